"""Samples that bind: counted, told, and no samples that keep a limit of the backlash."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from pyarrow import parquet

from ltca.analysis.engines import HalfSpace
from ltca.arrays import stack_drives
from ltca.commands.actions.study import _print
from ltca.commands.program import main
from ltca.drive.fields import read_field
from ltca.drive.single_discs import single_discs
from ltca.drive.units.quantities import ARCMIN
from ltca.geometry.interference import FLANK, HOLES
from ltca.geometry.pairs import ContactGeometry
from ltca.geometry.play import CLOSED, free_play, least_overlap
from ltca.page.studies.samples import samples_page
from ltca.page.study_page import study_page
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive, parse_drive
from ltca.studies.binding import LARGEST, LEAST, find_binding, pairs_that_a_length_moves
from ltca.studies.bound_samples import NO_BACKLASH, samples_that_bind
from ltca.studies.execution.storage import StudyFolder
from ltca.studies.execution.workers import Workers
from ltca.studies.run_study import StudySummary, run_study
from ltca.studies.study import BatchResult, run_batch
from ltca.studies.study_results import read_binds, summarise_quantity
from ltca.studies.tolerance_study import tolerance_study
from ltca.studies.yields import find_yield
from ltca.testing.field_changes import change_of

TOOLKIT = Path(__file__).parents[2] / "literature" / "public_drives" / "toolkit_14_to_1.toml"
TOLERANCES = """
[tolerances]
pin_wheel.pin_errors.radial = { distribution = "uniform", tolerance = 0.08 }
[limits]
max_backlash_output = 60.0
"""
VALUES = {
    LARGEST: np.array([50.0, 30.0, 0.0, 70.0, 5e-4, np.nan]),
    LEAST: np.array([40.0, 0.0, 0.0, 20.0, 0.0, np.nan]),
}
"""Two samples keep the limit of 60′ and move, of which one binds at some position; two bind at all of them, one is too loose."""


def toolkit(offset=0.05, hole=2.3, tolerances=TOLERANCES):
    """A printed drive with a play of that offset at the flank, of its holes less pin and eccentricity there."""
    text = TOOLKIT.read_text(encoding="utf-8").replace("equidistant_offset = 0.2", f"equidistant_offset = {offset}")
    return parse_drive(text.replace("hole_radius = 2.2", f"hole_radius = {hole}") + tolerances)


def study_of(file, samples=6, quantities=None):
    return tolerance_study(file, samples=samples, positions=2, quantities=quantities, engine=HalfSpace())


def summary_of(study, values):
    binding = find_binding(study, values)
    judged = find_yield(study.judged, values, study.design, study.not_judged, binding.keeps_no_limit)
    return StudySummary(
        quantities={name: summarise_quantity(each) for name, each in values.items()}, nominal={},
        ranking={"method": "regression", "quantities": {}}, judged=judged, binding=binding, failures=(), solved_positions=0,
        seconds=1.0,
    )  # fmt: skip


def test_bound_parts_were_counted_as_a_kept_limit_of_the_backlash():
    """Zero is below 60′: four of six samples kept it, of which one moves at every position."""
    study = study_of(toolkit())
    assert {LARGEST, LEAST} <= set(study.quantities)  # the least comes with the largest
    found = summary_of(study, VALUES)
    (kept,) = (kept for one, kept in found.judged.each if one.quantity == LARGEST)
    assert (kept.kept, kept.samples) == (1, 6)
    assert (found.binding.counted.kept, found.binding.counted.samples) == (3, 6)
    assert found.binding.content()["binding"] == 3
    (told,) = found.binding.words()
    assert "3 of 6 samples bind" in told
    assert "[limits] min_backlash_output" in told
    page = study_page(samples_page(study, found, VALUES))
    assert "3 of 6 samples bind" in page


def test_samples_that_bind_at_some_position_were_not_counted_where_the_largest_backlash_alone_was_asked_for():
    """Two of six samples were said to bind "at some position": those whose largest backlash is zero, that at every one."""
    study = study_of(toolkit(), quantities=(LARGEST,))
    assert study.quantities == (LARGEST, LEAST)
    assert find_binding(study, VALUES).counted.kept == 3
    without = find_binding(study, {LARGEST: VALUES[LARGEST]})  # of a study that was kept before
    assert without.counted is None
    assert not np.any(without.each)


def test_a_limit_of_the_least_backlash_is_not_suggested_twice():
    file = toolkit(tolerances=TOLERANCES + "min_backlash_output = 0.0\n")
    found = summary_of(study_of(file), VALUES)
    (told,) = found.binding.words()
    assert "min_backlash_output" not in told
    kept = {one.quantity: kept.kept for one, kept in found.judged.each if one.quantity in VALUES}
    assert kept == {LARGEST: 1, LEAST: 2}  # without a play there is no least one, also where 0′ are asked for


def test_drives_that_are_preloaded_as_drawn_bind_as_they_are_meant_to():
    study = study_of(toolkit(offset=-0.01))
    found = summary_of(study, VALUES)
    (kept,) = (kept for one, kept in found.judged.each if one.quantity == LARGEST)
    assert kept.kept == 4
    assert "overlap as drawn" in found.binding.words()[0]


def test_printed_tolerances_beyond_the_play_suggest_a_limit():
    """A study without the backlash said nothing of samples that bind. Tolerances of hundredths, and wide plays, say nothing."""
    asked, values = ("max_pin_load",), {"max_pin_load": np.ones(6)}
    found = find_binding(study_of(toolkit(), quantities=asked), values)
    (told,) = found.words()
    assert (
        "tolerances.pin_wheel.pin_errors.radial of ±0.08 mm is beyond the play of wheel pins and flank, 0.05 mm" in told
    )
    assert "[limits] min_backlash_output" in told
    assert found.counted is None
    wide = toolkit(offset=0.1, hole=2.3)
    assert find_binding(study_of(wide, quantities=asked), values).words() == []
    fine = toolkit(offset=0.005, tolerances=TOLERANCES.replace("0.08", "0.02"))
    assert find_binding(study_of(fine, quantities=asked), values).words() == []


def test_a_tolerance_of_wheel_pins_is_compared_with_the_play_of_the_flank():
    """It named the holes, whose play is the least, 2.22 - 1.2 - 1 mm, and in which no wheel pin acts."""
    study = study_of(toolkit(offset=0.06, hole=2.22), quantities=("max_pin_load",))
    (message,) = find_binding(study, {"max_pin_load": np.ones(6)}).words()
    assert "pin_errors.radial of ±0.08 mm is beyond the play of wheel pins and flank, 0.06 mm" in message


def test_no_sample_that_binds_is_said_of_wide_tolerances_alone():
    study = study_of(toolkit())
    moving = {name: np.full(6, 20.0) for name in VALUES}
    found = summary_of(study, moving)
    assert found.binding.words() == ["none of 6 samples binds, without backlash at some position: 0.0 % (0.0 … 45.9 %)"]
    assert found.binding.counted.kept == 0
    fine = study_of(toolkit(tolerances=TOLERANCES.replace("0.08", "0.02")))
    assert summary_of(fine, moving).binding.words() == []


def test_samples_that_bind_by_their_geometry_are_those_without_backlash():
    """The count by default and that by the least backlash are one."""
    study = study_of(toolkit(offset=0.06, tolerances=TOLERANCES.split("[limits]", maxsplit=1)[0]), samples=24)
    drives, angle = [study.sample_drive(number) for number in range(24)], np.tile([0.3, 2.0, 4.4], 24)
    model = stack_drives([HalfSpace().model(drive, in_batch=True) for drive in drives], 3)
    play = free_play(model.geometries, angle).play.reshape(24, 3) * ARCMIN
    least = play.min(axis=1) * [abs(drive.output_per_wheel_angle) for drive in drives]
    assert 0 < np.sum(least <= NO_BACKLASH) < 24
    np.testing.assert_array_equal(samples_that_bind(model, drives, angle), least <= NO_BACKLASH)


def test_which_samples_bind_goes_through_batches_to_the_files(tmp_path):
    study = study_of(toolkit(), quantities=("max_pin_load",))
    folder, binds = StudyFolder(path=tmp_path), np.array([True, False, True, False, False, True])
    folder.prepare(study, resume=False)
    rows = {"factors": study.design.rows(0, 6), "values": np.ones((6, 1)), "messages": ("",) * 6}
    folder.store(study, BatchResult(number=0, binds=binds, **rows))
    folder.finish(study)
    np.testing.assert_array_equal(read_binds(folder.results), binds)
    assert parquet.read_table(folder.table)["binds"].to_pylist() == binds.tolist()
    values = {"max_pin_load": np.ones(6)}
    assert find_binding(study, values, binds).counted.kept == 3
    (told,) = find_binding(study, values, binds).words()
    assert "3 of 6 samples bind" in told


@pytest.mark.slow
def test_samples_that_bind_were_counted_where_the_backlash_was_asked_for_alone(tmp_path):
    """`samples may bind: name min_backlash_output among --quantities` stood where printed tolerances let 3 of 40 bind."""
    tolerances = TOLERANCES.split("[limits]", maxsplit=1)[0]
    file = toolkit(offset=0.06, tolerances=tolerances)
    study = tolerance_study(file, samples=12, positions=2, quantities=("max_pin_load",), engine=HalfSpace())
    assert study.counts_binding
    assert study.quantities == ("max_pin_load",)
    found = run_study(study, StudyFolder(path=tmp_path / "out"), Workers())
    asked = tolerance_study(file, samples=12, positions=2, quantities=(LEAST,), engine=HalfSpace())
    assert not asked.counts_binding
    least = run_batch(asked, 0).values[:, 0]
    assert 0 < found.binding.counted.kept < 12
    np.testing.assert_array_equal(found.binding.each, least <= NO_BACKLASH)
    np.testing.assert_array_equal(read_binds(tmp_path / "out" / "results.nc"), found.binding.each)
    (told,) = found.binding.words()
    assert f"{found.binding.counted.kept} of 12 samples bind" in told
    summary = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    assert summary["binding"]["binding"] == found.binding.counted.kept


def test_what_prints_cannot_make_bind_is_not_counted():
    asked = ("max_pin_load",)
    assert study_of(toolkit(), quantities=asked).counts_binding
    assert not study_of(toolkit(tolerances=TOLERANCES.replace("0.08", "0.02")), quantities=asked).counts_binding
    assert not study_of(toolkit(offset=-0.01), quantities=asked).counts_binding  # preloaded as it is meant to be
    thick = '[tolerances]\ndisc.thickness = { distribution = "uniform", tolerance = 0.2 }\n'
    assert not study_of(toolkit(tolerances=thick), quantities=asked).counts_binding


@pytest.mark.parametrize("pin", [0.0, 0.04, 0.08])
def test_poses_without_overlap_are_found_where_the_play_says_so(pin):
    """One pin in and its neighbours out by more than the play: a few programmes against the free play."""
    drive = toolkit(tolerances="").cases["nominal"]
    pins = drive.pin_wheel.number_of_pins
    errors = [0.0, pin, -pin, pin] + [0.0] * (pins - 4)
    drive = with_fields(drive, {"pin_wheel.pin_errors.radial": tuple(errors)}, check=False)
    discs = [ContactGeometry.of_drive(single) for single in single_discs(drive)]
    angle = np.linspace(0.0, 6.0, 5)
    np.testing.assert_array_equal(least_overlap(discs, angle) > CLOSED, free_play(discs, angle).preloaded)


def test_a_nominal_column_did_not_say_that_it_is_sampled(tmp_path, capsys):
    """The transmission error of a drive was 178″ by `cyclo run` and 154″ in the nominal column of `cyclo tolerance`."""
    study = study_of(toolkit(), quantities=("max_pin_load",))
    values = {"max_pin_load": np.ones(6)}
    found = summary_of(study, values)
    words = "over 2 sampled positions of a turn, not refined between them as those of cyclo run are"
    assert words in study_page(samples_page(study, found, values))
    _print(study, StudyFolder(path=tmp_path), found, values, "")
    assert words in capsys.readouterr().out


@pytest.mark.slow
def test_samples_that_bind_stand_in_terminal_and_summary(tmp_path, capsys):
    """Pins off by up to 0.08 mm in a play of 0.05 mm: pins that stand in and out leave the wheel no play."""
    path = tmp_path / "printed.toml"
    text = TOOLKIT.read_text(encoding="utf-8").replace("equidistant_offset = 0.2", "equidistant_offset = 0.05")
    path.write_text(text + TOLERANCES, encoding="utf-8")
    small = [
        "--samples",
        "12",
        "--positions",
        "5",
        "--quantities",
        LARGEST,
        LEAST,
        "--quick",
        "--no-figures",
        "--no-page",
    ]
    main(["tolerance", str(path), *small, "--out", str(tmp_path / "out")])
    told = capsys.readouterr().out
    summary = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    bound = summary["binding"]["binding"]
    assert bound > 0
    assert f"{bound} of 12 samples bind" in told
    assert summary["quantities"][LEAST]["smallest"] == pytest.approx(0.0, abs=1e-6)
    (limit,) = (one for one in summary["yield"]["limits"] if one["quantity"] == LARGEST)
    assert limit["kept"] <= 12 - bound


@pytest.mark.parametrize(
    ("path", "pairs"),
    [
        ("pin_wheel.pin_radius", []),  # the flank is generated with it
        ("pin_wheel.pin_errors.diameter", [FLANK]),
        ("pin_wheel.pin_errors.radial", [FLANK]),
        ("disc.runout.amount", [FLANK]),
        ("disc.of.0.profile_errors.deviation", [FLANK]),
        ("pin_shaft.hole_radius", [HOLES]),
        ("disc.hole_errors.tangential", [HOLES]),
        ("crank.eccentricity", [HOLES]),  # the flank is generated with it
        ("crank.eccentricity_error", [FLANK, HOLES]),
        ("crank_bearing.roller_errors.diameter", [FLANK, HOLES]),
        ("clearance.bearing", [FLANK, HOLES]),
        ("pin_shaft.pin_circle_radius", []),  # pins and holes share the circle
        ("pin_wheel.core_radius", []),
        ("disc.thickness", []),
        ("main_bearing.clearance", []),
        ("materials.disc.hardness_depth", []),
    ],
)
def test_a_length_acts_where_it_moves_a_gap(path, pairs):
    """Fields were listed by hand: lengths along the axis and of other members counted as acting in both pairs."""
    contract = load_drive(Path(__file__).parents[2] / "contract" / "drive.toml").cases["nominal"]
    base, change = change_of(contract, path)
    drive = with_fields(base, change, check=False)
    assert pairs_that_a_length_moves(drive, path, np.atleast_1d(read_field(drive, path))) == pairs


def test_a_wide_tolerance_of_the_thickness_was_said_to_bind():
    tolerances = '[tolerances]\ndisc.thickness = { distribution = "uniform", tolerance = 0.2 }\n'
    study = study_of(toolkit(tolerances=tolerances), quantities=("max_pin_load",))
    assert find_binding(study, {"max_pin_load": np.ones(6)}).words() == []
