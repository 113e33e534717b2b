"""Rollers of a crank bearing with races displaced against each other, alone: no other contact carries anything."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from ltca.arrays import ComplexArray, FloatArray
from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.compliance.response import Response, Start
from ltca.equilibrium.reducer import Reducer
from ltca.geometry.coordinates import X, Y
from ltca.geometry.pair_motion import RollerRays
from ltca.geometry.pairs import ContactGeometry
from ltca.laws.contact_law import ContactLaw
from ltca.reading.drive_file import load_drive


@dataclass(frozen=True, slots=True)
class NoLoad(ContactLaw):
    """Contacts that carry nothing."""

    def load_and_stiffness(self, approach: ArrayLike, effective_radius: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Return zeros."""
        nothing = np.zeros(np.shape(approach))
        return nothing, nothing.copy()


@dataclass(frozen=True, slots=True, kw_only=True)
class _GivenRays(ContactGeometry):
    """The geometry of a drive whose rollers stand on given rays."""

    rays: RollerRays

    def rollers(self, crank_angle: FloatArray) -> RollerRays:
        """Return the rays."""
        return self.rays


@lru_cache(maxsize=1)
def _bare_disc() -> HalfSpaceCompliance:
    return replace(HalfSpaceCompliance.of_drive(load_drive("paper").cases["CS-1"]), pin_law=NoLoad(), hole_law=NoLoad())


def bearing_alone(
    rays: RollerRays,
    displacement: ComplexArray,
    laws: tuple[ContactLaw, ContactLaw],
    radii: tuple[FloatArray, FloatArray],
    share: FloatArray | None = None,
) -> Response:
    """Return the contacts of a disc whose rollers alone carry.

    Parameters
    ----------
    rays : RollerRays
        Of the rollers, with a row for every position.
    displacement : array of complex, shape (positions,)
        Centre of the bore from that of the inner race, mm.
    laws : tuple of ContactLaw
        In the bore and on the race.
    radii : tuple of array, shape (rollers,)
        Effective radii in the bore and on the race, mm.
    share : array, shape (positions, rollers), optional
        Part of the interference that the contact on the race takes where the search begins.
    """
    disc, rollers = _bare_disc(), rays.outermost.size
    known = {item.name: getattr(disc.geometry, item.name) for item in fields(ContactGeometry)}
    place = disc.geometry.placement
    known["placement"] = replace(
        place, roller_radii=np.full(rollers, float(place.roller_radii[0])), roller_cage_angles=np.zeros(rollers)
    )
    model = Reducer(
        discs=(
            replace(
                disc,
                geometry=_GivenRays(rays=rays, **known),
                roller_laws=replace(
                    disc.roller_laws, outer=laws[0], inner=laws[1], outer_radius=radii[0], inner_radius=radii[1]
                ),
            ),
        )
    )
    angle = np.zeros(displacement.size)
    pose = np.zeros((displacement.size, model.coordinates.size))
    pose[:, X], pose[:, Y] = displacement.real, displacement.imag
    start = None
    if share is not None:
        start = replace(Start.after(model.respond(angle, pose)), share=share, inner=None)
    return model.respond(angle, pose, start)
