"""Width of the contacts: slices along them, and parts that stand inclined."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field
from pydantic.dataclasses import dataclass

from ltca.drive.deviations import STRICT, Angle
from ltca.drive.units.quantities import COUNT


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class Contact:
    """How contacts are described along their width.

    Attributes
    ----------
    slices : int
        Slices along the width of every contact, an odd number: 1 is the plane model, in which nothing tilts.
    """

    slices: Annotated[int, Field(ge=1, le=99), COUNT] = 1


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class Inclination:
    """Small rotation of an axis about two axes of the fixed frame.

    Attributes
    ----------
    x : float
        About the x axis, along the crank at crank angle zero, rad: the upper end moves towards −y.
    y : float
        About the y axis, 90° ahead of it, rad: the upper end moves towards x.
    """

    x: Angle = 0.0
    y: Angle = 0.0

    @property
    def lean(self) -> complex:
        """dx/dz and dy/dz of the axis as a complex number."""
        return complex(self.y, -self.x)
