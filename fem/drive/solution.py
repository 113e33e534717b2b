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
from fem.drive.contact_results import ContactResults, deformed_contacts, summarise_contacts
from fem.drive.expected_contacts import ExpectedContacts, guess_contacts, require_one_disc
from fem.drive.full_solution import CoarseSolution, FullSolution
from fem.drive.grading import FINE_SHARE, find_shortcoming, grade_contacts
from fem.drive.meshes import DriveMeshes, mesh_drive, require_model_memory
from fem.drive.model import PlacedContacts, RoundGroup
from fem.drive.pose import POSE_TOLERANCE, PoseSolution, WheelLoad, solve_poses
from fem.drive.rigid_bodies import RigidBodies
from fem.drive.supports import Supports
from fem.errors import MeshError
from fem.mesh.memory_need import require_memory, solution_memory
from fem.options import DEFAULT_OPTIONS, SolutionOptions
from fem.shapes import DriveShapes
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
class PlaneDisc:
    """One disc with its pins and rollers as plane bodies.

    Attributes
    ----------
    drive : Drive
        Of one disc.
    rigid : RigidBodies
        Its bodies as rigid ones.
    shapes : DriveShapes
        Exact shapes.
    guess : ExpectedContacts
        Contacts of rigid bodies on springs.
    approach : float
        Largest overlap in the guess, mm.
    """

    drive: Drive
    rigid: RigidBodies
    shapes: DriveShapes
    guess: ExpectedContacts
    approach: float

    @classmethod
    def of_single(cls, drive: Drive, crank_angle: float, wheel_moment: float) -> PlaneDisc:
        """Return the disc of a drive of one under a moment on the wheel, N·mm."""
        rigid = RigidBodies.of_drive(drive, crank_angle)
        guess = guess_contacts(drive, crank_angle, wheel_moment=wheel_moment)
        return cls(
            drive=drive,
            rigid=rigid,
            shapes=DriveShapes.of_drive(drive),
            guess=guess,
            approach=_largest_approach(rigid, guess),
        )

    @property
    def guessed(self) -> ExpectedContacts:
        """The contacts of the coarse meshes: wherever the guess has a load."""
        guess = self.guess
        loads = (guess.pins.load, guess.rollers_outer.load, guess.holes.load)
        place = complex(guess.disc_x, guess.disc_y), guess.disc_rotation, guess.wheel_angle
        margin = COARSE_MARGIN * self.approach
        return grade_contacts(self.drive, self.rigid, *place, loads, margin=margin, smallest_share=COARSE_SHARE)

    def graded(self, model: PlacedContacts, solution: PoseSolution, grading: int) -> ExpectedContacts:
        """Return the contacts of a solution on other meshes."""
        results, pose = summarise_contacts(model, solution), solution.pose
        return grade_contacts(
            self.drive,
            self.rigid.moved(*pose.displacements),
            pose.disc_displacement,
            pose.disc_rotation,
            pose.wheel_angle,
            (results.pin_load, results.roller_load, results.pin_shaft_load),
            # A contact that closes although the rigid bodies leave it open is caught by the wider margin next time.
            margin=FINE_MARGIN * 3.0 ** (grading - 1) * self.approach,
            smallest_share=FINE_SHARE,
            deformed=deformed_contacts(model, solution),
        )

    def fine(self, options: SolutionOptions) -> SolutionOptions:
        """Return the options of the graded meshes."""
        return replace(options, size=options.size * SIZE_RESERVE)

    def mesh(self, contacts: ExpectedContacts, options: SolutionOptions, rounds: tuple[RoundGroup, ...]) -> DriveMeshes:
        """Return meshes graded for contacts; those of known pins and rollers are taken again."""
        known = {group.made_of.grading: group.body for group in rounds}
        return mesh_drive(self.shapes, contacts, options, known=known)

    def condense(
        self,
        contacts: ExpectedContacts,
        meshes: DriveMeshes,
        options: SolutionOptions,
        rounds: tuple[RoundGroup, ...],
        say: Callable[[str], None],
    ) -> PlacedContacts:
        """Return the condensed bodies on meshes."""
        return condense_drive(self.drive, self.shapes, contacts, meshes, plane=options.plane, known=rounds)

    def shortcoming(
        self, model: PlacedContacts, solution: PoseSolution, results: ContactResults, options: SolutionOptions
    ) -> str:
        """Return why the meshes do not serve a solution, "" when they do."""
        return find_shortcoming(model, solution, results, options.size)


@dataclass(frozen=True, slots=True, kw_only=True)
class Task:
    """What stays the same through all stages of one solution."""

    discs: Sequence[PlaneDisc]
    supports: Supports
    load: WheelLoad
    options: SolutionOptions
    pose_tolerance: float
    say: Callable[[str], None]
    watch: Stopwatch

    def solve_guess(
        self, start: tuple[float, float, float, float] | None, rounds: tuple[RoundGroup, ...]
    ) -> tuple[list[PlacedContacts], tuple[PoseSolution, ...]]:
        """Solve on coarse meshes; `start` is that of every disc."""
        contacts = [disc.guessed for disc in self.discs]
        self.watch.lap("guess")
        self.say("coarse meshes")
        models = list[PlacedContacts]()
        for disc, expected in zip(self.discs, contacts, strict=True):
            models.append(self.condense_coarse(disc, expected, with_groups(rounds, models)))
        starts = None if start is None else [model.start_pose(start) for model in models]
        found = solve_poses(models, self.supports, self.load, starts, progress=self.say)
        self.watch.lap("coarse")
        return models, found

    def condense_coarse(
        self, disc: PlaneDisc, contacts: ExpectedContacts, rounds: tuple[RoundGroup, ...]
    ) -> PlacedContacts:
        """Return a disc on coarse meshes."""
        coarse = SolutionOptions(
            size=max(COARSE_SIZE, self.options.size), plane=self.options.plane, growth=COARSE_GROWTH
        )
        try:
            return disc.condense(contacts, disc.mesh(contacts, coarse, rounds), coarse, rounds, self.say)
        except MeshError:
            # Fast growth in a narrow place may end in too flat triangles; a drive is not refused for that.
            slow = replace(coarse, growth=self.options.growth)
            return disc.condense(contacts, disc.mesh(contacts, slow, rounds), slow, rounds, self.say)

    def solve_graded(
        self,
        models: Sequence[PlacedContacts],
        found: Sequence[PoseSolution],
        rounds: tuple[RoundGroup, ...] = (),
    ) -> tuple[FullSolution, ...]:
        """Solve on meshes graded for the contacts of another solution, anew until they serve."""
        discs, complaints = self.discs, ["coarse"] * len(self.discs)
        for grading in range(1, MAX_GRADINGS + 1):
            models = self.grade(models, found, complaints, grading, rounds)
            load, starts = self.load, [each.pose for each in found]
            if load.output is not None:
                load = replace(load, moment=sum(each.wheel_moment for each in found))
            found = solve_poses(
                models, self.supports, load, starts, pose_tolerance=self.pose_tolerance, progress=self.say
            )
            self.watch.lap("contact and pose")
            rounds = with_groups(rounds, models)
            results = [summarise_contacts(model, own) for model, own in zip(models, found, strict=True)]
            complaints = [
                disc.shortcoming(model, own, contacts, self.options)
                for disc, model, own, contacts in zip(discs, models, found, results, strict=True)
            ]
            self.watch.lap("check")
            if not any(complaints):
                return _solutions(models, found, results, self.options, rounds, self.watch)
            complaint = next(filter(None, complaints))
            self.say(f"meshes graded anew ({grading}): {complaint}")
        hint = "; use smaller elements" if self.options.size > COARSE_SIZE else ""
        raise ConvergenceError(f"meshes do not fit the contacts after {MAX_GRADINGS} gradings: {complaint}{hint}")

    def grade(
        self,
        models: Sequence[PlacedContacts],
        found: Sequence[PoseSolution],
        complaints: Sequence[str],
        grading: int,
        rounds: tuple[RoundGroup, ...],
    ) -> list[PlacedContacts]:
        """Return the discs on meshes graded for the contacts of another solution, those without complaint as they are."""
        graded, made = list(models), list[PlacedContacts]()
        for number, (disc, model, own) in enumerate(zip(self.discs, models, found, strict=True)):
            if not complaints[number]:
                continue
            contacts = disc.graded(model, own, grading)
            self.say("meshes" if len(self.discs) == 1 else f"disc {number}: meshes")
            known = with_groups(rounds, made)
            meshes = disc.mesh(contacts, disc.fine(self.options), known)
            self.watch.lap("mesh")
            graded[number] = disc.condense(contacts, meshes, self.options, known, self.say)
            made.append(graded[number])
            self.watch.lap("assembly and factorisation")
        return graded


def with_groups(rounds: tuple[RoundGroup, ...], models: Sequence[PlacedContacts]) -> tuple[RoundGroup, ...]:
    """Return plane pins and rollers known before and those of other discs."""
    for model in models:
        rounds = keep_rounds(rounds, tuple(group for group in model.groups if isinstance(group, RoundGroup)))
    return rounds


class Stopwatch:
    """Wall time by stages."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self._last = time.perf_counter()

    def lap(self, stage: str) -> None:
        """Count the time since the last call to a stage."""
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
    watch, discs = Stopwatch(), plane_discs(drive, crank_angle, load)
    require_model_memory([(disc.shapes, disc.guess) for disc in discs], options)
    return solve_plane_discs(drive, discs, load, options, watch, start, rounds, pose_tolerance, progress)


def plane_discs(drive: Drive, crank_angle: float, load: WheelLoad) -> tuple[PlaneDisc, ...]:
    """Return every disc of a drive, under an equal share of the moment on the wheel."""
    singles = single_discs(drive)
    return tuple(PlaneDisc.of_single(single, crank_angle, load.moment / len(singles)) for single in singles)


def solve_plane_discs(
    drive: Drive,
    discs: Sequence[PlaneDisc],
    load: WheelLoad,
    options: SolutionOptions,
    watch: Stopwatch,
    start: tuple[float, float, float, float] | None = None,
    rounds: tuple[RoundGroup, ...] = (),
    pose_tolerance: float = POSE_TOLERANCE,
    progress: Callable[[str], None] | None = None,
) -> tuple[FullSolution, ...]:
    """Solve the discs of an accepted drive as plane bodies: coarse, then graded; arguments of `solve_discs`."""
    task = Task(
        discs=discs,
        supports=Supports.of_drive(drive),
        load=load,
        options=options,
        pose_tolerance=pose_tolerance,
        say=progress or (lambda _: None),
        watch=watch,
    )
    try:
        models, found = task.solve_guess(start, rounds)
    except ConvergenceError as error:
        if (idle := _idle_disc(discs, load.moment)) is None:
            raise
        raise ConvergenceError(
            f"disc {idle} carries less than {LEAST_SHARE:g} of the mean share of the wheel's moment: finite elements cannot "
            "say where a disc without load rests",
            error.history,
        ) from None
    return task.solve_graded(models, found, with_groups(rounds, models))


def _idle_disc(discs: Sequence[PlaneDisc], moment: float) -> int | None:
    """The first disc that is hardly touched where another one carries all of the moment, by springs between rigid bodies."""

    def wound(disc: PlaneDisc, part: float) -> float:
        guess = guess_contacts(disc.drive, disc.rigid.crank_angle, wheel_moment=part * moment)
        return float(np.sign(moment)) * guess.wheel_angle

    alone = [wound(disc, 1.0) for disc in discs]
    for number, disc in enumerate(discs):
        others = alone[:number] + alone[number + 1 :]
        if others and min(others) < wound(disc, LEAST_SHARE / len(discs)):
            return number
    return None


def _solutions(
    models: Sequence[PlacedContacts],
    found: Sequence[PoseSolution],
    results: Sequence[ContactResults],
    options: SolutionOptions,
    rounds: tuple[RoundGroup, ...],
    watch: Stopwatch,
) -> tuple[FullSolution, ...]:
    seconds = watch.total()
    return tuple(
        FullSolution(
            model=model,
            state=own,
            contacts=contacts,
            options=options,
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
    watch, options = Stopwatch(), previous[0].options
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
    say, watch, options = progress or (lambda _: None), Stopwatch(), coarse[0].options
    options = replace(options, halvings=options.halvings + 1)
    unknowns = sum(own.refined_unknowns for own in coarse)
    require_memory(unknowns, solution_memory(unknowns), "the refined mesh")
    models, rounds = list[PlacedContacts](), tuple[RoundGroup, ...]()
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
