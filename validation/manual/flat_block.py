"""Blocks with a flat top for contact problems; the bodies of a drive are all round."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from skfem import MeshTri1, MeshTri2

from fem.mesh.body_mesh import BodyMesh
from ltca.arrays import ComplexArray, FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class FlatCurve:
    """The line y = 0 with the body below it; the parameter is x.

    Attributes
    ----------
    name : str
        Of the boundary.
    encloses_body : bool
        Whether the body is on the inner side.
    """

    name: str = "perimeter"
    encloses_body: bool = True

    @property
    def samples(self) -> int:
        """How many parameters resolve a line."""
        return 2

    @property
    def corners(self) -> tuple[float, ...]:
        """None: the corners of a block are nodes of its mesh."""
        return ()

    def points(self, parameter: ArrayLike) -> ComplexArray:
        """Return points at parameters, mm."""
        return np.asarray(parameter) + 0j

    def normals(self, parameter: ArrayLike) -> ComplexArray:
        """Return unit normals out of the body."""
        return np.full(np.shape(parameter), 1j)

    def curvature_radius(self, parameter: ArrayLike) -> FloatArray:
        """Return radii of curvature, infinite."""
        return np.full(np.shape(parameter), np.inf)

    def parameter_of(self, point: ArrayLike) -> FloatArray:
        """Return the parameters of the nearest points."""
        return np.asarray(np.asarray(point).real)


FLAT = FlatCurve()


def mesh_block(
    half_width: float,
    height: float,
    size: float,
    *,
    zone: float,
    growth: float = 1.25,
    depth: float | None = None,
    name: str = "block",
) -> BodyMesh:
    """Mesh a block below y = 0 by quadratic triangles in rows and columns.

    Parameters
    ----------
    half_width, height : float
        mm.
    size : float
        Edges within `zone` of the origin, mm.
    zone : float
        mm.
    growth : float
        Of the edges beyond.
    depth : float, optional
        Where a row of nodes shall lie, mm.
    name : str
        Of the body.
    """
    side = _graded(zone, half_width, size, growth)
    down = _graded(zone, height, size, growth)
    if depth is not None:
        down[np.argmin(np.abs(down - depth))] = depth
    mesh = MeshTri1.init_tensor(np.concatenate([-side[:0:-1], side]), -down[::-1])
    vertices, triangles = mesh.p, mesh.t
    p, q, r = (vertices[:, triangles[k]] for k in range(3))
    area = (q[0] - p[0]) * (r[1] - p[1]) - (r[0] - p[0]) * (q[1] - p[1])
    triangles = np.where(area > 0.0, triangles, triangles[[0, 2, 1]])
    linear = MeshTri1(vertices, triangles, sort_t=False, validate=False)
    facets = linear.boundary_facets()
    middles = linear.p[:, linear.facets].mean(axis=1)
    bottom = facets[np.abs(middles[1, facets] + height) < 1e-9]
    curved = MeshTri2(np.hstack([linear.p, middles]), linear.t, sort_t=False, validate=False)
    return BodyMesh(name=name, mesh=curved.with_boundaries({"perimeter": facets, "bottom": bottom}))


def _graded(near: float, far: float, size: float, growth: float) -> FloatArray:
    """Places from 0 to `far`: edges of `size` up to `near`, then growing by a factor."""
    count = max(round(near / size), 1)
    places = list(np.linspace(0.0, near, count + 1))
    step = near / count
    while places[-1] + growth * step < far:
        step *= growth
        places.append(places[-1] + step)
    if places[-1] == near < far:
        places.append(far)
    found = np.array(places)
    outer = found > near
    if np.any(outer):
        found[outer] = near + (found[outer] - near) * (far - near) / (found[-1] - near)
    return found
