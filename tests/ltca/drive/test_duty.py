"""``[[duty]]`` and ``[lubricant]`` of a drive file: read, written, changed, refused by name."""

from __future__ import annotations

import pytest
from refusals import error_says, refused_field

from ltca.drive.fields import absence, field_kind, read_field
from ltca.drive.parts import Duty, Lubricant
from ltca.drive.single_discs import single_discs
from ltca.errors import DriveError
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import parse_drive, shipped_drive
from ltca.reading.physical_checks import find_contradictions, is_sound
from ltca.reading.writing import drive_text

TABLES = """
[[duty]]
torque = "400 N m"
speed = "1500 rpm"
share = "30 %"

[[duty]]
torque = 200000.0
speed = 3000
share = 0.7

[lubricant]
viscosity = "46 cSt"
contamination = 0.5
"""
PLAIN = shipped_drive("robot-joint").partition("\n[tolerances]")[0]


def drive_of(text):
    return parse_drive(text, "mine").cases["nominal"]


def test_read_written_and_read_again():
    drive = drive_of(PLAIN + TABLES)
    assert drive.duty == (Duty(torque=4e5, speed=1500.0, share=0.3), Duty(torque=2e5, speed=3000.0, share=0.7))
    assert drive.lubricant == Lubricant(viscosity=46.0, contamination=0.5)
    assert drive_of(drive_text(drive)) == drive
    assert is_sound(drive)


def test_fingerprints_know_them_and_those_without_stay():
    """What is left out enters no hash; duty changes no body."""
    drive, plain = drive_of(PLAIN + TABLES), drive_of(PLAIN)
    assert drive.fingerprint() != plain.fingerprint()
    assert single_discs(drive)[0].shape_fingerprint() == single_discs(plain)[0].shape_fingerprint()
    assert plain.duty == ()
    assert plain.lubricant is None


@pytest.mark.parametrize(
    ("old", "new", "path", "value", "said"),
    [
        ("share = 0.7", "share = 0.70001", "duty", "", "must add up to 1, they add up to 1.00001"),
        ("share = 0.7", "", "duty.1.share", "", "is missing"),
        ("speed = 3000", "speed = 0", "duty.1.speed", "= 0", "must be greater than 0 rpm"),
        ("torque = 200000.0", "torque = -1.0", "duty.1.torque", "= -1.0", "must be"),
        ("0.5\n", "1.5\n", "lubricant.contamination", "= 1.5", "must be at least 0 and at most 1"),
        ("46 cSt", "46 Pa s", "lubricant.viscosity", "= '46 Pa s'", "mm²/s"),
        ("viscosity", "viscosities", "lubricant.viscosities", "", "is not a field"),
    ],
)
def test_mistakes_are_named(old, new, path, value, said):
    assert old in TABLES
    with refused_field(path, value, said):
        drive_of(PLAIN + TABLES.replace(old, new))


@pytest.mark.parametrize(
    ("new", "said"),
    [
        ("share = 0.6", "duty.0.share = 0.3, duty.1.share = 0.6: must add up to 1, they add up to 0.9"),
        ("shares = 0.7", "duty.1.shares: is not a field; did you mean `share`"),
    ],
)
def test_mistakes_of_shares_are_one_sentence(new, said):
    with error_says(DriveError, said):
        drive_of(PLAIN + TABLES.replace("share = 0.7", new))


def test_a_table_in_the_place_of_tables():
    with refused_field("duty", "", "must be an array of tables, written [[duty]]"):
        drive_of(PLAIN + "\n[duty]\ntorque = 1.0\nspeed = 1.0\nshare = 1.0\n")


def test_shares_of_thirds_add_up_within_round_off():
    entry = "\n[[duty]]\ntorque = 1000.0\nspeed = 10.0\nshare = {}\n"
    assert len(drive_of(PLAIN + "".join(entry.format(share) for share in (0.1, 0.2, 0.7))).duty) == 3
    assert len(drive_of(PLAIN + entry.format(1 / 3) * 3).duty) == 3


def test_a_lubricant_without_a_speed_is_refused():
    oil = "\n[lubricant]\nviscosity = 46.0\ncontamination = 0.5\n"
    with refused_field("lubricant.viscosity", "= 46 mm²/s", "needs a speed, load.speed or those of"):
        drive_of(PLAIN + oil)
    drive = drive_of(PLAIN.replace("[load]", "[load]\nspeed = 1500.0") + oil)
    assert not find_contradictions(drive)


def test_fields_by_their_paths():
    drive = drive_of(PLAIN + TABLES)
    assert field_kind("duty.1.torque").unit == "N*mm"
    assert field_kind("duty.N.torque") is None
    assert read_field(drive, "duty.1.share") == 0.7
    assert absence(drive, "duty.1.speed") is None
    assert absence(drive, "duty.2.speed") == "there is no entry 2; [[duty]] has 2, counted from 0"
    faster = with_fields(drive, {"duty.1.speed": 2000.0, "lubricant.viscosity": 32.0})
    assert (faster.duty[1].speed, faster.duty[0], faster.lubricant.viscosity) == (2000.0, drive.duty[0], 32.0)
    with refused_field("duty.2", "", "there is no entry 2"):
        with_fields(drive, {"duty.2.speed": 2000.0})
    with refused_field("duty.2.torque", "= -1.0"):
        with_fields(drive, {"duty.2.speed": 1.0, "duty.2.torque": -1.0, "duty.2.share": 0.1})
    with refused_field("duty.0.shar", "", "did you mean `duty.N.share`? N of duty.N is the entry"):
        with_fields(drive, {"duty.0.shar": 0.5})


def test_an_entry_is_added_whole():
    drive = drive_of(PLAIN)
    added = with_fields(drive, {"duty.0.speed": 1.0, "duty.0.torque": 1.0, "duty.0.share": 1.0})
    assert added.duty == (Duty(torque=1.0, speed=1.0, share=1.0),)
    with refused_field("duty.0", "", "there is no entry 0"):
        with_fields(drive, {"duty.0.speed": 1.0, "duty.0.share": 1.0})


def test_a_case_may_have_its_own_duty():
    own = '\n[[case]]\nname = "light"\nduty = [{ torque = 1000.0, speed = 100.0, share = 1.0 }]\n[[case]]\nname = "as it is"\n'
    cases = parse_drive(PLAIN + TABLES + own, "mine").cases
    assert [len(case.duty) for case in cases.values()] == [1, 2]
