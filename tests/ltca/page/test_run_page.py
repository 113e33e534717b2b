"""The page of a run: whole in itself, numbers as in the dataset, names as texts, the same from the same run."""

from __future__ import annotations

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from refusals import error_says

from ltca.errors import DriveError
from ltca.output.netcdf import read_netcdf
from ltca.page import run_arrays as arrays_module
from ltca.page.compared import read_compared
from ltca.page.packing import unpack
from ltca.page.run_arrays import run_arrays, shown_positions
from ltca.page.run_page import run_page
from ltca.page.run_tables import input_tables
from ltca.page.tables import minus
from ltca.page.verdict_tables import verdict_of
from ltca.quantities import SCHEMA_VERSION
from ltca.reading.drive_file import parse_drive, shipped_drive


def script(text, name):
    return re.search(rf'<script id="{name}"[^>]*>(.*?)</script>', text, re.S).group(1)


def numbers_of(text):
    content = json.loads(script(text, "data"))
    return content, unpack(content["places"], script(text, "numbers"))


@pytest.fixture(scope="module")
def page(paper_run):
    return run_page(paper_run[0])


def test_nothing_is_loaded_from_elsewhere(page):
    addresses = set(re.findall(r"https?://[^\s\"'<>`]+", page)) - {"http://www.w3.org/2000/svg"}
    assert not addresses
    for attribute in re.findall(r'\b(?:src|href)="([^"]*)"', page):
        assert attribute.startswith(("data:", "#")), attribute
    assert "@import" not in page
    assert "url(" not in page


def test_numbers_are_those_of_the_dataset(page, paper_run):
    """To the half unit of float32, every case, kind and position; positions stand last."""
    dataset = paper_run[1]
    content, numbers = numbers_of(page)
    assert content["names"] == list(dataset["case"].values)
    assert np.allclose(numbers["angle"], dataset["crank_angle"])
    for number in range(dataset.sizes["case"]):
        one = dataset.isel(case=number)
        for kind, name, contact in (
            ("pin", "pin_load", "pin"), ("hole", "pin_shaft_load", "hole"), ("pin", "pin_pressure_mid", "pin"),
        ):  # fmt: skip
            quantity = "pressure" if name.endswith("mid") else "load"
            shown = numbers[f"{number}/full/{kind}/{quantity}"]
            assert np.allclose(shown, one[name].transpose("disc", contact, "position"), rtol=1e-7)
        rollers = one["roller_load"].transpose("disc", "crank", "roller", "position").values
        assert np.allclose(numbers[f"{number}/full/outer/load"], rollers.reshape(1, -1, rollers.shape[-1]), rtol=1e-7)
        error = np.degrees(one["transmission_error_light"].values) * 3600.0
        assert np.allclose(numbers[f"{number}/light/te"], error, rtol=1e-6)


def test_light_loads_carry_the_light_torque(page, paper_run):
    """Mean tangential forces are as the torques: the light answer is one of its own, not the full one made smaller."""
    _, numbers = numbers_of(page)
    assert 0.0 < numbers["0/light/pin/load"].max() < 0.3 * numbers["0/full/pin/load"].max()
    pressed = numbers["0/light/pin/pressure"]
    assert np.array_equal(pressed > 0.0, numbers["0/light/pin/load"] > 0.0)


def test_same_run_same_page(page, paper_run):
    assert run_page(paper_run[0]) == page


@pytest.mark.slow
def test_a_page_is_made_from_results_read_back(page, paper_run, tmp_path):
    """Without the answers at the light torque the page has all else; their transmission error is in the results."""
    run, dataset = paper_run
    dataset.to_netcdf(tmp_path / "results.nc", engine="h5netcdf")
    read = read_netcdf(tmp_path / "results.nc", "results of cyclo run")
    _, numbers = numbers_of(page)
    _, again = numbers_of(run_page(replace(run, dataset=read, light=None)))
    light = {name for name in numbers if "/light/" in name and not name.endswith("/te")}
    assert light
    assert again.keys() == numbers.keys() - light
    assert all(np.array_equal(again[name], numbers[name]) for name in again)


@pytest.mark.slow
def test_results_of_a_later_schema_are_refused(paper_run, tmp_path):
    path = tmp_path / "results.nc"
    paper_run[1].assign_attrs(schema_version=SCHEMA_VERSION + 1).to_netcdf(path, engine="h5netcdf")
    with error_says(DriveError, f"schema version {SCHEMA_VERSION + 1}", f"up to {SCHEMA_VERSION}: update cyclo"):
        read_compared(tmp_path)


def test_names_are_texts_whatever_they_contain(paper_run):
    """A case that ends a script element, or begins one, runs nothing."""
    odd = "</script><script>alert(1)</script>"
    run = paper_run[0]
    (first, drive), *_ = run.drives.items()
    attributes = {"drive": f"<img onerror=alert(1)> {odd}", "drive_file": f'name = "{odd}"'}
    dataset, light = (
        each.isel(case=[0]).assign_coords(case=[odd]).assign_attrs(attributes) for each in (run.dataset, run.light)
    )
    named = replace(
        run, dataset=dataset, light=light, drives={odd: drive}, summaries={odd: run.summaries[first]},
        checks={odd: run.checks[first]}, lives={odd: run.lives[first]},
    )  # fmt: skip
    text = run_page(named)
    assert "<script>alert" not in text
    assert "<img onerror" not in text
    assert text.count("<script") == text.count("</script>")
    assert "&lt;/script&gt;" in text
    assert json.loads(script(text, "data"))["names"] == [odd]
    assert "&lt;b&gt;few&lt;/b&gt; positions" in text


def test_how_far_half_spaces_are_off_stands_under_the_verdict_and_rows_are_called_what_they_are(page):
    """It stood at the end of the page, in one of three rows all called "sampling"."""
    where = "the shipped drive paper, at 50 … 100 % of the torque"
    caution = f'<p class="caution">half-spaces: about 31 … 34 % too stiff here (measured on {where})</p>'
    assert page.count(caution) == 1
    assert page.index('class="verdict') < page.index(caution) < page.index('id="verdict"')
    made = page[page.index('data-name="computed_by"') :]
    assert [made.count(f">{name}</th>") for name in ("sampling", "bodies")] == [1, 1]


def test_the_verdict_comes_first_and_counts_honestly(page, paper_run):
    checks = paper_run[0].checks
    every = [check for case in checks.values() for check in case]
    kept = {(check.title, check.limit.value) for check in every if check.verdict == "pass"}
    assert f"All {len(kept)} values that can be judged keep their limits in every case." in page
    assert page.index('id="verdict"') < page.index('id="drive"') < page.index('id="loads"') < page.index('id="inputs"')
    sentence, state = verdict_of({})
    assert state == "fail"
    assert "no answer" in sentence


def test_stiffness_stood_among_the_loads_in_newton_millimetres(page):
    """As 6.162e+08 N·mm/rad, while the terminal and the section on the wind-up have N·m/′."""
    loads = page[page.index('data-name="loads"') : page.index('data-name="pressures"')]
    wound = page[page.index('data-name="wind_up"') : page.index('data-name="life"')]
    assert "N·mm/rad" not in page
    assert "stiffness" not in loads
    assert "stiffness of the cycloid stage there, N·m/′" in wound


def test_cases_without_an_answer_are_told(paper_run):
    run = paper_run[0]
    text = run_page(replace(run, checks={"CS-1": run.checks["CS-1"]}))
    assert "✗ No answer at some positions, not judged: CS-6. All " in text


def test_failures_come_first(paper_run):
    run = paper_run[0]
    (name, each), *_ = run.checks.items()
    hurt = [
        replace(one, value=replace(one.value, value=9e9)) if one.value.quantity == "pin_shaft_pressure_mid" else one
        for one in each
    ]
    text = run_page(replace(run, checks={**run.checks, name: hurt}))
    assert "✗ 1 of" in text
    assert "in 1 of 2 cases" in text
    table = text[text.index('data-name="verdict"') :]
    assert table.index("✗ FAIL") < table.index("✓ pass")


def test_inputs_are_echoed_with_units_and_degrees(page):
    plain = page.replace("<wbr>", "")  # where a name may go on in the next line
    assert re.search(r">crank.eccentricity</th><td[^>]*>4</td><td[^>]*>mm<", plain)
    assert "What differs between cases" in page
    assert re.search(r">clearance.bearing</th><td[^>]*>mm</td><td[^>]*>0</td>", plain)


def test_one_minus_sign(page):
    table = page[page.index('data-name="loads"') : page.index('data-name="inputs"')]
    assert not re.search(r">-\d", table)
    assert minus("-1.2e-05, mid-width, CS-1") == "−1.2e−05, mid-width, CS-1"


def test_runs_of_many_positions_are_thinned(paper_run, monkeypatch):
    run = paper_run[0]
    assert shown_positions(run.dataset).tolist() == list(range(8))
    monkeypatch.setattr(arrays_module, "MOST_VALUES", 2000)
    shown = shown_positions(run.dataset)
    assert 1 <= shown.size < 8
    assert sum(each.size for each in run_arrays(run.dataset, run.light, shown).values()) < 3000
    assert "th is shown, tables know all" in run_page(run)


def test_a_measured_curve(tmp_path):
    path = tmp_path / "te.csv"
    path.write_text("# bench 3\ncrank_angle_deg, transmission_error_arcmin\n370,0.5\n0,-0.25\n", encoding="utf-8")
    found = read_compared(path)
    assert np.allclose(found.arrays["measured/angle"], np.radians([0.0, 10.0]))
    assert np.allclose(found.arrays["measured/te"], [-15.0, 30.0])
    assert "2 measured values" in found.told


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("angle,te\n1,2\n", "must have one column of crank_angle_deg | crank_angle_rad"),
        ("crank_angle_deg,transmission_error_arcsec\n1,x\n", "row 2: must hold two finite numbers"),
        ("crank_angle_deg,transmission_error_arcsec\n1,nan\n", "row 2: must hold two finite numbers"),
        ("crank_angle_deg,transmission_error_arcsec\n", "holds no measured value"),
        ("", "must have one column"),
    ],
)
def test_no_measured_curve(tmp_path, text, told):
    path = tmp_path / "te.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(DriveError, match="--compare") as caught:
        read_compared(path)
    assert told in str(caught.value)


def test_nothing_to_compare_with(tmp_path):
    for path in (tmp_path, tmp_path / "none.nc"):
        with pytest.raises(DriveError, match="holds no results"):
            read_compared(path)
    broken = tmp_path / "results.nc"
    broken.write_bytes(b"no netCDF")
    with pytest.raises(DriveError, match="cannot be read as results of cyclo run"):
        read_compared(tmp_path)


@pytest.mark.slow
def test_a_second_run_beside_the_first(paper_run, tmp_path):
    run, dataset = paper_run
    dataset.to_netcdf(tmp_path / "results.nc", engine="h5netcdf")
    (tmp_path / "summary.json").write_text(json.dumps({"drive": "paper", "cases": run.summaries}), encoding="utf-8")
    name = "CS-6"
    alone = replace(
        run, dataset=dataset.sel(case=[name]), light=run.light.sel(case=[name]), drives={name: run.drives[name]},
        summaries={name: run.summaries[name]}, checks={name: run.checks[name]}, lives={name: run.lives[name]},
        compared=read_compared(tmp_path),
    )  # fmt: skip
    text = run_page(alone)
    content, numbers = numbers_of(text)
    assert content["compared"]["match"] == [1]
    assert np.array_equal(numbers["b/1/full/outer/load"], numbers["0/full/outer/load"])
    assert "second run, CS-6" in text
    assert "0.00\u00a0%" in text


def test_inputs_are_those_of_parts_that_are_there():
    """The page of an RV listed the material of shaft pins, that of the paper's drive sleeves and crankshafts."""
    paths = {
        name: {
            cell.text
            for table in input_tables(parse_drive(shipped_drive(name), name).cases)
            for (cell, *_) in table.rows
        }
        for name in ("rv", "sleeved", "paper")
    }
    assert not [
        path for path in paths["rv"] if any(part in path for part in ("shaft_pin", "pin_shaft", "sleeve", "pin_hole"))
    ]
    assert "materials.crankshaft.youngs_modulus" in paths["rv"]
    assert {"materials.sleeve.youngs_modulus", "materials.shaft_pin.youngs_modulus"} <= paths["sleeved"]
    assert not [path for path in paths["paper"] if any(part in path for part in ("crankshaft", "sleeve", "wheel_seat"))]
    assert {"materials.shaft_pin.youngs_modulus", "clearance.pin_hole"} <= paths["paper"]
