"""The quantities of one drive solved finely: many positions for means, extremes searched between them.

Studies and searches solve few positions of many drives, and extremes over few positions fall short. What is said of a
single drive in the end, of the optimum found for instance, is solved again here.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np

from ltca.analysis.engines import Engine
from ltca.analysis.extremes import refine_extremes
from ltca.analysis.loaded_analysis import analyse
from ltca.drive.parts import Drive
from ltca.equilibrium.output_angle import play_before_cranks
from ltca.geometry.coordinates import WHEEL_ANGLE
from ltca.geometry.first_contact import backlash
from ltca.geometry.placement import position_angles
from ltca.geometry.play import play_over_a_turn
from ltca.studies.quantities import STAGES, SampleBatch, evaluate
from ltca.studies.shapes import with_kept_coefficients

FINE_POSITIONS = 360
BACKLASH_POSITIONS = 3600
"""Positions of the backlash of the flank: geometry alone, cheap."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FineSolution:
    """Quantities of one drive.

    Attributes
    ----------
    values : dict of str to float
        By name, in the units of `ltca.studies.quantities`.
    positions : int
        Behind means; extremes are searched between them.
    """

    values: dict[str, float]
    positions: int


def solve_finely(
    drive: Drive, quantities: tuple[str, ...], engine: Engine, positions: int = FINE_POSITIONS
) -> FineSolution:
    """Return the quantities of one drive, means over positions 2πk/N of the crank and extremes refined between them.

    Examples
    --------
    >>> from ltca.analysis.engines import HalfSpace
    >>> from ltca.reading.drive_file import load_drive
    >>> drive = load_drive("paper").cases["CS-1"]
    >>> found = solve_finely(drive, ("ptp_transmission_error",), HalfSpace(), 13)
    >>> print(f"{found.values['ptp_transmission_error']:.1f} arcsec")
    5.4 arcsec
    """
    analysis = analyse(drive, position_angles(positions), engine=with_kept_coefficients(engine, drive))
    play = None
    if any(STAGES[name] == "backlash" for name in quantities):
        play = backlash(analysis.model.geometries, position_angles(BACKLASH_POSITIONS), WHEEL_ANGLE)
    free = None
    if any(STAGES[name] == "play" for name in quantities):
        turn = play_over_a_turn(analysis.model.geometries, partial(play_before_cranks, analysis.model))
        free = np.array([turn.least, turn.largest])
    batch = SampleBatch(
        drives=(drive,),
        model=analysis.model,
        full=analysis.full,
        pressures=analysis.pressures,
        light=analysis.light,
        backlash=play,
        play=free,
    )
    values = {name: float(evaluate(name, batch)[0]) for name in quantities}
    values |= {name: value for name, value in refine_extremes(analysis).values.items() if name in quantities}
    return FineSolution(values=values, positions=positions)
