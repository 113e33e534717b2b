"""Materials of the parts, linear-elastic, and their profiles along the length."""

from __future__ import annotations

from dataclasses import field
from typing import Annotated

from pydantic.dataclasses import dataclass

from ltca.drive.deviations import STRICT, NonNegativeLength, PositiveLength
from ltca.drive.units.quantities import quantity

STEEL = 190_000.0, 225_000.0
"""Young's moduli of steels, MPa: bearings are rated with rings and rollers of hardened bearing steel."""
HARDENED = 653.0
"""Least surface hardness of such rings, HV: the 58 HRC of makers' catalogues by ISO 18265."""


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class Material:
    """Linear-elastic material.

    Attributes
    ----------
    youngs_modulus : float
        Young's modulus E, MPa.
    poisson_ratio : float
        Poisson's ratio ν.
    allowable_pressure : float or None
        Largest contact pressure that the surface endures, MPa.
    yield_strength : float or None
        Yield strength, of hardened parts that of the core, MPa.
    bending_fatigue_limit : float or None
        Endurance limit: amplitude of fully reversed bending of smooth parts, MPa.
    hardness : float or None
        Hardness of the surface, HV.
    hardness_depth : float or None
        Depth of the hardened case, mm; hard throughout when left out.
    density : float or None
        Mass by volume, kg/m³.
    thermal_expansion : float or None
        Coefficient of linear thermal expansion, 1/K; used where the drive has temperatures.

    Notes
    -----
    Properties that may be left out change no load: results are judged by strength and hardness; masses and vibrations need the
    density.
    """

    youngs_modulus: Annotated[float, quantity("MPa", gt=0.0)] = 206_000.0
    poisson_ratio: Annotated[float, quantity("dimensionless", ge=0.0, lt=0.5)] = 0.3
    allowable_pressure: Annotated[float, quantity("MPa", gt=0.0)] | None = None
    yield_strength: Annotated[float, quantity("MPa", gt=0.0)] | None = None
    bending_fatigue_limit: Annotated[float, quantity("MPa", gt=0.0)] | None = None
    hardness: Annotated[float, quantity("dimensionless", gt=0.0)] | None = None
    hardness_depth: PositiveLength | None = None
    density: Annotated[float, quantity("kg/m³", gt=0.0)] | None = None
    thermal_expansion: Annotated[float, quantity("1/K", gt=-1e-3, lt=1e-3)] | None = None

    @property
    def plane_strain_compliance(self) -> float:
        """(1 − ν²)/E in 1/MPa, the part of one body in 1/E*."""
        return (1.0 - self.poisson_ratio**2) / self.youngs_modulus

    @property
    def is_bearing_steel(self) -> bool:
        """Whether ISO 76 and ISO 281 rate races of it: a steel, and hardened where its hardness is given."""
        return STEEL[0] <= self.youngs_modulus <= STEEL[1] and (self.hardness is None or self.hardness >= HARDENED)


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class Materials:
    """Material of each part.

    Attributes
    ----------
    disc : Material
        Material of the discs: flank, bores and holes.
    wheel_pin : Material
        Material of the wheel pins.
    roller : Material
        Material of the rollers of the crank bearings.
    inner_race : Material
        Material of the inner races of the crank bearings.
    shaft_pin : Material
        Material of the pins of the pin shaft.
    crankshaft : Material
        Material of the crankshaft, which bends between its bearings.
    wheel_seat : Material
        Material of the slots of loose wheel pins; with temperatures that of the wheel.
    sleeve : Material
        Material of the sleeves on wheel pins and shaft pins.
    carrier : Material
        Material of posts and flanges of the carrier; with temperatures that of the circle of shaft pins or cranks.
    """

    disc: Material = field(default_factory=Material)
    wheel_pin: Material = field(default_factory=Material)
    roller: Material = field(default_factory=Material)
    inner_race: Material = field(default_factory=Material)
    shaft_pin: Material = field(default_factory=Material)
    crankshaft: Material = field(default_factory=Material)
    wheel_seat: Material = field(default_factory=Material)
    sleeve: Material = field(default_factory=Material)
    carrier: Material = field(default_factory=Material)


PARTS = ("disc", "wheel_pin", "roller", "inner_race", "shaft_pin", "crankshaft", "wheel_seat", "sleeve", "carrier")
"""Fields of `Materials`."""
JUDGED_BY = ("allowable_pressure", "yield_strength", "bending_fatigue_limit", "hardness", "hardness_depth", "density")
"""Properties of a material that change no load."""
MAY_BE_UNKNOWN = (*JUDGED_BY, "thermal_expansion")
"""Fields of a material that may be left out."""


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
        1 is the profile of ISO 16281:2025.
    end_relief_length : float
        Length of the parabolic end relief at each end, mm.
    end_relief_depth : float
        Depth of the end relief at y = ±L/2, mm.
    """

    crown_drop: NonNegativeLength = 0.0
    logarithmic_factor: Annotated[float, quantity("dimensionless", ge=0.0, divides=True)] = 0.0
    end_relief_length: NonNegativeLength = 0.0
    end_relief_depth: NonNegativeLength = 0.0

    @property
    def is_cylinder(self) -> bool:
        """Whether the generator is straight to its ends."""
        relieved = self.end_relief_length > 0.0 and self.end_relief_depth > 0.0
        return self.crown_drop == 0.0 and self.logarithmic_factor == 0.0 and not relieved


def elastic_alone(materials: Materials) -> Materials:
    """Return materials with modulus and Poisson's ratio alone, which determine the loads at 20 °C."""
    bare = {}
    for part in PARTS:
        own: Material = getattr(materials, part)
        bare[part] = Material(youngs_modulus=own.youngs_modulus, poisson_ratio=own.poisson_ratio)
    return Materials(**bare)


def contact_modulus(first: Material, second: Material) -> float:
    """Return E* of two materials, MPa: 1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂ (Johnson, Eq. 4.18)."""
    return 1.0 / (first.plane_strain_compliance + second.plane_strain_compliance)
