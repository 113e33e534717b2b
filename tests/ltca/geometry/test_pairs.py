"""Approaches of pairs against plain geometry, their derivatives against finite differences."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from ltca.geometry.coordinates import DISC_ROTATION, WHEEL_ANGLE, X, Y, disc_displacement
from ltca.geometry.pairs import ContactGeometry

POSE_SIZE = 0.03  # mm: as far as clearances and loads carry the disc


@pytest.fixture(scope="module")
def drives(paper_cases, random_drives):
    return [paper_cases["CS-6"], *random_drives]


def random_poses(drive, count, seed):
    """Crank angles over several turns and poses of about a clearance; the angles have the disc's radius as lever."""
    rng = np.random.default_rng(seed)
    size = POSE_SIZE * drive.pin_wheel.pin_circle_radius / 88.0
    scale = size / np.array([1.0, 1.0, drive.pin_wheel.pin_circle_radius, drive.pin_wheel.pin_circle_radius])
    return rng.uniform(-20.0, 20.0, count), rng.uniform(-1.0, 1.0, (count, 4)) * scale


def part(errors, name, number):
    values = getattr(errors, name)
    return values[number] if values else 0.0


def brute_flank_approach(drive, crank, pose, pin):
    """Pin radius less the least distance of the pin centre from Eq. 1's flank, all in the fixed frame."""
    wheel, e = drive.pin_wheel, drive.crank.eccentricity
    z = wheel.number_of_pins
    errors = wheel.pin_errors
    turn = crank / z + pose[3] + 2.0 * np.pi * pin / z
    centre = (wheel.pin_circle_radius + part(errors, "radial", pin) + 1j * part(errors, "tangential", pin)) * np.exp(
        1j * turn
    )
    disc = e * np.exp(1j * crank) + pose[0] + 1j * pose[1]
    R = wheel.pin_circle_radius + drive.disc.shifting_offset
    r = wheel.pin_radius + drive.disc.equidistant_offset

    def distance(theta):
        psi = np.arctan2(np.sin((1 - z) * theta), R / (e * z) - np.cos((1 - z) * theta))
        flank = R * np.exp(1j * theta) - r * np.exp(1j * (theta + psi)) - e * np.exp(1j * z * theta)
        return np.abs(disc + np.exp(1j * pose[2]) * flank - centre)

    grid = np.linspace(0.0, 2.0 * np.pi, 300 * z, endpoint=False)
    best, width = grid[np.argmin(distance(grid))], 2.0 * np.pi / (300 * z)
    least = minimize_scalar(distance, bounds=(best - width, best + width), method="bounded", options={"xatol": 1e-12})
    return wheel.pin_radius + 0.5 * part(errors, "diameter", pin) - least.fun


def test_flank_approach_against_brute_force_with_errors(drives):
    for drive in drives[:4]:
        geometry = ContactGeometry.of_drive(drive)
        angles, poses = random_poses(drive, 2, 5)
        approach = geometry.flank(angles, poses).approach
        for row in range(2):
            for pin in range(0, drive.pin_wheel.number_of_pins, 3):
                expected = brute_flank_approach(drive, angles[row], poses[row], pin)
                # round-off of places of the size of the pin circle
                tolerance = 1e-12 * drive.pin_wheel.pin_circle_radius
                assert approach[row, pin] == pytest.approx(expected, abs=tolerance)


def test_nominal_gaps_vanish_without_offsets(vary, random_drives):
    angles = np.random.default_rng(6).uniform(-50.0, 50.0, 40)
    geometry = ContactGeometry.of_drive(vary(disc={"equidistant_offset": 0.0, "shifting_offset": 0.0}))
    # 1e-16 of the argument z_P θ ~ 50 rad on a radius of 88 mm
    np.testing.assert_allclose(geometry.flank(angles, np.zeros((40, 4))).approach, 0.0, atol=1e-12)


def test_uniform_equidistant_offset_is_the_gap_of_every_pin(vary):
    geometry = ContactGeometry.of_drive(vary(disc={"equidistant_offset": 0.07, "shifting_offset": 0.0}))
    angles = np.linspace(0.0, 6.0, 17)
    np.testing.assert_allclose(geometry.flank(angles, np.zeros((17, 4))).approach, -0.07, atol=1e-13)


def test_hole_approach_against_plain_geometry(drives):
    for drive in drives:
        geometry = ContactGeometry.of_drive(drive)
        angles, poses = random_poses(drive, 3, 7)
        approach = geometry.holes(angles, poses).approach
        shaft, z = drive.pin_shaft, drive.pin_shaft.number_of_pins
        for row in range(3):
            centre = drive.crank.eccentricity * np.exp(1j * angles[row]) + poses[row, 0] + 1j * poses[row, 1]
            for k in range(z):
                ray = np.exp(2j * np.pi * k / z)
                places = []
                for errors in (shaft.pin_errors, drive.disc.hole_errors):
                    shift = part(errors, "radial", k) + 1j * part(errors, "tangential", k)
                    places.append((shaft.pin_circle_radius + shift) * ray)
                pin, hole = places[0], centre + np.exp(1j * poses[row, 2]) * places[1]
                play = (
                    shaft.hole_radius
                    + drive.clearance.pin_hole
                    + 0.5 * part(drive.disc.hole_errors, "diameter", k)
                    - shaft.pin_radius
                    - 0.5 * part(shaft.pin_errors, "diameter", k)
                )
                assert approach[row, k] == pytest.approx(abs(pin - hole) - play, abs=1e-13 * shaft.pin_circle_radius)


def curvatures(motion):
    """∂²δ/∂q² of every pair: what each alone bends under a unit load."""
    shape = motion.bending.shape
    return np.stack([motion.bend(np.broadcast_to(alone, shape)) for alone in np.eye(shape[1])], axis=1)


def test_gradients_and_curvatures_against_finite_differences(drives):
    for drive in drives:
        geometry = ContactGeometry.of_drive(drive)
        angles, poses = random_poses(drive, 4, 8)
        radius = drive.pin_wheel.pin_circle_radius
        lever = np.array([1.0, 1.0, radius, radius])
        step = 1e-5 * radius / lever
        for motion in (geometry.flank, geometry.holes):
            here = motion(angles, poses)
            for column in range(4):
                move = np.zeros(4)
                move[column] = step[column]
                ahead, behind = motion(angles, poses + move), motion(angles, poses - move)
                slope = (ahead.approach - behind.approach) / (2.0 * step[column])
                bend = (ahead.gradient - behind.gradient) / (2.0 * step[column])
                # h² by the third derivative (~1/r²) is 1e-10·(R/r)² ~ 1e-7; round-off 1e-15/1e-5
                np.testing.assert_allclose(here.gradient[..., column] / lever[column], slope / lever[column], atol=1e-6)
                scale = radius / (lever[column] * lever)
                np.testing.assert_allclose(
                    curvatures(here)[..., column] * scale,
                    bend * scale,
                    rtol=1e-5,
                    atol=1e-5 * np.max(np.abs(bend * scale)),
                )


def test_flank_force_acts_along_the_common_normal(drives):
    """The gradient by x, y is the unit normal; by the angles it is the lever of that normal about either centre."""
    for drive in drives:
        geometry = ContactGeometry.of_drive(drive)
        angles, poses = random_poses(drive, 3, 9)
        motion = geometry.flank(angles, poses)
        normal = motion.gradient[..., X] + 1j * motion.gradient[..., Y]
        np.testing.assert_allclose(np.abs(normal), 1.0, rtol=1e-13)
        # moving the disc toward the pin closes the gap: the normal points out of the disc
        own = geometry.profile.normal(motion.parameter) * np.exp(1j * poses[:, DISC_ROTATION, None])
        np.testing.assert_allclose(normal, own, atol=1e-13)
        disc = drive.crank.eccentricity * np.exp(1j * angles) + disc_displacement(poses)
        pins = geometry.placement.wheel_pin_centres * np.exp(
            1j * (angles / drive.pin_wheel.number_of_pins + poses[:, WHEEL_ANGLE])[:, None]
        )
        about_disc = ((pins - disc[:, None]).conjugate() * normal).imag
        about_wheel = (pins.conjugate() * normal).imag
        tolerance = 1e-12 * drive.pin_wheel.pin_circle_radius
        np.testing.assert_allclose(motion.gradient[..., DISC_ROTATION], about_disc, atol=tolerance)
        np.testing.assert_allclose(motion.gradient[..., WHEEL_ANGLE], -about_wheel, atol=tolerance)


def test_start_of_the_contact_parameter_does_not_matter(drives):
    for drive in drives[:3]:
        geometry = ContactGeometry.of_drive(drive)
        angles, poses = random_poses(drive, 3, 10)
        first = geometry.flank(angles, poses)
        z = drive.pin_wheel.number_of_pins
        shifted = np.random.default_rng(11).uniform(-0.3, 0.3, first.parameter.shape) / z
        second = geometry.flank(angles, poses, first.parameter + shifted)
        np.testing.assert_allclose(first.approach, second.approach, atol=1e-12 * drive.pin_wheel.pin_circle_radius)


def test_part_errors_change_the_approach_by_their_closed_form(vary):
    """One pin larger by 2ε: ε closer, at any pose. One pin moved by ε: its normal's part, to ε² κ/2."""
    size = 1e-4
    angles, poses = np.array([0.3, 2.0, 4.4]), np.array([[1e-2, -5e-3, 1e-4, -2e-4]] * 3)
    plain = ContactGeometry.of_drive(vary()).flank(angles, poses)
    normal = plain.gradient[..., X] + 1j * plain.gradient[..., Y]
    pin = 4
    ray = np.exp(1j * (angles / 14 - 2e-4 + 2.0 * np.pi * pin / 14))
    expected = {
        "diameter": np.full(3, 0.5 * size),
        "radial": -size * (normal[:, pin].conjugate() * ray).real,
        "tangential": -size * (normal[:, pin].conjugate() * 1j * ray).real,
    }
    for name, change in expected.items():
        errors = {name: [size if n == pin else 0.0 for n in range(14)]}
        moved = ContactGeometry.of_drive(vary(pin_wheel={"pin_errors": errors})).flank(angles, poses)
        difference = moved.approach - plain.approach
        # second order: ε²/2 over the smallest radius of the pin-centre path, (R − z e)²/(z² e − R) = 1.47 mm at a root
        np.testing.assert_allclose(difference[:, pin], change, atol=size**2 / 2.0 / 1.45 + 1e-13)
        # and no other pin feels it
        assert np.all(np.delete(difference, pin, axis=1) == 0.0)


def test_hole_and_shaft_pin_errors_change_the_approach_by_their_closed_form(vary):
    size, hole = 1e-4, 3
    angles, poses = np.array([0.3, 2.0]), np.array([[1e-2, -5e-3, 1e-4, 0.0]] * 2)
    plain = ContactGeometry.of_drive(vary()).holes(angles, poses)
    normal = plain.gradient[:, hole, 0] + 1j * plain.gradient[:, hole, 1]  # of a hole moving with the disc
    ray = np.exp(2j * np.pi * hole / 8)
    hole_ray = ray * np.exp(1e-4j)
    for part_name, sign, direction in (("disc", 1.0, hole_ray), ("pin_shaft", -1.0, ray)):
        for name, turn in (("radial", 1.0), ("tangential", 1j), ("diameter", None)):
            errors = {name: [size if n == hole else 0.0 for n in range(8)]}
            key = "hole_errors" if part_name == "disc" else "pin_errors"
            moved = ContactGeometry.of_drive(vary(**{part_name: {key: errors}})).holes(angles, poses)
            difference = (moved.approach - plain.approach)[:, hole]
            if turn is None:
                expected = np.full(2, -0.5 * sign * size)
            else:
                expected = sign * size * (normal.conjugate() * direction * turn).real
            # second order: ε²/2 over the distance of the centres, e = 4 mm
            np.testing.assert_allclose(difference, expected, atol=size**2 / 2.0 / 4.0 + 1e-13)


def test_zero_error_arrays_change_nothing(vary):
    """To the last bit."""
    zeros = {
        "pin_wheel": {"pin_errors": {n: [0.0] * 14 for n in ("radial", "tangential", "diameter")}},
        "disc": {"hole_errors": {n: [0.0] * 8 for n in ("radial", "tangential", "diameter")}},
        "pin_shaft": {"pin_errors": {n: [0.0] * 8 for n in ("radial", "tangential", "diameter")}},
        "crank_bearing": {"roller_errors": {n: [0.0] * 11 for n in ("tangential", "diameter")}},
    }
    plain, zeroed = ContactGeometry.of_drive(vary()), ContactGeometry.of_drive(vary(**zeros))
    angles, poses = np.linspace(0.0, 6.0, 9), np.full((9, 4), 1e-3)
    np.testing.assert_array_equal(plain.flank(angles, poses).approach, zeroed.flank(angles, poses).approach)
    np.testing.assert_array_equal(plain.holes(angles, poses).approach, zeroed.holes(angles, poses).approach)
    first, second = plain.rollers(angles), zeroed.rollers(angles)
    np.testing.assert_array_equal(first.direction, second.direction)
    np.testing.assert_array_equal(first.bore_play, second.bore_play)


def test_touching_distance_of_rollers(drives):
    """At that distance on its ray a roller touches the displaced bore from inside, on the far side."""
    for drive in drives:
        geometry = ContactGeometry.of_drive(drive)
        angles, poses = random_poses(drive, 3, 12)
        rays = geometry.rollers(angles)
        displacement = disc_displacement(poses)[:, None]
        centre = rays.touching(rays.direction.conjugate() * displacement) * rays.direction
        reach = np.abs(centre - displacement) + geometry.placement.roller_radii
        np.testing.assert_allclose(reach, geometry.placement.bore_radius, rtol=1e-14)
        assert np.all(rays.touching(rays.direction.conjugate() * displacement) > 0.0)
