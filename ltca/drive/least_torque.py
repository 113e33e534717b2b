"""The least torque of a drive that can be balanced.

Approaches of contacts are differences of places on the pin circle, known to its round-off. Times the stiffness of a contact this
is a force; a load that is not much larger has no answer.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import pi

import numpy as np

from ltca.drive.parts import Drive, contact_modulus
from ltca.errors import Problem

ROUND_OFF = 4.0 * np.finfo(float).eps
"""Round-off of an approach as a part of the pin circle radius; times the stiffness it bounds the residual below."""
ROUND_OFF_BOUND = 1e-5
"""Largest residual accepted on account of round-off, as a part of the load: beyond it there is no answer."""


def least_torque(drive: Drive) -> float:
    """Return the least output torque that can be balanced, N·mm: 1.9e-7 to 4.9e-7 of the torque of shipped drives.

    At it the round-off of one wheel pin, of a line of contact of stiffness π E* t/10 (Palmgren), is `ROUND_OFF_BOUND` of the load
    of the eccentric T/(e u). Where a drive carries anything, one pin touches at least. Shaft pins whose tips are tied add the
    stiffness 12 E I/L³ of one of them against the ring: of thick pins in discs of plastics it is far above that of contacts.
    """
    stiffness = pi * contact_modulus(drive.materials.disc, drive.flank_pin) * drive.disc.thickness / 10.0
    residual = ROUND_OFF * drive.pin_wheel.pin_circle_radius * (stiffness + _tied_stiffness(drive))
    return float(residual / ROUND_OFF_BOUND * drive.crank.eccentricity * abs(drive.reduction_ratio))


def _tied_stiffness(drive: Drive) -> float:
    """Stiffness of a shaft pin between the flange and the ring that ties the tips, N/mm; 0 where none does."""
    shaft = drive.pin_shaft
    if shaft is None or shaft.beam is None or shaft.beam.tip == "free":
        return 0.0
    inertia = pi * shaft.beam_diameter**4 / 64.0
    return 12.0 * drive.materials.shaft_pin.youngs_modulus * inertia / drive.shaft_pin_span**3


def torque_problem(drive: Drive, path: str, torque: float, *, zero: bool, shown: str = "") -> Iterator[Problem]:
    """Yield what is wrong with a torque that is too small to be balanced, N·mm; `zero` tells whether it may be 0.

    It is called `shown` in the sentence, by default by its path.
    """
    least = least_torque(drive)
    if 0.0 < torque < least:
        yield Problem.of(
            path,
            f"= {torque:g} N·mm",
            f"must be {'0 or ' if zero else ''}at least {least:.2g} N·mm in this drive: below, the round-off "
            f"of the pin circle radius is more than {ROUND_OFF_BOUND:g} of the loads",
            shown=shown,
            bound=("at least", least),
        )
