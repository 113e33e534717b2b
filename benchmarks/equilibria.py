"""Equilibria per second of processor time on one core: half-space, ``fe`` and ``hybrid``, and their evaluations.

    python benchmarks/equilibria.py [--coefficients FILE] [--positions 360] [--rounds 3]

A second table has other reducers on tables: discs, fixed wheel, cranks, supports, slices (time relative to the paper's drive).
``fe`` and ``hybrid`` start from the solution on tables as the engines do (included in their time). Without a file of
``cyclo derive paper --case CS-1`` closed-form bodies with fewer stations are used (`ltca.testing.closed_form_bodies`).
Values are the best of several rounds; compare ratios within one run. Evaluations are those of places, laws and flexibility of
all contacts of a position, corrections of deformations and displaced pins among them; kernels are evaluations of Love's kernel
of a line in slices for each loaded contact that an evaluation asks for, 1 in the plane, where laws read a table;
slices that do not feel each other have none.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import argparse
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from ltca.analysis.engines import HalfSpace
from ltca.compliance.coefficients import load_coefficients
from ltca.compliance.coupled import CoupledCompliance
from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.compliance.near_field import NEAR_FIELDS
from ltca.compliance.response import Start
from ltca.drive.parts import Drive, Installation
from ltca.equilibrium.balance import Equilibrium, solve_equilibrium
from ltca.equilibrium.output_torque import solve_at_output
from ltca.equilibrium.reducer import Reducer
from ltca.geometry.placement import position_angles
from ltca.laws.sliced_line import SlicedLine
from ltca.mechanics.contacts import Linearised
from ltca.reading.drive_file import load_drive, parse_drive, shipped_drive
from ltca.testing.closed_form_bodies import closed_form_coefficients


def best(rounds: int, function: Callable[[], Equilibrium]) -> tuple[Equilibrium, float]:
    """Return the last result and the smallest processor time, s."""
    seconds = np.inf
    for _ in range(rounds):
        start = time.process_time()
        answer = function()
        seconds = min(seconds, time.process_time() - start)
    return answer, seconds


def evaluations(function: Callable[[], Equilibrium]) -> tuple[float, float]:
    """Return how often places, laws and flexibility of contacts were evaluated for each position, and in slices how often the
    kernel of a law for each of its loaded contacts: laws of the plane read their table once.
    """
    rows, kernels, loaded = [0], [0], [0]
    plain, coupling = Linearised.__init__, SlicedLine._coupling

    def counted(self: Linearised, *given: Any, **options: Any) -> None:
        plain(self, *given, **options)
        rows[0] += self.angle.size
        if any(self.sliced):
            loaded[0] += int(np.count_nonzero(self.load[:, 0]))

    def counted_kernel(self: SlicedLine, load: np.ndarray, effective_radius: np.ndarray) -> Any:
        kernels[0] += load.shape[1]
        return coupling(self, load, effective_radius)

    Linearised.__init__, SlicedLine._coupling = counted, counted_kernel  # type: ignore[method-assign]
    try:
        found = function()
    finally:
        Linearised.__init__, SlicedLine._coupling = plain, coupling  # type: ignore[method-assign]
    return rows[0] / found.crank_angle.size, kernels[0] / loaded[0] if loaded[0] else 1.0


def one_evaluation(model: Reducer, angles: np.ndarray, pose: np.ndarray) -> float:
    """Return the processor time, s, of one evaluation started from the solution at neighbouring poses."""
    start = Start.after(model.respond(angles, pose))
    began = time.process_time()
    model.respond(angles, pose + 1e-6, start)
    return time.process_time() - began


def other_reducers(paper: Drive) -> dict[str, Drive]:
    """Return drives whose cost should be proportional to the numbers of discs and cranks."""
    rv = parse_drive(shipped_drive("rv"), "rv").cases["nominal"]
    rigid = replace(rv, crank=replace(rv.crank, support=None))
    held = Installation(held="pin-shaft", first_stage_ratio=2.0)
    return {
        "two discs": replace(paper, disc=replace(paper.disc, number_of_discs=2)),
        "three discs": replace(paper, disc=replace(paper.disc, number_of_discs=3)),
        "wheel held": replace(paper, installation=Installation(held="pin-wheel")),
        "sleeved": parse_drive(shipped_drive("sleeved"), "sleeved").cases["nominal"],
        "robot joint": parse_drive(shipped_drive("robot-joint"), "robot-joint").cases["nominal"],
        "rv, rigid, shaft held": replace(rigid, installation=held),
        "rv, rigid": rigid,
        "rv": rv,
        "rv, one disc": replace(rv, disc=replace(rv.disc, number_of_discs=1, phases=(), planes=())),
        "rv, six cranks": replace(rv, crank=replace(rv.crank, number=6)),
        "9 slices": paper.with_fields({"contact.slices": 9}),
        "9 slices, lead slope": paper.with_fields({"contact.slices": 9, "disc.lead_slope": 2e-4}),
        "rv, 9 slices": rv.with_fields({"contact.slices": 9}),
    }


def measure_others(paper: Drive, angles: np.ndarray, rounds: int, base: float) -> None:
    """Print the second table."""
    print(f"\n{'':<24}{'equilibria/s':>14}{'iterations':>12}{'evaluations':>13}{'kernels':>9}{'time by one disc':>18}")
    for name, drive in other_reducers(paper).items():
        model = HalfSpace().prepare(drive).model
        solve = partial(solve_at_output, model, [drive], angles, drive.load.torque)
        found, seconds = best(rounds, solve)
        contacts, kernels = evaluations(solve)
        print(
            f"{name:<24}{angles.size / seconds:>14.0f}{found.iterations.mean():>12.1f}{contacts:>13.1f}{kernels:>9.1f}"
            f"{seconds / base:>18.1f}"
        )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--coefficients", type=Path, help="file of cyclo derive paper --case CS-1")
    parser.add_argument("--positions", type=int, default=360, help="number of positions; default 360")
    parser.add_argument("--rounds", type=int, default=3, help="number of rounds; default 3")
    arguments = parser.parse_args()
    drive = load_drive("paper").cases["CS-1"]
    angles, moment = position_angles(arguments.positions), drive.wheel_moment()
    with tempfile.TemporaryDirectory() as folder:
        path = arguments.coefficients
        if path is None:
            path = Path(folder) / "closed_form.nc"
            closed_form_coefficients(drive, half_width=0.05, depth=300.0).to_netcdf(path, engine="h5netcdf")
        coefficients = load_coefficients(path, drive)
    tables = Reducer(discs=(HalfSpaceCompliance.of_drive(drive),))
    print(f"{angles.size} positions of the paper's CS-1, one core, best of {arguments.rounds}")
    print(
        f"{'':<12}{'equilibria/s':>14}{'iterations':>12}{'evaluations':>13}{'ms/evaluation':>15}{'time by half-space':>20}"
    )
    near, base = best(arguments.rounds, lambda: solve_equilibrium(tables, angles, moment))
    models: dict[str, Reducer] = {"half-space": tables}
    models |= {
        name: Reducer(discs=(CoupledCompliance.of_drive(drive, coefficients, field),))
        for name, field in NEAR_FIELDS.items()
    }
    for name, model in models.items():
        found, seconds, solve = near, base, partial(solve_equilibrium, model, angles, moment)
        if name != "half-space":
            solve = partial(solve_equilibrium, model, angles, moment, near.pose)
            found, seconds = best(arguments.rounds, solve)
            seconds += base
        each = min(one_evaluation(model, angles, found.pose) for _ in range(arguments.rounds)) / angles.size
        print(
            f"{name:<12}{angles.size / seconds:>14.0f}{found.iterations.mean():>12.1f}{evaluations(solve)[0]:>13.1f}"
            f"{1e3 * each:>15.3f}"
            f"{seconds / base:>20.1f}"
        )
    measure_others(drive, angles, arguments.rounds, base)


if __name__ == "__main__":
    main()
