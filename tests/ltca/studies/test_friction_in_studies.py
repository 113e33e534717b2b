"""Studies of friction: a drive without the table gets it from its factors, and the worst sample is the least efficient."""

from __future__ import annotations

import numpy as np
import pytest
from refusals import error_says

from ltca.commands.program import main
from ltca.drive.parts import Friction
from ltca.errors import DriveError
from ltca.quantities import SCALARS
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive
from ltca.studies.quantities import quantities_for, with_what_varies

SWEEP = """
drive = "paper"
case = "CS-1"
positions = 3
quantities = ["mean_efficiency", "max_pin_load"]
[design]
kind = "grid"
[factors]
"friction.pin" = [0.0, 0.02, 0.05]
"friction.support_bearing" = [0.0, 0.01]
"friction.support_bearing_radius" = [10.0]
"""


@pytest.mark.slow
def test_a_drive_without_friction_is_studied_over_it(tmp_path, capsys):
    """`cyclo sweep` was refused: quantities were judged on the drive before its factors were applied."""
    import json

    study = tmp_path / "study.toml"
    study.write_text(SWEEP, encoding="utf-8")
    assert main(["sweep", str(study), "--out", str(tmp_path / "out"), "--no-figures"]) == 0
    summary = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    efficiency = summary["quantities"]["mean_efficiency"]
    assert efficiency["largest"] == 1.0
    assert efficiency["largest_sample"] == 0
    # "worst by efficiency" named the best sample
    worst = efficiency["smallest_sample"]
    assert worst == 5
    assert f"sample_{worst:08d}.toml" in capsys.readouterr().out


def test_quantities_of_friction_need_friction_and_a_speed():
    drive = load_drive("paper").cases["CS-1"]
    assert not {"mean_efficiency", "power_loss"} & set(quantities_for(drive, None))
    rubs = with_what_varies(drive, ["friction.pin"])
    assert rubs.friction == Friction()
    assert with_what_varies(drive, ["disc.thickness"]) is drive
    assert "mean_efficiency" in quantities_for(rubs, None)
    assert "power_loss" not in quantities_for(rubs, None)
    assert "power_loss" in quantities_for(with_fields(rubs, {"load.speed": 1500.0}), None)
    with error_says(DriveError, "mean_efficiency: ", " has no friction"):
        quantities_for(drive, ("mean_efficiency",))
    assert SCALARS["mean_efficiency"].more_is_better
    assert not any(one.more_is_better for name, one in SCALARS.items() if name != "mean_efficiency")


def test_a_coefficient_of_zero_is_a_coefficient():
    """A radius beside a support bearing that takes nothing was refused."""
    drive = load_drive("paper").cases["CS-1"]
    found = with_fields(drive, {"friction.support_bearing": 0.0, "friction.support_bearing_radius": 10.0})
    assert np.isclose(found.friction.support_bearing_radius, 10.0)
