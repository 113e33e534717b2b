r"""Response of a drive to its transmission error over speed, order by order, and what it does to contacts.

Seen from the crank, the contacts of a drive stand nearly still. In that frame (`Motion.turned`), which turns at the speed
:math:`\dot\varphi` of the crank, the drive would follow its quasi-static motion :math:`X_s(\varphi_C)`, whose orders are fitted
with the input turning evenly; its masses do not let it, and it departs by Y:

.. math:: M D^2 Y + C \dot Y + K(\varphi_C) Y = -M D^2 X_s - f_0, \quad D = \frac{d}{dt} + \dot\varphi J

with the tangent K of every position of a turn, the masses in the mean of a turn, the spin J of the frame (Coriolis and
centrifugal terms) and the inertia forces :math:`f_0` of the nominal motion: discs on their eccentrics. The pulsation of the
stiffness makes of every whole order all others (`ltca.dynamics.harmonic_balance`). What of it does not come again after a turn
is left out and told; so are the speeds at which the balance does not converge and the mean stiffness answers. What torque the
input takes at rest it has at every speed: an input whose inertia is given vibrates about that. A damping ratio is that of every
mode of the mean of K and M, a loss factor makes K̄(1 + iη) of the mean.

Where the pulsation shakes modes up by itself, and from where the transmitted torque would pass through zero, so that contacts
part, the response is not valid: both are told.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ltca.analysis.force_orders import ForceSpectrum, force_content
from ltca.analysis.forces_in_motion import forces_in_motion
from ltca.analysis.transmission_error_orders import OrderFit
from ltca.analysis.vibration import Vibration, speed_range
from ltca.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from ltca.drive.parts import Drive
from ltca.dynamics.harmonic_balance import HillSystem, UnstableRange, unstable_ranges
from ltca.dynamics.kinetics import moving_bodies
from ltca.dynamics.masses import drive_masses
from ltca.dynamics.modes import Modes, solve_modes
from ltca.errors import ConvergenceError, DriveError, Problem
from ltca.geometry.placement import position_angles
from ltca.output.threads import on_one_thread

SPEEDS = 300
"""Evenly spaced speeds of a response; critical ones come to them."""
OPERATION = "speed of operation"
TOLD_BETWEEN, TOLD_CRITICAL = 24, 8
"""Speeds whose forces are told: evenly over all, and critical ones of the largest orders; those of operation come to them."""
MOST_TRUNCATION = 0.05
"""Change of the transmission error by half of the orders, relative to it, beyond which more positions are asked for."""
MOST_POSITIONS = 1000
"""Positions of a turn that are asked for at most."""
GIVEN_UP = 3
"""Speeds in a row, faster than one that balances, whose failure ends the balance with the pulsation."""
SAME_ORDER = 1e-9
"""Distance from a whole number below which an order is one."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ForcedVibration:
    """Response over speed.

    Attributes
    ----------
    speed : array, shape (speeds,)
        Of the input, ascending, turns a minute.
    order_amplitude : array, shape (speeds, orders)
        Of the transmission error in motion, the orders of the spectrum, rad.
    amplitude : array, shape (speeds,)
        Root mean square of the transmission error about its mean, rad, with orders that only the motion has.
    mean_at : array, shape (speeds,)
        Those of the speeds at which the mean stiffness answers, since the balance with its pulsation does not converge.
    truncation : float
        Change of the transmission error, by itself, that half of the orders of the balance make where it is largest.
    unstable : tuple of UnstableRange
        Speeds of the input, turns a minute, at which the stiffness shakes modes up by its pulsation.
    torque_ratio : array, shape (speeds,)
        Largest departure of the moment between wheel and discs by its mean over the turn: from 1 on contacts part.
    factors : dict of str to array, shape (speeds,)
        Largest load in motion by the largest at rest over the walked turns, by what carries it.
    told_speed : array, shape (told,)
        Speeds of the input whose forces are told, turns a minute, ascending, the first 0: at rest.
    reasons : tuple of str
        Why each is told: what turns there, or resonates; empty of those between.
    forces : tuple of ForceSpectrum
        Spectra of all single forces at these speeds, by kind.
    """

    speed: FloatArray
    order_amplitude: FloatArray
    amplitude: FloatArray
    mean_at: FloatArray
    truncation: float
    unstable: tuple[UnstableRange, ...]
    torque_ratio: FloatArray
    factors: dict[str, FloatArray]
    told_speed: FloatArray
    reasons: tuple[str, ...]
    forces: tuple[ForceSpectrum, ...]

    @property
    def parts_from(self) -> float | None:
        """Least speed at which contacts part, turns a minute; None where they stay closed."""
        beyond = self.speed[self.torque_ratio >= 1.0]
        return float(beyond[0]) if beyond.size else None


@on_one_thread  # of tens of rows: more threads wait for each other ten times as long as they work
def forced_vibration(found: Vibration, *, fastest: float | None = None, speeds: int = SPEEDS) -> ForcedVibration:
    """Return the response of a drive over the speed of its input.

    Parameters
    ----------
    found : Vibration
        Its vibrations; its drive has damping.
    fastest : float, optional
        Largest speed of the input, turns a minute; that of `speed_range` by default.
    speeds : int
        Evenly spaced speeds; critical ones come to them.

    Returns
    -------
    ForcedVibration

    Raises
    ------
    DriveError
        Without damping, with which resonances would have no end.
    """
    drive = found.drive
    if drive.damping is None:
        said = "must be given (or damping.loss_factor) for a response over speed"
        raise DriveError([Problem.of("damping.ratio", "", said)])
    return _respond(found, speed_range(drive)[1] if fastest is None else fastest, speeds)


def _respond(found: Vibration, top: float, speeds: int) -> ForcedVibration:
    """Response up to a speed of the input, turns a minute."""
    drive = found.drive
    critical = [one.speed for one in found.critical_speeds(top) if one.speed <= top]
    speed = np.unique(np.concatenate((top * np.arange(1, speeds + 1) / speeds, critical, _operation(drive, top))))
    model = replace(found.engine.prepare(drive).model, friction=None)
    orders, resting = _orders(found), _quasi_static(found)
    crank = abs(drive.crank_turns_per_input) * speed * 2.0 * np.pi / 60.0
    system, nominal = _system(found), _nominal_forces(found)
    forces = np.array([_force(system, one, orders, resting, nominal) for one in crank])
    answers, balanced = _answers(system, crank, orders, forces)
    every = np.abs(np.einsum("n,smn->sm", _deviation(found), resting.T + answers[:, 1:]))
    amplitude = np.sqrt(0.5 * np.sum(every**2, axis=1))
    worst = int(np.argmax(np.where(balanced, amplitude, 0.0)))
    fewer = system.respond(
        crank[worst], orders, forces[worst], pulsates=bool(balanced[worst]), highest=system.stiffness.orders // 2
    )
    changed = _deviation(found) @ (fewer - answers[worst])[1:].T
    told, reasons = _told(found, speed, top)
    loads = forces_in_motion(found, model, orders, answers, told)
    return ForcedVibration(
        speed=speed,
        order_amplitude=every[:, _places(found, orders)],
        amplitude=amplitude,
        mean_at=speed[~balanced],
        truncation=float(np.sqrt(0.5 * np.sum(np.abs(changed) ** 2)) / amplitude[worst]),
        unstable=_unstable(found, system, top),
        torque_ratio=loads.torque_ratio,
        factors=loads.factors,
        told_speed=np.concatenate(([0.0], speed[told])),
        reasons=("at rest", *reasons),
        forces=loads.spectra,
    )


def _operation(drive: Drive, top: float) -> list[float]:
    """Speeds at which a drive runs, up to a largest one, turns a minute."""
    given = [entry.speed for entry in drive.duty] or ([] if drive.load.speed is None else [drive.load.speed])
    return [speed for speed in given if 0.0 < speed <= top]


def _told(found: Vibration, speed: FloatArray, top: float) -> tuple[IntArray, tuple[str, ...]]:
    """Places of the speeds whose forces are told, ascending, and why each is: those of operation, critical ones of the largest
    orders, and some between.
    """
    reasons = dict.fromkeys(speed[np.unique(np.linspace(0, speed.size - 1, TOLD_BETWEEN).round().astype(int))], "")
    critical = [one for one in found.critical_speeds(top) if one.speed <= top]
    for one in sorted(critical, key=lambda each: -each.amplitude)[:TOLD_CRITICAL]:
        reasons[one.speed] = f"mode {one.mode + 1} by {one.order.name}"
    reasons |= dict.fromkeys(_operation(found.drive, top), OPERATION)
    places = sorted((int(np.argmin(np.abs(speed - each))), why) for each, why in reasons.items())
    return np.array([place for place, _ in places]), tuple(why for _, why in places)


def _answers(
    system: HillSystem, crank: FloatArray, orders: FloatArray, forces: ComplexArray
) -> tuple[ComplexArray, BoolArray]:
    """Amplitudes by speed, order and coordinate, the mean first; and at which speeds the stiffness pulses."""
    found, balanced = list[ComplexArray](), np.zeros(crank.size, dtype=bool)
    for number, (speed, force) in enumerate(zip(crank.tolist(), forces, strict=True)):
        # Beyond speeds that balance, what does not converge does so less and less; below, an input may turn too freely.
        if not balanced.any() or balanced[max(number - GIVEN_UP, 0) : number].any():
            try:
                found.append(system.respond(speed, orders, force))
                balanced[number] = True
                continue
            except ConvergenceError:
                pass
        found.append(system.respond(speed, orders, force, pulsates=False))
    return np.array(found), balanced


def _system(found: Vibration) -> HillSystem:
    """What vibrates, seen from the crank; on average the turning of a whole free drive, on which no torque changes, stays."""
    damping, losses = _damping(found)
    steady = np.eye(found.basis.shape[1])
    if not found.input_is_held:
        along = np.linalg.lstsq(found.basis, found.motion.rigid, rcond=None)[0]
        steady = np.linalg.svd(along[None])[2][1:].T
    return HillSystem(
        mass=found.mean_mass,
        damping=damping,
        spin=found.motion.spin,
        loss_factor=losses,
        stiffness=found.stiffness,
        basis=found.basis,
        steady=steady,
    )


def _force(
    system: HillSystem, speed: float, orders: FloatArray, resting: ComplexArray, nominal: FloatArray
) -> ComplexArray:
    """Inertia forces of the nominal and the quasi-static motion at a speed of the crank, mean and orders, shape (1 + orders,
    coordinates).
    """
    rates = 1j * speed * orders[:, None, None] * np.eye(nominal.size) + speed * system.spin
    moving = -(system.mass @ rates @ rates @ resting.T[:, :, None])[:, :, 0]
    return np.concatenate((speed**2 * nominal[None], moving))


def _unstable(found: Vibration, system: HillSystem, top: float) -> tuple[UnstableRange, ...]:
    """Ranges of parametric resonance up to a speed of the input, turns a minute, speeds as those of the input."""
    damping, modes = found.drive.damping, _mean_modes(found)
    if damping is None:
        return ()
    first = int(modes.turns_freely)
    frequency, shapes = 2.0 * np.pi * modes.frequency[first:], modes.shapes[:, first:]
    by_crank = 60.0 / (2.0 * np.pi * abs(found.drive.crank_turns_per_input))
    ranges = unstable_ranges(system.stiffness, frequency, shapes, damping.ratio_at_resonance, top / by_crank)
    return tuple(replace(one, slowest=by_crank * one.slowest, fastest=by_crank * one.fastest) for one in ranges)


def _mean_modes(found: Vibration) -> Modes:
    rigid = None if found.input_is_held else found.motion.rigid
    return solve_modes(found.stiffness.mean, found.mean_mass, found.basis, rigid)


def _damping(found: Vibration) -> tuple[FloatArray, float]:
    """Matrix of viscous damping of every mode alike, N·s/mm, and loss factor: one of them zero."""
    damping = found.drive.damping
    nothing = np.zeros_like(found.mean_mass)
    if damping is None or damping.ratio is None:
        return nothing, 0.0 if damping is None else damping.loss_factor or 0.0
    modes = _mean_modes(found)
    each = 2.0 * damping.ratio * 2.0 * np.pi * modes.frequency
    on_modes = found.mean_mass @ modes.shapes
    return np.asarray((on_modes * each) @ on_modes.T), 0.0


def _orders(found: Vibration) -> FloatArray:
    """Whole orders that the positions of a turn resolve, then those of the spectrum that are no whole numbers."""
    spectrum = np.array([order.value for order in found.spectrum.orders])
    between = spectrum[np.abs(spectrum - np.round(spectrum)) > SAME_ORDER]
    return np.concatenate((np.arange(1.0, found.stiffness.orders + 1.0), between))


def _places(found: Vibration, orders: FloatArray) -> IntArray:
    """Places of the orders of the spectrum among all."""
    return np.array([int(np.argmin(np.abs(orders - order.value))) for order in found.spectrum.orders])


def _deviation(found: Vibration) -> FloatArray:
    """Row of the transmission error: the rotation of the output less what that of the input makes of it."""
    motion = found.motion
    ratio = float(motion.output_turns @ motion.rigid) / float(motion.input_turns @ motion.rigid)
    return np.asarray(motion.output_turns - ratio * motion.input_turns)


def _quasi_static(found: Vibration) -> ComplexArray:
    """Orders of the quasi-static motion of all coordinates with the input turning evenly, seen from the crank, shape
    (coordinates, orders): those of the spectrum, the others zero.
    """
    motion = found.motion
    moved = np.zeros((found.walked_angle.size, motion.size))
    moved[:, : motion.pose.size] = found.walked_pose
    moved[:, motion.crank] = found.walked_lag
    evenly = moved @ motion.input_turns / float(motion.input_turns @ motion.rigid)
    moved -= evenly[:, None] * motion.rigid
    moved = np.einsum("pji,pj->pi", motion.turned(found.walked_angle), moved)
    fit, orders = OrderFit(np.array([order.value for order in found.spectrum.orders])), _orders(found)
    fit.add(found.walked_angle, moved)
    every = np.zeros((motion.size, orders.size), dtype=complex)
    every[:, _places(found, orders)] = fit.solve()[1].T
    return every


def _nominal_forces(found: Vibration) -> FloatArray:
    """Inertia forces of the nominal motion as loads, seen from the crank, by the square of its speed, mean of a turn, shape
    (coordinates,).
    """
    motion, masses, step = found.motion, drive_masses(found.drive), 1e-4
    total, angles = np.zeros(motion.size), position_angles(8)
    for angle, turned in zip(angles, motion.turned(angles), strict=True):
        here, before, after = (moving_bodies(motion, masses, float(angle) + by) for by in (0.0, -step, step))
        for body, low, high in zip(here, before, after, strict=True):
            acceleration = (high.row - low.row) @ motion.rigid / (2.0 * step)
            total -= turned.T @ (body.size * (body.row.conjugate() * acceleration).real)
    return np.asarray(total / angles.size)


RANGES_TOLD = 4
"""Ranges of parametric resonance that are told in words; files have all."""


def response_notes(found: ForcedVibration, vibration: Vibration) -> list[str]:
    """Return what to know of a response, one sentence each.

    Parameters
    ----------
    found : ForcedVibration
        The response.
    vibration : Vibration
        Whose it is.
    """
    notes = [
        f"stiffness pulses over the turn; {vibration.stiffness_rest:.2%} of it does not come again after one and is left out; "
        f"half of the orders change the transmission error by {found.truncation:.2g} of it"
    ]
    if found.truncation > MOST_TRUNCATION:
        more = min(2 * len(vibration.stiffness.over_turn), MOST_POSITIONS)
        notes.append(
            f"that is more than {MOST_TRUNCATION:g}: the orders are too few for the resonances up to this speed; take more "
            f"positions (--positions {more}) or a lower --speed"
        )
    if found.mean_at.size:
        low, high = found.mean_at.min(), found.mean_at.max()
        notes.append(
            f"at {found.mean_at.size} of {found.speed.size} speeds, from {low:.4g} to {high:.4g} rpm, the balance with the "
            "pulsation does not converge: mean stiffness there"
        )
    notes += [
        f"from {one.slowest:.4g} to {one.fastest:.4g} rpm order {one.order} of the stiffness shakes modes "
        f"{one.modes[0] + 1} and {one.modes[1] + 1} up by itself (parametric resonance): unstable"
        for one in found.unstable[:RANGES_TOLD]
    ]
    if len(found.unstable) > RANGES_TOLD:
        notes.append(f"and {len(found.unstable) - RANGES_TOLD} more such ranges in dynamics.json")
    if found.parts_from is not None:
        notes.append(
            f"from {found.parts_from:.4g} rpm the torque would pass through zero: contacts part, and the linear response ends"
        )
    return notes


def response_content(found: ForcedVibration, vibration: Vibration) -> dict[str, Any]:
    """Return a response as files hold it.

    Parameters
    ----------
    found : ForcedVibration
        The response.
    vibration : Vibration
        Whose it is.
    """
    orders = vibration.told_orders
    return {
        "speed_rpm": found.speed.tolist(),
        "transmission_error_rms_rad": found.amplitude.tolist(),
        "orders": [
            {
                "order": vibration.spectrum.orders[place].value,
                "name": vibration.spectrum.names[place],
                "amplitude_rad": found.order_amplitude[:, place].tolist(),
            }
            for place in orders
        ],
        "stiffness_that_does_not_repeat": vibration.stiffness_rest,
        "truncation": found.truncation,
        "mean_stiffness_at_rpm": found.mean_at.tolist(),
        "unstable_ranges": [
            {
                "least_rpm": one.slowest,
                "largest_rpm": one.fastest,
                "order": one.order,
                "modes": [m + 1 for m in one.modes],
            }
            for one in found.unstable
        ],
        "torque_ratio": found.torque_ratio.tolist(),
        "contacts_part_from_rpm": found.parts_from,
        "forces": [
            {
                "speed_rpm": float(speed),
                "why": why,
                "forces": force_content(tuple(one.at(place) for one in found.forces)),
            }
            for place, (speed, why) in enumerate(zip(found.told_speed, found.reasons, strict=True))
            if why and place
        ],
        "dynamic_factor": {kind.replace(" ", "_"): values.tolist() for kind, values in found.factors.items()},
    }
