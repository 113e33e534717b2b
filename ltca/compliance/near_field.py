"""Near fields of all contacts of a drive, and the yield of bodies beyond them: the diagonal of the body part C.

Finite-element approaches hold the near field of the law as well: it comes off once, as that of a load even over the body's
thickness. With the law's length it would cancel, and short rollers be as stiff as long ones (docs/theory/solid_bodies.md).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal, get_args

import numpy as np

from ltca.arrays import FloatArray
from ltca.compliance import sliced
from ltca.compliance.coefficients import SOLID, InfluenceCoefficients, logarithm_factor
from ltca.compliance.half_space import HalfSpaceCompliance, behind_wheel_pins, hole_in_slices
from ltca.compliance.response import DiscContacts
from ltca.compliance.solid_cylinder import free_ends_of_cylinder
from ltca.contact.contact_kind import ContactKinds
from ltca.contact.free_end import FreeEnds, guilbault_factor
from ltca.contact.hertz import effective_radius, line_half_width
from ltca.drive.engine_support import require
from ltca.drive.hole_contact import hole_modulus
from ltca.drive.parts import Drive, Material, PinShaft, PinWheel, contact_modulus
from ltca.errors import ConvergenceError, DriveError
from ltca.geometry.length_profile import lead_relief
from ltca.geometry.pairs import ContactGeometry
from ltca.laws.backed import HALF_SPACE_DATUM, BackedLaw, shaft_pin_seat, sleeve_overlap, tip_motion
from ltca.laws.contact_law import ContactLaw
from ltca.laws.line_contact import LineContactLaw
from ltca.laws.plane_strain import SELF_ENERGY, PlaneContactLaw

NearField = Literal["plane-strain", "half-space"]

NEAR_FIELDS: dict[str, NearField] = {"fe": "plane-strain", "hybrid": "half-space"}
"""The near field of a compliance, by its name."""
POINTS_ACROSS = 12
"""Of a semi-elliptic load: exact of powers of 23."""
IMAGE_PANELS, NEAREST_IMAGE = 24, 1e-8
"""Of integrals over distances of images, and where they start, by the length."""
ALIGNED_SLICES = 17
"""Of the line whose difference from an even load is taken."""
MEAN_DISTANCE, MEAN_CUBED_DISTANCE = 256.0 / (45.0 * np.pi**2), 8192.0 / (1575.0 * np.pi**2)
"""⟨|x − x′|⟩ and ⟨|x − x′|³⟩ of two semi-ellipses of half-width 1."""
MAX_ITERATIONS = 30
"""Of the search for the approach of a half-width: a handful is usual."""


def near_field_contacts(drive: Drive, kind: NearField, *, rigid_shaft_pins: bool, solid: bool = False) -> DiscContacts:
    """Return the contacts of a drive with the laws of their near fields; with `rigid_shaft_pins` holes yield by walls alone."""
    if kind not in get_args(NearField):
        raise DriveError([f"near_field = {kind!r}: must be one of {', '.join(map(repr, get_args(NearField)))}"])
    modulus, kinds = hole_modulus(drive, rigid_shaft_pins=rigid_shaft_pins), ContactKinds.of_drive(drive)
    if kind == "half-space":
        if solid and drive.contact.slices > 1:
            kinds = kinds.with_free_ends(drive, rigid_shaft_pins=rigid_shaft_pins)
        found = HalfSpaceCompliance.of_drive(drive, kinds=kinds)
        holes = replace(kinds.holes, contact_modulus=modulus)
        at_hole: Any = LineContactLaw(drive.disc.thickness, modulus)
        if drive.contact.slices > 1:
            at_hole = hole_in_slices(drive, holes, found.geometry.placement.shaft_pin_plays)
        kinds = replace(found.kinds, holes=holes)
        return replace(found, hole_law=at_hole, kinds=kinds, rigid_shaft_pins=rigid_shaft_pins)
    require(drive, "fe")
    parts, thickness, slices = drive.materials, drive.disc.thickness, drive.contact.slices
    geometry, datum = ContactGeometry.of_drive(drive), plane_strain_datum(drive)

    def law(modulus: float, part: PinWheel | PinShaft | None = None) -> Any:
        plane: ContactLaw = PlaneContactLaw(thickness=thickness, contact_modulus=modulus, datum=datum)
        if slices == 1:
            return plane
        z = sliced.slice_heights(thickness, slices)
        if part is not None and part.seat.kind == "sleeve":
            plane = BackedLaw(contact=plane, play=np.zeros(1), overlap=sleeve_overlap(drive, part, datum))
        relief = lead_relief(drive.disc, z) if part is drive.pin_wheel else np.zeros(z.shape)
        return sliced.SeparateSlices(law=plane, length=thickness, slices=slices, relief=relief)

    flank, hole = law(contact_modulus(parts.disc, drive.flank_pin), drive.pin_wheel), law(modulus, drive.pin_shaft)
    place = geometry.placement
    if slices > 1:
        hole = sliced.back_line(hole, shaft_pin_seat(drive), place.shaft_pin_plays)
    return DiscContacts(
        geometry=replace(geometry, **tip_motion(drive)),
        pin_law=behind_wheel_pins(drive, flank, place.wheel_pin_plays, datum),
        outer_law=law(contact_modulus(parts.disc, parts.roller)),
        inner_law=law(contact_modulus(parts.inner_race, parts.roller)),
        hole_law=hole,
        kinds=replace(kinds, holes=replace(kinds.holes, contact_modulus=modulus)),
        rigid_shaft_pins=rigid_shaft_pins,
    )


def plane_strain_datum(drive: Drive) -> float:
    """Distance at which a near field in plane strain hands over to the body part, mm: it cancels against plane strain there."""
    return max(drive.disc.thickness, drive.pin_wheel.pin_radius, drive.crank_bearing.roller_radius)


def near_field_depth(drive: Drive, kind: NearField) -> float:
    """Return the depth down to which the near field of a contact over the disc's thickness counts, mm."""
    return HALF_SPACE_DATUM * drive.disc.thickness if kind == "half-space" else plane_strain_datum(drive)


@dataclass(frozen=True, slots=True, kw_only=True)
class BodyParts:
    """Yield of a disc's bodies beyond near fields: of approaches by loads, mm/N, or of tilts by moments, rad/(N·mm)."""

    coefficients: InfluenceCoefficients  # between the contacts
    alone: FloatArray  # of a pin, a roller in its bore, and a hole with the spring behind it, on the diagonal
    race: FloatArray  # between the inner contacts of the rollers, (rollers, rollers), own ones included
    unit: float  # square of the factor of tilts, mm², 1 for approaches

    @classmethod
    def of_drive(
        cls,
        drive: Drive,
        geometry: ContactGeometry,
        coefficients: InfluenceCoefficients,
        near_field: NearField,
        *,
        elastic_shaft_pins: bool,
        hole_spring: float,
        tilts: bool,
    ) -> BodyParts:
        """Return the parts of approaches by loads, or of `tilts` by moments, whose unit is 12 by the square of the length.

        With A = smooth + κ (−ln(b/2) + 1/4) of a patch, plane strain holds κ (ln(2D/b) + 1/4), so smooth − κ ln D is left;
        half-spaces hold `finite_length_approach`, of solid bodies `projected_on_half_space` with images of their ends, at the
        half-width of half the drive's load T/(e u). Of one slice comes off the difference of an aligned line to that of many.
        """
        parts, bearing, shaft, c = drive.materials, drive.crank_bearing, drive.pin_shaft, coefficients
        place, thickness, length = geometry.placement, drive.disc.thickness, drive.roller_length
        load = 0.5 * abs(drive.wheel_moment()) / (float(place.mean_eccentricity[0]) * place.reduction_ratio)
        datum, several = plane_strain_datum(drive), drive.contact.slices > 1

        def unit(material: Material, thickness: float, plane: str = "strain") -> float:
            return logarithm_factor(material, thickness, plane) * (12.0 / thickness**2 if tilts else 1.0)

        def remove(body: float, material: Material, radius: float, modulus: float, thickness: float) -> float:
            if body == 0.0:
                return 0.0
            joined = -body * np.log(datum)
            if near_field == "plane-strain":
                return float(joined)
            half_width = float(line_half_width(load / thickness, radius, modulus))
            if c.plane != SOLID:
                of_length = finite_length_approach(thickness, half_width)
            else:
                images = (FreeEnds(reach=1.0, weight=guilbault_factor(material.poisson_ratio)),)
                of_length = projected_on_half_space(thickness, half_width, images if several else ())[int(tilts)]
                if not several:
                    of_length -= redistributed_approach(thickness, half_width)
                    of_length += redistributed_approach(thickness, half_width, images)
            held = material.plane_strain_compliance * of_length
            return float(joined + unit(material, thickness) * (np.log(2.0 * datum / half_width) + SELF_ENERGY) - held)

        # Where the pitch circle cuts the flank the pins carry most.
        steep = np.array([0.25 * 2.0 * np.pi / drive.reduction_ratio])
        at_pin = (
            float(geometry.profile.effective_radius(steep, drive.pin_wheel.pin_radius)[0]),
            contact_modulus(parts.disc, drive.flank_pin),
        )
        in_bore = (
            effective_radius(bearing.roller_radius, -drive.bore_radius),
            contact_modulus(parts.disc, parts.roller),
        )
        on_race = (
            effective_radius(bearing.roller_radius, bearing.inner_race_radius),
            contact_modulus(parts.inner_race, parts.roller),
        )
        in_hole = (
            1.0 if shaft is None else effective_radius(shaft.pin_radius, -drive.hole_radius),
            hole_modulus(drive, rigid_shaft_pins=not elastic_shaft_pins),
        )
        disc, roller = c.disc_logarithm, c.roller_logarithm
        pin, outer, hole = (remove(disc, parts.disc, *at, thickness) for at in (at_pin, in_bore, in_hole))
        if drive.pin_wheel.seat.kind != "sleeve":  # whose law has all of it (`ltca.laws.backed`)
            pin += c.pin + remove(c.pin_logarithm, drive.flank_pin, *at_pin, thickness)
        if shaft is not None and elastic_shaft_pins and disc > 0.0:  # without coupling there is no body part at all
            own, nu = unit(parts.shaft_pin, thickness, c.plane), parts.shaft_pin.poisson_ratio
            hole += own * carried_cylinder(shaft.pin_radius, nu, c.plane)
            if c.plane == SOLID and shaft.beam is None:
                # On its spring it ends with the disc; as a beam it goes on.
                hole += own * free_ends_of_cylinder(shaft.pin_radius, thickness, nu)[int(tilts)]
            hole += remove(own, parts.shaft_pin, *in_hole, thickness)
        outer += float(c.roller[1, 1]) + remove(roller, parts.roller, *in_bore, length)
        inner = remove(c.race_logarithm, parts.inner_race, *on_race, thickness)
        inner += float(c.roller[0, 0]) + remove(roller, parts.roller, *on_race, length)
        race = c.race_matrix(place.roller_cage_angles, float(place.inner_race_radius))
        return cls(
            coefficients=c,
            alone=np.array((pin, outer, hole if tilts else hole + hole_spring)),
            race=race + inner * np.eye(race.shape[0]),
            unit=(0.5 * thickness) ** 2 if tilts else 1.0,
        )


def carried_cylinder(radius: float, poisson_ratio: float, plane: str = "strain") -> float:
    """Return the yield of a cylinder carried evenly by its section, in mm under the logarithm: A/κ_l + ln(b/2) − 1/4.

    Kolosov's potentials for an even body force give A = κ_l (ln(2R/b) + 1/4 − (κ + 2)/(2(κ + 1))) to (b/R)², with the logarithm's
    factor κ_l and κ = 3 − 4ν in plane strain, (3 − ν)/(1 + ν) in plane stress (docs/theory/coefficients.md).

    >>> round(carried_cylinder(1.0, 0.3), 6)
    -0.678571
    """
    nu = poisson_ratio
    kolosov = (3.0 - nu) / (1.0 + nu) if plane == "stress" else 3.0 - 4.0 * nu
    return float(np.log(radius) - 0.5 * (kolosov + 2.0) / (kolosov + 1.0))


def finite_length_approach(length: float, half_width: float) -> float:
    """Return the approach less mean separation of a straight cylinder, lengths in mm, times E/(1 − ν²) per load, 1/mm."""
    law = LineContactLaw(length, 1.0)
    # Newton's method on ln δ = ln b² + ln m(ln(δ/L²)) at a radius of 1: m = ρδ/b² goes from 0.5 to 10 over all of the law, so
    # slowly that the first guess is within its reach. (A bracketing solver of scipy takes longer to import than to search.)
    logarithm = start = 2.0 * np.log(half_width)
    for _ in range(MAX_ITERATIONS):
        ratio, slope, _ = law.table.inverse_square_half_width.value_and_derivatives(
            np.array([logarithm - 2.0 * np.log(length)])
        )
        step = (start + np.log(ratio[0]) - logarithm) / (1.0 - slope[0] / ratio[0])
        logarithm += step
        if abs(step) < 1e-12:
            break
    else:
        raise ConvergenceError(
            f"no approach of a straight cylinder of {length:g} mm has the half-width {half_width:g} mm"
        )
    approach = float(np.exp(logarithm))
    load = float(law.load_and_stiffness(approach, 1.0)[0])
    return (approach - half_width**2 / 8.0) / load


def redistributed_approach(length: float, half_width: float, free_ends: tuple[FreeEnds, ...] = ()) -> float:
    """Return how much less than under an even load an aligned line in slices approaches, times E/(1 − ν²) per load, 1/mm."""
    line = sliced.SlicedLine.straight(length, 1.0, ALIGNED_SLICES, free_ends)
    load = 0.25 * np.pi * half_width**2 * length
    even, _ = projected_on_half_space(length, half_width, free_ends)
    approach = start = even * load + half_width**2 / 8.0
    for _ in range(MAX_ITERATIONS):
        found = line.respond(np.array([approach]), np.zeros(1), np.ones(1))
        step = (load - float(found.load[0])) / float(found.by_approach[0])
        approach += step
        if abs(step) < 1e-10 * start:
            return float((start - approach) / load)
    raise ConvergenceError(f"no approach of a straight line of {length:g} mm has the half-width {half_width:g} mm")


def projected_on_half_space(
    length: float, half_width: float, free_ends: tuple[FreeEnds, ...] = ()
) -> tuple[float, float]:
    """Return the yield of a half-space under loads even, 1/t, and linear, 12 z/t³, times E/(1 − ν²), 1/mm and 1/mm³.

    Semi-elliptic over 2b across, with S_k = ⟨∫₀ᵗ s^k/√(s² + ξ²) ds⟩ of Boussinesq's kernel they are 2/(πt) (S₀ − S₁/t) and
    24/(πt³) (S₀ − 3 S₁/t + 2 S₃/t³), plus images in `free_ends` (docs/theory/solid_bodies.md).

    >>> even, linear = projected_on_half_space(10.0, 1e-6)
    >>> print(f"{0.5 * np.pi * 10.0 * even - np.log(4e7):.4f} {np.pi * 1e3 / 24.0 * linear - np.log(4e7):.4f}")
    -0.7500 -2.0833
    """
    t, b = length, half_width
    # Points of two semi-ellipses by Gauss's rule of Chebyshev polynomials of the second kind; means of odd powers of their
    # distance and of its logarithm, which that does not know, in closed form.
    angle = np.pi * np.arange(1, POINTS_ACROSS + 1) / (POINTS_ACROSS + 1)
    weight = 2.0 / (POINTS_ACROSS + 1) * np.sin(angle) ** 2
    square = b**2 * (np.cos(angle)[:, None] - np.cos(angle)) ** 2
    far = np.sqrt(t**2 + square)
    mean = np.outer(weight, weight)
    zeroth = float((mean * np.log(t + far)).sum()) - np.log(0.5 * b) + SELF_ENERGY
    first = float((mean * far).sum()) - MEAN_DISTANCE * b
    third = float((mean * (far**3 / 3.0 - square * far)).sum()) + 2.0 / 3.0 * MEAN_CUBED_DISTANCE * b**3
    even = 2.0 / (np.pi * t) * (zeroth - first / t)
    linear = 24.0 / (np.pi * t**3) * (zeroth - 3.0 * first / t + 2.0 * third / t**3)
    for each in free_ends:
        # A height and one mirrored in the end plane at s/2 from both: their sum is p = t reach − s.
        s, ds = _distances_of_images(t, each.reach)
        total = t * each.reach - s
        spread = 0.5 * (t - np.abs(total))  # half the range of the one height at a given sum
        kernel = ds * np.einsum("ij,sij->s", mean, 1.0 / np.sqrt(s[:, None, None] ** 2 + square))
        even += each.weight * 2.0 / (np.pi * t**2) * float(kernel @ (2.0 * spread))
        product = 2.0 * spread * (0.5 * total) ** 2 - 2.0 / 3.0 * spread**3
        linear += each.weight * 2.0 / np.pi * (12.0 / t**3) ** 2 * float(kernel @ product)
    return even, linear


def _distances_of_images(length: float, reach: float) -> tuple[FloatArray, FloatArray]:
    """Points and weights for distances of points of a line from images in a plane `reach` half-lengths from its middle, mm."""
    nodes, weights = np.polynomial.legendre.leggauss(8)
    nearest, middle, farthest = length * (reach - 1.0), length * reach, length * (reach + 1.0)
    grown = nearest + np.append(0.0, np.geomspace(NEAREST_IMAGE * length, length, IMAGE_PANELS))
    edges = np.append(grown, np.linspace(middle, farthest, 5)[1:])
    half = 0.5 * np.diff(edges)[:, None]
    return (edges[:-1, None] + half * (1.0 + nodes)).ravel(), (half * weights).ravel()
