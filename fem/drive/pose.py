"""Iteration of the pose of all discs: contact solved about the pose of the bodies, bodies moved there, gaps rebuilt.

The pressures of all discs are unknowns of one contact problem: discs turn one wheel, and their forces meet in what holds pins.

Displacements are small about the *loaded* pose; about the nominal one the gaps would be wrong by as much as
the approaches themselves. The rigid increments of a converged pose are zero, so that the answer does not
depend on the start.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
import scipy.linalg as sla
from numpy.typing import NDArray

from fem.contact.coupling import PairIntegrals
from fem.contact.unilateral import ContactProblem, ContactSolution, solve_floating_contact
from fem.drive.model import DrivePose, PlacedContacts
from fem.drive.supports import Supports
from ltca.arrays import ComplexArray, FloatArray
from ltca.drive.parts import Drive
from ltca.errors import ConvergenceError

# Well below the accuracy wanted, 0.5 µm and 0.1 %: one more step of a linearly converging iteration takes a tenth of a second.
POSE_TOLERANCE = 5.0e-5
LOAD_TOLERANCE = 2.0e-4
# Farthest a body may travel in one step, mm: normals are those of the old pose.
MAX_STEP = 0.05
# Largest change of the moment on a held wheel in the last step, by itself.
MOMENT_TOLERANCE = 1e-8
# Place of the rotation of the wheel among the motions of a disc.
WHEEL = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class WheelLoad:
    """External moment on the wheel, ccw positive.

    Attributes
    ----------
    moment : float
        N·mm; of a held wheel a first estimate.
    output : float or None
        Torque on the output, ccw positive, N·mm, that a held wheel and the input balance; None where `moment` is given.
    input_per_crank_moment : float
        Moment of the input by that of the cranks.
    """

    moment: float
    output: float | None = None
    input_per_crank_moment: float = 0.0

    @classmethod
    def of_drive(cls, drive: Drive, torque: float | None = None, moment: float | None = None) -> WheelLoad:
        """Return the load of a drive at an output torque, its own by default, whichever member is held."""
        estimate = drive.wheel_moment(torque) if moment is None else moment
        if not drive.wheel_is_held:
            return cls(moment=estimate)
        output = drive.driving_sign * (drive.load.torque if torque is None else torque)
        return cls(moment=estimate, output=output, input_per_crank_moment=drive.input_per_crank_moment)

    def balanced_by(self, crank_moment: float) -> float:
        """Return the moment on the wheel where cranks are held by a moment, N·mm."""
        return self.moment if self.output is None else -self.output - self.input_per_crank_moment * crank_moment


@dataclass(frozen=True, slots=True, kw_only=True)
class PoseSolution:
    """Contact solution at the loaded pose that belongs to it.

    Attributes
    ----------
    pose : DrivePose
        Of the rigid bodies.
    contact : ContactSolution
        Pressures and gaps.
    integrals : tuple of PairIntegrals
        Of all pairs at that pose.
    wheel_moment : float
        External moment on the wheel that the disc carries, N·mm.
    iterations : int
        Pose steps.
    increments : tuple of float
        Largest rigid increment of each step, mm.
    load_changes : tuple of float
        Largest change of a load in each step relative to the largest load.
    """

    pose: DrivePose
    contact: ContactSolution
    integrals: tuple[PairIntegrals, ...]
    wheel_moment: float
    iterations: int
    increments: tuple[float, ...]
    load_changes: tuple[float, ...]


def pair_forces(model: PlacedContacts, integrals: Sequence[PairIntegrals], pressure: FloatArray) -> FloatArray:
    """Return force (x, y, N) and moment about the origin (N·mm) on the round side of each pair, shape (pairs, 3)."""
    return np.array(
        [model.force_of(pair, integral, pressure) for pair, integral in zip(model.pairs, integrals, strict=True)]
    )


def moment_about(place: complex, force: FloatArray) -> float:
    """Return the moment about a place of a force (x, y, N) with its moment about the origin, N·mm."""
    return float(force[2] - place.real * force[1] + place.imag * force[0])


def moments_on_cranks(model: PlacedContacts, forces: FloatArray) -> FloatArray:
    """Return the external moment that holds each crank, ccw positive, N·mm, by `pair_forces`, shape (cranks,).

    That of its rollers' forces on the disc about the crank's axis, as if they acted at the centre of the race, and by the
    part `cage_speed` of the crank's angle what they take of the cage: their moment about that centre.
    """
    place = model.placement
    on_disc = np.zeros((place.cranks, 3))
    for pair, force in zip(model.pairs, forces, strict=True):
        if pair.kind == "roller_outer":
            on_disc[model.crank_of(pair.index)] -= force
    push, races = on_disc[:, 0] + 1j * on_disc[:, 1], model.race_centres
    about_race = on_disc[:, 2] - (races.conjugate() * push).imag
    lever = races - place.crank_axes
    return np.asarray((lever.conjugate() * push).imag + float(place.cage_speed) * about_race)


def joint_problem(
    models: Sequence[PlacedContacts],
    supports: Supports,
    poses: Sequence[DrivePose],
    integrals: Sequence[list[PairIntegrals]],
    wheel_moment: float,
) -> ContactProblem:
    """Return the contact problem of all discs about their poses; motions: of the first, then of others without the wheel's."""
    problems = [
        model.contact_problem(pose, each, wheel_moment)
        for model, pose, each in zip(models, poses, integrals, strict=True)
    ]
    gap = np.concatenate([problem.gap for problem in problems])
    compliance, motions, external = problems[0].compliance, problems[0].motions, problems[0].external
    if len(problems) > 1:
        places = _motions(models)
        compliance = np.zeros((gap.size, gap.size))
        motions, external = np.zeros((gap.size, int(places[-1].max()) + 1)), np.zeros(int(places[-1].max()) + 1)
        for own, columns, problem in zip(_unknowns(models), places, problems, strict=True):
            compliance[own, own] = problem.compliance
            motions[own, columns] = problem.motions
            external[columns] = problem.external
    forces = [_by_pressures(model, pose, each) for model, pose, each in zip(models, poses, integrals, strict=True)]
    on_wheel, on_shaft, on_cranks = (sla.block_diag(*each) for each in zip(*forces, strict=True))
    at_shaft = [pose.shaft_pin_displacements for pose in poses] + [pose.crank_displacements for pose in poses]
    for flexibility, force, moved in (
        (supports.wheel, on_wheel, [pose.wheel_pin_displacements for pose in poses]),
        (supports.shaft, np.vstack((on_shaft, on_cranks)), at_shaft),
    ):
        if flexibility is None:
            continue
        here = np.concatenate(moved)
        gap = gap - force.T @ np.column_stack([here.real, here.imag]).ravel()
        # Some contacts press nothing that yields.
        yields = np.any(flexibility != 0.0, axis=0)
        pressed = np.flatnonzero(np.any(force[yields] != 0.0, axis=0))
        along = force[:, pressed]
        compliance[np.ix_(pressed, pressed)] += along.T @ flexibility @ along
    return ContactProblem(compliance=compliance, gap=gap, motions=motions, external=external)


def _unknowns(models: Sequence[PlacedContacts]) -> list[slice]:
    """Pressure unknowns of every disc among those of all."""
    ends = np.cumsum([0, *(model.unknown_count for model in models)]).tolist()
    return [slice(first, last) for first, last in pairwise(ends)]


def _motions(models: Sequence[PlacedContacts]) -> list[NDArray[np.intp]]:
    """Place of every motion of every disc among those of all: the wheel's stands with the first."""
    places = [np.arange(models[0].motion_count)]
    last = models[0].motion_count
    for model in models[1:]:
        own = np.arange(last, last + model.motion_count - 1)
        places.append(np.insert(own, WHEEL, WHEEL))
        last += own.size
    return places


def solve_pose(
    model: PlacedContacts, wheel_moment: float, *, start: DrivePose | None = None, **options: Any
) -> PoseSolution:
    """Solve contact and pose of one disc under a moment on the wheel, N·mm; further arguments as for `solve_poses`."""
    supports, load = Supports.of_drive(model.drive), WheelLoad(moment=wheel_moment)
    (found,) = solve_poses((model,), supports, load, None if start is None else (start,), **options)
    return found


def solve_poses(
    models: Sequence[PlacedContacts],
    supports: Supports,
    load: WheelLoad,
    starts: Sequence[DrivePose] | None = None,
    *,
    start_active: NDArray[np.bool_] | None = None,
    limit: int = 60,
    pose_tolerance: float = POSE_TOLERANCE,
    progress: Callable[[str], None] | None = None,
) -> tuple[PoseSolution, ...]:
    """Solve contact and poses of all discs together.

    Parameters
    ----------
    models : sequence of PlacedContacts
        Condensed discs with their pins and rollers.
    supports : Supports
        What holds the pins.
    load : WheelLoad
        Moment on the wheel, or what a held wheel balances.
    starts : sequence of DrivePose, optional
        First poses, at one wheel angle; those the meshes were graded for by default.
    start_active : array of bool, optional
        First active set, disc after disc.
    limit : int
        Pose steps.
    pose_tolerance : float
        Largest rigid increment of a converged pose, mm.
    progress : callable, optional
        Called with one line for each step.

    Returns
    -------
    tuple of PoseSolution
        Of every disc, converged to that tolerance and `LOAD_TOLERANCE`.

    Raises
    ------
    ConvergenceError
        When poses or contact do not settle, or nothing can carry the load.
    """
    poses = [model.start_pose() for model in models] if starts is None else list(starts)
    poses = _at_one_wheel(poses)
    active = np.concatenate([model.start_active() for model in models]) if start_active is None else start_active
    increments: list[float] = []
    changes: list[float] = []
    loads = np.zeros(sum(len(model.pairs) for model in models))
    moment = load.moment
    for iteration in range(1, limit + 1):
        integrals = [
            [model.integrate(pair, pose) for pair in model.pairs] for model, pose in zip(models, poses, strict=True)
        ]
        problem = joint_problem(models, supports, poses, integrals, moment)
        contact = solve_floating_contact(problem, active)
        parts = _by_disc(models, contact)
        forces = [
            pair_forces(model, each, part.pressure) for model, each, part in zip(models, integrals, parts, strict=True)
        ]
        size = np.concatenate([np.hypot(each[:, 0], each[:, 1]) for each in forces])
        previous, loads = loads, size
        following, increment = _move(models, supports, poses, integrals, parts)
        increments.append(increment)
        changes.append(float(np.max(np.abs(loads - previous)) / np.max(loads)))
        held_by = load.balanced_by(
            float(sum(moments_on_cranks(model, each).sum() for model, each in zip(models, forces, strict=True)))
        )
        off = abs(held_by - moment)
        if progress is not None:
            progress(
                f"pose {iteration}: increment {1e3 * increment:.3g} µm, loads changed by {100 * changes[-1]:.2g} %, "
                f"{contact.iterations} active-set steps"
            )
        if increment < pose_tolerance and changes[-1] < LOAD_TOLERANCE and off <= MOMENT_TOLERANCE * abs(moment):
            carried = [moment]
            if len(models) > 1:
                carried = [_wheel_moment(model, each) for model, each in zip(models, forces, strict=True)]
            return tuple(
                PoseSolution(
                    pose=pose,
                    contact=part,
                    integrals=tuple(each),
                    wheel_moment=by_disc,
                    iterations=iteration,
                    increments=tuple(increments),
                    load_changes=tuple(changes),
                )
                for pose, part, each, by_disc in zip(following, parts, integrals, carried, strict=True)
            )
        poses, active, moment = following, contact.active, held_by
    raise ConvergenceError(
        f"the loaded pose at crank angle {models[0].crank_angle:g} rad did not settle in {limit} steps; increments in mm",
        increments,
    )


def _at_one_wheel(poses: Sequence[DrivePose]) -> list[DrivePose]:
    """The poses with the wheel where it stands in the mean."""
    if len(poses) == 1:
        return list(poses)
    angle = float(np.mean([pose.wheel_angle for pose in poses]))
    return [replace(pose, wheel_angle=angle) for pose in poses]


def _wheel_moment(model: PlacedContacts, forces: FloatArray) -> float:
    """External moment on the wheel against the forces of a disc, about its axis, N·mm."""
    of_pins = sum(force for pair, force in zip(model.pairs, forces, strict=True) if pair.kind == "pin")
    return -float(moment_about(complex(model.placement.wheel_axis), np.asarray(of_pins)))


def _by_disc(models: Sequence[PlacedContacts], found: ContactSolution) -> list[ContactSolution]:
    """The solution of every disc, with the motion of the wheel among its own."""
    if len(models) == 1:
        return [found]
    return [
        replace(
            found,
            pressure=found.pressure[own],
            motion=found.motion[columns],
            opening=found.opening[own],
            active=found.active[own],
        )
        for own, columns in zip(_unknowns(models), _motions(models), strict=True)
    ]


def _move(
    models: Sequence[PlacedContacts],
    supports: Supports,
    poses: Sequence[DrivePose],
    integrals: Sequence[Sequence[PairIntegrals]],
    contacts: Sequence[ContactSolution],
) -> tuple[list[DrivePose], float]:
    """Return the poses found and the largest increment, mm."""
    motions, largest = [], 0.0
    for model, contact in zip(models, contacts, strict=True):
        # Further motions are tilts: gaps are linear in them, each step finds all of them anew.
        motion = contact.motion[: 4 + len(model.rollers)]
        reach = np.ones(len(motion))
        reach[2] = model.shapes.disc.flank.profile.tip_radius
        reach[WHEEL] = float(np.abs(model.placement.wheel_pin_centres).max())
        largest = max(largest, float(np.max(np.abs(motion * reach))))
        motions.append(motion)
    part = min(1.0, MAX_STEP / largest) if largest > 0.0 else 1.0
    increment, found = largest, []
    moved = supports.moved(*forces_on_supports(models, poses, integrals, [each.pressure for each in contacts]))
    for model, pose, motion, seats, pins, cranks in zip(models, poses, motions, *moved, strict=True):
        change = np.concatenate(
            [
                pins - pose.shaft_pin_displacements,
                seats - pose.wheel_pin_displacements,
                cranks - pose.crank_displacements,
            ]
        )
        increment = max(increment, float(np.max(np.abs(change), initial=0.0)))
        distances = pose.roller_distances.copy()
        distances[list(model.rollers)] += part * motion[4:]
        found.append(
            DrivePose(
                disc_x=pose.disc_x + part * float(motion[0]),
                disc_y=pose.disc_y + part * float(motion[1]),
                disc_rotation=pose.disc_rotation + part * float(motion[2]),
                wheel_angle=pose.wheel_angle + part * float(motion[WHEEL]),
                roller_distances=distances,
                shaft_pin_displacements=pins,
                wheel_pin_displacements=seats,
                crank_displacements=cranks,
            )
        )
    return found, increment


def forces_on_supports(
    models: Sequence[PlacedContacts],
    poses: Sequence[DrivePose],
    integrals: Sequence[Sequence[PairIntegrals]],
    pressures: Sequence[FloatArray],
) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """Return the forces on wheel pins, in the wheel, shaft pins and cranks by the pressures of all discs, N, (discs, parts)."""
    discs = zip(models, poses, integrals, pressures, strict=True)
    found = [[on @ own for on in _by_pressures(model, pose, each)] for model, pose, each, own in discs]
    wheel, shaft, cranks = (np.array(each)[:, 0::2] + 1j * np.array(each)[:, 1::2] for each in zip(*found, strict=True))
    return wheel, shaft, cranks


def _by_pressures(
    model: PlacedContacts, pose: DrivePose, integrals: Sequence[PairIntegrals]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """x, y of the forces of a disc on wheel pins, in the wheel, shaft pins and cranks by its pressures, N/MPa, (2 parts, m)."""
    place, in_wheel = model.placement, model.wheel_direction(pose).conjugate()
    counts = len(place.wheel_pin_radii), len(place.hole_radii), place.cranks
    on_wheel, on_shaft, on_cranks = (np.zeros((2 * count, model.unknown_count)) for count in counts)
    for pair, integral in zip(model.pairs, integrals, strict=True):
        if pair.kind == "roller_inner":  # the crank carries roller and race with it
            continue
        fx, fy, _ = model.resultants_of(pair, integral)
        along, rows, index = fx + 1j * fy, on_shaft, pair.index
        if pair.kind == "pin":
            along, rows = along * in_wheel, on_wheel
        elif pair.kind == "roller_outer":
            rows, index = on_cranks, model.crank_of(pair.index)
        rows[2 * index, pair.unknowns], rows[2 * index + 1, pair.unknowns] = along.real, along.imag
    return on_wheel, on_shaft, on_cranks
