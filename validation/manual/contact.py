"""Contact of two bodies: Hertz' lines and points, NAFEMS' cylinder, flat punch, patch test, roller between flats."""

from __future__ import annotations

import numpy as np
from scipy.sparse import hstack

from fem.body.condensation import condense_body
from fem.body.elasticity import assemble_stiffness, unknowns_of_boundary
from fem.body.surface import OppositeZone, PressureZone
from fem.contact.coupling import Pose, integrate_pair
from fem.contact.pressure_measures import pressure_moments
from fem.contact.two_bodies import TwoBodyContact, press_together
from fem.contact.unilateral import ContactProblem, solve_floating_contact
from fem.mesh.body_mesh import BodyMesh
from fem.mesh.element_size import Refinement
from fem.mesh.triangulation import mesh_circle
from fem.shapes import CircleShape
from ltca.arrays import FloatArray, IntArray
from ltca.contact.hertz import line_half_width
from ltca.drive.parts import Material, contact_modulus
from ltca.laws.line_contact import LineContactLaw
from validation.hertz import strip_approach
from validation.levels.closed_forms import crowned_roller_rows, cylinder_rows, roller_rows
from validation.manual.case import Case, Figure, Reference, relative_figure
from validation.manual.error_bars import HALVED, error_by_size, figures_by_size
from validation.manual.flat_block import FLAT, mesh_block

STEEL = Material(youngs_modulus=206_000.0, poisson_ratio=0.3)
CLOSED_FORM = "None beyond round-off: a closed form."
SIZES = (4.0, 8.0, 16.0)
"""Elements for the half-width of a contact, coarsest first."""
ROUND_OFF = "round-off of the solution of some thousand equations, estimated"


# NAFEMS benchmark 1

NAFEMS_HALF_WIDTH, NAFEMS_PEAK = 6.2146, 3585.36
NAFEMS_STEEL = Material(youngs_modulus=210_000.0, poisson_ratio=0.3)
NAFEMS_ALUMINIUM = Material(youngs_modulus=70_000.0, poisson_ratio=0.3)


def press_nafems_cylinder(elements: float) -> TwoBodyContact:
    """Press the cylinder of NAFEMS' contact benchmark 1 on its block, so many elements for the half-width."""
    radius, load = 50.0, 35_000.0
    width = float(line_half_width(load, radius, contact_modulus(NAFEMS_STEEL, NAFEMS_ALUMINIUM)))
    block = mesh_block(100.0, 200.0, width / elements, zone=1.6 * width)
    shape = CircleShape(name="cylinder", radius=radius)
    cylinder = mesh_circle(shape, [Refinement(0.0, -radius, width / elements, 1.5 * width)])
    zone = PressureZone.on_boundary(block, FLAT, 0j, 2.0 * width, thickness=1.0)
    opposite = OppositeZone.on_circle(cylinder, "surface", -1j * radius, 2.8 * width)
    below = condense_body(
        block,
        assemble_stiffness(block, NAFEMS_ALUMINIUM, thickness=1.0),
        zone.load_shapes(block.unknowns),
        fixed=unknowns_of_boundary(block, "bottom"),
    )
    above = condense_body(
        cylinder, assemble_stiffness(cylinder, NAFEMS_STEEL, thickness=1.0), opposite.unit_loads(cylinder.unknowns)
    )
    return press_together(
        zone,
        below,
        opposite,
        above,
        pose=Pose(centre=1j * radius),
        radius=radius,
        load=load,
        direction=1j,
        expected_half_width=width,
    )


def _nafems() -> list[Figure]:
    sizes = (5.0, 10.0, 20.0)
    found = [press_nafems_cylinder(size) for size in sizes]
    reason = "asked of this benchmark; the half-width is 12.4 % of the radius, so the cylinder is no half-plane: (b/R)² is 1.5 %"
    figures = []
    for quantity, values, reference, unit in (
        ("half-width of the contact", [contact.half_width for contact in found], NAFEMS_HALF_WIDTH, "mm"),
        ("largest pressure", [contact.peak_pressure for contact in found], NAFEMS_PEAK, "MPa"),
    ):
        error = error_by_size(values) / reference
        origin = f"{HALVED} (5, 10, 20 elements for the half-width)"
        figures.append(
            relative_figure(
                quantity, values[-1], reference, unit, 5e-3, reason, numerical_error=error, numerical_origin=origin,
                reference_error=1e-5,
            )
        )  # fmt: skip
    return figures


# Flat punch

PUNCH_HALF_WIDTH, PUNCH_LINE_LOAD = 5.0, 1000.0


def press_flat_punch(elements: int) -> tuple[FloatArray, FloatArray]:
    """Press a rigid flat punch on a large block, so many elements for its half-width; return places (mm) and pressure (MPa)."""
    half = PUNCH_HALF_WIDTH
    block = mesh_block(60.0 * half, 60.0 * half, half / elements, zone=half)
    zone = PressureZone.on_boundary(block, FLAT, 0j, half, thickness=1.0, loaded_ends=True)
    below = condense_body(
        block,
        assemble_stiffness(block, STEEL, thickness=1.0),
        zone.load_shapes(block.unknowns),
        fixed=unknowns_of_boundary(block, "bottom"),
    )
    contact = press_together(
        zone,
        below,
        None,
        None,
        pose=Pose(rotation=np.pi),
        radius=np.inf,
        load=PUNCH_LINE_LOAD,
        direction=1j,
        expected_half_width=2.0 * half,
    )
    return contact.arc - 0.5 * contact.arc[-1], contact.pressure


def _punch() -> list[Figure]:
    sizes, half = (8, 16, 32), PUNCH_HALF_WIDTH
    each = []
    for elements in sizes:
        place, pressure = press_flat_punch(elements)
        inside = np.abs(place) <= 0.5 * half + 1e-9
        shared = pressure_moments(place[inside], pressure[inside])[0] / PUNCH_LINE_LOAD
        each.append((*np.interp([0.0, 0.5 * half], place, pressure), shared))
    middle = PUNCH_LINE_LOAD / (np.pi * half)
    reason = (
        "pressure is infinite at the corners, which even elements do not resolve: their error falls with the first "
        "power of "
        "the size, 3 % of the half-width here, and reaches the places compared weakened"
    )
    origin = f"{HALVED} (8, 16, 32 elements for the half-width)"
    return [
        relative_figure(
            quantity, values[-1], reference, unit, 1e-2, reason,
            numerical_error=error_by_size(values) / reference, numerical_origin=origin,
        )
        for quantity, values, reference, unit in (
            ("pressure in the middle", [float(one[0]) for one in each], middle, "MPa"),
            ("pressure half-way to the corner", [float(one[1]) for one in each], middle / np.sqrt(0.75), "MPa"),
            ("part of the load on the middle half", [float(one[2]) for one in each], 1.0 / 3.0, ""),
        )
    ]  # fmt: skip


# Patch test

PATCH_MESHES = ((7, 10), (9, 4), (5, 5))


def _on_smooth_support(body: BodyMesh) -> IntArray:
    """Unknowns held by a smooth support: the bottom vertically, one node sideways."""
    bottom = unknowns_of_boundary(body, "bottom")
    return np.append(bottom[1::2], bottom[0])


def press_blocks(edges_below: int, edges_above: int) -> tuple[FloatArray, float]:
    """Press two equal blocks together, with so many edges on half the width; return pressure (MPa) and approach (mm)."""
    half, height, thickness, load = 5.0, 6.0, 3.0, 900.0
    lower = mesh_block(half, height, half / edges_below, zone=half)
    upper = mesh_block(half, height, half / edges_above, zone=half)
    zone = PressureZone.on_boundary(lower, FLAT, 0j, half, thickness=thickness, loaded_ends=True)
    opposite = OppositeZone.on_flat(upper, "perimeter", 0j, half)
    bodies = [
        condense_body(body, assemble_stiffness(body, STEEL, thickness=thickness), loads, fixed=_on_smooth_support(body))
        for body, loads in ((lower, zone.load_shapes(lower.unknowns)), (upper, opposite.unit_loads(upper.unknowns)))
    ]
    contact = press_together(
        zone,
        bodies[0],
        opposite,
        bodies[1],
        pose=Pose(rotation=np.pi),
        radius=np.inf,
        load=load,
        direction=1j,
        expected_half_width=2.0 * half,
    )
    return contact.pressure, contact.approach


def _patch() -> list[Figure]:
    even = 900.0 / (10.0 * 3.0)
    squeezed = 2.0 * 6.0 * even * (1.0 - STEEL.poisson_ratio**2) / STEEL.youngs_modulus
    reason = "constants are in the space of pressures and the weights of the segments are exact: round-off"
    figures = []
    for below, above in PATCH_MESHES:
        pressure, approach = press_blocks(below, above)
        worst = float(pressure[np.argmax(np.abs(pressure - even))])
        for quantity, value, reference, unit in (
            ("pressure, worst vertex", worst, even, "MPa"),
            ("approach", approach, squeezed, "mm"),
        ):
            figures.append(
                relative_figure(
                    f"{quantity}, {below} edges on {above}", value, reference, unit, 1e-8, reason,
                    numerical_error=1e-9, numerical_origin=ROUND_OFF,
                )
            )  # fmt: skip
    return figures


# Roller between flats

ROLLER_RADIUS, ROLLER_THICKNESS, ROLLER_LINE_LOAD, ROLLER_DEPTH = 5.0, 11.8, 150.0, 2.0


def squeeze_roller(elements: float) -> float:
    """Squeeze a roller between two large flats, so many elements for the half-width; return the approach of deep points, mm."""
    radius, thickness, depth = ROLLER_RADIUS, ROLLER_THICKNESS, ROLLER_DEPTH
    width = float(line_half_width(ROLLER_LINE_LOAD, radius, contact_modulus(STEEL, STEEL)))
    # 60 mm wide and deep: its far boundary changes the strain near by about depth/(2·60)·(1/3).
    block = mesh_block(60.0, 60.0, width / elements, zone=2.2 * width, depth=depth)
    size = width / elements
    spots = [Refinement.polar(radius, sign * np.pi / 2.0, size=size, radius=1.5 * width) for sign in (-1, 1)]
    roller = mesh_circle(CircleShape(name="roller", radius=radius), spots)
    zone = PressureZone.on_boundary(block, FLAT, 0j, 2.2 * width, thickness=thickness)
    ends = [OppositeZone.on_circle(roller, "surface", sign * 1j * radius, 3.3 * width) for sign in (-1, 1)]
    flat = condense_body(
        block,
        assemble_stiffness(block, STEEL, thickness=thickness),
        zone.load_shapes(block.unknowns),
        fixed=unknowns_of_boundary(block, "bottom"),
    )
    loads = hstack([end.unit_loads(roller.unknowns) for end in ends], format="csc")
    between = condense_body(roller, assemble_stiffness(roller, STEEL, thickness=thickness), loads)
    poses = [Pose(), Pose(centre=2j * radius, rotation=np.pi)]
    pairs = [
        integrate_pair(zone, pose, Pose(centre=1j * radius), radius, end) for pose, end in zip(poses, ends, strict=True)
    ]
    count, split = zone.unknown_count, pairs[0].opposite_loads.shape[0]
    own = np.zeros((between.compliance.shape[0], 2 * count))
    own[:split, :count], own[split:, count:] = pairs[0].opposite_loads, pairs[1].opposite_loads
    compliance = own.T @ between.compliance @ own
    compliance[:count, :count] += flat.compliance
    compliance[count:, count:] += flat.compliance
    # Motions: the roller along y, the upper flat downward.
    motions = np.zeros((2 * count, 2))
    motions[:count, 0], motions[count:, 0] = pairs[0].force[1], pairs[1].force[1]
    motions[count:, 1] = pairs[1].force[1]
    arc = zone.arc[1:-1] - 0.5 * zone.arc[-1]
    solution = solve_floating_contact(
        ContactProblem(
            compliance=compliance,
            gap=np.concatenate([pair.gap for pair in pairs]),
            motions=motions,
            external=np.array([0.0, -ROLLER_LINE_LOAD * thickness]),
        ),
        np.tile(np.abs(arc) < 0.8 * width, 2),
    )
    x, y = block.mesh.doflocs
    node = int(np.argmin(np.abs(x + 1j * (y + depth))))
    sunk = sum(float(flat.displacement(part)[2 * node + 1]) for part in np.split(solution.pressure, 2))
    return float(solution.motion[1]) + sunk


def _roller_between_flats() -> list[Figure]:
    nu, modulus = STEEL.poisson_ratio, STEEL.youngs_modulus
    width = float(line_half_width(ROLLER_LINE_LOAD, ROLLER_RADIUS, contact_modulus(STEEL, STEEL)))
    plane = ROLLER_LINE_LOAD * (1.0 - nu**2) / (np.pi * modulus)
    in_flat = plane * (2.0 * np.log(2.0 * ROLLER_DEPTH / width) - nu / (1.0 - nu))
    in_roller = 4.0 * plane * (np.log(4.0 * ROLLER_RADIUS / width) - 0.5)
    exact = 2.0 * in_flat + in_roller
    values = [squeeze_roller(elements) for elements in SIZES]
    return [
        relative_figure(
            "approach of points 2 mm deep in both flats", values[-1], exact, "mm", 1e-2,
            "the far boundary of the blocks, 60 mm away, changes the strain between by 1 to 2 % of the flats' part",
            numerical_error=error_by_size(values) / exact,
            numerical_origin=f"{HALVED} (4, 8, 16 elements for the half-width)",
        )
    ]  # fmt: skip


# Half-space cells and tables


def _line_on_cells() -> list[Figure]:
    return figures_by_size(lambda cells: roller_rows(cells)[:3], (8, 16, 32), "8, 16, 32 cells over the half-width")


def _strip() -> list[Figure]:
    """Approach of a roller as the load vanishes against Lundberg's mean over a strip of even load."""
    modulus, length, radius = contact_modulus(STEEL, STEEL), 11.8, 2.0
    law = LineContactLaw(length, modulus)
    figures = []
    for approach in (1e-12, 1e-60, 1e-120):
        load = float(law.load_and_stiffness(approach, radius)[0])
        width = line_half_width(load / length, radius, modulus)
        _, mean = strip_approach(load / length, width, length, modulus)
        figures.append(
            relative_figure(
                f"approach at a load of {load:.3g} N", approach, float(mean), "mm",
                1e-3 if approach < 1e-50 else None,
                "the load evens out as the logarithm of length by width grows; the continuation of the table beyond its "
                "range keeps constant and slope to 0.06 %",
                numerical_error=4e-4,
                numerical_origin="constant and slope of the table's last interval, fitted to half-space grids",
            )
        )  # fmt: skip
    return figures


def _sphere() -> list[Figure]:
    """Crowned roller as long as its ellipse stays inside; the closed form is that of an elliptical point contact."""
    return figures_by_size(crowned_roller_rows, (8, 16, 32), "8, 16, 32 cells over the half axis")


CASES = (
    Case(
        name="hertz_line",
        title="Hertz' line contact by finite elements",
        problem="Two steel cylinders of radius 8 and 6.5 mm, 10 mm long (E 206 000 MPa, ν 0.3), pressed together by 1500 N "
        "without friction: half-width, largest pressure and resultant of the contact.",
        references=(
            Reference(
                source="Hertz; K. L. Johnson, *Contact Mechanics* (1985), Eqs. 4.43 to 4.45",
                uncertainty="None as numbers. Bodies are half-planes in it: (b/R)² = 0.03 % for the smaller cylinder.",
            ),
        ),
        model="Plane strain, quadratic triangles, meshes that do not match (ratio 0.7), rigid cores of radius 2 mm; "
        "mortar contact "
        "(`fem.contact.two_bodies.press_together`), half-width from the second moment of the pressure.",
        model_uncertainty="Cylinders instead of half-planes, (b/R)², and rigid cores, which hold the cylinders far "
        "from the contact.",
        run=lambda: figures_by_size(cylinder_rows, SIZES, "4, 8, 16 elements for the half-width"),
    ),
    Case(
        name="hertz_line_half_space",
        title="Hertz' line contact and the stress below it on half-space cells",
        problem="A steel roller of radius 2 mm and 40 mm length on a flat, pressed by 5 µm: half-width, largest "
        "pressure and largest "
        "shear stress in the middle of its length. The line load there is that of the pressure found.",
        references=(
            Reference(
                source="Hertz; stress below the surface: McEwen (1949), Johnson (1985), Eqs. 4.45, 4.46",
                uncertainty="None as numbers; of an infinitely long contact, 40 mm are 800 half-widths.",
            ),
        ),
        model="Boussinesq's half-space, cells of constant pressure (`ltca.contact.pressure_cells`, "
        "`ltca.contact.subsurface`).",
        model_uncertainty="Finite length: plane strain holds in the middle within 0.3 %.",
        run=_line_on_cells,
    ),
    Case(
        name="lundberg_strip",
        title="Approach of a line contact of finite length at vanishing load",
        problem="A steel roller of radius 2 mm and 11.8 mm length on a flat: approach at a given load as the load "
        "goes to zero.",
        references=(
            Reference(
                source="Lundberg (1939): strip of even load along its length, mean approach "
                "(`validation.hertz.strip_approach`; a "
                "test integrates Boussinesq's solution)",
                uncertainty="Holds in the limit; at finite loads the true load is not even along the length, which "
                "informing rows show.",
            ),
        ),
        model="Table of half-space grids with its continuation (`ltca.laws.line_contact.LineContactLaw`). Loads are "
        "far below "
        "any in a drive: they show the limit.",
        model_uncertainty="The limit is reached as the inverse logarithm of length by width.",
        run=_strip,
    ),
    Case(
        name="hertz_point",
        title="Hertz' point contact: a crowned roller",
        problem="A steel roller of radius 2 mm, crowned with 40 mm along its length, pressed on a flat by 2 µm: load "
        "and largest pressure.",
        references=(
            Reference(
                source="Hertz, elliptical contact (`validation.hertz.solve_point_contact`; a test shows that its "
                "pressure displaces "
                "the surface by approach less separation)",
                uncertainty="None beyond round-off: elliptic integrals to 1e-12.",
            ),
        ),
        model="Boussinesq's half-space, rectangular cells of constant pressure (`ltca.contact.pressure_cells`); the "
        "contact ends inside "
        "the roller.",
        run=_sphere,
    ),
    Case(
        name="nafems_1",
        title="NAFEMS contact benchmark 1: cylinder on a block",
        problem="A cylinder of diameter 100 mm (E 210 000 MPa) is pressed on a block of 200 × 200 mm (E 70 000 MPa, "
        "fixed below) by "
        "35 000 N on a width of 1 mm; ν 0.3, plane strain, no friction: half-width and largest pressure.",
        references=(
            Reference(
                source="A. W. A. Konter, *Advanced Finite Element Contact Benchmarks*, NAFEMS R0094 (2006), benchmark "
                "1; also "
                "code_aster SSNP154. Hertz: E* 57 692.3 MPa, b 6.2146 mm, p₀ 3585.36 MPa",
                uncertainty="Half a unit of the last printed digit, 1e-5. Half-planes are assumed while b/R = 0.124.",
            ),
        ),
        model="Whole cylinder and block, quadratic triangles, meshes that do not match; mortar contact "
        "(`fem.contact.two_bodies.press_together`). The load acts on the cylinder as a body force over its section. "
        "Half-width from the "
        "second moment of the pressure.",
        model_uncertainty="The gap is that of the circle, not of Hertz' parabola, and the cylinder is not a "
        "half-plane: both of the "
        "order (b/R)² = 1.5 %. Where the load acts on the cylinder is 16 half-widths away.",
        run=_nafems,
    ),
    Case(
        name="flat_punch",
        title="Rigid flat punch on a half-plane",
        problem="A rigid flat punch 10 mm wide is pressed on a steel half-plane by 1000 N/mm without friction: pressure "
        "p(x) = P/(π √(a² − x²)), infinite at the corners.",
        references=(Reference(source="Sadowsky (1928); Johnson (1985), Eq. 2.64", uncertainty=CLOSED_FORM),),
        model="Block 600 mm wide and 300 mm high, fixed below, quadratic triangles of even size below the punch; the "
        "pressure is "
        "piecewise linear up to the corners and finite there.",
        model_uncertainty="A block instead of a half-plane: (a/300 mm)² = 0.03 %.",
        run=_punch,
    ),
    Case(
        name="patch_test",
        title="Contact patch test across meshes that do not match",
        problem="Two steel blocks of equal width, 10 × 6 mm, 3 mm thick, pressed together by 900 N between smooth "
        "supports: the pressure is "
        "even and so is the strain, whatever the meshes.",
        references=(
            Reference(source="Hooke's law in plane strain: p = F/(w t), δ = 2 h p (1 − ν²)/E", uncertainty=CLOSED_FORM),
        ),
        model="Quadratic triangles with 7 edges on 10, 9 on 4 and 5 on 5 on half the width; mortar contact with "
        "loaded ends.",
        run=_patch,
    ),
    Case(
        name="roller_between_flats",
        title="Roller between two flats: approach",
        problem="A steel roller of radius 5 mm between two large steel flats, 150 N/mm: approach of the points 2 mm "
        "deep in both flats.",
        references=(
            Reference(
                source="Johnson (1985), Eqs. 5.56 (a flat down to a depth) and 5.57 (a cylinder between two contacts)",
                uncertainty="None as numbers; terms of (b/d)² and (b/R)², 1e-3, are left out in it.",
            ),
        ),
        model="Plane strain, quadratic triangles; roller and both contacts solved together.",
        model_uncertainty="Blocks 120 × 60 mm instead of half-planes.",
        run=_roller_between_flats,
        long=True,
    ),
)
