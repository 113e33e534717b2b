"""Volume, mass, centre and inertia of every part of a drive, and the unbalance of its discs.

Parts are plane sections between two heights, at crank angle 0 in the frame of the pin shaft, at 20 °C; pins and rollers are
cylinders. The unit of mass is the tonne, N·s²/mm.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import isnan, nan
from operator import attrgetter

import numpy as np

from ltca.arrays import ComplexArray, FloatArray
from ltca.drive.parts import Drive, PinShaft, PinWheel
from ltca.drive.single_discs import single_discs
from ltca.geometry.flank import FlankProfile
from ltca.geometry.length_profile import has_lead, lead_relief
from ltca.geometry.placement import Placement

TONNE_PER_KG = 1e-3
DENSITY = 1e-12
"""t/mm³ of 1 kg/m³."""
INERTIA = 1e3
"""t·mm² of 1 kg·m²."""
POINTS_PER_LOBE = 400
"""Points of the trapezoidal rule along a flank; half as many change the area by round-off."""
POINTS_PER_WAVE = 12
"""Points for the highest order of a deviation of the flank."""
GAUSS = np.polynomial.legendre.leggauss(4)
"""Places over (−1, 1) and weights: a lead is a square, whose fourth power, times z², second moments have."""
BALANCED = 1e-9
"""Part of the unbalance of all discs, taken one by one, below which their sum is round-off."""
DISCS, WHEEL_PINS, SHAFT_PINS, ROLLERS, CRANKS, RING, POSTS = (
    "discs", "wheel pins", "shaft pins", "rollers", "cranks", "ring", "posts",
)  # fmt: skip
SLEEVES = {WHEEL_PINS: "sleeves of wheel pins", SHAFT_PINS: "sleeves of shaft pins"}

Single = tuple[Drive, Placement]
"""One disc as a drive, and the places of its parts."""


def circle_section(radius: float, centre: complex = 0j) -> ComplexArray:
    """Return the section of a circle, mm, as `section_within`."""
    size = abs(centre) ** 2 + 0.5 * radius**2
    return np.asarray(np.pi * radius**2 * np.array([1.0, centre, size, centre * centre]))


def section_within(points: ComplexArray, steps: ComplexArray) -> ComplexArray:
    """Return ∫dA, ∫z dA, ∫|z|² dA and ∫z² dA inside a closed curve, z = x + iy, mm² to mm⁴, by points and tangential steps.

    Of f homogeneous of degree k, ∫f dA = ∮ f (x dy − y dx)/(k + 2), by the trapezoidal rule.
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
    """A part of one material; integrals over z are sums over heights by weights."""

    name: str
    group: str
    material: str  # its path in a drive file
    density: float  # kg/m³, NaN where none is given
    heights: FloatArray  # mm
    weights: FloatArray  # mm
    sections: ComplexArray  # as `section_within`, shape (heights, 4)
    disc: int  # to which it belongs, −1 to none
    crank: int  # likewise

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
        xz, yz, zz = z * first.real, z * first.imag, z * z * area.real
        second = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ w
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
    """Mass times eccentricity of each disc with its rollers and eccentrics; NaN without densities of discs and rollers."""

    discs: ComplexArray  # along and ahead of the crank, t·mm
    planes: FloatArray  # axial places, mm
    eccentrics: bool  # whether their density is known

    @property
    def static(self) -> complex:
        """Sum over all discs, t·mm; 0 where it is round-off."""
        total = complex(self.discs.sum())
        return 0j if abs(total) <= BALANCED * abs(self.discs).sum() else total

    @property
    def couple(self) -> complex:
        """Moment of the unbalances about the zero of the planes, t·mm²; 0 where it is round-off."""
        total, sizes = complex(self.planes @ self.discs), abs(self.discs)
        return 0j if abs(total) <= BALANCED * max(sizes @ abs(self.planes), sizes.sum()) else total


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveMasses:
    """Masses of the parts that a drive file describes, discs first, and the places of the parts of every disc, at 20 °C."""

    drive: Drive
    solids: tuple[Solid, ...]
    places: tuple[Placement, ...]

    def of(self, group: str) -> tuple[Solid, ...]:
        """Return the parts of a group."""
        return tuple(solid for solid in self.solids if solid.group == group)

    @property
    def groups(self) -> tuple[str, ...]:
        """Names of the groups of parts."""
        return tuple(dict.fromkeys(solid.group for solid in self.solids))

    @property
    def without_density(self) -> tuple[str, ...]:
        """Fields of missing densities, those of cranks only where mass or inertia is not given otherwise."""
        given = self.drive.inertia
        known = given is not None and given.crank is not None and given.crank_mass is not None
        missing = [s for s in self.solids if isnan(s.density) and not (known and s.group == CRANKS)]
        return tuple(dict.fromkeys(f"{solid.material}.density" for solid in missing))

    def mass_of(self, group: str) -> float:
        """Return the mass of all parts of a group, t, NaN without a density; of cranks the given one counts."""
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

    @property
    def unbalance(self) -> Unbalance:
        """Unbalance of discs, rollers and eccentrics."""
        arms = np.array([(place.eccentricity * np.exp(1j * place.eccentric_phase)).mean() for place in self.places])

        def by_disc(group: str) -> FloatArray:
            """Masses at each disc."""
            return np.array([sum(s.mass for s in self.of(group) if s.disc == disc) for disc in range(arms.size)])

        on_cranks, planes = by_disc(CRANKS), np.array(self.drive.disc.disc_planes, dtype=float)
        found = (by_disc(DISCS) + by_disc(ROLLERS) + np.nan_to_num(on_cranks)) * arms
        return Unbalance(discs=found, planes=planes, eccentrics=not np.isnan(on_cranks).any())


def drive_masses(drive: Drive) -> DriveMasses:
    """Return the masses of the parts whose shapes a drive's file gives, not of flanges, housings and cages."""
    drive = replace(drive, temperature=None)
    discs = [(single, Placement.of_drive(single)) for single in single_discs(drive)]
    solids = (*_discs(discs), *_pins(drive), *_rollers(discs), *_cranks(drive, discs))
    return DriveMasses(drive=drive, solids=solids, places=tuple(place for _, place in discs))


def flank_section(profile: FlankProfile, inward: float = 0.0) -> ComplexArray:
    """Return the section inside the flank of one disc, moved into the material along its normal, mm, in the frame of the disc."""
    waves = 0 if profile.deviation is None else max(profile.deviation.orders, default=0)
    count = max(POINTS_PER_LOBE * (round(profile.reduction_ratio) - 1), POINTS_PER_WAVE * waves)
    parameter = 2.0 * np.pi * np.arange(count) / count
    points = profile.flank(parameter) - inward * profile.normal(parameter)
    steps = profile.flank_tangent(parameter) * (1.0 - inward * profile.curvature(parameter)) * (2.0 * np.pi / count)
    return section_within(np.asarray(points), np.asarray(steps))


def _solid(
    drive: Drive,
    name: str,
    group: str,
    material: str,
    section: ComplexArray,
    ends: Sequence[float],
    *,
    disc: int = -1,
    crank: int = -1,
) -> Solid:
    """A part between heights, with one section or one at every height of `_gauss`."""
    heights, weights = _gauss(ends)
    density = attrgetter(material)(drive).density
    return Solid(
        name=name,
        group=group,
        material=material,
        density=nan if density is None else density,
        heights=heights,
        weights=weights,
        sections=np.broadcast_to(section, (heights.size, 4)),
        disc=disc,
        crank=crank,
    )


def _gauss(ends: Sequence[float]) -> tuple[FloatArray, FloatArray]:
    """Heights and weights of Gauss's rule between neighbouring ends, mm."""
    places, weights = GAUSS
    low, high = np.array(ends[:-1])[:, None], np.array(ends[1:])[:, None]
    half = 0.5 * (high - low)
    return (low + half * (1.0 + places)).ravel(), (half * weights).ravel()


def _about(middle: float, length: float) -> tuple[float, float]:
    """Ends of a length about its middle."""
    return middle - 0.5 * length, middle + 0.5 * length


def _discs(discs: Sequence[Single]) -> Iterator[Solid]:
    for number, (single, place) in enumerate(discs):
        profile, disc = FlankProfile.of_drive(single), single.disc
        radii = [*place.hole_radii.tolist(), *[single.bore_radius] * place.cranks]
        centres = [*place.hole_centres.tolist(), *place.bore_centres.tolist()]
        cut = sum(circle_section(radius, centre) for radius, centre in zip(radii, centres, strict=True))
        (plane,), stands = disc.disc_planes, complex(place.races(np.zeros(1)).middle[0])
        half, relief = 0.5 * disc.thickness, disc.lead_relief_length
        ends, shorts = [-half, half], np.zeros(1)  # one section where the flank is straight along its width
        if has_lead(disc):
            ends = sorted({*ends, relief - half, half - relief} if 0.0 < relief < half else ends)
            shorts = lead_relief(disc, _gauss(ends)[0])
        each = [moved_section(flank_section(profile, short) - cut, stands) for short in shorts.tolist()]
        heights = [plane + end for end in ends]
        yield _solid(single, f"disc {number}", DISCS, "materials.disc", np.array(each), heights, disc=number)


def _pins(drive: Drive) -> Iterator[Solid]:
    """Pins and sleeves of wheel and shaft, the ring of the wheel, posts of the carrier."""
    first, shaft, ring, posts = single_discs(drive)[0], drive.pin_shaft, drive.ring, drive.posts
    # Pins may be inclined about z = 0, the zero of the planes of the discs.
    place = Placement.of_drive(replace(first, disc=replace(first.disc, planes=(0.0,))))
    axis = complex(place.wheel_axis)
    centres, radii = place.wheel_pin_centres + axis, place.wheel_pin_radii
    yield from _with_sleeves(drive, WHEEL_PINS, drive.pin_wheel, drive.wheel_pin_span, centres, radii)
    if ring is not None:
        section = circle_section(ring.outer_radius, axis) - circle_section(ring.inner_radius, axis)
        yield _solid(drive, RING, RING, "ring.material", section, _about(0.0, ring.width))
    if shaft is not None:
        centres, radii = place.shaft_pin_centres, place.shaft_pin_radii
        yield from _with_sleeves(drive, SHAFT_PINS, shaft, drive.shaft_pin_span, centres, radii)
    if posts is not None:
        beside = drive.crank.angle + np.pi / drive.crank.number if shaft is None else np.pi / shaft.number_of_pins
        around = posts.radius * np.exp(1j * (beside + 2.0 * np.pi * np.arange(posts.number) / posts.number))
        radii, ends = np.full(posts.number, 0.5 * posts.size), _about(0.0, drive.post_length)
        yield from _on_circle(drive, POSTS, "materials.carrier", around, radii, ends)


def _with_sleeves(
    drive: Drive, group: str, pins: PinWheel | PinShaft, span: float, centres: ComplexArray, radii: FloatArray
) -> Iterator[Solid]:
    """Pins of wheel or shaft, then the sleeves on them; `radii` are those at the flank or the holes."""
    seat, planes, half = pins.seat, drive.disc.disc_planes, 0.5 * drive.disc.thickness
    sleeves, stack = seat.kind == "sleeve", (min(planes) - half, max(planes) + half)
    own = np.full_like(radii, seat.pin_radius) if sleeves and seat.pin_radius is not None else radii
    material = f"materials.{group.removesuffix('s').replace(' ', '_')}"
    yield from _on_circle(drive, group, material, centres, own, stack if pins.beam is None else _about(0.0, span))
    if sleeves:
        bore = seat.bore_radius or 0.0
        yield from _on_circle(drive, SLEEVES[group], "materials.sleeve", centres, radii, stack, bore)


def _on_circle(
    drive: Drive,
    group: str,
    material: str,
    centres: ComplexArray,
    radii: FloatArray,
    ends: tuple[float, float],
    bore: float = 0.0,
) -> Iterator[Solid]:
    """Round parts that stand about an axis, with a bore of some radius."""
    name = group.replace("sleeves", "sleeve").removesuffix("s")
    for number, (centre, radius) in enumerate(zip(centres.tolist(), radii.tolist(), strict=True)):
        section = circle_section(radius, centre) - circle_section(bore, centre)
        yield _solid(drive, f"{name} {number}", group, material, section, ends)


def _rollers(discs: Sequence[Single]) -> Iterator[Solid]:
    """Rollers on their inner races at crank angle 0."""
    for number, (single, place) in enumerate(discs):
        ends = _about(single.disc.disc_planes[0], single.roller_length)
        races, radii, rays = place.races(np.zeros(1)).centre[0], place.roller_radii, place.roller_rays(np.zeros(1))[0]
        centres = races[place.roller_cranks] + (single.crank_bearing.inner_race_radius + radii) * rays
        for roller, (centre, radius) in enumerate(zip(centres.tolist(), radii.tolist(), strict=True)):
            name, section = f"roller {roller} of disc {number}", circle_section(radius, centre)
            yield _solid(single, name, ROLLERS, "materials.roller", section, ends, disc=number)


def _cranks(drive: Drive, discs: Sequence[Single]) -> Iterator[Solid]:
    """Solid eccentrics as wide as the rollers and shafts beside them, of the inner races' material without one of their own."""
    support, taken = drive.crank.support, list[tuple[float, float]]()
    material = f"materials.{'inner_race' if drive.materials.crankshaft.density is None else 'crankshaft'}"
    for disc, (single, place) in enumerate(discs):
        ends, radius = _about(single.disc.disc_planes[0], single.roller_length), single.crank_bearing.inner_race_radius
        taken.append(ends)
        for crank, centre in enumerate(place.races(np.zeros(1)).centre[0].tolist()):
            name, section = f"eccentric {disc} of crank {crank}", circle_section(radius, centre)
            yield _solid(drive, name, CRANKS, material, section, ends, disc=disc, crank=crank)
    if support is None:
        return
    for piece, ends in enumerate(_beside(support.positions, sorted(taken))):
        for crank, axis in enumerate(discs[0][1].crank_axes.tolist()):
            name, section = f"shaft {piece} of crank {crank}", circle_section(0.5 * support.diameter, axis)
            yield _solid(drive, name, CRANKS, material, section, ends, crank=crank)


def _beside(whole: tuple[float, float], taken: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """Remaining pieces of a length, in ascending order."""
    firsts, lasts = zip(*taken, strict=True)
    low = np.maximum.accumulate([whole[0], *lasts])
    high = np.minimum([*firsts, whole[1]], whole[1])
    return [(start, end) for start, end in zip(low.tolist(), high.tolist(), strict=True) if end > start]
