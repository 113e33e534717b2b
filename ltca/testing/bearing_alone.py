"""Rollers of a crank bearing with races displaced against each other, alone: no other contact carries anything."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ltca.arrays import ComplexArray, FloatArray
from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.compliance.response import ContactLaws, DiscContacts, Response, Start
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


class RollerLaws(NamedTuple):
    """Load laws of the two contacts of every roller, and effective radii, mm, shape (rollers,)."""

    inner: ContactLaw
    outer: ContactLaw
    inner_radius: FloatArray
    outer_radius: FloatArray


def roller_laws(disc: DiscContacts) -> RollerLaws:
    """Return the laws of the rollers of a disc."""
    (_, outer, _, inner), outer_radius, _, inner_radius = disc.contact_laws
    return RollerLaws(inner, outer, inner_radius, outer_radius)


@dataclass(frozen=True, slots=True, kw_only=True)
class _BearingAlone(HalfSpaceCompliance):
    """A disc whose rollers have effective radii of their own."""

    radii: tuple[FloatArray, FloatArray]

    @property
    def contact_laws(self) -> ContactLaws:
        """Laws of the contacts."""
        laws, _, holes, _ = super(_BearingAlone, self).contact_laws
        return ContactLaws(laws, self.radii[0], holes, self.radii[1])


@lru_cache(maxsize=1)
def _bare_disc() -> HalfSpaceCompliance:
    return replace(HalfSpaceCompliance.of_drive(load_drive("paper").cases["CS-1"]), pin_law=NoLoad(), hole_law=NoLoad())


def bearing_alone(
    rays: RollerRays, displacement: ComplexArray, laws: RollerLaws, share: FloatArray | None = None
) -> Response:
    """Return the contacts of a disc whose rollers alone carry.

    Parameters
    ----------
    rays : RollerRays
        Of the rollers, with a row for every position.
    displacement : array of complex, shape (positions,)
        Centre of the bore from that of the inner race, mm.
    laws : RollerLaws
        Of the rollers.
    share : array, shape (positions, rollers), optional
        Part of the interference that the contact on the race takes where the search begins.
    """
    disc, rollers = _bare_disc(), rays.outermost.size
    known = {item.name: getattr(disc.geometry, item.name) for item in fields(ContactGeometry)}
    place = disc.geometry.placement
    known["placement"] = replace(
        place, roller_radii=np.full(rollers, float(place.roller_radii[0])), roller_cage_angles=np.zeros(rollers)
    )
    given = {item.name: getattr(disc, item.name) for item in fields(HalfSpaceCompliance)}
    given |= {"geometry": _GivenRays(rays=rays, **known), "outer_law": laws.outer, "inner_law": laws.inner}
    model = Reducer(discs=(_BearingAlone(**given, radii=(laws.outer_radius, laws.inner_radius)),))
    angle = np.zeros(displacement.size)
    pose = np.zeros((displacement.size, model.coordinates.size))
    pose[:, X], pose[:, Y] = displacement.real, displacement.imag
    start = None
    if share is not None:
        start = replace(Start.after(model.respond(angle, pose)), share=share, inner=None)
    return model.respond(angle, pose, start)
