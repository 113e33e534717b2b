"""What the machine does not give, and what nobody can compute, is said in one line before work, and nothing is left."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from multiprocessing.context import BaseContext
from pathlib import Path
from types import SimpleNamespace

import pytest
from refusals import error_says, refused_field

from ltca.commands.program import _told, main
from ltca.errors import DriveError
from ltca.output import process_pools
from ltca.output.files import whole_file
from ltca.output.process_pools import LOCK, PREFIX, remove_stale_folders
from ltca.output.run_folder import MANIFEST, claimed_folder
from ltca.reading.drive_file import parse_drive, shipped_drive
from ltca.studies.sweep_file import parse_sweep

FIELDS = (
    "load.torque", "crank.eccentricity", "disc.thickness", "pin_wheel.pin_radius", "disc.equidistant_offset",
    "disc.shifting_offset", "load.light_torque", "clearance.bearing", "clearance.pin_hole", "pin_shaft.pin_radius",
    "pin_shaft.hole_radius", "pin_shaft.stiffness", "crank_bearing.roller_length", "crank_bearing.roller_radius",
)  # fmt: skip
SMALL = ["tolerance", "paper", "--samples", "4", "--positions", "4", "--no-figures", "--no-page"]


def test_the_samples_of_a_grid_are_bounded_before_its_levels_are_looked_at(monkeypatch):
    """A grid of 14 factors of 100,000 levels ran for minutes without a word."""
    monkeypatch.setattr("ltca.studies.sweep_file._factor", lambda *words: pytest.fail("a level was looked at"))
    levels = {name: {"low": 1.0, "high": 2.0, "levels": 100_000} for name in FIELDS}
    with refused_field("factors", "", "make a grid of 1e+70 samples", bound=("at most", 100_000_000)):
        parse_sweep({"factors": levels}, "paper")
    with refused_field("factors", "", "make a grid of 1000000000 samples", bound=("at most", 100_000_000)):
        parse_sweep({"factors": {name: [1.0] * 1000 for name in FIELDS[:3]}}, "paper")


def test_of_many_levels_the_ends_are_asked():
    levels = {"load.torque": {"low": 1.0, "high": 2.0, "levels": 1000}}
    assert parse_sweep({"factors": levels}, "paper").design.samples == 1000
    with error_says(DriveError, "factors.load.torque"):
        parse_sweep({"factors": {"load.torque": [1.0] * 999 + [-1.0]}}, "paper")


def test_values_of_a_drive_are_bounded_before_they_are_read(monkeypatch):
    """Two million numbers took 4 s of processor and 20 s."""
    with monkeypatch.context() as patched:
        patched.setattr("ltca.reading.toml_text.tomllib.loads", lambda text: pytest.fail("it was read"))
        with error_says(DriveError, "holds some 2000000 values: must be at most 500000"):
            parse_drive("a = [" + "0.001," * 1_999_999 + "]")
    with error_says(DriveError, "an array has 30000 entries: must be at most 20000"):
        parse_drive(shipped_drive() + "\n[other]\na = [" + "0," * 30_000 + "]")


@pytest.mark.parametrize("address", ["nonsense", "foo://x:1", "tcp://", "127.0.0.1:99999", "host:", ":80"])
def test_what_is_no_address_of_a_scheduler_is_refused(address, tmp_path, capsys):
    """It ended after 20 s with a traceback of dask, and a folder."""
    assert main([*SMALL, "--scheduler", address, "--out", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert f"--scheduler = '{address}': must be the address of a dask scheduler" in said
    assert said.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_shared_memory_that_is_read_only(tmp_path, capsys, monkeypatch):
    """With two workers it said "a file: Read-only file system"."""

    def refused(*words, **options):
        raise OSError(30, "Read-only file system")

    monkeypatch.setattr(BaseContext, "Lock", refused)
    assert main([*SMALL, "--workers", "2", "--out", str(tmp_path / "out")]) == 1
    errors = [line for line in capsys.readouterr().err.splitlines() if line.startswith("cyclo: ")]
    assert errors == [
        "cyclo: error: 2 worker processes cannot be started: Read-only file system: /dev/shm and TMPDIR must be writable; "
        "or take --workers 1"
    ]
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    "error",
    [
        ImportError("/x/_mt19937.so: failed to map segment from shared object"),
        ImportError("libopenblas.so: cannot allocate memory in static TLS block"),
        RuntimeError("can't start new thread"),
        OSError(12, "Cannot allocate memory"),
    ],
)
def test_memory_that_ends_at_an_import(error):
    """Little memory was an "unforeseen ImportError … a fault of cyclo"."""
    assert _told(error).startswith("memory is not enough")
    assert "unforeseen" in _told(ImportError("no module named x"))


@pytest.mark.parametrize(
    "words",
    [
        ["run", "paper", "--out", "ö"],
        *(pytest.param([name, "ö.toml"], marks=pytest.mark.slow) for name in ("run", "sweep")),
    ],
    ids=str,
)
def test_a_name_that_the_locale_cannot_write(words, tmp_path):
    """`LC_ALL=C cyclo … --out ö` said "invalid read value"."""
    environment = {**os.environ, "LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    run = subprocess.run(
        [sys.executable, "-m", "ltca.commands.program", *words],
        env=environment, cwd=tmp_path, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert run.returncode == 2
    assert "cannot be a name of a file in the encoding ascii: LC_ALL=C.UTF-8 helps" in run.stderr
    assert run.stderr.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def write_and_refuse(out, command, names, **options):
    """Write files as a run does, then refuse its input."""
    with claimed_folder(out, command, **options):
        for name in names:
            with whole_file(out / name) as part:
                part.write_text("1")
        raise DriveError(["x"])


def test_a_drive_that_is_refused_leaves_nothing(tmp_path):
    """A drive was solved and then refused, with results left behind."""
    with pytest.raises(DriveError):
        write_and_refuse(tmp_path / "a" / "out", "run", ["results.nc", "figures/a.svg"])
    assert list(tmp_path.iterdir()) == []


def test_a_refused_run_that_adds_leaves_what_was_there(tmp_path):
    with claimed_folder(tmp_path, "show"), whole_file(tmp_path / "old") as part:
        part.write_text("1")
    (tmp_path / "own").write_text("of the user")
    with pytest.raises(DriveError):
        write_and_refuse(tmp_path, "show", ["new"], adding=True)
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(["old", "own", MANIFEST])


def test_batches_of_a_study_that_ends_in_an_error_stay(tmp_path):
    with pytest.raises(DriveError):
        write_and_refuse(tmp_path, "study", ["study.json", "batches/00000000.npz"], beside=("batches",))
    assert (tmp_path / "study.json").exists()


DYING = """
import os, sys
from concurrent.futures import wait
from ltca.output.process_pools import process_pool
def main():
    with process_pool(2, preload="json") as pool:
        print(pool.submit(os.getpid).result(), flush=True)
        sys.stdin.read()
if __name__ == "__main__":
    main()
"""


@pytest.fixture
def short_place():
    """A folder for temporary files with a path that leaves room for the names of sockets."""
    with tempfile.TemporaryDirectory(prefix="t-", dir="/tmp") as name:
        yield Path(name)


def test_a_long_path_of_temporary_files_is_no_end_of_a_pool(tmp_path):
    """Paths of sockets have 107 bytes at the most: a pool ended in "AF_UNIX path too long"."""
    place = tmp_path / ("long" * 20)
    place.mkdir()
    (tmp_path / "pool.py").write_text(DYING)
    words = [sys.executable, str(tmp_path / "pool.py")]
    environment = {**os.environ, "TMPDIR": str(place)}
    done = subprocess.run(words, input="", capture_output=True, text=True, env=environment, check=False)
    assert done.returncode == 0, done.stderr
    assert int(done.stdout)
    assert list(place.iterdir()) == []


def test_the_folder_of_a_pool_ends_with_it_also_after_a_kill(tmp_path, short_place):
    """Of ten killed runs with two workers ten left a pymp-* in the folder for temporary files."""
    script = tmp_path / "pool.py"
    script.write_text(DYING)
    place = short_place
    with subprocess.Popen(
        [sys.executable, str(script)],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env={**os.environ, "TMPDIR": str(place)},
    ) as process:  # fmt: skip
        assert int(process.stdout.readline())
        (folder,) = place.iterdir()
        assert folder.name.startswith(PREFIX)
        remove_stale_folders(place, 0.0)
        assert folder.exists()  # of a living process
        process.kill()
    end = time.monotonic() + 300.0
    while list(place.iterdir()) and time.monotonic() < end:
        time.sleep(0.05)
    assert list(place.iterdir()) == []


def test_left_over_folders_of_pools_go_at_the_next_start(tmp_path):
    for name in (f"{PREFIX}dead", f"{PREFIX}fresh", "pymp-x", f"{PREFIX}without"):
        (tmp_path / name).mkdir()
        if not name.endswith("without"):
            (tmp_path / name / LOCK).touch()
    (tmp_path / f"{PREFIX}link").symlink_to(tmp_path / "pymp-x")
    os.utime(tmp_path / f"{PREFIX}dead", (0, 0))
    remove_stale_folders(tmp_path)
    left = sorted(path.name for path in tmp_path.iterdir())
    assert left == sorted([f"{PREFIX}fresh", f"{PREFIX}link", f"{PREFIX}without", "pymp-x"])


def test_a_pool_has_no_more_processes_than_windows_waits_for(monkeypatch):
    """`ProcessPoolExecutor` refuses more than 61 there (its documentation), which a machine of 64 processors asks for."""
    asked = []
    monkeypatch.setattr(process_pools, "ProcessPoolExecutor", lambda processes, **_: asked.append(processes))
    for system in ("posix", "nt"):
        monkeypatch.setattr(process_pools, "os", SimpleNamespace(**{**vars(os), "name": system}))
        process_pools._started_pool(64, "", None)
    assert asked == [64, 61]


def test_processes_of_macos_are_no_copies(monkeypatch):
    """Its own libraries do not work in a copy of a process that has loaded them."""
    monkeypatch.setattr(process_pools, "sys", SimpleNamespace(platform="darwin"))
    assert process_pools.start_context("json").get_start_method() == "spawn"
