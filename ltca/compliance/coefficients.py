"""Influence coefficients of the bodies by finite elements: approaches, and tilts of solid bodies, by unit loads at stations.

Of each entry the half-plane's logarithm is taken off; the rest is smooth when load and place move together, and is interpolated,
and the logarithm of the actual places added again (docs/theory/coefficients.md, solid_bodies.md).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import ComplexArray, FloatArray
from ltca.compliance.stress_coefficients import StressCoefficients, read_stress_coefficients
from ltca.drive.parts import Bodies, Drive, Material
from ltca.drive.single_discs import nominal_shape
from ltca.errors import CycloError, DamagedFileError, DriveError, Problem
from ltca.geometry.boundary_stations import Boundary, boundaries_of, turned_boundaries, weights_of
from ltca.reading.coefficient_file import quality_warning, read_coefficients, require_places, require_same_bodies
from ltca.reading.coefficient_schema import flank_clustering, is_solid

if TYPE_CHECKING:
    from ltca.output.labelled import Labelled


SOLID = "solid"
"""What files of solid bodies say of their plane."""


class BodyPlaces(NamedTuple):
    """Places of contacts on the body of a disc: those of the flank, of bores and of holes, arrays (positions, contacts)."""

    wall: NDArray[np.intp]  # number, ascending: flank, bores, holes
    parameter: FloatArray  # θ on the flank, polar angles in the disc frame about the centres of bores and holes, rad
    point: ComplexArray  # in the disc frame, on bores from their centres, mm; zero in holes, of one contact each

    @classmethod
    def on_walls(
        cls, flank: FloatArray, on_flank: ComplexArray, bores: FloatArray, radius: float, holes: FloatArray, cranks: int
    ) -> BodyPlaces:
        """Return the places by parameters of contacts on flank, bores of a radius, mm (crank after crank), and holes, rad."""
        numbers = (
            np.zeros(flank.shape[1], dtype=np.intp),
            1 + np.repeat(np.arange(cranks), bores.shape[1] // cranks),
            1 + cranks + np.arange(holes.shape[1]),
        )
        parameter = np.concatenate((flank, bores, holes), axis=1)
        return cls(
            wall=np.broadcast_to(np.concatenate(numbers), parameter.shape),
            parameter=parameter,
            point=np.concatenate((on_flank, radius * np.exp(1j * bores), np.zeros(holes.shape)), axis=1),
        )

    def take(self, columns: NDArray[np.intp]) -> BodyPlaces:
        """Return some of the contacts by their numbers, ascending, shape (positions, chosen)."""
        pick = partial(np.take_along_axis, indices=columns, axis=1)
        return BodyPlaces(pick(self.wall), pick(self.parameter), pick(self.point))


@dataclass(frozen=True, slots=True, kw_only=True)
class InfluenceCoefficients:
    """Smooth parts of all bodies, approaches by loads, mm/N, or tilts by moments, rad/(N·mm), and factors κ of −ln(distance)."""

    fingerprint: str  # `Drive.shape_fingerprint` of the drive they serve
    shared: bool  # whether they stand for bodies that differ a little, on somebody's word
    plane: str  # "strain", "stress" or "solid"
    thickness: float  # of all bodies but solid rollers, mm
    flank: Boundary
    bores: tuple[Boundary, ...]
    holes: tuple[Boundary, ...]
    disc: FloatArray  # shape (stations, stations)
    pin: float
    roller: FloatArray  # rows and columns inner, outer
    race: FloatArray  # by the angle between place and load
    disc_logarithm: float
    pin_logarithm: float
    roller_logarithm: float
    race_logarithm: float
    stress: StressCoefficients | None = None
    code_hash: str = ""  # of the code that derived them
    warning: str = ""  # about figures of its accuracy out of bounds
    tilting: InfluenceCoefficients | None = None  # of solid bodies; plane ones take nothing of a tilt

    @property
    def bodies(self) -> Bodies:
        """What bodies they are of."""
        return "solid" if self.plane == SOLID else "plane"

    def lent_to(self, drive: Drive) -> InfluenceCoefficients:
        """Return the coefficients to serve another drive whose bodies differ a little; DriveError for other bores or holes."""
        counts = (
            ("crank.number", drive.crank.number, self.bores),
            ("pin_shaft.number_of_pins", drive.number_of_holes, self.holes),
        )
        if wrong := [
            Problem.of(
                name,
                f"= {number}",
                f"must be {len(walls)}, that of the drive whose influence coefficients are shared",
                bound=("equal to", len(walls)),
            )
            for name, number, walls in counts
            if number != len(walls)
        ]:
            raise DriveError(wrong[:1])
        fingerprint = drive.shape_fingerprint(self.bodies)
        return replace(self, fingerprint=fingerprint, shared=self.shared or fingerprint != self.fingerprint)

    def placed_in(self, drive: Drive) -> InfluenceCoefficients:
        """Return the coefficients of the part as it stands in the disc of a drive, its flank turned (`Drive.part_turn`)."""
        _, steps, tooth_pitches = drive.part_turn
        if steps == 0 and tooth_pitches == 0:
            return self
        cranks, tooth_turn = len(self.bores), -2.0 * np.pi * tooth_pitches / drive.disc.number_of_teeth
        how: dict[str, Any] = {"bores": cranks, "steps": steps, "pattern": drive.pattern, "flank_turn": tooth_turn}
        flank, *walls = turned_boundaries((self.flank, *self.bores, *self.holes), **how)
        bores, holes = tuple(walls[:cranks]), tuple(walls[cranks:])
        tilting = None if self.tilting is None else self.tilting.placed_in(drive)
        placed = None if self.stress is None else self.stress.placed(**how)
        return replace(self, flank=flank, bores=bores, holes=holes, stress=placed, tilting=tilting)

    def with_roller_length(self, length: float) -> InfluenceCoefficients:
        """Return the coefficients with rollers of a length, mm: plane ones yield like one over it, and solid ones have it."""
        if self.plane == SOLID:
            return self
        scale = self.thickness / length
        return replace(self, roller=scale * self.roller, roller_logarithm=scale * self.roller_logarithm)

    def disc_matrix(self, places: BodyPlaces) -> FloatArray:
        """Return the approach of contacts by unit loads on each, mm/N, (positions, n, n), without the logarithm on itself."""
        from scipy.sparse import csr_array

        stations, weights = self._weights(places)
        positions, contacts, points = stations.shape
        rows, size = positions * contacts, self.disc.shape[0]
        spread = csr_array((weights.ravel(), stations.ravel(), np.arange(rows + 1) * points), shape=(rows, size))
        at = (np.arange(rows) * size).reshape(positions, contacts, 1) + stations.reshape(positions, 1, -1)
        near = (spread @ self.disc).ravel().take(at).reshape(positions, contacts, contacts, points)
        matrix: FloatArray = np.einsum("bkna,bna->bnk", near, weights)
        for wall, logarithm in self._logarithms(places):
            matrix[:, wall, wall] -= logarithm
        return matrix

    def disc_approach(self, places: BodyPlaces, load: FloatArray) -> FloatArray:
        """Return the approaches of contacts by their loads together, mm, without the logarithm of each on itself."""
        stations, weights = self._weights(places)
        positions, size = load.shape[0], self.disc.shape[0]
        at = stations + size * np.arange(positions)[:, None, None]
        on_stations = np.bincount(at.ravel(), (weights * load[..., None]).ravel(), positions * size)
        moved = on_stations.reshape(positions, size) @ self.disc
        approach: FloatArray = np.einsum("bna,bna->bn", moved.ravel().take(at), weights)
        for wall, logarithm in self._logarithms(places):
            approach[:, wall] -= np.matmul(logarithm, load[:, wall, None])[..., 0]
        return approach

    def _weights(self, places: BodyPlaces) -> tuple[NDArray[np.intp], FloatArray]:
        """Stations and weights of the interpolation to contacts, shapes (positions, contacts, points)."""
        return weights_of((self.flank, *self.bores, *self.holes), places.wall, places.parameter)

    def _logarithms(self, places: BodyPlaces) -> Iterator[tuple[slice, FloatArray]]:
        """κ ln(distance) among contacts of the flank and of each bore, zero of one with itself, with their numbers."""
        flank, bores = np.searchsorted(places.wall[0], (1, 1 + len(self.bores)))
        for own in (slice(0, flank), slice(flank, bores)):
            wall, point = places.wall[:, own], places.point[:, own]
            apart = point[:, :, None] - point[:, None]
            none = (wall[:, :, None] != wall[:, None]) | np.eye(wall.shape[1], dtype=bool)
            square = np.where(none, 1.0, apart.real**2 + apart.imag**2)
            yield own, 0.5 * self.disc_logarithm * np.log(square)

    def race_matrix(self, angles: FloatArray, radius: float) -> FloatArray:
        """Return the coefficients of inner contacts at angles in the cage, rad, on the race of each crank for itself, mm/N."""
        cranks = len(self.bores)
        angles = angles[: angles.size // cranks]
        between = angles[:, None] - angles[None, :]
        stations, weights = Boundary(first=0, count=self.race.size).weights(between)
        matrix = np.einsum("ijk,ijk->ij", self.race[stations], weights)
        distance = 2.0 * radius * np.abs(np.sin(0.5 * between))
        same = np.eye(angles.size, dtype=bool)
        return np.kron(np.eye(cranks), matrix - self.race_logarithm * np.log(np.where(same, 1.0, distance)))


def _mean_logarithm(distance: FloatArray, first: FloatArray, second: FloatArray) -> FloatArray:
    """⟨ln|x − x′|⟩ over two semi-elliptic patches at a distance: exact for a patch on itself, else to (b/d)²."""
    apart = distance > 0.0
    far = np.log(np.where(apart, distance, 1.0))
    far -= (first**2 + second**2) / (8.0 * np.where(apart, distance, np.inf) ** 2)
    return np.where(apart, far, np.log(0.5 * first) - 0.25)


def logarithm_factor(material: Material, thickness: float, plane: str = "strain") -> float:
    """Return κ = 2 (1 − ν²)/(π E t) of a half-plane's displacement −κ F ln(distance); in plane stress 2/(π E t)."""
    compliance = 1.0 / material.youngs_modulus if plane == "stress" else material.plane_strain_compliance
    return 2.0 * compliance / (np.pi * thickness)


def load_coefficients(
    path: Path, drive: Drive, *, lawful: bool | Literal["quick"] = True, bodies: Bodies | None = None
) -> InfluenceCoefficients:
    """Read the coefficients of a drive from a file of ``cyclo derive``, checking its laws ("quick": those of milliseconds)."""
    data = read_coefficients(path, lawful=lawful)
    own: Bodies = "solid" if is_solid(data) else "plane"
    if bodies not in (None, own):
        raise CycloError(f"{path}: holds coefficients of {own} bodies, not of {bodies} ones: give --bodies {own}")
    shared = require_same_bodies(path, data, drive)
    boundaries = len(np.unique(data["station_boundary"].values))
    walls = 1 + drive.crank.number + drive.number_of_holes
    if boundaries != walls:
        raise DamagedFileError(
            f"{path}: has stations on {boundaries} boundaries; flank, bores and holes of {drive.name} are {walls}"
        )
    require_places(path, data, nominal_shape(drive, keep_clearance=not shared))
    found = _coefficients_of_dataset(data, drive, shared=shared)
    stress = read_stress_coefficients(data, (found.flank, *found.bores, *found.holes))
    return replace(
        found, stress=stress, code_hash=str(data.attrs.get("code_hash", "")), warning=quality_warning(data, str(path))
    )


def _coefficients_of_dataset(
    data: Labelled, drive: Drive, *, shared: bool, tilts: bool = False
) -> InfluenceCoefficients:
    """Take the half-plane's logarithm off every entry of a file; that of `tilts` has 12 by the square of the length."""
    plane, thickness, parts = str(data.attrs["plane"]), float(data.attrs["thickness"]), drive.materials
    # Solid rollers have their own length.
    length = drive.roller_length if plane == SOLID else thickness

    def approach(body: str) -> FloatArray:
        return np.asarray(data[f"{body}_tilt_approach" if tilts else f"{body}_approach"].values)

    def logarithm(material: Material, width: float) -> float:
        return logarithm_factor(material, width, plane) * (12.0 / width**2 if tilts else 1.0)

    boundary = data["station_boundary"].values.astype(int)
    places = data["station_x"].values + 1j * data["station_y"].values
    half_width = data["station_half_width"].values
    disc_logarithm = logarithm(parts.disc, thickness)
    distance = np.abs(places[:, None] - places[None, :])
    between = _mean_logarithm(distance, half_width[:, None], half_width[None, :])
    same = boundary[:, None] == boundary[None, :]
    disc = approach("disc") + np.where(same, disc_logarithm * between, 0.0)

    flank, *walls = boundaries_of(boundary, drive.disc.number_of_teeth, flank_clustering(data))
    pin_logarithm = logarithm(drive.flank_pin, thickness)
    roller_logarithm = logarithm(parts.roller, length)
    race_logarithm = logarithm(parts.inner_race, thickness)
    of_pin, of_roller = (
        _mean_logarithm(0.0 * b, b, b) for b in (data["pin_half_width"].values, data["roller_half_width"].values)
    )
    roller = approach("roller") + roller_logarithm * np.diag(of_roller)
    angle = data["race_angle"].values
    race_half_width = np.full(angle.shape, float(data["race_half_width"].values))
    chord = 2.0 * drive.crank_bearing.inner_race_radius * np.abs(np.sin(0.5 * angle))
    race = approach("race") + race_logarithm * _mean_logarithm(chord, race_half_width, race_half_width)
    return InfluenceCoefficients(
        fingerprint=drive.shape_fingerprint("solid" if plane == SOLID else "plane"),
        shared=shared,
        plane=plane,
        thickness=thickness,
        flank=flank,
        bores=tuple(walls[: drive.crank.number]),
        holes=tuple(walls[drive.crank.number :]),
        disc=0.5 * (disc + disc.T),
        pin=float(approach("pin") + pin_logarithm * of_pin),
        roller=roller,
        race=race,
        disc_logarithm=disc_logarithm,
        pin_logarithm=pin_logarithm,
        roller_logarithm=roller_logarithm,
        race_logarithm=race_logarithm,
        tilting=_coefficients_of_dataset(data, drive, shared=shared, tilts=True)
        if plane == SOLID and not tilts
        else None,
    )
