"""The elastic ring of the wheel: tangent and work, its rigid limit, and the fixed point made outside with errors of pins."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from refusals import refused_field

from ltca.analysis.derivatives import derivatives
from ltca.analysis.engines import HalfSpace, Hybrid, PlaneStrain
from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.results import labelled_results
from ltca.compliance.coefficients import load_coefficients
from ltca.drive.fields import read_field
from ltca.drive.members.temperatures import warm_drive
from ltca.drive.parts import WheelPinBeam, WheelPinSeat
from ltca.drive.single_discs import single_discs, without_own
from ltca.equilibrium.output_torque import solve_at_output
from ltca.errors import DriveError
from ltca.geometry.coordinates import WHEEL_ANGLE
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive
from ltca.studies.batch_analysis import BatchSettings, analyse_samples
from ltca.testing.balance_check import find_imbalance
from ltca.testing.closed_form_bodies import closed_form_coefficients
from ltca.testing.crank_drives import crank_drive
from ltca.testing.practical_drives import practical_drive
from ltca.testing.ring_statics import ring_by_statics

ANGLES = np.array([0.31, 1.7, 4.4])
BOLTS = {"ring.bolts.number": 6, "ring.bolts.circle_radius": 85.0, "ring.bolts.stiffness": 2e5}
AROUND = {
    "robot-joint": (60.0, 90.0, 50.0),
    "rv": (80.0, 110.0, 60.0),
    "paper": (82.0, 110.0, 20.0),
    "sleeved": (65.0, 85.0, 30.0),
}
"""Inner and outer radius and width of rings about shipped drives, mm."""


def ringed(name, **fields):
    drive = next(iter(load_drive(name).cases.values()))
    inner, outer, width = AROUND[name]
    shape = {"ring.inner_radius": inner, "ring.outer_radius": outer, "ring.width": width}
    return with_fields(drive, shape | {f"ring.{key}": value for key, value in fields.items()})


def kind(name):
    """Rings of all kinds around drives of all kinds."""
    if name == "free":
        return ringed("robot-joint")
    if name == "bolted":
        return with_fields(ringed("robot-joint"), BOLTS)
    if name == "built-in":
        return ringed("robot-joint", flange="built-in")
    if name == "bolted, slots and beams":
        drive = with_fields(ringed("robot-joint"), BOLTS)
        wheel = replace(
            drive.pin_wheel,
            seat=WheelPinSeat(kind="slot", radius=2.504),
            beam=WheelPinBeam(span=30.0, ends="supported"),
            support_stiffness=5e5,
        )
        return replace(drive, pin_wheel=wheel)
    if name == "free, sleeves and beams":
        drive = ringed("robot-joint")
        seat = WheelPinSeat(kind="sleeve", pin_radius=1.5, bore_radius=1.51)
        return replace(
            drive, pin_wheel=replace(drive.pin_wheel, seat=seat, beam=WheelPinBeam(span=30.0, ends="clamped"))
        )
    if name == "one disc, shaft held":
        return ringed("paper")
    if name == "one disc, wheel held":
        return with_fields(ringed("paper"), {"installation.held": "pin-wheel"})
    if name == "plastic ring":
        return ringed("robot-joint", **{"material.youngs_modulus": 9000.0, "material.poisson_ratio": 0.4})
    assert name == "rv"
    return ringed("rv")


QUICK = ("built-in", "one disc, shaft held")
SLOW = ("free", "bolted", "bolted, slots and beams", "one disc, wheel held", "rv")
NIGHTLY = ("free, sleeves and beams", "plastic ring")
"""Dear ones: seats, beams and soft rings are of every full run by energies alone."""
BY_ENERGIES = [*QUICK, *(pytest.param(name, marks=pytest.mark.slow) for name in (*SLOW, *NIGHTLY))]
KINDS = [
    *QUICK,
    *(pytest.param(name, marks=pytest.mark.slow) for name in SLOW),
    *(pytest.param(name, marks=pytest.mark.nightly) for name in NIGHTLY),
]


@pytest.mark.family(quick=1, full=3)
@pytest.mark.parametrize("name", KINDS)
def test_tangent_is_the_slope_of_the_force(name, tangent_and_slope):
    scaled, slope = tangent_and_slope(kind(name), ANGLES[:1])
    # differences of second order over 1e-7 mm: round-off of loads of 1e4 N by the step, and contacts that just open
    np.testing.assert_allclose(slope, scaled, rtol=0.0, atol=2e-6 * np.abs(scaled).max())


@pytest.mark.family(quick=1, full=3)
@pytest.mark.parametrize("name", KINDS)
def test_virtual_work_at_every_position(name, unbalanced_work):
    """With the energy ½ fᵀSf of the ring."""
    # differences of fourth order over 1e-4 rad, and contacts that open within
    np.testing.assert_allclose(unbalanced_work(kind(name), ANGLES + 0.05), 0.0, atol=1e-7)


@pytest.mark.parametrize("name", BY_ENERGIES)
def test_confirmed_by_energies_alone(name):
    drive = kind(name)
    model, found = solved(drive, ANGLES[:1])
    assert find_imbalance(drive, model, found, torque=drive.load.torque) == []


def test_the_check_sees_a_ring_left_out():
    drive = kind("free")
    model, _ = solved(drive, ANGLES[:1])
    _, rigid = solved(replace(drive, ring=None), ANGLES[:1])
    assert any("place of a wheel pin" in problem for problem in find_imbalance(drive, model, rigid))


@pytest.mark.family(quick=1)
@pytest.mark.parametrize("name", ["free", "built-in", pytest.param("rv", marks=pytest.mark.slow)])
def test_a_rigid_ring_is_a_ring_left_out(name):
    drive = kind(name)
    rigid = with_fields(drive, {"ring.material.youngs_modulus": 1e15})
    found, expected = (analyse(each, ANGLES).full for each in (rigid, replace(drive, ring=None)))
    # 206e3/1e15 of the displacements of a steel ring, 1e-12 mm beside approaches of 5e-3, and the balance's own 1e-9.
    largest = expected.response.pin_load.max()
    np.testing.assert_allclose(found.response.pin_load, expected.response.pin_load, rtol=0.0, atol=1e-8 * largest)
    np.testing.assert_allclose(found.pose[:, WHEEL_ANGLE], expected.pose[:, WHEEL_ANGLE], rtol=1e-9)


def solved(drive, angles, engine=None, start=None):
    model = (engine or HalfSpace()).prepare(drive).model
    return model, solve_at_output(model, [drive], angles, drive.load.torque, start)


def made_outside(drive, angle, engine=None):
    """Loads → displacements of the ring by statics → errors of the places of single pins → loads, with Anderson's acceleration
    of an underrelaxed iteration, until the displacements repeat to 1e-10 mm.
    """
    pins, rigid = drive.pin_wheel.number_of_pins, replace(drive, ring=None)
    flexibility = ring_by_statics(drive).reshape(2 * pins, -1)
    ray = np.exp(2j * np.pi * np.arange(pins) / pins)
    pose, moved, known, left = None, np.zeros(2 * pins), [], []
    for _ in range(60):
        places = (moved[::2] + 1j * moved[1::2]) * ray.conj()
        errors = {"radial": tuple(places.real), "tangential": tuple(places.imag)}
        there = with_fields(rigid, {f"pin_wheel.pin_errors.{name}": value for name, value in errors.items()})
        _, found = solved(there, np.array([angle]), engine, pose)
        pose = found.pose
        turned = angle * drive.tooth_number_difference / pins + pose[0, WHEEL_ANGLE]
        force = sum(part.pin_forces[0, :pins] for part in found.response.parts) * np.exp(-1j * turned)
        rest = flexibility @ np.ravel(np.column_stack((force.real, force.imag))) - moved
        if np.abs(rest).max() < 1e-10:
            return found
        known, left = [*known, moved], [*left, rest]
        moved = moved + 0.3 * rest
        if len(known) > 1:
            before, changes = np.diff(known, axis=0).T, np.diff(left, axis=0).T
            moved = moved - (before + 0.3 * changes) @ np.linalg.lstsq(changes, rest, rcond=1e-10)[0]
    raise AssertionError("the iteration outside does not converge")


@pytest.mark.family(quick=1)
@pytest.mark.parametrize(
    "name",
    [
        "one disc, shaft held",
        *(pytest.param(name, marks=pytest.mark.slow) for name in ("rv", "built-in")),
        *(pytest.param(name, marks=pytest.mark.nightly) for name in ("free", "bolted")),
    ],
)
def test_fixed_point_made_outside(name):
    """No normal is linearised on either side, and the ring's displacement comes from statics: equal to 1e-6 of the load."""
    drive = kind(name)
    for angle in ANGLES[:2]:
        _, found = solved(drive, np.array([angle]))
        expected = made_outside(drive, angle)
        largest = found.response.pin_load.max()
        # Places repeat to 1e-10 mm; stiffnesses of 1e5 N/mm, loads of 1e3 N.
        np.testing.assert_allclose(found.response.pin_load, expected.response.pin_load, rtol=0.0, atol=1e-6 * largest)
        np.testing.assert_allclose(found.pose[:, WHEEL_ANGLE], expected.pose[:, WHEEL_ANGLE], rtol=1e-7)
        rigid = solved(replace(drive, ring=None), np.array([angle]))[1]
        moved = np.abs(found.response.pin_load - rigid.response.pin_load).max()
        assert moved > (0.01 if name == "built-in" else 0.1) * largest


@pytest.mark.slow
@pytest.mark.parametrize("engine", ["hybrid", "fe"])
def test_fixed_point_made_outside_with_bodies(engine, tmp_path):
    """On the disc's own body contacts of a disc feel each other as well as the ring under all of them."""
    drive = kind("one disc, shaft held")
    drive = with_fields(drive, {"crank_bearing.roller_length": drive.disc.thickness})
    (single,) = single_discs(replace(drive, ring=None))
    file = tmp_path / "body.nc"
    closed_form_coefficients(single, half_width=0.02, depth=300.0).to_netcdf(file, engine="h5netcdf")
    bodies = load_coefficients(file, single)
    beside_bodies(drive, Hybrid(coefficients=bodies) if engine == "hybrid" else PlaneStrain(coefficients=bodies))


@pytest.mark.slow
@pytest.mark.nightly
def test_fixed_point_made_outside_with_shipped_coefficients():
    beside_bodies(kind("one disc, shaft held"), Hybrid())


def beside_bodies(drive, engine):
    found, expected = solved(drive, ANGLES[:1], engine)[1], made_outside(drive, ANGLES[0], engine)
    largest = found.response.pin_load.max()
    # Places repeat to 1e-10 mm; stiffnesses of 1e5 N/mm, loads of 1e3 N.
    np.testing.assert_allclose(found.response.pin_load, expected.response.pin_load, rtol=0.0, atol=1e-6 * largest)


@pytest.mark.slow
def test_contact_grids_feel_the_ring():
    """Method direct left the ring out in silence: loads of the rigid one, more than half of the largest beside."""
    drive = ringed("paper")
    tables = analyse(drive, ANGLES[:1]).full.response.pin_load
    found = analyse(drive, ANGLES[:1], engine=HalfSpace(method="direct")).full.response.pin_load
    # Grids and tables are 0.2 % apart without a ring.
    np.testing.assert_allclose(found, tables, rtol=0.0, atol=5e-3 * tables.max())


@pytest.mark.slow
def test_tables_are_compared_with_grids_at_the_displaced_pins():
    """Grids that check the tables took the pins for those of a rigid ring, and told of loads 100 % beside."""
    drive, angle = practical_drive(116)
    alone = single_discs(without_own(replace(drive, ring=None)))[0]
    circle = alone.pin_wheel.pin_circle_radius
    shape = {"inner_radius": circle, "outer_radius": 1.5 * circle, "width": alone.disc.thickness}
    alone = with_fields(
        alone, {"installation.held": "pin-shaft"} | {f"ring.{key}": value for key, value in shape.items()}
    )
    (warning,) = [
        text
        for text in analyse(alone, np.array([angle]), 100.0 * alone.load.torque).warnings
        if "--method direct" in text
    ]
    # 1.5 % of a rigid ring.
    assert float(warning.split(" differs by ")[1].split(" %")[0]) < 5.0


@pytest.mark.family(quick=1)
@pytest.mark.parametrize("coefficients", [{"friction.pin": 0.05, "friction.hole": 0.04}, {"friction.pin": 0.1}])
def test_friction_moves_the_pins_along_the_ring(coefficients):
    """Displacements did not settle beside friction: what it adds to the forces on the pins was missing in their slopes."""
    drive = with_fields(ringed("paper", **{"material.youngs_modulus": 70e3}), coefficients)
    model, found = solved(drive, ANGLES[:1])
    assert find_imbalance(drive, model, found, torque=drive.load.torque) == []


@pytest.mark.slow
def test_soft_rings_on_which_contacts_alternate():
    """Displacements went back and forth by 10 µm: of a ring of aluminium about 100 pins steps by the residual settle nothing."""
    drive, angle = crank_drive(298)
    assert drive.ring is not None
    model, found = solved(drive, np.array([angle]))
    assert find_imbalance(drive, model, found, torque=drive.load.torque) == []


def test_engines_with_rigid_rings_tell_what_the_ring_has():
    """Of a material or bolts in a ring the refusal broke off: "unsupported format string"."""
    drive = with_fields(ringed("paper", **{"material.youngs_modulus": 70e3}), BOLTS)
    with pytest.raises(DriveError) as refused:
        HalfSpace(method="paper").prepare(drive)
    (told,) = refused.value.problems
    assert "ring.material.youngs_modulus = 70000 MPa, ring.bolts.number = 6, ring.bolts.circle_radius = 85 mm" in told
    assert "must be left out for method paper (the wheel pins stand in a rigid ring in the model)" in told


def test_the_ring_grows_by_its_own_expansion():
    drive = with_fields(
        ringed("robot-joint", **{"material.thermal_expansion": 2.3e-5}),
        {"temperature.housing": 60.0}
        | {
            f"materials.{part}.thermal_expansion": 1.15e-5
            for part in ("disc", "wheel_pin", "roller", "inner_race", "shaft_pin")
        },
    )
    warm = warm_drive(drive)
    assert warm.pin_wheel.pin_circle_radius == pytest.approx(60.0 * (1.0 + 2.3e-5 * 40.0), rel=1e-12)
    assert warm.pin_wheel.pin_radius == pytest.approx(2.5 * (1.0 + 1.15e-5 * 40.0), rel=1e-12)
    with refused_field(
        "ring.material.thermal_expansion",
        "= 2.3e-05 1/K",
        "must equal materials.wheel_seat",
        bound=("equal to", 1.2e-5),
    ):
        with_fields(drive, {"materials.wheel_seat.thermal_expansion": 1.2e-5})


def test_ring_grows_with_the_wheel():
    drive = with_fields(ringed("robot-joint"), BOLTS)
    expansion = {
        f"materials.{part}.thermal_expansion": 1.15e-5
        for part in ("disc", "wheel_pin", "roller", "inner_race", "shaft_pin")
    }
    warm = warm_drive(
        with_fields(
            drive, expansion | {"temperature.housing": 60.0, "temperature.disc": 20.0, "temperature.shaft": 20.0}
        )
    )
    ring, wheel = warm.ring, warm.pin_wheel
    lengths = (ring.inner_radius, ring.outer_radius, ring.width, ring.bolts.circle_radius)
    growth = wheel.pin_circle_radius / drive.pin_wheel.pin_circle_radius
    assert growth == pytest.approx(1.0 + 1.15e-5 * 40.0, rel=1e-12)
    np.testing.assert_allclose(lengths, growth * np.array([60.0, 90.0, 50.0, 85.0]), rtol=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("field", "values"),
    [
        ("ring.width", (50.0, 40.0)),
        ("ring.outer_radius", (90.0, 84.0)),
        pytest.param("ring.material.poisson_ratio", (0.3, 0.2), marks=pytest.mark.nightly),
        ("ring.bolts.stiffness", (2e5, 5e4)),
        pytest.param("ring.bolts.circle_radius", (85.0, 80.0), marks=pytest.mark.nightly),
    ],
)
def test_samples_of_rings_are_those_of_each_alone(field, values):
    """Many drives at once have the ring of each, not of the first: a study or tolerances of a ring."""
    drives = [with_fields(ringed("robot-joint"), BOLTS | {field: value}) for value in values]
    settings = BatchSettings(
        crank_angle=ANGLES[:2], quantities=("mean_transmission_error", "max_pin_load"), engine=HalfSpace(), nominal=None
    )
    together = analyse_samples(drives, settings)
    alone = np.concatenate([analyse_samples([drive], settings).values for drive in drives])
    assert together.messages == ("", "")
    # Solved from other starts: 1e-9 of the load
    np.testing.assert_allclose(together.values, alone, rtol=1e-8)
    assert np.ptp(alone[:, 1]) > 1e-4 * alone[0, 1]


@pytest.mark.slow
@pytest.mark.nightly
def test_derivatives_by_fields_of_the_ring():
    drive = with_fields(ringed("robot-joint"), BOLTS)
    fields = {"ring.outer_radius": 2e-3, "ring.bolts.stiffness": 20.0}
    found = derivatives(analyse(drive, ANGLES[:1]), list(fields))["pin_load"]
    for path, step in fields.items():
        value = read_field(drive, path)
        loads = [
            labelled_results("", {"": analyse(with_fields(drive, {path: value + side * step}), ANGLES[:1])})["pin_load"]
            for side in (1.0, -1.0)
        ]
        slope = (loads[0].values - loads[1].values).squeeze() / (2.0 * step)
        # Differences of second order over some 2e-5 of a field, of loads that balance to 1e-9.
        np.testing.assert_allclose(found.sel(field=path).values.squeeze(), slope, atol=1e-4 * np.abs(slope).max())


@pytest.mark.slow
def test_a_soft_ring_settles_by_its_step():
    """A plastic ring 6 mm high: what is left of displacements is its flexibility times the round-off of loads, 1e-10 mm; told not
    to settle, or after 300 iterations, before."""
    ring = {
        "inner_radius": 60.0,
        "outer_radius": 66.0,
        "width": 10.0,
        "material": {"youngs_modulus": 2600.0, "poisson_ratio": 0.38},
    }
    drive = with_fields(
        load_drive("robot-joint").cases["nominal"], {"ring": ring, "load.torque": 2e4, "load.light_torque": 600.0}
    )
    model = HalfSpace().prepare(drive).model
    found = solve_at_output(model, [drive], np.array([1.2]), drive.load.torque)
    assert found.iterations[0] < 50
    assert find_imbalance(drive, model, found, torque=drive.load.torque) == []
