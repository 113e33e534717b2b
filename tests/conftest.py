"""Drives the tests share: the paper's, variations of it, and random ones of other sizes and tooth numbers."""

from __future__ import annotations

import copy
import os
import tomllib
from collections.abc import Callable
from typing import Any

for _variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    # Before numpy comes: threads of several libraries on two cores wait for each other.
    os.environ.setdefault(_variable, "1")

import numpy as np
import pytest

from ltca.drive.parts import Drive
from ltca.errors import DriveError
from ltca.reading.drive_file import build_drive, load_drive, parse_drive, shipped_drive


@pytest.hookimpl(tryfirst=True, optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Give every worker a run of files, and let the one that is done take of the other's: fixtures are made once."""
    if config.getoption("dist") != "load":
        return None
    from xdist.scheduler import WorkStealingScheduling

    return WorkStealingScheduling(config, log)


def _merge(below: dict[str, Any], over: dict[str, Any]) -> dict[str, Any]:
    for key, value in over.items():
        if isinstance(value, dict) and isinstance(below.get(key), dict):
            _merge(below[key], value)
        else:
            below[key] = value
    return below


@pytest.fixture(scope="session")
def paper_cases() -> dict[str, Drive]:
    """The paper's drive in its six cases."""
    return load_drive("paper").cases


@pytest.fixture(scope="session")
def paper_table() -> Callable[..., dict[str, Any]]:
    """Return a function that gives the plain tables of the paper's drive, some fields replaced."""

    def table(**over: Any) -> dict[str, Any]:
        base = tomllib.loads(shipped_drive())
        del base["case"]
        base.pop("tolerances", None)
        return _merge(base, copy.deepcopy(over))

    return table


@pytest.fixture(scope="session")
def vary(paper_table: Callable[..., dict[str, Any]]) -> Callable[..., Drive]:
    """Return a function that builds the paper's drive with some fields replaced, fully checked."""
    return lambda **over: build_drive(paper_table(**over))


@pytest.fixture(scope="session")
def kinds_of_drives(vary: Callable[..., Drive]) -> dict[str, Drive]:
    """The shipped drives, one with 99 sharp lobes, and a plastic one whose flank, holes and bore are not as designed."""
    shipped = {
        name: next(iter(parse_drive(shipped_drive(name), name).cases.values()))
        for name in ("paper", "rv", "robot-joint", "sleeved")
    }
    sharp = {"number_of_pins": 100, "pin_radius": 1.3}
    many = vary(
        name="many",
        crank={"eccentricity": 0.72},
        pin_wheel=sharp,
        pin_shaft={"hole_radius": 10.82},
        disc={"number_of_teeth": 99, "equidistant_offset": 0.02, "shifting_offset": 0.01},
    )
    waves = {"orders": [2, 13, 60], "cosine": [0.004, -0.002, 0.0005], "sine": [0.001, 0.002, 0.0]}
    plastic = vary(
        name="plastic",
        disc={
            "profile_errors": waves,
            "runout": {"amount": 0.01, "angle": 0.7},
            "hole_errors": {"diameter": [0.02] * 8, "radial": [0.01, *[0.0] * 7]},
        },
        clearance={"bearing": 0.03, "pin_hole": 0.05},
        materials={"disc": "PA12"},
    )
    return {**shipped, "many": many, "plastic": plastic}


@pytest.fixture(scope="session")
def random_drives() -> list[Drive]:
    """Six sound drives of random size, tooth number, eccentricity, offsets, clearances and part errors."""
    rng = np.random.default_rng(20240611)
    drives: list[Drive] = []
    while len(drives) < 6:
        pins = int(rng.integers(7, 41))
        radius = rng.uniform(30.0, 200.0)
        eccentricity = rng.uniform(0.4, 0.75) * radius / pins
        pin_radius = rng.uniform(0.25, 0.55) * radius * np.sin(np.pi / pins)
        inner, roller = 0.2 * radius, rng.uniform(0.05, 0.07) * radius
        bore = inner + 2.0 * roller
        rollers = int(rng.uniform(0.6, 0.95) * np.pi / np.arcsin(roller / (inner + roller)))
        root = radius - eccentricity - pin_radius
        holes = int(rng.integers(5, 11))
        circle = 0.5 * (bore + root)
        hole = 0.8 * min(0.5 * (root - bore), circle * np.sin(np.pi / holes))
        size = 2e-4 * radius

        def errors(count: int, size: float = size) -> dict[str, list[float]]:
            return {
                name: (size * rng.uniform(-0.2, 0.2, count)).tolist() for name in ("radial", "tangential", "diameter")
            }

        pocket = errors(rollers)
        del pocket["radial"]
        table: dict[str, Any] = {
            "name": f"random{len(drives)}",
            "crank": {"eccentricity": eccentricity},
            "pin_wheel": {
                "number_of_pins": pins,
                "pin_circle_radius": radius,
                "pin_radius": pin_radius,
                "pin_errors": errors(pins),
            },
            "disc": {
                "number_of_teeth": pins - 1,
                "thickness": 0.13 * radius,
                "equidistant_offset": rng.uniform(1.5, 2.0) * size,
                "shifting_offset": rng.uniform(0.3, 1.2) * size,
                "hole_errors": errors(holes),
            },
            "crank_bearing": {
                "inner_race_radius": inner,
                "outer_race_radius": bore,
                "number_of_rollers": rollers,
                "roller_radius": roller,
                "roller_length": 0.1 * radius,
                "roller_errors": pocket,
            },
            "pin_shaft": {
                "number_of_pins": holes,
                "pin_circle_radius": circle,
                "pin_radius": hole - eccentricity,
                "hole_radius": hole,
                "stiffness": 1.1e4 * radius,
                "pin_errors": errors(holes),
            },
            "load": {"torque": 0.5 * radius**3, "direction": "ccw" if len(drives) % 2 else "cw"},
            "clearance": {"bearing": rng.uniform(0.0, 2.0) * size, "pin_hole": rng.uniform(0.0, 2.0) * size},
        }
        try:
            drives.append(build_drive(table))
        except DriveError:  # a random drive may be unsound: the checks say so, the next one is drawn
            continue
    return drives
