"""Roller bearings: the load zone, ratings, and the life of ISO 16281 in its limits."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import quad

from ltca.analysis.life.equivalent_load import race_load
from ltca.analysis.life.laminae import EvenLaminae, edge_factors
from ltca.analysis.life.ratings import INNER_SHARE, OUTER_SHARE, RollerBearing
from ltca.arrays import FloatArray
from ltca.geometry.length_profile import LOGARITHMIC, Relief
from ltca.geometry.pair_motion import RollerRays
from ltca.laws.contact_law import ContactLaw
from ltca.reading.drive_file import load_drive
from ltca.testing.bearing_alone import RollerLaws, bearing_alone
from validation.manual.case import Case, Figure, Reference, absolute_figure, relative_figure

ROUND_OFF = "round-off"


# Load zone


@dataclass(frozen=True, slots=True, kw_only=True)
class PowerLaw(ContactLaw):
    """A contact that yields by a power of its load, as bearing books have it.

    Attributes
    ----------
    factor : float
        K, N/mmⁿ.
    exponent : float
        n.
    """

    factor: float
    exponent: float = 1.1

    def load_and_stiffness(self, approach: ArrayLike, effective_radius: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Return the load at an approach and its derivative, N and N/mm."""
        pressed = np.maximum(np.asarray(approach, dtype=float), 0.0) + 0.0 * np.asarray(effective_radius, dtype=float)
        stiffness = self.factor * self.exponent * pressed ** (self.exponent - 1.0)
        return np.asarray(self.factor * pressed**self.exponent), np.asarray(stiffness)


LOAD_INTEGRALS = {0.3: 0.2055, 0.4: 0.2286, 0.5: 0.2453, 0.6: 0.2568}
"""J_r for line contact by ε (table 7.1)."""


def load_zone(epsilon: float, rollers: int) -> tuple[float, float, float]:
    """Return J_r, Z Q_max/F_r, and Q_max by that of both contacts in series, of a bearing with races displaced by 1 µm."""
    deflection, n, stiff = 1e-3, 1.1, (8e5, 1.3e6)
    play = (1.0 - 2.0 * epsilon) * deflection  # P_d/2, negative: preload
    rays = RollerRays(
        direction=np.exp(2j * np.pi * np.arange(rollers) / rollers)[None, :],
        outermost=np.full(rollers, 24.5),
        bore_play=np.full(rollers, 24.5 + play),
    )
    radius = np.ones(rollers)
    inner, outer = (PowerLaw(factor=factor) for factor in stiff)
    state = bearing_alone(rays, np.array([-deflection + 0j]), RollerLaws(inner, outer, radius, radius)).parts[0].rollers
    force = float((state.outer_load * state.outer_direction).sum().real)
    largest = float(sum(k ** (-1.0 / n) for k in stiff) ** -n * (deflection - play) ** n)
    return force / (rollers * largest), largest * rollers / force, float(state.outer_load.max()) / largest


def _load_zone() -> list[Figure]:
    figures = []
    for epsilon, printed in LOAD_INTEGRALS.items():
        coarse, fine = (load_zone(epsilon, rollers) for rollers in (1000, 2000))
        figures.append(
            absolute_figure(
                f"load integral J_r at ε = {epsilon:g}", fine[0], printed, "", 1e-4,
                "one unit of the last printed digit; obliquity of 1e-3 mm on 24.5 mm is below that",
                numerical_error=abs(fine[0] - coarse[0]), numerical_origin="change from 1000 to 2000 rollers",
                reference_error=5e-5,
            )
        )  # fmt: skip
        figures.append(
            relative_figure(
                f"largest load by that of both contacts in series, ε = {epsilon:g}", fine[2], 1.0, "", 1e-6,
                "obliquity, second order of displacement by radius", numerical_error=1e-9,
                numerical_origin="tolerance of the balance of each roller",
            )
        )  # fmt: skip
        if epsilon == 0.5:
            figures.append(
                absolute_figure(
                    "Z Q_max/F_r without clearance", fine[1], 4.08, "", 5e-3, "half a unit of the last printed digit",
                    numerical_error=abs(fine[1] - coarse[1]), numerical_origin="change from 1000 to 2000 rollers",
                    reference_error=5e-3,
                )
            )  # fmt: skip
    return figures


# Ratings

GEOMETRY_FACTORS = {
    0.01: 52.1, 0.02: 60.8, 0.03: 66.5, 0.04: 70.7, 0.05: 74.1, 0.06: 76.9, 0.07: 79.2, 0.08: 81.2, 0.09: 82.8,
    0.10: 84.2, 0.12: 86.4, 0.14: 87.7, 0.16: 88.5, 0.18: 88.8, 0.20: 88.7, 0.22: 88.2, 0.24: 87.5, 0.26: 86.4,
    0.28: 85.2, 0.30: 83.8,
}  # fmt: skip
"""f_c of radial roller bearings by D_we cos α/D_pw (ISO 281:2007, Table 7)."""


def _bearing(slenderness: float, rollers: int = 20, pitch_diameter: float = 100.0) -> RollerBearing:
    return RollerBearing(
        rollers=rollers, roller_diameter=pitch_diameter * slenderness, roller_length=10.0, pitch_diameter=pitch_diameter
    )


def _ratings() -> list[Figure]:
    figures = [
        absolute_figure(
            f"f_c at D_we/D_pw = {slenderness:g}", _bearing(slenderness).geometry_factor, factor, "", 0.11,
            "the table has three digits; its own smoothing is another tenth", numerical_error=1e-12,
            numerical_origin=ROUND_OFF, reference_error=0.05,
        )
        for slenderness, factor in GEOMETRY_FACTORS.items()
    ]  # fmt: skip
    found = RollerBearing.of_drive(load_drive("paper").cases["CS-1"])
    by_hand = 1.1 * 88.65 * 11.8 ** (7 / 9) * 11**0.75 * 10 ** (29 / 27)
    return [
        *figures,
        relative_figure(
            "C_r of the paper's crank bearing, 11 rollers 10 × 11.8 on 49 mm", found.dynamic_load_rating, by_hand, "N", 1e-3,
            "f_c by hand between two rows of the table", numerical_error=1e-12, numerical_origin=ROUND_OFF, reference_error=1e-3,
        ),
        absolute_figure(
            "C_0r, 44 (1 − 10/49) · 11 · 11.8 · 10", found.static_load_rating, 45_456.49, "N", 0.01, "by hand to 0.01 N",
            numerical_error=1e-9, numerical_origin=ROUND_OFF, reference_error=0.005,
        ),
        absolute_figure(
            "C_u, C_0r/8.2", found.fatigue_load_limit, 45_456.49 / 8.2, "N", 0.01, "by hand to 0.01 N", numerical_error=1e-9,
            numerical_origin=ROUND_OFF, reference_error=0.005,
        ),
    ]  # fmt: skip


# ISO 16281


def _zone_mean(power: float) -> float:
    """Mean of cos to a power over half the circle, by the whole circle."""
    return float(quad(lambda psi: np.cos(psi) ** power, -np.pi / 2, np.pi / 2)[0]) / (2.0 * np.pi)


def life_at_the_rating(turns: int) -> float:
    """Return the life in millions of turns at P = C without edge stress and its allowance: inner race turning, standing load."""
    part, positions, cage = _bearing(0.15), 60, 0.425
    crank = 2.0 * np.pi * np.arange(positions * turns) / positions
    angle = cage * crank[:, None] + 2.0 * np.pi * np.arange(20) / 20
    # Q ∝ cos^1.1 ψ over half the circle: rigid races without clearance (ISO/TR 1281-1).
    loads = np.maximum(np.cos(angle), 0.0) ** 1.1
    loads *= part.dynamic_load_rating / 0.83 / np.mean((loads * np.cos(angle)).sum(axis=1))
    even = EvenLaminae(edges=False)
    inner, outer = race_load(loads, angle - crank[:, None], even), race_load(loads, angle, even)
    return part.race_ratings().life(inner, outer)


def _iso_16281() -> list[Figure]:
    radial = _zone_mean(2.1)
    factors, relief = edge_factors(31), Relief(length=20.0, logarithm=LOGARITHMIC * 20.0)
    lives = [life_at_the_rating(turns) for turns in (3, 7)]
    ratings = _bearing(0.15).race_ratings(20_000.0)
    tabulated = "the standard's constants come from tabulated J of three digits: 0.3 %, against 4 % between the two"
    quadrature = "quadrature, 1e-9"
    return [
        relative_figure(
            "0.378, load of a race that turns by the load integral", INNER_SHARE, radial / _zone_mean(1.1 * 4.0) ** 0.25, "",
            4e-3, tabulated, numerical_error=1e-9, numerical_origin=quadrature, reference_error=3e-3,
        ),
        relative_figure(
            "0.364, load of a race that stands by the load integral", OUTER_SHARE,
            radial / _zone_mean(1.1 * 4.5) ** (1 / 4.5), "",
            4e-3, tabulated, numerical_error=1e-9,
            numerical_origin=quadrature, reference_error=3e-3,
        ),
        absolute_figure(
            "life at P = C without edges", lives[1], 1.0, "million turns", 0.02,
            "0.3 % of the constants to the fourth power, and 0.5 % for the roller load that 20 rollers share",
            numerical_error=abs(lives[1] - lives[0]), numerical_origin="change from 3 to 7 turns", reference_error=0.012,
        ),
        relative_figure(
            "life at half the load", ratings.life(1000.0, 900.0) / ratings.life(2000.0, 1800.0), 16.0, "times", 1e-9,
            "fourth power: round-off", numerical_error=1e-12, numerical_origin=ROUND_OFF,
        ),
        relative_figure(
            "edge factor of the last of 31 laminae, 1 − 0.01/ln(1.985 · 30/62)", float(factors[-1]),
            1.0 - 0.01 / float(np.log(1.985 * 30.0 / 62.0)), "", 1e-9, "by hand: round-off", numerical_error=1e-12,
            numerical_origin=ROUND_OFF,
        ),
        relative_figure(
            "edge factor in the middle", float(factors[15]), 1.0, "", 1e-12, "1 by definition", numerical_error=0.0,
            numerical_origin="no arithmetic",
        ),
        relative_figure(
            "logarithmic profile at 0.8 of the half-length, 0.00035 · 20 · ln(1/0.36)", 1e3 * float(relief.relief(8.0)), 7.1516,
            "µm", 1e-4, "by hand to five digits", numerical_error=1e-12, numerical_origin=ROUND_OFF, reference_error=1e-5,
        ),
    ]  # fmt: skip


CASES = (
    Case(
        name="bearing_load_zone",
        title="Load zone of a roller bearing",
        problem="Rigid races displaced against each other, line contacts with F ∝ δ^1.1 on both races: load integral "
        "J_r and largest roller load by "
        "the extent ε of the zone.",
        references=(
            Reference(
                source="T. A. Harris, M. N. Kotzalas, *Essential Concepts of Bearing Technology* (5th ed.), ch. 7, "
                "table 7.1; "
                "Sjövall: J_r(ε) = 1/(2π) ∮ [1 − (1 − cos ψ)/(2ε)]ⁿ cos ψ dψ",
                uncertainty="Half a unit of the last printed digit; n = 1.1 (10/9 gives 5e-4 less).",
            ),
        ),
        model="The contacts of a disc (`ltca.mechanics`) whose 2000 rollers alone carry, each with two contacts in series.",
        model_uncertainty="The books sum an integral along rays; normals here are exact.",
        run=_load_zone,
    ),
    Case(
        name="iso_281_ratings",
        title="ISO 281 and ISO 76: ratings of roller bearings",
        problem="f_c for all rows of the standard's table; dynamic and static rating and fatigue load limit of the "
        "paper's crank bearing.",
        references=(
            Reference(
                source="ISO 281:2007, Table 7, and B.3.3; ISO 76", uncertainty="Three digits, smoothed: 0.05 to 0.1."
            ),
        ),
        model="`ltca.analysis.life.ratings.RollerBearing`: the formula of ISO/TR 1281-1.",
        run=_ratings,
    ),
    Case(
        name="iso_16281_limits",
        title="ISO 16281: rating life in its limits",
        problem="What ISO 16281:2025 must give in limits that are known: constants of the races from the load zone, a "
        "million turns at the rating, the "
        "fourth power of the load, edge factors and the logarithmic profile by hand.",
        references=(
            Reference(
                source="ISO 16281:2025, ISO/TR 1281-1, ISO 281: P = C is a million turns",
                uncertainty="Constants of the standard have three digits (0.3 %), of the life 1.2 %.",
            ),
        ),
        model="`ltca.analysis.life`: equivalent loads of races as means over places and time, laminae.",
        run=_iso_16281,
    ),
)
