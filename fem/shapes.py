"""Exact shape of each body of a drive: closed curves with names, in the frame of the body.

The disc is given in its own frame, as `ltca.geometry.flank` and `ltca.geometry.placement` define it; pins, rollers and the
inner race have their centre at the origin. Points of the plane are complex numbers in mm. Every curve runs
counter-clockwise with a parameter of period 2π and knows on which side the body lies.
"""

from __future__ import annotations

import functools
import pickle
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from fem.errors import MeshError
from ltca.arrays import ComplexArray, FloatArray
from ltca.drive.hole_contact import shaft_pins_yield
from ltca.drive.parts import Drive
from ltca.geometry.flank import FlankProfile
from ltca.geometry.placement import Placement


class Curve(Protocol):
    """A closed curve that bounds a body, counter-clockwise, parameter of period 2π."""

    @property
    def name(self) -> str:
        """Name of the boundary in the mesh."""

    @property
    def encloses_body(self) -> bool:
        """Whether the body lies inside the curve (else the curve is a hole in it)."""

    @property
    def samples(self) -> int:
        """How many equally spaced parameters resolve the shape."""

    @property
    def corners(self) -> tuple[float, ...]:
        """Parameters, ascending in (0, 2π), at which an edge has to end; none on a smooth curve."""

    def points(self, parameter: FloatArray) -> ComplexArray:
        """Return points, mm."""

    def normals(self, parameter: FloatArray) -> ComplexArray:
        """Return unit normals out of the body."""

    def curvature_radius(self, parameter: FloatArray) -> FloatArray:
        """Return the size of the radius of curvature, mm."""

    def parameter_of(self, point: ComplexArray) -> FloatArray:
        """Return the parameter in [0, 2π) of the point of the curve nearest to each point."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CircleCurve:
    """Circle; the parameter is the polar angle about its centre.

    Attributes
    ----------
    name : str
        Name of the boundary.
    radius : float
        mm.
    centre : complex
        mm.
    encloses_body : bool
        False for a hole.
    """

    name: str
    radius: float
    centre: complex = 0j
    encloses_body: bool = True

    @property
    def samples(self) -> int:
        """How many equally spaced parameters resolve the shape."""
        return 360

    @property
    def corners(self) -> tuple[float, ...]:
        """None."""
        return ()

    def points(self, parameter: FloatArray) -> ComplexArray:
        """Return points, mm."""
        return np.asarray(self.centre + self.radius * np.exp(1j * np.asarray(parameter)))

    def normals(self, parameter: FloatArray) -> ComplexArray:
        """Return unit normals out of the body."""
        outward = np.exp(1j * np.asarray(parameter))
        return np.asarray(outward if self.encloses_body else -outward)

    def curvature_radius(self, parameter: FloatArray) -> FloatArray:
        """Return the radius for every parameter, mm."""
        return np.full(np.shape(parameter), self.radius)

    def parameter_of(self, point: ComplexArray) -> FloatArray:
        """Return the polar angle about the centre, in [0, 2π)."""
        return np.asarray(np.mod(np.angle(np.asarray(point) - self.centre), 2.0 * np.pi))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FlankCurve:
    """Flank of the disc; the parameter is θ of Eq. 1.

    Attributes
    ----------
    profile : FlankProfile
        The flank.
    name : str
        Name of the boundary.
    """

    profile: FlankProfile
    name: str = "flank"

    def __eq__(self, other: object) -> bool:
        """Whether the other is the same flank, to the last bit of its deviations."""
        return isinstance(other, FlankCurve) and self._content == other._content

    def __hash__(self) -> int:
        """Of flank and name."""
        return hash(self._content)

    @property
    def _content(self) -> tuple[FlankProfile, str, bytes]:
        """What tells flanks apart; arrays of deviations, which have neither hash nor truth, as bytes."""
        deviation = self.profile.deviation
        if deviation is None:
            return self.profile, self.name, b""
        return replace(self.profile, deviation=None), self.name, pickle.dumps(deviation)

    @property
    def encloses_body(self) -> bool:
        """Whether the body lies inside: always."""
        return True

    @property
    def samples(self) -> int:
        """How many equally spaced parameters resolve the shape: 128 for each tooth."""
        return 128 * round(self.profile.reduction_ratio)

    @property
    def corners(self) -> tuple[float, ...]:
        """None."""
        return ()

    def points(self, parameter: FloatArray) -> ComplexArray:
        """Return points, mm."""
        return self.profile.flank(np.asarray(parameter))

    def normals(self, parameter: FloatArray) -> ComplexArray:
        """Return unit normals out of the disc."""
        return self.profile.normal(np.asarray(parameter))

    def curvature_radius(self, parameter: FloatArray) -> FloatArray:
        """Return the size of the radius of curvature, mm; very large where the flank is straight."""
        curvature = np.abs(self.profile.curvature(np.asarray(parameter)))
        return np.asarray(1.0 / np.maximum(curvature, 1e-12))

    def parameter_of(self, point: ComplexArray) -> FloatArray:
        """Return θ in [0, 2π) of the nearest point of the flank; for points within a pin radius of it."""
        points = np.asarray(point, dtype=complex).ravel()
        table, tree = _flank_samples(self)
        _, nearest = tree.query(np.column_stack([points.real, points.imag]))
        theta = self.profile.nearest_point(points, table[nearest]).parameter
        return np.asarray(np.mod(theta, 2.0 * np.pi).reshape(np.shape(point)))


@functools.lru_cache(maxsize=16)
def _flank_samples(flank: FlankCurve) -> tuple[FloatArray, cKDTree]:
    """Return parameters and places that start Newton's method on the right tooth and side; every zone asks for them."""
    table = np.linspace(0.0, 2.0 * np.pi, flank.samples, endpoint=False)
    samples = flank.profile.flank(table)
    return table, cKDTree(np.column_stack([samples.real, samples.imag]))


@dataclass(frozen=True, slots=True, kw_only=True)
class DiscShape:
    """Cycloid disc in its own frame.

    Attributes
    ----------
    flank : FlankCurve
        Boundary "flank".
    bores : tuple of CircleCurve
        Boundary "bore", of several cranks boundaries "bore_0", "bore_1", …
    holes : tuple of CircleCurve
        Boundaries "hole_0", "hole_1", …; none without a pin shaft.
    name : str
        Name of the body.
    """

    flank: FlankCurve
    bores: tuple[CircleCurve, ...]
    holes: tuple[CircleCurve, ...]
    name: str = "disc"

    @classmethod
    def of_drive(cls, drive: Drive) -> DiscShape:
        """Return the disc of a drive, errors of holes and bores included."""
        placement = Placement.of_drive(drive)
        names = ["bore"] if placement.cranks == 1 else [f"bore_{c}" for c in range(placement.cranks)]
        return cls(
            flank=FlankCurve(profile=FlankProfile.of_drive(drive)),
            bores=tuple(
                CircleCurve(name=name, radius=drive.bore_radius, centre=complex(centre), encloses_body=False)
                for name, centre in zip(names, placement.bore_centres, strict=True)
            ),
            holes=tuple(
                CircleCurve(name=f"hole_{k}", radius=float(radius), centre=complex(centre), encloses_body=False)
                for k, (centre, radius) in enumerate(zip(placement.hole_centres, placement.hole_radii, strict=True))
            ),
        )

    @property
    def curves(self) -> tuple[Curve, ...]:
        """Outer curve first, then bores, then holes."""
        return (self.flank, *self.bores, *self.holes)

    @property
    def narrowest_wall(self) -> float:
        """Smallest wall between two boundaries, mm (the root circle stands for the flank)."""
        root = self.flank.profile.root_radius
        walls, circles = [], (*self.bores, *self.holes)
        for k, circle in enumerate(circles):
            walls.append(root - abs(circle.centre) - circle.radius)
            walls += [abs(circle.centre - other.centre) - circle.radius - other.radius for other in circles[:k]]
        return min(walls)

    @property
    def area(self) -> float:
        """Area, mm², by the divergence theorem; the trapezoidal rule is exact to round-off on a closed curve."""
        theta = np.linspace(0.0, 2.0 * np.pi, 400 * round(self.flank.profile.reduction_ratio), endpoint=False)
        points = self.flank.points(theta)
        normals = self.flank.normals(theta)
        _, tangent, _ = self.flank.profile.locus(theta)
        # Parallel curves: |r′| = |c′| (1 − offset κ_c).
        speed = np.abs(tangent) * (1.0 - self.flank.profile.offset * self.flank.profile.locus(theta).curvature)
        outer = 0.5 * float(np.mean((points * normals.conjugate()).real * speed)) * 2.0 * np.pi
        return outer - np.pi * (sum(bore.radius**2 for bore in self.bores) + sum(hole.radius**2 for hole in self.holes))


@dataclass(frozen=True, slots=True, kw_only=True)
class CircleShape:
    """Pin or roller, centre at the origin.

    Attributes
    ----------
    name : str
        Name of the body.
    radius : float
        Boundary "surface", mm.
    core_radius : float
        Boundary "core" of a rigid core that is left out of the mesh, mm; 0 for none.
    """

    name: str
    radius: float
    core_radius: float = 0.0

    def __post_init__(self) -> None:
        if not 0.0 <= self.core_radius < self.radius:
            raise MeshError(
                f"core radius {self.core_radius:g} mm of {self.name}: must be at least 0 mm and less than "
                f"{self.radius:g} mm, its radius"
            )

    @property
    def curves(self) -> tuple[Curve, ...]:
        """Outer curve first, then the core."""
        surface = CircleCurve(name="surface", radius=self.radius)
        if self.core_radius == 0.0:
            return (surface,)
        return (surface, CircleCurve(name="core", radius=self.core_radius, encloses_body=False))

    @property
    def narrowest_wall(self) -> float:
        """Wall between surface and core, or the radius, mm."""
        return self.radius - self.core_radius

    @property
    def area(self) -> float:
        """Area, mm²."""
        return float(np.pi * (self.radius**2 - self.core_radius**2))


@dataclass(frozen=True, slots=True, kw_only=True)
class RingShape:
    """Inner race, centre at the origin.

    Attributes
    ----------
    name : str
        Name of the body.
    inner_radius, outer_radius : float
        Boundaries "inner" and "outer", mm.
    """

    inner_radius: float
    outer_radius: float
    name: str = "inner_race"

    def __post_init__(self) -> None:
        if not 0.0 < self.inner_radius < self.outer_radius:
            raise MeshError(
                f"inner radius {self.inner_radius:g} mm of {self.name}: must be greater than 0 mm and less than "
                f"{self.outer_radius:g} mm, its outer radius"
            )

    @property
    def curves(self) -> tuple[Curve, ...]:
        """Outer curve first, then the inner one."""
        return (
            CircleCurve(name="outer", radius=self.outer_radius),
            CircleCurve(name="inner", radius=self.inner_radius, encloses_body=False),
        )

    @property
    def narrowest_wall(self) -> float:
        """Wall of the ring, mm."""
        return self.outer_radius - self.inner_radius

    @property
    def area(self) -> float:
        """Area, mm²."""
        return float(np.pi * (self.outer_radius**2 - self.inner_radius**2))


@dataclass(frozen=True, slots=True, kw_only=True)
class SlottedCircle:
    """Inner boundary of the ring of the pin wheel: a circle into which the seats of the pins are cut.

    Over one pitch, of which the seat is in the middle, the parameter runs with the arc length: along the circle, around the
    seat, along the circle.

    Attributes
    ----------
    radius : float
        Of the circle, mm.
    seats : int
        Number of seats; seat i has its centre at the polar angle 2πi/seats.
    seat_circle_radius, seat_radius : float
        Circle of the centres of the seats, and their radius, mm; the seats cut the circle.
    name : str
        Name of the boundary.
    """

    radius: float
    seats: int
    seat_circle_radius: float
    seat_radius: float
    name: str = "inner"

    @property
    def encloses_body(self) -> bool:
        """Whether the body lies inside: never."""
        return False

    @property
    def samples(self) -> int:
        """How many equally spaced parameters resolve the shape: 60 for each pitch."""
        return 60 * self.seats

    @property
    def pitch(self) -> float:
        """Angle from a seat to the next, rad."""
        return 2.0 * np.pi / self.seats

    @property
    def opening(self) -> float:
        """Half the angle, about the ring's centre, over which a seat opens the circle, rad."""
        inner, circle, seat = self.radius, self.seat_circle_radius, self.seat_radius
        return float(np.arccos((inner**2 + circle**2 - seat**2) / (2.0 * inner * circle)))

    @property
    def half_arc(self) -> float:
        """Half the angle of a seat's wall about its own centre, rad: π − that to which it is open inwards."""
        inner, circle, seat = self.radius, self.seat_circle_radius, self.seat_radius
        return float(np.arccos((inner**2 - circle**2 - seat**2) / (2.0 * circle * seat)))

    @property
    def loaded_half_arc(self) -> float:
        """Half the angle of the wall that a pin loads: that of its outer half, rad."""
        return min(self.half_arc, 0.5 * np.pi)

    @property
    def seat_centres(self) -> ComplexArray:
        """Centres of the seats, mm."""
        return np.asarray(self.seat_circle_radius * np.exp(1j * self.pitch * np.arange(self.seats)))

    @property
    def corners(self) -> tuple[float, ...]:
        """Parameters where circle and seats meet."""
        land, wall = self._shares
        every = (np.arange(self.seats)[:, None] + np.array([land, land + wall])) * self.pitch
        return tuple(every.ravel().tolist())

    @property
    def _shares(self) -> tuple[float, float]:
        """Shares of a pitch of the parameter: circle before the seat (as after it), and seat."""
        land, wall = self.radius * (0.5 * self.pitch - self.opening), 2.0 * self.half_arc * self.seat_radius
        return land / (2.0 * land + wall), wall / (2.0 * land + wall)

    def _pieces(self, parameter: FloatArray) -> tuple[FloatArray, FloatArray, NDArray[np.bool_]]:
        """Polar angle of the middle of the pitch, angle along the piece from there, whether it is the seat's."""
        land, wall = self._shares
        number = np.floor(parameter / self.pitch)
        place = parameter / self.pitch - number
        on_seat = (place >= land) & (place <= land + wall)
        along_seat = self.half_arc * (2.0 * (place - land) / wall - 1.0)
        rise = (0.5 * self.pitch - self.opening) / land
        along_circle = np.where(
            place < land, -0.5 * self.pitch + rise * place, self.opening + rise * (place - land - wall)
        )
        return number * self.pitch, np.where(on_seat, along_seat, along_circle), on_seat

    def points(self, parameter: FloatArray) -> ComplexArray:
        """Return points, mm."""
        middle, along, on_seat = self._pieces(np.asarray(parameter, dtype=float))
        seat = self.seat_circle_radius + self.seat_radius * np.exp(1j * along)
        return np.asarray(np.exp(1j * middle) * np.where(on_seat, seat, self.radius * np.exp(1j * along)))

    def normals(self, parameter: FloatArray) -> ComplexArray:
        """Return unit normals out of the body: towards the centre of the ring, or of the seat."""
        middle, along, _ = self._pieces(np.asarray(parameter, dtype=float))
        return np.asarray(-np.exp(1j * (middle + along)))

    def curvature_radius(self, parameter: FloatArray) -> FloatArray:
        """Return the radius of the piece, mm."""
        on_seat = self._pieces(np.asarray(parameter, dtype=float))[2]
        return np.where(on_seat, self.seat_radius, self.radius)

    def parameter_of(self, point: ComplexArray) -> FloatArray:
        """Return the parameter in [0, 2π) of the nearest point."""
        point = np.asarray(point)
        turned = np.mod(np.angle(point) + 0.5 * self.pitch, 2.0 * np.pi)
        number = np.floor(turned / self.pitch)
        own = point * np.exp(-1j * number * self.pitch)
        land, wall = self._shares
        arm = own - self.seat_circle_radius
        along = np.clip(np.angle(arm), -self.half_arc, self.half_arc)
        on_seat = np.abs(own - self.seat_circle_radius - self.seat_radius * np.exp(1j * along))
        polar = np.angle(own)
        polar = np.copysign(np.maximum(np.abs(polar), self.opening), polar)  # the circle ends at its corners
        on_circle = np.abs(own - self.radius * np.exp(1j * polar))
        rise = land / (0.5 * self.pitch - self.opening)
        beside = np.where(polar < 0.0, rise * (polar + 0.5 * self.pitch), land + wall + rise * (polar - self.opening))
        place = np.where(on_seat <= on_circle, land + 0.5 * wall * (along / self.half_arc + 1.0), beside)
        return np.asarray(np.mod((number + place) * self.pitch, 2.0 * np.pi))


@dataclass(frozen=True, slots=True, kw_only=True)
class PinRingShape:
    """Ring of the pin wheel with the seats of its pins, centre at the origin.

    Attributes
    ----------
    inner : SlottedCircle
        Boundary "inner".
    outer_radius : float
        Boundary "outer", mm.
    name : str
        Name of the body.
    """

    inner: SlottedCircle
    outer_radius: float
    name: str = "pin_ring"

    @property
    def curves(self) -> tuple[Curve, ...]:
        """Outer curve first, then the inner one."""
        return (CircleCurve(name="outer", radius=self.outer_radius), self.inner)

    @property
    def narrowest_wall(self) -> float:
        """Wall outside the seats, or metal between two of them, mm."""
        inner = self.inner
        between = 2.0 * (inner.seat_circle_radius * np.sin(0.5 * inner.pitch) - inner.seat_radius)
        outside = self.outer_radius - inner.seat_circle_radius - inner.seat_radius
        return float(min(between, outside) if inner.radius < inner.seat_circle_radius else outside)

    @property
    def area(self) -> float:
        """Area, mm²."""
        inner = self.inner
        half, opening = inner.half_arc, inner.opening
        # Of a seat beyond the circle: its sector and the triangle to the chord, less the circle's segment under it.
        seat = inner.seat_radius**2 * (half - np.sin(half) * np.cos(half))
        segment = inner.radius**2 * (opening - np.sin(opening) * np.cos(opening))
        return float(np.pi * (self.outer_radius**2 - inner.radius**2) - inner.seats * (seat - segment))


Shape = DiscShape | CircleShape | RingShape | PinRingShape


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveShapes:
    """Shapes of all bodies of a drive, each in its own frame.

    Attributes
    ----------
    disc : DiscShape
        The cycloid disc.
    wheel_pins : tuple of CircleShape
        "pin_0", …, with a rigid core.
    rollers : tuple of CircleShape
        "roller_0", …, full circles, crank after crank.
    inner_race : RingShape
        "inner_race", the same on every crank.
    shaft_pins : tuple of CircleShape
        "shaft_pin_0", …, full circles whose mean displacement stands on the spring; none where they are rigid.
    """

    disc: DiscShape
    wheel_pins: tuple[CircleShape, ...]
    rollers: tuple[CircleShape, ...]
    inner_race: RingShape
    shaft_pins: tuple[CircleShape, ...]

    @classmethod
    def of_drive(cls, drive: Drive) -> DriveShapes:
        """Return the shapes of a drive."""
        placement, race = Placement.of_drive(drive), drive.crank_bearing
        return cls(
            disc=DiscShape.of_drive(drive),
            wheel_pins=tuple(
                CircleShape(name=f"pin_{i}", radius=float(radius), core_radius=drive.pin_wheel.held_core_radius)
                for i, radius in enumerate(placement.wheel_pin_radii)
            ),
            rollers=tuple(
                CircleShape(name=f"roller_{n}", radius=float(radius)) for n, radius in enumerate(placement.roller_radii)
            ),
            inner_race=RingShape(inner_radius=race.held_bore_radius, outer_radius=race.inner_race_radius),
            shaft_pins=tuple(
                CircleShape(name=f"shaft_pin_{k}", radius=float(radius))
                for k, radius in enumerate(placement.shaft_pin_radii if shaft_pins_yield(drive) else ())
            ),
        )
