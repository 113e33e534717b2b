"""Curves of one drive: torque against wind-up, orders of the transmission error, bearing lives, flank pressure over a turn."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from math import ceil
from typing import Any, NamedTuple

import numpy as np

from ltca.analysis import loaded_analysis
from ltca.analysis.engines import Engine, HalfSpace, describe_engine, lent_words
from ltca.analysis.half_space_errors import half_space_words
from ltca.analysis.life.bearing_lives import BearingLives, lives_over, passages_of_duty
from ltca.analysis.life.life_text import life_content, life_lines
from ltca.analysis.light_torque import light_torque_lines
from ltca.analysis.memory_need import positions_together
from ltca.analysis.pressure_safety import PressureOfTurns, PressureSafety
from ltca.analysis.stiffness_by_part import StiffnessByPart, stiffness_by_part
from ltca.analysis.torque_curve import UNDER_FORCES, TorqueCurve, curve_angles, curve_content, torque_curve
from ltca.analysis.transmission_error_orders import Order, Spectrum, fit_orders, fitted_orders, least_turns
from ltca.arrays import FloatArray
from ltca.drive.members.judgement import Value, judge
from ltca.drive.members.limits import Limit
from ltca.drive.parts import Drive
from ltca.drive.units.quantities import ARCMIN, ARCSEC
from ltca.equilibrium.output_angle import play_before_cranks
from ltca.errors import ConvergenceError, DriveError
from ltca.geometry.play import PLAY_SAMPLED, TurnPlay, play_over_a_turn, preload_words

POSITIONS_PER_TURN = 192
"""Least positions in a turn; more where the highest order asks for them (`positions_per_turn`)."""
HARMONICS = 7
"""Multiples of each origin of an order; fewer, but two, where the teeth are many (`fitted_orders`)."""
POSITIONS_PER_PERIOD = 2.05
"""Positions for each period of the highest order, beyond the two that tell it from others."""


class CurveSettings(NamedTuple):
    """What the curves are computed with.

    Attributes
    ----------
    pressure : float or None
        Permissible flank pressure, MPa; that of the drive file or its materials otherwise.
    load_rating : float or None
        Of the crank bearing, N; by ISO 281 otherwise.
    speed : float or None
        Of the crank, turns a minute: of a central one against the held member, of several against the carrier.
    lost_motion : float
        Part of the rated torque at which lost motion is read.
    parts : bool
        Whether the stiffness is told with and without each part that the file describes.
    """

    pressure: float | None
    load_rating: float | None
    speed: float | None
    lost_motion: float
    parts: bool = False


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class DriveCurves:
    """Curves of one drive.

    Attributes
    ----------
    drive : Drive
        The drive, at its temperatures.
    engine : Engine
        What it was solved on.
    settings : CurveSettings
        What it was computed with.
    curve : TorqueCurve
        Of the whole drive.
    turns : int
        Crank turns behind everything below.
    positions : int
        In all of them.
    spectrum : Spectrum
        Orders of the transmission error.
    lives : BearingLives
        Of all crank bearings.
    crank_angle : array, shape (positions of a turn,)
        φ_C in the turn that holds the largest pressure of all, rad.
    pressure : array, shape (positions of a turn, pins)
        At mid-width in that turn, MPa.
    safety : PressureSafety
        Over all positions; its position is one of that turn.
    parts : StiffnessByPart or None
        The stiffness with and without each part, where it was asked for.
    play : TurnPlay or None
        Free play of the wheel over a turn with that of a first stage, as `cyclo run` has it; None where forces from outside
        displace the wheel, or a position has no answer.

    Examples
    --------
    >>> import ltca
    >>> found = ltca.curves(ltca.load_drive("paper"), 4, case="CS-1")
    >>> sorted(found.content)  # as in curves.json
    ['bearing_life', 'pressure_safety', 'stiffness_by_part', 'torque_curve', 'transmission_error_orders']
    >>> bool((found.curve.stiffness > 0.0).all()), found.lives.shortest.hours
    (True, None)
    """

    drive: Drive
    engine: Engine
    settings: CurveSettings
    curve: TorqueCurve
    turns: int
    positions: int
    spectrum: Spectrum
    lives: BearingLives
    crank_angle: FloatArray
    pressure: FloatArray
    safety: PressureSafety
    parts: StiffnessByPart | None = None
    play: TurnPlay | None = None

    @property
    def backlash_of_turn(self) -> FloatArray | None:
        """Least and largest backlash at the output among sampled positions of a turn, rad."""
        if self.play is None:
            return None
        return abs(self.drive.output_per_wheel_angle) * np.array([self.play.least, self.play.largest])

    @property
    def backlash_words(self) -> str:
        """Range of the backlash at the output, ′, and where it was sampled."""
        of_turn = self.backlash_of_turn
        if self.play is None or of_turn is None:
            angles = self.curve.crank_angle.size
            return f"{_range(self.curve.backlash * ARCMIN)}′, sampled at {angles} crank angles over one mesh"
        remarks = filter(None, (preload_words(self.play.preloaded), PLAY_SAMPLED))
        return ", ".join([f"{_range(of_turn * ARCMIN)}′", *remarks])

    @property
    def content(self) -> dict[str, Any]:
        """What ``curves.json`` holds of it, without the options of the engine: lists and numbers, units in the keys."""
        return curve_contents(self)

    def __repr__(self) -> str:
        """Print what ``cyclo curves`` prints."""
        return "\n".join(curve_lines(self, f"{self.drive.name} {self.drive.case}"))


def known_orders_of(drive: Drive) -> tuple[Order, ...]:
    """Return the orders that are fitted."""
    return fitted_orders(drive, harmonics=HARMONICS)


def positions_per_turn(drive: Drive) -> int:
    """Return the number of positions in a turn that resolves the highest order."""
    return max(POSITIONS_PER_TURN, ceil(POSITIONS_PER_PERIOD * max(order.value for order in known_orders_of(drive))))


def fewest_turns(drive: Drive, turns: int) -> int:
    """Return the least number of turns, up to `turns`, that separates the orders of the transmission error."""
    return least_turns(known_orders_of(drive), positions_per_turn(drive), turns)


def require_turns(drive: Drive, turns: int, name: str = "--turns") -> None:
    """Refuse too few turns to separate the orders of the transmission error."""
    least, orders = fewest_turns(drive, drive.pin_wheel.number_of_pins), len(known_orders_of(drive))
    if turns < least:
        raise DriveError(
            [f"{name} = {turns}: must be at least {least}, or {orders} orders of the transmission error look alike"]
        )


def life_speed(drive: Drive, settings: CurveSettings) -> str | None:
    """The speed behind the hours of the life, as text."""
    speed = _crank_speed(drive, settings)
    return None if drive.duty or speed is None else speed_words(drive, speed)


def allowed_pressure(drive: Drive, limits: Mapping[str, Limit]) -> float | None:
    """Permissible flank pressure of a case: of the drive file, or of its materials, MPa; None where neither has one."""
    known = {key: limit for key, limit in limits.items() if key == "max_pin_pressure_mid"}
    (check,) = judge(drive, [Value(quantity="pin_pressure_mid", value=None)], known)
    return None if check.limit is None else check.limit.value


def _crank_speed(drive: Drive, settings: CurveSettings) -> float | None:
    """Speed of the crank: the one asked for, or that of the input in the drive file."""
    if settings.speed is not None or drive.load.speed is None:
        return settings.speed
    return drive.load.speed * (1.0 if drive.crank.number == 1 else abs(drive.crank_turns_per_input))


def solve_curves(
    drive: Drive,
    turns: int,
    settings: CurveSettings,
    engine: Engine,
    advance: Callable[[int], None] = lambda _: None,
) -> DriveCurves:
    """Solve a warm drive, a part of its positions at a time, to bound memory."""
    drive.require_torque("torque curves, which go up to it")
    asked, engine = settings, engine.with_coefficients(drive)
    settings = settings._replace(speed=_crank_speed(drive, settings))
    angles = curve_angles(drive)
    curve = torque_curve(drive, angles, engine=engine, lost_motion=settings.lost_motion)
    parts = None
    if settings.parts:
        parts = stiffness_by_part(drive, angles, engine=engine, lost_motion=settings.lost_motion)
    each = positions_per_turn(drive)
    angle = 2.0 * np.pi * np.arange(turns * each) / each
    # Of the light torque nothing is told here: at the whole one it is not solved again.
    loaded = replace(drive, load=replace(drive.load, light_torque=drive.load.torque))
    error, passages, pressures = [], [], PressureOfTurns(each)
    for rows in np.array_split(angle, -(-angle.size // positions_together(drive))):
        analysis = loaded_analysis.analyse(loaded, rows, engine=engine)
        error.append(analysis.transmission_error)
        passages.append(passages_of_duty(analysis))
        pressures.add(analysis.pressures.pins.mid)
        advance(rows.size)
    try:
        spectrum = fit_orders(angle, np.concatenate(error), known_orders_of(drive))
    except ValueError as problem:
        raise DriveError([f"turns = {turns}: {problem}"]) from problem
    # The disc does not turn against the pin shaft: a bearing turns as the crank does against that one.
    turning = abs(drive.output_per_wheel_angle) if drive.crank.number == 1 else 1.0
    speed = None if settings.speed is None else settings.speed * turning
    turn = pressures.turn * each
    return DriveCurves(
        drive=drive,
        engine=engine,
        settings=asked,
        curve=curve,
        turns=turns,
        positions=angle.size,
        spectrum=spectrum,
        lives=lives_over(passages, dynamic_load_rating=settings.load_rating, speed=speed),
        crank_angle=angle[turn : turn + each],
        pressure=pressures.worst,
        safety=pressures.safety(float("inf") if settings.pressure is None else settings.pressure),
        parts=parts,
        play=None if curve.displaced else _play_over_a_turn(drive),
    )


def _play_over_a_turn(drive: Drive) -> TurnPlay | None:
    """Free play of the wheel over a turn; None where a position has no answer."""
    model = HalfSpace().prepare(drive).model
    try:
        return play_over_a_turn(model.geometries, partial(play_before_cranks, model))
    except ConvergenceError:
        return None


def curve_lines(found: DriveCurves, title: str) -> list[str]:
    """Return the curves of a drive as lines for the terminal."""
    curve, spectrum, safety, drive = found.curve, found.spectrum, found.safety, found.drive
    output = "output" if drive.wheel_is_held else "wheel"
    over = f"over {found.turns} turns, {found.positions} positions"
    floating = f"backlash at the {output}, all clearances"
    of_loop = [] if curve.loop is None else [
        f"  width of the loop there                   {_range(curve.loop.width * ARCMIN)}′",
        f"  energy lost in a loop at the rated torque {_range(curve.loop.energy / 1e3)} J",
    ]  # fmt: skip
    told_apart = spectrum.resolved()
    strongest = [
        (told_apart.orders[number], told_apart.amplitude[number]) for number in np.argsort(-told_apart.amplitude)[:8]
    ]
    width = max(32, *(len(order.name) for order, _ in strongest))
    limit = found.settings.pressure
    told = "without a limit" if limit is None else f"safety {safety.safety:.3f} against {limit:g} MPa"
    return [
        f"{title}, {drive.load_words()}, {describe_engine(found.engine)}: torque curve at {curve.crank_angle.size} crank "
        "angles over one mesh, ranges sampled there",
        *(
            f"  {words}"
            for words in [half_space_words(found.engine, drive) or lent_words(found.engine, drive)]
            if words
        ),
        *(f"  {line}" for line in light_torque_lines({drive.case: drive})),
        f"  {floating:<40}  {found.backlash_words}",
        *([f"  {UNDER_FORCES}"] if curve.displaced else []),
        f"  lost motion at ±{100.0 * curve.lost_motion_part:g} % of the rated torque   {_range(curve.lost_motion * ARCMIN)}′",
        *of_loop,
        f"  stiffness of the cycloid stage, 50…100 %  {_range(curve.stiffness / ARCMIN / 1e3)} N m/′",
        f"  of the reducer with what is described     {_range(curve.reducer_stiffness / ARCMIN / 1e3)} N m/′",
        f"  {curve.yielding.words}",
        *([] if found.parts is None else found.parts.lines),
        f"orders of the transmission error {over}",
        *(f"  {order.value:>9.4f}  {order.name:<{width}}{size * ARCSEC:>9.4f}″" for order, size in strongest),
        f"  {'unexplained, rms':<{width + 13}}{spectrum.residual * ARCSEC:>9.4f}″",
        *([f"  {resolution_words(found)}"] if any(" or " in order.name for order, _ in strongest) else []),
        *life_lines(found.lives, drive, life_speed(drive, found.settings)),
        f"flank pressure {safety.largest:.1f} MPa, {told}, largest sampled {over}",
    ]


def resolution_words(found: DriveCurves) -> str:
    """Return which orders the turns do not tell apart; nothing where they tell all apart."""
    if len(found.spectrum.groups) == len(found.spectrum.orders):
        return ""
    return (
        f"{found.turns} turns do not tell orders apart that are nearer than 1/{found.turns}: "
        'a row with "or" is the sum of those it names'
    )


def speed_words(drive: Drive, speed: float) -> str:
    """The speed as text, for several cranks in the carrier also that of the input or against the housing."""
    told, ratio = f"{speed:g} turns a minute", drive.reduction_ratio
    if drive.crank.number == 1:
        return f"{told} of the crank against the held {drive.installation.held.replace('-', ' ')}"
    told += " of the cranks against the carrier"
    if drive.first_stage_ratio is not None:
        return f"{told}, {speed * abs(drive.transmission_ratio) / ratio:.6g} of the input before the first stage"
    # The carrier turns backward, by one turn for u of the cranks in it.
    return f"{told}, {speed * (1.0 - 1.0 / ratio):.6g} against the housing" if drive.wheel_is_held else told


def _range(values: Any) -> str:
    return f"{values.min():.4g} … {values.max():.4g}"


def _finite(value: float) -> float | None:
    return None if value == float("inf") else value


def curve_contents(found: DriveCurves) -> dict[str, Any]:
    """Return the curves of a drive as files hold them."""
    drive, curve, spectrum, safety = found.drive, found.curve, found.spectrum, found.safety
    of_turn = found.backlash_of_turn
    return {
        "torque_curve": {
            **curve_content(curve, drive),
            "backlash_over_a_turn_rad": None if of_turn is None else of_turn.tolist(),
        },
        "stiffness_by_part": None if found.parts is None else found.parts.content,
        "transmission_error_orders": {
            "turns": found.turns,
            "positions": found.positions,
            "orders": [
                {"order": entry.value, "name": name, "amplitude_rad": float(size), "phase_rad": float(phase)}
                for entry, name, size, phase in zip(
                    spectrum.orders, spectrum.names, spectrum.amplitude, spectrum.phase, strict=True
                )
            ],
            "not_told_apart": [
                {"orders": [spectrum.orders[place].value for place in places], "amplitude_rad": float(size)}
                for places, size in zip(spectrum.groups, spectrum.resolved().amplitude, strict=True)
                if len(places) > 1
            ],
            "residual_rms_rad": spectrum.residual,
        },
        "bearing_life": life_content(found.lives, drive),
        "pressure_safety": {
            "limit_MPa": _finite(safety.limit),
            "largest_MPa": safety.largest,
            "safety": _finite(safety.safety),
            "load_factor": _finite(safety.load_factor),
            "pin": safety.pin % drive.pin_wheel.number_of_pins,
            "disc": safety.pin // drive.pin_wheel.number_of_pins,
        },
    }
