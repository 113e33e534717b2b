"""Meshes of all bodies of a drive, graded for the contacts expected at a crank angle."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fem.drive.expected_contacts import ContactGroup, ExpectedContacts
from fem.mesh.body_mesh import BodyMesh
from fem.mesh.element_size import DEFAULT_GROWTH, Refinement
from fem.mesh.memory_need import require_memory, solution_memory
from fem.mesh.triangulation import default_coarse_size, estimate_unknowns, mesh_circle, mesh_disc, mesh_ring
from fem.mesh.uniform_refinement import refine_uniformly
from fem.options import DEFAULT_OPTIONS, SolutionOptions
from fem.shapes import CircleShape, DiscShape, DriveShapes, Shape
from ltca.arrays import ComplexArray, FloatArray

ELEMENTS_PER_HALF_WIDTH = 8.0
# The pressure ends at one half-width; the rest is for contacts that lie a little beside the place expected
# (`fem.drive.grading.SHIFT_TOLERANCE`).
ZONE_HALF_WIDTHS = 1.5
# Fine walls: elements along bore and holes for the narrowest wall of the disc, and of a root's radius of curvature. On the
# paper's disc the nodal stress along all walls is then within 0.8 % of the largest of that on finer meshes, and off by up
# to 3.4 % without them, for a tenth more unknowns.
WALL_ELEMENTS, ROOT_ELEMENTS = 6.0, 8.0
# Pins (or rollers) whose half-widths lie within this ratio share one mesh, turned.
CLASS_RATIO = np.sqrt(2.0)
# Ratios of the half-widths at the two ends of a roller are rounded down to this part, which costs 2 % of the edge at most.
RATIO_STEPS = 64.0


@dataclass(frozen=True, slots=True, kw_only=True)
class RoundEnd:
    """Small elements of a pin or roller at one of its contacts.

    Attributes
    ----------
    edge : float
        Element edge, mm.
    half_width : float
        Largest half-width that they serve, mm; 0 where there is no contact.
    """

    edge: float
    half_width: float


@dataclass(frozen=True, slots=True, kw_only=True)
class RoundGrading:
    """Everything that determines the mesh of a pin or roller: equal gradings have equal meshes, to the last bit.

    Attributes
    ----------
    radius, core_radius : float
        As in `fem.shapes.CircleShape`, mm.
    ends : tuple of RoundEnd
        First contact at polar angle 0, second opposite.
    coarse_size : float
        Element edge far from them, mm.
    order : int
        1 or 2.
    growth : float
        Growth of the edge by distance from a contact.
    halvings : int
        Uniform refinements of the mesh so graded.
    """

    radius: float
    core_radius: float
    ends: tuple[RoundEnd, ...]
    coarse_size: float
    order: int = 2
    growth: float = DEFAULT_GROWTH
    halvings: int = 0

    @property
    def touches(self) -> bool:
        """Whether a contact is expected at either end."""
        return any(end.half_width > 0.0 for end in self.ends)

    @property
    def refinements(self) -> tuple[Refinement, ...]:
        """Small elements at the contacts."""
        return tuple(
            Refinement.polar(self.radius, angle, size=end.edge, radius=ZONE_HALF_WIDTHS * end.half_width)
            for angle, end in zip((0.0, np.pi), self.ends, strict=False)
            if end.half_width > 0.0
        )

    def mesh(self, name: str) -> BodyMesh:
        """Return the mesh under the name of a body."""
        shape = CircleShape(name=name, radius=self.radius, core_radius=self.core_radius)
        body = mesh_circle(shape, self.refinements, coarse_size=self.coarse_size, growth=self.growth, order=self.order)
        for _ in range(self.halvings):
            body = refine_uniformly(body, shape.curves)
        return body


@dataclass(frozen=True, slots=True, kw_only=True)
class RoundMesh:
    """Mesh of a pin or roller with its first contact at polar angle 0, and its rotation in the drive.

    Attributes
    ----------
    grading : RoundGrading
        By which it was meshed.
    body : BodyMesh
        Before the rotation; may be shared by several bodies.
    turn : float
        Polar angle of the first contact in fixed axes, rad.
    """

    grading: RoundGrading
    body: BodyMesh
    turn: float

    def placed(self, name: str) -> BodyMesh:
        """Return the mesh turned to its contact, axes as the fixed ones."""
        return self.body.turned(self.turn, name)

    def refined(self, known: dict[RoundGrading, BodyMesh]) -> RoundMesh:
        """Return the mesh refined uniformly, from those `known` or added to them; a body without contact keeps its own."""
        if not self.grading.touches:
            return self
        grading = replace(self.grading, halvings=self.grading.halvings + 1)
        if grading not in known:
            shape = CircleShape(name=self.body.name, radius=grading.radius, core_radius=grading.core_radius)
            known[grading] = refine_uniformly(self.body, shape.curves)
        return replace(self, grading=grading, body=known[grading])


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveMeshes:
    """Meshes of all bodies of a drive, each in its own frame, axes of pins, rollers and races as the fixed ones.

    Attributes
    ----------
    disc, inner_race : BodyMesh
        One each: the race serves every crank, fine where any of them presses on it.
    wheel_pins, rollers, shaft_pins : tuple of BodyMesh
        In the order of their numbers; rigid shaft pins have none.
    unturned_pins, unturned_rollers, unturned_shaft_pins : tuple of RoundMesh
        Of the same bodies: those of one grading share a mesh.
    """

    disc: BodyMesh
    wheel_pins: tuple[BodyMesh, ...]
    rollers: tuple[BodyMesh, ...]
    shaft_pins: tuple[BodyMesh, ...]
    inner_race: BodyMesh
    unturned_pins: tuple[RoundMesh, ...]
    unturned_rollers: tuple[RoundMesh, ...]
    unturned_shaft_pins: tuple[RoundMesh, ...]

    @property
    def bodies(self) -> tuple[BodyMesh, ...]:
        """All meshes: disc, pins, rollers, elastic shaft pins, race."""
        return (self.disc, *self.wheel_pins, *self.rollers, *self.shaft_pins, self.inner_race)

    @property
    def unknowns(self) -> int:
        """Displacement unknowns of all bodies."""
        return sum(body.unknowns for body in self.bodies)

    @property
    def factorised_unknowns(self) -> int:
        """Displacement unknowns of the meshes that are factorised: of pins and rollers those with contacts, equal ones once."""
        rounds = (*self.unturned_pins, *self.unturned_rollers, *self.unturned_shaft_pins)
        distinct = {mesh.grading: mesh.body.unknowns for mesh in rounds if mesh.grading.touches}
        return self.disc.unknowns + self.inner_race.unknowns + sum(distinct.values())

    def refined(self, shapes: DriveShapes, report: Callable[[BodyMesh], None] | None = None) -> DriveMeshes:
        """Return the meshes with every triangle divided into four; `report` is called with each as soon as it is made."""
        known: dict[RoundGrading, BodyMesh] = {}
        unturned = [
            tuple(mesh.refined(known) for mesh in meshes)
            for meshes in (self.unturned_pins, self.unturned_rollers, self.unturned_shaft_pins)
        ]

        def announce(body: BodyMesh) -> BodyMesh:
            if report is not None:
                report(body)
            return body

        def placed(meshes: tuple[RoundMesh, ...], bodies: tuple[BodyMesh, ...]) -> tuple[BodyMesh, ...]:
            return tuple(announce(mesh.placed(body.name)) for mesh, body in zip(meshes, bodies, strict=True))

        return DriveMeshes(
            disc=announce(refine_uniformly(self.disc, shapes.disc.curves)),
            wheel_pins=placed(unturned[0], self.wheel_pins),
            rollers=placed(unturned[1], self.rollers),
            shaft_pins=placed(unturned[2], self.shaft_pins),
            inner_race=announce(refine_uniformly(self.inner_race, shapes.inner_race.curves)),
            unturned_pins=unturned[0],
            unturned_rollers=unturned[1],
            unturned_shaft_pins=unturned[2],
        )


def _spots(points: ComplexArray, half_width: FloatArray, size: float) -> list[Refinement]:
    return [
        Refinement(
            float(point.real), float(point.imag), size * width / ELEMENTS_PER_HALF_WIDTH, ZONE_HALF_WIDTHS * width
        )
        for point, width in zip(points, half_width.tolist(), strict=True)
        if width > 0.0
    ]


def disc_refinements(contacts: ExpectedContacts, size: float = 1.0) -> tuple[Refinement, ...]:
    """Return the refinements of the disc: elements of `size` times b/8 within 1.5 b of each contact."""
    return (
        *_spots(contacts.flank_points, contacts.pins.half_width, size),
        *_spots(contacts.bore_points, contacts.rollers_outer.half_width, size),
        *_spots(contacts.hole_points, contacts.holes.half_width, size),
    )


def wall_refinements(shape: DiscShape) -> tuple[Refinement, ...]:
    """Return the refinements of fine walls: along bores and holes, and in the lobe roots."""
    spots = []
    edge = shape.narrowest_wall / WALL_ELEMENTS
    for curve in (*shape.bores, *shape.holes):
        count = int(np.ceil(np.pi * curve.radius / edge))
        places = curve.points(2.0 * np.pi * np.arange(count) / count).tolist()
        spots += [Refinement(point.real, point.imag, edge, edge) for point in places]
    lobes = round(shape.flank.profile.reduction_ratio) - 1
    roots = 2.0 * np.pi * np.arange(lobes) / lobes
    radii = shape.flank.curvature_radius(roots)
    for point, radius in zip(shape.flank.points(roots).tolist(), radii.tolist(), strict=True):
        spots.append(Refinement(point.real, point.imag, min(radius / ROOT_ELEMENTS, edge), 0.5 * radius))
    return tuple(spots)


def race_refinements(contacts: ExpectedContacts, size: float = 1.0) -> tuple[Refinement, ...]:
    """Return the refinements of the inner race."""
    return tuple(_spots(contacts.race_points, contacts.rollers_inner.half_width, size))


def _class_of(half_width: float) -> float:
    """Return the lower end of the class of a half-width, 0 for none."""
    if half_width <= 0.0:
        return 0.0
    return float(CLASS_RATIO ** np.floor(np.log(half_width) / np.log(CLASS_RATIO)))


def _ratio_below(width: float, first: float) -> float:
    """Return the ratio of a half-width to the first of its body, rounded down so that equal bodies have equal ratios."""
    return float(np.floor(RATIO_STEPS * width / first + 1e-9) / RATIO_STEPS) if first > 0.0 else 0.0


def coarse_edge(shape: Shape, size: float) -> float:
    """Return the element edge far from all contacts, mm.

    The displacement is smooth there: below a size of 1 the edge goes with its square root only.
    """
    return default_coarse_size(shape, min(1.0, float(np.sqrt(size))) if size < 1.0 else size)


def _plan_circles(
    shapes: tuple[CircleShape, ...], groups: tuple[ContactGroup, ...], options: SolutionOptions, order: int
) -> list[tuple[str, RoundGrading, float]]:
    """Return name, grading and turn of each pin or roller; a roller's contacts lie opposite each other."""
    plan = []
    for index, shape in enumerate(shapes):
        widths = [float(group.half_width[index]) for group in groups]
        # Elements for the lower end of a class, a zone for its upper end. Both ends of a roller carry one load: the second
        # follows the class of the first, or the classes of both would make twice as many meshes.
        first = _class_of(widths[0])
        ends = tuple(
            RoundEnd(edge=options.size * width / ELEMENTS_PER_HALF_WIDTH, half_width=float(CLASS_RATIO * width))
            for width in (first * _ratio_below(width, widths[0]) for width in widths)
        )
        grading = RoundGrading(
            radius=shape.radius,
            core_radius=shape.core_radius,
            ends=ends,
            coarse_size=coarse_edge(shape, options.size),
            order=order,
            growth=options.growth,
        )
        plan.append((shape.name, grading, float(groups[0].direction[index])))
    return plan


def require_model_memory(models: Sequence[tuple[DriveShapes, ExpectedContacts]], options: SolutionOptions) -> None:
    """Raise MemoryLimitError when the models of several discs would not fit into memory together, before any meshing.

    Only the meshes of discs and inner races are counted: pins and rollers are small beside them.
    """
    size, sizes = options.size, []
    for shapes, guess in models:
        unknowns = estimate_unknowns(shapes.disc, disc_refinements(guess, size))
        sizes.append(unknowns + estimate_unknowns(shapes.inner_race, race_refinements(guess, size)))
    what = (
        "the model of disc and inner race" if len(sizes) == 1 else f"the models of {len(sizes)} discs and inner races"
    )
    require_memory(sum(sizes), sum(solution_memory(unknowns) for unknowns in sizes), what)


def mesh_drive(
    shapes: DriveShapes,
    contacts: ExpectedContacts,
    options: SolutionOptions = DEFAULT_OPTIONS,
    *,
    order: int = 2,
    known: Mapping[RoundGrading, BodyMesh] | None = None,
    report: Callable[[BodyMesh], None] | None = None,
) -> DriveMeshes:
    """Mesh all bodies of a drive for the contacts expected.

    Pins (and rollers) of one radius whose expected half-widths are alike share one mesh, turned to their
    contacts, so that one factorisation can serve them all.

    Parameters
    ----------
    shapes : DriveShapes
        Shapes of the bodies.
    contacts : ExpectedContacts
        From `fem.drive.expected_contacts.expect_contacts`.
    options : SolutionOptions
        Size and growth of the elements, and whether the walls of the disc are refined (`wall_refinements`).
    order : int
        1 or 2.
    known : mapping of RoundGrading to BodyMesh, optional
        Meshes of pins and rollers made before, used where the grading is the same.
    report : callable, optional
        Called with each mesh as soon as it is made.

    Returns
    -------
    DriveMeshes
        All meshes.

    Raises
    ------
    MeshError
        When a mesh cannot be made or is bad.
    MemoryLimitError
        When meshes and solution would not fit into memory; checked before any meshing.
    """
    size, growth = options.size, options.growth
    disc_spots, race_spots = disc_refinements(contacts, size), race_refinements(contacts, size)
    if options.fine_walls:
        disc_spots += wall_refinements(shapes.disc)
    pins = _plan_circles(shapes.wheel_pins, (contacts.pins,), options, order)
    ends = (contacts.rollers_outer, contacts.rollers_inner)
    rollers = _plan_circles(shapes.rollers, ends, options, order)
    shaft_pins = _plan_circles(shapes.shaft_pins, (contacts.holes,), options, order)
    planned: list[tuple[Shape, tuple[Refinement, ...]]] = [(shapes.disc, disc_spots), (shapes.inner_race, race_spots)]
    planned += [
        (shape, grading.refinements)
        for shape, (_, grading, _) in zip(
            shapes.wheel_pins + shapes.rollers + shapes.shaft_pins, pins + rollers + shaft_pins, strict=True
        )
    ]
    total = sum(
        estimate_unknowns(shape, spots, coarse_size=coarse_edge(shape, size), growth=growth, order=order)
        for shape, spots in planned
    )
    require_memory(total, solution_memory(total), "the drive's mesh")

    def announce(body: BodyMesh) -> BodyMesh:
        if report is not None:
            report(body)
        return body

    made = dict(known or {})

    def circle(name: str, grading: RoundGrading, turn: float) -> RoundMesh:
        if grading not in made:
            made[grading] = grading.mesh(name)
        return RoundMesh(grading=grading, body=made[grading], turn=turn)

    disc_edge, race_edge = coarse_edge(shapes.disc, size), coarse_edge(shapes.inner_race, size)
    disc = announce(mesh_disc(shapes.disc, disc_spots, coarse_size=disc_edge, growth=growth, order=order))

    def placed(meshes: tuple[RoundMesh, ...], plan: list[tuple[str, RoundGrading, float]]) -> tuple[BodyMesh, ...]:
        return tuple(announce(mesh.placed(name)) for mesh, (name, _, _) in zip(meshes, plan, strict=True))

    unturned = [tuple(circle(*item) for item in plan) for plan in (pins, rollers, shaft_pins)]
    return DriveMeshes(
        disc=disc,
        wheel_pins=placed(unturned[0], pins),
        rollers=placed(unturned[1], rollers),
        shaft_pins=placed(unturned[2], shaft_pins),
        inner_race=announce(
            mesh_ring(shapes.inner_race, race_spots, coarse_size=race_edge, growth=growth, order=order)
        ),
        unturned_pins=unturned[0],
        unturned_rollers=unturned[1],
        unturned_shaft_pins=unturned[2],
    )
