"""The guess of contacts: Hertz' formulas, balance, places and symmetry."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fem.drive.expected_contacts import expect_contacts, hertz_half_width
from ltca.drive.parts import Drive
from ltca.geometry.placement import Placement
from ltca.reading.drive_file import load_drive


@pytest.fixture(scope="module")
def drive() -> Drive:
    return load_drive("paper").cases["CS-1"]


def test_the_half_width_matches_a_published_case() -> None:
    # NAFEMS benchmark CGS-1, cylinder on block: R 50 mm, 35 kN/mm, E 210/70 GPa, ν 0.3: 6.21 mm.
    modulus = 1.0 / ((1.0 - 0.09) / 210e3 + (1.0 - 0.09) / 70e3)
    assert float(hertz_half_width(35e3, 50.0, modulus)) == pytest.approx(6.21, abs=0.01)


@pytest.mark.parametrize("angle", [0.0, 0.5, 1.0, 3.0, -2.0])
@pytest.mark.parametrize("case", ["CS-1", "CS-6"])
def test_loads_balance(angle: float, case: str) -> None:
    drive = load_drive("paper").cases[case]
    contacts = expect_contacts(drive, angle)
    placement = Placement.of_drive(drive)
    # Moments of the flank loads about the crank axis carry the torque (force on a pin: away from the contact).
    turn = angle / placement.reduction_ratio + contacts.wheel_angle
    pins = placement.wheel_pin_centres * np.exp(1j * turn)
    on_pins = -contacts.pins.load * np.exp(1j * contacts.pins.direction)
    assert np.sum((pins.conjugate() * on_pins).imag) == pytest.approx(drive.load.torque, rel=1e-6)
    # Forces on the disc from pins, rollers and shaft pins vanish.
    on_disc = -on_pins.sum()
    on_disc += np.sum(contacts.rollers_outer.load * np.exp(1j * contacts.rollers_outer.direction))
    on_disc += np.sum(contacts.holes.load * np.exp(1j * contacts.holes.direction))
    assert abs(on_disc) < 1e-4 * contacts.pins.load.sum()


def test_tangential_bearing_force_is_that_of_energy(drive: Drive) -> None:
    """Its mean over one turn is T_out/(u e), whatever the stiffnesses (virtual work)."""
    forces = []
    for angle in 2.0 * np.pi * np.arange(16) / 16:
        rollers = expect_contacts(drive, angle).rollers_outer
        resultant = np.sum(rollers.load * np.exp(1j * rollers.direction)) * np.exp(-1j * angle)
        forces.append(resultant.imag)
    exact = drive.load.torque / (drive.reduction_ratio * drive.crank.eccentricity)
    # It swings by tens of N with the slope of the transmission error; 16 positions average that to some N.
    assert np.mean(forces) == pytest.approx(exact, rel=2e-3)


def test_contact_places_lie_on_both_bodies(drive: Drive) -> None:
    contacts = expect_contacts(drive, 0.7)
    placement = Placement.of_drive(drive)
    centre = placement.races(np.array(0.7)).middle + contacts.disc_x + 1j * contacts.disc_y
    turn = 0.7 / placement.reduction_ratio + contacts.wheel_angle
    pins = placement.wheel_pin_centres * np.exp(1j * turn)
    flank = centre + contacts.flank_points * np.exp(1j * contacts.disc_rotation)
    touching = contacts.pins.load > 0.0
    gap = np.abs(flank - pins) - placement.wheel_pin_radii
    # Pressed together by some micrometres where a load is expected, apart elsewhere.
    assert np.all(gap[touching] < 0.0)
    assert np.all(gap[touching] > -0.02)
    assert np.all(gap[~touching] >= 0.0)
    np.testing.assert_allclose(np.angle((flank - pins) / np.exp(1j * contacts.pins.direction)), 0.0, atol=1e-9)
    hole = np.abs(contacts.hole_points - placement.hole_centres)
    np.testing.assert_allclose(hole, placement.hole_radii, rtol=1e-12)
    np.testing.assert_allclose(np.abs(contacts.bore_points), placement.bore_radius, rtol=1e-12)


def test_reverse_rotation_is_the_mirror_image(drive: Drive) -> None:
    reverse = replace(drive, load=replace(drive.load, direction="cw"))
    forward, mirrored = expect_contacts(drive, 0.4), expect_contacts(reverse, -0.4)
    order = -np.arange(14) % 14
    np.testing.assert_allclose(mirrored.pins.load[order], forward.pins.load, atol=1e-2)
    np.testing.assert_allclose(mirrored.holes.load[-np.arange(8) % 8], forward.holes.load, atol=1e-2)
    assert mirrored.wheel_angle == pytest.approx(-forward.wheel_angle, rel=1e-6)
    assert mirrored.disc_x == pytest.approx(forward.disc_x, abs=1e-8)
    assert mirrored.disc_y == pytest.approx(-forward.disc_y, abs=1e-8)


def test_half_widths_follow_hertz_and_have_a_floor(drive: Drive) -> None:
    contacts = expect_contacts(drive, 0.5)
    heavy = int(np.argmax(contacts.rollers_outer.load))
    load = contacts.rollers_outer.load[heavy] / drive.crank_bearing.roller_length
    modulus = 206e3 / (2.0 * (1.0 - 0.09))
    concave, convex = 5.0 * 29.5 / 24.5, 5.0 * 19.5 / 24.5
    assert contacts.rollers_outer.half_width[heavy] == pytest.approx(np.sqrt(4 * load * concave / (np.pi * modulus)))
    assert contacts.rollers_inner.half_width[heavy] == pytest.approx(np.sqrt(4 * load * convex / (np.pi * modulus)))
    for group in (contacts.pins, contacts.rollers_outer, contacts.holes):
        refined = group.half_width > 0.0
        assert np.all(refined[group.load > 0.0])
        # The effective radius of flank contacts varies by some tens of per cent, the square root of it less.
        assert group.half_width[refined].min() > 0.8 * np.sqrt(0.05) * group.half_width[np.argmax(group.load)]
