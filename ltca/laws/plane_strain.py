r"""Load–approach law of a line contact in plane strain, with a datum.

A half-plane alone defines no approach: it has to be measured relative to some depth, the same for the law and for the
flexibility of the rest of the body. Here the approach is that of bodies whose displacement follows the logarithm of the
half-plane down to the distance D, the datum distance:

.. math:: \delta = \frac{2 q}{\pi E^*} \left( \ln\frac{2D}{b} + \tfrac12 \right), \qquad
          b^2 = \frac{4 q \rho}{\pi E^*},

which is the pressure-weighted mean of the displacements over the patch plus the mean separation b²/(8ρ) (a quarter
of the bracket each for the self-energy of the semi-elliptic pressure and for the separation).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ltca.arrays import FloatArray
from ltca.errors import ConvergenceError
from ltca.laws.contact_law import ContactLaw

SELF_ENERGY = 0.25
"""Of a semi-elliptic pressure of half-width b: −⟨ln|x − x′|⟩ = −ln(b/2) + 1/4."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PlaneContactLaw(ContactLaw):
    """Plane-strain law of one line contact.

    Attributes
    ----------
    thickness : float
        mm.
    contact_modulus : float
        E*, MPa.
    datum : float
        D, mm; large compared with every half-width.
    """

    thickness: float
    contact_modulus: float
    datum: float

    def approach_at_load(
        self, load: FloatArray, effective_radius: ArrayLike, start: FloatArray | None = None
    ) -> tuple[FloatArray, FloatArray]:
        """Return the approach at a load and its derivative, mm and mm/N, in closed form; zero where there is no load."""
        force, radius = np.broadcast_arrays(np.asarray(load, dtype=float), np.asarray(effective_radius, dtype=float))
        loaded = force > 0.0
        scale = 2.0 / (np.pi * self.contact_modulus * self.thickness)
        half_width = self._half_width_of(np.maximum(force, 1e-300), radius)
        logarithm = np.log(2.0 * self.datum / half_width)
        return np.where(loaded, scale * force * (logarithm + 0.5), 0.0), np.where(loaded, scale * logarithm, 0.0)

    def _half_width_of(self, load: FloatArray, effective_radius: ArrayLike) -> FloatArray:
        return np.asarray(
            np.sqrt(4.0 * load * np.asarray(effective_radius) / (np.pi * self.contact_modulus * self.thickness))
        )

    def _load(self, approach: ArrayLike, effective_radius: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Return the load and ln(2D/b) by Newton's method.

        The approach is a concave function of the load, so iterates rise to the root. With λ(F) = ln(2D/b) the approach is F (λ
        + 1/2) in units of 2/(π E* L), and its slope is λ: a step leads to (δ − F/2)/λ and costs one logarithm.
        """
        delta = np.asarray(approach, dtype=float)
        closed = delta > 0.0
        pull = np.pi * self.contact_modulus * self.thickness
        at_unit_load = np.log(2.0 * self.datum) - 0.5 * np.log(4.0 * np.asarray(effective_radius, dtype=float) / pull)
        # Open contacts are given an approach at which the law holds.
        target = np.where(closed, delta * (0.5 * pull), np.exp(2.0 * at_unit_load - 10.0))
        logarithm = at_unit_load - 0.5 * np.log(target / 10.0)
        load = target / (logarithm + 0.5)
        history = []
        for _ in range(60):
            logarithm = at_unit_load - 0.5 * np.log(load)
            following = (target - 0.5 * load) / logarithm
            history.append(float(np.max(np.abs(following - load) / load, initial=0.0)))
            load = following
            if not np.all((load > 0.0) & (logarithm > 0.0)):
                break
            if history[-1] < 1e-7:  # quadratic: 1e-14 is left
                logarithm = at_unit_load - 0.5 * np.log(load)
                return np.where(closed, load, 0.0), logarithm
        raise ConvergenceError(
            f"approach beyond what the plane-strain law holds for (half-width against datum {self.datum:g} mm); "
            "relative change of the load",
            history,
        )

    def load_and_stiffness(self, approach: ArrayLike, effective_radius: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Return the load at an approach and its derivative, N and N/mm; zero where open."""
        load, logarithm = self._load(approach, effective_radius)
        scale = 2.0 / (np.pi * self.contact_modulus * self.thickness)
        return load, np.where(load > 0.0, 1.0 / (scale * logarithm), 0.0)

    def energy(self, approach: ArrayLike, effective_radius: ArrayLike) -> FloatArray:
        """Return ∫ F dδ = F δ − ∫ δ dF, N·mm."""
        load, _ = self._load(approach, effective_radius)
        scale = 2.0 / (np.pi * self.contact_modulus * self.thickness)
        # ∫₀^F F′ (ln(2D/b) + 1/2) dF′ = F²/2 (ln(2D/b) + 3/4), since ln b grows like ln(F)/2.
        logarithm = np.log(2.0 * self.datum / self._half_width_of(np.maximum(load, 1e-300), effective_radius))
        return np.asarray(scale * load**2 * (logarithm + 0.5 - 0.5 * (logarithm + 0.75)))

    def half_width(self, approach: ArrayLike, effective_radius: ArrayLike) -> FloatArray:
        """Return the contact half-width, mm (Johnson, Eq. 4.43)."""
        return self._half_width_of(self._load(approach, effective_radius)[0], effective_radius)

    def mid_pressure(self, approach: ArrayLike, effective_radius: ArrayLike) -> FloatArray:
        """Return the peak pressure, MPa (Johnson, Eq. 4.45)."""
        line_load = self._load(approach, effective_radius)[0] / self.thickness
        return np.sqrt(line_load * self.contact_modulus / (np.pi * np.asarray(effective_radius)))
