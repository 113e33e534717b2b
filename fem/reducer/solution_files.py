"""Files of a full solution: ``summary.json``, ``fem.nc``, one ``.vtu`` for each body and ``fem.vtm`` over them all.

``fem.nc`` has the dimensions and names of ``results.nc``: case, disc, crank, position, then pin, roller or hole, always
all of them that a quantity has; so far each of the first four has size 1.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.sax.saxutils import quoteattr

import numpy as np

from fem.contact.pressure_measures import vertex_means
from fem.drive.contact_results import ContactResults
from fem.drive.disc_stress import recover_disc_stress, stress_variables, summarise_stress
from fem.drive.fields import BodyField, bore_motion
from fem.drive.model import DriveModel
from fem.drive.solution import FullSolution
from fem.mesh.mesh_file import write_vtu
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
RIGID_SHAFT_PINS = (
    "shaft pins are rigid: their material is not used, elastic ones of the disc's steel would read 1/√2 of it"
)
MULTI_BLOCK = "fem.vtm"


def bearing_components(contacts: ContactResults, crank_angle: float) -> tuple[float, float]:
    """Return the bearing force on the disc along the eccentricity and 90° ahead of it, N."""
    along = contacts.bearing_force * np.exp(-1j * crank_angle)
    return float(along.real), float(along.imag)


def summarise(solution: FullSolution) -> dict[str, Any]:
    """Return the content of ``summary.json``: lists by disc, then by part; of full length, zeros included."""
    contacts, model, pose = solution.contacts, solution.model, solution.pose
    content: dict[str, Any] = {}
    for name, (attribute, _, unit, _) in ARRAYS.items():
        values = [float(value) for value in getattr(contacts, attribute)]
        content[f"{SUMMARY_NAMES.get(name, name)}_{unit}"] = [values]
    bore, bore_rotation = bore_motion(model, solution.state)
    radial, tangential = bearing_components(contacts, model.crank_angle)
    content |= {
        "crank_angle_rad": model.crank_angle,
        "wheel_moment_N_mm": solution.state.wheel_moment,
        "wheel_angle_rad": pose.wheel_angle,
        "disc_displacement": {"x_mm": bore.real, "y_mm": bore.imag, "rotation_rad": bore_rotation},
        "disc_displacement_area": {"x_mm": pose.disc_x, "y_mm": pose.disc_y, "rotation_rad": pose.disc_rotation},
        "bearing_radial_N": radial,
        "bearing_tangential_N": tangential,
        "equilibrium_residual_N": contacts.equilibrium_residual,
        "pose_iterations": solution.pose_iterations,
        "dof": solution.unknowns,
        "size": solution.scale,
        "plane_state": solution.plane_state,
        "fingerprint": model.drive.fingerprint(),
        "seconds": solution.seconds["total"],
        "seconds_by_stage": {stage: value for stage, value in solution.seconds.items() if stage != "total"},
    }
    return content


def build_dataset(solution: FullSolution, case: str) -> xr.Dataset:
    """Return the solution as a labelled dataset, with the pressure of every loaded contact."""
    import xarray as xr

    contacts, model, pose = solution.contacts, solution.model, solution.pose
    data: dict[str, Any] = {}

    def add(name: str, values: Any, belongs: str, unit: str, text: str) -> None:
        dimensions = ("case", *DIMENSIONS[belongs])
        missing = len(dimensions) - np.ndim(values)
        spread = np.reshape(np.asarray(values, dtype=float), (1,) * missing + np.shape(values))
        data[name] = (dimensions, spread, {"units": unit, "long_name": text})

    for name, (attribute, belongs, unit, text) in ARRAYS.items():
        if name == "pin_shaft_pressure_mid" and not model.shaft_pins:
            text = f"{text}; {RIGID_SHAFT_PINS}"
        add(name, getattr(contacts, attribute), belongs, unit, text)
    radial, tangential = bearing_components(contacts, model.crank_angle)
    bore, bore_rotation = bore_motion(model, solution.state)
    for name, value, belongs, unit, text in (
        ("wheel_angle", pose.wheel_angle, "drive", "rad", "deviation of the wheel from φ_C/u, ccw positive"),
        ("disc_x", bore.real, "disc", "mm", "disc centre from inner-race centre, fixed axes, fitted to the bore"),
        ("disc_y", bore.imag, "disc", "mm", "disc centre from inner-race centre, fixed axes, fitted to the bore"),
        ("disc_rotation", bore_rotation, "disc", "rad", "rotation of the disc, fitted to the bore, ccw positive"),
        ("disc_area_x", pose.disc_x, "disc", "mm", "disc from inner-race centre, mean over the area"),
        ("disc_area_y", pose.disc_y, "disc", "mm", "disc from inner-race centre, mean over the area"),
        ("disc_area_rotation", pose.disc_rotation, "disc", "rad", "rotation of the disc, mean over the area"),
        ("bearing_radial", radial, "crank", "N", "bearing force on the disc along the eccentricity"),
        ("bearing_tangential", tangential, "crank", "N", "bearing force on the disc, 90° ahead of the eccentricity"),
        ("equilibrium_residual", contacts.equilibrium_residual, "drive", "N", "largest unbalanced force"),
    ):
        add(name, value, belongs, unit, text)
    for name, (values, unit, text) in _pressure_profiles(solution).items():
        data[name] = ("sample", values, {"units": unit, "long_name": text})
    attributes = {
        "Conventions": "CF-1.11",
        "title": f"full finite-element solution of {model.drive.name}",
        "source": f"cyclo {code_version()}",
        "version": code_version(),
        "code_hash": code_hash("ltca", "fem"),
        "drive": model.drive.name,
        "drive_file": drive_text(model.drive),
        "fingerprint": model.drive.fingerprint(),
        "model": f"finite elements, plane {solution.plane_state}",
        "plane": solution.plane_state,
        "elastic_shaft_pins": int(bool(model.shaft_pins)),
        "size": solution.scale,
        "unknowns": solution.unknowns,
    }
    return xr.Dataset(data, coords=_coordinates(model, solution.state.wheel_moment, case), attrs=attributes)


def _coordinates(model: DriveModel, wheel_moment: float, case: str) -> dict[str, Any]:
    """Return numbers and places of the parts, crank angle and torque: what ``results.nc`` has, for one position."""
    drive, place = model.drive, model.placement

    def at(dimensions: tuple[str, ...], values: Any, unit: str, text: str) -> tuple[Any, ...]:
        missing = len(dimensions) - np.ndim(values)
        return dimensions, np.reshape(values, (1,) * missing + np.shape(values)), {"units": unit, "long_name": text}

    found: dict[str, Any] = {"case": [case], "disc": [0], "crank": [0], "position": [0]}
    for name, radii in (
        ("pin", place.wheel_pin_radii),
        ("roller", place.roller_radii),
        ("hole", place.hole_radii),
    ):
        found[name] = np.arange(len(radii))
    for name, dimensions, centres, frame in (
        ("pin", ("case", "pin"), place.wheel_pin_centres, "wheel pin, in the frame of the wheel"),
        ("hole", ("case", "disc", "hole"), place.hole_centres, "hole, in the frame of the disc"),
        ("shaft_pin", ("case", "hole"), place.shaft_pin_centres, "shaft pin, in the fixed frame"),
    ):
        found[f"{name}_x"] = at(dimensions, centres.real, "mm", frame)
        found[f"{name}_y"] = at(dimensions, centres.imag, "mm", frame)
    cage = "angle of the roller in the cage, which stands at cage_speed · φ_C"
    torque = wheel_moment / drive.wheel_moment(1.0)
    return found | {
        "crank_angle": at(("position",), model.crank_angle, "rad", "crank angle φ_C, held"),
        "roller_angle": at(("case", "disc", "crank", "roller"), place.roller_cage_angles, "rad", cage),
        "cage_speed": at(("case",), float(place.cage_speed), "1", "cage angle by crank angle"),
        "torque": at(("case",), torque, "N mm", "output torque of the solution"),
        "driving_sign": at(("case",), drive.driving_sign, "1", "+1: the crank drives ccw, −1: cw"),
    }


def _pressure_profiles(solution: FullSolution) -> dict[str, tuple[Any, str, str]]:
    model, results = solution.model, solution.contacts
    kinds, indices, places, values = [], [], [], []
    for pair, detail in zip(model.pairs, results.details, strict=True):
        if detail.load > 0.0:
            arc = pair.zone.arc
            kinds.append(np.full(len(arc), pair.kind))
            indices.append(np.full(len(arc), pair.index))
            places.append(arc - detail.middle)
            own = pair.zone.at_vertices(solution.state.contact.pressure[pair.unknowns])
            values.append(vertex_means(arc, own))
    return {
        "pressure_contact": (np.concatenate(kinds).astype(str), "1", "kind of the contact of each sample"),
        "pressure_part": (np.concatenate(indices), "1", "number of its pin, roller or hole"),
        "pressure_place": (np.concatenate(places), "mm", "arc length from the centre of pressure"),
        "pressure": (np.concatenate(values), "MPa", "mean contact pressure under the shape function of each vertex"),
    }


def write_solution(solution: FullSolution, fields: Iterable[BodyField], case: str, folder: Path) -> None:
    """Write all files of a solution; each appears only when it is complete, ``fem.vtm`` only over bodies of this one.

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
    stress = recover_disc_stress(solution)
    with whole_file(folder / "fem.nc") as part:
        write_netcdf(build_dataset(solution, case).assign(stress_variables(stress)), part)
    bodies = [write_field(field, folder / f"{field.body.name}.vtu") for field in fields]
    write_multi_block(bodies, index)
    write_json(folder / "summary.json", summarise(solution) | summarise_stress(stress))


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
