"""Stiffness and laws of the bearings of cranks and wheel as a drive gives them, and of crankshafts between them."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite, nan

import numpy as np

from ltca.arrays import FloatArray
from ltca.beam import shaft_flexibility, support_parts, torsion_flexibility
from ltca.drive.members.main_bearing import ROLLER, axial_preload
from ltca.drive.parts import CrankSupport, Drive, Preload
from ltca.laws.bearing_pair import RollingRow, SideLaw, facing_of


def crank_flexibility(drive: Drive) -> FloatArray | None:
    """Return the flexibility of a crank at its journals, mm/N, both sides of preloaded bearings carrying; None of rigid ones."""
    support = drive.crank.support
    if support is None:
        return None
    modulus = drive.materials.crankshaft.youngs_modulus
    planes, slopes = journals(drive)
    springs = crank_springs(drive)
    return shaft_flexibility(planes, support.positions, springs, support.diameter, modulus, slopes)


def crank_stiffness(drive: Drive) -> FloatArray | None:
    """Return the inverse of `crank_flexibility`, N/mm."""
    yields = crank_flexibility(drive)
    return None if yields is None else np.asarray(np.linalg.inv(yields))


def journals(drive: Drive) -> tuple[Sequence[float], Sequence[float]]:
    """Return the planes at which a crank is displaced, mm, and those at which it leans, as `Coordinates.journals` has them."""
    planes = drive.disc.disc_planes
    return planes, planes if drive.contact.slices > 1 else ()


def crank_torsion(drive: Drive) -> FloatArray | None:
    """Return the stiffness against twists at the discs from the splined planet, N·mm/rad; None where cranks do not twist."""
    support, shaft = drive.crank.support, drive.materials.crankshaft
    if support is None or not support.torsion:
        return None
    shear_modulus = shaft.youngs_modulus / (2.0 * (1.0 + shaft.poisson_ratio))
    planes = drive.disc.disc_planes
    return np.asarray(
        np.linalg.inv(torsion_flexibility(planes, support.spline_plane or 0.0, support.diameter, shear_modulus))
    )


def crank_bearing_stiffness(drive: Drive) -> tuple[float, float]:
    """Return the radial stiffness of the two bearings of a crank as given, or of tapered rollers at their preload, N/mm."""
    support = drive.crank.support
    assert support is not None
    if support.load_constant is None:
        first, second = support.stiffness
        return first, second
    radial = _tapered_row(support).radial
    return radial, radial


def _tapered_row(support: CrankSupport) -> RollingRow:
    """A bearing of a crank that is a preloaded row of tapered rollers."""
    return _row(ROLLER, support.contact_angle or 0.0, None, support.load_constant, support.preload)


def crank_springs(drive: Drive) -> tuple[float, float]:
    """Return the stiffness of the two bearings of a crank without clearance, both sides of preloaded ones carrying, N/mm."""
    laws = crank_laws(drive)
    first, second = crank_bearing_stiffness(drive) if laws is None else (law.stiffness for law in laws)
    return first, second


def crank_laws(drive: Drive) -> tuple[SideLaw, ...] | None:
    """Return the laws of the two bearings of a crank; None where they are springs alone."""
    support = drive.crank.support
    if support is None or (support.clearance is None and support.preload is None):
        return None
    found = []
    for stiffness in crank_bearing_stiffness(drive):
        if support.preload is None:
            found.append(SideLaw.of_clearance(stiffness, support.clearance or 0.0))
        elif support.load_constant is None:
            found.append(SideLaw.of_preload(stiffness, support.preload.force, support.preload.displacement))
        else:
            found.append(SideLaw.of_rows([_tapered_row(support)]))
    return tuple(found)


def wheel_rows(drive: Drive) -> tuple[RollingRow, ...]:
    """Return the rows of the main bearing about their preload; empty where it is given by its stiffness."""
    bearing = drive.main_bearing
    if bearing is None:
        return ()
    placed = [row.plane for row in bearing.bearings if row.contact_angle]
    middle = sum(placed) / max(len(placed), 1)
    found = []
    for row in bearing.bearings:
        if not row.contact_angle:
            found.append(RollingRow(radial=row.radial_stiffness or 0.0, axial=0.0, pressure_centre=row.plane))
            continue
        facing = facing_of(bearing.arrangement, row.plane, middle)
        found.append(
            _row(
                row.power,
                row.contact_angle,
                row.axial_stiffness,
                row.load_constant,
                row.preload or bearing.preload,
                plane=row.plane,
                pitch_radius=nan if row.pitch_radius is None else row.pitch_radius,
                facing=facing,
            )
        )
    return tuple(found)


def wheel_law(drive: Drive) -> SideLaw | float | None:
    """Return the radial stiffness of the main bearing, tilt held, N/mm, or its law with clearance or preload; None if rigid."""
    bearing = drive.main_bearing
    if bearing is None:
        return drive.pin_wheel.support_stiffness
    if rows := wheel_rows(drive):
        return side_law(drive, rows)
    stiffness = bearing.radial_stiffness or drive.pin_wheel.support_stiffness
    assert stiffness is not None
    if bearing.clearance is not None:
        return SideLaw.of_clearance(stiffness, bearing.clearance)
    held = bearing.preload
    return stiffness if held is None else SideLaw.of_preload(stiffness, held.force, held.displacement)


def side_law(drive: Drive, rows: Sequence[RollingRow]) -> SideLaw | float:
    """Radial stiffness of rows of the main bearing, N/mm, or their law with clearance or preload."""
    stiffness = sum(row.radial for row in rows)
    if drive.main_bearing is not None and drive.main_bearing.clearance is not None:
        return SideLaw.of_clearance(stiffness, drive.main_bearing.clearance)
    return SideLaw.of_rows(rows) if any(isfinite(row.reach) for row in rows) else stiffness


def wheel_axial_stiffness(drive: Drive) -> float | None:
    """Return the axial stiffness of the main bearing, N/mm; None where it is not known, as of rows with clearance."""
    bearing = drive.main_bearing
    if bearing is None or not bearing.bearings:
        return None if bearing is None else bearing.axial_stiffness
    found = sum(row.axial for row in wheel_rows(drive))
    return found if found and bearing.clearance is None else None


def _row(
    power: float,
    contact_angle: float,
    axial: float | None,
    load_constant: float | None,
    preload: Preload | None,
    *,
    plane: float = 0.0,
    pitch_radius: float = 0.0,
    facing: int = 1,
) -> RollingRow:
    """A row with a contact angle about its preload, by its axial stiffness there or by its load constant."""
    if preload is None:
        assert axial is not None
        return RollingRow.of_axial(axial, contact_angle, plane=plane, pitch_radius=pitch_radius, facing=facing)
    force, pressed = axial_preload(power, axial, load_constant, force=preload.force, displacement=preload.displacement)
    stiffness = power * force / pressed if axial is None else axial
    row = RollingRow.of_axial(stiffness, contact_angle, plane=plane, pitch_radius=pitch_radius, facing=facing)
    return row.pressed(contact_angle, force, pressed)


def crank_shares(drive: Drive) -> FloatArray:
    """Part of a force or couple at each journal that each of the two bearings of a crank carries, shape (journals, 2)."""
    support = drive.crank.support
    assert support is not None
    planes, slopes = journals(drive)
    return support_parts(planes, support.positions, slopes).T
