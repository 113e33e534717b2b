"""Check that full finite elements and the commands use every leaf field of a drive or refuse it by name.

    python benchmarks/contract.py [full-fe curves tolerance sweep optimise run-fe run-hybrid]

The same check as in ``tests/contract``, but with complete commands: every field of a small drive is changed by a realistic
amount, and every command is run on it with coarse settings. Prints ignored fields; exit status 1 if there are any. Full finite
elements take some minutes; ``run-fe`` and ``run-hybrid`` derive the coefficients of every changed shape and take half an hour.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import argparse
import contextlib
import io
import json
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

sys.path[0] = str(Path(__file__).resolve().parents[1])  # the package fem, not the benchmark of that name

from fem.options import SolutionOptions
from fem.reducer.solution import solve_reducer
from ltca.analysis.loaded_analysis import analyse
from ltca.commands.program import main as cyclo
from ltca.drive.members.temperatures import warm_drive
from ltca.drive.parts import Drive
from ltca.errors import CycloError, DriveError
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive
from ltca.reading.writing import drive_text
from ltca.testing.field_changes import change_of, fault_of_field, leaf_fields

FILE = Path(__file__).resolve().parents[1] / "tests" / "contract" / "drive.toml"
TOLERANCES = """
[tolerances]
pin_shaft.pin_errors.radial = { distribution = "uniform", tolerance = 0.001 }
"""
STUDY = """
drive = "drive.toml"
positions = 4
quantities = ["all"]
[design]
kind = "grid"
[factors]
"materials.shaft_pin.poisson_ratio" = [0.28, 0.3]
"""


def numbers_of(content: Any) -> list[float]:
    """Return all numbers of nested lists and tables, in order."""
    if isinstance(content, dict):
        return [value for name, entry in content.items() if "seconds" not in name for value in numbers_of(entry)]
    if isinstance(content, list):
        return [value for entry in content for value in numbers_of(entry)]
    return [float(content)] if isinstance(content, int | float) and not isinstance(content, bool) else []


def program(words: list[str], answer: str, extra: str = "", study: bool = False) -> Callable[[Drive], np.ndarray]:
    """Return a function that runs a command on a drive in a temporary folder and returns the numbers of one JSON file."""

    def run(drive: Drive) -> np.ndarray:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder)
            (path / "drive.toml").write_text(drive_text(drive) + extra, encoding="utf-8")
            (path / "study.toml").write_text(STUDY, encoding="utf-8")
            source = path / ("study.toml" if study else "drive.toml")
            errors = io.StringIO()
            with contextlib.redirect_stderr(errors), contextlib.redirect_stdout(io.StringIO()):
                status = cyclo([words[0], str(source), *words[1:], "--out", str(path / "out"), "--no-figures"])
            partial = status == 1 and "partial:" in errors.getvalue()
            content = json.loads((path / "out" / answer).read_text(encoding="utf-8")) if partial or status == 0 else {}
            if status != 0 and not content.get("quantities"):  # a study with some solved samples is sufficient
                raise DriveError([errors.getvalue()])
            return np.array(numbers_of(content))

    return run


def full_solution(drive: Drive) -> np.ndarray:
    """Return results of full finite elements on a coarse mesh."""
    found = solve_reducer(warm_drive(drive), 0.5, SolutionOptions(size=4.0))
    numbers = [np.array([found.wheel_angle, found.transmission_error, *found.disc_torques])]
    for disc in found.discs:
        contacts, pose = disc.contacts, disc.pose
        numbers += [contacts.pin_load, contacts.roller_load, contacts.pin_shaft_load, contacts.pin_pressure_mid]
        numbers.append(np.array([pose.disc_x, pose.disc_y, pose.disc_rotation]))
    return np.concatenate(numbers)


def answer_or_error(
    answer: Callable[[Drive], np.ndarray], base: Drive, change: dict[str, Any]
) -> np.ndarray | CycloError:
    """Return the answer to a changed drive, or the error by which it is refused."""
    try:
        return answer(with_fields(base, change))
    except CycloError as error:
        return error


def is_accepted(base: Drive, change: dict[str, Any]) -> bool:
    """Return whether half-spaces take a changed drive, to tell a refusal of one engine from that of all."""
    found = answer_or_error(lambda drive: analyse(drive, np.array([0.5])).transmission_error, base, change)
    return not isinstance(found, CycloError)


def optimum(drive: Drive) -> np.ndarray:
    """Return all quantities that an optimisation computes for a candidate."""
    from ltca.studies.optimiser import Bound, Problem, batch_analysis, parse_variable
    from ltca.studies.quantities import quantities_for

    problem = Problem(
        drive=drive,
        variables=(parse_variable("disc.equidistant_offset", drive),),
        aims=("max_pin_load",),
        limits=tuple(
            Bound(quantity=name, sense=1, value=1e9)
            for name in quantities_for(drive, ("all",))
            if name != "max_pin_load"
        ),
    )
    return np.asarray(batch_analysis(problem, 4)([drive]))


COMMANDS: dict[str, tuple[str, Callable[[Drive], np.ndarray]]] = {
    "full-fe": ("full FE", full_solution),
    "curves": ("curves", program(["curves", "--turns", "5", "--quick"], "curves.json")),
    "tolerance": (
        "studies",
        program(
            ["tolerance", "--quick", "--samples", "2", "--positions", "4", "--quantities", "all"],
            "summary.json",
            TOLERANCES,
        ),
    ),
    "optimise": ("studies", optimum),
    "sweep": ("studies", program(["sweep", "--quick"], "summary.json", study=True)),
    "run-fe": ("fe", program(["run", "--positions", "2", "--compliance", "fe"], "summary.json")),
    "run-hybrid": ("hybrid", program(["run", "--positions", "2", "--compliance", "hybrid"], "summary.json")),
}


def main() -> int:
    """Run the check for the given commands."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "commands", nargs="*", metavar="COMMAND", help=f"one of {', '.join(COMMANDS)}; default: all except run-…"
    )
    parser.add_argument("--fields", type=int, default=0, help="number of fields, from the first; default: all")
    arguments = parser.parse_args()
    asked = arguments.commands or [name for name in COMMANDS if not name.startswith("run-")]
    unknown = set(asked) - set(COMMANDS)
    if unknown:
        parser.error(f"unknown: {', '.join(sorted(unknown))}; there are {', '.join(COMMANDS)}")
    paths = leaf_fields()[: arguments.fields or None]
    drive = load_drive(FILE).cases["nominal"]
    plain = with_fields(drive, {"crank_bearing.roller_length": drive.disc.thickness})
    bases = {
        "full-fe": with_fields(plain, {"pin_wheel.axis_offset.x": 0.0, "pin_wheel.axis_offset.y": 0.0}),
        "run-fe": plain,
    }
    status = 0
    for name in asked:
        kind, answer = COMMANDS[name]
        began, ignored, refused, known = time.perf_counter(), [], 0, {}
        for path in paths:
            base, change = change_of(bases.get(name, drive), path)
            after = answer_or_error(answer, base, change)
            if (key := repr(base)) not in known and not isinstance(after, CycloError):
                known[key] = answer_or_error(answer, base, {})
            refused += isinstance(after, CycloError)
            accepted = partial(is_accepted, base, change)
            fault = fault_of_field(path, kind, known.get(key, after), after, accepted=accepted, by_table=True)
            ignored += [fault] if fault else []
        seconds = time.perf_counter() - began
        print(f"{name}: {len(paths)} fields, {refused} refused by name, {len(ignored)} wrong ({seconds:.0f} s)")
        for line in ignored:
            print(f"  {line}")
        status |= bool(ignored)
    return status


if __name__ == "__main__":
    sys.exit(main())
