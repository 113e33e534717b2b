r"""An extruded body: its unknowns, stiffness, rigid motions and loads.

Displacements are products of the shape functions of the cross-section and of the layers. Unknowns are numbered node by node of
the cross-section: all heights of u, then those of v, then those of w (`ExtrudedBody.unknowns_of`). The stiffness is a sum of
products of the integrals over the section and over the axis,

.. math:: K_{uu} = (\lambda + 2\mu) S_{xx} \otimes P + \mu S_{yy} \otimes P + \mu M \otimes P', \quad
          K_{uv} = (\lambda S_{xy} + \mu S_{yx}) \otimes P, \quad
          K_{uw} = \lambda G_x \otimes Q + \mu G_x^T \otimes Q', \quad
          K_{ww} = \mu (S_{xx} + S_{yy}) \otimes R + (\lambda + 2\mu) M \otimes R'

with the integrals over the axis of the shapes ψ in the plane and χ along the axis, :math:`P = \int\psi\psi`,
:math:`P' = \int\psi'\psi'`, :math:`Q = \int\psi\chi'`, :math:`Q' = \int\psi'\chi`, :math:`R = \int\chi\chi`,
:math:`R' = \int\chi'\chi'`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from skfem.models.elasticity import lame_parameters

from fem.solid.layers import Layers
from fem.solid.section import Section, SectionIntegrals, integrate_section
from ltca.arrays import FloatArray, IntArray
from ltca.drive.parts import Material

Density = Callable[[FloatArray], FloatArray]
"""Load by length along the axis at heights, 1/mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ExtrudedBody:
    """A cross-section along its layers.

    Attributes
    ----------
    section : Section
        Its plane mesh.
    layers : Layers
        Along the axis.
    """

    section: Section
    layers: Layers

    @property
    def counts(self) -> tuple[int, int]:
        """Unknown heights of u and of v, and of w, at every node of the section."""
        return self.layers.free_in_plane.size, self.layers.free_along_axis.size

    @property
    def per_node(self) -> int:
        """Unknowns at every node of the section."""
        return self.layers.unknowns_per_node

    @property
    def unknowns(self) -> int:
        """Number of unknowns."""
        return self.per_node * self.section.node_count

    def unknowns_of(self, nodes: IntArray, component: int) -> IntArray:
        """Return the unknowns of a component (0 u, 1 v, 2 w) at nodes of the section, shape (nodes, unknown heights)."""
        in_plane, axial = self.counts
        heights = np.arange(axial if component == 2 else in_plane)
        return np.asarray(np.asarray(nodes)[:, None] * self.per_node + component * in_plane + heights)

    def all_unknowns_of(self, nodes: IntArray) -> IntArray:
        """Return all unknowns of nodes of the section, node by node in the order given."""
        return np.asarray((np.asarray(nodes)[:, None] * self.per_node + np.arange(self.per_node)).ravel())

    def spread(self, plane: sp.spmatrix | FloatArray, density: Density) -> sp.csc_matrix:
        """Return loads of the section spread along the axis, shape (unknowns, loads).

        Parameters
        ----------
        plane : sparse matrix or array, shape (2 nodes, loads)
            Forces on the nodes of the section, x and y in turn, N.
        density : callable
            How they are spread along the axis, 1/mm, at heights, mm; of a force that is even along the thickness t it is 1/t.
        """
        along = self.layers.moments(density)[self.layers.free_in_plane]
        loads = sp.coo_matrix(plane)
        in_plane, _ = self.counts
        node, component = loads.row // 2, loads.row % 2
        rows = (node * self.per_node + component * in_plane)[:, None] + np.arange(in_plane)
        values = loads.data[:, None] * along
        columns = np.broadcast_to(loads.col[:, None], rows.shape)
        shape = (self.unknowns, loads.shape[1])
        return sp.csc_matrix((values.ravel(), (rows.ravel(), columns.ravel())), shape=shape)

    def rigid_motions(self) -> FloatArray:
        """Return the rigid motions of the class of displacements, shape (unknowns, motions).

        Symmetric: along x, y and about z; antisymmetric: along z, about x and about y; whole: all six in that order, mm by mm
        and mm by rad about the origin.
        """
        x, y = self.section.places
        heights = self.layers.heights
        z_plane, z_axis = heights[self.layers.free_in_plane], heights[self.layers.free_along_axis]
        one_plane, one_axis = np.ones(z_plane.size), np.ones(z_axis.size)
        none_plane, none_axis = np.zeros((x.size, z_plane.size)), np.zeros((x.size, z_axis.size))

        def motion(u: FloatArray, v: FloatArray, w: FloatArray) -> FloatArray:
            return np.concatenate([u, v, w], axis=1).ravel()

        even = [
            motion(np.outer(np.ones(x.size), one_plane), none_plane, none_axis),
            motion(none_plane, np.outer(np.ones(x.size), one_plane), none_axis),
            motion(-np.outer(y, one_plane), np.outer(x, one_plane), none_axis),
        ]
        odd = [
            motion(none_plane, none_plane, np.outer(np.ones(x.size), one_axis)),
            motion(none_plane, -np.outer(np.ones(x.size), z_plane), np.outer(y, one_axis)),
            motion(np.outer(np.ones(x.size), z_plane), none_plane, -np.outer(x, one_axis)),
        ]
        of_class = {"symmetric": even, "antisymmetric": odd, "whole": even + odd}[self.layers.parity]
        return np.stack(of_class, axis=1)

    def statically_determinate(self, nodes: tuple[int, int, int]) -> IntArray:
        """Return unknowns that hold a free body without straining it, at three nodes of the section that are not in line.

        Loads on the held unknowns would be lost: the nodes have to be free of loads.
        """
        first, second, third = nodes
        places = self.section.places
        span = places[:, second] - places[:, first]
        across = 1 if abs(span[0]) >= abs(span[1]) else 0
        lowest = [
            self.unknowns_of(np.array([first]), 0)[0, 0],
            self.unknowns_of(np.array([first]), 1)[0, 0],
            self.unknowns_of(np.array([second]), across)[0, 0],
        ]
        axial = [self.unknowns_of(np.array([node]), 2)[0, 0] for node in (first, second, third)]
        return np.array({"symmetric": lowest, "antisymmetric": axial, "whole": lowest + axial}[self.layers.parity])

    def mass_times(self, displacement: FloatArray) -> FloatArray:
        """Return ∫ N_i u dV: nodal loads of body forces shaped like displacements, shape (unknowns, k)."""
        found = integrate_section(self.section)
        size = (self.section.node_count,) * 2
        mass = sp.csr_matrix((found.mass, (found.rows, found.columns)), shape=size)
        along = _axis_integrals(self.layers)
        values = np.asarray(displacement).reshape(self.section.node_count, self.per_node, -1)
        of_axis = np.zeros((self.per_node, self.per_node))
        in_plane, _ = self.counts
        of_axis[:in_plane, :in_plane] = of_axis[in_plane : 2 * in_plane, in_plane : 2 * in_plane] = along["P"]
        of_axis[2 * in_plane :, 2 * in_plane :] = along["R"]
        moved = np.einsum("kl,nlj->nkj", of_axis, values)
        summed = mass @ moved.reshape(self.section.node_count, -1)
        return np.asarray(summed).reshape(self.unknowns, -1)

    def assemble_stiffness(self, material: Material) -> sp.csc_matrix:
        """Return the stiffness of the whole body in its class, N/mm, shape (unknowns, unknowns), sorted indices.

        Symmetric, with the rigid motions of the class as null space.
        """
        lam, mu = (float(each) for each in lame_parameters(material.youngs_modulus, material.poisson_ratio))
        found = integrate_section(self.section)
        return _sum_of_products(self, found, _products(found, _axis_integrals(self.layers), lam, mu))


def _axis_integrals(layers: Layers) -> dict[str, FloatArray]:
    """Integrals over the axis of products of shapes in the plane and along the axis, by the names of the equations."""
    _, weight, values, slopes = layers.points()
    in_plane, axial = layers.free_in_plane, layers.free_along_axis
    psi, dpsi, chi, dchi = values[:, in_plane], slopes[:, in_plane], values[:, axial], slopes[:, axial]

    def integral(left: FloatArray, right: FloatArray) -> FloatArray:
        return np.asarray((left * weight[:, None]).T @ right)

    return {
        "P": integral(psi, psi),
        "P'": integral(dpsi, dpsi),
        "Q": integral(psi, dchi),
        "Q'": integral(dpsi, chi),
        "R": integral(chi, chi),
        "R'": integral(dchi, dchi),
    }


Product = tuple[int, int, FloatArray, FloatArray]
"""Row and column component, values over the section, matrix over the axis."""


def _products(found: SectionIntegrals, along: dict[str, FloatArray], lam: float, mu: float) -> list[Product]:
    """The products of which the stiffness is the sum."""
    s, g, h, m = found.slopes, found.mixed, found.mixed_transposed, found.mass
    products: list[Product] = []
    for a in range(2):
        b = 1 - a
        products.append((a, a, (lam + 2.0 * mu) * s[a, a] + mu * s[b, b], along["P"]))
        products.append((a, a, mu * m, along["P'"]))
        products.append((a, b, lam * s[a, b] + mu * s[b, a], along["P"]))
        products.append((a, 2, lam * g[a], along["Q"]))
        products.append((a, 2, mu * h[a], along["Q'"]))
        products.append((2, a, lam * h[a], along["Q"].T))
        products.append((2, a, mu * g[a], along["Q'"].T))
    products.append((2, 2, mu * (s[0, 0] + s[1, 1]), along["R"]))
    products.append((2, 2, (lam + 2.0 * mu) * m, along["R'"]))
    return products


def _sum_of_products(body: ExtrudedBody, found: SectionIntegrals, products: list[Product]) -> sp.csc_matrix:
    in_plane, _ = body.counts
    size = (body.unknowns, body.unknowns)
    rows, columns, data = [], [], []
    for row in range(3):
        for column in range(3):
            own = [(values, matrix) for r, c, values, matrix in products if (r, c) == (row, column)]
            touched = np.any([matrix != 0.0 for _, matrix in own], axis=0)
            i, j = np.nonzero(touched)
            block = sum(values[:, None] * matrix[i, j] for values, matrix in own)
            rows.append((found.rows[:, None] * body.per_node + row * in_plane + i).astype(np.int32).ravel())
            columns.append((found.columns[:, None] * body.per_node + column * in_plane + j).astype(np.int32).ravel())
            data.append(np.asarray(block).ravel())
    matrix = sp.coo_matrix((np.concatenate(data), (np.concatenate(rows), np.concatenate(columns))), shape=size)
    return sp.csc_matrix(matrix)
