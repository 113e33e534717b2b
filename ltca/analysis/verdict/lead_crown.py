"""The crown of the flank that takes the load off the ends of the contacts: the one with the least largest pressure anywhere."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from math import inf

import numpy as np

from ltca.analysis.loaded_analysis import analyse, analyse_cases
from ltca.arrays import FloatArray
from ltca.compliance.response import ContactPressures
from ltca.drive.parts import Drive
from ltca.drive.single_discs import single_discs
from ltca.errors import ConvergenceError, DriveError
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


def best_lead_crown(
    drive: Drive, torque: float, within: tuple[float, float] = (0.0, inf), most_mid: float = inf
) -> LeadCrown | None:
    """Return the crown of the flank with the least largest pressure at an output torque, N·mm; None where nothing balances, and
    where discs have crowns that differ.

    A ladder of drops, then twice the middles between the best and its neighbours; only drops `within` two, mm, are tried. Crowns
    press the middle of the line more: those beyond `most_mid` there, MPa, are taken only where none is below.
    """
    angle = position_angles(POSITIONS) + OFFSET
    of_discs = {single.disc.lead_crown_drop for single in single_discs(drive)}
    if len(of_discs) > 1:
        return None
    (now,) = of_discs
    try:
        near = analyse(drive, angle, torque)
    except ConvergenceError:
        return None
    pressures = {now: _largest_and_mid(near.pressures)}

    def worth(drop: float) -> tuple[float, float]:
        largest, mid = pressures[drop]
        return max(mid - most_mid, 0.0), largest

    deepest = float(np.max(near.full.response.flank.approach))
    _try(drive, sorted({float(np.clip(part * deepest, *within)) for part in LADDER}), torque, angle, pressures)
    for _ in range(2):
        drops = np.array(sorted(pressures))
        best = int(np.searchsorted(drops, min(pressures, key=worth)))
        low, high = drops[max(best - 1, 0)], drops[min(best + 1, drops.size - 1)]
        _try(drive, [0.5 * (low + drops[best]), 0.5 * (drops[best] + high)], torque, angle, pressures)
    least = min(pressures, key=worth)
    return LeadCrown(drop=least, now=now, pressure=pressures[least][0], pressure_now=pressures[now][0])


def _largest_and_mid(pressures: ContactPressures) -> tuple[float, float]:
    """Largest pressures of the flank anywhere and at mid-width, MPa."""
    return float(np.max(pressures.pins.largest)), float(np.nanmax(pressures.pins.mid))


def _try(
    drive: Drive, drops: Sequence[float], torque: float, angle: FloatArray, pressures: dict[float, tuple[float, float]]
) -> None:
    """Add the largest pressures at some drops, of drives that balance."""
    drives = {}
    for drop in drops:
        if drop not in pressures:
            with suppress(DriveError):  # beyond the bound of the field
                drives[f"{drop:.17g}"] = _crowned(drive, drop)
    groups = [drives]
    while groups:
        group = groups.pop()
        try:
            for name, found in analyse_cases(group, angle, torque):
                if not isinstance(found, ConvergenceError):
                    pressures[float(name)] = _largest_and_mid(found.pressures)
        except DriveError:  # contacts too wide for their bodies: one of the crowns is no choice
            groups += [{name: each} for name, each in group.items()] if len(group) > 1 else []


def _crowned(drive: Drive, drop: float) -> Drive:
    """The drive with a crown of all its discs."""
    own = [number for number, one in enumerate(drive.disc.of, start=1) if one.lead_crown_drop is not None]
    return with_fields(drive, {FIELD: drop} | {f"disc.of.{number}.lead_crown_drop": drop for number in own})
