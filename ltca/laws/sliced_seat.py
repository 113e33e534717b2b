r"""Contacts in slices in series with the seats of loose pins and sleeves.

A loose pin, or a sleeve, stands between the flank (or the hole) and its seat. It travels into the seat by s and leans into it by
:math:`\psi`, so that the contact outside approaches by :math:`\delta - s` and tilts by :math:`\theta - \psi`. s and
:math:`\psi` are where the energy of both is least: forces and moments of both are equal. A seat is the plane law
(`ltca.laws.conforming`) at every height: slices of it do not feel each other. Across the line of load a loose part aligns itself
with its seat.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import FloatArray, by_drive, take_rows
from ltca.errors import ConvergenceError
from ltca.laws.between_contacts import SETTLED, PartStiffness, newton_step, shorten_steps, unbalanced
from ltca.laws.conforming import ConformingLaw
from ltca.laws.slenderness_curve import quintic_spline_pieces
from ltca.laws.sliced_contact import EXACT, POINTS, SHARES, Exactness, SlicedContact, slice_heights
from ltca.laws.sliced_line import TOUCHING, SlicedLine
from ltca.laws.sliced_plane import SlicedPlane
from ltca.laws.sliced_spring import SlicedSpring

LEAST_PLAY = 1e-9
"""Play that stands for none, mm."""
_ALL = slice(None)
MAX_ITERATIONS = 60
_LIGHTEST, _HEAVIEST, _KNOTS = -40.0, 20.0, 601


class _Seat(NamedTuple):
    """Load, moment and their derivatives of seats, shape (contacts,), and line loads, (contacts, slices, points)."""

    load: FloatArray
    moment: FloatArray
    by_travel: FloatArray
    by_lean: FloatArray
    moment_by_lean: FloatArray
    line_load: FloatArray

    def stiffness(self, length: float) -> PartStiffness:
        """Second derivatives of the energy by travel and lean."""
        return PartStiffness(self.by_travel, self.by_lean, self.moment_by_lean, 0.5 * length)


@dataclass(frozen=True, slots=True, kw_only=True)
class SlicedSeat:
    """Law of conforming seats in slices.

    Attributes
    ----------
    law : ConformingLaw
        Of the whole width.
    slices : int
        As of `ltca.laws.sliced_line.SlicedLine`.
    curve : array, shape (6, pieces)
        Level of the approach over the logarithm of the travel, both by what makes them the same for every play.
    """

    law: ConformingLaw
    slices: int
    curve: FloatArray

    @classmethod
    def of_law(cls, law: ConformingLaw, slices: int) -> SlicedSeat:
        """Return slices of the law of a seat."""
        goal = np.linspace(_LIGHTEST, _HEAVIEST, _KNOTS)
        # With unit play the travel is g (level of the approach at g), in lengths and loads of the series.
        scale = law.series.load_scale
        unit = scale * law.contact_modulus * law.length
        place = goal.copy()
        for _ in range(100):
            approach, compliance = law.approach_and_compliance(unit * np.exp(place), 1.0)
            off = np.log(approach / scale) - goal
            place = place - (off * approach / (unit * np.exp(place) * compliance)).clip(-3.0, 3.0)
            if np.max(np.abs(off)) < 1e-14:
                break
        return cls(law=law, slices=slices, curve=quintic_spline_pieces(np.exp(goal - place)))

    def press(self, travel: FloatArray, lean: FloatArray, play: FloatArray) -> _Seat:
        """Return what seats carry at travels, mm, and leans, rad, shape (contacts,), zero where open."""
        z = slice_heights(self.law.length, self.slices)
        weights = self.law.length / self.slices * SHARES
        local = travel[:, None, None] + lean[:, None, None] * z
        pressed = local > 0.0
        unit = (
            self.law.series.load_scale
            * np.broadcast_to(np.maximum(play, LEAST_PLAY)[:, None, None], local.shape)[pressed]
        )
        line, slope = np.zeros(local.shape), np.zeros(local.shape)
        level, bend = self._level(np.log(local[pressed] / unit))
        line[pressed] = self.law.contact_modulus * local[pressed] / level
        slope[pressed] = self.law.contact_modulus / level * (1.0 - bend / level)
        by_point = slope * weights
        return _Seat(
            load=(line @ weights).sum(axis=1),
            moment=((line * z) @ weights).sum(axis=1),
            by_travel=by_point.sum(axis=(1, 2)),
            by_lean=(by_point * z).sum(axis=(1, 2)),
            moment_by_lean=(by_point * z**2).sum(axis=(1, 2)),
            line_load=line,
        )

    def heaviest(self, load: FloatArray, moment: FloatArray, play: FloatArray) -> FloatArray:
        """Return the load of the whole width at the line load of the most loaded end of seats, N, from their loads and moments.

        Arrays have the shape (contacts,), N and N·mm; loads are positive.

        Raises
        ------
        ConvergenceError
            When no line of travel carries these.
        """
        travel, lean = self.under(load, moment, play)
        end = travel + 0.5 * self.law.length * np.abs(lean)
        level, _ = self._level(np.log(end / (self.law.series.load_scale * np.maximum(play, LEAST_PLAY))))
        return np.asarray(self.law.contact_modulus * self.law.length * end / level)

    def under(self, load: FloatArray, moment: FloatArray, play: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return travels, mm, and leans, rad, of seats under loads and moments; arguments and errors as for `heaviest`."""
        travel, _ = self.law.approach_and_compliance(load, np.maximum(play, LEAST_PLAY))
        lean, half = np.zeros_like(travel), 0.5 * self.law.length
        history = []
        for _ in range(MAX_ITERATIONS):
            seat = self.press(travel, lean, play)
            left = np.maximum(np.abs(seat.load - load), np.abs(seat.moment - moment) / half) / load
            history.append(float(np.max(left, initial=0.0)))
            if history[-1] <= 1e-9:
                return travel, lean
            travel, lean = self._carry(load, moment, play, (travel, lean), seat)
        raise ConvergenceError("seats in slices do not carry loads and moments; left over by the load", history)

    def _carry(
        self,
        load: FloatArray,
        moment: FloatArray,
        play: FloatArray,
        place: tuple[FloatArray, FloatArray],
        seat: _Seat,
    ) -> tuple[FloatArray, FloatArray]:
        """Travel and lean a step closer to where seats carry loads and moments."""
        travel, lean = place
        step, turn, slope = newton_step(seat.load - load, seat.moment - moment, seat.stiffness(self.law.length))

        def move(some: NDArray[np.intp], fraction: FloatArray) -> tuple[FloatArray, FloatArray]:
            by, turned = step[some], turn[some]
            there = self.press(travel[some] + fraction * by, lean[some] + fraction * turned, play[some])
            ahead = (there.load - load[some]) * by + (there.moment - moment[some]) * turned
            return ahead, there.stiffness(self.law.length).along(by, turned)

        fraction = shorten_steps(slope, move)
        return travel + fraction * step, lean + fraction * turn

    def _level(self, place: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Level at the logarithm of the travel, and its derivative."""
        spacing = (_HEAVIEST - _LIGHTEST) / (_KNOTS - 1)
        at = (place.clip(_LIGHTEST, _HEAVIEST) - _LIGHTEST) / spacing
        piece = np.minimum(at.astype(np.intp), _KNOTS - 2)
        t = at - piece
        c0, c1, c2, c3, c4, c5 = self.curve[:, piece]
        value = c0 + t * (c1 + t * (c2 + t * (c3 + t * (c4 + t * c5))))
        first = (c1 + t * (2.0 * c2 + t * (3.0 * c3 + t * (4.0 * c4 + t * 5.0 * c5)))) / spacing
        inside = (place >= _LIGHTEST) & (place <= _HEAVIEST)
        return value, np.where(inside, first, 0.0)

    def energy(self, line_load: FloatArray, play: FloatArray) -> FloatArray:
        """Return the energy of seats under line loads, N·mm, shape (contacts,)."""
        length = self.law.length
        weights = SHARES / self.slices
        stored = self.law.energy(line_load * length, np.maximum(play, LEAST_PLAY)[:, None, None])
        return np.asarray((stored @ weights).sum(axis=1))


@dataclass(frozen=True, slots=True, kw_only=True)
class BackedLine:
    """Contacts in slices of one kind in series with the seats of their pins or sleeves.

    Attributes
    ----------
    contact : SlicedLine, SlicedPlane or SlicedSpring
        Law of the surfaces in contact.
    seat : SlicedSeat
        Law of the seats.
    play : array
        Radial play of the seats, shape (pairs,) or (positions, pairs), mm.
    """

    contact: SlicedLine | SlicedPlane | SlicedSpring
    seat: SlicedSeat
    play: FloatArray = by_drive(1)

    @property
    def length(self) -> float:
        """Length of the contacts, mm."""
        return self.contact.length

    @property
    def slices(self) -> int:
        """Slices of the contacts."""
        return self.contact.slices

    def respond(
        self,
        approach: FloatArray,
        tilt: FloatArray,
        effective_radius: FloatArray,
        start: FloatArray | None = None,
        exactness: Exactness = EXACT,
    ) -> SlicedContact:
        """Return loads, moments and their derivatives of contact and seat, as `ltca.laws.sliced_line.SlicedLine.respond`.

        Loads of the slices are those of the contact outside. What is left over is nothing, whatever would do.
        """
        return self.solve(approach, tilt, effective_radius, start)[0]

    def solve(
        self, approach: FloatArray, tilt: FloatArray, effective_radius: FloatArray, start: FloatArray | None = None
    ) -> tuple[SlicedContact, FloatArray, FloatArray]:
        """Return the same with travel, mm, and lean, rad, of the pins or sleeves in their seats, zero where open.

        Raises
        ------
        ConvergenceError
            When they do not settle.
        """
        given = np.broadcast_arrays(approach, tilt, effective_radius, self.play)
        shape = given[0].shape
        delta, theta, radius, play = (each.reshape(-1) for each in given)
        highest = slice_heights(self.length, self.slices).max()
        # An open contact that a relief keeps open is found so by its law.
        metal = 0.0 if isinstance(self.contact, SlicedSpring) else max(0.0, -float(self.contact.relief.min()))
        closed = np.flatnonzero(delta + highest * np.abs(theta) + metal > TOUCHING * self.length)
        sizes = {"slice_load": (self.slices,), "line_load": (self.slices, POINTS), "near": (2 + 3 * self.slices,)}
        names = ("load", "moment", "by_approach", "by_tilt", "moment_by_tilt", *sizes)
        whole = {name: np.zeros((delta.size, *sizes.get(name, ()))) for name in names}
        travel, lean = np.zeros(delta.size), np.zeros(delta.size)
        if closed.size:
            near = None if start is None else start.reshape(-1, start.shape[-1])[closed]
            # Drives of a batch may have reliefs and springs of their own.
            own = replace(self, contact=take_rows(self.contact, np.unravel_index(closed, shape)[0]))
            found, travel[closed], lean[closed] = own._closed(
                delta[closed], theta[closed], radius[closed], play[closed], near
            )
            for name, values in whole.items():
                values[closed] = getattr(found, name)
        answer = SlicedContact(**{name: values.reshape((*shape, *values.shape[1:])) for name, values in whole.items()})
        return answer, travel.reshape(shape), lean.reshape(shape)

    def energy(self, contact: SlicedContact, effective_radius: FloatArray) -> FloatArray:
        """Return the energy of contacts and their seats, N·mm, shape (…)."""
        found = self.contact.energy(contact, effective_radius)
        presses = contact.load > 0.0
        load, moment, play = (
            np.broadcast_to(each, presses.shape)[presses] for each in (contact.load, contact.moment, self.play)
        )
        seat = self.seat.press(*self.seat.under(load, moment, play), play)
        found[presses] += self.seat.energy(seat.line_load, play)
        return found

    def _closed(
        self, delta: FloatArray, theta: FloatArray, radius: FloatArray, play: FloatArray, start: FloatArray | None
    ) -> tuple[SlicedContact, FloatArray, FloatArray]:
        travel, lean = 0.5 * delta, 0.5 * theta
        half = 0.5 * self.length
        if start is not None:
            loads = start[:, 2 : 2 + self.slices]
            known = np.count_nonzero(loads > 0.0, axis=1) > 2  # a line through two slices says little
            near = self._seat_under(loads[known], play[known])
            travel[known], lean[known] = near
            # What was there may leave nothing pressed outside here.
            lost = np.zeros(delta.shape, dtype=bool)
            lost[known] = (delta - travel)[known] + half * np.abs(theta - lean)[known] <= 0.0
            travel[lost], lean[lost] = 0.5 * delta[lost], 0.5 * theta[lost]
        contact = self._outside(_ALL, delta - travel, theta - lean, radius, start)
        seat = self.seat.press(travel, lean, play)
        # What round-off of places, some eight lengths away, makes of a load.
        lightest = np.spacing(8.0 * self.length) * self.seat.law.contact_modulus * self.length / SETTLED
        before, history = np.full(delta.shape, np.inf), []
        for _ in range(MAX_ITERATIONS):
            force, moment = seat.load - contact.load, seat.moment - contact.moment
            size = np.maximum(np.maximum(seat.load, contact.load), lightest)
            left = np.maximum(np.abs(force), np.abs(moment) / half) / size
            history.append(float(np.max(left, initial=0.0)))
            going = unbalanced(left, before)
            if not going.size:
                break
            before = left
            self._step(going, (delta, theta, radius, play), travel, lean, contact, seat)
        else:
            raise ConvergenceError(
                "loose pins or sleeves do not settle in their seats; force left over by the load", history
            )
        return self._in_series(contact, seat, play), travel, lean

    def _outside(
        self, rows: Any, approach: FloatArray, tilt: FloatArray, radius: FloatArray, start: FloatArray | None
    ) -> SlicedContact:
        """Some of the contacts outside at what the seats leave them; each is a row of its own."""
        contact = take_rows(self.contact, rows)
        near = None if start is None else start[:, None]
        return contact.respond(approach[:, None], tilt[:, None], radius[:, None], near).squeezed()

    def _seat_under(self, loads: FloatArray, play: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Travel and lean under the loads of slices, by least squares over what carries."""
        own, _ = self.seat.law.approach_and_compliance(loads * self.slices, np.maximum(play, LEAST_PLAY)[:, None])
        z = slice_heights(self.length, self.slices).mean(axis=1)
        total = loads.sum(axis=1)
        middle, mean = (loads @ z) / total, (loads * own).sum(axis=1) / total
        apart = z - middle[:, None]
        spread = (loads * apart**2).sum(axis=1)
        slope = (loads * apart * own).sum(axis=1) / spread
        return mean - slope * middle, slope

    def _step(
        self,
        going: NDArray[np.intp],
        given: tuple[FloatArray, FloatArray, FloatArray, FloatArray],
        travel: FloatArray,
        lean: FloatArray,
        contact: SlicedContact,
        seat: _Seat,
    ) -> None:
        """Newton's step of those that go on, in place, shortened where the energy rises again steeply at its end."""
        first, second = contact.take(going), _Seat(*(values[going] for values in seat))
        force, moment = second.load - first.load, second.moment - first.moment
        step, turn, slope = newton_step(force, moment, _together(first, second, self.length))
        begin, upright = travel[going], lean[going]

        def move(some: NDArray[np.intp], fraction: FloatArray) -> tuple[FloatArray, FloatArray]:
            rows, by, turned = going[some], step[some], turn[some]
            travel[rows], lean[rows] = begin[some] + fraction * by, upright[some] + fraction * turned
            delta, theta, radius, play = (values[rows] for values in given)
            there = self._outside(rows, delta - travel[rows], theta - lean[rows], radius, first.near[some])
            under = self.seat.press(travel[rows], lean[rows], play)
            contact.put(rows, there)
            for values, part in zip(seat, under, strict=True):
                values[rows] = part
            ahead = (under.load - there.load) * by + (under.moment - there.moment) * turned
            return ahead, _together(there, under, self.length).along(by, turned)

        shorten_steps(slope, move)

    def _in_series(self, contact: SlicedContact, seat: _Seat, play: FloatArray) -> SlicedContact:
        """The contact with the derivatives and the energy of both."""
        own = np.empty((contact.load.size, 2, 2))
        own[:, 0, 0], own[:, 1, 1] = contact.by_approach, contact.moment_by_tilt
        own[:, 0, 1] = own[:, 1, 0] = contact.by_tilt
        # What a relief keeps open although middle or ends overlap carries nothing and has no stiffness.
        both = _together(contact, seat, self.length).matrix
        found = own - np.matmul(own, np.linalg.solve(both, own))
        return SlicedContact(
            load=contact.load,
            moment=contact.moment,
            by_approach=found[:, 0, 0],
            by_tilt=0.5 * (found[:, 0, 1] + found[:, 1, 0]),
            moment_by_tilt=found[:, 1, 1],
            slice_load=contact.slice_load,
            line_load=contact.line_load,
            near=contact.near,
        )


def _together(contact: SlicedContact, seat: _Seat, length: float) -> PartStiffness:
    """Second derivatives of the energy by travel and lean."""
    return PartStiffness(
        contact.by_approach + seat.by_travel,
        contact.by_tilt + seat.by_lean,
        contact.moment_by_tilt + seat.moment_by_lean,
        0.5 * length,
    )


def back_line(
    contact: SlicedLine | SlicedPlane | SlicedSpring, seat: ConformingLaw | None, play: FloatArray
) -> SlicedLine | SlicedPlane | SlicedSpring | BackedLine:
    """Return the law of contacts in slices with the seats behind them; that of the contacts alone for fixed pins."""
    if seat is None:
        return contact
    return BackedLine(contact=contact, seat=SlicedSeat.of_law(seat, contact.slices), play=play)
