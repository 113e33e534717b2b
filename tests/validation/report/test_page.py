"""The page: whole in itself, honest about failures, the same from the same study."""

from __future__ import annotations

import json
import re
from dataclasses import replace

import numpy as np
import pytest

from ltca.drive.members.limits import parse_limits
from validation.compare.model_positions import MODELS
from validation.report.page import write_report
from validation.report.verdict import verdict_content, verdict_lines, verdicts

pytestmark = pytest.mark.slow


def embedded(text):
    found = re.search(r'<script id="data" type="application/json">(.*?)</script>', text, re.S)
    return json.loads(found.group(1))


def test_nothing_is_loaded_from_elsewhere(small_report):
    text = small_report.read_text(encoding="utf-8")
    # the name space of SVG is an identifier, nothing that is fetched
    addresses = set(re.findall(r"https?://[^\s\"'<>]+", text)) - {"http://www.w3.org/2000/svg"}
    assert not addresses
    for attribute in re.findall(r'\b(?:src|href)="([^"]*)"', text):
        assert attribute.startswith(("data:", "#")), attribute
    assert "@import" not in text
    assert "url(" not in text


def test_the_page_knows_every_position(small_report, small_study):
    data = embedded(small_report.read_text(encoding="utf-8"))
    assert [(p["case"], p["angle"]) for p in data["positions"]] == [
        (case, angle) for case in small_study.plan.drives for angle in small_study.plan.crank_angles
    ]
    first = data["positions"][0]
    loads = small_study.compared["CS-1"][0].full.answer.kinds["pin"].load
    drawn = {c["name"]: c["models"]["full FE"][0] for c in first["contacts"]}
    for number in loads.nonzero()[0]:
        assert drawn[f"pin {number}"] == pytest.approx(loads[number], rel=1e-4)
    assert len(data["drives"]["CS-1"]["outline"]) == 13 * 36


def test_contacts_lie_on_the_parts_and_push_on_the_disc(small_report):
    """Distance of contact and part centre is the radius; forces and bearing force balance as drawn."""
    data = embedded(small_report.read_text(encoding="utf-8"))
    for position in data["positions"]:
        centres = {"pin": position["pins"], "roller_outer": position["rollers"], "hole": position["shafts"]}
        total = 0j
        for contact in position["contacts"]:
            if contact["kind"] == "roller_inner":
                continue
            number = int(re.search(r"\d+", contact["name"]).group())
            x, y, radius = centres[contact["kind"]][number]
            at, to = complex(*contact["at"]), complex(*contact["to"])
            assert abs(at - complex(x, y)) == pytest.approx(radius, abs=2e-4)  # places have four digits
            assert abs(to) == pytest.approx(1.0, abs=2e-4)
            total += to * contact["models"]["half-space"][0]
        # The disc is in balance: directions have four digits, and loads of some 10 kN in sum
        assert abs(total) < 5.0


def test_failures_show(small_study, tmp_path):
    good = tuple(row for row in small_study.rows if row.passed)
    bad = replace(good[0], quantity="a <broken> figure", difference=9.0, limit=0.1)
    text = write_report(replace(small_study, rows=(*good, bad)), tmp_path / "bad.html").read_text(encoding="utf-8")
    assert "1 of" in text
    assert "fail their limit" in text
    assert "a &lt;broken&gt; figure" in text
    assert '<tr class="failed">' in text
    fine = write_report(replace(small_study, rows=good), tmp_path / "good.html").read_text(encoding="utf-8")
    assert '<tr class="failed">' not in fine


def test_same_study_same_page(small_study, small_report, tmp_path):
    again = write_report(small_study, tmp_path / "again.html")
    assert again.read_bytes() == small_report.read_bytes()


def test_names_are_text_in_the_page(small_study, tmp_path):
    """'<!--<script>' within a script element keeps '</script>' from ending it, and the page stays empty."""
    odd = "a$x_{b$ <!--<script>\"'&"
    case = "CS-1"
    plan = replace(small_study.plan, name=odd, drives={odd: small_study.plan.drives[case]})
    items = [replace(item, full=replace(item.full, case=odd)) for item in small_study.compared[case]]
    study = replace(
        small_study,
        plan=plan,
        compared={odd: items},
        flexibility={odd: small_study.flexibility[case]},
        coefficients={odd: small_study.coefficients[case]},
        rows=tuple(replace(row, case=odd) for row in small_study.rows if row.case == case),
    )
    text = write_report(study, tmp_path / "odd.html").read_text(encoding="utf-8")
    assert "<!--<script" not in text
    assert text.count("<script") == text.count("</script>")
    assert list(embedded(text)["drives"]) == [odd]


def test_the_drive_is_judged_by_its_limits_in_every_model(small_study):
    """Full solution and models against one limit: the largest over the positions of a case, named where it is."""
    case = next(iter(small_study.compared))
    answers = [item.full.answer.kinds["pin"].pressure for item in small_study.compared[case]]
    largest = max(float(np.nanmax(each)) for each in answers)
    limits = {case: parse_limits({"max_pin_pressure_mid": 0.8 * largest, "max_backlash_output": "1 arcmin"}, [])}
    judged = replace(small_study, plan=replace(small_study.plan, limits=limits))
    checks = {check.value.quantity: check for check in verdicts(judged)[case]["full FE"]}
    assert checks["pin_pressure_mid"].verdict == "fail"
    assert checks["pin_pressure_mid"].safety == pytest.approx(0.8)
    assert "backlash_output" not in checks
    (line,) = [line for line in verdict_lines(judged) if line["case"] == case and line["check"] == "flank pressure"]
    assert line["models"][0] == {"value": f"{largest:.5g}", "verdict": "FAIL"}
    assert len(line["models"]) == 1 + len(MODELS)
    assert verdict_content(judged)[case]["hybrid"]
