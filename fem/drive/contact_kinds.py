"""The kinds of contacts of one disc, and what each is called in results, tables and pictures."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from ltca.geometry.placement import Placement

PairKind = Literal["pin", "roller_outer", "roller_inner", "hole"]


@dataclass(frozen=True, slots=True, kw_only=True)
class ContactKind:
    """Names of one kind of contacts.

    Attributes
    ----------
    load, pressure, half_width : str
        Its arrays in `fem.drive.contact_results.ContactResults`, by their names in `ltca.quantities`.
    part : str
        The part that touches the disc or the race.
    name, title : str
        Of one contact, short and in full, with its number in place of ``{}``.
    """

    load: str
    pressure: str
    half_width: str
    part: str
    name: str
    title: str

    def name_of(self, index: int, placement: Placement) -> str:
        """Return what one contact is called in short."""
        return _numbered(self.name, index, placement)

    def title_of(self, index: int, placement: Placement) -> str:
        """Return what one contact is called in full."""
        return _numbered(self.title, index, placement)


def _numbered(text: str, index: int, placement: Placement) -> str:
    """A text with the number of a contact: rollers of several cranks count anew in every bearing."""
    if not text.startswith("roller") or placement.cranks == 1:
        return text.format(index)
    crank, roller = divmod(index, placement.roller_radii.size // placement.cranks)
    return f"crank {crank}, {text.format(roller)}"


CONTACT_KINDS: dict[PairKind, ContactKind] = {
    "pin": ContactKind(
        load="pin_load",
        pressure="pin_pressure_mid",
        half_width="pin_half_width",
        part="wheel pin",
        name="pin {}",
        title="pin {} on the flank",
    ),
    "roller_outer": ContactKind(
        load="roller_load",
        pressure="roller_pressure_mid_outer",
        half_width="roller_half_width_outer",
        part="roller",
        name="roller {} bore",
        title="roller {} on the bore",
    ),
    "roller_inner": ContactKind(
        load="roller_load_inner",
        pressure="roller_pressure_mid_inner",
        half_width="roller_half_width_inner",
        part="roller",
        name="roller {} race",
        title="roller {} on the race",
    ),
    "hole": ContactKind(
        load="pin_shaft_load",
        pressure="pin_shaft_pressure_mid",
        half_width="pin_shaft_half_width",
        part="shaft pin",
        name="shaft pin {}",
        title="shaft pin {} in its hole",
    ),
}
"""All kinds; the disc carries the pressure of each but ``roller_inner``, the inner race that one."""
