"""The page of the width and its drive file: what they print is read, balanced and refused as they say."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import numpy as np
import pytest

from ltca.analysis.engines import HalfSpace
from ltca.drive.engine_support import ENGINES, refusal
from ltca.drive.fields import field_kinds
from ltca.drive.members.width import needs_slices
from ltca.geometry.coordinates import Coordinates
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "how-to" / "width.md").read_text(encoding="utf-8")
FILE = ROOT / "examples" / "drives" / "leaning_pins.toml"


@pytest.mark.slow
def test_the_example_of_the_page_is_a_drive():
    (text,) = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)
    drive = with_fields(load_drive("paper").cases["CS-1"], tomllib.loads(text))
    assert drive.contact.slices == 9
    assert drive.pin_shaft.inclination.y == pytest.approx(2e-4)
    found = HalfSpace().prepare(drive).balance(np.array([0.5]), drive.load.torque)
    # Inclined by tenths of a milliradian: the disc tilts, and by no more than that.
    tilt = np.abs(found.pose[0, 3:5])
    assert 1e-6 < tilt.max() < 5e-4


def test_every_field_of_the_width_is_on_the_page():
    for path in ["contact.slices", *filter(needs_slices, field_kinds())]:
        if ".of." not in path:
            table, _, name = path.rpartition(".")
            known = (
                f"`{path}`" in PAGE or f"`{table}`" in PAGE or (f"`{table}.{name[:-1]}x`" in PAGE and "`…_y`" in PAGE)
            )
            assert known, path


def test_engines_of_the_page_are_those_of_the_table():
    """A row for what takes slices, one for what refuses them."""
    (refusing,) = [line for line in PAGE.splitlines() if line.endswith("| refused by the name `contact.slices` |")]
    names = {"hybrid": "hybrid", "fe": "--compliance fe", "paper": "paper", "full FE": "full FE", "direct": "direct"}
    for engine in set(ENGINES) - {"tables"}:
        assert (refusal(engine, "contact.slices") is not None) == (names[engine] in refusing), engine


@pytest.mark.slow
def test_the_drive_file_has_what_the_page_tells():
    """The crown takes the edge off; cantilevers tilt the discs by tenths of a milliradian."""
    cases = load_drive(FILE).cases
    largest = {}
    for name in ("straight", "crowned"):
        drive = cases[name]
        prepared = HalfSpace().prepare(drive)
        found = prepared.balance(np.array([0.5]), drive.load.torque)
        contacts = [part.leaning_pins.contact for part in found.response.parts]
        largest[name] = max(float(each.line_load[..., (0, -1), :].max()) for each in contacts)
        coordinates = Coordinates.of_drive(drive)
        each = found.pose[0, : coordinates.discs * coordinates.own].reshape(coordinates.discs, -1)
        assert 3e-4 < np.abs(each[:, coordinates.lean_place]).max() < 1e-3
    assert largest["crowned"] < 0.7 * largest["straight"]
