r"""Equilibrium at a given torque of the output, whichever member is held.

With the pin shaft held the output is the wheel, and its moment is the torque. With the wheel held the output is the pin
shaft: what holds the wheel then follows from the sum of all moments about its axis,
:math:`T_W + T_{in} + T_{out} + w \times G = 0`, with the moment of the input at every position: that of a central crank, of the
sun of a first stage, or none where the shaft itself turns its cranks. A force G on the wheel relative to the shaft, from outside
or by the teeth of a first stage, acts on the shaft at its axis and is held at that of the wheel, which a main bearing that yields
leaves displaced by w. Contacts do not care who is held.

The moment of a crank is that of virtual work, with its cages geared to it. The forces on the crank alone have the moment
:math:`T_C - k M_K` about its axis, with the part k of the crank's angle by which cages turn, and cages are held by the moments
:math:`M_K` (`cage_moments`): of all forces :math:`T_W + \sum T_C + (1 - k) \sum M_K + T_{PS} = 0` with what holds the pin shaft.
The output torque of a drive whose wheel is held differs from the forces' by as much.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import FloatArray, put_positions, take_positions
from ltca.compliance.response import Start
from ltca.drive.parts import Drive
from ltca.equilibrium.balance import Equilibrium, follow_equilibrium, solve_equilibrium
from ltca.equilibrium.reducer import Reducer
from ltca.errors import ConvergenceError

Balance = Callable[[FloatArray, FloatArray, FloatArray | None], Equilibrium]
"""What balances positions: crank angles, moments on the wheel and poses to start from."""

MAX_ITERATIONS = 30
TORQUE_TOLERANCE = 1e-10
"""Unbalanced moment relative to the output torque; the balance of forces leaves more."""


def unbalanced_moment(
    model: Reducer, found: Equilibrium, input_per_crank_moment: FloatArray, output: FloatArray | float
) -> FloatArray:
    """Return what is left of the moments about the axis of the shaft, ccw positive, N·mm, shape (positions,).

    `input_per_crank_moment` is that of the drive of each position, and `output` the torque on the output. What seals and oil take
    at the input is not in it.
    """
    angle, pose, parts = found.crank_angle, found.pose, found.response.parts
    left = found.wheel_moment + input_per_crank_moment * model.crank_moments(angle, pose, parts).sum(axis=1) + output
    if model.coordinates.wheel:
        x, y = pose[:, model.coordinates.wheel_place].T
        force = model.force_beside_pins(angle, pose, parts)
        left = left + x * force.imag - y * force.real
    if model.coordinates.wheel_leans:
        x, y = pose[:, model.coordinates.wheel_lean_place].T
        tilting = model.tilting_beside_pins(angle, pose, parts)
        left = left + x * tilting.imag - y * tilting.real
    return np.asarray(left)


FIRST_FRICTION_STEP, LEAST_FRICTION_STEP = 0.25, 0.01
"""First and least step of the continuation in the strength of friction: where a step of the least size fails, the drive jams
between two hundredths of its friction."""
JAMMING_LOAD_RATIO = 2.0
"""Ratio of the loads with and without friction from which the end of the continuation is reported as jamming."""


def solve_at_output(
    model: Reducer,
    drives: Sequence[Drive],
    crank_angle: FloatArray,
    torque: FloatArray | float,
    start: FloatArray | None = None,
    inner: Start | None = None,
    wheel_moment: FloatArray | None = None,
) -> Equilibrium:
    """Balance positions at output torques.

    With friction they start from the answer without, and are followed through growing coefficients where that is too far.

    Parameters
    ----------
    model : Reducer
        Loads at a pose, of one drive or of a batch.
    drives : sequence of Drive
        The drives of the batch, often one; all have the same number of positions, drive by drive.
    crank_angle : array, shape (positions,)
        φ_C, rad.
    torque : float or array, shape (positions,)
        On the output, N·mm, positive as `load.direction` says; a negative one loads the other way. Without any the parts
        must hold each other.
    start : array, shape (positions, coordinates), optional
        Poses to start from, first contact by default.
    inner : Start, optional
        Inner unknowns near those poses.
    wheel_moment : array, shape (positions,), optional
        Moments on the wheel to start from, N·mm; those of the mean of a turn by default.

    Returns
    -------
    Equilibrium

    Raises
    ------
    ConvergenceError
        When a position does not balance.
    """
    if start is None and np.any(np.asarray(torque) == 0.0):
        angle = np.atleast_1d(np.asarray(crank_angle, dtype=float))
        light = np.repeat([drive.load.light_torque for drive in drives], angle.size // len(drives))
        near = solve_at_output(replace(model, friction=None), drives, angle, np.where(torque, torque, light))
        start, inner = near.pose, Start.after(near.response)
    friction = model.friction
    if friction is None or not friction.turns:
        return _solve(model, drives, crank_angle, torque, start, inner, wheel_moment)
    smooth = _solve(replace(model, friction=None), drives, crank_angle, torque, start, inner)
    try:
        return _solve(model, drives, crank_angle, torque, smooth.pose, Start.after(smooth.response))
    except ConvergenceError as error:
        failure = error
    found, reached, lost, step, loads = smooth, 0.0, 1.0, FIRST_FRICTION_STEP, smooth.response.pin_load.sum(axis=1)
    while reached < 1.0:
        strength = min(reached + step, 1.0)
        try:
            weakened = replace(model, friction=friction.scaled(strength))
            found = _solve(weakened, drives, crank_angle, torque, found.pose, Start.after(found.response))
        except ConvergenceError:
            lost = strength
            if step <= LEAST_FRICTION_STEP:
                raise _jam(
                    drives,
                    np.atleast_1d(crank_angle),
                    reached,
                    lost,
                    loads,
                    found.response.pin_load.sum(axis=1),
                    failure,
                ) from None
            step *= 0.5
            continue
        reached = strength
        if reached >= lost:  # the step was too long, nothing else
            step = min(2.0 * step, FIRST_FRICTION_STEP)
    return found


def _jam(
    drives: Sequence[Drive],
    crank_angle: FloatArray,
    reached: float,
    lost: float,
    without: FloatArray,
    grown: FloatArray,
    failure: ConvergenceError,
) -> ConvergenceError:
    """Return what to say of positions that balance up to a part of their friction: that they jam, and at which coefficients.

    Friction goes with the loads. What is left of a unit load's moment falls as friction rises, and the loads grow by its
    inverse; where that comes down to nothing before the whole friction counts no load whatever balances the torque. What
    the search made of the whole friction at once (that the teeth slip) tells nothing of that.
    """
    row = int(np.argmax(grown / np.maximum(without, 1e-300)))
    friction = drives[row * len(drives) // grown.size].friction
    names = () if friction is None else ("pin", "seat", "hole", "roller", "support_bearing")
    given = {name: value for name in names if (value := getattr(friction, name))}
    told = ", ".join(
        f"friction.{name} = {reached * value:.3g} to {lost * value:.3g} of {value:g}" for name, value in given.items()
    )
    # Near the end loads grow without bound; where they have not, the search may as well have lost its way.
    ended = "the drive jams" if grown[row] >= JAMMING_LOAD_RATIO * without[row] else "no balance was found"
    jammed = ConvergenceError(
        f"{ended} between {reached:.1%} and {lost:.1%} of its friction ({told}): wheel pins carry {without[row]:.4g} N "
        f"without friction, {grown[row]:.4g} N at {reached:.1%} of it at crank angle {crank_angle[row]:.6g} rad (position {row} "
        f"of {grown.size}), and nothing balances beyond"
    )
    jammed.history = failure.history
    return jammed


def _solve(
    model: Reducer,
    drives: Sequence[Drive],
    crank_angle: FloatArray,
    torque: FloatArray | float,
    start: FloatArray | None,
    inner: Start | None,
    wheel_moment: FloatArray | None = None,
) -> Equilibrium:
    """Balance positions at output torques, the way `solve_at_output` says."""
    angle = np.atleast_1d(np.asarray(crank_angle, dtype=float))
    loads = np.broadcast_to(np.asarray(torque, dtype=float), angle.shape)
    repeats = angle.size // len(drives)
    mean = np.repeat([drive.wheel_moment(1.0) for drive in drives], repeats) * loads
    held = np.repeat([drive.wheel_is_held for drive in drives], repeats)
    signed = np.repeat([drive.driving_sign for drive in drives], repeats) * loads
    # What parts that hold each other carry without a torque is balanced as well as under the light one.
    light = np.where(loads == 0.0, np.repeat([drive.load.light_torque for drive in drives], repeats), 0.0)

    def follow(rows: NDArray[np.intp], moment: FloatArray, near: Equilibrium) -> Equilibrium:
        return follow_equilibrium(model if rows.size == angle.size else model.take(rows), near, moment, light[rows])

    input_per_crank_moment = np.repeat([drive.input_per_crank_moment for drive in drives], repeats)
    by_wheel = np.repeat([1.0 / abs(drive.output_per_wheel_angle) for drive in drives], repeats)
    first = mean if wheel_moment is None else np.where(held, wheel_moment, mean)
    found = solve_equilibrium(model, angle, first, start, inner, len(drives), light)
    return _at_output(model, follow, found, signed, held, input_per_crank_moment, by_wheel, light)


def balance_at_output(
    model: Reducer,
    balance: Balance,
    drive: Drive,
    crank_angle: FloatArray,
    torque: float,
    start: FloatArray | None = None,
) -> Equilibrium:
    """Balance positions of one drive at an output torque, N·mm, by any method that balances moments on the wheel.

    `balance` takes crank angles, moments on the wheel and poses to start from, and returns balanced positions.
    """
    angle = np.atleast_1d(np.asarray(crank_angle, dtype=float))
    mean = np.full(angle.size, drive.wheel_moment(torque))
    held = np.full(angle.size, drive.wheel_is_held)

    def follow(rows: NDArray[np.intp], moment: FloatArray, near: Equilibrium) -> Equilibrium:
        return balance(angle[rows], moment, near.pose)

    input_per_crank_moment = np.full(angle.size, drive.input_per_crank_moment)
    signed = np.full(angle.size, drive.driving_sign * torque)
    by_wheel = np.full(angle.size, 1.0 / abs(drive.output_per_wheel_angle))
    found, light = balance(angle, mean, start), np.zeros(angle.size)
    return _at_output(model, follow, found, signed, held, input_per_crank_moment, by_wheel, light)


def _at_output(
    model: Reducer,
    follow: Callable[[NDArray[np.intp], FloatArray, Equilibrium], Equilibrium],
    found: Equilibrium,
    signed: FloatArray,
    held: NDArray[np.bool_],
    input_per_crank_moment: FloatArray,
    by_wheel: FloatArray,
    reference: FloatArray,
) -> Equilibrium:
    """Find the moments on held wheels by secants, from positions balanced at the mean moment of a turn.

    `follow` balances some positions under other moments, from what they were balanced under last. `by_wheel` is the mean of
    the output torque by the moment on the wheel, and `reference` the torque that what is left over is measured by where the
    output torque is smaller, N·mm.
    """
    if not np.any(held):
        return found
    angle, mean = found.crank_angle, found.wheel_moment
    moment = mean.copy()
    left = unbalanced_moment(model, found, input_per_crank_moment, signed)
    # The cranks carry 1/u of the wheel's moment in the mean, the input its part of that: what is left grows with the moment.
    slope = by_wheel.copy()
    history = []
    for _ in range(MAX_ITERATIONS):
        history.append(float(np.max(np.abs(np.where(held, left, 0.0)))))
        open_rows = np.nonzero(held & (np.abs(left) > TORQUE_TOLERANCE * np.maximum(np.abs(signed), reference)))[0]
        if open_rows.size == 0:
            return found
        step = -left[open_rows] / slope[open_rows]
        moment[open_rows] += step
        whole = open_rows.size == angle.size
        near = found if whole else take_positions(found, open_rows)
        part = follow(open_rows, moment[open_rows], near)
        part = replace(part, iterations=near.iterations + part.iterations)
        found = part if whole else put_positions(found, open_rows, part)
        before = left[open_rows]
        model_part = model if whole else model.take(open_rows)
        left[open_rows] = unbalanced_moment(model_part, part, input_per_crank_moment[open_rows], signed[open_rows])
        secant = (left[open_rows] - before) / step
        # Round-off of both ends makes no slope any more; a wrong one would only cost rounds.
        slope[open_rows] = np.where(np.abs(secant / slope[open_rows] - 1.0) < 0.5, secant, slope[open_rows])
    worst = int(np.argmax(np.abs(np.where(held, left, 0.0))))
    raise ConvergenceError(
        f"the moment that holds the wheel is not found at crank angle {angle[worst]:.6g} rad; moments left over in N·mm",
        history,
    )
