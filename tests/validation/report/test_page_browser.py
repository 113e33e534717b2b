"""The page in a real browser (headless chromium): no network, no error, controls that work.

A script added to a copy of the page works the controls as a user's events would and writes down what it sees.
"""

from __future__ import annotations

import re

import pytest

from validation.report.page import write_report

pytestmark = [pytest.mark.needs("chromium"), pytest.mark.slow]

DRIVE = """<script>
addEventListener("load", () => {
  const loads = () => [...document.querySelectorAll("#picture .load")].map(
    n => [n.dataset.model, n.dataset.contact, Number(n.dataset.load)]);
  const button = (group, name) => [...document.querySelectorAll(`#${group} button`)].find(b => b.textContent === name);
  const slider = document.getElementById("angle");
  seen.start = loads();
  seen.startAngle = document.getElementById("angle-text").textContent;
  slider.value = 1;
  slider.dispatchEvent(new Event("input", {bubbles: true}));
  seen.moved = loads();
  seen.movedAngle = document.getElementById("angle-text").textContent;
  seen.bars = document.querySelectorAll("#bars rect").length;
  button("models", "full FE").click();
  seen.model = loads();
  button("cases", "CS-6").click();
  seen.case = loads();
  seen.pressed = [...document.querySelectorAll("button[aria-pressed=true]")].map(b => b.textContent);
  const contact = document.querySelector("#picture .contact");
  const before = document.getElementById("tip").hidden;
  contact.dispatchEvent(new MouseEvent("mouseenter", {clientX: 200, clientY: 200}));
  seen.tip = [before, document.getElementById("tip").hidden, document.getElementById("tip").textContent];
  contact.dispatchEvent(new MouseEvent("mouseleave", {}));
  seen.tipGone = document.getElementById("tip").hidden;
  seen.overflow = document.documentElement.scrollWidth - document.documentElement.clientWidth;
  seen.resources = performance.getEntriesByType("resource").map(e => e.name).filter(n => !n.startsWith("data:"));
  leave();
});
</script>"""


@pytest.fixture(scope="module")
def visited(small_report, chromium, tmp_path_factory):
    return chromium(small_report.read_text(encoding="utf-8"), DRIVE, tmp_path_factory.mktemp("browser"))


def test_no_error_and_no_request(visited):
    seen, console, asked = visited
    assert seen["errors"] == []
    assert console == []
    assert seen["resources"] == []
    assert asked == set()


def test_the_angle_selector_changes_the_drawn_loads(visited, small_study):
    seen, _, _ = visited
    assert seen["startAngle"] != seen["movedAngle"]
    assert seen["start"] != seen["moved"]
    for name, step in (("start", 0), ("moved", 1)):
        item = small_study.compared["CS-1"][step]
        drawn = {contact: load for model, contact, load in seen[name] if model == "half-space"}
        for number, load in enumerate(item.answers["half-space"].kinds["pin"].load):
            if load > 0.0:
                assert drawn[f"pin {number}"] == pytest.approx(load, rel=1e-4)
    contacts = {contact for _, contact, _ in seen["moved"]}
    assert seen["bars"] == 4 + len(contacts) * 5  # a legend, then four bars and a background for each contact


def test_case_and_model(visited, small_study):
    seen, _, _ = visited
    assert {model for model, _, _ in seen["model"]} == {"full FE"}
    assert {model for model, _, _ in seen["moved"]} == {"full FE", "half-space"}
    assert set(seen["pressed"]) == {"CS-6", "full FE"}
    load = small_study.compared["CS-6"][1].full.answer.kinds["pin"].load
    drawn = {contact: value for _, contact, value in seen["case"]}
    assert drawn[f"pin {load.argmax()}"] == pytest.approx(load.max(), rel=1e-4)


def test_hover_tells_all_models(visited):
    seen, _, _ = visited
    before, during, text = seen["tip"]
    assert before
    assert not during
    assert seen["tipGone"]
    for word in ("full FE", "half-space", "fe", "hybrid", "MPa", "µm"):
        assert word in text


@pytest.mark.slow
def test_nothing_sticks_out_on_a_narrow_screen(small_report, chromium, tmp_path):
    text = small_report.read_text(encoding="utf-8")
    seen, console, _ = chromium(text, DRIVE, tmp_path, "500,900")  # chromium's narrowest window
    assert seen["errors"] == []
    assert console == []
    assert seen["overflow"] <= 0


@pytest.mark.slow
def test_every_crank_is_drawn(crank_study, chromium, tmp_path):
    """Its race, its arm, its name; rollers are numbered in every bearing anew; the disc has three openings."""
    page = write_report(crank_study, tmp_path / "report.html")
    script = """<script>addEventListener("load", () => {
      for (const id of ["picture", "totals"]) seen[id] = document.getElementById(id).outerHTML;
      leave();
    });</script>"""
    seen, _, _ = chromium(page.read_text(encoding="utf-8"), script, tmp_path)
    picture, totals = seen["picture"], seen["totals"]
    assert picture.count('class="race"') == 3
    texts = re.findall(r"<text[^>]*>([^<]*)</text>", picture)
    assert texts.count("8") == 1 + 3  # a pin, and the last of nine rollers in each bearing
    assert texts.count("9") == 1
    assert [text for text in texts if text.startswith("crank")] == ["crank 0", "crank 1", "crank 2"]
    (disc,) = re.findall(r'<path d="([^"]*)" fill-rule', picture)
    assert disc.count("M") == 1 + 3
    assert totals.count("bearing of crank") == 6
