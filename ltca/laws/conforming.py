"""Load–approach law of a conforming seat: a round pin in a bore that is hardly larger, without friction, plane strain.

Pin and bore are circles of the radius a = √(r r_s) under p = p₀ + Σ pₙ cos nθ (Michell; docs/theory/seats.md). The first harmonic
is a spring, the only part that depends on the datum. Finite displacements and the outer boundary of the bore's body are left out.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ltca.arrays import FloatArray
from ltca.drive.materials import Material, contact_modulus
from ltca.errors import DriveError
from ltca.laws.seats.series import ConformingSeries, conforming_series
from ltca.laws.seats.sleeve_wall import sleeve_wall

SMALLEST_BREATHING = 0.02
"""Lower bound of c₀, that of a pin of ν = 0.495 in a rigid bore; a softer pin would touch its bore all round."""


class _Seat(NamedTuple):
    """Dimensionless numbers of a pin and the body around it, rounded so that nearly the same materials share a series."""

    modulus: float
    radius: float
    mismatch: float
    breathing: float
    kappa: float  # of the body around the pin
    part: float  # its E*/4μ
    first: float


def _seat(pin: Material, bore: Material, pin_radius: float, bore_radius: float, length: float) -> _Seat:
    """Numbers of a pin in a bore; DriveError where radii or length leave no such bodies."""
    if not 0.0 < pin_radius <= bore_radius:
        raise DriveError(
            [f"pin radius {pin_radius:g} mm: must be greater than 0 mm and at most {bore_radius:g} mm, its bore"]
        )
    if not length > 0.0:
        raise DriveError([f"length {length:g} mm of a seat: must be greater than 0 mm"])
    modulus = contact_modulus(pin, bore)
    pin_kappa, kappa = (3.0 - 4.0 * part.poisson_ratio for part in (pin, bore))
    pin_part, part = (0.5 * modulus * (1.0 + part.poisson_ratio) / part.youngs_modulus for part in (pin, bore))
    between = (kappa + 1.0) * part - (pin_kappa + 1.0) * pin_part
    return _Seat(
        modulus=modulus,
        radius=float(np.sqrt(pin_radius * bore_radius)),
        mismatch=round(0.5 * ((pin_kappa - 1.0) * pin_part - (kappa - 1.0) * part), 12),
        breathing=round(max((pin_kappa - 1.0) * pin_part + 2.0 * part, SMALLEST_BREATHING), 12),
        kappa=kappa,
        part=round(part, 12),
        # Near the load each body follows the logarithm of its radius, not of a, which counts where the play is wide.
        first=0.5 * ((pin_kappa - 1.0) * pin_part + between * np.log(bore_radius / pin_radius)),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class ConformingLaw:
    """Law of one pin in one bore, by loads, N, and plays (radial), mm, at least 0; approaches are from touching, by the datum."""

    length: float
    radius: float  # a, mm
    contact_modulus: float  # E*, MPa
    first_harmonic: float  # approach of the harmonic n = 1, datum included, in F/(L E*)
    series: ConformingSeries

    @classmethod
    def of_bodies(
        cls, *, pin: Material, bore: Material, pin_radius: float, bore_radius: float, datum_radius: float, length: float
    ) -> ConformingLaw:
        """Return the law of a pin in a bore, relative to the circle of `datum_radius` about it; lengths in mm."""
        if not datum_radius >= bore_radius:
            raise DriveError([f"datum radius {datum_radius:g} mm: must be at least {bore_radius:g} mm, the bore"])
        seat = _seat(pin, bore, pin_radius, bore_radius, length)
        yielding = 2.0 * seat.kappa / (seat.kappa + 1.0) * np.log(datum_radius / bore_radius) + 0.5
        return cls._of_seat(seat, length, yielding)

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
        """Return the law of pin, seat and wall of a sleeve under a narrow load outside, which counts it down to `datum`; mm."""
        if not outer_radius > bore_radius:
            raise DriveError(
                [f"outer radius {outer_radius:g} mm of a sleeve: must be greater than {bore_radius:g} mm, its bore"]
            )
        seat = _seat(pin, sleeve, pin_radius, bore_radius, length)
        kappa, ratio = round(seat.kappa, 12), round(bore_radius / outer_radius, 12)
        wall = sleeve_wall(kappa, ratio)
        yielding = wall.own[1] - wall.back[1] + (kappa + 1.0) * np.log(outer_radius / datum)
        return cls._of_seat(seat, length, yielding, (kappa, ratio, seat.part))

    @classmethod
    def _of_seat(
        cls, seat: _Seat, length: float, yielding: float, *sleeve: tuple[float, float, float]
    ) -> ConformingLaw:
        """The law of a seat of which the body around the pin yields that much by the first harmonic, in its E*/4μ."""
        return cls(
            length=length,
            radius=seat.radius,
            contact_modulus=seat.modulus,
            first_harmonic=float((seat.first + yielding * seat.part) / np.pi),
            series=conforming_series(seat.mismatch, seat.breathing, *sleeve),
        )

    def _place(self, load: ArrayLike, play: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Force per length, N/mm, and z, never zero: the logarithm in the compliance has no limit there."""
        force = np.maximum(np.asarray(load, dtype=float), 1e-300) / self.length
        scale = self.series.load_scale * self.contact_modulus * np.asarray(play, dtype=float)
        return force, np.sqrt(force / (force + scale))

    def _level(self, z: FloatArray) -> FloatArray:
        """Approach in F/(L E*)."""
        return self.first_harmonic - 2.0 / np.pi * np.log(z) + self.series.evaluate(self.series.approach, z)

    def approach_and_compliance(self, load: ArrayLike, play: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Return the approach at a load and its derivative, mm and mm/N; the derivative is unbounded at no load."""
        force, z = self._place(load, play)
        level = self._level(z)
        # F dz/dF = z (1 − z²)/2
        bend = 0.5 * (1.0 - z**2) * (z * self.series.evaluate(self.series.slope, z) - 2.0 / np.pi)
        approach = np.where(np.asarray(load) > 0.0, force * level / self.contact_modulus, 0.0)
        return approach, (level + bend) / (self.contact_modulus * self.length)

    def energy(self, load: ArrayLike, play: ArrayLike) -> FloatArray:
        """Return ∫ F dδ = F δ − ∫ δ dF, N·mm."""
        force, z = self._place(load, play)
        complement = 0.5 * self.first_harmonic - np.log(z) / np.pi + self.series.evaluate(self.series.complement, z)
        return np.asarray(self.length / self.contact_modulus * force**2 * (self._level(z) - complement))

    def half_angle(self, load: ArrayLike, play: ArrayLike) -> FloatArray:
        """Return half the arc of contact on the radius a, rad."""
        _, z = self._place(load, play)
        return np.asarray(2.0 * np.arctan(z * self.series.evaluate(self.series.half_width, z)))

    def largest_pressure(self, load: ArrayLike, play: ArrayLike) -> FloatArray:
        """Return the pressure in the line of load, MPa."""
        force, z = self._place(load, play)
        return np.asarray(force / (self.radius * z) * self.series.evaluate(self.series.pressure, z))
