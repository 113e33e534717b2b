"""Stress along a meshed boundary, from recovered nodal stresses."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem.body.stress import Stress
from fem.mesh.body_mesh import BodyMesh
from fem.shapes import Curve
from ltca.arrays import ComplexArray, FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class WallStress:
    """Stress along a boundary at its nodes.

    Attributes
    ----------
    name : str
        Of the boundary.
    parameter : array, shape (nodes,)
        Of the boundary curve, increasing in [0, 2π), rad.
    points : array of complex, shape (nodes,)
        Frame of the body, mm.
    stress : array, shape (nodes,)
        Along the wall, tension positive, MPa.
    """

    name: str
    parameter: FloatArray
    points: ComplexArray
    stress: FloatArray

    def at(self, parameter: FloatArray) -> FloatArray:
        """Return the stress at parameters of the curve, linear between nodes, MPa."""
        return np.asarray(np.interp(parameter, self.parameter, self.stress, period=2.0 * np.pi))


def stress_along_wall(body: BodyMesh, stress: Stress, curve: Curve) -> WallStress:
    """Return the stress along a boundary at vertices and mid-side nodes; tangents are those of the exact curve."""
    nodes = body.boundary_nodes(curve.name)[:, :2].ravel()
    points = body.mesh.doflocs[0, nodes] + 1j * body.mesh.doflocs[1, nodes]
    parameter = curve.parameter_of(points)
    order = np.argsort(parameter)
    nodes, points, parameter = nodes[order], points[order], parameter[order]
    tangent = 1j * curve.normals(parameter)
    x, y = tangent.real, tangent.imag
    along = stress.xx[nodes] * x**2 + 2.0 * stress.xy[nodes] * x * y + stress.yy[nodes] * y**2
    return WallStress(name=curve.name, parameter=parameter, points=points, stress=along)
