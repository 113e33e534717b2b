"""All combinations of counts, stock sizes and coarse sizes, and the best of them by closed forms."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import pi, sin

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import FloatArray
from ltca.studies.design_search.closed_forms import (
    Setting,
    flank_shape,
    flank_values,
    inner_values,
    shape_values,
)
from ltca.studies.design_search.demands import Demand, margins
from ltca.studies.design_search.requirements import Requirements
from ltca.studies.design_search.sizes import LEAST_DISTANCE, Sizes, distance, joined

PIN_CIRCLE_RATIOS = 1.0 / np.geomspace(1.0, 2.2, 7)
"""Radii of the pin circle that are tried, as parts of the largest; refinement goes between them."""
THICKNESSES = np.array([1.0, 0.75, 0.5])
BORES = np.array([1.0, 0.85, 0.7, 0.5])
HOLES = (6, 8, 10, 12, 16)
SHORTENING = 0.25, 0.95
"""K1 = e z_P/R_C: below, levers are short; above, the flank comes to loops."""
STAGES = 1.0, 6.0
"""Ratios of the first stage of RV reducers."""
SUNS = range(12, 41)
PINS_OF_RV = range(20, 61)
MOST_PINS_OF_RV = 6
MAX_ROOM_FACTOR = 3.0
"""Largest factor by which room is widened where it is relaxed."""
KEPT_ECCENTRICITIES = 5
"""Candidates that are kept of each number of discs and pins, pin circle and thickness: of different eccentricities."""
LEAST_ROLLERS = 6
CLOSED_FORM_TOLERANCES = {
    "bearing_life_hours": 1.8,
    "bearing_life_million_turns": 1.8,
    "shaft_pin_bending_stress": 0.8,
    "shaft_pin_bending_amplitude": 0.8,
    "shaft_pin_shear_stress": 0.8,
}
CLOSED_FORM_TOLERANCE = 0.4
"""Violation of a demand by closed forms (ln) up to which a candidate is kept: their error is of that size."""
PENALTY, RELAXED_PENALTY = 2.0, 10.0
"""Weight of violations against size, and against the relaxation; lives go with high powers of loads."""
SPARE_WEIGHT = 0.1
"""Weight of the least margin of what is held against the relaxation: it tells candidates apart that give way alike."""
BATCH_ROWS = 100_000
"""Rows that are evaluated together, to bound memory."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Enumeration:
    """Best candidates of all combinations.

    Attributes
    ----------
    sizes : Sizes
        The best candidates, at least `LEAST_DISTANCE` from each other, best first.
    broken : array, shape (candidates,)
        Sum of what they break by closed forms (ln).
    combinations : int
        That were looked at.
    """

    sizes: Sizes | None
    broken: FloatArray
    combinations: int


def enumerate_candidates(
    requirements: Requirements,
    demands: Sequence[Demand],
    relaxed: Collection[str] = (),
    most: int = 6,
    shifts: Mapping[str, float] | None = None,
    **at: float,
) -> Enumeration:
    """Return up to `most` of the best candidates by closed forms.

    Demands in `relaxed` may be broken; `shifts` are by name how far margins of solved drives lay above those of closed forms;
    `at` replaces the ``torque`` on the output, N·mm, and clearances, mm, of which candidates have the least otherwise.
    """
    setting = Setting.of(requirements)
    found: list[Sizes] = []
    scores: list[FloatArray] = []
    broken: list[FloatArray] = []
    combinations = 0
    for flank, values, looked in _flanks(requirements, setting, demands, relaxed, at):
        combinations += looked
        for sizes, known in _inner(flank, values, requirements):
            combinations += sizes.count
            shape = shape_values(sizes, setting)
            held = margins([one for one in demands if one.kind == "shape"], shape).min(axis=1) >= -1e-9
            if not held.any():
                continue
            sizes, known = sizes.take(held), {name: value[held] for name, value in known.items()}
            reached = {name: value[held] for name, value in shape.items()} | known | inner_values(sizes, setting, known)
            score, breaks, kept = _scores(reached, demands, relaxed, requirements, shifts or {})
            if kept.any():
                best = np.flatnonzero(kept)[np.argsort(score[kept])[: 4 * most]]
                found.append(sizes.take(best))
                scores.append(score[best])
                broken.append(breaks[best])
    if not found:
        return Enumeration(sizes=None, broken=np.zeros(0), combinations=combinations)
    together, score, breaks = joined(found), np.concatenate(scores), np.concatenate(broken)
    chosen: list[int] = []
    rows: list[dict[str, float]] = []
    for place in np.argsort(score, kind="stable"):
        row = together.take([place]).row()
        near = sum((one["discs"], one["eccentricity"]) == (row["discs"], row["eccentricity"]) for one in rows)
        if near < 3 and all(distance(row, other) >= LEAST_DISTANCE for other in rows):
            rows.append(row)
            chosen.append(int(place))
        if len(chosen) == most:
            break
    return Enumeration(sizes=together.take(np.array(chosen)), broken=breaks[chosen], combinations=combinations)


def _scores(
    reached: dict[str, FloatArray],
    demands: Sequence[Demand],
    relaxed: Collection[str],
    requirements: Requirements,
    shifts: Mapping[str, float],
) -> tuple[FloatArray, FloatArray, NDArray[np.bool_]]:
    """Objective, sum of violations, and whether a combination is kept as a candidate."""
    judged = [one for one in demands if one.kind != "shape" and one.quantity in reached]
    each = margins(judged, reached) + np.array([shifts.get(one.name, 0.0) for one in judged])
    free = np.array([one.name in relaxed for one in judged])
    slack = np.array([CLOSED_FORM_TOLERANCES.get(one.quantity, CLOSED_FORM_TOLERANCE) for one in judged])
    fits = np.all((each >= -slack) | free, axis=1)
    breaks = np.where(free, 0.0, np.maximum(-each, 0.0)).sum(axis=1)
    given = np.where(free, np.maximum(-each, 0.0), 0.0).max(axis=1)
    aim = given if relaxed else size_of(reached, requirements.asked.smallest)
    penalty = RELAXED_PENALTY if relaxed else PENALTY
    if relaxed:  # of those that give way alike, the one with most to spare elsewhere
        spare = np.where(free, np.inf, each).min(axis=1, initial=np.inf)
        aim = aim - SPARE_WEIGHT * np.clip(spare, 0.0, CLOSED_FORM_TOLERANCE)
    return aim + penalty * breaks, breaks, np.asarray(fits & np.isfinite(breaks))


def size_of(reached: dict[str, FloatArray], smallest: str) -> FloatArray:
    """Return the logarithm of the size to be minimised, as a length; `reached` has ``outer_diameter`` and ``length`` in mm."""
    diameter, length = np.log(reached["outer_diameter"]), np.log(reached["length"])
    if smallest == "diameter":
        return np.asarray(diameter + 1e-3 * length)
    if smallest == "length":
        return np.asarray(length + 1e-3 * diameter)
    return np.asarray((2.0 * diameter + length) / 3.0)


def teeth(requirements: Requirements) -> list[tuple[int, float, int, int]]:
    """Return numbers of pins that give the ratio, with the first stage, its sun and its planet."""
    asked = requirements.asked
    allowed, more = asked.ratio * asked.ratio_tolerance + 1e-9, 1 if asked.held == "pin-wheel" else 0
    if asked.kind == "discs":
        low, high = int(np.ceil(asked.ratio - allowed)), int(np.floor(asked.ratio + allowed))
        nearest = sorted(range(low, high + 1), key=lambda ratio: abs(ratio - asked.ratio))[:MOST_PINS_OF_RV]
        return [(ratio + more, 1.0, 0, 0) for ratio in nearest if ratio + more >= 4]
    found = []
    for pins in PINS_OF_RV:
        wanted = (asked.ratio - more) / pins
        if not STAGES[0] <= wanted <= STAGES[1]:
            continue
        for sun in SUNS:
            planet = round(wanted * sun)
            if abs(planet * pins / sun + more - asked.ratio) <= allowed:
                found.append((pins, float(Fraction(planet, sun)), sun, planet))
                break
    step = max(1, -(-len(found) // MOST_PINS_OF_RV))
    return found[::step]


def _flanks(
    requirements: Requirements,
    setting: Setting,
    demands: Sequence[Demand],
    relaxed: Collection[str],
    at: Mapping[str, float],
) -> Iterator[tuple[Sizes, dict[str, FloatArray], int]]:
    """Flanks with their pins that are kept by closed forms, by number of discs and pins."""
    asked, shop, stock = requirements.asked, requirements.asked.shop, requirements.stock
    wider = MAX_ROOM_FACTOR if "outer_diameter" in relaxed else 1.0
    longer = MAX_ROOM_FACTOR if "length" in relaxed else 1.0
    circles = np.geomspace(0.9, wider, 10) if wider > 1.0 else PIN_CIRCLE_RATIOS
    given = {"torque": asked.torque, **asked.starting, **at}
    if asked.kind == "rv":
        given["pin_hole_clearance"] = 0.0
    for discs in asked.numbers_of_discs:
        room = (longer * asked.length - shop.flanges - (discs - 1) * shop.disc_gap) / discs
        if room <= 0.0:
            continue
        thicknesses = room * THICKNESSES if longer == 1.0 else room / longer * np.geomspace(0.75, longer, 4)
        for pins, stage, sun, planet in teeth(requirements):
            diameters, eccentricities = np.array(stock.wheel_pins), np.array(stock.eccentricities)
            part, e, pin, t = (
                one.ravel() for one in np.meshgrid(circles, eccentricities, 0.5 * diameters, thicknesses, indexing="ij")
            )
            circle = part * (0.5 * asked.outer_diameter - shop.housing_wall - 0.5 * diameters.min())
            if wider == 1.0:
                circle = part * (0.5 * asked.outer_diameter - shop.housing_wall - pin)
            ones = np.ones_like(t)
            sizes = Sizes(
                discs=discs * ones, pins=pins * ones, stage=stage * ones, sun=sun * ones, planet=planet * ones,
                eccentricity=e, pin_circle=circle, pin_radius=pin, thickness=t, bore=ones, roller_radius=ones,
                roller_length=ones, rollers=ones, holes=ones, hole_circle=ones, hole_pin=ones,
                **{name: value * ones for name, value in given.items()},
            )  # fmt: skip
            looked = sizes.count
            shortening = e * pins / np.maximum(circle, 1e-9)
            usual = (shortening >= SHORTENING[0]) & (shortening <= SHORTENING[1])
            sizes = sizes.take(usual & (circle > 0.0))
            shape = flank_shape(sizes, setting)
            sound = [one for one in demands if one.kind == "shape" and one.quantity in shape]
            sizes = sizes.take(margins(sound, shape).min(axis=1) >= 0.0) if sizes.count else sizes
            if not sizes.count:
                yield sizes, {}, looked
                continue
            values = flank_values(sizes, setting)
            kept = _different(sizes, values, demands, relaxed)
            yield sizes.take(kept), {name: value[kept] for name, value in values.items()}, looked


def _different(
    sizes: Sizes, values: dict[str, FloatArray], demands: Sequence[Demand], relaxed: Collection[str]
) -> NDArray[np.intp]:
    """Of each pin circle and thickness the least pressed flanks of some eccentricities."""
    judged = [one for one in demands if one.quantity == "pin_pressure_mid"]
    each = margins(judged, values).min(axis=1) if judged else -np.log(values["pin_pressure_mid"])
    if judged and not any(one.name in relaxed for one in judged):
        allowed = each >= -CLOSED_FORM_TOLERANCE
    else:
        allowed = np.ones(sizes.count, dtype=bool)
    best: dict[tuple[float, float, float], int] = {}
    for place in np.flatnonzero(allowed)[np.argsort(-each[allowed], kind="stable")]:
        key = (round(float(sizes.pin_circle[place] + sizes.pin_radius[place]), 1), float(sizes.thickness[place]))
        best.setdefault((*key, float(sizes.eccentricity[place])), int(place))
    groups: dict[tuple[float, float], list[int]] = {}
    for (room, thickness, _), place in best.items():
        groups.setdefault((room, thickness), []).append(place)
    chosen: list[int] = []
    for members in groups.values():
        # Larger eccentricities unload the bearing, smaller ones leave room for it: of all that go, evenly.
        ordered = sorted(members, key=lambda place: float(sizes.eccentricity[place]))
        step = max(1, -(-len(ordered) // KEPT_ECCENTRICITIES))
        chosen += ordered[::step]
    return np.array(chosen, dtype=np.intp)


def _inner(
    flank: Sizes, values: dict[str, FloatArray], requirements: Requirements
) -> Iterator[tuple[Sizes, dict[str, FloatArray]]]:
    """Yield crank bearings and holes that fit into flanks, in batches, with the closed-form values of the flanks.

    Of rollers of one diameter the longest that the disc is thick for is taken, of shaft pins of one diameter as many as
    stand beside each other: neither is ever worse but in friction, which they do not change.
    """
    if not flank.count:
        return
    asked, shop, stock = requirements.asked, requirements.asked.shop, requirements.stock
    diameters = np.unique([diameter for diameter, _ in stock.rollers])
    several = asked.kind == "rv"
    pins = np.array([0.0]) if several else 0.5 * np.array(stock.shaft_pins)
    roller, pin, part = (grid.ravel() for grid in np.meshgrid(0.5 * diameters, pins, BORES, indexing="ij"))
    piece = max(1, BATCH_ROWS // roller.size)
    for first in range(0, flank.count, piece):
        rows = np.arange(first, min(first + piece, flank.count))
        own, other = (grid.ravel() for grid in np.meshgrid(rows, np.arange(roller.size), indexing="ij"))
        e, thickness, r = flank.eccentricity[own], flank.thickness[own], roller[other]
        root = (flank.pin_circle + flank.shifting_offset - flank.pin_radius - flank.equidistant_offset)[own] - e
        clearance = flank.bearing_clearance[own]
        length = np.zeros(own.size)
        for diameter, long in stock.rollers:
            length = np.where((2.0 * r == diameter) & (long <= thickness), np.maximum(length, long), length)
        count = np.zeros(own.size)
        if several:
            half = sin(pi / asked.number_of_cranks)
            edge = root - 0.5 * clearance - shop.least_wall
            bore = part[other] * (half * edge - 0.5 * (shop.least_wall + clearance)) / (1.0 + half)
            circle = edge - bore
            fits = length > 0.0
        else:
            hole = pin[other] + e + flank.pin_hole_clearance[own]
            circle = root - shop.least_wall - hole
            bore = part[other] * (circle - hole - shop.least_wall - 0.5 * clearance)
            for more in HOLES:
                beside = 2.0 * (circle * sin(pi / more) - hole) >= shop.least_wall
                count = np.where(beside, float(more), count)
            fits = (length > 0.0) & (count > 0.0)
        fits &= (bore - 2.0 * r - e > shop.least_race) & (circle > 0.0)
        with np.errstate(invalid="ignore", divide="ignore"):  # not a number where no two rollers fit beside each other
            number = np.floor(np.pi / np.arcsin((r + 0.5 * shop.roller_gap(2.0 * r)) / (bore - r)) + 1e-9)
        fits &= number >= LEAST_ROLLERS
        if not fits.any():
            continue
        at = own[fits]
        sizes = replace(
            flank.take(at), bore=bore[fits], roller_radius=r[fits], roller_length=length[fits], rollers=number[fits],
            holes=count[fits], hole_circle=circle[fits], hole_pin=pin[other][fits],
        )  # fmt: skip
        yield sizes, {name: value[at] for name, value in values.items()}
