"""What is read from the pressure unknowns of one contact: resultant, half-width, peak, means at the vertices."""

from __future__ import annotations

import numpy as np

from ltca.arrays import FloatArray

PEAK_WINDOW = 0.5
"""Part of the half-width about the largest pressure over which the parabola for the peak is fitted: single values wiggle by some
tenths of a per cent and the largest of them lies beside the peak."""


def pressure_moments(arc: FloatArray, pressure: FloatArray) -> tuple[float, float, float]:
    """Return ∫p ds (N/mm), centre (mm) and second moment ⟨x²⟩ about it (mm²) of a piecewise linear pressure.

    `arc` holds the places of the vertices, mm. All are zero without pressure. Simpson's rule is exact for these cubics.
    """
    left, right = arc[:-1], arc[1:]
    length = right - left
    middle, between = 0.5 * (left + right), 0.5 * (pressure[:-1] + pressure[1:])
    total = float(np.sum(length * between))
    if total <= 0.0:
        return 0.0, 0.0, 0.0

    def integral(weight_left: FloatArray, weight_middle: FloatArray, weight_right: FloatArray) -> float:
        values = weight_left * pressure[:-1] + 4.0 * weight_middle * between + weight_right * pressure[1:]
        return float(np.sum(length * values)) / 6.0

    centre = integral(left, middle, right) / total
    square = integral((left - centre) ** 2, (middle - centre) ** 2, (right - centre) ** 2) / total
    return total, centre, square


def peak_of(arc: FloatArray, pressure: FloatArray, half_width: float) -> float:
    """Return the peak of a piecewise linear pressure from a parabola about its largest vertex value, MPa."""
    top = int(np.argmax(pressure))
    near = (np.abs(arc - arc[top]) <= PEAK_WINDOW * half_width) & (pressure > 0.0)
    if np.count_nonzero(near) < 5:
        return float(pressure[top])
    x = (arc[near] - arc[top]) / half_width
    # Hertz: p² is a parabola, so its fit has no error of form.
    bend, slope, level = np.polyfit(x, pressure[near] ** 2, 2)
    if bend >= 0.0:
        return float(pressure[top])
    place = np.clip(-slope / (2.0 * bend), x.min(), x.max())
    peak = float(np.sqrt(max(level + place * (slope + bend * place), 0.0)))
    # Weighted gaps make the pressure an L2 projection on piecewise linear functions; the vertex values of the
    # projection of a parabola lie above it by h²|p″|/12, exactly, for equal edges h.
    edge = float(np.mean(np.diff(arc[near])))
    return float(peak - edge**2 * abs(bend / peak) / half_width**2 / 12.0)


def vertex_means(arc: FloatArray, pressure: FloatArray) -> FloatArray:
    r"""Return the mean pressure under the shape function of each vertex, ∫φp ds/∫φ ds, MPa.

    The pressure unknowns are an L2 projection, whose vertex values swing beside the square-root end of the
    contact; these means do not. They are for pictures and files; every force comes from the unknowns.
    """
    edge = np.diff(arc)
    moment = np.zeros(len(arc))
    moment[:-1] += edge * (2.0 * pressure[:-1] + pressure[1:]) / 6.0
    moment[1:] += edge * (2.0 * pressure[1:] + pressure[:-1]) / 6.0
    area = np.zeros(len(arc))
    area[:-1] += 0.5 * edge
    area[1:] += 0.5 * edge
    return np.asarray(moment / area)
