"""Files of ``cyclo export --for``: they load where they belong, hold what the analysis says, and wrong input leaves nothing."""

from __future__ import annotations

import json
import sys
import zipfile

import needs
import numpy as np
import pytest

from ltca.analysis.engines import HalfSpace
from ltca.analysis.reduced_model.reduced_drive import ReducedDrive
from ltca.commands.program import main
from ltca.drive.units.quantities import ARCMIN
from ltca.dynamics.kinetics import reflected_inertia
from ltca.dynamics.masses import INERTIA
from ltca.export.simulators.files import write_simulator
from ltca.export.simulators.lookup_tables import readme_text
from ltca.output.run_folder import MANIFEST
from ltca.reading.drive_file import load_drive, shipped_drive

pytestmark = pytest.mark.slow
mujoco, fmpy = needs.optional("mujoco"), needs.optional("fmpy")
MOST_ANGLE = 0.02 / ARCMIN
"""Bound of the task; errors are half of it."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The paper's drive with a speed: tables by the command, the other formats written of the same ones."""
    out = tmp_path_factory.mktemp("formats")
    text = shipped_drive("paper").replace('direction = "ccw" ', 'speed = 1500.0\ndirection = "ccw" ', 1)
    (out / "drive.toml").write_text(text)
    given = ["export", str(out / "drive.toml"), "--case", "CS-4", "--for", "json", "--out", str(out / "json")]
    assert main(given) == 0
    for kind in ("mujoco", "urdf", "modelica", "fmu"):
        write_simulator(kind, json.loads((out / "json" / "paper_CS_4.json").read_text()), out / kind)
    return out


@pytest.fixture(scope="module")
def tables(folder):
    return json.loads((folder / "json" / "paper_CS_4.json").read_text())


def test_files_of_every_format(folder):
    def names(kind):
        return {path.name for path in (folder / kind).iterdir()} - {MANIFEST}

    tables = {f"paper_CS_4_{end}.csv" for end in ("wind_up", "friction", "hysteresis", "hysteresis_factor")}
    assert names("json") == {"paper_CS_4.json", "reduced_drive.py", "paper_CS_4_readme.md", *tables}
    assert names("mujoco") == {"paper_CS_4.xml", "paper_CS_4.json", "mujoco_callback.py", "reduced_drive.py"}
    assert names("urdf") == {"paper_CS_4.urdf", "paper_CS_4.json"}
    assert names("modelica") == {"paper_CS_4.mo"}
    assert names("fmu") == {"paper_CS_4.fmu"}


def test_model_says_whose_it_is_and_how_good(tables):
    drive = load_drive("paper").cases["CS-4"].with_fields({"load.speed": 1500.0})
    assert tables["fingerprint"] == drive.fingerprint()
    assert tables["transmission_ratio"] == drive.transmission_ratio
    own = reflected_inertia(drive)
    assert tables["inertia"]["at_input_kg_m2"] == pytest.approx(own.at_input / INERTIA)
    # One inertia, referred to both ends.
    assert tables["inertia"]["at_output_kg_m2"] == pytest.approx(
        tables["inertia"]["at_input_kg_m2"] * drive.transmission_ratio**2
    )
    assert tables["limits"]["input_speed_rpm"] == 1500.0
    assert tables["fit_error"]["worst"]["part_of_torque_range"] < 0.02
    assert tables["fit_error"]["worst"]["angle_rad"] < MOST_ANGLE


def test_damping_that_is_missing_is_told_in_words(tables):
    given = {"at_output_N_m_s_per_rad": 2.5, "words": "of [damping]"}
    missing = {"at_output_N_m_s_per_rad": None, "words": "no [damping]"}
    assert "Damping at the output: 2.5 N·m·s/rad (of [damping])." in readme_text({**tables, "damping": given})
    assert "Damping at the output: not given (no [damping])." in readme_text({**tables, "damping": missing})


def test_wind_up_is_that_of_the_analysis(tables):
    """Through a torque at a crank angle of a later turn, by the drive's own balance."""
    from dataclasses import replace

    from ltca.equilibrium.output_angle import wheel_angle_of_input
    from ltca.equilibrium.output_torque import solve_at_output

    drive = load_drive("paper").cases["CS-4"]
    model = replace(HalfSpace().prepare(drive).model, friction=None)
    angle, torque = np.array([31.0, 47.7]), 0.55 * drive.load.torque
    wound = drive.output_deviation(wheel_angle_of_input(model, solve_at_output(model, [drive], angle, torque)), torque)
    law = ReducedDrive(tables)
    for crank_angle, expected in zip(angle, wound, strict=True):
        at = crank_angle / law.cranks
        nodes = law.wind_up_nodes(at)
        assert np.interp(-torque / 1e3, law.torque, nodes) == pytest.approx(expected, abs=MOST_ANGLE)


@pytest.fixture(scope="module")
def stops():
    """Crank angle, and the output's angle against the input where it begins to hold cw and ccw, rad, by the analysis."""
    from dataclasses import replace

    from ltca.equilibrium.output_angle import wheel_angle_of_input
    from ltca.equilibrium.output_torque import solve_at_output

    drive, crank_angle = load_drive("paper").cases["CS-4"], np.array([3.0, 3.0])
    model = replace(HalfSpace().prepare(drive).model, friction=None)
    # The pin shaft is held and the crank drives ccw: the wheel goes cw, and a positive torque turns it ccw against the crank's
    # sense of driving it, to the lower stop in the convention of the deviation (cw in its own sense).
    load = np.array([1e-4, -1e-4]) * drive.load.torque
    found = solve_at_output(model, [drive], crank_angle, load)
    low, high = drive.output_deviation(wheel_angle_of_input(model, found), load)
    assert low < 0.0 < high
    return 3.0, float(low), float(high)


BESIDE = 0.1 / ARCMIN
"""Five times the bound of angles: beyond a stop by so much the drive holds, within it does not."""


def held_by_law(folder, tables, angles):
    return ReducedDrive(tables).step(*angles)


def held_by_callback(folder, tables, angles):
    sys.path.insert(0, str(folder / "mujoco"))
    try:
        from mujoco_callback import DriveCallback

        joint = mujoco.MjModel.from_xml_path(str(folder / "mujoco" / "paper_CS_4.xml"))
        data = mujoco.MjData(joint)
        mujoco.set_mjcb_passive(DriveCallback(joint, folder / "mujoco" / "paper_CS_4.json"))
        data.qpos[:] = angles
        mujoco.mj_forward(joint, data)
        return tuple(data.qfrc_passive)
    finally:
        mujoco.set_mjcb_passive(None)
        sys.path.remove(str(folder / "mujoco"))
        for name in ("mujoco_callback", "reduced_drive"):
            sys.modules.pop(name, None)


def held_by_unit(folder, tables, angles):
    values = dict(zip(("input_angle", "output_angle"), angles, strict=True))
    path = str(folder / "fmu" / "paper_CS_4.fmu")
    answer = fmpy.simulate_fmu(path, stop_time=0.1, output_interval=0.1, start_values=values)
    return answer["input_torque"][-1], answer["output_torque"][-1]


@pytest.mark.parametrize(
    "held",
    [
        held_by_law,
        pytest.param(held_by_callback, marks=pytest.mark.needs("robotics")),
        pytest.param(held_by_unit, marks=pytest.mark.needs("robotics", "compiler")),
    ],
)
def test_play_lies_where_the_analysis_has_it_and_torques_push_back(held, folder, tables, stops):
    """Beyond either stop the drive pushes the output back, within neither; the input takes part 1/i of it the other way."""
    crank_angle, low, high = stops
    stiffness, ratio = tables["linear_spring"]["stiffness_N_m_per_rad"], tables["transmission_ratio"]
    at = crank_angle / ReducedDrive(tables).cranks
    for wound, back in ((low - BESIDE, 1.0), (low + BESIDE, 0.0), (high - BESIDE, 0.0), (high + BESIDE, -1.0)):
        on_input, on_output = held(folder, tables, (at, at / ratio + wound))
        # A tenth of the mean spring: contacts at their first touch are softer. Within, the light torque alone is there.
        least = 0.1 * stiffness * BESIDE
        assert back * on_output > least if back else abs(on_output) < 1e-3 * tables["limits"]["rated_torque_N_m"]
        # Turned together by dφ and dφ/i nothing is wound up: T_in dφ + T_out dφ/i = 0.
        assert on_input == pytest.approx(-on_output / ratio, abs=1e-9)


@pytest.mark.needs("robotics")
def test_mujoco_loads_both_models_without_a_warning(folder, tables):
    heard = []
    mujoco.set_mju_user_warning(heard.append)
    try:
        joint = mujoco.MjModel.from_xml_path(str(folder / "mujoco" / "paper_CS_4.xml"))
        alone = mujoco.MjModel.from_xml_path(str(folder / "urdf" / "paper_CS_4.urdf"))
    finally:
        mujoco.set_mju_user_warning(None)
    assert heard == []
    assert (joint.nv, alone.nv) == (2, 1)
    data, spring = mujoco.MjData(joint), tables["linear_spring"]
    data.qpos[1] = spring["stops_rad"][1] + 1e-3  # the tendon alone, a milliradian behind the play
    mujoco.mj_forward(joint, data)
    force = 1e-3 * spring["stiffness_N_m_per_rad"]
    assert data.qfrc_passive == pytest.approx([force / tables["transmission_ratio"], -force])
    data.qpos[1] = 0.5 * spring["stops_rad"][1]
    mujoco.mj_forward(joint, data)
    assert data.qfrc_passive == pytest.approx([0.0, 0.0])


@pytest.mark.needs("robotics")
def test_callback_puts_the_law_in_place_of_the_spring(folder, tables):
    sys.path.insert(0, str(folder / "mujoco"))
    try:
        from mujoco_callback import DriveCallback

        joint = mujoco.MjModel.from_xml_path(str(folder / "mujoco" / "paper_CS_4.xml"))
        data = mujoco.MjData(joint)
        mujoco.set_mjcb_passive(DriveCallback(joint, folder / "mujoco" / "paper_CS_4.json"))
        law = ReducedDrive(tables)
        data.qpos[:] = 2.0, 2.0 / law.ratio + 0.002
        mujoco.mj_forward(joint, data)
        torque = law.elastic_torque(2.0, 2.0 / law.ratio + 0.002)
        assert torque > 1.0
        assert data.qfrc_passive == pytest.approx([torque / law.ratio, -torque])
    finally:
        mujoco.set_mjcb_passive(None)
        sys.path.remove(str(folder / "mujoco"))
        for name in ("mujoco_callback", "reduced_drive"):
            sys.modules.pop(name, None)


@pytest.mark.needs("robotics", "compiler")
def test_unit_is_valid_and_answers(folder, tables):
    from fmpy.validation import validate_fmu

    path = str(folder / "fmu" / "paper_CS_4.fmu")
    assert validate_fmu(path) == []
    law = ReducedDrive(tables)
    values = {"input_angle": 3.0, "output_angle": 3.0 / law.ratio - 0.0021}
    answer = fmpy.simulate_fmu(path, stop_time=0.1, output_interval=0.1, start_values=values)
    torque = law.elastic_torque(*values.values())
    assert torque < -10.0
    # The C code and numpy do the same sums in another order.
    assert answer["output_torque"][-1] == pytest.approx(-torque, rel=1e-9)
    assert answer["input_torque"][-1] == pytest.approx(torque / law.ratio, rel=1e-9)


@pytest.mark.needs("referee")
def test_modelica_parses(folder):
    from pymoca import parser

    text = (folder / "modelica" / "paper_CS_4.mo").read_text()
    tree = parser.parse(text)
    assert list(tree.classes["paper_CS_4"].classes) == ["interpolate", "windUpNodes", "strengthFactor", "Drive"]
    with pytest.raises(SyntaxError):  # that the parser can fail
        parser.parse(text.replace("end Drive;", "end Drive", 1))


def test_same_input_gives_the_same_bytes(folder, tables, tmp_path):
    write_simulator("fmu", tables, tmp_path)
    assert (tmp_path / "paper_CS_4.fmu").read_bytes() == (folder / "fmu" / "paper_CS_4.fmu").read_bytes()


def test_without_a_compiler_the_sources_are_there(tables, tmp_path, monkeypatch):
    monkeypatch.setenv("CC", "no-such-compiler")
    (told,) = write_simulator("fmu", tables, tmp_path)
    assert told.startswith("not compiled: no C compiler")
    names = zipfile.ZipFile(tmp_path / "paper_CS_4.fmu").namelist()
    assert names == ["modelDescription.xml", "sources/reduced_drive.c", "sources/reduced_drive_tables.h"]


@pytest.mark.parametrize(
    ("given", "told"),
    [
        (["--for", "json", "--part", "disc"], "--part: has no effect with --for json"),
        (["--for", "fmu", "--compensate", "0.1"], "--compensate: has no effect with --for fmu"),
        (["--for", "urdf"], "load.speed: must be given for --for urdf, whose <limit> has a velocity: by --speed N"),
        (["--for", "urdf", "--speed", "0"], "--speed = 0: must be greater than 0"),
        (["--format", "csv", "--speed", "1500"], "--speed: has no effect with --format, only with --for"),
        (["--format", "csv", "--quick"], "--quick: has no effect with --format, only with --for"),
        (["--for", "json", "--quick", "--compliance", "fe"], "--quick: is half-spaces, not --compliance fe"),
    ],
)
def test_wrong_input_is_refused_and_leaves_nothing(given, told, tmp_path, capsys):
    out = tmp_path / "out"
    assert main(["export", "paper", "--case", "CS-4", *given, "--out", str(out)]) == 2
    error = capsys.readouterr().err
    assert told in error
    assert error.count("\n") == 1
    assert not out.exists()


@pytest.mark.parametrize(
    ("given", "told"),
    [
        (["--for", "json", "--format", "dxf"], "argument --format: not allowed with argument --for"),
        ([], "one of the arguments --format --for is required"),
        (["--for", "gazebo"], "argument --for: invalid choice: 'gazebo'"),
    ],
)
def test_one_of_two_options_is_given(given, told, tmp_path, capsys):
    with pytest.raises(SystemExit) as end:
        main(["export", "paper", *given, "--out", str(tmp_path / "out")])
    assert end.value.code == 2
    assert told in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_density_that_is_missing_is_named(tmp_path, capsys):
    text = shipped_drive("paper").replace('roller = { like = "100Cr6", ', "roller = { ")
    (tmp_path / "drive.toml").write_text(text)
    given = ["export", str(tmp_path / "drive.toml"), "--case", "CS-4", "--out", str(tmp_path / "out")]
    assert main([*given, "--for", "mujoco"]) == 2
    assert "materials.roller.density: must be given for --for mujoco" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
    assert main([*given, "--for", "modelica"]) == 0  # a law without masses
