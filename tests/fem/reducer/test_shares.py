"""Sharing of a moment between discs that are springs made by hand; no finite elements here."""

from __future__ import annotations

import numpy as np
import pytest
from refusals import error_says

from fem.reducer.shares import MOMENT_TOLERANCE, SharedAnswer, share_moment
from ltca.errors import ConvergenceError

PLAY = np.array([-4e-4, -3.5e-4, -5e-4])
SOFTNESS = np.array([4e-9, 5e-9, 3e-9])
TOTAL = -3e5


def springs(moment):
    """θ_k = play_k + c_k M_k."""
    return SharedAnswer(wheel_angle=PLAY + SOFTNESS * moment, left_over=float(moment.sum()) - TOTAL)


def parallel():
    """The closed form of springs in parallel: one angle, moments that sum up."""
    angle = (TOTAL + np.sum(PLAY / SOFTNESS)) / np.sum(1.0 / SOFTNESS)
    return (angle - PLAY) / SOFTNESS


def test_springs_in_parallel_by_wrong_slopes():
    """Slopes twice and half of what they are: the first step tells them, the second is exact."""
    found = share_moment(springs, np.full(3, TOTAL / 3.0), SOFTNESS * np.array([2.0, 0.5, 1.0]))
    np.testing.assert_allclose(found.moment, parallel(), rtol=1e-9)
    np.testing.assert_allclose(found.slope, SOFTNESS, rtol=1e-6)
    assert len(found.spread) == 3
    assert found.spread[-1] < 1e-15 < found.spread[0]


def test_contacts_stiffen_and_are_followed():
    def stiffening(moment):
        return SharedAnswer(
            wheel_angle=PLAY + SOFTNESS * np.sign(moment) * np.abs(moment) ** 0.9 * 1e5**0.1,
            left_over=float(moment.sum()) - TOTAL,
        )

    found = share_moment(stiffening, np.full(3, TOTAL / 3.0), SOFTNESS)
    answer = stiffening(found.moment)
    assert np.ptp(answer.wheel_angle) <= 1e-9
    assert found.moment.sum() == pytest.approx(TOTAL, rel=1e-12)


def test_a_moment_that_follows_the_crank():
    """A crank that takes 1/14 of the wheel's moment and 30 N·mm: what is left grows by 13/14 of the sum."""

    def held(moment):
        return SharedAnswer(
            wheel_angle=springs(moment).wheel_angle, left_over=float(moment.sum()) * 13.0 / 14.0 - TOTAL + 30.0
        )

    found = share_moment(held, np.full(3, TOTAL / 3.0), SOFTNESS, rise=13.0 / 14.0)
    assert found.moment.sum() == pytest.approx((TOTAL - 30.0) * 14.0 / 13.0, rel=1e-12)
    assert abs(found.left_over[-1]) <= MOMENT_TOLERANCE * abs(TOTAL)


def test_others_make_up_for_a_disc_that_a_step_would_let_go():
    """A slope a third of the true one sends disc 2 past zero; the moments of every trial add up to that of the wheel."""
    play, tried = np.array([-4e-4, -3.5e-4, -9e-4]), []

    def early(moment):
        tried.append(moment.copy())
        return SharedAnswer(wheel_angle=play + SOFTNESS * moment, left_over=float(moment.sum()) - TOTAL)

    found = share_moment(early, np.full(3, TOTAL / 3.0), SOFTNESS * np.array([1.0, 1.0, 0.3]))
    np.testing.assert_allclose(np.sum(tried, axis=1), TOTAL, rtol=1e-12)
    assert abs(tried[1][2]) < 2e-3 * abs(TOTAL)  # let go, but for a thousandth of the mean share
    angle = (TOTAL + np.sum(play / SOFTNESS)) / np.sum(1.0 / SOFTNESS)
    np.testing.assert_allclose(found.moment, (angle - play) / SOFTNESS, rtol=1e-9)


def test_a_disc_that_carries_nothing_is_named():
    def one_idle(moment):
        return SharedAnswer(
            wheel_angle=np.array([-4e-4, -4e-4, -9e-3]) + SOFTNESS * moment, left_over=float(moment.sum()) - TOTAL
        )

    with error_says(ConvergenceError, starts="disc 2 carries less than 0.001 of the mean share"):
        share_moment(one_idle, np.full(3, TOTAL / 3.0), SOFTNESS)


def test_angles_that_never_agree_are_an_error_with_their_differences():
    calls = []

    def jumping(moment):
        calls.append(1)
        return SharedAnswer(wheel_angle=1e-6 * (-1.0) ** len(calls) * np.array([1.0, 0.0]), left_over=0.0)

    with pytest.raises(ConvergenceError, match="do not agree after 4 rounds") as caught:
        share_moment(jumping, np.full(2, TOTAL / 2.0), SOFTNESS[:2], rounds=4)
    assert list(caught.value.history) == pytest.approx([1e-6] * 4)
