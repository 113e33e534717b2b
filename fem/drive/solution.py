"""Full solution of all discs of a drive at one crank angle: coarse, graded anew, fine, checked.

1. `fem.drive.expected_contacts` guesses contacts; coarse meshes with wide zones give the loads that the flexible
   bodies really share.
2. Meshes graded for those loads are condensed once and the pose iterated on them.
3. A solution is accepted when no pressure reaches the end of its zone, the elements are small enough for the
   half-widths found and no contact without a zone has closed; otherwise the meshes are graded anew.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fem.drive.condensed import condense_drive, keep_rounds
from fem.drive.contact_results import ContactResults, DeformedContacts, deformed_contacts, summarise_contacts
from fem.drive.expected_contacts import (
    ExpectedContacts,
    expect_contacts,
    require_one_disc,
)
from fem.drive.full_solution import CoarseSolution, FullSolution
from fem.drive.grading import FINE_SHARE, find_shortcoming, grade_contacts
from fem.drive.meshes import DriveMeshes, mesh_drive, require_model_memory
from fem.drive.model import DriveModel, RoundGroup
from fem.drive.pose import POSE_TOLERANCE, PoseSolution, WheelLoad, solve_poses
from fem.drive.rigid_bodies import RigidBodies
from fem.drive.supports import Supports
from fem.errors import MeshError
from fem.mesh.memory_need import require_memory, solution_memory
from fem.options import DEFAULT_OPTIONS, SolutionOptions
from fem.shapes import DriveShapes
from ltca.arrays import FloatArray
from ltca.drive.engine_support import require
from ltca.drive.parts import Drive
from ltca.drive.single_discs import single_discs
from ltca.drive.unit_mistakes import names_unit_mistakes
from ltca.errors import ConvergenceError, DriveError, Problem

# The coarse stage looks for loads only: two elements for each half-width, zones for contacts that are open by as
# much as bodies approach each other, sized for at least a quarter of the largest load.
COARSE_SIZE = 4.0
# Elements of the coarse stage grow faster away from the contacts: fewer of them, loads still good to 1.5 %, half-widths
# to half of that.
COARSE_GROWTH = 0.75
COARSE_SHARE = 0.25
COARSE_MARGIN = 1.0
# Open contacts within this part of the largest approach stay candidates of the fine stage: three times what the gaps of the
# coarse stage are off by.
FINE_MARGIN = 0.05
MAX_GRADINGS = 5
# A disc below this part of the mean share floats in its play: its place is indeterminate.
LEAST_SHARE = 1e-3
# Meshes are graded a little finer than asked, so that loads that still change by some per cent do not matter.
SIZE_RESERVE = 0.96


@dataclass(frozen=True, slots=True, kw_only=True)
class _Disc:
    """One disc with its pins and rollers; `approach` is the largest overlap in the guess, mm."""

    drive: Drive
    rigid: RigidBodies
    shapes: DriveShapes
    guess: ExpectedContacts
    approach: float

    @classmethod
    def of_single(cls, drive: Drive, crank_angle: float, wheel_moment: float) -> _Disc:
        """Return the disc of a drive of one under a moment on the wheel, N·mm."""
        rigid = RigidBodies.of_drive(drive, crank_angle)
        guess = expect_contacts(drive, crank_angle, wheel_moment=wheel_moment)
        return cls(
            drive=drive,
            rigid=rigid,
            shapes=DriveShapes.of_drive(drive),
            guess=guess,
            approach=_largest_approach(rigid, guess),
        )

    def grade(
        self,
        rigid: RigidBodies,
        pose: tuple[complex, float, float],
        loads: tuple[FloatArray, FloatArray, FloatArray],
        *,
        margin: float,
        share: float,
        deformed: DeformedContacts | None = None,
    ) -> ExpectedContacts:
        """Return the contacts to grade meshes for."""
        return grade_contacts(
            self.drive, rigid, *pose, loads, margin=margin * self.approach, smallest_share=share, deformed=deformed
        )

    def guessed(self) -> ExpectedContacts:
        """Return the contacts of the coarse meshes: wherever the guess has a load."""
        guess = self.guess
        place = (complex(guess.disc_x, guess.disc_y), guess.disc_rotation, guess.wheel_angle)
        loads = (guess.pins.load, guess.rollers_outer.load, guess.holes.load)
        return self.grade(self.rigid, place, loads, margin=COARSE_MARGIN, share=COARSE_SHARE)

    def graded(self, model: DriveModel, solution: PoseSolution, grading: int) -> ExpectedContacts:
        """Return the contacts of a solution on other meshes."""
        results, pose = summarise_contacts(model, solution), solution.pose
        place = (pose.disc_displacement, pose.disc_rotation, pose.wheel_angle)
        loads = (results.pin_load, results.roller_load, results.pin_shaft_load)
        # A contact that closes although the rigid bodies leave it open is caught by the wider margin next time.
        margin, deformed = FINE_MARGIN * 3.0 ** (grading - 1), deformed_contacts(model, solution)
        rigid = self.rigid.moved(*pose.displacements)
        return self.grade(rigid, place, loads, margin=margin, share=FINE_SHARE, deformed=deformed)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Task:
    """What stays the same through all stages of one solution."""

    discs: tuple[_Disc, ...]
    supports: Supports
    load: WheelLoad
    options: SolutionOptions
    pose_tolerance: float
    say: Callable[[str], None]
    watch: _Stopwatch

    def solve_guess(
        self, start: tuple[float, float, float, float] | None, rounds: tuple[RoundGroup, ...]
    ) -> tuple[list[DriveModel], tuple[PoseSolution, ...]]:
        """Solve on coarse meshes; `start` is that of every disc."""
        contacts = [disc.guessed() for disc in self.discs]
        self.watch.lap("guess")
        self.say("coarse meshes")
        models = list[DriveModel]()
        for disc, expected in zip(self.discs, contacts, strict=True):
            models.append(self.condense_coarse(disc, expected, _with_groups(rounds, models)))
        starts = None if start is None else [model.start_pose(start) for model in models]
        found = solve_poses(models, self.supports, self.load, starts, progress=self.say)
        self.watch.lap("coarse")
        return models, found

    def condense_coarse(self, disc: _Disc, contacts: ExpectedContacts, rounds: tuple[RoundGroup, ...]) -> DriveModel:
        coarse = SolutionOptions(
            size=max(COARSE_SIZE, self.options.size), plane=self.options.plane, growth=COARSE_GROWTH
        )
        try:
            return self.condense(disc, contacts, self.mesh(disc, contacts, coarse, rounds), rounds)
        except MeshError:
            # Fast growth in a narrow place may end in too flat triangles; a drive is not refused for that.
            slow = replace(coarse, growth=self.options.growth)
            return self.condense(disc, contacts, self.mesh(disc, contacts, slow, rounds), rounds)

    def solve_graded(
        self,
        models: Sequence[DriveModel],
        found: Sequence[PoseSolution],
        complaints: Sequence[str],
        grading: int,
        rounds: tuple[RoundGroup, ...],
    ) -> tuple[list[DriveModel], tuple[PoseSolution, ...]]:
        """Solve on meshes graded for the contacts of another solution, those of discs without complaint as they are."""
        graded, made = list(models), list[DriveModel]()
        for number, (disc, model, own) in enumerate(zip(self.discs, models, found, strict=True)):
            if not complaints[number]:
                continue
            contacts = disc.graded(model, own, grading)
            self.say("meshes" if len(self.discs) == 1 else f"disc {number}: meshes")
            known = _with_groups(rounds, made)
            meshes = self.mesh(disc, contacts, replace(self.options, size=self.options.size * SIZE_RESERVE), known)
            self.watch.lap("mesh")
            graded[number] = self.condense(disc, contacts, meshes, known)
            made.append(graded[number])
            self.watch.lap("assembly and factorisation")
        starts = [each.pose for each in found]
        solved = solve_poses(
            graded, self.supports, self.load, starts, pose_tolerance=self.pose_tolerance, progress=self.say
        )
        self.watch.lap("contact and pose")
        return graded, solved

    def mesh(
        self, disc: _Disc, contacts: ExpectedContacts, options: SolutionOptions, rounds: tuple[RoundGroup, ...]
    ) -> DriveMeshes:
        known = {group.made_of.grading: group.body for group in rounds}
        return mesh_drive(disc.shapes, contacts, options, known=known)

    def condense(
        self, disc: _Disc, contacts: ExpectedContacts, meshes: DriveMeshes, rounds: tuple[RoundGroup, ...]
    ) -> DriveModel:
        return condense_drive(disc.drive, disc.shapes, contacts, meshes, plane=self.options.plane, known=rounds)


def _with_groups(rounds: tuple[RoundGroup, ...], models: Sequence[DriveModel]) -> tuple[RoundGroup, ...]:
    """Pins and rollers known before and those of other discs."""
    for model in models:
        rounds = keep_rounds(rounds, model.groups)
    return rounds


class _Stopwatch:
    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self._last = time.perf_counter()

    def lap(self, stage: str) -> None:
        now = time.perf_counter()
        self.seconds[stage] = self.seconds.get(stage, 0.0) + now - self._last
        self._last = now

    def total(self) -> dict[str, float]:
        """Return the seconds of each stage and their sum."""
        return self.seconds | {"total": sum(self.seconds.values())}


@names_unit_mistakes
def solve_drive(
    drive: Drive,
    crank_angle: float,
    options: SolutionOptions = DEFAULT_OPTIONS,
    *,
    torque: float | None = None,
    start: tuple[float, float, float, float] | None = None,
    rounds: tuple[RoundGroup, ...] = (),
    progress: Callable[[str], None] | None = None,
) -> FullSolution:
    """Solve a drive of one disc with the pin shaft held at one crank angle.

    Parameters
    ----------
    drive : Drive
        The drive in one case; any drive is solved by `fem.reducer.solution.solve_reducer`.
    crank_angle : float
        φ_C, rad.
    options : SolutionOptions
        Element size, plane state, fine walls.
    torque : float, optional
        Output torque, N·mm; the drive's own by default.
    start : tuple of four floats, optional
        First pose (disc x, y, mm; disc rotation, wheel angle, rad); that of the guess by default.
    rounds, progress
        As for `solve_discs`.

    Returns
    -------
    FullSolution
        Accepted solution.

    Raises
    ------
    ConvergenceError, MemoryLimitError
        As for `solve_discs`.
    DriveError
        As for `solve_discs`; for several discs, and where the wheel is held: its moment follows from the solution.
    """
    require_one_disc(drive)
    if drive.wheel_is_held:
        said = "must be pin-shaft for a moment on the wheel that is known; where the wheel is held it follows from the solution"
        raise DriveError([Problem.of("installation.held", f"= {drive.installation.held}", said)])
    load = WheelLoad.of_drive(drive, torque)
    (found,) = solve_discs(drive, crank_angle, load, options, start=start, rounds=rounds, progress=progress)
    return found


@names_unit_mistakes
def solve_discs(
    drive: Drive,
    crank_angle: float,
    load: WheelLoad,
    options: SolutionOptions = DEFAULT_OPTIONS,
    *,
    start: tuple[float, float, float, float] | None = None,
    rounds: tuple[RoundGroup, ...] = (),
    pose_tolerance: float = POSE_TOLERANCE,
    progress: Callable[[str], None] | None = None,
) -> tuple[FullSolution, ...]:
    """Solve all discs with wheel, cranks and pin shaft at one crank angle.

    Parameters
    ----------
    drive : Drive
        The drive in one case.
    crank_angle : float
        φ_C, rad.
    load : WheelLoad
        Moment on the wheel, or what a held wheel balances.
    options : SolutionOptions
        Element size, plane state, fine walls.
    start : tuple of four floats, optional
        First pose of every disc (x, y, mm; disc rotation, wheel angle, rad); that of the guess by default.
    rounds : tuple of RoundGroup
        Condensed pins and rollers of another solution (`FullSolution.rounds`), of any crank angle or disc: they save time
        and change no bit of the result.
    pose_tolerance : float
        Largest rigid increment of a converged pose, mm.
    progress : callable, optional
        Called with one line for each step.

    Returns
    -------
    tuple of FullSolution
        Accepted solution of every disc.

    Raises
    ------
    ConvergenceError
        When nothing can carry the load or an iteration does not settle.
    DriveError
        For what full finite elements refuse (`ltca.drive.engine_support`).
    MemoryLimitError
        When the meshes would not fit into memory.
    """
    require(drive, "full FE")
    say, watch, singles = progress or (lambda _: None), _Stopwatch(), single_discs(drive)
    discs = tuple(_Disc.of_single(single, crank_angle, load.moment / len(singles)) for single in singles)
    require_model_memory([(disc.shapes, disc.guess) for disc in discs], options)
    task = _Task(
        discs=discs,
        supports=Supports.of_drive(drive),
        load=load,
        options=options,
        pose_tolerance=pose_tolerance,
        say=say,
        watch=watch,
    )
    try:
        models, found = task.solve_guess(start, rounds)
    except ConvergenceError as error:
        if (idle := _idle_disc(discs, crank_angle, load.moment)) is None:
            raise
        raise ConvergenceError(
            f"disc {idle} carries less than {LEAST_SHARE:g} of the mean share of the wheel's moment: finite elements cannot "
            "say where a disc without load rests",
            error.history,
        ) from None
    rounds, complaints = _with_groups(rounds, models), ["coarse"] * len(discs)
    for grading in range(1, MAX_GRADINGS + 1):
        models, found = task.solve_graded(models, found, complaints, grading, rounds)
        rounds = _with_groups(rounds, models)
        results = [summarise_contacts(model, own) for model, own in zip(models, found, strict=True)]
        complaints = [
            find_shortcoming(model, own, contacts, options.size)
            for model, own, contacts in zip(models, found, results, strict=True)
        ]
        watch.lap("check")
        if not any(complaints):
            return _solutions(models, found, results, options, rounds, watch)
        complaint = next(filter(None, complaints))
        say(f"meshes graded anew ({grading}): {complaint}")
    hint = "; use smaller elements" if options.size > COARSE_SIZE else ""
    raise ConvergenceError(f"meshes do not fit the contacts after {MAX_GRADINGS} gradings: {complaint}{hint}")


def _idle_disc(discs: Sequence[_Disc], crank_angle: float, moment: float) -> int | None:
    """The first disc that is hardly touched where another one carries all of the moment, by springs between rigid bodies."""

    def wound(disc: _Disc, part: float) -> float:
        guess = expect_contacts(disc.drive, crank_angle, wheel_moment=part * moment)
        return float(np.sign(moment)) * guess.wheel_angle

    alone = [wound(disc, 1.0) for disc in discs]
    for number, disc in enumerate(discs):
        others = alone[:number] + alone[number + 1 :]
        if others and min(others) < wound(disc, LEAST_SHARE / len(discs)):
            return number
    return None


def _solutions(
    models: Sequence[DriveModel],
    found: Sequence[PoseSolution],
    results: Sequence[ContactResults],
    options: SolutionOptions,
    rounds: tuple[RoundGroup, ...],
    watch: _Stopwatch,
) -> tuple[FullSolution, ...]:
    seconds = watch.total()
    return tuple(
        FullSolution(
            model=model,
            state=own,
            contacts=contacts,
            options=options,
            pose_iterations=own.iterations,
            rounds=rounds,
            seconds=seconds,
        )
        for model, own, contacts in zip(models, found, results, strict=True)
    )


def solve_load(previous: FullSolution, torque: float, *, progress: Callable[[str], None] | None = None) -> FullSolution:
    """Solve another output torque, N·mm, of one disc on the meshes and factors of a solution at the same crank angle.

    New meshes are graded where those do not serve.
    """
    drive = previous.model.drive
    load = WheelLoad.of_drive(drive, torque)
    (found,) = solve_again(drive, (previous,), load, progress=progress)
    if find_shortcoming(found.model, found.state, found.contacts, previous.options.size):
        (found,) = solve_discs(
            drive, previous.model.crank_angle, load, previous.options, rounds=previous.rounds, progress=progress
        )
    return found


def solve_again(
    drive: Drive,
    previous: Sequence[FullSolution],
    load: WheelLoad,
    *,
    pose_tolerance: float = POSE_TOLERANCE,
    progress: Callable[[str], None] | None = None,
) -> tuple[FullSolution, ...]:
    """Solve all discs of a drive from a solution on its meshes, which are kept; whether they serve is not asked."""
    watch, options = _Stopwatch(), previous[0].options
    models = [each.model for each in previous]
    found = solve_poses(
        models,
        Supports.of_drive(drive, options.halvings),
        load,
        [each.pose for each in previous],
        start_active=np.concatenate([each.state.contact.active for each in previous]),
        pose_tolerance=pose_tolerance,
        progress=progress,
    )
    watch.lap("contact and pose")
    results = [summarise_contacts(model, own) for model, own in zip(models, found, strict=True)]
    return _solutions(models, found, results, options, previous[-1].rounds, watch)


def refine_discs(
    drive: Drive,
    load: WheelLoad,
    coarse: Sequence[CoarseSolution],
    *,
    pose_tolerance: float = POSE_TOLERANCE,
    progress: Callable[[str], None] | None = None,
) -> tuple[FullSolution, ...]:
    """Solve all discs on the meshes of a solution with every element divided into four.

    Contact zones stay where they are, with twice the pressure unknowns; a ring is refined likewise.

    Parameters
    ----------
    drive : Drive
        All of it.
    load : WheelLoad
        That of the solution.
    coarse : sequence of CoarseSolution
        Of the solution on coarser meshes (`FullSolution.coarse`), whose poses start the iteration.
    pose_tolerance : float
        Largest rigid increment of a converged pose, mm.
    progress : callable, optional
        Called with one line for each step.

    Returns
    -------
    tuple of FullSolution
        With `fem.options.SolutionOptions.halvings` increased by one.

    Raises
    ------
    ConvergenceError
        When the poses do not settle, or the contacts outgrow the zones of the coarser meshes.
    MemoryLimitError
        When the refined meshes would not fit into memory.
    """
    say, watch, options = progress or (lambda _: None), _Stopwatch(), coarse[0].options
    options = replace(options, halvings=options.halvings + 1)
    unknowns = sum(own.refined_unknowns for own in coarse)
    require_memory(unknowns, solution_memory(unknowns), "the refined mesh")
    models, rounds = list[DriveModel](), tuple[RoundGroup, ...]()
    for own in coarse:
        say(f"meshes halved, {own.refined_unknowns:,} unknowns")
        meshes = own.meshes.refined(own.shapes)
        watch.lap("mesh")
        model = condense_drive(own.drive, own.shapes, own.contacts, meshes, plane=options.plane, known=rounds)
        rounds = keep_rounds(rounds, model.groups)
        models.append(model)
        watch.lap("assembly and factorisation")
    found = solve_poses(
        models,
        Supports.of_drive(drive, options.halvings),
        load,
        [own.pose for own in coarse],
        pose_tolerance=pose_tolerance,
        progress=progress,
    )
    watch.lap("contact and pose")
    results = [summarise_contacts(model, own) for model, own in zip(models, found, strict=True)]
    solved = _solutions(models, found, results, options, rounds, watch)
    require_zones(solved)
    return solved


def require_zones(discs: Sequence[FullSolution]) -> None:
    """Raise ConvergenceError when the contacts outgrow the zones of meshes that are kept, whatever the size of their elements."""
    for disc in discs:
        if complaint := find_shortcoming(disc.model, disc.state, disc.contacts):
            raise ConvergenceError(
                f"nested meshes do not serve the solution at crank angle {disc.model.crank_angle:g} rad: {complaint}; "
                "use smaller elements"
            )


def _largest_approach(rigid: RigidBodies, guess: ExpectedContacts) -> float:
    """Return the largest overlap of rigid bodies in the guess, mm."""
    gaps = rigid.gaps(complex(guess.disc_x, guess.disc_y), guess.disc_rotation, guess.wheel_angle)
    return float(-np.concatenate([gaps.pins, gaps.rollers, gaps.holes]).min())
