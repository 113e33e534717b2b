"""Solve the cases of ``cyclo curves``; write curves.json, page and figures, print the results."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Mapping
from dataclasses import replace
from math import ceil
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ltca.analysis import loaded_analysis
from ltca.analysis.engines import Engine, describe_engine
from ltca.analysis.life.bearing_lives import BearingLives, lives_over, passages_of_duty
from ltca.analysis.life.life_text import life_content, life_lines
from ltca.analysis.memory_need import positions_together
from ltca.analysis.pressure_safety import PressureOfTurns, PressureSafety
from ltca.analysis.torque_curve import TorqueCurve, curve_content, torque_curve
from ltca.analysis.transmission_error_orders import Order, Spectrum, fit_orders, known_orders, least_turns
from ltca.arrays import FloatArray
from ltca.drive.members.judgement import Value, judge
from ltca.drive.members.limits import Limit
from ltca.drive.parts import Drive
from ltca.drive.units.quantities import ARCMIN, ARCSEC
from ltca.errors import DriveError
from ltca.output.files import write_json
from ltca.output.progress import progress
from ltca.page.studies.curves import (
    TurnOfPressure,
    life_section,
    orders_section,
    pressure_section,
    torque_section,
)
from ltca.page.study_page import Section, StudyPage, write_study_page
from ltca.reading.drive_file import DriveFile

POSITIONS_PER_TURN = 192
"""Least positions in a turn; more where the highest order asks for them (`positions_per_turn`)."""
ANGLES = 4
HARMONICS = 7
"""Multiples of each origin of an order; fewer, but two, where the teeth are many (`HIGHEST_ORDER`)."""
HIGHEST_ORDER = 320
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
    """

    pressure: float | None
    load_rating: float | None
    speed: float | None
    lost_motion: float


class CaseCurves(NamedTuple):
    """Curves of one case.

    Attributes
    ----------
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
    """

    curve: TorqueCurve
    turns: int
    positions: int
    spectrum: Spectrum
    lives: BearingLives
    crank_angle: FloatArray
    pressure: FloatArray
    safety: PressureSafety


def _orders(drive: Drive) -> tuple[Order, ...]:
    """Return the orders that are fitted."""
    return known_orders(drive, harmonics=min(HARMONICS, max(2, HIGHEST_ORDER // drive.disc.number_of_teeth)))


def positions_per_turn(drive: Drive) -> int:
    """Return the number of positions in a turn that resolves the highest order."""
    return max(POSITIONS_PER_TURN, ceil(POSITIONS_PER_PERIOD * max(order.value for order in _orders(drive))))


def require_turns(drive: Drive, turns: int) -> None:
    """Refuse too few turns to separate the orders of the transmission error."""
    orders = _orders(drive)
    least = least_turns(orders, positions_per_turn(drive), drive.pin_wheel.number_of_pins)
    if turns < least:
        raise DriveError(
            [
                f"--turns = {turns}: must be at least {least}, or {len(orders)} orders of the transmission error look alike"
            ]
        )


def tell_of_turns(drive: Drive, turns: int, positions: int) -> None:
    """Print before a long computation how many turns would do."""
    least = least_turns(_orders(drive), positions_per_turn(drive), turns)
    if least < turns:
        told = f"all {turns} turns of the crank are {positions} positions; --turns {least} would tell the orders apart, too"
        print(told, file=sys.stderr)


def solve_and_write(
    file: DriveFile,
    cases: dict[str, Drive],
    settings: CurveSettings,
    engine: Engine,
    arguments: argparse.Namespace,
    out: Path,
) -> int:
    """Solve every case, write curves.json, page and figures, print the results; return the exit status."""
    contents, every, speeds = {}, dict[str, CaseCurves](), dict[str, str | None]()
    turns_of = {name: arguments.turns or drive.pin_wheel.number_of_pins for name, drive in cases.items()}
    total = sum(turns * positions_per_turn(cases[name]) for name, turns in turns_of.items())
    with progress("positions", total) as advance:
        for name, drive in cases.items():
            title = f"{file.name} {name}"
            own = (
                settings
                if settings.pressure is not None
                else settings._replace(pressure=_allowed(drive, file.limits[name]))
            )
            found = _solve(drive, turns_of[name], own, engine, lambda size, case=name: advance(case, size))  # type: ignore[misc]
            contents[name] = {"drive": title, **engine.options, **_content(found, drive)}
            _print(found, title, drive, engine, own)
            every[name], speeds[name] = found, _life_speed(drive, own)
    if arguments.figures:
        figures = _draw(every, cases, file.name, out / "figures", arguments.figures)
        print(f"figures: {out / 'figures'} ({len(figures)} as {arguments.figures.upper()})")
    (first, *others) = contents.values()
    write_json(out / "curves.json", {"drive": file.name, "cases": contents} if others else first)
    files = [out / "curves.json"]
    if not arguments.no_page:
        sections = _sections(every, cases, speeds)
        loads = dict.fromkeys(drive.load_words() for drive in cases.values())
        told = f"curves at {', '.join(loads)}, {describe_engine(engine)}"
        page = StudyPage(name=file.name, told=told, sections=sections, made=engine.options, text=file.text)
        files.append(write_study_page(page, out))
    print("results: " + ", ".join(map(str, files)))
    return 0


def _sections(
    every: Mapping[str, CaseCurves], cases: Mapping[str, Drive], speeds: Mapping[str, str | None]
) -> list[Section]:
    """What the page shows of all cases; `speeds` are those behind the hours of lives."""
    lives = {name: found.lives for name, found in every.items()}
    turns = {name: TurnOfPressure(found.crank_angle, found.pressure, found.safety) for name, found in every.items()}
    return [
        torque_section({name: found.curve for name, found in every.items()}),
        orders_section(
            {name: found.spectrum for name, found in every.items()},
            [f"over {found.turns} turns, {found.positions} positions" for found in every.values()],
        ),
        life_section(lives, {name: life_lines(each, cases[name], speeds[name]) for name, each in lives.items()}),
        pressure_section(turns),
    ]


def _life_speed(drive: Drive, settings: CurveSettings) -> str | None:
    """The speed behind the hours of the life, as text."""
    speed = _crank_speed(drive, settings)
    return None if drive.duty or speed is None else _speed_words(drive, speed)


def _allowed(drive: Drive, limits: Mapping[str, Limit]) -> float | None:
    """Permissible flank pressure of a case: of the drive file, or of its materials, MPa; None where neither has one."""
    known = {key: limit for key, limit in limits.items() if key == "max_pin_pressure_mid"}
    (check,) = judge(drive, [Value(quantity="pin_pressure_mid", value=None)], known)
    return None if check.limit is None else check.limit.value


def _crank_speed(drive: Drive, settings: CurveSettings) -> float | None:
    """Speed of the crank: the one asked for, or that of the input in the drive file."""
    if settings.speed is not None or drive.load.speed is None:
        return settings.speed
    return drive.load.speed * (1.0 if drive.crank.number == 1 else abs(drive.crank_turns_per_input))


def _solve(
    drive: Drive, turns: int, settings: CurveSettings, engine: Engine, advance: Callable[[int], None]
) -> CaseCurves:
    """Solve a case, a part of its positions at a time, to bound memory."""
    engine = engine.with_coefficients(drive)
    mesh = 2.0 * np.pi / drive.disc.number_of_teeth
    settings = settings._replace(speed=_crank_speed(drive, settings))
    angles = mesh * np.arange(ANGLES) / ANGLES
    curve = torque_curve(drive, angles, engine=engine, lost_motion=settings.lost_motion)
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
        spectrum = fit_orders(angle, np.concatenate(error), _orders(drive))
    except ValueError as problem:
        raise DriveError([f"--turns = {turns}: {problem}"]) from problem
    # The disc does not turn against the pin shaft: a bearing turns as the crank does against that one.
    turning = abs(drive.output_per_wheel_angle) if drive.crank.number == 1 else 1.0
    speed = None if settings.speed is None else settings.speed * turning
    turn = pressures.turn * each
    return CaseCurves(
        curve=curve,
        turns=turns,
        positions=angle.size,
        spectrum=spectrum,
        lives=lives_over(passages, dynamic_load_rating=settings.load_rating, speed=speed),
        crank_angle=angle[turn : turn + each],
        pressure=pressures.worst,
        safety=pressures.safety(float("inf") if settings.pressure is None else settings.pressure),
    )


def _print(found: CaseCurves, title: str, drive: Drive, engine: Engine, settings: CurveSettings) -> None:
    curve, spectrum, safety = found.curve, found.spectrum, found.safety
    output = "output" if drive.wheel_is_held else "wheel"
    over = f"over {found.turns} turns, {found.positions} positions"
    print(
        f"{title}, {drive.load_words()}, {describe_engine(engine)}: torque curve at {ANGLES} crank angles over one mesh"
    )
    floating = f"backlash at the {output}, all clearances"
    print(f"  {floating:<40}  {_range(curve.backlash * ARCMIN)}′")
    print(
        f"  lost motion at ±{100.0 * curve.lost_motion_part:g} % of the rated torque   {_range(curve.lost_motion * ARCMIN)}′"
    )
    if curve.loop is not None:
        print(f"  width of the loop there                   {_range(curve.loop.width * ARCMIN)}′")
        print(f"  energy lost in a loop at the rated torque {_range(curve.loop.energy / 1e3)} J")
    print(f"  stiffness of the cycloid stage, 50…100 %  {_range(curve.stiffness / ARCMIN / 1e3)} N m/′")
    print(f"orders of the transmission error {over}")
    for number in np.argsort(-spectrum.amplitude)[:8]:
        entry = spectrum.orders[number]
        print(f"  {entry.value:>9.4f}  {entry.name:<32}{spectrum.amplitude[number] * ARCSEC:>9.4f}″")
    print(f"  unexplained, rms{'':<29}{spectrum.residual * ARCSEC:>9.4f}″")
    print("\n".join(life_lines(found.lives, drive, _life_speed(drive, settings))))
    told = (
        "without a limit"
        if settings.pressure is None
        else f"safety {safety.safety:.3f} against {settings.pressure:g} MPa"
    )
    print(f"flank pressure {safety.largest:.1f} MPa, {told}, largest {over}")


def _speed_words(drive: Drive, speed: float) -> str:
    """The speed as text, for several cranks in the carrier also that of the input or against the housing."""
    told, ratio = f"{speed:g} turns a minute", drive.reduction_ratio
    if drive.crank.number == 1:
        return f"{told} of the crank against the held {drive.installation.held.replace('-', ' ')}"
    told += " of the cranks against the carrier"
    if drive.installation.first_stage_ratio is not None:
        return f"{told}, {speed * abs(drive.transmission_ratio) / ratio:.6g} of the input before the first stage"
    # The carrier turns backward, by one turn for u of the cranks in it.
    return f"{told}, {speed * (1.0 - 1.0 / ratio):.6g} against the housing" if drive.wheel_is_held else told


def _range(values: Any) -> str:
    return f"{values.min():.4g} … {values.max():.4g}"


def _draw(
    every: Mapping[str, CaseCurves], cases: Mapping[str, Drive], name: str, folder: Path, kind: str
) -> list[Path]:
    from ltca.figures import curve_figures as figures
    from ltca.figures.shared_axes import order_axes, pressure_axis, torque_axes

    torques = torque_axes(found.curve for found in every.values())
    orders = order_axes(found.spectrum for found in every.values())
    pressures = pressure_axis(found.safety for found in every.values())
    files = []
    for case, found in every.items():
        title, ending = f"{name} {case}", f"_{case}.{kind}" if len(every) > 1 else f".{kind}"
        discs = cases[case].disc.number_of_discs
        files += [
            figures.draw_torque_curve(found.curve, title, folder / f"torque_curve{ending}", torques),
            figures.draw_spectrum(found.spectrum, title, folder / f"transmission_error_orders{ending}", orders),
            figures.draw_pressure(
                found.crank_angle,
                found.pressure,
                found.safety,
                title,
                folder / f"flank_pressure{ending}",
                discs,
                pressures,
            ),
        ]
    return files


def _finite(value: float) -> float | None:
    return None if value == float("inf") else value


def _content(found: CaseCurves, drive: Drive) -> dict[str, Any]:
    curve, spectrum, safety = found.curve, found.spectrum, found.safety
    return {
        "torque_curve": curve_content(curve, drive),
        "transmission_error_orders": {
            "turns": found.turns,
            "positions": found.positions,
            "orders": [
                {"order": entry.value, "name": entry.name, "amplitude_rad": float(size), "phase_rad": float(phase)}
                for entry, size, phase in zip(spectrum.orders, spectrum.amplitude, spectrum.phase, strict=True)
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
