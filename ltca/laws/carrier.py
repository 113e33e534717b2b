r"""How the far flange of a carrier moves against the near one: posts as beams, flanges as strips that bend between posts.

A post of length L is a round Timoshenko beam between two flanges that stay parallel (their tilt is left out). Under a force F
across it bends in an S; the ends carry moments :math:`M_1 + M_2 = FL` and turn by :math:`c_i M_i` where the flanges bend.
By Castigliano's theorem the flange moves by

.. math:: \Delta = F \left[\frac{L^3}{3EI} + \frac{L}{\kappa GA} + c_2 L^2\right]
   - M_1 L \left[\frac{L}{2EI} + c_2\right], \qquad M_1 = FL\,\frac{L/2EI + c_2}{L/EI + c_1 + c_2} ,

which is :math:`FL^3/12EI + FL/\kappa GA` between rigid flanges. A flange of thickness t turns where a post is fixed: between two
posts it is a strip that both bend alike, :math:`6EI_s/s` at each end, with the free length :math:`s = 2\pi R/n - d` along the
circle of the posts and the width R of a flange from R/2 to 3R/2; a post has such a strip on either side,

.. math:: c = \frac{s}{12 E I_s} = \frac{s}{E R t^3} .

Thin plates of usual outlines by finite elements tilt from 0.8 to 1.25 times as far (``tests/fem/test_flange_of_a_carrier.py``).
n posts on the circle R resist x and y with n times the stiffness k of one, and rotation with
:math:`n(kR^2 + GJ/L)`; in series with rotation stands the far flange itself, sheared between the circle of the posts and that
of the pins or cranks, :math:`|1/R^2 - 1/R_P^2|/4\pi Gt` (an annular disc in torsion).
"""

from __future__ import annotations

from math import pi

import numpy as np

from ltca.arrays import FloatArray
from ltca.drive.parts import Drive


def post_stiffness(
    length: float, diameter: float, youngs_modulus: float, poisson_ratio: float, ends: tuple[float, float] = (0.0, 0.0)
) -> tuple[float, float]:
    """Return the force by unit displacement of one post's far end that does not turn, N/mm, and its moment by twist, N·mm/rad.

    Lengths are in mm, `ends` the rotation of each end by its moment, rad/(N·mm); the shear coefficient is that of Cowper (1966),
    6(1 + ν)/(7 + 6ν).

    Examples
    --------
    A long post between rigid flanges resists with 12 EI/L³:

    >>> across, _ = post_stiffness(1e4, 10.0, 2e5, 0.3)
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
    """Return the rotation of a flange at the end of a post by its moment, rad/(N·mm).

    `number` posts of a diameter `size` stand on a circle of a radius, lengths in mm, and all tilt alike.

    Examples
    --------
    Posts that touch each other leave nothing to bend:

    >>> flange_compliance(10.0, 6, 30.0, 10.0 * pi, 2e5)
    0.0
    """
    return max(2.0 * pi * radius / number - size, 0.0) / (youngs_modulus * radius * thickness**3)


def far_flange_stiffness(drive: Drive) -> FloatArray | None:
    """Return the forces on the far flange by its x, y and rotation, shape (3, 3), N/mm, N/rad and N·mm/rad; None without
    posts.
    """
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
