"""Help: every command shows examples, and fields and quantities tell what they are.

That parsers take the examples: tests/test_printed_commands.py.
"""

from __future__ import annotations

from importlib.metadata import entry_points

import pytest

from ltca.commands.program import EXAMPLES, GROUP, main
from ltca.quantities import LIMITED
from ltca.studies.quantities import STAGES

COMMANDS = {entry.name: entry.load() for entry in entry_points(group=GROUP)}


@pytest.mark.parametrize("name", COMMANDS)
def test_help_shows_the_examples(name, capsys):
    examples = getattr(COMMANDS[name], "EXAMPLES", ())
    assert examples, f"cyclo {name} has no EXAMPLES: pairs of a command line and what it does"
    for line, told in examples:
        assert line.split()[:2] == ["cyclo", name]
        assert told
    with pytest.raises(SystemExit):
        main([name, "--help"])
    shown = capsys.readouterr().out
    assert EXAMPLES in shown
    assert all(f"  {line}\n" in shown for line, _ in examples)


def test_fields_tells_one_field(capsys):
    assert main(["fields", "crank_bearing.roller_length"]) == 0
    told = capsys.readouterr().out
    assert "crank_bearing.roller_length: mm; greater than 0; default left out" in told
    assert "refused by fe, full FE" in told
    assert main(["fields"]) == 0
    assert "materials.PART.youngs_modulus: MPa; greater than 0; default 206000" in capsys.readouterr().out


def test_a_misspelt_field_is_told_what_was_meant(capsys):
    assert main(["fields", "pin_whel"]) == 2
    assert "did you mean `pin_wheel`?" in capsys.readouterr().err


def test_quantities_are_those_of_studies_and_limits(capsys):
    assert main(["quantities"]) == 0
    told = capsys.readouterr().out.splitlines()
    names = [line.split()[0] for line in told if line.startswith("  ")]
    assert names == [*STAGES, *LIMITED]


@pytest.mark.slow
def test_quantities_of_a_drive_say_what_it_has_not(capsys):
    """Another source is asked for what is there: friction and pins that bend are none of the paper's drive."""
    assert main(["quantities", "--drive", "paper"]) == 0
    told = {line.split()[0]: line for line in capsys.readouterr().out.splitlines() if line.startswith("  ")}
    assert "no friction" in told["mean_input_torque"]
    assert "pin_wheel.beam" in told["wheel_pin_bending_stress"]
    assert "ISO 76" in told["roller_pressure_mid"]  # a limit of the file
    assert "[" not in told["pin_load"]
