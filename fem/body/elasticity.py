r"""Plane linear elasticity of one meshed body: stiffness, rigid modes, distributed loads, energy.

Unknowns are numbered node by node: component c of node k is unknown 2k + c, with the nodes of
`fem.mesh.body_mesh.BodyMesh` (vertices first, then mid-side nodes by facet), which is also the numbering of
scikit-fem's ``ElementVector(ElementTriP2())``. Forces are those on the full thickness, in N.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from skfem import Basis, ElementTriP1, ElementTriP2, ElementVector, FacetBasis, LinearForm, MeshTri2
from skfem.models.elasticity import lame_parameters, linear_elasticity

from fem.mesh.body_mesh import BodyMesh
from ltca.arrays import ComplexArray, FloatArray, IntArray
from ltca.drive.parts import Material

PlaneState = Literal["strain", "stress"]
Traction = Callable[[FloatArray, FloatArray], tuple[FloatArray, FloatArray]]
"""Traction x, y, MPa, at places (x, y) and outward normals, arrays of shape (2, …), mm."""

# Stiffness of straight quadratic triangles is a polynomial of degree 2 in the reference coordinates, exact with
# three points; curved ones have a rational integrand, for which six points leave less than the curve itself.
STRAIGHT_QUADRATURE = 2
CURVED_QUADRATURE = 4
# Relative offset of a mid-side node from the middle of its edge above which an element counts as curved.
CURVED_OFFSET = 1e-9


def plane_lame_parameters(material: Material, state: PlaneState) -> tuple[float, float]:
    """Return Lamé's λ and μ of the plane problem, MPa; in plane stress λ is replaced by 2λμ/(λ + 2μ)."""
    lam, mu = lame_parameters(material.youngs_modulus, material.poisson_ratio)
    if state == "stress":
        lam = 2.0 * lam * mu / (lam + 2.0 * mu)
    return float(lam), float(mu)


def _scalar_element(body: BodyMesh) -> ElementTriP1 | ElementTriP2:
    return ElementTriP2() if body.order == 2 else ElementTriP1()


def curved_elements(body: BodyMesh) -> NDArray[np.bool_]:
    """Return which elements have a mid-side node off the middle of its edge, shape (elements,)."""
    mesh = body.mesh
    if not isinstance(mesh, MeshTri2):
        return np.zeros(mesh.t.shape[1], dtype=bool)
    ends = mesh.doflocs[:, mesh.facets]
    middles = 0.5 * (ends[:, 0] + ends[:, 1])
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=0)
    offset = np.linalg.norm(mesh.doflocs[:, mesh.nvertices :] - middles, axis=0)
    curved = offset > CURVED_OFFSET * length
    return np.asarray(np.any(curved[mesh.t2f], axis=0))


def assemble_stiffness(
    body: BodyMesh, material: Material, *, thickness: float, state: PlaneState = "strain"
) -> sp.csc_matrix:
    """Return the stiffness matrix, shape (2 nodes, 2 nodes), N/mm: symmetric, with the three rigid modes as null space.

    The thickness is in mm.
    """
    lam, mu = plane_lame_parameters(material, state)
    form, curved = linear_elasticity(thickness * lam, thickness * mu), curved_elements(body)
    # Curved elements cost twice as many points; they lie along the boundary only.
    parts = [
        form.assemble(Basis(body.mesh, ElementVector(_scalar_element(body)), elements=elements, intorder=order))
        for elements, order in (
            (np.flatnonzero(~curved), STRAIGHT_QUADRATURE),
            (np.flatnonzero(curved), CURVED_QUADRATURE),
        )
        if elements.size
    ]
    found = sp.csc_matrix(sum(parts[1:], parts[0]))
    found.sort_indices()
    return found


def first_order_space(body: BodyMesh) -> sp.csc_matrix:
    """Return the displacement of all nodes of a quadratic mesh by that of its vertices, mid-side nodes in the mean of the ends.

    What displaces so, linearly on the same curved elements, is a part of what quadratic elements can: every load does less work
    on it. Shape (unknowns, 2 vertices).
    """
    vertices, facets = body.mesh.nvertices, body.mesh.facets
    rows = np.concatenate([np.arange(vertices), np.tile(vertices + np.arange(facets.shape[1]), 2)])
    columns = np.concatenate([np.arange(vertices), *facets])
    nodes = sp.csr_matrix((np.where(rows < vertices, 1.0, 0.5), (rows, columns)), shape=(body.node_count, vertices))
    return sp.csc_matrix(sp.kron(nodes, np.eye(2)))


def rigid_modes(body: BodyMesh, centre: complex = 0j) -> FloatArray:
    """Return nodal displacements of unit translations in x and y and of a unit rotation about a centre, shape (2 nodes, 3)."""
    return modes_at(body.places - centre)


def modes_at(arms: ComplexArray) -> FloatArray:
    """Return the rigid modes at places relative to the centre of the rotation, shape (2 places, 3)."""
    modes = np.zeros((2 * len(arms), 3))
    modes[0::2, 0] = 1.0
    modes[1::2, 1] = 1.0
    modes[0::2, 2] = -arms.imag
    modes[1::2, 2] = arms.real
    return modes


def area_loads(body: BodyMesh, centre: complex = 0j) -> FloatArray:
    r"""Return nodal loads of body forces shaped like the rigid modes: :math:`\int N_i r_j\,dA`, shape (2 nodes, 3).

    Their transpose measures the area mean of a displacement (up to the Gram matrix
    ``rigid_modes(body).T @ area_loads(body)``); they also spread a reaction evenly over the body. Units are mm², mm² and mm³
    for a unit of body force.
    """
    loads = np.zeros((body.unknowns, 3))
    loads[0::2, 0] = loads[1::2, 1] = loads_by_nodes(body, lambda x, y: np.ones_like(x))
    loads[0::2, 2] = loads_by_nodes(body, lambda x, y: centre.imag - y)
    loads[1::2, 2] = loads_by_nodes(body, lambda x, y: x - centre.real)
    return loads


def loads_by_nodes(
    body: BodyMesh, density: Callable[[FloatArray, FloatArray], FloatArray], elements: IntArray | None = None
) -> FloatArray:
    r"""Return :math:`\int N_i f\,dA` of a density f(x, y) over some elements, all by default, shape (nodes,)."""
    element = ElementTriP2() if body.order == 2 else ElementTriP1()
    basis = Basis(body.mesh, element, elements=elements, intorder=CURVED_QUADRATURE)
    return np.asarray(LinearForm(lambda v, w: density(w.x[0], w.x[1]) * v).assemble(basis))


def unknowns_of_nodes(nodes: IntArray) -> IntArray:
    """Return the unknowns of nodes, both components of a node side by side, shape (2 nodes,)."""
    return np.asarray(2 * np.asarray(nodes)[..., None] + np.arange(2)).reshape(-1)


def unknowns_of_boundary(body: BodyMesh, name: str) -> IntArray:
    """Return all displacement unknowns on a named boundary; MeshError when the mesh has none of that name."""
    facets = body.require_boundary(name)
    nodes = np.unique(body.mesh.facets[:, facets])
    if body.order == 2:
        nodes = np.concatenate([nodes, body.mesh.nvertices + facets])
    return unknowns_of_nodes(nodes)


def strain_energy(stiffness: sp.csc_matrix, displacement: FloatArray) -> float:
    """Return ½ uᵀKu, N·mm, of nodal displacements of any shape that ravels to node-by-node order."""
    u = np.asarray(displacement).reshape(-1)
    return float(0.5 * u @ (stiffness @ u))


def traction_load(
    body: BodyMesh,
    boundary: str,
    traction: Traction,
    *,
    thickness: float,
) -> FloatArray:
    """Return the nodal forces of a traction on a named boundary, N, shape (2 nodes,).

    `traction` takes places (x, y) and outward normals, arrays of shape (2, …), mm, and returns tx, ty in MPa.
    """
    facets = body.require_boundary(boundary)
    basis = FacetBasis(body.mesh, ElementVector(_scalar_element(body)), facets=facets, intorder=2 * CURVED_QUADRATURE)

    def work(v, w):  # type: ignore[no-untyped-def]
        tx, ty = traction(w.x, w.n)
        return thickness * (tx * v[0] + ty * v[1])

    return np.asarray(LinearForm(work).assemble(basis))
