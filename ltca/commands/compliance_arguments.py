"""Arguments that say how bodies yield, the same for every command that takes them."""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ltca.errors import DamagedFileError, DriveError
from ltca.reading.arguments import (
    DifferentValues,
    bodies_for,
    compliance_for,
    default_folder,
    refuse_idle_options,
    refuse_impossible_torques,
    tell_unit_mistakes,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from ltca.analysis.engines import Engine
    from ltca.drive.parts import Drive
    from ltca.reading.drive_file import DriveFile


def add_compliance_arguments(parser: argparse.ArgumentParser) -> None:
    """Add how bodies yield."""
    parser.add_argument(
        "--compliance",
        choices=("half-space", "fe", "hybrid"),
        help="how bodies yield: half-spaces, plane-strain finite elements, or (hybrid) half-spaces of finite length on finite "
        "elements; default [analysis] compliance of the drive file, hybrid where it has none",
    )
    parser.add_argument(
        "--quick",
        action="store_true",
        help="half-spaces, which need no influence coefficients, with a line that says how far they are off on the nearest "
        "shipped drive",
    )
    parser.add_argument(
        "--coefficients",
        metavar="FILE",
        type=Path,
        action=DifferentValues,
        help="influence coefficients of cyclo derive, repeatable: each drive takes the file of its shape; without any they "
        "are derived once for each shape and kept",
    )
    parser.add_argument(
        "--bodies",
        choices=("plane", "solid"),
        help="what bodies fe and hybrid stand on: plane sections, which yield evenly along the width, or solids with their ends; "
        "default [analysis] bodies of the drive file, plane where it has none",
    )
    parser.add_argument(
        "--no-hole-near-field",
        action="store_true",
        help="leave out the local yielding of the hole walls (fe and hybrid)",
    )


def check_compliance(arguments: argparse.Namespace) -> None:
    """Check the arguments as far as that goes before drives are read and engines imported, which takes a second."""
    if arguments.quick and arguments.compliance not in (None, "half-space"):
        raise DriveError([f"--quick: is half-spaces, not --compliance {arguments.compliance}; leave one of them out"])
    if arguments.quick and (arguments.coefficients or arguments.no_hole_near_field or arguments.bodies):
        option = "--no-hole-near-field" if arguments.no_hole_near_field else "--bodies"
        option = "--coefficients" if arguments.coefficients else option
        raise DriveError([f"{option}: has no effect with --quick, which is half-spaces; leave one of them out"])
    compliance = "half-space" if arguments.quick else arguments.compliance
    given = _options(arguments)
    arguments.half_spaces_asked = compliance == "half-space" or bool(given["method"] or given["contacts"])
    if compliance is not None:
        refuse_idle_options(compliance, **given)


def settle_compliance(arguments: argparse.Namespace, drives: Iterable[Drive]) -> str:
    """Return how the bodies of the drives yield, by the arguments or else as their file says, and keep it in the arguments."""
    drives, given = tuple(drives), _options(arguments)
    named = "half-space" if arguments.quick else arguments.compliance
    arguments.compliance = named or compliance_for(drives, method=given["method"], contacts=given["contacts"])
    refuse_idle_options(arguments.compliance, **given)
    arguments.bodies = arguments.bodies or bodies_for(drives, arguments.compliance)
    for path in arguments.coefficients or ():
        if not path.is_file():
            raise DamagedFileError(f"--coefficients {path}: no such file")
    return str(arguments.compliance)


def compliance_of(arguments: argparse.Namespace, drives: Iterable[Drive]) -> Engine:
    """Return the engine that the arguments ask for, or else the drives; with method and contacts where a command has these."""
    from ltca.analysis.engines import HalfSpace, engine_named

    compliance, given = settle_compliance(arguments, drives), _options(arguments)
    files = None if given["coefficients"] is None else tuple(arguments.coefficients)
    engine = engine_named(compliance, **{**given, "coefficients": files})
    return replace(engine, asked=arguments.half_spaces_asked) if isinstance(engine, HalfSpace) else engine


@dataclass(frozen=True, slots=True, kw_only=True)
class OpenedDrives:
    """Drive file of a command over some of its cases, before anything is solved.

    Attributes
    ----------
    file : DriveFile
        The file.
    cases : dict of str to Drive
        Those asked for, warm.
    engine : Engine
        Whose cases lend each other coefficients.
    out : Path
        Folder of the results.
    """

    file: DriveFile
    cases: dict[str, Drive]
    engine: Engine
    out: Path

    def figure_endings(self) -> list[str]:
        """Endings of the names of figures, as patterns: of several cases their names."""
        from glob import escape

        from ltca.output.file_names import file_words

        return [f"_{escape(word)}" for word in file_words(self.cases).values()] if len(self.cases) > 1 else [""]


def open_drives(arguments: argparse.Namespace, command: str) -> OpenedDrives:
    """Read the drive file of a command that takes ``--case`` repeatedly, settle how bodies yield and where results go.

    Parameters
    ----------
    arguments : argparse.Namespace
        Of the command.
    command : str
        Its name, after which the folder is called.
    """
    from ltca.output.run_folder import require_folder
    from ltca.reading.drive_file import load_drive

    check_compliance(arguments)
    file = load_drive(arguments.drive)
    cases = file.select_warm(arguments.case)
    settle_compliance(arguments, cases.values())
    refuse_impossible_torques(file.cases[name] for name in cases)
    tell_unit_mistakes(file.cases[name] for name in cases)
    out = arguments.out or default_folder(file.name, command)
    require_folder(out)
    from ltca.analysis.engines import lending_between

    engine = lending_between(file.cases.values(), compliance_of(arguments, cases.values()))
    return OpenedDrives(file=file, cases=cases, engine=engine, out=out)


def _options(arguments: argparse.Namespace) -> dict[str, Any]:
    """Options of single engines; None where they are not given."""
    return {
        "method": getattr(arguments, "method", None),
        "contacts": getattr(arguments, "contacts", None),
        "coefficients": arguments.coefficients or None,
        "hole_near_field": False if arguments.no_hole_near_field else None,
        "bodies": arguments.bodies,
    }


def find_coefficients_of(
    cases: Mapping[str, Drive], engine: Engine, arguments: argparse.Namespace, *, warn: bool = True
) -> None:
    """Check the files given against all cases, or derive all that is missing together: the engine finds each again.

    Of an engine that lends coefficients those of the lenders are derived. Files less accurate than asked for are told to stderr,
    unless `warn` is false: by commands that print the warnings of their analyses.
    """
    from ltca.analysis.engines import CoupledEngine
    from ltca.compliance.coefficient_files import coefficient_warnings, find_case_coefficients
    from ltca.compliance.near_field import NEAR_FIELDS
    from ltca.drive.members.temperatures import warm_drive
    from ltca.drive.single_discs import single_discs

    if arguments.compliance in NEAR_FIELDS:
        warm = {name: warm_drive(drive) for name, drive in cases.items()}  # coefficients are those of the warm bodies
        if isinstance(engine, CoupledEngine) and engine.lenders:
            found = [body for one in warm.values() for body in engine.bodies_of(single_discs(one))]
            bodies = {body.shape_fingerprint(engine.bodies): body for body in found}.values()
            cases_of = [body.case for body in bodies]
            warm = {
                body.case if cases_of.count(body.case) == 1 else f"{body.case}, body {number}": body
                for number, body in enumerate(bodies)
            }
        files = arguments.coefficients or ()
        coefficients = find_case_coefficients(warm, files, engine=arguments.compliance, bodies=engine.bodies)
        for text in coefficient_warnings(coefficients.values()) if warn else ():
            print(f"warning: {text}", file=sys.stderr)
