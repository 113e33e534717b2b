r"""Influence coefficients of the bodies derived from finite elements: the file, and their values at any place.

The file (written by ``cyclo derive``, format in docs/theory/coefficients.md) holds the approach of patches on disc, pin,
roller and race by unit loads on patches, at stations along the boundaries. Of each entry the half-plane's logarithm is
taken off; what is left is smooth when load and place move together, and is interpolated. The logarithm of the
actual places is added again.

Plane bodies know loads that are even along the width alone. Files of solid bodies hold a second set, of loads linear along it:
the tilt by a moment of 1 N·mm, q = 12 z/t³. Near a contact both follow one logarithm, that of a moment times 12/t².
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import FloatArray
from ltca.compliance.stress_coefficients import StressCoefficients, read_stress_coefficients
from ltca.drive.parts import Bodies, Drive, Material
from ltca.drive.single_discs import nominal_shape
from ltca.errors import CycloError, DamagedFileError, DriveError
from ltca.geometry.boundary_stations import (
    LAGRANGE_POINTS,
    Boundary,
    boundaries_of,
    turned_boundaries,
    weights_of,
)
from ltca.reading.coefficient_file import quality_warning, read_coefficients, require_places, require_same_bodies
from ltca.reading.coefficient_schema import (
    flank_clustering,
    is_solid,
)

if TYPE_CHECKING:
    from ltca.output.labelled import Labelled


SOLID = "solid"
"""What files of solid bodies say of their plane."""


@dataclass(frozen=True, slots=True, kw_only=True)
class InfluenceCoefficients:
    """Smooth parts of the influence coefficients of all bodies, and the strength of their logarithms: approaches by loads,
    mm/N, or tilts by moments, rad/(N·mm).

    Attributes
    ----------
    fingerprint : str
        `Drive.shape_fingerprint` of the drive they serve.
    shared : bool
        Whether they stand for bodies that differ a little from those they were derived for: on somebody's word.
    plane : str
        "strain" or "stress", state of the body part; or "solid".
    thickness : float
        Of all bodies but solid rollers, which are as long as they are, mm.
    flank : Boundary
        Stations of the flank.
    bores : tuple of Boundary
        Stations of the bore of each crank.
    holes : tuple of Boundary
        Stations of each hole.
    disc : array, shape (stations, stations)
        Smooth part of the disc.
    pin : float
        Smooth part of a wheel pin.
    roller : array, shape (2, 2)
        Of a roller; rows and columns inner, outer.
    race : array, shape (angles,)
        Of the inner race, by the angle between place and load.
    disc_logarithm, pin_logarithm, roller_logarithm, race_logarithm : float
        Factor κ of −ln(distance) in each body, mm/N or rad/(N·mm).
    stress : StressCoefficients or None
        Stress along the walls of the disc, where the file has it.
    code_hash : str
        Of the code that derived them, where the file says so.
    warning : str
        What to tell of figures that their file states about its accuracy and that are out of bounds; "" of none.
    tilting : InfluenceCoefficients or None
        Tilts by moments of solid bodies; None of plane ones, which take nothing of a tilt.
    """

    fingerprint: str
    shared: bool
    plane: str
    thickness: float
    flank: Boundary
    bores: tuple[Boundary, ...]
    holes: tuple[Boundary, ...]
    disc: FloatArray
    pin: float
    roller: FloatArray
    race: FloatArray
    disc_logarithm: float
    pin_logarithm: float
    roller_logarithm: float
    race_logarithm: float
    stress: StressCoefficients | None = None
    code_hash: str = ""
    warning: str = ""
    tilting: InfluenceCoefficients | None = None

    @property
    def bodies(self) -> Bodies:
        """What bodies they are of."""
        return "solid" if self.plane == SOLID else "plane"

    def lent_to(self, drive: Drive) -> InfluenceCoefficients:
        """Return the same coefficients to serve another drive whose bodies differ a little; who asks answers for it.

        Parameters
        ----------
        drive : Drive
            With as many teeth, bores and holes.

        Raises
        ------
        DriveError
            When the numbers of bores or holes differ.
        """
        counts = (
            ("crank.number", drive.crank.number, self.bores),
            ("pin_shaft.number_of_pins", drive.number_of_holes, self.holes),
        )
        if wrong := [
            f"{name} = {number}: must be {len(walls)}, that of the drive whose influence coefficients are shared"
            for name, number, walls in counts
            if number != len(walls)
        ]:
            raise DriveError(wrong[:1])
        fingerprint = drive.shape_fingerprint(self.bodies)
        return replace(self, fingerprint=fingerprint, shared=self.shared or fingerprint != self.fingerprint)

    def placed_in(self, drive: Drive) -> InfluenceCoefficients:
        """Return the coefficients of the part as it stands in a disc whose flank is turned against bores and holes.

        Parameters
        ----------
        drive : Drive
            Of one disc; which part it is and how that stands in it is told by `ltca.drive.parts.part_turn`.
        """
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
        """Return the coefficients with rollers of a length of their own, mm: in the plane they yield like one over it, and solid
        ones have it.
        """
        if self.plane == SOLID:
            return self
        scale = self.thickness / length
        return replace(self, roller=scale * self.roller, roller_logarithm=scale * self.roller_logarithm)

    def disc_matrix(
        self,
        flank: FloatArray,
        bore: FloatArray,
        holes: FloatArray,
        flank_places: NDArray[np.complex128],
        radius: float,
        loaded: Sequence[NDArray[np.intp]] | None = None,
        *,
        among: bool = False,
    ) -> FloatArray:
        """Return the coefficients between contacts of the disc, the logarithm of a contact on itself left out.

        Parameters
        ----------
        flank, bore, holes : array, shape (positions, pairs)
            Places: θ on the flank, polar angles in the disc frame about their centres on bores (rollers crank after crank)
            and holes, rad.
        flank_places : array of complex, shape (positions, z_P)
            The flank contacts in the disc frame, mm.
        radius : float
            Of the bores, mm.
        loaded : sequence of three arrays of int, shape (positions, chosen), optional
            Pins, rollers and holes whose loads are asked for; all of them by default.
        among : bool
            Whether only the approaches of these are wanted.

        Returns
        -------
        array, shape (positions, contacts, loaded contacts)
            Approach of every contact by unit loads, in the order flank, bores, holes, mm/N.
        """
        positions, pins, rollers = flank.shape[0], flank.shape[1], bore.shape[1]
        in_bores = [bore for bore in self.bores for _ in range(rollers // len(self.bores))]
        boundaries = [self.flank] * pins + in_bores + list(self.holes)
        stations, weights = weights_of(boundaries, np.concatenate((flank, bore, holes), axis=1))
        if loaded is None:
            loaded = [np.tile(np.arange(count), (positions, 1)) for count in (pins, rollers, holes.shape[1])]
        on_flank, in_bore, in_holes = loaded
        columns = np.concatenate((on_flank, pins + in_bore, pins + rollers + in_holes), axis=1)
        if among:
            stations = np.take_along_axis(stations, columns[..., None], axis=1)
            weights = np.take_along_axis(weights, columns[..., None], axis=1)
            columns = np.broadcast_to(np.arange(columns.shape[1]), columns.shape)
        matrix = self._interpolated(stations, weights, columns)
        split = on_flank.shape[1]
        first, last = (0, split) if among else (0, pins)
        self._add_logarithm(matrix[:, first:last, :split], flank_places, on_flank, among=among)
        around = radius * np.exp(1j * bore)
        first, last = last, last + (in_bore.shape[1] if among else rollers)
        block = matrix[:, first:last, split : split + in_bore.shape[1]]
        self._add_logarithm(block, around, in_bore, len(self.bores), among=among)
        return matrix

    def _interpolated(self, stations: NDArray[np.intp], weights: FloatArray, columns: NDArray[np.intp]) -> FloatArray:
        """Smooth parts between contacts at stations with weights, shape (positions, contacts, columns)."""
        from scipy.sparse import csr_array

        positions, contacts, points = stations.shape
        chosen, size = columns.shape[1], self.disc.shape[0]
        at, weight = (np.take_along_axis(values, columns[..., None], axis=1).ravel() for values in (stations, weights))
        rows = positions * chosen
        spread = csr_array((weight, at, np.arange(rows + 1) * points), shape=(rows, size))
        half = spread @ self.disc
        places = (np.arange(rows) * size).reshape(positions, chosen, 1) + stations.reshape(positions, 1, -1)
        near = half.ravel().take(places).reshape(positions, chosen, contacts, points)
        return np.asarray(np.einsum("bkna,bna->bnk", near, weights))

    def _add_logarithm(
        self,
        block: FloatArray,
        places: NDArray[np.complex128],
        columns: NDArray[np.intp],
        walls: int = 1,
        *,
        among: bool = False,
    ) -> None:
        """Take off κ ln(distance) between all places, or `among` those of the columns, and those of the columns on one wall, a
        place and itself left out.
        """
        chosen, each = np.take_along_axis(places, columns, axis=1), places.shape[1] // walls
        rows = columns if among else np.arange(places.shape[1])[None]
        apart = (chosen if among else places)[:, :, None] - chosen[:, None, :]
        square = apart.real**2 + apart.imag**2
        same = rows[:, :, None] == columns[:, None, :]
        if walls > 1:
            same |= (rows // each)[:, :, None] != (columns // each)[:, None, :]
        block -= 0.5 * self.disc_logarithm * np.log(np.where(same, 1.0, square))

    def race_matrix(self, angles: FloatArray, radius: float) -> FloatArray:
        """Return the coefficients between the inner contacts of all rollers, on the race of each crank for itself, mm/N.

        Parameters
        ----------
        angles : array, shape (cranks · n_BR,)
            Polar angles of the contacts in the cage, crank after crank and the same in each, rad.
        radius : float
            r_i, mm.

        Returns
        -------
        array, shape (cranks · n_BR, cranks · n_BR)
        """
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
    """Return κ = 2 (1 − ν²)/(π E t) of a half-plane's displacement −κ F ln(distance); 2/(π E t) in plane stress.

    Near its contacts a solid is in plane strain but for its ends.
    """
    compliance = 1.0 / material.youngs_modulus if plane == "stress" else material.plane_strain_compliance
    return 2.0 * compliance / (np.pi * thickness)


def load_coefficients(
    path: Path, drive: Drive, *, lawful: bool | Literal["quick"] = True, bodies: Bodies | None = None
) -> InfluenceCoefficients:
    """Read the coefficients of a drive.

    Parameters
    ----------
    path : Path
        File of ``cyclo derive``.
    drive : Drive
        The drive they must belong to.
    lawful : bool or "quick"
        Check their laws, which takes a second; "quick" those that take milliseconds, where all held when they were derived.
    bodies : {"plane", "solid"}, optional
        What bodies they must be of; any by default.

    Returns
    -------
    InfluenceCoefficients
        Ready to be evaluated at any place.

    Raises
    ------
    CycloError
        When the file cannot be read, is damaged, breaks a law, or belongs to other bodies; it names what differs.
    """
    data = read_coefficients(path, lawful=lawful)
    own = bodies_of(data)
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
        found,
        stress=stress,
        code_hash=str(data.attrs.get("code_hash", "")),
        warning=quality_warning(data, str(path)),
    )


def bodies_of(data: Labelled) -> Bodies:
    """Return what bodies a file is of."""
    return "solid" if is_solid(data) else "plane"


def _coefficients_of_dataset(data: Labelled, drive: Drive, *, shared: bool) -> InfluenceCoefficients:
    """Take the half-plane's logarithm off every entry of a file."""
    even = _smooth_parts(data, drive, shared=shared)
    return replace(even, tilting=_smooth_parts(data, drive, shared=shared, tilts=True)) if even.plane == SOLID else even


def _smooth_parts(data: Labelled, drive: Drive, *, shared: bool, tilts: bool = False) -> InfluenceCoefficients:
    """Smooth parts of approaches by loads, or of tilts by moments, whose logarithms have 12 by the square of the length."""
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
        fingerprint=drive.shape_fingerprint(bodies_of(data)),
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
    )


def without_coupling(drive: Drive) -> InfluenceCoefficients:
    """Return coefficients that add nothing to the half-space: C = 0, the paper's model."""
    cranks, holes = drive.crank.number, drive.number_of_holes
    flank, *walls = [Boundary(first=k * LAGRANGE_POINTS, count=LAGRANGE_POINTS) for k in range(1 + cranks + holes)]
    return InfluenceCoefficients(
        fingerprint=drive.shape_fingerprint(),
        shared=False,
        plane="none",
        thickness=drive.disc.thickness,
        flank=flank,
        bores=tuple(walls[:cranks]),
        holes=tuple(walls[cranks:]),
        disc=np.zeros(((1 + cranks + holes) * LAGRANGE_POINTS,) * 2),
        pin=0.0,
        roller=np.zeros((2, 2)),
        race=np.zeros(LAGRANGE_POINTS),
        disc_logarithm=0.0,
        pin_logarithm=0.0,
        roller_logarithm=0.0,
        race_logarithm=0.0,
    )
