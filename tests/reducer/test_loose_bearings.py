"""Main bearing and crank bearings with clearance or preload in whole drives: work, the independent check, play, limits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ltca.analysis.engines import HalfSpace
from ltca.analysis.loaded_analysis import analyse
from ltca.drive.members.main_bearing import MainBearing
from ltca.drive.members.temperatures import warm_drive
from ltca.equilibrium.output_torque import solve_at_output
from ltca.geometry.coordinates import WHEEL_ANGLE
from ltca.geometry.play import free_play
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import parse_drive, shipped_drive
from ltca.testing.balance_check import find_imbalance
from ltca.testing.crank_drives import crank_drive
from ltca.testing.practical_drives import compare

ANGLES = np.array([0.31, 1.7, 4.4])
CRANKS = {
    "crank.support.diameter": 20.0,
    "crank.support.positions": (-22.0, 22.0),
    "crank.support.stiffness": (3e5, 4e5),
}
LOOSE = {"main_bearing.radial_stiffness": 5e5, "main_bearing.clearance": 0.03, "crank.support.clearance": 0.01}
TIGHT = {"main_bearing.radial_stiffness": 5e5, "main_bearing.preload": 200.0, "crank.support.preload": 300.0}


def drive_of(name):
    """The paper's drive and the shipped ones, on crank bearings; the joint's discs of a plastic as well."""
    if name == "paper":
        return with_fields(parse_drive(shipped_drive("paper"), "paper").cases["CS-6"], CRANKS)
    if name == "plastic":
        plastic = {"materials.disc.youngs_modulus": 2800.0, "materials.disc.poisson_ratio": 0.38}
        return with_fields(drive_of("robot-joint"), plastic)
    drive = parse_drive(shipped_drive(name), name).cases["nominal"]
    return drive if name == "rv" else with_fields(drive, CRANKS)


def balanced(drive, angles=ANGLES):
    model = HalfSpace().prepare(warm_drive(drive)).model
    return model, solve_at_output(model, [drive], angles, drive.load.torque)


@pytest.mark.family(quick=1, full=4)
@pytest.mark.parametrize("words", [LOOSE, TIGHT], ids=["loose", "tight"])
@pytest.mark.parametrize(
    "name",
    [
        "paper",
        *(pytest.param(name, marks=pytest.mark.slow) for name in ("rv", "robot-joint", "plastic")),
        pytest.param("sleeved", marks=pytest.mark.nightly),
    ],
)
def test_the_potential_is_least(name, words):
    """Energies of one-sided springs, minimised by themselves, and places from the definition alone."""
    drive = with_fields(drive_of(name), words)
    model, found = balanced(drive)
    for position in (0, 2):
        assert find_imbalance(warm_drive(drive), model, found, position, torque=drive.load.torque) == []


@pytest.mark.family(quick=1)
@pytest.mark.parametrize(
    "words", [LOOSE, TIGHT | {"crank.support.preload": 3e4, "main_bearing.preload": 3e3}], ids=["loose", "tight"]
)
def test_virtual_work_at_every_position(words, unbalanced_work):
    drive = with_fields(drive_of("rv"), words)
    np.testing.assert_allclose(unbalanced_work(drive, ANGLES + 0.05), 0.0, atol=1e-7)


@pytest.mark.parametrize("words", [LOOSE, pytest.param(TIGHT, marks=pytest.mark.slow)], ids=["loose", "tight"])
def test_tangent_is_the_slope_of_the_force(words, tangent_and_slope):
    scaled, slope = tangent_and_slope(with_fields(drive_of("rv"), words), ANGLES[:1])
    # differences of second order over 1e-7 mm: round-off of loads of 1e4 N by the step, and contacts that just open
    np.testing.assert_allclose(slope, scaled, rtol=0.0, atol=2e-6 * np.abs(scaled).max())


@pytest.mark.parametrize("name", ["rv", pytest.param("paper", marks=pytest.mark.slow)])
def test_no_clearance_and_no_field_are_one_drive(name):
    plain = with_fields(drive_of(name), {"main_bearing.radial_stiffness": 5e5})
    none = with_fields(plain, {"main_bearing.clearance": 0.0, "crank.support.clearance": 0.0})
    both = with_fields(plain, {"main_bearing.preload": 1e9, "crank.support.preload": 1e9})
    expected = balanced(plain)[1]
    for drive in (none, both):  # and with a preload that nothing overcomes
        # the balance closes to 1e-9 of the load
        np.testing.assert_allclose(balanced(drive)[1].pose, expected.pose, rtol=0.0, atol=1e-11)


def test_the_loose_side_gives_way_by_the_clearance():
    """A central crank whose bearings are free by 5 µm: 5 µm, and what its load makes shaft and bearings yield."""
    drive = with_fields(drive_of("paper"), {"crank.support.clearance": 0.01})
    found = analyse(drive, ANGLES)
    load = np.hypot(found.bearing_radial, found.bearing_tangential)
    # in the middle of 44 mm: L³/48EI, and half the load on each bearing moves the middle by half of what it yields
    bent = 44.0**3 / (48.0 * 206e3 * np.pi * 20.0**4 / 64.0)
    yields = bent + 0.25 * (1.0 / 3e5 + 1.0 / 4e5)
    np.testing.assert_allclose(np.abs(found.crank_deflections), 0.005 + yields * load, rtol=1e-9)


@pytest.mark.slow
def test_from_loose_to_tight_without_a_jump():
    """The angle of the wheel over the clearance of all bearings, in steps of 2 µm: as smooth as its neighbours say."""
    drive, turned = drive_of("rv"), []
    for clearance in np.arange(6.0, -7.0, -2.0) * 1e-3:
        fields = {"crank.support.clearance": clearance, "main_bearing.radial_stiffness": 5e5}
        turned.append(
            balanced(with_fields(drive, fields | {"main_bearing.clearance": clearance}))[1].pose[:, WHEEL_ANGLE]
        )
    step = np.diff(turned, axis=0)
    # tight bearings stop giving way once no side lifts off: steps fall from some 1e-5 rad to none, and never grow or turn back
    assert np.all(step > -1e-12)
    assert np.abs(np.diff(step, axis=0)).max() < 0.4 * step.max()


def test_preloaded_bearings_drag():
    """Friction of two preloaded sides is that of twice the preload until one lifts off, at every bearing of the cranks."""
    rubbing = {"friction.pin": 0.04, "friction.support_bearing": 0.003, "friction.support_bearing_radius": 12.0}
    drive = with_fields(drive_of("rv"), rubbing | {"crank.support.preload": 2e4})
    model, found = balanced(drive, ANGLES[:1])
    alone = replace(model, friction=replace(model.friction, crank_preload=np.zeros(2)))
    of = [one.crank_moments(ANGLES[:1], found.pose, found.response.parts) for one in (model, alone)]
    smooth = replace(model, friction=None).crank_moments(ANGLES[:1], found.pose, found.response.parts)
    # six bearings of three cranks at 40 kN, none of which lifts off
    np.testing.assert_allclose(of[0] - smooth, 0.003 * 12.0 * 2.0 * 4e4, rtol=1e-12)
    assert np.all(of[1] - smooth < of[0] - smooth)


def axially_preloaded(angle, force):
    """Rows with contact angles under the wheel, tapered rollers under the cranks, friction on their radii alone."""
    rows = {
        f"main_bearing.bearings.{number}.{name}": value
        for number, plane in enumerate((-30.0, 30.0))
        for name, value in {
            "plane": plane, "kind": "angular-contact ball", "contact_angle": angle, "pitch_radius": 95.0, "load_constant": 3e6,
        }.items()
    } | {"main_bearing.preload": force}  # fmt: skip
    tapered = {"contact_angle": np.radians(15.0), "load_constant": 2e5, "stiffness": (), "preload": 500.0}
    rubbing = {"friction.support_bearing": 0.02, "friction.support_bearing_radius": 40.0}
    return rows | {f"crank.support.{name}": value for name, value in tapered.items()} | rubbing


@pytest.mark.parametrize(
    ("angle", "together"), [(15.0, 15454.81), (40.0, 6222.895), (60.0, 4618.802)], ids=["15°", "40°", "60°"]
)
def test_rows_rub_with_the_loads_of_their_elements(angle, together):
    """Two rows of 2 kN press with 2·2 kN/sin α, not with the radial force at which they lift off (11.2, 3.6, 1.7 kN); a row of
    tapered rollers of 500 N at 15° with 1932 N.
    """
    found = HalfSpace().prepare(with_fields(drive_of("rv"), axially_preloaded(np.radians(angle), 2e3))).model.friction
    # seven figures
    assert found.wheel_preload == pytest.approx(together, rel=1e-6)
    np.testing.assert_allclose(found.crank_preload, 1931.852, rtol=1e-6)


@pytest.mark.parametrize(
    "name", ["paper", *(pytest.param(name, marks=pytest.mark.slow) for name in ("rv", "plastic", "sleeved"))]
)
def test_axially_preloaded_rows_that_rub_balance(name):
    """The independent check sums over rolling elements: energies, and moments of friction at wheel and cranks."""
    drive = with_fields(drive_of(name), axially_preloaded(0.6, 4e3) | {"friction.pin": 0.04})
    model, found = balanced(drive)
    for position in (0, 2):
        assert find_imbalance(warm_drive(drive), model, found, position, torque=drive.load.torque) == []
    spoilt = replace(model, friction=replace(model.friction, wheel_preload=0.5 * model.friction.wheel_preload))
    told = find_imbalance(
        warm_drive(drive),
        spoilt,
        solve_at_output(spoilt, [drive], ANGLES, drive.load.torque),
        0,
        torque=drive.load.torque,
    )
    assert told  # half of it is seen


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("paper", {"main_bearing.radial_stiffness": 5e5, "main_bearing.clearance": 0.03}),
        pytest.param("robot-joint", {"crank.support.clearance": 0.02}, marks=pytest.mark.slow),
        pytest.param("rv", LOOSE, marks=pytest.mark.slow),
        pytest.param("sleeved", LOOSE, marks=pytest.mark.slow),
    ],
)
def test_loads_of_a_millionth_turn_as_far_as_the_play(name, words):
    """Root of the loaded model on either side at 1e-6 of the torque, or more where that cannot be balanced: 1 % or 0.005′."""
    found = compare(with_fields(drive_of(name), words), ANGLES[:1])
    assert [one.outcome for one in found] == ["alike"], found


def test_play_grows_with_every_clearance():
    """With the wheel free by g, a central drive's flank has its own play and what g lets the wheel turn: more, but less than
    2 g/e z_C of it would be if all of g turned the wheel.
    """
    drive = drive_of("paper")
    model = HalfSpace().prepare(drive).model
    own = free_play(model.geometries, ANGLES).play
    plays = [own]
    for clearance in (0.01, 0.02):
        fields = {"main_bearing.radial_stiffness": 5e5, "main_bearing.clearance": clearance}
        plays.append(free_play(HalfSpace().prepare(with_fields(drive, fields)).model.geometries, ANGLES).play)
    gained = np.diff(plays, axis=0)
    assert np.all(gained > 0.0)
    # in first order in the clearance: gaps are curved over hundredths of a millimetre
    np.testing.assert_allclose(gained[1], gained[0], rtol=0.1)


def loose_drive(seed):
    """A reducer of any kind whose main bearing is loose, and its crank bearings where it has them, with its crank angle.

    Beside teeth of a first stage these are without clearance, which is refused there (docs/how-to/supports.md): what cranks that
    float turn the sun by is in the loaded answer alone, 0.21′ of 14.4′ with seed 70.
    """
    (drive, angle), random = crank_drive(seed), np.random.default_rng((seed, 7))
    wheel, cranks = random.choice([0.004, 0.01, 0.03], 2) * min(1.0, drive.crank.eccentricity)
    support = drive.crank.support
    if support is not None:
        clearance = cranks if drive.first_stage is None else None
        support = replace(
            support, stiffness=(3e5, 4e5), clearance=clearance, preload=None, contact_angle=None, load_constant=None
        )
    bearing = MainBearing(radial_stiffness=5e5, clearance=wheel)
    pins, crank = replace(drive.pin_wheel, support_stiffness=None), replace(drive.crank, support=support)
    return replace(drive, main_bearing=bearing, pin_wheel=pins, crank=crank), angle


@pytest.mark.slow
def test_play_under_light_loads_with_a_ring_that_yields():
    """Half a newton-millimetre on a bolted ring of aluminium turns the wheel 0.38′ beyond its free play of 2.02′.

    The ring yields by as much as its contacts: overlaps of the contacts alone allowed 0.19′ of it.
    """
    drive, angle = loose_drive(49)
    (found,) = compare(drive, np.array([angle]))
    assert found.outcome == "settling", found
    stiff = replace(drive, ring=None)
    assert compare(stiff, np.array([angle]))[0].outcome != "wrong"


@pytest.mark.slow
@pytest.mark.nightly
@pytest.mark.parametrize("first", range(0, 300, 20))
def test_loads_of_a_millionth_turn_three_hundred_loose_drives_as_far(first):
    found = []
    for seed in range(first, first + 20):
        drive, angle = loose_drive(seed)
        found += compare(drive, np.array([angle]))
    assert not [one for one in found if one.outcome == "wrong"], found
    assert sum(one.outcome == "alike" for one in found) >= 8
