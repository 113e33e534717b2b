"""Reducers with loose, sleeved and bent pins: every one is answered, and confirmed by energies alone; the check can fail."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ltca.analysis.engines import HalfSpace
from ltca.compliance.response import Start
from ltca.drive.fields import read_field
from ltca.drive.materials import Material
from ltca.drive.parts import ShaftPinBeam, ShaftPinSeat, WheelPinBeam, WheelPinSeat
from ltca.equilibrium.output_torque import solve_at_output
from ltca.mechanics.contacts import Linearised
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import parse_drive, shipped_drive
from ltca.testing.balance_check import find_imbalance
from ltca.testing.pin_drives import pin_drive
from ltca.testing.yielding_pins import ContactOfSleeves, SeatEnergy, beam_stiffness


def check_seeds(first, count):
    for seed in range(first, first + count):
        drive, angle = pin_drive(seed)
        model = HalfSpace().prepare(drive).model
        balanced = solve_at_output(model, [drive], np.array([angle]), drive.load.torque)
        assert find_imbalance(drive, model, balanced, torque=drive.load.torque) == [], seed


def test_drives_of_all_pins_quick():
    check_seeds(0, 1)


@pytest.mark.slow
def test_shared_pins_settle_to_round_off_and_no_further(monkeypatch):
    """Of pins on a circle of 150 mm displacements were wanted to less than round-off: eight evaluations instead of four."""
    drive, angle = pin_drive(21)
    model = HalfSpace().prepare(drive).model
    found = solve_at_output(model, [drive], np.array([angle]), drive.load.torque)
    counts, plain = [], Linearised.__init__

    def evaluated(*arguments, **options):
        counts.append(0)
        plain(*arguments, **options)

    monkeypatch.setattr(Linearised, "__init__", evaluated)
    again = model.respond(found.crank_angle, found.pose, Start.after(found.response))
    assert again.shifts is not None
    assert len(counts) <= 2


@pytest.mark.slow
def test_carriers_of_all_kinds_are_drawn():
    """Twisting, on posts, both or none; posts on the circle of pins or cranks, as long as the discs, flanges left out."""
    drives = [pin_drive(seed)[0] for seed in range(60)]
    kinds = {
        None if d.carrier is None else (d.carrier.stiffness_torsion is None, d.carrier.posts is None) for d in drives
    }
    assert kinds == {None, (True, False), (False, True), (False, False)}
    on_posts = [d for d in drives if d.carrier is not None and d.carrier.posts is not None]
    assert (
        {d.carrier.flange is None for d in on_posts}
        == {d.carrier.posts.length is None for d in on_posts}
        == {True, False}
    )
    assert {d.crank.support is None for d in on_posts} == {d.pin_shaft is None for d in on_posts} == {True, False}
    circles = [d.crank.circle_radius if d.pin_shaft is None else d.pin_shaft.pin_circle_radius for d in on_posts]
    assert {d.carrier.posts.radius == circle for d, circle in zip(on_posts, circles, strict=True)} == {True, False}


@pytest.mark.slow
@pytest.mark.parametrize("path", ["carrier.posts.size", "carrier.flange.1"])
def test_the_check_sees_a_wrong_carrier(path):
    """Of an answer to a drive whose posts or far flange are a twentieth thicker."""
    given = {
        "carrier.posts.number": 3,
        "carrier.posts.radius": 42.0,
        "carrier.posts.size": 14.0,
        "carrier.flange": (8.0, 8.0),
    }
    drive = with_fields(parse_drive(shipped_drive("rv"), "rv").cases["nominal"], given)
    model = HalfSpace().prepare(drive).model
    balanced = solve_at_output(model, [drive], np.array([0.4]), drive.load.torque)
    assert find_imbalance(drive, model, balanced) == []
    other = with_fields(drive, {path: 1.05 * read_field(drive, path)})
    assert any("slope of the potential" in told for told in find_imbalance(other, model, balanced))


@pytest.mark.slow
@pytest.mark.parametrize(("first", "count"), [(1, 3), pytest.param(4, 96, marks=pytest.mark.nightly)])
def test_a_hundred_drives_of_all_pins(first, count):
    """``benchmarks/random_drives.py --pins`` runs thousands."""
    check_seeds(first, count)


@pytest.mark.slow
def test_every_kind_of_pin_is_drawn():
    drives = [pin_drive(seed)[0] for seed in range(60)]
    wheels, shafts = [drive.pin_wheel for drive in drives], [drive.pin_shaft for drive in drives if drive.pin_shaft]
    assert {wheel.seat.kind for wheel in wheels} == {"fixed", "slot", "sleeve"}
    assert {shaft.seat.kind for shaft in shafts} == {"fixed", "sleeve"}
    assert {wheel.beam.ends if wheel.beam else None for wheel in wheels} == {None, "supported", "clamped"}
    assert {shaft.beam.tip if shaft.beam else None for shaft in shafts} == {None, "free", "tied-clamped", "tied-pinned"}
    # Nothing at all, and what is equal.
    assert any(w.seat.kind == "fixed" and w.beam is None for w in wheels)
    both = [d for d in drives if d.pin_shaft and d.pin_wheel.seat_play > 0.0 and d.pin_shaft.seat_play > 0.0]
    assert any(np.isclose(drive.pin_wheel.seat_play, drive.pin_shaft.seat_play) for drive in both)
    beams = [(part, part.beam) for part in (*wheels, *shafts) if part.beam]
    assert {beam.diameter is None for _, beam in beams} == {True, False}
    assert any(beam.diameter == 2.0 * (part.seat.pin_radius or part.pin_radius) for part, beam in beams)
    assert any(drive.pin_wheel.pin_errors.diameter and drive.pin_wheel.seat.kind == "slot" for drive in drives)
    assert {drive.materials.sleeve.youngs_modulus for drive in drives} == {206e3, 110e3, 2.6e3}
    assert any(np.isclose(beam.span, span_needed(drive)) for drive in drives if (beam := drive.pin_wheel.beam))


def span_needed(drive):
    return 2.0 * max(abs(plane) for plane in drive.disc.disc_planes) + drive.disc.thickness


@pytest.fixture(scope="module")
def answered():
    """The made-up robot joint on two bent pins of every make, and its answer: wheel pins in slots or under sleeves."""
    joint = parse_drive(shipped_drive("robot-joint"), "robot-joint").cases["nominal"]
    seats = {
        "slot": WheelPinSeat(kind="slot", radius=2.504),
        "sleeve": WheelPinSeat(kind="sleeve", pin_radius=1.5, bore_radius=1.51),
    }
    shaft = replace(
        joint.pin_shaft,
        stiffness=None,
        seat=ShaftPinSeat(kind="sleeve", pin_radius=4.0, bore_radius=4.02),
        beam=ShaftPinBeam(span=30.0, tip="tied-clamped"),
    )
    found = {}
    for name, seat in seats.items():
        wheel = replace(joint.pin_wheel, seat=seat, beam=WheelPinBeam(span=30.0, ends="supported", diameter=3.0))
        drive = replace(joint, pin_wheel=wheel, pin_shaft=shaft)
        model = HalfSpace().prepare(drive).model
        found[name] = drive, model, solve_at_output(model, [drive], np.array([0.31]), drive.load.torque)
    return found


@pytest.mark.family(quick=1)
@pytest.mark.parametrize("name", ["slot", "sleeve"])
def test_the_answers_looked_at_below_balance(answered, name):
    drive, model, found = answered[name]
    assert find_imbalance(drive, model, found, torque=drive.load.torque) == []


@pytest.mark.parametrize(
    ("name", "other"),
    [
        # A tenth of a micrometre of play, a hundredth of a beam, another end.
        ("slot", {"pin_wheel.seat.radius": 2.5041}),
        ("sleeve", {"pin_wheel.seat.bore_radius": 1.5101}),
        ("slot", {"pin_shaft.seat.bore_radius": 4.0202}),
        ("slot", {"pin_wheel.beam.diameter": 2.97}),
        ("slot", {"pin_wheel.beam.span": 30.3}),
        ("slot", {"pin_wheel.beam.ends": "clamped"}),
        ("slot", {"pin_shaft.beam.diameter": 7.92}),
        ("slot", {"pin_shaft.beam.span": 30.3}),
        ("slot", {"pin_shaft.beam.tip": "tied-pinned"}),
        ("slot", {"disc.planes": (-8.3, 8.3)}),
        ("slot", {"pin_wheel.pin_errors.diameter": (0.0002,) * 40}),
    ],
)  # fmt: skip
def test_the_check_sees_another_drive(answered, name, other):
    drive, model, found = answered[name]
    assert any("slope" in problem for problem in find_imbalance(with_fields(drive, other), model, found))


@pytest.mark.parametrize("coordinate", [-4, -3, -2])
def test_the_check_sees_a_wrong_ring(answered, coordinate):
    """A micrometre at the tips: a tenth of what the ring moves."""
    drive, model, found = answered["slot"]
    pose = found.pose.copy()
    pose[0, coordinate] += 1e-3 / (drive.pin_shaft.pin_circle_radius if coordinate == -2 else 1.0)
    assert any("slope" in problem for problem in find_imbalance(drive, model, replace(found, pose=pose)))


def test_the_check_sees_a_pin_left_behind(answered):
    """The load of one pin too small by a fiftieth, the pose right: only the places of that pin tell."""
    drive, model, found = answered["slot"]
    first, second = found.response.parts
    pin = int(np.argmax(first.pin_load[0]))
    loads = first.pin_load.copy()
    loads[0, pin] = 0.98 * loads[0, pin]
    wrong = replace(found, response=replace(found.response, parts=(replace(first, pin_load=loads), second)))
    assert any("place of a wheel pin" in problem for problem in find_imbalance(drive, model, wrong))


@pytest.mark.parametrize(
    ("ends", "factor"),
    [("supported", 48.0), ("clamped", 192.0), ("free", 24.0), ("tied-pinned", 768.0 / 7.0), ("tied-clamped", 192.0)],
)
def test_beams_of_the_check_at_mid_span(answered, ends, factor):
    """Textbook: k = n EI/L³ under a force at mid-span; a cantilever's 24 is 3 · 2³. Slender, on a thin disc; 1e-3 for both."""
    drive = answered["slot"][0]
    single = replace(drive.disc, number_of_discs=1, phases=(), planes=(), thickness=0.02)
    drive = replace(drive, disc=single)
    wheel = replace(drive.pin_wheel, seat=WheelPinSeat(), beam=None)
    part = replace(wheel, beam=WheelPinBeam(span=100.0, ends=ends, diameter=1.0)) if ends in ("supported", "clamped") else (
        replace(drive.pin_shaft, beam=ShaftPinBeam(span=100.0, tip=ends, diameter=1.0))
    )  # fmt: skip
    stiffness = beam_stiffness(drive, part, Material())
    expected = factor * 206e3 * np.pi / 64.0 / 100.0**3
    # A tip that a ring holds stands still here: the first row is the force on the disc by the disc's displacement.
    assert stiffness[0, 0] == pytest.approx(expected, rel=1e-3)
    if ends.startswith("tied"):
        # Moving tip and nothing else: 12 EI/L³, 3 EI/L³ where it may turn; the disc yields along its own shape.
        alone = stiffness[1, 1] - stiffness[1, 0] ** 2 / stiffness[0, 0]
        assert alone == pytest.approx({"tied-clamped": 12.0, "tied-pinned": 3.0}[ends] / factor * expected, rel=1e-3)


def test_energy_of_a_seat_has_its_load_as_slope(answered):
    model = answered["slot"][1]
    law = model.discs[0].pin_law.seat
    seat = SeatEnergy(law=law, play=np.array([0.004, 0.0041]), largest=300.0)
    loads = np.array([[1e-3, 1e-3], [1.0, 1.0], [80.0, 90.0], [300.0, 320.0], [2000.0, 2100.0]])
    at, step = seat.approach(loads), 1e-3 * seat.approach(loads)
    slope = (seat.at(at + step) - seat.at(at - step)) / (2.0 * step)
    # second order in the step, a thousandth of the approach
    np.testing.assert_allclose(slope, loads, rtol=2e-6)
    np.testing.assert_array_equal(seat.at(-at), 0.0)


def test_energy_of_contacts_on_sleeves_has_their_load_as_slope(answered):
    """By bisection and quadrature, against the load that Newton's method finds for the same law with nothing behind it."""
    law = replace(answered["sleeve"][1].discs[0].pin_law, play=np.array(0.01))
    assert law.overlap > 0.0
    at, radius = np.geomspace(1e-6, 1e-2, 30)[None], np.full((1, 30), 2.0)
    energy = ContactOfSleeves(law=law).energy
    slope = (energy(1.0005 * at, radius) - energy(0.9995 * at, radius)) / (1e-3 * at)
    # second order in a step of 5e-4 of the approach, where what is taken off comes to its bound
    np.testing.assert_allclose(
        slope, replace(law, seat=None, flexibility=0.0).load_and_stiffness(at, radius)[0], rtol=1e-5
    )
    np.testing.assert_array_equal(energy(-at, radius), 0.0)
