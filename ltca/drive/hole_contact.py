"""The contact of holes and shaft pins: whether the pins are elastic there, and the modulus of the pair."""

from __future__ import annotations

from ltca.drive.parts import Drive, contact_modulus

RIGID_SHAFT_PINS = (
    "shaft pins are rigid at their holes (pin_shaft.elastic_contact = false), their material is not used; "
    "with elastic ones of the disc's material it would be about 1/√2 of that"
)
"""Note on the pressure of rigid shaft pins."""
SPRINGS_ALONE = (
    "pin_shaft.elastic_contact = false: without effect here, where springs are all that yields at the holes; "
    "pressures there are those of elastic pins"
)
"""Note on the pressure where shaft pins should be rigid and the model has springs in place of the contact."""


def shaft_pins_yield(drive: Drive) -> bool:
    """Tell whether what the holes touch is elastic with ``fe``, ``hybrid`` and full finite elements: sleeves always are."""
    shaft = drive.pin_shaft
    return shaft is None or shaft.elastic_contact or shaft.seat.kind == "sleeve"


def hole_words(drive: Drive, *, rigid_shaft_pins: bool) -> str:
    """Return the note on the pressures at the holes in a model; empty where shaft pins are elastic as they should be."""
    if drive.pin_shaft is None or drive.pin_shaft.elastic_contact:
        return ""
    return RIGID_SHAFT_PINS if rigid_shaft_pins else SPRINGS_ALONE


def hole_modulus(drive: Drive, *, rigid_shaft_pins: bool) -> float:
    """Return E* of the walls of the holes and what touches them, MPa: of the disc alone where shaft pins are rigid."""
    disc = drive.materials.disc
    return 1.0 / disc.plane_strain_compliance if rigid_shaft_pins else contact_modulus(disc, drive.hole_pin)
