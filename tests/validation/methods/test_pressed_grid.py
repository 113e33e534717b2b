"""Contacts on grids: loads that depend on the contact alone."""

from __future__ import annotations

import numpy as np
import pytest

from ltca.contact.contact_kind import ContactKind, Separation
from ltca.contact.fitted_grid import BLEND, RUNG, GridRung, find_patch_length, solve_fitted, unit_grid
from ltca.contact.pressure_cells import PatchGrid, solve_patch
from ltca.drive.parts import LengthProfile
from ltca.geometry.length_profile import generator_profile
from validation.methods.pressed_grid import press, recover_patches

LENGTH, MODULUS, RADIUS = 11.8, 113e3, 4.0
PROFILES = {
    "cylinder": LengthProfile(),
    "logarithmic": LengthProfile(logarithmic_factor=1.0),
    "crowned": LengthProfile(crown_drop=0.02),
}


def kind_of(profile="cylinder", cells=12):
    return ContactKind(
        length=LENGTH,
        contact_modulus=MODULUS,
        generator=generator_profile(PROFILES[profile], LENGTH, 5.0),
        symmetric=True,
        cells=cells,
    )


def parabola(place=0, part=0.0):
    """Separation whose curvature differs between the places of a ladder."""
    return Separation(
        effective_radius=RADIUS,
        departure=lambda at, x: x**2 / (2.0 * RADIUS) * (1.0 + 1e-4 * at),
        place=place,
        part=part,
    )


def test_pressing_on_without_a_factorisation_is_exact():
    """While the same cells touch the load is linear in the approach; a fresh solution agrees to round-off."""
    kind, separation = kind_of(), parabola()
    load, stiffness, pieces = press(kind, separation, 8e-3)
    (piece,) = pieces
    further = press(kind, separation, 8e-3 + 1e-8, pieces)
    assert further.pieces[0] is piece
    assert further.load == pytest.approx(load + 1e-8 * stiffness, rel=1e-12)
    assert further.load == pytest.approx(press(kind, separation, 8e-3 + 1e-8).load, rel=1e-11)
    back = press(kind, separation, 5e-3, pieces)
    assert back.pieces[0] is not piece
    assert back.load == pytest.approx(press(kind, separation, 5e-3).load, rel=1e-11)


def test_where_the_edge_falls_moves_the_load_by_less_than_a_ten_thousandth():
    kind, found = kind_of(), press(kind_of(), parabola(), 8e-3).pieces[0].grid
    loads = []
    for rung in range(found.rung - 2, found.rung + 3):  # ± 10 % of the half-width; contacts keep within 2.5 %
        shape = unit_grid(GridRung(rung, 0), 12, symmetric=True)
        grid = PatchGrid(x_edges=shape.x_edges * LENGTH, y_edges=shape.y_edges * LENGTH)
        separation = grid.cell_means(lambda x, y: x**2 / (2.0 * RADIUS) + 0.0 * y)
        loads.append(solve_patch(grid, separation, kind.contact_modulus, 8e-3).load)
    assert np.ptp(loads) < 2e-4 * np.mean(loads)
    assert press(kind, parabola(), 8e-3).load == pytest.approx(loads[2], rel=1e-11)


def sweep(profile):
    """Approaches over several rungs, and those at which more than one grid has a share."""
    kind = kind_of(profile)
    approaches = np.geomspace(4e-3, 8e-3, 161)
    shared = [len(press(kind, parabola(), float(approach)).pieces) for approach in approaches]
    return kind, approaches, np.array(shared)


@pytest.mark.slow
@pytest.mark.parametrize("profile", PROFILES)
def test_loads_are_continuous_where_grids_change(profile):
    """About a boundary of rungs both grids share the contact: stiffness is the slope of the load there too.

    Without the share the load jumps by what the grids differ, up to 1e-4 (1e-3 where the patch gets shorter).
    """
    kind, approaches, shared = sweep(profile)
    assert shared.max() >= 2
    assert 0.0 < np.mean(shared > 1) < 4.0 * BLEND  # and it costs little
    for approach in approaches[shared > 1][:4]:
        step = 1e-7 * approach
        before, here, after = (press(kind, parabola(), approach + way * step) for way in (-1.0, 0.0, 1.0))
        # second difference of a continuous slope; a kink or jump of 1e-6 of the load would be 10 of these
        assert (after.load - before.load) / (2.0 * step) == pytest.approx(here.stiffness, rel=1e-6)
    # finer than the zones are wide: nowhere a step. δ/F dF/dδ is 1.0 to 1.6, with the shares a little more.
    approaches = np.geomspace(5e-3, 5e-3 * np.exp(3.0 * RUNG), 400)
    loads, pieces = [], ()
    for approach in approaches:
        load, _, pieces = press(kind, parabola(), float(approach), pieces)
        loads.append(load)
    growth = np.diff(np.log(loads)) / np.diff(np.log(approaches))
    assert growth.min() > 0.8
    assert growth.max() < 2.0


@pytest.mark.family(quick=1)
@pytest.mark.parametrize("profile", PROFILES)
def test_loads_do_not_depend_on_what_was_solved_before(profile):
    """Approaches and places in any order, each started from the last: as from nothing, to round-off."""
    rng = np.random.default_rng(1)
    kind, pieces = kind_of(profile), ()
    for approach, place, part in zip(
        rng.uniform(4e-3, 8e-3, 25), rng.integers(-2, 3, 25), rng.uniform(0.0, 1.0, 25), strict=True
    ):
        separation = parabola(int(place), float(part))
        warm = press(kind, separation, float(approach), pieces)
        cold = press(kind, separation, float(approach))
        # condition of the influence matrix, some 1e4, times the round-off of a number
        assert warm.load == pytest.approx(cold.load, rel=1e-10)
        assert warm.stiffness == pytest.approx(cold.stiffness, rel=1e-9)
        pieces = warm.pieces


def test_the_separation_between_two_places_is_interpolated():
    """p is linear in the separation: from one place to the next no step, and the slope that interpolation has."""
    kind = kind_of()
    loads = [press(kind, parabola(3, part), 6e-3).load for part in (0.0, 0.5, 1.0)]
    assert loads[2] == pytest.approx(press(kind, parabola(4), 6e-3).load, rel=1e-11)
    assert loads[1] == pytest.approx(0.5 * (loads[0] + loads[2]), rel=1e-9)
    # ρ smaller by 1e-4: F falls by some tenth of that (1/(2 ln) of it)
    assert -5e-5 < loads[2] / loads[0] - 1.0 < -2e-6


def test_the_relief_of_a_cell_is_its_mean_over_the_cell():
    """Relief that grows with y: a contact feels it in every cell where the cell lies, as a grid of its own does."""
    kind, found = kind_of("crowned"), press(kind_of("crowned"), parabola(), 8e-3)
    (piece,) = found.pieces
    shape = unit_grid(piece.grid, 12, symmetric=True)
    length = find_patch_length(LENGTH, piece.grid.reach_rung)
    grid = PatchGrid(x_edges=shape.x_edges * length, y_edges=shape.y_edges * length)
    separation = grid.cell_means(lambda x, y: x**2 / (2.0 * RADIUS) + kind.generator.relief(y))
    assert found.load == pytest.approx(solve_patch(grid, separation, kind.contact_modulus, 8e-3).load, rel=1e-10)
    # the crown tells, or nothing was shown
    assert found.load < 0.95 * press(kind_of(), parabola(), 8e-3).load


def test_pieces_are_read_only():
    (piece,) = press(kind_of(), parabola(), 8e-3).pieces
    for array in (piece.active, piece.rate, piece.opening_rate, piece.taken, piece.opening_taken, piece.load_taken):
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0


def test_patches_carry_the_load_of_the_contact():
    """Pressure summed over the patches, by their shares, is the load; a contact solved alone agrees within a rung."""
    kind, approaches, shared = sweep("cylinder")
    for approach in (float(approaches[shared > 1][0]), float(approaches[shared == 1][0])):
        load = press(kind, parabola(), approach).load
        patches = recover_patches(kind, parabola(), approach)
        assert sum(share for share, _ in patches) == pytest.approx(1.0, rel=1e-14)
        assert sum(share * patch.load for share, patch in patches) == pytest.approx(load, rel=1e-12)
        for share, patch in patches:
            total = 4.0 * float(np.sum(patch.pressure * patch.grid.areas))
            assert patch.load == pytest.approx(total, rel=1e-12)
            assert share > 0.0
        alone = solve_fitted(kind, approach, RADIUS, lambda x: x**2 / (2.0 * RADIUS))
        assert alone.load == pytest.approx(load, rel=1e-4)
