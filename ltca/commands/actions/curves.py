"""Solve the cases of ``cyclo curves``; write curves.json, page and figures, print the results."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping
from pathlib import Path

from ltca.analysis.drive_curves import (
    CurveSettings,
    DriveCurves,
    allowed_pressure,
    curve_lines,
    fewest_turns,
    life_speed,
    positions_per_turn,
    resolution_words,
    solve_curves,
)
from ltca.analysis.engines import Engine, describe_engine
from ltca.analysis.half_space_errors import half_space_notes
from ltca.analysis.life.life_text import life_lines
from ltca.analysis.light_torque import light_torque_lines
from ltca.drive.parts import Drive
from ltca.output.file_names import file_words
from ltca.output.files import write_json
from ltca.output.progress import progress
from ltca.page.studies.curves import (
    TurnOfPressure,
    life_section,
    orders_section,
    parts_section,
    pressure_section,
    torque_section,
)
from ltca.page.study_page import Section, StudyPage, write_study_page
from ltca.reading.drive_file import DriveFile


def tell_of_turns(drive: Drive, turns: int, positions: int) -> None:
    """Print before a long computation how many turns would do."""
    least = fewest_turns(drive, turns)
    if least < turns:
        told = (
            f"all {turns} turns of the crank are {positions} positions; --turns {least} would do, too, "
            f"where orders nearer than 1/{least} need not be told apart"
        )
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
    contents, every = {}, dict[str, DriveCurves]()
    turns_of = {name: arguments.turns or drive.pin_wheel.number_of_pins for name, drive in cases.items()}
    total = sum(turns * positions_per_turn(cases[name]) for name, turns in turns_of.items())
    with progress("positions", total) as advance:
        for name, drive in cases.items():
            title = f"{file.name} {name}"
            own = (
                settings
                if settings.pressure is not None
                else settings._replace(pressure=allowed_pressure(drive, file.limits[name]))
            )
            found = solve_curves(drive, turns_of[name], own, engine, lambda size, case=name: advance(case, size))  # type: ignore[misc]
            contents[name] = {"drive": title, **engine.options, **found.content}
            print("\n".join(curve_lines(found, title)))
            every[name] = found
    if arguments.figures:
        figures = _draw(every, file.name, out / "figures", arguments.figures)
        print(f"figures: {out / 'figures'} ({len(figures)} as {arguments.figures.upper()})")
    (first, *others) = contents.values()
    write_json(out / "curves.json", {"drive": file.name, "cases": contents} if others else first)
    files = [out / "curves.json"]
    if not arguments.no_page:
        sections = _sections(every)
        loads = dict.fromkeys(drive.load_words() for drive in cases.values())
        notes = half_space_notes(engine, cases)
        told = "; ".join(
            [f"curves at {', '.join(loads)}, {describe_engine(engine)}", *notes, *light_torque_lines(cases)]
        )
        page = StudyPage(name=file.name, told=told, sections=sections, made=engine.options, text=file.text)
        files.append(write_study_page(page, out))
    print("results: " + ", ".join(map(str, files)))
    return 0


def _sections(every: Mapping[str, DriveCurves]) -> list[Section]:
    """What the page shows of all cases."""
    lives = {name: found.lives for name, found in every.items()}
    turns = {name: TurnOfPressure(found.crank_angle, found.pressure, found.safety) for name, found in every.items()}
    lines = {
        name: life_lines(found.lives, found.drive, life_speed(found.drive, found.settings))
        for name, found in every.items()
    }
    return [
        torque_section(
            {name: found.curve for name, found in every.items()},
            {name: found.backlash_words for name, found in every.items()},
        ),
        *parts_section({name: found.parts for name, found in every.items() if found.parts is not None}),
        orders_section(
            {name: found.spectrum.resolved() for name, found in every.items()},
            [
                "; ".join(
                    [f"over {found.turns} turns, {found.positions} positions", *filter(None, [resolution_words(found)])]
                )
                for found in every.values()
            ],
        ),
        life_section(lives, lines),
        pressure_section(turns),
    ]


def _draw(every: Mapping[str, DriveCurves], name: str, folder: Path, kind: str) -> list[Path]:
    from ltca.figures import curve_figures as figures
    from ltca.figures.shared_axes import order_axes, pressure_axis, torque_axes

    torques = torque_axes(found.curve for found in every.values())
    orders = order_axes(found.spectrum.resolved() for found in every.values())
    pressures = pressure_axis(found.safety for found in every.values())
    files, words = [], file_words(every)
    for case, found in every.items():
        title, ending = f"{name} {case}", f"_{words[case]}.{kind}" if len(every) > 1 else f".{kind}"
        discs = found.drive.disc.number_of_discs
        files += [
            figures.draw_torque_curve(found.curve, title, folder / f"torque_curve{ending}", torques),
            figures.draw_spectrum(
                found.spectrum.resolved(), title, folder / f"transmission_error_orders{ending}", orders
            ),
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
