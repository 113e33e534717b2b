"""Steps of parts between contacts: where a slice begins to carry within a step, and what turns freely."""

import numpy as np
import pytest

from ltca.laws.between_contacts import MAX_TRIALS, PartStiffness, newton_step, shorten_steps


def test_steps_end_where_a_slice_begins_to_carry():
    """A soft slope of the energy and, from a tenth or a thousandth of the step on, one a billion times as stiff."""
    soft, stiff, place = 1.0, 1e9, np.array([0.1, 1e-3, 2.0])
    trials = []

    def move(some, fraction):
        trials.append(some.size)
        beyond = np.maximum(fraction - place[some], 0.0)
        return soft * (fraction - 1.0) + stiff * beyond, soft + stiff * (beyond > 0.0)

    found = shorten_steps(np.full(3, -soft), move)
    # The least of the energy lies where the stiff part takes the slope off: a billionth beyond the place.
    assert found == pytest.approx([0.1, 1e-3, 1.0], rel=1e-5)
    assert len(trials) <= 3 < MAX_TRIALS


def test_what_touches_at_one_end_alone_is_not_sent_far():
    """Both contacts at the same end: turning about it costs nothing, and what is left over there is round-off."""
    half, stiff = 5.0, 1e5
    free = PartStiffness(*(np.array([value]) for value in (stiff, stiff * half, stiff * half**2)), half)
    step, turn, slope = newton_step(np.array([1e-3]), np.array([1e-3 * half + 1e-8]), free)
    # Along the stiff mode a thousandth of a newton is 1e-8 mm; the free one is held by a millionth of that stiffness.
    assert abs(step[0] + half * turn[0]) == pytest.approx(1e-8, rel=1e-2)
    assert half * abs(turn[0]) < 1e-7
    assert slope[0] < 0.0
