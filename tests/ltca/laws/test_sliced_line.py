"""Contacts in slices: they settle, their loads and moments have one energy, and they agree with the law of aligned lines."""

from __future__ import annotations

import numpy as np
import pytest
from refusals import error_says

from ltca.errors import ConvergenceError
from ltca.laws.line_contact import LineContactLaw
from ltca.laws.plane_strain import PlaneContactLaw
from ltca.laws.sliced_contact import SlicedContact, slice_heights
from ltca.laws.sliced_line import DATUM, SlicedLine

LENGTH, MODULUS = 10.0, 100e3
SLICES = (3, 5, 9, 17, 33)


def wild(slices, seed, count=120):
    """Contacts from a touch to a corner that carries alone: line with some relief, and δ, θ, ρ whose half-width is at most
    twice the length of a slice."""
    random = np.random.default_rng(seed)
    deepest = np.exp(random.uniform(np.log(1e-6), np.log(0.05), count))
    z = slice_heights(LENGTH, slices)
    relief = (
        random.choice([0.0, 1.0]) * np.median(deepest) * np.exp(random.normal()) * (2.0 * z / LENGTH) ** 2
        + random.choice([0.0, 1.0]) * np.median(deepest) * (np.maximum(np.abs(z) - 0.35 * LENGTH, 0.0) / 1.5) ** 2
        + random.choice([0.0, 1.0]) * random.normal() * 1e-3 * z
    )
    tilt = random.choice([0.0, 1.0, -1.0], count) * deepest / LENGTH * np.exp(random.uniform(-3.0, 3.0, count))
    # Deep where the line is deepest, wherever that is.
    shape = tilt[:, None, None] * z - relief
    approach = deepest - shape.max(axis=(1, 2))
    widest = 2.0 * LENGTH / slices
    radius = np.minimum(np.exp(random.uniform(np.log(0.1), np.log(300.0), count)), widest**2 / (0.7 * deepest))
    # Within the tables, from a ten-thousandth of a slice: below they go on straight, and derivatives turn by 1e-7 there.
    radius = np.maximum(radius, (5e-3 * LENGTH / slices) ** 2 / deepest)
    return SlicedLine(length=LENGTH, contact_modulus=MODULUS, slices=slices, relief=relief), approach, tilt, radius


@pytest.mark.family(quick=1)
@pytest.mark.parametrize("slices", SLICES)
def test_wild_contacts_settle_to_round_off(slices):
    law = PlaneContactLaw(thickness=1.0, contact_modulus=MODULUS, datum=DATUM * LENGTH)
    for seed in range(6):
        line, approach, tilt, radius = wild(slices, seed)
        found = line.respond(approach, tilt, radius)
        for positive in (found.load, found.by_approach, found.moment_by_tilt):
            assert np.all(positive > 0.0)
        # A second start leaves the same answer: the loads of the neighbour, as in an iteration of the balance.
        again = line.respond(approach, tilt, radius, start=np.roll(found.near, 1, axis=0))
        # measured: 2e-13 of the load, what the square of the last step leaves
        np.testing.assert_allclose(again.load, found.load, rtol=1e-11)
        np.testing.assert_allclose(again.moment, found.moment, rtol=1e-11, atol=1e-11 * LENGTH * found.load.max())
        # The points obey the plane law at one and the same u of their slice.
        free = approach[:, None, None] + tilt[:, None, None] * slice_heights(LENGTH, slices) - line.relief
        own = law.approach_at_load(found.line_load, radius[:, None, None])[0]
        pressed = found.line_load > 1e-3 * found.line_load.max(axis=(1, 2), keepdims=True)
        shift = np.where(pressed, free - own, np.nan)
        with np.errstate(invalid="ignore"):
            every = np.nan_to_num(np.fmax.reduce(shift, axis=2) - np.fmin.reduce(shift, axis=2))
        assert np.max(every / own.max(axis=(1, 2))[:, None]) < 1e-9


def test_slices_that_opened_on_the_way_pulled():
    """-5e-19 N/mm of one slice made the largest roller pressure of a study no number, and its summary no JSON."""
    stiffness, z = 1e4, slice_heights(LENGTH, 5)
    approach, tilt = np.array([[3e-3]]), np.array([[1e-3]])
    deep = approach[..., None, None] + tilt[..., None, None] * z
    held = SlicedContact.of_separate(
        approach, tilt, stiffness * np.maximum(deep, 0.0), stiffness * (deep > 0.0), LENGTH
    )
    back = np.array([[-2e-3]])
    moved = held.moved(back, np.zeros((1, 1)), np.zeros((1, 2, 1)), LENGTH)
    np.testing.assert_allclose(held.slice_load[0, 0], [0.0, 20.0, 60.0, 100.0, 140.0], rtol=1e-12)
    for after in (moved.slice_load, moved.line_load):
        assert np.all(after >= 0.0)
    # 20 N for each micrometre of the middle of a slice, of 2 mm; the second was 1 µm deep, the others 3, 5 and 7 µm.
    np.testing.assert_allclose(moved.slice_load[0, 0], [0.0, 0.0, 20.0, 60.0, 100.0], rtol=1e-12)


@pytest.mark.family(quick=1)
@pytest.mark.parametrize("slices", SLICES)
def test_derivatives_energy_and_maxwell(slices):
    compared = 0
    for seed in range(6):
        line, approach, tilt, radius = wild(slices, seed)
        found = line.respond(approach, tilt, radius)
        depth = (approach[:, None, None] + tilt[:, None, None] * slice_heights(LENGTH, slices) - line.relief).max(
            (1, 2)
        )
        step = 1e-3 * depth
        smooth = np.ones(approach.size, dtype=bool)

        def differences(by_approach, by_tilt, place=(line, approach, tilt, radius, step, smooth, found)):
            line, approach, tilt, radius, step, smooth, found = place
            total = np.zeros((3, approach.size))
            # Fourth order: what is left, 1e-12, is that of round-off.
            for far, weight in ((1, 8.0), (-1, -8.0), (2, -1.0), (-2, 1.0)):
                there = line.respond(
                    approach + far * by_approach * step, tilt + far * by_tilt * step, radius, start=found.near
                )
                moved = np.abs(there.line_load - found.line_load)
                smooth &= (moved <= 0.05 * found.line_load).all(axis=(1, 2))
                total += weight * np.stack((there.load, there.moment, line.energy(there, radius)))
            return total / (12.0 * step)

        by_approach, by_tilt = differences(1.0, 0.0), differences(0.0, 1.0 / LENGTH) * LENGTH
        some = np.flatnonzero(smooth)
        compared += some.size
        stiff = found.by_approach[some]
        scale = np.array((1.0, LENGTH))[:, None]
        # Derivatives are those before the last step, 1e-8 of the loads away: within 1e-6 where contacts bend most.
        error = np.abs(by_approach[:2] - np.stack((found.by_approach, found.by_tilt)))[:, some]
        assert np.max(error / scale / stiff) < 1e-6
        error = np.abs(by_tilt[:2] - np.stack((found.by_tilt, found.moment_by_tilt)))[:, some]
        assert np.max(error / scale / LENGTH / stiff) < 1e-6
        # Loads and moments are those of one energy, M ∂δ = F ∂θ.
        assert np.max(np.abs(by_approach[2] / found.load - 1.0)[some]) < 1e-8
        assert np.max(np.abs(by_tilt[2] - found.moment)[some] / (LENGTH * found.load[some])) < 1e-8
        assert np.max(np.abs(by_tilt[0] - by_approach[1])[some] / (LENGTH * stiff)) < 1e-8
    assert compared > 200  # in the others points open or close nearby


def test_mirror_and_units():
    line, approach, tilt, radius = wild(9, 2)
    found = line.respond(approach, tilt, radius)
    mirrored = SlicedLine(length=LENGTH, contact_modulus=MODULUS, slices=9, relief=line.relief[::-1, ::-1])
    back = mirrored.respond(approach, -tilt, radius)
    np.testing.assert_allclose(back.load, found.load, rtol=1e-11)
    np.testing.assert_allclose(back.moment, -found.moment, atol=1e-11 * LENGTH * found.load.max())
    inch = SlicedLine(length=LENGTH / 25.4, contact_modulus=MODULUS, slices=9, relief=line.relief / 25.4)
    np.testing.assert_allclose(inch.respond(approach / 25.4, tilt, radius / 25.4).load * 25.4**2, found.load, rtol=1e-9)


def test_contacts_do_not_know_of_each_other():
    """One far beyond the table of the plane law moved the others by 1e-5."""
    line = SlicedLine(length=LENGTH, contact_modulus=MODULUS, slices=3, relief=np.zeros((3, 4)))
    alone = line.respond(np.array([0.01]), np.array([1e-4]), np.array([5.0]))
    crowd = line.respond(np.array([0.01, 1e-18, 5.0]), np.array([1e-4, 0.0, 0.0]), np.array([5.0, 1e-3, 30.0]))
    assert crowd.load[0] == pytest.approx(alone.load[0], rel=1e-14)  # sums in another order
    nothing = line.respond(np.array([-0.01]), np.array([1e-4]), np.array([5.0]))
    assert nothing.load[0] == 0.0
    assert not nothing.line_load.any()


def test_reliefs_of_a_batch_of_drives():
    z = slice_heights(LENGTH, 5)
    crowns = np.array([0.0, 5e-3])[:, None, None] * (2.0 * z / LENGTH) ** 2
    approach, tilt = np.array([[0.01, 0.002], [0.01, 0.002]]), np.array([1e-3, -1e-4])
    batch = SlicedLine(length=LENGTH, contact_modulus=MODULUS, slices=5, relief=crowns)
    found = batch.respond(approach, tilt, np.full(2, 5.0))
    for number in range(2):
        own = SlicedLine(length=LENGTH, contact_modulus=MODULUS, slices=5, relief=crowns[number])
        np.testing.assert_allclose(
            found.load[number], own.respond(approach[number], tilt, np.full(2, 5.0)).load, rtol=1e-12
        )


def test_aligned_lines_have_the_load_of_the_line_law():
    """Whatever the number of slices: the softer ends were those of nine, and 33 slices of a line of L/b = 14 carried 2 % more.

    3e-4 down to L/b of 10 and slices of a fifth of b: what the spline of the ends misses of the line law, 6e-5 with nine slices.
    """
    law = LineContactLaw(LENGTH, MODULUS)
    for slices in (3, 5, 7, 9, 13, 17, 33, 49, 65):
        line = SlicedLine(length=LENGTH, contact_modulus=MODULUS, slices=slices, relief=np.zeros((slices, 4)))
        slenderness = np.array([1000.0, 300.0, 100.0, 30.0, 20.0, 10.0])
        approach = LENGTH**2 / slenderness[slenderness > slices / 5.0] ** 2 / 5.0
        radius = np.full(approach.size, 5.0)
        found = line.respond(approach, np.zeros(approach.size), radius)
        given = law.load_and_stiffness(approach, radius)[0]
        np.testing.assert_allclose(found.load, given, rtol=1.5e-4 if slices == 9 else 3e-4)


@pytest.mark.parametrize(
    ("middle", "tilt", "drop", "least"),
    [
        pytest.param(1.0, np.linspace(0.1, 0.9, 20), 0.0, 1.4, id="both ends carry"),
        pytest.param(0.5, np.linspace(0.7, 2.0, 20), 0.0, 1.8, id="one end carries"),
        pytest.param(1.0, np.linspace(0.5, 1.5, 20), 3.0, 2.6, id="crowned"),
    ],
)
def test_tilted_lines_converge(middle, tilt, drop, least):
    """From 5, 9 and 17 slices to 33 of lines of L/b = 232: load and moment move less by a factor each time the slices are halved.

    Of first order without a crown, of second with one, where the end of the contact falls anywhere within a slice: the root of
    the mean square over twenty tilts (`benchmarks/width.py --order`).
    """
    length, deep, radius, answers = 12.0, 3e-3, np.full(20, 3.0), []
    for slices in (5, 9, 17, 33):
        z = slice_heights(length, slices)
        relief = drop * deep * (2.0 * z / length) ** 2
        line = SlicedLine(length=length, contact_modulus=115e3, slices=slices, relief=relief)
        found = line.respond(np.full(20, middle * deep), 2.0 * tilt * deep / length, radius)
        answers.append(np.stack((found.load, 6.0 * found.moment / length)) / found.load)
        answers[-1][0] = found.load / radius
    scale = answers[-1][0]
    moved = [np.concatenate(((one[0] - answers[-1][0]) / scale, one[1] - answers[-1][1])) for one in answers[:-1]]
    size = [float(np.sqrt(np.mean(each**2))) for each in moved]
    assert size[0] > least * size[1]
    assert size[1] > least * size[2]


def test_a_touch_of_nothing_is_open():
    """Squares of the loads of a roller 1e-165 mm in vanished, and one 1e-20 mm in never balanced."""
    line = SlicedLine(length=12.0, contact_modulus=MODULUS, slices=9, relief=np.zeros((9, 4)))
    found = line.respond(np.array([1e-165, 1e-20, 1e-12]), np.zeros(3), np.full(3, 2.0))
    np.testing.assert_array_equal(found.load > 0.0, [False, False, True])


def test_slices_much_narrower_than_the_contact_are_told():
    line = SlicedLine(length=LENGTH, contact_modulus=MODULUS, slices=65, relief=np.zeros((65, 4)))
    with error_says(ConvergenceError, "contact.slices = 65: ", " choose at most ") as caught:
        line.respond(np.array([0.05]), np.array([0.0]), np.array([100.0]))
    most = int(str(caught.value).partition(" choose at most ")[2].partition(";")[0])
    assert 3 <= most < 65


@pytest.mark.parametrize("overlap", [2e-7, 6.7e-7])
def test_energy_less_a_wall_that_counts_twice(overlap):
    """Loads and moments are slopes of the energy where the compliance of a sleeve's wall is subtracted, up to its bound."""
    relief = 1e-5 * slice_heights(LENGTH, 9) ** 2
    line = SlicedLine(length=LENGTH, contact_modulus=MODULUS, slices=9, relief=relief, sleeve=0.5, overlap=overlap)
    radius, step = np.full(3, 6.0), 1e-6
    approach, tilt = np.array([2e-3, 8e-3, 0.03]), np.array([0.0, 3e-4, 1e-3])

    def slope(by_approach, by_tilt):
        up, down = (
            line.respond(approach + way * by_approach, tilt + way * by_tilt, radius, start=here.near)
            for way in (1.0, -1.0)
        )
        return (line.energy(up, radius) - line.energy(down, radius)) / 2.0

    here = line.respond(approach, tilt, radius)
    np.testing.assert_allclose(slope(step, 0.0) / step, here.load, rtol=1e-6)
    turn = step / LENGTH
    np.testing.assert_allclose(slope(0.0, turn) / turn, here.moment, rtol=1e-6, atol=1e-6 * LENGTH * here.load.max())
