"""Which reducers have a potential."""

from dataclasses import replace

import numpy as np
import pytest

from ltca.analysis.engines import HalfSpace
from ltca.drive.parts import Material
from ltca.equilibrium.output_torque import solve_at_output
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive

TEETH = {"first_stage.sun_teeth": 20, "first_stage.planet_teeth": 40, "first_stage.plane": 40.0}
SOFT_WHEEL = {"pin_wheel.support_stiffness": 5e5}
HELD_CARRIER = {"installation.held": "pin-shaft"}
TURNING = {"installation.held": "pin-wheel"}


@pytest.mark.parametrize(
    ("fields", "symmetric"),
    [
        (TEETH | HELD_CARRIER, True),
        (TEETH | HELD_CARRIER | SOFT_WHEEL, True),  # the sun presses a carrier that stands
        (TEETH | TURNING, True),  # it presses a carrier that cannot give way
        (TEETH | TURNING | SOFT_WHEEL, False),
    ],
    ids=["held carrier", "held carrier, soft wheel", "turning carrier", "turning carrier, soft wheel"],
)
def test_teeth_on_rigid_cranks_leave_a_potential_unless_they_press_what_yields(fields, symmetric):
    """Their forces go with the moments of the cranks, which are no slope of an energy; they work where the wheel moves."""
    drive = load_drive("rv").cases["nominal"]
    drive = replace(drive, crank=replace(drive.crank, support=None))
    drive = replace(drive, materials=replace(drive.materials, crankshaft=Material()))
    drive = with_fields(drive, fields)
    model, angle = HalfSpace().prepare(drive).model, np.array([0.31])
    found = solve_at_output(model, [drive], angle, drive.load.torque)
    pressed = np.abs(model.beside_pins(angle, found.pose, found.response.parts)).max() > 1.0
    work = bool(pressed and model.wheel_places[0].size)
    assert model.symmetric == symmetric
    assert work == (not symmetric)
