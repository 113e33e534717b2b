"""How many positions are solved at once."""

import pytest

from ltca.analysis.memory_need import DISPLACED_PINS, memory_per_position, positions_together
from ltca.reading.drive_file import load_drive


def test_pins_that_displace_each_other_leave_room_for_fewer_positions():
    """On a ring each pair takes 2.2 times the memory: parts of an analysis have as many positions fewer."""
    plain = load_drive("paper").cases["CS-1"]
    circle = plain.pin_wheel.pin_circle_radius
    ringed = plain.with_fields(
        {"ring.inner_radius": circle, "ring.outer_radius": circle + 20.0, "ring.width": plain.disc.thickness}
    )
    assert DISPLACED_PINS > 2.0
    assert positions_together(plain) / positions_together(ringed) == pytest.approx(DISPLACED_PINS, rel=1e-3)
    assert memory_per_position(ringed) / memory_per_position(plain) == pytest.approx(DISPLACED_PINS, rel=1e-12)
