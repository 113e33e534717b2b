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
from fem.drive.contact_kinds import PairKind
from fem.drive.model import ContactPair, DrivePose, PlacedContacts
from fem.solid_contact.bodies import CondensedSolid
from fem.solid_contact.pressing import opening_of_motion, weighted_gap
from fem.solid_contact.reliefs import relief_of
from fem.solid_contact.widths import WidthGrid
from fem.solid_drive.along_width import DriveWidths, lean_apart
from ltca.arrays import ComplexArray, FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class SolidRound:
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
    disc, race, groups
        Solid bodies without their factors. Probes of the disc: fit of its bores (x, y, rotation), x and y of each of
        `probed_places`; unless all is even along the width, the fit of what is linear along it.
    probed_places : array of complex, shape (n,)
        Nodes at mid-width on the walls of the disc where no contact is expected, mm.
    """

    widths: DriveWidths
    grids: dict[PairKind, WidthGrid]
    disc: CondensedSolid
    race: CondensedSolid
    groups: tuple[SolidRound, ...]
    probed_places: ComplexArray

    @property
    def displacement_count(self) -> int:
        """Number of displacement unknowns of all condensed bodies and classes."""
        return self.disc.unknowns + self.race.unknowns + sum(group.unknowns for group in self.groups)

    @property
    def motion_count(self) -> int:
        """Number of motions of a contact problem, with tilts unless all is even along the width."""
        straight = 4 + len(self.rollers)
        return straight if self.widths.even else straight + 2 + len(self.rollers)

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

    def bore_fit(self, pressure: FloatArray) -> FloatArray:
        """Return x, y (mm) and rotation (rad) by deformation of the disc at its bores, mean of the width, its own frame."""
        return np.asarray(self.disc.probed[:3] @ pressure[: self.on_disc])

    def wall_displacements(self, points: ComplexArray, pressure: FloatArray) -> ComplexArray:
        """Return the displacements of the disc, in its frame, at its probed nodes next to points, at mid-width, mm."""
        nearest = 3 + 2 * np.argmin(np.abs(self.probed_places[:, None] - points), axis=0)
        along_x, along_y = (self.disc.probed[nearest + axis] @ pressure[: self.on_disc] for axis in (0, 1))
        return np.asarray(along_x + 1j * along_y)

    def add_leans(
        self, pair: ContactPair, integral: PairIntegrals, pose: DrivePose, gap: FloatArray, motions: FloatArray
    ) -> None:
        """Add to gaps what stands inclined, and to motions the tilts of the disc and the lean of the roller of a pair.

        Tilts of the disc are about x and y; all of these motions are whole, no increments.
        """
        if self.widths.even:
            return
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

    def gap_of(self, pair: ContactPair, integral: PairIntegrals) -> FloatArray:
        """Return the weighted gap of each pressure unknown of a pair whose sides are parallel, mm·mm²."""
        return weighted_gap(integral, self.grids[pair.kind], *relief_of(self.drive, pair.kind))

    def loads_opposite(self, pair: ContactPair, integral: PairIntegrals) -> sp.spmatrix:
        """Return forces by length on the nodes opposite at every height by the pressures of a pair."""
        return sp.kron(sp.csr_matrix(integral.opposite_loads), sp.identity(pair.heights))
