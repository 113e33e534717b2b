"""The crown of the flank that takes the load off the ends of the contacts: the one with the least largest pressure anywhere."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ltca.analysis.loaded_analysis import analyse, analyse_cases
from ltca.arrays import FloatArray
from ltca.drive.parts import Drive
from ltca.errors import ConvergenceError
from ltca.geometry.placement import position_angles
from ltca.reading.changes import with_fields

FIELD = "disc.lead_crown_drop"
POSITIONS = 12
"""Positions of a turn at which pressures are compared."""
OFFSET = 1e-3
LADDER = (0.0, 0.125, 0.25, 0.5, 1.0, 2.0, 4.0)
"""Crowns tried first, by the largest approach of the contacts."""
WORTHWHILE = 0.02
"""Part of the pressure below which a crown takes off too little to be told."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LeadCrown:
    """What a crown of the flank does.

    Attributes
    ----------
    drop : float
        At the ends, mm.
    now : float
        Drop of the drive as it is, mm.
    pressure, pressure_now : float
        Largest pressure of the flank anywhere with that drop and as it is, MPa.
    """

    drop: float
    now: float
    pressure: float
    pressure_now: float

    @property
    def words(self) -> str:
        """What to say of it; empty where it is not worth the change."""
        if self.pressure > (1.0 - WORTHWHILE) * self.pressure_now:
            return ""
        return (
            f"{FIELD}: {self.now:.3g} → {self.drop:.3g} mm takes the largest flank pressure anywhere along the width from "
            f"{self.pressure_now:.4g} to {self.pressure:.4g} MPa, the least by a crown (half-spaces, {POSITIONS} positions)"
        )


def best_lead_crown(drive: Drive, torque: float) -> LeadCrown | None:
    """Return the crown of the flank with the least largest pressure at an output torque, N·mm; None where nothing balances.

    A ladder of drops, then twice the middles between the best and its neighbours.
    """
    angle = position_angles(POSITIONS) + OFFSET
    now = drive.disc.lead_crown_drop
    try:
        near = analyse(drive, angle, torque)
    except ConvergenceError:
        return None
    pressures = {now: float(np.max(near.pressures.pins.largest))}
    deepest = float(np.max(near.full.response.flank.approach))
    _try(drive, [part * deepest for part in LADDER], torque, angle, pressures)
    for _ in range(2):
        drops = np.array(sorted(pressures))
        best = int(np.argmin([pressures[drop] for drop in drops.tolist()]))
        low, high = drops[max(best - 1, 0)], drops[min(best + 1, drops.size - 1)]
        _try(drive, [0.5 * (low + drops[best]), 0.5 * (drops[best] + high)], torque, angle, pressures)
    least = min(pressures, key=lambda drop: pressures[drop])
    return LeadCrown(drop=least, now=now, pressure=pressures[least], pressure_now=pressures[now])


def _try(drive: Drive, drops: Sequence[float], torque: float, angle: FloatArray, pressures: dict[float, float]) -> None:
    """Add the largest pressures at some drops, of drives that balance."""
    drives = {f"{drop:.17g}": with_fields(drive, {FIELD: drop}) for drop in drops if drop not in pressures}
    for name, found in analyse_cases(drives, angle, torque):
        if not isinstance(found, ConvergenceError):
            pressures[float(name)] = float(np.max(found.pressures.pins.largest))
