r"""What finite elements have beyond the near field of each contact itself: the diagonal of the body part C.

The near field of a contact belongs to its law, plane strain with a datum (`fe`) or a half-space of finite length
(`hybrid`). The finite-element approach of a patch holds it as well, so it is taken off here, once.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.optimize import brentq

from ltca.compliance.coefficients import InfluenceCoefficients, logarithm_factor
from ltca.contact.hertz import line_half_width
from ltca.drive.parts import Drive, Material
from ltca.geometry.pairs import ContactGeometry
from ltca.laws.line_contact import LineContactLaw
from ltca.laws.plane_strain import SELF_ENERGY

NearField = Literal["fe", "hybrid"]


@dataclass(frozen=True, slots=True, kw_only=True)
class OwnParts:
    """Diagonal body parts of the contacts, mm/N: what FE has beyond the near field of each contact itself.

    Attributes
    ----------
    pin, outer, inner, hole : float
        Added to the interpolated diagonal of disc (pin, outer, hole) and race (inner).
    """

    pin: float
    outer: float
    inner: float
    hole: float

    @classmethod
    def of_drive(
        cls, drive: Drive, coefficients: InfluenceCoefficients, near_field: NearField, datum: float
    ) -> OwnParts:
        """Return the diagonal parts.

        With A = smooth + κ (−ln(b/2) + 1/4) the approach of a patch, the plane-strain law holds κ (ln(2D/b) + 1/4)
        of it, which leaves smooth − κ ln D. What a half-space of finite length holds of it for the same patch is
        `finite_length_approach`; both are taken at the half-width of half the drive's load T/(e z_P) on one contact
        (they differ by the end effects alone, which change little with the load). A plane-stress body part joins the
        plane-strain near field at D.
        """
        parts, thickness = drive.materials, drive.disc.thickness
        c = coefficients

        geometry = ContactGeometry.of_drive(drive)
        place, bearing = geometry.placement, drive.crank_bearing
        load = 0.5 * abs(drive.wheel_moment()) / (place.eccentricity * place.reduction_ratio)

        def remove(body: float, material: Material, partner: Material | None, radius: float, length: float) -> float:
            if body == 0.0:
                return 0.0
            joined = -body * np.log(datum)
            if near_field == "fe":
                return float(joined)
            compliance = material.plane_strain_compliance + (partner.plane_strain_compliance if partner else 0.0)
            half_width = float(line_half_width(load / length, radius, 1.0 / compliance))
            factor = logarithm_factor(material, thickness)
            held = material.plane_strain_compliance * finite_length_approach(length, half_width)
            return float(joined + factor * (np.log(2.0 * datum / half_width) + SELF_ENERGY) - held)

        outer_radius = 1.0 / (1.0 / bearing.roller_radius - 1.0 / drive.bore_radius)
        inner_radius = 1.0 / (1.0 / bearing.roller_radius + 1.0 / bearing.inner_race_radius)
        hole_radius = 1.0 / (1.0 / drive.pin_shaft.pin_radius - 1.0 / drive.hole_radius)
        # Where the pitch circle cuts the flank the pins carry most.
        steep = np.array([0.25 * 2.0 * np.pi / drive.reduction_ratio])
        pin_radius = float(geometry.profile.effective_radius(steep, drive.pin_wheel.pin_radius)[0])
        length = bearing.roller_length
        on_flank = remove(c.disc_logarithm, parts.disc, parts.wheel_pin, pin_radius, thickness)
        of_pin = remove(c.pin_logarithm, parts.wheel_pin, parts.disc, pin_radius, thickness)
        on_bore = remove(c.disc_logarithm, parts.disc, parts.roller, outer_radius, length)
        in_bore = remove(c.roller_logarithm, parts.roller, parts.disc, outer_radius, length)
        on_race = remove(c.race_logarithm, parts.inner_race, parts.roller, inner_radius, length)
        on_inner = remove(c.roller_logarithm, parts.roller, parts.inner_race, inner_radius, length)
        return cls(
            pin=on_flank + c.pin + of_pin,
            outer=on_bore + float(c.roller[1, 1]) + in_bore,
            inner=on_race + float(c.roller[0, 0]) + on_inner,
            hole=remove(c.disc_logarithm, parts.disc, None, hole_radius, thickness),
        )


def finite_length_approach(length: float, half_width: float) -> float:
    """Return the mean displacement of a half-space over a patch of finite length, times E/(1 − ν²) per load, 1/mm.

    Parameters
    ----------
    length : float
        L, mm.
    half_width : float
        b at mid-length, mm.

    Returns
    -------
    float
        Pressure-weighted mean over the patch pressed by a straight cylinder: its approach less the mean separation.
    """
    law = LineContactLaw(length, 1.0)

    def excess(logarithm: float) -> float:
        return float(law.half_width(np.exp(logarithm), 1.0)) - half_width

    # b²/(ρδ) lies between 0.1 (very long) and 2 (the undeformed overlap).
    approach = float(np.exp(brentq(excess, np.log(0.4 * half_width**2), np.log(20.0 * half_width**2), xtol=1e-12)))
    load = float(law.load_and_stiffness(approach, 1.0)[0])
    return (approach - half_width**2 / 8.0) / load
