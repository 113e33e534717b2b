"""The ring of the pin wheel: the elastic part in which the wheel pins are seated."""

from __future__ import annotations

from dataclasses import field
from typing import Annotated, Literal

from pydantic import Field
from pydantic.dataclasses import dataclass

from ltca.drive.deviations import STRICT, PositiveLength
from ltca.drive.materials import Material
from ltca.drive.members.preload import Stiffness
from ltca.drive.units.quantities import COUNT, grows


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class RingBolts:
    """Bolts that hold the ring of the pin wheel to a rigid housing, evenly spaced from the angle of wheel pin 0.

    Attributes
    ----------
    number : int
        Number of bolts.
    circle_radius : float
        Radius of the bolt circle, mm.
    stiffness : float
        Stiffness of one bolt against radial and against tangential displacement, N/mm.
    """

    number: Annotated[int, Field(ge=3, le=200), COUNT]
    circle_radius: Annotated[PositiveLength, grows("wheel")]
    stiffness: Stiffness


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class Ring:
    """Elastic ring of the pin wheel: the wheel pins press it, and their seats move with it.

    Attributes
    ----------
    inner_radius : float
        Inner radius of the ring, mm; pins may be sunk into it.
    outer_radius : float
        Outer radius of the ring, mm.
    width : float
        Axial width of the ring, mm.
    material : Material
        Material of the ring, by name or by its properties. Its thermal expansion, where given, is that of the whole wheel.
    flange : {"free", "one-side", "built-in"}
        How the ring is held: free to deform, its seats displaced relative to the rigid motion that fits them best; by a flange
        on one side, which a plane model cannot represent; or with its outer face in a rigid housing.
    bolts : RingBolts or None
        Bolts between a free ring and a rigid housing; without them a free ring floats.
    model : {"beam", "fe"}
        Curved beam in Fourier series, or plane finite elements of the ring with its seats (``cyclo derive --part ring``).
    """

    inner_radius: Annotated[PositiveLength, grows("wheel")]
    outer_radius: Annotated[PositiveLength, grows("wheel")]
    width: Annotated[PositiveLength, grows("wheel")]
    material: Material = field(default_factory=Material)
    flange: Literal["free", "one-side", "built-in"] = "free"
    bolts: RingBolts | None = None
    model: Literal["beam", "fe"] = "beam"
