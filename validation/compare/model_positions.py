"""The LTCA's answer to the same positions, with each compliance model, in the form of `validation.compare.comparison`."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from ltca.analysis.engines import Engine, HalfSpace, engine_named
from ltca.analysis.loaded_analysis import LoadedAnalysis
from ltca.arrays import FloatArray
from ltca.compliance.coefficients import InfluenceCoefficients
from ltca.compliance.response import ContactPressures
from ltca.drive.hole_contact import shaft_pins_yield
from ltca.drive.parts import Compliance, Drive
from ltca.geometry.coordinates import DISC_ROTATION, WHEEL_ANGLE, disc_displacement
from validation.compare.comparison import Kind, KindAnswer, PositionAnswer

MODELS: tuple[Compliance, ...] = ("half-space", "fe", "hybrid")
FULL = "full FE"
"""Label of the full solution beside the models."""
DiscCoefficients: TypeAlias = InfluenceCoefficients | tuple[InfluenceCoefficients, ...]
"""Coefficients of the one disc of a drive, or of each of several."""


def engine_of(compliance: Compliance, coefficients: DiscCoefficients | None) -> Engine:
    """Return the engine of a compliance model, with the coefficients where it takes them."""
    return HalfSpace() if compliance == "half-space" else engine_named(compliance, coefficients=coefficients)


def answers_of(analysis: LoadedAnalysis) -> list[PositionAnswer]:
    """Return the analysis of a drive of one disc (`LoadedAnalysis.discs`) position by position."""
    (disc,) = analysis.model.discs
    full, response, pressures = analysis.full, analysis.full.response, analysis.pressures
    direction = disc.geometry.placement.eccentric_direction(full.crank_angle)
    displacement = disc_displacement(full.pose) * direction.conjugate()
    hole_pressure, hole_width = _hole_contacts(analysis.drive, pressures)
    columns: dict[Kind, tuple[FloatArray, FloatArray, FloatArray]] = {
        "pin": (response.pin_load, pressures.pins.mid, pressures.pins.half_width),
        "roller_outer": (response.rollers.outer_load, pressures.outer.mid, pressures.outer.half_width),
        "roller_inner": (response.rollers.inner_load, pressures.inner.mid, pressures.inner.half_width),
        "hole": (response.hole_load, hole_pressure, hole_width),
    }
    return [
        PositionAnswer(
            kinds={
                kind: KindAnswer(load=load[row], pressure=pressure[row], half_width=width[row])
                for kind, (load, pressure, width) in columns.items()
            },
            bearing_radial=analysis.bearing_radial[row, 0],
            bearing_tangential=analysis.bearing_tangential[row, 0],
            wheel_angle=float(full.pose[row, WHEEL_ANGLE]),
            disc_radial=float(displacement[row].real),
            disc_tangential=float(displacement[row].imag),
            disc_rotation=float(full.pose[row, DISC_ROTATION]),
        )
        for row in range(full.crank_angle.size)
    ]


def _hole_contacts(drive: Drive, pressures: ContactPressures) -> tuple[FloatArray, FloatArray]:
    """Return pressures and half-widths at the holes; NaN where shaft pins yield in full FE or the model only."""
    holes = pressures.holes
    if pressures.rigid_shaft_pins == shaft_pins_yield(drive):
        return np.full(holes.mid.shape, np.nan), np.full(holes.mid.shape, np.nan)
    return holes.mid, holes.half_width
