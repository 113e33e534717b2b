"""``cyclo fem --bodies solid --pair``: files, keys, and one clear message for each mistake."""

import argparse
import json

import numpy as np
import pytest
import xarray as xr
from refusals import error_says, stands_in

from fem.commands import fem as command
from ltca.errors import DriveError


def run(*words):
    parser = argparse.ArgumentParser()
    command.configure(parser)
    return command.execute(parser.parse_args(words))


@pytest.mark.parametrize("words", [("--load", "0"), ("--tilt", "0.02"), ("--block", "-1")])
def test_quantities_have_bounds(words, tmp_path):
    with pytest.raises(DriveError, match=words[0]):
        run("paper", "--bodies", "solid", "--pair", "bore", "--out", str(tmp_path), *words)


@pytest.mark.slow
def test_files_of_a_pair(tmp_path, capsys):
    out = tmp_path / "out"
    words = ("paper", "--case", "CS-1", "--angle", "0.5", "--bodies", "solid", "--pair", "bore", "--size", "8")
    assert run(*words, "--approach", "3 µm", "--out", str(out)) == 0
    summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    assert summary["approach_mm"] == pytest.approx(3e-3)
    assert (summary["case"], summary["crank_angle_rad"], summary["block_mm"]) == ("CS-1", 0.5, 5.0)
    with xr.open_dataset(out / "pair.nc", engine="h5netcdf") as data:
        assert data["pressure"].dims == ("x", "height")
        assert data["pressure"].attrs["units"] == "MPa"
        line = np.trapezoid(data["line_load"].values, data["height"].values)
        # Vertex values along the width are smoothed for reading: a per cent at the ends.
        assert line == pytest.approx(summary["load_N"], rel=0.02)
        assert data.attrs["load_N"] == summary["load_N"]
    printed, warned = capsys.readouterr()
    assert "held in all directions at sides and bottom" in printed
    # An eighth of the default's eight elements, by the half-width that was expected.
    (line,) = (line for line in warned.splitlines() if "warning: --size 8: " in line)
    assert stands_in((" elements for the half-width of ", ", fewer than 4: ", " --size 2 or less"), line)
    assert 0.0 <= float(line.partition("warning: --size 8: ")[2].split()[0]) < 2.0
    assert "approach 3 µm" in printed


@pytest.mark.needs("calculix")
def test_a_rigid_shaft_pin_has_no_referee(tmp_path):
    """It was refused after the solution only, and left a folder behind."""
    words = ("examples/drives/plastic.toml", "--bodies", "solid", "--pair", "hole", "--load", "200")
    with error_says(DriveError, starts="--referee calculix: has no effect on a rigid shaft pin"):
        run(*words, "--referee", "calculix", "--out", str(tmp_path / "out"))
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
@pytest.mark.nightly
@pytest.mark.needs("calculix")
def test_calculix_solves_the_pair_of_a_drive(tmp_path, capsys):
    """One element for the half-width is too few: the row is FAILED, and the command says so by its status."""
    words = ("paper", "--case", "CS-1", "--angle", "0.5", "--bodies", "solid", "--pair", "bore", "--size", "8")
    status = run(*words, "--referee", "calculix", "--load", "2000", "--out", str(tmp_path))
    summary = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))
    assert summary["calculix"]["load_N"] == pytest.approx(summary["load_N"], rel=0.02)
    assert (tmp_path / "calculix.inp").exists()
    printed = capsys.readouterr().out
    assert "ccx C3D20R" in printed
    assert status == (0 if summary["calculix"]["passed"] else 1) == int("FAILED" in printed)
