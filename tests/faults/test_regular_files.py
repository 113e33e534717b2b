"""Pipes and devices in the place of files are refused in a line, by every reader; what libraries read is looked at before."""

from __future__ import annotations

import errno
import os
import shutil
import threading
from types import SimpleNamespace

import h5py
import numpy as np
import pytest
from refusals import error_says

from ltca.commands.program import main
from ltca.errors import DamagedFileError, DriveError
from ltca.output import regular_files
from ltca.output.netcdf import require_sound_netcdf
from ltca.output.regular_files import NotReadableError, read_regular
from ltca.output.run_folder import MANIFEST, claimed_folder
from ltca.page.compared import read_compared
from ltca.reading.coefficient_file import read_coefficients
from ltca.reading.measured.points import read_points
from ltca.reading.toml_text import read_text
from ltca.studies.execution.storage import StudyFolder, read_batch
from ltca.studies.study_results import opened_results

pytestmark = pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes with names")


@pytest.fixture(autouse=True)
def not_for_ever():
    """A reader that waits for the pipe is heard of, not waited for."""
    timer = threading.Timer(20.0, os._exit, (3,))
    timer.daemon = True
    timer.start()
    yield
    timer.cancel()


@pytest.fixture
def pipe(tmp_path):
    path = tmp_path / "results.nc"
    os.mkfifo(path)
    return path


def results_of(path):
    with opened_results(path):
        pass


READERS = {
    "drives, studies, requirements, stock": read_text,
    "points": read_points,
    "coefficients": read_coefficients,
    "a batch": lambda path: read_batch(path, None),
    "results of a study": results_of,
    "a plan": lambda path: StudyFolder(path=path.parent)._held(),
}


@pytest.mark.parametrize("read", READERS.values(), ids=READERS)
@pytest.mark.parametrize("target", ["pipe", "/dev/zero"])
def test_a_pipe_or_a_device_is_refused(read, target, pipe, tmp_path):
    """`--resume` with a FIFO or /dev/zero as a batch, and a FIFO as a drive file, hung."""
    path = tmp_path / ("study.json" if read is READERS["a plan"] else "00000000.npz")
    if target == "pipe":
        os.mkfifo(path)
    else:
        path.symlink_to(target)
    with pytest.raises((DriveError, DamagedFileError), match=r"not a regular file but a (pipe|device)") as error:
        read(path)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("words", [["run"], ["check"], ["sweep"], ["design"], ["derive"], ["fem"], ["curves"]], ids=str)
def test_commands_refuse_a_pipe_and_leave_nothing(words, pipe, tmp_path, capsys):
    assert main([*words, str(pipe), "--out", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert "not a regular file but a pipe" in said
    assert said.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_a_pipe_as_manifest_is_none(tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    os.mkfifo(out / MANIFEST)
    with claimed_folder(out, "run"):
        pass


def test_sizes_are_bounded(tmp_path):
    path = tmp_path / "large"
    with path.open("wb") as stream:
        stream.truncate(3_000_000)
    assert len(read_regular(path, 3_000_000)) == 3_000_000
    with error_says(NotReadableError, "it has 3 MB, such files have at most 2 MB") as error:
        read_regular(path, 2_000_000)
    assert error.value.errno == errno.EFBIG


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    out = tmp_path_factory.mktemp("compared") / "out"
    assert (
        main(
            ["run", "paper", "--case", "CS-1", "--angles", "0.1", "0.2", "--no-page", "--no-figures", "--out", str(out)]
        )
        == 0
    )
    return out


def cut(path):
    path.write_bytes(path.read_bytes()[:-2000])


def spoil_bytes(path):
    content = bytearray(path.read_bytes())
    content[200:2500] = b"\xff" * 2300
    path.write_bytes(content)


def link(path):
    with h5py.File(path, "r+") as file:
        del file["pin_load"]
        file["pin_load"] = h5py.ExternalLink("elsewhere.nc", "/pin_load")


def shape(path):
    with h5py.File(path, "r+") as file:
        del file["bearing_radial"]
        file["bearing_radial"] = np.zeros((1, 1, 1, 7))


def declare(path):
    with h5py.File(path, "r+") as file:
        file.create_dataset("huge", (10**12,), chunks=(1000,), dtype="f8")


@pytest.mark.family(quick=1)
@pytest.mark.parametrize("damage", [cut, spoil_bytes, link, shape, declare])
def test_a_damaged_second_run_is_refused_in_a_line(damage, run, tmp_path, capsys):
    """Damaged results in --compare ended in an "unforeseen RuntimeError"; external links in them were followed."""
    other = shutil.copytree(run, tmp_path / "other")
    damage(other / "results.nc")
    out = tmp_path / "out"
    assert main(["run", "paper", "--case", "CS-1", "--angles", "0.1", "--compare", str(other), "--out", str(out)]) == 2
    said = capsys.readouterr().err
    assert said.startswith("cyclo: error: --compare = ")
    assert said.count("\n") == 1
    assert "unforeseen" not in said
    assert not out.exists()


def test_a_sound_summary_of_a_second_run_is_read(run):
    assert read_compared(run).summaries["CS-1"]


@pytest.mark.family(quick=1)
@pytest.mark.parametrize(
    "text", ["{", "[]", '{"cases": 3}', '{"cases": {"CS-1": 4}}', '{"cases": {"CS-1": {"a": "b"}}}']
)
def test_a_damaged_summary_of_a_second_run_is_refused(text, run, tmp_path):
    other = shutil.copytree(run, tmp_path / "other")
    (other / "summary.json").write_text(text)
    with error_says(DriveError, "summary.json: is no summary of cyclo run"):
        read_compared(other)


def test_links_in_results_of_a_study_are_not_followed(run, tmp_path):
    path = shutil.copy(run / "results.nc", tmp_path / "results.nc")
    link(path)
    with error_says(DamagedFileError, "pin_load is a link to elsewhere.nc, which is not followed"):
        require_sound_netcdf(tmp_path / "results.nc", "the results of a study", whole=False)


@pytest.mark.parametrize("target", ["pipe", "/dev/zero"])
def test_results_to_compare_with_that_are_no_regular_file(target, tmp_path):
    """Was told as a folder without results.nc."""
    if target == "pipe":
        os.mkfifo(tmp_path / "results.nc")
    else:
        (tmp_path / "results.nc").symlink_to(target)
    with error_says(DriveError, "results.nc is not a regular file"):
        read_compared(tmp_path)


def test_a_folder_is_told_of_where_it_cannot_be_opened(tmp_path, monkeypatch):
    """Windows opens no folder and says that access is denied."""

    def refused(path, flags):
        raise PermissionError(errno.EACCES, "Permission denied", str(path))

    monkeypatch.setattr(regular_files, "os", SimpleNamespace(**{**vars(os), "open": refused}))
    with pytest.raises(OSError, match="not a regular file but a folder"), regular_files.regular_file(tmp_path):
        pass
    with pytest.raises(PermissionError), regular_files.regular_file(tmp_path / "file"):
        pass
