"""The gate: LTCA on FE coefficients against full FE, with real data through levels 4 and 5.

The paper's drive passes it in `test_whole_run`; this one is unlike it: 19 lobes, an aluminium disc, clearances, driven
clockwise. Coefficients on elements of the default size; 1.2 times that leaves 3.01 % of the shear below a shaft pin (limit 3 %).
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from fem.options import SolutionOptions
from ltca.reading.drive_file import load_drive
from validation.compare.compared_positions import compare_case
from validation.compare.derived_coefficients import coefficients_of
from validation.compare.finite_element_positions import solve_positions
from validation.levels.coefficients import check_file
from validation.levels.disc_stresses import disc_stress_rows
from validation.levels.positions import compare_position_rows
from validation.rows import failed_rows

pytestmark = [pytest.mark.slow, pytest.mark.nightly]

DRIVE = Path(__file__).parent / "drives" / "aluminium.toml"
CRANK_ANGLE = 0.7
STRESSES = {
    "largest shear stress in the disc below a contact": {3e-2},
    "stress along the flank, worst station": {2e-2}, "stress along the bore, worst station": {2e-2},
    "stress along the hole walls, worst station": {2e-2},
}  # fmt: skip


@pytest.fixture(scope="module")
def drive():
    return load_drive(DRIVE).cases["nominal"]


@pytest.fixture(scope="module")
def full(drive, tmp_path_factory):
    """Full FE at the default size."""
    (full,) = next(
        solve_positions(drive, "nominal", [CRANK_ANGLE], tmp_path_factory.mktemp("positions"), SolutionOptions())
    )
    return full


@pytest.fixture(scope="module")
def derived(drive, tmp_path_factory):
    return coefficients_of(drive, "nominal", tmp_path_factory.mktemp("coefficients"))


def compare(drive, full, coefficients):
    (compared,) = compare_case(drive, [full], coefficients)
    return compared, [*compare_position_rows(compared), *disc_stress_rows(compared)]


def agreed_limits(rows):
    """The limits that the rows of ``fe`` stand under, by quantity."""
    names = ("load", "peak pressure at mid-width", "half-width", "wheel angle", *STRESSES)
    return {name: {row.limit for row in rows if row.quantity == name and row.model == "fe"} for name in names}


def test_another_drive_passes_the_gate(drive, full, derived):
    dataset, coefficients = derived
    assert not failed_rows(check_file(dataset, "nominal", "strain"))
    compared, rows = compare(drive, full, coefficients)
    assert not failed_rows(rows)
    assert agreed_limits(rows) == {
        "load": {5e-3}, "peak pressure at mid-width": {2e-2}, "half-width": {2e-2}, "wheel angle": {0.3},
    } | STRESSES  # fmt: skip
    # Every loaded contact is held: six pins, four rollers twice, two shaft pins, each above 5 % of the largest.
    loaded = {kind: full.answer.loaded(kind) for kind in full.answer.kinds}
    assert loaded == {"pin": 6, "roller_outer": 4, "roller_inner": 4, "hole": 2}
    held = [row for row in rows if row.model == "fe" and row.quantity == "peak pressure at mid-width"]
    assert len(held) == sum(loaded.values())
    # The gate is worth something: half-spaces, which see nothing of the aluminium disc between contacts, are far outside.
    half = compared.differences["half-space"]
    assert abs(half.worst_load[2]) > 0.1
    assert abs(half.wheel_angle) > 10.0


def test_stresses_of_the_disc_alone_make_the_shear_right(drive, full, derived):
    """Hertz' 0.300 p0 without the stress along the wall is more than 3 % off under some contact."""
    compared, rows = compare(drive, full, derived[1])
    assert sum(row.quantity.startswith("largest shear") and row.model == "fe" for row in rows) == 6 + 4 + 2
    hertz = [
        0.3003 * pressure / shear - 1.0
        for kind, found in compared.full.stress.shear.items()
        for pressure, shear in zip(compared.answers["fe"].kinds[kind].pressure, found, strict=True)
        if shear > 0.0
    ]
    assert max(map(abs, hertz)) > 3e-2
    # Stresses 5 % too large, or of a disc 5 % thinner, do not pass.
    stress = replace(derived[1].stress, stress=1.05 * derived[1].stress.stress)
    _, rows = compare(drive, full, replace(derived[1], stress=stress))
    failed = {row.quantity for row in failed_rows(rows)}
    assert failed
    assert failed <= {row.quantity for row in rows if "stress" in row.quantity}


def test_coefficients_that_are_a_little_off_do_not_pass(drive, full, derived):
    """2 % of the disc's body part move the wheel by more than 0.3″; 5 % of a half-width are more than 2 %."""
    _, coefficients = derived
    _, rows = compare(drive, full, replace(coefficients, disc=1.02 * coefficients.disc))
    assert "wheel angle" in {row.quantity for row in failed_rows(rows)}
    wider = full.answer.kinds["pin"]
    answer = replace(
        full.answer, kinds={**full.answer.kinds, "pin": replace(wider, half_width=1.05 * wider.half_width)}
    )
    _, rows = compare(drive, replace(full, answer=answer), coefficients)
    assert {row.quantity for row in failed_rows(rows)} == {"half-width"}
