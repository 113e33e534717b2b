"""Seats and beams of pins: what goes together, one clear line for what does not, also at the bound itself."""

from __future__ import annotations

from math import radians, sin

import pytest
from refusals import refused_field

from ltca.commands.program import main
from ltca.drive.engine_support import require
from ltca.drive.materials import MAY_BE_UNKNOWN
from ltca.drive.tolerances import Factors, parse_tolerances
from ltca.errors import DriveError
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive, parse_drive, shipped_drive
from ltca.reading.writing import drive_text

SHAFT_BEAM = 'beam = { span = 24.0, tip = "tied-clamped" }'
# Of the shipped drive: z_P = 30 on R_C = 70, r_P = 3.5 in slots of 3.51; sleeves of 6 on pins of 4.5 with bores of 4.51;
# e = 1.5; two discs of 10 mm at −6 and 6 mm, between −11 and 11 mm.
FIXED = {
    "pin_wheel.seat.kind": "fixed",
    "pin_wheel.seat.radius": None,
    "materials.wheel_seat.youngs_modulus": 206_000.0,
}
FIXED |= {"materials.wheel_seat.poisson_ratio": 0.3}
FIXED |= {f"materials.wheel_seat.{name}": None for name in MAY_BE_UNKNOWN}
SLEEVES = FIXED | {
    "pin_wheel.seat.kind": "sleeve",
    "pin_wheel.seat.pin_radius": 2.5,
    "pin_wheel.seat.bore_radius": 2.52,
}
BEAMS = {"pin_shaft.stiffness": None, "pin_shaft.beam.span": 30.0, "pin_shaft.beam.tip": "free"}


@pytest.fixture(scope="module")
def sleeved():
    """The shipped drive on springs, which beams may take the place of."""
    text = shipped_drive("sleeved").replace(SHAFT_BEAM, "stiffness = 2.0e5")
    return parse_drive(text, "sleeved").cases["nominal"]


def test_neighbouring_slots_may_not_overlap(sleeved):
    """By the chord: 2 R sin(π/z) between neighbouring slots."""
    many = {"pin_wheel.number_of_pins": 45, "disc.number_of_teeth": 44, "pin_shaft.number_of_pins": 11}
    dense = with_fields(sleeved, many | {"crank.eccentricity": 1.2, "pin_shaft.hole_radius": 7.2})
    # 70 sin(4°) = 4.88295
    with_fields(dense, {"pin_wheel.pin_radius": 3.9, "pin_wheel.seat.radius": 4.88})
    with refused_field(
        "pin_wheel.seat.radius",
        "= 4.89 mm",
        "neighbouring",
        bound=("less than", pytest.approx(70.0 * sin(radians(4.0)))),
    ):
        with_fields(dense, {"pin_wheel.pin_radius": 3.9, "pin_wheel.seat.radius": 4.89})


SOUND = [
    {},
    SLEEVES,
    FIXED,
    BEAMS,
    SLEEVES | {"pin_wheel.beam.ends": "clamped", "pin_wheel.beam.diameter": 4.0} | BEAMS | {"pin_shaft.beam.tip": "tied-pinned"},
    {"pin_wheel.beam.span": 22.0, "pin_wheel.beam.diameter": 7.0},
    BEAMS | {"pin_shaft.beam.span": 22.0, "pin_shaft.beam.diameter": 9.02},
    # as tight as exact, as loose as the bound
    {"pin_wheel.seat.radius": 3.500_01, "pin_shaft.seat.bore_radius": 4.500_01},
    {"pin_wheel.seat.radius": 5.0, "pin_shaft.seat.bore_radius": 5.25},
    {"pin_wheel.pin_errors.diameter": (0.019,) + (-0.019,) * 29},
    # the play of the sleeves is all that the holes have
    {"pin_shaft.hole_radius": 7.49, "clearance.pin_hole": 0.0, "clearance.bearing": 0.0},
    # printed: soft, without offsets, with a play as of paper
    {f"materials.{part}.youngs_modulus": 2400.0 for part in ("disc", "wheel_pin", "wheel_seat", "sleeve", "shaft_pin")}
    | {"disc.equidistant_offset": 0.0, "disc.shifting_offset": 0.0, "pin_wheel.seat.radius": 3.7, "load.torque": 5000.0},
]  # fmt: skip


@pytest.mark.parametrize("words", SOUND, ids=range(len(SOUND)))
def test_sound_drives_are_taken_and_written_as_they_are(sleeved, words):
    drive = with_fields(sleeved, words)
    assert parse_drive(drive_text(drive)).cases["nominal"] == drive


def test_play_and_effective_radius(sleeved):
    assert sleeved.pin_wheel.seat_play == pytest.approx(0.01, rel=1e-12)
    assert sleeved.pin_shaft.seat_play == pytest.approx(0.01, rel=1e-12)
    drive = with_fields(sleeved, SLEEVES)
    assert drive.pin_wheel.seat_play == pytest.approx(0.02, rel=1e-12)
    assert (drive.pin_wheel.beam_diameter, sleeved.pin_wheel.beam_diameter) == (5.0, 7.0)
    assert (drive.flank_pin, drive.hole_pin) == (drive.materials.sleeve, drive.materials.sleeve)
    assert sleeved.flank_pin is sleeved.materials.wheel_pin


def test_the_alternatives_in_the_shipped_file_are_sound():
    """What stands behind # in the file can be uncommented, in the place of what it is an alternative to."""
    text = shipped_drive("sleeved")
    for old, new in (
        ('seat = { kind = "slot", radius = 3.51 }\n', ""),
        ("# seat = { kind", "seat = { kind"),
        ("wheel_seat = ", "# wheel_seat = "),
        (SHAFT_BEAM, ""),
        ("# stiffness = 2.63e5", "stiffness = 2.63e5"),
        ("pin_wheel.seat.radius = { d", "pin_wheel.seat.bore_radius = { d"),
    ):
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    drive = parse_drive(text).cases["nominal"]
    assert (drive.pin_wheel.seat.kind, drive.pin_shaft.beam, drive.pin_shaft.stiffness) == ("sleeve", None, 2.63e5)


def test_a_pin_typed_too_large_is_named_itself(sleeved):
    """Its slot, the flank and the pins beside it suffer all: the pin is what alone mends them."""
    text = shipped_drive("sleeved").replace("pin_radius = 3.5  ", "pin_radius = 35.0")
    with pytest.raises(DriveError) as caught:
        parse_drive(text)
    (problem,) = caught.value.problems
    told = "pin_wheel.pin_radius = 35 mm: must be at most 3.509 mm for the rest of the drive: the pin has no play in its slot"
    assert problem == told


def test_every_number_can_scatter(sleeved):
    """By the value of the field, or where it is left out by what follows from others."""
    fields = {
        "pin_wheel.seat.radius": 3.51,
        "pin_wheel.beam.span": 26.0,
        "pin_wheel.beam.diameter": 7.0,
        "pin_shaft.seat.pin_radius": 4.5,
        "pin_shaft.seat.bore_radius": 4.51,
        "pin_shaft.beam.span": 30.0,
        "pin_shaft.beam.diameter": 9.0,
        "materials.wheel_seat.youngs_modulus": 169_000.0,
        "materials.sleeve.poisson_ratio": 0.3,
    }
    problems = []
    table = {name: {"distribution": "uniform", "tolerance": 0.001} for name in fields}
    tolerances = parse_tolerances(table, problems)
    assert not problems
    factors = Factors.of_tolerances(with_fields(sleeved, BEAMS), tolerances)
    assert dict(zip(factors.paths, factors.centres, strict=True)) == fields
    with refused_field("tolerances.pin_shaft.beam.span", "", "there is no pin_shaft.beam in this drive"):
        Factors.of_tolerances(sleeved, tolerances)
    with refused_field("tolerances.pin_wheel.seat.bore_radius", "", "is left out in this drive"):
        Factors.of_tolerances(sleeved, {"pin_wheel.seat.bore_radius": tolerances["pin_wheel.seat.radius"]})
    parse_tolerances({"pin_wheel.seat.kind": table["pin_wheel.seat.radius"]}, problems)
    (problem,) = problems
    assert problem.startswith("tolerances.pin_wheel.seat.kind: is not a field of the drive that can scatter")


def test_a_model_of_fixed_pins_names_the_fields(sleeved):
    require(load_drive("paper").cases["CS-1"], "direct")
    with pytest.raises(DriveError) as caught:
        require(with_fields(sleeved, BEAMS), "direct")
    told = caught.value.problems
    starts = ("pin_wheel.seat (", "pin_wheel.beam (", "pin_shaft.seat (", "pin_shaft.beam (")
    assert len(told) == 4
    assert all(problem.startswith(start) for problem, start in zip(told, starts, strict=True))
    assert "pin_wheel.seat.radius" in told[0]
    assert "pin_shaft.beam.tip" in told[3]


@pytest.mark.parametrize(
    "words",
    [
        ["run", "--method", "direct", "--positions", "2"],
        ["run", "--method", "paper", "--positions", "2"],
        ["fem", "--angle", "0.5"],
        ["mesh", "--angle", "0.5"],
        ["validate", "--level", "quick"],
    ],
    ids=" ".join,
)
def test_commands_refuse_by_name_with_status_2(words, tmp_path, capsys):
    path = tmp_path / "sleeved.toml"
    path.write_text(shipped_drive("sleeved"), encoding="utf-8")
    assert main([words[0], str(path), *words[1:], "--out", str(tmp_path / "out")]) == 2
    told = capsys.readouterr().err
    assert "pin_wheel.seat" in told
    assert ("pin_wheel.beam" in told) is (words[0] == "run")  # full finite elements bend pins
    assert "pin_shaft.seat" in told
