"""Damped Newton iteration for the pose in which a batch of positions balances, to the nearest minimum downhill.

The step is damped (Levenberg–Marquardt) and bounded, and the slope of Π is brought down along it by a bracketed secant: Π falls
in every iteration. Positions with friction, which has no potential, may be balanced by the size of their residual instead.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import FloatArray, join_positions, put_positions, take_positions
from ltca.compliance.response import Response, Start
from ltca.drive.least_torque import ROUND_OFF, ROUND_OFF_BOUND
from ltca.equilibrium.reducer import Evaluation, Reducer
from ltca.errors import ConvergenceError
from ltca.geometry.coordinates import WHEEL_ANGLE
from ltca.mechanics.contacts import LEFT_WEIGHT

TOLERANCE = 1e-9
"""Largest residual accepted, as a part of the load T/(e z_P)."""
STEP_BOUND = 1e-3
"""Largest first step of a mode by e z_P: long against elastic approaches, short against the radius of a flank."""
MAX_LINE_SEARCH_STEPS = 12
CREEPING_RESIDUAL = 0.01
"""Residual, relative to the load, below which an unbalanced position is followed along its softest mode."""
MAX_VALLEY_STEPS, MAX_WALL_STEPS = 60, 6
"""Steps along a soft mode, and steps of the other modes after each."""
MAX_REDUCTION_STEPS = 60
"""Trial steps of the iteration that reduces the residual of a position with friction."""
RESTART_PERTURBATIONS = (0.0, *(0.02,) * 4, *(0.1,) * 4, *(0.4,) * 4)
"""Relative perturbations of the pose tried at restarts: friction may catch a disc that carries next to nothing."""
HOLDING, HELD = 0.1, 1e-9
"""Residuals, relative to the load, between which the moment that holds the wheel follows the contacts."""
RIDGE = 1e-9
"""Largest negative stiffness of a mode at a minimum by the stiffest: that of round-off."""
FIRST_VALLEY_STEP = 1e-5
"""First step along a soft mode relative to the smallest pin radius; each step is at most four times the last."""
LEAST_PIVOT_RATIO = 1e-6
"""Least pivot ratio accepted by the elimination: with smaller ones the modes of the tangent are computed."""
LINE_SEARCH_SLOPE_RATIO = 0.3
"""Largest ratio of the slopes of Π at the end and at the beginning of an accepted step."""


Holding = Callable[[NDArray[np.intp], FloatArray, FloatArray, Any], FloatArray]
"""Moments on the wheel by numbers of positions, their poses, present moments and contacts."""


class Search:
    """Damped Newton iteration of a batch; positions leave it as they balance.

    `lever`, mm, turns the residual into forces, `load` is the moment by the lever of the wheel, N. `pose` and, by `holding`,
    `moment` are changed in place. ``history`` has the residuals of each iteration, N, ``balanced`` the contacts of positions
    that balance, group by group; ``slipped`` are those whose wheel or disc had turned by more than half a pin pitch.
    """

    def __init__(
        self,
        model: Reducer,
        angle: FloatArray,
        moment: FloatArray,
        lever: FloatArray,
        load: FloatArray,
        pose: FloatArray,
        holding: Holding | None = None,
    ) -> None:
        self.model, self.angle, self.lever, self.load = model, angle, lever, load
        self.moment, self.holding = moment, holding
        self.pose = pose
        self.place = model.discs[0].geometry.placement
        self.smallest_pin = float(np.min(self.place.wheel_pin_radii))
        self.symmetric = model.symmetric
        self.half_pitch = np.pi / self.place.reduction_ratio
        self.rotations = model.coordinates.rotations
        self.history: list[FloatArray] = []
        self.residual = np.full(angle.size, np.inf)
        self.iterations = np.zeros(angle.size, dtype=np.intp)
        self.slipped = np.zeros(angle.size, dtype=bool)
        self.balanced: list[tuple[NDArray[np.intp], Response]] = []

    def levers(self, rows: NDArray[np.intp]) -> FloatArray:
        """Return the lever arms of some positions: one row for all where the drives are the same."""
        return self.lever[rows] if self.lever.ndim > 1 else self.lever

    def evaluate(
        self,
        rows: NDArray[np.intp],
        pose: FloatArray,
        start: Start | None,
        *,
        roughly: bool = False,
        everything: bool = False,
    ) -> Evaluation:
        """Return the contacts of some positions at poses; `roughly` and `everything` as for `Reducer.evaluate`."""
        model = self.model if rows.size == self.angle.size else self.model.take(rows)
        return model.evaluate(self.angle[rows], pose, start, roughly=roughly, everything=everything)

    def scaled(self, rows: NDArray[np.intp], response: Response | Evaluation) -> tuple[FloatArray, FloatArray]:
        """Return the scaled gradient, with the moment on the wheel (Eq. 89), and the scaled tangent: forces and lengths only."""
        lever = self.levers(rows)
        gradient = response.force.copy()
        gradient[:, WHEEL_ANGLE] -= self.moment[rows]
        gradient /= lever
        if np.isnan(gradient).any():
            row = rows[np.isnan(gradient).any(axis=1)][0]
            raise ConvergenceError(f"contact forces at crank angle {self.angle[row]:.6g} rad are no numbers")
        return gradient, response.tangent / (lever[..., :, None] * lever[..., None, :])

    def iterate(
        self,
        most: int,
        rows: NDArray[np.intp] | None = None,
        begin: Start | None = None,
        response: Response | Evaluation | None = None,
    ) -> NDArray[np.intp]:
        """Move positions towards balance, in place of the paper's iteration (Eq. 90–93); return those that do not balance.

        `rows` are ascending, all by default; `begin` has their inner unknowns and `response` their contacts, where known.
        """
        active = asked = np.arange(self.angle.size) if rows is None else rows
        first_bound = STEP_BOUND * float(np.max(self.lever[..., WHEEL_ANGLE]))
        damping, bound = np.full(self.angle.size, 1e-6), np.full(self.angle.size, first_bound)
        if response is None:
            response = self.evaluate(active, self.pose[active], begin, roughly=True)
        gradient, tangent = self.scaled(active, response)
        residual, held = self.residual, np.zeros(self.angle.size, dtype=bool)
        residual[active] = _left_over(gradient, response)
        for _ in range(most):
            self.history.append(residual.copy())
            # A residual that is no number does not balance either.
            balanced = residual[active] <= self.accepted(active, response)
            looked_at = np.nonzero(balanced)[0]
            if looked_at.size:
                overlooked = looked_at[take_positions(response, looked_at).overlooks]
                if overlooked.size:
                    mine = active[overlooked]
                    begin = take_positions(response.start, overlooked)
                    again = self.evaluate(mine, self.pose[mine], begin, roughly=True, everything=True)
                    response = put_positions(response, overlooked, again)
                    gradient, tangent = self.scaled(active, response)
                    residual[active] = _left_over(gradient, response)
                    balanced = residual[active] <= self.accepted(active, response)
            going = ~(balanced | self.slipped[active])
            if not going.all():
                self.keep(active, response, balanced & ~self.slipped[active])
                active, response = active[going], take_positions(response, going)
                gradient, tangent = gradient[going], tangent[going]
            if active.size == 0:
                break
            self.iterations[active] += 1
            step, slope = _damped_step(tangent, gradient, damping[active], bound[active], self.symmetric)
            taken, response, gradient, tangent, fraction = self.walk(active, step, slope, response.start)
            self.pose[active] = taken
            if self.holding is not None:
                left = _left_over(gradient, response) / self.load[active]
                near = np.nonzero((left < HOLDING) & ~held[active])[0]
                held[active] = left < HELD
                if near.size:
                    mine = active[near]
                    here = response if near.size == active.size else take_positions(response, near)
                    self.moment[mine] = self.holding(mine, taken[near], self.moment[mine], here)
                    gradient[near], tangent[near] = self.scaled(mine, here)
            self.slipped[active] = np.max(np.abs(taken[:, self.rotations]), axis=1) > self.half_pitch
            residual[active] = _left_over(gradient, response)
            bound[active] *= np.where(fraction == 1.0, 2.0, np.where(fraction < 0.1, 0.5, 1.0))
            bound[active] = bound[active].clip(1e-3 * first_bound, max(first_bound, 0.1 * self.smallest_pin))
            damping[active] *= np.where(fraction > 0.5, 0.1, np.where(fraction < 0.1, 10.0, 1.0))
            damping[active] = damping[active].clip(1e-12, 1e3)
        left = np.zeros(self.angle.size, dtype=bool)
        left[active] = left[asked[self.slipped[asked]]] = True
        return np.nonzero(left)[0]

    def reduce_residual(self, row: int) -> bool:
        """Balance a position with friction by the size of its residual alone; tell whether it does."""
        if self.slipped[row]:
            return False
        random = np.random.default_rng(0)  # the same position is always answered alike
        last = self.pose[row : row + 1].copy()
        for part in RESTART_PERTURBATIONS:
            with suppress(ConvergenceError):  # contacts may be lost on the way
                if self._descend(np.array([row]), row, last * (1.0 + part * random.normal(size=last.shape))):
                    return True
        return False

    def _descend(self, rows: NDArray[np.intp], row: int, pose: FloatArray) -> bool:
        """Levenberg and Marquardt's iteration from a pose."""
        response = self.evaluate(rows, pose, None)
        gradient, tangent = self.scaled(rows, response)
        damping, size = 1e-10, pose.shape[1]
        for _ in range(MAX_REDUCTION_STEPS):
            self.residual[row] = _left_over(gradient, response)[0]
            if self.residual[row] <= self.accepted(rows, response)[0]:
                self.pose[rows] = pose
                self.keep(rows, response, np.ones(1, dtype=bool))
                return True
            self.iterations[row] += 1
            lengths = np.linalg.norm(tangent[0], axis=0)
            lengths = np.where(lengths > 0.0, lengths, 1.0)
            system = np.concatenate((tangent[0] / lengths, np.sqrt(damping) * np.eye(size)))
            step = np.linalg.lstsq(system, np.concatenate((-gradient[0], np.zeros(size))), rcond=None)[0] / lengths
            tried = pose + step[None] / self.levers(rows)
            if np.max(np.abs(tried[:, self.rotations])) > self.half_pitch:
                damping *= 10.0
                continue
            there = self.evaluate(rows, tried, response.start)
            left, slopes = self.scaled(rows, there)
            if np.linalg.norm(left) < np.linalg.norm(gradient):
                pose, response, gradient, tangent, damping = tried, there, left, slopes, max(0.1 * damping, 1e-14)
            else:
                damping *= 10.0
        return False

    def follow_valley(self, row: int) -> bool:
        """Balance a position that creeps along one soft mode; tell whether it does."""
        with suppress(ConvergenceError):  # steps along a valley are long: contacts may be lost on the way
            return self._follow_valley(row)
        return False

    def _follow_valley(self, row: int) -> bool:
        """Follow the softest mode, down to the bottom after every step: straight steps along it climb the walls of Π."""
        rows = np.array([row])
        if self.slipped[row] or not self.residual[row] < CREEPING_RESIDUAL * self.load[row]:
            return False
        lever, pose = self.levers(rows), self.pose[rows].copy()
        before, along, last, response = 0.0, 0.0, np.zeros(pose.shape[1]), self.evaluate(rows, pose, None)
        for _ in range(MAX_VALLEY_STEPS):
            for _ in range(MAX_WALL_STEPS):
                gradient, tangent = self.scaled(rows, response)
                values, modes = np.linalg.eigh(tangent[0])
                soft = modes[:, np.argmin(np.abs(values))]
                soft = soft if soft @ last >= 0.0 else -soft
                self.residual[row] = _left_over(gradient, response)[0]
                if self.residual[row] <= self.accepted(rows, response)[0]:
                    # A ridge balances as well: steps this long may have left the valley.
                    if self.symmetric and values[0] < -RIDGE * values[-1]:
                        return False
                    self.pose[rows] = pose
                    self.keep(rows, response, np.ones(1, dtype=bool))
                    return True
                wall = gradient[0] - (soft @ gradient[0]) * soft
                if np.max(np.abs(wall)) < 0.1 * abs(soft @ gradient[0]):
                    break
                pose = pose - (modes @ ((modes.T @ wall) / np.where(values == 0.0, 1.0, values)))[None] / lever
                response = self.evaluate(rows, pose, response.start)
            self.iterations[row] += 1
            slope = float(soft @ gradient[0])
            change = (slope - before) / along if along else float(np.min(np.abs(values)))
            step = -slope / change if change > 0.0 else -np.sign(slope) * 2.0 * abs(along)
            most = 4.0 * abs(along) if along else FIRST_VALLEY_STEP * self.smallest_pin
            along, before, last = float(np.clip(step, -most, most)), slope, soft
            pose = pose + along * soft[None] / lever
            response = self.evaluate(rows, pose, response.start)
        return False

    def keep(self, rows: NDArray[np.intp], response: Response | Evaluation, balanced: NDArray[np.bool_]) -> None:
        """Keep the contacts of those positions that balance."""
        kept = response.kept
        if balanced.all():
            self.balanced.append((rows, kept))
        elif balanced.any():
            self.balanced.append((rows[balanced], take_positions(kept, balanced)))

    def contacts(self) -> tuple[NDArray[np.intp], Response]:
        """Return the positions that balance so far, ascending, and their contacts."""
        if len(self.balanced) > 1:
            rows = np.concatenate([rows for rows, _ in self.balanced])
            order = np.argsort(rows)
            self.balanced = [(rows[order], take_positions(join_positions([part for _, part in self.balanced]), order))]
        return self.balanced[0]

    def round_off(self, rows: NDArray[np.intp], response: Response | Evaluation) -> FloatArray:
        """Return the round-off of the residual by that of approaches, N; supports know displacements alone and add none."""
        size = float(np.max(np.abs(self.place.wheel_pin_centres)))
        stiffness = response.contact_stiffness / self.levers(rows) ** 2
        return np.asarray(ROUND_OFF * size * np.abs(stiffness.sum(axis=1)))

    def accepted(self, rows: NDArray[np.intp], response: Response | Evaluation) -> FloatArray:
        """Return the largest residual that counts as balance, N."""
        round_off, load = self.round_off(rows, response), self.load[rows]
        return np.asarray(np.maximum(TOLERANCE * load, np.minimum(round_off, ROUND_OFF_BOUND * load)))

    def walk(
        self, rows: NDArray[np.intp], step: FloatArray, slope: FloatArray, start: Start
    ) -> tuple[FloatArray, Evaluation, FloatArray, FloatArray, FloatArray]:
        """Walk along the steps until Π stops falling: poses, contacts, gradients, tangents there, parts of the steps."""
        low, high = np.zeros(rows.size), np.ones(rows.size)
        low_slope, high_slope = slope.copy(), np.zeros(rows.size)
        fraction = np.ones(rows.size)
        step_pose = step / self.levers(rows)
        pose = self.pose[rows] + step_pose
        response = self.evaluate(rows, pose, start, roughly=True)
        gradient, tangent = self.scaled(rows, response)
        # Longer than the minimum: neither round-off of the slope nor what contacts leave open must send a step back.
        round_off, longest = 1e-3 * TOLERANCE * self.load[rows], np.max(np.abs(step), axis=1)
        end = np.einsum("bi,bi->b", gradient, step)
        for _ in range(MAX_LINE_SEARCH_STEPS):
            far = end > LINE_SEARCH_SLOPE_RATIO * np.abs(slope) + (round_off + response.left / LEFT_WEIGHT) * longest
            if not np.any(far):
                break
            high[far], high_slope[far] = fraction[far], end[far]
            back = np.nonzero(far)[0]
            width = high[back] - low[back]
            rise = high_slope[back] - low_slope[back]
            # With friction a direction may lead uphill from the start, as steeply as at its end.
            place = np.divide(-low_slope[back], rise, out=np.zeros(back.size), where=rise != 0.0)
            fraction[back] = low[back] + width * place.clip(0.05, 0.9)
            pose = pose.copy()  # contacts know the poses at which they were found
            pose[back] = self.pose[rows[back]] + fraction[back, None] * step_pose[back]
            again = self.evaluate(rows[back], pose[back], take_positions(response.start, back), roughly=True)
            response = put_positions(response, back, again)
            gradient[back], tangent[back] = self.scaled(rows[back], again)
            end[back] = np.einsum("bi,bi->b", gradient[back], step[back])
            near = back[end[back] < 0.0]
            low[near], low_slope[near] = fraction[near], end[near]
        return pose, response, gradient, tangent, fraction


def _left_over(gradient: FloatArray, response: Response | Evaluation) -> FloatArray:
    """Largest unbalanced force of every position, N, or the uncertainty of contacts and pins that have not settled."""
    return np.asarray(np.maximum(np.max(np.abs(gradient), axis=1), response.left))


def _damped_step(
    tangent: FloatArray, gradient: FloatArray, damping: FloatArray, bound: FloatArray, symmetric: bool = True
) -> tuple[FloatArray, FloatArray]:
    """Return the step of every mode, −g/(|λ| + μ tr(H)/n) within the bound, and the slope g·step.

    With |λ| a mode of negative stiffness is left downhill; each mode has its own bound, so that a disc that floats in one
    direction still corrects the others. Where H is not symmetric the modes are those of its symmetric part.
    """
    stiffness = np.abs(np.trace(tangent, axis1=1, axis2=2)) / tangent.shape[1]
    # Nothing touches: any positive number gives the direction of the load, the bound gives the length.
    stiffness = np.where(stiffness > 0.0, stiffness, 1.0)
    floor = np.maximum(damping, 1e-15) * stiffness
    step, stiff = _stiff_step(tangent, gradient, floor)
    others = np.nonzero(~(stiff & (np.einsum("bi,bi->b", step, step) <= bound**2)))[0]
    if others.size:
        part = tangent[others]
        values, modes = np.linalg.eigh(part if symmetric else 0.5 * (part + part.swapaxes(1, 2)))
        along, most = np.einsum("bij,bi->bj", modes, gradient[others]), bound[others, None]
        lengths = np.clip(-along / (np.abs(values) + floor[others, None]), -most, most)
        step[others] = np.einsum("bij,bj->bi", modes, lengths)
    return step, np.einsum("bi,bi->b", gradient, step)


def _stiff_step(tangent: FloatArray, gradient: FloatArray, floor: FloatArray) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Return −(H + μ)⁻¹g by Gauss's elimination of all positions at once, and where H + μ is safely positive definite."""
    size = gradient.shape[1]
    matrix, right = tangent.transpose(1, 2, 0).copy(), -gradient.T
    places = np.arange(size)
    # Pivots are measured without μ, which must not make a soft mode stiff.
    least = LEAST_PIVOT_RATIO * matrix[places, places]
    matrix[places, places] += floor
    stiff = np.ones(gradient.shape[0], dtype=bool)
    for place in range(size):
        stiff &= matrix[place, place] > least[place] + floor
        pivot = np.where(stiff, matrix[place, place], 1.0)
        factors = np.where(stiff, matrix[place + 1 :, place] / pivot, 0.0)  # soft ones are left as they are
        matrix[place + 1 :, place + 1 :] -= factors[:, None] * matrix[place, place + 1 :]
        right[place + 1 :] -= factors * right[place]
        right[place] /= pivot
        matrix[place, place + 1 :] /= pivot
    right = np.where(stiff, right, 0.0)
    for place in range(size - 2, -1, -1):
        right[place] -= (matrix[place, place + 1 :] * right[place + 1 :]).sum(axis=0)
    return np.ascontiguousarray(right.T), stiff
