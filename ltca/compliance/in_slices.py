"""Contacts of a disc in slices at a pose: how they tilt, what they carry, and what force and tangent of the disc that makes.

Walls of bodies that yield under other contacts (`ltca.compliance.coupled_slices`) take their part off every approach and, where
bodies are solid, off every tilt: contacts may be asked for with that given.
"""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import ComplexArray, FloatArray
from ltca.compliance.leaning_rollers import RollerStart, balance_leaning_rollers
from ltca.compliance.response import (
    DiscResponse,
    LeaningPairs,
    PairSlopes,
    add_bearing_bend,
    bearing_moments,
    resultant,
    split_shifts,
)
from ltca.compliance.rollers import RollerLaws, RollerState
from ltca.compliance.stored_energy import StoredEnergy
from ltca.geometry.pair_motion import FlankMotion, PairMotion, dot
from ltca.geometry.pairs import ContactGeometry
from ltca.laws.sliced_contact import EXACT, Exactness, SlicedContact


class SlicedLaw(Protocol):
    """Law of contacts in slices."""

    def respond(
        self,
        approach: FloatArray,
        tilt: FloatArray,
        effective_radius: FloatArray,
        start: FloatArray | None = None,
        exactness: Exactness = EXACT,
    ) -> SlicedContact:
        """Return what contacts carry, as `ltca.laws.sliced_line.SlicedLine.respond`."""
        ...


class ContactsInSlices:
    """Wheel pins, shaft pins and rollers of a disc at the poses of a batch of positions.

    Parameters
    ----------
    geometry : ContactGeometry
        Of the disc.
    crank_angle : array, shape (positions,)
        φ_C, rad.
    pose : array, shape (positions, coordinates)
        q.
    flank : FlankMotion
        Wheel pins and flank there.
    shifts, leans : array of complex, shape (positions, z_P + z_PS), or None
        Displacements, mm, and leans, rad, of the pins.
    exactness : Exactness
        How close to balance contacts come.
    """

    def __init__(
        self,
        geometry: ContactGeometry,
        crank_angle: FloatArray,
        pose: FloatArray,
        flank: FlankMotion,
        shifts: ComplexArray | None,
        leans: ComplexArray | None,
        exactness: Exactness = EXACT,
    ) -> None:
        self.geometry, self.shifts, self.leans, self.exactness = geometry, shifts, leans, exactness
        self.coordinates = geometry.coordinates_of(pose)
        holes = geometry.holes(crank_angle, pose, split_shifts(shifts, geometry)[1])
        of_pins, of_holes = split_shifts(leans, geometry)
        self.motions: tuple[FlankMotion, PairMotion] = flank, holes
        self.tilts = (
            geometry.flank_tilt(crank_angle, pose, flank, of_pins),
            geometry.hole_tilt(pose, holes, of_holes),
        )
        self.radii = flank.effective_radius, geometry.placement.hole_effective_radii
        self.bores, self.rays = geometry.bores(crank_angle, pose), geometry.rollers(crank_angle)
        journals = self.bores.each(geometry.journal_leans(pose), self.rays.direction.shape[1])
        self.at_race, self.at_bore = (dot(self.rays.direction, lean) for lean in (journals, geometry.lean(pose)))

    def pair(
        self,
        number: int,
        law: SlicedLaw,
        start: FloatArray | None = None,
        given: FloatArray | float = 0.0,
        given_tilt: FloatArray | None = None,
    ) -> LeaningPairs:
        """Return what wheel pins (0) or shaft pins (1) carry, of whose approaches the bodies take `given`, mm, and `given_tilt`,
        rad, of their tilts.
        """
        motion, tilt = self.motions[number], self.tilts[number]
        at = tilt.tilt if given_tilt is None else tilt.tilt - given_tilt
        contact = law.respond(motion.approach - given, at, self.radii[number], start, self.exactness)
        return LeaningPairs(tilt=tilt, contact=contact.still)

    def rollers(
        self,
        laws: RollerLaws[Any],
        start: RollerStart | None = None,
        given: tuple[FloatArray | float, FloatArray | float] = (0.0, 0.0),
        given_tilts: tuple[FloatArray, FloatArray] | None = None,
    ) -> RollerState:
        """Return the balanced rollers, of whose approaches in the bore and on the race the bodies take `given`, mm, and
        `given_tilts`, rad, of their tilts.
        """
        displacement = self.bores.each(self.bores.displacement, self.rays.direction.shape[1])
        at = self.at_race, self.at_bore
        return balance_leaning_rollers(self.rays, displacement, laws, at, start, given, self.exactness, given_tilts)

    @property
    def moved(self) -> FloatArray:
        """How displacement and lean of the bores follow the pose, shape (positions, cranks, 4, coordinates)."""
        leans = self.bores.relative_leans(self.coordinates)
        by_pose = self.bores.gradient
        return np.stack((by_pose.real, by_pose.imag, leans.real, leans.imag), axis=2)

    def response(
        self,
        pairs: tuple[LeaningPairs, LeaningPairs],
        rollers: RollerState,
        warm_start: NDArray[np.object_],
    ) -> DiscResponse:
        """Return force, tangent and loads, the bodies' part of approaches held."""
        flank, holes = self.motions
        pins, of_holes = pairs[0].contact.load, pairs[1].contact.load
        force = resultant(flank, pins, holes, of_holes, rollers, self.bores)
        tilting = bearing_moments(rollers, self.rays, self.bores.arm.shape[1])
        leans = self.bores.relative_leans(self.coordinates)
        force -= np.einsum("bc,bcj->bj", tilting.conjugate(), leans).real
        tangent = self._roller_tangent(rollers)
        for motion, pair in zip(self.motions, pairs, strict=True):
            found, by_tilt = pair.contact, pair.tilt.gradient
            force += np.einsum("bi,bij->bj", found.moment, by_tilt)
            scaled = found.by_approach[..., None] * motion.gradient
            tangent += np.matmul(motion.gradient.swapaxes(1, 2), scaled) + motion.bend(found.load)
            mixed = np.matmul(motion.gradient.swapaxes(1, 2), found.by_tilt[..., None] * by_tilt)
            tangent += mixed + mixed.swapaxes(1, 2)
            tangent += np.matmul(by_tilt.swapaxes(1, 2), found.moment_by_tilt[..., None] * by_tilt)
            tangent += motion.bend_leans(found.moment, self.coordinates)
        return DiscResponse(
            force=force,
            tangent=tangent,
            flank=flank,
            holes=holes,
            rollers=rollers,
            pin_load=pins,
            hole_load=of_holes,
            warm_start=warm_start,
            shifts=self.shifts,
            leans=self.leans,
            slopes=None if self.shifts is None else self.slopes(pairs),
            leaning_pins=pairs[0],
            leaning_holes=pairs[1],
            left=None if self.exactness is EXACT else _largest((*(pair.contact.left for pair in pairs), rollers.left)),
        )

    def slopes(self, pairs: tuple[LeaningPairs, LeaningPairs]) -> PairSlopes:
        """Return how loads and moments of wheel pins and shaft pins follow their approaches, tilts and the pose."""
        k, mixed, turning = (
            np.concatenate([getattr(pair.contact, name) for pair in pairs], axis=1)
            for name in ("by_approach", "by_tilt", "moment_by_tilt")
        )
        gradient = np.concatenate([motion.gradient for motion in self.motions], axis=1)
        by_tilt = np.concatenate([pair.tilt.gradient for pair in pairs], axis=1)
        return PairSlopes(
            by_approach=k,
            by_pose=k[..., None] * gradient + mixed[..., None] * by_tilt,
            by_tilt=mixed,
            moment_by_tilt=turning,
            moment_by_pose=mixed[..., None] * gradient + turning[..., None] * by_tilt,
        )

    def _roller_tangent(self, rollers: RollerState) -> FloatArray:
        positions, cranks = self.bores.arm.shape
        stiffness = rollers.tangent[..., :4, :4].reshape(positions, cranks, -1, 4, 4).sum(axis=2)
        moved = self.moved
        tangent = np.matmul(moved.swapaxes(2, 3), np.matmul(stiffness, moved)).sum(axis=1)
        add_bearing_bend(tangent, rollers, self.bores)
        return np.asarray(tangent)


def _largest(forces: tuple[FloatArray | None, ...]) -> FloatArray | None:
    """Largest force that contacts of each position leave over, N."""
    left = [force.max(axis=1, initial=0.0) for force in forces if force is not None]
    return np.max(left, axis=0) if left else None


def roller_start(near: list[Any]) -> RollerStart:
    """Return the rollers of a warm start (`warm_rows`)."""
    names = ("inward", "lean", "inner", "outer", "place", "stood", "follow")
    return RollerStart(**dict(zip(names, near[2:9], strict=True)))


def warm_rows(pairs: tuple[LeaningPairs, LeaningPairs], rollers: RollerState, *more: FloatArray) -> NDArray[np.object_]:
    """Return what contacts want to find again, row by row: pins and holes (`SlicedContact.near`), the rollers, and more."""
    found = np.empty(rollers.share.shape[0], dtype=object)
    near = (pair.contact.near for pair in pairs)
    own = rollers.inner_near, rollers.outer_near
    each = (*near, rollers.share, rollers.lean, *own, rollers.inner_approach, rollers.stood, rollers.follow, *more)
    found[:] = list(zip(*(values for values in each if values is not None), strict=True))
    return found


def stacked(warm: NDArray[np.object_] | None) -> list[FloatArray] | None:
    """Return the arrays behind the rows of `warm_rows`; None where a row is missing."""
    if warm is None or any(each is None for each in warm):
        return None
    return [np.stack(parts) for parts in zip(*warm, strict=True)]


def stored_in_slices(
    response: DiscResponse,
    laws: tuple[Any, Any],
    rollers: RollerLaws[Any],
    hole_radii: FloatArray,
    given: tuple[FloatArray | float, ...] = (0.0, 0.0, 0.0, 0.0),
    given_tilts: tuple[FloatArray | float, ...] = (0.0, 0.0, 0.0, 0.0),
) -> StoredEnergy:
    """Return what the contacts of a response store themselves.

    Parameters
    ----------
    response : DiscResponse
        Contacts in slices, not `kept`.
    laws : tuple of SlicedLaw
        Of wheel pins and of shaft pins, with their energy.
    rollers : RollerLaws
        Of the rollers.
    hole_radii : array
        Effective radii of shaft pins in their holes, mm.
    given, given_tilts : tuple of array
        What bodies take of the approaches, mm, and tilts, rad, of wheel pins, bores, holes and races; tilts of rollers are
        without it.
    """
    pins, holes, own = response.leaning_pins, response.leaning_holes, response.rollers
    assert pins is not None
    assert holes is not None
    assert own.inner_tilt is not None
    assert own.outer_tilt is not None
    return StoredEnergy.of_slices(
        (
            laws[0],
            response.flank.approach - given[0],
            pins.tilt.tilt - given_tilts[0],
            response.flank.effective_radius,
            pins.contact.near,
        ),
        [
            (
                laws[1],
                response.holes.approach - given[2],
                holes.tilt.tilt - given_tilts[2],
                hole_radii,
                holes.contact.near,
            ),
            (rollers.outer, own.outer_approach - given[1], own.outer_tilt, rollers.outer_radius, own.outer_near),
            (rollers.inner, own.inner_approach - given[3], own.inner_tilt, rollers.inner_radius, own.inner_near),
        ],
    )
