"""Practical drives by expensive models: ``python benchmarks/practical_models.py --direct 50 --hybrid 20 --fe 20 --full 5``.

The drives are those of `ltca.testing.practical_drives`, by seed. All of them have to be solved. Printed are the residual relative
to the load and the largest wheel-pin load relative to that of the tables. ``fe`` and ``hybrid`` share derived coefficients, 15 to
110 s per shape; ``fe`` and full finite elements use drives whose roller length equals the disc thickness. Exit status 1 if a
drive has no solution.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

sys.path[0] = str(Path(__file__).resolve().parents[1])  # the package fem, not the benchmark of that name

from fem.reducer.solution import solve_reducer
from ltca.analysis.engines import Engine, HalfSpace, Hybrid, PlaneStrain
from ltca.drive.parts import Drive
from ltca.errors import CycloError
from ltca.testing.practical_drives import practical_drive

ENGINES: dict[str, Engine] = {"direct": HalfSpace(method="direct"), "hybrid": Hybrid(), "fe": PlaneStrain()}


def largest_pin(engine: Engine, drive: Drive, angle: float) -> tuple[float, float]:
    """Return the largest wheel-pin load, N, and the residual times e u relative to the moment on the wheel."""
    found = engine.prepare(drive).balance(np.array([angle]), drive.load.torque)
    lever = drive.crank.eccentricity * drive.reduction_ratio
    return float(np.max(found.response.pin_load)), float(found.residual[0] * lever / abs(found.wheel_moment[0]))


def try_model(name: str, drive: Drive, angle: float) -> dict[str, Any]:
    """Return the results of one model for one drive."""
    tables, _ = largest_pin(HalfSpace(), drive, angle)
    began = time.perf_counter()
    try:
        if name == "full":
            solved = solve_reducer(drive, angle)
            load, left = max(float(np.max(disc.contacts.pin_load)) for disc in solved.discs), 0.0
        else:
            load, left = largest_pin(ENGINES[name], drive, angle)
    except CycloError as error:
        return {"answered": False, "told": str(error)}
    return {
        "answered": True, "pin_load_by_tables": load / tables, "residual_by_load": left,
        "seconds": round(time.perf_counter() - began, 2),
    }  # fmt: skip


def main() -> int:
    """Solve the drives with every model; exit status 1 if one has no solution."""
    parser = argparse.ArgumentParser(description=__doc__)
    for name in ("direct", "hybrid", "fe", "full"):
        parser.add_argument(
            f"--{name}", type=int, default=0, metavar="N", help=f"number of drives for {name}; default 0"
        )
    parser.add_argument("--out", type=Path, default=Path("out/practical_models.json"))
    arguments = parser.parse_args()
    arguments.out.parent.mkdir(parents=True, exist_ok=True)
    report: dict[str, dict[str, Any]] = {}
    unanswered = 0
    for name in ("direct", "hybrid", "fe", "full"):
        rows, seed = report.setdefault(name, {}), 0
        while len(rows) < getattr(arguments, name):
            drive, angle = practical_drive(seed)
            plane = drive.crank_bearing.roller_length == drive.disc.thickness
            if plane or name in ("direct", "hybrid"):
                rows[str(seed)] = try_model(name, drive, angle)
                unanswered += not rows[str(seed)]["answered"]
                arguments.out.write_text(json.dumps(report, indent=1) + "\n", encoding="utf-8")
                print(f"{name}, seed {seed}: {rows[str(seed)]}", flush=True)
            seed += 1
        if rows:
            ratios = [row["pin_load_by_tables"] for row in rows.values() if row["answered"]]
            low, high = min(ratios), max(ratios)
            print(
                f"{name}: {len(ratios)} of {len(rows)} answered, largest pin load {low:.3f} … {high:.3f} relative to tables"
            )
    return 1 if unanswered else 0


if __name__ == "__main__":
    sys.exit(main())
