"""Pages of other commands: whole in themselves, names as texts, the same from the same content."""

from __future__ import annotations

import json
import re
import tomllib
from types import SimpleNamespace

import numpy as np
import pytest

from ltca.analysis.torque_curve import torque_curve
from ltca.analysis.verdict.advice import Driver
from ltca.commands.actions.study import _value_table
from ltca.errors import DriveError, as_sentences
from ltca.page.packing import unpack
from ltca.page.studies.check import check_page
from ltca.page.studies.curves import torque_section
from ltca.page.studies.optimum import optimum_page
from ltca.page.studies.samples import samples_page, values_of_one_factor
from ltca.page.study_page import Section, StudyPage, study_page
from ltca.page.tables import number, word
from ltca.reading.drive_file import parse_drive, shipped_drive
from ltca.studies.binding import find_binding
from ltca.studies.optimiser import Optimum, Problem, Variable, designs_of_front, front_span
from ltca.studies.run_study import StudySummary
from ltca.studies.study_results import summarise_quantity
from ltca.studies.sweep_file import parse_sweep
from ltca.studies.tolerance_study import tolerance_study
from ltca.studies.yields import find_yield


@pytest.fixture(scope="module")
def page(paper_run):
    curve = torque_curve(paper_run[0].drives["CS-1"], np.array([0.0, 0.1]), points=6)
    return curve, study_page(
        StudyPage(name="a </script><b>", told="curves", sections=[torque_section({"CS-1": curve, "CS-1 again": curve})])
    )


def opened(text):
    """What the scripts of a page are told, and its numbers."""
    content = json.loads(re.search(r'<script id="data"[^>]*>(.*?)</script>', text, re.S).group(1))
    packed = re.search(r'<script id="numbers"[^>]*>(.*?)</script>', text, re.S).group(1)
    return content, unpack(content["places"], packed)


def test_curves_are_those_computed(page):
    curve, text = page
    content, numbers = opened(text)
    assert np.allclose(numbers["plot/0/x"], curve.torque / 1e3, rtol=1e-6)
    mean = np.degrees(np.mean(curve.output_angle, axis=0)) * 60.0
    assert np.allclose(numbers["plot/0/0"], mean, rtol=1e-6, atol=1e-6)
    assert content["plots"][0]["names"] == ["CS-1", "CS-1 again"]
    assert "Means of 2 crank angles" in text


def test_names_are_texts(page):
    text = page[1]
    assert "<h1>a &lt;/script&gt;&lt;b&gt;</h1>" in text
    assert text.count("<script") == text.count("</script>")
    assert "backlash at the output" in text


def test_a_check_tells_what_drives_what(paper_run):
    checks = {"<i>": paper_run[0].checks["CS-1"]}
    driver = Driver(input="disc.thickness", elasticity=-0.5, change="10 mm instead of 8 mm", factor=1.25)
    drivers = {"<i>": {"pin_pressure_mid": [driver]}}
    page = check_page("paper", "name = 1", "verdict", checks, drivers, {"<i>": ["stiff pins"]}, {"positions": "8"})
    text = study_page(page)
    assert study_page(page) == text
    assert "<i>" not in text
    assert "stiff pins" in text
    assert re.search(r"flank pressure</td><td[^>]*>disc.thickness</td><td[^>]*>−0.50</td>", text)


def test_what_all_cases_have_is_told_once(paper_run):
    """Six cases had the same note six times, and what drives the value nearest to its limit stood in the middle."""
    checks = paper_run[0].checks
    cases = list(checks)
    notes = {cases[0]: ["stiff pins", "soft <i>"], cases[1]: ["stiff pins"]}
    drivers = {
        case: {
            check.value.quantity: [Driver(input="load.torque", elasticity=0.5, change="", factor=None)]
            for check in each
        }
        for case, each in checks.items()
    }
    page = check_page("paper", "", "verdict", checks, drivers, notes, {})
    assert list(page.sections[0].notes) == ["stiff pins", f"{cases[0]}: soft <i>"]
    assert [table.folded for table in page.sections[0].tables] == [False, True, True]
    safeties = {check.title: check.safety for check in checks[cases[0]]}
    first = [safeties[row[1].text] for row in page.sections[1].tables[0].rows if row[0].text == cases[0]]
    judged = [safety for safety in first if safety is not None][:5]
    assert judged == sorted(judged)
    assert judged[0] == safeties["flank pressure"]


def test_cells_keep_their_numbers():
    cell = number(-1234.5678, "{:.1f}", "arcsec", note="there")
    assert (cell.text, cell.value, cell.note) == ("−1234.6″", "-1234.5678", "there")
    assert number(float("nan")).text == "–"
    assert word("a-1").text == "a-1"


def summary_of(study, values, ranking=None):
    return StudySummary(
        quantities={name: summarise_quantity(each) for name, each in values.items()},
        nominal={"max_pin_pressure_mid": 1400.0}, ranking=ranking or {"method": "regression", "quantities": {}},
        judged=find_yield(study.judged, values, study.design, study.not_judged), binding=find_binding(study, values),
        failures=(), solved_positions=0, seconds=1.0,
    )  # fmt: skip


def test_a_tolerance_study_shows_yields_histograms_limits_and_ranks_of_chance():
    """Ranks that chance alone gives stood on the page like all others; no limit was on it."""
    file = parse_drive(shipped_drive("paper"))
    asked = ("max_pin_pressure_mid", "max_roller_pressure_mid")
    study = tolerance_study(file, case="CS-6", samples=200, positions=1, quantities=asked)
    pressure = np.linspace(1400.0, 1600.0, 200)
    values = {asked[0]: pressure, asked[1]: pressure}
    field, other = "disc.runout.amount", "crank.eccentricity_error"
    entry = {"explained": 0.9, "shares": {field: 0.6, other: 0.001}, "chance": {field: 0.01, other: 0.01}}
    found = summary_of(study, values, {"method": "regression", "quantities": {asked[0]: entry}})
    text = study_page(samples_page(study, found, values))
    assert text == study_page(samples_page(study, found, values))
    # Clopper–Pearson of 100 in 200, as tables have it
    assert "50.0 % (42.9 … 57.1 %) of the samples keep all limits" in text
    assert re.search(r'class="words chance">crank.eccentricity_error<', text)
    assert re.search(r'class="words ?">disc.runout.amount<', text)
    content, numbers = opened(text)
    flank, roller = content["plots"]
    assert numbers["plot/0/0"].sum() == 200.0
    assert [(mark["name"], mark["shown"]) for mark in flank["marks"]] == [
        ("without deviations", True),
        ("limit ≤ 1500 MPa", True),
    ]
    assert roller["marks"] == [
        {"name": "limit ≤ 4000 MPa, beyond the axis", "value": 4000.0, "shown": False, "colour": "c2", "dashed": True}
    ]


SWEEP = """
drive = "paper"
positions = 1
quantities = ["max_pin_load"]
[design]
kind = "grid"
[factors]
clearance.bearing = [0.0, 0.01, 0.02]
"load.direction" = ["ccw", "cw"]
"""


@pytest.fixture(scope="module")
def swept():
    study = parse_sweep(tomllib.loads(SWEEP), "paper")
    values = {"max_pin_load": np.arange(6.0)}
    return values, study_page(samples_page(study, summary_of(study, values), values))


def test_a_sweep_has_every_sample_over_every_factor(swept):
    values, text = swept
    content, numbers = opened(text)
    assert content["responses"]["quantities"] == ["largest load of a wheel pin [N]"]
    assert [one["title"] for one in content["responses"]["factors"]] == ["clearance.bearing [mm]", "load.direction"]
    assert content["responses"]["factors"][1]["levels"] == ["ccw", "cw"]
    assert np.array_equal(numbers["responses/quantity/0"], values["max_pin_load"])
    assert np.allclose(numbers["responses/factor/0"], [0.0, 0.0, 0.01, 0.01, 0.02, 0.02])
    # Lines join samples alike in the other factor: 0, 2, 4 and 1, 3, 5.
    assert np.array_equal(numbers["responses/path/0"], [0.0, 2.0, 4.0, np.nan, 1.0, 3.0, 5.0], equal_nan=True)


def test_a_sweep_of_three_values_had_mean_and_percentiles_for_them():
    """Up to 12 values of one factor have a row each, on the page as on the screen; 13 values have percentiles."""
    few = SWEEP.replace('"load.direction" = ["ccw", "cw"]', "")
    study = parse_sweep(tomllib.loads(few), "paper")
    values = {"max_pin_load": np.array([3000.0, 3500.0, np.nan])}
    section = next(
        one for one in samples_page(study, summary_of(study, values), values).sections if one.heading == "Values"
    )
    (table,) = section.tables
    assert table.columns == ["clearance.bearing [mm]", "largest load of a wheel pin [N]"]
    assert [[cell.text for cell in row] for row in table.rows] == [["0", "3000"], ["0.01", "3500"], ["0.02", "–"]]
    lines = _value_table(*values_of_one_factor(study), values).splitlines()
    assert [line.split()[-1] for line in lines[-4:]] == ["[N]", "3000", "3500", "–"]
    assert [line.split()[0] for line in lines[-4:]] == ["clearance.bearing", "0", "0.01", "0.02"]
    many = parse_sweep(tomllib.loads(few.replace("[0.0, 0.01, 0.02]", str([0.001 * k for k in range(13)]))), "paper")
    assert values_of_one_factor(many) is None
    assert values_of_one_factor(parse_sweep(tomllib.loads(SWEEP), "paper")) is None
    values = {"max_pin_load": np.arange(13.0)}
    headings = [one.heading for one in samples_page(many, summary_of(many, values), values).sections]
    assert headings == ["Responses", "Over all samples"]


POINTED = """<script>
addEventListener("load", () => {
  const wait = () => {
    if (!document.documentElement.dataset.ready) { setTimeout(wait, 20); return; }
    const select = document.querySelector("[data-responses] select"), svg = document.querySelector("[data-responses] .plot svg");
    select.value = 1;
    select.dispatchEvent(new Event("change"));
    const [, x, y] = svg.querySelector(".dots").getAttribute("d").match(/M([0-9.]+),([0-9.]+)/);
    const box = svg.getBoundingClientRect(), scale = box.width / svg.viewBox.baseVal.width;
    svg.dispatchEvent(new PointerEvent("pointermove", {clientX: box.left + x * scale, clientY: box.top + y * scale}));
    const spot = svg.querySelector(".spot");
    seen.told = document.querySelector("[data-responses] .told").textContent;
    const near = (name, value) => Math.abs(spot.getAttribute(name) - value) < 0.1;
    seen.spot = [spot.getAttribute("visibility"), near("cx", x), near("cy", y)];
    seen.overflow = document.documentElement.scrollWidth - document.documentElement.clientWidth;
    leave();
  };
  wait();
});
</script>"""


@pytest.mark.needs("chromium")
@pytest.mark.slow
def test_the_sample_under_the_pointer_is_told_and_marked(swept, chromium, tmp_path):
    seen, console, asked = chromium(swept[1], POINTED, tmp_path, "500,900")
    assert (seen["errors"], console, asked) == ([], [], set())
    assert seen["told"] == "sample 0: clearance.bearing [mm] 0, load.direction ccw"
    assert seen["spot"] == ["visible", True, True]
    assert seen["overflow"] <= 0


def test_a_front_is_seen_and_its_designs_open():
    """Far candidates squeezed the front into a corner; none of its designs could be opened."""
    drive = parse_drive(shipped_drive("paper")).cases["CS-1"]
    front = np.array([[1.0, 4.0], [2.0, 2.0], [4.0, 1.0]])
    values = np.vstack([front, [[3.0, 3.0], [500.0, 900.0]]])
    aims = ("max_pin_load", "max_roller_load")
    problem = Problem(
        drive=drive, variables=(Variable(path="disc.equidistant_offset", low=0.0, high=1.0),), aims=aims, limits=()
    )
    optimum = Optimum(
        problem=problem, variables=np.linspace(0.1, 0.5, 5)[:, None], values=values, feasible=np.ones(5, dtype=bool),
        start=np.array([5.0, 5.0]), best=1, front=np.arange(3), generations=1,
    )  # fmt: skip
    left, right, low, high = front_span(optimum)
    assert left < 1.0 < 5.0 < right < 20.0
    assert low < 1.0 < 5.0 < high < 20.0
    assert designs_of_front(optimum) == [0, 1, 2]
    quantity = dict.fromkeys(("as_it_is", "found", "as_it_is_in_search", "found_in_search"), 1.0)
    outcome = {
        "variables": {}, "quantities": dict.fromkeys(aims, quantity), "positions": 360, "positions_of_candidates": 28,
        "broken_limits": [], "limits": [], "candidates": 5, "compliance": "hybrid", "candidates_compliance": "half-space",
    }  # fmt: skip
    text = study_page(optimum_page("paper", "told", optimum, outcome, {"front-1.toml": 0, "front-2.toml": 1}, ""))
    assert '<a href="front-2.toml">front-2.toml</a>' in text
    # Columns of values by a coarser engine stood beside those of the finer one without a word.
    assert "as it is, hybrid, 360 positions" in text
    assert "found, half-space, 28 positions" in text
    assert "those of the search, half-space, 28 positions" in text
    content, numbers = opened(text)
    assert content["plots"][0]["range"] == [left, right, low, high]
    assert "1 candidates within the limits lie beyond the axes" in text
    assert numbers["plot/0/x"].tolist() == [1.0, 2.0, 4.0, 3.0, 5.0]


def test_reasons_of_samples_were_cut_within_words():
    """ "2 mistakes crank.eccentricity = …, beyond wha" stood on the page and in the terminal."""
    problems = [
        f"disc.thickness = {number} mm: must be greater than 0 mm, or nothing is left of it" for number in range(9)
    ]
    text = as_sentences(str(DriveError(problems)))
    assert text.startswith("9 mistakes: disc.thickness = 0 mm: must be")
    assert "left of it; disc.thickness = 1 mm" in text
    assert len(text) <= 300
    assert text.endswith(" …")
    assert text.removesuffix(" …").rpartition(" ")[2] in problems[4].split()
    assert as_sentences("one\n  and  another") == "one: and another"


def test_lines_ended_before_a_per_cent_sign_and_within_a_crank_angle():
    sections = [Section(heading="Modes", notes=["disc turns (60 %), φ_C = 5° < 7°"])]
    text = study_page(StudyPage(name="x", told="34 % too large", sections=sections))
    assert "34\N{NO-BREAK SPACE}% too large" in text
    assert "(60\N{NO-BREAK SPACE}%), φ<sub>C</sub>\N{NO-BREAK SPACE}=\N{NO-BREAK SPACE}5° &lt; 7°" in text


def test_of_long_fronts_evenly_many_designs_are_told():
    line = np.linspace(0.0, 1.0, 301)
    optimum = SimpleNamespace(values=np.stack([line, 1.0 - line], axis=1), front=np.arange(301), best=151)
    chosen = designs_of_front(optimum)
    assert 151 in chosen
    assert (chosen[0], chosen[-1]) == (0, 300)
    assert len(chosen) in (24, 25)
    assert np.diff(chosen).max() <= 14  # 300 in 23 parts
