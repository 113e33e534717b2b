"""Full solution of a drive of any number of discs at one crank angle, whichever member is held.

The contacts of all discs are one problem (`fem.drive.pose`): discs turn one wheel, and what holds the pins feels the forces of
all. Where the wheel is held, its moment is what balances the output's torque and the moment of the input, which follows from the
bearing forces found.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fem.drive.full_solution import CoarseSolution, FullSolution
from fem.drive.meshes import require_model_memory
from fem.drive.model import RoundGroup
from fem.drive.pose import POSE_TOLERANCE as ROUGH_POSE, WheelLoad, forces_on_supports, joint_problem
from fem.drive.solution import plane_discs, refine_discs, require_zones, solve_again, solve_discs
from fem.drive.supports import Supports, ring_of_seats
from fem.options import DEFAULT_OPTIONS, SolutionOptions
from fem.solid_drive.solved_discs import solve_solid_discs
from ltca.arrays import ComplexArray, FloatArray
from ltca.drive.engine_support import require
from ltca.drive.parts import Drive
from ltca.drive.unit_mistakes import names_unit_mistakes

POSE_TOLERANCE = 1e-7
"""Largest rigid increment of a converged pose of several discs, mm: of the wheel, 1e-9 rad at a pin circle of 0.1 m."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ReducerSolution:
    """Finite-element solution of a drive at one crank angle.

    Attributes
    ----------
    drive : Drive
        All of it.
    crank_angle : float
        φ_C, rad.
    torque : float
        Output torque, N·mm.
    discs : tuple of FullSolution
        Of each disc.
    seconds : dict of str to float
        Wall time of each stage; ``total`` is their sum.
    """

    drive: Drive
    crank_angle: float
    torque: float
    discs: tuple[FullSolution, ...]
    seconds: dict[str, float]

    @classmethod
    def of_discs(cls, drive: Drive, torque: float, discs: tuple[FullSolution, ...]) -> ReducerSolution:
        """Return the solution of a drive at an output torque, N·mm, solved together."""
        first = discs[0]
        return cls(drive=drive, crank_angle=first.model.crank_angle, torque=torque, discs=discs, seconds=first.seconds)

    @property
    def wheel_angle(self) -> float:
        """Deviation of the wheel from φ_C/u, rad."""
        return self.discs[0].pose.wheel_angle

    @property
    def disc_torques(self) -> FloatArray:
        """Part of the external moment on the wheel that each disc carries, ccw positive, shape (discs,), N·mm."""
        return np.array([disc.state.wheel_moment for disc in self.discs])

    @property
    def wheel_moment(self) -> float:
        """External moment on the wheel, ccw positive, N·mm."""
        return float(self.disc_torques.sum())

    @property
    def torque_share(self) -> FloatArray:
        """Part of the wheel's moment that each disc carries, shape (discs,)."""
        return np.asarray(self.disc_torques / self.wheel_moment)

    @property
    def transmission_error(self) -> float:
        """Deviation of the output, ccw positive, rad."""
        return float(self.drive.output_deviation(self.wheel_angle, self.torque))

    @property
    def ring_displacements(self) -> ComplexArray | None:
        """Displacement of the seats of the wheel pins by the ring, radial + i tangential, mm, shape (z_P,); None if rigid."""
        if self.drive.ring is None:
            return None
        on_wheel, _, _ = forces_on_supports(
            [disc.model for disc in self.discs],
            [disc.pose for disc in self.discs],
            [disc.state.integrals for disc in self.discs],
            [disc.state.contact.pressure for disc in self.discs],
        )
        total = on_wheel.sum(axis=0)
        flat = ring_of_seats(self.drive, self.options.halvings) @ np.column_stack([total.real, total.imag]).ravel()
        moved = flat[0::2] + 1j * flat[1::2]
        return np.asarray(moved * np.exp(-2j * np.pi * np.arange(moved.size) / moved.size))

    @property
    def equilibrium_residual(self) -> float:
        """Largest unbalanced force, N."""
        return max(disc.contacts.equilibrium_residual for disc in self.discs)

    @property
    def solid(self) -> bool:
        """Whether the bodies are solid."""
        return self.options.layers > 0

    @property
    def options(self) -> SolutionOptions:
        """How it was solved."""
        return self.discs[0].options

    @property
    def strain_energy(self) -> float:
        """Half of the pressures on what they displace: of all bodies and of what holds pins and cranks, N·mm."""
        models, states = [disc.model for disc in self.discs], [disc.state for disc in self.discs]
        poses, integrals = [state.pose for state in states], [list(state.integrals) for state in states]
        supports = Supports.of_drive(self.drive, self.options.halvings)
        pressure = np.concatenate([state.contact.pressure for state in states])
        compliance = joint_problem(models, supports, poses, integrals, 0.0).compliance
        return 0.5 * float(pressure @ compliance @ pressure)

    @property
    def coarse(self) -> tuple[CoarseSolution, ...]:
        """What a solution on refined meshes starts from, disc by disc."""
        return tuple(disc.coarse for disc in self.discs)

    @property
    def rounds(self) -> tuple[RoundGroup, ...]:
        """Condensed pins and rollers of all discs, to start another solution with."""
        return self.discs[0].rounds

    @property
    def unknowns(self) -> int:
        """Displacement and pressure unknowns of all discs."""
        return sum(disc.unknowns for disc in self.discs)


@names_unit_mistakes
def solve_reducer(
    drive: Drive,
    crank_angle: float,
    options: SolutionOptions = DEFAULT_OPTIONS,
    *,
    torque: float | None = None,
    rounds: tuple[RoundGroup, ...] = (),
    progress: Callable[[str], None] | None = None,
) -> ReducerSolution:
    """Solve a drive at one crank angle.

    Parameters
    ----------
    drive : Drive
        The drive in one case, of any number of discs, either member held.
    crank_angle : float
        φ_C, rad.
    options : SolutionOptions
        Element size, plane state, fine walls; layers of solid bodies.
    torque : float, optional
        Output torque, N·mm; the drive's own by default.
    rounds : tuple of RoundGroup
        Condensed pins and rollers of another solution (`ReducerSolution.rounds`): they save time and change no bit of the
        result.
    progress : callable, optional
        Called with one line for each step.

    Returns
    -------
    ReducerSolution
        All discs at one wheel angle.

    Raises
    ------
    ConvergenceError
        When nothing can carry the load, or an iteration does not settle.
    DriveError
        For what full finite elements refuse (`ltca.drive.engine_support`).
    MemoryLimitError
        When the meshes would not fit into memory.

    Examples
    --------
    Elements of six times the default size are for a look only: on fine meshes the wheel angle is −464.95″.

    >>> import ltca
    >>> from fem.options import SolutionOptions
    >>> drive = ltca.load_drive("paper").cases["CS-1"]
    >>> found = solve_reducer(drive, 0.5, SolutionOptions(size=6.0))
    >>> print(f"{found.wheel_angle * 206264.8:.0f}″")
    -465″
    """
    require(drive, "solid disc" if options.layers else "full FE")
    drive.require_torque("full finite elements, whose loads follow those of the torque", torque)
    alone = drive.disc.number_of_discs == 1 and not drive.wheel_is_held
    tolerance, load = ROUGH_POSE if alone else POSE_TOLERANCE, WheelLoad.of_drive(drive, torque)
    if options.layers:
        found = solve_solid_discs(drive, float(crank_angle), load, options, pose_tolerance=tolerance, progress=progress)
    else:
        found = solve_discs(
            drive, float(crank_angle), load, options, rounds=rounds, pose_tolerance=tolerance, progress=progress
        )
    return ReducerSolution.of_discs(drive, drive.load.torque if torque is None else torque, found)


def settle_pose(solution: ReducerSolution, progress: Callable[[str], None] | None = None) -> ReducerSolution:
    """Return a solution whose poses have converged to `POSE_TOLERANCE` on its own meshes, which are kept.

    That of several discs, or with the wheel held, has converged so far already.
    """
    if max(disc.state.increments[-1] for disc in solution.discs) <= POSE_TOLERANCE:
        return solution
    load = WheelLoad.of_drive(solution.drive, solution.torque, solution.wheel_moment)
    settled = solve_again(solution.drive, solution.discs, load, pose_tolerance=POSE_TOLERANCE, progress=progress)
    require_zones(settled)
    stages = solution.seconds.keys() | settled[0].seconds.keys()
    seconds = {stage: solution.seconds.get(stage, 0.0) + settled[0].seconds.get(stage, 0.0) for stage in stages}
    return replace(solution, discs=settled, seconds=seconds)


def solve_refined(
    drive: Drive,
    torque: float,
    coarse: Sequence[CoarseSolution],
    *,
    progress: Callable[[str], None] | None = None,
) -> ReducerSolution:
    """Solve a drive again, to `POSE_TOLERANCE`, on the meshes of a solution with every element divided into four.

    Parameters
    ----------
    drive : Drive
        All of it.
    torque : float
        Output torque of the solution, N·mm.
    coarse : sequence of CoarseSolution
        The solution, disc by disc (`ReducerSolution.coarse`).
    progress : callable, optional
        Called with one line for each step.

    Returns
    -------
    ReducerSolution
        Its meshes are never graded anew; its seconds are those of this call.

    Raises
    ------
    ConvergenceError
        As `solve_reducer`, and when the contacts outgrow the zones of the meshes.
    MemoryLimitError
        When the refined meshes of a disc would not fit into memory.
    """
    load = WheelLoad.of_drive(drive, torque, sum(own.wheel_moment for own in coarse))
    return ReducerSolution.of_discs(
        drive, torque, refine_discs(drive, load, coarse, pose_tolerance=POSE_TOLERANCE, progress=progress)
    )


def require_solution_memory(drive: Drive, crank_angle: float, options: SolutionOptions) -> None:
    """Raise MemoryLimitError when the full solution of a drive would not fit into memory, before any meshing."""
    discs = plane_discs(drive, crank_angle, WheelLoad.of_drive(drive))
    require_model_memory([(disc.shapes, disc.guess) for disc in discs], options)
