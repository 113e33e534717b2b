"""Contact grids solved inside every iteration of the equilibrium: the ``direct`` method.

The same equilibrium as with tables, but each loaded contact is a grid of its own with the true separation of its
surfaces: exact circles for rollers and races, exact flank and exact circle for pins. Loads depend on the pose alone.
The warm start that travels with each position holds its contacts as values, so that one iteration starts from the
contact cells of the last.

With ``contact.slices`` above 1 contacts tilt: their grids cover the whole width without symmetry (`ltca.contact.tilted_grid`),
and slices are what their line loads are told by. Cells found are then kept by contact for the next time it is pressed, at
whatever position: where an iteration starts alters no answer.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ltca.arrays import FloatArray
from ltca.compliance import sliced
from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.compliance.pressures import along_width
from ltca.compliance.response import ContactPressures, DiscResponse, KindPressures
from ltca.compliance.rollers import RollerLaws
from ltca.compliance.uncoupled import PairLaws, UncoupledContacts
from ltca.contact.end_pressure import largest_pressure
from ltca.contact.tracked_grid import CELLS, ContactKind, ContactKinds, Pieces, Separation, press, recover_patches
from ltca.drive.parts import Drive
from ltca.geometry.pair_motion import FlankMotion
from ltca.geometry.pairs import ContactGeometry
from ltca.geometry.separation import circle_departure, flank_departure
from ltca.laws.contact_law import ContactLaw
from ltca.laws.spring import SpringLaw

if TYPE_CHECKING:
    from ltca.contact.tilted_grid import TiltedPieces
    from ltca.laws.sliced_contact import Exactness, SlicedContact

STATIONS_PER_WAVE = 4096
"""Stations on the flank, per wave, at which separations are computed; between them they are interpolated,
which errs by 3e-7 of what the curvature swings ((2π/4096)²/8), the load by a tenth of that."""

SeparationOf = Callable[[int, int], Separation]
"""The separation of a pair, by position and pair."""


class PositionContacts(NamedTuple):
    """Pieces of the contacts of one position that have been loaded so far, by pair; empty for the others."""

    pins: tuple[Pieces, ...]
    inner: tuple[Pieces, ...]
    outer: tuple[Pieces, ...]


class _KindGrids(ContactLaw):
    """The law of the contacts of one kind in a batch of positions, each on grids of its own.

    It lives as long as one response: the pieces of every contact are replaced as it is pressed again.
    """

    def __init__(self, kind: ContactKind, separation: SeparationOf, start: list[tuple[Pieces, ...]]) -> None:
        self.kind, self.separation = kind, separation
        self.pieces = [list(position) for position in start]

    def load_and_stiffness(self, approach: ArrayLike, effective_radius: ArrayLike) -> tuple[FloatArray, FloatArray]:
        pressed = np.asarray(approach, dtype=float)
        load, stiffness = np.zeros_like(pressed), np.zeros_like(pressed)
        for row, pair in zip(*np.nonzero(pressed > 0.0), strict=True):
            load[row, pair], stiffness[row, pair], self.pieces[row][pair] = press(
                self.kind, self.separation(row, pair), float(pressed[row, pair]), self.pieces[row][pair]
            )
        return load, stiffness

    def pressures(self, approach: FloatArray) -> KindPressures:
        found = np.zeros((3, *approach.shape))
        for row, pair in zip(*np.nonzero(approach > 0.0), strict=True):
            for share, patch in recover_patches(
                self.kind, self.separation(row, pair), float(approach[row, pair]), self.pieces[row][pair]
            ):
                largest = largest_pressure(patch, self.kind.end_cell)
                found[:, row, pair] += share * np.array([patch.mid_pressure, largest, patch.half_width])
        return KindPressures(mid=found[0], largest=found[1], half_width=found[2], end_cell=self.kind.end_cell)


class _TiltedGrids:
    """The law of the contacts of one kind that tilt, as `ltca.laws.sliced_line.SlicedLine` answers.

    Parameters
    ----------
    kind : ContactKind
        Of the contacts.
    slices : int
        Slices along the width.
    separation : callable
        Separation of a contact by its indices and its effective radius.
    kept : dict
        Pieces of the contacts that have been loaded so far, by what `separation` is of.
    alike : bool
        Whether contacts of one effective radius are alike, as rollers are.
    """

    def __init__(
        self,
        kind: ContactKind,
        slices: int,
        separation: Callable[[tuple[int, ...], float], Separation],
        kept: dict[tuple[float, ...], TiltedPieces],
        *,
        alike: bool,
    ) -> None:
        self.kind, self.slices = kind, slices
        self.length, self.contact_modulus = kind.length, kind.contact_modulus
        self.separation, self.kept, self.alike = separation, kept, alike

    def known(self, radius: FloatArray) -> Callable[..., tuple[Separation, TiltedPieces]]:
        """Return the separation of contacts of effective radii, mm, by their indices, and the pieces known of them."""

        def of_contact(*index: int) -> tuple[Separation, TiltedPieces]:
            size = float(radius[index])
            return self.separation(index, size), self.kept.get(self._key(index, size), ())

        return of_contact

    def _key(self, index: tuple[int, ...], effective_radius: float) -> tuple[float, ...]:
        return (effective_radius,) if self.alike else tuple(float(number) for number in index)

    def respond(
        self,
        approach: FloatArray,
        tilt: FloatArray,
        effective_radius: FloatArray,
        start: FloatArray | None = None,
        exactness: Exactness | None = None,
    ) -> SlicedContact:
        """Return what contacts carry; loads of the slices nearby are of no use here."""
        delta, theta, radius = np.broadcast_arrays(
            *(np.asarray(each, float) for each in (approach, tilt, effective_radius))
        )
        z = sliced.slice_heights(self.length, self.slices)
        edges = np.linspace(-0.5 * self.length, 0.5 * self.length, self.slices + 1)
        values = np.zeros((6, *delta.shape))
        slice_load, line_load = np.zeros((*delta.shape, self.slices)), np.zeros((*delta.shape, *z.shape))
        for index in np.ndindex(delta.shape):
            size = float(radius[index])
            which = (size,) if self.alike else tuple(float(number) for number in index)
            known = self.kept.get(which, ())
            found = sliced.press_tilted(
                self.kind, self.separation(index, size), float(delta[index]), float(theta[index]), known
            )
            if found is None:
                continue
            self.kept[which] = found.pieces
            values[(slice(None), *index)] = found[:6]
            sums = np.concatenate(([0.0], np.cumsum(found.line_load * np.diff(found.edges))))
            shares = np.diff(np.interp(edges, found.edges, sums))
            # Of blended grids the larger tells how the load lies.
            slice_load[index] = shares * (found.load / shares.sum())
            centres = 0.5 * (found.edges[1:] + found.edges[:-1])
            points = np.interp(z, centres, found.line_load) * ((z > found.edges[0]) & (z < found.edges[-1]))
            # Points carry together what their slice does: the bulge at an end lies between them.
            means = sliced.slice_means(points)
            even = slice_load[index] * (self.slices / self.length)
            line_load[index] = points * np.divide(even, means, out=np.zeros(even.shape), where=means > 0.0)[:, None]
        load, moment, by_approach, by_tilt, turning, _ = values
        return sliced.SlicedContact(
            load=load,
            moment=moment,
            by_approach=by_approach,
            by_tilt=by_tilt,
            moment_by_tilt=turning,
            slice_load=slice_load,
            near=np.empty((*delta.shape, 0)),
            line_load=line_load,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class GridCompliance(UncoupledContacts[_KindGrids]):
    """Half-space contact grids for pins and rollers, springs for the pin holes.

    Attributes
    ----------
    slices : int
        Slices along the width of the contacts.
    """

    grids_can_check: ClassVar[bool] = False

    slices: int = 1
    _kept: tuple[dict[tuple[float, ...], TiltedPieces], ...] = field(
        default_factory=lambda: ({}, {}, {}), repr=False, compare=False
    )

    @classmethod
    def of_drive(cls, drive: Drive, cells: int = CELLS) -> GridCompliance:
        """Return the grid model of a drive, with so many cells over each half-width and over half of each length."""
        geometry, slices = ContactGeometry.of_drive(drive), drive.contact.slices
        return cls(
            geometry=geometry,
            kinds=ContactKinds.of_drive(drive, cells),
            hole_law=(
                SpringLaw(stiffness=drive.hole_stiffness)
                if slices == 1
                else HalfSpaceCompliance.in_slices(drive, geometry).hole_law
            ),
            slices=slices,
        )

    def forget(self) -> None:
        """Forget the grids of tilted contacts that were solved."""
        for kept in self._kept:
            kept.clear()

    def laws(self, flank: FlankMotion, warm_start: NDArray[np.object_] | None) -> PairLaws[Any]:
        """Return the grids of the pins and of the rollers on the inner race and in the bore."""
        if self.slices > 1:
            return self._tilted_laws(flank)
        pins, inner, outer = self._grids(flank, self._known(flank.approach.shape[0], warm_start))
        rollers = RollerLaws(
            inner=inner,
            outer=outer,
            inner_radius=self.geometry.placement.inner_effective_radii,
            outer_radius=self.geometry.placement.outer_effective_radii,
            by_place=True,
        )
        return PairLaws(pins=pins, rollers=rollers)

    def _tilted_laws(self, flank: FlankMotion) -> PairLaws[_TiltedGrids]:
        """The same of contacts that tilt."""
        place = self.geometry.placement
        between_pin_and_flank = self._pin_separation(flank)

        def of_roller(race: float) -> Callable[[tuple[int, ...], float], Separation]:
            def separation(_: tuple[int, ...], effective_radius: float) -> Separation:
                radius = 1.0 / (1.0 / effective_radius - 1.0 / race)
                return _roller_separation(radius, race, effective_radius)

            return separation

        pins, inner, outer = self._kept
        kinds, slices = self.kinds, self.slices
        race, bore = float(place.inner_race_radius), -float(place.bore_radius)
        return PairLaws(
            pins=_TiltedGrids(kinds.pins, slices, lambda at, _: between_pin_and_flank(*at), pins, alike=False),
            rollers=RollerLaws(
                inner=_TiltedGrids(kinds.inner, slices, of_roller(race), inner, alike=True),
                outer=_TiltedGrids(kinds.outer, slices, of_roller(bore), outer, alike=True),
                inner_radius=place.inner_effective_radii,
                outer_radius=place.outer_effective_radii,
            ),
        )

    def read_pressures(
        self, law: _KindGrids, kind: ContactKind, approach: FloatArray, effective_radius: FloatArray
    ) -> KindPressures:
        """Return pressures and half-widths of contacts of one kind at their approaches, shape (positions, pairs)."""
        return law.pressures(approach)

    def pressures(self, response: DiscResponse) -> ContactPressures:
        """Return pressures and half-widths as the grids found them, those of the shaft pins from their loads."""
        by_lines = UncoupledContacts.pressures(self, response)
        leaning = response.leaning_pins
        if leaning is None:
            return by_lines
        rollers, laws, flank = response.rollers, self._tilted_laws(response.flank), response.flank
        found = {}
        for name, law, approach, tilt, radius in (
            ("pins", laws.pins, flank.approach, leaning.tilt.tilt, flank.effective_radius),
            ("inner", laws.rollers.inner, rollers.inner_approach, rollers.inner_tilt, laws.rollers.inner_radius),
            ("outer", laws.rollers.outer, rollers.outer_approach, rollers.outer_tilt, laws.rollers.outer_radius),
        ):
            size = np.broadcast_to(radius, approach.shape)
            heights = sliced.slice_heights(law.length, law.slices).mean(axis=1)
            patches = sliced.solve_along_width(law.kind, approach, np.asarray(tilt), size, heights, law.known(size))
            here, means = along_width(law.kind, patches, size), getattr(by_lines, name).along
            assert here.along is not None
            # Grids tell pressures at single heights; line loads are means over slices, whose sum is the load.
            lines = {each: getattr(means, each) for each in ("line_load", "even_line_load")}
            found[name] = replace(here, along=replace(here.along, **lines))
        return replace(by_lines, pins=found["pins"], inner=found["inner"], outer=found["outer"])

    def warm_start(self, laws: PairLaws[_KindGrids], positions: int) -> NDArray[np.object_]:
        """Return the contacts of each position as values (`PositionContacts`)."""
        kept = np.empty(positions, dtype=object)
        kinds = (laws.pins.pieces, laws.rollers.inner.pieces, laws.rollers.outer.pieces)
        for row, pieces in enumerate(zip(*kinds, strict=True)):
            kept[row] = PositionContacts(*(tuple(each) for each in pieces))
        return kept

    def _known(self, positions: int, warm_start: NDArray[np.object_] | None) -> list[PositionContacts]:
        """What is known of the contacts of every position."""
        place = self.geometry.placement
        nothing: tuple[Pieces, ...] = ((),) * place.roller_radii.size
        fresh = PositionContacts(pins=((),) * place.wheel_pin_radii.size, inner=nothing, outer=nothing)
        return [fresh if warm is None else warm for warm in ([None] * positions if warm_start is None else warm_start)]

    def _pin_separation(self, flank: FlankMotion) -> SeparationOf:
        """Separation of the pins from the flank, by position and pin."""
        place, profile = self.geometry.placement, self.geometry.profile
        spacing = self._spacing
        number, part = np.divmod(flank.parameter, spacing)
        part /= spacing

        def between_pin_and_flank(row: int, pin: int) -> Separation:
            radius = float(place.wheel_pin_radii[pin])

            def departure(at: int, x: FloatArray) -> FloatArray:
                return flank_departure(profile, at * spacing, x) + circle_departure(x, radius)

            return Separation(
                effective_radius=float(flank.effective_radius[row, pin]),
                departure=departure,
                place=int(number[row, pin]),
                part=float(part[row, pin]),
            )

        return between_pin_and_flank

    def _grids(self, flank: FlankMotion, known: list[PositionContacts]) -> tuple[_KindGrids, _KindGrids, _KindGrids]:
        """Grids of the pins, of the rollers on the inner race and in the bore."""
        place = self.geometry.placement

        def between_roller_and(race: float, effective_radius: FloatArray) -> SeparationOf:
            def separation(row: int, roller: int) -> Separation:
                return _roller_separation(float(place.roller_radii[roller]), race, float(effective_radius[roller]))

            return separation

        bore = between_roller_and(-float(place.bore_radius), place.outer_effective_radii)
        race = between_roller_and(float(place.inner_race_radius), place.inner_effective_radii)
        return (
            _KindGrids(self.kinds.pins, self._pin_separation(flank), [position.pins for position in known]),
            _KindGrids(self.kinds.inner, race, [position.inner for position in known]),
            _KindGrids(self.kinds.outer, bore, [position.outer for position in known]),
        )

    @property
    def _spacing(self) -> float:
        """Distance of the places on the flank, rad."""
        profile = self.geometry.profile
        waves = round(profile.reduction_ratio)
        if profile.deviation is not None:
            waves = max(waves, profile.deviation.knots.size, *profile.deviation.orders)
        return float(2.0 * np.pi / (STATIONS_PER_WAVE * waves))


def _roller_separation(radius: float, race: float, effective_radius: float) -> Separation:
    """Separation of a roller from a race, whose radius is negative where it is a bore, mm."""
    return Separation(
        effective_radius=effective_radius,
        departure=lambda _, x: circle_departure(x, radius) + circle_departure(x, race),
    )
