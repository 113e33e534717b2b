r"""Equilibrium of the floating disc at held crank angles (Eq. 43–44, 70–72, 85–89).

The pose q minimises Π(q) = Σ U_i(δ_i(q)) − T_load · wheel_angle. Its gradient is the residual, its Hessian the
4×4 tangent. Before first contact the disc floats and the tangent is singular, so Newton's step is damped
(Levenberg–Marquardt) and its length bounded; a step is taken when Π does not rise again along it, which the
residual at its end tells.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import cast

import numpy as np
from numpy.typing import NDArray

from ltca.compliance import BatchModel, ComplianceModel, Response, Start
from ltca.errors import ConvergenceError
from ltca.tooth_contact import WHEEL_ANGLE, turn_to_contact

FloatArray = NDArray[np.float64]

TOLERANCE = 1e-9
"""Largest residual accepted, as a part of the load T/(e z_P)."""

ROUND_OFF = float(np.finfo(float).eps)
"""Places are known to this part of the pin circle radius; times the stiffness of the contacts it is the residual
below which none can be told from zero (some 1e-8 N: more than 1e-9 of the load only for torques below 1 N·m)."""

ITERATIONS = 200
SHORTENINGS = 12
"""Of one step, each to between a fiftieth and a half: enough to come from the largest step to a contact of 1e-5 mm."""

STEP_BOUND = 1e-3
"""Largest step as a part of e z_P (0.056 mm in the paper's drive): long against elastic approaches (µm), short
against the radius of a flank (mm), and a part, so that the drive's size does not matter."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Equilibrium:
    """Balanced positions.

    Attributes
    ----------
    crank_angle : array, shape (positions,)
        φ_C, rad.
    wheel_moment : array, shape (positions,)
        External moment on the wheel, N·mm.
    pose : array, shape (positions, 4)
        q of `ltca.pairs`.
    response : Response
        Contacts at that pose.
    residual : array, shape (positions,)
        Largest unbalanced force, moments divided by their lever arms (disc e z_C, wheel e z_P), N.
    iterations : array of int, shape (positions,)
        Newton iterations.
    """

    crank_angle: FloatArray
    wheel_moment: FloatArray
    pose: FloatArray
    response: Response
    residual: FloatArray
    iterations: NDArray[np.intp]


def lever_arms(model: ComplianceModel) -> FloatArray:
    """Return the lengths that turn the residual into forces, mm: 1, 1, e z_C, e z_P; (4,) or (positions, 4)."""
    place = model.geometry.placement
    wheel = place.eccentricity * place.reduction_ratio
    one = np.ones_like(wheel)
    return np.concatenate(np.atleast_1d(one, one, wheel - place.eccentricity, wheel), axis=-1)


def solve_equilibrium(
    model: ComplianceModel,
    crank_angle: FloatArray,
    wheel_moment: FloatArray | float,
    start: FloatArray | None = None,
) -> Equilibrium:
    """Find the pose in which every position of a batch balances.

    Parameters
    ----------
    model : ComplianceModel
        Loads at a pose.
    crank_angle : array, shape (positions,)
        Held crank angles φ_C, rad.
    wheel_moment : float or array, shape (positions,)
        External moment on the wheel, ccw positive, N·mm.
    start : array, shape (positions, 4), optional
        Poses to start from; by default the disc on the inner-race centre and the wheel turned to first contact.

    Returns
    -------
    Equilibrium
        Poses, loads, residuals.

    Raises
    ------
    ConvergenceError
        When a position does not balance; the history holds its residuals in N.
    """
    angle = np.atleast_1d(np.asarray(crank_angle, dtype=float))
    moment = np.broadcast_to(np.asarray(wheel_moment, dtype=float), angle.shape)
    lever = lever_arms(model)
    load = np.abs(moment) / lever[..., 3]
    if start is None:
        start = np.zeros((angle.size, 4))
        sense = np.where(moment < 0.0, -1, 1)
        for value in np.unique(sense):
            rows = sense == value
            # Parts far off their place may interfere at every wheel angle: the search then starts from none.
            geometry = model.geometry.take(rows)
            start[rows, WHEEL_ANGLE] = turn_to_contact(geometry, angle[rows], WHEEL_ANGLE, int(value))[0]
    search = _Search(model, angle, moment, lever, load, np.array(start, dtype=float))
    return search.run()


class _Search:
    """Damped Newton iteration of a batch; positions leave it as they balance."""

    def __init__(
        self,
        model: ComplianceModel,
        angle: FloatArray,
        moment: FloatArray,
        lever: FloatArray,
        load: FloatArray,
        pose: FloatArray,
    ) -> None:
        self.model, self.angle, self.moment, self.lever, self.load = model, angle, moment, lever, load
        self.pose = pose
        self.batch = model.geometry.placement.is_batch
        self.history: list[FloatArray] = []

    def evaluate(
        self, rows: NDArray[np.intp], pose: FloatArray, start: Start | None
    ) -> tuple[Response, FloatArray, FloatArray]:
        """Return the response, the scaled gradient and the scaled tangent (forces and lengths only)."""
        whole = not self.batch or rows.size == self.angle.size
        lever = self.lever if whole else self.lever[rows]
        model = self.model if whole else cast(BatchModel, self.model).take(rows)
        response = model.respond(self.angle[rows], pose, start)
        gradient = response.force.copy()
        gradient[:, 3] -= self.moment[rows]
        gradient /= lever
        tangent = response.tangent / (lever[..., :, None] * lever[..., None, :])
        return response, gradient, tangent

    def run(self) -> Equilibrium:
        count = self.angle.size
        iterations = np.zeros(count, dtype=np.intp)
        active = np.arange(count)
        damping = np.full(count, 1e-6)
        response, gradient, tangent = self.evaluate(active, self.pose, None)
        start = known = Start.after(response)
        residual = np.max(np.abs(gradient), axis=1)
        reach = float(np.max(np.abs(self.model.geometry.placement.wheel_pin_centres)))
        for _ in range(ITERATIONS):
            self.history.append(residual.copy())
            noise = ROUND_OFF * reach * np.trace(tangent, axis1=1, axis2=2)
            # A residual that is no number does not balance either.
            going = ~(residual[active] <= np.maximum(TOLERANCE * self.load[active], noise))
            active, start = active[going], start.take(going)
            gradient, tangent = gradient[going], tangent[going]
            if active.size == 0:
                return self.finish(iterations, known)
            iterations[active] += 1
            lever = self.lever[active] if self.batch else self.lever
            step, slope = _damped_step(tangent, gradient, damping[active], STEP_BOUND * lever[..., 3])
            trial = self.pose[active] + step / lever
            response, new_gradient, new_tangent = self.evaluate(active, trial, start)
            # The slope of Π at the end of a step: where it has risen as steeply as it fell, Π may be higher than
            # before, and the step is shortened by the secant until it has not.
            end_slope = np.einsum("bi,bi->b", new_gradient, step)
            overshoot = end_slope > 0.9 * np.abs(slope)
            moved = ~overshoot
            damping[active] = np.where(overshoot, damping[active] * 10.0, damping[active] * 0.1).clip(1e-12, 1e3)
            back = np.flatnonzero(overshoot)
            fraction = np.ones(active.size)
            for _ in range(SHORTENINGS):
                if back.size == 0:
                    break
                fraction[back] *= np.clip(-slope[back] / (end_slope - slope)[back], 0.02, 0.5)
                trial[back] = self.pose[active[back]] + fraction[back, None] * (step / lever)[back]
                _, new_gradient[back], new_tangent[back] = self.evaluate(active[back], trial[back], start.take(back))
                end_slope[back] = np.einsum("bi,bi->b", new_gradient[back], step[back])
                back = back[end_slope[back] > 0.9 * np.abs(slope[back])]
            new_residual = np.max(np.abs(new_gradient), axis=1)
            self.pose[active] = trial
            residual[active] = new_residual
            gradient, tangent = new_gradient, new_tangent
            start = start.replaced(moved, Start.after(response).take(moved))
            known = known.replaced(active, start)
        worst = int(np.argmax(residual / self.load))
        raise ConvergenceError(
            f"no equilibrium at crank angle {self.angle[worst]:.6g} rad (position {worst} of {count}, "
            f"{active.size} unbalanced) after {ITERATIONS} iterations; residual in N against a load of "
            f"{self.load[worst]:.4g} N",
            [float(values[worst]) for values in self.history],
        )

    def finish(self, iterations: NDArray[np.intp], start: Start) -> Equilibrium:
        response, gradient, _ = self.evaluate(np.arange(self.angle.size), self.pose, start)
        return Equilibrium(
            crank_angle=self.angle,
            wheel_moment=np.array(self.moment),
            pose=self.pose,
            response=response,
            residual=np.max(np.abs(gradient), axis=1),
            iterations=iterations,
        )


def _damped_step(
    tangent: FloatArray, gradient: FloatArray, damping: FloatArray, bound: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return −(H + μ tr(H)/4)⁻¹ g, its length bounded, and the slope g·step."""
    stiffness = np.trace(tangent, axis1=1, axis2=2) / 4.0
    # Nothing touches: any positive number gives the direction of the load, the bound gives the length.
    stiffness = np.where(stiffness > 0.0, stiffness, 1.0)
    damped = tangent + (damping * stiffness)[:, None, None] * np.eye(4)
    step = -np.linalg.solve(damped, gradient[..., None])[..., 0]
    uphill = np.einsum("bi,bi->b", gradient, step) >= 0.0
    if np.any(uphill):  # an indefinite tangent (strong geometric part): steepest descent instead
        step[uphill] = -gradient[uphill] / stiffness[uphill, None]
    length = np.max(np.abs(step), axis=1)
    step *= np.minimum(1.0, bound / np.maximum(length, 1e-300))[:, None]
    return np.asarray(step), np.asarray(np.einsum("bi,bi->b", gradient, step))
