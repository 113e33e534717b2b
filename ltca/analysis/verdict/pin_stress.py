r"""Bending and shear stress of pins that are beams, under the forces of all discs (elementary theory of round beams).

Pins bend to and fro every turn, so what they endure is a matter of fatigue. The moment of every section is followed in the
frame of the pin itself, over all positions of a turn: wheel pins in that of the wheel, where each takes the place of the next
after a turn, so that all of them together are the history of one; shaft pins in that of the shaft, each for itself. A fibre on
the circumference sees a largest and a smallest stress, and the fully reversed amplitude that does as much harm is

.. math:: \sigma_{ar} = \sqrt{\sigma_{max} \sigma_a}

(K. N. Smith, P. Watson, T. H. Topper, *A stress-strain function for the fatigue of metals*, J. Materials 5 (1970) 767): the
amplitude itself where it is reversed, 0.71 of the largest stress where it pulsates. Pins that lie loose roll, and see every
moment from all sides: fully reversed with their largest stress.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import Literal

import numpy as np

from ltca.analysis.loaded_analysis import LoadedAnalysis
from ltca.arrays import ComplexArray, FloatArray
from ltca.drive.pin_beams import from_start, shaft_pin_beam, wheel_pin_beam
from ltca.geometry.coordinates import WHEEL_ANGLE

STATIONS = 201
"""Stations along a pin at which moments are evaluated, besides its ends and the edges of the discs."""


FIBRES = 36
"""Places on half the circumference, opposite ones having opposite stresses: one between two loses 0.1 % at most."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BendingCycle:
    """Bending of the worst fibre over a turn.

    Attributes
    ----------
    equivalent_amplitude : float
        Fully reversed amplitude that does as much harm, MPa.
    ratio : float
        Smallest by largest stress R: −1 fully reversed, 0 pulsating.
    pin : int or None
        Its number; None where all have the same history.
    """

    equivalent_amplitude: float
    ratio: float
    pin: int | None


@dataclass(frozen=True, slots=True, kw_only=True)
class PinStress:
    """Stresses along pins.

    Attributes
    ----------
    bending : array, shape (positions, pins)
        32 M/(π d³), MPa.
    shear : array, shape (positions, pins)
        At the neutral fibre, 16 V/(3 π d²), MPa.
    cycle : BendingCycle
        Of the worst fibre of all pins over the positions.
    rolls : bool
        Whether pins lie loose and roll.
    """

    bending: FloatArray
    shear: FloatArray
    cycle: BendingCycle
    rolls: bool


def pin_stress(analysis: LoadedAnalysis, pins: Literal["wheel", "shaft"]) -> PinStress | None:
    """Return the stresses of wheel pins or shaft pins; None where they are no beams."""
    drive = analysis.drive
    beam = wheel_pin_beam(drive) if pins == "wheel" else shaft_pin_beam(drive)
    if beam is None:
        return None
    planes, width = from_start(beam, drive).tolist(), drive.disc.thickness
    edges = [edge for plane in planes for edge in (plane - 0.5 * width, plane + 0.5 * width)]
    at = np.unique(np.concatenate([np.linspace(0.0, beam.span, STATIONS), np.clip(edges, 0.0, beam.span)]))
    parts = analysis.full.response.parts
    count = parts[0].pin_load.shape[1]
    forces = [part.pin_forces[:, :count] if pins == "wheel" else part.pin_forces[:, count:] for part in parts]
    # A pin gives way as the disc presses; a tied tip goes with its ring.
    tip = np.zeros_like(forces[0])
    coordinates = analysis.model.coordinates
    if pins == "shaft" and coordinates.ring:
        by_ring = analysis.model.discs[0].geometry.tips_by_ring
        tip = np.einsum("pj,bj->bp", by_ring, analysis.full.pose[:, coordinates.ring_place])
    slopes = parts[0].leaning_pins is not None
    if slopes:
        moments = [part.pin_moments for part in parts]
        forces += [each[:, :count] if pins == "wheel" else each[:, count:] for each in moments]
    acting = np.stack([*forces, tip], axis=-1)
    moment = np.matmul(acting, beam.moments(at, planes, width, slopes=slopes).T.astype(complex))
    shear = np.abs(np.matmul(acting, beam.shears(at, planes, width, slopes=slopes).T.astype(complex))).max(axis=-1)
    section = 32.0 / (pi * beam.diameter**3)
    place = analysis.model.discs[0].geometry.placement
    if pins == "wheel":
        turned = place.wheel_rotation(analysis.full.crank_angle) + analysis.full.pose[:, WHEEL_ANGLE]
        moment *= np.exp(-1j * (turned[:, None] + np.angle(place.wheel_pin_centres)))[..., None]
    rolls = pins == "wheel" and drive.pin_wheel.seat.kind == "slot"
    return PinStress(
        bending=section * np.abs(moment).max(axis=-1),
        shear=16.0 * shear / (3.0 * pi * beam.diameter**2),
        cycle=worst_cycle(section * moment, alike=pins == "wheel", rolls=rolls),
        rolls=rolls,
    )


def worst_cycle(stress: ComplexArray, *, alike: bool, rolls: bool) -> BendingCycle:
    """Return what the worst fibre of pins sees.

    Parameters
    ----------
    stress : array of complex, shape (positions, pins, places)
        Bending moment as a vector in the frame of each pin, by the section modulus, MPa.
    alike : bool
        Whether pins take each other's places, so that all of them are the history of one.
    rolls : bool
        Whether pins turn under their loads.
    """
    reach = np.abs(stress).max(axis=(0, 1))
    most = float(reach.max())
    if rolls or not np.isfinite(most) or most == 0.0:
        return BendingCycle(equivalent_amplitude=most, ratio=-1.0, pin=None)
    fibres = np.exp(-1j * pi * np.arange(FIBRES) / FIBRES)
    best = BendingCycle(equivalent_amplitude=0.0, ratio=0.0, pin=None)
    for place in np.argsort(-reach):
        if reach[place] <= best.equivalent_amplitude:  # an equivalent amplitude is at most the largest stress
            break
        seen = (stress[:, :, place, None] * fibres).real
        high, low = seen.max(axis=0), seen.min(axis=0)
        if alike:
            high, low = high.max(axis=0, keepdims=True), low.min(axis=0, keepdims=True)
        largest = np.maximum(high, -low)  # on the fibre itself or on the one opposite
        equivalent = np.sqrt(0.5 * largest * (high - low))
        pin, fibre = np.unravel_index(int(np.argmax(equivalent)), equivalent.shape)
        if equivalent[pin, fibre] > best.equivalent_amplitude:
            least = min(high[pin, fibre], -low[pin, fibre])
            best = BendingCycle(
                equivalent_amplitude=float(equivalent[pin, fibre]),
                ratio=float(-least / largest[pin, fibre]),
                pin=None if alike else int(pin),
            )
    return best
