"""What is shown of a drive file, where a change goes, and what is answered."""

from __future__ import annotations

import json
import math
import re

import numpy as np
import pytest

from ltca.analysis.extremes import RESOLVED, sampling, sampling_warning
from ltca.commands.program import main
from ltca.drive.declaration import declared_fields
from ltca.geometry.placement import position_angles
from ltca.reading.arguments import SHIPPED_DRIVES
from ltca.reading.drive_file import load_drive, parse_drive, shipped_drive
from ltca.studio.answers import (
    CACHED,
    COARSE,
    DERIVATIVE,
    FINE,
    Memory,
    Question,
    _signed,
    answer,
    coarse_angles,
    problem_of,
)
from ltca.studio.sections import changed_text, declarations, files_elsewhere, written_values

PAPER = shipped_drive("paper")


def asked(text=PAPER, quality=COARSE, case="CS-3", **more):
    return Question(text=text, source="paper", case=case, quality=quality, **more)


def test_every_declared_field_is_on_the_page_with_its_unit_and_meaning():
    shown = {field["path"]: field for table in declarations()["tables"].values() for field in table["fields"]}
    for path, field in declared_fields().items():
        assert shown[path]["unit"] == field.label
        assert shown[path]["meaning"]
    assert set(declarations()["turned"]) <= set(shown)


@pytest.mark.parametrize("name", SHIPPED_DRIVES)
def test_every_value_that_is_written_has_a_field(name):
    known = {field["path"] for table in declarations()["tables"].values() for field in table["fields"]}
    written = written_values(shipped_drive(name), "CS-1")["values"]
    plain = {re.sub(r"\.\d+(?=\.|$)", ".N", path) for path in written}
    assert {path for path in plain - known if not path.endswith(".preload")} == set()


def test_a_field_of_the_case_is_changed_in_the_case_and_others_for_all():
    text = changed_text(
        PAPER, "CS-3", {"clearance.bearing": "0.04", "disc.shifting_offset": "0.1", "materials.disc.like": "PA12"}
    )
    before, after = parse_drive(PAPER, "paper").cases, parse_drive(text, "paper").cases
    assert [after[name].clearance.bearing - drive.clearance.bearing for name, drive in before.items()] == pytest.approx(
        [0, 0, 0.01, 0, 0, 0]
    )
    assert {drive.disc.shifting_offset for drive in after.values()} == {0.1}
    assert 'disc = { like = "PA12", youngs_modulus' in text
    left_out = changed_text(text, "CS-3", {"clearance.pin_hole": ""})
    assert "clearance = { bearing = 0.04 }" in left_out


def test_mistakes_name_their_fields():
    assert problem_of("case CS-1: pin_wheel.pin_radius = -3: must be greater than 0 mm")["fields"] == [
        "pin_wheel.pin_radius"
    ]
    assert problem_of("disc.thicknes: is not a field of the drive definition; did you mean `thickness`?")["fields"] == [
        "disc.thicknes"
    ]
    assert problem_of("some words without any")["fields"] == []


def test_measured_flanks_are_of_the_folder(tmp_path):
    def told(name):
        return files_elsewhere(f"[[disc.of]]\nmeasured_flank = {json.dumps(name)}\n", tmp_path / "mine.toml")

    (tmp_path / "link").symlink_to("/etc")
    assert told("flank.csv") == told("below/flank.csv") == []
    for name in ("/etc/passwd", "../flank.csv", "link/passwd", "\x00"):
        assert "must be a file in the folder of the studio" in told(name)[0]


@pytest.mark.parametrize("name", SHIPPED_DRIVES)
def test_coarse_positions_see_enough_of_the_mesh(name):
    drive = next(iter(load_drive(name).cases.values()))
    assert sampling(drive, coarse_angles(drive)).distinct_mesh_phases >= RESOLVED
    assert coarse_angles(drive).size <= 36


def values_of(found):
    """Full numbers of the verdict, in the order of the page."""
    text = found["html"]["verdict"].replace("−", "-")
    cells = re.findall(r'data-value="(-?[0-9.e+-]+)"|<b>(-?[0-9.e+-]+)</b>', text)
    return [float(full or shown) for full, shown in cells]


@pytest.mark.slow
def test_a_fine_answer_is_that_of_the_command(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = changed_text(PAPER, "CS-3", {"disc.shifting_offset": "0.12"})
    (tmp_path / "mine.toml").write_text(text, encoding="utf-8")
    assert main(["check", "mine.toml", "--case", "CS-3", "--no-advice", "--no-page", "--out", "out"]) in (0, 1)
    checks = json.loads((tmp_path / "out" / "check.json").read_text())["cases"]["CS-3"]
    found = values_of(answer(asked(text, FINE), Memory()))
    known = [one["value"] for one in checks if one["value"] is not None and one["limit"] is not None]
    assert known
    # The command and the studio solve the same positions by the same functions: round-off of sums.
    for value in known:
        assert any(math.isclose(value, one, rel_tol=1e-9) for one in found), value


JOINT = shipped_drive("robot-joint")
DECIDES = "half-spaces: cyclo check decides on hybrid"


def asked_joint(quality, text=JOINT, compliance=CACHED):
    return answer(
        Question(text=text, source="robot-joint", case="nominal", quality=quality, compliance=compliance), Memory()
    )


def test_a_verdict_on_half_spaces_says_that_the_check_decides_on_hybrid():
    """The studio said that all values keep their limits where `check` fails the bore."""
    assert asked_joint(COARSE)["caution"] == DECIDES
    plain = changed_text(JOINT, "nominal", {"analysis.compliance": "half-space"})
    assert asked_joint(COARSE, plain)["caution"].startswith("half-spaces: about 24 % too stiff here")


@pytest.mark.slow
def test_a_fine_answer_is_on_what_the_file_says_where_its_coefficients_are_there():
    """`robot-joint` says nothing of its bodies: hybrid, whose coefficients come with the package."""
    found = asked_joint(FINE)
    assert (found["model"], found["caution"]) == ("hybrid", "")
    assert asked_joint(FINE, compliance="half-space")["caution"] == DECIDES


@pytest.mark.slow
def test_a_fine_answer_derives_nothing_unless_asked(monkeypatch):
    """A shape without coefficients is answered on half-spaces, at once."""

    def derived(*_, **__):
        raise AssertionError("coefficients are derived")

    monkeypatch.setattr("ltca.analysis.engines.find_coefficients", derived)
    found = asked_joint(FINE, changed_text(JOINT, "nominal", {"pin_shaft.hole_radius": "6.1"}))
    assert found["model"].startswith("half-space")
    assert found["caution"] == DECIDES


def test_a_coarse_answer_from_poses_near_by_is_that_from_nothing():
    memory = Memory()
    answer(asked(), memory)
    text = changed_text(PAPER, "CS-3", {"disc.shifting_offset": "0.093", "load.torque": "350000"})
    warm = answer(asked(text), memory)
    cold = answer(asked(text), Memory())
    # Forces balance within 1e-9 of the largest; values follow them.
    assert np.allclose(values_of(warm), values_of(cold), rtol=1e-6)
    assert warm["positions"] == 36


@pytest.mark.slow
def test_a_derivative_is_told_for_a_small_change():
    found = answer(asked(quality=DERIVATIVE, field="load.torque"), Memory())
    assert found["step"] == "1 N·m"
    (change,) = [cell["value"] for cell in found["cells"] if cell["title"].startswith("bearing load, mean")]
    ends = []
    for torque in ("376300", "378300"):
        beside = answer(asked(changed_text(PAPER, "CS-3", {"load.torque": torque})), Memory())
        ends += [one["value"] for one in beside["summary"] if one["key"] == "mean_bearing_load_N"]
    # Of a difference over ±0.3 % of the torque, the third derivative makes less than 1e-3 while no contact opens.
    assert change == pytest.approx((ends[1] - ends[0]) / 2.0, rel=1e-3)
    assert found["cells"][0]["title"] == "lost motion"
    assert re.search(
        r"Lost motion at ±3 % of the torque, mean of 4 crank angles over one mesh: \d+\.\d{3}′", found["note"]
    )


def test_small_changes_are_told_by_powers_of_ten_and_round_off_as_none():
    assert [_signed(change, 10.0) for change in (0.12345, -7.163e-7, 1e-9, -12345.0)] == [
        "+0.123",
        "−7.16·10⁻⁷",
        "0",
        "−12300",
    ]


def test_mistakes_and_drives_without_an_answer_are_told():
    wrong = answer(asked(PAPER.replace("pin_radius = 6.5", "pin_radius = -6.5")), Memory())
    assert wrong["problems"][0]["fields"] == ["pin_wheel.pin_radius"]
    assert answer(asked(quality=DERIVATIVE, field="name"), Memory())["problems"][0]["text"].startswith(
        "name: must be a real number"
    )


def test_the_studio_named_an_option_that_it_has_not():
    """ "take --positions 17" stood among the warnings of the studio, which has no such option."""
    drive = load_drive("paper").cases["CS-1"]
    told = sampling_warning(drive, position_angles(13), typed="")
    assert told is not None
    assert told.endswith("values over them alone say little of the turn")
    assert sampling_warning(drive, position_angles(13)).startswith(f"{told}; take --positions ")


@pytest.mark.parametrize("quality", [COARSE, FINE, DERIVATIVE])
@pytest.mark.parametrize("torque", ["1e9", "1e15"])
def test_a_torque_beyond_the_bound_of_a_run_had_no_answer_in_minutes(quality, torque):
    text = re.sub(r"(?m)^torque = .*$", f"torque = {torque}", PAPER)
    found = answer(asked(text, quality, field="crank.eccentricity"), Memory())
    (problem,) = found["problems"]
    assert "must be at most 1.08e+08 N·mm" in problem["text"]
    assert problem["fields"] == ["load.torque"]
