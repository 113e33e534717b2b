"""What friction adds to a dataset: product of pressure and speed."""

from dataclasses import replace

import numpy as np
import pytest

from ltca.analysis.friction.variables import friction_values
from ltca.analysis.loaded_analysis import analyse
from ltca.drive.parts import Friction
from ltca.reading.drive_file import load_drive


@pytest.mark.parametrize(("seat", "rolls"), [(0.01, True), (0.5, False)], ids=["in the seats", "on the disc"])
def test_pressure_times_speed_in_megapascal_metres_per_second(seat, rolls):
    """W/N of a joint is the speed, m/s, at which the disc's surface passes that of the sleeve, or carries it along."""
    drive = next(iter(load_drive("sleeved").cases.values()))
    friction = Friction(pin=0.05, seat=seat, hole=0.05)
    drive = replace(drive, friction=friction, load=replace(drive.load, speed=1500.0))
    analysis = analyse(drive, np.array([0.3, 1.1]))
    shape = {"pin": analysis.losses.pins.force.shape, "pin_shaft": analysis.losses.holes.force.shape}
    random = np.random.default_rng(5)
    seats = {"pin": "pin_seat", "pin_shaft": "hole_seat"}
    pressures = {
        name: random.uniform(1.0, 900.0, shape[of])
        for of in shape
        for name in (f"{of}_pressure_mid", f"{seats[of]}_pressure_max")
    }
    found = friction_values(analysis, pressures)
    for of, part in (("pin", drive.pin_wheel), ("pin_shaft", drive.pin_shaft)):
        pressed = found[f"{of}_friction_force"] > 0.0
        assert pressed.any()
        speed = found[f"{of}_friction_power"][pressed] / found[f"{of}_friction_force"][pressed]
        turned = 1.0 if part.seat.kind == "slot" else part.seat.bore_radius / part.pin_radius
        on_disc, in_seat = (0.0, turned * speed) if rolls else (speed, 0.0)
        seat_name = seats[of]
        np.testing.assert_allclose(
            found[f"{of}_pv"][pressed], pressures[f"{of}_pressure_mid"][pressed] * on_disc, rtol=1e-12
        )
        np.testing.assert_allclose(
            found[f"{seat_name}_pv"][pressed], pressures[f"{seat_name}_pressure_max"][pressed] * in_seat, rtol=1e-12
        )
