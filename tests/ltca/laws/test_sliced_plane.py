"""Plane strain in slices: the plane law at every height, and its energy."""

import numpy as np
import pytest

from ltca.laws.backed import BackedLaw
from ltca.laws.plane_strain import PlaneContactLaw
from ltca.laws.sliced_contact import POINTS
from ltca.laws.sliced_plane import SlicedPlane

LENGTH, MODULUS, DATUM, SLICES = 10.0, 113186.8, 12.0, 5
RADIUS = np.full((2, 20), 6.0)


def sliced(overlap=0.0, relief=0.0):
    held = np.zeros((SLICES, POINTS)) + relief
    return SlicedPlane(length=LENGTH, contact_modulus=MODULUS, datum=DATUM, slices=SLICES, relief=held, overlap=overlap)


@pytest.mark.parametrize("overlap", [0.0, 6.7e-7])
def test_aligned_slices_are_the_plane_law(overlap):
    """Load, stiffness and energy of one contact over the whole width, sleeves' walls counted once: 1e-12, round-off."""
    plane = PlaneContactLaw(thickness=LENGTH, contact_modulus=MODULUS, datum=DATUM)
    if overlap:
        plane = BackedLaw(contact=plane, seat=None, play=np.zeros(1), overlap=overlap)
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
