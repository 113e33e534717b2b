"""What holds pins and cranks of full finite elements: closed forms of beams and flanges, and the LTCA on the same drives."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from plane_joint import compared, plane_joint

from fem.drive.supports import Supports
from fem.options import SolutionOptions
from fem.reducer.solution import solve_reducer
from ltca.commands.program import main
from ltca.drive.deviations import OneDisc, ProfileErrors
from ltca.errors import ConvergenceError
from ltca.reading.writing import drive_text

ANGLE = 0.5
LONG = {"pin_shaft.beam": {"tip": "tied-clamped", "span": 200.0, "diameter": 8.0}}
"""Slender shaft pins between two flanges, mm: shear is 1e-3 of their bending."""


def shaft_moved(drive, force):
    """Displacements of the shaft pins, mm, shape (discs, pins), by forces on them, N."""
    discs, cranks = drive.disc.number_of_discs, drive.crank.number
    _, moved, _ = Supports.of_drive(drive).moved(
        np.zeros((discs, drive.pin_wheel.number_of_pins), dtype=complex),
        force,
        np.zeros((discs, cranks), dtype=complex),
    )
    return moved


@pytest.mark.parametrize("table", ["springs", "beams", "posts", "cranks", "wheel"])
def test_flexibility_is_symmetric_and_stores_energy(table):
    changes = {
        "springs": {},
        "beams": {"pin_wheel.beam": {"ends": "clamped"}, **LONG},
        "posts": {"carrier.posts": {"number": 4, "radius": 30.0, "size": 8.0}, **LONG},
        "cranks": {
            "crank.support": {"diameter": 12.0, "positions": (-15.0, 15.0), "stiffness": (2e5, 3e5)},
            "carrier.posts": {"number": 4, "radius": 30.0, "size": 8.0},
            **LONG,
        },
        "wheel": {"pin_wheel.support_stiffness": 2e5},
    }[table]
    found = Supports.of_drive(plane_joint(**changes))
    for flexibility in (found.wheel, found.shaft):
        if flexibility is not None:
            np.testing.assert_allclose(flexibility, flexibility.T, atol=1e-14 * np.abs(flexibility).max())
            assert np.linalg.eigvalsh(flexibility).min() > -1e-12 * np.abs(flexibility).max()
    assert (found.wheel is None) == (table not in ("beams", "wheel"))


def test_springs_yield_alone():
    drive = plane_joint()
    force = np.zeros((2, drive.number_of_holes), dtype=complex)
    force[1, 3] = 30.0 - 40.0j
    np.testing.assert_allclose(shaft_moved(drive, force), force / drive.pin_shaft.stiffness, rtol=1e-13)


@pytest.mark.parametrize(("pressed", "carried"), [("one way", False), ("around", False), ("outward", True)])
def test_a_floating_flange_carries_what_does_not_move_it(pressed, carried):
    """Equal forces on all pins, one way or around, take the flange along: no slope at the tip, F a³(4L − 3a)/12EIL. Outward ones
    balance on it, and tips stand still: F a³(L − a)³/3EIL³. A disc is 8 mm thick on 200 mm.
    """
    drive = plane_joint(**LONG)
    pins = np.exp(2j * pi * np.arange(drive.number_of_holes) / drive.number_of_holes)
    direction = {"one way": np.exp(0.3j) * np.ones(pins.size), "around": 1j * pins, "outward": pins}[pressed]
    force = np.zeros((2, pins.size), dtype=complex)
    force[0] = direction
    span, at = 200.0, 100.0 + drive.disc.disc_planes[0]
    rigidity = drive.materials.shaft_pin.youngs_modulus * pi * 8.0**4 / 64.0
    if carried:
        expected = at**3 * (span - at) ** 3 / (3.0 * rigidity * span**3)
    else:
        expected = at**3 * (4.0 * span - 3.0 * at) / (12.0 * rigidity * span)
    np.testing.assert_allclose(shaft_moved(drive, force)[0], expected * direction, rtol=0.01)


def test_posts_hold_the_flange_by_themselves():
    """Rigid ones: tips stand still whatever presses; thin ones: as without."""
    force = np.zeros((2, plane_joint().number_of_holes), dtype=complex)
    force[:, 2] = 1.0 + 2.0j
    posts, rigid = {"number": 4, "radius": 30.0, "size": 8.0}, {"materials.carrier.youngs_modulus": 1e13}
    free, held, thin = (
        shaft_moved(plane_joint(**LONG, **more), force)
        for more in (
            {},
            {"carrier.posts": posts, **rigid},
            {"carrier.posts": posts | {"size": 0.1}},
        )
    )
    np.testing.assert_allclose(thin, free, rtol=1e-4, atol=1e-4 * np.abs(free).max())
    assert np.abs(held[:, [0, 4]]).max() < 0.01 * np.abs(free[:, [0, 4]]).max()
    assert np.abs(held[0, 2]) < np.abs(free[0, 2])


def test_the_bearing_of_the_wheel_moves_all_pins_alike():
    drive = plane_joint(**{"pin_wheel.support_stiffness": 2e5})
    pins = drive.pin_wheel.number_of_pins
    rng = np.random.default_rng(1)
    force = rng.normal(size=(2, pins)) + 1j * rng.normal(size=(2, pins))
    none = np.zeros((2, drive.number_of_holes), dtype=complex)
    moved, _, _ = Supports.of_drive(drive).moved(force, none, np.zeros((2, 1), dtype=complex))
    np.testing.assert_allclose(moved, force.sum() / 2e5, rtol=1e-12)


def test_a_crank_moves_on_its_bearings():
    """A rigid shaft on two springs, by levers."""
    support = {"diameter": 12.0, "positions": (-20.0, 20.0), "stiffness": (2e5, 3e5)}
    drive = plane_joint(**{"crank.support": support, "materials.crankshaft.youngs_modulus": 1e13})
    far = (np.array(drive.disc.disc_planes) + 20.0) / 40.0
    near = 1.0 - far
    force = np.array([[10.0 + 5.0j], [-3.0 + 1.0j]])
    pins = drive.number_of_holes
    _, _, moved = Supports.of_drive(drive).moved(
        np.zeros((2, drive.pin_wheel.number_of_pins), dtype=complex), np.zeros((2, pins), dtype=complex), force
    )
    ends = (near @ force[:, 0]) / 2e5, (far @ force[:, 0]) / 3e5
    np.testing.assert_allclose(moved[:, 0], near * ends[0] + far * ends[1], rtol=1e-6)


POSTS = {"carrier.posts": {"number": 4, "radius": 30.0, "size": 8.0}, "carrier.flange": (6.0, 6.0)}
CLAMPED = {"pin_shaft.beam": {"tip": "tied-clamped"}}


@pytest.mark.slow
@pytest.mark.nightly
@pytest.mark.parametrize(
    "more",
    [
        CLAMPED,
        {"pin_shaft.beam": {"tip": "free"}},
        {"pin_wheel.beam": {"ends": "clamped"}, **CLAMPED},
        POSTS | CLAMPED,
        {"pin_wheel.support_stiffness": 2e5, **CLAMPED},
        {
            "crank.support": {"diameter": 12.0, "positions": (-15.0, 15.0), "stiffness": (2e5, 3e5)},
            "installation.held": "pin-shaft",
        },
    ],
    ids=["tied", "free", "wheel pins", "posts", "main bearing", "crank"],
)
def test_the_ltca_with_the_same_supports_says_the_same(more):
    """0.5 % of the largest load of a kind, 0.5″, 0.002 of the shares: full finite elements took springs in the place of beams."""
    full, own, load, turned = compared(plane_joint(**more), ANGLE, 2.0)
    assert load < 5e-3
    assert turned < 0.5
    np.testing.assert_allclose(full.torque_share, own.torque_share[0], atol=2e-3)


@pytest.mark.slow
def test_beams_were_refused_by_full_finite_elements():
    """And springs in their place let the discs share the torque alike; coarse meshes are enough to see it. A carrier that twists
    turns the output alone, by T/k_T.
    """
    drive = plane_joint(**CLAMPED, **{"carrier.stiffness_torsion": 2e8})
    full = solve_reducer(drive, ANGLE, SolutionOptions(size=6.0))
    assert full.torque_share[0] == pytest.approx(0.606, abs=0.01)
    without = abs(drive.output_per_wheel_angle * full.wheel_angle)
    assert abs(full.transmission_error) - without == pytest.approx(drive.load.torque / 2e8, rel=1e-9)


DECK = {
    "ring": {"inner_radius": 60.5, "outer_radius": 72.5, "width": 30.0},
    "pin_wheel.beam": {"ends": "clamped"},
    "pin_shaft.beam": {"tip": "free"},
    "pin_wheel.support_stiffness": 2e5,
    "crank.support": {"diameter": 12.0, "positions": (-15.0, 15.0), "stiffness": (2e5, 3e5)},
}


@pytest.mark.parametrize("field", DECK)
def test_the_deck_for_calculix_refuses_what_it_does_not_hold(field, tmp_path, capsys):
    path = tmp_path / "joint.toml"
    path.write_text(drive_text(plane_joint(**{field: DECK[field]})), encoding="utf-8")
    assert main(["fem", str(path), "--angle", "0.5", "--export", "calculix", "--out", str(tmp_path / "out")]) == 2
    assert f"{field}: must be left out for --export calculix" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_a_disc_that_rests_anywhere_is_refused_with_its_number(paper_cases):
    """Its flank is 0.1 mm short all around, and the other one carries all of the torque."""
    relieved = OneDisc(profile_errors=ProfileErrors(orders=(0,), cosine=(-0.1,)))
    drive = paper_cases["CS-1"]
    drive = replace(drive, disc=replace(drive.disc, number_of_discs=2, of=(OneDisc(), relieved)))
    with pytest.raises(ConvergenceError, match="disc 1 carries less than"):
        solve_reducer(drive, ANGLE, SolutionOptions(size=6.0))
