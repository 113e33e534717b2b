"""A value changed in the text of a drive file: TOML's own reader says what was meant, everything else stays to the letter."""

import difflib
import tomllib

import pytest
from refusals import error_says

from ltca.drive.declaration import declared_fields
from ltca.errors import DriveError
from ltca.reading.arguments import SHIPPED_DRIVES
from ltca.reading.drive_file import shipped_drive
from ltca.reading.toml_edit import literal, with_entry, with_values, without_entry

FIELDS = [path for path in declared_fields() if ".N." not in path]


def read(table, path):
    for key in path.split("."):
        table = table[int(key)] if isinstance(table, list) else table[key]
    return table


def written(text, path):
    try:
        return read(tomllib.loads(text), path)
    except (KeyError, TypeError):
        return None


@pytest.mark.family(quick=1)
@pytest.mark.parametrize(
    ("name", "every"), [*((name, 5) for name in SHIPPED_DRIVES), pytest.param("paper", 1, marks=pytest.mark.slow)]
)
def test_every_field_of_every_shipped_drive_can_be_set_and_taken_away(name, every):
    text = shipped_drive(name)
    for path in FIELDS[::every]:
        if isinstance(written(text, path.rpartition(".")[0]), str) and not path.startswith("materials."):
            with error_says(DriveError, starts=f"{path}: cannot be changed"):
                with_values(text, {path: "1.25"})  # preload = "80 N"
            continue
        changed = with_values(text, {path: "1.25"})
        assert read(tomllib.loads(changed), path) == 1.25
        gone = with_values(changed, {path: None})
        with pytest.raises(KeyError):
            read(tomllib.loads(gone), path)


def test_one_line_differs_and_its_comment_stays():
    text = shipped_drive("paper")
    changed = with_values(text, {"disc.shifting_offset": "0.1"})
    lines = [line for line in difflib.ndiff(text.splitlines(), changed.splitlines()) if line[0] in "+-"]
    assert lines == ["- shifting_offset = 0.09        # ΔR_C", "+ shifting_offset = 0.1        # ΔR_C"]


@pytest.mark.parametrize(
    ("text", "path", "value", "expected"),
    [
        ('a = "# no comment"  # one\n', "a", "2", "a = 2  # one\n"),
        ("[t]\nx = [1, # one\n  2]\ny = 3\n", "t.x", "[4]", "[t]\nx = [4]\ny = 3\n"),
        ("m = { n = { o = 1 }, p = 2 }", "m.n.o", "5", "m = { n = { o = 5 }, p = 2 }"),
        ("m = {}\n", "m.n", "5", "m = { n = 5 }\n"),
        ("[[c]]\na = 1\n[[c]]\na = 2\n[c.b]\nd = 3\n", "c.1.b.d", "4", "[[c]]\na = 1\n[[c]]\na = 2\n[c.b]\nd = 4\n"),
        ("l = [{ a = 1 }, { a = 2 }]\n", "l.1.a", "3", "l = [{ a = 1 }, { a = 3 }]\n"),
        ('"quoted key" = 1\n[t]\nx = """\n[no] = 1"""\n', "t.x", "1", '"quoted key" = 1\n[t]\nx = 1\n'),
        ("materials.disc = 'PA12'\n", "materials.disc.density", "1.1",
         "materials.disc = { like = 'PA12', density = 1.1 }\n"),
    ],
)  # fmt: skip
def test_ways_to_write_a_value(text, path, value, expected):
    assert with_values(text, {path: value}) == expected


@pytest.mark.parametrize(
    ("text", "path"), [("a = [1, 2]\n", "a.b"), ("a = 1\n", "a.b"), ("a = \n", "a"), ("a = 1979-05-27\n", "a.x.y")]
)
def test_what_cannot_be_changed_alone_is_refused_by_name(text, path):
    with error_says(DriveError, starts=f"{path}: cannot be changed"):
        with_values(text, {path: "1"})


@pytest.mark.parametrize(
    ("path", "typed", "expected"),
    [
        ("clearance.bearing", ".5", 0.5), ("clearance.bearing", "5.", 5.0), ("clearance.bearing", "20 µm", "20 µm"),
        ("clearance.bearing", '"\\', '"\\'), ("disc.number_of_discs", "02", 2), ("disc.number_of_discs", "2.5", "2.5"),
        ("load.direction", "cw", "cw"), ("pin_shaft.elastic_contact", "true", True), ("disc.phases", "0, 1.5", [0, 1.5]),
        ("disc.phases", "", []), ("name", "a\x7fb", "a\x7fb"),
    ],
)  # fmt: skip
def test_what_is_typed_is_what_is_read(path, typed, expected):
    assert tomllib.loads(f"a = {literal(declared_fields()[path], typed)}")["a"] == expected


def test_entries_are_added_after_those_that_are_there():
    text = "[[duty]]\ntorque = 1.0\n\n[[case]]\nname = 'a'\n"
    assert [list(one) for one in tomllib.loads(with_entry(text, "duty"))["duty"]] == [["torque"], []]
    assert tomllib.loads(with_entry(text, "disc.of"))["disc"] == {"of": [{}]}
    with error_says(DriveError, starts="disc.of: an entry cannot be added"):
        with_entry("[disc]\nof = [{}]\n", "disc.of")


@pytest.mark.parametrize(
    ("text", "path", "expected"),
    [
        ("[limits]\n# of the maker\nmax_a = 1 # x\nmax_b = 2\n", "limits.max_a", "[limits]\n# of the maker\nmax_b = 2\n"),
        ("[limits]\nmax_b = 2\n[limits.max_a]\nvalue = 1\n# y\nsource = 's'\n[x]\ny = 1\n", "limits.max_a",
         "[limits]\nmax_b = 2\n[x]\ny = 1\n"),
        ("[[c]]\na = 1\n[c.b]\nd = 3\n[c.e]\nf = 1\n# next\n[[c]]\na = 2\n", "c.0", "# next\n[[c]]\na = 2\n"),
        ("[[c]]\na = 1\n[[c]]\na = 2\n[c.b]\nd = 3", "c.1", "[[c]]\na = 1\n"),
        ("[[c]]\na = 1\n", "c.0", ""),
        ("[t]\nx.y = { d = 'n' }\nx.z = 1\n", "t.x.y", "[t]\nx.z = 1\n"),
        ("[t.x.y]\nd = 'n'\n", "t.x.y", ""),
        ("t = { x = 1, y = 2 }\n", "t.x", "t = { y = 2 }\n"),
    ],
)  # fmt: skip
def test_entries_are_taken_away_with_all_that_is_in_them(text, path, expected):
    assert without_entry(text, tuple(path.split("."))) == expected


@pytest.mark.parametrize(("text", "path"), [("l = [{ a = 1 }]\n", "l.0"), ("a = 1\n", "b"), ("a = 1\n", "a.0")])
def test_what_cannot_be_taken_away_alone_is_refused_by_name(text, path):
    with error_says(DriveError, starts=f"{path}: cannot be taken away"):
        without_entry(text, tuple(path.split(".")))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a = 1\n", "a = 1\n\n[tolerances]\ncrank.e = 2\n"),
        ("[tolerances]\ndisc.x = 1 # y\n\n[z]\n", "[tolerances]\ndisc.x = 1 # y\ncrank.e = 2\n\n[z]\n"),
    ],
)
def test_tolerances_stand_in_one_table_with_their_dots(text, expected):
    assert with_values(text, {("tolerances", "crank", "e"): "2"}) == expected


def test_a_key_with_dots_is_one_key():
    changed = with_values('[bearings."K 1.5"]\nbore = 1\n', {("bearings", "K 1.5", "bore"): "2"})
    assert changed == '[bearings."K 1.5"]\nbore = 2\n'


def test_what_stands_behind_a_new_table_stays():
    text = "[load]\ntorque = 1.0\n\n[limits]\nmax_pin_pressure_mid = 1500.0  # of the maker\n"
    changed = with_values(text, {"friction.pin": "0.1"})
    assert tomllib.loads(changed) == tomllib.loads(text) | {"friction": {"pin": 0.1}}
    assert changed.endswith("max_pin_pressure_mid = 1500.0  # of the maker\n")
