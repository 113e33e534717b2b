"""A folder at the place of a file, or a file at that of a folder, is refused in one line before any work."""

from __future__ import annotations

import pytest
from refusals import error_is

from ltca.analysis import time_run as time_run_analysis
from ltca.commands.program import main
from ltca.compliance import coefficient_files, ring
from ltca.drive.single_discs import single_discs
from ltca.errors import PlaceError
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive


@pytest.fixture
def cache(tmp_path, monkeypatch):
    """An empty cache, and no derivation."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))

    def derivation(name=""):
        pytest.fail("a derivation has started")

    monkeypatch.setattr(coefficient_files, "derivation", derivation)
    monkeypatch.setattr(ring, "derivation", derivation)
    return tmp_path / "cache"


def refused(words, capsys):
    assert main(words) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    return said


def test_a_folder_at_the_place_of_kept_coefficients(cache):
    """All was derived, then "Is a directory"."""
    (single,) = single_discs(with_fields(load_drive("paper").cases["CS-1"], {"clearance.pin_hole": 0.017}))
    place = coefficient_files.cached_file(single)
    place.mkdir(parents=True)
    with error_is(PlaceError, f"{place}: is a folder in the place of a file that is derived and kept: remove it"):
        coefficient_files.find_coefficients(single)
    assert place.is_dir()


def test_a_folder_at_the_place_of_a_kept_ring(cache):
    drive = with_fields(
        next(iter(load_drive("robot-joint").cases.values())),
        {"ring.inner_radius": 60.0, "ring.outer_radius": 75.0, "ring.width": 25.0, "ring.model": "fe"},
    )
    place = coefficient_files.kept_file(ring.file_name(drive))
    place.mkdir(parents=True)
    with pytest.raises(PlaceError, match="is a folder in the place of a file"):
        ring.known_ring(drive)


@pytest.mark.parametrize(
    ("words", "name"),
    [
        (["tolerance", "paper", "--case", "CS-1", "--samples", "4", "--positions", "2"], "batches"),
        (["dynamics", "paper", "--case", "CS-1", "--speed", "1500", "--time", "1 ms"], "checkpoint"),
        (["validate", "paper"], "kept"),
    ],
    ids=lambda one: one[0] if isinstance(one, list) else one,
)  # fmt: skip
def test_a_file_at_the_place_of_a_folder_beside_the_results(words, name, tmp_path, capsys, monkeypatch):
    """A study was solved before "File exists", a run in time went on for twenty seconds."""
    monkeypatch.setattr(time_run_analysis, "prepare_run", lambda *_: pytest.fail("the work has started"))
    if words[0] == "validate":
        from validation.commands.validate import KEPT as name  # noqa: N811
    (tmp_path / name).write_text("the user's")
    said = refused([*words, "--out", str(tmp_path)], capsys)
    assert f"{name} is a file in the place of a folder: move it, or choose another place" in said
    assert (tmp_path / name).read_text() == "the user's"


@pytest.mark.parametrize(
    "words",
    [
        ["run", "paper", "--case", "CS-1", "--angles", "0.1"],
        ["check", "paper", "--case", "CS-1"],
        ["curves", "paper", "--case", "CS-1"],
        ["show", "paper"],
        ["export", "paper", "--for", "json"],
        ["export", "paper", "--format", "dxf"],
        ["mesh", "paper"],
        ["fem", "paper"],
        ["tolerance", "paper", "--case", "CS-1"],
        ["dynamics", "paper", "--case", "CS-1", "--speed", "1500"],
    ],
    ids=lambda words: " ".join(words[:4]),
)
def test_a_file_at_the_place_of_the_folder_of_results(words, tmp_path, capsys):
    out = tmp_path / "out"
    out.write_text("the user's")
    assert "is a file, not a folder" in refused([*words, "--out", str(out)], capsys)


@pytest.mark.parametrize("words", [["derive", "paper"], ["init"]], ids=str)
def test_a_folder_at_the_place_of_a_file_that_is_named(words, tmp_path, capsys):
    place = tmp_path / "place.toml"
    place.mkdir()
    given = ["--out", str(place)] if words[0] == "derive" else [str(place), "--force"]
    assert "is a folder, not a file" in refused([*words, *given], capsys)


@pytest.mark.parametrize("name", ["results.nc", "summary.json", "report.html"])
def test_a_folder_at_the_place_of_a_result(name, tmp_path, capsys):
    (tmp_path / name).mkdir()
    words = ["run", "paper", "--case", "CS-1", "--angles", "0.1", "--compliance", "half-space", "--out", str(tmp_path)]
    assert f"{name} is there and was not written by the last run" in refused(words, capsys)
