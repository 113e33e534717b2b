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

import numpy as np

from ltca.arrays import ComplexArray, FloatArray
from ltca.drive.materials import Material
from ltca.drive.parts import Disc, Drive
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


@dataclass(frozen=True, slots=True, kw_only=True)
class Section:
    """Integrals over a plane section, which add up; z = x + iy.

    Attributes
    ----------
    area : float
        ∫dA, mm².
    first : complex
        ∫z dA, mm³.
    polar : float
        ∫|z|² dA, mm⁴.
    square : complex
        ∫z² dA, mm⁴.
    """

    area: float
    first: complex
    polar: float
    square: complex

    @classmethod
    def of_circle(cls, radius: float, centre: complex = 0j) -> Section:
        """Return the section of a circle, mm."""
        area = np.pi * radius**2
        return cls(
            area=area,
            first=area * centre,
            polar=area * (abs(centre) ** 2 + 0.5 * radius**2),
            square=area * centre * centre,
        )

    @classmethod
    def within(cls, points: ComplexArray, steps: ComplexArray) -> Section:
        """Return the section inside a closed curve by its points, mm, and what it goes on by from each, mm."""
        swept = (points.conjugate() * steps).imag
        return cls(
            area=float(swept.sum() / 2.0),
            first=complex((points * swept).sum() / 3.0),
            polar=float((np.abs(points) ** 2 * swept).sum() / 4.0),
            square=complex((points**2 * swept).sum() / 4.0),
        )

    def __add__(self, other: Section) -> Section:
        """Both together."""
        return Section(
            area=self.area + other.area,
            first=self.first + other.first,
            polar=self.polar + other.polar,
            square=self.square + other.square,
        )

    def times(self, factor: float) -> Section:
        """Return the integrals times a factor; −1 for what is cut out."""
        return Section(
            area=factor * self.area, first=factor * self.first, polar=factor * self.polar, square=factor * self.square
        )

    def moved(self, by: complex) -> Section:
        """Return the section moved in its plane, mm."""
        return Section(
            area=self.area,
            first=self.first + self.area * by,
            polar=self.polar + 2.0 * (self.first * by.conjugate()).real + self.area * abs(by) ** 2,
            square=self.square + 2.0 * self.first * by + self.area * by * by,
        )


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
    density : float or None
        kg/m³; None where the drive does not give it.
    heights : array, shape (n,)
        Places z of the sections, mm.
    weights : array, shape (n,)
        What each section counts for, mm.
    sections : tuple of Section
        In the frame of the pin shaft.
    """

    name: str
    group: str
    material: str
    density: float | None
    heights: FloatArray
    weights: FloatArray
    sections: tuple[Section, ...]

    @property
    def volume(self) -> float:
        """Volume, mm³."""
        return float(self.weights @ [section.area for section in self.sections])

    @property
    def mass(self) -> float | None:
        """Mass, t; None without a density."""
        return None if self.density is None else DENSITY * self.density * self.volume

    @property
    def centre(self) -> FloatArray:
        """Centre of mass, mm, shape (3,)."""
        first = complex(self.weights @ [section.first for section in self.sections])
        z = float((self.weights * self.heights) @ [section.area for section in self.sections])
        return np.array([first.real, first.imag, z]) / self.volume

    @property
    def volume_moments(self) -> FloatArray:
        """∫ (r²·1 − r rᵀ) dV about the centre, mm⁵, shape (3, 3)."""
        w, z = self.weights, self.heights
        area, first, polar, square = (
            np.array([getattr(section, name) for section in self.sections])
            for name in ("area", "first", "polar", "square")
        )
        second = np.zeros((3, 3))
        second[0, 0], second[1, 1] = w @ (0.5 * (polar + square.real)), w @ (0.5 * (polar - square.real))
        second[0, 1] = second[1, 0] = w @ (0.5 * square.imag)
        second[2, 2] = (w * z * z) @ area
        second[0, 2] = second[2, 0] = (w * z) @ first.real
        second[1, 2] = second[2, 1] = (w * z) @ first.imag
        second -= self.volume * np.outer(self.centre, self.centre)
        return np.asarray(np.trace(second) * np.eye(3) - second)

    @property
    def inertia(self) -> FloatArray | None:
        """Tensor of inertia about the centre of mass, t·mm², shape (3, 3); None without a density."""
        return None if self.density is None else DENSITY * self.density * self.volume_moments

    @property
    def about_own_axis(self) -> float | None:
        """Moment of inertia about the line along z through the centre of mass, t·mm²; None without a density."""
        found = self.inertia
        return None if found is None else float(found[2, 2])


@dataclass(frozen=True, slots=True, kw_only=True)
class Unbalance:
    """Masses on eccentrics: what turns with the cranks about their axes.

    Attributes
    ----------
    discs : array of complex, shape (discs,)
        Mass times eccentricity of each disc with its eccentrics and rollers, along and ahead of the crank, t·mm.
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
        missing = [s for s in self.solids if s.density is None and not (known and s.group == CRANKS)]
        return tuple(dict.fromkeys(f"{solid.material}.density" for solid in missing))

    def mass_of(self, group: str) -> float | None:
        """Return the mass of all parts of a group, t; None where a density is not known. Of cranks the given one counts."""
        given = self.drive.inertia
        if group == CRANKS and given is not None and given.crank_mass is not None:
            return self.drive.crank.number * TONNE_PER_KG * given.crank_mass
        masses = [solid.mass for solid in self.of(group)]
        known = [mass for mass in masses if mass is not None]
        return sum(known) if len(known) == len(masses) else None

    @property
    def total(self) -> float | None:
        """Mass of all parts, t; None where one is not known."""
        masses = [self.mass_of(group) for group in self.groups]
        known = [mass for mass in masses if mass is not None]
        return sum(known) if len(known) == len(masses) else None

    @property
    def crank_inertia(self) -> float | None:
        """Moment of inertia of one crank about its own axis, t·mm²; None where it is not known."""
        given = self.drive.inertia
        if given is not None and given.crank is not None:
            return INERTIA * given.crank
        axis, total = complex(self.places[0].crank_axes[0]), 0.0
        for solid in self.of(CRANKS):
            mass, own = solid.mass, solid.about_own_axis
            if mass is None or own is None:
                return None
            # Cranks are alike but for errors of micrometres: the first stands for all.
            if solid.name.endswith("crank 0"):
                total += own + mass * abs(complex(solid.centre[0], solid.centre[1]) - axis) ** 2
        return total

    @cached_property
    def places(self) -> tuple[Placement, ...]:
        """Places of the parts of every disc."""
        return tuple(Placement.of_drive(single) for single in single_discs(self.drive))

    @property
    def unbalance(self) -> Unbalance | None:
        """Unbalance of discs, rollers and eccentrics; None where the density of discs or rollers is not known."""
        found, eccentrics = [], True
        for number, place in enumerate(self.places):
            arms = place.eccentricity * np.exp(1j * place.eccentric_phase)
            disc, rollers = self.of(DISCS)[number].mass, 0.0
            if disc is None:
                return None
            for solid in self.of(ROLLERS):
                if solid.name.endswith(f"of disc {number}"):
                    if solid.mass is None:
                        return None
                    rollers += solid.mass
            own = [solid.mass for solid in self.of(CRANKS) if solid.name.startswith(f"eccentric {number} ")]
            eccentrics = eccentrics and None not in own
            on_cranks = sum(mass or 0.0 for mass in own) if None not in own else 0.0
            found.append((disc + rollers + on_cranks) * complex(arms.mean()))
        planes = np.array(self.drive.disc.disc_planes, dtype=float)
        return Unbalance(discs=np.array(found), planes=planes, eccentrics=eccentrics)


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
    >>> [f"{group}: {1e3 * (masses.mass_of(group) or 0.0):.4f} kg" for group in masses.groups[:2]]
    ['discs: 1.2665 kg', 'wheel pins: 0.1288 kg']
    """
    drive = replace(drive, temperature=None)
    solids = (*_discs(drive), *_pins(drive), *_rollers(drive), *_cranks(drive))
    return DriveMasses(drive=drive, solids=solids)


def flank_section(profile: FlankProfile, inward: float = 0.0) -> Section:
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
    return Section.within(np.asarray(points), np.asarray(steps))


def _discs(drive: Drive) -> Iterator[Solid]:
    for number, single in enumerate(single_discs(drive)):
        place, profile, disc = Placement.of_drive(single), FlankProfile.of_drive(single), single.disc
        cut = [Section.of_circle(single.bore_radius, centre) for centre in place.bore_centres.tolist()]
        holes = zip(place.hole_radii.tolist(), place.hole_centres.tolist(), strict=True)
        cut += [Section.of_circle(radius, centre) for radius, centre in holes]
        (plane,), stands = disc.disc_planes, complex(place.race_centre(np.zeros(1))[0])
        heights, weights = _across(disc)
        sections = []
        for short in _shorts(disc, heights):
            section = flank_section(profile, short)
            for circle in cut:
                section = section + circle.times(-1.0)
            sections.append(section.moved(stands))
        if len(sections) == 1:
            sections *= heights.size
        yield Solid(
            name=f"disc {number}",
            group=DISCS,
            material="materials.disc",
            density=drive.materials.disc.density,
            heights=plane + heights,
            weights=weights,
            sections=tuple(sections),
        )


def _shorts(disc: Disc, heights: FloatArray) -> list[float]:
    """By how much the flank falls short at heights above the middle of the disc, mm; one value where it is straight."""
    return np.asarray(lead_relief(disc, heights)).tolist() if has_lead(disc) else [0.0]


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
    name: str, group: str, material: str, density: float | None, section: Section, low: float, high: float
) -> Solid:
    heights, weights = _gauss([low, high])
    return Solid(
        name=name,
        group=group,
        material=material,
        density=density,
        heights=heights,
        weights=weights,
        sections=(section,) * heights.size,
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
    place, wheel, shaft, stack, materials = (
        _in_the_middle(drive),
        drive.pin_wheel,
        drive.pin_shaft,
        _stack(drive),
        drive.materials,
    )
    half = 0.5 * drive.wheel_pin_span
    low, high = stack if wheel.beam is None else (-half, half)
    held = wheel.seat.pin_radius if wheel.seat.kind == "sleeve" else None
    centres = (place.wheel_pin_centres + place.wheel_axis).tolist()
    yield from _on_circle(
        WHEEL_PINS, "wheel_pin", materials.wheel_pin, centres, place.wheel_pin_radii, held, (low, high)
    )
    if wheel.seat.kind == "sleeve":
        bore = wheel.seat.bore_radius or 0.0
        yield from _sleeves(WHEEL_PINS, materials.sleeve, centres, place.wheel_pin_radii, bore, stack)
    if drive.ring is not None:
        ring, axis = drive.ring, complex(place.wheel_axis)
        inner = Section.of_circle(ring.inner_radius, axis).times(-1.0)
        section = Section.of_circle(ring.outer_radius, axis) + inner
        ends = -0.5 * ring.width, 0.5 * ring.width
        yield _cylinder(RING, RING, "ring.material", ring.material.density, section, *ends)
    if shaft is not None:
        half = 0.5 * drive.shaft_pin_span
        low, high = stack if shaft.beam is None else (-half, half)
        held = shaft.seat.pin_radius if shaft.seat.kind == "sleeve" else None
        centres, radii = place.shaft_pin_centres.tolist(), place.shaft_pin_radii
        yield from _on_circle(SHAFT_PINS, "shaft_pin", materials.shaft_pin, centres, radii, held, (low, high))
        if shaft.seat.kind == "sleeve":
            yield from _sleeves(SHAFT_PINS, materials.sleeve, centres, radii, shaft.seat.bore_radius or 0.0, stack)
    if (posts := drive.posts) is not None:
        half, number = 0.5 * drive.post_length, drive.crank.number
        beside = drive.crank.angle + np.pi / number if shaft is None else np.pi / shaft.number_of_pins
        around = posts.radius * np.exp(1j * (beside + 2.0 * np.pi * np.arange(posts.number) / posts.number))
        radii = np.full(posts.number, 0.5 * posts.size)
        yield from _on_circle(POSTS, "carrier", materials.carrier, around.tolist(), radii, None, (-half, half))


def _on_circle(
    group: str,
    part: str,
    material: Material,
    centres: Sequence[complex],
    radii: FloatArray,
    held: float | None,
    ends: tuple[float, float],
) -> Iterator[Solid]:
    """Round parts that stand about an axis; `held` is their radius where a sleeve is on them."""
    for number, (centre, radius) in enumerate(zip(centres, radii.tolist(), strict=True)):
        section = Section.of_circle(radius if held is None else held, centre)
        name = f"{group.removesuffix('s')} {number}"
        yield _cylinder(name, group, f"materials.{part}", material.density, section, *ends)


def _sleeves(
    pins: str,
    material: Material,
    centres: Sequence[complex],
    radii: FloatArray,
    bore: float,
    ends: tuple[float, float],
) -> Iterator[Solid]:
    for number, (centre, radius) in enumerate(zip(centres, radii.tolist(), strict=True)):
        section = Section.of_circle(radius, centre) + Section.of_circle(bore, centre).times(-1.0)
        name = f"sleeve of {pins.removesuffix('s')} {number}"
        yield _cylinder(name, SLEEVES[pins], "materials.sleeve", material.density, section, *ends)


def _rollers(drive: Drive) -> Iterator[Solid]:
    """Rollers on their inner races at crank angle 0."""
    for number, single in enumerate(single_discs(drive)):
        place, (plane,), half = Placement.of_drive(single), single.disc.disc_planes, 0.5 * single.roller_length
        races, radii = place.race_centres(np.zeros(1))[0], place.roller_radii
        rays = place.roller_rays(np.zeros(1))[0]
        centres = races[place.roller_cranks] + (single.crank_bearing.inner_race_radius + radii) * rays
        for roller, (centre, radius) in enumerate(zip(centres.tolist(), radii.tolist(), strict=True)):
            section = Section.of_circle(radius, centre)
            name, density = f"roller {roller} of disc {number}", drive.materials.roller.density
            yield _cylinder(name, ROLLERS, "materials.roller", density, section, plane - half, plane + half)


def crank_density(drive: Drive) -> tuple[str, float | None]:
    """Return the path of the material of the eccentrics and its density, kg/m³: of the crankshaft, or of the inner races, where
    it has none.
    """
    own, race = drive.materials.crankshaft.density, drive.materials.inner_race.density
    return ("materials.crankshaft", own) if own is not None else ("materials.inner_race", race)


def _cranks(drive: Drive) -> Iterator[Solid]:
    """Eccentrics as wide as the rollers, and the shaft between its bearings beside them; both solid."""
    material, density = crank_density(drive)
    taken, radius = [], drive.crank_bearing.inner_race_radius
    axes: list[complex] = []
    for number, single in enumerate(single_discs(drive)):
        place, (plane,), half = Placement.of_drive(single), single.disc.disc_planes, 0.5 * single.roller_length
        taken.append((plane - half, plane + half))
        axes = place.crank_axes.tolist()
        for crank, centre in enumerate(place.race_centres(np.zeros(1))[0].tolist()):
            section = Section.of_circle(radius, centre)
            name = f"eccentric {number} of crank {crank}"
            yield _cylinder(name, CRANKS, material, density, section, plane - half, plane + half)
    support = drive.crank.support
    if support is None:
        return
    for piece, (low, high) in enumerate(_beside(support.positions, sorted(taken))):
        for crank, axis in enumerate(axes):
            section = Section.of_circle(0.5 * support.diameter, axis)
            yield _cylinder(f"shaft {piece} of crank {crank}", CRANKS, material, density, section, low, high)


def _beside(whole: tuple[float, float], taken: Sequence[tuple[float, float]]) -> Iterator[tuple[float, float]]:
    """What is left of a length beside some pieces of it, in ascending order."""
    low, end = whole
    for first, last in taken:
        if min(first, end) > low:
            yield low, min(first, end)
        low = max(low, last)
    if end > low:
        yield low, end
