"""The LTCA on solid bodies against a whole disc of solid bodies by finite elements, aligned and with parts that lean.

``python benchmarks/solid_ltca.py`` condenses the leaning case of a drive once as solid bodies (`fem.solid_drive`), solves both
cases on them and, on the same sections, plane strain. Printed is by how many per cent `ltca.analyse` differs: `fe` and `hybrid`
on solid bodies from the solid disc, both on plane bodies from plane strain, so that what belongs to the plane is seen apart.
Loads are those above 5 % of the largest of their kind, the worst of each; tilts are those of the disc at its bore, their
difference by their size. Mind that the mesh of the finite elements has an error of its own: ``--size`` and ``--layers``.
"""

from __future__ import annotations

import argparse
import resource
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

sys.path[0] = str(Path(__file__).resolve().parents[1])  # the package fem, not the benchmark of that name

import ltca
from fem.drive.condensed import condense_drive
from fem.drive.contact_results import ContactResults, summarise_contacts
from fem.drive.pose import solve_pose
from fem.options import SolutionOptions
from fem.reducer.solution import solve_reducer
from fem.solid_drive.width_results import bore_lean
from ltca.geometry.placement import Placement
from ltca.reading.drive_file import load_drive

POSE_TOLERANCE = 1e-8
LEAST_SHARE = 0.05
LOADS = (("pin_load", "pins"), ("roller_load", "rollers"), ("pin_shaft_load", "holes"))


def worst(found: Any, reference: ContactResults, name: str) -> float:
    """Return the difference of loads of a kind that is largest, %."""
    expected = getattr(reference, name)
    on = expected > LEAST_SHARE * expected.max()
    off = 100.0 * (np.asarray(found[name].values).ravel()[on] / expected[on] - 1.0)
    return float(off[np.argmax(np.abs(off))])


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "drive", nargs="?", default="examples/drives/seven_lobes.toml", help="drive with two cases at least"
    )
    parser.add_argument("--aligned", default="aligned", help="name of the case in which nothing leans")
    parser.add_argument("--leaning", default="leaning", help="name of the other")
    parser.add_argument("--angle", type=float, default=0.3, help="crank angle, rad; default 0.3")
    parser.add_argument(
        "--size", type=float, default=4.0, help="element edge by an eighth of the half-width; default 4"
    )
    parser.add_argument("--layers", type=int, default=3, help="over half of the width; default 3")
    arguments = parser.parse_args()
    cases = load_drive(arguments.drive).cases
    drives = {"leaning": cases[arguments.leaning], "aligned": cases[arguments.aligned]}
    clock = time.process_time()
    options = SolutionOptions(size=arguments.size, layers=arguments.layers)
    (solid,) = solve_reducer(drives["leaning"], arguments.angle, options).discs
    moment, model = solid.state.wheel_moment, solid.model
    plane = condense_drive(model.drive, model.shapes, model.contacts, model.meshes)
    flat = solve_pose(plane, moment, start=solid.pose, pose_tolerance=POSE_TOLERANCE)
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    print(f"finite elements: {solid.unknowns:,} unknowns, {time.process_time() - clock:.0f} s, {most:.2g} GB")
    print(f"{'case':<9}{'LTCA':<8}{'bodies':<8}{'wheel':>8}{'pins':>8}{'rollers':>9}{'holes':>8}{'tilt':>8}   per cent")
    for case, drive in drives.items():
        own = replace(model, drive=drive, placement=Placement.of_drive(drive))
        state = solve_pose(own, moment, start=solid.pose, pose_tolerance=POSE_TOLERANCE)
        contacts, lean = summarise_contacts(own, state), bore_lean(replace(solid, model=own, state=state))
        for compliance in ("fe", "hybrid"):
            for bodies in ("solid", "plane"):
                found = ltca.analyse(
                    drive, crank_angle=np.array([arguments.angle]), compliance=compliance, bodies=bodies
                ).dataset
                expected, angle = (contacts, state) if bodies == "solid" else (summarise_contacts(plane, flat), flat)
                turned = 100.0 * (float(found["wheel_angle"].values.item()) / angle.pose.wheel_angle - 1.0)
                loads = [worst(found, expected, name) for name, _ in LOADS]
                about_x, about_y = np.asarray(found["disc_tilt"].values).ravel()
                off = 100.0 * abs(complex(about_y, -about_x) - lean) / abs(lean) if case == "leaning" else np.nan
                row = f"{turned:>+8.2f}{loads[0]:>+8.2f}{loads[1]:>+9.2f}{loads[2]:>+8.2f}{off:>8.2f}"
                print(f"{case:<9}{compliance:<8}{bodies:<8}{row}", flush=True)


if __name__ == "__main__":
    main()
