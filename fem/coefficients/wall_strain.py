r"""Tangential strain of walls as a measure of the displacement: what stress stations read.

At a wall without load the stress has one component, along the wall, :math:`\sigma_t = E' \epsilon_t` with
:math:`E' = E/(1 - \nu^2)` in plane strain (E in plane stress). The strain :math:`\epsilon_t = t \cdot du/ds` at a
point of a mesh is as rough as the mesh; its mean over a short arc of half-width b,

.. math:: \bar\epsilon_t = \int w(s)\, t \cdot \frac{du}{ds}\, ds, \qquad
          w = \frac{15}{16\,b} \left(1 - \frac{s^2}{b^2}\right)^2,

is a smooth functional of the displacement: integrated by parts it is the work of a traction :math:`-(w\,t)'`, which
balances itself and has no singularity, so its value converges with the square of the energy error. One solution for that
traction (the adjoint) tells, by reciprocity, the mean strain under any load. The mean differs from the value in the
middle by :math:`\epsilon_t''\, b^2/14`.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from fem.body.elasticity import PlaneState
from fem.body.surface import quadratic_slopes
from fem.coefficients.patch_loads import BoundaryArc, divide_patches
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
    """Return weights on nodal displacements that give mean tangential strains of a wall.

    Parameters
    ----------
    body : BodyMesh
        Quadratic mesh.
    curve : Curve
        Exact curve of a closed boundary of the mesh.
    parameters : array, shape (n,)
        Middles of the arcs as parameters of the curve, rad.
    half_width : float or array, shape (n,)
        Of the arcs, mm.

    Returns
    -------
    csc_matrix, shape (unknowns, n)
        1/mm; the transpose times a displacement is the strain. A rigid motion has none, to round-off.
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
    nodes = boundary.nodes[edge].T
    rows = np.concatenate([(2 * nodes).ravel(), (2 * nodes + 1).ravel()])
    values = np.concatenate([(weight.real * slopes).ravel(), (weight.imag * slopes).ravel()])
    columns = np.tile(owner, 6)
    return sp.csc_matrix(sp.coo_matrix((values, (rows, columns)), shape=(body.unknowns, len(parameters))))


def continue_under_patches(
    stress: FloatArray, stress_boundary: NDArray[np.int64], boundary: NDArray[np.int64]
) -> FloatArray:
    """Return stresses without what each patch does right under itself, −p: continued from its neighbours.

    Under its own patch a wall carries the patch's pressure along itself, too, and outside, on a half-plane, nothing at
    all: what is left varies smoothly along the wall, through the patch. So the entry of a place by the patch upon it is
    replaced by the polynomial through those of up to four patches on either side.

    Parameters
    ----------
    stress : array, shape (stress stations, stations)
        At each stress station by a newton on each patch, MPa/N.
    stress_boundary : array of int, shape (stress stations,)
        Number of the boundary of each stress station; uniform and in order along each, a whole number of them for each
        patch, the first of them upon it.
    boundary : array of int, shape (stations,)
        Likewise of the patches.
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
