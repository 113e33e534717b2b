"""All influence coefficients of a drive as one labelled dataset, the content of ``coefficients.nc``."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from typing import Any, Literal, NamedTuple, TypedDict

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
from ltca.drive.parts import Drive
from ltca.drive.single_discs import nominal_shape
from ltca.output.labelled import LabelledArray, LabelledDataset
from ltca.output.provenance import code_hash, code_version
from ltca.output.resources import available_memory
from ltca.reading.coefficient_schema import elastic_constants

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
    store: Callable[[Any], object] | None = None,
) -> Any:
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
        Multiple of the default element edges; that of solid bodies, whose error is told by a mesh of twice that, at most 2.
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
        Called with the result, to write it: what is kept of solid bodies is removed after that, not where it fails. It gets, and
        then is returned, a `ltca.output.labelled.LabelledDataset` for plane bodies, which takes no xarray.

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
    tell = progress or (lambda step: None)
    derived = _derive(shapes, places, nominal, size, state, tell)
    disc, _, roller, race = derived
    dataset = _label(places, places.refined(shapes.disc), *derived)
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
        thickness=nominal.disc.thickness,
        core_radius=shapes.wheel_pins[0].core_radius,
        race_bore_radius=shapes.inner_race.inner_radius,
        datum=DATUM.format(*["the bore" if len(shapes.disc.bores) == 1 else "all bores together"] * 2),
        unknowns_disc=disc.unknowns,
        mesh_size=f"{size:g}: edge {EDGE_SHARE * size:g} of the patch half-width, growth {GROWTH * size:g}; pins, "
        f"rollers and race {ROUND_SIZE:g} times that",
        **_convergence(derived),
        symmetry=max(body.reciprocity for body in derived),
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
    if bodies == "solid":
        keep = store or (lambda found: None)
        return with_solid_bodies(
            dataset.to_xarray(), nominal, shapes, places, size=size, layers=layers, tell=tell, store=keep
        )
    if store is None:
        return dataset.to_xarray()
    store(dataset)
    return dataset


class _Derived(NamedTuple):
    """All bodies."""

    disc: DerivedDisc
    pin: DerivedRound
    roller: DerivedRound
    race: DerivedRound


def _derive(
    shapes: DriveShapes,
    places: DiscStations,
    drive: Drive,
    size: float,
    state: PlaneState,
    tell: Callable[[str], None],
) -> _Derived:
    materials, same = drive.materials, _Options(thickness=drive.disc.thickness, state=state, size=size)
    tell("disc")
    disc = derive_disc(shapes.disc, places, materials.disc, **same)
    tell("pin, roller and race")
    return _Derived(
        disc=disc,
        pin=derive_pin(shapes.wheel_pins[0], drive.flank_pin, **same),
        roller=derive_roller(shapes.rollers[0], materials.roller, **same),
        race=derive_race(shapes.inner_race, materials.inner_race, **same),
    )


class _Options(TypedDict):
    """Options of every body."""

    thickness: float
    state: PlaneState
    size: float


def _convergence(derived: _Derived) -> dict[str, float]:
    """Estimates of the error of the meshes as attributes: the worst, of each body, of the stresses."""
    each = {f"convergence_{name}": body.error for name, body in derived._asdict().items()}
    return {"convergence_estimate": max(each.values()), **each, "convergence_stress": derived.disc.stress_error}


def _label(
    places: DiscStations,
    stressed: DiscStations,
    disc: DerivedDisc,
    pin: DerivedRound,
    roller: DerivedRound,
    race: DerivedRound,
) -> LabelledDataset:
    def variable(dimensions: tuple[str, ...], values: object, unit: str, text: str) -> LabelledArray:
        return LabelledArray(dimensions, np.asarray(values), {"units": unit, "long_name": text})

    angles = 2.0 * np.pi * np.arange(len(race.approach)) / len(race.approach)
    wide = disc.wide_stations
    return LabelledDataset(
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
        },
        (),
        {},
    )
