"""``crank.of.N`` counts eccentrics in studies and entries in a drive file; tolerances on what a drive has not."""

from __future__ import annotations

import json

import pyarrow.parquet as pq
import pytest
from refusals import error_says, refused_field

from ltca.commands.program import main
from ltca.drive.fields import whose
from ltca.errors import DriveError
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive, parse_drive, shipped_drive
from ltca.studies.tolerance_study import tolerance_study

RV, PAPER = shipped_drive("rv"), shipped_drive("paper")
SCATTER = '{ distribution = "normal", tolerance = 0.003 }'


def with_of(*entries):
    return RV.replace("number = 3\n", f"number = 3\nof = [{', '.join(entries)}]\n", 1)


def test_an_eccentric_is_named_by_disc_and_crank():
    """What the path changes is what it is said to be, for every eccentric and whatever the order of the file."""
    drive = parse_drive(with_of("{ disc = 1, crank = 2 }", "{ disc = 0, crank = 1 }")).cases["nominal"]
    for disc in range(2):
        for crank in range(3):
            path = f"crank.of.{disc * 3 + crank}.phase_error"
            assert whose(drive, path) == f"disc {disc}, crank {crank}"
            moved = with_fields(drive, {path: 1e-3}).crank
            assert moved.eccentric(disc, crank).phase_error == 1e-3
            assert sum(entry.phase_error for entry in moved.of) == 1e-3
    assert whose(drive, "disc.of.1.runout.amount") == whose(drive, "crank.eccentricity_error") == ""
    assert whose(load_drive("paper").cases["CS-1"], "crank.of.0.phase_error") == ""


@pytest.mark.slow
def test_a_study_says_whose_the_eccentric_is(tmp_path, capsys):
    """Three eccentrics of six were printed as crank.of.1 … with nothing that told them from entries of the file."""
    head = RV.partition("[tolerances]")[0]
    path = tmp_path / "drive.toml"
    path.write_text(f"{head}[tolerances]\ncrank.of.4.eccentricity_error = {SCATTER}\n", encoding="utf-8")
    arguments = [
        "tolerance",
        str(path),
        "--quick",
        "--samples",
        "24",
        "--positions",
        "3",
        "--out",
        str(tmp_path / "out"),
    ]
    assert main([*arguments, "--no-figures", "--quantities", "max_pin_load"]) == 0
    assert "crank.of.4.eccentricity_error (disc 1, crank 1) " in capsys.readouterr().out
    summary = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    assert summary["eccentrics"] == {"crank.of.4.eccentricity_error": "disc 1, crank 1"}
    column = pq.read_schema(tmp_path / "out" / "results.parquet").field("crank.of.4.eccentricity_error")
    assert column.metadata[b"description"].decode().endswith("(disc 1, crank 1)")


@pytest.mark.parametrize(
    ("entries", "told"),
    [
        (["{ disc = 2, crank = 0 }"], "crank.of, entry 0: disc = 2: must be less than 2"),
        (["{ disc = 0, crank = 0 }", "{ disc = 1, crank = 3 }"], "crank.of, entry 1: crank = 3: must be less than 3"),
        (["{ disc = 1 }"], "crank.of, entry 0: crank is left out"),
        (["{ disc = 1, crank = 2 }"] * 2, "crank.of, entry 1: disc 1 on crank 2 has an entry already"),
        (
            ["{ disc = 1, crank = 2, phase_error = 0.9 }"],
            "crank.of, entry 0 (disc 1, crank 2): phase_error = 0.9 rad",
        ),
        (
            ["{ disc = 0, crank = 0, eccentricity_error = 0.9 }"],
            "crank.of, entry 0 (disc 0, crank 0): eccentricity_error",
        ),
        (
            ["{ disc = 0, crank = 0, phase_eror = 0.1 }"],
            "crank.of, entry 0: phase_eror: is not a field …`phase_error`",
        ),
        (["3"], "crank.of, entry 0 = 3: must be a table"),
    ],
)
def test_messages_of_the_file_count_entries(entries, told):
    """`crank.of.0.disc = 2` read as eccentric 0, which is on disc 0."""
    with error_says(DriveError, *told.split("…")):
        parse_drive(with_of(*entries))


@pytest.mark.parametrize(
    ("path", "told"),
    [
        ("crank.of.6.phase_error", "there is no eccentric 6; …: N of crank.of.N is disc · 3 + crank, from 0 to 5"),
        ("disc.of.2.runout.amount", "there is no disc 2; …: N of disc.of.N is the disc, from 0 to 1"),
        ("crank.of.N.phase_error", "a number in the place of N; N of crank.of.N is disc · 3 + crank, from 0 to 5"),
        ("disc.runnout.amount", "did you mean `disc.runout.amount`?"),
        ("disc.of.1.runout.amonut", "did you mean `disc.of.1.runout.amount`?"),
        (
            "disc.bore_errors.radial",
            "did you mean `disc.of.N.bore_errors.radial`? N of disc.of.N is the disc, from 0 to 1",
        ),
    ],
)
def test_what_n_is_where_it_is_wrong(path, told):
    """In a study and in [tolerances] alike."""
    drive = parse_drive(RV).cases["nominal"]
    with error_says(DriveError, *told.split("…")):
        with_fields(drive, {path: 0.001})
    with error_says(DriveError, *told.split("…"), starts=f"rv.toml: tolerances.{path}: "):
        parse_drive(f"{RV}{path} = {SCATTER}\n", "rv.toml")


@pytest.mark.parametrize(
    ("text", "path", "told"),
    [
        (RV, "pin_shaft.pin_errors.radial", "there is no pin_shaft in this drive"),
        (RV, "disc.hole_errors.radial", "there is no pin_shaft in this drive"),
        (RV, "clearance.pin_hole", "there is no pin_shaft in this drive"),
        (RV, "pin_wheel.support_stiffness", "is left out in this drive"),
        (PAPER, "disc.of.0.bore_errors.radial", "must be left out with one crank"),
        (PAPER, "crank.circle_radius", "must be left out with one crank"),
        (PAPER, "crank.support.diameter", "there is no crank.support in this drive"),
    ],
)
def test_a_tolerance_on_a_part_that_is_not_there_is_refused_with_the_file(text, path, told):
    """`run` and `show` took it, and `tolerance` refused it without file and table."""
    head, table, rest = text.partition("[tolerances]\n")
    with refused_field(f"tolerances.{path}", "", told, alone=True, source="drive.toml"):
        parse_drive(f"{head}{table}{path} = {SCATTER}\n{rest}", "drive.toml")


def test_a_tolerance_on_a_part_that_one_case_has_is_kept():
    """What is wrong for one case is told when that case is studied."""
    head, table, rest = RV.partition("[tolerances]\n")
    cases = '\n[[case]]\nname = "rigid"\n[[case]]\nname = "soft"\npin_wheel = { support_stiffness = 1e6 }\n'
    text = f'{head}{table}pin_wheel.support_stiffness = {{ distribution = "normal", tolerance = 1e4 }}\n{rest}{cases}'
    file = parse_drive(text, "drive.toml")
    assert "pin_wheel.support_stiffness" in file.tolerances
    told = "drive.toml: case rigid: tolerances.pin_wheel.support_stiffness: is left out in this drive"
    with error_says(DriveError, starts=told):
        tolerance_study(file, case="rigid", samples=4, positions=3)
    assert tolerance_study(file, case="soft", samples=4, positions=3).design.samples == 4
