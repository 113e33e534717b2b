"""``cyclo fem``: the full finite-element contact solution of a drive at one crank angle."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from fem.commands.position_arguments import add_position_arguments, body_files, chosen_case, disc_prefix
from fem.commands.solid_pair import add_pair_arguments, execute_pair, refuse_mixed_options
from fem.solid.layer_count import FEWEST_LAYERS, MOST_LAYERS
from ltca.errors import CycloError
from ltca.reading.arguments import (
    add_out_argument,
    add_page_argument,
    count_argument,
    default_folder,
    torque_argument,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from fem.drive.full_solution import FullSolution
    from fem.options import SolutionOptions
    from fem.reducer.nested_meshes import NestedSolution
    from fem.reducer.solution import ReducerSolution
    from ltca.drive.members.judgement import Check
    from ltca.drive.members.limits import Limits
    from ltca.drive.parts import Drive
    from ltca.page.study_page import Picture

SUMMARY: str = "solve the whole drive by finite elements at one crank angle"
EXAMPLES = (
    ("cyclo fem paper --case CS-1 --angle 0.5", "one position by finite elements alone"),
    ("cyclo fem paper --case CS-1 --angle 0.5 --pictures", "with pictures of stress and deformation"),
    ("cyclo fem paper --case CS-1 --angle 0.5 --error", "on three nested meshes: every figure with its error bar"),
    ("cyclo fem paper --case CS-1 --angle 0.5 --referee calculix", "solved by CalculiX as well"),
    ("cyclo fem paper --case CS-1 --angle 0.5 --bodies solid --pair flank", "one pair of solid bodies with free ends"),
    ("cyclo fem examples/drives/plastic.toml --angle 0.3 --bodies solid", "a whole disc of solid bodies"),
)


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_position_arguments(parser)
    parser.add_argument(
        "--torque",
        metavar="T",
        type=torque_argument,
        help="output torque in N·mm (or a text such as '377.3 N m'); default that of the drive",
    )
    parser.add_argument("--plane", choices=("strain", "stress"), help="plane strain (default) or plane stress")
    parser.add_argument(
        "--fine-walls",
        action="store_true",
        help="mesh the disc's walls for the stress along them: within 1 %% of the largest instead of 3.4 %%",
    )
    parser.add_argument(
        "--error",
        action="store_true",
        help="solve on nested meshes, the coarsest with edges of twice --size, each next one with edges half as long: "
        "observed order and error bar (grid convergence index) of every figure, results of the finest",
    )
    parser.add_argument(
        "--meshes",
        metavar="N",
        type=count_argument("--meshes", 3, 5),
        help="nested meshes of --error, 3 (default) to 5",
    )
    add_out_argument(parser, "fem")
    drawn = parser.add_mutually_exclusive_group()
    drawn.add_argument(
        "--pictures",
        "--figures",
        action="store_true",
        help="draw von_mises.png, contacts.png and deformed.png, which takes as long as the solution",
    )
    drawn.add_argument("--no-pictures", "--no-figures", action="store_true", help="no pictures of stress, the default")
    add_page_argument(parser)
    parser.add_argument(
        "--export", choices=("calculix",), help="write a complete input deck of the same problem for another code"
    )
    parser.add_argument(
        "--referee", choices=("calculix",), help="let another code solve the same problem and print both side by side"
    )
    add_pair_arguments(parser)
    group = parser.add_argument_group("all discs as solid bodies (--bodies solid)")
    group.add_argument(
        "--layers",
        metavar="N",
        type=count_argument("--layers", FEWEST_LAYERS, MOST_LAYERS),
        help="layers of elements over half of the width, thinner towards the ends; default 4 (--size is 3 by default)",
    )
    # Solid discs have another default.
    parser.set_defaults(size=None)


def execute(arguments: argparse.Namespace) -> int:
    """Solve the drive; write ``fem.nc``, ``summary.json``, ``.vtu`` of each body and, where asked for, pictures of each disc.

    Returns
    -------
    int
        0.

    Raises
    ------
    CycloError
        For wrong input, no convergence, or meshes that would not fit into memory.
    """
    from ltca.output.run_folder import claimed_folder

    refuse_mixed_options(arguments)
    if arguments.pair is not None:
        arguments.size = arguments.size or 1.0
        return execute_pair(arguments)
    _require_options(arguments)
    referee = _referee(arguments.referee)
    file, case, drive = chosen_case(arguments)
    options = _options(arguments)
    bodies = "solid bodies" if options.layers else f"plane {options.plane}"
    name = file.name
    out = arguments.out or default_folder(name, "fem")
    if arguments.export or referee:
        _require_deck(drive, "--referee" if referee else "--export")
    discs = drive.disc.number_of_discs
    writes = ["fem.nc", "summary.json", *([] if options.layers else ["fem.vtm", *body_files("vtu", discs)])]
    writes += [] if arguments.no_page else ["report.html"]
    own = ["von_mises.png", "contacts.png", "deformed.png"] if arguments.pictures else []
    own += ["calculix.inp"] if arguments.export or referee else []
    own += ["calculix.dat"] if referee else []
    writes += [f"{disc_prefix(disc, discs)}{file}" for disc in range(discs) for file in own]
    with claimed_folder(out, "fem", writes=writes):
        solution, checks, pictures, nested = _solve_and_write(
            name, case, drive, file.limits[case], arguments, options, out, referee
        )
        if not arguments.no_page:
            from fem.pictures.drive_loads import draw_loads
            from fem.reducer.solution_page import solution_page
            from ltca.page.study_page import write_study_page

            words = f"case {case}, {drive.load_words(arguments.torque)}, full finite elements, {bodies}"
            page = solution_page(solution, checks, case, words, file.text, draw_loads(solution), pictures, nested)
            write_study_page(page, out)
    return 0


def _require_options(arguments: argparse.Namespace) -> None:
    """Raise CycloError for options that do not go together."""
    if arguments.meshes is not None and not arguments.error:
        raise CycloError(f"--meshes {arguments.meshes}: has no meaning without --error, which solves on nested meshes")
    for option in ("export", "referee"):
        if arguments.error and (code := getattr(arguments, option)):
            raise CycloError(
                f"--{option} {code}: does not go with --error, whose finest meshes are not those of one solution; "
                f"run --{option} by itself"
            )


def _solve_and_write(
    name: str,
    case: str,
    drive: Drive,
    limits: Limits,
    arguments: argparse.Namespace,
    options: SolutionOptions,
    out: Path,
    referee: Callable[[FullSolution, Path], None] | None,
) -> tuple[ReducerSolution, list[Check], list[Sequence[Picture]], NestedSolution | None]:
    from fem.drive.fields import recover_fields
    from fem.reducer.solution_files import write_solution
    from fem.reducer.solution_words import tabulate
    from ltca.drive.members.verdict_words import verdict_table
    from ltca.output.progress import steps

    title = f"{name}, {case}, {arguments.angle:g} rad"
    with steps() as show:
        solution, nested = _solve(drive, arguments, options, show)
        show("files")
        fields = [] if solution.solid else [recover_fields(disc) for disc in solution.discs]
        checks = write_solution(solution, fields, case, out, limits, nested)
    load, bodies = drive.load_words(arguments.torque), "solid bodies" if solution.solid else f"plane {options.plane}"
    print(f"{name} {case}, {load}, full finite elements, {bodies}: 1 position, φ_C = {arguments.angle:g} rad")
    if told := ring_words(drive):
        print(told)
    count, problem = len(solution.discs), ""
    pictures: list[Sequence[Picture]] = []
    if arguments.pictures:
        from fem.pictures.solution_pictures import draw_solution

        for number, disc in enumerate(solution.discs):
            headline = title if count == 1 else f"{title}, disc {number}"
            problem, drawn = draw_solution(disc, fields[number], headline, out, prefix=disc_prefix(number, count))
            pictures.append(drawn)
    print(*tabulate(solution), sep="\n")
    if nested is not None:
        from fem.reducer.error_table import error_lines

        print(*error_lines(nested), sep="\n")
    if not solution.solid:
        print("verdict by full finite elements at this position")
        print(verdict_table([check for check in checks if check.limit is not None]))
    if problem:
        print(f"drawn with matplotlib, because pyvista cannot render here: {problem}")
    for number, disc in enumerate(solution.discs):
        deck = out / f"{disc_prefix(number, count)}calculix.inp"
        if arguments.export or referee:
            from fem.referee.calculix_deck import write_deck

            print(f"CalculiX deck: {write_deck(disc, deck)}")
        if referee:
            referee(disc, deck)
    print(f"written to {out}")
    return solution, checks, pictures, nested


def _options(arguments: argparse.Namespace) -> SolutionOptions:
    """Return the options of the solution, whose defaults are others for solid bodies."""
    from fem.options import SolutionOptions

    if arguments.bodies == "solid":
        from fem.solid_drive.solved_discs import DEFAULT_LAYERS, DEFAULT_SIZE

        return SolutionOptions(size=arguments.size or DEFAULT_SIZE, layers=arguments.layers or DEFAULT_LAYERS)
    return SolutionOptions(
        size=arguments.size or 1.0, plane=arguments.plane or "strain", fine_walls=arguments.fine_walls
    )


def _solve(
    drive: Drive, arguments: argparse.Namespace, options: SolutionOptions, show: Callable[[str], None]
) -> tuple[ReducerSolution, NestedSolution | None]:
    """Solve the drive, on nested meshes where error bars are asked for."""
    if not arguments.error:
        from fem.reducer.solution import solve_reducer

        return solve_reducer(drive, arguments.angle, options, torque=arguments.torque, progress=show), None
    from fem.reducer.nested_meshes import FEWEST_MESHES, solve_nested

    count = arguments.meshes or FEWEST_MESHES
    nested = solve_nested(drive, arguments.angle, options, torque=arguments.torque, meshes=count, progress=show)
    return nested.solution, nested


def ring_words(drive: Drive) -> str:
    """Return what is told of a ring that an analysis has as a beam; empty where there is none."""
    if drive.ring is None or drive.ring.model == "fe":
        return ""
    return 'the ring is a plane mesh with the seats of the wheel pins here; analyses have it as a beam (ring.model = "beam")'


def _require_deck(drive: Drive, option: str) -> None:
    """Refuse what the deck for CalculiX does not hold: a ring, pins that bend, cranks and a wheel that yield."""
    from ltca.errors import DriveError

    shaft = drive.pin_shaft
    given = {
        "ring": drive.ring,
        "pin_wheel.beam": drive.pin_wheel.beam,
        "pin_shaft.beam": None if shaft is None else shaft.beam,
        "pin_wheel.support_stiffness": drive.pin_wheel.support_stiffness,
        "pin_wheel.axis_offset": drive.pin_wheel.axis_offset if drive.pin_wheel.axis_offset.place else None,
        "main_bearing": drive.main_bearing,
        "crank.support": drive.crank.support,
        "carrier.posts": drive.posts,
    }
    said = f"must be left out for {option} calculix, whose deck has a rigid wheel, rigid cranks and pins on springs"
    if found := [f"{path}: {said}" for path, value in given.items() if value is not None]:
        raise DriveError(found)


def _referee(name: str | None) -> Callable[[FullSolution, Path], None] | None:
    """Return a function that runs and prints the referee; CycloError before any work when it is not installed."""
    if name is None:
        return None
    from fem.referee.calculix import compare_with_calculix
    from fem.referee.calculix_deck import find_calculix

    program = find_calculix()

    def run(solution: FullSolution, deck: Path) -> None:
        for line in compare_with_calculix(solution, deck, program):
            print(line)

    return run
