"""Which beam in which plane makes equal discs share the torque unequally."""

from __future__ import annotations

from math import pi
from types import SimpleNamespace

import numpy as np
import pytest

from ltca.analysis.engines import HalfSpace
from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.share_causes import _of_beam, share_words
from ltca.analysis.verdict.values import notes
from ltca.beam import PinBeam
from ltca.commands.program import main
from ltca.reading.drive_file import parse_drive, shipped_drive

ANGLES = np.array([0.2, 0.9, 2.3])
STIFFNESS = "stiffness = 4.0e5"


def joint(beam):
    """The robot joint's text with shaft pins as beams, or as springs, whatever the shipped file has."""
    kept = [line for line in shipped_drive("robot-joint").splitlines() if not line.startswith(("beam =", STIFFNESS))]
    at = kept.index("[pin_shaft]") + 1
    return "\n".join([*kept[:at], beam or STIFFNESS, *kept[at:]])


def case_of(text):
    (drive,) = parse_drive(text, "joint").cases.values()
    return drive


def test_unequal_shares_of_equal_discs_had_no_cause():
    """A template with tied tips gave 0.65/0.35 without a word: its pins are clamped in one flange."""
    found = analyse(case_of(joint('beam = { tip = "tied-clamped" }')), ANGLES, None, HalfSpace())
    share = found.torque_share.mean(axis=0)
    assert share[0] > 0.6
    words = found.share_words
    assert words.startswith(f"the discs carry {share[0]:.2f}, {share[1]:.2f} of the torque, not equal parts: ")
    assert "shaft pins (pin_shaft.beam, clamped at -11.5 mm) yield by " in words
    assert words.index("in the plane of disc 0 (-5.5 mm)") < words.index("in the plane of disc 1 (5.5 mm)")
    assert words in notes(found)


def test_springs_share_equally_and_nothing_is_said():
    found = analyse(case_of(joint("")), ANGLES, None, HalfSpace())
    np.testing.assert_allclose(found.torque_share, 0.5, atol=0.02)
    assert found.share_words == ""
    # Parts that yield alike in all planes are no cause, whatever the shares.
    assert share_words(found.drive, np.array([0.7, 0.3])) == ""


def test_clearances_and_errors_of_single_discs_were_no_causes():
    """Shares of 0.10 and 0.90 by a pin-hole clearance of disc 0 had no note; beams and supports alone were named."""
    drive = case_of(joint(""))
    loose = drive.with_fields({"disc.of.0.clearance.pin_hole": 0.02})
    words = share_words(loose, np.array([0.1, 0.9]))
    assert words == (
        "the discs carry 0.10, 0.90 of the torque, not equal parts: the pin-hole clearance is 0.005 mm at disc 1 and 0.02 mm at "
        "disc 0 (disc.of.0.clearance.pin_hole)"
    )
    assert share_words(loose, np.array([0.9, 0.1])) == ""  # the looser disc carries more: that is not by its clearance
    found = analyse(loose, ANGLES, None, HalfSpace())
    assert found.share_words.partition(": ")[2] == words.partition(": ")[2]
    bearing = drive.with_fields({"disc.of.1.clearance.bearing": 0.03})
    said = share_words(bearing, np.array([0.7, 0.3]))
    assert said.endswith(
        "the bearing clearance is 0.005 mm at disc 0 and 0.03 mm at disc 1 (disc.of.1.clearance.bearing)"
    )
    errors = {"disc.of.0.hole_errors.radial.3": 0.01, "crank.of.1.phase_error": 1e-4}
    assert share_words(drive.with_fields(errors), np.array([0.7, 0.3])).endswith(
        "not equal parts: the discs differ in disc.of.N.hole_errors, crank.of.N"
    )
    # Errors that are those of both discs make no difference.
    both = drive.with_fields({"disc.hole_errors.radial.3": 0.01})
    assert share_words(both, np.array([0.7, 0.3])) == ""


@pytest.mark.slow
def test_show_names_the_cause(tmp_path, capsys):
    path = tmp_path / "joint.toml"
    path.write_text(joint('beam = { tip = "free" }'), encoding="utf-8")
    assert main(["show", str(path), "--angle", "0.5", "--out", str(tmp_path / "out")]) == 0
    (note,) = [line for line in capsys.readouterr().out.splitlines() if line.startswith("  note: the discs carry")]
    assert "shaft pins (pin_shaft.beam, clamped at -11.5 mm)" in note


@pytest.mark.parametrize("tip", ["clamped", "free"])
def test_pins_yield_as_beams_in_closed_form(tip):
    """P a³/3EI of a cantilever; with a tip that a floating ring keeps upright, P (a³/3 − a⁴/4L)/EI: no force beyond the load."""
    beam = PinBeam(span=24.0, ends=("clamped", tip), diameter=10.0, youngs_modulus=2e5)
    drive = SimpleNamespace(disc=SimpleNamespace(disc_planes=(-6.0, 4.0), thickness=1e-3))
    a, bending = np.array([6.0, 16.0]), 2e5 * pi * 10.0**4 / 64.0
    expected = a**3 / 3.0 - (a**4 / (4.0 * 24.0) if tip == "clamped" else 0.0)
    np.testing.assert_allclose(_of_beam(beam, drive, floating=tip == "clamped"), expected / bending, rtol=1e-3)
