"""Stiffness with and without each part: what is softer yields more, parts in series add up, rigid parts are absent ones."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ltca.analysis.stiffness_by_part import stiffness_by_part
from ltca.analysis.torque_curve import torque_curve
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive

ANGLES = np.array([0.3])
QUICK = {"lost_motion": 0.5}
"""Read where the stiffness is read anyway: small torques are the dear ones."""
SPRUNG = {
    "main_bearing.radial_stiffness": 1e6, "carrier.stiffness_torsion": 4e8, "carrier.flange": (10.0, 8.0),
    "carrier.posts.number": 3, "carrier.posts.radius": 42.0, "carrier.posts.size": 20.0,
    "crank.support.torsion": True, "crank.support.spline_plane": 40.0,
    "first_stage.sun_teeth": 20, "first_stage.planet_teeth": 40, "first_stage.mesh_stiffness": 3e5,
    "first_stage.backlash": 0.02, "first_stage.plane": 40.0,
    "ring.inner_radius": 80.0, "ring.outer_radius": 95.0, "ring.width": 20.0,
}  # fmt: skip
NAMES = [
    "crankshafts and their bearings", "torsion of the crankshafts", "main bearing", "ring that carries the wheel pins",
    "flanges and posts of the carrier", "torsion of the carrier", "first stage",
]  # fmt: skip


def shipped(name):
    return next(iter(load_drive(name).cases.values()))


@pytest.fixture(scope="module")
def whole():
    return with_fields(shipped("rv"), SPRUNG)


@pytest.fixture(scope="module")
def table(whole):
    return stiffness_by_part(whole, ANGLES, **QUICK)


def read(drive):
    """Reducer's stiffness of both senses, and angle from one rated torque to the other."""
    curve = torque_curve(drive, ANGLES, points=0, **QUICK)
    return curve.reducer_stiffness[0], curve.output_angle[0, -1] - curve.output_angle[0, 0]


SOFTER = {
    "bearings of cranks": {"crank.support.stiffness": (2e5, 2e5)},
    "crankshafts": {"materials.crankshaft.youngs_modulus": 1e5},
    "ring": {"ring.material.youngs_modulus": 1e5},
    "posts and flanges": {"materials.carrier.youngs_modulus": 1e5},
    "twist of the carrier": {"carrier.stiffness_torsion": 2e8},
    "teeth": {"first_stage.mesh_stiffness": 1.5e5},
}
POSTS = {"carrier.posts.number": 6, "carrier.posts.radius": 44.0, "carrier.posts.size": 16.0}


@pytest.mark.nightly
@pytest.mark.slow
def test_any_softer_part_makes_the_reducer_softer(whole):
    stiff, turned = read(whole)
    for name, fields in SOFTER.items():
        softer, further = read(with_fields(whole, fields))
        assert np.all(softer < stiff), name
        assert further > turned, name


@pytest.mark.parametrize(
    ("name", "common", "fields"),
    [
        ("paper", {"main_bearing.radial_stiffness": 1e6}, {"main_bearing.radial_stiffness": 5e5}),
        ("paper", {}, {"pin_shaft.stiffness": 5e5}),
        pytest.param("sleeved", POSTS, {"pin_wheel.beam.span": 32.0}, marks=pytest.mark.slow),
        pytest.param("sleeved", POSTS, {"materials.carrier.youngs_modulus": 5e4}, marks=pytest.mark.slow),
    ],
)
def test_a_softer_part_of_other_drives_makes_them_softer(name, common, fields):
    drive = with_fields(shipped(name), common)
    (stiff, turned), (softer, further) = read(drive), read(with_fields(drive, fields))
    assert np.all(softer < stiff)
    assert further > turned


@pytest.mark.slow
def test_each_part_takes_its_share(table):
    """Left out it leaves less wind-up than there was, alone it adds to that of the contacts."""
    assert [*table.without] == NAMES
    for name, without in table.without.items():
        assert without.wind_up < table.whole.wind_up, name
    # Twist of a crank needs a shaft.
    assert [*table.alone] == [name for name in NAMES if name != "torsion of the crankshafts"]
    for name, alone in table.alone.items():
        assert table.contacts.wind_up < alone.wind_up < table.whole.wind_up, name


@pytest.mark.slow
def test_a_part_in_series_adds_its_own_compliance(table):
    """The twist of the carrier, T/k, moves no load."""
    for more, less in (
        (table.whole, table.without["torsion of the carrier"]),
        (table.alone["torsion of the carrier"], table.contacts),
    ):
        # angles in a balance to 1e-9 of the load, of which differences are a tenth
        assert 1.0 / more.stiffness - 1.0 / less.stiffness == pytest.approx(1.0 / 4e8, rel=1e-6)
        assert more.wind_up - less.wind_up == pytest.approx(shipped("rv").load.torque / 4e8, rel=1e-6)


@pytest.mark.slow
def test_rows_are_those_of_files_that_leave_the_parts_out(table, whole):
    """By hand: the same drives made by other fields."""
    rv = shipped("rv")
    bare = replace(rv, crank=replace(rv.crank, support=None))
    teeth = with_fields(bare, {"materials.crankshaft.youngs_modulus": 206e3} | {
        key: value for key, value in SPRUNG.items()
        if key.startswith("first_stage") and "mesh" not in key
    })  # fmt: skip
    for drive, found in (
        (teeth, table.contacts),
        (with_fields(whole, {"ring.material.youngs_modulus": 1e13}), table.without["ring that carries the wheel pins"]),
        (with_fields(whole, {"carrier.posts.size": 70.0, "materials.carrier.youngs_modulus": 1e13}),
         table.without["flanges and posts of the carrier"]),
    ):  # fmt: skip
        stiffness, turned = read(drive)
        # 206e3/1e13 of what the part yields, and a balance to 1e-9 of the load
        assert found.stiffness == pytest.approx(stiffness.mean(), rel=1e-6)
        assert 2.0 * found.wind_up + found.backlash == pytest.approx(turned, rel=1e-6)


@pytest.mark.slow
def test_rigid_posts_hold_the_tips_of_pins():
    """Left out altogether they would let them float, and the reducer would be softer without its carrier."""
    drive = with_fields(shipped("sleeved"), POSTS)
    found = stiffness_by_part(drive, ANGLES, **QUICK)
    floating = stiffness_by_part(shipped("sleeved"), ANGLES, **QUICK)
    without = found.without["flanges and posts of the carrier"]
    assert without.stiffness > found.whole.stiffness > floating.whole.stiffness


def test_a_drive_that_describes_nothing_is_told_so():
    found = stiffness_by_part(shipped("paper"), ANGLES)
    assert [*found.rows] == ["everything that is described"]
    assert found.whole == found.contacts
    assert any(
        "rigid in all rows, because left out: bending of wheel pins (pin_wheel.beam), " in line for line in found.lines
    )


def test_friction_is_left_out():
    drive = shipped("paper")
    assert stiffness_by_part(with_fields(drive, {"friction.pin": 0.1}), ANGLES) == stiffness_by_part(drive, ANGLES)
