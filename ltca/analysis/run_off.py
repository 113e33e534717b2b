"""Contacts with a crown or relief whose patch of pressure runs off the end all the same."""

from __future__ import annotations

import numpy as np

from ltca.compliance.response import ContactPressures, KindPressures
from ltca.drive.parts import Drive
from ltca.drive.single_discs import single_discs

RUN_OFF = 0.02
"""Line load at an end, by the largest of all contacts of the kind, from which a contact with a crown is said to run off there."""


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
