"""One disc with errors given as its own is the drive with these errors, whatever its contacts are like."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import numpy as np
import pytest

import fem
import ltca
import validation
from ltca.analysis.loaded_analysis import analyse
from ltca.drive.single_discs import is_single
from ltca.reading.drive_file import parse_drive, shipped_drive
from validation.methods.grids import GridCompliance

RUNOUT = 'runout = { amount = 0.005, angle = "30 deg" }'
ANGLE = np.array([0.0, 1.6 * np.pi])


def wide(disc="", crank=""):
    """The joint with one disc whose lobes are so sharp that its contacts leave their parabola."""
    text = shipped_drive("robot-joint")
    for old, new in (
        ("eccentricity = 1.0 ", f"{crank}\neccentricity = 1.4 "),
        ("hole_radius = 6.0 ", "hole_radius = 6.4 "),
        ("number_of_discs = 2 ", f"{disc}\nnumber_of_discs = 1 "),
        ("phases = [", "# "),
        ("planes = [", "# "),
        ('torque = "400 N m"', 'torque = "2000 N m"'),
    ):
        assert old in text
        text = text.replace(old, new, 1)
    return parse_drive(text).cases["nominal"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("own", "common"),
    [
        ({"disc": f"of = [{{ {RUNOUT} }}]"}, {"disc": RUNOUT}),
        ({"crank": "of = [{ eccentricity_error = 0.003 }]"}, {"crank": "eccentricity_error = 0.003"}),
    ],
)
def test_one_disc_with_errors_of_its_own_and_wide_contacts(own, common, monkeypatch):
    """It was solved and then refused: "disc.number_of_discs = 1: must be 1 here, … see ltca.drive.single_discs"."""
    solved_on = []
    grids = GridCompliance.of_drive
    monkeypatch.setattr(GridCompliance, "of_drive", lambda drive: solved_on.append(drive) or grids(drive))
    one, other = (analyse(wide(**errors), ANGLE) for errors in (own, common))
    assert one.warnings == other.warnings
    assert [is_single(drive) for drive in solved_on] == [
        True,
        True,
    ]  # so wide that grids were asked, of one disc's drive
    # The same equations: equal to the last bit.
    assert np.array_equal(one.full.response.pin_load, other.full.response.pin_load)


@pytest.mark.slow
def test_no_message_names_a_module():
    """The refusal sent its reader to "ltca.drive.single_discs"."""
    named = re.compile(r"\b(ltca|fem|validation)\.[a-z_]+\.?[a-z_]*")
    found = []
    for package in (ltca, fem, validation):
        for path in Path(package.__file__).parent.rglob("*.py"):
            for raised in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if isinstance(raised, ast.Raise):
                    texts = [node.value for node in ast.walk(raised) if isinstance(node, ast.Constant)]
                    found += [f"{path.name}: {one}" for one in texts if isinstance(one, str) and named.search(one)]
    assert found == []
