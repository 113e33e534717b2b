"""Laws of all contacts of a reducer, in the plane or in slices: deformations in, loads, moments and their derivatives out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import FloatArray
from ltca.compliance import sliced
from ltca.compliance.response import ContactLaws
from ltca.laws.line_contact import LineContactLaw

if TYPE_CHECKING:
    from ltca.laws.sliced_contact import SlicedContact


class Carried(NamedTuple):
    """What contacts carry; components are the load and, in slices, the moment by half the thickness of the discs."""

    load: FloatArray  # N, shape (positions, components, contacts)
    stiffness: FloatArray  # k, in slices also of load and of moment by tilt, N/mm, (1 or 3, positions, contacts)
    left: FloatArray  # force that may be left over within a contact, N, shape (positions,)
    slices: list[list[SlicedContact]]  # by disc and kind; none in the plane


class PlaneLaws:
    """Laws of the contacts of all discs in the plane: wheel pins, rollers in bores, shaft pins, rollers on races."""

    def __init__(self, laws: Sequence[Any], kinds: Sequence[Sequence[slice]]) -> None:
        self.laws, self.kinds = laws, kinds
        self.radii = _radii(laws, kinds)
        alike = all(type(each) is ContactLaws for each in laws)
        self.groups = _law_groups(laws, kinds) if alike else []

    def carried(
        self, places: Sequence[Any], deformation: FloatArray, half: FloatArray, near: Any, *, roughly: bool
    ) -> Carried:
        """Return loads at deformations in mm, shape (positions, components, contacts), of discs at `places`."""
        e = deformation[:, 0]
        load, stiffness = np.zeros(deformation.shape), np.zeros((1, *e.shape))
        radius = np.empty(e.shape)
        radius[...] = self.radii
        for at, kinds in zip(places, self.kinds, strict=True):
            radius[:, kinds[0]] = at.flank.effective_radius
        for law, contacts in self.groups:
            found = law.load_and_stiffness(e[:, contacts], radius[:, contacts])
            load[:, 0, contacts], stiffness[0][:, contacts] = found
        # Laws that know where on the flank a pin touches are asked for closed contacts alone.
        for at, laws, kinds in zip(places, self.laws, self.kinds, strict=True) if not self.groups else ():
            for law, kind in zip(laws.placed(at.flank), kinds, strict=True):
                closed = e[:, kind] > 0.0
                found = law.take(closed.shape, closed).load_and_stiffness(e[:, kind][closed], radius[:, kind][closed])
                load[:, 0, kind][closed], stiffness[0][:, kind][closed] = found
        return Carried(load, stiffness, np.zeros(e.shape[0]), [[] for _ in places])

    @staticmethod
    def energy(law: Any, deformation: FloatArray, half: FloatArray, radius: FloatArray, near: Any) -> FloatArray:
        """Return ∫ F dδ of contacts of one kind, N·mm."""
        return np.asarray(law.energy(deformation[:, 0], radius))


class SlicedLaws:
    """The same in slices: what each slice carries is balanced inside its contact."""

    def __init__(self, laws: Sequence[Any], kinds: Sequence[Sequence[slice]]) -> None:
        self.laws, self.kinds = laws, kinds

    def carried(
        self, places: Sequence[Any], deformation: FloatArray, half: FloatArray, near: Any, *, roughly: bool
    ) -> Carried:
        """Return loads and moments at approaches and tilts; `near` are starts by disc and kind, or nothing."""
        load, left = np.zeros(deformation.shape), np.zeros(deformation.shape[0])
        stiffness = np.zeros((3, deformation.shape[0], deformation.shape[2]))
        every, starts = [], iter(near)
        for at, laws, kinds in zip(places, self.laws, self.kinds, strict=True):
            radii = at.flank.effective_radius, laws.outer_radius, laws.hole_radius, laws.inner_radius
            found = []
            for kind, law, radius in zip(kinds, laws.placed(at.flank), radii, strict=True):
                pressed, tilt = deformation[:, 0, kind], deformation[:, 1, kind] / half
                curved = np.broadcast_to(radius, pressed.shape)
                one = law.respond(pressed, tilt, curved, next(starts, None), sliced.ROUGH if roughly else sliced.EXACT)
                load[:, 0, kind], load[:, 1, kind] = one.load, one.moment / half
                own = one.by_approach, one.by_tilt / half, one.moment_by_tilt / half**2
                for values, mine in zip(stiffness, own, strict=True):
                    values[:, kind] = mine
                left = np.maximum(left, one.left.max(axis=1, initial=0.0))
                found.append(one)
            every.append(found)
        return Carried(load, stiffness, left, every)

    @staticmethod
    def energy(law: Any, deformation: FloatArray, half: FloatArray, radius: FloatArray, near: Any) -> FloatArray:
        """Return the energy of contacts of one kind, N·mm."""
        approach, tilt = deformation[:, 0], deformation[:, 1] / half
        curved = np.broadcast_to(radius, approach.shape)
        return np.asarray(law.energy(law.respond(approach, tilt, curved, near), curved))


def _law_groups(every: Sequence[Any], of_kind: Sequence[Sequence[slice]]) -> list[tuple[Any, slice | NDArray[np.intp]]]:
    """Laws of all discs in the plane with their contacts, those of one table as one law."""
    groups: list[tuple[Any, slice | NDArray[np.intp]]] = []
    lines: dict[int, list[tuple[LineContactLaw, slice]]] = {}
    for laws, kinds in zip(every, of_kind, strict=True):
        for law, kind in zip(laws.laws, kinds, strict=True):
            if type(law) is LineContactLaw:
                lines.setdefault(id(law.table), []).append((law, kind))
            elif kind.start < kind.stop:
                groups.append((law, kind))
    for same in lines.values():
        counts = [kind.stop - kind.start for _, kind in same]
        length, modulus = (
            np.repeat([getattr(law, name) for law, _ in same], counts) for name in ("length", "contact_modulus")
        )
        contacts = np.concatenate([np.arange(kind.start, kind.stop) for _, kind in same])
        groups.append((LineContactLaw(length, modulus, same[0][0].table), contacts))
    return groups


def _radii(laws: Sequence[Any], of_kind: Sequence[Sequence[slice]]) -> FloatArray:
    """Effective radii of all contacts, mm, shape (1 or positions, contacts); 1 of wheel pins."""
    every = [(each.outer_radius, each.hole_radius, each.inner_radius) for each in laws]
    rows = max(np.atleast_2d(each).shape[0] for radii in every for each in radii)
    found = np.ones((rows, of_kind[-1][-1].stop))
    for kinds, radii in zip(of_kind, every, strict=True):
        for kind, radius in zip(kinds[1:], radii, strict=True):
            found[:, kind] = radius
    return found
