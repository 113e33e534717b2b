"""Grids that fit a contact: room for the widest contact, and a crowned line against Hertz' ellipse."""

import numpy as np
import pytest

from ltca.contact.contact_kind import ContactKind
from ltca.contact.fitted_grid import RUNG, GridRung, solve_fitted, unit_grid
from ltca.contact.pressure_cells import GRID_ROOM
from ltca.geometry.length_profile import Relief
from validation.hertz import solve_point_contact

MODULUS, SMALL, LARGE = 113e3, 2.0, 40.0


@pytest.mark.parametrize("cells", [7, 12])
@pytest.mark.parametrize("rung", [-90, -60])
def test_grids_reach_as_far_as_the_widest_contact(rung, cells):
    half_width = np.exp(RUNG * rung)
    grid = unit_grid(GridRung(rung, 0), cells, symmetric=True)
    edges = grid.x_edges / half_width
    assert GRID_ROOM <= edges[-1] < GRID_ROOM + 1.0 / cells
    np.testing.assert_allclose(np.diff(edges), 1.0 / cells, rtol=1e-12)


@pytest.mark.parametrize("length", [6.0, 12.0])
def test_a_crowned_line_within_its_ends_is_an_elliptical_contact(length):
    """Load and largest pressure of Hertz; the ellipse is cut by cells, an error of their square."""
    approach = 2e-3
    profile = Relief(length=length, crown_radius=LARGE)
    kind = ContactKind(length=length, contact_modulus=MODULUS, generator=profile, symmetric=True, cells=16)
    found = solve_fitted(kind, approach, SMALL, lambda x: x**2 / (2.0 * SMALL))
    hertz = solve_point_contact(approach, SMALL, LARGE, MODULUS)
    assert hertz.half_axis_long < 0.5 * length
    assert found.load == pytest.approx(hertz.load, rel=0.01)
    assert found.pressure.max() == pytest.approx(hertz.peak_pressure, rel=0.02)
