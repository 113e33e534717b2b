"""What solid bodies move in a drive: results of the LTCA on plane and on solid coefficients, aligned and with a wheel askew.

``python benchmarks/solid_moves.py`` prints the table "What moves" of docs/theory/solid_bodies.md for CS-1 of the paper's drive
in nine slices with `hybrid`. ``--plane`` and ``--solid`` name coefficient files, by default derived once and kept, solid ones
in some minutes.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

sys.path[0] = str(Path(__file__).resolve().parents[1])  # the package fem, not the benchmark of that name

import ltca
from ltca.reading.changes import with_fields

RADIANS = np.degrees(1.0) * 3600.0


def largest(name: str, factor: float = 1.0) -> Callable[[Any], str]:
    """Return what tells the largest size of a variable."""
    return lambda found: f"{factor * float(np.abs(found[name]).max()):.4g}"


def load_factor(name: str) -> Callable[[Any], str]:
    """Return what tells the largest line load of a kind by the mean line load of that contact."""

    def told(found: Any) -> str:
        line = found[name].transpose(..., "slice").values.reshape(-1, found.sizes["slice"])
        most = line[np.argmax(line.max(axis=1))]
        return f"{most.max() / most.mean():.3f}"

    return told


ROWS: tuple[tuple[str, Callable[[Any], str]], ...] = (
    ("mean wheel angle, arcsec", lambda found: f"{RADIANS * float(found['wheel_angle'].mean()):.2f}"),
    ("largest load of a wheel pin, N", largest("pin_load")),
    ("largest load of a roller, N", largest("roller_load")),
    ("largest load of a shaft pin, N", largest("pin_shaft_load")),
    ("K_Hb of wheel pins, ends included", load_factor("pin_line_load")),
    ("K_Hb of rollers, ends included", load_factor("roller_line_load")),
    ("K_Hb of shaft pins, ends included", load_factor("pin_shaft_line_load")),
    ("largest flank pressure anywhere, MPa", largest("pin_pressure_max")),
    ("largest tilt of the disc, mrad", largest("disc_tilt", 1e3)),
    ("largest moment on the crank bearing, N m", largest("crank_bearing_moment", 1e-3)),
)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("drive", nargs="?", default="paper", help="drive of one disc, default the paper's")
    parser.add_argument("--case", default=None, help="of the drive; default the first")
    parser.add_argument("--positions", type=int, default=28, help="of the crank; default 28")
    parser.add_argument("--plane", default=None, help="coefficients of plane bodies")
    parser.add_argument("--solid", default=None, help="coefficients of solid bodies")
    arguments = parser.parse_args()
    cases = ltca.load_drive(arguments.drive).cases
    drive = with_fields(cases[arguments.case or next(iter(cases))], {"contact.slices": 9})
    inclined = with_fields(drive, {"pin_wheel.inclination.x": 3e-4, "pin_wheel.inclination.y": 2e-4})
    columns, spent = [], []
    for each in (drive, inclined):
        for bodies, file in (("plane", arguments.plane), ("solid", arguments.solid)):
            clock = time.process_time()
            found = ltca.analyse(
                each, arguments.positions, compliance="hybrid", bodies=bodies, coefficients=file
            ).dataset
            spent.append(time.process_time() - clock)
            columns.append(found)
    print(f"{'':<42}" + "".join(f"{title:>16}" for title in ("plane", "solid", "inclined, plane", "inclined, solid")))
    for title, of in ROWS:
        print(f"{title:<42}" + "".join(f"{of(found):>16}" for found in columns))
    print(f"{'processor time, s':<42}" + "".join(f"{each:>16.1f}" for each in spent))


if __name__ == "__main__":
    main()
