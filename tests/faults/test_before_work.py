"""What memory or disc cannot hold is refused before any work, by the option that asks for it; long work says where it is."""

from __future__ import annotations

import re
import time
import tracemalloc

import pytest
from refusals import error_says

from fem.mesh import memory_need
from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.memory_need import memory_per_position
from ltca.commands.program import main
from ltca.errors import PlaceError
from ltca.geometry.placement import position_angles
from ltca.output import progress as progress_module, resources
from ltca.output.progress import progress, steps
from ltca.output.resources import require_room
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive


@pytest.mark.parametrize(
    ("words", "free", "option"),
    [
        (["run", "paper", "--positions", "1000000"], 2e9, "--positions 1000000: needs about"),
        # Turns are solved part by part: it takes less memory than a part, or than what is kept of all, to refuse them.
        (["curves", "paper", "--turns", "1000"], 2e7, "--turns 1000: needs about"),
        (["validate", "paper", "--size", "1e-6"], 2e9, "--size 1e-06: the model of disc"),
        (["fem", "paper", "--size", "1e-6"], 2e9, "unknowns and need about"),
    ],
)
def test_memory_that_is_not_there(words, free, option, tmp_path, capsys, monkeypatch):
    """A million positions ended in a MemoryError, and validate --size 1e-6 ran on."""
    for module in (resources, memory_need):
        monkeypatch.setattr(module, "available_memory", lambda: free)
    assert main([*words, "--out", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert said.startswith("cyclo: error: ")
    assert option in said
    assert said.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_memory_of_slices_is_told_before():
    """Slices take six times the memory of the plane and more; the estimate is at most three times what it takes."""
    drive = with_fields(load_drive("paper").cases["CS-1"], {"contact.slices": 9})
    positions = position_angles(12)
    analyse(drive, positions[:4])  # what is made once
    tracemalloc.start()
    try:
        analyse(drive, positions)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert 0.3 < peak / (memory_per_position(drive) * positions.size) < 1.0


@pytest.mark.slow
@pytest.mark.parametrize("ring", [None, {"inner_radius": 60.0, "outer_radius": 90.0, "width": 50.0}])
def test_memory_is_told_before(ring):
    """A ring couples all pins: displacements, slopes and their blocks were not counted, nor several discs.

    The estimate is that of the dearest engine; half-spaces take a third of it at least, all told.
    """
    drive = load_drive("robot-joint").cases["nominal"]
    drive = drive if ring is None else with_fields(drive, {"ring": ring})
    positions = position_angles(12)
    analyse(drive, positions[:4])  # what is made once
    tracemalloc.start()
    try:
        analysis = analyse(drive, positions)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert 0.3 < peak / (memory_per_position(drive) * positions.size) < 1.0
    # What only the search asks for is not kept.
    inner = analysis.full.response.inner
    assert (inner.shifts is None) == (ring is None)
    assert inner.by_pose is inner.approach_by_pose is inner.shifts_by_pose is None


def test_room_on_the_disc(tmp_path, monkeypatch):
    room = resources.shutil.disk_usage(tmp_path).free
    require_room(0.5 * room, memory=0.0, folder=tmp_path / "not" / "there", option="x")
    with error_says(PlaceError, "are free in --out", starts="2000 samples: results take about "):
        require_room(2.0 * room, memory=0.0, folder=tmp_path / "not" / "there", option="2000 samples")


def test_without_a_terminal_a_line_says_where_it_is(monkeypatch, capsys):
    """239 s passed with one line. What is quick says nothing."""
    with progress("quick", 3) as advance, steps("quick") as show:
        show("one")
        advance("one")
    assert capsys.readouterr().err == ""
    for name in ("FIRST", "SECONDS"):
        monkeypatch.setattr(progress_module, name, 0.02)

    def two_lines():
        """Wait for them, the second of which knows what was told before: how soon they come is the machine's."""
        capsys.readouterr()
        said, end = "", time.monotonic() + 300.0
        while said.count("\n") < 2 and time.monotonic() < end:
            time.sleep(0.01)
            said += capsys.readouterr().err
        return [re.sub(r"\(\d+ s\)", "(… s)", line) for line in said.rpartition("\n")[0].split("\n")]

    with progress("candidates", 90, at_most=True) as advance:
        advance("solved", 30)
        *_, last = two_lines()
    assert last == "candidates: 30 of at most 90, solved (… s)"
    capsys.readouterr()
    with steps("deriving") as show:
        show("disc")
        *_, last = two_lines()
    assert last == "deriving: disc (… s)"
    capsys.readouterr()
    # Two streams of lines ran into each other where coefficients were derived within a search.
    with steps("design") as show, progress("coefficients", 1):
        show("candidate 1")
        lines = two_lines()
    assert {"design: candidate 1; coefficients: 0 of 1 (… s)"} >= set(lines[1:])
