"""Extruded bodies against exact states: a slab between flats, a bar under its own weight, a ring of finite length."""

from __future__ import annotations

import numpy as np
from skfem import MeshQuad, MeshQuad2

from fem.body.elasticity import traction_load
from fem.contact.coupling import Pose, integrate_pair
from fem.mesh.triangulation import mesh_ring
from fem.shapes import CircleCurve, RingShape
from fem.solid.extruded import ExtrudedBody
from fem.solid.factor import SymmetricFactor
from fem.solid.layers import Layers, Parity, graded_layers
from fem.solid.order import order_unknowns
from fem.solid.section import Section, section_mass
from fem.solid_contact.block import make_block
from fem.solid_contact.bodies import Face, condense_solid
from fem.solid_contact.pressing import press_faces
from fem.solid_contact.widths import WidthGrid
from ltca.arrays import BoolArray, FloatArray
from ltca.drive.parts import Material
from validation.manual.case import Case, Figure, Reference, relative_figure
from validation.manual.error_bars import HALVED, error_by_size

STEEL = Material(youngs_modulus=210e3, poisson_ratio=0.3)
CLOSED_FORM = "None beyond round-off: a closed form."
ROUND_OFF = "round-off of the solution of some thousand equations, estimated"
EXACT_STATE = "the mesh holds the exact state: round-off"


def _solve(body: ExtrudedBody, held: BoolArray, load: FloatArray) -> FloatArray:
    """Displacement of a body under loads, shape (unknowns,)."""
    order = order_unknowns(body)
    factor = SymmetricFactor(body.assemble_stiffness(STEEL), order[~held[order]])
    return np.asarray(factor.solve(load[:, None])[:, 0])


# A slab between flats

SLAB_HEIGHT, SLAB_HALF, SLAB_THICKNESS, SLAB_APPROACH = 2.0, 1.0, 3.0, 1e-3


def press_slab(columns: int, rows: int, layers: int) -> tuple[FloatArray, float]:
    """Press a slab between a rigid flat and a smooth support; return the pressure at all vertices, MPa, and the load, N."""
    block = make_block(
        "slab", np.zeros_like, np.linspace(0.0, SLAB_HALF, columns + 1), columns, np.linspace(0.0, SLAB_HEIGHT, rows + 1),
        above=False, symmetric=False,
    )  # fmt: skip
    along = graded_layers(SLAB_THICKNESS, layers, "symmetric")
    width = WidthGrid(heights=along.vertices, even=True)
    # A circle of 1e9 mm is a flat to 1e-9 mm over the millimetre of the slab.
    zone = block.pressure_zone(CircleCurve(name="flat", radius=1e9, centre=-1e9j))
    integrals = integrate_pair(zone, Pose(), Pose(rotation=np.pi), np.inf, None)

    def support(body: ExtrudedBody) -> BoolArray:
        still = np.zeros(body.unknowns, dtype=bool)
        bottom = block.row_nodes(2 * block.rows)
        still[body.unknowns_of(bottom, 1).ravel()] = True
        still[body.unknowns_of(bottom[[bottom.size // 2]], 0).ravel()[0]] = True
        return still

    face = Face(plane=zone.load_shapes(2 * block.section.node_count), width=width)
    body = condense_solid(block.section, [along], STEEL, [face], support)
    pressed = press_faces((body,), integrals, width, direction=1j, approach=SLAB_APPROACH)
    return pressed.pressure, pressed.load


def _slab() -> list[Figure]:
    even = STEEL.youngs_modulus * SLAB_APPROACH / SLAB_HEIGHT
    figures = []
    for columns, rows, layers in ((3, 3, 2), (5, 2, 4)):
        pressure, load = press_slab(columns, rows, layers)
        worst = float(pressure.ravel()[np.argmax(np.abs(pressure - even))])
        mesh = f"{2 * columns} × {rows} elements, {2 * layers} layers"
        for quantity, value, reference, unit in (
            ("pressure, worst vertex", worst, even, "MPa"),
            ("load", load, even * 2.0 * SLAB_HALF * SLAB_THICKNESS, "N"),
        ):
            figures.append(
                relative_figure(
                    f"{quantity}, {mesh}", value, reference, unit, 1e-6,
                    "the flat is a circle of 1e9 mm and even pressures are in the space: the rest is round-off",
                    numerical_error=1e-7, numerical_origin=ROUND_OFF,
                )
            )  # fmt: skip
    return figures


# A bar under its own weight

BAR_LENGTH, BAR_SIDE, BAR_WEIGHT = 20.0, 4.0, 7.7e-5
"""mm, mm, and N/mm³: the weight of steel."""


def hang_bar(refinements: int, layers: int) -> tuple[float, float, float]:
    """Hang a bar by its upper end; return its stretch along the axis, the dishing of an end's corner and its contraction, mm."""
    square = MeshQuad().refined(refinements).scaled(BAR_SIDE).translated((-0.5 * BAR_SIDE, -0.5 * BAR_SIDE))
    section = Section.of_quadrilaterals("bar", MeshQuad2.from_mesh(square))
    vertices = BAR_LENGTH * np.linspace(0.0, 1.0, layers + 1) ** 1.3
    body = ExtrudedBody(section=section, layers=Layers(vertices=vertices, parity="whole"))
    every = np.arange(section.node_count)
    axial = body.unknowns_of(every, 2)
    down = np.zeros((body.unknowns, 1))
    down[axial.ravel(), 0] = -BAR_WEIGHT
    load = body.mass_times(down)[:, 0]
    # The upper end is pulled by the weight, evenly; the load is in balance, so what holds the body carries nothing.
    load[axial[:, -1]] += BAR_WEIGHT * BAR_LENGTH * (section_mass(section) @ np.ones(section.node_count))
    x, y = section.places

    def node(place: complex) -> int:
        return int(np.argmin(np.abs(x + 1j * y - place)))

    middle, corner = node(0j), node(0.5 * BAR_SIDE * (1 + 1j))
    held = np.zeros(body.unknowns, dtype=bool)
    held[body.statically_determinate((middle, node(0.5 * BAR_SIDE + 0j), node(0.5j * BAR_SIDE)))] = True
    moved = _solve(body, held, load)
    # Rigid motions are taken out by differences that they leave alone: the section is symmetric.
    stretch = float(moved[axial[middle, -1]] - moved[axial[middle, 0]])
    opposite = node(-0.5 * BAR_SIDE * (1 + 1j))
    dishing = 0.5 * float(moved[axial[corner, -1]] + moved[axial[opposite, -1]]) - float(moved[axial[middle, -1]])
    across = body.unknowns_of(np.array([corner, opposite]), 0)[:, -1]
    return stretch, dishing, float(moved[across[1]] - moved[across[0]])


def _bar() -> list[Figure]:
    e, nu = STEEL.youngs_modulus, STEEL.poisson_ratio
    wanted = (
        ("stretch of the axis", BAR_WEIGHT * BAR_LENGTH**2 / (2.0 * e)),
        ("dishing of the upper end at a corner", nu * BAR_WEIGHT * 0.5 * BAR_SIDE**2 / (2.0 * e)),
        ("contraction of the upper end", nu * BAR_WEIGHT * BAR_LENGTH * BAR_SIDE / e),
    )
    figures = []
    for refinements, layers in ((1, 2), (2, 5)):
        found = hang_bar(refinements, layers)
        for (quantity, reference), value in zip(wanted, found, strict=True):
            figures.append(
                relative_figure(
                    f"{quantity}, {2**refinements} × {2**refinements} elements, {layers} layers",
                    1e6 * value, 1e6 * reference, "nm", 1e-6, EXACT_STATE,
                    # The dishing is a hundredth of the stretch from which round-off comes.
                    numerical_error=1e-8, numerical_origin=ROUND_OFF,
                )
            )  # fmt: skip
    return figures


# A ring of finite length

RING_INNER, RING_OUTER, RING_PRESSURE, RING_LENGTH = 10.0, 20.0, 100.0, 12.0
RING_SIZES = (4.0, 2.0, 1.0)


def inflate_ring(size: float, parity: Parity, *, held: bool) -> tuple[float, float]:
    """Inflate a ring; return how much its bore widens and its length shortens, mm.

    Parameters
    ----------
    size : float
        Elements on the wall of 10 mm, mm.
    parity : {"symmetric", "whole"}
        Half the length by symmetry, or all of it.
    held : bool
        Whether flats hold the ends along the axis.
    """
    mesh = mesh_ring(RingShape(inner_radius=RING_INNER, outer_radius=RING_OUTER), coarse_size=size)
    body = ExtrudedBody(section=Section.of_body(mesh), layers=graded_layers(RING_LENGTH, 2, parity))
    plane = traction_load(
        mesh, "inner", lambda x, n: (-RING_PRESSURE * n[0], -RING_PRESSURE * n[1]), thickness=RING_LENGTH
    )
    load = body.spread(plane[:, None], lambda z: np.full(np.shape(z), 1.0 / RING_LENGTH)).toarray()[:, 0]
    outer = np.unique(mesh.boundary_nodes("outer"))
    still = np.zeros(body.unknowns, dtype=bool)
    # Three nodes of the outer wall, which carries no load; the load is in balance.
    first, second, third = (int(outer[k * outer.size // 3]) for k in range(3))
    still[body.statically_determinate((first, second, third))] = True
    if held:
        ends = body.unknowns_of(np.arange(mesh.node_count), 2)
        still[ends[:, -1]] = True
        if parity == "whole":
            still[ends[:, 0]] = True
    moved = _solve(body, still, load)
    bore = np.unique(mesh.boundary_nodes("inner"))
    x, y = body.section.places[:, bore]
    u, v = (moved[body.unknowns_of(bore, component)].mean(axis=1) for component in (0, 1))
    # The mean over the bore: rigid motions of the ring have none.
    radial = float(np.mean((u * x + v * y) / RING_INNER))
    axial = moved[body.unknowns_of(outer, 2)]
    shortening = -2.0 * axial[:, -1] if parity == "symmetric" else axial[:, 0] - axial[:, -1]
    return radial, float(np.mean(shortening))


def _ring() -> list[Figure]:
    e, nu, a, b, p = STEEL.youngs_modulus, STEEL.poisson_ratio, RING_INNER, RING_OUTER, RING_PRESSURE
    share = p * a**2 / (b**2 - a**2)
    free = share / e * ((1.0 - nu) * a + (1.0 + nu) * b**2 / a)
    long = share * (1.0 + nu) / e * ((1.0 - 2.0 * nu) * a + b**2 / a)
    shorter = 2.0 * nu * share / e * RING_LENGTH
    origin = f"{HALVED} (elements of 4, 2, 1 mm on a wall of 10 mm)"
    reason = (
        "quadratic elements of a tenth of the wall and edges that are parabolas: an order less than asked of contacts"
    )
    figures = []
    free_ends = [inflate_ring(size, "symmetric", held=False) for size in RING_SIZES]
    flats = [inflate_ring(size, "symmetric", held=True) for size in RING_SIZES]
    whole = [inflate_ring(2.0 * size, "whole", held=False) for size in RING_SIZES]
    for quantity, values, reference in (
        ("widening of the bore, ends free", [one[0] for one in free_ends], free),
        ("shortening, ends free", [one[1] for one in free_ends], shorter),
        ("widening of the bore, ends free, meshed whole (8, 4, 2 mm)", [one[0] for one in whole], free),
        ("widening of the bore, ends between flats", [one[0] for one in flats], long),
    ):
        figures.append(
            relative_figure(
                quantity, 1e3 * values[-1], 1e3 * reference, "µm", 1e-3, reason,
                numerical_error=max(error_by_size(values) / reference, 1e-9), numerical_origin=origin,
            )
        )  # fmt: skip
    return figures


CASES = (
    Case(
        name="solid_slab",
        title="An elastic slab between flats",
        problem="A slab 2 mm wide, 2 mm high and 3 mm thick, E 210 000 MPa, ν 0.3, on a smooth support, pressed by 1 µm by a "
        "rigid flat without friction: pressure at every vertex, and load.",
        references=(Reference(source="σ = E δ/h, the only stress there is", uncertainty=CLOSED_FORM),),
        model="The block and the contact of solid pairs (`fem.solid_contact`): nine-node quadrilaterals times quadratic "
        "layers, pressure bilinear over arc and height, gaps closed in the mean.",
        run=_slab,
        bodies="solid",
    ),
    Case(
        name="solid_bar",
        title="A bar under its own weight",
        problem="A bar of 4 × 4 mm, 20 mm long, E 210 000 MPa, ν 0.3, weight 7.7e-5 N/mm³, hangs by its upper end, where "
        "the tension is even: stretch of the axis, dishing of the upper end at a corner, contraction across.",
        references=(
            Reference(
                source="Timoshenko and Goodier, *Theory of Elasticity*, stretching of a prismatical bar by its own weight: "
                "γ L²/2E, ν γ r²/2E, ν γ L a/E",
                uncertainty=CLOSED_FORM,
            ),
        ),
        model="An extruded body meshed whole (`fem.solid.extruded`): displacements of the exact state are of the second degree "
        "and in the space of its shapes, with layers of any thickness.",
        run=_bar,
        bodies="solid",
    ),
    Case(
        name="solid_ring",
        title="A ring of finite length under inner pressure",
        problem="A steel ring, radii 10 and 20 mm, 12 mm long, under an inner pressure of 100 MPa, its ends free or between "
        "smooth flats: widening of the bore, and shortening.",
        references=(
            Reference(
                source="Lamé; Timoshenko and Goodier, *Theory of Elasticity*, section 28: plane stress and an even axial "
                "strain where the ends are free, plane strain between flats, both exact at every length",
                uncertainty=CLOSED_FORM,
            ),
        ),
        model="Quadratic triangles times two quadratic layers over half the length (`fem.solid.extruded`), in the symmetric "
        "class; once meshed whole.",
        long=True,
        run=_ring,
        bodies="solid",
    ),
)
