"""Margins of the shape: undercut, hollow against pin, walls, gaps between rollers; mm, negative where there is none."""

from __future__ import annotations

from collections.abc import Iterator
from math import inf, pi, sin

import numpy as np

from ltca.drive.parts import Drive
from ltca.geometry.flank import FlankProfile

SAMPLES = 2001
"""Places on a lobe at which its curvature is looked at."""


def undercut_margin(single: Drive) -> float:
    """Return by how much a pin might be larger before the flank of a drive of one disc is undercut."""
    _, locus = _curvatures(single)
    return 1.0 / locus - (single.pin_wheel.pin_radius + single.disc.equidistant_offset)


def pin_hollow_margin(single: Drive) -> float:
    """Return by how much the sharpest hollow of the flank is rounder than the pin; infinite without a hollow."""
    hollow, _ = _curvatures(single)
    return inf if hollow >= 0.0 else -1.0 / hollow - single.pin_wheel.pin_radius


def _curvatures(single: Drive) -> tuple[float, float]:
    """Of the flank where it is most hollow, and of the path of the pins' centres where it is sharpest, 1/mm."""
    profile = FlankProfile.of_drive(single)
    parameter = np.linspace(0.0, 2.0 * pi / single.reduction_ratio, SAMPLES)
    return float(profile.curvature(parameter).min()), float(profile.locus(parameter).curvature.max())


def roller_gap(drive: Drive) -> float:
    """Return the gap between neighbouring rollers of a crank bearing."""
    bearing = drive.crank_bearing
    pitch = bearing.inner_race_radius + bearing.roller_radius
    return 2.0 * (pitch * sin(pi / bearing.number_of_rollers) - bearing.roller_radius)


def walls(single: Drive) -> Iterator[tuple[str, float]]:
    """Yield what is left between holes, bores, roots, slots and in sleeves of a drive of one disc, by name."""
    shaft, crank, wheel = single.pin_shaft, single.crank, single.pin_wheel
    root, bore, bores = FlankProfile.of_drive(single).root_radius, single.bore_radius, np.array(single.crank.places)
    if shaft is not None:
        circle, radius = shaft.pin_circle_radius, single.hole_radius
        holes = circle * np.exp(2j * pi * np.arange(shaft.number_of_pins) / shaft.number_of_pins)
        yield "between hole and root circle", root - circle - radius
        yield "between hole and bore", float(np.min(np.abs(holes[:, None] - bores))) - radius - bore
        yield "between neighbouring holes", 2.0 * (circle * sin(pi / shaft.number_of_pins) - radius)
    if crank.number > 1:
        circle = float(np.abs(bores[0]))
        yield "between bore and root circle", root - circle - bore
        yield "between neighbouring bores", 2.0 * (circle * sin(pi / crank.number) - bore)
    else:
        yield "between bore and root circle", root - bore
    yield (
        "between neighbouring wheel pins",
        2.0 * (wheel.pin_circle_radius * sin(pi / wheel.number_of_pins) - _outside(single)),
    )
    if single.ring is not None:
        yield "of the ring behind the wheel pins", single.ring.outer_radius - wheel.pin_circle_radius - _outside(single)
    for name, part in (("wheel", wheel), ("shaft", shaft)):
        if part is not None and part.seat.kind == "sleeve":
            yield f"of the sleeves on {name} pins", part.pin_radius - (part.seat.bore_radius or 0.0)


def _outside(single: Drive) -> float:
    """Radius of what stands beside its neighbours on the wheel: slots, or pins."""
    seat = single.pin_wheel.seat
    return (seat.radius or 0.0) if seat.kind == "slot" else single.pin_wheel.pin_radius
