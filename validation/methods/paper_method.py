"""The iteration of the paper: wheel held, crank leads, Newton with finite-difference tangents (Eq. 43–46, 90–93).

The wheel is held at φ_P; the unknowns are the displacements δ_r, δ_t of the disc centre from its ideal place, the
rotation δ_φ of the disc and the lead δ_φC of the crank. The residual is that of `ltca.equilibrium.balance`, on any
compliance model. Mapped back: the actual crank angle is u φ_P + δ_φC and the wheel deviates from its ideal place
there by −δ_φC/u. To give the answer at a requested actual crank angle the held φ_P is corrected from outside.

Newton's step is taken in full, as the paper takes it: nothing is damped, nothing is bounded, so the iteration
may fail, above all where a body floats free of contact and the tangent is singular.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import FloatArray, take_positions
from ltca.compliance.response import Start
from ltca.drive.parts import Drive
from ltca.equilibrium.balance import Equilibrium, lever_arms, solve_equilibrium
from ltca.equilibrium.newton import TOLERANCE
from ltca.equilibrium.output_torque import OutputTorque
from ltca.equilibrium.reducer import Reducer
from ltca.errors import ConvergenceError
from ltca.geometry.coordinates import DISC_ROTATION, WHEEL_ANGLE, disc_displacement

MAX_ITERATIONS = 60
START_TORQUE_RATIO = 0.95
"""Part of the torque whose solution is the starting point: near the answer, but not the answer."""
DIFFERENCE_STEP = 1e-6
"""ε of Eq. 91 and 93, mm (rotations: by their lever arms): small against an approach, large against round-off."""
MAX_CORRECTIONS = 12
CRANK_ANGLE_TOLERANCE = 1e-11
"""Largest difference of the actual crank angle from the requested one, rad: it moves loads by 1e-9 of themselves."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PaperIteration:
    """Result of the iteration of the paper for each position of a batch.

    Attributes
    ----------
    unknowns : array, shape (positions, 4)
        δ_r, δ_t in mm, δ_φ, δ_φC in rad.
    converged : array of bool, shape (positions,)
        Whether the residual fell below `ltca.equilibrium.newton.TOLERANCE` of the load.
    iterations : array of int, shape (positions,)
        Newton steps taken.
    failure : tuple of str
        Why each position failed, empty where it converged.
    history : tuple of tuple of float
        Residuals of each position, N.
    """

    unknowns: FloatArray
    converged: NDArray[np.bool_]
    iterations: NDArray[np.intp]
    failure: tuple[str, ...]
    history: tuple[tuple[float, ...], ...]


def pose_of_lead(model: Reducer, wheel_position: FloatArray, unknowns: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return actual crank angle and pose (`ltca.geometry.pairs`) of the unknowns of the paper (Eq. 45–46).

    `wheel_position` is the held φ_P, rad, shape (positions,); the unknowns are δ_r, δ_t, δ_φ and δ_φC, shape (positions, 4).
    """
    place = model.discs[0].geometry.placement
    ideal = place.reduction_ratio * wheel_position
    lead = unknowns[:, 3]
    turned = np.exp(1j * ideal)
    # e e^{iφ_C} − e e^{i(φ_C + δ)} without the difference of two nearly equal numbers.
    race_shift = place.eccentricity * turned * np.exp(0.5j * lead) * 2j * np.sin(0.5 * lead)
    displacement = (unknowns[:, 0] + 1j * unknowns[:, 1]) * turned - race_shift
    pose = np.stack((displacement.real, displacement.imag, unknowns[:, 2], -lead / place.reduction_ratio), axis=1)
    return ideal + lead, pose


def lead_of_pose(model: Reducer, crank_angle: FloatArray, pose: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return held φ_P and the unknowns of the paper of a pose at an actual crank angle: `pose_of_lead` inverted.

    The lead, −u · wheel angle, is the loaded transmission error at the crank (Eq. 94).
    """
    place = model.discs[0].geometry.placement
    lead = -place.reduction_ratio * pose[:, WHEEL_ANGLE]
    ideal = crank_angle - lead
    race_shift = place.eccentricity * np.exp(0.5j * lead) * 2j * np.sin(0.5 * lead)
    displacement = disc_displacement(pose) * np.exp(-1j * ideal) + race_shift
    unknowns = np.stack((displacement.real, displacement.imag, pose[:, DISC_ROTATION], lead), axis=1)
    return ideal / place.reduction_ratio, unknowns


def iterate_held_wheel(
    model: Reducer, wheel_position: FloatArray, wheel_moment: FloatArray, unknowns: FloatArray
) -> PaperIteration:
    """Iterate Eq. 90–93 at held wheel from given guesses; failures are part of the result, not raised.

    `wheel_position` is the held φ_P, rad, `wheel_moment` in N·mm, both of shape (positions,); the guesses are δ_r, δ_t, δ_φ
    and δ_φC, shape (positions, 4).
    """
    try:
        return _iterate(model, wheel_position, wheel_moment, unknowns)
    except (ConvergenceError, np.linalg.LinAlgError) as error:
        if wheel_position.size > 1:  # find out which position it was
            half = wheel_position.size // 2
            parts = [
                iterate_held_wheel(model, wheel_position[rows], wheel_moment[rows], unknowns[rows])
                for rows in (slice(None, half), slice(half, None))
            ]
            return PaperIteration(
                unknowns=np.concatenate([part.unknowns for part in parts]),
                converged=np.concatenate([part.converged for part in parts]),
                iterations=np.concatenate([part.iterations for part in parts]),
                failure=sum((part.failure for part in parts), ()),
                history=sum((part.history for part in parts), ()),
            )
        singular = isinstance(error, np.linalg.LinAlgError)
        history = getattr(error, "history", ())
        return PaperIteration(
            unknowns=unknowns.copy(),
            converged=np.zeros(1, dtype=bool),
            iterations=np.zeros(1, dtype=np.intp),
            failure=("singular tangent (a body floats)" if singular else "contact point not found",),
            history=(tuple(history),),
        )


def _iterate(
    model: Reducer, wheel_position: FloatArray, wheel_moment: FloatArray, unknowns: FloatArray
) -> PaperIteration:
    lever = lever_arms(model)
    reach = float(model.discs[0].geometry.placement.mean_eccentricity[0])
    load = np.abs(wheel_moment) / lever[WHEEL_ANGLE]
    guess = np.array(unknowns, dtype=float)
    count = guess.shape[0]
    iterations = np.zeros(count, dtype=np.intp)
    failure = ["" for _ in range(count)]
    history: list[list[float]] = [[] for _ in range(count)]
    going = np.ones(count, dtype=bool)
    converged = np.zeros(count, dtype=bool)
    # δ_φC moves the disc's race by e δ_φC: its lever is e, not e z_P.
    steps = DIFFERENCE_STEP / np.array([1.0, 1.0, lever[2], reach])
    start: Start | None = None

    def unbalanced(rows: NDArray[np.intp], values: FloatArray, before: Start | None) -> tuple[FloatArray, Start]:
        angle, pose = pose_of_lead(model, wheel_position[rows], values)
        found: Any = model.evaluate(angle, pose, before)
        residual = found.force.copy()
        residual[:, WHEEL_ANGLE] -= wheel_moment[rows]
        return residual / lever, found.start

    for _ in range(MAX_ITERATIONS + 1):
        rows = np.nonzero(going)[0]
        residual, near = unbalanced(rows, guess[rows], start)
        size = np.max(np.abs(residual), axis=1)
        for row, value in zip(rows, size, strict=True):
            history[row].append(float(value))
        done = size <= TOLERANCE * load[rows]
        converged[rows[done]] = True
        going[rows[done]] = False
        rows, residual, before = rows[~done], residual[~done], take_positions(near, ~done)
        if rows.size == 0:
            break
        tangent = np.empty((rows.size, 4, 4))
        for column, step in enumerate(steps):
            moved = guess[rows]
            moved[:, column] += step
            tangent[:, :, column] = (unbalanced(rows, moved, before)[0] - residual) / step
        guess[rows] -= np.linalg.solve(tangent, residual[..., None])[..., 0]
        iterations[rows] += 1
        away = np.max(np.abs(guess[rows]) * np.array([1.0, 1.0, lever[2], reach]), axis=1)
        lost = ~(away < reach)
        for row in rows[lost]:
            failure[row] = "left the drive (a displacement beyond the eccentricity)"
        going[rows[lost]] = False
        start = take_positions(before, ~lost)
        if not np.any(going):
            break
    for row in np.nonzero(~converged)[0]:
        failure[row] = failure[row] or f"no balance after {MAX_ITERATIONS} iterations"
    return PaperIteration(
        unknowns=guess,
        converged=converged,
        iterations=iterations,
        failure=tuple(failure),
        history=tuple(tuple(values) for values in history),
    )


def solve_paper_equilibrium(
    model: Reducer, crank_angle: FloatArray, wheel_moment: FloatArray | float, start: FloatArray
) -> Equilibrium:
    """Balance every position by the iteration of the paper, at requested actual crank angles (rad), from given poses.

    `iterations` of the result counts all Newton steps. ConvergenceError when a position fails; the history holds its
    residuals in N.
    """
    requested = np.atleast_1d(np.asarray(crank_angle, dtype=float))
    moment = np.broadcast_to(np.asarray(wheel_moment, dtype=float), requested.shape)
    ratio = model.discs[0].geometry.placement.reduction_ratio
    wheel, unknowns = lead_of_pose(model, requested, start)
    steps = np.zeros(requested.size, dtype=np.intp)
    off: list[float] = []
    for _ in range(MAX_CORRECTIONS):
        found = iterate_held_wheel(model, wheel, moment, unknowns)
        steps += found.iterations
        if not np.all(found.converged):
            worst = int(np.argmin(found.converged))
            raise ConvergenceError(
                f"the iteration of the paper fails at crank angle {requested[worst]:.6g} rad (position {worst} of "
                f"{requested.size}, {np.count_nonzero(~found.converged)} failed): {found.failure[worst]}; "
                "residual in N",
                found.history[worst],
            )
        unknowns = found.unknowns
        actual, pose = pose_of_lead(model, wheel, unknowns)
        away = requested - actual
        off.append(float(np.max(np.abs(away))))
        if off[-1] <= CRANK_ANGLE_TOLERANCE:
            response = model.respond(requested, pose)
            residual = response.force.copy()
            residual[:, WHEEL_ANGLE] -= moment
            return Equilibrium(
                crank_angle=requested,
                wheel_moment=np.array(moment),
                pose=pose,
                response=response,
                residual=np.max(np.abs(residual / lever_arms(model)), axis=1),
                iterations=steps,
            )
        wheel = wheel + away / ratio
    raise ConvergenceError("the wheel position for the requested crank angle is not found; difference in rad", off)


@dataclass(frozen=True, slots=True, kw_only=True)
class HeldWheel:
    """A drive that is balanced by the paper's iteration, started from the solution on tables at a little less torque.

    Attributes
    ----------
    drive : Drive
        Of one disc.
    tables, model : Reducer
        For the starting point, and the model that is balanced.
    """

    batches: ClassVar[bool] = False

    drive: Drive
    tables: Reducer
    model: Reducer

    def balance(self, crank_angle: FloatArray, torque: float, start: FloatArray | None = None) -> Equilibrium:
        """Return balanced positions at an output torque; DriveError for none."""
        self.drive.require_torque("method paper, which measures forces by it", torque)

        def iterate(angle: FloatArray, moment: FloatArray, begin: FloatArray | None) -> Equilibrium:
            near = solve_equilibrium(self.tables, angle, START_TORQUE_RATIO * moment, begin)
            return solve_paper_equilibrium(self.model, angle, moment, near.pose)

        angle = np.atleast_1d(np.asarray(crank_angle, dtype=float))
        wanted = OutputTorque.of_drives([self.drive], np.full(angle.size, torque))
        return wanted.balanced(self.model, iterate(angle, wanted.mean, start), iterate)


def prepare(drive: Drive, tables: Reducer, model: Reducer) -> HeldWheel:
    """Return the paper's iteration for a drive (entry point ``cyclo.methods``).

    Parameters
    ----------
    drive : Drive
        At its temperatures, without anything that method paper refuses (`ltca.drive.engine_support`).
    tables, model : Reducer
        On tabulated laws, and what is to be balanced.
    """
    return HeldWheel(drive=drive, tables=tables, model=model)
