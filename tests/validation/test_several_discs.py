"""Drives of several discs and a held wheel: compared disc by disc, rows and report say which disc. No finite elements here."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import validation.compare.derived_coefficients as derived
from fem.options import SolutionOptions
from ltca.analysis.loaded_analysis import analyse
from ltca.drive.deviations import DiscClearance, OneDisc, Runout
from ltca.drive.single_discs import single_discs
from ltca.reading.changes import with_fields
from ltca.testing.closed_form_bodies import without_coupling
from validation.compare.compared_positions import compare_case
from validation.compare.finite_element_positions import FullPosition, answer_of_summary, disc_case
from validation.compare.model_positions import answers_of
from validation.levels.closed_forms import power_rows
from validation.levels.flexible_disc import FlexibilityEffect, turn_figures
from validation.levels.positions import compare_position_rows
from validation.report.page import write_report
from validation.report.scene import position_scene
from validation.rows import failed_rows
from validation.study import Plan, Study, first_disc

ANGLES = (0.2,)


@pytest.fixture(scope="module")
def drive(paper_cases):
    """Two discs, one with a runout, on a held wheel."""
    held = with_fields(paper_cases["CS-3"], {"installation.held": "pin-wheel"})
    of = (OneDisc(runout=Runout(amount=0.004, angle=0.5)), OneDisc())
    return replace(held, disc=replace(held.disc, number_of_discs=2, of=of))


@pytest.fixture(scope="module")
def positions(drive, no_stress):
    """What the half-space says of each disc stands for the full solution."""
    analysis = analyse(drive, np.array(ANGLES))
    return [
        FullPosition(
            case=disc_case("CS-3", disc, 2), crank_angle=angle, answer=answers_of(own)[row], stress=no_stress,
            residual=0.0, unknowns=1000, seconds=1.0, pictures=None, disc=disc,
        )
        for row, angle in enumerate(ANGLES)
        for disc, own in enumerate(analysis.discs)
    ]  # fmt: skip


@pytest.fixture(scope="module")
def coefficients(drive):
    return tuple(without_coupling(single) for single in single_discs(drive))


@pytest.fixture(scope="module")
def compared(drive, positions, coefficients):
    return compare_case(drive, positions, coefficients)


@pytest.mark.slow
def test_every_disc_meets_its_own_answer(compared, drive):
    """The half-space's answer to a disc is its own at every position, and not that of the other disc."""
    assert [item.full.case for item in compared] == ["CS-3, disc 0", "CS-3, disc 1"]
    for item, single in zip(compared, single_discs(drive), strict=True):
        difference = item.differences["half-space"]
        assert difference.worst_load[2] == 0.0
        assert difference.wheel_angle == difference.disc_displacement == 0.0
        assert item.drive == single
    first, second = compared
    assert first.full.answer.wheel_angle == second.full.answer.wheel_angle
    assert first.full.answer.bearing_tangential != pytest.approx(second.full.answer.bearing_tangential, rel=1e-3)
    rows = [row for item in compared for row in compare_position_rows(item) if row.model == "half-space"]
    assert {row.case for row in rows} == {"CS-3, disc 0", "CS-3, disc 1"}


def test_an_analysis_of_several_discs_has_no_one_answer(drive):
    with pytest.raises(ValueError, match="unpack"):
        answers_of(analyse(drive, np.array(ANGLES)))


@pytest.mark.slow
def test_parts_stand_on_the_eccentric_of_their_disc(compared, drive):
    """The race of the second disc lies half a turn from that of the first; loaded pins touch its flank."""
    first, second = (position_scene(item) for item in compared)
    races = [np.array(scene["cranks"][0][2:]) for scene in (first, second)]
    np.testing.assert_allclose(races[0], -races[1], atol=1e-3)
    for scene, race in zip((first, second), races, strict=True):
        for contact in scene["contacts"]:
            if contact["kind"] == "roller_outer":  # pushes on the bore of this disc: away from its race
                away = np.array(contact["at"]) - race
                assert np.dot(away / np.linalg.norm(away), contact["to"]) > 0.9


@pytest.mark.slow
def test_report_of_several_discs(compared, drive, coefficients, tmp_path):
    analysis = analyse(drive, np.array(ANGLES))
    figures = turn_figures(analysis)
    assert figures.max_pin_load == max(own.full.response.pin_load.max() for own in analysis.discs)
    effect = FlexibilityEffect(turn=dict.fromkeys(("half-space", "fe", "hybrid"), figures), by_torque={})
    rows = tuple(row for item in compared for row in compare_position_rows(item))
    plan = Plan(name="two", drives={"CS-3": drive}, crank_angles=ANGLES, level="quick", options=SolutionOptions())
    study = Study(
        plan=plan, rows=rows, compared={"CS-3": compared}, flexibility={"CS-3": effect},
        coefficients={"CS-3": coefficients},
    )  # fmt: skip
    page = write_report(study, tmp_path / "report.html").read_text(encoding="utf-8")
    for disc in (0, 1):
        assert f'"CS-3, disc {disc}":{{"outline"' in page


@pytest.mark.slow
def test_power_balance_of_every_disc(drive, paper_cases):
    rows = power_rows(drive)
    assert [row.quantity[-6:] for row in rows] == ["disc 0", "disc 1"]
    # What a disc carries swings with the position, and so do the works of its two sides: the sum alone is closed.
    assert not failed_rows(rows), [row.difference for row in rows]
    held = with_fields(paper_cases["CS-3"], {"installation.held": "pin-wheel"})
    (row,) = power_rows(held)
    assert row.passed
    assert row.reference == pytest.approx(377_300.0 * 14.0 / 13.0 / (14.0 * 4.0), rel=3e-4)


def test_summary_of_several_discs_is_read_by_disc(drive):
    loads = {name: [[1.0], [2.0]] for name in ("pin_load_N", "pin_pressure_max_MPa", "pin_half_width_mm")}
    loads |= {name.replace("pin_", "pin_shaft_"): value for name, value in loads.items()}
    for side in ("outer", "inner"):
        loads |= {f"roller_{what}_{side}_{unit}": [[1.0], [2.0]]
                  for what, unit in (("load", "N"), ("pressure_max", "MPa"), ("half_width", "mm"))}  # fmt: skip
    summary = loads | {
        "crank_angle_rad": 0.3, "wheel_angle_rad": -1e-3, "bearing_radial_N": [5.0, 6.0],
        "bearing_tangential_N": [7.0, 8.0],
        "disc_displacement": [{"x_mm": 1.0, "y_mm": 0.0, "rotation_rad": 1e-4}, {"x_mm": 0.0, "y_mm": 2.0, "rotation_rad": 2e-4}],
    }  # fmt: skip
    answer = answer_of_summary(summary, single_discs(drive)[1], 1)
    assert (answer.kinds["pin"].load.item(), answer.bearing_radial, answer.bearing_tangential) == (2.0, 6.0, 8.0)
    along = 2.0j * np.exp(-1j * (0.3 + np.pi))  # its eccentricity stands half a turn on
    assert answer.disc_radial == pytest.approx(along.real)
    assert answer.disc_tangential == pytest.approx(along.imag)
    assert answer.disc_rotation == 2e-4


def test_coefficients_of_each_distinct_disc(drive, monkeypatch, tmp_path):
    asked = []

    def found(single, case, folder, **options):
        asked.append(single)
        return f"file {len(asked)}", without_coupling(single)

    monkeypatch.setattr(derived, "coefficients_of", found)
    files, own = derived.disc_coefficients_of(drive, "CS-3", tmp_path)
    assert files == {"CS-3": "file 1"}
    assert len(own) == 2
    wide = replace(drive, disc=replace(drive.disc, of=(OneDisc(), OneDisc(clearance=DiscClearance(bearing=0.01)))))
    files, _ = derived.disc_coefficients_of(wide, "CS-3", tmp_path)
    assert list(files) == ["CS-3, disc 0", "CS-3, disc 1"]
    alone = replace(drive, disc=replace(drive.disc, number_of_discs=1, of=()))
    files, single = derived.disc_coefficients_of(alone, "CS-3", tmp_path)
    assert list(files) == ["CS-3"]
    assert not isinstance(single, tuple)


def test_the_first_disc_alone_carries_its_part(drive, paper_cases):
    assert first_disc(paper_cases["CS-1"], "CS-1") == ("CS-1", paper_cases["CS-1"])
    label, alone = first_disc(drive, "CS-3")
    assert label == "CS-3, disc 0 alone"
    assert alone.load.torque == drive.load.torque / 2.0
    assert alone.disc.runout.amount == 0.004
