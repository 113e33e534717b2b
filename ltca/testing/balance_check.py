"""Whether a pose balances, found without the code that balances it.

Written apart from `ltca.geometry`, `ltca.compliance.rollers` and `ltca.equilibrium.balance`: every place from the definition of
the drive with all its deviations, distances from the flank by a search over points of the deviated flank, rollers placed by
a search on their energy, nothing but energies. The only things shared are the definition of the drive and the energy
∫F dδ of the contact laws, crown and relief in it. A pose balances when its potential Π is a minimum: no small
displacement lowers it, and its slope by central differences vanishes.

The effective radii of the flank contacts are held at those of the pose looked at: a frictionless contact pushes
along its normal with F(δ, ρ), and what the energy gains because the contact moves to another curvature (about 1e-3
of the contact's load, along the flank) is no force.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.drive.parts import Drive
from ltca.equilibrium.balance import Equilibrium

FloatArray = NDArray[np.float64]

GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)
SECTIONS = 9
"""Golden sections of the approach of a roller between race and bore: to a hundredth of it, parabolas do the rest."""
ComplexArray = NDArray[np.complex128]

SAMPLES = 48
"""Points of the flank for each wave of its highest order: a search is safe from the nearest of them."""
FINER = 12
"""How much finer the next search is."""
FARTHEST = 0.01
"""Largest displacement tried, as a part of the pin radius."""
NODES = 7
"""Points of the flank through which a polynomial stands for it next to a contact."""
_NODES = np.cos(np.pi * (np.arange(NODES) + 0.5) / NODES)
_TO_POWERS = np.linalg.inv(np.vander(_NODES, increasing=True))


class EnergyLaw(Protocol):
    """What the check asks of a contact law."""

    def energy(self, approach: ArrayLike, effective_radius: ArrayLike) -> FloatArray:
        """∫F dδ, N·mm."""
        ...


@dataclass(frozen=True)
class ActualParts:
    """Places and sizes of everything in a drive, written out from its definition.

    Parameters
    ----------
    drive : Drive
        The drive with its deviations.
    crank_angle : float
        φ_C, rad.
    """

    drive: Drive
    crank_angle: float

    @cached_property
    def race_centre(self) -> complex:
        """Centre of inner race and cage: at the actual eccentricity from the actual crank axis, mm."""
        crank = self.drive.crank
        arm = (crank.eccentricity + crank.eccentricity_error) * np.exp(1j * self.crank_angle)
        return complex(crank.axis_offset.x + arm.real, crank.axis_offset.y + arm.imag)

    @cached_property
    def wheel_pins(self) -> tuple[ComplexArray, FloatArray]:
        """Centres from the wheel's axis at the ideal wheel angle, and radii, mm."""
        wheel = self.drive.pin_wheel
        errors, pins = wheel.pin_errors, wheel.number_of_pins
        at = self._on_circle(wheel.pin_circle_radius, pins, errors.radial, errors.tangential)
        turned = at * np.exp(1j * self.crank_angle * self.drive.tooth_number_difference / pins)
        return turned, wheel.pin_radius + 0.5 * self._each(errors.diameter, pins)

    @cached_property
    def wheel_axis(self) -> complex:
        """Place of the axis the wheel turns about, mm."""
        return complex(self.drive.pin_wheel.axis_offset.x, self.drive.pin_wheel.axis_offset.y)

    @cached_property
    def holes(self) -> tuple[ComplexArray, FloatArray]:
        """Centres in the disc and radii, mm."""
        shaft, errors = self.drive.pin_shaft, self.drive.disc.hole_errors
        at = self._on_circle(shaft.pin_circle_radius, shaft.number_of_pins, errors.radial, errors.tangential)
        radius = shaft.hole_radius + self.drive.clearance.pin_hole
        return at, radius + 0.5 * self._each(errors.diameter, shaft.number_of_pins)

    @cached_property
    def shaft_pins(self) -> tuple[ComplexArray, FloatArray]:
        """Centres and radii, mm."""
        shaft = self.drive.pin_shaft
        errors, pins = shaft.pin_errors, shaft.number_of_pins
        at = self._on_circle(shaft.pin_circle_radius, pins, errors.radial, errors.tangential)
        return at, shaft.pin_radius + 0.5 * self._each(errors.diameter, pins)

    @cached_property
    def rollers(self) -> tuple[ComplexArray, FloatArray]:
        """Directions of the cage rays and radii, mm."""
        bearing = self.drive.crank_bearing
        errors, count = bearing.roller_errors, bearing.number_of_rollers
        speed = bearing.inner_race_radius / (bearing.inner_race_radius + bearing.outer_race_radius)
        pocket = self._each(errors.tangential, count) / (bearing.inner_race_radius + bearing.roller_radius)
        angle = speed * self.crank_angle + 2.0 * np.pi * np.arange(count) / count + pocket
        return np.exp(1j * angle), bearing.roller_radius + 0.5 * self._each(errors.diameter, count)

    @cached_property
    def races(self) -> tuple[float, float]:
        """Radii of inner race and bore, the latter with half the diametral clearance, mm."""
        bearing = self.drive.crank_bearing
        return bearing.inner_race_radius, bearing.outer_race_radius + 0.5 * self.drive.clearance.bearing

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
    """

    drive: Drive

    def points(self, theta: FloatArray) -> ComplexArray:
        """Return points of the flank at parameters, mm."""
        wheel, disc, e = self.drive.pin_wheel, self.drive.disc, self.drive.crank.eccentricity
        u = wheel.number_of_pins / self.drive.tooth_number_difference
        circle = (wheel.pin_circle_radius + disc.shifting_offset) * np.exp(1j * theta)
        crank = e * np.exp(1j * u * theta)
        along = 1j * (circle - u * crank)
        outward = -1j * along / np.abs(along)
        depth = wheel.pin_radius + disc.equidistant_offset - self.deviation(theta)
        runout = disc.runout.amount * np.exp(1j * disc.runout.angle)
        return np.asarray(circle - crank - depth * outward + runout)

    def deviation(self, theta: FloatArray) -> FloatArray:
        """Return the deviation along the design normal, positive where metal is left, mm."""
        errors = self.drive.disc.profile_errors
        total = np.zeros(theta.shape)
        for number, order in enumerate(errors.orders):
            if errors.cosine:
                total += errors.cosine[number] * np.cos(order * theta)
            if errors.sine:
                total += errors.sine[number] * np.sin(order * theta)
        return total if self._measured is None else total + self._measured(theta)

    @cached_property
    def _measured(self) -> Callable[[FloatArray], FloatArray] | None:
        errors = self.drive.disc.profile_errors
        if not any(errors.deviation):
            return None
        from scipy.interpolate import CubicSpline  # slow to import, for measured flanks only

        knots = [*errors.parameter, errors.parameter[0] + 2.0 * np.pi]
        spline = CubicSpline(knots, [*errors.deviation, errors.deviation[0]], bc_type="periodic")
        return lambda theta: np.asarray(spline(np.mod(theta - knots[0], 2.0 * np.pi) + knots[0]))

    def approaches(self, point: ComplexArray, radius: FloatArray, reach: float) -> tuple[FloatArray, FloatArray]:
        """Return approaches and effective radii of pins about points, mm.

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
        """
        theta, spacing, near = self._search(point[0], radius + reach)
        approach, effective = np.full(point.shape, -reach), radius.copy()
        if near.size == 0:
            return approach, effective
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
        return approach, effective

    def _search(self, point: ComplexArray, reach: FloatArray) -> tuple[FloatArray, float, NDArray[np.intp]]:
        """Points of the flank, finer and finer: the nearest to those points that it reaches, their spacing, which."""
        errors, pins, runout = (
            self.drive.disc.profile_errors,
            self.drive.pin_wheel.number_of_pins,
            self.drive.disc.runout,
        )
        spacing = 2.0 * np.pi / (SAMPLES * max((pins, *errors.orders, len(errors.parameter))))
        # A pin stands at the angle of the place it touches to less than 1/z_P, since e z_P/R_C is less than 1.
        half = int(np.ceil(np.pi / pins / spacing))
        theta = np.angle(point - runout.amount * np.exp(1j * runout.angle))
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


@dataclass(frozen=True, kw_only=True)
class PotentialEnergy:
    """Π of a drive at one crank angle, for many poses at once.

    Parameters
    ----------
    drive : Drive
        The drive; all its deviations are taken.
    pin_law, inner_law, outer_law : EnergyLaw
        Energies of the contacts of wheel pins, of rollers on the inner race and in the bore.
    crank_angle : float
        φ_C, rad.
    wheel_moment : float
        N·mm.
    """

    drive: Drive
    pin_law: EnergyLaw
    inner_law: EnergyLaw
    outer_law: EnergyLaw
    crank_angle: float
    wheel_moment: float

    def at(self, pose: FloatArray) -> FloatArray:
        """Return Π of poses, shape (poses, 4), with the effective radii of the first of them, N·mm.

        All poses lie within some approaches of the first.
        """
        parts = ActualParts(self.drive, self.crank_angle)
        shift = pose[:, 0] + 1j * pose[:, 1]
        centre = (parts.race_centre + shift)[:, None]
        turn = np.exp(1j * pose[:, 2])[:, None]
        pins, radii = parts.wheel_pins
        point = (parts.wheel_axis + pins * np.exp(1j * pose[:, 3])[:, None] - centre) * np.conj(turn)
        moved = float(np.max(np.abs(point - point[:1])))
        approach, effective = DeviatedFlank(self.drive).approaches(point, radii, 2.0 * moved)
        energy = self.pin_law.energy(approach, effective).sum(axis=1)
        holes, hole_radii = parts.holes
        shaft_pins, shaft_radii = parts.shaft_pins
        overlap = np.abs(shaft_pins - centre - holes * turn) - (hole_radii - shaft_radii)
        energy += 0.5 * self.drive.pin_shaft.stiffness * (np.maximum(overlap, 0.0) ** 2).sum(axis=1)
        energy += self._rollers(parts, shift[:, None])
        return np.asarray(energy - self.wheel_moment * pose[:, 3])

    def _rollers(self, parts: ActualParts, shift: ComplexArray) -> FloatArray:
        """Energy of all rollers, each at its best place on its ray."""
        ray, radii = parts.rollers
        inner_race, bore = parts.races
        across, along = (np.conj(ray) * shift).imag, (np.conj(ray) * shift).real
        whole = inner_race + radii - along - np.sqrt((bore - radii) ** 2 - across**2)
        pressed = np.nonzero(np.max(whole, axis=0) > 0.0)[0]
        ray, radii, whole = ray[pressed], radii[pressed], np.maximum(whole[:, pressed], 0.0)
        inner_radius, outer_radius = 1.0 / (1.0 / radii + 1.0 / inner_race), 1.0 / (1.0 / radii - 1.0 / bore)

        def energy(share: FloatArray) -> FloatArray:
            inner = share * whole
            outer = np.abs((inner_race + radii - inner) * ray - shift) - (bore - radii)
            outer = np.where(whole > 0.0, outer, 0.0)
            return np.asarray(self.inner_law.energy(inner, inner_radius) + self.outer_law.energy(outer, outer_radius))

        # Golden section: beside a plastic disc the steel race takes less than a hundredth of the approach.
        low, high = np.zeros(whole.shape), np.ones(whole.shape)
        left, right = np.full(whole.shape, 1.0 - GOLDEN), np.full(whole.shape, GOLDEN)
        at_left, at_right = energy(left), energy(right)
        for _ in range(SECTIONS):
            falls = at_left > at_right  # to the right
            low, high = np.where(falls, left, low), np.where(falls, high, right)
            kept, at_kept = np.where(falls, right, left), np.where(falls, at_right, at_left)
            other = low + high - kept
            at_other = energy(other)
            left, right = np.where(falls, kept, other), np.where(falls, other, kept)
            at_left, at_right = np.where(falls, at_kept, at_other), np.where(falls, at_other, at_kept)
        # Then the lowest point of the parabola through three energies, twice.
        share = 0.5 * (left + right)
        for part in (0.5, 0.05):
            step = part * (right - left)
            before, here, after = energy(share - step), energy(share), energy(share + step)
            bend = np.maximum(before - 2.0 * here + after, 1e-300)
            share = share + np.clip(0.5 * (before - after) / bend, -4.0, 4.0) * step
        return np.asarray(energy(np.clip(share, 0.0, 1.0)).sum(axis=1))


def find_imbalance(
    drive: Drive, model: HalfSpaceCompliance, balanced: Equilibrium, position: int = 0, seed: int = 0
) -> list[str]:
    """Return what speaks against a position being in equilibrium; empty when nothing does.

    Parameters
    ----------
    drive : Drive
        The drive; its geometry, deviations included, is taken from nowhere else.
    model : HalfSpaceCompliance
        For the energies of its laws.
    balanced : Equilibrium
        The solution.
    position : int
        Which of its positions.
    seed : int
        Of the random displacements.
    """
    pose, contacts = balanced.pose[position], balanced.response
    moment = float(balanced.wheel_moment[position])
    potential = PotentialEnergy(
        drive=drive,
        pin_law=model.pin_law,
        inner_law=model.roller_laws.inner,
        outer_law=model.roller_laws.outer,
        crank_angle=float(balanced.crank_angle[position]),
        wheel_moment=moment,
    )
    wheel = drive.crank.eccentricity * float(drive.reduction_ratio)
    lever = np.array([1.0, 1.0, wheel - drive.crank.eccentricity, wheel])
    load = abs(moment) / wheel
    problems = []
    if not np.all(np.isfinite(pose)):
        return ["the pose is not finite"]
    rollers = contacts.rollers
    for name, approach, force in (
        ("pin", contacts.flank.approach, contacts.pin_load),
        ("hole", contacts.holes.approach, contacts.hole_load),
        ("roller in the bore", rollers.outer_approach, rollers.outer_load),
        ("roller on the inner race", rollers.inner_approach, rollers.inner_load),
    ):
        if np.any(force[position] < 0.0) or np.any((force[position] > 0.0) & (approach[position] <= 0.0)):
            problems.append(f"a {name} pulls or carries while open")
    # How far the least stiff contact yields under the load sets the scale of the displacements.
    scale = max(1e-6, float(np.max(contacts.flank.approach[position])), float(np.max(rollers.outer_approach[position])))
    # Contacts that just open or close bend the slope: of several steps the best tells; a wrong pose fails with all.
    steps = scale * np.array([1e-3, 1e-4, 1e-5, 1e-6])
    offsets = (steps[:, None, None] * np.concatenate([np.eye(4), -np.eye(4)])).reshape(-1, 4)
    directions = np.random.default_rng(seed).normal(size=(12, 4))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    # Preloaded pins yield by more than the pieces of the flank hold on which they are followed.
    farthest = min(scale, FARTHEST * drive.pin_wheel.pin_radius)
    sizes = farthest * np.repeat([1e-2, 1e-1, 1.0], 4)
    here = np.zeros((1, 4))
    # Apart, since the farthest pose sets how wide the pieces are.
    value = potential.at(pose + np.concatenate([here, offsets]) / lever)
    moved = potential.at(pose + np.concatenate([here, sizes[:, None] * directions]) / lever)
    pairs = value[1:].reshape(4, 2, 4)
    slope = np.abs(pairs[:, 0] - pairs[:, 1]).max(axis=1) / (2.0 * steps)
    # Round-off of Π: of the stored energy and of T·angle, of the search along the rays, and of approaches (parts of
    # the pin circle radius) under the forces of preloaded pins.
    size = 4.0 * np.finfo(float).eps * drive.pin_wheel.pin_circle_radius
    forces = float(
        contacts.pin_load[position].sum() + contacts.hole_load[position].sum() + rollers.outer_load[position].sum()
    )
    noise = 1e-11 * (abs(moment * pose[3]) + abs(value[0]) + load * scale) + size * forces
    best = int(np.argmin(slope - noise / steps))
    if slope[best] > 1e-3 * load + noise / steps[best]:
        problems.append(f"slope of the potential {slope[best]:.3g} N against a load of {load:.3g} N")
    rise = moved[1:] - moved[0]
    if np.any(rise < -noise - 1e-4 * load * sizes):
        problems.append(f"a displacement lowers the potential by {-np.min(rise):.3g} N·mm")
    return problems
