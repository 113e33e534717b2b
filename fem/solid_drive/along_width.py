"""What of a drive varies along the width: lengths, layers, reliefs and leans.

Disc, wheel pins, shaft pins and inner race are as long as the disc is thick; rollers are as long as they are, no longer than
that, and so are their contacts.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem.drive.model import ContactPair, DrivePose, PlacedContacts
from fem.solid.layer_count import require_layers
from fem.solid.layers import Layers, Parity, graded_layers
from fem.solid_contact.widths import WidthGrid
from ltca.drive.parts import Drive
from ltca.geometry.placement import Placement

FINEST = 0.4
"""Thickness of the last layer at a free end by that of the first in the middle."""
ROUNDING = 1e-9
"""Relative difference up to which two lengths are equal."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveWidths:
    """Lengths of the bodies of a drive and grids along them.

    Attributes
    ----------
    drive : Drive
        Of one disc.
    layers : int
        Over half of a length.
    """

    drive: Drive
    layers: int

    def __post_init__(self) -> None:
        require_layers(self.layers)

    @property
    def even(self) -> bool:
        """Whether everything is its own mirror image in mid-width, so that nothing tilts."""
        place = Placement.of_drive(self.drive)
        leans = np.concatenate([place.wheel_pin_leans, place.hole_leans, place.shaft_pin_leans])
        axes = (complex(place.wheel_lean), complex(place.crank_lean))
        return self.drive.disc.lead_slope == 0.0 and not np.any(leans) and not any(axes)

    @property
    def parities(self) -> tuple[Parity, ...]:
        """Classes of displacements that are needed."""
        return ("symmetric",) if self.even else ("symmetric", "antisymmetric")

    def length_of(self, body: str) -> float:
        """Return the length of a body or contact by its name, mm: rollers and what they press on their own, others the disc's."""
        return self.drive.roller_length if body.startswith("roller") else self.drive.disc.thickness

    def layers_of(self, body: str) -> tuple[Layers, ...]:
        """Return the layers of a body in every class: one ends where a shorter body that it touches does."""
        return tuple(self._graded(self.length_of(body), parity) for parity in self.parities)

    def grid(self, body: str) -> WidthGrid:
        """Return the vertices of the pressure along a body or contact by its name: the ends of its layers."""
        upper = self._graded(self.length_of(body), "symmetric").vertices
        return WidthGrid(heights=upper if self.even else np.concatenate([-upper[:0:-1], upper]), even=self.even)

    def _graded(self, length: float, parity: Parity) -> Layers:
        roller = self.drive.roller_length
        marks = (0.5 * roller,) if roller < (1.0 - ROUNDING) * length else ()
        return graded_layers(length, self.layers, parity, finest=FINEST, marks=marks)


def lean_apart(model: PlacedContacts, pair: ContactPair, pose: DrivePose) -> complex:
    """Return by how much the round side of a pair leans from the side that carries the pressure, rad, before either tilts.

    As dx/dz + i dy/dz in the fixed frame (`ltca.drive.members.width.Inclination.lean`); that of the disc itself and those
    of rollers are unknowns.
    """
    place = model.placement
    if pair.kind == "pin":
        return complex(place.wheel_lean) + complex(place.wheel_pin_leans[pair.index]) * model.wheel_direction(pose)
    if pair.kind == "hole":
        turn = complex(np.exp(1j * pose.disc_rotation))
        return complex(place.shaft_pin_leans[pair.index]) - complex(place.hole_leans[pair.index]) * turn
    # Cages lean with their cranks, and hold rollers across their rays.
    ray, crank = complex(model.roller_rays[pair.index]), complex(place.crank_lean)
    across = crank - ray * (ray.conjugate() * crank).real
    return across - crank if pair.kind == "roller_inner" else across
