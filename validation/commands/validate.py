"""``cyclo validate``: comparison of each simplification with the full solution, as a report with limits."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from ltca.errors import CycloError
from ltca.reading.arguments import (
    DRIVE,
    add_case_argument,
    add_drive_argument,
    add_out_argument,
    add_size_argument,
    default_folder,
    quantity_argument,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from validation.study import Plan, Study

SUMMARY = "compare the codes with closed forms, other codes, the paper and full finite elements; write a report"
EXAMPLES = (
    ("cyclo validate paper --case CS-1", "a page of comparisons, with limits and reasons"),
    ("cyclo validate my.toml --level full --out out/validation", "more angles, halved meshes"),
    ("cyclo validate --manual", "the verification manual: a page for each case, with reference, error bar and verdict"),
    ("cyclo validate --manual nafems_1 cycloidal_studio", "two pages of it"),
)
MANUAL_FOLDER = Path("out") / "manual"
"""Default folder of the manual."""
KEPT = "kept"
"""Folder beside the results of what later runs, or the rest of an interrupted one, need not compute again."""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_drive_argument(parser, f"{DRIVE}; none with --manual", optional=True)
    add_case_argument(parser, "case, repeatable; default the first, middle and last of the file")
    parser.add_argument(
        "--angles",
        metavar="φ",
        nargs="+",
        type=quantity_argument("--angles", "rad"),
        help="crank angles of full solutions in rad (or texts such as '20 deg'); default two (quick) or twelve (full) "
        "over one period of the flank",
    )
    parser.add_argument(
        "--level",
        choices=("quick", "full"),
        help="how many angles; full also halves meshes and finds error bars of the full solutions; default quick",
    )
    add_size_argument(parser, "element edges of the full solutions as a multiple of the default (limits are for 1)")
    # Nothing, quick and 1 are told from values that are given: none has a meaning with --manual.
    parser.set_defaults(size=None)
    parser.add_argument(
        "--manual",
        nargs="*",
        metavar="CASE",
        help="write the verification manual instead, a page for each case and an index: all cases, or these. It needs "
        "no DRIVE and "
        f"takes no other option than --out (default {MANUAL_FOLDER}); each page is written when it is made, and the same command "
        "goes on where it was interrupted; exit status 1 when a verdict is FAILED",
    )
    add_out_argument(parser, "validate", "folder of report and kept solutions")


def execute(arguments: argparse.Namespace) -> int:
    """Run the validation; write ``report.html``, ``validation.json`` and ``rows.csv``, or the pages of the manual.

    Returns
    -------
    int
        0, or 1 when a row fails its limit or a case of the manual its bound.

    Raises
    ------
    CycloError
        For wrong input or when something does not converge.
    """
    if arguments.manual is not None:
        return _write_manual(arguments)
    if arguments.drive is None:
        raise CycloError("validate: give a drive file, or --manual")
    from ltca.output.run_folder import claimed_folder, require_folder
    from ltca.reading.drive_file import load_drive

    # Before finite elements are imported: wrong input is reported at once.
    file = load_drive(arguments.drive)
    file.select(arguments.case)
    out: Path = arguments.out or default_folder(file.name, "validate")
    require_folder(out)
    from fem.errors import MemoryLimitError
    from fem.options import SolutionOptions
    from fem.reducer.solution import require_solution_memory
    from validation.study import plan_study

    angles, size = list(arguments.angles or []), 1.0 if arguments.size is None else arguments.size
    plan = plan_study(file, arguments.case, angles, arguments.level or "quick", SolutionOptions(size=size))
    try:
        for drive in plan.drives.values():
            require_solution_memory(drive, plan.crank_angles[0], plan.options)
    except MemoryLimitError as error:
        raise CycloError(f"--size {size:g}: {error}") from error
    with claimed_folder(out, "validate", writes=("report.html", "validation.json", "rows.csv"), beside=(KEPT,)):
        return _run_and_write(plan, out)


def _write_manual(arguments: argparse.Namespace) -> int:
    """Compute the cases of the manual and write their pages; 1 when one of them fails."""
    import time

    from ltca.errors import DriveError
    from ltca.output.progress import steps
    from ltca.output.run_folder import claimed_folder, require_folder

    given = {"DRIVE": arguments.drive} | {
        f"--{name}": getattr(arguments, name) for name in ("case", "angles", "level", "size")
    }
    idle = [f"{name}: has no meaning with --manual; leave it out" for name, value in given.items() if value is not None]
    if idle:
        raise DriveError(idle)
    out: Path = arguments.out or MANUAL_FOLDER
    require_folder(out)
    from ltca.output.threads import on_one_thread
    from validation.manual.kept import KeptOutcomes
    from validation.manual.page import file_names, printed_difference, verdict_word, write_index, write_page
    from validation.manual.register import chosen_cases

    cases = chosen_cases(arguments.manual)
    kept = KeptOutcomes(folder=out / KEPT)
    with claimed_folder(out, "validate", writes=file_names(cases), beside=(KEPT,)):
        outcomes, times = [], []
        with steps() as show:
            for number, case in enumerate(cases, start=1):
                show(f"[{number}/{len(cases)}] {case.title}")
                began = time.perf_counter()
                outcome, was_kept = on_one_thread(kept.get)(case)
                times.append(f"{'kept':>8}" if was_kept else f"{time.perf_counter() - began:>6.1f} s")
                outcomes.append(outcome)
                # An interruption leaves the pages of what is finished.
                write_page(outcome, out)
                write_index(outcomes, out, left=len(cases) - number)
        kept.forget(cases)
    for outcome, spent in zip(outcomes, times, strict=True):
        print(f"{verdict_word(outcome)}  {outcome.case.name:<22}{len(outcome.figures):>4} figures {spent}")
        for figure in outcome.failed:
            print(
                f"        {figure.quantity}: {figure.value:.6g} {figure.unit}, difference {printed_difference(figure)}"
            )
    failed = sum(not outcome.passed for outcome in outcomes)
    print(f"{len(outcomes)} cases, {failed} failed")
    print(f"written: {len(file_names(cases))} pages in {out}, first {out / 'index.md'}")
    return 1 if failed else 0


def _run_and_write(plan: Plan, out: Path) -> int:
    from ltca.output.progress import steps
    from ltca.output.threads import on_one_thread
    from validation.report.headline import write_files
    from validation.report.page import write_report
    from validation.rows import failed_rows
    from validation.study import run_validation

    with steps() as show:
        progress = _Progress(plan, show)
        study = on_one_thread(run_validation)(plan, out / KEPT, progress.step, progress.say)
        progress.step("report")
        paths = [write_report(study, out / "report.html"), *write_files(study, out)]
    failed = failed_rows(study.rows)
    for row in failed:
        place = ", ".join(part for part in (row.case, _angle(row.crank_angle), row.contact, row.model) if part)
        print(
            f"FAILED  level {row.level}: {row.quantity} ({place}): {row.value:.6g} {row.unit}, difference "
            f"{row.difference:.3g}{row.difference_unit} beyond {row.limit:g}"
        )
    _print_headline(study)
    print(f"{len(study.rows)} rows, {len(failed)} failed")
    print("written: " + ", ".join(str(path) for path in paths))
    return 1 if failed else 0


def _angle(angle: float | None) -> str:
    return "" if angle is None else f"{angle:.4g} rad"


def _print_headline(study: Study) -> None:
    from validation.report.headline import headline

    head = headline(study)
    plan = study.plan
    loads = ", ".join(f"{case} {drive.load_words()}" for case, drive in plan.drives.items())
    print(f"{plan.name}: {loads}; {len(plan.crank_angles)} positions of full FE")
    print(f"{'against full FE':<14}{'load':>12}{'pressure':>12}{'wheel angle':>14}")
    for model, worst in head["worst_difference_from_full_fe"].items():
        print(
            f"{model:<14}{100.0 * worst['load']['difference']:>+11.2f}%{100.0 * worst['pressure']['difference']:>+11.2f}%"
            f"{worst['wheel_angle']['difference_arcsec']:>+13.3f}″"
        )
    print(f"{'full FE against half-space':<28}{'pin':>9}{'roller':>9}{'pin shaft':>11}")
    for case, changes in head["change_half_space_to_full_fe"].items():
        pin, roller = (100.0 * changes[name] for name in ("pin_load", "roller_load"))
        shaft = f"{100.0 * changes['pin_shaft_load']:>+10.1f}%" if "pin_shaft_load" in changes else f"{'–':>11}"
        print(f"{case:<28}{pin:>+8.1f}%{roller:>+8.1f}%{shaft}")
    _print_costs(study)


def _print_costs(study: Study) -> None:
    """Costs stay out of the report: it shall not depend on the machine or on what was kept."""
    from validation.report.costs import measure_costs

    costs = measure_costs(study)
    cheaper = ", ".join(
        f"{model} {1e3 * value:.2f} ms ({costs.full / value:.0f} times cheaper)"
        for model, value in costs.models.items()
    )
    print(f"one position: full FE {costs.full:.1f} s; LTCA after derivation {cheaper}")


class _Progress:
    """Prints the number and title of a step and its details."""

    def __init__(self, plan: Plan, show: Callable[[str], None]) -> None:
        self.total, self.done, self.title, self.show = plan.steps, 0, "", show

    def step(self, title: str) -> None:
        self.done += 1
        self.title = f"[{self.done}/{self.total}] {title}"
        self.say("")

    def say(self, detail: str) -> None:
        self.show(f"{self.title}: {detail}" if detail else self.title)
