"""Generalised force and tangent of all contacts against the energy they come from."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from ltca.arrays import stack_drives, take_rows
from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.compliance.response import Start
from ltca.equilibrium.reducer import Reducer
from ltca.geometry.coordinates import WHEEL_ANGLE
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive
from ltca.testing.bearing_alone import roller_laws


@dataclass(frozen=True)
class PowerLaw:
    """F = K δⁿ whatever the radius: a law whose energy depends on the approach alone."""

    factor: float
    exponent: float = 10.0 / 9.0

    def load_and_stiffness(self, approach, effective_radius):
        pressed = np.maximum(approach, 0.0) + 0.0 * effective_radius
        slope = np.where(
            pressed > 0.0, self.factor * self.exponent * np.maximum(pressed, 1e-300) ** (self.exponent - 1), 0
        )
        return self.factor * pressed**self.exponent, slope

    def energy(self, approach, effective_radius):
        pressed = np.maximum(approach, 0.0) + 0.0 * effective_radius
        return self.factor * pressed ** (self.exponent + 1.0) / (self.exponent + 1.0)


def contacts_of(drive):
    """The contacts of a drive of one disc on tables."""
    return Reducer(discs=(HalfSpaceCompliance.of_drive(drive),))


def energy_of(model, response):
    """Return ΣU of all contacts at every position."""
    laws = roller_laws(model)
    total = model.pin_law.energy(response.flank.approach, response.flank.effective_radius).sum(axis=1)
    total = total + model.hole_law.energy(response.holes.approach, 1.0).sum(axis=1)
    total = total + laws.inner.energy(response.rollers.inner_approach, laws.inner_radius).sum(axis=1)
    return total + laws.outer.energy(response.rollers.outer_approach, laws.outer_radius).sum(axis=1)


@pytest.fixture(scope="module")
def drives(paper_cases, random_drives):
    return [paper_cases["CS-6"], *random_drives[:4]]


def pressed_poses(drive, count, seed):
    """Poses that press many pairs: beyond clearances and backlash by about as much again."""
    rng = np.random.default_rng(seed)
    radius = drive.pin_wheel.pin_circle_radius
    size = 1.5e-3 * radius
    scale = size / np.array([1.0, 1.0, 0.6 * radius, 0.6 * radius])
    return rng.uniform(-20.0, 20.0, count), rng.uniform(-1.0, 1.0, (count, 4)) * scale, np.array([1, 1, radius, radius])


def test_force_is_the_gradient_of_the_energy_and_tangent_its_hessian(drives):
    """With laws of the approach alone, where the statement is exact."""
    for drive in drives:
        model = HalfSpaceCompliance.of_drive(drive)
        law = PowerLaw(1.5e4 * drive.disc.thickness**1.1)
        model = replace(model, pin_law=law, inner_law=law, outer_law=law)
        contacts = Reducer(discs=(model,))
        angles, poses, lever = pressed_poses(drive, 6, 1)
        here = contacts.respond(angles, poses)
        assert (here.pin_load > 0).any()
        assert (here.hole_load > 0).any()
        assert (here.rollers.outer_load > 0).any()
        approaches = [here.flank.approach, here.holes.approach, here.rollers.outer_approach]
        h = 1e-6 * drive.pin_wheel.pin_circle_radius / 88.0
        clear = np.all([np.min(np.abs(a), axis=1) > 3.0 * h for a in approaches], axis=0)
        assert clear.sum() >= 4  # steps must not cross first contact anywhere
        force_size = np.max(np.abs(here.force / lever))
        tangent_size = np.max(np.abs(here.tangent / lever[:, None] / lever))
        for column in range(4):
            move = np.zeros(4)
            move[column] = h / lever[column]
            ahead, behind = contacts.respond(angles, poses + move), contacts.respond(angles, poses - move)
            slope = (energy_of(model, ahead) - energy_of(model, behind)) / (2.0 * h)
            # h²/δ² for pairs pressed by 30 µm ~ 1e-3 … 1e-2 of their part: 1e-6; round-off R·1e-16·F/h ~ 1e-8
            error = (slope - here.force[:, column] / lever[column])[clear] / force_size
            np.testing.assert_allclose(error, 0.0, atol=1e-5)
            bend = (ahead.force - behind.force) / lever / (2.0 * h)
            error = (bend - here.tangent[:, :, column] / lever / lever[column])[clear] / tangent_size
            # a pair that touches by only 3 h has its stiffness known to some per cent there, one of many
            np.testing.assert_allclose(error, 0.0, atol=1e-3)
            np.testing.assert_allclose(np.median(np.abs(error)), 0.0, atol=1e-6)


def test_tangent_of_the_half_space_laws(drives):
    """The change of ρ with the place of the contact is left out of it: some 1e-4 of the stiffness at most."""
    for drive in drives:
        model = contacts_of(drive)
        angles, poses, lever = pressed_poses(drive, 4, 2)
        here = model.respond(angles, poses)
        h = 1e-7 * drive.pin_wheel.pin_circle_radius / 88.0
        size = np.max(np.abs(here.tangent / lever[:, None] / lever))
        for column in range(4):
            move = np.zeros(4)
            move[column] = h / lever[column]
            ahead, behind = model.respond(angles, poses + move), model.respond(angles, poses - move)
            bend = (ahead.force - behind.force) / lever / (2.0 * h)
            error = (bend - here.tangent[:, :, column] / lever / lever[column]) / size
            np.testing.assert_allclose(error, 0.0, atol=2e-3)


def test_tangent_is_symmetric(drives):
    for drive in drives:
        model = contacts_of(drive)
        angles, poses, lever = pressed_poses(drive, 6, 3)
        tangent = model.respond(angles, poses).tangent / lever[:, None] / lever
        np.testing.assert_allclose(tangent, tangent.swapaxes(1, 2), atol=1e-13 * np.abs(tangent).max())


def test_wheel_feels_pins_alone(drives):
    """The fourth force is the moment of the pin loads; holes and rollers do not reach the wheel."""
    for drive in drives:
        model = contacts_of(drive)
        angles, poses, _ = pressed_poses(drive, 6, 4)
        response = model.respond(angles, poses)
        moment = (response.pin_load * response.flank.gradient[..., WHEEL_ANGLE]).sum(axis=1)
        np.testing.assert_allclose(response.force[:, WHEEL_ANGLE], moment, rtol=1e-12)


def test_start_does_not_matter(drives):
    drive = drives[0]
    model = contacts_of(drive)
    angles, poses, _ = pressed_poses(drive, 4, 5)
    plain = model.respond(angles, poses)
    parameter, share = plain.flank.parameter + 0.01, np.full_like(plain.rollers.share, 0.9)
    start = replace(Start.after(plain), parameter=parameter, share=share, inner=None)
    other = model.respond(angles, poses, start)
    np.testing.assert_allclose(other.force, plain.force, atol=1e-8 * np.abs(plain.force).max())


def test_positions_of_a_batch_do_not_feel_each_other(drives):
    model = contacts_of(drives[0])
    angles, poses, _ = pressed_poses(drives[0], 5, 6)
    batch = model.respond(angles, poses)
    for row in range(5):
        alone = model.respond(angles[row : row + 1], poses[row : row + 1])
        np.testing.assert_allclose(alone.force[0], batch.force[row], rtol=1e-9, atol=1e-9 * np.abs(batch.force).max())


def test_stiffness_scales_with_modulus_and_shaft_spring(vary):
    """Each law takes the modulus of its own two bodies."""
    angles, poses = np.array([0.4]), np.array([[0.01, 0.02, 1e-4, -2e-3]])
    base = contacts_of(vary()).respond(angles, poses)
    soft = {"youngs_modulus": 103_000.0, "poisson_ratio": 0.3}
    # E* of a steel body on one half as stiff is 2/3 of steel on steel
    pins = contacts_of(vary(materials={"wheel_pin": soft})).respond(angles, poses)
    np.testing.assert_allclose(pins.pin_load, base.pin_load * 2.0 / 3.0, rtol=1e-12)
    np.testing.assert_array_equal(pins.rollers.outer_load, base.rollers.outer_load)
    # a soft roller softens both of its contacts alike: same balance, 2/3 of the load
    rollers = contacts_of(vary(materials={"roller": soft})).respond(angles, poses)
    np.testing.assert_allclose(rollers.rollers.outer_load, base.rollers.outer_load * 2.0 / 3.0, rtol=1e-9)
    np.testing.assert_array_equal(rollers.pin_load, base.pin_load)
    race = contacts_of(vary(materials={"inner_race": soft})).respond(angles, poses)
    loaded = base.rollers.outer_load > 0.0
    assert np.all(race.rollers.inner_approach[loaded] > base.rollers.inner_approach[loaded])
    holes = contacts_of(vary(pin_shaft={"stiffness": 2.0e6})).respond(angles, poses)
    np.testing.assert_allclose(holes.hole_load, 2.0 * base.hole_load, rtol=1e-14)
    np.testing.assert_allclose(base.hole_load, 1e6 * np.maximum(base.holes.approach, 0.0), rtol=1e-14)


@pytest.mark.slow
def test_crowned_pins_on_deviated_flanks_are_a_batch(paper_cases, coarse_tables):
    """A batch of drives with crowned pins and waves on their flanks ended in a mismatch of shapes."""
    waves = {"disc.profile_errors.cosine": (0.001, 0.0, 0.0, 0.0), "disc.profile_errors.sine": (0.0,) * 4}
    crown = {"pin_wheel.pin_profile.crown_drop": 0.002}
    drives = [with_fields(paper_cases["CS-1"], waves | crown | {"crank.eccentricity_error": e}) for e in (0.0, 0.01)]
    batch = stack_drives([HalfSpaceCompliance.of_drive(each, in_batch=True) for each in drives], 1)
    pose = np.zeros((2, 4))
    pose[:, 3] = -0.003  # wound up beyond the backlash, so that pins carry
    together = Reducer(discs=(batch,)).respond(np.full(2, 0.3), pose)
    assert together.pin_load.max() > 100.0
    for row, drive in enumerate(drives):
        alone = contacts_of(drive).respond(np.array([0.3]), pose[:1])
        # Tables on a ladder of radii and tables of one drive: their interpolation differs.
        np.testing.assert_allclose(together.pin_load[row], alone.pin_load[0], rtol=2e-3, atol=1e-6)


@pytest.mark.slow
def test_radii_between_samples_and_on_other_lobes_are_in_the_table_of_crowned_pins(coarse_tables):
    """A crowned pin at the sharpest place of a flank was "asked for 2.85237" mm of a table from 2.85238 mm on."""
    drive = load_drive(Path(__file__).parents[2] / "contract" / "drive.toml").cases["nominal"]
    drive = with_fields(drive, {"pin_wheel.pin_profile.crown_drop": 0.001})
    for model in (
        HalfSpaceCompliance.of_drive(drive),
        stack_drives([HalfSpaceCompliance.of_drive(each, in_batch=True) for each in [drive, drive]], 1),
    ):
        profile = take_rows(model.geometry.profile, np.array([0]))
        turn = np.linspace(0.0, 2.0 * np.pi, 60_001)[None]
        radii = model.geometry.placement.wheel_pin_radii
        for radius in (radii.min(), radii.max()):
            model.pin_law.load_and_stiffness(1e-3, profile.effective_radius(turn, radius))
