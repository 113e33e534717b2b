"""Pages on a narrow screen: no column is lost without a sign, inputs are folded, the curve follows the largest load."""

from __future__ import annotations

import pytest

from ltca.analysis.verdict.advice import Driver
from ltca.page.run_page import run_page
from ltca.page.studies.check import check_page
from ltca.page.study_page import Section, StudyPage, study_page
from ltca.page.tables import Table, number, word
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import DriveFile, parse_drive, shipped_drive

WAIT = 120_000
"""Milliseconds after which a page has failed; it takes half a second on an idle machine."""
pytestmark = [pytest.mark.needs("chromium"), pytest.mark.slow]

WIDTH, HEIGHT = 390, 844
SIGNS = """() => [...document.querySelectorAll(".tablebox")].filter(box => box.offsetWidth).every(box => {
  const wide = box.querySelector(".wide");
  return wide.classList.contains("more") === (wide.scrollWidth - wide.clientWidth - wide.scrollLeft > 2);
})"""
"""Whether every table has its sign, which comes with a frame after the layout."""
LOOK = """() => {
  const seen = {}, boxes = [...document.querySelectorAll(".tablebox")].filter(box => box.offsetWidth);
  seen.tables = boxes.map(box => {
    const wide = box.querySelector(".wide"), sign = box.querySelector(".sign");
    const beyond = wide.scrollWidth - wide.clientWidth, name = box.querySelector("table").dataset.name;
    return [name, beyond, wide.classList.contains("more"), sign.hidden ? "" : sign.textContent];
  });
  const wide = boxes[0].querySelector(".wide");
  wide.scrollLeft = wide.scrollWidth;
  wide.dispatchEvent(new Event("scroll"));
  seen.atTheEnd = [wide.classList.contains("more"), boxes[0].querySelector(".sign").textContent];
  const numbers = [...document.querySelectorAll("#picture .number")].map(text => text.getBoundingClientRect());
  seen.numbers = numbers.length;
  seen.collisions = 0;
  numbers.forEach((a, i) => numbers.slice(i + 1).forEach(b => {
    if (a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom) seen.collisions++;
  }));
  const slider = document.getElementById("angle");
  const told = () => document.querySelector("[data-plot=load] figcaption").textContent;
  const turn = k => { slider.value = k; slider.dispatchEvent(new Event("input", {bubbles: true})); return told(); };
  seen.follows = Array.from({length: Number(slider.max) + 1}, (_, k) => turn(k));
  const contacts = [...document.querySelectorAll("#picture .contact")];
  contacts[contacts.length - 1].dispatchEvent(new MouseEvent("click", {clientX: 20, clientY: 20}));
  seen.picked = [told(), turn(0), turn(1)];
  document.getElementById("follow").click();
  seen.again = turn(2);
  seen.palette = [shade(0), shade(1), matchMedia(DARK).matches];
  return seen;
}"""


@pytest.fixture
def phone(browser, tmp_path):
    """Open a page on a phone; its console must stay empty."""
    console = []
    page = browser.new_page(viewport={"width": WIDTH, "height": HEIGHT})
    page.set_default_timeout(WAIT)
    page.on("console", lambda message: console.append(message.text))
    page.on("pageerror", lambda error: console.append(str(error)))

    def opened(text):
        path = tmp_path / "page.html"
        path.write_text(text, encoding="utf-8")
        page.goto(path.as_uri())
        page.wait_for_function("() => document.documentElement.dataset.ready")
        return page

    yield opened
    page.close()
    assert console == []


def hundred():
    """A robot joint's drive with a hundred pins."""
    drive = next(iter(parse_drive(shipped_drive("robot-joint")).cases.values()))
    fields = {
        "pin_wheel.number_of_pins": 100, "disc.number_of_teeth": 99, "pin_wheel.pin_circle_radius": 110.0,
        "pin_wheel.pin_radius": 2.0, "crank.eccentricity": 0.75,
    }  # fmt: skip
    drive = with_fields(drive, fields)
    return DriveFile(
        name="hundred", source="", cases={"nominal": drive}, tolerances={}, limits={"nominal": {}}, text=""
    )


@pytest.mark.usefixtures("positions_alone")
@pytest.mark.parametrize("kind", ["paper", "hundred"])
def test_a_phone_misses_nothing(kind, paper_run, run_of, phone):
    run, dataset = paper_run if kind == "paper" else run_of(hundred(), positions=5)
    page = phone(run_page(run))
    assert page.evaluate("document.querySelector('[data-name=inputs]').closest('details').open") is False
    page.evaluate("document.querySelectorAll('details').forEach(each => { each.open = true; })")
    page.wait_for_function(SIGNS)
    seen = page.evaluate(LOOK)
    for name, beyond, more, sign in seen["tables"]:
        assert more == (beyond > 2), name
        assert sign == ("more columns →" if beyond > 2 else ""), name
    if kind == "paper":
        assert seen["tables"][0][1] > 2
        assert seen["atTheEnd"] == [False, "← more columns"]
    # Numbers of the hundred pins were on each other, a few pixels high
    assert seen["numbers"] > 20
    assert seen["collisions"] == 0
    load = dataset["pin_load"].isel(case=0, disc=0).transpose("position", "pin").values
    for told, loads in zip(seen["follows"], load, strict=True):
        assert f"wheel pin {loads.argmax()}" in told
    assert len(set(seen["picked"])) == 1
    assert f"wheel pin {load[2].argmax()}" in seen["again"]
    least, most, dark = seen["palette"]
    yellow, navy = "rgb(254,232,56)", "rgb(0,34,78)"
    assert (least, most) == ((navy, yellow) if dark else (yellow, navy))


BROKEN = """() => [...document.querySelectorAll("table thead th, table[data-name=inputs] td:nth-child(3)")].filter(cell => {
  const words = cell.textContent.trim().split(/[\\s-]+/), style = getComputedStyle(cell);
  const pen = document.createElement("canvas").getContext("2d");
  pen.font = `${style.fontWeight} ${style.fontSize} ${style.fontFamily}`;
  const room = cell.clientWidth - parseFloat(style.paddingLeft) - parseFloat(style.paddingRight);
  return cell.clientWidth && Math.max(...words.map(word => pen.measureText(word).width)) > room + 2;
}).map(cell => cell.textContent)"""
"""Headings and units that are broken within a word."""


@pytest.mark.usefixtures("positions_alone")
def test_units_and_headings_were_broken_within_words(paper_run, phone):
    """ "N·m" stood above "m", "kg/m" above "³", "mod" above "e"."""
    page = phone(run_page(paper_run[0]))
    page.evaluate("document.querySelectorAll('details').forEach(each => { each.open = true; })")
    assert page.evaluate(BROKEN) == []
    rows = [[word("1"), word("disc turns (60 %), disc moves along its eccentricity"), *[number(2058.5)] * 3]]
    columns = ["mode", "what moves", "least, Hz", "mean, Hz", "largest, Hz"]
    table = Table(name="modes", caption="", columns=columns, rows=rows, words=1)
    page = phone(study_page(StudyPage(name="x", told="", sections=[Section(heading="Modes", tables=[table])])))
    assert page.evaluate(BROKEN) == []


def test_a_heading_out_of_sight_left_a_gap_above_a_table(paper_run, phone):
    """The last columns of "What drives each value" were two words wide: their headings had six lines, 100 px."""
    checks = {"CS-1": paper_run[0].checks["CS-1"]}
    inputs = ("all sizes", "pin_wheel.pin_circle_radius", "disc.equidistant_offset")
    drivers = {
        "CS-1": {"pin_pressure_mid": [Driver(input=one, elasticity=0.1, change="", factor=None) for one in inputs]}
    }
    page = phone(study_page(check_page("paper", "", "verdict", checks, drivers, {}, {})))
    height, line = page.evaluate(
        "[document.querySelector('table[data-name=drivers] thead').offsetHeight,"
        " parseFloat(getComputedStyle(document.querySelector('table[data-name=drivers] thead th')).lineHeight)]"
    )
    assert height < 4 * line
