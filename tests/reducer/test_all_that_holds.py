"""What holds the contacts, together: bearings with clearance or preload, posts, ring, teeth and an arm, confirmed by energies."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from refusals import refused_field

from ltca.analysis.engines import HalfSpace
from ltca.analysis.loaded_analysis import analyse
from ltca.drive.materials import Material
from ltca.drive.yielding_parts import yielding_parts
from ltca.equilibrium.output_angle import wheel_angle_of_input
from ltca.equilibrium.output_torque import solve_at_output
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import parse_drive, shipped_drive
from ltca.testing import balance_check
from ltca.testing.balance_check import find_imbalance
from ltca.testing.practical_drives import compare

ANGLES = np.array([0.3, 1.9])
TEETH = {
    "first_stage.sun_teeth": 20, "first_stage.planet_teeth": 40, "first_stage.helix_angle": 0.2,
    "first_stage.mesh_stiffness": 3e5, "first_stage.backlash": 0.02, "first_stage.plane": 40.0,
}  # fmt: skip
POSTS = {
    "carrier.posts.number": 3, "carrier.posts.radius": 42.0, "carrier.posts.size": 20.0, "carrier.flange": (10.0, 8.0),
    "carrier.stiffness_torsion": 4e8,
}  # fmt: skip
LOOSE = {"main_bearing.radial_stiffness": 1e6, "main_bearing.clearance": 0.02}
TIGHT = {"crank.support.preload": "300 N", "main_bearing.radial_stiffness": 1e6, "main_bearing.preload": "2 µm"}
LIFTING = {"crank.support.preload": "3 N"}
TWISTS = {"crank.support.torsion": True, "crank.support.spline_plane": 40.0}
ARM = {"load.external.0.force.x": 300.0, "load.external.0.frame": "output"}
RUBS = {
    "friction.pin": 0.05, "friction.roller": 0.001, "friction.support_bearing": 0.002,
    "friction.support_bearing_radius": 15.0,
}  # fmt: skip
KINDS = {
    "teeth, posts": TEETH | POSTS,
    "teeth, posts, lifting": TEETH | POSTS | LIFTING,
    "loose cranks, posts": POSTS | {"crank.support.clearance": 0.01},
    "all": TEETH | POSTS | TIGHT | TWISTS | ARM | RUBS,
    "all, loose wheel": TEETH | POSTS | LIFTING | LOOSE | TWISTS | ARM,
}


@pytest.fixture(scope="module")
def rv():
    return parse_drive(shipped_drive("rv"), "rv").cases["nominal"]


def ringed(drive):
    circle = drive.pin_wheel.pin_circle_radius
    return with_fields(drive, {"ring.inner_radius": circle, "ring.outer_radius": circle + 15.0, "ring.width": 20.0})


def balanced(drive):
    model = HalfSpace().prepare(drive).model
    return model, solve_at_output(model, [drive], ANGLES, drive.load.torque)


@pytest.mark.parametrize(
    "name",
    [
        *(pytest.param(name, marks=pytest.mark.slow) for name in ("teeth, posts", "ring", "teeth, posts, lifting")),
        *(pytest.param(name, marks=pytest.mark.nightly) for name in ("all", "all, loose wheel", "loose cranks, posts")),
    ],
)
def test_the_independent_check_confirms_it(rv, name):
    drive = with_fields(rv, KINDS.get(name, KINDS["all"]))
    drive = ringed(drive) if name == "ring" else drive
    model, found = balanced(drive)
    for position in range(ANGLES.size):
        assert find_imbalance(drive, model, found, position, torque=drive.load.torque) == []


def test_the_independent_check_confirms_rigid_cranks_on_posts(rv):
    """Cranks without springs stand in the far flange, and so do the forces of their planets."""
    drive = with_fields(rv, TEETH | POSTS)
    drive = replace(
        drive,
        crank=replace(drive.crank, support=None),
        materials=replace(drive.materials, crankshaft=Material()),
    )
    model, found = balanced(drive)
    assert find_imbalance(drive, model, found, torque=drive.load.torque) == []


@pytest.mark.slow
@pytest.mark.parametrize(("bearing", "plane"), [(0, -31.0), pytest.param(1, 31.0, marks=pytest.mark.slow)])
def test_the_independent_check_misses_no_bearing(rv, bearing, plane, monkeypatch):
    """What the bearing next to the planets carries of their teeth left out of the check: more than the thousandth that passes."""
    drive = with_fields(rv, KINDS["teeth, posts, lifting"] | {"first_stage.plane": plane})
    model, found = balanced(drive)
    whole = balance_check.teeth_on_shafts

    def without(*given):
        on_discs, carried = whole(*given)
        return on_discs, np.where(np.arange(2)[:, None] == bearing, 0.0, carried)

    monkeypatch.setattr(balance_check, "teeth_on_shafts", without)
    assert any("slope" in problem for problem in find_imbalance(drive, model, found))


def test_preload_beyond_reach_is_the_spring_it_stands_for(rv):
    """No side lifts off: the bearings of the cranks are linear, with posts and teeth as without a preload."""
    spring = with_fields(rv, TEETH | POSTS)
    tight = with_fields(spring, {"crank.support.preload": "1000 kN"})
    (one, linear), (other, held) = balanced(spring), balanced(tight)
    # Both balances leave 1e-9 of a load of kilonewtons behind.
    np.testing.assert_allclose(held.response.pin_load, linear.response.pin_load, rtol=0.0, atol=1e-4)
    angles = [wheel_angle_of_input(model, found) for model, found in ((one, linear), (other, held))]
    np.testing.assert_allclose(angles[1], angles[0], rtol=1e-8)


@pytest.mark.slow
def test_shares_add_up_with_everything(rv):
    found = analyse(with_fields(ringed(rv), KINDS["all"]), ANGLES)
    shares = found.compliance_shares
    np.testing.assert_allclose(sum(shares.values()), 1.0, rtol=1e-12)
    assert all(np.all(shares[part] > 0.0) for part in ("pins", "ring", "crank_bearings", "cranks", "carrier"))


def test_the_output_lags_by_teeth_and_by_the_carrier(rv):
    """The twist of the carrier adds T/k to what the input held leaves: neither hides the other."""
    stiff = with_fields(rv, TEETH)
    soft = with_fields(stiff, {"carrier.stiffness_torsion": 4e8})
    one, other = (analyse(drive, ANGLES) for drive in (stiff, soft))
    # at the wheel held the output turns with the torque, which winds it up
    twist = rv.driving_sign * rv.load.torque / 4e8
    np.testing.assert_allclose(other.transmission_error - one.transmission_error, twist, rtol=1e-9)
    np.testing.assert_allclose(other.stage_wind_up - one.stage_wind_up, abs(twist) * light_part(rv), rtol=1e-7)


def light_part(drive):
    return 1.0 - drive.load.light_torque / drive.load.torque


@pytest.mark.slow
def test_play_has_teeth_and_the_loose_main_bearing(rv):
    """The input held, both ways, against loads of a millionth."""
    found = compare(with_fields(rv, TEETH | LOOSE), ANGLES[:1])
    assert [one.outcome for one in found] == ["alike"], found


def test_parts_that_yield_are_told(rv):
    bare, whole = yielding_parts(rv), yielding_parts(with_fields(ringed(rv), KINDS["all"]))
    assert whole.rigid == ("bending of wheel pins (pin_wheel.beam)",)
    told = {part.rpartition(" (")[0] for part in bare.rigid}
    assert told == {*whole.reducer, "bending of wheel pins"} - {*bare.reducer}


def test_cranks_with_clearance_are_refused_beside_teeth(rv):
    """A planet on a crank that floats has no place in the mesh: its lag was anything within the clearance."""
    with refused_field("crank.support.clearance", "= 0.01 mm", "beside first_stage", bound=("at most", 0.0)):
        with_fields(rv, TEETH | {"crank.support.clearance": 0.01})
