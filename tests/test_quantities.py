"""The registry is the single source of quantities: what runs write is in it, and what is in it is written by some run.

``python -m tests.test_quantities`` writes the schema of the version anew.
"""

from __future__ import annotations

import argparse
import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fem.drive.disc_stress import STRESSES, recover_disc_stress, stress_variables, summarise_stress
from fem.options import SolutionOptions
from fem.reducer.solution import solve_reducer
from fem.reducer.solution_files import ARRAYS, build_dataset as build_fem_dataset, summarise as summarise_fem
from ltca.analysis.engines import HalfSpace
from ltca.analysis.force_dataset import force_dataset
from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.pressure_fields import build_pressure_dataset
from ltca.analysis.results import build_dataset
from ltca.analysis.summary import summarise
from ltca.analysis.time_dataset import time_dataset
from ltca.analysis.time_run import Course, prepare_run, run_in_time
from ltca.analysis.verdict.values import find_values
from ltca.analysis.vibration import vibration
from ltca.quantities import IN_TIME, LIMITED, QUANTITIES, REFINED, SCALARS, SCHEMA_VERSION, Quantity, scalar_named
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import parse_drive, shipped_drive
from ltca.studies.quantities import STAGES

SCHEMA = Path(__file__).parent / "regression" / f"schema_{SCHEMA_VERSION}.json"
SHIPPED = ("paper", "rv", "robot-joint", "sleeved")
RUBBING = """
[ring]
inner_radius = 70.0
outer_radius = 95.0
width = 40.0
[carrier]
stiffness_torsion = 1e9
[friction]
pin = 0.05
seat = 0.05
hole = 0.05
[lubricant]
viscosity = 100.0
contamination = 0.5
[temperature]
disc = 30.0
"""
INDEXES = {"case", "disc", "crank", "position", "pin", "roller", "hole", "slice", "axis", "speed"}
INDEXES |= {f"{part}_order" for part in ("pin", "roller", "hole", "bearing", "main_bearing")}
INFORMATION = {
    "torque_share", "disc_displacement", "disc_displacement_area", "pose_iterations", "dof", "size", "plane_state", "held",
    "fingerprint", "seconds", "seconds_by_stage",
}  # fmt: skip
"""What the summary of `cyclo fem` has beside the arrays of the registry."""


def schema():
    """What is seen outside: arrays with unit and dimensions, keys of summaries, limits and scalars of studies with units."""
    return {
        "arrays": {name: [one.unit, *one.dimensions] for name, one in QUANTITIES.items() if one.of},
        "arrays_in_time": {name: [one.unit, *one.dimensions] for name, one in IN_TIME.items()},
        "summary": [scalar.key for scalar in SCALARS.values() if scalar.in_summary],
        "refined": [scalar.key for scalar in REFINED.values()],
        "fem_summary": [key for name in (*ARRAYS, *STRESSES) for key in _fem_keys(QUANTITIES[name])],
        "limits": {name: scalar.unit for name, scalar in LIMITED.items()},
        "studies": {name: SCALARS[name].unit for name in STAGES},
    }


def _fem_keys(quantity: Quantity):
    return dict.fromkeys((quantity.older_fem_key, quantity.fem_key))


def test_the_registry_is_the_schema_of_its_version():
    """Outside checks read these names: one that changes or goes needs a higher `SCHEMA_VERSION` and a file of its own."""
    assert schema() == json.loads(SCHEMA.read_text(encoding="utf-8"))


def test_a_wrong_unit_is_seen(monkeypatch):
    monkeypatch.setitem(QUANTITIES, "pin_load", replace(QUANTITIES["pin_load"], unit="kN"))
    monkeypatch.setitem(SCALARS, "max_pin_load", replace(SCALARS["max_pin_load"], unit="kN"))
    found, kept = schema(), json.loads(SCHEMA.read_text(encoding="utf-8"))
    assert {name for name in kept if found[name] != kept[name]} == {"arrays", "summary", "fem_summary", "studies"}


def test_scalars_have_the_unit_of_what_they_sum_up():
    """But for angles, which the datasets have in radians, and energies that are told as powers."""
    for quantity in QUANTITIES.values():
        for scalar in quantity.scalars:
            assert scalar.unit in ("", quantity.unit) or (quantity.unit, scalar.unit) in {
                ("rad", "arcsec"),
                ("N mm", "W"),
            }


@pytest.fixture(scope="module")
def drives():
    """The shipped drives; one that rubs, is warm, has an elastic ring and carrier, a soft bearing and a hardened case; one with
    teeth and an arm; one with cranks that twist; one in slices.
    """
    files = {name: parse_drive(shipped_drive(name), name) for name in SHIPPED}
    text = re.sub(r"(?m)^(torque = .*)$", r"\1\nspeed = 1000.0", shipped_drive("sleeved")).replace(
        'disc = { like = "100Cr6",', 'disc = { like = "100Cr6", hardness_depth = 0.5,'
    )
    text = text.replace("[pin_wheel]\n", "[pin_wheel]\nsupport_stiffness = 1e6\n") + RUBBING
    files["rubbing"] = parse_drive(text, "rubbing")
    found = {name: next(iter(file.cases.values())) for name, file in files.items()}
    teeth = {"first_stage.sun_teeth": 20, "first_stage.planet_teeth": 40, "load.external.0.force.x": 100.0,
             "first_stage.plane": 40.0}  # fmt: skip
    teeth |= {"main_bearing.radial_stiffness": 1e6, "main_bearing.axial_stiffness": 1e6}
    twisting = {"crank.support.torsion": True, "crank.support.spline_plane": 40.0}
    wide = {"contact.slices": 5, "disc.lead_slope": 1e-4, "disc.axial_play": 0.1,
            "main_bearing.radial_stiffness": 1e6, "main_bearing.tilt_stiffness": 1e9}  # fmt: skip
    sliced = {"sliced": with_fields(found["paper"], wide)}
    return found | sliced | {"geared": with_fields(found["rv"], teeth), "twisting": with_fields(found["rv"], twisting)}


@pytest.mark.slow
def test_runs_write_what_is_declared_and_nothing_else(drives):
    kept = json.loads(SCHEMA.read_text(encoding="utf-8"))
    arrays, keys, judged = set(), set(), {"carried_torque", "roller_pressure_mid", "roller_pressure_max"}
    for name, drive in drives.items():
        analysis = analyse(drive, np.array([0.1, 1.9]))
        summary = summarise(analysis)
        arrays |= check_arrays(build_dataset(name, {name: analysis}), kept)
        keys |= {re.sub(r"(disc|crank)_\d+", r"\1_#", key) for key in summary}
        judged |= {value.quantity for value in find_values(analysis, summary)}
    analyses = {"CS-1": analyse(drives["paper"], np.array([0.0]))}
    arrays |= check_arrays(build_pressure_dataset("paper", analyses, cells=4), kept)
    yielding = with_fields(drives["paper"], {"main_bearing.radial_stiffness": 1e6})
    shaken = vibration(yielding, engine=HalfSpace(), positions=4, turns=4, torque_parts=())
    arrays |= check_arrays(force_dataset(shaken, None), kept)
    solution = solve_reducer(drives["paper"], 0.5, SolutionOptions(size=6.0))
    stresses = [recover_disc_stress(disc) for disc in solution.discs]
    arrays |= check_arrays(build_fem_dataset(solution, "CS-1").assign(stress_variables(stresses)), kept)
    assert arrays == set(kept["arrays"])
    walls = {scalar_named(f"max_{wall}_stress").key for wall in ("root", "bore", "hole")}  # of fe and hybrid
    assert keys | walls == {*kept["summary"], *(f"refined_{key}" for key in kept["refined"])}
    assert judged == set(LIMITED)
    told = set(summarise_fem(solution) | summarise_stress(stresses)) - INFORMATION
    arrays_of_fem = {QUANTITIES[name].fem_key for name in arrays}
    assert set(kept["fem_summary"]) <= told <= {*kept["fem_summary"], *arrays_of_fem}


@pytest.mark.slow
def test_a_run_in_time_writes_what_is_declared_and_nothing_else():
    """Of two discs on three cranks in slices, so that no two dimensions are alike."""
    drive = with_fields(next(iter(parse_drive(shipped_drive("rv"), "rv").cases.values())), {"contact.slices": 3})
    found = time_dataset(
        run_in_time(prepare_run(drive, HalfSpace(), Course.of_values("steady", 1e-5, 1500.0)), samples=2)
    )
    kept = json.loads(SCHEMA.read_text(encoding="utf-8"))["arrays_in_time"]
    assert found.attrs["schema_version"] == SCHEMA_VERSION
    assert {str(name) for name in found.variables} - {"axis"} == set(kept)
    for name, expected in kept.items():
        assert [found[name].attrs["units"], *found[name].dims] == expected, name
        assert found[name].attrs["long_name"] == IN_TIME[name].description


def check_arrays(dataset, kept):
    """Units, dimensions and descriptions are those of the registry; names of the arrays."""
    assert dataset.attrs["schema_version"] == SCHEMA_VERSION
    names = {str(name) for name in dataset.variables} - INDEXES
    for name in names - {"lobe"}:
        array = dataset[name]
        assert [array.attrs["units"], *array.dims] == kept["arrays"][name], name
        texts = (QUANTITIES[name].description, QUANTITIES[name].in_fem or None)
        assert array.attrs["long_name"].startswith(tuple(filter(None, texts))), name
    return names


if __name__ == "__main__":
    argparse.ArgumentParser(description=f"Write {SCHEMA.name} anew.").parse_args()
    SCHEMA.write_text(re.sub(r"(.{100,}?,) ", r"\1\n", json.dumps(schema())) + "\n", encoding="utf-8")
