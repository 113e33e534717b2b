"""Pressures of contacts that tilt, against the load and the moment that they were asked for and Hertz's line contact."""

import numpy as np
import pytest

from ltca.analysis.tilted_fields import solve_tilted
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
