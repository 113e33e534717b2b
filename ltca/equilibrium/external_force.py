"""Forces and moments from outside on the output: an arm, a pulley, the weight of what it carries.

With the pin shaft held the output is the wheel. With the wheel held it is the pin shaft, whose frame is that of the analysis: the
housing turns in it by φ_C/u, and a force on the shaft acts on the wheel, relative to the shaft, the other way.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ltca.arrays import ComplexArray, FloatArray, by_drive
from ltca.drive.parts import Drive, ExternalLoad
from ltca.geometry.rotation import unit


@dataclass(frozen=True, slots=True, kw_only=True)
class ExternalForce:
    """Force in the plane of the discs on the wheel, relative to the pin shaft.

    Attributes
    ----------
    still : complex
        At rest in the frame of the pin shaft, x + iy, N.
    turning : complex
        Turning with the wheel by φ_C/u, as it stands at φ_C = 0, N.
    reduction_ratio : float
        u.
    """

    still: ComplexArray = by_drive(1)
    turning: ComplexArray = by_drive(1)
    reduction_ratio: float

    @classmethod
    def of_drive(cls, drive: Drive) -> ExternalForce | None:
        """Return the forces of a drive; None where there are none."""
        if not drive.load.external:
            return None
        sums = {
            frame: np.array([sum((complex(one.force.x, one.force.y) for one in entries_of(drive, frame)), 0j)])
            for frame in ("housing", "output")
        }
        if drive.wheel_is_held:
            still, turning = -sums["output"], -sums["housing"]
        else:
            still, turning = sums["housing"], sums["output"]
        return cls(still=still, turning=turning, reduction_ratio=drive.reduction_ratio)

    def on_wheel(self, crank_angle: FloatArray) -> ComplexArray:
        """Return the force at crank angles, in the frame of the pin shaft, N, shape (positions,)."""
        return np.asarray(self.still[..., 0] + self.turning[..., 0] * unit(crank_angle / self.reduction_ratio))


def entries_of(drive: Drive, frame: str) -> list[ExternalLoad]:
    """Return the entries of ``[[load.external]]`` that are given in a frame."""
    return [entry for entry in drive.load.external if entry.frame == frame]
