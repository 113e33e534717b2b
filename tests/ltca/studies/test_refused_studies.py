"""Studies and searches that are refused: one table, each row with what the message says, before any work."""

from __future__ import annotations

import shlex
import tomllib
from pathlib import Path

import pytest

from ltca.commands.program import main
from ltca.errors import DriveError
from ltca.reading.drive_file import load_drive
from ltca.studies.optimiser import parse_bound, parse_variable
from ltca.studies.sweep_file import parse_sweep

TABLES = tomllib.loads(Path(__file__).with_name("refused_studies.toml").read_text(encoding="utf-8"))
HEAD = 'positions = 3\ndesign = { kind = "grid" }\n'
"""Of a sweep whose factors are wrong."""


def parse_study(text):
    parse_sweep(tomllib.loads(HEAD + text if text.startswith("[factors]") else text), "paper")


PARSERS = {
    "sweeps": parse_study,
    "variables": lambda text: parse_variable(text, load_drive("paper").cases["CS-1"]),
    "bounds": parse_bound,
}


@pytest.mark.parametrize(
    ("kind", "row"), [(kind, row) for kind in PARSERS for row in TABLES[kind]], ids=lambda one: str(one)[:60]
)
def test_a_wrong_study_is_refused_by_name(kind, row):
    with pytest.raises(DriveError) as caught:
        PARSERS[kind](row["text"])
    assert row["message"] in str(caught.value)


@pytest.mark.parametrize("row", TABLES["options"], ids=lambda row: row["text"])
def test_wrong_options_are_refused(row, tmp_path, capsys):
    command, *words = shlex.split(row["text"])
    assert main([command, *words, "--out", str(tmp_path / "out")]) == 2
    assert row["message"] in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
