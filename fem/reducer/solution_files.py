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

from fem.contact.pressure_measures import vertex_means
from fem.drive.disc_stress import recover_disc_stress, stress_variables, summarise_stress
from fem.drive.fields import BodyField, bore_motion
from fem.drive.full_solution import FullSolution
from fem.mesh.mesh_file import body_stem, write_vtu
from fem.reducer.solution import ReducerSolution
from fem.reducer.verdict import judge_solution
from ltca.drive.members.judgement import Check
from ltca.drive.members.limits import Limit
from ltca.drive.members.verdict_words import check_content
from ltca.drive.plane_strain import RIGID_SHAFT_PINS, shaft_pins_yield
from ltca.errors import CycloError
from ltca.output.files import whole_file, write_json
from ltca.output.netcdf import write_netcdf
from ltca.output.provenance import code_hash, code_version
from ltca.reading.writing import drive_text

if TYPE_CHECKING:
    import xarray as xr

# What a quantity belongs to, and the dimensions behind `case` that follow from it, as in ``results.nc``.
DIMENSIONS = {
    "drive": ("position",),
    "disc": ("disc", "position"),
    "crank": ("disc", "crank", "position"),
    "pin": ("disc", "position", "pin"),
    "roller": ("disc", "crank", "position", "roller"),
    "hole": ("disc", "position", "hole"),
}
# name in fem.nc: (attribute of ContactResults, what it belongs to, unit, description)
ARRAYS: dict[str, tuple[str, str, str, str]] = {
    "pin_load": ("pin_load", "pin", "N", "load of wheel pin and flank"),
    "roller_load": ("roller_load_outer", "roller", "N", "load of roller and bore (outer side)"),
    "roller_load_inner": ("roller_load_inner", "roller", "N", "load of roller and inner race"),
    "pin_shaft_load": ("pin_shaft_load", "hole", "N", "load of shaft pin and hole"),
    "pin_pressure_mid": ("pin_pressure_max", "pin", "MPa", "largest pressure of wheel pin and flank"),
    "roller_pressure_mid_outer": ("roller_pressure_max_outer", "roller", "MPa", "largest pressure of roller and bore"),
    "roller_pressure_mid_inner": ("roller_pressure_max_inner", "roller", "MPa", "largest pressure of roller and race"),
    "pin_shaft_pressure_mid": ("hole_pressure_max", "hole", "MPa", "largest pressure of shaft pin and hole"),
    "pin_half_width": ("pin_half_width", "pin", "mm", "half-width 2√⟨x²⟩ of wheel pin and flank"),
    "roller_half_width_outer": ("roller_half_width_outer", "roller", "mm", "half-width of roller and bore"),
    "roller_half_width_inner": ("roller_half_width_inner", "roller", "mm", "half-width of roller and race"),
    "pin_shaft_half_width": ("hole_half_width", "hole", "mm", "half-width of shaft pin and hole"),
}
# Keys of summary.json that are older than the names of the datasets, and stay.
SUMMARY_NAMES = {
    "roller_load": "roller_load_outer",
    "pin_pressure_mid": "pin_pressure_max",
    "roller_pressure_mid_outer": "roller_pressure_max_outer",
    "roller_pressure_mid_inner": "roller_pressure_max_inner",
    "pin_shaft_pressure_mid": "pin_shaft_pressure_max",
}
MULTI_BLOCK = "fem.vtm"


def summarise(solution: ReducerSolution) -> dict[str, Any]:
    """Return the content of ``summary.json``: lists by disc, then by part; of full length, zeros included.

    What a disc has one of is a number with one disc, else a list by disc; of several cranks bearing forces are lists by
    crank. Rollers follow each other crank after crank.
    """
    discs = solution.discs
    content: dict[str, Any] = {}
    for name, (attribute, _, unit, _) in ARRAYS.items():
        values = [[float(value) for value in getattr(disc.contacts, attribute)] for disc in discs]
        content[f"{SUMMARY_NAMES.get(name, name)}_{unit}"] = values

    def each(values: list[Any]) -> Any:
        return values[0] if len(values) == 1 else values

    def by_crank(column: int) -> Any:
        return each([each(disc.bearing_components[:, column].tolist()) for disc in discs])

    content |= {
        "crank_angle_rad": solution.crank_angle,
        "wheel_moment_N_mm": solution.wheel_moment,
        "disc_torque_N_mm": [float(value) for value in solution.disc_torques],
        "torque_share": [float(value) for value in solution.torque_share],
        "wheel_angle_rad": solution.wheel_angle,
        "transmission_error_rad": solution.transmission_error,
        "disc_displacement": each([_motion(*bore_motion(disc.model, disc.state)) for disc in discs]),
        "disc_displacement_area": each(
            [_motion(disc.pose.disc_displacement, disc.pose.disc_rotation) for disc in discs]
        ),
        "bearing_radial_N": by_crank(0),
        "bearing_tangential_N": by_crank(1),
        "equilibrium_residual_N": solution.equilibrium_residual,
        "pose_iterations": each([disc.pose_iterations for disc in discs]),
        "dof": solution.unknowns,
        "size": discs[0].scale,
        "plane_state": discs[0].plane_state,
        "held": solution.drive.installation.held,
        "fingerprint": solution.drive.fingerprint(),
        "seconds": solution.seconds["total"],
        "seconds_by_stage": {stage: value for stage, value in solution.seconds.items() if stage != "total"},
    }
    return content


def _motion(shift: complex, rotation: float) -> dict[str, float]:
    return {"x_mm": shift.real, "y_mm": shift.imag, "rotation_rad": rotation}


def build_dataset(solution: ReducerSolution, case: str) -> xr.Dataset:
    """Return the solution as a labelled dataset, with the pressure of every loaded contact."""
    import xarray as xr

    discs, first = solution.discs, solution.discs[0]
    sizes = {"case": 1, "disc": len(discs), "crank": solution.drive.crank.number, "position": 1}
    data: dict[str, Any] = {}

    def add(name: str, values: Any, belongs: str, unit: str, text: str) -> None:
        """Put values of the drive, or by disc and then by crank and part, in the dimensions of what they belong to."""
        dimensions = ("case", *DIMENSIONS[belongs])
        array = np.asarray(values, dtype=float).reshape([sizes.get(dimension, -1) for dimension in dimensions])
        data[name] = (dimensions, array, {"units": unit, "long_name": text})

    for name, (attribute, belongs, unit, text) in ARRAYS.items():
        if name == "pin_shaft_pressure_mid" and not shaft_pins_yield(solution.drive):
            text = f"{text}; {RIGID_SHAFT_PINS}"
        add(name, [getattr(disc.contacts, attribute) for disc in discs], belongs, unit, text)
    bearings = np.array([disc.bearing_components for disc in discs])
    motions = [bore_motion(disc.model, disc.state) for disc in discs]
    bore, bore_rotation = np.array([shift for shift, _ in motions]), [rotation for _, rotation in motions]
    poses = [disc.pose for disc in discs]
    area = "disc from its nominal place, mean over the area"
    for name, value, belongs, unit, text in (
        ("wheel_angle", solution.wheel_angle, "drive", "rad", "deviation of the wheel from φ_C/u, ccw positive"),
        ("transmission_error", solution.transmission_error, "drive", "rad", "deviation of the output, ccw positive"),
        ("wheel_moment", solution.wheel_moment, "drive", "N mm", "external moment on the wheel, ccw positive"),
        ("disc_torque", solution.disc_torques, "disc", "N mm", "part of that moment that the disc carries"),
        ("disc_x", bore.real, "disc", "mm", "disc from its nominal place, fixed axes, fitted to its bores"),
        ("disc_y", bore.imag, "disc", "mm", "disc from its nominal place, fixed axes, fitted to its bores"),
        ("disc_rotation", bore_rotation, "disc", "rad", "rotation of the disc, fitted to its bores, ccw positive"),
        ("disc_area_x", [pose.disc_x for pose in poses], "disc", "mm", area),
        ("disc_area_y", [pose.disc_y for pose in poses], "disc", "mm", area),
        (
            "disc_area_rotation",
            [pose.disc_rotation for pose in poses],
            "disc",
            "rad",
            "rotation of the disc, mean over the area",
        ),
        ("bearing_radial", bearings[..., 0], "crank", "N", "bearing force on the disc along the eccentricity"),
        (
            "bearing_tangential",
            bearings[..., 1],
            "crank",
            "N",
            "bearing force on the disc, 90° ahead of the eccentricity",
        ),
        ("equilibrium_residual", solution.equilibrium_residual, "drive", "N", "largest unbalanced force"),
    ):
        add(name, value, belongs, unit, text)
    for name, (values, unit, text) in _pressure_profiles(discs).items():
        data[name] = ("sample", values, {"units": unit, "long_name": text})
    attributes = {
        "Conventions": "CF-1.11",
        "title": f"full finite-element solution of {solution.drive.name}",
        "source": f"cyclo {code_version()}",
        "version": code_version(),
        "code_hash": code_hash("ltca", "fem"),
        "drive": solution.drive.name,
        "drive_file": drive_text(solution.drive),
        "fingerprint": solution.drive.fingerprint(),
        "held": solution.drive.installation.held,
        "model": f"finite elements, plane {first.plane_state}",
        "plane": first.plane_state,
        "elastic_shaft_pins": int(bool(first.model.meshes.shaft_pins)),
        "size": first.scale,
        "unknowns": solution.unknowns,
    }
    return xr.Dataset(data, coords=_coordinates(solution, case), attrs=attributes)


def _coordinates(solution: ReducerSolution, case: str) -> dict[str, Any]:
    """Return numbers and places of the parts, crank angle and torque: what ``results.nc`` has, for one position."""
    drive, places = solution.drive, [disc.model.placement for disc in solution.discs]
    place, count, cranks = places[0], len(places), places[0].cranks

    def at(dimensions: tuple[str, ...], values: Any, unit: str, text: str) -> tuple[Any, ...]:
        missing = len(dimensions) - np.ndim(values)
        return dimensions, np.reshape(values, (1,) * missing + np.shape(values)), {"units": unit, "long_name": text}

    found: dict[str, Any] = {"case": [case], "disc": np.arange(count), "crank": np.arange(cranks), "position": [0]}
    for name, parts in (
        ("pin", len(place.wheel_pin_radii)),
        ("roller", len(place.roller_radii) // cranks),
        ("hole", len(place.hole_radii)),
    ):
        found[name] = np.arange(parts)
    for name, dimensions, centres, frame in (
        ("pin", ("case", "pin"), place.wheel_pin_centres, "wheel pin, in the frame of the wheel"),
        (
            "hole",
            ("case", "disc", "hole"),
            np.array([own.hole_centres for own in places]),
            "hole, in the frame of the disc",
        ),
        ("shaft_pin", ("case", "hole"), place.shaft_pin_centres, "shaft pin, in the fixed frame"),
    ):
        found[f"{name}_x"] = at(dimensions, centres.real, "mm", frame)
        found[f"{name}_y"] = at(dimensions, centres.imag, "mm", frame)
    cage = "angle of the roller in the cage, which stands at cage_speed · φ_C"
    cages = np.array([own.roller_cage_angles.reshape(cranks, -1) for own in places])
    phase, plane = "phase of the disc's eccentric against the crank angle", "axial place of the disc's middle"
    return found | {
        "crank_angle": at(("position",), solution.crank_angle, "rad", "crank angle φ_C, held"),
        "roller_angle": at(("case", "disc", "crank", "roller"), cages, "rad", cage),
        "disc_phase": at(("case", "disc"), drive.disc.disc_phases, "rad", phase),
        "disc_plane": at(("case", "disc"), drive.disc.disc_planes, "mm", plane),
        "cage_speed": at(("case",), float(place.cage_speed), "1", "cage angle by crank angle"),
        "torque": at(("case",), solution.torque, "N mm", "output torque of the solution"),
        "driving_sign": at(("case",), drive.driving_sign, "1", "+1: the crank drives ccw, −1: cw"),
    }


def _pressure_profiles(discs: tuple[FullSolution, ...]) -> dict[str, tuple[Any, str, str]]:
    numbers, kinds, indices, places, values = [], [], [], [], []
    for number, disc in enumerate(discs):
        for pair, detail in zip(disc.model.pairs, disc.contacts.details, strict=True):
            if detail.load > 0.0:
                arc = pair.zone.arc
                numbers.append(np.full(len(arc), number))
                kinds.append(np.full(len(arc), pair.kind))
                indices.append(np.full(len(arc), pair.index))
                places.append(arc - detail.middle)
                own = pair.zone.at_vertices(disc.state.contact.pressure[pair.unknowns])
                values.append(vertex_means(arc, own))
    return {
        "pressure_contact": (np.concatenate(kinds).astype(str), "1", "kind of the contact of each sample"),
        "pressure_disc": (np.concatenate(numbers), "1", "number of its disc"),
        "pressure_part": (np.concatenate(indices), "1", "number of its pin, roller (crank after crank) or hole"),
        "pressure_place": (np.concatenate(places), "mm", "arc length from the centre of pressure"),
        "pressure": (np.concatenate(values), "MPa", "mean contact pressure under the shape function of each vertex"),
    }


def write_solution(
    solution: ReducerSolution,
    fields: Sequence[Iterable[BodyField]],
    case: str,
    folder: Path,
    limits: Mapping[str, Limit] | None = None,
) -> list[Check]:
    """Write all files of a solution; each appears only when it is complete, ``fem.vtm`` only over bodies of this one.

    Parameters
    ----------
    solution : ReducerSolution
        The solution.
    fields : sequence of iterables of BodyField
        Of each disc (`fem.drive.fields.recover_fields`).
    case : str
        Name of the case.
    folder : Path
        Where to.
    limits : mapping of str to Limit, optional
        Of the drive file, for the verdict.

    Returns
    -------
    list of Check
        The verdict, as ``summary.json`` holds it.

    Raises
    ------
    CycloError
        When the folder cannot be written to.
    """
    index = folder / MULTI_BLOCK
    try:
        # An older one would point at bodies of two solutions if this one is cut short.
        index.unlink(missing_ok=True)
    except OSError as error:
        raise CycloError(f"{index}: cannot be written: {error.strerror or error}") from error
    stresses = [recover_disc_stress(disc) for disc in solution.discs]
    with whole_file(folder / "fem.nc") as part:
        write_netcdf(build_dataset(solution, case).assign(stress_variables(stresses)), part)
    bodies = [
        write_field(field, folder / f"{body_stem(field.body.name, disc, len(solution.discs))}.vtu")
        for disc, own in enumerate(fields)
        for field in own
    ]
    write_multi_block(bodies, index)
    checks = judge_solution(solution, stresses, limits or {})
    verdict = {"verdict": [check_content(check, case) for check in checks]}
    write_json(folder / "summary.json", summarise(solution) | summarise_stress(stresses) | verdict)
    return checks


def write_multi_block(bodies: list[Path], path: Path) -> Path:
    """Write an index that opens the files of all bodies as one multi-block dataset, each under its name.

    Parameters
    ----------
    bodies : list of Path
        ``.vtu`` files in the folder of the index, or below it.
    path : Path
        Ends in ``.vtm``.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    CycloError
        When the file cannot be written.
    """
    lines = ['<?xml version="1.0"?>', '<VTKFile type="vtkMultiBlockDataSet" version="1.0" byte_order="LittleEndian">']
    lines.append("  <vtkMultiBlockDataSet>")
    for number, body in enumerate(bodies):
        place = quoteattr(body.relative_to(path.parent).as_posix())
        lines.append(f'    <DataSet index="{number}" name={quoteattr(body.stem)} file={place}/>')
    lines += ["  </vtkMultiBlockDataSet>", "</VTKFile>"]
    with whole_file(path) as part:
        part.write_text("\n".join(lines) + "\n", encoding="utf-8")
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
