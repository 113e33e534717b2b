r"""Equilibrium at a given torque of the output, whichever member is held.

With the wheel held the output is the pin shaft, and its moments balance by :math:`T_W + T_{in} + T_{out} + w \times G = 0` with
the force G on the wheel, displaced by w against the shaft, from outside and by the first stage.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import FloatArray, put_positions, take_positions
from ltca.compliance.response import Start
from ltca.drive.least_torque import least_torque
from ltca.drive.parts import Drive
from ltca.equilibrium.balance import Equilibrium, follow_equilibrium, poses_at_stops, solve_equilibrium
from ltca.equilibrium.newton import Holding
from ltca.equilibrium.reducer import Reducer
from ltca.errors import ConvergenceError

Balance = Callable[[FloatArray, FloatArray, FloatArray | None], Equilibrium]
"""Function that balances positions: crank angles, moments on the wheel and poses to start from."""

MAX_ITERATIONS = 30
TORQUE_TOLERANCE = 1e-10
"""Unbalanced moment relative to the output torque; the balance of forces leaves more."""
HARDLY_LOADED = 1e4
"""Torque by the least one below which the search begins where the wheel stops without load. The less a pin is pressed, the
shorter are the steps along the curve of the flank that do not lift it off: hundreds from first contact, or from near by."""
FIRST_FRICTION_STEP, LEAST_FRICTION_STEP = 0.25, 0.01
"""First and least step of the continuation in the strength of friction."""
JAMMING_LOAD_RATIO = 2.0
"""Ratio of the loads with and without friction from which the end of the continuation counts as jamming."""


def unbalanced_moment(
    model: Reducer, found: Equilibrium, input_per_crank_moment: FloatArray, output: FloatArray | float
) -> FloatArray:
    """Return the sum of moments about the axis of the shaft without drag of seals, ccw positive, N·mm, shape (positions,)."""
    pressed = _moment_of_contacts(model, found.crank_angle, found.pose, found.response.parts, input_per_crank_moment)
    return np.asarray(found.wheel_moment + pressed + output)


def _moment_of_contacts(
    model: Reducer, angle: FloatArray, pose: FloatArray, parts: Any, input_per_crank_moment: FloatArray
) -> FloatArray:
    """Sum of the moments without those on wheel and output."""
    left = input_per_crank_moment * model.crank_moments(angle, pose, parts).sum(axis=1)
    if model.coordinates.wheel or model.coordinates.wheel_leans:
        for place, pressed in zip(model.wheel_places, model.beside_pins(angle, pose, parts).T, strict=True):
            x, y = pose[:, place[:1]], pose[:, place[1:]]
            left = left + (x * pressed.imag[:, None] - y * pressed.real[:, None]).sum(axis=1)
    return np.asarray(left)


def solve_at_output(
    model: Reducer,
    drives: Sequence[Drive],
    crank_angle: FloatArray,
    torque: FloatArray | float,
    start: FloatArray | None = None,
    inner: Start | None = None,
    wheel_moment: FloatArray | None = None,
) -> Equilibrium:
    """Balance positions at output torques, N·mm, positive as `load.direction` says; without any the parts must hold each other.

    The `drives` of a batch have equally many positions, drive by drive; `wheel_moment` are moments to start from.
    """
    angle = np.atleast_1d(np.asarray(crank_angle, dtype=float))
    loads = np.broadcast_to(np.asarray(torque, dtype=float), angle.shape)
    wanted = OutputTorque.of_drives(drives, loads)
    if _hardly_load(drives, loads) and (stops := poses_at_stops(model, angle, wanted.mean)) is not None:
        start, inner = stops, None
    if start is None and np.any(loads == 0.0):
        light = np.repeat([drive.load.light_torque for drive in drives], angle.size // len(drives))
        near = solve_at_output(replace(model, friction=None), drives, angle, np.where(loads, loads, light))
        start, inner = near.pose, Start.after(near.response)
    friction, moment = model.friction, wanted.mean
    rubs = friction is not None and friction.turns
    if wheel_moment is not None and not rubs:
        moment = np.where(wanted.held, wheel_moment, moment)
    # What rubs is taken away first, then all of it is tried at once, then more and more.
    strength, reached, lost, step = (0.0 if rubs else 1.0), 0.0, 1.0, 1.0
    failure, carried = None, list[FloatArray]()
    while True:
        part = model
        if friction is not None and strength < 1.0:
            part = replace(model, friction=friction.scaled(strength) if strength else None)
        try:
            holding = wanted.holding(part, angle)
            found = solve_equilibrium(part, angle, moment, start, inner, len(drives), wanted.reference, holding)
            found = wanted.balanced(part, found)
        except ConvergenceError as error:
            if not (rubs and strength):
                raise
            lost, failure = strength, failure or error
            if step <= LEAST_FRICTION_STEP:
                raise _jam(drives, angle, reached, lost, carried[0], carried[-1], failure) from None
            step = min(0.5 * step, FIRST_FRICTION_STEP)
        else:
            if strength == 1.0:
                return found
            reached, start, inner = strength, found.pose, Start.after(found.response)
            carried.append(found.response.pin_load.sum(axis=1))
            if failure and reached >= lost:  # the step was too long, nothing else
                step = min(2.0 * step, FIRST_FRICTION_STEP)
        strength = min(reached + step, 1.0)


def _hardly_load(drives: Sequence[Drive], loads: FloatArray) -> bool:
    """Whether all loads press the parts so little that their way through the play would be long."""
    least = np.repeat([least_torque(drive) for drive in drives], loads.size // len(drives))
    return bool(np.all(np.abs(loads) < HARDLY_LOADED * least))


def _jam(
    drives: Sequence[Drive],
    crank_angle: FloatArray,
    reached: float,
    lost: float,
    without: FloatArray,
    grown: FloatArray,
    failure: ConvergenceError,
) -> ConvergenceError:
    """The error of positions that balance up to a part of their friction only: that they jam, and at which coefficients."""
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


@dataclass(frozen=True, slots=True, kw_only=True)
class OutputTorque:
    """Torques at which positions are balanced, N·mm, one row for each."""

    signed: FloatArray  # on the output, ccw positive
    mean: FloatArray  # moment on the wheel that it is in the mean of a turn
    held: NDArray[np.bool_]  # where the wheel is held
    input_per_crank_moment: FloatArray
    by_wheel: FloatArray  # mean output torque by the moment on the wheel, without sign
    reference: FloatArray  # that residuals are measured by where the output torque is smaller

    @classmethod
    def of_drives(cls, drives: Sequence[Drive], loads: FloatArray) -> OutputTorque:
        """Return the torques, those of drive after drive."""

        def each(value: Callable[[Drive], float]) -> NDArray[Any]:
            return np.repeat([value(drive) for drive in drives], loads.size // len(drives))

        return cls(
            signed=each(lambda drive: drive.driving_sign) * loads,
            mean=each(lambda drive: drive.wheel_moment(1.0)) * loads,
            held=each(lambda drive: drive.wheel_is_held),
            input_per_crank_moment=each(lambda drive: drive.input_per_crank_moment),
            by_wheel=each(lambda drive: 1.0 / abs(drive.output_per_wheel_angle)),
            # What parts that hold each other carry without a torque is balanced as well as under the light one.
            reference=np.where(loads == 0.0, each(lambda drive: drive.load.light_torque), 0.0),
        )

    def holding(self, model: Reducer, crank_angle: FloatArray) -> Holding | None:
        """Return the function that finds moments on held wheels by the contacts of some positions; None where none is held."""
        if not np.any(self.held):
            return None

        def moments(rows: NDArray[np.intp], pose: FloatArray, moment: FloatArray, response: Any) -> FloatArray:
            own, ratio = model.take(rows), self.input_per_crank_moment[rows]
            left = moment + self.signed[rows] + _moment_of_contacts(own, crank_angle[rows], pose, response.parts, ratio)
            return np.where(self.held[rows], moment - left / self.by_wheel[rows], moment)

        return moments

    def balanced(self, model: Reducer, found: Equilibrium, balance: Balance | None = None) -> Equilibrium:
        """Find the moments on held wheels by secants, following positions by Newton's method, or anew by `balance`."""
        held, moment = self.held, found.wheel_moment.copy()
        if not np.any(held):
            return found
        left = unbalanced_moment(model, found, self.input_per_crank_moment, self.signed)
        # The cranks carry 1/u of the wheel's moment in the mean, the input its part of that: what is left grows with it.
        slope, history = self.by_wheel.copy(), []
        for _ in range(MAX_ITERATIONS):
            history.append(float(np.max(np.abs(np.where(held, left, 0.0)))))
            accepted = TORQUE_TOLERANCE * np.maximum(np.abs(self.signed), self.reference)
            rows = np.nonzero(held & (np.abs(left) > accepted))[0]
            if rows.size == 0:
                return found
            step, whole = -left[rows] / slope[rows], rows.size == moment.size
            moment[rows] += step
            near, own = (found, model) if whole else (take_positions(found, rows), model.take(rows))
            if balance is None:
                part = follow_equilibrium(own, near, moment[rows], self.reference[rows])
            else:
                part = balance(near.crank_angle, moment[rows], near.pose)
            part = replace(part, iterations=near.iterations + part.iterations)
            found, before = part if whole else put_positions(found, rows, part), left[rows]
            left[rows] = unbalanced_moment(own, part, self.input_per_crank_moment[rows], self.signed[rows])
            secant = (left[rows] - before) / step
            # Round-off of both ends makes no slope any more; a wrong one would only cost rounds.
            slope[rows] = np.where(np.abs(secant / slope[rows] - 1.0) < 0.5, secant, slope[rows])
        worst = int(np.argmax(np.abs(np.where(held, left, 0.0))))
        raise ConvergenceError(
            f"the moment that holds the wheel is not found at crank angle {found.crank_angle[worst]:.6g} rad; moments left "
            "over in N·mm",
            history,
        )
