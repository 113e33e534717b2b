"""Contacts in slices that feel each other through the bodies: the plane as their limit, their tangent, loose pins and sleeves."""

from dataclasses import replace

import numpy as np
import pytest

from ltca.compliance.coupled import CoupledCompliance
from ltca.compliance.response import Start
from ltca.drive.materials import Material
from ltca.drive.parts import ShaftPinSeat, WheelPinSeat
from ltca.equilibrium.output_torque import solve_at_output
from ltca.equilibrium.reducer import Reducer
from ltca.reading.drive_file import load_drive
from ltca.testing.width_check import WidthCheck

SLICES = 3
ANGLES = np.array([0.5])
SLEEVE = {"kind": "sleeve", "pin_radius": 2.2, "bore_radius": 2.22}
SEATS = {
    "loose pins": ({}, False), "sleeves": (SLEEVE, True), "loose pins, sleeves on shaft pins": ({}, True),
    "sleeves on shaft pins": ({"kind": "fixed"}, True),
}  # fmt: skip
"""Seats of the wheel pins, those of the shipped drive where nothing is given, and whether shaft pins have sleeves."""


def seated(seats, slices, **fields):
    """One disc of the shipped drive with loose parts, on pins that do not bend."""
    drive = next(iter(load_drive("sleeved").cases.values()))
    wheel, shaft, parts = drive.pin_wheel, drive.pin_shaft, drive.materials
    on_wheel, sleeves = SEATS[seats]
    wheel = replace(wheel, beam=None, seat=WheelPinSeat(**on_wheel) if on_wheel else wheel.seat)
    shaft = replace(shaft, beam=None, stiffness=2e5, seat=shaft.seat if sleeves else ShaftPinSeat())
    none = {} if "sleeve" in (wheel.seat.kind, shaft.seat.kind) else {"sleeve": Material()}
    none |= {} if wheel.seat.kind == "slot" else {"wheel_seat": Material()}
    whole = replace(
        drive, pin_wheel=wheel, pin_shaft=shaft, materials=replace(parts, **none),
        disc=replace(drive.disc, number_of_discs=1), load=replace(drive.load, torque=250e3),
    )  # fmt: skip
    return whole.with_fields({"contact.slices": slices, **fields})


def balanced(drive, closed_form, near_field, angles=ANGLES):
    """Model of a drive on coefficients in closed form, and its equilibrium."""
    disc = CoupledCompliance.of_drive(drive, closed_form(drive), near_field)
    model = Reducer.of_drive(drive, [disc])
    return model, solve_at_output(model, [drive], angles, drive.load.torque)


@pytest.mark.family(quick=1)
@pytest.mark.parametrize("seats", SEATS)
def test_aligned_slices_of_plane_strain_on_seats_are_the_plane(seats, closed_form):
    """`fe` in slices of a drive that nothing tilts: loads of every contact as with one slice.

    1e-9 of the largest: the curve of a seat is a spline to 1e-8 of what the seat yields, a tenth of the approach.
    """
    _, plane = balanced(seated(seats, 1), closed_form, "plane-strain")
    _, found = balanced(seated(seats, SLICES), closed_form, "plane-strain")
    for one, other in (
        (found.response.pin_load, plane.response.pin_load),
        (found.response.hole_load, plane.response.hole_load),
        (found.response.rollers.outer_load, plane.response.rollers.outer_load),
    ):
        np.testing.assert_allclose(one, other, atol=1e-9 * np.max(other))
    assert found.pose[0, -1] == pytest.approx(plane.pose[0, -1], rel=1e-9)


@pytest.mark.family(quick=1)
@pytest.mark.parametrize("seats", ["loose pins, sleeves on shaft pins", "sleeves"])
def test_loads_on_seats_balance_in_six_directions(seats, closed_form, monkeypatch):
    """Forces and couples of crowned flanks on inclined pins by the lines of `ltca.testing.width_check`, which know no bodies.

    Gaps are those of rigid bodies there and not asked.
    """
    drive = seated(seats, SLICES, **{"disc.lead_crown_drop": 0.002, "pin_wheel.inclination": {"x": 3e-4, "y": 2e-4}})
    model, found = balanced(drive, closed_form, "plane-strain")
    monkeypatch.setattr(WidthCheck, "_laws", lambda *_: None)
    assert WidthCheck(drive, model, found, 0).problems(drive.load.torque) == []
    pins = found.response.parts[0].leaning_pins.contact
    assert np.max(np.abs(pins.moment)) > 0.01 * np.max(pins.load) * drive.disc.thickness


@pytest.mark.family(quick=1)
@pytest.mark.parametrize("near_field", ["plane-strain", "half-space"])
@pytest.mark.parametrize("seats", [None, "loose pins"])
def test_the_tangent_is_that_of_the_force_of_coupled_slices(near_field, seats, closed_form, hold_coefficients):
    """Differences of the force against the tangent, leans included, 2e-4 of its largest entry, all by levers of the coordinates.

    The effective radius that follows the pose is 1e-4, as in the plane; coefficients that follow it, 1e-3 there, are held.
    """
    tilted = {"contact.slices": SLICES, "disc.lead_slope": 1e-4}
    drive = load_drive("paper").cases["CS-3"].with_fields(tilted) if seats is None else seated(seats, SLICES)
    model, found = balanced(drive, closed_form, near_field)
    pose, start = found.pose, Start.after(found.response)
    hold_coefficients()
    tangent = model.respond(ANGLES, pose, start).tangent[0]
    disc = drive.disc.thickness
    lever = np.array([1.0, 1.0, drive.pin_shaft.pin_circle_radius, disc, disc, drive.pin_wheel.pin_circle_radius])
    numeric = np.empty_like(tangent)
    for column, arm in enumerate(lever):
        ends = []
        for side in (1.0, -1.0):
            moved = pose.copy()
            moved[0, column] += side * 1e-6 / arm
            ends.append(model.respond(ANGLES, moved, start).force[0])
        numeric[:, column] = (ends[0] - ends[1]) / (2e-6 / arm)
    scale = np.outer(lever, lever)
    np.testing.assert_allclose(numeric / scale, tangent / scale, atol=2e-4 * np.max(np.abs(tangent / scale)))
    np.testing.assert_allclose(tangent / scale, (tangent / scale).T, atol=1e-12 * np.max(np.abs(tangent / scale)))
