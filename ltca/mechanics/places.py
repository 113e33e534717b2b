"""Places of the contacts of discs at poses, and the inner unknowns of the one system of all contacts."""

from __future__ import annotations

from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import ComplexArray, FloatArray
from ltca.geometry.coordinates import WHEEL_ANGLE, Coordinates, X, Y
from ltca.geometry.pair_motion import KnownPins, PairTilt, Turns, dot
from ltca.geometry.pairs import ContactGeometry

Indices = NDArray[np.intp]


class DiscPlaces:
    """Places of the contacts of one disc at poses."""

    def __init__(
        self,
        geometry: ContactGeometry,
        angle: FloatArray,
        pose: FloatArray,
        parameter: FloatArray | None,
        known: KnownPins | None,
        shifts: ComplexArray | None,
        leans: ComplexArray | None,
    ) -> None:
        self.geometry, self.angle, self.pose, self.shifts, self.leans = geometry, angle, pose, shifts, leans
        pins = geometry.placement.wheel_pin_radii.shape[-1]
        on_pins, on_holes = (None, None) if shifts is None else (shifts[:, :pins], shifts[:, pins:])
        at = geometry.disc_place(angle, pose)
        self.races = at.races
        self.flank = geometry.flank(angle, pose, parameter, on_pins, known, at)
        self.holes = geometry.holes(angle, pose, on_holes, at)
        self.bores, self.rays = geometry.bores(angle, pose, at), geometry.rollers(angle)
        self.rollers = self.rays.direction.shape[1]
        self.displacement = self.bores.each(self.bores.displacement, self.rollers)
        # Along and across the rays.
        self.displaced = self.rays.direction.conjugate() * self.displacement
        self.total = self.rays.outermost - self.rays.touching(self.displaced)
        self.half = np.asarray(geometry.half_width, dtype=float)
        self.tilts: list[tuple[PairTilt, PairTilt]] = []
        self.turns: list[tuple[Turns, Turns]] = []
        # By half the thickness, mm, (positions, leans, pairs or 1): pins on the flank and in holes, journals, bores.
        self.pin_tilts = self.hole_tilts = self.at_race = self.at_bore = np.zeros((angle.size, 0, 1))
        if geometry.coordinates_of(pose).leans:
            self._lean(
                geometry.coordinates_of(pose), *((None, None) if leans is None else (leans[:, :pins], leans[:, pins:]))
            )

    def _lean(self, own: Coordinates, on_pins: ComplexArray | None, in_holes: ComplexArray | None) -> None:
        """Tilts of the contacts, with the leans of displaced pins."""
        geometry, direction = self.geometry, self.rays.direction
        flank, holes = geometry.flank_lean(self.angle, self.pose, on_pins), geometry.hole_lean(self.pose, in_holes)
        self.turns = [(flank[1], holes[1])]
        self.tilts = [(self.flank.leaning(*flank, own), self.holes.leaning(*holes, own))]
        journals = self.bores.each(geometry.journal_leans(self.pose), self.rollers)
        tilts = (
            *(pair.tilt for pair in self.tilts[0]),
            dot(direction, journals),
            dot(direction, geometry.lean(self.pose)),
        )
        self.pin_tilts, self.hole_tilts, self.at_race, self.at_bore = ((self.half * each)[:, None] for each in tilts)

    @cached_property
    def gradients(self) -> list[tuple[FloatArray, FloatArray]]:
        """Derivatives by the pose of wheel pins and shaft pins: of approaches, then of tilts by half the thickness."""
        approach = self.flank.gradient, self.holes.gradient
        half = self.half[..., None]
        return [approach, *((half * pins.gradient, half * holes.gradient) for pins, holes in self.tilts)]

    @property
    def room(self) -> FloatArray:
        """Overlap or play of rollers where bore and race do not tilt against each other, mm."""
        return np.abs(self.total)

    @cached_property
    def nominal(self) -> FloatArray:
        """Nominal motion of disc and wheel by the crank angle, mm and rad, shape (positions, coordinates, 1)."""
        found, velocity = np.zeros((*self.pose.shape, 1)), self.races.velocity
        found[:, X, 0], found[:, Y, 0] = velocity.real, velocity.imag
        found[:, WHEEL_ANGLE, 0] = 1.0 / self.geometry.placement.reduction_ratio
        return found

    @cached_property
    def seen_from_cages(self) -> FloatArray:
        """Motion of the bores against the cages by the crank angle, x and y, mm/rad, shape (positions, cranks, 2)."""
        place, bores = self.geometry.placement, self.bores
        seen = self.races.velocity[:, None] - 1j * (bores.lever + place.cage_speed * bores.displacement)
        return np.asarray(seen.view(float).reshape(*seen.shape, 2))

    def place_rollers(self, inward: FloatArray) -> None:
        """Put the rollers inward of where they only touch the race, mm (Eq. 52, 57, 69)."""
        rays = self.rays
        place = rays.outermost - inward
        arm = place - self.displaced
        self.length = np.abs(arm)
        turn = arm / self.length
        self.outward, self.cosine, self.slant = turn * rays.direction, turn.real, -turn.imag
        # |s n − d| less the bore play as a product: no cancellation for rollers that barely touch.
        beyond = place + (rays.outermost - self.total) - 2.0 * self.displaced.real
        self.inward, self.outer = inward, (self.total - inward) * beyond / (self.length + rays.bore_play)


def reach_of(deformations: FloatArray) -> FloatArray:
    """Return how far contacts reach where they are pressed most, mm; components are approaches and, in slices, tilts."""
    if deformations.shape[1] == 1:
        return deformations[:, 0]
    return np.asarray(deformations[:, 0] + np.abs(deformations[:, 1:]).sum(axis=1))


class State(NamedTuple):
    """Inner unknowns at poses: contact parameters, rollers, deformations, displacements of pins, starts of laws."""

    parameter: FloatArray | None
    place: FloatArray
    share: FloatArray
    lean: FloatArray  # shape (positions, leans of a roller, rollers)
    approach: FloatArray | None
    shifts: ComplexArray | None
    near: tuple[FloatArray, ...]


def mixed(first: State, second: State, rows: NDArray[np.bool_]) -> State:
    """Inner unknowns of the first, those of the second at some positions."""

    def of_both(mine: Any, other: Any) -> Any:
        if mine is None or other is None:
            return mine
        if isinstance(mine, tuple):
            return tuple(of_both(*each) for each in zip(mine, other, strict=True))
        return by_rows(rows, other, mine)

    return State(*(of_both(*each) for each in zip(first, second, strict=True)))


def by_rows(rows: NDArray[np.bool_], first: NDArray[Any] | None, second: NDArray[Any] | None) -> Any:
    """Values of the first of some positions, of the second elsewhere."""
    if first is None or second is None:
        return None
    return np.where(rows.reshape(-1, *(1,) * (first.ndim - 1)), first, second)


def beside(values: list[Any]) -> Any:
    """Arrays of discs side by side: itself where there is one."""
    return values[0] if len(values) == 1 else np.concatenate(values, axis=1)


def with_crank(pose: FloatArray, angle: FloatArray) -> FloatArray:
    """Return poses with the crank angle as one more coordinate behind them."""
    return np.concatenate((pose, angle[:, None]), axis=1)


def places_of(chosen: list[list[Indices]]) -> tuple[list[list[slice]], list[slice], list[list[slice]]]:
    """Return places of the contacts of each disc and kind among all chosen, of its rollers, and within the disc."""
    ends = np.cumsum([0, *(some.shape[1] for own in chosen for some in own)])
    at = [[slice(ends[4 * disc + kind], ends[4 * disc + kind + 1]) for kind in range(4)] for disc in range(len(chosen))]
    ends = np.cumsum([0, *(own[1].shape[1] for own in chosen)])
    local = [[slice(kind.start - own[0].start, kind.stop - own[0].start) for kind in own] for own in at]
    return at, [slice(first, last) for first, last in pairwise(ends)], local


def padded(mask: NDArray[np.bool_]) -> Indices:
    """Numbers of the chosen entries of each row, ascending, padded to the fullest row with others."""
    count = int(np.max(np.count_nonzero(mask, axis=1), initial=0))
    if count == mask.shape[1]:
        return np.broadcast_to(np.arange(count), mask.shape)
    return np.sort(np.argsort(~mask, axis=1, kind="stable")[:, :count], axis=1)
