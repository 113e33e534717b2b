"""The labelled dataset of a run: what ``results.nc`` holds.

Dimensions stand in the order case, disc, crank, position, then pin, roller or hole, then slice or axis, always all of them that a
quantity has, of size 1 where a drive has one disc or one crank. Places of the parts are coordinates: wheel pins in
the frame of the wheel, holes in that of the disc, shaft pins in the fixed frame, rollers by their angle in the cage.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ltca.analysis.contact_arrays import contact_arrays
from ltca.analysis.friction.variables import friction_values
from ltca.analysis.half_width_guard import pin_deflections
from ltca.analysis.loaded_analysis import LoadedAnalysis
from ltca.analysis.reactions import reaction_values
from ltca.analysis.width import face_load_factors, width_coordinates, width_values
from ltca.arrays import FloatArray
from ltca.compliance import sliced
from ltca.compliance.response import ContactPressures
from ltca.compliance.wall_stress import WallStresses
from ltca.contact.subsurface import line_contact_shear
from ltca.drive.parts import Drive
from ltca.errors import DriveError, counted
from ltca.geometry.coordinates import DISC_ROTATION, WHEEL_ANGLE, disc_displacement
from ltca.geometry.placement import place_coordinates
from ltca.laws.backed import shaft_pin_seat, wheel_pin_seat
from ltca.output.labelled import LabelledDataset
from ltca.output.provenance import code_hash, code_version
from ltca.quantities import DIMENSIONS, QUANTITIES, SCHEMA_VERSION
from ltca.reading.writing import drive_text

if TYPE_CHECKING:
    import xarray as xr


def case_arrays(analysis: LoadedAnalysis) -> dict[str, Any]:
    """Return the arrays of one case by name, their dimensions those of the registry without the case."""
    full, light = analysis.full, analysis.light
    per_disc = [_disc_values(disc) for disc in analysis.discs]
    values = {name: np.stack([disc[name] for disc in per_disc]) for name in per_disc[0]} | face_load_factors(analysis)
    rubbed = friction_values(analysis, values)
    cranks = analysis.drive.crank.number
    return {name: _by_crank(value, QUANTITIES[name].of, cranks) for name, value in values.items()} | {
        "wheel_moment": full.wheel_moment,
        "wheel_angle": full.pose[:, WHEEL_ANGLE],
        "wheel_angle_light": light.pose[:, WHEEL_ANGLE],
        "transmission_error": analysis.transmission_error,
        "transmission_error_light": analysis.transmission_error_light,
        "equilibrium_residual": full.residual,
        "iterations": full.iterations,
        "crank_torque": analysis.crank_torques.T,
        "cage_moment": analysis.cage_moments.T,
        **_supports(analysis),
        **reaction_values(analysis),
        **rubbed,
        "status": (~analysis.balanced).astype(np.int32),
        "status_light": (~analysis.balanced_light).astype(np.int32),
    }


def _supports(analysis: LoadedAnalysis) -> dict[str, Any]:
    """Displacements of what yields on its supports, where anything does."""
    pose, coordinates = analysis.full.pose, analysis.model.coordinates
    values: dict[str, Any] = {}
    if coordinates.ring:
        values["ring_x"], values["ring_y"], values["ring_rotation"] = pose[:, coordinates.ring_place].T
    if (ring := analysis.ring_displacements) is not None:
        values["ring_displacement_radial"], values["ring_displacement_tangential"] = ring.real, ring.imag
    if coordinates.wheel:
        values["wheel_x"], values["wheel_y"] = pose[:, coordinates.wheel_place].T
    if coordinates.wheel_leans:
        along_x, along_y = pose[:, coordinates.wheel_lean_place].T
        values["wheel_tilt_x"], values["wheel_tilt_y"] = -along_y, along_x
    if coordinates.cranks:
        yielding = np.moveaxis(analysis.crank_deflections, 0, 2)
        values["crank_deflection_radial"], values["crank_deflection_tangential"] = yielding.real, yielding.imag
    if coordinates.twists:
        places = [coordinates.columns(disc)[list(coordinates.twist_places)] for disc in range(coordinates.discs)]
        values["crank_twist"] = np.moveaxis(pose[:, np.stack(places)], 0, 2)
    return values


def _disc_values(analysis: LoadedAnalysis) -> dict[str, Any]:
    """Quantities of one disc on its eccentric: (position,), (position, pair) or (position, pair, slice)."""
    full, pressures = analysis.full, analysis.pressures
    contacts = full.response.parts[0]
    place = analysis.model.discs[0].geometry.placement
    displacement = disc_displacement(full.pose) * place.eccentric_direction(full.crank_angle).conjugate()
    values = {
        **contact_arrays(contacts, pressures),
        "pin_contact_parameter": np.mod(contacts.flank.parameter, 2.0 * np.pi),
        "bearing_radial": analysis.bearing_radial[:, 0],
        "bearing_tangential": analysis.bearing_tangential[:, 0],
        "disc_torque": contacts.force[:, WHEEL_ANGLE],
        "disc_radial": displacement.real,
        "disc_tangential": displacement.imag,
        "disc_rotation": full.pose[:, DISC_ROTATION],
    }
    for walls in analysis.wall_stresses:
        values |= _wall_values(walls, pressures)
    return values | width_values(analysis) | _seat_values(analysis)


def _seat_values(analysis: LoadedAnalysis) -> dict[str, FloatArray]:
    """What loose pins, sleeves and bent pins of one disc have; nothing of fixed pins that do not bend."""
    drive, contacts = analysis.drive, analysis.full.response.parts[0]
    place = analysis.model.discs[0].geometry.placement
    values: dict[str, FloatArray] = {}
    for name, seat, load, play, leaning in (
        ("pin", wheel_pin_seat(drive), contacts.pin_load, place.wheel_pin_plays, contacts.leaning_pins),
        ("hole", shaft_pin_seat(drive), contacts.hole_load, place.shaft_pin_plays, contacts.leaning_holes),
    ):
        if seat is not None:
            each = np.broadcast_to(play, load.shape)
            values[f"{name}_seat_load"] = load
            if leaning is not None:
                # Arc and pressure are those of the most loaded end of a seat in which the pin leans.
                pressed, leaned = load > 0.0, sliced.SlicedSeat.of_law(seat, drive.contact.slices)
                load = load.copy()
                load[pressed] = leaned.heaviest(load[pressed], leaning.contact.moment[pressed], each[pressed])
            values[f"{name}_seat_arc"] = np.where(load > 0.0, 2.0 * seat.half_angle(load, each), 0.0)
            values[f"{name}_seat_pressure_max"] = np.where(load > 0.0, seat.largest_pressure(load, each), 0.0)
    return values | pin_deflections(drive, analysis.model, analysis.full)


def _wall_values(walls: WallStresses, pressures: ContactPressures) -> dict[str, Any]:
    return {
        "root_stress": walls.root,
        "bore_stress": walls.bore,
        "hole_stress": walls.hole,
        "pin_shear_max": line_contact_shear(pressures.pins.mid, walls.pin_contact),
        "roller_shear_max_outer": line_contact_shear(pressures.outer.mid, walls.roller_contact),
        "pin_shaft_shear_max": line_contact_shear(pressures.holes.mid, walls.hole_contact),
    }


def _by_crank(values: FloatArray, of: str, cranks: int) -> FloatArray:
    """Put the axis of the cranks behind that of the discs where a quantity has one: pairs come crank after crank."""
    if "crank" not in DIMENSIONS[of]:
        return values
    pairs = values.shape[2] // cranks
    parts = values.reshape(*values.shape[:2], cranks, pairs, *values.shape[3:]).swapaxes(1, 2)
    return parts if "roller" in DIMENSIONS[of] else parts[:, :, :, 0]


def coordinates(analyses: Mapping[str, LoadedAnalysis]) -> dict[str, Any]:
    """Return the coordinates of a dataset of analyses: cases, positions, places of the parts, torques."""
    each = analyses.values()
    first = next(iter(each))
    return {
        **place_coordinates(
            {name: analysis.drive for name, analysis in analyses.items()},
            [[disc.geometry.placement for disc in analysis.model.discs] for analysis in each],
            first.full.crank_angle,
        ),
        **width_coordinates({name: analysis.drive for name, analysis in analyses.items()}),
        **({} if not first.wall_stresses else {"lobe": np.arange(first.drive.disc.number_of_teeth)}),
        "torque": QUANTITIES["torque"].labelled([analysis.torque for analysis in each]),
        "light_torque": QUANTITIES["light_torque"].labelled([analysis.drive.load.light_torque for analysis in each]),
    }


def check_common_shape(cases: Mapping[str, Drive], mend: str = "run it alone with --case") -> None:
    """Refuse cases with different numbers of pins, rollers, holes, discs or slices, which do not fit one dataset.

    `mend` says what to do.

    Raises
    ------
    DriveError
        Naming the case and the numbers.
    """
    shapes: dict[str, tuple[int, ...]] = {
        name: (
            d.pin_wheel.number_of_pins,
            d.crank_bearing.number_of_rollers,
            d.number_of_holes,
            d.disc.number_of_discs,
            d.crank.number,
            d.contact.slices,
        )
        for name, d in cases.items()
    }
    first = next(iter(shapes))
    things: tuple[str, ...] = ("wheel pins", "rollers", "shaft pins", "discs", "cranks", "slices (contact.slices)")
    if len({drive.contact.slices for drive in cases.values()}) == 1:  # which goes without saying
        shapes, things = {name: shape[:-1] for name, shape in shapes.items()}, things[:-1]
    problems = [
        f"case {name}: has {_counted(shape, things)}: must be {_counted(shapes[first], things)} as in case {first} to share "
        f"one result ({mend})"
        for name, shape in shapes.items()
        if shape != shapes[first]
    ]
    if problems:
        raise DriveError(problems)


def _counted(numbers: tuple[int, ...], things: tuple[str, ...]) -> str:
    return ", ".join(counted(*each) for each in zip(numbers, things, strict=True))


def build_dataset(drive_name: str, analyses: Mapping[str, LoadedAnalysis], drive_file: str | None = None) -> xr.Dataset:
    """Return the labelled dataset of a run.

    Parameters
    ----------
    drive_name : str
        Name of the drive.
    analyses : mapping of str to LoadedAnalysis
        One analysis for each case, all at the same crank angles and on one engine.
    drive_file : str, optional
        Text of the drive file; by default the drive of the first case written as one.

    Returns
    -------
    xarray.Dataset
        Dimensions case, disc, crank, position, pin, roller, hole, slice, axis; units and descriptions in the attributes.
    """
    return labelled_results(drive_name, analyses, drive_file).to_xarray()


def labelled_results(
    drive_name: str, analyses: Mapping[str, LoadedAnalysis], drive_file: str | None = None
) -> LabelledDataset:
    """Return the same as `build_dataset` without xarray, for files and pages."""
    per_case = [case_arrays(analysis) for analysis in analyses.values()]
    named = {name: value for values in per_case for name, value in values.items()}
    first = next(iter(analyses.values()))
    variables = {}
    for name, quantity in QUANTITIES.items():
        if name not in named:
            continue
        # What one case has and another has not, as sleeves, is no number there.
        stacked = np.stack(
            [values[name] if name in values else np.full_like(named[name], np.nan) for values in per_case]
        )
        variables[name] = quantity.labelled(stacked)
    dataset = LabelledDataset.build(
        variables,
        coords=coordinates(analyses),
        attrs={
            **provenance(drive_name, first.as_written, drive_file),
            **first.engine.options,
            "status": "complete" if all(analysis.is_complete for analysis in analyses.values()) else "partial",
            "held": first.drive.installation.held,
            "fingerprint": [analysis.drive.fingerprint() for analysis in analyses.values()],
            **_bodies(analyses),
        },
    )
    # At unrelieved ends the largest pressure is singular: it is that of an end cell of this length.
    for name, pressures in (
        ("pin_pressure_max", first.pressures.pins),
        ("roller_pressure_max_outer", first.pressures.outer),
        ("roller_pressure_max_inner", first.pressures.inner),
        ("pin_shaft_pressure_max", first.pressures.holes),
    ):
        dataset[name].attrs["end_cell_mm"] = pressures.end_cell
    if told := _of_cases({name: analysis.hole_words for name, analysis in analyses.items()}):
        for name in ("pin_shaft_pressure_mid", "pin_shaft_pressure_max"):
            dataset[name].attrs["comment"] = told
    return dataset


def _of_cases(words: Mapping[str, str]) -> str:
    """Return what is told of all cases alike once, else case by case."""
    if len({*words.values()}) == 1:
        return next(iter(words.values()))
    return "; ".join(f"{name}: {told}" for name, told in words.items() if told)


def _bodies(analyses: Mapping[str, LoadedAnalysis]) -> dict[str, list[int] | list[str]]:
    """Whether coefficients of each case are its own or, on somebody's word, of bodies that differ a little; who derived them."""
    models = [analysis.model.discs for analysis in analyses.values()]
    used = [[disc.coefficients for disc in discs if disc.coefficients is not None] for discs in models]
    if not all(used):
        return {}
    return {
        "shared_coefficients": [int(any(own.shared for own in discs)) for discs in used],
        "coefficients_code_hash": [discs[0].code_hash for discs in used],
    }


def provenance(drive_name: str, drive: Drive, drive_file: str | None = None) -> dict[str, Any]:
    """Return the attributes that say what a file is and what made it; no clock and no folder among them."""
    return {
        "Conventions": "CF-1.11",
        "schema_version": SCHEMA_VERSION,
        "title": f"loaded tooth contact analysis of {drive_name}",
        "source": f"cyclo {code_version()}",
        "version": code_version(),
        "code_hash": code_hash("ltca"),
        "drive": drive_name,
        "drive_file": drive_text(drive) if drive_file is None else drive_file,
    }
