"""Cycloid flank with equidistant and shifting offset, its normals, curvature and nearest point (Eq. 1), in the frame of the disc.

As designed it is parallel to the trochoid of a pin centre, so both share normals and nearest points; a root lies at θ = 0. With a
deviation δ(θ) it is F = c − (offset − δ) n, no parallel curve, and normals and nearest points are those of F.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ltca.arrays import ComplexArray, FloatArray, by_drive, has_rows, take_rows
from ltca.drive.parts import Drive
from ltca.errors import ConvergenceError
from ltca.geometry.flank_deviation import ProfileDeviation
from ltca.geometry.placement import BatchScalar
from ltca.geometry.rotation import integer_power, small_turn, unit

SETTLED = 1e-8
"""Last step of Newton's method, rad: convergence is quadratic, the error that is left is below round-off."""
MAX_ITERATIONS = 100
"""Newton steps to a contact point."""
NEARLY = 1e-7
"""Last step, rad, over which the curve is followed by its derivatives: what they leave out is 1e-11 of the least radius."""
BRACKETED = 6
"""Steps after which the points that are left are bracketed."""
ROUND_OFF = 1e-13
"""Step within round-off, rad: the direction before it is that after it."""


class CurvePoints(NamedTuple):
    """Points of a curve with two derivatives by θ: complex, mm, mm/rad, mm/rad²."""

    point: ComplexArray
    tangent: ComplexArray
    second: ComplexArray

    @property
    def normal(self) -> ComplexArray:
        """Unit normal out of the disc."""
        return -1j * self.tangent / np.abs(self.tangent)

    @property
    def curvature(self) -> FloatArray:
        """1/mm, positive where the disc is convex."""
        return np.asarray((self.tangent.conjugate() * self.second).imag / np.abs(self.tangent) ** 3)


LEAST_SQUARE = 1e-9
"""Least S² of a trochoid with cusps."""


def trochoid_curvature(
    radius: FloatArray | float, eccentricity: FloatArray | float, pins: FloatArray | float, cosine: FloatArray | float
) -> FloatArray:
    """Return the curvature of the path of the pin centres, 1/mm, positive where convex, by the cosine of pin and eccentric.

    >>> float(trochoid_curvature(60.0, 0.0, 40, 0.3))  # a circle
    0.016666666666666666
    """
    shortening = np.asarray(eccentricity * pins / radius)
    lever = np.sqrt(np.maximum(1.0 + shortening**2 - 2.0 * shortening * cosine, LEAST_SQUARE))
    return np.asarray((1.0 + pins * shortening**2 - shortening * (1.0 + pins) * cosine) / (radius * lever**3))


class CurveFrame(NamedTuple):
    """Moving frame of a curve over θ: point, mm, unit tangent, speed |c′| and the rotation w dθ, with derivatives of both."""

    point: ComplexArray
    tangent: ComplexArray
    speed: FloatArray
    speed_slope: FloatArray
    turning: FloatArray
    turning_slope: FloatArray


class NearestPoint(NamedTuple):
    """Foot of the normal through a point: θ and the curve of `FlankProfile.contact_curve` there."""

    parameter: FloatArray
    curve: CurvePoints


@dataclass(frozen=True, slots=True, kw_only=True)
class FlankProfile:
    """Flank of the disc, or flanks of a batch of discs, whose numbers are arrays of shape (positions, 1)."""

    generating_radius: BatchScalar = by_drive(0)  # R_C + ΔR_C, mm
    eccentricity: BatchScalar = by_drive(0)
    reduction_ratio: float  # u = z_P/Δz, a whole number
    offset: BatchScalar = by_drive(0)  # r_P + Δr_P, distance of the flank from the trochoid, mm
    turn: complex | ComplexArray = by_drive(0, default=1.0)  # unit vector of the root at θ = 0 in the frame of the disc
    centre: complex | ComplexArray = by_drive(0, default=0.0)  # of the flank from that of the bore, mm
    deviation: ProfileDeviation | None = None

    @classmethod
    def of_drive(cls, drive: Drive) -> FlankProfile:
        """Return the flank of a drive's disc."""
        runout = drive.require_warmed().disc.runout
        return cls(
            generating_radius=drive.pin_wheel.pin_circle_radius + drive.disc.shifting_offset,
            eccentricity=drive.crank.eccentricity,
            reduction_ratio=drive.reduction_ratio,
            offset=drive.pin_wheel.pin_radius + drive.disc.equidistant_offset,
            turn=complex(unit(drive.flank_turn)) if drive.flank_turn else 1.0,
            centre=runout.amount * complex(unit(runout.angle)),
            deviation=ProfileDeviation.of_errors(drive.disc.profile_errors),
        )

    def locus(self, parameter: FloatArray) -> CurvePoints:
        """Return the design trochoid about its centre at θ, rad, turned with the flank, and its first two derivatives by θ."""
        return self.at(unit(parameter))

    def at(self, direction: ComplexArray) -> CurvePoints:
        """Return the design trochoid, (R_C + ΔR_C) e^{iθ} − e e^{iuθ} turned with the flank, as `locus` does, at e^{iθ}."""
        u = self.reduction_ratio
        circle = self.generating_radius * direction
        crank = self.eccentricity * integer_power(direction, round(u))
        if isinstance(self.turn, np.ndarray) or self.turn != 1.0:
            circle, crank = circle * self.turn, crank * self.turn
        return CurvePoints(circle - crank, 1j * (circle - u * crank), u * u * crank - circle)

    @property
    def contact_offset(self) -> BatchScalar:
        """Distance of the actual flank from `contact_curve`, mm."""
        return self.offset if self.deviation is None else 0.0

    def contact_curve(self, direction: ComplexArray) -> CurvePoints:
        """Return the curve at e^{iθ} whose inward parallel at `contact_offset` is the flank: trochoid, or the flank itself."""
        if self.deviation is None:
            c, dc, ddc = self.at(direction)
            return CurvePoints(c + self.centre, dc, ddc)
        return self.deviated(self.frame(direction), direction)

    def frame(self, direction: ComplexArray) -> CurveFrame:
        """Return the frame of the design trochoid at e^{iθ}, in which deviations are given."""
        c, dc, ddc = self.at(direction)
        u = self.reduction_ratio
        circle = self.generating_radius * direction * self.turn
        dddc = 1j * (u**3 * (circle - c) - circle)
        back = dc.conjugate()
        square = dc.real**2 + dc.imag**2
        speed = np.sqrt(square)
        tangent = dc / speed
        turning = back * ddc
        w, ds = turning.imag / square, turning.real / speed
        return CurveFrame(c, tangent, speed, ds, w, (back * dddc).imag / square - 2.0 * w * ds / speed)

    def deviated(self, frame: CurveFrame, direction: ComplexArray) -> CurvePoints:
        """Return the actual flank with its deviation, from the frame of the design at e^{iθ}."""
        if self.deviation is None:
            raise ValueError("the flank is as designed")
        # The frame t, n = −it turns with w: t′ = −w n, n′ = w t. Derivatives of F = c − d n, d = offset − δ.
        c, t, speed, ds, w, dw = frame
        delta, slope, bend = self.deviation.value_and_derivatives(direction)
        d = self.offset - delta
        along = speed - d * w

        def framed(along_tangent: FloatArray, along_normal: FloatArray) -> ComplexArray:
            parts = np.empty(t.shape, dtype=complex)
            parts.real, parts.imag = along_tangent, -along_normal
            return parts * t

        return CurvePoints(
            c + 1j * d * t + self.centre, framed(along, slope), framed(ds + 2.0 * slope * w - d * dw, bend - w * along)
        )

    def normal(self, parameter: FloatArray) -> ComplexArray:
        """Return the unit normal out of the disc at θ: e^{i(θ+ψ)} of Eq. 1 for a flank as designed."""
        return self.contact_curve(unit(parameter)).normal

    def flank(self, parameter: FloatArray) -> ComplexArray:
        """Return the points r_C(θ) of the flank (Eq. 1), mm."""
        curve = self.contact_curve(unit(parameter))
        return np.asarray(curve.point - self.contact_offset * curve.normal)

    def flank_tangent(self, parameter: FloatArray) -> ComplexArray:
        """Return dr_C/dθ of the flank, mm/rad."""
        curve = self.contact_curve(unit(parameter))
        return np.asarray(curve.tangent * (1.0 - self.contact_offset * curve.curvature))

    def curvature(self, parameter: FloatArray) -> FloatArray:
        """Return the curvature of the flank at θ, 1/mm, positive where convex; as designed ρ_flank = ρ_trochoid − offset."""
        curvature = self.contact_curve(unit(parameter)).curvature
        return np.asarray(curvature / (1.0 - self.contact_offset * curvature))

    def effective_radius(self, parameter: FloatArray, pin_radius: FloatArray | float) -> FloatArray:
        """Return the effective radius of curvature of flank and pin: 1/ρ = 1/r_pin + κ_flank, mm."""
        return 1.0 / (1.0 / np.asarray(pin_radius) + self.curvature(parameter))

    def nearest_point(self, point: ComplexArray, start: FloatArray) -> NearestPoint:
        """Find the flank point next to θ = `start` whose normal passes through each point (Eq. 61): bracketed Newton's method."""
        theta = start if start.shape == point.shape else np.broadcast_to(start, point.shape)
        return self._nearer_side(point, self._settle(point, theta))

    def _settle(self, point: ComplexArray, start: FloatArray) -> NearestPoint:
        """Find the foot next to every start, g = Re(conj(c′)(c − p)) = 0, in a loop of its own: every equilibrium runs it."""
        flank, theta, direction = self, start, unit(start)
        every, settled, left = theta, direction, np.arange(theta.size)
        bound = 0.4 * np.pi / self.reduction_ratio
        low = high = last = slope_before = np.zeros(0)
        history: list[float] = []
        for iteration in range(MAX_ITERATIONS):
            curve = flank.contact_curve(direction)
            away, tangent = (curve.point - point).conjugate(), curve.tangent
            speed = tangent.real**2 + tangent.imag**2
            value = (tangent * away).real
            slope = speed + (curve.second * away).real
            # Beyond a centre of curvature the slope is negative, near a maximum of the distance: step away from it.
            safe = np.maximum(np.abs(slope), 1e-3 * speed)
            step = value / safe
            if iteration:  # Halley's correction, the bend of g from the last two slopes
                bend = np.divide(slope_before - slope, last, out=np.zeros(theta.shape), where=last != 0.0)
                step /= 1.0 - (0.5 * step * bend / safe).clip(-0.5, 0.5)
            moved = np.abs(step)
            if (furthest := float(moved.max(initial=0.0))) > bound:
                step = step.clip(-bound, bound)
            if iteration == BRACKETED:
                low, high = np.full(theta.shape, -np.inf), np.full(theta.shape, np.inf)
            if iteration >= BRACKETED:  # nearly every point has converged by now: only slow ones need a bracket
                low, high = np.where(value < 0.0, theta, low), np.where(value > 0.0, theta, high)
                # A step starts at one end. One nearly to the other end counts as outside: it could go back and forth forever.
                outside = np.abs(step) > 0.95 * (high - low)
                step[outside] = theta[outside] - 0.5 * (low[outside] + high[outside])
            if furthest > bound or iteration >= BRACKETED:
                moved = np.abs(step)
                furthest = float(moved.max(initial=0.0))
            theta = theta - step
            slope_before, last = slope, step
            history.append(furthest)
            if history[-1] <= (NEARLY if self.deviation is None else ROUND_OFF) and theta.size == every.size:
                return NearestPoint(theta, self._moved(curve, step))
            if history[-1] > ROUND_OFF:
                direction = direction * small_turn(-step)
            if history[-1] <= SETTLED and theta.size == every.size:
                return NearestPoint(theta, self.contact_curve(direction))
            going = moved > SETTLED
            if 2 * np.count_nonzero(going) < going.size:
                every, settled = every.copy(), settled.copy()
                every.ravel()[left], settled.ravel()[left] = theta.ravel(), direction.ravel()
                left = left[going.ravel()]
                if left.size == 0:
                    return NearestPoint(every, self.contact_curve(settled))
                flank = take_rows(flank, np.nonzero(going)[0])
                # What is left goes on as one column.
                theta, last, slope_before = (each[going][:, None] for each in (theta, last, slope_before))
                direction, point = direction[going][:, None], point[going][:, None]
                if iteration >= BRACKETED:
                    low, high = low[going][:, None], high[going][:, None]
        raise ConvergenceError("contact points on the flank not found; largest step in rad", history)

    def _moved(self, curve: CurvePoints, step: FloatArray) -> CurvePoints:
        """Curve of a flank as designed a small step back, its derivatives to second order: c‴ = i (u + 1) c″ + u c′."""
        point, tangent, second = curve
        u = self.reduction_ratio
        change = (u * tangent + 1j * (u + 1.0) * second) * step
        half = 0.5 * step
        return CurvePoints(
            point - step * (tangent - half * second), tangent - step * second + half * change, second - change
        )

    def _nearer_side(self, point: ComplexArray, found: NearestPoint) -> NearestPoint:
        """Replace nearest points by those beyond a root, nearly a cusp where e z_P/R_C is near 1, where these are nearer."""
        u = self.reduction_ratio
        bend = self.eccentricity * u * u - self.generating_radius
        if isinstance(bend, np.ndarray):
            bend = np.where(bend > 0.0, bend, np.nan)
        elif bend <= 0.0:
            return found
        sharp = (self.generating_radius - self.eccentricity * u) ** 2 / bend
        theta, away = found.parameter, self._off_path(point, found)
        pitch = 2.0 * np.pi / (u - 1.0)
        root = pitch * np.round(theta / pitch)
        doubtful = (away > 0.3 * sharp) & (np.abs(theta - root) < 0.25 * pitch)
        if not np.any(doubtful):
            return found
        # The doubtful points alone; of a batch of flanks the positions that have some.
        rows = np.nonzero(np.any(doubtful, axis=1))[0] if has_rows(self) else doubtful
        flank = take_rows(self, rows)
        point, start = point[rows], np.where(doubtful, 2.0 * root - theta, theta)[rows]
        other = flank._settle(point, start)
        nearer = doubtful[rows] & (flank._off_path(point, other) < away[rows])

        mixed = NearestPoint(theta.copy(), CurvePoints(*(each.copy() for each in found.curve)))
        for here, there in zip((mixed.parameter, *mixed.curve), (other.parameter, *other.curve), strict=True):
            here[rows] = np.where(nearer, there, here[rows])
        return mixed

    def _off_path(self, point: ComplexArray, found: NearestPoint) -> FloatArray:
        """Distance of points from the path of the centre of a pin that touches the flank, mm."""
        return np.asarray(np.abs(np.abs(found.curve.point - point) - (self.offset - self.contact_offset)))

    def distance(self, point: ComplexArray, parameter: FloatArray) -> FloatArray:
        """Return the signed distance of points from the flank along the normal at θ, mm, positive outside."""
        curve = self.contact_curve(unit(parameter))
        return np.asarray(((point - curve.point) * curve.normal.conjugate()).real + self.contact_offset)

    @property
    def root_radius(self) -> float:
        """Smallest radius of the disc as designed, mm (at θ = 0)."""
        return float(self.generating_radius - self.eccentricity - self.offset)

    @property
    def tip_radius(self) -> float:
        """Largest radius of the disc as designed, mm (at θ = π/z_C for Δz = 1)."""
        return float(self.generating_radius + self.eccentricity - self.offset)
