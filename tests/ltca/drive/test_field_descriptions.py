"""What `cyclo fields` tells: every field has a word, a unit where it is a quantity, and bounds that the reader keeps."""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from ltca.drive.fields import field_kinds
from ltca.drive.reference.engine_support import ENGINES, REFUSED
from ltca.drive.reference.field_descriptions import (
    REQUIRED,
    attribute_sentences,
    by_table,
    describe_fields,
    describe_tables,
    find_fields,
    gathered,
)
from ltca.drive.units.table import label
from ltca.errors import DriveError
from ltca.reading.drive_file import parse_drive, shipped_drive
from ltca.testing.field_changes import EXCEPTIONS

DESCRIBED = {field.path: field for field in describe_fields()}


def is_a_sentence(told):
    return len(told.split()) >= 2 and told.endswith(".")


def test_every_field_and_table_has_a_sentence():
    """A new field without a word in its docstring is red here, by its path."""
    assert {path: field.meaning for path, field in DESCRIBED.items() if not is_a_sentence(field.meaning)} == {}
    assert {path: table.meaning for path, table in describe_tables().items() if not is_a_sentence(table.meaning)} == {}
    assert [is_a_sentence(told) for told in ("", "Word.", "Some words", "Some words, mm.")] == [False] * 3 + [True]


def test_a_field_without_a_word_is_seen():
    """The check above can fail: what no docstring names has an empty meaning."""

    @dataclass
    class Part:
        """A part.

        Attributes
        ----------
        told : float
            Something, mm.

        Notes
        -----
        None.
        """

        told: float
        untold: float

    assert attribute_sentences(Part) == {"told": "Something, mm."}


def test_the_fields_are_those_of_the_definition():
    assert set(field_kinds()) == set(DESCRIBED) - {"crank.of.N.disc", "crank.of.N.crank"}
    for path, kind in field_kinds().items():
        assert DESCRIBED[path].is_array == kind.is_array
        assert DESCRIBED[path].unit == label(kind.unit)
    assert all(table == "" or table in describe_tables() for table in by_table(describe_fields()))


@pytest.mark.parametrize(
    ("path", "word"),
    [
        ("disc.thickness", "greater than 0"),
        ("pin_wheel.number_of_pins", "at least 4"),
        ("load.direction", '"ccw", "cw"'),
    ],
)
def test_bounds_are_those_of_the_reader(path, word):
    """What is told is what the message of a refused value says."""
    assert word in DESCRIBED[path].bounds
    name = path.partition(".")[2]
    text = shipped_drive("paper").splitlines()
    bad = {"thickness": "-1.0", "number_of_pins": "1", "direction": '"up"'}[name]
    row = next(number for number, line in enumerate(text) if line.startswith(f"{name} ="))
    text[row] = f"{name} = {bad}"
    with pytest.raises(DriveError, match=path):
        parse_drive("\n".join(text))


def test_required_fields_are_required():
    """A file of the required fields alone is read, and one without any of them is not."""
    needed = [f for f in describe_fields() if f.default == REQUIRED and not _of_optional(f.table)]
    text = shipped_drive("paper")
    for field in needed:
        lines = [line for line in text.splitlines() if not line.startswith(f"{field.name} =")]
        with pytest.raises(DriveError, match="missing"):
            parse_drive("\n".join(lines))


def _of_optional(table):
    parts = table.split(".")
    above = [".".join(parts[: end + 1]) for end in range(len(parts))]
    return any(describe_tables()[path].optional for path in above if path in describe_tables())


def test_names_find_fields():
    assert [f.path for f in find_fields("disc.thickness")] == ["disc.thickness"]
    assert {f.table for f in find_fields("disc.of.0.runout")} == {"disc.of.N.runout"}
    assert {f.path for f in find_fields("span")} == {"pin_wheel.beam.span", "pin_shaft.beam.span"}
    assert [f.path for f in find_fields("disc.phases.1")] == ["disc.phases"]
    assert find_fields("nothing") == ()
    assert len(gathered(describe_fields())) == len(DESCRIBED) - 7 * 9  # nine fields of seven more parts, told once


def test_engines_and_their_refusals_are_of_this_definition():
    """The walk of the contract holds the refusals themselves; here that they name what there is."""
    assert set(ENGINES) == set(REFUSED) == set(EXCEPTIONS) - {"curves", "studies"}
    for fields in REFUSED.values():
        for path in fields:
            assert path in DESCRIBED or path in describe_tables(), path
