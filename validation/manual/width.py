"""Contacts along their width: lines that tilt and crowned lines, in slices, against half-space grids."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from ltca.arrays import FloatArray
from ltca.contact.contact_kind import ContactKind, Separation
from ltca.contact.tilted_grid import press_tilted
from ltca.geometry.length_profile import Relief
from ltca.laws.sliced_contact import slice_heights
from ltca.laws.sliced_line import SlicedLine
from ltca.laws.width_pressure import estimate_along_width
from validation.manual.case import Case, Figure, Reference
from validation.methods.grid_pressures import solve_along_width

LENGTH, MODULUS, DEEP = 12.0, 115e3, 3e-3
"""Length of the line, mm, E*, MPa, and the approach to which approaches, tilts at the ends and drops are scaled, mm."""
RADII = (3.0, 20.0)
"""Radii of the cylinder, mm: length by half-width 232 and 83."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TiltedLine:
    """A line pressed and tilted, by slices and by grids.

    Attributes
    ----------
    sliced, on_grid : array, shape (3,)
        Load, N, moment, N·mm, and largest pressure, MPa.
    arm : float
        What differences of moments are divided by, N·mm: the moment, or a sixth of load times length where that is more.
    """

    sliced: FloatArray
    on_grid: FloatArray
    arm: float

    @property
    def differences(self) -> FloatArray:
        """Relative differences of load, moment and largest pressure."""
        scale = np.array([self.on_grid[0], self.arm, self.on_grid[2]])
        return np.asarray((self.sliced - self.on_grid) / scale)


def _kind(drop: float) -> ContactKind:
    """A line without or with a crown."""
    profile = None
    if drop:
        profile = Relief(length=LENGTH, crown_radius=LENGTH**2 / (8.0 * drop * DEEP))
    # Twelve cells over the half-width and half the length: the load errs by 5e-4, the moment by 1e-3 (20 cells).
    return ContactKind(length=LENGTH, contact_modulus=MODULUS, generator=profile, symmetric=True)


@cache
def press_on_grid(radius: float, approach: float, tilt: float, drop: float) -> tuple[float, float, float]:
    """Return load, moment and largest pressure of a line on half-space grids; arguments as for `press_line`."""
    kind, delta, theta = _kind(drop), approach * DEEP, 2.0 * tilt * DEEP / LENGTH
    separation = Separation(effective_radius=radius, departure=lambda _, x: x**2 / (2.0 * radius))
    grid = press_tilted(kind, separation, delta, theta)
    if grid is None:
        raise ValueError(f"approach {approach:g}, tilt {tilt:g}: the line is open")
    found = solve_along_width(kind, np.array([delta]), np.array([theta]), np.array([radius]))
    return grid.load, grid.moment, float(found.largest[0])


def press_line(radius: float, slices: int, approach: float, tilt: float, drop: float = 0.0) -> TiltedLine:
    """Press a line; approach, tilt at the end and drop of a crown are by `DEEP`, the radius in mm."""
    kind = _kind(drop)
    relief = kind.relief(slice_heights(LENGTH, slices))
    line = SlicedLine(length=LENGTH, contact_modulus=MODULUS, slices=slices, relief=relief)
    at = np.array([radius])
    found = line.respond(np.array([approach * DEEP]), np.array([2.0 * tilt * DEEP / LENGTH]), at)
    largest = float(estimate_along_width(kind, found.line_load, at).largest[0])
    on_grid = np.array(press_on_grid(radius, approach, tilt, drop))
    return TiltedLine(
        sliced=np.array([found.load[0], found.moment[0], largest]),
        on_grid=on_grid,
        arm=max(abs(on_grid[1]), on_grid[0] * LENGTH / 6.0),
    )


STRAIGHT = (
    ("full line", 9, 1.0, 0.0),
    ("one end half as deep", 9, 1.0, 1.0 / 3.0),
    ("one end just out", 9, 1.0, 1.0),
    ("three quarters of the line", 9, 1.0, 2.0),
    ("half of the line", 9, 0.0, 1.0),
    ("a quarter, seventeen slices", 17, -1.0, 2.0),
    ("an eighth, forty-nine slices", 49, -1.5, 2.0),
)
"""What is pressed, slices, approach and tilt at the end by `DEEP`."""
CROWNED = (
    ("crown as deep as pressed", 1.0, 0.0),
    ("crown as deep as pressed, tilted", 1.0, 0.5),
    ("crown as deep as pressed, on its end", 1.0, 2.0),
    ("crown that leaves half of the line", 4.0, 0.0),
    ("crown that leaves half of the line, tilted", 4.0, 2.0),
)
"""What is pressed, drop of the crown and tilt at the end by `DEEP`."""


def _figures(name: str, radius: float, slices: int, approach: float, tilt: float, drop: float) -> list[Figure]:
    """Load, moment and largest pressure of a line; the pressure is bounded where a crown keeps the ends from being singular."""
    coarser, found = (press_line(radius, count, approach, tilt, drop) for count in ((slices + 1) // 2, slices))
    change = np.abs(found.differences - coarser.differences)
    reason = "asked of slices where the contact reaches over four of them and more"
    singular = "no bound: the estimate by line loads at ends that are singular, and 1 % of the grid itself"
    figures = []
    for number, (quantity, unit, bound, why, grid) in enumerate((
        ("load", "N", 1e-2, reason, 5e-4),
        ("moment", "N·mm", 2e-2, f"{reason}; of the moment, or of a sixth of load times length where that is more", 1e-3),
        ("largest pressure", "MPa", 3e-2 if drop else None, reason if drop else singular, 1e-2),
    )):  # fmt: skip
        if number == 1 and not tilt:
            continue  # none by symmetry
        figures.append(
            Figure(
                quantity=f"{quantity}, radius {radius:g} mm, {name}",
                value=float(found.sliced[number]),
                reference=float(found.on_grid[number]),
                unit=unit,
                difference=float(found.differences[number]),
                difference_unit="",
                bound=bound,
                bound_reason=why,
                numerical_error=float(change[number]),
                numerical_origin="change from slices twice as wide",
                reference_error=grid,
            )
        )
    return figures


def _straight() -> list[Figure]:
    return [
        figure
        for radius in RADII
        for name, slices, approach, tilt in STRAIGHT
        for figure in _figures(name, radius, slices, approach, tilt, 0.0)
    ]


def _crowned() -> list[Figure]:
    return [
        figure
        for radius in RADII
        for name, drop, tilt in CROWNED
        for figure in _figures(name, radius, 9, 1.0, tilt, drop)
    ]


GRID = Reference(
    source="Half-space grids of the whole surface (`ltca.contact.tilted_grid`): Boussinesq's solution by Love's "
    "rectangles, "
    "independent of slices and of their tables; tamaas judges them in turn (tests/referee)",
    uncertainty="Load 5e-4, moment 1e-3 (against 20 cells over the half-width instead of 12), pressure 1 % at ends.",
)
MODEL = (
    "`ltca.laws.sliced_line.SlicedLine`: a plane-strain-like law for each slice, coupled along the width by Love's "
    "kernel; largest "
    "pressure from the line loads (`ltca.laws.width_pressure`)."
)

CASES = (
    Case(
        name="tilted_line",
        title="A straight line that tilts",
        problem="A cylinder of radius 3 or 20 mm and 12 mm length on a flat, E* 115 000 MPa, pressed by up to 3 µm in "
        "the middle and "
        "tilted, from the full line to an eighth that carries alone: load, moment and largest pressure.",
        references=(GRID,),
        model=MODEL,
        model_uncertainty="The kernel takes the half-width of the mean line load for all slices.",
        run=_straight,
    ),
    Case(
        name="crowned_line",
        title="A crowned line, aligned and tilted",
        problem="The same cylinders with a crown that drops by 3 or 12 µm at the ends, pressed by 3 µm, aligned and "
        "tilted: load, moment and "
        "largest pressure.",
        references=(GRID,),
        model=MODEL,
        model_uncertainty="The kernel takes the half-width of the mean line load for all slices.",
        run=_crowned,
    ),
)
