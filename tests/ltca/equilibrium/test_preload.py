"""Drives whose parts overlap as drawn: preload against closed forms and symmetry, no torque to speak of."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from refusals import error_says
from scipy.optimize import brentq

from ltca.analysis.loaded_analysis import analyse
from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.equilibrium.balance import solve_equilibrium
from ltca.equilibrium.reducer import Reducer
from ltca.errors import DriveError
from ltca.geometry.pairs import ContactGeometry
from ltca.laws.line_contact import LineContactLaw

NEXT_TO_NOTHING = -1.0
"""Moment on the wheel, N·mm, some 1e-6 of the rated one: 0.02 N at the flank."""


@pytest.fixture
def drive(paper_cases):
    """Races and holes that fit, an unmodified flank that touches every pin."""
    paper = paper_cases["CS-1"]
    return replace(paper, disc=replace(paper.disc, equidistant_offset=0.0, shifting_offset=0.0))


@pytest.mark.parametrize("overlap", [0.002, 0.02])
def test_oversize_rollers_are_pressed_alike(drive, overlap):
    """Each roller stands between concentric races: two line contacts in series share the overlap of the diameter."""
    loose = replace(drive, disc=replace(drive.disc, equidistant_offset=0.1))  # the flank has nothing to say
    radius = 5.0 + 0.5 * overlap
    large = replace(loose, crank_bearing=replace(drive.crank_bearing, roller_radius=radius))
    balanced = solve_equilibrium(
        Reducer(discs=(HalfSpaceCompliance.of_drive(large),)), np.array([0.3]), NEXT_TO_NOTHING
    )
    law = LineContactLaw(length=11.8, contact_modulus=206e3 / (2.0 * (1.0 - 0.3**2)))
    on_race, on_bore = 1.0 / (1.0 / radius + 1.0 / 19.5), 1.0 / (1.0 / radius - 1.0 / 29.5)

    def load(approach, effective):
        return float(law.load_and_stiffness(approach, effective)[0])

    inner = brentq(lambda part: load(part, on_race) - load(overlap - part, on_bore), 0.0, overlap, xtol=1e-15)
    # 0.02 N at the flank over eleven rollers, against some hundred newtons of preload and more
    np.testing.assert_allclose(balanced.response.rollers.outer_load[0], load(inner, on_race), rtol=2e-4)
    np.testing.assert_allclose(balanced.response.rollers.inner_load[0], load(inner, on_race), rtol=2e-4)


def test_oversize_pins_are_pressed_alike_where_nothing_moves(drive):
    """The flank is offset by the overlap everywhere, so every pin is in the same place against it: F(δ, ρ) of each."""
    tight = replace(drive, disc=replace(drive.disc, equidistant_offset=-0.01))
    model = HalfSpaceCompliance.of_drive(tight)
    response = Reducer(discs=(model,)).respond(np.array([0.4]), np.zeros((1, 4)))
    np.testing.assert_allclose(response.flank.approach, 0.01, rtol=0.0, atol=1e-12)  # round-off of places
    law = LineContactLaw(length=11.8, contact_modulus=206e3 / (2.0 * (1.0 - 0.3**2)))
    # 1/ρ = 1/r + κ/(1 − r₀ κ), κ of the path z = R e^{iθ} − e e^{iuθ}, r₀ = 6.49 mm that the flank is off it
    theta = ContactGeometry.of_drive(tight).nominal_parameter(np.array([0.4]))[0]
    first = 88j * np.exp(1j * theta) - 56j * np.exp(14j * theta)
    second = -88 * np.exp(1j * theta) + 784 * np.exp(14j * theta)
    curvature = (first.conjugate() * second).imag / np.abs(first) ** 3
    effective = 1.0 / (1.0 / 6.5 + curvature / (1.0 - 6.49 * curvature))
    np.testing.assert_allclose(response.pin_load[0], law.load_and_stiffness(0.01, effective)[0], rtol=1e-9)


@pytest.mark.parametrize(
    "change", [{"disc": -0.01}, {"rollers": 0.005}, {"holes": -0.01}, {"disc": -0.02, "holes": -0.01}]
)
def test_preload_without_torque_is_mirrored_at_the_crank(drive, change):
    """At φ_C = 0 the drive is its own mirror image: the disc moves along the crank alone, loads come in pairs."""
    part = replace(
        drive,
        disc=replace(drive.disc, equidistant_offset=change.get("disc", 0.0)),
        crank_bearing=replace(drive.crank_bearing, roller_radius=5.0 + 0.5 * change.get("rollers", 0.0)),
        pin_shaft=replace(drive.pin_shaft, hole_radius=14.075 + change.get("holes", 0.0)),
    )
    balanced = solve_equilibrium(Reducer(discs=(HalfSpaceCompliance.of_drive(part),)), np.zeros(1), NEXT_TO_NOTHING)
    for load in (balanced.response.pin_load, balanced.response.hole_load, balanced.response.rollers.outer_load):
        # 0.02 N turn the wheel one way
        np.testing.assert_allclose(load[0, 1:], load[0, :0:-1], rtol=0.0, atol=0.1)
    assert abs(balanced.pose[0, 1]) < 1e-6  # mm, against some µm along the crank
    # Pins in tight holes stand against the eccentricity: the disc gives way towards the crank axis.
    if change == {"holes": -0.01}:
        assert -0.01 < balanced.pose[0, 0] < -0.001


def test_what_is_pressed_too_wide_by_its_fit_is_told_so(paper_cases):
    """A quarter of a millimetre on pins of 1 mm: the torque was named, which has no part in it."""
    paper = paper_cases["CS-1"]
    wheel = replace(paper.pin_wheel, pin_radius=2.5)
    tight = replace(paper, pin_wheel=wheel, disc=replace(paper.disc, equidistant_offset=-0.24, shifting_offset=0.0))
    with error_says(DriveError, "disc.equidistant_offset = -0.24 mm: an overlap of 0.24 mm as drawn cannot be"):
        analyse(tight, np.array([0.1]))
