"""Springs that the beams of shaft pins are equal to, for full finite elements and contact grids, which do not bend pins."""

from __future__ import annotations

import re
from math import pi
from pathlib import Path

import numpy as np
import pytest
from refusals import refused_field

from ltca.analysis.loaded_analysis import analyse
from ltca.drive.engine_support import require
from ltca.drive.pin_beams import _energy_beside, _wind_up, shaft_pin_spring
from ltca.geometry.placement import position_angles
from ltca.page.derived import derived_rows
from ltca.reading.drive_file import load_drive, parse_drive

ROOT = Path(__file__).parents[3]
JOINT = load_drive("robot-joint").cases["nominal"]
TIED = {"pin_shaft.beam.tip": "tied-clamped"}


def test_a_free_pin_of_one_disc_is_a_cantilever(vary):
    """a³/3EI and a/κGA for a disc in the middle of a span of 400 mm that is ever so thin: κ = 6(1 + ν)/(7 + 6ν) (Cowper)."""
    drive = vary(
        disc={"thickness": 0.2}, crank_bearing={"roller_length": 0.2}, load={"torque": 100.0, "light_torque": 10.0}
    )
    beam = {"pin_shaft.beam": {"tip": "free", "span": 400.0}}
    spring = shaft_pin_spring(drive.with_fields(beam))
    diameter, modulus, nu, arm = 2.0 * 10.075, 206000.0, 0.3, 200.0
    bending = arm**3 / (3.0 * modulus * pi * diameter**4 / 64.0)
    shear = arm / (6.0 * (1.0 + nu) / (7.0 + 6.0 * nu) * modulus / (2.0 * (1.0 + nu)) * pi * diameter**2 / 4.0)
    assert spring.loaded_alike == pytest.approx(1.0 / (bending + shear), rel=1e-5)
    assert spring.turned_alike == pytest.approx(spring.loaded_alike, rel=1e-12)
    assert spring.stiffness == pytest.approx(spring.loaded_alike, rel=0.005)  # three digits
    assert (spring.error, spring.accuracy) == (0.0, "")


@pytest.mark.parametrize("phases", [(0.0, pi), (0.0, 2.0), (0.0, 0.5 * pi)])
def test_tied_pins_of_two_discs_yield_as_statics_pin_by_pin_say(phases):
    """Slender pins between two clamps by handbook formulas, and a ring with three degrees of freedom, at 200 crank angles."""
    span, diameter, modulus, pins, circle = 100.0, 1.0, 206000.0, 8, 38.0
    drive = JOINT.with_fields(
        TIED
        | {"pin_shaft.beam.span": span, "pin_shaft.beam.diameter": diameter, "disc.planes": (-20.0, 10.0)}
        | {"disc.phases": phases, "disc.thickness": 1.0}
    )
    rigidity = modulus * pi * diameter**4 / 64.0
    arm = np.array([30.0, 60.0])
    share = arm**2 * (3.0 * span - 2.0 * arm) / span**3
    tip = 12.0 * rigidity / span**3
    own = np.empty((2, 2))
    for row, place in enumerate(arm):
        for column, force in enumerate(arm):
            near, far = min(place, force), span - max(place, force)  # the other formula by Maxwell
            right = span - far
            own[row, column] = (
                near**2 * far**2 * (3.0 * right * (span) - near * (3.0 * right + far)) / (6.0 * rigidity * span**3)
            )
    around = 2.0 * pi * np.arange(pins) / pins
    place = circle * np.exp(1j * around)
    energies = np.zeros((2, 2))
    angles = 2.0 * pi * np.arange(200) / 200
    for crank in angles:
        way = np.exp(1j * (crank + np.array(phases)))
        force = np.stack([np.maximum(0.0, np.sin(around - crank - phase)) for phase in phases]) * way[:, None]
        # Tips at rest, then the ring lets go: three equations of a floating rigid body on z springs across.
        onto = share[:, None] * force
        for first in (0, 1):
            for second in (0, 1):
                bent = own[first, second] * np.sum((force[first].conj() * force[second]).real)
                resultant = [np.array([f.sum().real, f.sum().imag, (place.conj() * f).imag.sum()]) for f in onto]
                stiffness = tip * np.diag([pins, pins, pins * circle**2])
                moved = resultant[first] @ np.linalg.solve(stiffness, resultant[second])
                energies[first, second] += (bent + moved) / angles.size
    spring = shaft_pin_spring(drive)
    # A spring k has Σ f²/k = z/4k by disc; shear of pins of 1 mm by 100 mm, and the width of 1 mm, are 1e-4 of the bending.
    assert 2.0 * pins / 4.0 / spring.loaded_alike == pytest.approx(energies.sum(), rel=2e-3)
    together = np.linalg.solve(energies, np.ones(2))
    pressed = together.sum() if np.all(together > 0.0) else 1.0 / energies.diagonal().min()
    assert 0.25 * pins / 2.0 * pressed == pytest.approx(spring.turned_alike, rel=2e-3)
    assert spring.loaded_alike <= spring.turned_alike


@pytest.mark.slow
@pytest.mark.parametrize("name", ["robot-joint", "sleeved"])
def test_the_spring_turns_the_output_as_far_and_shares_the_torque_alike(name):
    """Between both bounds, and within 3 % in torsion; the file of `sleeved` had named 2e5 N/mm, 7 % too soft. Shares differ."""
    drive = load_drive(name).cases["nominal"]
    beams = drive.with_fields(TIED) if name == "robot-joint" else drive
    spring = shaft_pin_spring(beams)
    stiffness = {}
    for value in (None, spring.loaded_alike, spring.stiffness, spring.turned_alike):
        found = analyse(
            beams if value is None else beams.with_fields({"pin_shaft.stiffness": value}), position_angles(13)
        )
        stiffness[value] = np.mean((found.torque - drive.load.light_torque) / found.wind_up)
        if value is not None:
            assert found.torque_share.max() < 0.51
        else:
            assert found.torque_share.max() > 0.6
    bent = stiffness[None]
    assert stiffness[spring.loaded_alike] < bent < stiffness[spring.turned_alike]
    assert stiffness[spring.stiffness] == pytest.approx(bent, rel=0.035)


def test_the_spring_was_a_mean_whatever_yields_beside_the_pins():
    """Slender pins turn their discs alike, stiff ones let flank and bearing share: the mean was 58 % too soft at worst."""
    thin = {"disc.thickness": 0.2, "crank_bearing.roller_length": 0.2, "disc.planes": JOINT.disc.disc_planes}
    thin["pin_shaft.beam.span"] = JOINT.with_fields(TIED).shaft_pin_span
    slender, stiff = (
        shaft_pin_spring(JOINT.with_fields({"pin_shaft.beam.tip": "free", "pin_shaft.beam.diameter": diameter, **more}))
        for diameter, more in ((1.0, {}), (10.0, thin))
    )
    assert slender.turned_alike / slender.loaded_alike > 4.0
    # Pins of ⌀ 1 mm yield by far more than contacts of 8 mm; those of ⌀ 10 mm by far less than contacts of 0.2 mm.
    assert slender.together == pytest.approx(slender.turned_alike, rel=2e-3)
    assert stiff.loaded_alike == pytest.approx(stiff.together, rel=0.1)
    assert stiff.turned_alike > 2.0 * stiff.loaded_alike


@pytest.mark.parametrize("moment", [0.1, 1.0, 30.0])
def test_pins_behind_gaps_carry_a_moment(moment):
    """The rotation by which it is carried, by bisection."""
    generator = np.random.default_rng(3)
    lever, gap = generator.uniform(0.0, 3.0, (4, 9)), generator.uniform(-0.1, 0.5, (4, 9))
    lever[:, 4] = 0.0
    low, high = np.full((4, 1), -10.0), np.full((4, 1), 100.0)
    for _ in range(80):
        middle = 0.5 * (low + high)
        more = np.sum(np.maximum(middle * lever - gap, 0.0) * lever, axis=1, keepdims=True) < moment
        low, high = np.where(more, middle, low), np.where(more, high, middle)
    np.testing.assert_allclose(_wind_up(lever, gap, moment), middle, rtol=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("tip", "diameter", "most"), [("free", 10.0, 0.08), ("free", 6.0, 0.25), ("tied-pinned", 6.0, 0.1)]
)
def test_the_spring_of_slender_and_of_free_pins_was_not_told_to_be_off(tip, diameter, most):
    """It "turns the output as far", and was 40 % too soft with free tips of ⌀ 6 mm."""
    beams = JOINT.with_fields({"pin_shaft.beam.tip": tip, "pin_shaft.beam.diameter": diameter})
    spring = shaft_pin_spring(beams)
    bent, sprung = (
        np.mean((found.torque - drive.load.light_torque) / found.wind_up)
        for drive in (beams, beams.with_fields({"pin_shaft.stiffness": spring.stiffness}))
        for found in (analyse(drive, position_angles(12)),)
    )
    assert sprung == pytest.approx(bent, rel=most)
    assert most <= spring.error
    with refused_field("pin_shaft.beam", "", f"turns the output as far within some {100.0 * spring.error:g} %"):
        require(beams, "direct")


@pytest.mark.slow
def test_the_spring_of_three_pins_was_told_to_be_within_ten_percent():
    """The least stiffness over a turn was 17 % too large, by the pins that happen to carry at a position."""
    drive = {
        "pin_shaft.number_of_pins": 3, "pin_shaft.pin_radius": 2.5, "pin_shaft.hole_radius": 3.505, "load.torque": 60e3,
        "pin_shaft.beam.tip": "tied-clamped",
    }  # fmt: skip
    beams = JOINT.with_fields(drive)
    spring = shaft_pin_spring(beams)
    bent, sprung = (
        np.min((found.torque - one.load.light_torque) / found.wind_up)
        for one in (beams, beams.with_fields({"pin_shaft.stiffness": spring.stiffness}))
        for found in (analyse(one, position_angles(4)),)
    )
    off = abs(sprung / bent - 1.0)
    assert 0.1 < off < spring.error
    assert spring.accuracy == "within some 25 %"


@pytest.mark.slow
def test_the_spring_of_slender_pins_on_pinned_tips_was_told_to_be_within_twenty_percent(monkeypatch):
    """It is 22 % too soft: of 24 invented drives the worst with tied tips."""
    monkeypatch.syspath_prepend(ROOT / "benchmarks")
    from spring_of_pins import BASE, BEAMS, stiffnesses

    (base,) = parse_drive(BASE).cases.values()
    beams = base.with_fields(BEAMS["pinned, slender"])
    spring = shaft_pin_spring(beams)
    bent, sprung = (
        stiffnesses(drive, position_angles(3))
        for drive in (beams, beams.with_fields({"pin_shaft.stiffness": spring.stiffness}))
    )
    assert 0.2 < np.max(np.abs(sprung / bent - 1.0)) < spring.error


@pytest.mark.parametrize("engine", ["solid disc", "direct"])
def test_a_refusal_of_beams_names_the_spring_in_their_place(engine):
    """It said to write `stiffness`, and no command printed a value."""
    drive = JOINT.with_fields(TIED | {"disc.number_of_discs": 1} if engine == "solid disc" else TIED)
    with refused_field("pin_shaft.beam", "", "; give pin_shaft.stiffness in its place: ", " N/mm turns") as told:
        require(drive, engine)
    value = float(re.search(r"place: (\S+) N/mm", str(told.value))[1])
    assert value == shaft_pin_spring(drive).stiffness
    assert ("alike" in str(told.value)) == (drive.disc.number_of_discs == 2)
    require(drive.with_fields({"pin_shaft.stiffness": value}), engine)


def test_show_prints_the_spring_that_pins_are_equal_to():
    spring = shaft_pin_spring(JOINT.with_fields(TIED))
    drive = JOINT.with_fields(TIED)
    row = dict(derived_rows(drive, drive, plays=False))["shaft pins, springs that turn as far"]
    assert row.startswith(f"pin_shaft.stiffness = {spring.stiffness:g} N/mm, within some 25 %; ")
    assert "shaft pins, springs that turn as far" not in dict(derived_rows(JOINT, JOINT, plays=False))


def test_the_lines_of_springs_in_shipped_files_are_those_of_their_beams():
    """4e5 N/mm of `robot-joint` beside its beam, 2e5 N/mm in the comment of `sleeved`, whose beam is equal to 2.63e5."""
    assert JOINT.pin_shaft.stiffness == pytest.approx(shaft_pin_spring(JOINT.with_fields(TIED)).stiffness, rel=0.03)
    sleeved = load_drive("sleeved")
    (line,) = re.findall(r"(?m)^# stiffness = (\S+)", sleeved.text)
    assert float(line) == shaft_pin_spring(sleeved.cases["nominal"]).stiffness


def test_a_disc_between_holes_flank_and_bearing_is_in_balance(vary):
    """Energies by hand where shaft pins carry g sin: forces along lines through the pitch point, on all pins of one side.

    Their moment about the centre of the disc is that of the holes; the bearing takes the moment on the wheel by e z_P.
    """
    drive = vary(
        pin_wheel={"number_of_pins": 6, "pin_radius": 9.0},
        disc={"number_of_teeth": 5, "equidistant_offset": 0.0, "shifting_offset": 0.0},
    )
    wheel, bearing, e = drive.pin_wheel, drive.crank_bearing, drive.crank.eccentricity
    steel, length = 206_000.0 / (2.0 * (1.0 - 0.3**2)), drive.disc.thickness
    on_holes = 0.25 * drive.number_of_holes * drive.pin_shaft.pin_circle_radius  # of g = 1 in the mean
    pitch, energies = 6.0 * e, []
    for phase in np.arange(8) / 8.0:
        pin = wheel.pin_circle_radius * np.exp(2j * pi * (np.arange(6) + phase) / 6.0)
        along = (pitch - pin) / np.abs(pitch - pin)
        about_wheel, about_disc = ((along.conjugate() * (pin - at)).imag for at in (0.0, e))
        pressed = pin.imag > 1e-9
        force = np.where(pressed, np.abs(about_wheel), 0.0)
        force *= on_holes / np.abs(np.sum(force * about_disc))
        across = np.abs(np.sum(force * about_wheel)) / pitch
        by_flank = np.sum(force**2) / (pi * steel * length / 10.0)
        rollers = pi * steel * drive.roller_length / 10.0 * bearing.number_of_rollers / 8.0
        energies.append(by_flank + across**2 / rollers)
    assert _energy_beside(drive) == pytest.approx(np.mean(energies), rel=1e-9)
