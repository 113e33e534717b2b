"""Yields: intervals against tail sums of the binomial distribution, limits of drive files, samples that count."""

from __future__ import annotations

from dataclasses import replace
from math import comb

import numpy as np
import pytest

from ltca.commands.program import main
from ltca.drive.members.limits import Limit, parse_limits
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive, shipped_drive
from ltca.studies.designs import ToleranceDesign
from ltca.studies.sensitivity import is_chance
from ltca.studies.tolerance_study import tolerance_study
from ltca.studies.yields import Judged, find_yield, independent_samples, interval, limits_of


@pytest.fixture(scope="module")
def paper():
    return load_drive("paper")


@pytest.mark.parametrize(("kept", "samples"), [(0, 10), (1, 10), (7, 10), (95, 100), (100, 100)])
def test_ends_of_the_interval_leave_a_fortieth_on_each_side(kept, samples):
    """Clopper and Pearson's definition: with the part at an end, so many or more (less) samples have probability α/2."""
    found = interval(kept, samples)

    def probability(part, counts):
        return sum(comb(samples, k) * part**k * (1.0 - part) ** (samples - k) for k in counts)

    # sums of a hundred terms, each to round-off
    if kept:
        assert probability(found.low, range(kept, samples + 1)) == pytest.approx(0.025, rel=1e-9)
    if kept < samples:
        assert probability(found.high, range(kept + 1)) == pytest.approx(0.025, rel=1e-9)
    assert found.low <= found.part <= found.high
    mirrored = interval(samples - kept, samples)
    assert (mirrored.low, mirrored.high) == pytest.approx((1.0 - found.high, 1.0 - found.low), abs=1e-12)


def judged(quantity, sense, value):
    return Judged(quantity=quantity, limit=Limit(quantity=quantity, sense=sense, value=value, source="here"))


def test_samples_are_counted_by_each_limit_and_by_all_together(paper):
    """Of ten samples one has no answer; two other ones break a limit each, one of these both."""
    design = replace(tolerance_study(paper, case="CS-6", samples=10, positions=1).design, sequence="random")
    load = np.array([1.0, 2.0, 9.0, 1.0, np.nan, 1.0, 1.0, 1.0, 1.0, 1.0])
    efficiency = np.array([0.9, 0.9, 0.5, 0.6, np.nan, 0.9, 0.9, 0.9, 0.9, 0.8])
    limits = (
        judged("max_pin_load", "max", 2.0),
        judged("mean_efficiency", "min", 0.8),
        judged("power_loss", "max", 1.0),
    )
    found = find_yield(limits, {"max_pin_load": load, "mean_efficiency": efficiency}, design, {})
    assert [kept.kept for _, kept in found.each] == [8, 7]
    assert (found.together.kept, found.together.samples) == (7, 10)
    assert found.not_judged == {"max_power_loss": "power_loss was not asked for"}
    assert find_yield(limits[2:], {"max_pin_load": load}, design, {}) is None


def test_only_independent_samples_of_saltelli_blocks_count(paper):
    """All but the first two of a block share their numbers with these."""
    factors = tolerance_study(paper, case="CS-6", samples=10, positions=1).design.factors
    design = ToleranceDesign(factors=factors, samples=100, seed=0, sequence="saltelli")
    size = len(design.groups) + 2
    chosen = independent_samples(design)
    assert [number % size in (0, 1) for number in range(100)] == chosen.tolist()
    rows = design.rows(0, size)
    assert all(np.any(row == rows[0]) for row in rows[2:])  # shared numbers, which no two independent draws have
    assert not np.any(rows[0] == rows[1])


def test_limits_of_file_and_materials_are_judged_where_studies_know_the_quantity(paper):
    drive = paper.cases["CS-6"]
    limits = parse_limits(
        {"max_backlash_output": 3.0, "min_wall": 1.0, "min_mean_efficiency": 0.9, "max_pin_pressure_mid": 1400.0}, []
    )
    found, left = limits_of(drive, limits)
    bounds = {one.quantity: one.limit.value for one in found}
    assert bounds["max_backlash_output"] == 3.0
    assert bounds["max_pin_pressure_mid"] == 1400.0  # of the file, in place of the 1500 of its material
    assert bounds["max_pin_shaft_pressure_mid"] == drive.materials.disc.allowable_pressure
    assert set(left) == {"min_wall", "min_mean_efficiency"}
    assert "friction" in left["min_mean_efficiency"]


def test_limits_are_told_in_the_unit_of_their_quantity(tmp_path, capsys):
    """A limit of 1.5, meant in GPa, was pointed out by `check` and judged every sample in silence here; angles and forces carry
    units of their own."""
    drive = load_drive("robot-joint").cases["nominal"]
    texts = {"max_pin_pressure_mid": "1.4 GPa", "max_backlash_output": "0.05 deg", "max_pin_load": "1.5 kN"}
    bounds = {one.quantity: one.bound for one in limits_of(drive, parse_limits(texts, []))[0]}
    assert bounds["max_pin_pressure_mid"] == "≤ 1400 MPa"
    assert bounds["max_backlash_output"] == "≤ 3′"  # 0.05 degrees
    assert bounds["max_pin_load"] == "≤ 1500 N"
    path = tmp_path / "joint.toml"
    text = shipped_drive("robot-joint").replace("[limits]\n", "[limits]\nmax_pin_pressure_mid = 1.5\n", 1)
    path.write_text(text, encoding="utf-8")
    small = [
        "--samples",
        "2",
        "--positions",
        "2",
        "--quantities",
        "max_pin_pressure_mid",
        "--no-figures",
        "--no-page",
        "--quick",
    ]
    assert main(["tolerance", str(path), *small, "--out", str(tmp_path / "out")]) == 0
    told = capsys.readouterr()
    assert "warning: limits.max_pin_pressure_mid = 1.5 MPa is 1/" in told.err
    assert 'did you mean "1.5 GPa" (1500 MPa)?' in told.err
    assert "≤ 1.5 MPa" in told.out


def test_races_of_different_strength_are_judged_apart(paper):
    """A printed disc and steel rollers: the larger of both pressures says nothing of the weaker race."""
    drive = with_fields(
        paper.cases["CS-6"], {"materials.disc.allowable_pressure": 73.0, "materials.disc.youngs_modulus": 3000.0}
    )
    bounds = {one.quantity: one.limit.value for one in limits_of(drive, {})[0]}
    assert bounds["max_roller_pressure_mid_outer"] == 73.0
    assert bounds["max_roller_pressure_mid_inner"] == drive.materials.inner_race.allowable_pressure
    assert "max_roller_pressure_mid" not in bounds
    # Beside 4000 MPa of all rollers in the file, 73 MPa is the one limit of the bore.
    found, _ = limits_of(drive, parse_limits({"max_roller_pressure_mid": 4000.0}, []))
    races = [(one.quantity, one.limit.value) for one in found if "roller" in one.quantity]
    assert races == [("max_roller_pressure_mid_outer", 73.0), ("max_roller_pressure_mid_inner", 4000.0)]
    study = tolerance_study(replace(paper, cases={"CS-6": drive}, limits={"CS-6": {}}), samples=5, positions=1)
    assert {"max_roller_pressure_mid_outer", "max_roller_pressure_mid_inner"} <= set(study.quantities)


def test_a_rank_is_of_chance_up_to_what_chance_gives():
    entry = {"shares": {"one": 0.3, "two": 0.01}, "chance": {"one": 0.02, "two": 0.02}}
    assert (is_chance(entry, "one"), is_chance(entry, "two")) == (False, True)
    assert not is_chance({"shares": {"one": 0.0}}, "one")  # Sobol indices tell no chance
