"""Stiffness of rolling bearings in five directions, in closed form: rows with contact angles, alone or in pairs.

Linearised about the preload a row has k_n Σ g gᵀ, g = (n, p × n) (docs/how-to/supports.md; Jones, J. Basic Eng. 82 (1960) 309;
Harris & Kotzalas, Essential Concepts of Bearing Technology, 5th ed., ch. 7, 11; Lim & Singh, J. Sound Vib. 139 (1990) 179).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import cos, inf, isfinite, sin, tan

import numpy as np

from ltca.arrays import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class RollingRow:
    """A row of rolling elements about its working point, by its stiffnesses, N/mm."""

    radial: float
    axial: float
    pressure_centre: float  # h = z − s R tan α, s the `facing`, where the contact normals meet the axis, mm
    reach: float = inf  # radial displacement at which the elements opposite to the load lift off, mm
    normal_load: float = 0.0  # sum of the normal loads of all by the preload, N

    @classmethod
    def of_axial(
        cls, axial: float, contact_angle: float, *, plane: float = 0.0, pitch_radius: float = 0.0, facing: int = 1
    ) -> RollingRow:
        """Return the row with an axial stiffness, N/mm, and a contact angle, rad; `facing` +1 presses the outer ring towards +z.

        >>> row = RollingRow.of_axial(1e5, np.pi / 4, plane=10.0, pitch_radius=30.0, facing=-1)
        >>> print(f"{row.radial:.1f} {row.pressure_centre:.1f}")
        50000.0 40.0
        """
        radial = 0.5 * axial * (cos(contact_angle) / sin(contact_angle)) ** 2
        return cls(radial=radial, axial=axial, pressure_centre=plane - facing * pitch_radius * tan(contact_angle))

    def pressed(self, contact_angle: float, force: float, displacement: float) -> RollingRow:
        """Return the row under an axial preload P, N, with a displacement δ, mm: it lifts off at δ tan α, loads sum to P/sin α.

        >>> row = RollingRow.of_axial(1e5, np.pi / 4).pressed(np.pi / 4, 500.0, 0.005)
        >>> print(f"{row.reach:.4f} {row.normal_load:.1f}")
        0.0050 707.1
        """
        return replace(self, reach=displacement * tan(contact_angle), normal_load=force / sin(contact_angle))

    @property
    def matrix(self) -> FloatArray:
        """Forces and moments by displacements and tilts (x, y, z, θ_x, θ_y), N/mm, N, N·mm, shape (5, 5)."""
        h, found = self.pressure_centre, np.diag([self.radial, self.radial, self.axial, 0.0, 0.0])
        found[3, 3] = found[4, 4] = self.radial * h**2
        found[0, 4] = found[4, 0] = self.radial * h
        found[1, 3] = found[3, 1] = -self.radial * h
        return found


def bearing_matrix(rows: Sequence[RollingRow]) -> FloatArray:
    """Return the stiffness of all rows together, shape (5, 5), symmetric: see `RollingRow.matrix`."""
    return np.asarray(sum((row.matrix for row in rows), np.zeros((5, 5))))


def facing_of(arrangement: str, plane: float, middle: float) -> int:
    """Return how a row of a pair faces: in O arrangement the pressure centres lie outside of the rows, in X between them."""
    outward = 1 if plane > middle else -1
    return -outward if arrangement == "O" else outward


@dataclass(frozen=True, slots=True, kw_only=True)
class SideLaw:
    """A bearing in a radial direction: under a force R it yields R/k + w, w ≤ g at R = 0, w = g + c (R − R₀)⁺ beyond."""

    stiffness: float  # k, N/mm
    gap: float = 0.0  # g, mm
    lift_off: float = 0.0  # R₀, at which one side lifts off, N
    beyond: float = 0.0  # c, mm/N
    preload_load: float = 0.0  # sum of the loads of all elements at rest, by which it rubs, N

    @classmethod
    def of_clearance(cls, side: float, clearance: float) -> SideLaw:
        """Return the law of a bearing by the stiffness of a side, N/mm, and diametral clearance, mm; tight, both sides carry."""
        if clearance >= 0.0:
            return cls(stiffness=side, gap=0.5 * clearance)
        pressed = -side * clearance
        return cls(stiffness=2.0 * side, lift_off=pressed, beyond=0.5 / side, preload_load=pressed)

    @classmethod
    def of_preload(cls, both: float, force: float | None, displacement: float | None) -> SideLaw:
        """Return the law of two sides of k/2 each, N/mm, pressed together by P, N, or δ, mm: one lifts off at 2P = kδ."""
        lift_off = both * displacement if displacement is not None else 2.0 * (force or 0.0)
        return cls(stiffness=both, lift_off=lift_off, beyond=1.0 / both, preload_load=lift_off)

    @classmethod
    def of_rows(cls, rows: Sequence[RollingRow]) -> SideLaw:
        """Return the law of rows side by side, of which the preloaded ones lift off together at the mean of their reaches.

        >>> loaded = RollingRow(radial=1e5, axial=0.0, pressure_centre=0.0, reach=0.005, normal_load=800.0)
        >>> law = SideLaw.of_rows([loaded, RollingRow(radial=5e4, axial=0.0, pressure_centre=0.0)])
        >>> print(f"{law.lift_off:g} N, {1.0 / (1.0 / law.stiffness + law.beyond):g} N/mm beyond")
        750 N, 100000 N/mm beyond
        """
        stiffness, lifting = sum(row.radial for row in rows), [row for row in rows if isfinite(row.reach)]
        both = sum(row.radial for row in lifting)
        return cls(
            stiffness=stiffness,
            lift_off=stiffness * sum(row.radial * row.reach for row in lifting) / both,
            beyond=1.0 / (stiffness - 0.5 * both) - 1.0 / stiffness,
            preload_load=sum(row.normal_load for row in lifting),
        )
