"""Drive and study files that nobody should write: each is read or refused in clear lines, never anything else."""

from __future__ import annotations

import pytest

from ltca.commands.program import main
from ltca.errors import MOST_TOLD, DriveError
from ltca.reading.drive_file import load_drive, parse_drive
from ltca.studies.sweep_file import load_sweep
from ltca.testing.malformed import BASE, malformed_drives, malformed_studies

SEED = 20261122


def refusal(load, content, path):
    """The message of a refusal, None for a file that is read; a warning is an error here, as everywhere in the tests."""
    path.write_bytes(content)
    try:
        load(path)
    except DriveError as error:
        return str(error)
    return None


def is_clear(message):
    """A few printable lines of bounded length that name the file and say something."""
    lines = message.split("\n")
    return (
        lines[0].startswith("/")
        and len(lines) <= 1 + MOST_TOLD
        and all(line.isprintable() and len(line) < 1500 for line in lines)
    )


@pytest.mark.slow
@pytest.mark.parametrize(("generate", "load"), [(malformed_drives, load_drive), (malformed_studies, load_sweep)])
def test_malformed_files_are_refused_in_clear_lines(generate, load, tmp_path):
    refused = 0
    for sample in generate(SEED, 150):
        message = refusal(load, sample.content, tmp_path / "bad.toml")
        refused += message is not None
        assert message is not None or not sample.wrong, f"accepted: {sample.about}"
        assert message is None or is_clear(message), (sample.about, message)
    assert refused > 130  # most of them are surely wrong


def test_the_generator_gives_the_same_files_again():
    assert list(malformed_drives(1, 20)) == list(malformed_drives(1, 30))[:20]
    assert list(malformed_studies(1, 5)) != list(malformed_studies(2, 5))


def test_the_base_of_the_generator_is_sound():
    """Otherwise every file would be refused for another reason than its own."""
    assert list(parse_drive(BASE).cases) == ["nominal"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("override", "counted"),
    [
        ("clearance = {{ bearing = -{0} }}", "10000 mistakes, the first 10\n  case 1: clearance.bearing = -1: must be"),
        ("clearance = {{ bearing = -1 }}", "cases 1, 2, 3, 4, 5, 6, 7, 8, 9, 10 and 9990 more: clearance.bearing = -1"),
        (
            "crank = {{ eccentricity = 7 }}",
            "1, 2, 3, 4, 5, 6, 7, 8, 9, 10 and 290 more: crank.eccentricity = 7 mm: must",
        ),
    ],
)
def test_ten_thousand_bad_cases_are_counted(override, counted):
    cases = "".join(f'[[case]]\nname = "{k}"\n{override.format(k)}\n' for k in range(1, 10_001))
    with pytest.raises(DriveError) as caught:
        parse_drive(BASE + cases)
    told = str(caught.value)
    assert counted in told
    assert len(told.splitlines()) <= 11
    assert ("9700 cases not checked" in told) == ("eccentricity" in override)


def test_an_unforeseen_exception_is_one_line_and_debug_shows_the_traceback(monkeypatch, capsys):
    def fails(source):
        raise RuntimeError("two\nlines")

    monkeypatch.setattr("ltca.reading.drive_file.load_drive", fails)
    assert main(["show", "paper"]) == 1
    told = capsys.readouterr().err
    assert told.startswith("cyclo: error: unforeseen RuntimeError: two lines. ")
    assert told.count("\n") == 1
    assert "report" in told
    for words in (["--debug", "show", "paper"], ["show", "paper", "--debug"]):
        assert main(words) == 1
        assert "Traceback (most recent call last)" in capsys.readouterr().err
