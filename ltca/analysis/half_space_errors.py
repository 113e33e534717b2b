"""How far half-spaces are off: measured against `hybrid` on the shipped drives, reported for the most similar one.

Half-spaces yield at the contacts alone. The error differs from drive to drive (thin walls, wide holes, plastic, beams) and is
known for the shipped drives; of another drive only a hybrid analysis can say it.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from functools import cache
from math import log
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ltca.drive.fingerprints import fingerprint_of
from ltca.drive.parts import Drive
from ltca.output.case_texts import with_case_names

if TYPE_CHECKING:
    from ltca.analysis.engines import Engine

MEASURED = Path(__file__).with_suffix(".toml")
"""Ratios of half-space to hybrid, likeness and hash of the bodies: ``python benchmarks/half_space_errors.py --write``."""
LARGEST_DISTANCE = 1.0
"""Distance beyond which no shipped drive is similar: a modulus or a number of teeth of e times, say."""
OTHER_PART = 0.3
"""Distance of two drives for each kind of part that yields in one of them only: bending pins, ring, supports."""
WORDS = {
    "stiffness": "torsional stiffness",
    "life": "life of the crank bearing",
    "pin_pressure": "largest flank pressure",
    "roller_pressure": "largest roller pressure",
    "transmission_error": "transmission error",
}
SHAPES_AND_SUPPORTS = (
    "crank", "pin_wheel", "disc", "crank_bearing", "pin_shaft", "ring", "carrier", "first_stage", "main_bearing", "installation",
    "temperature",
)  # fmt: skip
"""Parts of a drive that hold its shape and all that yields; clearances and loads are not among them."""


def likeness(drive: Drive) -> dict[str, float]:
    """Return the numbers that the similarity of drives is judged by: cranks, pins, supports, ratio, slenderness, modulus."""
    pins = [part for part in (drive.pin_wheel, drive.pin_shaft) if part is not None]
    return {
        "several_cranks": float(drive.crank.number > 1),
        "loose_pins": float(any(part.seat.kind != "fixed" for part in pins)),
        "wheel_pin_beams": float(drive.pin_wheel.beam is not None),
        "shaft_pin_beams": float(drive.pin_shaft is not None and drive.pin_shaft.beam is not None),
        "ring": float(drive.ring is not None),
        "crank_supports": float(drive.crank.support is not None),
        "carrier": float(drive.carrier is not None),
        "main_bearing": float(drive.wheel_yields),
        "teeth": float(drive.disc.number_of_teeth),
        "slenderness": drive.disc.thickness / drive.pin_wheel.pin_circle_radius,
        "youngs_modulus": drive.materials.disc.youngs_modulus,
    }


def body_fingerprint(drive: Drive) -> str:
    """Return a hash of shape, supports and elastic constants of all parts, whatever loads, clearances and limits are."""
    content: dict[str, Any] = {
        name: fingerprint_of(part) for name in SHAPES_AND_SUPPORTS if (part := getattr(drive, name)) is not None
    }
    materials = drive.body_materials
    for name in ("disc", "wheel_pin", "roller", "inner_race", "shaft_pin"):
        material = getattr(materials, name)
        content[f"materials.{name}"] = material.youngs_modulus, material.poisson_ratio
    return fingerprint_of(content)


@cache
def measured() -> dict[str, dict[str, Any]]:
    """Return ratios, likeness and `body_fingerprint` of each shipped drive."""
    with MEASURED.open("rb") as stream:
        return tomllib.load(stream)


def nearest_shipped(drive: Drive) -> tuple[str, float]:
    """Return the name of the shipped drive that a drive is most similar to, and their distance.

    Examples
    --------
    >>> from ltca.reading.drive_file import load_drive
    >>> name, distance = nearest_shipped(load_drive("paper").cases["CS-1"])
    >>> name, distance < 1e-5
    ('paper', True)
    """
    numbers = likeness(drive)

    def distance(other: Mapping[str, float]) -> float:
        differences = {name: abs(value - other[name]) for name, value in numbers.items()}
        kind = 4.0 * differences["several_cranks"] + differences["loose_pins"]
        kinds = ("wheel_pin_beams", "shaft_pin_beams", "ring", "crank_supports", "carrier", "main_bearing")
        parts = OTHER_PART * sum(differences[name] for name in kinds)
        sizes = sum(abs(log(numbers[name] / other[name])) for name in ("teeth", "slenderness", "youngs_modulus"))
        return kind + parts + sizes

    distances = {name: distance(entry["likeness"]) for name, entry in measured().items()}
    nearest = min(distances, key=distances.__getitem__)
    return nearest, distances[nearest]


def _similar_shipped(drive: Drive) -> tuple[dict[str, float], str, bool] | None:
    """Ratios and name of the most similar shipped drive, and whether its bodies are the same; None where none is similar."""
    name, distance = nearest_shipped(drive)
    if distance > LARGEST_DISTANCE:
        return None
    entry = measured()[name]
    return entry["ratio"], name, entry["bodies"] == body_fingerprint(drive)


def _deviation(ratio: float, more: str = "too large", less: str = "too small") -> str:
    """A ratio as a deviation with its direction."""
    percent = 100.0 * (ratio - 1.0)
    return "within 1 %" if abs(percent) < 1.0 else f"{abs(percent):.0f} % {more if percent > 0.0 else less}"


def half_space_caution(engine: Engine, drive: Drive) -> str:
    """Return the measured error of half-spaces in torsion in a few words; empty for another engine.

    Examples
    --------
    >>> from ltca.analysis.engines import HalfSpace
    >>> from ltca.reading.drive_file import load_drive
    >>> half_space_caution(HalfSpace(), load_drive("paper").cases["CS-1"])
    'half-spaces: about 34 % too stiff here (measured on the shipped drive paper)'
    """
    if engine.compliance != "half-space":
        return ""
    if (shipped := _similar_shipped(drive)) is None:
        return (
            "half-spaces: bodies beyond the contacts do not yield; no shipped drive is similar enough to say the error"
        )
    ratio, name, same = shipped
    error = _deviation(ratio["stiffness"], "too stiff", "too soft")
    if error.startswith("within"):
        error = f"stiffness {error}, transmission error about {_deviation(ratio['transmission_error'])}"
    else:
        error = f"about {error}"
    if same:
        return f"half-spaces: {error} here (measured on the shipped drive {name})"
    return f"half-spaces: {error}, as on the most similar shipped drive {name}; not measured on this one"


def half_space_cautions(engine: Engine, cases: Mapping[str, Drive]) -> list[str]:
    """Return the cautions on half-spaces of all cases, each once with the names of its cases."""
    texts = {name: half_space_caution(engine, drive) for name, drive in cases.items()}
    return with_case_names({name: [text] if text else [] for name, text in texts.items()})


def half_space_words(engine: Engine, drive: Drive) -> str:
    """Return the reason for half-spaces, and their measured errors; empty for another engine."""
    if engine.compliance != "half-space":
        return ""
    told = drive.analysis.compliance == "half-space"
    why = "as [analysis] of the drive file says" if told else "as asked"
    if told and getattr(engine, "asked", False):
        why = "as asked; without that [analysis] of the drive file says the same"
    errors = "the error is not known, no shipped drive is similar"
    if (shipped := _similar_shipped(drive)) is not None:
        ratio, name, same = shipped
        where = f"measured on the {'' if same else 'most similar '}shipped drive {name}"
        where += "" if same else ", not on this one"
        errors = (
            f"against hybrid, {where}: {', '.join(f'{WORDS[key]} {_deviation(one)}' for key, one in ratio.items())}"
        )
    return f"half-spaces, {why}: contacts yield, bodies beyond them do not; {errors}{_supports_of_bodies(drive)}"


def half_space_notes(engine: Engine, cases: Mapping[str, Drive]) -> list[str]:
    """Return `half_space_words` of all cases, each once with the names of its cases."""
    texts = {name: half_space_words(engine, drive) for name, drive in cases.items()}
    return with_case_names({name: [text] if text else [] for name, text in texts.items()})


def _supports_of_bodies(drive: Drive) -> str:
    """Fields on the supports of bodies, which have no effect on half-spaces."""
    fields = {
        "pin_wheel.core_radius": drive.pin_wheel.core_radius,
        "crank_bearing.race_bore_radius": drive.crank_bearing.race_bore_radius,
    }
    words = ", ".join(f"{path} = {value:g} mm" for path, value in fields.items() if value is not None)
    return f"; without effect on them: {words}" if words else ""
