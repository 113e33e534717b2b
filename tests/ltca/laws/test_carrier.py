"""Posts and flanges of a carrier: hand calculations, sums, limits."""

from __future__ import annotations

from dataclasses import replace
from math import pi, sqrt

import numpy as np
import pytest

from ltca.drive.parts import Carrier, CarrierPosts, Material, Materials, ShaftPinBeam
from ltca.laws.carrier import far_flange_stiffness, flange_compliance, post_stiffness
from ltca.reading.drive_file import load_drive
from ltca.testing.yielding_pins import post_forces

EXACT = 1e-12
"""Round-off of a few operations."""


def carried(name, **words):
    """A shipped drive with shaft pins tied, if it has any, and a carrier on posts."""
    drive = load_drive(name).cases["nominal"]
    if drive.pin_shaft is not None:
        beam = ShaftPinBeam(span=30.0, tip="tied-pinned")
        drive = replace(drive, pin_shaft=replace(drive.pin_shaft, stiffness=None, beam=beam))
    return replace(drive, carrier=Carrier(**words))


def test_a_post_between_rigid_flanges_by_hand():
    """d = 12, L = 30 mm, E = 206 GPa, ν = 0.3: I = 1017.876 mm⁴, A = 113.097 mm², κ = 7.8/8.8, G = 79230.77 MPa."""
    second, area, shear = pi * 12.0**4 / 64.0, pi * 36.0, 206e3 / 2.6
    across, twist = post_stiffness(30.0, 12.0, 206e3, 0.3)
    assert 1.0 / across == pytest.approx(
        30.0**3 / (12.0 * 206e3 * second) + 30.0 / (7.8 / 8.8 * shear * area), rel=EXACT
    )
    assert twist == pytest.approx(shear * 2.0 * second / 30.0, rel=EXACT)
    assert across == pytest.approx(68_929.2, rel=2e-6)  # 1/(1.073051e-5 + 3.77714e-6), by calculator


def test_ends_that_turn_freely_leave_a_cantilever():
    """Without hold at one end 3EI/L³ is left, whichever end that is."""
    held = 3.0 * 206e3 * pi * 12.0**4 / 64.0 / 400.0**3
    for ends in ((0.0, 1e3), (1e3, 0.0)):
        across, _ = post_stiffness(400.0, 12.0, 206e3, 0.3, ends)
        assert across == pytest.approx(held, rel=2e-3)  # shear of a post as slender as that


def test_equal_flanges_add_half_their_rotation():
    """Each end carries FL/2 and moves the other by c (FL/2) L/2: both together c L²/2 per force."""
    rigid, soft = (post_stiffness(30.0, 12.0, 206e3, 0.3, (c, c))[0] for c in (0.0, 3e-9))
    assert 1.0 / soft - 1.0 / rigid == pytest.approx(3e-9 * 30.0**2 / 2.0, rel=1e-9)


def test_a_flange_bends_between_its_posts_by_hand():
    """R = 42, 3 posts of 20, t = 10: s = 2π·14 − 20 = 67.96 mm, I = 42·1000/12 = 3500 mm⁴; 12 E I/s on either post."""
    free = 2.0 * pi * 14.0 - 20.0
    assert flange_compliance(10.0, 3, 42.0, 20.0, 206e3) == pytest.approx(free / (12.0 * 206e3 * 3500.0), rel=EXACT)
    assert free / (12.0 * 206e3 * 3500.0) == pytest.approx(7.855e-9, rel=1e-4)  # by calculator


@pytest.mark.parametrize("name", ["robot-joint", "rv"])
@pytest.mark.parametrize("number", [2, 3, 5])
@pytest.mark.parametrize("flange", [None, (8.0, 14.0)])
def test_posts_add_up(name, number, flange):
    """Against stiffness matrices of bars put together post by post; symmetric, positive, alike in x and y."""
    posts = CarrierPosts(number=number, radius=33.0, size=12.0, length=33.0)
    drive = carried(name, posts=posts, flange=flange)
    drive = replace(drive, materials=Materials(carrier=Material(youngs_modulus=110e3, poisson_ratio=0.27)))
    found = far_flange_stiffness(drive)
    np.testing.assert_allclose(found, post_forces(drive), rtol=1e-9, atol=1e-9 * found[2, 2])
    assert np.all(np.linalg.eigvalsh(found) > 0.0)


def test_thick_flanges_are_rigid():
    posts = CarrierPosts(number=4, radius=38.0, size=12.0, length=33.0)
    rigid, thick, thin = (
        far_flange_stiffness(carried("robot-joint", posts=posts, flange=flange))
        for flange in (None, (1e4, 1e4), (6.0, 6.0))
    )
    np.testing.assert_allclose(thick, rigid, rtol=1e-6)  # (12/1e4)³ of the post
    assert np.all(np.diag(thin) < 0.9 * np.diag(rigid))


def test_posts_on_the_circle_of_the_pins_do_not_shear_the_flange():
    """Without tilt of the flange rotation and displacement differ by R² alone, and by the twist of the posts."""
    posts = CarrierPosts(number=4, radius=38.0, size=12.0, length=33.0)
    drive = carried("robot-joint", posts=posts, flange=(8.0, 8.0))
    assert drive.pin_shaft.pin_circle_radius == 38.0
    found = far_flange_stiffness(drive)
    twist = 4.0 * post_stiffness(33.0, 12.0, 206e3, 0.3)[1]
    assert sqrt((found[2, 2] - twist) / found[0, 0]) == pytest.approx(38.0, rel=EXACT)
