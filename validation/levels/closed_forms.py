"""Level 1: the finite-element code and the half-space code against closed forms, computed anew in every run."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fem.body.condensation import condense_body
from fem.body.elasticity import Traction, assemble_stiffness, traction_load, unknowns_of_boundary
from fem.body.plane_references import kirsch_traction, lame_hoop_stress, solve_free_body
from fem.body.stress import Stress
from fem.body.surface import OppositeZone, PressureZone
from fem.contact.coupling import Pose
from fem.contact.two_bodies import press_together
from fem.mesh.element_size import Refinement
from fem.mesh.triangulation import mesh_circle, mesh_ring
from fem.shapes import CircleShape, RingShape
from ltca.analysis.loaded_analysis import analyse
from ltca.contact.hertz import effective_radius, line_half_width, line_peak_pressure
from ltca.contact.pressure_cells import solve_cylinder_patch
from ltca.contact.subsurface import find_subsurface_shear
from ltca.drive.parts import Drive, Material, contact_modulus
from ltca.drive.single_discs import single_discs
from ltca.geometry.placement import Placement, position_angles
from ltca.laws.line_contact import LineContactLaw
from validation.hertz import line_contact_stress, solve_point_contact, strip_approach
from validation.rows import Row, relative_row

STEEL = Material(youngs_modulus=206_000.0, poisson_ratio=0.3)
MODULUS = contact_modulus(STEEL, STEEL)
FEM, HALF_SPACE = "finite elements", "half-space"


def check_closed_forms(drive: Drive) -> list[Row]:
    """Return the rows of level 1; the mean tangential bearing load of the drive is compared with power balance."""
    return [*ring_rows(), *hole_rows(), *cylinder_rows(), *roller_rows(), *crowned_roller_rows(), *power_rows(drive)]


def _solve_ring(
    inner: float, outer: float, size: float, boundary: str, traction: Traction
) -> tuple[Stress, NDArray[np.complex128]]:
    """Solve a free ring under tractions; return the stress at the nodes and the nodes."""
    body = mesh_ring(RingShape(inner_radius=inner, outer_radius=outer, name="ring"), coarse_size=size)
    return solve_free_body(body, STEEL, traction_load(body, boundary, traction, thickness=1.0)), body.places


def ring_rows(size: float = 0.7) -> list[Row]:
    """Return the row on a ring under inner pressure, elements of `size` mm on a wall of 10 mm."""
    inner, outer, pressure = 10.0, 20.0, 100.0
    stress, nodes = _solve_ring(inner, outer, size, "inner", lambda x, n: (-pressure * n[0], -pressure * n[1]))
    c, s = np.cos(np.angle(nodes)), np.sin(np.angle(nodes))
    hoop = stress.xx * s**2 + stress.yy * c**2 - 2.0 * stress.xy * s * c
    exact = lame_hoop_stress(pressure, inner, outer, np.abs(nodes))
    worst = int(np.argmax(np.abs(hoop - exact)))
    return [
        Row(
            level=1,
            quantity="hoop stress of a ring under inner pressure, worst node",
            value=float(hoop[worst]),
            reference=float(exact[worst]),
            unit="MPa",
            difference=float((hoop[worst] - exact[worst]) / exact.max()),
            limit=5e-3,
            model=FEM,
            against="Lamé",
            reason=f"of the largest stress; averaged stresses of quadratic elements {size:g} mm long on a wall of 10 mm",
        )
    ]


def hole_rows(size: float = 0.36) -> list[Row]:
    """Return the row on a hole of radius 3 mm in a plate under tension, elements of `size` mm."""
    far, radius = 80.0, 3.0
    stress, nodes = _solve_ring(radius, 5.0 * radius, size, "outer", lambda x, n: kirsch_traction(far, radius, x))
    side = int(np.argmin(np.abs(nodes - 1j * radius)))
    angle = float(np.angle(nodes[side]))  # no node need stand exactly at the side
    return [
        relative_row(
            1,
            "peak stress at a hole in a plate under tension",
            float(stress.xx[side]),
            far * (1.0 - 2.0 * np.cos(2.0 * angle)) * np.sin(angle) ** 2,
            "MPa",
            5e-3,
            "a boundary node, where averaging is one-sided; halving the elements divides the error by four",
            model=FEM,
            against="Kirsch",
        )
    ]


def cylinder_rows(elements: float = 8.0) -> list[Row]:
    """Return the rows on two cylinders pressed together, so many elements for the half-width."""
    radii, load, thickness = (8.0, 6.5), 1500.0, 10.0
    effective = effective_radius(*radii)
    width = float(line_half_width(load / thickness, effective, MODULUS))
    peak = float(line_peak_pressure(load / thickness, effective, MODULUS))
    shapes = [CircleShape(name=f"cylinder_{k}", radius=radius, core_radius=2.0) for k, radius in enumerate(radii)]
    below = mesh_circle(shapes[0], [Refinement(radii[0], 0.0, width / elements, 1.5 * width)])
    above = mesh_circle(shapes[1], [Refinement(-radii[1], 0.0, 0.7 * width / elements, 1.5 * width)])
    zone = PressureZone.on_boundary(below, shapes[0].curves[0], radii[0] + 0j, 2.4 * width, thickness=thickness)
    opposite = OppositeZone.on_circle(above, "surface", -radii[1] + 0j, 3.6 * width)
    bodies = [
        condense_body(
            body,
            assemble_stiffness(body, STEEL, thickness=thickness),
            loads,
            fixed=unknowns_of_boundary(body, "core"),
        )
        for body, loads in ((below, zone.load_shapes(below.unknowns)), (above, opposite.unit_loads(above.unknowns)))
    ]
    contact = press_together(
        zone,
        bodies[0],
        opposite,
        bodies[1],
        pose=Pose(centre=sum(radii) + 0j),
        radius=radii[1],
        load=load,
        direction=1.0 + 0j,
        expected_half_width=width,
    )
    reason = f"{elements:g} elements for the half-width, meshes that do not match; half-width 2 % of the radius: (b/R)² is 0.04 %"
    where = {"model": FEM, "against": "Hertz"}
    return [
        relative_row(
            1, "half-width of two cylinders pressed together", contact.half_width, width, "mm", 5e-3, reason, **where
        ),
        relative_row(1, "peak pressure of two cylinders", contact.peak_pressure, peak, "MPa", 5e-3, reason, **where),
        relative_row(
            1,
            "resultant of the contact pressure",
            abs(contact.force),
            load,
            "N",
            1e-10,
            "equilibrium holds by construction of the weights: round-off",
            model=FEM,
            against="load applied",
        ),
    ]


def roller_rows(cells: int = 16) -> list[Row]:
    """Return the rows on a long roller on half-space cells, so many over the half-width, and on the table's light-load limit."""
    length, radius = 40.0, 2.0
    solution = solve_cylinder_patch(length, radius, MODULUS, 5e-3, cells=cells)
    x, pressure = solution.mid_profile
    by_length = 2.0 * float(np.sum(pressure)) * float(x[1] - x[0])
    shear = find_subsurface_shear(solution, 0.3)
    depth = solution.half_width * np.linspace(0.7, 0.9, 401)
    exact = line_contact_stress(0.0, depth, solution.half_width, solution.mid_pressure).max_shear
    law = LineContactLaw(11.8, MODULUS)
    light = 1e-60
    load = float(law.load_and_stiffness(light, radius)[0])
    width = line_half_width(load / 11.8, radius, MODULUS)
    _, mean = strip_approach(load / 11.8, width, 11.8, MODULUS)
    reason = f"{cells} constant cells over the half-width, corrected for their size: 0.04 % measured with 8"
    hertz = {"model": HALF_SPACE, "against": "Hertz, same load at mid-width"}
    return [
        relative_row(
            1,
            "half-width of a long roller at mid-width",
            solution.half_width,
            float(line_half_width(by_length, radius, MODULUS)),
            "mm",
            1e-3,
            reason,
            **hertz,
        ),
        relative_row(
            1,
            "peak pressure of a long roller at mid-width",
            solution.mid_pressure,
            float(line_peak_pressure(by_length, radius, MODULUS)),
            "MPa",
            1e-3,
            reason,
            **hertz,
        ),
        relative_row(
            1,
            "largest shear stress below a long roller",
            float(shear.max_shear),
            float(exact.max()),
            "MPa",
            5e-3,
            "40 mm are 360 half-widths: plane strain within 0.3 %",
            model=HALF_SPACE,
            against="McEwen",
        ),
        relative_row(
            1,
            "approach of a roller, light-load limit of the table",
            light,
            float(mean),
            "mm",
            1e-3,
            "far beyond the tabulated range its continuation holds to 0.06 % and tends to the closed form",
            model=HALF_SPACE,
            against="Lundberg's strip, mean approach",
        ),
    ]


def crowned_roller_rows(cells: int = 24) -> list[Row]:
    """Return the rows on a crowned roller, an elliptical point contact as long as it does not reach its ends."""
    small, large, approach = 2.0, 40.0, 2e-3
    point = solve_point_contact(approach, small, large, MODULUS)
    length = 2.2 * point.half_axis_long
    solution = solve_cylinder_patch(
        length, small, MODULUS, approach, relief=lambda y: np.asarray(y) ** 2 / (2.0 * large), cells=cells, grading=1.0
    )
    reason = "point contact on rectangles: the ellipse is cut by the grid, an error of the square of the cells"
    where = {"model": HALF_SPACE, "against": "Hertz, elliptical"}
    return [
        relative_row(1, "load of a crowned roller", float(solution.load), point.load, "N", 3e-3, reason, **where),
        relative_row(
            1,
            "peak pressure of a crowned roller",
            float(solution.pressure.max()),
            point.peak_pressure,
            "MPa",
            5e-3,
            reason,
            **where,
        ),
    ]


def power_rows(drive: Drive, positions: int = 360) -> list[Row]:
    """Return the rows on power balance over whole periods of the flank: mean tangential bearing load T/(u e) of each disc.

    Several cranks turn together: their loads count by their eccentricities.
    """
    analysis = analyse(drive, position_angles(positions))
    count, cranks = drive.disc.number_of_discs, drive.crank.number
    rows = []
    for number, single in enumerate(single_discs(drive)):
        moment = abs(drive.wheel_moment())
        if count > 1 or drive.wheel_is_held:
            moment = abs(float(np.mean(analysis.disc_torques[:, number])))
        eccentricities = Placement.of_drive(single).eccentricity
        eccentricity = float(np.mean(eccentricities))
        tangential = analysis.bearing_tangential[:, number] * (eccentricities / eccentricity)
        of = (", sum of all cranks" if cranks > 1 else "") + (f", disc {number}" if count > 1 else "")
        rows.append(
            relative_row(
                1,
                f"mean tangential bearing load over one turn{of}",
                float(np.mean(tangential)) * cranks * drive.driving_sign,
                moment / (drive.reduction_ratio * eccentricity),
                "N",
                5e-4,
                "power balance; rollers repeat only after many turns, one turn leaves 0.005 % for the paper's drive",
                model=HALF_SPACE,
                against="T/(u e)",
            )
        )
    return rows
