"""Values of the loaded drive of a candidate, judged as by `cyclo check`."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import gcd, inf

import numpy as np
from numpy.typing import NDArray

from ltca.analysis.engines import Engine, HalfSpace, engine_named
from ltca.analysis.extremes import RESOLVED
from ltca.analysis.friction.hysteresis import hysteresis_loop
from ltca.analysis.loaded_analysis import LoadedAnalysis, analyse
from ltca.analysis.summary import summarise
from ltca.analysis.torque_curve import LOST_MOTION, torque_curve, torsional_stiffness
from ltca.analysis.verdict.lead_crown import best_lead_crown
from ltca.analysis.verdict.values import LIVES, find_values, judge_analysis
from ltca.drive.members.judgement import Check
from ltca.drive.members.limits import Limits
from ltca.drive.members.temperatures import warm_drive
from ltca.drive.parts import Compliance, Drive
from ltca.drive.units.quantities import ARCMIN
from ltca.errors import CycloError
from ltca.geometry.placement import position_angles
from ltca.studies.design_search.closed_forms import Setting, lives_by_loads, shape_values
from ltca.studies.design_search.demands import OF_SHAPE, Demand
from ltca.studies.design_search.requirements import CLEARANCES, Requirements
from ltca.studies.design_search.sizes import Sizes, drive_of
from ltca.studies.shapes import with_kept_coefficients

COARSE_POSITIONS = 24
TURNS, HOURS = "bearing_life_million_turns", "bearing_life_hours"
CHECK_POSITIONS = 360
"""Of `cyclo check`."""
CROWN_DECIMALS = 3
"""Decimals of the drop of a crown in mm, as of all sizes."""
OFFSET = 1e-3
"""Offset of positions from those of a whole turn, between which extremes would be refined, rad."""
CURVE_ANGLES = np.array([0.0, 0.1])
"""Crank angles at which stiffness and lost motion are read, rad."""
CURVE_POINTS, LOOP_POINTS = 4, 16
"""Torques of each direction of a curve, and of a loop with friction in fine solutions, as `cyclo curves` has them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Solution:
    """Values of a candidate by a solution.

    Attributes
    ----------
    values : dict of str to float
        By quantity; empty where it cannot be solved.
    checks : tuple of Check
        Of `cyclo check`, for fine solutions alone.
    positions : int
        Of a turn.
    compliance : {"half-space", "hybrid"}
        How bodies yield.
    message : str
        Why it cannot be solved.
    life_factor : float or None
        Life by what ISO 281 says of the mean force, of coarse solutions with a demand on lives.
    """

    values: dict[str, float]
    checks: tuple[Check, ...] = ()
    positions: int = COARSE_POSITIONS
    compliance: Compliance = "half-space"
    message: str = ""
    life_factor: float | None = None

    @property
    def passes(self) -> bool:
        """Whether `cyclo check` passes a fine solution."""
        return bool(self.checks) and not any(check.fails for check in self.checks)


def solve_coarsely(
    row: dict[str, float], requirements: Requirements, demands: tuple[Demand, ...], life_factor: float | None = None
) -> Solution:
    """Return the values of a candidate over few positions.

    `life_factor` is that of an earlier solution of nearly the same sizes: lives then follow from the forces, as rollers in slices
    take longer than all else.
    """
    try:
        drive = _on_beam(drive_of(row, requirements))
        positions = COARSE_POSITIONS if drive.disc.number_of_discs == 1 else COARSE_POSITIONS // 2
        analysis = analyse(drive, position_angles(positions) + OFFSET, engine=HalfSpace())
        by_forces = _lives_by_forces(row, analysis, requirements)
        asked = [one for one in demands if one.quantity in LIVES]
        # ISO 281 with the mean force falls short of the slices by a factor of two or so: what it finds enough is.
        short = any(float(one.margin(by_forces[one.quantity])) < 0.0 for one in asked)
        values = find_values(analysis, summarise(analysis), lives=short and life_factor is None)
        found = {one.quantity: one.value for one in values if one.value is not None}
        if asked:
            if short and life_factor is None:
                life_factor = found.get(TURNS, by_forces[TURNS]) / by_forces[TURNS]
            factors = {TURNS: life_factor or 1.0, HOURS: life_factor or 1.0}
            found = {name: value * factors.get(name, 1.0) for name, value in by_forces.items()} | found
        found |= own_values(row, drive, requirements, demands, CURVE_ANGLES[:1], coarse=True)
        found["disc_share"] = least_disc_share(analysis)
        return Solution(values=found, life_factor=life_factor)
    except CycloError as error:
        return Solution(values={}, message=" ".join(str(error).split()))


def with_lead_crown(row: dict[str, float], requirements: Requirements, most_mid: float = inf) -> dict[str, float]:
    """Return a candidate with the crown of the flank that `cyclo check` would advise, within what the shop makes.

    The least that it makes where another one takes too little off the ends to be told, and where the drive cannot be built;
    `most_mid` is what the flank may have at mid-width, MPa.
    """
    low, high = requirements.asked.lead_crowns
    if low == high:
        return row
    least = row | {"lead_crown_drop": low}
    try:
        drive = _on_beam(drive_of(least, requirements))
        crown = best_lead_crown(drive, drive.load.torque, (low, high), most_mid)
    except CycloError:
        return least
    if crown is None or not crown.words:
        return least
    return row | {"lead_crown_drop": min(max(round(crown.drop, CROWN_DECIMALS), low), high)}


def _on_beam(drive: Drive) -> Drive:
    """A drive whose ring, if it has one, is a beam: finite elements are derived for each shape."""
    return drive if drive.ring is None else replace(drive, ring=replace(drive.ring, model="beam"))


def least_disc_share(analysis: LoadedAnalysis) -> float:
    """Return what the least loaded disc carries of the torque, mean over the positions, by an even share; 1 of one disc."""
    share = analysis.torque_share
    return float(share.shape[1] * share.mean(axis=0).min())


def _lives_by_forces(row: dict[str, float], analysis: LoadedAnalysis, requirements: Requirements) -> dict[str, float]:
    force = np.hypot(analysis.bearing_radial, analysis.bearing_tangential)
    force = force.reshape(force.shape[0], -1)
    mean = (force ** (10.0 / 3.0)).mean(axis=0).max() ** 0.3
    sizes, setting = Sizes.of_rows([row]), Setting.of(requirements)
    found = lives_by_loads(sizes, setting, np.array([force.max()]), np.array([mean]))
    return {name: float(value[0]) for name, value in found.items()}


def own_values(
    row: dict[str, float],
    drive: Drive,
    requirements: Requirements,
    demands: tuple[Demand, ...],
    angles: NDArray[np.float64] = CURVE_ANGLES,
    engine: Engine | None = None,
    coarse: bool = False,
) -> dict[str, float]:
    """Return values that `cyclo check` has not: room, torque, margins of the shape as far as demanded, stiffness, lost motion.

    Stiffness and lost motion are read from torque curves, at `angles` in rad, solved where they are demanded: few points
    of what the bodies yield for the stiffness, a loop for lost motion with friction, some hundred times as long.
    """
    shape = shape_values(Sizes.of_rows([row]), Setting.of(requirements))
    found = {name: float(shape[name][0]) for name in (*OF_SHAPE, *CLEARANCES, "outer_diameter", "length", "torque")}
    if any(one.quantity in ("stiffness", "lost_motion") for one in demands):
        warm = warm_drive(drive)
        smooth = replace(warm, friction=None)
        demanded = any(one.quantity == "lost_motion" for one in demands)
        if not demanded and (coarse or drive.friction is not None):
            return found | {"stiffness": float(torsional_stiffness(smooth, angles, engine=engine).min())}
        curve = torque_curve(smooth, angles, points=CURVE_POINTS, engine=engine)
        lost = curve.lost_motion
        if drive.friction is not None:
            points = CURVE_POINTS if coarse else LOOP_POINTS
            lost = hysteresis_loop(warm, angles, lost_motion=LOST_MOTION, points=points, engine=engine).lost_motion
        found |= {"stiffness": float(curve.reducer_stiffness.min()), "lost_motion": float(lost.max()) * ARCMIN}
    return found


def check_positions(drive: Drive) -> int:
    """Return at how many positions to check a drive: as many as `cyclo check`, one more where those alias with the teeth."""
    distinct = CHECK_POSITIONS // gcd(CHECK_POSITIONS, drive.disc.number_of_teeth)
    return CHECK_POSITIONS if distinct >= RESOLVED else CHECK_POSITIONS + 1


def solve_finely(
    row: dict[str, float],
    drive: Drive,
    limits: Limits,
    requirements: Requirements,
    demands: tuple[Demand, ...],
    *,
    lives: bool = True,
    compliance: Compliance = "half-space",
) -> Solution:
    """Return the values of a drive, with the checks of `cyclo check`; coefficients of its shape are derived where there are none.

    `row` and `drive` are the same candidate; `lives` tells whether lives are wanted where no limit asks for them.
    """
    positions = check_positions(drive)
    try:
        engine = with_kept_coefficients(engine_named(compliance), drive)
        analysis = analyse(drive, position_angles(positions), engine=engine)
        checks = judge_analysis(analysis, summarise(analysis), limits, lives=lives)
        found = {check.value.quantity: check.value.value for check in checks if check.value.value is not None}
        found |= own_values(row, drive, requirements, demands, engine=engine)
        found["disc_share"] = least_disc_share(analysis)
        return Solution(values=found, checks=tuple(checks), positions=positions, compliance=compliance)
    except CycloError as error:
        return Solution(values={}, positions=positions, compliance=compliance, message=" ".join(str(error).split()))
