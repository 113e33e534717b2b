"""What the finite elements do not model is refused, not left out silently."""

import numpy as np
from refusals import refused_field

from fem.drive.expected_contacts import expect_contacts
from ltca.reading.changes import with_fields


def test_offset_wheel_axis_is_refused(paper_cases):
    drive = with_fields(paper_cases["CS-1"], {"pin_wheel.axis_offset.x": 0.02})
    with refused_field("pin_wheel.axis_offset", "(pin_wheel.axis_offset.x = 0.02 mm)", "must be left out"):
        expect_contacts(drive, float(np.pi / 6.0))
