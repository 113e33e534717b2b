r"""Element matrices of triangles for all elements at once, and their sum by nodes.

On one element with shape functions :math:`N_i` and reference gradients :math:`\hat\nabla N_i` at quadrature points q,

.. math:: \int N_{i,a} N_{j,b}\,dA = \sum_q \sum_{cd} \big(w \hat N_{i,c} \hat N_{j,d}\big)_q\,
    \big(|J|\,J^{-1}_{ac} J^{-1}_{bd}\big)_q.

The first factor is the same for all elements: the products of the second with it are one product of matrices. Elements with
straight sides have one J, for which the sum over q is taken beforehand.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from skfem import ElementTriP1, ElementTriP2
from skfem.quadrature import get_quadrature

from fem.mesh.body_mesh import BodyMesh
from ltca.arrays import FloatArray, IntArray


def shape_functions(body: BodyMesh, quadrature: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return shape functions (points, nodes), their gradients (points, nodes, 2) and weights at quadrature points.

    Polynomials of degree `quadrature` are integrated exactly.
    """
    element = ElementTriP2() if body.order == 2 else ElementTriP1()
    points, weights = get_quadrature(element, quadrature)
    found = [element.lbasis(points, node) for node in range(6 if body.order == 2 else 3)]
    values = np.array([np.broadcast_to(value, weights.shape) for value, _ in found])
    slopes = np.array([np.broadcast_to(slope, (2, weights.size)) for _, slope in found])
    return values.T, slopes.transpose(2, 0, 1), weights


def jacobians(body: BodyMesh, elements: IntArray, slopes: FloatArray) -> FloatArray:
    """Return J = ∂x_a/∂ξ_c, shape (points, 2 (c), 2 (a), elements), for gradients of shape (points, nodes, 2)."""
    places = body.mesh.doflocs[:, body.element_nodes.T[:, elements]]
    return np.asarray(np.einsum("qnc,ane->qcae", slopes, places, optimize=True))


def elastic_blocks(
    body: BodyMesh, elements: IntArray, quadrature: int, *, lam: float, mu: float, straight: bool
) -> FloatArray:
    r"""Return the stiffness of some elements, shape (nodes (i), nodes (j), 2 (a), 2 (b), elements), N/mm by mm of thickness.

    .. math:: \int \lambda N_{i,a} N_{j,b} + \mu (N_{i,b} N_{j,a} + \delta_{ab} \nabla N_i \cdot \nabla N_j)\,dA

    `lam` and `mu` are Lamé's constants, MPa, `quadrature` the degree of the rule; `straight` elements have a constant Jacobian.
    """
    _, slopes, weights = shape_functions(body, quadrature)
    nodes = slopes.shape[1]
    outer = weights[:, None, None, None, None] * slopes[:, :, None, :, None] * slopes[:, None, :, None, :]
    jacobian = jacobians(body, elements, slopes[:1] if straight else slopes)
    if straight:
        outer = outer.sum(axis=0, keepdims=True)
    (xx, xy), (yx, yy) = jacobian.transpose(1, 2, 0, 3)
    determinant = xx * yy - xy * yx
    # J⁻¹ by (a, c): derivative of the reference coordinate c along the axis a.
    inverse = np.array([[yy, -yx], [-xy, xx]]).swapaxes(0, 1) / determinant
    metric = np.empty((len(determinant), 2, 2, 2, 2, len(elements)))
    for c in range(2):
        for d in range(2):
            products = inverse[:, None, c] * inverse[None, :, d] * determinant
            trace = mu * (products[0, 0] + products[1, 1])
            for a in range(2):
                for b in range(2):
                    metric[:, c, d, a, b] = lam * products[a, b] + mu * products[b, a] + (trace if a == b else 0.0)
    left = outer.transpose(1, 2, 0, 3, 4).reshape(nodes * nodes, -1)
    return (left @ metric.reshape(left.shape[1], -1)).reshape(nodes, nodes, 2, 2, len(elements))


def sum_by_nodes(body: BodyMesh, elements: IntArray, blocks: FloatArray) -> sp.csc_matrix:
    """Return the sum of element matrices as a matrix of shape (unknowns, unknowns) with sorted indices.

    Blocks have the shape (nodes (i), nodes (j), 2 (a), 2 (b), elements): component a of the force on node i for a unit of
    component b at node j, in the order of `elements`.
    """
    nodes, count = body.element_nodes.T[:, elements].astype(np.int32), body.node_count
    shape = (len(nodes), *nodes.shape)
    places = np.broadcast_to(nodes[:, None], shape).ravel(), np.broadcast_to(nodes[None], shape).ravel()
    summed = [
        [sp.coo_matrix((blocks[:, :, a, b].ravel(), places), shape=(count, count)).tocsc() for b in range(2)]
        for a in range(2)
    ]
    # Blocks by columns are those of the transpose by rows.
    pattern, values = summed[0][0], np.empty((summed[0][0].nnz, 2, 2))
    for a, b in np.ndindex(2, 2):
        values[:, b, a] = summed[a][b].data
    transposed = sp.bsr_matrix((values, pattern.indices, pattern.indptr), shape=(2 * count, 2 * count)).tocsr()
    return sp.csc_matrix(transposed.T)
