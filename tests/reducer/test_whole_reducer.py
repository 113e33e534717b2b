"""The example of a whole reducer: its documented table is what the analysis says, and its sizes are those that are known."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from ltca.analysis.engines import HalfSpace, Hybrid
from ltca.analysis.loaded_analysis import analyse_cases
from ltca.analysis.stiffness_by_part import stiffness_by_part
from ltca.drive.units.quantities import ARCMIN
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive

ROOT = Path(__file__).resolve().parents[2]
FILE = ROOT / "examples" / "drives" / "whole_reducer.toml"
PAGE = ROOT / "docs" / "how-to" / "whole_reducer.md"
ANGLES = 2.0 * np.pi / 39 * np.arange(4) / 4
"""Those of the command: four over one mesh."""
ASSUMED = {
    "crank.support.load_constant": [{"crank.support.load_constant": 1e5}],
    "crank.support.preload": [{"crank.support.preload": 50.0}, {"crank.support.preload": 5000.0}],
    "crank.support.diameter": [{"crank.support.diameter": 32.0}],
    "carrier.stiffness_torsion": [{"carrier.stiffness_torsion": "3000 N·m/arcmin"}],
    "carrier.posts.size": [{"carrier.posts.size": 30.0}, {"carrier.posts.size": 50.0}],
    "carrier.flange": [{"carrier.flange": (15.0, 12.0)}, {"carrier.flange": None}],
    "ring.bolts.stiffness": [{"ring.bolts.stiffness": "100 N/µm"}, {"ring.bolts.stiffness": "2000 N/µm"}],
    "ring.width": [{"ring.width": 40.0}],
    "disc.equidistant_offset": [{"disc.equidistant_offset": "2 µm"}, {"disc.equidistant_offset": "20 µm"}],
    "half the torque": [{"load.torque": "800 N m"}],
    "first_stage.mesh_stiffness": [{"first_stage.mesh_stiffness": "50 N/µm"}],
}
"""What the rows of the second table change, in their order of values; the pins are cases of the file."""


def documented():
    """Rows of the table by name: stiffness, wind-up and lost motion on hybrid, stiffness on half-spaces."""
    rows = {}
    for line in PAGE.read_text(encoding="utf-8").splitlines():
        name, *cells = (cell.strip() for cell in line.strip("| ").split(" | "))
        if len(cells) == 4 and cells[0][:1].isdigit():
            rows[name] = [float(cell) for cell in cells]
    return rows


def backlash():
    """What the page says of the backlash, arc minutes."""
    (found,) = re.findall(
        r"free play with every clearance; ([0-9.]+)′ in all rows above", PAGE.read_text(encoding="utf-8")
    )
    return float(found)


def assumptions():
    """Rows of the second table: label and printed percentages."""
    rows = {}
    text = PAGE.read_text(encoding="utf-8").partition("## How much the assumptions count")[2]
    for line in text.splitlines():
        cells = [cell.strip() for cell in line.strip("| ").split(" | ")]
        if line.startswith("|") and cells[-1].endswith("%"):
            rows[cells[0].replace("`", "")] = re.findall(r"([+−][0-9.]+) %", cells[-1])
    return rows


def test_known_sizes_are_those_of_the_example():
    for drive in load_drive(FILE).cases.values():
        wheel, crank = drive.pin_wheel, drive.crank
        assert (drive.disc.number_of_teeth, wheel.number_of_pins, wheel.pin_circle_radius) == (39, 40, 111.5)
        assert (crank.eccentricity, crank.number, crank.circle_radius) == (2.0, 3, 65.0)


@pytest.mark.slow
def test_documented_table_is_that_of_the_analysis():
    """At one of the four angles, and without the small torques of the lost motion: angles differ by a per cent."""
    drive = load_drive(FILE).cases["pins 5 mm"]
    found = stiffness_by_part(drive, ANGLES[:1], lost_motion=0.5)
    rows = documented()
    assert [*rows] == [*found.rows]
    for name, read in found.rows.items():
        assert read.printed[0] == pytest.approx(rows[name][3], rel=0.01), name
        # hybrid winds up by 1 to 3 % more: bodies beyond the contacts
        assert read.wind_up * ARCMIN == pytest.approx(rows[name][1], rel=0.04), name
        # "in all rows above", a mean of four angles that differ by a thousandth
        assert read.backlash * ARCMIN == pytest.approx(backlash(), rel=0.002), name


@pytest.mark.slow
def test_documented_assumptions_count_as_the_analysis_has_it():
    """Slopes from half the torque to the torque, here one sense of a batch: wind-up from a light torque that is half of it.

    Percentages are round ones; those of two of the four angles and of one sense are within 0.1 of those of all.
    """
    cases = load_drive(FILE).cases
    drive = cases["pins 5 mm"]
    changed = {name: [with_fields(drive, fields) for fields in each] for name, each in ASSUMED.items()}
    changed["pin_wheel.pin_radius"] = [cases["pins 4 mm"], cases["pins 6 mm"]]
    drives = {"": drive} | {f"{name} {n}": one for name, each in changed.items() for n, one in enumerate(each)}
    drives = {name: with_fields(one, {"load.light_torque": 0.5 * one.load.torque}) for name, one in drives.items()}
    stiffness = {
        name: 0.5 * found.torque / found.wind_up.mean()
        for name, found in analyse_cases(drives, ANGLES[::2], engine=HalfSpace())
    }
    rows = assumptions()
    assert len(rows) == len(changed)
    for name, each in changed.items():
        (printed,) = (texts for label, texts in rows.items() if label.startswith(name))
        assert len(printed) == len(each), name
        for number, text in enumerate(printed):
            by = 100.0 * (stiffness[f"{name} {number}"] / stiffness[""] - 1.0)
            last = 10.0 ** -len(text.partition(".")[2])
            assert by == pytest.approx(float(text.replace("−", "-")), abs=0.5 * last + 0.1 * last), (name, number)


@pytest.mark.nightly
def test_documented_table_to_its_digits(tmp_path, monkeypatch):
    """As `cyclo curves --parts` has it, on the default engine: the column of half-spaces, backlash and lost motion as well."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    drive = load_drive(FILE).cases["pins 5 mm"]
    plane = stiffness_by_part(with_fields(drive, {"ring.model": "fe"}), ANGLES, lost_motion=0.5).whole
    hybrid = stiffness_by_part(drive, ANGLES, engine=Hybrid().with_coefficients(drive)).rows
    simple = stiffness_by_part(drive, ANGLES, lost_motion=0.5).rows
    (lower,) = re.findall(r'model = "fe"` the stiffness is ([0-9]) % lower', PAGE.read_text(encoding="utf-8"))
    whole = simple["everything that is described"]
    assert 100.0 * (1.0 - plane.stiffness / whole.stiffness) == pytest.approx(float(lower), abs=0.5)
    for name, cells in documented().items():
        stiff, wound, lost, play = hybrid[name].printed
        # half a unit of the last digit that is printed
        assert stiff == pytest.approx(cells[0], abs=0.5), name
        assert (wound, lost) == pytest.approx(cells[1:3], abs=5e-4), name
        assert simple[name].printed[0] == pytest.approx(cells[3], abs=0.5), name
        assert play == pytest.approx(backlash(), abs=5e-4), name
