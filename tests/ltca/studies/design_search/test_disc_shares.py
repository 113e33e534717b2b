"""Discs on slender shaft pins: the one near the ring yields more and may carry nothing; such a drive is refused."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import ltca
from ltca.analysis.loaded_analysis import analyse
from ltca.geometry.placement import position_angles
from ltca.studies.design_search.closed_forms import Setting, closed_forms
from ltca.studies.design_search.demands import find_demands
from ltca.studies.design_search.designs import refused_words
from ltca.studies.design_search.enumeration import enumerate_candidates
from ltca.studies.design_search.refinement import Refined
from ltca.studies.design_search.requirement_file import parse_requirements
from ltca.studies.design_search.sizes import Sizes, drive_of
from ltca.studies.design_search.solution import Solution, least_disc_share, solve_coarsely

ASKED = """
discs = 2
held = "pin-wheel"
ratio = 20
torque = "100 N m"
speed = "15 rpm"
outer_diameter = "150 mm"
length = "60 mm"
[shop]
equidistant_offset = 0.1
bearing_clearance = 0.0
pin_hole_clearance = 0.0
[materials]
disc = "100Cr6"
wheel_pin = "100Cr6"
roller = "100Cr6"
inner_race = "100Cr6"
shaft_pin = "100Cr6"
"""


@pytest.fixture(scope="module")
def requirements():
    return parse_requirements(ASKED)


@pytest.mark.slow
def test_a_second_disc_that_carries_nothing_is_refused(requirements):
    """Ranked first was a drive whose second disc carries 1 % of the torque: sixteen shaft pins of 4 mm under discs of 15 mm."""
    demands = find_demands(requirements)
    blind = tuple(one for one in demands if one.kind != "share")
    slender, sound = (enumerate_candidates(requirements, judged, (), 1).sizes.row() for judged in (blind, demands))
    (share,) = (one for one in demands if one.kind == "share")
    lone, shared = (solve_coarsely(row, requirements, demands).values["disc_share"] for row in (slender, sound))
    assert lone < 0.1
    assert share.margin(lone) < 0.0 < share.margin(shared)
    told = {"disc_share": lone}
    refused = Refined(
        row=slender, solution=Solution(values=told), fits=False, given=0.0, broken={"disc_share": 1.0}, relaxed=(),
        solved=1, shifts={},
    )  # fmt: skip
    words = refused_words(SimpleNamespace(tried=(refused,), designs=()))
    assert words.startswith("1 of 1 candidates refused: a disc carries 0.0")
    assert words.endswith("of an even share of the torque, less than 0.5")
    assert refused_words(SimpleNamespace(tried=(replace(refused, broken={}),), designs=())) == ""


@pytest.mark.slow
def test_shares_by_closed_forms_are_on_the_safe_side_and_even_on_stiff_pins(requirements):
    """Linear bodies take every disc as in mesh; clearances of the loaded model share out more evenly. Stiff pins leave halves."""
    setting = Setting.of(requirements)
    row = enumerate_candidates(requirements, find_demands(requirements), (), 1).sizes.row()
    analysis = analyse(drive_of(row, requirements), position_angles(7), engine=ltca.HalfSpace())
    by_forms = float(closed_forms(Sizes.of_rows([row]), setting)["disc_share"][0])
    assert 0.5 * least_disc_share(analysis) < by_forms < least_disc_share(analysis)
    stiff = replace(setting, pin_modulus=1e6 * setting.pin_modulus)
    even = closed_forms(Sizes.of_rows([row]), stiff)["disc_share"]
    np.testing.assert_allclose(even, 1.0, atol=1e-4)  # a millionth of the bending, which is some ten times the rest
    alone = closed_forms(Sizes.of_rows([row | {"discs": 1.0}]), setting)["disc_share"]
    assert alone.tolist() == [1.0]
