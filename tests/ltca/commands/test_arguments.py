"""The same option means the same in every command: metavar, unit, default folder; numbers are checked where they enter."""

from __future__ import annotations

import argparse
import math

import pytest
from refusals import error_says

from ltca.commands.program import ORDER, build_parser, main
from ltca.drive.names import names_a_file
from ltca.errors import CycloError
from ltca.reading.drive_file import shipped_drive

PARSER = build_parser()
(COMMANDS,) = (action.choices for action in PARSER._actions if isinstance(action, argparse._SubParsersAction))
POSITIONALS = {
    "sweep": ["x.toml"], "init": ["x.toml"], "optimise": ["paper", "--vary", "x", "--minimise", "y"],
    "export": ["paper", "--for", "mujoco"],
}  # fmt: skip


def options(name):
    return {word: action for action in COMMANDS[name]._actions for word in action.option_strings}


def parse(name, *words):
    return PARSER.parse_args([name, *POSITIONALS.get(name, ["paper"]), *words])


def test_every_command_is_looked_at():
    assert tuple(COMMANDS) == ORDER


WITHOUT_FOLDER = {"init", "fields", "quantities", "studio"}
"""Commands that write no folder of results."""


def test_metavars_are_the_same_in_all_commands():
    seen = {}
    for name in COMMANDS:
        for action in COMMANDS[name]._actions:
            words = action.option_strings or [action.dest]
            seen.setdefault(words[-1], {}).setdefault(str(action.metavar), []).append(name)
    folders = [name for name in ORDER if name not in {*WITHOUT_FOLDER, "derive"}]
    assert seen.pop("--out") == {"DIR": folders, "FILE": ["derive"]}
    assert {word: found for word, found in seen.items() if len(found) > 1} == {}


def test_folders_are_named_after_drive_and_command():
    for name in set(ORDER) - WITHOUT_FOLDER - {"run", "sweep", "derive"}:
        assert f"default out/<drive>_{name}" in " ".join(options(name)["--out"].help.split())
    assert "default out/<drive>" in options("run")["--out"].help
    assert "default out/<study>_sweep" in options("sweep")["--out"].help
    assert "default out/<drive>_derive/coefficients.nc" in options("derive")["--out"].help


QUANTITIES = [
    (name, word, text, value)
    for word, text, value in (
        ("--angle", "20 deg", math.radians(20.0)), ("--angles", "-20deg", math.radians(-20.0)),
        ("--pressure", "30′", math.radians(0.5)), ("--torque", "377.3 N m", 377_300.0), ("--torque", "377.3", 377.3),
        ("--pressure-limit", "1.5 GPa", 1500.0), ("--load-rating", "40 kN", 40_000.0), ("--speed", "1500 rpm", 1500.0),
        ("--load", "1.5 kN", 1500.0), ("--speed", "1500", 1500.0), ("--size", "50 %", 0.5), ("--stations", "2", 2.0),
        ("--at", "2 ms", 0.002), ("--within", "2 s", 2.0), ("--from-speed", "10 rpm", 10.0), ("--frequency", "1 kHz", 1000.0),
        ("--amplitude", "50 %", 0.5), ("--factor", "2", 2.0),
    )
    for name in ORDER
    if word in options(name)
]  # fmt: skip


@pytest.mark.parametrize(("name", "word", "text", "value"), QUANTITIES)
def test_quantities_take_units_wherever_they_are_asked_for(name, word, text, value):
    found = getattr(parse(name, word, text), word.strip("-").replace("-", "_"))
    assert (found[0] if isinstance(found, list) else found) == value


def test_every_number_is_read_by_our_own_grammar():
    """float and int of Python take nan, inf, 1_000 and Arabic digits."""
    for name in ORDER:
        for word, action in options(name).items():
            assert action.type not in (int, float), (name, word)
    assert {name for name, *_ in QUANTITIES} >= {"run", "show", "curves", "mesh", "fem", "derive", "validate"}


NUMBERS = sorted(
    {word for name in ORDER for word, action in options(name).items() if action.type is not None} - {"--out"}
)


@pytest.mark.family(quick=12)
@pytest.mark.parametrize("word", NUMBERS)
def test_what_is_no_number_is_refused_in_one_line(word, capsys):
    (name, *_) = [name for name in ORDER if word in options(name)]
    if word in ("--coefficients", "--order"):
        pytest.skip("a file, a choice")
    for text in ("nan", "inf", "-inf", "1e999", "1e9", "x", "", "1,5", "1_000", "٣", "7" * 400, "1/0", "true", "5 kg"):
        if text == "1e9" and word in {word for _, word, *_ in QUANTITIES}:
            continue  # large, but a quantity
        assert main([name, *POSITIONALS.get(name, ["paper"]), f"{word}={text}"]) == 2, text
        out, err = capsys.readouterr()
        assert out == ""
        assert err.count("\n") == 1, err
        assert err.startswith(f"cyclo: error: {word} = "), err
        assert err[:-1].isprintable()


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["rnu", "paper"], "did you mean `run`?"),
        (["run", "paper", "--postions", "3"], "did you mean `--positions`?"),
        (["run", "paper", "--compliance", "hybird"], "did you mean `hybrid`?"),
        (["run"], "the following arguments are required: DRIVE"),
    ],
)
def test_usage_is_told_in_one_line_with_what_was_meant(words, told, capsys):
    with pytest.raises(SystemExit) as stopped:
        main(words)
    assert stopped.value.code == 2
    err = capsys.readouterr().err
    assert told in err
    assert err.count("\n") == 1


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["tolerance", "paper", "--quantities", "max_pin_laod"], "did you mean `max_pin_load`?"),
        (["optimise", "paper", "--vary", "thicknes", "--minimise", "max_pin_load"], "did you mean `thickness`?"),
        (["optimise", "paper", "--vary", "thickness", "--minimise", "max_pin_laod"], "did you mean `max_pin_load`?"),
        (["run", "paper", "--case", "cs-1"], "did you mean `CS-1`?"),
    ],
)
def test_names_that_are_not_there_ask_for_the_nearest(words, told, capsys):
    assert main(words) == 2
    assert told in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["run", "paper", "--case", "CS-1", "--case", "CS-1"], "--case CS-1: is given twice"),
        (["optimise", "paper", "--vary", "thickness", "disc.thickness=9:12", "--minimise", "max_pin_load"],
         "--vary disc.thickness: is given twice"),
        (["optimise", "paper", "--vary", "thickness", "--minimise", "max_pin_load", "max_pin_load"],
         "--minimise max_pin_load max_pin_load: give one quantity, or two different ones"),
        (["tolerance", "paper", "--quantities", "max_pin_load", "max_pin_load"], "max_pin_load: is given twice"),
        # 52 fields of the shipped drive scatter: a block has 54 samples
        (["tolerance", "paper", "--design", "saltelli", "--samples", "3"],
         "--samples = 3: --design saltelli must have at least"),
        (["run", "paper", "--out", ""], "--out = '': is empty"),
        (["run", "paper", "--out", " "], "--out = ' ': is empty"),
        (["run", "paper", "--out", "a\nb"], "--out = 'a\\nb': must not have control or invisible characters"),
        (["run", "paper", "--out", "a\u200bb"], "--out = 'a\\u200bb': must not have control or invisible characters"),
        (["run", "paper", "--out", "a" * 300], "no name in it can have more than 255 bytes"),
        (["tolerance", "paper", "--out", "x/" + "ä" * 128], "no name in it can have more than 255 bytes"),
        (["derive", "paper", "--out", ""], "--out = '': is empty"),
        (["run", "paper", "--compliance", "fe", "--coefficients", "a" * 300], "File name too long"),
        (["sweep", "a" * 300], "File name too long"),
        (["run", "a" * 300], "File name too long"),
        (["derive", "--check", "a" * 300], "File name too long"),
        (["run", "paper", "--out", "a/" * 3000], "File name too long"),
        (["init", "b" * 110 + "/" + "a" * 300 + "/x.toml"], "no name in it can have more than 255"),
    ],
)  # fmt: skip
def test_what_cannot_be_meant_is_refused_in_one_line(words, told, tmp_path, monkeypatch, capsys):
    """Duplicates were taken once in silence, odd folders made, a folder of 300 letters ended with exit status 1."""
    monkeypatch.chdir(tmp_path)
    assert main(words) == 2
    err = capsys.readouterr().err
    assert told in err
    assert err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


SOUND = ["out", ".", "..", "a b", "è/ü", "输出", "می\u200cخواهم", "क्\u200dष", "a" * 255, "a$x_{b$", "'\""]


@pytest.mark.parametrize("name", SOUND)
def test_sound_folders_are_taken(name):
    assert str(parse("run", "--out", name).out) == name


@pytest.mark.parametrize(
    "name",
    [
        "CS\u200b-1",
        "\ufeffCS",
        "CS\u2060",
        "\u200d",
        "CS-\u200c1",
        "\u3164",
        "C\u00adS",
        "\u2800",
        "C\u202eS",
        "a\U000e0041",
        "a\uffff",
        "a\ufdd0",
        "a\U0001fffe",
    ],
)
def test_names_that_nobody_sees_are_refused(name):
    """Two cases could have looked alike; U+FFFF gave MJCF that does not parse."""
    assert not names_a_file(name)


@pytest.mark.parametrize(
    "name", ["CS-1", "Getriebe Größe 3", "می\u200cخواهم", "क्\u200dष", "减速器", "❤\ufe0f", "\u06dd3", "e\u0301"]
)
def test_names_of_any_script_are_taken(name):
    assert names_a_file(name)


@pytest.mark.parametrize("field", ["number_of_pins", "pin_radius"])
def test_numbers_of_hundreds_of_digits_are_told_as_typed(field, tmp_path, capsys):
    """A count of 400 digits was told as 1000000000000000."""
    text = shipped_drive().replace(f"\n{field} = ", f"\n{field} = {'7' * 400} # ", 1)
    path = tmp_path / "drive.toml"
    path.write_text(text, encoding="utf-8")
    assert main(["show", str(path)]) == 2
    assert f"pin_wheel.{field} = {'7' * 57}...: must be" in capsys.readouterr().err
    assert main(["run", "paper", "--positions", "7" * 400]) == 2
    assert f"--positions = {'7' * 55}...: must be" in capsys.readouterr().err


def test_a_torque_turned_round_says_what_turns_it():
    with error_says(CycloError, "--torque = -5: must be at least 0 N·mm (load.direction turns it)"):
        parse("fem", "--torque=-5")
