r"""Motion of a drive in time: Lagrange's equations on the contacts' own laws (``docs/theory/motion.md``).

Coordinates are :math:`x = B y + g\,s(t)`: s the angle of the input, g the rigid motion of all parts by it, and y what departs
from that. Where the input turns as it is told, B spans the motions that leave it still; where a torque drives it, B spans all.

.. math:: B^T (M\ddot x + h(x, \dot x) + \partial U/\partial x + R + C\dot x - Q) = 0

with inertia forces h, friction R, and torques Q at both ends with forces from outside. With the modes Φ under the stiffness K of
the contacts that are closed, their frequencies ω and the damping ratio ζ,

.. math:: C = K\Phi\,\mathrm{diag}(2\zeta/\omega^3)\,\Phi^T K .

Beside y and its rate the state has the works of input, output, damping and friction, N·mm.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
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
"""Steps to a balanced state, the last one by the largest coordinate, mm, and how often one is halved that leaves more."""
REST_PLAIN, REST_ASIDE = 12, 1e-7
"""Steps by the stiffness alone, which leaves friction out, and places aside by which it is differenced after them, mm."""

Profile = Callable[[float], tuple[float, float, float]]
"""Angle, speed and acceleration of the input at a time."""


class Moment(NamedTuple):
    """What the equation of motion gives for a state: its rate, the torque at the input, ccw positive, N·mm, the forces, and the
    coordinates of all parts and their rates.
    """

    state_rate: FloatArray
    input_torque: float
    forces: Instant
    place: FloatArray
    rate: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class Equation:
    """Equation of motion of a drive over n coordinates.

    `basis` is B, mm and rad by mm, shape (n, m), `lead` is g, by rad of the input, shape (n,); the turns of both ends are rows.
    `input_motion` tells s and its rates at a time, rad, `output_torque` the torque on the output; torques are ccw positive, N·mm,
    that at the input None where it turns as told. B leaves out the motions of parts without mass.
    """

    kinetic: KineticEnergy
    contacts: ContactForces
    basis: FloatArray
    lead: FloatArray
    input_turns: FloatArray
    output_turns: FloatArray
    input_motion: Profile
    output_torque: Callable[[float], float]
    input_torque: float | None
    damping_ratio: float
    massless: MasslessParts | None = None

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
        """x, its rate, the forces, and B with what follows its motions."""
        m, (angle, speed, _) = self.freedoms, self.input_motion(time)
        x, rate = self.basis @ state[:m] + self.lead * angle, self.basis @ state[m : 2 * m] + self.lead * speed
        if self.massless is None:
            return x, rate, self.contacts.at(x, rate), self.basis
        x, rate, now, slope = self.massless.settle(x, rate, partial(self._pushed, time))
        return x, rate, now, self.basis + self.massless.columns @ (slope @ self.basis)

    def rates(self, time: float, state: FloatArray) -> FloatArray:
        """Return the rate of a state, shape (2m + 4,)."""
        return self.solved(time, state).state_rate

    def solved(self, time: float, state: FloatArray) -> Moment:
        """Return the rate of a state, and what goes with it."""
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
        """C at the state of the moment, shape (n, n), of motions that parts without mass follow."""
        pressed = stiffness @ basis
        square, shapes = _checked(dsygv(basis.T @ pressed, mass))[:2]
        felt = square > SOFTEST**2 * square[-1]
        on_modes = pressed @ shapes[:, felt]
        return np.asarray((on_modes * (2.0 * self.damping_ratio / square[felt] ** 1.5)) @ on_modes.T)

    def _left_over(self, time: float, y: FloatArray) -> tuple[Instant, FloatArray]:
        """The same in a state of `at_rest`."""
        angle, speed, _ = self.input_motion(time)
        return self._pushed(time, self.whole @ y + self.lead * angle, self.lead * speed)

    def input_torque_at_rest(self, time: float, y: FloatArray) -> float:
        """Return the torque at the input that balances a time in a state of `at_rest`, ccw positive, N·mm."""
        return float(self.lead @ self._left_over(time, y)[1])

    def at_rest(self, time: float, start: FloatArray) -> FloatArray:
        """Return y of balance under the torques of a time, the input held, and the places of parts without mass, shape (m + k,).

        Friction is that of the slips which the rigid motion has at the speed of the input, none where the input stands.
        ConvergenceError where no balance is found.
        """
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
    """Return what LAPACK answers; ConvergenceError where it fails, as for a motion that is not a number."""
    if found[-1] != 0:
        raise ConvergenceError("the motion has become no number: its masses or forces are not finite", [])
    return found
