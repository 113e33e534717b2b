"""Answers in slices are equilibria in six directions per disc, as lines in space and loads of slices alone confirm."""

from dataclasses import replace

import numpy as np
import pytest

from ltca.analysis.engines import HalfSpace
from ltca.analysis.half_width_guard import moments_left_out, steep_tilt_warning
from ltca.equilibrium.output_torque import solve_at_output
from ltca.laws.sliced_contact import slice_heights
from ltca.laws.sliced_line import SlicedLine
from ltca.reading.drive_file import load_drive
from ltca.testing.balance_check import find_imbalance
from ltca.testing.pin_drives import seated_drive, sloping_drive
from ltca.testing.random_drives import tilted_reducer
from ltca.testing.slice_law import plane_approach, pressed_in
from ltca.testing.width_check import Lines, WidthCheck
from ltca.testing.yielding_pins import beam_stiffness


def solved(drive, angle):
    model = HalfSpace().prepare(drive).model
    return model, solve_at_output(model, [drive], np.array([angle]), drive.load.torque)


@pytest.fixture(scope="module")
def paper():
    """The paper's drive with a slope of its flank and an inclined wheel."""
    fields = {"contact.slices": 5, "disc.lead_slope": 2e-4, "pin_wheel.inclination": {"x": 2e-4, "y": 1e-4}}
    drive = load_drive("paper").cases["CS-4"].with_fields(fields)
    model, found = solved(drive, 0.7)
    assert find_imbalance(drive, model, found, torque=drive.load.torque) == []
    return drive, model, found


@pytest.mark.parametrize("coordinate", range(6))
def test_the_check_sees_a_wrong_pose(paper, coordinate):
    """1 % of the largest approach off at the pins, in any coordinate, leans included."""
    drive, model, found = paper
    lever = np.array([1.0, 1.0, 52.0, 5.0, 5.0, 56.0])[coordinate]
    pose = found.pose.copy()
    pose[0, coordinate] += 1e-4 / lever
    assert any("gap" in problem for problem in find_imbalance(drive, model, replace(found, pose=pose)))


@pytest.mark.parametrize("kind", ["leaning_pins", "leaning_holes"])
def test_the_check_sees_loads_moved_along_the_width(paper, kind):
    """Loads of one pair turned end for end: moments about x and y change, and forces by what normals turn along the width."""
    drive, model, found = paper
    part = found.response.parts[0]
    pairs = getattr(part, kind)
    line = pairs.contact.line_load.copy()
    number = int(np.argmax(pairs.contact.load[0]))
    line[0, number] = line[0, number, ::-1, ::-1]
    turned = replace(part, **{kind: replace(pairs, contact=replace(pairs.contact, line_load=line))})
    wrong = replace(found, response=replace(found.response, parts=(turned,)))
    left = {one.what: one.left for one in WidthCheck(drive, model, wrong, 0).measured(None)}
    moments, forces = left["disc 0: moments about x and y left"], left["disc 0: forces along x and y left"]
    assert moments > 0.1 * abs(pairs.contact.moment[0, number])
    assert forces < 1e-3 * moments / (0.5 * drive.disc.thickness)
    assert any("moments about x and y" in problem for problem in find_imbalance(drive, model, wrong))


def test_what_is_taken_off_is_of_the_square_in_forces_and_of_the_first_power_in_moments():
    """The same line loads on pins that lean half as much leave a quarter out of forces and half of moments, to 2 % (next power).

    A first order of normals that were wrong would be left out of forces with the first power.
    """
    fields = {"contact.slices": 5, "pin_wheel.inclination": {"x": 4e-3, "y": 0.0}}
    drive = load_drive("paper").cases["CS-4"].with_fields(fields)
    model, found = solved(drive, 0.7)
    left = []
    for part in (1.0, 0.5):
        disc = WidthCheck(drive, model, found, 0).each[0]
        lines = disc.wheel_pins
        disc.wheel_pins = Lines(at=lines.at, lean=disc.lean + part * (lines.lean - disc.lean))
        _, steep = disc.on_flank[0]
        left.append((np.abs(steep.force), np.abs(steep.couple)))
    number = int(np.argmax(left[0][0]))
    assert left[0][0][number] > 1e-6 * found.response.pin_load[0, number]
    assert left[1][0][number] == pytest.approx(left[0][0][number] / 4.0, rel=0.02)
    assert left[1][1][number] == pytest.approx(left[0][1][number] / 2.0, rel=0.02)


@pytest.mark.parametrize("slices", [3, 9, 17])
def test_line_loads_by_the_formula_alone(slices):
    """From an aligned line to a corner that carries alone, crowned and not: approaches of quadratures of the kernel.

    1e-6 of the deepest gap: the shipped curves are interpolated to 1e-7.
    """
    length, modulus, radius = 12.0, 1.1e5, np.array([5.0, 8.0, 3.0, 20.0])
    z = slice_heights(length, slices)
    approach, tilt = np.array([0.01, 0.005, 0.002, 0.02]), np.array([0.0, 1e-3, 3e-4, -4e-3])
    law = SlicedLine(
        length=length, contact_modulus=modulus, slices=slices, relief=0.002 * (2.0 * z / length) ** 2 * (slices > 3)
    )
    found = law.respond(approach, tilt, radius)
    gap = approach[:, None, None] + tilt[:, None, None] * z - law.relief
    deepest = gap.max(axis=(1, 2))
    gap = gap - pressed_in(found.slice_load, length, modulus, radius)[..., None]
    carries = found.line_load > 0.0
    needed = plane_approach(np.where(carries, found.line_load, 1.0), length, modulus, radius[:, None, None])
    assert np.max(np.where(carries, np.abs(needed - gap), 0.0).max(axis=(1, 2)) / deepest) < 1e-6
    assert np.max(np.where(carries, -1.0, gap)) <= 0.0
    assert not carries.all()


def check_seeds(draw, seeds):
    for seed in seeds:
        drawn = draw(seed)
        if drawn is not None:
            drive, angle = drawn
            model, found = solved(drive, angle)
            assert find_imbalance(drive, model, found, torque=drive.load.torque) == [], seed


def test_rollers_that_touched_at_their_ends_start_anew():
    """The place of a roller as a part of an overlap of next to nothing sent it 700 m away in the next step."""
    check_seeds(sloping_drive, [19])


def test_flanks_whose_paths_are_narrow_at_roots():
    """A pin beside a root keeps its distance on a path of 0.02 mm, where differences over 3e-4 mm gave normals 2e-4 off."""
    check_seeds(tilted_reducer, [124])


def test_moments_on_the_wheel_are_about_its_axis():
    """Where a disc leans against the wheel couples have a moment about the axis of one, and none about the other's."""
    check_seeds(tilted_reducer, [214])


@pytest.mark.slow
def test_rollers_without_load_stand_free_along_their_rays():
    """Gaps along the normal in the bore told 1e-9 mm of overlap where a roller that leans as it likes is open."""
    check_seeds(tilted_reducer, [545])


@pytest.mark.slow
def test_steep_parts_balance_as_linear_tilts_have_it():
    """A pin beside a root, on whose path of 0.02 mm a tilt of 0.5 mrad across its normal turns this by 6° along the width.

    Forces of sections as they stand are some 0.1 % of the load beside those of linear gaps and moments more than 1 %: the check
    takes them off, and the run tells of them. Both have own sums of the moments, the run's to first order and by the loads of
    pins alone.
    """
    drive, angle = tilted_reducer(288)
    model, found = solved(drive, angle)
    check = WidthCheck(drive, model, found, 0)
    assert check.problems(drive.load.torque) == []
    forces, moments = check.left_out
    assert 1e-4 < forces < 1e-2  # beside a root it follows the loads steeply
    half = 0.5 * drive.disc.thickness
    told = moments_left_out(found.response, half)[0].max()
    assert told == pytest.approx(moments, rel=0.2)
    assert "normals turn along the width" in steep_tilt_warning(model.coordinates, found, half)


@pytest.mark.nightly
def test_soft_pins_settle_each_by_itself():
    """Wheel pins of 1 mm on 33 mm under three discs: steps of all pins, as long as the worst of them allowed, went nowhere.

    With the wheel wound up by 2 mrad and the discs in their middles they stand where their beams bend under what presses on them,
    by unit loads: 1e-8 of the largest, as contacts of 1e5 N/mm make 1e-12 mm on beams of 16 N/mm.
    """
    drive, angle = sloping_drive(39)
    model = HalfSpace().prepare(replace(drive, contact=replace(drive.contact, slices=3))).model
    pose = np.zeros((1, model.coordinates.size))
    pose[0, -1] = -2e-3
    response = model.respond(np.array([angle]), pose)
    wheel, discs = drive.pin_wheel, drive.disc.number_of_discs
    pressed = [part.pin_forces[0] for part in response.parts] + [part.pin_moments[0] for part in response.parts]
    forces = np.stack(pressed)[:, : wheel.number_of_pins]
    forces *= np.exp(-1j * (angle * drive.tooth_number_difference / wheel.number_of_pins + pose[0, -1]))
    moved = np.linalg.solve(beam_stiffness(drive, wheel, drive.materials.wheel_pin, slopes=True), forces)[:discs]
    assert np.abs(moved).max() > 0.02
    assert np.abs(response.shifts[0, :discs, : wheel.number_of_pins] - moved).max() < 1e-8 * np.abs(moved).max()


@pytest.mark.slow
@pytest.mark.parametrize(
    "seeds", [(1, 10, 31), pytest.param((4, *range(11, 31), *range(32, 62)), marks=pytest.mark.nightly)]
)
def test_tilted_reducers(seeds):
    """Slices, leads and inclinations of one to three discs; ``benchmarks/random_drives.py --tilted`` runs more."""
    check_seeds(tilted_reducer, seeds)


@pytest.mark.slow
@pytest.mark.parametrize("seeds", [(1, 4), pytest.param((2, 8, 9, 13, 26, *range(40, 90)), marks=pytest.mark.nightly)])
def test_sloping_reducers(seeds):
    """Beams, supports and wheels that tilt besides; ``benchmarks/random_drives.py --sloping`` runs more.

    Seed 4 has contacts narrower than the table of softer ends reaches, beyond which it goes straight on. In seed 1 forces press a
    displaced housing, whose moment the check had with the wrong sign; its ring forces were off by a thousandth of the load while
    pins were displaced by what the normals of the middle press.
    """
    check_seeds(sloping_drive, seeds)


@pytest.mark.slow
def test_cranks_without_load_stand_anywhere_in_their_clearance():
    """A crank whose rollers carry nothing floats in its bearings: the check had it in their middles and told of 0.015 mm.

    What it may take is the clearance, no more: the same answer beside bearings of a tenth of it is told of.
    """
    drive, angle = seated_drive(7040)
    model, found = solved(drive, angle)
    assert find_imbalance(drive, model, found, torque=drive.load.torque) == []
    support = replace(drive.crank.support, clearance=0.1 * drive.crank.support.clearance)
    tight = WidthCheck(replace(drive, crank=replace(drive.crank, support=support)), model, found, 0)
    assert any("crank 1: a bearing without load out of its clearance" in one for one in tight.problems(None))


@pytest.mark.slow
@pytest.mark.parametrize("seeds", [(0, 1, 2), pytest.param(range(3, 30), marks=pytest.mark.nightly)])
def test_seated_reducers(seeds):
    """Loose pins and sleeves besides, in forces and moments; ``benchmarks/random_drives.py --seated`` runs more.

    Leads that keep contacts on sleeves open made one of three stop at a singular matrix.
    """
    check_seeds(seated_drive, seeds)
