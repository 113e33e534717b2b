"""``cyclo design``: what it writes passes `cyclo check`; where nothing fits, what would do does."""

import json
import re
import shlex
import tomllib
from pathlib import Path

import pytest

from ltca.commands.design import _write
from ltca.commands.program import main
from ltca.output.files import whole_file
from ltca.output.run_folder import claimed_folder
from ltca.reading.drive_file import load_drive
from ltca.studies.design_search import refinement, search
from ltca.studies.design_search.refinement import Refined
from ltca.studies.design_search.requirement_file import parse_requirements
from ltca.studies.design_search.requirement_words import requirement_warnings
from ltca.studies.design_search.requirements import REQUIRED
from ltca.studies.design_search.solution import Solution

EXAMPLES = Path(__file__).parents[3] / "examples" / "requirements"


@pytest.fixture
def few(monkeypatch):
    """Fewer candidates and solutions of each: the first ones of these files do."""
    monkeypatch.setattr(search, "CANDIDATES", 2)
    monkeypatch.setattr(search, "RELAXED_CANDIDATES", 1)
    monkeypatch.setattr(refinement, "MAX_COARSE_SOLUTIONS", 2)
    monkeypatch.setattr(search, "MAX_ENUMERATIONS", 1)


def passes_check(path, out):
    return main(["check", str(path), "--no-advice", "--out", str(out)]) == 0


@pytest.mark.slow
@pytest.mark.usefixtures("few", "coarse_derivations")
def test_the_paper_drive_is_matched_at_its_own_figures(tmp_path):
    out = tmp_path / "out"
    assert main(["design", str(EXAMPLES / "possible-paper.toml"), "--best", "1", "--out", str(out)]) == 0
    told = json.loads((out / "design.json").read_text())
    assert told["verdict"] == "fits"
    (design,) = told["designs"]
    assert not list(out.glob("candidate-*"))  # they are kept while the search goes on
    assert design["values"]["outer_diameter"] <= 189.0
    assert design["values"]["pin_pressure_mid"] <= 1390.8
    assert design["values"]["bearing_life_million_turns"] >= 1397.0
    drive = load_drive(out / design["file"]).cases["nominal"]
    assert (drive.load.torque, drive.reduction_ratio, drive.wheel_is_held) == (377_300.0, 14.0, False)
    assert passes_check(out / design["file"], tmp_path / "check")
    page = (out / "report.html").read_text()
    assert page.count("<svg") == 1
    assert "flank pressure" in page
    for name in ("http://www.w3.org/2000/svg", "http-equiv"):  # names, nothing that is fetched
        page = page.replace(name, "")
    assert "http" not in page


@pytest.mark.nightly
@pytest.mark.slow
@pytest.mark.usefixtures("few", "coarse_derivations")
def test_what_stands_in_the_way_is_told_and_would_do(tmp_path, capsys):
    out = tmp_path / "out"
    assert main(["design", str(EXAMPLES / "impossible-diameter.toml"), "--out", str(out)]) == 1
    printed = capsys.readouterr().out
    assert "nothing fits" in printed
    told = json.loads((out / "design.json").read_text())
    assert told["designs"] == []
    way = {one["requirements"][0]["name"]: one for one in told["in_the_way"]}
    assert {"outer_diameter", "length", "torque", "shop.equidistant_offset"} == set(way)
    (diameter,) = way["outer_diameter"]["requirements"]
    assert diameter["would_do"] > diameter["asked"] == 95.0
    # Torques grow with the cube of the size at equal stress, and a disc that grows in diameter alone gains its square.
    assert diameter["would_do"] < 2.0 * diameter["asked"]
    assert passes_check(out / way["outer_diameter"]["file"], tmp_path / "check")


def test_an_interrupted_search_keeps_what_it_has_found(tmp_path, monkeypatch, capsys):
    """Nothing of 165 s was there, beside the report of an earlier search, which was taken for the answer."""
    out, path = tmp_path / "out", tmp_path / "joint.toml"
    path.write_text(
        'ratio = 19\ntorque = "60 N m"\nspeed = 15.0\nouter_diameter = 150.0\nlength = 15.0\ndiscs = 1\n[shop]\n'
        "eccentricities = [1.5, 2.0]\nwheel_pins = [8.0]\nshaft_pins = [8.0]\nrollers = [[6.0, 10.0]]\n"
    )
    with claimed_folder(out, "design"), whole_file(out / "report.html") as part:
        part.write_text("earlier")

    def refine(task, most=0):
        values = {"outer_diameter": 149.0, "length": 14.0, "torque": 60_000.0, "pin_pressure_mid": 900.0}
        return Refined(
            row=task.row, solution=Solution(values=values), fits=True, given=0.0, broken={}, relaxed=(), solved=1, shifts={},
        )  # fmt: skip

    def interrupted(task):
        assert not (out / "report.html").exists()
        raise KeyboardInterrupt

    monkeypatch.setattr(search, "refine", refine)
    monkeypatch.setattr(search, "finish", interrupted)
    monkeypatch.setattr(search, "CANDIDATES", 2)
    assert main(["design", str(path), "--best", "1", "--out", str(out)]) == 130
    assert f"what it has found is kept in {out}: candidate-1.toml, candidate-2.toml" in capsys.readouterr().err
    assert sorted(file.name for file in out.glob("*.*")) == [
        "candidate-1.toml", "candidate-2.toml", "cyclo-manifest.json", "design.json",
    ]  # fmt: skip
    text = (out / "candidate-1.toml").read_text()
    assert "a candidate that no `cyclo check` has judged yet" in text
    assert "100Cr6 for disc" in text
    assert load_drive(out / "candidate-1.toml").cases["nominal"].reduction_ratio == 20.0
    assert json.loads((out / "design.json").read_text())["verdict"] == "search not finished"


def test_an_infeasible_answer_asks_for_the_speed_of_the_motor(tmp_path, capsys):
    """2000 rpm of a motor as the speed of the output stood in the way of all, and no line named it."""
    requirements = parse_requirements(starting_file().replace("34 rpm", "2000 rpm"))
    found = search.Found(
        requirements=requirements, demands=(), designs=(), tried=(), relaxations=(), combinations=7, solved=2,
    )  # fmt: skip
    _write(found, 1, tmp_path)
    printed = capsys.readouterr().out
    assert printed.startswith("joint, 1:59, 200 N·m and 2000 rpm at the output: 7 combinations")
    asked = "speed = 2000 rpm at the output: the input would turn at 118,000 rpm. Is speed that of the output?"
    assert f"look first at: {asked}" in printed
    assert asked in (tmp_path / "report.html").read_text(encoding="utf-8")
    (warning,) = json.loads((tmp_path / "design.json").read_text(encoding="utf-8"))["warnings"]
    assert warning.startswith(asked)


DESIGN, ROBOT_JOINT = (Path(__file__).parents[3] / "docs" / "how-to" / name for name in ("design.md", "robot_joint.md"))


def starting_file():
    """The requirement file that the page begins with."""
    return re.findall(r"```toml\n(.*?)```", DESIGN.read_text(encoding="utf-8"), flags=re.DOTALL)[0]


def test_the_file_to_start_from_is_complete():
    """There was none on the page, and what is left out of one had no strength."""
    requirements = parse_requirements(starting_file())
    assert requirements.assumed_materials == {}
    assert requirement_warnings(requirements) == []
    assert set(REQUIRED) <= set(tomllib.loads(starting_file()))


@pytest.mark.slow
@pytest.mark.nightly
@pytest.mark.needs("robotics")
def test_from_a_ratio_to_an_arm_as_it_is_printed(tmp_path, monkeypatch):
    """A newcomer's design had no density, so that no simulator took it."""
    import mujoco

    monkeypatch.chdir(tmp_path)
    Path("requirements.toml").write_text(starting_file(), encoding="utf-8")
    page = ROBOT_JOINT.read_text(encoding="utf-8").partition("## From a ratio")[2]
    (commands,), (script,) = (re.findall(rf"```{kind}\n(.*?)```", page, flags=re.DOTALL) for kind in ("sh", "python"))
    for command in commands.splitlines():
        assert main(shlex.split(command)[1:]) == 0
    names: dict[str, mujoco.MjModel] = {}
    exec(compile(script, str(ROBOT_JOINT), "exec"), names)
    assert (names["model"].nv, names["alone"].nv) == (2, 1)


def test_bad_input_ends_with_two(tmp_path, capsys):
    path = tmp_path / "wrong.toml"
    path.write_text("ratio = 39\ntorque = -1.0\nspeed = 15.0\nouter_diameter = 100.0\nlength = 20.0\n")
    assert main(["design", str(path), "--out", str(tmp_path / "out")]) == 2
    assert "torque = -1.0: must be greater than 0 N·mm" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
