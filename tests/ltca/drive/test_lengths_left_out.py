"""Lengths that follow others where they are left out: planes of the discs, rollers, spans of bending pins."""

from __future__ import annotations

import numpy as np
import pytest
from refusals import refused_field

from ltca.analysis.loaded_analysis import analyse
from ltca.drive.fields import read_field
from ltca.drive.members.temperatures import warm_drive
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import parse_drive, shipped_drive
from ltca.reading.writing import drive_text

LEFT_OUT = {
    "disc.gap": 2.0,
    "crank_bearing.roller_length": None,
    "pin_wheel.beam.span": None,
    "pin_shaft.beam.span": None,
}


def sleeved(changes):
    (drive,) = parse_drive(shipped_drive("sleeved"), "sleeved").cases.values()
    return with_fields(drive, changes)


@pytest.mark.slow
@pytest.mark.parametrize("discs", [2, 3])
def test_a_drive_with_lengths_left_out_is_that_with_them(discs):
    """Three discs of 10 mm, 2 mm apart: planes −12, 0, 12 mm; the pins reach 2 mm beyond the faces at ±17 mm, span 38 mm.

    The middle disc alone would span 14 mm. The same numbers to the last bit.
    """
    number = {"disc.number_of_discs": discs, "load.torque": 250e3 * discs}
    planes = {2: (-6.0, 6.0), 3: (-12.0, 0.0, 12.0)}[discs]
    span = 2.0 * (planes[-1] + 5.0 + 2.0)
    following = sleeved(number | LEFT_OUT)
    given = sleeved(
        number
        | {"disc.planes": planes, "crank_bearing.roller_length": 10.0}
        | {"pin_wheel.beam.span": span, "pin_shaft.beam.span": span}
    )
    assert read_field(following, "disc.planes") == planes
    assert (following.roller_length, following.wheel_pin_span, following.shaft_pin_span) == (10.0, span, span)
    angles = np.array([0.3])
    one, other = analyse(following, angles), analyse(given, angles)
    np.testing.assert_array_equal(one.full.pose, other.full.pose)
    np.testing.assert_array_equal(one.pressures.outer.mid, other.pressures.outer.mid)


def test_lengths_follow_the_thickness():
    drive = with_fields(sleeved(LEFT_OUT), {"disc.thickness": 14.0})
    assert drive.disc.disc_planes == (-8.0, 8.0)
    assert (drive.roller_length, drive.wheel_pin_span) == (14.0, 34.0)
    assert parse_drive(drive_text(drive)).cases["nominal"] == drive


def test_lengths_follow_in_the_warm():
    """Discs of one material at one temperature: rollers stay as long as the disc is thick, discs as far apart as they grow."""
    warmed = {f"temperature.{part}": 120.0 for part in ("housing", "disc", "shaft")}
    warm = warm_drive(sleeved(LEFT_OUT | warmed))
    grown = 1.0 + 11.4e-6 * 100.0  # 100Cr6
    assert warm.roller_length == warm.disc.thickness == pytest.approx(10.0 * grown, rel=1e-12)
    assert warm.disc.disc_planes[1] == pytest.approx(6.0 * grown, rel=1e-12)


def test_gap_and_planes_replace_each_other():
    text = shipped_drive("sleeved").replace("gap = 2.0", "gap = 2.0\nplanes = [-6.0, 6.0]")
    with refused_field("disc.gap", "= 2 mm", "must be left out beside disc.planes"):
        parse_drive(text)
    case = '\n[[case]]\nname = "a"\ndisc.planes = [-5.5, 5.5]\n'
    disc = parse_drive(shipped_drive("sleeved") + case).cases["a"].disc
    assert (disc.gap, disc.disc_planes) == (0.0, (-5.5, 5.5))
    changed = with_fields(sleeved({"disc.planes": (-5.5, 5.5)}), {"disc.gap": 1.5})
    assert changed.disc.disc_planes == (-5.75, 5.75)


def test_a_span_that_discs_outgrow_is_refused():
    with refused_field(
        "disc.thickness", "= 14 mm", "not between the walls at ±13 mm", bound=("at most", 11.0), alone=True
    ):
        sleeved({"disc.thickness": 14.0})
