"""Carrier: two flanges, tied by posts, between which shaft pins or cranks stand, and what twists between it and the output."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field
from pydantic.dataclasses import dataclass

from ltca.drive.deviations import STRICT, PositiveLength
from ltca.drive.units.quantities import COUNT, grows, quantity

TorsionalStiffness = Annotated[float, quantity("N*mm/rad", gt=0.0)]


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class CarrierPosts:
    """Posts that tie the far flange to the near one, evenly spaced round bars that are fixed in both.

    Attributes
    ----------
    number : int
        Number of posts.
    radius : float
        Radius of the circle of the posts, mm.
    size : float
        Diameter of each post, mm.
    length : float or None
        Length of each post from flange to flange, mm; when left out ``pin_shaft.beam.span``, or as long as the discs with the
        gaps between and beside them (``disc.gap``).
    """

    number: Annotated[int, Field(ge=2, le=100), COUNT]
    radius: Annotated[PositiveLength, grows("carrier")]
    size: Annotated[PositiveLength, grows("carrier")]
    length: Annotated[PositiveLength | None, grows("carrier")] = None


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class Carrier:
    """Carrier of shaft pins and cranks; rigid in one piece when left out.

    The output, or with the pin shaft held the housing, is fixed to the near flange, which bears the ends of shaft pins and cranks
    at negative axial places and is the frame of the analysis. The far flange bears their other ends and moves against it.

    Attributes
    ----------
    stiffness_torsion : float or None
        Torsional stiffness between the near flange and what it is fixed to, N·mm/rad; rigid when left out.
    flange : tuple of float or None
        Thicknesses of the near and the far flange, which bend between the posts, mm; rigid when left out.
    posts : CarrierPosts or None
        Posts between the flanges; when left out the flanges do not move against each other.
    """

    stiffness_torsion: TorsionalStiffness | None = None
    flange: Annotated[tuple[PositiveLength, PositiveLength] | None, grows("carrier")] = None
    posts: CarrierPosts | None = None
