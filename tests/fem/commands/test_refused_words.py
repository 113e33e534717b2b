"""Words of the commands of finite elements that are refused before any work, without a file: one table."""

from __future__ import annotations

import shlex
import tomllib
from pathlib import Path

import pytest

from ltca.commands.program import main

ROWS = tomllib.loads(Path(__file__).with_name("refused_words.toml").read_text(encoding="utf-8"))["refused"]


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row["words"])
def test_wrong_words_are_refused_before_any_work(row, tmp_path, monkeypatch, capsys):
    def never(*_words, **_options):
        raise AssertionError("work was begun")

    monkeypatch.setattr("fem.coefficients.bodies.mesh_disc_parts", never)
    command, *words = shlex.split(row["words"])
    assert main([command, "--out", str(tmp_path / "out"), *words]) == 2
    _, _, said = capsys.readouterr().err.partition("cyclo: error: ")
    at = 0
    for piece in row["message"]:
        assert piece in said[at:]
        at = said.index(piece, at) + len(piece)
    assert "unforeseen" not in said
    assert not (tmp_path / "out").exists()
