"""Which inputs drive a value, and how much of which would mend it.

Every input is changed by a little, with what belongs to it, and the drive is solved again, on half-spaces: elasticities
d ln v/d ln x of all values come from one solution for each input. What a change would have to be follows from a power law,
so the change is approximate; nothing is said of changes beyond `MAX_FACTOR`, nor of such that make no drive or that would fail
another check, so that no two pieces of advice contradict each other. A ring of finite elements is a beam here: its shape is
derived for each drive. Of counts it is the next whole number; those of wheel pins
and teeth are the ratio, and no advice. Nor is a Young's modulus: another one is another material, with a strength of its own.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from math import ceil, exp, floor, isfinite, log
from typing import Any

from ltca.analysis.loaded_analysis import LoadedAnalysis, analyse, analyse_cases
from ltca.analysis.summary import OF_FLANK, summarise_cases
from ltca.analysis.verdict.values import LIVES, find_values
from ltca.arrays import FloatArray
from ltca.drive.fields import field_kinds, read_field
from ltca.drive.members.bearings import NAMED_SIZES, bought_size
from ltca.drive.members.judgement import Check, Value, judged_by
from ltca.drive.parts import Drive
from ltca.drive.ring_shape import has_ring_of_elements
from ltca.drive.units.table import label
from ltca.equilibrium.output_angle import play_before_cranks
from ltca.errors import ConvergenceError, CycloError
from ltca.geometry.interference import ROUNDING, drawn_interference
from ltca.geometry.play import TurnPlay, play_over_a_turn
from ltca.reading.changes import with_fields

RELATIVE_STEP = 0.01
"""Relative change of an input; half of it where the whole makes no drive."""
MAX_FACTOR = 3.0
"""Largest factor on an input for which the power law is used."""
MAX_SIZE_FACTOR = 10.0
"""Largest factor on all sizes together, which keeps the shape."""
LEAST_ELASTICITY = 0.02
"""Elasticity below which an input is not said to drive a value."""
MAX_INPUTS = 3
"""Number of inputs named for each value."""
TORQUE, SIZES = "load.torque", "all sizes"


@dataclass(frozen=True, slots=True, kw_only=True)
class Driver:
    """An input that drives a value.

    Attributes
    ----------
    input : str
        Field, or the name of a group of fields that belong together.
    elasticity : float
        d ln value/d ln input.
    change : str
        What would bring the value to its limit, in words; empty where nothing within `MAX_FACTOR` does.
    factor : float or None
        The same as a factor.
    breaks : tuple of str
        Titles of the checks that such a change would fail, or fail by more: it is no advice, and neither told nor a factor.
    """

    input: str
    elasticity: float
    change: str
    factor: float | None
    breaks: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class _Input:
    name: str
    start: float | None
    unit: str
    changed: Callable[[float], dict[str, Any]]
    beside: tuple[str, ...] = ()
    is_count: bool = False
    fit: float = 1.0
    """Factor with which parts that overlap as drawn fit: the only step, and the largest change, since what follows is play."""

    @property
    def steps(self) -> tuple[float, ...]:
        """Changes to try, by the input: the first that makes a drive is taken."""
        if self.is_count and self.start:
            return (1.0 / self.start, -1.0 / self.start)
        if self.fit > 1.0:
            return (self.fit - 1.0,)
        return (RELATIVE_STEP, -RELATIVE_STEP, 0.5 * RELATIVE_STEP, -0.5 * RELATIVE_STEP)


def advise(
    drive: Drive, checks: Sequence[Check], crank_angle: FloatArray, torque: float | None = None, part: float = 1.0
) -> dict[str, list[Driver]]:
    """Return what drives every value that has a limit, the strongest first, by quantity.

    Parameters
    ----------
    drive : Drive
        The drive.
    checks : sequence of Check
        Of it (`ltca.drive.members.judgement`).
    crank_angle : array, shape (positions,)
        φ_C at which values are compared, rad.
    torque : float, optional
        Output torque, N·mm; the drive's own by default.
    part : float
        Of the torque that the drive carries and is judged at: sizes are told for the whole of it, and nothing else is.
    """
    torque = part * (drive.load.torque if torque is None else torque)
    wanted: dict[str, Check] = {}
    for check in checks:  # of two limits on one quantity that which fails
        if (
            check.limit is not None
            and check.value.value
            and not (check.value.quantity in wanted and wanted[check.value.quantity].fails)
        ):
            wanted[check.value.quantity] = check
    if not wanted:
        return {}
    if has_ring_of_elements(drive):
        drive = with_fields(drive, {"ring.model": "beam"})
    trials = _Trials(drive, crank_angle, torque, wanted)
    base = trials.base
    found: dict[str, list[Driver]] = {quantity: [] for quantity in wanted}
    for one, step, changed in _changes(drive, trials):
        for quantity, check in wanted.items():
            before, after = _judged(base, check), _judged(changed, check)
            if not before or not after or before * after <= 0.0:
                continue
            elasticity = log(after / before) / log(1.0 + step)
            if abs(elasticity) >= LEAST_ELASTICITY:
                found[quantity].append(_driver(drive, one, elasticity, check, part))
    if part == 1.0:
        found = _without_contradictions(found, wanted)
    return {
        quantity: sorted(drivers, key=lambda driver: -abs(driver.elasticity)) for quantity, drivers in found.items()
    }


def _without_contradictions(
    found: Mapping[str, Sequence[Driver]], checks: Mapping[str, Check]
) -> dict[str, list[Driver]]:
    """Drivers whose changes mend one check without failing another; the others with what they would break instead."""
    kept: dict[str, list[Driver]] = {quantity: [] for quantity in found}
    for quantity, drivers in found.items():
        for driver in drivers:
            breaks: tuple[str, ...] = ()
            if driver.factor is not None:
                breaks = tuple(
                    checks[other].title
                    for other, others in found.items()
                    if other != quantity
                    for one in others
                    if one.input == driver.input and _fails_more(checks[other], one.elasticity, driver.factor)
                )
            kept[quantity].append(replace(driver, change="", factor=None, breaks=breaks) if breaks else driver)
    return kept


def _fails_more(check: Check, elasticity: float, factor: float) -> bool:
    """Whether a factor on an input takes a value beyond its limit, or farther beyond it."""
    value, limit = check.value.value, check.limit
    if value is None or limit is None:
        return False
    after = value * (1.0 + elasticity * (factor - 1.0)) if _is_linear(check) else value * factor**elasticity
    worse = after > value if limit.sense == "max" else after < value
    return worse and (check.fails or (after > limit.value if limit.sense == "max" else after < limit.value))


def _is_linear(check: Check) -> bool:
    """Whether a value is a margin or a play, which is what sizes leave less what others take: a power law goes past its end."""
    return check.safety is None or check.value.quantity.startswith("backlash")


def _driver(drive: Drive, one: _Input, elasticity: float, check: Check, part: float) -> Driver:
    safety = check.safety
    farthest, whole = MAX_FACTOR, 1.0
    if one.name == SIZES:  # which are told for the whole torque: at equal stress torques grow with their cube
        farthest, whole = MAX_SIZE_FACTOR, part ** (-1.0 / 3.0)
    elif part < 1.0 and one.name != TORQUE:
        safety = None
    value = check.value.value
    linear = _is_linear(check) and part == 1.0 and check.limit is not None and value
    if check.verdict == "pass" or check.limit is None or not (linear or safety):
        return Driver(input=one.name, elasticity=elasticity, change="", factor=None)
    if value and linear:  # margins and plays at or below nothing follow no power law
        factor = 1.0 + (check.limit.value / value - 1.0) / elasticity
    else:
        wanted = log(safety or 1.0) / elasticity * (1.0 if check.limit.sense == "max" else -1.0)
        factor = exp(wanted) if isfinite(wanted) and abs(wanted) <= log(farthest) else 0.0
    if not 1.0 / farthest <= factor <= farthest or 1.0 < one.fit < factor:
        return Driver(input=one.name, elasticity=elasticity, change="", factor=None)
    factor *= whole
    if one.is_count and one.start:  # the next whole number beyond
        factor = (ceil(factor * one.start) if factor > 1.0 else floor(factor * one.start)) / one.start
    try:
        with_fields(drive, one.changed(factor))
    except CycloError:  # such a drive cannot be built
        return Driver(input=one.name, elasticity=elasticity, change="", factor=None)
    told = f"× {factor:.4g}"
    if one.start is not None:
        scale, unit = (1e-3, "N·m") if one.name == TORQUE else (1.0, label(one.unit))
        told = f"{scale * one.start:.4g} → {scale * factor * one.start:.4g} {unit}".rstrip()
    if one.beside:
        told += f" (with {', '.join(one.beside)})"
    return Driver(input=one.name, elasticity=elasticity, change=told, factor=factor)


class _Trials:
    """Values of drives that are nearly one, under one torque: what their checks judge and nothing else.

    Attributes
    ----------
    base : dict of str to Value
        Values of the drive itself, by quantity.
    """

    def __init__(self, drive: Drive, crank_angle: FloatArray, torque: float, wanted: Container[str]) -> None:
        """Solve the drive itself, whose poses and places of extremes the others start from."""
        self.angle, self.torque = crank_angle, torque
        self.lives = any(name in wanted for name in LIVES)
        self.without_load = any(name in wanted for name in (*OF_FLANK, "backlash_output"))
        self.near = analyse(_at_torque(drive, torque), crank_angle)
        self.play: TurnPlay | None = None
        if self.without_load:
            with suppress(ConvergenceError):  # nothing stops the wheel
                self.play = play_over_a_turn(self.near.model.geometries, partial(play_before_cranks, self.near.model))
        self.base = self._values({"": self.near}, self.play)[""]

    def values(self, drives: Mapping[str, Drive], *, alike: bool = True) -> dict[str, dict[str, Value]]:
        """Values of drives by name, solved together; without those that are refused or do not balance.

        Those of other numbers of parts are not `alike`: their plays are largest elsewhere.
        """
        if not drives:
            return {}
        try:
            solved = dict(analyse_cases(drives, self.angle, near=self.near))
            analyses = {name: found for name, found in solved.items() if not isinstance(found, ConvergenceError)}
            return self._values(analyses, self.play if alike else None)
        except CycloError:  # of one of them, which the others do without
            if len(drives) == 1:
                return {}
            each = (self.values({name: one}, alike=alike) for name, one in drives.items())
            return {name: values for found in each for name, values in found.items()}

    def _values(self, analyses: Mapping[str, LoadedAnalysis], play: TurnPlay | None) -> dict[str, dict[str, Value]]:
        summaries = summarise_cases(analyses, without_load=self.without_load, masses=False, near=play)
        return {
            name: {value.quantity: value for value in find_values(one, summaries[name], lives=self.lives)}
            for name, one in analyses.items()
        }


def _at_torque(drive: Drive, torque: float) -> Drive:
    """A drive at an output torque, N·mm, and at the same light torque: of a lighter one no limit asks."""
    return replace(drive, load=replace(drive.load, torque=torque, light_torque=torque))


def _changes(drive: Drive, trials: _Trials) -> Iterator[tuple[_Input, float, dict[str, Value]]]:
    """Give each input with the first of its steps that makes a drive that balances, and the values there.

    All inputs are tried at once, the next steps of those that are left after that.
    """
    inputs = {one.name: one for one in _inputs(drive, trials.torque)}
    answered: dict[str, tuple[float, dict[str, Value]]] = {}
    for number in range(max((len(one.steps) for one in inputs.values()), default=0)):
        left = {
            name: one.steps[number] for name, one in inputs.items() if name not in answered and number < len(one.steps)
        }
        drives = dict[str, Drive]()
        for name, step in left.items():
            with suppress(CycloError):
                changed = with_fields(drive, inputs[name].changed(1.0 + step))
                drives[name] = _at_torque(changed, (1.0 + step if name == TORQUE else 1.0) * trials.torque)
        counts = {name: drives.pop(name) for name in [*drives] if inputs[name].is_count}
        tried = trials.values(drives) | trials.values(counts, alike=False)
        answered |= {name: (left[name], values) for name, values in tried.items()}
    yield from ((one, *answered[name]) for name, one in inputs.items() if name in answered)


def _judged(values: Mapping[str, Value], check: Check) -> float | None:
    """Return what the limit of a check goes by."""
    value = values.get(check.value.quantity)
    if value is None or check.limit is None:
        return None if value is None else value.value
    return judged_by(check.limit, value).value


def _inputs(drive: Drive, torque: float) -> list[_Input]:
    """What a designer turns: sizes with what belongs to them, torque, materials, friction."""

    def field(path: str, beside: Mapping[str, Callable[[float, float], Any]] | None = None) -> _Input | None:
        try:
            start = read_field(drive, path)
        except CycloError:
            return None
        if not start:
            return None

        def changed(factor: float) -> dict[str, Any]:
            extra = {
                other: how(read_field(drive, other), (factor - 1.0) * start) for other, how in (beside or {}).items()
            }
            return {path: factor * start, **extra}

        unit = field_kinds()[path].unit
        return _Input(name=path, start=float(start), unit=unit, changed=changed, beside=tuple(beside or ()))

    def count(path: str) -> _Input | None:
        try:
            start = read_field(drive, path)
        except CycloError:
            return None
        return _Input(
            name=path, start=start, unit="1", changed=lambda factor: {path: round(factor * start)}, is_count=True
        )

    def grown(value: float, more: float) -> float:
        return value + more

    def shrunk(value: float, more: float) -> float:
        return value - 2.0 * more

    shaft = drive.pin_shaft is not None
    wide = drive.roller_length
    thickness = drive.disc.thickness
    hole = {"pin_shaft.hole_radius": grown} if shaft else {}
    ring = {} if drive.ring is None else {"ring.inner_radius": grown, "ring.outer_radius": grown}
    if drive.ring is not None and drive.ring.bolts is not None:
        ring["ring.bolts.circle_radius"] = grown
    overlap = drawn_interference(drive).holes if shaft else 0.0
    hole_radius = field("pin_shaft.hole_radius") if overlap > ROUNDING else None
    if hole_radius is not None and hole_radius.start:
        hole_radius = replace(hole_radius, fit=1.0 + overlap / hole_radius.start)
    chosen = [
        hole_radius,
        field("disc.thickness", {"crank_bearing.roller_length": lambda value, more: value * (1.0 + more / thickness)}),
        field("crank_bearing.roller_length") if wide < 0.98 * thickness else None,
        field("crank_bearing.roller_radius", {"crank_bearing.inner_race_radius": shrunk}),
        field("pin_wheel.pin_circle_radius", ring),
        field("pin_wheel.pin_radius"),
        count("crank_bearing.number_of_rollers"),
        count("pin_shaft.number_of_pins") if shaft else None,
        field("crank.eccentricity", hole),
        field("pin_shaft.pin_radius", hole) if shaft else None,
        field("pin_shaft.pin_circle_radius") if shaft else None,
        field("pin_shaft.stiffness") if shaft and drive.pin_shaft is not None and drive.pin_shaft.stiffness else None,
        *(field(f"disc.{name}") for name in ("lead_slope", "lead_crown_drop", "lead_relief_depth", "axial_play")),
        field("disc.equidistant_offset"),
        field("disc.shifting_offset"),
        field("clearance.bearing"),
        field("clearance.pin_hole"),
        field("pin_wheel.beam.diameter"),
        field("pin_shaft.beam.diameter"),
        field("ring.outer_radius"),
        field("ring.width"),
        field("ring.bolts.stiffness"),
        field("carrier.posts.size"),
        field("carrier.stiffness_torsion"),
        field("main_bearing.radial_stiffness"),
        field("main_bearing.clearance"),
        field("crank.support.diameter"),
        field("crank.support.clearance"),
        field("first_stage.backlash"),
        field("first_stage.mesh_stiffness"),
        field("load.speed"),
        *(field(f"friction.{name}") for name in ("pin", "seat", "hole", "roller", "support_bearing", "no_load_torque")),
    ]
    turned = _Input(name=TORQUE, start=torque, unit="N*mm", changed=lambda factor: {TORQUE: factor * torque})
    # A bought bearing is another one, not one of another size: its clearance is a class.
    bought = bought_size(drive.crank_bearing, "crank_bearing.roller_radius") is not None
    held = {"clearance.bearing", *(f"crank_bearing.{size}" for size in NAMED_SIZES)} if bought else set()
    return [_all_sizes(drive), turned, *(one for one in chosen if one is not None and one.name not in held)]


def _all_sizes(drive: Drive) -> _Input:
    """Every length of pins, disc, bearing, eccentricity and of what holds them alike; clearances, offsets and deviations stay."""
    paths = (
        "crank.eccentricity", "pin_wheel.pin_circle_radius", "pin_wheel.pin_radius", "disc.thickness",
        "crank_bearing.inner_race_radius", "crank_bearing.outer_race_radius", "crank_bearing.roller_radius",
        "crank_bearing.roller_length", "crank.circle_radius", "pin_shaft.pin_circle_radius", "pin_shaft.pin_radius",
        "pin_shaft.hole_radius", "pin_wheel.beam.span", "pin_wheel.beam.diameter", "pin_shaft.beam.span",
        "pin_shaft.beam.diameter", "pin_wheel.seat.radius", "pin_wheel.seat.pin_radius", "pin_wheel.seat.bore_radius",
        "pin_shaft.seat.pin_radius", "pin_shaft.seat.bore_radius",
        "disc.planes" if drive.disc.planes else "disc.gap", "ring.inner_radius",
        "ring.outer_radius", "ring.width", "ring.bolts.circle_radius", "carrier.posts.radius", "carrier.posts.size",
        "carrier.posts.length", "carrier.flange", "crank.support.diameter", "crank.support.positions",
        "crank.support.spline_plane", "first_stage.module", "first_stage.plane",
    )  # fmt: skip

    def changed(factor: float) -> dict[str, Any]:
        found: dict[str, Any] = {}
        for path in paths:
            try:
                value = read_field(drive, path)
            except CycloError:
                continue
            found[path] = tuple(factor * one for one in value) if isinstance(value, tuple) else factor * value
        return found

    return _Input(name=SIZES, start=None, unit="", changed=changed)
