"""What is said of an analysis on half-spaces."""

from __future__ import annotations

from ltca.analysis.engines import HalfSpace, Hybrid
from ltca.analysis.half_space_errors import half_space_words
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive

PAPER = load_drive("paper").cases["CS-1"]


def test_supports_of_bodies_are_said_to_have_no_effect():
    """Half-spaces have neither cores of pins nor bores of races: nothing is ignored in silence."""
    given = with_fields(PAPER, {"pin_wheel.core_radius": 3.0, "crank_bearing.race_bore_radius": 12.0})
    said = "without effect on them: pin_wheel.core_radius = 3 mm, crank_bearing.race_bore_radius = 12 mm"
    assert half_space_words(HalfSpace(), given).endswith(said)
    assert "without effect" not in half_space_words(HalfSpace(), PAPER)
    assert half_space_words(Hybrid(), given) == ""
