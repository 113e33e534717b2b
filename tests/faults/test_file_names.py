"""Files named after drives and cases: different names are different files, and each fits the file system and its format."""

from __future__ import annotations

import re
from itertools import combinations
from xml.dom import minidom

import pytest
from refusals import error_says

from ltca.commands.actions import reduced_model
from ltca.commands.program import main
from ltca.drive.names import LONGEST_NAME, names_a_file
from ltca.errors import PlaceError
from ltca.export.simulators.files import file_names, model_name
from ltca.export.simulators.mujoco_model import comment
from ltca.output.file_names import shortened_file_name
from ltca.output.files import whole_file
from ltca.output.run_folder import claimed_folder
from ltca.reading.drive_file import shipped_drive

CASES = ["Spiel groß ö", "Spiel groß ä", "Spiel gro___", "a" * 120, "a" * 119 + "b", "ö" * 60, "CS.1", "CS 1"]
BESIDE = len(".") + len(".") + 16 + len(".part")
"""What `whole_file` puts about a name while it is written."""


def test_cases_with_other_signs_are_different_models():
    """Of "Spiel groß ö" and "Spiel groß ä" the second replaced the first without a word."""
    assert all(names_a_file(case) for case in CASES)
    for one, other in combinations(CASES, 2):
        assert model_name("paper", one) != model_name("paper", other)
    for case in CASES:
        assert re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", model_name("paper", case))
    assert model_name("robot-joint", "nominal") == "robot_joint_nominal"  # as it always was


@pytest.mark.parametrize("kind", ["json", "mujoco", "urdf", "modelica", "fmu"])
def test_the_longest_names_fit_while_they_are_written(kind, tmp_path):
    """Names of 118 letters failed after the work: "File name too long"."""
    for name in file_names(kind, model_name("d" * LONGEST_NAME, "c" * LONGEST_NAME)):
        assert len(name) + BESIDE <= 255
        with whole_file(tmp_path / name) as part:
            part.write_text("written")
        assert (tmp_path / name).exists()


def test_a_cut_name_tells_what_was_cut():
    for most in (20, 60):
        names = {shortened_file_name("ä" * 60 + end, most) for end in "abc"}
        assert len(names) == 3
        assert all(len(name.encode()) <= most for name in names)


@pytest.fixture
def drives(tmp_path):
    """Two drive files whose cases have one name in files: "a_b" with "c", and "a" with "b_c"."""
    head = shipped_drive().split("[[case]]")[0].replace('direction = "ccw" ', 'speed = 1500.0\ndirection = "ccw" ', 1)
    for name, case in (("a_b", "c"), ("a", "b_c")):
        (tmp_path / f"{name}.toml").write_text(
            re.sub(r'(?m)^name = "paper"', f'name = "{name}"', head) + f'[[case]]\nname = "{case}"\n', encoding="utf-8"
        )
    return tmp_path


def test_a_file_made_from_another_case_is_not_replaced(drives, capsys, monkeypatch):
    monkeypatch.setattr(reduced_model, "reduce_drive", lambda *_: pytest.fail("the computation has started"))
    out, first = drives / "out", drives / "out" / "a_b_c.mo"
    origins = {first.name: "drive a_b, case c"}
    with claimed_folder(out, "export", adding=True, origins=origins), whole_file(first) as part:
        part.write_text("a model")
    words = ["--for", "modelica", "--compliance", "half-space", "--out", str(out)]
    assert main(["export", str(drives / "a.toml"), *words]) == 2
    said = capsys.readouterr().err
    assert "a_b_c.mo was made from drive a_b, case c, drive a, case b_c would replace it: choose another --out" in said
    assert said.count("\n") == 1
    assert first.read_text() == "a model"


@pytest.mark.parametrize("first", [("a-b", "c"), ("a_b", "c")])
def test_names_that_differ_in_a_hyphen_are_one_model_and_refused_in_one_folder(first, tmp_path, capsys, monkeypatch):
    """ "a-b" with "c" and "a_b" with "c" are both "a_b_c": the second run into a folder ends before its work."""
    monkeypatch.setattr(reduced_model, "reduce_drive", lambda *_: pytest.fail("the computation has started"))
    second = {"a-b": "a_b", "a_b": "a-b"}[first[0]]
    head = shipped_drive().split("[[case]]")[0].replace('direction = "ccw" ', 'speed = 1500.0\ndirection = "ccw" ', 1)
    cases = '[[case]]\nname = "c"\n'
    (tmp_path / "d.toml").write_text(
        re.sub(r'(?m)^name = "paper"', f'name = "{second}"', head) + cases, encoding="utf-8"
    )
    model = tmp_path / "out" / "a_b_c.mo"
    origins = {model.name: f"drive {first[0]}, case c"}
    with claimed_folder(model.parent, "export", adding=True, origins=origins), whole_file(model) as part:
        part.write_text("a model")
    words = ["--for", "modelica", "--compliance", "half-space", "--out", str(model.parent)]
    assert main(["export", str(tmp_path / "d.toml"), *words]) == 2
    said = capsys.readouterr().err
    assert f"a_b_c.mo was made from drive {first[0]}, case c, drive {second}, case c would replace it" in said
    assert model.read_text() == "a model"


def test_cases_of_one_file_that_differ_in_a_hyphen_are_refused_in_one_folder(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(reduced_model, "reduce_drive", lambda *_: pytest.fail("the computation has started"))
    head = shipped_drive().split("[[case]]")[0].replace('direction = "ccw" ', 'speed = 1500.0\ndirection = "ccw" ', 1)
    cases = '[[case]]\nname = "x-y"\n[[case]]\nname = "x_y"\n'
    (tmp_path / "d.toml").write_text(head + cases, encoding="utf-8")
    model = tmp_path / "out" / "paper_x_y.mo"
    origins = {model.name: "drive paper, case x-y"}
    with claimed_folder(model.parent, "export", adding=True, origins=origins), whole_file(model) as part:
        part.write_text("a model")
    words = ["--for", "modelica", "--compliance", "half-space", "--out", str(model.parent), "--case", "x_y"]
    assert main(["export", str(tmp_path / "d.toml"), *words]) == 2
    assert "made from drive paper, case x-y, drive paper, case x_y would replace it" in capsys.readouterr().err


def test_cases_that_differ_in_capitals_were_one_file_on_windows_and_macos():
    cases = ["loose", "Loose", "LOOSE", "tight"]
    names = [model_name("paper", case, cases) for case in cases]
    for kind in ("json", "mujoco", "urdf", "modelica", "fmu"):
        own = [file_names(kind, name)[0] for name in names]
        assert len({name.casefold() for name in own}) == len(cases)
    assert names[-1] == "paper_tight"  # alone of its kind, it keeps its name
    assert all(re.fullmatch(r"paper_[A-Za-z]+_[0-9a-f]{12}", name) for name in names[:-1])


@pytest.mark.parametrize(
    "command", [["--for", "modelica", "--compliance", "half-space"], ["--format", "csv", "--part", "disc"]]
)
def test_a_file_named_alike_but_for_capitals_is_not_written_beside_another(command, tmp_path, capsys, monkeypatch):
    """Files of the drives "Joint" and "joint" in one folder are one file after a copy to Windows or macOS."""
    monkeypatch.setattr(reduced_model, "reduce_drive", lambda *_: pytest.fail("the computation has started"))
    head = shipped_drive().split("[[case]]")[0].replace('direction = "ccw" ', 'speed = 1500.0\ndirection = "ccw" ', 1)
    cases, out = '[[case]]\nname = "c"\n', tmp_path / "out"
    (tmp_path / "d.toml").write_text(re.sub(r'(?m)^name = "paper"', 'name = "joint"', head) + cases, encoding="utf-8")
    model = "Joint_c.mo" if command[0] == "--for" else "Joint_c_disc_flank.csv"
    with (
        claimed_folder(out, "export", adding=True, origins={model: "drive Joint, case c"}),
        whole_file(out / model) as part,
    ):
        part.write_text("a model")
    assert main(["export", str(tmp_path / "d.toml"), *command, "--out", str(out)]) == 2
    said = capsys.readouterr().err
    assert f"{model} was made from drive Joint, case c, drive joint, case c would replace it by joint_c" in said
    assert "on Windows and macOS: choose another --out" in said


def test_a_file_of_the_same_case_is_replaced_and_its_origin_kept(tmp_path):
    picture = tmp_path / "drive_a.png"
    for text in ("first", "second"):
        origins = {picture.name: "drive d, case a"}
        with claimed_folder(tmp_path, "show", adding=True, origins=origins), whole_file(picture) as part:
            part.write_text(text)
    assert picture.read_text() == "second"
    beside = tmp_path / "drive_b.png"
    origins = {beside.name: "drive d, case b"}
    with claimed_folder(tmp_path, "show", adding=True, origins=origins), whole_file(beside) as part:
        part.write_text("third")
    other = {picture.name: "drive e, case a"}
    told = "drive_a.png was made from drive d, case a, drive e, case a would replace it"
    with (
        error_says(PlaceError, told),
        claimed_folder(tmp_path, "show", writes=[picture.name], adding=True, origins=other),
    ):
        pass


@pytest.mark.parametrize("name", ["a---b", "a--", "<&\"'>", "ö"])
def test_names_are_sound_in_a_comment_of_xml(name):
    """Three hyphens ended it."""
    minidom.parseString(f"<!-- {comment(name)}. --><a/>")
