r"""Kinetic energy of a drive over the coordinates of its reducer, and what it comes to at input and output.

Velocities are those in the frame of the held member. In the frame of the pin shaft stand discs, cranks and wheel
(`ltca.geometry.coordinates`); the crank angle :math:`\varphi_C` is a coordinate as well, the sun where teeth of a first stage
yield, and the twist of the carrier where it has one. The frame itself turns by the twist where the pin shaft is held, and by
:math:`-(\varphi_C/u + w)` where the wheel is held, whose displacements and angle w are those relative to the shaft. Each body
brings a row of its velocity z and one of its rotation, and the mass matrix is

.. math:: M = \sum m\, \mathrm{Re}(z^H z) + \sum J\, r^T r .

Rollers move by the mean of race and bore; their cage turns by `cage_speed`, they roll on the bore. Pins, sleeves, ring and posts
are rigid with wheel and shaft, shafts of cranks bend as their stiffness lets them. Where contacts
have slices discs lean, with their transverse moments of inertia; leans of cranks and wheel have none and follow as springs do.
Frozen at a crank angle: accelerations by the square of the speed (centrifugal and Coriolis terms) are no part of it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

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
from ltca.equilibrium.supports import crank_springs
from ltca.errors import DriveError
from ltca.geometry.coordinates import DISC_ROTATION, WHEEL_ANGLE, Coordinates, X, Y

OF_WHEEL = (WHEEL_PINS, SLEEVES[WHEEL_PINS], RING)
OF_SHAFT = (SHAFT_PINS, SLEEVES[SHAFT_PINS], POSTS)
INPUT, OUTPUT, CARRIER, WHEEL = "input", "output", "carrier and shaft pins", "wheel pins"
"""Bodies beside discs, rollers and cranks, as modes name them."""
PLACES = 4
"""Crank angles over which the inertia of rigid parts is averaged: uneven holes make it vary by once and twice a turn."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Motion:
    """Coordinates of a vibrating drive: those of the pose, then the crank angle, the sun, the twist of the carrier.

    Attributes
    ----------
    drive : Drive
        Warm.
    pose : Coordinates
        Of the pose.
    mesh : StageMesh or None
        Teeth of the first stage.
    mesh_compliance : float
        Rotation of the cranks against the sun by the moment of all of them, rad/(N·mm); 0 where it is rigid.
    mesh_by_pose : array, shape (pose,)
        The same rotation by the coordinates of the pose, rad by mm or rad.
    """

    drive: Drive
    pose: Coordinates
    mesh: StageMesh | None
    mesh_compliance: float
    mesh_by_pose: FloatArray

    @classmethod
    def of_drive(cls, drive: Drive) -> Motion:
        """Return the coordinates of a warm drive; with contacts in slices leans of its parts are among them."""
        pose, mesh = Coordinates.of_drive(drive), StageMesh.of_drive(drive)
        compliance, by_pose = 0.0, np.zeros(pose.size)
        if mesh is not None:
            # The load drives the cranks against the teeth in this sense.
            compliance, by_pose = mesh.together(float(drive.driving_sign))
        return cls(drive=drive, pose=pose, mesh=mesh, mesh_compliance=compliance, mesh_by_pose=by_pose)

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
        carrier = self.drive.carrier
        if carrier is None or carrier.stiffness_torsion is None:
            return None
        return self.pose.size + 1 + bool(self.mesh_compliance)

    @property
    def springs(self) -> FloatArray:
        """Stiffness of the carrier against its twist, shape (n, n)."""
        found, carrier = np.zeros((self.size, self.size)), self.drive.carrier
        if self.twist is not None and carrier is not None:
            found[self.twist, self.twist] = carrier.stiffness_torsion or 0.0
        return found

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return self.pose.size + 1 + bool(self.mesh_compliance) + (self.twist is not None)

    @property
    def light_leans(self) -> NDArray[np.intp]:
        """Places of the leans of cranks at the discs and of the wheel, which have no mass."""
        pose = self.pose
        first = pose.own - 2 * (pose.cranks + 1) * pose.leans
        each = (pose.own * np.arange(pose.discs)[:, None] + np.arange(first, pose.lean_place.start)).ravel()
        wheel = np.arange(*pose.wheel_lean_place.indices(pose.size))
        return np.concatenate((each, wheel)).astype(np.intp)

    def unit(self, place: int | None) -> FloatArray:
        """Return the row of one coordinate; zeros of none."""
        row = np.zeros(self.size)
        if place is not None:
            row[place] = 1.0
        return row

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
        row = np.zeros(self.size, dtype=complex)
        if self.pose.wheel:
            row[self.pose.wheel_place] = 1.0, 1j
        return row

    @property
    def frame_moves(self) -> ComplexArray:
        """Row of the displacement of the pin shaft."""
        return -self.wheel_moves if self.drive.wheel_is_held else np.zeros(self.size, dtype=complex)

    @property
    def input_turns(self) -> FloatArray:
        """Row of the rotation of the input."""
        stage = self.drive.first_stage_ratio
        if stage is None:
            return self.frame_turns + self.unit(self.crank)
        sun = self.unit(self.crank if self.sun is None else self.sun)
        if self.sun is None:
            sun[: self.pose.size] += self.mesh_by_pose
        return self.frame_turns - stage * sun

    @property
    def output_turns(self) -> FloatArray:
        """Row of the rotation of the output."""
        if self.drive.wheel_is_held:
            return self.frame_turns + self.unit(self.twist)
        return self.frame_turns + self.wheel_turns

    @property
    def output_moves(self) -> ComplexArray:
        """Row of the displacement of the output, x + iy."""
        return self.frame_moves + (0.0 if self.drive.wheel_is_held else self.wheel_moves)

    def turned(self, crank_angle: FloatArray) -> FloatArray:
        """Return the matrices that take coordinates in the frame that turns with the crank to those at rest, shape
        (positions, n, n).

        Parameters
        ----------
        crank_angle : array, shape (positions,)
            φ_C, rad.
        """
        found = np.tile(np.eye(self.size), (crank_angle.size, 1, 1))
        cosine, sine = np.cos(crank_angle), np.sin(crank_angle)
        for x in self.pose.displacements:
            found[:, x, x] = found[:, x + 1, x + 1] = cosine
            found[:, x, x + 1], found[:, x + 1, x] = -sine, sine
        return found

    @property
    def spin(self) -> FloatArray:
        """Derivative of `turned` by the crank angle, in the frame that turns, shape (n, n)."""
        found = np.zeros((self.size, self.size))
        for x in self.pose.displacements:
            found[x, x + 1], found[x + 1, x] = -1.0, 1.0
        return found

    @property
    def rigid(self) -> FloatArray:
        """Motion of all parts as rigid ones while the crank turns by 1 rad."""
        return self.unit(self.crank) + self.unit(self.sun)


@dataclass(frozen=True, slots=True, kw_only=True)
class Body:
    """A mass, or a moment of inertia, with the row of its velocity.

    Attributes
    ----------
    name : str
        What moves, for words: ``disc 0``, ``output``, …
    turns : bool
        Whether it is a moment of inertia about z.
    size : float
        t, or t·mm².
    row : array, shape (coordinates,)
        Velocity x + iy, rotation, or one direction of a lean, by the rates of the coordinates.
    across : array, shape (coordinates,), or None
        Of a moment of inertia about a line in the plane, by the lean in one direction, what a frame that turns by 1 rad adds to
        that: the lean across. None of others.
    """

    name: str
    turns: bool
    size: float
    row: ComplexArray
    across: ComplexArray | None = None

    @property
    def leans(self) -> bool:
        """Whether it is a moment of inertia about a line in the plane."""
        return self.across is not None

    @property
    def carried(self) -> ComplexArray:
        """Velocity that a frame which turns by 1 rad adds, by the displacements of the row."""
        return 1j * self.row if self.across is None else self.across

    @property
    def matrix(self) -> FloatArray:
        """Its part of the mass matrix."""
        return np.asarray(self.size * np.outer(self.row.conjugate(), self.row).real)


def require_masses(masses: DriveMasses) -> DriveMasses:
    """Return the masses themselves; DriveError with every density that is not given."""
    missing = masses.without_density
    if missing:
        raise DriveError([f"{path}: must be given for inertias, kg/m³ (a named material has it)" for path in missing])
    return masses


def moving_bodies(motion: Motion, masses: DriveMasses, crank_angle: float) -> tuple[Body, ...]:
    """Return every body that moves, with its velocity at a crank angle; those that stand are left out.

    Parameters
    ----------
    motion : Motion
        Coordinates.
    masses : DriveMasses
        Of the same drive, every density known.
    crank_angle : float
        φ_C, rad.
    """
    require_masses(masses)
    bodies = (
        *_discs_and_rollers(motion, masses, crank_angle),
        *_cranks(motion, masses, crank_angle),
        *_members(motion, masses),
        *_given(motion),
    )
    return tuple(body for body in bodies if body.size and np.any(body.row))


def mass_matrix(bodies: Sequence[Body], size: int) -> FloatArray:
    """Return the mass matrix of bodies, t, t·mm, t·mm², shape (size, size)."""
    total = np.zeros((size, size))
    for body in bodies:
        total += body.matrix
    return total


@dataclass(frozen=True, slots=True, kw_only=True)
class ReflectedInertia:
    """Moment of inertia of all parts that move, as rigid ones, t·mm².

    Attributes
    ----------
    at_input, at_output : float
        Of the parts that the file describes and the given cranks, referred to the input and to the output.
    given_input, given_output : float
        Given inertias in front of and behind the drive, each at its own place; 0 where there is none.
    """

    at_input: float
    at_output: float
    given_input: float
    given_output: float


def reflected_inertia(drive: Drive, masses: DriveMasses | None = None) -> ReflectedInertia | None:
    """Return the inertia of a drive at its input and output, mean over a turn; None where a density is not known.

    Parameters
    ----------
    drive : Drive
        In one disc or several.
    masses : DriveMasses, optional
        Of this drive, where they are known.
    """
    masses = drive_masses(drive) if masses is None else masses
    if masses.without_density:
        return None
    motion, energies = Motion.of_drive(_plane(masses.drive)), []
    for angle in 2.0 * np.pi * np.arange(PLACES) / PLACES:
        own = [b for b in moving_bodies(motion, masses, float(angle)) if b.name not in (INPUT, OUTPUT)]
        energies.append(motion.rigid @ mass_matrix(own, motion.size) @ motion.rigid)
    given, mean = drive.inertia, float(np.mean(energies))
    return ReflectedInertia(
        at_input=mean / float(motion.input_turns @ motion.rigid) ** 2,
        at_output=mean / float(motion.output_turns @ motion.rigid) ** 2,
        given_input=INERTIA * ((given.input if given is not None else None) or 0.0),
        given_output=INERTIA * ((given.output if given is not None else None) or 0.0),
    )


def _plane(drive: Drive) -> Drive:
    """The drive without slices, which change nothing of rigid motions."""
    return drive if drive.contact.slices == 1 else replace(drive, contact=replace(drive.contact, slices=1))


def _at(motion: Motion, place: complex, row: ComplexArray) -> ComplexArray:
    """Velocity in the frame of the held member of what stands at a place and moves by a row in that of the pin shaft."""
    return np.asarray(motion.frame_moves + 1j * motion.frame_turns * place + row)


def _turning(motion: Motion, row: FloatArray) -> ComplexArray:
    return np.asarray(motion.frame_turns + row, dtype=complex)


def _discs_and_rollers(motion: Motion, masses: DriveMasses, angle: float) -> Iterator[Body]:
    bearing, pose, crank = motion.drive.crank_bearing, motion.pose, motion.unit(motion.crank)
    for number, (place, disc) in enumerate(zip(masses.places, masses.of(DISCS), strict=True)):
        own, at = pose.columns(number), np.array([angle])
        start, stands = complex(place.race_centre(np.zeros(1))[0]), complex(place.race_centre(at)[0])
        middle = disc.place - start  # from the origin of the disc, which does not turn
        moves = motion.unit(int(own[X])) + 1j * motion.unit(int(own[Y]))
        turns = motion.unit(int(own[DISC_ROTATION]))
        nominal = complex(place.race_velocity(at)[0]) * crank
        name = f"disc {number}"
        row = _at(motion, stands + middle, moves + nominal + 1j * middle * turns)
        yield Body(name=name, turns=False, size=disc.mass, row=row)
        yield Body(name=name, turns=True, size=disc.about_own_axis, row=_turning(motion, turns))
        yield from _leaning(motion, disc, number)
        rollers = sum(solid.mass for solid in masses.of(ROLLERS) if solid.disc == number)
        mass, centres = rollers / place.cranks, place.race_centres(at)[0]
        radius = float(np.mean(place.roller_radii))
        orbit, cage = bearing.inner_race_radius + radius, float(place.cage_speed)
        for bearing_number, centre in enumerate(centres.tolist()):
            carried = _eccentric_velocity(motion, masses, number, bearing_number, angle)
            bore = moves + nominal + 1j * complex(place.bore_centres[bearing_number]) * turns
            row = _at(motion, centre, 0.5 * (bore + carried))
            yield Body(name=ROLLERS, turns=False, size=mass, row=row)
            yield Body(name=ROLLERS, turns=True, size=mass * orbit**2, row=_turning(motion, cage * crank))
            spin = _turning(motion, -cage * orbit / radius * crank)
            yield Body(name=ROLLERS, turns=True, size=0.5 * mass * radius**2, row=spin)


def _leaning(motion: Motion, disc: Solid, number: int) -> Iterator[Body]:
    """Transverse moments of inertia of a disc that leans: points move by z l in the plane and −(x l_x + y l_y) along z."""
    if not motion.pose.leans:
        return
    tensor = disc.inertia
    own = motion.pose.columns(number)[motion.pose.lean_place]
    # A lean along x turns the disc about y.
    by_lean = np.array([[tensor[1, 1], -tensor[0, 1]], [-tensor[0, 1], tensor[0, 0]]])
    for size, direction in zip(*np.linalg.eigh(by_lean), strict=True):
        along, beside = motion.unit(int(own[0])), motion.unit(int(own[1]))
        row, across = (first * along + second * beside for first, second in (direction, (direction[1], -direction[0])))
        yield Body(
            name=f"disc {number}", turns=False, size=float(size), row=row.astype(complex), across=across.astype(complex)
        )


def _eccentric_velocity(motion: Motion, masses: DriveMasses, disc: int, crank: int, angle: float) -> ComplexArray:
    """Velocity of the centre of an eccentric in the frame of the pin shaft."""
    place, own = masses.places[disc], motion.pose.columns(disc)
    arm = complex((place.eccentricity * place.eccentric_directions(np.array([angle]))[0])[crank])
    row = 1j * arm * (motion.unit(motion.crank) + _twist_of(motion, disc, crank))
    if motion.pose.cranks:
        x = int(own[motion.pose.crank(crank)])
        row = row + motion.unit(x) + 1j * motion.unit(x + 1)
    return np.asarray(row)


def _twist_of(motion: Motion, disc: int, crank: int) -> FloatArray:
    """Row of the angle by which an eccentric is ahead of its crank."""
    places = motion.pose.twist_places
    return motion.unit(int(motion.pose.columns(disc)[places[crank]]) if places else None)


def _cranks(motion: Motion, masses: DriveMasses, angle: float) -> Iterator[Body]:
    """Eccentrics and shafts; where mass or inertia of a crank is given, that, by equal parts at the discs."""
    drive, given, discs = motion.drive, motion.drive.inertia, motion.pose.discs
    number = drive.crank.number
    if given is not None and (given.crank is not None or given.crank_mass is not None):
        mass, inertia = masses.mass_of(CRANKS) / (number * discs), masses.crank_inertia / discs
        for disc, place in enumerate(masses.places):
            for crank, axis in enumerate(place.crank_axes.tolist()):
                row = np.zeros(motion.size, dtype=complex)
                if motion.pose.cranks:
                    x = int(motion.pose.columns(disc)[motion.pose.crank(crank)])
                    row = motion.unit(x) + 1j * motion.unit(x + 1)
                yield Body(name=CRANKS, turns=False, size=mass, row=_at(motion, axis, row))
                turns = motion.unit(motion.crank) + _twist_of(motion, disc, crank)
                yield Body(name=CRANKS, turns=True, size=inertia, row=_turning(motion, turns))
        return
    for solid in masses.of(CRANKS):
        disc, crank = solid.disc, solid.crank
        if disc < 0:
            yield from _shaft(motion, solid)
            continue
        centre = complex(masses.places[disc].race_centres(np.array([angle]))[0, crank])
        row = _at(motion, centre, _eccentric_velocity(motion, masses, disc, crank, angle))
        yield Body(name=CRANKS, turns=False, size=solid.mass, row=row)
        turns = motion.unit(motion.crank) + _twist_of(motion, disc, crank)
        yield Body(name=CRANKS, turns=True, size=solid.about_own_axis, row=_turning(motion, turns))


def _shaft(motion: Motion, solid: Solid) -> Iterator[Body]:
    """A piece of a shaft beside its eccentrics, which bends with them."""
    for height, weight in zip(solid.heights.tolist(), solid.weights.tolist(), strict=True):
        mass = solid.mass * weight / float(solid.weights.sum())
        yield Body(
            name=CRANKS, turns=False, size=mass, row=_at(motion, solid.place, _bent(motion, solid.crank, height))
        )
    turns = _turning(motion, motion.unit(motion.crank))
    yield Body(name=CRANKS, turns=True, size=solid.about_own_axis, row=turns)


def _bent(motion: Motion, crank: int, height: float) -> ComplexArray:
    """Displacement of a shaft at a height by those at the discs, its bearings where they stand."""
    drive, row = motion.drive, np.zeros(motion.size, dtype=complex)
    support = drive.crank.support
    if support is None:
        return row
    planes, modulus = drive.disc.disc_planes, drive.materials.crankshaft.youngs_modulus
    springs = crank_springs(drive)
    whole = shaft_flexibility([*planes, height], support.positions, springs, support.diameter, modulus, ())
    shape = np.linalg.solve(whole[:-1, :-1], whole[:-1, -1])
    for disc, part in enumerate(np.atleast_1d(shape).tolist()):
        x = int(motion.pose.columns(disc)[motion.pose.crank(crank)])
        row[x], row[x + 1] = part, 1j * part
    return row


def _members(motion: Motion, masses: DriveMasses) -> Iterator[Body]:
    """What is rigid with the wheel, and what with the pin shaft."""
    axis = complex(masses.places[0].wheel_axis)
    mass, centre, inertia = _together([each for group in OF_WHEEL for each in masses.of(group)])
    row = motion.wheel_moves + 1j * (centre - axis) * motion.wheel_turns
    yield Body(name=WHEEL, turns=False, size=mass, row=_at(motion, centre, row))
    yield Body(name=WHEEL, turns=True, size=inertia, row=_turning(motion, motion.wheel_turns))
    mass, centre, inertia = _together([each for group in OF_SHAFT for each in masses.of(group)])
    nothing = np.zeros(motion.size)
    yield Body(name=CARRIER, turns=False, size=mass, row=_at(motion, centre, nothing.astype(complex)))
    yield Body(name=CARRIER, turns=True, size=inertia, row=_turning(motion, nothing))


def _together(solids: Sequence[Solid]) -> tuple[float, complex, float]:
    """Mass, t, centre of mass, mm, and moment of inertia about it, t·mm², of parts that are rigid with each other."""
    mass = sum(solid.mass for solid in solids)
    if not mass:
        return 0.0, 0j, 0.0
    centre = sum(solid.mass * solid.place for solid in solids) / mass
    return mass, centre, sum(solid.about(centre) for solid in solids)


def _given(motion: Motion) -> Iterator[Body]:
    """What turns in front of the drive and behind it."""
    given = motion.drive.inertia
    if given is None:
        return
    for name, inertia, turns in (
        (INPUT, given.input, motion.input_turns),
        (OUTPUT, given.output, motion.output_turns),
    ):
        yield Body(name=name, turns=True, size=INERTIA * (inertia or 0.0), row=np.asarray(turns, dtype=complex))
    mass = TONNE_PER_KG * (given.output_mass or 0.0)
    yield Body(name=OUTPUT, turns=False, size=mass, row=motion.output_moves)
