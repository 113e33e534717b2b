"""Vibrations of a drive about its loaded positions: modes over a turn and over torque, orders that excite them, critical speeds.

The drive is balanced without friction at crank angles of one turn and at several torques; about each position it vibrates with
the stiffness and the masses that it has there, as if the crank stood (`ltca.dynamics`). Orders of the transmission error,
counted by turn of the crank against the pin shaft, meet an eigenfrequency at the critical speeds.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ltca.analysis.drive_curves import known_orders_of, positions_per_turn
from ltca.analysis.engines import Engine
from ltca.analysis.force_orders import ForceFit, ForceSpectrum, force_content, single_forces
from ltca.analysis.memory_need import positions_together
from ltca.analysis.transmission_error_orders import Order, Spectrum, fit_orders
from ltca.arrays import FloatArray
from ltca.drive.members.temperatures import warm_drive
from ltca.drive.parts import Drive
from ltca.drive.unit_mistakes import names_unit_mistakes
from ltca.dynamics.harmonic_balance import PulsatingStiffness
from ltca.dynamics.kinetics import Motion, mass_matrix, moving_bodies, require_masses
from ltca.dynamics.masses import drive_masses
from ltca.dynamics.modes import Modes, free_coordinates, mode_words, solve_modes
from ltca.dynamics.stiffness import levers, stiffness_matrices
from ltca.equilibrium.output_angle import crank_lag, wheel_angle_of_input
from ltca.equilibrium.output_torque import solve_at_output
from ltca.equilibrium.reducer import Reducer
from ltca.errors import DriveError
from ltca.geometry.placement import position_angles

TORQUE_PARTS = (0.1, 0.25, 0.5, 0.75, 1.0)
"""Torques at which modes are told, by that of the load."""
POSITIONS = 24
"""Crank angles of a turn at which modes are told."""
TOLD_ORDERS = 8
"""Orders of the transmission error, the largest, that critical speeds are told of."""
FASTEST = 3000.0
"""Speed of the input up to which critical speeds are told of a drive that gives none, turns a minute."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CriticalSpeed:
    """Speed at which an order of the transmission error meets an eigenfrequency.

    Attributes
    ----------
    speed, slowest, fastest : float
        Of the input by the mean frequency over a turn, and by the least and the largest one, turns a minute.
    order : Order
        By turn of the crank against the pin shaft.
    amplitude : float
        Of that order in the transmission error, rad.
    mode : int
        Number of the mode.
    in_duty : bool
        Whether its range meets that of the speeds of ``[[duty]]``, or of ``load.speed``.
    """

    speed: float
    slowest: float
    fastest: float
    order: Order
    amplitude: float
    mode: int
    in_duty: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class Vibration:
    """Vibrations of a drive.

    Attributes
    ----------
    drive : Drive
        Warm.
    engine : Engine
        What it ran on.
    motion : Motion
        Coordinates.
    torque : array, shape (torques,)
        On the output, ascending, the load last, N·mm.
    crank_angle : array, shape (positions,)
        φ_C, rad.
    frequency : array, shape (torques, positions, modes)
        Eigenfrequencies, Hz, ascending at every position; without the free turning of the whole drive.
    words : tuple of str
        What moves in each mode at the load and crank angle 0.
    shapes : array, shape (coordinates, modes)
        The same as coordinates, mm and rad, mass-normalised (t·mm²).
    stiffness : PulsatingStiffness
        K at the load in the frame that turns with the crank (`Motion.turned`), mean of the turns behind the spectrum.
    stiffness_rest : float
        Of it what does not come again after a turn, as root mean square by the mean.
    mean_mass : array, shape (coordinates, coordinates)
        M in that frame, mean over the turn.
    basis : array, shape (coordinates, free coordinates)
        Motions that are free in that frame.
    spectrum : Spectrum
        Orders of the transmission error at the load.
    turns : int
        Crank turns behind it.
    walked_angle : array, shape (walked,)
        φ_C over these turns, rad.
    walked_pose : array, shape (walked, pose)
        Balanced poses there.
    walked_lag : array, shape (walked,)
        Angle of the cranks less the one that the held input gives them, rad.
    forces : tuple of ForceSpectrum
        Spectra of all single forces there, at rest.
    """

    drive: Drive
    engine: Engine
    motion: Motion
    torque: FloatArray
    crank_angle: FloatArray
    frequency: FloatArray
    words: tuple[str, ...]
    shapes: FloatArray
    stiffness: PulsatingStiffness
    stiffness_rest: float
    mean_mass: FloatArray
    basis: FloatArray
    spectrum: Spectrum
    turns: int
    walked_angle: FloatArray
    walked_pose: FloatArray
    walked_lag: FloatArray
    forces: tuple[ForceSpectrum, ...]

    @property
    def input_is_held(self) -> bool:
        """Whether the input turns evenly, since its inertia is not given."""
        return holds_input(self.drive)

    @property
    def ends_words(self) -> str:
        """What stands in front of the drive and behind it, in words."""
        given = self.drive.inertia
        before = "input turns evenly" if self.input_is_held else "input turns freely with inertia.input"
        behind = given is not None and given.output is not None
        return f"{before}, {'inertia.output behind the output' if behind else 'nothing behind the output (inertia.output)'}"

    @property
    def at_load(self) -> FloatArray:
        """Eigenfrequencies at the load, Hz, shape (positions, modes)."""
        return np.asarray(self.frequency[-1])

    @property
    def input_orders(self) -> FloatArray:
        """Fitted orders by turn of the input, shape (orders,)."""
        ratio = abs(self.drive.crank_turns_per_input)
        return np.array([ratio * order.value for order in self.spectrum.orders])

    @property
    def told_orders(self) -> tuple[int, ...]:
        """Places of the largest orders of the transmission error, largest first."""
        amplitude, groups = self.spectrum.resolved().amplitude, self.spectrum.groups
        largest = [max(places, key=lambda place: self.spectrum.amplitude[place]) for places in groups]
        return tuple(largest[group] for group in np.argsort(-amplitude, kind="stable")[:TOLD_ORDERS])

    def told_as(self, place: int) -> tuple[Order, float]:
        """Return an order and its amplitude, rad, together with those that the turns do not tell from it."""
        group = next(number for number, places in enumerate(self.spectrum.groups) if place in places)
        order = Order(self.spectrum.orders[place].value, self.spectrum.names[place])
        return order, float(self.spectrum.resolved().amplitude[group])

    def critical_speeds(self, fastest: float | None = None) -> tuple[CriticalSpeed, ...]:
        """Return the critical speeds up to a speed of the input, turns a minute, ascending.

        Parameters
        ----------
        fastest : float, optional
            `speed_range` of the drive by default.
        """
        low, high = speed_range(self.drive)
        top, found = high if fastest is None else fastest, []
        known = bool(self.drive.duty or self.drive.load.speed is not None)
        for place in self.told_orders:
            order, (told, amplitude) = self.input_orders[place], self.told_as(place)
            for mode in range(self.at_load.shape[1]):
                speeds = 60.0 * self.at_load[:, mode] / order
                slowest, mean, largest = float(speeds.min()), float(speeds.mean()), float(speeds.max())
                if slowest > top:
                    continue
                found.append(
                    CriticalSpeed(
                        speed=mean,
                        slowest=slowest,
                        fastest=largest,
                        order=told,
                        amplitude=amplitude,
                        mode=mode,
                        in_duty=known and largest >= low and slowest <= high,
                    )
                )
        return tuple(sorted(found, key=lambda one: (one.speed, one.mode)))


def holds_input(drive: Drive) -> bool:
    """Return whether the input of a drive turns evenly, since its inertia is not given."""
    return drive.inertia is None or drive.inertia.input is None


def speed_range(drive: Drive) -> tuple[float, float]:
    """Return least and largest speed of the input, turns a minute: of ``[[duty]]``, else ``load.speed`` twice, else 0 and
    `FASTEST`.
    """
    speeds = [entry.speed for entry in drive.duty] or ([] if drive.load.speed is None else [drive.load.speed])
    return (min(speeds), max(speeds)) if speeds else (0.0, FASTEST)


def walked_positions(drive: Drive, positions: int) -> int:
    """Return the crank angles of each turn behind orders and pulsation, an even number: those asked for, or the more that the
    highest order of the transmission error needs.
    """
    each = max(positions, positions_per_turn(drive))
    return each + each % 2


@names_unit_mistakes
def vibration(
    drive: Drive,
    *,
    engine: Engine,
    positions: int = POSITIONS,
    torque_parts: Sequence[float] = TORQUE_PARTS,
    turns: int,
    advance: Callable[[int], None] = lambda _: None,
) -> Vibration:
    """Return the vibrations of a drive over a turn and over torque.

    Parameters
    ----------
    drive : Drive
        Every density known; its load is the largest torque.
    engine : Engine
        How bodies yield.
    positions : int
        Crank angles of a turn; more of them than the orders of the transmission error need are those of the pulsation too.
    torque_parts : sequence of float
        Torques by that of the load; the whole one is added.
    turns : int
        Crank turns behind the orders of the transmission error.
    advance : callable
        Told of solved positions.

    Returns
    -------
    Vibration

    Raises
    ------
    DriveError
        When a density is missing, the torque is zero, or turns are too few.
    ConvergenceError
        When a position does not balance or is not stable.
    """
    warm = warm_drive(drive)
    warm.require_torque("vibrations, which are those about loaded positions")
    masses, motion = require_masses(drive_masses(drive)), Motion.of_drive(warm)
    model = replace(engine.prepare(drive).model, friction=None)
    angles, parts = position_angles(positions), np.unique([*torque_parts, 1.0])
    row = motion.input_turns if holds_input(drive) else np.zeros(motion.size)
    lever = levers(model, motion)
    basis, turned = free_coordinates(row, lever), motion.turned(angles)
    rigid = None if holds_input(drive) else motion.rigid
    bodies = [moving_bodies(motion, masses, float(angle)) for angle in angles]
    mass = np.array([mass_matrix(each) for each in bodies])
    frequency, found, start = [], list[Modes](), None
    for part in parts[::-1]:
        balanced = solve_at_output(model, [warm], angles, part * warm.load.torque, start)
        start = balanced.pose
        own = stiffness_matrices(model, motion, balanced)
        modes = [solve_modes(k, m, basis, rigid) for k, m in zip(own, mass, strict=True)]
        if part == 1.0:
            found = modes
        first = int(rigid is not None)
        frequency.append([np.sort(each.frequency[first:]) for each in modes])
        advance(positions)
    first, at_zero = int(rigid is not None), found[0]
    shown = first + np.argsort(at_zero.frequency[first:], kind="stable")
    ahead = np.array([disc.geometry.placement.eccentric_direction(angles[:1])[0] for disc in model.discs])
    walked = _walk(model, motion, warm, turns, walked_positions(warm, positions), lever, advance)
    try:
        spectrum = fit_orders(walked.angle, walked.error, known_orders_of(warm))
    except ValueError as problem:
        raise DriveError([f"turns = {turns}: {problem}"]) from problem
    return Vibration(
        drive=warm,
        engine=engine,
        motion=motion,
        torque=warm.load.torque * parts,
        crank_angle=angles,
        frequency=np.array(frequency[::-1]),
        words=tuple(mode_words(motion, bodies[0], at_zero.shapes[:, mode], ahead) for mode in shown),
        shapes=at_zero.shapes[:, shown],
        stiffness=walked.stiffness,
        stiffness_rest=walked.stiffness_rest,
        mean_mass=np.mean(turned.swapaxes(1, 2) @ mass @ turned, axis=0),
        basis=free_coordinates(np.mean(row @ turned, axis=0), lever),
        spectrum=spectrum,
        turns=turns,
        walked_angle=walked.angle,
        walked_pose=walked.pose,
        walked_lag=walked.lag,
        forces=walked.forces,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Walked:
    """Crank angles of some turns, and there, at the load, transmission error, poses, lags of the cranks, spectra of single
    forces, and the stiffness of a mean turn with what departs from it.
    """

    angle: FloatArray
    error: FloatArray
    pose: FloatArray
    lag: FloatArray
    forces: tuple[ForceSpectrum, ...]
    stiffness: PulsatingStiffness
    stiffness_rest: float


def _walk(
    model: Reducer,
    motion: Motion,
    drive: Drive,
    turns: int,
    each: int,
    lever: FloatArray,
    advance: Callable[[int], None],
) -> _Walked:
    """Balance some turns of so many positions at the load."""
    torque = drive.load.torque
    angle = 2.0 * np.pi * np.arange(turns * each) / each
    parts, forces, squares = [], ForceFit(drive, angle), 0.0
    over_turn = np.zeros((each, motion.size, motion.size))
    scale, first = np.outer(lever, lever), 0
    for rows in np.array_split(angle, -(-angle.size // positions_together(drive))):
        found = solve_at_output(model, [drive], rows, torque)
        turned = motion.turned(rows)
        stiffness = turned.swapaxes(1, 2) @ stiffness_matrices(model, motion, found) @ turned
        np.add.at(over_turn, (first + np.arange(rows.size)) % each, stiffness / turns)
        squares += float(np.sum((stiffness / scale) ** 2)) / turns
        error = drive.output_deviation(wheel_angle_of_input(model, found), np.full(rows.size, torque))
        parts.append((error, found.pose, crank_lag(model, found)))
        forces.add(rows, single_forces(model, rows, found.pose, found.response))
        first += rows.size
        advance(rows.size)
    error, pose, lag = (np.concatenate(values) for values in zip(*parts, strict=True))
    kept = float(np.sum((over_turn / scale) ** 2))
    return _Walked(
        angle=angle,
        error=error,
        pose=pose,
        lag=lag,
        forces=forces.solve(),
        stiffness=PulsatingStiffness(over_turn=over_turn),
        stiffness_rest=float(np.sqrt(max(squares - kept, 0.0) / kept)),
    )


def vibration_content(found: Vibration, fastest: float | None = None) -> dict[str, Any]:
    """Return the vibrations of a drive as files hold them.

    Parameters
    ----------
    found : Vibration
        The vibrations.
    fastest : float, optional
        Speed of the input up to which critical speeds are told, turns a minute.
    """
    drive, spectrum = found.drive, found.spectrum
    low, high = speed_range(drive)
    return {
        "input_held": found.input_is_held,
        "damping_ratio": None if drive.damping is None else drive.damping.ratio_at_resonance,
        "torque_N_mm": found.torque.tolist(),
        "crank_angle_rad": found.crank_angle.tolist(),
        "frequency_Hz": found.frequency.tolist(),
        "modes": [
            {
                "number": mode + 1,
                "mean_frequency_Hz": float(found.at_load[:, mode].mean()),
                "least_frequency_Hz": float(found.at_load[:, mode].min()),
                "largest_frequency_Hz": float(found.at_load[:, mode].max()),
                "what_moves": words,
            }
            for mode, words in enumerate(found.words)
        ],
        "transmission_error_orders": {
            "turns": found.turns,
            "orders": [
                {
                    "order": one.value,
                    "by_turn_of_input": float(by_input),
                    "name": name,
                    "amplitude_rad": float(size),
                }
                for one, name, by_input, size in zip(
                    spectrum.orders, spectrum.names, found.input_orders, spectrum.amplitude, strict=True
                )
            ],
            "residual_rms_rad": spectrum.residual,
        },
        "forces_at_rest": force_content(found.forces),
        "speed_range_rpm": [low, high],
        "critical_speeds": [
            {
                "speed_rpm": one.speed,
                "least_rpm": one.slowest,
                "largest_rpm": one.fastest,
                "order": one.order.value,
                "name": one.order.name,
                "amplitude_rad": one.amplitude,
                "mode": one.mode + 1,
                "in_range": one.in_duty,
            }
            for one in found.critical_speeds(fastest)
        ],
    }
