"""Bearings as one-sided springs, for the independent check: energies of each side, and of shafts on two of them.

Independent of `ltca.equilibrium.supports` and `ltca.laws.bearing_pair`: rows are sums over rolling elements that press or do not
(`ElementRow`), sides of a bearing are springs that press or do not, and the displacements of a shaft at its bearings are found by
minimising the energy, pose by pose.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ltca.arrays import ComplexArray, FloatArray
from ltca.drive.parts import Drive, Preload

ELEMENTS = 120
"""Rolling elements of a row: while all press, sums over a circle do not depend on their number from three on."""


@dataclass(frozen=True, kw_only=True)
class ElementRow:
    """A row of rolling elements each of which presses along its normal with Q = c qⁿ of its approach q, where that is positive.

    Parameters
    ----------
    power : float
        n.
    load_constant : float
        K of the axial force F = K δⁿ of the row at an axial displacement δ alone, N/mmⁿ.
    angle : float
        Of the normals against the radial plane, rad.
    pressed : float
        δ at rest, mm.
    facing : int
        +1 where a displacement towards +z presses the row.
    """

    power: float
    load_constant: float
    angle: float
    pressed: float
    facing: int = 1

    def loads(self, radial: float = 0.0, axial: float = 0.0) -> tuple[FloatArray, FloatArray]:
        """Return normal load and stiffness of every element at a displacement along x and z, N and N/mm."""
        into_row = self.pressed + self.facing * axial
        approach = np.maximum(into_row * np.sin(self.angle) + radial * np.cos(self.angle) * self._ahead, 0.0)
        # K δⁿ = Z c (δ sin α)ⁿ sin α
        constant = self.load_constant / (ELEMENTS * np.sin(self.angle) ** (self.power + 1.0))
        return constant * approach**self.power, constant * self.power * approach ** (self.power - 1.0)

    def forces(self, radial: float = 0.0, axial: float = 0.0) -> tuple[float, float]:
        """Return what resists along x and z, N."""
        loads = self.loads(radial, axial)[0]
        return float((loads * self._ahead).sum() * np.cos(self.angle)), self.facing * float(loads.sum()) * float(
            np.sin(self.angle)
        )

    @property
    def radial_stiffness(self) -> float:
        """Stiffness along x at rest, N/mm."""
        return float((self.loads()[1] * (np.cos(self.angle) * self._ahead) ** 2).sum())

    @property
    def reach(self) -> float:
        """Radial displacement at which the element opposite to it is free, mm."""
        return self.pressed * float(np.sin(self.angle) / np.cos(self.angle))

    @property
    def _ahead(self) -> FloatArray:
        return np.cos(2.0 * np.pi * np.arange(ELEMENTS) / ELEMENTS)


@dataclass(frozen=True, kw_only=True)
class SidedSpring:
    """A radial bearing of two opposite sides.

    Parameters
    ----------
    side : float
        Stiffness of one side, N/mm.
    pressed : float
        Displacement by which each side is pressed in at rest, mm; a gap where negative; infinite where both always carry.
    beside : float
        Stiffness of rows that carry on both sides always, N/mm.
    normal : float or None
        Sum of the loads of all rolling elements at rest, N; where omitted that of two sides.
    """

    side: float
    pressed: float
    beside: float = 0.0
    normal: float | None = None

    def energy(self, distance: FloatArray) -> FloatArray:
        """Return the energy of a displacement, N·mm, less that at rest."""
        if np.isinf(self.pressed):
            return np.asarray(self.side * distance**2)
        ahead, behind = np.maximum(self.pressed + distance, 0.0), np.maximum(self.pressed - distance, 0.0)
        if self.pressed < 0.0:
            behind = np.zeros_like(behind)
        rest = max(self.pressed, 0.0)
        sides = self.side * (ahead**2 + behind**2 - 2.0 * rest**2)
        return np.asarray(0.5 * (sides + self.beside * distance**2))

    def slopes(self, distance: float) -> tuple[float, float]:
        """Return force and stiffness at a displacement, N and N/mm."""
        if np.isinf(self.pressed):
            return 2.0 * self.side * distance, 2.0 * self.side
        ahead, behind = self.pressed + distance, self.pressed - distance
        force = self.side * (max(ahead, 0.0) - (max(behind, 0.0) if self.pressed > 0.0 else 0.0))
        sides = int(ahead > 0.0) + int(behind > 0.0 and self.pressed > 0.0)  # of numpy's truths True + True is True
        return force + self.beside * distance, self.side * sides + self.beside

    @property
    def load_at_rest(self) -> float:
        """Sum of the loads of both sides, or of all rolling elements, at rest, N."""
        if self.normal is not None:
            return self.normal
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


def _elements(power: float, angle: float, axial: float | None, constant: float | None, preload: Preload) -> ElementRow:
    """A preloaded row: F = K δⁿ at the preload, or what has the axial stiffness there."""
    force, pressed = preload.force, preload.displacement
    if constant is None:
        assert axial is not None
        pressed = power * force / axial if pressed is None and force is not None else pressed
        assert pressed is not None
        constant = axial * pressed ** (1.0 - power) / power
    elif pressed is None:
        assert force is not None
        pressed = (force / constant) ** (1.0 / power)
    return ElementRow(power=power, load_constant=constant, angle=angle, pressed=pressed)


def _rows_together(rows: list[ElementRow], beside: float) -> SidedSpring:
    """Preloaded rows, one side of which lifts off where they do on the average, beside others."""
    stiffness = [row.radial_stiffness for row in rows]
    reach = sum(one * row.reach for one, row in zip(stiffness, rows, strict=True)) / sum(stiffness)
    normal = float(sum(row.loads()[0].sum() for row in rows))
    return SidedSpring(side=0.5 * sum(stiffness), pressed=reach, beside=beside, normal=normal)


def crank_springs(drive: Drive) -> tuple[SidedSpring, SidedSpring]:
    """Return the two bearings of a crank."""
    support = drive.crank.support
    assert support is not None
    if support.load_constant is not None:
        assert support.preload is not None
        row = _elements(10.0 / 9.0, support.contact_angle or 0.0, None, support.load_constant, support.preload)
        return _rows_together([row], 0.0), _rows_together([row], 0.0)
    first, second = (_spring(value, support.clearance, support.preload) for value in support.stiffness)
    return first, second


def wheel_rows(drive: Drive) -> tuple[list[ElementRow], float]:
    """Return the preloaded rows of the main bearing, and the radial stiffness of its others, N/mm."""
    bearing, rows, others = drive.main_bearing, [], 0.0
    assert bearing is not None
    for row in bearing.bearings:
        power = 10.0 / 9.0 if row.kind in ("tapered roller", "cylindrical") else 1.5
        preload = row.preload or bearing.preload
        if not row.contact_angle:
            others += row.radial_stiffness or 0.0
        elif preload is None:
            others += 0.5 * (row.axial_stiffness or 0.0) / np.tan(row.contact_angle) ** 2
        else:
            rows.append(_elements(power, row.contact_angle, row.axial_stiffness, row.load_constant, preload))
    return rows, float(others)


def wheel_spring(drive: Drive) -> SidedSpring | None:
    """Return the main bearing; None where it is rigid."""
    bearing, alias = drive.main_bearing, drive.pin_wheel.support_stiffness
    if bearing is None:
        return None if alias is None else _spring(alias, None, None)
    if not bearing.bearings:
        return _spring(bearing.radial_stiffness or alias or 0.0, bearing.clearance, bearing.preload)
    rows, others = wheel_rows(drive)
    return _rows_together(rows, others) if rows else _spring(others, bearing.clearance, None)


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
