"""``cyclo show``: what a drive is, before and beside its analysis."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from ltca.reading.arguments import (
    add_angle_argument,
    add_case_argument,
    add_drive_argument,
    add_out_argument,
    default_folder,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ltca.analysis.loaded_analysis import LoadedAnalysis
    from ltca.arrays import FloatArray
    from ltca.drive.parts import Drive

SUMMARY = "derived geometry, backlash, checks and a picture with contact normals and loads"
EXAMPLES = (
    ("cyclo show my.toml", "what follows from the numbers of a drive file"),
    ("cyclo show paper --case CS-3 --angle '20 deg'", "a picture at that crank angle"),
)


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_drive_argument(parser)
    add_case_argument(parser, "case to show, repeatable; default the first")
    add_angle_argument(parser)
    add_out_argument(parser, "show", "folder for the picture")


def execute(arguments: argparse.Namespace) -> int:
    """Print the drive and write its picture."""
    from glob import escape

    import numpy as np

    from ltca.output.file_names import file_words
    from ltca.output.run_folder import claimed_folder
    from ltca.reading.drive_file import load_drive

    angle = arguments.angle
    file = load_drive(arguments.drive)
    cases = file.select(arguments.case or [next(iter(file.cases))])
    out = arguments.out or default_folder(file.name, "show")
    print(f"{file.name} ({file.source}): cases {', '.join(file.cases)}; a valid drive file")
    pictures = {f"drive_{word}.png": f"drive {file.name}, case {name}" for name, word in file_words(cases).items()}
    with claimed_folder(out, "show", writes=[escape(name) for name in pictures], adding=True, origins=pictures):
        _show(cases, np.array([angle]), out)
    return 0


def _show(cases: dict[str, Drive], angle: FloatArray, out: Path) -> None:
    from ltca.analysis.engines import describe_engine
    from ltca.analysis.loaded_analysis import analyse
    from ltca.analysis.verdict.proportions import odd_proportions
    from ltca.figures.drive_picture import draw_drive
    from ltca.output.file_names import file_words
    from ltca.page.derived import derived_rows

    words = file_words(cases)
    for name, drive in cases.items():
        print(f"\ncase {name}")
        analysis = analyse(drive, angle)
        for warning in analysis.warnings:
            print(f"  warning: {warning}")
        for proportion in odd_proportions(analysis.as_written):
            print(f"  note: {proportion}")
        written, drive = drive, analysis.drive
        for title, value in derived_rows(written, drive):
            print(f"  {title:<47} {value}")
        print(f"  at φ_C = {angle[0]:g} rad, {drive.load_words()}, {describe_engine(analysis.engine)}")
        for title, value in _loads(analysis):
            print(f"    {title:<45} {value}")
        if analysis.share_words:
            print(f"  note: {analysis.share_words}")
        path = out / f"drive_{words[name]}.png"
        draw_drive(drive, analysis, 0, path, name if len(cases) > 1 or name != "nominal" else "")
        print(f"  picture: {path}")


def _of_crank(crank: int, all_of_them: Sequence[object]) -> str:
    return f", crank {crank}" if len(all_of_them) > 1 else ""


def _loads(analysis: LoadedAnalysis) -> list[tuple[str, str]]:
    import numpy as np

    from ltca.drive.units.quantities import ARCMIN
    from ltca.geometry.coordinates import DISC_ROTATION, WHEEL_ANGLE

    def loaded(values: FloatArray) -> str:
        numbers = np.nonzero(values > 1e-3 * values.max())[0]
        return ", ".join(f"{n}: {values[n]:.0f} N" for n in numbers) or "none"

    rows = []
    share = analysis.torque_share[0]
    for number, disc in enumerate(analysis.discs):
        contacts = disc.full.response
        x, y, rotation = disc.full.pose[0, : DISC_ROTATION + 1]
        of = "" if share.size == 1 else f"disc {number}: "
        rows += [(f"{of}part of the torque", f"{share[number]:.4f}")] if of else []
        rows += [(f"{of}wheel pins", loaded(contacts.pin_load[0]))]
        rollers = np.split(contacts.rollers.outer_load[0], disc.bearing_radial.shape[2])
        rows += [
            (f"{of}rollers, on the bore{_of_crank(crank, rollers)}", loaded(load)) for crank, load in enumerate(rollers)
        ]
        rows += [(f"{of}shaft pins", loaded(contacts.hole_load[0]))] if contacts.hole_load.size else []
        forces = zip(disc.bearing_radial[0, 0], disc.bearing_tangential[0, 0], strict=True)
        for crank, (radial, tangential) in enumerate(forces):
            on = f"{of}bearing load on it" if of else "bearing load on the disc"
            rows += [(f"{on}{_of_crank(crank, rollers)}, radial, tangential", f"{radial:z.1f}, {tangential:z.1f} N")]
        rows += [
            (f"{of}displacement x, y" if of else "disc displacement x, y", f"{1e3 * x:z.2f}, {1e3 * y:z.2f} µm"),
            (f"{of}rotation" if of else "disc rotation", f"{rotation * ARCMIN:z.4f}′"),
        ]
    wheel = analysis.full.pose[0, WHEEL_ANGLE]
    rows += [("wheel angle", f"{wheel * ARCMIN:z.4f}′")]
    if analysis.drive.wheel_is_held:
        rows += [
            ("moment that holds the wheel", f"{analysis.full.wheel_moment[0] / 1000.0:.6g} N·m"),
            ("deviation of the output", f"{analysis.transmission_error[0] * ARCMIN:z.4f}′"),
        ]
    return rows
