"""Contacts in slices on loose pins and sleeves: against the plane laws, their energy, and statics."""

from dataclasses import replace

import numpy as np
import pytest

from ltca.arrays import stack_drives
from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.drive.parts import WheelPinSeat
from ltca.drive.single_discs import single_discs
from ltca.laws.backed import BackedLaw, wheel_pin_seat
from ltca.laws.line_contact import LineContactLaw
from ltca.laws.separate_slices import SeparateSlices
from ltca.laws.sliced_contact import slice_heights
from ltca.laws.sliced_line import SlicedLine
from ltca.laws.sliced_seat import MAX_TRIALS, BackedLine, SlicedSeat, newton_step, shorten_steps
from ltca.laws.spring import SpringLaw
from ltca.reading.drive_file import load_drive

MODULUS, LENGTH, SLICES = 113186.8, 10.0, 9


def loose(slices=SLICES, **seat):
    """One disc of the shipped drive with loose pins, its wheel pins in other seats."""
    whole = next(iter(load_drive("sleeved").cases.values())).with_fields({"contact.slices": slices})
    drive = single_discs(whole)[0]
    if seat:
        drive = replace(drive, pin_wheel=replace(drive.pin_wheel, seat=WheelPinSeat(**seat)))
    return drive


SLEEVE = {"kind": "sleeve", "pin_radius": 2.2, "bore_radius": 2.22}


@pytest.mark.parametrize("play", [1e-5, 0.01, 1.0])
@pytest.mark.parametrize("seat", [{}, SLEEVE])
def test_slices_of_a_seat_are_the_plane_law(play, seat):
    """Even along the width: load, stiffness and energy of the conforming law at its own approach, from a microgram to a ton.

    1e-8: a quintic spline of 60 e-folds of the travel.
    """
    law = wheel_pin_seat(loose(**seat))
    load = np.array([1e-5, 1.0, 100.0, 3e3, 1e4])
    approach, compliance = law.approach_and_compliance(load, play)
    sliced = SlicedSeat.of_law(law, SLICES)
    found = sliced.respond(approach, np.zeros(5), np.full(5, play))
    np.testing.assert_allclose(found.load, load, rtol=1e-8)
    np.testing.assert_allclose(found.by_approach * compliance, 1.0, rtol=1e-7)
    np.testing.assert_allclose(sliced.energy(found, np.full(5, play)), law.energy(load, play), rtol=1e-8)


@pytest.mark.parametrize("seat", [{}, SLEEVE])
def test_aligned_slices_carry_what_the_plane_law_of_loose_pins_does(seat):
    """Contact and seat in series without tilt, to 0.5 % of the load: a part of a sleeve's compliance is a logarithm of length."""
    law, drive = HalfSpaceCompliance.of_drive(loose(**seat)).pin_law, loose(1, **seat)
    plane = HalfSpaceCompliance.of_drive(replace(drive, pin_wheel=replace(drive.pin_wheel, beam=None))).pin_law
    assert isinstance(plane, BackedLaw)
    approach = np.tile(np.array([[1e-3], [5e-3], [0.02], [0.04]]), (1, 30))
    found = law.respond(approach, np.zeros_like(approach), np.full_like(approach, 6.0))
    load, stiffness = plane.load_and_stiffness(approach, np.full_like(approach, 6.0))
    np.testing.assert_allclose(found.load, load, rtol=5e-3)
    np.testing.assert_allclose(found.by_approach, stiffness, rtol=1e-2)
    assert np.max(np.abs(found.moment)) < 1e-9 * load.max()


@pytest.mark.family(quick=1)
@pytest.mark.parametrize("seat", [{}, SLEEVE])
def test_loads_and_moments_of_loose_pins_are_the_slopes_of_their_energy(seat):
    """From full lines to corners that carry alone: differences of the energy against load and moment, and of load and moment
    against their derivatives, which are symmetric.

    1e-7 of the largest: differences over 1e-7 of numbers good to 1e-13 and their third derivatives.
    """
    law = HalfSpaceCompliance.of_drive(loose(**seat)).pin_law
    rng = np.random.default_rng(3)
    shape = (2, 30)
    delta, theta, radius = rng.uniform(-0.004, 0.02, shape), rng.normal(size=shape) * 1.5e-3, np.full(shape, 6.0)
    found, step = law.respond(delta, theta, radius), 1e-7
    assert (found.load == 0.0).any()
    assert ((found.slice_load > 0.0).sum(axis=-1) < SLICES).any()

    def value(name, side, by_tilt):
        contact, travel, lean = law.solve(delta + side * (not by_tilt), theta + side * by_tilt, radius)
        if name != "energy":
            return getattr(contact, name)
        play = np.broadcast_to(law.play, shape).reshape(-1)
        seat = law.seat.respond(travel.reshape(-1), lean.reshape(-1), play)
        return law.contact.energy(contact, radius) + law.seat.energy(seat, play).reshape(shape)

    def slope(name, by_tilt):
        return (value(name, step, by_tilt) - value(name, -step, by_tilt)) / (2.0 * step)

    for name, expected, by_tilt, bound in (
        ("energy", "load", False, 1e-8), ("energy", "moment", True, 1e-8), ("load", "by_approach", False, 1e-5),
        ("load", "by_tilt", True, 1e-5), ("moment", "by_tilt", False, 1e-5), ("moment", "moment_by_tilt", True, 1e-5),
    ):  # fmt: skip
        values = getattr(found, expected)
        np.testing.assert_allclose(slope(name, by_tilt), values, atol=bound * np.max(np.abs(values)))


def test_a_pin_leans_in_its_seat_until_both_sides_carry_the_same():
    """Forces and moments of contact and seat at the place and lean found, by each law alone: 1e-9."""
    law = HalfSpaceCompliance.of_drive(loose()).pin_law
    delta, theta = np.array([[0.01, 0.02, 0.004]]), np.array([[1e-3, -5e-4, 2e-3]])
    radius = np.full_like(delta, 6.0)
    law = BackedLine(contact=law.contact, seat=law.seat, play=np.full(3, 0.01))
    found, travel, lean = law.solve(delta, theta, radius)
    outside = law.contact.respond(delta - travel, theta - lean, radius)
    inside = law.seat.respond(travel[0], lean[0], np.full(3, 0.01))
    for one in (outside.load[0], inside.load):
        np.testing.assert_allclose(one, found.load[0], rtol=1e-9)
    for one in (outside.moment[0], inside.moment):
        np.testing.assert_allclose(one, found.moment[0], rtol=1e-9)
    # From what was answered, the same answer.
    again = law.respond(delta, theta, radius, found.near)
    np.testing.assert_allclose(again.slice_load, found.slice_load, rtol=1e-8, atol=1e-8)


def test_what_a_lead_keeps_open_carries_nothing():
    """Metal of a lead at the end that tilts away beside a contact that carries: neither side touches, and nothing is singular."""
    law = HalfSpaceCompliance.of_drive(loose()).pin_law
    half = 0.5 * LENGTH
    sloped = replace(law.contact, relief=3e-4 * slice_heights(LENGTH, SLICES) / half)
    law = BackedLine(contact=sloped, seat=law.seat, play=np.full(2, 0.01))
    found = law.respond(np.array([[-7.4e-4, 0.01]]), np.array([[6.4e-4 / half, 0.0]]), np.full((1, 2), 6.0))
    for name in ("load", "moment", "by_approach", "by_tilt", "moment_by_tilt"):
        assert getattr(found, name)[0, 0] == 0.0
    assert found.load[0, 1] > 0.0


def test_a_spring_before_a_neat_seat_is_two_springs():
    """Without play a seat is a spring, even along the width: F = δ/(1/k + c), M = θ w²/12/(1/k + c), to 1e-6 (none is 1 pm)."""
    law = wheel_pin_seat(loose())
    spring, compliance = 2e5, float(law.approach_and_compliance(1.0, 0.0)[1])
    relief = np.zeros((SLICES, 4))
    contact = SeparateSlices(law=SpringLaw(stiffness=spring), length=LENGTH, slices=SLICES, relief=relief)
    both = BackedLine(contact=contact, seat=SlicedSeat.of_law(law, SLICES), play=np.zeros(1))
    delta, theta = np.array([[0.02]]), np.array([[1e-3]])
    found = both.respond(delta, theta, np.ones((1, 1)))
    stiffness = 1.0 / (1.0 / spring + compliance)
    assert found.load[0, 0] == pytest.approx(0.02 * stiffness, rel=1e-6)
    assert found.moment[0, 0] == pytest.approx(1e-3 * stiffness * LENGTH**2 / 12.0, rel=1e-6)


def test_a_sleeve_counts_its_wall_once():
    """A line whose second body is a sleeve, aligned: the plane law less what its own law has of it, to 0.5 % of the approach."""
    overlap = 6.7e-7
    law = SlicedLine(
        length=LENGTH, contact_modulus=MODULUS, slices=SLICES, relief=np.zeros((SLICES, 4)), sleeve=0.5, overlap=overlap
    )
    plane = LineContactLaw(LENGTH, MODULUS)
    load = np.array([100.0, 1000.0, 3000.0])
    approach = plane.approach_at_load(load, np.full(3, 6.0))[0] - overlap * load
    np.testing.assert_allclose(law.respond(approach, np.zeros(3), np.full(3, 6.0)).load, load, rtol=1e-2)


def test_the_most_loaded_end_of_a_seat_follows_from_load_and_moment():
    """From what seats carry at some travels and leans, open at an end and all along, the plane law of their deepest end: 1e-6."""
    law = wheel_pin_seat(loose())
    sliced = SlicedSeat.of_law(law, SLICES)
    travel, lean = np.array([3e-3, 1e-3, 5e-4, 2e-3]), np.array([2e-4, -2e-4, 4e-4, 0.0])
    play = np.full(4, 0.01)
    carried = sliced.respond(travel, lean, play)
    assert (carried.line_load == 0.0).any()
    found = sliced.heaviest(carried.load, carried.moment, play)
    deepest, _ = law.approach_and_compliance(found, play)
    np.testing.assert_allclose(deepest, travel + 5.0 * np.abs(lean), rtol=1e-6)


def test_an_open_pin_beside_metal_at_its_other_end_is_open():
    """A slope of the flank adds metal at one end, the tilt presses the other: a singular matrix ended the run."""
    law = HalfSpaceCompliance.of_drive(loose()).pin_law
    sloped = replace(law.contact, relief=-2e-4 * slice_heights(LENGTH, SLICES))
    law = BackedLine(contact=sloped, seat=law.seat, play=np.full(1, 0.01))
    found = law.respond(np.array([[-0.0019]]), np.array([[-3e-4]]), np.full((1, 1), 2.1))
    assert (found.load[0, 0], found.by_approach[0, 0], found.moment_by_tilt[0, 0]) == (0.0, 0.0, 0.0)


def test_loose_pins_of_a_batch_have_the_leads_of_their_own_drives():
    """Contacts were flattened before their law was asked: each took the lead of another drive. 1e-12, round-off."""
    drives = [loose().with_fields({"disc.lead_crown_drop": drop}) for drop in (1e-3, 6e-3)]
    laws = [HalfSpaceCompliance.of_drive(drive).pin_law for drive in drives]
    both = stack_drives(laws, 1)
    shape, rng = (2, laws[0].play.shape[-1]), np.random.default_rng(2)
    delta, theta, radius = rng.uniform(-0.01, 0.02, shape), 1e-3 * rng.normal(size=shape), np.full(shape, 6.0)
    together = both.respond(delta, theta, radius)
    for row, law in enumerate(laws):
        alone = law.respond(delta[row : row + 1], theta[row : row + 1], radius[row : row + 1])
        for name in ("load", "moment", "by_approach", "slice_load"):
            np.testing.assert_allclose(getattr(together, name)[row], getattr(alone, name)[0], rtol=1e-12, atol=1e-9)


def test_steps_end_where_a_slice_begins_to_carry():
    """A soft slope of the energy and, from a tenth or a thousandth of the step on, one a billion times as stiff."""
    soft, stiff, place = 1.0, 1e9, np.array([0.1, 1e-3, 2.0])
    trials = []

    def move(some, fraction):
        trials.append(some.size)
        beyond = np.maximum(fraction - place[some], 0.0)
        return soft * (fraction - 1.0) + stiff * beyond, soft + stiff * (beyond > 0.0)

    found = shorten_steps(np.full(3, -soft), move)
    # The least of the energy lies where the stiff part takes the slope off: a billionth beyond the place.
    assert found == pytest.approx([0.1, 1e-3, 1.0], rel=1e-5)
    assert len(trials) <= 3 < MAX_TRIALS


def test_what_touches_at_one_end_alone_is_not_sent_far():
    """Both contacts at the same end: turning about it costs nothing, and what is left over there is round-off."""
    half, stiff = 5.0, 1e5
    free = stiff * np.array([[[1.0, half], [half, half**2]]])
    moved, slope = newton_step(np.array([[1e-3, 1e-3 * half + 1e-8]]), free, half)
    step, turn = moved.T
    # Along the stiff mode a thousandth of a newton is 1e-8 mm; the free one is held by a millionth of that stiffness.
    assert abs(step[0] + half * turn[0]) == pytest.approx(1e-8, rel=1e-2)
    assert half * abs(turn[0]) < 1e-7
    assert slope[0] < 0.0


def test_open_pins_beside_metal_of_a_lead_store_nothing():
    """Energies of open contacts of slices that do not feel each other were those of the metal of their lead alone."""
    seat, metal = wheel_pin_seat(loose()), -2e-4 * np.ones((SLICES, 4))
    springs = SeparateSlices(law=SpringLaw(stiffness=1e5), length=LENGTH, slices=SLICES, relief=metal)
    law = BackedLine(contact=springs, seat=SlicedSeat.of_law(seat, SLICES), play=np.full(2, 0.01))
    radius = np.ones((1, 2))
    found = law.respond(np.array([[-0.01, 0.01]]), np.zeros((1, 2)), radius)
    energy = law.energy(found, radius)
    assert (found.load[0, 0], energy[0, 0]) == (0.0, 0.0)
    assert energy[0, 1] > 0.0
