"""Time of one position: full finite elements as measured when solved, the LTCA measured here."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from ltca.analysis.loaded_analysis import analyse
from ltca.geometry.placement import position_angles
from validation.compare.model_positions import MODELS, engine_of
from validation.study import Study

POSITIONS, REPEATS = 36, 3


@dataclass(frozen=True, slots=True, kw_only=True)
class Costs:
    """Wall time of one position, s.

    Attributes
    ----------
    full : float
        Full finite elements, mean of the positions of the study.
    models : dict of str to float
        LTCA by compliance model, mean of one turn, light torque included, after derivation.
    """

    full: float
    models: dict[str, float]


def measure_costs(study: Study) -> Costs:
    """Time one turn of the first case with each model."""
    case, drive = next(iter(study.plan.drives.items()))
    coefficients = study.coefficients[case]
    angles = position_angles(POSITIONS)
    models: dict[str, float] = {}
    for model in MODELS:
        seconds = []
        for _ in range(REPEATS):  # the least disturbed by other processes
            start = time.perf_counter()
            analyse(drive, angles, engine=engine_of(model, coefficients))
            seconds.append(time.perf_counter() - start)
        models[model] = min(seconds) / POSITIONS
    full = [item.full.seconds for items in study.compared.values() for item in items]
    return Costs(full=float(np.mean(full)), models=models)
