"""The labelled dataset of a run and the scalars of its summary."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ltca.analysis.loaded_analysis import LoadedAnalysis
from ltca.drive.parts import Drive
from ltca.errors import DriveError
from ltca.geometry.first_contact import DISC_ROTATION, WHEEL_ANGLE, backlash
from ltca.geometry.pairs import ContactGeometry
from ltca.geometry.placement import position_angles as position_angles

FloatArray = NDArray[np.float64]

LOADED_FRACTION = 1e-3
"""A contact counts as loaded above this part of the largest load of its kind in the case."""

ARCMIN = 180.0 / np.pi * 60.0
ARCSEC = 60.0 * ARCMIN

# name: (dimension of the pair or "", unit, description)
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
    "pin_half_width": ("pin", "mm", "contact half-width of wheel pin and flank at mid-width"),
    "roller_half_width_outer": ("roller", "mm", "contact half-width of roller and bore at mid-width"),
    "roller_half_width_inner": ("roller", "mm", "contact half-width of roller and inner race at mid-width"),
    "pin_contact_parameter": ("pin", "rad", "place of the contact on the flank, parameter of Eq. 1, in [0, 2π)"),
    "bearing_radial": ("", "N", "bearing force on the disc along the eccentricity"),
    "bearing_tangential": ("", "N", "bearing force on the disc, 90° ahead of the eccentricity"),
    "transmission_error": ("", "rad", "deviation of the wheel from φ_C/u at the torque of the run, ccw positive"),
    "transmission_error_light": ("", "rad", "the same at the light torque"),
    "disc_radial": ("", "mm", "disc centre from inner-race centre along the eccentricity"),
    "disc_tangential": ("", "mm", "disc centre from inner-race centre, 90° ahead of the eccentricity"),
    "disc_rotation": ("", "rad", "rotation of the disc, ccw positive"),
    "equilibrium_residual": ("", "N", "largest unbalanced force, moments by their lever arms"),
    "iterations": ("", "1", "Newton iterations at the torque of the run"),
}


def _values(analysis: LoadedAnalysis) -> dict[str, Any]:
    full = analysis.full
    contacts, pressures = full.response, analysis.pressures
    displacement = (full.pose[:, 0] + 1j * full.pose[:, 1]) * np.exp(-1j * full.crank_angle)
    return {
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
        "pin_half_width": pressures.pins.half_width,
        "roller_half_width_outer": pressures.outer.half_width,
        "roller_half_width_inner": pressures.inner.half_width,
        "pin_contact_parameter": np.mod(contacts.flank.parameter, 2.0 * np.pi),
        "bearing_radial": analysis.bearing_radial,
        "bearing_tangential": analysis.bearing_tangential,
        "transmission_error": full.pose[:, WHEEL_ANGLE],
        "transmission_error_light": analysis.light.pose[:, WHEEL_ANGLE],
        "disc_radial": displacement.real,
        "disc_tangential": displacement.imag,
        "disc_rotation": full.pose[:, DISC_ROTATION],
        "equilibrium_residual": full.residual,
        "iterations": full.iterations,
    }


def check_common_shape(cases: Mapping[str, Drive]) -> None:
    """Refuse cases with different numbers of pins, rollers or holes: they do not fit one dataset.

    Raises
    ------
    DriveError
        Naming the case and the numbers.
    """
    shapes = {
        name: (d.pin_wheel.number_of_pins, d.crank_bearing.number_of_rollers, d.pin_shaft.number_of_pins)
        for name, d in cases.items()
    }
    first = next(iter(shapes))
    problems = [
        f"case {name}: has {shape[0]} wheel pins, {shape[1]} rollers and {shape[2]} shaft pins: must be "
        f"{shapes[first][0]}, {shapes[first][1]} and {shapes[first][2]} as in case {first} to share one result "
        "(run it alone with --case)"
        for name, shape in shapes.items()
        if shape != shapes[first]
    ]
    if problems:
        raise DriveError(problems)


def build_dataset(drive_name: str, analyses: Mapping[str, LoadedAnalysis]) -> xr.Dataset:
    """Return the labelled dataset of a run.

    Parameters
    ----------
    drive_name : str
        Name of the drive.
    analyses : mapping of str to LoadedAnalysis
        One analysis for each case, all at the same crank angles.

    Returns
    -------
    xarray.Dataset
        Dimensions case, position, pin, roller, hole; units and descriptions in the attributes.
    """
    per_case = [_values(analysis) for analysis in analyses.values()]
    first = next(iter(analyses.values()))
    crank_angle = first.full.crank_angle
    variables = {}
    for name, (pair, unit, description) in VARIABLES.items():
        dimensions = ("case", "position", pair) if pair else ("case", "position")
        stacked = np.stack([values[name] for values in per_case])
        variables[name] = (dimensions, stacked, {"units": unit, "long_name": description})
    dataset = xr.Dataset(
        variables,
        coords={
            "case": list(analyses),
            "position": np.arange(crank_angle.size),
            "crank_angle": ("position", crank_angle, {"units": "rad", "long_name": "crank angle φ_C, held"}),
        },
        attrs={
            "drive": drive_name,
            "compliance": first.compliance,
            "method": first.method,
            "contacts": first.contacts,
            "cage_speed": ContactGeometry.of_drive(first.drive).placement.cage_speed,
            "torque_N_mm": [analysis.torque for analysis in analyses.values()],
            "driving_sign": [analysis.drive.driving_sign for analysis in analyses.values()],
            "fingerprint": [analysis.drive.fingerprint() for analysis in analyses.values()],
        },
    )
    # At unrelieved ends the largest pressure is singular: it is that of an end cell of this length.
    for name, kind in (
        ("pin_pressure_max", first.pressures.pins),
        ("roller_pressure_max_outer", first.pressures.outer),
        ("roller_pressure_max_inner", first.pressures.inner),
    ):
        dataset[name].attrs["end_cell_mm"] = kind.end_cell
    return dataset


def summarise(analysis: LoadedAnalysis) -> dict[str, float]:
    """Return the scalars of one case; means and peaks run over its positions.

    Parameters
    ----------
    analysis : LoadedAnalysis
        The case.

    Returns
    -------
    dict of str to float
        The keys of ``summary.json``, their units in their names.
    """
    geometry = ContactGeometry.of_drive(analysis.drive)
    full, contacts = analysis.full, analysis.full.response
    angle = full.crank_angle
    radial, tangential = analysis.bearing_radial, analysis.bearing_tangential
    pins, rollers, holes = (
        load > LOADED_FRACTION * np.max(load)
        for load in (contacts.pin_load, contacts.rollers.outer_load, contacts.hole_load)
    )
    pressures = analysis.pressures
    roller_mid = max(np.max(pressures.outer.mid), np.max(pressures.inner.mid))
    roller_largest = max(np.max(pressures.outer.largest), np.max(pressures.inner.largest))
    values = {
        "backlash_disc_arcmin": np.mean(backlash(geometry, angle, DISC_ROTATION)) * ARCMIN,
        "backlash_wheel_arcmin": np.mean(backlash(geometry, angle, WHEEL_ANGLE)) * ARCMIN,
        "mean_bearing_load_N": np.mean(np.hypot(radial, tangential)),
        "mean_radial_bearing_load_N": np.mean(radial),
        "mean_tangential_bearing_load_N": np.mean(tangential),
        "ptp_tangential_bearing_load_N": np.ptp(tangential),
        "max_pin_load_N": np.max(contacts.pin_load),
        "max_pin_pressure_mid_MPa": np.max(pressures.pins.mid),
        "max_pin_pressure_max_MPa": np.max(pressures.pins.largest),
        "max_roller_load_N": np.max(contacts.rollers.outer_load),
        "max_roller_pressure_mid_MPa": roller_mid,
        "max_roller_pressure_max_MPa": roller_largest,
        "pin_end_cell_mm": pressures.pins.end_cell,
        "roller_end_cell_mm": pressures.outer.end_cell,
        "max_pin_shaft_load_N": np.max(contacts.hole_load),
        "pin_shaft_loaded_range_deg": 360.0 * np.mean(holes),
        "mean_loaded_pins": np.mean(pins.sum(axis=1)),
        "mean_loaded_rollers": np.mean(rollers.sum(axis=1)),
        "mean_loaded_pin_shaft_pins": np.mean(holes.sum(axis=1)),
        "ptp_transmission_error_arcsec": np.ptp(full.pose[:, WHEEL_ANGLE]) * ARCSEC,
        "ptp_transmission_error_light_arcsec": np.ptp(analysis.light.pose[:, WHEEL_ANGLE]) * ARCSEC,
        "max_equilibrium_residual_N": max(np.max(full.residual), np.max(analysis.light.residual)),
    }
    return {name: float(value) for name, value in values.items()}
