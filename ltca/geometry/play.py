r"""How far the wheel can turn while no body gives: the play of all clearances together, disc floating.

The farthest wheel angle at which no pair interferes is a programme with curved bounds. A corner of them alone would be
a linear one; but the pins that lead the disc in holes without clearance hold it by arcs, and the farthest pose then
lies where an arc and the turning have one tangent: no sequence of corners ends there. It is found by augmented
Lagrangians instead, which is mechanics: a unit load turns the wheel against pairs that yield on springs,

.. math:: F_i = \max(0, \lambda_i + k \delta_i),

the disc moves until everything balances (Newton's method with the curvature of the gaps), and the loads found become
the :math:`\lambda_i` with which the pairs carry without yielding. Each round divides the interference by some hundreds;
where it does not the springs get stiffer. It is what the loaded analysis tends to as torque goes to zero.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ltca.errors import ConvergenceError
from ltca.geometry.coordinates import DISC_ROTATION, WHEEL_ANGLE
from ltca.geometry.pair_motion import FlankMotion, PairMotion, RollerRays
from ltca.geometry.pairs import ContactGeometry

FloatArray = NDArray[np.float64]

FIRST_YIELD = 1e-4
"""What a unit load presses a pair together in the first round, as a part of e z_P."""
TOUCHING = 1e-12
"""Interference that counts as touching, as a part of the pin circle radius: some thousand times the round-off."""
STEP_BOUND = 2e-3
"""Largest step of a mode as a part of e z_P."""
ROUNDS, ITERATIONS, LINE_TRIALS = 40, 200, 12
STUCK = 6
"""Rounds without gain, each on springs ten times stiffer, after which parts interfere for good."""
SLOPE_LEFT = 0.3
"""A step is short enough when the slope at its end is at most this part of the slope at its beginning."""


def rigid_poses(geometry: ContactGeometry, crank_angle: FloatArray, sense: int) -> FloatArray:
    """Return the poses in which the wheel is turned as far as rigid bodies allow.

    Parameters
    ----------
    geometry : ContactGeometry
        One drive.
    crank_angle : array, shape (positions,)
        Held φ_C, rad.
    sense : {+1, −1}
        Counter-clockwise or clockwise; −1 is where the load of a crank driving counter-clockwise turns it.

    Returns
    -------
    array, shape (positions, 4)
        q of `ltca.geometry.pairs`.

    Raises
    ------
    ConvergenceError
        When parts interfere in every pose (a drive that cannot be put together without force), or nothing stops the
        wheel within half a pin pitch.
    """
    return _Programme(geometry, np.atleast_1d(np.asarray(crank_angle, dtype=float)), sense).solve()


def rigid_play(geometry: ContactGeometry, crank_angle: FloatArray) -> FloatArray:
    """Return the play of the wheel with the crank held and the disc floating, rad, shape (positions,)."""
    forward = rigid_poses(geometry, crank_angle, 1)[:, WHEEL_ANGLE]
    return forward - rigid_poses(geometry, crank_angle, -1)[:, WHEEL_ANGLE]


class _Pairs(NamedTuple):
    """All pairs at poses: pins, holes, rollers on the inner race against the bore."""

    flank: FlankMotion
    holes: PairMotion
    length: FloatArray
    across: FloatArray
    arm: FloatArray
    approach: FloatArray
    gradient: FloatArray

    @classmethod
    def at(cls, geometry: ContactGeometry, rays: RollerRays, angle: FloatArray, pose: FloatArray) -> _Pairs:
        flank, holes = geometry.flank(angle, pose), geometry.holes(angle, pose)
        # A roller on the inner race presses on the bore with |s n − d| less the bore play.
        bores, rollers = geometry.bores(angle, pose), rays.direction.shape[1]
        arm = rays.outermost * rays.direction - bores.each(bores.displacement, rollers)
        length = np.abs(arm)
        outward = arm / length
        moved = outward.conjugate()[..., None] * bores.each(bores.gradient, rollers)
        return cls(
            flank=flank,
            holes=holes,
            length=length,
            across=moved.imag,
            arm=(outward.conjugate() * bores.each(bores.arm, rollers)).real,
            approach=np.concatenate([flank.approach, holes.approach, length - rays.bore_play], axis=1),
            gradient=np.concatenate([flank.gradient, holes.gradient, -moved.real], axis=1),
        )

    def bend(self, load: FloatArray) -> FloatArray:
        """Σ F ∂²δ/∂q²."""
        pins, holes = self.flank.approach.shape[1], self.holes.approach.shape[1]
        total = self.flank.bend(load[:, :pins]) + self.holes.bend(load[:, pins : pins + holes])
        rollers = load[:, pins + holes :]
        total += np.einsum("bi,bij,bik->bjk", rollers / self.length, self.across, self.across)
        total[:, DISC_ROTATION, DISC_ROTATION] += (rollers * self.arm).sum(axis=1)
        return total


class _Programme:
    """The farthest wheel angle of a batch of positions of one drive."""

    def __init__(self, geometry: ContactGeometry, angle: FloatArray, sense: int) -> None:
        place = geometry.placement
        self.geometry, self.angle, self.sense = geometry, angle, sense
        self.rays = geometry.rollers(angle)
        reach = float(place.mean_eccentricity[0]) * place.reduction_ratio
        self.lever = np.array([1.0, 1.0, reach, reach])
        self.touching = TOUCHING * float(np.max(np.abs(place.wheel_pin_centres)))
        self.pitch = np.pi / place.reduction_ratio
        self.stiffness = np.full(angle.size, 1.0 / (FIRST_YIELD * reach))
        self.held = np.zeros((angle.size, place.wheel_pin_radii.size + place.hole_radii.size + place.roller_radii.size))
        self.pose = np.zeros((angle.size, 4))

    def solve(self) -> FloatArray:
        history: list[float] = []
        before, stuck = np.full(self.angle.size, np.inf), np.zeros(self.angle.size, dtype=np.intp)
        for _ in range(ROUNDS):
            pairs, load = self.balance()
            # What a pair still yields under its load, and what others interfere.
            yielding = np.max(np.maximum(pairs.approach, np.abs(load - self.held) / self.stiffness[:, None]), axis=1)
            history.append(float(np.max(yielding)))
            if history[-1] <= self.touching:
                return self.pose
            going = yielding > self.touching
            stuck = np.where(going & (yielding > 0.9 * before), stuck + 1, 0)
            if np.max(stuck) >= STUCK:
                break
            self.held = np.where(going[:, None], load, self.held)
            self.stiffness = np.where(going & (yielding > 0.1 * before), 10.0 * self.stiffness, self.stiffness)
            before = yielding
        worst = int(np.argmax(stuck))
        raise ConvergenceError(
            f"parts interfere in every rigid pose at crank angle {self.angle[worst]:.6g} rad, by {yielding[worst]:.3g} mm "
            "where springs between them balance; interference by rounds in mm",
            history,
        )

    def evaluate(self, pose: FloatArray) -> tuple[_Pairs, FloatArray, FloatArray]:
        """Return the pairs, their loads and the slope of the potential by scaled coordinates."""
        pairs = _Pairs.at(self.geometry, self.rays, self.angle, pose)
        load = np.maximum(self.held + self.stiffness[:, None] * pairs.approach, 0.0)
        slope = np.einsum("bi,bij->bj", load, pairs.gradient) / self.lever
        slope[:, WHEEL_ANGLE] -= self.sense
        return pairs, load, slope

    def balance(self) -> tuple[_Pairs, FloatArray]:
        """Move every position to the minimum of its potential."""
        bound = np.full(self.angle.size, STEP_BOUND * self.lever[WHEEL_ANGLE])
        pairs, load, slope = self.evaluate(self.pose)
        history: list[float] = []
        for _ in range(ITERATIONS):
            # The load is one; round-off of the loads, and of the approaches times the springs.
            accepted = np.maximum(1e-10 + 1e-13 * np.max(load, axis=1), 1e-3 * self.touching * self.stiffness)
            residual = np.max(np.abs(slope), axis=1)
            history.append(float(np.max(residual)))
            if np.all(residual <= accepted):
                return pairs, load
            closed = np.where(load > 0.0, self.stiffness[:, None], 0.0)
            tangent = pairs.gradient.swapaxes(1, 2) @ (closed[..., None] * pairs.gradient) + pairs.bend(load)
            tangent /= self.lever[:, None] * self.lever
            step = _bounded_step(tangent, slope, bound)
            step[residual <= accepted] = 0.0
            fraction, pairs, load, slope = self.walk(step, slope)
            bound *= np.where(fraction < 0.1, 0.5, 1.0)
            if np.max(np.abs(self.pose[:, WHEEL_ANGLE])) > self.pitch:
                worst = int(np.argmax(np.abs(self.pose[:, WHEEL_ANGLE])))
                raise ConvergenceError(
                    f"nothing stops the wheel within half a pin pitch at crank angle {self.angle[worst]:.6g} rad",
                    history,
                )
        worst = int(np.argmax(np.max(np.abs(slope), axis=1)))
        raise ConvergenceError(
            f"no rigid pose found at crank angle {self.angle[worst]:.6g} rad, parts still interfere by "
            f"{np.max(pairs.approach[worst]):.3g} mm; unbalanced parts of the load",
            history,
        )

    def walk(self, step: FloatArray, slope: FloatArray) -> tuple[FloatArray, _Pairs, FloatArray, FloatArray]:
        """Walk along the steps until the potential stops falling."""
        start, along = self.pose, np.einsum("bi,bi->b", slope, step)
        low, high, fraction = np.zeros(along.size), np.ones(along.size), np.ones(along.size)
        low_slope = along.copy()
        for _ in range(LINE_TRIALS):
            self.pose = start + fraction[:, None] * step / self.lever
            pairs, load, slope = self.evaluate(self.pose)
            end = np.einsum("bi,bi->b", slope, step)
            far = end > SLOPE_LEFT * np.abs(along) + 1e-13 * np.max(np.abs(step), axis=1)
            if not np.any(far):
                break
            short = ~far & (end < 0.0)
            low, low_slope = np.where(short, fraction, low), np.where(short, end, low_slope)
            high = np.where(far, fraction, high)
            width = np.clip(-low_slope / np.where(far, end - low_slope, 1.0), 0.05, 0.9)
            fraction = np.where(far, low + width * (high - low), fraction)
        return fraction, pairs, load, slope


def _bounded_step(tangent: FloatArray, slope: FloatArray, bound: FloatArray) -> FloatArray:
    """Newton's step of every mode, downhill where its stiffness is negative, within the bound."""
    values, modes = np.linalg.eigh(tangent)
    along = np.einsum("bij,bi->bj", modes, slope)
    largest = np.max(np.abs(values), axis=1)[:, None]
    stiffness = np.abs(values) + np.where(
        largest > 0.0, 1e-12 * largest, 1.0
    )  # where nothing touches the bound decides
    return np.asarray(np.einsum("bij,bj->bi", modes, np.clip(-along / stiffness, -bound[:, None], bound[:, None])))
