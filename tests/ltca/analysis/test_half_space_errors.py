"""What is said of an analysis on half-spaces."""

from __future__ import annotations

import argparse
from dataclasses import replace

import pytest

from ltca.analysis.engines import HalfSpace, Hybrid
from ltca.analysis.half_space_errors import (
    LARGEST_DISTANCE,
    at_torque,
    half_space_caution,
    half_space_cautions,
    half_space_words,
    measured,
    measured_with,
    nearest_shipped,
)
from ltca.commands.compliance_arguments import (
    add_compliance_arguments,
    check_compliance,
    compliance_of,
    settle_compliance,
)
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive

PAPER = load_drive("paper").cases["CS-1"]
THIN = PAPER.with_fields({"disc.thickness": 9.0, "crank_bearing.roller_length": 9.0})
"""A drive that no ratios were measured of; `paper` is the most similar one."""


def test_supports_of_bodies_are_said_to_have_no_effect():
    """Half-spaces have neither cores of pins nor bores of races: nothing is ignored in silence."""
    given = with_fields(PAPER, {"pin_wheel.core_radius": 3.0, "crank_bearing.race_bore_radius": 12.0})
    said = "without effect on them: pin_wheel.core_radius = 3 mm, crank_bearing.race_bore_radius = 12 mm"
    assert half_space_words(HalfSpace(), given).endswith(said)
    assert "without effect" not in half_space_words(HalfSpace(), PAPER)
    assert half_space_words(Hybrid(), given) == ""


def test_a_shipped_drive_was_called_the_one_nearest_to_itself():
    for name in measured():
        drive = next(iter(load_drive(name).cases.values()))
        for said in (half_space_words(HalfSpace(), drive), half_space_caution(HalfSpace(), drive)):
            assert f"measured on the shipped drive {name}" in said
            assert "nearest" not in said
            assert "similar" not in said
    assert "on the most similar shipped drive paper; not measured on this one" in half_space_words(HalfSpace(), THIN)


def test_the_caution_gives_a_direction():
    """A ratio of 1.34 says neither of what nor which way; 0.785 is 21.5 % below one, 1.219 some 22 % above."""
    assert half_space_caution(HalfSpace(), THIN).startswith(
        "half-spaces: too stiff, by 30 … 34 % on the most similar shipped drive paper; not measured on this one; "
    )
    said = half_space_words(HalfSpace(), PAPER)
    for part in (
        "torsional stiffness at 50 … 100 % of the torque 34 % too large", "life of the crank bearing 22 % too large",
        "largest flank pressure within 1 %",
        "largest roller pressure 8 % too small", "transmission error 21 % too small",
    ):  # fmt: skip
        assert part in said
    reducer = load_drive("rv").cases["nominal"]
    assert half_space_caution(HalfSpace(), reducer).startswith(
        "half-spaces: stiffness within 1 %, transmission error about 45 % too small here"
    )
    assert half_space_caution(Hybrid(), PAPER) == ""


def test_no_ratio_of_steel_is_given_for_a_printed_disc():
    """It was told as 24 % too stiff by robot-joint, whose disc is seventy times stiffer."""
    printed = load_drive("robot-joint").cases["nominal"].with_fields({"materials.disc": "printed PLA"})
    said = half_space_caution(HalfSpace(), printed)
    assert said.startswith(
        "half-spaces: too stiff, as bodies beyond the contacts do not yield; by how much is not known, no shipped "
    )
    for words in (said, half_space_words(HalfSpace(), printed)):
        assert "%" not in words
        assert "either way by tens of per cent" in words


@pytest.mark.parametrize(
    "changes",
    [
        {"pin_wheel.beam.ends": "supported"},
        {"pin_shaft.beam": {"tip": "tied-clamped"}},
        {"pin_shaft.stiffness": 2e5},
        {"pin_wheel.pin_radius": 2.6},
        {"crank_bearing.number_of_rollers": 13},
        {"materials.roller.youngs_modulus": 3e5},
    ],
)
def test_what_was_measured_on_a_shipped_drive_was_told_of_one_with_other_yielding_parts(changes):
    """`robot-joint` with bending pins was "24 % too stiff here (measured on the shipped drive)", where 30 % are measured."""
    drive = load_drive("robot-joint").cases["nominal"]
    changed = drive.with_fields(changes)
    for said in (half_space_caution(HalfSpace(), changed), half_space_words(HalfSpace(), changed)):
        assert "by 24 % on the most similar shipped drive robot-joint; not measured on this one" in said
        assert " here" not in said


@pytest.mark.parametrize(
    ("case", "changes", "torque"),
    [
        ("CS-1", {"load.torque": 900e3}, None), ("CS-1", {}, 60e3), ("CS-6", {"load.torque": 60e3}, None),
        ("CS-3", {"clearance.bearing": 0.02}, None), ("CS-3", {"clearance.pin_hole": 0.005}, None),
        ("CS-1", {"load.light_torque": 5e3}, None), ("CS-1", {"disc.equidistant_offset": 0.01}, None),
    ],
)  # fmt: skip
def test_what_was_measured_at_one_load_and_clearance_was_told_of_any(case, changes, torque):
    """`paper` at 900 N·m was told of its pressures at 377 N·m; CS-6 of the transmission error of CS-1, 21 % for 34 %."""
    drive = load_drive("paper").cases[case].with_fields(changes)
    drive = at_torque(drive, torque or drive.load.torque)
    for said in (half_space_caution(HalfSpace(), drive), half_space_words(HalfSpace(), drive)):
        assert "too stiff, by 30 … 34 % on the most similar shipped drive paper; not measured on this one" in said
        assert " here" not in said
    # Names, engines and what vibrations alone take change nothing.
    same = load_drive("paper").cases[case].with_fields({"analysis.compliance": "hybrid", "name": "mine"})
    assert (
        f"here (measured on the shipped drive paper, case {case}, at 50 … 100 % of the torque)"
        in half_space_caution(HalfSpace(), at_torque(same, 377.3e3))
    )


def test_every_case_of_a_shipped_drive_has_its_own_errors():
    """The errors of the first case were printed for all."""
    for name in measured():
        cases = load_drive(name).cases
        assert {case: measured_with(drive) for case, drive in cases.items()} == {
            case: entry["measured_with"] for case, entry in measured()[name]["cases"].items()
        }
    cases = load_drive("paper").cases
    assert half_space_cautions(HalfSpace(), cases) == [
        "half-spaces: about 30 … 34 % too stiff here (measured on the shipped drive paper, at 50 … 100 % of the torque)"
    ]
    assert half_space_caution(HalfSpace(), cases["CS-6"]).startswith("half-spaces: about 31 % too stiff here")


def test_signed_errors_of_one_drive_were_told_of_another():
    """Two discs of 25 pins: "flank pressure 4 % too large, life 3 % too large" by `robot-joint`, and both were 13 % too small."""
    joint = load_drive("robot-joint").cases["nominal"]
    two = joint.with_fields({"pin_shaft.beam.tip": "tied-clamped", "clearance.pin_hole": 0.0})
    for said in (half_space_caution(HalfSpace(), two), half_space_words(HalfSpace(), two)):
        assert said.endswith(
            "pressures and life may be off either way by tens of per cent, the transmission error by a factor of two or three"
        )
        assert "too small" not in said
        assert "too large" not in said


def test_a_case_of_another_material_got_the_caution_of_the_first_case():
    steel = load_drive("robot-joint").cases["nominal"]
    printed = steel.with_fields({"materials.disc": "printed PLA"})
    first, second = half_space_cautions(HalfSpace(), {"steel": steel, "printed": printed})
    assert first.startswith("case steel: half-spaces: about 24 % too stiff here")
    assert second.startswith("case printed: half-spaces: too stiff, as bodies beyond the contacts do not yield")
    assert len(half_space_cautions(HalfSpace(), {"a": steel, "b": steel})) == 1
    assert half_space_cautions(Hybrid(), {"a": steel}) == []


def test_quick_was_what_the_drive_file_says():
    """`run paper --quick` gave the file as the reason for half-spaces, which had been asked for."""
    parser = argparse.ArgumentParser()
    add_compliance_arguments(parser)

    def words(*options):
        arguments = parser.parse_args(options)
        check_compliance(arguments)
        settle_compliance(arguments, [PAPER])
        return half_space_words(compliance_of(arguments, [PAPER]), PAPER)

    assert words().startswith("half-spaces, as [analysis] of the drive file says: ")
    for options in (["--quick"], ["--compliance", "half-space"]):
        assert words(*options).startswith(
            "half-spaces, as asked; without that [analysis] of the drive file says the same: "
        )
    hybrid = replace(PAPER, analysis=replace(PAPER.analysis, compliance="hybrid"))
    assert half_space_words(HalfSpace(asked=True), hybrid).startswith("half-spaces, as asked: ")


def test_a_drive_with_loose_pins_is_as_far_from_one_with_fixed_pins_as_a_drive_may_be():
    """Of the shipped drives only `sleeved` has loose pins, and no part that yields in common with a drive of rigid parts."""
    seat = {"pin_wheel.seat.kind": "slot", "pin_wheel.seat.radius": 1.01 * PAPER.pin_wheel.pin_radius}
    name, distance = nearest_shipped(PAPER.with_fields(seat))
    assert name == "paper"
    assert distance == pytest.approx(LARGEST_DISTANCE, abs=1e-5)
