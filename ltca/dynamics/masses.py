r"""Volume, mass, centre and inertia of every part of a drive, its unbalance, its inertia referred to input and output.

Parts are plane sections between two heights, as they stand at crank angle 0 in the frame of the pin shaft, z as in
``disc.planes``; lengths are those at 20 °C, since warmth changes no mass. Integrals over a section are those along its edge: of
a function f homogeneous of degree k

.. math:: \int f\, dA = \frac{1}{k+2} \oint f\, (x\, dy - y\, dx) ,

on which the trapezoidal rule is exact to round-off, as for every smooth closed curve. A flank with a lead along its width is
integrated over the width as well. Pins and rollers are cylinders: crowns, reliefs and inclinations are micrometres.

Inside the suite the unit of mass is the tonne, which is N·s²/mm; moments of inertia are t·mm².
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import isnan, nan

import numpy as np

from ltca.arrays import ComplexArray, FloatArray
from ltca.drive.materials import Material
from ltca.drive.parts import Disc, Drive, PinShaft, PinWheel
from ltca.drive.single_discs import single_discs
from ltca.geometry.flank import FlankProfile
from ltca.geometry.length_profile import has_lead, lead_relief
from ltca.geometry.placement import Placement

TONNE_PER_KG = 1e-3
"""A tonne is N·s²/mm, the unit of mass that goes with mm, N and s."""
DENSITY = 1e-12
"""t/mm³ of 1 kg/m³."""
INERTIA = 1e3
"""t·mm² of 1 kg·m²."""
POINTS_PER_LOBE = 400
"""Of the trapezoidal rule along a flank; half as many change the area by round-off."""
POINTS_PER_WAVE = 12
"""Of the highest order of a deviation of the flank."""
OVER_WIDTH = 4
"""Places of Gauss's rule between the heights at which a lead changes its law: a lead is a square there, second moments of the
section have its fourth power, and z² comes to it."""
GAUSS = np.polynomial.legendre.leggauss(OVER_WIDTH)
"""Places over (−1, 1) and their weights."""
DISCS, WHEEL_PINS, SHAFT_PINS, ROLLERS, CRANKS, RING, POSTS = (
    "discs", "wheel pins", "shaft pins", "rollers", "cranks", "ring", "posts",
)  # fmt: skip
SLEEVES = {WHEEL_PINS: "sleeves of wheel pins", SHAFT_PINS: "sleeves of shaft pins"}


def circle_section(radius: float, centre: complex = 0j) -> ComplexArray:
    """Return the section of a circle, mm, as `section_within`."""
    size = abs(centre) ** 2 + 0.5 * radius**2
    return np.asarray(np.pi * radius**2 * np.array([1.0, centre, size, centre * centre]))


def section_within(points: ComplexArray, steps: ComplexArray) -> ComplexArray:
    """Return the section inside a closed curve by its points, mm, and what it goes on by from each, mm.

    It is ∫dA, ∫z dA, ∫|z|² dA and ∫z² dA with z = x + iy, mm² to mm⁴: sections side by side add up, one that is cut out is
    subtracted.
    """
    swept = (points.conjugate() * steps).imag
    powers = np.stack((np.ones_like(points), points, np.abs(points) ** 2, points**2))
    return np.asarray(powers @ swept / np.array([2.0, 3.0, 4.0, 4.0]))


def moved_section(section: ComplexArray, by: complex) -> ComplexArray:
    """Return a section moved in its plane, mm."""
    area, first, polar, square = section
    polar = polar + 2.0 * (first * by.conjugate()).real + area * abs(by) ** 2
    return np.array([area, first + area * by, polar, square + 2.0 * first * by + area * by * by])


@dataclass(frozen=True, slots=True, kw_only=True)
class Solid:
    """A part of one material.

    Attributes
    ----------
    name : str
        ``disc 0``, ``wheel pin 3``, …
    group : str
        Which parts it is one of: ``discs``, ``wheel pins``, …
    material : str
        Path of its material in a drive file.
    density : float
        kg/m³; not a number where the drive does not give it, and so is what follows from it.
    heights : array, shape (n,)
        Places z of the sections, mm.
    weights : array, shape (n,)
        What each section counts for, mm.
    sections : array of complex, shape (n, 4)
        As `section_within`, in the frame of the pin shaft.
    disc, crank : int
        Of a disc, and of a crank, that it belongs to; −1 for none.
    """

    name: str
    group: str
    material: str
    density: float
    heights: FloatArray
    weights: FloatArray
    sections: ComplexArray
    disc: int = -1
    crank: int = -1

    @property
    def volume(self) -> float:
        """Volume, mm³."""
        return float(self.weights @ self.sections[:, 0].real)

    @property
    def mass(self) -> float:
        """Mass, t."""
        return DENSITY * self.density * self.volume

    @property
    def place(self) -> complex:
        """Centre of mass in the plane, mm."""
        return complex(self.weights @ self.sections[:, 1]) / self.volume

    @property
    def centre(self) -> FloatArray:
        """Centre of mass, mm, shape (3,)."""
        z = float((self.weights * self.heights) @ self.sections[:, 0].real) / self.volume
        return np.array([self.place.real, self.place.imag, z])

    @property
    def volume_moments(self) -> FloatArray:
        """∫ (r²·1 − r rᵀ) dV about the centre, mm⁵, shape (3, 3)."""
        w, z = self.weights, self.heights
        area, first, polar, square = self.sections.T
        xx, yy, xy = 0.5 * (polar + square).real, 0.5 * (polar - square).real, 0.5 * square.imag
        in_plane = [[w @ xx, w @ xy], [w @ xy, w @ yy]]
        along = (w * z) @ np.stack((first.real, first.imag, z * area.real), axis=1)
        second = np.block([[np.array(in_plane), along[:2, None]], [along]])
        second -= self.volume * np.outer(self.centre, self.centre)
        return np.asarray(np.trace(second) * np.eye(3) - second)

    @property
    def inertia(self) -> FloatArray:
        """Tensor of inertia about the centre of mass, t·mm², shape (3, 3)."""
        return DENSITY * self.density * self.volume_moments

    @property
    def about_own_axis(self) -> float:
        """Moment of inertia about the line along z through the centre of mass, t·mm²."""
        return float(self.inertia[2, 2])

    def about(self, place: complex) -> float:
        """Return the moment of inertia about a line along z through a place, mm, in t·mm²."""
        return self.about_own_axis + self.mass * abs(self.place - place) ** 2


@dataclass(frozen=True, slots=True, kw_only=True)
class Unbalance:
    """Masses on eccentrics: what turns with the cranks about their axes.

    Attributes
    ----------
    discs : array of complex, shape (discs,)
        Mass times eccentricity of each disc with its eccentrics and rollers, along and ahead of the crank, t·mm; not a number
        where the density of discs or rollers is not known.
    planes : array, shape (discs,)
        Their axial places, mm.
    eccentrics : bool
        Whether the masses of the eccentrics are known and in it.
    """

    discs: ComplexArray
    planes: FloatArray
    eccentrics: bool

    @property
    def static(self) -> complex:
        """What is left of all discs together, t·mm."""
        return complex(self.discs.sum())

    @property
    def couple(self) -> complex:
        """Moment of the unbalances about the zero of the planes, t·mm²."""
        return complex(self.planes @ self.discs)


@dataclass(frozen=True, kw_only=True)
class DriveMasses:
    """Masses of the parts that a drive file describes.

    Attributes
    ----------
    drive : Drive
        Whose, at 20 °C.
    solids : tuple of Solid
        Every part, discs first.
    """

    drive: Drive
    solids: tuple[Solid, ...]

    def of(self, group: str) -> tuple[Solid, ...]:
        """Return the parts of a group."""
        return tuple(solid for solid in self.solids if solid.group == group)

    @property
    def groups(self) -> tuple[str, ...]:
        """Which parts there are."""
        return tuple(dict.fromkeys(solid.group for solid in self.solids))

    @property
    def without_density(self) -> tuple[str, ...]:
        """Fields of the densities that the drive does not give, those of cranks only where they are not given otherwise."""
        given = self.drive.inertia
        known = given is not None and given.crank is not None and given.crank_mass is not None
        missing = [s for s in self.solids if isnan(s.density) and not (known and s.group == CRANKS)]
        return tuple(dict.fromkeys(f"{solid.material}.density" for solid in missing))

    def mass_of(self, group: str) -> float:
        """Return the mass of all parts of a group, t; not a number without a density. Of cranks the given one counts."""
        given = self.drive.inertia
        if group == CRANKS and given is not None and given.crank_mass is not None:
            return self.drive.crank.number * TONNE_PER_KG * given.crank_mass
        return sum(solid.mass for solid in self.of(group))

    @property
    def total(self) -> float:
        """Mass of all parts, t."""
        return sum(self.mass_of(group) for group in self.groups)

    @property
    def crank_inertia(self) -> float:
        """Moment of inertia of one crank about its own axis, t·mm²."""
        given, axis = self.drive.inertia, complex(self.places[0].crank_axes[0])
        if given is not None and given.crank is not None:
            return INERTIA * given.crank
        # Cranks are alike but for errors of micrometres: the first stands for all.
        return sum(solid.about(axis) for solid in self.of(CRANKS) if solid.crank == 0)

    @cached_property
    def places(self) -> tuple[Placement, ...]:
        """Places of the parts of every disc."""
        return tuple(Placement.of_drive(single) for single in single_discs(self.drive))

    @property
    def unbalance(self) -> Unbalance:
        """Unbalance of discs, rollers and eccentrics."""
        arms = [(place.eccentricity * np.exp(1j * place.eccentric_phase)).mean() for place in self.places]

        def by_disc(group: str) -> FloatArray:
            """Masses at each disc."""
            return np.array([sum(s.mass for s in self.of(group) if s.disc == disc) for disc in range(len(arms))])

        on_cranks, planes = by_disc(CRANKS), np.array(self.drive.disc.disc_planes, dtype=float)
        found = (by_disc(DISCS) + by_disc(ROLLERS) + np.nan_to_num(on_cranks)) * np.array(arms)
        return Unbalance(discs=found, planes=planes, eccentrics=not np.isnan(on_cranks).any())


def drive_masses(drive: Drive) -> DriveMasses:
    """Return the masses of the parts of a drive as its file describes them.

    Flanges of a carrier, a housing and cages have no mass: a file gives neither radius nor shape of these.

    Parameters
    ----------
    drive : Drive
        With its temperatures or without; lengths are those at 20 °C.

    Returns
    -------
    DriveMasses

    Examples
    --------
    >>> from ltca.reading.drive_file import load_drive
    >>> masses = drive_masses(load_drive("robot-joint").cases["nominal"])
    >>> [f"{group}: {1e3 * masses.mass_of(group):.4f} kg" for group in masses.groups[:2]]
    ['discs: 1.2665 kg', 'wheel pins: 0.1288 kg']
    """
    drive = replace(drive, temperature=None)
    solids = (*_discs(drive), *_pins(drive), *_rollers(drive), *_cranks(drive))
    return DriveMasses(drive=drive, solids=solids)


def flank_section(profile: FlankProfile, inward: float = 0.0) -> ComplexArray:
    """Return the section inside a flank that is moved into the material along its normal, in the frame of the disc.

    Parameters
    ----------
    profile : FlankProfile
        Of one disc.
    inward : float
        By how much, mm.
    """
    waves = 0 if profile.deviation is None else max(profile.deviation.orders, default=0)
    count = max(POINTS_PER_LOBE * (round(profile.reduction_ratio) - 1), POINTS_PER_WAVE * waves)
    parameter = 2.0 * np.pi * np.arange(count) / count
    points = profile.flank(parameter) - inward * profile.normal(parameter)
    steps = profile.flank_tangent(parameter) * (1.0 - inward * profile.curvature(parameter)) * (2.0 * np.pi / count)
    return section_within(np.asarray(points), np.asarray(steps))


def _discs(drive: Drive) -> Iterator[Solid]:
    for number, single in enumerate(single_discs(drive)):
        place, profile, disc = Placement.of_drive(single), FlankProfile.of_drive(single), single.disc
        radii = [*place.hole_radii.tolist(), *[single.bore_radius] * place.cranks]
        centres = [*place.hole_centres.tolist(), *place.bore_centres.tolist()]
        cut = sum(circle_section(radius, centre) for radius, centre in zip(radii, centres, strict=True))
        (plane,), stands = disc.disc_planes, complex(place.race_centre(np.zeros(1))[0])
        heights, weights = _across(disc)
        # Of a flank that is straight along its width one section is that of all heights.
        shorts = lead_relief(disc, heights) if has_lead(disc) else np.zeros(1)
        each = [moved_section(flank_section(profile, short) - cut, stands) for short in shorts.tolist()]
        yield Solid(
            name=f"disc {number}",
            group=DISCS,
            material="materials.disc",
            density=_density(drive.materials.disc),
            heights=plane + heights,
            weights=weights,
            sections=np.broadcast_to(np.array(each), (heights.size, 4)),
            disc=number,
        )


def _density(material: Material) -> float:
    return nan if material.density is None else material.density


def _across(disc: Disc) -> tuple[FloatArray, FloatArray]:
    """Places above the middle of a disc, mm, and their weights, mm."""
    half, relief = 0.5 * disc.thickness, disc.lead_relief_length
    ends = [-half, *((relief - half, half - relief) if has_lead(disc) and 0.0 < relief < half else ()), half]
    return _gauss(sorted(ends))


def _gauss(ends: Sequence[float]) -> tuple[FloatArray, FloatArray]:
    places, weights = GAUSS
    low, high = np.array(ends[:-1])[:, None], np.array(ends[1:])[:, None]
    half = 0.5 * (high - low)
    return (low + half * (1.0 + places)).ravel(), (half * weights).ravel()


def _cylinder(
    name: str, group: str, material: str, density: float, section: ComplexArray, ends: tuple[float, float], **of: int
) -> Solid:
    """A part with one section; `of` are its disc and crank."""
    heights, weights = _gauss(ends)
    return Solid(
        name=name,
        group=group,
        material=material,
        density=density,
        heights=heights,
        weights=weights,
        sections=np.tile(section, (heights.size, 1)),
        **of,
    )


def _stack(drive: Drive) -> tuple[float, float]:
    half = 0.5 * drive.disc.thickness
    return min(drive.disc.disc_planes) - half, max(drive.disc.disc_planes) + half


def _in_the_middle(drive: Drive) -> Placement:
    """Where pins stand at z = 0, the zero of the discs' planes, about which they are inclined."""
    first = single_discs(drive)[0]
    return Placement.of_drive(replace(first, disc=replace(first.disc, planes=(0.0,))))


def _pins(drive: Drive) -> Iterator[Solid]:
    """Pins and sleeves of wheel and shaft, the ring of the wheel, posts of the carrier."""
    place, shaft, materials = _in_the_middle(drive), drive.pin_shaft, drive.materials
    axis = complex(place.wheel_axis)
    centres, radii = place.wheel_pin_centres + axis, place.wheel_pin_radii
    yield from _with_sleeves(drive, WHEEL_PINS, drive.pin_wheel, drive.wheel_pin_span, centres, radii)
    if drive.ring is not None:
        ring = drive.ring
        section = circle_section(ring.outer_radius, axis) - circle_section(ring.inner_radius, axis)
        yield _cylinder(RING, RING, "ring.material", _density(ring.material), section, _about_middle(ring.width))
    if shaft is not None:
        centres, radii = place.shaft_pin_centres, place.shaft_pin_radii
        yield from _with_sleeves(drive, SHAFT_PINS, shaft, drive.shaft_pin_span, centres, radii)
    if (posts := drive.posts) is not None:
        beside = drive.crank.angle + np.pi / drive.crank.number if shaft is None else np.pi / shaft.number_of_pins
        around = posts.radius * np.exp(1j * (beside + 2.0 * np.pi * np.arange(posts.number) / posts.number))
        radii = np.full(posts.number, 0.5 * posts.size)
        yield from _on_circle(POSTS, "carrier", materials.carrier, around, radii, _about_middle(drive.post_length))


def _about_middle(length: float) -> tuple[float, float]:
    return -0.5 * length, 0.5 * length


def _with_sleeves(
    drive: Drive, group: str, pins: PinWheel | PinShaft, span: float, centres: ComplexArray, radii: FloatArray
) -> Iterator[Solid]:
    """Pins of wheel or shaft, then the sleeves on them; `radii` are those at the flank or the holes."""
    stack, seat, part = _stack(drive), pins.seat, group.removesuffix("s").replace(" ", "_")
    sleeves = seat.kind == "sleeve"
    own = np.full_like(radii, seat.pin_radius) if sleeves and seat.pin_radius is not None else radii
    ends = stack if pins.beam is None else _about_middle(span)
    yield from _on_circle(group, part, getattr(drive.materials, part), centres, own, ends)
    if sleeves:
        bore = seat.bore_radius or 0.0
        yield from _on_circle(SLEEVES[group], "sleeve", drive.materials.sleeve, centres, radii, stack, bore)


def _on_circle(
    group: str,
    part: str,
    material: Material,
    centres: ComplexArray,
    radii: FloatArray,
    ends: tuple[float, float],
    bore: float = 0.0,
) -> Iterator[Solid]:
    """Round parts that stand about an axis, with a bore of some radius."""
    name, density = group.replace("sleeves", "sleeve").removesuffix("s"), _density(material)
    for number, (centre, radius) in enumerate(zip(centres.tolist(), radii.tolist(), strict=True)):
        section = circle_section(radius, centre) - circle_section(bore, centre)
        yield _cylinder(f"{name} {number}", group, f"materials.{part}", density, section, ends)


def _rollers(drive: Drive) -> Iterator[Solid]:
    """Rollers on their inner races at crank angle 0."""
    density = _density(drive.materials.roller)
    for number, single in enumerate(single_discs(drive)):
        place, ends = Placement.of_drive(single), _of_rollers(single)
        races, radii = place.race_centres(np.zeros(1))[0], place.roller_radii
        rays = place.roller_rays(np.zeros(1))[0]
        centres = races[place.roller_cranks] + (single.crank_bearing.inner_race_radius + radii) * rays
        for roller, (centre, radius) in enumerate(zip(centres.tolist(), radii.tolist(), strict=True)):
            name, section = f"roller {roller} of disc {number}", circle_section(radius, centre)
            yield _cylinder(name, ROLLERS, "materials.roller", density, section, ends, disc=number)


def _of_rollers(single: Drive) -> tuple[float, float]:
    """Ends of the rollers of one disc, mm."""
    (plane,), half = single.disc.disc_planes, 0.5 * single.roller_length
    return plane - half, plane + half


def _cranks(drive: Drive) -> Iterator[Solid]:
    """Eccentrics as wide as the rollers, and the shaft between its bearings beside them; both solid.

    They are of the material of the crankshaft, or of that of the inner races where it has no density.
    """
    named = "crankshaft" if drive.materials.crankshaft.density is not None else "inner_race"
    material, density = f"materials.{named}", _density(getattr(drive.materials, named))
    taken, axes = list[tuple[float, float]](), list[complex]()
    for disc, single in enumerate(single_discs(drive)):
        place, ends = Placement.of_drive(single), _of_rollers(single)
        taken.append(ends)
        axes = place.crank_axes.tolist()
        for crank, centre in enumerate(place.race_centres(np.zeros(1))[0].tolist()):
            section, name = (
                circle_section(single.crank_bearing.inner_race_radius, centre),
                f"eccentric {disc} of crank {crank}",
            )
            yield _cylinder(name, CRANKS, material, density, section, ends, disc=disc, crank=crank)
    support = drive.crank.support
    if support is None:
        return
    for piece, ends in enumerate(_beside(support.positions, sorted(taken))):
        for crank, axis in enumerate(axes):
            section, name = circle_section(0.5 * support.diameter, axis), f"shaft {piece} of crank {crank}"
            yield _cylinder(name, CRANKS, material, density, section, ends, crank=crank)


def _beside(whole: tuple[float, float], taken: Sequence[tuple[float, float]]) -> Iterator[tuple[float, float]]:
    """What is left of a length beside some pieces of it, in ascending order."""
    low, end = whole
    for first, last in taken:
        if min(first, end) > low:
            yield low, min(first, end)
        low = max(low, last)
    if end > low:
        yield low, end
