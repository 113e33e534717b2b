"""The row of overlaps counts every pair of parts: flank, rollers and races, shaft pins and holes."""

from __future__ import annotations

import numpy as np
import pytest

from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.summary import _unloaded
from ltca.geometry.interference import overlap_at_rest
from ltca.page.derived import derived_rows
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive

PAPER = load_drive("paper").cases["CS-3"]
"""Its holes fit pins and eccentricity exactly, rollers have a play of 0.015 mm, the flank one of 0.06 mm."""
OVERLAPS = [
    ({}, 0.0, ""),
    ({"pin_shaft.hole_radius": 14.045}, 0.03, "shaft pins and holes"),
    ({"crank_bearing.roller_radius": 5.02}, 0.025, "rollers and races"),  # 2 · 0.02 less the play
    (
        {"disc.equidistant_offset": 0.05},
        0.04,
        "wheel pins and flank",
    ),  # at ψ = 0, where the shift of 0.09 mm closes all of it
    ({"crank.eccentricity_error": 0.01}, 0.01, "shaft pins and holes"),
]


@pytest.mark.parametrize(("changes", "overlap", "parts"), OVERLAPS)
def test_every_pair_counts_as_an_overlap_at_rest(changes, overlap, parts):
    """0 mm stood above a note of 0.05 mm: only the flank was looked at."""
    drive = with_fields(PAPER, changes)
    analysis = analyse(drive, np.array([0.0]))
    (found,) = _unloaded([analysis])
    # What the wheel turns to, so that pins overlap least, is good to the search for it; 4e-3 mm of the flank at a few positions.
    assert found["interference"] == pytest.approx(overlap, abs=4e-3 if "flank" in parts else 1e-9)
    assert overlap_at_rest(drive, found["interference"])[1] == parts


def test_no_row_of_overlaps_where_none_overlap():
    rows = dict(derived_rows(PAPER, PAPER))
    assert "assembly: overlap at rest" not in rows
