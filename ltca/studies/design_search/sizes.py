"""Sizes of many candidates at once, and the drive of one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from math import log, sqrt
from typing import Any

import numpy as np
from pydantic import TypeAdapter

from ltca.arrays import FloatArray
from ltca.drive.materials import PARTS, Material
from ltca.drive.parts import Drive
from ltca.reading.drive_file import build_drive
from ltca.reading.member_checks import find_member_problems
from ltca.studies.design_search.requirements import Requirements
from ltca.studies.design_search.surroundings import carrier_table, ring_table, stage_of

CONTINUOUS = ("pin_circle", "thickness", "bore", "hole_circle")
"""Sizes that refinement varies, beside clearances that have a range; the rest is counted, or comes in stock sizes."""


OF_DISTANCE = (
    "discs", "pins", "eccentricity", "pin_circle", "pin_radius", "thickness", "bore", "roller_radius", "roller_length", "holes",
    "hole_circle", "hole_pin",
)  # fmt: skip
"""Sizes by which two designs are told apart."""
LEAST_DISTANCE = 0.2
"""Least `distance` between two of the designs that are told: one size that differs by a fifth, or several by less."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Sizes:
    """Sizes of candidates, an array each, shape (candidates,); radii and lengths in mm.

    Attributes
    ----------
    discs, pins, rollers, holes : array
        n, z_P, n_BR, and z_PS (0 for RV reducers).
    stage : array
        z₂/z₁ of the first stage of RV reducers; 1 for others.
    sun, planet : array
        Its teeth z₁ and z₂; 0 for others.
    eccentricity, pin_circle, pin_radius, thickness : array
        e, R_C, r_P, t.
    bore, roller_radius, roller_length : array
        r_o, r_BR and the length of the rollers.
    hole_circle, hole_pin : array
        R_PS, or of RV reducers the circle of the cranks; r_PS.
    equidistant_offset, shifting_offset : array
        Δr_P and ΔR_C of the flank.
    bearing_clearance, pin_hole_clearance : array
        As in a drive file; the latter without effect in RV reducers.
    lead_crown_drop : array
        Drop of the crown of the flank along its width.
    torque : array
        On the output, N·mm: that asked for, or less where it stands in the way.
    """

    discs: FloatArray
    pins: FloatArray
    stage: FloatArray
    sun: FloatArray
    planet: FloatArray
    eccentricity: FloatArray
    pin_circle: FloatArray
    pin_radius: FloatArray
    thickness: FloatArray
    bore: FloatArray
    roller_radius: FloatArray
    roller_length: FloatArray
    rollers: FloatArray
    holes: FloatArray
    hole_circle: FloatArray
    hole_pin: FloatArray
    equidistant_offset: FloatArray
    shifting_offset: FloatArray
    bearing_clearance: FloatArray
    pin_hole_clearance: FloatArray
    lead_crown_drop: FloatArray
    torque: FloatArray

    @property
    def count(self) -> int:
        """Candidates."""
        return int(self.pins.size)

    def take(self, rows: Any) -> Sizes:
        """Return some of the candidates, as an index of arrays chooses."""
        return Sizes(**{item.name: np.atleast_1d(getattr(self, item.name)[rows]) for item in fields(self)})

    def row(self) -> dict[str, float]:
        """Return the numbers of the one candidate by name."""
        return {item.name: float(getattr(self, item.name).item()) for item in fields(self)}

    @classmethod
    def of_rows(cls, rows: list[dict[str, float]]) -> Sizes:
        """Return candidates of their numbers by name."""
        return cls(**{item.name: np.array([row[item.name] for row in rows], dtype=float) for item in fields(cls)})


def distance(first: Mapping[str, float], second: Mapping[str, float]) -> float:
    """Return how far two candidates are from each other: the root of the sum of squares of ln of the ratios of their sizes.

    Examples
    --------
    >>> one = dict.fromkeys(OF_DISTANCE, 2.0)
    >>> round(distance(one, one | {"bore": 2.4, "pin_radius": 2.2}), 3)
    0.206
    """
    both = [(first[name], second[name]) for name in OF_DISTANCE if first[name] > 0.0 and second[name] > 0.0]
    return sqrt(sum(log(one / other) ** 2 for one, other in both))


def joined(parts: list[Sizes]) -> Sizes:
    """Return the candidates of several sets as one."""
    return Sizes(**{item.name: np.concatenate([getattr(part, item.name) for part in parts]) for item in fields(Sizes)})


def stack_length(sizes: Sizes, gap: float) -> FloatArray:
    """Return the length of the discs with the gaps between them, mm."""
    return np.asarray(sizes.discs * sizes.thickness + (sizes.discs - 1.0) * gap)


def drive_table(row: dict[str, float], requirements: Requirements, name: str) -> dict[str, Any]:
    """Return the drive of one candidate (a row of `Sizes.row`) as plain tables, as in a drive file."""
    asked, shop = requirements.asked, requirements.asked.shop
    discs, several = int(row["discs"]), asked.kind == "rv"
    stack = discs * row["thickness"] + (discs - 1) * shop.disc_gap
    inner = row["bore"] - 2.0 * row["roller_radius"]
    held = asked.held == "pin-wheel"
    turned = row["pins"] - (1.0 if held else 0.0)
    if several:
        turned = row["stage"] * row["pins"] + (1.0 if held else 0.0)
    # Parts that are given where the drive has none are refused by the drive (`problems_of_any_size`).
    materials = {
        part: own
        for part in PARTS
        if (own := getattr(requirements.materials, part)) != Material()
        or part in ("disc", "wheel_pin", "roller", "inner_race", *(() if several else ("shaft_pin",)))
    }
    table: dict[str, Any] = {
        "name": name,
        "installation": {"held": asked.held},
        "crank": {"eccentricity": row["eccentricity"]},
        "pin_wheel": {
            "number_of_pins": int(row["pins"]),
            "pin_circle_radius": row["pin_circle"],
            "pin_radius": row["pin_radius"],
        },
        "disc": {
            "number_of_teeth": int(row["pins"]) - 1,
            "thickness": row["thickness"],
            "number_of_discs": discs,
            "equidistant_offset": row["equidistant_offset"],
            "shifting_offset": row["shifting_offset"],
            "lead_crown_drop": row["lead_crown_drop"],
        },
        "crank_bearing": {
            "inner_race_radius": inner,
            "outer_race_radius": row["bore"],
            "number_of_rollers": int(row["rollers"]),
            "roller_radius": row["roller_radius"],
            "roller_length": row["roller_length"],
        },
        "load": {"torque": row["torque"], "speed": asked.speed * turned},
        "clearance": {"bearing": row["bearing_clearance"]},
        "contact": asked.contact,
        "materials": materials,
    }
    if discs > 1:
        table["disc"]["gap"] = shop.disc_gap
    if several:
        if asked.first_stage is None:
            table["installation"]["first_stage_ratio"] = row["stage"]
        else:
            table["first_stage"] = stage_of(asked.first_stage, row)
        table["crank"] |= {"number": asked.number_of_cranks, "circle_radius": row["hole_circle"]}
        if shop.crank_support_stiffness is not None:
            half = 0.5 * stack + shop.disc_gap + 0.5 * inner
            table["crank"]["support"] = {
                "diameter": 2.0 * (inner - row["eccentricity"]),
                "positions": (-half, half),
                "stiffness": (shop.crank_support_stiffness,) * 2,
            }
    else:
        table["clearance"]["pin_hole"] = row["pin_hole_clearance"]
        table["pin_shaft"] = {
            "number_of_pins": int(row["holes"]),
            "pin_circle_radius": row["hole_circle"],
            "pin_radius": row["hole_pin"],
            "hole_radius": row["hole_pin"] + row["eccentricity"],
        }
        if shop.shaft_pin_stiffness is None:
            span = stack + 2.0 * shop.disc_gap
            table["pin_shaft"]["beam"] = {"span": span, "tip": "tied-clamped"}
        else:
            table["pin_shaft"]["stiffness"] = shop.shaft_pin_stiffness
    if asked.ring is not None:
        table["ring"] = ring_table(asked.ring, row, shop.housing_wall, stack + shop.flanges)
    if asked.carrier is not None:
        table["carrier"] = carrier_table(asked.carrier, row)
    if asked.load.external:
        table["load"]["external"] = asked.load.external
    for key in ("friction", "temperature", "lubricant", "main_bearing"):
        if getattr(asked, key) is not None:
            table[key] = getattr(asked, key)
    meant: dict[str, Any] = as_meant(table)
    return meant


def as_meant(value: Any) -> Any:
    """Return plain tables with numbers to twelve digits: sums and differences of lengths without the dust of binary fractions.

    Examples
    --------
    >>> as_meant({"inner_race_radius": 17.841 - 5.0, "planes": (-6.5, 6.5)})
    {'inner_race_radius': 12.841, 'planes': (-6.5, 6.5)}
    """
    if isinstance(value, float):
        return float(f"{value:.12g}")
    if isinstance(value, dict):
        return {name: as_meant(own) for name, own in value.items()}
    return tuple(map(as_meant, value)) if isinstance(value, tuple) else value


def drive_of(row: dict[str, float], requirements: Requirements, name: str | None = None) -> Drive:
    """Return the drive of one candidate (a row of `Sizes.row`), fully checked; `DriveError` where it cannot be built."""
    return build_drive(drive_table(row, requirements, name or requirements.asked.name))


def prototype(requirements: Requirements, scale: float = 1.0) -> Drive:
    """Return a drive of arbitrary sizes, times a scale, for what does not depend on them; nothing of it is checked."""
    row = dict.fromkeys(Sizes.__dataclass_fields__, scale) | {
        "pins": 20.0, "discs": float(requirements.asked.numbers_of_discs[0]), "rollers": 10.0, "holes": 8.0,
        "pin_circle": 10.0 * scale, "eccentricity": 0.4 * scale, "bore": 9.0 * scale, "stage": 2.0, "sun": 20.0, "planet": 40.0,
        "torque": requirements.asked.torque, **requirements.asked.starting,
    }  # fmt: skip
    return TypeAdapter(Drive).validate_python(drive_table(row, requirements, "prototype"))


def problems_of_any_size(requirements: Requirements) -> list[str]:
    """Return what is wrong with the members of a drive whatever its sizes are: sentences that do not change with them."""
    small, large = (list(find_member_problems(prototype(requirements, scale))) for scale in (1.0, 50.0))
    return [told for told in small if told in large]
