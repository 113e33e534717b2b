"""Equilibrium of random valid drives, checked by energies alone: ``python benchmarks/random_drives.py --count N``.

``--practical`` generates drives with practical proportions (`ltca.testing.practical_drives`), ``--preloaded`` drives
whose parts overlap as drawn, ``--cranks`` reducers of all kinds (`ltca.testing.crank_drives`), ``--pins`` reducers
with loose, sleeved or bending pins, ``--friction`` reducers with friction, also with reversed motion
(`ltca.testing.pin_drives`). All of these must be solved. ``--tilted`` generates random reducers with contacts in
slices, leads and inclinations, ``--sloping`` reducers of all kinds with them, whose pins and cranks bend and whose
wheels tilt, ``--seated`` these with loose pins and sleeves; they are checked in six directions
(`ltca.testing.width_check`), all must be confirmed, and the report says what linear tilts leave out. Up to half of
the others have an elastic ring, free, bolted or built in.

A solution has to be confirmed by `ltca.testing.balance_check` (residual, complementarity, minimum of the potential) or be a
`ConvergenceError` with its history; anything else counts as wrong and is reported with its seed. ``--positions 4`` balances
every drive at crank angles of several turns, half of them under a tenth of its torque. Results are written as JSON every ten
drives, so that a long run can be monitored, interrupted, and continued by the same command with ``--resume``.
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
from ltca.testing.pin_drives import friction_drive, pin_drive, seated_drive, sloping_drive
from ltca.testing.practical_drives import practical_drive, preloaded_drive
from ltca.testing.random_drives import random_reducer, tilted_reducer
from ltca.testing.width_check import WidthCheck

TURN = 2.0 * np.pi * 1.37
"""Crank angle from position to position, rad."""
LIGHT = 0.1
"""Part of the torque at every other position."""


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


def try_drive(
    seed: int,
    draw: Callable[[int], tuple[Drive, float] | None],
    positions: int,
    left_out: list[tuple[float, float, int]],
) -> tuple[str, str, int]:
    """Return outcome, details and iterations of the drive of a seed; what linear tilts leave out is added to a list."""
    if draw is friction_drive:
        return try_friction_drive(seed)
    drawn = draw(seed)
    if drawn is None:
        return "no drive fits", "", 0
    drive, angle = drawn
    problems, iterations = [], 0
    try:
        model = HalfSpace().prepare(drive).model
        for light in (False, True)[:positions]:
            torque = (LIGHT if light else 1.0) * drive.load.torque
            angles = angle + TURN * np.arange(positions, dtype=np.float64)[light::2]
            balanced = solve_at_output(model, [drive], angles, torque)
            for position in range(angles.size):
                problems += find_imbalance(drive, model, balanced, position, torque=torque)
                if drive.contact.slices > 1:
                    left_out.append((*WidthCheck(drive, model, balanced, position).left_out, seed))
            iterations = max(iterations, int(balanced.iterations.max()))
    except ConvergenceError as error:
        return ("convergence error" if error.history else "error without history"), str(error), 0
    return ("wrong" if problems else "balanced"), "; ".join(problems), iterations


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
    kind.add_argument("--seated", action="store_true", help="these with loose pins and sleeves")
    parser.add_argument("--first", type=int, default=0, help="first seed; default 0")
    parser.add_argument("--positions", type=int, default=1, help="positions of each drive without friction; default 1")
    parser.add_argument("--resume", action="store_true", help="go on from the report that --out names")
    parser.add_argument("--out", type=Path, default=Path("out/random_drives.json"))
    arguments = parser.parse_args()
    in_slices = arguments.tilted or arguments.sloping or arguments.seated
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
        else seated_drive
        if arguments.seated
        else draw
    )
    outcomes: Counter[str] = Counter()
    remarks: list[str] = []
    iterations: Counter[int] = Counter()
    left_out: list[tuple[float, float, int]] = []
    slowest, slowest_seed, spent, drawn = 0.0, -1, 0.0, 0
    if arguments.resume and arguments.out.exists():
        before = json.loads(arguments.out.read_text(encoding="utf-8"))
        outcomes.update(before["outcomes"])
        remarks += before["remarks"]
        iterations.update({int(steps): count for steps, count in before["iterations"].items()})
        left_out += [tuple(each) for each in before["left_out"]]
        slowest, slowest_seed, spent, drawn = (
            before[name] for name in ("slowest_drive_s", "slowest_seed", "seconds", "drawn")
        )
    arguments.out.parent.mkdir(parents=True, exist_ok=True)
    began = time.perf_counter() - spent
    for number in range(drawn + 1, arguments.count + 1):
        start, seed = time.perf_counter(), arguments.first + number - 1
        outcome, detail, steps = try_drive(seed, draw, arguments.positions, left_out)
        taken = time.perf_counter() - start
        if number > 1 and taken > slowest:  # the first drive includes the construction of the contact-law table
            slowest, slowest_seed = taken, seed
        outcomes[outcome] += 1
        iterations[steps] += 1
        if detail:
            remarks.append(f"seed {seed}: {outcome}: {detail}")
        if number % 10 == 0 or number == arguments.count:
            counts = np.array(sorted(iterations.elements()))
            report = {
                "drawn": number,
                "outcomes": dict(outcomes),
                "iterations_median": float(np.median(counts)),
                "iterations_max": int(counts.max()),
                "iterations": dict(iterations),
                "seconds": round(time.perf_counter() - began, 1),
                "slowest_drive_s": round(slowest, 3),
                "slowest_seed": slowest_seed,
                "left_out": left_out,
                "remarks": remarks,
            }
            arguments.out.write_text(json.dumps(report, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
        if number % 100 == 0 or number == arguments.count:
            print(f"{number}: {dict(outcomes)}, {report['seconds']} s", flush=True)
    if left_out:
        forces, moments, seeds = (np.array(each) for each in zip(*left_out, strict=True))
        for name, parts in (
            ("forces, by the loads", forces),
            ("moments about x and y, by them times half the width", moments),
        ):
            median, most = f"{np.median(parts):.1e}", int(np.argmax(parts))
            print(f"linear tilts leave out of {name}: median {median}, most {parts[most]:.1e} (seed {seeds[most]})")
    bad = outcomes["wrong"] + outcomes["error without history"]
    solved = outcomes["balanced"] + outcomes["balanced, locks itself"]
    if in_slices:
        return int(solved + outcomes["no drive fits"] < arguments.count)
    return 1 if bad or (answered and solved < arguments.count) else 0


if __name__ == "__main__":
    sys.exit(main())
