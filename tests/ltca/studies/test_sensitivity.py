"""Shares of fields in the scatter of results."""

import numpy as np

from ltca.studies.sensitivity import grouped


def test_shares_of_an_array_are_those_of_its_elements_together():
    """By quantity; what noise leaves below zero is cut after the sum."""
    shares = np.array([[0.1, 0.3, 0.2], [0.2, -0.1, 0.1], [-0.2, 0.05, 0.0]])
    found = grouped(shares, [("disc.pin_errors", slice(0, 2)), ("load.torque", slice(2, 3))])
    np.testing.assert_allclose(found, [[0.3, 0.2, 0.3], [0.0, 0.05, 0.0]], atol=1e-15)
