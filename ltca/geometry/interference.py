"""Overlap of the parts as drawn, before any body yields: it preloads a drive without external load."""

from __future__ import annotations

from math import inf, sqrt
from typing import NamedTuple

from ltca.drive.deviations import BoreErrors, PlacementErrors
from ltca.drive.parts import Drive
from ltca.drive.single_discs import single_discs

# A fit that is exact in the definition (r_i + 2 r_BR = r_o) must not overlap by the rounding of the sum.
ROUNDING = 1e-9
"""Overlap within the rounding of a sum, mm."""
ROLLERS = "rollers and races"
FLANK = "wheel pins and flank"
HOLES = "shaft pins and holes"
"""Name of the pair whose overlap depends on the errors of single pins as well (`ltca.geometry.first_contact.interference`)."""


class Interference(NamedTuple):
    """Overlaps of the drawn parts with the disc in its nominal place, mm, clearances included; negative where there is play."""

    pins: float  # largest of wheel pins and flank over the mesh, the wheel at its ideal angle
    rollers: float  # of a roller and both races together
    holes: float  # of shaft pins on one side against the eccentricity; −∞ without them


def drawn_interference(drive: Drive) -> Interference:
    """Return the overlaps of the parts of a drive whose flank has no loops, errors of single parts left out.

    >>> from ltca.reading.drive_file import load_drive
    >>> found = drawn_interference(load_drive("paper").cases["CS-3"])
    >>> print(f"{found.pins:.3f} {found.rollers:.3f} {found.holes:.3f}")
    -0.060 -0.015 0.000
    """
    wheel, disc, bearing, shaft = drive.pin_wheel, drive.disc, drive.crank_bearing, drive.pin_shaft
    # Gap of every pin in the nominal position: Δr_P − ΔR_C cos ψ, ψ between 0 and asin(e z_P/R).
    radius = wheel.pin_circle_radius + disc.shifting_offset
    pitch = drive.crank.eccentricity * drive.reduction_ratio  # a flank with loops is refused, and has no such angle
    steepest = sqrt(1.0 - (pitch / radius) ** 2) if abs(radius) > pitch else 0.0
    return Interference(
        pins=max(disc.shifting_offset, disc.shifting_offset * steepest) - disc.equidistant_offset - wheel.seat_play,
        rollers=bearing.inner_race_radius + 2.0 * bearing.roller_radius - drive.bore_radius,
        holes=-inf
        if shaft is None
        else drive.crank.eccentricity + shaft.pin_radius - shaft.seat_play - drive.hole_radius,
    )


def lost_play(cold: Drive, warm: Drive) -> list[str]:
    """Return messages about the plays of a drive at 20 °C that are lost in the `warm` one."""
    before, after = drawn_plays(cold), drawn_plays(warm)
    return [
        f"the play of {what} ({before[what]:.4g} mm at 20 °C) is gone: they overlap by {-after[what]:.4g} mm"
        for what in before
        if after[what] < 0.0 and after[what] < before[what] - ROUNDING
    ]


def drawn_plays(drive: Drive) -> dict[str, float]:
    """Return the least play of any disc by the parts that touch, mm, negative for overlap, discs in mid-eccentric."""
    overlaps = {FLANK: -inf, ROLLERS: -inf, HOLES: -inf}
    for single in single_discs(drive):
        pins, rollers, holes = drawn_interference(single)
        error = single.crank.eccentricity_error
        rollers += sum(_mean_shift(own.bore_errors) for own in single.disc.of)
        holes = holes + error + _mean_shift(None if single.pin_shaft is None else single.pin_shaft.pin_errors)
        for what, overlap in zip(overlaps, (pins + abs(error), rollers, holes), strict=True):
            overlaps[what] = max(overlaps[what], overlap)
    return {what: 0.0 if abs(overlap) <= ROUNDING else -overlap for what, overlap in overlaps.items() if overlap > -inf}


def _mean_shift(errors: BoreErrors | PlacementErrors | None) -> float:
    """By how much the circle of some parts is larger or smaller than its radius: it presses all of them alike, mm."""
    radial = () if errors is None else errors.radial
    return abs(sum(radial) / len(radial)) if radial else 0.0


def overlap_at_rest(drive: Drive, flank: float) -> tuple[float, str]:
    """Return the largest overlap of any pair of parts without load, mm, and the names of the parts, given that of the `flank`."""
    overlaps = {what: -play for what, play in drawn_plays(drive).items() if what != FLANK} | {FLANK: flank}
    what = max(overlaps, key=lambda one: overlaps[one])
    return (overlaps[what], what) if overlaps[what] > 0.0 else (0.0, "")


def preload_warning(drive: Drive) -> str | None:
    """Return a warning of a drive whose parts overlap as drawn, None where none do; errors of single parts are left out."""
    fields = (
        ("wheel pins the flank", "disc.equidistant_offset"),
        ("rollers the races", "crank_bearing.roller_radius"),
        ("shaft pins the holes", "pin_shaft.hole_radius"),
    )
    largest = map(max, zip(*map(drawn_interference, single_discs(drive)), strict=True))
    named = [
        f"{what} by {overlap:.4g} mm ({field})"
        for overlap, (what, field) in zip(largest, fields, strict=True)
        if overlap > ROUNDING
    ]
    if not named:
        return None
    return f"parts overlap as drawn: {', '.join(named)}; the drive is preloaded, its contacts carry without load"
