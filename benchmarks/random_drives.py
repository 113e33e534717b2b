"""Equilibrium of random valid drives, checked by energies alone: ``python benchmarks/random_drives.py --count N``.

``--practical`` generates drives with practical proportions (`ltca.testing.practical_drives`), ``--preloaded`` drives whose parts
overlap as drawn, ``--cranks`` reducers of all kinds (`ltca.testing.crank_drives`), ``--pins`` reducers with loose, sleeved or
bending pins, ``--friction`` reducers with friction, also with reversed motion (`ltca.testing.pin_drives`). All of these must
be solved. ``--tilted`` generates random reducers with contacts in slices, leads and inclinations, ``--sloping`` reducers of all
kinds with them, whose pins and cranks bend and whose wheels tilt; they are checked in six directions (`ltca.testing.width_check`).
Up to half of the others have an elastic ring, free, bolted or built in.

A solution has to be confirmed by `ltca.testing.balance_check` (residual, complementarity, minimum of the potential) or be a
`ConvergenceError` with its history; anything else counts as wrong and is reported with its seed. Results are written as JSON
regularly, so that a long run can be monitored and interrupted.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from ltca.analysis.engines import HalfSpace
from ltca.analysis.friction.losses import losses
from ltca.drive.parts import Drive
from ltca.equilibrium.friction.turning import TurningFriction
from ltca.equilibrium.output_torque import solve_at_output
from ltca.errors import ConvergenceError
from ltca.testing.balance_check import find_imbalance
from ltca.testing.crank_drives import crank_drive
from ltca.testing.pin_drives import friction_drive, pin_drive, sloping_drive
from ltca.testing.practical_drives import practical_drive, preloaded_drive
from ltca.testing.random_drives import random_reducer, tilted_reducer


def try_friction_drive(seed: int) -> tuple[str, str, int]:
    """Return outcome, details and iterations of a drive with friction, driven by its input and by its output."""
    drive, angle = friction_drive(seed)
    model = HalfSpace().prepare(drive).model
    friction, outcome, problems, iterations = model.friction, "balanced", [], 0
    assert isinstance(friction, TurningFriction)
    for driven_by in ("input", "output"):
        own = replace(drive, load=replace(drive.load, driven_by=driven_by))
        rubs = friction if driven_by == drive.load.driven_by else friction.reversed()
        moving = replace(model, friction=rubs)
        try:
            balanced = solve_at_output(moving, [own], np.array([angle]), drive.load.torque)
        except ConvergenceError as error:
            kind = "convergence error" if error.history else "error without history"
            return kind, f"driven by its {driven_by}: {error}", 0
        found = find_imbalance(own, moving, balanced, torque=drive.load.torque)
        lost = losses(moving, [own], balanced, drive.load.torque)
        if not np.all(np.isfinite(lost.efficiency)) or np.any(lost.total < 0.0):
            found.append(f"efficiency {lost.efficiency}, losses {lost.total} N·mm")
        if driven_by == "output" and np.any(lost.at_input >= 0.0):
            outcome = "balanced, locks itself"
        problems += [f"driven by its {driven_by}: {problem}" for problem in found]
        iterations = max(iterations, int(balanced.iterations[0]))
    return ("wrong" if problems else outcome), "; ".join(problems), iterations


def try_drive(seed: int, draw: Callable[[int], tuple[Drive, float] | None]) -> tuple[str, str, int]:
    """Return outcome, details and iterations of the drive of a seed."""
    if draw is friction_drive:
        return try_friction_drive(seed)
    drawn = draw(seed)
    if drawn is None:
        return "no drive fits", "", 0
    drive, angle = drawn
    try:
        model = HalfSpace().prepare(drive).model
        balanced = solve_at_output(model, [drive], np.array([angle]), drive.load.torque)
    except ConvergenceError as error:
        return ("convergence error" if error.history else "error without history"), str(error), 0
    problems = find_imbalance(drive, model, balanced, torque=drive.load.torque)
    return ("wrong" if problems else "balanced"), "; ".join(problems), int(balanced.iterations[0])


def main() -> int:
    """Solve the drives; exit status 1 if a solution is wrong."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=2000, help="number of drives; default 2000")
    kind = parser.add_mutually_exclusive_group()
    kind.add_argument("--practical", action="store_true", help="drives with practical proportions")
    kind.add_argument(
        "--cranks", action="store_true", help="reducers of all kinds: several cranks, supports, first stages"
    )
    kind.add_argument("--preloaded", action="store_true", help="practical drives whose parts overlap as drawn")
    kind.add_argument("--pins", action="store_true", help="reducers with loose, sleeved and bending pins")
    kind.add_argument("--friction", action="store_true", help="reducers with friction, driven in both directions")
    kind.add_argument("--tilted", action="store_true", help="random reducers with slices, leads and inclinations")
    kind.add_argument("--sloping", action="store_true", help="these of all kinds: beams, supports, wheels that tilt")
    parser.add_argument("--first", type=int, default=0, help="first seed; default 0")
    parser.add_argument("--out", type=Path, default=Path("out/random_drives.json"))
    arguments = parser.parse_args()
    answered = arguments.practical or arguments.preloaded or arguments.cranks or arguments.pins or arguments.friction
    draw = practical_drive if arguments.practical else preloaded_drive if arguments.preloaded else random_reducer
    draw = (
        crank_drive
        if arguments.cranks
        else pin_drive
        if arguments.pins
        else friction_drive
        if arguments.friction
        else tilted_reducer
        if arguments.tilted
        else sloping_drive
        if arguments.sloping
        else draw
    )
    outcomes: Counter[str] = Counter()
    remarks: list[str] = []
    iterations: Counter[int] = Counter()
    began, slowest, slowest_seed = time.perf_counter(), 0.0, -1
    arguments.out.parent.mkdir(parents=True, exist_ok=True)
    for number, seed in enumerate(range(arguments.first, arguments.first + arguments.count), start=1):
        start = time.perf_counter()
        outcome, detail, steps = try_drive(seed, draw)
        taken = time.perf_counter() - start
        if number > 1 and taken > slowest:  # the first drive includes the construction of the contact-law table
            slowest, slowest_seed = taken, seed
        outcomes[outcome] += 1
        iterations[steps] += 1
        if detail:
            remarks.append(f"seed {seed}: {outcome}: {detail}")
        if number % 100 == 0 or number == arguments.count:
            counts = np.array(sorted(iterations.elements()))
            report = {
                "drawn": number,
                "outcomes": dict(outcomes),
                "iterations_median": float(np.median(counts)),
                "iterations_max": int(counts.max()),
                "seconds": round(time.perf_counter() - began, 1),
                "slowest_drive_s": round(slowest, 3),
                "slowest_seed": slowest_seed,
                "remarks": remarks,
            }
            arguments.out.write_text(json.dumps(report, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
            print(f"{number}: {dict(outcomes)}, {report['seconds']} s", flush=True)
    bad = outcomes["wrong"] + outcomes["error without history"]
    return 1 if bad or (answered and outcomes["balanced"] + outcomes["balanced, locks itself"] < arguments.count) else 0


if __name__ == "__main__":
    sys.exit(main())
