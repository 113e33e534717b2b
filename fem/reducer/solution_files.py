"""Files of a full solution: ``summary.json``, ``fem.nc``, one ``.vtu`` for each body and ``fem.vtm`` over them all.

``fem.nc`` has the dimensions and names of ``results.nc``: case, disc, crank, position, then pin, roller or hole, always
all of them that a quantity has; case and position have size 1.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.sax.saxutils import quoteattr

import numpy as np

from fem.drive.contact_kinds import CONTACT_KINDS, PairKind
from fem.drive.disc_stress import DiscStress, recover_disc_stress, stress_variables, summarise_stress
from fem.drive.fields import BodyField, bore_motion
from fem.drive.full_solution import FullSolution
from fem.mesh.mesh_file import body_stem, write_vtu
from fem.reducer.error_table import error_content
from fem.reducer.nested_meshes import NestedSolution
from fem.reducer.solution import ReducerSolution
from fem.reducer.verdict import judge_solution
from fem.solid_drive.width_results import (
    bearing_couples,
    bore_lean,
    disc_lean,
    pressures_over,
    roller_leans,
    width_results,
)
from ltca.arrays import FloatArray
from ltca.drive.hole_contact import RIGID_SHAFT_PINS, shaft_pins_yield
from ltca.drive.members.judgement import Check
from ltca.drive.members.limits import Limit
from ltca.drive.members.verdict_words import check_content
from ltca.errors import CycloError
from ltca.geometry.placement import place_coordinates
from ltca.output.files import whole_file, write_json
from ltca.output.labelled import LabelledDataset
from ltca.output.netcdf import write_netcdf
from ltca.output.provenance import code_hash, code_version
from ltca.quantities import QUANTITIES, SCHEMA_VERSION
from ltca.reading.writing import drive_text

if TYPE_CHECKING:
    import xarray as xr

ARRAYS = tuple(getattr(kind, name) for name in ("load", "pressure", "half_width") for kind in CONTACT_KINDS.values())
"""Arrays of `fem.drive.contact_results.ContactResults` that files hold, by their names in ``fem.nc``."""
MULTI_BLOCK = "fem.vtm"


LARGEST: dict[PairKind, str] = {
    "pin": "pin_pressure_max",
    "roller_outer": "roller_pressure_max_outer",
    "roller_inner": "roller_pressure_max_inner",
    "hole": "pin_shaft_pressure_max",
}
"""Names of the largest pressure anywhere along the width of solid bodies, by kinds of contacts."""
POSE = ("disc_x", "disc_y", "disc_rotation", "disc_area_x", "disc_area_y", "disc_area_rotation")


def numbers_of(solution: ReducerSolution) -> dict[str, Any]:
    """Return the results by their names in `ltca.quantities`: of the drive, or by disc and then by crank and part."""
    discs, poses = solution.discs, [disc.pose for disc in solution.discs]
    bearings, motions = np.array([disc.bearing_components for disc in discs]), [bore_motion(disc) for disc in discs]
    found: dict[str, Any] = {name: [getattr(disc.contacts, name) for disc in discs] for name in ARRAYS}
    found |= {
        "wheel_angle": solution.wheel_angle,
        "transmission_error": solution.transmission_error,
        "wheel_moment": solution.wheel_moment,
        "disc_torque": solution.disc_torques,
        "disc_x": [shift.real for shift, _ in motions],
        "disc_y": [shift.imag for shift, _ in motions],
        "disc_rotation": [rotation for _, rotation in motions],
        "disc_area_x": [pose.disc_x for pose in poses],
        "disc_area_y": [pose.disc_y for pose in poses],
        "disc_area_rotation": [pose.disc_rotation for pose in poses],
        "bearing_radial": bearings[..., 0],
        "bearing_tangential": bearings[..., 1],
        "equilibrium_residual": solution.equilibrium_residual,
    }
    if (ring := solution.ring_displacements) is not None:
        found |= {"ring_displacement_radial": ring.real, "ring_displacement_tangential": ring.imag}
    if not solution.solid:
        return found
    for kind, name in LARGEST.items():
        found[name] = [np.zeros(getattr(disc.contacts, CONTACT_KINDS[kind].load).size) for disc in discs]
        for largest, disc in zip(found[name], discs, strict=True):
            for pair, along in zip(disc.model.pairs, width_results(disc), strict=True):
                if pair.kind == kind:
                    largest[pair.index] = along.largest.max()
    # As rotations about x and y.
    leans, couples = np.array([bore_lean(disc) for disc in discs]), np.array([bearing_couples(disc) for disc in discs])
    return found | {
        "disc_tilt": np.stack([-leans.imag, leans.real], axis=-1),
        "crank_bearing_moment": np.stack([-couples.imag, couples.real], axis=-1),
    }


def summarise(solution: ReducerSolution) -> dict[str, Any]:
    """Return the content of ``summary.json``: lists by disc, then by part; of full length, zeros included.

    A value of a disc is a number with one disc, else a list by disc; with several cranks bearing forces are lists by
    crank. Of one solid disc all lists are by part alone. Rollers follow each other crank after crank.
    """
    discs = solution.discs
    content: dict[str, Any] = {QUANTITIES["crank_angle"].fem_key: solution.crank_angle}

    def bare(values: Any) -> Any:
        return values[0] if len(values) == 1 else values

    for name, values in numbers_of(solution).items():
        quantity, listed = QUANTITIES[name], np.asarray(values, dtype=float).tolist()
        if name in POSE and not solution.solid:
            continue
        by_crank = "crank" in quantity.dimensions and "roller" not in quantity.dimensions
        if by_crank:
            listed = [bare(of_disc) for of_disc in listed]
        if "disc" in quantity.dimensions and (solution.solid or by_crank):
            listed = bare(listed)
        keys = (quantity.fem_key,) if solution.solid else (quantity.older_fem_key, quantity.fem_key)
        content |= dict.fromkeys(keys, listed)
    content |= {
        "torque_share": [float(value) for value in solution.torque_share],
        "disc_displacement": bare([_motion(*bore_motion(disc)) for disc in discs]),
        "disc_displacement_area": bare(
            [_motion(disc.pose.disc_displacement, disc.pose.disc_rotation) for disc in discs]
        ),
        "pose_iterations": bare([disc.pose_iterations for disc in discs]),
        "dof": solution.unknowns,
        "size": solution.options.refined_size,
        "held": solution.drive.installation.held,
        "fingerprint": solution.drive.fingerprint(),
        "seconds": solution.seconds["total"],
        "seconds_by_stage": {stage: value for stage, value in solution.seconds.items() if stage != "total"},
    }
    if not solution.solid:
        return content | {"plane_state": solution.options.plane}
    return content | {
        "bodies": "solid",
        "layers": solution.options.layers,
        "contacts": bare([_along_width(disc) for disc in discs]),
        "roller_lean_rad": bare([roller_leans(disc).tolist() for disc in discs]),
        "disc_volume_tilt_rad": bare([[-disc_lean(disc).imag, disc_lean(disc).real] for disc in discs]),
        "strain_energy_N_mm": solution.strain_energy,
    }


def _along_width(disc: FullSolution) -> dict[str, dict[str, float]]:
    """Load, moment and load factor of every contact that carries, by its name."""
    return {
        CONTACT_KINDS[pair.kind].name_of(pair.index, disc.model.placement): {
            "load_N": along.load,
            "moment_N_mm": along.moment,
            "face_load_factor": along.load_factor,
        }
        for pair, along in zip(disc.model.pairs, width_results(disc), strict=True)
        if along.load > 0.0
    }


def _motion(shift: complex, rotation: float) -> dict[str, float]:
    return {"x_mm": shift.real, "y_mm": shift.imag, "rotation_rad": rotation}


def build_dataset(solution: ReducerSolution, case: str) -> xr.Dataset:
    """Return the solution as a labelled dataset, with the pressure of every loaded contact."""
    return label_solution(solution, case).to_xarray()


def label_solution(solution: ReducerSolution, case: str, stresses: Sequence[DiscStress] = ()) -> LabelledDataset:
    """Return what `build_dataset` holds without xarray, whose import takes half a second, and the stress in each disc."""
    discs, options = solution.discs, solution.options
    sizes = {"case": 1, "disc": len(discs), "crank": solution.drive.crank.number, "position": 1, "axis": 2}
    data: dict[str, Any] = {}
    for name, values in numbers_of(solution).items():
        quantity = QUANTITIES[name]
        shape = [sizes.get(dimension, -1) for dimension in quantity.dimensions]
        data[name] = quantity.labelled(np.asarray(values, dtype=float).reshape(shape), in_fem=True)
    if not shaft_pins_yield(solution.drive):
        data["pin_shaft_pressure_mid"][2]["long_name"] += f"; {RIGID_SHAFT_PINS}"
    heights, listed = _pressures(discs)
    data |= {name: QUANTITIES[name].labelled(values) for name, values in listed.items()}
    coordinates = place_coordinates(
        {case: solution.drive}, [[disc.model.placement for disc in discs]], np.atleast_1d(solution.crank_angle)
    ) | {"torque": QUANTITIES["torque"].labelled([solution.torque], in_fem=True)}
    if solution.solid:
        told = {"units": "mm", "long_name": "height above mid-width"}
        data["pressure_height"] = QUANTITIES["pressure_place"].dimensions, heights, told
        bodies: dict[str, Any] = {"model": "finite elements, solid bodies", "layers": options.layers}
    else:
        bodies = {"model": f"finite elements, plane {options.plane}", "plane": options.plane}
    attributes = {
        "Conventions": "CF-1.11",
        "schema_version": SCHEMA_VERSION,
        "title": f"full finite-element solution of {solution.drive.name}{' with solid bodies' * solution.solid}",
        "source": f"cyclo {code_version()}",
        "version": code_version(),
        "code_hash": code_hash("ltca", "fem"),
        "drive": solution.drive.name,
        "drive_file": drive_text(solution.drive),
        "fingerprint": solution.drive.fingerprint(),
        "held": solution.drive.installation.held,
        "elastic_shaft_pins": int(bool(discs[0].model.meshes.shaft_pins)),
        "size": options.refined_size,
        "unknowns": solution.unknowns,
    }
    if stresses:
        data |= stress_variables(stresses)
    return LabelledDataset.build(data, coordinates, attributes | bodies)


def _pressures(discs: tuple[FullSolution, ...]) -> tuple[FloatArray, dict[str, Any]]:
    """Heights of the vertices of all contacts that carry, mm, and their pressures, with their places on the arc."""
    numbers, kinds, indices, places, heights, values = [], [], [], [], [], []
    for number, disc in enumerate(discs):
        for pair, detail in zip(disc.model.pairs, disc.contacts.details, strict=True):
            if detail.load > 0.0:
                height, own = pressures_over(disc, pair)
                numbers.append(np.full(own.size, number))
                kinds.append(np.full(own.size, pair.kind))
                indices.append(np.full(own.size, pair.index))
                places.append(np.repeat(pair.zone.arc - detail.middle, height.size))
                heights.append(np.tile(height, len(own)))
                values.append(own.ravel())
    return np.concatenate(heights), {
        "pressure_contact": np.concatenate(kinds).astype(str),
        "pressure_disc": np.concatenate(numbers),
        "pressure_part": np.concatenate(indices),
        "pressure_place": np.concatenate(places),
        "pressure": np.concatenate(values),
    }


def write_solution(
    solution: ReducerSolution,
    fields: Sequence[Iterable[BodyField]],
    case: str,
    folder: Path,
    limits: Mapping[str, Limit] | None = None,
    nested: NestedSolution | None = None,
) -> list[Check]:
    """Write all files of a solution and return its verdict, as ``summary.json`` holds it; `fields` by disc (`recover_fields`).

    The key ``error`` of ``summary.json`` holds the error bars of the solutions on `nested` meshes, of which this is the finest.
    Each file appears only when it is complete, ``fem.vtm`` only over bodies of this solution. Solid bodies have neither fields
    nor a verdict.
    """
    if solution.solid:
        with whole_file(folder / "fem.nc") as part:
            write_netcdf(label_solution(solution, case), part)
        write_json(folder / "summary.json", summarise(solution))
        return []
    index = folder / MULTI_BLOCK
    try:
        # An older one would point at bodies of two solutions if this one is cut short.
        index.unlink(missing_ok=True)
    except OSError as error:
        raise CycloError(f"{index}: cannot be written: {error.strerror or error}") from error
    stresses = [recover_disc_stress(disc) for disc in solution.discs]
    with whole_file(folder / "fem.nc") as part:
        write_netcdf(label_solution(solution, case, stresses), part)
    bodies = [
        write_field(field, folder / f"{body_stem(field.body.name, disc, len(solution.discs))}.vtu")
        for disc, own in enumerate(fields)
        for field in own
    ]
    write_multi_block(bodies, index)
    checks = judge_solution(solution, stresses, limits or {})
    verdict = {"verdict": [check_content(check, case) for check in checks]}
    bars = {} if nested is None else {"error": error_content(nested)}
    write_json(folder / "summary.json", summarise(solution) | summarise_stress(stresses) | verdict | bars)
    return checks


def write_multi_block(bodies: list[Path], path: Path) -> Path:
    """Write an index (``.vtm``) that opens the files of all bodies, in its folder or below, as one multi-block dataset."""
    lines = ['<?xml version="1.0"?>', '<VTKFile type="vtkMultiBlockDataSet" version="1.0" byte_order="LittleEndian">']
    lines.append("  <vtkMultiBlockDataSet>")
    for number, body in enumerate(bodies):
        place = quoteattr(body.relative_to(path.parent).as_posix())
        lines.append(f'    <DataSet index="{number}" name={quoteattr(body.stem)} file={place}/>')
    lines += ["  </vtkMultiBlockDataSet>", "</VTKFile>"]
    with whole_file(path) as part:
        part.write_text("\n".join(lines) + "\n", encoding="utf-8", newline="\n")
    return path


def write_field(field: BodyField, path: Path) -> Path:
    """Write one body with displacements and stresses, at its place in the loaded pose."""
    stress = field.stress
    largest, middle, smallest = stress.principal

    def vectors(values: Any) -> Any:
        return np.column_stack([values.real, values.imag, np.zeros(len(values))])

    return write_vtu(
        field.placed_mesh,
        path,
        {
            "displacement_elastic_mm": vectors(field.elastic),
            "displacement_mm": vectors(field.rigid + field.elastic),
            "stress_xx_MPa": stress.xx,
            "stress_yy_MPa": stress.yy,
            "stress_xy_MPa": stress.xy,
            "stress_zz_MPa": stress.zz,
            "principal_MPa": np.column_stack([largest, middle, smallest]),
            "maximum_shear_MPa": stress.maximum_shear,
            "von_mises_MPa": stress.von_mises,
            "contact_pressure_MPa": field.pressure,
        },
    )
