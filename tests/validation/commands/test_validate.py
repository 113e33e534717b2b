"""The command: exit status, messages, wrong input."""

from __future__ import annotations

import argparse
from dataclasses import replace

import pytest

import validation.report.costs
import validation.study
from fem.options import SolutionOptions
from ltca.errors import CycloError
from ltca.output.run_folder import MANIFEST
from validation.commands import validate
from validation.rows import failed_rows
from validation.study import plan_study


def run(*words):
    parser = argparse.ArgumentParser()
    validate.configure(parser)
    return validate.execute(parser.parse_args(words))


def keep(rows, passed):
    return tuple(row for row in rows if row.passed is passed)


@pytest.mark.slow
@pytest.mark.parametrize("status", [0, 1])
def test_a_failed_row_makes_the_exit_status_one(status, small_study, tmp_path, monkeypatch, capsys):
    rows = keep(small_study.rows, True)
    if status:
        rows += (replace(rows[0], quantity="broken figure", difference=1.0, limit=0.1),)
    study = replace(small_study, rows=rows)
    monkeypatch.setattr(validation.study, "run_validation", lambda plan, folder, step, say: study)
    # Times are printed, not tested: a short turn tells as much.
    monkeypatch.setattr(validation.report.costs, "POSITIONS", 2)
    monkeypatch.setattr(validation.report.costs, "REPEATS", 1)
    assert run("paper", "--out", str(tmp_path)) == status
    out = capsys.readouterr().out
    assert ("FAILED" in out) == bool(status)
    assert ("broken figure" in out) == bool(status)
    assert {path.name for path in tmp_path.iterdir()} == {"report.html", "validation.json", "rows.csv", MANIFEST}
    assert ("fail their limit" in (tmp_path / "report.html").read_text(encoding="utf-8")) == bool(status)


@pytest.mark.slow
def test_the_small_study_fails_where_it_should(small_study):
    """Full loads 1 % larger than the half-space's: fe without coefficients is far from that, and rows say so."""
    failed = failed_rows(small_study.rows)
    assert failed
    assert {row.model for row in failed} == {"fe"}


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["paper", "--case", "CS-9"], "CS-9"),
        (["paper", "--size", "0"], "--size"),
        (["paper", "--size", "nan"], "--size"),
        (["paper", "--angles", "ten"], "--angles"),
        (["nowhere.toml"], "nowhere.toml"),
    ],
)
def test_wrong_input_is_one_error(words, message, tmp_path):
    with pytest.raises(CycloError, match=message):
        run(*words, "--out", str(tmp_path / "out"))
    assert not (tmp_path / "out").exists()


def test_out_must_not_be_a_file(tmp_path):
    (tmp_path / "file").write_text("x", encoding="utf-8")
    with pytest.raises(CycloError, match="is a file"):
        run("paper", "--out", str(tmp_path / "file"))


def test_default_plan(paper_cases):
    from ltca.reading.drive_file import load_drive

    file = load_drive("paper")
    quick = plan_study(file, None, None, "quick", SolutionOptions())
    full = plan_study(file, None, None, "full", SolutionOptions())
    assert list(quick.drives) == list(full.drives) == ["CS-1", "CS-3", "CS-6"]
    assert len(quick.crank_angles) == 2
    # twelve angles over one period of the flank, 2π/13, end not included
    assert len(full.crank_angles) == 12
    period = 2.0 * 3.141592653589793 / 13.0
    assert full.crank_angles[1] == pytest.approx(period / 12.0)
    assert max(full.crank_angles) < period
    chosen = plan_study(file, ["CS-2"], [0.1, 0.1], "quick", SolutionOptions())
    assert list(chosen.drives) == ["CS-2"]
    assert chosen.crank_angles == (0.1,)


def figure_of_the_manual(value):
    from validation.manual.case import relative_figure

    return relative_figure("quantity", value, 1.0, "N", 0.1, "why", numerical_error=0.01, numerical_origin="how")


@pytest.mark.slow
@pytest.mark.parametrize(("value", "status"), [(1.05, 0), (1.2, 1)])
def test_manual_exits_with_its_verdict(value, status, tmp_path, monkeypatch, capsys):
    from validation.manual import register

    case = replace(register.all_cases()["patch_test"], run=lambda: [figure_of_the_manual(value)])
    monkeypatch.setattr(register, "chosen_cases", lambda names: (case,))
    assert run("--manual", "--out", str(tmp_path)) == status
    word = "FAILED" if status else "PASSED"
    assert word in capsys.readouterr().out
    assert {path.name for path in tmp_path.iterdir()} == {"patch_test.md", "index.md", MANIFEST}
    for name in ("patch_test.md", "index.md"):
        assert word in (tmp_path / name).read_text(encoding="utf-8")


@pytest.mark.slow
def test_manual_writes_the_pages_that_are_named(tmp_path):
    assert run("--manual", "patch_test", "tied_pins", "--out", str(tmp_path)) == 0
    assert {path.name for path in tmp_path.iterdir()} == {"patch_test.md", "tied_pins.md", "index.md", MANIFEST}
    text = (tmp_path / "index.md").read_text(encoding="utf-8")
    assert "**2 of 2 cases pass**" in text
    assert "nafems" not in text
    # The same input gives the same bytes, into a folder that holds an earlier manual too.
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    assert run("--manual", "tied_pins", "patch_test", "--out", str(tmp_path)) == 0
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_an_interrupted_manual_goes_on_where_it_stood(tmp_path, monkeypatch, capsys):
    from validation.manual import register

    computed = []

    def first():
        computed.append("first")
        return [figure_of_the_manual(1.0 / 3.0), replace(figure_of_the_manual(float("nan")), bound=None)]

    def second():
        computed.append("second")
        if computed == ["first", "second"]:
            raise KeyboardInterrupt
        return [figure_of_the_manual(1.0)]

    known = register.all_cases()
    cases = tuple(replace(known[name], run=run) for name, run in (("patch_test", first), ("tied_pins", second)))
    monkeypatch.setattr(register, "chosen_cases", lambda names: cases)
    with pytest.raises(KeyboardInterrupt):
        run("--manual", "--out", str(tmp_path))
    assert {path.name for path in tmp_path.iterdir()} == {"patch_test.md", "index.md", "kept", MANIFEST}
    assert "Unfinished: 1 of 2 cases" in (tmp_path / "index.md").read_text(encoding="utf-8")
    page = (tmp_path / "patch_test.md").read_bytes()
    assert run("--manual", "--out", str(tmp_path)) == 1
    assert computed == ["first", "second", "second"]
    assert (tmp_path / "patch_test.md").read_bytes() == page
    assert {path.name for path in tmp_path.iterdir()} == {"patch_test.md", "tied_pins.md", "index.md", MANIFEST}
    assert "Unfinished" not in (tmp_path / "index.md").read_text(encoding="utf-8")
    assert "kept" in capsys.readouterr().out
    # A whole manual is computed anew.
    run("--manual", "--out", str(tmp_path))
    assert computed[3:] == ["first", "second"]


@pytest.mark.parametrize("damage", [b"", b"{}", b"[{}]", b"[1]", b"\xff"])
def test_damaged_figures_are_computed_again(damage, tmp_path):
    from validation.manual.kept import KeptOutcomes
    from validation.manual.register import all_cases

    kept = KeptOutcomes(folder=tmp_path)
    case = replace(all_cases()["patch_test"], run=lambda: [figure_of_the_manual(1.0)])
    kept.get(case)
    (file,) = tmp_path.iterdir()
    file.write_bytes(damage)
    assert not kept.get(case)[1]
    outcome, was_kept = kept.get(case)
    assert was_kept
    assert outcome.figures == (figure_of_the_manual(1.0),)


@pytest.mark.parametrize(
    ("words", "messages"),
    [
        (["paper", "--manual"], ["DRIVE: has no meaning with --manual"]),
        (
            ["--manual", "--case", "CS-1", "--angles", "0.5", "--level", "quick", "--size", "1"],
            [f"--{name}: has no meaning with --manual" for name in ("case", "angles", "level", "size")],
        ),
        (["--manual", "flat_punsh"], ["--manual flat_punsh: is no case of the manual; did you mean `flat_punch`"]),
        (["--manual", "krol", "krol"], ["--manual krol: is given twice"]),
        ([], ["give a drive file, or --manual"]),
    ],
)
def test_manual_refuses_by_name(words, messages, tmp_path):
    with pytest.raises(CycloError) as refused:
        # The folder first: --manual takes all words behind it.
        run("--out", str(tmp_path / "out"), *words)
    assert all(message in str(refused.value) for message in messages)
    assert not (tmp_path / "out").exists()
