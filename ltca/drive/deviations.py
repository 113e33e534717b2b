"""Deviations of real parts from their drawing: part of the drive's definition, all zero unless given.

Every deviation changes a shape or a place, which the geometry includes exactly; none adds a compliance. Angles are in the
frame of the body with the deviation, at crank angle zero.
"""

from __future__ import annotations

from dataclasses import fields
from typing import Annotated

from pydantic import ConfigDict, Field
from pydantic.dataclasses import dataclass

from ltca.drive.units.quantities import COUNT, grows, quantity

SignedLength = Annotated[float, quantity("mm")]
PositiveLength = Annotated[float, quantity("mm", gt=0.0)]
NonNegativeLength = Annotated[float, quantity("mm", ge=0.0)]
Angle = Annotated[float, quantity("rad")]
Number = Annotated[int, Field(ge=0, le=100), COUNT]
Errors = tuple[SignedLength, ...]

STRICT = ConfigDict(extra="forbid", strict=False, defer_build=True)


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class PlacementErrors:
    """Errors of the pins or holes of a circle, by part; an empty tuple means zero for all.

    Attributes
    ----------
    radial : tuple of float
        Outward along the radius of the circle the part stands on, mm.
    tangential : tuple of float
        Counter-clockwise, at a right angle to that radius, mm.
    diameter : tuple of float
        Actual less nominal diameter, mm.
    inclination_x, inclination_y : tuple of float
        Rotation of the part's axis about the x and y axes of the body that carries it, as those of the whole circle, rad.
    """

    radial: Errors = ()
    tangential: Errors = ()
    diameter: Errors = ()
    inclination_x: tuple[Angle, ...] = ()
    inclination_y: tuple[Angle, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class RollerErrors:
    """Errors of the rollers, by roller; an empty tuple means zero for all.

    A roller moves freely along the ray of its cage pocket, so there is no radial error.

    Attributes
    ----------
    tangential : tuple of float
        Counter-clockwise shift of the cage pocket on the roller pitch circle, mm.
    diameter : tuple of float
        Actual less nominal diameter, mm.
    """

    tangential: Errors = ()
    diameter: Errors = ()


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class BoreErrors:
    """Errors of the places of the bores of a disc for several cranks; an empty tuple means zero for all.

    Attributes
    ----------
    radial : tuple of float
        Outward along the radius of the crank circle, mm.
    tangential : tuple of float
        Counter-clockwise, at a right angle to that radius, mm.
    """

    radial: Errors = ()
    tangential: Errors = ()


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class AxisOffset:
    """Place of an axis in the fixed frame, whose origin is the centre of the pin shaft.

    Attributes
    ----------
    x : float
        Along the crank at crank angle zero, mm.
    y : float
        90° ahead of it, mm.
    """

    x: SignedLength = 0.0
    y: SignedLength = 0.0

    @property
    def place(self) -> complex:
        """The offset as a complex number, mm."""
        return complex(self.x, self.y)


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class Runout:
    """Centre of the flank against the bore of the disc (the full indicator reading is twice the amount).

    Attributes
    ----------
    amount : float
        Distance of the centres, mm; a negative one points the other way.
    angle : float
        Direction from the bore to the centre of the flank in the frame of the disc, rad.
    """

    amount: SignedLength = 0.0
    angle: Angle = 0.0


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class ProfileErrors:
    """Deviation of the flank along its normal over the parameter θ of Eq. 1, positive where metal is left, mm.

    Harmonics and measured points add up.

    Attributes
    ----------
    orders : tuple of int
        Waves around the disc, k of ``cosine cos kθ + sine sin kθ``.
    cosine : tuple of float
        Amplitudes of cos kθ, one for each order; an empty tuple means zero for all, mm.
    sine : tuple of float
        Amplitudes of sin kθ, likewise, mm.
    parameter : tuple of float
        Measured places θ, ascending in [0, 2π), rad; a root of the flank lies at 0.
    deviation : tuple of float
        Deviation measured there, mm; a periodic cubic spline joins them.
    """

    orders: tuple[Annotated[int, Field(ge=0, le=1000), COUNT], ...] = ()
    cosine: Errors = ()
    sine: Errors = ()
    parameter: tuple[Angle, ...] = ()
    deviation: Errors = ()

    @property
    def is_zero(self) -> bool:
        """Whether the flank is as designed."""
        return not (any(self.cosine) or any(self.sine) or any(self.deviation))


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class DiscClearance:
    """Clearances of one disc; those left out are the common ones of ``clearance``.

    Attributes
    ----------
    bearing : float or None
        Replaces ``clearance.bearing``, mm.
    pin_hole : float or None
        Replaces ``clearance.pin_hole``, mm.
    """

    bearing: NonNegativeLength | None = None
    pin_hole: NonNegativeLength | None = None


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class OneDisc:
    """An entry of ``[[disc.of]]``: one disc with its crank bearing.

    Attributes
    ----------
    runout : Runout or None
        Replaces ``disc.runout``.
    profile_errors : ProfileErrors or None
        Replaces ``disc.profile_errors``.
    hole_errors : PlacementErrors or None
        Replaces ``disc.hole_errors``.
    clearance : DiscClearance or None
        Clearances of the disc.
    roller_errors : RollerErrors or None
        Replaces ``crank_bearing.roller_errors``, at every crank.
    bore_errors : BoreErrors or None
        Errors of the places of the bores, one number per bore.
    lead_crown_drop : float or None
        Replaces ``disc.lead_crown_drop``, mm.
    lead_relief_length : float or None
        Replaces ``disc.lead_relief_length``, mm.
    lead_relief_depth : float or None
        Replaces ``disc.lead_relief_depth``, mm.
    lead_slope : float or None
        Replaces ``disc.lead_slope``, rad.
    """

    runout: Annotated[Runout | None, grows("disc")] = None
    profile_errors: Annotated[ProfileErrors | None, grows("disc")] = None
    hole_errors: Annotated[PlacementErrors | None, grows("disc")] = None
    clearance: Annotated[DiscClearance | None, grows("disc")] = None
    roller_errors: Annotated[RollerErrors | None, grows("roller")] = None
    bore_errors: Annotated[BoreErrors | None, grows("disc", radial=grows("disc", upon="crank.circle_radius"))] = None
    lead_crown_drop: Annotated[NonNegativeLength | None, grows("disc")] = None
    lead_relief_length: Annotated[NonNegativeLength | None, grows("disc")] = None
    lead_relief_depth: Annotated[NonNegativeLength | None, grows("disc")] = None
    lead_slope: Angle | None = None

    @property
    def of_bores_alone(self) -> bool:
        """Whether only places of bores are given, which replace no common value."""
        return all(getattr(self, item.name) is None for item in fields(self) if item.name != "bore_errors")


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class OneEccentric:
    """An entry of ``[[crank.of]]``: the eccentric of one disc on one crank.

    Attributes
    ----------
    disc : int or None
        Number of the disc. Left out, entry k is that of disc k on a central crank.
    crank : int or None
        Number of the crank, of several.
    eccentricity_error : float or None
        Replaces ``crank.eccentricity_error``, mm.
    phase_error : float
        Actual less nominal phase of the eccentric, counter-clockwise, rad.
    """

    disc: Number | None = None
    crank: Number | None = None
    eccentricity_error: Annotated[SignedLength | None, grows("eccentric", upon="crank.eccentricity")] = None
    phase_error: Angle = 0.0
