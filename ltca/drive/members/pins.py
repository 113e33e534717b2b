"""Pins of the pin wheel and of the pin shaft: fixed, loose or sleeved, rigid or bending."""

from __future__ import annotations

from dataclasses import field
from typing import Annotated, Literal

from pydantic import Field, StrictBool
from pydantic.dataclasses import dataclass

from ltca.drive.deviations import STRICT, AxisOffset, PlacementErrors, PositiveLength
from ltca.drive.materials import LengthProfile
from ltca.drive.members.preload import Stiffness
from ltca.drive.members.width import Inclination
from ltca.drive.units.quantities import COUNT, grows

LARGEST_DEFAULT_CORE = 2.0
"""Radius of the rigid core of a wheel pin where a drive gives none, mm: at most `DEFAULT_CORE_SHARE` of the pin."""
DEFAULT_CORE_SHARE = 1.0 / 3.0
"""Largest part of the pin's radius that its core has by default, or a small pin would have no material left to deform."""


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class WheelPinSeat:
    """Seat of the wheel pins.

    Attributes
    ----------
    kind : {"fixed", "slot", "sleeve"}
        Fixed in the wheel; loose in a round slot; or fixed, with a loose sleeve that rolls on the flank.
    radius : float or None
        Radius r_s of the slot, with ``slot`` alone, mm.
    pin_radius : float or None
        Radius of the pin within the sleeve, with ``sleeve`` alone, mm; ``pin_wheel.pin_radius`` is the sleeve's outer radius.
    bore_radius : float or None
        Radius of the sleeve's bore, with ``sleeve`` alone, mm.
    """

    kind: Literal["fixed", "slot", "sleeve"] = "fixed"
    radius: Annotated[PositiveLength | None, grows("wheel")] = None
    pin_radius: Annotated[PositiveLength | None, grows("wheel_pin")] = None
    bore_radius: Annotated[PositiveLength | None, grows("wheel_sleeve")] = None


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class ShaftPinSeat:
    """Seat of the shaft pins.

    Attributes
    ----------
    kind : {"fixed", "sleeve"}
        Whether a loose sleeve runs on each pin.
    pin_radius : float or None
        Radius of the pin within the sleeve, with ``sleeve`` alone, mm; ``pin_shaft.pin_radius`` is the sleeve's outer radius.
    bore_radius : float or None
        Radius of the sleeve's bore, with ``sleeve`` alone, mm.
    """

    kind: Literal["fixed", "sleeve"] = "fixed"
    pin_radius: Annotated[PositiveLength | None, grows("shaft_pin")] = None
    bore_radius: Annotated[PositiveLength | None, grows("shaft_sleeve")] = None


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class WheelPinBeam:
    """A wheel pin as a beam between two walls of the wheel, its middle at the zero of ``disc.planes``.

    Attributes
    ----------
    span : float or None
        Distance of the walls, mm; when left out as long as the discs with the gaps between and beside them (``disc.gap``).
    ends : {"supported", "clamped"}
        Whether the ends may turn in the walls.
    diameter : float or None
        Diameter of the beam, mm; that of the seat's pin when left out.
    """

    span: Annotated[PositiveLength | None, grows("wheel")] = None
    ends: Literal["supported", "clamped"]
    diameter: Annotated[PositiveLength | None, grows("wheel_pin")] = None


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class ShaftPinBeam:
    """A shaft pin as a beam clamped in the flange at −span/2 of the axis of ``disc.planes``.

    Attributes
    ----------
    span : float or None
        Distance from the flange to the tip, mm; when left out as long as the discs with the gaps between and beside them
        (``disc.gap``).
    tip : {"free", "tied-clamped", "tied-pinned"}
        Free, or tied to the other tips by a rigid ring that floats: clamped in it, or free to turn.
    diameter : float or None
        Diameter of the beam, mm; that of the seat's pin when left out.
    """

    span: Annotated[PositiveLength | None, grows("carrier")] = None
    tip: Literal["free", "tied-clamped", "tied-pinned"]
    diameter: Annotated[PositiveLength | None, grows("shaft_pin")] = None


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class PinWheel:
    """Pin wheel, which carries the wheel pins.

    Attributes
    ----------
    number_of_pins : int
        Number of wheel pins z_P.
    pin_circle_radius : float
        Radius R_C of the circle of the wheel pins, mm.
    pin_radius : float
        Outer radius r_P at the flank, of the pin or of its sleeve, mm.
    pin_profile : LengthProfile
        Crown and relief of the wheel pins.
    core_radius : float or None
        Radius of the rigid core by which ``fe``, ``hybrid`` and full finite elements hold a wheel pin, mm; the smaller of 2 mm
        and r_P/3 when left out. Without effect on half-spaces, which have no bodies.
    pin_errors : PlacementErrors
        Errors of the wheel pins.
    axis_offset : AxisOffset
        Axis that the wheel turns about, relative to the centre of the pin shaft; a pin circle eccentric to that axis is given
        by ``pin_wheel.pin_errors``.
    inclination : Inclination
        Of the axis that the wheel turns about, and of all wheel pins with it.
    support_stiffness : float or None
        Radial stiffness of the wheel's main bearing, N/mm; rigid when left out.
    seat : WheelPinSeat
        Seat of the wheel pins.
    beam : WheelPinBeam or None
        Bending of the wheel pins; rigid when left out.
    """

    number_of_pins: Annotated[int, Field(ge=4, le=1000), COUNT]
    pin_circle_radius: Annotated[PositiveLength, grows("wheel")]
    pin_radius: Annotated[PositiveLength, grows("wheel_sleeve")]
    core_radius: Annotated[PositiveLength | None, grows("wheel_sleeve")] = None
    pin_profile: Annotated[LengthProfile, grows("wheel_sleeve")] = field(default_factory=LengthProfile)
    pin_errors: Annotated[PlacementErrors, grows("wheel", diameter=grows("wheel_sleeve"))] = field(
        default_factory=PlacementErrors
    )
    axis_offset: Annotated[AxisOffset, grows("wheel")] = field(default_factory=AxisOffset)
    inclination: Inclination = field(default_factory=Inclination)
    support_stiffness: Stiffness | None = None
    seat: WheelPinSeat = field(default_factory=WheelPinSeat)
    beam: WheelPinBeam | None = None

    @property
    def default_core_radius(self) -> float:
        """Radius of the rigid core of a wheel pin where the drive gives none, min(2 mm, r_P/3), mm."""
        return min(LARGEST_DEFAULT_CORE, DEFAULT_CORE_SHARE * self.pin_radius)

    @property
    def held_core_radius(self) -> float:
        """Radius of the rigid core of a wheel pin, mm."""
        return self.default_core_radius if self.core_radius is None else self.core_radius

    @property
    def seat_play(self) -> float:
        """Radial play of the pin in its seat, mm; 0 for fixed pins."""
        if self.seat.kind == "slot":
            return (self.seat.radius or 0.0) - self.pin_radius
        return (self.seat.bore_radius or 0.0) - (self.seat.pin_radius or 0.0) if self.seat.kind == "sleeve" else 0.0

    @property
    def beam_diameter(self) -> float:
        """Diameter of the bending pin, mm."""
        held = None if self.beam is None else self.beam.diameter
        return held or 2.0 * (self.seat.pin_radius or self.pin_radius)


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class PinShaft:
    """Pins of the pin shaft, the carrier of the cranks.

    Attributes
    ----------
    number_of_pins : int
        Number of shaft pins z_PS, also of the holes in the disc.
    pin_circle_radius : float
        Radius R_PS of the circle of shaft pins and holes alike, mm.
    pin_radius : float
        Outer radius r_PS in the hole, of the pin or of its sleeve, mm.
    hole_radius : float
        Nominal radius r_PSH of the holes in the disc (without clearance), mm.
    stiffness : float or None
        Stiffness k_PS of one pin for the full thickness of one disc, N/mm; left out where the pins are beams.
    elastic_contact : bool
        Whether the contact of pins and holes is elastic, in series with ``pin_shaft.stiffness`` or ``pin_shaft.beam``; rigid
        when false. Without effect on half-spaces, where the springs include everything that yields.
    pin_errors : PlacementErrors
        Errors of the shaft pins.
    inclination : Inclination
        Of all shaft pins.
    seat : ShaftPinSeat
        Seat of the shaft pins, with or without sleeves.
    beam : ShaftPinBeam or None
        Bending of the shaft pins, in place of ``pin_shaft.stiffness``.
    """

    number_of_pins: Annotated[int, Field(ge=3, le=200), COUNT]
    pin_circle_radius: Annotated[PositiveLength, grows("disc")]  # that of the holes
    pin_radius: Annotated[PositiveLength, grows("shaft_sleeve")]
    hole_radius: Annotated[PositiveLength, grows("disc")]
    stiffness: Stiffness | None = None
    elastic_contact: StrictBool = True
    pin_errors: Annotated[
        PlacementErrors,
        grows(
            "carrier",
            radial=grows("carrier", upon="pin_shaft.pin_circle_radius"),
            diameter=grows("shaft_sleeve"),
        ),
    ] = field(default_factory=PlacementErrors)
    inclination: Inclination = field(default_factory=Inclination)
    seat: ShaftPinSeat = field(default_factory=ShaftPinSeat)
    beam: ShaftPinBeam | None = None

    @property
    def seat_play(self) -> float:
        """Radial play of the sleeves on the pins, mm; 0 without sleeves."""
        return (self.seat.bore_radius or 0.0) - (self.seat.pin_radius or 0.0) if self.seat.kind == "sleeve" else 0.0

    @property
    def beam_diameter(self) -> float:
        """Diameter of the bending pin, mm."""
        held = None if self.beam is None else self.beam.diameter
        return held or 2.0 * (self.seat.pin_radius or self.pin_radius)
