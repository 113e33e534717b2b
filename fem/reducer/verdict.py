"""Largest loads, pressures and stresses of a full solution, judged by the same limits as the LTCA."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial

import numpy as np

from fem.drive.contact_kinds import CONTACT_KINDS, ContactKind, PairKind
from fem.drive.disc_stress import DiscStress
from fem.reducer.solution import ReducerSolution
from ltca.arrays import FloatArray
from ltca.drive.members.judgement import Check, Value, judge
from ltca.drive.members.limits import Limit
from ltca.drive.members.verdict_words import part_words
from ltca.drive.parts import Drive
from ltca.quantities import LIMITED

WALLS = {"root": "lobe", "bore": "bore", "hole": "hole"}
"""Parts of the disc along whose walls stresses are judged."""


Candidate = tuple[FloatArray, Callable[[int], str], float]
"""Values, the name of each by its number, and the crank angle, rad."""


def judge_solution(
    solution: ReducerSolution, stresses: Sequence[DiscStress], limits: Mapping[str, Limit]
) -> list[Check]:
    """Return the checks of one position by full finite elements; limits on quantities of a whole turn are left out."""
    parts = {quantity: [(kind.part, quantity)] for quantity, _, kind in judged_contacts()}
    parts["disc_shear"] = [
        ("below wheel pin", "pin_shear_max"),
        ("below roller", "roller_shear_max_outer"),
        ("below shaft pin", "pin_shaft_shear_max"),
    ]
    parts |= {f"{wall}_stress": [(part, f"{wall}_stress")] for wall, part in WALLS.items()}

    def candidates(quantity: str) -> Iterator[Candidate]:
        for part, name in parts[quantity]:
            for disc, (of_disc, stress) in enumerate(zip(solution.discs, stresses, strict=True)):
                source = of_disc.contacts if hasattr(of_disc.contacts, name) else stress
                values = np.asarray(getattr(source, name), dtype=float).ravel()
                yield values, partial(_words, solution.drive, part, values.size, disc), solution.crank_angle

    return judge_largest(solution.drive, {quantity: candidates(quantity) for quantity in parts}, limits)


def _words(drive: Drive, part: str, pairs: int, disc: int, pair: int) -> str:
    return part_words(drive, part, pair, pairs, disc)


def judged_contacts() -> list[tuple[str, PairKind, ContactKind]]:
    """Return the loads and pressures of contacts that ``[limits]`` may bound, with their kinds."""
    arrays = ("load", "pressure")
    found = [(getattr(names, array), kind, names) for array in arrays for kind, names in CONTACT_KINDS.items()]
    return [entry for entry in found if entry[0] in LIMITED]


def judge_largest(
    drive: Drive, candidates: Mapping[str, Iterable[Candidate]], limits: Mapping[str, Limit]
) -> list[Check]:
    """Return the checks of the largest candidate of each quantity, with the limits on these quantities."""
    values = [value for quantity, found in candidates.items() if (value := _largest(quantity, found)) is not None]
    told = {value.quantity for value in values} | {"roller_pressure_mid"}
    return judge(drive, values, {key: limit for key, limit in limits.items() if limit.quantity in told})


def _largest(quantity: str, candidates: Iterable[Candidate]) -> Value | None:
    """Return the largest number among candidates, the first of equal ones; None where there is none."""
    best: Value | None = None
    for values, name_of, crank_angle in candidates:
        if not np.any(np.isfinite(values)):
            continue
        number = int(np.nanargmax(values))
        if best is None or values[number] > (best.value or 0.0):
            best = Value(quantity=quantity, value=float(values[number]), part=name_of(number), crank_angle=crank_angle)
    return best
