"""How far half-spaces are off: measured against `hybrid` on the shipped drives, reported for the most similar one.

Half-spaces take the contacts along and nothing beyond them. What that costs differs from drive to drive (thin walls, wide holes,
plastic), and only a hybrid analysis of the drive itself tells; for the shipped drives it is known.
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
SAME = 1e-5
"""Distance of two drives up to which they have the same disc: what is measured is kept to six digits."""
FAR = 1.0
"""Distance beyond which no shipped drive says how far off half-spaces are: a modulus or a number of teeth of e times, say."""
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


def nearest_shipped(drive: Drive) -> tuple[str, float]:
    """Return the name of the shipped drive that a drive is most similar to, and how far apart they are, 0 for the same disc.

    Examples
    --------
    >>> from ltca.reading.drive_file import load_drive
    >>> name, distance = nearest_shipped(load_drive("paper").cases["CS-1"])
    >>> name, distance < SAME
    ('paper', True)
    """
    own = likeness(drive)

    def distance(other: dict[str, float]) -> float:
        kind = 4.0 * abs(own["several_cranks"] - other["several_cranks"]) + abs(own["loose_pins"] - other["loose_pins"])
        return kind + sum(abs(log(own[name] / other[name])) for name in ("teeth", "slenderness", "youngs_modulus"))

    distances = {name: distance(of["likeness"]) for name, of in measured().items()}
    nearest = min(distances, key=distances.__getitem__)
    return nearest, distances[nearest]


def _measured_on(drive: Drive) -> tuple[dict[str, float], str] | None:
    """Ratios for a drive, and where they were measured; None where no shipped drive is similar."""
    name, distance = nearest_shipped(drive)
    if distance > FAR:
        return None
    same = distance < SAME
    return measured()[name]["ratio"], f"measured on the {'' if same else 'most similar '}shipped drive {name}"


def _off(ratio: float, more: str = "too large", less: str = "too small") -> str:
    """A ratio as a deviation with its direction."""
    percent = 100.0 * (ratio - 1.0)
    return "within 1 %" if abs(percent) < 1.0 else f"{abs(percent):.0f} % {more if percent > 0.0 else less}"


def half_space_caution(engine: Engine, drive: Drive) -> str:
    """Return by how much half-spaces are off in torsion, and in which direction, in a few words; empty for another engine.

    Examples
    --------
    >>> from ltca.analysis.engines import HalfSpace
    >>> from ltca.reading.drive_file import load_drive
    >>> half_space_caution(HalfSpace(), load_drive("paper").cases["CS-1"])
    'half-spaces: about 34 % too stiff here (measured on the shipped drive paper)'
    """
    if engine.compliance != "half-space":
        return ""
    if (found := _measured_on(drive)) is None:
        return "half-spaces: too stiff here; no shipped drive is similar enough to say by how much"
    ratio, where = found
    stiff = _off(ratio["stiffness"], "too stiff", "too soft")
    if stiff.startswith("within"):
        stiff = f"stiffness {stiff}, transmission error about {_off(ratio['transmission_error'])}"
        return f"half-spaces: {stiff} here ({where})"
    return f"half-spaces: about {stiff} here ({where})"


def half_space_words(engine: Engine, drive: Drive) -> str:
    """Return what to know of an analysis on half-spaces: why, and by how much they are off; nothing for another engine."""
    if engine.compliance != "half-space":
        return ""
    found = _measured_on(drive)
    why = "as [analysis] of the drive file says" if drive.analysis.compliance == "half-space" else "as asked"
    told = "how far off they are is not known, no shipped drive is similar"
    if found is not None:
        ratio, where = found
        told = f"against hybrid, {where}: {', '.join(f'{WORDS[key]} {_off(value)}' for key, value in ratio.items())}"
    return f"half-spaces, {why}: contacts yield, bodies beyond them do not; {told}{_supports_of_bodies(drive)}"


def _supports_of_bodies(drive: Drive) -> str:
    """What a drive says of the supports of its bodies, which half-spaces do not have."""
    given = {
        "pin_wheel.core_radius": drive.pin_wheel.core_radius,
        "crank_bearing.race_bore_radius": drive.crank_bearing.race_bore_radius,
    }
    told = ", ".join(f"{path} = {value:g} mm" for path, value in given.items() if value is not None)
    return f"; without effect on them: {told}" if told else ""
