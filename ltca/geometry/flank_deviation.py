"""Deviation of the flank along its design normal, δ(θ) = Re Σ (a_k − i b_k) e^{ikθ} + a spline, with two derivatives."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from ltca.arrays import ComplexArray, FloatArray, by_drive
from ltca.drive.deviations import ProfileErrors
from ltca.geometry.rotation import integer_power


@dataclass(frozen=True, slots=True, kw_only=True)
class ProfileDeviation:
    """Deviation of one flank, or of the flanks of a batch: harmonics and a periodic cubic spline through measured points."""

    orders: tuple[int, ...]  # waves around the disc
    amplitudes: ComplexArray = by_drive(1)  # a − i b of each order, mm, shape (orders,) or (positions, orders)
    knots: FloatArray  # measured parameters and the first one a turn later, rad; empty without points
    pieces: FloatArray  # powers 3 … 0 of the distance from the knot before, mm, shape (4, n)

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
        """Return δ, δ′ and δ″ at e^{iθ}, mm by powers of rad, shape (…); of a batch of flanks axis 0 is the position."""
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
