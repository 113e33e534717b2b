"""Actual places of all parts of a drive, computed from its definition independently of `ltca.geometry`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import ComplexArray, FloatArray
from ltca.drive.parts import Drive, ProfileErrors

SAMPLES = 48
"""Points of the flank per wave of its highest order, so that a search from the nearest of them is safe."""
FINER = 12
"""Refinement of the next search."""
NODES = 7
"""Number of points of the flank in the polynomial that replaces it near a contact."""
_NODES = np.cos(np.pi * (np.arange(NODES) + 0.5) / NODES)
_TO_POWERS = np.linalg.inv(np.vander(_NODES, increasing=True))


def disc_phase(drive: Drive, disc: int) -> float:
    """Return the phase ζ of the eccentric of a disc, rad."""
    phases = drive.disc.phases
    return float(phases[disc]) if phases else 2.0 * np.pi * disc / drive.disc.number_of_discs


def disc_own(drive: Drive, disc: int, name: str, common: Any) -> Any:
    """Return the value of a disc, or else the common one."""
    own = getattr(drive.disc.of[disc], name) if drive.disc.of else None
    return common if own is None else own


@dataclass(frozen=True)
class ActualParts:
    """Places and sizes of all parts at one disc of a drive.

    Parameters
    ----------
    drive : Drive
        The drive with its deviations.
    crank_angle : float
        φ_C, rad.
    disc : int
        Number of the disc.
    """

    drive: Drive
    crank_angle: float
    disc: int = 0

    @cached_property
    def eccentrics(self) -> ComplexArray:
        """Centres of inner races and cages from the actual crank axes, at the actual eccentricities, mm."""
        crank = self.drive.crank
        arms = []
        for number in range(crank.number):
            error, ahead = crank.eccentricity_error, 0.0
            for place, own in enumerate(crank.of):
                if (place if own.disc is None else own.disc, own.crank or 0) == (self.disc, number):
                    error = error if own.eccentricity_error is None else own.eccentricity_error
                    ahead = own.phase_error
            phase = self.crank_angle + disc_phase(self.drive, self.disc) + ahead
            arms.append(complex(np.cos(phase), np.sin(phase)) * (crank.eccentricity + error))
        return np.array(arms)

    @cached_property
    def race_centres(self) -> ComplexArray:
        """Centres of inner races and cages, mm."""
        crank = self.drive.crank
        axes = np.full(crank.number, complex(crank.axis_offset.x, crank.axis_offset.y))
        if crank.circle_radius is not None:
            on_circle = crank.angle + 2.0 * np.pi * np.arange(crank.number) / crank.number
            axes = axes + crank.circle_radius * np.exp(1j * on_circle)
        return np.asarray(axes + self.eccentrics)

    @cached_property
    def place(self) -> complex:
        """Origin of the displacement of the disc: the mean of the centres of its inner races, mm."""
        return complex(sum(self.race_centres) / self.race_centres.size)

    @cached_property
    def bores(self) -> ComplexArray:
        """Centres of the bores in the disc, mm."""
        crank = self.drive.crank
        if crank.circle_radius is None:
            return np.zeros(1, dtype=complex)
        errors = disc_own(self.drive, self.disc, "bore_errors", None)
        radial = self._each(() if errors is None else errors.radial, crank.number)
        tangential = self._each(() if errors is None else errors.tangential, crank.number)
        ray = np.exp(1j * (crank.angle + 2.0 * np.pi * np.arange(crank.number) / crank.number))
        return np.asarray((crank.circle_radius + radial + 1j * tangential) * ray)

    @cached_property
    def wheel_pins(self) -> tuple[ComplexArray, FloatArray]:
        """Centres from the wheel's axis at the ideal wheel angle, and radii, mm."""
        wheel = self.drive.pin_wheel
        errors, pins = wheel.pin_errors, wheel.number_of_pins
        at = self._on_circle(wheel.pin_circle_radius, pins, errors.radial, errors.tangential)
        turned = at * np.exp(1j * self.crank_angle * self.drive.tooth_number_difference / pins)
        return turned, wheel.pin_radius + 0.5 * self._each(errors.diameter, pins)

    @cached_property
    def wheel_pin_plays(self) -> FloatArray:
        """Radial plays of wheel pins in their slots, or of sleeves on them, mm."""
        seat, radii = self.drive.pin_wheel.seat, self.wheel_pins[1]
        if seat.kind == "slot":
            return np.asarray((seat.radius or 0.0) - radii)
        return np.full(radii.size, (seat.bore_radius or 0.0) - (seat.pin_radius or 0.0))

    @cached_property
    def shaft_pin_plays(self) -> FloatArray:
        """Radial plays of sleeves on the shaft pins, mm."""
        if self.drive.pin_shaft is None:
            return np.zeros(0)
        seat = self.drive.pin_shaft.seat
        return np.full(self.drive.pin_shaft.number_of_pins, (seat.bore_radius or 0.0) - (seat.pin_radius or 0.0))

    @cached_property
    def wheel_axis(self) -> complex:
        """Place of the axis that the wheel turns about, mm."""
        return complex(self.drive.pin_wheel.axis_offset.x, self.drive.pin_wheel.axis_offset.y)

    @cached_property
    def holes(self) -> tuple[ComplexArray, FloatArray]:
        """Centres in the disc and radii, mm."""
        shaft, errors = (
            self.drive.pin_shaft,
            disc_own(self.drive, self.disc, "hole_errors", self.drive.disc.hole_errors),
        )
        if shaft is None:
            return np.zeros(0, dtype=complex), np.zeros(0)
        at = self._on_circle(shaft.pin_circle_radius, shaft.number_of_pins, errors.radial, errors.tangential)
        radius = shaft.hole_radius + self._clearance("pin_hole")
        return at, radius + 0.5 * self._each(errors.diameter, shaft.number_of_pins)

    @cached_property
    def shaft_pins(self) -> tuple[ComplexArray, FloatArray]:
        """Centres and radii, mm."""
        shaft = self.drive.pin_shaft
        if shaft is None:
            return np.zeros(0, dtype=complex), np.zeros(0)
        errors, pins = shaft.pin_errors, shaft.number_of_pins
        at = self._on_circle(shaft.pin_circle_radius, pins, errors.radial, errors.tangential)
        return at, shaft.pin_radius + 0.5 * self._each(errors.diameter, pins)

    @cached_property
    def rollers(self) -> tuple[ComplexArray, FloatArray]:
        """Directions of the cage rays and radii, mm."""
        bearing = self.drive.crank_bearing
        errors, count = (
            disc_own(self.drive, self.disc, "roller_errors", bearing.roller_errors),
            bearing.number_of_rollers,
        )
        speed = bearing.inner_race_radius / (bearing.inner_race_radius + bearing.outer_race_radius)
        pocket = self._each(errors.tangential, count) / (bearing.inner_race_radius + bearing.roller_radius)
        begun = disc_phase(self.drive, self.disc)
        angle = begun + speed * self.crank_angle + 2.0 * np.pi * np.arange(count) / count + pocket
        return np.exp(1j * angle), bearing.roller_radius + 0.5 * self._each(errors.diameter, count)

    @cached_property
    def races(self) -> tuple[float, float]:
        """Radii of inner race and bore, the latter with half the diametral clearance, mm."""
        bearing = self.drive.crank_bearing
        return bearing.inner_race_radius, bearing.outer_race_radius + 0.5 * self._clearance("bearing")

    def _clearance(self, name: str) -> float:
        own = disc_own(self.drive, self.disc, "clearance", None)
        mine = None if own is None else getattr(own, name)
        return float(getattr(self.drive.clearance, name) if mine is None else mine)

    @staticmethod
    def _each(values: Sequence[float], count: int) -> FloatArray:
        return np.array(values) if values else np.zeros(count)

    def _on_circle(
        self, radius: float, count: int, radial: Sequence[float], tangential: Sequence[float]
    ) -> ComplexArray:
        ray = np.exp(2j * np.pi * np.arange(count) / count)
        return np.asarray((radius + self._each(radial, count) + 1j * self._each(tangential, count)) * ray)


@dataclass(frozen=True)
class DeviatedFlank:
    """Points of the flank in the frame of the disc: the design of Eq. 1, less its offset and plus its deviation.

    Parameters
    ----------
    drive : Drive
        The drive with its deviations.
    disc : int
        Number of the disc: its flank is turned by −Δz ζ/z_C relative to the holes, the runout is not.
    """

    drive: Drive
    disc: int = 0

    @cached_property
    def turn(self) -> float:
        """Rotation of the flank relative to the holes, rad."""
        return -self.drive.tooth_number_difference * disc_phase(self.drive, self.disc) / self.drive.disc.number_of_teeth

    @cached_property
    def centre(self) -> complex:
        """Centre of the flank in the frame of the disc, mm."""
        runout = disc_own(self.drive, self.disc, "runout", self.drive.disc.runout)
        return complex(runout.amount * np.exp(1j * runout.angle))

    @cached_property
    def errors(self) -> ProfileErrors:
        """Deviation of the flank."""
        found: ProfileErrors = disc_own(self.drive, self.disc, "profile_errors", self.drive.disc.profile_errors)
        return found

    def points(self, theta: FloatArray) -> ComplexArray:
        """Return points of the flank at parameters, mm."""
        wheel, disc, e = self.drive.pin_wheel, self.drive.disc, self.drive.crank.eccentricity
        u = wheel.number_of_pins / self.drive.tooth_number_difference
        circle = (wheel.pin_circle_radius + disc.shifting_offset) * np.exp(1j * theta)
        crank = e * np.exp(1j * u * theta)
        along = 1j * (circle - u * crank)
        outward = -1j * along / np.abs(along)
        depth = wheel.pin_radius + disc.equidistant_offset - self.deviation(theta)
        return np.asarray((circle - crank - depth * outward) * np.exp(1j * self.turn) + self.centre)

    def deviation(self, theta: FloatArray) -> FloatArray:
        """Return the deviation along the design normal, positive where metal is left, mm."""
        errors = self.errors
        total = np.zeros(theta.shape)
        for number, order in enumerate(errors.orders):
            if errors.cosine:
                total += errors.cosine[number] * np.cos(order * theta)
            if errors.sine:
                total += errors.sine[number] * np.sin(order * theta)
        return total if self._measured is None else total + self._measured(theta)

    @cached_property
    def _measured(self) -> Callable[[FloatArray], FloatArray] | None:
        errors = self.errors
        if not any(errors.deviation):
            return None
        from scipy.interpolate import CubicSpline  # slow to import, for measured flanks only

        knots = [*errors.parameter, errors.parameter[0] + 2.0 * np.pi]
        spline = CubicSpline(knots, [*errors.deviation, errors.deviation[0]], bc_type="periodic")
        return lambda theta: np.asarray(spline(np.mod(theta - knots[0], 2.0 * np.pi) + knots[0]))

    def approaches(self, point: ComplexArray, radius: FloatArray, reach: float) -> tuple[FloatArray, FloatArray]:
        """Return approaches and effective radii of pins about points, mm; arguments and values as for `contacts`."""
        approach, effective, _ = self.contacts(point, radius, reach)
        return approach, effective

    def contacts(
        self, point: ComplexArray, radius: FloatArray, reach: float
    ) -> tuple[FloatArray, FloatArray, ComplexArray]:
        """Return approaches and effective radii of pins about points, mm, and normals of the flank there.

        Parameters
        ----------
        point : array of complex, shape (poses, pins)
            Centres of the pins in the frame of the disc, those of the other poses near those of the first.
        radius : array, shape (pins,)
            Radii of the pins.
        reach : float
            Pins farther off the flank than this in the first pose are left there.

        Returns
        -------
        approach : array, shape (poses, pins)
            Positive where pressed together; minus the reach for pins farther off.
        effective_radius : array, shape (pins,)
            In the first pose; the pin's own for pins farther off.
        normal : array of complex, shape (poses, pins)
            Out of the disc; zero for pins farther off.
        """
        theta, spacing, near = self._search(point[0], radius + reach)
        approach, effective = np.full(point.shape, -reach), radius.copy()
        normal = np.zeros(point.shape, dtype=complex)
        if near.size == 0:
            return approach, effective, normal
        point, radius = point[:, near], radius[near]
        # From here on a polynomial stands for the flank, as wide as the poses move the contact.
        ends = self.points(theta + spacing * np.array([[-1.0], [1.0]]))
        rate = np.abs(ends[1] - ends[0]) / (2.0 * spacing)
        width = 1.5 * spacing + 3.0 * float(np.max(np.abs(point - point[:1]))) / rate
        curve = _TO_POWERS @ self.points(theta + width * _NODES[:, None])
        tangent = curve[1:] * np.arange(1, NODES)[:, None]
        second = tangent[1:] * np.arange(1, NODES - 1)[:, None]
        t = np.zeros(point.shape)
        for _ in range(6):
            away, along = _value(curve, t) - point, _value(tangent, t)
            speed = along.real**2 + along.imag**2
            slope = speed + (np.conj(_value(second, t)) * away).real
            # Near a centre of curvature the slope all but vanishes: the place is on the piece all the same.
            t = np.clip(t - (np.conj(along) * away).real / np.where(slope > 0.0, slope, speed), -1.0, 1.0)
        along = _value(tangent, t)
        outward = -1j * along / np.abs(along)
        approach[:, near] = radius - (np.conj(outward) * (point - _value(curve, t))).real
        bend = (np.conj(along[0]) * _value(second, t)[0]).imag / np.abs(along[0]) ** 3
        effective[near] = 1.0 / (1.0 / radius + bend)
        normal[:, near] = outward
        return approach, effective, normal

    def _search(self, point: ComplexArray, reach: FloatArray) -> tuple[FloatArray, float, NDArray[np.intp]]:
        """Parameters of the nearest points of the flank to those points that it reaches, their spacing, and which points."""
        errors, pins = self.errors, self.drive.pin_wheel.number_of_pins
        spacing = 2.0 * np.pi / (SAMPLES * max((pins, *errors.orders, len(errors.parameter))))
        # A pin stands at the angle of the place it touches to less than 1/z_P, since e z_P/R_C is less than 1.
        half = int(np.ceil(np.pi / pins / spacing))
        theta = np.angle(point - self.centre) - self.turn
        theta, apart = self._nearest(point, theta + spacing * np.arange(-half, half + 1.0)[:, None])
        finer = np.arange(-FINER, FINER + 1.0)[:, None] / FINER
        theta, apart = self._nearest(point, theta + spacing * finer)
        # Points of the flank overestimate the distance, by less than a hundredth of a pin's radius now.
        near = np.nonzero(apart < 1.01 * reach)[0]
        spacing /= FINER
        theta, apart = self._nearest(point[near], theta[near] + spacing * finer)
        return theta, spacing / FINER, near

    def _nearest(self, point: ComplexArray, theta: FloatArray) -> tuple[FloatArray, FloatArray]:
        distance = np.abs(self.points(theta) - point)
        best = np.argmin(distance, axis=0), np.arange(point.size)
        return theta[best], distance[best]


def _value(pieces: ComplexArray, t: FloatArray) -> ComplexArray:
    """Polynomials by their coefficients, lowest first, shape (powers, pins)."""
    total = np.broadcast_to(pieces[-1], t.shape).copy()
    for piece in pieces[-2::-1]:
        total *= t
        total += piece
    return total
