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
    """Force in the plane of the discs on the wheel, relative to the pin shaft, x + iy, N, and what presses the lean of the wheel,
    z F − i M of forces at z and moments M = M_x + i M_y, N·mm.

    One pair stands still in the frame of the pin shaft, one turns with the wheel by φ_C/u from where it is at φ_C = 0.
    """

    still: ComplexArray = by_drive(1)
    turning: ComplexArray = by_drive(1)
    reduction_ratio: float

    @classmethod
    def of_drive(cls, drive: Drive) -> ExternalForce | None:
        """Return the forces of a drive; None where there are none."""
        if not drive.load.external:
            return None
        housing, output = (
            sum((_pressing(one) for one in entries_of(drive, frame)), np.zeros(2, dtype=complex))
            for frame in ("housing", "output")
        )
        still, turning = (-output, -housing) if drive.wheel_is_held else (housing, output)
        return cls(still=still, turning=turning, reduction_ratio=drive.reduction_ratio)

    def on_wheel(self, crank_angle: FloatArray) -> ComplexArray:
        """Return the force at crank angles, in the frame of the pin shaft, N, and what presses the lean, N·mm, (positions, 2)."""
        return np.asarray(self.still + self.turning * unit(crank_angle / self.reduction_ratio)[:, None])


def _pressing(load: ExternalLoad) -> ComplexArray:
    """Force in the plane, N, and what presses a lean, N·mm; forces along the axis act on it and press none."""
    force = complex(load.force.x, load.force.y)
    return np.array([force, load.at.z * force - 1j * complex(load.moment.x, load.moment.y)])


def entries_of(drive: Drive, frame: str) -> list[ExternalLoad]:
    """Return the entries of ``[[load.external]]`` that are given in a frame."""
    return [entry for entry in drive.load.external if entry.frame == frame]
