"""Check of an equilibrium by its potential energy, independently of the code that finds it.

Independent of `ltca.geometry`, `ltca.mechanics` and `ltca.equilibrium.balance`: all places come from the definition of
the drive with its deviations, distances from the flank from a search over points of the deviated flank, places of rollers from a
search on their energy. Shared are only the definition of the drive and the energies ∫F dδ of the contact laws, crown and
relief included. At an equilibrium the potential Π has a minimum: no small displacement lowers it, and its slope by
central differences vanishes. Loose and bent pins have explicit coordinates (`ltca.testing.yielding_pins`), by which the
slope vanishes as well. An elastic ring moves the wheel pins by statics of its own (`ltca.testing.ring_statics`) under the loads
of the answer; at the displaced places the slopes of the energies of the contacts are those loads. Friction
(`ltca.testing.friction_check`) adds its work.

The effective radii of the flank contacts are those of the pose that is checked: a frictionless contact pushes along its
normal with F(δ, ρ), and the change of energy because the contact moves to another curvature (about 1e-3 of the load, along the
flank) is no force.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import cast

import numpy as np

from ltca.arrays import ComplexArray, FloatArray, take_positions
from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.drive.parts import Drive
from ltca.equilibrium.balance import Equilibrium
from ltca.equilibrium.reducer import Reducer
from ltca.laws.backed import BackedLaw
from ltca.testing.actual_parts import ActualParts, DeviatedFlank
from ltca.testing.bearing_springs import (
    crank_springs,
    disc_coordinates,
    shaft_energy,
    shaft_torsion,
    wheel_spring,
)
from ltca.testing.first_stage_check import outside_on_wheel, teeth_on_shafts, teeth_on_supports, tooth_forces
from ltca.testing.friction_check import FrictionCheck
from ltca.testing.ring_statics import ring_by_statics
from ltca.testing.width_check import find_imbalance_in_slices
from ltca.testing.yielding_pins import (
    EnergyLaw,
    SeatEnergy,
    YieldingPins,
    beam_stiffness,
    contact_alone,
    crankshaft_bending,
    has_ring,
    post_forces,
    ring_tips,
)

GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)
SECTIONS = 9
"""Number of golden sections of the approach of a roller between race and bore, to a hundredth of it, before parabolas."""

FARTHEST = 0.01
"""Largest displacement, as a fraction of the pin radius."""


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
    wheel_pins, shaft_pins : YieldingPins
        Where forces hold them.
    ring : array of complex, shape (z_P,)
        Displacements of the seats of the wheel pins by the elastic ring, in the turning wheel, mm.
    pulls : array of complex, shape (2, cranks), or None
        What the bearings of each crank carry of the teeth of a first stage while the discs stand still, N.
    """

    drive: Drive
    pin_law: EnergyLaw
    inner_law: EnergyLaw
    outer_law: EnergyLaw
    crank_angle: float
    wheel_moment: float
    wheel_pins: YieldingPins
    shaft_pins: YieldingPins
    ring: ComplexArray
    pulls: ComplexArray | None = None

    def at(self, pose: FloatArray) -> FloatArray:
        """Return Π of poses, shape (poses, coordinates), with the effective radii of the first of them, N·mm.

        All poses lie within some approaches of the first; pins stay where they are.
        """
        stored = self._supports(pose) + self.of_wheel_pins(pose).sum(axis=1) + self.of_shaft_pins(pose).sum(axis=1)
        for disc in range(self.drive.disc.number_of_discs):
            stored = stored + self._bearings(ActualParts(self.drive, self.crank_angle, disc), disc, pose)
        return np.asarray(stored - self.wheel_moment * pose[:, -1])

    def of_wheel_pins(self, pose: FloatArray, moved: ComplexArray | float = 0.0) -> FloatArray:
        """Return the energy of each wheel pin and its flank contacts, N·mm, shape (rows, pins).

        Poses have shape (rows, coordinates); one row serves for all displacements. `moved`, shape (rows, 2, discs, 1), are
        displacements of beams and of loose parts, of all pins alike, from their places under load, mm.
        """
        held = self.wheel_pins
        place = np.stack([held.bent, held.loose])[None] + moved
        stored = held.stored(place[:, 0], place[:, 1], np.zeros((1, held.tip.size), dtype=complex))
        return stored + self.of_flanks(pose, place.sum(axis=1))

    def of_flanks(self, pose: FloatArray, place: ComplexArray) -> FloatArray:
        """Return the energy of the flank contacts of each wheel pin, N·mm, shape (rows, pins).

        `place` are displacements of the pins from their seats in the ring, mm, complex, shape (rows, discs, pins).
        """
        total = np.zeros((max(pose.shape[0], place.shape[0]), place.shape[2]))
        for disc in range(self.drive.disc.number_of_discs):
            parts, centre, turn = self._place(disc, pose)
            pins, radii = parts.wheel_pins
            axis = parts.wheel_axis + self.wheel_displacement(pose)[:, None] + place[:, disc]
            seats = (pins + self.ring * self.wheel_turn) * np.exp(1j * pose[:, -1])[:, None]
            point = (axis + seats - centre) * np.conj(turn)
            farthest = float(np.max(np.abs(point - point[:1])))
            approach, effective = DeviatedFlank(self.drive, disc).approaches(point, radii, 2.0 * farthest)
            total = total + self.pin_law.energy(approach, effective)
        return np.asarray(total)

    def of_shaft_pins(self, pose: FloatArray, moved: ComplexArray | float = 0.0) -> FloatArray:
        """Return the energy of each shaft pin and its contacts with the holes; arguments as for `of_wheel_pins`."""
        held, shaft = self.shaft_pins, self.drive.pin_shaft
        if shaft is None:
            return np.zeros((pose.shape[0], 0))
        place = np.stack([held.bent, held.loose])[None] + moved
        total = held.stored(place[:, 0], place[:, 1], ring_tips(self.drive, pose))
        for disc in range(self.drive.disc.number_of_discs):
            parts, centre, turn = self._place(disc, pose)
            holes, hole_radii = parts.holes
            pins, radii = parts.shaft_pins
            overlap = np.abs(pins + place.sum(axis=1)[:, disc] - centre - holes * turn) - (hole_radii - radii)
            if held.stiffness is None:
                total = total + 0.5 * self.drive.hole_stiffness * np.maximum(overlap, 0.0) ** 2
            else:  # What bends is the pin: the contact is a constraint, its load the multiplier (augmented Lagrangian).
                pushed, load = held.stiffness[disc, disc], held.load[disc]
                total = total + 0.5 * (np.maximum(load + pushed * overlap, 0.0) ** 2 - load**2) / pushed
        return np.asarray(total)

    @property
    def wheel_turn(self) -> complex:
        """Direction in which the wheel stands without load."""
        wheel = self.drive.pin_wheel
        return complex(np.exp(1j * self.crank_angle * self.drive.tooth_number_difference / wheel.number_of_pins))

    def slopes_at_seats(self, pose: FloatArray, step: float) -> ComplexArray:
        """Return the slopes of the energies of the flank contacts by the places of the wheel pins under all discs, N, shape
        (pins,), by central differences over a step, mm.
        """
        place = (self.wheel_pins.bent + self.wheel_pins.loose)[None]
        ways = step * np.array([0.0, 1.0, -1.0, 1j, -1j])[:, None, None]
        energy = self.of_flanks(pose[None], place + ways)
        return np.asarray((energy[1] - energy[2] + 1j * (energy[3] - energy[4])) / (2.0 * step))

    def _place(self, disc: int, pose: FloatArray) -> tuple[ActualParts, ComplexArray, ComplexArray]:
        """Parts at a disc, its centre and its rotation at poses."""
        parts, first = ActualParts(self.drive, self.crank_angle, disc), self.own * disc
        centre = (parts.place + pose[:, first] + 1j * pose[:, first + 1])[:, None]
        return parts, centre, np.exp(1j * pose[:, first + 2])[:, None]

    @property
    def own(self) -> int:
        """Number of coordinates of each disc: three, and two for each crank on elastic supports, three where it twists."""
        return disc_coordinates(self.drive)

    def _cranks(self, disc: int, pose: FloatArray) -> ComplexArray:
        """Displacements of the cranks in the plane of a disc, shape (poses, cranks), mm."""
        first = self.own * disc + 3
        cranks, support = self.drive.crank.number, self.drive.crank.support
        if support is None:
            return self._lines(disc, pose)
        yielding = pose[:, first : first + 2 * cranks]
        return np.asarray(yielding[:, ::2] + 1j * yielding[:, 1::2])

    def _twists(self, disc: int, pose: FloatArray) -> FloatArray:
        """Angles of the eccentrics of a disc ahead of their cranks, shape (poses, cranks), rad; zero without torsion."""
        cranks, support = self.drive.crank.number, self.drive.crank.support
        if support is None or not support.torsion:
            return np.zeros((pose.shape[0], cranks))
        first = self.own * disc + 3 + 2 * cranks
        return pose[:, first : first + cranks]

    def _races(self, parts: ActualParts, disc: int, pose: FloatArray) -> ComplexArray:
        """Centres of the inner races of a disc on cranks that yield and twist, shape (poses, cranks), mm."""
        turned = parts.eccentrics * (np.exp(1j * self._twists(disc, pose)) - 1.0)
        return np.asarray(parts.race_centres + turned + self._cranks(disc, pose))

    @property
    def _crank_places(self) -> ComplexArray:
        """Axes of the cranks, mm."""
        crank = self.drive.crank
        angle = crank.angle + 2.0 * np.pi * np.arange(crank.number) / crank.number
        circle = (crank.circle_radius or 0.0) * np.exp(1j * angle)
        return np.asarray(complex(crank.axis_offset.x, crank.axis_offset.y) + circle)

    def _lines(self, disc: int, pose: FloatArray) -> ComplexArray:
        """Displacements of the straight lines between the bearings of the cranks in a disc, shape (poses, cranks)."""
        drive, crank = self.drive, self.drive.crank
        if drive.carrier is None or drive.carrier.posts is None:
            return np.zeros((pose.shape[0], crank.number), dtype=complex)
        if crank.support is not None:
            near, far = crank.support.positions
        else:
            thick = drive.carrier.flange or (0.0, 0.0)
            length = drive.carrier.posts.length
            if length is None:
                beam = None if drive.pin_shaft is None else drive.pin_shaft.beam
                length = drive.disc.stack_length if beam is None or beam.span is None else beam.span
            near, far = -0.5 * length - 0.5 * thick[0], 0.5 * length + 0.5 * thick[1]
        seat = pose[:, -4, None] + 1j * pose[:, -3, None] + 1j * pose[:, -2, None] * self._crank_places
        return np.asarray((drive.disc.disc_planes[disc] - near) / (far - near) * seat)

    def wheel_displacement(self, pose: FloatArray) -> ComplexArray:
        """Displacement of the wheel, mm."""
        if wheel_spring(self.drive) is None:
            return np.zeros(pose.shape[0], dtype=complex)
        last = -6 if has_ring(self.drive) else -3
        return np.asarray(pose[:, last] + 1j * pose[:, last + 1])

    def _supports(self, pose: FloatArray) -> FloatArray:
        """Energy of crankshafts on their bearings, less the work of teeth there, of the wheel on its main bearing and of the
        posts of the carrier, N·mm.
        """
        spring, total = wheel_spring(self.drive), np.zeros(pose.shape[0])
        if spring is not None:
            total = total + spring.energy(np.abs(self.wheel_displacement(pose)))
        if (support := self.drive.crank.support) is not None:
            (start, end), planes = support.positions, np.asarray(self.drive.disc.disc_planes)
            second, discs = (planes - start) / (end - start), range(self.drive.disc.number_of_discs)
            shares, springs = np.stack([1.0 - second, second]), crank_springs(self.drive)
            bending = crankshaft_bending(self.drive)
            moved = np.stack([self._cranks(disc, pose) - self._lines(disc, pose) for disc in discs], axis=1)
            for crank in range(self.drive.crank.number):
                pull = np.zeros(2, dtype=complex) if self.pulls is None else self.pulls[:, crank]
                total = total + shaft_energy(bending, shares, springs, moved[:, :, crank], pull)
            twisted = np.stack([self._twists(disc, pose) for disc in discs], axis=1)
            total = total + shaft_torsion(self.drive, twisted)
        if self.drive.posts is not None:
            flange = pose[:, -4:-1]
            total = total + 0.5 * np.einsum("pi,ij,pj->p", flange, post_forces(self.drive), flange)
        return np.asarray(total)

    def crank_moment(self, pose: FloatArray) -> float:
        """Return the moment that holds all cranks at a pose, shape (coordinates,): the slope of the stored energy by φ_C,
        N·mm.
        """
        return float(self.crank_moments(pose).sum())

    def crank_moments(self, pose: FloatArray) -> FloatArray:
        """Return the moment that holds each crank at a pose, N·mm, shape (cranks,).

        Discs, cranks and wheel are fixed; the inner races move under them and the cages turn.
        """
        e, ends = self.drive.crank.eccentricity, []
        step = 1e-5 * float(np.max(np.abs(pose))) / e + 1e-7
        discs = range(self.drive.disc.number_of_discs)
        before = [ActualParts(self.drive, self.crank_angle, disc).place for disc in discs]
        for side in (1.0, -1.0):
            angle, total = self.crank_angle + side * step, np.zeros(self.drive.crank.number)
            for disc in discs:  # of rollers alone: the others see no difference
                parts, moved = ActualParts(self.drive, angle, disc), pose.copy()
                shift = parts.place - before[disc]
                moved[self.own * disc] -= shift.real
                moved[self.own * disc + 1] -= shift.imag
                total += self._each_bearing(parts, disc, moved[None])[:, 0]
            ends.append(total)
        return np.asarray((ends[0] - ends[1]) / (2.0 * step))

    def outside(self, pose: FloatArray, rubbed_at_cranks: FloatArray | float = 0.0) -> FloatArray:
        """Return the work against forces of a first stage and from outside by the pose, N, shape (coordinates,)."""
        drive, work = self.drive, np.zeros(pose.size)
        if drive.first_stage is not None:
            moments, posts = self.crank_moments(pose) + rubbed_at_cranks, drive.carrier and drive.carrier.posts
            pressed, carried = teeth_on_shafts(drive, moments)
            for disc, forces in enumerate(pressed if drive.crank.support is not None else ()):
                first = self.own * disc + 3
                work[first : first + 2 * drive.crank.number : 2] -= forces.real
                work[first + 1 : first + 2 * drive.crank.number : 2] -= forces.imag
            if posts:
                seated = carried[1]
                turning = (np.conj(1j * self._crank_places) * seated).real.sum()
                work[-4:-1] -= seated.real.sum(), seated.imag.sum(), turning
        if wheel_spring(drive) is not None:
            last, force = -6 if has_ring(drive) else -3, outside_on_wheel(drive, self.crank_angle)
            if drive.first_stage is not None and drive.installation.held == "pin-wheel":
                force -= tooth_forces(drive, self.crank_moments(pose) + rubbed_at_cranks)[0].sum()
            work[last] -= force.real
            work[last + 1] -= force.imag
        return work

    def bearing_forces(self, pose: FloatArray) -> ComplexArray:
        """Return the forces of the crank bearings at a pose, shape (discs, cranks), N, as slopes of their energies."""
        found = []
        for disc in range(self.drive.disc.number_of_discs):
            parts, centre, turn = self._place(disc, pose[None])
            shift = centre + parts.bores * turn - self._races(parts, disc, pose[None])
            # Short against the approaches of a disc that carries next to nothing.
            step = 2e-6 * float(np.max(np.abs(shift))) + 1e-10
            around = shift[0, :, None, None] + step * np.array([[1.0], [-1.0], [1j], [-1j]])
            energy = np.stack([self._rollers(parts, each) for each in around])
            found.append((energy[:, 0] - energy[:, 1] + 1j * (energy[:, 2] - energy[:, 3])) / (2.0 * step))
        return np.stack(found)

    def _bearings(self, parts: ActualParts, disc: int, pose: FloatArray) -> FloatArray:
        """Energy of the rollers of all crank bearings of one disc."""
        return np.asarray(self._each_bearing(parts, disc, pose).sum(axis=0))

    def _each_bearing(self, parts: ActualParts, disc: int, pose: FloatArray) -> FloatArray:
        """Energy of the rollers of each crank bearing of one disc, shape (cranks, poses)."""
        first = self.own * disc
        centre = parts.place + pose[:, first] + 1j * pose[:, first + 1]
        turn, races = np.exp(1j * pose[:, first + 2]), self._races(parts, disc, pose)
        shifts = [(centre + bore * turn - races[:, crank])[:, None] for crank, bore in enumerate(parts.bores)]
        return np.stack([self._rollers(parts, shift) for shift in shifts])

    def _rollers(self, parts: ActualParts, shift: ComplexArray) -> FloatArray:
        """Energy of all rollers, each at the place of least energy on its ray."""
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


def _yielding(drive: Drive, laws: HalfSpaceCompliance, balanced: Equilibrium, row: int) -> dict[str, YieldingPins]:
    """Wheel pins and shaft pins at the displacements under the loads of a solution."""
    parts, found = balanced.response.parts, {}
    tip = ring_tips(drive, balanced.pose[row : row + 1])[0]
    for name, part, law, material in (
        ("wheel_pins", drive.pin_wheel, laws.pin_law, drive.materials.wheel_pin),
        ("shaft_pins", drive.pin_shaft, laws.hole_law, drive.materials.shaft_pin),
    ):
        on_wheel = name == "wheel_pins"
        load = np.stack([(each.pin_load if on_wheel else each.hole_load)[row] for each in parts])
        gradient = np.stack([(each.flank if on_wheel else each.holes).gradient[row, :, :2] for each in parts])
        seat = law.seat if isinstance(law, BackedLaw) else None
        own = ActualParts(drive, 0.0)
        play = own.wheel_pin_plays if on_wheel else own.shaft_pin_plays
        largest = float(np.max(load, initial=0.0))
        found[name] = YieldingPins(
            stiffness=None if part is None else beam_stiffness(drive, part, material),
            seat=None if seat is None else SeatEnergy(law=seat, play=play, largest=largest),
            load=load,
            away=gradient[..., 0] + 1j * gradient[..., 1],
            tip=np.zeros(load.shape[1], dtype=complex) if on_wheel else tip,
        )
    return found


def _ring(drive: Drive, balanced: Equilibrium, row: int) -> ComplexArray:
    """Displacements of the seats in the turning wheel under the forces of the discs at a position of a solution, mm."""
    wheel, flexibility = drive.pin_wheel, ring_by_statics(drive)
    if flexibility is None:
        return np.zeros(wheel.number_of_pins, dtype=complex)
    force = np.zeros((wheel.number_of_pins, 2))
    for part in balanced.response.parts:
        force += part.pin_load[row, :, None] * part.flank.gradient[row, :, :2]
        if part.friction is not None:
            force += part.friction[row, : wheel.number_of_pins, None] * part.flank.along[row, :, :2]
    turned = balanced.crank_angle[row] * drive.tooth_number_difference / wheel.number_of_pins + balanced.pose[row, -1]
    pushed = (force[:, 0] + 1j * force[:, 1]) * np.exp(-1j * turned)
    moved = np.einsum("iajb,jb->ia", flexibility, np.stack((pushed.real, pushed.imag), axis=1))
    return np.asarray(moved[:, 0] + 1j * moved[:, 1])


def potential_of(drive: Drive, model: Reducer, balanced: Equilibrium, position: int) -> PotentialEnergy:
    """Return Π about a position of a solution; arguments as for `find_imbalance`."""
    laws = cast(HalfSpaceCompliance, model.discs[0])
    pins = _yielding(drive, laws, balanced, position)
    return PotentialEnergy(
        drive=drive,
        pin_law=contact_alone(laws.pin_law),
        inner_law=laws.inner_law,
        outer_law=laws.outer_law,
        crank_angle=float(balanced.crank_angle[position]),
        wheel_moment=float(balanced.wheel_moment[position]),
        wheel_pins=pins["wheel_pins"],
        shaft_pins=pins["shaft_pins"],
        ring=_ring(drive, balanced, position),
    )


def friction_at(potential: PotentialEnergy, balanced: Equilibrium, position: int) -> FrictionCheck:
    """Return the friction at that position of a drive with friction."""
    drive, pose, wheel, shaft = potential.drive, balanced.pose[position], potential.wheel_pins, potential.shaft_pins
    supported = drive.wheel_yields
    found = FrictionCheck(
        drive=drive,
        crank_angle=potential.crank_angle,
        pose=pose,
        wheel=complex(potential.wheel_displacement(pose[None])[0]),
        wheel_column=None if not supported else -6 if has_ring(drive) else -3,
        wheel_place=wheel.bent + wheel.loose + potential.ring * potential.wheel_turn * np.exp(1j * pose[-1]),
        shaft_place=shaft.bent + shaft.loose,
        parts=[take_positions(part, np.array([position])) for part in balanced.response.parts],
        bearings=potential.bearing_forces(pose),
        teeth=None if drive.first_stage is None else teeth_on_supports(drive, potential.crank_moments(pose)),
        outside=outside_on_wheel(drive, potential.crank_angle),
    )
    if drive.first_stage is None or drive.installation.held == "pin-shaft":
        return found
    pressed, _ = tooth_forces(drive, potential.crank_moments(pose) + found.at_each_crank)
    return replace(found, outside=found.outside - pressed.sum())


def find_imbalance(
    drive: Drive,
    model: Reducer,
    balanced: Equilibrium,
    position: int = 0,
    seed: int = 0,
    *,
    torque: float | None = None,
) -> list[str]:
    """Return the violations of equilibrium at a position of a solution; empty for an equilibrium.

    The geometry with all deviations comes from the drive, the energies of the laws from the model (half-spaces on tables).
    `seed` is that of the random displacements. With the output torque (N·mm) the balance of the moments of wheel, crank and
    output is checked as well. Contacts in slices are checked by the loads of their slices (`ltca.testing.width_check`).
    """
    if drive.contact.slices > 1:
        return find_imbalance_in_slices(drive, model, balanced, position, torque=torque)
    pose, contacts = balanced.pose[position], balanced.response
    moment = float(balanced.wheel_moment[position])
    potential = potential_of(drive, model, balanced, position)
    wheel, size = drive.crank.eccentricity * float(drive.reduction_ratio), pose.size
    lever = np.ones(size)
    lever[2 : potential.own * drive.disc.number_of_discs : potential.own] = wheel - drive.crank.eccentricity
    lever[-1] = wheel
    support = drive.crank.support
    if support is not None and support.torsion:
        for disc in range(drive.disc.number_of_discs):
            first = potential.own * disc + 3 + 2 * drive.crank.number
            lever[first : first + drive.crank.number] = drive.crank.eccentricity
    if has_ring(drive):
        pins = drive.pin_shaft
        lever[-2] = (drive.crank.circle_radius or 1.0) if pins is None else pins.pin_circle_radius
    load = abs(moment) / wheel
    if not np.all(np.isfinite(pose)):
        return ["the pose is not finite"]
    rubbed = None if drive.friction is None else friction_at(potential, balanced, position)
    problems = [] if rubbed is None else rubbed.problems()
    rollers = contacts.rollers
    for name, approach, force in (
        ("pin", contacts.flank.approach, contacts.pin_load),
        ("hole", contacts.holes.approach, contacts.hole_load),
        ("roller in the bore", rollers.outer_approach, rollers.outer_load),
        ("roller on the inner race", rollers.inner_approach, rollers.inner_load),
    ):
        if np.any(force[position] < 0.0) or np.any((force[position] > 0.0) & (approach[position] <= 0.0)):
            problems.append(f"a {name} pulls or carries while open")
    # The approach of the softest contact is the scale of the displacements.
    scale = max(1e-6, float(np.max(contacts.flank.approach[position])), float(np.max(rollers.outer_approach[position])))
    # Contacts that just open or close disturb the slope: the best of several steps counts; a wrong pose fails with all.
    # A disc without load rests on kinks of stiff holes: there the step itself is the slope.
    steps = scale * np.array([1e-3, 1e-4, 1e-5, 1e-6, 1e-7])
    offsets = (steps[:, None, None] * np.concatenate([np.eye(size), -np.eye(size)])).reshape(-1, size)
    directions = np.random.default_rng(seed).normal(size=(12, size))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    # Approaches of preloaded pins may exceed the pieces of the flank on which they are followed.
    farthest = min(scale, FARTHEST * drive.pin_wheel.pin_radius)
    sizes = farthest * np.repeat([1e-2, 1e-1, 1.0], 4)
    here = np.zeros((1, size))
    # Separately, since the farthest pose determines the width of the pieces.
    rubbed_at_cranks = 0.0 if rubbed is None else rubbed.at_each_crank
    outside = potential.outside(pose, rubbed_at_cranks)
    work = outside / lever
    if drive.first_stage is not None:
        pulls = teeth_on_shafts(drive, potential.crank_moments(pose) + rubbed_at_cranks)[1]
        potential = replace(potential, pulls=pulls)
    if rubbed is not None:
        work = work + rubbed.work / lever
    value = potential.at(pose + np.concatenate([here, offsets]) / lever)
    value[1:] += offsets @ work
    away = sizes[:, None] * directions
    moved = potential.at(pose + np.concatenate([here, away]) / lever)
    pairs = value[1:].reshape(steps.size, 2, size)
    slope = np.abs(pairs[:, 0] - pairs[:, 1]).max(axis=1) / (2.0 * steps)
    # Round-off of Π: of the stored energy and of T·angle, of the search along the rays, and of approaches (parts of
    # the pin circle radius) under the forces of preloaded pins.
    rounding = 4.0 * np.finfo(float).eps * drive.pin_wheel.pin_circle_radius
    forces = float(
        contacts.pin_load[position].sum() + contacts.hole_load[position].sum() + rollers.outer_load[position].sum()
    )
    noise = 1e-11 * (abs(moment * pose[-1]) + abs(value[0]) + load * scale) + rounding * forces
    best = int(np.argmin(slope - noise / steps))
    if slope[best] > 1e-3 * load + noise / steps[best]:
        problems.append(f"slope of the potential {slope[best]:.3g} N against a load of {load:.3g} N")
    if drive.ring is not None:
        force = (potential.wheel_pins.load * potential.wheel_pins.away).sum(axis=0)
        off = [np.abs(potential.slopes_at_seats(pose, step) + force) - noise / step for step in steps]
        worst = float(np.max(np.min(off, axis=0)))
        if worst > 1e-3 * load:
            problems.append(
                f"slope of the contacts by the place of a wheel pin {worst:.3g} N beside its force (load: {load:.3g} N)"
            )
    for name, held, stored in (
        ("wheel", potential.wheel_pins, potential.of_wheel_pins),
        ("shaft", potential.shaft_pins, potential.of_shaft_pins),
    ):
        # With friction loose pins stand where they are only to first order in μ, as their closed form does.
        if held.ways.size and held.load.size and rubbed is None:
            ways = (steps[:, None, None, None, None] * np.stack([held.ways, -held.ways])).reshape(
                -1, *held.ways.shape[1:]
            )
            ways = np.concatenate([np.zeros((1, *ways.shape[1:])), ways])[..., None]
            beside = stored(pose[None], ways.astype(complex))[1:].reshape(steps.size, 2, -1, held.load.shape[1])
            # Pins are independent: the best step for each coordinate.
            steep = np.abs(beside[:, 0] - beside[:, 1]) / (2.0 * steps)[:, None, None]
            steep = np.min(steep - (noise / steps)[:, None, None], axis=0)
            if np.max(steep) > 1e-3 * load:
                problems.append(
                    f"slope of the potential by the place of a {name} pin {np.max(steep):.3g} N against a load of {load:.3g} N"
                )
    rise = moved[1:] - moved[0] + away @ work
    if np.any(rise < -noise - 1e-4 * load * sizes):
        problems.append(f"a displacement lowers the potential by {-np.min(rise):.3g} N·mm")
    if torque is not None:
        output = drive.driving_sign * torque
        left = moment + output
        if drive.wheel_is_held:
            stage = drive.first_stage_ratio
            reaction = 1.0 if drive.crank.number == 1 else 0.0 if stage is None else -1.0 / stage
            left += reaction * (potential.crank_moment(pose) + (0.0 if rubbed is None else rubbed.at_cranks))
            if (
                wheel_spring(drive) is not None
            ):  # forces on the shaft at its axis are held at that of the displaced wheel
                last = -6 if has_ring(drive) else -3
                left -= pose[last] * outside[last + 1] - pose[last + 1] * outside[last]
        if abs(left) > 1e-3 * abs(output):
            problems.append(f"moments of wheel, crank and output leave {left:.3g} N·mm of {output:.3g} N·mm")
    return problems
