"""Contacts in slices that tilt against half-space grids of the whole surface: what too few slices leave, and how more converge.

Lines that slices resolve are cases of the manual (`validation.manual.width`): load 1 %, moment 2 % (of itself, or of a sixth of
load times length where that is more), largest pressure of a crowned line 3 %. A contact has to reach over four slices and more
for that: nine slices down to half of the line, seventeen to a quarter, thirty-three to an eighth.
"""

from __future__ import annotations

import numpy as np
import pytest

from validation.manual.width import RADII, press_line


@pytest.mark.parametrize("radius", RADII)
def test_corners_of_fewer_than_four_slices_are_too_soft(radius):
    """Nine slices: a contact over a quarter of the line, two slices and a quarter, 1.7 % in load and 3.8 % in moment."""
    load, moment, _ = press_line(radius, 9, -1.0, 2.0).differences
    assert -0.025 < load < 0.0
    assert -0.05 < moment < 0.0


@pytest.mark.parametrize(("approach", "tilt", "drop"), [(0.0, 1.0, 0.0), (-1.0, 2.0, 0.0), (1.0, 0.5, 1.0)])
def test_more_slices_come_closer(approach, tilt, drop):
    errors = [np.max(np.abs(press_line(3.0, slices, approach, tilt, drop).differences[:2])) for slices in (5, 9, 17)]
    # Order one at least: half of the error with twice the slices, twice, down to what the grids leave open. Of a single contact
    # one step may bring little: it is where its end falls within a slice (`test_sliced_line.test_tilted_lines_converge`).
    assert errors[1] < errors[0]
    assert errors[2] < 0.5 * errors[0]
