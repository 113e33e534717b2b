"""Whether a pose balances, found without the code that balances it.

Written apart from `ltca.geometry.pairs`, `ltca.compliance.rollers` and `ltca.equilibrium.balance`: distances from the
flank by a search over the whole trochoid, rollers placed by golden sections on their energy, nothing but energies.
The only things shared are the definition of the drive and the energy ∫F dδ of the contact laws. A pose balances when
its potential Π is a minimum: no small displacement lowers it, and its slope by central differences vanishes.

The effective radii of the flank contacts are held at those of the pose looked at: a frictionless contact pushes
along its normal with F(δ, ρ), and what the energy gains because the contact moves to another curvature (about 1e-3
of the contact's load, along the flank) is no force.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.drive.parts import Drive
from ltca.equilibrium.balance import Equilibrium

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

SAMPLES = 48
"""Samples of the trochoid for each tooth: Newton's method is safe from the nearest of them."""
_GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class PotentialEnergy:
    """Π of a drive at one crank angle, for many poses at once.

    Attributes
    ----------
    drive : Drive
        The drive; single-part errors included.
    model : HalfSpaceCompliance
        For the energies of its laws.
    crank_angle : float
        φ_C, rad.
    wheel_moment : float
        N·mm.
    """

    drive: Drive
    model: HalfSpaceCompliance
    crank_angle: float
    wheel_moment: float

    def at(self, pose: FloatArray) -> FloatArray:
        """Return Π of poses, shape (poses, 4), with the effective radii of the first of them, N·mm."""
        place = self.model.geometry.placement
        e, u = self.drive.crank.eccentricity, float(self.drive.reduction_ratio)
        shift = pose[:, 0] + 1j * pose[:, 1]
        centre = e * np.exp(1j * self.crank_angle) + shift
        back = np.exp(-1j * pose[:, 2])
        pins = place.wheel_pin_centres * np.exp(1j * (self.crank_angle / u + pose[:, 3]))[:, None]
        approach, radius = self._flank((pins - centre[:, None]) * back[:, None])
        energy = self.model.pin_law.energy(approach, radius[:1]).sum(axis=1)
        arm = place.hole_centres * np.exp(1j * pose[:, 2])[:, None]
        overlap = np.abs(place.shaft_pin_centres - centre[:, None] - arm) - (place.hole_radii - place.shaft_pin_radii)
        energy += 0.5 * self.drive.pin_shaft.stiffness * (np.maximum(overlap, 0.0) ** 2).sum(axis=1)
        energy += self._rollers(shift).sum(axis=1)
        return np.asarray(energy - self.wheel_moment * pose[:, 3])

    def _flank(self, point: ComplexArray) -> tuple[FloatArray, FloatArray]:
        """Approach and effective radius of pins whose centres are at points in the disc frame."""
        wheel, disc = self.drive.pin_wheel, self.drive.disc
        big, e = wheel.pin_circle_radius + disc.shifting_offset, self.drive.crank.eccentricity
        u, pins = float(self.drive.reduction_ratio), wheel.number_of_pins
        offset = wheel.pin_radius + disc.equidistant_offset
        samples = np.linspace(0.0, 2.0 * np.pi, SAMPLES * pins, endpoint=False)
        locus = big * np.exp(1j * samples) - e * np.exp(1j * u * samples)
        # All poses are within micrometres of the first: one search over the whole flank serves them all.
        nearest = np.argmin(np.abs(locus[:, None] - point[:1]), axis=0)
        theta = np.broadcast_to(samples[nearest], point.shape).copy()
        spacing = samples[1]
        for _ in range(12):
            c, dc, ddc = self._locus(theta, big, e, u)
            away = c - point
            slope = np.abs(dc) ** 2 + (np.conj(ddc) * away).real
            step = (np.conj(dc) * away).real / np.where(slope > 0.0, slope, np.abs(dc) ** 2)
            # Near a centre of curvature the slope all but vanishes: the place is between the neighbouring samples.
            theta = np.clip(theta - step, samples[nearest] - spacing, samples[nearest] + spacing)
        c, dc, ddc = self._locus(theta, big, e, u)
        normal = -1j * dc / np.abs(dc)
        distance = (np.conj(normal) * (point - c)).real
        bend = (np.conj(dc) * ddc).imag / np.abs(dc) ** 3
        radii = self.model.geometry.placement.wheel_pin_radii
        return radii - offset - distance, 1.0 / (1.0 / radii + bend / (1.0 - offset * bend))

    @staticmethod
    def _locus(theta: FloatArray, big: float, e: float, u: float) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        circle, crank = big * np.exp(1j * theta), e * np.exp(1j * u * theta)
        return circle - crank, 1j * (circle - u * crank), u * u * crank - circle

    def _rollers(self, shift: ComplexArray) -> FloatArray:
        """Energy of every roller at its best place on its ray."""
        place, laws = self.model.geometry.placement, self.model.roller_laws
        bearing = self.drive.crank_bearing
        speed = bearing.inner_race_radius / (bearing.inner_race_radius + bearing.outer_race_radius)
        ray = np.exp(1j * (speed * self.crank_angle + place.roller_cage_angles))
        most = place.inner_race_radius + place.roller_radii
        play = place.bore_radius - place.roller_radii
        across = (np.conj(ray) * shift[:, None]).imag
        along = (np.conj(ray) * shift[:, None]).real
        least = along + np.sqrt(play**2 - across**2)
        pressed = most > least
        low, high = np.where(pressed, least, 0.0), np.where(pressed, most, 1.0)

        def energy(s: FloatArray) -> FloatArray:
            outer = np.abs(s * ray - shift[:, None]) - play
            total = laws.inner.energy(most - s, laws.inner_radius) + laws.outer.energy(outer, laws.outer_radius)
            return np.asarray(np.where(pressed, total, 0.0))

        for _ in range(22):
            first, second = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
            lower = energy(first) < energy(second)
            low, high = np.where(lower, low, first), np.where(lower, second, high)
        return energy(0.5 * (low + high))


def find_imbalance(
    drive: Drive, model: HalfSpaceCompliance, balanced: Equilibrium, position: int = 0, seed: int = 0
) -> list[str]:
    """Return what speaks against a position being in equilibrium; empty when nothing does.

    Parameters
    ----------
    drive : Drive
        The drive.
    model : HalfSpaceCompliance
        Its laws.
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
        drive=drive, model=model, crank_angle=float(balanced.crank_angle[position]), wheel_moment=moment
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
    sizes = scale * np.repeat([1e-2, 1e-1, 1.0], 4)
    moves = np.concatenate([np.zeros((1, 4)), offsets, sizes[:, None] * directions])
    value = potential.at(pose + moves / lever)
    pairs = value[1:33].reshape(4, 2, 4)
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
    rise = value[33:] - value[0]
    if np.any(rise < -noise - 1e-4 * load * sizes):
        problems.append(f"a displacement lowers the potential by {-np.min(rise):.3g} N·mm")
    return problems
