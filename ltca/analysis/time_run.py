r"""A drive run in time: start, steady speed, speed ramp, torque step, reversal through the play, sinusoidal load.

The run begins in balance at crank angle 0, with the friction of the speed it begins with; where it begins at speed all parts
move as slow motion would have them. `ltca.dynamics.motion` has the equations; scipy's DOP853 solves them with its own step and
dense output, of which samples evenly in time are kept. Contacts that close and open set its step: drives
have vibrations up to some 10 kHz, and implicit methods are no cheaper at equal error (``benchmarks/integrators.py``).

The balance of energy is that of input, output, damping, friction, of what is stored, and of the work of contacts that move to
another radius of curvature or over bodies that yield otherwise there (`ltca.mechanics.energy`): their forces act along
the normal alone.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import DOP853

from ltca.analysis.engines import Engine
from ltca.arrays import FloatArray, named_arrays, with_named_arrays
from ltca.drive.members.temperatures import warm_drive
from ltca.drive.parts import Drive
from ltca.dynamics.contact_forces import ContactForces
from ltca.dynamics.kinetic_energy import KineticEnergy
from ltca.dynamics.kinetics import Motion, require_masses
from ltca.dynamics.masses import drive_masses
from ltca.dynamics.massless import MasslessParts
from ltca.dynamics.modes import free_coordinates
from ltca.dynamics.motion import WORKS, Equation, Profile
from ltca.dynamics.stiffness import levers
from ltca.dynamics.teeth import TeethForces
from ltca.equilibrium.output_angle import crank_lag
from ltca.equilibrium.output_torque import solve_at_output
from ltca.errors import ConvergenceError, DamagedFileError, DriveError, Problem
from ltca.mechanics.energy import StoredEnergy

MOTIONS = {
    "steady": "the input turns evenly under the load",
    "start": "from rest to the speed within a time, then evenly",
    "ramp": "from one speed to the other over the whole run",
    "step": "evenly, the torque changes by a factor",
    "reverse": "evenly, the torque changes its sign: through the play",
    "sine": "evenly, the torque swings about the load",
}
VALUES = {
    "steady": (), "start": ("within",), "ramp": ("from_speed",), "step": ("at", "within", "factor"),
    "reverse": ("at", "within"), "sine": ("amplitude", "frequency"),
}  # fmt: skip
"""Values that each motion takes."""
DEFAULTS = {"within": 0.1, "at": 0.5, "from_speed": 0.0, "factor": 2.0, "amplitude": 0.5}
"""Parts of the whole time, turns a minute, parts of the load."""
FASTEST, HIGHEST = 1e6, 1e6
"""Largest speeds, rpm, and frequency of a torque, Hz: beyond any drive, and of vibrations up to some 10 kHz."""
ROUND_OFF = 1e-9
"""By which times that are given, as 1.5 ms and 0.5 ms, may pass the end of the run."""
RELATIVE_TOLERANCE, PLACE_TOLERANCE = 1e-5, 5e-8
"""Of a step, relative and in mm: contacts approach by some micrometres, of which this is some 1e-5."""
WORK_TOLERANCE = 1e-9
"""Of a step, works, by the energy that the load takes in the whole run."""
QUASI_STATIC_STEP = 1e-4
"""Step of the angle of the crank for the rates of slow motion, rad."""
BALANCED_PER_TURN = 72
"""Positions in a turn of the crank whose mean is the torque that drives a drive with friction."""
PER_TURN, FEWEST_SAMPLES, MOST_SAMPLES = 720, 400, 40_000
"""Samples to a turn of the crank, and their bounds, by which memory is bounded."""
FIRST_STEP = 0.1
"""First step of the solver by the inverse of the highest frequency, rad: a longer one could throw parts through each other."""
STEPS_PER_PIN = 4
"""Steps of the solver, at least, in which the crank turns by the pitch of the wheel pins: no contact is passed over."""
STEPS_BETWEEN = 25
"""Steps of the solver between two occasions to save."""
MASSLESS = 1e-10
"""Mass by the largest one below which a coordinate has none, as in `ltca.dynamics.modes`."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Course:
    """What a run does.

    Attributes
    ----------
    motion : str
        One of `MOTIONS`.
    time : float
        s.
    speed : float
        Of the input, turns a minute, without its sense, which is that of the load's direction.
    driven_by : {"speed", "torque"}
        Whether the input turns as told or is driven by the even torque that balances load and friction in the mean of a turn.
    within, at : float or None
        Time that a change takes, and when it begins, s.
    from_speed : float or None
        First speed of a ramp, turns a minute.
    factor : float or None
        Torque after a step by that before.
    amplitude, frequency : float or None
        Of a swinging torque, by the load, and Hz.
    """

    motion: str
    time: float
    speed: float
    driven_by: str = "speed"
    within: float | None = None
    at: float | None = None
    from_speed: float | None = None
    factor: float | None = None
    amplitude: float | None = None
    frequency: float | None = None

    @classmethod
    def of_values(cls, motion: str, time: float, speed: float, driven_by: str = "speed", **values: Any) -> Course:
        """Return the course with the defaults of its motion; DriveError for values that it does not take, or lacks."""
        problems = []
        if motion not in MOTIONS:
            raise DriveError([f"motion = {motion!r}: is unknown; must be one of {', '.join(MOTIONS)}"])
        for name, bound in (("time", time), ("speed", speed)):
            if not (np.isfinite(bound) and bound > 0.0):
                problems.append(f"{name} = {bound:g}: must be greater than 0 {'s' if name == 'time' else 'rpm'}")
            elif name == "speed" and bound > FASTEST:
                problems.append(f"speed = {bound:g}: must be at most {FASTEST:g} rpm")
        taken = VALUES[motion]
        given = {name: value for name, value in values.items() if value is not None}
        problems += [
            f"{name} = {given[name]:g}: the motion {motion!r} takes none" for name in given if name not in taken
        ]
        if driven_by not in ("speed", "torque"):
            problems.append(f"driven_by = {driven_by!r}: must be 'speed' or 'torque'")
        elif driven_by == "torque" and motion in ("start", "ramp"):
            problems.append(f"driven_by = 'torque': the motion {motion!r} is one of the speed")
        chosen = {}
        for name in taken:
            value = given.get(name)
            if value is None:
                if name == "frequency":
                    problems.append("frequency: must be given for the motion 'sine', Hz")
                    continue
                value = DEFAULTS[name] * (time if name in ("within", "at") else 1.0)
            chosen[name] = float(value)
        for name in ("within", "frequency"):
            if name in chosen and not chosen[name] > 0.0:
                problems.append(
                    f"{name} = {chosen[name]:g}: must be greater than 0 {'s' if name == 'within' else 'Hz'}"
                )
        if "at" in chosen:
            if not 0.0 <= chosen["at"] < time:
                problems.append(f"at = {chosen['at']:g}: must be at least 0 and less than the time, {time:g} s")
            elif chosen["at"] + chosen["within"] > time * (1.0 + ROUND_OFF):
                problems.append(
                    f"within = {chosen['within']:g}: must be at most {time - chosen['at']:g} s, what is left of the time, "
                    f"{time:g} s, after at = {chosen['at']:g} s"
                )
        elif "within" in chosen and chosen["within"] > time * (1.0 + ROUND_OFF):
            problems.append(f"within = {chosen['within']:g}: must be at most the time, {time:g} s")
        for name, bound, unit in (("from_speed", FASTEST, "rpm"), ("frequency", HIGHEST, "Hz")):
            if name in chosen and chosen[name] > bound:
                problems.append(f"{name} = {chosen[name]:g}: must be at most {bound:g} {unit}")
        for name in ("from_speed", "amplitude"):
            if name in chosen and not 0.0 <= chosen[name] < np.inf:
                problems.append(f"{name} = {chosen[name]:g}: must be at least 0")
        if problems:
            raise DriveError(problems)
        return cls(motion=motion, time=time, speed=speed, driven_by=driven_by, **chosen)

    @property
    def values(self) -> dict[str, Any]:
        """What is given, by name, for files."""
        found = {item.name: getattr(self, item.name) for item in fields(self)}
        return {name: value for name, value in found.items() if value is not None}

    def input_motion(self, sense: float) -> Profile:
        """Return angle, speed and acceleration of the input over time, rad, in a sense of ±1."""
        last = sense * self.speed * 2.0 * np.pi / 60.0
        if self.motion == "start":
            return _rising(0.0, last, self.within or 0.0)
        if self.motion == "ramp":
            return _rising(sense * (self.from_speed or 0.0) * 2.0 * np.pi / 60.0, last, self.time)
        return lambda time: (last * time, last, 0.0)

    def load_factor(self, time: float) -> float:
        """Return the torque at a time by the load."""
        if self.motion == "sine":
            return 1.0 + (self.amplitude or 0.0) * float(np.sin(2.0 * np.pi * (self.frequency or 0.0) * time))
        if self.motion not in ("step", "reverse"):
            return 1.0
        last = -1.0 if self.motion == "reverse" else float(self.factor if self.factor is not None else 1.0)
        part = min(max((time - (self.at or 0.0)) / (self.within or 1.0), 0.0), 1.0)
        return 1.0 + (last - 1.0) * part * part * (3.0 - 2.0 * part)


def _rising(first: float, last: float, within: float) -> Profile:
    """Angle, speed and acceleration whose speed goes from one to the other as a half cosine, then stays."""
    rate, mean, half = np.pi / within, 0.5 * (first + last), 0.5 * (last - first)

    def at(time: float) -> tuple[float, float, float]:
        if time >= within:
            return mean * within + last * (time - within), last, 0.0
        turned = rate * time
        angle = mean * time - half * np.sin(turned) / rate
        return float(angle), float(mean - half * np.cos(turned)), float(half * rate * np.sin(turned))

    return at


@dataclass(frozen=True, slots=True, kw_only=True)
class Samples:
    """Samples of a run, evenly in time; axis 0 is the time.

    Attributes
    ----------
    time : array, shape (samples,)
        s.
    place, rate : array, shape (samples, n)
        Coordinates of `Motion` and their rates, mm and rad, mm/s and rad/s; rates of parts without mass are without the turning
        of normals where nothing rubs (`ltca.dynamics.massless`).
    input_torque, output_torque : array, shape (samples,)
        External torques, ccw positive, N·mm.
    pin_load, roller_load, hole_load : array, shape (samples, discs, parts)
        N; rollers in the bore.
    bearing_load : array, shape (samples, discs, cranks)
        Force of the crank bearings, N.
    works : array, shape (samples, 4)
        Done since the start at input, by the output on its load, lost in damping and friction, N·mm.
    kinetic, stored : array, shape (samples,)
        Kinetic and stored energy, N·mm; this and the following not a number where the model does not tell what it stores.
    curvature, stations : array, shape (samples,)
        Work of changing radii of curvature, and of contacts that move over bodies which yield otherwise there, since the start,
        N·mm.
    teeth : array, shape (samples,)
        Work of teeth of a first stage by what planets carry unevenly, since the start, N·mm.
    """

    time: FloatArray
    place: FloatArray
    rate: FloatArray
    input_torque: FloatArray
    output_torque: FloatArray
    pin_load: FloatArray
    roller_load: FloatArray
    hole_load: FloatArray
    bearing_load: FloatArray
    works: FloatArray
    kinetic: FloatArray
    stored: FloatArray
    curvature: FloatArray
    stations: FloatArray
    teeth: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class EnergyBalance:
    """Energy of a run, N·mm.

    Attributes
    ----------
    input, output, damping, friction : float
        Work done at the input, on the load, and lost.
    kinetic, stored : float
        Change of what is stored.
    curvature, stations : float
        Work of changing radii of curvature, and of contacts that move over bodies which yield otherwise there.
    teeth : float
        Work of teeth of a first stage by what planets carry unevenly (`ltca.dynamics.teeth`).
    throughput : float
        Larger of the works that went through input and output, both ways counted.
    """

    input: float
    output: float
    damping: float
    friction: float
    kinetic: float
    stored: float
    curvature: float
    stations: float
    teeth: float
    throughput: float

    @property
    def left(self) -> float:
        """Input and the work of moving contacts less output, losses and what is stored; not a number where it is not known."""
        taken = self.output + self.damping + self.friction + self.kinetic + self.stored
        return self.input + self.curvature + self.stations + self.teeth - taken

    @property
    def relative(self) -> float:
        """What is left by the throughput."""
        return self.left / self.throughput


@dataclass(frozen=True, slots=True, kw_only=True)
class Checkpoint:
    """Where a run stands: all that it goes on with, so that a resumed run is the uninterrupted one.

    Attributes
    ----------
    time, step : float
        s; the next step of the solver.
    state, rate, tolerances : array, shape (2m + 4,)
        Of `Equation`, its rate as the solver has it, and the absolute tolerances that it was started with.
    evaluations : int
        Calls of the equation of motion by the solver.
    rows : int
        Samples taken.
    samples : dict of str to array
        The arrays of `Samples` so far.
    followed : dict of str to array
        Inner unknowns of contacts and parts without mass, from which their next solution starts, and what the works of contacts
        are summed from, by name.
    """

    time: float
    step: float
    state: FloatArray
    rate: FloatArray
    tolerances: FloatArray
    evaluations: int
    rows: int
    samples: dict[str, FloatArray]
    followed: dict[str, NDArray[Any]]


@dataclass(frozen=True, slots=True, kw_only=True)
class TimeRun:
    """A run in time.

    Attributes
    ----------
    drive : Drive
        Warm.
    engine : Engine
        How bodies yield.
    course : Course
        What it did.
    motion : Motion
        Coordinates.
    samples : Samples
        What happened.
    evaluations : int
        Calls of the equation of motion.
    """

    drive: Drive
    engine: Engine
    course: Course
    motion: Motion
    samples: Samples
    evaluations: int

    @property
    def transmission_error(self) -> FloatArray:
        """Rotation of the output less what that of the input makes of it, rad, shape (samples,)."""
        motion = self.motion
        ratio = float(motion.output_turns @ motion.rigid) / float(motion.input_turns @ motion.rigid)
        return np.asarray(self.samples.place @ (motion.output_turns - ratio * motion.input_turns))

    @property
    def input_speed(self) -> FloatArray:
        """Turns a minute, ccw positive, shape (samples,)."""
        return np.asarray(self.samples.rate @ self.motion.input_turns * 60.0 / (2.0 * np.pi))

    @property
    def lost_contact(self) -> float:
        """Part of the time in which a disc has no pin in contact with its flank."""
        return float(np.mean(np.any(self.samples.pin_load.max(axis=2) <= 0.0, axis=1)))

    @property
    def energy(self) -> EnergyBalance:
        """Energy of the whole run."""
        taken = self.samples
        done = dict(zip(WORKS, taken.works[-1] - taken.works[0], strict=True))
        through = np.abs(np.diff(taken.works[:, :2], axis=0)).sum(axis=0)
        return EnergyBalance(
            **{name: float(value) for name, value in done.items()},
            kinetic=float(taken.kinetic[-1] - taken.kinetic[0]),
            stored=float(taken.stored[-1] - taken.stored[0]),
            curvature=float(taken.curvature[-1]),
            stations=float(taken.stations[-1]),
            teeth=float(taken.teeth[-1]),
            throughput=float(through.max()),
        )

    def spectrum(self) -> tuple[FloatArray, FloatArray]:
        """Return orders by turn of the crank against the pin shaft and amplitudes of the transmission error, rad.

        Over the last whole turns of an even speed, at which a window is not needed; empty where there is no such turn.
        """
        if self.course.motion in ("start", "ramp") or self.course.driven_by == "torque":
            return np.zeros(0), np.zeros(0)
        crank = np.abs(self.samples.place[:, self.motion.crank])
        turns = int((crank[-1] - crank[0]) / (2.0 * np.pi) + 1e-9)
        if turns < 1:
            return np.zeros(0), np.zeros(0)
        each = (crank.size - 1) * 2.0 * np.pi * turns / (crank[-1] - crank[0])
        count = int(each)
        at = crank[-1] - 2.0 * np.pi * turns * np.arange(count, 0, -1) / count
        found = 2.0 * np.abs(np.fft.rfft(np.interp(at, crank, self.transmission_error))) / count
        return np.arange(1, found.size) / turns, found[1:]


@dataclass(frozen=True, slots=True, kw_only=True)
class PreparedRun:
    """A run that can begin.

    Attributes
    ----------
    drive : Drive
        Warm.
    engine : Engine
        How bodies yield.
    course : Course
        What it does.
    motion : Motion
        Coordinates.
    equation : Equation
        Of its motion.
    start : array
        First state.
    """

    drive: Drive
    engine: Engine
    course: Course
    motion: Motion
    equation: Equation
    start: FloatArray

    @property
    def fastest(self) -> float:
        """Highest frequency at the start, rad/s."""
        equation = self.equation
        there = equation.solved(0.0, self.start)
        mass = equation.kinetic.at(there.place, there.rate)[0]
        stiffness, basis = there.forces.stiffness, equation.basis
        square = np.linalg.eigvals(np.linalg.solve(basis.T @ mass @ basis, basis.T @ stiffness @ basis))
        return float(np.sqrt(np.abs(square).max()))

    def tolerances(self) -> FloatArray:
        """Return the absolute tolerances of the state."""
        m = self.equation.freedoms
        found = np.full(2 * m + len(WORKS), PLACE_TOLERANCE)
        found[m : 2 * m] = PLACE_TOLERANCE * self.fastest
        turn = abs(float(self.motion.output_turns @ self.equation.lead))
        torque = self.drive.load.torque * turn
        found[2 * m :] = WORK_TOLERANCE * torque * self.course.speed * 2.0 * np.pi / 60.0 * self.course.time
        return found


def prepare_run(drive: Drive, engine: Engine, course: Course) -> PreparedRun:
    """Return a run that can begin.

    Parameters
    ----------
    drive : Drive
        Every density known; its load is the torque at the output.
    engine : Engine
        How bodies yield.
    course : Course
        What it does.

    Raises
    ------
    DriveError
        For what a run in time leaves out, by name: rigid teeth with backlash, or before posts, on rigid cranks, eccentric
        teeth, a twist of the carrier without mass, an input of no inertia that a torque drives, a torque of zero.
    ConvergenceError
        Where no balanced state is found to start from.
    """
    warm = warm_drive(drive)
    warm.require_torque("a run in time, which starts under load")
    masses, motion = require_masses(drive_masses(drive)), Motion.of_drive(warm)
    model = engine.prepare(drive).model
    _require_supported(warm, motion, course)
    sense = _sense(warm)
    # A first stage turns the cranks against its sun.
    turns = motion.input_turns
    lead = motion.rigid / float(turns @ motion.rigid)
    lever = levers(model, motion)
    against = warm.load_sign * warm.load.torque
    told = course.input_motion(sense)
    crank_speed = course.speed * 2.0 * np.pi / 60.0 * abs(warm.crank_turns_per_input)
    kinetic = KineticEnergy.of_drive(motion, masses)
    massless = _massless(kinetic, motion)
    held, columns = _spans(turns, lever, massless)
    # Friction and forces from outside do work on rates of what has no mass.
    works = model.friction is not None or (model.external is not None and motion.pose.wheel_leans)
    _require_mass(kinetic, motion, held, lever)
    equation = Equation(
        kinetic=kinetic,
        contacts=ContactForces(model, motion, crank_speed),
        basis=held,
        lead=lead,
        input_turns=turns,
        output_turns=motion.output_turns,
        input_motion=told,
        output_torque=lambda time: against * course.load_factor(time),
        input_torque=None,
        damping_ratio=0.0 if warm.damping is None else warm.damping.ratio_at_resonance,
        massless=MasslessParts(columns, np.zeros(massless.size), works) if massless.size else None,
    )
    whole, at_first = equation.whole, warm.load.torque * course.load_factor(0.0)

    def balanced(crank_angle: FloatArray) -> FloatArray:
        """Balanced without friction, y of each position, shape (positions, m + k)."""
        smooth = replace(model, friction=None)
        found = solve_at_output(smooth, [warm], crank_angle, at_first)
        places = np.zeros((crank_angle.size, motion.size))
        places[:, : motion.pose.size] = found.pose
        if motion.sun is not None:
            places[:, motion.sun] = -crank_lag(smooth, found)
        places -= np.outer(places @ turns, lead)
        return np.asarray(np.linalg.lstsq(whole, places.T, rcond=None)[0].T, dtype=float)

    y = equation.at_rest(0.0, balanced(np.zeros(1))[0])
    slow = QUASI_STATIC_STEP / abs(float(lead[motion.crank]))
    ends = [replace(equation, input_motion=_passing(side * slow, told(0.0)[1])).at_rest(0.0, y) for side in (-1.0, 1.0)]
    rate = (ends[1] - ends[0]) / (2.0 * slow) * told(0.0)[1]
    if course.driven_by == "torque":
        torque = _mean_input_torque(equation, motion, balanced, told(0.0)[1])
        free = _spans(np.zeros(motion.size), lever, massless)[0]
        equation = replace(equation, basis=free, input_torque=torque)
        y, rate = (np.asarray(np.linalg.solve(equation.whole, whole @ each)) for each in (y, rate))
    m = equation.freedoms
    if massless.size:
        equation = replace(equation, massless=MasslessParts(columns, y[m:], works))
    start = np.concatenate((y[:m], rate[:m], np.zeros(len(WORKS))))
    return PreparedRun(drive=warm, engine=engine, course=course, motion=motion, equation=equation, start=start)


def _massless(kinetic: KineticEnergy, motion: Motion) -> NDArray[np.intp]:
    """Places of the coordinates of the pose whose mass is zero: leans of cranks and of the wheel, a ring or the far flange that
    ties the shaft pins, cranks where theirs is given as nothing.
    """
    return np.flatnonzero(np.diag(kinetic.mass[0])[: motion.pose.size] == 0.0)


def _spans(row: FloatArray, lever: FloatArray, massless: NDArray[np.intp]) -> tuple[FloatArray, FloatArray]:
    """Columns that span the motions under which a row is zero: of what has mass, and of what has none."""
    kept = np.delete(np.arange(lever.size), massless)
    part = free_coordinates(row[kept], lever[kept])
    found = np.zeros((lever.size, part.shape[1]))
    found[kept] = part
    return found, np.asarray(np.diag(1.0 / lever)[:, massless])


def _passing(angle: float, speed: float) -> Profile:
    """The input as it passes an angle at a speed, at any time."""
    return lambda _: (angle, speed, 0.0)


def _mean_input_torque(
    equation: Equation, motion: Motion, balanced: Callable[[FloatArray], FloatArray], speed: float
) -> float:
    """Torque that balances load, forces from outside and friction in the mean of a turn of the crank, ccw positive, N·mm.

    `balanced` gives states without friction at crank angles, from which those with friction are found.
    """
    if not equation.contacts.rubs and not motion.drive.load.external:
        return -float(equation.output_torque(0.0) * (equation.output_turns @ equation.lead))  # by the ratio
    torques, by_crank = [], float(equation.lead[motion.crank])
    angles = np.arange(BALANCED_PER_TURN) * 2.0 * np.pi / BALANCED_PER_TURN
    for angle, start in zip(angles.tolist(), balanced(angles), strict=True):
        there = replace(equation, input_motion=_passing(angle / by_crank, speed))
        torques.append(there.input_torque_at_rest(0.0, there.at_rest(0.0, start)))
    return float(np.mean(torques))


def _sense(drive: Drive) -> float:
    """Sense of the input, ±1: cranks turn as the load's direction says."""
    return float(np.sign(drive.motion_sign * drive.crank_turns_per_input))


def _require_supported(drive: Drive, motion: Motion, course: Course) -> None:
    problems: list[str] = []
    stage = drive.first_stage
    if stage is not None and motion.sun is None:
        rigid = "with rigid teeth and cranks a run in time has nothing between sun and cranks"
        if stage.backlash:
            said = f"{rigid}; first_stage.mesh_stiffness must be given"
            problems.append(Problem.of("first_stage.backlash", f"= {stage.backlash:g} mm", said))
        elif np.any(motion.mesh_by_pose):
            said = f"{rigid}, and the far flange has no mass; first_stage.mesh_stiffness must be given"
            problems.append(Problem.of("carrier.posts", "", said))
    if stage is not None and stage.runs_out:
        said = "a run in time leaves out teeth that stand off their axes, by which cranks turn apart; must be 0"
        both = "first_stage.sun_runout, first_stage.planet_runout"
        problems.append(Problem.of("first_stage", "", said, shown=both, bound=("equal to", 0.0)))
    if course.driven_by == "torque" and (drive.inertia is None or drive.inertia.input is None):
        problems.append(Problem.of("inertia.input", "", "must be given for an input that a torque drives, kg·m²"))
    if problems:
        raise DriveError(problems)


def _require_mass(kinetic: KineticEnergy, motion: Motion, basis: FloatArray, lever: FloatArray) -> None:
    """Refuse coordinates that have no mass and do not follow as springs."""
    matrix = kinetic.at(np.zeros(motion.size), np.zeros(motion.size))[0]
    size = np.sqrt(np.maximum(np.diag(matrix), 0.0)) * (1.0 / lever)
    least = np.linalg.eigvalsh(basis.T @ matrix @ basis)
    if least[0] > MASSLESS * least[-1]:
        return
    light = [place for place in range(motion.size) if size[place] <= np.sqrt(MASSLESS) * size.max()]
    lacks = "yields, but has no mass, which a run in time needs"
    named = {
        motion.sun: Problem.of("inertia.input", "", f"sun of the first stage {lacks}"),
        motion.twist: Problem.of("inertia.output", "", f"twist of the carrier {lacks}"),
    }
    raise DriveError(
        [named.get(place, f"coordinate {place} {lacks}") for place in light]
        or ["masses: some motion that yields has none, which a run in time needs"]
    )


class Recorder:
    """Samples of a run in the making.

    Parameters
    ----------
    run : PreparedRun
        The run.
    count : int
        Number of samples, first and last time included.
    """

    def __init__(self, run: PreparedRun, count: int) -> None:
        self._run, self.rows = run, 0
        self.times = np.linspace(0.0, run.course.time, count)
        self._before: tuple[StoredEnergy, ...] = ()
        self._teeth: TeethForces | None = None
        self.arrays: dict[str, FloatArray] = {}

    def take(self, state: FloatArray) -> None:
        """Take the next sample, of a state."""
        run, row = self._run, self.rows
        time, equation = float(self.times[row]), run.equation
        _, torque, now, x, rate = equation.solved(time, state)
        contacts = equation.contacts
        stored, curvature, stations = np.nan, np.nan, np.nan
        if contacts.has_energy:
            curvature, stations = (
                float(self.arrays[name][row - 1]) if row else 0.0 for name in ("curvature", "stations")
            )
            stored, discs_store = contacts.stored(x, now)
            for before, there in zip(self._before, discs_store, strict=row > 0):
                by_radius, by_place = before.work_to(there)
                curvature, stations = curvature + float(by_radius[0]), stations + float(by_place[0])
            self._before = discs_store
        teeth = float(self.arrays["teeth"][row - 1]) if row else 0.0
        if self._teeth is not None and now.teeth is not None:
            teeth += self._teeth.work_to(now.teeth)
        self._teeth = now.teeth
        taken: dict[str, Any] = {
            "time": time,
            "place": x,
            "rate": rate,
            "input_torque": torque,
            "output_torque": equation.output_torque(time),
            **now.loads,
            "works": state[2 * equation.freedoms :],
            "kinetic": equation.kinetic.energy(x, rate),
            "stored": stored,
            "curvature": curvature,
            "stations": stations,
            "teeth": teeth,
        }
        for name, values in taken.items():
            if name not in self.arrays:
                self.arrays[name] = np.zeros((self.times.size, *np.shape(values)))
            self.arrays[name][row] = values
        self.rows += 1

    def checkpoint(self, solver: DOP853) -> Checkpoint:
        """Return where the run stands after a step of the solver."""
        followed = named_arrays(self._run.equation.warm_start(), "inner") | named_arrays(self._summed(), "summed")
        return Checkpoint(
            time=float(solver.t),
            step=float(solver.h_abs),
            state=solver.y.copy(),
            rate=solver.f.copy(),
            tolerances=solver.atol.copy(),
            evaluations=int(solver.nfev),
            rows=self.rows,
            samples={name: values[: self.rows] for name, values in self.arrays.items()},
            followed={name: values.copy() for name, values in followed.items()},
        )

    def resume(self, checkpoint: Checkpoint) -> DOP853:
        """Take over an interrupted run and return its solver as it stood; DamagedFileError where it does not fit."""
        run, size = self._run, self._run.start.shape
        fits = all(
            values.shape == size and np.all(np.isfinite(values))
            for values in (checkpoint.state, checkpoint.rate, checkpoint.tolerances)
        )
        rows = {len(values) for values in checkpoint.samples.values()}
        fits = fits and 0.0 < checkpoint.time < run.course.time and checkpoint.step > 0.0
        if not fits or rows != {checkpoint.rows} or not 0 < checkpoint.rows <= self.times.size:
            raise DamagedFileError("does not fit the run in time that it says it is of")
        solver = self.solver(checkpoint.time, checkpoint.state, checkpoint.step, checkpoint.tolerances)
        equation = run.equation
        # What one call at the state leaves has the structure of what is kept.
        moment = equation.solved(checkpoint.time, checkpoint.state)
        if equation.contacts.has_energy:
            self._before = equation.contacts.stored(moment.place, moment.forces)[1]
        self._teeth = moment.forces.teeth
        try:
            inner = with_named_arrays(equation.warm_start(), checkpoint.followed, "inner")
            self._before, self._teeth = with_named_arrays(self._summed(), checkpoint.followed, "summed")
            fields_of = {item.name for item in fields(Samples)}
            if set(checkpoint.samples) != fields_of:
                raise ValueError(f"samples: must be {', '.join(sorted(fields_of))}")
        except ValueError as error:
            raise DamagedFileError(f"does not fit the run in time that it says it is of: {error}") from error
        equation.start_from(inner)
        equation.contacts.forget_grids()  # those of the calls above: the uninterrupted run had none when it was saved
        solver.f, solver.h_abs, solver.nfev = checkpoint.rate, checkpoint.step, checkpoint.evaluations
        self.rows = checkpoint.rows
        for name, values in checkpoint.samples.items():
            self.arrays[name] = np.zeros((self.times.size, *values.shape[1:]))
            self.arrays[name][: self.rows] = values
        return solver

    def solver(self, time: float, state: FloatArray, step: float, tolerances: FloatArray) -> DOP853:
        """Return the solver at a state, with its next step."""
        end = self._run.course.time
        return DOP853(
            self._run.equation.rates,
            time,
            state,
            end,
            max_step=longest_step(self._run),
            rtol=RELATIVE_TOLERANCE,
            atol=tolerances,
            first_step=min(step, end - time),
        )

    def _summed(self) -> tuple[tuple[StoredEnergy, ...], TeethForces | None]:
        """Energies and teeth at the last sample, from which works are summed to the next."""
        return self._before, self._teeth

    def samples(self) -> Samples:
        """Return what was taken."""
        return Samples(**{name: values[: self.rows] for name, values in self.arrays.items()})


def samples_of(course: Course, drive: Drive) -> int:
    """Return how many samples are kept of a run: `PER_TURN` to a turn of the crank at full speed, up to `MOST_SAMPLES`."""
    turns = course.time * course.speed / 60.0 * abs(drive.crank_turns_per_input)
    return 1 + int(min(max(np.ceil(PER_TURN * turns), FEWEST_SAMPLES), MOST_SAMPLES))


def longest_step(run: PreparedRun) -> float:
    """Return the longest step of the solver, s: `STEPS_PER_PIN` while the crank turns by the pitch of the wheel pins."""
    crank_speed = run.course.speed * 2.0 * np.pi / 60.0 * abs(run.drive.crank_turns_per_input)
    return 2.0 * np.pi / (run.drive.pin_wheel.number_of_pins * crank_speed * STEPS_PER_PIN)


def _stopped(solver: DOP853, equation: Equation, problem: str) -> ConvergenceError:
    """The error of a run that goes no farther, with what refused the last states tried."""
    return ConvergenceError(
        f"the run stops at {solver.t:.6g} s: {equation.refused[-1] if equation.refused else problem}", []
    )


def run_in_time(
    run: PreparedRun,
    *,
    samples: int | None = None,
    advance: Callable[[int], None] = lambda _: None,
    save: Callable[[Callable[[], Checkpoint]], None] = lambda _: None,
    resumed: Checkpoint | None = None,
) -> TimeRun:
    """Run a drive in time.

    Parameters
    ----------
    run : PreparedRun
        The run.
    samples : int, optional
        Samples that are kept, first and last time included; default `samples_of`.
    advance : callable
        Told how many samples were taken.
    save : callable
        Given what returns a checkpoint, every `STEPS_BETWEEN` steps of the solver.
    resumed : Checkpoint, optional
        Where an interrupted run of the same input stood.

    Returns
    -------
    TimeRun

    Raises
    ------
    ConvergenceError
        Where the solver's step vanishes, or contacts find no loads at a state between its steps.
    DamagedFileError
        Where the checkpoint does not fit the run.
    """
    equation = run.equation
    recorder = Recorder(run, samples or samples_of(run.course, run.drive))
    if resumed is None:
        step = FIRST_STEP / run.fastest
        recorder.take(run.start)
        solver = recorder.solver(0.0, run.start, step, run.tolerances())
    else:
        solver = recorder.resume(resumed)
    advance(recorder.rows)
    taken = 0
    while solver.status == "running":
        problem = solver.step()
        if solver.status == "failed":
            raise _stopped(solver, equation, problem)
        taken += 1
        between = None
        while recorder.rows < recorder.times.size and recorder.times[recorder.rows] <= solver.t:
            between = solver.dense_output() if between is None else between
            at = float(recorder.times[recorder.rows])
            state = solver.y if at == solver.t else between(at)
            if not np.isfinite(state).all():
                raise _stopped(solver, equation, "no state between its steps")
            try:
                recorder.take(state)
            except ConvergenceError as problem:
                raise _stopped(solver, equation, str(problem)) from problem
            advance(1)
        if taken % STEPS_BETWEEN == 0 and solver.status == "running":
            equation.contacts.forget_grids()
            save(lambda: recorder.checkpoint(solver))
    return TimeRun(
        drive=run.drive,
        engine=run.engine,
        course=run.course,
        motion=run.motion,
        samples=recorder.samples(),
        evaluations=int(solver.nfev),
    )
