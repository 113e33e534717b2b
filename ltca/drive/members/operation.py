"""Installation and use of the drive: the fixed member, load, speed, duty, lubricant, friction, temperatures."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import field
from math import isnan, nan
from typing import Annotated, Any, Literal

from pydantic import WrapValidator
from pydantic.dataclasses import dataclass

from ltca.drive.deviations import STRICT, NonNegativeLength, SignedLength
from ltca.drive.fingerprints import HASHED_DEFAULT
from ltca.drive.units.quantities import grows, quantity

REFERENCE_TEMPERATURE = 20.0
"""Temperature at which lengths are given, °C (ISO 1)."""
Celsius = Annotated[float, quantity("°C", gt=-273.15, lt=1000.0)]
Coefficient = Annotated[float, quantity("dimensionless", ge=0.0, le=1.0)]


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class OuterForce:
    """Force from outside on the output, N.

    Attributes
    ----------
    x : float
        Along the crank at crank angle zero, N.
    y : float
        90° ahead of it, N.
    z : float
        Along the axis, N.
    """

    x: Annotated[float, quantity("N")] = 0.0
    y: Annotated[float, quantity("N")] = 0.0
    z: Annotated[float, quantity("N")] = 0.0


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class OuterMoment:
    """Tilting moment from outside on the output, N·mm; the one about the axis is the torque.

    Attributes
    ----------
    x : float
        About x, N·mm.
    y : float
        About y, N·mm.
    """

    x: Annotated[float, quantity("N*mm")] = 0.0
    y: Annotated[float, quantity("N*mm")] = 0.0


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class OuterPlace:
    """Point of the axis at which a force from outside acts.

    Attributes
    ----------
    z : float
        On the axis of ``disc.planes``, mm.
    """

    z: Annotated[SignedLength, grows("planes")] = 0.0


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class ExternalLoad:
    """An entry of ``[[load.external]]``: what an arm or a pulley does to the output; entries add up.

    Attributes
    ----------
    force : OuterForce
        Force on the output.
    moment : OuterMoment
        Tilting moment on the output, which the main bearing carries.
    at : OuterPlace
        Where the force acts.
    frame : {"housing", "output"}
        Frame of x and y: at rest with the held member, or turning with the output.
    """

    force: OuterForce = field(default_factory=OuterForce)
    moment: OuterMoment = field(default_factory=OuterMoment)
    at: Annotated[OuterPlace, grows("planes")] = field(default_factory=OuterPlace)
    frame: Literal["housing", "output"] = "housing"


LIGHT_SHARE = 0.03
"""Light torque as a part of the torque, where it is left out."""
LIGHT_WITHOUT_TORQUE = 10_000.0
"""Light torque of a load of 0, where it is left out, N·mm."""
LIGHT_DEFAULT = f"{100.0 * LIGHT_SHARE:g} % of load.torque"
"""Default of the light torque, for screens and messages."""


class DerivedLightTorque(float):
    """Light torque of a load that leaves it out, N·mm: `LIGHT_SHARE` of a torque, or `LIGHT_WITHOUT_TORQUE` for 0.

    A changed torque (``--torque``, a study, a duty) keeps it, so results at the light torque stay comparable.

    Attributes
    ----------
    written_torque : float
        Torque that the load was made with, N·mm.
    """

    __slots__ = ("written_torque",)

    written_torque: float

    @classmethod
    def of_torque(cls, torque: float) -> DerivedLightTorque:
        """Derive the light torque from a torque, N·mm."""
        derived = cls(LIGHT_SHARE * torque if torque > 0.0 else LIGHT_WITHOUT_TORQUE)
        derived.written_torque = torque
        return derived

    @property
    def origin(self) -> str:
        """Rule that the value follows from."""
        return f"{LIGHT_DEFAULT} as written" if self.written_torque > 0.0 else "load.torque is 0 as written"


def _kept_if_derived(value: Any, check: Callable[[Any], float]) -> float:
    """A derived value as it is, so that a replaced load still knows where it comes from; any other checked."""
    return value if isinstance(value, DerivedLightTorque) else check(value)


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class Load:
    """Load on the output.

    Attributes
    ----------
    torque : float
        Output torque T_out of all discs together, on the pin wheel or, where that is held, on the pin shaft, N·mm. 0 needs a
        drive without play at the output, whose parts hold each other.
    light_torque : float
        Light torque at which the transmission error is taken as the unloaded one, N·mm; left out, 3 % of ``load.torque`` as
        the case has it in its file, whatever replaces that later, or 10 N·m where it is 0.
    direction : {"ccw", "cw"}
        Sense in which the crank drives, against the load.
    speed : float or None
        Speed of the input, revolutions per minute; without it powers and slip speeds are not given.
    driven_by : {"input", "output"}
        Side that moves the drive: "output" loads the same flank, with reversed motion.
    external : tuple of ExternalLoad
        Forces and moments from outside on the output, beside the torque.
    """

    torque: Annotated[float, quantity("N*mm", ge=0.0)]
    # Hashes leave out the fixed default of earlier versions, so those of files that state it stay the same.
    light_torque: Annotated[float, quantity("N*mm", gt=0.0), WrapValidator(_kept_if_derived)] = field(
        default=nan, metadata={HASHED_DEFAULT: LIGHT_WITHOUT_TORQUE}
    )
    direction: Literal["ccw", "cw"] = "ccw"
    speed: Annotated[float, quantity("rpm", gt=0.0)] | None = None
    driven_by: Literal["input", "output"] = "input"
    external: tuple[ExternalLoad, ...] = ()

    def __post_init__(self) -> None:
        """Derive the light torque where it is left out."""
        if isnan(self.light_torque):
            object.__setattr__(self, "light_torque", DerivedLightTorque.of_torque(self.torque))

    @property
    def leaves_out_light_torque(self) -> bool:
        """Whether the light torque is derived because the file leaves it out."""
        return isinstance(self.light_torque, DerivedLightTorque)

    @property
    def light_torque_name(self) -> str:
        """Name of the light torque in messages, with the rule for one that is left out."""
        if not isinstance(self.light_torque, DerivedLightTorque):
            return "load.light_torque"
        zero = f"{LIGHT_WITHOUT_TORQUE:g} N·mm with load.torque = 0"
        rule = LIGHT_DEFAULT if self.light_torque.written_torque > 0.0 else zero
        return f"load.light_torque, left out and so {rule} as written,"

    @property
    def light_torque_words(self) -> str:
        """Value and origin of a light torque that is left out, and whether it exceeds the torque; empty for a given one."""
        if not isinstance(self.light_torque, DerivedLightTorque):
            return ""
        value = f"{self.light_torque / 1000.0:.6g} N·m"
        if self.light_torque > self.torque > 0.0:
            return (
                f"{value} ({self.light_torque.origin}) exceeds the torque {self.torque / 1000.0:.6g} N·m: results at the "
                "light torque are not those of a lightly loaded drive, load.light_torque states another"
            )
        comma = "," if self.light_torque.written_torque > 0.0 else ", and"
        return f"{value}: load.light_torque is left out{comma} {self.light_torque.origin}"


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class Duty:
    """One entry of the duty cycle of the drive, used for bearing lives alone.

    Attributes
    ----------
    torque : float
        Output torque of the entry, N·mm.
    speed : float
        Speed of the input, revolutions per minute.
    share : float
        Fraction of the time; those of all entries add up to one.
    """

    torque: Annotated[float, quantity("N*mm", gt=0.0)]
    speed: Annotated[float, quantity("rpm", gt=0.0)]
    share: Annotated[float, quantity("dimensionless", gt=0.0, le=1.0)]


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class Lubricant:
    """Lubricant between rollers and races, used for bearing lives alone.

    Attributes
    ----------
    viscosity : float
        Kinematic viscosity at operating temperature, mm²/s.
    contamination : float
        e_C of ISO 281, from 0 (badly contaminated) to 1 (of the utmost cleanliness).
    """

    viscosity: Annotated[float, quantity("mm²/s", gt=0.0)]
    contamination: Annotated[float, quantity("dimensionless", ge=0.0, le=1.0)]


Compliance = Literal["half-space", "fe", "hybrid"]
"""How the bodies of a drive yield, by the names of the engines (`ltca.analysis.engines`)."""
Bodies = Literal["plane", "solid"]
"""What bodies influence coefficients are of: plane sections, or solids with their ends."""


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class Analysis:
    """How a drive is analysed where a command or a call does not say otherwise.

    Attributes
    ----------
    compliance : {"half-space", "fe", "hybrid"}
        How the bodies yield: half-spaces, plane-strain finite elements, or half-spaces of finite length on finite elements.
        The same in all cases.
    bodies : {"plane", "solid"}
        Whether finite elements of ``fe`` and ``hybrid`` are those of plane sections, which yield evenly along the width, or of
        solid bodies with their ends. The same in all cases.
    """

    compliance: Compliance = "hybrid"
    bodies: Bodies = "plane"


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class Installation:
    """Installation of the drive.

    Attributes
    ----------
    held : {"pin-shaft", "pin-wheel"}
        The fixed member; ``load.torque`` acts on the other one, which is the output.
    first_stage_ratio : float or None
        z₂/z₁ of a first stage between a central input and several cranks; left out, the cranks are driven from the carrier.
    """

    held: Literal["pin-shaft", "pin-wheel"] = "pin-shaft"
    first_stage_ratio: Annotated[float, quantity("dimensionless", gt=0.0)] | None = None


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class Friction:
    """Coefficients of friction; each is 0 when left out.

    Attributes
    ----------
    pin : float
        μ of the flank on wheel pins, or on their sleeves.
    seat : float
        μ of pins in their slots, and of sleeves on the pins of wheel and shaft.
    hole : float
        μ of the holes on shaft pins, or on their sleeves.
    roller : float
        Rolling resistance f of the crank bearings, whose moment is f·|F_b|·(r_i + r_BR).
    support_bearing : float
        f of the bearings of cranks and wheel, whose moment is f times their load times ``support_bearing_radius``.
    support_bearing_radius : float
        Radius at which the friction of these bearings acts, mm.
    no_load_torque : float
        Torque of seals and oil at the input, N·mm.
    """

    pin: Coefficient = 0.0
    seat: Coefficient = 0.0
    hole: Coefficient = 0.0
    roller: Coefficient = 0.0
    support_bearing: Coefficient = 0.0
    support_bearing_radius: Annotated[NonNegativeLength, grows("eccentric")] = 0.0
    no_load_torque: Annotated[float, quantity("N*mm", ge=0.0)] = 0.0


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class Temperature:
    """Temperatures of the parts in operation; lengths are given at 20 °C.

    Attributes
    ----------
    housing : float
        Temperature of the wheel, its pins and their sleeves, °C.
    disc : float
        Temperature of the discs, °C.
    shaft : float
        Temperature of cranks, carrier and shaft pins, °C; rollers have the mean of disc and shaft.
    """

    housing: Celsius = REFERENCE_TEMPERATURE
    disc: Celsius = REFERENCE_TEMPERATURE
    shaft: Celsius = REFERENCE_TEMPERATURE
