"""Contacts that tilt, solved on grids over their whole width: load and moment by approach and tilt, with derivatives.

The patch is where the undeformed surfaces overlap and moves steadily with the pose; only widths are on a ladder, blended as in
`ltca.contact.fitted_grid`. While the same cells touch, p = δ A⁻¹1 + θ A⁻¹z − A⁻¹h needs no further factorisation.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ltca.arrays import BoolArray, FloatArray, freeze
from ltca.contact.contact_kind import ContactKind, Separation
from ltca.contact.fitted_grid import BLEND, END_GRADING, FREE_GRADING, RUNG, smooth_step, unit_separations
from ltca.contact.pressure_cells import PatchGrid, PatchPressure, expected_half_width, graded_edges, mirrored
from ltca.contact.unilateral import solve_unilateral_contact

STEP = 2.0 * RUNG
"""Step of the widths of grids in ln(half-width/length of the patch): matrices without symmetry are four times as large."""
ROOM = 1.8
"""Width of the grid by the expected half-width: a tilted line bulges at its end by more than an aligned one."""
END_DEPTH = 0.1
"""Overlap at an end of the line, by the deepest, below which it is blended with an end that is not reached."""
KEPT = 24
"""Matrices kept, 7 MB each for flanks."""
SAMPLES = 201
"""Heights at which the ends of the overlap are looked for before they are refined."""


class GridShape(NamedTuple):
    """Shape of a grid: its width on the ladder and whether the line carries at its lower and at its upper end."""

    step: int
    lower_end: bool
    upper_end: bool


class Patch(NamedTuple):
    """Overlap of undeformed surfaces along the width, mm, its depth, mm, and the depth at the ends of the line by that."""

    lower: float
    upper: float
    depth: float
    at_ends: tuple[float, float]

    @property
    def length(self) -> float:
        """Length of the patch, mm."""
        return self.upper - self.lower

    @property
    def middle(self) -> float:
        """Its middle, mm."""
        return 0.5 * (self.lower + self.upper)

    def closing(self, approach: float, tilt: float, separation: Separation) -> FloatArray:
        """Return the approach in the middle by the length, the tilt, and the weights of a separation, negative."""
        middle = (approach + tilt * self.middle) / self.length
        return np.concatenate(((middle, tilt), -separation.weights))


@dataclass(frozen=True, slots=True, kw_only=True)
class TiltedPiece:
    """Coefficients of a contact on one grid and patch with its contact cells held: linear in approach, tilt and separation."""

    shape: GridShape
    place: int  # of the separation
    patch: Patch
    active: BoolArray
    rate: FloatArray  # pressure by E* per closing (`Patch.closing`), shape (cells, 2 + places)
    opening_rate: FloatArray  # opening by the same

    def pressure(self, closing: FloatArray) -> FloatArray:
        """Return pressures by E*, from approach and tilt as above and the weights of the places, negative."""
        return np.asarray(self.rate[:, : closing.size] @ closing)

    def holds(self, closing: FloatArray, slack: float) -> bool:
        """Return whether the same cells touch: no tension inside, no overlap outside."""
        if self.rate.shape[1] < closing.size:
            return False
        pressure = self.pressure(closing)
        if np.min(pressure) < -1e-11 * np.max(pressure):
            return False
        return bool(np.min(self.opening_rate[:, : closing.size] @ closing) >= -slack)


class TiltedPress(NamedTuple):
    """A pressed contact: load and moment with their derivatives, N, mm, rad, energy, N·mm, and the pressure on its main grid."""

    load: float
    moment: float
    by_approach: float
    by_tilt: float
    moment_by_tilt: float
    energy: float
    patch: PatchPressure
    pieces: tuple[TiltedPiece, ...]


@lru_cache(maxsize=KEPT)
def whole_grid(shape: GridShape, cells: int, symmetric: bool) -> PatchGrid:
    """Return the grid of unit length of a shape; its influence matrix is kept with it."""
    x = float(np.exp(shape.step * STEP)) / cells * np.arange(int(np.ceil(ROOM * cells)) + 1.0)
    lower, upper = (
        graded_edges(1.0, cells, END_GRADING if end else FREE_GRADING) for end in (shape.lower_end, shape.upper_end)
    )
    return PatchGrid(
        x_edges=x if symmetric else mirrored(x),
        y_edges=np.concatenate([-lower[:0:-1], upper]),
        symmetric_x=symmetric,
        symmetric_y=False,
    )


def find_patch(kind: ContactKind, approach: float, tilt: float) -> Patch | None:
    """Return where the undeformed surfaces overlap, None where they do nowhere; approach in mm, tilt in rad."""
    half = 0.5 * kind.length

    def free(z: FloatArray | float) -> FloatArray:
        # Logarithmic profiles have no end.
        return np.asarray(np.maximum(approach + tilt * np.asarray(z) - kind.relief(z), -1.0))

    heights = np.linspace(-half, half, SAMPLES)
    depth = free(heights)
    deepest = int(np.argmax(depth))
    if 0 < deepest < SAMPLES - 1:
        # The top between samples: by a parabola, as smooth reliefs have.
        before, most, after = depth[deepest - 1 : deepest + 2]
        bend = before - 2.0 * most + after
        top = most - 0.125 * (after - before) ** 2 / bend if bend < 0.0 else most
    else:
        top = depth[deepest]
    pressed = np.flatnonzero(depth > 0.0)
    if not pressed.size or not top > 0.0:
        return None
    from scipy.optimize import brentq  # 0.2 s to import; contacts that overlap all along need it not

    lower, upper = -half, half
    if pressed[0] > 0:
        lower = float(brentq(free, heights[pressed[0] - 1], heights[pressed[0]], xtol=1e-15 * half, rtol=1e-14))
    if pressed[-1] < SAMPLES - 1:
        upper = float(brentq(free, heights[pressed[-1]], heights[pressed[-1] + 1], xtol=1e-15 * half, rtol=1e-14))
    return Patch(lower, upper, float(top), (float(depth[0] / top), float(depth[-1] / top)))


def press_tilted(
    kind: ContactKind, separation: Separation, approach: float, tilt: float, start: Sequence[TiltedPiece] = ()
) -> TiltedPress | None:
    """Return a contact at an approach in its middle, mm, and a tilt, rad; `start`, pieces nearby, saves time. None where open."""
    patch = find_patch(kind, approach, tilt)
    if patch is None:
        return None
    found = []
    for shape, share in _find_shares(patch, separation.effective_radius).items():
        piece = _settle(kind, shape, patch, separation, approach, tilt, start)
        found.append((share, piece, *_press_piece(kind, piece, separation, approach, tilt)))
    values = np.sum([share * numbers for share, _, numbers, _ in found], axis=0)
    if len(found) > 1:
        # Shares differ in what multiplies 1e-4 of the load: differences do.
        size = 1e-6 * patch.depth
        for column, (by_approach, by_tilt) in enumerate(((size, 0.0), (0.0, size / kind.length))):
            before, after = (
                _find_shares(
                    find_patch(kind, approach + sign * by_approach, tilt + sign * by_tilt), separation.effective_radius
                )
                for sign in (-1.0, 1.0)
            )
            for _, piece, numbers, _ in found:
                difference = after.get(piece.shape, 0.0) - before.get(piece.shape, 0.0)
                slope = difference / (2.0 * (by_approach + by_tilt))
                values[2 + column] += slope * numbers[0]
                if column:
                    values[4] += slope * numbers[1]
    *_, pressed = max(found, key=lambda each: each[0])
    load, moment, stiffness, mixed, turning, energy = (float(value) for value in values)
    return TiltedPress(load, moment, stiffness, mixed, turning, energy, pressed, tuple(piece for _, piece, *_ in found))


def _find_shares(patch: Patch | None, effective_radius: float) -> dict[GridShape, float]:
    """Grids that are blended for a patch and their parts; none for a contact that is open."""
    if patch is None:
        return {}
    half_width = expected_half_width(patch.length, effective_radius, patch.depth)
    place = float(np.log(half_width / patch.length)) / STEP
    below = int(np.floor(place))
    above = smooth_step((place - below - 0.5) / BLEND + 0.5)
    lower, upper = (smooth_step(end / END_DEPTH) for end in patch.at_ends)
    found = {}
    for step, of_width in ((below, 1.0 - above), (below + 1, above)):
        for at_lower, of_lower in ((True, lower), (False, 1.0 - lower)):
            for at_upper, of_upper in ((True, upper), (False, 1.0 - upper)):
                share = of_width * of_lower * of_upper
                if share > 0.0:
                    found[GridShape(step, at_lower, at_upper)] = share
    return found


def _press_piece(
    kind: ContactKind, piece: TiltedPiece, separation: Separation, approach: float, tilt: float
) -> tuple[FloatArray, PatchPressure]:
    """Load, moment, ∂F/∂δ, ∂F/∂θ, ∂M/∂θ and energy on one grid; its pressures where the patch lies."""
    patch, grid = piece.patch, whole_grid(piece.shape, kind.cells, kind.symmetric)
    length, flat = patch.length, grid.areas.ravel()
    pressure = np.maximum(piece.pressure(patch.closing(approach, tilt, separation)), 0.0)
    scale = grid.images * kind.contact_modulus * length**2
    # About the middle of the width, mm.
    arm = np.tile(patch.middle + length * grid.y_centres, grid.shape[0])
    # The rates are by δ/length in the middle of the patch and by θ about it.
    by_approach = piece.rate[:, 0] / length
    by_tilt = piece.rate[:, 1] + piece.rate[:, 0] * (patch.middle / length)
    gap = (unit_separations(grid, separation, length, kind.relief, patch.middle) @ separation.weights) * length
    pairs = ((pressure, 1.0), (pressure, arm), (by_approach, 1.0), (by_tilt, 1.0), (by_tilt, arm),
             (0.5 * pressure, approach + tilt * arm - gap))  # fmt: skip
    numbers = np.array([scale * (values @ (flat * weight)) for values, weight in pairs])
    placed = replace(grid.scaled(length), y_edges=patch.middle + length * grid.y_edges)
    return numbers, PatchPressure(grid=placed, pressure=kind.contact_modulus * pressure.reshape(grid.shape))


def _settle(
    kind: ContactKind,
    shape: GridShape,
    patch: Patch,
    separation: Separation,
    approach: float,
    tilt: float,
    start: Sequence[TiltedPiece],
) -> TiltedPiece:
    """Return the piece of one grid that holds: one of `start` if it does, otherwise solved from it."""
    grid = whole_grid(shape, kind.cells, kind.symmetric)
    areas, closing, active = np.pi * grid.areas.ravel(), patch.closing(approach, tilt, separation), None
    for piece in start:
        if piece.shape == shape:
            active = piece.active
            slack = 1e-13 * float(np.max(areas)) * patch.depth / patch.length
            if piece.place == separation.place and piece.patch[:2] == patch[:2] and piece.holds(closing, slack):
                return piece
    units = unit_separations(grid, separation, patch.length, kind.relief, patch.middle)
    arm = np.tile(grid.y_centres, grid.shape[0])
    penetration = closing[0] + closing[1] * arm - units @ separation.weights
    if active is None:
        near = [piece for piece in start if abs(piece.shape.step - shape.step) <= 1]
        active = near[0].active if near else penetration > 0.5 * np.max(penetration)
    directions = np.column_stack((areas, areas * arm, units * areas[:, None]))
    found = solve_unilateral_contact(grid.influence, penetration * areas, start=active, load_direction=directions)
    inside = np.flatnonzero(found.active)
    opening = grid.influence[:, inside] @ found.rate[inside] - directions
    opening[inside] = 0.0
    piece = TiltedPiece(
        shape=shape, place=separation.place, patch=patch, active=found.active, rate=found.rate, opening_rate=opening
    )
    return freeze(piece)
