r"""Motion of a drive in time: Lagrange's equations on the contacts' own laws (``docs/theory/motion.md``).

Coordinates are :math:`x = B y + g\,s(t)`; beside y and its rate the state has the works of `WORKS`, N·mm.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from scipy.linalg.lapack import dposv, dsygv

from ltca.arrays import FloatArray
from ltca.dynamics.contact_forces import ContactForces, Instant
from ltca.dynamics.kinetic_energy import KineticEnergy
from ltca.dynamics.massless import MasslessParts
from ltca.errors import ConvergenceError

WORKS = ("input", "output", "damping", "friction")
"""Works that the state ends with."""
SOFTEST = 1e-3
"""Frequency by the highest one below which a motion counts as free, and is not damped."""
REST_STEPS, REST_SETTLED, REST_HALVINGS = 200, 1e-10, 8
"""Steps to a balanced state, the last one by the largest coordinate, mm, and how often one is halved."""
REST_PLAIN, REST_ASIDE = 12, 1e-7
"""Steps by the stiffness alone, without friction, and places aside by which it is differenced after them, mm."""

Profile = Callable[[float], tuple[float, float, float]]
"""Angle, speed and acceleration of the input at a time."""


class Moment(NamedTuple):
    """The equation of motion at a state."""

    state_rate: FloatArray
    input_torque: float  # ccw positive, N·mm
    forces: Instant
    place: FloatArray  # coordinates of all parts, mm and rad
    rate: FloatArray  # and their rates


@dataclass(frozen=True, slots=True, kw_only=True)
class Equation:
    """Equation of motion of a drive over n coordinates; torques are ccw positive, N·mm."""

    kinetic: KineticEnergy
    contacts: ContactForces
    basis: FloatArray  # B, of parts with mass, mm and rad by mm, shape (n, m)
    lead: FloatArray  # g, by rad of the input, shape (n,)
    input_turns: FloatArray  # rotation of the input, a row
    output_turns: FloatArray
    input_motion: Profile
    output_torque: Callable[[float], float]
    input_torque: float | None  # None where the input turns by `input_motion`
    damping_ratio: float
    massless: MasslessParts | None = None
    refused: list[Exception] = field(default_factory=list)  # of states tried since the last that had a rate

    @property
    def freedoms(self) -> int:
        """Number m of coordinates y."""
        return int(self.basis.shape[1])

    @property
    def whole(self) -> FloatArray:
        """B and, last, the motions of parts without mass, shape (n, m + k)."""
        return self.basis if self.massless is None else np.hstack((self.basis, self.massless.columns))

    def warm_start(self) -> tuple[Any, ...]:
        """Return the inner unknowns from which the next call starts: the last digits of its forces depend on them."""
        contacts = self.contacts.start if self.contacts.has_energy else None
        return contacts, None if self.massless is None else self.massless.warm_start

    def start_from(self, kept: tuple[Any, ...]) -> None:
        """Start the next call from inner unknowns that `warm_start` returned."""
        self.contacts.start = kept[0]
        if self.massless is not None:
            self.massless.warm_start = kept[1]

    def _pushed(self, time: float, x: FloatArray, rate: FloatArray) -> tuple[Instant, FloatArray]:
        """Forces at coordinates and rates, and their sum without inertia and damping, ∂U/∂x + R − Q."""
        now = self.contacts.at(x, rate)
        loaded = self.output_torque(time) * self.output_turns + now.outside
        return now, now.force + now.friction - loaded

    def _moment(self, time: float, state: FloatArray) -> tuple[FloatArray, FloatArray, Instant, FloatArray]:
        """x, its rate, the forces, and B with the parts without mass that follow its motions."""
        m, (angle, speed, _) = self.freedoms, self.input_motion(time)
        x, rate = self.basis @ state[:m] + self.lead * angle, self.basis @ state[m : 2 * m] + self.lead * speed
        if self.massless is None:
            return x, rate, self.contacts.at(x, rate), self.basis
        x, rate, now, slope = self.massless.settle(x, rate, partial(self._pushed, time))
        return x, rate, now, self.basis + self.massless.columns @ (slope @ self.basis)

    def rates(self, time: float, state: FloatArray) -> FloatArray:
        """Return the rate of a state, shape (2m + 4,); NaN, which makes a step shorter, where contacts have no loads at it."""
        if not np.isfinite(state).all():  # a stage behind such a one
            return np.full(state.size, np.nan)
        kept, beside = self.contacts.start, None if self.massless is None else self.massless.warm_start
        try:
            rate = self.solved(time, state).state_rate
        except (ConvergenceError, np.linalg.LinAlgError) as problem:
            self.start_from((kept, beside))
            self.refused.append(problem)
            return np.full(state.size, np.nan)
        self.refused.clear()
        return rate

    def solved(self, time: float, state: FloatArray) -> Moment:
        """Return the rate of a state, with torque, forces and coordinates."""
        m, basis = self.freedoms, self.basis
        x, rate, now, followed = self._moment(time, state)
        mass, inertia = self.kinetic.at(x, rate)
        projected = basis.T @ mass @ basis
        damped = self._damping(now.stiffness, projected, followed) @ rate if self.damping_ratio else np.zeros(x.size)
        loaded = self.output_torque(time) * self.output_turns + now.outside
        told = self.input_motion(time)[2]
        inner = now.force + now.friction + damped + inertia
        outer = loaded if self.input_torque is None else loaded + self.input_torque * self.input_turns
        # LAPACK itself: a system of five takes numpy ten times as long.
        faster = _checked(dposv(projected, basis.T @ (outer - inner - mass @ self.lead * told)))[1]
        torque = self.input_torque
        if torque is None:
            # By virtual work on the rigid motion; the input's own angle is s.
            torque = float(self.lead @ (mass @ (basis @ faster + self.lead * told) + inner - loaded))
        works = torque * (self.input_turns @ rate), -(loaded @ rate), damped @ rate, now.friction @ rate
        return Moment(np.concatenate((state[m : 2 * m], faster, works)), torque, now, x, rate)

    def _damping(self, stiffness: FloatArray, mass: FloatArray, basis: FloatArray) -> FloatArray:
        """C = K Φ diag(2ζ/ω³) Φᵀ K at the state of the moment, shape (n, n), of motions that parts without mass follow."""
        pressed = stiffness @ basis
        square, shapes = _checked(dsygv(basis.T @ pressed, mass))[:2]
        felt = square > SOFTEST**2 * square[-1]
        on_modes = pressed @ shapes[:, felt]
        return np.asarray((on_modes * (2.0 * self.damping_ratio / square[felt] ** 1.5)) @ on_modes.T)

    def _left_over(self, time: float, y: FloatArray) -> tuple[Instant, FloatArray]:
        """Forces and their sum in a state of `at_rest`."""
        angle, speed, _ = self.input_motion(time)
        return self._pushed(time, self.whole @ y + self.lead * angle, self.lead * speed)

    def input_torque_at_rest(self, time: float, y: FloatArray) -> float:
        """Return the torque at the input that balances a time in a state of `at_rest`, ccw positive, N·mm."""
        return float(self.lead @ self._left_over(time, y)[1])

    def at_rest(self, time: float, start: FloatArray) -> FloatArray:
        """Return y of balance, the input held, friction at its speed, and places of parts without mass, shape (m + k,)."""
        y, whole, history = start, self.whole, list[float]()
        step: FloatArray = np.zeros(y.size)
        before, halved = np.inf, 0
        for _ in range(REST_STEPS):
            now, unbalanced = self._left_over(time, y)
            left = whole.T @ unbalanced
            if (size := float(np.linalg.norm(left))) > before and halved < REST_HALVINGS:
                step, halved = 0.5 * step, halved + 1
                y = y + step
                continue
            if len(history) < REST_PLAIN:
                matrix = whole.T @ now.stiffness @ whole
            else:
                ends = [self._left_over(time, y + aside)[1] for aside in REST_ASIDE * np.eye(y.size)]
                matrix = whole.T @ (np.array(ends) - unbalanced).T / REST_ASIDE
            try:
                step = np.asarray(np.linalg.solve(matrix, left), dtype=float)
            except np.linalg.LinAlgError as problem:
                raise ConvergenceError("no balanced state to start from: nothing holds a part", history) from problem
            y, before, halved = y - step, size, 0
            history.append(float(np.abs(step).max()))
            if history[-1] <= REST_SETTLED * max(1.0, float(np.abs(y).max())):
                return y
        raise ConvergenceError("no balanced state to start from; last steps in mm", history)


def _checked(found: tuple[Any, ...]) -> tuple[Any, ...]:
    """Return an answer of LAPACK; ConvergenceError where it failed, as for a motion that is not a number."""
    if found[-1] != 0:
        raise ConvergenceError("the motion has become no number: its masses or forces are not finite", [])
    return found
