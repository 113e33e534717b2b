"""The ring of the pin wheel as a curved beam: displacements of the pin seats under unit forces at the seats.

Winkler's curved beam with shear about its neutral radius, in a Fourier series whose orders have 3 × 3 matrices in (u_r, u_t, θ);
the first three terms in 1/n are summed in closed form, so that the rest falls like n⁻⁵. Energy and supports: docs/theory/ring.md.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import log1p, pi

import numpy as np

from ltca.arrays import FloatArray
from ltca.drive.parts import Drive

ORDERS = 512
"""Fourier orders summed one by one; the rest of the sum is below 1e-12 of it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RingBeam:
    """A ring of rectangular section as a curved beam; lengths in mm, Young's modulus in MPa."""

    inner_radius: float
    outer_radius: float
    width: float
    youngs_modulus: float
    poisson_ratio: float

    @property
    def height(self) -> float:
        """Radial height of the section, mm."""
        return self.outer_radius - self.inner_radius

    @property
    def neutral_radius(self) -> float:
        """Radius about which bending does not stretch the ring, mm."""
        return self.height / self._wall

    def free(self, seats: FloatArray, radius: float) -> FloatArray:
        """Return displacements of seats beyond their rigid motion by unit forces there, mm/N, shape (seats, 2, seats, 2).

        Opposite forces stretch a thin ring by (π/4 − 2/π) F R³/EI:

        >>> ring = RingBeam(inner_radius=99.9, outer_radius=100.1, width=10.0, youngs_modulus=2e5, poisson_ratio=0.0)
        >>> found = ring.free(np.array([0.0, 0.5, 1.0, 1.5]) * pi, 100.0)
        >>> stretch = 2.0 * (found[0, 0, 0, 0] - found[0, 0, 2, 0])
        >>> expected = (pi / 4.0 - 2.0 / pi) * 100.0**3 / (2e5 * 10.0 * 0.2**3 / 12.0)
        >>> bool(abs(stretch / expected - 1.0) < 1e-5)
        True
        """
        among = self._among(seats, radius, seats, radius)
        modes = rigid_motions(seats, radius).reshape(-1, 3)
        found = beyond_rigid_motions(modes, among.reshape(2 * seats.size, -1))
        return np.asarray(found.reshape(among.shape))

    def bolted(
        self, seats: FloatArray, radius: float, bolts: FloatArray, circle: float, stiffness: float
    ) -> FloatArray:
        """Return displacements of the seats of a ring on bolts, as `free`; bolts at angles (rad) on a circle (mm), N/mm each."""
        places = np.concatenate((seats, bolts))
        radii = np.concatenate((np.full(seats.size, radius), np.full(bolts.size, circle)))
        among = self._among(places, radii, places, radii).reshape(2 * places.size, -1)
        modes = rigid_motions(places, radii).reshape(-1, 3)
        return on_bolts(beyond_rigid_motions(modes, among), modes, seats.size, stiffness)

    def built_in(self, seats: FloatArray, radius: float) -> FloatArray:
        """Return displacements of the seats of a ring whose outer face is held all around, as `free`."""
        outer = self.outer_radius
        bend = self.youngs_modulus * self._second_moment(outer)
        shear = self._shear_modulus * outer**2 * self._wall
        # θ of a ring: bend θ″ − shear θ = −moment by the angle; its periodic solution under a unit moment.
        apart = (seats[:, None] - seats) % (2.0 * pi)
        rate = np.sqrt(shear / bend)
        # cosh(λ(π − φ))/sinh(λπ) without overflow.
        decay = (np.exp(-rate * apart) + np.exp(-rate * (2.0 * pi - apart))) / -np.expm1(-2.0 * pi * rate)
        turned = decay / (2.0 * self.width * np.sqrt(shear * bend))
        along = 1j * np.exp(1j * seats)
        tangent = np.stack((along.real, along.imag), axis=-1)
        return np.asarray((radius - outer) ** 2 * np.einsum("ij,ia,jb->iajb", turned, tangent, tangent))

    @property
    def _wall(self) -> float:
        """L."""
        return log1p(self.height / self.inner_radius)

    def _second_moment(self, about: float) -> float:
        """∫(r − about)²/r dr over the height, mm², by quadrature: closed forms of thin rings are differences of large numbers."""
        nodes, weights = np.polynomial.legendre.leggauss(24)
        radii = self.inner_radius + 0.5 * self.height * (1.0 + nodes)
        return float(np.sum(0.5 * self.height * weights * (radii - about) ** 2 / radii))

    @property
    def _shear_modulus(self) -> float:
        """κG, MPa."""
        ratio = self.poisson_ratio
        factor = 10.0 * (1.0 + ratio) / (12.0 + 11.0 * ratio)
        return factor * self.youngs_modulus / (2.0 * (1.0 + ratio))

    def _among(
        self, to: FloatArray, to_radius: FloatArray | float, of: FloatArray, of_radius: FloatArray | float
    ) -> FloatArray:
        """Displacements of places under unit forces at others, all by angle (rad) and radius (mm), but for rigid motions."""
        apart = (to[:, None] - of) % (2.0 * pi)
        lever = np.broadcast_to(np.asarray(to_radius) - self.neutral_radius, to.shape)[:, None]
        load = np.broadcast_to(np.asarray(of_radius) - self.neutral_radius, of.shape)
        even, odd = self._series(apart)
        polar = np.empty((to.size, 2, of.size, 2))
        polar[:, 0, :, 0] = even[0, 0]
        polar[:, 1, :, 0] = odd[1, 0] + lever * odd[2, 0]
        polar[:, 0, :, 1] = -(odd[0, 1] + load * odd[0, 2])
        polar[:, 1, :, 1] = even[1, 1] + lever * even[2, 1] + load * even[1, 2] + lever * load * even[2, 2]
        return np.asarray(np.einsum("ipa,ipjq,jqb->iajb", _axes(to), polar, _axes(of)))

    def _series(self, apart: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Sums of the inverses of the orders' matrices with cosines and with sines, 1/N, shape (3, 3, …)."""
        wall, radius = self._wall, self.neutral_radius
        stretch = self.youngs_modulus * wall * self.width
        bend = self.youngs_modulus * self._second_moment(radius) * self.width
        shear = self._shear_modulus * wall * self.width

        # Of each order n the matrix is n² first + n second + third, by (u_r, u_t, θ).
        first = np.diag([shear, stretch, bend])
        second, third = np.zeros((3, 3)), np.diag([stretch, shear, radius**2 * shear])
        second[0, 1] = second[1, 0] = stretch + shear
        second[0, 2] = second[2, 0] = -radius * shear
        third[1, 2] = third[2, 1] = -radius * shear
        squares = np.linalg.inv(first)
        cubes = -squares @ second @ squares
        fourths = squares @ second @ squares @ second @ squares - squares @ third @ squares
        order = np.arange(1, ORDERS + 1)[:, None, None]
        matrices = order**2 * first + order * second + third
        inverse = np.concatenate(
            (np.linalg.pinv(matrices[:1], rcond=1e-10, hermitian=True), np.linalg.inv(matrices[1:]))
        )
        left = inverse - squares / order**2 - cubes / order.astype(float) ** 3 - fourths / order.astype(float) ** 4
        # Seats stand at few distinct distances.
        angles, places = np.unique(np.round(apart, 12), return_inverse=True)
        turned = np.arange(1, ORDERS + 1)[:, None] * angles
        cosines = np.einsum("nij,nk->ijk", left, np.cos(turned))
        sines = np.einsum("nij,nk->ijk", left, np.sin(turned))
        cosines += squares[..., None] * (pi**2 / 6.0 - pi * angles / 2.0 + angles**2 / 4.0)
        cosines += fourths[..., None] * (
            pi**4 / 90.0 - pi**2 * angles**2 / 12.0 + pi * angles**3 / 12.0 - angles**4 / 48.0
        )
        sines += cubes[..., None] * (angles**3 / 12.0 - pi * angles**2 / 4.0 + pi**2 * angles / 6.0)
        # Order 0: the ring as a whole grows under an even pressure, and shears between pins and bolts that turn it.
        cosines += 0.5 * np.linalg.pinv(third, rcond=1e-10, hermitian=True)[..., None]
        # Terms that mix u_r with the others are odd in the order, the others even.
        shape = (3, 3, *apart.shape)
        return (cosines[..., places].reshape(shape) / pi, sines[..., places].reshape(shape) / pi)


def rigid_motions(angles: FloatArray, radius: FloatArray | float) -> FloatArray:
    """Return the displacements (x, y) of places by unit x, y and rotation of a rigid ring, shape (places, 2, 3)."""
    place = np.asarray(radius) * np.exp(1j * angles)
    motions = np.zeros((angles.size, 2, 3))
    motions[:, 0, 0] = motions[:, 1, 1] = 1.0
    motions[:, 0, 2], motions[:, 1, 2] = -place.imag, place.real
    return motions


def on_bolts(among: FloatArray, modes: FloatArray, seats: int, stiffness: float) -> FloatArray:
    """Return the flexibility at the seats of a ring on bolts from that of the free one at seats, then bolts, and rigid modes."""
    count = 2 * seats
    bolts = len(among) - count
    # Forces t of the bolts on the ring and its rigid motion g: the bolts yield by −t/k, all forces balance.
    held = among[count:, count:] + np.eye(bolts) / stiffness
    system = np.block([[held, modes[count:]], [modes[count:].T, np.zeros((3, 3))]])
    right = np.concatenate((-among[count:, :count], -modes[:count].T))
    reaction, motion = np.split(np.linalg.solve(system, right), [bolts])
    found = among[:count, :count] + among[:count, count:] @ reaction + modes[:count] @ motion
    return np.asarray(0.5 * (found + found.T).reshape(seats, 2, seats, 2))


def beyond_rigid_motions(modes: FloatArray, flexibility: FloatArray) -> FloatArray:
    """A flexibility without the motions that fit best, and for forces without their dual part."""
    base, _ = np.linalg.qr(modes)
    once = flexibility - base @ (base.T @ flexibility)
    found = once - (once @ base) @ base.T
    return np.asarray(0.5 * (found + found.T))


def _axes(angles: FloatArray) -> FloatArray:
    """Components (x, y) of the radial and of the tangential direction, shape (places, 2, 2)."""
    cosine, sine = np.cos(angles), np.sin(angles)
    return np.stack((cosine, sine, -sine, cosine), axis=-1).reshape(-1, 2, 2)


def beam_flexibility(drive: Drive) -> FloatArray | None:
    """Return displacements of evenly spaced seats by unit forces at their centres, mm/N, (z_P, 2, z_P, 2); None where rigid."""
    ring, wheel = drive.ring, drive.pin_wheel
    if ring is None:
        return None
    beam = RingBeam(
        inner_radius=ring.inner_radius,
        outer_radius=ring.outer_radius,
        width=ring.width,
        youngs_modulus=ring.material.youngs_modulus,
        poisson_ratio=ring.material.poisson_ratio,
    )
    seats = 2.0 * pi * np.arange(wheel.number_of_pins) / wheel.number_of_pins
    if ring.flange == "built-in":
        return beam.built_in(seats, wheel.pin_circle_radius)
    if ring.bolts is None:
        return beam.free(seats, wheel.pin_circle_radius)
    bolts = 2.0 * pi * np.arange(ring.bolts.number) / ring.bolts.number
    return beam.bolted(seats, wheel.pin_circle_radius, bolts, ring.bolts.circle_radius, ring.bolts.stiffness)
