"""The drive: validated, frozen definitions of its parts, clearances and load (mm, N, MPa, N·mm, rad).

`Drive` is one complete drive in one case; `load_drive` in `ltca.reading.drive_file` reads a TOML file with its
cases, `ltca.reading.physical_checks` holds the physical checks.
"""

from __future__ import annotations

import hashlib
from dataclasses import asdict, field
from typing import Annotated, Any, Literal

from pydantic import Field
from pydantic.dataclasses import dataclass

from ltca.drive.deviations import (
    STRICT,
    AxisOffset,
    PlacementErrors as PlacementErrors,
    ProfileErrors as ProfileErrors,
    RollerErrors as RollerErrors,
    Runout as Runout,
    SignedLength,
)
from ltca.drive.names import Name
from ltca.drive.units import COUNT, quantity

PositiveLength = Annotated[float, quantity("mm", gt=0.0)]
NonNegativeLength = Annotated[float, quantity("mm", ge=0.0)]


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class Material:
    """Linear-elastic material.

    Attributes
    ----------
    youngs_modulus : float
        MPa.
    poisson_ratio : float
        Between 0 and 0.5.
    """

    youngs_modulus: Annotated[float, quantity("MPa", gt=0.0)] = 206_000.0
    poisson_ratio: Annotated[float, quantity("dimensionless", ge=0.0, lt=0.5)] = 0.3

    @property
    def plane_strain_compliance(self) -> float:
        """(1 − ν²)/E in 1/MPa, the part of one body in 1/E*."""
        return (1.0 - self.poisson_ratio**2) / self.youngs_modulus


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class Materials:
    """Material of each part."""

    disc: Material = field(default_factory=Material)
    wheel_pin: Material = field(default_factory=Material)
    roller: Material = field(default_factory=Material)
    inner_race: Material = field(default_factory=Material)
    shaft_pin: Material = field(default_factory=Material)


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class LengthProfile:
    """Drop of a roller or pin generator from its cylinder toward the ends.

    The terms add up; all zero is an uncrowned cylinder. With y from mid-length and L the length:

    Attributes
    ----------
    crown_drop : float
        Parabolic crown, drop at y = ±L/2, mm: ``crown_drop (2y/L)²``.
    logarithmic_factor : float
        Factor of the logarithmic profile ``factor · 0.00035 D ln(1/(1 − (2y/L)²))`` with D the diameter;
        1 is the profile of ISO/TS 16281.
    end_relief_length : float
        Length of the parabolic end relief at each end, mm.
    end_relief_depth : float
        Its depth at y = ±L/2, mm.
    """

    crown_drop: NonNegativeLength = 0.0
    logarithmic_factor: Annotated[float, quantity("dimensionless", ge=0.0)] = 0.0
    end_relief_length: NonNegativeLength = 0.0
    end_relief_depth: NonNegativeLength = 0.0

    @property
    def is_cylinder(self) -> bool:
        """Whether the generator is straight to its ends."""
        relieved = self.end_relief_length > 0.0 and self.end_relief_depth > 0.0
        return self.crown_drop == 0.0 and self.logarithmic_factor == 0.0 and not relieved


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class Crank:
    """Crankshaft.

    Attributes
    ----------
    eccentricity : float
        e, design distance from the crank axis to the inner-race centre, mm; the flank is generated with it.
    eccentricity_error : float
        Actual less design eccentricity, mm.
    axis_offset : AxisOffset
        Crank axis against the centre of the pin shaft.
    """

    eccentricity: PositiveLength
    eccentricity_error: SignedLength = 0.0
    axis_offset: AxisOffset = field(default_factory=AxisOffset)


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class PinWheel:
    """Pin wheel: `number_of_pins` z_P, `pin_circle_radius` R_C and `pin_radius` r_P in mm.

    `axis_offset` is the axis the wheel turns about against the centre of the pin shaft; a pin circle eccentric to
    that axis is a matter of `pin_errors`.
    """

    number_of_pins: Annotated[int, Field(ge=4, le=1000), COUNT]
    pin_circle_radius: PositiveLength
    pin_radius: PositiveLength
    pin_profile: LengthProfile = field(default_factory=LengthProfile)
    pin_errors: PlacementErrors = field(default_factory=PlacementErrors)
    axis_offset: AxisOffset = field(default_factory=AxisOffset)


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class Disc:
    """Cycloid disc.

    Attributes
    ----------
    number_of_teeth : int
        z_C.
    thickness : float
        Thickness of one disc, mm.
    number_of_discs : int
        Discs that share the torque.
    torque_share : float
        Part of the torque that the analysed disc carries; 1/number_of_discs unless given.
    equidistant_offset : float
        Δr_P: the flank is generated with pins of radius r_P + Δr_P, mm (Eq. 1).
    shifting_offset : float
        ΔR_C: the flank is generated on the pin circle R_C + ΔR_C, mm (Eq. 1).
    hole_errors : PlacementErrors
        Errors of the pin holes.
    profile_errors : ProfileErrors
        Deviation of the flank along its normal.
    runout : Runout
        Centre of the flank against the bore.
    """

    number_of_teeth: Annotated[int, Field(ge=3, le=1000), COUNT]
    thickness: PositiveLength
    number_of_discs: Annotated[int, Field(ge=1, le=10), COUNT] = 1
    torque_share: Annotated[float, quantity("dimensionless", gt=0.0, le=1.0)] = 1.0
    equidistant_offset: SignedLength = 0.0
    shifting_offset: SignedLength = 0.0
    hole_errors: PlacementErrors = field(default_factory=PlacementErrors)
    profile_errors: ProfileErrors = field(default_factory=ProfileErrors)
    runout: Runout = field(default_factory=Runout)


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class CrankBearing:
    """Cylindrical-roller bearing between crank and disc; the disc bore is its outer race.

    Attributes
    ----------
    inner_race_radius, outer_race_radius : float
        r_i and the nominal r_o (without clearance), mm.
    number_of_rollers : int
        n_BR.
    roller_radius, roller_length : float
        mm.
    roller_profile : LengthProfile
        Crown and relief of the rollers.
    roller_errors : RollerErrors
        Diameter and pocket errors of the rollers.
    """

    inner_race_radius: PositiveLength
    outer_race_radius: PositiveLength
    number_of_rollers: Annotated[int, Field(ge=3, le=500), COUNT]
    roller_radius: PositiveLength
    roller_length: PositiveLength
    roller_profile: LengthProfile = field(default_factory=LengthProfile)
    roller_errors: RollerErrors = field(default_factory=RollerErrors)


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class PinShaft:
    """Pin shaft, fixed in the housing.

    Attributes
    ----------
    number_of_pins : int
        z_PS, also the number of holes in the disc.
    pin_circle_radius : float
        R_PS, of pins and holes alike, mm.
    pin_radius, hole_radius : float
        r_PS and the nominal r_PSH (without clearance), mm.
    stiffness : float
        k_PS of one pin for the full thickness of one disc, N/mm.
    pin_errors : PlacementErrors
        Errors of the shaft pins.
    """

    number_of_pins: Annotated[int, Field(ge=3, le=200), COUNT]
    pin_circle_radius: PositiveLength
    pin_radius: PositiveLength
    hole_radius: PositiveLength
    stiffness: Annotated[float, quantity("N/mm", gt=0.0)]
    pin_errors: PlacementErrors = field(default_factory=PlacementErrors)


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class Clearance:
    """Clearances.

    Attributes
    ----------
    bearing : float
        Radial internal clearance of the crank bearing, diametral as usual: half of it widens the bore, mm.
    pin_hole : float
        Added whole to r_PSH − r_PS, mm.
    """

    bearing: NonNegativeLength = 0.0
    pin_hole: NonNegativeLength = 0.0


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class Load:
    """Load on the output.

    Attributes
    ----------
    torque : float
        Output torque T_out on the pin wheel, all discs together, N·mm.
    light_torque : float
        Torque whose transmission error stands for the unloaded one, N·mm.
    direction : {"ccw", "cw"}
        Sense in which the crank drives; the load opposes it.
    """

    torque: Annotated[float, quantity("N*mm", gt=0.0)]
    light_torque: Annotated[float, quantity("N*mm", gt=0.0)] = 10_000.0
    direction: Literal["ccw", "cw"] = "ccw"


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class Drive:
    """One drive in one case, complete.

    Attributes
    ----------
    name : str
        Name of the drive.
    crank, pin_wheel, disc, crank_bearing, pin_shaft : dataclass
        The parts.
    load : Load
        Torque and direction.
    clearance : Clearance
        Bearing and pin-hole clearance.
    materials : Materials
        Material of each part.
    """

    name: Name = "drive"
    crank: Crank
    pin_wheel: PinWheel
    disc: Disc
    crank_bearing: CrankBearing
    pin_shaft: PinShaft
    load: Load
    clearance: Clearance = field(default_factory=Clearance)
    materials: Materials = field(default_factory=Materials)

    @property
    def tooth_number_difference(self) -> int:
        """Δz = z_P − z_C."""
        return self.pin_wheel.number_of_pins - self.disc.number_of_teeth

    @property
    def reduction_ratio(self) -> float:
        """u = z_P/Δz, pin shaft fixed."""
        return self.pin_wheel.number_of_pins / self.tooth_number_difference

    @property
    def driving_sign(self) -> int:
        """+1 for a crank driving counter-clockwise, −1 clockwise."""
        return 1 if self.load.direction == "ccw" else -1

    def wheel_moment(self, torque: float | None = None) -> float:
        """Return the external moment on the wheel of the analysed disc, ccw positive, N·mm.

        Parameters
        ----------
        torque : float, optional
            Output torque of the whole drive, N·mm; the drive's own by default.

        Returns
        -------
        float
            −T_out · torque_share for a crank driving counter-clockwise.
        """
        total = self.load.torque if torque is None else torque
        return -self.driving_sign * total * self.disc.torque_share

    def load_words(self, torque: float | None = None) -> str:
        """Return torque and direction for the heading of a table.

        Parameters
        ----------
        torque : float, optional
            Output torque of the whole drive, N·mm; the drive's own by default.
        """
        total = self.load.torque if torque is None else torque
        return f"{total / 1000.0:.6g} N·m {self.load.direction}"

    @property
    def bore_radius(self) -> float:
        """Outer-race radius with half the diametral bearing clearance, mm."""
        return self.crank_bearing.outer_race_radius + 0.5 * self.clearance.bearing

    @property
    def hole_radius(self) -> float:
        """Pin-hole radius with the pin-hole clearance, mm."""
        return self.pin_shaft.hole_radius + self.clearance.pin_hole

    def fingerprint(self) -> str:
        """Return a hash of everything that defines the drive in this case (hex, 16 digits)."""
        return _hash(asdict(self))

    def body_shape(self) -> dict[str, float]:
        """Return every number that plane finite-element bodies of the drive are made of: what their compliance belongs to.

        Bore and holes are as wide as they are, clearances included. Errors of single parts never enter. What no plane body
        has is left out: load, name, lengths and profiles along the length, numbers of rollers and discs, and all of the
        shaft pins but their number and circle, which are those of the holes.

        Returns
        -------
        dict of str to float
            By field, or by the name of what several fields make: mm, MPa, counts.
        """
        wheel, disc, bearing, shaft = self.pin_wheel, self.disc, self.crank_bearing, self.pin_shaft
        shape = {
            "crank.eccentricity": self.crank.eccentricity,
            "pin_wheel.number_of_pins": float(wheel.number_of_pins),
            "pin_wheel.pin_radius": wheel.pin_radius,
            "generating_circle_radius": wheel.pin_circle_radius + disc.shifting_offset,
            "generating_pin_radius": wheel.pin_radius + disc.equidistant_offset,
            "disc.number_of_teeth": float(disc.number_of_teeth),
            "disc.thickness": disc.thickness,
            "crank_bearing.inner_race_radius": bearing.inner_race_radius,
            "crank_bearing.roller_radius": bearing.roller_radius,
            "bore_radius": self.bore_radius,
            "pin_shaft.number_of_pins": float(shaft.number_of_pins),
            "pin_shaft.pin_circle_radius": shaft.pin_circle_radius,
            "hole_radius": self.hole_radius,
        }
        for part in ("disc", "wheel_pin", "roller", "inner_race"):
            material: Material = getattr(self.materials, part)
            shape[f"materials.{part}.youngs_modulus"] = material.youngs_modulus
            shape[f"materials.{part}.poisson_ratio"] = material.poisson_ratio
        # Sums of radii and clearances must not differ by their rounding.
        return {name: float(f"{value:.12g}") for name, value in shape.items()}

    def shape_fingerprint(self) -> str:
        """Return a hash of `body_shape` (hex, 16 digits): influence coefficients of the bodies belong to it."""
        return _hash(self.body_shape())


def _hash(definition: dict[str, Any]) -> str:
    return hashlib.sha256(repr(definition).encode()).hexdigest()[:16]


def contact_modulus(first: Material, second: Material) -> float:
    """Return E* of two materials, MPa: 1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂ (Johnson, Eq. 4.18)."""
    return 1.0 / (first.plane_strain_compliance + second.plane_strain_compliance)
