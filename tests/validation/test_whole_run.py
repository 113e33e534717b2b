"""The whole validation with real finite elements: all levels, interrupted and resumed; no row may fail.

With full FE at the default size this is the gate of the paper's drive: LTCA on FE coefficients within 0.5 % of the largest
load, 2 % pressure and 0.3″. `test_gate` has another drive.
"""

from __future__ import annotations

import argparse
import json
import shutil
from dataclasses import replace

import pytest

import validation.compare.derived_coefficients
import validation.compare.finite_element_positions
import validation.levels.flexible_disc
import validation.report.costs
import validation.study
from fem.coefficients.dataset import derive_coefficients
from validation.commands import validate
from validation.levels.other_code_problems import CODES
from validation.rows import LEVELS

pytestmark = [pytest.mark.slow, pytest.mark.nightly]

WORDS = ("paper", "--case", "CS-3", "--angles", "0.5")


@pytest.fixture(scope="module", autouse=True)
def coarse():
    """Coefficients on coarser meshes (as in `test_gate`; plane stress only informs), other codes as stored, short turns."""

    def derive(drive, *, size, state, **options):
        gated = state == "strain" and drive.clearance.bearing > 0.0
        return derive_coefficients(drive, size=1.5 if gated else 2.0, state=state, **options)

    with pytest.MonkeyPatch.context() as patch:
        # These two have tests of their own and do not depend on the run: once is enough.
        for name in ("check_closed_forms", "compare_printed_results"):
            patch.setattr(validation.study, name, once(getattr(validation.study, name)))
        # Only printed.
        patch.setattr(validation.report.costs, "POSITIONS", 2)
        patch.setattr(validation.levels.flexible_disc, "TURN_POSITIONS", 12)
        patch.setattr(validation.levels.flexible_disc, "TORQUES", (1.0,))
        patch.setattr(validation.compare.derived_coefficients, "derive_coefficients", derive)
        for name, code in CODES.items():
            patch.setitem(CODES, name, replace(code, installed=lambda: False, ours=computed_once(code.ours)))
        yield


def computed_once(function):
    found = once(lambda: [function()])
    return lambda: found()[0]


def once(function):
    found = []

    def call(*words):
        if not found:
            found.extend(function(*words))
        return list(found)

    return call


def run(out, *words):
    parser = argparse.ArgumentParser()
    validate.configure(parser)
    return validate.execute(parser.parse_args([*WORDS, *words, "--out", str(out)]))


def test_interrupted_and_resumed_gives_the_same_files(tmp_path, monkeypatch):
    real = validation.study.study_case

    def interrupt(*words):
        raise KeyboardInterrupt

    monkeypatch.setattr(validation.study, "study_case", interrupt)
    with pytest.raises(KeyboardInterrupt):
        run(tmp_path / "first")
    assert list((tmp_path / "first" / "kept" / "positions").glob("*.json"))
    assert not (tmp_path / "first" / "report.html").exists()
    monkeypatch.setattr(validation.study, "study_case", real)

    # The second run is told nothing but the coefficients: it solves its positions itself.
    shutil.copytree(tmp_path / "first" / "kept" / "coefficients", tmp_path / "second" / "kept" / "coefficients")
    status = run(tmp_path / "second")
    content = json.loads((tmp_path / "second" / "validation.json").read_text(encoding="utf-8"))
    rows = content["rows"]
    assert {row["level"] for row in rows} == set(LEVELS)
    assert len(rows) >= 40
    assert [row for row in rows if not row["pass"]] == []
    assert status == 0
    held = [row for row in rows if row["level"] == 5 and row["model"] == "fe" and row["against"] == "full FE"]
    for quantity, limit, at_least in (
        ("load", 5e-3, 10), ("peak pressure at mid-width", 2e-2, 10), ("half-width", 2e-2, 10), ("wheel angle", 0.3, 1),
        ("largest shear stress in the disc below a contact", 3e-2, 8), ("stress along the flank, worst station", 2e-2, 1),
        ("stress along the bore, worst station", 2e-2, 1), ("stress along the hole walls, worst station", 2e-2, 1),
    ):  # fmt: skip
        limits = [row["limit"] for row in held if row["quantity"] == quantity]
        assert set(limits) == {limit}, quantity
        assert len(limits) >= at_least, quantity
    # The gate is worth something: half-spaces are a quarter off here.
    worst = content["headline"]["worst_difference_from_full_fe"]
    assert abs(worst["half-space"]["load"]["difference"]) > 0.1

    def forbidden(*words, **options):
        raise AssertionError("solved again")

    monkeypatch.setattr(validation.compare.finite_element_positions, "solve_reducer", forbidden)
    monkeypatch.setattr(validation.compare.derived_coefficients, "derive_coefficients", forbidden)
    # resumed: what was kept before the interruption carries the run to the same bytes, nothing is solved again
    assert run(tmp_path / "first") == status
    for name in ("report.html", "validation.json", "rows.csv"):
        assert (tmp_path / "first" / name).read_bytes() == (tmp_path / "second" / name).read_bytes(), name
