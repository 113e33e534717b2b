"""Iteration of the pose: contact solved about the pose of the bodies, bodies moved there, gaps rebuilt.

Displacements are small about the *loaded* pose; about the nominal one the gaps would be wrong by as much as
the approaches themselves. The rigid increments of a converged pose are zero, so that the answer does not
depend on the start.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fem.contact.coupling import PairIntegrals
from fem.contact.unilateral import ContactSolution, solve_floating_contact
from fem.drive.model import DrivePose, PlacedContacts
from ltca.arrays import FloatArray
from ltca.errors import ConvergenceError

# Well below the accuracy wanted, 0.5 µm and 0.1 %: one more step of a linearly converging iteration takes a tenth of a second.
POSE_TOLERANCE = 5.0e-5
LOAD_TOLERANCE = 2.0e-4
# Farthest a body may travel in one step, mm: normals are those of the old pose.
MAX_STEP = 0.05


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
        External moment on the wheel, N·mm.
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


def pair_forces(model: PlacedContacts, integrals: list[PairIntegrals], pressure: FloatArray) -> FloatArray:
    """Return force (x, y, N) and moment about the origin (N·mm) on the round side of each pair, shape (pairs, 3)."""
    return np.array(
        [model.force_of(pair, integral, pressure) for pair, integral in zip(model.pairs, integrals, strict=True)]
    )


def solve_pose(
    model: PlacedContacts,
    wheel_moment: float,
    *,
    start: DrivePose | None = None,
    start_active: NDArray[np.bool_] | None = None,
    limit: int = 60,
    pose_tolerance: float = POSE_TOLERANCE,
    progress: Callable[[str], None] | None = None,
) -> PoseSolution:
    """Solve contact and pose together.

    Parameters
    ----------
    model : PlacedContacts
        Condensed drive.
    wheel_moment : float
        External moment on the wheel, N·mm, ccw positive.
    start : DrivePose, optional
        First pose; the one the meshes were graded for by default.
    start_active : array of bool, optional
        First active set.
    limit : int
        Pose steps.
    pose_tolerance : float
        Largest rigid increment of a converged pose, mm.
    progress : callable, optional
        Called with one line for each step.

    Returns
    -------
    PoseSolution
        Converged to that tolerance and `LOAD_TOLERANCE`.

    Raises
    ------
    ConvergenceError
        When pose or contact do not settle, or nothing can carry the load.
    """
    pose = model.start_pose() if start is None else start
    active = model.start_active() if start_active is None else start_active
    increments: list[float] = []
    changes: list[float] = []
    loads = np.zeros(len(model.pairs))
    for iteration in range(1, limit + 1):
        integrals = [model.integrate(pair, pose) for pair in model.pairs]
        problem = model.contact_problem(pose, integrals, wheel_moment)
        contact = solve_floating_contact(problem, active)
        forces = pair_forces(model, integrals, contact.pressure)
        previous, loads = loads, np.hypot(forces[:, 0], forces[:, 1])
        following, increment = _move(model, pose, contact, forces)
        increments.append(increment)
        changes.append(float(np.max(np.abs(loads - previous)) / np.max(loads)))
        if progress is not None:
            progress(
                f"pose {iteration}: increment {1e3 * increment:.3g} µm, loads changed by {100 * changes[-1]:.2g} %, "
                f"{contact.iterations} active-set steps"
            )
        if increment < pose_tolerance and changes[-1] < LOAD_TOLERANCE:
            return PoseSolution(
                pose=following,
                contact=contact,
                integrals=tuple(integrals),
                wheel_moment=wheel_moment,
                iterations=iteration,
                increments=tuple(increments),
                load_changes=tuple(changes),
            )
        pose, active = following, contact.active
    raise ConvergenceError(
        f"the loaded pose at crank angle {model.crank_angle:g} rad did not settle in {limit} steps; increments in mm",
        increments,
    )


def _move(
    model: PlacedContacts,
    pose: DrivePose,
    contact: ContactSolution,
    forces: FloatArray,
) -> tuple[DrivePose, float]:
    """Return the pose found and the largest increment, mm."""
    # Further motions are tilts: gaps are linear in them, each step finds all of them anew.
    motion = contact.motion[: 4 + len(model.rollers)].copy()
    shapes = model.shapes
    reach = np.ones(len(motion))
    reach[2] = shapes.disc.flank.profile.tip_radius
    reach[3] = float(np.abs(model.placement.wheel_pin_centres).max())
    largest = float(np.max(np.abs(motion * reach)))
    motion *= min(1.0, MAX_STEP / largest) if largest > 0.0 else 1.0
    distances = pose.roller_distances.copy()
    for column, roller in enumerate(model.rollers, start=4):
        distances[roller] += motion[column]
    pins, on_seats = np.zeros_like(pose.shaft_pin_displacements), np.zeros_like(pose.wheel_pin_displacements)
    in_wheel = model.wheel_direction(pose).conjugate()
    for pair, force in zip(model.pairs, forces, strict=True):
        if pair.kind == "hole":
            pins[pair.index] = complex(force[0], force[1]) / model.drive.hole_stiffness
        elif pair.kind == "pin":
            on_seats[pair.index] = complex(force[0], force[1]) * in_wheel
    seats = model.by_others + model.seats_moved_by(on_seats)
    change = np.concatenate([pins - pose.shaft_pin_displacements, seats - pose.wheel_pin_displacements])
    increment = max(largest, float(np.max(np.abs(change), initial=0.0)))
    moved = DrivePose(
        disc_x=pose.disc_x + float(motion[0]),
        disc_y=pose.disc_y + float(motion[1]),
        disc_rotation=pose.disc_rotation + float(motion[2]),
        wheel_angle=pose.wheel_angle + float(motion[3]),
        roller_distances=distances,
        shaft_pin_displacements=pins,
        wheel_pin_displacements=seats,
    )
    return moved, increment
