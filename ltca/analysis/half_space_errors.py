"""How far half-spaces are off: measured against `hybrid` on all cases of the shipped drives.

Half-spaces yield at the contacts alone, so that every drive is too stiff on them. By how much differs from drive to drive (thin
walls, wide holes, plastic, beams), and with load and clearances. What was measured is said of the drive, load and clearances that
it was measured with, and of nothing else: of another drive the stiffness of the most similar shipped drive is given as that
drive's, and no figure of pressures, life and transmission error, which are off either way.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cache
from math import log
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ltca.drive.fingerprints import fingerprint_of
from ltca.drive.members.operation import Analysis
from ltca.drive.parts import Drive
from ltca.output.case_texts import with_case_names

if TYPE_CHECKING:
    from ltca.analysis.engines import Engine

MEASURED = Path(__file__).with_suffix(".toml")
"""Likeness of each shipped drive, ratios of half-space to hybrid by case: ``python benchmarks/half_space_errors.py --write``."""
LARGEST_DISTANCE = 1.0
"""Distance beyond which no shipped drive is similar: a modulus or a number of teeth of e times, say."""
OTHER_PART = 0.3
"""Distance of two drives for each kind of part that yields in one of them only: bending pins, ring, supports."""
WHERE = "at 50 … 100 % of the torque"
"""Torques between which the stiffness was measured; from the light torque on it is off by more, 38 for 31 % of `paper` CS-6."""
WORDS = {
    "stiffness": f"torsional stiffness {WHERE}",
    "life": "life of the crank bearing",
    "pin_pressure": "largest flank pressure",
    "roller_pressure": "largest roller pressure",
    "transmission_error": "transmission error",
}
EITHER_WAY = (
    "pressures and life may be off either way by tens of per cent, the transmission error by a factor of two or three"
)
"""Errors on drives that nothing was measured on; of those measured, 13 % too small and 22 % too large, 2.7 times either way."""


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


def measured_with(drive: Drive) -> str:
    """Return a hash of all that the errors depend on: the drive with its load and clearances, whatever its name and engine."""
    return fingerprint_of(replace(drive, name="drive", analysis=Analysis(), inertia=None, damping=None))


@cache
def measured() -> dict[str, dict[str, Any]]:
    """Return likeness and cases of each shipped drive; of each case ``ratio`` and `measured_with`."""
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


@dataclass(frozen=True, slots=True, kw_only=True)
class _Shipped:
    """Shipped drive that the errors of a drive are known by.

    Attributes
    ----------
    name : str
        Name of the shipped drive.
    case : str
        Case of it that the drive is, load and clearances included, "cases" of several; empty where it is only similar.
    ratios : tuple of dict
        Ratios of half-space to hybrid: of these cases, or of all cases of a similar drive.
    """

    name: str
    case: str
    ratios: tuple[dict[str, float], ...]

    @property
    def words(self) -> str:
        """The shipped drive, and which case where it has several and one is meant."""
        one_of_several = len(self.ratios) == 1 and len(measured()[self.name]["cases"]) > 1
        return f"the shipped drive {self.name}{f', case {self.case}' if one_of_several else ''}"


def at_torque(drive: Drive, torque: float) -> Drive:
    """Return a drive whose load has the torque of an analysis, N·mm."""
    return drive if torque == drive.load.torque else replace(drive, load=replace(drive.load, torque=torque))


def _shipped(drive: Drive) -> _Shipped | None:
    """Shipped drive that a drive is, or is most similar to; None where none is similar."""
    whole = measured_with(drive)
    for name, entry in measured().items():
        for case, one in entry["cases"].items():
            if one["measured_with"] == whole:
                return _Shipped(name=name, case=case, ratios=(one["ratio"],))
    name, distance = nearest_shipped(drive)
    if distance > LARGEST_DISTANCE:
        return None
    return _Shipped(name=name, case="", ratios=tuple(one["ratio"] for one in measured()[name]["cases"].values()))


def _shipped_of_cases(cases: Mapping[str, Drive]) -> dict[str, _Shipped | None]:
    """The same of several cases; cases that are cases of one shipped drive have it in common, with the ratios of all of them."""
    every = {name: _shipped(drive) for name, drive in cases.items()}
    together: dict[str, list[_Shipped]] = {}
    for one in every.values():
        if one is not None and one.case and one not in together.setdefault(one.name, []):
            together[one.name].append(one)
    joined = {
        name: parts[0]
        if len(parts) == 1
        else replace(parts[0], case="cases", ratios=tuple(ratio for part in parts for ratio in part.ratios))
        for name, parts in together.items()
    }
    return {name: joined[one.name] if one is not None and one.case else one for name, one in every.items()}


def _deviation(ratios: Iterable[float], more: str = "too large", less: str = "too small") -> str:
    """Ratios of several cases as a deviation with its direction, as a range where they differ."""
    percents = [100.0 * (ratio - 1.0) for ratio in ratios]
    low, high = min(percents), max(percents)
    if max(abs(low), abs(high)) < 1.0:
        return "within 1 %"
    if low < 0.0 < high:
        return f"{-low:.0f} % {less} … {high:.0f} % {more}"
    sizes = dict.fromkeys(f"{size:.0f}" for size in sorted((abs(low), abs(high))))
    return f"{' … '.join(sizes)} % {more if high > 0.0 else less}"


def _measured_caution(shipped: _Shipped) -> str:
    """Error of cases of a shipped drive in torsion."""
    error = _deviation((ratio["stiffness"] for ratio in shipped.ratios), "too stiff", "too soft")
    if error.startswith("within"):
        other = _deviation(ratio["transmission_error"] for ratio in shipped.ratios)
        return f"half-spaces: stiffness {error}, transmission error about {other} here (measured on {shipped.words})"
    return f"half-spaces: about {error} here (measured on {shipped.words}, {WHERE})"


def _stiffness_of_similar(shipped: _Shipped) -> str:
    """Error in torsion of a shipped drive, told of a drive that is similar."""
    error = _deviation((ratio["stiffness"] for ratio in shipped.ratios), "", "")
    error = "less than 1 %" if error.startswith("within") else error.strip()
    return f"by {error} on the most similar shipped drive {shipped.name}; not measured on this one"


def half_space_caution(engine: Engine, drive: Drive) -> str:
    """Return what is known of the errors of half-spaces in a few words; empty for another engine.

    Examples
    --------
    >>> from ltca.analysis.engines import HalfSpace
    >>> from ltca.reading.drive_file import load_drive
    >>> half_space_caution(HalfSpace(), load_drive("paper").cases["CS-1"])
    'half-spaces: about 34 % too stiff here (measured on the shipped drive paper, case CS-1, at 50 … 100 % of the torque)'
    """
    return "; ".join(half_space_cautions(engine, {drive.case: drive}))


def half_space_cautions(engine: Engine, cases: Mapping[str, Drive]) -> list[str]:
    """Return the cautions on half-spaces of all cases, each once with the names of its cases."""
    if engine.compliance != "half-space":
        return []
    texts = {}
    for name, shipped in _shipped_of_cases(cases).items():
        if shipped is None:
            texts[name] = (
                "half-spaces: too stiff, as bodies beyond the contacts do not yield; by how much is not known, no shipped "
                f"drive is similar; {EITHER_WAY}"
            )
        elif shipped.case:
            texts[name] = _measured_caution(shipped)
        else:
            texts[name] = f"half-spaces: too stiff, {_stiffness_of_similar(shipped)}; {EITHER_WAY}"
    return with_case_names({name: [text] for name, text in texts.items()})


def half_space_words(engine: Engine, drive: Drive) -> str:
    """Return the reason for half-spaces, and their errors; empty for another engine."""
    return "; ".join(half_space_notes(engine, {drive.case: drive}))


def half_space_notes(engine: Engine, cases: Mapping[str, Drive]) -> list[str]:
    """Return `half_space_words` of all cases, each once with the names of its cases."""
    if engine.compliance != "half-space":
        return []
    shipped = _shipped_of_cases(cases)
    return with_case_names({name: [_words(engine, drive, shipped[name])] for name, drive in cases.items()})


def _words(engine: Engine, drive: Drive, shipped: _Shipped | None) -> str:
    by_file = drive.analysis.compliance == "half-space"
    why = "as [analysis] of the drive file says" if by_file else "as asked"
    if by_file and getattr(engine, "asked", False):
        why = "as asked; without that [analysis] of the drive file says the same"
    if shipped is None:
        errors = f"too stiff, by how much is not known, no shipped drive is similar; {EITHER_WAY}"
    elif shipped.case:
        errors = f"against hybrid, measured on {shipped.words}: "
        errors += ", ".join(
            f"{words} {_deviation(ratio[key] for ratio in shipped.ratios)}"
            for key, words in WORDS.items()
            if all(key in ratio for ratio in shipped.ratios)
        )
    else:
        errors = f"against hybrid too stiff, {_stiffness_of_similar(shipped)}; {EITHER_WAY}"
    return f"half-spaces, {why}: contacts yield, bodies beyond them do not; {errors}{_supports_of_bodies(drive)}"


def _supports_of_bodies(drive: Drive) -> str:
    """Fields on the supports of bodies, which have no effect on half-spaces."""
    fields = {
        "pin_wheel.core_radius": drive.pin_wheel.core_radius,
        "crank_bearing.race_bore_radius": drive.crank_bearing.race_bore_radius,
    }
    words = ", ".join(f"{path} = {value:g} mm" for path, value in fields.items() if value is not None)
    return f"; without effect on them: {words}" if words else ""
