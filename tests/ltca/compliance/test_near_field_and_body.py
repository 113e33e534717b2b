"""What the coupled models make of bodies in closed form: Johnson's half-planes and cylinders, whatever the patches.

Each pair has the load it has in an equilibrium of the whole drive, its approach is read from the response.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from ltca.compliance.coupled import CoupledCompliance
from ltca.compliance.near_field import finite_length_approach
from ltca.contact.hertz import line_half_width
from ltca.drive.parts import Material, Materials
from ltca.equilibrium.balance import solve_equilibrium
from ltca.equilibrium.reducer import Reducer
from ltca.testing.closed_form_bodies import CROSS_SHARE, cylinder_approach, half_plane_approach
from validation.hertz import strip_approach

ANGLES = np.array([0.0, 0.5])
DEPTH = 300.0
ROLLER = 5.0
# Of each body another, so that none can stand for another.
MATERIALS = Materials(
    disc=Material(youngs_modulus=120_000.0, poisson_ratio=0.33),
    wheel_pin=Material(youngs_modulus=206_000.0, poisson_ratio=0.3),
    roller=Material(youngs_modulus=300_000.0, poisson_ratio=0.26),
    inner_race=Material(youngs_modulus=190_000.0, poisson_ratio=0.28),
)
BODIES = {"pin": ("disc", "wheel_pin"), "outer": ("disc", "roller"), "inner": ("inner_race", "roller")}


def constants(body):
    """E and ν of a body."""
    material = getattr(MATERIALS, body)
    return material.youngs_modulus, material.poisson_ratio


def plane_modulus(body):
    """E/(1 − ν²)."""
    modulus, ratio = constants(body)
    return modulus / (1.0 - ratio**2)


def width_of(kind, line, radius):
    """Hertz's half-width of a pair of bodies."""
    return line_half_width(line, radius, 1.0 / sum(1.0 / plane_modulus(body) for body in BODIES[kind]))


@pytest.fixture
def mixed(paper_cases):
    return {name: replace(drive, materials=MATERIALS) for name, drive in paper_cases.items()}


def widened(drive, width, roller_share=1.0):
    """The same drive `width` times as thick under that much more load, its rollers a part as long."""
    thickness = width * drive.disc.thickness
    load = drive.load
    return replace(
        drive,
        disc=replace(drive.disc, thickness=thickness),
        crank_bearing=replace(drive.crank_bearing, roller_length=roller_share * thickness),
        pin_shaft=replace(drive.pin_shaft, stiffness=width * drive.pin_shaft.stiffness),
        load=replace(load, torque=width * load.torque, light_torque=width * load.light_torque),
    )


def pair_approaches(model, drive):
    """Loads, approaches and effective radii of the well-loaded pairs of each kind: what the pair itself adds up to.

    A roller's two loads push it from both ends: each end yields to the other's load as well.
    """
    response = solve_equilibrium(Reducer(discs=(model,)), ANGLES, drive.wheel_moment()).response
    place = model.geometry.placement
    rollers, scale = response.rollers, 1.0 / (np.pi * plane_modulus("roller") * drive.crank_bearing.roller_length)
    across = 2.0 * CROSS_SHARE * scale
    kinds = {
        "pin": (response.pin_load, response.flank.approach, response.flank.effective_radius),
        "outer": (
            rollers.outer_load,
            rollers.outer_approach + across * rollers.inner_load,
            place.outer_effective_radii,
        ),
        "inner": (
            rollers.inner_load,
            rollers.inner_approach + across * rollers.outer_load,
            place.inner_effective_radii,
        ),
    }
    found = {}
    for kind, (load, approach, radius) in kinds.items():
        loaded = load > 0.05 * load.max()
        found[kind] = (load[loaded], approach[loaded], np.broadcast_to(radius, load.shape)[loaded])
    return found


def closed_forms(kind, load, radius, drive):
    """Approach of the pair in plane strain: two half-planes, or a half-plane and a squeezed cylinder."""
    line, (first, second) = load / drive.disc.thickness, BODIES[kind]
    width = width_of(kind, line, radius)
    below = half_plane_approach(line, width, DEPTH, *constants(first))
    if kind == "pin":
        return below + half_plane_approach(line, width, DEPTH, *constants(second))
    return below + cylinder_approach(line, width, ROLLER, *constants(second))


@pytest.mark.parametrize("half_width", [0.05, 0.2])
def test_plane_strain_is_johnsons_whatever_the_patches(half_width, mixed, closed_form):
    """The patch of the file, its own logarithm and self-energy, must leave no trace in the approach of a contact."""
    drive = mixed["CS-6"]
    model = CoupledCompliance.of_drive(drive, closed_form(drive, half_width=half_width, depth=DEPTH), "plane-strain")
    for kind, (load, approach, radius) in pair_approaches(model, drive).items():
        # the inner contact's law is inverted to 1e-9, and the balance holds to that
        np.testing.assert_allclose(approach, closed_forms(kind, load, radius, drive), rtol=1e-7, err_msg=kind)


@pytest.mark.slow
def test_half_spaces_tend_to_plane_strain_with_the_width(mixed, closed_form):
    """What is taken off is what the law holds: approaches differ by end effects alone, less the wider the drive.

    A 2 % smaller subtraction or one without the self-energy of the patch (a quarter of some 7 units) shifts them by 3 %.
    """
    worst = []
    for width in (1.0, 16.0, 256.0):
        drive = widened(mixed["CS-1"], width)
        model = CoupledCompliance.of_drive(drive, closed_form(drive, depth=DEPTH), "half-space")
        pairs = pair_approaches(model, drive).items()
        worst.append(
            max(
                float(np.max(np.abs(approach / closed_forms(kind, load, radius, drive) - 1.0)))
                for kind, (load, approach, radius) in pairs
            )
        )
    # 0.62, 0.35 and 0.19 % as they fade like one over the logarithm of the width
    assert worst[0] < 1e-2
    assert worst[2] < 3e-3
    assert worst[2] < 0.7 * worst[1] < 0.5 * worst[0]


def test_short_rollers_press_like_short_rollers(mixed, closed_form):
    """Two thirds as long on a wide disc: the roller yields like one of its own length, the disc by what the shorter load
    adds to that over its whole thickness (Lundberg's strips, both averaged alike)."""
    drive = widened(mixed["CS-1"], 256.0, roller_share=2.0 / 3.0)
    model = CoupledCompliance.of_drive(drive, closed_form(drive, depth=DEPTH), "half-space")
    load, approach, radius = pair_approaches(model, drive)["outer"]
    thickness, length = drive.disc.thickness, drive.crank_bearing.roller_length
    short, whole = (width_of("outer", load / size, radius) for size in (length, thickness))
    disc = plane_modulus("disc")
    expected = (
        cylinder_approach(load / length, short, ROLLER, *constants("roller"))
        + half_plane_approach(load / thickness, whole, DEPTH, *constants("disc"))
        + strip_approach(load / length, short, length, disc)[1]
        - strip_approach(load / thickness, whole, thickness, disc)[1]
    )
    # Lundberg's means are those of an even load; what they err by nearly cancels between both lengths (0.04 % measured)
    np.testing.assert_allclose(approach, expected, rtol=2e-3)
    even = closed_forms("outer", load, radius, drive)
    assert np.all(approach > 1.2 * even)


@pytest.mark.parametrize(("length", "nearest"), [(10.0, 0.97), (1000.0, 0.993)])
def test_what_a_half_space_holds_is_less_than_under_an_even_load(length, nearest):
    """Lundberg's mean over an even strip bounds the approach of a straight cylinder, and they meet as it gets long.

    By 2.0 and 0.4 %, a share that fades like the square of one over the logarithm of length by width.
    """
    half_width = 0.1
    line = 1.0 / length
    mean = float(strip_approach(line, half_width, length, 1.0)[1])
    separation = half_width**2 / (8.0 * np.pi * half_width**2 / (4.0 * line))
    ratio = finite_length_approach(length, half_width) / (mean - separation)
    assert nearest < ratio < 1.0


def test_what_is_taken_off_a_pin_is_the_patch_of_the_steepest_place(mixed, closed_form):
    """Half the load of the drive on one pin at a quarter of θ = 2π/z_P: there the near field of finite length and its body
    part add up to the half-planes of plane strain, whatever lies between.

    Of the trochoid where its eccentric is at α = z_C θ from the arm ρ₀ = R S³/(1 + z_P K² − K (1 + z_P) cos α), with
    S² = 1 + K² − 2 K cos α, and flank and pin have r (1 − r/ρ₀) between them.
    """
    drive = mixed["CS-1"]
    drive = replace(drive, disc=replace(drive.disc, equidistant_offset=0.0, shifting_offset=0.0))
    model = CoupledCompliance.of_drive(drive, closed_form(drive, depth=DEPTH), "half-space")
    wheel, thickness = drive.pin_wheel, drive.disc.thickness
    count, shortening = wheel.number_of_pins, drive.crank.eccentricity * wheel.number_of_pins / wheel.pin_circle_radius
    cosine = np.cos(0.5 * np.pi * (count - 1.0) / count)
    speed = (1.0 + shortening**2 - 2.0 * shortening * cosine) ** 1.5
    turning = 1.0 + count * shortening**2 - shortening * (1.0 + count) * cosine
    trochoid = wheel.pin_circle_radius * speed / turning
    radius = wheel.pin_radius * (1.0 - wheel.pin_radius / trochoid)
    line = 0.5 * abs(drive.wheel_moment()) / (drive.crank.eccentricity * count) / thickness
    width = width_of("pin", line, radius)
    # The load at which a patch of finite length is as wide, and what its bodies sink by: less the separation of the surfaces.
    low, high = 0.5 * width**2 / radius, 4.0 * width**2 / radius
    law, place = model.contacts.pin_law, np.array([radius])
    near = np.array(
        [brentq(lambda near: float(law.half_width(np.array([near]), place)[0]) - width, low, high, xtol=1e-15)]
    )
    load = law.load_and_stiffness(near, place)[0]
    own = np.diag(model.coefficients.disc)[0] + model.bodies[0].alone[0]
    sunk = near - width**2 / (8.0 * radius) + own * load
    expected = sum(
        half_plane_approach(load / thickness, width, DEPTH, *constants(body))
        - 0.5 * load / thickness / (np.pi * plane_modulus(body))
        for body in BODIES["pin"]
    )
    # round-off of tables and of the logarithms of the patch
    np.testing.assert_allclose(sunk, expected, rtol=1e-9)
