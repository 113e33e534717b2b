"""Free play and backlash of contacts in slices: parts that stand askew close at some height first, and discs lean."""

from __future__ import annotations

from dataclasses import replace
from importlib.resources import files

import numpy as np
import pytest

from ltca.arrays import stack_drives
from ltca.drive.deviations import PlacementErrors
from ltca.drive.members.temperatures import warm_drive
from ltca.drive.single_discs import single_discs
from ltca.geometry.coordinates import WHEEL_ANGLE, X, Y
from ltca.geometry.first_contact import backlash, interference
from ltca.geometry.pairs import ContactGeometry
from ltca.geometry.play import _Disc, free_play
from ltca.geometry.rotation import unit
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive
from ltca.testing.practical_drives import compare

ANGLES = np.array([0.2, 1.1, 2.9, 4.4])
FOUND = 4e-9
"""Where programmes stop: 1e-7 mm of the wheel's way at e z_P = 56 mm, at both stops, rad."""
SLICES = {"contact.slices": 5}
ASKEW = {"pin_wheel.inclination.x": 4e-4, "crank.inclination.y": -3e-4, "disc.lead_slope": 2e-4}


def discs_of(drive):
    return [ContactGeometry.of_drive(one) for one in single_discs(warm_drive(drive))]


def play_of(drive, angles=ANGLES):
    return free_play(discs_of(drive), angles).play


@pytest.fixture(scope="module")
def loose(paper_cases):
    """All clearances, one disc."""
    return paper_cases["CS-3"]


@pytest.fixture(scope="module")
def two_discs():
    (drive,) = load_drive(files("ltca.drives") / "robot-joint.toml").cases.values()
    return drive


@pytest.mark.parametrize(
    "fields",
    [
        {},
        {"disc.lead_crown_drop": 0.01},
        {"disc.lead_relief_length": 2.0, "disc.lead_relief_depth": 0.02},
        {"pin_wheel.pin_profile.crown_drop": 0.01, "crank_bearing.roller_profile.logarithmic_factor": 1.0},
    ],
    ids=["straight", "crowned", "relieved", "profiles"],
)
def test_upright_parts_have_the_play_of_the_plane(loose, fields):
    """Middles touch first, whatever falls short at the ends."""
    np.testing.assert_array_equal(play_of(with_fields(loose, SLICES | fields)), play_of(loose))


def test_discs_that_may_lean_between_upright_parts_gain_nothing_by_it(loose):
    """An inclination of 1e-12 has the programme of leaning discs: 1e-11 mm at the ends."""
    nearly = with_fields(loose, SLICES | {"pin_wheel.inclination.x": 1e-12, "disc.lead_crown_drop": 0.01})
    assert discs_of(nearly)[0].stands_askew
    np.testing.assert_allclose(play_of(nearly), play_of(loose), rtol=0.0, atol=FOUND)


def test_tangents_of_crowned_flanks_are_not_kept(loose):
    """Flanks are not convex: tangents of those that are pressed in their middle took up to 1e-6 rad at two of these positions."""
    play = {"clearance.bearing": 0.1, "clearance.pin_hole": 0.05}
    loose = with_fields(loose, play | {"disc.equidistant_offset": 0.0, "disc.shifting_offset": 0.0})
    angles = np.linspace(0.05, 6.2, 24)
    nearly = with_fields(loose, SLICES | {"pin_wheel.inclination.x": 1e-12, "disc.lead_crown_drop": 0.01})
    np.testing.assert_allclose(play_of(nearly, angles), play_of(loose, angles), rtol=0.0, atol=FOUND)


def test_where_all_parts_lean_alike_the_disc_leans_with_them(two_discs):
    """A frame that is askew as a whole; discs beside its middle are displaced with it."""
    alike = {f"{part}.inclination.{axis}": 6e-4 for part in ("pin_wheel", "pin_shaft", "crank") for axis in "xy"}
    found = play_of(with_fields(two_discs, SLICES | alike))
    np.testing.assert_allclose(found, play_of(two_discs), rtol=0.0, atol=FOUND)


@pytest.mark.slow
def test_cranks_loose_in_their_bearings_lean_with_their_discs():
    """Three cranks, two discs, both bearings with clearance: journals lean by what their bearings are displaced.

    Upright it costs nothing; all alike askew is upright; a wheel askew alone takes play.
    """
    (drive,) = load_drive(files("ltca.drives") / "rv.toml").cases.values()
    loose, angle = with_fields(drive, {"crank.support.clearance": 0.008}), ANGLES[:1]
    plane = play_of(loose, angle)
    alike = {f"{part}.inclination.{axis}": 4e-4 for part in ("pin_wheel", "crank") for axis in "xy"}
    for fields in ({}, alike):
        np.testing.assert_allclose(play_of(with_fields(loose, SLICES | fields), angle), plane, rtol=0.0, atol=FOUND)
    assert np.all(play_of(with_fields(loose, SLICES | {"pin_wheel.inclination.x": 4e-4}), angle) < plane - 1e-5)


def test_a_lead_slope_is_pins_that_are_thicker_by_what_it_rises(vary):
    """Rollers and holes without clearance hold the disc upright, and every pin meets the high end of the flank: s t/2."""
    none = vary(clearance={"bearing": 0.0, "pin_hole": 0.0})
    slope, count = 2e-4, none.pin_wheel.number_of_pins
    sloping = with_fields(none, SLICES | {"disc.lead_slope": slope})
    errors = PlacementErrors(diameter=(slope * none.disc.thickness,) * count)
    thicker = replace(none, pin_wheel=replace(none.pin_wheel, pin_errors=errors))
    np.testing.assert_allclose(play_of(sloping), play_of(thicker), rtol=0.0, atol=FOUND)
    for measure in (lambda discs: backlash(discs, ANGLES, WHEEL_ANGLE), lambda discs: interference(discs[0], ANGLES)):
        # nearest points of the flank are found to round-off
        np.testing.assert_allclose(measure(discs_of(sloping)), measure(discs_of(thicker)), rtol=0.0, atol=1e-13)


def test_of_the_flank_alone_it_is_the_backlash_with_discs_held(vary):
    """A wheel that stands askew about a disc that rollers and holes hold upright."""
    drive = with_fields(
        vary(clearance={"bearing": 0.0, "pin_hole": 0.0}),
        SLICES | {"pin_wheel.inclination.x": 5e-4, "disc.lead_crown_drop": 0.002},
    )
    discs = discs_of(drive)
    found = backlash(discs, ANGLES, WHEEL_ANGLE)
    np.testing.assert_allclose(free_play(discs, ANGLES).play, found, rtol=0.0, atol=FOUND)
    upright = discs_of(with_fields(drive, {"pin_wheel.inclination.x": 0.0}))
    assert np.all(found < 0.999 * backlash(upright, ANGLES, WHEEL_ANGLE))


def test_pins_inclined_along_their_normals_are_a_lead_slope(vary):
    """Of rigid discs held upright; normals turn by some 1e-3 on the way to a stop: 1e-6 of what the slope takes, 5e-5 rad."""
    none, slope, angle = vary(clearance={"bearing": 0.0, "pin_hole": 0.0}), 2e-4, ANGLES[:1]
    (disc,) = discs_of(none)
    normal = disc.flank(angle, np.zeros((1, 4))).gradient[0, :, :2] @ np.array([1.0, 1j])
    lean = -slope * normal * unit(-disc.placement.wheel_rotation(angle))
    errors = PlacementErrors(inclination_x=tuple(-lean.imag), inclination_y=tuple(lean.real))
    inclined = with_fields(replace(none, pin_wheel=replace(none.pin_wheel, pin_errors=errors)), SLICES)
    sloping = with_fields(none, SLICES | {"disc.lead_slope": slope})
    np.testing.assert_allclose(play_of(inclined, angle), play_of(sloping, angle), rtol=0.0, atol=FOUND)


def test_the_mirror_along_the_axis_has_the_same_play(two_discs):
    planes = two_discs.disc.disc_planes
    placed = replace(two_discs, disc=replace(two_discs.disc, planes=planes, gap=0.0))
    first = with_fields(placed, SLICES | ASKEW)
    mirrored = replace(placed, disc=replace(placed.disc, planes=tuple(-plane for plane in planes)))
    second = with_fields(mirrored, SLICES | {field: -value for field, value in ASKEW.items()})
    np.testing.assert_allclose(play_of(first), play_of(second), rtol=0.0, atol=1e-12)  # the same steps, to round-off
    assert np.all(play_of(first) < play_of(two_discs) - 1e-5)


def test_what_falls_short_at_the_ends_gives_back_what_askew_parts_take(loose):
    """Straight flanks have the least play, relieved ones more, and none more than upright parts."""
    askew = SLICES | {"pin_wheel.inclination.x": 2e-3}
    relief = {"disc.lead_relief_length": 1.5, "disc.lead_relief_depth": 0.01}
    straight, relieved = play_of(with_fields(loose, askew)), play_of(with_fields(loose, askew | relief))
    crowned = play_of(with_fields(loose, askew | {"disc.lead_crown_drop": 0.02}))
    assert np.all(straight < relieved)
    assert np.all(relieved < crowned)
    assert np.all(crowned <= play_of(loose) + FOUND)


def test_drives_of_a_batch_keep_their_own_widths(loose):
    """Leads, inclinations and upright parts in one batch; every position takes the steps it takes alone."""
    fields = [ASKEW, {"disc.lead_crown_drop": 0.01, "crank.inclination.x": 5e-4}, {"disc.lead_slope": -4e-4}]
    drives = [with_fields(loose, SLICES | {"disc.lead_crown_drop": 0.0} | one) for one in fields]
    alone = np.concatenate([play_of(drive) for drive in drives])
    stacked = stack_drives([discs_of(drive)[0] for drive in drives], ANGLES.size)
    together = free_play([stacked], np.tile(ANGLES, len(drives))).play
    np.testing.assert_allclose(together, alone, rtol=0.0, atol=FOUND)


def test_a_crank_that_stands_askew_takes_play_of_the_bearing_and_no_more(vary):
    """Half the clearance of the bearing at the ends of the rollers: between that of the whole clearance and that of none."""
    drive = vary(
        disc={"equidistant_offset": 0.02, "shifting_offset": 0.0}, clearance={"bearing": 0.03, "pin_hole": 0.0}
    )
    tight = play_of(replace(drive, clearance=replace(drive.clearance, bearing=0.0)))
    half = 0.5 * 0.03 / drive.roller_length
    askew = play_of(with_fields(drive, SLICES | {"crank.inclination.y": half}))
    assert np.all(askew < play_of(drive))
    assert np.all(askew > tight)


@pytest.mark.slow
@pytest.mark.parametrize(
    "fields",
    [
        ASKEW,
        pytest.param(
            {"disc.lead_crown_drop": 0.01, "pin_wheel.inclination.y": -2e-3}, id="crowned", marks=pytest.mark.nightly
        ),
    ],
)
def test_light_loads_turn_askew_drives_as_far(loose, fields):
    """1 % or 0.005′ (`compare`): the loaded model has no points nearer to an end than 0.007 of the length."""
    found = compare(with_fields(loose, SLICES | fields), ANGLES[1:2])
    assert [one.outcome for one in found] == ["alike"], found


def test_what_bounds_a_leaning_disc_by_arcs_comes_first(loose):
    """Rollers and holes at both of their ends: wherever the disc moves, no gap is more than its tangent says, which may be kept.

    Those of flanks, which come after them, are.
    """
    rows, random = np.arange(ANGLES.size), np.random.default_rng(2)
    geometry = discs_of(with_fields(loose, SLICES | ASKEW))[0]
    disc, here = _Disc(geometry, ANGLES, leans=True), np.zeros((ANGLES.size, geometry.coordinates.size))
    gap, slope, arcs = disc.gaps(rows, here)
    assert arcs == 2 * (loose.crank_bearing.number_of_rollers + loose.number_of_holes)
    assert gap.shape[1] == arcs + 2 * loose.pin_wheel.number_of_pins
    more = []
    for _ in range(20):
        pose = here.copy()
        pose[:, [X, Y]] = random.uniform(-0.3, 0.3, (ANGLES.size, 2))
        more.append(disc.gaps(rows, pose)[0] - gap - np.einsum("bij,bj->bi", slope, pose))
    assert np.max(np.array(more)[..., :arcs]) < 1e-12
    assert np.max(np.array(more)[..., arcs:]) > 1e-4
