"""True separation of two touching surfaces along their common tangent (Eq. 17–19, 53–58, 65).

At the distance l from the contact point along the tangent a circle of radius r has departed from it by r − √(r² − l²), and
the flank by h(l), from its equation. To second order both are the parabola l²/(2ρ) of the tables; ``direct`` includes the
higher orders.
"""

from __future__ import annotations

import numpy as np

from ltca.arrays import FloatArray
from ltca.errors import ConvergenceError
from ltca.geometry.flank import FlankProfile

MAX_ITERATIONS = 40
"""Newton steps to a point of the flank at a distance along the tangent."""


def circle_departure(tangent_distance: FloatArray, radius: float) -> FloatArray:
    """Return r − √(r² − l²), the departure of a circle from its tangent at the distance l, mm (Eq. 17, 53–54).

    The radius is negative for the concave side (a bore), whose departure is negative. Computed as l²/(r + √(r² − l²)), without
    cancellation; infinite beyond the radius, where the circle has no points.
    """
    size = abs(radius)
    square = np.asarray(tangent_distance, dtype=float) ** 2
    inside = square < size**2
    departure = np.where(inside, square / (size + np.sqrt(np.where(inside, size**2 - square, 0.0))), np.inf)
    return np.asarray(np.copysign(departure, radius))


def flank_departure(profile: FlankProfile, parameter: float, tangent_distance: FloatArray) -> FloatArray:
    """Return h, the departure of the flank from its tangent at the contact point θ, mm, positive into the disc (Eq. 18–19, 65).

    `parameter` is θ, rad; `tangent_distance` is l along the tangent in the sense of growing θ, mm. ConvergenceError where the
    flank has no point at such a distance next to the contact point.
    """
    at = np.array(parameter)
    origin = profile.flank(at)
    normal = profile.normal(at)
    tangent = 1j * normal
    theta = np.full(tangent_distance.shape, float(parameter))
    bound = 0.4 * np.pi / profile.reduction_ratio
    history: list[float] = []
    for _ in range(MAX_ITERATIONS):
        rate = (profile.flank_tangent(theta) * np.conj(tangent)).real
        away = ((profile.flank(theta) - origin) * np.conj(tangent)).real - tangent_distance
        floor = 0.05 * np.abs(profile.locus(theta).tangent)
        step = np.clip(away / np.where(rate > floor, rate, floor), -bound, bound)
        theta -= step
        history.append(float(np.max(np.abs(step), initial=0.0)))
        if history[-1] < 1e-9:
            leaving = profile.flank(theta) - origin
            return np.asarray(-(leaving * np.conj(normal)).real)
    raise ConvergenceError("no point of the flank at that distance from the contact; largest step in rad", history)
