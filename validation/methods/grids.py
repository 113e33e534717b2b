"""Contact grids solved inside every iteration of the equilibrium: the contacts of the ``direct`` method.

The same equilibrium as with tables, but each loaded contact is a grid of its own with the true separation of its
surfaces: exact circles for rollers and races, exact flank and exact circle for pins. Loads depend on the pose alone.

With ``contact.slices`` above 1 contacts tilt: their grids cover the whole width without symmetry (`ltca.contact.tilted_grid`),
and slices are the parts of the width for which line loads are given.

Solutions are kept by the separation that they belong to. The next call with the same separation starts from their contact
cells, and needs no factorisation where the same cells touch. The start changes the time of a solution and not its result.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, Protocol

import numpy as np
from numpy.typing import ArrayLike

from ltca.arrays import FloatArray
from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.compliance.pressures import along_width, pressures_in_slices, pressures_of_law
from ltca.compliance.response import ContactLaws, ContactPressures, DiscResponse, KindPressures
from ltca.contact.contact_kind import CELLS, ContactKind, ContactKinds, Separation
from ltca.contact.end_pressure import largest_pressure
from ltca.contact.tilted_grid import press_tilted
from ltca.drive.parts import Drive
from ltca.geometry.flank import FlankProfile
from ltca.geometry.pair_motion import FlankMotion
from ltca.geometry.pairs import ContactGeometry
from ltca.geometry.separation import circle_departure, flank_departure
from ltca.laws.contact_law import ContactLaw
from ltca.laws.line_contact import LineContactLaw
from ltca.laws.sliced_contact import Exactness, SlicedContact, slice_heights, slice_means
from ltca.laws.spring import SpringLaw
from ltca.laws.width_pressure import PatchAlongWidth
from validation.methods.grid_pressures import solve_along_width
from validation.methods.pressed_grid import press, recover_patches

STATIONS_PER_WAVE = 4096
"""Stations on the flank, per wave, at which separations are computed; between them they are interpolated,
which errs by 3e-7 of what the curvature swings ((2π/4096)²/8), the load by a tenth of that."""
KEPT_CELLS = 3_000_000
"""Cells of all solutions that are kept of one kind of contacts: some 50 bytes each, 480 of a pin in the plane."""

Key = tuple[float, ...]


class KeptPieces:
    """Pieces of solved contacts, by the numbers that determine the separation of their surfaces."""

    def __init__(self) -> None:
        self._pieces: dict[Key, tuple[Any, ...]] = {}
        self._cells = 0

    def __len__(self) -> int:
        return len(self._pieces)

    def start(self, *keys: Key) -> tuple[Any, ...]:
        """Return pieces to start from, those of the last key last."""
        return tuple(piece for key in keys for piece in self._pieces.get(key, ()))

    def keep(self, key: Key, pieces: tuple[Any, ...]) -> None:
        """Keep the pieces of a solved contact that are not kept yet; those of the separations not used for longest go."""
        known = self._pieces.pop(key, ())
        new = tuple(piece for piece in pieces if not any(piece is old for old in known))
        self._pieces[key] = (*known, *new)
        self._cells += _cells(new)
        while self._cells > KEPT_CELLS:
            self._cells -= _cells(self._pieces.pop(next(iter(self._pieces))))

    def clear(self) -> None:
        """Forget all of them."""
        self._pieces.clear()
        self._cells = 0


def _cells(pieces: tuple[Any, ...]) -> int:
    return sum(piece.active.size for piece in pieces)


class Surfaces(Protocol):
    """Surfaces of the contacts of one kind."""

    def separation(self, index: tuple[int, ...], effective_radius: float) -> tuple[Separation, tuple[Key, ...]]:
        """Return the separation of a contact by its indices and its effective radius, mm, and keys of near ones and its own."""
        ...

    def take(self, places: Any) -> Surfaces:
        """Return the surfaces of some contacts."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class RollerSurfaces:
    """Rollers and a race, alike where their effective radii are.

    Attributes
    ----------
    race : float
        Radius of the race, negative of a bore, mm.
    """

    race: float

    def separation(self, index: tuple[int, ...], effective_radius: float) -> tuple[Separation, tuple[Key, ...]]:
        """Return the separation (Eq. 55–56, 58), and its key."""
        race, radius = self.race, 1.0 / (1.0 / effective_radius - 1.0 / self.race)
        apart = Separation(
            effective_radius=effective_radius,
            departure=lambda _, x: circle_departure(x, radius) + circle_departure(x, race),
        )
        return apart, ((effective_radius,),)

    def take(self, places: Any) -> RollerSurfaces:
        """Return the surfaces themselves."""
        return self


@dataclass(frozen=True, slots=True, kw_only=True)
class PinSurfaces:
    """Wheel pins where they touch the flank.

    Attributes
    ----------
    profile : FlankProfile
        Of the flank.
    spacing : float
        Distance of the stations at which separations are computed, rad.
    parameter, radius : array, shape (…)
        θ of the contacts, rad, and radii of the pins, mm.
    """

    profile: FlankProfile
    spacing: float
    parameter: FloatArray
    radius: FloatArray

    def separation(self, index: tuple[int, ...], effective_radius: float) -> tuple[Separation, tuple[Key, ...]]:
        """Return the separation (Eq. 65), and keys of the stations beside it and its own."""
        profile, spacing, radius = self.profile, self.spacing, float(self.radius[index])
        number, part = divmod(float(self.parameter[index]), spacing)
        place = int(number)

        def departure(at: int, x: FloatArray) -> FloatArray:
            return flank_departure(profile, at * spacing, x) + circle_departure(x, radius)

        apart = Separation(effective_radius=effective_radius, departure=departure, place=place, part=part / spacing)
        return apart, tuple((radius, float(at)) for at in (place - 1, place + 1, place))

    def take(self, places: Any) -> PinSurfaces:
        """Return those of some contacts."""
        return replace(self, parameter=self.parameter[places], radius=self.radius[places])


@dataclass(frozen=True, slots=True, kw_only=True)
class GridLaw(ContactLaw):
    """Contacts of one kind, each on grids of its own: in the plane as every law, in slices as `ltca.laws.sliced_line.SlicedLine`.

    Attributes
    ----------
    kind : ContactKind
        Of the contacts.
    slices : int
        Slices along the width.
    surfaces : Surfaces
        Of the contacts.
    kept : KeptPieces
        Solutions to start from.
    """

    kind: ContactKind
    slices: int
    surfaces: Surfaces
    kept: KeptPieces

    def take(self, shape: tuple[int, ...], places: Any) -> GridLaw:
        """Return the law of some contacts of a batch."""
        return replace(self, surfaces=self.surfaces.take(places))

    def load_and_stiffness(self, approach: ArrayLike, effective_radius: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Return the load at an approach and its derivative at held place, N and N/mm; zeros where open."""
        pressed, radius = np.broadcast_arrays(*(np.asarray(each, float) for each in (approach, effective_radius)))
        load, stiffness = np.zeros(pressed.shape), np.zeros(pressed.shape)
        for index in zip(*np.nonzero(pressed > 0.0), strict=True):
            separation, keys = self.surfaces.separation(index, float(radius[index]))
            found = press(self.kind, separation, float(pressed[index]), self.kept.start(*keys))
            load[index], stiffness[index], pieces = found
            self.kept.keep(keys[-1], pieces)
        return load, stiffness

    def pressures(self, approach: FloatArray, effective_radius: FloatArray) -> KindPressures:
        """Return pressures and half-widths at approaches, mm, shape (positions, pairs)."""
        found, radius = np.zeros((3, *approach.shape)), np.broadcast_to(effective_radius, approach.shape)
        for index in zip(*np.nonzero(approach > 0.0), strict=True):
            separation, start = self.known(index, radius)
            for share, patch in recover_patches(self.kind, separation, float(approach[index]), start):
                largest = largest_pressure(patch, self.kind.end_cell)
                found[(slice(None), *index)] += share * np.array([patch.mid_pressure, largest, patch.half_width])
        return KindPressures(mid=found[0], largest=found[1], half_width=found[2], end_cell=self.kind.end_cell)

    def known(self, index: tuple[int, ...], radius: FloatArray) -> tuple[Separation, tuple[Any, ...]]:
        """Return the separation of a contact of an array of effective radii, mm, and the solutions known of it."""
        separation, keys = self.surfaces.separation(index, float(radius[index]))
        return separation, self.kept.start(*keys)

    def respond(
        self,
        approach: FloatArray,
        tilt: FloatArray,
        effective_radius: FloatArray,
        start: FloatArray | None = None,
        exactness: Exactness | None = None,
    ) -> SlicedContact:
        """Return loads, moments and their derivatives of contacts that tilt; `start` and `exactness` are not used."""
        delta, theta, radius = np.broadcast_arrays(
            *(np.asarray(each, float) for each in (approach, tilt, effective_radius))
        )
        length, slices = self.kind.length, self.slices
        z = slice_heights(length, slices)
        edges = np.linspace(-0.5 * length, 0.5 * length, slices + 1)
        values = np.zeros((6, *delta.shape))
        slice_load, line_load = np.zeros((*delta.shape, slices)), np.zeros((*delta.shape, *z.shape))
        for index in np.ndindex(delta.shape):
            separation, keys = self.surfaces.separation(index, float(radius[index]))
            known = self.kept.start(*keys)
            found = press_tilted(self.kind, separation, float(delta[index]), float(theta[index]), known)
            if found is None:
                continue
            self.kept.keep(keys[-1], found.pieces)
            values[(slice(None), *index)] = found[:6]
            along = PatchAlongWidth.of_patch(found.patch, self.kind)
            sums = np.concatenate(([0.0], np.cumsum(along.line_load * np.diff(along.edges))))
            shares = np.diff(np.interp(edges, along.edges, sums))
            # Of blended grids the one with the larger share gives the distribution of the load.
            slice_load[index] = shares * (found.load / shares.sum())
            centres = 0.5 * (along.edges[1:] + along.edges[:-1])
            points = np.interp(z, centres, along.line_load) * ((z > along.edges[0]) & (z < along.edges[-1]))
            # Points carry together the load of their slice: the bulge at an end lies between them.
            means = slice_means(points)
            even = slice_load[index] * (slices / length)
            line_load[index] = points * np.divide(even, means, out=np.zeros(even.shape), where=means > 0.0)[:, None]
        load, moment, by_approach, by_tilt, turning, _ = values
        return SlicedContact(
            load=load,
            moment=moment,
            by_approach=by_approach,
            by_tilt=by_tilt,
            moment_by_tilt=turning,
            slice_load=slice_load,
            near=np.empty((*delta.shape, 0)),
            line_load=line_load,
            left=np.zeros(delta.shape),
        )


class _GridLaws(ContactLaws):
    """Laws of a disc of which that of the wheel pins depends on where they touch the flank."""

    __slots__ = ()

    def placed(self, flank: FlankMotion) -> tuple[Any, Any, Any, Any]:
        """Return the laws with the wheel pins where they are on the flank."""
        pins, *others = self.laws
        here = replace(
            pins.surfaces,
            parameter=flank.parameter,
            radius=np.broadcast_to(pins.surfaces.radius, flank.parameter.shape),
        )
        return (replace(pins, surfaces=here), *others)


@dataclass(frozen=True, slots=True, kw_only=True)
class GridCompliance:
    """Half-space contact grids for pins and rollers of one disc, springs for the pin holes.

    Attributes
    ----------
    geometry : ContactGeometry
        Of the disc in its drive.
    kinds : ContactKinds
        Of its contacts.
    hole_law : ContactLaw or law in slices
        Of shaft pins and holes.
    slices : int
        Slices along the width of the contacts.
    """

    coefficients: ClassVar[None] = None

    geometry: ContactGeometry
    kinds: ContactKinds
    hole_law: Any
    slices: int = 1
    _kept: tuple[KeptPieces, KeptPieces, KeptPieces] = field(
        default_factory=lambda: (KeptPieces(), KeptPieces(), KeptPieces()), repr=False, compare=False
    )

    @classmethod
    def of_drive(cls, drive: Drive, cells: int = CELLS) -> GridCompliance:
        """Return the grid model of a drive of one disc (entry point ``cyclo.methods``).

        Grids have `cells` over each half-width and over half of each length.
        """
        geometry, slices = ContactGeometry.of_drive(drive), drive.contact.slices
        return cls(
            geometry=geometry,
            kinds=ContactKinds.of_drive(drive, cells),
            hole_law=(
                SpringLaw(stiffness=drive.hole_stiffness)
                if slices == 1
                else HalfSpaceCompliance.of_drive(drive).hole_law
            ),
            slices=slices,
        )

    def forget(self) -> None:
        """Forget the solutions from which contacts start."""
        for kept in self._kept:
            kept.clear()

    @property
    def contact_laws(self) -> ContactLaws:
        """Laws of the contacts."""
        place, kinds = self.geometry.placement, self.kinds
        on_flank = PinSurfaces(
            profile=self.geometry.profile,
            spacing=self._spacing,
            parameter=np.zeros(place.wheel_pin_radii.shape),
            radius=place.wheel_pin_radii,
        )
        surfaces: tuple[Surfaces, ...] = (
            on_flank,
            RollerSurfaces(race=float(place.inner_race_radius)),
            RollerSurfaces(race=-float(place.bore_radius)),
        )
        pins, inner, outer = (
            GridLaw(kind=kind, slices=self.slices, surfaces=own, kept=kept)
            for kind, own, kept in zip((kinds.pins, kinds.inner, kinds.outer), surfaces, self._kept, strict=True)
        )
        return _GridLaws(
            (pins, outer, self.hole_law, inner),
            place.outer_effective_radii,
            place.hole_effective_radii,
            place.inner_effective_radii,
        )

    def pressures(self, response: DiscResponse) -> ContactPressures:
        """Return pressures and half-widths on the grids, those of the shaft pins from their loads."""
        place, kinds, flank, rollers = self.geometry.placement, self.kinds, response.flank, response.rollers
        laws = self.contact_laws
        pins, outer, _, inner = laws.placed(flank)
        leaning = response.leaning_pins
        if leaning is None:
            return ContactPressures(
                pins=pins.pressures(flank.approach, flank.effective_radius),
                outer=outer.pressures(rollers.outer_approach, laws.outer_radius),
                inner=inner.pressures(rollers.inner_approach, laws.inner_radius),
                holes=_hole_pressures(kinds.holes, response.hole_load, place.hole_effective_radii),
                rigid_shaft_pins=False,
            )
        by_lines = pressures_in_slices(response, kinds, place, shaft_pins_on_springs=True)
        found, leaning_rollers = {}, rollers.leaning
        assert leaning_rollers is not None
        for name, law, approach, tilt, radius in (
            ("pins", pins, flank.approach, leaning.tilt.tilt, flank.effective_radius),
            ("inner", inner, rollers.inner_approach, leaning_rollers.inner_tilt, laws.inner_radius),
            ("outer", outer, rollers.outer_approach, leaning_rollers.outer_tilt, laws.outer_radius),
        ):
            found[name] = _along_grids(law, approach, np.asarray(tilt), radius, getattr(by_lines, name))
        return replace(by_lines, pins=found["pins"], inner=found["inner"], outer=found["outer"])

    @property
    def _spacing(self) -> float:
        """Distance of the stations on the flank, rad."""
        profile = self.geometry.profile
        waves = round(profile.reduction_ratio)
        if profile.deviation is not None:
            waves = max(waves, profile.deviation.knots.size, *profile.deviation.orders)
        return float(2.0 * np.pi / (STATIONS_PER_WAVE * waves))


def _hole_pressures(kind: ContactKind, load: FloatArray, radius: FloatArray) -> KindPressures:
    """Pressures of elastic shaft pins in their holes by their loads, N: half-spaces of finite length."""
    law = LineContactLaw(kind.length, kind.contact_modulus)
    return pressures_of_law(law, kind, law.approach_at_load(load, radius)[0], radius)


def _along_grids(
    law: GridLaw, approach: FloatArray, tilt: FloatArray, radius: FloatArray, by_lines: KindPressures
) -> KindPressures:
    """Pressures of contacts that tilt on their grids, with the line loads of their slices."""
    size = np.broadcast_to(radius, approach.shape)
    heights = slice_heights(law.kind.length, law.slices).mean(axis=1)

    def known(*index: int) -> tuple[Separation, tuple[Any, ...]]:
        return law.known(index, size)

    patches = solve_along_width(law.kind, approach, tilt, size, heights, known)
    here, means = along_width(law.kind, patches, size), by_lines.along
    assert here.along is not None
    assert means is not None
    # Grids give pressures at single heights; line loads are means over slices, whose sum is the load.
    return replace(here, along=replace(here.along, line_load=means.line_load, even_line_load=means.even_line_load))
