"""Physical checks of a drive: bounds, fits, hollows and folds of the flank; `refused_changes.toml` has a wrong drive for each."""

from __future__ import annotations

import numpy as np
import pytest
from refusals import refused_field, stands_in

from ltca.errors import DriveError
from ltca.geometry.flank import FlankProfile
from ltca.reading.drive_file import build_drive


def test_sound_at_the_bound_itself(vary):
    """Exact fits are the rule in drives: they must pass, whatever the rounding of their sum."""
    vary(crank_bearing={"roller_radius": 5.0})
    vary(crank_bearing={"inner_race_radius": 19.3, "outer_race_radius": 29.3})
    vary(pin_shaft={"hole_radius": 10.075 + 4.0})
    vary(disc={"equidistant_offset": 0.09})
    vary(disc={"equidistant_offset": 0.0, "shifting_offset": 0.0})


def test_drawn_interference_is_answered_and_clearance_counts(vary):
    """Oversize pins passed as errors of single parts while the same overlap was refused as drawn."""
    vary(disc={"equidistant_offset": -0.4})
    vary(crank_bearing={"roller_radius": 5.01})
    vary(pin_shaft={"hole_radius": 14.0})
    vary(crank_bearing={"roller_radius": 5.27}, clearance={"bearing": 0.06})
    vary(pin_shaft={"hole_radius": 13.57}, clearance={"pin_hole": 0.01})


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


# e z_P/R_C = 0.955: the path of a pin's centre turns sharply in the roots, at a radius of 0.015 mm.
SHARP = {"crank": {"eccentricity": 6.0}, "pin_shaft": {"hole_radius": 16.075}}
HOLLOW = ("the flank has a hollow of radius ", " mm at θ = ", " at two points")


def sharp_path_radius(generating_radius, e=6.0, u=14):
    """ρ = (R − e u)²/(e u² − R) of the trochoid in its root."""
    return (generating_radius - e * u) ** 2 / (e * u * u - generating_radius)


def test_a_hollow_narrower_than_the_pin_is_refused_always(paper_table):
    """It was accepted on the flank as designed and refused with a harmonic of 1 nm: one rule, one sentence, one field."""
    narrow = sharp_path_radius(87.8)  # of the flank: less by the equidistant offset, negative here
    for offset, refused in ((-1.01 * narrow, True), (-0.99 * narrow, False)):
        found = []
        for cosine in ([], [1e-6]):
            disc = {"equidistant_offset": offset, "shifting_offset": -0.2}
            disc["profile_errors"] = {"orders": [5] * len(cosine), "cosine": cosine}
            try:
                build_drive(paper_table(**SHARP, disc=disc))
            except DriveError as error:
                found += error.problems
        if refused:
            assert len(found) == 2
            for problem in found:
                assert problem.subject == f"disc.equidistant_offset = {offset:g} mm"
                assert problem.bound == ("greater than", 6.5)
                assert stands_in(HOLLOW, problem.said)
        else:
            assert found == []


def test_hollows_are_told_by_what_makes_them(paper_table):
    """A flank that is wide enough as designed: its deviation, or a pin that has grown, takes the room."""
    disc = {"equidistant_offset": 0.0, "shifting_offset": 0.0}
    build_drive(paper_table(**SHARP, disc=disc))
    room = sharp_path_radius(88.0)
    pins = [0.0] * 13 + [2.02 * room]  # a diameter
    grown = {"pin_wheel": {"pin_errors": {"diameter": pins}}}
    largest = pytest.approx(6.5 + 1.01 * room)
    diameter = "pin_wheel.pin_errors.diameter"
    with refused_field(diameter, f"holds {2.02 * room:g} mm", *HOLLOW, bound=("greater than", largest)):
        build_drive(paper_table(**SHARP, **grown, disc=disc))
    pins[-1] = 1.98 * room
    build_drive(paper_table(**SHARP, **grown, disc=disc))
    pins[-1] = -0.1  # smaller pins fit wherever the others do
    build_drive(paper_table(**SHARP, **grown, disc=disc))
    wavy = disc | {"profile_errors": {"orders": [60], "cosine": [0.01]}}
    with refused_field("disc.profile_errors", "", *HOLLOW, bound=("greater than", 6.5)):
        build_drive(paper_table(disc=wavy, **SHARP))


@pytest.mark.parametrize(
    ("equidistant", "shifting"), [(0.0, 0.0), (-0.05, -0.09), (0.02, -0.09), (0.15, 0.09), (1.0, 0.3)]
)
def test_offsets_of_sound_drives_are_accepted(paper_table, equidistant, shifting):
    """Flanks generated with pins smaller than the wheel's leave their hollows wide enough: by 1.48 mm here."""
    drive = build_drive(paper_table(disc={"equidistant_offset": equidistant, "shifting_offset": shifting}))
    assert sharp_path_radius(88.0 + shifting, e=4.0) > 1.4 > -equidistant
    effective = FlankProfile.of_drive(drive).effective_radius(np.linspace(0.0, 1.0, 101), drive.pin_wheel.pin_radius)
    assert np.all(effective > 0.0)
