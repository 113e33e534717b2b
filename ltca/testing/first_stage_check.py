"""First stage and forces from outside for the independent check: normal forces of teeth, moments by quadrature, hand rotations.

Independent of `ltca.equilibrium` and of `ltca.drive.members.first_stage`: tooth forces come from base circles and base helix, and
deflections of the crankshaft from bending moments.
"""

from __future__ import annotations

import numpy as np

from ltca.arrays import ComplexArray, FloatArray
from ltca.drive.parts import Drive
from ltca.testing.bearing_springs import crank_springs, softened
from ltca.testing.yielding_pins import crankshaft_bending


def tooth_forces(drive: Drive, moments: FloatArray) -> tuple[ComplexArray, FloatArray]:
    """Return force in the plane, complex, and along z of the sun on the planet of every crank by the moments that hold them, N.

    The normal force N of a tooth has the moment N cos β_b r_b about the planet: β_b is the helix angle on the base cylinder.
    """
    stage, distance = drive.first_stage, drive.crank.circle_radius
    assert stage is not None
    assert distance is not None
    teeth = stage.sun_teeth + stage.planet_teeth
    module = stage.module or 2.0 * distance * np.cos(stage.helix_angle) / teeth
    transverse = module / np.cos(stage.helix_angle)
    alpha = np.arctan(np.tan(stage.pressure_angle) / np.cos(stage.helix_angle))
    base = 0.5 * transverse * stage.planet_teeth * np.cos(alpha)
    base_helix = np.arcsin(np.sin(stage.helix_angle) * np.cos(stage.pressure_angle))
    normal = np.abs(moments) / (base * np.cos(base_helix))
    working = np.arccos(0.5 * transverse * teeth * np.cos(alpha) / distance)
    outward = np.array(drive.crank.places) / distance
    # The planet is pushed at the point that is nearest to the sun: ccw by a force to the right of the direction outward.
    along = np.where(moments >= 0.0, -1j, 1j) * outward
    in_plane = normal * np.cos(base_helix) * (np.cos(working) * along + np.sin(working) * outward)
    return in_plane, np.asarray(-np.sign(moments) * normal * np.sin(base_helix))


def teeth_on_shafts(drive: Drive, moments: FloatArray) -> tuple[ComplexArray, ComplexArray]:
    """Return the forces at the discs that move the cranks there as the teeth do, shape (discs, cranks), and what the two bearings
    of each crank carry of the teeth while these planes stand still, shape (2, cranks), N; zero where bearings are not told.
    """
    stage, distance, discs = drive.first_stage, drive.crank.circle_radius, drive.disc.number_of_discs
    assert stage is not None
    assert distance is not None
    in_plane, axial = tooth_forces(drive, moments)
    pitch = distance * stage.planet_teeth / (stage.sun_teeth + stage.planet_teeth)
    # A force along z at −r outward bends the shaft like opposite radial forces, the outer one of them at greater z.
    both = np.stack((in_plane, axial * pitch * np.array(drive.crank.places) / distance))
    held: FloatArray = np.zeros((discs, 2))
    if drive.crank.support is not None:
        columns = [crankshaft_bending(drive, stage.plane or 0.0, couple=which)[:-1, -1] for which in (False, True)]
        held = np.asarray(
            np.linalg.solve(softened(crankshaft_bending(drive), crank_springs(drive)), np.stack(columns, axis=1))
        )
    if drive.crank_supports is None:
        return held @ both, np.zeros((2, drive.crank.number), dtype=complex)
    start, end = drive.crank_supports
    second = (np.asarray(drive.disc.disc_planes) - start) / (end - start)
    return held @ both, teeth_on_supports(drive, moments) - np.stack([1.0 - second, second]) @ held @ both


def teeth_on_supports(drive: Drive, moments: FloatArray) -> ComplexArray:
    """Return what the bearings of each crank carry of the teeth, by lever arms, N, shape (bearings, cranks).

    Of cranks without told bearings the force of each planet is carried beside it.
    """
    stage, supports, distance = drive.first_stage, drive.crank_supports, drive.crank.circle_radius
    assert stage is not None
    assert distance is not None
    in_plane, axial = tooth_forces(drive, moments)
    if supports is None:
        return np.asarray(in_plane[None])
    start, end = supports
    pitch = distance * stage.planet_teeth / (stage.sun_teeth + stage.planet_teeth)
    tilted = axial * pitch * np.array(drive.crank.places) / distance
    far = (in_plane * ((stage.plane or 0.0) - start) + tilted) / (end - start)
    return np.stack((in_plane - far, far))


def outside_on_wheel(drive: Drive, crank_angle: float) -> complex:
    """Return the force from outside on the wheel relative to the pin shaft, in the frame of the shaft, N."""
    turned = np.exp(1j * crank_angle * drive.tooth_number_difference / drive.pin_wheel.number_of_pins)
    total = 0j
    for entry in drive.load.external:
        force = complex(entry.force.x, entry.force.y)
        if drive.installation.held == "pin-wheel":  # the shaft is the output, and the housing turns against it
            total -= force * (turned if entry.frame == "housing" else 1.0)
        else:
            total += force * (turned if entry.frame == "output" else 1.0)
    return total
