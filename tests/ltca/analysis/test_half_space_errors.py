"""What is said of an analysis on half-spaces."""

from __future__ import annotations

from ltca.analysis.engines import HalfSpace, Hybrid
from ltca.analysis.half_space_errors import half_space_caution, half_space_words, measured
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
    assert "measured on the most similar shipped drive paper" in half_space_words(HalfSpace(), THIN)


def test_the_caution_gives_a_direction():
    """A ratio of 1.34 says neither of what nor which way; 0.785 is 21.5 % below one, 1.219 some 22 % above."""
    assert half_space_caution(HalfSpace(), THIN) == (
        "half-spaces: about 34 % too stiff here (measured on the most similar shipped drive paper)"
    )
    said = half_space_words(HalfSpace(), PAPER)
    for part in (
        "torsional stiffness 34 % too large", "life of the crank bearing 22 % too large", "largest flank pressure within 1 %",
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
    assert half_space_caution(HalfSpace(), printed) == (
        "half-spaces: too stiff here; no shipped drive is similar enough to say by how much"
    )
    assert "%" not in half_space_words(HalfSpace(), printed)
