"""What vibrations leave of single forces: the dataset ``dynamics.nc``, at rest and at the told speeds of a response."""

from __future__ import annotations

from typing import Any

import numpy as np

from ltca.analysis.engines import describe_engine
from ltca.analysis.force_orders import (
    BEARING_RADIAL,
    BEARING_TANGENTIAL,
    MAIN_BEARING_X,
    MAIN_BEARING_Y,
    ROLLER,
    SHAFT_PIN,
    WHEEL_PIN,
)
from ltca.analysis.forced_vibration import ForcedVibration
from ltca.analysis.vibration import Vibration
from ltca.output.labelled import LabelledDataset
from ltca.quantities import QUANTITIES, SCHEMA_VERSION

NAMES = {
    WHEEL_PIN: ("pin_load", "pin_order"),
    ROLLER: ("roller_load", "roller_order"),
    SHAFT_PIN: ("pin_shaft_load", "hole_order"),
    BEARING_RADIAL: ("bearing_radial", "bearing_order"),
    BEARING_TANGENTIAL: ("bearing_tangential", "bearing_order"),
    MAIN_BEARING_X: ("main_bearing_x", "main_bearing_order"),
    MAIN_BEARING_Y: ("main_bearing_y", "main_bearing_order"),
}
"""Quantities and dimension of the orders, by kind of force."""


def force_dataset(found: Vibration, answer: ForcedVibration | None) -> LabelledDataset:
    """Return the spectra of all single forces as a labelled dataset, those at rest as those at the speed 0.

    Parameters
    ----------
    found : Vibration
        Vibrations of a drive.
    answer : ForcedVibration or None
        Its response; None leaves the forces at rest.
    """
    spectra = found.forces if answer is None else answer.forces
    data, coords = dict[str, tuple[Any, ...]](), dict[str, tuple[Any, ...]]()
    for one in spectra:
        name, orders = NAMES[one.kind]
        mean, amplitude, rest = one.mean, one.amplitude, one.rest
        if answer is None:
            mean, amplitude, rest = mean[None], amplitude[:, None], rest[None]
        values = {
            "over_speed": mean,
            "order_amplitude": np.moveaxis(np.abs(amplitude), 0, -1).astype(np.float32),
            "order_phase": np.moveaxis(-np.angle(amplitude), 0, -1).astype(np.float32),
            "order_rest": rest,
        }
        data |= {f"{name}_{ending}": QUANTITIES[f"{name}_{ending}"].labelled(each) for ending, each in values.items()}
        told = {"units": "1", "long_name": "order by turn of the crank against the pin shaft"}
        coords[orders] = ((orders,), one.orders, told)
    speed = np.zeros(1) if answer is None else answer.told_speed
    coords["speed"] = (("speed",), speed, {"units": "rpm", "long_name": "speed of the input; 0 is at rest"})
    attributes = {
        "schema_version": SCHEMA_VERSION,
        "engine": describe_engine(found.engine),
        "drive": found.drive.name,
        "case": found.drive.case,
        "turns": found.turns,
    }
    return LabelledDataset.build(data, coords, attributes)
