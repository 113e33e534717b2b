r"""Pins of a drive as beams, and the springs that shaft pins are equal to.

A disc k that turns about its crank presses the shaft pin at the angle :math:`\varphi` along its eccentricity with
:math:`g_k \max(0, \sin(\varphi - \zeta_k))`, so that the pins of a side carry it. Averaged over crank angles, the energy of the
pins is :math:`\tfrac12 g^T C g`, with the flexibility A of a pin at rest at both ends, the shares b of its tip and the stiffness
k_t of that tip (`ltca.beam.PinBeam`), and a rigid ring that floats, turned by the moment and moved by the force of all tips,

.. math:: C_{kl} = z \left[ A_{kl} \cos\Delta\,\frac{(\pi - \Delta)\cos\Delta + \sin\Delta}{4\pi}
   + \frac{b_k b_l}{k_t} \left( \frac{1}{16} + \frac{\cos\Delta}{\pi^2} \right) \right],
   \quad \Delta = |\zeta_k - \zeta_l| \le \pi ,

where springs of stiffness k have :math:`z \sum g_k^2/4k`. At one torque, in proportion to :math:`\sum g_k`, springs yield alike
under alike loads of the discs; beams yield by no more than with alike loads, and no less than where the discs turn alike. What
else yields in series with each disc decides between the two: with s, its energy for g = 1 twice, springs and beams turn the
output as far where

.. math:: \frac{n}{z/4k + s} = 1^T (C + s)^{-1} 1 ,

s from lines of contact of flank and crank bearing, of stiffness π E* t/10 (Palmgren), at the torque.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from ltca.arrays import FloatArray
from ltca.beam import End, PinBeam
from ltca.drive.parts import Drive, contact_modulus

ERROR_TIED, ERROR_FREE = 0.25, 0.3
"""Largest errors of the torsional stiffness, least or mean over a turn, with a spring in the place of pins with tied tips, which
share a load otherwise than by their places, and with free tips of several discs, rounded up: 0.224 and 0.248 of the 24 invented
drives of ``benchmarks/spring_of_pins.py``, on half-spaces. With tied tips slender pins on pinned tips, and three pins, are off by
most; thick ones by some hundredths. With a free tip and one disc there is none."""
FLANK_PHASES = 8
"""Places of the wheel pins between two teeth over which the compliance of the flank is a mean."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ShaftPinSpring:
    """Springs that the beams of shaft pins are equal to in torsion of the output, N/mm of one pin against one disc.

    Attributes
    ----------
    loaded_alike : float
        Where every disc carries the same torque.
    turned_alike : float
        Where every disc turns by the same angle, against the pins alone; no less than `loaded_alike`, equal for one disc.
    together : float
        Between both, with flank and crank bearing of every disc in series.
    error : float
        Part by which the torsional stiffness with the spring is off at most (`ERROR_TIED`, `ERROR_FREE`).
    """

    loaded_alike: float
    turned_alike: float
    together: float
    error: float

    @property
    def stiffness(self) -> float:
        """`together` to three digits, for ``pin_shaft.stiffness``."""
        return float(f"{self.together:.2e}")

    @property
    def accuracy(self) -> str:
        """How near the torsional stiffness with `stiffness` is to that with the beams, in words; empty where it is the same."""
        return f"within some {100.0 * self.error:g} %" if self.error else ""


def two_digits(value: float) -> float:
    """Return a value rounded to two significant digits."""
    return float(f"{value:.1e}")


def shaft_pin_spring(drive: Drive) -> ShaftPinSpring | None:
    """Return the springs that the shaft pins are equal to; None where they are springs, or posts hold their tips.

    Examples
    --------
    Pins of ⌀ 10 mm between flange and ring, two discs half a turn apart:

    >>> from ltca.reading.drive_file import load_drive
    >>> joint = load_drive("robot-joint").cases["nominal"]
    >>> pins = joint.with_fields({"pin_shaft.beam": {"tip": "tied-clamped"}})
    >>> shaft_pin_spring(pins).stiffness
    391000.0
    """
    beam = shaft_pin_beam(drive)
    if beam is None or drive.posts is not None:
        return None
    planes, width, pins = from_start(beam, drive).tolist(), drive.disc.thickness, drive.number_of_holes
    phase = np.array(drive.disc.disc_phases)
    apart = np.abs((phase[:, None] - phase + pi) % (2.0 * pi) - pi)
    common = np.cos(apart) * ((pi - apart) * np.cos(apart) + np.sin(apart)) / (4.0 * pi)
    energy = pins * common * beam.flexibility(planes, width)
    if beam.ends[1] != "free":
        share = beam.tip_shape(planes, width)
        energy += pins * np.outer(share, share) / beam.tip_stiffness * (1.0 / 16.0 + np.cos(apart) / pi**2)
    discs, beside = phase.size, _energy_beside(drive)
    alone = discs / _most_torque(energy + beside * np.eye(discs)) - beside
    return ShaftPinSpring(
        loaded_alike=0.25 * pins * discs / float(energy.sum()),
        turned_alike=0.25 * pins / discs * _most_torque(energy),
        together=0.25 * pins / alone,
        error=ERROR_TIED if beam.ends[1] != "free" else ERROR_FREE if discs > 1 else 0.0,
    )


def _energy_beside(drive: Drive) -> float:
    """Twice the energy of flank and crank bearing of a disc whose shaft pins carry g max(0, sin), by g², mm/N.

    Of `ltca.studies.design_search.closed_forms`: pins of the wheel share by levers and gaps of the flank.
    """
    wheel, bearing = drive.pin_wheel, drive.crank_bearing
    count, radius, reach = (
        wheel.number_of_pins,
        wheel.pin_circle_radius,
        drive.crank.eccentricity * wheel.number_of_pins,
    )
    torque = abs(drive.wheel_moment()) / drive.disc.number_of_discs
    turning = np.linspace(0.0, 1.0, FLANK_PHASES, endpoint=False)[:, None]
    angle = 2.0 * pi * (np.arange(count) + turning) / count
    apart = np.sqrt(radius**2 + reach**2 - 2.0 * radius * reach * np.cos(angle))
    lever = reach * radius * np.maximum(np.sin(angle), 0.0) / apart
    gap = drive.disc.equidistant_offset - drive.disc.shifting_offset * (radius - reach * np.cos(angle)) / apart
    line = pi * contact_modulus(drive.materials.disc, drive.flank_pin) * drive.disc.thickness / 10.0
    wound = _wind_up(lever, gap, torque / line)
    closed = line * np.sum(np.where(wound * lever > gap, lever**2, 0.0), axis=1)
    rolled = pi * contact_modulus(drive.materials.disc, drive.materials.roller) * drive.roller_length / 10.0
    across = rolled * bearing.number_of_rollers / 8.0
    of_wheel = float(np.mean(1.0 / closed)) + 1.0 / (across * reach**2)
    shaft = drive.pin_shaft
    circle = 0.0 if shaft is None else shaft.pin_circle_radius
    return of_wheel * (0.25 * drive.number_of_holes * circle * count / (count - 1.0)) ** 2


def _wind_up(lever: FloatArray, gap: FloatArray, moment: float) -> FloatArray:
    """Rotation by which pins of stiffness 1, each behind its gap, carry a moment, row by row, rad."""
    meets = np.where(lever > 0.0, gap / np.where(lever > 0.0, lever, 1.0), np.inf)
    order = np.argsort(meets, axis=1)
    levers, gaps = np.take_along_axis(lever, order, 1), np.take_along_axis(gap, order, 1)
    # With the first k pins closed the rotation is one of these; the least is that where no further pin touches.
    carried = (moment + np.cumsum(levers * gaps, axis=1)) / np.cumsum(levers**2, axis=1)
    return np.asarray(carried.min(axis=1, keepdims=True))


def _most_torque(energy: FloatArray) -> float:
    """Sum of loads of the discs by their common rotation, :math:`1^T C^{-1} 1`, of those discs that are pressed."""
    pressed = np.arange(energy.shape[0])
    while True:
        load = np.linalg.solve(energy[np.ix_(pressed, pressed)], np.ones(pressed.size))
        if np.all(load >= 0.0):
            return float(load.sum())
        pressed = np.delete(pressed, np.argmin(load))


def wheel_pin_beam(drive: Drive) -> PinBeam | None:
    """Return a wheel pin as a beam, its middle at the zero of the planes; None where it does not bend."""
    wheel = drive.pin_wheel
    if wheel.beam is None:
        return None
    material = drive.materials.wheel_pin
    return PinBeam(
        span=drive.wheel_pin_span,
        ends=(wheel.beam.ends, wheel.beam.ends),
        diameter=wheel.beam_diameter,
        youngs_modulus=material.youngs_modulus,
        poisson_ratio=material.poisson_ratio,
    )


def shaft_pin_beam(drive: Drive) -> PinBeam | None:
    """Return a shaft pin as a beam, its middle at the zero of the planes; None where it is a spring or there is none."""
    shaft = drive.pin_shaft
    if shaft is None or shaft.beam is None:
        return None
    tips: dict[str, End] = {"free": "free", "tied-clamped": "clamped", "tied-pinned": "supported"}
    material = drive.materials.shaft_pin
    return PinBeam(
        span=drive.shaft_pin_span,
        ends=("clamped", tips[shaft.beam.tip]),
        diameter=shaft.beam_diameter,
        youngs_modulus=material.youngs_modulus,
        poisson_ratio=material.poisson_ratio,
    )


def from_start(beam: PinBeam, drive: Drive) -> FloatArray:
    """Return the planes of the discs from the start of a beam whose middle is at their zero, mm."""
    return np.asarray(drive.disc.disc_planes) + 0.5 * beam.span
