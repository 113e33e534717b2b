"""Contacts at a pose: loads of all pairs, their generalised force and its tangent, and the model of a disc."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import ComplexArray, FloatArray, Result, map_arrays
from ltca.compliance.coefficients import InfluenceCoefficients
from ltca.contact.contact_kind import ContactKinds
from ltca.geometry.coordinates import DISC_PLACE, X, Y
from ltca.geometry.pair_motion import FlankMotion, KnownPins, PairMotion, PairTilt, RollerRays
from ltca.geometry.pairs import ContactGeometry

if TYPE_CHECKING:
    from ltca.laws.sliced_contact import SlicedContact


@dataclass(frozen=True, slots=True, kw_only=True)
class LeaningRollers:
    """Balanced rollers in slices, (positions, rollers), rad: leans along their rays and tilts, positive presses positive z."""

    lean: FloatArray
    inner_tilt: FloatArray
    outer_tilt: FloatArray
    inner: SlicedContact
    outer: SlicedContact


@dataclass(frozen=True, slots=True, kw_only=True)
class RollerState:
    """Balanced rollers, crank after crank, arrays (positions, rollers), mm and N."""

    share: FloatArray  # part of the total interference taken by the inner contact
    inner_approach: FloatArray  # negative where open; a free roller rests on the inner race
    outer_approach: FloatArray
    inner_load: FloatArray
    outer_load: FloatArray
    outer_direction: ComplexArray  # unit vector from bore centre to roller, of the load on the disc
    leaning: LeaningRollers | None = None  # in slices


@dataclass(frozen=True, slots=True, kw_only=True)
class LeaningPairs:
    """Pairs of one kind in slices: how they tilt, and what they carry."""

    tilt: PairTilt
    contact: SlicedContact


@dataclass(frozen=True, slots=True, kw_only=True)
class DiscResponse:
    """Contacts of one disc in a batch of positions at given poses; of wheel pins before shaft pins where both are pairs."""

    force: FloatArray  # Σ F ∂δ/∂q, N and N·mm, shape (positions, coordinates)
    flank: FlankMotion
    holes: PairMotion
    rollers: RollerState
    pin_load: FloatArray
    hole_load: FloatArray
    shifts: ComplexArray | None = None  # displacements of pins by the parts that hold them, mm, (positions, pairs)
    leans: ComplexArray | None = None  # of the pins at the disc in slices, rad
    ring: ComplexArray | None = None  # displacements of wheel pins by the ring, in the turning wheel, mm, of `shifts`
    friction: FloatArray | None = None  # forces of pins along their tangents, N
    leaning_pins: LeaningPairs | None = None  # in slices
    leaning_holes: LeaningPairs | None = None
    deformation: FloatArray | None = None  # that coupled contacts' own laws take, mm, (positions, components, contacts)

    @property
    def pin_forces(self) -> ComplexArray:
        """Force of the disc on each wheel pin and shaft pin in the fixed frame, with friction, N, shape (positions, pairs)."""
        load, normal, along = (
            np.concatenate(both, axis=1)
            for both in (
                (self.pin_load, self.hole_load),
                (self.flank.gradient, self.holes.gradient),
                (self.flank.along, self.holes.along),
            )
        )
        force = load[..., None] * normal[..., DISC_PLACE]
        if self.leaning_pins is not None and self.leaning_holes is not None:
            turned = [
                pairs.contact.moment[..., None] * pairs.tilt.gradient[..., DISC_PLACE]
                for pairs in (self.leaning_pins, self.leaning_holes)
            ]
            force = force + np.concatenate(turned, axis=1)
        if self.friction is not None:
            force = force + self.friction[..., None] * along[..., DISC_PLACE]
        return np.asarray(force[..., 0] + 1j * force[..., 1])

    @property
    def pin_moments(self) -> ComplexArray:
        """Moment of the disc on each pin in slices along leans, with friction, N·mm, (positions, pairs)."""
        found, along = [], []
        for motion, pairs in ((self.flank, self.leaning_pins), (self.holes, self.leaning_holes)):
            assert pairs is not None
            found.append(pairs.contact.moment * (motion.gradient[..., X] + 1j * motion.gradient[..., Y]))
            along.append(pairs.contact.moment * (motion.along[..., X] + 1j * motion.along[..., Y]))
        moments: ComplexArray = np.concatenate(found, axis=1)
        return moments if self.friction is None else moments + self.rubs * np.concatenate(along, axis=1)

    @property
    def rubs(self) -> FloatArray:
        """Friction of wheel pins and shaft pins by their loads, shape (positions, pairs)."""
        load = np.concatenate((self.pin_load, self.hole_load), axis=1)
        if self.friction is None:
            return np.zeros_like(load)
        return np.asarray(np.divide(self.friction, load, out=np.zeros_like(load), where=load > 0.0))


@dataclass(frozen=True, slots=True, kw_only=True)
class Response:
    """Contacts of all discs of a reducer: of n discs array axes for pairs are n times as long, disc after disc."""

    force: FloatArray  # of the reducer, N and N·mm, shape (positions, coordinates)
    parts: tuple[DiscResponse, ...]  # of each disc, by its own pose
    tangent: FloatArray = field(default_factory=lambda: np.zeros((0, 0, 0)))  # derivative of the force
    contact_stiffness: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))  # its diagonal without supports
    left: FloatArray = field(default_factory=lambda: np.zeros(0))  # unsettled force, N
    shifts: ComplexArray | None = None  # displacements of pins, mm, (positions, discs, pairs)
    inner: Inner | None = None  # unknowns beside the pose; None of one disc of several

    @property
    def flank(self) -> FlankMotion:
        """Kinematics of the wheel pins of all discs."""
        return beside([part.flank for part in self.parts])

    @property
    def holes(self) -> PairMotion:
        """Kinematics of the pin holes of all discs."""
        return beside([part.holes for part in self.parts])

    @property
    def rollers(self) -> RollerState:
        """Balanced rollers of all discs."""
        return beside([part.rollers for part in self.parts])

    @property
    def pin_load(self) -> FloatArray:
        """Loads of the wheel pins of all discs, N, shape (positions, pairs)."""
        return beside([part.pin_load for part in self.parts])

    @property
    def hole_load(self) -> FloatArray:
        """Loads of the shaft pins of all discs, N, shape (positions, pairs)."""
        return beside([part.hole_load for part in self.parts])

    @property
    def ring(self) -> ComplexArray | None:
        """What the ring of the wheel moves the wheel pins (`DiscResponse`)."""
        return self.parts[0].ring

    @property
    def start(self) -> Start:
        """Where other poses of the same positions start."""
        return Start.onward(self)

    @property
    def overlooks(self) -> NDArray[np.bool_]:
        """Positions where a contact was left out that is pressed together after all: none of an answer."""
        return np.zeros(self.force.shape[0], dtype=bool)

    @property
    def kept(self) -> Response:
        """The response of balanced positions without what the search alone asks for, which is two fifths of one on a ring."""
        return self if self.inner is None else replace(self, inner=self.inner.kept)


def beside(values: Sequence[Result]) -> Result:
    """Put arrays (positions, pairs, …), or trees of them, of several discs side by side."""
    found: Result = (
        values[0] if len(values) == 1 else map_arrays(lambda *arrays: np.concatenate(arrays, axis=1), *values)
    )
    return found


@dataclass(frozen=True, slots=True, kw_only=True)
class AlongWidth:
    """Contacts of one kind in slices along their width, arrays (positions, pairs, slices), zero where open."""

    line_load: FloatArray  # mean over each slice, N/mm
    even_line_load: FloatArray  # without the bulge of ends that carry, by slices of an aligned straight line
    pressure: FloatArray  # largest over the profile, MPa
    half_width: FloatArray  # in the middle of each slice, mm
    place: FloatArray  # height of the largest pressure anywhere, mm, (positions, pairs)
    end_load: FloatArray  # line load at the lower and upper end, N/mm, (positions, pairs, 2)


@dataclass(frozen=True, slots=True, kw_only=True)
class KindPressures:
    """Pressures and half-widths of all pairs of one kind, shape (positions, pairs), zero where open."""

    mid: FloatArray  # largest at mid-width, MPa
    largest: FloatArray  # anywhere, MPa, singular at unrelieved ends; NaN in plane strain, which has none
    half_width: FloatArray  # at mid-width, mm
    end_cell: float  # length over which `largest` is a mean, mm; NaN where there is none
    along: AlongWidth | None = None  # in slices

    @property
    def widest(self) -> FloatArray:
        """Largest half-width anywhere along the width but at its very ends, mm, shape (positions, pairs)."""
        return self.half_width if self.along is None else np.asarray(self.along.half_width.max(axis=-1))


@dataclass(frozen=True, slots=True, kw_only=True)
class ContactPressures:
    """Pressures of all kinds; of rigid shaft pins by E* of the disc alone (`ltca.compliance.pressures`)."""

    pins: KindPressures
    outer: KindPressures
    inner: KindPressures
    holes: KindPressures
    rigid_shaft_pins: bool


class ContactLaws(NamedTuple):
    """Laws of a disc's wheel pins, rollers in bores, shaft pins and rollers on races, and their own effective radii, mm."""

    laws: tuple[Any, Any, Any, Any]
    outer_radius: FloatArray
    hole_radius: FloatArray
    inner_radius: FloatArray

    def placed(self, flank: FlankMotion) -> tuple[Any, Any, Any, Any]:
        """Return the laws with the wheel pins where they are on the flank: tabulated laws are the same everywhere."""
        return self.laws


class DiscModel(Protocol):
    """How the contacts of one disc yield."""

    @property
    def geometry(self) -> ContactGeometry:
        """The contact geometry of the disc in its drive."""

    @property
    def coefficients(self) -> InfluenceCoefficients | None:
        """Coefficients by which the contacts of the disc feel each other; None where they do not."""

    @property
    def contact_laws(self) -> ContactLaws:
        """Laws of the contacts."""

    def pressures(self, response: DiscResponse) -> ContactPressures:
        """Return the pressures behind a response of this model."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DiscContacts:
    """Geometry of the contacts of a disc, their laws of the plane or in slices, lengths and profiles."""

    geometry: ContactGeometry
    pin_law: Any
    outer_law: Any
    inner_law: Any
    hole_law: Any
    kinds: ContactKinds
    rigid_shaft_pins: bool = False  # where they touch their holes

    @property
    def contact_laws(self) -> ContactLaws:
        """Laws of the contacts."""
        place = self.geometry.placement
        return ContactLaws(
            (self.pin_law, self.outer_law, self.hole_law, self.inner_law),
            place.outer_effective_radii,
            place.hole_effective_radii,
            place.inner_effective_radii,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Inner:
    """Inner unknowns beside the pose, as they were found at some pose, and how they follow the pose to first order."""

    pose: FloatArray  # where they were found
    place: FloatArray  # of rollers, inward from where they only touch the race, mm; NaN where unknown, (positions, rollers)
    lean: FloatArray  # along their rays by half the thickness of the disc, mm, (positions, leans, rollers)
    approach: FloatArray | None  # deformations e, mm, (positions, components, contacts); None: the approaches
    shifts: ComplexArray | None  # displacements u of the pins, mm, (positions, rows, pairs)
    near: tuple[FloatArray, ...]  # `SlicedContact.near` of each disc and kind; empty in the plane
    by_pose: FloatArray | None = None  # derivatives of rollers by the pose, as those below
    approach_by_pose: FloatArray | None = None
    shifts_by_pose: ComplexArray | None = None
    columns: tuple[tuple[int, ...], ...] = ()  # coordinates of `by_pose` for each disc; empty for all

    @property
    def kept(self) -> Inner:
        """The same without derivatives, for balanced positions that are kept."""
        return replace(self, by_pose=None, approach_by_pose=None, shifts_by_pose=None)

    @property
    def elsewhere(self) -> Inner:
        """What other positions have in common with these: neither places of rollers nor displacements of pins."""
        return replace(self.kept, place=np.full_like(self.place, np.nan), shifts=None)

    def at(self, pose: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray | None, ComplexArray | None]:
        """Return places and leans of rollers, deformations and displacements of pins to expect at other poses."""
        place, lean, approach, shifts = self.place, self.lean, self.approach, self.shifts
        if self.by_pose is None:
            return place, lean, approach, shifts
        moved = (pose - self.pose)[:, None, :, None]
        if self.columns:
            rollers = zip(np.split(self.by_pose, len(self.columns), axis=1), self.columns, strict=True)
            change = np.concatenate([np.matmul(part, moved[:, :, own])[..., 0] for part, own in rollers], axis=1)
        else:
            change = np.matmul(self.by_pose, moved)[..., 0]
        place, lean = place + change[..., 0], lean + change[..., 1:].swapaxes(1, 2)
        if approach is not None and self.approach_by_pose is not None:
            approach = approach + np.matmul(self.approach_by_pose, moved)[..., 0]
        if shifts is not None and self.shifts_by_pose is not None:
            shifts = shifts + np.matmul(self.shifts_by_pose, moved)[..., 0]
        return place, lean, approach, shifts


@dataclass(frozen=True, slots=True, kw_only=True)
class Start:
    """Inner unknowns of a neighbouring pose, to start from."""

    parameter: FloatArray  # of contacts on the flank, rad, (positions, z_P)
    share: FloatArray  # of the total interference on the race, (positions, n_BR)
    known: KnownPins | None = None  # where the pins were
    inner: Inner | None = None

    @classmethod
    def after(cls, response: Response) -> Start:
        """Return the start that a response gives for poses near it, also of other drives and angles."""
        parameter = beside([part.flank.parameter for part in response.parts])
        return cls(
            parameter=parameter, share=beside([part.rollers.share for part in response.parts]), inner=response.inner
        )

    @classmethod
    def onward(cls, response: Response) -> Start:
        """Return the start for other poses of the same positions, also of drives nearly alike."""
        flank = response.flank
        known = KnownPins(point=flank.point, turning=flank.turning)
        return replace(cls.after(response), known=known)


def split_shifts(
    shifts: ComplexArray | None, geometry: ContactGeometry
) -> tuple[ComplexArray | None, ComplexArray | None]:
    """Return the displacements of wheel pins and of shaft pins, shape (positions, pairs); None for none."""
    if shifts is None:
        return None, None
    pins = geometry.placement.wheel_pin_radii.shape[-1]
    return shifts[:, :pins], shifts[:, pins:]


def bearing_pushes(rollers: RollerState, cranks: int) -> ComplexArray:
    """Return the force of every crank bearing on the disc in the fixed frame, shape (positions, cranks), N."""
    each = rollers.outer_load * rollers.outer_direction
    return np.asarray(each.reshape(each.shape[0], cranks, -1).sum(axis=2))


def bearing_moments(rollers: RollerState, rays: RollerRays, cranks: int) -> ComplexArray:
    """Return the moment of every crank bearing on the lean of the disc, x + iy, N·mm, (positions, cranks)."""
    if rollers.leaning is None:
        return np.zeros((rays.direction.shape[0], cranks), dtype=complex)
    each = rollers.leaning.outer.moment * rays.direction
    return np.asarray(each.reshape(each.shape[0], cranks, -1).sum(axis=2))
