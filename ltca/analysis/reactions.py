"""What the bearings of cranks and output carry: forces of the discs, of the first stage and from outside."""

from __future__ import annotations

from math import sin
from typing import Any

import numpy as np

from ltca.analysis.loaded_analysis import LoadedAnalysis
from ltca.arrays import ComplexArray, FloatArray
from ltca.beam import support_parts
from ltca.compliance.response import bearing_moments, bearing_pushes
from ltca.equilibrium.external_force import entries_of
from ltca.equilibrium.first_stage import MeshForces
from ltca.geometry.rotation import unit
from ltca.laws.member_bearings import crank_laws, journals, wheel_axial_stiffness, wheel_rows


def reaction_values(analysis: LoadedAnalysis) -> dict[str, Any]:
    """Return what first stage, bearings of cranks and main bearing add to the arrays of a case."""
    values: dict[str, Any] = {}
    forces = mesh_forces(analysis)
    if forces is not None:
        values |= {
            "first_stage_tangential_force": forces.tangential.T,
            "first_stage_radial_force": forces.radial.T,
            "first_stage_axial_force": forces.axial.T,
            "first_stage_lag": analysis.crank_lag,
        }
    carried = crank_support_forces(analysis)
    if carried is not None:
        values["crank_support_load_first"], values["crank_support_load_second"] = np.abs(carried).transpose(2, 1, 0)
    return values | _main_bearing(analysis)


def mesh_forces(analysis: LoadedAnalysis) -> MeshForces | None:
    """Return the forces of the sun on the planets (`ltca.equilibrium.first_stage`); None without teeth."""
    full, stage = analysis.full, analysis.model.stage
    if stage is None:
        return None
    return stage.forces(analysis.model.crank_moments(full.crank_angle, full.pose, full.response.parts))


def crank_support_forces(analysis: LoadedAnalysis) -> ComplexArray | None:
    """Return the force of each crank on each of its two bearings in the fixed frame, N, shape (positions, cranks, 2).

    None where the file says nothing of these (`Drive.crank_supports`).
    """
    drive, full, stage = analysis.drive, analysis.full, analysis.model.stage
    if drive.crank_supports is None:
        return None
    cranks, contacts = drive.crank.number, full.response.parts
    planes, slopes = journals(drive)
    parts = support_parts(planes, drive.crank_supports, slopes)
    pushes = [bearing_pushes(part.rollers, cranks) for part in contacts]
    if slopes:
        rays = [disc.geometry.rollers(full.crank_angle) for disc in analysis.model.discs]
        pushes += [bearing_moments(part.rollers, own, cranks) for part, own in zip(contacts, rays, strict=True)]
    carried = -np.matmul(np.stack(pushes, axis=-1), parts.T.astype(complex))
    if stage is not None:
        carried = carried + stage.on_bearings(
            analysis.model.crank_moments(full.crank_angle, full.pose, full.response.parts)
        )
    return np.asarray(carried)


def relieved_rows_warning(analysis: LoadedAnalysis) -> str | None:
    """Return a warning where axial forces exceed the axial preload of rows, whose radial stiffness is that at the preload."""
    drive, support, values = analysis.drive, analysis.drive.crank.support, reaction_values(analysis)
    found = []
    given = () if drive.main_bearing is None else drive.main_bearing.bearings
    pressed = [
        row.normal_load * sin(own.contact_angle)
        for row, own in zip(wheel_rows(drive), given, strict=True)
        if row.normal_load
    ]
    if pressed and "main_bearing_z" in values:
        found.append(("main_bearing.preload", np.max(np.abs(values["main_bearing_z"])), min(pressed)))
    if support is not None and support.load_constant is not None and "first_stage_axial_force" in values:
        held = (crank_laws(drive) or ())[0].preload_load * sin(support.contact_angle or 0.0)
        found.append(("crank.support.preload", np.nanmax(np.abs(values["first_stage_axial_force"])), held))
    told = [f"{force:.4g} N on rows of {path} = {held:.4g} N" for path, force, held in found if force > held]
    if not told:
        return None
    return (
        f"axial forces exceed the preload of bearings: {', '.join(told)}; one row is relieved, and stiffness and friction stay "
        "those at the preload"
    )


def _main_bearing(analysis: LoadedAnalysis) -> dict[str, FloatArray]:
    """Force and moment of the housing on the output where its main bearing is described or forces from outside act on it, in the
    frame of the housing.

    Moments are about the zero of the planes of the discs. Forces off that plane and along the axis tilt the output, and so do
    contacts that carry unevenly along their width; where the bearing is rigid in tilt they load it alone. Where its axial
    stiffness is known it yields along the axis.
    """
    drive, full = analysis.drive, analysis.full
    if not (drive.load.external or drive.wheel_yields or drive.contact.slices > 1):
        return {}
    wheel = unit(full.crank_angle / drive.reduction_ratio)
    into_housing = wheel.conjugate() if drive.wheel_is_held else np.ones(wheel.shape, dtype=complex)
    output_turned = wheel.conjugate() if drive.wheel_is_held else wheel
    force, moment = np.zeros(wheel.shape, dtype=complex), np.zeros(wheel.shape, dtype=complex)
    axial = 0.0 * full.crank_angle
    for frame, turned in (("housing", np.ones(wheel.shape, dtype=complex)), ("output", output_turned)):
        for entry in entries_of(drive, frame):
            pressed = complex(entry.force.x, entry.force.y)
            force = force + pressed * turned
            moment = moment + (complex(entry.moment.x, entry.moment.y) + 1j * entry.at.z * pressed) * turned
            axial = axial + entry.force.z
    pins = analysis.drive.pin_wheel.number_of_pins
    sense = -1.0 if drive.wheel_is_held else 1.0
    for plane, part in zip(drive.disc.disc_planes, full.response.parts, strict=True):
        pressed_by_disc = sense * part.pin_forces[:, :pins].sum(axis=1) * into_housing
        force, moment = force + pressed_by_disc, moment + 1j * plane * pressed_by_disc
        if part.leaning_pins is not None:
            moment = moment + 1j * sense * part.pin_moments[:, :pins].sum(axis=1) * into_housing
    teeth, stage = mesh_forces(analysis), drive.first_stage
    if drive.wheel_is_held and teeth is not None and stage is not None and analysis.model.stage is not None:
        outward, radius = analysis.model.stage.outward, float(np.max(analysis.model.stage.sun_radius))
        pressed_by_sun = teeth.in_plane.sum(axis=1) * into_housing
        tilted = (-1j * radius * outward * teeth.axial).sum(axis=1) * into_housing
        force, axial = force + pressed_by_sun, axial + teeth.axial.sum(axis=1)
        moment = moment + 1j * (stage.plane or 0.0) * pressed_by_sun + tilted
    stiffness = wheel_axial_stiffness(drive)
    displaced = {} if stiffness is None else {"main_bearing_axial_displacement": axial / stiffness}
    return displaced | {
        "main_bearing_x": -force.real,
        "main_bearing_y": -force.imag,
        "main_bearing_z": -axial,
        "main_bearing_moment_x": -moment.real,
        "main_bearing_moment_y": -moment.imag,
    }
