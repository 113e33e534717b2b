"""The walks of ``examples/walks``: what a new user types, from an empty folder to verdict, page and CAD."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path

import pytest

from ltca.commands.program import main

WALKS = sorted((Path(__file__).parents[3] / "examples" / "walks").glob("*.toml"))
MOST_COMMANDS = 9


def edited(text, path, value):
    """The text of a drive file with another value in the line of a field, which is there."""
    table, _, field = path.rpartition(".")
    head, _, rest = text.partition(f"\n[{table}]\n")
    lines, after = re.split(r"(?=\n\[)", rest, maxsplit=1)
    changed, times = re.subn(rf"(?m)^{field} = [^#\n]*", f"{field} = {json.dumps(value)}  ", lines)
    assert times == 1, f"{path}: the template has no line of it"
    return f"{head}\n[{table}]\n{changed}{after}"


SHORT = {"check": ["--quick", "--positions", "24"], "run": ["--quick", "--positions", "24"]}
"""Words that make a walk a short one; two of three go without advice and extremes between positions, which take most of it."""
WITHOUT_ADVICE = SHORT | {"check": [*SHORT["check"], "--no-advice"]}


def walk_along(walk, folder, more):
    """Walk, with further words for some commands; every command ends with status 0."""
    assert len(walk["commands"]) <= MOST_COMMANDS
    for command in walk["commands"]:
        if command == "edit":
            file = folder / walk["file"]
            text = file.read_text(encoding="utf-8")
            for path, value in walk["edit"].items():
                text = edited(text, path, value)
            file.write_text(text, encoding="utf-8")
            continue
        _, name, *words = command.split()
        assert main([name, *words, *more.get(name, [])]) == 0, command


@pytest.mark.parametrize(
    ("more", "path"),
    [
        *(
            pytest.param(
                SHORT if path.stem == "rv" else WITHOUT_ADVICE,
                path,
                id=path.stem,
                marks=[pytest.mark.slow, *([] if path.stem == "rv" else [pytest.mark.nightly])],
            )
            for path in WALKS
        ),
        *(pytest.param({}, path, id=f"{path.stem}-as-typed", marks=pytest.mark.nightly) for path in WALKS),
    ],
)
def test_a_walk_ends_with_verdict_page_and_cad(more, path, tmp_path, monkeypatch, capsys, request):
    """Nothing that the user did not write is refused, nothing fails: exit status 0 throughout, of `check` too."""
    if more == WITHOUT_ADVICE:
        request.getfixturevalue("positions_alone")
    monkeypatch.chdir(tmp_path)
    walk = tomllib.loads(path.read_text(encoding="utf-8"))
    walk_along(walk, tmp_path, more)
    printed = capsys.readouterr()
    assert "error" not in printed.err
    name = Path(walk["file"]).stem
    assert (
        json.loads((tmp_path / "out" / f"{name}_check" / "check.json").read_text(encoding="utf-8"))["verdict"] == "pass"
    )
    pages = sorted(page.parent.name for page in tmp_path.rglob("report.html"))
    assert pages == [name, f"{name}_check"]
    assert list(tmp_path.rglob("*.step"))


def test_walks_are_three():
    assert [path.stem for path in WALKS] == ["joint-99", "printed", "rv"]
