"""Limits of values, from the drive file or its materials, with safety and verdict.

Every value is judged once in each sense, by the strictest limit that applies. A limit of the drive file replaces that of a
material, but for first yield. Demands of geometry (a wall thicker than zero) are limits of zero, demands of a theory
(half-spaces, sampling) are the bounds of that theory; neither depends on the design, and their sources say so.

A joint is judged by its pressure: by the lowest allowable pressure of its bodies, and by first yield below a line contact where
hardness or yield strength of a body is known. Shear below the surface and strain of the contact are that pressure times
constants, and say the same again: they are told.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from ltca.drive.materials import Material
from ltca.drive.members.limits import SENSES, Limit
from ltca.drive.parts import Drive
from ltca.quantities import LIMITED, NEED_SLICES

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
    """Return a check for every value and sense of limit, and one without a limit for values that have none.

    Limits are those of the drive file, of the materials of the drive, and those that theories demand, by quantity; of several in
    one sense the strictest is the one that judges.
    """
    checks = []
    for value in values:
        own = [one for sense in SENSES if (one := _own(limits, sense, value.quantity)) is not None]
        allowed, lacking = _of_materials(drive, value, own)
        found = [*own, *allowed, *_of_shape(value)]
        if value.quantity == "play_at_temperature" and not any(one.sense == "min" for one in own):
            found.append(_limit(value, "min", 0.0, SEIZED))
        if demanded is not None and value.quantity in demanded:
            found.append(demanded[value.quantity])
        asked = {one.sense for one in own}
        judged = value if found or not lacking else replace(value, reason=lacking)
        checks += [
            Check(value=judged_by(limit, judged), limit=limit, asked=limit.sense in asked)
            for limit in _strictest(found)
        ] or [Check(value=judged, limit=None)]
    told = {value.quantity for value in values} | {_BOTH.get(value.quantity) for value in values}
    for limit in limits.values():
        if limit.quantity not in told:
            reason = "not in this drive, or not computed by this engine"
            if drive.pin_shaft is None and limit.quantity.startswith(OF_SHAFT_PINS):
                reason = "this drive has no shaft pins"
            elif drive.contact.slices == 1 and limit.quantity in NEED_SLICES:
                reason = "nothing tilts in the plane model (contact.slices = 1)"
            elif limit.quantity == "axial_play_taken":
                reason = "disc.axial_play is left out"
            checks.append(
                Check(value=Value(quantity=limit.quantity, value=None, reason=reason), limit=limit, asked=True)
            )
    return checks


OF_SHAFT_PINS = ("pin_shaft_", "shaft_pin_", "hole_")
"""How quantities begin that only drives with a pin shaft have."""


def _strictest(limits: Sequence[Limit]) -> list[Limit]:
    """The lowest upper and the highest lower limit, the first of equal ones."""
    upper = [one for one in limits if one.sense == "max"]
    lower = [one for one in limits if one.sense == "min"]
    return [
        *([min(upper, key=lambda one: one.value)] if upper else []),
        *([max(lower, key=lambda one: one.value)] if lower else []),
    ]


def judged_by(limit: Limit, value: Value) -> Value:
    """Return the value that a limit applies to: for a lower limit the least, where a value has a range."""
    if limit.sense == "max" or value.least is None:
        return value
    return replace(value, value=value.least, part=", ".join(filter(None, ("least", value.part))))


ANYWHERE = {
    "pin_pressure_max": "pin_pressure_mid",
    "roller_pressure_max_outer": "roller_pressure_mid_outer",
    "roller_pressure_max_inner": "roller_pressure_mid_inner",
    "pin_shaft_pressure_max": "pin_shaft_pressure_mid",
}
"""Largest pressures anywhere along the width, with those at mid-width of the same joints.

Where a contact ends before its line does the allowable pressure of the joint holds for them; at a straight end that carries the
pressure is singular in any drive, and first yield holds, unless the file limits it."""


def allowable_anywhere(drive: Drive, value: Value) -> Limit | None:
    """Return the limit by the allowable pressures of a joint on one of `ANYWHERE`; None where a body has none."""
    found, _ = _of_materials(drive, replace(value, quantity=ANYWHERE[value.quantity]), [])
    allowed = [one for one in found if one.source.endswith("allowable_pressure")]
    return replace(allowed[0], quantity=value.quantity) if allowed else None


_BOTH = {
    "roller_pressure_max_outer": "roller_pressure_max",
    "roller_pressure_max_inner": "roller_pressure_max",
    "roller_pressure_mid_outer": "roller_pressure_mid",
    "roller_pressure_mid_inner": "roller_pressure_mid",
}
"""Quantities that are bounded by the limit of another one as well."""


def _own(limits: Mapping[str, Limit], sense: str, quantity: str) -> Limit | None:
    found = limits.get(f"{sense}_{quantity}")
    return found if found is not None or quantity not in _BOTH else limits.get(f"{sense}_{_BOTH[quantity]}")


def _of_shape(value: Value) -> list[Limit]:
    """Limits of geometry."""
    if value.quantity in ("undercut_margin", "wall", "pin_hollow_margin", "roller_gap"):
        return [_limit(value, "min", 0.0, "geometry: less is no part")]
    return []


SEIZED = "geometry: parts that had play at 20 °C overlap at [temperature]"


def _of_materials(drive: Drive, value: Value, own: Sequence[Limit]) -> tuple[list[Limit], str]:
    """Limits that the materials of a value's parts set, and the property that is missing where they set none.

    `own` are the limits of the file on that value.
    """
    parts, quantity = drive.materials, value.quantity
    disc = ("disc", parts.disc)
    upper = next((one for one in own if one.sense == "max"), None)
    joints = {
        "pin_pressure_mid": (disc, _flank_pin(drive)),
        "pin_shaft_pressure_mid": (disc, _hole_pin(drive)),
        "roller_pressure_mid_outer": (disc, ("roller", parts.roller)),
        "roller_pressure_mid_inner": (("roller", parts.roller), ("inner_race", parts.inner_race)),
    }
    if quantity in joints:
        return _of_joint(value, joints[quantity], upper)
    if upper is not None:
        return [], ""
    if quantity in ANYWHERE and drive.contact.slices > 1:
        bodies = joints[ANYWHERE[quantity]]
        return _of_bodies(value, _yielding(value, bodies), [name for name, _ in bodies], "hardness or yield_strength")
    seats = {
        "pin_seat_pressure": (("wheel_pin", parts.wheel_pin), _seat(drive)),
        "hole_seat_pressure": (("shaft_pin", parts.shaft_pin), ("sleeve", parts.sleeve)),
    }
    if quantity in seats:
        given = {name: [_endured(value, name, part)] for name, part in seats[quantity] if part.allowable_pressure}
        return _of_bodies(value, given, [name for name, _ in seats[quantity]], "allowable_pressure")
    bent = {"wheel": ("wheel_pin", parts.wheel_pin), "shaft": ("shaft_pin", parts.shaft_pin)}
    which, _, rest = quantity.partition("_pin_")
    if rest == "bending_amplitude":
        name, part = bent[which]
        limit = _of_property(value, part.bending_fatigue_limit, f"materials.{name}.bending_fatigue_limit")
        return limit, f"not judged: materials.{name} has no bending_fatigue_limit"
    if rest in ("bending_stress", "shear_stress"):
        name, part = bent[which]
        factor, how = (1.0, "yield_strength") if rest.startswith("bending") else (3.0**-0.5, "yield_strength/√3")
        limit = _of_property(value, part.yield_strength, f"materials.{name}.{how}", factor)
        return limit, f"materials.{name} has no yield_strength"
    strength = parts.disc.yield_strength
    if quantity in ("root_stress", "bore_stress", "hole_stress"):
        limit = _of_property(value, strength, "materials.disc.yield_strength")
        return limit, "materials.disc has no yield_strength"
    if quantity == "core_shear":
        return _of_property(value, strength, "materials.disc.yield_strength/2 (Tresca)", 0.5), ""
    if quantity == "shear_depth" and strength is None:  # the core is judged by its shear where its strength is known
        return _of_property(value, parts.disc.hardness_depth, "materials.disc.hardness_depth"), ""
    return [], ""


def _yielding(value: Value, bodies: Sequence[tuple[str, Material]]) -> dict[str, list[Limit]]:
    """First yield of the bodies of which it is known."""
    return {name: found for name, part in bodies if (found := _first_yield(value, name, part))}


FIRST_YIELD = "first yield below a line contact, 1.67 Y (Johnson, Contact Mechanics, 1985, sect. 4.2)"
YIELD_BY_HARDNESS = 9.81 / 3.0
"""Yield strength of a surface by its Vickers hardness, MPa by HV (Tabor, The Hardness of Metals, 1951): of hardened parts the
yield strength is that of the core. Fatigue is a matter of the allowable pressure."""


def _of_joint(value: Value, bodies: Sequence[tuple[str, Material]], upper: Limit | None) -> tuple[list[Limit], str]:
    """What the bodies of a line contact bear: their allowable pressures, which an upper limit of the file replaces, and their
    first yield.

    A limit on all races together is one of bearing steel, and replaces nothing of other bodies.
    """
    given: dict[str, list[Limit]] = {}
    for name, part in bodies:
        replaced = upper is not None and (upper.quantity == value.quantity or part.is_bearing_steel)
        endured = [] if replaced or part.allowable_pressure is None else [_endured(value, name, part)]
        found = [*endured, *_first_yield(value, name, part)]
        if found:
            given[name] = found
    if upper is not None:  # which judges what the materials leave open
        return [limit for found in given.values() for limit in found], ""
    return _of_bodies(value, given, [name for name, _ in bodies], "allowable_pressure, hardness or yield_strength")


def _of_bodies(
    value: Value, given: Mapping[str, Sequence[Limit]], names: Sequence[str], lacked: str
) -> tuple[list[Limit], str]:
    """The strictest limit of two bodies; that of one alone only where the value is beyond it already."""
    found = _strictest([limit for limits in given.values() for limit in limits])
    lacking = [f"materials.{name}" for name in names if name not in given]
    kept = value.value is None or not found or value.value <= found[0].value
    told = f"{' and '.join(lacking)} {'has' if len(lacking) == 1 else 'have'} no {lacked}" if lacking else ""
    return ([] if lacking and kept else found), told


def _endured(value: Value, name: str, part: Material) -> Limit:
    return _limit(value, "max", part.allowable_pressure or 0.0, f"materials.{name}.allowable_pressure")


def _first_yield(value: Value, name: str, part: Material) -> list[Limit]:
    if part.hardness is not None:
        strength, known = YIELD_BY_HARDNESS * part.hardness, "hardness · 9.81/3 (Tabor 1951)"
    elif part.yield_strength is not None:
        strength, known = part.yield_strength, "yield_strength"
    else:
        return []
    return [_limit(value, "max", 1.67 * strength, f"{FIRST_YIELD}, Y = materials.{name}.{known}")]


def _of_property(value: Value, number: float | None, source: str, factor: float = 1.0) -> list[Limit]:
    return [] if number is None else [_limit(value, "max", factor * number, source)]


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
