"""The shipped robot joint as plane bodies have it, and full finite elements of a drive beside the LTCA on ``fe``."""

from __future__ import annotations

from typing import Any

import numpy as np

from fem.options import SolutionOptions
from fem.reducer.solution import ReducerSolution, solve_reducer
from ltca.analysis.engines import PlaneStrain
from ltca.analysis.loaded_analysis import LoadedAnalysis, analyse
from ltca.drive.parts import Drive
from ltca.drive.units.quantities import ARCSEC
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive


def plane_joint(**changes: Any) -> Drive:
    """Return the joint with rollers as long as the disc and no profiles, and further changes."""
    drive = load_drive("robot-joint").cases["nominal"]
    plain: dict[str, Any] = {"crank_bearing.roller_length": drive.disc.thickness}
    for table in ("crank_bearing.roller_profile", "pin_wheel.pin_profile"):
        plain |= {f"{table}.{name}": 0.0 for name in ("crown_drop", "logarithmic_factor")}
        plain |= {f"{table}.{name}": 0.0 for name in ("end_relief_length", "end_relief_depth")}
    return with_fields(drive, plain | changes)


def compared(drive: Drive, angle: float, size: float) -> tuple[ReducerSolution, LoadedAnalysis, float, float]:
    """Return both answers, the largest difference of a load by the largest of its kind, and that of the output, arc seconds."""
    full = solve_reducer(drive, angle, SolutionOptions(size=size))
    own = analyse(drive, np.array([angle]), engine=PlaneStrain())
    differences = []
    for disc, other in zip(full.discs, own.discs, strict=True):
        contacts, response = disc.contacts, other.full.response
        for load, expected in (
            (contacts.pin_load, response.pin_load),
            (contacts.roller_load, response.rollers.outer_load),
            (contacts.pin_shaft_load, response.hole_load),
        ):
            differences.append(float(np.max(np.abs(load - expected[0])) / np.max(load)))
    turned = ARCSEC * abs(full.transmission_error - float(own.transmission_error[0]))
    return full, own, max(differences), turned
