"""Labels beside points in free space: candidate places are compared by cost, distant ones get a leader line."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox

DIRECTIONS = 16
"""Directions tried about a point."""
LEAST_GAP, LARGEST_GAP, GAP_STEP = 3.0, 120.0, 6.0
"""Gaps between a point and its word that are tried, pixels."""
LEADER_GAP = 14.0
"""Gap from which on a line joins them, pixels."""
LINE_COST, TURN_COST, DISTANCE_COST = 40.0, 6.0, 1.0
"""What a place costs: each line crossed, half a turn from the direction wanted, each pixel of distance."""


class FreeLabels:
    """Boxes and lines already drawn in some axes.

    Parameters
    ----------
    figure : Figure
        Laid out already: places are found in pixels.
    axes : Axes
        In which words stand.
    """

    def __init__(self, figure: Figure, axes: Any) -> None:
        canvas = FigureCanvasAgg(figure)
        self._renderer = canvas.get_renderer()  # type: ignore[no-untyped-call]
        self._axes = axes
        axes.apply_aspect()
        self._frame = axes.get_window_extent(self._renderer)
        self._boxes = np.zeros((0, 4))
        self._lines: list[np.ndarray[Any, Any]] = []

    def keep(self, text: Any) -> None:
        """Keep labels off a text."""
        self._boxes = np.vstack([self._boxes, text.get_window_extent(self._renderer).extents])

    def keep_circle(self, centre: complex, radius: float) -> None:
        """Keep labels off a circle, in data coordinates."""
        corners = np.array([[centre.real - radius, centre.imag - radius], [centre.real + radius, centre.imag + radius]])
        box = np.asarray(self._axes.transData.transform(corners), dtype=float).ravel()
        self._boxes = np.vstack([self._boxes, box])

    def keep_line(self, start: complex, end: complex) -> None:
        """Make labels avoid a line, in data coordinates."""
        points = np.array([[start.real, start.imag], [end.real, end.imag]])
        first, last = np.asarray(self._axes.transData.transform(points), dtype=float)
        self._lines.append(np.linspace(first, last, 12))

    def place(self, words: str, point: complex, direction: complex, **style: Any) -> Any:
        """Write words near a point, in a direction from it if there is room, and return the text; both in data coordinates."""
        text = self._axes.text(point.real, point.imag, words, ha="center", va="center", **style)
        box = text.get_window_extent(self._renderer)
        half = 0.5 * np.array([box.width + 3.0, box.height + 2.0])
        at = self._axes.transData.transform((point.real, point.imag))
        first = np.angle(direction)
        points = np.concatenate([*self._lines, np.zeros((0, 2))])
        best, least = None, np.inf
        for gap in np.arange(LEAST_GAP, LARGEST_GAP, GAP_STEP):
            if gap * DISTANCE_COST >= least:
                break
            for turn in np.linspace(-np.pi, np.pi, DIRECTIONS, endpoint=False):
                ray = np.array([np.cos(first + turn), np.sin(first + turn)])
                # So far that the box clears the point by the gap.
                reach = gap + float(np.min(half / np.maximum(np.abs(ray), 1e-9)))
                middle = at + reach * ray
                if not self._free(middle, half):
                    continue
                crossed = np.all(np.abs(points - middle) < half, axis=1).any()
                cost = gap * DISTANCE_COST + TURN_COST * abs(turn) / np.pi + LINE_COST * crossed
                if cost < least:
                    best, least = (middle, gap), cost
        if best is None:  # nowhere room: better no word than one on another
            text.remove()
            return None
        middle, gap = best
        place = self._axes.transData.inverted().transform(middle)
        text.set_position(place)
        self._boxes = np.vstack([self._boxes, Bbox.from_extents(*(middle - half), *(middle + half)).extents])
        if gap > LEADER_GAP:
            nearest = middle + np.clip(at - middle, -half, half)
            end = self._axes.transData.inverted().transform(nearest)
            self._axes.plot(
                [point.real, end[0]], [point.imag, end[1]], color=style.get("color"), linewidth=0.5, zorder=7.8
            )
        return text

    def _free(self, middle: np.ndarray[Any, Any], half: np.ndarray[Any, Any]) -> bool:
        low, high = middle - half, middle + half
        if np.any(low < self._frame.min) or np.any(high > self._frame.max):
            return False
        boxes = self._boxes
        return not np.any(np.all((boxes[:, :2] < high) & (boxes[:, 2:] > low), axis=1))
