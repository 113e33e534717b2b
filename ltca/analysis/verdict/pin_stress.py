"""Bending and shear stress of pins that are beams, under the forces of all discs (elementary theory of round beams)."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ltca.analysis.loaded_analysis import LoadedAnalysis
from ltca.equilibrium.reducer import disc_responses
from ltca.geometry.coordinates import DISC_PLACE
from ltca.laws.backed import from_start, shaft_pin_beam, wheel_pin_beam

FloatArray = NDArray[np.float64]

PLACES = 201
"""Places along a pin at which moments are looked at, besides its ends and the edges of the discs."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PinStress:
    """Largest stresses along pins.

    Attributes
    ----------
    bending : array, shape (positions, pins)
        32 M/(π d³), MPa.
    shear : array, shape (positions, pins)
        At the neutral fibre, 16 V/(3 π d²), MPa.
    """

    bending: FloatArray
    shear: FloatArray


def pin_stress(analysis: LoadedAnalysis, pins: Literal["wheel", "shaft"]) -> PinStress | None:
    """Return the stresses of wheel pins or shaft pins; None where they are no beams."""
    drive = analysis.drive
    beam = wheel_pin_beam(drive) if pins == "wheel" else shaft_pin_beam(drive)
    if beam is None:
        return None
    planes, width = from_start(beam, drive).tolist(), drive.disc.thickness
    edges = [edge for plane in planes for edge in (plane - 0.5 * width, plane + 0.5 * width)]
    at = np.unique(np.concatenate([np.linspace(0.0, beam.span, PLACES), np.clip(edges, 0.0, beam.span)]))
    forces = []
    for part in disc_responses(analysis.full.response):
        motion, load = (part.flank, part.pin_load) if pins == "wheel" else (part.holes, part.hole_load)
        vector = load[..., None] * motion.gradient[..., DISC_PLACE]
        if part.friction is not None:
            count = part.pin_load.shape[1]
            rubbed = part.friction[:, :count] if pins == "wheel" else part.friction[:, count:]
            vector = vector + rubbed[..., None] * motion.along[..., DISC_PLACE]
        forces.append(vector[..., 0] + 1j * vector[..., 1])
    # A pin gives way as the disc presses; a tied tip goes with its ring.
    tip = np.zeros_like(forces[0])
    coordinates = analysis.model.coordinates
    if pins == "shaft" and coordinates.ring:
        by_ring = analysis.model.discs[0].geometry.tips_by_ring
        tip = np.einsum("pj,bj->bp", by_ring, analysis.full.pose[:, coordinates.ring_place])
    acting = np.stack([*forces, tip], axis=-1)
    moment = np.abs(np.matmul(acting, beam.moments(at, planes, width).T.astype(complex))).max(axis=-1)
    shear = np.abs(np.matmul(acting, beam.shears(at, planes, width).T.astype(complex))).max(axis=-1)
    return PinStress(
        bending=32.0 * moment / (pi * beam.diameter**3), shear=16.0 * shear / (3.0 * pi * beam.diameter**2)
    )
