"""Solve the cases of ``cyclo dynamics``; write dynamics.json, dynamics.nc, page and figures, print the results."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ltca.analysis.drive_curves import fewest_turns
from ltca.analysis.engines import Engine, describe_engine
from ltca.analysis.force_dataset import force_dataset
from ltca.analysis.forced_vibration import ForcedVibration, forced_vibration, response_content, response_notes
from ltca.analysis.half_space_errors import half_space_notes, half_space_words
from ltca.analysis.vibration import (
    TORQUE_PARTS,
    Vibration,
    speed_range,
    vibration,
    vibration_content,
    walked_positions,
)
from ltca.arrays import FloatArray
from ltca.drive.parts import Drive
from ltca.drive.units.quantities import ARCSEC
from ltca.dynamics.kinetics import require_masses
from ltca.dynamics.masses import drive_masses
from ltca.output.file_names import file_words
from ltca.output.files import whole_file, write_json
from ltca.output.netcdf import write_netcdf
from ltca.output.progress import progress
from ltca.page.studies.dynamics import dynamics_sections
from ltca.page.study_page import StudyPage, write_study_page
from ltca.reading.drive_file import DriveFile

SPEEDS_PRINTED = 12
"""Critical speeds printed, those in the range of the speeds first; files have all."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Found:
    """What was found of one case.

    Attributes
    ----------
    vibration : Vibration
        Modes and critical speeds.
    response : ForcedVibration or None
        Of a drive with damping.
    fastest : float
        Largest speed of the input, turns a minute.
    """

    vibration: Vibration
    response: ForcedVibration | None
    fastest: float


def require_vibrations(drive: Drive) -> None:
    """Refuse a drive whose vibrations cannot be told, before anything is solved."""
    require_masses(drive_masses(drive))


def solve_and_write(
    file: DriveFile, cases: dict[str, Drive], engine: Engine, arguments: argparse.Namespace, out: Path
) -> int:
    """Solve every case, write dynamics.json, dynamics.nc, page and figures, print the results; return the exit status."""
    contents, every = {}, dict[str, Found]()
    turns = {
        name: arguments.turns or fewest_turns(drive, drive.pin_wheel.number_of_pins) for name, drive in cases.items()
    }
    at_modes = len(TORQUE_PARTS) * arguments.positions
    total = sum(turns[name] * walked_positions(drive, arguments.positions) + at_modes for name, drive in cases.items())
    with progress("positions", total) as advance:
        for name, drive in cases.items():
            found = vibration(
                drive,
                engine=engine.with_coefficients(drive),
                positions=arguments.positions,
                turns=turns[name],
                advance=lambda size, case=name: advance(case, size),  # type: ignore[misc]
            )
            fastest = arguments.speed or speed_range(drive)[1]
            answer = None if drive.damping is None else forced_vibration(found, fastest=fastest)
            every[name] = Found(vibration=found, response=answer, fastest=fastest)
            title = f"{file.name} {name}"
            contents[name] = {
                "drive": title,
                **engine.options,
                **vibration_content(found, fastest),
                "response": None if answer is None else response_content(answer, found),
            }
            print("\n".join(_lines(every[name], title)))
    if arguments.figures:
        figures = _draw(every, file.name, out / "figures", arguments.figures)
        print(f"figures: {out / 'figures'} ({len(figures)} as {arguments.figures.upper()})")
    (first, *others) = contents.values()
    write_json(out / "dynamics.json", {"drive": file.name, "cases": contents} if others else first)
    files, in_files = [], file_words(every)
    for name, case in every.items():
        path = out / f"dynamics{f'_{in_files[name]}' if others else ''}.nc"
        with whole_file(path) as part:
            write_netcdf(force_dataset(case.vibration, case.response), part)
        files.append(path)
    files.append(out / "dynamics.json")
    if not arguments.no_page:
        loads = dict.fromkeys(drive.load_words() for drive in cases.values())
        notes = half_space_notes(engine, cases)
        told = "; ".join([f"vibrations at {', '.join(loads)}, {describe_engine(engine)}", *notes])
        sections = [
            section
            for name, found in every.items()
            for section in dynamics_sections(
                name if len(every) > 1 else "", found.vibration, found.response, found.fastest
            )
        ]
        page = StudyPage(name=file.name, told=told, sections=sections, made=engine.options, text=file.text)
        files.append(write_study_page(page, out))
    print("results: " + ", ".join(map(str, files)))
    return 0


def _lines(found: Found, title: str) -> list[str]:
    """Results as lines for the terminal."""
    shaken, drive = found.vibration, found.vibration.drive
    least = shaken.torque[0] / shaken.torque[-1]
    lines = [
        f"{title}, {drive.load_words()}, {describe_engine(shaken.engine)}: modes at {shaken.crank_angle.size} crank angles, "
        f"{shaken.ends_words}",
        *(f"  {words}" for words in [half_space_words(shaken.engine, drive)] if words),
        f"  mode   Hz over a turn      at {least:.0%} of it  what moves (part of the kinetic energy)",
    ]
    for mode, words in enumerate(shaken.words):
        over, light = shaken.at_load[:, mode], shaken.frequency[0, :, mode]
        lines.append(f"  {mode + 1:>4}   {_range(over):<19} {_hertz(light.mean()):<12}  {words}")
    speeds = shaken.critical_speeds(found.fastest)
    inside = [one for one in speeds if one.in_duty]
    shown = sorted((*inside, *(one for one in speeds if not one.in_duty))[:SPEEDS_PRINTED], key=lambda one: one.speed)
    low, high = speed_range(drive)
    known = bool(drive.duty) or drive.load.speed is not None
    lines.append(
        f"critical speeds of the input up to {found.fastest:g} rpm, orders of the transmission error over {shaken.turns} turns"
        + (f"; * meets {_speed_words(low, high)}" if known else "")
    )
    lines += [
        f"  {'*' if one.in_duty else ' '} {one.slowest:>8.0f} … {one.fastest:<8.0f} rpm  mode {one.mode + 1}, order "
        f"{one.order.value:.6g} ({one.order.name}), {one.amplitude * ARCSEC:.4f}″"
        for one in shown
    ] or ["  none"]
    if len(speeds) > len(shown):
        lines.append(f"  and {len(speeds) - len(shown)} more in dynamics.json")
    return lines + _response_lines(found)


def _speed_words(low: float, high: float) -> str:
    return f"{low:g} rpm" if low == high else f"{low:g} … {high:g} rpm"


def _response_lines(found: Found) -> list[str]:
    answer = found.response
    if answer is None:
        return ["response over speed: none without damping (damping.ratio or damping.loss_factor)"]
    damping = found.vibration.drive.damping
    told = (
        ""
        if damping is None
        else f"damping ratio {damping.ratio:g}"
        if damping.ratio is not None
        else f"loss factor {damping.loss_factor:g}"
    )
    worst = int(np.argmax(answer.amplitude))
    lines = [
        f"response up to {found.fastest:g} rpm, {told}, contacts closed",
        f"  transmission error, rms           {answer.amplitude[0] * ARCSEC:.4f}″ at {answer.speed[0]:.4g} rpm, "
        f"{answer.amplitude[worst] * ARCSEC:.4f}″ at {answer.speed[worst]:.4g} rpm",
    ]
    for kind, factor in answer.factors.items():
        at = int(np.argmax(factor))
        lines.append(f"  dynamic factor of {kind:<16} {factor[at]:.4f} at {answer.speed[at]:.4g} rpm")
    return lines + [f"  {note}" for note in response_notes(answer, found.vibration)]


def _hertz(value: float) -> str:
    return f"{value:.0f}" if value >= 1000.0 else f"{value:.4g}"


def _range(values: FloatArray) -> str:
    low, high = _hertz(values.min()), _hertz(values.max())
    return low if low == high else f"{low} … {high}"


def _draw(every: Mapping[str, Found], name: str, folder: Path, kind: str) -> list[Path]:
    from ltca.figures.vibration_figures import draw_campbell, draw_response

    files, words = [], file_words(every)
    for case, found in every.items():
        title, ending = f"{name} {case}", f"_{words[case]}.{kind}" if len(every) > 1 else f".{kind}"
        files.append(draw_campbell(found.vibration, found.fastest, title, folder / f"campbell_diagram{ending}"))
        if found.response is not None:
            files.append(draw_response(found.response, found.vibration, title, folder / f"response{ending}"))
    return files
