"""Width of the contacts: slices along them, parts that stand inclined, and the fields that need slices."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field
from pydantic.dataclasses import dataclass

from ltca.drive.deviations import STRICT, Angle
from ltca.drive.units.quantities import COUNT

MOST_SLICES = 65
"""Far beyond what any answer still changes by, and the dearest that fits beside a batch of positions."""
FEWEST_SLICES = 3
"""With which something may tilt."""
LARGEST_SLOPE = 0.01
"""Largest inclination or slope, rad: beyond it disc and pins are a different design, and angles are no small ones any more."""


def needs_slices(path: str) -> bool:
    """Tell whether a field, or the table of one, concerns the width of the contacts, of which one slice knows nothing.

    Examples
    --------
    >>> needs_slices("disc.of.0.hole_errors.inclination_x"), needs_slices("pin_wheel.inclination.y"), needs_slices("load.torque")
    (True, True, False)
    """
    own = ("axial_play", "tilt_stiffness")
    return any(name in own or name.startswith(("lead_", "inclination")) for name in path.split("."))


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class Contact:
    """How contacts are described along their width.

    Attributes
    ----------
    slices : int
        Slices along the width of every contact, an odd number: 1 is the plane model, in which nothing tilts and flanks are
        straight.
    """

    slices: Annotated[int, Field(ge=1, le=MOST_SLICES), COUNT] = 1


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
