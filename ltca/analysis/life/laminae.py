r"""Load of a roller over slices of its length, its laminae, by its own profile.

**Where the contact is solved along its length** (half-space and hybrid engines: `SolvedLaminae`) the line load is that of
the very contact behind the load law: the half-space patch of `ltca.contact.pressure_cells` over the whole length, with
whatever the profile takes away, nothing of a straight one. Edge stress is in that solution, as the pressure that rises to
the ends of what is not relieved there, so no factor comes on top. Straight and profiled rollers go through the same grid
and the same sum, and the solution follows the profile continuously: a crown of a nanometre gives the straight roller.

**Where nothing is known along the length** (plane strain: `EvenLaminae`) every slice carries the same, and the stress
function of ISO 16281:2025 for the ends of plain rollers stands for the edges. Plane strain refuses profiles by name, so no
roller ever changes from one to the other.

**Where contacts have slices** (`contact.slices`) laminae carry what tilt and profile give them in the equilibrium
(`uneven_shares`), with the edges of the straight roller.

The pressure of a straight end is singular, more so in thinner slices: life then belongs to a number of slices. ISO
16281:2025 asks for at least 30; 31 are taken (of the paper's straight rollers 51 give 9 % less life, 101 a quarter less).
Profiles that carry no peak at their ends do not feel the number.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache, lru_cache
from pathlib import Path
from typing import Protocol

import numpy as np

from ltca.arrays import FloatArray
from ltca.compliance import sliced
from ltca.contact.pressure_cells import PatchGrid, PatchSolution, expected_half_width, solve_patch
from ltca.geometry.length_profile import Relief
from ltca.laws.line_contact import LineContactLaw

LAMINAE = 31
"""n_s, odd: one in the middle and pairs beside it."""
APPROACH_RATIO = 1.4
"""Ratio of neighbouring approaches at which a contact is solved; between them shares follow the logarithm of the load."""
LEAST_LOAD_RATIO = 0.05
"""Part of the largest load below which shares are held: what is left out is 0.05⁴ of the damage."""
STRAIGHT = Path(__file__).with_name("straight_rollers.json")
"""Contacts of straight rollers; each takes 0.04 s to solve, and a run has a dozen."""
RUNGS = range(-60, -3)
"""Approaches of 2e-9 to 0.3 L²/ρ, as powers of `APPROACH_RATIO`: from the weight of a roller to beyond every half-space."""
_CELLS, _GUESS_CELLS = 8, 5
_PER_LAMINA, _IN_LAST, _LAST_GRADING = 2, 8, 3.0


class Laminae(Protocol):
    """How the load of an aligned roller spreads over its laminae, from the middle outward."""

    @property
    def weights(self) -> FloatArray:
        """Part of the length that each slice, or pair of slices, takes; they add up to one, shape (slices,)."""
        ...

    def shares(self, load: FloatArray) -> FloatArray:
        """Return n_s q_k/Q of every load, shape (loads, slices): one everywhere where it is even.

        Parameters
        ----------
        load : array, shape (loads,)
            Q, N.
        """
        ...

    def slice_shares(self, load: FloatArray, slices: int) -> FloatArray:
        """Return the part of every load that each of some slices of the straight aligned roller carries, (loads, slices).

        Parameters
        ----------
        load : array, shape (loads,)
            Q, N.
        slices : int
            Of the contacts of the analysis.
        """
        ...


def pair_weights() -> FloatArray:
    """Return the parts of the length from the middle outward: one slice, then pairs of them."""
    return np.array([1.0] + [2.0] * (LAMINAE // 2)) / LAMINAE


def uneven_shares(slice_load: FloatArray, straight: FloatArray, aligned_slices: FloatArray) -> FloatArray:
    """Return n_s q_k/Q of tilted rollers over all laminae from one end to the other, shape (loads, laminae).

    Tilt and profile are in the loads of the slices that the contact was balanced with; the rest, its edges, is as of the straight
    aligned roller: what slices carry, by what those of the straight aligned roller do, is interpolated between their middles, and
    prolonged to the ends. A straight aligned roller has its own shares.

    Parameters
    ----------
    slice_load : array, shape (loads, slices)
        N.
    straight : array, shape (loads, laminae from the middle outward)
        Shares of the straight aligned roller under the same load (`SolvedLaminae`, or edge factors).
    aligned_slices : array, shape (loads, slices)
        Parts of its load that its slices carry.
    """
    aligned = np.concatenate((straight[:, :0:-1], straight), axis=1)
    slices, laminae = slice_load.shape[1], aligned.shape[1]
    ratio = slice_load / slice_load.sum(axis=1, keepdims=True) / aligned_slices
    at, middles = (np.arange(laminae) + 0.5) / laminae, (np.arange(slices) + 0.5) / slices
    piece = np.clip(np.searchsorted(middles, at) - 1, 0, slices - 2)
    part = (at - middles[piece]) * slices
    found = aligned * np.maximum((1.0 - part) * ratio[:, piece] + part * ratio[:, piece + 1], 0.0)
    return np.asarray(found * laminae / found.sum(axis=1, keepdims=True))


def edge_factors(laminae: int = LAMINAE) -> FloatArray:
    """Return the stress risers of the laminae of an unrelieved roller (ISO 16281:2025): 1 inside, more at the ends."""
    place = np.abs(2.0 * np.arange(1, laminae + 1) - laminae - 1.0) / (2.0 * laminae)
    factors = np.ones(laminae)
    inside = place > 0.0
    factors[inside] = 1.0 - 0.01 / np.log(1.985 * place[inside])
    return factors


@dataclass(frozen=True, slots=True, kw_only=True)
class EvenLaminae:
    """Even load over the length, with or without the stress function of plain ends.

    Attributes
    ----------
    edges : bool
        Whether the ends are plain and nothing else tells of their stress.
    """

    edges: bool = True

    @property
    def weights(self) -> FloatArray:
        """Part of the length of each slice or pair."""
        return pair_weights()

    def shares(self, load: FloatArray) -> FloatArray:
        """Return the edge factors for every load, or ones."""
        row = edge_factors()[LAMINAE // 2 :] if self.edges else np.ones(LAMINAE // 2 + 1)
        return np.broadcast_to(row, (load.size, row.size))

    def slice_shares(self, load: FloatArray, slices: int) -> FloatArray:
        """Return equal parts."""
        return np.full((load.size, slices), 1.0 / slices)


@dataclass(frozen=True, slots=True, kw_only=True)
class SolvedLaminae:
    """Load over the length as the contact of two half-spaces gives it.

    Attributes
    ----------
    profile : Relief or None
        Of the roller; None of a straight one.
    length, effective_radius : float
        L and ρ, mm.
    contact_modulus : float
        E*, MPa.
    """

    profile: Relief | None
    length: float
    effective_radius: float
    contact_modulus: float

    @property
    def weights(self) -> FloatArray:
        """Part of the length of each slice or pair."""
        return pair_weights()

    def shares(self, load: FloatArray) -> FloatArray:
        """Return n_s q_k/Q of every load, interpolated between solved contacts."""
        largest = float(np.max(load, initial=0.0))
        if largest <= 0.0:
            return np.ones((load.size, self.weights.size))
        loads, rows = self._solved(largest)
        at = np.log(np.clip(load, loads[0], loads[-1]))
        found = monotone_cubic(np.log(loads), rows, at)
        return np.asarray(found / (found @ self.weights)[:, None])

    def slice_shares(self, load: FloatArray, slices: int) -> FloatArray:
        """Return what the law of slices gives each of them, interpolated between loads."""
        law = sliced.SlicedLine.straight(self.length, self.contact_modulus, slices)
        rungs = self._height * APPROACH_RATIO ** np.array(RUNGS)
        # Those around the loads and two more at either end, for slopes: slices may be too narrow for heavier contacts.
        own = LineContactLaw(self.length, self.contact_modulus).load_and_stiffness(rungs, self.effective_radius)[0]
        first, last = np.searchsorted(own, (np.min(load), np.max(load)))
        rungs = rungs[max(first - 3, 0) : last + 3]
        found = law.respond(rungs, np.zeros(rungs.size), np.full(rungs.size, self.effective_radius))
        at = np.log(np.clip(load, found.load[0], found.load[-1]))
        return monotone_cubic(np.log(found.load), found.slice_load / found.load[:, None], at)

    def _solved(self, largest: float) -> tuple[FloatArray, FloatArray]:
        """Loads and shares of the contacts around [LEAST_LOAD_RATIO, 1] of the largest load, ascending."""
        # An approach of any power of the rung: every load of a drive is served by the same contacts.
        rough = largest / (self.contact_modulus * self.length)
        first = int(np.floor(np.log(rough / self._height) / np.log(APPROACH_RATIO)))
        found = {first: self._at(first)}
        while found[max(found)][0] < largest:
            found[max(found) + 1] = self._at(max(found) + 1)
        while found[min(found)][0] > LEAST_LOAD_RATIO * largest:
            found[min(found) - 1] = self._at(min(found) - 1)
        rungs = [found[number] for number in sorted(found)]
        return np.array([load for load, _ in rungs]), np.array([row for _, row in rungs])

    @property
    def _height(self) -> float:
        """What approaches are counted in, L²/ρ, mm."""
        return self.length**2 / self.effective_radius

    def _at(self, number: int) -> tuple[float, FloatArray]:
        """Load and shares at a rung."""
        approach, unit = APPROACH_RATIO**number, self.contact_modulus
        if self.profile is not None:
            load, row = solve_laminae(self.profile, self.length, self.effective_radius, self._height * approach)
        else:
            # Lengths counted in L and heights in L²/ρ, straight rollers of all sizes are one, whose contacts are shipped.
            load, row = straight_rollers().get(number) or solve_laminae(None, 1.0, 1.0, approach)
            unit *= self.length * self._height
        return unit * load, row


def monotone_cubic(place: FloatArray, values: FloatArray, at: FloatArray) -> FloatArray:
    """Interpolate by cubics that are monotone where the values are (Fritsch and Butland 1984), as scipy's ``PchipInterpolator``.

    That takes 0.3 s to import, for this sum alone.

    Parameters
    ----------
    place : array, shape (n,)
        Ascending, at least two.
    values : array, shape (n, columns)
        There.
    at : array, shape (m,)
        From the first place to the last.

    Returns
    -------
    array, shape (m, columns)

    Examples
    --------
    >>> monotone_cubic(np.arange(3.0), np.array([[0.0], [1.0], [1.0]]), np.array([0.5, 1.5])).ravel().tolist()
    [0.6875, 1.0]
    """
    width = np.diff(place)[:, None]
    secant = np.diff(values, axis=0) / width
    slope = np.empty_like(values)
    if place.size == 2:
        slope[:] = secant
    else:
        before, behind = secant[:-1], secant[1:]
        first, second = 2.0 * width[1:] + width[:-1], width[1:] + 2.0 * width[:-1]
        monotone = np.sign(before) * np.sign(behind) > 0.0
        mean = first / np.where(monotone, before, 1.0) + second / np.where(monotone, behind, 1.0)
        slope[1:-1] = np.where(monotone, (first + second) / np.where(monotone, mean, 1.0), 0.0)
        slope[0] = _end_slope(width[0], width[1], secant[0], secant[1])
        slope[-1] = _end_slope(width[-1], width[-2], secant[-1], secant[-2])
    rung = np.clip(np.searchsorted(place, at, side="right") - 1, 0, place.size - 2)
    along, span = (at - place[rung])[:, None], width[rung]
    curvature = (slope[rung] + slope[rung + 1] - 2.0 * secant[rung]) / span
    bend = (secant[rung] - slope[rung]) / span - curvature
    return np.asarray(values[rung] + along * (slope[rung] + along * (bend + along * curvature / span)))


def _end_slope(near: FloatArray, far: FloatArray, first: FloatArray, second: FloatArray) -> FloatArray:
    """Slope at an end by three points, kept monotone."""
    found = ((2.0 * near + far) * first - near * second) / (near + far)
    found = np.where(np.sign(found) == np.sign(first), found, 0.0)
    steep = (np.sign(first) != np.sign(second)) & (np.abs(found) > 3.0 * np.abs(first))
    return np.asarray(np.where(steep, 3.0 * first, found))


@cache
def straight_rollers() -> dict[int, tuple[float, FloatArray]]:
    """Return load by E* and shares of straight rollers at the rungs of `STRAIGHT`, L and ρ being 1."""
    content = json.loads(STRAIGHT.read_text(encoding="utf-8"))
    return {int(number): (load, np.array(row)) for number, (load, row) in content.items()}


def write_straight_rollers() -> None:
    """Write the contacts of straight rollers into the package anew; tests/ltca/analysis/life/test_laminae.py compares."""
    solved = {number: solve_laminae(None, 1.0, 1.0, APPROACH_RATIO**number) for number in RUNGS}
    content = {str(number): (load, row.tolist()) for number, (load, row) in solved.items()}
    STRAIGHT.write_text(json.dumps(content, indent=0) + "\n", encoding="utf-8", newline="\n")


@lru_cache(maxsize=512)
def solve_laminae(
    profile: Relief | None, length: float, effective_radius: float, approach: float
) -> tuple[float, FloatArray]:
    """Solve one contact and return its load by E*, mm², and n_s q_k/Q from the middle slice outward.

    Parameters
    ----------
    profile : Relief or None
        Relief along the length.
    length, effective_radius : float
        mm.
    approach : float
        At mid-length, mm.

    Notes
    -----
    The grid along the length is laid by the slices alone, whatever the profile, and graded in the last one. Twice the cells
    in both directions move the 4.5-power mean of a straight roller by 2e-4 of itself (31 slices).
    """
    half = LAMINAE // 2
    inside = np.arange(1, _PER_LAMINA + 1) / _PER_LAMINA
    toward_end = 1.0 - (1.0 - np.arange(1, _IN_LAST + 1) / _IN_LAST) ** _LAST_GRADING
    steps = [0.5 * inside, *(number - 0.5 + inside for number in range(1, half)), half - 0.5 + toward_end]
    y = np.concatenate([[0.0], *steps]) * length / LAMINAE
    y[-1] = 0.5 * length

    def solve(half_width: float, cells: int) -> PatchSolution:
        count = int(np.ceil(1.6 * cells))
        grid = PatchGrid(x_edges=half_width / cells * np.arange(count + 1.0), y_edges=y)
        separation = grid.cell_means(
            lambda x, along: x**2 / (2.0 * effective_radius) + (0.0 if profile is None else _relief(profile, along))
        )
        return solve_patch(grid, separation, 1.0, approach)

    guess = solve(expected_half_width(length, effective_radius, approach), _GUESS_CELLS).half_width
    found = solve(guess, _CELLS)
    along = found.grid.images * (found.pressure * found.grid.areas).sum(axis=0)
    slices = np.add.reduceat(along, [0, *(_PER_LAMINA * np.arange(1, half + 1))])
    row = slices / found.load / pair_weights()
    row.setflags(write=False)
    return found.load, row


def _relief(profile: Relief, along: FloatArray) -> FloatArray:
    """Relief at Gauss points; they lie inside the ends, where a logarithmic one is finite."""
    return profile.relief(along)
