"""True separation of two touching surfaces along their common tangent (Eq. 17–19, 53–58, 65), for grids."""

from __future__ import annotations

import numpy as np

from ltca.arrays import FloatArray
from ltca.errors import ConvergenceError
from ltca.geometry.flank import FlankProfile

MAX_ITERATIONS = 40
"""Newton steps to a point of the flank at a distance along the tangent."""


def circle_departure(tangent_distance: FloatArray, radius: float) -> FloatArray:
    """Return r − √(r² − l²), the departure of a circle from its tangent at l, mm (Eq. 17, 53–54); a bore has r < 0."""
    size = abs(radius)
    square = np.asarray(tangent_distance, dtype=float) ** 2
    inside = square < size**2
    departure = np.where(inside, square / (size + np.sqrt(np.where(inside, size**2 - square, 0.0))), np.inf)
    return np.asarray(np.copysign(departure, radius))


def flank_departure(profile: FlankProfile, parameter: float, tangent_distance: FloatArray) -> FloatArray:
    """Return h of the flank from its tangent at θ, mm, positive into the disc, at distances l along it (Eq. 18–19, 65)."""
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
