"""``cyclo derive``: influence coefficients of the bodies of a drive, or the flexibility of its ring, by finite elements."""

from __future__ import annotations

import argparse
from collections.abc import Iterable
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

from fem.commands.position_arguments import chosen_drive
from fem.solid.layer_count import FEWEST_LAYERS, MOST_LAYERS
from ltca.errors import CycloError
from ltca.reading.arguments import (
    add_case_argument,
    add_drive_argument,
    add_size_argument,
    count_argument,
    default_folder,
    path_argument,
    quantity_argument,
    shown_folder,
)

if TYPE_CHECKING:
    from ltca.drive.parts import Drive
    from ltca.output.labelled import Labelled
    from ltca.reading.coefficient_laws import Check

SUMMARY: str = (
    "derive the bodies' influence coefficients, or the ring's flexibility, by finite elements, or check a file of them"
)
EXAMPLES = (
    ("cyclo derive paper --case CS-1 --out coefficients.nc", "for cyclo run --compliance fe or hybrid"),
    ("cyclo derive drive.toml --part ring", 'the flexibility of the ring of the wheel pins, with ring.model = "fe"'),
    ("cyclo derive --check coefficients.nc paper", "any file of coefficients against schema and laws"),
)
# Options of a derivation, and their defaults.
DERIVING = {
    "part": "bodies",
    "bodies": None,
    "stations": 1.0,
    "size": 1.0,
    "layers": None,
    "plane": None,
    "without_clearance": False,
    "out": None,
}
OF_BODIES = {"bodies", "layers", "stations", "plane", "without_clearance"}
"""Options that a derivation of the ring has no use for."""
COEFFICIENTS = "coefficients.nc"
RING = "ring.nc"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_drive_argument(parser, optional=True)
    add_case_argument(parser, "case; default the first", several=False)
    parser.add_argument(
        "--part",
        choices=("bodies", "ring"),
        default="bodies",
        help="disc, wheel pin, roller and inner race (default), or the ring of [ring] with the seats of the wheel pins and its "
        "bolts, always in plane stress",
    )
    parser.add_argument(
        "--bodies",
        choices=("plane", "solid"),
        help="plane bodies (default), or solid ones with free ends, which also yield to loads linear along the width: minutes "
        "instead of seconds; time and memory are told before, and what is done is kept until all is",
    )
    parser.add_argument(
        "--layers",
        type=count_argument("--layers", FEWEST_LAYERS, MOST_LAYERS),
        metavar="N",
        help="with --bodies solid: quadratic layers over half of the thickness; default 2",
    )
    parser.add_argument(
        "--stations",
        type=quantity_argument("--stations", "dimensionless", ge=0.25, le=8.0),  # as fem.coefficients.stations
        default=1.0,
        metavar="N",
        help="number of stations as a multiple of the default (16 for each lobe and at least 8, 48 on each bore, 24 on "
        "each hole); default 1",
    )
    add_size_argument(parser, "element edge as a multiple of the default")
    parser.add_argument(
        "--plane",
        choices=("strain", "stress"),
        help="plane strain (default) or plane stress; not with --bodies solid, which are in neither",
    )
    parser.add_argument(
        "--without-clearance",
        action="store_true",
        help="leave the clearances of the case out, so that one file serves all clearance cases about alike (up to 2 %% of "
        "the pressures); it says so, and so does a run with it",
    )
    parser.add_argument(
        "--out",
        metavar="FILE",
        type=path_argument("--out"),
        help=f"file for the coefficients; default {shown_folder('<drive>', 'derive') / COEFFICIENTS}, of a ring "
        f"{RING} there; discs cut otherwise "
        "get one each, its name ending in _disc_ and the number of the first of them",
    )
    parser.add_argument(
        "--check",
        metavar="FILE",
        help="derive nothing; check this file, whichever code made it: its schema (docs/theory/coefficients.md), then "
        "reciprocity, positive work, rigid motions, near field and closed forms; with DRIVE also that it belongs to the bodies "
        "of that drive in --case. What a file of another code leaves out (wider patches, resultants, how it was derived) is said "
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
    if arguments.part == "ring":
        return _derive_ring(arguments)
    arguments.bodies = arguments.bodies or "plane"
    if arguments.bodies == "solid" and arguments.plane is not None:
        raise CycloError(f"--plane {arguments.plane}: has no meaning with --bodies solid, which are in no plane state")
    if arguments.bodies == "plane" and arguments.layers is not None:
        raise CycloError(f"--layers {arguments.layers}: has no meaning with plane bodies; give --bodies solid with it")
    from ltca.output.locks import claimed_file
    from ltca.reading.coefficient_file import require_replaceable

    name, case, drive = chosen_drive(arguments)
    out: Path = arguments.out or default_folder(name, "derive") / COEFFICIENTS
    shapes = _distinct_discs(drive, keep_clearance=not arguments.without_clearance)
    files = [out if len(shapes) == 1 else out.with_stem(f"{out.stem}_disc_{discs[0]}") for _, discs in shapes]
    status = 0
    with ExitStack() as claims:
        for file in files:
            claims.enter_context(claimed_file(file, "derive"))
            require_replaceable(file)
        for (single, discs), file in zip(shapes, files, strict=True):
            if drive.disc.number_of_discs > 1:
                print(f"disc{'s' if len(discs) > 1 else ''} {', '.join(map(str, discs))}:")
            status = max(status, _derive(name, case, single, arguments, file))
    return status


def _distinct_discs(drive: Drive, *, keep_clearance: bool) -> list[tuple[Drive, list[int]]]:
    """Return the drives of one disc whose bodies differ, and the numbers of the discs that have the bodies of each."""
    from ltca.drive.single_discs import nominal_shape, single_discs

    shapes: dict[str, tuple[Drive, list[int]]] = {}
    for number, single in enumerate(single_discs(drive)):
        fingerprint = nominal_shape(single, keep_clearance=keep_clearance).shape_fingerprint()
        shapes.setdefault(fingerprint, (single, []))[1].append(number)
    return list(shapes.values())


def _derive(name: str, case: str, drive: Drive, arguments: argparse.Namespace, out: Path) -> int:
    import time

    from fem.coefficients.dataset import derive_coefficients
    from fem.coefficients.solid_dataset import LAYERS
    from ltca.output.progress import steps
    from ltca.output.resources import derivation_memory, tell_memory
    from ltca.reading.coefficient_file import read_coefficients, write_coefficients
    from ltca.reading.coefficient_laws import check_coefficients

    start = time.perf_counter()
    if arguments.bodies == "plane":  # of solid ones the derivation tells it
        tell_memory(derivation_memory(drive.disc.number_of_teeth, arguments.size), f"the disc of {name} {case}")
    with steps("deriving coefficients") as show:
        derive_coefficients(
            drive,
            case=case,
            stations=arguments.stations,
            size=arguments.size,
            state=arguments.plane or "strain",
            bodies=arguments.bodies,
            layers=arguments.layers or LAYERS,
            keep_clearance=not arguments.without_clearance,
            progress=show,
            store=lambda derived: write_coefficients(derived, out),
        )
    written = read_coefficients(out, lawful=False)
    checks = check_coefficients(written)
    attributes = written.attrs
    print(
        f"{name} {case}: {written.sizes['station']} stations, {attributes['unknowns_disc']:,} unknowns of the disc, "
        f"{_state_of(written)}, {time.perf_counter() - start:.1f} s"
    )
    left_out = ", those of the case left out" if attributes["clearances_left_out"] else ""
    print(
        f"clearances: bearing {attributes['bearing_clearance']:g} mm, pin hole {attributes['pin_hole_clearance']:g} mm"
        f"{left_out}"
    )
    _print_checks(written, checks)
    if "bracket" in attributes:
        least, share, most = (float(attributes[f"bracket{which}"]) for which in ("_lowest", "", "_highest"))
        print(
            f"between plane strain (0) and plane stress (1) the disc lies at {share:.3f} for contacts farther apart than it is "
            f"thick, from {least:.3f} to {most:.3f} for any loads in equilibrium"
        )
    print(f"written to {out}")
    return 0 if all(check.passed for check in checks) else 1


def _state_of(dataset: Labelled) -> str:
    """The state of the bodies of a file, and of solid ones their unknowns."""
    from ltca.reading.coefficient_schema import is_solid

    if not is_solid(dataset):
        return f"plane {dataset.attrs['plane']}"
    return f"solid{f' ({unknowns:,})' if (unknowns := dataset.attrs.get('unknowns_solid')) else ''}"


def _derive_ring(arguments: argparse.Namespace) -> int:
    """Derive the ring of a drive, write it whole or not at all, and check it."""
    for option in sorted(OF_BODIES):
        if getattr(arguments, option) != DERIVING[option]:
            raise CycloError(f"--{option.replace('_', '-')}: has no meaning with --part ring, a body by itself")
    import time

    from fem.coefficients.ring import derive_ring, require_replaceable_ring
    from ltca.output.locks import claimed_file
    from ltca.output.progress import steps
    from ltca.reading.ring_file import check_ring, read_ring, write_ring

    name, case, drive = chosen_drive(arguments)
    out: Path = arguments.out or default_folder(name, "derive") / RING
    start = time.perf_counter()
    with claimed_file(out, "derive"):
        require_replaceable_ring(out)
        with steps("deriving the ring") as show:
            dataset = derive_ring(drive, case=case, size=arguments.size, progress=show)
        write_ring(dataset, out)
    written = read_ring(out, lawful=False)
    checks = check_ring(written)
    print(
        f"{name} {case}: {drive.pin_wheel.number_of_pins} seats, {written.attrs['bolts']} bolts, {written.attrs['unknowns']:,} "
        f"unknowns of the ring, plane stress, {time.perf_counter() - start:.1f} s"
    )
    _print_verdicts(checks)
    print(f"written to {out}")
    return 0 if all(check.passed for check in checks) else 1


def _check_ring_file(arguments: argparse.Namespace, path: Path) -> int:
    from ltca.reading.ring_file import check_ring, read_ring, require_same_ring

    dataset = read_ring(path, lawful=False)
    if arguments.drive is not None:
        require_same_ring(dataset, chosen_drive(arguments)[2], arguments.check)
    checks = check_ring(dataset)
    print(f"{arguments.check}: ring, {dataset['flexibility'].values.shape[0]} seats and bolts")
    _print_verdicts(checks)
    return 0 if all(check.passed for check in checks) else 1


def _check_file(arguments: argparse.Namespace) -> int:
    """Check a file that is there; return 0 when all laws held, 1 when one is broken."""
    for option, default in DERIVING.items():
        if getattr(arguments, option) != default:
            raise CycloError(f"--{option.replace('_', '-')}: has no meaning with --check, which derives nothing")
    if not Path(arguments.check).is_file():
        raise CycloError(f"--check {arguments.check}: no such file")
    from ltca.output.netcdf import read_netcdf
    from ltca.reading.coefficient_file import read_coefficients
    from ltca.reading.coefficient_laws import check_coefficients
    from ltca.reading.ring_file import is_ring

    if is_ring(read_netcdf(Path(arguments.check), "a coefficient file")):
        return _check_ring_file(arguments, Path(arguments.check))
    dataset = read_coefficients(Path(arguments.check), lawful=False)
    checks = check_coefficients(dataset)
    if arguments.drive is not None:
        checks += _check_against_discs(dataset, chosen_drive(arguments)[2], arguments.check)
    print(f"{arguments.check}: {dataset.sizes['station']} stations, {_state_of(dataset)}")
    _print_checks(dataset, checks)
    return 0 if all(check.passed for check in checks) else 1


def _check_against_discs(dataset: Labelled, drive: Drive, source: str) -> tuple[Check, ...]:
    """Check a file against the disc of a drive that it belongs to; of several discs it must belong to one."""
    from fem.coefficients.fit import check_against_drive

    shapes = _distinct_discs(drive, keep_clearance=True)
    refusals = []
    for single, discs in shapes:
        try:
            found = check_against_drive(dataset, single, source)
        except CycloError as error:
            refusals.append(error)
            continue
        if len(shapes) > 1:
            print(f"{source}: belongs to disc {', '.join(map(str, discs))} of {drive.name}")
        return found
    raise refusals[0]


def _print_checks(dataset: Labelled, checks: tuple[Check, ...]) -> None:
    """Print the laws with value, limit and verdict, then those that the file has no data for."""
    from ltca.reading.coefficient_laws import unstated_laws

    unstated = unstated_laws(dataset)
    width = _print_verdicts(checks, unstated)
    for name, lacking in unstated.items():
        print(f"{name:<{width}}  {'':>10}  {'':<16}  not checked: the file has no {lacking}")


def _print_verdicts(checks: tuple[Check, ...], also: Iterable[str] = ()) -> int:
    """Print the laws with value, limit and verdict; return the width of their names and of others that follow."""
    width = max(len(name) for name in [*(check.name for check in checks), *also])
    for check in checks:
        print(f"{check.name:<{width}}  {check.value:>10.4g}  {check.bounds:<16}  {'ok' if check.passed else 'FAILED'}")
    return width
