r"""Tangential strain of walls as a linear measure of the displacement, for the stress stations.

At a wall without load the stress has one component, along the wall, :math:`\sigma_t = E' \epsilon_t` with
:math:`E' = E/(1 - \nu^2)` in plane strain (E in plane stress). The strain :math:`\epsilon_t = t \cdot du/ds` at a
point of a mesh is as rough as the mesh; its mean over a short arc of half-width b,

.. math:: \bar\epsilon_t = \int w(s)\, t \cdot \frac{du}{ds}\, ds, \qquad
          w = \frac{15}{16\,b} \left(1 - \frac{s^2}{b^2}\right)^2,

is a smooth functional of the displacement: integrated by parts it is the work of a traction :math:`-(w\,t)'`, which
balances itself and has no singularity, so its value converges with the square of the energy error. One solution for that
traction (the adjoint) gives, by reciprocity, the mean strain under any load. The mean differs from the value in the
middle by :math:`\epsilon_t''\, b^2/14`.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from fem.body.elasticity import PlaneState
from fem.body.surface import quadratic_shapes, quadratic_slopes
from fem.coefficients.patch_loads import BoundaryArc, divide_patches, sum_at_nodes
from fem.mesh.body_mesh import BodyMesh
from fem.shapes import Curve
from ltca.arrays import FloatArray
from ltca.drive.parts import Material


def wall_modulus(material: Material, state: PlaneState = "strain") -> float:
    """Return E', stress by strain along a wall without load, MPa: E/(1 − ν²) in plane strain, E in plane stress."""
    flat = 1.0 - material.poisson_ratio**2 if state == "strain" else 1.0
    return material.youngs_modulus / flat


def wall_strain_measures(
    body: BodyMesh, curve: Curve, parameters: FloatArray, half_width: FloatArray | float
) -> sp.csc_matrix:
    """Return weights on nodal displacements that give mean tangential strains of a wall, 1/mm, shape (unknowns, n).

    `parameters` are the middles of the arcs on the exact curve, rad, `half_width` their half-widths, mm. The transpose times a
    displacement is the strain; that of a rigid motion is zero to round-off.
    """
    parameters = np.atleast_1d(np.asarray(parameters, dtype=float))
    width = np.broadcast_to(np.asarray(half_width, dtype=float), parameters.shape)
    boundary = BoundaryArc.of_boundary(body, curve)
    middle = boundary.arc_of(curve.points(parameters))
    phi, step, owner = divide_patches(boundary, middle, width)
    edge, xi = boundary.coordinate_of(middle[owner] + width[owner] * np.sin(phi))
    slopes = quadratic_slopes(xi)
    # The tangent is that of the meshed edge, not of the exact curve: then a rotation strains nothing.
    tangent = np.sum(boundary.places[edge].T * slopes, axis=0)
    weight = 15.0 / 16.0 * np.cos(phi) ** 5 * step * tangent / np.abs(tangent) ** 2
    return sum_at_nodes(boundary.nodes[edge].T, weight * slopes, owner, (body.unknowns, len(parameters)))


def continue_under_patches(
    stress: FloatArray, stress_boundary: NDArray[np.int64], boundary: NDArray[np.int64]
) -> FloatArray:
    """Return stresses without the local part under each patch, −p, interpolated from neighbouring patches.

    Under a patch the wall is compressed along itself by the pressure, which outside, on a half-plane, has no effect at all. The
    rest varies smoothly along the wall. So the entry of a place under its own patch is replaced by the polynomial through the
    entries of up to four patches on either side.

    `stress` has the shape (stress stations, stations), MPa/N. `stress_boundary` and `boundary` are the numbers of the
    boundaries of stress stations and patches; both are uniform along a boundary, with a whole number of stress stations for
    each patch and the first of them at its middle.
    """
    found = stress.copy()
    for number in np.unique(boundary).tolist():
        own, places = np.flatnonzero(boundary == number), np.flatnonzero(stress_boundary == number)
        upon = places[:: len(places) // len(own)]
        reach = min(4, (len(own) - 1) // 2)
        offsets = np.concatenate([np.arange(-reach, 0), np.arange(1, reach + 1)])
        weights = [np.prod([other / (other - one) for other in offsets if other != one]) for one in offsets.tolist()]
        beside = own[(np.arange(len(own))[:, None] + offsets) % len(own)]
        found[upon, own] = stress[upon[:, None], beside] @ np.array(weights)
    return found


def wall_values(body: BodyMesh, curve: Curve, parameters: FloatArray) -> sp.csc_matrix:
    """Return weights on nodal values that give the values at places of a wall, shape (nodes, n).

    `parameters` are the places on the exact curve, rad.
    """
    parameters = np.atleast_1d(np.asarray(parameters, dtype=float))
    boundary = BoundaryArc.of_boundary(body, curve)
    edge, xi = boundary.coordinate_of(boundary.arc_of(curve.points(parameters)))
    columns = np.broadcast_to(np.arange(len(parameters)), (3, len(parameters)))
    entries = (quadratic_shapes(xi).ravel(), (boundary.nodes[edge].T.ravel(), columns.ravel()))
    return sp.csc_matrix(entries, shape=(body.node_count, len(parameters)))
