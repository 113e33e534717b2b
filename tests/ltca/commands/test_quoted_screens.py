"""Screens that the first page of the documentation quotes are what the commands print."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from ltca.commands.program import main

PAGE = Path(__file__).parents[3] / "docs" / "start" / "index.md"
DRIVE = "robot-joint"


def quoted():
    """The quoted lines of the page, by the command that stands before them."""
    found, command = {}, ""
    for kind, body in re.findall(r"```(sh|text)\n(.*?)```", PAGE.read_text(encoding="utf-8"), flags=re.DOTALL):
        if kind == "sh":
            command = body.strip()
        else:
            found[command] = [" ".join(line.split()) for line in body.splitlines() if line.strip("… ")]
    return found


WITHOUT = {"show": [], "check": ["--no-advice", "--no-page"], "run": ["--no-page"]}


def test_the_first_page_quotes_three_commands():
    assert {command.split()[1] for command in quoted()} == set(WITHOUT)


# What `run` tells beside `check`'s numbers has tests of its own (`test_run_table`).
@pytest.mark.slow
@pytest.mark.parametrize("name", ["show", "check", pytest.param("run", marks=pytest.mark.nightly)])
def test_the_first_page_quotes_what_is_printed(name, tmp_path, monkeypatch, capsys):
    """Rows of `check` had places and limits of former versions, and were those of another file than the page writes."""
    monkeypatch.chdir(tmp_path)
    assert main(["init", "my.toml", "--like", DRIVE]) == 0
    capsys.readouterr()
    ((words, lines),) = ((command.split(), lines) for command, lines in quoted().items() if command.split()[1] == name)
    assert main([*words[1:], *WITHOUT[name]]) == 0
    printed = {" ".join(line.split()) for line in capsys.readouterr().out.splitlines()}
    assert [line for line in lines if line not in printed] == []
