"""How contacts slip by the pose and by the crank angle (``docs/theory/friction.md``)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ltca.arrays import FloatArray
from ltca.compliance.response import DiscResponse, Response
from ltca.geometry.coordinates import DISC_ROTATION, WHEEL_ANGLE, X, Y
from ltca.geometry.pairs import ContactGeometry
from ltca.mechanics.places import DiscPlaces


@dataclass(frozen=True, slots=True, kw_only=True)
class Slip:
    """Slip of pins against a disc along the tangent, wheel pins first."""

    by_pose: FloatArray  # ∂s/∂q, mm/mm and mm/rad, shape (positions, pairs, coordinates)
    by_crank: FloatArray  # ds/dφ_C of the drive that turns, mm/rad, shape (positions, pairs)

    @classmethod
    def of_disc(
        cls,
        geometry: ContactGeometry,
        crank_angle: FloatArray,
        pose: FloatArray,
        part: DiscPlaces | DiscResponse | Response,
    ) -> Slip:
        """Return the slip of the contacts of one disc at crank angles, rad, and its poses, shape (positions, coordinates)."""
        place = geometry.placement
        flank, holes = part.flank.along.copy(), part.holes.along.copy()
        # The flank lies a pin radius nearer to the disc than the pin's centre, less what the pin has given way by, its play
        # first; the wall lies a hole radius beyond the hole's centre.
        nearer = place.wheel_pin_radii - place.wheel_pin_plays - np.maximum(part.flank.approach, 0.0)
        flank[..., DISC_ROTATION] += nearer
        flank[..., WHEEL_ANGLE] -= nearer
        holes[..., DISC_ROTATION] += place.hole_radii
        by_pose = np.concatenate((flank, holes), axis=1)
        centre, rate = place.races(crank_angle).velocity, np.zeros(pose.shape)
        for x in geometry.coordinates_of(pose).displacements:
            rate[:, x], rate[:, x + 1] = -pose[:, x + 1], pose[:, x]
        rate[:, X] += centre.real
        rate[:, Y] += centre.imag
        rate[:, WHEEL_ANGLE] = 1.0 / place.reduction_ratio
        return cls(by_pose=by_pose, by_crank=np.einsum("bpj,bj->bp", by_pose, rate))
