"""What is exported, replayed in MuJoCo and by FMPy, against the quasi-static analysis of the same drive at other crank angles.

Expected values are those of cyclo's analysis (the path of the locked drive, its free play, its losses), never those of the fit.
Bounds are those of the task: 1 % of the torque range, here twice the rated torque, and 0.02′.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import needs
import numpy as np
import pytest

from ltca.analysis.engines import HalfSpace
from ltca.analysis.friction.hysteresis import locked_path
from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.reduced_model.model import reduce_drive
from ltca.drive.units.quantities import ARCMIN
from ltca.equilibrium.output_angle import play_before_cranks
from ltca.export.simulators.files import write_simulator
from ltca.geometry.placement import position_angles
from ltca.geometry.play import free_play
from ltca.reading.drive_file import load_drive

pytestmark = [pytest.mark.slow, pytest.mark.nightly, pytest.mark.needs("robotics")]
mujoco, fmpy = needs.optional("mujoco"), needs.optional("fmpy")

ANGLES = (1.234, 17.71, 42.9)
"""Crank angles of the replays, rad; none of those that the elements are fitted at. Drives settle at the first alone."""
ANGLE = ANGLES[0]
TURNS = (1.0, 0.3, 0.9, -1.0, 0.5)
"""Torques by the rated one between which the path goes: the whole loop, with a reversal within it."""
STEP = 0.1
"""Of the path of the analysis, which holds contacts between its steps: with half the step its wind-up changes by 0.004′."""
BESIDE_PLAY = (0.01, 0.03)
"""Torques beside the play, through which the output jumps: steps of the path there, either way."""
MOST_TORQUE, MOST_ANGLE = 0.01, 0.02 / ARCMIN
LIGHT = 1e-4


def loaded_path():
    """Torques by the rated one, step by step; those of nearly nothing are left out."""
    found, before = [], 0.0
    for turn in TURNS:
        count = round(abs(turn - before) / STEP)
        steps = before + (turn - before) * np.arange(1, count + 1) / count
        steps = steps[np.abs(steps) > 2.0 * BESIDE_PLAY[-1]].tolist()
        if before * turn <= 0.0:
            steps += [np.sign(turn) * part for part in BESIDE_PLAY] + [
                np.sign(before) * part for part in BESIDE_PLAY if before
            ]
        found += sorted(steps, reverse=turn < before)
        before = turn
    return np.array(found)


@pytest.fixture(scope="module", params=["rv", "robot-joint", "sleeved", "paper"])
def drive(request):
    """A shipped drive with friction: the joint that of docs/how-to/robot_joint.md."""
    file = load_drive(request.param)
    rubs = {"robot-joint": {"hole": 0.05}, "sleeved": {"hole": 0.05, "seat": 0.03}, "paper": {"pin": 0.06}}
    return file.cases["CS-4" if request.param == "paper" else next(iter(file.cases))].with_fields({
        "friction": {"pin": 0.05, "roller": 0.002, "no_load_torque": 100.0} | rubs.get(request.param, {}),
        "load.speed": 1500.0, "inertia": {"input": 1e-4, "output": 0.05}, "damping": {"ratio": 0.1},
    })  # fmt: skip


@pytest.fixture(scope="module")
def tables(drive):
    return {"name": "joint", **reduce_drive(drive, HalfSpace()).content}


@pytest.fixture(scope="module")
def folder(tables, tmp_path_factory):
    out = tmp_path_factory.mktemp("simulators")
    for kind in ("mujoco", "urdf", "fmu"):
        write_simulator(kind, tables, out)
    return out


@pytest.fixture(scope="module")
def expected(drive):
    """Torque on the output and its angle against the input, N·m and rad, by the analysis."""
    torque = drive.load.torque * np.array([LIGHT, *loaded_path()])
    wound = locked_path(drive, np.array(ANGLES), torque, engine=HalfSpace())
    # With the pin wheel held and a crank that drives ccw a positive load turns the pin shaft ccw, the pin wheel cw.
    assert drive.load.direction == "ccw"
    return torque[1:] / (1e3 if drive.wheel_is_held else -1e3), wound[:, 1:]


@pytest.fixture(scope="module")
def play(drive):
    model = HalfSpace().prepare(drive).model
    angle = np.array([ANGLE])
    play = free_play(model.geometries, angle).play + play_before_cranks(model, angle)
    return abs(drive.output_per_wheel_angle) * float(play[0])


@pytest.fixture(scope="module")
def driving_back(drive):
    """Torque from which a turn of the drive, moved by its output, leaves something for the input, N·m, by bisection."""

    def left(torque):
        found = analyse(drive, position_angles(24), torque=torque, engine=HalfSpace()).losses_back
        return float(np.mean(found.at_input))

    low, high = 1e3, 3e4
    assert left(low) > 0.0 > left(high)
    for _ in range(7):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if left(middle) > 0.0 else (low, middle)
    return 0.5 * (low + high) / 1e3


class Replay:
    """MuJoCo with the callback: the input is held at a crank angle, the output moves."""

    def __init__(self, folder):
        import sys

        sys.path.insert(0, str(folder))
        try:
            import mujoco_callback
        finally:
            sys.path.remove(str(folder))
        mujoco.set_mjcb_passive(None)
        self.model = mujoco.MjModel.from_xml_path(str(folder / "joint.xml"))
        self.data = mujoco.MjData(self.model)
        self.drive = mujoco_callback.DriveCallback(self.model, folder / "joint.json")
        mujoco.set_mjcb_passive(self.drive)
        self.input, self.output = (self.model.joint(f"joint_{side}").qposadr[0] for side in ("input", "output"))

    def torque_at(self, wound, crank_angle=ANGLE):
        """Torque with which the output is held at an angle; the state of the drive goes on."""
        at = crank_angle / self.drive.law.cranks
        self.data.qpos[[self.input, self.output]] = at, at / self.drive.law.ratio + wound
        self.data.qvel[:] = 0.0
        self.data.time += 1.0
        mujoco.mj_forward(self.model, self.data)
        return -self.data.qfrc_passive[self.output]

    def settle(self, torque, longest=120_000):
        """Angle of the output against the input once a torque is balanced.

        The lightest torque crosses the play slowly: of the paper's drive 4 mrad at 5.5 mrad/s in steps of 10 µs.
        """
        at = ANGLE / self.drive.law.cranks
        self.data.qfrc_applied[self.output] = torque
        for step in range(longest):
            self.data.qpos[self.input], self.data.qvel[self.input] = at, 0.0
            mujoco.mj_step(self.model, self.data)
            if step > 100 and abs(self.data.qacc[self.output]) < 1e-3 and abs(self.data.qvel[self.output]) < 1e-6:
                return self.data.qpos[self.output] - at / self.drive.law.ratio
        raise AssertionError(f"{torque} N·m is not balanced")


@pytest.fixture
def replay(folder):
    try:
        yield Replay(folder)
    finally:
        mujoco.set_mjcb_passive(None)


def test_mujoco_torque_along_the_loop(replay, expected, tables):
    held = []
    for crank_angle, path in zip(ANGLES, expected[1], strict=True):
        replay.drive.law.reset()
        held.append([replay.torque_at(wound, crank_angle) for wound in path])
    assert np.max(np.abs(held - expected[0])) < MOST_TORQUE * 2.0 * tables["limits"]["rated_torque_N_m"]


def test_mujoco_wind_up_along_the_loop(replay, expected, tables):
    # Critical damping of the output on the spring of the table with elements that stick, which add as much to it: it comes to
    # each angle from one side, as a slow torque brings it.
    stiffness = 4.0 * tables["linear_spring"]["stiffness_N_m_per_rad"]
    replay.model.dof_damping[1] = 2.0 * np.sqrt(stiffness * 0.05)
    wound = [replay.settle(torque) for torque in expected[0]]
    assert np.max(np.abs(wound - expected[1][0])) < MOST_ANGLE


def edges(torque_at, least):
    """Angles at which a drive without past begins to hold, either way."""
    found = []
    for way in (-1.0, 1.0):
        free, held = 0.0, way * 0.01
        for _ in range(40):
            middle = 0.5 * (free + held)
            free, held = (free, middle) if way * torque_at(middle) > least else (middle, held)
        found.append(held)
    return found


def test_mujoco_play(replay, play, tables):
    def torque_at(wound):
        replay.drive.law.reset()
        return replay.torque_at(wound)

    low, high = edges(torque_at, 1.1 * LIGHT * tables["limits"]["rated_torque_N_m"])
    assert abs(high - low - play) < MOST_ANGLE


def moved_by(replay, torque):
    """Angle by which the input, free but for its friction, turns in 0.1 s under a torque on the output."""
    mujoco.mj_resetData(replay.model, replay.data)
    replay.model.dof_damping[1] = 50.0  # the output follows without a bounce
    replay.drive.law.reset()
    replay.data.qpos[replay.output] = edges(lambda wound: replay.drive.law.elastic_torque(0.0, wound), torque)[1]
    replay.data.qfrc_applied[replay.output] = torque
    for _ in range(round(0.1 / replay.model.opt.timestep)):
        mujoco.mj_step(replay.model, replay.data)
    return abs(replay.data.qpos[replay.input])


def test_mujoco_is_driven_back(replay, driving_back):
    """5 % below the torque the input creeps by some microradians, as MuJoCo's friction does; 5 % above it turns."""
    held, driven = moved_by(replay, 0.95 * driving_back), moved_by(replay, 1.05 * driving_back)
    assert held < 1e-4
    assert driven > 20.0 * held


class Unit:
    """The unit as a co-simulation master sees it."""

    def __init__(self, folder, cranks):
        from fmpy.fmi2 import FMU2Slave

        path = folder / "joint.fmu"
        self.description = fmpy.read_model_description(str(path))
        self.place = {one.name: one.valueReference for one in self.description.modelVariables}
        self.slave = FMU2Slave(
            guid=self.description.guid,
            unzipDirectory=fmpy.extract(str(path)),
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="joint",
        )
        self.slave.instantiate()
        self.slave.setupExperiment(startTime=0.0)
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()
        self.ratio, self.time = self.get("transmission_ratio"), 0.0
        self.cranks, self.unloaded = cranks, self.slave.getFMUState()

    def get(self, name):
        return self.slave.getReal([self.place[name]])[0]

    def set(self, input_angle, wound):
        names = [self.place["input_angle"], self.place["output_angle"]]
        self.slave.setReal(names, [input_angle, input_angle / self.ratio + wound])

    def begin(self, crank_angle):
        """Forget the past; the input stands at a crank angle."""
        self.slave.setFMUState(self.unloaded)
        self.at = crank_angle / self.cranks

    def torque_at(self, wound, input_angle=None, goes_on=True):
        input_angle = self.at if input_angle is None else input_angle
        self.set(input_angle, wound)
        torque = -self.get("output_torque")
        if goes_on:
            self.slave.doStep(self.time, 0.1)
            self.time += 0.1
        return torque

    def wound_by(self, torque):
        """Angle at which the unit holds a torque; it goes there."""
        low, high = -0.01, 0.01
        for _ in range(50):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self.torque_at(middle, goes_on=False) < torque else (low, middle)
        self.torque_at(low)
        return low


@pytest.fixture
def unit(folder, tables):
    found = Unit(folder, tables["crank_turns_per_input_turn"])
    found.begin(ANGLE)
    yield found
    found.slave.terminate()
    found.slave.freeInstance()


@pytest.mark.needs("compiler")
def test_fmu_torque_along_the_loop(unit, expected, tables):
    held = []
    for crank_angle, path in zip(ANGLES, expected[1], strict=True):
        unit.begin(crank_angle)
        held.append([unit.torque_at(wound) for wound in path])
    assert np.max(np.abs(held - expected[0])) < MOST_TORQUE * 2.0 * tables["limits"]["rated_torque_N_m"]


@pytest.mark.needs("compiler")
def test_fmu_wind_up_along_the_loop(unit, expected):
    found = []
    for crank_angle in ANGLES:
        unit.begin(crank_angle)
        found.append([unit.wound_by(torque) for torque in expected[0]])
    assert np.max(np.abs(found - expected[1])) < MOST_ANGLE


@pytest.mark.needs("compiler")
def test_fmu_play(unit, play, tables):
    low, high = edges(
        lambda wound: unit.torque_at(wound, goes_on=False), 1.1 * LIGHT * tables["limits"]["rated_torque_N_m"]
    )
    assert abs(high - low - play) < MOST_ANGLE


@pytest.mark.needs("compiler")
def test_fmu_is_driven_back(unit, driving_back):
    """Turned as the load would turn it, the input is held back below the torque that drives back, and pushed on above."""
    for part, pushed in ((0.95, False), (1.05, True)):
        angle = 0.0
        for _ in range(20):
            angle += 0.001 * np.sign(unit.ratio)
            low, high = 0.0, 0.01
            for _ in range(40):
                middle = 0.5 * (low + high)
                torque = unit.torque_at(middle, angle, goes_on=False)
                low, high = (middle, high) if torque < part * driving_back else (low, middle)
            unit.torque_at(low, angle)
        assert (unit.get("input_torque") * np.sign(unit.ratio) > 0.0) == pushed


@pytest.mark.needs("compiler")
def test_fmu_goes_back_to_a_kept_state(unit):
    unit.torque_at(0.004)
    kept = unit.slave.getFMUState()
    before = unit.torque_at(0.003, goes_on=False)
    unit.torque_at(-0.004)
    assert unit.torque_at(0.003, goes_on=False) != before
    unit.slave.setFMUState(kept)
    assert unit.torque_at(0.003, goes_on=False) == before
    unit.slave.freeFMUState(kept)


def test_description_of_the_unit_is_valid(folder):
    from fmpy.validation import validate_fmu

    assert validate_fmu(str(folder / "joint.fmu")) == []


@pytest.mark.parametrize("file", ["joint.xml", "joint.urdf"])
def test_models_load_without_a_warning(folder, file):
    heard = []
    mujoco.set_mju_user_warning(heard.append)
    try:
        model = mujoco.MjModel.from_xml_path(str(folder / file))
    finally:
        mujoco.set_mju_user_warning(None)
    assert heard == []
    assert model.nv == (2 if file.endswith("xml") else 1)


def test_spring_of_the_mjcf_alone(folder, tables):
    """Without the callback the tendon holds the rated torque at the mean wind-up of the table, half a turn of a play apart."""
    model = mujoco.MjModel.from_xml_path(str(folder / "joint.xml"))
    data = mujoco.MjData(model)
    data.qpos[1] = tables["wind_up"]["mean_rad"][-1]
    mujoco.mj_forward(model, data)
    rated = tables["limits"]["rated_torque_N_m"]
    # Both ways have one stiffness, the mean of two that differ by less than 1e-3 of a drive without errors.
    assert -data.qfrc_passive[1] == pytest.approx(rated, rel=1e-3)
    assert data.qfrc_passive[0] == pytest.approx(rated / tables["transmission_ratio"], rel=1e-3)


@pytest.mark.needs("compiler")
def test_fmu_of_a_printed_drive_follows_the_loop_of_a_mean_crank_angle(tmp_path):
    """With five pins and friction 0.1 single contacts show at each crank angle, which the law holds to its scatter alone.

    Over the crank angles the difference must vanish within the 2 % that are asked of the fit. 24 angles that the elements were
    not fitted at; at a scatter of 2.6 % their mean is known to 0.5 %.
    """
    file = load_drive(Path(__file__).parents[4] / "examples" / "drives" / "plastic.toml")
    printed = file.cases["aligned"].with_fields({"friction": {"pin": 0.1, "hole": 0.1}})
    tables = {"name": "joint", **reduce_drive(printed, HalfSpace()).content}
    write_simulator("fmu", tables, tmp_path)
    angles = 2.0 * np.pi * 5.0 * (np.arange(24) + 0.37) / 24.0
    torque = printed.load.torque * np.array([LIGHT, *loaded_path()])
    wound = locked_path(printed, angles, torque, engine=HalfSpace())
    unit, held = Unit(tmp_path, tables["crank_turns_per_input_turn"]), []
    for crank_angle, path in zip(angles, wound, strict=True):
        unit.begin(crank_angle)
        held.append([unit.torque_at(one) for one in path])
    expected = torque / (1e3 if printed.wheel_is_held else -1e3)
    off = (np.array(held) - expected) / (2.0 * printed.load.torque / 1e3)
    assert np.max(np.abs(off.mean(axis=0))) < 0.02
    told = tables["fit_error"]["worst"]
    # Scatter is told: that of other angles is one sample of it.
    assert np.max(off.std(axis=0)) < 1.5 * told["scatter_over_crank_angle_part_of_torque_range"]


def test_the_drive_without_friction_has_no_loop(drive):
    bare = reduce_drive(replace(drive, friction=None), HalfSpace()).content
    assert not any(bare["hysteresis"].values())
    assert bare["friction"]["driving_back_torque_N_m"] == {"ccw": 0.0, "cw": 0.0}
    assert set(bare["fit_error"]) == {"without_friction", "worst"}
    assert bare["fit_error"]["worst"]["part_of_torque_range"] < MOST_TORQUE
