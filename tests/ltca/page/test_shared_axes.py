"""Axes that figures and pages share: they hold their values, begin and end at ticks, and are those of the figures."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest

from ltca.figures.run_figures import draw_figure
from ltca.figures.shared_axes import axis_of, run_axes, run_values
from ltca.page.run_page import run_page


def test_an_axis_holds_its_values_between_few_round_ticks():
    """Steps are 1, 2, 2.5 or 5 times a power of ten; no tick more than asked for; zero where asked for."""
    random = np.random.default_rng(3)
    for zero in (False, True):
        for _ in range(400):
            middle, size = random.normal() * 10.0 ** random.integers(-3, 5), 10.0 ** random.uniform(-4, 4)
            values = middle + size * random.uniform(-1.0, 1.0, 5)
            axis = axis_of(values, np.array([np.nan]), zero=zero)
            room = 1e-8 * axis.step  # of what counts as a tick
            assert axis.low - room <= values.min() <= values.max() <= axis.high + room
            assert not zero or axis.low <= 0.0 <= axis.high
            assert 2 <= axis.ticks.size <= 5
            assert axis.ticks[[0, -1]] == pytest.approx([axis.low, axis.high], abs=room)
            lead = axis.step / 10.0 ** np.floor(np.log10(axis.step) + 1e-9)
            assert min(abs(lead - round_one) for round_one in (1.0, 2.0, 2.5, 5.0)) < 1e-9


@pytest.mark.parametrize("values", [[], [np.nan], [0.0, 0.0], [7.0], [1e-300], [-3.0, -3.0]])
def test_values_all_alike_have_an_axis(values):
    axis = axis_of(np.array(values))
    assert axis.low < axis.high
    assert all(axis.low <= value <= axis.high for value in values if np.isfinite(value))


@pytest.mark.family(quick=1)
@pytest.mark.parametrize(
    ("figure", "panel", "name"),
    [
        ("fig23_transmission_error", 1, "full/te"),
        ("fig26_pin_pressure", 0, "full/pin/pressure"),
        *(
            pytest.param(*one, marks=pytest.mark.slow)
            for one in [
                ("fig23_transmission_error", 0, "light/te"),
                ("fig24_pin_load", 0, "full/pin/load"),
                ("fig28_bearing_load", 0, "total"),
                ("fig29_tangential_bearing_load", 0, "tangential"),
                ("fig30_radial_bearing_load", 0, "radial"),
            ]
        ),
    ],
)
def test_page_and_figure_have_one_axis(figure, panel, name, paper_run):
    """The page zoomed each case on its own, the figure all of them together, at other ticks."""
    run, dataset = paper_run
    content = json.loads(re.search(r'<script id="data"[^>]*>(.*?)</script>', run_page(run), re.S).group(1))
    low, high, step = content["axes"][name]
    axes = draw_figure(figure, dataset).axes[panel]
    assert axes.get_yticks() == pytest.approx(np.arange(low, high + 0.5 * step, step), abs=1e-9 * step)
    for end, tick in zip(axes.get_ylim(), (low, high), strict=True):
        assert abs(end - tick) <= 0.031 * (high - low)  # a line on the last tick is drawn whole
    drawn = np.concatenate([line.get_ydata() for one in dataset_panels(axes) for line in one.get_lines()])
    assert low <= np.nanmin(drawn)
    assert np.nanmax(drawn) <= high


def dataset_panels(axes):
    """The panels that share the scale of one."""
    return axes.get_shared_y_axes().get_siblings(axes)


def test_positions_without_an_answer_leave_the_axes_alone(paper_run):
    dataset = paper_run[1]
    values = run_values(dataset)
    hurt = {
        name: np.where(np.arange(each.size).reshape(each.shape) == 0, np.nan, each) for name, each in values.items()
    }
    assert run_axes(hurt, 1).keys() == run_axes(values, 1).keys()
    assert all(np.isfinite(axis).all() for axis in run_axes(hurt, 1).values())
