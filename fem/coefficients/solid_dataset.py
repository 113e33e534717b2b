"""Coefficients of the solid bodies of a drive: those of plane strain with what solid bodies have beyond them."""

from __future__ import annotations

import json
from collections.abc import Callable, Hashable, Iterable
from dataclasses import dataclass, replace
from functools import reduce
from operator import add
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import scipy.sparse as sp
from scipy.linalg import eigh

from fem.body.elasticity import area_loads
from fem.body.free_body import boundary_motion_loads
from fem.coefficients.bodies import ROUND_SIZE, WIDE_RATIO, edge_growth, estimate_disc_unknowns
from fem.coefficients.patch_loads import patch_loads
from fem.coefficients.pieces import Pieces
from fem.coefficients.solid_bodies import Differences, SolidOptions, Support, Wall, solid_differences
from fem.coefficients.solid_need import SolidNeed, solid_need
from fem.coefficients.stations import RACE_ANGLES, DiscStations, patch_half_width, root_clustering
from fem.coefficients.wall_strain import (
    continue_under_patches,
    wall_modulus,
    wall_strain_measures,
    wall_values,
)
from fem.errors import MeshError
from fem.mesh.body_mesh import BodyMesh
from fem.mesh.boundary_division import MAX_TURN
from fem.mesh.triangulation import default_coarse_size, mesh_circle, mesh_disc, mesh_ring
from fem.shapes import CircleShape, DiscShape, DriveShapes, RingShape
from fem.solid.layer_count import require_layers
from fem.solid.layers import graded_layers
from ltca.arrays import FloatArray, IntArray
from ltca.drive.parts import Drive, Material
from ltca.errors import CycloError, FaultError
from ltca.geometry.boundary_stations import boundaries_of, clustered_parameter, weights_of
from ltca.reading.coefficient_laws import project_rigid_motions

if TYPE_CHECKING:
    import xarray as xr

# Layers over half of the thickness, and in the convergence estimate.
LAYERS = 2
COARSE_RATIO = 2.0
# Thickness of the last layer by that of the first.
FINEST = 0.5
# Places midway between stations that are solved for to measure what interpolation leaves.
MIDWAY = 24


class SectionMesh(NamedTuple):
    """Size of the mesh of a cross-section, and the largest angle of its boundary edges, rad."""

    size: float
    turn: float


class SolidDisc(NamedTuple):
    """Differences of the disc, and what interpolation between the stations leaves of them."""

    even: FloatArray
    linear: FloatArray
    flat: FloatArray
    wide_even: FloatArray
    wide_linear: FloatArray
    strain: FloatArray
    left_even: float
    left_linear: float
    unknowns: int


def _mesh(shape: DiscShape | CircleShape | RingShape, mesh: SectionMesh) -> BodyMesh:
    size = mesh.size * (1.0 if isinstance(shape, DiscShape) else ROUND_SIZE)
    coarse, growth, turn = default_coarse_size(shape, size), edge_growth(size), mesh.turn
    if isinstance(shape, DiscShape):
        return mesh_disc(shape, coarse_size=coarse, growth=growth, turn=turn)
    if isinstance(shape, RingShape):
        return mesh_ring(shape, coarse_size=coarse, growth=growth, turn=turn)
    return mesh_circle(shape, coarse_size=coarse, growth=growth, turn=turn)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Places:
    """Patches on the disc: at the stations, wider ones, and midway between stations."""

    shape: DiscShape
    stations: DiscStations

    @property
    def wide(self) -> IntArray:
        """Stations that also carry a wider patch."""
        return self.stations.wide(self.stations.cells(self.shape))

    def midway(self) -> FloatArray:
        """Parameters midway between each station and the next on its boundary, rad."""
        stations, teeth = self.stations, round(self.shape.flank.profile.reduction_ratio) - 1
        found = []
        for number in np.unique(stations.boundary).tolist():
            count = int(np.count_nonzero(stations.boundary == number))
            uniform = 2.0 * np.pi * (np.arange(count) + 0.5) / count
            found.append(uniform if number else clustered_parameter(uniform, teeth, root_clustering(self.shape)))
        return np.concatenate(found)

    def loads(self, body: BodyMesh, at: FloatArray, boundary: IntArray, width: FloatArray) -> sp.csc_matrix:
        """Patches at parameters of boundaries, which ascend."""
        return sp.hstack(
            [
                patch_loads(body, curve, at[boundary == index], width[boundary == index])
                for index, curve in enumerate(self.shape.curves)
                if np.any(boundary == index)
            ],
            format="csc",
        )

    def interpolation(self, parameter: FloatArray, boundary: IntArray) -> sp.csr_matrix:
        """Weights of the stations at parameters of boundaries, shape (places, stations), as the LTCA takes them."""
        teeth = round(self.shape.flank.profile.reduction_ratio) - 1
        curves = boundaries_of(self.stations.boundary, teeth, root_clustering(self.shape))
        at, weights = weights_of(curves, boundary, parameter)
        rows = np.repeat(np.arange(len(parameter)), at.shape[-1])
        return sp.csr_matrix((weights.ravel(), (rows, at.ravel())), shape=(len(parameter), self.stations.count))


def solid_disc(
    shape: DiscShape, stations: DiscStations, material: Material, mesh: SectionMesh, options: SolidOptions, note: str
) -> SolidDisc:
    """Derive what the solid disc has beyond plane strain."""
    body, places = _mesh(shape, mesh), _Places(shape=shape, stations=stations)
    wide, between = places.wide, places.midway()
    count = stations.count
    sampled = np.unique(np.linspace(0, count - 1, MIDWAY).astype(int))
    own = places.loads(body, stations.parameter, stations.boundary, stations.half_width)
    wider = places.loads(
        body, stations.parameter[wide], stations.boundary[wide], WIDE_RATIO * stations.half_width[wide]
    )
    middle = places.loads(body, between, stations.boundary, stations.half_width)
    balance = reduce(add, (boundary_motion_loads(body, bore.name) for bore in shape.bores)).toarray()
    seen = stations.refined(shape)
    strains, values = [], []
    for index, curve in enumerate(shape.curves):
        at = seen.boundary == index
        strains.append(wall_strain_measures(body, curve, seen.parameter[at], seen.half_width[at]))
        values.append(wall_values(body, curve, seen.parameter[at]))
    found = solid_differences(
        f"solid disc{note}",
        body,
        Support(held=np.zeros(0, dtype=np.int64), balance=balance),
        sp.hstack([own, wider, middle[:, sampled]], format="csc"),
        sp.hstack([own, wider, middle], format="csc"),
        material,
        options,
        Wall(strains=sp.hstack(strains, format="csc"), values=sp.hstack(values, format="csc")),
    )
    weights = places.interpolation(between, stations.boundary)
    broad = slice(count, count + len(wide))
    left = []
    for each in (found.even, found.linear):
        ahead = weights @ each[:count, :count] @ weights[sampled].T
        left.append(float(np.max(np.abs(ahead - each[broad.stop :, broad.stop :]))))
    return SolidDisc(
        even=found.even[:count, :count],
        linear=found.linear[:count, :count],
        flat=found.flat[:count, :count],
        wide_even=np.diag(found.even[broad, broad]),
        wide_linear=np.diag(found.linear[broad, broad]),
        strain=found.strain[:, :count],
        left_even=left[0],
        left_linear=left[1],
        unknowns=found.unknowns,
    )


def solid_round(
    name: str,
    shape: CircleShape | RingShape,
    angles: FloatArray,
    measured: FloatArray,
    material: Material,
    mesh: SectionMesh,
    options: SolidOptions,
    held: str = "",
) -> Differences:
    """Derive what a solid pin, roller or race has beyond plane strain.

    Loads are patches at `angles` and, last, one twice as wide at the first of them; measures are patches at `measured` and
    that wide one. `held` is a boundary that does not move.
    """
    body, curve, width = _mesh(shape, mesh), shape.curves[0], patch_half_width(shape)
    wide = patch_loads(body, curve, angles[:1], WIDE_RATIO * width)
    loads, seen = (sp.hstack([patch_loads(body, curve, at, width), wide], format="csc") for at in (angles, measured))
    if held:
        support = Support(held=np.unique(body.boundary_nodes(held)), balance=None)
    else:
        support = Support(held=np.zeros(0, dtype=np.int64), balance=area_loads(body))
    return solid_differences(name, body, support, loads, seen, material, options)


class _Solid(NamedTuple):
    """All bodies on meshes of one size."""

    disc: SolidDisc
    pin: Differences
    roller: Differences
    race: Differences


def _derive(
    drive: Drive, shapes: DriveShapes, places: DiscStations, mesh: SectionMesh, options: SolidOptions, note: str
) -> _Solid:
    materials, none = drive.materials, np.zeros(1)
    turn = 2.0 * np.pi * np.arange(RACE_ANGLES) / RACE_ANGLES
    ends = np.array([np.pi, 0.0])
    as_long = replace(options, thickness=drive.roller_length)
    pin, race = shapes.wheel_pins[0], shapes.inner_race
    return _Solid(
        disc=solid_disc(shapes.disc, places, materials.disc, mesh, options, note),
        pin=solid_round(f"solid pin{note}", pin, none, none, drive.flank_pin, mesh, options, "core"),
        roller=solid_round(f"solid roller{note}", shapes.rollers[0], ends, ends, materials.roller, mesh, as_long),
        race=solid_round(f"solid race{note}", race, none, turn, materials.inner_race, mesh, options, "inner"),
    )


def with_solid_bodies(
    plane: xr.Dataset,
    drive: Drive,
    shapes: DriveShapes,
    places: DiscStations,
    *,
    size: float,
    layers: int,
    tell: Callable[[str], None],
    store: Callable[[xr.Dataset], object],
) -> xr.Dataset:
    """Return the coefficients of solid bodies: those of plane strain, of a nominal drive, with what solid ones have beyond them.

    Each class of each body is kept in the cache until the result is stored: a derivation that was interrupted, or whose result
    found no room, goes on.
    """
    key = json.dumps([drive.body_shape("solid"), size, layers, places.count, plane.attrs["code_hash"]])
    options = SolidOptions(thickness=drive.disc.thickness, layers=layers, tell=tell, pieces=Pieces.of_key(key))
    fewer = replace(options, layers=layers - 1)
    coarser = SectionMesh(COARSE_RATIO * size, COARSE_RATIO * MAX_TURN)
    coarse = _derive(drive, shapes, places, coarser, fewer, ", coarser")
    fine = _derive(drive, shapes, places, SectionMesh(size, MAX_TURN), options, "")
    found = _joined(plane, drive, fine, layers)
    found.attrs["roller_length"] = drive.roller_length
    found.attrs |= {
        "dimensions": 3,
        "plane": "solid",
        "shape": json.dumps(drive.body_shape("solid")),
        "fingerprint": drive.shape_fingerprint("solid"),
        "pin_length": drive.disc.thickness,
        "race_length": drive.disc.thickness,
        "datum": plane.attrs["datum"]
        + "; "
        + TILT_DATUM.format(*(["the bore" if len(shapes.disc.bores) == 1 else "all bores"])),
        "unknowns_solid": fine.disc.unknowns,
        "solid_mesh": f"{size:g}: section of edges {default_coarse_size(shapes.disc, size):.4g} mm, {layers} layers over half of "
        f"the thickness, the last {FINEST:g} of the first; coarser: {COARSE_RATIO:g} times the edges, {fewer.layers} layers",
        "interpolation_error": fine.disc.left_even / float(np.max(np.abs(found["disc_approach"].values))),
        "interpolation_error_tilt": fine.disc.left_linear / float(np.max(np.abs(found["disc_tilt_approach"].values))),
        "symmetry": max(float(plane.attrs["symmetry"]), _asymmetry(fine)),
        **_convergence(plane, found, fine, coarse),
        **_bracket(plane, fine.disc, places),
    }
    try:
        store(found)
    except CycloError as error:
        # What broke a law is not kept; what found no room is.
        if not isinstance(error, FaultError):
            options.pieces.forget()
        raise
    options.pieces.forget()
    return found


TILT_DATUM = (
    "linear loads: disc relative to the tilt of {} (least squares of the displacement in the plane over the wall, linear in z), "
    "balanced by forces linear in z over it; roller relative to its mean lean over the volume"
)


def _joined(plane: xr.Dataset, drive: Drive, solid: _Solid, layers: int) -> xr.Dataset:
    """All variables of a file, from those of plane strain and the differences."""
    import xarray as xr

    thickness, length = drive.disc.thickness, drive.roller_length
    per_tilt, roller_tilt = 12.0 / thickness**2, 12.0 / length**2
    shorter = thickness / length

    def variable(dimensions: Iterable[Hashable], values: object, unit: str, text: str) -> xr.Variable:
        return xr.Variable(tuple(dimensions), np.asarray(values), {"units": unit, "long_name": text})

    def both(name: str, even: FloatArray, linear: FloatArray, scale: float = 1.0, tilt: float = per_tilt) -> None:
        old = plane[name]
        base = scale * old.values
        text = str(old.attrs["long_name"])
        found[name] = variable(old.dims, base + even, "mm/N", text)
        own = name.replace("approach", "tilt_approach")
        found[own] = variable(
            old.dims, tilt * base + linear, "rad/(N mm)", f"{text}, tilt by a load linear in z, 1 N mm"
        )

    def even_in(values: FloatArray) -> FloatArray:
        return 0.5 * (values + np.roll(values[::-1], 1))

    def mean(matrix: FloatArray) -> FloatArray:
        return 0.5 * (matrix + matrix.T)

    found = plane.copy()
    both("disc_approach", mean(solid.disc.even), mean(solid.disc.linear))
    both("wide_approach", solid.disc.wide_even, solid.disc.wide_linear)
    both("pin_approach", solid.pin.even[0, 0], solid.pin.linear[0, 0])
    both("pin_wide_approach", solid.pin.even[-1, -1], solid.pin.linear[-1, -1])
    ends = slice(0, 2)
    both(
        "roller_approach",
        mean(solid.roller.even[ends, ends]),
        mean(solid.roller.linear[ends, ends]),
        shorter,
        roller_tilt,
    )
    both("roller_wide_approach", solid.roller.even[-1, -1], solid.roller.linear[-1, -1], shorter, roller_tilt)
    both("race_approach", even_in(solid.race.even[:-1, 0]), even_in(solid.race.linear[:-1, 0]))
    both("race_wide_approach", solid.race.even[-1, -1], solid.race.linear[-1, -1])
    force = plane["disc_resultant"].values
    found["disc_tilt_resultant"] = variable(
        ("tilt", "station"), [-force[1], force[0]], "1", "moments about x and y of each unit linear load"
    )
    material = drive.materials.disc
    more = wall_modulus(material, "strain") * solid.disc.strain
    more = continue_under_patches(more, plane["stress_station_boundary"].values, plane["station_boundary"].values)
    found["disc_stress"] = plane["disc_stress"].copy(data=plane["disc_stress"].values + more)
    heights = graded_layers(thickness, layers, "symmetric").vertices
    found["layer_height"] = variable(("layer",), heights, "mm", "heights of the ends of the layers of the disc")
    return found


def need_of_solid(shape: DiscShape, places: DiscStations, *, size: float, layers: int) -> SolidNeed:
    """Return what the derivation of a solid disc needs, with that of the plane one on two meshes before it."""
    wide = len(places.wide(places.cells(shape)))
    return solid_need(
        shape,
        places.count + wide + MIDWAY,
        size=size,
        growth=edge_growth(size),
        layers=layers,
        plane_unknowns=estimate_disc_unknowns(shape, places, size),
    )


def _asymmetry(solid: _Solid) -> float:
    """Reciprocity of displacements solved for, of the largest difference."""
    square = [(solid.disc.even, solid.disc.linear), (solid.roller.even[:2, :2], solid.roller.linear[:2, :2])]
    return max(float(np.max(np.abs(each - each.T)) / np.max(np.abs(each))) for both in square for each in both)


def _convergence(plane: xr.Dataset, found: xr.Dataset, fine: _Solid, coarse: _Solid) -> dict[str, float]:
    """Changes from the coarser meshes, those of plane strain and of the differences together: the worst, of each body."""
    force = plane["disc_resultant"].values
    tilting = found["disc_tilt_resultant"].values
    each = {}
    for body, own, other in zip(("disc", "pin", "roller", "race"), fine, coarse, strict=True):
        worst = []
        for name, kind, resultants in (("approach", "even", force), ("tilt_approach", "linear", tilting)):
            now, before = getattr(own, kind), getattr(other, kind)
            largest = float(np.max(np.abs(found[f"{body}_{name}"].values)))
            if body == "disc":
                now, before = (project_rigid_motions(values, resultants) for values in (now, before))
                largest = float(np.max(np.abs(project_rigid_motions(found[f"{body}_{name}"].values, resultants))))
            in_plane = 12.0 / float(plane.attrs["thickness"]) ** 2 if kind == "linear" else 1.0
            of_plane = in_plane * float(np.max(np.abs(plane[f"{body}_approach"].values)))
            if body == "roller":
                shorter = float(plane.attrs["thickness"]) / float(found.attrs["roller_length"])
                of_plane *= shorter ** (3 if kind == "linear" else 1)
            change = float(np.max(np.abs(now - before))) + float(plane.attrs[f"convergence_{body}"]) * of_plane
            worst.append(change / largest)
        each[f"convergence_{body}"], each[f"convergence_{body}_tilt"] = worst
    modulus = float(plane.attrs["disc_youngs_modulus"]) / (1.0 - float(plane.attrs["disc_poisson_ratio"]) ** 2)
    strained = modulus * float(np.max(np.abs(fine.disc.strain - coarse.disc.strain)))
    largest = float(np.max(np.abs(plane["disc_stress"].values)))
    tilts = {name: value for name, value in each.items() if name.endswith("_tilt")}
    return {
        "convergence_estimate": max(value for name, value in each.items() if name not in tilts),
        "convergence_estimate_tilt": max(tilts.values()),
        **each,
        "convergence_stress": float(plane.attrs["convergence_stress"]) + strained / largest,
    }


def _bracket(plane: xr.Dataset, disc: SolidDisc, places: DiscStations) -> dict[str, float]:
    """Where the solid disc lies between plane strain (0) and plane stress (1), rigid motions left out.

    The share of contacts farther apart than the disc is thick, by least squares, and the least and the largest of all balanced
    loads.
    """
    force = plane["disc_resultant"].values
    solid, flat = (project_rigid_motions(0.5 * (each + each.T), force) for each in (disc.even, disc.flat))
    far = np.abs(places.points[:, None] - places.points[None, :]) > float(plane.attrs["thickness"])
    balanced = np.linalg.qr(force.T, mode="complete")[0][:, 3:]
    between = eigh(balanced.T @ solid @ balanced, balanced.T @ flat @ balanced, eigvals_only=True)
    return {
        "bracket": float(np.sum((solid * flat)[far]) / np.sum((flat * flat)[far])),
        "bracket_lowest": float(between[0]),
        "bracket_highest": float(between[-1]),
    }


def require_solid(state: str, layers: int) -> None:
    """Raise MeshError for options that have no meaning or are out of bounds with solid bodies."""
    if state != "strain":
        raise MeshError(f"plane {state}: has no meaning with solid bodies, which are in no plane state")
    require_layers(layers)
