"""How far plane strain and plane stress are from solid bodies, drive by drive, over the width.

``python benchmarks/solid_or_plane.py`` solves every drive at one crank angle as solid bodies (`fem.solid_drive`) and, on the
very same meshes of the cross-section, in plane strain and plane stress: what differs is the third dimension alone. Torque and
stiffness of the shaft pins go with the width, so that the plane answers are the same for every width but for the shares of the
wheel's angle. Printed are differences of the plane from the solid answer in per cent: wheel angle, largest load of a wheel pin,
roller and shaft pin, largest pressure of a wheel pin at mid-width; and what the solid has besides, K_Hβ of that pin and where
between plane strain (0) and plane stress (1) its wheel angle is.
"""

from __future__ import annotations

import argparse
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path[0] = str(Path(__file__).resolve().parents[1])  # the package fem, not the benchmark of that name

from fem.body.elasticity import PlaneState
from fem.drive.condensed import condense_drive
from fem.drive.contact_results import ContactResults, summarise_contacts
from fem.drive.full_solution import FullSolution
from fem.drive.pose import solve_pose
from fem.options import SolutionOptions
from fem.reducer.solution import solve_reducer
from fem.solid_drive.width_results import width_results
from ltca.drive.parts import Drive
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive

DRIVES = ("examples/drives/plastic.toml",)
WIDTHS = (5.0, 10.0, 20.0, 40.0)
POSE_TOLERANCE = 1e-7
"""mm, far below what bodies differ by."""


def widened(drive: Drive, width: float) -> Drive:
    """Return a drive of another width, loaded and carried alike by its length."""
    ratio = width / drive.disc.thickness
    fields: dict[str, float] = {"disc.thickness": width, "load.torque": ratio * drive.load.torque}
    if drive.crank_bearing.roller_length is not None:
        fields["crank_bearing.roller_length"] = width
    if drive.pin_shaft is not None and drive.pin_shaft.stiffness is not None:
        fields["pin_shaft.stiffness"] = ratio * drive.pin_shaft.stiffness
    return with_fields(drive, fields)


def in_the_plane(solid: FullSolution, state: PlaneState) -> tuple[float, ContactResults]:
    """Return wheel angle, rad, and contacts of the plane drive on the sections of a solid one."""
    model = solid.model
    plane = condense_drive(model.drive, model.shapes, model.contacts, model.meshes, plane=state)
    found = solve_pose(plane, solid.state.wheel_moment, start=solid.pose, pose_tolerance=POSE_TOLERANCE)
    return found.pose.wheel_angle, summarise_contacts(plane, found)


def largest(contacts: ContactResults) -> np.ndarray:
    """Return the largest load of a wheel pin, a roller and a shaft pin, N, and the largest pressure of a wheel pin, MPa."""
    return np.array(
        [
            contacts.pin_load.max(),
            contacts.roller_load.max(),
            contacts.pin_shaft_load.max(initial=0.0),
            contacts.pin_pressure_mid.max(),
        ]
    )


def compare(drive: Drive, angle: float, options: SolutionOptions) -> str:
    """Return the row of one drive."""
    clock = time.process_time()
    (solid,) = solve_reducer(drive, angle, options).discs
    settled = solve_pose(solid.model, solid.state.wheel_moment, start=solid.pose, pose_tolerance=POSE_TOLERANCE)
    solid = replace(solid, state=settled, contacts=summarise_contacts(solid.model, settled))
    own, own_angle = largest(solid.contacts), settled.pose.wheel_angle
    angles, row = [], ""
    for state in ("strain", "stress"):
        plane_angle, contacts = in_the_plane(solid, state)
        angles.append(plane_angle)
        values = [plane_angle / own_angle, *(largest(contacts)[:3] / own[:3]), largest(contacts)[3] / own[3]]
        row += " |" + "".join(f"{100.0 * (value - 1.0):+8.2f}" for value in values)
    between = (own_angle - angles[0]) / (angles[1] - angles[0])
    pins = [each for pair, each in zip(solid.model.pairs, width_results(solid), strict=True) if pair.kind == "pin"]
    factor = max(pins, key=lambda each: each.load).load_factor
    seconds = time.process_time() - clock
    return f"{row} | {factor:6.3f} {between:8.2f} {solid.unknowns:>9,} {seconds:8.0f}"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "drives", nargs="*", default=DRIVES, help="drive files, their first cases; default the plastic one"
    )
    parser.add_argument("--widths", type=float, nargs="+", default=WIDTHS, help="mm; default 5 to 40")
    parser.add_argument("--angle", type=float, default=0.3, help="crank angle, rad; default 0.3")
    parser.add_argument(
        "--size", type=float, default=4.0, help="element edge by an eighth of the half-width; default 4"
    )
    parser.add_argument("--layers", type=int, default=4, help="over half of the width; default 4")
    arguments = parser.parse_args()
    options = SolutionOptions(size=arguments.size, layers=arguments.layers)
    columns = "".join(f"{name:>8}" for name in ("wheel", "pin", "roller", "hole", "p pin"))
    print(f"{'drive':<14}{'mm':>6} | plane strain, % of solid{columns[25:]:>15} | plane stress")
    print(f"{'':<20} |{columns} |{columns} | {'K_Hβ':>6} {'between':>8} {'unknowns':>9} {'CPU, s':>8}")
    for path in arguments.drives:
        drive = next(iter(load_drive(path).cases.values()))
        for width in arguments.widths:
            row = compare(widened(drive, width), arguments.angle, options)
            print(f"{drive.name[:13]:<14}{width:>6g}{row}", flush=True)


if __name__ == "__main__":
    main()
