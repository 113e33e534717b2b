"""The tabulated law: calculus of its methods, similarity, ends of the table, open contacts."""

from __future__ import annotations

import numpy as np
import pytest

from ltca.contact.pressure_cells import solve_cylinder_patch
from ltca.laws.line_contact import LONGEST, SHORTEST, LineContactLaw, line_contact_table

LAW = LineContactLaw(11.8, 113_187.0)
# inside the table, across its knots, and beyond both ends
APPROACHES = np.geomspace(1e-11, 2e4, 400)


def test_load_is_the_derivative_of_the_energy_everywhere():
    step = 1e-5 * APPROACHES
    slope = (LAW.energy(APPROACHES + step, 2.0) - LAW.energy(APPROACHES - step, 2.0)) / (2 * step)
    load, _ = LAW.load_and_stiffness(APPROACHES, 2.0)
    np.testing.assert_allclose(slope, load, rtol=1e-8)  # (step/δ)² of a smooth function


def test_stiffness_is_the_derivative_of_the_load_everywhere():
    step = 1e-5 * APPROACHES
    ahead, behind = (LAW.load_and_stiffness(APPROACHES + s, 2.0)[0] for s in (step, -step))
    _, stiffness = LAW.load_and_stiffness(APPROACHES, 2.0)
    # the third derivative may jump where the continuations begin, which costs one order there
    np.testing.assert_allclose((ahead - behind) / (2 * step), stiffness, rtol=1e-6)


def test_stiffness_is_continuous_where_the_table_ends():
    for slenderness in (SHORTEST, LONGEST):
        edge = LAW.length**2 / (2.0 * slenderness**2)
        _, stiffness = LAW.load_and_stiffness(edge * np.array([1 - 1e-9, 1 + 1e-9]), 2.0)
        assert stiffness[0] == pytest.approx(stiffness[1], rel=1e-7)


def test_load_grows_faster_than_the_approach_and_everything_is_positive():
    load, stiffness = LAW.load_and_stiffness(APPROACHES, 2.0)
    assert np.all(load > 0)
    assert np.all(stiffness * APPROACHES > load)
    for field in (LAW.mid_pressure(APPROACHES, 2.0), LAW.half_width(APPROACHES, 2.0)):
        assert np.all(np.diff(field) > 0)


def test_light_loads_follow_the_logarithmic_law():
    """For λ → ∞, π/f = v obeys v − ln v = 2 ln λ + constant: dv/d ln λ = 2/(1 − 1/v)."""
    slenderness = np.array([1e6, 1e8, 1e12, 1e20])
    approach = LAW.length**2 / (2.0 * slenderness**2)

    def inverse(factor):
        load, _ = LAW.load_and_stiffness(approach / factor**2, 2.0)
        return np.pi * LAW.contact_modulus * LAW.length * approach / factor**2 / load

    slope = (inverse(np.e) - inverse(1 / np.e)) / 2
    # what the length-wise redistribution of load changes falls like 1/v²: 0.15 % at v = 30, less further out
    np.testing.assert_allclose(slope, 2 / (1 - 1 / inverse(1.0)), rtol=1.5e-3)


def test_open_contacts_give_zeros_without_warnings():
    approach = np.array([-1.0, -1e-9, 0.0])
    for value in (
        *LAW.load_and_stiffness(approach, 2.0),
        LAW.energy(approach, 2.0),
        LAW.mid_pressure(approach, 2.0),
        LAW.half_width(approach, 2.0),
    ):
        assert np.array_equal(value, np.zeros(3))


def test_arguments_broadcast():
    load, stiffness = LAW.load_and_stiffness(np.full((3, 1), 1e-3), np.array([1.0, 2.0]))
    assert load.shape == stiffness.shape == (3, 2)
    assert LAW.energy(1e-3, 2.0).shape == ()
    assert LAW.load_and_stiffness(np.zeros((0, 4)), 2.0)[0].shape == (0, 4)


SLENDERNESS = [0.7, *(pytest.param(value, marks=pytest.mark.slow) for value in (12.0, 400.0)), 2e4]


@pytest.mark.slow
@pytest.mark.parametrize("slenderness", SLENDERNESS)
def test_different_dimensions_collapse_on_the_table(slenderness):
    """Full grid solutions with other lengths, radii and moduli, all at one λ."""
    for length, radius, modulus in ((11.8, 2.0, 113e3), (3.0, 40.0, 5.0), (250.0, 0.3, 1e7)):
        approach = length**2 / (radius * slenderness**2)
        law = LineContactLaw(length, modulus)
        solution = solve_cylinder_patch(length, radius, modulus, approach, cells=24)
        load, _ = law.load_and_stiffness(approach, radius)
        # grid of 24 cells: load within 5e-5, pressure and half-width within 5e-4 of the limit
        assert solution.load == pytest.approx(float(load), rel=1e-4)
        assert solution.energy == pytest.approx(float(law.energy(approach, radius)), rel=1e-4)
        assert solution.mid_pressure == pytest.approx(float(law.mid_pressure(approach, radius)), rel=1e-3)
        assert solution.half_width == pytest.approx(float(law.half_width(approach, radius)), rel=1e-3)


def test_table_is_built_once_in_a_process():
    assert LineContactLaw(1.0, 1.0).table is line_contact_table()


def test_contacts_of_several_lengths_and_moduli_together_carry_as_each_alone():
    """Also where some are open, and some are taken: by a mask, or by numbers."""
    others = [LAW, LineContactLaw(25.0, 56_000.0), LineContactLaw(3.0, 113_187.0)]
    together = LineContactLaw(
        *(np.array([getattr(law, name) for law in others]) for name in ("length", "contact_modulus"))
    )
    approach, radius = np.array([[1e-3, -1e-3, 2e-3], [0.0, 5e-4, 1e-4]]), np.array([1.0, 2.0, 30.0])
    expected = [np.stack(each, 1) for each in zip(*(
        law.load_and_stiffness(approach[:, place], radius[place]) for place, law in enumerate(others)
    ), strict=True)]  # fmt: skip
    np.testing.assert_allclose(together.load_and_stiffness(approach, radius), expected, rtol=1e-14)
    closed = approach > 0.0
    for some in (closed, np.nonzero(closed)):
        found = together.take(closed.shape, some).load_and_stiffness(approach[closed], np.tile(radius, (2, 1))[closed])
        np.testing.assert_allclose(found, [each[closed] for each in expected], rtol=1e-14)
