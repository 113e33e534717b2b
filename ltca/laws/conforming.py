r"""Load–approach law of a conforming seat: a round pin in a bore that is hardly larger, without friction, plane strain.

At usual loads the arc of such a contact is not small compared with the radius, and Hertz' solution does not hold. Here the
pressure acts on circles: a solid cylinder (force balanced by a uniform body force, displacement relative to its mean over
the section) in a circular hole of an infinite body (displacement relative to the mean one of a concentric circle, the datum,
in the direction of the load). Michell's solutions for the pressure :math:`p = p_0 + \sum p_n \cos n\theta` on the radius a
give the radial displacements, κ = 3 − 4ν, μ the shear modulus:

=======  =================================================  ==================================================================
n        pin, inward, per p_n a / 4μ                        bore, outward, per p_n a / 4μ
=======  =================================================  ==================================================================
0        κ − 1                                              2
1        (κ − 1)/2                                          2κ/(κ + 1) · ln(datum/a) + 1/2
n ≥ 2    κ/(n + 1) + 1/(n − 1)                              κ/(n − 1) + 1/(n + 1)
=======  =================================================  ==================================================================

They fill the gap ΔR (1 − cos θ) − δ cos θ over the arc |θ| < α: `ltca.laws.seats.arc` solves that for a given arc,
`ltca.laws.seats.series` tabulates it over the load, once for each pair of materials; the first harmonic adds a spring, the
only part that depends on the datum. docs/theory/seats.md has the whole derivation, with figures.

Both circles are taken at :math:`a = \sqrt{r r_s}`, which keeps Hertz' curvature exact; where the play is wide the arc is
small, and there the logarithms of both radii count. Left out: finite displacements, friction, and the outer boundary of the
body with the bore.
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
    """Dimensionless numbers of a pin and the body around it; `part`, E*/4μ, and `kappa` are those of that body.

    They are rounded where series are looked up by them, so that materials that differ in the last bit share one.
    """

    modulus: float
    radius: float
    mismatch: float
    breathing: float
    kappa: float
    part: float
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
    """Law of one pin in one bore, for any play small compared with the radius.

    Loads are in N, at least 0, and plays (bore radius less pin radius) in mm, at least 0; they broadcast. Approaches are the
    travel of the pin from where it touches, relative to the datum. `length` and `radius`, a, are in mm, `contact_modulus`, E*, in
    MPa; `first_harmonic` is the approach of the harmonic n = 1, datum included, in F/(L E*).
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

        `pin` and `bore` are the materials of the solid cylinder and of the body around it; lengths are in mm. The approach is
        measured relative to the mean displacement of the circle of `datum_radius` about the bore. Radii or a length that leave
        no such bodies are refused (DriveError).
        """
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
        """Return the law of a sleeve between its pin and a load outside, in line: pin, seat and wall of the sleeve.

        The load outside is narrow compared with the wall. The law of that contact counts the sleeve as a half-plane down to the
        distance `datum` (`ltca.laws.plane_strain`); the rest of the travel between the pin and the patch outside is here. With
        a datum much larger than the wall the rest may be zero or negative. Lengths are in mm; those that leave no such bodies
        are refused (DriveError).
        """
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
