"""`ltca.check`: the verdict of ``cyclo check``, limits of the file among it."""

from __future__ import annotations

import json

import numpy as np
import pytest
from refusals import error_says

import ltca
from ltca.commands.program import main
from ltca.drive.members.verdict_words import check_content
from ltca.errors import DriveError
from ltca.reading.drive_file import load_drive, shipped_drive

FILE = load_drive("paper")
LIMITS = """[limits]
max_pin_pressure_mid = { value = "1300 MPa", source = "drawing" }
min_backlash_output = 3.0
"""


@pytest.fixture(scope="module")
def mine(tmp_path_factory):
    """A drive file with limits of its own that the drive does not keep."""
    path = tmp_path_factory.mktemp("check") / "mine.toml"
    text = shipped_drive().partition("[[case]]")[0].replace('name = "paper"', 'name = "mine"')
    path.write_text(text.replace("[limits]\n", LIMITS), encoding="utf-8")
    return path


@pytest.mark.slow
def test_it_is_the_verdict_of_the_command(mine, tmp_path):
    """Limits of the file count: one drive alone would pass here, and the command fails."""
    words = ["check", str(mine), "--positions", "8", "--no-advice", "--no-page", "--out", str(tmp_path / "out")]
    assert main(words) == 1
    kept = json.loads((tmp_path / "out" / "check.json").read_text(encoding="utf-8"))
    file = ltca.load_drive(mine)
    found = ltca.check(file, 8, advice=False)
    told = json.loads(json.dumps([check_content(check, "nominal") | {"drivers": []} for check in found.checks]))
    assert told == kept["cases"]["nominal"]
    assert [*found.notes] == kept["notes"]["nominal"]
    assert not found.passes
    assert [check.value.quantity for check in found.failed] == ["pin_pressure_mid"]
    pressure = found["pin_pressure_mid"]
    assert pressure.limit.source == "drawing"
    assert pressure.safety == pytest.approx(1300.0 / pressure.value.value, rel=1e-12)  # rounding
    # of one drive alone the limits are those of its materials and those given
    assert ltca.check(file.cases["nominal"], 8, advice=False).passes
    same = ltca.check(file.cases["nominal"], 8, limits=file.limits["nominal"], advice=False)
    assert same.checks == found.checks
    own = ltca.check(file, 8, limits={"max_pin_pressure_mid": "1.5 GPa"}, advice=False)
    assert own.passes
    assert own["pin_pressure_mid"].limit.value == 1500.0


def test_it_prints_itself():
    found = ltca.check(FILE, 8, case="CS-3", torque="200 N·m", advice=False)
    lines = repr(found).splitlines()
    assert lines[0] == "paper CS-3, 200 N·m ccw: judged by half-space (tables), 8 positions"
    assert sum(line.startswith("  flank pressure ") for line in lines) == 1
    assert found.torque == 200_000.0
    with pytest.raises(KeyError):
        found["pin_pressure"]


@pytest.mark.slow
def test_advice_names_the_torque_of_a_load_that_is_too_much():
    """Flank pressure follows the torque by a power near 1/2, between 1/3 of a point and 1/2 of a line."""
    found = ltca.check(FILE, 4, case="CS-1", limits={"max_pin_pressure_mid": 1000.0})
    driver = next(one for one in found.drivers["pin_pressure_mid"] if one.input == "load.torque")
    assert 1.0 / 3.0 < driver.elasticity < 0.55  # the number of loaded pins grows with the torque, too
    assert "load.torque: " in found.advice
    assert found.advice in f"{found!r}\n"


@pytest.mark.slow
def test_temperatures_of_a_drive_count():
    cold = FILE.cases["CS-3"]
    warm = cold.with_fields({"temperature.disc": "70 °C"})
    plays = [ltca.check(one, 4, advice=False)["backlash_output"].value.value for one in (cold, warm)]
    assert plays[1] < plays[0]  # the disc grows between the pins


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"case": None}, "case: must be given, one of CS-1, CS-2"),
        ({"case": "CS-9"}, "case 'CS-9' is not defined"),
        ({"drive": FILE.cases["CS-1"]}, "case = 'CS-1': has no effect with one Drive"),
        ({"drive": "paper", "case": None}, "drive: must be one Drive, not a str"),
        (
            {"limits": {"max_pin_pressure": 3.0}},
            "limits.max_pin_pressure: is no limit; …did you mean `max_pin_pressure_mid`",
        ),
        ({"limits": {"max_pin_pressure_mid": "3 N"}}, "limits.max_pin_pressure_mid = '3 N': must have the unit MPa"),
        ({"limits": 5}, "limits = 5: must be limits by name"),
        ({"torque": "3 mm"}, "torque = '3 mm': must have the unit N·mm"),
        ({"torque": -1}, "torque = -1: must be finite and at least 0 N·mm"),
        ({"positions": 1}, "positions = 1: must be a whole number from 2 to 100000"),
        ({"advice": 1}, "advice = 1: must be true or false"),
        ({"compliance": "soft"}, "compliance = 'soft': is unknown"),
        (
            {"coefficients": "x.nc", "compliance": "half-space"},
            "coefficients: has no effect with compliance half-space",
        ),
    ],
)
def test_what_makes_no_sense_is_refused_by_name(options, message):
    with error_says(DriveError, *message.split("…")):
        ltca.check(**({"drive": FILE, "case": "CS-1"} | options))


@pytest.mark.slow
def test_what_is_judged_is_what_was_analysed():
    drive = FILE.cases["CS-3"]
    found = ltca.check(drive, 8, advice=False)
    largest = ltca.analyse(drive, 8, compliance=found.engine).dataset["pin_shaft_load"]
    value = found["pin_shaft_load"].value
    assert value.value >= float(largest.max())  # between positions it may be more
    assert np.isclose(value.crank_angle % (2.0 * np.pi / 8.0), 0.0) or value.value > float(largest.max())
