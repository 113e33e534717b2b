"""Four errors at one pin: changes of the gap and the turn that restores contact, from the instant centre of a four-bar.

15 pins of radius 18 on 130 mm, 14 lobes, e = 5. The pin stands at 0°, the centre of the disc in the direction φ from the
wheel's axis; in the frame of the pin shaft that is a crank at φ_C = φ z_P/z_C. One error at a time; the change of the normal
gap is that of the first order, and the disc turns by it over the lever of the normal. The wheel's lever is z_P/z_C of the
disc's. Pin circle, pin radius and eccentricity are `pin_errors.radial`, half of `pin_errors.diameter` and
`crank.eccentricity_error`.
"""

import numpy as np
import pytest

from ltca.geometry.coordinates import DISC_ROTATION, WHEEL_ANGLE
from ltca.geometry.pairs import ContactGeometry
from ltca.reading.drive_file import build_drive

PINS = 15
ERRORS = {
    "pin circle": {"pin_wheel": {"pin_errors": {"radial": [0.025] * PINS}}},
    "pin radius": {"pin_wheel": {"pin_errors": {"diameter": [0.022] * PINS}}},
    "eccentricity": {"crank": {"eccentricity_error": 0.008}},
}
PRINTED = {
    -60.0: (69.7255, 74.7059, (20.4598, 0.01681), (-11.0, -0.00904), (0.7078, 0.00058)),
    -90.0: (60.6330, 64.9639, (21.6546, 0.02046), (-11.0, -0.01039), (3.9978, 0.00378)),
    -120.0: (43.8671, 47.0005, (23.3089, 0.03044), (-11.0, -0.01437), (6.2343, 0.00814)),
}
"""By the direction of the disc's centre, °: levers about disc and wheel, mm; of each error the change of the gap, µm, and the
turn of the disc, °."""


def gap_and_levers(error, direction):
    """Gap of pin 0 without load, mm, and the levers of its normal about disc and wheel, mm."""
    plain = {
        "crank": {"eccentricity": 5.0},
        "pin_wheel": {"number_of_pins": PINS, "pin_circle_radius": 130.0, "pin_radius": 18.0},
        "disc": {"number_of_teeth": 14, "thickness": 20.0},
        "crank_bearing": {
            "inner_race_radius": 26.0, "outer_race_radius": 38.0, "number_of_rollers": 14, "roller_radius": 6.0,
            "roller_length": 20.0,
        },
        "pin_shaft": {
            "number_of_pins": 8, "pin_circle_radius": 72.0, "pin_radius": 10.0, "hole_radius": 15.0, "stiffness": 1e6
        },
        "load": {"torque": 500e3, "light_torque": 5e3},
    }  # fmt: skip
    table = {section: entries | ERRORS.get(error, {}).get(section, {}) for section, entries in plain.items()}
    geometry = ContactGeometry.of_drive(build_drive(table))
    found = geometry.flank(np.array([np.radians(direction) * PINS / 14.0]), np.zeros((1, 4)))
    disc, wheel = found.gradient[0, 0, [DISC_ROTATION, WHEEL_ANGLE]]
    return -found.approach[0, 0], disc, wheel


@pytest.mark.parametrize("direction", PRINTED)
def test_errors_at_one_pin(direction):
    disc, wheel, *printed = PRINTED[direction]
    gap, lever, other = gap_and_levers("", direction)
    assert gap == pytest.approx(0.0, abs=1e-12)  # mm: round-off of 130
    # One unit of the last printed digit.
    assert (abs(lever), abs(other)) == pytest.approx((disc, wheel), abs=1e-4)
    assert lever * other < 0.0
    for error, (change, turn) in zip(ERRORS, printed, strict=True):
        gap, *_ = gap_and_levers(error, direction)
        # Half a unit of the last digit (of −11 all digits), and the second order: an error moves the pin by up to 0.02 mm along
        # a trochoid that bends with 30 mm and more, 0.02²/60 mm = 0.007 µm; of the turn that is 6e-6°.
        assert 1e3 * gap == pytest.approx(change, abs=7e-3)
        assert np.degrees(gap / abs(lever)) == pytest.approx(turn, abs=1.1e-5)
