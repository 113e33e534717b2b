"""Malformed drive and study files by a seeded generator: wrong values, texts, structures and bytes.

A file either is certainly wrong, and must be refused, or may be valid by chance (a changed letter in a comment); in both cases
reading it ends with drives or a `DriveError`, nothing else.
"""

from __future__ import annotations

import random
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from ltca.drive.declaration import find_fields
from ltca.reading.drive_file import shipped_drive

DIGITS = "7" * 400
NO_QUANTITY = (
    "nan", "-nan", "inf", "-inf", "true", "false", "[]", "[1.0]", "{}", "{ value = 1.0 }", "1979-05-27", "07:32:00",
    '""', '" "', '"mm"', '"abc"', '"1,5 mm"', '"377 300 N mm"', "\"377'300\"", '"1_000.5"', '"1/0 mm"', '"9**9**9**9 mm"',
    '"nan mm"', '"inf"', '"5 parsec"', '"5 kg"', '"1e999999999 mm"', '"--5 mm"', '"5 mm 5 mm"', '"5\\u0000mm"', '"٣ mm"',
    '"__import__(\'os\')"', '"${HOME}"', "1e308", "-1e308", "1e400", DIGITS, f"-{DIGITS}", f'"{DIGITS}"', f'"{"5 mm" * 5000}"',
    "'''5\nmm'''", '"5 mm²³"', '"5 e3 mm"', '"0x10 mm"', "0xffffffffffffffffffffffffffffffff",
)  # fmt: skip
"""Texts that are not a value of any quantity of a drive."""
NO_COUNT = (
    "13.5", "-1", "0", "nan", "inf", "true", "1e308", "1e400", DIGITS, f"-{DIGITS}", '"many"', '"14 mm"', '"1e1"', "[14]",
    "{}", '""', "1001", "100000000000000000000", "1979-05-27",
)  # fmt: skip
NO_NAME = (
    '""',
    '"a/b"',
    '"a\\\\b"',
    '"a\\u0000b"',
    '"a\\nb"',
    '"a\\u001b[31mb"',
    '".."',
    "5",
    "true",
    "[]",
    f'"{DIGITS}"',
)
BASE = shipped_drive().partition("[[case]]")[0].partition("# How parts scatter")[0]


@dataclass(frozen=True, slots=True, kw_only=True)
class Malformed:
    """One file.

    Attributes
    ----------
    about : str
        Description of the change.
    content : bytes
        Bytes of the file.
    wrong : bool
        Whether the file is certainly wrong.
    """

    about: str
    content: bytes
    wrong: bool = True


def malformed_drives(seed: int, count: int) -> Iterator[Malformed]:
    """Yield `count` drive files; file k of a seed does not depend on the count."""
    for number in range(count):
        draw = random.Random(f"drive {seed} {number}")
        yield draw.choice(DRIVES)(draw)


def malformed_studies(seed: int, count: int) -> Iterator[Malformed]:
    """Yield study files; see `malformed_drives`."""
    for number in range(count):
        draw = random.Random(f"study {seed} {number}")
        yield draw.choice(STUDIES)(draw)


def _lines(text: str) -> list[tuple[int, str, str]]:
    """Assignments ``field = value`` of a text: line, field, value without its comment."""
    found = []
    for number, line in enumerate(text.splitlines()):
        match = re.fullmatch(r"(\w+) = ([^#]*?)\s*(#.*)?", line)
        if match and match[1] != "profile_errors":
            found.append((number, match[1], match[2]))
    return found


def _with_line(text: str, number: int, line: str) -> str:
    lines = text.splitlines()
    lines[number] = line
    return "\n".join(lines) + "\n"


def _value(draw: random.Random) -> Malformed:
    number, field, _ = draw.choice([item for item in _lines(BASE) if re.fullmatch(r"[-\d.e]+", item[2])])
    value = draw.choice(NO_COUNT if find_fields(field)[0].kind == "count" else NO_QUANTITY)
    return Malformed(about=f"{field} = {value[:40]}", content=_with_line(BASE, number, f"{field} = {value}").encode())


def _tiny(draw: random.Random) -> Malformed:
    number, field, _ = draw.choice([item for item in _lines(BASE) if re.fullmatch(r"[\d.e]+", item[2])])
    value = draw.choice(("5e-324", "1e-300", "-5e-324", "1e-12", "1e6", "1e9", "1e18", '"1 nm"', '"1e3 m"'))
    content = _with_line(BASE, number, f"{field} = {value}").encode()
    return Malformed(about=f"{field} = {value}", content=content, wrong=False)


def _misspelt(draw: random.Random) -> Malformed:
    number, field, value = draw.choice(_lines(BASE)[1:])
    place = draw.randrange(len(field) - 1)
    changed = draw.choice((field[:place] + field[place + 1 :], field[:place] + "x" + field[place:]))
    return Malformed(about=f"{field} as {changed}", content=_with_line(BASE, number, f"{changed} = {value}").encode())


def _left_out(draw: random.Random) -> Malformed:
    tables = re.findall(r"^\[(?!materials|clearance|limits|analysis)\w+\]$", BASE, re.MULTILINE)
    table = draw.choice(tables)
    start = BASE.index(table)
    end = BASE.find("\n[", start)
    return Malformed(about=f"without {table}", content=(BASE[:start] + BASE[end:]).encode())


def _table_as_value(draw: random.Random) -> Malformed:
    tables = re.findall(r"^\[(\w+)\]$", BASE, re.MULTILINE)
    table, value = draw.choice(tables), draw.choice(("5", "[]", '"x"', "true", "[{}]", "nan", "1979-05-27"))
    start = BASE.index(f"[{table}]")
    end = BASE.find("\n[", start)
    end = len(BASE) if end < 0 else end
    return Malformed(about=f"{table} = {value}", content=(f"{table} = {value}\n" + BASE[:start] + BASE[end:]).encode())


def _deep(draw: random.Random) -> Malformed:
    depth = draw.choice((30, 1001, 5000, 100_000))
    text = draw.choice(
        (
            f"x = {'[' * depth}{']' * depth}",
            f"x = {'{a=' * depth}1{'}' * depth}",
            f"{'a.' * min(depth, 5000)}a = 1",
            f"[{'a.' * min(depth, 5000)}a]",
            "x = " + "[" * depth,
        )
    )
    return Malformed(about=f"nested {depth}", content=f"{text}\n{BASE}".encode())


def _bytes(draw: random.Random) -> Malformed:
    content = bytearray(BASE.encode())
    for _ in range(draw.choice((1, 1, 3, 30))):
        place = draw.randrange(len(content))
        match draw.randrange(3):
            case 0:
                content[place] = draw.randrange(256)
            case 1:
                del content[place]
            case 2:
                content.insert(place, draw.randrange(256))
    return Malformed(about="bytes changed", content=bytes(content), wrong=False)


def _cut(draw: random.Random) -> Malformed:
    content = BASE.encode()
    return Malformed(about="cut short", content=content[: draw.randrange(content.index(b"torque = 3"))])


def _noise(draw: random.Random) -> Malformed:
    return Malformed(about="noise", content=draw.randbytes(draw.choice((1, 50, 5000))) + b"\xff")


def _case(draw: random.Random) -> Malformed:
    many = draw.choice((10, 300, 2000))
    text = draw.choice(
        [f"[[case]]\nname = {name}" for name in NO_NAME]
        + [
            "case = 5", "case = [5]", "case = {}", '[case]\nname = "a"', "[[case]]\nclearance = {}", '[[case]]\nname = ["a"]',
            '[[case]]\nname = "a"\n[[case]]\nname = "a"', '[[case]]\nname = "a"\ncranks = {}', '[[case]]\nname = "a"\ncrank = 5',
            '[[case]]\nname = "a"\nclearance = { bearing = -1 }', '[[case]]\nname = "a"\nclearance.bering = 0.1',
            "".join(f'[[case]]\nname = "{k}"\nclearance = {{ bearing = -{k + 1} }}\n' for k in range(many)),
            "".join(f'[[case]]\nname = "{k}"\ncrank = {{ eccentricity = {7 + k} }}\n' for k in range(many)),
        ]
    )  # fmt: skip
    head = f"{text}\n{BASE}" if text.startswith("case") else f"{BASE}\n{text}"
    return Malformed(about=f"case: {text[:50]}", content=head.encode())


def _tolerance(draw: random.Random) -> Malformed:
    good = '{ distribution = "normal", tolerance = 0.005 }'
    value = draw.choice([value for value in NO_QUANTITY if "\n" not in value])
    text = draw.choice(
        (
            "tolerances = 5", "tolerances = []", "[tolerances]\ncrank = 5", "[tolerances]\ncrank.eccentricity_error = 5",
            f"[tolerances]\ncrank.excentricity_error = {good}", f"[tolerances]\nname = {good}",
            f"[tolerances]\npin_wheel.number_of_pins = {good}", f"[tolerances]\ncrank.eccentricity_error.x = {good}",
            f'[tolerances]\ncrank.eccentricity_error = {{ distribution = "normal", tolerance = {value} }}',
            f'[tolerances]\ncrank.eccentricity_error = {{ distribution = "normal", tolerance = 0.1, mean = {value} }}',
            f'[tolerances]\ncrank.eccentricity_error = {{ distribution = "normal", tolerance = 0.1, cpk = {value} }}',
            f"[tolerances]\ncrank.eccentricity_error = {{ distribution = {value}, tolerance = 0.1 }}",
            '[tolerances]\ncrank.eccentricity_error = { distribution = "normal", tolerance = 0.1, cpx = 1.0 }',
            '[tolerances]\ncrank.eccentricity_error = { distribution = "normal" }',
        )
    )  # fmt: skip
    head = f"{text}\n{BASE}" if text.startswith("tolerances =") else f"{BASE}\n{text}"
    return Malformed(about=text[:90], content=head.encode())


def _array(draw: random.Random) -> Malformed:
    value = draw.choice(NO_QUANTITY)
    errors = draw.choice((f"[{value}]", value, f"[{', '.join(['0.0'] * 13)}, {value}]", "[[0.0]]", "[0.0]"))
    place = "pin_radius = 6.5 "
    if errors == "[]":
        errors = "[0.0, 0.0]"
    text = BASE.replace(place, f"pin_errors.radial = {errors}\n{place}", 1)
    return Malformed(about=f"pin_errors.radial = {errors[:50]}", content=text.encode())


def _width(draw: random.Random) -> Malformed:
    """Slices that are none, and leads and inclinations that are none or that no slices see."""
    value = draw.choice([value for value in NO_QUANTITY if "\n" not in value])
    slices = draw.choice((*NO_COUNT, "2", "4", "66", "67"))
    place, line = draw.choice(
        (
            ("[disc]", f"lead_slope = {value}"), ("[disc]", f"lead_crown_drop = {value}"), ("[disc]", "lead_slope = 1e-4"),
            ("[disc]", "lead_crown_drop = -1e-3"), ("[disc]", "lead_relief_depth = 1e-3"), ("[disc]", f"axial_play = {value}"),
            ("[pin_wheel]", f"inclination.x = {value}"), ("[pin_wheel]", "inclination = { z = 0.0 }"),
            ("[crank]", "inclination = 1e-4"), ("[crank]", 'inclination.y = "1 mrad"'), ("[pin_shaft]", "inclination.x = 0.5"),
            ("[pin_shaft]", f"pin_errors.inclination_x = [{value}]"), ("[disc]", "hole_errors.inclination_y = [1e-4]"),
            ("", f"[contact]\nslices = {slices}"),
        )
    )  # fmt: skip
    text = BASE.replace(f"{place}\n", f"{place}\n{line}\n", 1) if place else f"{BASE}\n{line}\n"
    return Malformed(about=f"{place} {line[:60]}", content=text.encode())


def _name(draw: random.Random) -> Malformed:
    name = draw.choice(NO_NAME)
    return Malformed(about=f"name = {name[:40]}", content=BASE.replace('name = "paper"', f"name = {name}", 1).encode())


DRIVES: tuple[Callable[[random.Random], Malformed], ...] = (
    _value, _value, _value, _value, _tiny, _misspelt, _left_out, _table_as_value, _deep, _bytes, _bytes, _cut, _noise, _case,
    _case, _tolerance, _array, _name, _width,
)  # fmt: skip

SOUND_STUDY = {
    "drive": '"paper"',
    "case": '"CS-3"',
    "positions": "28",
    "quantities": '["max_pin_load"]',
    "design": '{ kind = "grid" }',
    "factors": '{ "clearance.bearing" = [0.0, 0.01] }',
}
NO_FACTOR = [value for value in NO_QUANTITY if "\n" not in value]
WRONG_KEYS = {
    "drive": ["5", "true", "[]", '""', '"nowhere.toml"', '["paper"]', '"a\\u0000b"', "{}", '"/"', f'"{DIGITS}"'],
    "case": ['["CS-3"]', "5", "true", '"CS-9"', "[]", "{}", '""', "nan"],
    "positions": ["true", "0", "-1", "1e9", "nan", '"28"', "[28]", DIGITS, "28.0", "1000000000"],
    "quantities": ["5", "[]", '["max_pin_lod"]', "[5]", '"max_pin_load"', "{}", "[[]]", "true", '["\\u0000"]'],
    "design": [
        "5", "[]", '"grid"', '{ kind = "star" }', "{ kind = 5 }", "{ kind = [] }", '{ kind = "sobol" }', "{ color = 1 }",
        '{ kind = "sobol", samples = true }', '{ kind = "sobol", samples = 0 }', '{ kind = "sobol", samples = 1e9 }',
        f'{{ kind = "sobol", samples = {DIGITS} }}', '{ kind = "sobol", samples = 8, seed = nan }',
        '{ kind = "latin-hypercube", samples = "many" }', '{ kind = "sobol", samples = 8, seed = -1 }',
    ],
    "factors": [
        "5", "[]", "{}", '"clearance.bearing"', "{ case = 5 }", "{ case = [5] }", '{ case = [["CS-1"]] }', "{ case = [] }",
        '{ case = ["CS-9"] }', '{ "clearance.bering" = [0.0] }', '{ "load.direction" = ["left"] }', '{ "load.direction" = [1] }',
        '{ "pin_wheel.number_of_pins" = [nan] }', '{ "pin_wheel.number_of_pins" = [true] }', '{ "clearance.bearing" = [] }',
        '{ "clearance.bearing" = { low = 0.0, high = 0.1, levels = 1000000000 } }', '{ "pin_wheel.pin_errors.radial" = [0.0] }',
        '{ "clearance.bearing" = { low = 0.0, high = 0.1, levels = true } }', '{ "clearance.bearing" = { low = 0.0 } }',
        '{ "clearance.bearing" = { low = 0.0, high = 0.1, levels = 2.0 } }', '{ "pin_wheel.pin_errors.radial.14" = [0.0] }',
        '{ "clearance.bearing" = { low = 0.0, high = 0.1, scale = "log", levels = 3 } }', '{ "name" = ["a\\u0000b"] }',
        '{ "clearance.bearing" = { low = 0.0, high = 0.1, scale = "logarithmic", levels = 3 } }',
        '{ "clearance.bearing" = { low = 0.1, high = 0.0, levels = 3 } }', '{ "clearance.bearing" = { lo = 0, high = 1 } }',
        f'{{ "pin_wheel.pin_errors.radial.{DIGITS}" = [0.0] }}', '{ "clearance.bearing" = [{}] }', '{ "" = [1] }',
        *(f'{{ "clearance.bearing" = [{value}] }}' for value in NO_FACTOR),
        *(f'{{ "clearance.bearing" = {{ low = {value}, high = 1.0, levels = 2 }} }}' for value in NO_FACTOR),
        *(f'{{ "disc.number_of_discs" = [{value}] }}' for value in NO_COUNT),
    ],
}  # fmt: skip


def _study(changes: dict[str, str], about: str, *, wrong: bool = True) -> Malformed:
    table = SOUND_STUDY | changes
    text = "".join(f"{key} = {value}\n" for key, value in table.items() if value)
    return Malformed(about=about[:100], content=text.encode(), wrong=wrong)


def _study_key(draw: random.Random) -> Malformed:
    key = draw.choice([*WRONG_KEYS, "factors", "factors", "factors"])
    value = draw.choice(WRONG_KEYS[key])
    return _study({key: value}, f"{key} = {value}")


def _study_left_out(draw: random.Random) -> Malformed:
    key = draw.choice(("drive", "factors"))
    return _study({key: ""}, f"without {key}")


def _study_misspelt(draw: random.Random) -> Malformed:
    key = draw.choice(list(SOUND_STUDY))
    return _study({key: "", f"{key}x": SOUND_STUDY[key]}, f"{key} misspelt")


def _study_bytes(draw: random.Random) -> Malformed:
    content = bytearray(_study({}, "").content)
    for _ in range(draw.choice((1, 3, 10))):
        content[draw.randrange(len(content))] = draw.randrange(256)
    return Malformed(about="study, bytes changed", content=bytes(content), wrong=False)


def _study_structure(draw: random.Random) -> Malformed:
    if draw.random() < 0.5:
        return _deep(draw)
    return _noise(draw)


STUDIES: tuple[Callable[[random.Random], Malformed], ...] = (
    _study_key, _study_key, _study_key, _study_key, _study_key, _study_key, _study_left_out, _study_misspelt, _study_bytes,
    _study_structure,
)  # fmt: skip
