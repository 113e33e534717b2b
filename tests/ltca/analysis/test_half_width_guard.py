"""Where half-spaces end: half-widths against the smaller radius of each contact, in closed form."""

from __future__ import annotations

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from refusals import error_says
from scipy.optimize import brentq

from ltca.analysis.engines import HalfSpace
from ltca.analysis.half_width_guard import (
    HALF_WIDTH_BOUND,
    _on_grids,
    check_half_widths,
    unborne_warning,
    wide_holes_warning,
)
from ltca.analysis.loaded_analysis import analyse
from ltca.drive.single_discs import single_discs, without_own
from ltca.equilibrium.reducer import Reducer
from ltca.errors import DriveError
from ltca.geometry.pairs import ContactGeometry
from ltca.reading.changes import with_fields
from ltca.testing.practical_drives import practical_drive
from validation.methods.grids import GridCompliance


def check(drive, radius, pin=(0.0, 0.0), outer=0.0, inner=0.0):
    """Check one position: effective radii and half-widths of two pins, half-widths of a roller on bore and race."""
    pressures = SimpleNamespace(
        pins=SimpleNamespace(half_width=np.array([pin]), widest=np.array([pin])),
        outer=SimpleNamespace(half_width=np.array([[0.0, outer]]), widest=np.array([[0.0, outer]])),
        inner=SimpleNamespace(half_width=np.array([[inner, 0.0]]), widest=np.array([[inner, 0.0]])),
    )
    contacts = SimpleNamespace(flank=SimpleNamespace(effective_radius=np.array([radius])))
    check_half_widths([drive], contacts, pressures, 377_300.0)


def test_the_smaller_radius_bounds_the_half_width(paper_cases):
    """Pin of 6.5 mm on flanks of radius 1.5, 10 (convex) and −10 mm (concave): 1/ρ = 1/r_pin + 1/r_flank."""
    drive = paper_cases["CS-1"]
    assert drive.pin_wheel.pin_radius == 6.5
    for flank, smaller in ((1.5, 1.5), (10.0, 6.5), (-10.0, 6.5)):
        effective = 1.0 / (1.0 / 6.5 + 1.0 / flank)
        bound = HALF_WIDTH_BOUND * smaller
        check(drive, (effective, 2.0), pin=(0.999 * bound, 0.0))
        with pytest.raises(DriveError, match=r"of wheel pin 0, must be at most") as told:
            check(drive, (effective, 2.0), pin=(1.001 * bound, 0.0))
        assert f"must be at most {bound:.4g} mm" in str(told.value)
        assert "load.torque = 377300 N·mm" in str(told.value)


@pytest.mark.parametrize(
    ("place", "name"), [("outer", "roller on the bore 1"), ("inner", "roller on the inner race 0")]
)
def test_rollers_are_bounded_by_their_own_radius(paper_cases, place, name):
    drive = paper_cases["CS-1"]
    bound = HALF_WIDTH_BOUND * drive.crank_bearing.roller_radius
    check(drive, (2.0, 2.0), **{place: 0.999 * bound})
    with error_says(DriveError, name):
        check(drive, (2.0, 2.0), **{place: 1.001 * bound})


def one_disc_of(seed):
    """The drive of a seed with one of its discs, which carries its part of the torque, and the pin shaft held."""
    drive, angle = practical_drive(seed)
    alone = single_discs(without_own(replace(drive, ring=None)))[0]
    return with_fields(alone, {"installation.held": "pin-shaft"}), angle


@pytest.mark.slow
def test_tables_are_warned_of_where_the_flank_leaves_its_parabola():
    """Curvature that changes within the contact: tables 1.5 % beside the true separation while b/r is 0.07."""
    drive, angle = one_disc_of(116)
    torque = 100.0 * drive.load.torque
    found = analyse(drive, np.array([angle]), torque)
    (warning,) = [text for text in found.warnings if "--method direct" in text]
    told = re.search(r"load of wheel pin (\d+) differs by ([\d.]+) % of the largest .* take --method direct", warning)
    assert told, warning
    assert analyse(drive, np.array([angle]), 0.01 * torque).warnings == []


def test_loose_and_bent_pins_are_warned_of_as_well():
    """Grids, which know fixed pins alone, were asked: "pin_shaft.stiffness: is left out", or pins taken for fixed."""
    drive, angle = one_disc_of(116)
    loose = {"pin_wheel.seat.kind": "slot", "pin_wheel.seat.radius": 1.002 * drive.pin_wheel.pin_radius}
    bent = {"pin_shaft.stiffness": None, "pin_shaft.beam.span": 18.0, "pin_shaft.beam.tip": "tied-clamped"}
    drive, torque = with_fields(drive, loose | bent), 100.0 * drive.load.torque
    told = [text for text in analyse(drive, np.array([angle]), torque).warnings if "parabola" in text]
    assert len(told) == 1
    assert re.search(r"the surfaces at wheel pin \d+ depart from the parabola of the tables by [\d.]+ %", told[0])
    assert "--method direct" not in told[0]
    assert analyse(drive, np.array([angle]), 0.01 * torque).warnings == []


def test_the_departure_that_is_told_is_that_of_the_surfaces():
    """Gaps of pin and flank a half-width beside the contact on both sides, by circle and flank, against b²/2ρ.

    Two digits are told; the flank is followed by its parameter, and its cubic term counted for less by a tenth.
    """
    drive, angle = one_disc_of(116)
    loose = {"pin_wheel.seat.kind": "slot", "pin_wheel.seat.radius": 1.002 * drive.pin_wheel.pin_radius}
    found = analyse(with_fields(drive, loose), np.array([angle]), 100.0 * drive.load.torque)
    (warning,) = [text for text in found.warnings if "parabola" in text]
    told = re.search(r"the surfaces at wheel pin (\d+) depart from the parabola of the tables by ([\d.]+) %", warning)
    pin, flank = int(told[1]), found.full.response.flank
    profile, placement = found.model.discs[0].geometry.profile, found.model.discs[0].geometry.placement
    width, theta = found.pressures.pins.half_width[0, pin], flank.parameter[0, pin]
    origin, normal = profile.flank(np.array(theta)), profile.normal(np.array(theta))
    ahead = 3.0 * width / np.abs(profile.flank_tangent(np.array(theta)))

    def beside(place):
        return (profile.flank(np.array(place)) - origin) * normal.conjugate()

    radius, gaps = float(placement.wheel_pin_radii[pin]), []
    for sense in (1.0, -1.0):
        at = brentq(lambda place, sense=sense: beside(place).imag - sense * width, theta - ahead, theta + ahead)
        gaps.append(radius - np.sqrt(radius**2 - width**2) - beside(at).real)
    parabola = width**2 / (2.0 * flank.effective_radius[0, pin])
    even, odd = 0.5 * (gaps[0] + gaps[1]) / parabola - 1.0, 0.5 * (gaps[0] - gaps[1]) / parabola
    load = found.full.response.pin_load[0]
    departure = 100.0 * max(abs(even), odd**2) * load[pin] / load.max()
    assert float(told[2]) == pytest.approx(departure, rel=0.15)


def test_grids_check_pins_where_a_ring_has_displaced_them(paper_cases):
    """They stand in the wheel elsewhere than drawn; rollers do not feel it."""
    drive = paper_cases["CS-1"]
    found = analyse(drive, np.array([0.4])).full
    geometry = ContactGeometry.of_drive(drive)
    moved = np.full(14 + 8, 2e-3 + 1e-3j)
    on_grids = _on_grids(drive, found.crank_angle, found.pose, moved)
    expected = geometry.flank(found.crank_angle, found.pose, shifts=moved[None, :14])
    np.testing.assert_allclose(on_grids.flank.approach, expected.approach, rtol=0.0, atol=1e-12)
    # By more than a tenth of the largest approach, so that displacements count.
    still = _on_grids(drive, found.crank_angle, found.pose, None)
    np.testing.assert_allclose(still.flank.approach, found.response.flank.approach, rtol=0.0, atol=1e-12)
    changed = np.abs(on_grids.pin_load - still.pin_load).max()
    assert changed > 0.1 * still.pin_load.max()
    np.testing.assert_array_equal(on_grids.rollers.outer_load, still.rollers.outer_load)


@pytest.mark.slow
def test_direct_has_nothing_to_warn_of():
    """Solved anew by the true separation the loads move by 0.9 % of the largest, as the warning said to its order."""
    drive, angle = one_disc_of(116)
    torque = 100.0 * drive.load.torque
    tables = analyse(drive, np.array([angle]), torque)
    direct = analyse(drive, np.array([angle]), torque, HalfSpace(method="direct"))
    assert not any("--method direct" in text for text in direct.warnings)
    (warning,) = [text for text in tables.warnings if "--method direct" in text]
    loads = direct.full.response.pin_load
    pin = int(re.search(r"wheel pin (\d+)", warning)[1])
    told = float(re.search(r"([\d.]+) % of the largest", warning)[1])
    model = Reducer(discs=(GridCompliance.of_drive(drive),))
    grids = model.respond(tables.full.crank_angle, tables.full.pose).pin_load[0]
    difference = abs(tables.full.response.pin_load[0, pin] - grids[pin]) / grids.max()
    assert told == pytest.approx(100.0 * difference, rel=0.05)  # two digits are told
    moved = np.max(np.abs(tables.full.response.pin_load - loads)) / np.max(loads)
    assert 0.005 < moved < 0.025


@pytest.mark.slow
def test_the_paper_is_not_warned_of(paper_cases):
    for drive in paper_cases.values():
        assert analyse(drive, np.linspace(0.0, 6.0, 7)).warnings == []


def test_what_loads_say_nothing_of_is_warned_of(paper_cases):
    """Shaft pins wider in their holes than half-spaces stand for, pressures that no steel bears, a light torque that is not."""
    drive = paper_cases["CS-1"]
    soft = {f"materials.{part}.youngs_modulus": 2500.0 for part in ("disc", "shaft_pin")}
    heavy = analyse(with_fields(drive, {"load.torque": 6e6, "load.light_torque": 7e6}), np.array([0.3]))
    told = "; ".join(heavy.warnings)
    assert "load.light_torque = 7e+06 N·mm is more than the torque of 6e+06 N·mm" in told
    wide = analyse(with_fields(drive, soft), np.array([0.3]), 1e5).pressures
    bound = HALF_WIDTH_BOUND * drive.pin_shaft.pin_radius
    largest = float(np.max(wide.holes.half_width))
    warned = wide_holes_warning(drive, wide)
    assert (warned is not None) == (largest > bound)
    narrow = replace(wide, holes=replace(wide.holes, half_width=np.full((1, 8), 0.99 * bound)))
    assert wide_holes_warning(drive, narrow) is None
    broad = replace(wide, holes=replace(wide.holes, half_width=np.full((1, 8), 1.01 * bound)))
    assert "pin_shaft.pin_radius = 10.07" in str(wide_holes_warning(drive, broad))
    pressed = replace(wide, pins=replace(wide.pins, mid=np.full((1, 14), 10_001.0)))
    assert "more than any steel bears" in str(unborne_warning(pressed))
    assert unborne_warning(wide) is None
