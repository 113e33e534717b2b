"""Influence coefficients of uniformly pressed rectangles on an elastic half-space: ∫∫ 1/r dA_i dA_j in closed form, mm³.

Galerkin means, unlike Love's displacements of points, are symmetric and positive definite on any grid: the energy of pressures
p is p·A·p/(2 π E*). Cells are uniform along x, so only lags in x matter; quarter or half domains follow by images.
"""

from __future__ import annotations

import numpy as np

from ltca.arrays import FloatArray

# Beyond this ratio of distance along y to the largest distance along x a power series replaces the closed
# form, whose second difference in x would lose (distance/cell)² digits: 1e-9 at worst on either side.
_SERIES_RATIO = 40.0
_GAUSS_POINTS, _GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(3)
# Cells are far from each other when the gap exceeds these numbers of cell lengths (y) and widths (x): there the
# quadrature errs by less than 5e-6 of the coefficient, while second differences lose (distance/cell)⁴ digits.
_FAR_LENGTHS = 1.5
_FAR_WIDTHS = 4.0
_PAIRS_AT_ONCE = 1024  # distant pairs of cells: their nodes stay in the cache


def _product_with_inverse_sinh(factor: FloatArray, ratio_of: FloatArray, to: FloatArray) -> FloatArray:
    """``factor · asinh(ratio_of / |to|)``, zero where ``to`` is zero: its limit, since the factor contains |to| or to²."""
    size = np.abs(to)
    safe = np.where(size > 0.0, size, 1.0)
    return np.where(size > 0.0, factor * np.arcsinh(ratio_of / safe), 0.0)


def _fourfold_potential(x: FloatArray, y: FloatArray) -> FloatArray:
    """K with ∂⁴K/∂x²∂y² = 1/r: ½x²y asinh(y/|x|) + ½xy² asinh(x/|y|) − r³/6."""
    cube = np.hypot(x, y) ** 3
    return (
        _product_with_inverse_sinh(0.5 * x * x * y, y, x)
        + _product_with_inverse_sinh(0.5 * x * y * y, x, y)
        - cube / 6.0
    )


def _even_moment(lag: FloatArray, width: float, order: int) -> FloatArray:
    """Mean of (ξ−ξ')^order over two cells of equal width at a distance of ``lag``."""
    n = order + 2
    difference = (lag + width) ** n - 2.0 * lag**n + (lag - width) ** n
    return np.asarray(difference / (n * (n - 1) * width**2))


def _mean_logarithm(lag: FloatArray, width: float) -> FloatArray:
    """Mean of ln|ξ−ξ'| over two cells of equal width at a distance of ``lag``."""

    def twice_integrated(value: FloatArray) -> FloatArray:
        size = np.abs(value)
        return np.asarray(0.5 * value**2 * np.log(np.where(size > 0.0, size, 1.0)) - 0.75 * value**2)

    difference = twice_integrated(lag + width) - 2.0 * twice_integrated(lag) + twice_integrated(lag - width)
    return np.asarray(difference / width**2)


def _mean_line_potential(lags: FloatArray, width: float, distance: FloatArray) -> FloatArray:
    """Mean over two x cells of M(x, Y), where ∂²M/∂Y² = 1/r; shape (lags, *distance)."""
    size = np.abs(distance).ravel()
    far = size > _SERIES_RATIO * (lags[-1] + width)
    mean = np.empty((lags.size, size.size))
    if not far.all():
        near = size[~far]
        # lags are 0, 1, 2, … cells, so K at −1, 0, 1, … serves every second difference.
        stations = np.concatenate([[-width], lags, [lags[-1] + width]])
        potential = _fourfold_potential(stations[:, None], near[None, :])
        mean[:, ~far] = (potential[2:] - 2.0 * potential[1:-1] + potential[:-2]) / width**2
    if far.any():
        y = size[far][None, :]
        square, fourth, sixth = (_even_moment(lags, width, k)[:, None] for k in (2, 4, 6))
        # M = Y asinh(Y/x) − r expanded for x ≪ Y.
        mean[:, far] = (
            y * (np.log(2.0 * y) - 1.0 - _mean_logarithm(lags, width)[:, None])
            - square / (4.0 * y)
            + fourth / (32.0 * y**3)
            - sixth / (96.0 * y**5)
        )
    return mean.reshape(lags.size, *distance.shape)


def _far_mean(lag: FloatArray, width: float, distance: FloatArray, receive: FloatArray, send: FloatArray) -> FloatArray:
    """Mean of 1/r over two distant cells, times their lengths in y: Gauss in y, moments in x; flat pairs."""
    nodes_receive = np.repeat(_GAUSS_POINTS, _GAUSS_POINTS.size)[:, None]
    nodes_send = np.tile(_GAUSS_POINTS, _GAUSS_POINTS.size)[:, None]
    y = distance + 0.5 * receive * nodes_receive - 0.5 * send * nodes_send
    inverse_square = 1.0 / (lag**2 + y**2)
    cosine_square = lag**2 * inverse_square
    small = width**2 * inverse_square
    # Two cells of width w: ⟨t²⟩ = w²/6, ⟨t⁴⟩ = w⁴/15, so 1/r gains w²/12 ∂² + w⁴/360 ∂⁴ along x.
    series = (
        1.0
        + small * (3.0 * cosine_square - 1.0) / 12.0
        + small**2 * (105.0 * cosine_square**2 - 90.0 * cosine_square + 9.0) / 360.0
    )
    weights = np.outer(_GAUSS_WEIGHTS, _GAUSS_WEIGHTS).ravel() / 4.0
    return np.asarray((weights @ (np.sqrt(inverse_square) * series)) * receive * send)


def _lagged_block(lags: FloatArray, width: float, y_edges: FloatArray, sign: float, shift: float = 0.0) -> FloatArray:
    """Fourfold integrals per width² between cells at y and their images at ``sign·y + shift``; (lags, n, n)."""
    lengths = np.diff(y_edges)
    centres = 0.5 * (y_edges[1:] + y_edges[:-1])
    potential = _mean_line_potential(lags, width, y_edges[:, None] - sign * y_edges[None, :] - shift)
    block = sign * (potential[:, 1:, :-1] - potential[:, 1:, 1:] - potential[:, :-1, :-1] + potential[:, :-1, 1:])
    distance = np.broadcast_to(centres[:, None] - sign * centres[None, :] - shift, block.shape)
    gap = np.maximum(np.abs(distance) - 0.5 * (lengths[:, None] + lengths[None, :]), lags[:, None, None] - width)
    longest = np.maximum(lengths[:, None], lengths[None, :])
    far = gap >= np.maximum(_FAR_LENGTHS * longest, _FAR_WIDTHS * width)
    pairs = np.nonzero(far)
    for first in range(0, pairs[0].size, _PAIRS_AT_ONCE):
        m, i, j = (each[first : first + _PAIRS_AT_ONCE] for each in pairs)
        block[m, i, j] = _far_mean(lags[m], width, distance[m, i, j], lengths[i], lengths[j])
    return np.asarray(block)


def lagged_influence(
    cell_width: float, lag_count: int, y_edges: FloatArray, *, mirrored: bool, end_factor: float = 0.0
) -> FloatArray:
    """Return ∫∫ 1/r dA_i dA_j of a grid of uniform x cells by the lag in x, mm³, shape (lag_count, n, n).

    `mirrored` adds images in y = 0, where `y_edges`, mm, start; `end_factor` times those in the ends y = ±`y_edges[-1]`.
    """
    lags = cell_width * np.arange(lag_count, dtype=float)
    total = np.zeros((lag_count, y_edges.size - 1, y_edges.size - 1))
    for sign in (1.0, -1.0) if mirrored else (1.0,):
        total += _lagged_block(lags, cell_width, y_edges, sign)
        if end_factor:
            for shift in (2.0 * y_edges[-1], -2.0 * y_edges[-1]):
                total += end_factor * _lagged_block(lags, cell_width, y_edges, -sign, shift)
    return np.asarray(0.5 * cell_width**2 * (total + total.transpose(0, 2, 1)))


def end_images(cell_width: float, y_edges: FloatArray, end_plane: float) -> FloatArray:
    """Return ∫∫ 1/r dA_i dA_j between strips and their images in the planes y = ±`end_plane`, mm, both together, mm³, (n, n)."""
    lags = np.zeros(1)
    total = sum(
        _lagged_block(lags, cell_width, y_edges, -1.0, shift)[0] for shift in (2.0 * end_plane, -2.0 * end_plane)
    )
    return np.asarray(0.5 * cell_width**2 * (total + np.transpose(total)))


def assemble_influence_matrix(
    x_edges: FloatArray,
    y_edges: FloatArray,
    *,
    symmetric_x: bool = False,
    symmetric_y: bool = False,
    end_factor: float = 0.0,
) -> FloatArray:
    """Return the influence matrix ∫∫ 1/r dA_i dA_j of a tensor grid, mm³, shape (nx·ny, nx·ny), x-major.

    Symmetric directions are given by their positive half, edges from 0 (else ValueError), and images added: p·A·p/(2 π E*) is the
    energy of that half. x edges are uniform; free ends at y = ±`y_edges[-1]` add their images times `end_factor`.
    """
    widths = np.diff(x_edges)
    count, width = widths.size, float(np.mean(widths))
    if not np.allclose(widths, width, rtol=1e-6, atol=0.0):
        raise ValueError("the x edges of an influence grid must be uniform")
    if (symmetric_x and abs(x_edges[0]) > 1e-9 * width) or (symmetric_y and abs(y_edges[0]) > 1e-9 * y_edges[-1]):
        raise ValueError("the edges of a symmetric direction must start at 0")
    lags = lagged_influence(
        width, 2 * count if symmetric_x else count, y_edges, mirrored=symmetric_y, end_factor=end_factor
    )
    index, along = np.arange(count), y_edges.size - 1
    matrix = np.empty((count, along, count, along))
    for row, blocks in enumerate(matrix):  # one after the other: the matrix is the largest thing in memory
        blocks[...] = lags[np.abs(index - row)].swapaxes(0, 1)
        if symmetric_x:
            blocks += lags[index + row + 1].swapaxes(0, 1)
    return matrix.reshape(count * along, count * along)
