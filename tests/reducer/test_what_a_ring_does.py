"""What results, page and export have of an elastic ring of the wheel."""

from __future__ import annotations

import tomllib

import numpy as np
import pytest

from ltca.analysis.engines import HalfSpace
from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.results import labelled_results
from ltca.drive.single_discs import single_discs
from ltca.errors import DriveError
from ltca.export.parts import make_parts
from ltca.page.run_arrays import ring_arrays
from ltca.page.scene import moving_scene
from ltca.reading.drive_file import build_drive, load_drive, shipped_drive

ANGLES = np.array([0.2, 1.3])


@pytest.fixture(scope="module")
def drive():
    rigid = load_drive("robot-joint").cases["nominal"]
    return rigid.with_fields(
        {"ring": {"inner_radius": 60.0, "outer_radius": 80.0, "width": 30.0, "material": "42CrMo4"}}
    )


@pytest.fixture(scope="module")
def found(drive):
    return analyse(drive, ANGLES, engine=HalfSpace())


def test_the_ring_moves_beyond_every_rigid_motion(found):
    """A free ring is displaced relative to the rigid motion that fits its seats best: no mean, no moment (round-off)."""
    moved = found.ring_displacements
    place = found.model.discs[0].geometry.placement.wheel_pin_centres
    fixed = moved * place / np.abs(place)
    largest = np.abs(moved).max()
    assert largest > 1e-3
    np.testing.assert_allclose(fixed.mean(axis=1), 0.0, atol=1e-12 * largest)
    np.testing.assert_allclose(moved.imag.mean(axis=1), 0.0, atol=1e-12 * largest)


def test_shares_of_the_compliance_have_the_ring(found, drive):
    shares = found.compliance_shares
    total = sum(shares.values())
    np.testing.assert_allclose(total, 1.0, rtol=1e-12)  # the last share is what is left of one
    assert np.all(shares["ring"] > 0.01)
    rigid = analyse(drive.with_fields({"ring.material.youngs_modulus": 1e15}), ANGLES, engine=HalfSpace())
    np.testing.assert_allclose(rigid.compliance_shares["ring"], 0.0, atol=1e-8)  # by the ratio of the moduli


def test_dataset_and_page_have_its_displacements(found, drive):
    data = labelled_results("joint", {"nominal": found})
    for name in ("ring_displacement_radial", "ring_displacement_tangential"):
        assert data[name].dims == ("case", "position", "pin")
    page = ring_arrays(data.isel(case=0))
    np.testing.assert_array_equal(page["ring/radial"], found.ring_displacements.real.T)
    assert moving_scene(single_discs(drive)[0])["ring"] == [60.0, 80.0]
    stiff = load_drive("robot-joint").cases["nominal"]
    rigid = labelled_results("joint", {"nominal": analyse(stiff, ANGLES, engine=HalfSpace())})
    assert ring_arrays(rigid.isel(case=0)) == {}


def test_the_wheel_is_exported_with_its_ring(drive):
    (part,) = make_parts(drive, "nominal", "pin-wheel")
    (ring,) = (body for body in part.bodies if body.name == "ring of the wheel")
    assert (ring.outer.radius, ring.inner[0].radius, ring.top - ring.bottom) == (80.0, 60.0, 30.0)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"outer_radius": 59.0}, "ring.outer_radius = 59 mm: must be greater than ring.inner_radius"),
        ({"inner_radius": 57.0}, "ring.inner_radius = 57 mm: must be greater than 57.5 mm"),
        ({"inner_radius": 63.0}, "ring.inner_radius = 63 mm: must be at most 62.5 mm"),
        ({"outer_radius": 62.5}, "ring.outer_radius = 62.5 mm: must be greater than 62.5 mm"),
        ({"flange": "one-side"}, 'ring.flange = "one-side": must be "free" or "built-in"'),
        ({"flange": "built-in", "bolts": {"number": 8, "circle_radius": 70.0, "stiffness": 1e6}}, "ring.bolts"),
        (
            {"bolts": {"number": 2, "circle_radius": 70.0, "stiffness": 1e6}},
            "ring.bolts.number = 2: must be greater than or equal to 3",
        ),
        ({"bolts": {"number": 8, "circle_radius": 50.0, "stiffness": 1e6}}, "ring.bolts.circle_radius = 50 mm"),
        ({"material": "cheese"}, "ring.material = 'cheese': is no named material"),
    ],
)
def test_rings_that_hold_no_pins_are_refused(changes, words):
    ring = {"inner_radius": 60.0, "outer_radius": 80.0, "width": 30.0} | changes
    with pytest.raises(DriveError) as caught:
        build_drive(tomllib.loads(shipped_drive("robot-joint")) | {"ring": ring})
    assert any(words in problem for problem in caught.value.problems), caught.value.problems


@pytest.mark.parametrize("inner", [57.6, 59.0, 62.4])
def test_rings_whose_seats_hold_the_pins_are_taken(inner):
    ring = {"inner_radius": inner, "outer_radius": 80.0, "width": 30.0}
    assert build_drive(tomllib.loads(shipped_drive("robot-joint")) | {"ring": ring}).ring.inner_radius == inner
