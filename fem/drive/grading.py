"""Where the contacts of rigid bodies lie at a given pose, how far open they are, and how to grade meshes for them.

`fem.drive.expected_contacts` guesses pose and loads from springs; here pose and loads come from a finite-element
solution on coarser meshes, so that the final meshes are graded for the contacts that are really there. What those do
not serve after all is found here, too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fem.drive.contact_results import DeformedContacts, summarise_contacts
from fem.drive.expected_contacts import ContactGroup, ExpectedContacts, bore_displacements, on_turned_flank
from fem.drive.meshes import ELEMENTS_PER_HALF_WIDTH
from fem.drive.model import DriveModel
from fem.drive.pose import PoseSolution
from ltca.arrays import ComplexArray, FloatArray
from ltca.drive.hole_contact import hole_modulus, shaft_pins_yield
from ltca.drive.parts import Drive, contact_modulus
from ltca.geometry.flank import FlankProfile
from ltca.geometry.placement import Placement

# Contacts under this share of the largest load of their kind get elements as if they carried it (design.md: 5 %).
FINE_SHARE = 0.05
# Elements may be this much larger than asked for before the meshes are graded anew.
SLACK = 1.1
# A soft disc turns and bends under its flank: the pressure then lies beside the place where the rigid bodies meet. Up to
# this part of a half-width the fine elements, which reach half a half-width further than the contact, serve it there.
SHIFT = 0.25


@dataclass(frozen=True, slots=True, kw_only=True)
class RigidGaps:
    """Contacts of rigid bodies at a pose; arrays over pins, rollers, holes.

    Attributes
    ----------
    pins, rollers, holes : array of float
        Gap, mm, negative where the rigid bodies overlap; that of a roller is its play along the cage ray.
    flank_parameters : array of float, shape (z_P,)
        θ of the contact points.
    pin_normals : array of complex, shape (z_P,)
        Out of the disc, fixed axes.
    hole_directions : array of complex, shape (z_PS,)
        From the hole centre to the contact, fixed axes.
    """

    pins: FloatArray
    rollers: FloatArray
    holes: FloatArray
    flank_parameters: FloatArray
    pin_normals: ComplexArray
    hole_directions: ComplexArray


def measure_gaps(
    drive: Drive, crank_angle: float, displacement: complex, rotation: float, wheel_angle: float
) -> RigidGaps:
    """Measure all gaps between rigid bodies.

    Parameters
    ----------
    drive : Drive
        The drive in one case.
    crank_angle : float
        φ_C, rad.
    displacement : complex
        Of the disc from its nominal place, fixed axes, mm.
    rotation, wheel_angle : float
        Of the disc, and of the wheel beyond φ_C/u, rad.

    Returns
    -------
    RigidGaps
        Exact, from flank and circles.
    """
    profile, place = FlankProfile.of_drive(drive), Placement.of_drive(drive)
    turn, wheel = np.exp(1j * rotation), crank_angle / place.reduction_ratio + wheel_angle
    centre = complex(place.race_centre(np.asarray(crank_angle))) + displacement
    pins = (place.wheel_pin_centres * np.exp(1j * wheel) - centre) / turn
    start = np.angle(place.wheel_pin_centres) + wheel - rotation
    theta = profile.nearest_parameter(pins, on_turned_flank(profile, start))
    rays = np.exp(1j * place.roller_angles(np.asarray(crank_angle)))
    reach = _reach_to_bore(_of_rollers(place, crank_angle, displacement, rotation), place, rays)
    holes = place.shaft_pin_centres - (centre + place.hole_centres * turn)
    return RigidGaps(
        pins=profile.distance(pins, theta) - place.wheel_pin_radii,
        rollers=reach - place.roller_radii - place.inner_race_radius,
        holes=place.hole_radii - place.shaft_pin_radii - np.abs(holes),
        flank_parameters=theta,
        pin_normals=profile.normal(theta) * turn,
        hole_directions=holes / np.maximum(np.abs(holes), 1e-300),
    )


def grade_contacts(
    drive: Drive,
    crank_angle: float,
    displacement: complex,
    rotation: float,
    wheel_angle: float,
    loads: tuple[FloatArray, FloatArray, FloatArray],
    *,
    margin: float,
    smallest_share: float,
    deformed: DeformedContacts | None = None,
) -> ExpectedContacts:
    """Return the contacts to grade meshes for.

    Parameters
    ----------
    drive, crank_angle, displacement, rotation, wheel_angle
        As for `measure_gaps`.
    loads : tuple of three arrays
        Loads of pins, rollers and holes, N; zero where open.
    margin : float
        A contact without load whose gap is below this becomes a candidate, mm.
    smallest_share : float
        Candidates get elements for at least this share of the largest load of their kind.
    deformed : DeformedContacts, optional
        Gaps and places of pressure of a solution at this pose: they count, where known and far enough from those of the
        rigid bodies (`SHIFT`).

    Returns
    -------
    ExpectedContacts
        With this pose and these loads.
    """
    gaps = measure_gaps(drive, crank_angle, displacement, rotation, wheel_angle)
    profile, place = FlankProfile.of_drive(drive), Placement.of_drive(drive)
    materials, thickness = drive.materials, drive.disc.thickness
    rays = np.exp(1j * place.roller_angles(np.asarray(crank_angle)))
    bore, race, radius = place.bore_radius, place.inner_race_radius, place.roller_radii
    turn_back = np.exp(-1j * rotation)

    pin_gaps, roller_gaps, hole_gaps = _gaps_left(gaps, deformed)

    def group(
        load: FloatArray, gap: FloatArray, effective: FloatArray, modulus: float, direction: ComplexArray
    ) -> ContactGroup:
        return ContactGroup.of_loads(
            load,
            (load > 0.0) | (gap < margin),
            direction,
            smallest_share=smallest_share,
            length=thickness,
            effective_radius=effective,
            modulus=modulus,
        )

    hole_effective = place.shaft_pin_radii * place.hole_radii / (place.hole_radii - place.shaft_pin_radii)
    outer_effective, inner_effective = radius * bore / (bore - radius), radius * race / (race + radius)
    pin_modulus = contact_modulus(materials.disc, materials.wheel_pin)
    outer_modulus = contact_modulus(materials.disc, materials.roller)
    inner_modulus = contact_modulus(materials.inner_race, materials.roller)
    pins, rollers, holes = loads
    at_hole = hole_modulus(drive, rigid_shaft_pins=not shaft_pins_yield(drive))

    def pin_group(theta: FloatArray) -> ContactGroup:
        effective = profile.effective_radius(theta, place.wheel_pin_radii)
        return group(pins, pin_gaps, effective, pin_modulus, -profile.normal(theta) * np.exp(1j * rotation))

    theta = gaps.flank_parameters
    flank_points = profile.flank(theta)
    bore_points = (
        place.bore_centres[place.roller_cranks]
        + _bore_points(_of_rollers(place, crank_angle, displacement, rotation), place, rays) * turn_back
    )
    hole_points = place.hole_centres + place.hole_radii * gaps.hole_directions * turn_back
    outer = group(rollers, roller_gaps, outer_effective, outer_modulus, rays)
    on_holes = group(holes, hole_gaps, hole_effective, at_hole, gaps.hole_directions)
    if deformed is not None:
        shifted = _is_shifted(flank_points, deformed.flank_points, pin_group(theta))
        theta = np.where(
            shifted, profile.nearest_parameter(np.where(shifted, deformed.flank_points, flank_points), theta), theta
        )
        flank_points = profile.flank(theta)
        bore_points = np.where(_is_shifted(bore_points, deformed.bore_points, outer), deformed.bore_points, bore_points)
        hole_points = np.where(
            _is_shifted(hole_points, deformed.hole_points, on_holes), deformed.hole_points, hole_points
        )
    return ExpectedContacts(
        crank_angle=float(crank_angle),
        disc_x=displacement.real,
        disc_y=displacement.imag,
        disc_rotation=float(rotation),
        wheel_angle=float(wheel_angle),
        pins=pin_group(theta),
        flank_points=flank_points,
        rollers_outer=outer,
        rollers_inner=group(rollers, roller_gaps, inner_effective, inner_modulus, -rays),
        bore_points=bore_points,
        race_points=race * rays,
        holes=on_holes,
        hole_points=hole_points,
    )


def _is_shifted(rigid: ComplexArray, deformed: ComplexArray, group: ContactGroup) -> NDArray[np.bool_]:
    """Return which contacts press so far from where the rigid bodies would that small elements there miss them."""
    return np.asarray(np.abs(deformed - rigid) > SHIFT * group.half_width) & (group.half_width > 0.0)


def _gaps_left(gaps: RigidGaps, deformed: DeformedContacts | None) -> tuple[FloatArray, ...]:
    """Return the gaps of pins, rollers and holes: those known of the deformed bodies, else those of the rigid ones."""
    rigid = (gaps.pins, gaps.rollers, gaps.holes)
    if deformed is None:
        return rigid
    known = (deformed.pin_gaps, deformed.roller_gaps, deformed.hole_gaps)
    return tuple(np.where(np.isnan(gap), plain, gap) for gap, plain in zip(known, rigid, strict=True))


def _of_rollers(place: Placement, crank_angle: float, displacement: complex, rotation: float) -> ComplexArray:
    """Return the displacement of each roller's bore from the inner race in it, mm."""
    return bore_displacements(place, crank_angle, displacement, rotation)[place.roller_cranks]


def _bore_points(displacement: ComplexArray, place: Placement, rays: ComplexArray) -> ComplexArray:
    """Return where rollers that touch their bore touch it, about the bore centre, fixed axes, mm."""
    from_bore_centre = _reach_to_bore(displacement, place, rays) * rays - displacement
    return np.asarray(place.bore_radius * from_bore_centre / np.abs(from_bore_centre))


def _reach_to_bore(displacement: ComplexArray, place: Placement, rays: ComplexArray) -> FloatArray:
    """Return how far out along its cage ray the centre of each roller stands when it touches its bore, mm."""
    inward = (displacement * rays.conjugate()).real
    across = (displacement * rays.conjugate()).imag
    return np.asarray(inward + np.sqrt((place.bore_radius - place.roller_radii) ** 2 - across**2))


def find_shortcoming(model: DriveModel, solution: PoseSolution, scale: float) -> str:
    """Return why the meshes do not serve a solution, "" when they do."""
    results = summarise_contacts(model, solution)
    for pair, detail in zip(model.pairs, results.details, strict=True):
        own = solution.contact.pressure[pair.unknowns]
        name = f"{pair.kind.replace('_', ' ')} {pair.index}"
        if own[0] > 0.0 or own[-1] > 0.0:
            return f"the pressure of {name} reaches the end of its zone"
        if (
            detail.share > FINE_SHARE
            and detail.largest_edge > SLACK * scale * detail.half_width / ELEMENTS_PER_HALF_WIDTH
        ):
            return (
                f"{detail.half_width / detail.largest_edge:.3g} elements for the half-width of {name}, "
                f"not {ELEMENTS_PER_HALF_WIDTH / scale:.3g}"
            )
    return _closed_without_zone(model, solution)


def _closed_without_zone(model: DriveModel, solution: PoseSolution) -> str:
    pose, place = solution.pose, model.placement
    gaps = measure_gaps(model.drive, model.crank_angle, pose.disc_displacement, pose.disc_rotation, pose.wheel_angle)
    elastic = model.disc.displacement(solution.contact.pressure[: model.disc.compliance.shape[0]])
    moved = (elastic[0::2] + 1j * elastic[1::2]) * np.exp(1j * pose.disc_rotation)
    nodes = model.meshes.disc.mesh.doflocs[0] + 1j * model.meshes.disc.mesh.doflocs[1]
    turn = np.exp(1j * pose.disc_rotation)
    rays = model.roller_rays
    flank = model.shapes.disc.flank.profile.flank(gaps.flank_parameters)
    bore = place.bore_centres[place.roller_cranks] + place.bore_radius * rays / turn
    holes = place.hole_centres + place.hole_radii * gaps.hole_directions / turn
    candidates = {(pair.kind, pair.index) for pair in model.pairs}
    for kind, gap, points, normals in (
        ("pin", gaps.pins, flank, gaps.pin_normals),
        ("roller_outer", gaps.rollers, bore, -rays),
        ("hole", gaps.holes, holes, -gaps.hole_directions),
    ):
        for index in range(len(gap)):
            if (kind, index) in candidates:
                continue
            nearest = int(np.argmin(np.abs(nodes - points[index])))
            left = gap[index] - (moved[nearest] * np.conj(normals[index])).real
            if left < 0.0:
                return f"{kind.replace('_outer', '')} {index} closes by {-1e3 * left:.3g} µm and has no contact zone"
    return ""
