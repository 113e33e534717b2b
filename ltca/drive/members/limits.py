"""``[limits]`` of a drive file: bounds on results, by the names of the summary, each with its source.

Like tolerances, limits are no part of a drive: they change no load, results are judged by them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pydantic_core import PydanticCustomError

from ltca.drive.units.quantities import QuantityCheck
from ltca.drive.units.table import label
from ltca.errors import did_you_mean, printable, shortened
from ltca.quantities import LIMITED

SENSES = ("max", "min")


@dataclass(frozen=True, slots=True, kw_only=True)
class Limit:
    """A bound on a quantity.

    Attributes
    ----------
    quantity : str
        One of `ltca.quantities.LIMITED`.
    sense : {"max", "min"}
        Upper or lower bound.
    value : float
        In the unit of the quantity.
    source : str
        Origin of the bound.
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
    """Return the limits of a drive file by `Limit.key`; mistakes are appended to `problems`, one sentence each.

    Keys are ``max_…`` and ``min_…`` with the names of `ltca.quantities.LIMITED`, also with the unit of the summary behind
    them; values are numbers in the unit of the summary, texts with a unit, or tables of value and source.

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
        sense, name = str(key).partition("_")[0], limited_quantity(str(key))
        if name is None:
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
        unit = LIMITED[name].unit
        try:
            number = _quantity(name, sense)(value)
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


def limited_quantity(key: str) -> str | None:
    """Return the quantity that a key of the table limits, one of `ltca.quantities.LIMITED`; None for no limit.

    Examples
    --------
    >>> limited_quantity("max_pin_pressure_mid_MPa"), limited_quantity("most_pin_pressure_mid")
    ('pin_pressure_mid', None)
    """
    sense, _, name = key.partition("_")
    name = _without_unit(name)
    return name if sense in SENSES and name in LIMITED else None


def _without_unit(name: str) -> str:
    """The name of a quantity that is given with or without the unit of its key in the summary."""
    return next((known for known, scalar in LIMITED.items() if name == scalar.key.removeprefix("max_")), name)


def _quantity(name: str, sense: str) -> QuantityCheck:
    """Check of the value of a limit: no pressure or stress under load is at most 0."""
    scalar = LIMITED[name]
    least, most = scalar.limit or (None, None)
    positive = sense == "max" and scalar.unit == "MPa"
    bounds = (
        ("greater than", 0.0 if positive else None),
        ("at least", None if positive else least),
        ("less than", None),
        ("at most", most),
    )
    return QuantityCheck(unit="dimensionless" if scalar.unit == "1" else scalar.unit, bounds=bounds, divides=True)
