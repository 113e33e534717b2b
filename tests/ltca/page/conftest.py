"""Runs of few positions, as the page shows them."""

from __future__ import annotations

import pytest

from ltca.analysis.engines import HalfSpace
from ltca.analysis.half_space_errors import half_space_words
from ltca.analysis.life.bearing_lives import bearing_lives
from ltca.analysis.light_torque import at_light_torque
from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.results import build_dataset
from ltca.analysis.summary import summarise
from ltca.analysis.verdict.values import judge_analysis
from ltca.geometry.placement import position_angles
from ltca.page.run_page import Run
from ltca.reading.drive_file import parse_drive, shipped_drive

POSITIONS = 8


def run_of(file, positions=POSITIONS, cases=None, compared=None):
    """A run of a drive file, and its dataset."""
    chosen = file.select(cases)
    analyses = {name: analyse(drive, position_angles(positions)) for name, drive in chosen.items()}
    summaries = {name: summarise(one) for name, one in analyses.items()}
    checks = {
        name: judge_analysis(one, summaries[name], file.limits[name], lives=False) for name, one in analyses.items()
    }
    dataset = build_dataset(file.name, analyses, file.text)
    light = {name: at_light_torque(one) for name, one in analyses.items()}
    run = Run(
        dataset=dataset, drives=chosen, engine=HalfSpace(), summaries=summaries, checks=checks,
        lives={name: bearing_lives(one) for name, one in analyses.items()},
        sampling=["warning: <b>few</b> positions"],
        method=[("sampling", "means over 8 positions"), ("bodies", half_space_words(HalfSpace(), next(iter(chosen.values()))))],
        light=build_dataset(file.name, light, file.text), compared=compared,
    )  # fmt: skip
    return run, dataset


@pytest.fixture(scope="session", name="run_of")
def _run_of():
    return run_of


@pytest.fixture(scope="session")
def paper_run():
    return run_of(parse_drive(shipped_drive("paper")), cases=["CS-1", "CS-6"])
