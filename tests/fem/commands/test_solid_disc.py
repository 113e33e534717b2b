"""``cyclo fem --bodies solid``: files, names and table of a whole disc."""

import argparse
import json

import numpy as np
import pytest
import xarray as xr

from fem.commands import fem as command
from fem.reducer.solution_files import ARRAYS
from ltca.quantities import QUANTITIES


@pytest.mark.nightly
@pytest.mark.slow
def test_files_of_a_disc(tmp_path, capsys):
    out = tmp_path / "out"
    parser = argparse.ArgumentParser()
    command.configure(parser)
    words = ["examples/drives/plastic.toml", "--case", "leaning", "--angle", "0.3", "--bodies", "solid"]
    assert command.execute(parser.parse_args([*words, "--size", "6", "--layers", "2", "--out", str(out)])) == 0
    printed = capsys.readouterr().out
    assert "tilt of the disc at its bore: about x" in printed
    summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    assert summary["bodies"] == "solid"
    assert len(summary["pin_load_N"]) == 5
    assert len(summary["roller_load_N"]) == len(summary["roller_load_inner_N"]) == 5
    # Rollers lean between an upright race and the bore.
    assert len(summary["roller_lean_rad"]) == 5
    tilt = float(np.linalg.norm(summary["disc_tilt_rad"]))
    assert 0.0 < np.max(np.abs(summary["roller_lean_rad"])) < tilt
    assert abs(summary["wheel_moment_N_mm"]) == pytest.approx(1500.0, rel=1e-12)
    assert summary["equilibrium_residual_N"] < 1e-6 * max(summary["pin_load_N"])
    with xr.open_dataset(out / "fem.nc", engine="h5netcdf") as data:
        for name in (*ARRAYS, "pin_pressure_max"):
            np.testing.assert_array_equal(data[name].values.ravel(), summary[QUANTITIES[name].fem_key], err_msg=name)
        assert data["disc_tilt"].dims == ("case", "disc", "position", "axis")
        assert 1e-4 < float(np.abs(data["disc_tilt"]).max()) < 3e-3
        # The listed pressures of a contact carry its load: the rule of trapezoids over both, coarse as the mesh.
        own = (data["pressure_contact"] == "pin") & (data["pressure_part"] == int(np.argmax(data["pin_load"].values)))
        z, s = np.unique(data["pressure_height"][own]), np.unique(data["pressure_place"][own])
        field = data["pressure"].values[own.values].reshape(s.size, z.size)
        load = np.trapezoid(np.trapezoid(field, z, axis=1), s)
        # Normals of an arc of some 0.2 rad lean from the force: 1 − 0.2²/6.
        assert load == pytest.approx(float(data["pin_load"].max()), rel=0.02)
        assert data.attrs["model"] == "finite elements, solid bodies"
    page = (out / "report.html").read_text(encoding="utf-8")
    assert "line load of wheel pins on the flank" in page
