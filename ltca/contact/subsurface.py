"""Stresses in a half-space below a contact patch: uniformly pressed rectangles summed (Love 1929; Johnson, Eq. 3.10).

With V = ∫∫ 1/r and χ = ∫∫ ln(z + r): σx = (2ν V_z − (1−2ν) χ_xx − z V_xx)/2π, σy alike, σz = (V_z − z V_zz)/2π, τxy = −((1−2ν)
χ_xy + z V_xy)/2π, τxz = −z V_xz/2π, τyz = −z V_yz/2π, in corner functions of order one: nothing cancels.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ltca.arrays import FloatArray
from ltca.contact.pressure_cells import PatchPressure

_DEPTHS = 48


def rectangle_stress(
    x: ArrayLike,
    y: ArrayLike,
    depth: ArrayLike,
    half_length_x: ArrayLike,
    half_length_y: ArrayLike,
    poisson_ratio: float,
) -> FloatArray:
    """Return σx, σy, σz, τxy, τxz, τyz below a rectangle about the origin by unit pressure, compression negative, (…, 6)."""
    x, y, z, a, b = np.broadcast_arrays(
        *(np.asarray(value, dtype=float) for value in (x, y, depth, half_length_x, half_length_y))
    )
    total = np.zeros((*x.shape, 6))
    slack = 1.0 - 2.0 * poisson_ratio
    for sign, across, along in ((1.0, x + a, y + b), (-1.0, x + a, y - b), (-1.0, x - a, y + b), (1.0, x - a, y - b)):
        r = np.sqrt(across**2 + along**2 + z**2)
        square_x, square_y = across**2 + z**2, along**2 + z**2
        product = across * along
        v_z = -np.arctan2(product, z * r)
        v_xx, v_yy = -product / (r * square_x), -product / (r * square_y)
        chi_xx = np.arctan2(product * (r - z), across**2 * r + z * along**2)
        chi_yy = np.arctan2(product * (r - z), along**2 * r + z * across**2)
        total[..., 0] += sign * (2.0 * poisson_ratio * v_z - slack * chi_xx - z * v_xx)
        total[..., 1] += sign * (2.0 * poisson_ratio * v_z - slack * chi_yy - z * v_yy)
        total[..., 2] += sign * (v_z + z * (v_xx + v_yy))
        total[..., 3] -= sign * (slack * np.log(z + r) + z / r)
        total[..., 4] += sign * z * z * along / (r * square_x)
        total[..., 5] += sign * z * z * across / (r * square_y)
    return np.asarray(total / (2.0 * np.pi))


def patch_stress(
    solution: PatchPressure, x: ArrayLike, y: ArrayLike, depth: ArrayLike, poisson_ratio: float
) -> FloatArray:
    """Return the stresses at points, mm, below a solved patch in a body of this ν, as `rectangle_stress`, MPa."""
    x, y, z = np.broadcast_arrays(*(np.asarray(value, dtype=float) for value in (x, y, depth)))
    grid = solution.grid
    inside = solution.contact
    i, j = np.nonzero(inside)
    pressure = solution.pressure[inside]
    half_x, half_y = 0.5 * np.diff(grid.x_edges)[i], 0.5 * np.diff(grid.y_edges)[j]
    total = np.zeros((*x.shape, 6))
    for sign_x in (1.0, -1.0) if grid.symmetric_x else (1.0,):
        for sign_y in (1.0, -1.0) if grid.symmetric_y else (1.0,):
            unit = rectangle_stress(
                x[..., None] - sign_x * grid.x_centres[i],
                y[..., None] - sign_y * grid.y_centres[j],
                z[..., None],
                half_x,
                half_y,
                poisson_ratio,
            )
            total += np.einsum("...kc,k->...c", unit, pressure)
    return total


def max_shear_stress(stress: FloatArray) -> FloatArray:
    """Return half the difference of the largest and smallest principal stress; components on the last axis as above."""
    tensor = np.empty((*stress.shape[:-1], 3, 3))
    for component, (i, j) in enumerate(((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))):
        tensor[..., i, j] = tensor[..., j, i] = stress[..., component]
    principal = np.linalg.eigvalsh(tensor)
    return np.asarray(0.5 * (principal[..., 2] - principal[..., 0]))


class SubsurfaceShear(NamedTuple):
    """Largest shear stress below mid-width, MPa, under the peak of the pressure, and its depth, mm."""

    max_shear: float
    depth: float


def find_subsurface_shear(solution: PatchPressure, poisson_ratio: float) -> SubsurfaceShear:
    """Return the largest shear stress on the normal through the pressure peak at mid-width; ValueError where nothing touches."""
    half_width = solution.half_width
    if half_width <= 0.0:
        raise ValueError("no contact at mid-width: there is no subsurface shear to find")
    x, pressure = solution.mid_profile
    place = 0.0 if solution.grid.symmetric_x else float(x[np.argmax(pressure)])
    depths = half_width * np.geomspace(0.2, 2.5, _DEPTHS)
    shear = max_shear_stress(patch_stress(solution, place, 0.0, depths, poisson_ratio))
    top = int(np.clip(np.argmax(shear), 1, _DEPTHS - 2))
    bend, slope, crest = np.polyfit(np.log(depths[top - 1 : top + 2] / depths[top]), shear[top - 1 : top + 2], 2)
    offset = float(np.clip(-0.5 * slope / bend, -0.1, 0.1))
    return SubsurfaceShear(float(crest + 0.5 * slope * offset), float(depths[top] * np.exp(offset)))


LINE_SHEAR = 0.3002831
"""Largest shear stress below a Hertz line contact, in its peak pressure: the maximum of ζ (1 − ζ/√(1 + ζ²))."""
LINE_SHEAR_DEPTH = 0.7861514
"""Depth ζ of that stress in half-widths, √((√5 − 1)/2): the positive root of ζ⁴ + ζ² = 1."""


def line_contact_shear(peak_pressure: ArrayLike, wall_stress: ArrayLike) -> FloatArray:
    """Return the largest shear stress below a line contact of peak pressure p0 in a body with a stress along its wall, MPa.

    Half of σx − σz = 2 p0 ζ (1 − ζ/√(1 + ζ²)) in plane strain (Johnson, Eq. 4.45 and 4.46), and half of the wall's.

    >>> float(line_contact_shear(1000.0, -20.0).round(2))
    290.28
    """
    pressure = np.asarray(peak_pressure, dtype=float)
    return np.where(pressure > 0.0, LINE_SHEAR * pressure + 0.5 * np.asarray(wall_stress, dtype=float), 0.0)


def line_contact_shear_at(peak_pressure: ArrayLike, half_width: ArrayLike, depth: ArrayLike) -> FloatArray:
    """Return the largest shear stress at and below a depth, mm, under a line contact, MPa (Johnson, Eq. 4.46 and 4.47).

    p0 (ζ − ζ²/√(1 + ζ²)), ζ = depth/half-width, grows to `LINE_SHEAR` p0 and falls below.

    >>> line_contact_shear_at(1000.0, 0.2, [0.05, 0.6]).round(1)
    array([300.3, 154. ])
    """
    pressure, width = np.asarray(peak_pressure, dtype=float), np.asarray(half_width, dtype=float)
    relative = np.asarray(depth, dtype=float) / np.where(width > 0.0, width, 1.0)
    falling = relative - relative**2 / np.hypot(1.0, relative)
    below = np.where(relative < LINE_SHEAR_DEPTH, LINE_SHEAR, falling)
    return np.where((pressure > 0.0) & (width > 0.0), below * pressure, 0.0)
