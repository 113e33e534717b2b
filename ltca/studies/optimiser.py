"""Best fields of a drive under limits: scipy's differential evolution on the batch solver, Pareto front of two aims.

A generation is one batch. Candidates that break a limit or are no sound drive rank behind every one that is fine, by
how far they break it (the feasibility rule of Deb, Comput. Methods Appl. Mech. Eng. 186, 2000); the best one is refined
by Nelder and Mead's simplex.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ltca.analysis.engines import Engine, HalfSpace
from ltca.arrays import FloatArray
from ltca.drive.fields import ANY, field_kind, field_kinds, lacks_slices, not_a_field, read_field
from ltca.drive.members.bearings import bought_size
from ltca.drive.parts import Drive
from ltca.drive.units.quantities import label, parse_quantity
from ltca.errors import CycloError, DriveError, shortened
from ltca.geometry.placement import position_angles
from ltca.quantities import SCALARS
from ltca.reading.changes import with_fields
from ltca.studies.batch_analysis import BatchSettings, analyse_samples
from ltca.studies.quantities import check_quantities, quantities_for
from ltca.studies.shapes import rings_of, shapes_of

Analysis = Callable[[Sequence[Drive]], FloatArray]
"""Quantities of drives, shape (drives, quantities), not a number where one fails."""

BROKEN = 1e3
"""Rank of a candidate just beyond a limit; aims are scaled to the drive's own value, so all sound ones stay below."""
UNSOUND = 1e6
WEIGHTS = 9
"""Weighted problems behind a Pareto front, from three generations."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Variable:
    """One field to vary between two values, in its unit."""

    path: str
    low: float
    high: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Bound:
    """Bound of a quantity: at most (sense +1) or at least (−1) a value in its unit."""

    quantity: str
    sense: int
    value: float


def parse_variable(text: str, drive: Drive) -> Variable:
    """Read ``name``, ``path`` or either with ``=low:high``; half to one and a half of its value without a range."""
    name, _, span = text.partition("=")
    # A name alone is that of all discs; of one disc the whole path says it.
    kinds = {path: kind for path, kind in field_kinds().items() if f".{ANY}." not in path}
    parent = name.rpartition(".")[0]
    of_parent, own = field_kind(parent), field_kind(name)
    element = own is None and of_parent is not None and of_parent.is_array
    found = [name] if own or element else [path for path in kinds if path.rpartition(".")[2] == name]
    if len(found) != 1:
        last = [path.rpartition(".")[2] for path in kinds]
        hint = (
            f"may be {' or '.join(found)}: give the whole path"
            if found
            else not_a_field(drive, name, (*field_kinds(), *last))
        )
        raise DriveError([f"--vary {shortened(name)[1:-1]}: {hint}"])
    path = found[0]
    kind = of_parent if element else field_kind(path)
    unit = "" if kind is None else kind.unit
    if kind is None or not unit or (kind.is_array and not element):
        raise DriveError([f"--vary {path}: is not a single quantity"])
    if refused := bought_size(drive.crank_bearing, path):
        raise DriveError([f"--vary {refused}"])
    if refused := lacks_slices(drive, path):
        raise DriveError([f"--vary {path}: {refused}"])
    if span:
        ends = span.split(":")
        if len(ends) != 2:
            raise DriveError([f"--vary {shortened(text)[1:-1]}: write the range as {name}=low:high"])
        low, high = (parse_quantity(end.strip(), unit, f"--vary {path}") for end in ends)
    else:
        value = float(read_field(drive, path))
        low, high = sorted((0.5 * value, 1.5 * value))
    if not low < high:
        raise DriveError([f"--vary {path}: needs a range, as {name}=low:high with low less than high"])
    return Variable(path=path, low=low, high=high)


def parse_bound(text: str) -> Bound:
    """Read ``quantity <= value unit`` or ``quantity >= value unit``.

    Examples
    --------
    >>> parse_bound("max_pin_pressure_mid <= 1.5 GPa").value
    1500.0
    """
    match = re.fullmatch(r"\s*(\w+)\s*(<=|>=|≤|≥)\s*(.+?)\s*", text)
    if match is None:
        raise DriveError([f"--subject {shortened(text)}: write it as 'quantity <= value unit'"])
    name, sign, value = match.groups()
    check_quantities((name,))
    unit = SCALARS[name].unit
    number = parse_quantity(value, "dimensionless" if unit == "1" else unit, f"--subject {name}")
    return Bound(quantity=name, sense=1 if sign in ("<=", "≤") else -1, value=number)


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem:
    """What is to be optimised.

    Attributes
    ----------
    drive : Drive
        Where everything else comes from.
    variables : tuple of Variable
        What varies.
    aims : tuple of str
        One or two quantities to make small.
    limits : tuple of Bound
        What must hold.
    """

    drive: Drive
    variables: tuple[Variable, ...]
    aims: tuple[str, ...]
    limits: tuple[Bound, ...]

    @property
    def quantities(self) -> tuple[str, ...]:
        """Aims, then the quantities of the limits."""
        return tuple(dict.fromkeys((*self.aims, *(limit.quantity for limit in self.limits))))


def batch_analysis(problem: Problem, positions: int, engine: Engine | None = None) -> Analysis:
    """Return the analysis of candidates by the batch solver at crank angles 2πk/N, by default on half-spaces."""
    used: Engine = HalfSpace() if engine is None else engine
    quantities_for(problem.drive, problem.quantities)
    settings = BatchSettings(crank_angle=position_angles(positions), quantities=problem.quantities, engine=used)
    return lambda drives: analyse_samples(drives, settings).values


@dataclass(frozen=True, slots=True, kw_only=True)
class Optimum:
    """Outcome.

    Attributes
    ----------
    problem : Problem
        What was asked.
    variables : array, shape (candidates, variables)
        Every candidate that was solved, in its units.
    values : array, shape (candidates, quantities)
        Its quantities; not a number where it failed.
    feasible : array of bool, shape (candidates,)
        Whether it is sound and within the limits.
    start : array, shape (quantities,)
        Quantities of the drive as it is.
    best : int
        The best candidate by the first aim, or the front's compromise of two (nearest to both single optima, scaled).
    front : array of int
        Candidates that no other beats in both aims, by the first; the best alone for one aim.
    generations : int
        Batches solved.
    """

    problem: Problem
    variables: FloatArray
    values: FloatArray
    feasible: NDArray[np.bool_]
    start: FloatArray
    best: int
    front: NDArray[np.intp]
    generations: int

    def drive(self, candidate: int) -> Drive:
        """Return the drive of a candidate."""
        return with_fields(self.problem.drive, _fields(self.problem, self.variables[candidate]))


def _fields(problem: Problem, row: FloatArray) -> dict[str, Any]:
    return {variable.path: float(value) for variable, value in zip(problem.variables, row, strict=True)}


@dataclass(slots=True, kw_only=True)
class _Archive:
    """Every candidate solved so far; scalar ranks for the optimiser."""

    problem: Problem
    analysis: Analysis
    scale: FloatArray
    told: Callable[[int], None]
    rows: list[FloatArray] = field(default_factory=list)
    values: list[FloatArray] = field(default_factory=list)
    batches: int = 0

    def solve(self, places: FloatArray) -> FloatArray:
        """Solve candidates at places 0 … 1 of every range, shape (candidates, variables); return the quantities."""
        low = np.array([variable.low for variable in self.problem.variables])
        high = np.array([variable.high for variable in self.problem.variables])
        rows = low + (high - low) * np.clip(places, 0.0, 1.0)
        values = np.full((len(rows), len(self.problem.quantities)), np.nan)
        drives, sound = [], []
        for number, row in enumerate(rows):
            try:
                drives.append(with_fields(self.problem.drive, _fields(self.problem, row)))
                sound.append(number)
            except DriveError:
                continue  # a design that cannot be built: it ranks as unsound and stays in the record without values
        if drives:
            values[sound] = self.analysis(drives)
        self.rows += list(rows)
        self.values += list(values)
        self.batches += 1
        self.told(len(rows))
        return values

    def violation(self, values: FloatArray) -> FloatArray:
        """How far candidates break the limits, as a part of each; infinite where they failed."""
        columns = {name: number for number, name in enumerate(self.problem.quantities)}
        total = np.zeros(len(values))
        for limit in self.problem.limits:
            excess = limit.sense * (values[:, columns[limit.quantity]] - limit.value)
            total += np.maximum(excess, 0.0) / max(abs(limit.value), 1e-300)
        return np.where(np.isfinite(values).all(axis=1), total, np.inf)

    def rank(self, places: FloatArray, weights: FloatArray) -> FloatArray:
        """Return the number to make small: the larger of the weighted aims, then by what breaks."""
        values = self.solve(places)
        aims = values[:, : len(weights)] / self.scale
        # Chebyshev's distance reaches every point of a front, hollow ones too; the small sum keeps off its flats.
        merit = np.max(weights * aims, axis=1) + 1e-3 * aims @ weights
        broken = self.violation(values)
        return np.where(np.isinf(broken), UNSOUND, np.where(broken > 0.0, BROKEN + broken, merit))


def optimise(
    problem: Problem,
    analysis: Analysis,
    *,
    seed: int = 0,
    generations: int = 40,
    told: Callable[[int], None] = lambda candidates: None,
) -> Optimum:
    """Find the best candidate, for two aims the Pareto front.

    `generations` are those of differential evolution, a third of them for each of the weighted problems of a front, of which
    there are fewer below three generations; `told` is called with the number of candidates of each solved batch. Raises
    `CycloError` when the drive itself cannot be solved, or no candidate is sound and within the limits.
    """
    from scipy.optimize import differential_evolution, minimize

    start = analysis([problem.drive])[0]
    if not np.isfinite(start).all():
        raise CycloError("the drive to start from cannot be solved; 'cyclo run' says why")
    aims = len(problem.aims)
    scale = np.maximum(np.abs(start[:aims]), 1e-300)
    archive = _Archive(problem=problem, analysis=analysis, scale=scale, told=told)
    count = len(problem.variables)
    problems, maxiter, popsize, simplex = _effort(problem, generations)
    shares = [1.0] if aims == 1 else np.linspace(0.03, 0.97, problems)
    for number, share in enumerate(shares):
        weights = np.ones(1) if aims == 1 else np.array([share, 1.0 - share])

        def rank(places: FloatArray, weights: FloatArray = weights) -> FloatArray:
            return archive.rank(np.atleast_2d(places.T), weights)

        found = differential_evolution(
            rank,
            [(0.0, 1.0)] * count,
            maxiter=maxiter,
            popsize=popsize,
            tol=1e-4,
            rng=np.random.default_rng([seed, number]),
            polish=False,
            updating="deferred",
            vectorized=True,
            init="sobol",
        )
        if aims == 1:
            minimize(
                lambda place: float(rank(np.asarray(place)[:, None])[0]),
                found.x,
                method="Nelder-Mead",
                bounds=[(0.0, 1.0)] * count,
                options={"maxfev": simplex, "xatol": 1e-4, "fatol": 1e-7, "initial_simplex": _simplex(found.x)},
            )
    return _outcome(archive, start, aims)


def _effort(problem: Problem, generations: int) -> tuple[int, int, int, int]:
    """Weighted problems, generations of each, candidates of a generation for every variable, candidates of the simplex."""
    count = len(problem.variables)
    members = max(5, 24 // count)
    if len(problem.aims) == 1:
        return 1, generations, members, 4 * min(generations, 10) * count
    return min(WEIGHTS, 3 * generations), max(1, generations // 3), members, 0


def most_candidates(problem: Problem, generations: int) -> int:
    """Return how many candidates a search may solve at most."""
    problems, maxiter, popsize, simplex = _effort(problem, generations)
    # a Sobol sequence has a power of two of members
    members = 1 << (popsize * len(problem.variables) - 1).bit_length()
    return problems * members * (maxiter + 1) + simplex


def varies_shape(problem: Problem, engine: Engine) -> bool:
    """Tell whether candidates differ so much in shape or material that an engine has coefficients for each."""
    ends = _ends(problem)
    return len(shapes_of([problem.drive, *ends], engine)) > len(shapes_of([problem.drive], engine))


def varies_ring(problem: Problem, engine: Engine) -> bool:
    """Tell whether candidates differ so much in the shape of a ring of finite elements that each has its own."""
    return len(rings_of([problem.drive, *_ends(problem)], engine)) > 1


def _ends(problem: Problem) -> list[Drive]:
    return [
        with_fields(problem.drive, {variable.path: value}, check=False)
        for variable in problem.variables
        for value in (variable.low, variable.high)
    ]


def _simplex(place: FloatArray) -> FloatArray:
    """Corners one per cent of the ranges around a place, inside of them."""
    corners = np.tile(place, (place.size + 1, 1))
    for number in range(place.size):
        corners[number + 1, number] += 0.01 if place[number] < 0.5 else -0.01
    return corners


def _outcome(archive: _Archive, start: FloatArray, aims: int) -> Optimum:
    values, rows = np.array(archive.values), np.array(archive.rows)
    feasible = archive.violation(values) == 0.0
    if not feasible.any():
        raise CycloError(
            f"none of {len(rows)} candidates is sound and within the limits; widen --vary or relax --subject"
        )
    numbers = np.flatnonzero(feasible)
    if aims == 1:
        front = numbers[np.argmin(values[numbers, 0])][None]
        best = int(front[0])
    else:
        order = numbers[np.lexsort((values[numbers, 1], values[numbers, 0]))]
        least = np.minimum.accumulate(np.concatenate([[np.inf], values[order[:-1], 1]]))
        front = order[values[order, 1] < least]
        points = values[front][:, :2]
        spread = np.maximum(np.ptp(points, axis=0), 1e-300)
        best = int(front[np.argmin(np.hypot(*((points - points.min(axis=0)) / spread).T))])
    return Optimum(
        problem=archive.problem,
        variables=rows,
        values=values,
        feasible=feasible,
        start=start,
        best=best,
        front=np.asarray(front, dtype=np.intp),
        generations=archive.batches,
    )


MOST_OF_FRONT = 24
"""Designs of a Pareto front that are told one by one."""


def designs_of_front(optimum: Optimum) -> list[int]:
    """Return candidates of a Pareto front, by the first aim: all, or evenly many along it, its compromise among them."""
    points = optimum.values[optimum.front, :2]
    spread = np.maximum(np.ptp(points, axis=0), 1e-300)
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*(np.diff(points, axis=0) / spread).T))])
    places = np.linspace(0.0, along[-1], min(MOST_OF_FRONT, along.size))
    nearest = {int(np.argmin(np.abs(along - place))) for place in places}
    chosen = {int(optimum.front[number]) for number in nearest} | {optimum.best}
    return [int(candidate) for candidate in optimum.front if int(candidate) in chosen]


START_SEEN = 3.0
"""Distance of the drive as it is from a front, by its span, up to which axes go as far as the drive."""


def front_span(optimum: Optimum) -> tuple[float, float, float, float]:
    """Return least and most of both aims that show a front, and the drive as it is where that is near."""
    points, found = optimum.values[optimum.front, :2], []
    for aim, start in zip(points.T, optimum.start[:2], strict=True):
        low, high = float(aim.min()), float(aim.max())
        room = max(high - low, 1e-2 * abs(high))
        if low - START_SEEN * room <= start <= high + START_SEEN * room:
            low, high = min(low, float(start)), max(high, float(start))
        room = max(high - low, room)
        found += [low - 0.15 * room, high + 0.6 * room]
    return found[0], found[1], found[2], found[3]


def broken_limits(problem: Problem, values: Mapping[str, float]) -> tuple[Bound, ...]:
    """Return the limits that quantities break by more than rounding, 1e-6 of the limit."""
    return tuple(
        limit
        for limit in problem.limits
        if limit.sense * (values[limit.quantity] - limit.value) > 1e-6 * abs(limit.value)
    )


def describe_bound(limit: Bound) -> str:
    """Return a limit as it is written on the command line."""
    unit = SCALARS[limit.quantity].unit
    text = label(unit) if unit != "1" else ""
    return f"{limit.quantity} {'<=' if limit.sense > 0 else '>='} {limit.value:g} {text}".rstrip()
