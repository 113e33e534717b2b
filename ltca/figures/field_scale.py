"""Units in which values of fields of a drive are drawn: small angles in minutes or degrees, all else as it is."""

from __future__ import annotations

import numpy as np

from ltca.arrays import FloatArray
from ltca.drive.fields import field_kind
from ltca.drive.units.quantities import ARCMIN
from ltca.drive.units.table import label

SMALL = np.radians(2.0)
"""Angles up to this are told in minutes."""


def field_scale(path: str, values: FloatArray) -> tuple[float, str]:
    """Return the factor by which values of a field, or of an element of an array, are multiplied, and their unit then."""
    kind = field_kind(path) or field_kind(path.rpartition(".")[0])
    unit = "" if kind is None else kind.unit
    if unit == "rad":
        largest = float(np.max(np.abs(values), initial=0.0))
        return (ARCMIN, "′") if largest <= SMALL else (float(np.degrees(1.0)), "°")
    return 1.0, "" if unit in ("", "1", "dimensionless") else label(unit)
