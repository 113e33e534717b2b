r"""Hertz line contact of two cylinders: half-width and peak pressure (Johnson, Contact Mechanics, 1985, 4.2(c)).

.. math:: b = \sqrt{\frac{4 P R}{\pi E^*}}, \qquad p_0 = \frac{2 P}{\pi b}

with P the load by length, 1/R the sum of the curvatures and 1/E* the sum of (1 − ν²)/E (Eqs. 4.43, 4.45).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ltca.arrays import FloatArray


def hertz_half_width(load_by_length: ArrayLike, radius: ArrayLike, modulus: ArrayLike) -> FloatArray:
    """Return the half-width of a line contact, mm.

    Parameters
    ----------
    load_by_length : float or array
        P ≥ 0, N/mm.
    radius : float or array
        Effective radius R > 0, mm.
    modulus : float or array
        E* > 0, MPa.

    Examples
    --------
    >>> round(float(hertz_half_width(100.0, 10.0, 113187.0)), 5)
    0.10606
    """
    product = 4.0 * np.asarray(load_by_length) * np.asarray(radius) / (np.pi * np.asarray(modulus))
    return np.asarray(np.sqrt(product), dtype=float)


def hertz_peak_pressure(load_by_length: ArrayLike, radius: ArrayLike, modulus: ArrayLike) -> FloatArray:
    """Return the peak pressure of a line contact, MPa; parameters as for `hertz_half_width`."""
    product = np.asarray(load_by_length) * np.asarray(modulus) / (np.pi * np.asarray(radius))
    return np.asarray(np.sqrt(product), dtype=float)
