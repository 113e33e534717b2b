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
else yields in series with each disc decides between the two.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sqrt

import numpy as np

from ltca.arrays import FloatArray
from ltca.beam import End, PinBeam
from ltca.drive.parts import Drive


@dataclass(frozen=True, slots=True, kw_only=True)
class ShaftPinSpring:
    """Springs that the beams of shaft pins are equal to in torsion of the output, N/mm of one pin against one disc.

    Attributes
    ----------
    loaded_alike : float
        Where every disc carries the same torque.
    turned_alike : float
        Where every disc turns by the same angle, against the pins alone; no less than `loaded_alike`, equal for one disc.
    """

    loaded_alike: float
    turned_alike: float

    @property
    def stiffness(self) -> float:
        """Geometric mean of both to two digits, for ``pin_shaft.stiffness``."""
        return two_digits(sqrt(self.loaded_alike * self.turned_alike))


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
    410000.0
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
    discs = phase.size
    return ShaftPinSpring(
        loaded_alike=0.25 * pins * discs / float(energy.sum()),
        turned_alike=0.25 * pins / discs * _most_torque(energy),
    )


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
