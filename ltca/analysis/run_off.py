"""How far contacts reach along their width: patches that run off the end of a crown, and such as few slices resolve."""

from __future__ import annotations

import numpy as np

from ltca.compliance.response import ContactPressures, KindPressures
from ltca.drive.members.width import MOST_SLICES
from ltca.drive.parts import Drive
from ltca.drive.single_discs import single_discs
from ltca.errors import counted

RUN_OFF = 0.02
"""Line load at an end, by the largest of all contacts of the kind, from which a contact with a crown is said to run off there."""

FEWEST_SLICES = 4
"""Slices over which a contact that ends within its width has to reach: by fewer its profile of loads is not resolved."""
NOTABLE = 0.1
"""Load of a contact, by the largest of its kind, from which its slices are counted."""


def run_off_warning(drive: Drive, pressures: ContactPressures) -> str | None:
    """Return a warning where a line that is crowned or relieved carries right up to an end of it; None elsewhere.

    Straight lines do so always.
    """
    told = []
    leads = any(
        disc.lead_crown_drop > 0.0 or (disc.lead_relief_length > 0.0 and disc.lead_relief_depth > 0.0)
        for disc in (single.disc for single in single_discs(drive))
    )
    kinds = (
        ("wheel pins", leads or not drive.pin_wheel.pin_profile.is_cylinder, pressures.pins),
        ("rollers in the bore", not drive.crank_bearing.roller_profile.is_cylinder, pressures.outer),
        ("rollers on the inner race", not drive.crank_bearing.roller_profile.is_cylinder, pressures.inner),
    )
    for name, modified, kind in kinds:
        if modified and (words := _run_off_words(kind)):
            told.append(f"{name} {words}")
    if not told:
        return None
    return (
        f"the patch of pressure runs off the end of modified contacts: {', '.join(told)}; it peaks there, a larger crown or "
        "relief takes it in"
    )


def _run_off_words(kind: KindPressures) -> str:
    along = kind.along
    if along is None or not along.line_load.size:
        return ""
    load = np.where(np.isfinite(along.end_load), along.end_load, 0.0)
    largest = max(float(np.nanmax(along.line_load, initial=0.0)), float(np.max(load, initial=0.0)), 1e-300)
    ends = load.max(axis=(0, 1)) / largest
    sides = [side for side, one in zip(("lower", "upper"), ends, strict=True) if one > RUN_OFF]
    if not sides:
        return ""
    return f"(at the {' and the '.join(sides)} end, with {100.0 * np.max(ends):.2g} % of the largest line load)"


def undivided_ends_warning(slices: int, solid: bool, pressures: ContactPressures) -> str | None:
    """Return a warning where lines of one slice have the ends of half-spaces on solid bodies; None elsewhere.

    Plane strain has no largest pressure beyond that at mid-width.
    """
    if slices > 1 or not solid or not np.isfinite(pressures.pins.largest).any():
        return None
    return (
        "contact.slices = 1: the largest pressures anywhere along the width are those of half-spaces, which peak where solid "
        "bodies end; contact.slices = 9 has the ends of the bodies"
    )


def few_slices_warning(slices: int, pressures: ContactPressures) -> str | None:
    """Return a warning where contacts that carry notably end within their width and reach over few slices; None elsewhere."""
    told, fewest = [], slices
    for name, kind in (
        ("wheel pins", pressures.pins),
        ("rollers in the bore", pressures.outer),
        ("rollers on the inner race", pressures.inner),
        ("shaft pins", pressures.holes),
    ):
        if kind.along is None or not kind.along.line_load.size:
            continue
        line = np.nan_to_num(kind.along.line_load)
        load, reached = line.sum(axis=-1), (line > 0.0).sum(axis=-1)
        notable = (load > 0.0) & (load >= NOTABLE * load.max())
        if not notable.any() or (least := int(reached[notable].min())) >= min(FEWEST_SLICES, slices):
            continue
        told.append(f"{name} over {counted(least, 'slices')}")
        fewest = min(fewest, least)
    if not told:
        return None
    needed = -(-FEWEST_SLICES * slices // fewest) // 2 * 2 + 1
    more = f"contact.slices = {needed} or more tells" if needed <= MOST_SLICES else "more slices tell"
    return (
        f"contact.slices = {slices}: contacts that carry notably end within their width and reach over fewer than "
        f"{FEWEST_SLICES} slices ({', '.join(told)}): their largest pressures, line loads and K_Hβ are rough, {more} them better"
    )
