"""How flanges tilt at the ends of their posts: thin plates by finite elements against the strips of `ltca.laws.carrier`."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import Basis, BilinearForm, ElementTriMorley, MeshTri, condense, solve
from skfem.helpers import dd, ddot, eye, trace

from fem.mesh.gmsh_session import gmsh_model
from ltca.laws.carrier import flange_compliance

MODULUS, RATIO, THICKNESS = 206e3, 0.3, 10.0
WITHIN = 0.3
"""Of the plate: what strips of an assumed width leave out of its outline."""


def plate(radius, posts, size, outer, inner):
    """A flange with its posts as regions of the mesh."""
    with gmsh_model("flange") as gmsh:
        occ = gmsh.model.occ
        whole = [(2, occ.addDisk(0.0, 0.0, 0.0, outer, outer))]
        occ.cut(whole, [(2, occ.addDisk(0.0, 0.0, 0.0, inner, inner))])
        places = radius * np.exp(2j * np.pi * np.arange(posts) / posts)
        bosses = [(2, occ.addDisk(place.real, place.imag, 0.0, 0.5 * size, 0.5 * size)) for place in places]
        occ.fragment(occ.getEntities(2), bosses)
        occ.synchronize()
        gmsh.option.setNumber("Mesh.MeshSizeMax", 3.0)
        gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", 32)
        gmsh.model.mesh.generate(2)
        tags, points, _ = gmsh.model.mesh.getNodes()
        triangles = gmsh.model.mesh.getElementsByType(2)[1].reshape(-1, 3)
    order = np.argsort(tags)
    corners = order[np.searchsorted(tags[order], triangles)]
    used = np.unique(corners)
    return MeshTri(
        np.ascontiguousarray(points.reshape(-1, 3)[used, :2].T), np.ascontiguousarray(np.searchsorted(used, corners).T)
    )


def tilt(radius, posts, size, outer, inner):
    """Rotation of the posts by their moments, all alike along the circle, of a plate with free edges."""
    mesh, rigidity = plate(radius, posts, size, outer, inner), MODULUS * THICKNESS**3 / (12.0 * (1.0 - RATIO**2))
    basis = Basis(mesh, ElementTriMorley(), intorder=4)

    @BilinearForm
    def bending(u, v, _):
        moment = rigidity * ((1.0 - RATIO) * dd(u) + RATIO * eye(trace(dd(u)), 2))
        return ddot(moment, dd(v))

    stiffness = bending.assemble(basis)
    places = radius * np.exp(2j * np.pi * np.arange(posts) / posts)
    at = mesh.p[0] + 1j * mesh.p[1]
    nearest = np.argmin(np.abs(at - places[:, None]), axis=0)
    ahead = 1j * places[nearest] / radius
    held = np.flatnonzero(np.abs(at - places[nearest]) < 0.5 * size * (1.0 + 1e-6))
    facets = np.flatnonzero(np.isin(mesh.facets, held).all(axis=0))
    # What the elements hold of the planes x and y: slopes across edges in their own sense.
    planes = [basis.project(lambda x, axis=axis: x[axis]) for axis in (0, 1)]
    for each in planes:
        assert abs(float(each @ (stiffness @ each))) < 1e-8 * rigidity  # round-off of places of 50 mm
    across = planes[0][basis.facet_dofs[0]] + 1j * planes[1][basis.facet_dofs[0]]
    given = np.zeros(basis.N)
    given[basis.nodal_dofs[0, held]] = ((at - places[nearest]) * ahead.conj()).real[held]
    given[basis.facet_dofs[0, facets]] = (across * ahead[mesh.facets[0]].conj()).real[facets]
    fixed = np.concatenate([basis.nodal_dofs[0, held], basis.facet_dofs[0, facets]])
    found = solve(*condense(stiffness, x=given, D=fixed))
    return posts / float(found @ (stiffness @ found))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("radius", "posts", "size", "outer", "inner"),
    [
        (42.0, 6, 16.0, 55.0, 20.0),
        (42.0, 3, 20.0, 56.0, 20.0),
        (42.0, 4, 12.0, 55.0, 25.0),
        (38.0, 4, 12.0, 50.0, 12.0),
    ],
)
def test_a_flange_tilts_as_a_plate_does(radius, posts, size, outer, inner):
    strips = flange_compliance(THICKNESS, posts, radius, size, MODULUS)
    assert strips == pytest.approx(tilt(radius, posts, size, outer, inner), rel=WITHIN)
