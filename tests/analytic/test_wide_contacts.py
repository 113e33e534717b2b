"""Where the tables end: Hertz and half-planes against an elastic cylinder with its true boundary.

`ltca.testing.elastic_cylinder` shares nothing with the tables: Fourier series of the disc on the one side, grids of half-spaces
on the other. ``benchmarks/wide_contacts.py`` prints the whole curve.
"""

from __future__ import annotations

import pytest

from ltca.testing.elastic_cylinder import hertz_approach, press_cylinder, press_half_plane

CELLS, REACH = 120, 0.36


@pytest.mark.parametrize("half_width", [0.03, pytest.param(0.06, marks=pytest.mark.slow)])
def test_narrow_contacts_of_the_cylinder_are_hertz(half_width):
    """Johnson's closed form (Eq. 5.57) holds to (b/r)², here 0.4 of it at most; 10 and 20 cells to the half-width."""
    found = press_cylinder(hertz_approach(half_width), CELLS, REACH)
    assert found.line_load == pytest.approx(0.7853981634 * half_width**2, rel=0.4 * half_width**2)
    # constant cells make 2√⟨x²⟩ too large by 0.15 (cell/b)², 0.15 % with ten
    assert found.half_width == pytest.approx(half_width, rel=2e-3)
    assert found.peak_pressure == pytest.approx(0.5 * half_width, rel=2e-3)


@pytest.mark.parametrize("half_width", [0.1, 0.2, 0.3])
def test_the_true_separation_is_nearer_than_the_parabola(half_width):
    """Measured: the parabola carries 0.104, 0.552, 1.51 % too much, the circle 0.069, 0.363, 0.976 %: grows as (b/r)²."""
    approach = hertz_approach(half_width)
    right = press_cylinder(approach, CELLS, REACH)
    parabola, circle = (press_half_plane(approach, CELLS, REACH, parabola=flag) for flag in (True, False))
    for name in ("line_load", "half_width", "peak_pressure"):
        far, near = (getattr(found, name) / getattr(right, name) - 1.0 for found in (parabola, circle))
        assert abs(near) < 0.7 * abs(far) < 0.7 * 0.35 * half_width**2
    # what is left out is of the order (b/r)²; that it is no multiple of it by one number is its next order
    assert 0.08 * half_width**2 < parabola.line_load / right.line_load - 1.0 < 0.2 * half_width**2
