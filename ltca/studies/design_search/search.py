"""From requirements to designs; where none fits, the relaxations that would make one fit.

Each requirement in turn becomes the objective, violated as little as possible with all others held: enumeration and refinement
say which value would do. Where no single one is enough, pairs are relaxed by the same factor.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, as_completed
from dataclasses import dataclass, replace
from itertools import combinations as pairs_of
from math import ceil, exp, floor, log10
from time import monotonic

import numpy as np

from ltca.compliance.coefficient_files import expected_seconds, has_coefficients, told_seconds
from ltca.compliance.ring import expected_ring_seconds
from ltca.drive.parts import Compliance
from ltca.drive.ring_shape import has_ring_of_elements
from ltca.studies.design_search.demands import TIGHTENED, Demand, find_demands
from ltca.studies.design_search.enumeration import MAX_ROOM_FACTOR, Enumeration, enumerate_candidates, size_of
from ltca.studies.design_search.refinement import Refined, Task, finish, refine
from ltca.studies.design_search.requirements import Requirements
from ltca.studies.design_search.sizes import LEAST_DISTANCE, distance, drive_of
from ltca.studies.design_search.solution import HOURS
from ltca.studies.shapes import shapes_of

CANDIDATES = 6
"""Candidates that are refined."""
RELAXED_CANDIDATES = 3
TORQUE_PARTS = 0.85, 0.7, 0.55, 0.4, 0.28, 0.2, 0.14, 0.1
"""Parts of the torque that are tried where it is relaxed."""
MAX_ENUMERATIONS = 2
"""The second is with closed forms shifted by the margins of solved drives, where the first leads to no design."""
CANDIDATE_TOLERANCE = 0.1
"""Candidate tolerance on logarithmic margins of closed forms."""
MAX_RELAXED_SOLUTIONS = 8
"""Coarse solutions of all candidates of one relaxation: what bounds the time of a search in vain."""
MAX_PAIRS = 6
"""Pairs of requirements that are refined, those first that closed forms violate least."""
FUTILE_DERIVATION = 120.0
"""Expected time of derivations without any design that fits after which no further candidate is solved finely, s."""
CLEARANCE_PARTS = 0.7, 0.5, 0.3, 0.1
"""Parts of the least clearance that are tried where it gives way."""
DIGITS = 4
"""Significant digits of values that would do."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Relaxation:
    """Smallest relaxation of one or two requirements that makes the design feasible.

    Attributes
    ----------
    demands : tuple of Demand
        Those that are relaxed.
    refined : Refined or None
        The design that then fits; None where none was found.
    combinations : int
        Combinations of sizes that were enumerated.
    broken : float or None
        Least sum of violations of the others by closed forms (ln); None without candidates.
    solved : int
        Loaded drives that were solved.
    speed : float
        That was asked of the output, rpm.
    """

    demands: tuple[Demand, ...]
    refined: Refined | None
    combinations: int
    broken: float | None
    solved: int = 0
    speed: float = 0.0

    @property
    def name(self) -> str:
        """Names of the requirements, joined."""
        return "-and-".join(one.name for one in self.demands)

    @property
    def change(self) -> float:
        """Largest `Demand.change` of its requirements; infinite where no design was found."""
        if self.refined is None:
            return float("inf")
        return max(one.change(self.refined.solution.values[one.quantity]) for one in self.demands)

    def would_do(self, demand: Demand) -> float | None:
        """Return the value of a requirement that would do, rounded to the side that does."""
        if self.refined is None:
            return None
        return rounded_safely(self.refined.solution.values[demand.quantity], demand.sense)

    @property
    def words(self) -> str:
        """The same as a sentence."""
        asked = " and ".join(
            f"{one.name if '.' in one.name else one.name.replace('_', ' ')} {one.words()}" for one in self.demands
        )
        if self.refined is None:
            alone = "alone" if len(self.demands) == 1 else "together"
            room = any(one.name in ("outer_diameter", "length") for one in self.demands)
            return f"{asked}: not enough {alone}{f' (tried to × {MAX_ROOM_FACTOR:g})' if room else ''}"
        found = " with ".join(one.words(self.would_do(one)) for one in self.demands)
        return f"{asked}: {found} would do{self._slower}"

    @property
    def _slower(self) -> str:
        """The speed at which hours that are asked for would be reached: they are turns by speed."""
        (demand, *others) = self.demands
        hours = None if others or demand.quantity != HOURS else self.would_do(demand)
        if hours is None or self.speed == 0.0:
            return ""
        return f", as would {rounded_safely(self.speed * hours / demand.value, 'min'):g} rpm at the output"


@dataclass(frozen=True, slots=True, kw_only=True)
class Found:
    """What a search found.

    Attributes
    ----------
    requirements : Requirements
        What was asked.
    demands : tuple of Demand
        Of it.
    designs : tuple of Refined
        That fit, best first.
    tried : tuple of Refined
        Candidates that were refined and do not.
    relaxations : tuple of Relaxation
        Where nothing fits: what would do first, by the least change.
    combinations, solved : int
        Combinations evaluated by closed forms; loaded drives that were solved.
    """

    requirements: Requirements
    demands: tuple[Demand, ...]
    designs: tuple[Refined, ...]
    tried: tuple[Refined, ...]
    relaxations: tuple[Relaxation, ...]
    combinations: int
    solved: int


def rounded_safely(value: float, sense: str) -> float:
    """Return a value with a few digits, rounded up for a limit of sense ``max`` and down for ``min``.

    Examples
    --------
    >>> rounded_safely(71.3521, "max"), rounded_safely(0.86129, "min")
    (71.36, 0.8612)
    """
    if value == 0.0:
        return 0.0
    digits = DIGITS - 1 - floor(log10(abs(value)))
    scaled = value * 10.0**digits
    whole = round(scaled) if abs(scaled - round(scaled)) < 1e-6 else (ceil(scaled) if sense == "max" else floor(scaled))
    return round(whole / 10.0**digits, max(digits, 0))


def relax(requirements: Requirements, demands: tuple[Demand, ...], names: tuple[str, ...]) -> Relaxation:
    """Return the smallest relaxation of the named demands that makes the design feasible, all others held."""
    combinations, solved, coarse, best = 0, 0, 0, None
    shifts: dict[str, float] = {}
    giving = tuple(one for one in demands if one.name in names)
    for _ in range(MAX_ENUMERATIONS):
        # Less torque or clearance changes what fits: start from the largest part of it for which there is a candidate.
        for part in _parts(names):
            at = _given_way(requirements, names, part)
            found = enumerate_candidates(requirements, demands, names, RELAXED_CANDIDATES, shifts, **at)
            combinations += found.combinations
            if found.broken.size and found.broken.min() < CANDIDATE_TOLERANCE:
                break
        tasks = [Task(requirements=requirements, demands=demands, row=row, relaxed=names) for row in _rows(found)]
        refined = []
        for task in tasks:
            if coarse < MAX_RELAXED_SOLUTIONS:
                refined.append(refine(task, MAX_RELAXED_SOLUTIONS - coarse))
                coarse += refined[-1].solved
        for one in sorted((one for one in refined if one.fits), key=lambda one: one.given):
            fine = finish(Task(requirements=requirements, demands=demands, row=one.row, relaxed=names))
            solved += fine.solved
            if fine.fits:
                best = fine
                break
        shifts = mean_shifts(refined)
        if best is not None or not shifts or coarse >= MAX_RELAXED_SOLUTIONS:
            break
    broken = float(found.broken.min()) if found.broken.size else None
    return Relaxation(
        demands=giving, refined=best, combinations=combinations, broken=broken, solved=coarse + solved,
        speed=requirements.asked.speed,
    )  # fmt: skip


def least_broken(requirements: Requirements, demands: tuple[Demand, ...], names: tuple[str, ...]) -> float:
    """Return the least violation of all other requirements by closed forms (ln); infinite where no candidate is left."""
    at = _given_way(requirements, names, _parts(names)[-1])
    return float(np.min(enumerate_candidates(requirements, demands, names, 1, None, **at).broken, initial=np.inf))


def _parts(names: tuple[str, ...]) -> tuple[float, ...]:
    """Parts of the torque or the clearances among names of demands that are tried."""
    if "torque" in names:
        return TORQUE_PARTS
    return CLEARANCE_PARTS if any(f"shop.{name}" in names for name in TIGHTENED) else (1.0,)


def _given_way(requirements: Requirements, names: tuple[str, ...], part: float) -> dict[str, float]:
    """Torque and clearances of which there is a part only, by name."""
    at = {"torque": part * requirements.asked.torque} if "torque" in names else {}
    tightest = requirements.asked.shop.tightest
    return at | {name: part * tightest[name] for name in TIGHTENED if f"shop.{name}" in names}


def find_designs(
    requirements: Requirements,
    executor: Executor,
    told: Callable[[str], None] = lambda step: None,
    best: int = 3,
    *,
    compliance: Compliance = "hybrid",
    kept: Callable[[Refined], None] = lambda refined: None,
) -> Found:
    """Return up to `best` designs that fit, or the relaxations that would make one fit.

    The executor refines candidates; `told` is called with a line for each step of the search, `kept` with each candidate that
    fits as soon as it is refined, and with each design as soon as its fine solution passes. Candidates and relaxations are solved
    on half-spaces, designs in the end with the `compliance` asked for.
    """
    demands = find_demands(requirements)
    told("combinations")
    most = max(CANDIDATES, 2 * best)
    found = enumerate_candidates(requirements, demands, (), most)
    refined = _refine_all(requirements, demands, _rows(found), executor, told, kept)
    looked = found.combinations
    if not any(one.fits for one in refined) and (shifts := mean_shifts(refined)):
        # Closed forms that err on one side choose the wrong candidates: once more, shifted by the solved drives.
        found = enumerate_candidates(requirements, demands, (), most, shifts=shifts)
        refined += _refine_all(requirements, demands, _rows(found), executor, told, kept)
        looked += found.combinations
    solved = sum(one.solved for one in refined)
    smallest = requirements.asked.smallest
    coarse = _once(sorted((one for one in refined if one.fits), key=lambda one: _size(one, smallest)))
    designs: list[Refined] = []
    missed = [one for one in refined if not one.fits]
    fits_on_half_spaces, spent, last = bool(coarse), 0.0, ""
    while coarse and len(designs) < best and (designs or spent < FUTILE_DERIVATION):
        each = 0.0 if compliance == "half-space" else _derivation(requirements, coarse[0])
        bodies = (
            f" on {compliance}, whose coefficients take {told_seconds(each)} on a free core for each drive that is tried{last}"
            if each
            else ""
        )
        # Coefficients are dear: one alone first, which tells whether half-spaces flattered.
        count = 1 if each and not designs else best - len(designs)
        now, coarse = coarse[:count], coarse[count:]
        tasks = [Task(requirements=requirements, demands=demands, row=one.row, compliance=compliance) for one in now]
        began, finely, so_far = monotonic(), dict[int, Refined](), len(designs)
        in_all = min(best, so_far + len(now) + len(coarse))

        def begun(number: int, words: str = bodies, before: int = so_far, of: int = in_all) -> None:
            told(f"designs solved finely{words}: {before + number} of {of}")

        for number, one in _as_done(executor, finish, tasks, begun):
            finely[number] = one
            if one.fits:
                kept(one)
        last = f", the last took {told_seconds((monotonic() - began) / len(tasks))} with its solutions"
        done = [finely[number] for number in sorted(finely)]
        solved += sum(one.solved for one in done)
        spent += each * sum(one.solved for one in done)
        designs += [one for one in done if one.fits]
        missed += [one for one in done if not one.fits]
    relaxations: list[Relaxation] = []
    if not designs:
        # Nothing stands in the way of half-spaces where they have a drive that fits: what finer bodies break does.
        speed = requirements.asked.speed
        relaxations = (
            _broken_by_bodies(demands, missed, speed) if fits_on_half_spaces and compliance != "half-space" else []
        )
        relaxations = relaxations or _stand_in_the_way(requirements, demands, missed, executor, told)
        looked += sum(one.combinations for one in relaxations)
        solved += sum(one.solved for one in relaxations)
        # A relaxation of nothing fits as it is, if a solution with every limit in place confirms it.
        whole = [one.refined for one in relaxations if one.refined is not None and one.refined.given <= 0.0]
        whole = sorted(whole, key=lambda one: _size(one, smallest))[: 1 if compliance != "half-space" else len(whole)]
        tasks = [Task(requirements=requirements, demands=demands, row=one.row, compliance=compliance) for one in whole]
        fine = [finish(task) for task in tasks]
        designs = [one for one in fine if one.fits]
    designs.sort(key=lambda one: _size(one, smallest))
    return Found(
        requirements=requirements,
        demands=demands,
        designs=tuple(_once(designs)),
        tried=tuple(missed),
        relaxations=() if designs else tuple(relaxations),
        combinations=looked,
        solved=solved,
    )


def _derivation(requirements: Requirements, refined: Refined) -> float:
    """About how long the coefficients of a candidate take, s, with those of a ring of finite elements."""
    drive = drive_of(refined.row, requirements)
    bodies = shapes_of([drive]).values()
    ring = expected_ring_seconds(drive) if has_ring_of_elements(drive) else 0.0
    return sum(expected_seconds([body for body in bodies if not has_coefficients(body)])) + ring


def _broken_by_bodies(demands: tuple[Demand, ...], missed: list[Refined], speed: float) -> list[Relaxation]:
    """Return what drives that fit on half-spaces break on finer bodies, the least change first: its values would do."""
    found: dict[tuple[str, ...], Relaxation] = {}
    for one in missed:
        giving = tuple(demand for demand in demands if demand.name in one.broken and demand.kind != "share")
        if not one.solution.checks or not giving or len(giving) < len(one.broken):
            continue
        names = tuple(demand.name for demand in giving)
        refined = replace(one, given=max(one.broken.values()), relaxed=names, fits=True)
        relaxation = Relaxation(demands=giving, refined=refined, combinations=0, broken=0.0, speed=speed)
        if names not in found or relaxation.change < found[names].change:
            found[names] = relaxation
    return sorted(found.values(), key=lambda one: one.change)


def _rows(found: Enumeration) -> list[dict[str, float]]:
    return [] if found.sizes is None else [found.sizes.take([place]).row() for place in range(found.sizes.count)]


def mean_shifts(refined: list[Refined]) -> dict[str, float]:
    """Return by name the mean difference between margins of solved drives and those of closed forms."""
    each = [one.shifts for one in refined if one.shifts]
    names = set().union(*each) if each else set()
    return {name: float(np.mean([one[name] for one in each if name in one])) for name in sorted(names)}


def _size(refined: Refined, smallest: str) -> float:
    return float(size_of({name: np.array(value) for name, value in refined.solution.values.items()}, smallest))


def _refine_all(
    requirements: Requirements,
    demands: tuple[Demand, ...],
    rows: list[dict[str, float]],
    executor: Executor,
    told: Callable[[str], None],
    kept: Callable[[Refined], None],
) -> list[Refined]:
    """Refine candidates by the executor; results are in the order of the rows, `kept` is called with each that fits."""
    tasks = [Task(requirements=requirements, demands=demands, row=row) for row in rows]
    done: dict[int, Refined] = {}
    for number, one in _as_done(executor, refine, tasks, lambda number: told(f"candidate {number + 1} of {len(rows)}")):
        done[number] = one
        if one.fits:
            kept(one)
        told(f"candidates refined: {len(done)} of {len(rows)}")
    return [done[number] for number in sorted(done)]


def _as_done(
    executor: Executor, solve: Callable[[Task], Refined], tasks: list[Task], begun: Callable[[int], None]
) -> Iterator[tuple[int, Refined]]:
    """Hand in tasks and give what they found, with their numbers, as they are done.

    `begun` is called before each is handed in; an executor that works at once gives one before the next begins.
    """
    waiting: dict[Future[Refined], int] = {}
    for number, task in enumerate(tasks):
        begun(number)
        future = executor.submit(solve, task)
        if future.done():
            yield number, future.result()
        else:
            waiting[future] = number
    for future in as_completed(waiting):
        yield waiting[future], future.result()


def _stand_in_the_way(
    requirements: Requirements,
    demands: tuple[Demand, ...],
    tried: list[Refined],
    executor: Executor,
    told: Callable[[str], None],
) -> list[Relaxation]:
    asked = [one for one in demands if one.kind in ("requirement", "limit")]
    clearances = clearances_in_the_way(demands)
    alone = [(one.name,) for one in (*asked, *clearances)]
    together = [tuple(one.name for one in clearances)] if len(clearances) > 1 else []
    single = _relax_all(requirements, demands, [*alone, *together], executor, told)
    if any(one.refined is not None for one in single):
        return sorted(single, key=lambda one: one.change)
    # All pairs by closed forms, the likeliest by loaded drives; of equal ones those that candidates violated come first.
    broken = {name for one in tried for name in one.broken}
    room = ("outer_diameter", "length", "torque")
    order = sorted(asked, key=lambda one: (one.name not in broken, one.name not in room))
    names: list[tuple[str, ...]] = [(first.name, second.name) for first, second in pairs_of(order, 2)]
    names += [(one.name, clearances[0].name) for one in order if clearances]
    told(f"pairs that stand in the way: {len(names)}")
    chances = [
        future.result() for future in [executor.submit(least_broken, requirements, demands, own) for own in names]
    ]
    likely = sorted(range(len(names)), key=lambda place: chances[place])[:MAX_PAIRS]
    pairs = [names[place] for place in likely if np.isfinite(chances[place])]
    return sorted(_relax_all(requirements, demands, pairs, executor, told), key=lambda one: one.change) + single


def _relax_all(
    requirements: Requirements,
    demands: tuple[Demand, ...],
    names: list[tuple[str, ...]],
    executor: Executor,
    told: Callable[[str], None],
) -> list[Relaxation]:
    futures = {}
    for number, own in enumerate(names):
        told(f"what stands in the way: {number + 1} of {len(names)}, {' and '.join(own)}")
        futures[executor.submit(relax, requirements, demands, own)] = number
    done: dict[int, Relaxation] = {}
    for future in as_completed(futures):
        done[futures[future]] = future.result()
        told(f"what stands in the way: {len(done)} of {len(names)}")
    return [done[number] for number in sorted(done)]


def clearances_in_the_way(demands: tuple[Demand, ...]) -> list[Demand]:
    """Return demands on clearances that may stand in the way: that of the flank shares loads, of play all have their part."""
    play = any(one.quantity in ("backlash_output", "lost_motion") and one.sense == "max" for one in demands)
    return [
        one
        for one in demands
        if one.kind == "clearance" and one.value > 0.0 and (play or one.quantity == "equidistant_offset")
    ]


def factor_words(relaxation: Relaxation) -> str:
    """Return the factor by which a requirement is relaxed, as text; empty where no relaxation was found."""
    if relaxation.refined is None:
        return ""
    return f"× {exp(relaxation.refined.given):.3g}"


def _once(designs: list[Refined]) -> list[Refined]:
    """Designs that are at least `LEAST_DISTANCE` from all before them."""
    found: list[Refined] = []
    for one in designs:
        if all(distance(one.row, other.row) >= LEAST_DISTANCE for other in found):
            found.append(one)
    return found
