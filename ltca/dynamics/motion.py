r"""Motion of a drive in time: Lagrange's equations on the contacts' own laws.

Coordinates are :math:`x = B y + g\,s(t)`: s the angle of the input, g the rigid motion of all parts by it, and y what departs
from that. Where the input turns as it is told, B spans the motions that leave it still; where a torque drives it, B spans all.

.. math:: B^T (M\ddot x + h(x, \dot x) + \partial U/\partial x + R + C\dot x - Q) = 0

with inertia forces h (`ltca.dynamics.kinetic_energy`), forces of contacts and supports, friction R
(`ltca.dynamics.contact_forces`), and torques Q at both ends with forces from outside. Parts without mass follow
(`ltca.dynamics.massless`). Damping is that of every vibration about the state of the moment alike, with the ratio ζ: of modes
:math:`\Phi` with frequencies ω under the stiffness K of the contacts that are closed,

.. math:: C = K\Phi\,\mathrm{diag}(2\zeta/\omega^3)\,\Phi^T K ,

which takes energy from changes of the contacts' forces only: none in a free flight, and next to none from a slow motion.

Beside y and its rate the state has the works of input, output, damping and friction, N·mm.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
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
    """Equation of motion of a drive.

    Attributes
    ----------
    kinetic : KineticEnergy
        Of all bodies.
    contacts : ContactForces
        Contacts and supports.
    basis : array, shape (n, m)
        B, mm and rad by mm.
    lead : array, shape (n,)
        g, by rad of the input.
    input_turns, output_turns : array, shape (n,)
        Rows of the rotations of both ends.
    input_motion : callable
        s and its rates at a time, rad.
    output_torque : callable
        Torque on the output at a time, ccw positive, N·mm.
    input_torque : float or None
        Torque that drives the input, ccw positive, N·mm; None where it turns as told.
    damping_ratio : float
        ζ; 0 for none.
    massless : MasslessParts or None
        Motions of parts without mass, which B leaves out.
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

    def _moment(self, time: float, state: FloatArray) -> tuple[FloatArray, FloatArray, Instant | None, FloatArray]:
        """x, its rate, the forces where they are known already, and B with what follows its motions."""
        m, (angle, speed, _) = self.freedoms, self.input_motion(time)
        x, rate = self.basis @ state[:m] + self.lead * angle, self.basis @ state[m : 2 * m] + self.lead * speed
        if self.massless is None:
            return x, rate, None, self.basis
        torque = self.output_torque(time) * self.output_turns

        def respond(there: FloatArray, moving: FloatArray) -> tuple[Instant, FloatArray]:
            now = self.contacts.at(there, moving)
            return now, torque + now.outside

        x, rate, now, slope = self.massless.settle(x, rate, respond)
        return x, rate, now, self.basis + self.massless.columns @ (slope @ self.basis)

    def rates(self, time: float, state: FloatArray) -> FloatArray:
        """Return the rate of a state, shape (2m + 4,)."""
        return self.solved(time, state).state_rate

    def solved(self, time: float, state: FloatArray) -> Moment:
        """Return the rate of a state, and what goes with it."""
        m, basis = self.freedoms, self.basis
        x, rate, known_forces, followed = self._moment(time, state)
        mass, inertia = self.kinetic.at(x, rate)
        now = self.contacts.at(x, rate) if known_forces is None else known_forces
        projected = basis.T @ mass @ basis
        damped = self._damping(now.stiffness, projected, followed) @ rate if self.damping_ratio else np.zeros(x.size)
        loaded = self.output_torque(time) * self.output_turns + now.outside
        told = self.input_motion(time)[2]
        inner = now.force + now.friction + damped + inertia
        outer = loaded if self.input_torque is None else loaded + self.input_torque * self.input_turns
        known = outer - inner - mass @ self.lead * told
        faster = _checked(dposv(projected, basis.T @ known))[
            1
        ]  # LAPACK itself: a system of five takes numpy ten times as long
        if self.input_torque is None:
            # By virtual work on the rigid motion; the input's own angle is s.
            torque = float(self.lead @ (mass @ (basis @ faster + self.lead * told) + inner - loaded))
        else:
            torque = self.input_torque
        found = np.empty_like(state)
        found[:m], found[m : 2 * m] = state[m : 2 * m], faster
        found[2 * m] = torque * (self.input_turns @ rate)
        found[2 * m + 1] = -(loaded @ rate)
        found[2 * m + 2] = damped @ rate
        found[2 * m + 3] = now.friction @ rate
        return Moment(found, torque, now, x, rate)

    def _damping(self, stiffness: FloatArray, mass: FloatArray, basis: FloatArray) -> FloatArray:
        """C at the state of the moment, shape (n, n), of motions that parts without mass follow."""
        pressed = stiffness @ basis
        square, shapes = _checked(dsygv(basis.T @ pressed, mass))[:2]
        felt = square > SOFTEST**2 * square[-1]
        on_modes = pressed @ shapes[:, felt]
        return np.asarray((on_modes * (2.0 * self.damping_ratio / square[felt] ** 1.5)) @ on_modes.T)

    def input_torque_at_rest(self, time: float, y: FloatArray) -> float:
        """Return the torque at the input that balances a time in a state of `at_rest`, ccw positive, N·mm."""
        angle, speed, _ = self.input_motion(time)
        now = self.contacts.at(self.whole @ y + self.lead * angle, self.lead * speed)
        loaded = self.output_torque(time) * self.output_turns + now.outside
        return float(self.lead @ (now.force + now.friction - loaded))

    def at_rest(self, time: float, start: FloatArray) -> FloatArray:
        """Return y of balance under the torques of a time, the input held, and the places of parts without mass, shape (m + k,).

        Friction is that of the slips which the rigid motion has at the speed of the input, none where the input stands.

        Raises
        ------
        ConvergenceError
            Where it is not found.
        """
        y, (angle, speed, _), whole = start.copy(), self.input_motion(time), self.whole
        torque = self.output_torque(time) * self.output_turns

        def left_over(there: FloatArray) -> tuple[FloatArray, Instant]:
            now = self.contacts.at(whole @ there + self.lead * angle, self.lead * speed)
            return np.asarray(whole.T @ (now.force + now.friction - torque - now.outside)), now

        history: list[float] = []
        step: FloatArray = np.zeros(y.size)
        before, halved = np.inf, 0
        for _ in range(REST_STEPS):
            left, now = left_over(y)
            if (size := float(np.linalg.norm(left))) > before and halved < REST_HALVINGS:
                step, halved = 0.5 * step, halved + 1
                y = y + step
                continue
            if len(history) < REST_PLAIN:
                matrix = whole.T @ now.stiffness @ whole
            else:
                aside = REST_ASIDE * np.eye(y.size)
                matrix = np.array([(left_over(y + one)[0] - left) / REST_ASIDE for one in aside]).T
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
