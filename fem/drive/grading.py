"""The contacts to grade meshes for at a given pose, and why meshes do not serve a solution.

`fem.drive.expected_contacts` guesses pose and loads from springs; here pose and loads come from a finite-element
solution on coarser meshes, so that the final meshes are graded for the contacts that are really there. Whether the meshes
serve the solution is checked here, too.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fem.drive.contact_kinds import CONTACT_KINDS, PairKind
from fem.drive.contact_results import ContactResults, DeformedContacts
from fem.drive.expected_contacts import ContactGroup, ExpectedContacts, HertzContacts
from fem.drive.meshes import ELEMENTS_PER_HALF_WIDTH
from fem.drive.model import PlacedContacts
from fem.drive.pose import PoseSolution
from fem.drive.rigid_bodies import RigidBodies, RigidGaps
from ltca.arrays import ComplexArray, FloatArray
from ltca.drive.parts import Drive

# Contacts under this share of the largest load of their kind get elements as if they carried it.
FINE_SHARE = 0.05
# Elements may be this much larger than asked for before the meshes are graded anew.
EDGE_TOLERANCE = 1.1
# A soft disc turns and bends under its flank: the pressure then lies beside the place where the rigid bodies meet. Up to
# this part of a half-width the fine elements, which reach half a half-width further than the contact, serve it.
SHIFT_TOLERANCE = 0.25


def grade_contacts(
    drive: Drive,
    rigid: RigidBodies,
    displacement: complex,
    rotation: float,
    wheel_angle: float,
    loads: tuple[FloatArray, FloatArray, FloatArray],
    *,
    margin: float,
    smallest_share: float,
    deformed: DeformedContacts | None = None,
) -> ExpectedContacts:
    """Return the contacts to grade meshes for, with the pose of `RigidBodies.gaps` and the loads of pins, rollers and holes, N.

    A contact without load whose gap is below `margin`, mm, becomes a candidate, with elements for at least `smallest_share`
    of the largest load of its kind. Gaps and places of pressure of a `deformed` solution at this pose replace those of the
    rigid bodies where they are known and far enough from them (`SHIFT_TOLERANCE`).
    """
    gaps = rigid.gaps(displacement, rotation, wheel_angle)
    profile, place, rays = rigid.profile, rigid.placement, rigid.roller_rays()
    turn_back = np.exp(-1j * rotation)
    hertz = HertzContacts(drive=drive, rigid=rigid, smallest_share=smallest_share)
    pins, rollers, holes = loads
    pin_near, roller_near, hole_near = (
        (load > 0.0) | (gap < margin) for load, gap in zip(loads, _gaps_left(gaps, deformed), strict=True)
    )

    def pin_group(theta: FloatArray) -> ContactGroup:
        return hertz.on_flank(pins, pin_near, theta, -profile.normal(theta) * np.exp(1j * rotation))

    theta = gaps.flank_parameters
    flank_points = profile.flank(theta)
    bore_points = place.bore_centres[place.roller_cranks] + gaps.bore_points * turn_back
    hole_points = place.hole_centres + place.hole_radii * gaps.hole_directions * turn_back
    outer = hertz.on_bore(rollers, roller_near, rays)
    on_holes = hertz.in_holes(holes, hole_near, gaps.hole_directions)
    if deformed is not None:
        shifted = _is_shifted(flank_points, deformed.flank_points, pin_group(theta))
        theta = np.where(
            shifted,
            profile.nearest_point(np.where(shifted, deformed.flank_points, flank_points), theta).parameter,
            theta,
        )
        flank_points = profile.flank(theta)
        bore_points = np.where(_is_shifted(bore_points, deformed.bore_points, outer), deformed.bore_points, bore_points)
        hole_points = np.where(
            _is_shifted(hole_points, deformed.hole_points, on_holes), deformed.hole_points, hole_points
        )
    return ExpectedContacts(
        crank_angle=rigid.crank_angle,
        disc_x=displacement.real,
        disc_y=displacement.imag,
        disc_rotation=float(rotation),
        wheel_angle=float(wheel_angle),
        pins=pin_group(theta),
        flank_points=flank_points,
        rollers_outer=outer,
        rollers_inner=hertz.on_race(rollers, roller_near, -rays),
        bore_points=bore_points,
        race_points=place.inner_race_radius * rays,
        holes=on_holes,
        hole_points=hole_points,
    )


def _is_shifted(rigid: ComplexArray, deformed: ComplexArray, group: ContactGroup) -> NDArray[np.bool_]:
    """Return which contacts press so far from those of the rigid bodies that the small elements there miss them."""
    return np.asarray(np.abs(deformed - rigid) > SHIFT_TOLERANCE * group.half_width) & (group.half_width > 0.0)


def _gaps_left(gaps: RigidGaps, deformed: DeformedContacts | None) -> tuple[FloatArray, ...]:
    """Return the gaps of pins, rollers and holes: of the deformed bodies where known, else of the rigid ones."""
    rigid = (gaps.pins, gaps.rollers, gaps.holes)
    if deformed is None:
        return rigid
    known = (deformed.pin_gaps, deformed.roller_gaps, deformed.hole_gaps)
    return tuple(np.where(np.isnan(gap), plain, gap) for gap, plain in zip(known, rigid, strict=True))


def find_shortcoming(
    model: PlacedContacts, solution: PoseSolution, results: ContactResults, size: float = np.inf
) -> str:
    """Return why the meshes do not serve a solution with these contacts, "" when they do.

    Elements are measured against those of `size`, a multiple of the default edge; at infinity any will do.
    """
    for pair, detail in zip(model.pairs, results.details, strict=True):
        own = solution.contact.pressure[pair.unknowns].reshape(-1, pair.heights)
        name = CONTACT_KINDS[pair.kind].name_of(pair.index, model.placement)
        if np.any(own[[0, -1]] > 0.0):
            return f"the pressure of {name} reaches the end of its zone"
        if (
            detail.share > FINE_SHARE
            and detail.largest_edge > EDGE_TOLERANCE * size * detail.half_width / ELEMENTS_PER_HALF_WIDTH
        ):
            return (
                f"{detail.half_width / detail.largest_edge:.3g} elements for the half-width of {name}, "
                f"not {ELEMENTS_PER_HALF_WIDTH / size:.3g}"
            )
    return closed_without_zone(model, solution)


def closed_without_zone(model: PlacedContacts, solution: PoseSolution) -> str:
    """Return which contact without a zone the deformed disc has closed at mid-width, "" for none."""
    pose, place = solution.pose, model.placement
    flank_profile = model.shapes.disc.flank.profile
    rigid = RigidBodies(profile=flank_profile, placement=place, crank_angle=model.crank_angle)
    rigid = rigid.moved(*pose.displacements)
    gaps = rigid.gaps(pose.disc_displacement, pose.disc_rotation, pose.wheel_angle)
    turn = np.exp(1j * pose.disc_rotation)
    rays = model.roller_rays
    flank = flank_profile.flank(gaps.flank_parameters)
    bore = place.bore_centres[place.roller_cranks] + place.bore_radius * rays / turn
    holes = place.hole_centres + place.hole_radii * gaps.hole_directions / turn
    candidates = {(pair.kind, pair.index) for pair in model.pairs}
    kinds: dict[PairKind, tuple[FloatArray, ComplexArray, ComplexArray]] = {
        "pin": (gaps.pins, flank, gaps.pin_normals),
        "roller_outer": (gaps.rollers, bore, -rays),
        "hole": (gaps.holes, holes, -gaps.hole_directions),
    }
    names = [(kind, index) for kind, (gap, _, _) in kinds.items() for index in range(gap.size)]
    others = [number for number, name in enumerate(names) if name not in candidates]
    if not others:
        return ""
    gap, points, normals = (np.concatenate(each)[others] for each in zip(*kinds.values(), strict=True))
    moved = turn * model.wall_displacements(points, solution.contact.pressure)
    left = gap - (moved * normals.conjugate()).real
    for number, remaining in zip(others, left.tolist(), strict=True):
        if remaining < 0.0:
            kind, index = names[number]
            name = CONTACT_KINDS[kind].name_of(index, place)
            return f"{name} closes by {-1e3 * remaining:.3g} µm and has no contact zone"
    return ""
