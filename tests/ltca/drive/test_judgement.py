"""Safety of a value against its limit."""

import pytest

from ltca.drive.members.judgement import Check, Value
from ltca.drive.members.limits import Limit


@pytest.mark.parametrize(
    ("sense", "limit", "value", "safety"),
    [
        ("max", 1500.0, 750.0, 2.0),
        ("min", 6000.0, 15_000.0, 2.5),
        ("min", 6000.0, 3000.0, 0.5),
        ("min", 0.0, 3.0, None),
    ],
)
def test_safety_is_above_one_where_the_limit_is_kept(sense, limit, value, safety):
    """Limit by value of an upper bound, value by limit of a lower one."""
    bound = Limit(quantity="bearing_life_hours", sense=sense, value=limit, source="ours")
    check = Check(value=Value(quantity="bearing_life_hours", value=value), limit=bound)
    assert check.safety == (safety if safety is None else pytest.approx(safety, rel=1e-15))
    assert (check.verdict == "pass") == (safety is None or safety >= 1.0)
