"""``[limits]`` of a drive file: what its results may reach, by the names of the summary, each with its source.

Limits are no part of a drive, as tolerances are not: they move no load and judge what loads do.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pydantic_core import PydanticCustomError

from ltca.drive.units.quantities import QuantityCheck
from ltca.drive.units.table import label
from ltca.errors import did_you_mean, printable, shortened

LIMITED: dict[str, str] = {
    "carried_torque": "1",
    "undercut_margin": "mm",
    "wall": "mm",
    "pin_hollow_margin": "mm",
    "roller_gap": "mm",
    "interference": "mm",
    "mean_loaded_pins": "1",
    "backlash_disc": "arcmin",
    "backlash_wheel": "arcmin",
    "backlash_output": "arcmin",
    "ptp_transmission_error": "arcsec",
    "pin_load": "N",
    "roller_load": "N",
    "pin_shaft_load": "N",
    "bearing_load": "N",
    "pin_pressure_mid": "MPa",
    "pin_shaft_pressure_mid": "MPa",
    "roller_pressure_mid": "MPa",
    "roller_pressure_mid_outer": "MPa",
    "roller_pressure_mid_inner": "MPa",
    "pin_seat_pressure": "MPa",
    "hole_seat_pressure": "MPa",
    "disc_shear": "MPa",
    "shear_depth": "mm",
    "core_shear": "MPa",
    "wheel_pin_bending_stress": "MPa",
    "wheel_pin_bending_amplitude": "MPa",
    "wheel_pin_shear_stress": "MPa",
    "shaft_pin_bending_stress": "MPa",
    "shaft_pin_bending_amplitude": "MPa",
    "shaft_pin_shear_stress": "MPa",
    "root_stress": "MPa",
    "bore_stress": "MPa",
    "hole_stress": "MPa",
    "bearing_life_hours": "h",
    "bearing_life_modified_hours": "h",
    "bearing_life_million_turns": "1",
    "static_safety_S0": "1",
    "mean_efficiency": "1",
    "mean_efficiency_back": "1",
    "moves_back": "1",
    "power_loss": "W",
    "pin_pv": "MPa m/s",
    "pin_shaft_pv": "MPa m/s",
    "pin_seat_pv": "MPa m/s",
    "hole_seat_pv": "MPa m/s",
    "half_width_ratio": "1",
    "contact_strain": "1",
    "distinct_mesh_phases": "1",
    "pin_deflection": "mm",
    "shaft_pin_deflection": "mm",
    "play_at_temperature": "mm",
    "bearing_deflection": "mm",
    "bearing_deflection_by_clearance": "1",
    "crank_deflection": "mm",
    "crank_deflection_by_clearance": "1",
    "wheel_deflection": "mm",
    "wheel_deflection_by_clearance": "1",
}
"""Quantities that may be limited, named as in the summary without ``max_`` and unit, and their units there."""
SUFFIXES = {"MPa": "MPa", "N": "N", "mm": "mm", "arcmin": "arcmin", "arcsec": "arcsec", "W": "W", "MPa_m_s": "MPa m/s"}
"""Units as they end the keys of the summary."""
SENSES = ("max", "min")
MARGINS = ("undercut_margin", "wall", "pin_hollow_margin", "roller_gap", "play_at_temperature", "mean_efficiency_back")
"""Quantities that may be less than nothing; limits of others are at least 0."""
PARTS_OF_ONE = ("carried_torque", "mean_efficiency", "mean_efficiency_back", "moves_back")
"""Quantities that are at most 1."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Limit:
    """What a quantity may reach.

    Attributes
    ----------
    quantity : str
        One of `LIMITED`.
    sense : {"max", "min"}
        Whether it is the most or the least.
    value : float
        In the unit of `LIMITED`.
    source : str
        Where it comes from.
    """

    quantity: str
    sense: str
    value: float
    source: str

    @property
    def key(self) -> str:
        """Name in the drive file."""
        return f"{self.sense}_{self.quantity}"


Limits = dict[str, Limit]
"""By `Limit.key`."""


def parse_limits(table: Any, problems: list[str], where: str = "limits") -> Limits:
    """Return the limits of a drive file.

    Parameters
    ----------
    table : mapping
        ``max_…`` and ``min_…`` with the names of `LIMITED`, also with the unit of the summary behind them; a number in the
        unit of the summary, a text with a unit, or a table of value and source.
    problems : list of str
        Takes what is wrong, one sentence each.
    where : str
        Name of the table, for messages.

    Examples
    --------
    >>> found = parse_limits({"max_pin_pressure_mid": {"value": "1.5 GPa", "source": "ISO 6336-5"}}, [])
    >>> found["max_pin_pressure_mid"].value
    1500.0
    """
    found: Limits = {}
    if not isinstance(table, Mapping):
        problems.append(f"{where} = {shortened(table)}: must be a table of max_… and min_…")
        return found
    for key, entry in table.items():
        path = f"{where}.{printable(str(key))}"
        sense, _, name = str(key).partition("_")
        name = _without_unit(name)
        if sense not in SENSES or name not in LIMITED:
            known = [f"{one}_{quantity}" for quantity in LIMITED for one in SENSES]
            problems.append(
                f"{path}: is no limit; limits are max_… or min_… of a quantity{did_you_mean(str(key), known)}"
            )
            continue
        value, source = entry, f"[{where}], no source given"
        if isinstance(entry, Mapping):
            if not {"value"} <= set(entry) <= {"value", "source"} or not isinstance(entry.get("source", ""), str):
                problems.append(f"{path}: must be a number, a text with a unit, or a table of value and source")
                continue
            value, source = entry["value"], entry.get("source") or source
        unit = LIMITED[name]
        try:
            number = _quantity(name)(value)
        except PydanticCustomError as error:
            told = error.message()
            beside = f" ({label(unit)})" if unit != "1" and label(unit) not in told else ""
            problems.append(f"{path} = {shortened(value)}: {told}{beside}")
            continue
        limit = Limit(quantity=name, sense=sense, value=number, source=source)
        if limit.key in found:
            problems.append(f"{path}: is given twice, with and without its unit")
        found[limit.key] = limit
    for quantity in dict.fromkeys(limit.quantity for limit in found.values()):
        least, most = found.get(f"min_{quantity}"), found.get(f"max_{quantity}")
        if least is not None and most is not None and least.value > most.value:
            problems.append(
                f"{where}.{least.key} = {least.value:g}: must be at most {most.value:g}, {where}.{most.key}"
            )
    return found


def _without_unit(name: str) -> str:
    for suffix in SUFFIXES:
        bare = name.removesuffix(f"_{suffix}")
        if bare != name and LIMITED.get(bare) == SUFFIXES[suffix]:
            return bare
    return name


def _quantity(name: str) -> QuantityCheck:
    unit = LIMITED[name]
    bounds = (
        ("greater than", None),
        ("at least", None if name in MARGINS else 0.0),
        ("less than", None),
        ("at most", 1.0 if name in PARTS_OF_ONE else None),
    )
    return QuantityCheck(unit="dimensionless" if unit == "1" else unit, bounds=bounds)
