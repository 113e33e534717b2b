"""What a full solution reaches, judged by the same limits as the LTCA."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from fem.drive.disc_stress import DiscStress
from fem.reducer.solution import ReducerSolution
from ltca.arrays import FloatArray
from ltca.drive.members.judgement import Check, Value, judge
from ltca.drive.members.limits import Limit


def judge_solution(
    solution: ReducerSolution, stresses: Sequence[DiscStress], limits: Mapping[str, Limit]
) -> list[Check]:
    """Return the checks of one position by full finite elements; limits on what one position cannot say are left out."""
    contacts = [disc.contacts for disc in solution.discs]
    found: dict[str, list[tuple[str, list[FloatArray]]]] = {
        name: [(part, [getattr(each, name) for each in contacts])]
        for name, part in (
            ("pin_load", "wheel pin"), ("roller_load", "roller"), ("pin_shaft_load", "shaft pin"),
            ("pin_pressure_mid", "wheel pin"), ("roller_pressure_mid_outer", "roller"),
            ("roller_pressure_mid_inner", "roller"), ("pin_shaft_pressure_mid", "shaft pin"),
        )
    }  # fmt: skip
    found["disc_shear"] = [
        (f"below {part}", [getattr(stress, name) for stress in stresses])
        for name, part in (
            ("pin_shear_max", "wheel pin"), ("roller_shear_max_outer", "roller"), ("pin_shaft_shear_max", "shaft pin")
        )
    ]  # fmt: skip
    for wall in ("root", "bore", "hole"):
        part = "lobe" if wall == "root" else wall
        found[f"{wall}_stress"] = [(part, [np.atleast_1d(getattr(stress, f"{wall}_stress")) for stress in stresses])]
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
