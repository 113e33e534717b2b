"""Mesh of a first stage: how its teeth and the parts that hold the cranks turn them."""

from dataclasses import replace

import numpy as np
import pytest

from ltca.drive.parts import Carrier, CarrierPosts, Material
from ltca.equilibrium.first_stage import StageMesh
from ltca.geometry.coordinates import Coordinates
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive

TEETH = {
    "first_stage.sun_teeth": 20,
    "first_stage.planet_teeth": 40,
    "first_stage.plane": 40.0,
    "first_stage.mesh_stiffness": 3e5,
}


def geared():
    return with_fields(load_drive("rv").cases["nominal"], TEETH)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_rigid_cranks_lag_by_their_teeth_alone(sense):
    """Of a moment shared by n cranks each turns by 1/(n c r_b²), r_b = 2/3 of the distance of the axes times cos 20°."""
    drive = geared()
    rigid = replace(drive, crank=replace(drive.crank, support=None))
    rigid = replace(rigid, materials=replace(drive.materials, crankshaft=Material()))
    by_moment, by_pose = StageMesh.of_drive(rigid).together(sense)
    base = drive.crank.circle_radius * 40.0 / 60.0 * np.cos(np.pi / 9.0)
    assert by_moment == pytest.approx(1.0 / (drive.crank.number * 3e5 * base**2), rel=1e-12)
    assert not by_pose.any()


def test_cranks_that_bend_lag_more():
    drive = geared()
    by_moment = StageMesh.of_drive(drive).together(1.0)[0]
    base = drive.crank.circle_radius * 40.0 / 60.0 * np.cos(np.pi / 9.0)
    assert by_moment > 1.001 / (drive.crank.number * 3e5 * base**2)


def test_a_far_flange_that_turns_moves_planets_about_the_axis():
    """x, y and rotation of a flange: (1, i, i p) of each crank's place p, by the part that its far bearing has of the planet."""
    drive = geared()
    drive = replace(drive, carrier=Carrier(posts=CarrierPosts(number=3, radius=42.0, size=14.0)))
    stage, coordinates = StageMesh.of_drive(drive), Coordinates.of_drive(drive)
    along_x, along_y, turned = np.moveaxis(stage.by_pose[..., coordinates.ring_place], -1, 0)
    assert np.all(np.abs(along_x) > 1e-6)
    np.testing.assert_allclose(along_y, 1j * along_x, rtol=1e-12)
    places = drive.crank.circle_radius * np.exp(2j * np.pi * np.arange(drive.crank.number) / drive.crank.number)
    np.testing.assert_allclose(turned, 1j * places[:, None] * along_x, rtol=1e-12)
