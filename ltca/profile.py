r"""Cycloid flank with equidistant and shifting offset, its normals, curvature and nearest point (Eq. 1).

Points of the plane are complex numbers in the frame of the disc. The flank is the inward parallel curve,
at the distance :math:`r_P + \Delta r_P`, of the trochoid that a pin centre describes about the disc,

.. math:: c(\theta) = (R_C + \Delta R_C) e^{i\theta} - e\, e^{i u \theta},

so flank and trochoid share their normals, and the distance of a pin from the flank is the distance of its
centre from the trochoid. A root of the flank lies at θ = 0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ltca.drive import Drive
from ltca.errors import ConvergenceError

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]


@dataclass(frozen=True, slots=True, kw_only=True)
class FlankProfile:
    """Flank of the disc.

    Attributes
    ----------
    generating_radius : float
        R_C + ΔR_C, mm.
    eccentricity : float
        e of the generating motion, mm.
    reduction_ratio : float
        u = z_P/Δz, the frequency of the trochoid.
    offset : float
        r_P + Δr_P, distance of the flank from the trochoid, mm.
    """

    generating_radius: float
    eccentricity: float
    reduction_ratio: float
    offset: float

    @classmethod
    def of_drive(cls, drive: Drive) -> FlankProfile:
        """Return the flank of a drive's disc."""
        return cls(
            generating_radius=drive.pin_wheel.pin_circle_radius + drive.disc.shifting_offset,
            eccentricity=drive.crank.eccentricity,
            reduction_ratio=drive.reduction_ratio,
            offset=drive.pin_wheel.pin_radius + drive.disc.equidistant_offset,
        )

    def locus(self, parameter: FloatArray) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """Return the trochoid and its first two derivatives by the parameter θ.

        Parameters
        ----------
        parameter : array of float
            θ, rad.

        Returns
        -------
        c, dc, ddc : arrays of complex, same shape
            mm, mm/rad, mm/rad².
        """
        u = self.reduction_ratio
        circle = self.generating_radius * np.exp(1j * np.asarray(parameter))
        crank = self.eccentricity * np.exp(1j * u * np.asarray(parameter))
        return circle - crank, 1j * (circle - u * crank), u * u * crank - circle

    def normal(self, parameter: FloatArray) -> ComplexArray:
        """Return the unit normal out of the disc at θ: e^{i(θ+ψ)} of Eq. 1."""
        _, tangent, _ = self.locus(parameter)
        return -1j * tangent / np.abs(tangent)

    def flank(self, parameter: FloatArray) -> ComplexArray:
        """Return the points r_C(θ) of the flank (Eq. 1), mm."""
        point, tangent, _ = self.locus(parameter)
        return point + 1j * self.offset * tangent / np.abs(tangent)

    def locus_curvature(self, parameter: FloatArray) -> FloatArray:
        """Return the curvature of the trochoid at θ, 1/mm, positive where the disc is convex."""
        _, tangent, second = self.locus(parameter)
        return np.asarray((tangent.conjugate() * second).imag / np.abs(tangent) ** 3)

    def curvature(self, parameter: FloatArray) -> FloatArray:
        """Return the curvature of the flank at θ, 1/mm, positive where the disc is convex.

        Parallel curves share centres of curvature: ρ_flank = ρ_trochoid − offset.
        """
        curvature = self.locus_curvature(parameter)
        return curvature / (1.0 - self.offset * curvature)

    def effective_radius(self, parameter: FloatArray, pin_radius: FloatArray | float) -> FloatArray:
        """Return the effective radius of curvature of flank and pin: 1/ρ = 1/r_pin + κ_flank, mm."""
        return 1.0 / (1.0 / np.asarray(pin_radius) + self.curvature(parameter))

    def nearest_parameter(
        self,
        point: ComplexArray,
        start: FloatArray,
        *,
        tolerance: float = 1e-13,
        limit: int = 100,
        across_root: bool = True,
    ) -> FloatArray:
        """Return θ of the flank point whose normal passes through a point.

        Newton's method on g = Re(conj(c′)(c − p)) = 0 with the step bounded to a fifth of a tooth and, when it does not
        settle soon, kept between a place with g < 0 and one with g > 0: near a centre of curvature the slope of g
        vanishes and Newton's method alone creeps or runs away. The minimum next to the start is found; for points
        about a pin radius away from the flank that is the nearest one.

        Parameters
        ----------
        point : array of complex
            Points in the disc frame, mm.
        start : array of float, same shape
            First guess of θ, rad.
        tolerance : float
            Largest accepted step, rad.
        limit : int
            Iterations.
        across_root : bool
            Look at the other side of the root as well, where its curvature lets both sides be near.

        Returns
        -------
        array of float
            θ, rad, near the start (not reduced to one turn).

        Raises
        ------
        ConvergenceError
            When a point does not settle; the history holds the largest steps.
        """
        theta = np.array(np.broadcast_to(start, np.shape(point)), dtype=float)
        bound = 0.4 * np.pi / self.reduction_ratio
        low, high = np.full(theta.shape, -np.inf), np.full(theta.shape, np.inf)
        history: list[float] = []
        for iteration in range(limit):
            c, tangent, second = self.locus(theta)
            away = c - point
            speed = (tangent * tangent.conjugate()).real
            value = (tangent.conjugate() * away).real
            slope = speed + (second.conjugate() * away).real
            # Beyond a centre of curvature the slope is negative, the point next to a largest distance: leave it.
            step = np.clip(value / np.maximum(np.abs(slope), 1e-3 * speed), -bound, bound)
            if iteration > 5:  # nearly every point is there by now: only those that creep need a bracket
                low, high = np.where(value < 0.0, theta, low), np.where(value > 0.0, theta, high)
                outside = ((theta - step < low) | (theta - step > high)) & np.isfinite(high - low)
                step[outside] = theta[outside] - 0.5 * (low[outside] + high[outside])
            theta -= step
            history.append(float(np.max(np.abs(step), initial=0.0)))
            # Convergence is quadratic: a step of 1e-8 leaves an error below round-off.
            if history[-1] <= max(tolerance, 1e-8) and (len(history) > 1 or history[-1] <= tolerance):
                return self._nearer_side(point, theta) if across_root else theta
        raise ConvergenceError("contact points on the flank not found; largest step in rad", history)

    def _nearer_side(self, point: ComplexArray, theta: FloatArray) -> FloatArray:
        """Change to the other side of the root where the flank is nearer there.

        With e z_P/R_C near 1 the path of a pin centre is nearly a cusp at the root, and a pin that has left it by
        more than its radius there has a nearest point on either side.
        """
        eccentric, u = self.eccentricity, self.reduction_ratio
        bend = eccentric * u * u - self.generating_radius
        if bend <= 0.0:
            return theta
        root_radius = (self.generating_radius - eccentric * u) ** 2 / bend
        away = np.abs(self.locus(theta)[0] - point)
        pitch = 2.0 * np.pi / (u - 1.0)
        root = pitch * np.round(theta / pitch)
        doubtful = (away > 0.3 * root_radius) & (np.abs(theta - root) < 0.25 * pitch)
        if not np.any(doubtful):
            return theta
        places = np.broadcast_to(point, theta.shape)[doubtful]
        other = self.nearest_parameter(places, (2.0 * root - theta)[doubtful], across_root=False)
        nearer = np.abs(self.locus(other)[0] - places) < away[doubtful]
        theta[doubtful] = np.where(nearer, other, theta[doubtful])
        return theta

    def distance(self, point: ComplexArray, parameter: FloatArray) -> FloatArray:
        """Return the signed distance of points from the flank along the normal at θ, mm, positive outside."""
        c, tangent, _ = self.locus(parameter)
        normal = -1j * tangent / np.abs(tangent)
        return ((point - c) * normal.conjugate()).real + self.offset

    @property
    def root_radius(self) -> float:
        """Smallest radius of the disc, mm (at θ = 0)."""
        return self.generating_radius - self.eccentricity - self.offset

    @property
    def tip_radius(self) -> float:
        """Largest radius of the disc, mm (at θ = π/z_C for Δz = 1)."""
        return self.generating_radius + self.eccentricity - self.offset
