"""Where parts stand: conventions of the design, errors entering exactly."""

from __future__ import annotations

import numpy as np
import pytest

from ltca.arrays import stack_drives
from ltca.drive.single_discs import single_discs
from ltca.geometry.placement import Placement
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import parse_drive, shipped_drive


def test_numbering_starts_at_zero_and_runs_counter_clockwise(vary):
    place = Placement.of_drive(vary())
    np.testing.assert_allclose(place.wheel_pin_centres[:2], 88.0 * np.exp(2j * np.pi * np.array([0, 1]) / 14))
    np.testing.assert_allclose(place.hole_centres[3], 56.0 * np.exp(2j * np.pi * 3 / 8))
    np.testing.assert_allclose(place.shaft_pin_centres, place.hole_centres)
    # θ_b,n = r_i φ/(r_i + r_o) + 2πn/n_BR
    np.testing.assert_allclose(
        place.roller_angles(np.array([1.5]))[0], 19.5 * 1.5 / 49.0 + 2.0 * np.pi * np.arange(11) / 11
    )
    assert complex(place.races(np.array(0.7)).middle) == pytest.approx(4.0 * np.exp(0.7j))
    assert float(place.wheel_rotation(np.array(1.4))) == pytest.approx(0.1)


def test_clearances_bearing_diametral_and_hole_whole(vary):
    place = Placement.of_drive(vary(clearance={"bearing": 0.03, "pin_hole": 0.02}))
    assert place.bore_radius == pytest.approx(29.515, rel=1e-15)
    np.testing.assert_allclose(place.hole_radii - place.shaft_pin_radii, 4.02, rtol=1e-13)
    # the cage turns with the nominal outer race, the clearance is not in it
    assert place.cage_speed == pytest.approx(19.5 / 49.0, rel=1e-15)


def test_effective_radii_of_rollers_and_holes(vary):
    """Convex on convex r₁r₂/(r₁ + r₂), in a bore or a hole r₁r₂/(r₂ − r₁); the roller that is 10 µm larger alone."""
    larger = {"diameter": [0.0] * 9 + [0.01, 0.0]}
    drive = vary(crank_bearing={"roller_errors": larger}, clearance={"pin_hole": 0.02})
    place = Placement.of_drive(drive)
    radii = np.where(np.arange(11) == 9, 5.005, 5.0)
    np.testing.assert_allclose(place.inner_effective_radii, radii * 19.5 / (radii + 19.5), rtol=1e-14)
    np.testing.assert_allclose(place.outer_effective_radii, radii * 29.5 / (29.5 - radii), rtol=1e-14)
    pin = drive.pin_shaft.pin_radius
    np.testing.assert_allclose(place.hole_effective_radii, pin * (pin + 4.02) / 4.02, rtol=1e-12)
    both = stack_drives([place, Placement.of_drive(vary())], positions=2)
    np.testing.assert_allclose(both.inner_effective_radii[:, 9], [5.005 * 19.5 / 24.505] * 2 + [5 * 19.5 / 24.5] * 2)
    assert both.outer_effective_radii.shape == (4, 11)


def test_errors_move_and_resize_one_part_only(vary):
    def one(count, number, value):
        return [value if n == number else 0.0 for n in range(count)]

    pins = {"radial": one(14, 3, 0.02), "tangential": one(14, 5, -0.03), "diameter": one(14, 7, 0.04)}
    holes = {"radial": one(8, 1, 0.02), "tangential": one(8, 2, -0.03), "diameter": one(8, 4, 0.04)}
    rollers = {"tangential": one(11, 2, -0.05), "diameter": one(11, 9, 0.01)}
    nominal = Placement.of_drive(vary())
    place = Placement.of_drive(
        vary(
            pin_wheel={"pin_errors": pins},
            disc={"hole_errors": holes},
            pin_shaft={"pin_errors": holes},
            crank_bearing={"roller_errors": rollers},
        )
    )
    ray = np.exp(2j * np.pi * np.arange(14) / 14)
    moved = (place.wheel_pin_centres - nominal.wheel_pin_centres) / ray
    np.testing.assert_allclose(moved, np.array(pins["radial"]) + 1j * np.array(pins["tangential"]), atol=2e-14)
    np.testing.assert_allclose(place.wheel_pin_radii, 6.5 + 0.5 * np.array(pins["diameter"]))
    ray = np.exp(2j * np.pi * np.arange(8) / 8)
    for centres in (place.hole_centres, place.shaft_pin_centres):
        moved = (centres - nominal.hole_centres) / ray
        np.testing.assert_allclose(moved, np.array(holes["radial"]) + 1j * np.array(holes["tangential"]), atol=2e-14)
    np.testing.assert_allclose(place.hole_radii - 14.075, 0.5 * np.array(holes["diameter"]), atol=1e-14)
    np.testing.assert_allclose(place.shaft_pin_radii - 10.075, 0.5 * np.array(holes["diameter"]), atol=1e-14)
    np.testing.assert_allclose(place.roller_radii - 5.0, 0.5 * np.array(rollers["diameter"]), atol=1e-14)
    turned = place.roller_cage_angles - nominal.roller_cage_angles
    np.testing.assert_allclose(turned, np.array(rollers["tangential"]) / 24.5, atol=1e-15)


def test_eccentrics_of_several_cranks_stand_where_their_errors_put_them():
    """Race k of disc 0 is at (e + Δe_k) e^{i(φ_C + ζ + Δζ_k)} from its crank; the disc stands at the mean of the races."""
    drive = parse_drive(shipped_drive("rv"), "rv").cases["nominal"]
    drive = with_fields(drive, {"crank.of.0.eccentricity_error": 0.006, "crank.of.2.phase_error": 2e-3})
    place, angle = Placement.of_drive(single_discs(drive)[0]), np.array([0.0, 1.1])
    arms = place.races(angle).centre - place.crank_axes
    lengths, ahead = drive.crank.eccentricity + np.array([0.006, 0.0, 0.0]), np.array([0.0, 0.0, 2e-3])
    np.testing.assert_allclose(arms, lengths * np.exp(1j * (angle[:, None] + ahead)), rtol=0.0, atol=1e-13)
    np.testing.assert_allclose(place.mean_eccentricity, [drive.crank.eccentricity + 0.002], rtol=1e-14)
    np.testing.assert_allclose(place.races(angle).middle, place.races(angle).centre.mean(axis=1), rtol=0.0, atol=1e-14)
