"""`ltca.vibration`: what ``cyclo dynamics`` computes, as an object."""

from __future__ import annotations

import json

import pytest
from refusals import error_says

import ltca
from ltca.commands.program import main
from ltca.errors import DriveError
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive, shipped_drive

FILE = load_drive("paper")


@pytest.mark.slow  # two responses over speed
def test_it_is_what_the_command_writes(tmp_path):
    path, out = tmp_path / "mine.toml", tmp_path / "out"
    path.write_text(shipped_drive("paper").partition("[[case]]")[0] + '\n[damping]\nratio = "5 %"\n', encoding="utf-8")
    words = ["--quick", "--positions", "6", "--turns", "4", "--speed", "500 rpm", "--no-page", "--out", str(out)]
    assert main(["dynamics", str(path), *words]) == 0
    kept = json.loads((out / "dynamics.json").read_text(encoding="utf-8"))
    found = ltca.vibration(load_drive(str(path)), positions=6, turns=4, speed="500 rpm", compliance="half-space")
    assert found.fastest == 500.0
    assert found.response is not None
    content = json.loads(json.dumps(found.content))
    assert {name: kept[name] for name in content} == content
    assert "critical speeds up to 500 rpm" in repr(found)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"turns": 0}, "turns = 0: must be a whole number from 1 to 1000"),
        ({"turns": 1}, "turns = 1: must be at least 4, or 66 orders of the transmission error look alike"),
        ({"positions": 3}, "positions = 3: must be a whole number from 4 to 1000"),
        ({"speed": "3 mm"}, "speed = '3 mm': must have the unit rpm"),
        ({"speed": 0}, "speed = 0: must be greater than 0 rpm"),
        ({"case": None}, "case: must be given"),
        ({"compliance": "soft"}, "compliance = 'soft': is unknown"),
        (
            {"drive": with_fields(FILE.cases["CS-1"], {"materials.disc.density": None}), "case": None},
            "materials.disc.density: must be given for inertias",
        ),
    ],
)
def test_what_makes_no_sense_is_refused_by_name(options, message):
    with error_says(DriveError, message):
        ltca.vibration(**({"drive": FILE, "case": "CS-1", "compliance": "half-space"} | options))
