"""Normal approach influence coefficients of the bodies of a drive, derived by finite elements.

Every approach is the pressure-weighted mean over a patch of the displacement into the body along the inward
normal at the middle of the patch, for each newton on a patch (`fem.coefficients.patch_loads`). The patches are far wider
than a contact: the near field of a contact is known in closed form, and what finite elements add to it is
smooth in the place and does not depend on the width. So a mesh far coarser than that of a contact serves.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import reduce
from operator import add

import numpy as np
import scipy.sparse as sp

from fem.body.condensation import condense_body
from fem.body.elasticity import PlaneState, area_loads, assemble_stiffness, rigid_modes, unknowns_of_boundary
from fem.body.free_body import boundary_motion_loads
from fem.body.influence import influence_of_loads
from fem.coefficients.patch_loads import patch_loads
from fem.coefficients.stations import RACE_ANGLES, DiscStations, patch_half_width
from fem.coefficients.wall_strain import continue_under_patches, wall_modulus, wall_strain_measures
from fem.errors import MeshError
from fem.mesh.body_mesh import BodyMesh
from fem.mesh.element_size import Refinement
from fem.mesh.memory_need import require_memory, solution_memory
from fem.mesh.triangulation import default_coarse_size, estimate_unknowns, mesh_circle, mesh_disc, mesh_ring
from fem.shapes import CircleShape, DiscShape, RingShape
from ltca.arrays import ComplexArray, FloatArray, IntArray
from ltca.drive.parts import Material
from ltca.output.resources import available_memory
from ltca.reading.coefficient_laws import project_rigid_motions

# Element edge at a patch for its half-width, and growth of the edge by distance, on a mesh of size 1. Measured on
# the paper's disc: 0.3 % of the largest entry between this size and twice it, 0.05 % between it and half of it.
EDGE_SHARE = 0.4
GROWTH = 0.4
# Pins, rollers and race are small: a mesh of half the size costs nothing.
ROUND_SIZE = 0.5
# Elements stay small to this distance from the middle of a patch, in half-widths.
REFINED_RADIUS = 1.2
# Every 16th station also gets a patch twice as wide: both together show the closed form of the near field.
WIDE_STEP = 16
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
    what = "the disc for its influence coefficients"
    require_memory(unknowns, solution_memory(unknowns), what, available=available_memory() / processes)


def mesh_disc_for_stations(shape: DiscShape, stations: DiscStations, size: float = 1.0) -> BodyMesh:
    """Mesh a disc for its stations; `size` is a multiple of all element edges and of their growth."""
    require_element_size(size)
    require_disc_memory(shape, stations, size)
    refinements = _refinements(stations.points, float(stations.half_width.min()), size)
    return mesh_disc(shape, refinements, coarse_size=default_coarse_size(shape, size), growth=edge_growth(size))


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
    body = mesh_disc_for_stations(shape, stations, size)
    count, places = stations.count, stations.refined(shape)
    wide = np.arange(0, count, WIDE_STEP)
    patches, wide_patches, pressures, strains = [], [], [], []
    for index, curve in enumerate(shape.curves):
        own = np.flatnonzero(stations.boundary == index)
        patches.append(patch_loads(body, curve, stations.parameter[own], stations.half_width[own]))
        # Stresses beside a patch feel which way it presses, and contacts press along the normals.
        pressures.append(
            patch_loads(body, curve, stations.parameter[own], stations.half_width[own], along_normals=True)
        )
        seen = places.boundary == index
        strains.append(wall_strain_measures(body, curve, places.parameter[seen], places.half_width[seen]))
        also = wide[stations.boundary[wide] == index]
        if len(also):
            width = WIDE_RATIO * stations.half_width[also]
            wide_patches.append(patch_loads(body, curve, stations.parameter[also], width))
    motions = reduce(add, (boundary_motion_loads(body, bore.name) for bore in shape.bores))
    # What measures the strain of a wall is a load that balances itself: its row of the compliance holds, by
    # reciprocity, that strain under every patch. One factorisation serves both.
    measures = wall_modulus(material, state) * sp.hstack(strains)
    loads = sp.hstack([*patches, *wide_patches, *pressures, measures], format="csc")
    stiffness = assemble_stiffness(body, material, thickness=thickness, state=state)
    sampled = np.unique(np.linspace(0, count - 1, RECIPROCITY_SAMPLES).astype(int))
    by_area, by_bores = area_loads(body), motions.toarray()
    influence = influence_of_loads(body, stiffness, loads, [by_area, by_bores], sampled)
    del stiffness
    placed, pressed = slice(0, count), slice(count + len(wide), 2 * count + len(wide))
    area_approach, approach = influence.in_every_datum(placed)
    resultants = influence.resultants[:, placed]
    reciprocity = np.max(np.abs(influence.sampled[placed] - area_approach[:, sampled])) / np.max(np.abs(approach))

    modes = rigid_modes(body)
    left = loads[:, placed].T @ modes - resultants.T @ np.linalg.solve(modes.T @ by_bores, by_bores.T @ modes)
    balanced = project_rigid_motions(approach, resultants)
    datums = np.max(np.abs(balanced - project_rigid_motions(area_approach, resultants))) / np.max(np.abs(balanced))
    del balanced, area_approach
    stress = influence.block(slice(pressed.stop, loads.shape[1]), pressed, datum=1)
    return DerivedDisc(
        approach=approach,
        resultants=resultants,
        wide_stations=wide,
        wide_approach=influence.own(slice(count, pressed.start), datum=1),
        stress=continue_under_patches(stress, places.boundary, stations.boundary),
        reciprocity=float(reciprocity),
        rigid_residual=float(max(np.max(np.abs(left)) / np.max(np.abs(resultants)), datums)),
        unknowns=body.unknowns,
    )


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
    result = DerivedRound(
        approach=compliance[: len(places), : len(places)],
        half_width=width,
        wide_approach=float(compliance[-1, -1]),
        reciprocity=float(np.max(np.abs(measured - compliance.T)) / np.max(np.abs(compliance))),
        mirror=float(np.ptp(np.diag(compliance)[: len(places)]) / np.max(compliance)),
        unknowns=body.unknowns,
    )
    return result, body, displacement


def _mesh_round(shape: CircleShape | RingShape, angles: FloatArray, size: float) -> tuple[BodyMesh, float]:
    require_element_size(size)
    finer = ROUND_SIZE * size
    width = patch_half_width(shape)
    refinements = _refinements(shape.curves[0].points(angles), width, finer)
    coarse = default_coarse_size(shape, finer)
    if isinstance(shape, RingShape):
        return mesh_ring(shape, refinements, coarse_size=coarse, growth=edge_growth(finer)), width
    return mesh_circle(shape, refinements, coarse_size=coarse, growth=edge_growth(finer)), width
