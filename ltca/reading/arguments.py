"""Arguments that commands share: the same names, metavars, units, bounds and default folders in all of them.

Quantities are numbers or texts with a unit (``"20 deg"``), with the messages of a drive file. The module is light: commands
import it at the top.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ltca.errors import DriveError, Problem, shortened
from ltca.output.file_names import file_word

if TYPE_CHECKING:
    from ltca.drive.members.limits import Limits
    from ltca.drive.parts import Drive

SHIPPED_DRIVES = ("paper", "robot-joint", "rv", "sleeved")
"""Names of the drives that ship with the package, each that of a file in ``ltca/drives``."""
DRIVE = f"drive file (TOML), or the name of a shipped drive: {', '.join(SHIPPED_DRIVES)}"
ALIKE = "must be the same in all drives that are analysed together"
"""What is said of a field that all drives of an analysis share."""
LONGEST_PART = 255
"""Largest number of bytes in the name of a file or folder on common file systems."""
LONGEST_COUNT = 19
"""Largest number of digits of a whole number; longer ones are out of every range."""


class DifferentValues(argparse.Action):
    """Action of a repeatable option, which refuses a value that is given twice."""

    def __call__(
        self, parser: argparse.ArgumentParser, namespace: argparse.Namespace, values: Any, option_string: Any = None
    ) -> None:
        """Add a value; DriveError when it is given already."""
        before = getattr(namespace, self.dest) or []
        if values in before:
            raise DriveError([f"{option_string} {shortened(str(values))[1:-1]}: is given twice"])
        setattr(namespace, self.dest, [*before, values])


def compliance_for(drives: Iterable[Drive], *, method: str | None, contacts: str | None) -> str:
    """Return how the bodies of drives yield where nobody says so: half-spaces where an option belongs to them alone, else as
    the drives' files say; DriveError when these differ.
    """
    if method is not None or contacts is not None:
        return "half-space"
    known = tuple(drives)
    found = list(dict.fromkeys(drive.analysis.compliance for drive in known))
    if len(found) > 1:
        raise DriveError([Problem.of("analysis.compliance", f"= {', '.join(found)}", ALIKE)])
    if found[0] == "half-space" and any(drive.analysis.bodies != "plane" for drive in known):
        said = "has no effect with analysis.compliance = 'half-space'; leave one of them out"
        raise DriveError([Problem.of("analysis.bodies", "= 'solid'", said)])
    return found[0]


def bodies_for(drives: Iterable[Drive], compliance: str) -> str | None:
    """Return what bodies influence coefficients are of where nobody says so: as the drives' files say, None where half-spaces
    have none; DriveError when these differ.
    """
    found = list(dict.fromkeys(drive.analysis.bodies for drive in drives))
    if compliance == "half-space":
        return None
    if len(found) > 1:
        raise DriveError([Problem.of("analysis.bodies", f"= {', '.join(found)}", ALIKE)])
    return found[0]


def refuse_idle_options(
    compliance: str,
    *,
    method: str | None,
    contacts: str | None,
    coefficients: object,
    hole_near_field: bool | None,
    bodies: str | None = None,
) -> None:
    """Refuse options that have no effect together, all of them in one DriveError; before the engines are imported, which
    check more.

    Options that are not given are None.
    """
    if compliance == "half-space":
        found = {"coefficients": coefficients, "hole_near_field": hole_near_field, "bodies": bodies}
        idle = [
            f"{name}: has no effect with compliance {compliance}; leave it out"
            for name in found
            if found[name] is not None
        ]
        own = "grids" if method == "direct" else "tables"
        if method in (None, "tables", "direct") and contacts in {"tables", "grids"} - {own}:
            idle.append(
                f"contacts = {contacts}: method {method or 'tables'} runs on {own}; only method paper runs on either"
            )
    else:
        given = {"method": None if method == "tables" else method, "contacts": contacts}
        idle = [
            f"{name} = {value}: runs on half-space compliance only, not on {compliance}"
            for name, value in given.items()
            if value is not None
        ]
    if idle:
        raise DriveError(idle)


def add_drive_argument(parser: argparse.ArgumentParser, what: str = DRIVE, *, optional: bool = False) -> None:
    """Add the drive file."""
    parser.add_argument("drive", metavar="DRIVE", nargs="?" if optional else None, help=what)


def add_case_argument(parser: argparse.ArgumentParser, what: str, *, several: bool = True) -> None:
    """Add the case, or cases."""
    parser.add_argument("--case", metavar="NAME", action=DifferentValues if several else "store", help=what)


def add_out_argument(parser: argparse.ArgumentParser, command: str, what: str = "folder for the results") -> None:
    """Add the output folder of a command."""
    shown = shown_folder("<drive>" if command != "sweep" else "<study>", command)
    parser.add_argument("--out", metavar="DIR", type=path_argument("--out"), help=f"{what}; default {shown}")


def add_page_argument(parser: argparse.ArgumentParser) -> None:
    """Add the option that writes no page."""
    parser.add_argument("--no-page", action="store_true", help="write no report.html")


FIGURE_KINDS = ("svg", "png", "pdf")
"""File types of figures."""


def add_figures_argument(parser: argparse.ArgumentParser) -> None:
    """Add the options for figures and for no figures, which is the default."""
    which = parser.add_mutually_exclusive_group()
    which.add_argument(
        "--figures",
        nargs="?",
        const=FIGURE_KINDS[0],
        choices=FIGURE_KINDS,
        help=f"write figures for print into figures/, as {FIGURE_KINDS[0]} unless another kind is named",
    )
    which.add_argument("--no-figures", action="store_true", help="write no figures, the default")


def default_folder(name: str, command: str) -> Path:
    """Return the default output folder of a command: ``out/<name>`` for ``run``, ``out/<name>_<command>`` for others.

    The name is that of the drive or of the study file.

    Examples
    --------
    >>> default_folder("paper", "curves").as_posix()
    'out/paper_curves'
    """
    return Path("out") / file_word(shown_folder(name, command).name)


def shown_folder(name: str, command: str) -> Path:
    """Return the default output folder of a command as a help shows it, for a name that no file need have."""
    return Path("out") / (name if command == "run" else f"{name}_{command}")


def add_angle_argument(parser: argparse.ArgumentParser) -> None:
    """Add the one crank angle of a command."""
    parser.add_argument(
        "--angle",
        metavar="φ",
        type=quantity_argument("--angle", "rad"),
        default=0.0,
        help="crank angle in rad (or a text such as '20 deg'); default 0",
    )


def add_size_argument(parser: argparse.ArgumentParser, what: str) -> None:
    """Add the element edge as a multiple of the default."""
    parser.add_argument(
        "--size",
        metavar="S",
        type=quantity_argument("--size", "dimensionless", gt=0.0, le=1e3),
        default=1.0,
        help=f"{what}; default 1, 0.5 halves it",
    )


def quantity_argument(
    option: str, unit: str, *, gt: float | None = None, ge: float | None = None, le: float | None = None
) -> Callable[[str], float]:
    """Return the ``type=`` of an option with a quantity in a unit (`ltca.drive.units.quantities.quantity`); it raises
    DriveError.

    Bounds (greater than, at least, at most) are in that unit.
    """

    def read(text: str) -> float:
        from ltca.drive.units.quantities import parse_quantity

        return parse_quantity(text, unit, option, gt=gt, ge=ge, le=le)

    return read


def torque_argument(text: str, name: str = "--torque") -> float:
    """Return the output torque of ``--torque``, or of an argument `name` of a function, N·mm; DriveError for anything else.

    Examples
    --------
    >>> torque_argument("400 N·m")
    400000.0
    """
    from ltca.drive.units.quantities import parse_quantity

    try:
        return parse_quantity(text, "N*mm", name, ge=0.0)
    except DriveError as error:
        (problem,) = error.problems
        hint = " (load.direction turns it)" if problem.endswith("must be at least 0 N·mm") else ""
        raise DriveError([f"{problem}{hint}"]) from error


def path_argument(option: str) -> Callable[[str], Path]:
    """Return the ``type=`` of an option with the name of a file or folder to be written; it raises DriveError.

    Examples
    --------
    >>> path_argument("--out")("out/paper").as_posix()
    'out/paper'
    """

    def read(text: str) -> Path:
        from ltca.drive.names import is_seen

        told = f"{option} = {shortened(text)}"
        if not text.strip():
            raise DriveError([f"{told}: is empty; '.' is the folder we are in"])
        if not is_seen(text):
            raise DriveError([f"{told}: must not have control or invisible characters"])
        try:
            os.fsencode(text)
        except UnicodeEncodeError as error:
            more = f"cannot be a name of a file in the encoding {error.encoding}: LC_ALL=C.UTF-8 helps"
            raise DriveError([f"{told}: {more}"]) from error
        if max(len(os.fsencode(part)) for part in Path(text).parts or (".",)) > LONGEST_PART:
            raise DriveError([f"{told}: no name in it can have more than {LONGEST_PART} bytes"])
        return Path(text)

    return read


def count_argument(option: str, least: int, most: int) -> Callable[[str], int]:
    """Return the ``type=`` of an option with a whole number from `least` to `most`; it raises DriveError.

    Examples
    --------
    >>> count_argument("--positions", 1, 1_000_000)("360")
    360
    """

    def read(text: str) -> int:
        digits = text.removeprefix("-").removeprefix("+")
        if not (digits.isascii() and digits.isdigit()):
            raise DriveError([f"{option} = {shortened(text)}: must be a whole number from {least} to {most}"])
        number = int(text) if len(digits) <= LONGEST_COUNT else -1
        if len(digits) > LONGEST_COUNT or not least <= number <= most:
            raise DriveError([f"{option} = {shortened(text)[1:-1]}: must be from {least} to {most}"])
        return number

    return read


def refuse_impossible_torques(
    drives: Iterable[Drive], torque: float | None = None, *, duty: bool = True, in_parts: bool = False
) -> None:
    """Refuse (`DriveError`) an output torque, N·mm, or those of the drives, that presses wheel pins beyond what is answered.

    With `duty` those of the entries of a duty are refused as well: of commands that solve them. A check answers `in_parts`, at
    the part of a torque that is carried. It comes before `tell_unit_mistakes`: a question about a value that is refused for the
    same reason is none.
    """
    from ltca.drive.unit_mistakes import impossible_torque

    if told := next(
        filter(None, (impossible_torque(drive, torque, duty=duty, in_parts=in_parts) for drive in drives)), ""
    ):
        raise DriveError([told])


def tell_unit_mistakes(drives: Iterable[Drive], torque: float | None = None, limits: Iterable[Limits] = ()) -> None:
    """Print warnings to stderr about values of drives, as written, that were probably meant in another unit, each once.

    `torque` is the output torque of the command, N·mm; that of the drives for None. `limits` are those of each drive, where they
    are judged.
    """
    from ltca.drive.unit_mistakes import limit_warnings, unit_warnings

    each = [*drives]
    told = [warning for drive in each for warning in unit_warnings(drive, torque)]
    told += [
        warning for drive, own in zip(each, limits, strict=False) for warning in limit_warnings(drive, own.values())
    ]
    for text in dict.fromkeys(told):
        print(f"warning: {text}", file=sys.stderr)
