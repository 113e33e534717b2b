"""Compare loads and wheel angles of a commit with the working tree: shipped drives on all engines, random reducers.

    python benchmarks/before_and_after.py HEAD                  # 500 random reducers
    python benchmarks/before_and_after.py HEAD --count 60 --keep answers

A refactoring may change results by round-off only: loads by 1e-9 of the largest load of the drive, the wheel angle by 1e-12
rad; drives that are refused have to remain refused. All cases of the shipped drives run with tables, with contact grids, by
the paper's iteration, and with ``fe`` and ``hybrid`` on closed-form bodies (`ltca.testing.closed_form_bodies`). Random
reducers, on half-spaces, are of all kinds (several discs and cranks, loose and bending pins, friction, preload). Both versions
read the same files by ``ltca.load_drive`` and solve them by ``ltca.analyse``. ``--keep`` stores the results of the commit for
later comparisons. Exit status 1 if a difference exceeds round-off, 2 for an unknown commit.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from summary_numbers import ROOT, commit_of, install  # type: ignore[import-not-found]  # beside this script

from ltca.drive.members.temperatures import warm_drive
from ltca.drive.parts import Drive
from ltca.drive.single_discs import single_discs
from ltca.reading.drive_file import load_drive
from ltca.reading.writing import drive_text
from ltca.testing.closed_form_bodies import closed_form_coefficients
from ltca.testing.crank_drives import crank_drive
from ltca.testing.pin_drives import friction_drive, pin_drive
from ltca.testing.practical_drives import preloaded_drive
from ltca.testing.random_drives import random_reducer

LOAD_BOUND, WHEEL_BOUND = 1e-9, 1e-12
"""Permitted change by round-off: of loads, relative to the largest of the drive, and of the wheel angle, rad."""
LOADS, WHEEL = ("pin_load", "roller_load", "pin_shaft_load"), "wheel_angle"
GENERATORS = (random_reducer, crank_drive, pin_drive, friction_drive, preloaded_drive)
ENGINES: tuple[dict[str, str], ...] = (
    {"compliance": "half-space"},
    {"method": "direct"},
    {"method": "paper"},
    {"compliance": "fe"},
    {"compliance": "hybrid"},
)
SHIPPED_ANGLES = (0.1, 1.4, 2.6, 3.9, 5.2)
HALF_SPACES = {"compliance": "half-space"}
SECOND_ANGLE_OFFSET = 0.7
"""Difference between the two crank angles of a random reducer, rad."""

WORKER = """
import json, sys
import numpy as np
import ltca
from ltca.errors import CycloError

answers = {}
for job in json.load(open(sys.argv[1], encoding="utf-8")):
    try:
        drive = ltca.load_drive(job["file"]).cases[job["case"]]
        found = ltca.analyse(drive, crank_angle=np.array(job["angles"]), **job["options"]).dataset
    except CycloError as error:
        answers[job["name"] + "|refused"] = np.array(type(error).__name__)
        continue
    for variable in sys.argv[3:]:
        answers[job["name"] + "|" + variable] = np.asarray(found[variable], dtype=float)
np.savez(sys.argv[2], **answers)
"""


def shipped_jobs(folder: Path) -> list[dict[str, Any]]:
    """Return jobs for all shipped cases on all engines; write the coefficient files of ``fe`` and ``hybrid``."""
    jobs = []
    for source in sorted(path.name for path in files("ltca.drives").iterdir() if path.name.endswith(".toml")):
        name, written = source.removesuffix(".toml"), folder / source
        written.write_text((files("ltca.drives") / source).read_text(encoding="utf-8"), encoding="utf-8")
        for case, drive in load_drive(written).cases.items():
            bodies = list[str]()
            for number, single in enumerate(single_discs(warm_drive(drive))):
                bodies.append(str(folder / f"{name}-{case}-{number}.nc"))
                data = closed_form_coefficients(single, half_width=0.02, depth=300.0)
                data.to_netcdf(bodies[-1], engine="h5netcdf")
            for engine in ENGINES:
                on_bodies = engine.get("compliance") in ("fe", "hybrid")
                options = engine | ({"coefficients": bodies} if on_bodies else {})
                told = f"{name}, {case}, {'-'.join(engine.values())}"
                jobs.append(
                    {"name": told, "file": str(written), "case": case, "angles": SHIPPED_ANGLES, "options": options}
                )
    return jobs


def random_jobs(folder: Path, count: int) -> list[dict[str, Any]]:
    """Return jobs for random reducers on half-spaces, from all generators in turn; write their drive files."""
    jobs, seed = list[dict[str, Any]](), 0
    while len(jobs) < count:
        generator = GENERATORS[seed % len(GENERATORS)]
        drawn: tuple[Drive, float] | None = generator(seed)
        if drawn is not None:
            drive, angle = drawn
            path = folder / f"{generator.__name__}-{seed}.toml"
            path.write_text(drive_text(drive), encoding="utf-8")
            angles = (angle, angle + SECOND_ANGLE_OFFSET)
            jobs.append(
                {"name": path.stem, "file": str(path), "case": "nominal", "angles": angles, "options": HALF_SPACES}
            )
        seed += 1
    return jobs


def answers_of(source: Path, jobs: list[dict[str, Any]], path: Path) -> dict[str, NDArray[Any]]:
    """Return the results computed by the packages in a folder, by job and variable."""
    asked = path.with_suffix(".json")
    asked.write_text(json.dumps(jobs), encoding="utf-8")
    environment = os.environ | {"PYTHONPATH": str(source), "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    words = [sys.executable, "-c", WORKER, str(asked), str(path), *LOADS, WHEEL]
    subprocess.run(words, env=environment, cwd=path.parent, check=True)
    with np.load(path) as content:
        return dict(content)


def differences(job: str, before: dict[str, NDArray[Any]], after: dict[str, NDArray[Any]]) -> tuple[float, float]:
    """Return the relative change of the loads and the change of the wheel angle; infinite if only one version has a solution."""
    pairs = {name: (before.get(f"{job}|{name}"), after.get(f"{job}|{name}")) for name in ("refused", WHEEL, *LOADS)}
    if pairs["refused"] != (None, None):
        return (0.0, 0.0) if pairs["refused"][0] == pairs["refused"][1] else (np.inf, np.inf)

    def apart(name: str) -> float:
        old, new = pairs[name]
        if old is None or new is None or old.shape != new.shape or np.any(np.isnan(old) != np.isnan(new)):
            return np.inf
        return float(np.nanmax(np.abs(new - old), initial=0.0))

    largest = max(float(np.nanmax(after[f"{job}|{name}"], initial=0.0)) for name in LOADS)
    return max(apart(name) for name in LOADS) / max(largest, 1e-300), apart(WHEEL)


def main() -> int:
    """Compare, print the differences, and the largest change within round-off."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("before", help="commit")
    parser.add_argument("--count", type=int, default=500, help="number of random reducers (500)")
    parser.add_argument(
        "--keep", type=Path, metavar="FOLDER", help="store the results of the commit here and reuse them"
    )
    arguments = parser.parse_args()
    commit = commit_of(parser, arguments.before)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        jobs = shipped_jobs(folder) + random_jobs(folder, arguments.count)
        kept = (arguments.keep or folder) / f"{commit[:12]}-{arguments.count}.npz"
        if kept.exists():
            with np.load(kept) as content:
                before = dict(content)
        else:
            kept.parent.mkdir(parents=True, exist_ok=True)
            before = answers_of(install(commit, folder / "before"), jobs, folder / "before.npz")
            (folder / "before.npz").replace(kept)
        after = answers_of(ROOT, jobs, folder / "after.npz")
    worst_load, worst_wheel, moved = 0.0, 0.0, 0
    for job in jobs:
        load, wheel = differences(job["name"], before, after)
        if load > LOAD_BOUND or wheel > WHEEL_BOUND:
            moved += 1
            print(f"{job['name']}: loads by {load:.1e} of the largest, wheel by {wheel:.1e} rad")
        else:
            worst_load, worst_wheel = max(worst_load, load), max(worst_wheel, wheel)
    refused = sum(name.endswith("|refused") for name in after)
    print(f"{len(jobs)} analyses, {refused} refused: {moved} moved by more than round-off;", end=" ")
    print(f"the others by {worst_load:.1e} of the largest load and {worst_wheel:.1e} rad at most")
    return 1 if moved else 0


if __name__ == "__main__":
    sys.exit(main())
