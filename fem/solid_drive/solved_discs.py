"""The way to a solution of solid bodies: plane solution, meshes graded for it, solid bodies, checked.

1. The drive as it is at mid-width is solved in plane strain on coarse meshes: its loads size the contacts.
2. Sections graded for them are extruded and condensed, and the poses are iterated on them, as in the plane
   (`fem.drive.solution.Task`).
3. A solution is accepted when no pressure reaches the end of its zone and no contact without a zone has closed; otherwise
   meshes are graded anew for the loads found, by the height where each contact carries most.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fem.drive.condensed import PRESSURE_REACH
from fem.drive.contact_results import ContactResults, deformed_contacts, summarise_contacts
from fem.drive.expected_contacts import ExpectedContacts
from fem.drive.full_solution import FullSolution
from fem.drive.grading import find_shortcoming, grade_contacts
from fem.drive.meshes import ELEMENTS_PER_HALF_WIDTH, DriveMeshes, coarse_edge, disc_refinements, mesh_drive
from fem.drive.model import DrivePose, PlacedContacts, RoundGroup
from fem.drive.pose import POSE_TOLERANCE, PoseSolution, WheelLoad
from fem.drive.solution import COARSE_SIZE, PlaneDisc, Stopwatch, Task, plane_discs, solve_plane_discs
from fem.drive.supports import Supports
from fem.mesh.memory_need import require_memory, solid_memory
from fem.mesh.triangulation import estimate_unknowns
from fem.options import SolutionOptions
from fem.shapes import DriveShapes
from fem.solid_drive.along_width import DriveWidths
from fem.solid_drive.solid_bodies import condense_solids
from fem.solid_drive.solid_model import SolidModel
from fem.solid_drive.width_results import along_width
from ltca.arrays import FloatArray
from ltca.drive.engine_support import require
from ltca.drive.parts import Drive
from ltca.geometry.placement import Placement

DEFAULT_SIZE = 3.0
"""Element edge as a multiple of an eighth of the half-width, where none is given: solids of a size of 1 fit into few machines."""
DEFAULT_LAYERS = 4
SOLID_OPTIONS = SolutionOptions(size=DEFAULT_SIZE, layers=DEFAULT_LAYERS)
GROWTH = 0.6
"""Growth of the edge away from contacts: the far field is smooth, and every node of a section costs a column of unknowns."""
SMALLEST_SHARE = 0.25
"""Contacts under this share of the largest load of their kind get elements as if they carried it."""
COMPLIANCES = 4.0
"""Matrices of all pressures by all that are in memory together: of the bodies, of the discs, of the drive, its carrying part."""
MARGIN = 0.1
"""Open contacts within this part of the largest approach are candidates; three times as much each time meshes are graded anew."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SolidDisc(PlaneDisc):
    """One disc with its pins and rollers as solid bodies."""

    widths: DriveWidths

    def graded(self, model: PlacedContacts, solution: PoseSolution, grading: int) -> ExpectedContacts:
        """Return the contacts of a solution, plane or solid, on other meshes."""
        pose = solution.pose
        return grade_contacts(
            self.drive,
            self.rigid.moved(*pose.displacements),
            pose.disc_displacement,
            pose.disc_rotation,
            pose.wheel_angle,
            largest_loads(model, solution),
            margin=self.margin(pose) * 3.0 ** (grading - 1),
            smallest_share=SMALLEST_SHARE,
            deformed=deformed_contacts(model, solution),
        )

    def margin(self, pose: DrivePose) -> float:
        """Return the gap up to which an open contact is a candidate, mm: part of the overlap, and what inclinations close."""
        gaps = self.rigid.moved(*pose.displacements).gaps(pose.disc_displacement, pose.disc_rotation, pose.wheel_angle)
        overlap = -float(np.concatenate([gaps.pins, gaps.rollers, gaps.holes]).min())
        place: Placement = self.rigid.placement
        leans = np.concatenate([place.wheel_pin_leans, place.hole_leans, place.shaft_pin_leans])
        apart = (
            float(np.max(np.abs(leans), initial=0.0)) + abs(complex(place.wheel_lean)) + abs(complex(place.crank_lean))
        )
        return MARGIN * overlap + 0.5 * self.drive.disc.thickness * (apart + abs(self.drive.disc.lead_slope))

    def fine(self, options: SolutionOptions) -> SolutionOptions:
        """Return the options of the sections."""
        return replace(options, growth=GROWTH)

    def mesh(self, contacts: ExpectedContacts, options: SolutionOptions, rounds: tuple[RoundGroup, ...]) -> DriveMeshes:
        """Return meshes of the sections; MemoryLimitError where the disc would not fit beside what is there already."""
        require_solid_memory([(self.shapes, contacts, self.widths)], options)
        return mesh_drive(self.shapes, contacts, options)

    def condense(
        self,
        contacts: ExpectedContacts,
        meshes: DriveMeshes,
        options: SolutionOptions,
        rounds: tuple[RoundGroup, ...],
        say: Callable[[str], None],
    ) -> PlacedContacts:
        """Return the condensed bodies on meshes of their sections."""
        return condense_solids(self.drive, self.shapes, contacts, meshes, self.widths, say)

    def shortcoming(
        self, model: PlacedContacts, solution: PoseSolution, results: ContactResults, options: SolutionOptions
    ) -> str:
        """Return why the meshes do not serve a solution, "" when they do; elements may be of any size."""
        return find_shortcoming(model, solution, results)


def solve_solid_discs(
    drive: Drive,
    crank_angle: float,
    load: WheelLoad,
    options: SolutionOptions = SOLID_OPTIONS,
    *,
    pose_tolerance: float = POSE_TOLERANCE,
    progress: Callable[[str], None] | None = None,
) -> tuple[FullSolution, ...]:
    """Solve all discs with wheel, cranks and pin shaft as solid bodies; arguments as for `fem.drive.solution.solve_discs`.

    DriveError for what solid bodies refuse (`ltca.drive.engine_support`), MemoryLimitError before anything is meshed.
    """
    require(drive, "solid disc")
    plane, watch, say = plane_discs(drive, crank_angle, load), Stopwatch(), progress or (lambda _: None)
    discs = [
        SolidDisc(
            drive=each.drive,
            rigid=each.rigid,
            shapes=each.shapes,
            guess=each.guess,
            approach=each.approach,
            widths=DriveWidths(drive=each.drive, layers=options.layers),
        )
        for each in plane
    ]
    require_solid_memory([(disc.shapes, disc.guess, disc.widths) for disc in discs], options)
    say("plane solution")
    coarse = SolutionOptions(size=max(COARSE_SIZE, options.size))
    start = solve_plane_discs(drive, plane, WheelLoad(moment=load.moment), coarse, watch, progress=say)
    task = Task(
        discs=discs,
        supports=Supports.of_drive(drive),
        load=load,
        options=options,
        pose_tolerance=pose_tolerance,
        say=say,
        watch=watch,
    )
    return task.solve_graded([each.model for each in start], [each.state for each in start])


def require_solid_memory(
    discs: Sequence[tuple[DriveShapes, ExpectedContacts, DriveWidths]], options: SolutionOptions
) -> None:
    """Raise MemoryLimitError when discs would not fit into memory as solids.

    One class of one disc has its factor at a time; compliances of all discs stay, and are put together.
    """
    unknowns, factor, pressures = 0, 0.0, 0.0
    for shapes, contacts, widths in discs:
        spots, edge = disc_refinements(contacts, options.size), coarse_edge(shapes.disc, options.size)
        nodes = estimate_unknowns(shapes.disc, spots, coarse_size=edge, growth=GROWTH) // 2
        for layers in widths.layers_of("disc"):
            per_node = layers.unknowns_per_node
            unknowns, factor = unknowns + nodes * per_node, max(factor, solid_memory(nodes, per_node))
        groups = (contacts.pins, contacts.holes, contacts.rollers_outer, contacts.rollers_inner)
        for kind, group in zip(("pin", "hole", "roller_outer", "roller_inner"), groups, strict=True):
            arc = 2.0 * PRESSURE_REACH * ELEMENTS_PER_HALF_WIDTH / options.size
            pressures += arc * widths.grid(kind).size * np.count_nonzero(group.half_width)
    what = "the disc as a solid body" if len(discs) == 1 else f"{len(discs)} discs as solid bodies"
    require_memory(unknowns, factor + COMPLIANCES * 8.0 * pressures**2, what)


def largest_loads(model: PlacedContacts, solution: PoseSolution) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the loads of pins, rollers and holes, N: if all of their width carried as the height that carries most."""
    results = summarise_contacts(model, solution)
    found = {"pin": results.pin_load, "roller_outer": results.roller_load, "hole": results.pin_shaft_load}
    if isinstance(model, SolidModel):
        for pair, own in zip(model.pairs, along_width(model, solution), strict=True):
            if pair.kind in found:
                found[pair.kind][pair.index] = float(own.line_load.max()) * model.widths.length_of(pair.kind)
    return found["pin"], found["roller_outer"], found["hole"]
