"""How deep the calls are from a question to the iteration that answers it."""

from __future__ import annotations

import traceback
from pathlib import Path

import pytest

import ltca
from ltca.equilibrium.newton import Search

MOST = 8
"""Frames of this project from `ltca.analyse` to `Search.iterate`, both counted."""


@pytest.mark.parametrize("name", ["paper", "rv", "robot-joint"])
def test_no_more_than_eight_frames_lie_between_analyse_and_the_newton_iteration(monkeypatch, name):
    drive = next(iter(ltca.load_drive(name).cases.values()))
    iterate, package, deepest = Search.iterate, str(Path(ltca.__file__).parent), []

    def counted(self, *arguments, **named):
        mine = [frame.name for frame in traceback.extract_stack()[:-1] if frame.filename.startswith(package)]
        deepest.append([*mine, "iterate"])
        return iterate(self, *arguments, **named)

    monkeypatch.setattr(Search, "iterate", counted)
    ltca.analyse(drive, 1)
    # Also where a held wheel's moment is followed, and both torques.
    assert len(deepest) > 1
    assert all(path[0] == "analyse" for path in deepest)
    assert max(map(len, deepest)) <= MOST, max(deepest, key=len)
