"""Demands on a candidate as margins: of the requirements, of the parts, of limits and materials.

A margin is the logarithm of limit by value (value by limit where more is wanted), of losses for efficiencies, and what is to
spare in a size of the drive for walls and gaps. A candidate that keeps all of them has none below zero.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import log
from typing import Literal

import numpy as np

from ltca.analysis.life.ratings import not_rated
from ltca.analysis.verdict.values import DEMANDED
from ltca.arrays import FloatArray
from ltca.drive.members.judgement import ANYWHERE, Value, judge
from ltca.drive.members.limits import Limit, Limits
from ltca.drive.units.quantities import ARCMIN
from ltca.drive.units.table import label
from ltca.quantities import LIMITED, SCALARS, Scalar
from ltca.studies.design_search.requirements import Requirements
from ltca.studies.design_search.sizes import prototype

Kind = Literal["requirement", "limit", "material", "shape", "clearance", "share"]

ROLLERS = "ISO 76:2006, roller bearings at their static load rating"
ROLLER_PRESSURE = 4000.0
"""What hardened rollers and races bear without a lasting mark, MPa."""
SAFETY = 0.02
"""By which part demands are kept in the search: a fine solution finds larger peaks than a coarse one."""
LEAST_DISC_SHARE = 0.5
"""Part of an even share of the torque that each of several discs carries at least, as the mean over a turn."""
TIGHTENED = ("equidistant_offset", "bearing_clearance", "pin_hole_clearance")
"""Clearances whose least is a demand: what needs less of them is asked of the shop, and may stand in the way."""
CHANGE_WEIGHT = {"outer_diameter": 2.0, **dict.fromkeys(TIGHTENED, 0.5)}
"""Weight of the logarithm of a factor in what a relaxation changes, 1 for all others: with the diameter the volume grows by its
square; a finer clearance is finer work on one joint, and nothing that was asked of the drive."""
OF_MATERIALS = (
    "pin_pressure_mid", "pin_shaft_pressure_mid", "roller_pressure_mid_outer", "roller_pressure_mid_inner",
    "shaft_pin_bending_stress", "shaft_pin_bending_amplitude", "shaft_pin_shear_stress", "half_width_ratio",
)  # fmt: skip
OF_SHAPE = (
    "undercut_margin", "pin_hollow_margin", "pin_gap", "pin_size", "pin_slenderness", "wall", "cage_room",
    "bearing_proportion", "race", "roller_room", "flank_clearance", "ring_seat",
)  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class Demand:
    """One demand.

    Attributes
    ----------
    name : str
        Key of the requirement file, or of its ``[limits]``; the quantity for others.
    quantity : str
        Of `closed_forms`: a key of `ltca.quantities.LIMITED` or `SCALARS`.
    sense : {"max", "min"}
        Whether the value is to be at most or at least the limit.
    value : float
        Of the limit, in the unit of the quantity.
    kind : str
        Where it comes from.
    source : str
        The same in words.
    scale : float
        What spare lengths of the shape are measured by, mm.
    """

    name: str
    quantity: str
    sense: str
    value: float
    kind: Kind
    source: str
    scale: float = 1.0

    @property
    def _scalar(self) -> Scalar:
        return LIMITED.get(self.quantity) or SCALARS[self.quantity]

    @property
    def title(self) -> str:
        """What is looked at, in words."""
        return self._scalar.verdict_title

    @property
    def unit(self) -> str:
        """Unit of the value."""
        return self._scalar.unit

    def margin(self, reached: FloatArray | float) -> FloatArray:
        """Return the margin of values in the unit of the quantity, negative where they violate the demand."""
        value = np.asarray(reached, dtype=float)
        if self.kind == "shape":
            return np.asarray((value - self.value) / self.scale)
        if self.quantity == "mean_efficiency":
            return np.asarray(log(1.0 - self.value) - np.log(np.maximum(1.0 - value, 1e-12)))
        if self.value <= 0.0:
            spare = value - self.value
            return np.asarray(spare if self.sense == "min" else -spare)
        ratio = np.log(np.maximum(value, 1e-12) / self.value)
        return np.asarray(ratio if self.sense == "min" else -ratio)

    def change(self, reached: float) -> float:
        """Return by how much the demand would have to change for a value: ln of the factor by `CHANGE_WEIGHT`."""
        return max(0.0, -float(self.margin(reached))) * CHANGE_WEIGHT.get(self.quantity, 1.0)

    def words(self, value: float | None = None) -> str:
        """Return the limit with sign and unit, or a value in its place."""
        if value is not None:
            return shown(value, self.unit)
        return f"{'≤' if self.sense == 'max' else '≥'} {shown(self.value, self.unit)}"


def shown(value: float, unit: str) -> str:
    """Return a value in the unit that people use: N·m, N·m/arcmin, per cent where a unit has one.

    Examples
    --------
    >>> shown(412_000.0, "N mm"), shown(69921.4, "h")
    ('412 N·m', '69920 h')
    """
    if unit == "N mm":
        return f"{_figures(value / 1000.0)} N·m"
    if unit == "N mm/rad":
        return f"{_figures(value / 1000.0 / ARCMIN)} N·m/arcmin"
    return f"{_figures(value)} {label(unit)}".rstrip() if unit != "1" else _figures(value)


def _figures(value: float) -> str:
    """Four digits, large numbers in full."""
    return f"{value:.4g}" if abs(value) < 1e4 else f"{float(f'{value:.4g}'):.0f}"


def written_limits(requirements: Requirements) -> Limits:
    """Return the ``[limits]`` of the drive file: those of the requirement file, and requirements that `cyclo check` judges."""
    asked, shop, found = requirements.asked, requirements.asked.shop, {}

    def add(sense: str, quantity: str, value: float | None, source: str) -> None:
        if value is not None:
            limit = Limit(quantity=quantity, sense=sense, value=value, source=source)
            found[limit.key] = limit

    if not not_rated(prototype(requirements)):
        add("max", "roller_pressure_mid", ROLLER_PRESSURE, ROLLERS)
    add("min", "bearing_life_hours", asked.life, "requirement: life")
    add("min", "mean_efficiency", asked.efficiency, "requirement: efficiency")
    add("max", "backlash_output", None if asked.backlash is None else asked.backlash * ARCMIN, "requirement: backlash")
    add("min", "wall", min(shop.least_wall, shop.least_pin_gap), "requirement: shop.least_wall, shop.least_pin_gap")
    return {**found, **requirements.limits}


def find_demands(requirements: Requirements) -> tuple[Demand, ...]:
    """Return every demand on candidates."""
    asked, shop = requirements.asked, requirements.asked.shop
    found: dict[tuple[str, str], Demand] = {}

    def add(name: str, quantity: str, sense: str, value: float | None, kind: Kind, source: str = "") -> None:
        if value is None:
            return
        scale = asked.outer_diameter / 50.0
        told = source or "requirement"
        # Of two limits the harder one counts; the requirement's name stands before that of its limit.
        here = Demand(name=name, quantity=quantity, sense=sense, value=value, kind=kind, source=told, scale=scale)
        before = found.get((quantity, sense))
        harder = before is not None and (value - before.value) * (1.0 if sense == "min" else -1.0) > 0.0
        if before is None or harder:
            found[quantity, sense] = here

    add("outer_diameter", "outer_diameter", "max", asked.outer_diameter, "requirement")
    add("length", "length", "max", asked.length, "requirement")
    add("torque", "torque", "min", asked.torque, "requirement")
    add("life", "bearing_life_hours", "min", asked.life, "requirement")
    add("stiffness", "stiffness", "min", asked.stiffness, "requirement")
    backlash = None if asked.backlash is None else asked.backlash * ARCMIN
    add("backlash", "backlash_output", "max", backlash, "requirement")
    lost = None if asked.lost_motion is None else asked.lost_motion * ARCMIN
    add("lost_motion", "lost_motion", "max", lost, "requirement")
    add("efficiency", "mean_efficiency", "min", asked.efficiency, "requirement")
    for limit in requirements.limits.values():
        if limit.quantity == "roller_pressure_mid":
            continue  # judged for each race below
        add(f"limits.{limit.key}", limit.quantity, limit.sense, limit.value, "limit", limit.source)
    drive = prototype(requirements)
    judged = (*OF_MATERIALS, *(ANYWHERE if asked.contact.slices > 1 else ()))
    values = [Value(quantity=name, value=1.0) for name in judged if _is_of(name, requirements)]
    for check in judge(drive, values, written_limits(requirements), DEMANDED):
        if check.limit is not None and check.value.value is not None:
            add(
                check.value.quantity,
                check.value.quantity,
                check.limit.sense,
                check.limit.value,
                "material",
                check.limit.source,
            )
    for name in TIGHTENED:
        if name != "pin_hole_clearance" or asked.kind == "discs":
            add(f"shop.{name}", name, "min", shop.range_of(name)[0], "clearance", f"shop.{name}")
    if max(asked.numbers_of_discs) > 1:
        add("disc_share", "disc_share", "min", LEAST_DISC_SHARE, "share", "a disc that carries little is of no use")
    least = {"pin_gap": shop.least_pin_gap, "wall": shop.least_wall, "race": shop.least_race}
    # A flank that is asked to press stays as it was asked.
    least["flank_clearance"] = min(0.0, shop.range_of("equidistant_offset")[0] - shop.range_of("shifting_offset")[1])
    for name in OF_SHAPE:
        if name == "ring_seat" and asked.ring is None:
            continue
        add(
            name,
            name,
            "min",
            least.get(name, 0.0),
            "shape",
            f"shop.least_{name}" if hasattr(shop, f"least_{name}") else "geometry",
        )
    return tuple(found.values())


def _is_of(quantity: str, requirements: Requirements) -> bool:
    asked = requirements.asked
    if quantity.startswith("shaft_pin_"):
        return asked.kind == "discs" and asked.shop.shaft_pin_stiffness is None
    return not quantity.startswith("pin_shaft_") or asked.kind == "discs"


def margins(demands: Sequence[Demand], values: Mapping[str, FloatArray]) -> FloatArray:
    """Return all margins, shape (candidates, demands); not a number where a value, of shape (candidates,), is not known."""
    count = len(next(iter(values.values())))
    return np.stack(
        [
            demand.margin(values[demand.quantity]) if demand.quantity in values else np.full(count, np.nan)
            for demand in demands
        ],
        axis=1,
    )
