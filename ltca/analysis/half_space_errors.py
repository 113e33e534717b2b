"""How far half-spaces are off: measured against `hybrid` on the shipped drives, told of the one nearest to a drive.

Half-spaces take the contacts along and nothing beyond them. What that costs differs from drive to drive (thin walls, wide holes,
plastic), and only a hybrid analysis of the drive itself tells; of the nearest shipped drive it is known.
"""

from __future__ import annotations

import tomllib
from functools import cache
from math import log
from pathlib import Path
from typing import TYPE_CHECKING

from ltca.drive.parts import Drive

if TYPE_CHECKING:
    from ltca.analysis.engines import Engine

MEASURED = Path(__file__).with_suffix(".toml")
"""Ratios of half-space to hybrid, and what makes drives alike: ``python benchmarks/half_space_errors.py --write``."""
WORDS = {
    "stiffness": "torsional stiffness",
    "life": "life of the crank bearing",
    "pin_pressure": "largest flank pressure",
    "roller_pressure": "largest roller pressure",
    "transmission_error": "transmission error",
}


def likeness(drive: Drive) -> dict[str, float]:
    """Return what makes drives alike: cranks, loose pins, ratio, slenderness and stiffness of the disc."""
    return {
        "several_cranks": float(drive.crank.number > 1),
        "loose_pins": float(
            any(part is not None and part.seat.kind != "fixed" for part in (drive.pin_wheel, drive.pin_shaft))
        ),
        "teeth": float(drive.disc.number_of_teeth),
        "slenderness": drive.disc.thickness / drive.pin_wheel.pin_circle_radius,
        "youngs_modulus": drive.materials.disc.youngs_modulus,
    }


@cache
def measured() -> dict[str, dict[str, dict[str, float]]]:
    """Return the ratios that were measured, and the likeness, by shipped drive."""
    with MEASURED.open("rb") as stream:
        return tomllib.load(stream)


def nearest_shipped(drive: Drive) -> str:
    """Return the name of the shipped drive that a drive is nearest to.

    Examples
    --------
    >>> from ltca.reading.drive_file import load_drive
    >>> nearest_shipped(load_drive("paper").cases["CS-1"])
    'paper'
    """
    own = likeness(drive)

    def distance(other: dict[str, float]) -> float:
        kind = 4.0 * abs(own["several_cranks"] - other["several_cranks"]) + abs(own["loose_pins"] - other["loose_pins"])
        return kind + sum(abs(log(own[name] / other[name])) for name in ("teeth", "slenderness", "youngs_modulus"))

    return min(measured(), key=lambda name: distance(measured()[name]["likeness"]))


def half_space_words(engine: Engine, drive: Drive) -> str:
    """Return what to know of an analysis on half-spaces: why, and by how much they are off; nothing for another engine."""
    if engine.compliance != "half-space":
        return ""
    name = nearest_shipped(drive)
    why = "as [analysis] of the drive file says" if drive.analysis.compliance == "half-space" else "as asked"
    told = ", ".join(f"{WORDS[key]} {value:.2f}" for key, value in measured()[name]["ratio"].items())
    return (
        f"half-spaces, {why}: contacts yield, bodies beyond them do not; on {name}, the nearest shipped drive, they give "
        f"of what hybrid gives: {told}{_supports_of_bodies(drive)}"
    )


def _supports_of_bodies(drive: Drive) -> str:
    """What a drive says of the supports of its bodies, which half-spaces do not have."""
    given = {
        "pin_wheel.core_radius": drive.pin_wheel.core_radius,
        "crank_bearing.race_bore_radius": drive.crank_bearing.race_bore_radius,
    }
    told = ", ".join(f"{path} = {value:g} mm" for path, value in given.items() if value is not None)
    return f"; without effect on them: {told}" if told else ""
