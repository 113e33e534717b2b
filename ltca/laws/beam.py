r"""A round shaft as a beam on two elastic supports: how far it yields at some planes under forces at these planes.

Bending alone (Euler–Bernoulli; shear and torsion are left out). The deflection at z under a unit force at s on a beam whose
supports at 0 and L stand still is the fundamental solution :math:`|z-s|^3/12EI`, the same of the two reactions, and the
rigid motion that brings the supports back to zero; elastic supports add their yielding along the straight line between them.
Overhanging ends are in it.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


def shaft_flexibility(
    planes: Sequence[float],
    supports: tuple[float, float],
    stiffness: tuple[float, float],
    diameter: float,
    youngs_modulus: float,
) -> FloatArray:
    """Return deflections of a shaft at its planes by unit forces at these planes, mm/N.

    Parameters
    ----------
    planes : sequence of float
        Axial places of the forces, mm.
    supports : tuple of float
        Axial places of the two supports, mm.
    stiffness : tuple of float
        Of each support, N/mm.
    diameter : float
        mm.
    youngs_modulus : float
        MPa.

    Returns
    -------
    array, shape (planes, planes)
        Symmetric.

    Examples
    --------
    Mid-span of a beam on rigid supports yields by L³/48EI:

    >>> rigid = shaft_flexibility([0.0], (-10.0, 10.0), (1e30, 1e30), 10.0, 2e5)
    >>> bool(np.isclose(rigid[0, 0], 20.0**3 / (48.0 * 2e5 * pi * 10.0**4 / 64.0)))
    True
    """
    start, span = supports[0], supports[1] - supports[0]
    place = np.asarray(planes, dtype=float) - start
    far = place / span
    # Parts of a force that each support carries.
    parts = np.stack((1.0 - far, far))
    ends = np.array([0.0, span])

    def cubes(at: FloatArray) -> FloatArray:
        """|z − s|³ less those of the reactions, by z and s."""
        reactions = np.abs(at[:, None] - ends) ** 3 @ parts
        return np.asarray(np.abs(at[:, None] - place) ** 3 - reactions)

    bent = cubes(place) - np.einsum("ez,es->zs", parts, cubes(ends))
    bent /= 12.0 * youngs_modulus * pi * diameter**4 / 64.0
    yielding = np.einsum("ez,es,e->zs", parts, parts, 1.0 / np.asarray(stiffness, dtype=float))
    return np.asarray(0.5 * (bent + bent.T) + yielding)
