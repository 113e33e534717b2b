"""All influence coefficients of a drive as one labelled dataset, the content of ``coefficients.nc``."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from fem.body.elasticity import PlaneState
from fem.coefficients.bodies import (
    EDGE_SHARE,
    GROWTH,
    MAX_SIZE,
    ROUND_SIZE,
    WIDE_RATIO,
    DerivedDisc,
    DerivedRound,
    derive_disc,
    derive_pin,
    derive_race,
    derive_roller,
    require_disc_memory,
    require_element_size,
)
from fem.coefficients.solid_dataset import LAYERS, need_of_solid, require_solid, with_solid_bodies
from fem.coefficients.stations import DiscStations, root_clustering
from fem.mesh.gmsh_session import load_gmsh
from fem.mesh.memory_need import require_memory
from fem.shapes import DriveShapes
from ltca.arrays import FloatArray
from ltca.drive.parts import Drive, Material, Materials
from ltca.drive.single_discs import nominal_shape
from ltca.output.provenance import code_hash, code_version
from ltca.output.resources import available_memory
from ltca.reading.coefficient_laws import project_rigid_motions
from ltca.reading.coefficient_schema import elastic_constants

if TYPE_CHECKING:
    import xarray as xr


DATUM = (
    "disc: relative to the best-fit rigid motion of {} (least squares along its length), the resultant of each "
    "unit load balanced by forces over {} dual to that motion; wheel pin: rigid core held; roller: relative to "
    "area-mean displacement and rotation, unit loads balanced by uniform body force; inner race: bore held"
)
COARSE_RATIO = 2.0


def derive_coefficients(
    drive: Drive,
    *,
    case: str = "",
    stations: float = 1.0,
    size: float = 1.0,
    state: PlaneState = "strain",
    keep_clearance: bool = True,
    bodies: Literal["plane", "solid"] = "plane",
    layers: int = LAYERS,
    processes: int = 1,
    progress: Callable[[str], None] | None = None,
    store: Callable[[xr.Dataset], object] | None = None,
) -> xr.Dataset:
    """Derive the influence coefficients of all bodies of a drive.

    Errors of single parts are left out: one dataset serves all drives of one `Drive.shape_fingerprint`.

    Parameters
    ----------
    drive : Drive
        The drive.
    case : str
        Name of its case, for the record.
    stations : float
        Multiple of the default numbers of stations (see `DiscStations.of_disc`).
    size : float
        Multiple of the default element edges; the convergence estimate takes a mesh of twice that.
    state : {"strain", "stress"}
        Plane strain or plane stress.
    keep_clearance : bool
        Derive the disc with the bearing and pin-hole clearance of this case; without them on purpose, one dataset serves
        all clearance cases approximately, and says so.
    bodies : {"plane", "solid"}
        Solid bodies have true ends, and coefficients for the tilt of contacts as well (`fem.coefficients.solid_dataset`); time
        and memory are told on stderr, and what is done is kept until all is stored.
    layers : int
        Of solid bodies, over half of their thickness.
    processes : int
        How many derivations share the memory of the machine.
    progress : callable, optional
        Called with the name of each step before it starts.
    store : callable, optional
        Called with the result, to write it: what is kept of solid bodies is removed after that, not where it fails.

    Returns
    -------
    Dataset
        As ``docs/theory/coefficients.md`` describes it; mm/N.

    Raises
    ------
    DriveError
        For several discs, which may be of several shapes.
    MeshError
        When a parameter is out of bounds or meshing fails, or for solid bodies in plane stress.
    MemoryLimitError
        When mesh and solution would not fit into memory.

    Examples
    --------
    A quarter of the stations on a coarse mesh: the displacement at one by a load at another is that the other way round.

    >>> import ltca
    >>> found = derive_coefficients(ltca.load_drive("paper").cases["CS-1"], stations=0.25, size=2.0)
    >>> disc = found["disc_approach"].values
    >>> bool(abs(disc - disc.T).max() < 1e-8 * abs(disc).max())
    True
    """
    require_element_size(size, MAX_SIZE / COARSE_RATIO)
    if bodies == "solid":
        require_solid(state, layers)
    nominal = nominal_shape(drive, keep_clearance=keep_clearance)
    shapes = DriveShapes.of_drive(nominal)
    places = DiscStations.of_disc(shapes.disc, stations)
    require_disc_memory(shapes.disc, places, size, processes)
    if bodies == "solid":
        need = need_of_solid(shapes.disc, places, size=size, layers=layers)
        what = "the solid disc for its influence coefficients (--bodies solid)"
        require_memory(need.unknowns, need.memory, what, available=available_memory() / processes)
        print(f"{drive.name}: {need.words}", file=sys.stderr)
    if (coarse_walls := places.coarse_walls) is not None:
        print(f"warning: {drive.name}: {coarse_walls}", file=sys.stderr)
    plane = _Bodies(
        shapes=shapes,
        places=places,
        materials=nominal.materials,
        wheel_pin=nominal.flank_pin,
        thickness=nominal.disc.thickness,
        state=state,
        tell=progress or (lambda step: None),
    )
    coarse = plane.derive(COARSE_RATIO * size, ", twice the size")
    fine = plane.derive(size, "")
    disc, _, roller, race = fine
    dataset = _label(places, places.refined(shapes.disc), *fine)
    if len(shapes.disc.bores) > 1:
        dataset["station_boundary"].attrs["long_name"] = (
            f"0 flank, 1 + c bore c, {1 + len(shapes.disc.bores)} + k hole k"
        )
    dataset.attrs.update(
        drive=drive.name,
        case=case,
        fingerprint=nominal.shape_fingerprint(),
        shape=json.dumps(nominal.body_shape()),
        clearances_left_out=int(not keep_clearance),
        flank_clustering=root_clustering(shapes.disc),
        plane=state,
        thickness=plane.thickness,
        core_radius=shapes.wheel_pins[0].core_radius,
        race_bore_radius=shapes.inner_race.inner_radius,
        datum=DATUM.format(*["the bore" if len(shapes.disc.bores) == 1 else "all bores together"] * 2),
        unknowns_disc=disc.unknowns,
        mesh_size=f"{size:g}: edge {EDGE_SHARE * size:g} of the patch half-width, growth {GROWTH * size:g}; pins, "
        f"rollers and race {ROUND_SIZE:g} times that",
        **_convergence(fine, coarse),
        symmetry=max(body.reciprocity for body in fine),
        mirror=max(roller.mirror, race.mirror),
        rigid_residual=disc.rigid_residual,
        roller_radius=shapes.rollers[0].radius,
        bearing_clearance=nominal.clearance.bearing,
        pin_hole_clearance=nominal.clearance.pin_hole,
        version=code_version(),
        code_hash=code_hash("ltca", "fem"),
        gmsh=str(load_gmsh().__version__),
        **elastic_constants(nominal.body_materials),
    )
    keep = store or (lambda derived: None)
    if bodies == "plane":
        keep(dataset)
        return dataset
    return with_solid_bodies(dataset, nominal, shapes, places, size=size, layers=layers, tell=plane.tell, store=keep)


class _Derived(NamedTuple):
    """All bodies on meshes of one size."""

    disc: DerivedDisc
    pin: DerivedRound
    roller: DerivedRound
    race: DerivedRound


@dataclass(frozen=True, slots=True, kw_only=True)
class _Bodies:
    """Shapes, materials and options shared by the meshes of both sizes."""

    shapes: DriveShapes
    places: DiscStations
    materials: Materials
    wheel_pin: Material
    thickness: float
    state: PlaneState
    tell: Callable[[str], None]

    def derive(self, size: float, note: str) -> _Derived:
        shapes, materials = self.shapes, self.materials
        same: dict[str, Any] = {"thickness": self.thickness, "state": self.state, "size": size}
        self.tell(f"disc{note}")
        disc = derive_disc(shapes.disc, self.places, materials.disc, **same)
        self.tell(f"pin, roller and race{note}")
        return _Derived(
            disc=disc,
            pin=derive_pin(shapes.wheel_pins[0], self.wheel_pin, **same),
            roller=derive_roller(shapes.rollers[0], materials.roller, **same),
            race=derive_race(shapes.inner_race, materials.inner_race, **same),
        )


def _convergence(fine: _Derived, coarse: _Derived) -> dict[str, float]:
    """Changes from the coarser meshes as attributes: the worst, of each body, of the stresses."""
    disc = (project_rigid_motions(own.disc.approach, own.disc.resultants) for own in (fine, coarse))
    each = {"convergence_disc": _difference(*disc)}
    for name, own, other in zip(("pin", "roller", "race"), fine[1:], coarse[1:], strict=True):
        each[f"convergence_{name}"] = _difference(own.approach, other.approach)
    worst, stress = max(each.values()), _difference(fine.disc.stress, coarse.disc.stress)
    return {"convergence_estimate": worst, **each, "convergence_stress": stress}


def _difference(values: FloatArray, other: FloatArray) -> float:
    return float(np.max(np.abs(values - other)) / np.max(np.abs(values)))


def _label(
    places: DiscStations,
    stressed: DiscStations,
    disc: DerivedDisc,
    pin: DerivedRound,
    roller: DerivedRound,
    race: DerivedRound,
) -> xr.Dataset:
    import xarray as xr

    def variable(dimensions: tuple[str, ...], values: object, unit: str, text: str) -> xr.Variable:
        return xr.Variable(dimensions, np.asarray(values), {"units": unit, "long_name": text})

    angles = 2.0 * np.pi * np.arange(len(race.approach)) / len(race.approach)
    wide = disc.wide_stations
    return xr.Dataset(
        {
            "station_boundary": variable(("station",), places.boundary, "1", "0 flank, 1 bore, 2 + k hole k"),
            "station_parameter": variable(("station",), places.parameter, "rad", "θ of Eq. 1, or polar angle"),
            "station_x": variable(("station",), places.points.real, "mm", "place in the disc frame"),
            "station_y": variable(("station",), places.points.imag, "mm", "place in the disc frame"),
            "station_normal_x": variable(("station",), places.normals.real, "1", "unit normal out of the disc"),
            "station_normal_y": variable(("station",), places.normals.imag, "1", "unit normal out of the disc"),
            "station_half_width": variable(("station",), places.half_width, "mm", "half-width of the patch"),
            "disc_approach": variable(
                ("station", "station_loaded"), disc.approach, "mm/N", "approach at a station by a newton at another"
            ),
            "disc_resultant": variable(
                ("motion", "station"), disc.resultants, "N, N, N mm", "force in x, y and moment of each unit load"
            ),
            "stress_station_boundary": variable(("stress_station",), stressed.boundary, "1", "as station_boundary"),
            "stress_station_parameter": variable(
                ("stress_station",), stressed.parameter, "rad", "as station_parameter"
            ),
            "stress_station_x": variable(("stress_station",), stressed.points.real, "mm", "place in the disc frame"),
            "stress_station_y": variable(("stress_station",), stressed.points.imag, "mm", "place in the disc frame"),
            "disc_stress": variable(
                ("stress_station", "station_loaded"),
                disc.stress,
                "MPa/N",
                "stress along the wall by a newton at a station, without what its patch does right under itself",
            ),
            "wide_station": variable(("wide",), wide, "1", "stations that also carry a wider patch"),
            "wide_half_width": variable(
                ("wide",), WIDE_RATIO * places.half_width[wide], "mm", "half-width of the wider patch"
            ),
            "wide_approach": variable(("wide",), disc.wide_approach, "mm/N", "approach of the wider patch by itself"),
            "pin_approach": variable((), pin.approach[0, 0], "mm/N", "wheel pin, load and place together"),
            "pin_half_width": variable((), pin.half_width, "mm", "half-width of the patch"),
            "pin_wide_approach": variable((), pin.wide_approach, "mm/N", "patch twice as wide"),
            "roller_approach": variable(
                ("roller_end", "roller_end_loaded"), roller.approach, "mm/N", "roller, (inner, outer)"
            ),
            "roller_half_width": variable(("roller_end",), [roller.half_width] * 2, "mm", "half-width of the patch"),
            "roller_wide_approach": variable((), roller.wide_approach, "mm/N", "patch twice as wide"),
            "race_angle": variable(("race_angle",), angles, "rad", "difference of polar angles"),
            "race_approach": variable(("race_angle",), race.approach, "mm/N", "inner race, by a newton at angle 0"),
            "race_half_width": variable((), race.half_width, "mm", "half-width of the patch"),
            "race_wide_approach": variable((), race.wide_approach, "mm/N", "patch twice as wide"),
        }
    )
