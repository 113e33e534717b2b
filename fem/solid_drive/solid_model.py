"""Condensed solid bodies with all pairs of a disc, and their contact problem at a pose.

To the motions of the plane (`fem.drive.model.DriveModel`) come, where anything leans, the tilts of the disc about x and y and
the lean of every roller in the plane of its ray and the axis. Gaps are linear in tilts and leans: normals and partners are
those of mid-width.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from fem.body.surface import OppositeZone
from fem.contact.coupling import PairIntegrals
from fem.contact.unilateral import ContactProblem
from fem.drive.contact_kinds import PairKind
from fem.drive.model import ContactPair, DrivePose, PlacedContacts
from fem.solid_contact.bodies import CondensedSolid
from fem.solid_contact.pressing import opening_of_motion, weighted_gap
from fem.solid_contact.reliefs import relief_of
from fem.solid_contact.widths import WidthGrid
from fem.solid_drive.along_width import DriveWidths, lean_apart
from ltca.arrays import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class SolidGroup:
    """Condensed pin or roller whose mesh serves several bodies, turned.

    Attributes
    ----------
    compliance : array
        By forces by length on the nodes of its zones, at every height of the pressure of its contacts.
    zones : tuple of OppositeZone
        One for a pin; outer and inner for a roller.
    unknowns : int
        Of its displacements, in all classes.
    """

    compliance: FloatArray
    zones: tuple[OppositeZone, ...]
    unknowns: int


@dataclass(frozen=True, slots=True, kw_only=True)
class SolidModel(PlacedContacts):
    """Solid bodies of one disc at one crank angle.

    Attributes
    ----------
    widths : DriveWidths
        Lengths and layers of the bodies.
    grids : dict
        Vertices of the pressure along the width, by kinds of contacts.
    disc : CondensedSolid
        Its faces are those of its pairs, in order. Of the other bodies the factors are not kept.
    disc_compliance, race_compliance : array
        By the pressures on both.
    race_unknowns : int
        Of the displacements of the race, in all classes.
    groups : tuple of SolidGroup
        Pins and rollers.
    """

    widths: DriveWidths
    grids: dict[PairKind, WidthGrid]
    disc: CondensedSolid
    disc_compliance: FloatArray
    race_compliance: FloatArray
    race_unknowns: int
    groups: tuple[SolidGroup, ...]

    @property
    def on_disc(self) -> int:
        """Number of pressure unknowns on the disc, the first of all."""
        return int(self.disc_compliance.shape[0])

    @property
    def solid_unknowns(self) -> int:
        """Displacement unknowns of all condensed bodies and classes, and pressures."""
        own = self.disc.unknowns + self.race_unknowns + sum(group.unknowns for group in self.groups)
        return own + self.unknown_count

    @property
    def motion_count(self) -> int:
        """Number of motions of a contact problem, with tilts unless all is even along the width."""
        straight = 4 + len(self.rollers)
        return straight if self.widths.even else straight + 2 + len(self.rollers)

    def opposite_zone(self, pair: ContactPair) -> OppositeZone | None:
        """Return the meshed zone opposite the pressure of a pair, None for a rigid circle."""
        return None if pair.group < 0 else self.groups[pair.group].zones[1 if pair.kind == "roller_inner" else 0]

    def pressures_of(self, pair: ContactPair, pressure: FloatArray) -> FloatArray:
        """Return the pressures of a pair over arc and height, MPa, shape (arc, heights), of all pressures."""
        return pressure[pair.unknowns].reshape(-1, pair.heights)

    def measure_of(self, pair: ContactPair, integral: PairIntegrals) -> FloatArray:
        """Return the weighted area of each pressure unknown of a pair, mm²."""
        return np.outer(integral.measure, self.grids[pair.kind].moments(np.ones_like)).ravel()

    def profile_of(self, pair: ContactPair, pressure: FloatArray) -> FloatArray:
        """Return the pressures of a pair along its arc at mid-width, of all pressures, MPa."""
        grid = self.grids[pair.kind]
        return self.pressures_of(pair, pressure)[:, 0 if grid.even else grid.size // 2]

    def resultants_of(self, pair: ContactPair, integral: PairIntegrals) -> FloatArray:
        """Return force (x, y, N) and moment about the origin (N·mm) on the round side by its pressures, MPa, shape (3, m)."""
        return np.asarray(np.kron(integral.force, self.grids[pair.kind].moments(np.ones_like)), dtype=float)

    def couple_of(self, pair: ContactPair, integral: PairIntegrals, pressure: FloatArray) -> complex:
        """Return ∫ z dF of the force on the round side of a pair, N·mm; zero where pressures are even."""
        grid = self.grids[pair.kind]
        if grid.even:
            return 0j
        fx, fy, _ = integral.force @ (self.pressures_of(pair, pressure) @ grid.moments(np.asarray))
        return complex(fx, fy)

    def disc_displacement(self, pressure: FloatArray) -> FloatArray:
        """Return the nodal displacements of the disc in its own frame, at mid-width, mm, at all pressures, MPa."""
        own = next(each for each in self.disc.classes if each.body.layers.parity == "symmetric")
        u = own.displacement(pressure[: self.on_disc])
        nodes = np.arange(own.body.section.node_count)
        return np.column_stack([u[own.body.unknowns_of(nodes, axis)[:, 0]] for axis in (0, 1)]).ravel()

    def strain_energy(self, pose: DrivePose, integrals: tuple[PairIntegrals, ...], pressure: FloatArray) -> float:
        """Return ½ pᵀSp of the pressures at a pose, N·mm: of all bodies, and of the springs of shaft pins."""
        problem = self.contact_problem(pose, list(integrals), 0.0)
        _, on_shaft, _ = self.forces_on_supports(pose, integrals)
        of_springs = float(np.sum((on_shaft @ pressure) ** 2)) / self.drive.hole_stiffness
        return 0.5 * (float(pressure @ problem.compliance @ pressure) + of_springs)

    def contact_problem(self, pose: DrivePose, integrals: list[PairIntegrals], wheel_moment: float) -> ContactProblem:
        """Return the condensed contact problem linearised about a pose.

        Motions: disc x, y (mm), rotation (rad), wheel rotation (rad), each candidate roller along its ray (mm); then, unless
        all is even along the width, tilts of the disc about x and y and the lean of each roller, rad, all of them whole, no
        increments.
        """
        count, rollers, first = self.unknown_count, self.rollers, self.on_disc
        compliance = np.zeros((count, count))
        compliance[:first, :first] = self.disc_compliance
        compliance[first:, first:] = self.race_compliance
        motions = np.zeros((count, self.motion_count))
        gap = np.zeros(count)
        centre = self.disc_pose(pose).centre
        of_rollers: dict[int, list[tuple[ContactPair, PairIntegrals]]] = {}
        for pair, integral in zip(self.pairs, integrals, strict=True):
            own, grid = pair.unknowns, self.grids[pair.kind]
            relief, kinks = relief_of(self.drive, pair.kind)
            gap[own] = weighted_gap(integral, grid, relief, kinks)
            fx, fy = (opening_of_motion(integral, grid, direction) for direction in (1.0 + 0.0j, 1j))
            moment = np.outer(integral.force[2], grid.moments(np.ones_like)).ravel()
            if pair.kind != "roller_inner":
                motions[own, 0], motions[own, 1] = -fx, -fy
                motions[own, 2] = -(moment - centre.real * fy + centre.imag * fx)
            if pair.kind == "pin":
                motions[own, 3] = moment
            elif pair.kind != "hole":
                ray = self.roller_rays[pair.index]
                motions[own, 4 + rollers.index(pair.index)] = fx * ray.real + fy * ray.imag
                of_rollers.setdefault(pair.index, []).append((pair, integral))
            if pair.kind in ("pin", "hole") and pair.group >= 0:
                loads = self._on_nodes(pair, integral)
                compliance[own, own] += loads.T @ (loads.T @ self.groups[pair.group].compliance).T
            if not self.widths.even:
                self._lean(pair, integral, pose, gap, motions)
        for (outer, outer_integral), (inner, inner_integral) in of_rollers.values():
            own = np.r_[outer.unknowns, inner.unknowns]
            loads = sp.block_diag([self._on_nodes(outer, outer_integral), self._on_nodes(inner, inner_integral)], "csr")
            compliance[np.ix_(own, own)] += loads.T @ (loads.T @ self.groups[outer.group].compliance).T
        external = np.zeros(motions.shape[1])
        external[3] = -wheel_moment
        return ContactProblem(compliance=compliance, gap=gap, motions=motions, external=external)

    def _lean(
        self, pair: ContactPair, integral: PairIntegrals, pose: DrivePose, gap: FloatArray, motions: FloatArray
    ) -> None:
        """Add to gaps what stands inclined, and to motions the tilts of the disc and the lean of the roller of a pair."""
        own, grid, straight = pair.unknowns, self.grids[pair.kind], 4 + len(self.rollers)
        fx, fy = (opening_of_motion(integral, grid, direction, np.asarray) for direction in (1.0 + 0.0j, 1j))
        lean = lean_apart(self, pair, pose)
        gap[own] += fx * lean.real + fy * lean.imag
        if pair.kind != "roller_inner":
            # A tilt about x moves the upper end of the disc towards −y, one about y towards +x.
            motions[own, straight], motions[own, straight + 1] = fy, -fx
        if pair.kind in ("roller_outer", "roller_inner"):
            ray = self.roller_rays[pair.index]
            motions[own, straight + 2 + self.rollers.index(pair.index)] = fx * ray.real + fy * ray.imag

    def _on_nodes(self, pair: ContactPair, integral: PairIntegrals) -> sp.csr_matrix:
        """Forces by length on the nodes opposite at every height by the pressures of a pair."""
        return sp.csr_matrix(sp.kron(sp.csr_matrix(integral.opposite_loads), sp.identity(pair.heights)))
