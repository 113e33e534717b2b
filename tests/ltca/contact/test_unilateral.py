"""The complementarity solver against non-negative least squares and its own conditions."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import nnls

import ltca.contact.unilateral
from ltca.contact.unilateral import solve_unilateral_contact
from ltca.errors import ConvergenceError


def random_problem(size, seed):
    generator = np.random.default_rng(seed)
    root = generator.normal(size=(size, size))
    return root @ root.T + 0.05 * size * np.eye(size), generator.normal(size=size)


@pytest.mark.parametrize("seed", range(20))
def test_conditions_hold_and_the_solution_is_the_only_one(seed):
    matrix, right = random_problem(40, seed)
    solution = solve_unilateral_contact(matrix, right)
    opening = matrix @ solution.pressure - right
    assert np.all(solution.pressure >= 0.0)
    assert opening.min() > -1e-10  # round-off of a 40 × 40 system with entries of order 40
    assert abs(solution.pressure @ opening) < 1e-10
    factor = np.linalg.cholesky(matrix)
    reference, _ = nnls(factor.T, np.linalg.solve(factor, right))
    np.testing.assert_allclose(solution.pressure, reference, atol=1e-10)


@pytest.mark.parametrize("seed", range(5))
def test_the_answer_does_not_depend_on_the_start(seed):
    matrix, right = random_problem(30, seed)
    plain = solve_unilateral_contact(matrix, right).pressure
    for start in (np.zeros(30, dtype=bool), np.ones(30, dtype=bool)):
        np.testing.assert_allclose(solve_unilateral_contact(matrix, right, start=start).pressure, plain, atol=1e-12)


def test_strongly_coupled_problem_where_block_exchange_cycles_still_ends():
    # Nearly singular, long-range coupling: block exchange alone cycles on some of these.
    worst = 0
    for seed in range(200):
        generator = np.random.default_rng(seed)
        root = generator.normal(size=(12, 3))
        matrix = root @ root.T + 1e-3 * np.eye(12)
        right = generator.normal(size=12)
        solution = solve_unilateral_contact(matrix, right)
        opening = matrix @ solution.pressure - right
        assert opening.min() > -1e-8
        assert np.all(solution.pressure >= 0.0)
        worst = max(worst, len(solution.history))
    assert worst > 4  # the guard has been exercised


def test_rate_is_the_derivative_of_the_pressure():
    matrix, right = random_problem(30, 3)
    direction = np.ones(30)
    solution = solve_unilateral_contact(matrix, right, load_direction=direction)
    step = 1e-7
    ahead = solve_unilateral_contact(matrix, right + step * direction).pressure
    np.testing.assert_allclose((ahead - solution.pressure) / step, solution.rate, atol=1e-6)


def test_an_indefinite_matrix_is_reported():
    with pytest.raises(ConvergenceError, match="positive definite"):
        solve_unilateral_contact(-np.eye(3), np.ones(3))


def test_nothing_touches_when_nothing_overlaps():
    solution = solve_unilateral_contact(np.eye(3), -np.ones(3), load_direction=np.ones(3))
    assert not solution.active.any()
    assert not solution.pressure.any()
    assert not solution.rate.any()


def test_running_out_of_iterations_is_reported_with_the_history(monkeypatch):
    monkeypatch.setattr(ltca.contact.unilateral, "MAX_ITERATIONS", 1)
    matrix, right = random_problem(40, 1)
    with pytest.raises(ConvergenceError) as caught:
        solve_unilateral_contact(matrix, right)
    assert len(caught.value.history) == 1
