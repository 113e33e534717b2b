"""How far parts overlap as they are drawn, before any body yields: what presses a drive together without load."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, sqrt

from ltca.drive.parts import Drive
from ltca.drive.single_discs import single_discs

# Fits that are exact in the definition (r_i + 2 r_BR = r_o) must survive the rounding of their sum.
ROUNDING = 1e-9
"""Overlap that is the rounding of a sum, mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Interference:
    """Overlaps of the drawn parts with the disc in its nominal place, mm; negative where there is play.

    Attributes
    ----------
    pins : float
        Largest of wheel pins and flank over the mesh, the wheel at its ideal angle.
    rollers : float
        Of a roller and both races together, clearance included.
    holes : float
        Of shaft pins and holes, clearance included: all on the same side, against the eccentricity; −∞ without them.
    """

    pins: float
    rollers: float
    holes: float


def drawn_interference(drive: Drive) -> Interference:
    """Return how far the parts of a drive overlap, errors of single parts left out.

    Parameters
    ----------
    drive : Drive
        The drive; its flank without loops.

    Examples
    --------
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
    """Return which plays of a drive its warmth has taken, and by how much parts overlap then; empty where none is gone.

    Parameters
    ----------
    cold, warm : Drive
        At 20 °C and at temperature (`ltca.drive.members.temperatures.warm_drive`).
    """
    before, after = drawn_plays(cold), drawn_plays(warm)
    return [
        f"the play of {what} ({before[what]:.4g} mm at 20 °C) is gone: they overlap by {-after[what]:.4g} mm"
        for what in before
        if after[what] < 0.0 and after[what] < before[what] - ROUNDING
    ]


def _zero(value: float) -> float:
    return 0.0 if abs(value) <= ROUNDING else value


def drawn_plays(drive: Drive) -> dict[str, float]:
    """Return the least play of any disc, by what touches, discs in the middle of their eccentrics as these are.

    The circles of holes and shaft pins, and those of bores and several cranks, are as far apart as they are in the mean.

    Parameters
    ----------
    drive : Drive
        At one temperature.

    Returns
    -------
    dict of str to float
        mm, negative where parts overlap as drawn, without the rounding of sums.
    """
    found = {"wheel pins and flank": -inf, "rollers and races": -inf, "shaft pins and holes": -inf}
    for single in single_discs(drive):
        drawn, shaft = drawn_interference(single), single.pin_shaft
        error = single.crank.eccentricity_error
        pins, holes = drawn.pins + abs(error), drawn.holes + error
        rollers = drawn.rollers
        for own in single.disc.of:  # bores that stand farther out than the cranks press all bearings alike
            if own.bore_errors is not None and own.bore_errors.radial:
                rollers += abs(sum(own.bore_errors.radial) / len(own.bore_errors.radial))
        if shaft is not None and shaft.pin_errors.radial:
            radial = shaft.pin_errors.radial
            holes += abs(sum(radial) / len(radial))
        for what, overlap in zip(found, (pins, rollers, holes), strict=True):
            found[what] = max(found[what], overlap)
    return {what: _zero(-overlap) for what, overlap in found.items() if overlap > -inf}


def preload_warning(drive: Drive) -> str | None:
    """Return what to say of a drive whose parts overlap as drawn, None where none do.

    Parameters
    ----------
    drive : Drive
        The drive; errors of its single parts are not looked at.
    """
    discs = [drawn_interference(single) for single in single_discs(drive)]
    named = [
        f"{what} by {overlap:.4g} mm ({field})"
        for overlap, what, field in (
            (max(found.pins for found in discs), "wheel pins the flank", "disc.equidistant_offset"),
            (max(found.rollers for found in discs), "rollers the races", "crank_bearing.roller_radius"),
            (max(found.holes for found in discs), "shaft pins the holes", "pin_shaft.hole_radius"),
        )
        if overlap > ROUNDING
    ]
    if not named:
        return None
    return f"parts overlap as drawn: {', '.join(named)}; the drive is preloaded, its contacts carry without load"
