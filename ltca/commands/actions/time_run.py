"""Run the cases of ``cyclo dynamics --time``; write time.nc, time.json, page and figures, print the results."""

from __future__ import annotations

import argparse
import hashlib
import os
import re
import time
from collections.abc import Callable, Mapping
from dataclasses import fields
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from ltca.analysis.engines import Engine, describe_engine
from ltca.analysis.half_space_errors import half_space_notes, half_space_words
from ltca.analysis.time_dataset import loads_by_kind, time_content, time_dataset
from ltca.analysis.time_run import Checkpoint, Course, PreparedRun, TimeRun, prepare_run, run_in_time, samples_of
from ltca.drive.parts import Drive
from ltca.drive.units.quantities import ARCSEC
from ltca.errors import CycloError, DamagedFileError, DriveError, PlaceError
from ltca.output.checked_arrays import read_arrays, write_arrays
from ltca.output.file_names import file_words
from ltca.output.files import whole_file, write_json
from ltca.output.netcdf import write_netcdf
from ltca.output.progress import progress
from ltca.page.studies.time_run import time_sections
from ltca.page.study_page import StudyPage, write_study_page
from ltca.reading.drive_file import DriveFile

CHECKPOINTS = "checkpoint"
"""Folder of interrupted runs, a file for each case."""
SAVED_EVERY = 20.0
"""Seconds of work between two checkpoints."""
REMOVED = "remove it to begin anew"
WHAT_DIFFERS = "another drive file, engine, motion or version"


def course_of(drive: Drive, arguments: argparse.Namespace) -> Course:
    """Return what the options ask of a drive; DriveError where they do not fit."""
    speed = arguments.speed if arguments.speed is not None else drive.load.speed
    if speed is None:
        raise DriveError(["--speed: must be given for a run in time (or load.speed in the drive file), rpm"])
    values = {
        name: getattr(arguments, name) for name in ("within", "at", "from_speed", "factor", "amplitude", "frequency")
    }
    motion, driven = arguments.motion or "steady", arguments.driven_by or "speed"
    try:
        return Course.of_values(motion, arguments.time, speed, driven, **values)
    except DriveError as error:
        raise DriveError([_of_option(problem) for problem in error.problems]) from error


def _of_option(problem: str) -> str:
    """Name the option in what is wrong with a value of the course."""
    return re.sub(r"^(\w+)|(?<=after )(at)\b", lambda name: f"--{name[0].replace('_', '-')}", problem)


def require_checkpoints(out: Path, resume: bool) -> None:
    """Refuse a folder whose interrupted run is not to be continued, and one without any that is."""
    there = any((out / CHECKPOINTS).glob("*.npz"))
    if there and not resume:
        raise PlaceError(f"--out {out}: holds an interrupted run; continue it with --resume, or choose another --out")
    if resume and not there:
        raise CycloError(f"{out}: holds no run to resume")


def run_and_write(
    file: DriveFile, cases: Mapping[str, Drive], engine: Engine, arguments: argparse.Namespace, out: Path
) -> int:
    """Run every case, write time.nc, time.json, page and figures, print the results; return the exit status."""
    prepared: dict[str, PreparedRun] = {}
    resumed: dict[str, Checkpoint] = {}
    for number, (name, drive) in enumerate(cases.items()):
        prepared[name] = prepare_run(drive, engine.with_coefficients(drive), course_of(drive, arguments))
        path = _checkpoint(out, number)
        if arguments.resume and os.path.lexists(path):
            resumed[name] = _read(path, _mark(file, prepared[name]))
    total = sum(samples_of(run.course, run.drive) for run in prepared.values())
    every: dict[str, TimeRun] = {}
    with progress("samples", total) as advance:
        for number, (name, run) in enumerate(prepared.items()):
            path = _checkpoint(out, number)
            save = _saving(path, _mark(file, run))
            try:
                every[name] = run_in_time(run, advance=partial(advance, name), save=save, resumed=resumed.get(name))
            except DamagedFileError as error:
                raise DamagedFileError(f"{path}: {error}; {REMOVED}") from error
            print("\n".join(_lines(every[name], f"{file.name} {name}")))
    files, contents, in_files = [], {}, file_words(every)
    for name, found in every.items():
        ending = f"_{in_files[name]}" if len(every) > 1 else ""
        with whole_file(out / f"time{ending}.nc") as part:
            write_netcdf(time_dataset(found), part)
        files.append(out / f"time{ending}.nc")
        contents[name] = {"drive": f"{file.name} {name}", **engine.options, **time_content(found)}
    (first, *others) = contents.values()
    write_json(out / "time.json", {"drive": file.name, "cases": contents} if others else first)
    files.append(out / "time.json")
    if arguments.figures:
        figures = _draw(every, file.name, out / "figures", arguments.figures)
        print(f"figures: {out / 'figures'} ({len(figures)} as {arguments.figures.upper()})")
    if not arguments.no_page:
        loads = dict.fromkeys(drive.load_words() for drive in cases.values())
        told = f"run in time at {', '.join(loads)}, {describe_engine(engine)}"
        sections = [
            section for name, found in every.items() for section in time_sections(name if len(every) > 1 else "", found)
        ]
        page = StudyPage(
            name=file.name,
            told="; ".join([told, *half_space_notes(engine, cases)]),
            sections=sections,
            made=engine.options,
            text=file.text,
        )
        files.append(write_study_page(page, out))
    for path in (out / CHECKPOINTS).glob("*.npz"):
        path.unlink()
    if (out / CHECKPOINTS).is_dir():
        (out / CHECKPOINTS).rmdir()
    print("results: " + ", ".join(map(str, files)))
    return 0


def _checkpoint(out: Path, number: int) -> Path:
    return out / CHECKPOINTS / f"{number}.npz"


def _mark(file: DriveFile, run: PreparedRun) -> str:
    """What a run is of, for its checkpoint."""
    from importlib.metadata import version

    text = repr((run.drive, run.engine.options, run.course, version("cyclo-ltca")))
    return hashlib.sha256(f"{file.name}\n{text}".encode()).hexdigest()


def _saving(path: Path, mark: str) -> Callable[[Callable[[], Checkpoint]], None]:
    last = time.monotonic()

    def save(state: Callable[[], Checkpoint]) -> None:
        nonlocal last
        if time.monotonic() - last < SAVED_EVERY:
            return
        last, found = time.monotonic(), state()
        kept: dict[str, Any] = {"mark": mark}
        for item in fields(Checkpoint):
            value = getattr(found, item.name)
            kept |= (
                {f"{item.name}/{name}": values for name, values in value.items()}
                if isinstance(value, dict)
                else {item.name: value}
            )
        write_arrays(path, kept)

    return save


def _read(path: Path, mark: str) -> Checkpoint:
    """Read the checkpoint of a run; CycloError where it belongs to another run, DamagedFileError where it is damaged."""
    try:
        held = read_arrays(path, "a checkpoint of a run in time")
    except DamagedFileError as error:
        raise DamagedFileError(f"{error}; {REMOVED}") from error
    if str(held.pop("mark", "")) != mark:
        raise CycloError(f"{path}: holds another run ({WHAT_DIFFERS}); resume with the options it was started with")
    parts: dict[str, Any] = {"samples": {}, "followed": {}}
    for name, values in held.items():
        of, _, inside = name.partition("/")
        if inside:
            parts.setdefault(of, {})[inside] = values
        else:
            parts[of] = values if values.ndim else values.item()
    try:
        return Checkpoint(**parts)
    except TypeError as error:
        raise DamagedFileError(f"{path}: is no checkpoint of a run in time of this version; {REMOVED}") from error


def _lines(found: TimeRun, title: str) -> list[str]:
    """Results as lines for the terminal."""
    drive, course, energy = found.drive, found.course, found.energy
    content = time_content(found)
    damped = drive.damping is not None
    told = ", ".join(f"{name} {value:g}" for name, value in course.values.items() if isinstance(value, float))
    error = found.transmission_error * ARCSEC
    lines = [
        f"{title}, {drive.load_words()}, {describe_engine(found.engine)}: {course.motion} in time, {told}, "
        + (f"damping ratio {content['damping_ratio']:g}" if damped else "no damping (damping.ratio)"),
        *(f"  {words}" for words in [half_space_words(found.engine, drive)] if words),
        f"  transmission error        {error.min():z.4f}″ … {error.max():z.4f}″",
        f"  torque at the input       {_metres(content['input_torque_N_mm'])} N·m",
    ]
    lines += [
        f"  largest load, {kind:<13} {values.max():.1f} N"
        for kind, values in loads_by_kind(found).items()
        if values.size
    ]
    lines.append(f"  time without contact      {found.lost_contact:.2%} (of a disc with its pins)")
    for order in sorted(content["orders"], key=lambda one: -one["amplitude_rad"])[:5]:
        lines.append(f"  order {order['order']:<10.6g} {order['amplitude_rad'] * ARCSEC:.4f}″ by turn of the crank")
    parts = ", ".join(
        f"{name} {value / 1e3:.4g}"
        for name, value in (
            ("input", energy.input), ("output", energy.output), ("damping", energy.damping), ("friction", energy.friction),
            ("kinetic", energy.kinetic), ("stored", energy.stored), ("curvature", energy.curvature),
            ("stations", energy.stations),
            ("teeth", energy.teeth),
        )
        if np.isfinite(value)
    )  # fmt: skip
    closed = f"{energy.relative:.1e} of the throughput left" if np.isfinite(energy.left) else NOT_TOLD
    return [*lines, f"  energy, J                 {parts}; {closed}"]


NOT_TOLD = "stored energy is not told on contact grids (method = direct)"


def _metres(values: Mapping[str, float]) -> str:
    return f"{values['least'] / 1e3:.5g} … {values['largest'] / 1e3:.5g}"


def _draw(every: Mapping[str, TimeRun], name: str, folder: Path, kind: str) -> list[Path]:
    from ltca.figures.time_figures import draw_time_run

    files, words = [], file_words(every)
    for case, found in every.items():
        ending = f"_{words[case]}.{kind}" if len(every) > 1 else f".{kind}"
        files.append(draw_time_run(found, f"{name} {case}", folder / f"time_run{ending}"))
    return files
