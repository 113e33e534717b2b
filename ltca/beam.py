r"""Round shafts and pins as beams: their deflections at the planes of the discs under the forces of the discs.

A crankshaft on two elastic supports bends (Euler–Bernoulli; shear is left out) and twists. The deflection at z under a unit
force at s on a beam whose supports at 0 and L stand still is the fundamental solution :math:`|z-s|^3/12EI`, that of the
two reactions, and the rigid motion that brings the supports back to zero; elastic supports add their displacement along the
straight line between them. Overhanging ends are included.

A pin between two ends (Timoshenko's beam, shear coefficient of a round section by Cowper 1966): each disc presses evenly along
its thickness, and deflections are means along it, so that the flexibility is symmetric (Maxwell). Discs that tilt press with
moments as well, linearly along the thickness, and slopes are the means that these work along.
The deflection is the sum of fundamental solutions of forces :math:`|x|^3/12EI - |x|/2\kappa GA` and couples
:math:`x|x|/4EI`, and a rigid motion; forces and couples at the ends follow from equilibrium and from how the ends are held.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi
from typing import Literal

import numpy as np

from ltca.arrays import BoolArray, FloatArray

End = Literal["free", "supported", "clamped"]
GAUSS_POINTS, GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(4)


def shaft_flexibility(
    planes: Sequence[float],
    supports: tuple[float, float],
    stiffness: tuple[float, float],
    diameter: float,
    youngs_modulus: float,
    slopes: Sequence[float] = (),
) -> FloatArray:
    """Return deflections of a shaft at planes under unit forces at these planes, mm/N, symmetric, shape (planes, planes).

    Planes and the two supports are axial places in mm; `stiffness` is that of each support in N/mm, the diameter in mm, Young's
    modulus in MPa. Behind the planes come the places `slopes`, with the slope there under a unit force, 1/N, and what a
    unit couple does.

    Examples
    --------
    Mid-span of a beam on rigid supports yields by L³/48EI:

    >>> rigid = shaft_flexibility([0.0], (-10.0, 10.0), (1e30, 1e30), 10.0, 2e5)
    >>> bool(np.isclose(rigid[0, 0], 20.0**3 / (48.0 * 2e5 * pi * 10.0**4 / 64.0)))
    True
    """
    start, span = supports[0], supports[1] - supports[0]
    place = np.asarray([*planes, *slopes], dtype=float) - start
    turned = np.arange(place.size) >= len(planes)
    parts = support_parts(planes, supports, slopes)
    ends, still = np.array([0.0, span]), np.zeros(2, dtype=bool)

    def cubes(at: FloatArray, slope: BoolArray) -> FloatArray:
        """|z − s|³ less those of the reactions, by z and s; its derivative by z, by s or by both where slopes are asked for."""
        reactions = _cubes(at, slope, ends, still) @ parts
        return np.asarray(_cubes(at, slope, place, turned) - reactions)

    bent = cubes(place, turned) - np.einsum("ez,es->zs", parts, cubes(ends, still))
    bent /= 12.0 * youngs_modulus * pi * diameter**4 / 64.0
    yielding = np.einsum("ez,es,e->zs", parts, parts, 1.0 / np.asarray(stiffness, dtype=float))
    return np.asarray(0.5 * (bent + bent.T) + yielding)


def support_parts(planes: Sequence[float], supports: tuple[float, float], slopes: Sequence[float] = ()) -> FloatArray:
    """Return the part of a force at each plane that each of two supports carries, and of a couple at each place in `slopes`,
    1/mm, shape (2, planes + slopes).
    """
    start, span = supports[0], supports[1] - supports[0]
    far = (np.asarray(planes, dtype=float) - start) / span
    of_couples = np.full(len(slopes), 1.0 / span)
    return np.stack((np.append(1.0 - far, -of_couples), np.append(far, of_couples)))


def _cubes(at: FloatArray, slope: BoolArray, place: FloatArray, turned: BoolArray) -> FloatArray:
    """|z − s|³ by z and s, or its derivatives by z (`slope`) and by s (`turned`)."""
    apart = at[:, None] - place
    size = np.abs(apart)
    once = 3.0 * apart * size
    by_z, by_s = np.broadcast_arrays(slope[:, None], turned)
    return np.where(by_z & by_s, -6.0 * size, np.where(by_z, once, np.where(by_s, -once, size**3)))


def torsion_flexibility(planes: Sequence[float], held: float, diameter: float, shear_modulus: float) -> FloatArray:
    """Return twists of a round shaft at planes under unit moments at these planes, rad/(N·mm), shape (planes, planes).

    It is held against turning at an axial place, mm: moments on its other side twist nothing. Planes and diameter in mm, the
    shear modulus in MPa.

    Examples
    --------
    L/GJ at the end of a shaft, and half of it in the middle:

    >>> found = torsion_flexibility([10.0, 20.0], 0.0, 10.0, 8e4) * 8e4 * pi * 10.0**4 / 32.0
    >>> found.round(9).tolist()
    [[10.0, 10.0], [10.0, 20.0]]
    """
    away = np.asarray(planes, dtype=float) - held
    same_side = np.sign(away[:, None]) == np.sign(away)
    common = np.where(same_side, np.minimum(np.abs(away[:, None]), np.abs(away)), 0.0)
    return np.asarray(common / (shear_modulus * pi * diameter**4 / 32.0))


@dataclass(frozen=True, slots=True, kw_only=True)
class PinBeam:
    """A round pin as a beam from 0 to its span.

    Planes are the middles of the discs from the start of the pin and `width` is the thickness of each disc, both in mm.

    Attributes
    ----------
    span : float
        mm.
    ends : tuple of {"free", "supported", "clamped"}
        How each end is held: not at all, free to turn, not free to turn.
    diameter : float
        mm.
    youngs_modulus : float
        MPa.
    poisson_ratio : float or None
        None for a beam that bends only, without shear.
    """

    span: float
    ends: tuple[End, End]
    diameter: float
    youngs_modulus: float
    poisson_ratio: float | None = None

    def flexibility(self, planes: Sequence[float], width: float, *, slopes: bool = False) -> FloatArray:
        """Return mean deflections along each disc under unit forces of the discs, mm/N, symmetric, shape (discs, discs).

        With `slopes` the mean slopes of all discs follow, and behind the forces the moments of the discs, (2 discs, 2 discs).
        A moment presses linearly along the thickness, 12 M z/w³, and the mean slope is what it works along, 12/w³ ∫ y z dz:
        1/N, and 1/(N·mm).

        Examples
        --------
        Mid-span of a supported pin yields by L³/48EI under a force on a very thin disc:

        >>> pin = PinBeam(span=20.0, ends=("supported", "supported"), diameter=10.0, youngs_modulus=2e5)
        >>> found = pin.flexibility([10.0], 1e-3)[0, 0]
        >>> bool(np.isclose(found, 20.0**3 / (48.0 * 2e5 * pi * 10.0**4 / 64.0)))
        True
        """
        middle = np.asarray(planes, dtype=float)
        if slopes:
            return self._with_slopes(middle, width)
        held = self._held(middle, width)
        apart = middle[:, None] - middle
        own = sum(sign * self._integral(apart + shift, 2) for sign, shift in ((1, width), (-2, 0.0), (1, -width)))
        found = own / width**2 + self._bent(held, middle, width)
        return np.asarray(0.5 * (found + found.T))

    def _with_slopes(self, middle: FloatArray, width: float) -> FloatArray:
        """The flexibility with slopes behind deflections and moments behind forces."""
        count = middle.size
        z, weights = _points(np.zeros((count, count)), width)
        apart = (middle[:, None] - middle)[..., None, None] + z[..., :, None] - z[..., None, :]
        own = np.einsum("aijz,bijs,ijzs->aibj", weights, weights, self._integral(apart, 0))
        itself = np.arange(count)
        own[:, itself, :, itself] = np.diag(self._alone(width))
        around = self._around(middle, width)
        found = own.reshape(2 * count, -1) + around.reshape(2 * count, 6) @ self._held_with_moments(middle, width)
        return np.asarray(0.5 * (found + found.T))

    def _alone(self, width: float) -> FloatArray:
        """What force and moment of a disc do to its own deflection and slope without ends: integrals of |z − s|³ and |z − s|."""
        bending, shear = self._rigidity
        of_force = width**3 / (120.0 * bending) - width / (6.0 * shear)
        of_moment = -9.0 * width / (70.0 * bending) + 6.0 / (5.0 * width * shear)
        return np.array([of_force, of_moment])

    def _around(self, middle: FloatArray, width: float) -> FloatArray:
        """Mean deflection and mean slope along each disc by forces, couples and rigid motion of the ends, shape (2, discs, 6)."""
        columns = []
        for end in (0.0, self.span):
            z, weights = _points(end - middle, width)
            apart = middle[:, None] + z - end
            columns.append(np.einsum("aiz,iz->ai", weights, self._integral(apart, 0)))
            columns.append(np.einsum("aiz,iz->ai", weights, self._turn(apart)))
        still, turned = np.zeros((2, middle.size)), np.zeros((2, middle.size))
        still[0], turned[0], turned[1] = 1.0, middle, 1.0
        return np.stack([*columns, still, turned], axis=-1)

    def _held_with_moments(self, middle: FloatArray, width: float) -> FloatArray:
        """Forces and couples of the ends and the rigid motion under unit forces, then unit moments, of the discs."""
        right = np.zeros((6, 2, middle.size))
        right[0, 0], right[1, 0], right[1, 1] = -1.0, -middle, -1.0
        for number, kind in enumerate(self.ends):
            end = self.span * number
            z, weights = _points(end - middle, width)
            apart = end - middle[:, None] - z
            if kind != "free":
                right[2 + 2 * number] = -np.einsum("aiz,iz->ai", weights, self._integral(apart, 0))
            if kind == "clamped":
                right[3 + 2 * number] = -np.einsum("aiz,iz->ai", weights, self._turn(apart))
        return np.asarray(np.linalg.solve(self._conditions(), right.reshape(6, -1)))

    def deflection(self, at: float, middle: float, width: float) -> float:
        """Return the deflection at one place under a unit force spread evenly over `width` about another, mm/N."""
        held = self._held(np.array([middle]), width)
        own = self._mean(np.array([at - middle]), width)
        return float((own + self._point(np.array([at]))[:, :6] @ held)[0, 0])

    def tip_shape(self, planes: Sequence[float], width: float, *, slopes: bool = False) -> FloatArray:
        """Return the mean displacement along each disc when the far end is moved by one, shape (discs,).

        By reciprocity it is also the share of the force of each disc that the far end carries. With `slopes` mean slopes follow,
        1/mm, the shares of moments.
        """
        middle = np.asarray(planes, dtype=float)
        held = self._held_with_moments(middle, width) if slopes else self._held(middle, width)
        return np.asarray(-held[2])

    def moments(self, at: FloatArray, planes: Sequence[float], width: float, *, slopes: bool = False) -> FloatArray:
        """Return bending moments at places under unit forces of the discs, mm, shape (places, discs + 1).

        Places are in mm from the start of the pin. The last column is the moment when the far end is moved by one, N (by mm).
        With `slopes` those under unit moments of the discs stand before it.

        Examples
        --------
        >>> pin = PinBeam(span=20.0, ends=("supported", "supported"), diameter=10.0, youngs_modulus=2e5)
        >>> print(f"{abs(pin.moments(np.array([10.0]), [10.0], 1e-3)[0, 0]):.3f}")  # F L/4
        5.000
        """
        held, low, high = self._internal(planes, width, slopes)
        place = np.asarray(at, dtype=float)[:, None]
        covered = np.clip(place - low, 0.0, high - low)
        spread, discs = np.zeros((place.shape[0], held.shape[1])), low.size
        spread[:, :discs] = covered * (place - low - 0.5 * covered) / width
        if slopes:
            above, half = covered - 0.5 * width, 0.5 * width
            turned = 6.0 * (place - low - half) * (above**2 - half**2) - 4.0 * (above**3 + half**3)
            spread[:, discs:-1] = turned / width**3
        return np.asarray(held[0] * place + held[1] + spread)

    def shears(self, at: FloatArray, planes: Sequence[float], width: float, *, slopes: bool = False) -> FloatArray:
        """Return shear forces as `moments` returns moments: N by N, 1/mm by N·mm, and N/mm for the far end."""
        held, low, high = self._internal(planes, width, slopes)
        place = np.asarray(at, dtype=float)[:, None]
        covered = np.clip(place - low, 0.0, high - low)
        spread, discs = np.zeros((place.shape[0], held.shape[1])), low.size
        spread[:, :discs] = covered / width
        if slopes:
            spread[:, discs:-1] = 6.0 * covered * (covered - width) / width**3
        return np.asarray(held[0] + spread)

    def _internal(
        self, planes: Sequence[float], width: float, slopes: bool
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Forces and couples of the ends, for each disc and for the far end moved by one; start and end of each force."""
        middle, moved = np.asarray(planes, dtype=float), np.zeros(6)
        moved[4] = 1.0
        tip = np.linalg.solve(self._conditions(), moved) if self.ends[1] != "free" else np.zeros(6)
        own = self._held_with_moments(middle, width) if slopes else self._held(middle, width)
        held = np.concatenate([own, tip[:, None]], axis=1)
        return held, middle - 0.5 * width, middle + 0.5 * width

    @property
    def tip_stiffness(self) -> float:
        """Force that moves the far end by one when no disc presses, N/mm."""
        matrix, moved = self._conditions(), np.zeros(6)
        moved[4] = 1.0
        return float(np.linalg.solve(matrix, moved)[2])

    @property
    def _rigidity(self) -> tuple[float, float]:
        """EI, N·mm², and κGA, N; infinite without shear."""
        bending = self.youngs_modulus * pi * self.diameter**4 / 64.0
        if self.poisson_ratio is None:
            return bending, np.inf
        factor = 6.0 * (1.0 + self.poisson_ratio) / (7.0 + 6.0 * self.poisson_ratio)
        return bending, factor * self.youngs_modulus / (2.0 * (1.0 + self.poisson_ratio)) * pi * self.diameter**2 / 4.0

    def _integral(self, x: FloatArray, times: int) -> FloatArray:
        """Fundamental solution of a unit force, integrated `times` times by x."""
        bending, shear = self._rigidity
        cubic, line = ((3, 1), (4, 2), (5, 3))[times]
        over, under = ((12.0, 2.0), (48.0, 4.0), (240.0, 12.0))[times]
        size, sign = np.abs(x), np.sign(x) ** times
        return np.asarray(sign * (size**cubic / (over * bending) - size**line / (under * shear)))

    def _mean(self, x: FloatArray, width: float) -> FloatArray:
        """Fundamental solution at x of a unit force spread evenly over a width, as a column."""
        spread = self._integral(x + 0.5 * width, 1) - self._integral(x - 0.5 * width, 1)
        return np.asarray(spread[:, None] / width)

    def _turn(self, x: FloatArray) -> FloatArray:
        """Rotation of the section at x by a unit force."""
        return np.asarray(x * np.abs(x) / (4.0 * self._rigidity[0]))

    def _point(self, at: FloatArray) -> FloatArray:
        """Deflection at places by (force, couple) at the start, the same at the far end, and a + b z."""
        columns = [column for end in (0.0, self.span) for column in (self._integral(at - end, 0), self._turn(at - end))]
        return np.stack([*columns, np.ones_like(at), at], axis=1)

    def _bent(self, held: FloatArray, middle: FloatArray, width: float) -> FloatArray:
        """Mean deflection along each disc due to the forces, couples and rigid motion of the ends."""
        low, high = middle - 0.5 * width, middle + 0.5 * width
        columns = []
        for end in (0.0, self.span):
            columns.append((self._integral(high - end, 1) - self._integral(low - end, 1)) / width)
            bend = np.abs(high - end) ** 3 - np.abs(low - end) ** 3
            columns.append(bend / (12.0 * self._rigidity[0] * width))
        return np.asarray(np.stack([*columns, np.ones_like(middle), middle], axis=1) @ held)

    def _conditions(self) -> FloatArray:
        """Equations of the ends' forces and couples and of the rigid motion: balance, then two for each end."""
        ends = np.array([0.0, self.span])
        matrix = np.zeros((6, 6))
        matrix[0, [0, 2]] = 1.0
        matrix[1] = [0.0, -1.0, self.span, -1.0, 0.0, 0.0]
        deflection = self._point(ends)
        rotation = np.zeros((2, 6))
        for number, end in enumerate(ends):
            rotation[:, 2 * number] = self._turn(ends - end)
            rotation[:, 2 * number + 1] = np.abs(ends - end) / (2.0 * self._rigidity[0])
        rotation[:, 5] = 1.0
        for number, kind in enumerate(self.ends):
            row = 2 + 2 * number
            matrix[row : row + 2] = deflection[number], rotation[number]
            if kind == "free":
                matrix[row] = np.eye(6)[2 * number]
            if kind != "clamped":
                matrix[row + 1] = np.eye(6)[2 * number + 1]
        return matrix

    def _held(self, middle: FloatArray, width: float) -> FloatArray:
        """Forces and couples of the ends and the rigid motion under a unit force on each disc, shape (6, discs)."""
        right = np.zeros((6, middle.size))
        right[0], right[1] = -1.0, -middle
        for number, kind in enumerate(self.ends):
            end = self.span * number
            if kind != "free":
                right[2 + 2 * number] = -self._mean(end - middle, width)[:, 0]
            if kind == "clamped":
                low, high = end - middle - 0.5 * width, end - middle + 0.5 * width
                turned = (np.abs(high) ** 3 - np.abs(low) ** 3) / (12.0 * self._rigidity[0] * width)
                right[3 + 2 * number] = -turned
        return np.asarray(np.linalg.solve(self._conditions(), right))


def _points(kink: FloatArray, width: float) -> tuple[FloatArray, FloatArray]:
    """Places along discs about their middles, and weights there of a unit force and of a unit moment.

    What is integrated is a polynomial on either side of a kink at `kink`, shape (…); places have the shape (…, 8), weights
    (2, …, 8).
    """
    split = np.clip(kink, -0.5 * width, 0.5 * width)[..., None]
    below, above = 0.5 * (split + 0.5 * width), 0.5 * (0.5 * width - split)
    places = np.concatenate((split - below + below * GAUSS_POINTS, split + above + above * GAUSS_POINTS), axis=-1)
    even = np.concatenate((below * GAUSS_WEIGHTS, above * GAUSS_WEIGHTS), axis=-1) / width
    return places, np.stack((even, even * 12.0 * places / width**2))
