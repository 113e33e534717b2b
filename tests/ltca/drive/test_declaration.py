"""What `cyclo fields` tells: every field has a word, a unit where it is a quantity, and bounds that the reader keeps."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from refusals import refused_field

from ltca.drive.declaration import (
    INDICES,
    REQUIRED,
    attribute_sentences,
    by_table,
    declared_fields,
    declared_tables,
    find_fields,
    gathered,
    naming_fields,
)
from ltca.drive.fields import absence, field_kinds, read_field
from ltca.drive.materials import PARTS
from ltca.drive.members.operation import Temperature
from ltca.drive.members.temperatures import Growth, warm_drive
from ltca.errors import DriveError
from ltca.reading.drive_file import parse_drive, shipped_drive

DECLARED = declared_fields()
ROOT = Path(__file__).parents[3]


def is_a_sentence(told):
    return len(told.split()) >= 2 and told.endswith(".")


def test_every_field_and_table_has_a_sentence():
    """A new field without a word in its docstring is red here, by its path."""
    assert {path: field.meaning for path, field in DECLARED.items() if not is_a_sentence(field.meaning)} == {}
    assert {path: table.meaning for path, table in declared_tables().items() if not is_a_sentence(table.meaning)} == {}
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


def test_paths_are_those_of_the_declaration():
    assert set(field_kinds()) == set(DECLARED) - set(INDICES)
    assert all(table == "" or table in declared_tables() for table in by_table(tuple(DECLARED.values())))


def test_every_length_grows():
    """A new length says how it grows with temperature; a depth of hardness is judged by alone."""
    lengths = {path for path, field in DECLARED.items() if field.unit == "mm" and field.grows is None}
    assert {path for path in lengths if not path.endswith(".hardness_depth")} == set()
    for path, field in DECLARED.items():
        assert field.grows is None or isinstance(getattr(Growth, field.grows.part), object), path
        assert field.grows is None or field.grows.upon == "" or DECLARED[field.grows.upon].unit == "mm", path


@pytest.mark.parametrize("name", ["paper", "robot-joint", "rv", "sleeved", "contract"])
def test_a_drive_of_one_material_at_one_temperature_is_larger_in_every_length(name):
    """Each length by 1 + α ΔT, deviations included: a growth forgotten in the definition shows by its path.

    Tolerance: deviations are differences of lengths of 100 mm, with their rounding.
    """
    source = ROOT / "tests" / "contract" / "drive.toml" if name == "contract" else None
    file = parse_drive(source.read_text(encoding="utf-8") if source else shipped_drive(name), name)
    cold = next(iter(file.cases.values()))
    materials = {part: replace(getattr(cold.materials, part), thermal_expansion=2e-5) for part in PARTS}
    hot = Temperature(housing=70.0, disc=70.0, shaft=70.0)
    warm = warm_drive(replace(cold, materials=replace(cold.materials, **materials), temperature=hot))
    compared = 0
    for path, field in DECLARED.items():
        place = path.replace(".N.", ".0.")
        if field.grows is not None and absence(cold, place) is None:
            try:
                before = read_field(cold, place)
            except DriveError:
                continue  # left out
            assert read_field(warm, place) == pytest.approx(np.multiply(before, 1.001), abs=1e-12), path
            compared += bool(np.any(before))
    assert compared > 10


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
    assert word in DECLARED[path].bounds
    name = path.partition(".")[2]
    text = shipped_drive("paper").splitlines()
    bad = {"thickness": "-1.0", "number_of_pins": "1", "direction": '"up"'}[name]
    row = next(number for number, line in enumerate(text) if line.startswith(f"{name} ="))
    text[row] = f"{name} = {bad}"
    with refused_field(path):
        parse_drive("\n".join(text))


def test_required_fields_are_required():
    """A file of the required fields alone is read, and one without any of them is not."""
    needed = [f for f in DECLARED.values() if f.default == REQUIRED and not _of_optional(f.table)]
    text = shipped_drive("paper")
    for field in needed:
        lines = [line for line in text.splitlines() if not line.startswith(f"{field.name} =")]
        with pytest.raises(DriveError, match="missing"):
            parse_drive("\n".join(lines))


def _of_optional(table):
    parts = table.split(".")
    above = [".".join(parts[: end + 1]) for end in range(len(parts))]
    return any(declared_tables()[path].optional for path in above if path in declared_tables())


def test_names_find_fields():
    assert [f.path for f in find_fields("disc.thickness")] == ["disc.thickness"]
    assert {f.table for f in find_fields("disc.of.0.runout")} == {"disc.of.N.runout"}
    assert {f.path for f in find_fields("span")} == {"pin_wheel.beam.span", "pin_shaft.beam.span"}
    assert [f.path for f in find_fields("disc.phases.1")] == ["disc.phases"]
    assert {f.table for f in find_fields("beam")} == {"pin_wheel.beam", "pin_shaft.beam"}
    assert find_fields("nothing") == ()
    # nine fields of eight more parts, told once; names of bearings and their entries stand for fields
    assert len(gathered()) == len(DECLARED) - 8 * 9 + len(naming_fields())
