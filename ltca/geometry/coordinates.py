"""The coordinates of a pose and their places: discs, cranks that yield, the wheel if its bearing yields, the angle of the wheel.

A pose of one disc at a held crank angle is q = (x, y, disc rotation, …, wheel angle): x and y in mm are the displacement of
the disc from its nominal place in the fixed frame, the angles in rad; the wheel angle is its deviation from φ_C/u. Between
them stand x and y of each crank in the plane of the disc, if cranks yield, and the angle by which each eccentric is ahead of
the crank, if they twist; if contacts have slices, the leans of these cranks and of the disc; x and y of the wheel, if its bearing
yields, and its lean, if it yields in tilt; and x, y and rotation of the ring that ties the tips of the shaft pins, or of the far
flange of the carrier, if there is one. The poses of several discs follow each other, with one wheel.

A lean is what x and y of a part change by along its axis, dx/dz and dy/dz about the middle of the disc: with the rotation
vector ω of a small tilt it is (ω_y, −ω_x). As an arrow of the plane it turns as displacements do.
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
    """Members whose displacements make up a pose: the number of discs, and what yields beside them.

    Attributes
    ----------
    discs, cranks : int
        Number of discs, and of cranks that yield; none where these are rigid.
    wheel, wheel_leans : bool
        Whether the wheel's bearing yields, and whether it leans as well.
    ring : bool
        Whether a ring ties the tips of the shaft pins and floats, or is the far flange of a carrier on posts.
    twists, leans : bool
        Whether cranks yield in torsion, and whether discs lean, and cranks that yield in their planes.
    """

    discs: int = 1
    cranks: int = 0
    wheel: bool = False
    ring: bool = False
    twists: bool = False
    leans: bool = False
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
        """Number of coordinates of each disc: x, y, rotation, x and y of every crank there, the twist of every crank, the
        lean of every crank and its own.
        """
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

        Examples
        --------
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
        """Return the places of x of a crank at every disc, followed by those of its lean there if discs lean; each has its y
        behind it.
        """
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
        """Places of the angles.

        Examples
        --------
        >>> Coordinates(discs=2, cranks=1).rotations.tolist()
        [2, 7, 10]
        """
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
