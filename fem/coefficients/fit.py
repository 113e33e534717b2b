"""Check that a file of influence coefficients belongs to the bodies of a drive: dimensions and stations."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fem.shapes import DriveShapes
from ltca.drive.parts import Bodies, Drive
from ltca.drive.single_discs import nominal_shape
from ltca.errors import CycloError
from ltca.reading.coefficient_laws import Check
from ltca.reading.coefficient_schema import is_solid, require_same_supports, shape_differences, shape_of

if TYPE_CHECKING:
    from ltca.output.labelled import Labelled


@dataclass(frozen=True, slots=True, kw_only=True)
class _Fit:
    """How far stations lie from where a drive has them: largest distance (half-widths) and difference of normals."""

    distance: float
    normals: float


def check_against_drive(dataset: Labelled, drive: Drive, source: str) -> tuple[Check, ...]:
    """Check that coefficients belong to the bodies of a drive: places and normals of the stations.

    CycloError, naming the file `source`, when the numbers that its bodies are made of are not the drive's, or the numbers of
    boundaries differ.
    """
    nominal = _served_by(dataset, drive, source)
    fit = _fit(dataset, nominal)
    if fit is None:
        raise CycloError(
            f"{source}: has stations on {len(np.unique(dataset['station_boundary'].values))} boundaries; flank, bores "
            f"and holes of {drive.name} are {1 + drive.crank.number + drive.number_of_holes}"
        )
    return (
        Check(
            name="places of the stations on the drive's bodies",
            value=fit.distance,
            lowest=0.0,
            highest=1e-3,
            reason="in half-widths of a patch: coefficients change by that part of the near field's unit",
        ),
        Check(
            name="normals of the stations on the drive's bodies",
            value=fit.normals,
            lowest=0.0,
            highest=1e-3,
            reason="loads and approaches are along them; a cosine changes by the square",
        ),
    )


def _served_by(dataset: Labelled, drive: Drive, source: str) -> Drive:
    """Return the nominal drive that a file was derived for, with its clearances or, where the file leaves them out, without."""
    theirs = shape_of(dataset)
    bodies: Bodies = "solid" if is_solid(dataset) else "plane"
    for keep in (True, False) if float(dataset.attrs["clearances_left_out"]) else (True,):
        nominal = nominal_shape(drive, keep_clearance=keep)
        if theirs == nominal.body_shape(bodies):
            require_same_supports(source, dataset, nominal)
            return nominal
    own = drive.body_shape(bodies)
    different = shape_differences(theirs, own)
    differences = ", ".join(f"{name} {here} ({there} there)" for name, (here, there) in different.items())
    raise CycloError(f"{source}: belongs to other bodies than those of {drive.name}: {differences}")


def _fit(dataset: Labelled, nominal: Drive) -> _Fit | None:
    """Return how the stations fit a drive; None when it has other boundaries."""
    curves = DriveShapes.of_drive(nominal).disc.curves
    boundary = dataset["station_boundary"].values
    if len(np.unique(boundary)) != len(curves):
        return None
    distance = normals = 0.0
    for number, curve in enumerate(curves):
        own = np.flatnonzero(boundary == number)
        parameter = dataset["station_parameter"].values[own]
        place = dataset["station_x"].values[own] + 1j * dataset["station_y"].values[own]
        normal = dataset["station_normal_x"].values[own] + 1j * dataset["station_normal_y"].values[own]
        away = np.abs(place - curve.points(parameter)) / dataset["station_half_width"].values[own]
        distance = max(distance, float(np.max(away)))
        normals = max(normals, float(np.max(np.abs(normal - curve.normals(parameter)))))
    return _Fit(distance=distance, normals=normals)
