"""Uniform refinement: every triangle in four, every boundary edge in two, boundary nodes on the exact curves.

The mid-side nodes of a quadratic mesh become vertices. Vertices and mid-side nodes of the boundary lie on the exact curve, inner
edges are straight, as after `fem.mesh.triangulation`; so meshes refined from one mesh are a family with one grading and a ratio
of edges of exactly two, which extrapolation to edges of zero needs.
"""

from __future__ import annotations

import numpy as np

from fem.errors import MeshError
from fem.mesh.body_mesh import BodyMesh, triangle_mesh
from fem.mesh.boundary_division import DividedCurve, curve_middles
from fem.mesh.quality import require_quality
from fem.shapes import Curve

CHILDREN = 4
"""Triangles that each triangle is divided into."""


def refine_uniformly(body: BodyMesh, curves: tuple[Curve, ...]) -> BodyMesh:
    """Return the mesh of a body with every triangle divided into four.

    Parameters
    ----------
    body : BodyMesh
        Of quadratic triangles, in the frame of `curves`.
    curves : tuple of Curve
        Exact curves of all its boundaries.

    Returns
    -------
    BodyMesh
        The vertices of the given mesh come first, then its mid-side nodes, both at their places, as vertices.

    Raises
    ------
    MeshError
        For straight-sided elements of order 1, a curve without a boundary of its name, and when an element becomes too flat.
    """
    if body.order != 2:
        raise MeshError(f"mesh of {body.name} has elements of order {body.order}: only those of order 2 are refined")
    nodes = body.element_nodes
    first, second, third, between, beyond, last = nodes.T  # mid-sides of (0, 1), (1, 2), (2, 0)
    triangles = np.concatenate(
        [[first, between, last], [between, second, beyond], [last, beyond, third], [between, beyond, last]], axis=1
    )
    edges, divided = {}, {}
    for curve in curves:
        line = body.boundary_nodes(curve.name)
        own = line[:, :2].ravel()
        parameters = curve.parameter_of(body.places[own])
        # Ascending along the curve whichever way the boundary runs: neighbours are the ends of one edge.
        order = np.argsort(parameters)
        own, parameters = own[order], parameters[order]
        edges[curve.name] = np.column_stack([own, np.roll(own, -1)])
        divided[curve.name] = DividedCurve(curve=curve, parameters=parameters)
    mesh = triangle_mesh(body.mesh.doflocs, triangles, edges, order=2)
    refined = BodyMesh(name=body.name, mesh=curve_middles(mesh, tuple(divided.values())))
    refined.require_complete_boundaries()
    require_quality(refined)
    return refined
