"""Contacts on half-space grids at every approach of an equilibrium: load, stiffness, pressures.

Where the edge of the contact falls within a cell changes the load on 12 cells per half-width by less than 1e-4 (measured
in ``tests/validation/methods/test_pressed_grid.py``).

**A load depends on approach, radius and place alone**, never on earlier solutions. The grids of a contact follow
from the half-width expected at its approach (`ltca.contact.fitted_grid`); near the boundary of two rungs the load is a weighted
mean of both grids, continuous with its slope, so Newton's method converges. The separation of a flank is interpolated between
fixed places.

While the same cells touch, pressure is linear in the approach and in the distance between two such places,
p = δ A⁻¹1 − A⁻¹h, and needs no further factorisation. A `GridPiece` holds the coefficients. It is a value: a contact that
starts from pieces of its own or of a neighbour solves the same problem, only faster.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ltca.arrays import BoolArray, FloatArray, freeze
from ltca.contact.contact_kind import ContactKind, Separation
from ltca.contact.fitted_grid import (
    BLEND,
    GridRung,
    expected_cells,
    find_patch_length,
    find_reach_place,
    find_width_place,
    smooth_step,
    unit_grid,
    unit_separations,
)
from ltca.contact.pressure_cells import PatchPressure
from ltca.contact.unilateral import solve_unilateral_contact
from ltca.geometry.length_profile import Relief


def find_shares(
    length: float, generator: Relief | None, effective_radius: float, approach: float
) -> dict[GridRung, float]:
    """Return the grids of a contact and the share of each in its load, for ρ and δ in mm and a contact line of `length`, mm.

    Mostly there is one grid; two near a boundary of rungs, four at most. Shares and their slopes are continuous.
    """
    reach_place = find_reach_place(length, generator, approach)
    reach = int(np.floor(reach_place))
    # A patch a little too long only has idle cells, one too short would cut the contact off: the longer one is left
    # only when the shorter has enough room.
    over = smooth_step((reach_place - reach) / BLEND) if reach > 0 else 1.0
    found: dict[GridRung, float] = {}
    for number, part in ((reach, over), (reach - 1, 1.0 - over)):
        if part > 0.0:
            place = find_width_place(length, number, effective_radius, approach)
            below = int(np.floor(place))
            above = smooth_step((place - below - 0.5) / BLEND + 0.5)
            if above < 1.0:
                found[GridRung(below, number)] = part * (1.0 - above)
            if above > 0.0:
                found[GridRung(below + 1, number)] = part * above
    return found


def find_share_slopes(
    length: float, generator: Relief | None, effective_radius: float, approach: float
) -> dict[GridRung, float]:
    """Return the derivatives of the shares by the approach, 1/mm, for the arguments of `find_shares`.

    They multiply differences of 1e-4, so a difference quotient is accurate enough.
    """
    step = 1e-6 * approach
    before, after = (find_shares(length, generator, effective_radius, approach + sign * step) for sign in (-1.0, 1.0))
    return {rung: (after.get(rung, 0.0) - before.get(rung, 0.0)) / (2.0 * step) for rung in before | after}


@dataclass(frozen=True, slots=True, kw_only=True)
class GridPiece:
    """Coefficients of a contact on one grid with its contact cells held: linear in the approach and the separation.

    Attributes
    ----------
    grid : GridRung
        Shape of the grid.
    place : int
        Place of the separation, see `Separation`.
    active : array of bool, shape (cells,)
        Contact cells.
    rate, opening_rate : array, shape (cells,)
        Pressure by E*, and opening, per approach by patch length.
    taken, opening_taken : array, shape (cells, places)
        Both due to the separation at each place, to be subtracted.
    load_rate : float
        Sum of `rate` times the areas of the cells.
    load_taken : array, shape (places,)
        Sums of `taken` times the areas.
    """

    grid: GridRung
    place: int
    active: BoolArray
    rate: FloatArray
    opening_rate: FloatArray
    taken: FloatArray
    opening_taken: FloatArray
    load_rate: float
    load_taken: FloatArray

    def holds(self, closing: float, weights: FloatArray, slack: float) -> bool:
        """Return whether the same cells touch at an approach by patch length: no tension inside, no overlap outside."""
        taken, opening_taken = self.taken, self.opening_taken
        if weights.size == 1:  # at a place of the ladder, or the only one
            taken, opening_taken = taken[:, :1], opening_taken[:, :1]
        elif taken.shape[1] == 1:
            return False
        pressure = closing * self.rate - taken @ weights
        if np.min(pressure) < -1e-11 * np.max(pressure):
            return False
        return bool(np.min(closing * self.opening_rate - opening_taken @ weights) >= -slack)


Pieces = tuple[GridPiece, ...]


class Pressed(NamedTuple):
    """A pressed contact: load, N, its derivative by the approach at held place, N/mm, and the pieces behind it."""

    load: float
    stiffness: float
    pieces: Pieces


def press(kind: ContactKind, separation: Separation, approach: float, start: Sequence[GridPiece] = ()) -> Pressed:
    """Return load and stiffness of a contact at an approach δ, mm, positive (Eq. 55, 67–68, 84).

    `start` are the pieces of a neighbouring pose: they save time and do not change the result.
    """
    shares = find_shares(kind.length, kind.generator, separation.effective_radius, approach)
    slopes = (
        {}
        if len(shares) == 1
        else find_share_slopes(kind.length, kind.generator, separation.effective_radius, approach)
    )
    load = stiffness = 0.0
    pieces = []
    for rung, share in shares.items():
        piece = _settle(kind, rung, separation, approach, start)
        length = find_patch_length(kind.length, rung.reach_rung)
        scale = kind.contact_modulus * length * unit_grid(rung, kind.cells, kind.symmetric).images / np.pi
        taken = float(piece.load_taken[: separation.weights.size] @ separation.weights)
        own = scale * length * (approach / length * piece.load_rate - taken)
        load += share * own
        stiffness += share * scale * piece.load_rate + slopes.get(rung, 0.0) * own
        pieces.append(piece)
    return Pressed(load, stiffness, tuple(pieces))


def recover_patches(
    kind: ContactKind, separation: Separation, approach: float, start: Sequence[GridPiece] = ()
) -> list[tuple[float, PatchPressure]]:
    """Return the shares and the pressures of a contact on each of its grids; arguments as for `press`."""
    patches = []
    weights = separation.weights
    for rung, share in find_shares(kind.length, kind.generator, separation.effective_radius, approach).items():
        piece = _settle(kind, rung, separation, approach, start)
        closing = approach / find_patch_length(kind.length, rung.reach_rung)
        pressure = np.maximum(closing * piece.rate - piece.taken[:, : weights.size] @ weights, 0.0)
        grid = unit_grid(rung, kind.cells, kind.symmetric)
        scaled = grid.scaled(find_patch_length(kind.length, rung.reach_rung))
        patch = PatchPressure(grid=scaled, pressure=kind.contact_modulus * pressure.reshape(grid.shape))
        patches.append((share, patch))
    return patches


def _settle(
    kind: ContactKind, rung: GridRung, separation: Separation, approach: float, start: Sequence[GridPiece]
) -> GridPiece:
    """Return the piece of one grid that holds at an approach: one of `start` if it does, otherwise solved from it."""
    length = find_patch_length(kind.length, rung.reach_rung)
    weights, closing = separation.weights, approach / length
    grid = unit_grid(rung, kind.cells, kind.symmetric)
    areas = np.pi * grid.areas.ravel()
    active = None
    for piece in start:
        if piece.grid == rung:
            active = piece.active
            if piece.place == separation.place and piece.holds(
                closing, weights, 1e-13 * float(np.max(areas)) * closing
            ):
                return piece
    if active is None:
        # Grids are scaled with the half-width, so neighbours on the ladder have nearly the same contact cells.
        near = [piece for piece in start if abs(piece.grid.rung - rung.rung) <= 1]
        active = near[0].active if near else expected_cells(kind, rung, separation.effective_radius, approach).ravel()
    units = unit_separations(grid, separation, length, kind.aligned_relief)
    influence = grid.influence
    found = solve_unilateral_contact(
        influence,
        (closing - units @ weights) * areas,
        start=active,
        load_direction=np.column_stack([areas, units * areas[:, None]]),
    )
    inside = np.nonzero(found.active)[0]
    opening = influence[:, inside] @ found.rate[inside] - np.column_stack([areas, units * areas[:, None]])
    opening[inside] = 0.0
    load = areas @ found.rate
    piece = GridPiece(
        grid=rung,
        place=separation.place,
        active=found.active,
        rate=found.rate[:, 0],
        opening_rate=opening[:, 0],
        taken=found.rate[:, 1:],
        opening_taken=opening[:, 1:],
        load_rate=float(load[0]),
        load_taken=load[1:],
    )
    return freeze(piece)
