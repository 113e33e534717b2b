"""Friction of a drive that turns, independently of the code that balances it.

Places come from the definition of the drive (`ltca.testing.actual_parts`), normals from differences of the distance from the
flank; the material points of both bodies at a contact move as parts of rigid bodies, by the pose and, for the slip of the turning
drive, by a small rotation of the cranks. Friction follows from frozen loads, so its work is linear in small displacements:
added to the potential of `ltca.testing.balance_check`, it makes the balanced pose a minimum again.

A pin that is free to turn transmits its load: the total forces of disc and seat are equal and opposite, in the line
through both contacts, so the force on the wheel is that at the flank.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ltca.arrays import ComplexArray, FloatArray
from ltca.compliance.response import DiscResponse
from ltca.drive.parts import Drive, Friction, PinShaft, PinWheel
from ltca.geometry.coordinates import X, Y
from ltca.testing.actual_parts import ActualParts, DeviatedFlank
from ltca.testing.bearing_springs import SidedSpring, crank_springs, disc_coordinates, wheel_spring

FADES = 1e-4
"""Slip by the crank angle, in eccentricities, below which a contact is next to the pitch point: any friction may be there."""
SAME = 1e-5
"""Largest difference of friction forces, as a fraction of the largest possible one: normals by differences are accurate to some
1e-8, the balance of the loads is better."""
TURNED = 1e-6
"""Rotation of the cranks for the slip, rad."""


def easier_coefficient(contact: float, seat: float, part: PinWheel | PinShaft) -> float:
    """Return the coefficient of the surface of a pin that slips first: that at the disc, or that of the seat at the lever
    of the disc.
    """
    own = part.seat
    if own.kind == "slot":
        return min(contact, seat)
    if own.kind == "sleeve":
        assert own.bore_radius is not None
        return min(contact, seat * own.bore_radius / part.pin_radius)
    return contact


@dataclass(frozen=True, kw_only=True)
class RubbedContacts:
    """Contacts of one disc, wheel pins before shaft pins.

    Attributes
    ----------
    point : array of complex, shape (pairs,)
        Where they touch, in the fixed frame, mm.
    into_disc : array of complex, shape (pairs,)
        Unit vectors from the pins into the disc.
    rubbing : array of complex, shape (pairs,)
        Friction on the pins, N.
    most : array, shape (pairs,)
        Its size where it slips, N.
    slip : array, shape (pairs,)
        Of the pin against the disc by the crank angle, mm/rad.
    """

    point: ComplexArray
    into_disc: ComplexArray
    rubbing: ComplexArray
    most: FloatArray
    slip: FloatArray


@dataclass(frozen=True, kw_only=True)
class FrictionCheck:
    """Friction of a drive that turns, at one crank angle and pose.

    Parameters
    ----------
    drive : Drive
        With friction; which way it moves is taken from its load.
    crank_angle : float
        φ_C, rad.
    pose : array, shape (coordinates,)
        q.
    wheel : complex
        Displacement of the wheel's axis, mm.
    wheel_column : int or None
        The first of its two coordinates, counted from the end; None where it is held.
    wheel_place, shaft_place : array of complex, shape (discs, pins)
        Displacements of pins from where they are drawn, by forces, mm.
    parts : sequence of DiscResponse
        Contacts of each disc at this position alone: their loads, and the friction that is told of them.
    bearings : array of complex, shape (discs, cranks)
        Force of each crank bearing on its crank, N.
    teeth : array of complex, shape (bearings, cranks), or None
        What the bearings of each crank carry of the teeth of a first stage, N.
    outside : complex
        Force from outside on the wheel, N.
    """

    drive: Drive
    crank_angle: float
    pose: FloatArray
    wheel: complex
    wheel_column: int | None
    wheel_place: ComplexArray
    shaft_place: ComplexArray
    parts: Sequence[DiscResponse]
    bearings: ComplexArray
    teeth: ComplexArray | None = None
    outside: complex = 0j

    @cached_property
    def contacts(self) -> tuple[RubbedContacts, ...]:
        """Contacts of each disc with the pins."""
        return tuple(self._contacts(disc) for disc in range(len(self.parts)))

    @cached_property
    def work(self) -> FloatArray:
        """Work against friction by the pose, N and N·mm, shape (coordinates,)."""
        drive, pins = self.drive, self.drive.pin_wheel.number_of_pins
        own = disc_coordinates(drive)
        work = np.zeros(self.pose.size)
        for disc, found in enumerate(self.contacts):
            # On the disc the force is the opposite; the pins of the shaft stand still.
            force, first, total = found.rubbing, own * disc, found.rubbing.sum()
            work[first : first + 2] += total.real, total.imag
            work[first + 2] += (np.conj(force) * 1j * (found.point - self._centre(disc))).real.sum()
            # The crank drags the disc along, rollers between them.
            rolled = self._motion * self._rolling * np.abs(self.bearings[disc])
            work[first + 2] -= rolled.sum()
            if drive.crank.support is not None and drive.crank.support.torsion:
                twists = first + 3 + 2 * drive.crank.number
                work[twists : twists + drive.crank.number] += rolled
            rubbed = force[:pins]
            work[-1] -= (np.conj(rubbed) * 1j * (found.point[:pins] - self._axis(disc))).real.sum()
            if self.wheel_column is not None:
                work[self.wheel_column] -= rubbed.sum().real
                work[self.wheel_column + 1] -= rubbed.sum().imag
        work[-1] += self._motion * np.sign(drive.tooth_number_difference) * self._at_wheel
        return work

    @property
    def at_cranks(self) -> float:
        """Moment of friction on all cranks, ccw positive, N·mm."""
        return float(self.at_each_crank.sum())

    @property
    def at_each_crank(self) -> FloatArray:
        """Moment of friction on each crank, N·mm, shape (cranks,)."""
        places, planes = self.drive.crank_supports, self.drive.disc.disc_planes
        teeth = np.zeros((2, self.bearings.shape[1])) if self.teeth is None else self.teeth
        if places is None:  # held beside every disc, and beside the planet
            carried = np.abs(self.bearings).sum(axis=0) + np.abs(teeth).sum(axis=0)
        else:
            near, far = places
            share = (np.asarray(planes) - near) / (far - near)
            first, second = crank_springs(self.drive) if self.drive.crank.support is not None else (None, None)
            carried = _at_least(share @ self.bearings + teeth[1], second)
            carried = carried + _at_least((1.0 - share) @ self.bearings + teeth[0], first)
        friction = self._friction
        at_support = friction.support_bearing * friction.support_bearing_radius * carried
        return np.asarray(self._motion * (self._rolling * np.abs(self.bearings).sum(axis=0) + at_support))

    @property
    def lost(self) -> float:
        """Energy lost per radian of the crank without seals and oil, N·mm."""
        at_pins = sum(float((np.abs(each.rubbing) * np.abs(each.slip)).sum()) for each in self.contacts)
        turns = abs(self.drive.tooth_number_difference) / self.drive.pin_wheel.number_of_pins
        return at_pins + self._at_wheel * turns + abs(self.at_cranks)

    def problems(self) -> list[str]:
        """Return the friction forces of the solution that are wrong; empty when none is."""
        found, pins = [], self.drive.pin_wheel.number_of_pins
        for disc, (part, own) in enumerate(zip(self.parts, self.contacts, strict=True)):
            # The accuracy of small loads is a fraction of the sum of all.
            nothing = 1e-9 * float(part.pin_load.sum() + part.hole_load.sum())
            told = self._told(disc)
            off = np.abs(told - own.rubbing) > SAME * own.most + nothing
            for pair in np.nonzero(off)[0]:
                where = f"wheel pin {pair}" if pair < pins else f"shaft pin {pair - pins}"
                found.append(
                    f"friction on {where} of disc {disc} is {told[pair]:.6g} N instead of {own.rubbing[pair]:.6g} N"
                )
        return found

    @property
    def _friction(self) -> Friction:
        assert self.drive.friction is not None
        return self.drive.friction

    @property
    def _motion(self) -> float:
        """Sense in which the crank turns."""
        load = self.drive.load
        return (1.0 if load.direction == "ccw" else -1.0) * (1.0 if load.driven_by == "input" else -1.0)

    @property
    def _rolling(self) -> float:
        """Lever of the rolling resistance, mm."""
        bearing = self.drive.crank_bearing
        return self._friction.roller * (bearing.inner_race_radius + bearing.roller_radius)

    @property
    def _at_wheel(self) -> float:
        """Magnitude of the friction moment of the wheel's bearing, N·mm."""
        pins, on_wheel = self.drive.pin_wheel.number_of_pins, 0j
        for part, found in zip(self.parts, self.contacts, strict=True):
            on_wheel += (found.rubbing[:pins] - part.pin_load[0] * found.into_disc[:pins]).sum()
        friction, spring = self._friction, wheel_spring(self.drive)
        load = max(abs(on_wheel + self.outside), 0.0 if spring is None else spring.load_at_rest)
        return float(friction.support_bearing * friction.support_bearing_radius * load)

    def _told(self, disc: int) -> ComplexArray:
        """Friction on the pins in the solution: the force that works by the place of the disc."""
        part = self.parts[disc]
        along = np.concatenate((part.flank.along[0], part.holes.along[0]))
        told = np.zeros(along.shape[0]) if part.friction is None else part.friction[0]
        return np.asarray(told * (along[:, X] + 1j * along[:, Y]))

    def _centre(self, disc: int) -> complex:
        own = disc_coordinates(self.drive)
        place = ActualParts(self.drive, self.crank_angle, disc).place
        return place + complex(self.pose[own * disc], self.pose[own * disc + 1])

    def _axis(self, disc: int) -> complex:
        return ActualParts(self.drive, self.crank_angle, disc).wheel_axis + self.wheel

    def _contacts(self, disc: int) -> RubbedContacts:
        drive, friction, part = self.drive, self._friction, self.parts[disc]
        parts = ActualParts(drive, self.crank_angle, disc)
        ahead, behind = (ActualParts(drive, self.crank_angle + side * TURNED, disc) for side in (1.0, -1.0))
        own = disc_coordinates(drive)
        centre, axis, turn = self._centre(disc), self._axis(disc), np.exp(1j * self.pose[own * disc + 2])
        places, radii = parts.wheel_pins
        pin = axis + places * np.exp(1j * self.pose[-1]) + self.wheel_place[disc]
        into, approach = self._into_flank(disc, (pin - centre) * np.conj(turn), radii)
        into = into * turn
        # The wheel turns about its axis, the disc goes around without turning; their displacements go around with the load.
        turning = np.angle(ahead.wheel_pins[0] / behind.wheel_pins[0]) / (2.0 * TURNED)
        carried = (ahead.place - behind.place) / (2.0 * TURNED) + 1j * (centre - parts.place)
        point = pin + (radii - approach) * into
        speed = 1j * turning * (point - axis) + 1j * self.wheel - carried
        coefficient = np.full(places.size, easier_coefficient(friction.pin, friction.seat, drive.pin_wheel))
        if drive.pin_shaft is not None:
            shaft, shaft_radii = parts.shaft_pins
            shaft = shaft + self.shaft_place[disc]
            apart = shaft - (centre + parts.holes[0] * turn)
            outward = apart / np.where(apart == 0.0, 1.0, np.abs(apart))
            into = np.concatenate((into, outward))
            point = np.concatenate((point, shaft + shaft_radii * outward))
            speed = np.concatenate((speed, np.full(shaft.size, -carried)))
            hole = easier_coefficient(friction.hole, friction.seat, drive.pin_shaft)
            coefficient = np.concatenate((coefficient, np.full(shaft.size, hole)))
        slip = (np.conj(1j * into) * speed).real
        most = coefficient * np.concatenate((part.pin_load[0], part.hole_load[0]))
        rubbing = -self._motion * np.sign(slip) * most * 1j * into
        # Next to the pitch point it may have any size up to that.
        told, rolls = self._told(disc), np.abs(slip) < 1.01 * FADES * drive.crank.eccentricity
        some = rolls & (np.abs(told) <= (1.0 + SAME) * most)
        return RubbedContacts(point=point, into_disc=into, rubbing=np.where(some, told, rubbing), most=most, slip=slip)

    def _into_flank(self, disc: int, at: ComplexArray, radii: FloatArray) -> tuple[ComplexArray, FloatArray]:
        """Unit vectors from loaded wheel pins into the flank, in the frame of the disc, and approaches; 0 for the others."""
        step = 1e-5 * self.drive.pin_wheel.pin_radius
        rows = at + step * np.array([0.0, 1.0, -1.0, 1j, -1j])[:, None]
        approach = DeviatedFlank(self.drive, disc).approaches(rows, radii, 10.0 * step)[0]
        slope: ComplexArray = (approach[1] - approach[2] + 1j * (approach[3] - approach[4])) / (2.0 * step)
        loaded = self.parts[disc].pin_load[0] > 0.0
        into = np.where(loaded, slope, 0.0) / np.where(loaded, np.abs(slope), 1.0)
        return np.asarray(into), np.where(loaded, approach[0], 0.0)


def _at_least(carried: ComplexArray, spring: SidedSpring | None) -> FloatArray:
    """Loads of bearings, N: those of both sides of preloaded ones where these are more."""
    return np.maximum(np.abs(carried), 0.0 if spring is None else spring.load_at_rest)
