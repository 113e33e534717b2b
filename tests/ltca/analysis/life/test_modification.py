"""a_ISO of radial roller bearings by the published formula of ISO 281:2007, and where its pieces meet.

No published worked example of a cylindrical roller bearing with its numbers was at hand; the numbers below are reckoned
apart (bc, twenty digits) from the printed constants, and the two pieces at κ = 0.4, printed apart, meet.
"""

from __future__ import annotations

import pytest

from ltca.analysis.life.modification import life_modification_factor, reference_viscosity


@pytest.mark.parametrize(
    ("viscosity_ratio", "product", "factor"),
    [
        # κ = 1: 1.5859 − 1.2348 = 0.3511; 0.1^0.4 = 0.398107
        (1.0, 0.1, 0.3986486),
        # κ = 4: 1.5859 − 1.2348 · 4^−0.071739 = 0.467994; 0.2^0.4 = 0.525306
        (4.0, 0.2, 1.335045),
        # κ = 0.2: 1.5859 − 1.3993 · 0.2^−0.054381 = 0.058610; 0.5^0.4 = 0.757858
        (0.2, 0.5, 0.1517885),
        # κ = 0.7: 1.5859 − 1.2348 · 0.7^−0.19087 = 0.264109; 0.1^0.4 = 0.398107
        (0.7, 0.1, 0.2774253),
    ],
)
def test_by_hand(viscosity_ratio, product, factor):
    assert life_modification_factor(viscosity_ratio, 0.5, 2.0 * product) == pytest.approx(factor, rel=1e-6)
    assert life_modification_factor(viscosity_ratio, 1.0, product) == pytest.approx(factor, rel=1e-6)


def test_pieces_meet():
    """1.3993 · 0.4^−0.054381 = 1.2348 · 0.4^−0.19087, to the digits the standard prints; at 1 the pieces are one."""
    for edge, error in ((0.4, 2e-5), (1.0, 1e-6)):
        below, above = (life_modification_factor(edge + step, 0.8, 1.0) for step in (-1e-9, 1e-9))
        assert below == pytest.approx(above, rel=error)


def test_bounds():
    assert life_modification_factor(4.0, 1.0, 5.0) == 50.0
    assert life_modification_factor(4.0, 1.0, 1e6) == 50.0
    assert life_modification_factor(9.0, 0.3, 0.7) == life_modification_factor(4.0, 0.3, 0.7)
    # utterly dirty, or without end of load: a tenth
    assert life_modification_factor(4.0, 0.0, 1.0) == pytest.approx(0.1)
    assert life_modification_factor(0.0999, 0.5, 1.0) is None
    assert life_modification_factor(0.1, 0.5, 1.0) is not None


def test_reference_viscosity():
    """4500/√(n D) at 3000/min and 49 mm: 4500/383.4; 45000 n^−0.83/√D at 100/min: 45000/(45.709 · 7)."""
    assert reference_viscosity(3000.0, 49.0) == pytest.approx(11.737, abs=1e-3)
    assert reference_viscosity(100.0, 49.0) == pytest.approx(140.64, abs=0.01)
    # the two fits of the standard differ by 2 % where they meet
    assert reference_viscosity(999.999, 80.0) == pytest.approx(reference_viscosity(1000.0, 80.0), rel=0.03)
