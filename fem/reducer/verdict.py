"""What a full solution reaches, judged by the same limits as the LTCA."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from fem.drive.disc_stress import DiscStress
from fem.reducer.solution import ReducerSolution
from ltca.drive.members.judgement import Check, Value, judge
from ltca.drive.members.limits import Limit

FloatArray = NDArray[np.float64]


def judge_solution(
    solution: ReducerSolution, stresses: Sequence[DiscStress], limits: Mapping[str, Limit]
) -> list[Check]:
    """Return the checks of one position by full finite elements: loads, peak pressures, stresses of the disc.

    Parameters
    ----------
    solution : ReducerSolution
        The solution.
    stresses : sequence of DiscStress
        Of each disc (`fem.drive.disc_stress.recover_disc_stress`).
    limits : mapping of str to Limit
        Of the drive file; those on what one position cannot say are left out.
    """
    contacts = [disc.contacts for disc in solution.discs]
    found: dict[str, list[tuple[str, list[FloatArray]]]] = {
        "pin_load": [("wheel pin", [each.pin_load for each in contacts])],
        "roller_load": [("roller", [each.roller_load_outer for each in contacts])],
        "pin_shaft_load": [("shaft pin", [each.pin_shaft_load for each in contacts])],
        "pin_pressure_mid": [("wheel pin", [each.pin_pressure_max for each in contacts])],
        "roller_pressure_mid_outer": [("roller", [each.roller_pressure_max_outer for each in contacts])],
        "roller_pressure_mid_inner": [("roller", [each.roller_pressure_max_inner for each in contacts])],
        "pin_shaft_pressure_mid": [("shaft pin", [each.hole_pressure_max for each in contacts])],
        "disc_shear": [
            ("below wheel pin", [stress.pin_shear for stress in stresses]),
            ("below roller", [stress.roller_shear for stress in stresses]),
            ("below shaft pin", [stress.hole_shear for stress in stresses]),
        ],
        "root_stress": [("lobe", [stress.root_stress for stress in stresses])],
        "bore_stress": [("bore", [np.atleast_1d(stress.bore_stress) for stress in stresses])],
        "hole_stress": [("hole", [stress.hole_stress for stress in stresses])],
    }
    values = [
        value
        for quantity, kinds in found.items()
        if (value := _largest(quantity, kinds, solution.crank_angle)) is not None
    ]
    told = {value.quantity for value in values} | {"roller_pressure_mid"}
    return judge(solution.drive, values, {key: limit for key, limit in limits.items() if limit.quantity in told})


def _largest(quantity: str, kinds: list[tuple[str, list[FloatArray]]], crank_angle: float) -> Value | None:
    """Largest number of a quantity over all discs and kinds of contacts; None where there is none."""
    best: Value | None = None
    for name, discs in kinds:
        for disc, each in enumerate(discs):
            known = np.asarray(each, dtype=float).ravel()
            if not np.any(np.isfinite(known)):
                continue
            number = int(np.nanargmax(known))
            if best is None or known[number] > (best.value or 0.0):
                part = f"{name} {number}" + (f" of disc {disc}" if len(discs) > 1 else "")
                best = Value(quantity=quantity, value=float(known[number]), part=part, crank_angle=crank_angle)
    return best
