"""Tables of results on the pages of ring and carrier: every printed digit is that of the analysis."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ltca.analysis.engines import HalfSpace
from ltca.analysis.loaded_analysis import analyse_cases
from ltca.drive.parts import Carrier, CarrierPosts
from ltca.drive.units.quantities import ARCSEC
from ltca.geometry.placement import position_angles
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive

DOCS = Path(__file__).resolve().parents[2] / "docs"
NUMBER = re.compile(r"[+−]?\d+(?:\.\d+)?")
ANGLES = position_angles(17)
RINGS = {"robot-joint": (60.0, 90.0, 50.0, 75.0), "rv": (80.0, 110.0, 60.0, 95.0)}
"""Inner and outer radius, width, circle of bolts, mm."""
POSTS = {
    "none": None,
    "6 of 16 mm, rigid flanges": (6, 16.0, None),
    "6 of 16 mm, flanges of 10 mm": (6, 16.0, (10.0, 10.0)),
    "3 of 20 mm, flanges of 10 mm": (3, 20.0, (10.0, 10.0)),
}


def table_of(page, head):
    """Rows of the table of a page under a line that has the words `head`: cells of each."""
    lines = (DOCS / page).read_text(encoding="utf-8").splitlines()
    start = next(number for number, line in enumerate(lines) if line.startswith("|") and head in line)
    rows = []
    for line in lines[start + 2 :]:
        if not line.startswith("|"):
            break
        rows.append([cell.strip() for cell in line.strip().removeprefix("|").removesuffix("|").split("|")])
    return rows


def assert_printed(cells, values):
    """Numbers in cells, in their order, are the values rounded as they are printed."""
    printed = NUMBER.findall(" ".join(cells))
    assert len(printed) == len(values), (cells, values)
    for text, value in zip(printed, values, strict=True):
        # half a unit of the last digit, and round-off of values that stand in the middle
        half = 0.5 * 10.0 ** -len(text.partition(".")[2]) + 1e-9 * abs(value)
        assert abs(float(text.replace("−", "-")) - value) <= half, (cells, text, value)


def ring_cases(name):
    rigid = load_drive(name).cases["nominal"]
    inner, outer, width, circle = RINGS[name]
    free = {"inner_radius": inner, "outer_radius": outer, "width": width}
    bolted = {**free, "bolts": {"number": 12, "circle_radius": circle, "stiffness": 1e6}}
    return {
        "rigid": rigid,
        "free": with_fields(rigid, {"ring": free}),
        "bolted": with_fields(rigid, {"ring": bolted}),
        "built-in": with_fields(rigid, {"ring": {**free, "flange": "built-in"}}),
    }


def angles_of(analysis):
    """Mean amounts of transmission error and wind-up, seconds of arc."""
    return float(np.abs(analysis.transmission_error).mean()) * ARCSEC, float(analysis.wind_up.mean()) * ARCSEC


@pytest.mark.slow
def test_the_table_of_the_ring_is_that_of_the_analysis():
    rows = table_of("how-to/ring.md", "pins that carry")
    assert len(rows) == 8
    for first, name in ((0, "robot-joint"), (4, "rv")):
        found = dict(analyse_cases(ring_cases(name), ANGLES, engine=HalfSpace()))
        rigid = found["rigid"]
        loads, angles = rigid.full.response.pin_load, angles_of(rigid)
        for row, (kind, analysis) in zip(rows[first : first + 4], found.items(), strict=True):
            assert row[0].endswith(kind)
            own = analysis.full.response.pin_load
            largest = own.max()
            carry = np.count_nonzero(own > 1e-3 * largest, axis=1)
            expected = [largest]
            for angle, before in zip(angles_of(analysis), angles, strict=True):
                expected += [angle] if kind == "rigid" else [angle, 100.0 * (angle / before - 1.0)]
            expected += [carry.min(), carry.max()]
            if kind != "rigid":
                expected.insert(1, 100.0 * (largest / loads.max() - 1.0))
                expected.append(100.0 * np.abs(own - loads).max() / loads.max())
            assert_printed(row[1:], expected)


@pytest.mark.slow
def test_the_table_of_the_carrier_is_that_of_the_analysis():
    rows = table_of("how-to/carrier.md", "`rv`: wind-up")
    assert len(rows) == len(POSTS)
    for first, name in ((1, "rv"), (4, "sleeved")):
        drive = next(iter(load_drive(name).cases.values()))
        circle = drive.crank.circle_radius if name == "rv" else drive.pin_shaft.pin_circle_radius
        cases = {}
        for words, built in POSTS.items():
            carrier = None
            if built is not None:
                number, size, flange = built
                carrier = Carrier(posts=CarrierPosts(number=number, radius=circle, size=size), flange=flange)
            cases[words] = replace(drive, carrier=carrier)
        found = analyse_cases(cases, ANGLES, engine=HalfSpace())
        for row, (words, analysis) in zip(rows, found, strict=True):
            assert row[0].startswith(words)
            expected = [angles_of(analysis)[1], analysis.full.response.pin_load.max()]
            if words != "none":
                expected.append(np.mean(analysis.compliance_shares["carrier"]))
            assert_printed(row[first : first + 3], expected)


@pytest.mark.nightly
def test_the_table_of_plane_rings_is_that_of_the_analysis():
    rows = table_of("theory/ring_elements.md", "free ring, mm")
    for first, name, radii in ((0, "robot-joint", (60.5, 72.0, 30.0)), (2, "rv", (80.5, 95.0, 60.0))):
        rigid = load_drive(name).cases["nominal"]
        ring = dict(zip(("inner_radius", "outer_radius", "width"), radii, strict=True))
        cases = {"rigid": rigid} | {
            model: with_fields(rigid, {"ring": {**ring, "model": model}}) for model in ("beam", "fe")
        }
        angles = [angles_of(analysis) for _, analysis in analyse_cases(cases, ANGLES, engine=HalfSpace())]
        for row, values in zip(rows[first : first + 2], zip(*angles, strict=True), strict=True):
            assert_printed(row[2:], values)
