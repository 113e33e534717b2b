"""Normal approach influence coefficients of the bodies of a drive, derived by finite elements.

Every approach is the pressure-weighted mean over a patch of the displacement into the body along the inward
normal at the middle of the patch, for each newton on a patch (`fem.coefficients.patch_loads`). The patches are far wider
than a contact: the near field of a contact is known in closed form, and what finite elements add to it is
smooth in the place and does not depend on the width. So a mesh far coarser than that of a contact serves.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import reduce
from operator import add
from typing import Any

import numpy as np
import scipy.sparse as sp

from fem.body.condensation import SYMMETRIC, condense_body, statically_determinate
from fem.body.elasticity import (
    PlaneState,
    area_loads,
    assemble_stiffness,
    first_order_space,
    modes_at,
    rigid_modes,
    unknowns_of_boundary,
)
from fem.body.free_body import boundary_motion_loads
from fem.body.influence import LoadInfluence, influence_of_loads
from fem.body.joined_parts import JoinedBody, Part, join_parts, motions_of_copy, of_first_order
from fem.body.sparse_factor import factor_sparse
from fem.coefficients.patch_loads import patch_loads
from fem.coefficients.stations import RACE_ANGLES, STRESS_PER_STATION, DiscStations, patch_half_width
from fem.coefficients.wall_strain import continue_under_patches, wall_modulus, wall_strain_measures
from fem.errors import MeshError
from fem.mesh.body_mesh import BodyMesh
from fem.mesh.boundary_division import MAX_TURN
from fem.mesh.disc_parts import SAME_NODE, Cells, DiscPart, lobe_count, mesh_disc_parts
from fem.mesh.element_size import Refinement, SizeField
from fem.mesh.memory_need import require_memory, solution_memory
from fem.mesh.triangulation import default_coarse_size, estimate_unknowns, mesh_circle, mesh_ring, size_field
from fem.shapes import CircleShape, DiscShape, RingShape
from ltca.arrays import ComplexArray, FloatArray, IntArray
from ltca.drive.parts import Material
from ltca.output.resources import available_memory, derivation_memory
from ltca.reading.coefficient_laws import project_rigid_motions

# Element edge at a patch for its half-width, and growth of the edge by distance, on a mesh of size 1. Measured on
# the paper's disc: 0.3 % of the largest entry between this size and twice it, 0.05 % between it and half of it.
EDGE_SHARE = 0.4
GROWTH = 0.4
# Of the error of quadratic elements in units of the near field, by the square of what linear ones miss beside them: 0.035 to 0.09
# on discs, 0.12 to 0.27 on pins, rollers and races, measured against finer meshes (docs/theory/coefficients.md).
DISC_ERROR, ROUND_ERROR = 0.12, 0.3
# Of the largest error of a stress, by the largest difference of both: 0.08 to 0.13 measured likewise, 0.37 with a quarter of the
# stations at twice the size.
STRESS_ERROR_SHARE = 0.4
# Pins, rollers and race are small: a mesh of half the size costs nothing.
ROUND_SIZE = 0.5
# Elements stay small to this distance from the middle of a patch, in half-widths.
REFINED_RADIUS = 1.2
# Some stations also get a patch twice as wide: both together show the closed form of the near field.
WIDE_RATIO = 2.0
# Stations whose displacement is solved for once more, to measure reciprocity by another way than the matrix.
RECIPROCITY_SAMPLES = 12
# Faster growth distorts triangles (smallest angle below 15° on one of six random discs at 1.0).
MAX_GROWTH = 0.7
# Beyond this the edges are longer than the patches are wide.
MAX_SIZE = 4.0


@dataclass(frozen=True, slots=True, kw_only=True)
class DerivedDisc:
    """Coefficients of the disc.

    Attributes
    ----------
    approach : array, shape (stations, stations)
        mm/N, relative to the best-fit rigid motion of all bores together, symmetric positive semidefinite.
    resultants : array, shape (3, stations)
        Force in x, in y (N) and moment (N·mm) of each unit load on the mesh.
    wide_stations : array of int, shape (w,)
        Stations that also carry a patch twice as wide.
    wide_approach : array, shape (w,)
        Approach of the wide patch by its own load, mm/N.
    stress : array, shape (stress stations, stations)
        Stress along the wall at each stress station (`DiscStations.refined`) by a newton at each station, tension
        positive, MPa/N; without what a patch does right under itself
        (`fem.coefficients.wall_strain.continue_under_patches`).
    error : float
        Estimate of the error of the mesh, of the largest approach without rigid motions.
    stress_error : float
        Estimate of the error of the mesh in the stresses, of the largest.
    reciprocity : float
        Largest difference of "displacement at i by j" and "at j by i", of the largest approach.
    rigid_residual : float
        What is left of rigid motions of the disc once that of the bores is removed, and of the difference
        between two datums once rigid motions are projected out; the larger of both, relative.
    unknowns : int
        Of the mesh.
    """

    approach: FloatArray
    resultants: FloatArray
    wide_stations: IntArray
    wide_approach: FloatArray
    stress: FloatArray
    error: float
    stress_error: float
    reciprocity: float
    rigid_residual: float
    unknowns: int


@dataclass(frozen=True, slots=True, kw_only=True)
class DerivedRound:
    """Coefficients of a pin, a roller or the inner race.

    Attributes
    ----------
    approach : array
        mm/N; shape (1, 1) for a pin, (2, 2) for a roller (inner, outer), (angles,) for the race.
    half_width : float
        Half-width of the patches, mm.
    wide_approach : float
        Approach of a patch twice as wide by its own load, mm/N.
    error : float
        Estimate of the error of the mesh, of the largest approach.
    reciprocity : float
        Relative, as for the disc.
    mirror : float
        Largest difference of "at +φ" and "at −φ" on the race before their mean is taken, of the largest approach;
        that of both ends of a roller; an error of the mesh. 0 for a pin.
    unknowns : int
        Of the mesh.
    """

    approach: FloatArray
    half_width: float
    wide_approach: float
    error: float
    reciprocity: float
    mirror: float
    unknowns: int


def _refinements(points: ComplexArray, half_width: float, size: float) -> list[Refinement]:
    edge = EDGE_SHARE * size * half_width
    return [Refinement(float(point.real), float(point.imag), edge, REFINED_RADIUS * half_width) for point in points]


def require_element_size(size: float, largest: float = MAX_SIZE) -> None:
    """Raise MeshError for a multiple of the default element edge that is not positive or above the largest."""
    if not (np.isfinite(size) and 0.0 < size <= largest):
        raise MeshError(
            f"size = {size:g} (--size): must be greater than 0 and at most {largest:g}, element edge by the default one"
        )


def edge_growth(size: float) -> float:
    """Return the growth of edges by distance on a mesh of a size."""
    return min(GROWTH * size, MAX_GROWTH)


def estimate_disc_unknowns(shape: DiscShape, stations: DiscStations, size: float) -> int:
    """Return about how many unknowns the disc's mesh has; `size` is a multiple of all element edges and of their growth."""
    refinements = _refinements(stations.points, float(stations.half_width.min()), size)
    coarse = default_coarse_size(shape, size)
    return estimate_unknowns(shape, refinements, coarse_size=coarse, growth=edge_growth(size))


def require_disc_memory(shape: DiscShape, stations: DiscStations, size: float = 1.0, processes: int = 1) -> None:
    """Raise MemoryLimitError when the disc's mesh and solution would not fit into memory shared by some processes."""
    unknowns = estimate_disc_unknowns(shape, stations, size)
    in_cells = any(0 in cells.walls for cells in stations.cells(shape))
    needed = derivation_memory(lobe_count(shape), size) if in_cells else solution_memory(unknowns)
    what = "the disc for its influence coefficients"
    require_memory(unknowns, needed, what, available=available_memory() / processes)


def derive_disc(
    shape: DiscShape,
    stations: DiscStations,
    material: Material,
    *,
    thickness: float,
    state: PlaneState = "strain",
    size: float = 1.0,
) -> DerivedDisc:
    """Derive the coefficients of the disc, all contacts coupled.

    Thickness in mm; `size` is a multiple of the element edges. MeshError when that is out of bounds or meshing fails,
    MemoryLimitError when mesh and solution would not fit into memory.
    """
    require_element_size(size)
    require_disc_memory(shape, stations, size)
    cells, places = stations.cells(shape), stations.refined(shape)
    parts = mesh_disc_parts(shape, disc_size_field(shape, stations, size), cells)
    count, wide = stations.count, stations.wide(cells)
    loads = _DiscLoads(
        shape=shape,
        stations=stations,
        places=places,
        cells=[part.cells for part in parts.parts],
        wide=wide,
        modulus=wall_modulus(material, state),
    )
    options: dict[str, Any] = {"thickness": thickness, "state": state}
    core = loads.core(parts.core, assemble_stiffness(parts.core, material, **options))
    copied = [loads.part(each, assemble_stiffness(each.mesh, material, **options)) for each in parts.parts]
    same = SAME_NODE * shape.flank.profile.tip_radius
    joined = join_parts(core, copied, same)
    core = of_first_order(core, parts.core)
    copied = [of_first_order(part, each.mesh) for part, each in zip(copied, parts.parts, strict=True)]
    sampled = np.unique(np.linspace(0, count - 1, RECIPROCITY_SAMPLES).astype(int))
    pressed, strained, datums = loads.pressed, loads.strained, loads.datums(joined.loads.shape[1], parts.parts)
    influence = _influence(joined, datums, sampled)
    placed, wider = slice(0, count), slice(count, pressed.start)
    rim_approach, approach = influence.in_every_datum(placed)
    resultants = influence.resultants[:, placed]
    reciprocity = np.max(np.abs(influence.sampled[placed] - rim_approach[:, sampled])) / np.max(np.abs(approach))

    modes, by_bores = modes_at(joined.places), (joined.loads @ datums[1]).toarray()
    left = joined.loads[:, placed].T @ modes - resultants.T @ np.linalg.solve(modes.T @ by_bores, by_bores.T @ modes)
    balanced = project_rigid_motions(approach, resultants)
    largest = float(np.max(np.abs(balanced)))
    rest = np.max(np.abs(balanced - project_rigid_motions(rim_approach, resultants))) / largest
    del balanced, rim_approach
    wide_approach, work = influence.own(wider, datum=1), influence.own(placed, datum=1)
    stress = influence.block(strained, pressed, datum=1)
    unknowns = joined.unknowns
    del influence, joined
    linear = _influence(join_parts(core, copied, same), datums, sampled[:1])
    some = loads.of_first_cells()
    apart = np.abs(stress[some] - linear.block(strained.start + some, pressed, datum=1))
    # What stands at a place under its own patch is replaced by what is beside it.
    apart[np.abs(places.points[some][:, None] - stations.points) < same] = 0.0
    stress = continue_under_patches(stress, places.boundary, stations.boundary)
    return DerivedDisc(
        approach=approach,
        resultants=resultants,
        wide_stations=wide,
        wide_approach=wide_approach,
        stress=stress,
        error=error_of_quadratic(work - linear.own(placed, datum=1), near_field(material, thickness, state), DISC_ERROR)
        / largest,
        stress_error=STRESS_ERROR_SHARE * float(np.max(apart) / np.max(np.abs(stress))),
        reciprocity=float(reciprocity),
        rigid_residual=float(max(np.max(np.abs(left)) / np.max(np.abs(resultants)), rest)),
        unknowns=unknowns,
    )


def _influence(joined: JoinedBody, datums: Sequence[sp.csc_matrix], sampled: IntArray) -> LoadInfluence:
    return influence_of_loads(joined.places, joined.stiffness, joined.loads, datums, sampled, beyond=joined.held)


def near_field(material: Material, thickness: float, state: PlaneState) -> float:
    """Return k = 2/(πE't), the unit of the near field, mm/N."""
    return 2.0 / (np.pi * wall_modulus(material, state) * thickness)


def error_of_quadratic(work: FloatArray, unit: float, factor: float) -> float:
    """Return an estimate of the largest error of approaches by quadratic elements, mm/N.

    `work` is the work, twice, of each load on quadratic elements less that on linear ones, mm/N: the square of their distance in
    energy, which goes with the square of the size of the elements, that from the exact solution with its fourth power. No entry
    is more in error than the worst on the diagonal (Cauchy and Schwarz).
    """
    return float(factor * np.max(work) ** 2 / unit)


def disc_size_field(shape: DiscShape, stations: DiscStations, size: float = 1.0) -> SizeField:
    """Return the size field of a disc with stations; `size` is a multiple of all element edges and of their growth."""
    refinements = tuple(_refinements(stations.points, float(stations.half_width.min()), size))
    return size_field(shape, refinements, default_coarse_size(shape, size), edge_growth(size), MAX_TURN)


@dataclass(frozen=True, slots=True, kw_only=True)
class _DiscLoads:
    """Loads on a disc, part by part, and their numbers.

    First come the patches of all stations, then the wide ones, pressures, and what measures the strain at the stress stations;
    then forces in the form of the rigid motions: along the outside of the core, and along the bores of the core or of each cell.
    """

    shape: DiscShape
    stations: DiscStations
    places: DiscStations
    cells: list[Cells]
    wide: IntArray
    modulus: float

    @property
    def pressed(self) -> slice:
        """Numbers of the pressures."""
        first = self.stations.count + len(self.wide)
        return slice(first, first + self.stations.count)

    @property
    def strained(self) -> slice:
        """Numbers of what measures strains."""
        return slice(self.pressed.stop, self.pressed.stop + self.places.count)

    @property
    def by_rim(self) -> IntArray:
        """Numbers of the forces along the outside of the core."""
        return np.asarray(self.strained.stop + np.arange(3))

    def by_bores(self, copy: int = 0) -> IntArray:
        """Numbers of the forces along the bores of a copy of their cells, or of the core."""
        return np.asarray(self.strained.stop + 3 * (copy + 1) + np.arange(3))

    def are_bores(self, wall: int) -> bool:
        """Whether a wall is that of a bore."""
        return 0 < wall <= len(self.shape.bores)

    def core(self, mesh: BodyMesh, stiffness: sp.csc_matrix) -> Part:
        """Return the core with the loads on it."""
        elsewhere = {wall for each in self.cells for wall in each.walls}
        loads, numbers = [boundary_motion_loads(mesh, mesh.boundary_names[0])], [self.by_rim]
        motions = []
        for wall, curve in enumerate(self.shape.curves):
            if wall in elsewhere:
                continue
            own, seen = (np.flatnonzero(each.boundary == wall) for each in (self.stations, self.places))
            wide = own[np.isin(own, self.wide)]
            loads.append(self._on_wall(mesh, wall, own, seen, wide))
            numbers.append(self._numbers(own, seen, wide))
            if self.are_bores(wall):
                motions.append(boundary_motion_loads(mesh, curve.name))
        if motions:
            loads.append(reduce(add, motions))
            numbers.append(self.by_bores())
        return Part(
            stiffness=stiffness,
            places=mesh.places,
            loads=sp.hstack(loads, format="csc"),
            shared=np.arange(mesh.node_count),
            turns=np.ones(1, dtype=complex),
            shifts=np.zeros(1, dtype=complex),
            numbers=np.concatenate(numbers)[None],
        )

    def part(self, part: DiscPart, stiffness: sp.csc_matrix) -> Part:
        """Return copies of a cell with the loads on them."""
        cells, wall, numbers = part.cells, part.cells.walls[0], []
        along_bores = self.are_bores(wall)
        for copy in range(len(part.turns)):
            own, seen = (
                self.stations.of_cell(cells, copy),
                self.places.of_cell(cells, copy, STRESS_PER_STATION if wall else 1),
            )
            wide = own[len(own) - len(own) // 2 - 1 :][:1]
            if copy == 0:
                loads = [self._on_wall(part.mesh, wall, own, seen, wide)]
            numbers.append([self._numbers(own, seen, wide), *([self.by_bores(copy)] if along_bores else [])])
        if along_bores:
            loads.append(boundary_motion_loads(part.mesh, self.shape.curves[wall].name, part.wall_edges))
        return Part(
            stiffness=stiffness,
            places=part.mesh.places,
            loads=sp.hstack(loads, format="csc"),
            shared=part.shared,
            turns=part.turns,
            shifts=part.shifts,
            numbers=np.array([np.concatenate(each) for each in numbers]),
        )

    def of_first_cells(self) -> IntArray:
        """Return the stress stations of the core and of the first cell of each wall, which stand for all others."""
        walls = [each.walls[0] for each in self.cells]
        firsts = [
            self.places.of_cell(each, 0, STRESS_PER_STATION if wall else 1)
            for wall, each in zip(walls, self.cells, strict=True)
        ]
        elsewhere = [wall for each in self.cells for wall in each.walls]
        return np.sort(np.concatenate([*firsts, np.flatnonzero(~np.isin(self.places.boundary, elsewhere))]))

    def datums(self, count: int, parts: Sequence[DiscPart]) -> list[sp.csc_matrix]:
        """Return the amounts of so many loads that are the forces of both datums: outside of the core, bores."""
        bores = [part for part in parts if self.are_bores(part.cells.walls[0])]
        turns = [(turn, shift) for part in bores for turn, shift in zip(part.turns, part.shifts, strict=True)] or [
            (1.0, 0.0)
        ]
        by_bores = [motions_of_copy(complex(turn), complex(shift)) for turn, shift in turns]
        rows = np.concatenate([self.by_bores(copy) for copy in range(len(turns))])
        first = sp.csc_matrix((np.ones(3), (self.by_rim, np.arange(3))), shape=(count, 3))
        columns = np.tile(np.arange(3), len(rows))
        return [first, sp.csc_matrix((np.vstack(by_bores).ravel(), (np.repeat(rows, 3), columns)), shape=(count, 3))]

    def _on_wall(self, mesh: BodyMesh, wall: int, own: IntArray, seen: IntArray, wide: IntArray) -> sp.csc_matrix:
        """Return the loads of some stations and stress stations on a wall of a mesh."""
        curve, at, width = self.shape.curves[wall], self.stations.parameter, self.stations.half_width
        return sp.hstack(
            [
                patch_loads(mesh, curve, at[own], width[own]),
                patch_loads(mesh, curve, at[wide], WIDE_RATIO * width[wide]),
                # Stresses beside a patch feel which way it presses, and contacts press along the normals.
                patch_loads(mesh, curve, at[own], width[own], along_normals=True),
                # What measures the strain of a wall is a load that balances itself: its row of the compliance holds, by
                # reciprocity, that strain under every patch. One factorisation serves both.
                self.modulus
                * wall_strain_measures(mesh, curve, self.places.parameter[seen], self.places.half_width[seen]),
            ],
            format="csc",
        )

    def _numbers(self, own: IntArray, seen: IntArray, wide: IntArray) -> IntArray:
        """Return the numbers of the loads of some stations and stress stations; -1 of wide patches that are not wanted."""
        place = np.minimum(np.searchsorted(self.wide, wide), len(self.wide) - 1)
        wider = np.where(self.wide[place] == wide, self.stations.count + place, -1)
        return np.concatenate([own, wider, self.pressed.start + own, self.strained.start + seen])


def derive_pin(
    shape: CircleShape, material: Material, *, thickness: float, state: PlaneState = "strain", size: float = 1.0
) -> DerivedRound:
    """Derive the coefficient of a wheel pin whose rigid core is held; parameters as for `derive_disc`."""
    return _derive_round(shape, [0.0], material, thickness, state, size, held="core")[0]


def derive_roller(
    shape: CircleShape, material: Material, *, thickness: float, state: PlaneState = "strain", size: float = 1.0
) -> DerivedRound:
    """Derive the coefficients of a free roller at two places opposite each other (inner, outer).

    Area-mean displacement and mean rotation are removed, unit loads balanced by uniform body force; parameters as
    for `derive_disc`.
    """
    return _derive_round(shape, [np.pi, 0.0], material, thickness, state, size)[0]


def derive_race(
    shape: RingShape,
    material: Material,
    *,
    thickness: float,
    state: PlaneState = "strain",
    size: float = 1.0,
    angles: int = RACE_ANGLES,
) -> DerivedRound:
    """Derive the approach of the inner race at uniform angles from a unit load; its bore is held.

    The ring has no preferred direction, so one load is enough; parameters as for `derive_disc`.
    """
    result, body, displacement = _derive_round(shape, [0.0], material, thickness, state, size, held="inner")
    parameters = 2.0 * np.pi * np.arange(angles) / angles
    everywhere = patch_loads(body, shape.curves[0], parameters, result.half_width)
    measured = np.asarray(everywhere.T @ displacement[:, 0])
    # Reciprocity and the symmetry of the ring make "at +φ" and "at −φ" one number; the mesh has neither symmetry.
    mirrored = np.roll(measured[::-1], 1)
    mirror = float(np.max(np.abs(measured - mirrored)) / np.max(np.abs(measured)))
    return replace(result, approach=0.5 * (measured + mirrored), mirror=mirror)


def _derive_round(
    shape: CircleShape | RingShape,
    angles: list[float],
    material: Material,
    thickness: float,
    state: PlaneState,
    size: float,
    held: str = "",
) -> tuple[DerivedRound, BodyMesh, FloatArray]:
    """Return the coefficients at polar angles, the mesh and the nodal displacements under the unit loads.

    The last load is a patch twice as wide at the first angle; `held` is a boundary that does not move.
    """
    places = np.array(angles)
    body, width = _mesh_round(shape, places, size)
    curve = shape.curves[0]
    wide = patch_loads(body, curve, places[:1], WIDE_RATIO * width)
    loads = sp.hstack([patch_loads(body, curve, places, width), wide], format="csc")
    stiffness = assemble_stiffness(body, material, thickness=thickness, state=state)
    condensed = condense_body(body, stiffness, loads, fixed=unknowns_of_boundary(body, held) if held else None)
    compliance, displacement = condensed.compliance, condensed.displacement(np.eye(len(places) + 1))
    measured = np.asarray(loads.T @ displacement)
    work = np.diag(compliance) - _first_order_work(body, stiffness, loads, held)
    error = error_of_quadratic(work[: len(places)], near_field(material, thickness, state), ROUND_ERROR)
    result = DerivedRound(
        approach=compliance[: len(places), : len(places)],
        half_width=width,
        wide_approach=float(compliance[-1, -1]),
        error=error / float(np.max(compliance[: len(places), : len(places)])),
        reciprocity=float(np.max(np.abs(measured - compliance.T)) / np.max(np.abs(compliance))),
        mirror=float(np.ptp(np.diag(compliance)[: len(places)]) / np.max(compliance)),
        unknowns=body.unknowns,
    )
    return result, body, displacement


def _first_order_work(body: BodyMesh, stiffness: sp.csc_matrix, loads: sp.csc_matrix, held: str) -> FloatArray:
    """Return the work, twice, of each load on linear elements of a mesh, balanced by body forces where nothing is held, mm/N."""
    space, force = first_order_space(body), loads.toarray()
    if held:
        fixed = unknowns_of_boundary(body, held)
    else:
        modes, area = rigid_modes(body), area_loads(body)
        force -= area @ np.linalg.solve(modes.T @ area, modes.T @ force)
        fixed = statically_determinate(body.mesh.doflocs.T[: body.mesh.nvertices], loads[: space.shape[1]])
    free = np.setdiff1d(np.arange(space.shape[1]), fixed)
    inner = (space.T @ stiffness @ space)[free][:, free]
    factor = factor_sparse(sp.csc_matrix(inner), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=SYMMETRIC)
    acting = (space.T @ force)[free]
    return np.asarray(np.sum(acting * factor.solve(acting), axis=0))


def _mesh_round(shape: CircleShape | RingShape, angles: FloatArray, size: float) -> tuple[BodyMesh, float]:
    require_element_size(size)
    finer = ROUND_SIZE * size
    width = patch_half_width(shape)
    refinements = _refinements(shape.curves[0].points(angles), width, finer)
    coarse = default_coarse_size(shape, finer)
    if isinstance(shape, RingShape):
        return mesh_ring(shape, refinements, coarse_size=coarse, growth=edge_growth(finer)), width
    return mesh_circle(shape, refinements, coarse_size=coarse, growth=edge_growth(finer)), width
