"""Contact against closed forms: patch test, Hertz, Johnson's compressed roller, NAFEMS' cylinder on a block.

Johnson: *Contact Mechanics* (1985), Eqs. 4.43–4.45 (line contact), 5.56 (flat to a depth), 5.57 (cylinder
between two contacts). NAFEMS: Konter, *Advanced Finite Element Contact Benchmarks* (2006), benchmark 1.
"""

import numpy as np
import pytest

from fem.body.condensation import condense_body
from fem.body.elasticity import assemble_stiffness, unknowns_of_boundary
from fem.body.surface import OppositeZone, PressureZone
from fem.contact.coupling import Pose, integrate_pair
from fem.contact.two_bodies import press_together
from fem.contact.unilateral import ContactProblem, solve_floating_contact
from fem.mesh.element_size import Refinement
from fem.mesh.triangulation import mesh_circle
from fem.shapes import CircleShape
from ltca.contact.hertz import line_half_width, line_peak_pressure
from ltca.drive.parts import Material, contact_modulus

STEEL = Material(youngs_modulus=206_000.0, poisson_ratio=0.3)


def vertical(body, name):
    return unknowns_of_boundary(body, name)[1::2]


@pytest.mark.parametrize(("edges_below", "edges_above"), [(7, 10), (9, 4), (5, 5)])
def test_contact_patch(block_of, flat, edges_below, edges_above):
    """Two blocks of equal width pressed together carry a uniform pressure, whatever their meshes."""
    half, height, thickness, load = 5.0, 6.0, 3.0, 900.0
    lower = block_of(half, height, half / edges_below, zone=half)
    upper = block_of(half, height, half / edges_above, zone=half)
    zone = PressureZone.on_boundary(lower, flat, 0j, half, thickness=thickness, loaded_ends=True)
    assert zone.edge_count == 2 * edges_below
    opposite = OppositeZone.on_flat(upper, "perimeter", 0j, half)
    bodies = []
    for body, loads in ((lower, zone.load_shapes(lower.unknowns)), (upper, opposite.unit_loads(upper.unknowns))):
        # Smooth support below: no friction there either, one node holds the block sideways.
        fixed = np.append(vertical(body, "bottom"), unknowns_of_boundary(body, "bottom")[0])
        bodies.append(condense_body(body, assemble_stiffness(body, STEEL, thickness=thickness), loads, fixed=fixed))
    contact = press_together(
        zone, bodies[0], opposite, bodies[1],
        pose=Pose(rotation=np.pi), radius=np.inf, load=load, direction=1j, expected_half_width=2.0 * half,
    )  # fmt: skip
    expected = load / (2.0 * half * thickness)
    # The issue asks for 1 %; constants are in the pressure space and the segments make the weights exact.
    np.testing.assert_allclose(contact.pressure, expected, rtol=1e-8)
    strain = expected * (1.0 - 0.3**2) / 206_000.0
    assert contact.approach == pytest.approx(2.0 * height * strain, rel=1e-8)


def two_cylinders(elements, ratio, first, second, radii=(8.0, 6.5), load=1500.0, thickness=10.0):
    """Press two pins with rigid cores together; return contact and Hertz' half-width and peak."""
    modulus = contact_modulus(first, second)
    effective = 1.0 / (1.0 / radii[0] + 1.0 / radii[1])
    width = float(line_half_width(load / thickness, effective, modulus))
    shapes = [CircleShape(name=f"cylinder_{k}", radius=radius, core_radius=2.0) for k, radius in enumerate(radii)]
    below = mesh_circle(shapes[0], [Refinement(radii[0], 0.0, width / elements, 1.5 * width)])
    above = mesh_circle(shapes[1], [Refinement(-radii[1], 0.0, ratio * width / elements, 1.5 * width)])
    zone = PressureZone.on_boundary(below, shapes[0].curves[0], radii[0] + 0j, 2.4 * width, thickness=thickness)
    opposite = OppositeZone.on_circle(above, "surface", -radii[1] + 0j, 3.6 * width)
    condensed = [
        condense_body(
            body, assemble_stiffness(body, material, thickness=thickness), loads,
            fixed=unknowns_of_boundary(body, "core"),
        )
        for body, material, loads in (
            (below, first, zone.load_shapes(below.unknowns)),
            (above, second, opposite.unit_loads(above.unknowns)),
        )
    ]  # fmt: skip
    contact = press_together(
        zone, condensed[0], opposite, condensed[1],
        pose=Pose(centre=sum(radii) + 0j), radius=radii[1], load=load, direction=1.0, expected_half_width=width,
    )  # fmt: skip
    return contact, width, float(line_peak_pressure(load / thickness, effective, modulus))


@pytest.mark.slow
@pytest.mark.parametrize("ratio", [1.0, 0.7, 1.3])
@pytest.mark.parametrize("second", [STEEL, Material(youngs_modulus=70_000.0, poisson_ratio=0.33)])
def test_cylinder_on_cylinder(ratio, second):
    """Eight elements for each half-width, non-matching meshes, like and unlike materials."""
    contact, width, peak = two_cylinders(8.0, ratio, STEEL, second)
    assert contact.half_width == pytest.approx(width, rel=5e-3)
    assert contact.peak_pressure == pytest.approx(peak, rel=5e-3)
    assert contact.force.real == pytest.approx(1500.0, rel=1e-12)


@pytest.mark.slow
def test_finer_meshes_come_nearer_to_hertz():
    errors = []
    for elements in (4.0, 16.0):
        contact, width, peak = two_cylinders(elements, 0.8, STEEL, STEEL)
        errors.append(max(abs(contact.half_width / width - 1.0), abs(contact.peak_pressure / peak - 1.0)))
    # b/R = 1 % leaves about (b/R)² of true difference between the bodies and Hertz' half-spaces.
    assert errors[1] < 0.5 * errors[0]
    assert errors[1] < 2e-3


@pytest.mark.slow
def test_roller_between_flats(block_of, flat):
    """Approach of points 2 mm deep in two large flats that squeeze a roller (Johnson, Eqs. 5.56, 5.57)."""
    radius, thickness, line_load, depth = 5.0, 11.8, 150.0, 2.0
    nu, modulus = STEEL.poisson_ratio, STEEL.youngs_modulus
    width = float(line_half_width(line_load, radius, contact_modulus(STEEL, STEEL)))
    # A block 60 mm wide and deep: its far boundary changes the strain near by about depth/(2·60)·(1/3).
    block = block_of(60.0, 60.0, width / 8.0, zone=2.2 * width, depth=depth)
    shape = CircleShape(name="roller", radius=radius)
    spots = [Refinement.polar(radius, sign * np.pi / 2.0, size=width / 8.0, radius=1.5 * width) for sign in (-1, 1)]
    roller = mesh_circle(shape, spots)
    zone = PressureZone.on_boundary(block, flat, 0j, 2.2 * width, thickness=thickness)
    ends = [OppositeZone.on_circle(roller, "surface", sign * 1j * radius, 3.3 * width) for sign in (-1, 1)]
    flat_body = condense_body(
        block,
        assemble_stiffness(block, STEEL, thickness=thickness),
        zone.load_shapes(block.unknowns),
        fixed=unknowns_of_boundary(block, "bottom"),
    )
    from scipy.sparse import hstack

    loads = hstack([end.unit_loads(roller.unknowns) for end in ends], format="csc")
    round_body = condense_body(roller, assemble_stiffness(roller, STEEL, thickness=thickness), loads)
    poses = [Pose(), Pose(centre=2j * radius, rotation=np.pi)]
    pairs = [
        integrate_pair(zone, pose, Pose(centre=1j * radius), radius, end) for pose, end in zip(poses, ends, strict=True)
    ]
    count, split = zone.unknown_count, pairs[0].opposite_loads.shape[0]
    own = np.zeros((round_body.compliance.shape[0], 2 * count))
    own[:split, :count], own[split:, count:] = pairs[0].opposite_loads, pairs[1].opposite_loads
    compliance = own.T @ round_body.compliance @ own
    compliance[:count, :count] += flat_body.compliance
    compliance[count:, count:] += flat_body.compliance
    # Motions: the roller along y, the upper flat downward.
    motions = np.zeros((2 * count, 2))
    motions[:count, 0], motions[count:, 0] = pairs[0].force[1], pairs[1].force[1]
    motions[count:, 1] = pairs[1].force[1]
    load = line_load * thickness
    arc = zone.arc[1:-1] - 0.5 * zone.arc[-1]
    solution = solve_floating_contact(
        ContactProblem(
            compliance=compliance,
            gap=np.concatenate([pair.gap for pair in pairs]),
            motions=motions,
            external=np.array([0.0, -load]),
        ),
        np.tile(np.abs(arc) < 0.8 * width, 2),
    )
    x, y = block.mesh.doflocs
    node = int(np.argmin(np.abs(x + 1j * y + 1j * depth)))
    assert abs(x[node] + 1j * (y[node] + depth)) < 1e-9
    sunk = [flat_body.displacement(part)[2 * node + 1] for part in np.split(solution.pressure, 2)]
    approach = solution.motion[1] + sum(sunk)
    plane = line_load * (1.0 - nu**2) / (np.pi * modulus)
    in_flat = plane * (2.0 * np.log(2.0 * depth / width) - nu / (1.0 - nu))
    in_roller = 4.0 * plane * (np.log(4.0 * radius / width) - 0.5)
    assert approach == pytest.approx(2.0 * in_flat + in_roller, rel=1e-2)


def test_nafems_cylinder_on_block(block_of, flat):
    """R 50 mm on a block 200 mm wide and deep, 35 kN on unit thickness: 3585 MPa and 6.21 mm by Hertz.

    The half-width is 12 % of the radius: neither body is a half-space over the contact and the slopes of the
    cylinder are not small there, so that a few per cent lie between the problem and Hertz' figures, which
    are the benchmark's; elements are a tenth of the half-width.
    """
    aluminium = Material(youngs_modulus=70_000.0, poisson_ratio=0.3)
    steel = Material(youngs_modulus=210_000.0, poisson_ratio=0.3)
    radius, load = 50.0, 35_000.0
    width = float(line_half_width(load, radius, contact_modulus(steel, aluminium)))
    assert width == pytest.approx(6.21, abs=0.01)
    block = block_of(100.0, 200.0, width / 10.0, zone=1.6 * width)
    shape = CircleShape(name="cylinder", radius=radius)
    cylinder = mesh_circle(shape, [Refinement(0.0, -radius, width / 10.0, 1.5 * width)])
    zone = PressureZone.on_boundary(block, flat, 0j, 2.0 * width, thickness=1.0)
    opposite = OppositeZone.on_circle(cylinder, "surface", -1j * radius, 2.8 * width)
    below = condense_body(
        block,
        assemble_stiffness(block, aluminium, thickness=1.0),
        zone.load_shapes(block.unknowns),
        fixed=unknowns_of_boundary(block, "bottom"),
    )
    # The cylinder is loaded by a body force over its area, as a free body is.
    above = condense_body(
        cylinder, assemble_stiffness(cylinder, steel, thickness=1.0), opposite.unit_loads(cylinder.unknowns)
    )
    contact = press_together(
        zone, below, opposite, above,
        pose=Pose(centre=1j * radius), radius=radius, load=load, direction=1j, expected_half_width=width,
    )  # fmt: skip
    assert contact.peak_pressure == pytest.approx(3585.0, rel=0.03)
    assert contact.half_width == pytest.approx(6.21, rel=0.03)
