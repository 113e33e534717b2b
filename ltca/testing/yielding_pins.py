"""Places and energies of loose and bent pins by explicit coordinates, independently of the laws in series of `ltca.laws`.

Coordinates are two complex numbers for every pin and disc: the displacement of the beam in the plane of the disc, and that of the
loose pin or sleeve from there. Nothing is eliminated, and no common normal is assumed: the slope of the potential by all
these coordinates vanishes where pins, sleeves and slots are in equilibrium. The stiffness of a beam comes from a quadrature of
bending moments and shear forces (the unit-load theorem), with forces and couples at held ends.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from ltca.arrays import ComplexArray, FloatArray
from ltca.drive.materials import Material
from ltca.drive.members.pins import PinShaft, PinWheel, WheelPinBeam
from ltca.drive.parts import Drive
from ltca.laws.backed import MAX_OVERLAP, BackedLaw
from ltca.laws.conforming import ConformingLaw
from ltca.testing.actual_parts import ActualParts

LOADS = np.concatenate([[0.0], np.geomspace(1e-9, 1.0, 300), np.linspace(1.02, 8.0, 60)])
"""Nodes of the energy of a seat, in units of its largest load."""


class EnergyLaw(Protocol):
    """Contact law with an energy."""

    def energy(self, approach: ArrayLike, effective_radius: ArrayLike) -> FloatArray:
        """∫F dδ, N·mm."""
        ...


@dataclass(frozen=True, kw_only=True)
class SeatEnergy:
    """∫F ds of seats, one for each pin.

    Parameters
    ----------
    law : ConformingLaw
        Approach at a load.
    play : array, shape (pins,)
        mm.
    largest : float
        Load about which energies are wanted, N.
    """

    law: ConformingLaw
    play: FloatArray
    largest: float

    def approach(self, load: FloatArray) -> FloatArray:
        """Return s at loads, shape (discs, pins), mm."""
        return self.law.approach_and_compliance(load, np.broadcast_to(self.play, load.shape))[0]

    def at(self, approach: FloatArray) -> FloatArray:
        """Return the energy at approaches, shape (rows, discs, pins), N·mm, by cubic Hermite interpolation between nodes."""
        found = np.zeros(approach.shape)
        for play in np.unique(self.play):
            own = self.play == play
            known, energy, load = self._known(float(play))
            s = np.maximum(approach[..., own], 0.0)
            piece = np.clip(np.searchsorted(known, s, side="right") - 1, 0, known.size - 2)
            width, t = known[piece + 1] - known[piece], (s - known[piece]) / (known[piece + 1] - known[piece])
            left = (1.0 + 2.0 * t) * energy[piece] + t * width * load[piece]
            right = (3.0 - 2.0 * t) * energy[piece + 1] + (t - 1.0) * width * load[piece + 1]
            value = (1.0 - t) ** 2 * left + t**2 * right
            # Beyond the last node: along the last slope.
            beyond = energy[-1] + load[-1] * (s - known[-1])
            found[..., own] = np.where(s < known[-1], value, beyond)
        return found

    def _known(self, play: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Approaches, energies and loads of the nodes."""
        loads = LOADS * max(self.largest, 1e-9)
        nodes, weights = np.polynomial.legendre.leggauss(4)
        middle, half = 0.5 * (loads[1:] + loads[:-1]), 0.5 * np.diff(loads)
        at = middle[:, None] + half[:, None] * nodes
        compliance = self.law.approach_and_compliance(at, np.full(at.shape, play))[1]
        pieces = ((at * compliance) @ weights) * half
        known = self.law.approach_and_compliance(loads, np.full(loads.shape, play))[0]
        return known, np.concatenate([[0.0], np.cumsum(pieces)]), loads


@dataclass(frozen=True, kw_only=True)
class ContactOfSleeves:
    """Contacts on sleeves, whose laws count the sleeve down to half its wall alone; approaches are found by bisection.

    `law` holds the law of the contact and the compliance that is subtracted.
    """

    law: BackedLaw

    def _off(self, near: FloatArray, effective_radius: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Subtracted approach at approaches of a whole half-space, its derivative, and the load."""
        load, stiffness = self.law.contact.load_and_stiffness(near, effective_radius)
        return *self.law.counted_twice(near, load, stiffness), load

    def energy(self, approach: ArrayLike, effective_radius: ArrayLike) -> FloatArray:
        """Return ∫F dδ, N·mm."""
        delta = np.asarray(approach, dtype=float)
        radius = np.broadcast_to(np.asarray(effective_radius, dtype=float), delta.shape)
        total, closed = np.zeros(delta.shape), delta > 0.0
        whole, radius = delta[closed], radius[closed]
        low, high = whole.copy(), whole / (1.0 - MAX_OVERLAP)
        for _ in range(52):
            middle = 0.5 * (low + high)
            above = middle - self._off(middle, radius)[0] > whole
            low, high = np.where(above, low, middle), np.where(above, middle, high)
        nodes, weights = np.polynomial.legendre.leggauss(20)
        for node, weight in zip(0.5 * (1.0 + nodes), 0.5 * weights, strict=True):
            _, slope, load = self._off(high * node**2, radius)
            total[closed] += 2.0 * weight * node * high * load * (1.0 - slope)
        return total


@dataclass(frozen=True, kw_only=True)
class YieldingPins:
    """Pins of one kind, at the displacements under the loads of an answer.

    Parameters
    ----------
    stiffness : array or None, shape (discs + 1, discs + 1) or (discs, discs)
        Forces of a beam by its displacements at the discs, and at its tip where a ring holds it, N/mm; None for rigid pins.
    seat : SeatEnergy or None
        None for fixed pins.
    load : array, shape (discs, pins)
        N.
    away : array of complex, shape (discs, pins)
        Unit vectors along which the discs press the pins.
    tip : array of complex, shape (pins,)
        Displacements of the tips, mm.
    """

    stiffness: FloatArray | None
    seat: SeatEnergy | None
    load: FloatArray
    away: ComplexArray
    tip: ComplexArray

    @property
    def bent(self) -> ComplexArray:
        """Displacement of the beams at the discs, mm, shape (discs, pins)."""
        if self.stiffness is None:
            return np.zeros(self.load.shape, dtype=complex)
        discs = self.load.shape[0]
        force = self.load * self.away
        if self.stiffness.shape[0] > discs:
            force = force - self.stiffness[:discs, discs:] @ self.tip[None]
        return np.asarray(np.linalg.solve(self.stiffness[:discs, :discs], force))

    @property
    def loose(self) -> ComplexArray:
        """Displacement of loose pins and sleeves from the axes of their seats, mm, shape (discs, pins)."""
        if self.seat is None:
            return np.zeros(self.load.shape, dtype=complex)
        return np.asarray((self.seat.play + self.seat.approach(self.load)) * self.away)

    def stored(self, bent: ComplexArray, loose: ComplexArray, tip: ComplexArray) -> FloatArray:
        """Return the energy of beams and seats, N·mm, shape (rows, pins), at displacements in mm.

        `bent` and `loose` have shape (rows, discs, pins), `tip` (rows, pins), all complex.
        """
        rows = max(bent.shape[0], loose.shape[0], tip.shape[0])
        total = np.zeros((rows, self.load.shape[1]))
        if self.stiffness is not None:
            moved = np.broadcast_to(bent, (rows, *bent.shape[1:]))
            if self.stiffness.shape[0] > bent.shape[1]:
                moved = np.concatenate([moved, np.broadcast_to(tip, (rows, tip.shape[1]))[:, None]], axis=1)
            total += 0.5 * np.einsum("rdp,de,rep->rp", moved.conj(), self.stiffness, moved).real
        if self.seat is not None:
            total += self.seat.at(np.abs(loose) - self.seat.play).sum(axis=1)
        return total

    @property
    def ways(self) -> ComplexArray:
        """Unit displacements of beams and loose parts in all their directions, shape (ways, 2, discs)."""
        discs = self.load.shape[0]
        kinds = [kind for kind, free in enumerate((self.stiffness, self.seat)) if free is not None]
        each = np.zeros((len(kinds), discs, 2, 2, discs), dtype=complex)
        for place, kind in enumerate(kinds):
            for disc in range(discs):
                each[place, disc, :, kind, disc] = (1.0, 1j)
        return each.reshape(-1, 2, discs)


def has_ring(drive: Drive) -> bool:
    """Tell whether a ring ties the tips of the shaft pins, or the carrier has a far flange on posts."""
    tied = drive.pin_shaft is not None and drive.pin_shaft.beam is not None and drive.pin_shaft.beam.tip != "free"
    return tied or drive.posts is not None


def ring_tips(drive: Drive, pose: FloatArray) -> ComplexArray:
    """Displacements of the tips of the shaft pins by the motion of their ring, mm, shape (poses, z_PS)."""
    places = ActualParts(drive, 0.0).shaft_pins[0]
    if not has_ring(drive):
        return np.zeros((pose.shape[0], places.size), dtype=complex)
    x, y, turned = pose[:, -4, None], pose[:, -3, None], pose[:, -2, None]
    return np.asarray(x + 1j * y + 1j * turned * places)


def post_forces(drive: Drive) -> FloatArray:
    """Return the forces on the far flange by its x, y and rotation, shape (3, 3), post by post from stiffness matrices of bars.

    Each post has displacement and rotation at both ends as unknowns, each end a spring to a flange that does not turn; the far
    flange is sheared between posts and pins by a quadrature of its rings.
    """
    assert drive.carrier is not None
    posts, flange, material = drive.carrier.posts, drive.carrier.flange, drive.materials.carrier
    assert posts is not None
    length = posts.length
    if length is None:
        beam = None if drive.pin_shaft is None else drive.pin_shaft.beam
        length = drive.disc.stack_length if beam is None or beam.span is None else beam.span
    nu, modulus = material.poisson_ratio, material.youngs_modulus
    second, area, shear = np.pi * posts.size**4 / 64.0, np.pi * posts.size**2 / 4.0, modulus / (2.0 * (1.0 + nu))
    phi = 12.0 * modulus * second / (6.0 * (1.0 + nu) / (7.0 + 6.0 * nu) * shear * area * length**2)
    bar = np.array([
        [12.0, 6.0 * length, -12.0, 6.0 * length],
        [6.0 * length, (4.0 + phi) * length**2, -6.0 * length, (2.0 - phi) * length**2],
        [-12.0, -6.0 * length, 12.0, -6.0 * length],
        [6.0 * length, (2.0 - phi) * length**2, -6.0 * length, (4.0 + phi) * length**2],
    ]) * modulus * second / ((1.0 + phi) * length**3)  # fmt: skip
    total, sheared = np.zeros((3, 3)), 0.0
    kept = [2]  # rotations at rigid flanges and the near displacement are held
    if flange is not None:
        # Strips to either side, as wide as the circle's radius; a neighbour turns as the post does.
        free = 2.0 * np.pi * posts.radius / posts.number - posts.size
        for place, thickness in zip((1, 3), flange, strict=True):
            strip = modulus * posts.radius * thickness**3 / 12.0 / free
            bar[place, place] += 2.0 * (4.0 + 2.0) * strip
        kept = [2, 1, 3]
        pins = drive.pin_shaft
        circle = (drive.crank.circle_radius or 0.0) if pins is None else pins.pin_circle_radius
        if circle:
            nodes, weights = np.polynomial.legendre.leggauss(40)
            low, high = sorted((posts.radius, circle))
            at = 0.5 * (high + low) + 0.5 * (high - low) * nodes
            sheared = float(0.5 * (high - low) * (weights / (2.0 * np.pi * shear * flange[1] * at**3)).sum())
    across = float(1.0 / np.linalg.inv(bar[np.ix_(kept, kept)])[0, 0])
    for angle in 2.0 * np.pi * np.arange(posts.number) / posts.number:
        x, y = posts.radius * np.cos(angle), posts.radius * np.sin(angle)
        moved = np.array([[1.0, 0.0, -y], [0.0, 1.0, x]])
        total += across * moved.T @ moved
        total[2, 2] += shear * 2.0 * second / length
    return np.asarray(np.linalg.inv(np.linalg.inv(total) + np.diag([0.0, 0.0, sheared])))


def contact_alone(law: EnergyLaw) -> EnergyLaw:
    """Return the law of the contacts themselves, on sleeves down to half their wall, without seats and beams behind them."""
    if not isinstance(law, BackedLaw):
        return law
    return ContactOfSleeves(law=law) if law.overlap else law.contact


def beam_stiffness(
    drive: Drive, part: PinWheel | PinShaft, material: Material, *, slopes: bool = False
) -> FloatArray | None:
    """Return the forces on a pin by its mean displacements along the discs, and that of a tip held by a ring, N/mm; None
    for rigid pins.

    With `slopes` mean slopes and moments of the discs, which press linearly along their width, stand behind displacements and
    forces of the discs, N and N·mm.
    """
    beam = part.beam
    if beam is None:
        return None
    span, width = drive.disc.stack_length if beam.span is None else beam.span, drive.disc.thickness
    middles = [plane + 0.5 * span for plane in drive.disc.disc_planes]
    if isinstance(beam, WheelPinBeam):
        basis, held, kept = "between", 2 if beam.ends == "clamped" else 0, len(middles)
    else:
        basis, held, kept = "flange", {"free": 0, "tied-pinned": 1, "tied-clamped": 2}[beam.tip], len(middles)
        kept += min(held, 1)
    if beam.diameter is not None:
        diameter = beam.diameter
    else:
        diameter = 2.0 * (part.pin_radius if part.seat.kind != "sleeve" else part.seat.pin_radius or 0.0)
    nodes, weights = np.polynomial.legendre.leggauss(6)
    ends = [middle + side * 0.5 * width for middle in middles for side in (-1.0, 1.0)]
    marks = np.unique(np.concatenate([[0.0, span], np.clip(ends, 0.0, span)]))
    half = 0.5 * np.diff(marks)
    at = (0.5 * (marks[1:] + marks[:-1])[:, None] + half[:, None] * nodes).ravel()
    weight = (half[:, None] * weights).ravel()
    moments, shears = _unit_loads(at, middles, width, span, basis, slopes=slopes)
    loads = len(middles) * (1 + slopes)
    moments, shears, kept = moments[: loads + held], shears[: loads + held], kept + slopes * len(middles)
    bending = material.youngs_modulus * np.pi * diameter**4 / 64.0
    ratio = material.poisson_ratio
    shear = 6.0 * (1.0 + ratio) / (7.0 + 6.0 * ratio) * material.youngs_modulus / (2.0 * (1.0 + ratio))
    shear *= np.pi * diameter**2 / 4.0
    yielding = (moments * weight) @ moments.T / bending + (shears * weight) @ shears.T / shear
    # Where ends may not turn the rotations that belong to their couples are zero.
    return np.asarray(np.linalg.inv(yielding)[:kept, :kept])


def _unit_loads(
    at: FloatArray, middles: Sequence[float], width: float, span: float, basis: str, *, slopes: bool = False
) -> tuple[FloatArray, FloatArray]:
    """Bending moments and shear forces of unit loads spread along the discs, with `slopes` of unit moments 12 (z − m)/w³ as well,
    followed by those of reactions at the ends.
    """
    moments, shears = [], []
    for middle in middles:
        low, high = middle - 0.5 * width, middle + 0.5 * width
        inside = np.clip(high - at, 0.0, width)
        # Of the part of the load beyond a section: a cantilever.
        moment = np.where(at < low, middle - at, 0.5 * inside**2 / width)
        shear = inside / width
        if basis == "between":  # less the cantilever's under the reaction at the far wall
            moment, shear = moment - middle / span * (span - at), shear - middle / span
        moments.append(moment)
        shears.append(shear)
    for middle in middles if slopes else ():
        a, h = np.clip(at - middle, -0.5 * width, 0.5 * width), 0.5 * width
        moment = np.where(at < middle - h, 1.0, 12.0 / width**3 * ((h**3 - a**3) / 3.0 - 0.5 * a * (h**2 - a**2)))
        shear = 6.0 * (h**2 - a**2) / width**3
        if basis == "between":
            moment, shear = moment - (span - at) / span, shear - 1.0 / span
        moments.append(moment)
        shears.append(shear)
    one = np.ones_like(at)
    if basis == "between":
        moments += [1.0 - at / span, at / span]
        shears += [one / span, -one / span]
    else:
        moments += [span - at, one]
        shears += [one, 0.0 * one]
    return np.stack(moments), np.stack(shears)


def crankshaft_bending(drive: Drive, beside: float | None = None, *, couple: bool = False) -> FloatArray:
    """Return the deflections of a crankshaft on rigid bearings in the planes of the discs by forces there, by quadrature of
    moments, mm/N.

    With `beside`, mm, also by a force in that plane, or by a `couple` there as a pair of opposite forces times their distance,
    and what these move: the last row and column.
    """
    support = drive.crank.support
    assert support is not None
    (start, end), planes = support.positions, np.asarray(drive.disc.disc_planes)
    planes = planes if beside is None else np.append(planes, beside)
    nodes, weights = np.polynomial.legendre.leggauss(6)
    marks = np.unique(np.concatenate([[start, end], planes]))
    half = 0.5 * np.diff(marks)
    at = (0.5 * (marks[1:] + marks[:-1])[:, None] + half[:, None] * nodes).ravel()
    weight = (half[:, None] * weights).ravel()
    second = (planes - start) / (end - start)

    def bending(force: float, share: float) -> FloatArray:
        """Bending moment of a unit force and its two reactions, looking from the left, mm."""
        left = np.maximum(at - force, 0.0) - (1.0 - share) * np.maximum(at - start, 0.0)
        return np.asarray(left - share * np.maximum(at - end, 0.0))

    moments = np.stack([bending(force, share) for force, share in zip(planes, second, strict=True)])
    if couple:
        part = 1.0 / (end - start)
        moments[-1] = part * (np.maximum(at - start, 0.0) - np.maximum(at - end, 0.0)) - (at > planes[-1])
    rigidity = drive.materials.crankshaft.youngs_modulus * np.pi * support.diameter**4 / 64.0
    return np.asarray((moments * weight) @ moments.T / rigidity)
