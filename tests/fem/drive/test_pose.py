"""When the iteration of the pose stops, and that bodies never travel too far at once. No meshes here."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

import fem.drive.pose as pose
from fem.contact.unilateral import ContactSolution
from fem.drive.model import DrivePose
from fem.drive.supports import Supports
from ltca.errors import ConvergenceError

CONTACT = ContactSolution(
    pressure=np.ones(3), motion=np.zeros(6), opening=np.zeros(3), active=np.ones(3, dtype=bool),
    residual=0.0, iterations=1,
)  # fmt: skip


def plain_pose(rollers=2, pins=1):
    return DrivePose(
        disc_x=0.0, disc_y=0.0, disc_rotation=0.0, wheel_angle=0.0,
        roller_distances=np.full(rollers, 24.5), shaft_pin_displacements=np.zeros(pins, dtype=complex),
        wheel_pin_displacements=np.zeros(2, dtype=complex), crank_displacements=np.zeros(1, dtype=complex),
    )  # fmt: skip


@pytest.fixture
def stepping(monkeypatch):
    """Return a function that runs the iteration with given increments [mm] and loads [N] of each step."""

    def run(increments, loads, **options):
        steps = iter(zip(increments, loads, strict=True))
        now = {}

        def forces(model, integrals, pressure):
            now["increment"], load = next(steps)
            return np.column_stack([0.6 * np.asarray(load), 0.8 * np.asarray(load), np.zeros(len(load))])

        model = SimpleNamespace(
            pairs=("first", "second"), unknown_count=3, crank_angle=0.5, integrate=lambda pair, at: pair
        )
        monkeypatch.setattr(pose, "joint_problem", lambda *given: None)
        monkeypatch.setattr(pose, "solve_floating_contact", lambda problem, active: CONTACT)
        monkeypatch.setattr(pose, "pair_forces", forces)
        monkeypatch.setattr(pose, "moments_on_cranks", lambda *given: np.zeros(1))
        monkeypatch.setattr(pose, "_move", lambda models, supports, at, integrals, contacts: (at, now["increment"]))
        load, supports = pose.WheelLoad(moment=-1.0), Supports(wheel=None, shaft=np.eye(4))
        (found,) = pose.solve_poses((model,), supports, load, (plain_pose(),), start_active=CONTACT.active, **options)
        return found

    return run


def test_half_a_micrometre_and_a_thousandth_of_the_load_are_asked_for(stepping):
    """The pose must rest within 0.5 µm *and* the loads within 0.1 % of the largest: one of both is not enough."""
    loads = [[900.0, 100.0]] * 4
    moving = stepping([0.03, 5.1e-4, 5.1e-4, 1e-6], loads)
    assert moving.iterations == 4
    assert moving.increments == (0.03, 5.1e-4, 5.1e-4, 1e-6)
    changing = stepping([1e-6] * 4, [[900.0, 100.0], [900.0, 101.0], [900.0, 102.0], [900.0, 102.0]])
    assert changing.iterations == 4
    # 1 N of the largest load, not of the contact's own
    np.testing.assert_allclose(changing.load_changes, [1.0, 1.0 / 900.0, 1.0 / 900.0, 0.0])


def test_a_pose_that_never_rests_is_an_error_with_its_increments(stepping):
    with pytest.raises(ConvergenceError, match="did not settle in 3 steps") as caught:
        stepping([0.03, 0.02, 0.01], [[900.0, 100.0]] * 3, limit=3)
    assert list(caught.value.history) == [0.03, 0.02, 0.01]


def move(motion, start=None, force=(0.0, 0.0, 0.0), ring=0.0):
    """Move from a pose with the multipliers of one step: disc x, y, rotation, wheel, two rollers."""
    model = SimpleNamespace(
        shapes=SimpleNamespace(disc=SimpleNamespace(flank=SimpleNamespace(profile=SimpleNamespace(tip_radius=50.0)))),
        placement=SimpleNamespace(
            wheel_pin_centres=np.array([80.0, -80.0j]), wheel_pin_radii=np.ones(2), hole_radii=np.ones(1), cranks=1
        ),
        rollers=(1, 0),
        pairs=tuple(
            SimpleNamespace(kind=kind, index=0, unknowns=slice(place, place + 1))
            for place, kind in enumerate(("hole", "pin"))
        ),
        unknown_count=2,
        resultants_of=lambda pair, force: np.array(force)[:, None],
        wheel_direction=lambda at: 1j,
    )
    found = SimpleNamespace(motion=np.asarray(motion), pressure=np.ones(2))
    supports = Supports(wheel=ring * np.eye(4), shaft=1e-6 * np.diag([1.0, 1.0, 0.0, 0.0]))
    poses = [plain_pose() if start is None else start]
    (at,), increment = pose._move([model], supports, poses, [[force, (9.0, 9.0, 9.0)]], [found])
    return at, increment


def test_bodies_move_by_the_multipliers():
    at, increment = move([0.01, -0.02, 3e-4, -2e-4, 0.003, -0.001], force=(3000.0, -4000.0, 0.0))
    assert (at.disc_x, at.disc_y, at.disc_rotation, at.wheel_angle) == (0.01, -0.02, 3e-4, -2e-4)
    np.testing.assert_allclose(at.roller_distances, [24.499, 24.503], rtol=1e-14)
    # a shaft pin yields by its load over its stiffness, the way it is pushed
    np.testing.assert_allclose(at.shaft_pin_displacements, [0.003 - 0.004j], rtol=1e-14)
    assert increment == pytest.approx(0.02)
    assert move([0.01, 0.0, 3e-4, -2e-4, 0.0, 0.0])[1] == pytest.approx(16e-3)  # the wheel at its pin circle
    assert move([0.01, 0.0, 3e-4, 0.0, 0.0, 0.0])[1] == pytest.approx(15e-3)  # the disc at its tip
    assert move(np.zeros(6), force=(0.0, -5000.0, 0.0))[1] == pytest.approx(5e-3)  # a shaft pin alone


def test_seats_of_a_ring_move_in_the_wheel():
    """9 + 9j N on a pin are 9 − 9j in a wheel that stands a quarter turn ahead; 1 µm/N of the ring."""
    at, increment = move(np.zeros(6), ring=1e-3)
    np.testing.assert_allclose(at.wheel_pin_displacements, [0.009 - 0.009j, 0.0], rtol=1e-14)
    assert increment == pytest.approx(0.009 * np.sqrt(2.0))


def test_no_step_is_longer_than_five_hundredths():
    """Normals are those of the old pose, so all motions are cut alike; the increment says what was asked for."""
    at, increment = move([0.3, -0.4, 1e-3, 0.0, 0.2, 0.0])
    assert increment == pytest.approx(0.4)
    assert (at.disc_x, at.disc_y) == (pytest.approx(0.0375), pytest.approx(-0.05))
    assert at.disc_rotation == pytest.approx(1.25e-4)
    np.testing.assert_allclose(at.roller_distances, [24.5, 24.525], rtol=1e-14)
