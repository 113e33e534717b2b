"""Contact grids solved inside every iteration of the equilibrium: the ``direct`` method.

The same equilibrium as with tables, but each loaded contact is a grid of its own with the true separation of its
surfaces: exact circles for rollers and races, exact flank and exact circle for pins. The memory that travels with
each position holds its contacts, so that one iteration starts from the contact cells of the last.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ltca.compliance.pressures import elastic_hole_pressures
from ltca.compliance.response import (
    ContactPressures,
    KindPressures,
    Response,
    Start,
    assemble_response,
    spring_load_and_stiffness,
)
from ltca.compliance.rollers import RollerLaws, RollerState, balance_rollers
from ltca.contact.end_pressure import largest_pressure
from ltca.contact.tracked_grid import CELLS, ContactKind, ContactKinds, GridContact
from ltca.drive.parts import Drive
from ltca.geometry.pairs import ContactGeometry, FlankMotion
from ltca.geometry.separation import circle_departure, flank_departure

FloatArray = NDArray[np.float64]

SAME_PLACE = 1e-6
"""Contacts that move by less than this parameter (rad) keep their separation; its radius then errs by 1e-5 or less,
the load by a tenth of that."""


@dataclass(frozen=True, slots=True)
class PositionContacts:
    """Contacts of one position that have been loaded so far, by the number of their pair."""

    pins: dict[int, GridContact] = field(default_factory=dict)
    inner: dict[int, GridContact] = field(default_factory=dict)
    outer: dict[int, GridContact] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class _RollerGrids:
    """The law of the rollers of a batch of positions on one race, each on its own grid."""

    contacts: list[dict[int, GridContact]]

    def load_and_stiffness(self, approach: ArrayLike, effective_radius: ArrayLike) -> tuple[FloatArray, FloatArray]:
        pressed = np.asarray(approach, dtype=float)
        load, stiffness = np.zeros_like(pressed), np.zeros_like(pressed)
        for row, roller in zip(*np.nonzero(pressed > 0.0), strict=True):
            load[row, roller], stiffness[row, roller] = self.contacts[row][int(roller)].press(
                float(pressed[row, roller])
            )
        return load, stiffness


@dataclass(frozen=True, slots=True, kw_only=True)
class GridCompliance:
    """Half-space contact grids for pins and rollers, springs for the pin holes.

    Attributes
    ----------
    geometry : ContactGeometry
        The contact geometry of the drive.
    kinds : ContactKinds
        What the contacts of each kind share.
    inner_radius, outer_radius : array, shape (n_BR,)
        Effective radii of the rollers, mm.
    hole_stiffness : float
        k_PS, N/mm.
    """

    geometry: ContactGeometry
    kinds: ContactKinds
    inner_radius: FloatArray
    outer_radius: FloatArray
    hole_stiffness: float

    @classmethod
    def of_drive(cls, drive: Drive, cells: int = CELLS) -> GridCompliance:
        """Return the grid model of a drive.

        Parameters
        ----------
        drive : Drive
            The drive.
        cells : int
            Cells over each half-width and over half of each length.
        """
        geometry = ContactGeometry.of_drive(drive)
        place = geometry.placement
        kinds = ContactKinds.of_drive(drive, cells)
        return cls(
            geometry=geometry,
            kinds=kinds,
            inner_radius=place.inner_effective_radii,
            outer_radius=place.outer_effective_radii,
            hole_stiffness=drive.pin_shaft.stiffness,
        )

    def respond(self, crank_angle: FloatArray, pose: FloatArray, start: Start | None = None) -> Response:
        """Return the contact forces at the poses of a batch of positions; see `ltca.compliance.half_space`."""
        memory = np.full(crank_angle.size, None, dtype=object) if start is None else start.memory.copy()
        for row in range(memory.size):
            if memory[row] is None:
                memory[row] = PositionContacts()
        flank = self.geometry.flank(crank_angle, pose, None if start is None else start.parameter)
        pin_load, pin_stiffness = self._press_pins(flank, memory)
        holes = self.geometry.holes(crank_angle, pose)
        hole_load, hole_stiffness = spring_load_and_stiffness(holes.approach, self.hole_stiffness)
        rollers = self._balance(crank_angle, pose, None if start is None else start.share, memory)
        return assemble_response(
            flank, pin_load, pin_stiffness, holes, hole_load, hole_stiffness, rollers, memory=memory
        )

    def pressures(self, response: Response) -> ContactPressures:
        """Return pressures and half-widths from the grids, those of the shaft pins from their loads."""
        flank, rollers, memory = response.flank, response.rollers, response.memory
        return ContactPressures(
            pins=_read_grids([entry.pins for entry in memory], flank.approach, self.kinds.pins),
            outer=_read_grids([entry.outer for entry in memory], rollers.outer_approach, self.kinds.outer),
            inner=_read_grids([entry.inner for entry in memory], rollers.inner_approach, self.kinds.inner),
            holes=elastic_hole_pressures(self.kinds.holes, response.hole_load, self.geometry.placement),
            rigid_shaft_pins=False,
        )

    def _press_pins(self, flank: FlankMotion, memory: NDArray[np.object_]) -> tuple[FloatArray, FloatArray]:
        load, stiffness = np.zeros_like(flank.approach), np.zeros_like(flank.approach)
        profile, pin_radii = self.geometry.profile, self.geometry.placement.wheel_pin_radii
        for row, pin in zip(*np.nonzero(flank.approach > 0.0), strict=True):
            approach = float(flank.approach[row, pin])
            contact = memory[row].pins.setdefault(int(pin), GridContact(self.kinds.pins))
            contact.fit(approach, float(flank.effective_radius[row, pin]))
            theta = float(flank.parameter[row, pin])
            if abs(theta - contact.place) < SAME_PLACE:
                theta = contact.place
            radius = float(pin_radii[pin])
            contact.shape(theta, lambda x, t=theta, r=radius: flank_departure(profile, t, x) + circle_departure(x, r))
            load[row, pin], stiffness[row, pin] = contact.press(approach)
        return load, stiffness

    def _balance(
        self, crank_angle: FloatArray, pose: FloatArray, share: FloatArray | None, memory: NDArray[np.object_]
    ) -> RollerState:
        place = self.geometry.placement
        rays = self.geometry.rollers(crank_angle)
        displacement = pose[:, 0] + 1j * pose[:, 1]
        interference = rays.outermost - rays.touching_distance(displacement)
        guess = np.full(interference.shape, 0.5) if share is None else share
        # Grids are chosen before the rollers are balanced and held meanwhile: their laws then stay monotone.
        for row, roller in zip(*np.nonzero(interference > 0.0), strict=True):
            number, whole, part = int(roller), float(interference[row, roller]), float(guess[row, roller])
            radius = float(place.roller_radii[roller])
            inner = memory[row].inner.setdefault(number, GridContact(self.kinds.inner))
            inner.fit(part * whole, float(self.inner_radius[roller]))
            race = place.inner_race_radius
            inner.shape(0.0, lambda x, r=radius, o=race: circle_departure(x, r) + circle_departure(x, o))
            outer = memory[row].outer.setdefault(number, GridContact(self.kinds.outer))
            outer.fit((1.0 - part) * whole, float(self.outer_radius[roller]))
            bore = -place.bore_radius
            outer.shape(0.0, lambda x, r=radius, o=bore: circle_departure(x, r) + circle_departure(x, o))
        laws = RollerLaws(
            inner=_RollerGrids([entry.inner for entry in memory]),
            outer=_RollerGrids([entry.outer for entry in memory]),
            inner_radius=self.inner_radius,
            outer_radius=self.outer_radius,
        )
        return balance_rollers(rays, displacement, laws, share)


def _read_grids(contacts: list[dict[int, GridContact]], approach: FloatArray, kind: ContactKind) -> KindPressures:
    mid, largest, half_width = np.zeros_like(approach), np.zeros_like(approach), np.zeros_like(approach)
    for row, pair in zip(*np.nonzero(approach > 0.0), strict=True):
        solved = contacts[row][int(pair)].solution(float(approach[row, pair]))
        mid[row, pair], half_width[row, pair] = solved.mid_pressure, solved.half_width
        largest[row, pair] = largest_pressure(solved, kind.end_cell)
    return KindPressures(mid=mid, largest=largest, half_width=half_width, end_cell=kind.end_cell)
