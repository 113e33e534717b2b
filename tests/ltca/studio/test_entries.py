"""Limits, tolerances, cases and bearings of a text as rows, and how they are changed, added and taken away."""

from __future__ import annotations

import pytest
from refusals import error_says

from ltca.errors import DriveError
from ltca.quantities import LIMITED
from ltca.reading.arguments import SHIPPED_DRIVES
from ltca.reading.drive_file import load_drive, parse_drive, shipped_drive
from ltca.studio.entries import (
    changed_entries,
    declared_entries,
    with_named_entry,
    without_named_entry,
    written_entries,
)

PAPER = shipped_drive("paper")


def read(text):
    return parse_drive(text, "paper")


@pytest.mark.parametrize("name", SHIPPED_DRIVES)
def test_every_limit_tolerance_and_case_of_a_shipped_drive_is_there(name):
    file, found = load_drive(name), written_entries(shipped_drive(name))
    titles = {table: [one["title"] for one in entries] for table, entries in found["named"].items()}
    assert titles["tolerances"] == list(file.tolerances)
    assert {key for limits in file.limits.values() for key in limits} <= set(titles["limits"])
    cases = [one.partition(": ")[2] for one in titles["case"]]
    assert cases == [one for one in file.cases if one != "nominal"]
    for path, scatter in file.tolerances.items():
        assert found["values"][f"tolerances.{path}.distribution"] == scatter.distribution


def test_every_quantity_with_a_limit_is_offered():
    offered = declared_entries()["limits"]["keys"]
    assert set(offered) == {f"{sense}_{name}" for name in LIMITED for sense in ("max", "min")}


def test_a_limit_is_added_changed_and_taken_away():
    text = with_named_entry(PAPER, "limits", "max_pin_pressure_mid", "1.5 GPa")
    assert read(text).limits["CS-1"]["max_pin_pressure_mid"].value == 1500.0
    text = changed_entries(text, "CS-1", {"limits.max_pin_pressure_mid.source": "ISO 6336"})
    text = changed_entries(text, "CS-1", {"limits.max_pin_pressure_mid.value": "1600"})
    limit = read(text).limits["CS-1"]["max_pin_pressure_mid"]
    assert (limit.value, limit.source) == (1600.0, "ISO 6336")
    (row,) = [one for one in written_entries(text)["named"]["limits"] if one["title"] == "max_pin_pressure_mid"]
    assert [(one["name"], one["unit"]) for one in row["fields"]] == [("value", "MPa"), ("source", "")]
    assert without_named_entry(text, "limits.max_pin_pressure_mid") == PAPER
    emptied = changed_entries(text, "CS-1", {"limits.max_pin_pressure_mid.value": ""})
    with pytest.raises(DriveError, match=r"limits\.max_pin_pressure_mid"):
        read(emptied)


def test_a_tolerance_has_the_unit_of_its_field():
    text = with_named_entry(PAPER, "tolerances", "disc.thickness", "10 µm")
    text = changed_entries(text, "", {"tolerances.disc.thickness.distribution": "uniform"})
    found = read(text).tolerances["disc.thickness"]
    assert (found.distribution, found.tolerance) == ("uniform", 0.01)
    (row,) = [one for one in written_entries(text)["named"]["tolerances"] if one["title"] == "disc.thickness"]
    assert [one["unit"] for one in row["fields"]] == ["", "mm", "", "mm"]
    assert row["fields"][0]["choices"] == ["normal", "uniform", "truncated-normal"]
    assert without_named_entry(text, "tolerances.disc.thickness") == PAPER


def test_a_case_has_fields_and_limits_of_its_own():
    text = with_named_entry(PAPER, "case", "tight", "")
    text = with_named_entry(text, "case.6", "disc.shifting_offset", "50 µm")
    text = with_named_entry(text, "case.6", "limits.max_pin_load", "3 kN")
    file = read(text)
    assert file.cases["tight"].disc.shifting_offset == 0.05
    assert file.limits["tight"]["max_pin_load"].value == 3000.0
    assert "max_pin_load" not in file.limits["CS-1"]
    changed = {
        "case.6.name": "tighter", "case.6.disc.shifting_offset": "0.04", "case.6.limits.max_pin_load.value": "2000",
    }  # fmt: skip
    file = read(changed_entries(text, "tight", changed))
    assert file.cases["tighter"].disc.shifting_offset == 0.04
    assert file.limits["tighter"]["max_pin_load"].value == 2000.0
    assert list(read(without_named_entry(text, "case.2")).cases) == ["CS-1", "CS-2", "CS-4", "CS-5", "CS-6", "tight"]


def test_a_bearing_has_any_name():
    name = "K 37.5-x"
    text = with_named_entry(PAPER, "bearings", name, "39")
    others = {"outer_race_diameter": "59", "roller_length": "11.8", "number_of_rollers": "11"}
    text = changed_entries(text, "CS-1", {f"bearings.{name}.{field}": typed for field, typed in others.items()})
    text = changed_entries(text, "CS-1", {"crank_bearing.bearing": name})
    assert read(text).cases["CS-1"].crank_bearing.inner_race_radius == 19.5
    with pytest.raises(DriveError, match="bearing"):
        read(without_named_entry(text, f"bearings.{name}"))


@pytest.mark.parametrize(
    ("table", "key", "value", "told"),
    [
        ("limits", "max_foo", "1", "limits.max_foo: is no limit"),
        ("limits", "max_pin_load", "abc", "limits.max_pin_load = 'abc'"),
        ("limits", "max_roller_pressure_mid", "1", "is there already"),
        ("tolerances", "disc.nothing", "1", "tolerances.disc.nothing: is not a field"),
        ("tolerances", "disc.thickness", "-1", "must be greater than 0 mm"),
        ("tolerances", "disc.runout.amount", "1", "is there already"),
        ("case", "CS-1", "", "name is used already"),
        ("case", "a/b", "", "can name a file"),
        ("case.9", "disc.thickness", "1", "is no case"),
        ("case.0", "disc.nope", "1", "is no field"),
        ("case.0", "clearance.bearing", "0.3", "is there already"),
        ("bearings", "x", "", "inner_race_diameter: is missing"),
        ("disc", "", "", "must be one of"),
    ],
)
def test_what_cannot_be_added_is_refused_by_name(table, key, value, told):
    with error_says(DriveError, told):
        with_named_entry(PAPER, table, key, value)


@pytest.mark.parametrize("path", ["case.9", "disc", "disc.thickness", "limits.max_nothing", "clearance.bearing"])
def test_what_is_no_entry_is_not_taken_away(path):
    with pytest.raises(DriveError, match=r"is no entry|cannot be taken away"):
        without_named_entry(PAPER, path)
