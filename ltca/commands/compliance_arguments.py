"""Arguments that say how bodies yield, the same for every command that takes them."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ltca.analysis.engines import Engine


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
        help="influence coefficients of cyclo derive; without it they are derived once for each shape and kept",
    )
    parser.add_argument(
        "--no-hole-near-field",
        action="store_true",
        help="leave out the local yielding of the hole walls (fe and hybrid)",
    )


def compliance_of(arguments: argparse.Namespace) -> Engine:
    """Return the engine that the arguments ask for.

    Raises
    ------
    DriveError
        When an option does not belong to the compliance.
    """
    from ltca.analysis.engines import engine_named

    return engine_named(
        arguments.compliance,
        coefficients=arguments.coefficients,
        hole_near_field=False if arguments.no_hole_near_field else None,
    )
