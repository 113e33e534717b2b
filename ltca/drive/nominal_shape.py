"""The shape that influence coefficients know: a drive without the errors of its single parts."""

from __future__ import annotations

from dataclasses import replace

from ltca.drive.parts import Clearance, Drive, PlacementErrors, ProfileErrors, RollerErrors, Runout


def nominal_shape(drive: Drive, *, keep_clearance: bool = True) -> Drive:
    """Return the drive without errors of single parts, which coefficients do not know, and without clearances if asked."""
    return replace(
        drive,
        clearance=drive.clearance if keep_clearance else Clearance(),
        pin_wheel=replace(drive.pin_wheel, pin_errors=PlacementErrors()),
        disc=replace(drive.disc, hole_errors=PlacementErrors(), profile_errors=ProfileErrors(), runout=Runout()),
        pin_shaft=replace(drive.pin_shaft, pin_errors=PlacementErrors()),
        crank_bearing=replace(drive.crank_bearing, roller_errors=RollerErrors()),
    )
