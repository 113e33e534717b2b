"""The labelled dataset of a run: what ``results.nc`` holds.

Dimensions stand in the order case, disc, crank, position, then pin, roller or hole, always all of them that a
quantity has, of size 1 where a drive has one disc or one crank. Places of the parts are coordinates: wheel pins in
the frame of the wheel, holes in that of the disc, shaft pins in the fixed frame, rollers by their angle in the cage.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ltca.analysis.friction.variables import VARIABLES as FRICTION_VARIABLES, friction_values
from ltca.analysis.half_width_guard import pin_deflections
from ltca.analysis.loaded_analysis import LoadedAnalysis
from ltca.compliance.coupled import CoupledCompliance
from ltca.compliance.response import ContactPressures
from ltca.compliance.wall_stress import WallStresses
from ltca.contact.subsurface import line_contact_shear
from ltca.drive.parts import Drive
from ltca.errors import DriveError
from ltca.geometry.coordinates import DISC_ROTATION, WHEEL_ANGLE, disc_displacement
from ltca.laws.backed import shaft_pin_seat, wheel_pin_seat
from ltca.output.provenance import code_hash, code_version
from ltca.reading.writing import drive_text

FloatArray = NDArray[np.float64]

# What a quantity belongs to, and the dimensions behind `case` that follow from it.
DIMENSIONS = {
    "drive": ("position",),
    "disc": ("disc", "position"),
    "crank": ("disc", "crank", "position"),
    "crankshaft": ("crank", "position"),
    "pin": ("disc", "position", "pin"),
    "roller": ("disc", "crank", "position", "roller"),
    "hole": ("disc", "position", "hole"),
    "lobe": ("disc", "position", "lobe"),
}
# name: (what it belongs to, unit, description)
VARIABLES: dict[str, tuple[str, str, str]] = {
    "pin_load": ("pin", "N", "load of wheel pin and flank"),
    "roller_load": ("roller", "N", "load of roller and bore (outer side)"),
    "roller_load_inner": ("roller", "N", "load of roller and inner race"),
    "pin_shaft_load": ("hole", "N", "load of shaft pin and hole"),
    "pin_approach": ("pin", "mm", "approach of wheel pin and flank, negative when open"),
    "roller_approach_outer": ("roller", "mm", "approach of roller and bore, negative when open"),
    "roller_approach_inner": ("roller", "mm", "approach of roller and inner race"),
    "pin_shaft_approach": ("hole", "mm", "approach of shaft pin and hole, negative when open"),
    "pin_pressure_mid": ("pin", "MPa", "largest pressure of wheel pin and flank at mid-width"),
    "roller_pressure_mid_outer": ("roller", "MPa", "largest pressure of roller and bore at mid-width"),
    "roller_pressure_mid_inner": ("roller", "MPa", "largest pressure of roller and inner race at mid-width"),
    "pin_pressure_max": ("pin", "MPa", "largest pressure of wheel pin and flank anywhere, end cell in attrs"),
    "roller_pressure_max_outer": ("roller", "MPa", "largest pressure of roller and bore anywhere, end cell in attrs"),
    "roller_pressure_max_inner": (
        "roller",
        "MPa",
        "largest pressure of roller and inner race anywhere, end cell in attrs",
    ),
    "pin_shaft_pressure_mid": ("hole", "MPa", "largest pressure of shaft pin and hole at mid-width"),
    "pin_shaft_pressure_max": ("hole", "MPa", "largest pressure of shaft pin and hole anywhere, end cell in attrs"),
    "pin_half_width": ("pin", "mm", "contact half-width of wheel pin and flank at mid-width"),
    "roller_half_width_outer": ("roller", "mm", "contact half-width of roller and bore at mid-width"),
    "roller_half_width_inner": ("roller", "mm", "contact half-width of roller and inner race at mid-width"),
    "pin_shaft_half_width": ("hole", "mm", "contact half-width of shaft pin and hole at mid-width"),
    "pin_contact_parameter": ("pin", "rad", "place of the contact on the flank, parameter of Eq. 1, in [0, 2π)"),
    "bearing_radial": ("crank", "N", "bearing force on the disc along the eccentricity"),
    "bearing_tangential": ("crank", "N", "bearing force on the disc, 90° ahead of the eccentricity"),
    "pin_seat_load": ("pin", "N", "load of the wheel pin in its slot, or of the sleeve on the wheel pin"),
    "pin_seat_arc": ("pin", "rad", "angle of the arc under pressure there"),
    "pin_seat_pressure_max": ("pin", "MPa", "largest pressure there"),
    "pin_deflection": ("pin", "mm", "displacement of the bent wheel pin at the disc, under the forces of all discs"),
    "hole_seat_load": ("hole", "N", "load of the sleeve on the shaft pin"),
    "hole_seat_arc": ("hole", "rad", "angle of the arc under pressure there"),
    "hole_seat_pressure_max": ("hole", "MPa", "largest pressure there"),
    "shaft_pin_deflection": (
        "hole",
        "mm",
        "displacement of the bent shaft pin at the disc, under the forces of all discs",
    ),
    "ring_x": ("drive", "mm", "displacement of the ring that ties the tips of the shaft pins, fixed frame"),
    "ring_y": ("drive", "mm", "displacement of the ring that ties the tips of the shaft pins, fixed frame"),
    "ring_rotation": ("drive", "rad", "rotation of that ring, ccw positive"),
    "crank_torque": (
        "crankshaft",
        "N mm",
        "external moment that holds the crank by virtual work, ∂U/∂φ_C: that of the forces on it plus cage_speed times "
        "cage_moment, and what rubs there; ccw positive",
    ),
    "cage_moment": (
        "crankshaft",
        "N mm",
        "external moment that holds the roller cages of the crank, a part of the balance of all forces; ccw positive",
    ),
    "crank_deflection_radial": ("crank", "mm", "crank at the disc, along its eccentricity; torsion and tilt left out"),
    "crank_deflection_tangential": ("crank", "mm", "crank at the disc, 90° ahead of its eccentricity"),
    "wheel_x": ("drive", "mm", "displacement of the wheel on its bearing in the fixed frame"),
    "wheel_y": ("drive", "mm", "displacement of the wheel on its bearing in the fixed frame"),
    "disc_torque": ("disc", "N mm", "part of the external moment on the wheel that the disc carries, ccw positive"),
    "wheel_moment": ("drive", "N mm", "external moment on the wheel at the torque of the run, ccw positive"),
    "wheel_angle": ("drive", "rad", "deviation of the wheel from φ_C/u at the torque of the run, ccw positive"),
    "wheel_angle_light": ("drive", "rad", "the same at the light torque"),
    "transmission_error": ("drive", "rad", "deviation of the output at the torque of the run, ccw positive"),
    "transmission_error_light": ("drive", "rad", "the same at the light torque"),
    "disc_radial": ("disc", "mm", "disc centre from inner-race centre along the eccentricity"),
    "disc_tangential": ("disc", "mm", "disc centre from inner-race centre, 90° ahead of the eccentricity"),
    "disc_rotation": ("disc", "rad", "rotation of the disc, ccw positive"),
    "equilibrium_residual": ("drive", "N", "largest unbalanced force, moments by their lever arms"),
    "iterations": ("drive", "1", "Newton iterations at the torque of the run"),
    "status": ("drive", "1", "0: balanced at the torque of the run, 1: no equilibrium found"),
    "status_light": ("drive", "1", "the same at the light torque"),
}

# What bodies with walls have besides: engines on derived coefficients.
WALL_VARIABLES: dict[str, tuple[str, str, str]] = {
    "root_stress": ("lobe", "MPa", "largest tensile stress along the flank about each lobe root, clear of contacts"),
    "bore_stress": ("disc", "MPa", "largest tensile stress along the bore, clear of contacts"),
    "hole_stress": ("hole", "MPa", "largest tensile stress along the wall of each hole, clear of contacts"),
    "pin_shear_max": ("pin", "MPa", "largest shear stress in the disc below wheel pins, its own stress included"),
    "roller_shear_max_outer": ("roller", "MPa", "largest shear stress in the disc below rollers, likewise"),
    "pin_shaft_shear_max": ("hole", "MPa", "largest shear stress in the disc below shaft pins, likewise"),
}


def _values(analysis: LoadedAnalysis) -> dict[str, Any]:
    """Quantities of one case in the dimensions that `DIMENSIONS` says."""
    full, light = analysis.full, analysis.light
    per_disc = [_disc_values(disc) for disc in analysis.discs]
    values = {name: np.stack([disc[name] for disc in per_disc]) for name in per_disc[0]}
    rubbed = friction_values(analysis, values)
    cranks = analysis.drive.crank.number
    return {
        name: _by_crank(value, VARIABLES.get(name) or WALL_VARIABLES[name], cranks) for name, value in values.items()
    } | {
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
    if coordinates.wheel:
        values["wheel_x"], values["wheel_y"] = pose[:, coordinates.wheel_place].T
    if coordinates.cranks:
        yielding = np.moveaxis(analysis.crank_deflections, 0, 2)
        values["crank_deflection_radial"], values["crank_deflection_tangential"] = yielding.real, yielding.imag
    return values


def _disc_values(analysis: LoadedAnalysis) -> dict[str, Any]:
    """Quantities of one disc on its eccentric: (position,) or (position, pair)."""
    full, pressures = analysis.full, analysis.pressures
    contacts = full.response
    place = analysis.model.discs[0].geometry.placement
    displacement = disc_displacement(full.pose) * place.eccentric_direction(full.crank_angle).conjugate()
    values = {
        "pin_load": contacts.pin_load,
        "roller_load": contacts.rollers.outer_load,
        "roller_load_inner": contacts.rollers.inner_load,
        "pin_shaft_load": contacts.hole_load,
        "pin_approach": contacts.flank.approach,
        "roller_approach_outer": contacts.rollers.outer_approach,
        "roller_approach_inner": contacts.rollers.inner_approach,
        "pin_shaft_approach": contacts.holes.approach,
        "pin_pressure_mid": pressures.pins.mid,
        "roller_pressure_mid_outer": pressures.outer.mid,
        "roller_pressure_mid_inner": pressures.inner.mid,
        "pin_pressure_max": pressures.pins.largest,
        "roller_pressure_max_outer": pressures.outer.largest,
        "roller_pressure_max_inner": pressures.inner.largest,
        "pin_shaft_pressure_mid": pressures.holes.mid,
        "pin_shaft_pressure_max": pressures.holes.largest,
        "pin_half_width": pressures.pins.half_width,
        "roller_half_width_outer": pressures.outer.half_width,
        "roller_half_width_inner": pressures.inner.half_width,
        "pin_shaft_half_width": pressures.holes.half_width,
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
    return values | seat_values(analysis)


def seat_values(analysis: LoadedAnalysis) -> dict[str, FloatArray]:
    """Return what loose pins, sleeves and bent pins of one disc have: loads, arcs and pressures of seats, deflections.

    Parameters
    ----------
    analysis : LoadedAnalysis
        Of one disc.

    Returns
    -------
    dict of str to array, shape (positions, pairs)
        By name in the dataset, as there; empty for fixed pins that do not bend.
    """
    drive, contacts = analysis.drive, analysis.full.response
    place = analysis.model.discs[0].geometry.placement
    values: dict[str, FloatArray] = {}
    for name, seat, load, play in (
        ("pin", wheel_pin_seat(drive), contacts.pin_load, place.wheel_pin_plays),
        ("hole", shaft_pin_seat(drive), contacts.hole_load, place.shaft_pin_plays),
    ):
        if seat is not None:
            each = np.broadcast_to(play, load.shape)
            values[f"{name}_seat_load"] = load
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


def _by_crank(values: FloatArray, described: tuple[str, str, str], cranks: int) -> FloatArray:
    """Put the axis of the cranks behind that of the discs where a quantity has one: pairs come crank after crank."""
    if "crank" not in DIMENSIONS[described[0]]:
        return values
    parts = values.reshape(*values.shape[:2], cranks, -1).swapaxes(1, 2)
    return parts[..., 0] if described[0] == "crank" else parts


def coordinates(analyses: Mapping[str, LoadedAnalysis]) -> dict[str, Any]:
    """Return the coordinates of a dataset of analyses: cases, positions, places of the parts, torques."""
    discs = [[disc.geometry.placement for disc in analysis.model.discs] for analysis in analyses.values()]
    places = [each[0] for each in discs]
    first = next(iter(analyses.values()))
    cranks = places[0].cranks
    counts = {"pin": places[0].wheel_pin_radii.size, "roller": places[0].roller_radii.size // cranks}
    counts["hole"] = places[0].hole_radii.size
    wheel_pins, shaft_pins = (
        np.stack([getattr(place, name) for place in places]) for name in ("wheel_pin_centres", "shaft_pin_centres")
    )
    holes, cages = (
        np.array([[getattr(place, name) for place in each] for each in discs])
        for name in ("hole_centres", "roller_cage_angles")
    )
    mm, rad = {"units": "mm"}, {"units": "rad"}

    def per_case(values: list[Any], unit: str, text: str) -> tuple[str, list[Any], dict[str, str]]:
        return "case", values, {"units": unit, "long_name": text}

    return {
        "case": list(analyses),
        "disc": np.arange(len(discs[0])),
        "crank": np.arange(places[0].cranks),
        "position": np.arange(first.full.crank_angle.size),
        **{name: np.arange(count) for name, count in counts.items()},
        **({} if not first.wall_stresses else {"lobe": np.arange(first.drive.disc.number_of_teeth)}),
        "crank_angle": ("position", first.full.crank_angle, {**rad, "long_name": "crank angle φ_C, held"}),
        "pin_x": (("case", "pin"), wheel_pins.real, {**mm, "long_name": "wheel pin, in the frame of the wheel"}),
        "pin_y": (("case", "pin"), wheel_pins.imag, {**mm, "long_name": "wheel pin, in the frame of the wheel"}),
        "hole_x": (
            ("case", "disc", "hole"),
            holes.real,
            {**mm, "long_name": "hole, in the frame of the disc"},
        ),
        "hole_y": (
            ("case", "disc", "hole"),
            holes.imag,
            {**mm, "long_name": "hole, in the frame of the disc"},
        ),
        "shaft_pin_x": (("case", "hole"), shaft_pins.real, {**mm, "long_name": "shaft pin, in the fixed frame"}),
        "shaft_pin_y": (("case", "hole"), shaft_pins.imag, {**mm, "long_name": "shaft pin, in the fixed frame"}),
        "roller_angle": (
            ("case", "disc", "crank", "roller"),
            cages.reshape(*cages.shape[:2], cranks, -1),
            {**rad, "long_name": "angle of the roller in the cage, which stands at cage_speed · φ_C"},
        ),
        "disc_phase": (
            ("case", "disc"),
            [analysis.drive.disc.disc_phases for analysis in analyses.values()],
            {**rad, "long_name": "phase of the disc's eccentric against the crank angle"},
        ),
        "disc_plane": (
            ("case", "disc"),
            [analysis.drive.disc.disc_planes for analysis in analyses.values()],
            {**mm, "long_name": "axial place of the disc's middle"},
        ),
        "cage_speed": per_case([float(place.cage_speed) for place in places], "1", "cage angle by crank angle"),
        "torque": per_case([analysis.torque for analysis in analyses.values()], "N mm", "output torque of the run"),
        "light_torque": per_case(
            [analysis.drive.load.light_torque for analysis in analyses.values()], "N mm", "light output torque"
        ),
        "driving_sign": per_case(
            [analysis.drive.driving_sign for analysis in analyses.values()], "1", "+1: the crank drives ccw, −1: cw"
        ),
    }


def check_common_shape(cases: Mapping[str, Drive]) -> None:
    """Refuse cases with different numbers of pins, rollers, holes or discs: they do not fit one dataset.

    Raises
    ------
    DriveError
        Naming the case and the numbers.
    """
    shapes = {
        name: (
            d.pin_wheel.number_of_pins,
            d.crank_bearing.number_of_rollers,
            d.number_of_holes,
            d.disc.number_of_discs,
            d.crank.number,
        )
        for name, d in cases.items()
    }
    first = next(iter(shapes))
    things = ("wheel pins", "rollers", "shaft pins", "discs", "cranks")
    problems = [
        f"case {name}: has {_counted(shape, things)}: must be {_counted(shapes[first], things)} as in case {first} to share "
        "one result (run it alone with --case)"
        for name, shape in shapes.items()
        if shape != shapes[first]
    ]
    if problems:
        raise DriveError(problems)


def _counted(numbers: tuple[int, ...], things: tuple[str, ...]) -> str:
    each = zip(numbers, things, strict=True)
    return ", ".join(f"{number} {thing if number != 1 else thing.removesuffix('s')}" for number, thing in each)


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
        Dimensions case, disc, crank, position, pin, roller, hole; units and descriptions in the attributes.
    """
    per_case = [_values(analysis) for analysis in analyses.values()]
    named = {name: value for values in per_case for name, value in values.items()}
    first = next(iter(analyses.values()))
    variables = {}
    for name, (kind, unit, description) in (VARIABLES | FRICTION_VARIABLES | WALL_VARIABLES).items():
        if name not in named:
            continue
        # What one case has and another has not, as sleeves, is no number there.
        stacked = np.stack(
            [values[name] if name in values else np.full_like(named[name], np.nan) for values in per_case]
        )
        variables[name] = (("case", *DIMENSIONS[kind]), stacked, {"units": unit, "long_name": description})
    dataset = xr.Dataset(
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
    models = [
        [disc for disc in analysis.model.discs if isinstance(disc, CoupledCompliance)] for analysis in analyses.values()
    ]
    used = [[disc.coefficients for disc in model] for model in models]
    if not all(used):
        return {}
    return {
        "shared_coefficients": [int(any(own.shared for own in discs)) for discs in used],
        "coefficients_code_hash": [discs[0].code_hash for discs in used],
    }


def provenance(drive_name: str, drive: Drive, drive_file: str | None = None) -> dict[str, str]:
    """Return the attributes that say what a file is and what made it; no clock and no folder among them."""
    return {
        "Conventions": "CF-1.11",
        "title": f"loaded tooth contact analysis of {drive_name}",
        "source": f"cyclo {code_version()}",
        "version": code_version(),
        "code_hash": code_hash("ltca"),
        "drive": drive_name,
        "drive_file": drive_text(drive) if drive_file is None else drive_file,
    }
