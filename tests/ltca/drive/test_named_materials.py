"""Named materials: every number has a source and lies within its scatter, and a name means the same wherever it may stand."""

from __future__ import annotations

import tomllib
from dataclasses import fields, replace
from fnmatch import fnmatch
from pathlib import Path

import numpy as np
import pytest
from refusals import error_says

import ltca
from ltca.analysis.loaded_analysis import analyse
from ltca.drive.materials import MAY_BE_UNKNOWN, PARTS, Material, Materials, elastic_alone
from ltca.drive.members.named_materials import (
    FILE,
    material_sources,
    name_of,
    named_material,
    named_materials,
    named_parts,
    sourced_material,
    strength_warning,
)
from ltca.errors import DriveError
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import build_drive, load_drive, parse_drive, shipped_drive
from ltca.reading.writing import drive_text

ROOT = Path(ltca.__file__).parents[1]
ASKED_FOR = ["100Cr6", "16MnCr5", "42CrMo4", "EN-GJS", "aluminium 7075", "POM", "PA12", "printed PLA", "printed PETG"]
DISC = 'disc = { like = "100Cr6", youngs_modulus = 206000.0, poisson_ratio = 0.3 }'
PAPER = load_drive("paper").cases["CS-1"]


def paper(disc, case=""):
    """The paper's drive with something else as the material of its disc, and a case more."""
    text = shipped_drive("paper")
    assert DISC in text
    return parse_drive(text.replace(DISC, f"disc = {disc}") + (f'\n[[case]]\nname = "own"\n{case}\n' if case else ""))


def test_the_materials_asked_for_are_there():
    assert list(named_materials()) == ASKED_FOR


@pytest.mark.parametrize("name", ASKED_FOR)
def test_every_number_has_a_source_and_lies_within_its_scatter(name):
    entry = sourced_material(name)
    assert entry.state
    given = {"youngs_modulus", "poisson_ratio", "allowable_pressure", "yield_strength", "density", "thermal_expansion"}
    assert given <= set(entry.numbers)
    for field, number in entry.numbers.items():
        assert number.low <= number.value <= number.high, field
        assert len(number.source) > 10, field
        assert len(number.scatter_source) > 10, field
        # What was not looked up says so itself, wherever it is printed.
        assert number.confirmed or "not confirmed" in number.source or "not seen" in number.source, field
        assert getattr(entry.material, field) == number.value
    assert material_sources(name) == {field: number.source for field, number in entry.numbers.items()}


def test_numbers_have_the_size_of_their_unit():
    """A wrong prefix in the data would pass every other test: metals and plastics lie within bounds of any handbook."""
    for entry in named_materials().values():
        material, plastic = entry.material, entry.material.youngs_modulus < 10_000.0
        assert (1e3 if plastic else 6e4) < material.youngs_modulus < (5e3 if plastic else 2.2e5)
        assert (850 if plastic else 2600) < material.density < (1500 if plastic else 8000)
        assert (5e-5 if plastic else 1e-5) < material.thermal_expansion < (2e-4 if plastic else 2.5e-5)
        assert material.yield_strength < material.youngs_modulus / 30.0


def test_first_yield_is_that_of_a_line_contact():
    """Where no standard allows a pressure it is Y/2 over the largest shear below a line contact (Johnson, Eq. 4.47)."""
    depth = np.linspace(0.5, 1.0, 501)
    factor = 1.67  # as the book rounds it
    assert 0.5 / np.max(depth - depth**2 / np.sqrt(1.0 + depth**2)) == pytest.approx(factor, abs=0.006)
    of_johnson = [
        entry for entry in named_materials().values() if "Johnson" in entry.numbers["allowable_pressure"].source
    ]
    assert len(of_johnson) == 5
    for entry in of_johnson:
        pressure, strength = entry.numbers["allowable_pressure"], entry.numbers["yield_strength"]
        for end in ("value", "low", "high"):  # whole megapascals
            assert getattr(pressure, end) == pytest.approx(factor * getattr(strength, end), abs=0.6), entry.name


def test_lines_of_the_gear_standard():
    """Allowable pressures that follow from hardness follow from the hardness beside them."""
    for name, slope, start, tolerance in (("42CrMo4", 1.313, 373.0, 0.6), ("EN-GJS", 1.434, 211.0, 0.6)):
        numbers = sourced_material(name).numbers
        for end in ("value", "low", "high"):
            expected = slope * getattr(numbers["hardness"], end) + start
            assert getattr(numbers["allowable_pressure"], end) == pytest.approx(expected, abs=tolerance)


def test_aliases_mean_one_material():
    assert named_material("EN-GJS-600-3") == named_material("EN-GJS")
    assert named_material("pla") == named_material("printed PLA")
    assert named_material("7075") == named_material("aluminium 7075")
    spellings = [text.casefold() for entry in named_materials().values() for text in (entry.name, *entry.aliases)]
    assert len(set(spellings)) == len(spellings)


def test_a_name_stands_for_its_numbers_in_files_cases_tables_and_changes():
    expected = named_material("PA12")
    assert paper('"PA12"').cases["CS-1"].materials.disc == expected
    assert paper('{ like = "PA12" }').cases["CS-1"].materials.disc == expected
    assert paper('"POM"', 'materials.disc = "PA12"').cases["own"].materials.disc == expected
    assert with_fields(PAPER, {"materials.disc": "PA12"}).materials.disc == expected
    table = tomllib.loads(drive_text(PAPER))
    table["materials"]["disc"] = "PA12"
    assert build_drive(table).materials.disc == expected


def test_numbers_beside_a_name_replace_its_own():
    expected = replace(named_material("PA12"), youngs_modulus=1400.0)
    assert paper('{ like = "PA12", youngs_modulus = "1.4 GPa" }').cases["CS-1"].materials.disc == expected
    assert paper('"PA12"', 'materials.disc = { youngs_modulus = "1.4 GPa" }').cases["own"].materials.disc == expected
    changed = with_fields(PAPER, {"materials.disc.youngs_modulus": 1400.0, "materials.disc": "PA12"})
    assert changed.materials.disc == expected


def test_a_name_takes_nothing_over_from_what_it_replaces():
    """A plastic disc must not keep the hardness of the steel that stood there."""
    steel = with_fields(PAPER, {"materials.disc": "16MnCr5"})
    assert steel.materials.disc.hardness == 700.0
    assert with_fields(steel, {"materials.disc": "POM"}).materials.disc == named_material("POM")
    assert paper('"16MnCr5"', 'materials.disc = "POM"').cases["own"].materials.disc == named_material("POM")
    given = '{ youngs_modulus = "200 GPa", hardness = 700 }'
    assert paper(given, 'materials.disc = { like = "POM" }').cases["own"].materials.disc == named_material("POM")


@pytest.mark.parametrize(
    ("disc", "told"),
    [
        ('"PA-12"', "materials.disc = 'PA-12': is no named material; there are 100Cr6"),
        ('"PA-12"', "did you mean `PA12`?"),
        ('{ like = "alluminium 7075" }', "materials.disc.like = 'alluminium 7075': is no named material"),
        ("{ like = 3 }", "materials.disc.like = 3: must be the name of a material"),
        ('{ like = "PLA", yongs_modulus = 3 }', "materials.disc.yongs_modulus: is not a field"),
        ('{ hardness = "700 HV" }', "materials.disc.hardness"),
        ('{ density = "7.85 t" }', "materials.disc.density"),
        ("{ thermal_expansion = 12 }", "must be greater than -0.001 and less than 0.001 1/K"),
    ],
)
def test_what_is_no_material_is_refused(disc, told):
    with pytest.raises(DriveError) as error:
        paper(disc)
    assert told in str(error.value)


def test_a_change_to_no_material_is_refused():
    with error_says(DriveError, starts="materials.disc = 'PA-12': is no named material"):
        with_fields(PAPER, {"materials.disc": "PA-12"})
    with error_says(DriveError, "must be the name of a material"):
        with_fields(PAPER, {"materials.disc": 3.0})


def test_units_of_material_fields():
    given = '{ density = "7.85 g/cm³", allowable_pressure = "1.5 GPa", hardness_depth = "600 µm" }'
    found = paper(given).cases["CS-1"].materials.disc
    assert (found.density, found.allowable_pressure, found.hardness_depth) == (7850.0, 1500.0, 0.6)
    assert paper('{ thermal_expansion = "12e-6 1/K" }').cases["CS-1"].materials.disc.thermal_expansion == 12e-6


def test_what_is_left_out_changes_no_fingerprint():
    """Coefficients and results of drives without the new fields are found under the names they had."""
    shaft = replace(PAPER.pin_shaft, elastic_contact=True)
    bare = replace(PAPER, materials=elastic_alone(PAPER.materials), pin_shaft=shaft)
    assert (bare.fingerprint(), bare.shape_fingerprint()) == ("9f1b8097fb353a07", "5126582301a331b5")
    assert PAPER.shape_fingerprint() == bare.shape_fingerprint()
    assert PAPER.fingerprint() != bare.fingerprint()


@pytest.mark.parametrize("name", ["paper", "robot-joint", "rv", "sleeved"])
def test_shipped_drives_keep_modulus_and_ratio(name):
    """Names bring what results are judged by; loads are those of 206 GPa and 0.3 as before, the slots' of 169 GPa and 0.275."""
    for drive in parse_drive(shipped_drive(name), name).cases.values():
        for part in PARTS:
            material = getattr(drive.materials, part)
            expected = (169_000.0, 0.275) if (name, part) == ("sleeved", "wheel_seat") else (206_000.0, 0.3)
            assert (material.youngs_modulus, material.poisson_ratio) == expected
        assert drive.materials.disc.allowable_pressure == 1500.0


def test_named_materials_are_told_by_name():
    assert name_of(Material()) is None
    assert all(name_of(named_material(name)) == name for name in ASKED_FOR)
    materials = replace(
        Materials(), disc=named_material("PA12"), roller=replace(named_material("100Cr6"), density=None)
    )
    assert named_parts(materials) == {"disc": "PA12", "roller": "like 100Cr6, but density"}


def test_another_modulus_beside_a_name_is_warned_of():
    """A case of aluminium made by its modulus alone would be judged by the strength of the steel below it."""
    assert strength_warning(PAPER.materials) is None  # 206 GPa beside the name of bearing steel
    aluminium = with_fields(PAPER, {"materials.disc.youngs_modulus": 71e3, "materials.disc.poisson_ratio": 0.33})
    told = "materials.disc: youngs_modulus = 71000 MPa is none of 100Cr6 (200000 … 212000 MPa), by whose strength it is judged"
    assert strength_warning(aluminium.materials) == told
    assert told in analyse(aluminium, np.array([0.5])).warnings
    assert strength_warning(with_fields(PAPER, {"materials.disc": "7075"}).materials) is None
    given = with_fields(aluminium, {"materials.disc.allowable_pressure": 700.0})
    assert strength_warning(given.materials) is None


def test_parts_and_fields_are_those_of_the_definition():
    assert tuple(item.name for item in fields(Materials)) == PARTS
    assert {item.name for item in fields(Material) if item.default is None} == set(MAY_BE_UNKNOWN)


def test_a_drive_of_named_materials_is_written_and_read_back():
    drive = with_fields(
        PAPER, {f"materials.{part}": "100Cr6" for part in ("disc", "wheel_pin", "roller", "inner_race")}
    )
    assert parse_drive(drive_text(drive)).cases["nominal"] == drive


def test_the_wheel_has_the_data():
    data = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["setuptools"]["package-data"]
    assert any(fnmatch(f"drive/members/{FILE}", pattern) for pattern in data["ltca"])
