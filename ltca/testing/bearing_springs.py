"""Bearings as one-sided springs, for the independent check: energies of each side, and of shafts on two of them.

Independent of `ltca.equilibrium.supports` and `ltca.laws.bearing_pair`: rows are summed over their rolling elements, sides of
a bearing are springs that press or do not, and the displacements of a shaft at its bearings are found by minimising the
energy, pose by pose.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ltca.arrays import ComplexArray, FloatArray
from ltca.drive.parts import Drive, Preload

ELEMENTS = 12
"""Rolling elements of a row: sums of cos² and sin² over a circle do not depend on their number from three on."""


@dataclass(frozen=True, kw_only=True)
class SidedSpring:
    """A radial bearing of two opposite sides.

    Parameters
    ----------
    side : float
        Stiffness of one side, N/mm.
    pressed : float
        Displacement by which each side is pressed in at rest, mm; a gap where negative; infinite where both always carry.
    """

    side: float
    pressed: float

    def energy(self, distance: FloatArray) -> FloatArray:
        """Return the energy of a displacement, N·mm, less that at rest."""
        if np.isinf(self.pressed):
            return np.asarray(self.side * distance**2)
        ahead, behind = np.maximum(self.pressed + distance, 0.0), np.maximum(self.pressed - distance, 0.0)
        if self.pressed < 0.0:
            behind = np.zeros_like(behind)
        rest = max(self.pressed, 0.0)
        return np.asarray(0.5 * self.side * (ahead**2 + behind**2 - 2.0 * rest**2))

    def slopes(self, distance: float) -> tuple[float, float]:
        """Return force and stiffness at a displacement, N and N/mm."""
        if np.isinf(self.pressed):
            return 2.0 * self.side * distance, 2.0 * self.side
        ahead, behind = self.pressed + distance, self.pressed - distance
        force = self.side * (max(ahead, 0.0) - (max(behind, 0.0) if self.pressed > 0.0 else 0.0))
        sides = int(ahead > 0.0) + int(behind > 0.0 and self.pressed > 0.0)  # of numpy's truths True + True is True
        return force, self.side * sides

    @property
    def sides_together(self) -> float:
        """Sum of the loads of both sides at rest, N."""
        return 0.0 if np.isinf(self.pressed) else 2.0 * self.side * max(self.pressed, 0.0)


def _spring(stiffness: float, clearance: float | None, preload: Preload | None) -> SidedSpring:
    if clearance is not None:
        return SidedSpring(side=stiffness, pressed=-0.5 * clearance)
    if preload is None:
        return SidedSpring(side=0.5 * stiffness, pressed=np.inf)
    pressed = preload.displacement
    return SidedSpring(
        side=0.5 * stiffness, pressed=(preload.force or 0.0) / (0.5 * stiffness) if pressed is None else pressed
    )


def _row(
    power: float, angle: float, axial: float | None, constant: float | None, preload: Preload | None
) -> tuple[float, float]:
    """Radial stiffness of a row about its preload, by its rolling elements, and the radial displacement that unloads one."""
    force, pressed = (None, None) if preload is None else (preload.force, preload.displacement)
    if constant is not None:  # F = K δⁿ of all elements together, each by its approach δ sin α
        pressed = (force / constant) ** (1.0 / power) if pressed is None and force is not None else pressed
        assert pressed is not None
        normal = power * constant * pressed ** (power - 1.0) / (ELEMENTS * np.sin(angle) ** 2)
    else:
        assert axial is not None
        pressed = power * force / axial if pressed is None and force is not None else pressed
        normal = axial / (ELEMENTS * np.sin(angle) ** 2)
    around = 2.0 * np.pi * np.arange(ELEMENTS) / ELEMENTS
    radial = float((normal * (np.cos(angle) * np.cos(around)) ** 2).sum())
    return radial, np.inf if pressed is None else pressed * np.sin(angle) / np.cos(angle)


def crank_springs(drive: Drive) -> tuple[SidedSpring, SidedSpring]:
    """Return the two bearings of a crank."""
    support = drive.crank.support
    assert support is not None
    if support.load_constant is not None:
        radial, reach = _row(10.0 / 9.0, support.contact_angle or 0.0, None, support.load_constant, support.preload)
        spring = SidedSpring(side=0.5 * radial, pressed=reach)
        return spring, spring
    first, second = (_spring(value, support.clearance, support.preload) for value in support.stiffness)
    return first, second


def wheel_spring(drive: Drive) -> SidedSpring | None:
    """Return the main bearing; None where it is rigid."""
    bearing, alias = drive.main_bearing, drive.pin_wheel.support_stiffness
    if bearing is None:
        return None if alias is None else _spring(alias, None, None)
    if not bearing.bearings:
        return _spring(bearing.radial_stiffness or alias or 0.0, bearing.clearance, bearing.preload)
    total, nearest = 0.0, np.inf
    for row in bearing.bearings:
        if not row.contact_angle:
            total += row.radial_stiffness or 0.0
            continue
        power = 10.0 / 9.0 if row.kind == "tapered roller" else 1.5
        preload = row.preload or bearing.preload
        radial, reach = _row(power, row.contact_angle, row.axial_stiffness, row.load_constant, preload)
        total, nearest = total + radial, min(nearest, reach)
    if bearing.clearance is not None:
        return _spring(total, bearing.clearance, None)
    return SidedSpring(side=0.5 * total, pressed=nearest)


def softened(bending: FloatArray, springs: tuple[SidedSpring, ...]) -> FloatArray:
    """Return deflections on rigid bearings, mm/N, with a flexibility too small to matter: a disc in the plane of a bearing bends
    nothing.
    """
    return np.asarray(bending + 1e-9 / max(2.0 * spring.side for spring in springs) * np.eye(bending.shape[0]))


def shaft_energy(
    bending: FloatArray,
    shares: FloatArray,
    springs: tuple[SidedSpring, ...],
    moved: ComplexArray,
    pull: ComplexArray | None = None,
) -> FloatArray:
    """Return the energy of a shaft, N·mm, at displacements in the planes of the discs, shape (poses, planes).

    `bending` are deflections on rigid bearings by forces in the planes, mm/N, and `shares` the parts of these forces that each
    bearing carries, shape (bearings, planes). `pull` are constant forces at the bearings, N, shape (bearings,), whose work is
    taken off.
    """
    stiff = np.asarray(np.linalg.inv(softened(bending, springs)), dtype=float)
    pulled = np.zeros(len(springs), dtype=complex) if pull is None else pull
    return np.array([_least(stiff, shares, springs, row, pulled) for row in moved])


def _least(
    stiff: FloatArray, shares: FloatArray, springs: tuple[SidedSpring, ...], moved: ComplexArray, pull: ComplexArray
) -> float:
    """Least energy by the displacements at the bearings: Newton's method with shortened steps."""
    count = len(springs)
    place = np.zeros(2 * count)

    def energy(at: FloatArray) -> float:
        each = at[::2] + 1j * at[1::2]
        rest = moved - each @ shares
        bent = 0.5 * float((rest.conj() @ stiff @ rest).real) - float((pull.conj() @ each).real)
        return bent + sum(float(spring.energy(np.abs(one))) for spring, one in zip(springs, each, strict=True))

    here = energy(place)
    for _ in range(200):
        each = place[::2] + 1j * place[1::2]
        pulled = -(shares @ (stiff @ (moved - each @ shares))) - pull
        gradient = np.stack((pulled.real, pulled.imag), axis=-1).ravel()
        hessian = np.kron(shares @ stiff @ shares.T, np.eye(2))
        for number, (spring, one) in enumerate(zip(springs, each, strict=True)):
            distance = abs(one)
            force, slope = spring.slopes(distance)
            ahead = np.array([one.real, one.imag]) / distance if distance else np.array([1.0, 0.0])
            own = slice(2 * number, 2 * number + 2)
            gradient[own] += force * ahead
            across = force / distance if distance else slope
            hessian[own, own] += across * np.eye(2) + (slope - across) * np.outer(ahead, ahead)
        step = -np.linalg.lstsq(hessian, gradient, rcond=1e-14)[0]
        part = 1.0
        while part > 1e-9 and (there := energy(place + part * step)) > here:
            part *= 0.5
        if part <= 1e-9 or here - there <= 1e-16 * abs(here):
            return min(here, there)
        place, here = place + part * step, there
    return here


def disc_coordinates(drive: Drive) -> int:
    """Return the number of coordinates of each disc: three, two for each crank on elastic supports, three where it twists."""
    support = drive.crank.support
    return 3 if support is None else 3 + (3 if support.torsion else 2) * drive.crank.number


def shaft_torsion(drive: Drive, twist: FloatArray) -> FloatArray:
    """Return the energy of all cranks, N·mm, at twists of their eccentrics, shape (poses, discs, cranks), rad.

    The shaft is a chain of pieces from the spline to one side and to the other, each GJ/2L times the square of its twist.
    """
    support, total = drive.crank.support, np.zeros(twist.shape[0])
    if support is None or not support.torsion:
        return total
    material = drive.materials.crankshaft
    rigidity = material.youngs_modulus / (2.0 + 2.0 * material.poisson_ratio) * np.pi * support.diameter**4 / 32.0
    planes, held = np.asarray(drive.disc.disc_planes), support.spline_plane or 0.0
    for side in (1.0, -1.0):
        last, before = 0.0, np.zeros(twist.shape[::2])
        for disc in np.argsort(side * (planes - held)):
            away = side * (planes[disc] - held)
            if away > 0.0:
                total = total + 0.5 * rigidity / (away - last) * ((twist[:, disc] - before) ** 2).sum(axis=1)
                last, before = away, twist[:, disc]
    return np.asarray(total)
