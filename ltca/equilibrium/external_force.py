"""Forces and moments from outside on the output: an arm, a pulley, the weight of what it carries."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ltca.arrays import ComplexArray, FloatArray, by_drive
from ltca.drive.parts import Drive, ExternalLoad
from ltca.geometry.rotation import unit


@dataclass(frozen=True, slots=True, kw_only=True)
class ExternalForce:
    """Force in the plane on the wheel against the pin shaft, x + iy, N, and on the lean of the wheel, z F − i M, N·mm."""

    still: ComplexArray = by_drive(1)  # in the frame of the pin shaft
    turning: ComplexArray = by_drive(1)  # turns with the wheel by φ_C/u; at φ_C = 0
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
        # With the wheel held the output is the pin shaft, and its forces act on the wheel, relative to it, the other way.
        still, turning = (-output, -housing) if drive.wheel_is_held else (housing, output)
        return cls(still=still, turning=turning, reduction_ratio=drive.reduction_ratio)

    def on_wheel(self, crank_angle: FloatArray) -> ComplexArray:
        """Return the force at crank angles, in the frame of the pin shaft, N, and on the lean, N·mm, shape (positions, 2)."""
        return np.asarray(self.still + self.turning * unit(crank_angle / self.reduction_ratio)[:, None])


def _pressing(load: ExternalLoad) -> ComplexArray:
    """Force in the plane, N, and on a lean, N·mm; forces along the axis press none."""
    force = complex(load.force.x, load.force.y)
    return np.array([force, load.at.z * force - 1j * complex(load.moment.x, load.moment.y)])


def entries_of(drive: Drive, frame: str) -> list[ExternalLoad]:
    """Return the entries of ``[[load.external]]`` that are given in a frame."""
    return [entry for entry in drive.load.external if entry.frame == frame]
