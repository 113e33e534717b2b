"""The active set against enumeration of all sets, and its failure."""

from itertools import product

import numpy as np
import pytest

from fem.contact import unilateral
from fem.contact.unilateral import ContactProblem, find_active_set, solve_floating_contact
from ltca.errors import ConvergenceError


def random_problem(seed, count=7):
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(count, count))
    motions = np.column_stack([-np.abs(rng.normal(size=count)) - 0.1, rng.normal(size=count)])
    # A pushed body: some pressure must balance the load on the first motion and nothing loads the second.
    feasible = np.abs(rng.normal(size=count))
    return ContactProblem(
        compliance=root @ root.T + 0.1 * np.eye(count),
        gap=rng.normal(size=count),
        motions=motions,
        external=motions.T @ feasible,
    )


def enumerate_sets(problem):
    """Return the pressure of the only active set that satisfies every condition."""
    count, rigid = problem.motions.shape
    for choice in product([False, True], repeat=count):
        active = np.array(choice)
        size = int(active.sum())
        if size < rigid:
            continue
        matrix = np.zeros((size + rigid, size + rigid))
        matrix[:size, :size] = problem.compliance[np.ix_(active, active)]
        matrix[:size, size:], matrix[size:, :size] = problem.motions[active], problem.motions[active].T
        right = np.concatenate([-problem.gap[active], problem.external])
        found = np.linalg.solve(matrix, right)
        pressure = np.zeros(count)
        pressure[active] = found[:size]
        opening = problem.compliance @ pressure + problem.gap + problem.motions @ found[size:]
        if np.all(pressure >= -1e-12) and np.all(opening[~active] >= -1e-12):
            return pressure, found[size:]
    raise AssertionError("no set fits")


@pytest.mark.parametrize("seed", range(12))
def test_matches_enumeration(seed):
    problem = random_problem(seed)
    solution = solve_floating_contact(problem, np.ones(7, dtype=bool))
    pressure, motion = enumerate_sets(problem)
    np.testing.assert_allclose(solution.pressure, pressure, atol=1e-9)
    np.testing.assert_allclose(solution.motion, motion, atol=1e-9)
    assert solution.residual < 1e-12
    assert np.all(solution.pressure * solution.opening == 0.0)


def test_start_does_not_matter():
    problem = random_problem(3)
    answers = [solve_floating_contact(problem, start).pressure for start in np.tril(np.ones((7, 7), dtype=bool))[2:]]
    for answer in answers[1:]:
        np.testing.assert_allclose(answer, answers[0], atol=1e-10)


def test_empty_start_is_a_start():
    problem = random_problem(4)
    solution = solve_floating_contact(problem, np.zeros(7, dtype=bool))
    np.testing.assert_allclose(solution.pressure, enumerate_sets(problem)[0], atol=1e-9)


@pytest.mark.parametrize("seed", range(6))
def test_interior_point_finds_the_set(seed):
    problem = random_problem(seed)
    np.testing.assert_array_equal(find_active_set(problem), enumerate_sets(problem)[0] > 1e-9)


def test_load_no_pressure_can_balance_is_an_error():
    """Contact can only push: a load that would need a pull has no answer."""
    problem = ContactProblem(compliance=np.eye(2), gap=np.ones(2), motions=np.ones((2, 1)), external=np.array([-1.0]))
    with pytest.raises(ConvergenceError, match="balance the load"):
        solve_floating_contact(problem, np.array([True, False]))


def test_limit_gives_history():
    with pytest.raises(ConvergenceError) as caught:
        solve_floating_contact(random_problem(1), np.ones(7, dtype=bool), limit=1)
    assert len(caught.value.history) == 1


@pytest.mark.parametrize("seed", range(6))
def test_unknowns_exchanged_one_by_one_find_the_set(seed, monkeypatch):
    """Murty's rule, which takes over where whole sets would flip for ever: from any start, here from all in contact."""
    monkeypatch.setattr(unilateral, "MAX_PLAIN_STEPS", 0)
    monkeypatch.setattr(unilateral, "find_active_set", lambda problem: np.ones(7, dtype=bool))
    problem = random_problem(seed)
    found = solve_floating_contact(problem, np.zeros(7, dtype=bool), limit=400)
    np.testing.assert_allclose(found.pressure, enumerate_sets(problem)[0], atol=1e-9)
