"""Commands in the background: their words, their files, their end."""

from __future__ import annotations

import re
import time
from importlib.resources import files

import pytest
from refusals import error_says

from ltca.errors import CycloError, DriveError
from ltca.output import progress
from ltca.reading.drive_file import load_drive, shipped_drive
from ltca.studio.jobs import Jobs, _done, exports, job_words

PAPER = shipped_drive("paper")


@pytest.mark.parametrize(
    ("asked", "expected"),
    [
        ({"kind": "fem"}, ["fem"]),
        ({"kind": "tolerance", "samples": 12}, ["tolerance", "--samples", "12"]),
        ({"kind": "export", "format": "dxf", "part": "disc"}, ["export", "--format", "dxf", "--part", "disc"]),
    ],
)
def test_known_jobs_are_known_words(asked, expected):
    assert job_words(asked) == expected


@pytest.mark.parametrize(
    "asked",
    [{}, {"kind": "run"}, {"kind": ["fem"]}, {"kind": "tolerance"}, {"kind": "tolerance", "samples": "1 --out /"},
     {"kind": "tolerance", "samples": True}, {"kind": "tolerance", "samples": 0}, {"kind": "export", "format": "exe"},
     {"kind": "export", "format": "dxf", "part": "--out"}, {"kind": "simulator", "simulator": "; rm"}],
)  # fmt: skip
def test_anything_else_is_refused(asked):
    with pytest.raises(DriveError, match="must be"):
        job_words(asked)


def test_as_many_samples_as_the_page_offers():
    page = (files("ltca") / "studio" / "templates" / "studio.html").read_text(encoding="utf-8")
    most = int(re.search(r'id="samples" [^>]*max="(\d+)"', page)[1])
    assert job_words({"kind": "tolerance", "samples": most})[-1] == str(most)
    with error_says(DriveError, ends=f"must be a whole number from 1 to {most}"):
        job_words({"kind": "tolerance", "samples": most + 1})


def test_what_is_offered_is_what_the_command_has():
    assert {"dxf", "step", "stl"} <= set(exports()["formats"])
    assert "disc" in exports()["parts"]


def finished(jobs, number):
    until = time.monotonic() + 600.0
    while time.monotonic() < until:
        (job,) = (one for one in jobs.told() if one["number"] == number)
        if job["state"] != "running":
            return job
        time.sleep(0.05)
    raise AssertionError(job)


@pytest.mark.parametrize("target", ["elsewhere", "not there"])
def test_a_link_that_leads_out_is_refused_before_a_folder_is_made(target, tmp_path):
    """``out`` as a link to a folder elsewhere: `out/paper_studio` was made there, then refused."""
    folder, outside = tmp_path / "folder", tmp_path / "outside"
    folder.mkdir()
    outside.mkdir()
    place = outside if target == "elsewhere" else outside / "new"
    (folder / "out").symlink_to(place)
    with pytest.raises(DriveError, match="leads out of the folder of the studio"):
        Jobs(folder).start({"kind": "fem"}, PAPER, "paper", "CS-1")
    assert [*outside.iterdir()] == []


def test_folders_of_links_in_a_circle_and_odd_digits_are_told_in_a_line(tmp_path):
    circle = tmp_path / "circle"
    circle.mkdir()
    (circle / "out").symlink_to("out")
    with pytest.raises(CycloError):
        Jobs(circle).start({"kind": "fem"}, PAPER, "paper", "CS-1")
    assert Jobs(circle).file("out/x") is None
    (tmp_path / "out" / "paper_studio" / "²").mkdir(parents=True)  # a digit, but no number
    assert Jobs(tmp_path)._new_folder("paper").name == "1"


@pytest.mark.slow
def test_a_case_called_as_an_option_is_a_case(tmp_path):
    jobs = Jobs(tmp_path)
    text = PAPER.replace('name = "CS-3"', 'name = "--debug"')
    number = jobs.start({"kind": "export", "format": "dxf", "part": "disc"}, text, "paper", "--debug")
    job = finished(jobs, number)
    assert job["state"] == "done", job
    assert job["command"].endswith("--case=--debug")
    assert any(path.endswith(".dxf") for path in job["files"])


@pytest.mark.slow
def test_an_export_is_a_file_of_the_text_as_it_is(tmp_path):
    jobs = Jobs(tmp_path)
    text = PAPER.replace("thickness = 11.8 ", "thickness = 12.5 ")
    number = jobs.start({"kind": "export", "format": "dxf", "part": "disc"}, text, "paper", "CS-3")
    job = finished(jobs, number)
    assert job["state"] == "done", job
    (drawing,) = (path for path in job["files"] if path.endswith(".dxf"))
    assert jobs.file(drawing).read_text().startswith("  0\nSECTION")
    (own,) = (path for path in job["files"] if path.endswith(".toml"))
    assert load_drive(jobs.file(own)).cases["CS-3"].disc.thickness == 12.5
    assert jobs.file("out/paper_studio") is None


@pytest.mark.slow
def test_a_job_is_cancelled_and_a_wrong_drive_is_told(tmp_path):
    jobs = Jobs(tmp_path)
    first = jobs.start({"kind": "tolerance", "samples": 90_000}, PAPER, "paper", "CS-1")
    second = jobs.start({"kind": "fem"}, PAPER.replace("number_of_teeth = 13", "number_of_teeth = -1"), "paper", "CS-1")
    with pytest.raises(DriveError, match="2 jobs run already"):
        jobs.start({"kind": "fem"}, PAPER, "paper", "CS-1")
    assert jobs.cancel(first)
    assert finished(jobs, first)["state"] == "cancelled"
    wrong = finished(jobs, second)
    assert wrong["state"] == "failed"
    assert "disc.number_of_teeth = -1" in " ".join(wrong["lines"])
    assert not jobs.cancel(first)
    jobs.close()


def test_how_far_a_job_is_stands_in_its_last_line_that_says_so(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(progress, "FIRST", 0.01)
    with progress.progress("samples", 250) as advance:
        advance("disc, pin (3 s)", 12)
        told = ""
        while not re.search(r"samples: 12 of 250, disc, pin \(3 s\) \(\d+ s\)\n", told):
            time.sleep(0.01)  # the seconds are those that the machine takes to come to the line
            told += capsys.readouterr().err
    lines = told.splitlines()
    assert _done([*lines, "warning: 3 of 4 pins"]) == [12, 250]
    assert _done(["coefficients: 0 of at most 4 (10 s)"]) == [0, 4]
    assert _done(["disc: 3 of 4 holes", "…"]) == []


def test_what_a_job_tells_is_utf_8_whatever_the_locale(tmp_path, monkeypatch):
    """Of a terminal in cp1252 or latin-1 a page showed replacement signs for ° and µ."""
    monkeypatch.setenv("PYTHONIOENCODING", "latin-1")
    jobs = Jobs(tmp_path)
    number = jobs.start(
        {"kind": "export", "format": "dxf", "part": "disc"}, PAPER.replace("paper", "größe", 1), "größe", "CS-1"
    )
    job = finished(jobs, number)
    assert job["state"] == "done"
    assert any("größe" in line for line in job["lines"])
    jobs.close()
