"""The contract of ``cyclo dynamics``: every leaf field of a drive moves masses or vibrations, or is refused by its name."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ltca.analysis.drive_curves import fewest_turns
from ltca.analysis.engines import HalfSpace
from ltca.analysis.forced_vibration import forced_vibration
from ltca.analysis.vibration import vibration, vibration_content
from ltca.drive.fields import field_kinds
from ltca.drive.members.temperatures import warm_drive
from ltca.dynamics.mass_values import mass_values
from ltca.errors import DriveError
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive
from ltca.testing.field_changes import EXCEPTIONS, change_of, goes_with, leaf_fields, moves, with_densities

PARTS = ("disc", "wheel_pin", "roller", "inner_race", "shaft_pin")
BASE = with_fields(
    load_drive(Path(__file__).parent / "drive.toml").cases["nominal"],
    {f"materials.{part}.density": 7800.0 + 10.0 * number for number, part in enumerate(PARTS)}
    | {"inertia.output": 0.01},
)
NEW = tuple(path for path in field_kinds() if path.startswith(("inertia.", "damping.")))
QUICK = (*NEW, "materials.disc.density", "load.direction", "crank.eccentricity")


def answer(drive):
    """Everything that masses, modes, orders, critical speeds and the response have, in one row."""
    turns = fewest_turns(warm_drive(drive), 40)  # warm rollers are all but a period apart
    found = vibration(drive, engine=HalfSpace(), positions=4, torque_parts=(0.5,), turns=turns)
    content = vibration_content(found)
    critical = [[one["speed_rpm"], one["in_range"]] for one in content["critical_speeds"]]
    parts = [
        list(mass_values(drive).values()),
        found.frequency,
        found.spectrum.amplitude * 1e6,
        content["speed_range_rpm"],
        critical,
    ]
    if drive.damping is not None:
        parts.append(forced_vibration(found, fastest=1000.0, speeds=10).amplitude)
    return np.concatenate([np.ravel(np.asarray(part, dtype=float)) for part in parts])


@pytest.fixture(scope="module")
def answers():
    return {}


def walk():
    for path in leaf_fields():
        marks = [pytest.mark.slow] if path in QUICK else [pytest.mark.slow, pytest.mark.nightly]
        yield pytest.param(path, id=path, marks=marks)


@pytest.mark.parametrize("path", list(walk()))
def test_every_field_is_used_or_refused(path, answers):
    refused = ""
    try:
        base, change = change_of(BASE, path)
        base, changed = with_densities(base), with_densities(with_fields(base, change))
        after = answer(changed)
    except DriveError as error:
        refused = str(error)
    if refused:
        assert goes_with(path) in refused or path in refused, f"{path} is refused without its name: {refused}"
        return
    key = repr(base)
    if key not in answers:
        answers[key] = answer(base)
    if path in EXCEPTIONS["dynamics"]:
        assert not moves(answers[key], after), f"{path} is listed as an exception but moves the answer"
    else:
        assert moves(answers[key], after), f"{path} is ignored"
