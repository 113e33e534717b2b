"""Gaps of a flank with harmonics against Cycloidal Studio (SHKinsem/cycloidal-studio, MIT, commit 52a00d1, optimizer/model.py).

19 pins of radius 2.5 on 34 mm, 18 lobes, e = 1.5. It searches 8000 points of the flank for the one nearest to each pin and
shares nothing with this code. Its modification of the flank along the normal is −0.0254 − 0.0034 cos 18θ' − 0.0081 cos 36θ'
mm, positive where metal is left, with a point at θ' = 0 at the tip of a lobe. θ is 0 in a root here, half a lobe away:
cos 18θ' = −cos 18θ, cos 36θ' = cos 36θ, and the constant is an equidistant offset, positive where metal is taken away.

With the wheel held its ψ puts the disc's centre at −e (cos ψ, sin ψ) and pin k at 2πk/19. Here the crank stands at φ_C of the
pin shaft's frame, in which the wheel has turned by φ_C/19: ψ + π = φ_C (1 − 1/19), so ψ = 0 is φ_C = 19π/18.
"""

import numpy as np
import pytest

from ltca.geometry.coordinates import DISC_ROTATION, WHEEL_ANGLE
from ltca.geometry.first_contact import backlash
from ltca.geometry.pairs import ContactGeometry
from ltca.reading.drive_file import build_drive

PINS = 19
GAPS = np.array([36.900, 35.000, 30.048, 23.972, 19.086, 17.135, 18.496, 22.196, 26.650, 29.702])
"""Of pins 0 … 9 at ψ = 0, µm; pins k and 19 − k mirror each other."""
LEVERS = np.array([0.0, 4.8127, 9.4941, 13.9148, 17.9482, 21.4680, 24.4501, 26.5754, 27.1840, 20.5572])
"""Of their normals about the disc's centre, mm."""
HERE, WORST = 5.2011, 5.2299
"""Backlash of the disc at ψ = 0 and the largest over a period, crank and wheel held, arc minutes."""
ARCMIN = 180.0 * 60.0 / np.pi


@pytest.fixture(scope="module")
def geometry():
    drive = build_drive({
        "crank": {"eccentricity": 1.5},
        "pin_wheel": {"number_of_pins": PINS, "pin_circle_radius": 34.0, "pin_radius": 2.5},
        "disc": {
            "number_of_teeth": 18, "thickness": 8.0, "equidistant_offset": 0.0254, "shifting_offset": 0.0,
            "profile_errors": {"orders": [18, 36], "cosine": [0.0034, -0.0081], "sine": [0.0, 0.0]},
        },
        "crank_bearing": {
            "inner_race_radius": 7.0, "outer_race_radius": 10.0, "number_of_rollers": 12, "roller_radius": 1.5,
            "roller_length": 8.0,
        },
        "pin_shaft": {
            "number_of_pins": 6, "pin_circle_radius": 19.0, "pin_radius": 2.5, "hole_radius": 4.0, "stiffness": 1e6
        },
        "load": {"torque": 50e3, "light_torque": 500.0},
    })  # fmt: skip
    return ContactGeometry.of_drive(drive)


def crank_angle_at(psi):
    """φ_C of their crank angles."""
    return (np.atleast_1d(psi) + np.pi) * PINS / 18.0


def gaps_and_levers(geometry, crank_angle):
    """Gaps, mm, and how they close by a turn of the disc, mm/rad, shape (positions, pins)."""
    found = geometry.flank(crank_angle, np.zeros((crank_angle.size, 4)))
    return -found.approach, found.gradient[..., DISC_ROTATION]


def gaps_and_levers_at_points(geometry, crank_angle, count):
    """The same from the nearest of so many points of this flank, one of them at a tip."""
    points = geometry.profile.flank(2.0 * np.pi * np.arange(count) / count + np.pi / 18.0)
    wheel = geometry.placement
    gaps, levers = [], []
    for angle in crank_angle:
        disc = 1.5 * np.exp(1j * angle)
        pins = wheel.wheel_pin_centres * np.exp(1j * angle / PINS) - disc
        nearest = points[[np.argmin(np.abs(points - pin)) for pin in pins]]
        gaps.append(np.abs(pins - nearest) - 2.5)
        levers.append((nearest.conj() * (pins - nearest) / np.abs(pins - nearest)).imag)
    return np.array(gaps), np.array(levers)


def small_turns(gap, lever):
    """Free turn of the disc both ways where gaps close in proportion, arc minutes."""
    ways = [np.where(way * lever > 1e-6, gap, np.inf) / np.abs(lever) for way in (1.0, -1.0)]
    return sum(np.min(way, axis=-1) for way in ways) * ARCMIN


def test_gaps_and_levers(geometry):
    there = gaps_and_levers_at_points(geometry, crank_angle_at(0.0), 8000)
    here = gaps_and_levers(geometry, crank_angle_at(0.0))
    for pins in (np.arange(10), (PINS - np.arange(10)) % PINS):
        # At their points: one unit of the last printed digit.
        np.testing.assert_allclose(1e3 * there[0][0, pins], GAPS, rtol=0.0, atol=1e-3)
        np.testing.assert_allclose(np.abs(there[1][0, pins]), LEVERS, rtol=0.0, atol=1e-4)
        # The flank itself is never farther than a point of it, and nearer by less than s²/2 (1/r_P + 1/r) of half a step, 0.016
        # mm at the tips, and of a flank of 2 mm and more: 0.1 µm. The normal turns by s/r_P there, at a lever of 35 mm.
        assert np.all(there[0] - here[0] > -1e-9)
        assert np.all(there[0] - here[0] < 1e-4)
        np.testing.assert_allclose(here[1], there[1], rtol=0.0, atol=35.0 * 0.016 / 2.5)
    # Mirrored pins stop the disc either way.
    np.testing.assert_allclose(here[1][0, 1:10], -here[1][0, :9:-1], rtol=0.0, atol=1e-9)


def test_backlash(geometry):
    # 48 angles of the crank over a period, as theirs.
    angle = crank_angle_at(2.0 * np.pi / 18.0 * np.arange(48) / 48.0)
    there = small_turns(*gaps_and_levers_at_points(geometry, angle, 8000))
    # One unit of the last printed digit.
    assert there[0] == pytest.approx(HERE, abs=1e-4)
    assert there.max() == pytest.approx(WORST, abs=1e-4)
    # Levers of points are off by up to a hundredth.
    here = small_turns(*gaps_and_levers(geometry, angle))
    np.testing.assert_allclose(here, there, rtol=1e-2)
    # Turned until pins touch, by 0.76 mrad each way, they also slide 0.02 mm along a flank that bends with 5 mm and more:
    # 0.02²/10 mm = 0.04 µm of a gap of 18 µm.
    exact = backlash(geometry, angle, DISC_ROTATION) * ARCMIN
    np.testing.assert_allclose(exact, here, rtol=2.5e-3)
    # At the wheel the disc's turn counts as z_C/z_P of it.
    wheel = backlash(geometry, angle, WHEEL_ANGLE) * ARCMIN
    np.testing.assert_allclose(wheel, 18.0 / 19.0 * exact, rtol=1e-3)
