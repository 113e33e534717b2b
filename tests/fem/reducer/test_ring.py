"""Full finite elements with the elastic ring of the pin wheel, against the loaded tooth contact analysis with the same ring."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from plane_joint import compared, plane_joint

from fem.body.pin_ring import seat_flexibility
from fem.reducer.solution_files import build_dataset, summarise
from ltca.analysis.engines import PlaneStrain
from ltca.analysis.loaded_analysis import analyse
from ltca.compliance.ring import ring_flexibility
from ltca.drive.single_discs import single_discs
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive

ANGLE = 0.5
RING = {"inner_radius": 60.5, "outer_radius": 72.5, "width": 30.0, "model": "fe"}


def joint(discs):
    """The shipped joint in the plane, which `fe` has coefficients of, with an elastic ring."""
    drive = plane_joint(ring=RING)
    return drive if discs == 2 else single_discs(drive)[0]


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    """A cache of rings of its own."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


@pytest.mark.slow
@pytest.mark.nightly
def test_one_disc_on_an_elastic_ring():
    """1 % of load and 0.5″; on two elements for a half-width 0.5 % and 0.1″, where without a ring 0.2 % and 0.1″ are left."""
    drive = joint(1)
    full, own, load, turned = compared(drive, ANGLE, 4.0)
    assert load < 0.01
    assert turned < 0.5
    rigid = analyse(replace(drive, ring=None), np.array([ANGLE]), engine=PlaneStrain())
    assert full.discs[0].contacts.pin_load.max() < 0.95 * rigid.full.response.pin_load.max()
    np.testing.assert_allclose(full.ring_displacements, own.ring_displacements[0], atol=2e-4)  # of 0.01 mm, 1 % of load
    summary, dataset = summarise(full), build_dataset(full, "nominal")
    np.testing.assert_array_equal(summary["ring_displacement_radial_mm"], full.ring_displacements.real)
    np.testing.assert_array_equal(dataset["ring_displacement_tangential"].values[0, 0], full.ring_displacements.imag)


@pytest.mark.slow
@pytest.mark.nightly
def test_two_discs_share_the_ring():
    """The forces of both hold the seats: as for one disc."""
    full, own, load, turned = compared(joint(2), ANGLE, 4.0)
    assert load < 0.01
    assert turned < 0.5
    first, second = (disc.pose.wheel_pin_displacements for disc in full.discs)
    np.testing.assert_allclose(first, second, rtol=1e-12)
    np.testing.assert_allclose(full.ring_displacements, own.ring_displacements[0], atol=2e-4)


@pytest.mark.slow
@pytest.mark.parametrize(
    "more",
    [
        {},
        pytest.param({"flange": "built-in"}, marks=pytest.mark.nightly),
        {"bolts": {"number": 8, "circle_radius": 101.0, "stiffness": 5e5}},
    ],
)
def test_the_ring_of_the_analysis_is_that_of_the_full_solution(more):
    """Bolts as springs in the mesh against bolts joined to its flexibility; means over the ring's symmetry against none."""
    sizes = {"inner_radius": 88.5, "outer_radius": 106.0, "width": 20.0, "model": "fe"}
    drive = with_fields(load_drive("paper").cases["CS-1"], {"ring": sizes | more})
    own, other = seat_flexibility(drive), ring_flexibility(drive)
    np.testing.assert_allclose(
        own.reshape(other.shape), other, atol=1e-4 * np.max(other)
    )  # equal seats on a mesh: 6e-5
