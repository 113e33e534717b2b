"""Crown, relief and length of rollers and pins: `hybrid` has them at its contacts, as the half-space does."""

from __future__ import annotations

import numpy as np
import pytest

from ltca.analysis.engines import Hybrid
from ltca.analysis.loaded_analysis import analyse
from ltca.reading.changes import with_fields
from ltca.testing.closed_form_bodies import without_coupling

ANGLES = np.array([0.5])
CROWN = "crank_bearing.roller_profile.crown_drop"


def answers(result):
    response, pressures = result.full.response, result.pressures
    return {
        "pin load": response.pin_load,
        "roller load": response.rollers.outer_load,
        "hole load": response.hole_load,
        **{
            f"{kind} {field}": getattr(getattr(pressures, kind), field)
            for kind in ("pins", "outer", "inner", "holes")
            for field in ("mid", "largest", "half_width")
        },
        "pose": 50.0 * result.full.pose,
    }


@pytest.mark.parametrize(
    "fields",
    [
        {"crank_bearing.roller_length": 8.0},
        {CROWN: 0.01},
        {"crank_bearing.roller_length": 8.0, "crank_bearing.roller_profile.logarithmic_factor": 1.0},
        {"pin_wheel.pin_profile.end_relief_length": 2.0, "pin_wheel.pin_profile.end_relief_depth": 0.01},
    ],
    ids=["short", "crowned", "short and logarithmic", "relieved pins"],
)
@pytest.mark.slow
def test_without_a_body_part_it_is_the_half_space_with_its_profiles(fields, paper_cases, coarse_tables):
    drive = with_fields(paper_cases["CS-1"], fields)
    plain = analyse(drive, ANGLES)
    bare = analyse(drive, ANGLES, engine=Hybrid(coefficients=without_coupling(drive), hole_near_field=False))
    found, expected, even = answers(bare), answers(plain), answers(analyse(paper_cases["CS-1"], ANGLES))
    for name, values in expected.items():
        # both balance to 1e-9 of the load, and pressures start like a root of the approach
        np.testing.assert_allclose(found[name], values, atol=1e-5 * np.max(np.abs(values)), err_msg=name)
    assert np.max(np.abs(found["pose"] - even["pose"])) > 1e-3  # the fields are felt


@pytest.mark.slow
def test_crown_is_felt_on_a_body_part(paper_cases, closed_form, coarse_tables):
    """Uncrowned in silence before: at about the same load a crown of 10 µm presses a third higher, as on half-spaces."""
    drive = paper_cases["CS-1"]
    crowned = with_fields(drive, {CROWN: 0.01})
    engine = Hybrid(coefficients=closed_form(drive))
    assert drive.shape_fingerprint() == crowned.shape_fingerprint()
    even, found = analyse(drive, ANGLES, engine=engine), analyse(crowned, ANGLES, engine=engine)
    plain, half_space = analyse(drive, ANGLES), analyse(crowned, ANGLES)
    rise = found.pressures.inner.mid.max() / even.pressures.inner.mid.max()
    expected = half_space.pressures.inner.mid.max() / plain.pressures.inner.mid.max()
    # the rollers share the load a little otherwise on each
    assert rise == pytest.approx(expected, rel=0.03)
    assert expected > 1.25
    # a crown makes the rollers yield more, and takes the load off their ends
    assert found.full.pose[0, 3] < even.full.pose[0, 3]
    assert found.pressures.inner.largest.max() < 0.8 * even.pressures.inner.largest.max()


@pytest.mark.slow
def test_vanishing_crown_is_none(paper_cases, closed_form, coarse_tables):
    drive = paper_cases["CS-1"]
    engine = Hybrid(coefficients=closed_form(drive))
    found = analyse(with_fields(drive, {CROWN: 1e-7}), ANGLES, engine=engine)
    even = analyse(drive, ANGLES, engine=engine)
    # the coarse table of the profiled law: loads to half a per cent, pressures to one
    load, expected = found.full.response.rollers.outer_load, even.full.response.rollers.outer_load
    np.testing.assert_allclose(load, expected, atol=0.005 * expected.max())
    np.testing.assert_allclose(found.pressures.outer.mid, even.pressures.outer.mid, atol=0.01 * 1200.0)


@pytest.mark.slow
def test_shorter_rollers_press_harder_on_a_body_part(paper_cases, closed_form):
    """8 mm rollers read what 11.8 mm ones do: at equal load pressure goes like the root of the length."""
    drive = paper_cases["CS-1"]
    engine = Hybrid(coefficients=closed_form(drive))
    long, short = (
        analyse(with_fields(drive, {"crank_bearing.roller_length": length}), ANGLES, engine=engine)
        for length in (11.8, 8.0)
    )
    one, other = (result.full.response.rollers.outer_load for result in (long, short))
    loaded = one > 0.3 * one.max()
    rise = (short.pressures.outer.mid / np.sqrt(np.where(loaded, other, 1.0)))[loaded]
    rise /= (long.pressures.outer.mid / np.sqrt(np.where(loaded, one, 1.0)))[loaded]
    # 1.2145, less than a per cent away by what goes to the ends
    np.testing.assert_allclose(rise, np.sqrt(11.8 / 8.0), rtol=0.01)
    # and they yield more: by about as much as on half-spaces, where nothing else is
    plain, softer = (
        analyse(with_fields(drive, {"crank_bearing.roller_length": length}), ANGLES) for length in (11.8, 8.0)
    )
    more = short.full.pose[0, 3] - long.full.pose[0, 3]
    assert more == pytest.approx(softer.full.pose[0, 3] - plain.full.pose[0, 3], rel=0.15)
    assert more < 0.0


@pytest.mark.slow
def test_rollers_of_about_the_thickness_are_no_special_case(paper_cases, closed_form):
    drive = paper_cases["CS-1"]
    engine = Hybrid(coefficients=closed_form(drive))
    whole, nearly = (
        answers(analyse(with_fields(drive, {"crank_bearing.roller_length": 11.8 * share}), ANGLES, engine=engine))
        for share in (1.0, 1.0 - 1e-7)
    )
    for name, values in whole.items():
        # where a contact of micrometres' approach opens, loads change by some ten times the length
        np.testing.assert_allclose(nearly[name], values, atol=1e-5 * np.max(np.abs(values)), err_msg=name)
