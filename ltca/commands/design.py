"""``cyclo design``: from requirements to drive files, or to the relaxations that would make a design feasible."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ltca.commands.study_arguments import add_worker_arguments, check_worker_arguments
from ltca.errors import FaultError
from ltca.reading.arguments import add_out_argument, count_argument, default_folder, path_argument

if TYPE_CHECKING:
    from ltca.drive.parts import Compliance
    from ltca.studies.design_search.refinement import Refined
    from ltca.studies.design_search.requirements import Requirements
    from ltca.studies.design_search.search import Found

SUMMARY = (
    "find drives for requirements: ratio, torque, room, life, backlash; or say which requirement stands in the way"
)
EXAMPLES = (
    ("cyclo design requirements.toml", "the best three drives as files, or what stands in the way"),
    ("cyclo design requirements.toml --best 1 --workers 2", "one drive, on two cores"),
)
BEST = 3
NOTHING_FITS = 1


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument(
        "requirements", metavar="REQUIREMENTS", type=path_argument("REQUIREMENTS"),
        help="requirement file (TOML): docs/how-to/design.md, examples/requirements",
    )  # fmt: skip
    parser.add_argument(
        "--best",
        metavar="N",
        type=count_argument("--best", 1, 20),
        default=BEST,
        help=f"designs to write; default {BEST}",
    )
    parser.add_argument(
        "--quick",
        action="store_true",
        help="designs on half-spaces as candidates are, not on hybrid, whose coefficients take some 5 s (20 pins) to 15 s (100 "
        "pins) on a free core for each drive that is tried",
    )
    add_worker_arguments(parser)
    add_out_argument(parser, "design")


def execute(arguments: argparse.Namespace) -> int:
    """Search, write and print what was found; exit status 1 when nothing fits."""
    from concurrent.futures.process import BrokenProcessPool

    from ltca.output.run_folder import claimed_folder, require_folder
    from ltca.studies.design_search.requirement_file import load_requirements

    check_worker_arguments(arguments)
    requirements = load_requirements(arguments.requirements)
    out = arguments.out or default_folder(requirements.asked.name, "design")
    require_folder(out)
    from ltca.output.processes import Terminated
    from ltca.output.progress import steps
    from ltca.studies.design_search.requirement_words import requirement_warnings
    from ltca.studies.design_search.search import find_designs
    from ltca.studies.execution.workers import Workers

    for text in requirement_warnings(requirements):
        print(f"warning: {text}", file=sys.stderr)
    writes = [
        "design.json",
        "designs.csv",
        "report.html",
        "design-[0-9]*.toml",
        "relaxed-*.toml",
        "candidate-[0-9]*.toml",
    ]
    with claimed_folder(out, "design", writes=writes) as folder:
        found_so_far = _FoundSoFar(requirements, out)
        compliance: Compliance = "half-space" if arguments.quick else "hybrid"
        workers = Workers(processes=arguments.workers, scheduler=arguments.scheduler)
        try:
            with steps("design") as told, workers.executor() as (executor, _):
                found = find_designs(
                    requirements, executor, told, arguments.best, compliance=compliance, kept=found_so_far.keep
                )
        except (KeyboardInterrupt, Terminated):
            if found_so_far.files:
                names = ", ".join(path.name for path in found_so_far.files)
                print(
                    f"design: the search is not finished; what it has found is kept in {out}: {names}", file=sys.stderr
                )
            raise
        except BrokenProcessPool as error:
            raise FaultError("workers died (killed, or out of memory); start the search again") from error
        folder.discard(*found_so_far.files)
        _write(found, arguments.best, out)
    return 0 if found.designs else NOTHING_FITS


class _FoundSoFar:
    """What an unfinished search leaves in its folder: candidates that fit on half-spaces, and designs, as drive files.

    Results of an earlier search go when this one begins.
    """

    def __init__(self, requirements: Requirements, out: Path) -> None:
        from ltca.studies.design_search.demands import find_demands
        from ltca.studies.design_search.search import Found

        self.files: list[Path] = []
        self._out = out
        self._found = Found(
            requirements=requirements, demands=find_demands(requirements), designs=(), tried=(), relaxations=(),
            combinations=0, solved=0,
        )  # fmt: skip
        _write_json(self._found, out, {"verdict": "search not finished"})

    def keep(self, refined: Refined) -> None:
        """Write a candidate, or a design where its fine solution has passed, under the next free number."""
        from ltca.output.files import whole_file
        from ltca.studies.design_search.designs import design_text

        kind = "design" if refined.solution.checks else "candidate"
        stem = f"{kind}-{1 + sum(path.name.startswith(kind) for path in self.files)}"
        path = self._out / f"{stem}.toml"
        with whole_file(path) as part:
            name = f"{self._found.requirements.asked.name}-{stem}"
            part.write_text(design_text(refined, self._found, name), encoding="utf-8", newline="\n")
        self.files.append(path)


def _write_json(found: Found, out: Path, results: dict[str, Any]) -> None:
    from ltca.output.files import write_json
    from ltca.output.provenance import code_hash, code_version
    from ltca.studies.design_search.requirement_words import requirement_warnings

    head = {"name": found.requirements.asked.name, "version": code_version(), "code_hash": code_hash("ltca")}
    tail = {
        "assumed_materials": found.requirements.assumed_materials,
        "warnings": requirement_warnings(found.requirements),
        "requirements": found.requirements.text,
    }
    write_json(out / "design.json", head | results | tail)


def _write(found: Found, best: int, out: Path) -> None:
    from ltca.output.files import whole_file
    from ltca.page.studies.designs import write_design_page
    from ltca.studies.design_search.designs import (
        comparison,
        csv_text,
        design_content,
        design_text,
        relaxation_content,
    )
    from ltca.studies.design_search.sizes import LEAST_DISTANCE

    asked = found.requirements.asked
    shown: list[tuple[str, Refined]] = []
    contents: list[dict[str, Any]] = []

    def written(stem: str, refined: Refined) -> str:
        with whole_file(out / f"{stem}.toml") as part:
            part.write_text(design_text(refined, found, f"{asked.name}-{stem}"), encoding="utf-8", newline="\n")
        shown.append((stem, refined))
        contents.append(design_content(refined, found, f"{stem}.toml"))
        return f"{stem}.toml"

    for number, refined in enumerate(found.designs[:best], 1):
        written(f"design-{number}", refined)
    relaxations = []
    for one in found.relaxations:
        stem = f"relaxed-{one.name}".replace(".", "-")
        file = None if one.refined is None else written(stem, one.refined)
        relaxations.append(relaxation_content(one, file))
    rows = comparison(found, shown)
    with whole_file(out / "designs.csv") as part:
        part.write_text(csv_text(rows), encoding="utf-8", newline="\n")
    tried = [{"broken": one.broken, "message": one.solution.message} for one in found.tried]
    _write_json(
        found,
        out,
        {
            "verdict": "fits" if found.designs else "nothing fits",
            "combinations": found.combinations,
            "solved": found.solved,
            "least_distance": LEAST_DISTANCE,
            "designs": [content for content in contents if content["file"].startswith("design-")],
            "in_the_way": relaxations,
            "relaxed_designs": [content for content in contents if content["file"].startswith("relaxed-")],
            "tried": tried,
        },
    )
    write_design_page(found, shown, rows, out / "report.html")
    _print(found, rows, out)


def _print(found: Found, rows: list[list[str]], out: Path) -> None:
    from ltca.studies.design_search.designs import refused_words
    from ltca.studies.design_search.requirement_words import assumed_words, requirement_warnings

    asked = found.requirements.asked
    print(
        f"{asked.name}, 1:{asked.ratio:g}, {asked.torque / 1000.0:g} N·m and {asked.speed:g} rpm at the output: "
        f"{found.combinations} combinations by closed forms, {found.solved} loaded drives"
    )
    if assumed := assumed_words(found.requirements):
        print(assumed)
    if refused := refused_words(found):
        print(refused)
    if not found.designs:
        print(
            "nothing fits. What stands in the way, least change first, each with all others held, and at most so much "
            "(a longer search may find less):"
        )
        for one in found.relaxations:
            print(f"  {one.words}")
        if not found.relaxations:
            print("  no requirement that could give")
        for text in requirement_warnings(found.requirements):
            print(f"look first at: {text}")
    wide = max((len(row[0]) for row in rows), default=0)
    columns = [max(len(row[column]) for row in rows) for column in range(1, len(rows[0]))]
    if len(rows[0]) > 2:
        for row in rows:
            cells = "  ".join(f"{cell:>{width}}" for cell, width in zip(row[1:], columns, strict=True))
            print(f"{row[0]:<{wide}}  {cells}")
    sys.stdout.flush()
    files = "report.html, design.json, designs.csv"
    print(f"results: {out} ({files}{', drive files' if len(rows[0]) > 2 else ''})")
