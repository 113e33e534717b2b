"""Contacts of a disc that do not feel each other: the load of every pair follows from its approach alone (C = 0).

Half-spaces on tables are this (`ltca.compliance.half_space`).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar, Generic

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import ComplexArray, FloatArray
from ltca.compliance import sliced
from ltca.compliance.pressures import elastic_hole_pressures, pressures_in_slices
from ltca.compliance.response import (
    ContactPressures,
    DiscResponse,
    KindPressures,
    PairSlopes,
    Start,
    add_bearing_bend,
    resultant,
    split_shifts,
)
from ltca.compliance.rollers import AnyLaw, Law, RollerLaws, RollerState, balance_rollers
from ltca.contact.tracked_grid import ContactKind, ContactKinds
from ltca.geometry.pair_motion import BoreMotion, FlankMotion, PairMotion
from ltca.geometry.pairs import ContactGeometry
from ltca.laws.contact_law import ContactLaw


@dataclass(frozen=True, slots=True, kw_only=True)
class PairLaws(Generic[AnyLaw]):
    """Laws of the contacts of wheel pins and of rollers at some poses."""

    pins: AnyLaw
    rollers: RollerLaws[AnyLaw]


@dataclass(frozen=True, slots=True, kw_only=True)
class UncoupledContacts(ABC, Generic[Law]):
    """Contacts of one disc, each with a law.

    Attributes
    ----------
    geometry : ContactGeometry
        The contact geometry of the drive.
    hole_law : ContactLaw
        Law of shaft pins and holes: springs of stiffness k_PS in series with the sleeves' seats.
    kinds : ContactKinds
        The contacts as grids see them.
    rigid_shaft_pins : bool
        Whether shaft pins are rigid where they touch their holes; springs stand for all that yields there otherwise.
    """

    coefficients: ClassVar[None] = None

    geometry: ContactGeometry
    hole_law: ContactLaw
    kinds: ContactKinds
    rigid_shaft_pins: bool = False

    @abstractmethod
    def laws(self, flank: FlankMotion, warm_start: NDArray[np.object_] | None) -> PairLaws[Law]:
        """Return the laws of the contacts with the pins where they are."""

    @abstractmethod
    def read_pressures(
        self, law: Law, kind: ContactKind, approach: FloatArray, effective_radius: FloatArray
    ) -> KindPressures:
        """Return pressures and half-widths of contacts of one kind at their approaches, shape (positions, pairs)."""

    def warm_start(self, laws: PairLaws[Law], positions: int) -> NDArray[np.object_]:
        """Return what the laws want to find again at the next pose of each position: nothing."""
        return np.full(positions, None, dtype=object)

    def respond(
        self,
        crank_angle: FloatArray,
        pose: FloatArray,
        start: Start | None = None,
        shifts: ComplexArray | None = None,
        leans: ComplexArray | None = None,
        again: DiscResponse | None = None,
        *,
        roughly: bool = False,
    ) -> DiscResponse:
        """Return the contact forces at the poses of a batch of positions.

        Parameters
        ----------
        crank_angle : array, shape (positions,)
            φ_C, rad.
        pose : array, shape (positions, coordinates)
            q of `ltca.geometry.coordinates`.
        start : Start, optional
            Inner unknowns of a neighbouring pose.
        shifts : array of complex, shape (positions, z_P + z_PS), optional
            Displacements of the pins, mm: of wheel pins in the turning wheel, of shaft pins in the fixed frame. Slopes come
            with them.
        leans : array of complex, shape (positions, z_P + z_PS), optional
            Leans of the pins at the disc in the same frames, rad, of contacts in slices.
        again : DiscResponse, optional
            What was answered at the same poses with pins displaced otherwise, in slices: their rollers stand where they stood.
        roughly : bool
            Whether contacts in slices that have nearly settled will do: `DiscResponse.left` tells what is left.

        Returns
        -------
        DiscResponse
            Generalised force, tangent and every pair's load.

        Notes
        -----
        A load depends on its place through ρ(θ) as well. That derivative is left out of the tangent, and the
        force it would add to the gradient of the energy (about 1e-5 of the load, along the flank) is no contact
        force without friction: the force acts along the common normal.
        """
        geometry, moved = self.geometry, split_shifts(shifts, self.geometry)
        places, known, share, warm = (
            (None, None, None, None) if start is None else (start.parameter, start.known, start.share, start.warm_start)
        )
        leaning = geometry.coordinates_of(pose).leans
        # A pin that is open in the middle may touch at its end: none is left out.
        flank = geometry.flank(crank_angle, pose, places, moved[0], None if leaning else known)
        laws = self.laws(flank, warm)
        if leaning:
            return self._respond_in_slices(
                crank_angle, pose, flank, laws, shifts, leans, warm, again, sliced.ROUGH if roughly else sliced.EXACT
            )
        pin_load, pin_stiffness = laws.pins.load_and_stiffness(flank.approach, flank.effective_radius)
        holes = geometry.holes(crank_angle, pose, moved[1])
        hole_load, hole_stiffness = self.hole_law.load_and_stiffness(
            holes.approach, geometry.placement.hole_effective_radii
        )
        bores, rays = geometry.bores(crank_angle, pose), geometry.rollers(crank_angle)
        displacement = bores.each(bores.displacement, rays.direction.shape[1])
        rollers = balance_rollers(rays, displacement, laws.rollers, share)
        tangent = _pair_tangent(flank, pin_load, pin_stiffness) + _pair_tangent(holes, hole_load, hole_stiffness)
        tangent += _roller_tangent(rollers, bores)
        return DiscResponse(
            force=resultant(flank, pin_load, holes, hole_load, rollers, bores),
            tangent=tangent,
            flank=flank,
            holes=holes,
            rollers=rollers,
            pin_load=pin_load,
            hole_load=hole_load,
            warm_start=self.warm_start(laws, crank_angle.size),
            shifts=shifts,
            slopes=None if shifts is None else _slopes(flank, pin_stiffness, holes, hole_stiffness),
        )

    def _respond_in_slices(
        self,
        crank_angle: FloatArray,
        pose: FloatArray,
        flank: FlankMotion,
        laws: PairLaws[Any],
        shifts: ComplexArray | None,
        leans: ComplexArray | None,
        warm: NDArray[np.object_] | None,
        again: DiscResponse | None,
        exactness: sliced.Exactness,
    ) -> DiscResponse:
        """The same of contacts in slices, which tilt."""
        here = sliced.ContactsInSlices(self.geometry, crank_angle, pose, flank, shifts, leans, exactness)
        near = sliced.stacked(warm)
        starts = (None, None) if near is None else (near[0], near[1])
        if again is not None and again.leaning_pins is not None and again.leaning_holes is not None:
            starts = again.leaning_pins.contact.near, again.leaning_holes.contact.near
        holes: Any = self.hole_law
        pairs = here.pair(0, laws.pins, starts[0]), here.pair(1, holes, starts[1])
        begin = None if near is None else sliced.roller_start(near)
        rollers = here.rollers(laws.rollers, begin) if again is None else again.rollers
        return here.response(pairs, rollers, sliced.warm_rows(pairs, rollers))

    def pressures(self, response: DiscResponse) -> ContactPressures:
        """Return pressures and half-widths from the laws, those of the shaft pins from their loads."""
        if response.leaning_pins is not None:
            spring = isinstance(getattr(self.hole_law, "contact", self.hole_law), sliced.SlicedSpring)
            return pressures_in_slices(
                response,
                self.kinds,
                self.geometry.placement,
                rigid_shaft_pins=self.rigid_shaft_pins,
                shaft_pins_on_springs=spring,
            )
        flank, rollers, kinds = response.flank, response.rollers, self.kinds
        laws = self.laws(flank, response.warm_start)
        of_rollers = laws.rollers
        return ContactPressures(
            pins=self.read_pressures(laws.pins, kinds.pins, flank.approach, flank.effective_radius),
            outer=self.read_pressures(of_rollers.outer, kinds.outer, rollers.outer_approach, of_rollers.outer_radius),
            inner=self.read_pressures(of_rollers.inner, kinds.inner, rollers.inner_approach, of_rollers.inner_radius),
            holes=elastic_hole_pressures(kinds.holes, response.hole_load, self.geometry.placement),
            rigid_shaft_pins=self.rigid_shaft_pins,
        )


def _slopes(flank: FlankMotion, pin: FloatArray, holes: PairMotion, hole: FloatArray) -> PairSlopes:
    by_approach = np.concatenate((pin, hole), axis=1)
    gradient = np.concatenate((flank.gradient, holes.gradient), axis=1)
    return PairSlopes(by_approach=by_approach, by_pose=by_approach[..., None] * gradient)


def _roller_tangent(rollers: RollerState, bores: BoreMotion) -> FloatArray:
    positions, cranks = bores.arm.shape
    stiffness = np.einsum("bcri->bci", rollers.tangent.reshape(positions, cranks, -1, 4)).reshape(-1, cranks, 2, 2)
    moved = np.stack((bores.gradient.real, bores.gradient.imag), axis=2)
    tangent = np.matmul(moved.swapaxes(2, 3), np.matmul(stiffness, moved)).sum(axis=1)
    add_bearing_bend(tangent, rollers, bores)
    return np.asarray(tangent)


def _pair_tangent(motion: PairMotion, load: FloatArray, stiffness: FloatArray) -> FloatArray:
    scaled = stiffness[..., None] * motion.gradient
    return np.asarray(np.matmul(motion.gradient.swapaxes(1, 2), scaled) + motion.bend(load))
