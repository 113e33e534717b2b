r"""Integrals of the shape functions over the cross-section of an extruded body.

For quadratic triangles (`fem.mesh.body_mesh.BodyMesh`) and for quadrilaterals of nine nodes (``skfem.MeshQuad2``):

.. math:: S_{ab} = \int N_{i,a} N_{j,b}\,dA, \qquad G_a = \int N_{i,a} N_j\,dA, \qquad M = \int N_i N_j\,dA .
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from skfem import ElementQuad2, ElementTriP2, MeshQuad2
from skfem.quadrature import get_quadrature

from fem.errors import MeshError
from fem.mesh.body_mesh import BodyMesh
from ltca.arrays import FloatArray, IntArray

# Products of two quadratic shape functions; of nine-node quadrilaterals of the fourth degree in each direction.
QUADRATURE = {6: 4, 9: 8}


@dataclass(frozen=True, slots=True, kw_only=True)
class Section:
    """Plane mesh of a cross-section.

    Attributes
    ----------
    name : str
        Of the body.
    places : array, shape (2, nodes)
        Places of the nodes, mm.
    element_nodes : array of int, shape (elements, 6 or 9)
        Nodes of each element: vertices, mid-sides, and the middle of a quadrilateral.
    """

    name: str
    places: FloatArray
    element_nodes: IntArray

    @classmethod
    def of_body(cls, body: BodyMesh) -> Section:
        """Return the cross-section of a mesh of quadratic triangles; MeshError for straight ones."""
        if body.order != 2:
            raise MeshError(f"mesh of {body.name} has straight elements; solid bodies need second-order ones")
        return cls(name=body.name, places=np.asarray(body.mesh.doflocs), element_nodes=body.element_nodes)

    @classmethod
    def of_quadrilaterals(cls, name: str, mesh: MeshQuad2) -> Section:
        """Return the cross-section of a mesh of quadrilaterals of nine nodes.

        Nodes are numbered as scikit-fem does: vertices, mid-sides facet by facet, middles of the elements.
        """
        first = mesh.nvertices + mesh.nfacets
        middles = first + np.arange(mesh.t.shape[1])
        nodes = np.vstack([mesh.t, mesh.nvertices + mesh.t2f, middles])
        return cls(name=name, places=np.asarray(mesh.doflocs), element_nodes=np.asarray(nodes, dtype=np.int64).T)

    @property
    def node_count(self) -> int:
        """Number of nodes."""
        return int(self.places.shape[1])


@dataclass(frozen=True, slots=True, kw_only=True)
class SectionIntegrals:
    """Integrals over the cross-section, all on one sparsity pattern.

    Attributes
    ----------
    rows, columns : array of int, shape (entries,)
        Nodes i and j of the entries.
    slopes : array, shape (2, 2, entries)
        S_ab.
    mixed : array, shape (2, entries)
        G_a, mm.
    mixed_transposed : array, shape (2, entries)
        ∫ N_i N_j,a dA, mm.
    mass : array, shape (entries,)
        M, mm².
    """

    rows: IntArray
    columns: IntArray
    slopes: FloatArray
    mixed: FloatArray
    mixed_transposed: FloatArray
    mass: FloatArray


def integrate_section(section: Section) -> SectionIntegrals:
    """Return the integrals of a cross-section; MeshError where an element is turned inside out."""
    nodes = section.element_nodes.T
    number = nodes.shape[0]
    element = ElementTriP2() if number == 6 else ElementQuad2()
    points, weights = get_quadrature(element, QUADRATURE[number])
    basis = [element.lbasis(points, node) for node in range(number)]
    values = np.array([np.broadcast_to(value, weights.shape) for value, _ in basis])
    slopes = np.array([np.broadcast_to(slope, (2, weights.size)) for _, slope in basis])
    places = section.places[:, nodes]
    # J by (a, c): derivative of the place along axis a by the reference coordinate c.
    jacobian = np.einsum("ane,ncq->acqe", places, slopes, optimize=True)
    determinant = jacobian[0, 0] * jacobian[1, 1] - jacobian[0, 1] * jacobian[1, 0]
    if not np.all(determinant > 0.0):
        raise MeshError(f"mesh of {section.name}: an element is turned inside out")
    inverse = np.array([[jacobian[1, 1], -jacobian[0, 1]], [-jacobian[1, 0], jacobian[0, 0]]]) / determinant
    gradient = np.einsum("caqe,ncq->anqe", inverse, slopes, optimize=True)
    area = weights[:, None] * determinant
    weighted = gradient * area
    stiff = np.einsum("anqe,bmqe->abnme", weighted, gradient, optimize=True)
    mixed = np.einsum("anqe,mq->anme", weighted, values, optimize=True)
    mass = np.einsum("qe,nq,mq->nme", area, values, values, optimize=True)
    stacked = np.concatenate([stiff.reshape(4, number, number, -1), mixed, mixed.swapaxes(1, 2), mass[None]])
    shape = (number, number, nodes.shape[1])
    rows = np.broadcast_to(nodes[:, None], shape).ravel()
    columns = np.broadcast_to(nodes[None], shape).ravel()
    count = section.node_count
    keys = rows.astype(np.int64) * count + columns
    pattern, place = np.unique(keys, return_inverse=True)
    summed: FloatArray = np.stack(
        [np.bincount(place, weights=each.ravel(), minlength=pattern.size).astype(np.float64) for each in stacked]
    )
    return SectionIntegrals(
        rows=pattern // count,
        columns=pattern % count,
        slopes=summed[:4].reshape(2, 2, -1),
        mixed=summed[4:6],
        mixed_transposed=summed[6:8],
        mass=summed[8],
    )


def section_mass(section: Section) -> sp.csc_matrix:
    """Return the mass matrix of a cross-section, shape (nodes, nodes), mm²."""
    found = integrate_section(section)
    return sp.csc_matrix((found.mass, (found.rows, found.columns)), shape=(section.node_count,) * 2)
