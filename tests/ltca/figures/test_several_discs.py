"""Figures of several discs: each has its curve, told by its line, and none is left out in silence."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.figure import Figure

from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.results import build_dataset
from ltca.figures.house_style import OTHERS
from ltca.figures.pressure_figures import draw_contact_zone
from ltca.figures.run_figures import draw_figure, figure_names
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive

ANGLES = np.array([0.1, 0.2, 0.3])


@pytest.fixture(scope="module")
def two():
    changes = {"disc.number_of_discs": 2, "disc.of.1.runout.amount": 0.005}
    return analyse(with_fields(load_drive("paper").cases["CS-3"], changes), ANGLES)


def curves(figure):
    """Curves by their line style: each has a panel of its own, with the others behind in one colour."""
    own = [line for axes in figure.axes for line in axes.lines if line.get_color() != OTHERS]
    return {line.get_linestyle(): line.get_ydata() for line in own if len(line.get_xdata()) == 3}


def test_every_disc_has_its_curve(two):
    drawn = curves(draw_figure("fig29_tangential_bearing_load", build_dataset("d", {"nominal": two})))
    assert len(drawn) == 2
    np.testing.assert_array_equal(drawn["-"], two.bearing_tangential[:, 0, 0])
    np.testing.assert_array_equal(drawn["--"], two.bearing_tangential[:, 1, 0])


def test_the_torque_share_is_drawn_of_several_discs_only(two):
    assert set(figure_names(2, 8)) - set(figure_names(1, 8)) == {"torque_share"}
    drawn = curves(draw_figure("torque_share", build_dataset("d", {"nominal": two})))
    # moments are balanced to 1e-9
    np.testing.assert_allclose(drawn["-"], two.torque_share[:, 0], rtol=0.0, atol=1e-8)


def test_cases_that_have_no_room_are_counted(two):
    """The first eight curves were drawn and nothing was said of the others."""
    dataset = build_dataset("d", {f"case {number}": two for number in range(9)})
    texts = [text.get_text() for text in draw_figure("fig28_bearing_load", dataset).texts]
    assert [text for text in texts if "cases" in text] == ["8 of 9 cases"]


def test_few_positions_leave_no_teeth_in_the_roller_load():
    """Places that no roller passed were drawn as 0 N."""
    result = analyse(load_drive("paper").cases["CS-1"], np.linspace(0.0, 2.0 * np.pi, 45, endpoint=False))
    axes = draw_figure("fig34_roller_load", build_dataset("d", {"CS-1": result})).axes[0]
    load = axes.lines[0].get_ydata()
    place = axes.lines[0].get_xdata()
    loaded = (place > 30.0) & (place < 90.0)
    assert np.min(load[loaded]) > 500.0


def test_contact_zone_of_several_discs(two):
    """It took the flank of the drive, and ended in an error: each disc has one of its own."""
    figure = Figure()
    draw_contact_zone(figure, build_dataset("d", {"nominal": two}), two.drive)
    shown = max(len(line.get_xdata()) for line in figure.axes[1].lines)
    load = np.stack([disc.full.response.pin_load for disc in two.discs])
    assert shown == int(np.sum(load > 1e-3 * load.max()))
