"""What is said of a single drive in the end is solved finely: the optimum and where it started."""

from __future__ import annotations

import argparse
import json

import numpy as np
import pytest
from pyarrow import parquet

from ltca.analysis.engines import HalfSpace
from ltca.analysis.extremes import refine_extremes
from ltca.analysis.loaded_analysis import analyse
from ltca.commands import optimise
from ltca.geometry.placement import position_angles
from ltca.reading.drive_file import load_drive
from ltca.studies.fine_solution import solve_finely
from ltca.studies.optimiser import Bound, Problem, broken_limits
from ltca.studies.quantities import OF_FRICTION, OF_WIDTH, STAGES, quantities_for

ARCMIN, ARCSEC = 10_800.0 / np.pi, 648_000.0 / np.pi


@pytest.fixture(scope="module")
def drive():
    return load_drive("paper").cases["CS-1"]


@pytest.mark.slow
def test_every_quantity_finely(drive):
    """Means over the positions, extremes of the search, the backlash over many more positions."""
    names = quantities_for(drive, ("all",))
    found = solve_finely(drive, names, HalfSpace(), 60)
    assert found.positions == 60
    assert tuple(found.values) == names
    assert set(STAGES) - set(names) == {*OF_FRICTION, *OF_WIDTH}
    analysis = analyse(drive, position_angles(60))
    refined = refine_extremes(analysis)
    total = np.hypot(analysis.bearing_radial, analysis.bearing_tangential)
    for name, value in {
        "ptp_transmission_error": refined.values["ptp_transmission_error"],
        "ptp_transmission_error_light": refined.values["ptp_transmission_error_light"],
        "mean_transmission_error": analysis.full.pose[:, 3].mean() * ARCSEC,
        "max_pin_load": refined.values["max_pin_load"],
        "max_bearing_load": refined.values["max_bearing_load"],
        "ptp_tangential_bearing_load": refined.values["ptp_tangential_bearing_load"],
        "mean_bearing_load": total.mean(),
    }.items():
        assert found.values[name] == pytest.approx(value, rel=1e-9), name
    # the paper's drive: about 10′ at the wheel
    assert 9.5 < found.values["min_backlash_wheel"] < found.values["mean_backlash_wheel"] < 10.5


def test_limits_broken_when_solved_finely(drive):
    limits = (
        Bound(quantity="max_pin_load", sense=1, value=100.0),
        Bound(quantity="min_backlash_wheel", sense=-1, value=8.0),
    )
    problem = Problem(drive=drive, variables=(), aims=("max_pin_load",), limits=limits)
    assert broken_limits(problem, {"max_pin_load": 100.00001, "min_backlash_wheel": 8.1}) == ()
    assert broken_limits(problem, {"max_pin_load": 100.1, "min_backlash_wheel": 8.1}) == limits[:1]
    assert broken_limits(problem, {"max_pin_load": 99.0, "min_backlash_wheel": 7.9}) == limits[1:]


@pytest.mark.slow
def test_optimum_is_told_finely(tmp_path, capsys):
    """It announced what its few positions saw: 2.71″ where a fine run reads 3.35″."""
    parser = argparse.ArgumentParser()
    optimise.configure(parser)
    words = ["paper", "--case", "CS-3", "--vary", "equidistant_offset=0.15:0.2", "--minimise", "ptp_transmission_error"]
    words += ["--subject", "max_pin_load <= 3556 N", "--positions", "4", "--generations", "1", "--no-figures"]
    assert optimise.execute(parser.parse_args([*words, "--out", str(tmp_path)])) == 0
    told = capsys.readouterr()
    kept = json.loads((tmp_path / "optimum.json").read_text(encoding="utf-8"))
    error = kept["quantities"]["ptp_transmission_error"]
    assert (kept["positions"], kept["positions_of_candidates"], error["units"]) == (360, 4, "arcsec")
    assert kept["compliance"] == "half-space"
    for name, place in (("as_it_is", load_drive("paper").cases["CS-3"]), ("found", tmp_path / "optimum.toml")):
        one = place if name == "as_it_is" else load_drive(place).cases["nominal"]
        fine = refine_extremes(analyse(one, position_angles(360)))
        assert error[name] == pytest.approx(fine.values["ptp_transmission_error"], rel=1e-9)
        coarse = analyse(one, position_angles(4)).full.pose[:, 3]
        assert error[f"{name}_in_search"] == pytest.approx(np.ptp(coarse) * ARCSEC, rel=1e-6)
        assert error[name] > 1.1 * error[f"{name}_in_search"]
        assert f"{error[name]:.5g}" in told.out
    assert "360 positions, refined" in told.out
    assert "4 positions see 4 phases" in told.err
    # the limit stands between what four positions see of this drive and what it carries
    load = kept["quantities"]["max_pin_load"]
    assert load["found_in_search"] <= 3556.0 < load["found"]
    assert kept["broken_limits"] == ["max_pin_load <= 3556 N"]
    assert "beyond max_pin_load <= 3556 N when solved finely" in told.out
    schema = parquet.read_schema(tmp_path / "candidates.parquet")
    units = {name: schema.field(name).metadata[b"units"].decode() for name in schema.names}
    assert units == {
        "disc.equidistant_offset": "mm", "ptp_transmission_error": "arcsec", "max_pin_load": "N", "feasible": "1", "front": "1"
    }  # fmt: skip
    assert all(schema.field(name).metadata[b"description"] for name in schema.names)
