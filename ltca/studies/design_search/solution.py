"""What the loaded drive of a candidate reaches, judged as `cyclo check` judges it."""

from __future__ import annotations

from dataclasses import dataclass
from math import gcd

import numpy as np

from ltca.analysis.extremes import RESOLVED
from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.summary import summarise
from ltca.analysis.torque_curve import torque_curve
from ltca.analysis.verdict.values import find_values, judge_analysis
from ltca.drive.members.judgement import Check
from ltca.drive.members.limits import Limits
from ltca.drive.members.temperatures import warm_drive
from ltca.drive.parts import Drive
from ltca.drive.units.quantities import ARCMIN
from ltca.errors import CycloError
from ltca.geometry.placement import position_angles
from ltca.studies.design_search.closed_forms import Setting, shape_values
from ltca.studies.design_search.demands import OF_SHAPE, Demand
from ltca.studies.design_search.requirements import Requirements
from ltca.studies.design_search.sizes import Sizes, drive_of

COARSE_POSITIONS = 24
CHECK_POSITIONS = 360
"""Of `cyclo check`."""
BESIDE = 1e-3
"""Between the positions of a turn, so that nothing is refined, rad."""
CURVE_ANGLES = np.array([0.0, 0.1])
"""Crank angles at which stiffness and lost motion are read, rad."""
CURVE_POINTS = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class Solution:
    """What a candidate reaches.

    Attributes
    ----------
    values : dict of str to float
        By quantity; empty where it cannot be solved.
    checks : tuple of Check
        Of `cyclo check`, for fine solutions alone.
    positions : int
        Of a turn.
    message : str
        Why it cannot be solved.
    """

    values: dict[str, float]
    checks: tuple[Check, ...] = ()
    positions: int = COARSE_POSITIONS
    message: str = ""

    @property
    def passes(self) -> bool:
        """Whether `cyclo check` passes a fine solution."""
        return bool(self.checks) and not any(check.fails for check in self.checks)


def solve_coarsely(row: dict[str, float], requirements: Requirements, demands: tuple[Demand, ...]) -> Solution:
    """Return what a candidate reaches over few positions.

    Parameters
    ----------
    row : dict of str to float
        Of `Sizes.row`.
    requirements : Requirements
        What is asked.
    demands : tuple of Demand
        For what has to be known.
    """
    try:
        drive = drive_of(row, requirements)
        analysis = analyse(drive, position_angles(COARSE_POSITIONS) + BESIDE)
        found = {one.quantity: one.value for one in find_values(analysis, summarise(analysis)) if one.value is not None}
        return Solution(values=found | own_values(row, drive, requirements, demands))
    except CycloError as error:
        return Solution(values={}, message=" ".join(str(error).split()))


def own_values(
    row: dict[str, float], drive: Drive, requirements: Requirements, demands: tuple[Demand, ...]
) -> dict[str, float]:
    """Return what `cyclo check` does not tell: room, torque, margins of the shape as far as demanded, stiffness, lost motion.

    Parameters
    ----------
    row : dict of str to float
        Of `Sizes.row`.
    drive : Drive
        The same, built.
    requirements : Requirements
        What is asked.
    demands : tuple of Demand
        Stiffness and lost motion take a curve of their own, and are told where they are demanded.
    """
    shape = shape_values(Sizes.of_rows([row]), Setting.of(requirements))
    found = {name: float(shape[name][0]) for name in (*OF_SHAPE, "outer_diameter", "length", "torque")}
    if any(one.quantity in ("stiffness", "lost_motion") for one in demands):
        curve = torque_curve(warm_drive(drive), CURVE_ANGLES, points=CURVE_POINTS)
        found["stiffness"] = float(curve.stiffness.min())
        found["lost_motion"] = float(curve.lost_motion.max()) * ARCMIN
    return found


def check_positions(drive: Drive) -> int:
    """Return the positions at which to check a drive: those of `cyclo check`, one more where they alias with its teeth.

    Parameters
    ----------
    drive : Drive
        The drive.
    """
    distinct = CHECK_POSITIONS // gcd(CHECK_POSITIONS, drive.disc.number_of_teeth)
    return CHECK_POSITIONS if distinct >= RESOLVED else CHECK_POSITIONS + 1


def solve_finely(
    row: dict[str, float], drive: Drive, limits: Limits, requirements: Requirements, demands: tuple[Demand, ...]
) -> Solution:
    """Return what a drive reaches, with the checks of `cyclo check`.

    Parameters
    ----------
    row : dict of str to float
        Of `Sizes.row`.
    drive : Drive
        As it is written.
    limits : dict of str to Limit
        Of its file.
    requirements : Requirements
        What is asked.
    demands : tuple of Demand
        For what has to be known beside the checks.
    """
    positions = check_positions(drive)
    try:
        analysis = analyse(drive, position_angles(positions))
        checks = judge_analysis(analysis, summarise(analysis), limits)
        found = {check.value.quantity: check.value.value for check in checks if check.value.value is not None}
        found |= own_values(row, drive, requirements, demands)
        return Solution(values=found, checks=tuple(checks), positions=positions)
    except CycloError as error:
        return Solution(values={}, positions=positions, message=" ".join(str(error).split()))
