"""Level 2: comparison with other codes, run where they are installed, else with stored answers.

Our side is computed in every run. Only the other codes' answers are stored, in ``stored/other_codes.json``, each with the
fingerprint of the problem it belongs to (`validation.levels.other_code_problems`); an answer to another problem is refused.
``python -m validation.levels.other_codes`` writes the file anew where the codes are installed.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from fem.drive.contact_kinds import CONTACT_KINDS
from ltca.drive.units.quantities import ARCSEC
from ltca.errors import CycloError
from ltca.output.files import write_json
from ltca.output.processes import supervised
from ltca.output.provenance import code_hash
from ltca.output.regular_files import read_regular
from validation.compare.comparison import contact_name
from validation.levels.other_code_problems import CASE, CODES, CRANK_ANGLE, CROWNED_PAIRS, ROLLERS, Answer
from validation.rows import Row

COMMAND = "python -m validation.levels.other_codes"
STORED = "stored/other_codes.json"
LARGEST_KEPT = 10_000_000
"""Bytes of the kept answers."""
LIMITS = {
    "load": (5e-3, "of the largest load of its kind; same mesh in both codes, their contact is a penalty"),
    "wheel": (
        0.3,
        "seconds of arc, as of full FE: two elements for each half-width resolve the contacts, the penalty gives way by "
        "a quarter of it",
    ),
    "pressure": (3e-3, "the other code's uniform cells, 96 across: finer ones halve the difference (0.15 % at worst)"),
    "approach": (3e-3, "its uniform cells at the ends: 0.05 to 0.1 % measured"),
    "pair load": (3e-3, "asked of solid pairs on the same mesh: reduced integration and a penalty in the other code"),
    "pair pressure": (2e-2, "asked of solid pairs on the same mesh: means of the points of a face there"),
}


@contextmanager
def asked_codes(kept: Path | None = None) -> Iterator[Callable[[], list[Row]]]:
    """Run the installed codes in a separate process while the block runs.

    Yields a callable that computes our answers, waits for theirs and returns the rows of level 2; codes that are not
    installed answer as stored. Answers that belong to today's problems and code are kept in the file `kept` and not asked for
    again. The callable raises CycloError when an installed code fails, or a stored answer belongs to another problem.
    """
    known = {} if kept is None else read_kept(kept)
    asked = [name for name, code in CODES.items() if name not in known and code.installed()]
    with (
        tempfile.TemporaryDirectory(prefix="cyclo-validate-", ignore_cleanup_errors=True) as name,
        ExitStack() as stack,
    ):
        folder = Path(name)
        answers, trouble = folder / "answers.json", folder / "trouble.txt"
        process = None
        if asked:
            words = [sys.executable, "-m", "validation.levels.other_codes", "--out", str(answers), *asked]
            with trouble.open("wb") as stream:
                # One thread for the same digits always; its temporary files go with the folder.
                one_thread = {**os.environ, "OMP_NUM_THREADS": "1"}
                process = stack.enter_context(supervised(words, folder, stdout=stream, stderr=stream, env=one_thread))

        def collect() -> list[Row]:
            # Ours first: the other process works meanwhile.
            ours = {name: code.ours() for name, code in CODES.items()}
            found = dict(known)
            if process is not None:
                status = process.wait()
                if status != 0:
                    lines = trouble.read_text(encoding="utf-8", errors="replace").strip().splitlines()
                    raise CycloError(f"{' and '.join(asked)} failed: {lines[-1] if lines else status}")
                found |= fitting_answers(json.loads(answers.read_text(encoding="utf-8")))
            if kept is not None and process is not None:
                write_kept(kept, found)
            rows = []
            for name in CODES:
                fresh = name in found
                theirs = found[name] if fresh else stored_answer(name)
                rows += compare_answers(name, ours[name], theirs, name if fresh else f"{name} (stored, {COMMAND})")
            return rows

        yield collect


def fitting_answers(content: dict[str, Any]) -> dict[str, Answer]:
    """Return the answers, by code, whose problem is today's."""
    return {
        name: content[name]["answer"]
        for name, code in CODES.items()
        if name in content and content[name]["problem"] == code.fingerprint()
    }


def stored_answer(name: str) -> Answer:
    """Return the stored answer of a code; CycloError when it belongs to another problem than today's."""
    content = json.loads((resources.files("validation.levels") / STORED).read_text(encoding="utf-8"))
    found = fitting_answers(content)
    if name not in found:
        raise CycloError(
            f"{name} is not installed and its stored answer belongs to another problem: "
            f"{CODES[name].installation}, then {COMMAND}"
        )
    return found[name]


def read_kept(path: Path) -> dict[str, Answer]:
    """Return the answers, by code, that a file keeps for today's problems and today's code; none when it is damaged."""
    try:
        content: Any = json.loads(read_regular(path, LARGEST_KEPT))
        return fitting_answers(content["answers"]) if content["code"] == _code() else {}
    except (OSError, ValueError, KeyError, TypeError):
        return {}


def write_kept(path: Path, answers: dict[str, Answer]) -> None:
    """Keep answers with the fingerprints of their problems and of the code that posed them."""
    write_json(path, {"code": _code(), "answers": with_problems(answers)})


def _code() -> str:
    # ltca and fem write what the other codes are given; validation says what.
    return code_hash("ltca", "fem", "validation")


def with_problems(answers: dict[str, Answer]) -> dict[str, Any]:
    """Return answers, by code, as files hold them: each with the fingerprint of its problem."""
    return {name: {"problem": CODES[name].fingerprint(), "answer": answer} for name, answer in answers.items()}


def add_answers(path: Path, answers: dict[str, Answer]) -> None:
    """Write answers, by code, into a file; those of other codes that it holds stay, those of the same codes are replaced."""
    held = json.loads(read_regular(path, LARGEST_KEPT)) if path.exists() else {}
    write_json(path, held | with_problems(answers))


def compare_answers(name: str, ours: Answer, theirs: Answer, against: str) -> list[Row]:
    """Return the rows of one code of `CODES`; `against` is the label of the other code."""
    rows_of = {"CalculiX": _drive_rows, "tamaas": _roller_rows, "CalculiX C3D20R": _pair_rows}
    return rows_of[name](ours, theirs, against)


def _drive_rows(ours: Answer, theirs: Answer, against: str) -> list[Row]:
    place: dict[str, Any] = {
        "case": CASE, "crank_angle": CRANK_ANGLE, "model": "finite elements, coarse", "against": against,
    }  # fmt: skip
    rows = []
    for kind, names in CONTACT_KINDS.items():
        own, other = np.array(ours[names.load]), np.array(theirs[names.load])
        for part in np.flatnonzero((own > 0.0) | (other > 0.0)).tolist():
            value, reference = float(own[part]), float(other[part])
            difference = (value - reference) / float(other.max())
            contact = contact_name(kind, part)
            rows.append(
                _row("load of a contact of the whole drive", value, reference, "N", difference, "load", contact=contact, **place)
            )  # fmt: skip
    value, reference = ours["wheel_angle"] * ARCSEC, theirs["wheel_angle"] * ARCSEC
    return [*rows, _row("wheel angle", value, reference, '"', value - reference, "wheel", difference_unit='"', **place)]


def _roller_rows(ours: Answer, theirs: Answer, against: str) -> list[Row]:
    rows = []
    for roller in ROLLERS:
        for quantity, own, other, unit, bound in zip(
            ("pressure at mid-length", "approach"), ours[roller.name], theirs[roller.name], ("MPa", "mm"),
            ("pressure", "approach"), strict=True,
        ):  # fmt: skip
            difference = own / other - 1.0
            rows.append(
                _row(f"{quantity}, {roller.name}", own, other, unit, difference, bound, model="half-space", against=against)
            )  # fmt: skip
    return rows


def _pair_rows(ours: Answer, theirs: Answer, against: str) -> list[Row]:
    rows = []
    for pair in CROWNED_PAIRS:
        for quantity, own, other, unit, bound in zip(
            ("load", "largest mean pressure of a face"), ours[pair.name], theirs[pair.name], ("N", "MPa"),
            ("pair load", "pair pressure"), strict=True,
        ):  # fmt: skip
            rows.append(
                _row(
                    f"{quantity}, {pair.name}", own, other, unit, own / other - 1.0, bound,
                    model="solid finite elements, coarse", against=against,
                )
            )  # fmt: skip
    return rows


def _row(
    quantity: str, value: float, reference: float, unit: str, difference: float, bound: str, **place: Any
) -> Row:  # fmt: skip
    limit, reason = LIMITS[bound]
    return Row(
        level=2,
        quantity=quantity,
        value=value,
        reference=reference,
        unit=unit,
        difference=difference,
        limit=limit,
        reason=reason,
        **place,
    )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(prog=COMMAND, description="Let other codes solve the problems of level 2.")
    parser.add_argument("codes", nargs="*", default=list(CODES), help="default: all")
    parser.add_argument("--out", type=Path, default=Path(__file__).parent / STORED, help="default: the stored answers")
    arguments = parser.parse_args()
    for missing in [name for name in arguments.codes if not CODES[name].installed()]:
        parser.exit(2, f"{COMMAND}: error: {missing} is not installed: {CODES[missing].installation}\n")
    add_answers(arguments.out, {name: CODES[name].theirs() for name in arguments.codes})
