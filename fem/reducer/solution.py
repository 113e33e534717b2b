"""Full solution of a drive of any number of discs at one crank angle, whichever member is held.

Each disc with its pins, rollers and race is a separate finite-element problem (`fem.drive.solution`); the discs share the
wheel's angle and its moment (`fem.reducer.shares`). Where the wheel is held, its moment is what balances the output's torque
and the moment of the input, which follows from the bearing forces found. On an elastic ring each disc finds the seats of its pins
where the forces of the others hold them, in turn until nothing moves.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from fem.drive.condensed import keep_rounds
from fem.drive.expected_contacts import expect_contacts
from fem.drive.full_solution import CoarseSolution, FullSolution
from fem.drive.meshes import require_model_memory
from fem.drive.model import RoundGroup
from fem.drive.solution import refine_solution, solve_disc, solve_moment
from fem.options import DEFAULT_OPTIONS, SolutionOptions
from fem.reducer.mixing import AndersonMixing
from fem.reducer.shares import SharedAnswer, share_moment
from fem.shapes import DriveShapes
from ltca.arrays import ComplexArray, FloatArray
from ltca.drive.engine_support import require
from ltca.drive.parts import Drive
from ltca.drive.single_discs import single_discs
from ltca.drive.unit_mistakes import names_unit_mistakes
from ltca.errors import ConvergenceError

POSE_TOLERANCE = 1e-7
"""Largest rigid increment of a converged pose, mm: of the wheel, 1e-9 rad at a pin circle of 0.1 m."""
SEAT_TOLERANCE = 1e-7
"""Largest change of the seats of a ring in the last round of all discs, mm."""
MAX_SWEEPS = 40
"""Rounds of all discs on one ring."""
MIXED_ROUNDS = 5
"""Rounds whose changes are combined for the next: without, a free ring takes thirty rounds, with them six."""
RELATIVE_MOMENT_STEP = 0.01
"""Step of a central difference of the springs' wheel angle, as a part of the moment."""
SPRING_TOLERANCE = 1e-7


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
    spread : tuple of float
        Largest difference of the discs' wheel angles in each round of moments, rad; empty where nothing is shared.
    left_over : tuple of float
        Moment by which wheel, input and output do not balance in each round, N·mm.
    seconds : dict of str to float
        Wall time of each stage, all discs and rounds; ``total`` is their sum.
    """

    drive: Drive
    crank_angle: float
    torque: float
    discs: tuple[FullSolution, ...]
    spread: tuple[float, ...]
    left_over: tuple[float, ...]
    seconds: dict[str, float]

    @classmethod
    def of_disc(cls, disc: FullSolution) -> ReducerSolution:
        """Return the solution of a drive of one disc with the pin shaft held, which shares nothing."""
        drive, moment = disc.model.drive, disc.state.wheel_moment
        return cls(
            drive=drive,
            crank_angle=disc.model.crank_angle,
            torque=moment / drive.wheel_moment(1.0),
            discs=(disc,),
            spread=(),
            left_over=(),
            seconds=disc.seconds,
        )

    @property
    def wheel_angle(self) -> float:
        """Deviation of the wheel from φ_C/u, rad."""
        return float(np.mean([disc.pose.wheel_angle for disc in self.discs]))

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
        return self.drive.output_per_wheel_angle * self.wheel_angle

    @property
    def ring_displacements(self) -> ComplexArray | None:
        """Displacement of the seats of the wheel pins by the ring, radial + i tangential, mm, shape (z_P,); None if rigid."""
        if self.drive.ring is None:
            return None
        moved = sum(
            (_seats_moved(disc, self.drive) for disc in self.discs[1:]), _seats_moved(self.discs[0], self.drive)
        )
        return np.asarray(moved * np.exp(-2j * np.pi * np.arange(moved.size) / moved.size))

    @property
    def equilibrium_residual(self) -> float:
        """Largest unbalanced force, N."""
        return max(disc.contacts.equilibrium_residual for disc in self.discs)

    @property
    def coarse(self) -> tuple[CoarseSolution, ...]:
        """What a solution on refined meshes starts from, disc by disc."""
        return tuple(disc.coarse for disc in self.discs)

    @property
    def rounds(self) -> tuple[RoundGroup, ...]:
        """Condensed pins and rollers of all discs, to start another solution with."""
        found: tuple[RoundGroup, ...] = ()
        for disc in self.discs:
            found = keep_rounds(found, disc.rounds)
        return found

    @property
    def unknowns(self) -> int:
        """Displacement and pressure unknowns of all discs."""
        return sum(disc.unknowns for disc in self.discs)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Task:
    """Drive, load and options of one solution."""

    drive: Drive
    crank_angle: float
    singles: tuple[Drive, ...]
    torque: float
    options: SolutionOptions
    say: Callable[[str], None]
    regraded: bool = True
    seconds: dict[str, float] = field(default_factory=dict)

    @classmethod
    def again(
        cls, drive: Drive, torque: float, coarse: Sequence[CoarseSolution], say: Callable[[str], None] | None
    ) -> _Task:
        """Return the task of solving a solution again on meshes that are never graded anew."""
        return cls(
            drive=drive,
            crank_angle=coarse[0].contacts.crank_angle,
            singles=single_discs(drive),
            torque=torque,
            options=coarse[0].options,
            say=say or (lambda _: None),
            regraded=False,
        )

    def start(
        self, disc: int, moment: float, rounds: tuple[RoundGroup, ...], by_others: ComplexArray | None = None
    ) -> FullSolution:
        return self.timed(
            solve_disc(
                self.singles[disc],
                self.crank_angle,
                moment,
                self.options,
                rounds=rounds,
                by_others=by_others,
                progress=self.saying(disc),
            )
        )

    def settle(
        self,
        disc: int,
        previous: FullSolution | None,
        moment: float,
        rounds: tuple[RoundGroup, ...],
        by_others: ComplexArray,
    ) -> FullSolution:
        """Solve one disc under a moment until its pose has converged to `POSE_TOLERANCE`, seats displaced by other discs."""
        found = self.start(disc, moment, rounds, by_others) if previous is None else previous
        if not np.array_equal(found.model.by_others, by_others):
            moved = replace(found, model=replace(found.model, by_others=by_others))
            found = self.solve_again(disc, moved, moment)
        while found.state.wheel_moment != moment or found.state.increments[-1] > POSE_TOLERANCE:
            found = self.solve_again(disc, found, moment)
        return found

    def solve_again(self, disc: int, found: FullSolution, moment: float) -> FullSolution:
        """Solve one disc under a moment on the meshes it has, from the pose it has."""
        say = self.saying(disc)
        return self.timed(
            solve_moment(found, moment, pose_tolerance=POSE_TOLERANCE, regraded=self.regraded, progress=say)
        )

    def settle_all(
        self, discs: Sequence[FullSolution | None], moments: FloatArray, rounds: tuple[RoundGroup, ...]
    ) -> list[FullSolution]:
        """Solve every disc under its moment, all on one ring: each finds the seats where the forces of the others hold them.

        One disc after the other lowers the complementary energy of all, which is convex, so this ends; without a ring discs do
        not know of each other.
        """
        now = list(discs)
        parts = np.stack([_seats_moved(disc, self.drive) for disc in now])
        mixing, history = AndersonMixing(depth=MIXED_ROUNDS), list[float]()
        for _ in range(MAX_SWEEPS):
            found = parts.copy()
            for disc, moment in enumerate(moments):
                others = found.sum(axis=0) - found[disc]
                # Pins and rollers of one disc serve the next.
                last = now[disc - 1] if disc else None
                known = rounds if last is None else last.rounds
                now[disc] = own = self.settle(disc, now[disc], float(moment), known, others)
                found[disc] = _seats_moved(own, self.drive)
            history.append(float(np.max(np.abs(found - parts))))
            if self.drive.ring is None or len(now) == 1 or history[-1] <= SEAT_TOLERANCE:
                return [own for own in now if own is not None]
            self.say(f"ring: seats moved by {1e3 * history[-1]:.3g} µm")
            parts = mixing.next(parts, found)
        raise ConvergenceError(
            f"the seats of the ring did not settle in {MAX_SWEEPS} rounds of all discs; their changes in mm", history
        )

    def left_over(self, discs: list[FullSolution]) -> float:
        """Moment by which wheel, input and output do not balance; of a held shaft none."""
        wheel = sum(disc.state.wheel_moment for disc in discs)
        if not self.drive.wheel_is_held:
            return wheel - self.drive.wheel_moment(self.torque)
        cranks = float(sum(disc.crank_moments.sum() for disc in discs))
        return wheel + self.drive.input_per_crank_moment * cranks + self.drive.driving_sign * self.torque

    def solve_shares(
        self,
        first: Sequence[FullSolution | None],
        moment: FloatArray,
        slope: FloatArray,
        rounds: tuple[RoundGroup, ...],
    ) -> ReducerSolution:
        """Solve all discs, from `first` where known, under moments whose wheel angles agree and that balance the drive."""
        discs = list(first)

        def answer(moments: FloatArray) -> SharedAnswer:
            found = self.settle_all(discs, moments, rounds)
            discs[:] = found
            angle = np.array([disc.pose.wheel_angle for disc in found])
            shares = ", ".join(f"{share:.4f}" for share in moments / moments.sum())
            self.say(f"shares {shares}; wheel angles differ by {np.ptp(angle):.2g} rad")
            return SharedAnswer(wheel_angle=angle, left_over=self.left_over(found))

        shares = share_moment(answer, moment, slope, rise=1.0 / abs(self.drive.output_per_wheel_angle))
        return ReducerSolution(
            drive=self.drive,
            crank_angle=self.crank_angle,
            torque=self.torque,
            discs=tuple(disc for disc in discs if disc is not None),
            spread=shares.spread,
            left_over=shares.left_over,
            seconds=self.seconds,
        )

    def saying(self, disc: int) -> Callable[[str], None]:
        if len(self.singles) == 1:
            return self.say
        return lambda line: self.say(f"disc {disc}: {line}")

    def timed(self, found: FullSolution) -> FullSolution:
        for stage, value in found.seconds.items():
            self.seconds[stage] = self.seconds.get(stage, 0.0) + value
        return found


def _seats_moved(disc: FullSolution | None, drive: Drive) -> ComplexArray:
    """Displacement of the seats of the wheel pins by the forces of one disc, in the wheel, mm; zero before it is solved."""
    if disc is None:
        return np.zeros(drive.pin_wheel.number_of_pins, dtype=complex)
    return np.asarray(disc.pose.wheel_pin_displacements - disc.model.by_others)


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
        Element size, plane state, fine walls.
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
        When nothing can carry the load, an iteration does not settle, or a disc carries nothing.
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
    require(drive, "full FE")
    drive.require_torque("full finite elements, whose loads follow those of the torque", torque)
    singles = single_discs(drive)
    task = _Task(
        drive=drive,
        crank_angle=float(crank_angle),
        singles=singles,
        torque=drive.load.torque if torque is None else torque,
        options=options,
        say=progress or (lambda _: None),
    )
    if len(singles) == 1 and not drive.wheel_is_held:
        return replace(
            ReducerSolution.of_disc(task.start(0, drive.wheel_moment(torque), rounds)), drive=drive, torque=task.torque
        )
    if len(singles) > 1:
        require_solution_memory(drive, crank_angle, options)
    moment, slope = expect_shares(drive, crank_angle, drive.wheel_moment(torque))
    return task.solve_shares([None] * len(singles), moment, slope, rounds)


def settle_pose(solution: ReducerSolution, progress: Callable[[str], None] | None = None) -> ReducerSolution:
    """Return a solution whose poses have converged to `POSE_TOLERANCE` on its own meshes, which are kept.

    That of several discs, or with the wheel held, has converged so far already.
    """
    if len(solution.discs) > 1 or solution.drive.wheel_is_held:
        return solution
    (disc,) = solution.discs
    task = _Task.again(solution.drive, solution.torque, (disc.coarse,), progress)
    settled = task.settle(0, disc, disc.state.wheel_moment, (), disc.model.by_others)
    seconds = {stage: solution.seconds.get(stage, 0.0) + task.seconds.get(stage, 0.0) for stage in solution.seconds}
    return replace(solution, discs=(settled,), seconds=seconds)


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
    task = _Task.again(drive, torque, coarse, progress)
    discs, rounds = list[FullSolution | None](), tuple[RoundGroup, ...]()
    for number, own in enumerate(coarse):
        # Pins and rollers of one disc serve the next.
        say = task.saying(number)
        found = task.timed(refine_solution(own, rounds=rounds, pose_tolerance=POSE_TOLERANCE, progress=say))
        rounds = found.rounds
        discs.append(found)
    if len(discs) == 1 and not drive.wheel_is_held:
        return replace(ReducerSolution.of_disc(found), drive=drive, torque=torque)
    moments = np.array([own.wheel_moment for own in coarse])
    _, slope = expect_shares(drive, task.crank_angle, float(moments.sum()))
    return task.solve_shares(discs, moments, slope, ())


def expect_shares(drive: Drive, crank_angle: float, wheel_moment: float) -> tuple[FloatArray, FloatArray]:
    """Estimate the moment that each disc carries, N·mm, and dθ/dM there, rad/(N·mm), from springs between rigid bodies.

    Equal moments where the springs leave a disc without load.
    """
    singles = single_discs(drive)

    def angles(moments: FloatArray) -> FloatArray:
        return np.array(
            [
                expect_contacts(single, crank_angle, wheel_moment=float(moment)).wheel_angle
                for single, moment in zip(singles, moments, strict=True)
            ]
        )

    def answer(moments: FloatArray) -> SharedAnswer:
        return SharedAnswer(wheel_angle=angles(moments), left_over=0.0)

    def slopes(moments: FloatArray) -> FloatArray:
        step = RELATIVE_MOMENT_STEP
        return (angles((1.0 + step) * moments) - angles((1.0 - step) * moments)) / (2.0 * step * moments)

    equal = np.full(len(singles), wheel_moment / len(singles))
    try:
        moment = share_moment(answer, equal, slopes(equal), angle_tolerance=SPRING_TOLERANCE).moment
        return moment, slopes(moment)
    except ConvergenceError:
        return equal, slopes(equal)


def require_solution_memory(drive: Drive, crank_angle: float, options: SolutionOptions) -> None:
    """Raise MemoryLimitError when the full solution of a drive would not fit into memory, before any meshing."""
    singles = single_discs(drive)
    moment = drive.wheel_moment() / len(singles)
    require_model_memory(
        [
            (DriveShapes.of_drive(single), expect_contacts(single, crank_angle, wheel_moment=moment))
            for single in singles
        ],
        options,
    )
