"""Arrays of all contacts of balanced positions by their names in the registry."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ltca.arrays import FloatArray
from ltca.compliance.response import ContactPressures, DiscResponse, Response

PARTS = {"pin": "wheel pin", "roller": "roller", "hole": "shaft pin", "lobe": "lobe"}
"""What the parts are called that a quantity belongs to (`ltca.quantities.Quantity.of`)."""
SIDES = ("_outer", "_inner")
"""Endings of names where a roller has a contact in the bore and one on the inner race."""


def contact_arrays(contacts: Response | DiscResponse, pressures: ContactPressures) -> dict[str, FloatArray]:
    """Return loads, approaches, pressures and half-widths of all contacts, shape (positions, pairs)."""
    rollers = contacts.rollers
    arrays = {
        "pin_load": contacts.pin_load,
        "roller_load": rollers.outer_load,
        "roller_load_inner": rollers.inner_load,
        "pin_shaft_load": contacts.hole_load,
        "pin_approach": contacts.flank.approach,
        "roller_approach_outer": rollers.outer_approach,
        "roller_approach_inner": rollers.inner_approach,
        "pin_shaft_approach": contacts.holes.approach,
    }
    kinds = (("pin", "", pressures.pins), ("pin_shaft", "", pressures.holes))
    of_rollers = (("roller", SIDES[0], pressures.outer), ("roller", SIDES[1], pressures.inner))
    for part, side, kind in (*kinds, *of_rollers):
        arrays[f"{part}_pressure_mid{side}"] = kind.mid
        arrays[f"{part}_pressure_max{side}"] = kind.largest
        arrays[f"{part}_half_width{side}"] = kind.half_width
    return arrays


def array_of(arrays: Mapping[str, FloatArray], name: str) -> FloatArray | None:
    """Return the array of a quantity, of both sides of the rollers where it is that of either; None where there is none."""
    if name in arrays:
        return arrays[name]
    sides = [arrays[name + side] for side in SIDES if name + side in arrays]
    return np.concatenate(sides, axis=-1) if sides else None
