"""Names of drives and cases are text in figures: no formula, no markup."""

from __future__ import annotations

import xml.dom.minidom
from dataclasses import replace

import matplotlib as mpl
import numpy as np
import pytest

from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.results import build_dataset
from ltca.figures.drive_picture import draw_drive
from ltca.figures.house_style import STYLE
from ltca.figures.run_figures import draw_figure

NAMES = ("a$x_{b$", "<!--<script>", 'it\'s "q" & <b>')


def texts(path):
    found = xml.dom.minidom.parse(str(path)).getElementsByTagName("text")
    return ["".join(node.data for node in text.childNodes if node.nodeType == node.TEXT_NODE) for text in found]


@pytest.fixture(scope="module")
def analysis(paper_cases):
    return analyse(replace(paper_cases["CS-1"], name=NAMES[0]), np.array([0.1, 0.2]))


@pytest.mark.parametrize("figure", ["fig28_bearing_load", pytest.param("fig25_loaded_pins", marks=pytest.mark.slow)])
def test_figures_hold_the_names_as_they_are(figure, analysis, tmp_path):
    """matplotlib took what stands between dollar signs for a formula, and ended in its parser."""
    dataset = build_dataset(NAMES[0], dict.fromkeys(NAMES, analysis))
    path = tmp_path / "figure.svg"
    with mpl.rc_context(STYLE):
        draw_figure(figure, dataset).savefig(path)
    for name in NAMES:
        assert any(name in text for text in texts(path)), name


@pytest.mark.slow
def test_picture_of_a_drive_holds_its_name(analysis, tmp_path):
    draw_drive(analysis.drive, analysis, 0, tmp_path / "drive.svg")
    assert any(NAMES[0] in text for text in texts(tmp_path / "drive.svg"))
