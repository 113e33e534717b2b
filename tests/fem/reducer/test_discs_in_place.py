"""A disc at a phase of its own: flank, rollers and eccentric where the LTCA has them; what one solution cannot say is refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from refusals import refused_field

from fem.coefficients.dataset import derive_coefficients
from fem.drive.expected_contacts import expect_contacts
from fem.drive.rigid_bodies import RigidBodies
from fem.drive.solution import solve_drive
from ltca.drive.deviations import OneDisc, Runout
from ltca.drive.single_discs import single_discs
from ltca.geometry.pairs import ContactGeometry
from ltca.reading.changes import with_fields

POSE = np.array([[0.012, -0.02, 3e-4, -1.9e-3]])


@pytest.fixture(scope="module")
def three(paper_cases):
    """Three discs on the paper's wheel, flanks cut at phases of their own, the second with a runout."""
    drive = paper_cases["CS-3"]
    of = (OneDisc(), OneDisc(runout=Runout(amount=0.01, angle=0.4)), OneDisc())
    return replace(drive, disc=replace(drive.disc, number_of_discs=3, of=of))


@pytest.mark.parametrize("disc", [0, 1, 2])
def test_gaps_are_those_of_the_pairs(three, disc):
    """Finite elements start from the same rigid bodies as the LTCA: gap = −approach, at any pose and phase."""
    single, angle = single_discs(three)[disc], np.array([1.3])
    x, y, rotation, wheel = POSE[0].tolist()
    gaps = RigidBodies.of_drive(single, 1.3).gaps(complex(x, y), rotation, wheel)
    geometry = ContactGeometry.of_drive(single)
    flank = geometry.flank(angle, POSE)
    np.testing.assert_allclose(gaps.pins, -flank.approach[0], rtol=0.0, atol=1e-11)
    np.testing.assert_allclose(gaps.holes, -geometry.holes(angle, POSE).approach[0], rtol=0.0, atol=1e-12)
    rays = geometry.rollers(angle)
    reach = rays.touching(rays.direction.conjugate() * np.array([complex(x, y)]))
    np.testing.assert_allclose(gaps.rollers, (reach - rays.outermost)[0], rtol=0.0, atol=1e-12)


def test_one_solution_is_of_one_disc(three):
    with refused_field("disc.number_of_discs", "= 3", bound=("equal to", 1)):
        solve_drive(three, 0.5)
    with refused_field("disc.number_of_discs", "= 3", bound=("equal to", 1)):
        expect_contacts(three, 0.5)
    with refused_field("disc.number_of_discs", "= 3", bound=("equal to", 1)):
        derive_coefficients(three)


def test_the_moment_of_a_held_wheel_is_not_known_before(paper_cases):
    held = with_fields(paper_cases["CS-1"], {"installation.held": "pin-wheel"})
    with refused_field("installation.held", "= pin-wheel", "must be pin-shaft"):
        solve_drive(held, 0.5)
