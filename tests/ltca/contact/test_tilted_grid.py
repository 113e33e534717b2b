"""Grids of contacts that tilt: the aligned ones without symmetry, one energy, and a mirror."""

from __future__ import annotations

import numpy as np
import pytest

from ltca.contact.contact_kind import ContactKind, Separation
from ltca.contact.tilted_grid import find_patch, press_tilted
from ltca.geometry.length_profile import Relief
from validation.methods.pressed_grid import press

LENGTH, MODULUS, RADIUS = 12.0, 115e3, 3.0
SEPARATION = Separation(effective_radius=RADIUS, departure=lambda _, x: x**2 / (2.0 * RADIUS))
CROWN = Relief(length=LENGTH, crown_radius=LENGTH**2 / (8.0 * 5e-3))


def kind_of(generator=None, symmetric=True, cells=12):
    return ContactKind(length=LENGTH, contact_modulus=MODULUS, generator=generator, symmetric=symmetric, cells=cells)


@pytest.mark.parametrize("approach", [3e-3, 30e-3])
def test_an_aligned_line_has_the_load_of_its_quarter(approach):
    found, quarter = press_tilted(kind_of(), SEPARATION, approach, 0.0), press(kind_of(), SEPARATION, approach)
    # The same cells along the width, another place on the ladder of widths: 1e-4 of the load, as told there.
    assert found.load == pytest.approx(quarter.load, rel=3e-4)
    # Cells at the edge that are about to touch: 4e-3 of the slope, measured.
    assert found.by_approach == pytest.approx(quarter.stiffness, rel=8e-3)
    assert found.moment == pytest.approx(0.0, abs=1e-9 * LENGTH * found.load)


@pytest.mark.parametrize(("approach", "tilt"), [(3e-3, 2e-4), (30e-3, 2e-3)])
def test_loads_and_moments_of_one_grid_have_one_energy(approach, tilt):
    kind, step = kind_of(), 1e-4 * approach
    found = press_tilted(kind, SEPARATION, approach, tilt)

    def change(by_approach, by_tilt):
        ends = [press_tilted(kind, SEPARATION, approach + s * by_approach, tilt + s * by_tilt) for s in (1.0, -1.0)]
        return np.array([(ends[0][k] - ends[1][k]) / (2.0 * step) for k in (0, 1, 5)])

    load, moment, energy = change(step, 0.0)
    # No grid changes within the steps: differences of a quadratic function, to round-off.
    assert load == pytest.approx(found.by_approach, rel=1e-8)
    assert moment == pytest.approx(found.by_tilt, rel=1e-8)
    assert energy == pytest.approx(found.load, rel=1e-8)
    load, moment, energy = change(0.0, step / LENGTH) * LENGTH
    assert load == pytest.approx(found.by_tilt, rel=1e-8)
    assert moment == pytest.approx(found.moment_by_tilt, rel=1e-8)
    assert energy == pytest.approx(found.moment, rel=1e-8)


@pytest.mark.parametrize("generator", [None, CROWN])
@pytest.mark.parametrize(("approach", "tilt"), [(1e-3, 6e-4), (3e-3, 2e-3)])
def test_slopes_where_the_patch_moves(generator, approach, tilt):
    kind, step = kind_of(generator), 1e-5 * approach
    found = press_tilted(kind, SEPARATION, approach, tilt)
    up, down = (press_tilted(kind, SEPARATION, approach + sign * step, tilt) for sign in (1.0, -1.0))
    # Cells move with the patch, and the error of the grid with them: 1 % of the slopes, measured.
    assert (up.load - down.load) / (2.0 * step) == pytest.approx(found.by_approach, rel=0.015)
    assert (up.moment - down.moment) / (2.0 * step) == pytest.approx(
        found.by_tilt, abs=0.015 * LENGTH * found.by_approach
    )


def test_the_mirror_of_a_contact():
    kind = kind_of(symmetric=False)
    slanted = Separation(effective_radius=RADIUS, departure=lambda _, x: x**2 / (2.0 * RADIUS) * (1.0 + 0.1 * x))
    found, mirrored = (press_tilted(kind, slanted, 1e-3, tilt) for tilt in (6e-4, -6e-4))
    assert mirrored.load == pytest.approx(found.load, rel=1e-10)
    assert mirrored.moment == pytest.approx(-found.moment, rel=1e-10)
    assert find_patch(kind, -1.0, 1e-4) is None


def test_a_start_alters_nothing():
    kind = kind_of(CROWN)
    before = press_tilted(kind, SEPARATION, 2.9e-3, 5e-4)
    found = press_tilted(kind, SEPARATION, 3e-3, 5e-4, before.pieces)
    fresh = press_tilted(kind, SEPARATION, 3e-3, 5e-4)
    assert found.load == pytest.approx(fresh.load, rel=1e-12)
    again = press_tilted(kind, SEPARATION, 3e-3, 5e-4, fresh.pieces)
    assert again.pieces[0] is fresh.pieces[0]
