"""Overlap of the undeformed bodies at a pose, and where on the disc each contact lies: what coupled bodies start from."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import ComplexArray, FloatArray
from ltca.geometry.coordinates import DISC_ROTATION, X, Y
from ltca.geometry.pair_motion import FlankMotion, PairMotion
from ltca.geometry.pairs import ContactGeometry

Motions: TypeAlias = tuple[FlankMotion, PairMotion, ComplexArray | None]
"""Pairs of wheel pins and of shaft pins, and displacements of the pins that are in them."""


class UndeformedBodies:
    """Some positions at given poses, undeformed: where their contacts are and how far they overlap.

    Parameters
    ----------
    geometry : ContactGeometry
        Of a disc.
    angle : array, shape (positions,)
        φ_C, rad.
    pose : array, shape (positions, coordinates)
        q.
    pins : tuple
        Pairs of wheel pins and of shaft pins there, and displacements of the pins that are in them.
    """

    def __init__(self, geometry: ContactGeometry, angle: FloatArray, pose: FloatArray, pins: Motions) -> None:
        flank, holes, self.shifts = pins
        self.flank, self.holes = flank, holes
        self.bores, self.rays = geometry.bores(angle, pose), geometry.rollers(angle)
        bores, each = self.bores, self.rays.bore_play.size
        self.displacement, self.moved = bores.each(bores.displacement, each), bores.each(bores.gradient, each)
        turn = pose[:, DISC_ROTATION, None]
        play = -(holes.gradient[..., X] + 1j * holes.gradient[..., Y])
        length, outward, _ = self.rollers_at(0.0)
        self.bore_places, self.hole_places = np.angle(outward) - turn, np.angle(play) - turn
        self.geometric = np.concatenate([flank.approach, length - self.rays.bore_play, holes.approach], axis=1)
        """Overlap of the undeformed bodies, shape (positions, contacts)."""

    def rollers_at(self, inner_approach: FloatArray | float) -> tuple[FloatArray, ComplexArray, FloatArray]:
        """Distances of the rollers from the disc centre, directions, and cosines to their rays, at inner approaches, mm."""
        arm = (self.rays.outermost - inner_approach) * self.rays.direction - self.displacement
        length = np.sqrt(arm.real**2 + arm.imag**2)
        outward = arm / length
        return length, outward, (outward * self.rays.direction.conjugate()).real

    def within(self, margin: float) -> list[NDArray[np.intp]]:
        """Pins, rollers and holes that overlap or nearly do, as many in each position, shape (positions, chosen)."""
        reach = margin * np.max(self.geometric, axis=1, initial=0.0)[:, None]
        pins, rollers = self.flank.approach.shape[1], self.rays.bore_play.size
        chosen = []
        for part in np.split(self.geometric, (pins, pins + rollers), axis=1):
            near = (part > 0.0) | (part > -reach)
            most = max(1, int(np.max(np.count_nonzero(near, axis=1))))
            chosen.append(np.sort(np.argsort(-part, axis=1, kind="stable")[:, :most], axis=1))
        return chosen
