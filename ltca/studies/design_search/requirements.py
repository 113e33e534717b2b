"""What is asked of a design, with numbers in the units of drive files."""

from __future__ import annotations

from dataclasses import field
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator, Field
from pydantic.dataclasses import dataclass
from pydantic_core import PydanticCustomError

from ltca.drive.deviations import STRICT, NonNegativeLength, PositiveLength
from ltca.drive.materials import Materials
from ltca.drive.members.limits import Limits
from ltca.drive.members.main_bearing import MainBearing
from ltca.drive.members.operation import Friction, Lubricant, Temperature
from ltca.drive.members.width import Contact
from ltca.drive.names import Name
from ltca.drive.units.quantities import COUNT, QuantityCheck, check_count, quantity
from ltca.studies.design_search.stock import Stock
from ltca.studies.design_search.surroundings import (
    WantedCarrier,
    WantedLoad,
    WantedRing,
    WantedStage,
)

NO_FILE = "no such file; docs/how-to/design.md says what a requirement file holds, examples/requirements has ten"
STOCK = ("eccentricities", "wheel_pins", "shaft_pins", "rollers")
MOST_DISCS = 3
CLEARANCES = ("equidistant_offset", "shifting_offset", "bearing_clearance", "pin_hole_clearance")
"""Lengths of `Shop` that are held as numbers and searched as ranges."""
LEAD_CROWNS = (0.0, 0.02)
"""Drops of the lead crown that are searched with slices where the shop says nothing, mm."""
FINEST_CLEARANCE = 1e-3
"""Step to which sizes are rounded, below which no range of clearances starts, mm."""


def _counts(value: Any) -> Any:
    return tuple(check_count(one) for one in (value if isinstance(value, list | tuple) else [value]))


Counts = Annotated[
    tuple[Annotated[int, Field(ge=1, le=MOST_DISCS)], ...], Field(min_length=1), BeforeValidator(_counts)
]


def _ratio(value: Any) -> Any:
    """A ratio written "1:59" or "59:1" as its number; anything else as it is."""
    sides = [side.strip() for side in value.split(":")] if isinstance(value, str) else []
    if len(sides) != 2 or "1" not in sides:
        return value
    other = sides[1] if sides[0] == "1" else sides[0]
    try:
        return float(other)
    except ValueError:
        return value


def _range_of(check: QuantityCheck) -> BeforeValidator:
    """Validator of a length that is one number, held, or a range of two."""

    def read(value: Any) -> tuple[float, float]:
        if not isinstance(value, list | tuple):
            held = check(value)
            return held, held
        if len(value) != 2:
            raise PydanticCustomError("range", "must be a length in mm, or a range of two, [least, most]")
        low, high = check(value[0]), check(value[1])
        if not low < high:
            raise PydanticCustomError("range", "must be a range, [least, most] in mm with least less than most")
        return low, high

    return BeforeValidator(read)


def _lengths(least: float | None = None) -> QuantityCheck:
    return QuantityCheck(
        unit="mm", bounds=(("greater than", None), ("at least", least), ("less than", None), ("at most", None))
    )


SignedRange = Annotated[tuple[float, float], _range_of(_lengths())]
NonNegativeRange = Annotated[tuple[float, float], _range_of(_lengths(0.0))]


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class Shop:
    """Manufacturing limits and rules of assembly.

    Attributes
    ----------
    equidistant_offset, shifting_offset : (float, float)
        Of the flank, least and most that the shop makes, mm; equal where one number is given, which is held.
    bearing_clearance, pin_hole_clearance : (float, float)
        As in a drive file, least and most, mm.
    lead_crown_drop : (float, float) or None
        Of the crown of the flank along its width, least and most, mm; `LEAD_CROWNS` when left out with slices, none in the plane.
    least_wall : float
        Between holes, bores and roots, mm.
    least_pin_gap : float
        Between neighbouring wheel pins, mm.
    housing_wall : float
        Outside of the wheel pins, mm.
    disc_gap : float
        Between neighbouring discs, mm.
    flanges : float
        What comes to the discs in length, both sides together, mm.
    cage_gap : float
        Between neighbouring rollers, as a part of their diameter; 0 without a cage.
    least_cage_bar : float
        Thickness of a bar of the cage between two rollers, mm.
    least_race : float
        Of the crank, between its shaft and the inner race of the eccentric on its thin side, mm.
    crankshaft_shear : float
        That the shaft of a crank may have by the torque of the input, MPa.
    shaft_pin_stiffness : float or None
        Of a shaft pin as a spring, N/mm; left out, shaft pins are beams that a ring ties.
    crank_support_stiffness : float or None
        Radial, of each of the two bearings of a crankshaft, N/mm; rigid when left out.
    """

    equidistant_offset: SignedRange = (0.01, 0.02)
    shifting_offset: SignedRange = (0.0, 0.0)
    bearing_clearance: NonNegativeRange = (0.002, 0.005)
    pin_hole_clearance: NonNegativeRange = (0.002, 0.005)
    lead_crown_drop: NonNegativeRange | None = None
    least_wall: PositiveLength = 2.0
    least_pin_gap: PositiveLength = 0.5
    housing_wall: NonNegativeLength = 4.0
    disc_gap: NonNegativeLength = 1.0
    flanges: NonNegativeLength = 0.0
    cage_gap: Annotated[float, quantity("dimensionless", ge=0.0, le=2.0)] = 0.2
    least_cage_bar: NonNegativeLength = 0.4
    least_race: PositiveLength = 1.5
    crankshaft_shear: Annotated[float, quantity("MPa", gt=0.0)] = 40.0
    shaft_pin_stiffness: Annotated[float, quantity("N/mm", gt=0.0)] | None = None
    crank_support_stiffness: Annotated[float, quantity("N/mm", gt=0.0)] | None = None

    def range_of(self, clearance: str) -> tuple[float, float]:
        """Return least and most of one of `CLEARANCES`, mm."""
        low, high = getattr(self, clearance)
        return float(low), float(high)

    @property
    def tightest(self) -> dict[str, float]:
        """Clearances from which candidates start, mm: the least of each, of the shift of the flank the middle."""
        found = {name: self.range_of(name)[0] for name in CLEARANCES}
        return found | {"shifting_offset": 0.5 * sum(self.range_of("shifting_offset"))}

    def roller_gap(self, diameter: Any) -> Any:
        """Return the gap that a cage needs between neighbouring rollers of a diameter, both in mm; 0 without a cage."""
        return np.maximum(self.cage_gap * diameter, self.least_cage_bar if self.cage_gap else 0.0)


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class Asked:
    """The plain keys and the tables of a requirement file that are read as they stand.

    Attributes
    ----------
    name : str
        Of the drives that are written.
    kind : {"discs", "rv"}
        One crank in the centre and a pin shaft, or several cranks behind a spur stage.
    discs : tuple of int or None
        Numbers of discs to choose from, 1 to 3; where left out `numbers_of_discs`.
    cranks : int or None
        Of an RV reducer; three when left out. None of others.
    held : {"pin-shaft", "pin-wheel"}
        Member that stands still.
    ratio : float
        Turns of the input for one of the output, its size; a text "1:59" is read as 59.
    ratio_tolerance : float
        By which part the ratio may differ.
    torque : float
        On the output, N·mm.
    speed : float
        Of the output, turns a minute.
    outer_diameter, length : float
        Room for the drive, mm.
    life : float or None
        Of the crank bearings, L10r in hours, at least.
    stiffness : float or None
        Torsional, at the output, N·mm/rad, at least.
    backlash, lost_motion : float or None
        At the output, rad, at most; lost motion at ± 3 % of the torque.
    efficiency : float or None
        At least.
    smallest : {"size", "diameter", "length"}
        What designs are ranked by: volume of the cylinder around them, or one of its sizes.
    shop : Shop
        What can be made.
    friction, temperature, lubricant, main_bearing : dataclass or None
        As in a drive file.
    ring, carrier, first_stage : dataclass or None
        What else holds the contacts; sizes that are left out of them follow those that are searched.
    load : WantedLoad
        Forces from outside.
    contact : Contact
        As in a drive file: slices along the width of every contact.
    """

    name: Name = "design"
    kind: Literal["discs", "rv"] = "discs"
    discs: Counts | None = None
    cranks: Annotated[int, Field(ge=2, le=6), COUNT] | None = None
    held: Literal["pin-shaft", "pin-wheel"] = "pin-wheel"
    ratio: Annotated[float, quantity("dimensionless", ge=3.0, le=1000.0), BeforeValidator(_ratio)]
    ratio_tolerance: Annotated[float, quantity("dimensionless", ge=0.0, le=0.5)] = 0.0
    torque: Annotated[float, quantity("N*mm", gt=0.0)]
    speed: Annotated[float, quantity("rpm", gt=0.0)]
    outer_diameter: PositiveLength
    length: PositiveLength
    life: Annotated[float, quantity("h", gt=0.0)] | None = None
    stiffness: Annotated[float, quantity("N*mm/rad", gt=0.0)] | None = None
    backlash: Annotated[float, quantity("rad", gt=0.0)] | None = None
    lost_motion: Annotated[float, quantity("rad", gt=0.0)] | None = None
    efficiency: Annotated[float, quantity("dimensionless", gt=0.0, lt=1.0)] | None = None
    smallest: Literal["size", "diameter", "length"] = "size"
    shop: Shop = field(default_factory=Shop)
    friction: Friction | None = None
    temperature: Temperature | None = None
    lubricant: Lubricant | None = None
    ring: WantedRing | None = None
    carrier: WantedCarrier | None = None
    main_bearing: MainBearing | None = None
    first_stage: WantedStage | None = None
    load: WantedLoad = field(default_factory=WantedLoad)
    contact: Contact = field(default_factory=Contact)

    @property
    def numbers_of_discs(self) -> tuple[int, ...]:
        """Numbers of discs to choose from; one or two where nothing is asked, of an RV reducer two."""
        return self.discs or ((2,) if self.kind == "rv" else (1, 2))

    @property
    def lead_crowns(self) -> tuple[float, float]:
        """Least and most drop of the lead crown, mm; equal where it is held, zero in the plane."""
        if self.shop.lead_crown_drop is None:
            return LEAD_CROWNS if self.contact.slices > 1 else (0.0, 0.0)
        low, high = self.shop.lead_crown_drop
        return float(low), float(high)

    @property
    def starting(self) -> dict[str, float]:
        """Clearances and crown from which candidates start: `Shop.tightest`, and the least crown."""
        return self.shop.tightest | {"lead_crown_drop": self.lead_crowns[0]}

    @property
    def number_of_cranks(self) -> int:
        """Of an RV reducer; three where nothing else is asked."""
        return 3 if self.cranks is None else self.cranks


REQUIRED = {
    "ratio": "turns of the input for one of the output, without unit: ratio = 59",
    "torque": 'torque at the output, in N·mm or as a text with its unit: torque = "200 N m"',
    "speed": 'speed of the output (not of the motor), in rpm or as a text with its unit: speed = "30 rpm"',
    "outer_diameter": 'diameter of the room for the drive, over pins and housing wall, in mm: outer_diameter = "130 mm"',
    "length": 'axial room for discs, gaps and flanges, in mm: length = "40 mm"',
}
"""Keys that every requirement file gives: meaning, unit and an example."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Requirements:
    """A requirement file, read.

    Attributes
    ----------
    asked : Asked
        What is asked.
    stock : Stock
        Sizes to choose from.
    materials : Materials
        Of the parts, as in a drive file.
    assumed_materials : dict of str to str
        Names of the materials of parts that were given none, by path (``"materials.disc"``, ``"ring.material"``).
    limits : dict of str to Limit
        ``[limits]``, as in a drive file.
    text : str
        What was read.
    """

    asked: Asked
    stock: Stock
    materials: Materials
    assumed_materials: dict[str, str]
    limits: Limits
    text: str
