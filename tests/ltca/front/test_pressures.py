"""`result.pressure`: the field over one contact carries its load, and is Hertz's in the middle."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from refusals import error_is, error_says

import ltca
from ltca.analysis.pressure_fields import build_pressure_dataset
from ltca.errors import DriveError
from ltca.reading.drive_file import load_drive
from ltca.testing.closed_form_bodies import without_coupling

ANGLES = [0.3, 1.1]
LOADS = {
    "pin": "pin_load",
    "roller_outer": "roller_load",
    "roller_inner": "roller_load_inner",
    "hole": "pin_shaft_load",
}


@pytest.fixture(scope="module", params=["paper", "sleeved", "rv"])
def result(request):
    return ltca.analyse(next(iter(load_drive(request.param).cases.values())), crank_angle=ANGLES)


@pytest.mark.slow
@pytest.mark.parametrize("contact", LOADS)
def test_it_is_the_contact_that_carries_most(result, contact):
    """Fields of loose and bent wheel pins carried five times their load: seat and beam had been pressed into the contact."""
    loads = result.dataset[LOADS[contact]].isel(case=0)
    if not loads.size:
        with error_is(DriveError, "contact = 'hole': there is none in this drive"):
            result.pressure(contact)
        return
    field = result.pressure(contact, cells=10)
    carried = float((field * field.x_size * field.y_size).sum())
    assert carried == pytest.approx(float(loads.max()), rel=2e-5)  # to which it is solved, twice
    assert carried == pytest.approx(field.attrs["load_N"], rel=1e-12)
    place = {name: int(field[name]) for name in loads.dims}
    assert float(loads.isel(place)) == float(loads.max())
    assert float(field["crank_angle"]) == ANGLES[place["position"]]
    part = contact.partition("_")
    names = {"pin": "pin_pressure_mid", "hole": "pin_shaft_pressure_mid", "roller": f"roller_pressure_mid_{part[2]}"}
    told = float(result.dataset[names[part[0]]].isel(case=0).isel(place))
    assert field.attrs["pressure_mid_MPa"] == pytest.approx(told, rel=2e-3)  # tables against a grid of ten cells
    middle = field.sel(y=0.0, method="nearest")
    assert float(middle.max()) == pytest.approx(told, rel=0.02)  # means of cells beside the middle


@pytest.mark.slow
def test_the_largest_of_the_cells_settles():
    """It grew with `cells` without end, 11 500 MPa on 16 and 27 000 on 32, where a straight pin ends.

    Of cells of a hundredth of the length it is the largest pressure as it is defined, but for what a coarse grid leaves of the
    singular end: 2.7 % from 8 to 16 cells. The load stays the same.
    """
    result = ltca.analyse(load_drive("paper").cases["CS-1"], crank_angle=[0.3])
    coarse, fine = (result.pressure("pin", cells=cells) for cells in (8, 16))
    assert float(fine.max()) == pytest.approx(float(coarse.max()), rel=0.03)
    for field in (coarse, fine):
        assert float(field.max()) == pytest.approx(field.attrs["pressure_max_MPa"], rel=1e-9)
        assert float((field * field.x_size * field.y_size).sum()) == pytest.approx(field.attrs["load_N"], rel=1e-12)


@pytest.mark.slow
def test_the_profile_is_the_ellipse_of_hertz():
    """Away from the ends p = p0 √(1 − x²/b²), and the mean of a line contact is π/4 of the largest."""
    result = ltca.analyse(load_drive("paper").cases["CS-1"], crank_angle=[0.3])
    field = result.pressure("roller_inner", crank_angle=0.3, cells=40)
    middle = field.sel(y=0.0, method="nearest")
    half, top = field.attrs["half_width_mm"], field.attrs["pressure_mid_MPa"]
    inside = np.abs(middle["x"]) < 0.9 * half
    expected = top * np.sqrt(1.0 - (middle["x"] / half).where(inside) ** 2)
    assert float(np.abs(middle - expected).max()) < 0.01 * top  # half-width read from a grid; end effects of a roller
    line = float((middle * middle["x_size"]).sum())
    assert line == pytest.approx(0.25 * np.pi * top * 2.0 * half, rel=5e-3)


@pytest.mark.slow
def test_hybrid_bodies_have_it_too():
    """Without coupling by the bodies hybrid contacts are half-spaces; in plane strain nothing has a width."""
    drive = load_drive("paper").cases["CS-1"]
    coefficients = without_coupling(drive)
    hybrid = ltca.analyse(drive, crank_angle=[0.3], compliance="hybrid", coefficients=coefficients)
    field = hybrid.pressure("pin", cells=10)
    load = hybrid.dataset["pin_load"].max()
    assert float((field * field.x_size * field.y_size).sum()) == pytest.approx(float(load), rel=2e-5)
    told = float(hybrid.dataset["pin_pressure_mid"].max())
    assert field.attrs["pressure_mid_MPa"] == pytest.approx(told, rel=2e-3)
    fields = build_pressure_dataset("paper", {"CS-1": hybrid.loaded}, cells=6)  # what cyclo run --pressure writes
    xr.testing.assert_allclose(fields["pin_field_load"].max(), load, rtol=2e-5)
    plane = ltca.analyse(drive, crank_angle=[0.3], compliance="fe", coefficients=coefficients)
    with error_says(DriveError, starts="compliance = fe: plane strain has no pressure over the width"):
        plane.pressure()


@pytest.mark.slow
def test_a_contact_is_chosen():
    result = ltca.analyse(load_drive("robot-joint").cases["nominal"], crank_angle=["20 deg", 1.1])
    field = result.pressure("roller_outer", 2, crank_angle="20 deg", disc=1, cells=6)
    assert (int(field["disc"]), int(field["position"]), int(field["roller"])) == (1, 0, 2)
    expected = result.dataset["roller_load"].isel(case=0, crank=0).sel(disc=1, position=0, roller=2)
    assert field.attrs["load_N"] == pytest.approx(float(expected), rel=2e-5)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"contact": "pinn"}, "contact = 'pinn': is unknown; must be one of 'pin', …did you mean `pin`"),
        ({"contact": 3}, "contact = 3: is unknown"),
        ({"number": 14}, "number = 14: must be a whole number from 0 to 13"),
        ({"number": 1.5}, "number = 1.5: must be a whole number"),
        ({"disc": 1}, "disc = 1: must be a whole number from 0 to 0"),
        ({"crank": 0}, "crank = 0: has no effect with contact = 'pin'"),
        ({"contact": "roller_outer", "crank": 1}, "crank = 1: must be a whole number from 0 to 0"),
        ({"position": 2}, "position = 2: must be a whole number from 0 to 1"),
        ({"position": 0, "crank_angle": 0.3}, "position and crank_angle: give one of them"),
        ({"crank_angle": "20 deg"}, "crank_angle = '20 deg': was not analysed; the nearest is 0.3 rad"),
        ({"crank_angle": "20 mm"}, "crank_angle = '20 mm': must have the unit rad"),
        ({"crank_angle": [0.3, 1.1]}, "must be one angle in rad"),
        ({"number": 10, "position": 0}, "contact = 'pin': carries nothing at position 0, number 10"),
        ({"cells": 100}, "cells = 100: must be a whole number from 4 to 60"),
    ],
)
def test_what_makes_no_sense_is_refused_by_name(options, message):
    result = ltca.analyse(load_drive("paper").cases["CS-1"], crank_angle=ANGLES)
    with error_says(DriveError, *message.split("…")):
        result.pressure(**options)
