"""How near springs are to the beams that they replace: ``python benchmarks/spring_of_pins.py``, some minutes.

Torsional stiffness from the light torque on, on half-spaces, with shaft pins as beams and with the ``pin_shaft.stiffness`` that
`cyclo show` prints for them, of invented drives: pins thick and slender, few and many, with clearance in the holes and without,
tips tied and free, one to three discs, light and heavy torques. What is stated beside that spring
(`ltca.drive.pin_beams.ERROR_TIED`, `ERROR_FREE`) is measured by this.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

sys.path[0] = str(Path(__file__).resolve().parents[1])  # the package fem, not the benchmark of that name

from ltca.analysis.engines import HalfSpace
from ltca.analysis.loaded_analysis import analyse
from ltca.arrays import FloatArray
from ltca.drive.parts import Drive
from ltca.drive.pin_beams import shaft_pin_spring
from ltca.geometry.placement import position_angles
from ltca.reading.drive_file import parse_drive

POSITIONS = 17
BASE = """
name = "beams"
installation = { held = "pin-wheel" }
crank = { eccentricity = 1.5 }
pin_wheel = { number_of_pins = 25, pin_circle_radius = 55.0, pin_radius = 3.0 }
crank_bearing = { inner_race_radius = 12.0, outer_race_radius = 18.0, number_of_rollers = 12, roller_radius = 3.0 }
load = { torque = 180e3 }
clearance = { bearing = 0.0, pin_hole = 0.0 }
materials = { disc = "100Cr6", wheel_pin = "100Cr6", roller = "100Cr6", inner_race = "100Cr6", shaft_pin = "100Cr6" }
[disc]
number_of_teeth = 24
thickness = 9.0
number_of_discs = 2
gap = 1.5
equidistant_offset = 0.0
shifting_offset = 0.0
[pin_shaft]
number_of_pins = 6
pin_circle_radius = 33.0
pin_radius = 4.5
hole_radius = 6.0
beam = { tip = "tied-clamped" }
"""


def pins(radius: float, **changes: float | str) -> dict[str, float | str]:
    """Pins of a radius in holes that fit; other fields by names with two underscores for the dot."""
    fitting = {"pin_shaft.pin_radius": radius, "pin_shaft.hole_radius": radius + 1.5}
    return fitting | {name.replace("__", "."): value for name, value in changes.items()}


FREE = {"pin_shaft__beam__tip": "free"}
PINNED = {"pin_shaft__beam__tip": "tied-pinned"}
BEAMS = {
    "thick": pins(4.5),
    "free": pins(4.5, **FREE),
    "free, one disc": pins(4.5, **FREE, disc__number_of_discs=1, load__torque=90e3),
    "slender": pins(2.0, load__torque=60e3),
    "slender, holes 0.03 mm": pins(2.0, load__torque=60e3, clearance__pin_hole=0.03),
    "three discs": pins(2.5, disc__number_of_discs=3),
    "free, three discs": pins(3.5, **FREE, disc__number_of_discs=3),
    "slender, light, holes 0.02 mm": pins(2.0, load__torque=10e3, clearance__pin_hole=0.02),
    "three pins": pins(2.5, load__torque=60e3, pin_shaft__number_of_pins=3),
    "three thick pins": pins(4.5, pin_shaft__number_of_pins=3),
    "four pins": pins(3.0, load__torque=60e3, pin_shaft__number_of_pins=4),
    "ten pins": pins(3.0, pin_shaft__number_of_pins=10),
    "pinned": pins(4.5, **PINNED),
    "pinned, slender": pins(2.0, **PINNED, load__torque=60e3),
    "pinned, three pins": pins(2.5, **PINNED, load__torque=60e3, pin_shaft__number_of_pins=3),
    "thick, holes 0.03 mm": pins(4.5, clearance__pin_hole=0.03),
    "bearing 0.02 mm": pins(3.0, clearance__bearing=0.02),
    "gap of 6 mm": pins(3.0, disc__gap=6.0),
    "free, slender": pins(2.5, **FREE, load__torque=60e3),
    "free, slender, holes 0.03 mm": pins(2.5, **FREE, load__torque=60e3, clearance__pin_hole=0.03),
    "free, three pins": pins(3.5, **FREE, load__torque=60e3, pin_shaft__number_of_pins=3),
    "thin discs": pins(3.0, load__torque=40e3, disc__thickness=4.0),
    "flank 0.02 mm": pins(3.0, load__torque=90e3, disc__equidistant_offset=0.02),
    "three discs, three pins": pins(3.0, load__torque=60e3, disc__number_of_discs=3, pin_shaft__number_of_pins=3),
}
"""Changes of `BASE`; the first nine are those by which 10 % was found to be too little."""


def stiffnesses(drive: Drive, angles: FloatArray) -> FloatArray:
    """Stiffness from the light torque on at each angle, N·mm/rad."""
    found = analyse(drive, angles, engine=HalfSpace())
    return np.asarray((found.torque - drive.load.light_torque) / found.wind_up)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--positions", type=int, default=POSITIONS, help=f"of the crank; default {POSITIONS}")
    parser.add_argument("--only", choices=BEAMS, metavar="NAME", help="one of the beams")
    arguments = parser.parse_args()
    angles = position_angles(arguments.positions)
    (base,) = parse_drive(BASE).cases.values()
    print(f"{'shaft pins':<32}{'spring':>10}  least    mean   told")
    for name in [arguments.only] if arguments.only else BEAMS:
        beams = base.with_fields(BEAMS[name])
        spring = shaft_pin_spring(beams)
        assert spring is not None
        springs = beams.with_fields({"pin_shaft.stiffness": spring.stiffness})
        bent, sprung = (stiffnesses(drive, angles) for drive in (beams, springs))
        least, mean = (100.0 * (pick(sprung) / pick(bent) - 1.0) for pick in (np.min, np.mean))
        told = spring.accuracy or "the same"
        print(f"{name:<32}{spring.stiffness:>10.4g} {least:+6.1f} % {mean:+6.1f} %  {told}", flush=True)


if __name__ == "__main__":
    main()
