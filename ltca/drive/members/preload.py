"""Preload of bearings, and the quantities that say how bearings yield."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import model_validator
from pydantic.dataclasses import dataclass
from pydantic_core import ArgsKwargs

from ltca.drive.deviations import STRICT, PositiveLength
from ltca.drive.units.quantities import quantity
from ltca.drive.units.table import UNITS, read_text_unit

Stiffness = Annotated[float, quantity("N/mm", gt=0.0)]
Force = Annotated[float, quantity("N", gt=0.0)]
LoadConstant = Annotated[float, quantity("N/mmⁿ", gt=0.0)]


def preload_table(value: Any) -> Any:
    """Return a preload given as a number or text as a table: lengths are displacements, everything else forces.

    Examples
    --------
    >>> preload_table("5 µm"), preload_table(800.0)
    ({'displacement': '5 µm'}, {'force': 800.0})
    """
    if value is None or isinstance(value, dict | ArgsKwargs | Preload):
        return value
    is_length = isinstance(value, str) and read_text_unit(value) in UNITS["length"]
    return {"displacement" if is_length else "force": value}


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class Preload:
    """Preload of a bearing, as a force or as a displacement; in a file simply ``preload = "500 N"`` or ``"5 µm"``.

    Attributes
    ----------
    force : float or None
        Force with which its opposite sides press each other, N.
    displacement : float or None
        Displacement by which each side is pressed in, mm.
    """

    force: Force | None = None
    displacement: PositiveLength | None = None

    @model_validator(mode="before")
    @classmethod
    def _of_text(cls, value: Any) -> Any:
        return preload_table(value)
