"""``cyclo fem --bodies solid --pair``: one pair of solid bodies cut out of a drive."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fem.commands.position_arguments import chosen_case
from ltca.errors import DriveError
from ltca.reading.arguments import count_argument, default_folder, quantity_argument

if TYPE_CHECKING:
    from fem.solid_contact.solved_pair import PairLoad, SolvedPair

OPTIONS = ("pair", "contact", "load", "approach", "tilt", "block")
"""Options that belong to a pair alone."""


def add_pair_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of solid bodies."""
    parser.add_argument(
        "--bodies",
        choices=("plane", "solid"),
        default="plane",
        help="plane bodies (default), or solid ones with free ends: a whole disc, or one pair with --pair",
    )
    group = parser.add_argument_group("one pair of solid bodies (--bodies solid)")
    group.add_argument(
        "--pair",
        choices=("flank", "bore", "race", "hole"),
        help="wheel pin on the flank, roller in the bore, roller on the inner race, shaft pin in its hole",
    )
    group.add_argument(
        "--contact",
        metavar="N",
        type=count_argument("--contact", 0, 9999),
        help="number of the pin, roller or hole; default the one with the largest load of rigid bodies on springs",
    )
    group.add_argument(
        "--load",
        metavar="F",
        type=quantity_argument("--load", "N", gt=0.0),
        help="load of the pair in N; default that of rigid bodies on springs, which grades plane meshes as well",
    )
    group.add_argument(
        "--approach",
        metavar="δ",
        type=quantity_argument("--approach", "mm"),
        help="approach at mid-width in mm (or a text such as '5 µm') in the place of a load",
    )
    group.add_argument(
        "--tilt",
        metavar="θ",
        type=quantity_argument("--tilt", "rad", ge=-0.01, le=0.01),
        help="tilt of the body opposite in rad, at most 0.01; positive presses the upper end; default 0",
    )
    group.add_argument(
        "--block",
        metavar="D",
        type=quantity_argument("--block", "mm", gt=0.0),
        help="depth and half the width of the blocks in mm; default the radius of the pin or roller",
    )


def refuse_mixed_options(arguments: argparse.Namespace) -> None:
    """Refuse options of plane and solid bodies that have no effect together; DriveError names all of them."""
    given = [name for name in OPTIONS if getattr(arguments, name) is not None]
    if arguments.bodies == "plane":
        problems = [f"--{name}: has no effect with plane bodies; add --bodies solid" for name in given]
        if arguments.layers is not None:
            problems.append("--layers: has no effect with plane bodies; add --bodies solid")
    else:
        alone = arguments.pair is None
        idle = {
            "--plane": arguments.plane is not None,
            "--fine-walls": arguments.fine_walls,
            "--pictures": arguments.pictures,
            "--export": arguments.export is not None,
            "--referee": alone and arguments.referee is not None,
            "--layers": not alone and arguments.layers is not None,
            "--error": arguments.error,
            "--meshes": arguments.meshes is not None,
        }
        what = "--bodies solid" if alone else "--pair"
        problems = [f"{name}: has no effect with {what}; leave it out" for name, there in idle.items() if there]
        if alone:
            problems += [f"--{name}: belongs to one pair; add --pair flank, bore, race or hole" for name in given]
        if arguments.load is not None and arguments.approach is not None:
            problems.append("--approach: must be left out where --load is given")
        if arguments.torque is not None and (arguments.load is not None or arguments.approach is not None):
            problems.append("--torque: has no effect where the load or the approach of the pair is given; leave it out")
    if problems:
        raise DriveError(problems)


def execute_pair(arguments: argparse.Namespace) -> int:
    """Solve one pair; write ``pair.nc`` and ``summary.json``, with a referee its deck and answer.

    Returns
    -------
    int
        0, or 1 when the referee's answer is beyond a bound.

    Raises
    ------
    CycloError
        For wrong input, no convergence, or blocks that would not fit into memory.
    """
    from fem.solid_contact.pair_files import FILES, tabulate_pair, write_pair
    from fem.solid_contact.pair_shapes import SolidPair
    from fem.solid_contact.solved_pair import PairMeshes, solve_pair
    from ltca.output.progress import steps
    from ltca.output.run_folder import claimed_folder

    program = None
    if arguments.referee:
        from fem.referee.calculix_deck import find_calculix

        program = find_calculix()
    file, case, drive = chosen_case(arguments)
    out = arguments.out or default_folder(file.name, "fem")
    pair = SolidPair.of_drive(drive, arguments.pair, arguments.angle, arguments.contact, torque=arguments.torque)
    load, words = _load(arguments, pair.expected_load, pair.name)
    if program and pair.opposite_material is None:
        raise DriveError(
            [
                f"--referee calculix: has no effect on a rigid {pair.opposite}, of which CalculiX gets no elements; "
                "leave it out or set pin_shaft.elastic_contact = true"
            ]
        )
    block = pair.radius if arguments.block is None else arguments.block
    writes = [*FILES, *(["calculix.inp", "calculix.dat"] if program else [])]
    with claimed_folder(out, "fem", writes=writes):
        with steps() as show:
            solved = solve_pair(pair, load, PairMeshes(size=arguments.size, block=block), show)
        _warn_of_coarse_mesh(solved, arguments.size)
        print(f"{file.name} {case}, {pair.name}, solid bodies, φ_C = {arguments.angle:g} rad, {words}")
        for line in tabulate_pair(solved):
            print(line)
        more, passed = _ask(solved, out, program)
        write_pair(
            solved, out, more | {"case": case, "crank_angle_rad": arguments.angle, "fingerprint": drive.fingerprint()}
        )
        print(f"written to {out}")
    return 0 if passed else 1


def _warn_of_coarse_mesh(solved: SolvedPair, size: float) -> None:
    """Tell of a mesh that has few elements for the half-width found."""
    from fem.solid_contact.solved_pair import ELEMENTS_PER_HALF_WIDTH, FEWEST_ELEMENTS

    found = solved.elements_per_half_width
    if 0.0 < found < FEWEST_ELEMENTS:
        print(
            f"warning: --size {size:g}: {found:.2g} elements for the half-width of {solved.pair.name}, fewer than "
            f"{FEWEST_ELEMENTS}: load and pressures may be off by per cents; give --size "
            f"{ELEMENTS_PER_HALF_WIDTH / FEWEST_ELEMENTS:g} or less (1 has {ELEMENTS_PER_HALF_WIDTH})",
            file=sys.stderr,
        )


def _load(arguments: argparse.Namespace, expected: float, name: str) -> tuple[PairLoad, str]:
    """By what the pair is pressed, and how that is told."""
    from fem.solid_contact.solved_pair import PairLoad

    tilt = arguments.tilt or 0.0
    if arguments.approach is not None:
        return PairLoad(approach=arguments.approach, tilt=tilt), f"approach {1e3 * arguments.approach:g} µm"
    if arguments.load is not None:
        return PairLoad(load=arguments.load, tilt=tilt), f"load {arguments.load:g} N"
    if not expected > 0.0:
        raise DriveError([f"--load: must be given, because rigid bodies on springs leave {name} open"])
    return PairLoad(load=expected, tilt=tilt), f"load {expected:.5g} N of rigid bodies on springs"


def _ask(solved: SolvedPair, out: Path, program: str | None) -> tuple[dict[str, Any], bool]:
    """Let the other code solve the pair where asked for; return its answer for the summary, and whether all rows passed."""
    if program is None:
        return {}, True
    from fem.referee.calculix_pair import ask_about_pair, referee_rows, tabulate_referee

    answer = ask_about_pair(solved, out / "calculix.inp", program)
    for line in tabulate_referee(solved, answer):
        print(line)
    passed = all(row.passed for row in referee_rows(solved, answer))
    found = {
        "load_N": answer.load,
        "largest_face_mean_MPa": answer.largest,
        "own_largest_face_mean_MPa": answer.own_largest,
        "face_mean_deviation": answer.deviation,
        "passed": passed,
        "seconds": answer.seconds,
    }
    return {"calculix": found}, passed
