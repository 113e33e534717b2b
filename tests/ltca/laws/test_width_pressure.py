"""Pressures along the width: the estimate by line loads against grids, and both against what is known of lines."""

from __future__ import annotations

import numpy as np
import pytest

from ltca.contact.contact_kind import ContactKind, ContactKinds, Separation
from ltca.contact.hertz import line_peak_pressure
from ltca.contact.tilted_grid import press_tilted
from ltca.geometry.length_profile import Relief
from ltca.laws.line_contact import LineContactLaw
from ltca.laws.sliced_contact import slice_heights
from ltca.laws.sliced_line import SlicedLine
from ltca.laws.width_pressure import estimate_along_width
from ltca.reading.drive_file import load_drive
from validation.methods.grid_pressures import solve_along_width

LENGTH, MODULUS, RADIUS = 12.0, 115e3, 3.0


def kind_of(drop):
    generator = None
    if drop:
        generator = Relief(length=LENGTH, crown_radius=LENGTH**2 / (8.0 * drop))
    return ContactKind(length=LENGTH, contact_modulus=MODULUS, generator=generator, symmetric=True)


def both(drop, approach, tilt, slices=9):
    kind = kind_of(drop)
    line = SlicedLine(
        length=LENGTH, contact_modulus=MODULUS, slices=slices, relief=kind.relief(slice_heights(LENGTH, slices))
    )
    delta, theta, radius = (np.array([value]) for value in (approach, tilt, RADIUS))
    estimate = estimate_along_width(kind, line.respond(delta, theta, radius).line_load, radius)
    return estimate, solve_along_width(kind, delta, theta, radius, estimate.height)


@pytest.mark.parametrize(
    ("drop", "approach", "tilt", "tolerance"),
    [
        # largest pressure inside: 1 %, measured 0.5; at ends that carry: 3 %, measured 1 to 2.5 (0.8 of it that of the grid)
        pytest.param(5e-3, 3e-3, 0.0, 0.01, id="crowned"),
        pytest.param(5e-3, 1e-3, 6e-4, 0.01, id="crowned, tilted"),
        pytest.param(15e-3, 3e-3, 2e-3, 0.01, id="crowned, on its side"),
        pytest.param(0.0, 3e-3, 0.0, 0.03, id="straight"),
        pytest.param(0.0, 3e-3, 2e-4, 0.03, id="tilted"),
        pytest.param(0.0, 3e-3, 2e-3, 0.03, id="five eighths of the line"),
        pytest.param(5e-3, 3e-3, 2e-3, 0.03, id="crowned, on its end"),
    ],
)
def test_largest_pressure_by_line_loads_and_by_grids(drop, approach, tilt, tolerance):
    estimate, grid = both(drop, approach, tilt)
    assert estimate.largest[0] == pytest.approx(grid.largest[0], rel=tolerance)
    # Flat tops are found within a slice.
    assert estimate.place[0] == pytest.approx(grid.place[0], abs=LENGTH / 9.0) or tilt == 0.0
    np.testing.assert_array_equal(estimate.end_load > 0.0, grid.end_load > 0.0)


def test_a_long_straight_line_has_the_pressure_of_hertz_in_the_middle():
    estimate, grid = both(0.0, 3e-3, 0.0)
    law = LineContactLaw(LENGTH, MODULUS)
    for found in (estimate, grid):
        assert found.pressure[0, 4] == pytest.approx(float(law.mid_pressure(3e-3, RADIUS)), rel=3e-3)
        hertz = float(line_peak_pressure(found.line_load[0, 4], RADIUS, MODULUS))
        assert found.pressure[0, 4] == pytest.approx(hertz, rel=2e-3)  # a cell's mean against its peak
    assert grid.line_load.sum() * LENGTH / 9.0 == pytest.approx(
        float(law.load_and_stiffness(3e-3, RADIUS)[0]),
        rel=0.06,  # nine heights miss the ends
    )


def test_open_contacts_have_none():
    estimate, grid = both(5e-3, -1.0, 1e-3)
    for found in (estimate, grid):
        for values in (found.line_load, found.pressure, found.largest, found.place, found.end_load):
            assert not values.any()


def test_shapes_follow_the_arrays():
    kind = kind_of(5e-3)
    found = solve_along_width(kind, np.full((2, 3), 3e-3), np.array([0.0, 2e-4, -2e-4]), np.array(RADIUS))
    assert found.pressure.shape == (2, 3, 33)
    np.testing.assert_allclose(found.pressure[0, 1], found.pressure[1, 2, ::-1], rtol=1e-9)
    np.testing.assert_allclose(found.place[0, 1], -found.place[1, 2], rtol=1e-6)  # a parabola's top


def test_contacts_that_only_the_metal_of_a_lead_closes_have_the_pressure_of_their_load():
    """Pressures of `direct` left them out. 2 %: one grid, and means at heights, against the load of several grids."""
    drive = next(iter(load_drive("paper").cases.values())).with_fields({"contact.slices": 5, "disc.lead_slope": 1e-3})
    kind = ContactKinds.of_drive(drive).pins
    separation = Separation(effective_radius=RADIUS, departure=lambda _, x: x**2 / (2.0 * RADIUS))
    load = press_tilted(kind, separation, -1e-3, 0.0).load
    z = np.linspace(-0.5, 0.5, 401) * kind.length
    found = solve_along_width(kind, np.array([-1e-3]), np.zeros(1), np.array([RADIUS]), z)
    assert load > 100.0
    assert np.trapezoid(found.line_load[0], z) == pytest.approx(load, rel=0.02)
    assert found.largest[0] > 0.0
