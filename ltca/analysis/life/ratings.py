"""What a row of cylindrical rollers bears by its size: ISO 281, the races apart by ISO 16281:2025, at rest by ISO 76."""

from __future__ import annotations

from dataclasses import dataclass

from ltca.drive.materials import HARDENED, STEEL
from ltca.drive.parts import Drive

EDGE_ALLOWANCE = 0.83
"""λν of ISO 16281:2025: the part of the rating of ISO 281 that allows for edge stress, taken out where it is reckoned."""
BEARING_STEEL = 1.1
"""b_m of ISO 281 for radial cylindrical roller bearings."""
INNER_SHARE, OUTER_SHARE = 0.378, 0.364
"""Radial load by Z times the equivalent roller load of a race that turns and of one that stands (ISO 16281:2025)."""
STATIC_RATING_FACTOR = 44.0
"""Factor of the static rating of radial roller bearings, N/mm² (ISO 76)."""
FATIGUE_LIMIT_RATIO = 8.2
"""Static rating by the fatigue load limit C_u of roller bearings (ISO 281, B.3.3)."""
LARGE_PITCH_DIAMETER = 100.0
"""Pitch diameter above which C_u falls behind, mm."""


def not_rated(drive: Drive) -> tuple[str, ...]:
    """Return why ISO 281 and ISO 76 rate no crank bearing of a drive, one sentence for each part; empty where they do.

    Parameters
    ----------
    drive : Drive
        The drive.

    Examples
    --------
    >>> from ltca.reading.drive_file import load_drive
    >>> not_rated(load_drive("paper").cases["CS-1"])
    ()
    """
    told = []
    for part in ("inner_race", "roller", "disc"):
        material = getattr(drive.materials, part)
        if not STEEL[0] <= material.youngs_modulus <= STEEL[1]:
            told.append(f"materials.{part}.youngs_modulus = {material.youngs_modulus:g} MPa: no bearing steel")
        elif material.hardness is not None and material.hardness < HARDENED:
            told.append(
                f"materials.{part}.hardness = {material.hardness:g} HV: less than {HARDENED:g} HV, of hardened rings"
            )
    return tuple(told)


@dataclass(frozen=True, slots=True, kw_only=True)
class RaceRatings:
    """Roller loads that the races bear for a million turns.

    Attributes
    ----------
    inner, outer : float
        Q_ci and Q_ce, N.
    """

    inner: float
    outer: float

    def life(self, inner_load: float, outer_load: float) -> float:
        """Return L_10r = ((Q_i/Q_ci)^4.5 + (Q_e/Q_ce)^4.5)^(−8/9) in millions of turns; infinite without load.

        Parameters
        ----------
        inner_load, outer_load : float
            Equivalent roller loads, N.
        """
        spent = (inner_load / self.inner) ** 4.5 + (outer_load / self.outer) ** 4.5
        return spent ** (-8.0 / 9.0) if spent > 0.0 else float("inf")


@dataclass(frozen=True, slots=True, kw_only=True)
class RollerBearing:
    """A row of cylindrical rollers, as ISO 281 sees it.

    Attributes
    ----------
    rollers : int
        Z.
    roller_diameter, roller_length : float
        D_we and L_we, mm.
    pitch_diameter : float
        D_pw, mm.
    """

    rollers: int
    roller_diameter: float
    roller_length: float
    pitch_diameter: float

    @classmethod
    def of_drive(cls, drive: Drive) -> RollerBearing:
        """Return the crank bearing of a drive."""
        part = drive.crank_bearing
        return cls(
            rollers=part.number_of_rollers,
            roller_diameter=2.0 * part.roller_radius,
            roller_length=drive.roller_length,
            pitch_diameter=part.inner_race_radius + part.outer_race_radius,
        )

    @property
    def slenderness(self) -> float:
        """γ = D_we/D_pw of a radial bearing."""
        return self.roller_diameter / self.pitch_diameter

    @property
    def race_ratio(self) -> float:
        """1.038 ((1 − γ)/(1 + γ))^(143/108), rating of the inner by that of the outer race under a standing load."""
        g = self.slenderness
        return 1.038 * float(((1.0 - g) / (1.0 + g)) ** (143.0 / 108.0))

    @property
    def geometry_factor(self) -> float:
        """f_c of ISO 281 (Table 7 tabulates it), by the formula of ISO/TR 1281-1."""
        g = self.slenderness
        races = 1.04 * ((1.0 - g) / (1.0 + g)) ** (143.0 / 108.0)
        shape = g ** (2.0 / 9.0) * (1.0 - g) ** (29.0 / 27.0) / (1.0 + g) ** 0.25
        return float(207.9 * EDGE_ALLOWANCE * shape * (1.0 + races**4.5) ** (-2.0 / 9.0))

    @property
    def dynamic_load_rating(self) -> float:
        """C_r = b_m f_c L_we^(7/9) Z^(3/4) D_we^(29/27), N (ISO 281, one row, α = 0)."""
        size = self.roller_length ** (7.0 / 9.0) * self.rollers**0.75 * self.roller_diameter ** (29.0 / 27.0)
        return float(BEARING_STEEL * self.geometry_factor * size)

    @property
    def static_load_rating(self) -> float:
        """C_0r = 44 (1 − γ) Z L_we D_we, N (ISO 76, one row, α = 0)."""
        return (
            STATIC_RATING_FACTOR * (1.0 - self.slenderness) * self.rollers * self.roller_length * self.roller_diameter
        )

    @property
    def fatigue_load_limit(self) -> float:
        """C_u = C_0/8.2, less by (100 mm/D_pw)^0.3 above a pitch diameter of 100 mm, N (ISO 281, B.3.3)."""
        size = max(self.pitch_diameter / LARGE_PITCH_DIAMETER, 1.0)
        return float(self.static_load_rating / FATIGUE_LIMIT_RATIO * size**-0.3)

    def race_ratings(self, dynamic_load_rating: float | None = None) -> RaceRatings:
        """Return Q_ci and Q_ce of ISO 16281:2025: C_r/(0.378 λν Z) and C_r/(0.364 λν Z) with their parts of the joined life.

        Parameters
        ----------
        dynamic_load_rating : float, optional
            C_r of the maker, N; by ISO 281 otherwise.
        """
        capacity = self.dynamic_load_rating if dynamic_load_rating is None else dynamic_load_rating
        share, ratio = capacity / (EDGE_ALLOWANCE * self.rollers), self.race_ratio
        return RaceRatings(
            inner=share / INNER_SHARE * float((1.0 + ratio**4.5) ** (2.0 / 9.0)),
            outer=share / OUTER_SHARE * float((1.0 + ratio**-4.5) ** (2.0 / 9.0)),
        )
