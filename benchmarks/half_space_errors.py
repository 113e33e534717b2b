"""How far half-spaces are off on the shipped drives: ``python benchmarks/half_space_errors.py``, some minutes of derivations.

Prints for each case the ratio of half-space to hybrid in what decides, beside the ratio that is told of a half-space analysis
(`ltca.analysis.half_space_errors`); ``--write`` replaces those.
"""

from __future__ import annotations

import argparse
import sys
from math import nan
from pathlib import Path

import numpy as np

sys.path[0] = str(Path(__file__).resolve().parents[1])  # the package fem, not the benchmark of that name

from ltca.analysis.engines import Engine, HalfSpace, Hybrid
from ltca.analysis.half_space_errors import MEASURED, likeness, measured, measured_with
from ltca.analysis.life.bearing_lives import bearing_lives
from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.summary import summarise
from ltca.analysis.torque_curve import torque_curve
from ltca.drive.parts import Drive
from ltca.geometry.placement import position_angles
from ltca.reading.arguments import SHIPPED_DRIVES
from ltca.reading.drive_file import load_drive

POSITIONS, CURVE_POSITIONS, CURVE_POINTS = 360, 6, 12


def decisive(drive: Drive, engine: Engine, positions: int) -> dict[str, float]:
    """Solve a drive and return what decides about it."""
    analysis = analyse(drive, position_angles(positions), engine=engine)
    summary = summarise(analysis)
    curve = torque_curve(drive, position_angles(CURVE_POSITIONS), points=CURVE_POINTS, engine=engine)

    def refined(name: str) -> float:
        return float(summary[f"refined_{name}"] or 0.0)

    return {
        "stiffness": float(np.mean(curve.stiffness)),
        "life": bearing_lives(analysis).shortest.life,
        "pin_pressure": refined("max_pin_pressure_mid_MPa"),
        "roller_pressure": refined("max_roller_pressure_mid_MPa"),
        "transmission_error": refined("ptp_transmission_error_arcsec"),
    }


def main() -> None:
    """Measure, print and write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", action="store_true", help="replace the ratios that are told, of all drives")
    parser.add_argument(
        "--drive",
        action="append",
        choices=SHIPPED_DRIVES,
        metavar="NAME",
        help="repeatable; default all shipped drives",
    )
    parser.add_argument("--positions", type=int, default=POSITIONS, help=f"of the crank; default {POSITIONS}")
    arguments = parser.parse_args()
    if arguments.write and arguments.drive:
        parser.error("--write replaces the ratios of all drives: leave --drive out")
    lines = ["# Half-space by hybrid, all cases of the shipped drives: python benchmarks/half_space_errors.py --write"]
    known = measured() if MEASURED.exists() else {}
    for name in arguments.drive or SHIPPED_DRIVES:
        cases = load_drive(name).cases
        numbers = likeness(next(iter(cases.values())))
        lines += ["", f"[{name}.likeness]", *(f"{key} = {value:.6g}" for key, value in numbers.items())]
        for case, drive in cases.items():
            engines: tuple[Engine, ...] = (HalfSpace(), Hybrid().with_coefficients(drive))
            first, second = (decisive(drive, engine, arguments.positions) for engine in engines)
            found = {key: value / second[key] for key, value in first.items() if second[key]}
            reported = known.get(name, {}).get("cases", {}).get(case, {}).get("ratio", {})
            for key, value in found.items():
                print(f"{name:<12} {case:<8} {key:<20} {value:.3f}  told {reported.get(key, nan):.3f}", flush=True)
            ratios = ", ".join(f"{key} = {value:.3f}" for key, value in found.items())
            lines += [
                "",
                f"[{name}.cases.{case}]",
                f'measured_with = "{measured_with(drive)}"',
                f"ratio = {{ {ratios} }}",
            ]
    if arguments.write:
        MEASURED.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
