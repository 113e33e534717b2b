"""Motion in time with contacts in slices, whose discs lean: against statics, the plane, modes, and energy."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

import ltca
from ltca.analysis.engines import HalfSpace, Hybrid, PlaneStrain
from ltca.analysis.time_dataset import time_dataset
from ltca.analysis.time_run import Course, _massless, prepare_run, run_in_time
from ltca.compliance.coefficients import load_coefficients
from ltca.drive.members.temperatures import warm_drive
from ltca.drive.single_discs import single_discs
from ltca.dynamics.contact_forces import ContactForces
from ltca.dynamics.kinetic_energy import KineticEnergy, LeaningSpin
from ltca.dynamics.kinetics import Body, Motion, _leaning, mass_matrix, moving_bodies
from ltca.dynamics.masses import drive_masses
from ltca.dynamics.modes import solve_modes
from ltca.dynamics.stiffness import levers, stiffness_matrices
from ltca.equilibrium.output_torque import solve_at_output
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive
from ltca.testing.closed_form_bodies import closed_form_coefficients

ARCSEC = 206264.806
SLOPED = {"contact.slices": 3, "disc.lead_slope": 5e-4}
"""A flank that slopes by 5 µm over 10 mm makes discs lean by as much."""
PULLED = {"load.external.0.force.x": 3000.0, "load.external.0.at.z": 90.0, "load.external.0.moment.y": 1e6}
RUBBING = {"friction.pin": 0.05, "friction.hole": 0.05, "friction.roller": 0.002}
SLOW = pytest.mark.slow
NIGHTLY = (pytest.mark.slow, pytest.mark.nightly)


@cache
def drive_of(name):
    """Drives of several kinds in slices, most with flanks that slope."""
    first = {one: next(iter(load_drive(one).cases.values())) for one in ("paper", "robot-joint", "rv", "sleeved")}
    path = Path(__file__).parents[3] / "examples" / "drives" / "plastic.toml"
    plastic = next(iter(load_drive(path).cases.values()))
    return {
        "plane": first["paper"],
        "aligned": with_fields(first["paper"], {"contact.slices": 3}),
        "paper": with_fields(first["paper"], SLOPED),
        "paper, rubs": with_fields(first["paper"], {**SLOPED, **RUBBING, "damping.ratio": 0.03}),
        "paper, light": with_fields(first["paper"], {**SLOPED, "load.torque": 2e4}),
        "two discs held pin-wheel": with_fields(first["robot-joint"], {**SLOPED, "installation.held": "pin-wheel"}),
        "wheel leans": with_fields(
            first["robot-joint"],
            {**SLOPED, **PULLED, "main_bearing.radial_stiffness": 3e5, "main_bearing.tilt_stiffness": 1e9},
        ),
        "plastic": with_fields(plastic, {**SLOPED, "damping.ratio": 0.03}),
        "rv": with_fields(first["rv"], SLOPED),
        "sleeved": with_fields(first["sleeved"], SLOPED),
    }[name]


def prepared(name, course):
    return prepare_run(drive_of(name), HalfSpace(), course)


def leans_of(motion):
    """Places of the leans of discs."""
    own = [motion.pose.columns(disc)[motion.pose.lean_place] for disc in range(motion.pose.discs)]
    return np.concatenate(own)


def balanced(name, angle):
    """The model of a drive without friction, its motion, and where it balances."""
    model = replace(HalfSpace().prepare(drive_of(name)).model, friction=None)
    warm = warm_drive(drive_of(name))
    return model, Motion.of_drive(warm), solve_at_output(model, [warm], np.atleast_1d(angle), warm.load.torque)


@pytest.mark.parametrize(
    "name", ["paper", *(pytest.param(one, marks=SLOW) for one in ("two discs held pin-wheel", "rv", "wheel leans"))]
)
def test_slow_motion_is_the_quasi_static_one(name):
    """At 30 rpm inertia forces are a millionth of the loads; 0.01″, 1e-3 of the largest load and 1e-3 of the largest lean were
    asked for beforehand.
    """
    found = run_in_time(prepared(name, Course.of_values("steady", 2e-4, 30.0)), samples=3)
    taken = found.samples
    _, motion, still = balanced(name, taken.place[:, found.motion.crank])
    assert taken.place[:, motion.wheel_angle] * ARCSEC == pytest.approx(still.pose[:, -1] * ARCSEC, abs=0.01)
    loads = still.response.pin_load.reshape(taken.pin_load.shape)
    assert taken.pin_load == pytest.approx(loads, abs=1e-3 * loads.max())
    loads = still.response.rollers.outer_load.reshape(taken.roller_load.shape)
    assert taken.roller_load == pytest.approx(loads, abs=1e-3 * loads.max())
    leans = still.pose[:, leans_of(motion)]
    assert np.abs(leans).max() > 1e-4
    assert taken.place[:, leans_of(motion)] == pytest.approx(leans, abs=1e-3 * np.abs(leans).max())


@pytest.mark.slow
def test_an_aligned_drive_moves_in_slices_as_in_the_plane():
    """Loads of an aligned pair in slices are those of its length to 0.5 %, what contacts yield likewise; nothing leans."""
    course = Course.of_values("steady", 2e-4, 1500.0)
    plane, slices = (run_in_time(prepared(name, course), samples=21) for name in ("plane", "aligned"))
    load = plane.samples.pin_load
    assert slices.samples.pin_load == pytest.approx(load, abs=5e-3 * load.max())
    yields = np.abs(plane.transmission_error).max()
    assert slices.transmission_error == pytest.approx(plane.transmission_error, abs=5e-3 * yields)
    assert np.abs(slices.samples.place[:, leans_of(slices.motion)]).max() < 1e-12


@pytest.mark.slow
def test_small_rocking_is_the_mode():
    """A disc that rocks by ten nanometres at half its thickness: its frequency by the modes, 1e-3 asked for, by its zeros."""
    run = prepared("plastic", Course.of_values("steady", 1.0, 1e-6))
    equation = replace(run.equation, input_motion=lambda _: (0.0, 0.0, 0.0))
    model, motion, still = balanced("plastic", 0.0)
    mass = mass_matrix(moving_bodies(motion, drive_masses(drive_of("plastic")), 0.0))
    modes = solve_modes(stiffness_matrices(model, motion, still)[0], mass, equation.basis, None)
    leans = leans_of(motion)
    rocking = [shape[leans] @ mass[np.ix_(leans, leans)] @ shape[leans] for shape in modes.shapes.T]
    mode = int(np.argmax(rocking))
    assert rocking[mode] > 0.99  # of a mass-normalised shape
    shape, m = modes.shapes[:, mode], equation.freedoms
    own = np.linalg.lstsq(equation.basis, shape, rcond=None)[0]
    start, rest = run.start.copy(), run.start[:m].copy()
    start[m : 2 * m] = 0.0
    start[:m] += own * (1e-5 / np.abs(own).max())
    tolerance = 1e-2 * run.tolerances()
    tolerance[2 * m :] = 1.0  # works are not looked at
    times = np.linspace(0.0, 2.6 / modes.frequency[mode], 521)
    answer = solve_ivp(
        equation.rates, (0.0, times[-1]), start, method="DOP853", t_eval=times, rtol=1e-7, atol=tolerance,
        first_step=0.1 / run.fastest
    )  # fmt: skip
    moved = (shape @ mass @ equation.basis) @ (answer.y[:m] - rest[:, None])
    crossing = np.flatnonzero((moved[:-1] > 0.0) & (moved[1:] <= 0.0))
    zeros = times[crossing] + moved[crossing] / (moved[crossing] - moved[crossing + 1]) * (times[1] - times[0])
    assert zeros.size >= 2
    damped = modes.frequency[mode] * np.sqrt(1.0 - 0.03**2)
    assert (zeros.size - 1) / (zeros[-1] - zeros[0]) == pytest.approx(damped, rel=1e-3)


@pytest.mark.parametrize(
    ("name", "course"),
    [
        ("paper, rubs", Course.of_values("steady", 5e-5, 1500.0)),
        pytest.param("paper, light", Course.of_values("reverse", 1e-3, 1500.0, at=1e-4, within=6e-4), marks=NIGHTLY),
        pytest.param("two discs held pin-wheel", Course.of_values("steady", 5e-5, 1500.0), marks=SLOW),
        pytest.param("wheel leans", Course.of_values("steady", 5e-5, 1500.0), marks=SLOW),
        pytest.param("rv", Course.of_values("steady", 5e-5, 1500.0), marks=SLOW),
    ],
)
def test_energy_closes(name, course):
    """Input and work of curvature less output, losses and change of what is stored: 1e-5 of the throughput was asked for."""
    energy = run_in_time(prepared(name, course), samples=11).energy
    assert abs(energy.relative) < 1e-5
    if name == "paper, rubs":
        assert energy.friction > 1e-3 * energy.throughput


def in_closed_form(drive, folder, tilt_depth):
    """Coefficients of a drive's bodies without finite elements; solid with a depth of linear loads."""
    path, (single, *_) = folder / "bodies.nc", single_discs(warm_drive(drive))
    found = closed_form_coefficients(single, half_width=0.02, depth=300.0, tilt_depth=tilt_depth)
    found.to_netcdf(path, engine="h5netcdf")
    return load_coefficients(path, single)


@pytest.mark.parametrize(
    ("name", "kind", "tilt_depth"),
    [
        ("paper", HalfSpace, None),
        ("paper", PlaneStrain, None),
        pytest.param("paper", Hybrid, None, marks=SLOW),
        ("paper", Hybrid, 260.0),
        pytest.param("sleeved", HalfSpace, None, marks=SLOW),
        pytest.param("rv", HalfSpace, None, marks=SLOW),
    ],
)
def test_forces_are_slopes_of_what_is_stored(name, kind, tilt_depth, tmp_path):
    """Along any way beside balance, leans among it, U grows by the work of forces and moments and of contacts that move over the
    bodies.

    Differences of fourth order by two of second (Richardson): 1e-7 of the slopes. Steps are two nanometres, a thousandth of
    approaches: over longer ones a point of a slice opens. The sleeved drive has seats, and pins that lean; with a depth of linear
    loads bodies are solid and yield to moments.
    """
    drive = drive_of(name)
    engine = (
        kind()
        if kind is HalfSpace
        else kind(
            coefficients=in_closed_form(drive, tmp_path, tilt_depth), **({"bodies": "solid"} if tilt_depth else {})
        )
    )
    model, warm, rng = replace(engine.prepare(drive).model, friction=None), warm_drive(drive), np.random.default_rng(2)
    motion = Motion.of_drive(warm)
    still = solve_at_output(model, [warm], np.array([0.3]), warm.load.torque)
    x = np.zeros(motion.size)
    x[: motion.pose.size], x[motion.crank] = still.pose[0] * 1.05, 0.3
    contacts, at_rest = ContactForces(model, motion, 1.0), np.zeros(motion.size)
    lever = levers(model, motion)
    way = rng.standard_normal(motion.size) / lever
    way[motion.crank] = 1.0
    force = contacts.at(x, at_rest).force

    def slopes(step):
        ends = []
        for side in (-1.0, 1.0):
            there = x + side * step * way
            ends.append(contacts.stored(there, contacts.at(there, at_rest)))
        (low, before), (high, after) = ends
        moved = sum(np.array(one.work_to(other))[:, 0] for one, other in zip(before, after, strict=True))
        return np.append(moved, high - low) / (2.0 * step)

    by_radius, by_place, stored = (4.0 * slopes(2e-6) - slopes(4e-6)) / 3.0
    work = force * way
    size = np.abs(work).sum()
    assert stored == pytest.approx(work.sum() + by_radius + by_place, abs=1e-7 * size)
    assert np.abs(work[leans_of(motion)]).max() > 1e-3 * size
    assert abs(by_radius) > 1e-6 * size
    assert abs(by_place) > 1e-6 * size or kind is HalfSpace


@pytest.mark.parametrize("name", ["wheel leans", pytest.param("rv", marks=SLOW)])
def test_leans_without_mass_are_in_balance(name):
    """Beside the balance of all others: what is left on leans of cranks or wheel by their stiffness is below 1e-8 mm at half the
    thickness, to which they settle.
    """
    run = prepared(name, Course.of_values("steady", 1e-3, 30.0))
    state, equation = run.start.copy(), run.equation
    state[: equation.freedoms] += 1e-4 * np.random.default_rng(4).standard_normal(equation.freedoms)
    moment = equation.solved(0.0, state)
    x, rate = moment.place, moment.rate
    own, half_width = (
        _massless(equation.kinetic, run.motion),
        float(np.max(equation.contacts._model.discs[0].geometry.half_width)),
    )
    assert own.size
    now, before = equation.contacts.at(x, rate), equation.solved(0.0, run.start).place
    left = (now.force - now.outside)[own]
    assert half_width * np.abs(np.linalg.solve(now.stiffness[np.ix_(own, own)], left)).max() < 1e-8
    assert half_width * np.abs(x - before)[own].max() > 1e-6  # they do follow


def test_stiffness_in_slices_is_that_in_the_plane():
    """Of an aligned drive, over all that does not lean, the crank angle with it: loads by slices are those of the length to
    0.5 %; 1e-2 of the largest was asked for.
    """
    found = []
    for name in ("plane", "aligned"):
        model, motion, still = balanced(name, 0.3)
        x = np.append(still.pose[0], 0.3)
        contacts = ContactForces(model, motion, 1.0)
        lever = levers(model, motion)
        stiffness = contacts.at(x, np.zeros(motion.size)).stiffness / np.outer(lever, lever)
        rest = np.delete(np.arange(motion.size), leans_of(motion)) if name == "aligned" else np.arange(motion.size)
        found.append(stiffness[np.ix_(rest, rest)])
    assert found[1] == pytest.approx(found[0], abs=1e-2 * np.abs(found[0]).max())


def test_friction_presses_the_leans_as_in_statics():
    """At full slip: friction in motion is that of a drive that turns, moments on leans with it. v₀ is 1 % of the eccentrics'
    speed: 1e-3 where slips are some tenths of it.
    """
    run = prepared("paper, rubs", Course.of_values("steady", 1e-4, 1500.0))
    equation, motion = run.equation, run.motion
    x = equation.solved(0.0, run.start).place
    now = equation.contacts.at(x, equation.lead * equation.input_motion(0.0)[1])
    model = HalfSpace().prepare(drive_of("paper, rubs")).model
    at, pose = x[motion.crank : motion.crank + 1], x[None, : motion.pose.size]
    rubbing, smooth = (one.respond(at, pose).force[0] for one in (model, replace(model, friction=None)))
    leans, expected = leans_of(motion), rubbing - smooth
    assert np.abs(expected[leans]).max() > 0.01
    assert now.friction[leans] == pytest.approx(expected[leans], abs=1e-3 * np.abs(expected[leans]).max())
    assert now.friction[:2] == pytest.approx(expected[:2], abs=1e-3 * np.abs(expected[:2]).max())


def test_kinetic_energy_is_that_of_a_body_that_spins_and_leans():
    """½ ω·J ω of a body unlike in x and y, ω from its rotation in space: its own axis leans in a frame that turns.

    The model keeps second order of leans and turn: with leans of 1e-4 what is left is some 1e-4 of what leans add.
    """
    tensor = np.array([[3.0, 0.4, 0.0], [0.4, 2.2, 0.0], [0.0, 0.0, 4.9]])
    motion = SimpleNamespace(
        pose=SimpleNamespace(leans=True, lean_place=slice(0, 2), columns=lambda _: np.arange(4)),
        unit=lambda place: np.eye(4)[place],
    )
    frame, turns = np.eye(4)[3], np.eye(4)[3] + np.eye(4)[2]
    bodies = (
        Body(name="disc 0", turns=True, size=4.9, row=turns.astype(complex)),
        *_leaning(motion, SimpleNamespace(inertia=tensor), 0),
    )
    spin, displaces = LeaningSpin(inertia=4.9, turns=turns, lean=0), np.array([1.0, 1.0, 1.0, 0.0])
    kinetic = KineticEnergy.of_bodies([bodies] * 3, crank=3, frame=frame, displaces=displaces, spins=(spin,))
    size = 1e-4
    x, rate = np.array([0.7 * size, -0.4 * size, 0.3 * size, 0.6]), np.array([1.3 * size, 0.9 * size, 0.8, 2.0])

    def rotation(time):
        lean_x, lean_y, turn, angle = x + rate * time
        leaning = Rotation.from_rotvec([-lean_y, lean_x, 0.0])
        return Rotation.from_euler("z", angle) * leaning * Rotation.from_euler("z", turn)

    step = 1e-5
    omega = (rotation(-step).inv() * rotation(step)).as_rotvec() / (2.0 * step)
    even = 0.5 * 4.9 * (turns @ rate) ** 2
    leaning = 0.5 * omega @ tensor @ omega - even
    assert kinetic.energy(x, rate) - even == pytest.approx(leaning, rel=1e-3)


def test_inertia_forces_of_leans_are_those_of_lagrange():
    """Differences of T by places, rates and time along a path, of leaning discs whose frame turns; steps of 1e-4 leave 1e-6."""
    drive = warm_drive(drive_of("two discs held pin-wheel"))
    motion = Motion.of_drive(drive)
    kinetic, rng = KineticEnergy.of_drive(motion, drive_masses(drive)), np.random.default_rng(3)
    assert len(kinetic.spins) == 2
    x, rate, step = 0.05 * rng.standard_normal(motion.size), rng.standard_normal(motion.size), 1e-4
    bias = kinetic.at(x, rate)[1]
    ahead, behind = (kinetic.at(x + side * step * rate, rate)[0] @ rate for side in (1.0, -1.0))
    slope = [
        (kinetic.energy(x + step * unit, rate) - kinetic.energy(x - step * unit, rate)) / (2.0 * step)
        for unit in np.eye(motion.size)
    ]
    expected, leans = (ahead - behind) / (2.0 * step) - slope, leans_of(motion)
    assert bias[leans] == pytest.approx(expected[leans], abs=1e-6 * np.abs(expected[leans]).max())
    assert bias == pytest.approx(expected, abs=1e-6 * np.abs(expected).max())


@pytest.mark.slow
def test_tilts_of_a_run_are_those_of_the_analysis():
    """At the begin, which is in balance: rotation vectors about the same axes as the quasi-static dataset has, 1e-3 asked for."""
    course = Course.of_values("steady", 1e-6, 1.0)
    found = time_dataset(run_in_time(prepared("paper", course), samples=2))
    still = ltca.analyse(drive_of("paper"), positions=1, compliance="half-space").dataset
    expected = still["disc_tilt"].values[0, :, 0]
    assert found.variables["disc_tilt"].dims == ("time", "disc", "axis")
    assert found.variables["disc_tilt"].values[0] == pytest.approx(expected, abs=1e-3 * np.abs(expected).max())
