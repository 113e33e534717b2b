"""Crankshafts: their eccentrics, the circle they stand on, their supports and their bearings."""

from __future__ import annotations

from cmath import rect
from dataclasses import field
from math import pi
from typing import Annotated

from pydantic import Field, StrictBool
from pydantic.dataclasses import dataclass

from ltca.drive.deviations import (
    STRICT,
    Angle,
    AxisOffset,
    OneEccentric,
    PositiveLength,
    RollerErrors,
    SignedLength,
)
from ltca.drive.materials import LengthProfile
from ltca.drive.members.preload import Force, LoadConstant, Preload, Stiffness
from ltca.drive.members.width import Inclination
from ltca.drive.units.quantities import COUNT, grows

LARGEST_DEFAULT_RACE_BORE = 10.0
"""Fixed bore of the inner race where a drive gives none, mm: at most `DEFAULT_RACE_BORE_SHARE` of the race."""
DEFAULT_RACE_BORE_SHARE = 0.6
"""Largest part of r_i that the fixed bore has by default, or a small race would have no material left to deform."""


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class CrankSupport:
    """A crankshaft as a beam on its two bearings in the carrier, the same for every crank.

    Attributes
    ----------
    diameter : float
        Diameter of the shaft between its bearings, mm.
    positions : tuple of float
        Axial places of the two bearings, on the axis of ``disc.planes``, mm.
    stiffness : tuple of float
        Radial stiffness of each of the two bearings, N/mm: with ``preload`` that while both sides carry, otherwise that of
        the side that carries. Left out with ``load_constant``.
    clearance : float or None
        Radial internal clearance of each of the two bearings, diametral as usual, mm; negative where they are tight.
    preload : Preload or None
        Preload of the two bearings: radial beside ``stiffness``, axial of the pair beside ``load_constant``.
    contact_angle : float or None
        Angle of the contact normals of two tapered roller bearings against the radial plane, rad; ``positions`` are then
        their pressure centres.
    load_constant : float or None
        K of F = K δ^(10/9), axial force by axial displacement of each tapered roller bearing, N/mmⁿ, in place of
        ``stiffness``; needs a preload.
    torsion : bool
        Whether the shaft twists between ``spline_plane`` and the eccentrics.
    spline_plane : float or None
        Axial place where the planet gear of the first stage, or whatever turns the crank, is fixed on the shaft, with
        ``torsion`` alone, mm.
    """

    diameter: PositiveLength
    positions: tuple[SignedLength, SignedLength]
    stiffness: tuple[Stiffness, ...] = ()
    clearance: SignedLength | None = None
    preload: Preload | None = None
    contact_angle: Angle | None = None
    load_constant: LoadConstant | None = None
    torsion: StrictBool = False
    spline_plane: SignedLength | None = None


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class Crank:
    """Crankshaft, or several alike on a circle of the pin shaft (the carrier).

    Attributes
    ----------
    eccentricity : float
        Eccentricity e, design distance from the crank axis to the inner-race centre, mm; the flank is generated with it.
    number : int
        Number of cranks; a single one stands in the centre.
    circle_radius : float or None
        Radius of the circle of several cranks, mm.
    angle : float
        Place of crank 0 on that circle, rad.
    support : CrankSupport or None
        Bending shaft and elastic bearings of the cranks; rigid when left out.
    eccentricity_error : float
        Actual less design eccentricity, mm.
    inclination : Inclination
        Of the axes that the cranks turn about.
    axis_offset : AxisOffset
        Crank axis, or the centre of the crank circle, against the centre of the pin shaft.
    of : tuple of OneEccentric
        Values per eccentric: one entry per disc for a central crank, entries with disc and crank for several.
    """

    eccentricity: Annotated[PositiveLength, grows("disc")]  # that of the flank
    number: Annotated[int, Field(ge=1, le=12), COUNT] = 1
    circle_radius: Annotated[PositiveLength | None, grows("carrier")] = None
    angle: Angle = 0.0
    support: Annotated[CrankSupport | None, grows("eccentric")] = None
    eccentricity_error: Annotated[SignedLength, grows("eccentric", upon="crank.eccentricity")] = 0.0
    axis_offset: Annotated[AxisOffset, grows("carrier")] = field(default_factory=AxisOffset)
    inclination: Inclination = field(default_factory=Inclination)
    of: tuple[OneEccentric, ...] = ()

    @property
    def places(self) -> tuple[complex, ...]:
        """Axis of each crank from the centre of its circle, mm: also the places of the bores from the centre of the disc."""
        if self.number == 1:
            return (0j,)
        return tuple(
            rect(self.circle_radius or 0.0, self.angle + 2.0 * pi * c / self.number) for c in range(self.number)
        )

    def eccentric(self, disc: int, crank: int = 0) -> OneEccentric:
        """Return the entry of the eccentric of a disc on a crank, an empty one where there is none."""
        return self.entries.get((disc, crank), OneEccentric())

    @property
    def entries(self) -> dict[tuple[int, int], OneEccentric]:
        """Entries of `of` by disc and crank."""
        return {
            (place if entry.disc is None else entry.disc, entry.crank or 0): entry
            for place, entry in enumerate(self.of)
        }


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class CrankBearing:
    """Cylindrical-roller bearing between crank and disc, the same at every crank; the disc bore is its outer race.

    Attributes
    ----------
    inner_race_radius : float
        Radius r_i of the inner race, mm.
    outer_race_radius : float
        Nominal radius r_o of the bore of the disc, which is the outer race (without clearance), mm.
    number_of_rollers : int
        Number of rollers n_BR of one bearing.
    roller_radius : float
        Radius r_BR of the rollers, mm.
    race_bore_radius : float or None
        Radius of the fixed bore by which ``fe``, ``hybrid`` and full finite elements hold the inner race, mm; the smaller of
        10 mm and 0.6 r_i when left out. Without effect on half-spaces, which have no bodies.
    roller_length : float or None
        Length of the rollers, at most the thickness of the disc, mm; as long as that when left out.
    roller_profile : LengthProfile
        Crown and relief of the rollers.
    roller_errors : RollerErrors
        Diameter and pocket errors of the rollers.
    dynamic_load_rating : float or None
        Rating C of the maker, for lives alone, N; by ISO 281 from the rollers when left out.
    static_load_rating : float or None
        Rating C_0 of the maker, for the static safety and the fatigue load limit alone, N; by ISO 76 from the rollers when
        left out.
    """

    inner_race_radius: Annotated[PositiveLength, grows("race")]
    outer_race_radius: Annotated[PositiveLength, grows("disc")]
    number_of_rollers: Annotated[int, Field(ge=3, le=500), COUNT]
    roller_radius: Annotated[PositiveLength, grows("roller")]
    race_bore_radius: Annotated[PositiveLength | None, grows("race")] = None
    roller_length: Annotated[PositiveLength | None, grows("roller")] = None
    roller_profile: Annotated[LengthProfile, grows("roller")] = field(default_factory=LengthProfile)
    roller_errors: Annotated[RollerErrors, grows("roller")] = field(default_factory=RollerErrors)
    dynamic_load_rating: Force | None = None
    static_load_rating: Force | None = None

    @property
    def default_race_bore_radius(self) -> float:
        """Radius of the fixed bore of the inner race where the drive gives none, min(10 mm, 0.6 r_i), mm."""
        return min(LARGEST_DEFAULT_RACE_BORE, DEFAULT_RACE_BORE_SHARE * self.inner_race_radius)

    @property
    def held_bore_radius(self) -> float:
        """Radius of the fixed bore of the inner race, mm."""
        return self.default_race_bore_radius if self.race_bore_radius is None else self.race_bore_radius
