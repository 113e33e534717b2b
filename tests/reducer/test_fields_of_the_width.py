"""Fields of the width in batches of drives, as derivatives, and as tolerances."""

from __future__ import annotations

import re

import numpy as np
import pytest

from ltca.analysis.derivatives import CENTRAL, _Node, _Position, derivatives
from ltca.analysis.engines import HalfSpace
from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.results import case_arrays
from ltca.arrays import batch_layout, stack_drives
from ltca.drive.fields import read_field
from ltca.drive.tolerances import Factors, parse_tolerances
from ltca.equilibrium.output_torque import solve_at_output
from ltca.errors import DriveError
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive

SLICES = {"contact.slices": 5}
ANGLES = np.array([0.5, 1.1])


@pytest.fixture(scope="module")
def paper():
    return load_drive("paper").cases["CS-1"]


def balance(drive, start=None):
    return solve_at_output(HalfSpace().model(drive), [drive], ANGLES, drive.load.torque, start)


@pytest.mark.slow
def test_drives_of_a_batch_have_leads_and_leans_of_their_own(paper):
    """Leads that differ between the drives of a batch ended in arrays that do not fit."""
    changes = (
        {"disc.lead_slope": 1e-4},
        {"disc.lead_crown_drop": 2e-3, "pin_shaft.inclination.x": 1e-4},
        {"disc.lead_relief_length": 2.0, "disc.lead_relief_depth": 1e-3},
    )
    drives = [with_fields(paper, SLICES | change) for change in changes]
    models = [HalfSpace().model(drive, in_batch=True) for drive in drives]
    assert len({batch_layout(model) for model in models}) == 1
    together = solve_at_output(
        stack_drives(models, ANGLES.size), drives, np.tile(ANGLES, len(drives)), paper.load.torque
    )
    for number, drive in enumerate(drives):
        alone = balance(drive).pose
        rows = slice(ANGLES.size * number, ANGLES.size * (number + 1))
        # Both are balanced to 1e-9 of the load, of approaches of some micrometres.
        np.testing.assert_allclose(together.pose[rows], alone, rtol=0.0, atol=1e-11)


TILTED = {
    "disc.lead_crown_drop": 2e-3,
    "disc.lead_relief_length": 2.0,
    "disc.lead_relief_depth": 2e-3,
    "disc.lead_slope": 5e-5,
    "pin_wheel.inclination.x": 3e-5,
    "pin_wheel.inclination.y": -4e-5,
    "pin_shaft.inclination.x": 6e-5,
    "pin_shaft.inclination.y": 2e-5,
    "crank.inclination.x": -2e-5,
    "crank.inclination.y": 7e-5,
    "pin_wheel.pin_errors.inclination_x.4": 5e-5,
    "pin_wheel.pin_errors.inclination_y.4": -5e-5,
    "disc.hole_errors.inclination_x.3": 3e-5,
    "disc.hole_errors.inclination_y.3": 3e-5,
    "pin_shaft.pin_errors.inclination_x.3": -3e-5,
    "pin_shaft.pin_errors.inclination_y.3": 3e-5,
}
"""A field of every kind, with a part of its own that carries."""


@pytest.fixture(scope="module")
def tilted(paper):
    drive = with_fields(paper, SLICES | TILTED)
    found = balance(drive)
    carrying = (found.response.pin_load[:, 4] > 0.0, found.response.hole_load[:, 3] > 0.0)
    assert all(part.any() for part in carrying), carrying
    node = _Node(drive=drive, model=HalfSpace().model(drive), step=0.0)
    return drive, found, _Position(found, node, lambda one: one.load.torque)


QUICK = ("disc.hole_errors.inclination_x.3",)


# Of two components one is of every full run, the other of the night.
@pytest.mark.parametrize(
    "path",
    [
        path
        if path in QUICK
        else pytest.param(path, marks=pytest.mark.nightly if re.search(r"[._]y(\.\d+)?$", path) else pytest.mark.slow)
        for path in TILTED
    ],
)
def test_derivatives_are_those_of_balanced_drives(path, tilted):
    """Against differences of drives that are balanced on both sides."""
    drive, found, position = tilted
    value = float(read_field(drive, path))
    places, weights = CENTRAL
    step = 0.05 * abs(value)
    beside = [with_fields(drive, {path: value + step * place}) for place in places]
    nodes = [
        _Node(drive=one, model=HalfSpace().model(one), step=step * place)
        for one, place in zip(beside, places, strict=True)
    ]
    slopes = position.follow(nodes, weights, step)[:, :-1]
    poses = [balance(one, found.pose).pose for one in beside]
    expected = np.tensordot(weights, np.stack(poses), 1) / step
    lengths = position.lever * expected
    assert np.abs(lengths).max() > 0.0
    # Steps of a twentieth: the fourth power of what they change loads by, as far as no contact at the end of a slice opens.
    assert np.max(np.abs(position.lever * slopes - lengths)) < 1e-4 * np.abs(lengths).max()


def test_what_the_width_has_scatters(paper):
    """Of every part and of every disc by itself, in a drive with slices; a plane one refuses by the name of the slices."""
    table = {
        path: {"distribution": "normal", "tolerance": "0.2 mrad"}
        for path in ("pin_wheel.pin_errors.inclination_x", "crank.inclination.y", "disc.lead_slope")
    } | {"disc.lead_crown_drop": {"distribution": "truncated-normal", "tolerance": "1 µm"}}
    problems = []
    two = with_fields(paper, SLICES | {"disc.number_of_discs": 2, "disc.lead_crown_drop": 2e-3})
    tolerances = parse_tolerances(table, problems, two)
    assert not problems
    factors = Factors.of_tolerances(two, tolerances)
    wheel = [f"pin_wheel.pin_errors.inclination_x.{number}" for number in range(14)]
    slopes, drops = ([f"disc.of.{disc}.{name}" for disc in (0, 1)] for name in ("lead_slope", "lead_crown_drop"))
    assert [*factors.paths] == [*wheel, "crank.inclination.y", *slopes, *drops]
    drawn = factors.draw(np.full((1, len(factors.paths)), 0.9))[0]
    sample = with_fields(two, factors.values(drawn))
    # The quantile at 0.9 is 1.2816 standard deviations of a third of the tolerance.
    assert sample.crank.inclination.y == pytest.approx(1.2815515655 * 2e-4 / 3.0, rel=1e-9)
    assert sample.disc.of[1].lead_slope == sample.crank.inclination.y
    assert sample.disc.of[0].lead_crown_drop > 2e-3
    with pytest.raises(DriveError) as refused:
        Factors.of_tolerances(paper, tolerances)
    assert len(refused.value.problems) == 4
    assert all("needs slices along the width, contact.slices = 3 or more" in each for each in refused.value.problems)


@pytest.mark.slow
def test_derivatives_of_results_by_leads_and_inclinations(paper):
    """As a user asks for them, pressures along the width among them: against analyses on both sides."""
    drive = with_fields(paper, SLICES | TILTED)
    fields = ("disc.lead_crown_drop", "pin_shaft.inclination.x")
    found = derivatives(analyse(drive, ANGLES), fields)
    for path in fields:
        value = float(read_field(drive, path))
        places, weights = CENTRAL
        sides = [analyse(with_fields(drive, {path: value * (1.0 + 1e-3 * place)}), ANGLES) for place in places]
        arrays = [case_arrays(side) for side in sides]
        for name in ("transmission_error", "pin_load", "pin_pressure_max"):
            slope = np.tensordot(weights, np.stack([each[name] for each in arrays]), 1) / (1e-3 * value)
            own = found[name].sel(field=path).values
            assert np.abs(slope).max() > 0.0
            # Steps so small that no point of a slice opens; angles change by 1e-11 rad over one, and are balanced to some 1e-14.
            np.testing.assert_allclose(own, slope, rtol=0.0, atol=2e-3 * np.abs(slope).max(), err_msg=f"{name}, {path}")
