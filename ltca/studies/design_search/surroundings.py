"""What holds the contacts of the drives that are searched: ring, carrier, main bearing, first stage, forces from outside.

Tables of a requirement file have the fields of the same tables in a drive file, but for sizes that follow those that are
searched: the ring is the wall outside the wheel pins, the posts of the carrier stand on the circle of shaft pins or cranks unless
they are placed, and the teeth of the first stage are those that give the ratio.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field, fields
from math import cos
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field
from pydantic.dataclasses import dataclass

from ltca.drive.deviations import STRICT, NonNegativeLength, PositiveLength, SignedLength
from ltca.drive.materials import Material
from ltca.drive.members.carrier import TorsionalStiffness
from ltca.drive.members.first_stage import FirstStage
from ltca.drive.members.main_bearing import BearingRow, MainBearing
from ltca.drive.members.operation import ExternalLoad
from ltca.drive.members.preload import Stiffness
from ltca.drive.ring_shape import LEAST_HALF_ARC
from ltca.drive.units.quantities import COUNT, quantity

TEETH_TO_RING = 0.1
"""Gap between the teeth of a disc and the ring that is kept where they decide how deep pins are seated, by the pin radius."""


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class WantedBolts:
    """Bolts of the ring, in the middle of the wall outside the wheel pins.

    Attributes
    ----------
    number : int
        Number of bolts.
    stiffness : float
        Stiffness of one bolt against radial and against tangential displacement, N/mm.
    """

    number: Annotated[int, Field(ge=3, le=200), COUNT]
    stiffness: Stiffness


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class WantedRing:
    """The ring, which is the wall outside the wheel pins (``shop.housing_wall``): its outer radius is that of the drive.

    Attributes
    ----------
    width : float or None
        Axial width, mm; the length of the drive when left out.
    material, flange, model
        As in a drive file.
    bolts : WantedBolts or None
        Bolts between a free ring and a rigid housing.
    """

    width: PositiveLength | None = None
    material: Material = field(default_factory=Material)
    flange: Literal["free", "one-side", "built-in"] = "free"
    bolts: WantedBolts | None = None
    model: Literal["beam", "fe"] = "beam"


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class WantedPosts:
    """Posts of the carrier.

    Attributes
    ----------
    number : int
        Number of posts.
    size : float
        Diameter of each post, mm.
    radius : float or None
        Radius of the circle of the posts, mm; that of shaft pins or cranks when left out.
    length : float or None
        As in a drive file, mm.
    """

    number: Annotated[int, Field(ge=2, le=100), COUNT]
    size: PositiveLength
    radius: PositiveLength | None = None
    length: PositiveLength | None = None


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class WantedCarrier:
    """The carrier, as in a drive file but for the circle of its posts.

    Attributes
    ----------
    stiffness_torsion : float or None
        Torsional stiffness between the near flange and what it is fixed to, N·mm/rad; rigid when left out.
    flange : tuple of float or None
        Thicknesses of the near and the far flange, mm; rigid when left out.
    posts : WantedPosts or None
        Posts between the flanges; when left out the flanges do not move against each other.
    """

    stiffness_torsion: TorsionalStiffness | None = None
    flange: tuple[PositiveLength, PositiveLength] | None = None
    posts: WantedPosts | None = None


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class WantedStage:
    """The first stage, as in a drive file but for its teeth and their module: pitch circles are reference circles.

    Attributes
    ----------
    pressure_angle, helix_angle : float
        At the reference circle, rad.
    backlash : float
        Circumferential backlash at the pitch circles, mm.
    mesh_stiffness : float or None
        Of one mesh along the line of action, N/mm; rigid when left out.
    plane : float or None
        Axial place of the middle of the planets, mm.
    """

    pressure_angle: Annotated[float, quantity("rad", gt=0.0, lt=0.25 * np.pi)] = float(np.pi / 9.0)
    helix_angle: Annotated[float, quantity("rad", gt=-0.25 * np.pi, lt=0.25 * np.pi)] = 0.0
    backlash: NonNegativeLength = 0.0
    mesh_stiffness: Annotated[float, quantity("N/mm", gt=0.0)] | None = None
    plane: SignedLength | None = None


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class WantedLoad:
    """What acts on the output beside the torque.

    Attributes
    ----------
    external : tuple of ExternalLoad
        As in a drive file.
    """

    external: tuple[ExternalLoad, ...] = ()


FOLLOWING = {
    "ring.inner_radius": "the ring follows the searched pin circle: pins are sunk into it by half, or less where teeth need room",
    "ring.outer_radius": "the ring follows the searched pin circle: shop.housing_wall is its metal outside the wheel pins",
    "ring.bolts.circle_radius": "bolts follow the searched pin circle: they stand in the middle of shop.housing_wall",
    "first_stage.sun_teeth": "teeth are searched: they give the ratio",
    "first_stage.planet_teeth": "teeth are searched: they give the ratio",
    "first_stage.module": "it follows the searched circle of the cranks: pitch circles are reference circles",
    "load.torque": "the key torque says it",
    "load.light_torque": "it is a fixed part of the torque",
    "load.speed": "the key speed says it",
}
"""Fields of the same tables in a drive file that follow what is searched, and from what."""

TABLES: dict[str, tuple[str, ...]] = {
    table: tuple(item.name for item in fields(kind))
    for table, kind in (
        ("ring", WantedRing),
        ("ring.bolts", WantedBolts),
        ("carrier", WantedCarrier),
        ("carrier.posts", WantedPosts),
        ("main_bearing", MainBearing),
        ("main_bearing.bearings", BearingRow),
        ("first_stage", WantedStage),
        ("load", WantedLoad),
        ("load.external", ExternalLoad),
    )
}
"""Names of fields of the tables of a requirement file, by table."""


def without_following(table: Mapping[str, Any], problems: list[str]) -> dict[str, Any]:
    """Return the tables of a requirement file without fields that follow what is searched, each of which is a problem."""
    found = {key: dict(value) if isinstance(value, Mapping) else value for key, value in table.items()}
    for path, why in FOLLOWING.items():
        *above, name = path.split(".")
        here: Any = found
        for part in above:
            inner = here.get(part) if isinstance(here, dict) else None
            if isinstance(inner, Mapping) and isinstance(here, dict):
                here[part] = inner = dict(inner)
            here = inner
        if isinstance(here, dict) and name in here:
            del here[name]
            problems.append(f"{path}: must be left out of requirements: {why}")
    return found


def seat_depth(pin_circle: Any, pin_radius: Any, eccentricity: Any) -> Any:
    """Return by how much seats of wheel pins in the ring are deeper than the shallowest that lead them, mm."""
    corner = pin_circle**2 + pin_radius**2 + 2.0 * pin_circle * pin_radius * cos(LEAST_HALF_ARC)
    return np.sqrt(corner) - inner_radius(pin_circle, pin_radius, eccentricity)


def inner_radius(pin_circle: Any, pin_radius: Any, eccentricity: Any) -> Any:
    """Return the inner radius of the ring, mm: that of the pin circle, or more where the teeth of the discs reach there."""
    reached = pin_circle - pin_radius + 2.0 * eccentricity
    return np.maximum(pin_circle, reached + TEETH_TO_RING * pin_radius)


def ring_table(ring: WantedRing, row: Mapping[str, float], wall: float, length: float) -> dict[str, Any]:
    """Return the ring of a candidate as the table of a drive file; `wall` outside the pins and `length` of the drive in mm."""
    outer = row["pin_circle"] + row["pin_radius"] + wall
    bolts = ring.bolts
    held = (
        {}
        if bolts is None
        else {"number": bolts.number, "circle_radius": outer - 0.5 * wall, "stiffness": bolts.stiffness}
    )
    return {
        "inner_radius": float(inner_radius(row["pin_circle"], row["pin_radius"], row["eccentricity"])),
        "outer_radius": outer,
        "width": length if ring.width is None else ring.width,
        "material": ring.material,
        "flange": ring.flange,
        "model": ring.model,
        **({"bolts": held} if held else {}),
    }


def carrier_table(carrier: WantedCarrier, row: Mapping[str, float]) -> dict[str, Any]:
    """Return the carrier of a candidate as the table of a drive file."""
    posts, found = carrier.posts, {"stiffness_torsion": carrier.stiffness_torsion, "flange": carrier.flange}
    if posts is None:
        return found
    own = {item.name: getattr(posts, item.name) for item in fields(posts)}
    return found | {"posts": own | {"radius": posts.radius or row["hole_circle"]}}


def stage_of(stage: WantedStage, row: Mapping[str, float]) -> FirstStage:
    """Return the first stage of a candidate."""
    own = {item.name: getattr(stage, item.name) for item in fields(stage)}
    return FirstStage(sun_teeth=int(row["sun"]), planet_teeth=int(row["planet"]), **own)
