"""Arguments that say how bodies yield, the same for every command that takes them."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from ltca.errors import DamagedFileError
from ltca.reading.arguments import DifferentValues, refuse_idle_options

if TYPE_CHECKING:
    from ltca.analysis.engines import Engine
    from ltca.drive.parts import Drive


def add_compliance_arguments(parser: argparse.ArgumentParser) -> None:
    """Add how bodies yield."""
    parser.add_argument(
        "--compliance",
        choices=("half-space", "fe", "hybrid"),
        default="half-space",
        help="how bodies yield: half-spaces (default), plane-strain finite elements, or finite elements beyond "
        "half-spaces of finite length",
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
        "--no-hole-near-field",
        action="store_true",
        help="leave out the local yielding of the hole walls (fe and hybrid)",
    )


def check_compliance(arguments: argparse.Namespace) -> None:
    """Check the arguments as far as that goes before the engines are imported, which takes a second."""
    refuse_idle_options(
        arguments.compliance,
        method=getattr(arguments, "method", None),
        contacts=getattr(arguments, "contacts", None),
        coefficients=arguments.coefficients,
        hole_near_field=False if arguments.no_hole_near_field else None,
    )
    for path in arguments.coefficients or ():
        if not path.is_file():
            raise DamagedFileError(f"--coefficients {path}: no such file")


def compliance_of(arguments: argparse.Namespace) -> Engine:
    """Return the engine that the arguments ask for, method and contacts among them where a command has these."""
    from ltca.analysis.engines import engine_named

    return engine_named(
        arguments.compliance,
        method=getattr(arguments, "method", None),
        contacts=getattr(arguments, "contacts", None),
        coefficients=tuple(arguments.coefficients) if arguments.coefficients else None,
        hole_near_field=False if arguments.no_hole_near_field else None,
    )


def find_coefficients_of(cases: dict[str, Drive], arguments: argparse.Namespace) -> None:
    """Check the files given against all cases, or derive all that is missing together: the engine finds each again."""
    from ltca.compliance.coefficient_files import find_case_coefficients
    from ltca.compliance.near_field import NEAR_FIELDS
    from ltca.drive.members.temperatures import warm_drive

    if arguments.compliance in NEAR_FIELDS:
        warm = {name: warm_drive(drive) for name, drive in cases.items()}  # coefficients are those of the warm bodies
        find_case_coefficients(warm, arguments.coefficients or (), near_field=NEAR_FIELDS[arguments.compliance])
