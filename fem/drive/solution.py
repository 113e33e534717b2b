"""Full solution of a drive at one crank angle: coarse, graded anew, fine, checked.

1. `fem.drive.expected_contacts` guesses contacts; coarse meshes with wide zones give the loads that the flexible
   bodies really share.
2. Meshes graded for those loads are condensed once and the pose iterated on them.
3. A solution is accepted when no pressure reaches the end of its zone, the elements are small enough for the
   half-widths found and no contact without a zone has closed; otherwise the meshes are graded anew.
"""

from __future__ import annotations

import time
from collections.abc import Callable
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
from fem.drive.pose import POSE_TOLERANCE, PoseSolution, solve_pose
from fem.drive.rigid_bodies import RigidBodies
from fem.drive.ring import ring_of_seats
from fem.errors import MeshError
from fem.mesh.memory_need import require_memory, solution_memory
from fem.options import DEFAULT_OPTIONS, SolutionOptions
from fem.shapes import DriveShapes
from ltca.arrays import ComplexArray, FloatArray
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
# Meshes are graded a little finer than asked, so that loads that still change by some per cent do not matter.
SIZE_RESERVE = 0.96


@dataclass(frozen=True, slots=True, kw_only=True)
class _Task:
    """What stays the same through all stages of one solution; `approach` is the largest overlap in the guess, mm."""

    drive: Drive
    rigid: RigidBodies
    shapes: DriveShapes
    moment: float
    options: SolutionOptions
    approach: float
    say: Callable[[str], None]
    watch: _Stopwatch
    ring: FloatArray | None
    by_others: ComplexArray | None

    def solve_guess(
        self, guess: ExpectedContacts, start: tuple[float, float, float, float] | None, rounds: tuple[RoundGroup, ...]
    ) -> tuple[DriveModel, PoseSolution]:
        """Solve on coarse meshes wherever the guess has a load."""
        place = (complex(guess.disc_x, guess.disc_y), guess.disc_rotation, guess.wheel_angle)
        loads = (guess.pins.load, guess.rollers_outer.load, guess.holes.load)
        contacts = self.grade(self.rigid, place, loads, margin=COARSE_MARGIN, share=COARSE_SHARE)
        self.watch.lap("guess")
        self.say("coarse meshes")
        model = self.condense_coarse(contacts, rounds)
        first = None if start is None else model.start_pose(start)
        solution = solve_pose(model, self.moment, start=first, progress=self.say)
        self.watch.lap("coarse")
        return model, solution

    def condense_coarse(self, contacts: ExpectedContacts, rounds: tuple[RoundGroup, ...]) -> DriveModel:
        coarse = SolutionOptions(
            size=max(COARSE_SIZE, self.options.size), plane=self.options.plane, growth=COARSE_GROWTH
        )
        try:
            return self.condense(contacts, self.mesh(contacts, coarse, rounds), rounds)
        except MeshError:
            # Fast growth in a narrow place may end in too flat triangles; a drive is not refused for that.
            slow = replace(coarse, growth=self.options.growth)
            return self.condense(contacts, self.mesh(contacts, slow, rounds), rounds)

    def solve_graded(
        self, model: DriveModel, solution: PoseSolution, grading: int, rounds: tuple[RoundGroup, ...]
    ) -> tuple[DriveModel, PoseSolution]:
        """Solve on meshes graded for the contacts of another solution."""
        results, pose = summarise_contacts(model, solution), solution.pose
        place = (pose.disc_displacement, pose.disc_rotation, pose.wheel_angle)
        loads = (results.pin_load, results.roller_load, results.pin_shaft_load)
        # A contact that closes although the rigid bodies leave it open is caught by the wider margin next time.
        margin, deformed = FINE_MARGIN * 3.0 ** (grading - 1), deformed_contacts(model, solution)
        rigid = self.rigid.with_pins_moved(pose.wheel_pin_displacements)
        contacts = self.grade(rigid, place, loads, margin=margin, share=FINE_SHARE, deformed=deformed)
        self.say("meshes")
        meshes = self.mesh(contacts, replace(self.options, size=self.options.size * SIZE_RESERVE), rounds)
        self.watch.lap("mesh")
        graded = self.condense(contacts, meshes, rounds)
        self.watch.lap("assembly and factorisation")
        found = solve_pose(graded, self.moment, start=solution.pose, progress=self.say)
        self.watch.lap("contact and pose")
        return graded, found

    def mesh(self, contacts: ExpectedContacts, options: SolutionOptions, rounds: tuple[RoundGroup, ...]) -> DriveMeshes:
        known = {group.made_of.grading: group.body for group in rounds}
        return mesh_drive(self.shapes, contacts, options, known=known)

    def condense(self, contacts: ExpectedContacts, meshes: DriveMeshes, rounds: tuple[RoundGroup, ...]) -> DriveModel:
        return condense_drive(
            self.drive,
            self.shapes,
            contacts,
            meshes,
            plane=self.options.plane,
            known=rounds,
            ring=self.ring,
            by_others=self.by_others,
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
        return grade_contacts(
            self.drive,
            rigid,
            *pose,
            loads,
            margin=margin * self.approach,
            smallest_share=share,
            deformed=deformed,
        )


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
    start, rounds, progress
        As for `solve_disc`.

    Returns
    -------
    FullSolution
        Accepted solution.

    Raises
    ------
    ConvergenceError, MemoryLimitError
        As for `solve_disc`.
    DriveError
        As for `solve_disc`; for several discs, and where the wheel is held: its moment follows from the solution.
    """
    require_one_disc(drive)
    if drive.wheel_is_held:
        said = "must be pin-shaft for a moment on the wheel that is known; where the wheel is held it follows from the solution"
        raise DriveError([Problem.of("installation.held", f"= {drive.installation.held}", said)])
    (single,) = single_discs(drive)
    moment = drive.wheel_moment(torque)
    return solve_disc(single, crank_angle, moment, options, start=start, rounds=rounds, progress=progress)


@names_unit_mistakes
def solve_disc(
    drive: Drive,
    crank_angle: float,
    wheel_moment: float,
    options: SolutionOptions = DEFAULT_OPTIONS,
    *,
    start: tuple[float, float, float, float] | None = None,
    rounds: tuple[RoundGroup, ...] = (),
    by_others: ComplexArray | None = None,
    progress: Callable[[str], None] | None = None,
) -> FullSolution:
    """Solve one disc with wheel, crank and pin shaft at one crank angle.

    Parameters
    ----------
    drive : Drive
        Of one disc (`ltca.drive.single_discs`).
    crank_angle : float
        φ_C, rad.
    wheel_moment : float
        External moment on the wheel that the disc carries, ccw positive, N·mm.
    options : SolutionOptions
        Element size, plane state, fine walls.
    start : tuple of four floats, optional
        First pose (disc x, y, mm; disc rotation, wheel angle, rad); that of the guess by default.
    rounds : tuple of RoundGroup
        Condensed pins and rollers of another solution (`FullSolution.rounds`), of any crank angle or disc: they save time
        and change no bit of the result.
    by_others : array of complex, shape (z_P,), optional
        Displacement of the seats of the wheel pins in the wheel by the forces of other discs on the ring, mm.
    progress : callable, optional
        Called with one line for each step.

    Returns
    -------
    FullSolution
        Accepted solution.

    Raises
    ------
    ConvergenceError
        When nothing can carry the load or an iteration does not settle.
    DriveError
        For several discs, and for what full finite elements refuse (`ltca.drive.engine_support`).
    MemoryLimitError
        When the meshes would not fit into memory.
    """
    require(drive, "full FE")
    say, watch = progress or (lambda _: None), _Stopwatch()
    shapes, rigid = DriveShapes.of_drive(drive), RigidBodies.of_drive(drive, crank_angle)
    guess = expect_contacts(drive, crank_angle, wheel_moment=wheel_moment)
    task = _Task(
        drive=drive,
        rigid=rigid,
        shapes=shapes,
        moment=wheel_moment,
        options=options,
        approach=_largest_approach(rigid, guess),
        say=say,
        watch=watch,
        ring=None if drive.ring is None else ring_of_seats(drive),
        by_others=by_others,
    )
    require_model_memory([(shapes, guess)], options)
    model, solution = task.solve_guess(guess, start, rounds)
    rounds, complaint = keep_rounds(rounds, model.groups), ""
    for grading in range(1, MAX_GRADINGS + 1):
        model, solution = task.solve_graded(model, solution, grading, rounds)
        rounds = keep_rounds(rounds, model.groups)
        results = summarise_contacts(model, solution)
        complaint = find_shortcoming(model, solution, results, options.size)
        watch.lap("check")
        if not complaint:
            return FullSolution(
                model=model,
                state=solution,
                contacts=results,
                options=options,
                pose_iterations=solution.iterations,
                rounds=rounds,
                seconds=watch.total(),
            )
        say(f"meshes graded anew ({grading}): {complaint}")
    hint = "; use smaller elements" if options.size > COARSE_SIZE else ""
    raise ConvergenceError(f"meshes do not fit the contacts after {MAX_GRADINGS} gradings: {complaint}{hint}")


def solve_load(previous: FullSolution, torque: float, *, progress: Callable[[str], None] | None = None) -> FullSolution:
    """Solve another output torque, N·mm, on the meshes and factors of a solution at the same crank angle."""
    return solve_moment(previous, previous.model.drive.wheel_moment(torque), progress=progress)


def solve_moment(
    previous: FullSolution,
    wheel_moment: float,
    *,
    pose_tolerance: float = POSE_TOLERANCE,
    regraded: bool = True,
    progress: Callable[[str], None] | None = None,
) -> FullSolution:
    """Solve for another moment on the wheel, N·mm, on the meshes of a solution at the same crank angle where they serve.

    The pose has converged when no increment is larger than `pose_tolerance`, mm. Where the meshes do not serve, new ones are
    graded; with `regraded` false the meshes stay, whatever their elements, and ConvergenceError says why they do not serve.
    """
    watch = _Stopwatch()
    model = previous.model
    solution = solve_pose(
        model,
        wheel_moment,
        start=previous.pose,
        start_active=previous.state.contact.active,
        pose_tolerance=pose_tolerance,
        progress=progress,
    )
    watch.lap("contact and pose")
    results = summarise_contacts(model, solution)
    if not regraded:
        _require_zones(model, solution, results)
    elif find_shortcoming(model, solution, results, previous.options.size):
        return solve_disc(
            model.drive,
            model.crank_angle,
            wheel_moment,
            previous.options,
            rounds=previous.rounds,
            by_others=model.by_others,
            progress=progress,
        )
    return replace(
        previous,
        state=solution,
        contacts=results,
        pose_iterations=solution.iterations,
        seconds=watch.total(),
    )


def refine_solution(
    coarse: CoarseSolution,
    *,
    rounds: tuple[RoundGroup, ...] = (),
    pose_tolerance: float = POSE_TOLERANCE,
    progress: Callable[[str], None] | None = None,
) -> FullSolution:
    """Solve under the same moment on the meshes of a solution with every element divided into four.

    Contact zones stay where they are, with twice the pressure unknowns; a ring is refined likewise.

    Parameters
    ----------
    coarse : CoarseSolution
        Of a solution on coarser meshes (`FullSolution.coarse`), whose pose starts the iteration.
    rounds : tuple of RoundGroup
        Condensed pins and rollers of another disc so refined.
    pose_tolerance : float
        Largest rigid increment of a converged pose, mm.
    progress : callable, optional
        Called with one line for each step.

    Returns
    -------
    FullSolution
        With `fem.options.SolutionOptions.halvings` increased by one.

    Raises
    ------
    ConvergenceError
        When the pose does not settle, or the contacts outgrow the zones of the coarser meshes.
    MemoryLimitError
        When the refined meshes would not fit into memory.
    """
    say, watch = progress or (lambda _: None), _Stopwatch()
    unknowns, drive = coarse.refined_unknowns, coarse.drive
    require_memory(unknowns, solution_memory(unknowns), "the refined mesh")
    options = replace(coarse.options, halvings=coarse.options.halvings + 1)
    say(f"meshes halved, {unknowns:,} unknowns")
    meshes = coarse.meshes.refined(coarse.shapes)
    watch.lap("mesh")
    model = condense_drive(
        drive,
        coarse.shapes,
        coarse.contacts,
        meshes,
        plane=options.plane,
        known=rounds,
        ring=None if drive.ring is None else ring_of_seats(drive, options.halvings),
        by_others=coarse.by_others,
    )
    watch.lap("assembly and factorisation")
    found = solve_pose(model, coarse.wheel_moment, start=coarse.pose, pose_tolerance=pose_tolerance, progress=progress)
    watch.lap("contact and pose")
    results = summarise_contacts(model, found)
    _require_zones(model, found, results)
    return FullSolution(
        model=model,
        state=found,
        contacts=results,
        options=options,
        pose_iterations=found.iterations,
        rounds=keep_rounds(rounds, model.groups),
        seconds=watch.total(),
    )


def _require_zones(model: DriveModel, solution: PoseSolution, results: ContactResults) -> None:
    """Raise ConvergenceError when the contacts outgrow the zones of meshes that are kept, whatever the size of their elements."""
    if complaint := find_shortcoming(model, solution, results):
        raise ConvergenceError(
            f"nested meshes do not serve the solution at crank angle {model.crank_angle:g} rad: {complaint}; "
            "use smaller elements"
        )


def _largest_approach(rigid: RigidBodies, guess: ExpectedContacts) -> float:
    """Return the largest overlap of rigid bodies in the guess, mm."""
    gaps = rigid.gaps(complex(guess.disc_x, guess.disc_y), guess.disc_rotation, guess.wheel_angle)
    return float(-np.concatenate([gaps.pins, gaps.rollers, gaps.holes]).min())
