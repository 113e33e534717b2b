"""Motion of the far flange of a carrier against the near one: posts as beams, flanges as strips that bend between posts.

Flanges stay parallel, κ is Cowper's (1966). A post of length L under a force F across turns its ends by c_i M_i, M₁ + M₂ = F L:
by Castigliano's theorem Δ = F [L³/3EI + L/κGA + c₂ L²] − M₁ L [L/2EI + c₂], M₁ = F L (L/2EI + c₂)/(L/EI + c₁ + c₂).
"""

from __future__ import annotations

from math import pi

import numpy as np

from ltca.arrays import FloatArray
from ltca.drive.parts import Drive


def post_stiffness(
    length: float, diameter: float, youngs_modulus: float, poisson_ratio: float, ends: tuple[float, float] = (0.0, 0.0)
) -> tuple[float, float]:
    """Return force by displacement, N/mm, and moment by twist, N·mm/rad, of a post whose `ends` turn by moments, rad/(N·mm).

    >>> across, _ = post_stiffness(1e4, 10.0, 2e5, 0.3)  # a long post between rigid flanges, 12 EI/L³
    >>> print(f"{across / (12.0 * 2e5 * pi * 10.0**4 / 64.0 / 1e12):.4f}")
    1.0000
    """
    second, shear_modulus = pi * diameter**4 / 64.0, youngs_modulus / (2.0 * (1.0 + poisson_ratio))
    bending = youngs_modulus * second
    shear = 6.0 * (1.0 + poisson_ratio) / (7.0 + 6.0 * poisson_ratio) * shear_modulus * pi * diameter**2 / 4.0
    first, far = ends
    near_moment = length * (0.5 * length / bending + far) / (length / bending + first + far)
    moved = length**3 / (3.0 * bending) + length / shear + far * length**2
    moved -= near_moment * length * (0.5 * length / bending + far)
    return 1.0 / moved, shear_modulus * 2.0 * second / length


def flange_compliance(thickness: float, number: int, radius: float, size: float, youngs_modulus: float) -> float:
    """Return c = s/(E R t³), s = 2πR/n − d, the rotation of a flange at the end of each of n posts by its moment, rad/(N·mm).

    >>> flange_compliance(10.0, 6, 30.0, 10.0 * pi, 2e5)  # posts that touch leave nothing to bend
    0.0
    """
    return max(2.0 * pi * radius / number - size, 0.0) / (youngs_modulus * radius * thickness**3)


def far_flange_stiffness(drive: Drive) -> FloatArray | None:
    """Return the forces on the far flange by its x, y and rotation, N, mm, rad, shape (3, 3); None without posts."""
    carrier, posts = drive.carrier, drive.posts
    if carrier is None or posts is None:
        return None
    material = drive.materials.carrier
    modulus, ratio = material.youngs_modulus, material.poisson_ratio
    ends, sheared = (0.0, 0.0), 0.0
    if carrier.flange is not None:
        near, far = carrier.flange
        near_end = flange_compliance(near, posts.number, posts.radius, posts.size, modulus)
        ends = near_end, flange_compliance(far, posts.number, posts.radius, posts.size, modulus)
        if loaded := loaded_circle(drive):
            shear_modulus = modulus / (2.0 * (1.0 + ratio))
            sheared = abs(posts.radius**-2 - loaded**-2) / (4.0 * pi * shear_modulus * far)
    across, twist = post_stiffness(drive.post_length, posts.size, modulus, ratio, ends)
    turning = posts.number * (across * posts.radius**2 + twist)
    return np.diag([posts.number * across, posts.number * across, turning / (1.0 + sheared * turning)])


def loaded_circle(drive: Drive) -> float:
    """Return the radius of the circle on which the far flange is pressed, that of the shaft pins or else of the cranks, mm."""
    if drive.pin_shaft is not None:
        return drive.pin_shaft.pin_circle_radius
    return drive.crank.circle_radius or 0.0
