r"""Yield of a tolerance study: the part of the samples that keeps each limit, and of all limits together.

Of n independent samples k keep a limit; the part of all drives that would keep it lies with `CONFIDENCE` within the interval of
Clopper and Pearson (Biometrika 26, 1934), whose ends are quantiles of beta distributions, :math:`B(\alpha/2; k, n-k+1)` and
:math:`B(1-\alpha/2; k+1, n-k)`: exact, so it holds for small n and for k = n as well. A sample without an answer keeps nothing.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import FloatArray
from ltca.drive.members.judgement import Value, judge
from ltca.drive.members.limits import Limit, Limits
from ltca.drive.parts import Drive
from ltca.quantities import LIMITED, SCALARS, unit_sign
from ltca.studies.designs import Design, ToleranceDesign
from ltca.studies.quantities import OF_RACES, STAGES, missing_quantities

ANGLES = ("°", "′", "″")
"""Signs that stand right behind their number."""
CONFIDENCE = 0.95
METHOD = "Clopper–Pearson"
RANGES = {
    ("max", "backlash_output"): "max_backlash_output",
    ("min", "backlash_output"): "min_backlash_output",
    ("min", "backlash_wheel"): "min_backlash_wheel",
}
"""Quantities of studies by sense and name of the limit, of those that are limited at the end of a range over the turn."""
OF_PLAY = tuple(name for name, stage in STAGES.items() if stage == "play")
"""Quantities of the backlash at the output."""
ALONE = tuple(dict.fromkeys(name for _, name in RANGES))
BY_NAME = {
    SCALARS[name].limited_name: name
    for name in STAGES
    if SCALARS[name].limit is not None and SCALARS[name].limited_name not in ALONE
}
"""Quantities of studies by the name that a limit has for them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Judged:
    """A limit by which samples are judged.

    Attributes
    ----------
    quantity : str
        Of the study.
    limit : Limit
        With its source.
    """

    quantity: str
    limit: Limit

    @property
    def title(self) -> str:
        """What is limited, in words."""
        return SCALARS[self.quantity].title

    @property
    def bound(self) -> str:
        """Sign, value and unit."""
        unit = unit_sign(SCALARS[self.quantity].unit)
        space = "" if unit in ANGLES else " "
        return (
            f"{'≤' if self.limit.sense == 'max' else '≥'} {self.limit.value:.6g}{'' if unit == '1' else space + unit}"
        )

    def keeps(self, values: FloatArray) -> NDArray[np.bool_]:
        """Return which values keep the limit; what is no number does not."""
        with np.errstate(invalid="ignore"):
            kept = values <= self.limit.value if self.limit.sense == "max" else values >= self.limit.value
        return np.asarray(kept)


@dataclass(frozen=True, slots=True, kw_only=True)
class Kept:
    """How many of some independent samples keep a limit, or all of them, with the interval of the part in all drives."""

    kept: int
    samples: int
    low: float
    high: float

    @property
    def part(self) -> float:
        """Part of the samples."""
        return self.kept / self.samples


@dataclass(frozen=True, slots=True, kw_only=True)
class Yield:
    """Yield of a study.

    Attributes
    ----------
    each : tuple of (Judged, Kept)
        By limit.
    together : Kept
        All limits at once.
    not_judged : dict of str to str
        Limits of the drive file that samples are not judged by, with the reason.
    """

    each: tuple[tuple[Judged, Kept], ...]
    together: Kept
    not_judged: dict[str, str]

    def content(self) -> dict[str, Any]:
        """Return the entry of ``summary.json``."""

        def told(kept: Kept) -> dict[str, Any]:
            return {"kept": kept.kept, "part": kept.part, "low": kept.low, "high": kept.high}

        return {
            "method": METHOD,
            "confidence": CONFIDENCE,
            "samples": self.together.samples,
            "limits": [
                {
                    "quantity": one.quantity,
                    "limit": one.limit.key,
                    "value": one.limit.value,
                    "unit": SCALARS[one.quantity].unit,
                    "source": one.limit.source,
                    **told(kept),
                }
                for one, kept in self.each
            ],
            "all": told(self.together),
            "not_judged": self.not_judged,
        }


def limits_of(drive: Drive, limits: Limits) -> tuple[tuple[Judged, ...], dict[str, str]]:
    """Return the limits that samples of a drive are judged by, and those that are not with the reason.

    They are the ``[limits]`` of the drive file as far as studies have their quantities, and the allowable pressures of materials.
    """
    missing = missing_quantities(drive)
    # Limits of bodies depend on values only where one body of two has none: no value asks for all of them.
    values = [Value(quantity=name, value=None) for name, quantity in BY_NAME.items() if quantity not in missing]
    found, left = [], {}
    for check in judge(drive, values, limits):
        limit, quantity = check.limit, check.value.quantity
        if limit is None or limit.quantity == "roller_pressure_mid" == quantity:
            continue  # of both races, each of which is judged
        named = RANGES.get((limit.sense, quantity)) or BY_NAME.get(quantity)
        if named is None:
            left[limit.key] = f"studies do not keep the {LIMITED[quantity].verdict_title}"
        elif named in missing:
            left[limit.key] = f"the drive has no {missing[named]}"
        else:
            found.append(Judged(quantity=named, limit=limit))
    # A joint is judged once: of a race of plastic between rollers of steel the harder limit counts.
    hardest: dict[tuple[str, str], Judged] = {}
    for one in sorted(found, key=lambda one: one.limit.value * (1.0 if one.limit.sense == "max" else -1.0)):
        hardest.setdefault((one.quantity, one.limit.sense), one)
    found = list(hardest.values())
    outer, inner = ([one for one in found if one.quantity == name] for name in OF_RACES)
    if [one.limit.value for one in outer] == [one.limit.value for one in inner]:
        found = [one for one in found if one.quantity not in OF_RACES]
        found += [Judged(quantity="max_roller_pressure_mid", limit=one.limit) for one in outer]
    order = list(STAGES)
    return tuple(sorted(found, key=lambda one: order.index(one.quantity))), left


def interval(kept: int, samples: int, confidence: float = CONFIDENCE) -> Kept:
    """Return the interval of Clopper and Pearson.

    Examples
    --------
    >>> found = interval(20, 20)
    >>> round(found.low, 4), found.high
    (0.8316, 1.0)
    """
    from scipy.special import betaincinv

    tail = 0.5 * (1.0 - confidence)
    low = float(betaincinv(kept, samples - kept + 1, tail)) if kept else 0.0
    high = float(betaincinv(kept + 1, samples - kept, 1.0 - tail)) if kept < samples else 1.0
    return Kept(kept=kept, samples=samples, low=low, high=high)


def independent_samples(design: Design) -> NDArray[np.bool_]:
    """Return which samples of a design are independent draws: of Saltelli blocks the first two of each."""
    chosen = np.ones(design.samples, dtype=bool)
    if isinstance(design, ToleranceDesign) and design.sequence == "saltelli":
        chosen = np.arange(design.samples) % (len(design.groups) + 2) < 2
    return chosen


def left_out(judged: tuple[Judged, ...], quantities: Collection[str], not_judged: Mapping[str, str]) -> dict[str, str]:
    """Return limits that samples with some quantities are not judged by, with the reason."""
    unasked = {one.limit.key: f"{one.quantity} was not asked for" for one in judged if one.quantity not in quantities}
    return dict(not_judged) | unasked


def find_yield(
    judged: tuple[Judged, ...],
    values: Mapping[str, FloatArray],
    design: Design,
    not_judged: Mapping[str, str],
    without_play: NDArray[np.bool_] | None = None,
) -> Yield | None:
    """Return the yield of samples by their `values`, shape (samples,), by quantity; None without a limit on any of these.

    Samples `without_play`, shape (samples,), keep no limit of the backlash at the output.
    """
    known = [one for one in judged if one.quantity in values]
    if not known:
        return None
    chosen = independent_samples(design)
    keeps = [one.keeps(values[one.quantity]) for one in known]
    if without_play is not None:
        keeps = [
            kept & ~without_play if one.quantity in OF_PLAY else kept for one, kept in zip(known, keeps, strict=True)
        ]
    keeps = [kept[chosen] for kept in keeps]
    count = int(chosen.sum())
    return Yield(
        each=tuple((one, interval(int(kept.sum()), count)) for one, kept in zip(known, keeps, strict=True)),
        together=interval(int(np.all(keeps, axis=0).sum()), count),
        not_judged=left_out(judged, values, not_judged),
    )
