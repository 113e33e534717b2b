"""What stands in the way: single requirements first, pairs where no single one is enough."""

import math
from concurrent.futures import Future
from dataclasses import replace
from itertools import combinations
from types import SimpleNamespace

import numpy as np
import pytest

from ltca.commands.program import main
from ltca.studies.design_search import search, sizes
from ltca.studies.design_search.demands import find_demands
from ltca.studies.design_search.designs import design_text
from ltca.studies.design_search.enumeration import Enumeration
from ltca.studies.design_search.refinement import Refined
from ltca.studies.design_search.requirement_file import parse_requirements
from ltca.studies.design_search.search import Relaxation, find_designs
from ltca.studies.design_search.solution import Solution

STEEL = "\n[materials]\n" + "\n".join(
    f'{part} = "100Cr6"' for part in ("disc", "wheel_pin", "roller", "inner_race", "shaft_pin")
)
# Rollers of 20 mm do not go into a disc of 15 mm, and with a clearance of 20 µm no lever within three times the room leaves
# 0.2 arcmin: either stands in the way alone.
TWO_IN_THE_WAY = """
discs = 1
held = "pin-wheel"
ratio = 19
torque = "60 N m"
speed = "15 rpm"
outer_diameter = "150 mm"
length = "15 mm"
backlash = "0.2 arcmin"
[shop]
equidistant_offset = 0.02
shaft_pin_stiffness = 4.0e5
rollers = [[8.0, 20.0]]
"""


class InTurn:
    """An executor that does all at once."""

    def submit(self, function, *arguments):
        future = Future()
        future.set_result(function(*arguments))
        return future


def made_up(row, given, values, fits):
    return Refined(
        row=row, solution=Solution(values=values), fits=fits, given=given, broken={}, relaxed=(), solved=1, shifts={},
    )  # fmt: skip


def searched(monkeypatch, enough, chances=None):
    """Search where nothing but `enough`, names to ln of the factor, is enough; what closed forms break of pairs: `chances`."""
    asked = []

    def relax(requirements, demands, names):
        asked.append(names)
        giving = tuple(one for one in demands if one.name in names)
        given = enough.get(frozenset(names))
        values = {
            one.quantity: one.value * math.exp((given or 0.0) * (1.0 if one.sense == "max" else -1.0)) for one in giving
        }
        refined = None if given is None else made_up({}, given, values, True)
        return Relaxation(demands=giving, refined=refined, combinations=10, broken=None)

    def least_broken(requirements, demands, names):
        return (chances or {}).get(frozenset(names), 1.0)

    monkeypatch.setattr(search, "refine", lambda task: made_up(task.row, 0.0, {}, False))
    monkeypatch.setattr(search, "relax", relax)
    monkeypatch.setattr(search, "least_broken", least_broken)
    nothing = Enumeration(sizes=None, broken=np.zeros(0), combinations=0)
    monkeypatch.setattr(search, "enumerate_candidates", lambda *arguments, **keys: nothing)
    return find_designs(parse_requirements(TWO_IN_THE_WAY + STEEL), InTurn()), asked


def test_where_one_is_enough_no_pair_is_tried(monkeypatch):
    found, asked = searched(monkeypatch, {frozenset({"torque"}): 0.7, frozenset({"length"}): 0.2})
    assert asked == [
        ("outer_diameter",),
        ("length",),
        ("torque",),
        ("backlash",),
        *((name,) for name in CLEARANCES),
        CLEARANCES,
    ]
    assert [one.name for one in found.relaxations[:2]] == ["length", "torque"]
    assert [one.refined for one in found.relaxations[2:]] == [None] * 6


def test_where_no_single_one_is_enough_pairs_are_tried(monkeypatch):
    enough = {frozenset({"length", "backlash"}): 0.6, frozenset({"torque", "backlash"}): 0.4}
    found, asked = searched(monkeypatch, enough)
    assert not found.designs
    assert len(set(map(frozenset, asked[8:]))) == len(asked[8:]) == 6
    first, second = found.relaxations[:2]
    # The least factor first; each with both of its values.
    assert ({one.name for one in first.demands}, first.refined.given) == ({"torque", "backlash"}, 0.4)
    assert {one.name for one in second.demands} == {"length", "backlash"}
    assert "27.34 mm" in second.words  # 15 mm × e^0.6, rounded up
    assert second.words.endswith("would do")
    assert " with " in second.words
    assert all(one.refined is None for one in found.relaxations[2:])
    assert "not enough together" in found.relaxations[2].words
    assert "not enough alone" in found.relaxations[-2].words


def test_pairs_with_a_chance_are_tried_first_and_no_more_than_said(monkeypatch):
    """The last pair of the list is the likeliest; one that closed forms rule out is not tried."""
    monkeypatch.setattr(search, "MAX_PAIRS", 2)
    named = ("outer_diameter", "length", "torque", "backlash", "shop.equidistant_offset")
    chances = dict.fromkeys(map(frozenset, combinations(named, 2)), math.inf)
    _, asked = searched(monkeypatch, {}, chances | {frozenset({"torque", "backlash"}): 0.1})
    assert [set(names) for names in asked[8:]] == [{"torque", "backlash"}]
    _, asked = searched(monkeypatch, {}, {frozenset({"torque", "backlash"}): 0.1})
    assert [len(names) for names in asked] == [1, 1, 1, 1, 1, 1, 1, 3, 2, 2]
    assert set(asked[8]) == {"torque", "backlash"}


CLEARANCES = ("shop.equidistant_offset", "shop.bearing_clearance", "shop.pin_hole_clearance")


def test_the_obstacle_is_the_one_that_gives_with_least_change(monkeypatch):
    """A diameter of 313.8 mm for 180 was named where 10 µm less offset did: by its square, a factor of 3, against √2."""
    enough = {frozenset({"outer_diameter"}): math.log(313.8 / 180.0), frozenset(CLEARANCES[:1]): math.log(2.0)}
    found, _ = searched(monkeypatch, enough)
    assert [one.name for one in found.relaxations[:2]] == ["shop.equidistant_offset", "outer_diameter"]
    assert found.relaxations[0].words == "shop.equidistant_offset ≥ 0.02 mm: 0.01 mm would do"
    assert found.relaxations[0].change == pytest.approx(0.5 * math.log(2.0), rel=1e-12)
    # Two per cent of diameter are less than half the clearance.
    found, _ = searched(monkeypatch, enough | {frozenset({"outer_diameter"}): math.log(1.02)})
    assert found.relaxations[0].name == "outer_diameter"


def test_designs_that_are_told_differ_by_the_distance_that_is_stated():
    """Three designs were told of which two differed by 2 % of one size."""
    row = dict.fromkeys(sizes.OF_DISTANCE, 10.0)
    near, far = row | {"bore": 11.0, "pin_circle": 10.5}, row | {"pin_radius": 10.0 * math.exp(0.21)}
    told = search._once([made_up(one, 0.0, {}, True) for one in (row, near, far)])
    assert [one.row for one in told] == [row, far]
    # A symmetric measure, root of the sum of squares of ln of ratios, without the holes that an RV reducer has not.
    assert sizes.distance(row, near) == pytest.approx(math.hypot(math.log(1.1), math.log(1.05)), rel=1e-12)
    assert sizes.distance(near | {"holes": 0.0}, row | {"holes": 0.0}) == pytest.approx(
        sizes.distance(row, near), rel=1e-12
    )


def test_a_search_in_vain_ends(monkeypatch):
    """At 1:99 nobody had waited for its end: every relaxation solved up to 36 loaded drives, and those that fitted on half-spaces
    alone had coefficients derived for each step of their sizes."""
    requirements = parse_requirements(TWO_IN_THE_WAY + STEEL)
    demands = find_demands(requirements)
    solved = []

    def refine(task, most=search.MAX_RELAXED_SOLUTIONS):
        solved.append(min(most, 6))
        return replace(made_up(task.row, 0.0, {}, False), solved=solved[-1], shifts={"length": 0.1})

    row = {"discs": 1.0}
    found = Enumeration(
        sizes=SimpleNamespace(count=3, take=lambda place: SimpleNamespace(row=lambda: row)), broken=np.zeros(3),
        combinations=10,
    )  # fmt: skip
    monkeypatch.setattr(search, "refine", refine)
    monkeypatch.setattr(search, "enumerate_candidates", lambda *arguments, **keys: found)
    assert search.relax(requirements, demands, ("length",)).solved == sum(solved) == search.MAX_RELAXED_SOLUTIONS


def test_what_finer_bodies_break_is_the_obstacle(monkeypatch):
    """Drives that fit on half-spaces had "a relaxation of nothing" told, derived again and again, until it was given up."""
    requirements = parse_requirements(TWO_IN_THE_WAY + STEEL)
    coarse = made_up({}, 0.0, {"outer_diameter": 100.0, "length": 15.0}, True)
    values = {"outer_diameter": 100.0, "length": 15.0, "backlash_output": 0.25, "pin_pressure_mid": 1600.0}
    finished = []

    def finish(task, solved=0):
        finished.append(task)
        solution = Solution(values=values, checks=(None,), compliance=task.compliance)
        broken = {"backlash": math.log(1.25)}
        return replace(coarse, solution=solution, fits=False, broken=broken, solved=2)

    sizes_found = SimpleNamespace(count=6, take=lambda place: SimpleNamespace(row=lambda: {"place": place}))
    monkeypatch.setattr(search, "refine", lambda task, most=6: replace(coarse, row=task.row))
    monkeypatch.setattr(search, "_once", list)
    monkeypatch.setattr(search, "finish", finish)
    monkeypatch.setattr(search, "_derivation", lambda requirements, refined: 90.0)
    monkeypatch.setattr(
        search, "enumerate_candidates",
        lambda *arguments, **keys: Enumeration(sizes=sizes_found, broken=np.zeros(6), combinations=10),
    )  # fmt: skip
    monkeypatch.setattr(search, "_stand_in_the_way", lambda *given: pytest.fail("half-spaces have nothing in the way"))
    found = find_designs(requirements, InTurn())
    assert len(finished) == 1  # two derivations of 90 s without a design are enough
    (obstacle,) = found.relaxations
    assert (obstacle.name, obstacle.words) == ("backlash", "backlash ≤ 0.2 arcmin: 0.25 arcmin would do")
    # Where derivations cost little, all candidates are tried.
    monkeypatch.setattr(search, "_derivation", lambda requirements, refined: 1.0)
    finished.clear()
    assert not find_designs(requirements, InTurn()).designs
    assert len(finished) == 6


@pytest.mark.slow
def test_a_pair_that_would_do_does(monkeypatch, tmp_path):
    """Length and backlash by what is known without a search: rollers of 20 mm, and the clearance by the longest lever."""
    monkeypatch.setattr(search, "CANDIDATES", 1)
    monkeypatch.setattr(search, "RELAXED_CANDIDATES", 1)
    requirements = parse_requirements(TWO_IN_THE_WAY + STEEL)
    assert {one.name for one in find_demands(requirements) if one.kind == "requirement"} == {
        "outer_diameter", "length", "torque", "backlash"
    }  # fmt: skip
    found = find_designs(requirements, InTurn(), best=1)
    assert not found.designs
    best = found.relaxations[0]
    assert best.name == "length-and-backlash"
    assert [one.name for one in found.relaxations if one.refined is not None] == [best.name]
    length, backlash = (best.would_do(one) for one in best.demands)
    assert 20.0 <= length <= 3.0 * 15.0
    assert backlash > 2.0 * 0.02 / 75.0  # rad; no lever is longer than the pin circle
    file = tmp_path / "pair.toml"
    file.write_text(design_text(best.refined, found, "pair"))
    assert main(["check", str(file), "--no-advice", "--out", str(tmp_path / "check")]) == 0
