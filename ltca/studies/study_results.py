"""Reading the final dataset of a study: scalars of each quantity, worst samples, sensitivity, in flat memory."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ltca.arrays import FloatArray
from ltca.studies.designs import FEWEST_BLOCKS, ToleranceDesign
from ltca.studies.execution.storage import CHUNK, opened_results
from ltca.studies.sensitivity import Regression, SobolIndices, grouped, regress, sobol_indices
from ltca.studies.study import Study

PERCENTILES = (0.1, 1.0, 5.0, 50.0, 95.0, 99.0, 99.9)


@dataclass(frozen=True, slots=True, kw_only=True)
class QuantitySummary:
    """One quantity over the sound samples.

    Attributes
    ----------
    mean, standard_deviation : float
        In the unit of the quantity.
    percentiles : tuple of float
        At `PERCENTILES`.
    smallest, largest : float
        Extremes.
    smallest_sample, largest_sample : int
        Where they are.
    """

    mean: float
    standard_deviation: float
    percentiles: tuple[float, ...]
    smallest: float
    largest: float
    smallest_sample: int
    largest_sample: int


def read_quantity(path: Path, name: str) -> FloatArray:
    """Return one quantity of all samples, not a number where they failed."""
    with opened_results(path) as file:
        return np.asarray(file.variables[name][...])


def summarise_quantity(values: FloatArray) -> QuantitySummary | None:
    """Return the scalars of one quantity, None when every sample failed."""
    sound = np.isfinite(values)
    if not sound.any():
        return None
    kept = values[sound]
    return QuantitySummary(
        mean=float(kept.mean()),
        standard_deviation=float(kept.std(ddof=1)) if kept.size > 1 else 0.0,
        percentiles=tuple(float(value) for value in np.percentile(kept, PERCENTILES)),
        smallest=float(kept.min()),
        largest=float(kept.max()),
        smallest_sample=int(np.nanargmin(values)),
        largest_sample=int(np.nanargmax(values)),
    )


def _chunks(path: Path, quantities: Sequence[str]) -> Iterator[tuple[FloatArray, FloatArray]]:
    with opened_results(path) as file:
        samples = file.dimensions["sample"].size
        for first in range(0, samples, CHUNK):
            rows = slice(first, min(first + CHUNK, samples))
            sound = np.asarray(file.variables["failed"][rows]) == 0
            factors = np.asarray(file.variables["factor_value"][rows])
            values = np.stack([np.asarray(file.variables[name][rows]) for name in quantities], axis=1)
            yield factors[sound], values[sound]


def regression_of(path: Path, study: Study) -> Regression | None:
    """Return the regression of all quantities on all factors; None when samples are too few."""
    return regress(lambda: _chunks(path, study.quantities))


def sobol_of(path: Path, study: Study) -> SobolIndices | None:
    """Return the Sobol indices of a study of Saltelli blocks; None for other designs or fewer than `FEWEST_BLOCKS`."""
    design = study.design
    if not isinstance(design, ToleranceDesign) or design.sequence != "saltelli":
        return None
    size = len(design.groups) + 2
    blocks = design.samples // size
    values = np.stack([read_quantity(path, name) for name in study.quantities], axis=1)
    cut = values[: blocks * size].reshape(blocks, size, len(study.quantities))
    cut = cut[np.isfinite(cut).all(axis=(1, 2))]
    return sobol_indices(cut) if len(cut) >= FEWEST_BLOCKS else None


def factor_groups(study: Study) -> tuple[tuple[str, slice], ...]:
    """Return the fields of a study with their columns."""
    if isinstance(study.design, ToleranceDesign):
        return study.design.groups
    return tuple((name, slice(column, column + 1)) for column, name in enumerate(study.design.names))


def rank(path: Path, study: Study) -> dict[str, Any]:
    """Return the sensitivity ranking of every quantity.

    Parameters
    ----------
    path : Path
        ``results.nc``.
    study : Study
        Its study.

    Returns
    -------
    dict
        ``method`` and, for each quantity, ``explained`` and the ``shares`` of the fields, largest first.
    """
    names = [name for name, _ in factor_groups(study)]
    sobol = sobol_of(path, study)
    if sobol is not None:
        tables = {
            quantity: {
                "explained": float(sobol.first[:, column].sum()),
                "shares": _sorted(names, sobol.total[:, column]),
                "first_order": dict(zip(names, map(float, sobol.first[:, column]), strict=True)),
            }
            for column, quantity in enumerate(study.quantities)
        }
        return {"method": f"Sobol total indices, {sobol.blocks} blocks", "quantities": tables}
    regression = regression_of(path, study)
    if regression is None:
        return {"method": "none: fewer than two samples for each factor and the mean", "quantities": {}}
    shares = grouped(regression.shares, factor_groups(study))
    return {
        "method": "standardised regression, SRC² added up over the elements of a field",
        "quantities": {
            quantity: {
                "explained": float(regression.explained[column]),
                "shares": _sorted(names, shares[:, column]),
            }
            for column, quantity in enumerate(study.quantities)
        },
    }


def _sorted(names: Sequence[str], shares: FloatArray) -> dict[str, float]:
    order = np.argsort(-shares, kind="stable")
    return {names[number]: float(shares[number]) for number in order}
