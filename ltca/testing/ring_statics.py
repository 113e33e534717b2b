r"""The elastic ring of the pin wheel by statics: complementary energy with redundants, independently of `ltca.laws.ring_beam`.

A ring that is cut at one place is a cantilever: the force through a section, and its moment about the centre, are those at the
cut less the forces passed on the way. Force and moment at the cut, and the forces of bolts, are redundants, by which the
complementary energy is stationary (Castigliano):

.. math:: U^* = \oint \frac{N^2}{2 E b L} + \frac{M^2}{2 E b h e} + \frac{V^2}{2 \kappa G b L} \, d\varphi
          + \sum_{bolts} \frac{|t|^2}{2 k}, \qquad L = \ln(r_o/r_i), \quad e = R_c - r_n,

with M about the neutral radius. Integrals over sections and angles are quadratures. No Fourier series and no stiffness of a
section by displacements is used. Where the outer face is held, sections are prisms that turn about it on an elastic
foundation, joined by the direct stiffness method.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ltca.arrays import FloatArray
from ltca.drive.members.ring import Ring
from ltca.drive.parts import Drive

NODES = 8
"""Gauss points of a stretch of at most a quarter of a radian: integrands are polynomials in sine and cosine."""


def ring_by_statics(drive: Drive) -> FloatArray | None:
    """Return displacements of the seats of the wheel pins under unit forces there, mm/N; None for a rigid ring.

    Shape (z_P, 2, z_P, 2), by seat and component (x, y) in the wheel.
    """
    ring, wheel = drive.ring, drive.pin_wheel
    if ring is None:
        return None
    angles = 2.0 * np.pi * np.arange(wheel.number_of_pins) / wheel.number_of_pins
    return flexibility_by_statics(ring, angles, wheel.pin_circle_radius)


def flexibility_by_statics(ring: Ring, angles: FloatArray, radius: float) -> FloatArray:
    """Return displacements of seats at angles (rad) on a circle (mm), shape (seats, 2, seats, 2), mm/N.

    Of a free ring they are those beyond the rigid motion that fits the seats best, under forces without what that motion works
    with.
    """
    count = angles.size
    if ring.flange == "built-in":
        return _on_foundation(ring, angles, radius)
    places, reach = angles, np.full(count, radius)
    if ring.bolts is not None:
        at = 2.0 * np.pi * np.arange(ring.bolts.number) / ring.bolts.number
        places, reach = (
            np.concatenate((angles, at)),
            np.concatenate((reach, np.full(at.size, ring.bolts.circle_radius))),
        )
    # Energy by forces at the places and by the three redundants of the cut.
    energy = _complementary(ring, places, reach)
    statics = _resultants(places, reach)
    if ring.bolts is None:
        # Forces less the part that a rigid body would feel, spread over the seats as displacements of a rigid body.
        spread = np.eye(2 * count) - statics.T @ np.linalg.solve(statics @ statics.T, statics)
        inner = energy[2 * count :, 2 * count :]
        mixed = energy[2 * count :, : 2 * count]
        found = energy[: 2 * count, : 2 * count] - mixed.T @ np.linalg.solve(inner, mixed)
        return np.asarray((spread @ found @ spread).reshape(count, 2, count, 2))
    bolts = slice(2 * count, 2 * places.size)
    energy[bolts, bolts] += np.eye(2 * places.size - 2 * count) / ring.bolts.stiffness
    # Redundants x make the energy stationary while all forces balance.
    free = energy[2 * count :, 2 * count :]
    holds = np.concatenate((statics[:, bolts], np.zeros((3, 3))), axis=1)
    scale = 1.0 / np.sqrt(np.diagonal(free))
    lever = np.array([1.0, 1.0, 1.0 / radius])[:, None]
    system = np.block(
        [[free * np.outer(scale, scale), (lever * holds * scale).T], [lever * holds * scale, np.zeros((3, 3))]]
    )
    given = np.concatenate((energy[2 * count :, : 2 * count] * scale[:, None], lever * statics[:, : 2 * count]))
    redundants = -np.linalg.solve(system, given)[: free.shape[0]] * scale[:, None]
    own, mixed = energy[: 2 * count, : 2 * count], energy[: 2 * count, 2 * count :]
    # ½ fᵀ(...)f at the stationary point, by all its parts.
    found = own + mixed @ redundants + redundants.T @ mixed.T + redundants.T @ free @ redundants
    return np.asarray(found.reshape(count, 2, count, 2))


def _resultants(angles: FloatArray, radii: FloatArray) -> FloatArray:
    """Resultant force and moment about the centre of unit forces (x, y) at places, shape (3, 2 places)."""
    x, y = radii * np.cos(angles), radii * np.sin(angles)
    found = np.zeros((3, angles.size, 2))
    found[0, :, 0] = found[1, :, 1] = 1.0
    found[2, :, 0], found[2, :, 1] = -y, x
    return found.reshape(3, -1)


def _radial_quadrature(ring: Ring, centre: float) -> tuple[float, float]:
    """∫dr/r and ∫(r − centre)²/r dr over the section, the second in mm²."""
    nodes, weights = np.polynomial.legendre.leggauss(40)
    half = 0.5 * (ring.outer_radius - ring.inner_radius)
    r = 0.5 * (ring.outer_radius + ring.inner_radius) + half * nodes
    return float(np.sum(weights * half / r)), float(np.sum(weights * half * (r - centre) ** 2 / r))


def _shear_modulus(ring: Ring) -> float:
    """κG of a rectangle (Cowper 1966), MPa."""
    modulus, ratio = ring.material.youngs_modulus, ring.material.poisson_ratio
    return 5.0 * modulus / (12.0 + 11.0 * ratio)


def _complementary(ring: Ring, angles: FloatArray, radii: FloatArray) -> FloatArray:
    """Second derivatives of the complementary energy by forces (x, y) at places and by those of the cut at angle 0."""
    inverse, _ = _radial_quadrature(ring, 0.0)
    neutral = (ring.outer_radius - ring.inner_radius) / inverse  # about which ∫(r − neutral)/r dr vanishes
    _, second = _radial_quadrature(ring, neutral)
    modulus, width = ring.material.youngs_modulus, ring.width
    yielding = 1.0 / (width * np.array([modulus * inverse, modulus * second, _shear_modulus(ring) * inverse]))
    marks = np.unique(np.concatenate(([0.0], np.sort(angles % (2.0 * np.pi)), [2.0 * np.pi])))
    pieces = [np.linspace(low, high, int(4.0 * (high - low)) + 2)[:-1] for low, high in pairwise(marks)]
    marks = np.concatenate((*pieces, [2.0 * np.pi]))
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    half = 0.5 * np.diff(marks)
    at = (0.5 * (marks[1:] + marks[:-1])[:, None] + half[:, None] * nodes).ravel()
    weight = (half[:, None] * weights).ravel()
    # Force and moment about the centre that the part behind a section passes on to the part ahead.
    passed = (at[:, None] > (angles % (2.0 * np.pi))[None, :]).astype(float)
    through = np.zeros((at.size, 3, angles.size, 2))
    unit = _resultants(angles, radii).reshape(3, angles.size, 2)
    through += passed[:, None, :, None] * unit
    whole = np.concatenate((through.reshape(at.size, 3, -1), np.broadcast_to(np.eye(3), (at.size, 3, 3))), axis=2)
    cos, sin = np.cos(at)[:, None], np.sin(at)[:, None]
    normal = -sin * whole[:, 0] + cos * whole[:, 1]
    shear = cos * whole[:, 0] + sin * whole[:, 1]
    moment = whole[:, 2] - neutral * normal
    return np.asarray(
        sum(
            (each * (weight * soft)[:, None]).T @ each
            for each, soft in zip((normal, moment, shear), yielding, strict=True)
        )
    )


def _on_foundation(ring: Ring, angles: FloatArray, radius: float) -> FloatArray:
    """Flexibility of a ring whose outer face is held: sections turn about it, each pair of neighbours a prism on a foundation."""
    order = np.argsort(angles % (2.0 * np.pi))
    placed = (angles % (2.0 * np.pi))[order]
    outer = ring.outer_radius
    inverse, second = _radial_quadrature(ring, outer)
    bend = ring.material.youngs_modulus * ring.width * second
    hold = _shear_modulus(ring) * ring.width * outer**2 * inverse
    rate = np.sqrt(hold / bend)
    stiffness = np.zeros((placed.size, placed.size))
    for first in range(placed.size):
        other = (first + 1) % placed.size
        length = rate * ((placed[other] - placed[first]) % (2.0 * np.pi) or 2.0 * np.pi)
        itself, across = bend * rate / np.tanh(length), -bend * rate * 2.0 * np.exp(-length) / -np.expm1(-2.0 * length)
        for one, two, value in (
            (first, first, itself),
            (other, other, itself),
            (first, other, across),
            (other, first, across),
        ):
            stiffness[one, two] += value
    turned = np.empty_like(stiffness)
    turned[np.ix_(order, order)] = np.linalg.inv(stiffness)
    tangent = np.stack((-np.sin(angles), np.cos(angles)), axis=1)
    return np.asarray((radius - outer) ** 2 * np.einsum("ij,ia,jb->iajb", turned, tangent, tangent))
