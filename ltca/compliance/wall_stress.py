"""Stress in the disc along lobe roots, bore and hole walls where they are clear of contacts, and in the wall under each contact.

Nearer than four half-widths the contact's own stresses rule (`ltca.contact.subsurface`), to whose largest shear half of the
stress under the contact adds (docs/theory/coefficients.md).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import ComplexArray, FloatArray, join_positions, take_positions
from ltca.compliance.response import ContactPressures, DiscModel, DiscResponse
from ltca.compliance.stress_coefficients import StressCoefficients, evaluate_wall_stress

CLEAR_HALF_WIDTHS = 4.0
"""A wall is clear of a contact beyond this many of its half-widths."""

REFINEMENT = 4
"""Places for each stress station: largest stresses of the paper's disc within 0.3 % (roots), 0.2 % (bore), 1.1 % (holes)."""

POSITIONS_PER_CHUNK = 128
"""Positions evaluated at once: distances of all places from all contacts stay small."""


@dataclass(frozen=True, slots=True, kw_only=True)
class WallProfile:
    """Stress along one wall of the disc at places: θ on the flank, polar angles in the disc frame about its centre, rad."""

    parameter: FloatArray
    stress: FloatArray  # tension positive, MPa, without a contact's own pressure, shape (positions, places)
    clear: NDArray[np.bool_]  # farther than four half-widths from every loaded contact

    def largest(self, places: NDArray[np.bool_] | slice = slice(None)) -> FloatArray:
        """Return the largest clear stress of each position among some places; not a number where none is clear."""
        best = np.max(np.where(self.clear[:, places], self.stress[:, places], -np.inf), axis=1)
        return np.where(np.isfinite(best), best, np.nan)


@dataclass(frozen=True, slots=True, kw_only=True)
class WallStresses:
    """Largest clear tensile stresses along walls and stresses under contacts, MPa; NaN where not known or nothing is clear."""

    root: FloatArray  # about each root θ = 2πk/z_C, from crest to crest, shape (positions, lobes)
    bore: FloatArray  # largest of all bores, (positions,)
    hole: FloatArray  # (positions, z_PS)
    pin_contact: FloatArray  # under wheel pins, or where open ones would touch, (positions, pairs), as those below
    roller_contact: FloatArray
    hole_contact: FloatArray


class _PlacedContacts(NamedTuple):
    """Contacts of one wall, arrays (positions, contacts): places, rad, loads into the disc, N, and how near they are, mm."""

    parameter: FloatArray
    load: FloatArray
    points: ComplexArray
    half_width: FloatArray


def wall_stresses(
    model: DiscModel, response: DiscResponse, pressures: ContactPressures, disc_rotation: FloatArray
) -> WallStresses:
    """Return the stresses along walls and under contacts of a response and its pressures, by the disc's rotation, rad."""
    positions, lobes = disc_rotation.size, round(model.geometry.profile.reduction_ratio) - 1
    stress = None if model.coefficients is None else model.coefficients.stress
    if stress is None:
        loads = response.pin_load, response.rollers.outer_load, response.hole_load
        pins, rollers, holes = (np.full(load.shape, np.nan) for load in loads)
        roots = np.full((positions, lobes), np.nan)
        return WallStresses(
            root=roots, bore=roots[:, 0], hole=holes, pin_contact=pins, roller_contact=rollers, hole_contact=holes
        )
    placed = _place_contacts(model, response, pressures, disc_rotation)
    parts = [
        _reduce(model, stress, take_positions(placed, rows), lobes)
        for rows in np.array_split(np.arange(positions), max(1, -(-positions // POSITIONS_PER_CHUNK)))
    ]
    return join_positions(parts)


def wall_profiles(
    model: DiscModel,
    response: DiscResponse,
    pressures: ContactPressures,
    disc_rotation: FloatArray,
    *,
    refinement: int = REFINEMENT,
) -> tuple[WallProfile, ...]:
    """Return the stress along flank, each bore and hole, at so many places per station; none without stresses in the file."""
    stress = None if model.coefficients is None else model.coefficients.stress
    if stress is None:
        return ()
    return _profiles(model, stress, _place_contacts(model, response, pressures, disc_rotation), refinement)[0]


def _place_contacts(
    model: DiscModel, response: DiscResponse, pressures: ContactPressures, disc_rotation: FloatArray
) -> tuple[_PlacedContacts, ...]:
    """Return the contacts of flank, each bore and each hole in the frame of the disc."""
    place, turn = model.geometry.placement, disc_rotation[:, None]
    flank, rollers = response.flank, response.rollers
    bore = np.angle(rollers.outer_direction) - turn
    bore_points = np.repeat(place.bore_centres, bore.shape[1] // place.cranks) + place.bore_radius * np.exp(1j * bore)
    # The approach of a shaft pin grows against its gradient by the displacement of the disc.
    toward = -(response.holes.gradient[..., 0] + 1j * response.holes.gradient[..., 1])
    holes = np.angle(toward) - turn
    hole_points = place.hole_centres + place.hole_radii * np.exp(1j * holes)
    kinds = (
        (1, flank.parameter, response.pin_load, model.geometry.profile.flank(flank.parameter), pressures.pins),
        (place.cranks, bore, rollers.outer_load, bore_points, pressures.outer),
        (holes.shape[1], holes, response.hole_load, hole_points, pressures.holes),
    )
    return tuple(
        _PlacedContacts(*of_wall)
        for walls, *each, pressed in kinds
        if walls
        for of_wall in zip(*(np.split(one, walls, axis=1) for one in (*each, pressed.half_width)), strict=True)
    )


def _profiles(
    model: DiscModel, coefficients: StressCoefficients, placed: tuple[_PlacedContacts, ...], refinement: int
) -> tuple[tuple[WallProfile, ...], FloatArray]:
    """Return the profiles of all walls, and the stress at the stations."""
    place = model.geometry.placement
    centres = np.concatenate((place.bore_centres, place.hole_centres))
    radii = np.concatenate((np.full(place.cranks, place.bore_radius), place.hole_radii))
    stress = evaluate_wall_stress(coefficients, [(own.parameter, own.load) for own in placed])
    profiles = []
    for number, (wall, own) in enumerate(zip(coefficients.walls, placed, strict=True)):
        parameter = wall.parameters(refinement)
        if number == 0:
            points = model.geometry.profile.flank(parameter)
        else:
            points = centres[number - 1] + radii[number - 1] * np.exp(1j * parameter)
        clear = np.ones((stress.shape[0], parameter.size), dtype=bool)
        for contact in range(own.points.shape[1]):
            reach = np.where(own.load[:, contact] > 0.0, CLEAR_HALF_WIDTHS * own.half_width[:, contact], -1.0)
            clear &= np.abs(points - own.points[:, contact, None]) > reach[:, None]
        profiles.append(WallProfile(parameter=parameter, stress=wall.refined(stress, refinement), clear=clear))
    return tuple(profiles), stress


def _reduce(
    model: DiscModel, coefficients: StressCoefficients, placed: tuple[_PlacedContacts, ...], lobes: int
) -> WallStresses:
    """Stresses of some positions."""
    profiles, stress = _profiles(model, coefficients, placed, REFINEMENT)
    flank, *round_walls = profiles
    nearest = np.mod(np.rint(flank.parameter * lobes / (2.0 * np.pi)).astype(int), lobes)
    walls = np.stack([wall.largest() for wall in round_walls], axis=1)
    cranks, rows, under = model.geometry.placement.cranks, np.arange(stress.shape[0])[:, None, None], []
    for wall, own in zip(coefficients.walls, placed, strict=True):
        stations, weights = wall.weights(own.parameter)
        under.append(np.sum(stress[rows, stations] * weights, axis=-1))
    return WallStresses(
        root=np.stack([flank.largest(nearest == root) for root in range(lobes)], axis=1),
        bore=np.fmax.reduce(walls[:, :cranks], axis=1),
        hole=walls[:, cranks:],
        pin_contact=under[0],
        roller_contact=np.concatenate(under[1 : 1 + cranks], axis=1),
        hole_contact=np.concatenate([np.zeros((len(stress), 0)), *under[1 + cranks :]], axis=1),
    )
