r"""What the coefficients of solid bodies are beyond those of plane strain, derived on extruded meshes.

Each contact has a load even along the width, :math:`q = 1/t`, and one linear in z, :math:`q = 12 z/t^3`; the same vectors measure
the mean approach (mm/N) and the tilt (rad/(N mm)). Within a distance well below the thickness both feel the near field of plane
strain, the linear one :math:`12/t^2` times it. So the coefficients are

.. math:: C = C_\mathrm{strain} + D, \qquad C' = \frac{12}{t^2} C_\mathrm{strain} + D',

with those of plane strain from a mesh that is fine at every patch (`fem.coefficients.bodies`), and differences that are smooth:
D and D' are taken between a solid and a plane body of one and the same section mesh, where the error of the near field is in both
and drops out. A section mesh that resolves walls and lobes, but no patch, serves.

A plane displacement with :math:`w = 0` is one of the displacements that a solid body may have, in the finite elements as in the
continuum, and the stress of plane stress is in equilibrium in the solid body: under even loads that balance,

.. math:: F^T C_\mathrm{strain} F \le F^T C F \le F^T C_\mathrm{stress} F,

the left exactly on the mesh, the right but for the error of the mesh.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from skfem.models.elasticity import lame_parameters

from fem.body.condensation import order_nodes, statically_determinate, unloaded_nodes
from fem.body.elasticity import rigid_modes
from fem.coefficients.pieces import Pieces
from fem.mesh.body_mesh import BodyMesh
from fem.solid.extruded import ExtrudedBody
from fem.solid.factor import SymmetricFactor
from fem.solid.layers import Parity, graded_layers
from fem.solid.section import Section, SectionIntegrals, integrate_section
from ltca.arrays import FloatArray, IntArray
from ltca.drive.parts import Material

# Right-hand sides that are solved for together.
BLOCK = 64


@dataclass(frozen=True, slots=True, kw_only=True)
class Support:
    """How a body is held.

    Attributes
    ----------
    held : array of int, shape (nodes,)
        Nodes of the section that do not move, at any height.
    balance : array or None, shape (2 nodes, 3)
        Forces shaped like the rigid modes, which measure the datum of a free body and balance its loads; None where nodes are
        held.
    """

    held: IntArray
    balance: FloatArray | None


def solve_plane(
    body: BodyMesh,
    found: SectionIntegrals,
    support: Support,
    loads: sp.csc_matrix,
    measures: sp.csc_matrix,
    *,
    material: Material,
    thickness: float,
    state: str,
) -> FloatArray:
    """Return what measures see of a plane body under loads, shape (measures, loads), on the integrals of its solid's section."""
    lam, mu = (float(each) for each in lame_parameters(material.youngs_modulus, material.poisson_ratio))
    if state == "stress":
        lam = 2.0 * lam * mu / (lam + 2.0 * mu)
    s = found.slopes
    rows, columns, data = [], [], []
    for a in range(2):
        for b in range(2):
            own = (lam + 2.0 * mu) * s[a, a] + mu * s[1 - a, 1 - a] if a == b else lam * s[a, b] + mu * s[b, a]
            rows.append(2 * found.rows + a)
            columns.append(2 * found.columns + b)
            data.append(thickness * own)
    size = (body.unknowns,) * 2
    matrix = sp.csc_matrix((np.concatenate(data), (np.concatenate(rows), np.concatenate(columns))), shape=size)
    fixed = np.zeros(body.unknowns, dtype=bool)
    if support.balance is None:
        fixed[(2 * support.held[:, None] + np.arange(2)).ravel()] = True
        balance = None
    else:
        fixed[statically_determinate(body.mesh.doflocs.T, loads)] = True
        balance = rigid_modes(body), support.balance
    unknowns = (2 * order_nodes(body)[:, None] + np.arange(2)).ravel()
    factor = SymmetricFactor(matrix, unknowns[~fixed[unknowns]], many_loads=True)
    return _measured(factor, loads, measures, balance, lambda done: None)


def solve_solid(
    body: BodyMesh,
    support: Support,
    loads: sp.csc_matrix,
    measures: sp.csc_matrix,
    *,
    material: Material,
    thickness: float,
    layers: int,
    parity: Parity,
    also: Callable[[ExtrudedBody], sp.csc_matrix] | None = None,
    advance: Callable[[int], None] = lambda done: None,
) -> FloatArray:
    """Return what measures see of a solid body under even ("symmetric") or linear loads ("antisymmetric").

    Parameters
    ----------
    body : BodyMesh
        The section.
    support : Support
        How it is held.
    loads, measures : csc_matrix, shapes (2 nodes, n) and (2 nodes, m)
        Of the section, spread along the thickness.
    material : Material
        Of the body.
    thickness : float
        Of the body, mm.
    layers : int
        Over half of it.
    parity : {"symmetric", "antisymmetric"}
        Of the displacements.
    also : callable, optional
        Gives further measures of the extruded body, which balance themselves.
    advance : callable
        Told how many loads are solved for so far.

    Returns
    -------
    array, shape (measures, loads)
    """
    solid = ExtrudedBody(section=Section.of_body(body), layers=graded_layers(thickness, layers, parity))
    density = solid.layers.unit_load
    spread, measured = solid.spread(loads, density), solid.spread(measures, density)
    fixed = np.zeros(solid.unknowns, dtype=bool)
    if support.balance is None:
        fixed[solid.all_unknowns_of(support.held)] = True
        balance = None
    else:
        fixed[solid.statically_determinate(unloaded_nodes(solid.section.places.T, loads))] = True
        # Forces in the plane alone balance linear loads: the datum is the tilt of u and v, whatever w does.
        modes, shapes = (slice(0, 3), slice(0, 3)) if parity == "symmetric" else (slice(1, 3), slice(0, 2))
        balance = solid.rigid_motions()[:, modes], solid.spread(support.balance[:, shapes], density).toarray()
    unknowns = solid.all_unknowns_of(order_nodes(body))
    factor = SymmetricFactor(solid.assemble_stiffness(material), unknowns[~fixed[unknowns]], many_loads=True)
    if also is None:
        return _measured(factor, spread, measured, balance, advance)
    return _measured(factor, spread, measured, balance, advance, also(solid))


def _measured(
    factor: SymmetricFactor,
    loads: sp.csc_matrix,
    measures: sp.csc_matrix,
    balance: tuple[FloatArray, FloatArray] | None,
    advance: Callable[[int], None],
    also: sp.csc_matrix | None = None,
) -> FloatArray:
    """What measures see under loads, both balanced by forces of given shapes (modes, shapes), block after block."""
    count = loads.shape[1]
    found = np.empty((measures.shape[1] + (0 if also is None else also.shape[1]), count))
    back = None
    if balance is not None:
        modes, shapes = balance
        gram = modes.T @ shapes
        back = np.linalg.solve(gram, np.asarray((measures.T @ modes).T))
    for first in range(0, count, BLOCK):
        own = slice(first, min(first + BLOCK, count))
        right = loads[:, own].toarray()
        if balance is not None:
            right -= shapes @ np.linalg.solve(gram, modes.T @ right)
        moved = factor.solve(right)
        seen = np.asarray(measures.T @ moved)
        if back is not None:
            seen -= back.T @ (shapes.T @ moved)
        found[: len(seen), own] = seen
        if also is not None:
            found[len(seen) :, own] = also.T @ moved
        advance(own.stop)
    return found


@dataclass(frozen=True, slots=True, kw_only=True)
class Differences:
    """What a solid body has beyond plane strain, on one section mesh; shapes (measures, loads) with those of the wall last.

    Attributes
    ----------
    even : array
        C − C_strain, mm/N.
    linear : array
        C' − 12/t² C_strain, rad/(N mm).
    flat : array
        C_stress − C_strain, mm/N.
    strain : array, shape (places, loads)
        Of walls along themselves: mean along the thickness less that of plane strain, with ν times the mean strain along the
        axis, for each newton.
    unknowns : int
        Of the solid body, in each class.
    """

    even: FloatArray
    linear: FloatArray
    flat: FloatArray
    strain: FloatArray
    unknowns: int


@dataclass(frozen=True, slots=True, kw_only=True)
class SolidOptions:
    """How a solid body is derived.

    Attributes
    ----------
    thickness : float
        Of the body, mm.
    layers : int
        Over half of it.
    tell : callable
        Called with what is being done.
    pieces : Pieces
        What is done already.
    """

    thickness: float
    layers: int
    tell: Callable[[str], None]
    pieces: Pieces


@dataclass(frozen=True, slots=True, kw_only=True)
class Wall:
    """Measures of the strain of walls that carry nothing there.

    Attributes
    ----------
    strains : csc_matrix, shape (2 nodes, places)
        Along the wall (`fem.coefficients.wall_strain.wall_strain_measures`).
    values : csc_matrix, shape (nodes, places)
        Of nodal values at the places.
    """

    strains: sp.csc_matrix
    values: sp.csc_matrix

    def measures(self, poisson_ratio: float) -> Callable[[ExtrudedBody], sp.csc_matrix]:
        """Return what measures, on an extruded body, the mean strains along the walls with ν times those along the axis."""

        def of(solid: ExtrudedBody) -> sp.csc_matrix:
            thickness = solid.layers.thickness
            along = solid.spread(self.strains, solid.layers.unit_load)
            values = sp.coo_matrix(self.values)
            # w is odd in z: the mean of its slope is w at the end by half of the thickness.
            ends = solid.unknowns_of(values.row, 2)[:, -1]
            weights = 2.0 * poisson_ratio / thickness * values.data
            return sp.csc_matrix(along + sp.csc_matrix((weights, (ends, values.col)), shape=along.shape))

        return of


def solid_differences(
    name: str,
    body: BodyMesh,
    support: Support,
    loads: sp.csc_matrix,
    measures: sp.csc_matrix,
    material: Material,
    options: SolidOptions,
    wall: Wall | None = None,
) -> Differences:
    """Derive what a solid body has beyond plane strain, both classes one after the other, each kept when it is done."""
    found, thickness = integrate_section(Section.of_body(body)), options.thickness
    places = 0 if wall is None else wall.strains.shape[1]
    seen = measures if wall is None else sp.hstack([measures, wall.strains], format="csc")
    same: dict[str, Any] = {"material": material, "thickness": thickness}
    strain, stress = (
        solve_plane(body, found, support, loads, seen, state=state, **same) for state in ("strain", "stress")
    )
    count, nu = measures.shape[1], material.poisson_ratio

    def solve(parity: Parity, words: str) -> FloatArray:
        def compute() -> FloatArray:
            options.tell(f"{name}, {words} loads")
            return solve_solid(
                body,
                support,
                loads,
                measures,
                layers=options.layers,
                parity=parity,
                also=None if wall is None or parity != "symmetric" else wall.measures(nu),
                advance=lambda done: options.tell(f"{name}, {words} loads: {done} of {loads.shape[1]}"),
                **same,
            )

        return options.pieces.get(f"{name}-{words}".replace(", ", "-").replace(" ", "-"), compute)

    even, linear = solve("symmetric", "even"), solve("antisymmetric", "linear")
    per_node = graded_layers(thickness, options.layers, "symmetric").unknowns_per_node
    return Differences(
        even=even[:count] - strain[:count],
        linear=linear - 12.0 / thickness**2 * strain[:count],
        flat=stress[:count] - strain[:count],
        strain=even[count:] - strain[count:] if places else np.zeros((0, loads.shape[1])),
        unknowns=per_node * body.node_count,
    )
