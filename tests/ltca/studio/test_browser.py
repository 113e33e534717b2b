"""The studio in chromium: what is typed is answered as ``cyclo run`` answers it, never mixed; by keyboard, on a phone."""

from __future__ import annotations

import math
import random
import re
import struct
from contextlib import ExitStack, contextmanager
from xml.etree import ElementTree

import pytest

from ltca.analysis.engines import engine_of
from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.summary import summarise
from ltca.analysis.torque_curve import curve_angles, torque_curve
from ltca.analysis.verdict.values import judge_analysis
from ltca.drive.units.quantities import ARCMIN
from ltca.geometry.placement import position_angles
from ltca.page.verdict_tables import verdict_of, verdict_tables
from ltca.reading.drive_file import parse_drive, shipped_drive

from .conftest import asker, studio

pytestmark = [pytest.mark.slow, pytest.mark.needs("studio", "browser", "chromium")]
WAIT = 120_000
"""Milliseconds after which a page that computes has failed; it takes one or two seconds on an idle machine."""


@contextmanager
def pages_of(browser, address):
    """Give a function that opens the studio in a window of its own; its console must stay empty."""
    contexts, console = [], []

    def opened(width=1400, height=900, **options):
        context = browser.new_context(viewport={"width": width, "height": height}, **options)
        contexts.append(context)
        page = context.new_page()
        page.set_default_timeout(WAIT)
        page.on("console", lambda message: console.append(message.text))
        page.on("pageerror", lambda error: console.append(str(error)))
        page.on(
            "request",
            lambda request: request.url.startswith((address, "data:", "blob:")) or console.append(request.url),
        )
        page.goto(address)
        settled(page)
        return page

    yield opened
    for context in contexts:
        context.close()
    assert console == []


@pytest.fixture
def open_page(browser, running):
    """Open the studio of the paper's drive."""
    with pages_of(browser, running.address) as opened:
        yield opened


@pytest.fixture
def open_alone(browser, tmp_path):
    """Open a studio of its own, without jobs, of a drive."""
    with ExitStack() as stack:

        def opened(drive):
            found = stack.enter_context(studio(drive, tmp_path))
            return stack.enter_context(pages_of(browser, found.address))()

        yield opened


def settled(page):
    """Wait until nothing is on its way, and what is shown is fine or refused."""
    page.wait_for_function(
        "() => !queue.length && !pumping && (['fine', 'refused'].includes(document.body.dataset.answer))"
        " && Number(document.body.dataset.sequence) === state.sequence"
    )


def table_of(page, name):
    return page.evaluate("name => tableRows(document.querySelector(`table[data-name=${name}]`))", name)


def as_run_says(text, case, engine=None):
    """Sentence and rows of the verdict as ``cyclo run`` finds them, on half-spaces unless an engine is given."""
    file = parse_drive(text, "paper")
    analysis = analyse(file.cases[case], position_angles(360), None, engine)
    checks = {case: judge_analysis(analysis, summarise(analysis), file.limits[case], lives=False)}
    (table, *_) = [one for one in verdict_tables(checks) if one.name == "verdict"]
    return verdict_of(checks)[0], [[cell.value for cell in row] for row in table.rows]


def assert_same(found, expected):
    assert len(found) == len(expected)
    for mine, theirs in zip(found, expected, strict=True):
        for a, b in zip(mine, theirs, strict=True):
            if re.fullmatch(r"-?[0-9.]+(e[+-]?[0-9]+)?", b):
                assert math.isclose(float(a), float(b), rel_tol=1e-9), (mine, theirs)
            else:
                assert re.sub(r"\s|−", "", a) == re.sub(r"\s|−|-(?=\d)", "", b) or a == b


def type_into(page, path, value):
    page.locator(f'#turned [data-path="{path}"] input[type=text]').fill(value)


def test_an_edit_changes_the_verdict_as_a_run_says(open_page):
    page = open_page()
    before = page.locator("#verdict-line").inner_text()
    type_into(page, "disc.shifting_offset", "0.14")
    type_into(page, "load.torque", "900 N m")
    settled(page)
    text = page.evaluate("state.text")
    assert 'torque = "900 N m"' in text
    assert "# ΔR_C" in text  # comments stay
    sentence, rows = as_run_says(text, "CS-1")
    shown = page.locator("#verdict-line").inner_text()
    assert shown != before
    assert sentence.startswith(shown.lstrip("✓✗ "))
    # One solution by the same functions in another process, of one case alone: round-off of sums.
    assert_same(table_of(page, "verdict")[1:], rows)
    page.keyboard.press("Control+z")
    page.keyboard.press("Control+z")
    settled(page)
    assert page.locator("#verdict-line").inner_text() == before
    page.keyboard.press("Control+Shift+Z")
    settled(page)
    assert page.evaluate("state.values['disc.shifting_offset']") == "0.14"


@pytest.mark.nightly
def test_a_urdf_is_offered_with_a_speed_alone(open_page):
    page = open_page()
    option = page.locator("#simulator option[value=urdf]")
    assert "may take minutes" in page.locator("#simulator-note").inner_text()
    assert option.is_disabled()
    assert "urdf needs load.speed" in page.locator("#urdf-note").inner_text()
    page.evaluate("change('load.speed', '1500')")
    settled(page)
    assert option.is_enabled()
    assert page.locator("#urdf-note").is_hidden()
    page.select_option("#simulator", "urdf")
    page.evaluate("change('load.speed', '')")
    settled(page)
    assert page.locator("#simulate").is_disabled()


@pytest.mark.nightly
def test_a_wrong_field_is_told_beside_it_and_the_older_answer_is_greyed(open_page):
    page = open_page()
    type_into(page, "pin_wheel.pin_radius", "-1")
    page.wait_for_selector("body[data-answer=refused]")
    row = page.locator('#turned [data-path="pin_wheel.pin_radius"]')
    assert "must be greater than 0" in row.locator(".message").inner_text()
    assert row.locator("input[type=text]").get_attribute("aria-invalid") == "true"
    assert float(page.evaluate("getComputedStyle(el('drive')).opacity")) < 0.6
    type_into(page, "pin_wheel.pin_radius", "6.5")
    settled(page)
    assert row.locator(".message").is_hidden()
    type_into(page, "disc.equidistant_offset", "-5")
    offset = page.locator('#turned [data-path="disc.equidistant_offset"]')
    page.wait_for_function("() => el('turn-disc-equidistant-offset').ariaInvalid === 'true'")
    before = offset.locator(".message").inner_text()
    type_into(page, "disc.equidistant_offset", "1e6")  # refused by other fields: the earlier message goes at once
    assert offset.locator(".message").is_hidden() or offset.locator(".message").inner_text() != before
    page.wait_for_function("() => !el('problems').hidden")
    assert offset.locator(".message").is_hidden()
    assert offset.locator("input[type=text]").get_attribute("aria-invalid") is None
    assert "must be less than" in row.locator(".message").inner_text()
    assert "pin_wheel.pin_radius" in page.locator("#problems").inner_text()
    assert page.locator("#results").is_visible()
    type_into(page, "disc.equidistant_offset", "0.15")
    settled(page)
    assert row.locator(".message").is_hidden()
    assert page.evaluate("document.body.dataset.answer") == "fine"


@pytest.mark.nightly
def test_a_page_that_is_opened_with_a_wrong_field_says_so(open_page):
    page = open_page()
    type_into(page, "pin_wheel.pin_radius", "-1")
    settled(page)
    page.reload()
    settled(page)
    assert page.locator("#verdict-line").inner_text() == "✗ A field is wrong"
    assert "pin_wheel.pin_radius = −1" in page.locator("#no-answer").inner_text()
    assert page.locator("#drive").is_hidden()
    assert page.locator("#work").is_visible()
    row = page.locator('#turned [data-path="pin_wheel.pin_radius"]')
    assert "must be greater than 0" in row.locator(".message").inner_text()
    page.locator("#undo").click()
    settled(page)
    assert page.locator("#no-answer").is_hidden()
    assert page.locator("#drive").is_visible()
    assert page.evaluate("document.body.dataset.answer") == "fine"


@pytest.mark.nightly
def test_limits_tolerances_and_cases_are_rows(open_page):
    page = open_page()
    for table in ("limits", "tolerances", "case", "disc.of"):
        page.locator(f'details[data-named="{table}"] > summary, details[data-table="{table}.N"] > summary').click()

    def add(table, key, value, word):
        name = table.replace(".", "-")
        page.fill(f"#add-{name}-key", key)
        if value:
            page.fill(f"#add-{name}-value", value)
        page.get_by_role("button", name=f"{word} to {table}", exact=True).click()
        settled(page)

    failing = page.locator("#verdict-line").inner_text()
    add("limits", "max_pin_pressure_mid", "1 MPa", "Add")
    assert page.locator("#verdict-line").inner_text() != failing
    page.fill('[data-path="limits.max_pin_pressure_mid.value"] input', "9 GPa")
    page.fill('[data-path="limits.max_pin_pressure_mid.source"] input', "a test")
    settled(page)
    assert 'max_pin_pressure_mid = { value = "9 GPa", source = "a test" }' in page.evaluate("state.text")
    sentence, rows = as_run_says(page.evaluate("state.text"), "CS-1")
    assert sentence.startswith(page.locator("#verdict-line").inner_text().lstrip("✓✗ "))
    assert_same(table_of(page, "verdict")[1:], rows)
    add("limits", "max_nothing", "1", "Add")
    assert "max_nothing: is no limit" in page.locator('[data-named="limits"]').inner_text()
    assert page.evaluate("document.body.dataset.answer") == "fine"
    add("tolerances", "disc.thickness", "-1", "Add")
    assert "must be greater than 0" in page.locator('[data-named="tolerances"]').inner_text()
    add("tolerances", "disc.thickness", "10 µm", "Add")
    page.fill('[data-path="tolerances.disc.thickness.cpk"] input', "-1")
    page.wait_for_selector('[data-path="tolerances.disc.thickness.cpk"] input[aria-invalid=true]')
    page.get_by_role("button", name="Remove disc.thickness", exact=True).click()
    settled(page)
    add("case", "cold", "", "Add")
    add("case.6", "clearance.bearing", "0.02", "Give it")
    page.select_option("#case", "cold")
    settled(page)
    assert page.evaluate("state.values['clearance.bearing']") == "0.02"
    page.fill('[data-path="case.6.name"] input', "colder")
    settled(page)
    assert page.locator("#case").input_value() == "colder"
    page.get_by_role("button", name="Remove 0: CS-1", exact=True).click()
    settled(page)
    assert page.evaluate("state.cases") == ["CS-2", "CS-3", "CS-4", "CS-5", "CS-6", "colder"]
    page.get_by_role("button", name="Add an entry of disc.of", exact=True).click()
    page.get_by_role("button", name="Remove disc.of, entry 0", exact=True).click()
    settled(page)
    assert page.evaluate("state.entries['disc.of']") is None
    assert page.evaluate("document.body.dataset.answer") == "fine"


@pytest.mark.nightly
def test_by_the_keyboard_alone(open_page):
    page = open_page()
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.className") == "skip"
    seen = []

    def tab_to(wanted):
        for _ in range(100):
            page.keyboard.press("Tab")
            seen.append(page.evaluate("document.activeElement.id"))
            if seen[-1] == wanted:
                return
        raise AssertionError(seen)

    tab_to("turn-disc-shifting-offset")
    page.keyboard.press("Control+a")
    page.keyboard.type("0.11")
    settled(page)
    assert page.evaluate("document.activeElement.id") == seen[-1]  # the answer does not take the focus
    assert page.evaluate("state.values['disc.shifting_offset']") == "0.11"
    tab_to("find")
    assert {"case", "compliance", "variant", "keep-variant", "save"} <= set(seen)
    page.evaluate("document.activeElement.blur(); scrollTo(0, 0)")
    page.locator("a.skip").nth(1).focus()  # the second stop of the page
    page.keyboard.press("Enter")
    tab_to("angle")
    assert "play" in seen
    page.locator('#turned [data-path="disc.shifting_offset"] input[type=range]').focus()
    page.keyboard.press("ArrowRight")
    settled(page)
    assert float(page.evaluate("state.values['disc.shifting_offset']")) > 0.11


@pytest.mark.parametrize(
    ("width", "scheme"),
    [
        (390, "dark"),
        *(pytest.param(*each, marks=pytest.mark.nightly) for each in ((390, "light"), (1400, "dark"), (1400, "light"))),
    ],
)
def test_no_serious_finding_of_axe_and_nothing_sticks_out(open_page, width, scheme):
    from axe_playwright_python import sync_playwright as axe

    page = open_page(width, color_scheme=scheme)
    if width == 390:  # folded, so that the answer is near
        page.locator("#all-fields > summary").click()
    for table in ("table=pin_wheel", "table=materials.disc", "named=limits", "named=case"):
        page.locator("details[data-{}='{}'] > summary".format(*table.split("="))).click()
    assert page.evaluate("document.documentElement.scrollWidth - innerWidth") <= 0
    found = axe.Axe().run(page).response["violations"]
    serious = [
        (one["id"], [node["html"][:120] for node in one["nodes"]][:3])
        for one in found
        if one["impact"] in ("serious", "critical")
    ]
    assert serious == []
    ground = page.evaluate("getComputedStyle(document.body).backgroundColor")
    assert (sum(map(int, re.findall(r"\d+", ground)[:3])) < 200) == (scheme == "dark")
    # On a wide screen the amber line stood below the verdict that it is about, 6 px beside it.
    page.set_viewport_size({"width": 1400, "height": 900})
    verdict, caution = (page.locator(name).bounding_box() for name in ("#verdict-line", "#caution"))
    assert caution["y"] == verdict["y"] or caution["x"] == verdict["x"]


@pytest.mark.nightly
def test_two_variants_stand_beside_each_other_and_a_number_says_what_it_drives(open_page):
    page = open_page()
    type_into(page, "clearance.bearing", "0.03")
    settled(page)
    page.locator("#beside-variant").select_option("as opened")
    page.wait_for_selector("#compared-box:not([hidden]) table")
    rows = {row[0]: row[1:] for row in table_of(page, "compared")[1:]}
    assert float(rows["bearing load, mean"][0]) != float(rows["bearing load, mean"][1])
    page.wait_for_function("() => derived.rows.has('clearance.bearing')")
    row = page.evaluate("derived.rows.get('clearance.bearing').cells.find(cell => cell.title === 'lost motion')")
    # Against a difference of two curves 2 µm apart, whose error is some 1e-4 of it: contacts open and close between.
    ends = []
    for value in ("0.029", "0.03", "0.031"):
        text = page.evaluate("state.text").replace(
            "clearance = { bearing = 0.03, pin_hole = 0.0 }", f"clearance = {{ bearing = {value}, pin_hole = 0.0 }}", 1
        )
        drive = parse_drive(text, "paper").cases["CS-1"]
        ends.append(torque_curve(drive, curve_angles(drive), points=0).lost_motion.mean() * ARCMIN)
    assert row["value"] == pytest.approx((ends[2] - ends[0]) / 2, rel=1e-2)
    assert f"{ends[1]:.3f}′" in page.locator("#derivatives").inner_text()


@pytest.mark.nightly
def test_a_killed_server_is_told_and_the_text_stays(browser, tmp_path):
    with studio("paper", tmp_path) as found:
        page = browser.new_page()
        page.set_default_timeout(WAIT)
        page.goto(found.address)
        settled(page)
        found.process.kill()
        found.process.wait()
        type_into(page, "disc.shifting_offset", "0.2")
        page.wait_for_selector("#lost:not([hidden])")
        with page.expect_download() as saved:
            page.locator("#lost .download").click()
        assert "shifting_offset = 0.09" in saved.value.path().read_text(encoding="utf-8")
        page.close()


@pytest.mark.nightly
def test_the_fine_answer_on_other_bodies_is_that_of_a_run(open_alone):
    """`robot-joint` says nothing of its bodies: what its file says is hybrid."""
    text = shipped_drive("robot-joint")
    engine = engine_of(parse_drive(text, "robot-joint").cases.values())
    assert engine.options["compliance"] == "hybrid"
    sentence, rows = as_run_says(text, "nominal", engine)
    page = open_alone("robot-joint")
    assert page.locator("#caution").is_hidden()
    assert_same(table_of(page, "verdict")[1:], rows)  # its coefficients come with the package
    page.select_option("#compliance", "half-space")
    settled(page)
    half_spaces = table_of(page, "verdict")[1:]
    assert "half-space" in page.locator("#about").inner_text()
    assert page.locator("#caution").inner_text() == "half-spaces: cyclo check decides on hybrid"
    line, caution = (page.locator(name).bounding_box() for name in ("#verdict-line", "#caution"))
    assert abs(line["y"] + line["height"] / 2 - caution["y"] - caution["height"] / 2) < 5  # beside it
    for compliance in ("hybrid", "file"):
        page.select_option("#compliance", compliance)
        settled(page)
        assert page.locator("#caution").is_hidden()
        assert page.evaluate("document.body.dataset.answer") == "fine"
        assert "hybrid" in page.locator("#about").inner_text()
        assert sentence.startswith(page.locator("#verdict-line").inner_text().lstrip("✓✗ "))
        assert_same(table_of(page, "verdict")[1:], rows)
        assert table_of(page, "verdict")[1:] != half_spaces


def job_done(page, number):
    """Wait until a job has ended; return its state and its files by name, each with where it is handed out."""
    row = page.locator(f'#jobs [data-job="{number}"]')
    page.wait_for_function(
        "number => document.querySelector(`#jobs [data-job='${number}']`).dataset.state !== 'running'", arg=number
    )
    links = row.locator(".files a").all()
    return row.get_attribute("data-state"), {
        link.inner_text().rpartition("/")[2]: link.get_attribute("href") for link in links
    }


@pytest.mark.nightly
def test_what_is_taken_along_is_a_file(open_alone):
    page = open_alone("paper")

    def made(number, button, form, name):
        page.select_option("#export-format" if button == "export" else "#simulator", form)
        page.locator(f"#{button}").click()
        page.wait_for_selector(f'#jobs [data-job="{number}"]')
        state, files = job_done(page, number)
        assert state == "done", page.locator("#jobs").inner_text()
        answer = page.context.request.get(page.url + files[name])
        assert answer.ok
        return answer.body()

    assert made(1, "export", "dxf", "paper_CS-1_disc.dxf").startswith(b"  0\nSECTION")
    assert made(2, "export", "step", "paper_CS-1_disc.step").startswith(b"ISO-10303-21;")
    faces = made(3, "export", "stl", "paper_CS-1_disc.stl")
    (count,) = struct.unpack("<I", faces[80:84])
    assert len(faces) == 84 + 50 * count
    assert ElementTree.fromstring(made(4, "simulate", "mujoco", "paper_CS_1.xml")).tag == "mujoco"


@pytest.mark.nightly
def test_jobs_tell_how_far_they_are_and_are_cancelled(open_alone):
    page = open_alone("paper")
    page.fill("#samples", "100000")
    page.locator("#tolerance").click()
    page.locator("#derive").click()
    page.wait_for_selector('#jobs [data-job="2"]')
    page.locator("#fem").click()
    page.wait_for_function("() => el('job-message').textContent.includes('2 jobs run already')")
    page.wait_for_selector('#jobs [data-job="1"] progress[value]')
    bar = page.locator('#jobs [data-job="1"] progress')
    assert bar.get_attribute("max") == "100000"
    assert 0 < int(bar.get_attribute("value")) < 100_000
    page.locator('#jobs [data-job="1"] .cancel').click()
    assert job_done(page, 1)[0] == "cancelled"
    state, files = job_done(page, 2)
    assert (state, "coefficients.nc" in files) == ("done", True)
    page.locator("#fem").click()
    page.wait_for_selector('#jobs [data-job="3"]')
    page.fill("#samples", "30")
    page.locator("#tolerance").click()
    page.wait_for_selector('#jobs [data-job="4"]')
    for number in (3, 4):
        state, files = job_done(page, number)
        assert state in ("done", "done, a check fails")
        assert "report.html" in files
        assert page.locator(f'#jobs [data-job="{number}"] progress').is_hidden()


@pytest.mark.nightly
def test_two_hundred_random_edits_leave_no_stale_number(open_page):
    page, draw = open_page(), random.Random(33)
    spans = {
        "disc.equidistant_offset": (0.1, 0.2), "disc.shifting_offset": (0.0, 0.2), "clearance.bearing": (0.0, 0.05),
        "clearance.pin_hole": (0.0, 0.05), "crank.eccentricity": (3.6, 4.2), "pin_wheel.pin_radius": (6.0, 7.0),
        "load.torque": (5e4, 6e5),
    }  # fmt: skip
    for number in range(200):
        path = draw.choice(list(spans))
        value = draw.choice(["-1", "x", ""]) if draw.random() < 0.1 else f"{draw.uniform(*spans[path]):.4f}"
        type_into(page, path, value)
        page.wait_for_timeout(draw.choice([0, 0, 20, 60, 200]))
        mark = page.evaluate(
            "[document.body.dataset.answer, Number(document.body.dataset.sequence), state.sequence, queue.length, pumping]"
        )
        # What is not of the last change is greyed.
        assert mark[0] in ("older", "refused") or (mark[1] == mark[2] and not mark[3] and not mark[4])
        if number % 25 == 24:
            for each, span in spans.items():
                type_into(page, each, f"{draw.uniform(*span):.4f}")
            settled(page)
            if page.evaluate("document.body.dataset.answer") == "fine":
                sentence, rows = as_run_says(page.evaluate("state.text"), "CS-1")
                assert sentence.startswith(page.locator("#verdict-line").inner_text().lstrip("✓✗ "))
                assert_same(table_of(page, "verdict")[1:], rows)


@pytest.mark.nightly
def test_two_tabs_have_their_own_drive(open_page, running):
    one, two = open_page(), open_page()
    type_into(one, "clearance.bearing", "0.02")
    type_into(two, "clearance.bearing", "0.04")
    settled(one)
    settled(two)
    assert [page.evaluate("state.values['clearance.bearing']") for page in (one, two)] == ["0.02", "0.04"]
    assert one.evaluate("shown.summary.find(each => each.key.startsWith('backlash_output')).value") < two.evaluate(
        "shown.summary.find(each => each.key.startsWith('backlash_output')).value"
    )
    assert asker(running.address)("jobs").body == {"jobs": []}
