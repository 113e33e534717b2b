"""Linear motion on a stiffness that pulses with the crank angle: Hill's equation (``docs/theory/vibrations.md``).

Whole orders below half the positions of a turn are balanced together by GMRES, others answer by the mean stiffness. The
preconditioner solves slow motions (`_PushedMotion`) on a stiffness at which others answer at every position at once (`_Split`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from scipy.linalg import eigh, expm
from scipy.sparse.linalg import LinearOperator, gmres

from ltca.arrays import ComplexArray, FloatArray
from ltca.errors import ConvergenceError

SOLVED = 1e-9
"""Relative residual of a balance, in displacements or as a force."""
DIRECTIONS, CYCLES = 60, 2
"""Limits of GMRES: each strong resonance takes some directions."""
BEYOND = 2.0
"""Eigenfrequency by that of the highest order from which motions answer at every position at once."""
FINER = 2
"""Pushes of slow motions by positions of a turn."""
RESOLVED = 0.9 * FINER
"""Eigenfrequency as above up to which these pushes resolve motions."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PulsatingStiffness:
    """Stiffness at crank angles 2πk/N of a turn, N even, symmetric, N/mm, N and N·mm, shape (N, n, n)."""

    over_turn: FloatArray

    @property
    def mean(self) -> FloatArray:
        """K̄, shape (n, n)."""
        return np.asarray(self.over_turn.mean(axis=0))

    @property
    def orders(self) -> int:
        """Largest order that its positions resolve."""
        return len(self.over_turn) // 2 - 1


@dataclass(frozen=True, slots=True, kw_only=True)
class HillSystem:
    """A vibrating system seen from the crank, M D² Y + C Ẏ + K(φ) Y."""

    mass: FloatArray  # M, t
    damping: FloatArray  # C, N·s/mm
    spin: FloatArray  # J
    loss_factor: float  # η of the mean stiffness, K̄ (1 + iη)
    stiffness: PulsatingStiffness
    basis: FloatArray  # of the free motions, as displacements, shape (n, m)
    steady: FloatArray  # those of them that are free on average of a turn, shape (m, k)
    splits: dict[int, _Split] = field(default_factory=dict, init=False, compare=False, repr=False)

    def compliance(self, speed: float, orders: FloatArray) -> ComplexArray:
        """Return the compliance of the mean stiffness at a speed of the crank, rad/s, shape (orders, m, m), order 0 first."""
        whole = self._moving(speed, orders) + self.basis.T @ self.stiffness.mean @ self.basis
        at_rest = self.steady @ np.linalg.inv(self.steady.T @ whole[0].real @ self.steady) @ self.steady.T
        return np.concatenate((at_rest[None], np.linalg.inv(whole[1:])))

    def _moving(self, speed: float, orders: FloatArray) -> ComplexArray:
        """Inertia, damping and losses by amplitudes of the free motions, shape (orders, m, m)."""
        rate = 1j * speed * orders[:, None, None]
        rates = rate * np.eye(self.mass.shape[0]) + speed * self.spin
        lossy = 1j * self.loss_factor * (rate != 0.0) * self.stiffness.mean
        return np.asarray(self.basis.T @ (self.mass @ rates @ rates + rate * self.damping + lossy) @ self.basis)

    def respond(
        self,
        speed: float,
        orders: FloatArray,
        force: ComplexArray,
        *,
        pulsates: bool = True,
        highest: int | None = None,
    ) -> ComplexArray:
        """Return amplitudes of the motion under those of a force, shape (1 + orders, n): mean, then a of Re a·exp(i·order·φ).

        Whole orders come first, all that `stiffness` resolves; those from `highest` on are cut off.
        """
        compliance = self.compliance(speed, np.concatenate(([0.0], orders)))
        still = np.einsum("oij,oj->oi", compliance, force @ self.basis)
        whole = self.stiffness.orders + 1 if highest is None else highest
        if pulsates and np.any(self.stiffness.over_turn != self.stiffness.over_turn[0]):
            still[: self.stiffness.orders + 1] = 0.0
            still[:whole] = self._balanced(speed, force[:whole] @ self.basis)
        return np.asarray(still @ self.basis.T)

    def _split(self, stiffness: FloatArray, mean: FloatArray, mass: FloatArray, fastest: float) -> _Split:
        """Motions up to an angular frequency and those beside them, the same ones at neighbouring speeds."""
        slow = _slow_motions(mean, mass, fastest)
        if slow.shape[1] not in self.splits:
            self.splits[slow.shape[1]] = _Split.of(stiffness, mass, slow)
        return self.splits[slow.shape[1]]

    def _balanced(self, speed: float, force: ComplexArray) -> ComplexArray:
        """Whole orders of the motion, zero first, over the free motions."""
        samples, (whole, size), basis = self.stiffness.over_turn.shape[0], force.shape, self.basis
        moving = self._moving(speed, np.arange(float(whole)))
        stiffness = basis.T @ self.stiffness.over_turn @ basis
        mean, mass = stiffness.mean(axis=0), basis.T @ self.mass @ basis
        held = self.steady @ self.steady.T
        split, resolved = (self._split(stiffness, mean, mass, part * whole * speed) for part in (BEYOND, RESOLVED))
        on_slow = split.slow.T @ moving @ split.slow + split.condensed.mean(axis=0)
        # At order zero the turning of a whole drive may have no stiffness.
        answers = np.concatenate((np.linalg.pinv(on_slow[:1]), np.linalg.inv(on_slow[1:])))
        slow = resolved.slow
        over_turn = _PushedMotion.over_turn(
            _at_positions(resolved.condensed, FINER * samples),
            slow.T @ mass @ slow,
            slow.T @ basis.T @ (self.damping + 2.0 * speed * self.mass @ self.spin) @ basis @ slow,
            slow.T @ basis.T @ (speed**2 * self.mass @ self.spin @ self.spin) @ basis @ slow,
            self.loss_factor * slow.T @ mean @ slow,
            speed,
        )

        def complex_of(values: FloatArray) -> ComplexArray:
            return values.view(np.complex128).reshape(whole, size)

        def real_of(amplitudes: ComplexArray) -> FloatArray:
            return np.asarray(amplitudes.ravel().view(np.float64), dtype=np.float64)

        def in_time(amplitudes: ComplexArray) -> FloatArray:
            return np.asarray(np.fft.irfft(amplitudes, samples, axis=0))

        def by_orders(values: FloatArray) -> ComplexArray:
            found: ComplexArray = np.fft.rfft(values, axis=0)[:whole]
            found[0] = held @ found[0]
            return found

        def balance(values: FloatArray) -> FloatArray:
            amplitudes = complex_of(values)
            forces = by_orders(_times(stiffness, in_time(amplitudes))) + np.einsum("oij,oj->oi", moving, amplitudes)
            forces[0] = held @ forces[0]
            return real_of(forces)

        def by_mean(pushed: FloatArray) -> FloatArray:
            return in_time(np.einsum("oij,oj->oi", answers, np.fft.rfft(pushed, axis=0)[:whole]))

        def pushed_between(pushed: FloatArray) -> FloatArray:
            return _at_positions(over_turn.answer(_at_positions(pushed, FINER * samples)), samples)

        def by_positions(values: FloatArray) -> FloatArray:
            return real_of(by_orders(split.answer(in_time(complex_of(values)), by_mean)))

        def prepared(values: FloatArray) -> FloatArray:
            found = by_positions(values)
            if not slow.shape[1]:
                return found
            left = in_time(complex_of(values - balance(found)))
            return found + real_of(by_orders(resolved.answer(left, pushed_between)))

        scale = np.concatenate(([samples], np.full(whole - 1, 0.5 * samples)))[:, None]
        right = force * scale
        right[0] = held @ right[0]
        # From the left what is left is measured in displacements, from the right as a force: where a preconditioner is nearly
        # singular the one does not end and the other does. Slow turns, between whose positions fast motions swing many times,
        # are answered at the positions alone.
        of_force, of_displacement, alone = (
            LinearOperator((2 * whole * size,) * 2, matvec=one, dtype=np.float64)
            for one in (balance, prepared, by_positions)
        )
        options = {"rtol": SOLVED, "atol": 0.0, "restart": DIRECTIONS, "maxiter": CYCLES}
        given = real_of(right)
        for preconditioner in (of_displacement, alone):
            found, missed = gmres(of_force, given, M=preconditioner, **options)
            if not missed:
                return np.asarray(complex_of(found) / scale)
        pushed, missed = gmres(of_force @ of_displacement, given, **options)
        if missed:
            raise ConvergenceError(f"no periodic motion found at {speed:.6g} rad/s of the crank", [])
        return np.asarray(complex_of(prepared(pushed)) / scale)


def _at_positions(values: FloatArray, samples: int) -> FloatArray:
    """Values at more positions of a turn, or those at fewer without the orders that they do not resolve."""
    orders = np.fft.rfft(values, axis=0, norm="forward")[: min(samples, len(values)) // 2]
    return np.asarray(np.fft.irfft(orders, samples, axis=0, norm="forward"))


@dataclass(frozen=True, slots=True, kw_only=True)
class _Split:
    """Slow motions a and those beside them, b = K_bb⁻¹ (f_b − K_ba a), without inertia; K_eff = K_aa − K_ab K_bb⁻¹ K_ba."""

    slow: FloatArray  # a, as columns
    motions: FloatArray  # a, then b
    at_once: FloatArray  # K_bb⁻¹ at every position
    across: FloatArray  # K_bb⁻¹ K_ba
    condensed: FloatArray  # K_eff

    @classmethod
    def of(cls, stiffness: FloatArray, mass: FloatArray, slow: FloatArray) -> _Split:
        motions = np.concatenate((slow, _beside(slow, mass)), axis=1)
        count = slow.shape[1]
        parts = motions.T @ stiffness @ motions
        at_once: FloatArray = np.asarray(np.linalg.inv(parts[:, count:, count:]), dtype=np.float64)
        across: FloatArray = at_once @ parts[:, count:, :count]
        condensed = parts[:, :count, :count] - parts[:, :count, count:] @ across
        return cls(slow=slow, motions=motions, at_once=at_once, across=across, condensed=condensed)

    def answer(self, force: FloatArray, slowly: Callable[[FloatArray], FloatArray]) -> FloatArray:
        """Motion under forces at the positions; `slowly` answers those on slow motions."""
        count = self.slow.shape[1]
        turned: FloatArray = force @ self.motions
        moved = slowly(turned[:, :count] - np.einsum("pba,pb->pa", self.across, turned[:, count:]))
        quick = _times(self.at_once, turned[:, count:]) - _times(self.across, moved)
        return np.asarray(np.concatenate((moved, quick), axis=1) @ self.motions.T)


@dataclass(frozen=True, slots=True, kw_only=True)
class _PushedMotion:
    """Motions over a turn that positions push: z_{k+1} = F_k z_k + G_k f_k, a_k = P_k (S z_k − D f_k).

    Between positions they move freely on the mean, F = e^{Ah} (1 − h M⁻¹ ΔK P S); positions are eliminated two by two.
    """

    levels: tuple[FloatArray, ...]  # F of one, two, four … positions, filled up with ones
    closing: FloatArray  # (1 − F of the turn)⁻¹
    push: FloatArray  # G
    direct: FloatArray  # D, of orders that positions do not resolve
    here: FloatArray  # P

    @classmethod
    def over_turn(
        cls,
        stiffness: FloatArray,
        mass: FloatArray,
        damping: FloatArray,
        outward: FloatArray,
        loss: FloatArray,
        speed: float,
    ) -> _PushedMotion:
        """Eliminate the positions of a turn; a loss is taken as the damping of each motion at its own frequency."""
        samples, count, _ = stiffness.shape
        mean = stiffness.mean(axis=0)
        lossy = np.sqrt(np.diag(mass) / np.maximum(np.diag(mean), np.finfo(float).tiny))
        damping = damping + np.sqrt(np.outer(lossy, lossy)) * loss
        inverse, step = np.linalg.inv(mass), 2.0 * np.pi / (samples * speed)
        system = np.block(
            [[np.zeros((count, count)), np.eye(count)], [-inverse @ (mean + outward), -inverse @ damping]]
        )
        onward = expm(system * step)
        pushed = onward[:, count:] @ inverse * step
        # Pushes have every order that looks alike at the positions: what these add to the first is all but the same to all.
        turn = np.exp(2j * np.pi / samples) * np.eye(2 * count)
        own = np.linalg.inv(mean + outward + 1j * speed * damping - speed**2 * mass)
        direct: FloatArray = (np.linalg.solve(turn - onward, pushed)[:count] - own).real
        beside = stiffness - mean
        here = np.linalg.inv(np.eye(count) - direct @ beside)
        factors = np.tile(onward, (1 << (samples - 1).bit_length(), 1, 1))
        factors[:samples, :, :count] -= pushed @ beside @ here
        factors[samples:] = np.eye(2 * count)
        levels = [factors]
        while len(levels[-1]) > 1:
            levels.append(levels[-1][1::2] @ levels[-1][::2])
        return cls(
            levels=tuple(levels[:-1]),
            closing=np.linalg.pinv(np.eye(2 * count) - levels[-1][0]),
            push=pushed @ (np.eye(count) + beside @ here @ direct),
            direct=direct,
            here=here,
        )

    def answer(self, force: FloatArray) -> FloatArray:
        """Periodic motion under forces at the positions, shape (positions, motions)."""
        samples = len(force)
        pushes = np.zeros(self.levels[0].shape[:2])
        pushes[:samples] = _times(self.push, force)
        each = []
        for factors in self.levels:
            each.append(pushes)
            pushes = pushes[1::2] + _times(factors[1::2], pushes[::2])
        state = pushes @ self.closing.T
        for factors, own in zip(self.levels[::-1], each[::-1], strict=True):
            both = np.repeat(state, 2, axis=0)
            both[1::2] = own[::2] + _times(factors[::2], state)
            state = both
        return _times(self.here, state[:samples, : force.shape[1]] - force @ self.direct.T)


def _times(matrices: FloatArray, vectors: FloatArray) -> FloatArray:
    """Product position by position."""
    return np.asarray(np.einsum("...ij,...j->...i", matrices, vectors))


def _slow_motions(stiffness: FloatArray, mass: FloatArray, fastest: float) -> FloatArray:
    """Modes up to an angular frequency, rad/s, as columns of length 1."""
    # A stiffness of a drive that turns freely may be singular: modes by the reciprocal need a shift that changes none of them.
    shift = np.trace(stiffness) / np.trace(mass)
    inverse, shapes = eigh(mass, stiffness + shift * mass)
    order = np.argsort(-inverse)
    count = int(np.count_nonzero(inverse * (shift + fastest**2) >= 1.0))
    found = shapes[:, order[:count]]
    return np.asarray(found / np.linalg.norm(found, axis=0))


def _beside(motions: FloatArray, mass: FloatArray) -> FloatArray:
    """Columns that span what no inertia couples to motions."""
    rows = motions.T @ mass
    return np.asarray(np.linalg.svd(rows / np.linalg.norm(rows, axis=1, keepdims=True))[2][motions.shape[1] :].T)


@dataclass(frozen=True, slots=True, kw_only=True)
class UnstableRange:
    """Speeds, rad/s, of the crank at which an order of the stiffness excites two modes, or one twice, to first order."""

    slowest: float
    fastest: float
    order: int
    modes: tuple[int, int]


def unstable_ranges(
    stiffness: PulsatingStiffness, frequency: FloatArray, shapes: FloatArray, damping_ratio: float, fastest: float
) -> tuple[UnstableRange, ...]:
    r"""Return speeds of the crank up to a fastest one, rad/s, at which parametric resonances grow, ascending.

    Modes, mass-normalised, shape (n, modes), are damped alike. An order o meets two of them (Hsu, J. Appl. Mech. 30 (1963)
    367–372; Nayfeh and Mook, Nonlinear Oscillations, 1979, sec. 5.5) where

    .. math:: |o \dot\varphi - \omega_i - \omega_j| < (\mu_i + \mu_j) \sqrt{g/(\mu_i \mu_j) - 1}, \quad
              g = \frac{|x_i^T K_o x_j|^2}{16\, \omega_i \omega_j}, \quad \mu = \zeta \omega .
    """
    found, damped = [], damping_ratio * frequency
    # K_o of Re K_o·exp(i·o·φ), orders 1, 2, …
    pulses = 2.0 * np.fft.rfft(stiffness.over_turn, axis=0, norm="forward")[1 : stiffness.orders + 1]
    growth = np.abs(shapes.T @ pulses @ shapes) ** 2 / (16.0 * np.multiply.outer(frequency, frequency))
    excess = growth / np.multiply.outer(damped, damped) - 1.0
    for place, first, second in np.argwhere(np.triu(excess > 0.0)).tolist():
        order, middle = place + 1, frequency[first] + frequency[second]
        half = (damped[first] + damped[second]) * np.sqrt(excess[place, first, second])
        slowest, top = float(middle - half) / order, float(middle + half) / order
        if slowest < fastest:
            found.append(UnstableRange(slowest=max(slowest, 0.0), fastest=top, order=order, modes=(first, second)))
    return tuple(sorted(found, key=lambda one: (one.slowest, one.order, one.modes)))
