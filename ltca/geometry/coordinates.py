"""The coordinates of a pose at a held crank angle and their places, in mm and rad (docs/theory/balance.md).

q = (x, y, rotation of the disc; x, y of each crank; twist of each; lean of each and of the disc; x, y and lean of the wheel; x,
y, rotation of ring or far flange; wheel angle, its deviation from φ_C/u) as far as they yield; several discs follow each other,
with one wheel. A lean is dx/dz + i dy/dz about the middle of the disc: with the rotation vector ω it is (ω_y, −ω_x).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import ComplexArray, FloatArray
from ltca.drive.parts import Drive

Columns = NDArray[np.intp]

X, Y, DISC_ROTATION, WHEEL_ANGLE = 0, 1, 2, -1
"""Places of the coordinates in poses, gradients and forces; the wheel angle is the last one."""
DISC_PLACE = slice(X, Y + 1)
RIGID = 4
"""Number of coordinates of one disc on members that do not yield."""


def disc_displacement(pose: FloatArray) -> ComplexArray:
    """Return x + iy of poses, shape (…, coordinates): displacement of the (first) disc in the fixed frame, mm."""
    return np.asarray(pose[..., X] + 1j * pose[..., Y])


@dataclass(frozen=True, slots=True, kw_only=True)
class Coordinates:
    """Members whose displacements make up a pose: the number of discs, and the parts that yield beside them."""

    discs: int = 1
    cranks: int = 0  # that yield; 0 where they are rigid
    wheel: bool = False  # whether its bearing yields
    ring: bool = False  # whether one ties the tips of shaft pins and floats, or is the far flange of a carrier
    twists: bool = False  # whether cranks yield in torsion
    leans: bool = False  # whether discs lean, and cranks that yield in their planes
    wheel_leans: bool = False

    @classmethod
    def of_drive(cls, drive: Drive) -> Coordinates:
        """Return the coordinates of a drive of any number of discs."""
        support = drive.crank.support
        beam = None if drive.pin_shaft is None else drive.pin_shaft.beam
        return cls(
            discs=drive.disc.number_of_discs,
            cranks=0 if support is None else drive.crank.number,
            wheel=drive.wheel_yields,
            ring=drive.posts is not None or (beam is not None and beam.tip != "free"),
            twists=support is not None and support.torsion,
            leans=drive.contact.slices > 1,
            wheel_leans=drive.wheel_tilts,
        )

    @property
    def own(self) -> int:
        """Number of coordinates of each disc, with those of the cranks at it."""
        return DISC_ROTATION + 1 + (2 + self.twists + 2 * self.leans) * self.cranks + 2 * self.leans

    @property
    def shared(self) -> int:
        """Number of coordinates of wheel and ring."""
        return 1 + 2 * self.wheel + 2 * self.wheel_leans + 3 * self.ring

    @property
    def size(self) -> int:
        """Number of all coordinates."""
        return self.discs * self.own + self.shared

    def columns(self, disc: int) -> Columns:
        """Return the places of the coordinates of a disc followed by those of wheel and ring.

        >>> Coordinates(discs=2).columns(1).tolist(), Coordinates(cranks=1, wheel=True).columns(0).tolist()
        ([3, 4, 5, 6], [0, 1, 2, 3, 4, 5, 6, 7])
        """
        first, last = self.own * disc, self.size
        return np.concatenate([np.arange(first, first + self.own), np.arange(last - self.shared, last)])

    def crank(self, crank: int) -> int:
        """Return the place of x of a crank in the pose of one disc."""
        return DISC_ROTATION + 1 + 2 * crank

    @property
    def twist_places(self) -> tuple[int, ...]:
        """Places of the twist of every crank in the pose of one disc; none where cranks do not twist."""
        first = self.crank(self.cranks)
        return tuple(range(first, first + self.cranks)) if self.twists else ()

    def crank_lean(self, crank: int) -> int:
        """Return the first of the two places of the lean of a crank in the pose of one disc, where discs lean."""
        return self.own - 2 * (1 + self.cranks - crank)

    def journals(self, crank: int) -> Columns:
        """Return the places of x, which y follows, of a crank at every disc, then of its leans there if discs lean."""
        places = [self.crank(crank), self.crank_lean(crank)] if self.leans else [self.crank(crank)]
        return (np.array(places)[:, None] + self.own * np.arange(self.discs)).ravel()

    @property
    def lean_place(self) -> slice:
        """Lean of a disc in its pose; empty where it does not lean."""
        return slice(self.own - 2 * self.leans, self.own)

    @property
    def wheel_place(self) -> slice:
        """x and y of the wheel; empty where its bearing does not yield."""
        first = self.size - self.shared
        return slice(first, first + 2 * self.wheel)

    @property
    def wheel_lean_place(self) -> slice:
        """Lean of the wheel; empty where it does not lean."""
        first = self.wheel_place.stop
        return slice(first, first + 2 * self.wheel_leans)

    @property
    def ring_place(self) -> slice:
        """x, y and rotation of the ring; empty where there is none."""
        return slice(self.size - 1 - 3 * self.ring, self.size - 1)

    @property
    def rotations(self) -> Columns:
        """Places of the angles."""
        shared = [self.size - 2, self.size - 1] if self.ring else [self.size - 1]
        return np.append(DISC_ROTATION + self.own * np.arange(self.discs), shared)

    @property
    def displacements(self) -> Columns:
        """Places of every x that is followed by its y: discs, cranks, leans, wheel, ring."""
        leans = self.own - 2 * (self.cranks + 1) * self.leans
        one = np.r_[X, DISC_ROTATION + 1 : self.crank(self.cranks) : 2, leans : self.own : 2]
        each = (self.own * np.arange(self.discs)[:, None] + one).ravel()
        shared = (self.wheel_place, self.wheel_lean_place, self.ring_place)
        return np.append(each, [place.start for place in shared if place.stop > place.start]).astype(np.intp)
