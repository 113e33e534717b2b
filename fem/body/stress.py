r"""Stress recovery: from nodal displacements to nodal Cauchy stresses.

The strain of a quadratic triangle is most accurate at the three points of its degree-2 rule. The linear
function through those values is taken to the nodes and averaged there, weighted by area (Zienkiewicz &
Taylor, *The Finite Element Method*, 14: superconvergent points). At a contact read the pressure from the
contact unknowns instead: there the stress changes over less than an element.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from skfem import Basis, ElementTriP1, ElementTriP2, ElementVector

from fem.body.elasticity import PlaneState, plane_lame_parameters
from fem.mesh.body_mesh import BodyMesh
from ltca.arrays import FloatArray
from ltca.drive.parts import Material

SAMPLES = (np.array([[1.0, 4.0, 1.0], [1.0, 1.0, 4.0]]) / 6.0, np.full(3, 1.0 / 6.0))


@dataclass(frozen=True, slots=True, kw_only=True)
class Stress:
    """Cauchy stress at points, MPa, tension positive.

    Attributes
    ----------
    xx, yy, xy, zz : array
        Components; zz = ν(xx + yy) in plane strain, 0 in plane stress.
    """

    xx: FloatArray
    yy: FloatArray
    xy: FloatArray
    zz: FloatArray

    @property
    def principal(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Principal stresses, largest first, MPa."""
        middle, radius = 0.5 * (self.xx + self.yy), np.hypot(0.5 * (self.xx - self.yy), self.xy)
        ordered = np.sort(np.stack([middle + radius, middle - radius, self.zz]), axis=0)
        return ordered[2], ordered[1], ordered[0]

    @property
    def maximum_shear(self) -> FloatArray:
        """Half the difference of the outer principal stresses, MPa."""
        largest, _, smallest = self.principal
        return np.asarray(0.5 * (largest - smallest))

    @property
    def von_mises(self) -> FloatArray:
        """Equivalent stress of von Mises, MPa."""
        differences = (self.xx - self.yy) ** 2 + (self.yy - self.zz) ** 2 + (self.zz - self.xx) ** 2
        return np.sqrt(0.5 * differences + 3.0 * self.xy**2)


def stress_of_strain(
    exx: FloatArray, eyy: FloatArray, exy: FloatArray, material: Material, state: PlaneState = "strain"
) -> Stress:
    """Return the stress of plane strains (exy = ½γ) by Hooke's law."""
    lam, mu = plane_lame_parameters(material, state)
    volume = exx + eyy
    xx, yy = lam * volume + 2.0 * mu * exx, lam * volume + 2.0 * mu * eyy
    zz = material.poisson_ratio * (xx + yy) if state == "strain" else np.zeros_like(xx)
    return Stress(xx=xx, yy=yy, xy=2.0 * mu * exy, zz=zz)


def recover_stress(
    body: BodyMesh, displacement: FloatArray, material: Material, *, state: PlaneState = "strain"
) -> Stress:
    """Return stresses at the nodes, averaged over elements, shape (nodes,), of nodal displacements of shape (2 nodes,), mm."""
    order = body.order
    basis = Basis(body.mesh, ElementVector(ElementTriP2() if order == 2 else ElementTriP1()), quadrature=SAMPLES)
    gradient = np.asarray(basis.interpolate(displacement).grad)
    sampled = stress_of_strain(gradient[0, 0], gradient[1, 1], 0.5 * (gradient[0, 1] + gradient[1, 0]), material, state)
    x, y = SAMPLES[0]
    corners = np.array([[0, 1, 0, 0.5, 0.5, 0.0], [0, 0, 1, 0.0, 0.5, 0.5]])[:, : 6 if order == 2 else 3]
    # Linear through three samples: values at nodes = [1 ξ η]_nodes [1 ξ η]_samples⁻¹ samples.
    spread = np.column_stack([np.ones(corners.shape[1]), corners.T]) @ np.linalg.inv(
        np.column_stack([np.ones(3), x, y])
    )
    nodes = body.element_nodes
    weight = np.repeat(np.abs(np.asarray(basis.dx)).sum(axis=1)[:, None], nodes.shape[1], axis=1).ravel()
    total = np.bincount(nodes.ravel(), weights=weight, minlength=body.node_count)

    def averaged(values: FloatArray) -> FloatArray:
        at_nodes = (values @ spread.T).ravel()
        return np.asarray(np.bincount(nodes.ravel(), weights=weight * at_nodes, minlength=body.node_count) / total)

    xx, yy, xy = averaged(sampled.xx), averaged(sampled.yy), averaged(sampled.xy)
    zz = material.poisson_ratio * (xx + yy) if state == "strain" else np.zeros_like(xx)
    return Stress(xx=xx, yy=yy, xy=xy, zz=zz)
