"""Contact without load: first contact against root finding on plain geometry, signs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from ltca.errors import ConvergenceError
from ltca.geometry.coordinates import DISC_ROTATION, WHEEL_ANGLE
from ltca.geometry.first_contact import (
    backlash,
    first_contact,
    interference,
)
from ltca.geometry.pairs import ContactGeometry


def smallest_gap(drive, crank, disc_rotation, wheel_angle):
    """Least distance of any pin from Eq. 1's flank: samples in two rounds, a parabola through the lowest three."""
    wheel, e = drive.pin_wheel, drive.crank.eccentricity
    z = wheel.number_of_pins
    R = wheel.pin_circle_radius + drive.disc.shifting_offset
    r = wheel.pin_radius + drive.disc.equidistant_offset
    pins = wheel.pin_circle_radius * np.exp(1j * (crank / z + wheel_angle + 2.0 * np.pi * np.arange(z) / z))
    step = 2.0 * np.pi / (200 * z)

    def distance(theta):
        psi = np.arctan2(np.sin((1 - z) * theta), R / (e * z) - np.cos((1 - z) * theta))
        flank = R * np.exp(1j * theta) - r * np.exp(1j * (theta + psi)) - e * np.exp(1j * z * theta)
        return np.abs(pins[:, None] - e * np.exp(1j * crank) - flank * np.exp(1j * disc_rotation))

    everywhere = step * np.arange(200 * z)
    lowest = everywhere[np.argmin(distance(everywhere[None, :]), axis=1)]
    near = distance(lowest[:, None] + step * np.linspace(-1.0, 1.0, 81))
    rows, at = np.arange(z), np.argmin(near, axis=1).clip(1, 79)
    left, middle, right = (near[rows, at + k] for k in (-1, 0, 1))
    vertex = middle - (right - left) ** 2 / (8.0 * (right - 2.0 * middle + left))
    return float(np.min(vertex)) - wheel.pin_radius


@pytest.mark.parametrize("crank", [0.0, 1.234, 5.1])
def test_first_contact_against_root_finding(paper_cases, crank):
    drive = paper_cases["CS-1"]
    geometry = ContactGeometry.of_drive(drive)
    for coordinate in (DISC_ROTATION, WHEEL_ANGLE):
        for sense in (1, -1):
            found, pin = first_contact(geometry, np.array([crank]), coordinate, sense)

            def gap(turn, coordinate=coordinate):
                return smallest_gap(drive, crank, *((turn, 0.0) if coordinate == DISC_ROTATION else (0.0, turn)))

            # 0.004 rad is beyond the backlash of 10′ = 0.003 rad: that far the bodies overlap
            expected = brentq(gap, 0.0, sense * 0.004, xtol=1e-12)
            # the parabola over 1/8000 of a tooth leaves some 1e-12 mm of the gap, at lever arms of 30 mm and more
            assert found[0] == pytest.approx(expected, abs=1e-11)
            pose = np.zeros((1, 4))
            pose[0, coordinate] = found[0]
            approach = geometry.flank(np.array([crank]), pose).approach[0]
            assert np.argmax(approach) == pin[0]
            assert approach[pin[0]] == pytest.approx(0.0, abs=1e-12)


def with_offsets(drive, equidistant, shifting):
    return replace(drive, disc=replace(drive.disc, equidistant_offset=equidistant, shifting_offset=shifting))


@pytest.mark.parametrize("crank", [0.004, 0.9, 1.234, 5.1])
def test_equal_offsets_have_a_small_backlash(paper_cases, crank):
    """A pin whose normal points at the axis stops the wheel: "no pin touches the flank" was the answer."""
    drive = with_offsets(paper_cases["CS-1"], 0.1, 0.1)
    geometry = ContactGeometry.of_drive(drive)
    for sense in (1, -1):
        found, _ = first_contact(geometry, np.array([crank]), WHEEL_ANGLE, sense)
        expected = brentq(lambda turn: smallest_gap(drive, crank, 0.0, turn), 0.0, sense * 0.001, xtol=1e-13)
        # the gap of such a pin grows with a hundredth of a usual lever arm: 1e-12 mm of it are some 1e-11 rad
        assert found[0] == pytest.approx(expected, abs=2e-11)
        assert 1e-7 < sense * found[0] < 1e-4


def test_equal_offsets_have_no_backlash_where_a_normal_points_at_the_axis(paper_cases):
    geometry = ContactGeometry.of_drive(with_offsets(paper_cases["CS-1"], 0.1, 0.1))
    # φ_C = 0 and every pitch of the flank: a root of the flank stands before a pin
    angles = 2.0 * np.pi / 13.0 * np.arange(6)
    # the gap there grows with the square of the rotation: its round-off of 1e-13 mm is some 1e-8 rad
    assert np.all(np.abs(backlash(geometry, angles, WHEEL_ANGLE)) < 1e-7)
    assert np.all(backlash(geometry, angles + 0.05, WHEEL_ANGLE) > 1e-5)


@pytest.mark.parametrize("pins", [6, 40, 90, *(pytest.param(pins, marks=pytest.mark.slow) for pins in (30, 60, 76))])
def test_unmodified_flanks_have_no_backlash(paper_cases, pins):
    """All loaded pins touch at once: at some numbers of pins round-off was taken for interference."""
    drive = with_offsets(paper_cases["CS-1"], 0.0, 0.0)
    scale = 14.0 / pins
    wheel = replace(drive.pin_wheel, number_of_pins=pins, pin_radius=drive.pin_wheel.pin_radius * min(scale, 1.0))
    disc = replace(drive.disc, number_of_teeth=pins - 1)
    crank = replace(drive.crank, eccentricity=drive.crank.eccentricity * scale)
    drive = replace(drive, pin_wheel=wheel, disc=disc, crank=crank)
    geometry = ContactGeometry.of_drive(drive)
    angles = np.linspace(0.0, 2.0 * np.pi, 25)
    for coordinate in (DISC_ROTATION, WHEEL_ANGLE):
        # round-off of 1e-13 mm where the lever arm of a touching pin may be a thousandth of 56 mm
        np.testing.assert_allclose(backlash(geometry, angles, coordinate), 0.0, atol=1e-11)


@pytest.mark.parametrize("growth", [0.0, 0.004, 0.03])
def test_pins_larger_than_their_flank_interfere_by_what_they_are_larger(paper_cases, growth):
    """Every pin touches an unmodified flank: larger by as much they press by as much, wherever their normals point."""
    geometry = ContactGeometry.of_drive(with_offsets(paper_cases["CS-1"], 0.0, 0.0))
    placement = replace(geometry.placement, wheel_pin_radii=geometry.placement.wheel_pin_radii + growth)
    found = interference(replace(geometry, placement=placement), np.linspace(0.0, 2.0 * np.pi, 9))
    # round-off of places, some 1e-13 mm
    np.testing.assert_allclose(found, growth, rtol=0.0, atol=1e-12)


@pytest.mark.slow
def test_flanks_that_overlap_every_pin_have_no_backlash(paper_cases):
    """The pins whose normals point at the axis were followed: a backlash of −179506′."""
    geometry = ContactGeometry.of_drive(with_offsets(paper_cases["CS-1"], -0.01, 0.0))
    angles = np.linspace(0.0, 2.0 * np.pi, 25)
    for coordinate in (DISC_ROTATION, WHEEL_ANGLE):
        for sense in (1, -1):
            # all pins are in the same place against the flank: the ideal angle is that of least interference;
            # overlaps grow with the rotation times 56 mm at most, so 1e-9 rad are far above their round-off of 1e-13 mm
            np.testing.assert_allclose(first_contact(geometry, angles, coordinate, sense)[0], 0.0, atol=1e-9)
    np.testing.assert_allclose(interference(geometry, angles), 0.01, rtol=0.0, atol=1e-11)


def test_backlash_is_the_sum_of_both_senses_and_positive(random_drives):
    for drive in random_drives:
        geometry = ContactGeometry.of_drive(drive)
        angles = np.linspace(0.0, 6.0, 13)
        for coordinate in (DISC_ROTATION, WHEEL_ANGLE):
            play = backlash(geometry, angles, coordinate)
            assert np.all(play > 0.0)
            rotation, _ = first_contact(geometry, angles, coordinate, 1)
            back, _ = first_contact(geometry, angles, coordinate, -1)
            np.testing.assert_allclose(play, rotation - back)


def test_nothing_touches_when_no_pin_can(paper_cases):
    geometry = ContactGeometry.of_drive(paper_cases["CS-1"])
    # a wheel of a single pin too thin for its flank
    lone = replace(
        geometry,
        placement=replace(
            geometry.placement,
            wheel_pin_centres=geometry.placement.wheel_pin_centres[:1],
            wheel_pin_radii=geometry.placement.wheel_pin_radii[:1] - 10.0,
            wheel_pin_plays=geometry.placement.wheel_pin_plays[:1],
        ),
    )
    with pytest.raises(ConvergenceError, match="no pin touches"):
        first_contact(lone, np.array([0.0]), WHEEL_ANGLE, 1)
