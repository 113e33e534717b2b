"""What the cranks of a full solution take, from forces on rollers made by hand."""

from types import SimpleNamespace

import numpy as np
import pytest

from fem.drive.pose import moments_on_cranks

AXES = np.array([20.0 + 0.0j, -20.0 + 0.0j])
RACES = AXES + np.array([1.5 + 0.4j, 1.2 - 0.9j])
POINTS = np.array([[6.0 + 1.0j, -2.0 + 5.0j], [3.0 - 5.5j, 1.0 + 6.0j]])
FORCES = np.array([[800.0 - 150.0j, 90.0 - 400.0j], [-350.0 + 700.0j, 60.0 - 20.0j]])


@pytest.mark.parametrize("cage_speed", [0.0, 0.4, 1.0])
def test_moments_of_roller_forces_about_their_crank(cage_speed):
    """By cross products: the force acts at the centre of the race, and by `cage_speed` its moment about that centre counts.

    With 1 it is the moment about the axis of the crank of forces where they act; pins have no part in it.
    """
    place = SimpleNamespace(cranks=2, crank_axes=AXES, cage_speed=cage_speed)
    rollers = [SimpleNamespace(kind="roller_outer", index=index) for index in range(4)]
    pairs = [SimpleNamespace(kind="pin", index=0), *rollers, SimpleNamespace(kind="hole", index=1)]
    model = SimpleNamespace(placement=place, pairs=pairs, race_centres=RACES, crank_of=lambda index: index // 2)
    at = RACES[:, None] + POINTS
    on_rollers = -FORCES  # on the round side; the disc feels the opposite
    about_origin = (at.conjugate() * on_rollers).imag
    rows = np.stack((on_rollers.real, on_rollers.imag, about_origin), axis=-1).reshape(4, 3)
    beside = np.array([[1e4, 2e4, 3e5]])
    found = moments_on_cranks(model, np.concatenate((beside, rows, beside)))
    force = FORCES.sum(axis=1)
    at_centre = ((RACES - AXES).conjugate() * force).imag
    about_centre = (POINTS.conjugate() * FORCES).imag.sum(axis=1)
    np.testing.assert_allclose(found, at_centre + cage_speed * about_centre, rtol=1e-12)
    if cage_speed == 1.0:
        about_axis = ((at - AXES[:, None]).conjugate() * FORCES).imag.sum(axis=1)
        np.testing.assert_allclose(found, about_axis, rtol=1e-12)
