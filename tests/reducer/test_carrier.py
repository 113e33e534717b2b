"""A carrier whose far flange moves on posts, and one that twists: statics, limits, virtual work, what results take in."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from refusals import refused_field

from ltca.analysis.engines import HalfSpace
from ltca.analysis.friction.hysteresis import locked_path
from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.summary import summarise
from ltca.analysis.torque_curve import torque_curve
from ltca.arrays import stack_drives
from ltca.compliance.response import bearing_pushes
from ltca.drive.parts import (
    Carrier,
    CarrierPosts,
    CrankSupport,
    Friction,
    Installation,
    Material,
    ShaftPinBeam,
)
from ltca.drive.pin_beams import shaft_pin_beam
from ltca.equilibrium.compliance_shares import compliance_shares
from ltca.equilibrium.output_torque import solve_at_output
from ltca.equilibrium.supports import Supports
from ltca.geometry.coordinates import WHEEL_ANGLE
from ltca.laws.backed import own_flexibility
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive, parse_drive
from ltca.reading.writing import drive_text
from ltca.studies.batch_analysis import BatchSettings, analyse_samples
from ltca.testing.yielding_pins import post_forces

ANGLES = np.array([0.31, 1.7, 4.4])
LOAD = 1e-4
"""Loads of equal drives solved from different sides, N: the balance closes to 1e-9 of some 10 kN, and stiffness adds a digit."""
POSTS = CarrierPosts(number=3, radius=42.0, size=14.0)
TORSION = 4e8


def nominal(name):
    return next(iter(load_drive(name).cases.values()))


def tied(drive, tip="tied-clamped"):
    """The drive with shaft pins that are beams, tied at their tips."""
    return replace(drive, pin_shaft=replace(drive.pin_shaft, stiffness=None, beam=ShaftPinBeam(span=30.0, tip=tip)))


def of_steel(drive, youngs_modulus):
    """The drive with posts of another material."""
    return replace(drive, materials=replace(drive.materials, carrier=Material(youngs_modulus=youngs_modulus)))


def kind(name):
    """A drive with a far flange."""
    rv, joint = nominal("rv"), nominal("robot-joint")
    on_posts = Carrier(posts=POSTS, flange=(10.0, 8.0))
    if name == "cranks":
        return replace(rv, carrier=on_posts)
    if name == "rigid cranks":
        return replace(rv, carrier=on_posts, crank=replace(rv.crank, support=None))
    if name == "overhung":
        support = CrankSupport(diameter=20.0, positions=(-25.0, 4.0), stiffness=(4e5, 2e5))
        return replace(
            rv,
            carrier=Carrier(posts=replace(POSTS, size=15.0), stiffness_torsion=TORSION),
            crank=replace(rv.crank, support=support),
        )
    if name == "tips":
        return replace(tied(joint), carrier=on_posts)
    if name == "pinned tips":
        return replace(tied(joint, "tied-pinned"), carrier=Carrier(posts=replace(POSTS, length=40.0)))
    assert name == "sleeved"
    drive = nominal("sleeved")
    support = CrankSupport(diameter=20.0, positions=(-25.0, 25.0), stiffness=(4e5, 2e5))
    return replace(drive, carrier=on_posts, crank=replace(drive.crank, support=support))


KINDS = [
    "cranks",
    pytest.param("rigid cranks", marks=pytest.mark.slow),
    pytest.param("overhung", marks=pytest.mark.slow),
    pytest.param("tips", marks=pytest.mark.slow),
    pytest.param("pinned tips", marks=pytest.mark.slow),
    pytest.param("sleeved", marks=pytest.mark.slow),
]


@pytest.mark.family(full=3)
@pytest.mark.parametrize("name", KINDS)
def test_virtual_work_at_every_position(name, unbalanced_work):
    np.testing.assert_allclose(unbalanced_work(kind(name), ANGLES + 0.05), 0.0, atol=1e-7)


@pytest.mark.family(full=3)
@pytest.mark.parametrize("name", KINDS)
def test_tangent_is_the_slope_of_the_force(name, tangent_and_slope):
    scaled, slope = tangent_and_slope(kind(name), ANGLES[:1])
    # differences of second order over 1e-7 mm: round-off of loads of 1e4 N by the step, and contacts that just open
    np.testing.assert_allclose(slope, scaled, rtol=0.0, atol=2e-6 * np.abs(scaled).max())
    np.testing.assert_allclose(scaled, scaled.T, rtol=0.0, atol=1e-9 * np.abs(scaled).max())


@pytest.mark.parametrize("name", ["cranks", pytest.param("rigid cranks", marks=pytest.mark.slow)])
def test_posts_carry_what_the_far_bearings_of_the_cranks_do(name):
    """Statics: each far bearing has the share of its place of every disc's force, and the posts have them all."""
    drive = kind(name)
    model = HalfSpace().prepare(drive).model
    found = solve_at_output(model, [drive], ANGLES, drive.load.torque)
    # The flanges are 10 and 8 mm thick and 30 mm apart: rigid cranks stand in their middles.
    near, far = (-22.0, 22.0) if name == "cranks" else (-20.0, 19.0)
    place = drive.crank.circle_radius * np.exp(1j * (drive.crank.angle + 2.0 * np.pi * np.arange(3) / 3.0))
    force, moment = 0j, 0.0
    for plane, part in zip(drive.disc.disc_planes, found.response.parts, strict=True):
        at_far = -bearing_pushes(part.rollers, 3) * (plane - near) / (far - near)
        force, moment = force + at_far.sum(axis=1), moment + (place.conj() * at_far).imag.sum(axis=1)
    carried = found.pose[:, model.coordinates.ring_place] @ post_forces(drive)
    expected = np.stack([force.real, force.imag, moment], axis=1)
    np.testing.assert_allclose(carried, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())


def test_half_of_the_torque_of_even_discs_goes_over_the_posts():
    """Discs at ±z that share evenly: by symmetry the flange turns by half of the torque on the stiffness of the posts."""
    drive = kind("cranks")
    found = analyse(drive, ANGLES)
    planes, torques = np.asarray(drive.disc.disc_planes), found.disc_torques
    on_carrier = -torques.sum(axis=1) - found.crank_torques.sum(axis=1)  # with cages, which cranks and carrier hold
    share = (planes + 22.0) / 44.0 @ torques.T / torques.sum(axis=1)
    turned = found.full.pose[:, found.model.coordinates.ring_place][:, 2]
    # Each disc's part is that of its torque on the wheel; what its cages and cranks take differs from that by some 1e-5.
    np.testing.assert_allclose(-turned * post_forces(drive)[2, 2], share * on_carrier, rtol=1e-4)


@pytest.mark.family(quick=1)
@pytest.mark.parametrize("name", ["cranks", pytest.param("rigid cranks", marks=pytest.mark.slow), "tips"])
def test_stiff_posts_are_a_carrier_in_one_piece(name):
    """Towards stiff posts: cranks as without a carrier; tied tips as pins clamped in two still walls, which are springs."""
    drive = kind(name) if name != "tips" else replace(tied(nominal("paper")), carrier=Carrier(posts=POSTS))
    rigid = replace(drive, carrier=None)
    if name == "tips":
        spring = 1.0 / own_flexibility(drive, shaft_pin_beam(drive))
        rigid = replace(rigid, pin_shaft=replace(drive.pin_shaft, beam=None, stiffness=spring))
    stiff, stiffer = (analyse(of_steel(drive, modulus), ANGLES).full for modulus in (2e9, 2e10))
    known = analyse(rigid, ANGLES).full

    def limit(of):
        """To first order in 1/E; what is left of the second is a hundred-millionth."""
        return (10.0 * of(stiffer) - of(stiff)) / 9.0

    loads = limit(lambda found: found.response.pin_load)
    # Very stiff supports balance to 5e-4 N (their round-off), of loads of some kN.
    np.testing.assert_allclose(loads, known.response.pin_load, rtol=0.0, atol=5e-3)
    angles = limit(lambda found: found.pose[:, WHEEL_ANGLE])
    np.testing.assert_allclose(angles, known.pose[:, WHEEL_ANGLE], rtol=1e-6)


def test_posts_that_hold_nothing_leave_a_ring_that_floats():
    """The crank stands beside the disc in the near flange: of the far one it sees nothing."""
    support = CrankSupport(diameter=20.0, positions=(0.0, 40.0), stiffness=(1e6, 1e6))
    drive = tied(nominal("paper"))
    floating = replace(drive, crank=replace(drive.crank, support=support))
    loose = of_steel(replace(floating, carrier=Carrier(posts=POSTS)), 1e-6)
    far, known = analyse(loose, ANGLES), analyse(floating, ANGLES)
    np.testing.assert_allclose(far.full.response.hole_load, known.full.response.hole_load, rtol=0.0, atol=LOAD)
    ring = known.model.coordinates.ring_place
    np.testing.assert_allclose(far.full.pose[:, ring], known.full.pose[:, ring], rtol=1e-6, atol=1e-9)


def test_the_supports_are_symmetric_and_hold_what_they_move():
    """Of a drive with everything: no motion is without energy but those that no support sees, and rigid motions of the whole
    are none of the frame."""
    drive = kind("overhung")
    model = HalfSpace().prepare(drive).model
    matrix = Supports.of_drive(drive, model.discs[0].geometry).matrix
    np.testing.assert_allclose(matrix, matrix.T, rtol=0.0, atol=1e-12 * np.abs(matrix).max())
    values = np.linalg.eigvalsh(matrix)
    # Discs and wheel angle are held by contacts alone: three for each disc, and the wheel.
    assert np.count_nonzero(values > 1e-9 * values.max()) == model.coordinates.size - 7


@pytest.mark.parametrize(
    "name",
    ["cranks", pytest.param("rigid cranks", marks=pytest.mark.slow), pytest.param("tips", marks=pytest.mark.slow)],
)
def test_shares_are_those_of_the_energies(name):
    """The carrier's share is what the posts store of a little more torque, told from two torques; shares add up to one."""
    drive = replace(kind(name), carrier=replace(kind(name).carrier, stiffness_torsion=TORSION))
    found = analyse(drive, ANGLES)
    shares = found.compliance_shares
    np.testing.assert_allclose(sum(shares.values()), 1.0, rtol=1e-12)
    model, torque, step = found.model, drive.load.torque, 1e-3
    up, down = (
        solve_at_output(model, [drive], ANGLES, torque * (1.0 + side * step), found.full.pose) for side in (0.5, -0.5)
    )
    moved = (up.pose - down.pose)[:, model.coordinates.ring_place]
    change = step * torque
    wound = drive.output_deviation(up.pose[:, WHEEL_ANGLE], torque * (1.0 + 0.5 * step))
    wound = np.abs(wound - drive.output_deviation(down.pose[:, WHEEL_ANGLE], torque * (1.0 - 0.5 * step)))
    stored = np.einsum("bi,ij,bj->b", moved, post_forces(drive), moved) + change**2 * drive.carrier_compliance
    # The torque of a held wheel changes a little differently at every position.
    np.testing.assert_allclose(shares["carrier"], stored / (change * wound), rtol=2e-3)


INSTALLED = [
    ("paper", "pin-shaft", None),
    *(
        pytest.param(*words, marks=pytest.mark.slow)
        for words in (
            ("paper", "pin-wheel", None),
            ("rv", "pin-wheel", 2.0),
            ("rv", "pin-shaft", None),
        )
    ),
    pytest.param("rv", "pin-wheel", None, marks=pytest.mark.nightly),
    pytest.param("rv", "pin-shaft", 2.0, marks=pytest.mark.nightly),
]


@pytest.mark.parametrize(("name", "held", "stage"), INSTALLED)
def test_a_carrier_that_twists_turns_the_output_alone(name, held, stage):
    """Loads, poses and the transmission error stay; the output lags by T/k, times (1 − T_in/T_out)² with the shaft held."""
    rigid = replace(nominal(name), installation=Installation(held=held, first_stage_ratio=stage))
    drive = replace(rigid, carrier=Carrier(stiffness_torsion=TORSION))
    plain, found = analyse(rigid, ANGLES), analyse(drive, ANGLES)
    np.testing.assert_array_equal(found.full.pose, plain.full.pose)
    added, ratio = found.transmission_error - plain.transmission_error, drive.transmission_ratio
    # T_in ω_in + T_out ω_out = 0; cranks driven from the carrier take nothing from outside.
    of_input = 0.0 if stage is None and rigid.crank.number > 1 else 1.0 / ratio
    part = 1.0 if held == "pin-wheel" else (1.0 - of_input) ** 2
    # Against a crank driving ccw, the wheel lags cw, the shaft, which turns the other way, ccw.
    sense = drive.driving_sign if held == "pin-wheel" else -drive.driving_sign
    np.testing.assert_allclose(added, sense * part * drive.load.torque / TORSION, rtol=1e-9)
    light = found.transmission_error_light - plain.transmission_error_light
    np.testing.assert_allclose(light, added * drive.load.light_torque / drive.load.torque, rtol=1e-9)
    # Wound up, not let go: the twist has the sense of the wind-up.
    wound = plain.transmission_error - plain.transmission_error_light
    assert np.all(np.sign(added) == np.sign(wound))
    keys = ("ptp_transmission_error_arcsec", "max_pin_load_N", "backlash_output_arcmin")
    told, before = summarise(found), summarise(plain)
    assert [told[key] for key in keys] == pytest.approx([before[key] for key in keys], rel=1e-9)


@pytest.mark.slow
def test_stiffness_and_lost_motion_take_the_twist_in():
    """Springs in a row: 1/k adds up, lost motion grows by its torques, backlash does not."""
    drive = nominal("rv")
    twisting = replace(drive, carrier=Carrier(stiffness_torsion=TORSION))
    plain, found = (torque_curve(each, ANGLES[:1], points=5) for each in (drive, twisting))
    np.testing.assert_allclose(1.0 / found.stiffness - 1.0 / plain.stiffness, 1.0 / TORSION, rtol=1e-7)
    longer = 2.0 * 0.03 * drive.load.torque / TORSION
    np.testing.assert_allclose(found.lost_motion - plain.lost_motion, longer, rtol=1e-7)
    np.testing.assert_array_equal(found.backlash, plain.backlash)
    np.testing.assert_array_equal(found.wheel_angle, plain.wheel_angle)


@pytest.mark.slow
def test_a_loop_of_friction_takes_the_twist_in():
    """It leans by T/k and loses no more."""
    drive = replace(nominal("rv"), friction=Friction(pin=0.05))
    twisting = replace(drive, carrier=Carrier(stiffness_torsion=TORSION))
    path = drive.load.torque * np.array([0.5, 1.0, 0.5])
    plain, found = (locked_path(each, ANGLES[:1], path) for each in (drive, twisting))
    np.testing.assert_allclose(found - plain, drive.driving_sign * path[None] / TORSION, rtol=1e-7)


def test_scattered_carriers_are_solved_together():
    """Posts and torsion that differ from sample to sample in one batch, as one by one."""
    base = kind("cranks")
    drives = [
        with_fields(
            base, {"carrier.posts.size": size, "carrier.stiffness_torsion": torsion, "carrier.flange": (9.0, flange)}
        )
        for size, torsion, flange in ((14.0, 4e8, 8.0), (15.0, 5e8, 9.0), (16.0, 4e8, 8.0))
    ]
    names = ("mean_transmission_error", "max_pin_load")
    settings = BatchSettings(crank_angle=ANGLES, quantities=names, engine=HalfSpace())
    together = analyse_samples(drives, settings).values
    alone = np.concatenate([analyse_samples([drive], settings).values for drive in drives])
    np.testing.assert_allclose(together, alone, rtol=1e-9)
    assert np.ptp(together[:, 0]) > 1e-3 * np.abs(together[0, 0])


def test_shares_of_a_batch_are_those_of_each_drive():
    """Cranks on circles of their own were refused by an index that the sum had lost."""
    base = kind("cranks")
    circle = base.crank.circle_radius
    drives = {f"{part}": with_fields(base, {"crank.circle_radius": part * circle}) for part in (1.0, 1.02)}
    model = stack_drives([HalfSpace().model(drive, in_batch=True) for drive in drives.values()], ANGLES.size)
    both = list(drives.values())
    torques = np.repeat([drive.load.torque for drive in both], ANGLES.size)
    found = compliance_shares(model, solve_at_output(model, both, np.tile(ANGLES, 2), torques))
    for number, drive in enumerate(both):
        for part, shares in analyse(drive, ANGLES).compliance_shares.items():
            own = found[part][number * ANGLES.size : (number + 1) * ANGLES.size]
            np.testing.assert_allclose(own, shares, atol=1e-6)  # of finite steps from poses balanced to 1e-9


def test_a_warm_carrier_grows():
    """Posts and their circle by the carrier's expansion, or by that of the pins or cranks where it has none."""
    from ltca.drive.members.temperatures import warm_drive

    drive = with_fields(kind("cranks"), {
        "temperature.shaft": 70.0, "materials.inner_race": "100Cr6", "materials.roller": "100Cr6",
        "materials.carrier.thermal_expansion": 2e-5,
    })  # fmt: skip
    warm = warm_drive(drive)
    assert warm.carrier.posts.size == pytest.approx(14.0 * 1.001, rel=1e-12)
    assert warm.carrier.posts.radius == pytest.approx(42.0 * 1.001, rel=1e-12)
    assert warm.carrier.flange == pytest.approx((10.01, 8.008), rel=1e-12)
    assert warm.crank.circle_radius == pytest.approx(drive.crank.circle_radius * 1.001, rel=1e-12)


def test_a_file_gives_a_carrier():
    drive = kind("overhung")
    assert parse_drive(drive_text(drive)).cases["nominal"] == drive
    told = with_fields(
        drive,
        {"carrier.stiffness_torsion": "0.5 N·m/arcmin", "carrier.posts.radius": "0.041 m"},
    )
    assert told.carrier.stiffness_torsion == pytest.approx(500.0 * 180.0 * 60.0 / np.pi, rel=1e-12)


def test_an_empty_carrier_is_refused():
    with refused_field("carrier", "", "is empty; give carrier.stiffness_torsion, carrier.posts or both"):
        parse_drive(drive_text(nominal("rv")) + "\n[carrier]\n")


def test_a_stiffness_in_newton_metres_is_warned_of():
    drive = with_fields(nominal("rv"), {"carrier.stiffness_torsion": 4e5})
    assert any(
        "carrier.stiffness_torsion = 400000 N·mm/rad would let the output turn" in one
        for one in analyse(drive, ANGLES[:1]).warnings
    )
