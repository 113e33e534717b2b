"""One contact on its own grid, solved again and again while the bodies move.

An influence matrix depends on the shape of its grid alone, not on its size: grids are kept per shape (cell width
by patch length, on a ladder of 5 %) with unit length, and one small set of matrices serves every contact of a drive.
A contact stays on its rung while its half-width fits within 8 %, so its load is a continuous function of the pose
where Newton's method ends. Where the edge of the contact falls within a cell moves the load of 12 cells per
half-width by less than 1e-4 (measured in ``tests/ltca/test_contact_grid.py``).

While the same cells touch, pressure is linear in the approach: p(δ) = p + (δ' − δ) A⁻¹1, known without another
factorisation. Only a change of the contact cells or of the separation costs one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache

import numpy as np
from numpy.typing import NDArray

from ltca.contact.generator import SummedProfile, generator_profile
from ltca.contact.pressure_cells import PatchGrid, PatchSolution, expected_half_width, graded_edges
from ltca.contact.unilateral import UnilateralSolution, solve_unilateral_contact
from ltca.drive.parts import Drive, contact_modulus

FloatArray = NDArray[np.float64]
Departure = Callable[[FloatArray], FloatArray]

CELLS = 12
RUNG = 0.05
"""Step of the ladder in ln(half-width)."""
FIT = 0.08
"""Largest misfit of ln(half-width) before a contact changes its rung."""

END_GRADING = 2.5
"""Grading of the cells along an unrelieved length (`ltca.contact.pressure_cells.graded_edges`): the singular end then
errs by 1e-4 in the load with 12 cells."""
END_STRETCH = 0.01
"""Part of the length over which the largest pressure is averaged, see `ltca.contact.end_pressure`."""

_ROOM = 1.6  # an unrelieved end bulges by up to 1.56 of the half-width at mid-width (ltca.contact.pressure_cells)
_FREE_GRADING = 1.25  # of contacts that end within a profile, where pressure falls to zero by itself
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(4)


@dataclass(frozen=True, slots=True, kw_only=True)
class ContactKind:
    """What all contacts of one kind share.

    Attributes
    ----------
    length : float
        Length of the contact line, mm.
    contact_modulus : float
        E*, MPa.
    generator : SummedProfile or None
        Crown and relief along the length; None for cylinders.
    symmetric : bool
        Whether the separation is even along the profile (circles) or not (flanks).
    cells : int
        Cells over the half-width and over half the length.
    pattern : dict
        Contact cells last found, by how far the patch ends before the body: where the next new contact starts.
        Grids are scaled with the half-width, so all contacts look much alike on them.
    """

    length: float
    contact_modulus: float
    generator: SummedProfile | None
    symmetric: bool
    cells: int = CELLS
    pattern: dict[int, NDArray[np.bool_]] = field(default_factory=dict, compare=False, repr=False)

    @property
    def end_cell(self) -> float:
        """Length that the largest pressure stands for, mm: at an unrelieved end it is singular."""
        return END_STRETCH * self.length


@dataclass(frozen=True, slots=True, kw_only=True)
class ContactKinds:
    """The kinds of half-space contacts of a drive: flank and pins, rollers on the inner race and in the bore, holes."""

    pins: ContactKind
    inner: ContactKind
    outer: ContactKind
    holes: ContactKind

    @classmethod
    def of_drive(cls, drive: Drive, cells: int = CELLS) -> ContactKinds:
        """Return the kinds of contact of a drive.

        Parameters
        ----------
        drive : Drive
            The drive.
        cells : int
            Cells over each half-width and over half of each length.
        """
        bearing, wheel, parts = drive.crank_bearing, drive.pin_wheel, drive.materials
        roller = generator_profile(bearing.roller_profile, bearing.roller_length, bearing.roller_radius)
        return cls(
            pins=ContactKind(
                length=drive.disc.thickness,
                contact_modulus=contact_modulus(parts.disc, parts.wheel_pin),
                generator=generator_profile(wheel.pin_profile, drive.disc.thickness, wheel.pin_radius),
                symmetric=False,
                cells=cells,
            ),
            inner=ContactKind(
                length=bearing.roller_length,
                contact_modulus=contact_modulus(parts.inner_race, parts.roller),
                generator=roller,
                symmetric=True,
                cells=cells,
            ),
            outer=ContactKind(
                length=bearing.roller_length,
                contact_modulus=contact_modulus(parts.disc, parts.roller),
                generator=roller,
                symmetric=True,
                cells=cells,
            ),
            holes=ContactKind(
                length=drive.disc.thickness,
                contact_modulus=contact_modulus(parts.disc, parts.shaft_pin),
                generator=None,
                symmetric=True,
                cells=cells,
            ),
        )


@cache
def unit_grid(rung: int, reach_rung: int, *, cells: int, symmetric: bool) -> PatchGrid:
    """Return the grid of unit length on a rung; its influence matrix is kept with it.

    Parameters
    ----------
    rung : int
        ln(half-width/length) in steps of `RUNG`.
    reach_rung : int
        How far a profiled contact ends before the body does, ln(body length/patch length) in steps of `RUNG`.
    cells : int
        Cells over the half-width and over half the length.
    symmetric : bool
        Positive half in x, or both.
    """
    half_width = float(np.exp(rung * RUNG))
    share = float(np.exp(-8.0 * reach_rung * RUNG))
    grading = _FREE_GRADING + share * (END_GRADING - _FREE_GRADING)
    count = int(np.ceil(_ROOM * cells))
    x = half_width / cells * np.arange(count + 1.0)
    return PatchGrid(
        x_edges=x if symmetric else np.concatenate([-x[:0:-1], x]),
        y_edges=graded_edges(1.0, cells, grading),
        symmetric_x=symmetric,
    )


class GridContact:
    """A contact that remembers its grid, its separation and its contact cells.

    Parameters
    ----------
    kind : ContactKind
        What it shares with others.
    """

    __slots__ = (
        "_approach",
        "_opening_rate",
        "_scaled_areas",
        "_solution",
        "_unit_separation",
        "active",
        "factorisations",
        "grid",
        "kind",
        "patch_length",
        "place",
        "radius",
        "reach_rung",
        "rung",
    )

    def __init__(self, kind: ContactKind) -> None:
        self.kind = kind
        self.rung, self.reach_rung = 0, -1
        self.grid: PatchGrid | None = None
        self.patch_length = kind.length
        self.place, self.radius = np.nan, np.nan
        self.active: NDArray[np.bool_] | None = None
        self.factorisations = 0
        self._unit_separation: FloatArray | None = None
        self._scaled_areas = np.zeros(0)
        self._solution: UnilateralSolution | None = None
        self._opening_rate = np.zeros(0)
        self._approach = np.nan

    def fit(self, approach: float, radius: float) -> None:
        """Choose the grid for an approach and an effective radius, mm; the present one stays while it fits."""
        kind = self.kind
        reach_rung = 0
        if kind.generator is not None:
            half = kind.generator.overlap_half_length(approach)
            reach_rung = max(0, int(np.floor(np.log(0.5 * kind.length / half) / RUNG)))
        if abs(reach_rung - self.reach_rung) == 1 and self.grid is not None and reach_rung > self.reach_rung:
            reach_rung = self.reach_rung  # a little too long a patch only has idle cells
        patch_length = kind.length * float(np.exp(-reach_rung * RUNG))
        ideal = expected_half_width(patch_length, radius, approach)
        if self._solution is not None and np.isfinite(self._approach) and self._approach > 0.0:
            known = self.solution(self._approach).half_width
            if known > 0.0:
                ideal = known * float(np.sqrt(approach / self._approach * radius / self.radius))
        place = float(np.log(ideal / patch_length)) / RUNG
        fits = abs(place - self.rung) * RUNG <= FIT and reach_rung == self.reach_rung
        if self.grid is None or not fits:
            self.rung, self.reach_rung, self.patch_length = round(place), reach_rung, patch_length
            self.grid = unit_grid(self.rung, reach_rung, cells=kind.cells, symmetric=kind.symmetric)
            self._scaled_areas = np.pi * self.grid.areas.ravel()
            self._unit_separation = self._solution = None
            self.active = kind.pattern.get(reach_rung)
            if self.active is None:  # the strip of the expected width
                strip = np.abs(self.grid.x_centres) < np.exp(self.rung * RUNG)
                self.active = np.repeat(strip, self.grid.shape[1])
        self.radius = radius

    def shape(self, place: float, departure: Departure) -> None:
        """Set the separation: where the contact is and how far both surfaces leave their tangent there.

        Parameters
        ----------
        place : float
            Any number that tells places with different separations apart; unchanged places change nothing.
        departure : callable
            Separation over the distance along the tangent, both in mm.
        """
        if self._unit_separation is not None and place == self.place:
            return
        grid = self._grid()
        length = self.patch_length
        widths = np.diff(grid.x_edges)
        points = grid.x_centres[:, None] + 0.5 * widths[:, None] * _POINTS
        along_x = departure(points * length) @ _WEIGHTS / (2.0 * length)
        separation = np.repeat(along_x[:, None], grid.shape[1], axis=1)
        if self.kind.generator is not None:
            points = grid.y_centres[:, None] + 0.5 * np.diff(grid.y_edges)[:, None] * _POINTS
            separation += self.kind.generator.relief(points * length) @ _WEIGHTS / (2.0 * length)
        self._unit_separation = separation.ravel()
        self.place, self._solution = place, None

    def press(self, approach: float) -> tuple[float, float]:
        """Return load and stiffness (contact cells held) at an approach in mm, N and N/mm."""
        grid = self._grid()
        pressure = self._pressure(approach)
        solution = self._solution
        assert solution is not None
        scale = self.kind.contact_modulus * self.patch_length * grid.images / np.pi
        load = scale * self.patch_length * float(pressure @ self._scaled_areas)
        return load, scale * float(solution.rate @ self._scaled_areas)

    def solution(self, approach: float) -> PatchSolution:
        """Return the pressure over the patch at an approach, in mm and MPa."""
        unit, length = self._grid(), self.patch_length
        pressure = self._pressure(approach) * self.kind.contact_modulus
        found = self._solution
        assert found is not None
        assert self._unit_separation is not None
        grid = PatchGrid(
            x_edges=unit.x_edges * length,
            y_edges=unit.y_edges * length,
            symmetric_x=unit.symmetric_x,
            symmetric_y=unit.symmetric_y,
        )
        load, stiffness = self.press(approach)
        penetration = (approach - self._unit_separation * length) * grid.areas.ravel()
        return PatchSolution(
            grid=grid,
            approach=approach,
            pressure=pressure.reshape(grid.shape),
            load=load,
            stiffness=stiffness,
            energy=0.5 * grid.images * float(pressure @ penetration),
            solution=found,
        )

    def _grid(self) -> PatchGrid:
        if self.grid is None:
            raise ValueError("fit() comes before the grid is used")
        return self.grid

    def _pressure(self, approach: float) -> FloatArray:
        """Dimensionless pressure p/E* of all cells."""
        if self._solution is not None:
            found = self._solution
            step = (approach - self._approach) / self.patch_length
            pressure = found.pressure + step * found.rate
            opening = found.opening + step * self._opening_rate
            slack = 1e-13 * float(np.max(self._scaled_areas)) * max(approach / self.patch_length, 1e-12)
            if np.all(pressure >= 0.0) and np.all(opening >= -slack):
                return pressure
            self.active = found.active
        grid = self._grid()
        if self._unit_separation is None:
            raise ValueError("shape() comes before the contact is pressed")
        found = solve_unilateral_contact(
            grid.influence,
            (approach / self.patch_length - self._unit_separation) * self._scaled_areas,
            start=self.active,
            load_direction=self._scaled_areas,
        )
        self.factorisations += len(found.history)
        self.active = self.kind.pattern[self.reach_rung] = found.active
        inside = np.nonzero(found.active)[0]
        self._opening_rate = grid.influence[:, inside] @ found.rate[inside] - self._scaled_areas
        self._opening_rate[inside] = 0.0
        self._solution, self._approach = found, approach
        return found.pressure
