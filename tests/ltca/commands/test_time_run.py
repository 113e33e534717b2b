"""``cyclo dynamics --time`` as a program: files, options used or refused by name, an interruption and what goes on after it."""

from __future__ import annotations

import json
from contextlib import suppress

import numpy as np
import pytest

from ltca.commands.actions import time_run
from ltca.commands.program import main
from ltca.drive.members.temperatures import warm_drive
from ltca.drive.single_discs import single_discs
from ltca.errors import DamagedFileError
from ltca.output.checked_arrays import read_arrays, write_arrays
from ltca.output.netcdf import read_netcdf
from ltca.reading.drive_file import load_drive
from ltca.testing.closed_form_bodies import closed_form_coefficients

RUN = ["dynamics", "paper", "--case", "CS-1", "--speed", "1500", "--compliance", "half-space"]


@pytest.mark.slow
def test_a_run_writes_what_it_says(tmp_path, capsys):
    out = tmp_path / "here"
    assert main([*RUN, "--time", "0.3 ms", "--motion", "step", "--factor", "1.5", "--out", str(out)]) == 0
    assert "of the throughput left" in capsys.readouterr().out
    content = json.loads((out / "time.json").read_text())
    assert content["motion"]["factor"] == 1.5
    assert abs(content["energy_N_mm"]["left_by_throughput"]) < 1e-5
    found = read_netcdf(out / "time.nc", "run")
    assert found["pin_load"].values.shape == (content["samples"], 1, 14)
    # The torque has changed by the factor to the end: 1e-12 of a polynomial.
    torque = found["output_torque"].values
    assert torque[-1] / torque[0] == pytest.approx(1.5, rel=1e-12)
    assert (out / "report.html").exists()
    assert not (out / "checkpoint").exists()


@pytest.mark.slow
def test_a_run_on_bodies_that_feel_each_other(tmp_path, capsys):
    """From coefficients to the page; the energy of contacts that move over the bodies closes to 1e-4, asked for beforehand."""
    bodies, out = tmp_path / "bodies.nc", tmp_path / "here"
    single, *_ = single_discs(warm_drive(load_drive("paper").cases["CS-1"]))
    closed_form_coefficients(single, half_width=0.02, depth=300.0).to_netcdf(bodies, engine="h5netcdf")
    asked = [*RUN[:-1], "hybrid", "--coefficients", str(bodies), "--time", "0.02 ms", "--out", str(out)]
    assert main(asked) == 0
    assert "CS-1, 377.3 N·m ccw, hybrid: steady in time" in capsys.readouterr().out
    energy = json.loads((out / "time.json").read_text())["energy_N_mm"]
    assert abs(energy["left_by_throughput"]) < 1e-4
    assert abs(energy["stations"]) > 10.0 * abs(energy["left"])
    assert read_netcdf(out / "time.nc", "run").attrs["engine"].startswith("hybrid")
    assert (out / "report.html").exists()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--motion", "start"], "--motion: has no effect without --time"),
        (["--resume"], "--resume: has no effect without --time"),
        (["--time", "1 ms", "--turns", "3"], "--turns = 3: has no effect with --time"),
        (["--time", "1 ms", "--positions", "5"], "--positions = 5: has no effect with --time"),
        (["--time", "1 ms", "--factor", "2"], "--factor = 2: the motion 'steady' takes none"),
        (["--time", "1 ms", "--motion", "sine"], "--frequency: must be given"),
        (["--time", "1 ms", "--speed", "1e9"], "--speed = 1e+09: must be at most 1e+06 rpm"),
        (
            ["--time", "2 ms", "--motion", "step", "--at", "1.5 ms", "--within", "1 ms"],
            "--within = 0.001: must be at most 0.0005 s, what is left of the time, 0.002 s, after --at = 0.0015 s",
        ),
        (["--time", "1 ms", "--motion", "sine", "--frequency", "5 kHz", "--at", "1"], "--at = 1: the motion 'sine'"),
        (["--time", "1 ms", "--motion", "sine", "--frequency", "1 GHz"], "--frequency = '1 GHz'"),
        (
            ["--time", "1 ms", "--motion", "sine", "--frequency", "2e3 kHz"],
            "--frequency = 2e+06: must be at most 1e+06 Hz",
        ),
    ],
)
def test_options_are_used_or_refused(options, words, tmp_path, capsys):
    out = tmp_path / "here"
    assert main([*RUN, *options, "--out", str(out)]) == 2
    assert words in capsys.readouterr().err
    assert not out.exists()


@pytest.mark.slow
def test_an_interrupted_run_goes_on(tmp_path, capsys, monkeypatch):
    out, asked = tmp_path / "here", [*RUN, "--time", "2 ms", "--no-page"]
    monkeypatch.setattr(time_run, "SAVED_EVERY", 0.0)
    written = time_run._saving

    def saving(path, mark):
        save = written(path, mark)

        def once(state):
            save(state)
            raise KeyboardInterrupt

        return once

    with monkeypatch.context() as patch:
        patch.setattr(time_run, "_saving", saving)
        with suppress(KeyboardInterrupt):
            assert main([*asked, "--out", str(out)]) != 0
    assert list((out / "checkpoint").glob("*.npz"))
    assert main([*asked, "--out", str(out)]) == 2
    assert "--resume" in capsys.readouterr().err
    assert main([*asked[:-2], "3 ms", "--no-page", "--resume", "--out", str(out)]) != 0
    assert "holds another run" in capsys.readouterr().err
    assert main([*asked, "--resume", "--out", str(out)]) == 0
    assert main([*asked, "--out", str(tmp_path / "whole")]) == 0
    again, whole = (read_netcdf(path / "time.nc", "run") for path in (out, tmp_path / "whole"))
    for name in ("pin_load", "transmission_error", "input_torque"):
        values = whole[name].values
        assert again[name].values == pytest.approx(values, abs=1e-9 * np.abs(values).max())


def one_bit(content):
    return content[:400] + bytes([content[400] ^ 1]) + content[401:]


DAMAGES = {
    "cut": lambda content: content[: len(content) // 2],
    "empty": lambda content: b"",
    "one bit": one_bit,
    "no archive": lambda content: b"no archive",
    "one array": lambda content: b"\x93NUMPY\x01\x00",
}


@pytest.fixture
def interrupted(tmp_path):
    """A run that was interrupted, with a file that would be its checkpoint; numbers in it do not matter."""
    path = tmp_path / "here" / "checkpoint" / "0.npz"
    write_arrays(path, {"mark": "of another run", "state": np.arange(3.0)})
    return path


@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_checkpoint_is_refused_with_a_line(damage, interrupted, capsys):
    """BadZipFile, EOFError and ValueError ended in "unforeseen"; a flipped bit of a value went unseen."""
    interrupted.write_bytes(DAMAGES[damage](interrupted.read_bytes()))
    assert main([*RUN, "--time", "2 ms", "--resume", "--out", str(interrupted.parents[1])]) == 2
    said = capsys.readouterr().err
    assert f"{interrupted}: " in said
    assert said.endswith("; remove it to begin anew\n")
    assert said.count("\n") == 1
    assert interrupted.exists()


def test_a_flipped_bit_of_a_checkpoint_is_found_out_or_changes_nothing(tmp_path):
    path = tmp_path / "0.npz"
    write_arrays(path, {"mark": "of a run", "state": np.array([0.5, 1.0])})
    content = path.read_bytes()
    sound = read_arrays(path, "a checkpoint")
    for place in range(0, len(content), 11):
        path.write_bytes(content[:place] + bytes([content[place] ^ 1]) + content[place + 1 :])
        try:
            found = read_arrays(path, "a checkpoint")
        except DamagedFileError:
            continue
        assert found.keys() == sound.keys()
        assert all(np.array_equal(found[name], sound[name]) for name in sound)


def test_a_checkpoint_with_a_state_of_three_is_refused_with_a_line(interrupted, capsys, monkeypatch):
    """It has its checksum; numpy said that shapes do not fit."""
    monkeypatch.setattr(time_run, "_mark", lambda *_: "this run")
    for content, words in (
        ({"state": np.arange(3.0)}, "is no checkpoint of a run in time of this version"),
        (
            {
                **dict.fromkeys(("time", "step"), 1e-6), "rows": 1, "evaluations": 12, "samples/time": np.zeros(1),
                **dict.fromkeys(("state", "rate", "tolerances"), np.arange(3.0)), "followed/inner": np.zeros(1),
            },
            "does not fit the run in time",
        ),
    ):  # fmt: skip
        write_arrays(interrupted, {"mark": "this run", **content})
        assert main([*RUN, "--time", "2 ms", "--resume", "--out", str(interrupted.parents[1])]) == 2
        said = capsys.readouterr().err
        assert words in said
        assert said.count("\n") == 1
