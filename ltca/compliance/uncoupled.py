"""Contacts of a disc that do not feel each other: the load of every pair follows from its approach alone (C = 0).

Both half-space models are this with laws of their own: tables (`ltca.compliance.half_space`) and contact grids
(`ltca.compliance.grids`).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar, Generic

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import ComplexArray, FloatArray
from ltca.compliance.leaning_rollers import RollerStart, balance_leaning_rollers
from ltca.compliance.pressures import elastic_hole_pressures, pressures_of_slices
from ltca.compliance.response import (
    ContactPressures,
    DiscResponse,
    KindPressures,
    LeaningPairs,
    PairSlopes,
    Start,
    add_bearing_bend,
    resultant,
    split_shifts,
)
from ltca.compliance.rollers import Law, RollerLaws, RollerState, balance_rollers
from ltca.contact.tracked_grid import ContactKind, ContactKinds
from ltca.contact.width_pressure import estimate_along_width, estimate_of_slices
from ltca.geometry.coordinates import Coordinates
from ltca.geometry.pair_motion import BoreMotion, FlankMotion, PairMotion, dot
from ltca.geometry.pairs import ContactGeometry
from ltca.laws.contact_law import ContactLaw
from ltca.laws.sliced_line import SlicedContact


@dataclass(frozen=True, slots=True, kw_only=True)
class PairLaws(Generic[Law]):
    """Laws of the contacts of wheel pins and of rollers at some poses."""

    pins: Law
    rollers: RollerLaws[Law]


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
    """

    coefficients: ClassVar[None] = None

    geometry: ContactGeometry
    hole_law: ContactLaw
    kinds: ContactKinds

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
        self, crank_angle: FloatArray, pose: FloatArray, start: Start | None = None, shifts: ComplexArray | None = None
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
        flank = geometry.flank(crank_angle, pose, places, moved[0], known)
        laws = self.laws(flank, warm)
        if geometry.coordinates_of(pose).leans:
            return self._respond_in_slices(crank_angle, pose, flank, laws, shifts, warm)
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
        warm: NDArray[np.object_] | None,
    ) -> DiscResponse:
        """The same of contacts in slices, which tilt."""
        near = None
        if warm is not None and all(each is not None for each in warm):
            near = [np.stack(parts) for parts in zip(*warm, strict=True)]
        geometry, place = self.geometry, self.geometry.placement
        coordinates = geometry.coordinates_of(pose)
        holes = geometry.holes(crank_angle, pose, split_shifts(shifts, geometry)[1])
        bores, rays = geometry.bores(crank_angle, pose), geometry.rollers(crank_angle)
        pairs = []
        for motion, tilt, law, radius in (
            (flank, geometry.flank_tilt(crank_angle, pose, flank), laws.pins, flank.effective_radius),
            (holes, geometry.hole_tilt(pose, holes), self.hole_law, place.hole_effective_radii),
        ):
            begin = () if near is None or motion is holes else (near[0],)
            contact = law.respond(motion.approach, tilt.tilt, radius, *begin)
            pairs.append((motion, LeaningPairs(tilt=tilt, contact=contact)))
        displacement = bores.each(bores.displacement, rays.direction.shape[1])
        along = [dot(rays.direction, lean) for lean in (np.asarray(place.crank_lean), geometry.lean(pose))]
        begin = None if near is None else RollerStart(inward=near[1], lean=near[2], inner=near[3], outer=near[4])
        rollers = balance_leaning_rollers(rays, displacement, laws.rollers, *along, begin)
        tangent = _leaning_roller_tangent(rollers, bores, coordinates)
        pins, of_holes = (pair.contact.load for _, pair in pairs)
        force = resultant(flank, pins, holes, of_holes, rollers, bores)
        if rollers.outer_moment is not None:
            pressed = (rollers.outer_moment * rays.direction).sum(axis=1)
            force[:, coordinates.lean_place] -= np.stack((pressed.real, pressed.imag), axis=-1)
        for motion, pair in pairs:
            found, leaning = pair.contact, pair.tilt
            force += np.einsum("bi,bij->bj", found.moment, leaning.gradient)
            tangent += _pair_tangent(motion, found.load, found.by_approach)
            mixed = np.matmul(motion.gradient.swapaxes(1, 2), found.by_tilt[..., None] * leaning.gradient)
            tangent += mixed + mixed.swapaxes(1, 2)
            turning = found.moment_by_tilt[..., None] * leaning.gradient
            tangent += np.matmul(leaning.gradient.swapaxes(1, 2), turning)
            tangent += motion.bend_leans(found.moment, coordinates)
        return DiscResponse(
            force=force,
            tangent=tangent,
            flank=flank,
            holes=holes,
            rollers=rollers,
            pin_load=pins,
            hole_load=of_holes,
            warm_start=_rows_of(pairs[0][1].contact.slice_load, rollers),
            shifts=shifts,
            leaning_pins=pairs[0][1],
            leaning_holes=pairs[1][1],
        )

    def pressures(self, response: DiscResponse) -> ContactPressures:
        """Return pressures and half-widths from the laws, those of the shaft pins from their loads."""
        if response.leaning_pins is not None and response.leaning_holes is not None:
            return self._pressures_of_slices(response, response.leaning_pins.contact, response.leaning_holes.contact)
        flank, rollers, kinds = response.flank, response.rollers, self.kinds
        laws = self.laws(flank, response.warm_start)
        of_rollers = laws.rollers
        return ContactPressures(
            pins=self.read_pressures(laws.pins, kinds.pins, flank.approach, flank.effective_radius),
            outer=self.read_pressures(of_rollers.outer, kinds.outer, rollers.outer_approach, of_rollers.outer_radius),
            inner=self.read_pressures(of_rollers.inner, kinds.inner, rollers.inner_approach, of_rollers.inner_radius),
            holes=elastic_hole_pressures(kinds.holes, response.hole_load, self.geometry.placement),
            rigid_shaft_pins=False,
        )

    def _pressures_of_slices(
        self, response: DiscResponse, pins: SlicedContact, holes: SlicedContact
    ) -> ContactPressures:
        """The same of contacts in slices, from their line loads."""
        rollers, kinds, place = response.rollers, self.kinds, self.geometry.placement
        radius, hole = response.flank.effective_radius, place.hole_effective_radii

        def of_rollers(kind: ContactKind, slices: FloatArray | None, radii: FloatArray) -> KindPressures:
            return pressures_of_slices(kind, estimate_of_slices(kind, np.asarray(slices), radii), radii)

        return ContactPressures(
            pins=pressures_of_slices(kinds.pins, estimate_along_width(kinds.pins, pins, radius), radius),
            outer=of_rollers(kinds.outer, rollers.outer_slices, place.outer_effective_radii),
            inner=of_rollers(kinds.inner, rollers.inner_slices, place.inner_effective_radii),
            holes=pressures_of_slices(kinds.holes, estimate_along_width(kinds.holes, holes, hole), hole),
            rigid_shaft_pins=False,
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


def _rows_of(pins: FloatArray, rollers: RollerState) -> NDArray[np.object_]:
    """What contacts in slices want to find again, row by row."""
    found = np.empty(pins.shape[0], dtype=object)
    each = (pins, rollers.share, rollers.lean, rollers.inner_slices, rollers.outer_slices)
    found[:] = list(zip(*(values for values in each if values is not None), strict=True))
    return found


def _leaning_roller_tangent(rollers: RollerState, bores: BoreMotion, coordinates: Coordinates) -> FloatArray:
    positions, cranks = bores.arm.shape
    stiffness = rollers.tangent.reshape(positions, cranks, -1, 4, 4).sum(axis=2)
    moved = np.zeros((positions, cranks, 4, coordinates.size))
    moved[:, :, 0], moved[:, :, 1] = bores.gradient.real, bores.gradient.imag
    moved[:, :, 2:, coordinates.lean_place] = np.eye(2)
    tangent = np.matmul(moved.swapaxes(2, 3), np.matmul(stiffness, moved)).sum(axis=1)
    add_bearing_bend(tangent, rollers, bores)
    return np.asarray(tangent)


def _pair_tangent(motion: PairMotion, load: FloatArray, stiffness: FloatArray) -> FloatArray:
    scaled = stiffness[..., None] * motion.gradient
    return np.asarray(np.matmul(motion.gradient.swapaxes(1, 2), scaled) + motion.bend(load))
