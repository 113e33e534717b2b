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

CHANCE_LEVEL = 0.05
"""Part of studies without any influence in which one of all fields has a share beyond its chance."""
CHANCE_WORDS = "no more than the largest share that chance alone gives in 19 of 20 studies"

Chunks = Callable[[], Iterator[tuple[FloatArray, FloatArray]]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Regression:
    """Linear shares of the variance.

    Attributes
    ----------
    coefficients : array, shape (factors, quantities)
        Standardised regression coefficients.
    shares : array, shape (factors, quantities)
        SRC² less what chance alone gives on so many samples: in the mean 0 of a factor without influence, so negative of some.
    inflation : array, shape (factors,)
        Factor by which correlations among the drawn numbers raise the variance of a coefficient.
    explained : array, shape (quantities,)
        R², adjusted for the number of factors.
    samples : int
        Samples behind them.
    """

    coefficients: FloatArray
    shares: FloatArray
    inflation: FloatArray
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
    inverse = np.linalg.inv(correlation)
    coefficients = inverse @ (xy / (spread_x[:, None] * spread_y))
    inflation = np.diag(inverse).copy()
    explained = np.einsum("fq,fq->q", coefficients, xy / (spread_x[:, None] * spread_y))
    freedom = count - mean_x.size - 1
    chance = (1.0 - explained) / freedom
    return Regression(
        coefficients=coefficients,
        inflation=inflation,
        shares=coefficients**2 - inflation[:, None] * chance,
        explained=1.0 - (1.0 - explained) * (count - 1) / freedom,
        samples=count,
    )


def grouped(shares: FloatArray, groups: Sequence[tuple[str, slice]]) -> FloatArray:
    """Return the shares of fields: the elements of an array added up, not below zero, shape (groups, quantities)."""
    # Cut after the sum: elements cut one by one would let a field of many elements grow with their noise.
    return np.stack([np.maximum(shares[columns].sum(axis=0), 0.0) for _, columns in groups])


@dataclass(frozen=True, slots=True, kw_only=True)
class SobolIndices:
    """Variance-based shares.

    Attributes
    ----------
    first, total : array, shape (groups, quantities)
        S and S_T.
    together_error : array, shape (quantities,)
        Standard error of the sum of S over all groups.
    blocks : int
        Complete blocks behind them.
    """

    first: FloatArray
    total: FloatArray
    together_error: FloatArray
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
    products = (b - mean)[:, None] * (mixed - a[:, None]) / variance
    total = 0.5 * ((a[:, None] - mixed) ** 2).mean(axis=0) / variance
    count = len(blocks)
    error = products.sum(axis=1).std(axis=0, ddof=1) / np.sqrt(count) if count > 1 else np.full(a.shape[1], np.inf)
    return SobolIndices(first=products.mean(axis=0), total=total, together_error=error, blocks=count)


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


def chance_of(study: Study, explained: float, samples: int, inflation: FloatArray) -> dict[str, float]:
    """Return the share up to which a field of a regression may have no influence at all, by its path.

    Parameters
    ----------
    study : Study
        For its fields and their elements.
    explained : float
        R² adjusted for its freedom.
    samples : int
        Answered samples.
    inflation : array, shape (factors,)
        `Regression.inflation`.

    Notes
    -----
    A coefficient without influence has the variance (1 − R²)/freedom = (1 − adjusted R²)/(samples − 1) times its inflation.
    The squares of the k coefficients of a field, by their variances and by k, follow the F distribution of k and the remaining
    degrees of freedom. Its quantile is that of the largest of all fields (Bonferroni): a ranking shows the largest of many.
    """
    from scipy.special import fdtri

    groups = factor_groups(study)
    one = (1.0 - min(explained, 1.0)) / max(samples - 1, 1)
    freedom = max(samples - inflation.size - 1, 1)
    level = 1.0 - CHANCE_LEVEL / len(groups)
    return {
        name: float(one * inflation[columns].sum() * (fdtri(inflation[columns].size, freedom, level) - 1.0))
        for name, columns in groups
    }


def is_chance(entry: Mapping[str, Any], path: str) -> bool:
    """Tell whether a field's share in an entry of `rank` is no larger than chance alone may give, where that is known."""
    return "chance" in entry and entry["shares"][path] <= entry["chance"][path]


def rank(path: Path, study: Study) -> dict[str, Any]:
    """Return the sensitivity ranking of a study from its ``results.nc``.

    That is the ``method`` and, for each quantity, ``explained`` and the ``shares`` of the fields, largest first. Of a regression
    ``explained`` is the part of the variance that all fields explain linearly, and ``chance`` the share up to which a field may
    have no influence at all. Of Sobol indices it is the sum of the first orders, with its standard error ``explained_error``.
    """
    names = [name for name, _ in factor_groups(study)]
    sobol = sobol_of(path, study)
    if sobol is not None:
        tables = {
            quantity: {
                "explained": float(sobol.first[:, column].sum()),
                "explained_error": float(sobol.together_error[column]),
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
    found = {}
    for column, quantity in enumerate(study.quantities):
        adjusted = float(regression.explained[column])
        own, chance = (
            _sorted(names, shares[:, column]),
            chance_of(study, adjusted, regression.samples, regression.inflation),
        )
        # The noise of fields without influence lowers adjusted R² below the parts that it is made of, and below zero.
        beyond = sum(share for name, share in own.items() if share > chance[name])
        explained = max(adjusted, min(beyond, 1.0))
        found[quantity] = {"explained": explained, "shares": own, "chance": chance}
    return {"method": "standardised regression, SRC² added up over the elements of a field", "quantities": found}


def together_words(entry: Mapping[str, Any]) -> str:
    """Return which part of the variance all fields of an entry of `rank` explain together, each acting alone.

    Examples
    --------
    >>> together_words({"explained": 0.3, "shares": {}})
    'all fields together, linearly: 30 %'
    >>> together_words({"explained": 0.9, "explained_error": 0.1, "shares": {}})
    'all fields together, without interactions: 70 … 100 %'
    """
    if "explained_error" not in entry:
        return f"all fields together, linearly: {100.0 * entry['explained']:.0f} %"
    low, high = (entry["explained"] + side * 2.0 * entry["explained_error"] for side in (-1.0, 1.0))
    if high <= 0.0 or (low <= 0.0 and high >= 1.0):
        told = "not known from so few blocks"
    else:
        told = f"{100.0 * min(max(low, 0.0), 1.0):.0f} … {100.0 * min(high, 1.0):.0f} %"
    return f"all fields together, without interactions: {told}"


def _sorted(names: Sequence[str], shares: FloatArray) -> dict[str, float]:
    order = np.argsort(-shares, kind="stable")
    return {names[number]: float(shares[number]) for number in order}
