r"""Deviation of the flank from its design along the design normal, δ(θ), with two derivatives.

It is the sum of harmonics, :math:`\delta = \mathrm{Re} \sum_k (a_k - i b_k) e^{ik\theta}`, and of a periodic cubic spline
through measured points (twice continuously differentiable, so contact and its tangent are continuous).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from ltca.arrays import ComplexArray, FloatArray, by_drive
from ltca.drive.deviations import ProfileErrors
from ltca.geometry.rotation import integer_power


@dataclass(frozen=True, slots=True, kw_only=True)
class ProfileDeviation:
    """Deviation of one flank, or of the flanks of a batch.

    Attributes
    ----------
    orders, amplitudes : tuple of int, array of complex, shape (orders,) or (positions, orders)
        Waves around the disc, and a − i b of each, mm.
    knots, pieces : array, shape (n + 1,) and (4, n)
        Measured parameters and the first one a turn later, rad, and powers 3 … 0 of the distance from the knot before, mm; empty
        without points.
    """

    orders: tuple[int, ...]
    amplitudes: ComplexArray = by_drive(1)
    knots: FloatArray
    pieces: FloatArray

    @classmethod
    def of_errors(cls, errors: ProfileErrors) -> ProfileDeviation | None:
        """Return the deviation that a drive defines, None for the flank as designed."""
        if errors.is_zero:
            return None
        none = np.zeros(len(errors.orders))
        cosine, sine = (np.array(each) if each else none for each in (errors.cosine, errors.sine))
        knots, pieces = np.empty(0), np.empty((4, 0))
        if any(errors.deviation):
            from scipy.interpolate import CubicSpline  # 0.1 s to import, for measured flanks only

            knots = np.array([*errors.parameter, errors.parameter[0] + 2.0 * pi])
            pieces = CubicSpline(knots, [*errors.deviation, errors.deviation[0]], bc_type="periodic").c
        return cls(
            orders=errors.orders, amplitudes=np.asarray(cosine - 1j * sine, dtype=complex), knots=knots, pieces=pieces
        )

    def value_and_derivatives(self, direction: ComplexArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return δ, δ′ and δ″ at e^{iθ}, mm by powers of rad, shape (…) or (positions, …).

        With a batch of flanks axis 0 is the position.
        """
        value, first, second = (np.zeros(direction.shape) for _ in range(3))
        for number, order in enumerate(self.orders):
            amplitude = self.amplitudes[..., number]
            if amplitude.ndim:
                amplitude = amplitude.reshape(-1, *(1,) * (direction.ndim - 1))
            wave = amplitude * integer_power(direction, order)
            value += wave.real
            first -= order * wave.imag
            second -= order * order * wave.real
        if self.knots.size:
            from scipy.interpolate import PPoly  # as above

            measured, at = PPoly(self.pieces, self.knots, extrapolate="periodic"), np.angle(direction)
            value, first, second = value + measured(at), first + measured(at, 1), second + measured(at, 2)
        return value, first, second
