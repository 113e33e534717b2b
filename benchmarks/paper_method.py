"""Convergence of the paper's iteration from the paper's starting pose and from poses near the solution.

    python benchmarks/paper_method.py [--positions 72]

The paper starts every case from its clearance-free analysis (Sect. 3.5: the displacements of Sect. 2) and uses Newton's method
without damping, with finite-difference tangents. The iteration is also started from the solution of `ltca` at 95 % and 50 % of
the torque.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import argparse
import sys
from collections import Counter
from dataclasses import replace
from pathlib import Path

sys.path[0] = str(Path(__file__).resolve().parents[1])  # the package fem, not the benchmark of that name


def main() -> None:
    """Print convergence, failures and their crank angles for every case and starting pose."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--positions", type=int, default=72, help="crank angles over one turn; default 72")
    arguments = parser.parse_args()
    # Not for the help.
    import numpy as np

    from ltca.compliance.half_space import HalfSpaceCompliance
    from ltca.drive.parts import Clearance
    from ltca.equilibrium.balance import solve_equilibrium
    from ltca.equilibrium.reducer import Reducer
    from ltca.geometry.placement import position_angles
    from ltca.reading.drive_file import load_drive
    from validation.methods.clearance_free import analyse_without_clearance
    from validation.methods.paper_method import iterate_held_wheel, lead_of_pose, pose_of_lead

    angles = position_angles(arguments.positions)
    cases = load_drive("paper").cases
    free = replace(cases["CS-1"], clearance=Clearance())
    paper_start = np.array([analyse_without_clearance(free, float(angle)).pose for angle in angles])
    for name, drive in cases.items():
        model, moment = Reducer(discs=(HalfSpaceCompliance.of_drive(drive),)), drive.wheel_moment()
        starts = {
            "clearance-free solution (the paper's start)": paper_start,
            "solution at 95 % of the torque": solve_equilibrium(model, angles, 0.95 * moment).pose,
            "solution at 50 % of the torque": solve_equilibrium(model, angles, 0.50 * moment).pose,
        }
        for title, pose in starts.items():
            wheel, unknowns = lead_of_pose(model, angles, pose)
            found = iterate_held_wheel(model, wheel, np.full(angles.size, moment), unknowns)
            failed = ~found.converged
            line = f"{name}  {title:<46}{np.count_nonzero(failed):4d} of {angles.size} fail"
            if np.any(found.converged):
                actual, at = pose_of_lead(model, wheel, found.unknowns)
                good = found.converged
                ours = solve_equilibrium(model, actual[good], moment)
                theirs = model.respond(actual[good], at[good])
                apart = np.max(np.abs(ours.response.pin_load - theirs.pin_load)) / np.max(theirs.pin_load)
                line += (
                    f"; {np.mean(found.iterations[good]):.1f} steps, loads within {100.0 * apart:.1e} % of the solution"
                )
            print(line)
            if np.any(failed):
                for reason, count in Counter(reason for reason in found.failure if reason).items():
                    print(f"        {count:4d} x {reason}")
                places = np.degrees(angles[failed])
                print(
                    "        at φ_C [°]: "
                    + ", ".join(f"{value:.0f}" for value in places[:18])
                    + (" …" if places.size > 18 else "")
                )


if __name__ == "__main__":
    main()
