"""Solve the cases of ``cyclo curves``; write curves.json, page and figures, print the results."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from ltca.analysis.drive_curves import (
    CurveSettings,
    DriveCurves,
    allowed_pressure,
    curve_lines,
    fewest_turns,
    life_speed,
    positions_per_turn,
    solve_curves,
)
from ltca.analysis.engines import Engine, describe_engine
from ltca.analysis.half_space_errors import half_space_words
from ltca.analysis.life.life_text import life_lines
from ltca.drive.parts import Drive
from ltca.output.files import write_json
from ltca.output.progress import progress
from ltca.page.studies.curves import life_section, orders_section, pressure_section, torque_section
from ltca.page.study_page import Section, StudyPage, write_study_page
from ltca.reading.drive_file import DriveFile


def tell_of_turns(drive: Drive, turns: int, positions: int) -> None:
    """Print before a long computation how many turns would do."""
    least = fewest_turns(drive, turns)
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
    contents, figures = {}, []
    sections: list[Section] = []
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
            if not arguments.no_page:
                sections += _sections(found, f"{name}: " if len(cases) > 1 else "")
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
        loads = dict.fromkeys(drive.load_words() for drive in cases.values())
        words = half_space_words(engine, next(iter(cases.values())))
        told = "; ".join(filter(None, (f"curves at {', '.join(loads)}, {describe_engine(engine)}", words)))
        page = StudyPage(name=file.name, told=told, sections=sections, made=engine.options, text=file.text)
        files.append(write_study_page(page, out))
    print("results: " + ", ".join(map(str, files)))
    return 0


def _sections(found: DriveCurves, of: str) -> list[Section]:
    """What the page shows of a case; `of` names it where there are several."""
    over = f"over {found.turns} turns, {found.positions} positions"
    return [
        torque_section(found.curve, of),
        orders_section(found.spectrum, over, of),
        life_section(life_lines(found.lives, found.drive, life_speed(found.drive, found.settings)), of),
        pressure_section(found.crank_angle, found.pressure, found.safety, of),
    ]


def _draw(found: DriveCurves, title: str, discs: int, folder: Path, ending: str) -> list[Path]:
    from ltca.figures import curve_figures as figures

    return [
        figures.draw_torque_curve(found.curve, title, folder / f"torque_curve{ending}"),
        figures.draw_spectrum(found.spectrum, title, folder / f"transmission_error_orders{ending}"),
        figures.draw_pressure(
            found.crank_angle, found.pressure, found.safety, title, folder / f"flank_pressure{ending}", discs
        ),
    ]
