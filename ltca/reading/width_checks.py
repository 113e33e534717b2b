"""Checks of the width of the contacts: slices, what needs them, lead of the flank, and sizes of inclinations."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache
from operator import attrgetter
from typing import Any

from ltca.drive.declaration import ANY, declared_fields
from ltca.drive.engine_support import given, shown, unit_of
from ltca.drive.members.width import FEWEST_SLICES, LARGEST_SLOPE, MOST_SLICES, needs_slices
from ltca.drive.parts import Disc, Drive
from ltca.errors import Problem

PLAY = "disc.axial_play"
"""The one field of the width that says something where it is zero."""


def find_width_problems(drive: Drive) -> Iterator[Problem]:
    """Yield the problems of slices along the width, of what needs them, and of inclined axes, one sentence each."""
    slices = drive.contact.slices
    if slices % 2 == 0:
        yield Problem.of(
            "contact.slices", f"= {slices}", f"must be odd, 1 for the plane model or {FEWEST_SLICES} to {MOST_SLICES}"
        )
    if slices == 1:
        if _may_need_slices(drive):
            yield from _without_slices(drive)
        return
    axes = [("pin_wheel", drive.pin_wheel.inclination), ("crank", drive.crank.inclination)]
    if drive.pin_shaft is not None:
        axes.append(("pin_shaft", drive.pin_shaft.inclination))
    for path, inclination in axes:
        for name in ("x", "y"):
            if abs(angle := getattr(inclination, name)) > LARGEST_SLOPE:
                yield Problem.of(f"{path}.inclination.{name}", f"= {angle:g} rad", slope_bound())
    play, most = drive.disc.axial_play, drive.disc.thickness
    if play is not None and play > most:
        yield Problem.of(
            PLAY, f"= {play:g} mm", f"must be at most {most:g} mm, the thickness of the disc", bound=("at most", most)
        )


def _without_slices(drive: Drive) -> Iterator[Problem]:
    """The one problem of a drive with something along the width that no slices see."""
    found = [
        f"{path} = {shown(value)}{unit_of(declared)}"
        for declared in _needing()
        for path, value, default in given(drive, declared.split("."))
        if value != default and (path == PLAY or any(value if isinstance(value, tuple) else (value,)))
    ]
    if found:
        yield Problem.of(
            "contact.slices",
            "= 1",
            f"must be odd, {FEWEST_SLICES} to {MOST_SLICES}, with {', '.join(found)}: nothing varies along "
            "the width of one slice",
        )


@cache
def _needing() -> tuple[str, ...]:
    """Paths of the fields that need slices."""
    return tuple(path for path in declared_fields() if needs_slices(path))


def _may_need_slices(drive: Drive) -> bool:
    """Whether to look closer: studies check millions of drives without anything along the width."""
    parts = ((getattr(drive, name), read) for name, read in _readers())
    return (
        bool(drive.disc.of)
        or drive.disc.axial_play is not None
        or any(part is not None and any(read(part)) for part, read in parts)
    )


@cache
def _readers() -> tuple[tuple[str, Callable[[Any], tuple[Any, ...]]], ...]:
    """Members of a drive, and what reads all that needs slices of one; entries per disc apart."""
    names: dict[str, list[str]] = {}
    for path in _needing():
        member, _, name = path.partition(".")
        if ANY not in path.split("."):
            names.setdefault(member, []).append(name)
    # Of one name an attrgetter returns no tuple.
    return tuple((member, attrgetter(*own, own[0])) for member, own in names.items())


def slope_bound() -> str:
    """Return the bound of inclinations and slopes in words."""
    return (
        f"must be at most {LARGEST_SLOPE:g} rad in size, 10 mm in a metre; a plain number is in rad, other units are written as "
        '"0.5 mrad", "0.5 mm/m", "0.03°" or "2 arcmin"'
    )


def find_lead_problems(disc: Disc, bound: float) -> Iterator[Problem]:
    """Yield the problems of the flank of a disc along its width; drops are at most `bound`, mm."""
    for name in ("lead_crown_drop", "lead_relief_depth"):
        if (drop := getattr(disc, name)) > bound:
            yield Problem.of(
                f"disc.{name}",
                f"= {drop:g} mm",
                f"must be at most {bound:g} mm, a tenth of the smallest pin or roller radius; a plain number is "
                'in mm, micrometres are written "5 µm"',
                bound=("at most", bound),
            )
    if abs(disc.lead_slope) > LARGEST_SLOPE:
        yield Problem.of("disc.lead_slope", f"= {disc.lead_slope:g} rad", slope_bound())
    length, depth, half = disc.lead_relief_length, disc.lead_relief_depth, 0.5 * disc.thickness
    if length > half:
        yield Problem.of(
            "disc.lead_relief_length",
            f"= {length:g} mm",
            f"must be at most {half:g} mm, half the thickness of the disc",
            bound=("at most", half),
        )
    if length and not depth:
        yield Problem.of(
            "disc.lead_relief_depth",
            "= 0 mm",
            f"must be greater than 0 with disc.lead_relief_length = {length:g} mm, which relieves nothing alone",
        )
    if depth and not length:
        yield Problem.of(
            "disc.lead_relief_length",
            "= 0 mm",
            f"must be greater than 0 with disc.lead_relief_depth = {depth:g} mm, which relieves nothing alone",
        )
