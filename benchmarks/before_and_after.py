"""Compare loads and wheel angles of a commit with the working tree: shipped drives on all engines, random drives of all kinds.

    python benchmarks/before_and_after.py HEAD                  # 800 random drives
    python benchmarks/before_and_after.py HEAD --count 60 --keep answers

Both versions read the same drives by ``ltca.load_drive`` and balance them at their torque and at a tenth of it to a residual of
1e-12 of the load. Loads may differ by 1e-9 of the largest of the drive, on coupled bodies by 1e-8, the wheel angle by 1e-6
arc seconds. A larger difference counts as explained where it is less than ten times what the larger residual moves through the
inverse of the tangent (by 1e-6 of the largest load at most); such are listed. Drives that are refused have to remain refused.

All cases of the shipped drives, or of those that ``--drive`` names, run with tables, in nine slices, and on ``fe`` and ``hybrid``
with closed-form bodies (`ltca.testing.closed_form_bodies`); random drives on half-spaces, every tenth on ``hybrid`` as well;
methods of `validation` (contact grids, the paper's iteration) by ``ltca.analyse`` on the shipped drives. ``--keep`` stores the
results of the commit for later comparisons. Exit status 1 if a difference exceeds its bound, 2 for an unknown commit.
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
from summary_numbers import ROOT, add_drive_argument, commit_of, install  # type: ignore[import-not-found]  # beside this script

from ltca.drive.members.temperatures import warm_drive
from ltca.drive.parts import Drive
from ltca.drive.single_discs import single_discs
from ltca.reading.arguments import SHIPPED_DRIVES
from ltca.reading.drive_file import load_drive
from ltca.reading.writing import drive_text
from ltca.testing.closed_form_bodies import closed_form_coefficients
from ltca.testing.crank_drives import crank_drive
from ltca.testing.pin_drives import friction_drive, pin_drive, seated_drive, sloping_drive
from ltca.testing.practical_drives import practical_drive, preloaded_drive
from ltca.testing.random_drives import random_reducer, tilted_reducer

LOAD_BOUND, BODY_BOUND, WHEEL_BOUND = 1e-9, 1e-8, 1e-6
"""Permitted change: of loads, relative to the largest of the drive, the same on coupled bodies, and of the wheel angle, arc
seconds."""
SOFTEST = 1e-6
"""Largest change of loads that what is left over may explain: of a disc that floats the tangent has no inverse."""
LOADS, WHEEL = ("pin_load", "roller_load", "pin_shaft_load"), "wheel_angle"
GENERATORS = (
    random_reducer, crank_drive, pin_drive, friction_drive, preloaded_drive, practical_drive, tilted_reducer, sloping_drive,
    seated_drive,
)  # fmt: skip
ENGINES = ("half-space", "nine slices", "fe", "hybrid", "direct", "paper")
SHIPPED_ANGLES = (0.1, 1.4, 2.6)
SECOND_ANGLE_OFFSET = 0.7
"""Difference between the two crank angles of a random drive, rad."""
PARTS = (1.0, 0.1)
"""Torques, by that of the drive."""

WORKER = """
import json, sys
import numpy as np
import ltca
from ltca.analysis.engines import Hybrid, PlaneStrain, HalfSpace
from ltca.drive.members.temperatures import warm_drive
from ltca.equilibrium import newton
from ltca.equilibrium.balance import lever_arms
from ltca.equilibrium.output_torque import solve_at_output
from ltca.errors import CycloError
from pathlib import Path

newton.TOLERANCE = 1e-12
answers = {}
for job in json.load(open(sys.argv[1], encoding="utf-8")):
    drive = ltca.load_drive(job["file"]).cases[job["case"]]
    angles, name = np.array(job["angles"]), job["name"]
    try:
        if job["engine"] in ("direct", "paper"):
            found = ltca.analyse(drive, crank_angle=angles, method=job["engine"]).dataset
            for variable in sys.argv[3:]:
                answers[name + "|" + variable] = np.asarray(found[variable], dtype=float)
            continue
        if job["engine"] == "nine slices":
            drive = drive.with_fields({"contact.slices": 9})
        paths = [Path(each) for each in job["bodies"]]
        engine = {"fe": PlaneStrain, "hybrid": Hybrid}[job["engine"]](coefficients=paths) if paths else HalfSpace()
        drive = warm_drive(drive)
        model = engine.prepare(drive).model
        found = solve_at_output(model, [drive], angles, job["part"] * drive.load.torque)
    except CycloError as error:
        answers[name + "|refused"] = np.array(type(error).__name__)
        continue
    response, arms = found.response, np.broadcast_to(lever_arms(model), found.pose.shape)
    answers[name + "|pin_load"] = response.pin_load
    answers[name + "|pin_shaft_load"] = response.hole_load
    answers[name + "|roller_load"] = response.rollers.outer_load
    answers[name + "|wheel_angle"] = found.pose[:, -1]
    tangent = response.tangent / (arms[:, :, None] * arms[:, None, :])
    soft = np.linalg.norm(tangent, 2, axis=(1, 2)) * np.linalg.norm(np.linalg.pinv(tangent), 2, axis=(1, 2))
    answers[name + "|unsettled"] = 10.0 * found.residual * soft
np.savez(sys.argv[2], **answers)
"""


def bodies_of(drive: Drive, folder: Path, name: str) -> list[str]:
    """Write closed-form coefficients of the discs of a drive; return their files."""
    found = list[str]()
    for number, single in enumerate(single_discs(warm_drive(drive))):
        found.append(str(folder / f"{name}-{number}.nc"))
        closed_form_coefficients(single, half_width=0.02, depth=300.0).to_netcdf(found[-1], engine="h5netcdf")
    return found


def jobs_of(
    name: str, path: Path, case: str, angles: tuple[float, ...], engine: str, bodies: list[str]
) -> list[dict[str, Any]]:
    """Return the jobs of a drive on an engine: at its torque, and where contacts are balanced directly at a tenth of it."""
    parts = PARTS[:1] if engine in ("direct", "paper") else PARTS
    told = {"file": str(path), "case": case, "angles": angles, "engine": engine, "bodies": bodies}
    return [told | {"name": f"{name}, {engine}, {part:g} T", "part": part} for part in parts]


def shipped_jobs(folder: Path, names: list[str]) -> list[dict[str, Any]]:
    """Return jobs for all cases of shipped drives on all engines; write the coefficient files of ``fe`` and ``hybrid``."""
    jobs = list[dict[str, Any]]()
    for name in names:
        source, written = f"{name}.toml", folder / f"{name}.toml"
        written.write_text((files("ltca.drives") / source).read_text(encoding="utf-8"), encoding="utf-8")
        for case, drive in load_drive(written).cases.items():
            bodies = bodies_of(drive, folder, f"{name}-{case}")
            for engine in ENGINES:
                files_of = bodies if engine in ("fe", "hybrid") else []
                jobs += jobs_of(f"{name}, {case}", written, case, SHIPPED_ANGLES, engine, files_of)
    return jobs


def random_jobs(folder: Path, count: int) -> list[dict[str, Any]]:
    """Return jobs for random drives on half-spaces, from all generators in turn, every tenth on ``hybrid`` as well."""
    jobs, seed, drawn_drives = list[dict[str, Any]](), 0, 0
    while drawn_drives < count:
        generator = GENERATORS[seed % len(GENERATORS)]
        drawn: Any = generator(seed)
        if drawn is not None:
            drive, angle = drawn if isinstance(drawn, tuple) else (drawn, 0.3)
            path = folder / f"{generator.__name__}-{seed}.toml"
            path.write_text(drive_text(drive), encoding="utf-8")
            angles = (angle, angle + SECOND_ANGLE_OFFSET)
            jobs += jobs_of(path.stem, path, "nominal", angles, "half-space", [])
            if drawn_drives % 10 == 0 and drive.contact.slices == 1:
                jobs += jobs_of(path.stem, path, "nominal", angles, "hybrid", bodies_of(drive, folder, path.stem))
            drawn_drives += 1
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


def differences(
    job: str, before: dict[str, NDArray[Any]], after: dict[str, NDArray[Any]]
) -> tuple[float, float, float]:
    """Return the relative change of the loads, the change of the wheel angle in arc seconds, infinite if only one version has a
    solution, and what what is left over may change loads by.
    """
    pairs = {name: (before.get(f"{job}|{name}"), after.get(f"{job}|{name}")) for name in ("refused", WHEEL, *LOADS)}
    if pairs["refused"] != (None, None):
        return (0.0, 0.0, 0.0) if pairs["refused"][0] == pairs["refused"][1] else (np.inf, np.inf, 0.0)

    def apart(name: str) -> float:
        old, new = pairs[name]
        if old is None or new is None or old.shape != new.shape or np.any(np.isnan(old) != np.isnan(new)):
            return np.inf
        return float(np.nanmax(np.abs(new - old), initial=0.0))

    largest = max(max(float(np.nanmax(after[f"{job}|{name}"], initial=0.0)) for name in LOADS), 1e-300)
    unsettled = max(float(np.max(each.get(f"{job}|unsettled", np.zeros(1)))) for each in (before, after)) / largest
    return max(apart(name) for name in LOADS) / largest, np.degrees(apart(WHEEL)) * 3600.0, min(unsettled, SOFTEST)


def main() -> int:
    """Compare, print the differences, and the largest change within round-off."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("before", help="commit")
    add_drive_argument(parser)
    parser.add_argument("--count", type=int, default=800, help="number of random drives (800)")
    parser.add_argument(
        "--keep", type=Path, metavar="FOLDER", help="store the results of the commit here and reuse them"
    )
    arguments = parser.parse_args()
    commit = commit_of(parser, arguments.before)
    names = sorted(set(arguments.drive or SHIPPED_DRIVES))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        jobs = shipped_jobs(folder, names) + random_jobs(folder, arguments.count)
        asked = "-".join([commit[:12], str(arguments.count), *(names if arguments.drive else [])])
        kept = (arguments.keep or folder) / f"{asked}.npz"
        if kept.exists():
            with np.load(kept) as content:
                before = dict(content)
        else:
            kept.parent.mkdir(parents=True, exist_ok=True)
            before = answers_of(install(commit, folder / "before"), jobs, folder / "before.npz")
            (folder / "before.npz").replace(kept)
        after = answers_of(ROOT, jobs, folder / "after.npz")
    worst_load, worst_wheel, moved, explained = 0.0, 0.0, 0, 0
    for job in jobs:
        load, wheel, unsettled = differences(job["name"], before, after)
        bound = BODY_BOUND if job["engine"] in ("fe", "hybrid") else LOAD_BOUND
        told = f"{job['name']}: loads by {load:.1e} of the largest, wheel by {wheel:.1e} arc seconds"
        if load <= bound and wheel <= WHEEL_BOUND:
            worst_load, worst_wheel = max(worst_load, load), max(worst_wheel, wheel)
        elif load <= unsettled:
            explained += 1
            print(f"{told}; what is left over explains {unsettled:.1e}")
        else:
            moved += 1
            print(told)
    refused = sum(name.endswith("|refused") for name in after)
    print(f"{len(jobs)} balances, {refused} refused: {moved} moved, {explained} by no more than is left over;", end=" ")
    print(f"the others by {worst_load:.1e} of the largest load and {worst_wheel:.1e} arc seconds at most")
    return 1 if moved else 0


if __name__ == "__main__":
    sys.exit(main())
