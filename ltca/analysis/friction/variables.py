"""What friction adds to the dataset of a run."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ltca.analysis.friction.losses import KINDS, JointSlip, Losses
from ltca.analysis.loaded_analysis import LoadedAnalysis
from ltca.arrays import FloatArray


def friction_values(analysis: LoadedAnalysis, pressures: Mapping[str, FloatArray]) -> dict[str, Any]:
    """Return what friction adds to the arrays of a case; `pressures` by name, shape (discs, positions, pairs)."""
    found, back = analysis.losses, analysis.losses_back
    if found is None or back is None:
        return {}
    values: dict[str, Any] = {}
    for pins, seat, joint in (("pin", "pin_seat", found.pins), ("pin_shaft", "hole_seat", found.holes)):
        values |= _of_joint(pins, seat, joint, found, pressures)
    values |= {f"loss_{kind}": found.by_kind[kind] for kind in KINDS}
    return values | {
        "power_loss": found.watts(found.total),
        "input_torque": found.input_torque,
        "input_torque_back": back.input_torque,
        "efficiency": found.efficiency,
        "efficiency_back": back.efficiency,
        "moves_back": np.where(np.isnan(back.at_input), np.nan, analysis.moves_back),
    }


def _of_joint(
    pins: str, seat: str, joint: JointSlip, found: Losses, pressures: Mapping[str, FloatArray]
) -> dict[str, FloatArray]:
    speed = found.per_second(joint.slip)
    values = {
        f"{pins}_friction_force": joint.force,
        f"{pins}_slip": joint.slip,
        f"{pins}_slip_speed": speed,
        f"{pins}_friction_power": found.watts(joint.energy),
        f"{pins}_pv": pressures[f"{pins}_pressure_mid"] * speed * 1e-3,
    }
    if f"{seat}_pressure_max" in pressures:
        seat_speed = found.per_second(joint.seat_slip)
        values |= {
            f"{seat}_slip": joint.seat_slip,
            f"{seat}_slip_speed": seat_speed,
            f"{seat}_pv": pressures[f"{seat}_pressure_max"] * seat_speed * 1e-3,
        }
    return values
