"""Cranks that twist between the splined planet and their eccentrics: GJ/L, work, the independent check, limits."""

from __future__ import annotations

import numpy as np
import pytest

from ltca.analysis.engines import HalfSpace
from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.results import build_dataset
from ltca.beam import torsion_flexibility
from ltca.compliance.response import bearing_pushes
from ltca.equilibrium.output_torque import solve_at_output
from ltca.geometry.coordinates import WHEEL_ANGLE
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import parse_drive, shipped_drive
from ltca.testing.balance_check import find_imbalance

ANGLES = np.array([0.31, 1.7, 4.4])
RIGIDITY = 206e3 / 2.6 * np.pi * 20.0**4 / 32.0
"""GJ of the shafts of the shipped reducer, ⌀ 20 mm of steel, N·mm²."""


@pytest.fixture(scope="module")
def rv():
    return parse_drive(shipped_drive("rv"), "rv").cases["nominal"]


def twisting(drive, place=40.0, **more):
    return with_fields(drive, {"crank.support.torsion": True, "crank.support.spline_plane": place, **more})


def balanced(drive, angles=ANGLES):
    model = HalfSpace().prepare(drive).model
    return model, solve_at_output(model, [drive], angles, drive.load.torque)


@pytest.mark.parametrize("place", [40.0, -35.0, 0.0])
def test_a_shaft_twists_by_its_moments(rv, place):
    """θ_k = Σ M_j L_jk/GJ with the moments of the bearings' forces about the crank axes, L common to both from the spline on."""
    drive = twisting(rv, place)
    model, found = balanced(drive)
    coordinates, moments, twists = model.coordinates, [], []
    for number, (disc, part) in enumerate(zip(model.discs, found.response.parts, strict=True)):
        own = found.pose[:, coordinates.columns(number)]
        twist = own[:, coordinates.twist_places]
        lever = disc.geometry.placement.races(ANGLES).centre - disc.geometry.placement.crank_axes
        # what the disc does to its eccentric
        moments.append(-((lever * np.exp(1j * twist)).conjugate() * bearing_pushes(part.rollers, 3)).imag)
        twists.append(twist)
    planes = rv.disc.disc_planes
    for one in (0, 1):
        expected = 0.0
        for other in (0, 1):
            if (planes[one] - place) * (planes[other] - place) > 0.0:
                common = min(abs(planes[one] - place), abs(planes[other] - place))
                expected = expected + common / RIGIDITY * moments[other]
        # forces balance to 1e-9 of a load whose twists are 1e-4 rad
        np.testing.assert_allclose(twists[one], expected, rtol=1e-6, atol=1e-10)
    assert np.abs(twists).max() > 1e-5


def test_flexibility_in_closed_form():
    """Two planes beyond each other, one on the other side: L/GJ each, the nearer of the two in common, nothing across."""
    found = torsion_flexibility([10.0, 25.0, -8.0], 0.0, 20.0, 206e3 / 2.6) * RIGIDITY
    np.testing.assert_allclose(found, [[10.0, 10.0, 0.0], [10.0, 25.0, 0.0], [0.0, 0.0, 8.0]], rtol=1e-12)


def test_a_stiff_shaft_is_rigid(rv):
    """What torsion adds to the wheel's angle falls with its flexibility, in first order; bending is left as it is."""
    plain = balanced(rv)[1].pose[:, WHEEL_ANGLE]

    def added(poisson):
        # ν moves the shear modulus alone: a shaft without shear bends by E
        drive = twisting(rv, **{"materials.crankshaft.poisson_ratio": poisson})
        return balanced(drive)[1].pose[:, WHEEL_ANGLE] - plain

    # GJ ∝ 1/(1 + ν); contacts are nearly linear over a twist of 1e-4 rad
    np.testing.assert_allclose(added(0.45) / added(0.0), 1.45, rtol=0.01)


@pytest.mark.parametrize(
    "words",
    [
        {},
        pytest.param(
            {"crank.support.clearance": 0.01, "friction.roller": 0.02, "friction.pin": 0.04}, marks=pytest.mark.slow
        ),
    ],
    ids=["plain", "loose and rubbing"],
)
def test_the_potential_is_least(rv, words):
    drive = twisting(rv, -30.0, **words)
    model, found = balanced(drive)
    assert find_imbalance(drive, model, found, 1, torque=drive.load.torque) == []


@pytest.mark.family(quick=1)
@pytest.mark.parametrize("words", [{}, {"installation.held": "pin-shaft"}], ids=["housing held", "carrier held"])
def test_virtual_work_at_every_position(rv, words, unbalanced_work):
    np.testing.assert_allclose(unbalanced_work(twisting(rv, **words), ANGLES + 0.05), 0.0, atol=1e-7)


def test_tangent_is_the_slope_of_the_force(rv, tangent_and_slope):
    scaled, slope = tangent_and_slope(twisting(rv), ANGLES[:1])
    # differences of second order over 1e-7 mm: round-off of loads of 1e4 N by the step, and contacts that just open
    np.testing.assert_allclose(slope, scaled, rtol=0.0, atol=2e-6 * np.abs(scaled).max())


@pytest.mark.slow
def test_twists_are_told(rv):
    found = analyse(twisting(rv), ANGLES)
    twist = build_dataset("rv", {"nominal": found})["crank_twist"]
    assert (twist.dims, twist.attrs["units"]) == (("case", "disc", "crank", "position"), "rad")
    assert twist.shape == (1, 2, 3, 3)
    assert float(np.abs(twist).max()) > 1e-5
    assert "crank_twist" not in build_dataset("rv", {"nominal": analyse(rv, ANGLES)})
    np.testing.assert_allclose(sum(found.compliance_shares.values()), 1.0, rtol=1e-12)
