"""Condensed finite-element model of a drive on given meshes: bodies, contact pairs, compliance at a pose.

The pressure is carried by the disc toward wheel pins, rollers and shaft pins, the inner race toward the
rollers. Pins and rollers that share a mesh share one factorisation and one compliance, turned.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from fem.body.condensation import CondensedBody
from fem.body.elasticity import PlaneState
from fem.body.surface import OppositeZone, PressureZone
from fem.contact.coupling import PairIntegrals, Pose, integrate_pair
from fem.contact.unilateral import ContactProblem
from fem.drive.contact_kinds import PairKind
from fem.drive.expected_contacts import ExpectedContacts
from fem.drive.meshes import DriveMeshes, RoundGrading
from fem.drive.rigid_bodies import bore_displacements
from fem.mesh.body_mesh import BodyMesh
from fem.shapes import DiscShape, DriveShapes
from ltca.arrays import ComplexArray, FloatArray
from ltca.drive.parts import Drive, Material
from ltca.geometry.placement import Placement


@dataclass(frozen=True, slots=True, kw_only=True)
class DrivePose:
    """Places of the rigid bodies at one crank angle.

    Attributes
    ----------
    disc_x, disc_y, disc_rotation : float
        Displacement of the disc from its nominal place, fixed axes, mm, and rotation, rad: area means.
    wheel_angle : float
        Deviation of the wheel from φ_C/u, rad.
    roller_distances : array, shape (cranks · n_BR,)
        Distance of each roller from the centre of its race along its cage ray, mm.
    shaft_pin_displacements : array of complex, shape (z_PS,)
        Displacement of each shaft pin on its spring, mm.
    wheel_pin_displacements : array of complex, shape (z_P,)
        Displacement of the seat of each wheel pin in the turning wheel, mm; zero in a rigid ring.
    crank_displacements : array of complex, shape (cranks,)
        Displacement of each crank at the disc, mm; zero of rigid ones.
    """

    disc_x: float
    disc_y: float
    disc_rotation: float
    wheel_angle: float
    roller_distances: FloatArray
    shaft_pin_displacements: ComplexArray
    wheel_pin_displacements: ComplexArray
    crank_displacements: ComplexArray

    @property
    def disc_displacement(self) -> complex:
        """Displacement of the disc centre, mm."""
        return complex(self.disc_x, self.disc_y)

    @property
    def displacements(self) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """Displacements of wheel pins, shaft pins and cranks."""
        return self.wheel_pin_displacements, self.shaft_pin_displacements, self.crank_displacements


@dataclass(frozen=True, slots=True, kw_only=True)
class RoundBody:
    """Everything that determines a condensed pin or roller.

    Attributes
    ----------
    grading : RoundGrading
        Of its mesh.
    material : Material
        Of the body.
    thickness : float
        mm.
    state : {"strain", "stress"}
        Plane strain or plane stress.
    held : str
        Boundary that does not move; "" for none.
    """

    grading: RoundGrading
    material: Material
    thickness: float
    state: PlaneState
    held: str


@dataclass(frozen=True, slots=True, kw_only=True)
class RoundGroup:
    """Condensed pin or roller whose mesh serves several bodies, also those of other crank angles and discs.

    Attributes
    ----------
    made_of : RoundBody
        What determines it: equal ones are equal to the last bit.
    body : BodyMesh
        The mesh in the frame in which it was condensed.
    condensed : CondensedBody
        Unit loads are nodal forces of the zones, one zone after the other.
    zones : tuple of OppositeZone
        One for a pin; outer and inner for a roller.
    """

    made_of: RoundBody
    body: BodyMesh
    condensed: CondensedBody
    zones: tuple[OppositeZone, ...]

    @property
    def entries(self) -> int:
        """Number of stored values."""
        return self.condensed.entries

    @property
    def compliance(self) -> FloatArray:
        """By forces on the nodes of the zones."""
        return self.condensed.compliance


class Compliant(Protocol):
    """A condensed body."""

    @property
    def compliance(self) -> FloatArray:
        """By its unit loads."""


class CompliantRound(Compliant, Protocol):
    """A condensed pin or roller."""

    @property
    def zones(self) -> tuple[OppositeZone, ...]:
        """One for a pin; outer and inner for a roller."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ContactPair:
    """One candidate contact.

    Attributes
    ----------
    kind : {"pin", "roller_outer", "roller_inner", "hole"}
        What meets what.
    index : int
        Number of the pin, roller or hole.
    zone : PressureZone
        Side that carries the pressure.
    unknowns : slice
        Its pressure unknowns among all of the drive.
    radius : float
        Radius of the circle opposite, mm.
    group : int
        Its `RoundGroup`, −1 for a rigid circle.
    turn : float
        Rotation of the group's mesh to this body, rad.
    expected_half_width : float
        mm.
    expected_load : float
        N.
    """

    kind: PairKind
    index: int
    zone: PressureZone
    unknowns: slice
    radius: float
    group: int
    turn: float
    expected_half_width: float
    expected_load: float

    @property
    def heights(self) -> int:
        """Pressure unknowns at each vertex of the zone: one in the plane."""
        return int(self.unknowns.stop - self.unknowns.start) // self.zone.unknown_count


@dataclass(frozen=True, slots=True, kw_only=True)
class PlacedContacts(ABC):
    """Candidate contacts of one disc at one crank angle and where the bodies stand at a pose, however these yield.

    Attributes
    ----------
    drive : Drive
        The drive in one case.
    crank_angle : float
        φ_C, rad.
    shapes : DriveShapes
        Exact shapes.
    meshes : DriveMeshes
        Their meshes.
    contacts : ExpectedContacts
        For which they were graded.
    pairs : tuple of ContactPair
        All candidate contacts, those on the disc first.
    placement : Placement
        Nominal places of the parts.
    disc : Compliant
        Unit loads are the pressure unknowns on it.
    race : Compliant
        One body that represents the inner races of all cranks; unit loads are the pressures about its boundary vertices,
        each once.
    groups : tuple of CompliantRound
        Pins and rollers.
    race_loads : array of int
        Unit load of `race` that each pressure unknown of an inner race is, crank after crank.
    """

    drive: Drive
    crank_angle: float
    shapes: DriveShapes
    meshes: DriveMeshes
    contacts: ExpectedContacts
    pairs: tuple[ContactPair, ...]
    placement: Placement
    disc: Compliant
    race: Compliant
    groups: tuple[CompliantRound, ...]
    race_loads: NDArray[np.intp]

    @property
    @abstractmethod
    def displacement_count(self) -> int:
        """Number of displacement unknowns of all bodies."""

    @abstractmethod
    def gap_of(self, pair: ContactPair, integral: PairIntegrals) -> FloatArray:
        """Return the weighted gap of each pressure unknown of a pair whose sides are parallel, mm·mm²."""

    @abstractmethod
    def loads_opposite(self, pair: ContactPair, integral: PairIntegrals) -> FloatArray | sp.spmatrix:
        """Return the unit loads of the round body opposite by the pressures of a pair, shape (loads, m)."""

    @abstractmethod
    def resultants_of(self, pair: ContactPair, integral: PairIntegrals) -> FloatArray:
        """Return force (x, y, N) and moment about the origin (N·mm) on the round side by its pressures, MPa, shape (3, m)."""

    @abstractmethod
    def measure_of(self, pair: ContactPair, integral: PairIntegrals) -> FloatArray:
        """Return the weighted area of each pressure unknown of a pair, mm²."""

    @abstractmethod
    def profile_of(self, pair: ContactPair, pressure: FloatArray) -> FloatArray:
        """Return the pressures of a pair along its arc, at mid-width, of all pressures, MPa."""

    @abstractmethod
    def wall_displacements(self, points: ComplexArray, pressure: FloatArray) -> ComplexArray:
        """Return the displacements of the disc at mid-width next to points on its walls, all in its frame, mm."""

    @abstractmethod
    def bore_fit(self, pressure: FloatArray) -> FloatArray:
        """Return x, y (mm) and rotation (rad) by deformation of the disc at its bores, in its frame, at all pressures, MPa."""

    def force_of(self, pair: ContactPair, integral: PairIntegrals, pressure: FloatArray) -> FloatArray:
        """Return force (x, y, N) and moment about the origin (N·mm) on the round side of a pair at all pressures, MPa."""
        return np.asarray(self.resultants_of(pair, integral) @ pressure[pair.unknowns])

    def contact_problem(self, pose: DrivePose, integrals: list[PairIntegrals], wheel_moment: float) -> ContactProblem:
        """Return the condensed contact problem linearised about a pose, with pins that stand.

        Motions: disc x, y (mm), rotation (rad), wheel rotation (rad), each candidate roller along its ray (mm), then what leans.
        """
        count, rollers, first = self.unknown_count, self.rollers, self.on_disc
        compliance = np.zeros((count, count))
        compliance[:first, :first] = self.disc.compliance
        for crank in range(self.placement.cranks):
            own, unit_loads = self.race_unknowns(crank), self.loads_on_race(crank)
            compliance[own, own] = self.race.compliance[np.ix_(unit_loads, unit_loads)]
        motions, gap = np.zeros((count, self.motion_count)), np.zeros(count)
        centre, axis, rays = self.disc_pose(pose).centre, complex(self.placement.wheel_axis), self.roller_rays
        on_rounds: dict[tuple[str, int], list[tuple[ContactPair, PairIntegrals]]] = {}
        for pair, integral in zip(self.pairs, integrals, strict=True):
            own = pair.unknowns
            gap[own] = self.gap_of(pair, integral)
            fx, fy, moment = self.resultants_of(pair, integral)
            if pair.kind != "roller_inner":
                motions[own, 0], motions[own, 1] = -fx, -fy
                motions[own, 2] = -(moment - centre.real * fy + centre.imag * fx)
            if pair.kind == "pin":
                motions[own, 3] = moment - axis.real * fy + axis.imag * fx
            elif pair.kind != "hole":
                ray = rays[pair.index]
                motions[own, 4 + rollers.index(pair.index)] = fx * ray.real + fy * ray.imag
            if pair.group >= 0:
                on_rounds.setdefault((pair.kind.partition("_")[0], pair.index), []).append((pair, integral))
            self.add_leans(pair, integral, pose, gap, motions)
        for sides in on_rounds.values():
            own_all = np.concatenate([np.arange(pair.unknowns.start, pair.unknowns.stop) for pair, _ in sides])
            loads = sp.csr_matrix(sp.block_diag([self.loads_opposite(*side) for side in sides]))
            of_round = self.groups[sides[0][0].group].compliance
            compliance[np.ix_(own_all, own_all)] += loads.T @ (loads.T @ of_round).T
        external = np.zeros(self.motion_count)
        external[3] = -wheel_moment
        return ContactProblem(compliance=compliance, gap=gap, motions=motions, external=external)

    @abstractmethod
    def add_leans(
        self, pair: ContactPair, integral: PairIntegrals, pose: DrivePose, gap: FloatArray, motions: FloatArray
    ) -> None:
        """Add to gaps what stands inclined, and to motions what tilts along the width."""

    def opposite_zone(self, pair: ContactPair) -> OppositeZone | None:
        """Return the meshed zone opposite the pressure of a pair, None for a rigid circle."""
        return None if pair.group < 0 else self.groups[pair.group].zones[1 if pair.kind == "roller_inner" else 0]

    @property
    def on_disc(self) -> int:
        """Number of pressure unknowns on the disc, the first of all."""
        return int(self.disc.compliance.shape[0])

    def race_unknowns(self, crank: int) -> slice:
        """Return the pressure unknowns on the inner race of a crank among all: rollers follow each other by cranks."""
        inner = [pair for pair in self.pairs if pair.kind == "roller_inner" and self.crank_of(pair.index) == crank]
        first = self.on_disc
        return slice(inner[0].unknowns.start, inner[-1].unknowns.stop) if inner else slice(first, first)

    def loads_on_race(self, crank: int) -> NDArray[np.intp]:
        """Return which unit load of `race` each pressure unknown on the inner race of a crank is."""
        own, first = self.race_unknowns(crank), self.on_disc
        return self.race_loads[own.start - first : own.stop - first]

    @property
    def unknown_count(self) -> int:
        """Number of pressure unknowns."""
        return int(self.pairs[-1].unknowns.stop)

    @property
    def motion_count(self) -> int:
        """Number of motions of a contact problem."""
        return 4 + len(self.rollers)

    @property
    def rollers(self) -> tuple[int, ...]:
        """Rollers with candidate contacts, in the order of their motions."""
        return tuple(pair.index for pair in self.pairs if pair.kind == "roller_outer")

    @property
    def race_centre(self) -> complex:
        """Nominal place of the disc: centre of its inner race, mean of those of several, mm."""
        return complex(self.placement.races(np.asarray(self.crank_angle)).middle)

    @property
    def race_centres(self) -> ComplexArray:
        """Centres of the inner races and cages, mm, shape (cranks,)."""
        return self.placement.races(np.asarray(self.crank_angle)).centre

    def crank_of(self, roller: int) -> int:
        """Return the number of the crank that a roller runs on."""
        return int(self.placement.roller_cranks[roller])

    @property
    def roller_rays(self) -> ComplexArray:
        """Unit vectors of the cage rays."""
        return np.asarray(np.exp(1j * self.placement.roller_angles(np.asarray(self.crank_angle))))

    def disc_pose(self, pose: DrivePose) -> Pose:
        """Return the disc's frame."""
        return Pose(centre=self.race_centre + pose.disc_displacement, rotation=pose.disc_rotation)

    def circle_centre(self, kind: PairKind, index: int, pose: DrivePose) -> complex:
        """Return the centre of a pin, roller or shaft pin in the fixed frame, mm."""
        place = self.placement
        if kind == "pin":
            centre = place.wheel_pin_centres[index] + pose.wheel_pin_displacements[index]
            return complex(place.wheel_axis + centre * self.wheel_direction(pose))
        if kind == "hole":
            return complex(place.shaft_pin_centres[index] + pose.shaft_pin_displacements[index])
        crank = self.crank_of(index)
        race = complex(self.race_centres[crank] + pose.crank_displacements[crank])
        return race + complex(pose.roller_distances[index] * self.roller_rays[index])

    def wheel_direction(self, pose: DrivePose) -> complex:
        """Return the direction in which the wheel stands."""
        return complex(np.exp(1j * (self.crank_angle / self.placement.reduction_ratio + pose.wheel_angle)))

    def carrier_pose(self, pair: ContactPair, pose: DrivePose) -> Pose:
        """Return the frame of the body that carries the pressure of a pair."""
        if pair.kind == "roller_inner":
            crank = self.crank_of(pair.index)
            return Pose(centre=complex(self.race_centres[crank] + pose.crank_displacements[crank]))
        return self.disc_pose(pose)

    def integrate(self, pair: ContactPair, pose: DrivePose) -> PairIntegrals:
        """Integrate one pair at a pose."""
        circle = Pose(centre=self.circle_centre(pair.kind, pair.index, pose), rotation=pair.turn)
        return integrate_pair(pair.zone, self.carrier_pose(pair, pose), circle, pair.radius, self.opposite_zone(pair))

    def start_pose(self, start: tuple[float, float, float, float] | None = None) -> DrivePose:
        """Return a pose with rollers midway between race and bore and shaft pins unloaded.

        `start` is disc x, y (mm), disc rotation and wheel angle (rad); by default the pose the meshes were graded for.
        """
        contacts, place = self.contacts, self.placement
        x, y, rotation, wheel = start or (
            contacts.disc_x,
            contacts.disc_y,
            contacts.disc_rotation,
            contacts.wheel_angle,
        )
        bores = bore_displacements(place, self.crank_angle, complex(x, y), rotation)[place.roller_cranks]
        toward = (bores * self.roller_rays.conjugate()).real
        outer = place.bore_radius - place.roller_radii + toward
        inner = place.inner_race_radius + place.roller_radii
        return DrivePose(
            disc_x=x,
            disc_y=y,
            disc_rotation=rotation,
            wheel_angle=wheel,
            roller_distances=0.5 * (outer + inner),
            shaft_pin_displacements=np.zeros(len(place.hole_radii), dtype=complex),
            wheel_pin_displacements=np.zeros(len(place.wheel_pin_radii), dtype=complex),
            crank_displacements=np.zeros(place.cranks, dtype=complex),
        )

    def start_active(self) -> NDArray[np.bool_]:
        """Return the pressure unknowns under the expected pressures."""
        active = np.zeros(self.unknown_count, dtype=bool)
        for pair in self.pairs:
            if pair.expected_load > 0.0:
                arc = pair.zone.arc[1:-1]
                middle = 0.5 * pair.zone.arc[-1]
                near = np.abs(arc - middle) < 0.8 * pair.expected_half_width
                active[pair.unknowns] = np.repeat(near, pair.heights)
        return active


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveModel(PlacedContacts):
    """Condensed drive at one crank angle; the meshes and factors serve every load and pose near by.

    Attributes
    ----------
    disc, race, groups
        Plane bodies.
    """

    disc: CondensedBody
    race: CondensedBody
    groups: tuple[RoundGroup, ...]

    @property
    def displacement_count(self) -> int:
        """Number of displacement unknowns of all bodies."""
        return self.meshes.unknowns

    def gap_of(self, pair: ContactPair, integral: PairIntegrals) -> FloatArray:
        """Return the weighted gap of each pressure unknown of a pair, mm·mm²."""
        return integral.gap

    def loads_opposite(self, pair: ContactPair, integral: PairIntegrals) -> FloatArray:
        """Return the forces on the nodes of the zone opposite by the pressures of a pair, shape (loads, m)."""
        return integral.opposite_loads

    def add_leans(
        self, pair: ContactPair, integral: PairIntegrals, pose: DrivePose, gap: FloatArray, motions: FloatArray
    ) -> None:
        """Leave gaps and motions as they are: nothing leans in the plane."""

    def resultants_of(self, pair: ContactPair, integral: PairIntegrals) -> FloatArray:
        """Return force (x, y, N) and moment about the origin (N·mm) on the round side by its pressures, MPa, shape (3, m)."""
        return integral.force

    def measure_of(self, pair: ContactPair, integral: PairIntegrals) -> FloatArray:
        """Return the weighted area of each pressure unknown of a pair, mm²."""
        return integral.measure

    def profile_of(self, pair: ContactPair, pressure: FloatArray) -> FloatArray:
        """Return the pressures of a pair along its arc, of all pressures, MPa."""
        return pressure[pair.unknowns]

    def wall_displacements(self, points: ComplexArray, pressure: FloatArray) -> ComplexArray:
        """Return the displacements of the disc at its nodes next to points, both in its frame, mm."""
        nearest = [int(np.argmin(np.abs(self.meshes.disc.places - point))) for point in points.tolist()]
        moved = self.disc_displacement(pressure)
        return np.asarray((moved[0::2] + 1j * moved[1::2])[nearest])

    def bore_fit(self, pressure: FloatArray) -> FloatArray:
        """Return x, y (mm) and rotation (rad) by deformation of the disc at its bores, in its frame, at all pressures, MPa."""
        nodes, fit = bore_weights(self.meshes.disc, self.shapes.disc)
        moved = self.disc_displacement(pressure)
        return np.asarray(fit @ np.concatenate([moved[0::2][nodes], moved[1::2][nodes]]))

    def disc_displacement(self, pressure: FloatArray) -> FloatArray:
        """Return the nodal displacements of the disc in its own frame, mm, at all pressures of the drive, MPa."""
        return self.disc.displacement(pressure[: self.on_disc])

    def race_displacement(self, crank: int, pressure: FloatArray) -> FloatArray:
        """Return the nodal displacements of the inner race of a crank, fixed axes, mm, at all pressures of the drive, MPa."""
        carried = np.zeros(self.race.compliance.shape[0])
        carried[self.loads_on_race(crank)] = pressure[self.race_unknowns(crank)]
        return self.race.displacement(carried)


def bore_weights(disc: BodyMesh, shape: DiscShape) -> tuple[NDArray[np.intp], FloatArray]:
    """Return the nodes on the bores of a disc and what their displacements weigh in x, y and rotation that fit them best.

    Weights by x of all nodes, then y, shape (3, 2 nodes): least squares over the length of the bores.
    """
    chain = np.concatenate([disc.boundary_nodes(bore.name) for bore in shape.bores])
    places = disc.places
    weight = np.zeros(len(places))
    length = np.abs(places[chain[:, 2]] - places[chain[:, 0]])
    for column, share in ((0, 1.0), (1, 4.0), (2, 1.0)):
        np.add.at(weight, chain[:, column], share * length / 6.0)
    nodes = np.flatnonzero(weight)
    return nodes, rigid_fit(places[nodes], weight[nodes])


def rigid_fit(places: ComplexArray, weight: FloatArray) -> FloatArray:
    """Return the weights of displacements in the translation of the origin and rotation that fit them best, (3, 2 places)."""
    x, y, one = places.real, places.imag, np.ones(len(places))
    rows = np.vstack([np.column_stack([one, 0 * one, -y]), np.column_stack([0 * one, one, x])])
    root = np.sqrt(np.concatenate([weight, weight]))
    return np.asarray(np.linalg.pinv(rows * root[:, None]) * root)
