"""Integrators of runs in time: processor time at equal error of scipy's DOP853, Radau, BDF and LSODA.

    OPENBLAS_NUM_THREADS=1 python benchmarks/integrators.py [NAME …] [--time 0.01] [--speed 1500]

The paper's drive, without and with damping, and a plastic one run steadily on half-spaces from the same start with each
integrator at several tolerances. The error is the largest difference of any pin load from a run of DOP853 at a thousandth of the
tolerance of runs, by the largest load; times at an error are interpolated between measured runs that no other one beats, both
logarithmic. Implicit methods difference their own Jacobians; all keep to the longest step of runs.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import BDF, DOP853, LSODA, Radau, solve_ivp

from ltca.analysis.engines import HalfSpace
from ltca.analysis.time_run import (
    FIRST_STEP,
    RELATIVE_TOLERANCE,
    Course,
    PreparedRun,
    longest_step,
    prepare_run,
)
from ltca.arrays import FloatArray
from ltca.drive.parts import Drive
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive

METHODS = {"DOP853": DOP853, "Radau": Radau, "BDF": BDF, "LSODA": LSODA}
PARTS = (10.0, 1.0, 0.1, 0.01)
"""Tolerances by those of runs."""
REFERENCE = 1e-3
AT_ERRORS = (1e-2, 1e-3, 1e-4)
COMPARED = 101
"""Times at which loads are compared."""


def drives() -> dict[str, Drive]:
    """Return the drives that are run, by name."""
    paper = load_drive("paper").cases["CS-1"]
    path = Path(__file__).parents[1] / "examples" / "drives" / "plastic.toml"
    plastic = with_fields(next(iter(load_drive(path).cases.values())), {"contact.slices": 1})
    return {"paper": paper, "paper, ζ = 0.03": with_fields(paper, {"damping.ratio": 0.03}), "plastic": plastic}


def loads_in_time(run: PreparedRun, states: FloatArray, times: FloatArray) -> FloatArray:
    """Return the loads of all wheel pins at times, shape (times, pins)."""
    found = []
    for at, state in zip(times.tolist(), states.T, strict=True):
        contacts = run.equation.solved(at, state).forces.contacts
        discs, pins = range(contacts.system.discs), contacts.system.pins
        found.append(np.concatenate([contacts.pin_loads(disc)[0, 0, :pins] for disc in discs]))
    return np.array(found)


def solved(drive: Drive, course: Course, method: Any, part: float) -> tuple[FloatArray, float, int, int]:
    """Return the loads of a run, its processor time, s, and how often forces and Jacobians were asked for."""
    run, times = prepare_run(drive, HalfSpace(), course), np.linspace(0.0, course.time, COMPARED)
    first, began = FIRST_STEP / run.fastest, time.process_time()
    answer = solve_ivp(
        run.equation.rates,
        (0.0, course.time),
        run.start,
        method=method,
        t_eval=times,
        max_step=longest_step(run),
        first_step=first,
        rtol=part * RELATIVE_TOLERANCE,
        atol=part * run.tolerances(),
    )
    seconds = time.process_time() - began
    if not answer.success:
        raise RuntimeError(answer.message)
    return loads_in_time(run, answer.y, times), seconds, int(answer.nfev), int(answer.njev)


def at_error(errors: list[float], seconds: list[float], wanted: float) -> str:
    """Return the time at an error in words, between measured runs that no other one beats; a bound beyond them."""
    runs = sorted(zip(errors, seconds, strict=True))
    best = [one for place, one in enumerate(runs) if all(one[1] < before[1] for before in runs[:place])]
    if wanted < best[0][0]:
        return "not reached"
    if wanted > best[-1][0]:
        return f"< {best[-1][1]:.2f} s"
    logs = np.log(np.array(best)).T
    return f"{np.exp(np.interp(np.log(wanted), *logs)):.2f} s"


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(drives())}; default all")
    parser.add_argument("--time", type=float, default=1e-2, help="s")
    parser.add_argument("--speed", type=float, default=1500.0, help="rpm")
    arguments = parser.parse_args()
    course = Course.of_values("steady", arguments.time, arguments.speed)
    for name, drive in drives().items():
        if arguments.names and name not in arguments.names:
            continue
        exact = solved(drive, course, DOP853, REFERENCE)[0]
        print(f"{name}: {arguments.time:g} s at {arguments.speed:g} rpm")
        for label, method in METHODS.items():
            errors, seconds = [], []
            for part in PARTS:
                loads, took, asked, jacobians = solved(drive, course, method, part)
                errors.append(float(np.abs(loads - exact).max() / exact.max()))
                seconds.append(took)
                tolerance = part * RELATIVE_TOLERANCE
                words = f"error {errors[-1]:.1e}, {took:.2f} s, {asked} evaluations, {jacobians} Jacobians"
                print(f"  {label:7s} {tolerance:.0e}: {words}", flush=True)
            told = ", ".join(f"{wanted:.0e}: {at_error(errors, seconds, wanted)}" for wanted in AT_ERRORS)
            print(f"  {label:7s} at errors of {told}")


if __name__ == "__main__":
    main()
