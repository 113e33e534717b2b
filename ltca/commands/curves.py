"""``cyclo curves``: torque against wind-up, orders of the transmission error, bearing life, pressure safety."""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from ltca.commands.compliance_arguments import add_compliance_arguments
from ltca.reading.arguments import (
    add_case_argument,
    add_drive_argument,
    add_figures_argument,
    add_out_argument,
    add_page_argument,
    count_argument,
    default_folder,
    quantity_argument,
    tell_unit_mistakes,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from ltca.analysis.engines import Engine
    from ltca.analysis.life.bearing_lives import BearingLives
    from ltca.analysis.pressure_safety import PressureSafety
    from ltca.analysis.torque_curve import TorqueCurve
    from ltca.analysis.transmission_error_orders import Order, Spectrum
    from ltca.drive.members.limits import Limit
    from ltca.drive.parts import Drive
    from ltca.geometry.pairs import FloatArray
    from ltca.page.study_page import Section
    from ltca.reading.drive_file import DriveFile

SUMMARY = "torque curve and lost motion, orders of the transmission error, bearing life, pressure safety"
EXAMPLES = (
    ("cyclo curves my.toml", "torque curve, orders, bearing lives; curves.json"),
    ("cyclo curves my.toml --speed '1500 rpm' --load-rating '40 kN'", "lives at a speed and a maker's load rating"),
)
POSITIONS_PER_TURN = 192
"""Least positions in a turn; more where the highest order asks for them (`positions_per_turn`)."""
ANGLES = 4
HARMONICS = 7
"""Multiples of each origin of an order; fewer, but two, where the teeth are many (`HIGHEST`)."""
HIGHEST = 320
SEEN = 2.05
"""Positions for each period of the highest order, beyond the two that tell it from others."""
MANY = 20_000
"""Positions beyond which it is said that fewer turns would do."""
FIGURES = ("torque_curve", "transmission_error_orders", "flank_pressure")


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_drive_argument(parser)
    add_case_argument(parser, "case, repeatable; default all")
    parser.add_argument(
        "--turns",
        metavar="N",
        type=count_argument("--turns", 1, 1000),
        help="crank turns behind the orders; default z_P",
    )
    parser.add_argument(
        "--pressure-limit",
        metavar="P",
        type=quantity_argument("--pressure-limit", "MPa", gt=0.0),
        help="permissible flank pressure in MPa (or a text such as '1.5 GPa'); default that of [limits] or of the materials",
    )
    parser.add_argument(
        "--lost-motion",
        metavar="PART",
        type=quantity_argument("--lost-motion", "dimensionless", ge=0.001, le=0.5),
        default=0.03,
        help="part of the rated torque at which lost motion is read, as '3%%' or 0.03; default 3%%",
    )
    parser.add_argument(
        "--speed",
        metavar="N",
        type=quantity_argument("--speed", "rpm", gt=0.0),
        help="crank speed in turns a minute (or a text such as '1500 rpm'), for the life in hours: of a central crank "
        "against the held member, of several cranks against the carrier (what that is of the input is printed); default from "
        "load.speed, if the drive has it; not with [[duty]]",
    )
    parser.add_argument(
        "--load-rating",
        metavar="C",
        type=quantity_argument("--load-rating", "N", gt=0.0),
        help="dynamic load rating of the crank bearing in N (or a text such as '40 kN'); default by ISO 281",
    )
    add_compliance_arguments(parser)
    add_out_argument(parser, "curves")
    add_figures_argument(parser)
    add_page_argument(parser)


class CurveSettings(NamedTuple):
    """What the results are held against.

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
    """What one case gives.

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


def execute(arguments: argparse.Namespace) -> int:
    """Solve every case, write curves.json and the figures, print what they say."""
    from glob import escape

    from ltca.commands.compliance_arguments import check_compliance, compliance_of, find_coefficients_of
    from ltca.errors import DriveError
    from ltca.output.run_folder import claimed_folder, figure_files, require_folder
    from ltca.reading.drive_file import load_drive

    check_compliance(arguments)
    file = load_drive(arguments.drive)
    cases = file.select_warm(arguments.case)
    tell_unit_mistakes(file.cases[name] for name in cases)
    out = arguments.out or default_folder(file.name, "curves")
    require_folder(out)
    from ltca.analysis.memory_need import require_room_for_parts

    asked = (arguments.pressure_limit, arguments.load_rating, arguments.speed, arguments.lost_motion)
    limits, engine = CurveSettings(*asked), compliance_of(arguments)
    for drive in cases.values():
        if drive.duty and limits.speed is not None:
            raise DriveError(["--speed: has no effect with [[duty]], whose entries have their own"])
        turns = arguments.turns or drive.pin_wheel.number_of_pins
        positions = turns * positions_per_turn(drive)
        require_room_for_parts(drive, positions, out, f"--turns {turns}")
        if turns < drive.pin_wheel.number_of_pins:
            _require_turns(drive, turns)
        elif arguments.turns is None and positions > MANY:
            _tell_of_turns(drive, turns, positions)
    endings = [f"_{escape(name)}" for name in cases] if len(cases) > 1 else [""]
    figures = figure_files(arguments.figures, *(name + ending for name in FIGURES for ending in endings))
    writes = ["curves.json", *([] if arguments.no_page else ["report.html"])]
    with claimed_folder(out, "curves", writes=[*writes, *figures]):
        find_coefficients_of(cases, arguments)
        return _solve_and_write(file, cases, limits, engine, arguments, out)


def _orders(drive: Drive) -> tuple[Order, ...]:
    """Return the orders that are looked for."""
    from ltca.analysis.transmission_error_orders import known_orders

    return known_orders(drive, harmonics=min(HARMONICS, max(2, HIGHEST // drive.disc.number_of_teeth)))


def positions_per_turn(drive: Drive) -> int:
    """Return how many positions a turn needs for the highest order to be told from the others."""
    from math import ceil

    return max(POSITIONS_PER_TURN, ceil(SEEN * max(order.value for order in _orders(drive))))


def _require_turns(drive: Drive, turns: int) -> None:
    """Refuse turns over which the orders of the transmission error look alike."""
    from ltca.analysis.transmission_error_orders import least_turns
    from ltca.errors import DriveError

    orders = _orders(drive)
    least = least_turns(orders, positions_per_turn(drive), drive.pin_wheel.number_of_pins)
    if turns < least:
        raise DriveError(
            [
                f"--turns = {turns}: must be at least {least}, or {len(orders)} orders of the transmission error look alike"
            ]
        )


def _tell_of_turns(drive: Drive, turns: int, positions: int) -> None:
    """Say before a long computation how many turns would do."""
    import sys

    from ltca.analysis.transmission_error_orders import least_turns

    least = least_turns(_orders(drive), positions_per_turn(drive), turns)
    if least < turns:
        told = f"all {turns} turns of the crank are {positions} positions; --turns {least} would tell the orders apart, too"
        print(told, file=sys.stderr)


def _solve_and_write(
    file: DriveFile,
    cases: dict[str, Drive],
    limits: CurveSettings,
    engine: Engine,
    arguments: argparse.Namespace,
    out: Path,
) -> int:
    from ltca.output.files import write_json
    from ltca.output.progress import progress

    contents, figures = {}, []
    sections: list[Section] = []
    turns_of = {name: arguments.turns or drive.pin_wheel.number_of_pins for name, drive in cases.items()}
    total = sum(turns * positions_per_turn(cases[name]) for name, turns in turns_of.items())
    with progress("positions", total) as advance:
        for name, drive in cases.items():
            title = f"{file.name} {name}"
            own = (
                limits if limits.pressure is not None else limits._replace(pressure=_allowed(drive, file.limits[name]))
            )
            found = _solve(drive, turns_of[name], own, engine, lambda size, case=name: advance(case, size))  # type: ignore[misc]
            contents[name] = {"drive": title, **engine.options, **_content(found, drive)}
            _print(found, title, drive, engine, own)
            if not arguments.no_page:
                sections += _sections(found, drive, own, f"{name}: " if len(cases) > 1 else "")
            if arguments.figures:
                ending = f"_{name}" if len(cases) > 1 else ""
                figures += _draw(
                    found, title, drive.disc.number_of_discs, out / "figures", f"{ending}.{arguments.figures}"
                )
    if figures:
        print(f"figures: {out / 'figures'} ({len(figures)} as {arguments.figures.upper()})")
    (first, *others) = contents.values()
    write_json(out / "curves.json", {"drive": file.name, "cases": contents} if others else first)
    files = [out / "curves.json"]
    if sections:
        from ltca.analysis.engines import describe_engine
        from ltca.page.study_page import StudyPage, write_study_page

        loads = dict.fromkeys(drive.load_words() for drive in cases.values())
        told = f"curves at {', '.join(loads)}, {describe_engine(engine)}"
        page = StudyPage(name=file.name, told=told, sections=sections, made=engine.options, text=file.text)
        files.append(write_study_page(page, out))
    print("results: " + ", ".join(map(str, files)))
    return 0


def _sections(found: CaseCurves, drive: Drive, limits: CurveSettings, of: str) -> list[Section]:
    """What the page shows of a case; `of` names it where there are several."""
    from ltca.analysis.life.life_text import life_lines
    from ltca.page.studies.curves import life_section, orders_section, pressure_section, torque_section

    over = f"over {found.turns} turns, {found.positions} positions"
    return [
        torque_section(found.curve, of),
        orders_section(found.spectrum, over, of),
        life_section(life_lines(found.lives, drive, _life_speed(drive, limits)), of),
        pressure_section(found.crank_angle, found.pressure, found.safety, of),
    ]


def _life_speed(drive: Drive, limits: CurveSettings) -> str | None:
    """Which speed the hours of the life are at."""
    speed = _crank_speed(drive, limits)
    return None if drive.duty or speed is None else _speed_words(drive, speed)


def _allowed(drive: Drive, limits: Mapping[str, Limit]) -> float | None:
    """Permissible flank pressure of a case: of the drive file, or of its materials, MPa; None where neither has one."""
    from ltca.drive.members.judgement import Value, judge

    known = {key: limit for key, limit in limits.items() if key == "max_pin_pressure_mid"}
    (check,) = judge(drive, [Value(quantity="pin_pressure_mid", value=None)], known)
    return None if check.limit is None else check.limit.value


def _crank_speed(drive: Drive, limits: CurveSettings) -> float | None:
    """Speed of the crank: the one asked for, or that of the input in the drive file."""
    if limits.speed is not None or drive.load.speed is None:
        return limits.speed
    return drive.load.speed * (1.0 if drive.crank.number == 1 else abs(drive.crank_turns_per_input))


def _solve(
    drive: Drive, turns: int, limits: CurveSettings, engine: Engine, advance: Callable[[int], None]
) -> CaseCurves:
    """Solve a case, a part of its positions at a time: what is kept of them is little."""
    import numpy as np

    from ltca.analysis import loaded_analysis
    from ltca.analysis.life.bearing_lives import lives_over, passages_of_duty
    from ltca.analysis.memory_need import positions_together
    from ltca.analysis.pressure_safety import PressureOfTurns
    from ltca.analysis.torque_curve import torque_curve
    from ltca.analysis.transmission_error_orders import fit_orders
    from ltca.errors import DriveError

    engine = engine.with_coefficients(drive)
    mesh = 2.0 * np.pi / drive.disc.number_of_teeth
    limits = limits._replace(speed=_crank_speed(drive, limits))
    angles = mesh * np.arange(ANGLES) / ANGLES
    curve = torque_curve(drive, angles, engine=engine, lost_motion=limits.lost_motion)
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
    speed = None if limits.speed is None else limits.speed * turning
    turn = pressures.turn * each
    return CaseCurves(
        curve=curve,
        turns=turns,
        positions=angle.size,
        spectrum=spectrum,
        lives=lives_over(passages, dynamic_load_rating=limits.load_rating, speed=speed),
        crank_angle=angle[turn : turn + each],
        pressure=pressures.worst,
        safety=pressures.safety(float("inf") if limits.pressure is None else limits.pressure),
    )


def _print(found: CaseCurves, title: str, drive: Drive, engine: Engine, limits: CurveSettings) -> None:
    import numpy as np

    from ltca.analysis.engines import describe_engine
    from ltca.analysis.life.life_text import life_lines
    from ltca.drive.units.quantities import ARCMIN, ARCSEC

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
    print("\n".join(life_lines(found.lives, drive, _life_speed(drive, limits))))
    told = (
        "without a limit" if limits.pressure is None else f"safety {safety.safety:.3f} against {limits.pressure:g} MPa"
    )
    print(f"flank pressure {safety.largest:.1f} MPa, {told}, largest {over}")


def _speed_words(drive: Drive, speed: float) -> str:
    """Which speed it is, and what that of several cranks in the carrier is elsewhere."""
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


def _draw(found: CaseCurves, title: str, discs: int, folder: Path, ending: str) -> list[Path]:
    from ltca.figures import curve_figures as figures

    return [
        figures.draw_torque_curve(found.curve, title, folder / f"torque_curve{ending}"),
        figures.draw_spectrum(found.spectrum, title, folder / f"transmission_error_orders{ending}"),
        figures.draw_pressure(
            found.crank_angle, found.pressure, found.safety, title, folder / f"flank_pressure{ending}", discs
        ),
    ]


def _finite(value: float) -> float | None:
    return None if value == float("inf") else value


def _content(found: CaseCurves, drive: Drive) -> dict[str, Any]:
    from ltca.analysis.life.life_text import life_content
    from ltca.analysis.torque_curve import curve_content

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
