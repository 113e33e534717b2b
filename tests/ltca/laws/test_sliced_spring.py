"""Springs in slices: what a rod on springs along its width does, by hand."""

from __future__ import annotations

import numpy as np
import pytest

from ltca.laws.sliced_spring import SlicedSpring


def test_pressed_all_along_it_is_a_spring_of_force_and_of_moment():
    law = SlicedSpring(stiffness=1e5, length=12.0, slices=5)
    found = law.respond(np.array([0.01]), np.array([1e-3]), np.array([5.0]))
    assert found.load[0] == pytest.approx(1e3, rel=1e-14)
    assert found.moment[0] == pytest.approx(1e5 * 12.0**2 / 12.0 * 1e-3, rel=1e-14)
    assert found.by_tilt[0] == pytest.approx(0.0, abs=1e-9)
    assert law.energy(found, 5.0)[0] == pytest.approx(0.5 * 1e5 * 0.01**2 + 0.5 * 1e5 * 12.0 * 1e-6, rel=1e-14)


def test_stiffnesses_of_a_batch_of_drives():
    one = SlicedSpring(stiffness=np.array([[1e5], [2e5]]), length=12.0, slices=5)
    found = one.respond(np.full((2, 3), 0.01), np.zeros((2, 3)), np.ones((2, 3)))
    np.testing.assert_allclose(found.load, [[1e3] * 3, [2e3] * 3])
    np.testing.assert_allclose(found.line_load[1], 2e3 / 12.0)
