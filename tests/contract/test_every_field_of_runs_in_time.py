"""The contract of ``cyclo dynamics --time``: every leaf field of a drive moves a run in time, or is refused by its name."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ltca.analysis.engines import HalfSpace
from ltca.analysis.time_run import Course, prepare_run, run_in_time
from ltca.errors import DriveError
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive
from ltca.testing.field_changes import (
    EXCEPTIONS,
    change_of,
    is_refused_by_name,
    leaf_fields,
    moves,
    with_densities,
)

PARTS = ("disc", "wheel_pin", "roller", "inner_race", "shaft_pin")
BASE = with_fields(
    load_drive(Path(__file__).parent / "drive.toml").cases["nominal"],
    {f"materials.{part}.density": 7800.0 + 10.0 * number for number, part in enumerate(PARTS)}
    | {"inertia.output": 0.01},
)
QUICK = ("friction.no_load_torque", "load.external.0.force.x", "damping.ratio", "carrier.posts.size")
"""One of each way of the forces that runs in time have of their own."""
MOVED_BY = {
    "materials.shaft_pin.density": {"installation.held": "pin-wheel"},
    "materials.carrier.density": {"installation.held": "pin-wheel"},
    "inertia.crank_mass": {
        "crank.support.diameter": 8.0, "crank.support.positions": (-10.0, 12.0), "crank.support.stiffness": (2e5, 3e5)
    },
}  # fmt: skip
"""What lets masses move that stand in the base."""
COURSE = Course.of_values("steady", 5e-5, 1500.0)


def answer(drive):
    """Begin and end of a run of some steps in one row, each array by its largest number, works one by one, and these numbers.

    Between its steps the solver interpolates, and steps follow round-off: what is read there differs by 1e-6, and rates
    by nearly as much.
    """
    found = run_in_time(prepare_run(drive, HalfSpace(), COURSE), samples=2).samples
    arrays = [getattr(found, name) for name in found.__slots__ if name not in ("rate", "works")]
    parts = []
    for array in (*arrays, *found.works.T):
        largest = float(np.abs(array).max(initial=0.0))
        parts += [[largest], 1.0 + np.ravel(array) / (largest or 1.0)]
    return np.concatenate(parts)


@pytest.fixture(scope="module")
def answers():
    return {}


def walk():
    assert set(QUICK) <= set(leaf_fields())
    assert set(EXCEPTIONS["time"]) <= set(leaf_fields())
    for path in leaf_fields():
        marks = [pytest.mark.slow] if path in QUICK else [pytest.mark.slow, pytest.mark.nightly]
        yield pytest.param(path, id=path, marks=marks)


@pytest.mark.parametrize("path", list(walk()))
def test_every_field_is_used_or_refused(path, answers):
    refused = ""
    try:
        base, change = change_of(with_fields(BASE, MOVED_BY.get(path, {})), path)
        base, changed = with_densities(base), with_densities(with_fields(base, change))
        after = answer(changed)
    except DriveError as error:
        refused = str(error)
    if refused:
        assert is_refused_by_name(path, refused), f"{path} is refused without its name: {refused}"
        return
    key = repr(base)
    if key not in answers:
        answers[key] = answer(base)
    if path in EXCEPTIONS["time"]:
        assert not moves(answers[key], after), f"{path} is listed as an exception but moves the answer"
    else:
        assert moves(answers[key], after), f"{path} is ignored"
