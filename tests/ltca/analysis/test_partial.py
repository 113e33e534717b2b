"""A position without an answer costs the others nothing: partial results are kept, and marked."""

from __future__ import annotations

import gc
import json

import numpy as np
import pytest
import xarray as xr

import ltca
from ltca.analysis import engines, loaded_analysis
from ltca.analysis.loaded_analysis import analyse
from ltca.commands.program import main
from ltca.equilibrium.balance import Equilibrium
from ltca.errors import ConvergenceError
from ltca.figures.run_figures import draw_figure
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import shipped_drive

ANGLES = 2.0 * np.pi * np.arange(8) / 8


@pytest.fixture
def failing(monkeypatch):
    """Let positions 2 and 5 of eight have no answer at one of the torques."""
    real = engines.solve_at_output

    def fail(which):
        def solve(model, drives, angle, torque, start=None):
            light = np.max(torque) < 0.5 * drives[0].load.torque
            bad = np.isclose(angle, ANGLES[2]) | np.isclose(angle, ANGLES[5])
            if np.any(bad) and (which == "both" or light == (which == "light")):
                raise ConvergenceError("no equilibrium at some crank angle", [1.0, 2.0])
            return real(model, drives, angle, torque, start)

        for module in (engines, loaded_analysis):  # case by case, and cases as one batch
            monkeypatch.setattr(module, "solve_at_output", solve)

    return fail


@pytest.mark.parametrize("discs", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_a_light_torque_that_fails_keeps_the_full_one(failing, paper_cases, discs):
    drive = ltca.load_drive("paper").cases["CS-4"]
    drive = with_fields(drive, {"disc.number_of_discs": discs})
    whole = analyse(drive, ANGLES)
    failing("light")
    with pytest.raises(ConvergenceError, match="no equilibrium") as caught:
        analyse(drive, ANGLES)
    partial = caught.value.partial
    np.testing.assert_array_equal(partial.balanced, True)
    np.testing.assert_array_equal(np.nonzero(~partial.balanced_light)[0], [2, 5])
    np.testing.assert_array_equal(partial.full.response.pin_load, whole.full.response.pin_load)
    good = partial.balanced_light
    # found in other batches: the same to what counts as balance
    np.testing.assert_allclose(partial.light.pose[good], whole.light.pose[good], rtol=0.0, atol=1e-9)
    assert np.all(np.isnan(partial.light.pose[~good]))


@pytest.mark.slow
def test_positions_without_an_answer_are_no_numbers(failing):
    drive = ltca.load_drive("paper").cases["CS-4"]
    whole = ltca.analyse(drive, 8)
    failing("full")
    with pytest.raises(ConvergenceError) as caught:
        ltca.analyse(drive, 8)
    partial = caught.value.partial
    data = partial.dataset
    assert data.attrs["status"] == "partial"
    assert whole.dataset.attrs["status"] == "complete"
    np.testing.assert_array_equal(data["status"].values[0], [0, 0, 1, 0, 0, 1, 0, 0])
    # at the light torque they have one, found from first contact
    np.testing.assert_array_equal(data["status_light"].values[0], 0)
    known = data["status"].values[0] == 0
    load = data["pin_load"].values[0, 0]
    np.testing.assert_allclose(load[known], whole.dataset["pin_load"].values[0, 0][known], rtol=0.0, atol=1e-5)
    assert np.all(np.isnan(load[~known]))
    summary = partial.summary
    assert summary.keys() == whole.summary.keys()
    for key in ("max_pin_load_N", "mean_loaded_pins", "ptp_transmission_error_arcsec", "refined_max_pin_load_N"):
        assert summary[key] is None, key
    for key in ("ptp_transmission_error_light_arcsec", "backlash_wheel_arcmin"):
        assert summary[key] is not None, key


@pytest.mark.slow
def test_a_light_torque_without_any_answer_keeps_the_full_one(tmp_path, capsys, monkeypatch):
    """So light that round-off is a load: it was "no equilibrium", after minutes, and nothing was written.

    A file with it is refused by now: let through here.
    """
    monkeypatch.setattr("ltca.reading.member_checks.torque_problem", lambda *_, **__: ())
    text = shipped_drive().replace("light_torque = 10000.0", "light_torque = 1e-6").split("[[case]]")[0]
    cases = '[[case]]\nname = "tiny"\n[[case]]\nname = "good"\nload = { light_torque = 1e4 }\n'
    drive, out = tmp_path / "tiny.toml", tmp_path / "out"
    drive.write_text(text + cases)
    assert main(["run", str(drive), "--angles", "0.3", "--no-figures", "--out", str(out)]) == 1
    told = capsys.readouterr().err
    assert "case tiny: partial: 1 of 2 states have no answer: load.light_torque = 1e-06 N·mm: no equilibrium" in told
    assert "too small to be balanced" in told
    data = xr.open_dataset(tmp_path / "out" / "results.nc", engine="h5netcdf")
    np.testing.assert_array_equal(data["status_light"], [[1], [0]])
    np.testing.assert_array_equal(data["status"], 0)
    cases = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))["cases"]
    assert cases["tiny"]["max_pin_load_N"] == cases["good"]["max_pin_load_N"]
    assert cases["tiny"]["ptp_transmission_error_light_arcsec"] is None


def test_nothing_at_all_is_no_partial_result(failing):
    drive = ltca.load_drive("paper").cases["CS-4"]
    failing("both")
    with pytest.raises(ConvergenceError) as caught:
        ltca.analyse(drive, crank_angle=ANGLES[[2, 5]])
    assert caught.value.partial is None


@pytest.mark.slow
def test_run_keeps_what_it_has_and_says_so(failing, tmp_path, capsys):
    failing("full")
    words = [
        "run",
        "paper",
        "--case",
        "CS-1",
        "--case",
        "CS-4",
        "--positions",
        "8",
        "--no-figures",
        "--out",
        str(tmp_path),
    ]
    assert main(words) == 1
    told = capsys.readouterr()
    assert "case CS-4: partial: 2 of 16 states have no answer" in told.err
    data = xr.open_dataset(tmp_path / "results.nc", engine="h5netcdf")
    assert data.attrs["status"] == "partial"
    assert int(data["status"].sum()) == 4
    cases = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))["cases"]
    assert cases["CS-1"]["max_pin_load_N"] is None
    # drawn are the positions that every case has
    figure = draw_figure("fig24_pin_load", data)
    assert len(figure.axes[0].lines[0].get_xdata()) == 6


@pytest.mark.slow
def test_no_answer_outlives_its_use(paper_cases):
    """A function that called itself kept all of them until garbage was collected: 1.5 GB where 0.4 are in use."""
    analyse(paper_cases["CS-1"], np.array([0.1]))  # what is kept for good
    gc.collect()
    before = sum(type(one) is Equilibrium for one in gc.get_objects())  # of other tests
    gc.disable()
    try:
        analyse(paper_cases["CS-1"], np.array([0.1, 0.2]))
        kept = sum(type(one) is Equilibrium for one in gc.get_objects())
    finally:
        gc.enable()
    assert kept == before
