r"""A body reduced to the pressures on its faces, class by class; held or floating.

A face is a set of plane loads, one for each hat of the pressure along the arc, times the hats of a `WidthGrid`. With
the loads B of all faces and the stiffness K of a class, the contact needs :math:`S = B^T K^{-1} B` and the resultants
of the loads on the rigid motions of a floating body. A body that is its own mirror image in z = 0 is solved in its
symmetric class, and in the antisymmetric one as well where pressures are not even: half the unknowns each.

A floating body is held at unknowns that just hold it, its loads are balanced by body forces shaped like its rigid
motions, and its displacement is relative to the rigid motion of its volume mean, as in the plane
(`fem.body.condensation`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from fem.body.condensation import unloaded_nodes
from fem.errors import MeshError
from fem.solid.extruded import ExtrudedBody
from fem.solid.factor import SymmetricFactor
from fem.solid.layers import Layers, Parity
from fem.solid.order import order_unknowns
from fem.solid.section import Section
from fem.solid_contact.widths import WidthGrid
from ltca.arrays import BoolArray, FloatArray
from ltca.drive.parts import Material

BLOCK = 128
"""Right-hand sides solved together: as many as fill the processor's matrix products, few beside the factor."""

MANY_LOADS = 128
"""Right-hand sides of a class from which on their time, and not that of the factor, counts."""

Held = Callable[[ExtrudedBody], BoolArray]
"""Which unknowns of a body in its class are held at zero."""

Probes = Callable[[ExtrudedBody], sp.spmatrix]
"""Weights of the unknowns of a body in its class in displacements to be known of it later, shape (probes, unknowns)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Face:
    """Where pressure acts on a body.

    Attributes
    ----------
    plane : sparse matrix, shape (2 nodes, m)
        Forces by length on the nodes of the section, x and y in turn, of a unit of each hat of the pressure along the
        arc, N/mm by MPa.
    width : WidthGrid
        Hats along the width.
    """

    plane: sp.spmatrix
    width: WidthGrid

    @property
    def size(self) -> int:
        """Number of pressure unknowns: arc by arc, all heights of each."""
        return int(self.plane.shape[1]) * self.width.size


@dataclass(frozen=True, slots=True, kw_only=True)
class CondensedClass:
    """One class of a body reduced to the loads of its faces.

    Attributes
    ----------
    body : ExtrudedBody
        The body in its class.
    compliance : array, shape (m, m)
        Displacement measured by load i for a unit of load j, mm·mm².
    resultants : array, shape (motions, m)
        Work of each load on each rigid motion of a floating body; (0, m) for a held one.
    loads : csc_matrix, shape (unknowns, m)
        Of the faces in this class.
    onto_class : sparse matrix, shape (m, pressures)
        From the pressures of all faces to the loads of the class.
    stiffness : csc_matrix, shape (unknowns, unknowns)
        Of the body.
    """

    body: ExtrudedBody
    compliance: FloatArray
    resultants: FloatArray
    loads: sp.csc_matrix
    onto_class: sp.csr_matrix
    stiffness: sp.csc_matrix
    _factor: SymmetricFactor
    _balance: tuple[FloatArray, FloatArray] | None

    def displacement(self, pressures: FloatArray) -> FloatArray:
        """Return the displacement of all unknowns under the pressures of all faces, MPa; (pressures,) gives (unknowns,)."""
        return _solve(self._factor, self.loads @ (self.onto_class @ pressures)[:, None], self._balance)[:, 0]

    def energy(self, displacement: FloatArray) -> float:
        """Return the strain energy of a displacement, N·mm."""
        return float(0.5 * displacement @ (self.stiffness @ displacement))


@dataclass(frozen=True, slots=True, kw_only=True)
class CondensedSolid:
    """A body reduced to the pressures on its faces.

    Attributes
    ----------
    faces : tuple of Face
        In the order of their pressures.
    classes : tuple of CondensedClass
        Symmetric, or symmetric and antisymmetric, or whole; none of a body without its factors.
    compliance : array, shape (pressures, pressures)
        Weighted gap opened by a unit of each pressure, mm·mm² by MPa.
    unknowns : int
        Displacements of all classes.
    probed : array, shape (probes, pressures)
        Displacements at the probes of all classes, one class after the other, by a unit of each pressure.
    """

    faces: tuple[Face, ...]
    classes: tuple[CondensedClass, ...]
    compliance: FloatArray
    unknowns: int
    probed: FloatArray

    @property
    def motions(self) -> FloatArray:
        """Weighted gap opened by each `ExtrudedBody.rigid_motions`, class after class, shape (pressures, motions)."""
        return np.concatenate([each.onto_class.T @ each.resultants.T for each in self.classes], axis=1)

    def energy(self, pressures: FloatArray) -> float:
        """Return the strain energy of the displacements under pressures, by the stiffness, N·mm."""
        return sum(each.energy(each.displacement(pressures)) for each in self.classes)


def condense_solid(
    section: Section,
    layers: Sequence[Layers],
    material: Material,
    faces: Sequence[Face],
    held: Held | None,
    progress: Callable[[str], None] = lambda _: None,
    *,
    probes: Probes | None = None,
    keep_factors: bool = True,
) -> CondensedSolid:
    """Factorise a body in its classes and reduce it to the pressures on its faces.

    Parameters
    ----------
    section : Section
        Cross-section.
    layers : sequence of Layers
        Those of every class that is wanted: symmetric alone where all pressures are even, else symmetric and
        antisymmetric, or whole.
    material : Material
        Elastic constants.
    faces : sequence of Face
        Where pressures act.
    held : callable, optional
        Which unknowns are held; None for a floating body.
    progress : callable, optional
        Is told each class.
    probes : callable, optional
        Displacements to be known when the factors are gone.
    keep_factors : bool
        Whether other displacements and the energy by the stiffness can be asked for; else one class is in memory at a time.

    Raises
    ------
    MeshError
        Where classes and widths do not go together.
    """
    needed = {parity for face in faces for parity in _class_matrices(face.width, layers)}
    given = {each.parity for each in layers}
    if missing := needed - given:
        raise MeshError(
            f"{section.name}: pressures need the class {sorted(missing)[0]!r}, of which no layers are given"
        )
    found, unknowns, measured = [], 0, [np.zeros((0, sum(face.size for face in faces)))]
    compliance = np.zeros((measured[0].shape[1],) * 2)
    for each in layers:
        progress(f"{section.name}, {each.parity}")
        body = ExtrudedBody(section=section, layers=each)
        wanted = sp.csr_matrix((0, body.unknowns) if probes is None else probes(body))
        own, at_probes = _condense_class(body, material, faces, held, layers, wanted)
        compliance += np.asarray(own.onto_class.T @ (own.onto_class.T @ own.compliance).T)
        measured.append(np.asarray((own.onto_class.T @ at_probes.T).T))
        unknowns += body.unknowns
        if keep_factors:
            found.append(own)
        del own
    return CondensedSolid(
        faces=tuple(faces),
        classes=tuple(found),
        compliance=0.5 * (compliance + compliance.T),
        unknowns=unknowns,
        probed=np.concatenate(measured),
    )


def spread_face(body: ExtrudedBody, face: Face) -> sp.csc_matrix:
    """Return the loads of a face on a body in its class, shape (unknowns, arc hats · class hats)."""
    along, plane = sp.coo_matrix(face.width.onto(body.layers)), sp.coo_matrix(face.plane)
    in_plane, _ = body.counts
    base = plane.row // 2 * body.per_node + plane.row % 2 * in_plane
    rows = base[:, None] + along.row
    columns = plane.col[:, None] * along.shape[1] + along.col
    values = plane.data[:, None] * along.data
    shape = (body.unknowns, plane.shape[1] * along.shape[1])
    return sp.csc_matrix((values.ravel(), (rows.ravel(), columns.ravel())), shape=shape)


def _class_matrices(width: WidthGrid, layers: Sequence[Layers]) -> dict[Parity, FloatArray]:
    if any(each.parity == "whole" for each in layers):
        return {"whole": np.eye(width.size)}
    return width.classes()


def _condense_class(
    body: ExtrudedBody,
    material: Material,
    faces: Sequence[Face],
    held: Held | None,
    layers: Sequence[Layers],
    probes: sp.csr_matrix,
) -> tuple[CondensedClass, FloatArray]:
    """The body in one class, and its displacements at probes by a unit of each load of the class."""
    parity = body.layers.parity
    parts, onto = [], []
    for face in faces:
        matrices = _class_matrices(face.width, layers)
        arcs = face.plane.shape[1]
        if parity in matrices:
            parts.append(spread_face(body, face))
            onto.append(sp.kron(sp.identity(arcs), sp.csr_matrix(matrices[parity])))
        else:
            onto.append(sp.csr_matrix((0, face.size)))
    loads = sp.csc_matrix(sp.hstack(parts)) if parts else sp.csc_matrix((body.unknowns, 0))
    stiffness = body.assemble_stiffness(material)
    balance = None
    if held is None:
        motions = body.rigid_motions()
        balance = (motions, body.mass_times(motions))
        still = np.zeros(body.unknowns, dtype=bool)
        plane = sp.hstack([face.plane for face in faces]) if faces else sp.coo_matrix((2 * body.section.node_count, 0))
        still[body.statically_determinate(unloaded_nodes(body.section.places.T, plane))] = True
    else:
        still = held(body)
    unknowns = order_unknowns(body)
    count = loads.shape[1]
    factor = SymmetricFactor(stiffness, unknowns[~still[unknowns]], many_loads=count > MANY_LOADS)
    compliance, probed = np.zeros((count, count)), np.zeros((probes.shape[0], count))
    transposed = loads.T.tocsr()
    for first in range(0, count, BLOCK):
        own = slice(first, first + BLOCK)
        moved = _solve(factor, loads[:, own].toarray(), balance)
        compliance[:, own], probed[:, own] = transposed @ moved, probes @ moved
    resultants = np.zeros((0, count)) if balance is None else np.asarray((loads.T @ balance[0]).T)
    condensed = CondensedClass(
        body=body,
        compliance=0.5 * (compliance + compliance.T),
        resultants=resultants,
        loads=loads,
        onto_class=sp.csr_matrix(sp.block_diag(onto)),
        stiffness=stiffness,
        _factor=factor,
        _balance=balance,
    )
    return condensed, probed


def _solve(factor: SymmetricFactor, forces: FloatArray, balance: tuple[FloatArray, FloatArray] | None) -> FloatArray:
    """Displacements under forces; of a floating body under balanced ones, without its volume-mean rigid motion."""
    if balance is None:
        return factor.solve(forces)
    motions, mass = balance
    inertia = motions.T @ mass
    found = factor.solve(forces - mass @ np.linalg.solve(inertia, motions.T @ forces))
    return np.asarray(found - motions @ np.linalg.solve(inertia, mass.T @ found))
