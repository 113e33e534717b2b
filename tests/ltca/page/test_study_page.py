"""Pages of other commands: whole in themselves, names as texts, the same from the same content."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest

from ltca.analysis.torque_curve import torque_curve
from ltca.analysis.verdict.advice import Driver
from ltca.page.packing import unpack
from ltca.page.studies.check import check_page
from ltca.page.studies.curves import torque_section
from ltca.page.study_page import StudyPage, study_page
from ltca.page.tables import number, word


@pytest.fixture(scope="module")
def page(paper_run):
    curve = torque_curve(paper_run[0].drives["CS-1"], np.array([0.0, 0.1]), points=6)
    return curve, study_page(
        StudyPage(name="a </script><b>", told="curves", sections=[torque_section({"CS-1": curve, "CS-1 again": curve})])
    )


def test_curves_are_those_computed(page):
    curve, text = page
    content = json.loads(re.search(r'<script id="data"[^>]*>(.*?)</script>', text, re.S).group(1))
    numbers = unpack(content["places"], re.search(r'<script id="numbers"[^>]*>(.*?)</script>', text, re.S).group(1))
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
