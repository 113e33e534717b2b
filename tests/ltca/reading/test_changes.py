"""`drive.with_fields`: a changed drive is that of a drive file with the same words, and wrong names are refused by name."""

from __future__ import annotations

import pickle

import pytest
from refusals import error_says, refused_field

from ltca.drive.members.temperatures import warm_drive
from ltca.drive.single_discs import single_discs
from ltca.errors import DriveError
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive, parse_drive, shipped_drive

PAPER = load_drive("paper").cases["CS-3"]


def from_file(name, text):
    """The first case of a shipped drive, whose file has a further case with `text`."""
    first = next(iter(load_drive(name).cases))
    given = shipped_drive(name)
    common, _, cases = given.partition("[[case]]")
    own = cases.partition("[[case]]")[0].replace(f'name = "{first}"', "") if cases else ""
    return parse_drive(f'{common}\n[[case]]\nname = "changed"\n{own}\n{text}\n', name).cases["changed"]


@pytest.mark.parametrize(
    ("name", "text", "changes"),
    [
        ("paper", 'pin_wheel.pin_radius = "5.95 mm"', {"pin_wheel.pin_radius": "5.95 mm"}),
        ("paper", 'crank.axis_offset = { x = "10 µm", y = 0.02 }', {"crank": {"axis_offset": {"x": 0.01, "y": 0.02}}}),
        ("paper", 'materials.disc = "PA12"', {"materials": {"disc": "PA12"}}),
        ("paper", 'materials.disc = { like = "PA12", youngs_modulus = 1500 }',
         {"materials.disc.like": "PA12", "materials.disc.youngs_modulus": "1.5 GPa"}),
        ("paper", 'pin_shaft.beam = { span = 30, tip = "free" }',
         {"pin_shaft.beam.span": 30, "pin_shaft.beam.tip": "free"}),
        ("paper", '[case.temperature]\ndisc = "60 °C"', {"temperature.disc": "60 °C"}),
        ("paper", "pin_wheel.pin_errors.radial = [0, 0, 0, 0.01, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]",
         {"pin_wheel.pin_errors.radial.3": "10 µm"}),
        ("sleeved", 'pin_shaft.stiffness = "500 N/µm"', {"pin_shaft": {"stiffness": 5e5}}),
        ("robot-joint", "disc.of = [{}, { runout = { amount = 0.005 } }]",
         {"disc.of.1.runout.amount": "5 µm"}),
        ("rv", 'load.torque = "700 N m"', {"load.torque": "700 N·m"}),
    ],
)  # fmt: skip
def test_a_changed_drive_is_that_of_a_file_with_the_same_words(name, text, changes):
    """Fingerprints, of the whole and of the bodies, go with it: coefficients are found by the latter."""
    told = from_file(name, text)
    drive = next(iter(load_drive(name).cases.values()))
    before = pickle.dumps(drive)
    changed = drive.with_fields(changes)
    assert changed == told
    assert changed.case == drive.case
    assert changed.fingerprint() == told.fingerprint() != drive.fingerprint()
    shapes = [[disc.shape_fingerprint() for disc in single_discs(warm_drive(one))] for one in (changed, told)]
    assert shapes[0] == shapes[1]
    assert pickle.dumps(drive) == before


def test_bodies_that_stay_keep_the_key_of_their_coefficients():
    """What changes no plane body (load, clearances of holes aside) finds the coefficients of before; a radius does not."""
    shape = PAPER.shape_fingerprint()
    assert PAPER.with_fields({"load.torque": "100 N·m"}).shape_fingerprint() == shape
    assert PAPER.with_fields({"pin_wheel.pin_radius": "5.95 mm"}).shape_fingerprint() != shape


def test_warmth_is_that_of_the_changed_drive():
    """A change of a drive with temperatures is one at 20 °C: twice the expansion moves its lengths twice as far."""
    warm = {"temperature.disc": "60 °C", "materials.disc.thermal_expansion": 1e-5}
    grown = [
        warm_drive(PAPER.with_fields(warm | {"materials.disc.thermal_expansion": part * 1e-5})).disc.thickness
        - PAPER.disc.thickness
        for part in (1.0, 2.0)
    ]
    assert grown[0] == pytest.approx(PAPER.disc.thickness * 1e-5 * 40.0, rel=1e-9)  # rounding of a difference
    assert grown[1] == pytest.approx(2.0 * grown[0], rel=1e-9)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"pin_wheel.pin_radiu": 5}, "pin_wheel.pin_radiu: is not a field of …; did you mean `pin_wheel.pin_radius`"),
        ({"pin_wheel": {"pin_radiu": 5}}, "pin_wheel.pin_radiu: is not a field"),
        ({"pin_wheel.pin_radius": "5 N"}, "pin_wheel.pin_radius = '5 N': must have the unit mm"),
        ({"pin_wheel.pin_radius": -1}, "pin_wheel.pin_radius = -1: must be greater than 0 mm"),
        ({"pin_wheel.pin_radius": 90}, "pin"),
        ({"pin_wheel": 5}, "pin_wheel: is a table; name its fields, as `pin_wheel.number_of_pins`"),
        ({"load": {}}, "load: is a table; name its fields"),
        ({"nothing": {}}, "nothing: is not a field"),
        ({"limits.max_pin_pressure_mid": 1500}, "limits.max_pin_pressure_mid: is not a field"),
        ({"case": "other"}, "case: is not a field"),
        ({"load.torque": 1e5, "load": {"torque": 2e5}}, "load.torque: is given twice"),
        ({"materials.disc": "unobtainium"}, "materials.disc = 'unobtainium': is no named material"),
        ({"pin_shaft.beam.diameter": 10}, "there is no pin_shaft.beam in this drive; to add it, give pin_shaft.beam.tip, too"),
        ({"pin_shaft.beam.span": 30, "pin_shaft.beam.tip": "free", "pin_shaft.stiffness": 1e5},
         "pin_shaft.stiffness = 100000 N/mm: must be left out beside pin_shaft.beam"),
        ({3: 5}, "must be values by the names of their fields"),
        (None, "must be values by the names of their fields"),
        ("load.torque", "must be values by the names of their fields"),
    ],
)  # fmt: skip
def test_what_is_no_change_is_refused_by_name(changes, message):
    with error_says(DriveError, *message.split("…")):
        PAPER.with_fields(changes)


def test_all_mistakes_together():
    with pytest.raises(DriveError) as caught:
        PAPER.with_fields({"pin_wheel.pin_radius": -1, "load.direction": "up"})
    assert len(caught.value.problems) == 2


def test_no_change_is_the_drive_itself():
    assert PAPER.with_fields({}) == PAPER == with_fields(PAPER, {})


def test_a_sweep_of_the_eccentricity_blamed_the_pin_radius_for_an_undercut(paper_cases):
    """Between undercut and loops the holes had to change as well, and the message named the sound pin radius alone."""
    drive = paper_cases["CS-1"]
    # Undercut at the smallest radius of the path, loops at R/z_P = 6.286 mm.
    with pytest.raises(DriveError) as caught:
        with_fields(drive, {"crank.eccentricity": 6.2})
    flank, holes = caught.value.problems
    assert flank.startswith(
        "crank.eccentricity = 6.2 mm: must be at most 6.117 mm (with pin_shaft.hole_radius = 16.192 mm)"
    )
    assert "or the flank is undercut; there the flank comes to an edge, " in flank
    assert holes.startswith("crank.eccentricity = 6.2 mm: must be at most 4 mm")
    with_fields(drive, {"crank.eccentricity": 6.117, "pin_shaft.hole_radius": 16.192})


@pytest.mark.parametrize(
    ("path", "value"),
    [
        ("disc.equidistant_offset", 9.75),
        ("disc.shifting_offset", -8.8),
        ("pin_wheel.pin_circle_radius", 79.2),
        ("crank_bearing.outer_race_radius", 35.4),
    ],
)
def test_the_only_changed_field_was_not_named_where_it_broke_the_rule_of_another(paper_cases, path, value):
    """A sweep of an offset blamed the circle of the shaft pins, which nobody had changed."""
    drive = paper_cases["CS-1"]
    with refused_field(path, f"= {value:g} mm", "must be at ", alone=True) as caught:
        with_fields(drive, {path: value})
    relation, bound = caught.value.problems[0].bound
    assert relation in ("at most", "at least")
    with_fields(drive, {path: bound})
    with pytest.raises(DriveError):
        with_fields(drive, {path: bound + 0.01 * (value - bound)})
