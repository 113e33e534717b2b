r"""Which tolerances matter: standardised regression over random samples, Sobol indices over Saltelli blocks.

Regression of a quantity y on the drawn numbers x gives :math:`\mathrm{SRC}_j = b_j \sigma_j/\sigma_y`; for independent
factors SRC² is the part of the variance of y that x_j explains linearly (Saltelli et al., *Global Sensitivity
Analysis*, 2008), and what all of them leave, 1 − R², is curved or mutual. Sobol indices see that too: S is the part of
the variance that vanishes with a factor known, S_T the part left with all others known.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ltca.arrays import FloatArray
from ltca.studies.designs import FEWEST_BLOCKS, ToleranceDesign
from ltca.studies.study import Study
from ltca.studies.study_results import read_chunks, read_quantity

CHANCE_MEAN, CHANCE_SPREAD = 0.484, 1.170
"""Mean and deviation of max(z² − 1, 0) of a normal z: what an element without influence adds to its share of a regression,
by the variance of its coefficient."""

Chunks = Callable[[], Iterator[tuple[FloatArray, FloatArray]]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Regression:
    """Linear shares of the variance.

    Attributes
    ----------
    coefficients : array, shape (factors, quantities)
        Standardised regression coefficients.
    shares : array, shape (factors, quantities)
        SRC² less what chance alone gives on so many samples, not below zero.
    explained : array, shape (quantities,)
        R², adjusted for the number of factors.
    samples : int
        Samples behind them.
    """

    coefficients: FloatArray
    shares: FloatArray
    explained: FloatArray
    samples: int


def regress(chunks: Chunks) -> Regression | None:
    """Regress every quantity on all factors at once, reading the samples in chunks.

    `chunks` gives the samples anew at every call: factors (n, f) and quantities (n, q), failed samples left out. None with fewer
    than two samples for each factor: chance would decide.
    """
    count, sum_x, sum_y = 0, np.zeros(1), np.zeros(1)
    for x, y in chunks():
        count += len(x)
        sum_x, sum_y = sum_x + x.sum(axis=0), sum_y + y.sum(axis=0)
    if count == 0 or count < 2 * (sum_x.size + 1):
        return None
    mean_x, mean_y = sum_x / count, sum_y / count
    xx, xy, yy = np.zeros((mean_x.size, mean_x.size)), np.zeros((mean_x.size, mean_y.size)), np.zeros(mean_y.size)
    for x, y in chunks():
        dx, dy = x - mean_x, y - mean_y
        xx += dx.T @ dx
        xy += dx.T @ dy
        yy += (dy**2).sum(axis=0)
    spread_x, spread_y = np.sqrt(np.diag(xx)), np.sqrt(yy)
    spread_x = np.where(spread_x > 0.0, spread_x, np.inf)  # a factor that does not vary explains nothing
    spread_y = np.where(spread_y > 0.0, spread_y, np.inf)
    correlation = xx / (spread_x[:, None] * spread_x)
    np.fill_diagonal(correlation, 1.0)
    coefficients = np.linalg.solve(correlation, xy / (spread_x[:, None] * spread_y))
    explained = np.einsum("fq,fq->q", coefficients, xy / (spread_x[:, None] * spread_y))
    freedom = count - mean_x.size - 1
    chance = (1.0 - explained) / freedom
    return Regression(
        coefficients=coefficients,
        shares=np.maximum(coefficients**2 - chance, 0.0),
        explained=1.0 - (1.0 - explained) * (count - 1) / freedom,
        samples=count,
    )


def grouped(shares: FloatArray, groups: Sequence[tuple[str, slice]]) -> FloatArray:
    """Return the shares of fields: the elements of an array added up, shape (groups, quantities)."""
    return np.stack([shares[columns].sum(axis=0) for _, columns in groups])


@dataclass(frozen=True, slots=True, kw_only=True)
class SobolIndices:
    """Variance-based shares.

    Attributes
    ----------
    first, total : array, shape (groups, quantities)
        S and S_T.
    blocks : int
        Complete blocks behind them.
    """

    first: FloatArray
    total: FloatArray
    blocks: int


def sobol_indices(blocks: FloatArray) -> SobolIndices:
    """Return the indices from Saltelli blocks of shape (blocks, groups + 2, quantities).

    Of each block: f(A), f(B), and f(A with one group from B); blocks with a failed sample are left out.

    Notes
    -----
    S: Saltelli et al. 2010 (Comput. Phys. Commun. 181), Table 2 (b); S_T: Jansen 1999, there (f).
    """
    a, b, mixed = blocks[:, 0], blocks[:, 1], blocks[:, 2:]
    variance = np.var(np.concatenate([a, b]), axis=0)
    variance = np.where(variance > 0.0, variance, np.inf)
    # Centred first: the estimator of S multiplies values and would drown in their mean.
    mean = np.concatenate([a, b]).mean(axis=0)
    first = ((b - mean)[:, None] * (mixed - a[:, None])).mean(axis=0) / variance
    total = 0.5 * ((a[:, None] - mixed) ** 2).mean(axis=0) / variance
    return SobolIndices(first=first, total=total, blocks=len(blocks))


def regression_of(path: Path, study: Study) -> Regression | None:
    """Return the regression of all quantities on all factors; None when samples are too few."""
    return regress(lambda: read_chunks(path, study.quantities))


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


def chance_of(study: Study, explained: float, samples: int) -> dict[str, float]:
    """Return the share up to which a field of a regression may have no influence at all, by its path.

    A coefficient without influence has the variance (1 − R²)/freedom; a field adds up as many as it has elements. The share is
    mean and two deviations of what chance alone gives, from R² adjusted for its freedom and the number of answered samples.
    """
    one = (1.0 - min(explained, 1.0)) / max(samples - 1, 1)
    sizes = {name: len(range(*columns.indices(columns.stop))) for name, columns in factor_groups(study)}
    return {name: one * (CHANCE_MEAN * size + 2.0 * CHANCE_SPREAD * np.sqrt(size)) for name, size in sizes.items()}


def is_chance(entry: Mapping[str, Any], path: str) -> bool:
    """Tell whether a field's share in an entry of `rank` is no larger than chance alone may give, where that is known."""
    return "chance" in entry and entry["shares"][path] <= entry["chance"][path]


def rank(path: Path, study: Study) -> dict[str, Any]:
    """Return the sensitivity ranking of a study from its ``results.nc``.

    That is the ``method`` and, for each quantity, ``explained`` and the ``shares`` of the fields, largest first; of a regression
    also ``chance``, the share up to which a field may have no influence at all.
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
                "chance": chance_of(study, float(regression.explained[column]), regression.samples),
            }
            for column, quantity in enumerate(study.quantities)
        },
    }


def _sorted(names: Sequence[str], shares: FloatArray) -> dict[str, float]:
    order = np.argsort(-shares, kind="stable")
    return {names[number]: float(shares[number]) for number in order}
