"""Internal fields of the small meshes in ``meshes/``, for regression: ``python -m fem.testing.reference_fields``.

Closed forms and other codes say whether the elements are right; these numbers say whether they changed. A
change in them is to be reviewed like a change of code.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse as sp

from fem.body.condensation import condense_body
from fem.body.elasticity import assemble_stiffness, strain_energy, unknowns_of_boundary
from fem.body.stress import recover_stress
from fem.body.surface import OppositeZone, PressureZone
from fem.contact.coupling import Pose
from fem.contact.two_bodies import press_together
from fem.mesh.mesh_file import read_msh
from fem.shapes import CircleCurve
from fem.testing.fixtures import CYLINDER_RADIUS, SLEEVE
from fem.testing.seated_pin import squeeze_sleeve
from ltca.drive.parts import Material
from ltca.output.files import whole_file

STEEL = Material(youngs_modulus=206_000.0, poisson_ratio=0.3)
LINE_LOAD = 2000.0
SLEEVE_LOAD = 1150.0


def body_fields(path: Path, fixed: str | None) -> dict[str, Any]:
    """Return energy, displacements and stresses of a body under smooth loads on every boundary.

    Each free boundary carries nodal forces cos(3x) e_x + sin(2y) e_y (x, y in units of the body's size): they
    excite every part of the mesh and have no symmetry that could hide a mistake.
    """
    body = read_msh(path)
    stiffness = assemble_stiffness(body, STEEL, thickness=1.0)
    x, y = body.mesh.doflocs
    size = float(np.hypot(x, y).max())
    force = np.zeros(body.unknowns)
    for name in body.boundary_names:
        if name != fixed:
            nodes = unknowns_of_boundary(body, name)[0::2] // 2
            force[2 * nodes] = np.cos(3.0 * x[nodes] / size)
            force[2 * nodes + 1] = np.sin(2.0 * y[nodes] / size)
    held = None if fixed is None else unknowns_of_boundary(body, fixed)
    condensed = condense_body(body, stiffness, sp.csc_matrix(force[:, None]), fixed=held)
    u = condensed.displacement(np.array([1.0]))
    stress = recover_stress(body, u, STEEL)
    return {
        "compliance": float(condensed.compliance[0, 0]),
        "energy": strain_energy(stiffness, u),
        "displacement_norm": float(np.linalg.norm(u)),
        "displacement_largest": float(np.abs(u).max()),
        "von_mises_mean": float(stress.von_mises.mean()),
        "von_mises_largest": float(stress.von_mises.max()),
        "pressure_mean": float(-(stress.xx + stress.yy + stress.zz).mean() / 3.0),
    }


def cylinder_fields(folder: Path) -> dict[str, Any]:
    """Return the contact of the two cylinders under 2 kN for each mm, 8 elements for each half-width."""
    lower, upper = read_msh(folder / "cylinder_lower.msh"), read_msh(folder / "cylinder_upper.msh")
    curve = CircleCurve(name="surface", radius=CYLINDER_RADIUS)
    zone = PressureZone.on_boundary(lower, curve, 1j * CYLINDER_RADIUS, 0.6, thickness=1.0)
    opposite = OppositeZone.on_circle(upper, "surface", -1j * CYLINDER_RADIUS, 0.8)
    bodies = [
        condense_body(body, assemble_stiffness(body, STEEL, thickness=1.0), loads)
        for body, loads in ((lower, zone.load_shapes(lower.unknowns)), (upper, opposite.unit_loads(upper.unknowns)))
    ]
    contact = press_together(
        zone,
        bodies[0],
        opposite,
        bodies[1],
        pose=Pose(centre=2j * CYLINDER_RADIUS),
        radius=CYLINDER_RADIUS,
        load=LINE_LOAD,
        direction=1j,
        expected_half_width=0.335,
    )
    return {
        "approach": contact.approach,
        "half_width": contact.half_width,
        "peak_pressure": contact.peak_pressure,
        "pressure": [float(value) for value in contact.pressure],
    }


def sleeve_fields(folder: Path) -> dict[str, Any]:
    """Return the sleeve on its pin under 1150 N."""
    pin, sleeve = read_msh(folder / "sleeved_pin.msh"), read_msh(folder / "sleeve.msh")
    squeezed = squeeze_sleeve(SLEEVE, pin, sleeve, SLEEVE_LOAD)
    return {
        "approach": squeezed.approach,
        "effective_half_angle": squeezed.effective_half_angle,
        "largest_pressure": squeezed.largest_pressure,
    }


def collect(folder: Path) -> dict[str, Any]:
    """Return the fields of all fixtures in a folder."""
    fixed = {"disc": None, "pin_3": "core", "roller_2": None, "inner_race": "inner", "reducer_disc": None}
    fixed |= {"sleeved_pin": None, "sleeve": None}
    fields: dict[str, Any] = {name: body_fields(folder / f"{name}.msh", held) for name, held in fixed.items()}
    fields["two_cylinders"] = cylinder_fields(folder)
    fields["sleeve_on_its_pin"] = sleeve_fields(folder)
    return fields


def main() -> None:
    """Write the reference file."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--meshes", type=Path, default=Path("meshes"))
    parser.add_argument("--out", type=Path, default=Path("tests/regression/fem_fields.json"))
    arguments = parser.parse_args()
    with whole_file(arguments.out) as part:
        part.write_text(json.dumps(collect(arguments.meshes), indent=1) + "\n", encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main()
