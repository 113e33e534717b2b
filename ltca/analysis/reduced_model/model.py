"""A reduced model of a drive: what its tables hold, and how far the law by them is from the analysis they are made of."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.optimize import brentq

from ltca.analysis.engines import Engine, describe_engine, lent_words
from ltca.analysis.friction.hysteresis import LEAST_TORQUE_RATIO, locked_path
from ltca.analysis.half_space_errors import half_space_words
from ltca.analysis.reduced_model.hysteresis_elements import (
    NO_ELEMENTS,
    NO_FACTOR,
    HysteresisElements,
    StrengthFactor,
    fit_elements,
)
from ltca.analysis.reduced_model.input_friction import (
    POSITIONS,
    TORQUE_PARTS as FRICTION_PARTS,
    InputFriction,
    input_friction,
)
from ltca.analysis.reduced_model.reduced_drive import ReducedDrive
from ltca.analysis.reduced_model.wind_up import (
    TORQUE_PARTS as WIND_UP_PARTS,
    WindUp,
    frictionless,
    scattered_angles,
    scattered_by,
    wind_up,
    wind_up_orders,
)
from ltca.analysis.transmission_error_orders import Order, known_orders
from ltca.arrays import FloatArray
from ltca.drive.members.temperatures import warm_drive
from ltca.drive.parts import Drive
from ltca.drive.unit_mistakes import names_unit_mistakes
from ltca.dynamics.kinetics import ReflectedInertia, reflected_inertia
from ltca.dynamics.masses import INERTIA, drive_masses
from ltca.equilibrium.output_angle import wheel_angle_of_input
from ltca.equilibrium.output_torque import solve_at_output
from ltca.output.provenance import code_version

NEWTON_METRE = 1e3
"""N·mm of 1 N·m."""
NOT_IDENTIFIED = (
    "orders without a name are below the residual of the fit: the table needs these terms, but they are not identified as "
    "motions of the drive"
)
"""Meaning of ``identified = false``."""
FORMAT = 3
"""Of the JSON file; a later one says so."""
BRISTLE_ANGLE = 1e-3
"""Angle of the input over which its friction builds up in the reduced law, rad; at the output it is less by the ratio."""
LOOP_PARTS = (0.01, 0.03, 0.06, 0.12, 0.2, 0.3, 0.4, 0.5, 0.6, 0.68, 0.74, 0.79, 0.84, 0.88, 0.92, 0.96, 1.0)
"""Torques of the loop by the largest one, either way."""
LOOP_ANGLES = 24
"""Crank angles over all turns whose loops the elements are fitted to."""
JUDGED_ANGLES = 6
"""Of them, that choose the orders of their weights."""
FACTOR_POSITIONS = 3
"""Positions for each unknown of the factor of that strength."""
LEAST_VARIATION = 0.002
"""Range over the crank angle of the part of the largest torque that friction holds, up to which there is no factor: 0.1 % of the
torque range."""
RISING_PARTS = (0.06, 0.2, 0.45, 0.7, 1.0)
"""Torques by which the largest one is reached there: with ten of them the wind-up at the last differs by less than 0.01′."""
FACTOR_HARMONICS = 1
"""Multiples of each origin of an order of the strength of the elements."""
WEIGHT_HARMONICS = 4
"""The same of their weights: with few holes the contacts that carry, and so the release, change by leaps."""
OTHER_ANGLES = 12
"""Crank angles besides, of loops and of the path that they are not fitted to."""
OTHER_PATH = (
    0.01, 0.03, 0.08, 0.15, 0.22, 0.3, 0.38, 0.46, 0.54, 0.62, 0.71, 0.8, 0.75, 0.7, 0.65, 0.6, 0.53, 0.47, 0.41, 0.35,
    0.42, 0.49, 0.55, 0.62, 0.68, 0.74, 0.8, 0.76, 0.72, 0.68, 0.63, 0.57, 0.5, 0.4, 0.3, 0.2, 0.12, 0.05, 0.01,
    -0.01, -0.03, -0.08, -0.15, -0.22, -0.3, -0.4, -0.5, -0.6, -0.7, -0.65, -0.6, -0.5, -0.4, -0.3, -0.2, -0.1, -0.03, -0.01,
    0.01, 0.03, 0.08, 0.15, 0.22, 0.3, 0.4, 0.5,
)  # fmt: skip
"""That path, by the largest torque: reversals within the loop. Its steps are small: contacts that open or slip within a step are
taken as at its end, and with steps twice as long the wind-up of the analysis itself differs by 0.01′ (of robot-joint with
friction 0.05 after a reversal), as much as the law does."""
CHECKED_PARTS = (2e-3, 0.02, 0.08, 0.21, 0.43, 0.68, 0.94)
"""Torques without friction between those of the table, by the largest one, either way."""
LEAST_TOLD = 1e-3
"""Torque by the largest one up to which angles are not compared: at the edge of the play a torque of nearly nothing turns the
output through all of it."""
CHECKED_ANGLES = 2.0 * np.pi * np.array([0.137, 0.411, 0.893, 1.271, 3.083, 7.357, 11.618])
"""Crank angles between those of the table, rad, within its first turn and beyond."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FitError:
    """How far the reduced law is from the analysis along paths of torque.

    Attributes
    ----------
    torque : float
        Largest difference at the wind-up of the analysis, N·mm.
    angle : float
        Largest difference at the torque of the analysis, rad.
    mean_torque, mean_angle : float
        The largest along the path of their means over the crank angles: what is off of the loop of a mean crank angle.
    scatter_torque, scatter_angle : float
        The largest along the path of their standard deviations over the crank angles.
    angles : int
        Crank angles at which paths were compared.
    points : int
        Points that were compared, of all of them.
    """

    torque: float
    angle: float
    mean_torque: float
    mean_angle: float
    scatter_torque: float
    scatter_angle: float
    angles: int
    points: int

    @classmethod
    def of_differences(cls, torque: FloatArray, angle: FloatArray) -> FitError:
        """Return the error by differences at crank angles and points of a path.

        Parameters
        ----------
        torque, angle : array, shape (angles, points)
            N·mm, and rad, nan where angles are not compared.
        """
        compared = angle[:, ~np.isnan(angle).any(axis=0)]
        return cls(
            torque=float(np.max(np.abs(torque))),
            angle=float(np.max(np.abs(compared))),
            mean_torque=float(np.max(np.abs(np.mean(torque, axis=0)))),
            mean_angle=float(np.max(np.abs(np.mean(compared, axis=0)))),
            scatter_torque=float(np.max(np.std(torque, axis=0))),
            scatter_angle=float(np.max(np.std(compared, axis=0))),
            angles=torque.shape[0],
            points=torque.size,
        )

    def content(self, largest: float) -> dict[str, float]:
        """Return it as files hold it; parts are those of the torque range from −`largest` to `largest`, N·mm."""
        return {
            "torque_N_m": self.torque / NEWTON_METRE,
            "part_of_torque_range": 0.5 * self.torque / largest,
            "angle_rad": self.angle,
            "mean_over_crank_angle_part_of_torque_range": 0.5 * self.mean_torque / largest,
            "mean_over_crank_angle_rad": self.mean_angle,
            "scatter_over_crank_angle_part_of_torque_range": 0.5 * self.scatter_torque / largest,
            "scatter_over_crank_angle_rad": self.scatter_angle,
            "crank_angles": self.angles,
            "points": self.points,
        }


@dataclass(frozen=True, slots=True, kw_only=True)
class ReducedModel:
    """A drive as a simulator holds it.

    Attributes
    ----------
    drive : Drive
        At its temperatures.
    engine : Engine
        What it was solved on.
    largest : float
        Largest torque of the tables, N·mm.
    wind_up : WindUp
        Without friction.
    elements : HysteresisElements
        None without friction.
    strength_factor : StrengthFactor
        Of the elements over the crank angle.
    friction : InputFriction
        Zero without friction.
    inertia : ReflectedInertia or None
        None where a density is not known.
    without_density : tuple of str
        Materials whose density is not known.
    errors : dict of str to FitError
        ``without_friction`` at other torques and crank angles than those of the tables; of a drive with friction
        ``loop`` along the loops that the elements are fitted to, ``other_loops`` along loops at other crank angles and
        ``other_path`` along a path with reversals there.
    """

    drive: Drive
    engine: Engine
    largest: float
    wind_up: WindUp
    elements: HysteresisElements
    strength_factor: StrengthFactor
    friction: InputFriction
    inertia: ReflectedInertia | None
    without_density: tuple[str, ...]
    errors: dict[str, FitError]

    @property
    def speed(self) -> float | None:
        """Largest speed of the input that the file gives, turns a minute: of ``[[duty]]``, else ``load.speed``."""
        return largest_speed(self.drive)

    @property
    def damping(self) -> tuple[float | None, str]:
        """Damping beside the spring of the wind-up at the output, N·mm·s/rad, and in words why, or why not."""
        given, inertia = self.drive.damping, self.inertia
        if given is None:
            return None, "the drive file has no [damping]"
        if inertia is None:
            return None, f"densities are not given: {', '.join(self.without_density)}"
        if not inertia.given_output:
            return None, "inertia.output is not given, with which the drive would vibrate"
        at_input = inertia.at_output + inertia.given_input * self.drive.transmission_ratio**2
        freely = self.drive.inertia is not None and self.drive.inertia.input is not None
        moving = inertia.given_output * at_input / (inertia.given_output + at_input) if freely else inertia.given_output
        value = 2.0 * given.ratio_at_resonance * float(np.sqrt(self.wind_up.stiffness * moving))
        held = "input and output free" if freely else "input held, since inertia.input is not given"
        return value, f"2 ζ √(k J) with ζ = {given.ratio_at_resonance:g}, {held}"

    @property
    def worst(self) -> FitError:
        """The largest error of all."""
        every = self.errors.values()
        return FitError(
            torque=max(one.torque for one in every),
            angle=max(one.angle for one in every),
            mean_torque=max(one.mean_torque for one in every),
            mean_angle=max(one.mean_angle for one in every),
            scatter_torque=max(one.scatter_torque for one in every),
            scatter_angle=max(one.scatter_angle for one in every),
            angles=max(one.angles for one in every),
            points=sum(one.points for one in every),
        )

    @property
    def spring_error(self) -> float:
        """Largest difference of a linear spring behind the mean play from the mean curve, N·mm."""
        low, high = self.wind_up.stops
        mean = self.wind_up.mean
        spring = self.wind_up.stiffness * np.where(mean > high, mean - high, np.where(mean < low, mean - low, 0.0))
        return float(np.max(np.abs(spring - self.wind_up.torque)))

    @property
    def content(self) -> dict[str, Any]:
        """The model as its JSON file holds it: N·m, rad, kg·m², s."""
        return _content(self)


def largest_speed(drive: Drive) -> float | None:
    """Return the largest speed of the input that a drive gives, turns a minute; None where it gives none."""
    speeds = [entry.speed for entry in drive.duty]
    return max(speeds) if speeds else drive.load.speed


def positions_of(drive: Drive) -> int:
    """Return how many positions are solved for a reduced model, those of the strength factor counted in."""
    drive = warm_drive(drive)
    found = 2 * len(WIND_UP_PARTS) * scattered_angles(drive, len(wind_up_orders(drive))).size
    if drive.friction is None:
        return found
    around = scattered_angles(drive, len(known_orders(drive, harmonics=FACTOR_HARMONICS)), FACTOR_POSITIONS).size
    loops = (LOOP_ANGLES + OTHER_ANGLES) * (1 + len(LOOP_PARTS) + 2 * (2 * len(LOOP_PARTS) - 1))
    paths = loops + OTHER_ANGLES * (1 + len(OTHER_PATH)) + 2 * around * (1 + len(RISING_PARTS))
    return found + 4 * len(FRICTION_PARTS) * POSITIONS + paths


@names_unit_mistakes
def reduce_drive(drive: Drive, engine: Engine, advance: Callable[[int], None] = lambda _: None) -> ReducedModel:
    """Reduce a drive.

    Parameters
    ----------
    drive : Drive
        Its torque is the rated one; the tables go up to the largest of ``[[duty]]``, too.
    engine : Engine
        How bodies yield.
    advance : callable
        Told of solved positions.

    Returns
    -------
    ReducedModel

    Raises
    ------
    ConvergenceError
        When a position does not balance.
    DriveError
        When the torque is zero.
    """
    warm = warm_drive(drive)
    warm.require_torque("a reduced model, whose tables go up to it")
    engine = engine.with_coefficients(warm)
    largest = max([warm.load.torque, *(entry.torque for entry in warm.duty)])
    model = frictionless(engine.prepare(warm).model)
    masses = drive_masses(drive)
    found = ReducedModel(
        drive=warm,
        engine=engine,
        largest=largest,
        wind_up=wind_up(warm, model, largest, advance),
        elements=NO_ELEMENTS,
        strength_factor=NO_FACTOR,
        friction=input_friction(warm, engine, largest, advance),
        inertia=reflected_inertia(drive, masses),
        without_density=masses.without_density,
        errors={},
    )
    errors = {"without_friction": _error_without_friction(found)}
    if warm.friction is not None:
        found, of_paths = _with_elements(found, advance)
        errors |= of_paths
    return replace(found, errors=errors)


def law_of(found: ReducedModel) -> ReducedDrive:
    """Return the law with the tables of a reduced model, in N·m and rad."""
    return ReducedDrive(found.content)


def _error_without_friction(found: ReducedModel) -> FitError:
    drive, model = found.drive, frictionless(found.engine.prepare(found.drive).model)
    size = found.largest * np.array(CHECKED_PARTS)
    load = np.concatenate([size[::-1], -size])
    angle, torque = np.repeat(CHECKED_ANGLES, load.size), np.tile(load, CHECKED_ANGLES.size)
    balanced = solve_at_output(model, [drive], angle, torque)
    wound = drive.output_deviation(wheel_angle_of_input(model, balanced), torque)
    shape = (CHECKED_ANGLES.size, load.size)
    return _along(law_of(found), CHECKED_ANGLES, wound.reshape(shape), drive.load_sign * load, found.largest)


def _with_elements(found: ReducedModel, advance: Callable[[int], None]) -> tuple[ReducedModel, dict[str, FitError]]:
    """Fit the elements to loops with the input locked; compare with these and with another path."""
    drive, way = found.drive, found.drive.load_sign
    up = np.array(LOOP_PARTS)
    once = np.concatenate([-up[::-1], up])
    loop = np.concatenate([[LEAST_TORQUE_RATIO], up, once[::-1][1:], once[1:]])
    other = np.array([LEAST_TORQUE_RATIO, *OTHER_PATH])
    angles = scattered_by(drive, LOOP_ANGLES + OTHER_ANGLES)
    fitted_to, beside = angles[:LOOP_ANGLES], angles[LOOP_ANGLES:]
    of_loops = locked_path(drive, angles, found.largest * loop, engine=found.engine, advance=advance)
    of_other = locked_path(drive, beside, found.largest * other, engine=found.engine, advance=advance)
    torque = way * found.largest * loop

    law = law_of(found)
    sprung = np.array([[_elastic(law, at, one) for one in path] for at, path in zip(angles, of_loops, strict=True)])
    ends = [int(np.argmax(sign * torque)) for sign in (-1.0, 1.0)]
    held = [torque[end] / sprung[:, end] - 1.0 for end in ends]
    orders = known_orders(drive, harmonics=FACTOR_HARMONICS)
    if max(float(np.ptp(part)) for part in held) > LEAST_VARIATION:
        found = replace(found, strength_factor=_strength_factor(found, orders, advance))
        law = law_of(found)
    elements = fit_elements(
        list(sprung[:LOOP_ANGLES]),
        [torque] * LOOP_ANGLES,
        drive.load.torque,
        [law.strength_factors(at / law.cranks)[::-1] for at in fitted_to.tolist()],
        fitted_to,
        tuple(order.value for order in known_orders(drive, harmonics=WEIGHT_HARMONICS)),
        JUDGED_ANGLES,
    )
    fitted = replace(found, elements=elements)
    own, along = law_of(fitted), way * found.largest * other
    return fitted, {
        "loop": _along(own, fitted_to, of_loops[:LOOP_ANGLES], torque, found.largest),
        "other_loops": _along(own, beside, of_loops[LOOP_ANGLES:], torque, found.largest),
        "other_path": _along(own, beside, of_other, along, found.largest),
    }


def _strength_factor(found: ReducedModel, orders: tuple[Order, ...], advance: Callable[[int], None]) -> StrengthFactor:
    """Factor of the crank angle by what friction holds after the largest torque has come slowly, either way."""
    drive, law, way = found.drive, law_of(found), found.drive.load_sign
    around = scattered_angles(drive, len(orders), FACTOR_POSITIONS)
    held = []
    for of_load in (-way, way):  # torque on the output negative, then positive
        rising = np.concatenate([[LEAST_TORQUE_RATIO], RISING_PARTS]) * of_load * found.largest
        wound = locked_path(drive, around, rising, engine=found.engine, advance=advance)[:, -1]
        sprung = np.array([_elastic(law, angle, one) for angle, one in zip(around, wound, strict=True)])
        held.append(way * rising[-1] / sprung - 1.0)
    return StrengthFactor.fitted(around, held, orders)


def _elastic(law: ReducedDrive, crank_angle: float, wound: float) -> float:
    """Elastic torque at a crank angle and a wind-up, N·mm."""
    at = crank_angle / law.cranks
    return NEWTON_METRE * law.elastic_torque(at, at / law.ratio + wound)


def _along(
    law: ReducedDrive, crank_angle: FloatArray, wound: FloatArray, torque: FloatArray, largest: float
) -> FitError:
    """Errors of the law along a path of torques, N·mm, whose wind-up is given at each crank angle, shape (angles, points)."""
    in_torque, in_angle = np.empty(wound.shape), np.full(wound.shape, np.nan)
    told = np.abs(torque) > LEAST_TOLD * largest
    for row, (one, path) in enumerate(zip((crank_angle / law.cranks).tolist(), wound.tolist(), strict=True)):
        law.reset()
        for place, (at, value) in enumerate(zip(path, torque.tolist(), strict=True)):
            if told[place]:
                in_angle[row, place] = wind_up_at(law, one, value / NEWTON_METRE) - at
            in_torque[row, place] = NEWTON_METRE * law.move(one, one / law.ratio + at) - value
    return FitError.of_differences(in_torque, in_angle)


def wind_up_at(law: ReducedDrive, input_angle: float, torque: float) -> float:
    """Return the wind-up at which the law, from its state, holds a torque; the state stays.

    Parameters
    ----------
    law : ReducedDrive
        The law.
    input_angle : float
        rad.
    torque : float
        On the output, N·m.
    """
    nodes, at = law.wind_up_nodes(input_angle), input_angle / law.ratio
    span = nodes[-1] - nodes[0]
    ends = float(nodes[0] - span), float(nodes[-1] + span)
    return float(brentq(lambda wound: law.torque_of(input_angle, at + wound) - torque, *ends, xtol=1e-12))


def _content(found: ReducedModel) -> dict[str, Any]:
    drive, table, friction, inertia = found.drive, found.wind_up, found.friction, found.inertia
    ratio, speed = drive.transmission_ratio, found.speed
    damping, why = found.damping
    factor = found.strength_factor
    words = half_space_words(found.engine, drive) or lent_words(found.engine, drive)
    back = {name: friction.driving_back_torque(way) for name, way in (("ccw", 1.0), ("cw", -1.0))}
    return {
        "format": FORMAT,
        "drive": drive.name,
        "case": drive.case,
        "fingerprint": drive.fingerprint(),
        "cyclo_version": code_version(),
        "engine": describe_engine(found.engine),
        **({"engine_remark": words} if words else {}),
        "held": drive.installation.held,
        "transmission_ratio": ratio,
        "crank_turns_per_input_turn": drive.crank_turns_per_input,
        "valid_range": {
            "torque_N_m": [-found.largest / NEWTON_METRE, found.largest / NEWTON_METRE],
            "input_speed_rpm": [0.0 if speed is None else -speed, 0.0 if speed is None else speed],
            "speed_words": "the tables are quasi-static: inertia of single parts, oil films and heat are not in them"
            + ("; the drive file gives no speed (load.speed, [[duty]])" if speed is None else ""),
        },
        "fit_error": {
            **{name: one.content(found.largest) for name, one in found.errors.items()},
            **({"worst": found.worst.content(found.largest)} if found.errors else {}),
        },
        "limits": {
            "rated_torque_N_m": drive.load.torque / NEWTON_METRE,
            "peak_torque_N_m": found.largest / NEWTON_METRE,
            "peak_torque_from": "[[duty]]" if found.largest > drive.load.torque else "load.torque",
            "input_speed_rpm": speed,
        },
        "wind_up": {
            "torque_N_m": (table.torque / NEWTON_METRE).tolist(),
            "mean_rad": table.mean.tolist(),
            "residual_rms_rad": table.residual.tolist(),
            "orders": [
                {
                    "order": order.value,
                    "name": order.name,
                    "identified": bool(order.name),
                    "cos_rad": table.cosine[place].tolist(),
                    "sin_rad": table.sine[place].tolist(),
                }
                for place, order in enumerate(table.orders)
            ],
            "not_identified": {
                "count": sum(not order.name for order in table.orders),
                "rms_rad": table.unidentified.tolist(),
                "words": NOT_IDENTIFIED,
            },
            "turns": table.turns,
            "positions": table.positions,
        },
        "linear_spring": {
            "play_rad": table.play,
            "stops_rad": list(table.stops),
            "stiffness_N_m_per_rad": table.stiffness / NEWTON_METRE,
            "torque_error_N_m": found.spring_error / NEWTON_METRE,
            "part_of_torque_range": 0.5 * found.spring_error / found.largest,
        },
        "hysteresis": {
            "flank": found.elements.flank.tolist(),
            "exponent": found.elements.exponent.tolist(),
            "strength": found.elements.strength.tolist(),
            "stiffness": found.elements.stiffness.tolist(),
            "weight_order": found.elements.order.tolist(),
            "weight_amplitude": found.elements.amplitude.tolist(),
            "weight_phase_rad": found.elements.phase.tolist(),
            "factor_orders": [
                {
                    "order": order.value,
                    "name": order.name,
                    "identified": bool(order.name),
                    "cos_ccw": float(factor.cosine[1, place]),
                    "sin_ccw": float(factor.sine[1, place]),
                    "cos_cw": float(factor.cosine[0, place]),
                    "sin_cw": float(factor.sine[0, place]),
                }
                for place, order in enumerate(factor.orders)
            ],
        },
        "friction": {
            "torque_N_m": (friction.torque / NEWTON_METRE).tolist(),
            "at_input_turning_ccw_N_m": (friction.ccw / NEWTON_METRE).tolist(),
            "at_input_turning_cw_N_m": (friction.cw / NEWTON_METRE).tolist(),
            "efficiency_input_driving": friction.efficiency.tolist(),
            "efficiency_output_driving": friction.efficiency_driven_back.tolist(),
            "no_equilibrium_output_driving": friction.locked.tolist(),
            "driving_back_torque_N_m": {
                name: None if value is None else value / NEWTON_METRE for name, value in back.items()
            },
            "speed_words": "the coefficients of [friction] do not go with speed, and neither does the table",
            "bristle_angle_rad": BRISTLE_ANGLE,
        },
        "inertia": {
            "at_input_kg_m2": None if inertia is None else inertia.at_input / INERTIA,
            "at_output_kg_m2": None if inertia is None else inertia.at_output / INERTIA,
            "given_input_kg_m2": None if inertia is None else inertia.given_input / INERTIA,
            "given_output_kg_m2": None if inertia is None else inertia.given_output / INERTIA,
            "given_output_mass_kg": None if drive.inertia is None else drive.inertia.output_mass,
            "words": "of the parts that move, as rigid ones, referred to the input or to the output: the same inertia twice"
            if inertia is not None
            else f"densities are not given: {', '.join(found.without_density)}",
        },
        "damping": {"at_output_N_m_s_per_rad": None if damping is None else damping / NEWTON_METRE, "words": why},
    }
