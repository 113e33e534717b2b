"""Time told beforehand: what friction and coupled bodies cost was told by nobody."""

from ltca.analysis.engines import HalfSpace, Hybrid
from ltca.analysis.time_need import expected_seconds, time_words
from ltca.commands.program import main
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive


def test_the_time_of_a_solution_is_told_beforehand(tmp_path, capsys, monkeypatch):
    drive = load_drive("robot-joint").cases["nominal"]
    rubbing = with_fields(drive, {"friction.pin": 0.06})
    for engine in (HalfSpace(), Hybrid()):
        assert expected_seconds([rubbing], 360, engine) > expected_seconds([drive], 360, engine) > 0.0
        # Cases and pairs of contacts add up.
        assert expected_seconds([drive, drive], 10, engine) == 2.0 * expected_seconds([drive], 10, engine)
    assert expected_seconds([drive], 1, Hybrid()) < 0.01  # no extremes between positions of one angle
    assert time_words([drive], 360, HalfSpace()) == ""
    sliced = with_fields(drive, {"contact.slices": 9})
    assert time_words([sliced], 360, HalfSpace()).endswith("(360 positions, half-space, 9 slices)")
    monkeypatch.setattr("ltca.analysis.time_need.TOLD_FROM", 0.0)
    assert main(["run", "paper", "--case", "CS-1", "--angles", "0.3", "--no-page", "--out", str(tmp_path / "out")]) == 0
    told = capsys.readouterr().err
    assert told.splitlines()[0] == "the solution takes some 5 s on one core (1 position, half-space)"
