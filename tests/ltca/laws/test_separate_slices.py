"""Slices that do not feel each other: plane strain at every height, its energy, and springs by hand."""

import numpy as np
import pytest

from ltca.laws.backed import BackedLaw
from ltca.laws.plane_strain import PlaneContactLaw
from ltca.laws.separate_slices import SeparateSlices
from ltca.laws.sliced_contact import POINTS
from ltca.laws.spring import SpringLaw

LENGTH, MODULUS, DATUM, SLICES = 10.0, 113186.8, 12.0, 5
RADIUS = np.full((2, 20), 6.0)


def of_plane(overlap):
    plane = PlaneContactLaw(thickness=LENGTH, contact_modulus=MODULUS, datum=DATUM)
    return BackedLaw(contact=plane, play=np.zeros(1), overlap=overlap) if overlap else plane


def sliced(overlap=0.0, relief=0.0):
    held = np.zeros((SLICES, POINTS)) + relief
    return SeparateSlices(law=of_plane(overlap), length=LENGTH, slices=SLICES, relief=held)


def springs(stiffness):
    relief = np.zeros((SLICES, POINTS))
    return SeparateSlices(law=SpringLaw(stiffness=stiffness), length=12.0, slices=SLICES, relief=relief)


@pytest.mark.parametrize("overlap", [0.0, 6.7e-7])
def test_aligned_slices_are_the_plane_law(overlap):
    """Load, stiffness and energy of one contact over the whole width, sleeves' walls counted once: 1e-12, round-off."""
    plane = of_plane(overlap)
    approach = np.linspace(-1e-3, 0.03, RADIUS.size).reshape(RADIUS.shape)
    law = sliced(overlap)
    found = law.respond(approach, np.zeros(RADIUS.shape), RADIUS)
    load, stiffness = plane.load_and_stiffness(approach, RADIUS)
    np.testing.assert_allclose(found.load, load, rtol=1e-12)
    np.testing.assert_allclose(found.by_approach, stiffness, rtol=1e-12)
    np.testing.assert_allclose(law.energy(found, RADIUS), plane.energy(approach, RADIUS), rtol=1e-12)
    np.testing.assert_allclose(found.moment, 0.0, atol=1e-12 * load.max() * LENGTH)
    np.testing.assert_allclose(found.line_load, np.broadcast_to(load[..., None, None] / LENGTH, found.line_load.shape))


@pytest.mark.parametrize("overlap", [0.0, 6.7e-7])
def test_loads_and_moments_are_the_slopes_of_the_energy(overlap):
    """Differences over 1e-7 of full lines, of crowned ones and of ends that carry alone: 1e-7 of the largest, as of other laws.

    Points that begin to carry within a step bend the slope of the slope: 1e-5 there.
    """
    rng = np.random.default_rng(5)
    delta, theta = rng.uniform(-0.004, 0.02, RADIUS.shape), rng.normal(size=RADIUS.shape) * 1.5e-3
    law = sliced(overlap, 1e-3 * np.linspace(-1.0, 1.0, SLICES)[:, None] ** 2)
    found, step = law.respond(delta, theta, RADIUS), 1e-7
    assert (found.load == 0.0).any()
    assert ((found.slice_load > 0.0).sum(axis=-1) < SLICES).any()
    for name, expected, by_tilt, bound in (
        ("energy", "load", False, 1e-7), ("energy", "moment", True, 1e-7), ("load", "by_approach", False, 1e-5),
        ("load", "by_tilt", True, 1e-5), ("moment", "by_tilt", False, 1e-5), ("moment", "moment_by_tilt", True, 1e-5),
    ):  # fmt: skip
        ends = [law.respond(delta + side * (not by_tilt), theta + side * by_tilt, RADIUS) for side in (step, -step)]
        values = [law.energy(end, RADIUS) if name == "energy" else getattr(end, name) for end in ends]
        slope = (values[0] - values[1]) / (2.0 * step)
        values = getattr(found, expected)
        np.testing.assert_allclose(slope, values, atol=bound * np.max(np.abs(values)))


def test_pressed_all_along_it_is_a_spring_of_force_and_of_moment():
    law = springs(1e5)
    found = law.respond(np.array([0.01]), np.array([1e-3]), np.array([5.0]))
    assert found.load[0] == pytest.approx(1e3, rel=1e-14)
    assert found.moment[0] == pytest.approx(1e5 * 12.0**2 / 12.0 * 1e-3, rel=1e-14)
    assert found.by_tilt[0] == pytest.approx(0.0, abs=1e-9)
    assert law.energy(found, 5.0)[0] == pytest.approx(0.5 * 1e5 * 0.01**2 + 0.5 * 1e5 * 12.0 * 1e-6, rel=1e-14)


def test_stiffnesses_of_a_batch_of_drives():
    one = springs(np.array([[1e5], [2e5]]))
    found = one.respond(np.full((2, 3), 0.01), np.zeros((2, 3)), np.ones((2, 3)))
    np.testing.assert_allclose(found.load, [[1e3] * 3, [2e3] * 3])
    np.testing.assert_allclose(found.line_load[1], 2e3 / 12.0)
