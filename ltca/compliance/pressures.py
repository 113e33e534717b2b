"""Pressures from the laws of the contacts, of shaft pins in the plane from their loads (docs/theory/contact.md)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ltca.arrays import FloatArray
from ltca.compliance import sliced
from ltca.compliance.response import AlongWidth, ContactPressures, DiscContacts, DiscResponse, KindPressures
from ltca.contact.contact_kind import ContactKind, ContactKinds
from ltca.contact.end_pressure import largest_pressure_ratio
from ltca.geometry.placement import Placement
from ltca.laws.contact_law import ContactLaw
from ltca.laws.line_contact import LineContactLaw

if TYPE_CHECKING:
    from ltca.laws.width_pressure import WidthPressures


def pressures_of_law(
    law: ContactLaw, ends: ContactKind | None, approach: FloatArray, effective_radius: FloatArray
) -> KindPressures:
    """Return pressures and half-widths at approaches, mm, seats and beams behind included; `ends` None in plane strain."""
    law, approach = law.surface(approach, effective_radius)
    closed = approach > 0.0
    mid, half_width, largest = (np.zeros(closed.shape) for _ in range(3))
    pressed, radius = approach[closed], np.broadcast_to(effective_radius, closed.shape)[closed]
    mid[closed], half_width[closed] = law.mid_pressure(pressed, radius), law.half_width(pressed, radius)
    if ends is None:
        return KindPressures(mid=mid, largest=np.full(mid.shape, np.nan), half_width=half_width, end_cell=np.nan)
    largest[closed] = mid[closed] * largest_pressure_ratio(ends, pressed, radius)
    return KindPressures(mid=mid, largest=largest, half_width=half_width, end_cell=ends.end_cell)


def pressures_in_plane(
    contacts: DiscContacts,
    response: DiscResponse,
    pins: FloatArray,
    outer: FloatArray,
    inner: FloatArray,
    *,
    ends: bool = True,
) -> ContactPressures:
    """Return pressures and half-widths in the plane, of pins and rollers at approaches, mm, of shaft pins by their loads."""
    kinds, (_, outer_radius, hole_radius, inner_radius) = contacts.kinds, contacts.contact_laws
    holes, _ = contacts.hole_law.approach_at_load(response.hole_load, hole_radius)

    def of(law: ContactLaw, kind: ContactKind, approach: FloatArray, radius: FloatArray) -> KindPressures:
        return pressures_of_law(law, kind if ends else None, approach, radius)

    return ContactPressures(
        pins=of(contacts.pin_law, kinds.pins, pins, response.flank.effective_radius),
        outer=of(contacts.outer_law, kinds.outer, outer, outer_radius),
        inner=of(contacts.inner_law, kinds.inner, inner, inner_radius),
        holes=of(contacts.hole_law, kinds.holes, holes, hole_radius),
        rigid_shaft_pins=contacts.rigid_shaft_pins,
    )


def pressures_in_slices(
    response: DiscResponse,
    kinds: ContactKinds,
    place: Placement,
    *,
    has_ends: bool = True,
    rigid_shaft_pins: bool = False,
    shaft_pins_on_springs: bool = False,
) -> ContactPressures:
    """Return pressures and half-widths of contacts in slices by their line loads; springs have those of aligned lines."""
    rollers, pins, holes = response.rollers.leaning, response.leaning_pins, response.leaning_holes
    if pins is None or holes is None or rollers is None:
        raise ValueError("contacts have no slices")
    of_holes, radius = holes.contact.line_load, place.hole_effective_radii
    if shaft_pins_on_springs:
        of_holes = _between_ends(kinds.holes, of_holes, holes.contact.load, radius)
    return ContactPressures(
        pins=_of_slices(kinds.pins, pins.contact.line_load, response.flank.effective_radius, has_ends),
        outer=_of_slices(kinds.outer, rollers.outer.line_load, place.outer_effective_radii, has_ends),
        inner=_of_slices(kinds.inner, rollers.inner.line_load, place.inner_effective_radii, has_ends),
        holes=_of_slices(kinds.holes, of_holes, radius, has_ends),
        rigid_shaft_pins=rigid_shaft_pins,
    )


def _between_ends(
    kind: ContactKind, line_load: FloatArray, load: FloatArray, effective_radius: FloatArray
) -> FloatArray:
    """Line loads that add up to the same loads, shaped as those of aligned lines of finite length."""
    slices = line_load.shape[-2]
    approach, _ = LineContactLaw(kind.length, kind.contact_modulus).approach_at_load(load, effective_radius)
    line = sliced.SlicedLine.straight(kind.length, kind.contact_modulus, slices, kind.free_ends)
    shaped = line_load * line.respond(approach, np.zeros(load.shape), effective_radius).line_load
    total = kind.length / slices * sliced.slice_means(shaped).sum(axis=-1)
    scale = np.divide(load, total, out=np.zeros(load.shape), where=total > 0.0)
    return np.asarray(shaped * scale[..., None, None])


def _of_slices(kind: ContactKind, line_load: FloatArray, effective_radius: FloatArray, has_ends: bool) -> KindPressures:
    """Pressures of one kind by line loads, N/mm, (positions, pairs, slices, points); mid-width is the middle slice."""
    found = sliced.estimate_along_width(kind, line_load, effective_radius)
    return along_width(kind, found, effective_radius, has_ends=has_ends)


def along_width(
    kind: ContactKind, found: WidthPressures, effective_radius: FloatArray, *, has_ends: bool = True
) -> KindPressures:
    """Return pressures and half-widths of contacts in slices from what is known along their width at the middles of these."""
    half_width = 2.0 / kind.contact_modulus * found.pressure * np.asarray(effective_radius)[..., None]
    middle = found.pressure.shape[-1] // 2
    largest, place, end_load, even = found.largest, found.place, found.end_load, found.even_line_load
    if not has_ends:
        at = np.argmax(found.pressure, axis=-1)
        largest, end_load, even = found.pressure.max(axis=-1), np.zeros(end_load.shape), found.line_load
        place = np.where(largest > 0.0, found.height[at], 0.0)
    return KindPressures(
        mid=found.pressure[..., middle],
        largest=largest,
        half_width=half_width[..., middle],
        end_cell=kind.end_cell if has_ends else np.nan,
        along=AlongWidth(
            line_load=found.line_load,
            even_line_load=even,
            pressure=found.pressure,
            half_width=half_width,
            place=place,
            end_load=end_load,
        ),
    )
