"""One wrong drive for each physical check; each message names field, value, bound and unit."""

from __future__ import annotations

import numpy as np
import pytest

from ltca.errors import DriveError
from ltca.reading.drive_file import build_drive

WRONG = {
    "pin errors of the wrong length": (
        {"pin_wheel": {"pin_errors": {"radial": [0.0] * 13}}},
        r"pin_wheel\.pin_errors\.radial has 13 values: must have 14, one for each of the pins",
    ),
    "hole errors of the wrong length": (
        {"disc": {"hole_errors": {"tangential": [0.0] * 9}}},
        r"disc\.hole_errors\.tangential has 9 values: must have 8, one for each of the holes",
    ),
    "shaft pin errors of the wrong length": (
        {"pin_shaft": {"pin_errors": {"diameter": [0.0]}}},
        r"pin_shaft\.pin_errors\.diameter has 1 values: must have 8",
    ),
    "roller errors of the wrong length": (
        {"crank_bearing": {"roller_errors": {"diameter": [0.0] * 12}}},
        r"crank_bearing\.roller_errors\.diameter has 12 values: must have 11, one for each of the rollers",
    ),
    "errors that are no errors any more": (
        {"pin_wheel": {"pin_errors": {"radial": [0.6] + [0.0] * 13}}},
        r"pin_wheel\.pin_errors\.radial holds 0\.6 mm: must be at most 0\.5 mm in size",
    ),
    "tooth-number difference": (
        {"disc": {"number_of_teeth": 12}},
        r"disc\.number_of_teeth = 12: must be 13, one less than pin_wheel\.number_of_pins = 14",
    ),
    "e z_P/R_C of 1 and more": (
        {"crank": {"eccentricity": 6.3}, "pin_shaft": {"hole_radius": 16.4}},
        r"crank\.eccentricity = 6\.3 mm: must be less than 6\.28571 mm",
    ),
    "generating pin of no radius": (
        {"disc": {"equidistant_offset": -6.5}},
        r"disc\.equidistant_offset = -6\.5 mm: must be greater than -6\.5 mm",
    ),
    "undercut": (
        {"crank": {"eccentricity": 6.0}, "pin_shaft": {"hole_radius": 16.075}, "pin_wheel": {"pin_radius": 8.6}},
        r"pin_wheel\.pin_radius = 8\.6 mm: must be less than 8\.4057\d* mm .*undercut",
    ),
    "disc and pins interfere": (
        {"disc": {"equidistant_offset": 0.05}},
        r"disc\.equidistant_offset = 0\.05 mm: must be at least 0\.09 mm",
    ),
    "negative offsets interfere on the flank": (
        {"disc": {"equidistant_offset": -0.08, "shifting_offset": -0.09}},
        r"disc\.equidistant_offset = -0\.08 mm: must be at least -0\.069\d* mm",
    ),
    "wheel pins overlap": (
        {"pin_wheel": {"pin_radius": 19.7}},
        r"pin_wheel\.pin_radius = 19\.7 mm: must be less than 19\.5818 mm, or neighbouring pins overlap",
    ),
    "shaft pins overlap": (
        {"pin_shaft": {"pin_radius": 22.0, "hole_radius": 26.0}},
        r"pin_shaft\.pin_radius = 22 mm: must be less than 21\.4303 mm, or neighbouring pins overlap",
    ),
    "rollers too large for the races": (
        {"crank_bearing": {"roller_radius": 5.001}},
        r"crank_bearing\.roller_radius = 5\.001 mm: must be at most 5 mm, half the space between the races",
    ),
    "rollers loose between the races": (
        {"crank_bearing": {"roller_radius": 4.4}},
        r"crank_bearing\.roller_radius = 4\.4 mm: must be at least 4\.5 mm",
    ),
    "rollers overlap": (
        {"crank_bearing": {"number_of_rollers": 16}},
        r"crank_bearing\.number_of_rollers = 16: rollers of radius 5 mm overlap, .* less than 4\.7797\d* mm",
    ),
    "rollers longer than the disc is thick": (
        {"crank_bearing": {"roller_length": 12.0}},
        r"crank_bearing\.roller_length = 12 mm: must be at most 11\.8 mm, the thickness of the disc",
    ),
    "bearing clearance": (
        {"clearance": {"bearing": 5.5}},
        r"clearance\.bearing = 5\.5 mm: must be at most 5 mm, the roller radius",
    ),
    "hole too small for the eccentricity": (
        {"pin_shaft": {"hole_radius": 14.07}},
        r"pin_shaft\.hole_radius = 14\.07 mm: must be at least 14\.075 mm, pin radius plus eccentricity",
    ),
    "hole too large to lead the disc": (
        {"pin_shaft": {"pin_radius": 8.0}},
        r"pin_shaft\.hole_radius = 14\.075 mm: must be at most 14 mm, pin radius plus 1\.5 eccentricities",
    ),
    "pin-hole clearance": (
        {"clearance": {"pin_hole": 2.1}},
        r"clearance\.pin_hole = 2\.1 mm: must be at most 2 mm, half the eccentricity",
    ),
    "holes cut into the bore": (
        {"pin_shaft": {"pin_circle_radius": 43.5}},
        r"pin_shaft\.hole_radius = 14\.075 mm: holes cut into the bore by 0\.075 mm; must be less than 14 mm",
    ),
    "holes cut into each other": (
        {"pin_shaft": {"number_of_pins": 13}},
        r"neighbouring holes cut into each other by 1\.34\d+ mm; must be less than 13\.4017 mm",
    ),
    "holes cut through the root circle": (
        {"pin_shaft": {"pin_circle_radius": 63.5}},
        r"holes cut through the root circle of the disc \(radius 77\.44 mm\) by 0\.135 mm; must be less than 13\.94 mm",
    ),
    "bore larger than the disc": (
        {"crank_bearing": {"inner_race_radius": 70.0, "outer_race_radius": 80.0}},
        r"crank_bearing\.outer_race_radius = 80 mm: must be less than 77\.44 mm, the root radius of the disc",
    ),
    "end relief longer than half the roller": (
        {"crank_bearing": {"roller_profile": {"end_relief_length": 6.0, "end_relief_depth": 0.01}}},
        r"crank_bearing\.roller_profile\.end_relief_length = 6 mm: must be at most 5\.9 mm, half the contact length",
    ),
    "crown that is no crown": (
        {"pin_wheel": {"pin_profile": {"crown_drop": 0.7}}},
        r"pin_wheel\.pin_profile\.crown_drop = 0\.7 mm: must be at most 0\.65 mm, a tenth of the radius",
    ),
    "logarithmic profile": (
        {"pin_wheel": {"pin_profile": {"logarithmic_factor": 101.0}}},
        r"pin_wheel\.pin_profile\.logarithmic_factor = 101: must be at most 100",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_each_contradiction_has_its_message(vary, name):
    change, message = WRONG[name]
    with pytest.raises(DriveError, match=message):
        vary(**change)


def test_sound_at_the_bound_itself(vary):
    """Exact fits are the rule in drives: they must pass, whatever the rounding of their sum."""
    vary(crank_bearing={"roller_radius": 5.0})
    vary(crank_bearing={"inner_race_radius": 19.3, "outer_race_radius": 29.3})
    vary(pin_shaft={"hole_radius": 10.075 + 4.0})
    vary(disc={"equidistant_offset": 0.09})
    vary(disc={"equidistant_offset": 0.0, "shifting_offset": 0.0})


def test_several_contradictions_are_told_together(vary):
    with pytest.raises(DriveError) as caught:
        vary(
            crank_bearing={"number_of_rollers": 16, "roller_length": 12.0},
            pin_shaft={"pin_circle_radius": 43.5},
            clearance={"pin_hole": 2.1},
        )
    assert len(caught.value.problems) >= 4


def test_undercut_bound_is_where_the_flank_folds(paper_table):
    """Brute force: the flank of pins below the bound goes on, above it it runs back on itself."""

    def table(pin_radius):
        return paper_table(
            crank={"eccentricity": 6.0}, pin_shaft={"hole_radius": 16.075}, pin_wheel={"pin_radius": pin_radius}
        )

    with pytest.raises(DriveError, match="undercut") as caught:
        build_drive(table(8.6))
    bound = float(str(caught.value).split("must be less than ")[1].split(" mm")[0])
    theta = np.linspace(0.0, 2.0 * np.pi, 200_001)
    locus = 88.09 * np.exp(1j * theta) - 6.0 * np.exp(14j * theta)
    tangent = 88.09j * np.exp(1j * theta) - 84.0j * np.exp(14j * theta)
    for radius, folds in ((bound - 0.02, False), (bound + 0.02, True)):
        if not folds:
            build_drive(table(radius))
        flank = locus + 1j * (radius + 0.15) * tangent / np.abs(tangent)
        forward = (np.diff(flank) * tangent[:-1].conjugate()).real
        assert bool(np.any(forward < 0.0)) is folds
