r"""Stiffness of rolling bearings in five directions, in closed form: rows with contact angles, alone or in pairs.

Every rolling element of a preloaded row presses along its contact normal, :math:`n = (\cos\alpha\cos\psi, \cos\alpha\sin\psi,
s\sin\alpha)`, through :math:`p = (R\cos\psi, R\sin\psi, z)`. Linearised about the preload all elements have one stiffness
:math:`k_n`, and the stiffness of the row is :math:`k_n \sum g g^T` with :math:`g = (n, p \times n)` (Jones, J. Basic Eng. 82
(1960) 309; Harris & Kotzalas, Essential Concepts of Bearing Technology, 5th ed., ch. 7 and 11; Lim & Singh, J. Sound Vib. 139
(1990) 179). The sums over the circle are those of :math:`\cos^2\psi` and :math:`\sin^2\psi`, Z/2 each:

.. math:: k_{xx} = \tfrac{Z}{2} k_n \cos^2\alpha, \quad k_{zz} = Z k_n \sin^2\alpha, \quad k_{x\theta_y} = k_{xx} h, \quad
          k_{y\theta_x} = -k_{xx} h, \quad k_{\theta\theta} = k_{xx} h^2, \qquad h = z - s R\tan\alpha,

with the place h of the pressure centre, where the contact normals meet the axis. The contact angle is taken as constant, and
centrifugal forces and gyroscopic moments are left out.

A bearing with clearance yields by nothing within it; a preloaded one has two sides, of which one lifts off. Both are one law
in series with a spring (`SideLaw`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import cos, inf, isfinite, sin, tan

import numpy as np

from ltca.arrays import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class RollingRow:
    """A row of rolling elements about its working point, by its stiffnesses, N/mm.

    `pressure_centre` is the place h where the contact normals meet the axis, mm, `reach` the radial displacement at which the
    elements opposite to the load lift off, mm, and `normal_load` the sum of the normal loads of all by the preload, N.
    """

    radial: float
    axial: float
    pressure_centre: float
    reach: float = inf
    normal_load: float = 0.0

    @classmethod
    def of_axial(
        cls, axial: float, contact_angle: float, *, plane: float = 0.0, pitch_radius: float = 0.0, facing: int = 1
    ) -> RollingRow:
        """Return the row with an axial stiffness, N/mm, a contact angle, rad, and the plane and radius of its contacts, mm.

        `facing` is the sign of the axial part of the normals by which it presses the outer ring: +1 towards +z.

        Examples
        --------
        >>> row = RollingRow.of_axial(1e5, np.pi / 4, plane=10.0, pitch_radius=30.0, facing=-1)
        >>> print(f"{row.radial:.1f} {row.pressure_centre:.1f}")
        50000.0 40.0
        """
        radial = 0.5 * axial * (cos(contact_angle) / sin(contact_angle)) ** 2
        return cls(radial=radial, axial=axial, pressure_centre=plane - facing * pitch_radius * tan(contact_angle))

    def pressed(self, contact_angle: float, force: float, displacement: float) -> RollingRow:
        """Return the row under an axial preload, N, that presses it in by a displacement, mm: elements by δ sin α, loads P/sin α
        together, and a radial displacement takes cos α of itself off the elements opposite to the load.

        Examples
        --------
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
    r"""A bearing in a radial direction: a spring in series with what it yields by its clearance, or when one side lifts off.

    Under a force R the ring is displaced by :math:`R/k + w` along R, with :math:`w = g` (anywhere within g at R = 0) and
    :math:`w = c\,(R - R_0)^+`.

    Attributes
    ----------
    stiffness : float
        k, N/mm.
    gap : float
        g, mm.
    lift_off : float
        R_0 at which one side lifts off, N.
    beyond : float
        c, mm/N: beyond lift-off the flexibility is 1/k + c.
    preload_load : float
        Sum of the loads of all elements at rest, N, by which a preloaded bearing rubs: of two sides twice the preload, of rows
        with contact angles Σ P/sin α.
    """

    stiffness: float
    gap: float = 0.0
    lift_off: float = 0.0
    beyond: float = 0.0
    preload_load: float = 0.0

    @classmethod
    def of_clearance(cls, side: float, clearance: float) -> SideLaw:
        """Return the law of a bearing whose side that carries has a stiffness, N/mm, by its diametral clearance, mm.

        A tight one (negative) has both sides carry, 2k, until one lifts off: loose and tight meet without a jump.
        """
        if clearance >= 0.0:
            return cls(stiffness=side, gap=0.5 * clearance)
        pressed = -side * clearance
        return cls(stiffness=2.0 * side, lift_off=pressed, beyond=0.5 / side, preload_load=pressed)

    @classmethod
    def of_preload(cls, both: float, force: float | None, displacement: float | None) -> SideLaw:
        """Return the law of a bearing that has a stiffness, N/mm, while both sides carry, by its preload, N or mm.

        Two sides of k/2 each, pressed together by P or by δ: one lifts off at 2P = kδ.
        """
        lift_off = both * displacement if displacement is not None else 2.0 * (force or 0.0)
        return cls(stiffness=both, lift_off=lift_off, beyond=1.0 / both, preload_load=lift_off)

    @classmethod
    def of_rows(cls, rows: Sequence[RollingRow]) -> SideLaw:
        """Return the law of rows side by side, of which at least one is preloaded.

        Preloaded ones lift off on one side and are half as stiff from there, others keep their stiffness. Rows with reaches δ_i
        of their own lift off together at the mean of these by the stiffness: force and stiffness are right before the first
        and beyond the last of them.

        Examples
        --------
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
