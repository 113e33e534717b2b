"""Newton's step of stiff positions is that of their modes; soft ones are told from them."""

from __future__ import annotations

import numpy as np
import pytest

from ltca.equilibrium.newton import _damped_step, _stiff_step


def tangents(random, count, size, values):
    modes = np.linalg.qr(random.normal(size=(count, size, size)))[0]
    return np.einsum("bij,bj,bkj->bik", modes, values, modes), modes


@pytest.mark.parametrize("size", [4, 7, 22])
def test_the_step_solves_the_damped_system(size):
    random = np.random.default_rng(size)
    values = 10.0 ** random.uniform(1.0, 5.0, (50, size))
    matrix, _ = tangents(random, 50, size, values)
    gradient, floor = random.normal(size=(50, size)), 10.0 ** random.uniform(-3.0, 3.0, 50)
    step, stiff = _stiff_step(matrix, gradient, floor)
    assert stiff.all()
    left = np.einsum("bij,bj->bi", matrix + floor[:, None, None] * np.eye(size), step) + gradient
    # round-off times a condition of 1e4, well below 1e-9
    np.testing.assert_allclose(left, 0.0, atol=1e-9)


@pytest.mark.parametrize("least", [0.0, 1e-9, -1.0, -1e5])
def test_modes_that_do_not_resist_are_no_stiff_position(least):
    random = np.random.default_rng(1)
    values = np.concatenate([np.full((20, 1), least), 10.0 ** random.uniform(3.0, 5.0, (20, 5))], axis=1)
    matrix, _ = tangents(random, 20, 6, values)
    _, stiff = _stiff_step(matrix, random.normal(size=(20, 6)), np.full(20, 1e-6))
    assert not stiff.any()


def test_a_step_is_bounded_mode_by_mode_and_goes_downhill():
    random = np.random.default_rng(2)
    values = random.uniform(-1.0, 1.0, (200, 5)) * 10.0 ** random.uniform(-2.0, 5.0, (200, 5))
    values[:50] = np.abs(values[:50])
    matrix, modes = tangents(random, 200, 5, values)
    gradient = 10.0 ** random.uniform(-6.0, 3.0, (200, 1)) * random.normal(size=(200, 5))
    damping, bound = np.full(200, 1e-9), np.full(200, 1e-3)
    step, slope = _damped_step(matrix, gradient, damping, bound)
    along = np.einsum("bji,bj->bi", modes, gradient)
    stiffness = np.abs(values) + (damping * np.abs(values.sum(axis=1)) / 5.0)[:, None]
    expected = np.einsum("bij,bj->bi", modes, np.clip(-along / stiffness, -1e-3, 1e-3))
    # of modes that differ by 1e7 in stiffness the soft ones keep some nine digits
    np.testing.assert_allclose(step, expected, rtol=1e-6, atol=1e-9 * np.max(np.abs(expected), axis=1).max())
    assert np.all(slope < 0.0)
    np.testing.assert_allclose(slope, np.einsum("bi,bi->b", gradient, step), rtol=1e-12)
