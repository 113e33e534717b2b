"""Loose pins and sleeves are drawn where flank and holes push them: what touches in the answer touches in the picture."""

from __future__ import annotations

import numpy as np
import pytest

from ltca.analysis.loaded_analysis import analyse
from ltca.drive.materials import MAY_BE_UNKNOWN
from ltca.figures.drive_picture import _Position, draw_drive
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import parse_drive, shipped_drive

PLAY = 0.3
"""Of every seat, mm: ten times what bodies yield here."""
WHEEL = {
    "slot": {"pin_wheel.seat.radius": 3.5 + PLAY},
    "sleeve": {
        "pin_wheel.seat.kind": "sleeve",
        "pin_wheel.seat.radius": None,
        "pin_wheel.seat.pin_radius": 2.8,
        "pin_wheel.seat.bore_radius": 2.8 + PLAY,
        "materials.wheel_seat.youngs_modulus": 206_000.0,
        "materials.wheel_seat.poisson_ratio": 0.3,
        **{f"materials.wheel_seat.{name}": None for name in MAY_BE_UNKNOWN},
    },
}


@pytest.mark.slow
@pytest.mark.parametrize("kind", WHEEL)
def test_drawn_parts_touch(kind, tmp_path):
    drive = parse_drive(shipped_drive("sleeved"), "sleeved").cases["nominal"]
    one = {"disc.number_of_discs": 1, "disc.phases": (), "disc.planes": (), "load.torque": 20_000.0}
    seats = {"pin_shaft.seat.bore_radius": 4.5 + PLAY}
    errors = {"pin_wheel.pin_errors.diameter": (0.02, -0.02) * 15}
    drive = with_fields(drive, one | WHEEL[kind] | seats | errors)
    analysis = analyse(drive, np.array([0.5]))
    shown = _Position(analysis.discs[0], 0)
    (pins, pin_load, pin_radii, _), _, (shaft_pins, hole_load, shaft_radii, _) = shown.loads
    flank = shown.disc + shown.turn * shown.profile.flank(np.linspace(0.0, 2.0 * np.pi, 20_000))
    pin, hole = int(np.argmax(pin_load)), int(np.argmax(hole_load))
    # Under this load bodies yield and pins bend by a hundredth.
    assert np.min(np.abs(flank - pins[pin])) == pytest.approx(pin_radii[pin], abs=0.1 * PLAY)
    reach = abs(shaft_pins[hole] - shown.holes[hole]) + shaft_radii[hole]
    assert reach == pytest.approx(drive.hole_radius, abs=0.1 * PLAY)
    # A pin loose in its slot moves as a whole, less where it is thicker; a sleeve about its pin.
    play = PLAY - 0.01 * np.tile([1.0, -1.0], 15) * (kind == "slot")
    assert np.abs(pins - shown.pins) == pytest.approx(play, abs=1e-9)
    draw_drive(drive, analysis, 0, tmp_path / "drive.png")
    assert (tmp_path / "drive.png").stat().st_size > 10_000
