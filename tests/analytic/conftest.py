"""Blocks with a flat top for contact benchmarks; the drive's own bodies are all round."""

from dataclasses import dataclass

import numpy as np
import pytest
from skfem import MeshTri1, MeshTri2

from fem.mesh.body_mesh import BodyMesh


@dataclass(frozen=True)
class FlatCurve:
    """The line y = 0 with the body below it; the parameter is x."""

    name: str = "perimeter"
    encloses_body: bool = True

    def points(self, parameter):
        return np.asarray(parameter) + 0j

    def normals(self, parameter):
        return np.full(np.shape(parameter), 1j)

    def curvature_radius(self, parameter):
        return np.full(np.shape(parameter), np.inf)

    def parameter_of(self, point):
        return np.asarray(point).real


def graded(near, far, size, growth):
    """Places from 0 to `far`: edges of `size` up to `near`, then growing by a factor."""
    count = max(round(near / size), 1)
    places = list(np.linspace(0.0, near, count + 1))
    step = near / count
    while places[-1] + growth * step < far:
        step *= growth
        places.append(places[-1] + step)
    if places[-1] == near < far:
        places.append(far)
    places = np.array(places)
    outer = places > near
    if np.any(outer):
        places[outer] = near + (places[outer] - near) * (far - near) / (places[-1] - near)
    return places


def make_block(half_width, height, size, *, zone, growth=1.25, depth=None, name="block"):
    """Mesh a block below y = 0 with edges of `size` within `zone` of the origin; a node at `depth` if given."""
    side = graded(zone, half_width, size, growth)
    down = graded(zone, height, size, growth)
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
    doflocs = np.hstack([linear.p, middles])
    curved = MeshTri2(doflocs, linear.t, sort_t=False, validate=False)
    return BodyMesh(name=name, mesh=curved.with_boundaries({"perimeter": facets, "bottom": bottom}))


@pytest.fixture(scope="session")
def block_of():
    return make_block


@pytest.fixture(scope="session")
def flat():
    return FlatCurve()
