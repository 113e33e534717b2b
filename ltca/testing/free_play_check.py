"""Free play against the loaded model at a millionth of the torque, which knows nothing of linear programmes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ltca.analysis.engines import HalfSpace
from ltca.drive.members.temperatures import warm_drive
from ltca.drive.parts import Drive
from ltca.drive.units.quantities import ARCMIN
from ltca.equilibrium.output_torque import solve_at_output
from ltca.equilibrium.reducer import geometries, with_friction
from ltca.errors import ConvergenceError
from ltca.geometry.coordinates import WHEEL_ANGLE
from ltca.geometry.play import free_play, largest_overlap
from ltca.testing.practical_drives import practical_drive

FloatArray = NDArray[np.float64]

PARTS = (1e-6, 1e-5, 1e-4)
"""Parts of the torque, the next where one is too little to be balanced."""
BESIDE = 1.1
"""From the crank angle of the drive to the second one, rad."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """Free play and what the loaded model turns at one crank angle.

    Attributes
    ----------
    outcome : {"alike", "settling", "preloaded", "not balanced", "wrong"}
        Settling: beyond 1 % and 0.005′, by no more than the overlaps under that load allow.
    free, loaded, yielding : float
        Of the output, arcmin: free, between the torques, and free with those overlaps.
    part : float
        Of the torque.
    """

    outcome: str
    free: float
    loaded: float = np.nan
    yielding: float = np.nan
    part: float = np.nan

    @property
    def difference(self) -> float:
        """Between loaded and free play, arcmin."""
        return abs(self.loaded - self.free)


def compare_with_load(seed: int) -> list[Comparison]:
    """Return the comparisons of the practical drive of a seed at two crank angles.

    Parameters
    ----------
    seed : int
        Of `ltca.testing.practical_drives.practical_drive`.
    """
    drive, angle = practical_drive(seed)
    return compare(drive, np.array([angle, angle + BESIDE]))


def compare(drive: Drive, crank_angle: FloatArray) -> list[Comparison]:
    """Return the comparisons of a drive at crank angles.

    Parameters
    ----------
    drive : Drive
        As it is written.
    crank_angle : array, shape (positions,)
        φ_C, rad.
    """
    drive = warm_drive(drive)
    model = with_friction(HalfSpace().prepare(drive).model, None)
    discs, scale = geometries(model), abs(drive.output_per_wheel_angle) * ARCMIN
    found = free_play(discs, crank_angle)
    answers, own = [], model.coordinates.own
    for row, angle in enumerate(crank_angle):
        free = float(found.play[row]) * scale
        if found.preloaded[row]:
            answers.append(Comparison(outcome="preloaded", free=free))
            continue
        for part in PARTS:
            torque = part * drive.load.torque * np.array([1.0, -1.0])
            try:
                loaded = solve_at_output(model, drive, np.full(2, angle), torque)
            except ConvergenceError:
                continue
            turned = abs(float(np.diff(loaded.pose[:, WHEEL_ANGLE])[0])) * scale
            overlap = np.max(
                [
                    largest_overlap(disc, np.full(2, angle), loaded.pose[:, np.append(np.arange(3) + own * number, -1)])
                    for number, disc in enumerate(discs)
                ]
            )
            yielding = float(free_play(discs, np.array([angle]), overlap=float(overlap)).play[0]) * scale
            outcome = "wrong"
            if abs(turned - free) <= max(0.005, 0.01 * turned):
                outcome = "alike"
            elif free - 1e-3 <= turned <= yielding + 1e-3:
                outcome = "settling"
            answers.append(Comparison(outcome=outcome, free=free, loaded=turned, yielding=yielding, part=part))
            break
        else:
            answers.append(Comparison(outcome="not balanced", free=free))
    return answers
