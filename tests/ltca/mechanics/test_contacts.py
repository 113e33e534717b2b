"""All contacts in one system: a position answers alike whatever stands beside it, and the tangent is that of the force."""

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from ltca.analysis.engines import HalfSpace
from ltca.compliance.coefficients import load_coefficients
from ltca.compliance.coupled import CoupledCompliance
from ltca.compliance.response import Start
from ltca.drive.members.temperatures import warm_drive
from ltca.drive.single_discs import single_discs
from ltca.equilibrium import reducer
from ltca.equilibrium.balance import lever_arms
from ltca.equilibrium.output_torque import solve_at_output
from ltca.equilibrium.reducer import Reducer
from ltca.geometry.placement import position_angles
from ltca.mechanics import full_tangent
from ltca.mechanics.contacts import ContactSystem, Linearised
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive
from ltca.testing.closed_form_bodies import closed_form_coefficients
from ltca.testing.crank_drives import crank_drive
from ltca.testing.practical_drives import preloaded_drive
from ltca.testing.random_drives import random_reducer

ANGLES = 0.05 + 2.0 * np.pi * np.arange(6) / 6.0
IN_SLICES = {"contact.slices": 5, "disc.lead_slope": 1e-4}
RING = {"ring.inner_radius": 88.0, "ring.outer_radius": 120.0, "ring.width": 30.0}


def on_bodies(drive, folder: Path, field):
    """The drive on closed-form bodies that couple its contacts."""
    discs = []
    for number, single in enumerate(single_discs(drive)):
        path = folder / f"{number}.nc"
        closed_form_coefficients(single, half_width=0.02, depth=300.0).to_netcdf(path, engine="h5netcdf")
        discs.append(CoupledCompliance.of_drive(single, load_coefficients(path, single), field))
    return Reducer.of_drive(drive, discs)


def prepared(name, folder):
    """A drive and its model: a shipped one, in slices, on a ring or on bodies that couple its contacts."""
    source, _, more = name.partition(", ")
    drive = next(iter(load_drive(source).cases.values()))
    drive = warm_drive(drive.with_fields({"slices": IN_SLICES, "ring": RING}.get(more, {})))
    if more == "hybrid":
        return drive, on_bodies(drive, folder, "half-space")
    return drive, HalfSpace().prepare(drive).model


def loads(response):
    """Loads of all contacts, shape (positions, contacts)."""
    rollers = response.rollers
    return np.concatenate((response.pin_load, response.hole_load, rollers.outer_load, rollers.inner_load), axis=1)


ROUND_OFF = 5e-12
"""Of loads by the largest: a unit in the last place of coordinates of 88 mm, 1.4e-14 mm, by stiffnesses of 1e6 N/mm."""

KINDS = ["paper", "rv", "sleeved", "paper, ring", "paper, hybrid", "paper, slices", "sleeved, hybrid", "rv, slices"]


@pytest.mark.parametrize("name", KINDS)
def test_a_position_answers_alike_in_any_block_and_order(name, tmp_path, monkeypatch):
    """Far from balance, with nothing to start from: deformations are corrected until those of the slowest position have settled,
    and a position beside slower ones went on where alone it had ended.
    """
    drive, model = prepared(name, tmp_path)
    pose = solve_at_output(model, [drive], ANGLES, drive.load.torque).pose
    pose[:, 0] += 1e-3 * np.cos(7.0 * ANGLES)  # mm
    pose[:, -1] *= 1.0 + 0.3 * np.sin(5.0 * ANGLES)
    together = loads(model.respond(ANGLES, pose))
    largest = together.max()
    order = np.array([4, 1, 5, 0, 3, 2])
    np.testing.assert_allclose(
        loads(model.respond(ANGLES[order], pose[order])), together[order], rtol=0.0, atol=ROUND_OFF * largest
    )
    monkeypatch.setattr(reducer, "POSITIONS_AT_ONCE", 2)
    np.testing.assert_allclose(loads(model.respond(ANGLES, pose)), together, rtol=0.0, atol=ROUND_OFF * largest)


TURN = position_angles(24)


@pytest.mark.parametrize("name", ["paper", "rv", "sleeved", "paper, ring", "paper, hybrid", "paper, slices"])
def test_a_search_in_blocks_or_another_order_is_the_search(name, tmp_path, monkeypatch):
    """A step that was cut moved the poses at which contacts were remembered, and those that lead went by their numbers."""
    drive, model = prepared(name, tmp_path)
    first = loads(solve_at_output(model, [drive], TURN, drive.load.torque).response)
    order = np.random.default_rng(0).permutation(TURN.size)
    other = loads(solve_at_output(model, [drive], TURN[order], drive.load.torque).response)
    np.testing.assert_allclose(other, first[order], rtol=0.0, atol=ROUND_OFF * first.max())
    monkeypatch.setattr(reducer, "POSITIONS_AT_ONCE", 8)
    other = loads(solve_at_output(model, [drive], TURN, drive.load.torque).response)
    np.testing.assert_allclose(other, first, rtol=0.0, atol=ROUND_OFF * first.max())


def test_contacts_that_open_as_a_ring_yields_settle(monkeypatch):
    """They were put back to where they stand without it, and counted as not settled while pins are held: a position a tenth of a
    millimetre from balance took 140 evaluations.
    """
    ring = {"ring": {"inner_radius": 88.0, "outer_radius": 97.0, "width": 8.0}}
    drive = warm_drive(with_fields(load_drive("paper").cases["CS-1"], ring))
    model = HalfSpace().prepare(drive).model
    pose = solve_at_output(model, [drive], ANGLES, drive.load.torque).pose
    pose[:, 0] += 0.1 * np.cos(7.0 * ANGLES)
    made, plain = [], Linearised.__init__

    def counted(self, system, angle, *given, **options):
        made.append(angle.size)
        plain(self, system, angle, *given, **options)

    monkeypatch.setattr(Linearised, "__init__", counted)
    ContactSystem(model).in_groups(ANGLES, pose, None, roughly=True)
    assert sum(made) < 40 * ANGLES.size


SOME_ANGLES = np.array([0.4, 1.9, 2.6])
STEPS = (1e-5, 5e-6)
"""Steps of the differences, mm: of the fourth order, and some 1e-9 by round-off."""
BOUND = 1e-8
"""Of the largest stiffness."""


def differences(model, angle, pose, start, lever, step):
    """Derivative of the force by differences of fourth order, as stiffnesses of displacements, N/mm."""
    found = np.zeros((*pose.shape, pose.shape[1]))
    for place in range(pose.shape[1]):
        for weight, steps in ((1.0, -2.0), (-8.0, -1.0), (8.0, 1.0), (-1.0, 2.0)):
            moved = pose.copy()
            moved[:, place] += steps * step / lever[:, place]
            found[:, :, place] += weight / 12.0 * model.respond(angle, moved, start).force / lever / step
    return found


def errors(drive, model):
    """Largest differences of the whole tangent and of the search's to that of the force, by the largest stiffness, at positions
    where no contact opens or closes within the differences.
    """
    model = replace(model, friction=None)
    found = solve_at_output(model, [drive], SOME_ANGLES, drive.load.torque)
    start, lever = Start.after(found.response), np.broadcast_to(lever_arms(model), found.pose.shape)
    contacts = replace(model, stage=None, external=None)
    coarse, fine = (differences(contacts, SOME_ANGLES, found.pose, start, lever, step) for step in STEPS)
    largest = np.abs(fine).max(axis=(1, 2))
    smooth = np.abs(coarse - fine).max(axis=(1, 2)) < BOUND * largest
    assert smooth.any()

    def error(tangent):
        off = np.abs(tangent / lever[:, :, None] / lever[:, None, :] - fine).max(axis=(1, 2)) / largest
        return off[smooth].max()

    searched = contacts.respond(SOME_ANGLES, found.pose, start).tangent
    return error(contacts.whole_tangent(SOME_ANGLES, found.pose, start, lever)), error(searched)


@pytest.mark.parametrize(
    "name",
    [
        "paper",
        "rv",
        "sleeved",
        "paper, ring",
        "paper, hybrid",
        pytest.param("sleeved, hybrid", marks=pytest.mark.slow),
        "paper, slices",
    ],
)
def test_the_whole_tangent_is_that_of_the_force(name, tmp_path):
    """Curvatures, coefficients of bodies and directions of displaced pins follow the pose: what the search leaves out of these is
    hundreds of times the bound.
    """
    whole, searched = errors(*prepared(name, tmp_path))
    assert whole < BOUND
    assert 10.0 * BOUND < searched < 2e-3


@pytest.mark.parametrize("drawn", [crank_drive, random_reducer, preloaded_drive])
def test_drawn_drives_have_the_tangent_of_their_force(drawn):
    drive = warm_drive(drawn(3)[0])
    assert errors(drive, HalfSpace().prepare(drive).model)[0] < BOUND


def test_displaced_pins_are_followed_until_they_settle(tmp_path, monkeypatch):
    """Curvatures follow the pins as these follow the pose: with one pass they would go by what the search takes for it."""
    drive, model = prepared("paper, ring", tmp_path)
    angle = SOME_ANGLES[:1]
    found = solve_at_output(model, [drive], angle, drive.load.torque)
    start, lever = Start.after(found.response), np.broadcast_to(lever_arms(model), found.pose.shape)
    passes = []
    for count in (1, 2, 3, 4):
        monkeypatch.setattr(full_tangent, "PASSES", count)
        passes.append(model.whole_tangent(angle, found.pose, start, lever) / lever[:, :, None] / lever[:, None, :])
    changes = [np.abs(second - first).max() for first, second in pairwise(passes)]
    assert changes[1] < 1e-2 * changes[0]
    assert changes[2] < 1e-12 * np.abs(passes[0]).max()


SOFT = {
    "ring": {
        "inner_radius": 60.0,
        "outer_radius": 66.0,
        "width": 10.0,
        "material": {"youngs_modulus": 2600.0, "poisson_ratio": 0.38},
    },
    "load.torque": 2e4,
    "load.light_torque": 600.0,
}
"""A plastic ring 6 mm high: 0.1 mm/N, on which loads of 100 N turn with their pins by more than the ring holds against."""


@pytest.mark.parametrize("bodies", ["half-space", "hybrid"])
def test_pins_go_where_the_turned_loads_press_them(bodies, tmp_path):
    """Put aside by 2 or 1 µm, pins come back to the square of that; they were put where loads pressed them before they turned,
    and a soft ring was refused.
    """
    drive = with_fields(load_drive("robot-joint").cases["nominal"], SOFT)
    model = HalfSpace().prepare(drive).model
    balanced = solve_at_output(model, [drive], np.array([1.2]), drive.load.torque)
    if bodies == "hybrid":
        model = on_bodies(drive, tmp_path, "half-space")
    system = ContactSystem(model)
    at = system.respond(balanced.crank_angle, balanced.pose, Start.after(balanced.response), roughly=False)
    for _ in range(5):
        at = at.corrected(np.ones(1))
    random = np.random.default_rng(1).normal(size=(2, *at.shifts.shape))
    aside, off = random[0] + 1j * random[1], []
    for size in (2e-3, 1e-3):
        state = at.here._replace(shifts=at.shifts + size * aside)
        off.append(np.max(np.abs(at.again(state).shifts_after - at.shifts)))
    assert off[0] == pytest.approx(4.0 * off[1], rel=0.3)
    assert off[1] < 1e-3


def test_settled_deformations_leave_nothing_over(tmp_path):
    """What deformations of contacts that carry miss, mm: round-off where they have settled."""
    drive, model = prepared("paper, ring", tmp_path)
    pose = solve_at_output(model, [drive], ANGLES, drive.load.torque).pose
    left = [at.off for _, at in ContactSystem(model).in_groups(ANGLES, pose, None, roughly=False)]
    assert sum(one.size for one in left) >= ANGLES.size
    assert np.max(np.concatenate(left)) < 1e-9
