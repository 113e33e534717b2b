"""Figures of a study: distribution of every quantity, what they come from, and responses of a sweep."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from ltca.figures.labelled_curves import COLOURS, STYLE
from ltca.output.files import whole_file
from ltca.studies.designs import SweepDesign
from ltca.studies.execution.storage import StudyFolder
from ltca.studies.quantities import QUANTITIES
from ltca.studies.study import Study
from ltca.studies.study_results import read_quantity

SHOWN = 8
"""Fields in a ranking; the rest has no share worth a bar."""


def write_study_figures(
    folder: StudyFolder, study: Study, ranking: Mapping[str, Any], nominal: Mapping[str, float]
) -> Iterator[Path]:
    """Write the figures of a finished study as SVG and PNG.

    Parameters
    ----------
    folder : StudyFolder
        Where ``results.nc`` is; figures go to its ``figures``.
    study : Study
        The study.
    ranking : mapping
        Of `ltca.studies.study_results.rank`.
    nominal : mapping of str to float
        Quantities of the drive without deviations, drawn where known.

    Yields
    ------
    Path
        The PNG of each figure when both files are written.
    """
    with mpl.rc_context(STYLE):
        if isinstance(study.design, SweepDesign):
            yield from _save(_responses(folder, study, study.design), folder.path / "figures" / "responses")
        else:
            yield from _save(_distributions(folder, study, nominal), folder.path / "figures" / "distributions")
        if ranking["quantities"]:
            yield from _save(_ranking(study, ranking), folder.path / "figures" / "sensitivity")


def _save(figure: Figure, stem: Path) -> Iterator[Path]:
    for suffix in (".svg", ".png"):
        path = stem.with_suffix(suffix)
        with whole_file(path) as part:
            figure.savefig(part, dpi=130, metadata={"Date": None} if suffix == ".svg" else None)
    yield stem.with_suffix(".png")


def _panels(count: int, height: float) -> tuple[Figure, Any]:
    columns = min(3, count)
    rows = -(-count // columns)
    figure = Figure(figsize=(3.4 * columns, height * rows))
    axes = np.atleast_1d(figure.subplots(rows, columns, squeeze=False)).ravel()
    for spare in axes[count:]:
        spare.set_visible(False)
    return figure, axes


def _distributions(folder: StudyFolder, study: Study, nominal: Mapping[str, float]) -> Figure:
    figure, axes = _panels(len(study.quantities), 2.3)
    for axis, name in zip(axes, study.quantities, strict=False):
        values = read_quantity(folder.results, name)
        values = values[np.isfinite(values)]
        axis.hist(values, bins=min(60, max(8, int(np.sqrt(values.size)))), color=COLOURS[1], linewidth=0.0)
        axis.set_xlabel(QUANTITIES[name].heading, fontsize=8.0)
        axis.set_yticks([])
        axis.grid(visible=False)
        axis.spines["left"].set_visible(False)
        axis.xaxis.set_major_locator(mpl.ticker.MaxNLocator(5))
        low, high = np.percentile(values, (1.0, 99.0))
        for place in (low, high):
            axis.axvline(place, color=COLOURS[2], linewidth=1.0, linestyle=(0, (4, 2)))
        if name in nominal:
            axis.axvline(nominal[name], color=COLOURS[0], linewidth=1.2)
    figure.suptitle(
        f"{study.name}, {study.engine.compliance}: {study.design.samples} samples × {study.positions} positions "
        "(dashed: 1 % and 99 %; black: no deviations)",
        fontsize=9.5,
    )
    return figure


def _responses(folder: StudyFolder, study: Study, design: SweepDesign) -> Figure:
    """Every quantity over every factor; samples alike in all other factors are joined."""
    factors = list(design.factors)[:SHOWN]
    rows, columns = len(study.quantities), len(factors)
    figure = Figure(figsize=(2.6 + 2.6 * columns, 1.0 + 1.9 * rows))
    axes = figure.subplots(rows, columns, squeeze=False, sharey="row", sharex="col")
    numbers = design.rows(0, design.samples)
    for row, name in enumerate(study.quantities):
        values = read_quantity(folder.results, name)
        for column, factor in enumerate(factors):
            axis = axes[row, column]
            x = numbers[:, column]
            if design.kind == "grid" and len(factor.levels) > 1 and design.samples <= 2000:
                others = np.delete(numbers, column, axis=1)
                for group in np.unique(others, axis=0):
                    line = np.flatnonzero((others == group).all(axis=1))
                    axis.plot(x[line], values[line], color=COLOURS[1], linewidth=0.9, marker="o", markersize=2.5)
            else:
                axis.plot(x, values, ".", color=COLOURS[1], markersize=3.0 if design.samples < 500 else 1.0)
            if factor.is_text:
                axis.set_xticks(range(len(factor.levels)), factor.levels)
            else:
                axis.xaxis.set_major_locator(mpl.ticker.MaxNLocator(4))
            if row == rows - 1:
                axis.set_xlabel(study.field_words(factor.path).replace(" (", "\n("), fontsize=8.0)
        axes[row, 0].set_ylabel(QUANTITIES[name].heading, fontsize=7.0, wrap=True)
    figure.suptitle(
        f"{study.name}, {study.engine.compliance}: {design.samples} samples × {study.positions} positions", fontsize=9.5
    )
    return figure


def _ranking(study: Study, ranking: Mapping[str, Any]) -> Figure:
    names = [name for name in study.quantities if name in ranking["quantities"]]
    figure, axes = _panels(len(names), 2.2)
    for axis, name in zip(axes, names, strict=False):
        entry = ranking["quantities"][name]
        shares = dict(list(entry["shares"].items())[:SHOWN])
        places = np.arange(len(shares))
        axis.barh(places, [100.0 * share for share in shares.values()], color=COLOURS[1], height=0.7)
        axis.set_yticks(places, [study.field_words(path) for path in shares], fontsize=6.0)
        axis.invert_yaxis()
        axis.grid(visible=False, axis="y")
        axis.set_xlim(left=0.0)
        axis.set_xlabel("share of the variance [%]", fontsize=7.5)
        axis.tick_params(axis="x", labelsize=7.5)
        axis.set_title(
            f"{QUANTITIES[name].description}\nfirst order together {100.0 * entry['explained']:.0f} %", fontsize=8.0
        )
    figure.suptitle(f"{study.name}: {ranking['method']}", fontsize=9.5)
    return figure
