"""What a folder holds comes from one run; what is the user's stays; one process at a time writes to it."""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from importlib.metadata import entry_points
from pathlib import Path

import pytest
from refusals import error_says

from ltca.commands.program import GROUP, main
from ltca.errors import FaultError, PlaceError
from ltca.output import files
from ltca.output.files import STALE, whole_file
from ltca.output.locks import claimed_file
from ltca.output.run_folder import LOCK, MANIFEST, claimed_folder, figure_files, require_folder

FIGURES = ("fig24_pin_load", "fig25_loaded_pins")
HOLDER = """
import sys, time
from pathlib import Path
from ltca.output.run_folder import claimed_folder
with claimed_folder(Path(sys.argv[1]), "run"):
    print("held", flush=True)
    time.sleep(60)
"""


def put(folder, **files):
    """Write files as a run does."""
    with claimed_folder(folder, "run"):
        for name, text in files.items():
            with whole_file(folder / name.replace("__", "/").replace("_", ".")) as part:
                part.write_text(text)


def names(folder):
    return sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())


@pytest.fixture
def holder(tmp_path):
    """Another process that holds a folder."""
    words = [sys.executable, "-c", HOLDER, str(tmp_path / "out")]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "held\n"
        yield process
        process.kill()


def test_the_root_of_a_file_system_was_taken_for_a_folder_of_results(tmp_path):
    """`--out /` put results beside /etc; so does a path that leads there."""
    root = Path(tmp_path.anchor)
    before = sorted(path.name for path in root.iterdir())
    for out in (root, tmp_path.joinpath(*[".."] * (len(tmp_path.parts) + 1))):
        with error_says(PlaceError, "is the root of a file system, must be a folder below it"):
            require_folder(out)
        with pytest.raises(PlaceError, match="is the root of a file system"), claimed_folder(out, "run"):
            pass  # nothing is written where it is taken
    assert sorted(path.name for path in root.iterdir()) == before


def test_two_processes_in_one_folder(holder, tmp_path, capsys):
    """Two studies with different seeds in one --out mixed in silence: 1752 of 2000 rows came from the other."""
    out = tmp_path / "out"
    assert main(["tolerance", "paper", "--samples", "2", "--positions", "2", "--seed", "7", "--out", str(out)]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert f"process {holder.pid}" in said
    assert names(out) == [LOCK]
    # the lock of a process that was killed holds nobody up
    holder.kill()
    holder.wait()
    put(out, a_txt="a")
    assert names(out) == ["a.txt", MANIFEST]


def test_one_process_does_not_hold_a_folder_twice(tmp_path):
    with (
        claimed_folder(tmp_path, "run"),
        pytest.raises(PlaceError, match="wait for it"),
        claimed_folder(tmp_path, "sweep"),
    ):
        pass
    with claimed_file(tmp_path / "a.nc", "derive"):
        with (
            error_says(PlaceError, "a.nc: cyclo derive (process"),
            claimed_file(tmp_path / "a.nc", "derive"),
        ):
            pass
        with claimed_file(tmp_path / "b.nc", "derive"):
            pass
    assert names(tmp_path) == []


@pytest.mark.slow
def test_numbers_of_one_run_never_lie_beside_pictures_of_another(tmp_path, monkeypatch):
    from ltca.figures import run_figures

    monkeypatch.setattr(run_figures, "FIGURES", {name: run_figures.FIGURES[name] for name in FIGURES})
    out = tmp_path / "out"
    words = ["run", "paper", "--case", "CS-1", "--out", str(out)]
    assert main([*words, "--angles", "0.1", "--figures"]) == 0
    assert (out / "figures").is_dir()
    (out / "notes.txt").write_text("the user's")
    (out / "figures" / "mine.png").write_text("the user's")
    changed = out / "figures" / "fig24_pin_load.svg"
    changed.write_text("drawn over by the user")
    assert main([*words, "--angles", "0.2", "--no-figures"]) == 0
    assert names(out) == [
        MANIFEST, "figures/fig24_pin_load.svg", "figures/mine.png", "notes.txt", "report.html", "results.nc", "summary.json",
    ]  # fmt: skip
    content = json.loads((out / MANIFEST).read_text())
    assert sorted(content["files"]) == ["report.html", "results.nc", "summary.json"]
    assert content["complete"]


ROOT = Path(__file__).parents[2]
STUDIES = ("tolerance", "sweep")
REQUIREMENTS = str(ROOT / "examples" / "requirements" / "possible-paper.toml")
STUDY = "study.toml"
"""A study file that `in_folder` writes where a test runs."""
COMMANDS = {
    "run": (["run", "paper", "--angles", "0"], "results.nc"),
    "run figures": (["run", "paper", "--angles", "0", "--figures"], "figures/fig24_pin_load.svg"),
    "run pressure": (["run", "paper", "--pressure", "--figures"], "figures/fig31_roller_pressure_CS-6.png"),
    "curves": (["curves", "paper", "--figures", "png"], "figures/torque_curve_CS-3.png"),
    "show": (["show", "paper"], "drive_CS-1.png"),
    "tolerance": (["tolerance", "paper"], "study.json"),
    "tolerance table": (["tolerance", "paper"], "results.parquet"),
    "tolerance resumed": (["tolerance", "paper", "--resume"], "results.nc"),
    "sample": (["tolerance", "paper", "--sample", "3"], "samples/sample_00000003.toml"),
    "optimise": (
        ["optimise", "paper", "--vary", "eccentricity", "--minimise", "max_pin_load", "--figures"],
        "figures/search.svg",
    ),
    "mesh": (["mesh", "paper"], "pin_12.vtu"),
    "fem": (["fem", "paper"], "summary.json"),
    "validate": (["validate", "paper"], "rows.csv"),
    "check": (["check", "paper"], "check.json"),
    "check page": (["check", "paper"], "report.html"),
    "dynamics": (["dynamics", "paper", "--speed", "1500"], "dynamics.json"),
    "time": (["dynamics", "paper", "--case", "CS-1", "--speed", "1500", "--time", "1 ms"], "time.nc"),
    "sweep": (["sweep", STUDY], "results.parquet"),
    "design": (["design", REQUIREMENTS], "designs.csv"),
    "export": (["export", "paper", "--case", "CS-1", "--format", "csv", "--part", "disc"], "paper_CS-1_disc_flank.csv"),
    "export model": (["export", "paper", "--case", "CS-1", "--for", "json"], "paper_CS_1.json"),
}


@pytest.fixture(autouse=True)
def in_folder(tmp_path, monkeypatch):
    """A folder with a study file, beside what a test writes."""
    place = tmp_path.parent / f"{tmp_path.name}_study"
    place.mkdir(exist_ok=True)
    (place / STUDY).write_text('drive = "paper"\npositions = 2\n[factors]\n"clearance.bearing" = [0.0, 0.01]\n')
    monkeypatch.chdir(place)


def test_every_command_that_writes_to_a_folder_is_among_these():
    """`check` and `dynamics` were not: what they do with files of the user was tested of other commands alone."""
    writing = set()
    for entry in entry_points(group=GROUP):
        parser = argparse.ArgumentParser()
        entry.load().configure(parser)
        if any("--out" in action.option_strings and action.metavar == "DIR" for action in parser._actions):
            writing.add(entry.name)
    assert writing == {words[0] for words, _ in COMMANDS.values()}
    assert {"run", "check", "curves", "dynamics", "design", "fem", "validate"} <= writing


@pytest.mark.parametrize(("words", "name"), COMMANDS.values(), ids=COMMANDS)
@pytest.mark.parametrize("kind", ["file", "link", "folder"])
def test_a_file_of_the_user_is_never_overwritten(words, name, kind, tmp_path, capsys):
    """A user's own results.nc in --out was overwritten in silence, and a link replaced."""
    out, victim = tmp_path / "out", tmp_path / "victim"
    place = out / name
    place.parent.mkdir(parents=True)
    victim.write_text("the user's")
    if kind == "file":
        place.write_text("the user's")
    elif kind == "link":
        place.symlink_to(victim)
    else:
        place.mkdir()
    assert main([*words, "--out", str(out)]) == 2
    said = capsys.readouterr()
    assert said.err.count("\n") == 1, said.err
    assert f"--out {out}: {name} is there and was not written by the last run" in said.err
    assert victim.read_text() == "the user's"
    assert kind != "file" or place.read_text() == "the user's"
    assert [path for path in out.rglob("*") if path.is_file()] == ([place] if kind != "folder" else [])


@pytest.mark.parametrize("words", [words for words, name in COMMANDS.values() if words[0] not in STUDIES], ids=str)
def test_an_interrupted_study_is_not_made_useless_by_another_command(words, tmp_path, capsys):
    """A run removed study.json as a file of the last run: batches were left that could never be resumed."""
    out = tmp_path / "out"
    put(out, study_json="{}")
    (out / "batches").mkdir()
    (out / "batches" / "00000000.npz").write_text("a batch")
    before = names(out)
    assert main([*words, "--out", str(out)]) == 2
    assert capsys.readouterr().err == (
        f"cyclo: error: --out {out}: holds an interrupted study; continue it with --resume, or choose another --out\n"
    )
    assert names(out) == before


@pytest.mark.parametrize(("name", "words"), [("figures", ["--figures"]), ("summary.json", [])])
def test_a_link_in_the_place_of_what_a_run_wrote_is_the_users(name, words, tmp_path, capsys):
    """Figures went through a link to a folder elsewhere, where no manifest lists them."""
    (tmp_path / "elsewhere").mkdir()
    out = tmp_path / "out"
    put(out, summary_json="{}", figures__fig24_pin_load_svg="")
    (out / name).rename(tmp_path / "elsewhere" / "moved")
    (out / name).symlink_to(tmp_path / "elsewhere" / "moved")
    assert main(["run", "paper", "--angles", "0", *words, "--out", str(out)]) == 2
    assert f"{name} is there" in capsys.readouterr().err
    assert (out / name).is_symlink()


def test_what_a_run_does_not_write_hinders_none(tmp_path):
    """Copies beside its files, changed files of another run, files of a run with another name."""
    out = tmp_path / "out"
    put(out, results_nc="old", optimum_toml="old")
    for name in ("optimum.toml", "fig24_pin_load_mine.svg", "search.svg", "summary.json.bak"):
        (out / name).write_text("changed by the user")
    with claimed_folder(out, "run", writes=["results.nc", *figure_files("svg", "fig24_pin_load")]):
        for name in ("results.nc", "figures/fig24_pin_load.svg"):
            with whole_file(out / name) as part:
                part.write_text("new")
    assert (out / "results.nc").read_text() == "new"
    assert (out / "fig24_pin_load_mine.svg").read_text() == "changed by the user"


@pytest.mark.parametrize(
    ("words", "name"),
    [entry for entry in COMMANDS.values() if "--sample" not in entry[0] and "--resume" not in entry[0]],
    ids=lambda one: one if isinstance(one, str) else one[0],
)
def test_what_the_user_changed_of_a_run_is_not_overwritten(words, name, tmp_path, capsys):
    """A summary.json with notes in it was overwritten: the manifest was asked for its name, not for its checksum."""
    out = tmp_path / "out"
    place = out / name
    with claimed_folder(out, "run"), whole_file(place) as part:
        part.write_text("ours")
    place.write_text("notes")
    assert main([*words, "--out", str(out)]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert f"--out {out}: {name} was changed since the last run wrote it" in said
    assert place.read_text() == "notes"


def test_a_file_of_ours_that_is_changed_while_a_run_works_is_not_overwritten(tmp_path):
    put(tmp_path, a_txt="old")

    def work():
        with claimed_folder(tmp_path, "run", writes=["a.txt"]):
            (tmp_path / "a.txt").write_text("notes")
            with whole_file(tmp_path / "a.txt") as part:
                part.write_text("ours")

    with pytest.raises(PlaceError, match="was changed since the last run"):
        work()
    assert (tmp_path / "a.txt").read_text() == "notes"


def test_a_run_killed_before_a_file_takes_its_place_leaves_none_of_the_users(tmp_path):
    """The manifest lists the new file while the old one still lies there."""
    put(tmp_path, a_txt="old")
    before = tmp_path / "a.txt"

    def end():
        with claimed_folder(tmp_path, "run", writes=["a.txt"]) as folder:
            part = tmp_path / "part"
            part.write_text("new")
            folder.place(before, part)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        end()
    assert before.read_text() == "old"
    with claimed_folder(tmp_path, "run", writes=["a.txt"]), whole_file(before) as part:
        part.write_text("third")
    assert before.read_text() == "third"


def test_a_file_that_comes_while_a_run_works_is_not_overwritten(tmp_path):
    def work():
        with claimed_folder(tmp_path, "run", writes=["a.txt"]):
            (tmp_path / "a.txt").write_text("the user's")
            with whole_file(tmp_path / "a.txt") as part:
                part.write_text("ours")

    with pytest.raises(PlaceError, match="was not written by the last run"):
        work()
    assert names(tmp_path) == ["a.txt"]
    assert (tmp_path / "a.txt").read_text() == "the user's"


def test_a_run_that_fails_leaves_the_last_one(tmp_path):
    put(tmp_path, a_txt="old", b_txt="old")
    with pytest.raises(KeyboardInterrupt), claimed_folder(tmp_path, "run"):
        raise KeyboardInterrupt
    assert names(tmp_path) == ["a.txt", "b.txt", MANIFEST]


def test_a_run_that_ends_between_two_files_leaves_nothing_of_the_last_one(tmp_path):
    put(tmp_path, a_txt="old", figures__b_txt="old")

    def end():
        with claimed_folder(tmp_path, "run"):
            with whole_file(tmp_path / "a.txt") as part:
                part.write_text("new")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        end()
    assert names(tmp_path) == ["a.txt", MANIFEST]
    assert not json.loads((tmp_path / MANIFEST).read_text())["complete"]
    put(tmp_path, c_txt="third")
    assert names(tmp_path) == ["c.txt", MANIFEST]


@pytest.mark.parametrize("name", ["../user.txt", "link/user.txt", "/user.txt", "sub/../../user.txt", ""])
def test_a_manifest_removes_nothing_outside_of_its_folder(name, tmp_path):
    """A manifest may come from anybody."""
    out, user = tmp_path / "out", tmp_path / "user.txt"
    put(out, a_txt="a")
    user.write_text("a")  # the same content, so that the checksum fits
    (out / "link").symlink_to(tmp_path)
    content = json.loads((out / MANIFEST).read_text())
    content["files"] = {name if name != "/user.txt" else str(user): content["files"]["a.txt"]}
    (out / MANIFEST).write_text(json.dumps(content))
    put(out, b_txt="b")
    assert user.exists()


@pytest.mark.parametrize("text", ["", "{", "[]", '{"cyclo": 1, "files": 3}', "[" * 100_000])
def test_a_damaged_manifest_removes_nothing(text, tmp_path):
    put(tmp_path, a_txt="a")
    (tmp_path / MANIFEST).write_text(text)
    put(tmp_path, b_txt="b")
    assert names(tmp_path) == ["a.txt", "b.txt", MANIFEST]


def test_what_a_killed_run_left_half_written_goes(tmp_path):
    half = [tmp_path / ".results.0123456789abcdef.part.nc", tmp_path / "figures" / ".a.0123456789abcdef.part.svg"]
    mine = tmp_path / ".results.part.nc"
    (tmp_path / "figures").mkdir()
    for path in [*half, mine]:
        path.write_text("half")
    put(tmp_path, a_txt="a")
    assert names(tmp_path) == [".results.part.nc", "a.txt", MANIFEST]


def test_old_parts_go_without_a_lock_too(tmp_path):
    old, new = (tmp_path / f".a.{digit * 16}.part.txt" for digit in "ab")
    for path in (old, new):
        path.write_text("half")
    os.utime(old, (0.0, os.stat(old).st_mtime - STALE - 60.0))
    with whole_file(tmp_path / "a.txt") as part:
        part.write_text("a")
    assert names(tmp_path) == [new.name, "a.txt"]


def test_a_held_folder_is_not_searched_for_parts_again(tmp_path, monkeypatch):
    """It is cleared when it is taken; a study of 20,000 batches looked through all of them for each, 19 ms a batch."""
    searched = []
    monkeypatch.setattr(files, "remove_parts_of", lambda path, age: searched.append(path.name))
    with claimed_folder(tmp_path / "out", "run"):
        for name in ("out/a.txt", "out/batches/b.txt", "elsewhere/c.txt"):
            with whole_file(tmp_path / name) as part:
                part.write_text("a")
    assert searched == ["c.txt"]
    assert names(tmp_path / "out") == ["a.txt", "batches/b.txt", MANIFEST]


def test_names_of_parts_cannot_be_foreseen_and_follow_no_link(tmp_path, monkeypatch):
    seen = set()
    for _ in range(3):
        with whole_file(tmp_path / "a.txt") as part:
            seen.add(part.name)
            part.write_text("a")
    assert len(seen) == 3
    monkeypatch.setattr("secrets.token_hex", lambda length: "0" * 16)
    (tmp_path / f".a.{'0' * 16}.part.txt").symlink_to(tmp_path / "victim")
    with pytest.raises(FaultError, match="cannot be written"), whole_file(tmp_path / "a.txt") as part:
        part.write_text("a")
    assert not (tmp_path / "victim").exists()


def test_a_folder_that_nobody_may_write_to_is_told_before_the_work(tmp_path, capsys):
    """The place of the folder is below a file, which not even root can write to."""
    (tmp_path / "file").touch()
    out = tmp_path / "file" / "out"
    for words in (
        ["run", "paper"],
        ["curves", "paper"],
        ["tolerance", "paper"],
        ["optimise", "paper", "--vary", "eccentricity=3.9:4.1", "--minimise", "max_pin_load"],
        ["mesh", "paper"],
        ["fem", "paper"],
        ["derive", "paper"],
        ["validate", "paper"],
    ):
        assert main([*words, "--out", str(out)]) == 2, words
        said = capsys.readouterr().err
        assert said.count("\n") == 1, said
        assert f"--out {out}" in said


def test_a_killed_derivation_leaves_no_part(tmp_path):
    """One of the kills of `benchmarks/faults.py` left the half-written file for a day."""
    for name in (".c.0123456789abcdef.part.nc", ".other.0123456789abcdef.part.nc"):
        (tmp_path / name).write_text("half")
    with claimed_file(tmp_path / "c.nc", "derive"):
        pass
    assert names(tmp_path) == [".other.0123456789abcdef.part.nc"]
