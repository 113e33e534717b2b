"""Limits of values, from the drive file or its materials, with safety and verdict.

A limit of the drive file replaces that of a material. Demands of geometry (a wall thicker than zero) are limits of zero, demands
of a theory (half-spaces, sampling) are the bounds of that theory; neither depends on the design, and their sources say so.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from ltca.drive.materials import Material
from ltca.drive.members.limits import SENSES, Limit
from ltca.drive.parts import Drive
from ltca.quantities import LIMITED

Verdict = Literal["pass", "fail", "no limit", "not known"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Value:
    """One quantity of a case.

    Attributes
    ----------
    quantity : str
        One of `ltca.quantities.LIMITED`.
    value : float or None
        In the unit of the quantity; None where it is not known.
    part : str
        Part that has it: pin, roller or hole with its number and disc; empty for the whole drive.
    crank_angle : float or None
        φ_C at which it occurs, rad.
    reason : str
        Why it is not known.
    least : float or None
        Value for a lower limit, where it differs: the least over a turn of the quantity whose largest is `value`.
    """

    quantity: str
    value: float | None
    part: str = ""
    crank_angle: float | None = None
    reason: str = ""
    least: float | None = None

    @property
    def unit(self) -> str:
        """Unit of the value."""
        return LIMITED[self.quantity].unit


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
    """A value, its limit and the verdict.

    Attributes
    ----------
    value : Value
        Value that is judged.
    limit : Limit or None
        Limit that it is judged by.
    asked : bool
        Whether the limit is given in the drive file, so that an unknown value fails.
    """

    value: Value
    limit: Limit | None
    asked: bool = False

    @property
    def fails(self) -> bool:
        """Whether the design fails: the value is beyond its limit, or unknown although the drive file limits it."""
        return self.verdict == "fail" or (self.asked and self.verdict == "not known")

    @property
    def title(self) -> str:
        """Title of the quantity."""
        return LIMITED[self.value.quantity].verdict_title

    @property
    def safety(self) -> float | None:
        """Limit by value for an upper bound, value by limit for a lower one; None where one of them is not positive."""
        value, limit = self.value.value, self.limit
        if value is None or limit is None or limit.value <= 0.0 or value <= 0.0:
            return None
        return limit.value / value if limit.sense == "max" else value / limit.value

    @property
    def verdict(self) -> Verdict:
        """Whether the value is within its limit."""
        value, limit = self.value.value, self.limit
        if limit is None:
            return "not known" if value is None else "no limit"
        if value is None:
            return "not known"
        kept = value <= limit.value if limit.sense == "max" else value >= limit.value
        return "pass" if kept else "fail"


WHOLE = Limit(quantity="carried_torque", sense="min", value=1.0, source="theory of half-spaces: half-widths by radii")
"""Limit that a drive carries all of its torque."""


def judge(
    drive: Drive, values: Sequence[Value], limits: Mapping[str, Limit], demanded: Mapping[str, Limit] | None = None
) -> list[Check]:
    """Return a check for every value and limit, and one without a limit for values that have none.

    Limits are those of the drive file, of the materials of the drive, and those that theories demand, by quantity.
    """
    checks = []
    for value in values:
        own = [one for sense in SENSES if (one := _own(limits, sense, value.quantity)) is not None]
        allowed, lacking = _of_materials(drive, value)
        found = [
            *own,
            *(limit for limit in allowed if limit.sense not in {one.sense for one in own}),
            *_of_soft_races(drive, value, own),
            *_of_shape(value),
        ]
        if value.quantity == "play_at_temperature" and not any(one.sense == "min" for one in own):
            found.append(_limit(value, "min", 0.0, SEIZED))
        if demanded is not None and value.quantity in demanded:
            found.append(demanded[value.quantity])
        judged = value if found or not lacking else replace(value, reason=lacking)
        checks += [Check(value=judged_by(limit, judged), limit=limit, asked=limit in own) for limit in found] or [
            Check(value=judged, limit=None)
        ]
    told = {value.quantity for value in values} | {_BOTH.get(value.quantity) for value in values}
    for limit in limits.values():
        if limit.quantity not in told:
            reason = "not in this drive, or not computed by this engine"
            checks.append(
                Check(value=Value(quantity=limit.quantity, value=None, reason=reason), limit=limit, asked=True)
            )
    return checks


def judged_by(limit: Limit, value: Value) -> Value:
    """Return the value that a limit applies to: for a lower limit the least, where a value has a range."""
    if limit.sense == "max" or value.least is None:
        return value
    return replace(value, value=value.least, part=", ".join(filter(None, ("least", value.part))))


_BOTH = {"roller_pressure_mid_outer": "roller_pressure_mid", "roller_pressure_mid_inner": "roller_pressure_mid"}
"""Quantities that are bounded by the limit of another one as well."""


def _of_soft_races(drive: Drive, value: Value, own: Sequence[Limit]) -> list[Limit]:
    """Allowable pressure of a race that is not of hardened steel, where the file limits all races together: that limit is
    of bearing steel.
    """
    race = {"roller_pressure_mid_outer": "disc", "roller_pressure_mid_inner": "inner_race"}.get(value.quantity)
    if race is None or not any(one.sense == "max" and one.quantity != value.quantity for one in own):
        return []
    part: Material = getattr(drive.materials, race)
    if part.is_bearing_steel or part.allowable_pressure is None:
        return []
    return _lowest(value, [(part.allowable_pressure, race)], "allowable_pressure")


def _own(limits: Mapping[str, Limit], sense: str, quantity: str) -> Limit | None:
    found = limits.get(f"{sense}_{quantity}")
    return found if found is not None or quantity not in _BOTH else limits.get(f"{sense}_{_BOTH[quantity]}")


def _of_shape(value: Value) -> list[Limit]:
    """Limits of geometry."""
    if value.quantity in ("undercut_margin", "wall", "pin_hollow_margin", "roller_gap"):
        return [_limit(value, "min", 0.0, "geometry: less is no part")]
    return []


SEIZED = "geometry: parts that had play at 20 °C overlap at [temperature]"


def _of_materials(drive: Drive, value: Value) -> tuple[list[Limit], str]:
    """The lowest allowable of the materials that a value belongs to, and the property that is missing for a lower one."""
    parts, quantity = drive.materials, value.quantity
    disc, flank_pin, hole_pin = ("disc", parts.disc), _flank_pin(drive), _hole_pin(drive)
    pressed = {
        "pin_pressure_mid": (disc, flank_pin),
        "pin_shaft_pressure_mid": (disc, hole_pin),
        "roller_pressure_mid_outer": (disc, ("roller", parts.roller)),
        "roller_pressure_mid_inner": (("roller", parts.roller), ("inner_race", parts.inner_race)),
        "pin_seat_pressure": (("wheel_pin", parts.wheel_pin), _seat(drive)),
        "hole_seat_pressure": (("shaft_pin", parts.shaft_pin), ("sleeve", parts.sleeve)),
    }
    if quantity in pressed:
        given = [
            (part.allowable_pressure, name) for name, part in pressed[quantity] if part.allowable_pressure is not None
        ]
        lacking = [f"materials.{name}" for name, part in pressed[quantity] if part.allowable_pressure is None]
        found = _lowest(value, given, "allowable_pressure")
        # The limit of one body alone is used only where the value is beyond it already.
        kept = value.value is None or not found or value.value <= found[0].value
        told = f"{' and '.join(lacking)} has no allowable_pressure" if lacking else ""
        return ([] if lacking and kept else found), told
    bent = {"wheel": ("wheel_pin", parts.wheel_pin), "shaft": ("shaft_pin", parts.shaft_pin)}
    which, _, rest = quantity.partition("_pin_")
    if rest == "bending_amplitude":
        name, part = bent[which]
        given = [] if part.bending_fatigue_limit is None else [(part.bending_fatigue_limit, name)]
        return _lowest(
            value, given, "bending_fatigue_limit"
        ), f"not judged: materials.{name} has no bending_fatigue_limit"
    if rest in ("bending_stress", "shear_stress"):
        name, part = bent[which]
        factor, how = (1.0, "yield_strength") if rest.startswith("bending") else (3.0**-0.5, "yield_strength/√3")
        given = [] if part.yield_strength is None else [(factor * part.yield_strength, name)]
        return _lowest(value, given, how), f"materials.{name} has no yield_strength"
    if quantity in ("root_stress", "bore_stress", "hole_stress"):
        given = [] if parts.disc.yield_strength is None else [(parts.disc.yield_strength, "disc")]
        return _lowest(value, given, "yield_strength"), "materials.disc has no yield_strength"
    if quantity == "contact_strain":
        name, part = min((disc, flank_pin), key=lambda body: body[1].youngs_modulus)
        return _strain(value, name, part), f"materials.{name} has neither hardness nor yield_strength"
    if quantity == "shear_depth" and parts.disc.hardness_depth is not None:
        return [_limit(value, "max", parts.disc.hardness_depth, "materials.disc.hardness_depth")], ""
    if quantity == "core_shear" and parts.disc.yield_strength is not None:
        return [_limit(value, "max", 0.5 * parts.disc.yield_strength, "materials.disc.yield_strength/2 (Tresca)")], ""
    if quantity == "disc_shear":
        return _shear(value, parts.disc), "materials.disc has neither hardness nor yield_strength"
    return [], ""


FIRST_YIELD = "1.67: first yield below a line contact (Johnson, Contact Mechanics, 1985, sect. 4.2)"
YIELD_BY_HARDNESS = 9.81 / 3.0
"""Yield strength of a surface by its Vickers hardness, MPa by HV (Tabor, The Hardness of Metals, 1951): of hardened parts the
yield strength is that of the core. Fatigue is a matter of the allowable pressure."""


def _strain(value: Value, name: str, part: Material) -> list[Limit]:
    if part.hardness is not None:
        strength, field = YIELD_BY_HARDNESS * part.hardness, "hardness · 9.81/3 (Tabor 1951)"
    elif part.yield_strength is not None:
        strength, field = part.yield_strength, "yield_strength"
    else:
        return []
    source = f"{FIRST_YIELD} of materials.{name}.{field} / youngs_modulus"
    return [_limit(value, "max", 1.67 * strength / part.youngs_modulus, source)]


def _shear(value: Value, disc: Material) -> list[Limit]:
    if disc.hardness is not None:
        source = "materials.disc.hardness · 9.81/6: yield by hardness (Tabor 1951) and Tresca"
        return [_limit(value, "max", 0.5 * YIELD_BY_HARDNESS * disc.hardness, source)]
    if disc.yield_strength is not None:
        return [_limit(value, "max", 0.5 * disc.yield_strength, "materials.disc.yield_strength/2 (Tresca)")]
    return []


def _lowest(value: Value, given: list[tuple[float, str]], field: str) -> list[Limit]:
    return [_limit(value, "max", number, f"materials.{name}.{field}") for number, name in sorted(given)[:1]]


def _limit(value: Value, sense: str, number: float, source: str) -> Limit:
    return Limit(quantity=value.quantity, sense=sense, value=number, source=source)


def _flank_pin(drive: Drive) -> tuple[str, Material]:
    sleeved = drive.pin_wheel.seat.kind == "sleeve"
    return ("sleeve", drive.materials.sleeve) if sleeved else ("wheel_pin", drive.materials.wheel_pin)


def _hole_pin(drive: Drive) -> tuple[str, Material]:
    shaft = drive.pin_shaft
    sleeved = shaft is not None and shaft.seat.kind == "sleeve"
    return ("sleeve", drive.materials.sleeve) if sleeved else ("shaft_pin", drive.materials.shaft_pin)


def _seat(drive: Drive) -> tuple[str, Material]:
    slot = drive.pin_wheel.seat.kind == "slot"
    return ("wheel_seat", drive.materials.wheel_seat) if slot else ("sleeve", drive.materials.sleeve)
