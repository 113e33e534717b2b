"""``--bodies solid``: derived on demand, kept, told in results; files of one kind of bodies for runs on it alone."""

import json

import pytest
import xarray as xr

from ltca.commands.program import main
from ltca.compliance import coefficient_files
from ltca.output.provenance import code_hash
from ltca.reading.drive_file import load_drive, shipped_drive
from ltca.testing.closed_form_bodies import closed_form_coefficients


@pytest.fixture
def derived(monkeypatch, tmp_path):
    """Bodies in closed form in place of finite elements, an empty cache, and the list of what was derived."""
    asked = []

    def derive(drive, *, processes, bodies, store):
        asked.append((bodies, drive.roller_length))
        depth = 260.0 if bodies == "solid" else None
        found = closed_form_coefficients(drive, half_width=0.05, depth=300.0, tilt_depth=depth)
        store(found)

    code_hash("ltca", "fem")  # by the usual cache, where it is kept
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(coefficient_files, "derivation", lambda: derive)
    # What ships is of the same shape.
    monkeypatch.setattr(coefficient_files, "shipped_file", lambda drive, bodies="plane": None)
    return asked


def written(folder, *lines):
    """The paper's drive with an engine of its own and slices."""
    text = shipped_drive("paper").replace('compliance = "half-space"', "\n".join(lines))
    path = folder / "drive.toml"
    path.write_text(text + "\n[contact]\nslices = 3\n", encoding="utf-8")
    return path


def run(path, out, *options):
    return main(["run", str(path), "--case", "CS-1", "--positions", "2", "--no-page", "--out", str(out), *options])


@pytest.mark.slow
def test_a_drive_file_asks_for_solid_bodies(derived, tmp_path, capsys, positions_alone):
    """Derived once and kept beside plane ones of the same drive, which the option asks for; both tell."""
    path = written(tmp_path, 'compliance = "hybrid"', 'bodies = "solid"')
    assert run(path, tmp_path / "solid") == 0
    assert "by an approach and a tilt of every contact" in capsys.readouterr().out
    assert run(path, tmp_path / "again") == 0
    assert run(path, tmp_path / "plane", "--bodies", "plane") == 0
    assert "influence coefficients of the bodies are those of the plane" in capsys.readouterr().out
    assert derived == [("solid", 11.8), ("plane", 11.8)]
    for name in ("solid", "plane"):
        assert json.loads((tmp_path / name / "summary.json").read_text(encoding="utf-8"))["bodies"] == name
        with xr.open_dataset(tmp_path / name / "results.nc", engine="h5netcdf") as found:
            assert found.attrs["bodies"] == name


def test_files_of_other_bodies_and_idle_options_are_refused(derived, tmp_path, capsys):
    """One line each, exit status 2, nothing written or derived."""
    drive = load_drive("paper").cases["CS-1"]
    file = tmp_path / "solid.nc"
    data = closed_form_coefficients(drive, half_width=0.05, depth=300.0, tilt_depth=260.0)
    coefficient_files.write_coefficients(data, file)
    named = ("--compliance", "hybrid", "--coefficients", str(file))
    for options, words in (
        (named, "holds coefficients of solid bodies, not of plane ones: give --bodies solid"),
        (("--bodies", "solid"), "bodies: has no effect with compliance half-space"),
        (("--quick", "--bodies", "solid"), "--bodies: has no effect with --quick"),
        (("--method", "paper", "--bodies", "solid"), "bodies: has no effect with compliance half-space"),
    ):
        assert run("paper", tmp_path / "out", *options) == 2
        assert words in capsys.readouterr().err
        assert not (tmp_path / "out" / "results.nc").exists()
    assert derived == []


@pytest.mark.nightly
@pytest.mark.slow
def test_samples_of_a_study_stand_on_solid_bodies(derived, tmp_path, capsys):
    """Samples of one shape share what is derived; how to run one again is told with the option."""
    path = tmp_path / "drive.toml"
    path.write_text(shipped_drive("paper"), encoding="utf-8")
    words = ["tolerance", str(path), "--case", "CS-1", "--samples", "2", "--positions", "2", "--no-page"]
    options = ["--compliance", "hybrid", "--bodies", "solid", "--out", str(tmp_path / "out")]
    assert main([*words, *options]) == 0
    told = capsys.readouterr().out
    assert derived == [("solid", 11.8)]
    assert "--compliance hybrid --bodies solid" in told
