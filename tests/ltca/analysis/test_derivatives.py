"""Derivatives of loads, poses and angles by fields of the drive, against differences of analyses that are balanced anew."""

from __future__ import annotations

from dataclasses import replace
from importlib.resources import files

import numpy as np
import pytest
from refusals import error_says, refused_field

import ltca
from ltca.analysis.derivatives import CENTRAL, FORWARD, LostMotion
from ltca.analysis.engines import HalfSpace, Hybrid, PlaneStrain
from ltca.analysis.torque_curve import torque_curve
from ltca.drive.fields import read_field
from ltca.equilibrium import newton
from ltca.errors import DriveError
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive
from ltca.testing.closed_form_bodies import closed_form_coefficients

ANGLES = np.array([0.1, 1.4])
ONE = ANGLES[:1]
"""Positions have nothing to do with each other: `test_paper` looks at two, the others at one."""
NAMES = ("wheel_angle", "pin_load", "roller_load", "pin_shaft_load", "pin_pressure_mid", "transmission_error_light")
RELATIVE = 1e-6
"""The issue's. Differences of fourth order over steps that change loads by some 1e-3 leave 1e-12 of them; analyses balance
to 1e-9 of the load, which such a step makes 1e-6 of the slope at most, and usually a hundredth of that."""


def shipped(name, case="nominal"):
    return load_drive(files("ltca.drives") / f"{name}.toml").cases[case]


@pytest.fixture(autouse=True)
def closely(monkeypatch):
    """Balance to a residual a thousand times smaller: differences divide what is left of it by their steps."""
    monkeypatch.setattr(newton, "TOLERANCE", 1e-12)


def differences(drive, path, step, engine, angles):
    """∂/∂path of the dataset by four analyses, each balanced anew."""
    value = float(read_field(drive, path))
    beside = [
        ltca.analyse(with_fields(drive, {path: value + part * step}), crank_angle=angles, compliance=engine).dataset
        for part in (-2.0, -1.0, 1.0, 2.0)
    ]
    return {
        name: (beside[0][name] - 8.0 * beside[1][name] + 8.0 * beside[2][name] - beside[3][name]).values / (12.0 * step)
        for name in NAMES
    }


def agree(drive, steps, engine=None, angles=ONE):
    engine = HalfSpace() if engine is None else engine
    result = ltca.analyse(drive, crank_angle=angles, compliance=engine)
    found, values = ltca.derivatives(result, list(steps)), result.dataset
    for path, step in steps.items():
        expected, mine = differences(drive, path, step, engine, angles), found.sel(field=path)
        for name in NAMES:
            # What does not follow the field at all is round-off by the step.
            size = float(np.max(np.abs(expected[name]), initial=0.0))
            size = max(size, 2e-6 * float(np.max(np.abs(values[name].values), initial=0.0)) / step)
            np.testing.assert_allclose(
                mine[name].values[None], expected[name], rtol=0.0, atol=RELATIVE * size, err_msg=f"{path}: {name}"
            )


def test_paper(paper_cases):
    agree(paper_cases["CS-3"], {"disc.shifting_offset": 2e-5, "load.torque": 300.0}, angles=ANGLES)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "case", "steps", "angles"),
    [
        ("paper", "CS-6", {"clearance.bearing": 2e-5}, ONE),
        ("robot-joint", "nominal", {"crank.eccentricity": 1e-5, "pin_shaft.hole_radius": 1e-5}, ONE),
        ("rv", "nominal", {"disc.equidistant_offset": 2e-6, "crank.support.diameter": 0.03}, ONE + 0.37),
        pytest.param(
            "sleeved",
            "nominal",
            {"pin_wheel.beam.span": 2e-3, "pin_shaft.beam.diameter": 1e-3},
            ONE,
            marks=pytest.mark.nightly,
        ),
    ],
)
def test_shipped_drives(name, case, steps, angles):
    """One disc; the wheel held by secants; cranks on springs; loose pins and beams that several discs bend.

    No pin of the RV is about to open at its angles, where steps to either side would differ.
    """
    agree(shipped(name, case), steps, angles=angles)


@pytest.mark.slow
def test_carrier():
    """Posts by differences; what twists behind all contacts turns the output by T/k alone, whose slope is −T/k²."""
    posts = {
        "carrier.posts.number": 3,
        "carrier.posts.radius": 42.0,
        "carrier.posts.size": 20.0,
        "carrier.flange": (10.0, 8.0),
    }
    drive = with_fields(shipped("rv"), posts | {"carrier.stiffness_torsion": 4e8})
    agree(drive, {"carrier.posts.size": 0.003, "carrier.flange.1": 0.003}, angles=ONE + 0.37)
    found = ltca.derivatives(
        ltca.analyse(drive, crank_angle=ONE, compliance=HalfSpace()), ["carrier.stiffness_torsion"]
    )
    slope = found["transmission_error"].values
    np.testing.assert_allclose(slope, -drive.driving_sign * drive.load.torque / 4e8**2, rtol=RELATIVE)
    np.testing.assert_allclose(found["pin_load"].values, 0.0, atol=1e-12)  # round-off of loads of kilonewtons


@pytest.mark.slow
def test_loose_bearings(paper_cases):
    """A clearance is a gap in series with the bearing, and its stiffness that of a shaft on two of them."""
    bearings = {
        "main_bearing.radial_stiffness": 5e5, "main_bearing.clearance": 0.02, "crank.support.diameter": 20.0,
        "crank.support.positions": (-20.0, 22.0), "crank.support.stiffness": (3e5, 4e5), "crank.support.clearance": 0.01,
    }  # fmt: skip
    drive = with_fields(paper_cases["CS-3"], bearings)
    agree(drive, {"main_bearing.clearance": 2e-5, "crank.support.clearance": 2e-5})


@pytest.mark.slow
def test_no_offsets_at_all(vary):
    agree(
        vary(disc={"equidistant_offset": 0.0, "shifting_offset": 0.0}, clearance={"bearing": 0.02, "pin_hole": 0.05}),
        {"materials.disc.youngs_modulus": 2000.0, "crank.axis_offset.x": 2e-5},
    )


@pytest.mark.slow
def test_plastic(vary):
    plastic = {"youngs_modulus": 2.6e3, "poisson_ratio": 0.38}
    drive = vary(materials={"disc": plastic}, load={"torque": 20_000.0, "light_torque": 500.0})
    agree(drive, {"pin_shaft.pin_circle_radius": 1e-3, "load.torque": 50.0})


@pytest.mark.slow
def test_two_discs_the_wheel_held_each_with_errors_of_its_own(vary):
    drive = vary(disc={"number_of_discs": 2}, installation={"held": "pin-wheel"})
    drive = with_fields(drive, {"disc.of.0.runout.amount": 0.004, "disc.of.1.runout.amount": 0.0})
    agree(drive, {"disc.of.0.runout.amount": 2e-5})


@pytest.mark.slow
def test_friction():
    """Slip follows the pose, and the motion turned back is followed as well."""
    drive = with_fields(shipped("robot-joint"), {"friction.pin": 0.05, "friction.hole": 0.05, "friction.roller": 1e-3})
    agree(drive, {"disc.shifting_offset": 2e-5, "friction.pin": 5e-4})


@pytest.mark.slow
@pytest.mark.parametrize("engine", [pytest.param(PlaneStrain, marks=pytest.mark.nightly), Hybrid])
def test_coupled_bodies(paper_cases, engine, tmp_path):
    """Fields that leave the body: clearances, loads, the place of a pin; stations of the coefficients move along."""
    path = tmp_path / "bodies.nc"
    closed_form_coefficients(paper_cases["CS-3"], half_width=0.02, depth=300.0).to_netcdf(path, engine="h5netcdf")
    agree(paper_cases["CS-3"], {"pin_wheel.pin_errors.radial.3": 1e-5, "load.torque": 300.0}, engine(coefficients=path))


SOFT_DISC = {"materials.disc.youngs_modulus": 3000.0, "materials.disc.poisson_ratio": 0.38, "load.torque": 50_000.0}


@pytest.mark.slow
def test_beside_a_lightly_loaded_pin(paper_cases):
    """Steps by the load of all contacts went over the opening of a pin with a thousandth of it: 1e-5 off here, 2 % elsewhere."""
    drive = with_fields(paper_cases["CS-3"], {**SOFT_DISC, "load.light_torque": 25_000.0})
    angles, path = [0.778], "disc.shifting_offset"
    result = ltca.analyse(drive, crank_angle=angles)
    loads = result.dataset["pin_load"].values.ravel()
    light = int(np.argmin(np.where(loads > 0.0, loads, np.inf)))
    assert loads[light] < 3e-4 * np.max(loads)
    step = 1e-6  # over which the pin keeps its load
    slope = differences(drive, path, step, HalfSpace(), angles)["pin_load"].ravel()
    found = ltca.derivatives(result, [path])["pin_load"].values.ravel()
    np.testing.assert_allclose(found[light], slope[light], rtol=RELATIVE)
    # Four analyses, of weights 1.5 in all, each balanced to 1e-9 of the load.
    np.testing.assert_allclose(found, slope, rtol=0.0, atol=1.5e-9 * np.sum(loads) / step)


@pytest.mark.slow
@pytest.mark.parametrize(("angle", "disc"), [pytest.param(1.6, 0, marks=pytest.mark.nightly), (5.0, 1)])
def test_a_disc_that_floats_under_the_light_torque(paper_cases, angle, disc):
    """A step by no stiffness ended in "a load is not a number"; the disc stays, or is taken along by what it touches."""
    drive = with_fields(
        paper_cases["CS-3"],
        {
            **SOFT_DISC,
            "load.light_torque": 2000.0,
            "installation.held": "pin-wheel",
            "clearance.bearing": 0.02,
            "clearance.pin_hole": 0.02,
            "disc.number_of_discs": 2,
            "disc.equidistant_offset": 0.03,
            "disc.shifting_offset": 0.0,
            "disc.runout.amount": 0.01,
            "disc.runout.angle": 0.3,
        },
    )
    result, name = ltca.analyse(drive, crank_angle=[angle]), "transmission_error_light"
    floating = result.loaded.light.response.parts[disc]
    assert floating.pin_load.max() < RELATIVE * result.loaded.light.response.pin_load.max()
    steps = {"load.light_torque": 2.0, "disc.equidistant_offset": 1e-6}
    found = ltca.derivatives(result, list(steps))
    for path, step in steps.items():
        expected = differences(drive, path, step, HalfSpace(), [angle])[name].ravel()
        # Balanced to 1e-9 of the load, of which a step is a thousandth; a step by round-off of the load's field made 1e-5.
        np.testing.assert_allclose(found[name].sel(field=path).values, expected, rtol=RELATIVE)


def test_contact_grids_are_refused_by_name(paper_cases):
    """Their loads change cell by cell: slopes over 1e-6 … 1e-3 mm scatter by some 1e-4."""
    result = ltca.analyse(paper_cases["CS-1"], crank_angle=ANGLES[:1], method="direct")
    with error_says(DriveError, starts="method direct: has no derivatives"):
        ltca.derivatives(result, ["disc.shifting_offset"])


@pytest.mark.slow
def test_zero_clearance_has_a_derivative_to_its_side(vary):
    """Clearances cannot be negative: differences to one side, of fourth order as well."""
    drive = vary(clearance={"bearing": 0.0, "pin_hole": 0.1})
    found = ltca.derivatives(ltca.analyse(drive, crank_angle=ONE), ["clearance.bearing"])
    step = 2e-6
    ends = [
        ltca.analyse(with_fields(drive, {"clearance.bearing": part * step}), crank_angle=ONE).dataset
        for part in range(5)
    ]
    weights = np.array([-25.0, 48.0, -36.0, 16.0, -3.0]) / (12.0 * step)
    expected = sum(weight * end["pin_load"].values for weight, end in zip(weights, ends, strict=True))
    # Both are differences to one side: some ten times what central ones leave.
    size = np.max(np.abs(expected))
    np.testing.assert_allclose(found["pin_load"].values, expected, rtol=0.0, atol=1e-5 * size)


def test_scalars_are_those_of_their_arrays(paper_cases):
    result = ltca.analyse(paper_cases["CS-3"], crank_angle=ANGLES)
    found = ltca.derivatives(result, ["disc.shifting_offset"])
    load = result.dataset["pin_load"].values.ravel()
    assert found["max_pin_load_N"].values[0] == found["pin_load"].values[0].ravel()[np.argmax(load)]
    assert found["field"].values.tolist() == ["disc.shifting_offset"]
    assert found["unit"].values.tolist() == ["mm"]
    assert found["pose"].dims == ("field", "position", "coordinate")


@pytest.mark.parametrize(
    ("path", "said"),
    [
        ("crank_bearing.number_of_rollers", ["must be a real number"]),
        ("installation.held", ["must be a real number"]),
        ("pin_wheel.pin_errors.radial", ["must be a real number, or an element ", "radial.0"]),
        ("disc.thicknes", ["is not a field"]),
    ],
)
def test_what_is_no_real_field_is_refused_by_name(paper_cases, path, said):
    result = ltca.analyse(paper_cases["CS-3"], crank_angle=ANGLES[:1])
    with refused_field(path, "", *said):
        ltca.derivatives(result, [path])


@pytest.mark.slow
def test_a_field_that_reshapes_a_body_is_refused_by_name(paper_cases, tmp_path):
    path = tmp_path / "bodies.nc"
    closed_form_coefficients(paper_cases["CS-1"], half_width=0.02, depth=300.0).to_netcdf(path, engine="h5netcdf")
    result = ltca.analyse(paper_cases["CS-1"], crank_angle=ANGLES[:1], compliance="hybrid", coefficients=path)
    with refused_field("disc.thickness", "", "reshapes a body"):
        ltca.derivatives(result, ["disc.thickness"])


def test_a_torque_of_its_own_has_no_field(paper_cases):
    result = ltca.analyse(paper_cases["CS-1"], crank_angle=ANGLES[:1], torque=2e5)
    with refused_field("load.torque", "", "the analysis has a torque of its own"):
        ltca.derivatives(result, ["load.torque"])


LOST_MOTION_DRIVES = {
    "robot-joint": ("robot-joint", {}, {"disc.shifting_offset": 1e-6, "crank.eccentricity": 1e-6}),
    "rv": ("rv", {}, {"clearance.bearing": 1e-6, "load.torque": 400.0}),
    "sleeved": ("sleeved", {}, {"disc.equidistant_offset": 1e-6}),
    "no offsets at all": (
        "paper", {"disc.equidistant_offset": 0.0, "disc.shifting_offset": 0.0, "clearance.bearing": 0.02},
        {"clearance.bearing": 1e-6, "materials.disc.youngs_modulus": 100.0},
    ),
    "two discs, the wheel held, friction": (
        "paper", {"disc.number_of_discs": 2, "installation.held": "pin-wheel", "load.direction": "cw", "friction.pin": 0.05},
        {"disc.shifting_offset": 1e-6},
    ),
}  # fmt: skip


def of_lost_motion(drive, steps, angles):
    """Slopes of the lost motion beside those of torque curves, which are balanced anew."""
    found = LostMotion(drive, angles)

    def read(one):
        return torque_curve(replace(one, friction=None), angles, points=0).lost_motion

    np.testing.assert_allclose(found.value, read(drive), rtol=1e-9)  # of poses from other starts, balanced to 1e-9
    for path, step in steps.items():
        value = float(read_field(drive, path))
        ends = [read(with_fields(drive, {path: value + part * step})) for part in (-2.0, -1.0, 1.0, 2.0)]
        expected = (ends[0] - 8.0 * ends[1] + 8.0 * ends[2] - ends[3]) / (12.0 * step)
        # Balanced to 1e-9 of the load, which a step changes by some 1e-3 at 3 % of the torque.
        size = np.max(np.abs(expected))
        np.testing.assert_allclose(found.slope(path), expected, rtol=0.0, atol=RELATIVE * size, err_msg=path)


@pytest.mark.slow
def test_lost_motion_follows_a_field(paper_cases):
    of_lost_motion(paper_cases["CS-3"], {"disc.shifting_offset": 1e-6, "load.torque": 300.0}, ONE)


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [pytest.param(one, marks=[] if one[:2] in ("no", "tw") else pytest.mark.nightly) for one in LOST_MOTION_DRIVES],
)
def test_lost_motion_of_other_drives(name, paper_cases):
    source, fields, steps = LOST_MOTION_DRIVES[name]
    drive = paper_cases["CS-3"] if source == "paper" else shipped(source)
    of_lost_motion(with_fields(drive, fields), steps, ONE)


def test_lost_motion_by_what_is_no_field_is_refused(paper_cases):
    with pytest.raises(DriveError, match=r"disc\.thicknes"):
        LostMotion(paper_cases["CS-3"], ONE).slope("disc.thicknes")


@pytest.mark.parametrize("stencil", [CENTRAL, FORWARD], ids=["central", "forward"])
def test_differences_are_exact_up_to_the_fourth_power(stencil):
    """Slope at zero of 1, s, …, s⁴: 1 of s, 0 of all others."""
    places, weights = stencil
    slopes = [float(weights @ places**power) for power in range(5)]
    np.testing.assert_allclose(slopes, [0.0, 1.0, 0.0, 0.0, 0.0], atol=1e-13)
