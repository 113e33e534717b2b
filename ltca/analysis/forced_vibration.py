r"""Response of a drive to its transmission error over speed, order by order, and what it does to contacts.

Seen from the crank, the contacts of a drive stand nearly still. In that frame (`Motion.turned`), which turns at the speed
:math:`\dot\varphi` of the crank, the drive would follow its quasi-static motion :math:`X_s(\varphi_C)`, whose orders are fitted
with the input turning evenly; its masses do not let it, and it departs by Y:

.. math:: M D^2 Y + C \dot Y + K Y = -M D^2 X_s - f_0, \quad D = \frac{d}{dt} + \dot\varphi J

with stiffness and masses in the mean of a turn, the spin J of the frame (Coriolis and centrifugal terms) and the inertia forces
:math:`f_0` of the nominal motion: discs on their eccentrics. What torque the input takes at rest it has at every speed: an input
whose inertia is given vibrates about that. A damping ratio is that of every mode of K and M, a loss factor makes K(1 + iη) of K.

That the stiffness itself pulses over the turn is in :math:`X_s` and left out of the response (no parametric resonance), and
contacts are taken to stay closed: from where the transmitted torque would pass through zero, that is told.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ltca.analysis.transmission_error_orders import order_amplitudes
from ltca.analysis.vibration import Vibration, speed_range
from ltca.arrays import ComplexArray, FloatArray
from ltca.compliance.response import Response, Start
from ltca.dynamics.kinetics import moving_bodies
from ltca.dynamics.masses import drive_masses
from ltca.dynamics.modes import solve_modes
from ltca.dynamics.stiffness import levers
from ltca.equilibrium.balance import lever_arms
from ltca.equilibrium.output_torque import solve_at_output
from ltca.equilibrium.reducer import Reducer, bearing_forces
from ltca.errors import DriveError
from ltca.geometry.coordinates import WHEEL_ANGLE
from ltca.geometry.placement import position_angles

SPEEDS = 300
"""Evenly spaced speeds of a response; critical ones come to them."""
POSITIONS = 96
"""Crank angles of a turn at which loads are told."""
STEP = 1e-6
"""Displacement by which loads are differenced, mm: approaches are micrometres."""
KINDS = ("wheel pins", "rollers", "shaft pins", "crank bearings")
"""Contacts that dynamic factors are told of."""


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
        Root of the sum of their squares by √2: root mean square of the transmission error about its mean, rad.
    torque_ratio : array, shape (speeds,)
        Largest departure of the moment between wheel and discs by its mean over the turn: from 1 on contacts part.
    factors : dict of str to array, shape (speeds,)
        Largest load in motion by the largest at rest, by `KINDS`.
    """

    speed: FloatArray
    order_amplitude: FloatArray
    amplitude: FloatArray
    torque_ratio: FloatArray
    factors: dict[str, FloatArray]

    @property
    def parts_from(self) -> float | None:
        """Least speed at which contacts part, turns a minute; None where they stay closed."""
        beyond = self.speed[self.torque_ratio >= 1.0]
        return float(beyond[0]) if beyond.size else None


def forced_vibration(found: Vibration, *, fastest: float | None = None) -> ForcedVibration:
    """Return the response of a drive over the speed of its input.

    Parameters
    ----------
    found : Vibration
        Its vibrations; its drive has damping.
    fastest : float, optional
        Largest speed of the input, turns a minute; that of `speed_range` by default.

    Returns
    -------
    ForcedVibration

    Raises
    ------
    DriveError
        Without damping, with which resonances would have no end.
    """
    drive, motion = found.drive, found.motion
    if drive.damping is None:
        raise DriveError(["damping.ratio: must be given (or damping.loss_factor) for a response over speed"])
    top = speed_range(drive)[1] if fastest is None else fastest
    critical = [one.speed for one in found.critical_speeds(top) if one.speed <= top]
    speeds = np.unique(np.concatenate((top * np.arange(1, SPEEDS + 1) / SPEEDS, critical)))
    model = replace(found.engine.prepare(drive).model, friction=None)
    orders, resting = _orders(found), _quasi_static(found)
    crank = abs(drive.crank_turns_per_input) * speeds * 2.0 * np.pi / 60.0
    departure, outward = _departures(found, crank, orders, resting)
    order_amplitude = np.abs(np.einsum("n,snm->sm", _deviation(found), resting + departure))
    loads = _Loads.at_load(found, model)
    waves = np.exp(1j * orders[:, None] * loads.angle)
    seen = np.matmul(departure, waves).real + outward[:, :, None]
    moved = np.einsum("pij,sjp->sip", motion.turned(loads.angle), seen)
    return ForcedVibration(
        speed=speeds,
        order_amplitude=order_amplitude,
        amplitude=np.sqrt(0.5 * np.sum(order_amplitude**2, axis=1)),
        torque_ratio=loads.torque_ratio(moved),
        factors=loads.factors(moved),
    )


def _departures(
    found: Vibration, crank: FloatArray, orders: FloatArray, resting: ComplexArray
) -> tuple[ComplexArray, FloatArray]:
    """Amplitudes of the departure by speed, coordinate and order; what centrifugal forces displace, by speed and coordinate."""
    motion, basis = found.motion, found.basis
    mass, stiffness = found.mean_mass, found.mean_stiffness
    damping, losses = _damping(found)
    spin, size = motion.spin, found.motion.size
    departure = np.zeros((crank.size, size, orders.size), dtype=complex)
    outward = np.zeros((crank.size, size))
    nominal = _nominal_forces(found)
    for row, speed in enumerate(crank.tolist()):
        rates = 1j * speed * orders[:, None, None] * np.eye(size) + speed * spin
        inertia = mass @ rates @ rates
        whole = inertia + 1j * speed * orders[:, None, None] * damping + stiffness * (1.0 + 1j * losses)
        force = -(inertia @ resting.T[:, :, None])
        answer = np.linalg.solve(basis.T @ whole @ basis, basis.T @ force)
        departure[row] = (basis @ answer)[:, :, 0].T
        steady = stiffness + speed**2 * mass @ spin @ spin
        turning = motion.rigid if not found.input_is_held else None
        outward[row] = _steady(steady, speed**2 * nominal, basis, turning)
    return departure, outward


def _steady(stiffness: FloatArray, force: FloatArray, basis: FloatArray, turning: FloatArray | None) -> FloatArray:
    """Displacement under steady forces; the turning of the whole drive, on which they do no work, is left as it is."""
    free = basis
    if turning is not None:
        along = np.linalg.lstsq(basis, turning, rcond=None)[0]
        _, _, rest = np.linalg.svd(along[None])
        free = basis @ rest[1:].T
    return np.asarray(free @ np.linalg.solve(free.T @ stiffness @ free, free.T @ force))


def _damping(found: Vibration) -> tuple[FloatArray, float]:
    """Matrix of viscous damping of every mode alike, N·s/mm, and loss factor: one of them zero."""
    damping = found.drive.damping
    nothing = np.zeros_like(found.mean_mass)
    if damping is None or damping.ratio is None:
        return nothing, 0.0 if damping is None else damping.loss_factor or 0.0
    rigid = None if found.input_is_held else found.motion.rigid
    modes = solve_modes(found.mean_stiffness, found.mean_mass, found.basis, rigid)
    each = 2.0 * damping.ratio * 2.0 * np.pi * modes.frequency
    on_modes = found.mean_mass @ modes.shapes
    return np.asarray((on_modes * each) @ on_modes.T), 0.0


def _orders(found: Vibration) -> FloatArray:
    return np.array([order.value for order in found.spectrum.orders])


def _deviation(found: Vibration) -> FloatArray:
    """Row of the transmission error: the rotation of the output less what that of the input makes of it."""
    motion = found.motion
    ratio = float(motion.output_turns @ motion.rigid) / float(motion.input_turns @ motion.rigid)
    return np.asarray(motion.output_turns - ratio * motion.input_turns)


def _quasi_static(found: Vibration) -> ComplexArray:
    """Orders of the quasi-static motion of all coordinates with the input turning evenly, seen from the crank, shape
    (coordinates, orders).
    """
    motion = found.motion
    moved = np.zeros((found.walked_angle.size, motion.size))
    moved[:, : motion.pose.size] = found.walked_pose
    moved[:, motion.crank] = found.walked_lag
    evenly = moved @ motion.input_turns / float(motion.input_turns @ motion.rigid)
    moved -= evenly[:, None] * motion.rigid
    moved = np.einsum("pji,pj->pi", motion.turned(found.walked_angle), moved)
    return np.asarray(order_amplitudes(found.walked_angle, moved, found.spectrum.orders).T)


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


@dataclass(frozen=True, slots=True, kw_only=True)
class _Loads:
    """Loads at rest over a turn, and their derivatives by the coordinates."""

    angle: FloatArray
    wheel: FloatArray
    mean_wheel: float
    kinds: dict[str, tuple[ComplexArray, ComplexArray]]

    @classmethod
    def at_load(cls, found: Vibration, model: Reducer) -> _Loads:
        """Balance a turn at the load and difference it."""
        drive, motion = found.drive, found.motion
        angle = position_angles(POSITIONS)
        still = solve_at_output(model, [drive], angle, drive.load.torque)
        contacts = replace(model, stage=None, friction=None, external=None)
        lever = levers(model, motion, np.atleast_2d(lever_arms(model))[0])
        start = Start.after(still.response)
        at_rest = _kinds(model, angle, still.response)
        slopes: dict[str, list[Any]] = {kind: [] for kind in at_rest}
        wheel = []
        for place in range(motion.size):
            ends = []
            step = STEP / lever[place]
            for sense in (-1.0, 1.0):
                pose, turned = still.pose.copy(), angle.copy()
                if place < motion.pose.size:
                    pose[:, place] += sense * step
                elif place == motion.crank:
                    turned = angle + sense * step
                ends.append((turned, contacts.respond(turned, pose, start)))
            (low_angle, low), (high_angle, high) = ends
            below, above = _kinds(model, low_angle, low), _kinds(model, high_angle, high)
            for kind, values in slopes.items():
                values.append((above[kind] - below[kind]) / (2.0 * step))
            wheel.append((high.force[:, WHEEL_ANGLE] - low.force[:, WHEEL_ANGLE]) / (2.0 * step))
        kinds = {kind: (at_rest[kind], np.stack(values, axis=-1)) for kind, values in slopes.items()}
        moment = contacts.respond(angle, still.pose, start).force[:, WHEEL_ANGLE]
        return cls(angle=angle, wheel=np.stack(wheel, axis=-1), mean_wheel=float(np.mean(moment)), kinds=kinds)

    def torque_ratio(self, moved: FloatArray) -> FloatArray:
        """Largest departure of the moment on the wheel by its mean, shape (speeds,), of motions of shape (speeds, coordinates,
        positions).
        """
        changes = np.einsum("pn,snp->sp", self.wheel, moved)
        return np.asarray(np.abs(changes).max(axis=1) / abs(self.mean_wheel))

    def factors(self, moved: FloatArray) -> dict[str, FloatArray]:
        """Largest load in motion by the largest at rest, by kind, shape (speeds,)."""
        by_position = moved.transpose(2, 1, 0)
        found = {}
        for kind, (at_rest, slope) in self.kinds.items():
            whole = at_rest[:, :, None] + np.matmul(slope, by_position)
            # A contact that is open has no slope; one that the linear motion would pull has no load.
            sizes = np.abs(whole) if np.iscomplexobj(whole) else np.maximum(whole, 0.0)
            found[kind] = sizes.max(axis=(0, 1)) / np.abs(at_rest).max()
        return found


def _kinds(model: Reducer, angle: FloatArray, response: Response) -> dict[str, Any]:
    """Loads by kind, shape (positions, parts)."""
    bearing = bearing_forces(model, angle, response).reshape(angle.size, -1)
    each = (response.pin_load, response.rollers.outer_load, response.hole_load, bearing)
    return {kind: values for kind, values in zip(KINDS, each, strict=True) if values.size}


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
                "name": vibration.spectrum.orders[place].name,
                "amplitude_rad": found.order_amplitude[:, place].tolist(),
            }
            for place in orders
        ],
        "torque_ratio": found.torque_ratio.tolist(),
        "contacts_part_from_rpm": found.parts_from,
        "dynamic_factor": {kind.replace(" ", "_"): values.tolist() for kind, values in found.factors.items()},
    }
