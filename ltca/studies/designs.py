"""Designs of experiments: each gives the numbers of any range of samples without the ones before.

So a batch depends on its place in the study alone, not on who computes it or when.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import islice, product
from math import prod
from typing import Any, Protocol

import numpy as np

from ltca.arrays import FloatArray
from ltca.drive.tolerances import Factors


class Design(Protocol):
    """Numbers of samples."""

    @property
    def samples(self) -> int:
        """How many samples there are."""
        ...

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns of `rows`."""
        ...

    def rows(self, first: int, last: int) -> FloatArray:
        """Return the numbers of samples first … last − 1, shape (samples, columns)."""
        ...

    def fields(self, row: FloatArray) -> dict[str, Any]:
        """Return what one row replaces in the drive, by dotted path."""
        ...


def random_rows(seed: int, first: int, last: int, columns: int) -> FloatArray:
    """Return uniform numbers in (0, 1) of samples, from a counter-based generator with a stretch for each sample."""
    rows = np.empty((last - first, columns))
    for row, sample in zip(rows, range(first, last), strict=True):
        generator = np.random.Generator(np.random.Philox(key=seed, counter=[0, 0, 0, sample]))
        generator.random(out=row)
    # 0 is a quantile of no normal distribution; half the spacing of the numbers keeps it away.
    return rows + 2.0**-54


def sobol_rows(seed: int, first: int, last: int, columns: int) -> FloatArray:
    """Return points of a scrambled Sobol sequence in (0, 1)."""
    from scipy.stats import qmc

    sequence = qmc.Sobol(columns, scramble=True, rng=np.random.default_rng(seed))
    if first:
        sequence.fast_forward(first)
    # Powers of two balance the sequence; a part of it is meant to be short.
    import warnings

    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="The balance properties")
        points = sequence.random(last - first)
    return np.asarray(np.clip(points, 2.0**-54, 1.0 - 2.0**-53))


FEWEST_BLOCKS = 8
"""Saltelli blocks that Sobol indices need."""


@dataclass(frozen=True, kw_only=True)
class ToleranceDesign:
    """Samples drawn from tolerances.

    Attributes
    ----------
    factors : Factors
        What scatters.
    samples : int
        How many.
    seed : int
        Of the random numbers.
    sequence : {"random", "sobol", "saltelli"}
        Independent numbers, a Sobol sequence, or blocks for Sobol indices: of each block of G + 2 samples the first
        two are independent, the others are the first with one of the G scattering fields from the second.
    """

    factors: Factors
    samples: int
    seed: int
    sequence: str = "random"

    @property
    def names(self) -> tuple[str, ...]:
        """Dotted paths of the numbers."""
        return self.factors.paths

    @property
    def groups(self) -> tuple[tuple[str, slice], ...]:
        """Each scattering field with its columns."""
        found, column = [], 0
        for path, count in self.factors.fields:
            found.append((path, slice(column, column + (count or 1))))
            column += count or 1
        return tuple(found)

    def rows(self, first: int, last: int) -> FloatArray:
        """Return the numbers of some samples."""
        columns = len(self.names)
        if self.sequence != "saltelli":
            draw = sobol_rows if self.sequence == "sobol" else random_rows
            return self.factors.draw(draw(self.seed, first, last, columns))
        groups = self.groups
        size = len(groups) + 2
        blocks = random_rows(self.seed, first // size, (last - 1) // size + 1, 2 * columns)
        rows = np.empty((last - first, columns))
        for row, sample in zip(rows, range(first, last), strict=True):
            block = blocks[sample // size - first // size]
            kind = sample % size
            row[:] = block[columns:] if kind == 1 else block[:columns]
            if kind > 1:
                part = groups[kind - 2][1]
                row[part] = block[columns:][part]
        return self.factors.draw(rows)

    def fields(self, row: FloatArray) -> dict[str, Any]:
        """Return the fields of one row, arrays whole."""
        return dict(self.factors.values(row))


@dataclass(frozen=True, kw_only=True)
class SweepFactor:
    """One field of a sweep.

    Attributes
    ----------
    path : str
        Dotted path, or ``case``.
    levels : tuple
        Its values, numbers or texts; empty with a range.
    low, high : float
        Ends of the range.
    logarithmic : bool
        Whether the range is filled evenly in the logarithm.
    """

    path: str
    levels: tuple[Any, ...] = ()
    low: float = 0.0
    high: float = 0.0
    logarithmic: bool = False

    @property
    def is_text(self) -> bool:
        """Whether the column holds the number of the level in place of the value."""
        return any(isinstance(level, str | bool) for level in self.levels)

    def column(self) -> FloatArray:
        """Return the numbers of the levels."""
        return np.arange(float(len(self.levels))) if self.is_text else np.array(self.levels, dtype=float)

    def at(self, share: FloatArray) -> FloatArray:
        """Return the numbers at places 0 … 1 of the range or of the levels."""
        if self.levels:
            place = np.minimum((share * len(self.levels)).astype(int), len(self.levels) - 1)
            return np.asarray(self.column()[place])
        if self.logarithmic:
            return np.asarray(self.low * (self.high / self.low) ** share)
        return np.asarray(self.low + (self.high - self.low) * share)

    def value(self, number: float) -> Any:
        """Return what a number of the column means for the field."""
        if self.is_text:
            return self.levels[int(number)]
        whole = all(isinstance(level, int) for level in self.levels) and self.levels
        return int(number) if whole else float(number)


@dataclass(frozen=True, kw_only=True)
class SweepDesign:
    """Samples of a sweep over chosen fields.

    Attributes
    ----------
    factors : tuple of SweepFactor
        The fields.
    kind : {"grid", "list", "latin-hypercube", "sobol"}
        All combinations of levels (the last factor runs fastest), levels side by side, or points in the ranges.
    number : int
        Samples of Latin hypercube and Sobol sequence.
    seed : int
        Theirs.
    """

    factors: tuple[SweepFactor, ...]
    kind: str
    number: int = 0
    seed: int = 0

    @property
    def samples(self) -> int:
        """How many samples there are."""
        if self.kind == "grid":
            return prod(len(factor.levels) for factor in self.factors)
        return len(self.factors[0].levels) if self.kind == "list" else self.number

    @property
    def names(self) -> tuple[str, ...]:
        """Dotted paths."""
        return tuple(factor.path for factor in self.factors)

    @cached_property
    def _hypercube(self) -> FloatArray:
        from scipy.stats import qmc

        sampler = qmc.LatinHypercube(len(self.factors), rng=np.random.default_rng(self.seed))
        return np.asarray(sampler.random(self.number))

    def rows(self, first: int, last: int) -> FloatArray:
        """Return the numbers of some samples."""
        if self.kind == "grid":
            rows = islice(product(*(factor.column() for factor in self.factors)), first, last)
            return np.array(list(rows))
        if self.kind == "list":
            return np.stack([factor.column()[first:last] for factor in self.factors], axis=1)
        shares = (
            sobol_rows(self.seed, first, last, len(self.factors))
            if self.kind == "sobol"
            else self._hypercube[first:last]
        )
        return np.stack([factor.at(share) for factor, share in zip(self.factors, shares.T, strict=True)], axis=1)

    def fields(self, row: FloatArray) -> dict[str, Any]:
        """Return the fields of one row."""
        return {factor.path: factor.value(number) for factor, number in zip(self.factors, row, strict=True)}
