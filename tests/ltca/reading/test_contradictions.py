"""A contradiction names the field that is wrong; its bound follows from the checks by hand."""

from __future__ import annotations

import re

import numpy as np
import pytest
from refusals import error_says, refused_field

from ltca.errors import DriveError
from ltca.reading.contradictions import Cause
from ltca.reading.drive_file import build_drive, parse_drive, shipped_drive

BASE = shipped_drive().partition("[[case]]")[0]
# The root circle (radius R_C − e − r_P − Δr_P + ΔR_C = 77.44 mm) leaves 7.365 mm beside the holes (56 + 14.075 mm).
SMALLEST_PIN_CIRCLE = 88.0 - (77.44 - 56.0 - 14.075)
# A hole leads its pin: e ≤ r_PSH − r_PS ≤ 1.5 e; rollers: 0.9 space ≤ 2 r_BR ≤ space; at these bounds nothing overlaps.
WRONG = [
    ("pin_wheel", "pin_circle_radius", 8.8, "at least", SMALLEST_PIN_CIRCLE),
    ("pin_wheel", "pin_circle_radius", "88 µm", "at least", SMALLEST_PIN_CIRCLE),
    ("pin_wheel", "pin_circle_radius", 40.0, "at least", SMALLEST_PIN_CIRCLE),
    ("crank", "eccentricity", 40.0, "at most", 4.0),
    ("crank", "eccentricity", 0.4, "at least", 4.0 / 1.5),
    ("crank_bearing", "outer_race_radius", 290.5, "at most", 19.5 + 10.0 / 0.9),
    ("crank_bearing", "inner_race_radius", 1.95, "at least", 29.5 - 10.0 / 0.9),
    ("crank_bearing", "roller_radius", 50.0, "at most", 5.0),
    ("pin_shaft", "pin_circle_radius", 5.6, "at least", 29.5 + 14.075),
    ("pin_shaft", "hole_radius", 140.75, "at most", 10.075 + 6.0),
]


@pytest.mark.family(quick=1)
@pytest.mark.parametrize(
    ("part", "field", "value", "side", "bound"),
    [*WRONG[::3], *(pytest.param(*row, marks=pytest.mark.slow) for row in WRONG if row not in WRONG[::3])],
)
def test_the_field_that_was_spoilt_is_named_with_its_bound(part, field, value, side, bound, paper_table):
    """A pin circle too small read 'hole_radius must be less than −29.06'."""
    # Four digits are printed, rounded to the sound side.
    rounded = (side, pytest.approx(bound, rel=1.1e-3))
    said = (f"must be {side} ", " mm ", "for the rest of the drive: ")
    with refused_field(f"{part}.{field}", "", *said, bound=rounded, alone=True) as caught:
        build_drive(paper_table(**{part: {field: value}}))
    (problem,) = caught.value.problems
    printed = f"{problem.bound[1]:g}"
    assert f"must be {side} {printed} mm" in problem
    assert not re.search(r"-\d", problem)  # no length is bounded by less than nothing
    build_drive(paper_table(**{part: {field: float(printed)}}))


# In the file with its six cases, whose clearances differ. The root circle is at 77.59 mm less the offset, and the holes
# reach to 56 + 14.075 mm: 7.515 mm of it leave no wall. Interference ends where both offsets are alike.
ONE_LINE = {
    ("equidistant_offset = 0.15", "15", "disc.equidistant_offset"): ("at most", pytest.approx(7.515, abs=0.005)),
    ("shifting_offset = 0.09", "9", "disc.shifting_offset"): ("at most", pytest.approx(0.6499, abs=1e-6)),
    ("outer_race_radius = 29.5", "295", "crank_bearing.outer_race_radius"): (
        "at most",
        pytest.approx(30.615, abs=0.005),
    ),
    ("inner_race_radius = 19.5", "195", "crank_bearing.inner_race_radius"): ("at most", pytest.approx(19.5)),
    ("pin_circle_radius = 56.0", "66", "pin_shaft.pin_circle_radius"): (
        "less than",
        pytest.approx(63.365, abs=0.0005),
    ),
}


@pytest.mark.family(quick=1)
@pytest.mark.parametrize(
    ("old", "value", "path"),
    [*list(ONE_LINE)[:2], *(pytest.param(*row, marks=pytest.mark.slow) for row in list(ONE_LINE)[2:])],
)
def test_what_is_wrong_in_the_common_part_is_told_once_by_its_field(old, value, path):
    """An offset of 15 mm named the circle of the holes, four times; a race of 295 mm took seven lines."""
    text = shipped_drive()
    assert text.count(f"\n{old} ") == 1
    new = f"{old.partition(' = ')[0]} = {value}"
    with refused_field(path, f"= {value} mm", bound=ONE_LINE[old, value, path], alone=True):
        parse_drive(text.replace(f"\n{old} ", f"\n{new} "))


@pytest.mark.parametrize(
    ("part", "smaller", "larger"),
    [("crank_bearing", "inner_race_radius", "outer_race_radius"), ("pin_shaft", "pin_radius", "hole_radius")],
)
def test_swapped_fields_are_both_named(part, smaller, larger):
    """Races given the wrong way round read 'roller_radius must be at most −5 mm'."""
    head, mark, tail = shipped_drive().partition(f"[{part}]\n")
    text = (
        head
        + mark
        + tail.replace(f"{smaller} =", "@", 1).replace(f"{larger} =", f"{smaller} =", 1).replace("@", f"{larger} =", 1)
    )
    sound = getattr(parse_drive(shipped_drive()).cases["CS-1"], part)
    least, most = getattr(sound, smaller), getattr(sound, larger)
    said = f"must be less than {larger} = {least:g} mm; the two seem to be swapped"
    with refused_field(f"{part}.{smaller}", f"= {most:g} mm", said, bound=("less than", least), alone=True):
        parse_drive(text)


@pytest.mark.parametrize(
    "drive", ["paper", *(pytest.param(name, marks=pytest.mark.slow) for name in ("rv", "robot-joint"))]
)
@pytest.mark.parametrize(
    "offset", [pytest.param(-100.0, marks=pytest.mark.nightly), -60.0, pytest.param(-20.0, marks=pytest.mark.nightly)]
)
def test_a_shifting_offset_far_below_zero_is_named_itself(drive, offset):
    """It blamed the pin circle; of -60 mm the robot joint's generating circle is a point, which was a division by zero."""
    text = re.sub(r"(?m)^shifting_offset.*$", "", shipped_drive(drive))
    with pytest.raises(DriveError) as caught:
        parse_drive(text.replace("[disc]", f"[disc]\nshifting_offset = {offset}", 1))
    (told,) = caught.value.problems
    assert told.startswith(f"disc.shifting_offset = {offset:g} mm: must be at least -")
    bound = 0.95 * float(re.search(r"at least (\S+) mm", told).group(1))  # cases of the paper have wider holes
    parse_drive(text.replace("[disc]", f"[disc]\nshifting_offset = {bound}", 1))


@pytest.mark.slow
def test_a_case_that_is_wrong_in_another_way_is_told_beside(paper_table):
    """What one field of the common part mends is told once, what it does not mend stays with its case."""
    text = shipped_drive().replace("\nshifting_offset = 0.09 ", "\nshifting_offset = 9 ").partition("[[case]]")[0]
    text += '[[case]]\nname = "A"\n[[case]]\nname = "B"\nclearance = { pin_hole = 3.0 }\n'
    with pytest.raises(DriveError) as caught:
        parse_drive(text)
    first, *others = caught.value.problems
    assert first.startswith("case A: disc.shifting_offset = 9 mm: must be at most 0.6499 mm")
    assert others
    assert all(problem.startswith("case B: ") for problem in others)


def test_a_count_that_was_spoilt_is_named(paper_table):
    with refused_field(
        "pin_shaft.number_of_pins", "= 18", "for the rest of the drive", bound=("at most", 12), alone=True
    ):
        build_drive(paper_table(pin_shaft={"number_of_pins": 18}))


def test_two_spoilt_fields_keep_their_own_sentences(paper_table):
    """No single field mends it: each contradiction is told, and none with a negative bound."""
    spoilt = {"pin_wheel": {"pin_circle_radius": 8.8}, "crank_bearing": {"number_of_rollers": 400}}
    with pytest.raises(DriveError) as caught:
        build_drive(paper_table(**spoilt))
    assert len(caught.value.problems) > 1
    assert not re.search(r"(than|most) -\d", str(caught.value))


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("pin_radius = 6.5", "pin_wheel.pin_radus: is not a field; did you mean `pin_radius`, which is missing?"),
        ('direction = "ccw"', "load.direction = 'CCW': must be 'ccw' or 'cw'; did you mean `ccw`?"),
        ("[clearance]", "clearence: is not a field of the drive definition; did you mean `clearance`?"),
        (
            '"100Cr6", youngs_modulus',
            "materials.disc.yongs_modulus: is not a field of the drive definition; did you mean",
        ),
        (
            "crank.eccentricity_error =",
            "tolerances.crank.excentricity_error: is not a field of the drive that can scatter; did",
        ),
        ('distribution = "normal"', "crank.eccentricity_error.distribution = 'normel': must be 'normal', 'uniform' or"),
    ],
)
def test_what_was_meant_is_asked(text, told):
    wrong = {
        "pin_radius = 6.5": "pin_radus = 6.5", 'direction = "ccw"': 'direction = "CCW"', "[clearance]": "[clearence]",
        '"100Cr6", youngs_modulus': '"100Cr6", yongs_modulus', "crank.eccentricity_error =": "crank.excentricity_error =",
        'distribution = "normal"': 'distribution = "normel"',
    }[text]  # fmt: skip
    assert text in BASE
    with pytest.raises(DriveError) as caught:
        parse_drive(BASE.replace(text, wrong, 1))
    assert len(caught.value.problems) == 1
    assert told in str(caught.value)


def test_a_mistake_of_several_cases_is_told_once_with_their_names():
    cases = "".join(f'[[case]]\nname = "{name}"\nclearance = {{ pin_hole = 3.0 }}\n' for name in "AB")
    sound = '[[case]]\nname = "C"\n'
    with pytest.raises(DriveError) as caught:
        parse_drive(BASE + cases + sound)
    assert caught.value.problems == (
        "cases A, B: clearance.pin_hole = 3 mm: must be at most 2 mm, half the eccentricity",
    )
    with pytest.raises(DriveError) as caught:
        parse_drive(BASE + (cases + sound).replace("pin_hole = 3.0", "pin_hole = -1"))
    assert caught.value.problems == ("cases A, B: clearance.pin_hole = -1: must be at least 0 mm",)


def test_a_case_overrides_parts_and_keeps_the_rest():
    """Parts that a case leaves alone are taken over from the base, whole."""
    text = (
        BASE + '[[case]]\nname = "A"\ndisc = { number_of_discs = 2 }\nmaterials = { disc = { poisson_ratio = 0.25 } }\n'
    )
    base, changed = parse_drive(BASE).cases["nominal"], parse_drive(text).cases["A"]
    assert changed.disc.number_of_discs == 2
    assert changed.disc.thickness == base.disc.thickness
    assert changed.materials.disc.poisson_ratio == 0.25
    assert changed.materials.disc.youngs_modulus == base.materials.disc.youngs_modulus
    assert (changed.crank, changed.pin_wheel, changed.load) == (base.crank, base.pin_wheel, base.load)


@pytest.mark.parametrize(
    ("content", "told"),
    [
        ("x = " + "[" * 5000 + "]" * 5000, "more than 20 deep"),
        ("a." * 5000 + "a = 1", "more than 20 deep"),
        ("x = " + "{a=" * 1001 + "1" + "}" * 1001, "more than 20 deep"),
        ("x = " + "7" * 5000, "a whole number has thousands of digits"),
        ("x = ", "is not valid TOML"),
    ],
)
def test_texts_that_broke_the_parser(content, told):
    with error_says(DriveError, told):
        parse_drive(f"{content}\n{BASE}")


def test_names_that_can_and_cannot_be():
    for name in ("a$x_{b$", "<!--<script>", "it's", "中文", "a" * 120):
        assert list(parse_drive(f"{BASE}\n[[case]]\nname = '''{name}'''").cases) == [name]
    for name in (
        r"a\u0000b",
        r"a\nb",
        r"a\u001b[31m",
        r"a\u007f",
        r"a\u202eb",
        r"a\u2028b",
        "a/b",
        "..",
        " ",
        "a" * 121,
    ):
        with pytest.raises(DriveError, match="can name a file"):
            parse_drive(f'{BASE}\n[[case]]\nname = "{name}"')
        with pytest.raises(DriveError, match="can name a file"):
            parse_drive(BASE.replace('name = "paper"', f'name = "{name}"', 1))


@pytest.mark.parametrize("value", ["true", '"14 mm"', "14.5", "nan", "[]"])
def test_no_count_is_no_count(value):
    """True was one disc."""
    with refused_field("disc.number_of_discs", "", "must be a whole number"):
        parse_drive(BASE.replace("number_of_discs = 1", f"number_of_discs = {value}"))
    two = parse_drive(BASE.replace("number_of_discs = 1", "number_of_discs = 2.0")).cases["nominal"]
    assert two.disc.number_of_discs == 2


def test_a_bound_of_half_the_value_is_as_far_as_one_of_twice():
    """Bounds are compared by ratios, of lengths of any size."""
    for value in (0.25, 4.0, 60.0):
        for bound in (0.5 * value, 2.0 * value):
            assert Cause(path="crank.eccentricity", value=value, bound=bound).distance == pytest.approx(np.log(2.0))
