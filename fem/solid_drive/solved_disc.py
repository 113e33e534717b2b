"""The way to a solution of solid bodies: plane solution, meshes graded for it, solid bodies, checked.

1. The drive as it is at mid-width is solved in plane strain on coarse meshes (`fem.drive.solution`): its loads size the
   contacts.
2. Sections graded for them are extruded and condensed, and the pose is iterated on them, as in the plane.
3. A solution is accepted when no pressure reaches the end of its zone and no contact without a zone has closed; otherwise
   meshes are graded anew for the loads found, by the height where each contact carries most.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fem.drive.contact_kinds import CONTACT_KINDS
from fem.drive.contact_results import ContactResults, deformed_contacts, summarise_contacts
from fem.drive.expected_contacts import ExpectedContacts, expect_contacts
from fem.drive.grading import closed_without_zone, grade_contacts
from fem.drive.meshes import coarse_edge, disc_refinements, mesh_drive
from fem.drive.model import DrivePose
from fem.drive.pose import PoseSolution, WheelLoad, solve_poses
from fem.drive.rigid_bodies import RigidBodies
from fem.drive.solution import COARSE_SIZE, solve_discs
from fem.drive.supports import Supports
from fem.mesh.memory_need import require_memory, solid_memory
from fem.mesh.triangulation import estimate_unknowns
from fem.options import SolutionOptions
from fem.shapes import DriveShapes
from fem.solid_drive.along_width import DriveWidths, plane_part
from fem.solid_drive.solid_bodies import condense_solids
from fem.solid_drive.solid_model import SolidModel
from fem.solid_drive.width_results import WidthResult, bore_lean, disc_lean, width_results
from ltca.arrays import FloatArray
from ltca.drive.engine_support import require
from ltca.drive.parts import Drive
from ltca.drive.single_discs import single_discs
from ltca.drive.unit_mistakes import names_unit_mistakes
from ltca.errors import ConvergenceError
from ltca.geometry.placement import Placement

DEFAULT_SIZE = 3.0
"""Element edge as a multiple of an eighth of the half-width, where none is given: solids of a size of 1 fit into few machines."""
DEFAULT_LAYERS = 4
GROWTH = 0.6
"""Growth of the edge away from contacts: the far field is smooth, and every node of a section costs a column of unknowns."""
SMALLEST_SHARE = 0.25
"""Contacts under this share of the largest load of their kind get elements as if they carried it."""
MARGIN = 0.1
"""Open contacts within this part of the largest approach are candidates; three times as much each time meshes are graded anew."""
MAX_GRADINGS = 4
MOMENT_TOLERANCE = 1e-6
"""Of the moment on a held wheel."""
MAX_MOMENTS = 20


@dataclass(frozen=True, slots=True, kw_only=True)
class SolidOptions:
    """Options of a solution of solid bodies.

    Attributes
    ----------
    size : float
        Element edge as a multiple of an eighth of each contact half-width.
    layers : int
        Over half of the width.
    """

    size: float = DEFAULT_SIZE
    layers: int = DEFAULT_LAYERS

    @property
    def section(self) -> SolutionOptions:
        """Those of the meshes of the cross-sections."""
        return SolutionOptions(size=self.size, growth=GROWTH)


DEFAULT_OPTIONS = SolidOptions()


@dataclass(frozen=True, slots=True, kw_only=True)
class SolidSolution:
    """Solution of a disc of solid bodies at one crank angle.

    Attributes
    ----------
    drive : Drive
        As given.
    torque : float
        Output torque, N·mm.
    model : SolidModel
        Condensed bodies, meshes, candidate pairs.
    state : PoseSolution
        Pressures at the loaded pose.
    contacts : ContactResults
        Loads of all parts, pressures and half-widths at mid-width, forces on the disc.
    along_width : tuple of WidthResult
        What every candidate pair has along its width.
    options : SolidOptions
        How it was solved.
    seconds : dict of str to float
        Wall time of each stage; ``total`` is their sum.
    """

    drive: Drive
    torque: float
    model: SolidModel
    state: PoseSolution
    contacts: ContactResults
    along_width: tuple[WidthResult, ...]
    options: SolidOptions
    seconds: dict[str, float]

    @property
    def pose(self) -> DrivePose:
        """Loaded pose."""
        return self.state.pose

    @property
    def disc_lean(self) -> complex:
        """Lean of the disc as its volume mean, dx/dz + i dy/dz in the fixed frame, rad."""
        return disc_lean(self.model, self.state)

    @property
    def bore_lean(self) -> complex:
        """Lean of the disc fitted to the wall of its bore, rad."""
        return bore_lean(self.model, self.state)

    @property
    def bearing_couple(self) -> complex:
        """∫ z dF of the rollers on the disc, N·mm: with i its moment about x and y is −imaginary and real part."""
        model, pressure = self.model, self.state.contact.pressure
        return -sum(
            (
                model.couple_of(pair, integral, pressure)
                for pair, integral in zip(model.pairs, self.state.integrals, strict=True)
                if pair.kind == "roller_outer"
            ),
            0j,
        )

    @property
    def strain_energy(self) -> float:
        """Of all bodies, and of the springs of shaft pins, N·mm."""
        return self.model.strain_energy(self.pose, self.state.integrals, self.state.contact.pressure)

    @property
    def transmission_error(self) -> float:
        """Deviation of the output, ccw positive, rad."""
        return self.drive.output_per_wheel_angle * self.pose.wheel_angle

    @property
    def bearing_components(self) -> tuple[float, float]:
        """Bearing force on the disc along its eccentricity and 90° ahead of it, N."""
        direction = self.model.placement.eccentric_directions(np.asarray(self.model.crank_angle))[0]
        along = complex(self.contacts.bearing_force[0] * np.conj(direction))
        return along.real, along.imag


@names_unit_mistakes
def solve_solid_disc(
    drive: Drive,
    crank_angle: float,
    options: SolidOptions = DEFAULT_OPTIONS,
    *,
    torque: float | None = None,
    progress: Callable[[str], None] | None = None,
) -> SolidSolution:
    """Solve a drive of one disc and one crank as solid bodies at one crank angle.

    Parameters
    ----------
    drive : Drive
        The drive in one case.
    crank_angle : float
        φ_C, rad.
    options : SolidOptions
        Element size and layers.
    torque : float, optional
        Output torque, N·mm; the drive's own by default.
    progress : callable, optional
        Called with one line for each step.

    Returns
    -------
    SolidSolution
        Accepted solution.

    Raises
    ------
    ConvergenceError
        When nothing can carry the load or an iteration does not settle.
    DriveError
        For what a disc of solid bodies refuses (`ltca.drive.engine_support`).
    MemoryLimitError
        When it would not fit into memory; known before any solid is condensed.
    """
    require(drive, "solid disc")
    drive.require_torque("full finite elements, whose loads follow those of the torque", torque)
    (single,) = single_discs(drive)
    widths = DriveWidths(drive=single, layers=options.layers)
    say, seconds, last = progress or (lambda _: None), dict[str, float](), time.perf_counter()

    def lap(stage: str) -> None:
        nonlocal last
        now = time.perf_counter()
        seconds[stage], last = seconds.get(stage, 0.0) + now - last, now

    plane = plane_part(single)
    shapes, rigid = DriveShapes.of_drive(plane), RigidBodies.of_drive(single, crank_angle)
    guess = expect_contacts(plane, crank_angle, wheel_moment=plane.wheel_moment(torque))
    require_solid_memory(shapes, guess, options, widths)
    say("plane solution")
    (start,) = solve_discs(
        plane,
        crank_angle,
        WheelLoad(moment=plane.wheel_moment(torque)),
        SolutionOptions(size=max(COARSE_SIZE, options.size)),
        progress=say,
    )
    results = start.contacts
    loads = (results.pin_load, results.roller_load, results.pin_shaft_load)
    pose, moment = start.pose, start.state.wheel_moment
    deformed = deformed_contacts(start.model, start.state)
    lap("plane solution")
    for grading in range(1, MAX_GRADINGS + 1):
        contacts = grade_contacts(
            single,
            rigid,
            pose.disc_displacement,
            pose.disc_rotation,
            pose.wheel_angle,
            loads,
            margin=_margin(rigid, pose, widths) * 3.0 ** (grading - 1),
            smallest_share=SMALLEST_SHARE,
            deformed=deformed,
        )
        require_solid_memory(shapes, contacts, options, widths)
        say("meshes")
        meshes = mesh_drive(shapes, contacts, options.section)
        lap("mesh")
        model = condense_solids(single, shapes, contacts, meshes, widths, say)
        lap("assembly and factorisation")
        (state,) = solve_poses(
            (model,), Supports.of_drive(single), WheelLoad.of_drive(drive, torque, moment), (pose,), progress=say
        )
        lap("contact and pose")
        along = width_results(model, state)
        if not (complaint := _shortcoming(model, state)):
            return SolidSolution(
                drive=drive,
                torque=drive.load.torque if torque is None else torque,
                model=model,
                state=state,
                contacts=summarise_contacts(model, state),
                along_width=along,
                options=options,
                seconds=seconds | {"total": sum(seconds.values())},
            )
        say(f"meshes graded anew ({grading}): {complaint}")
        loads, deformed = _largest_loads(model, along), deformed_contacts(model, state)
        pose, moment = state.pose, state.wheel_moment
    raise ConvergenceError(f"meshes do not fit the contacts after {MAX_GRADINGS} gradings: {complaint}")


def require_solid_memory(
    shapes: DriveShapes, contacts: ExpectedContacts, options: SolidOptions, widths: DriveWidths
) -> None:
    """Raise MemoryLimitError when a disc would not fit into memory as a solid: its factors are kept, others are smaller."""
    spots = disc_refinements(contacts, options.size)
    edge = coarse_edge(shapes.disc, options.size)
    nodes = estimate_unknowns(shapes.disc, spots, coarse_size=edge, growth=GROWTH) // 2
    unknowns, needed = 0, 0.0
    for layers in widths.layers_of("disc"):
        per_node = layers.unknowns_per_node
        unknowns, needed = unknowns + nodes * per_node, needed + solid_memory(nodes, per_node)
    require_memory(unknowns, needed, "the disc as a solid body")


def _margin(rigid: RigidBodies, pose: DrivePose, widths: DriveWidths) -> float:
    """Gap up to which an open contact is a candidate, mm: part of the largest overlap, and what inclinations close."""
    gaps = rigid.gaps(pose.disc_displacement, pose.disc_rotation, pose.wheel_angle)
    overlap = -float(np.concatenate([gaps.pins, gaps.rollers, gaps.holes]).min())
    place: Placement = rigid.placement
    leans = np.concatenate([place.wheel_pin_leans, place.hole_leans, place.shaft_pin_leans])
    apart = float(np.max(np.abs(leans), initial=0.0)) + abs(complex(place.wheel_lean)) + abs(complex(place.crank_lean))
    slope = abs(widths.drive.disc.lead_slope)
    return MARGIN * overlap + 0.5 * widths.drive.disc.thickness * (apart + slope)


def _shortcoming(model: SolidModel, state: PoseSolution) -> str:
    """Return why the meshes do not serve a solution, "" when they do."""
    for pair in model.pairs:
        own = model.pressures_of(pair, state.contact.pressure)
        if np.any(own[[0, -1]] > 0.0):
            name = CONTACT_KINDS[pair.kind].name_of(pair.index, model.placement)
            return f"the pressure of {name} reaches the end of its zone"
    return closed_without_zone(model, state)


def _largest_loads(model: SolidModel, along: tuple[WidthResult, ...]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Loads that pins, rollers and holes would carry if all of their width carried as the height that carries most, N."""
    place = model.placement
    found = {
        "pin": np.zeros(place.wheel_pin_radii.size),
        "roller_outer": np.zeros(place.roller_radii.size),
        "hole": np.zeros(place.hole_radii.size),
    }
    for pair, own in zip(model.pairs, along, strict=True):
        if pair.kind in found:
            found[pair.kind][pair.index] = float(own.line_load.max()) * model.widths.length_of(pair.kind)
    return found["pin"], found["roller_outer"], found["hole"]
