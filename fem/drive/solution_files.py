"""Files of a full solution: ``summary.json``, ``fem.nc`` and one ``.vtu`` for each body."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fem.contact.pressure_measures import vertex_means
from fem.drive.contact_results import ContactResults
from fem.drive.disc_stress import recover_disc_stress, stress_variables, summarise_stress
from fem.drive.fields import BodyField, bore_motion
from fem.drive.solution import FullSolution
from fem.mesh.mesh_file import write_vtu
from ltca.output.files import whole_file

if TYPE_CHECKING:
    import xarray as xr

# name in files: (attribute of ContactResults, dimension, unit, description)
ARRAYS: dict[str, tuple[str, str, str, str]] = {
    "pin_load": ("pin_load", "pin", "N", "load of wheel pin and flank"),
    "roller_load_outer": ("roller_load_outer", "roller", "N", "load of roller and bore"),
    "roller_load_inner": ("roller_load_inner", "roller", "N", "load of roller and inner race"),
    "pin_shaft_load": ("pin_shaft_load", "hole", "N", "load of shaft pin and hole"),
    "pin_pressure_max": ("pin_pressure_max", "pin", "MPa", "peak pressure of wheel pin and flank"),
    "roller_pressure_max_outer": ("roller_pressure_max_outer", "roller", "MPa", "peak pressure of roller and bore"),
    "roller_pressure_max_inner": ("roller_pressure_max_inner", "roller", "MPa", "peak pressure of roller and race"),
    "pin_shaft_pressure_max": ("hole_pressure_max", "hole", "MPa", "peak pressure of shaft pin and hole"),
    "pin_half_width": ("pin_half_width", "pin", "mm", "half-width 2√⟨x²⟩ of wheel pin and flank"),
    "roller_half_width_outer": ("roller_half_width_outer", "roller", "mm", "half-width of roller and bore"),
    "roller_half_width_inner": ("roller_half_width_inner", "roller", "mm", "half-width of roller and race"),
    "pin_shaft_half_width": ("hole_half_width", "hole", "mm", "half-width of shaft pin and hole"),
}


def bearing_components(contacts: ContactResults, crank_angle: float) -> tuple[float, float]:
    """Return the bearing force on the disc along the eccentricity and 90° ahead of it, N."""
    along = contacts.bearing_force * np.exp(-1j * crank_angle)
    return float(along.real), float(along.imag)


def summarise(solution: FullSolution) -> dict[str, Any]:
    """Return the content of ``summary.json``: arrays of full length, zeros included."""
    contacts, model, pose = solution.contacts, solution.model, solution.pose
    content: dict[str, Any] = {}
    for name, (attribute, _, unit, _) in ARRAYS.items():
        content[f"{name}_{unit}"] = [float(value) for value in getattr(contacts, attribute)]
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
    for name, (attribute, dimension, unit, text) in ARRAYS.items():
        values = np.asarray(getattr(contacts, attribute))[None, None, :]
        data[name] = (("case", "position", dimension), values, {"units": unit, "long_name": text})
    radial, tangential = bearing_components(contacts, model.crank_angle)
    bore, bore_rotation = bore_motion(model, solution.state)
    scalars = {
        "wheel_angle": (pose.wheel_angle, "rad", "deviation of the wheel from φ_C/u, ccw positive"),
        "disc_x": (bore.real, "mm", "disc centre from inner-race centre, fixed axes, fitted to the bore"),
        "disc_y": (bore.imag, "mm", "disc centre from inner-race centre, fixed axes, fitted to the bore"),
        "disc_rotation": (bore_rotation, "rad", "rotation of the disc, fitted to the bore, ccw positive"),
        "disc_area_x": (pose.disc_x, "mm", "disc from inner-race centre, mean over the area"),
        "disc_area_y": (pose.disc_y, "mm", "disc from inner-race centre, mean over the area"),
        "disc_area_rotation": (pose.disc_rotation, "rad", "rotation of the disc, mean over the area"),
        "bearing_radial": (radial, "N", "bearing force on the disc along the eccentricity"),
        "bearing_tangential": (tangential, "N", "bearing force on the disc, 90° ahead of the eccentricity"),
        "equilibrium_residual": (contacts.equilibrium_residual, "N", "largest unbalanced force"),
    }
    for name, (value, unit, text) in scalars.items():
        data[name] = (("case", "position"), np.array([[value]]), {"units": unit, "long_name": text})
    profile = _pressure_profiles(solution)
    for name, (values, unit, text) in profile.items():
        data[name] = ("sample", values, {"units": unit, "long_name": text})
    coordinates = {
        "case": [case],
        "crank_angle": ("position", [model.crank_angle], {"units": "rad"}),
        "pin": np.arange(len(contacts.pin_load)),
        "roller": np.arange(len(contacts.roller_load_outer)),
        "hole": np.arange(len(contacts.pin_shaft_load)),
    }
    attributes = {
        "drive": model.drive.name,
        "fingerprint": model.drive.fingerprint(),
        "model": f"finite elements, plane {solution.plane_state}",
        "unknowns": solution.unknowns,
        "size": solution.scale,
    }
    return xr.Dataset(data, coords=coordinates, attrs=attributes)


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
    """Write all files of a solution; each appears only when it is complete.

    Raises
    ------
    CycloError
        When the folder cannot be written to.
    """
    stress = recover_disc_stress(solution)
    with whole_file(folder / "fem.nc") as part:
        build_dataset(solution, case).assign(stress_variables(stress)).to_netcdf(part, engine="h5netcdf")
    for field in fields:
        write_field(field, folder / f"{field.body.name}.vtu")
    with whole_file(folder / "summary.json") as part:
        content = summarise(solution) | summarise_stress(stress)
        text = json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False)
        part.write_text(text + "\n", encoding="utf-8")


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
