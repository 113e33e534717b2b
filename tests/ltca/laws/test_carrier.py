"""Posts and flanges of a carrier: hand calculations, energies, limits."""

from __future__ import annotations

from dataclasses import replace
from math import log, pi, sqrt

import numpy as np
import pytest

from ltca.drive.parts import Carrier, CarrierPosts, Material, Materials, ShaftPinBeam
from ltca.laws.carrier import boss_compliance, far_flange_stiffness, post_stiffness
from ltca.reading.drive_file import load_drive
from ltca.testing.yielding_pins import plate_rotation, post_forces

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


@pytest.mark.parametrize("ratio", [0.0, 0.3, 0.45])
def test_a_boss_turns_by_the_energy_of_its_plate(ratio):
    """M φ = 2U with U from the curvatures of the plate by quadrature; the four constants come from its edges."""
    thickness, boss, support, modulus = 8.0, 6.0, 22.0, 206e3
    found = boss_compliance(thickness, boss, support, modulus, ratio)
    assert found == pytest.approx(plate_rotation(thickness, boss, support, modulus, ratio), rel=1e-10)
    rigidity = modulus * thickness**3 / (12.0 * (1.0 - ratio**2))
    # A r + B/r + C r³ + D r ln r under a unit moment, from the boss (plane), the support and D = −1/4πD_P.
    a, b, d = boss, support, -1.0 / (4.0 * pi * rigidity)
    edges = np.array([
        [-2.0 / a**2, 2.0 * a**2],
        [2.0 * (1.0 - ratio) / b**3, (6.0 + 2.0 * ratio) * b],
    ])  # fmt: skip
    inverse, cubic = np.linalg.solve(edges, -d * np.array([1.0, (1.0 + ratio) / b]))
    nodes, weights = np.polynomial.legendre.leggauss(60)
    r = 0.5 * (a + b) + 0.5 * (b - a) * nodes
    bend = 2.0 * inverse / r**3 + 6.0 * cubic * r + d / r  # w_rr by cos θ
    round_about = -2.0 * inverse / r**3 + 2.0 * cubic * r + d / r  # w_r/r + w_θθ/r²
    twist = -(-2.0 * inverse / r**3 + 2.0 * cubic * r + d / r)  # (w_θ/r)_r by sin θ
    density = (bend + round_about) ** 2 - 2.0 * (1.0 - ratio) * (bend * round_about - twist**2)
    energy = 0.5 * rigidity * pi * float((weights * density * r).sum()) * 0.5 * (b - a)
    assert found == pytest.approx(2.0 * energy, rel=1e-10)


def test_a_small_boss_in_a_wide_plate():
    """For a « b the rotation is [ln(b/a) − (2 + ν)/(3 + ν)]/4πD_P."""
    rigidity = 206e3 * 8.0**3 / (12.0 * 0.91)
    known = (log(1e4) - 2.3 / 3.3) / (4.0 * pi * rigidity)
    assert boss_compliance(8.0, 1e-3, 10.0, 206e3, 0.3) == pytest.approx(known, rel=1e-7)  # (a/b)² is left out
    assert boss_compliance(8.0, 10.0, 10.0, 206e3, 0.3) == 0.0


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
