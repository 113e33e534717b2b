"""Plays as drawn, and those that a warm drive loses."""

from ltca.geometry.interference import drawn_plays, lost_play
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive


def test_a_play_is_lost_where_it_ends_below_zero():
    """Rollers that grow by 8 µm close 16 µm of the bearing; whatever play is left, however little, is none that is lost."""
    cold = with_fields(load_drive("paper").cases["CS-1"], {"clearance.bearing": 0.02, "clearance.pin_hole": 0.03})
    radius = cold.crank_bearing.roller_radius
    less, none = (
        with_fields(cold, {"crank_bearing.roller_radius": radius + more}, check=False) for more in (0.004, 0.008)
    )
    assert all(play >= 0.0 for play in drawn_plays(less).values())
    assert lost_play(cold, cold) == lost_play(cold, less) == []
    (told,) = lost_play(cold, none)
    assert told.endswith("(0.01 mm at 20 °C) is gone: they overlap by 0.006 mm")
