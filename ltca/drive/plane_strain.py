"""What some models cannot say about a drive: what varies along parts, several cranks, supports, loose pins, friction."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields
from typing import Any

from ltca.drive.parts import Drive, LengthProfile, contact_modulus
from ltca.errors import DriveError

ROUNDING = 1e-9
"""Lengths that differ by less than this part of the thickness are one length."""
RIGID_SHAFT_PINS = (
    "shaft pins are rigid at their holes (pin_shaft.elastic_contact = false), their material is not used; "
    "elastic ones of the disc's own would read about 1/√2 of it"
)
"""What stands beside the pressure of rigid shaft pins."""
SPRINGS_ALONE = (
    "pin_shaft.elastic_contact = false: without effect here, where springs are all that yields at the holes; "
    "pressures there are those of elastic pins"
)
"""What stands beside the pressure of shaft pins that should be rigid where the model has no contact at the holes."""


def require_plane_strain(drive: Drive, model: str) -> None:
    """Refuse a drive that is not the same all along its thickness.

    Parameters
    ----------
    drive : Drive
        The drive.
    model : str
        What it is refused by, for the message.

    Raises
    ------
    DriveError
        One sentence for each field: rollers shorter than the disc, crown and relief of rollers and pins.
    """
    problems = list(_find_problems(drive, model))
    if problems:
        raise DriveError(problems)


def require_one_bore(drive: Drive, model: str) -> None:
    """Refuse a drive of several cranks.

    Parameters
    ----------
    drive : Drive
        The drive.
    model : str
        What it is refused by, for the message.

    Raises
    ------
    DriveError
        With the number of cranks.
    """
    if drive.crank.number > 1:
        raise DriveError(
            [f"crank.number = {drive.crank.number}: must be 1 for {model}, which knows discs with one bore"]
        )


def require_rigid_members(drive: Drive, model: str) -> None:
    """Refuse a drive of members that yield on their supports.

    Parameters
    ----------
    drive : Drive
        The drive.
    model : str
        What it is refused by, for the message.

    Raises
    ------
    DriveError
        One sentence for each field.
    """
    problems, stiffness = [], drive.pin_wheel.support_stiffness
    if drive.crank.support is not None:
        fields = ", ".join(f"crank.support.{name}" for name in ("diameter", "positions", "stiffness"))
        problems.append(f"crank.support ({fields}): must be left out for {model}, where cranks are rigid")
    if stiffness is not None:
        problems.append(
            f"pin_wheel.support_stiffness = {stiffness:g} N/mm: must be left out for {model}, where the wheel's axis stands still"
        )
    if problems:
        raise DriveError(problems)


def pins_are_fixed(drive: Drive) -> bool:
    """Tell whether no pin lies loose, carries a sleeve or bends."""
    parts = (drive.pin_wheel, drive.pin_shaft)
    return all(part is None or (part.seat.kind == "fixed" and part.beam is None) for part in parts)


def shaft_pins_yield(drive: Drive) -> bool:
    """Tell whether what the holes touch yields there, with ``fe``, ``hybrid`` and full finite elements: sleeves always do."""
    shaft = drive.pin_shaft
    return shaft is None or shaft.elastic_contact or shaft.seat.kind == "sleeve"


def hole_words(drive: Drive, *, rigid_shaft_pins: bool) -> str:
    """Return what to say beside the pressures at the holes of a model; nothing where shaft pins yield as they should."""
    if drive.pin_shaft is None or drive.pin_shaft.elastic_contact:
        return ""
    return RIGID_SHAFT_PINS if rigid_shaft_pins else SPRINGS_ALONE


def hole_modulus(drive: Drive, *, rigid_shaft_pins: bool) -> float:
    """Return E* of the walls of the holes and what touches them, MPa: of the disc alone where shaft pins are rigid."""
    disc = drive.materials.disc
    return 1.0 / disc.plane_strain_compliance if rigid_shaft_pins else contact_modulus(disc, drive.hole_pin)


def require_fixed_pins(drive: Drive, model: str) -> None:
    """Refuse a drive of pins that lie loose, carry sleeves or bend.

    Parameters
    ----------
    drive : Drive
        The drive.
    model : str
        What it is refused by, for the message.

    Raises
    ------
    DriveError
        One sentence for each seat and each beam, with its fields.
    """
    problems = []
    for path, pins in (("pin_wheel", drive.pin_wheel), ("pin_shaft", drive.pin_shaft)):
        if pins is None:
            continue
        if pins.seat.kind != "fixed":
            problems.append(f"{_told(f'{path}.seat', pins.seat)}: must be left out for {model}, where pins are fixed")
        if pins.beam is not None:
            instead = "" if path == "pin_wheel" else " (give pin_shaft.stiffness)"
            problems.append(
                f"{_told(f'{path}.beam', pins.beam)}: must be left out for {model}, where pins do not bend{instead}"
            )
    if problems:
        raise DriveError(problems)


def require_frictionless(drive: Drive, model: str) -> None:
    """Refuse a drive with friction.

    Parameters
    ----------
    drive : Drive
        The drive.
    model : str
        What it is refused by, for the message.

    Raises
    ------
    DriveError
        With the fields of the table.
    """
    if drive.friction is not None:
        raise DriveError([f"{_told('friction', drive.friction)}: must be left out for {model}, where nothing rubs"])


def _told(path: str, part: Any) -> str:
    """A part with all that it may hold."""
    return f"{path} ({', '.join(f'{path}.{item.name}' for item in fields(part))})"


def _find_problems(drive: Drive, model: str) -> Iterator[str]:
    wheel, bearing, thickness = drive.pin_wheel, drive.crank_bearing, drive.disc.thickness
    place = f"in two dimensions ({model}); use --compliance hybrid"
    if abs(bearing.roller_length - thickness) > ROUNDING * thickness:
        yield (
            f"crank_bearing.roller_length = {bearing.roller_length:g} mm: must be {thickness:g} mm, the thickness of the "
            f"disc, {place}"
        )
    for path, profile in (
        ("crank_bearing.roller_profile", bearing.roller_profile),
        ("pin_wheel.pin_profile", wheel.pin_profile),
    ):
        for name, value in _departures(profile):
            yield f"{path}.{name} = {value}: must be 0 {place}"


def _departures(profile: LengthProfile) -> Iterator[tuple[str, str]]:
    """Yield the fields that make a profile depart from the cylinder: a relief takes both its length and its depth."""
    if profile.crown_drop > 0.0:
        yield "crown_drop", f"{profile.crown_drop:g} mm"
    if profile.logarithmic_factor > 0.0:
        yield "logarithmic_factor", f"{profile.logarithmic_factor:g}"
    if profile.end_relief_length > 0.0 and profile.end_relief_depth > 0.0:
        yield "end_relief_length", f"{profile.end_relief_length:g} mm"
        yield "end_relief_depth", f"{profile.end_relief_depth:g} mm"
