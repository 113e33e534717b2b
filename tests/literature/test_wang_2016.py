"""Efficiency of a catalogue reducer: Wang, Luo, Su, Mechanism and Machine Theory 102 (2016) 135–148.

The reducer, their formula and what is compared in numbers are a case of the manual (`validation.manual.losses`). Their μ and f
are not printed, nor are the bearings: what may be asked of us beyond is that efficiency moves as theirs does.
"""

from __future__ import annotations

import numpy as np
import pytest

from ltca.analysis.loaded_analysis import analyse
from validation.manual.losses import WANG_ANGLES, wang_formula, wang_reducer


def efficiency(**design):
    return analyse(wang_reducer(**design), WANG_ANGLES).losses.mean_efficiency


@pytest.fixture(scope="module")
def initial():
    return efficiency()


def test_losses_are_larger_than_theirs(initial):
    """Theirs are those of a disc that stands still in its bearing. Ours yields there, and pins far from the pitch point carry."""
    assert initial < wang_formula()


@pytest.mark.slow
@pytest.mark.parametrize(
    "design",
    [
        {"shortening": 0.72},
        pytest.param({"pin": 4.0}, id="thinner pins"),
        pytest.param({"wall": 2.0}, id="thicker sleeves"),
    ],
)
def test_efficiency_moves_as_theirs(initial, design):
    """With the shortening, thinner pins, and sleeves that run on a smaller part of their outside."""
    assert np.sign(efficiency(**design) - initial) == np.sign(wang_formula(**design) - wang_formula())
