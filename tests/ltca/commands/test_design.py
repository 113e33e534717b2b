"""``cyclo design``: what it writes passes `cyclo check`; where nothing fits, what would do does."""

import json
from pathlib import Path

import pytest

from ltca.commands.program import main
from ltca.reading.drive_file import load_drive
from ltca.studies.design_search import refinement, search

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


def test_bad_input_ends_with_two(tmp_path, capsys):
    path = tmp_path / "wrong.toml"
    path.write_text("ratio = 39\ntorque = -1.0\nspeed = 15.0\nouter_diameter = 100.0\nlength = 20.0\n")
    assert main(["design", str(path), "--out", str(tmp_path / "out")]) == 2
    assert "torque = -1.0: must be greater than 0 N·mm" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
