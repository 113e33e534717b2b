"""``cyclo fem --bodies solid`` without ``--pair``: a whole disc of solid bodies at one crank angle."""

from __future__ import annotations

import argparse

from fem.commands.position_arguments import chosen_case
from fem.solid.layer_count import FEWEST_LAYERS, MOST_LAYERS
from ltca.reading.arguments import count_argument, default_folder


def add_disc_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of a disc of solid bodies."""
    group = parser.add_argument_group("a whole disc of solid bodies (--bodies solid)")
    group.add_argument(
        "--layers",
        metavar="N",
        type=count_argument("--layers", FEWEST_LAYERS, MOST_LAYERS),
        help="layers of elements over half of the width, thinner towards the ends; default 4 (--size is 3 by default)",
    )


def execute_disc(arguments: argparse.Namespace) -> int:
    """Solve one disc of solid bodies; write ``fem.nc``, ``summary.json`` and a page.

    Returns
    -------
    int
        0.

    Raises
    ------
    CycloError
        For wrong input, no convergence, or bodies that would not fit into memory.
    """
    from fem.solid_drive.solid_files import FILES, page_of_solid, tabulate_solid, write_solid
    from fem.solid_drive.solved_disc import DEFAULT_LAYERS, DEFAULT_SIZE, SolidOptions, solve_solid_disc
    from ltca.output.progress import steps
    from ltca.output.run_folder import claimed_folder
    from ltca.page.study_page import PAGE, write_study_page

    file, case, drive = chosen_case(arguments)
    out = arguments.out or default_folder(file.name, "fem")
    options = SolidOptions(size=arguments.size or DEFAULT_SIZE, layers=arguments.layers or DEFAULT_LAYERS)
    writes = [*FILES, *([] if arguments.no_page else [PAGE])]
    with claimed_folder(out, "fem", writes=writes):
        with steps() as show:
            solution = solve_solid_disc(drive, arguments.angle, options, torque=arguments.torque, progress=show)
            show("files")
            write_solid(solution, case, out)
        load = drive.load_words(arguments.torque)
        print(f"{file.name} {case}, {load}, full finite elements, solid bodies, φ_C = {arguments.angle:g} rad")
        for line in tabulate_solid(solution):
            print(line)
        print(f"{solution.state.iterations} pose iterations, {solution.seconds['total']:.1f} s")
        if not arguments.no_page:
            told = f"case {case}, {load}, full finite elements, solid bodies"
            write_study_page(page_of_solid(solution, case, told, file.text), out)
        print(f"written to {out}")
    return 0
