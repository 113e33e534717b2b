"""Free play of the wheel: its rotation while no body deforms, with all clearances together, crank held, discs floating.

The farthest wheel angle at which no pair interferes is found by successive linear programmes in the poses of the discs (joined
where wheel or cranks are loose in their bearings): gaps are linearised, g − ∇δ·d ≥ −t, the overlap t is made least, then the
wheel turned as far as they allow. Tangents of the arcs of races and holes at earlier poses remain bounds, as arcs are convex: the
farthest pose may lie where arc and turning have one tangent. Definition and error over a turn: docs/theory/conventions.md.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import BoolArray, FloatArray, stack_drives, take_rows
from ltca.errors import ConvergenceError
from ltca.geometry.coordinates import DISC_ROTATION, RIGID, WHEEL_ANGLE, Coordinates
from ltca.geometry.length_profile import ACROSS
from ltca.geometry.pair_motion import PairTilt
from ltca.geometry.pairs import ContactGeometry

Rows = NDArray[np.intp]
_Gap = tuple[FloatArray, FloatArray]

CLOSED = 1e-9
"""Overlap treated as none, mm: a thousandth of the least clearance that counts as one."""
RELIEF = 2e-11
"""Overlap that is always allowed, mm, so that parts without any clearance have a feasible pose."""
LEAST_GAIN = 1e-9
"""Displacement of the wheel at e z_P, mm, that a programme must promise to be followed: some 1e-7 arcmin."""
PENALTY = 1e6
"""Cost of overlap relative to displacement of the wheel: wedges of arcs gain some thousand mm per mm of overlap."""
STRAIGHT = 1e-12
"""Bend of a line along its width between three neighbouring places that counts as none, mm."""
KEPT_GAP = 5e-11
"""Overlap beyond the allowed one at which a pose is accepted, mm; thousands of times the round-off of drives of a metre."""
TIE_BREAK = 1e-8
"""Small costs, all different, of the coordinates of the discs, so that no two corners of a programme are equally good."""
MAX_STEP = 0.25
"""Largest step of a programme by the smaller of pin radius and eccentricity: gaps are nearly linear within it."""
MAX_PROGRAMMES = 60
"""Linear programmes of one position."""
SHRINK_AFTER = 12
"""Programmes after which steps are shortened."""
MAX_PIVOTS = 400
"""Pivots of one programme of four unknowns; of more in proportion."""
LEAST_PIVOT = 1e-9
"""Least pivot of a programme: unit normals beside unit normals."""
KEPT_PROGRAMMES = 8
"""Number of last programmes of which the tangents of arcs are kept."""
DEGENERATE = 1e-9
"""Determinant of the unit normals of a corner below which no programme is started from it."""
SIDES = 16
"""Sides of the polygon about the circle of a bearing, beside its tangents."""
CIRCLE = 0.01
"""Length by which the displacement in a bearing without clearance is counted, mm; it moves nothing."""
ROOM_SOUGHT = 1.0
"""Gap of all pairs that a pose without overlap is sought with, mm: more than any is left, so that the least becomes largest."""
FEW_PROGRAMMES = 5
"""Linear programmes after which a pose without overlap is not sought any more."""
GATHER_BELOW = 0.7
"""Fraction of a batch that still pivots below which those rows are gathered."""
GOLDEN = 0.5 * (5.0**0.5 - 1.0)
"""Fraction of a turn between positions."""
POSITIONS = 48
"""Positions of the first round over a turn."""
REFINEMENTS = 2
"""Rounds of further positions about the largest plays and the least."""
LARGEST_REFINED = 3
"""Number of largest plays about which they lie."""
REFINED_PLACES = np.array([-0.75, -0.5, -0.25, 0.25, 0.5, 0.75])
"""Places of the further positions, by the mean distance of positions in the first round."""


PlayBefore = Callable[[FloatArray], FloatArray]
"""Play of the wheel that something adds at crank angles, both in rad."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Play:
    """Free play of the wheel at held crank angles, shape (positions,)."""

    forward: FloatArray  # stop of the wheel counter-clockwise, rad
    backward: FloatArray  # clockwise; equal where it is not free
    preloaded: BoolArray  # parts overlap in every pose, and stops hold for the least overlap

    @property
    def play(self) -> FloatArray:
        """Angle between the stops, rad, shape (positions,)."""
        return np.asarray(self.forward - self.backward)


@dataclass(frozen=True, slots=True, kw_only=True)
class TurnPlay:
    """Largest and least free play of the wheel over one turn of the crank, rad, and φ_C of both."""

    largest: float
    least: float
    crank_angle: float
    crank_angle_of_least: float
    preloaded: float  # fraction of the positions where parts overlap in every pose


PLAY_SAMPLED = "sampled over a turn"
"""Remark beside the largest and the least free play."""


def preload_words(part: float) -> str:
    """Return a remark beside the free play of a drive that is preloaded over a fraction of the turn; empty for none.

    >>> preload_words(0.25), preload_words(1.0)
    ('preloaded over 25 % of the turn', 'preloaded')
    """
    if part == 1.0:
        return "preloaded"
    return f"preloaded over {100.0 * part:.0f} % of the turn" if part else ""


def play_over_a_turn(discs: Sequence[ContactGeometry], before: PlayBefore | None = None) -> TurnPlay:
    """Return the largest and least free play over one turn of a drive of these discs, with the play that `before` adds."""
    (found,) = plays_over_a_turn([discs], before=None if before is None else [before])
    return found


def plays_over_a_turn(
    drives: Sequence[Sequence[ContactGeometry]],
    near: TurnPlay | None = None,
    before: Sequence[PlayBefore] | None = None,
) -> list[TurnPlay]:
    """Return the same of several drives as one batch, or only where a drive nearly alike has its extremes (`near`)."""
    stacked = [stack_drives(discs, 1) for discs in zip(*drives, strict=True)]

    def plays(angle: FloatArray) -> tuple[FloatArray, BoolArray]:
        """Play and preload at angles of each drive, shape (drives, angles)."""
        rows = np.repeat(np.arange(len(drives)), angle.shape[1])
        found = free_play([take_rows(disc, rows) for disc in stacked], angle.ravel())
        play = found.play.reshape(angle.shape)
        if before is not None:
            play = play + np.stack([own(at) for own, at in zip(before, angle, strict=True)])
        return play, found.preloaded.reshape(angle.shape)

    if near is not None:
        places = np.array([near.crank_angle, near.crank_angle_of_least])
        found, _ = plays(np.tile(places, (len(drives), 1)))
        return [replace(near, largest=float(own[0]), least=float(own[1])) for own in found]
    # Flank, holes and rollers have different periods: equally spaced positions would see few phases of some of them.
    angle = np.tile(2.0 * np.pi * np.mod(GOLDEN * np.arange(POSITIONS), 1.0), (len(drives), 1))
    (play, preloaded), spread = plays(angle), 2.0 * np.pi / POSITIONS
    for _ in range(REFINEMENTS):
        order = np.argsort(play, axis=1, kind="stable")
        chosen = np.concatenate([order[:, :1], order[:, -LARGEST_REFINED:]], axis=1)
        places = np.take_along_axis(angle, chosen, axis=1)[..., None] + spread * REFINED_PLACES
        between = places.reshape(len(drives), -1)
        angle, play = np.append(angle, between, axis=1), np.append(play, plays(between)[0], axis=1)
        spread *= 0.3
    return [
        TurnPlay(
            largest=float(own.max()),
            least=float(own.min()),
            crank_angle=float(at[np.argmax(own)] % (2.0 * np.pi)),
            crank_angle_of_least=float(at[np.argmin(own)] % (2.0 * np.pi)),
            preloaded=float(pressed.mean()),
        )
        for own, at, pressed in zip(play, angle, preloaded, strict=True)
    ]


def free_play(discs: Sequence[ContactGeometry], crank_angle: FloatArray, *, overlap: FloatArray | float = 0.0) -> Play:
    """Return the free play of the wheel at held crank angles, rad, of all discs; parts may overlap by `overlap`, mm."""
    angle = np.atleast_1d(np.asarray(crank_angle, dtype=float))
    rows, sense = np.tile(np.arange(angle.size), 2), np.repeat([1.0, -1.0], angle.size)
    forward, backward = np.full(angle.size, np.inf), np.full(angle.size, -np.inf)
    preloaded, room = np.zeros(angle.size, dtype=bool), np.broadcast_to(np.asarray(overlap, dtype=float), angle.shape)
    loose = any(disc.has_loose_supports for disc in discs)
    # What yields without clearance stands still.
    still = [(replace(disc, coordinates=Coordinates(leans=disc.stands_askew)),) for disc in discs]
    for group in [tuple(discs)] if loose else still:
        programme = _Programme([take_rows(disc, rows) for disc in group], angle[rows], room[rows])
        pose, left = programme.farthest(sense)
        turned = pose[:, WHEEL_ANGLE].reshape(2, -1)
        pressed = np.flatnonzero(np.any(left.reshape(2, -1) > CLOSED, axis=0))
        if pressed.size:
            twice = np.tile(pressed, 2)
            beside = _Programme([take_rows(disc, twice) for disc in group], angle[twice], room[twice])
            turned[:, pressed] = _beside_preload(beside, pose.reshape(2, -1, pose.shape[1])[:, pressed])
            preloaded[pressed] = True
        forward, backward = np.minimum(forward, turned[0]), np.maximum(backward, turned[1])
    # Discs may each be free without any angle common to all.
    preloaded |= (backward - forward) * np.maximum.reduce([_reach(disc) for disc in discs]) > 100.0 * LEAST_GAIN
    shut = forward < backward
    middle = 0.5 * (forward + backward)
    return Play(forward=np.where(shut, middle, forward), backward=np.where(shut, middle, backward), preloaded=preloaded)


def least_overlap(discs: Sequence[ContactGeometry], crank_angle: FloatArray) -> FloatArray:
    """Return the least overlap of parts, mm, among the poses of a few programmes at each crank angle.

    At most `CLOSED`, it is proof that parts need not overlap there, for a tenth of the time of `free_play`.
    """
    group = discs
    if not any(disc.has_loose_supports for disc in discs):
        group = [replace(disc, coordinates=Coordinates(leans=disc.stands_askew)) for disc in discs]
    return _Programme(group, crank_angle, -ROOM_SOUGHT).least_overlap()


def _beside_preload(programme: _Programme, poses: FloatArray) -> FloatArray:
    """Return the farthest wheel angles both ways, (2, positions), of parts that keep the mean overlap of two poses."""
    rows = np.arange(programme.angle.size)
    # Rollers that are too thick press a disc and leave its flank as free as before.
    gap, _, _ = programme.gaps(rows, np.tile(poses.mean(axis=0), (2, 1)))
    programme.room = programme.room + RELIEF + np.maximum(-gap, 0.0)
    pose, _ = programme.farthest(np.repeat([1.0, -1.0], rows.size // 2))
    return np.asarray(pose[:, WHEEL_ANGLE].reshape(2, -1))


def loose_poses(discs: Sequence[ContactGeometry], crank_angle: FloatArray, sense: FloatArray) -> FloatArray:
    """Return poses of the whole drive, wheel and cranks loose, with the wheel turned as far as it goes in each sense."""
    programme, whole = _Programme(discs, crank_angle), replace(discs[0].coordinates, discs=len(discs))
    pose, _ = programme.farthest(sense)
    found = np.zeros((crank_angle.size, whole.size))
    for number, each in enumerate(programme.maps):
        found[:, whole.columns(number)] = np.matmul(each, pose[..., None])[..., 0]
    return found


def _reach(geometry: ContactGeometry) -> FloatArray:
    """Lever of the rotations, e z_P, mm; of a batch one for each position."""
    return np.asarray(geometry.placement.eccentricity.max(axis=-1) * geometry.placement.reduction_ratio)


class _Disc:
    """The gaps of one disc at positions; where it leans, at the ends of every line and where a bent one is pressed most."""

    def __init__(self, geometry: ContactGeometry, angle: FloatArray, *, leans: bool) -> None:
        self.geometry, self.angle = geometry, angle
        self.lines = [_shape(drop) for _, drop in _lines(geometry)] if leans else []
        self.parameter = geometry.flank(angle, np.zeros((angle.size, RIGID))).parameter

    def gaps(self, rows: Rows, pose: FloatArray) -> tuple[FloatArray, FloatArray, int]:
        """Exact gaps of all pairs of the disc, mm, their derivatives by the pose, and the number of arcs, which come first."""
        geometry, angle = take_rows(self.geometry, rows), self.angle[rows]
        rays, bores = geometry.rollers(angle), geometry.bores(angle, pose)
        # A roller that rests on the inner race overlaps the bore by |s n − d| less the bore play.
        arm = rays.resting(bores)
        length = np.abs(arm)
        moved = (arm / length).conjugate()[..., None] * bores.each(bores.gradient, arm.shape[1])
        holes = geometry.holes(angle, pose)
        turned = pose[:, WHEEL_ANGLE, None] - pose[:, DISC_ROTATION, None]
        flank = geometry.flank(angle, pose, self.parameter[rows] + turned)
        gaps = [(rays.bore_play - length, moved.real), *((-pair.approach, -pair.gradient) for pair in (holes, flank))]
        arcs, flanks = gaps[:2], gaps[2:]
        if self.lines:
            tilts = (
                geometry.roller_tilt(pose, bores, rays),
                geometry.hole_tilt(pose, holes),
                geometry.flank_tilt(angle, pose, flank),
            )
            arcs, flanks = self._along_width(geometry, gaps, tilts)
        return *_joined([*arcs, *flanks]), sum(gap.shape[1] for gap, _ in arcs)

    def _along_width(
        self, geometry: ContactGeometry, gaps: Sequence[_Gap], tilts: Sequence[PairTilt]
    ) -> tuple[list[_Gap], list[_Gap]]:
        """Gaps of rollers and shaft pins at their heights, and those of wheel pins, which are not convex."""
        size = (gaps[0][0].shape[0], ACROSS.size)
        each = list[list[_Gap]]()
        for (places, bends), (half, drop), own, tilt in zip(self.lines, _lines(geometry), gaps, tilts, strict=True):
            z, short = np.broadcast_to(half * ACROSS, size), np.broadcast_to(drop, size)
            each.append([tilt.at(*own, z[:, [place]], short[:, [place]]) for place in places])
            if bends:
                each[-1].append(tilt.at(*own, *tilt.deepest(z, short)))
        return [*each[0], *each[1]], each[2]


def _lines(geometry: ContactGeometry) -> tuple[tuple[float | FloatArray, FloatArray], ...]:
    """Half the length of rollers, shaft pins and wheel pins, and by how much they fall short at `ACROSS`, mm."""
    return (
        (geometry.roller_half_length, geometry.roller_drop),
        (geometry.half_width, np.zeros(ACROSS.size)),
        (geometry.half_width, geometry.flank_drop),
    )


def _joined(gaps: Sequence[_Gap]) -> _Gap:
    """Gaps and their derivatives of several kinds side by side."""
    gap, slope = (np.concatenate(each, axis=1) for each in zip(*gaps, strict=True))
    return gap, slope


def _shape(drop: FloatArray) -> tuple[Rows, bool]:
    """The outermost places of a line that falls short so far, mm, and whether it bends, in any row."""
    known = np.flatnonzero(np.isfinite(np.atleast_2d(drop)).all(axis=0))
    inner = np.atleast_2d(drop)[:, known]
    return known[[0, -1]], bool(np.any(inner[:, :-2] + inner[:, 2:] - 2.0 * inner[:, 1:-1] > STRAIGHT))


class _Programme:
    """The gaps of discs, with wheel and cranks free within circles in their bearings, and the farthest wheel angle allowed.

    Poses: x, y, rotation (and lean) of disc after disc; displacements in loose bearings by their radius; the wheel angle.
    """

    def __init__(self, discs: Sequence[ContactGeometry], angle: FloatArray, room: FloatArray | float = 0.0) -> None:
        first, self.angle = discs[0], angle
        self.room = RELIEF + np.broadcast_to(room, angle.shape)[:, None]
        # Journals of a crank that stands askew in its clearances lean where there are others beside them.
        askew = any(disc.stands_askew for disc in discs) or (len(discs) > 1 and bool(np.any(first.crank_gaps)))
        self.leans = askew and first.coordinates.leans
        cranks = first.coordinates.cranks if np.any(first.crank_gaps) else 0
        wheel = first.coordinates.wheel and bool(np.any(first.wheel_gap))
        self.discs = tuple(_Disc(disc, angle, leans=self.leans) for disc in discs)
        self.own = DISC_ROTATION + 1 + 2 * self.leans
        """Number of coordinates of each disc."""
        gaps = np.broadcast_to(first.crank_gaps, (angle.size, 2))
        radii = [np.tile(gaps, (1, cranks))] + wheel * [np.broadcast_to(first.wheel_gap, (angle.size, 1))]
        self.radii = np.concatenate(radii, axis=1)
        """Of the circles, mm, shape (positions, circles)."""
        self.circles = self.own * len(discs)
        """First coordinate of the circles."""
        self.size = self.circles + 2 * self.radii.shape[1] + 1
        # Displacements in a bearing are counted by the radius of its circle; a circle of none moves nothing.
        self.scale = np.where(self.radii > 0.0, self.radii, CIRCLE)
        # What scales and bounds a position is its own drive's: no answer depends on the others in the batch.
        self.lever = np.ones((angle.size, self.size))
        self.lever[:, np.r_[DISC_ROTATION : self.circles : self.own, -1]] = np.reshape(_reach(first), (-1, 1))
        for number, disc in enumerate(discs):
            self.lever[:, self.own * number + DISC_ROTATION + 1 : self.own * (number + 1)] = disc.half_width
        place = first.placement
        smallest = np.minimum(place.wheel_pin_radii.min(axis=-1), place.eccentricity.min(axis=-1))
        self.bound = np.broadcast_to(MAX_STEP * smallest, angle.shape)
        self.pitch = np.pi / place.reduction_ratio
        self.maps = [self._map(disc, number, cranks, wheel) for number, disc in enumerate(discs)]

    def _map(self, disc: ContactGeometry, number: int, cranks: int, wheel: bool) -> FloatArray:
        """Pose of one disc, with cranks and wheel, by the joined pose, shape (positions, coordinates, joined)."""
        coordinates, positions = replace(disc.coordinates, discs=1), self.angle.size
        found = np.zeros((positions, coordinates.size, self.size))
        each = np.r_[: DISC_ROTATION + 1, np.arange(coordinates.size)[coordinates.lean_place] if self.leans else []]
        found[:, each.astype(np.intp), self.own * number + np.arange(self.own)] = 1.0
        shares, slopes = (np.broadcast_to(values, (positions, 2)) for values in (disc.crank_shares, disc.crank_slopes))
        part, both = (self.radii / self.scale)[..., None], np.arange(2)
        for crank in range(cranks):
            for bearing in (0, 1):
                circle = 2 * crank + bearing
                own = self.circles + 2 * circle + both
                found[:, coordinates.crank(crank) + both, own] = shares[:, bearing, None] * part[:, circle]
                if self.leans:
                    found[:, coordinates.crank_lean(crank) + both, own] = slopes[:, bearing, None] * part[:, circle]
        if wheel:
            found[:, coordinates.wheel_place.start + both, self.size - 3 + both] = part[:, -1]
        found[:, -1, -1] = 1.0
        return found

    def gaps(self, rows: Rows, pose: FloatArray) -> tuple[FloatArray, FloatArray, int]:
        """Exact gaps with the room, mm, their derivatives by scaled coordinates, and the number of arcs, which come first."""
        arcs, others = list[_Gap](), list[_Gap]()
        for disc, each in zip(self.discs, self.maps, strict=True):
            own = each[rows]
            gap, slope, curved = disc.gaps(rows, np.matmul(own, pose[..., None])[..., 0])
            slope = np.matmul(slope, own) / self.lever[rows, None]
            arcs.append((gap[:, :curved], slope[:, :curved]))
            others.append((gap[:, curved:], slope[:, curved:]))
        place = pose[:, self.circles : -1].reshape(rows.size, -1, 2)
        distance, scale = np.hypot(place[..., 0], place[..., 1]), self.scale[rows]
        count = distance.shape[1]
        ahead = place / np.where(distance > 0.0, distance, 1.0)[..., None]
        circle = np.zeros((rows.size, count, self.size))
        corner = np.zeros((rows.size, count, SIDES, self.size))
        around = 2.0 * np.pi * np.arange(SIDES) / SIDES
        sides = np.stack((np.cos(around), np.sin(around)), axis=-1)
        for number in range(count):
            both = slice(self.circles + 2 * number, self.circles + 2 * number + 2)
            circle[:, number, both], corner[:, number, :, both] = -ahead[:, number], -sides
        arcs.append((scale - distance, circle))
        room = (scale[..., None] - np.einsum("bcj,sj->bcs", place, sides)).reshape(rows.size, -1)
        others.append((room, corner.reshape(rows.size, -1, self.size)))
        gap, slope = _joined([*arcs, *others])
        return gap + self.room[rows], slope, sum(each.shape[1] for each, _ in arcs)

    def least_overlap(self) -> FloatArray:
        """Return the least overlap at poses that widen the least gap, mm; of a position no more once it is at most `CLOSED`."""
        pose, found = np.zeros((self.angle.size, self.size)), np.full(self.angle.size, np.inf)
        going, still = np.arange(self.angle.size), np.zeros(self.angle.size)
        for programme in range(FEW_PROGRAMMES + 1):
            gap, slope, _ = self.gaps(going, pose[going])
            found[going] = np.minimum(found[going], (self.room[going] - gap).max(axis=1))
            left = found[going] > CLOSED
            if programme == FEW_PROGRAMMES or not left.any():
                break
            going, gap, slope = going[left], gap[left], slope[left]
            step, _, _ = _farthest(-slope, gap, still[going], self.bound[going])
            pose[going] += step / self.lever[going]
        return found

    def farthest(self, sense: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the poses of the farthest wheel angles in these senses, and the overlap of parts there, mm."""
        size, count = self.angle.size, self.size
        pose, left, bound = np.zeros((size, count)), np.zeros(size), self.bound.copy()
        going = np.arange(size)
        tangents, pairs = np.zeros((size, 0, count + 1)), np.zeros((size, 0), dtype=np.intp)
        start: Rows | None = None
        history: list[float] = []
        for turn in range(MAX_PROGRAMMES):
            place = pose[going] * self.lever[going]
            gap, slope, arcs = self.gaps(going, pose[going])
            overlap = np.maximum(-gap.min(axis=1), 0.0)
            # −slope · d ≤ gap + t; tangents of earlier poses are relative to the origin.
            before = tangents[going]
            room = before[..., count] + np.einsum("bij,bj->bi", before[..., :count], place)
            # A disc that turns far moves its holes on arcs as well: a tangent that the exact gap violates is dropped.
            holds = room >= np.take_along_axis(gap, pairs[going], axis=1) - KEPT_GAP
            before, room = np.where(holds[..., None], before, 0.0), np.where(holds, room, 0.0)
            step, least, active = _farthest(
                np.concatenate([-slope, -before[..., :count]], axis=1),
                np.concatenate([gap, room], axis=1),
                sense[going],
                bound[going],
                start,
            )
            gain = sense[going] * step[:, WHEEL_ANGLE]
            left[going] = np.maximum(RELIEF - gap.min(axis=1), 0.0)
            # Where gaps are shut a programme may promise much for a little overlap: that is no preload.
            found = np.where(
                np.minimum(overlap, least) > CLOSED,
                overlap - least <= CLOSED + 1e-3 * least,
                (overlap - least <= KEPT_GAP) & (np.abs(gain) <= LEAST_GAIN),
            )
            history.append(float(np.max(np.abs(np.where(found[:, None], 0.0, step)))))
            stay = ~found
            if not stay.any():
                return pose, left
            chosen_arcs = np.where(active < arcs, np.maximum(active, -1), -1)
            drop = max(tangents.shape[1] - (KEPT_PROGRAMMES - 1) * (count + 1), 0)
            tangents = np.concatenate([tangents[:, drop:], np.zeros((size, count + 1, count + 1))], axis=1)
            pairs = np.concatenate([pairs[:, drop:], np.zeros((size, count + 1), dtype=np.intp)], axis=1)
            tangents[going, -(count + 1) :] = _tangents_of(slope, gap, place, chosen_arcs)
            pairs[going, -(count + 1) :] = np.maximum(chosen_arcs, 0)
            if turn >= SHRINK_AFTER:
                bound[going] = 0.7 * np.minimum(bound[going], np.abs(step).max(axis=1))
            # The active constraints of this programme start the next one; the oldest tangents are dropped.
            old = active >= gap.shape[1]
            start = np.where(old, np.where(active - drop < gap.shape[1], -1, active - drop), active)[stay]
            going, step = going[stay], step[stay]
            pose[going] += step / self.lever[going]
            if np.max(np.abs(pose[:, WHEEL_ANGLE])) > self.pitch:
                worst = int(np.argmax(np.abs(pose[:, WHEEL_ANGLE])))
                raise ConvergenceError(
                    f"nothing stops the wheel within half a pin pitch at crank angle {self.angle[worst]:.6g} rad",
                    history,
                )
        raise ConvergenceError(
            f"no rigid pose found at crank angle {self.angle[going[0]]:.6g} rad, parts still interfere by "
            f"{left[going[0]]:.3g} mm; steps in mm",
            history,
        )


def _tangents_of(slope: FloatArray, gap: FloatArray, place: FloatArray, chosen: Rows) -> FloatArray:
    """Chosen gaps as linear functions of the scaled pose, shape (rows, chosen, 5); zeros, which bound nothing, for −1."""
    pair = np.maximum(chosen, 0)
    along = np.take_along_axis(slope, pair[..., None], axis=1)
    offset = np.take_along_axis(gap, pair, axis=1) - np.einsum("bij,bj->bi", along, place)
    tangents = np.concatenate([along, offset[..., None]], axis=2)
    tangents[chosen < 0] = 0.0
    return tangents


def _farthest(
    normal: FloatArray, room: FloatArray, sense: FloatArray, bound: FloatArray, start: Rows | None = None
) -> tuple[FloatArray, FloatArray, Rows]:
    """Turn the wheel furthest after the least overlap t, normal · d ≤ room + t, |d| ≤ bound; return d, t, active constraints."""
    rows, pairs, size = normal.shape
    fixed = 2 * size + 1
    matrix = np.zeros((rows, pairs + fixed, size + 1))
    matrix[:, : 2 * size, :size] = np.concatenate([np.eye(size), -np.eye(size)])
    matrix[:, 2 * size, size] = -1.0
    matrix[:, fixed:, :size], matrix[:, fixed:, size] = normal, -1.0
    limit = np.concatenate([np.repeat(bound[:, None], 2 * size, axis=1), np.zeros((rows, 1)), room], axis=1)
    objective = np.tile(np.r_[1.0, 1.7, 2.3, 3.1 + 0.73 * np.arange(size - 3), 0.0] * TIE_BREAK, (rows, 1))
    objective[:, size - 1] += sense
    objective[:, size] = -PENALTY
    # Without pairs the optimum is the corner of the bounds in the direction of the objective, without overlap.
    first = np.where(objective[:, :size] > 0.0, 0, size) + np.arange(size)
    first = np.concatenate([first, np.full((rows, 1), 2 * size)], axis=1)
    basis = _as_good_as_first(matrix, objective, first, first if start is None else start + fixed)
    answer, stopping = np.zeros((rows, size + 1)), basis.copy()
    # Rows that have reached their optimum stay in the batch until gathering the others pays.
    going = np.arange(rows)
    for _ in range(MAX_PIVOTS * size // RIGID):
        each = np.arange(going.size)[:, None]
        inverse = np.linalg.inv(matrix[each, basis])
        point = np.matmul(inverse, limit[each, basis][..., None])
        beyond = np.matmul(matrix, point)[..., 0] - limit
        beyond[each, basis] = 0.0
        entering = np.argmax(beyond, axis=1)
        over = beyond[each[:, 0], entering] > 1e-13
        answer[going], stopping[going] = point[..., 0], basis
        if not over.any():
            break
        if over.mean() < GATHER_BELOW:
            going, matrix, limit, objective = going[over], matrix[over], limit[over], objective[over]
            basis, inverse, entering, each = basis[over], inverse[over], entering[over], each[: over.sum()]
            over = over[over]
        price = np.matmul(objective[:, None], inverse)[:, 0]
        share = np.matmul(matrix[each, entering[:, None]], inverse)[:, 0]
        rises = share > LEAST_PIVOT
        ratio = np.where(rises, np.maximum(price, 0.0) / np.where(rises, share, 1.0), np.inf)
        leaving, changed = np.argmin(ratio, axis=1)[over], each[over, 0]
        basis[changed, leaving] = entering[over]
    else:
        stopping[going] = basis = _by_library(objective, matrix, limit)
        each = np.arange(going.size)[:, None]
        answer[going] = np.linalg.solve(matrix[each, basis], limit[each, basis][..., None])[..., 0]
    return answer[:, :size], answer[:, size], stopping - fixed


def _by_library(objective: FloatArray, matrix: FloatArray, limit: FloatArray) -> Rows:
    """Return the corners of programmes on which the simplex method above goes in circles, solved one by one."""
    from scipy.optimize import linprog

    found = np.zeros((objective.shape[0], objective.shape[1]), dtype=np.intp)
    for row, (price, normals, room) in enumerate(zip(objective, matrix, limit, strict=True)):
        solved = linprog(-price, A_ub=normals, b_ub=room, bounds=(None, None), method="highs-ds")
        if not solved.success:
            raise ConvergenceError(f"a linear programme of the play is not solved: {solved.message}")
        # The constraints that hold the corner: first those that price it, then by their slack, each independent of the others.
        order, chosen = np.lexsort((solved.slack, solved.ineqlin.marginals)), list[int]()
        basis = np.zeros((0, price.size))
        for candidate in order:
            rest = normals[candidate] - basis.T @ (basis @ normals[candidate])
            if (size := float(np.linalg.norm(rest))) > 1e-6 and solved.slack[candidate] < 1e-9:
                basis = np.vstack([basis, rest / size])
                chosen.append(int(candidate))
            if len(chosen) == price.size:
                break
        if len(chosen) < price.size:
            raise ConvergenceError("a linear programme of the play has no corner")
        found[row] = chosen
    return found


def _as_good_as_first(matrix: FloatArray, objective: FloatArray, first: Rows, start: Rows) -> Rows:
    """Return dual feasible corners to start from, as the dual simplex method needs them: `start`, otherwise the first."""
    each = np.arange(first.shape[0])[:, None]
    start = np.where((start < matrix.shape[1]).all(axis=1, keepdims=True), start, first)
    known = np.abs(np.linalg.det(matrix[each, start])) > DEGENERATE
    start = np.where(known[:, None], start, first)
    price = np.matmul(objective[:, None], np.linalg.inv(matrix[each, start]))[:, 0]
    return np.where(np.all(price >= 0.0, axis=1, keepdims=True), start, first)
