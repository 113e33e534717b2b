"""Sweeps from their file, the optimiser against problems with known answers, and the commands."""

from __future__ import annotations

import argparse
import tomllib

import matplotlib as mpl
import numpy as np
import pytest
from refusals import error_says, refused_field

from ltca.analysis.engines import Hybrid
from ltca.analysis.loaded_analysis import analyse
from ltca.commands import optimise, sweep, tolerance
from ltca.drive.fields import read_field
from ltca.drive.single_discs import single_discs
from ltca.errors import CycloError, DriveError
from ltca.figures.house_style import STYLE
from ltca.figures.optimum_figures import _search
from ltca.geometry.placement import position_angles
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive, parse_drive, shipped_drive
from ltca.reading.writing import drive_text
from ltca.studies import optimiser
from ltca.studies.optimiser import (
    Bound,
    Optimum,
    Problem,
    Variable,
    batch_analysis,
    most_candidates,
    optimise as search,
    parse_bound,
    parse_variable,
)
from ltca.studies.study import run_batch
from ltca.studies.sweep_file import load_sweep, parse_sweep
from ltca.testing.closed_form_bodies import without_coupling

STUDY = """
drive = "paper"
case = "CS-3"
positions = 13
quantities = ["ptp_transmission_error", "max_pin_load"]

[design]
kind = "grid"

[factors]
clearance.bearing = { low = 0.0, high = "30 um", levels = 3 }
"load.direction" = ["ccw", "cw"]
"""


def run(module, *words):
    parser = argparse.ArgumentParser()
    module.configure(parser)
    return module.execute(parser.parse_args([str(word) for word in words]))


def test_sweep_file_and_its_samples(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(STUDY)
    study = load_sweep(path)
    assert study.design.samples == 6
    drive = study.sample_drive(3)
    assert (drive.clearance.bearing, drive.load.direction) == (0.015, "cw")
    found = run_batch(study, 0)
    assert not any(found.messages)
    # a crank driving the other way is the mirror image: over whole turns the same, but for where the rollers stand
    loads = found.values[:, 1].reshape(3, 2)
    np.testing.assert_allclose(loads[:, 0], loads[:, 1], rtol=0.01)
    # clearance concentrates the load (the paper's Fig. 24 has it 3 % less at the flank)
    assert loads[2, 0] != loads[0, 0]


def test_cases_are_a_factor():
    table = tomllib.loads('positions = 3\nquantities = ["max_pin_load"]\nfactors.case = ["CS-1", "CS-6"]')
    study = parse_sweep(table, "paper")
    assert study.sample_drive(1) == load_drive("paper").cases["CS-6"]
    loads = run_batch(study, 0).values[:, 0]
    assert loads[0] != loads[1]


def test_numbers_of_parts_are_factors_too():
    """Drives of other shapes do not fit one batch: they are solved beside it."""
    table = tomllib.loads(
        'positions = 3\nquantities = ["max_pin_shaft_load"]\n[factors]\n"pin_shaft.number_of_pins" = [6, 8]'
    )
    found = run_batch(parse_sweep(table, "paper"), 0)
    assert not any(found.messages)
    for row, number in enumerate((6, 8)):
        drive = with_fields(load_drive("paper").cases["CS-1"], {"pin_shaft.number_of_pins": number})
        alone = analyse(drive, position_angles(3)).full.response.hole_load.max()
        assert found.values[row, 0] == pytest.approx(alone, rel=1e-6)


def test_a_sweep_over_slices_has_what_the_plane_has_too(tmp_path):
    """Of a drive in slices its sample in the plane failed over quantities of the width that nobody had named."""
    path = tmp_path / "wide.toml"
    path.write_text(drive_text(load_drive("paper").cases["CS-1"].with_fields({"contact.slices": 5})))
    table = tomllib.loads('positions = 3\n[factors]\n"contact.slices" = [1, 5]')
    study = parse_sweep(table, str(path))
    assert "max_pin_face_load_factor" not in study.quantities
    assert "max_pin_load" in study.quantities
    with error_says(DriveError, "max_pin_face_load_factor: ", " with contact.slices = 1"):
        parse_sweep(table | {"quantities": ["max_pin_face_load_factor"]}, str(path))


@pytest.mark.parametrize("kind", ["sobol", "latin-hypercube"])
def test_fractions_of_a_pin_are_refused_before_the_work(kind):
    """A range of counts was drawn as fractions, which no drive takes: the samples failed one by one."""
    head = f'design = {{ kind = "{kind}", samples = 4 }}\n[factors]\n"pin_shaft.number_of_pins" = '
    with refused_field("factors.pin_shaft.number_of_pins", "", "takes whole numbers, ", alone=True, source="study"):
        parse_sweep(tomllib.loads(f"{head}{{ low = 6, high = 10 }}"), "paper")
    for whole in ("[6, 7, 8]", "{ low = 6, high = 10, levels = 5 }"):
        assert parse_sweep(tomllib.loads(f"{head}{whole}"), "paper").samples_of(0) == (0, 4)


@pytest.fixture(scope="module")
def drive():
    return load_drive("paper").cases["CS-3"]


def quadratic(drives):
    """Two parabolas of the offsets, in place of the drive: (x − 0.12)² + (y − 0.07)² and (x − 0.2)² + (y − 0.1)²."""
    x = np.array([item.disc.equidistant_offset for item in drives])
    y = np.array([item.disc.shifting_offset for item in drives])
    first, second = (x - 0.12) ** 2 + (y - 0.07) ** 2, (x - 0.2) ** 2 + (y - 0.1) ** 2
    return np.stack([first, second], axis=1) + 1e-3


VARIABLES = (
    Variable(path="disc.equidistant_offset", low=0.1, high=0.25),
    Variable(path="disc.shifting_offset", low=0.05, high=0.13),
)


@pytest.mark.slow
def test_optimum_of_a_parabola(drive):
    problem = Problem(drive=drive, variables=VARIABLES, aims=("max_pin_load",), limits=())
    found = search(problem, lambda drives: quadratic(drives)[:, :1], seed=1)
    # the simplex ends at 1e-4 of the ranges
    np.testing.assert_allclose(found.variables[found.best], [0.12, 0.07], atol=1e-3)
    assert found.drive(found.best).disc.equidistant_offset == found.variables[found.best, 0]


@pytest.mark.slow
def test_limit_is_kept_and_met(drive):
    """Least of the first with the second at most 2e-3: on the line between both centres, where the circle cuts it."""
    limits = (Bound(quantity="max_roller_load", sense=1, value=2e-3),)
    problem = Problem(drive=drive, variables=VARIABLES, aims=("max_pin_load",), limits=limits)
    found = search(problem, quadratic, seed=1)
    line = np.array([0.08, 0.03]) / np.hypot(0.08, 0.03)
    np.testing.assert_allclose(found.variables[found.best], np.array([0.2, 0.1]) - np.sqrt(1e-3) * line, atol=2e-3)
    assert found.values[found.best, 1] <= 2e-3
    with pytest.raises(CycloError, match="none of"):
        search(
            Problem(
                drive=drive, variables=VARIABLES, aims=("max_pin_load",),
                limits=(Bound(quantity="max_roller_load", sense=1, value=1e-4),),
            ), quadratic, generations=2,
        )  # fmt: skip


@pytest.mark.slow
def test_pareto_front_is_the_line_between_the_optima(drive):
    problem = Problem(drive=drive, variables=VARIABLES, aims=("max_pin_load", "max_roller_load"), limits=())
    found = search(problem, quadratic, seed=1, generations=30)
    points = found.variables[found.front] - np.array([0.12, 0.07])
    line = np.array([0.08, 0.03]) / np.hypot(0.08, 0.03)
    across = points @ np.array([-line[1], line[0]])
    assert found.front.size >= 10
    assert np.max(np.abs(across)) < 0.01
    values = found.values[found.front]
    assert np.all(np.diff(values[:, 0]) > 0.0)
    assert np.all(np.diff(values[:, 1]) < 0.0)


@pytest.mark.parametrize(("aims", "most"), [(1, 2 * 32 + 2 * 4), (2, 3 * 2 * 32)])
def test_a_search_of_one_generation_solved_1440_candidates(drive, aims, most):
    """Sobol's 32 members and one generation of them, of three weighted problems for two aims; 4 of a simplex a variable."""
    solved = []

    def counted(drives):
        solved.append(len(drives))
        return quadratic(drives)[:, :aims]

    problem = Problem(drive=drive, variables=VARIABLES, aims=("max_pin_load", "max_roller_load")[:aims], limits=())
    found = search(problem, counted, generations=1)
    assert most_candidates(problem, 1) == most
    assert 64 < sum(solved) - 1 <= most
    assert found.front.size >= aims
    # As before from ten generations, a front from twelve.
    assert most_candidates(problem, 40) == (41 * 32 + 80 if aims == 1 else 9 * 14 * 32)


def test_names_ranges_and_limits(drive):
    found = parse_variable("equidistant_offset", drive)
    assert (found.path, found.low, found.high) == ("disc.equidistant_offset", 0.075, pytest.approx(0.225))
    assert parse_variable("disc.thickness=10:14 ", drive).high == 14.0
    assert parse_variable("load.torque=100 N m:200 N m", drive).low == 1e5
    for text, value in (
        ("min_backlash_wheel >= 8 arcmin", 8.0),
        ("min_backlash_wheel >= 8", 8.0),  # plain numbers in the unit that is printed
        ("min_backlash_wheel >= 0.001 rad", 0.001 * 10_800.0 / np.pi),
        ("ptp_transmission_error <= 0.05 arcmin", 3.0),
        ("ptp_transmission_error <= 3 arcsec", 3.0),
    ):
        assert parse_bound(text).value == pytest.approx(value), text


def test_models_of_one_drive_serve_the_optimiser(drive):
    """A model that is built for one drive at a time (finite-element coefficients are) gives what the batch gives."""
    problem = Problem(drive=drive, variables=VARIABLES, aims=("max_pin_load", "max_roller_load"), limits=())
    # Of one shape: coefficients belong to it.
    drives = [drive, with_fields(drive, {"crank.eccentricity_error": 0.01})]
    alone = batch_analysis(problem, 5, Hybrid(coefficients=without_coupling(drive), hole_near_field=False))
    np.testing.assert_allclose(alone(drives), batch_analysis(problem, 5)(drives), rtol=1e-9)


@pytest.mark.nightly
@pytest.mark.slow
def test_optimum_of_the_drive_beats_it_within_the_limit(drive):
    """By the batch solver: less transmission error, the backlash kept, and the re-run drive says the same."""
    limits = (parse_bound("max_pin_pressure_mid <= 1500 MPa"), parse_bound("min_backlash_wheel >= 8 arcmin"))
    problem = Problem(drive=drive, variables=VARIABLES, aims=("ptp_transmission_error",), limits=limits)
    analysis = batch_analysis(problem, 13)
    found = search(problem, analysis, generations=3)
    best = found.values[found.best]
    assert best[0] < 0.9 * found.start[0]
    assert best[1] <= 1500.0
    assert best[2] >= limits[1].value
    np.testing.assert_allclose(analysis([found.drive(found.best)])[0], best, rtol=1e-6)


@pytest.mark.slow
def test_commands_write_their_files(tmp_path, capsys, monkeypatch):
    path = tmp_path / "study.toml"
    path.write_text(STUDY)
    assert run(sweep, path, "--figures", "png", "--out", tmp_path / "sweep") == 0
    assert (tmp_path / "sweep" / "figures" / "responses.png").stat().st_size > 10_000
    words = ["paper", "--case", "CS-6", "--samples", 300, "--positions", 6, "--seed", 1]
    words += ["--quantities", "ptp_transmission_error", "max_pin_load"]
    assert run(tolerance, *words, "--out", tmp_path / "t", "--figures") == 0
    text = capsys.readouterr().out
    assert "300 samples × 6 positions, half-space" in text
    assert "cyclo run" in text
    assert (tmp_path / "t" / "figures" / "distributions.svg").exists()
    assert (tmp_path / "t" / "figures" / "sensitivity.svg").exists()
    assert run(tolerance, *words, "--out", tmp_path / "s", "--sample", 5) == 0
    written = load_drive(tmp_path / "s" / "samples" / "sample_00000005.toml").cases["nominal"]
    assert read_field(written, "pin_wheel.pin_errors.radial.0") != 0.0
    words = ["paper", "--case", "CS-3", "--vary", "equidistant_offset=0.12:0.2", "shifting_offset", "--positions", 6]
    aims = ["--minimise", "ptp_transmission_error", "max_pin_pressure_mid", "--generations", 2]
    monkeypatch.setattr(optimiser, "WEIGHTS", 3)  # a front of few points is written as one of many
    assert run(optimise, *words, *aims, "--figures", "pdf", "--out", tmp_path / "o") == 0
    assert (tmp_path / "o" / "figures" / "pareto.pdf").exists()
    assert "warning: 6 positions see 6 phases of the mesh of 13 teeth" in capsys.readouterr().err
    best = load_drive(tmp_path / "o" / "optimum.toml").cases["nominal"]
    assert 0.12 <= best.disc.equidistant_offset <= 0.2


def test_a_written_engine_is_honoured_by_a_search(tmp_path, capsys, monkeypatch):
    """A written hybrid was taken for the default, whose candidates of other shapes are solved on half-spaces."""
    searched = []

    def stop(problem, positions, engine):
        searched.append(engine.compliance)
        raise CycloError("far enough")

    monkeypatch.setattr("ltca.commands.actions.optimise.batch_analysis", stop)
    monkeypatch.setattr("ltca.commands.actions.optimise.find_beforehand", lambda *given: None)
    words = ["--vary", "disc.thickness=8:12", "--minimise", "max_pin_load", "--positions", 13]
    text = shipped_drive("robot-joint")
    written = "[analysis]\ncompliance = "
    for number, (table, more, engine, told) in enumerate(
        (
            ("", [], "half-space", "they are solved on half-spaces, the drive as it is and the optimum on hybrid"),
            (f'{written}"hybrid"\n', [], "hybrid", "[analysis] of the drive file names hybrid: up to"),
            (f'{written}"hybrid"\n', ["--quick"], "half-space", ""),
            (f'{written}"half-space"\n', ["--compliance", "hybrid"], "hybrid", "--compliance names hybrid: up to"),
        )
    ):
        path = tmp_path / f"joint-{number}.toml"
        path.write_text(text + "\n" + table, encoding="utf-8")
        with pytest.raises(CycloError, match="far enough"):
            run(optimise, path, *words, *more, "--out", tmp_path / f"out-{number}")
        assert searched.pop() == engine
        assert told in capsys.readouterr().err
    # The default is not written: of a drive that a command wrote nobody chose it.
    assert "[analysis]" not in drive_text(load_drive("robot-joint").cases["nominal"])
    assert not load_drive("robot-joint").names_compliance
    assert parse_drive(f'{text}\n{written}"hybrid"\n').names_compliance


def test_replacing_fields_keeps_the_rest(drive):
    changed = with_fields(drive, {"disc.number_of_discs": 2})
    assert changed.disc.disc_phases == (0.0, pytest.approx(np.pi))
    own = with_fields(changed, {"disc.of.1.runout.amount": 0.003, "disc.of.1.clearance.bearing": 0.02})
    assert [single.disc.runout.amount for single in single_discs(own)] == [drive.disc.runout.amount, 0.003]
    assert [single.clearance.bearing for single in single_discs(own)] == [drive.clearance.bearing, 0.02]
    with error_says(DriveError, "disc.of has 2 entries: must have 3"):
        with_fields(own, {"disc.number_of_discs": 3})
    with pytest.raises(DriveError, match=r"there is no disc 2"):
        with_fields(changed, {"disc.of.2.runout.amount": 0.003})
    assert changed.pin_wheel is drive.pin_wheel or changed.pin_wheel == drive.pin_wheel


@pytest.mark.slow
def test_a_study_with_failed_samples_is_a_partial_result(tmp_path, capsys):
    """Status 0 told a script that all was well: a flank that overlaps its pins by 0.75 mm was among the samples."""
    path = tmp_path / "study.toml"
    text = 'drive = "paper"\npositions = 3\nquantities = ["max_pin_load"]\ndesign = { kind = "grid" }\n[factors]\n'
    path.write_text(f"{text}disc.equidistant_offset = [0.15, -0.6, 0.16]\n", encoding="utf-8")
    assert run(sweep, path, "--out", tmp_path / "some", "--no-figures") == 1
    told = capsys.readouterr()
    assert told.err.splitlines()[-1] == "cyclo: error: partial: 1 of 3 samples failed"
    assert "1 of 3 samples failed; their drives" in told.out
    assert (
        run(sweep, path, "--out", tmp_path / "some", "--no-figures", "--resume") == 1
    )  # what is finished stays partial
    path.write_text(f"{text}disc.equidistant_offset = [0.15, 0.16]\n", encoding="utf-8")
    assert run(sweep, path, "--out", tmp_path / "all", "--no-figures") == 0


def test_the_legend_of_a_search_stands_outside_the_axes():
    """It covered candidates."""
    drive = load_drive("paper").cases["CS-1"]
    variables = tuple(
        Variable(path=path, low=0.1, high=0.2) for path in ("disc.equidistant_offset", "disc.shifting_offset")
    )
    problem = Problem(drive=drive, variables=variables, aims=("max_pin_load",), limits=())
    points = np.random.default_rng(1).uniform(0.1, 0.2, (40, 2))
    optimum = Optimum(
        problem=problem, variables=points, values=points[:, :1], feasible=points[:, 0] > 0.12, best=0,
        front=np.zeros(1, dtype=int), start=np.array([0.15]), generations=1,
    )  # fmt: skip
    with mpl.rc_context(STYLE):
        figure = _search(optimum, "search")
        figure.canvas.draw()
    (legend,) = figure.legends
    assert [axes.get_legend() for axes in figure.axes] == [None, None]
    assert not any(legend.get_window_extent().overlaps(axes.get_window_extent()) for axes in figure.axes)
