"""The Chinese handbook method for sleeved pins that bend (Li Lixing, Guan Tianmin; also patent CN105404737A): gaps and loads.

16 pins of radius 2.5 on 25.5 mm, each bending as a bar of diameter 3 that spans 16; 14.18 N·m on one disc. The method turns a
rigid disc about its centre until approaches, taken as the load by a constant, balance the moment: no bearing yields. It leaves
out shear and takes the load over half the span, so its largest approach is 18.25 µm, 14.05 of it bending; of a disc 4.5 thick
with shear the bending is 16.1 µm at the same force.
"""

import numpy as np
import pytest

from ltca.analysis.loaded_analysis import analyse
from ltca.drive.single_discs import single_discs
from ltca.geometry.pairs import ContactGeometry
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import build_drive

EQUIDISTANT, SHIFTING = 0.057238, 0.047238
"""Their Δr_rp, and their Δr_p with our sign: radial gap 0.01."""
PRINTED = [189.6, 273.0, 273.2, 239.3, 177.9, 90.4]
"""Pins from 22.5° on every 22.5°, N."""


@pytest.fixture(scope="module")
def drive():
    wheel = {
        "number_of_pins": 16, "pin_circle_radius": 25.5, "pin_radius": 2.5,
        "beam": {"span": 16.0, "ends": "supported", "diameter": 3.0},
    }  # fmt: skip
    disc = {
        "number_of_teeth": 15, "thickness": 4.5, "number_of_discs": 2, "planes": [-4.0, 4.0],
        "equidistant_offset": EQUIDISTANT, "shifting_offset": SHIFTING,
    }  # fmt: skip
    bearing = {
        "inner_race_radius": 7.0, "outer_race_radius": 8.0, "number_of_rollers": 44, "roller_radius": 0.5, "roller_length": 4.5
    }  # fmt: skip
    shaft = {
        "number_of_pins": 8, "pin_circle_radius": 15.5, "pin_radius": 2.0, "hole_radius": 2.9, "stiffness": 1e7
    }  # fmt: skip
    return build_drive({
        "installation": {"held": "pin-wheel"}, "crank": {"eccentricity": 0.9}, "pin_wheel": wheel, "disc": disc,
        "crank_bearing": bearing, "pin_shaft": shaft, "load": {"torque": 2.0 * 0.55 * 25_785.0, "light_torque": 500.0},
    })  # fmt: skip


def test_gaps_after_a_turn_of_the_wheel(drive):
    geometry = ContactGeometry.of_drive(single_discs(drive)[0])
    ours = -geometry.flank(np.zeros(1), np.zeros((1, 4))).approach[0]
    angle, shortening = 2.0 * np.pi * np.arange(16) / 16, 0.9 * 16 / 25.5
    root = np.sqrt(1.0 - shortening**2)
    distance = np.sqrt(1.0 + shortening**2 - 2.0 * shortening * np.cos(angle))
    lever = np.sin(angle) / distance
    moved = 1.0 - shortening * np.cos(angle) - root * np.sin(angle)
    theirs = EQUIDISTANT * (1.0 - lever) - SHIFTING * moved / distance
    # Theirs is zero where the lever is longest, cos φ = K1: the wheel is turned by what closes the gap there.
    turn = np.linalg.lstsq(lever[:, None], ours - theirs, rcond=None)[0][0]
    np.testing.assert_allclose(ours - turn * lever, theirs, rtol=0.0, atol=2e-4)
    assert np.ptp(theirs) > 0.03  # of gaps up to 36 µm


@pytest.mark.parametrize(
    ("changed", "apart"),
    [
        # A bearing that hardly yields, as the method has it.
        ({"materials.roller.youngs_modulus": 1e8, "materials.inner_race.youngs_modulus": 1e8}, 0.03),
        # Steel: the disc gives way to its resultant, and load moves to pins that it approaches.
        ({}, 0.10),
    ],
)
def test_loads(drive, changed, apart):
    found = analyse(with_fields(drive, changed), np.zeros(1)).discs[0].full.response.pin_load[0]
    np.testing.assert_allclose(found[1:7], PRINTED, rtol=apart)
    if changed:
        assert np.count_nonzero(found) == 6
    assert found.max() == pytest.approx(278.5, rel=apart)
