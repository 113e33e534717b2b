"""Pressure over a contact that tilts, is crowned or relieved unevenly: the grid that carries load and moment of its slices."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ltca.arrays import FloatArray
from ltca.contact.contact_kind import ContactKind, Departure, Separation
from ltca.contact.pressure_cells import PatchPressure
from ltca.contact.tilted_grid import press_tilted
from ltca.errors import ConvergenceError
from ltca.laws.line_contact import LineContactLaw
from ltca.laws.sliced_contact import slice_heights
from ltca.laws.sliced_line import SlicedLine
from ltca.laws.width_pressure import PatchAlongWidth

SLICES = 9
"""Of the contact by which the search for approach and tilt starts."""
CARRIED = 1e-4
"""Load, and moment by half the length, that a field may lack of those of its contact, by the load."""
MOST_STEPS, MOST_HALVINGS = 40, 14

_Press = Callable[[float, float], FloatArray]
"""Load, moment, ∂F/∂δ, ∂F/∂θ and ∂M/∂θ at an approach, mm, and a tilt, rad."""


def solve_tilted(
    kind: ContactKind, load: float, moment: float, effective_radius: float, departure: Departure
) -> tuple[PatchPressure, float]:
    """Return the pressure of a contact that carries load and moment, N and N·mm, and its largest pressure, MPa.

    Parameters
    ----------
    kind : ContactKind
        Its length, modulus, crown and lead.
    load, moment : float
        Of the slices, about the middle of the width.
    effective_radius : float
        ρ, mm.
    departure : callable
        Separation over the distance along the tangent, mm.

    Raises
    ------
    ConvergenceError
        When no approach and tilt are found.

    Notes
    -----
    What lies behind a contact has its part of the approach and the tilt of the bodies; load and moment it has not. The grid
    that fits best leaves up to some 1 % of the load of all that are blended (`ltca.contact.tilted_grid`): its cells are scaled.
    """
    half = 0.5 * kind.length
    separation = Separation(effective_radius=effective_radius, departure=lambda _, x: departure(x))
    line = SlicedLine(
        length=kind.length,
        contact_modulus=kind.contact_modulus,
        slices=SLICES,
        relief=kind.relief(slice_heights(kind.length, SLICES)),
    )

    def by_slices(approach: float, tilt: float) -> FloatArray:
        found = line.respond(np.array([approach]), np.array([tilt]), np.array([effective_radius]))
        return np.concatenate((found.load, found.moment, found.by_approach, found.by_tilt, found.moment_by_tilt))

    def by_grids(approach: float, tilt: float) -> FloatArray:
        found = press_tilted(kind, separation, approach, tilt)
        return np.zeros(5) if found is None else np.array(found[:5])

    law = LineContactLaw(kind.length, kind.contact_modulus)
    start = float(law.approach_at_load(np.array(load), np.array(effective_radius))[0])
    # Deep enough for something to touch whatever the relief.
    begin = start + max(0.0, float(np.min(kind.relief(np.linspace(-half, half, 33))))), 0.0
    approach, tilt = _pressed(by_grids, load, moment, half, _pressed(by_slices, load, moment, half, begin))
    pressed = press_tilted(kind, separation, approach, tilt)
    assert pressed is not None
    patch = pressed.patch
    scale = load / patch.load
    return replace(patch, pressure=scale * patch.pressure), scale * PatchAlongWidth.of_patch(patch, kind).largest()[0]


def _pressed(press: _Press, load: float, moment: float, half: float, begin: tuple[float, float]) -> tuple[float, float]:
    """Approach and tilt at which a contact carries load and moment, by Newton's method with shortened steps."""
    lengths = np.array((1.0, 1.0 / half))

    def at(place: FloatArray) -> tuple[FloatArray, FloatArray]:
        """What is left over of load and moment by half the length, and their slopes, in N and N/mm."""
        load_here, moment_here, stiff, mixed, turning = press(*(place * lengths))
        left = np.array((load_here - load, (moment_here - moment) / half))
        return left, np.array(((stiff, mixed / half), (mixed / half, turning / half**2)))

    place = np.array(begin) / lengths
    left, slopes = at(place)
    history = []
    for _ in range(MOST_STEPS):
        history.append(float(np.max(np.abs(left))) / load)
        if history[-1] <= CARRIED:
            return float(place[0]), float(place[1] * lengths[1])
        # A contact that touches at one end alone turns about that end freely.
        step = -np.linalg.solve(slopes + 1e-9 * np.trace(slopes) * np.eye(2), left)
        for _ in range(MOST_HALVINGS):
            there, steeper = at(place + step)
            if np.linalg.norm(there) < np.linalg.norm(left) and np.trace(steeper) > 0.0:
                break
            step = 0.5 * step
        place, left, slopes = place + step, there, steeper
        if len(history) > 3 and history[-1] > 0.9 * history[-3] and history[-1] < 1e-3:
            # From one grid to the next loads jump by some 1e-4: as close as grids come.
            return float(place[0]), float(place[1] * lengths[1])
    raise ConvergenceError(
        f"no tilted pressure field carries {load:g} N and {moment:g} N·mm; left over by the load", history
    )
