"""Torque shares of several discs, by kind and size of manufacturing errors: ``python benchmarks/torque_share.py``.

Drives: robot joint with two and with three discs and the paper's drive (CS-3) with two, at the shipped torque per disc
and at a tenth of it. Errors: a single error of disc 1 (or of one wheel pin), over one turn of the crank, and random errors
from the shipped tolerances. The equilibrium is compared with a spring model: w_k is the wheel angle of disc k alone under an
equal share of the moment T, and K_k its torsional stiffness there. The common wheel angle is w = Σ K_k w_k/Σ K_k, and

    T_k = T/n + K_k (w − w_k),

for two discs T_0 − T_1 = K (w_1 − w_0). A disc carries 10 % more than its equal share (0.55 of two) if its w_k differs from
the common angle by a tenth of the wind-up T/(n K).
"""

from __future__ import annotations

import argparse
import math
import os
import time
from collections.abc import Callable, Mapping
from math import cos, pi, sin

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

from ltca.analysis.engines import HalfSpace
from ltca.arrays import FloatArray
from ltca.drive.parts import Drive
from ltca.drive.single_discs import single_discs
from ltca.drive.tolerances import Factors, Tolerances
from ltca.drive.units.quantities import ARCSEC
from ltca.equilibrium.balance import solve_equilibrium
from ltca.equilibrium.reducer import disc_torques
from ltca.geometry.coordinates import WHEEL_ANGLE
from ltca.geometry.placement import position_angles
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive, parse_drive, shipped_drive

SIZES = (1.0, 2.0, 5.0, 10.0)
"""Sizes of errors, µm."""
OVERLOAD = 0.1
"""Overload of the most heavily loaded disc relative to its equal share: 0.55 for two discs."""
LARGEST = 50.0
"""Largest error in the search for that overload, µm."""
RELATIVE_MOMENT_STEP = 0.01
"""Relative change of the moment for finite-difference stiffnesses."""


def error_fields(drive: Drive) -> dict[str, Callable[[float], dict[str, object]]]:
    """Return for each kind of error a function from its size, mm, to the fields of the drive."""
    pins, e = drive.pin_wheel.number_of_pins, drive.crank.eccentricity

    def pin(size: float) -> dict[str, object]:
        return {"pin_wheel.pin_errors.radial": (-size, *[0.0] * (pins - 1))}

    def circle(size: float) -> dict[str, object]:
        angles = [2.0 * pi * number / pins for number in range(pins)]
        radial = tuple(size * cos(angle) for angle in angles)
        return {
            "pin_wheel.pin_errors.radial": radial,
            "pin_wheel.pin_errors.tangential": tuple(-size * sin(angle) for angle in angles),
        }

    return {
        "runout of disc 1": lambda size: {"disc.of.1.runout.amount": size},
        "phase error of eccentric 1, at e": lambda size: {"crank.of.1.phase_error": size / e},
        "eccentricity error of eccentric 1": lambda size: {"crank.of.1.eccentricity_error": size},
        "one wheel pin pushed in": pin,
        "pin circle off the wheel's axis": circle,
    }


def shares(drive: Drive, angle: FloatArray, torque: float) -> FloatArray:
    """Return the torque shares of the discs, shape (positions, discs)."""
    carried = disc_torques(HalfSpace().prepare(drive).balance(angle, torque).response)
    return np.asarray(carried / carried.sum(axis=1, keepdims=True))


def alone(drive: Drive, angle: FloatArray, torque: float) -> tuple[FloatArray, FloatArray]:
    """Return wheel angle, rad, and stiffness, N·mm/rad, of every disc alone under an equal share, shape (positions, discs)."""
    singles = single_discs(drive)
    part = drive.wheel_moment(torque) / len(singles)
    wheel, slope = [], []
    for single in singles:
        model = HalfSpace().prepare(single).model
        at = [
            solve_equilibrium(model, angle, factor * part)
            for factor in (1.0 - RELATIVE_MOMENT_STEP, 1.0, 1.0 + RELATIVE_MOMENT_STEP)
        ]
        low, middle, high = (found.pose[:, WHEEL_ANGLE] for found in at)
        wheel.append(middle)
        slope.append(2.0 * RELATIVE_MOMENT_STEP * part / (high - low))
    return np.stack(wheel, axis=1), np.stack(slope, axis=1)


def spring_shares(drive: Drive, angle: FloatArray, torque: float) -> FloatArray:
    """Return the shares of springs in parallel, shape (positions, discs)."""
    wheel, slope = alone(drive, angle, torque)
    common = (slope * wheel).sum(axis=1, keepdims=True) / slope.sum(axis=1, keepdims=True)
    return np.asarray(1.0 / wheel.shape[1] + slope * (common - wheel) / drive.wheel_moment(torque))


def size_of_overload(largest: Callable[[float], float], discs: int) -> float | None:
    """Return the error, µm, at which the largest share is 1.1/n within 1 % of the overload; None above `LARGEST`.

    The share is nearly proportional to the error, so the error is scaled iteratively. Where opening or closing contacts make the
    share discontinuous, bisection is used instead.
    """
    goal, size = OVERLOAD / discs, SIZES[0]
    low, high = 0.0, math.inf
    while high - low > max(0.01 * size, 0.001):
        found = largest(size) - 1.0 / discs
        if abs(found / goal - 1.0) < 0.01:
            break
        low, high = (size, high) if found < goal else (low, size)
        if low >= LARGEST:
            return None
        size = min(size * goal / max(found, 0.1 * goal), LARGEST)
        if not low < size < high:
            size = 0.5 * (low + high)
    return size


def print_errors(drive: Drive, angle: FloatArray, torque: float) -> None:
    """Print one row per kind and size of error."""
    discs = drive.disc.number_of_discs
    wheel, slope = alone(drive, angle, torque)
    spring = abs(drive.wheel_moment(torque)) / discs / slope
    slack = solve_equilibrium(
        HalfSpace().prepare(single_discs(drive)[0]).model, angle, 1e-3 * drive.wheel_moment(torque)
    )
    wound = np.abs(wheel[:, 0] - slack.pose[:, WHEEL_ANGLE])
    print(
        f"{drive.name}, {discs} discs, {torque / 1000.0:g} N·m: wind-up of a disc alone {wound.mean() * ARCSEC:.1f}″, "
        f"T/(n K) {spring.mean() * ARCSEC:.1f}″"
    )
    for name, fields in error_fields(drive).items():
        for size in SIZES:
            wrong = with_fields(drive, fields(1e-3 * size))
            found, expected = shares(wrong, angle, torque), spring_shares(wrong, angle, torque)
            print(
                f"  {name:<34}{size:>5g} µm  mean {found[:, 0].mean():.4f} {found[:, 1].mean():.4f}"
                f"  largest {found.max():.4f}  springs {expected.max():.4f}"
            )

        def largest(size: float, fields: Callable[[float], Mapping[str, object]] = fields) -> float:
            return float(shares(with_fields(drive, fields(1e-3 * size)), angle, torque).max())

        needed = size_of_overload(largest, discs)
        told = f"beyond {LARGEST:g}" if needed is None else f"{needed:.1f}"
        print(f"  {name:<34}{told:>5} µm  for a largest share of {(1.0 + OVERLOAD) / discs:.3f}", flush=True)


def print_scatter(
    drive: Drive, tolerances: Tolerances, what: str, samples: int, angle: FloatArray, torque: float
) -> None:
    """Print statistics of the largest and mean shares of random drives."""
    factors = Factors.of_tolerances(drive, tolerances)
    drawn = factors.draw(np.random.default_rng(1).random((samples, len(factors.paths))))
    each = [shares(with_fields(drive, factors.values(row)), angle, torque) for row in drawn]
    largest, means = np.array([share.max() for share in each]), np.array([share.mean(axis=0).max() for share in each])
    goal = (1.0 + OVERLOAD) / drive.disc.number_of_discs
    low, middle, high = np.percentile(largest, (5.0, 50.0, 95.0))
    print(
        f"  {what}, {samples} samples: largest share {low:.4f} {middle:.4f} {high:.4f} (5, 50, 95 %), "
        f"larger mean {np.median(means):.4f} (50 %), {np.percentile(means, 95.0):.4f} (95 %), "
        f"above {goal:.3f} in {100.0 * np.mean(largest > goal):.0f} %",
        flush=True,
    )


def drives() -> dict[str, tuple[Drive, Tolerances]]:
    """Return the drives with their tolerances; the torque per disc is that of the shipped drive."""
    joint = parse_drive(shipped_drive("robot-joint"), "robot-joint")
    nominal = joint.cases["nominal"]
    three = {"disc.number_of_discs": 3, "disc.phases": (), "disc.planes": (), "load.torque": 1.5 * nominal.load.torque}
    paper = load_drive("paper")
    one = paper.cases["CS-3"]
    return {
        "robot-joint": (nominal, joint.tolerances),
        "robot-joint of three discs": (with_fields(nominal, three), joint.tolerances),
        "paper CS-3 with two discs": (
            with_fields(one, {"disc.number_of_discs": 2, "load.torque": 2.0 * one.load.torque}), paper.tolerances,
        ),
    }  # fmt: skip


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--positions", type=int, default=41, help="positions over a turn, coprime to the numbers of teeth and holes"
    )
    parser.add_argument("--samples", type=int, default=200, help="random drives per table; default 200")
    parser.add_argument("--first", type=int, default=3, help="how many of the three drives; default all")
    arguments = parser.parse_args()
    angle = position_angles(arguments.positions)
    began = time.perf_counter()
    for name, (drive, tolerances) in [*drives().items()][: arguments.first]:
        pins = {path: entry for path, entry in tolerances.items() if path.startswith("pin_wheel.pin_errors")}
        for part in (1.0, 0.1):
            torque = part * drive.load.torque
            print(f"\n{name}, {arguments.positions} positions")
            print_errors(drive, angle, torque)
            print_scatter(drive, pins, "tolerances of the wheel pins", arguments.samples, angle, torque)
            print_scatter(drive, tolerances, "all tolerances", arguments.samples, angle, torque)
    print(f"\n{time.perf_counter() - began:.0f} s")


if __name__ == "__main__":
    main()
