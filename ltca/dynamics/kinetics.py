"""Coordinates of a drive in motion, its mass matrix, and its inertia referred to input and output (``docs/theory/motion.md``)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ltca.arrays import ComplexArray, FloatArray
from ltca.beam import shaft_flexibility
from ltca.drive.parts import Drive
from ltca.dynamics.masses import (
    CRANKS,
    DISCS,
    INERTIA,
    POSTS,
    RING,
    ROLLERS,
    SHAFT_PINS,
    SLEEVES,
    TONNE_PER_KG,
    WHEEL_PINS,
    DriveMasses,
    Solid,
    drive_masses,
)
from ltca.equilibrium.first_stage import StageMesh
from ltca.errors import DriveError, Problem
from ltca.geometry.coordinates import DISC_ROTATION, WHEEL_ANGLE, Coordinates, X
from ltca.laws.member_bearings import crank_springs

OF_WHEEL = (WHEEL_PINS, SLEEVES[WHEEL_PINS], RING)
OF_SHAFT = (SHAFT_PINS, SLEEVES[SHAFT_PINS], POSTS)
INPUT, OUTPUT, CARRIER, WHEEL = "input", "output", "carrier and shaft pins", "wheel pins"
"""Names of bodies beside discs, rollers and cranks."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Motion:
    """Coordinates of a vibrating drive: those of the pose, then the crank angle, the sun, the twist of the carrier."""

    drive: Drive
    pose: Coordinates
    mesh_compliance: float  # of cranks against the sun by all their moments, rad/(N·mm), 0 of rigid teeth
    mesh_by_pose: FloatArray  # their rotation by the pose, rad by mm or rad
    twist_stiffness: float  # of the carrier, N·mm/rad, 0 of a rigid one

    @classmethod
    def of_drive(cls, drive: Drive) -> Motion:
        """Return the coordinates of a warm drive; with contacts in slices leans of its parts are among them."""
        pose, mesh, carrier = Coordinates.of_drive(drive), StageMesh.of_drive(drive), drive.carrier
        compliance, by_pose = 0.0, np.zeros(pose.size)
        if mesh is not None:
            # The load drives the cranks against the teeth in this sense.
            compliance, by_pose = mesh.together(float(drive.driving_sign))
        return cls(
            drive=drive,
            pose=pose,
            mesh_compliance=compliance,
            mesh_by_pose=by_pose,
            twist_stiffness=0.0 if carrier is None else carrier.stiffness_torsion or 0.0,
        )

    @property
    def crank(self) -> int:
        """Place of the crank angle."""
        return self.pose.size

    @property
    def wheel_angle(self) -> int:
        """Place of the angle of the wheel."""
        return self.pose.size + WHEEL_ANGLE

    @property
    def sun(self) -> int | None:
        """Place of the angle of the sun, in angles of the cranks; None where it turns with them."""
        return self.pose.size + 1 if self.mesh_compliance else None

    @property
    def twist(self) -> int | None:
        """Place of the twist of the carrier; None where it is rigid."""
        return self.pose.size + 1 + bool(self.mesh_compliance) if self.twist_stiffness else None

    @property
    def springs(self) -> FloatArray:
        """Stiffness of the carrier against its twist, shape (n, n)."""
        return np.diag(self.twist_stiffness * self.unit(self.twist))

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return self.pose.size + 1 + bool(self.mesh_compliance) + bool(self.twist_stiffness)

    def unit(self, place: int | None) -> FloatArray:
        """Return the row of one coordinate; zeros of none."""
        row = np.zeros(self.size)
        if place is not None:
            row[place] = 1.0
        return row

    def displacement(self, x: int) -> ComplexArray:
        """Return the row of x + iy of a part whose x is a coordinate before its y."""
        return np.asarray(self.unit(x) + 1j * self.unit(x + 1))

    @property
    def wheel_turns(self) -> FloatArray:
        """Row of the rotation of the wheel against the pin shaft."""
        return self.unit(self.wheel_angle) + self.unit(self.crank) / self.drive.reduction_ratio

    @property
    def frame_turns(self) -> FloatArray:
        """Row of the rotation of the pin shaft (of the near flange of a carrier)."""
        return -self.wheel_turns if self.drive.wheel_is_held else self.unit(self.twist)

    @property
    def wheel_moves(self) -> ComplexArray:
        """Row of the displacement of the wheel against the pin shaft, x + iy."""
        return self.displacement(self.pose.wheel_place.start) if self.pose.wheel else np.zeros(self.size, dtype=complex)

    @property
    def frame_moves(self) -> ComplexArray:
        """Row of the displacement of the pin shaft."""
        return -self.wheel_moves if self.drive.wheel_is_held else np.zeros(self.size, dtype=complex)

    @property
    def input_turns(self) -> FloatArray:
        """Row of the rotation of the input."""
        stage, turns = self.drive.first_stage_ratio, self.unit(self.crank if self.sun is None else self.sun)
        if self.sun is None:  # of rigid teeth, if there are any
            turns[: self.pose.size] += self.mesh_by_pose
        return self.frame_turns + (turns if stage is None else -stage * turns)

    @property
    def output_turns(self) -> FloatArray:
        """Row of the rotation of the output."""
        return self.frame_turns + (self.unit(self.twist) if self.drive.wheel_is_held else self.wheel_turns)

    @property
    def output_moves(self) -> ComplexArray:
        """Row of the displacement of the output, x + iy."""
        return -self.wheel_moves if self.drive.wheel_is_held else self.wheel_moves

    def turned(self, crank_angle: FloatArray) -> FloatArray:
        """Return the matrices from coordinates in the frame that turns with the crank to those at rest, (positions, n, n)."""
        angle, spin = crank_angle[:, None, None], self.spin
        return np.asarray(np.eye(self.size) + np.sin(angle) * spin + (1.0 - np.cos(angle)) * (spin @ spin))

    @property
    def spin(self) -> FloatArray:
        """Derivative of `turned` by the crank angle, in the frame that turns, shape (n, n)."""
        found, x = np.zeros((self.size, self.size)), self.pose.displacements
        found[x, x + 1], found[x + 1, x] = -1.0, 1.0
        return found

    @property
    def rigid(self) -> FloatArray:
        """Motion of all parts as rigid ones while the crank turns by 1 rad."""
        return self.unit(self.crank) + self.unit(self.sun)


@dataclass(frozen=True, slots=True, kw_only=True)
class Body:
    """A mass or a moment of inertia, about z or about a line in the plane, with the row of its velocity."""

    name: str
    turns: bool  # about z
    size: float  # t, t·mm²
    row: ComplexArray  # of x + iy, of a rotation, or of a lean in one direction, by rates of coordinates
    across: ComplexArray | None = None  # row of the lean across, of a moment of inertia about a line in the plane

    @property
    def leans(self) -> bool:
        """Whether it is a moment of inertia about a line in the plane."""
        return self.across is not None

    @property
    def carried(self) -> ComplexArray:
        """Velocity that a frame which turns by 1 rad adds, by the displacements of the row."""
        return 1j * self.row if self.across is None else self.across


def require_masses(masses: DriveMasses) -> DriveMasses:
    """Return the masses themselves; DriveError with every density that is not given."""
    missing = masses.without_density
    if missing:
        said = "must be given for inertias, kg/m³ (a named material has it)"
        raise DriveError([Problem.of(path, "", said) for path in missing])
    return masses


def moving_bodies(motion: Motion, masses: DriveMasses, crank_angle: float) -> tuple[Body, ...]:
    """Return every body that moves, with its velocity at a crank angle, rad; those that stand are left out."""
    require_masses(masses)
    bodies = (
        *_discs_and_rollers(motion, masses, crank_angle),
        *_cranks(motion, masses, crank_angle),
        *_members(motion, masses),
        *_given(motion),
    )
    return tuple(body for body in bodies if body.size and np.any(body.row))


def mass_matrix(bodies: Sequence[Body]) -> FloatArray:
    """Return the mass matrix of bodies, t, t·mm, t·mm², shape (coordinates, coordinates)."""
    rows, sizes = np.array([body.row for body in bodies]), np.array([body.size for body in bodies])
    return np.asarray((rows.conj().T @ (sizes[:, None] * rows)).real)


@dataclass(frozen=True, slots=True, kw_only=True)
class ReflectedInertia:
    """Moment of inertia of all parts that move, as rigid ones, t·mm², and those given in front and behind, 0 of none."""

    at_input: float
    at_output: float
    given_input: float
    given_output: float


def reflected_inertia(drive: Drive, masses: DriveMasses | None = None) -> ReflectedInertia | None:
    """Return the inertia of a drive at its input and output, mean over a turn; None where a density is not known."""
    masses = drive_masses(drive) if masses is None else masses
    if masses.without_density:
        return None
    # Slices change nothing of rigid motions.
    motion = Motion.of_drive(replace(masses.drive, contact=replace(masses.drive.contact, slices=1)))
    energies = []
    for angle in (0.0, np.pi):  # uneven holes make it vary once a turn
        own = [body for body in moving_bodies(motion, masses, angle) if body.name not in (INPUT, OUTPUT)]
        energies.append(motion.rigid @ mass_matrix(own) @ motion.rigid)
    given, mean = drive.inertia, float(np.mean(energies))
    return ReflectedInertia(
        at_input=mean / float(motion.input_turns @ motion.rigid) ** 2,
        at_output=mean / float(motion.output_turns @ motion.rigid) ** 2,
        given_input=0.0 if given is None else INERTIA * (given.input or 0.0),
        given_output=0.0 if given is None else INERTIA * (given.output or 0.0),
    )


def _rigid(
    motion: Motion, name: str, mass: float, inertia: float, place: complex, moves: ComplexArray, turns: FloatArray
) -> Iterator[Body]:
    """Mass and inertia of a part that stands at a place and moves by rows in the frame of the pin shaft."""
    row = np.asarray(motion.frame_moves + 1j * motion.frame_turns * place + moves)
    yield Body(name=name, turns=False, size=mass, row=row)
    yield _turning(motion, name, inertia, turns)


def _turning(motion: Motion, name: str, inertia: float, turns: FloatArray) -> Body:
    return Body(name=name, turns=True, size=inertia, row=(motion.frame_turns + turns).astype(complex))


def _discs_and_rollers(motion: Motion, masses: DriveMasses, angle: float) -> Iterator[Body]:
    bearing, pose, crank = motion.drive.crank_bearing, motion.pose, motion.unit(motion.crank)
    for number, (place, disc) in enumerate(zip(masses.places, masses.of(DISCS), strict=True)):
        own, at = pose.columns(number), np.array([angle])
        start, stands = complex(place.races(np.zeros(1)).middle[0]), complex(place.races(at).middle[0])
        middle = disc.place - start  # from the origin of the disc, which does not turn
        turns = motion.unit(int(own[DISC_ROTATION]))
        moves = motion.displacement(int(own[X])) + complex(place.races(at).velocity[0]) * crank
        row = moves + 1j * middle * turns
        yield from _rigid(motion, f"disc {number}", disc.mass, disc.about_own_axis, stands + middle, row, turns)
        yield from _leaning(motion, disc, number)
        mass = sum(solid.mass for solid in masses.of(ROLLERS) if solid.disc == number) / place.cranks
        radius = float(np.mean(place.roller_radii))
        orbit, cage = bearing.inner_race_radius + radius, float(place.cage_speed)
        for bore, (stands_off, centre) in enumerate(zip(place.bore_centres, place.races(at).centre[0], strict=True)):
            carried = _eccentric_moves(motion, masses, number, bore, angle)
            row = 0.5 * (moves + 1j * complex(stands_off) * turns + carried)
            yield from _rigid(motion, ROLLERS, mass, mass * orbit**2, complex(centre), row, cage * crank)
            yield _turning(motion, ROLLERS, 0.5 * mass * radius**2, -cage * orbit / radius * crank)


def _leaning(motion: Motion, disc: Solid, number: int) -> Iterator[Body]:
    """Transverse moments of inertia of a disc that leans: points move by z l in the plane and −(x l_x + y l_y) along z."""
    if not motion.pose.leans:
        return
    tensor = disc.inertia
    along, beside = (motion.unit(int(x)) for x in motion.pose.columns(number)[motion.pose.lean_place])
    # A lean along x turns the disc about y.
    sizes, directions = np.linalg.eigh([[tensor[1, 1], -tensor[0, 1]], [-tensor[0, 1], tensor[0, 0]]])
    for size, (x, y) in zip(sizes.tolist(), directions.T.tolist(), strict=True):
        row, across = (x * along + y * beside).astype(complex), (y * along - x * beside).astype(complex)
        yield Body(name=f"disc {number}", turns=False, size=size, row=row, across=across)


def _eccentric_moves(motion: Motion, masses: DriveMasses, disc: int, crank: int, angle: float) -> ComplexArray:
    """Velocity of the centre of an eccentric in the frame of the pin shaft."""
    place = masses.places[disc]
    arm = complex((place.eccentricity * place.eccentric_directions(np.array([angle]))[0])[crank])
    return 1j * arm * _crank_turns(motion, disc, crank) + _crank_moves(motion, disc, crank)


def _crank_turns(motion: Motion, disc: int, crank: int) -> FloatArray:
    """Row of the rotation of a crank at a disc, twisted."""
    row, places = motion.unit(motion.crank), motion.pose.twist_places
    return row + motion.unit(int(motion.pose.columns(disc)[places[crank]])) if places else row


def _crank_moves(motion: Motion, disc: int, crank: int) -> ComplexArray:
    """Row of the displacement of the axis of a crank at a disc."""
    if not motion.pose.cranks:
        return np.zeros(motion.size, dtype=complex)
    return motion.displacement(int(motion.pose.columns(disc)[motion.pose.crank(crank)]))


def _cranks(motion: Motion, masses: DriveMasses, angle: float) -> Iterator[Body]:
    """Eccentrics and shafts; where mass or inertia of a crank is given, that, by equal parts at the discs."""
    given, discs, number = motion.drive.inertia, motion.pose.discs, motion.drive.crank.number
    if given is not None and (given.crank is not None or given.crank_mass is not None):
        mass, inertia = masses.mass_of(CRANKS) / (number * discs), masses.crank_inertia / discs
        for disc, place in enumerate(masses.places):
            for crank, axis in enumerate(place.crank_axes.tolist()):
                moves, turns = _crank_moves(motion, disc, crank), _crank_turns(motion, disc, crank)
                yield from _rigid(motion, CRANKS, mass, inertia, axis, moves, turns)
        return
    for solid in masses.of(CRANKS):
        disc, crank = solid.disc, solid.crank
        if disc < 0:
            yield from _shaft(motion, solid)
            continue
        centre = complex(masses.places[disc].races(np.array([angle])).centre[0, crank])
        moves, turns = _eccentric_moves(motion, masses, disc, crank, angle), _crank_turns(motion, disc, crank)
        yield from _rigid(motion, CRANKS, solid.mass, solid.about_own_axis, centre, moves, turns)


def _shaft(motion: Motion, solid: Solid) -> Iterator[Body]:
    """A piece of a shaft beside its eccentrics, which bends with them while its bearings stand."""
    drive, support = motion.drive, motion.drive.crank.support
    assert support is not None
    planes, modulus = drive.disc.disc_planes, drive.materials.crankshaft.youngs_modulus
    turns, parts = motion.unit(motion.crank), solid.weights / solid.weights.sum()
    for height, part in zip(solid.heights.tolist(), parts.tolist(), strict=True):
        bends = shaft_flexibility([*planes, height], support.positions, crank_springs(drive), support.diameter, modulus)
        shape = np.linalg.solve(bends[:-1, :-1], bends[:-1, -1])
        moves = sum(by * _crank_moves(motion, disc, solid.crank) for disc, by in enumerate(shape.tolist()))
        yield from _rigid(
            motion, CRANKS, part * solid.mass, part * solid.about_own_axis, solid.place, np.asarray(moves), turns
        )


def _members(motion: Motion, masses: DriveMasses) -> Iterator[Body]:
    """The parts that are rigid with the wheel, and with the pin shaft."""
    axis, still = complex(masses.places[0].wheel_axis), np.zeros(motion.size)
    for name, groups, moves, turns in (
        (WHEEL, OF_WHEEL, motion.wheel_moves, motion.wheel_turns),
        (CARRIER, OF_SHAFT, still, still),
    ):
        solids = [each for group in groups for each in masses.of(group)]
        if mass := sum(solid.mass for solid in solids):
            centre = sum(solid.mass * solid.place for solid in solids) / mass
            inertia = sum(solid.about(centre) for solid in solids)
            yield from _rigid(motion, name, mass, inertia, centre, moves + 1j * (centre - axis) * turns, turns)


def _given(motion: Motion) -> Iterator[Body]:
    """The inertias in front of the drive and behind it."""
    given = motion.drive.inertia
    if given is None:
        return
    for name, inertia, turns in ((INPUT, given.input, motion.input_turns), (OUTPUT, given.output, motion.output_turns)):
        yield Body(name=name, turns=True, size=INERTIA * (inertia or 0.0), row=turns.astype(complex))
    yield Body(name=OUTPUT, turns=False, size=TONNE_PER_KG * (given.output_mass or 0.0), row=motion.output_moves)
