"""Pressures of contacts that tilt, against the load and the moment that they were asked for and Hertz's line contact."""

import numpy as np
import pytest

from ltca.analysis.tilted_fields import _pressed, solve_tilted
from ltca.contact.contact_kind import ContactKinds
from ltca.reading.drive_file import load_drive

RADIUS, LOAD = 4.0, 2000.0


def parabola(across):
    """Separation of a cylinder from a plane."""
    return across**2 / (2.0 * RADIUS)


@pytest.fixture(scope="module")
def of_rollers():
    return ContactKinds.of_drive(load_drive("paper").cases["CS-1"]).outer


def carried(patch):
    """Load and moment of the cells about mid-width, N and N·mm."""
    grid = patch.grid
    force = (grid.images * patch.pressure * grid.areas).sum(axis=0)
    return float(force.sum()), float(force @ (0.5 * (grid.y_edges[1:] + grid.y_edges[:-1])))


@pytest.mark.parametrize("moment", [0.0, 1500.0])
def test_cells_carry_the_load_and_the_moment_of_the_contact(of_rollers, moment):
    patch, _ = solve_tilted(of_rollers, LOAD, moment, RADIUS, parabola)
    load, found = carried(patch)
    assert load == pytest.approx(LOAD, rel=1e-9)
    assert found == pytest.approx(moment, abs=0.01 * LOAD * 0.5 * of_rollers.length)


def test_an_aligned_contact_has_the_pressure_of_hertz_in_the_middle(of_rollers):
    """p = √(E* F / π ρ L); the line is short, its ends carry a little less or more."""
    patch, _ = solve_tilted(of_rollers, LOAD, 0.0, RADIUS, parabola)
    hertz = np.sqrt(of_rollers.contact_modulus * LOAD / (np.pi * RADIUS * of_rollers.length))
    z = 0.5 * (patch.grid.y_edges[1:] + patch.grid.y_edges[:-1])
    middle = patch.pressure[:, np.argmin(np.abs(z))].max()
    assert middle == pytest.approx(hertz, rel=0.05)


def test_what_yields_in_proportion_is_pressed_in_one_step():
    """Newton's method by load and moment over half the length, whatever that length is: the second place is the answer."""
    stiff, mixed, turning, half, asked = 3e5, 2e5, 8e6, 5.9, []

    def press(approach, tilt):
        asked.append((approach, tilt))
        load, moment = stiff * approach + mixed * tilt, mixed * approach + turning * tilt
        return np.array([load, moment, stiff, mixed, turning])

    found = _pressed(press, 2000.0, 1500.0, half, (1e-3, 0.0))
    exact = np.linalg.solve([[stiff, mixed], [mixed, turning]], [2000.0, 1500.0])
    np.testing.assert_allclose(found, exact, rtol=1e-6)
    np.testing.assert_allclose(asked[1], exact, rtol=1e-6)
