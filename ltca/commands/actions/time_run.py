"""Run the cases of ``cyclo dynamics --time``; write time.nc, time.json, page and figures, print the results."""

from __future__ import annotations

import argparse
import hashlib
import re
import time
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from ltca.analysis.engines import Engine, describe_engine
from ltca.analysis.half_space_errors import half_space_words
from ltca.analysis.time_dataset import loads_by_kind, time_content, time_dataset
from ltca.analysis.time_run import Checkpoint, Course, PreparedRun, TimeRun, prepare_run, run_in_time, samples_of
from ltca.drive.parts import Drive
from ltca.drive.units.quantities import ARCSEC
from ltca.errors import CycloError, DamagedFileError, DriveError, PlaceError
from ltca.output.file_names import file_words
from ltca.output.files import whole_file, write_json
from ltca.output.netcdf import write_netcdf
from ltca.output.progress import progress
from ltca.page.studies.time_run import time_sections
from ltca.page.study_page import StudyPage, write_study_page
from ltca.reading.drive_file import DriveFile

CHECKPOINTS = "checkpoint"
"""Folder of interrupted runs, a file for each case."""
KEPT = ("time", "step", "state", "rows")
"""What of a checkpoint stands beside its samples."""
SAVED_EVERY = 20.0
"""Seconds of work between two checkpoints."""
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
    for name, drive in cases.items():
        prepared[name] = prepare_run(drive, engine.with_coefficients(drive), course_of(drive, arguments))
    total = sum(samples_of(run.course, run.drive) for run in prepared.values())
    every: dict[str, TimeRun] = {}
    with progress("samples", total) as advance:
        for number, (name, run) in enumerate(prepared.items()):
            path = out / CHECKPOINTS / f"{number}.npz"
            mark = _mark(file, run)
            resumed = _read(path, mark) if arguments.resume and path.exists() else None
            save = _saving(path, mark)
            every[name] = run_in_time(
                run,
                advance=partial(advance, name),
                save=save,
                resumed=resumed,
            )
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
        words = half_space_words(engine, next(iter(cases.values())))
        sections = [
            section for name, found in every.items() for section in time_sections(name if len(every) > 1 else "", found)
        ]
        page = StudyPage(
            name=file.name,
            told="; ".join(filter(None, (told, words))),
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
        with whole_file(path) as part, part.open("wb") as stream:
            kept: dict[str, Any] = {name: getattr(found, name) for name in KEPT}
            kept |= {f"samples_{name}": values for name, values in found.samples.items()}
            np.savez(stream, mark=np.array(mark), **kept)

    return save


def _read(path: Path, mark: str) -> Checkpoint:
    """Return where a run stood; refused where it is of something else, or damaged."""
    try:
        with np.load(path, allow_pickle=False) as content:
            held: dict[str, Any] = {name: content[name] for name in content.files}
        if str(held["mark"]) != mark:
            raise CycloError(f"{path}: holds another run ({WHAT_DIFFERS}); resume with the options it was started with")
        return Checkpoint(
            time=float(held["time"]),
            step=float(held["step"]),
            state=held["state"],
            rows=int(held["rows"]),
            samples={
                name.removeprefix("samples_"): values for name, values in held.items() if name.startswith("samples_")
            },
        )
    except (OSError, ValueError, KeyError) as error:
        raise DamagedFileError(f"{path}: is no checkpoint of a run in time; remove it to begin anew") from error


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
        f"  transmission error        {error.min():.4f}″ … {error.max():.4f}″",
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
