"""``cyclo derive``: influence coefficients of the bodies of a drive by finite elements, as a file."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from ltca.errors import CycloError

if TYPE_CHECKING:
    import xarray as xr

    from ltca.drive.parts import Drive
    from ltca.reading.coefficient_laws import Check

SUMMARY: str = "derive the bodies' influence coefficients by finite elements, or check a file of them"
# Options that say how to derive, and their defaults.
DERIVING = {"stations": 1.0, "size": 1.0, "plane": "strain", "without_clearance": False, "out": "coefficients.nc"}


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("drive", nargs="?", help="drive file (TOML), or 'paper' for the drive that ships with cyclo")
    parser.add_argument("--case", metavar="NAME", help="case of the drive file; its first one by default")
    parser.add_argument(
        "--stations",
        type=float,
        default=1.0,
        metavar="N",
        help="number of stations as a multiple of the default (32 for each lobe, 48 on the bore, 24 on each hole)",
    )
    parser.add_argument(
        "--size", type=float, default=1.0, metavar="S", help="element edge as a multiple of the default; 0.5 halves it"
    )
    parser.add_argument(
        "--plane", choices=("strain", "stress"), default="strain", help="plane strain (default) or plane stress"
    )
    parser.add_argument(
        "--without-clearance",
        action="store_true",
        help="leave the clearances of the case out, so that one file serves all clearance cases about alike (up to 2 %% of "
        "the pressures); it says so, and so does a run with it",
    )
    parser.add_argument("--out", metavar="FILE", default="coefficients.nc", help="file (default: coefficients.nc)")
    parser.add_argument(
        "--check",
        metavar="FILE",
        help="derive nothing; check this file, whichever code made it: its schema (docs/coefficients.md), then reciprocity, "
        "positive work, rigid motions, near field and closed forms; with DRIVE also that it belongs to the bodies of that "
        "drive in --case. What a file of another code leaves out (wider patches, resultants, how it was derived) is said "
        "not to be in it. Exit status: 0 all laws held, 1 one is broken, 2 unreadable or of another schema or drive",
    )


def execute(arguments: argparse.Namespace) -> int:
    """Derive, write the file whole or not at all, and check it.

    Returns
    -------
    int
        0, or 1 when a check of the file fails.

    Raises
    ------
    CycloError
        For wrong input, missing libraries or a mesh that would not fit into memory.
    """
    if arguments.check is not None:
        return _check_file(arguments)
    if arguments.drive is None:
        raise CycloError("derive: give a drive file, or a file of coefficients with --check")
    from ltca.output.run_folder import claimed_file
    from ltca.reading.drive_file import load_drive

    out = Path(arguments.out)
    file = load_drive(arguments.drive)
    case, drive = next(iter(file.select([arguments.case] if arguments.case else None).items()))
    with claimed_file(out, "derive"):
        return _derive(case, drive, arguments, out)


def _derive(case: str, drive: Drive, arguments: argparse.Namespace, out: Path) -> int:
    import time

    from fem.coefficients.dataset import derive_coefficients
    from ltca.output.progress import steps
    from ltca.reading.coefficient_file import read_coefficients, write_coefficients
    from ltca.reading.coefficient_laws import check_coefficients

    start = time.perf_counter()
    with steps("deriving coefficients") as show:
        dataset = derive_coefficients(
            drive,
            case=case,
            stations=arguments.stations,
            size=arguments.size,
            state=arguments.plane,
            keep_clearance=not arguments.without_clearance,
            progress=show,
        )
    write_coefficients(dataset, out)
    written = read_coefficients(out, lawful=False)
    checks = check_coefficients(written)
    attributes = written.attrs
    print(
        f"{written.sizes['station']} stations, {attributes['unknowns_disc']:,} unknowns of the disc, plane "
        f"{attributes['plane']}, {time.perf_counter() - start:.1f} s"
    )
    left_out = ", those of the case left out" if attributes["clearances_left_out"] else ""
    print(
        f"clearances: bearing {attributes['bearing_clearance']:g} mm, pin hole {attributes['pin_hole_clearance']:g} mm"
        f"{left_out}"
    )
    _print_checks(written, checks)
    print(f"written to {out}")
    return 0 if all(check.passed for check in checks) else 1


def _check_file(arguments: argparse.Namespace) -> int:
    """Check a file that is there; return 0 when all laws held, 1 when one is broken."""
    for option, default in DERIVING.items():
        if getattr(arguments, option) != default:
            raise CycloError(f"--{option.replace('_', '-')}: has no meaning with --check, which derives nothing")
    from fem.coefficients.fit import check_against_drive
    from ltca.reading.coefficient_file import read_coefficients
    from ltca.reading.coefficient_laws import check_coefficients
    from ltca.reading.drive_file import load_drive

    dataset = read_coefficients(Path(arguments.check), lawful=False)
    checks = check_coefficients(dataset)
    if arguments.drive is not None:
        file = load_drive(arguments.drive)
        _, drive = next(iter(file.select([arguments.case] if arguments.case else None).items()))
        checks += check_against_drive(dataset, drive, arguments.check)
    print(f"{arguments.check}: {dataset.sizes['station']} stations, plane {dataset.attrs['plane']}")
    _print_checks(dataset, checks)
    return 0 if all(check.passed for check in checks) else 1


def _print_checks(dataset: xr.Dataset, checks: tuple[Check, ...]) -> None:
    """Print each law with its value, limit and verdict; then those that the file says nothing about."""
    from ltca.reading.coefficient_laws import unstated_laws

    unstated = unstated_laws(dataset)
    width = max(len(name) for name in [*(check.name for check in checks), *unstated])
    for check in checks:
        print(f"{check.name:<{width}}  {check.value:>10.4g}  {check.bounds:<16}  {'ok' if check.passed else 'FAILED'}")
    for name, lacking in unstated.items():
        print(f"{name:<{width}}  {'':>10}  {'':<16}  not checked: the file has no {lacking}")
