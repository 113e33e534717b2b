"""Near fields of all contacts of a drive: the laws that `ltca.compliance.coupled` puts upon the body part."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.contact.tracked_grid import ContactKinds
from ltca.drive.parts import Drive, contact_modulus
from ltca.drive.plane_strain import require_plane_strain
from ltca.errors import DriveError
from ltca.geometry.placement import Placement
from ltca.laws.backed import back_wheel_pins
from ltca.laws.contact_law import ContactLaw
from ltca.laws.line_contact import LineContactLaw
from ltca.laws.plane_strain import PlaneContactLaw

NearField = Literal["plane-strain", "half-space"]

NEAR_FIELDS: dict[str, NearField] = {"fe": "plane-strain", "hybrid": "half-space"}
"""The near field of a compliance, by its name."""


@dataclass(frozen=True, slots=True, kw_only=True)
class NearFieldLaws:
    """Near fields of the contacts of a drive.

    Attributes
    ----------
    kind : {"plane-strain", "half-space"}
        What they are.
    pin, outer, inner, hole : ContactLaw
        Wheel pins and flank, rollers in the bore and on the inner race, shaft pins and holes.
    rigid_shaft_pins : bool
        Whether `hole` is the law of rigid shaft pins in yielding walls.
    datum : float
        Distance at which a near field in plane strain hands over to the body part, mm.
    kinds : ContactKinds
        Lengths and profiles, what pressures at the ends are read from.
    """

    kind: NearField
    pin: ContactLaw
    outer: ContactLaw
    inner: ContactLaw
    hole: ContactLaw
    rigid_shaft_pins: bool
    datum: float
    kinds: ContactKinds

    @classmethod
    def of_drive(cls, drive: Drive, kind: NearField, *, rigid_shaft_pins: bool) -> NearFieldLaws:
        """Return the near fields of a drive.

        Parameters
        ----------
        drive : Drive
            The drive.
        kind : {"plane-strain", "half-space"}
            Plane strain with a datum, or half-spaces with the lengths and profiles of rollers and pins.
        rigid_shaft_pins : bool
            Whether shaft pins are rigid.

        Raises
        ------
        DriveError
            For another kind; in plane strain, when the drive is not the same all along its thickness.
        """
        if kind not in get_args(NearField):
            raise DriveError([f"near_field = {kind!r}: must be one of {', '.join(map(repr, get_args(NearField)))}"])
        parts, thickness = drive.materials, drive.disc.thickness
        wall = 1.0 / parts.disc.plane_strain_compliance
        at_hole = wall if rigid_shaft_pins else contact_modulus(parts.disc, drive.hole_pin)
        # Only its logarithm enters, and cancels where the body part is in plane strain, too.
        datum = max(thickness, drive.pin_wheel.pin_radius, drive.crank_bearing.roller_radius)
        if kind == "half-space":
            half_space = HalfSpaceCompliance.of_drive(drive)
            return cls(
                kind=kind,
                pin=half_space.pin_law,
                outer=half_space.roller_laws.outer,
                inner=half_space.roller_laws.inner,
                hole=LineContactLaw(thickness, at_hole),
                rigid_shaft_pins=rigid_shaft_pins,
                datum=datum,
                kinds=half_space.kinds,
            )
        require_plane_strain(drive, "compliance fe")
        plays = Placement.of_drive(drive).wheel_pin_plays

        def law(modulus: float) -> PlaneContactLaw:
            return PlaneContactLaw(thickness=thickness, contact_modulus=modulus, datum=datum)

        return cls(
            kind=kind,
            pin=back_wheel_pins(drive, law(contact_modulus(parts.disc, drive.flank_pin)), plays),
            outer=law(contact_modulus(parts.disc, parts.roller)),
            inner=law(contact_modulus(parts.inner_race, parts.roller)),
            hole=law(at_hole),
            rigid_shaft_pins=rigid_shaft_pins,
            datum=datum,
            kinds=ContactKinds.of_drive(drive),
        )

    @property
    def has_ends(self) -> bool:
        """Whether contacts end somewhere: in plane strain they do not."""
        return self.kind == "half-space"
