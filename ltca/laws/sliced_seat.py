"""Contacts in slices in series with the seats of loose pins and sleeves, plane laws at every height (`ltca.laws.conforming`).

The part travels into its seat by s and leans by ψ, where the energy of contact (δ − s, θ − ψ) and seat is least; across the line
of load it aligns itself. The energy is nearly convex: a step is shortened where its slope along the step rises again steeply,
which tells also where differences of energies are round-off.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ltca.arrays import FloatArray, by_drive
from ltca.errors import ConvergenceError
from ltca.laws.conforming import ConformingLaw
from ltca.laws.contact_law import ContactLaw
from ltca.laws.separate_slices import SeparateSlices
from ltca.laws.slenderness_curve import quintic, quintic_spline_pieces
from ltca.laws.sliced_contact import EXACT, Exactness, SlicedContact, slice_heights
from ltca.laws.sliced_line import TOUCHING, SlicedLine

LEAST_PLAY = 1e-9
"""Play that stands for none, mm."""
SETTLED = 1e-10
"""Largest force and moment (by half the length) left over, by the larger load of the two contacts."""
ROUND_OFF = 1e-7
"""What is left that may be due to what the slices leave over."""
MAX_TRIALS = 16
"""Places along a step at which the slope of the energy is asked for."""
STEEPEST = 0.5
"""Largest slope of the energy at the end of a step, by that at its start, that is not shortened."""
LEAST_TURNING = 1e-9
"""Stiffness against leaning by that of the place and half the length squared: what touches at one end turns freely about it."""
DAMPING = 1e-6
"""The same of a step: a residual of free turning must not send it far."""
MAX_ITERATIONS = 60
_LIGHTEST, _HEAVIEST, _KNOTS = -40.0, 20.0, 601

_PER_KNOT = (_KNOTS - 1) / (_HEAVIEST - _LIGHTEST)

Outside = Callable[[NDArray[np.intp], FloatArray, FloatArray | None], SlicedContact]
"""What presses some parts, by their numbers, at travels into their seats, mm, and leans, rad, from what it was nearby."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SeatLaw(ContactLaw):
    """Load of conforming seats by their travel, with the play of each, mm, in the place of an effective radius."""

    law: ConformingLaw
    curve: FloatArray  # pieces of the level of the approach over ln(travel), alike for every play, shape (6, pieces)

    @classmethod
    def of_law(cls, law: ConformingLaw) -> SeatLaw:
        """Return the law turned over."""
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
        return cls(law=law, curve=quintic_spline_pieces(np.exp(goal - place)))

    def load_and_stiffness(self, approach: ArrayLike, effective_radius: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Return the load at a travel and its derivative, N and N/mm; zeros where open."""
        travel = np.asarray(approach, dtype=float)
        pressed = travel > 0.0
        unit = self.law.series.load_scale * np.maximum(effective_radius, LEAST_PLAY)
        at = (np.log(np.where(pressed, travel, 1.0) / unit).clip(_LIGHTEST, _HEAVIEST) - _LIGHTEST) * _PER_KNOT
        piece = np.minimum(at.astype(np.intp), _KNOTS - 2)
        level, slope, _ = quintic(self.curve.take(piece, axis=1), at - piece)
        bend = np.where((at > 0.0) & (at < _KNOTS - 1.0), slope * _PER_KNOT, 0.0)
        stiffness = pressed * (self.law.contact_modulus * self.law.length / level)
        return stiffness * travel, stiffness * (1.0 - bend / level)

    def energy(self, approach: ArrayLike, effective_radius: ArrayLike) -> FloatArray:
        """Return ∫ F dδ, N·mm."""
        load, _ = self.load_and_stiffness(approach, effective_radius)
        return self.law.energy(load, np.maximum(effective_radius, LEAST_PLAY))

    def travel(self, load: FloatArray, play: FloatArray) -> FloatArray:
        """Return the travel of seats under loads, N, mm."""
        return self.law.approach_and_compliance(load, np.maximum(play, LEAST_PLAY))[0]


@dataclass(frozen=True, slots=True, kw_only=True)
class SlicedSeat(SeparateSlices):
    """Law of conforming seats in slices, which takes plays, mm, for effective radii."""

    law: SeatLaw

    @classmethod
    def of_law(cls, law: ConformingLaw, slices: int) -> SlicedSeat:
        """Return slices of the law of a seat."""
        relief = np.zeros(slice_heights(law.length, slices).shape)
        return cls(law=SeatLaw.of_law(law), length=law.length, slices=slices, relief=relief)

    def heaviest(self, load: FloatArray, moment: FloatArray, play: FloatArray) -> FloatArray:
        """Return the load of the width at the line load of the more loaded end, N, by loads and moments, N, N·mm, (contacts,)."""
        travel, lean = self.under(load, moment, play)
        return self.law.load_and_stiffness(travel + 0.5 * self.length * np.abs(lean), play)[0]

    def under(self, load: FloatArray, moment: FloatArray, play: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return travels, mm, and leans, rad, of seats under loads and moments; arguments and errors as for `heaviest`."""

        def outside(rows: NDArray[np.intp], *_: FloatArray | None) -> SlicedContact:
            return replace(SlicedContact.open(rows.size, 0), load=load[rows], moment=moment[rows])

        moved = np.stack((self.law.travel(load, play), np.zeros(load.shape)), axis=1)
        self.balance(outside, play, moved)
        return moved[:, 0], moved[:, 1]

    def balance(
        self, outside: Outside, play: FloatArray, moved: FloatArray, near: FloatArray | None = None
    ) -> tuple[SlicedContact, SlicedContact]:
        """Move travels and leans, in place, to where seats carry what presses them; return contact and seat there."""
        half = 0.5 * self.length
        contact, held = outside(np.arange(len(moved)), moved, near), self.respond(moved[:, 0], moved[:, 1], play)

        def step(going: NDArray[np.intp]) -> None:
            """Newton's step of those that go on, shortened where the energy rises again steeply at its end."""
            begin, known = moved[going], contact.near[going]
            by, slope = newton_step(unbalanced(contact, held)[going], joint_stiffness(contact, held)[going], half)

            def move(some: NDArray[np.intp], fraction: FloatArray) -> tuple[FloatArray, FloatArray]:
                rows, along = going[some], by[some]
                moved[rows] = begin[some] + fraction[:, None] * along
                there = outside(rows, moved[rows], known[some])
                under = self.respond(moved[rows, 0], moved[rows, 1], play[rows])
                contact.put(rows, there)
                held.put(rows, under)
                bend = np.einsum("ci,cij,cj->c", along, joint_stiffness(there, under), along)
                return (unbalanced(there, under) * along).sum(axis=1), bend

            shorten_steps(slope, move)

        # What round-off of places, some eight lengths away, makes of a load.
        lightest = np.spacing(8.0 * self.length) * self.law.law.contact_modulus * self.length / SETTLED
        before, history = np.full(len(moved), np.inf), []
        for _ in range(MAX_ITERATIONS):
            size = np.maximum(np.maximum(held.load, contact.load), lightest)
            left = np.abs(unbalanced(contact, held) / (1.0, half)).max(axis=1) / size
            history.append(float(np.max(left, initial=0.0)))
            # Nothing but what the slices leave over is left where steps no longer help.
            going = np.flatnonzero((left > SETTLED) & ~((before < ROUND_OFF) & (left >= 0.5 * before)))
            if not going.size:
                return contact, held
            before = left
            step(going)
        raise ConvergenceError(
            "loose pins or sleeves do not settle in their seats; force left over by the load", history
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class BackedLine:
    """Contacts in slices in series with seats of a radial play, mm, shape (pairs,) or (positions, pairs)."""

    contact: SlicedLine | SeparateSlices
    seat: SlicedSeat
    play: FloatArray = by_drive(1)

    def respond(
        self,
        approach: FloatArray,
        tilt: FloatArray,
        effective_radius: FloatArray,
        start: FloatArray | None = None,
        exactness: Exactness = EXACT,
    ) -> SlicedContact:
        """Return loads, moments and derivatives of contact and seat as `SlicedLine.respond`; balanced to round-off always."""
        return self.solve(approach, tilt, effective_radius, start)[0]

    def solve(
        self, approach: FloatArray, tilt: FloatArray, effective_radius: FloatArray, start: FloatArray | None = None
    ) -> tuple[SlicedContact, FloatArray, FloatArray]:
        """Return the same with travel, mm, and lean, rad, of the pins or sleeves in their seats, zero where open."""
        contact, length = self.contact, self.contact.length
        given = np.broadcast_arrays(approach, tilt, effective_radius, self.play)
        shape = given[0].shape
        delta, theta, radius, play = (each.reshape(-1) for each in given)
        whole, moved = SlicedContact.open(delta.size, contact.slices), np.zeros((delta.size, 2))
        # An open contact that a relief keeps open is found so by its law.
        reach = delta + slice_heights(length, contact.slices).max() * np.abs(theta) - contact.relief.min(initial=0.0)
        closed = np.flatnonzero(reach > TOUCHING * length)
        if closed.size:
            near = None if start is None else start.reshape(-1, start.shape[-1])[closed]
            law = contact.take(shape, np.unravel_index(closed, shape))
            delta, theta, radius, play = (each[closed] for each in (delta, theta, radius, play))
            begin = self._begin(delta, theta, play, near)

            def outside(rows: NDArray[np.intp], moved: FloatArray, known: FloatArray | None) -> SlicedContact:
                one = law.take((closed.size,), (rows,))
                return one.respond(delta[rows] - moved[:, 0], theta[rows] - moved[:, 1], radius[rows], known)

            whole.put(closed, _in_series(*self.seat.balance(outside, play, begin, near), 0.5 * length))
            moved[closed] = begin
        return whole.shaped(shape), moved[:, 0].reshape(shape), moved[:, 1].reshape(shape)

    def energy(self, contact: SlicedContact, effective_radius: FloatArray) -> FloatArray:
        """Return the energy of contacts and their seats, N·mm, shape (…)."""
        presses = contact.load > 0.0
        found = np.where(presses, self.contact.energy(contact, effective_radius), 0.0)
        load, moment, play = (
            np.broadcast_to(each, presses.shape)[presses] for each in (contact.load, contact.moment, self.play)
        )
        travel, lean = self.seat.under(load, moment, play)
        found[presses] += self.seat.energy(self.seat.respond(travel, lean, play), play)
        return found

    def _begin(self, delta: FloatArray, theta: FloatArray, play: FloatArray, start: FloatArray | None) -> FloatArray:
        """Travel and lean to start from: under the loads of a neighbour's slices, by least squares over what carries."""
        moved = 0.5 * np.stack((delta, theta), axis=1)
        if start is None:
            return moved
        slices, length = self.contact.slices, self.contact.length
        loads = start[:, 2 : 2 + slices]
        known = np.flatnonzero(np.count_nonzero(loads > 0.0, axis=1) > 2)  # a line through two slices says little
        loads = loads[known]
        own = self.seat.law.travel(loads * slices, play[known, None])
        z, total = slice_heights(length, slices).mean(axis=1), loads.sum(axis=1)
        middle, mean = (loads @ z) / total, (loads * own).sum(axis=1) / total
        apart = z - middle[:, None]
        lean = (loads * apart * own).sum(axis=1) / (loads * apart**2).sum(axis=1)
        travel = mean - lean * middle
        # What was there may leave nothing pressed outside here.
        held = delta[known] - travel + 0.5 * length * np.abs(theta[known] - lean) > 0.0
        moved[known[held]] = np.stack((travel, lean), axis=1)[held]
        return moved


def back_line(
    contact: SlicedLine | SeparateSlices, seat: ConformingLaw | None, play: FloatArray
) -> SlicedLine | SeparateSlices | BackedLine:
    """Return the law of contacts in slices with the seats behind them; that of the contacts alone for fixed pins."""
    if seat is None:
        return contact
    return BackedLine(contact=contact, seat=SlicedSeat.of_law(seat, contact.slices), play=play)


def unbalanced(contact: SlicedContact, seat: SlicedContact) -> FloatArray:
    """Return the force and moment of seats less those that press them, N and N·mm, shape (contacts, 2)."""
    return np.stack((seat.load - contact.load, seat.moment - contact.moment), axis=1)


def stiffness_of(contact: SlicedContact) -> FloatArray:
    """Return derivatives of load and moment by approach and tilt, N/mm, N/rad and N·mm/rad, shape (contacts, 2, 2)."""
    values = contact.by_approach, contact.by_tilt, contact.by_tilt, contact.moment_by_tilt
    return np.stack(values, axis=1).reshape(-1, 2, 2)


def joint_stiffness(contact: SlicedContact, seat: SlicedContact) -> FloatArray:
    """Return second derivatives of the energy by travel and lean, N/mm, N/rad and N·mm/rad, shape (contacts, 2, 2)."""
    return stiffness_of(contact) + stiffness_of(seat)


def _invertible(stiffness: FloatArray, turning: float) -> FloatArray:
    """Stiffnesses with some of that of the place against leaning, mm²; one where nothing touches."""
    found = stiffness.copy()
    found[:, 1, 1] += turning * found[:, 0, 0]
    found[stiffness[:, 0, 0] <= 0.0] = np.eye(2)
    return found


def _in_series(contact: SlicedContact, seat: SlicedContact, half: float) -> SlicedContact:
    """The contact with the derivatives of both."""
    own = stiffness_of(contact)
    # What a relief keeps open although middle or ends overlap carries nothing and has no stiffness.
    both = _invertible(joint_stiffness(contact, seat), LEAST_TURNING * half**2)
    found = own - np.matmul(own, np.linalg.solve(both, own))
    return replace(
        contact,
        by_approach=found[:, 0, 0],
        by_tilt=0.5 * (found[:, 0, 1] + found[:, 1, 0]),
        moment_by_tilt=found[:, 1, 1],
        left=np.zeros(contact.left.shape),
    )


def newton_step(left: FloatArray, stiffness: FloatArray, half: float) -> tuple[FloatArray, FloatArray]:
    """Return Newton's step of travel, mm, and lean, rad, (parts, 2), and the slope of the energy, N·mm; `half` the length."""
    step = -np.linalg.solve(_invertible(stiffness, DAMPING * half**2), left[..., None])[..., 0]
    return np.asarray(step), np.asarray((left * step).sum(axis=1))


def shorten_steps(
    slope: FloatArray, move: Callable[[NDArray[np.intp], FloatArray], tuple[FloatArray, FloatArray]]
) -> FloatArray:
    """Return the parts of steps taken: the whole, or to where the slope of the energy, which `move` returns, has nearly gone."""
    fraction, low, high = np.ones(slope.size), np.zeros(slope.size), np.full(slope.size, np.inf)
    steep, rows = STEEPEST * np.abs(slope), np.arange(slope.size)
    for trial in range(MAX_TRIALS):
        ahead, bend = move(rows, fraction[rows])
        far = ahead > steep[rows]
        short = (ahead < -steep[rows]) & np.isfinite(high[rows])
        high[rows[far]], low[rows[short]] = fraction[rows[far]], fraction[rows[short]]
        on = far | short
        if not on.any() or trial == MAX_TRIALS - 1:
            break
        rows, ahead, bend = rows[on], ahead[on], bend[on]
        # Where a slice begins to carry the slope turns within a little: from beyond, its tangent leads there. From before it
        # leads anywhere; places are halved by their size then.
        tangent = fraction[rows] - ahead / np.where(bend > 0.0, bend, 1.0)
        within = (bend > 0.0) & (tangent > low[rows]) & (tangent < high[rows])
        cut = high[rows] * np.clip(np.abs(slope[rows]) / (np.abs(slope[rows]) + np.abs(ahead)), 0.1, 0.7)
        halved = np.where(low[rows] > 0.0, np.sqrt(low[rows] * high[rows]), cut)
        fraction[rows] = np.where(within, tangent, halved)
    return fraction
