"""``cyclo export``: parts for CAD, printers, grinders and measuring machines; the whole drive for simulators."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from ltca.commands.reduced_model import add_simulator_arguments, export_model, refuse_simulator_options
from ltca.errors import DriveError
from ltca.reading.arguments import (
    add_case_argument,
    add_drive_argument,
    add_out_argument,
    count_argument,
    default_folder,
    quantity_argument,
    tell_unit_mistakes,
)

if TYPE_CHECKING:
    from ltca.export.parts import Part

SUMMARY = "write parts of a drive for CAD (DXF, STEP, STL, CSV), or a reduced model of it for simulators"
EXAMPLES = (
    ("cyclo export my.toml --format step", "the discs as solids, in their own frame"),
    ("cyclo export my.toml --format dxf --part assembly", "everything at φ_C = 0, a layer a part"),
    ("cyclo export my.toml --format stl --compensate 0.1", "for a printer whose walls grow by 0.1 mm"),
    ("cyclo export my.toml --for mujoco", "the drive in a robot's joint: MJCF, tables and callback"),
)
FORMATS = ("dxf", "step", "stl", "csv")
PARTS = ("disc", "pin-wheel", "pin-shaft", "carrier", "assembly")
SOLID = ("step", "stl")


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_drive_argument(parser)
    add_case_argument(parser, "case; default the first", several=False)
    add_out_argument(parser, "export", "folder for the files; what earlier exports wrote there stays")
    which = parser.add_mutually_exclusive_group(required=True)
    which.add_argument("--format", choices=FORMATS, help="of the files of a part")
    parser.add_argument("--part", choices=PARTS, help="what to write; default disc")
    parser.add_argument(
        "--disc",
        metavar="K",
        type=count_argument("--disc", 0, 9),
        help="of several discs this one, counted from 0; default all, a file each",
    )
    parser.add_argument(
        "--compensate",
        metavar="C",
        type=quantity_argument("--compensate", "mm", ge=-1.0, le=1.0),
        help="for printers: move every face into the material by so much, mm: outlines shrink, bores and holes grow",
    )
    parser.add_argument(
        "--chord",
        metavar="H",
        type=quantity_argument("--chord", "mm", gt=1e-6, le=1.0),
        help="of STL: largest distance of a triangle from the exact surface, mm; default 0.001",
    )
    add_simulator_arguments(parser, which)


def execute(arguments: argparse.Namespace) -> int:
    """Write the files of a part, or of a simulator.

    Returns
    -------
    int
        0.

    Raises
    ------
    CycloError
        For wrong input, what cannot be exported, or missing libraries.
    """
    if arguments.simulator is not None:
        for option in ("part", "disc", "compensate", "chord"):
            if getattr(arguments, option) is not None:
                raise DriveError([f"--{option}: has no effect with --for {arguments.simulator}; leave one of them out"])
        return export_model(arguments)
    refuse_simulator_options(arguments)
    return _export_part(arguments)


def _export_part(arguments: argparse.Namespace) -> int:
    """Write the files of a part; return the exit status."""
    from glob import escape

    from ltca.export.parts import make_parts
    from ltca.output.run_folder import claimed_folder
    from ltca.reading.drive_file import load_drive

    if arguments.chord is not None and arguments.format != "stl":
        raise DriveError([f"--chord {arguments.chord:g} mm: is for --format stl, {arguments.format} is exact"])
    file = load_drive(arguments.drive)
    case, drive = next(iter(file.select([arguments.case] if arguments.case else None).items()))
    tell_unit_mistakes([drive])
    _require_libraries(arguments.format)
    arguments.part = arguments.part or "disc"
    parts = make_parts(drive, case, arguments.part, disc=arguments.disc, compensation=arguments.compensate or 0.0)
    for part in parts:
        _require_straight(part, arguments.format)
    out = arguments.out or default_folder(file.name, "export")
    names = [path.name for part in parts for path in _paths(part, arguments.format, out)]
    origins = dict.fromkeys(names, f"drive {file.name}, case {case}")
    told = ", lengths at 20 °C" if drive.temperature is not None else ""
    print(f"{file.name} {case}, {arguments.part}{told}", flush=True)
    with claimed_folder(out, "export", writes=map(escape, names), adding=True, origins=origins):
        for part in parts:
            _write(part, arguments, out)
    return 0


def _require_libraries(kind: str) -> None:
    """Raise an error before any work when a library of the system is missing."""
    from fem.mesh.gmsh_session import load_gmsh

    if kind in SOLID:
        load_gmsh()


def _require_straight(part: Part, kind: str) -> None:
    """Refuse profiles along the length and inclinations, which straight and upright bodies do not have."""
    from ltca.drive.members.width import needs_slices

    if kind in SOLID and part.profiled:
        raise DriveError(
            [
                f"{field}: inclinations are not written to {kind.upper()}, whose pins and holes stand upright; --format dxf and "
                "csv hold the section at z = 0 of the planes of the discs"
                if needs_slices(field)
                else f"{field}: crown and relief along the length are not written to {kind.upper()}, whose pins and rollers are "
                "straight; --format dxf and csv hold the section at mid-length, --part disc has none of them"
                for field in part.profiled
            ]
        )


def _paths(part: Part, kind: str, out: Path) -> list[Path]:
    from ltca.export.point_tables import table_paths

    if kind == "csv":
        flanks, circles = table_paths(part, out)
        return [*flanks, circles]
    return [out / f"{part.stem}.{kind}"]


def _write(part: Part, arguments: argparse.Namespace, out: Path) -> None:
    """Write the files of one part and print their content."""
    kind, paths = arguments.format, _paths(part, arguments.format, out)
    for remark in (*part.remarks[2:], *part.leads):
        print(f"  {part.name}: {remark}", flush=True)
    if kind == "dxf":
        from ltca.export.drawing import write_drawing

        write_drawing(part, paths[0])
    elif kind == "step":
        from fem.export.solids import write_solids
        from ltca.output.progress import steps

        with steps(f"{part.name} as STEP") as note:
            write_solids(part, paths[0], note)
    elif kind == "csv":
        from ltca.export.point_tables import write_tables

        write_tables(part, out)
    else:
        from fem.export.facets import DEFAULT_CHORD, write_facets

        chord = DEFAULT_CHORD if arguments.chord is None else arguments.chord
        count = write_facets(part, paths[0], chord)
        print(f"  {count:,} triangles within {chord:g} mm of the exact surfaces")
        if part.walls:
            print(f"  {len(part.walls)} slots bound no body of the drive: they are in DXF, STEP and CSV, not in STL")
    for path in paths:
        print(f"  written: {path}")
