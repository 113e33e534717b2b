"""Samples of a tolerance study that bind: parts overlap in every pose, so that the output has no backlash.

Such a drive can only be put together by force. Its backlash, zero, is below every upper limit; a sample that binds keeps none,
unless the drive is preloaded as drawn, without any deviation.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import FloatArray
from ltca.drive.fields import field_kind
from ltca.drive.members.named_materials import FINEST_PRINT
from ltca.drive.members.temperatures import warm_drive
from ltca.drive.parts import Drive
from ltca.drive.single_discs import single_discs
from ltca.geometry.coordinates import RIGID
from ltca.geometry.interference import FLANK, HOLES, ROLLERS, drawn_plays
from ltca.geometry.pairs import ContactGeometry
from ltca.reading.changes import with_fields
from ltca.studies.bound_samples import NO_BACKLASH
from ltca.studies.designs import ToleranceDesign
from ltca.studies.study import Study
from ltca.studies.yields import Kept, independent_samples, interval

LEAST, LARGEST = "min_backlash_output", "max_backlash_output"


@dataclass(frozen=True, slots=True, kw_only=True)
class Binding:
    """Which samples of a study bind.

    Attributes
    ----------
    each : array of bool, shape (samples,)
        By sample; none where the study did not count them.
    counted : Kept or None
        Those among the independent samples; None where the study did not count them.
    preloaded : bool
        Whether parts of the drive without deviations overlap as drawn: then samples bind as they are meant to.
    wide : str
        Tolerances that are wider than a play of the drive, in words; empty where none are.
    asked : bool
        Whether a limit of the least backlash judges the samples.
    """

    each: NDArray[np.bool_]
    counted: Kept | None
    preloaded: bool
    wide: str
    asked: bool

    @property
    def keeps_no_limit(self) -> NDArray[np.bool_]:
        """Samples that keep no limit of the backlash, shape (samples,)."""
        return self.each & (not self.preloaded)

    def content(self) -> dict[str, Any]:
        """Return the entry of ``summary.json``."""
        part = {} if self.counted is None else asdict(self.counted)
        return {"binding" if name == "kept" else name: value for name, value in part.items()} | {
            "preloaded": self.preloaded
        }

    def words(self) -> list[str]:
        """Messages about samples that bind, one sentence each; empty where none does or may by its tolerances."""
        advice = f"[limits] {LEAST} in the drive file judges them"
        if self.counted is None:
            message = (
                f"samples may bind, {self.wide}: name {LEAST} among --quantities, which counts those that do; {advice}"
            )
            return [message] if self.wide and not self.preloaded else []
        bound = self.counted
        share = f"{100.0 * bound.part:.1f} % ({100.0 * bound.low:.1f} … {100.0 * bound.high:.1f} %)"
        if not bound.kept:
            found = f"none of {bound.samples} samples binds, without backlash at some position: {share}"
            return [found] if self.wide and not self.preloaded else []
        count = f"{bound.kept} of {bound.samples} samples bind, without backlash at some position: {share}"
        if self.preloaded:
            return [f"{count}; parts of the drive overlap as drawn, so they count as samples that keep their limits"]
        return [f"{count}; they keep no limit of the backlash{'' if self.asked else f'; {advice}'}"]


def find_binding(
    study: Study, values: Mapping[str, FloatArray], binds: NDArray[np.bool_] | None = None
) -> Binding | None:
    """Return which samples of a study bind; None of sweeps, whose samples are no chance.

    Parameters
    ----------
    study : Study
        The study.
    values : mapping of str to array, shape (samples,)
        Its quantities; not a number where a sample failed.
    binds : array of bool, shape (samples,), optional
        Which samples bind, of a study that keeps it; it serves where the study lacks the least backlash at the output.
    """
    if not isinstance(study.design, ToleranceDesign):
        return None
    least = values.get(LEAST)  # the largest is zero only where parts overlap at every position
    each = binds if least is None else least <= NO_BACKLASH
    is_counted = each is not None
    if each is None:
        each = np.zeros(study.design.samples, dtype=bool)
    chosen = independent_samples(study.design)
    plays = _plays(study.cases[0][1])
    return Binding(
        each=each,
        counted=interval(int(each[chosen].sum()), int(chosen.sum())) if is_counted else None,
        preloaded=min(plays.values()) < 0.0,
        wide=_wide_tolerances(study.cases[0][1], study.design, plays),
        asked=any(one.quantity == LEAST for one in study.judged),
    )


CHANGE = 1e-4
"""Change of a length by which its effect on gaps is seen, mm."""
ACTING = 0.05
"""Change of some gap, by that of a length, from which the length acts there: what it moves, it moves by about as much; what
the flank is generated with moves gaps by the offsets alone, by a thousandth."""
CRANK_ANGLE = 1.0
"""Angle at which gaps are compared, rad: any at which no part stands on an axis of symmetry."""


def _plays(drive: Drive) -> dict[str, float]:
    """Drawn plays of the pairs that hold the output, mm: what rollers have or lack between their races holds none."""
    return {what: play for what, play in drawn_plays(warm_drive(drive)).items() if what != ROLLERS}


def may_bind(drive: Drive, design: ToleranceDesign) -> bool:
    """Tell whether samples are to be counted that bind: parts move as drawn, and a tolerance as wide as prints moves a gap."""
    if min(_plays(drive).values()) < 0.0:
        return False
    return any(
        tolerance >= FINEST_PRINT and pairs_that_a_length_moves(drive, path, centres)
        for path, tolerance, centres in _lengths(design)
    )


def _lengths(design: ToleranceDesign) -> Iterator[tuple[str, float, FloatArray]]:
    """Yield the lengths that scatter: field, tolerance and centres, mm."""
    factors, first = design.factors, 0
    for (path, count), distribution in zip(factors.fields, factors.distributions, strict=True):
        centres = np.array(factors.centres[first : first + (count or 1)])
        first += centres.size
        kind = field_kind(path)
        if kind is not None and kind.unit == "mm":
            yield path, distribution.tolerance, centres


def _wide_tolerances(drive: Drive, design: ToleranceDesign, plays: Mapping[str, float]) -> str:
    """The widest tolerance of a length, as wide as those of prints, beyond the play where it acts; empty where none is."""
    wide: list[tuple[float, str, str]] = []
    for path, tolerance, centres in _lengths(design):
        if tolerance < max(FINEST_PRINT, min(plays.values())):
            continue
        pairs = [pair for pair in pairs_that_a_length_moves(drive, path, centres) if tolerance >= plays[pair]]
        if pairs:
            wide.append((tolerance, path, min(pairs, key=lambda pair: plays[pair])))
    if not wide:
        return ""
    tolerance, path, least = max(wide, key=lambda entry: entry[0])
    return f"tolerances.{path} of ±{tolerance:g} mm is beyond the play of {least}, {plays[least]:.4g} mm"


def pairs_that_a_length_moves(drive: Drive, path: str, centres: FloatArray) -> list[str]:
    """Return the pairs, of wheel pins and flank and of shaft pins and holes, whose gaps a length or the errors of parts move.

    What rollers gain or lack moves the disc, and with it both.

    Parameters
    ----------
    drive : Drive
        The drive.
    path : str
        The field, in mm.
    centres : array, shape (elements,)
        Its values, one of a field that is no array.
    """
    values = (centres + CHANGE).tolist()
    is_array = (kind := field_kind(path)) is not None and kind.is_array
    changed = with_fields(drive, {path: tuple(values) if is_array else values[0]}, check=False)
    before, after = _gaps(drive), _gaps(changed)
    moved = {pair for pair, gap in before.items() if np.any(np.abs(after[pair] - gap) > ACTING * CHANGE)}
    return [pair for pair in before if pair != ROLLERS and before[pair].size and moved & {pair, ROLLERS}]


def _gaps(drive: Drive) -> dict[str, FloatArray]:
    """Gaps of all pairs by the parts that touch, discs and wheel in their nominal places, mm."""
    angle, pose = np.array([CRANK_ANGLE]), np.zeros((1, RIGID))
    gaps: dict[str, list[FloatArray]] = {FLANK: [], ROLLERS: [], HOLES: []}
    for disc in (ContactGeometry.of_drive(single) for single in single_discs(warm_drive(drive))):
        rays, bores = disc.rollers(angle), disc.bores(angle, pose)
        gaps[FLANK].append(-disc.flank(angle, pose).approach)
        gaps[ROLLERS].append(rays.bore_play - np.abs(rays.resting(bores)))
        gaps[HOLES].append(-disc.holes(angle, pose).approach)
    return {pair: np.concatenate([each.ravel() for each in of_discs]) for pair, of_discs in gaps.items()}
