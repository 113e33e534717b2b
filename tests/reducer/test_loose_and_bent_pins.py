"""Loose pins, sleeves and pins that bend: brute force with the free parts' own unknowns, closed forms, work, invariances."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from refusals import refused_field
from scipy.optimize import root

from ltca.analysis import summary as summary_module
from ltca.analysis.engines import HalfSpace
from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.results import build_dataset
from ltca.analysis.summary import summarise
from ltca.compliance.coupled import CoupledCompliance
from ltca.compliance.pin_flexibility import PinDisplacements
from ltca.drive.parts import CrankSupport, ShaftPinBeam, ShaftPinSeat, WheelPinBeam, WheelPinSeat
from ltca.drive.pin_beams import from_start, shaft_pin_beam, wheel_pin_beam
from ltca.drive.single_discs import single_discs
from ltca.equilibrium.friction.sticking import StickingFriction
from ltca.equilibrium.output_torque import solve_at_output
from ltca.equilibrium.reducer import Reducer
from ltca.equilibrium.supports import Supports
from ltca.errors import ConvergenceError
from ltca.geometry.coordinates import DISC_ROTATION, WHEEL_ANGLE, X, Y
from ltca.geometry.flank import FlankProfile
from ltca.geometry.placement import position_angles
from ltca.laws.backed import wheel_pin_seat
from ltca.laws.line_contact import LineContactLaw
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import parse_drive, shipped_drive
from ltca.reading.writing import drive_text
from ltca.studies.batch_analysis import BatchSettings, analyse_samples
from ltca.testing.closed_form_bodies import without_coupling

pytestmark = pytest.mark.slow

ANGLES = np.array([0.31, 1.7, 4.4])
LOAD = 1e-4
"""Loads of equal drives solved from different sides, N: the balance closes to 1e-9 of some 10 kN, and stiffness adds a digit."""
SLOT = WheelPinSeat(kind="slot", radius=2.504)
SLEEVE = WheelPinSeat(kind="sleeve", pin_radius=1.5, bore_radius=1.51)
WALLS = WheelPinBeam(span=30.0, ends="supported")


@pytest.fixture(scope="module")
def joint():
    return parse_drive(shipped_drive("robot-joint"), "robot-joint").cases["nominal"]


def tips(kind):
    """Shaft pins under sleeves as beams."""
    seat = ShaftPinSeat(kind="sleeve", pin_radius=4.0, bore_radius=4.02)
    return {"stiffness": None, "seat": seat, "beam": ShaftPinBeam(span=30.0, tip=kind)}


def kind(joint, name):
    """The made-up robot joint, two discs, with pins in different makes."""

    def wheel(**words):
        return replace(joint, pin_wheel=replace(joint.pin_wheel, **words))

    if name == "slots":
        return wheel(seat=SLOT)
    if name == "sleeves":
        return wheel(seat=SLEEVE)
    if name == "bent wheel pins":
        return wheel(beam=WALLS)
    if name == "three discs on bent sleeved pins":
        three = wheel(seat=SLEEVE, beam=replace(WALLS, span=40.0, ends="clamped", diameter=2.8))
        return replace(three, disc=replace(joint.disc, number_of_discs=3, phases=(), planes=()))
    if name in ("free", "tied-clamped", "tied-pinned"):
        return replace(joint, pin_shaft=replace(joint.pin_shaft, **tips(name)))
    assert name == "everything"
    support = CrankSupport(diameter=20.0, positions=(-22.0, 22.0), stiffness=(3e5, 4e5))
    drive = wheel(seat=SLOT, beam=WALLS, support_stiffness=5e5)
    shaft = replace(joint.pin_shaft, **tips("tied-clamped"))
    return replace(drive, pin_shaft=shaft, crank=replace(joint.crank, support=support))


THREE, PINNED, ALL = (
    pytest.param(name, marks=pytest.mark.slow)
    for name in ("three discs on bent sleeved pins", "tied-pinned", "everything")
)
KINDS = ["slots", "free", ALL, "bent wheel pins", "sleeves", THREE, "tied-clamped", PINNED]
QUICK_AND_SLOW = [
    name if name in ("slots", "free", THREE, PINNED, ALL) else pytest.param(name, marks=pytest.mark.slow)
    for name in KINDS
]


@pytest.mark.family(full=4)
@pytest.mark.parametrize("name", QUICK_AND_SLOW)
def test_virtual_work_at_every_position(joint, name, unbalanced_work):
    np.testing.assert_allclose(unbalanced_work(kind(joint, name), ANGLES + 0.05), 0.0, atol=1e-7)


@pytest.mark.family(full=4)
@pytest.mark.parametrize("name", QUICK_AND_SLOW)
def test_tangent_is_the_slope_of_the_force(joint, name, tangent_and_slope):
    scaled, slope = tangent_and_slope(kind(joint, name), ANGLES[:1])
    # differences of second order over 1e-7 mm: round-off of loads of 1e4 N by the step, and contacts that just open
    np.testing.assert_allclose(slope, scaled, rtol=0.0, atol=2e-6 * np.abs(scaled).max())


@pytest.mark.slow
@pytest.mark.parametrize("name", ["slots", "sleeves"])
def test_a_free_pin_by_its_own_two_unknowns(joint, name):
    """Pin (or sleeve) between flank and seat, both contacts and its place found by brute force: load and approach of the pair."""
    drive = single_discs(kind(joint, name))[0]
    model = HalfSpace().prepare(drive).model
    found = solve_at_output(model, [drive], ANGLES[:1], drive.load.torque)
    (disc,), pose, part = model.discs, found.pose[0], found.response
    profile, wheel, place = FlankProfile.of_drive(drive), drive.pin_wheel, disc.geometry.placement
    seat, contact = wheel_pin_seat(drive), LineContactLaw(drive.disc.thickness, 206e3 / (2.0 * (1.0 - 0.09)))
    contact = replace(
        disc.pin_law, contact=contact, seat=None, play=np.zeros(1)
    )  # what a half-space counts of a sleeve's wall is off
    play = np.array([wheel.seat_play])
    centre = complex(place.races(ANGLES[:1]).middle[0]) + pose[X] + 1j * pose[Y]
    turn = np.exp(1j * pose[DISC_ROTATION])
    loaded = np.flatnonzero(part.pin_load[0] > 0.05 * part.pin_load[0].max())
    assert loaded.size > 5
    for pin in loaded[:: loaded.size // 4]:
        wheel_turn = place.wheel_rotation(ANGLES[:1])[0] + pose[WHEEL_ANGLE]
        home = place.wheel_pin_centres[pin] * np.exp(1j * wheel_turn)

        def forces(moved, home=home, pin=pin):
            """Sum of both forces on the free part, N, at its displacement from the seat's centre, µm."""
            at = home + 1e-3 * complex(*moved)
            in_disc = (at - centre) / turn
            theta = profile.nearest_point(np.array([in_disc]), part.flank.parameter[0, [pin]]).parameter
            gap = profile.distance(np.array([in_disc]), theta)[0] - wheel.pin_radius
            radius = profile.effective_radius(theta, np.array([wheel.pin_radius]))[0]
            flank = contact.load_and_stiffness(np.array([-gap]), radius)[0][0] * profile.normal(theta)[0] * turn
            pressed = abs(at - home) - play[0]
            held = load_of(seat, pressed, play)
            total = flank - held * (at - home) / abs(at - home)
            return [total.real, total.imag]

        outward = part.flank.gradient[0, pin, X] + 1j * part.flank.gradient[0, pin, Y]
        guess = 1e3 * (play[0] + 1e-3) * outward
        solved = root(forces, [guess.real, guess.imag], tol=1e-13)
        assert np.abs(forces(solved.x)).max() < 1e-7 * part.pin_load[0, pin]
        at = 1e-3 * complex(*solved.x)
        held = load_of(seat, abs(at) - play[0], play)
        assert held == pytest.approx(part.pin_load[0, pin], rel=1e-6)
        # Collinear: the free part lies from the seat's centre along the normal that the closed form took.
        assert abs(at - abs(at) * outward) < 1e-9


def load_of(seat, approach, play):
    """Load of a seat at an approach by bisection and Newton's method, N."""
    if approach <= 0.0:
        return 0.0
    low, high = 0.0, 1e6
    load = 100.0
    for _ in range(200):
        given, slope = (float(value[0]) for value in seat.approach_and_compliance(np.array([load]), play))
        low, high = (load, high) if given < approach else (low, load)
        step = load - (given - approach) / slope
        following = step if low < step < high else 0.5 * (low + high)
        if abs(following - load) < 1e-14 * load:
            break
        load = following
    return load


def unmodified(drive):
    """Without offsets and clearance: the loaded arc is half the wheel and more, discs share pins."""
    return with_fields(
        drive,
        {
            "disc.equidistant_offset": 0.0,
            "disc.shifting_offset": 0.0,
            "clearance.bearing": 0.0,
            "clearance.pin_hole": 0.0,
        },
    )


@pytest.mark.parametrize("name", ["bent wheel pins", THREE, "free", ALL])
def test_pins_that_discs_share_by_a_dense_reference(joint, name):
    """Every loaded pin alone, all its discs' forces and its place at each disc as unknowns, exact gaps of the moved pin."""
    drive = unmodified(kind(joint, name))
    model = HalfSpace().prepare(drive).model
    found = solve_at_output(model, [drive], ANGLES[:1], drive.load.torque)
    parts, singles = found.response.parts, single_discs(drive)
    on_wheel = drive.pin_wheel.beam is not None
    beam = wheel_pin_beam(drive) if on_wheel else shaft_pin_beam(drive)
    flexibility = beam.flexibility(from_start(beam, drive).tolist(), drive.disc.thickness)
    loads = np.stack([(part.pin_load if on_wheel else part.hole_load)[0] for part in parts])
    together = np.count_nonzero(loads > 0.0, axis=0)
    assert together.max() > 1 or len(parts) == 2  # two unmodified discs half a turn apart share every pin by turns
    pins = np.flatnonzero(together == together.max())[:3]
    for pin in pins:
        forces = []
        for number, (part, single) in enumerate(zip(parts, singles, strict=True)):
            forces.append(force_of(model.discs[number], single, part, found, number, pin, on_wheel, model.coordinates))

        def left(moved, forces=forces):
            places = moved[::2] + 1j * moved[1::2]
            pushed = np.array([force(at) for force, at in zip(forces, places, strict=True)])
            rest = places - flexibility @ pushed
            return np.ravel(np.column_stack((rest.real, rest.imag)))

        # Contacts are far stiffer than the pin: from the answer on, which a wrong one does not survive.
        motions = [(part.flank if on_wheel else part.holes).gradient[0, pin] for part in parts]
        begin = flexibility @ (loads[:, pin] * np.array([motion[X] + 1j * motion[Y] for motion in motions]))
        start = np.ravel(np.column_stack((begin.real, begin.imag)))
        for _ in range(3):
            solved = root(left, start, tol=1e-15, options={"xtol": 1e-13})
            start = solved.x
        assert np.abs(left(solved.x)).max() < 1e-10
        places = solved.x[::2] + 1j * solved.x[1::2]
        expected = [abs(force(at)) for force, at in zip(forces, places, strict=True)]
        # 1e-10 mm of a pin's place by 1e6 N/mm
        np.testing.assert_allclose(loads[:, pin], expected, rtol=1e-6, atol=1e-3)


def force_of(model, single, part, found, number, pin, on_wheel, coordinates):
    """The function that tells the force of one disc on a pin displaced by something, from exact gaps and the contact alone."""
    place, pose = model.geometry.placement, found.pose[0, coordinates.columns(number)]
    own = model.geometry.coordinates
    centre = complex(place.races(ANGLES[:1]).middle[0]) + pose[X] + 1j * pose[Y]
    turn = np.exp(1j * pose[DISC_ROTATION])
    if on_wheel:
        profile, law = model.geometry.profile, model.pin_law
        stiff = replace(law, flexibility=0.0)  # contact and seat, without the beam
        rotation = place.wheel_rotation(ANGLES[:1])[0] + pose[WHEEL_ANGLE]
        moved = complex(*pose[own.wheel_place]) if own.wheel else 0.0
        home = place.wheel_axis + moved + place.wheel_pin_centres[pin] * np.exp(1j * rotation)

        def on_pin(shift):
            at = np.array([(home + shift - centre) / turn])
            theta = profile.nearest_point(at, part.flank.parameter[0, [pin]]).parameter
            gap = profile.distance(at, theta) - (place.wheel_pin_radii - place.wheel_pin_plays)[pin]
            one = replace(stiff, play=stiff.play[[pin]])
            radius = profile.effective_radius(theta, place.wheel_pin_radii[[pin]])
            return complex(one.load_and_stiffness(-gap, radius)[0][0] * profile.normal(theta)[0] * turn)

        return on_pin
    law = model.hole_law
    home = place.shaft_pin_centres[pin] + 0j
    hole = centre + place.hole_centres[pin] * turn

    def on_shaft_pin(shift):
        away = home + shift - hole
        gap = place.hole_radii[pin] - place.shaft_pin_radii[pin] + place.shaft_pin_plays[pin] - abs(away)
        # The sleeve alone is between hole and pin: its law the other way round, the spring of the own beam taken out.
        load = load_of(law.seat, -gap, law.play[[pin]])
        return complex(-load * away / abs(away))

    return on_shaft_pin


@pytest.mark.parametrize(
    "name", [*(pytest.param(name, marks=pytest.mark.nightly) for name in ("sleeves", "tied-clamped")), ALL]
)
def test_bodies_that_feel_nothing_are_half_spaces(joint, name):
    """Coefficients without coupling: the coupled model, its matrix of slopes too, gives what the tables give."""
    drive = kind(joint, name)
    discs = [
        CoupledCompliance.of_drive(single, without_coupling(single), "half-space", hole_near_field=False)
        for single in single_discs(drive)
    ]
    model = Reducer(
        discs=tuple(discs), supports=Supports.of_drive(drive, discs[0].geometry), pins=PinDisplacements.of_drive(drive)
    )
    found = solve_at_output(model, [drive], ANGLES[:2], drive.load.torque)
    expected = analyse(drive, ANGLES[:2]).full
    np.testing.assert_allclose(found.pose[:, WHEEL_ANGLE], expected.pose[:, WHEEL_ANGLE], rtol=0.0, atol=1e-11)
    np.testing.assert_allclose(found.response.pin_load, expected.response.pin_load, rtol=0.0, atol=LOAD)
    np.testing.assert_allclose(found.response.hole_load, expected.response.hole_load, rtol=0.0, atol=LOAD)
    np.testing.assert_allclose(
        found.response.tangent, expected.response.tangent, rtol=0.0, atol=1e-6 * np.abs(expected.response.tangent).max()
    )
    assert np.max(found.iterations) < 20


def test_kinds_typed_out_are_those_left_out(joint):
    typed = with_fields(joint, {"pin_wheel.seat.kind": "fixed", "pin_shaft.seat.kind": "fixed"})
    assert typed.fingerprint() == joint.fingerprint()
    np.testing.assert_array_equal(analyse(typed, ANGLES).full.pose, analyse(joint, ANGLES).full.pose)


@pytest.mark.parametrize("name", [pytest.param(THREE.values[0], marks=pytest.mark.nightly), ALL])
def test_reverse_is_the_mirror_image(joint, name):
    drive = kind(joint, name)
    reverse = with_fields(drive, {"load.direction": "cw", "disc.phases": tuple(-p for p in drive.disc.disc_phases)})
    plain, mirrored = analyse(drive, -ANGLES), analyse(reverse, ANGLES)
    np.testing.assert_allclose(
        plain.full.pose[:, WHEEL_ANGLE], -mirrored.full.pose[:, WHEEL_ANGLE], rtol=0.0, atol=1e-11
    )
    numbers = -np.arange(drive.pin_wheel.number_of_pins) % drive.pin_wheel.number_of_pins
    for first, second in zip(plain.discs, mirrored.discs, strict=True):
        loads = first.full.response.pin_load, second.full.response.pin_load[:, numbers]
        np.testing.assert_allclose(*loads, rtol=0.0, atol=LOAD)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["bent wheel pins", "tied-pinned"])
def test_turning_the_whole_drive_by_a_hole_pitch(joint, name):
    """As for pins that stand still (`test_several_discs`): the same drive under other numbers."""
    turn = 2.0 * np.pi / 8.0
    drive = kind(joint, name)
    plain = analyse(drive, ANGLES)
    turned = analyse(with_fields(drive, {"disc.phases": tuple(p + turn for p in drive.disc.disc_phases)}), ANGLES)
    np.testing.assert_allclose(turned.full.pose[:, WHEEL_ANGLE], plain.full.pose[:, WHEEL_ANGLE], rtol=0.0, atol=1e-11)
    for before, after in zip(plain.discs, turned.discs, strict=True):
        first, second = before.full.response, after.full.response
        np.testing.assert_allclose(np.roll(first.pin_load, 5, axis=1), second.pin_load, rtol=0.0, atol=LOAD)
        np.testing.assert_allclose(np.roll(first.hole_load, 1, axis=1), second.hole_load, rtol=0.0, atol=LOAD)


@pytest.mark.slow
def test_planes_matter_where_pins_bend_and_nowhere_else(joint):
    apart = {"disc.planes": (-8.0, 8.0)}
    bent = kind(joint, "bent wheel pins")
    moved = analyse(with_fields(bent, apart), ANGLES).full.pose - analyse(bent, ANGLES).full.pose
    assert np.all(np.abs(moved[:, WHEEL_ANGLE]) > 1e-6)
    np.testing.assert_array_equal(
        analyse(with_fields(joint, apart), ANGLES).full.pose, analyse(joint, ANGLES).full.pose
    )


@pytest.mark.slow
def test_results_of_seats_and_beams(joint):
    """Loads of the seats are those of the contacts; deflections those of the beam under all discs; what a case lacks is none."""
    drive = kind(joint, "everything")
    found = analyse(drive, ANGLES)
    dataset = build_dataset("pins", {"bent": found, "fixed": analyse(joint, ANGLES)})
    bent, fixed = dataset.sel(case="bent"), dataset.sel(case="fixed")
    np.testing.assert_array_equal(bent["pin_seat_load"], bent["pin_load"])
    np.testing.assert_array_equal(bent["hole_seat_load"], bent["pin_shaft_load"])
    assert np.isnan(fixed["pin_seat_load"]).all()
    assert np.isnan(fixed["ring_x"]).all()
    loaded = bent["pin_load"].values > 0.0
    assert np.all((bent["pin_seat_arc"].values > 0.0) == loaded)
    assert np.all((bent["pin_seat_pressure_max"].values > 0.0) == loaded)
    # By hand: the force of each disc on the pin, along the normal out of the disc, by the beam of all.
    beam = wheel_pin_beam(drive)
    flexibility = beam.flexibility(from_start(beam, drive).tolist(), drive.disc.thickness)
    force = np.stack([
        part.pin_load * (part.flank.gradient[..., X] + 1j * part.flank.gradient[..., Y])
        for part in found.full.response.parts
    ])  # fmt: skip
    expected = np.abs(np.einsum("de,epi->dpi", flexibility, force))
    np.testing.assert_allclose(bent["pin_deflection"], expected, rtol=0.0, atol=1e-11)
    summary = summarise(found)
    assert summary["max_pin_deflection_mm"] == pytest.approx(expected.max(), abs=1e-11)
    assert summary["max_pin_seat_pressure_MPa"] == float(bent["pin_seat_pressure_max"].max())
    assert "max_pin_deflection_mm" not in summarise(analyse(joint, ANGLES))


@pytest.mark.slow
def test_samples_of_seats_and_beams_are_those_of_each_alone(joint):
    """Many drives at once have the law of each, not of the first: a study that scatters a seat or a beam."""
    changes = {
        "pin_wheel.seat.radius": 2.503,
        "pin_wheel.beam.span": 33.0,
        "pin_wheel.beam.diameter": 4.9,
        "pin_shaft.seat.bore_radius": 4.05,
        "pin_shaft.beam.span": 31.0,
        "disc.planes": (-7.0, 7.0),
        "materials.sleeve.youngs_modulus": 110e3,
    }
    base = with_fields(kind(joint, "everything"), {"disc.planes": (-6.0, 6.0)})
    drives = [base, *(with_fields(base, {field: value}) for field, value in changes.items())]
    settings = BatchSettings(
        crank_angle=ANGLES[:2], quantities=("mean_transmission_error", "max_pin_load"), engine=HalfSpace(), nominal=None
    )
    together = analyse_samples(drives, settings)
    alone = np.concatenate([analyse_samples([drive], settings).values for drive in drives])
    assert set(together.messages) == {""}
    # Solved from other starts: 1e-9 of the load
    np.testing.assert_allclose(together.values, alone, rtol=1e-8)
    for field, values in zip(changes, alone[1:], strict=True):
        least = 1e-6 if field == "disc.planes" else 4e-4
        assert abs(values[0] - alone[0, 0]) > least * abs(alone[0, 0]), field


CASES = """
[[case]]
name = "sleeve"
pin_wheel.seat = { kind = "sleeve", pin_radius = 1.5, bore_radius = 1.51 }
[[case]]
name = "fixed"
pin_wheel.seat = { kind = "fixed" }
[[case]]
name = "spring"
pin_shaft.stiffness = 4e5
"""


def test_a_case_may_have_pins_of_another_kind(joint):
    """A seat of another kind has nothing of the one it takes the place of, nor a spring of the beam (both were merged)."""
    base = drive_text(kind(joint, "everything"))
    cases = parse_drive(base + CASES, "pins").cases
    assert cases["sleeve"].pin_wheel.seat == SLEEVE
    assert cases["fixed"].pin_wheel.seat == WheelPinSeat()
    assert cases["spring"].pin_shaft.beam is None
    assert cases["spring"].pin_wheel.seat == SLOT


def test_discs_may_stand_beside_the_zero_where_something_bends(joint):
    aside = {"disc.planes": (-4.5, 6.5)}
    assert with_fields(kind(joint, "bent wheel pins"), aside).disc.planes == (-4.5, 6.5)
    with refused_field("disc.planes", "", "planes are centred on 0 where nothing bends", bound=("equal to", 0.0)):
        with_fields(joint, aside)


@pytest.mark.slow
def test_extremes_between_positions_without_an_answer_cost_no_run(joint, monkeypatch):
    """One position between those of the run that does not balance threw the whole run away."""

    def fails(_):
        raise ConvergenceError("between", [1.0])

    monkeypatch.setattr(summary_module, "refine_together", fails)
    values = summarise(analyse(joint, position_angles(2)))
    assert values["refined_max_pin_load_N"] is None
    assert values["max_pin_load_N"] > 0.0


def test_friction_of_contacts_that_stick_displaced_no_pins(joint):
    """With the input locked, pins on beams stand where all forces on them press them, those of contacts that stick among them."""
    drive = with_fields(
        kind(joint, "bent wheel pins"),
        {"friction.pin": 0.08, "friction.hole": 0.08, "friction.roller": 0.0, "friction.support_bearing": 0.0},
    )
    model = HalfSpace().prepare(drive).model
    smooth = replace(model, friction=None)
    found = solve_at_output(smooth, [drive], ANGLES, drive.load.torque)
    state = StickingFriction.at_rest(model.friction, smooth, found)
    rubbed = replace(model, friction=state)
    after = solve_at_output(rubbed, [drive], ANGLES, 0.98 * drive.load.torque, found.pose).response
    assert max(np.abs(part.friction).max() for part in after.parts) > 1.0
    parts = after.parts
    place = model.discs[0].geometry.placement
    wheel = np.exp(1j * (place.wheel_rotation(ANGLES) + found.pose[:, -1]))[:, None]
    pins = parts[0].pin_load.shape[1]
    force = np.stack([part.pin_forces for part in parts], axis=1)
    force[..., :pins] *= wheel.conjugate()[:, None]
    # Forces are those of discs on pins, u = S f; the wheel has turned on by some 1e-5 since.
    np.testing.assert_allclose(after.shifts, model.pins.under(force), rtol=0.0, atol=1e-4 * np.abs(after.shifts).max())
