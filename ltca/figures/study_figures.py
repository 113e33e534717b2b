"""Figures of a study: distribution of every quantity, what they come from, and responses of a sweep."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from textwrap import fill
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ltca.figures.field_scale import field_scale
from ltca.figures.house_style import COLOURS, DASHED, INK, OTHERS, STYLE, save_figure, shortened_label
from ltca.quantities import SCALARS
from ltca.studies.designs import SweepDesign
from ltca.studies.execution.storage import StudyFolder
from ltca.studies.sensitivity import CHANCE_WORDS, is_chance, together_words
from ltca.studies.study import Study
from ltca.studies.study_results import read_quantity

FIELDS_SHOWN = 8
"""Fields in a ranking; the rest has no share worth a bar."""
TITLE_LETTERS = 44
"""Letters of a line above a panel."""


def write_study_figures(
    folder: StudyFolder, study: Study, ranking: Mapping[str, Any], nominal: Mapping[str, float], kind: str = "svg"
) -> Iterator[Path]:
    """Write the figures of a finished study into ``figures`` beside its results, one after the other.

    `ranking` is that of `ltca.studies.sensitivity.rank`; `nominal`, quantities without deviations, is drawn where known.
    """
    values = {name: read_quantity(folder.results, name) for name in study.quantities}
    for name, figure in study_figures(study, values, ranking, nominal):
        yield save_figure(figure, folder.path / "figures" / f"{name}.{kind}")


def study_figures(
    study: Study, values: Mapping[str, Any], ranking: Mapping[str, Any], nominal: Mapping[str, float]
) -> Iterator[tuple[str, Figure]]:
    """Yield the figures of a study with their names.

    `values` of every quantity have shape (samples,), `ranking` is that of `ltca.studies.sensitivity.rank`, `nominal` has
    quantities of the drive without deviations, drawn where known.
    """
    with mpl.rc_context(STYLE):
        if isinstance(study.design, SweepDesign):
            yield "responses", _responses(study, study.design, values)
        else:
            yield "distributions", _distributions(study, values, nominal)
        if ranking["quantities"]:
            yield "sensitivity", _ranking(study, ranking)


def _head(study: Study, rest: str) -> str:
    samples = f"{study.design.samples} samples × {study.positions} positions"
    return f"{shortened_label(study.name, 40)}, {study.engine.compliance}: {samples}{rest}"


def _panels(count: int, height: float, width: float = 3.4, most: int = 3) -> tuple[Figure, Any]:
    columns = min(most, count)
    rows = -(-count // columns)
    # Room for the words above all, also of one panel.
    figure = Figure(figsize=(max(width * columns, 6.8), height * rows + 0.7))
    axes = np.atleast_1d(figure.subplots(rows, columns, squeeze=False)).ravel()
    for spare in axes[count:]:
        spare.set_visible(False)
    return figure, axes


def _distributions(study: Study, values: Mapping[str, Any], nominal: Mapping[str, float]) -> Figure:
    figure, axes = _panels(len(study.quantities), 2.1)
    for axis, name in zip(axes, study.quantities, strict=False):
        finite = values[name][np.isfinite(values[name])]
        axis.hist(finite, bins=min(60, max(8, int(np.sqrt(finite.size)))), color=COLOURS[6], linewidth=0.0)
        axis.set_xlabel(fill(SCALARS[name].heading, TITLE_LETTERS), fontsize=8.0)
        axis.set_yticks([])
        axis.grid(visible=False)
        axis.spines["left"].set_visible(False)
        axis.xaxis.set_major_locator(mpl.ticker.MaxNLocator(4))
        axis.ticklabel_format(axis="x", useOffset=False)
        if finite.size:
            for place in np.percentile(finite, (1.0, 99.0)):
                axis.axvline(place, color=COLOURS[2], linewidth=1.0, linestyle=DASHED)
        if name in nominal:
            axis.axvline(nominal[name], color=COLOURS[0], linewidth=1.2)
    marks = [
        Patch(color=COLOURS[6], label="samples"),
        Line2D([], [], color=COLOURS[2], linewidth=1.0, linestyle=DASHED, label="1 % and 99 %"),
        Line2D([], [], color=COLOURS[0], linewidth=1.2, label="without deviations"),
    ]
    figure.legend(handles=marks, loc="outside lower center", ncols=3, frameon=False, fontsize=8.0)
    figure.suptitle(_head(study, ""))
    return figure


MAX_HEIGHT = 12.0
"""Inches that a figure of responses may be high before its quantities stand in blocks beside each other."""


def _responses(study: Study, design: SweepDesign, values: Mapping[str, Any]) -> Figure:
    """Every quantity over every factor; samples alike in all other factors are joined."""
    factors = list(design.factors)[:FIELDS_SHOWN]
    count, across = len(study.quantities), len(factors)
    height = 1.25 if across < 4 else 1.0
    # Beside each other as far as a page is wide: few factors leave room for several blocks.
    blocks = max(1, min(-(-count // 2), 4 // across, int(np.ceil(count * height / (0.6 * MAX_HEIGHT)))))
    rows = -(-count // blocks)
    width = max(1.9, 3.2 / across)
    figure = Figure(figsize=(max(0.9 * blocks + width * across * blocks, 6.8), 1.3 + height * rows))
    grid = figure.subplots(rows, across * blocks, squeeze=False, sharex="col")
    numbers = design.rows(0, design.samples)
    shown = [field_scale(factor.path, numbers[:, column]) for column, factor in enumerate(factors)]
    for place in range(rows * blocks):
        row, block = place % rows, place // rows
        axes = grid[row, block * across : (block + 1) * across]
        if place >= count:
            for spare in axes:
                spare.set_visible(False)
            continue
        name = study.quantities[place]
        for column, (axis, factor) in enumerate(zip(axes, factors, strict=True)):
            scale, unit = shown[column]
            x = numbers[:, column] * (1.0 if factor.is_text else scale)
            _response(axis, design, numbers, column, x, values[name])
            if column:
                axis.sharey(axes[0])
                axis.tick_params(labelleft=False)
            axis.yaxis.set_major_locator(mpl.ticker.MaxNLocator(3))
            if factor.is_text:
                axis.set_xticks(range(len(factor.levels)), [shortened_label(str(level), 14) for level in factor.levels])
                axis.margins(x=0.25)
            else:
                axis.xaxis.set_major_locator(mpl.ticker.MaxNLocator(3))
            if row == rows - 1 or place == count - 1:
                axis.tick_params(labelbottom=True)
                words = study.field_words(factor.path).replace(" (", "\n(").replace(".", ".\u200b")
                words = _wrapped_path(words, int(14.0 * width))
                axis.set_xlabel(words + (f"\n[{unit}]" if unit and not factor.is_text else ""), fontsize=7.5)
        heading = fill(SCALARS[name].heading, int(15.0 * width * across))
        axes[0].set_title(heading, loc="left", fontsize=8.0, color=INK, pad=3.0)
    figure.suptitle(fill(_head(study, ""), int(13.0 * figure.get_figwidth())))
    return figure


def _wrapped_path(words: str, letters: int) -> str:
    """Break a path of fields at its points where it is longer than a line."""
    lines = [""]
    for part in words.replace("\u200b", "\n\u200b").split("\n"):
        joined = part.startswith("\u200b")
        text = part.lstrip("\u200b")
        if joined and len(lines[-1]) + len(text) <= letters:
            lines[-1] += text
        elif lines == [""]:
            lines = [text]
        else:
            lines.append(text)
    return "\n".join(lines)


def _response(axis: Any, design: SweepDesign, numbers: Any, column: int, x: Any, values: Any) -> None:
    """One quantity over one factor."""
    if design.kind == "grid" and len(design.factors[column].levels) > 1 and design.samples <= 2000:
        others = np.delete(numbers, column, axis=1)
        for group in np.unique(others, axis=0):
            line = np.flatnonzero((others == group).all(axis=1))
            axis.plot(x[line], values[line], color=COLOURS[1], linewidth=0.9, marker="o", markersize=2.5)
    else:
        axis.plot(x, values, ".", color=COLOURS[1], markersize=3.0 if design.samples < 500 else 1.0)


def _ranking(study: Study, ranking: Mapping[str, Any]) -> Figure:
    names = [name for name in study.quantities if name in ranking["quantities"]]
    bars = min(FIELDS_SHOWN, max(len(ranking["quantities"][name]["shares"]) for name in names))
    figure, axes = _panels(len(names), 0.95 + 0.17 * bars, 4.9, 2 if len(names) < 7 else 3)
    by_regression = "regression" in ranking["method"]
    for axis, name in zip(axes, names, strict=False):
        entry = ranking["quantities"][name]
        shares = dict(list(entry["shares"].items())[:FIELDS_SHOWN])
        colours = [OTHERS if is_chance(entry, path) else COLOURS[1] for path in shares]
        places = np.arange(len(shares))
        axis.barh(places, [100.0 * share for share in shares.values()], color=colours, height=0.7)
        axis.set_yticks(places, [shortened_label(study.field_words(path), 40) for path in shares], fontsize=7.0)
        axis.invert_yaxis()
        axis.grid(visible=False, axis="y")
        axis.set_xlim(0.0, max(1.0, 104.0 * max(shares.values(), default=0.0)))
        axis.xaxis.set_major_locator(mpl.ticker.MaxNLocator(5))
        axis.set_xlabel("share of the variance [%]", fontsize=7.5)
        axis.tick_params(axis="x", labelsize=7.5)
        words = f"{SCALARS[name].title}\n{together_words(entry)}"
        axis.set_title(
            "\n".join(fill(line, 2 * TITLE_LETTERS // 3 + 8) for line in words.split("\n")), fontsize=8.0, loc="left"
        )
    told = f"{shortened_label(study.name, 40)}: {ranking['method']}"
    letters = int(12.5 * figure.get_figwidth())
    told += f"\n{study.design.samples} samples; "
    if by_regression:
        told += f"grey: {CHANCE_WORDS}: such ranks say nothing"
    else:
        noise = _relative_noise(ranking["method"])
        told += f"an index is known to some {noise:.0f} % of itself: closer ranks say nothing"
    figure.suptitle("\n".join(fill(line, letters) for line in told.split("\n")))
    return figure


def _relative_noise(method: str) -> float:
    """Deviation of a mean of squares over the blocks of a Sobol design, per cent of it."""
    words = method.split()
    blocks = int(words[-2]) if len(words) > 1 and words[-2].isdigit() else 1
    return float(100.0 * np.sqrt(2.0 / blocks))
