"""Teeth of the first stage: forces by hand, statics of the cranks, play and give at the output, work."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from refusals import refused_field

from ltca.analysis.engines import HalfSpace
from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.reactions import crank_support_forces, mesh_forces
from ltca.analysis.summary import summarise
from ltca.analysis.torque_curve import torque_curve
from ltca.arrays import stack_drives
from ltca.compliance.response import bearing_pushes
from ltca.drive.members.first_stage import FirstStage
from ltca.drive.parts import Material
from ltca.drive.units.quantities import ARCMIN
from ltca.drive.yielding_parts import yielding_parts
from ltca.equilibrium.first_stage import StageMesh
from ltca.equilibrium.output_torque import solve_at_output
from ltca.geometry.coordinates import WHEEL_ANGLE
from ltca.geometry.placement import position_angles
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive
from ltca.testing.balance_check import find_imbalance
from ltca.testing.crank_drives import crank_drive
from ltca.testing.practical_drives import compare, compare_with_load

ANGLES = np.array([0.31, 1.7, 4.4])
TEETH = {"first_stage.sun_teeth": 20, "first_stage.planet_teeth": 40, "first_stage.plane": 40.0}
FULL = TEETH | {
    "first_stage.pressure_angle": "20 deg",
    "first_stage.helix_angle": "10 deg",
    "first_stage.backlash": 0.03,
    "first_stage.mesh_stiffness": 3e5,
    "first_stage.plane": -30.0,
}


@pytest.fixture(scope="module")
def rv():
    return load_drive("rv").cases["nominal"]


@pytest.fixture(scope="module")
def geared(rv):
    return with_fields(rv, FULL)


@pytest.fixture(scope="module")
def answer(geared):
    return analyse(geared, ANGLES)


def rigid(drive):
    stiff = replace(drive, crank=replace(drive.crank, support=None))
    return replace(stiff, materials=replace(drive.materials, crankshaft=Material()))


def test_forces_have_their_moment_and_push_planets_outward(answer):
    """The tangential force has the crank's moment about its axis; what teeth press is never towards the sun."""
    found, outward = mesh_forces(answer), np.exp(2j * np.pi * np.arange(3) / 3)
    np.testing.assert_allclose((-28.0 * outward.conj() * found.in_plane).imag, answer.crank_torques, rtol=1e-12)
    np.testing.assert_allclose((outward.conj() * found.in_plane).real, found.radial, rtol=1e-12)
    back = StageMesh.of_drive(answer.drive).forces(-answer.crank_torques)
    np.testing.assert_array_equal(back.radial, found.radial)
    np.testing.assert_array_equal(back.tangential, -found.tangential)


def test_teeth_in_other_planes_press_the_wheels_of_drives_that_are_solved_together(geared):
    """A check of shares stopped at arrays of different shapes where drives of one batch had teeth in planes of their own."""
    stages = [StageMesh.of_drive(with_fields(geared, {"first_stage.plane": plane})) for plane in (-30.0, 20.0)]
    moments = np.array([[3.0, 4.0, 5.0], [-1.0, 2.0, 6.0]]) * 1e4
    together = stack_drives(stages, 2).on_wheel(np.tile(moments, (2, 1)))
    alone = [stage.on_wheel(moments) for stage in stages]
    assert np.abs(alone[0][0][:, 1] - alone[1][0][:, 1]).min() > 1e3  # N·mm
    for mine, each in zip(together, zip(*alone, strict=True), strict=True):
        np.testing.assert_allclose(mine, np.concatenate(each), rtol=1e-14)


def test_sun_turns_by_what_planets_press(answer):
    """Their forces on the sun, by cross products, are held by the moment of the input, −ΣT/i₁."""
    found, outward = mesh_forces(answer), np.exp(2j * np.pi * np.arange(3) / 3)
    on_sun = (14.0 * outward.conj() * -found.in_plane).imag.sum(axis=1)
    np.testing.assert_allclose(on_sun, answer.crank_torques.sum(axis=1) / 2.0, rtol=1e-12)


@pytest.mark.parametrize("module", [1.38, 1.4, 1.42])
def test_shifted_teeth_press_along_the_line_of_action(rv, module):
    """The normal force is at right angles to the tooth, and its arm is the base circle's, m_t z₂/2 cos α_t."""
    stage = FirstStage(sun_teeth=20, planet_teeth=40, module=module, helix_angle=0.15)
    mesh, transverse = stage.mesh(42.0), module / np.cos(0.15)
    alpha = np.arctan(np.tan(np.pi / 9.0) / np.cos(0.15))
    base = 0.5 * transverse * 40 * np.cos(alpha)
    assert mesh.base_radius == pytest.approx(base, rel=1e-12)
    assert np.cos(mesh.working_angle) == pytest.approx(base * 60.0 / 40.0 / 42.0, rel=1e-12)
    # right-handed: the tooth rises along z as it goes ccw around the planet, by the helix angle of the pitch circle
    helix = np.arctan(np.tan(0.15) * mesh.pitch_radius / (0.5 * transverse * 40))
    force = np.array([1.0, -mesh.axial])  # along the circle and z
    assert force @ np.array([np.sin(helix), np.cos(helix)]) == pytest.approx(0.0, abs=1e-12)


def test_ratio_follows_from_the_teeth(rv):
    """Both may be given and agree; a planet of 40 teeth on a sun of 20 turns once for two turns of the sun."""
    without = with_fields(rv, TEETH | {"installation.first_stage_ratio": None})
    assert without.transmission_ratio == with_fields(rv, TEETH).transmission_ratio == rv.transmission_ratio == 81.0
    assert without.input_per_crank_moment == rv.input_per_crank_moment == -0.5


def test_teeth_alone_change_nothing_of_rigid_cranks(rv):
    """Left out is rigid and without play: with teeth but without backlash and stiffness the answer is the same, bit for bit."""
    plain = rigid(rv)
    found, teeth = analyse(plain, ANGLES), analyse(with_fields(plain, TEETH), ANGLES)
    np.testing.assert_array_equal(teeth.full.pose, found.full.pose)
    np.testing.assert_array_equal(teeth.transmission_error, found.transmission_error)


def test_crankshafts_are_in_balance(geared, answer):
    """Forces and moments of discs, teeth and both bearings on every shaft, with the axial force at its arm: cross products."""
    teeth, supports = mesh_forces(answer), crank_support_forces(answer)
    places, outward = np.array(geared.crank.places), np.exp(2j * np.pi * np.arange(3) / 3)
    discs = [-bearing_pushes(part.rollers, 3) for part in answer.full.response.parts]
    for crank in range(3):
        pressed = [(plane, force[:, crank]) for plane, force in zip(geared.disc.disc_planes, discs, strict=True)]
        pressed += [(-30.0, teeth.in_plane[:, crank])]
        held = list(zip(geared.crank.support.positions, -supports[:, crank].T, strict=True))
        total = sum(force for _, force in pressed + held)
        moment = sum(1j * plane * force for plane, force in pressed + held)  # z × F
        arm = -28.0 * outward[crank]
        moment = moment - 1j * arm * teeth.axial[:, crank]  # r × F_a z
        size = np.abs(supports).max()
        np.testing.assert_allclose(total, 0.0, atol=1e-9 * size)
        np.testing.assert_allclose(moment, 0.0, atol=1e-9 * 30.0 * size)
    assert places.size == 3


@pytest.mark.slow
def test_backlash_at_the_output_is_that_of_the_teeth_by_the_ratio(rv, geared):
    """0.03 mm on 28 mm turn a planet by 3.68′, the cranks with it, the carrier by 1/81 of the sun's 7.37′: 80/81 · 3.68′/40."""
    by_hand = 0.03 / 28.0 / 40.0 * 80.0 / 81.0 * ARCMIN
    found = [summarise(analyse(drive, ANGLES[:1])) for drive in (rv, geared)]  # the play of a turn, of any positions
    for name in ("backlash_output_arcmin", "min_backlash_output_arcmin"):
        assert found[1][name] - found[0][name] == pytest.approx(by_hand, rel=1e-9)
    sun = 0.03 / 14.0  # the sun turns this far while planets stand still: by the whole ratio as well
    assert by_hand == pytest.approx(sun / 81.0 * ARCMIN, rel=1e-12)


def test_give_of_the_teeth_is_that_of_springs_by_the_ratio(rv):
    """n springs c at the base circles r_b = r cos α_t: ΣT/(n c r_b²) at the cranks, 1/u of it at the wheel."""
    plain = rigid(rv)
    drive = with_fields(plain, TEETH | {"first_stage.mesh_stiffness": 3e5})
    found = analyse(drive, ANGLES)
    wheel = found.transmission_error / drive.output_per_wheel_angle - found.full.pose[:, WHEEL_ANGLE]
    by_hand = -found.crank_torques.sum(axis=1) / (3.0 * 3e5 * (28.0 * np.cos(np.pi / 9.0)) ** 2) / 40.0
    np.testing.assert_allclose(wheel, by_hand, rtol=1e-9)


def test_work_of_the_input_is_what_the_teeth_store(rv):
    """Cranks held, the load on the output rises: the carrier's work is the cycloid stage's energy, the sun's that of the teeth.

    The sun turns by −i₁ of the crank's lag under −ΣT/i₁; teeth are springs, so trapezoids are exact.
    """
    drive = with_fields(rigid(rv), TEETH | {"first_stage.mesh_stiffness": 3e5})
    found = [analyse(drive, ANGLES, part * drive.load.torque) for part in (0.4, 0.7, 1.0)]
    moment = [one.crank_torques.sum(axis=1) for one in found]
    sun = [2.0 * one.crank_lag for one in found]
    work = sum(-0.5 * (moment[n] + moment[n + 1]) / 2.0 * (sun[n + 1] - sun[n]) for n in range(2))
    stored = [sum((one / 3.0 / (28.0 * np.cos(np.pi / 9.0))) ** 2 / (2.0 * 3e5) for _ in range(3)) for one in moment]
    np.testing.assert_allclose(work, stored[2] - stored[0], rtol=1e-9)


def each_lag(drive, crank_angle, torque=None, turned=(0.0, 0.0, 0.0)):
    """Moments of the cranks, what each lags behind the held sun at its own planet, and wheel angle; cranks turned apart by
    phase errors of both their eccentrics.
    """
    apart = {
        f"crank.of.{3 * disc + crank}.phase_error": float(turned[crank]) for disc in range(2) for crank in range(3)
    }
    found = analyse(with_fields(drive, apart), np.array([crank_angle]), torque)
    moments, stage = found.crank_torques, found.model.stage
    lag = moments / (3e5 * (28.0 * np.cos(np.pi / 9.0)) ** 2)  # no helix, no profile shift
    if stage.yields:
        moved = stage.displaced(moments, found.full.pose, None)
        lag = lag + (stage.on_planets(moments)[1].conjugate() * moved).real.sum(axis=-1)
    return moments[0], lag[0], found.full.pose[0, WHEEL_ANGLE]


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["rigid", "yielding"])
@pytest.mark.parametrize("angle", [0.3, 1.2])
def test_cranks_that_turn_each_by_its_own_lag(rv, kind, angle):
    """The mean over all cranks against cranks that turn apart, iterated outside until every one meets the held sun.

    The energy of the teeth, ΣT²/(2 c r_b²) of each crank's own moment, grows by the work of the torque at the output, so what
    the output turns is Σ T_c ∂T_c/∂T_out/(c r_b²): lags are weighted by what each crank takes of a little more torque. Moments
    differ by half, what they take of more torque hardly: the plain mean is that up to 2 % of the first stage's part. Planets in
    the middle of their shafts keep lags small: 18 mm beyond the bearings what is of second order is 1 %.
    """
    drive = with_fields(rv, TEETH | {"first_stage.mesh_stiffness": 3e5, "first_stage.plane": 0.0})
    drive = rigid(drive) if kind == "rigid" else drive
    moments, lag, before = each_lag(drive, angle)
    assert np.ptp(moments) > 0.2 * moments.mean()
    more = each_lag(drive, angle, 1.001 * drive.load.torque)[0] - moments
    turned = np.zeros(3)
    for _ in range(8):
        _, each, wheel = each_lag(drive, angle, turned=turned)
        left, turned = np.abs(turned + each).max(), -each
    assert left < 1e-9  # rad, of lags of 3e-5 and more
    apart = wheel - before
    # of first order in the lags: teeth are a hundred times as stiff as what holds one crank against the others
    assert -(more * lag).sum() / more.sum() / 40.0 == pytest.approx(apart, rel=2e-3)
    told = analyse(drive, np.array([angle])).crank_lag[0]
    assert told == pytest.approx(-lag.mean(), rel=1e-9)
    assert told / 40.0 == pytest.approx(apart, rel=0.02)


@pytest.mark.parametrize("held", ["pin-wheel", pytest.param("pin-shaft", marks=pytest.mark.slow)])
def test_power_goes_through_the_first_stage(geared, held):
    """Σωτ of sun, carrier and wheel with speeds by Willis is T_crank + T_W/u, the slope of the energy by the crank angle."""
    drive = with_fields(geared, {"installation.held": held})
    found = analyse(drive, ANGLES)
    sun, wheel = -found.crank_torques.sum(axis=1) / 2.0, found.full.wheel_moment
    carrier = -sun - wheel
    speeds = (
        (-2.0, 0.0, 1.0 / 40.0) if held == "pin-shaft" else (-2.0 - 1.0 / 40.0, -1.0 / 40.0, 0.0)
    )  # crank 1 in the carrier
    power = sum(speed * moment for speed, moment in zip(speeds, (sun, carrier, wheel), strict=True))
    np.testing.assert_allclose(power, found.crank_torques.sum(axis=1) + wheel / 40.0, atol=1e-9 * drive.load.torque)


def test_virtual_work_with_bending_cranks(geared, stored):
    """T_C + T_W (1/u + w′) + F·u′ at the planets = U′; the shafts' energy has what they bend between discs that stand still."""
    found = analyse(geared, ANGLES)
    model, stage = found.model, found.model.stage

    def state(angle, start):
        at = solve_at_output(model, [geared], angle, geared.load.torque, start)
        moments = model.crank_moments(angle, at.pose, at.response.parts)
        forces = stage.forces(moments)
        both = np.stack((forces.in_plane, forces.axial * stage.pitch_radius * stage.outward), axis=-1)
        moved = stage.displaced(moments, at.pose, None)
        energy, slopes = stored(model, at.response, at.pose)
        energy = energy + 0.5 * np.einsum("pck,kl,pcl->p", both.conj(), stage.own, both).real
        return at, moments, both, moved, energy, slopes

    centre = state(ANGLES, found.full.pose)

    def left(step):
        (up, _, _, moved_up, energy_up, _), (down, _, _, moved_down, energy_down, _) = (
            state(ANGLES + side * step, found.full.pose) for side in (1.0, -1.0)
        )
        turn = (up.pose[:, WHEEL_ANGLE] - down.pose[:, WHEEL_ANGLE]) / (2.0 * step)
        radius = up.response.flank.effective_radius - down.response.flank.effective_radius
        work = (energy_up - energy_down) / (2.0 * step) - (centre[5] * radius / (2.0 * step)).sum(axis=1)
        at_teeth = (centre[2].conj() * (moved_up - moved_down) / (2.0 * step)).real.sum(axis=(1, 2))
        crank = centre[1].sum(axis=1)
        return crank + centre[0].wheel_moment * (1.0 / geared.reduction_ratio + turn) + at_teeth - work

    np.testing.assert_allclose((4.0 * left(1e-4) - left(2e-4)) / 3.0 / geared.load.torque, 0.0, atol=1e-7)


@pytest.mark.family(quick=1)
@pytest.mark.parametrize(("angle", "wheel"), [(0.31, None), (1.7, 5e5)])
def test_tangent_is_the_slope_of_the_force(geared, angle, wheel, tangent_and_slope):
    drive = with_fields(geared, {"pin_wheel.support_stiffness": wheel})
    scaled, slope = tangent_and_slope(drive, np.array([angle]))
    np.testing.assert_allclose(slope, scaled, rtol=0.0, atol=2e-6 * np.abs(scaled).max())


RUBS = {
    "friction.pin": 0.05,
    "friction.roller": 1e-3,
    "friction.support_bearing": 0.01,
    "friction.support_bearing_radius": 40.0,
}
SLOWLY = [pytest.param(name, marks=pytest.mark.slow) for name in ("plain", "rubs", "held")]


@pytest.mark.parametrize("kind", ["rigid", *SLOWLY])
def test_teeth_arm_and_main_bearing_balance_by_energies_alone(geared, kind):
    """Tooth forces from base circles, bending by quadrature; the carrier moves on the main bearing under the sun's forces."""
    drive = with_fields(geared, {"load.external.0.force.x": 500.0, "pin_wheel.support_stiffness": 5e5})
    if kind == "rigid":
        drive = rigid(drive)
    if kind in ("rubs", "held"):
        drive = with_fields(drive, RUBS | {"installation.held": "pin-shaft" if kind == "held" else "pin-wheel"})
    model = HalfSpace().prepare(drive).model
    found = solve_at_output(model, [drive], ANGLES, drive.load.torque)
    for position in range(ANGLES.size):
        assert find_imbalance(drive, model, found, position, torque=drive.load.torque) == []


@pytest.mark.slow
def test_stiffness_of_the_reducer_is_that_of_both_stages_in_series(rv):
    """Of rigid cranks 1/K grows by 1/(n c r_b² u²) of the mean crank moment, T_out/(i₁ u) … ; whose it is stands beside it."""
    plain = rigid(rv)
    drive = with_fields(plain, TEETH | {"first_stage.mesh_stiffness": 3e5, "first_stage.backlash": 0.03})
    curve, bare = (torque_curve(one, position_angles(8) / 39.0, points=4) for one in (drive, plain))
    np.testing.assert_array_equal(curve.stiffness, bare.stiffness)
    np.testing.assert_array_equal(bare.reducer_stiffness, bare.stiffness)
    series = 1.0 / curve.reducer_stiffness - 1.0 / curve.stiffness
    # moments of the cranks add up to 1/u of the wheel's; 1 % of that is how it changes over the mesh period
    by_hand = (80.0 / 81.0) ** 2 / 40.0**2 / (3.0 * 3e5 * (28.0 * np.cos(np.pi / 9.0)) ** 2)
    np.testing.assert_allclose(series.mean(axis=0), by_hand, rtol=0.01)
    play = 0.03 / 28.0 / 40.0 * 80.0 / 81.0
    np.testing.assert_allclose(curve.backlash - bare.backlash, play, rtol=1e-9)
    twice = 2.0 * 0.03 * drive.load.torque * by_hand
    np.testing.assert_allclose((curve.lost_motion - bare.lost_motion).mean(), play + twice, rtol=0.01)
    assert "first stage" in yielding_parts(drive).reducer
    assert "first stage" not in yielding_parts(drive).cycloid_stage
    assert "first stage (first_stage.mesh_stiffness)" in yielding_parts(plain).rigid


@pytest.mark.parametrize(("held", "refused"), [("pin-wheel", True), ("pin-shaft", False)])
def test_planets_have_a_place_where_the_main_bearing_carries_them(rv, held, refused):
    """They stood in the middle of the discs where it was left out; with rigid cranks no arm of theirs moves anything else."""
    fields = TEETH | {"first_stage.plane": None, "main_bearing.radial_stiffness": 1e6, "installation.held": held}
    if not refused:
        assert with_fields(rigid(rv), fields).first_stage.plane is None
        return
    with refused_field("first_stage.plane", "", "must be given with main_bearing, mm on the axis"):
        with_fields(rigid(rv), fields)


def test_one_crank_has_no_first_stage(paper_cases):
    with refused_field("first_stage", "", "must be left out with one crank (crank.number = 1)"):
        with_fields(paper_cases["CS-1"], TEETH)


@pytest.mark.slow
def test_loads_of_a_millionth_turn_geared_drives_as_far(geared):
    """The input held, both ways: backlash of the teeth, and of the cycloid stage by root finding on the loaded model."""
    found = compare(geared, np.array([0.3]))
    assert [one.outcome for one in found] == ["alike"], found


@pytest.mark.slow
@pytest.mark.nightly
@pytest.mark.parametrize(("first", "count"), [(0, 20), (20, 20), (40, 20)])
def test_loads_of_a_millionth_turn_reducers_of_all_kinds_as_far(first, count):
    """1 % or 0.005′, as of three hundred practical drives in ``test_free_play``; some have teeth. A quarter of a minute each."""
    found = [one for seed in range(first, first + count) for one in compare_with_load(seed, crank_drive)]
    assert not [one for one in found if one.outcome == "wrong"]
    assert sum(one.outcome == "alike" for one in found) >= count // 2
