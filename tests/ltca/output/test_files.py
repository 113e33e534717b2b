"""Files are whole or not there."""

from __future__ import annotations

import errno
import json
import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from ltca.commands.program import main
from ltca.errors import CycloError, FaultError, PlaceError
from ltca.output import files
from ltca.output.files import whole_file, write_json


def test_file_appears_only_when_the_block_ends_well(tmp_path):
    path = tmp_path / "deep" / "file.txt"
    with whole_file(path) as part:
        part.write_text("half")
        assert not path.exists()
    assert path.read_text() == "half"
    assert list(path.parent.iterdir()) == [path]


def test_interrupted_write_leaves_the_old_file(tmp_path):
    path = tmp_path / "file.txt"
    path.write_text("old")

    def interrupted():
        with whole_file(path) as part:
            part.write_text("new, half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_old_file_is_replaced_not_written_over(tmp_path):
    """Whoever has the old file open or linked keeps it whole; a kill between two writes cannot halve the new one."""
    path, link = tmp_path / "file.txt", tmp_path / "link.txt"
    path.write_text("old")
    link.hardlink_to(path)
    with whole_file(path) as part:
        part.write_text("new")
    assert path.read_text() == "new"
    assert link.read_text() == "old"


def test_suffix_is_kept_for_writers_that_choose_by_it(tmp_path):
    with whole_file(tmp_path / "a.svg") as part:
        assert part.suffix == ".svg"
        assert part.parent == tmp_path
        part.touch()


def test_folder_that_cannot_be_made(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(CycloError, match="cannot be written"), whole_file(tmp_path / "file" / "x.txt") as part:
        part.touch()


def test_a_folder_that_takes_no_file_was_a_fault_of_ours(tmp_path):
    """`cyclo init /proc/x.toml` ended with status 1, as a full disc does."""
    (tmp_path / "file").touch()
    (tmp_path / "loop").symlink_to("loop")
    places = [tmp_path / "file" / "x.txt", tmp_path / "loop" / "x.txt"]
    for place in [*places, *([Path("/proc/x.txt")] if Path("/proc/self").exists() else [])]:
        with pytest.raises(PlaceError, match="cannot be written") as caught, whole_file(place) as part:
            part.touch()
        assert caught.value.exit_status == 2
    with pytest.raises(FaultError, match="No space left"), whole_file(tmp_path / "full.txt"):
        raise OSError(errno.ENOSPC, "No space left on device")
    assert not (tmp_path / "full.txt").exists()


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="/proc takes no files, whoever asks")
@pytest.mark.parametrize(
    "words",
    [["init", "/proc/x.toml"], ["show", "paper", "--out", "/proc/x"], ["derive", "paper", "--out", "/proc/x.nc"]],
)
def test_a_command_that_was_to_write_where_nothing_can_be(words, capsys):
    assert main(words) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "/proc/x" in line
    assert "cannot be written" in line


def test_a_device_was_replaced_by_a_drive_file(tmp_path, capsys):
    os.mkfifo(tmp_path / "pipe.toml")
    assert main(["init", str(tmp_path / "pipe.toml"), "--force"]) == 2
    assert "is no regular file" in capsys.readouterr().err
    assert (tmp_path / "pipe.toml").is_fifo()


def test_a_killed_run_leaves_no_half_written_file(tmp_path):
    code = (
        "import os, sys\n"
        "from pathlib import Path\n"
        "from ltca.output.files import whole_file\n"
        "with whole_file(Path(sys.argv[1])) as part:\n"
        "    part.write_text('half')\n"
        "    os.kill(os.getpid(), 9)\n"
    )
    child = subprocess.run([sys.executable, "-c", code, str(tmp_path / "x.msh")], check=False)
    assert child.returncode == -9
    assert not (tmp_path / "x.msh").exists()


def test_written_files_have_ordinary_rights(tmp_path):
    with whole_file(tmp_path / "x.msh") as part:
        part.write_text("x")
    (tmp_path / "plain").write_text("x")
    assert os.stat(tmp_path / "x.msh").st_mode == os.stat(tmp_path / "plain").st_mode


def test_json_refuses_what_is_no_number(tmp_path):
    write_json(tmp_path / "a.json", {"größe": 1.5})
    assert json.loads((tmp_path / "a.json").read_text(encoding="utf-8")) == {"größe": 1.5}
    with pytest.raises(ValueError, match="JSON"):
        write_json(tmp_path / "b.json", {"x": float("nan")})
    assert [path.name for path in tmp_path.iterdir()] == ["a.json"]


def test_a_file_that_a_scanner_holds_for_a_moment_is_replaced_on_windows(tmp_path, monkeypatch):
    """Windows refuses to replace what another program has open; the second trial is in vain here, the third is not."""
    path, trials, replace = tmp_path / "a.txt", [], Path.replace
    path.write_text("old", encoding="utf-8")

    def held(part, place):
        trials.append(place)
        if len(trials) < 3:
            raise PermissionError(13, "Access is denied")
        return replace(part, place)

    monkeypatch.setattr(Path, "replace", held)
    monkeypatch.setattr(files, "PAUSES", (0.0,) * 4)
    monkeypatch.setattr(files, "os", SimpleNamespace(**{**vars(os), "name": "nt"}))
    with whole_file(path) as part:
        part.write_text("new", encoding="utf-8")
    assert path.read_text(encoding="utf-8") == "new"
    assert len(trials) == 3
