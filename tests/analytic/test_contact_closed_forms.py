"""Two cylinders pressed together against Hertz: unlike materials and meshes, and what finer meshes gain.

Johnson: *Contact Mechanics* (1985), Eqs. 4.43–4.45. More contacts against closed forms are cases of the manual
(`validation.manual.contact`): patch test, NAFEMS' cylinder, flat punch, roller between flats.
"""

import pytest

from fem.body.condensation import condense_body
from fem.body.elasticity import assemble_stiffness, unknowns_of_boundary
from fem.body.surface import OppositeZone, PressureZone
from fem.contact.coupling import Pose
from fem.contact.two_bodies import press_together
from fem.mesh.element_size import Refinement
from fem.mesh.triangulation import mesh_circle
from fem.shapes import CircleShape
from ltca.contact.hertz import line_half_width, line_peak_pressure
from ltca.drive.parts import Material, contact_modulus

STEEL = Material(youngs_modulus=206_000.0, poisson_ratio=0.3)


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
