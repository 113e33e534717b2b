"""What the pictures share: rows outside a window are told apart, surfaces and lines lie where they should."""

from __future__ import annotations

import numpy as np

from fem.pictures.flat_view import flat_lines, flat_surface, may_show


def test_rows_show_unless_they_lie_beyond_one_side_of_the_window():
    centre, half_side = 10.0 + 5.0j, 1.0
    inside = [10.2 + 5.1j, 10.4 + 5.1j, 10.2 + 5.6j]
    through = [8.0 + 3.0j, 12.0 + 7.0j, 8.0 + 3.0j]  # no corner inside, yet it crosses
    right, below = [11.1 + 5.0j, 12.0 + 5.0j, 11.5 + 9.0j], [10.0 + 3.0j, 10.5 + 3.9j, 9.5 + 3.5j]
    rows = np.array([inside, through, right, below])
    np.testing.assert_array_equal(may_show(rows, centre, half_side), [True, True, False, False])


def test_surfaces_and_lines_hold_their_points_in_order():
    points = np.array([0.0, 1.0, 1.0 + 1.0j, 1.0j])
    surface = flat_surface(points, np.array([[0, 1, 2], [0, 2, 3]]))
    assert surface.n_cells == 2
    assert surface.area == 1.0
    lines = flat_lines(np.array([[0.0, 3.0, 3.0 + 4.0j], [1.0j, 2.0j, 3.0j]]), 0.5)
    assert lines.n_cells == 2
    np.testing.assert_allclose(lines.points[:, 2], 0.5)
    lengths = lines.compute_cell_sizes(length=True)["Length"]
    np.testing.assert_allclose(lengths, [7.0, 2.0], rtol=1e-14)
