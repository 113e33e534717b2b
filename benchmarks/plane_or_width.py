"""How far the plane is off: shipped drives with pins that bend, cranks and discs that tilt, in one plane and in 9 slices.

    OPENBLAS_NUM_THREADS=1 python benchmarks/plane_or_width.py

prints the table of ``docs/theory/plane_or_width.md`` (half-space tables, 24 positions, lives over four turns): largest pressure
of flank and roller at mid-width and anywhere, MPa, the least life of a crank bearing, million turns, the stiffness of the cycloid
stage, N·m/′, the largest part of the torque that one disc carries, %, and what the discs tilt by, mrad.
"""

from __future__ import annotations

import argparse
from math import pi
from typing import Any

import numpy as np

import ltca
from ltca import Drive
from ltca.analysis.drive_curves import positions_per_turn
from ltca.analysis.engines import HalfSpace
from ltca.analysis.life.bearing_lives import lives_over, passages_of_duty
from ltca.analysis.loaded_analysis import analyse

POSITIONS, TURNS, SLICES = 24, 4, 9
ARCMIN = pi / 10800.0


def drives() -> dict[str, Drive]:
    """Return the drives by what they are called in the table."""
    paper, joint, rv = (next(iter(ltca.load_drive(name).cases.values())) for name in ("paper", "robot-joint", "rv"))
    bent = {"pin_wheel.beam.ends": "supported"}
    return {
        "paper, wheel pins supported, shaft pins tied": paper.with_fields(
            {**bent, "pin_shaft.beam.tip": "tied-clamped"}
        ),
        "paper, wheel pins supported, shaft pins free": paper.with_fields({**bent, "pin_shaft.beam.tip": "free"}),
        "robot-joint": joint,
        "robot-joint, shaft pins tied": joint.with_fields({"pin_shaft.beam.tip": "tied-clamped"}),
        "robot-joint, shaft pins free": joint.with_fields({"pin_shaft.beam.tip": "free"}),
        "rv": rv,
        "rv, second bearing of the cranks half as stiff": rv.with_fields({"crank.support.stiffness": [4e5, 2e5]}),
    }


def least_life(drive: Drive, turns: int) -> float:
    """Return the least life of a crank bearing at the positions of `ltca.curves`, million turns."""
    loaded = drive.with_fields({"load.light_torque": drive.load.torque})  # nothing of the light torque is told
    each = positions_per_turn(drive)
    lives = []
    for turn in range(turns):
        angle = 2.0 * pi * (turn + np.arange(each) / each)
        lives.append(passages_of_duty(analyse(loaded, angle, engine=HalfSpace())))
    return min(one.life for one in lives_over(lives).bearings)


def numbers(drive: Drive, positions: int, turns: int) -> list[float]:
    """Return the numbers of one row."""
    found: dict[str, Any] = dict(ltca.analyse(drive, positions, compliance="half-space").summary)
    shares = [value for key, value in found.items() if key.startswith("max_torque_share_disc")]
    return [
        found["max_pin_pressure_mid_MPa"],
        found["max_pin_pressure_max_MPa"],
        found["max_roller_pressure_mid_MPa"],
        found["max_roller_pressure_max_MPa"],
        least_life(drive, turns),
        found["cycloid_stage_stiffness_Nmm_per_rad"] * ARCMIN / 1e3,
        100.0 * max(shares),
        1e3 * found.get("max_disc_tilt_rad", 0.0),
    ]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--drive", choices=drives(), help="one of the drives of the table; default all")
    parser.add_argument("--positions", type=int, default=POSITIONS, help=f"of pressures and tilts; default {POSITIONS}")
    parser.add_argument("--turns", type=int, default=TURNS, help=f"of the lives; default {TURNS}")
    arguments = parser.parse_args()
    for name, drive in drives().items():
        if arguments.drive not in (None, name):
            continue
        for slices in (1, SLICES):
            values = numbers(drive.with_fields({"contact.slices": slices}), arguments.positions, arguments.turns)
            print(f"{name:50} {slices}  " + "  ".join(f"{value:8.4g}" for value in values), flush=True)


if __name__ == "__main__":
    main()
