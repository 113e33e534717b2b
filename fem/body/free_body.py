r"""Datum of a floating body: its displacement relative to the best-fit rigid motion of some boundaries.

The motion q that fits the displacement u of the boundaries best, in the mean square along their length, solves
:math:`G q = W^T u` with :math:`W_i = \int N_i r\,ds` for the rigid modes r and :math:`G = \int r^T r\,ds`. An
approach relative to it is :math:`B^T u - R^T G^{-1} W^T u`, R being the resultants of the patches B. The matrix of
approaches is symmetric when the resultant of a unit load is balanced by the forces dual to that datum,
:math:`-W G^{-1} R`, spread over the boundary; loads in equilibrium do not notice by what each of them was balanced.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from fem.body.surface import GAUSS_POINTS, GAUSS_WEIGHTS, quadratic_shapes, quadratic_slopes
from fem.mesh.body_mesh import BodyMesh
from ltca.arrays import BoolArray


def boundary_motion_loads(
    body: BodyMesh, boundary: str, edges: BoolArray | slice = slice(None), *, centre: complex = 0j
) -> sp.csc_matrix:
    r"""Return W: nodal loads shaped like the rigid modes along a closed boundary, :math:`\int N_i r\,ds`, shape (unknowns, 3).

    Their transpose times a displacement gives its means over the boundary times its length (mm, mm, and mm² for the rotation
    about `centre`); `edges` are those that count, all by default.
    """
    nodes = body.boundary_nodes(boundary)[edges]
    x, y = body.mesh.doflocs
    places = x[nodes] + 1j * y[nodes]
    shapes = quadratic_shapes(GAUSS_POINTS)
    points = places @ shapes
    length = np.abs(places @ quadratic_slopes(GAUSS_POINTS)) * GAUSS_WEIGHTS
    lever = points - centre
    columns = []
    for mode_x, mode_y in (
        (np.ones_like(length), np.zeros_like(length)),
        (np.zeros_like(length), np.ones_like(length)),
        (-lever.imag, lever.real),
    ):
        load = np.zeros(body.unknowns)
        np.add.at(load, 2 * nodes, (length * mode_x) @ shapes.T)
        np.add.at(load, 2 * nodes + 1, (length * mode_y) @ shapes.T)
        columns.append(load)
    return sp.csc_matrix(np.column_stack(columns))
