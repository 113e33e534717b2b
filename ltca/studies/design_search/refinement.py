"""Continuous sizes by scipy, on closed forms corrected by solutions of the loaded drive.

The loaded drive is expensive, closed forms are cheap and wrong by some tenths. So the drive is solved, every margin of the
closed forms is shifted to the solution, the sizes are optimised on the corrected forms within a step (sequential least squares),
and the drive is solved again (space mapping: Bandler et al., IEEE Trans. Microwave Theory Tech. 52, 2004). Only the solution
counts in the end.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import asin, ceil, exp, floor, inf, isfinite, log, pi

import numpy as np
from numpy.typing import NDArray

from ltca.analysis.verdict.values import LIVES
from ltca.arrays import FloatArray
from ltca.compliance.coefficient_files import expected_seconds
from ltca.drive.members.judgement import ANYWHERE
from ltca.drive.members.limits import Limits
from ltca.drive.parts import Compliance
from ltca.errors import CycloError
from ltca.studies.design_search.closed_forms import Setting, closed_forms
from ltca.studies.design_search.demands import SAFETY, Demand, margins, written_limits
from ltca.studies.design_search.enumeration import size_of
from ltca.studies.design_search.requirements import CLEARANCES, FINEST_CLEARANCE, Requirements
from ltca.studies.design_search.sizes import CONTINUOUS, Sizes, drive_of
from ltca.studies.design_search.solution import Solution, solve_coarsely, solve_finely, with_lead_crown
from ltca.studies.shapes import shapes_of

MAX_COARSE_SOLUTIONS = 6
"""Solutions of a candidate over few positions."""
MAX_FINE_SOLUTIONS: dict[Compliance, int] = {"half-space": 2, "hybrid": 4}
"""Solutions over those of a check: sizes come from half-spaces, which may be far from what bodies do."""
LEAST_FINE_SOLUTIONS, DEAR_DERIVATIONS = 2, 100.0
"""Fine solutions that are made at least, and the time of derivations (s) from which no more are: of 99 teeth one takes 35 s."""
MAX_SIZE_STEP = 0.2
"""Largest change of a size between two solutions (ln)."""
DIFFERENCE = 1e-5
LEAST_SIZE_STEP = 2e-3
LEAST_GAIN = 5e-3
"""Gain in the objective below which no further solution is made (ln)."""
LEAST_PROGRESS = 0.7
"""Ratio of violations in succession above which a candidate is given up."""
SMALL_VIOLATION = 0.03
"""Violation (ln) that the next step may remove, whatever the progress."""
VIOLATION_WEIGHT = 30.0
"""Weight of violations against the objective."""
DECIMALS = 3
"""Decimals of sizes in mm, as on a drawing."""
LOOSENESS = 3e-3
"""What a clearance at its most is worth against the size (ln of a length): of drives of one size the looser is easier made."""
CLEARANCE_SCALE = 2.5
"""Coordinate of a clearance: mm by so many times its most, so that `MAX_SIZE_STEP` is half of that."""
TIGHTEST_PART = 0.1
"""Part of its least to which a clearance that gives way goes at most."""
ROOM_TOLERANCE = 1e-2
"""Excess of sizes over their room that counts as rounding, mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Task:
    """A candidate to refine.

    Attributes
    ----------
    requirements : Requirements
        What is asked.
    demands : tuple of Demand
        Of it.
    row : dict of str to float
        Where to start.
    relaxed : tuple of str
        Names of demands of which as little as possible is given; size counts where there are none.
    compliance : {"half-space", "hybrid"}
        How bodies yield in fine solutions; coarse ones are on half-spaces.
    """

    requirements: Requirements
    demands: tuple[Demand, ...]
    row: dict[str, float]
    relaxed: tuple[str, ...] = ()
    compliance: Compliance = "half-space"


@dataclass(frozen=True, slots=True, kw_only=True)
class Refined:
    """A refined candidate.

    Attributes
    ----------
    row : dict of str to float
        Its sizes.
    solution : Solution
        Of `refine` a coarse one, of `finish` a fine one.
    fits : bool
        Whether it keeps all demands.
    given : float
        Largest violation of the relaxed demands (ln).
    broken : dict of str to float
        Violations of the others, by name (ln).
    relaxed : tuple of str
        As asked.
    solved : int
        Solutions.
    shifts : dict of str to float
        Margins of the solution less those of closed forms, by name.
    """

    row: dict[str, float]
    solution: Solution
    fits: bool
    given: float
    broken: dict[str, float]
    relaxed: tuple[str, ...]
    solved: int
    shifts: dict[str, float]


def refine(task: Task, most: int = MAX_COARSE_SOLUTIONS) -> Refined:
    """Return a candidate with its best continuous sizes, solved coarsely: `finish` says whether it fits.

    The drive is solved `most` times or `MAX_COARSE_SOLUTIONS`, whichever is less.
    """
    row, best, last, solved = dict(task.row), None, None, 0
    life: float | None = None
    broken = np.inf
    row["rollers"] = float(max(most_rollers(row, task), row["rollers"]))
    row = with_lead_crown(row, task.requirements, _most_mid(task))
    for _ in range(min(most, MAX_COARSE_SOLUTIONS)):
        row = _rounded(row, task)
        solution, solved = solve_coarsely(row, task.requirements, task.demands, life), solved + 1
        life = solution.life_factor or life
        if not solution.values:
            last = last or (row, solution)
            if best is None:
                break
            row = _between(best[0], row)
            continue
        last = (row, solution)
        each = _actual(solution, task)
        worse, broken = broken, float(np.maximum(-each[_held(task)], 0.0).sum())
        if _keeps(each, task):
            aim = _aim(solution, each, task)
            gained = np.inf if best is None else _aim(best[1], _actual(best[1], task), task) - aim
            if gained > 0.0:
                best = row, solution
            if gained < LEAST_GAIN:
                break
        elif broken > max(LEAST_PROGRESS * worse, SMALL_VIOLATION) and best is None:
            break
        moved = _improve(row, each, task)
        if max(abs(_place(name, moved, task) - _place(name, row, task)) for name in _varied(task)) < LEAST_SIZE_STEP:
            break
        # A crown gives way before the drive does.
        row = with_lead_crown(moved, task.requirements, _most_mid(task)) if _presses_mid(each, task) else moved
    if best is None:
        row, solution = last or (row, Solution(values={}))
        return _told(row, solution, task, solved, fits=False)
    return _told(*best, task, solved, fits=True)


def finish(task: Task, solved: int = 0) -> Refined:
    """Return a refined candidate solved finely; where that finds larger values, sizes step back by as much."""
    # Sizes have moved since the crown was chosen.
    row, solution = with_lead_crown(dict(task.row), task.requirements, _most_mid(task)), Solution(values={})
    last = row
    # A life that gives way has no limit in the file any more, and has to be known all the same.
    lives = not task.relaxed or any(one.quantity in LIVES for one in task.demands)
    spent = 0.0
    for number in range(MAX_FINE_SOLUTIONS[task.compliance]):
        if number >= LEAST_FINE_SOLUTIONS and spent >= DEAR_DERIVATIONS:
            break
        try:
            drive = drive_of(row, task.requirements)
            if task.compliance != "half-space":
                spent += sum(expected_seconds(shapes_of([drive]).values()))
        except CycloError as error:
            solution = Solution(values={}, message=" ".join(str(error).split()))
            break
        last, limits = row, relaxed_limits(written_limits(task.requirements), task)
        solution, solved = (
            solve_finely(row, drive, limits, task.requirements, task.demands, lives=lives, compliance=task.compliance),
            solved + 1,
        )
        if not solution.values:
            break
        each = _actual(solution, task)
        if solution.passes and _keeps(each, task):
            return _told(row, solution, task, solved, fits=True)
        task = _as_judged(task, solution)
        row = _rounded(_improve(row, _actual(solution, task), task), task)
    return _told(last, solution, task, solved, fits=False)


def _as_judged(task: Task, solution: Solution) -> Task:
    """A task with the limits of pressures anywhere along the width that its solution fails: where contacts end decides which."""
    found = {(one.quantity, one.sense): one for one in task.demands}
    for check in solution.checks:
        value, limit = check.value, check.limit
        if limit is None or not check.fails or value.quantity not in ANYWHERE:
            continue
        before = found.get((value.quantity, limit.sense))
        known = before or Demand(
            name=value.quantity,
            quantity=value.quantity,
            sense=limit.sense,
            value=limit.value,
            kind="material",
            source="",
        )
        if known.name not in task.relaxed:
            found[value.quantity, limit.sense] = replace(known, value=limit.value, source=limit.source)
    return replace(task, demands=tuple(found.values()))


def relaxed_limits(limits: Limits, task: Task) -> Limits:
    """Return limits without those of demands that are relaxed."""
    gone = {f"{one.sense}_{one.quantity}" for one in task.demands if one.name in task.relaxed}
    return {key: limit for key, limit in limits.items() if key not in gone}


def most_rollers(row: dict[str, float], task: Task) -> int:
    """Return how many rollers go beside each other in the bearing of a candidate."""
    radius = row["roller_radius"]
    gap = float(task.requirements.asked.shop.roller_gap(2.0 * radius))
    part = (radius + 0.5 * gap) / (row["bore"] - radius)
    return max(3, floor(pi / asin(part) + 1e-9)) if part < 1.0 else 3


def _varied(task: Task) -> tuple[str, ...]:
    torque = ("torque",) if "torque" in task.relaxed else ()
    return (*CONTINUOUS, *torque, *(name for name in CLEARANCES if _clearance_range(name, task)))


def _clearance_range(name: str, task: Task) -> tuple[float, float] | None:
    """Ends between which a clearance is varied, mm; None where it is held."""
    low, high = task.requirements.asked.shop.range_of(name)
    if name == "pin_hole_clearance" and task.requirements.asked.kind == "rv":
        return None
    if f"shop.{name}" in task.relaxed:
        return max(FINEST_CLEARANCE, TIGHTEST_PART * low), high
    return (low, high) if low < high else None


def _place(name: str, row: dict[str, float], task: Task) -> float:
    """Coordinate of a size: its logarithm, of a clearance a part of its most."""
    return row[name] / _unit(name, task) if name in CLEARANCES else log(row[name])


def _size_at(name: str, place: float, task: Task) -> float:
    return place * _unit(name, task) if name in CLEARANCES else exp(place)


def _unit(name: str, task: Task) -> float:
    return CLEARANCE_SCALE * max(map(abs, task.requirements.asked.shop.range_of(name)))


def _tightness(row: dict[str, float], task: Task) -> float:
    """How far clearances are from their most, in the measure of sizes; a shift of the flank is neither tight nor loose."""
    found = 0.0
    for name in CLEARANCES:
        low, high = task.requirements.asked.shop.range_of(name)
        if name != "shifting_offset" and low < high:
            found += LOOSENESS * (high - row[name]) / (high - low)
    return found


def _actual(solution: Solution, task: Task) -> FloatArray:
    """Margins by the solution; not a number where it has no value."""
    values = {name: np.array([value]) for name, value in solution.values.items()}
    return np.asarray(margins(task.demands, values)[0])


def _most_mid(task: Task) -> float:
    """Largest flank pressure at mid-width that is held, MPa."""
    held = (one for one in task.demands if one.name not in task.relaxed)
    return min((one.value for one in held if (one.quantity, one.sense) == ("pin_pressure_mid", "max")), default=inf)


def _presses_mid(each: FloatArray, task: Task) -> bool:
    """Whether margins say that the flank is pressed too much at mid-width."""
    found = [margin for one, margin in zip(task.demands, each, strict=True) if one.quantity == "pin_pressure_mid"]
    return any(margin < -1e-9 for margin in found) and isfinite(_most_mid(task))


def _held(task: Task) -> NDArray[np.bool_]:
    return np.asarray([one.name not in task.relaxed for one in task.demands])


def _keeps(each: FloatArray, task: Task) -> bool:
    return bool(np.all(each[_held(task)] >= -1e-9))


def _given(each: FloatArray, task: Task) -> float:
    # What is not known has given everything.
    free = np.nan_to_num(each[~_held(task)], nan=-np.inf)
    return float(np.max(-free, initial=0.0))


def _aim(solution: Solution, each: FloatArray, task: Task) -> float:
    if task.relaxed:
        return _given(each, task)
    values = {name: np.array(value) for name, value in solution.values.items()}
    return float(size_of(values, task.requirements.asked.smallest)) + _tightness(solution.values, task)


def _rounded(row: dict[str, float], task: Task) -> dict[str, float]:
    """Sizes rounded as on a drawing, within the room there is."""
    found = {name: round(value, DECIMALS) if name in CONTINUOUS else value for name, value in row.items()}
    asked, shop = task.requirements.asked, task.requirements.asked.shop
    if "outer_diameter" not in task.relaxed:
        most = 0.5 * asked.outer_diameter - shop.housing_wall - row["pin_radius"]
        found["pin_circle"] = (
            min(found["pin_circle"], most) if found["pin_circle"] - most < ROOM_TOLERANCE else found["pin_circle"]
        )
    if "length" not in task.relaxed:
        most = (asked.length - shop.flanges - (row["discs"] - 1.0) * shop.disc_gap) / row["discs"]
        found["thickness"] = (
            min(found["thickness"], most) if found["thickness"] - most < ROOM_TOLERANCE else found["thickness"]
        )
    if 0.0 < row["roller_length"] - found["thickness"] < ROOM_TOLERANCE:
        found["thickness"] = row["roller_length"]
    for name in CLEARANCES:
        if (ends := _clearance_range(name, task)) is not None:
            steps = row[name] * 10.0**DECIMALS
            # To the looser side.
            whole = floor(steps + 1e-6) if name == "shifting_offset" else ceil(steps - 1e-6)
            found[name] = min(max(round(whole / 10.0**DECIMALS, DECIMALS), ends[0]), ends[1])
    found["torque"] = row["torque"] if row["torque"] == asked.torque else float(f"{row['torque']:.5g}")
    return found


def _between(first: dict[str, float], second: dict[str, float]) -> dict[str, float]:
    found = {name: (first[name] * second[name]) ** 0.5 if name in CONTINUOUS else first[name] for name in first}
    return found | {name: 0.5 * (first[name] + second[name]) for name in CLEARANCES}


def _improve(row: dict[str, float], actual: FloatArray, task: Task) -> dict[str, float]:
    """Optimise on closed forms shifted so that they equal the solution at `row`."""
    from scipy.optimize import minimize

    setting, names, held = Setting.of(task.requirements), _varied(task), _held(task)
    row = {**row, "rollers": float(most_rollers(row, task))}
    start = np.array([_place(name, row, task) for name in names])

    def sizes_at(place: FloatArray) -> dict[str, float]:
        return {name: _size_at(name, float(one), task) for name, one in zip(names, place, strict=True)}

    def forms(places: FloatArray) -> tuple[FloatArray, FloatArray]:
        rows = [row | sizes_at(place) for place in places]
        values = closed_forms(Sizes.of_rows(rows), setting)
        each = margins(task.demands, values)
        # What no closed form tells stays as it is.
        size = size_of(values, task.requirements.asked.smallest) + np.array([_tightness(one, task) for one in rows])
        return np.where(np.isnan(each), 0.0, each), size

    here = forms(start[None])[0][0]
    shape = np.array([one.kind == "shape" for one in task.demands])
    # A count of rollers that grew is not what was solved: shape is exact, and told anew.
    shift = np.where(shape | np.isnan(actual), 0.0, actual - here)
    scale = np.array([one.scale for one in task.demands])
    target = np.where(shape, 2.0 * 10.0**-DECIMALS / scale, SAFETY)
    exact = ("outer_diameter", "length", "torque", "roller_room", "flank_clearance", *CLEARANCES)
    target[[one.quantity in exact for one in task.demands]] = 0.0
    count = len(names)
    cache: dict[bytes, tuple[FloatArray, FloatArray, float, FloatArray]] = {}

    def known(full: FloatArray) -> tuple[FloatArray, FloatArray, float, FloatArray]:
        place = full[:count]
        key = place.tobytes()
        if key not in cache:
            each, size = forms(np.vstack([place, place + DIFFERENCE * np.eye(count)]))
            cache.clear()
            slopes, grows = ((each[1:] - each[0]) / DIFFERENCE).T, (size[1:] - size[0]) / DIFFERENCE
            cache[key] = each[0] + shift - target, slopes, float(size[0]), grows
        return cache[key]

    # Beside the sizes: how much of what is relaxed is given, and how much of the rest is broken.
    relaxes = bool(task.relaxed)

    def objective(full: FloatArray) -> float:
        _, _, size, _ = known(full)
        return float((full[count] + 1e-3 * size if relaxes else size) + VIOLATION_WEIGHT * full[count + 1])

    def slope(full: FloatArray) -> FloatArray:
        _, _, _, size = known(full)
        return np.concatenate([(1e-3 if relaxes else 1.0) * size, [1.0 if relaxes else 0.0, VIOLATION_WEIGHT]])

    def kept(full: FloatArray) -> FloatArray:
        return np.asarray(known(full)[0] + np.where(held, full[count + 1], full[count]))

    def kept_slope(full: FloatArray) -> FloatArray:
        return np.hstack([known(full)[1], np.where(held, 0.0, 1.0)[:, None], np.where(held, 1.0, 0.0)[:, None]])

    first = known(np.concatenate([start, [0.0, 0.0]]))[0]
    given, broken = (
        max(0.0, float(np.max(-first[~held], initial=0.0))),
        max(0.0, float(np.max(-first[held], initial=0.0))),
    )
    bounds = [(place - MAX_SIZE_STEP, place + MAX_SIZE_STEP) for place in start] + [
        (0.0, given + 3.0),
        (0.0, broken + 1.0),
    ]
    if "torque" in names:
        at = names.index("torque")
        bounds[at] = (
            start[at] - 2.0 * MAX_SIZE_STEP,
            min(start[at] + MAX_SIZE_STEP, float(np.log(task.requirements.asked.torque))),
        )
    for at, name in enumerate(names):
        if name in CLEARANCES and (ends := _clearance_range(name, task)) is not None:
            low, high = (end / _unit(name, task) for end in ends)
            bounds[at] = min(max(low, bounds[at][0]), high), max(min(high, bounds[at][1]), low)
    found = minimize(
        objective,
        np.concatenate([start, [given, broken]]),
        jac=slope,
        method="SLSQP",
        bounds=bounds,
        constraints=[{"type": "ineq", "fun": kept, "jac": kept_slope}],
        options={"maxiter": 60, "ftol": 1e-6},
    )
    place = np.clip(found.x[:count], [low for low, _ in bounds[:count]], [high for _, high in bounds[:count]])
    if not np.all(np.isfinite(place)):
        place = start
    return row | sizes_at(place)


def _told(row: dict[str, float], solution: Solution, task: Task, solved: int, *, fits: bool) -> Refined:
    each = _actual(solution, task) if solution.values else np.full(len(task.demands), np.nan)
    broken = {
        one.name: float(-margin)
        for one, margin in zip(task.demands, each, strict=True)
        if one.name not in task.relaxed and margin < -1e-9
    }
    closed = margins(task.demands, closed_forms(Sizes.of_rows([row]), Setting.of(task.requirements)))[0]
    moved = zip(task.demands, each - closed, strict=True)
    shifts = {one.name: float(shift) for one, shift in moved if one.kind != "shape" and np.isfinite(shift)}
    return Refined(
        row=row, solution=solution, fits=fits, given=_given(each, task), broken=broken, relaxed=task.relaxed,
        solved=solved,
        shifts=shifts,
    )  # fmt: skip
