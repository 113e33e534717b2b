r"""Load–approach law of a conforming seat: a round pin in a bore that is hardly larger, without friction, plane strain.

At usual loads the arc of such a contact is no longer small against the radius and Hertz ends. Here the pressure acts
on circles: a solid cylinder (force balanced by a uniform body force, displacement relative to its mean over the section)
in a circular hole of an infinite body (displacement relative to the mean one of a concentric circle, the datum, in the
direction of the load). Michell's solutions for the pressure :math:`p = p_0 + \sum p_n \cos n\theta` on the radius a give
the radial displacements, κ = 3 − 4ν, μ the shear modulus:

=======  =================================================  ==================================================================
n        pin, inward, per p_n a / 4μ                        bore, outward, per p_n a / 4μ
=======  =================================================  ==================================================================
0        κ − 1                                              2
1        (κ − 1)/2                                          2κ/(κ + 1) · ln(datum/a) + 1/2
n ≥ 2    κ/(n + 1) + 1/(n − 1)                              κ/(n − 1) + 1/(n + 1)
=======  =================================================  ==================================================================

They fill the gap ΔR (1 − cos θ) − δ cos θ over the arc |θ| < α. The operator d²/dθ² + 1 takes cos θ and with it the
approach δ out of that condition and makes every harmonic n ≥ 1 a constant plus a multiple of n:

.. math:: -2 \sum n p_n \cos n\theta + 2\eta\, p + (c_0 - 2\eta) p_0 + 2 (1 - \eta) p_1 \cos\theta
          = -\frac{E^* \Delta R}{a},

with η half the mismatch of (κ − 1)/4μ and c₀ that of n = 0, both times E*. In t = tan(θ/2) = b s, b = tan(α/2), the sum is
a hypersingular integral that has the eigenfunctions :math:`\sqrt{1 - s^2} U_k(s)`: for a given arc few of them solve the
equation to round-off. The approach then follows from the condition itself at θ = 0.

With load q = F/(L E* ΔR) and z² = q/(q + π b₁²), b₁ of the neat fit, the arc, the peak pressure and the approach less
its logarithm are analytic in z from Hertz (z = 0) to the neat fit (z = 1: the play is nothing beside the approach, and the
contact linear): one Chebyshev series each. The first harmonic adds a spring, the only part that knows the datum.

Left out: displacements and play are small against the radius (both circles are taken at :math:`a = \sqrt{r r_s}`, which
keeps Hertz' curvature exact), friction, and what bounds the body with the bore.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike, NDArray

from ltca.drive.materials import Material, contact_modulus
from ltca.errors import DriveError
from ltca.frozen_arrays import freeze
from ltca.laws.sleeve_wall import sleeve_wall

FloatArray = NDArray[np.float64]

FUNCTIONS = 20
"""Pressure functions of even order for one arc: their error is below 1e-6 where ν differs by 0.3, else below 1e-9."""
QUADRATURE = 80
DEGREE = 20
"""Of the Chebyshev series over b and over z."""
SMALLEST_BREATHING = 0.02
"""Smallest c₀ that is told apart: a pin of ν = 0.495 in a rigid bore; a softer one would touch its bore all round."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ArcSolution:
    """Contact over a given arc, in units of the load: p in F/(aL), displacements in F/(L E*).

    Attributes
    ----------
    half_width : float
        b = tan(α/2).
    play : float
        ΔR that goes with it; negative beyond the arc of the neat fit.
    approach : float
        Without what the first harmonic yields.
    coefficients : array, shape (FUNCTIONS,)
        Of √(1 − s²) U_2k(s) in the pressure.
    """

    half_width: float
    play: float
    approach: float
    coefficients: FloatArray

    def pressure(self, angle: ArrayLike) -> FloatArray:
        """Return the pressure at angles (rad) from the line of load, in F/(aL); zero off the arc."""
        s = np.tan(0.5 * np.asarray(angle, dtype=float)) / self.half_width
        inside = np.abs(s) < 1.0
        return np.where(inside, _functions(np.where(inside, s, 0.0)) @ self.coefficients, 0.0)


def _functions(s: FloatArray) -> FloatArray:
    """√(1 − s²) U_k(s) = sin((k + 1) arccos s), k = 0, 2, …, on one more axis at the end."""
    return np.asarray(np.sin(np.arccos(s)[..., None] * (2.0 * np.arange(FUNCTIONS) + 1.0)))


@dataclass(frozen=True, slots=True, kw_only=True)
class _Points:
    """Places s and weights of ∫ … ds over the half arc, and the pressure functions there."""

    s: FloatArray
    weights: FloatArray
    functions: FloatArray

    def on_arc(self, b: float) -> tuple[FloatArray, FloatArray]:
        """Angles and weights of ∫ … dθ over the whole arc, of even functions."""
        return 2.0 * np.arctan(b * self.s), self.weights * 4.0 * b / (1.0 + (b * self.s) ** 2)


@lru_cache(maxsize=1)
def _points() -> tuple[_Points, _Points, _Points]:
    """Points of integrals of the pressure, of those with its logarithm at s = 0, and of collocation."""
    turn = 0.5 * np.pi * (np.arange(QUADRATURE) + 0.5) / QUADRATURE
    s = np.cos(turn)
    plain = _Points(s=s, weights=np.sin(turn) * (0.5 * np.pi / QUADRATURE), functions=_functions(s))
    nodes, weights = np.polynomial.legendre.leggauss(QUADRATURE)
    v = 0.5 * (nodes + 1.0)
    # s = sin(π v⁴/2): the logarithm at s = 0 and the root at s = 1 become smooth.
    turn = 0.5 * np.pi * v**4
    s = np.sin(turn)
    logarithmic = _Points(s=s, weights=np.cos(turn) * np.pi * v**3 * weights, functions=_functions(s))
    s = np.cos(0.5 * np.pi * (np.arange(FUNCTIONS) + 0.5) / FUNCTIONS)
    return plain, logarithmic, _Points(s=s, weights=np.empty(0), functions=_functions(s))


def solve_arc(
    half_width: float, mismatch: float, breathing: float, sleeve: tuple[float, float, float] | None = None
) -> ArcSolution:
    """Return the contact over a given arc.

    Parameters
    ----------
    half_width : float
        b = tan(α/2).
    mismatch : float
        η; zero for equal materials.
    breathing : float
        c₀; one for equal materials.
    sleeve : tuple of float, optional
        κ, a/R and E*/4μ of a sleeve; the bore is in an infinite body without.
    """
    b = half_width
    plain, logarithmic, points = _points()
    angle, weights = plain.on_arc(b)
    mean = weights @ plain.functions / (2.0 * np.pi)
    first = (weights * np.cos(angle)) @ plain.functions / np.pi
    # Σ n p_n cos nθ of each function: the hypersingular integral, in closed form.
    s = points.s[:, None]
    orders = 2.0 * np.arange(FUNCTIONS) + 1.0
    sums = (1.0 + (b * s) ** 2) / (2.0 * b * np.sqrt(1.0 - s**2)) * orders * points.functions
    cosine = (1.0 - (b * s) ** 2) / (1.0 + (b * s) ** 2)
    system = np.zeros((FUNCTIONS + 1, FUNCTIONS + 1))
    system[:-1, :-1] = (
        -2.0 * sums
        + 2.0 * mismatch * points.functions
        + (breathing - 2.0 * mismatch) * mean
        + 2.0 * (1.0 - mismatch) * cosine * first
    )
    system[:-1, -1] = 1.0
    # The force: ∫ p cos θ dθ = π p₁ = 1.
    system[-1, :-1] = np.pi * first
    right = np.zeros(FUNCTIONS + 1)
    right[-1] = 1.0
    if sleeve is not None:
        kappa, ratio, part = sleeve
        wall = sleeve_wall(kappa, ratio)
        n = np.arange(len(wall.own), dtype=float)[:, None]
        harmonics = (weights * np.cos(n * angle)) @ plain.functions / np.pi
        harmonics[0] *= 0.5
        waves = part * (1.0 - n**2) * np.cos(n * 2.0 * np.arctan(b * points.s))
        system[:-1, :-1] += (waves * wall.own[:, None]).T @ harmonics
        right[:-1] = -wall.across @ waves
    solved = np.asarray(np.linalg.solve(system, right), dtype=float)
    angle, weights = logarithmic.on_arc(b)
    # Σ over n ≥ 2 of (1 + η)/(n + 1) + (1 − η)/(n − 1) times cos nθ, and half the harmonic n = 0.
    kernel = (
        -2.0 * np.log(2.0 * np.sin(0.5 * angle)) * np.cos(angle)
        + mismatch * (np.pi - angle) * np.sin(angle)
        - (1.0 + mismatch) * (1.0 + 0.5 * np.cos(angle))
        + 0.5 * breathing
    )
    approach = (weights * kernel) @ (logarithmic.functions @ solved[:-1]) / np.pi
    if sleeve is not None:
        # Less the first harmonic, which does not know the arc.
        moved = np.where(n[:, 0] == 1.0, 0.0, wall.own - wall.back) @ harmonics
        approach += part * (moved @ solved[:-1] + wall.across.sum() + wall.outside)
    return ArcSolution(half_width=b, play=float(solved[-1]), approach=float(approach), coefficients=solved[:-1])


@dataclass(frozen=True, slots=True, kw_only=True)
class ConformingSeries:
    """Arc, pressure and approach over z, from Hertz (z = 0) to the neat fit (z = 1), as Chebyshev series.

    Attributes
    ----------
    load_scale : float
        π b₁², b₁ of the neat fit.
    half_width : array
        Of b/z.
    pressure : array
        Of z times the peak pressure in F/(aL).
    approach, slope : array
        Of the approach in F/(L E*) without its logarithm, −2/π ln z, and the first harmonic; of its derivative by z.
    """

    load_scale: float
    half_width: FloatArray
    pressure: FloatArray
    approach: FloatArray
    slope: FloatArray

    def evaluate(self, series: FloatArray, z: FloatArray) -> FloatArray:
        """Return one of the series at z, 0 … 1."""
        return np.asarray(chebyshev.chebval(2.0 * z - 1.0, series, tensor=False))


def _neat_fit(mismatch: float, breathing: float, sleeve: tuple[float, float, float] | None) -> float:
    """Return b where the play is nothing beside the load."""

    def left(b: float) -> float:
        """Play times b², 1/π for small arcs."""
        return b**2 * solve_arc(b, mismatch, breathing, sleeve).play

    # In small steps: sleeves so thin that they bend away have more such arcs, far beyond the first.
    low = 0.3 if sleeve is None else 0.002
    high = 1.2 * low
    at_low, at_high = left(low), left(high)
    while at_high > 0.0:
        low, high, at_low = high, 1.2 * high, at_high
        at_high = left(high)
    for _ in range(80):  # Illinois' regula falsi
        b = (low * at_high - high * at_low) / (at_high - at_low)
        found = left(b)
        if abs(found) < 1e-14:
            break
        if found < 0.0:
            high, at_high, at_low = b, found, 0.5 * at_low
        else:
            low, at_low, at_high = b, found, 0.5 * at_high
    return b


def _fit(nodes: FloatArray, values: FloatArray) -> FloatArray:
    return np.asarray(chebyshev.chebfit(nodes, values, DEGREE), dtype=float)


@lru_cache(maxsize=256)
def conforming_series(
    mismatch: float, breathing: float, sleeve: tuple[float, float, float] | None = None
) -> ConformingSeries:
    """Return the series of two materials.

    Parameters
    ----------
    mismatch : float
        η; zero for equal materials.
    breathing : float
        c₀; one for equal materials.
    sleeve : tuple of float, optional
        κ, a/R and E*/4μ of a sleeve; the bore is in an infinite body without.
    """
    widest = _neat_fit(mismatch, breathing, sleeve)
    nodes = chebyshev.chebpts1(DEGREE + 1)
    place = 0.5 * (nodes + 1.0)
    arcs = [solve_arc(float(b), mismatch, breathing, sleeve) for b in widest * place]
    b = np.array([arc.half_width for arc in arcs])
    # Analytic in b: b² times the play, b times the peak pressure, the approach without its logarithm.
    play = _fit(nodes, b**2 * [arc.play for arc in arcs])
    pressure = _fit(nodes, b * [float(arc.pressure(0.0)) for arc in arcs])
    approach = _fit(nodes, 2.0 / np.pi * np.log(b) + [arc.approach for arc in arcs])
    # 1/z² = 1 + π b₁² ΔR: the place x = b/b₁ of every z by Newton's method from x = z.
    slope = chebyshev.chebder(play)
    z, x = place, place.copy()
    for _ in range(50):
        found = chebyshev.chebval(2.0 * x - 1.0, play) * np.pi
        miss = x**2 * (1.0 - z**2) - z**2 * found
        step = miss / (2.0 * x * (1.0 - z**2) - 2.0 * z**2 * np.pi * chebyshev.chebval(2.0 * x - 1.0, slope))
        x = np.clip(x - step, 0.25 * x, 1.0)
        if np.max(np.abs(step)) < 1e-14:
            break
    at = 2.0 * x - 1.0
    series = (
        x * widest / z,
        chebyshev.chebval(at, pressure) * z / (x * widest),
        chebyshev.chebval(at, approach) - 2.0 / np.pi * np.log(x * widest / z),
    )
    half_width, peak, closing = (_fit(nodes, values) for values in series)
    return freeze(
        ConformingSeries(
            load_scale=float(np.pi * widest**2),
            half_width=half_width,
            pressure=peak,
            approach=closing,
            slope=np.asarray(2.0 * chebyshev.chebder(closing), dtype=float),
        )
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Seat:
    """Dimensionless numbers of a pin and the body around it; `part` and κ are those of that body.

    Rounded where series are found by them: the same materials with another last bit share theirs.
    """

    modulus: float
    radius: float
    mismatch: float
    breathing: float
    kappa: float
    part: float
    pin_first: float

    @classmethod
    def of_bodies(cls, pin: Material, bore: Material, pin_radius: float, bore_radius: float, length: float) -> _Seat:
        if not 0.0 < pin_radius <= bore_radius:
            raise DriveError(
                [f"pin radius {pin_radius:g} mm: must be greater than 0 mm and at most {bore_radius:g} mm, its bore"]
            )
        if not length > 0.0:
            raise DriveError([f"length {length:g} mm of a seat: must be greater than 0 mm"])
        modulus = contact_modulus(pin, bore)
        pin_kappa, kappa = (3.0 - 4.0 * part.poisson_ratio for part in (pin, bore))
        # E*/4μ of each body
        pin_part, part = (0.5 * modulus * (1.0 + part.poisson_ratio) / part.youngs_modulus for part in (pin, bore))
        return cls(
            modulus=modulus,
            radius=float(np.sqrt(pin_radius * bore_radius)),
            mismatch=round(0.5 * ((pin_kappa - 1.0) * pin_part - (kappa - 1.0) * part), 12),
            breathing=round(max((pin_kappa - 1.0) * pin_part + 2.0 * part, SMALLEST_BREATHING), 12),
            kappa=kappa,
            part=round(part, 12),
            pin_first=0.5 * (pin_kappa - 1.0) * pin_part,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class ConformingLaw:
    """Law of one pin in one bore, for any play small against the radius.

    Attributes
    ----------
    length : float
        mm.
    radius : float
        a, mm.
    contact_modulus : float
        E*, MPa.
    first_harmonic : float
        Approach of the harmonic n = 1, datum included, in F/(L E*).
    series : ConformingSeries
        Of the materials.
    """

    length: float
    radius: float
    contact_modulus: float
    first_harmonic: float
    series: ConformingSeries

    @classmethod
    def of_bodies(
        cls,
        *,
        pin: Material,
        bore: Material,
        pin_radius: float,
        bore_radius: float,
        datum_radius: float,
        length: float,
    ) -> ConformingLaw:
        """Return the law of a pin in a bore.

        Parameters
        ----------
        pin, bore : Material
            Of the solid cylinder and of the body around it.
        pin_radius, bore_radius : float
            mm.
        datum_radius : float
            Of the circle about the bore whose mean displacement the approach is counted from, mm.
        length : float
            mm.

        Raises
        ------
        DriveError
            When a radius or the length leaves no such bodies.
        """
        if not datum_radius >= bore_radius:
            raise DriveError([f"datum radius {datum_radius:g} mm: must be at least {bore_radius:g} mm, the bore"])
        seat = _Seat.of_bodies(pin, bore, pin_radius, bore_radius, length)
        yielding = 2.0 * seat.kappa / (seat.kappa + 1.0) * np.log(datum_radius / seat.radius) + 0.5
        return cls(
            length=length,
            radius=seat.radius,
            contact_modulus=seat.modulus,
            first_harmonic=float((seat.pin_first + yielding * seat.part) / np.pi),
            series=conforming_series(seat.mismatch, seat.breathing),
        )

    @classmethod
    def of_sleeve(
        cls,
        *,
        pin: Material,
        sleeve: Material,
        pin_radius: float,
        bore_radius: float,
        outer_radius: float,
        datum: float,
        length: float,
    ) -> ConformingLaw:
        """Return the law of a sleeve between its pin and a load outside, in line: pin, seat and wall of the sleeve.

        The load outside is narrow beside the wall. Its own law counts the sleeve as a half-plane down to the datum
        distance (`ltca.laws.plane_strain`); what is left of the travel between the pin and the patch outside is here.

        Parameters
        ----------
        pin, sleeve : Material
            Of both bodies.
        pin_radius, bore_radius, outer_radius : float
            mm.
        datum : float
            Distance D of the law of the load outside, mm. With D much larger than the wall nothing may be left, or less.
        length : float
            mm.

        Raises
        ------
        DriveError
            When a radius or the length leaves no such bodies.
        """
        if not outer_radius > bore_radius:
            raise DriveError(
                [f"outer radius {outer_radius:g} mm of a sleeve: must be greater than {bore_radius:g} mm, its bore"]
            )
        seat = _Seat.of_bodies(pin, sleeve, pin_radius, bore_radius, length)
        kappa, ratio = round(seat.kappa, 12), round(seat.radius / outer_radius, 12)
        wall = sleeve_wall(kappa, ratio)
        yielding = wall.own[1] - wall.back[1] + (kappa + 1.0) * np.log(outer_radius / datum)
        return cls(
            length=length,
            radius=seat.radius,
            contact_modulus=seat.modulus,
            first_harmonic=float((seat.pin_first + yielding * seat.part) / np.pi),
            series=conforming_series(seat.mismatch, seat.breathing, (kappa, ratio, seat.part)),
        )

    def _place(self, load: ArrayLike, play: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Force, mm·MPa, and z, never zero: the logarithm of the compliance has no end."""
        force = np.maximum(np.asarray(load, dtype=float), 1e-300) / self.length
        scale = self.series.load_scale * self.contact_modulus * np.asarray(play, dtype=float)
        return force, np.sqrt(force / (force + scale))

    def approach_and_compliance(self, load: ArrayLike, play: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Return the approach at a load and its derivative, mm and mm/N; the slope has no end at no load.

        Parameters
        ----------
        load : array
            N, at least 0.
        play : array
            Bore radius less pin radius, mm, at least 0; broadcasts with the load.

        Returns
        -------
        approach, compliance : array
            Travel of the pin from where it touches, against the datum.
        """
        force, z = self._place(load, play)
        level = self.first_harmonic - 2.0 / np.pi * np.log(z) + self.series.evaluate(self.series.approach, z)
        # F dz/dF = z (1 − z²)/2
        bend = 0.5 * (1.0 - z**2) * (z * self.series.evaluate(self.series.slope, z) - 2.0 / np.pi)
        approach = np.where(np.asarray(load) > 0.0, force * level / self.contact_modulus, 0.0)
        return approach, (level + bend) / (self.contact_modulus * self.length)

    def half_angle(self, load: ArrayLike, play: ArrayLike) -> FloatArray:
        """Return half the arc of contact, rad; parameters as for `approach_and_compliance`."""
        _, z = self._place(load, play)
        return np.asarray(2.0 * np.arctan(z * self.series.evaluate(self.series.half_width, z)))

    def largest_pressure(self, load: ArrayLike, play: ArrayLike) -> FloatArray:
        """Return the pressure in the line of load, MPa; parameters as for `approach_and_compliance`."""
        force, z = self._place(load, play)
        return np.asarray(force / (self.radius * z) * self.series.evaluate(self.series.pressure, z))
