"""Contact grids as a compliance: loads and pressures belong to the pose, a returned response stays as it was."""

from __future__ import annotations

from dataclasses import fields, is_dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest

from ltca.analysis.engines import HalfSpace
from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.compliance.response import Start
from ltca.contact.fitted_grid import solve_fitted
from ltca.drive.parts import LengthProfile
from ltca.equilibrium.balance import solve_equilibrium
from ltca.equilibrium.reducer import Reducer
from ltca.geometry.separation import circle_departure, flank_departure
from validation.methods import pressed_grid
from validation.methods.grids import KEPT_CELLS, GridCompliance, KeptPieces

ANGLES = np.array([0.4])


def arrays_of(value):
    """All arrays in nested dataclasses and tuples, in order."""
    if isinstance(value, np.ndarray) and value.dtype != object:
        return [value]
    if is_dataclass(value):
        value = tuple(getattr(value, item.name) for item in fields(value))
    if isinstance(value, tuple | list | np.ndarray):
        return [array for item in value for array in arrays_of(item)]
    return []


@pytest.fixture(scope="module")
def profiled(paper_cases):
    """Crowned pins and logarithmic rollers: patches that end before the bodies do."""
    drive = paper_cases["CS-4"]
    wheel = replace(drive.pin_wheel, pin_profile=LengthProfile(crown_drop=0.01))
    bearing = replace(drive.crank_bearing, roller_profile=LengthProfile(logarithmic_factor=1.0))
    return replace(drive, pin_wheel=wheel, crank_bearing=bearing)


@pytest.fixture(scope="module")
def balanced(paper_cases):
    """The balanced pose on tables."""
    drive = paper_cases["CS-4"]
    return solve_equilibrium(Reducer(discs=(HalfSpaceCompliance.of_drive(drive),)), ANGLES, drive.wheel_moment()).pose


def poses_about(near, count=3, size=1e-3):
    """Poses up to `size` mm about another: contacts open and close, grids change."""
    rng = np.random.default_rng(3)
    return [near + size * rng.normal(size=near.shape) / np.array([1.0, 1.0, 52.0, 56.0]) for _ in range(count)]


def on_grids(drive):
    """A drive of one disc on contact grids, of which none is solved yet."""
    return Reducer(discs=(GridCompliance.of_drive(drive),))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["CS-4", "profiled"])
def test_loads_follow_from_the_pose_alone(paper_cases, profiled, balanced, name):
    """Loads at one pose differed by 0.26 N of 3,500 with what had been solved before."""
    drive = profiled if name == "profiled" else paper_cases[name]
    poses = poses_about(balanced)
    # From nothing, and one after the other in two orders, each starting from what was solved before.
    cold = [on_grids(drive).respond(ANGLES, pose) for pose in poses]
    for order in ((0, 1, 2), (2, 0, 1)):
        grids, start = on_grids(drive), None
        for number in order:
            response = grids.respond(ANGLES, poses[number], start)
            start = Start.after(response)
            expected = cold[number]
            for found, wanted in (
                (response.pin_load, expected.pin_load),
                (response.rollers.outer_load, expected.rollers.outer_load),
                (response.rollers.inner_load, expected.rollers.inner_load),
                (response.force, expected.force),
            ):
                # Round-off of a factorised influence matrix (condition 1e4): measured 4e-11.
                np.testing.assert_allclose(found, wanted, rtol=1e-9, atol=1e-9 * np.max(np.abs(wanted)))
            found, wanted = arrays_of(grids.pressures(response)), arrays_of(grids.pressures(expected))
            for one, other in zip(found, wanted, strict=True):
                np.testing.assert_allclose(one, other, rtol=1e-8, atol=1e-9 * np.max(np.abs(other)))


def test_a_returned_response_never_changes(paper_cases, balanced):
    """The contacts of an earlier answer were pressed again by the next one, and its pressures with them."""
    grids = on_grids(paper_cases["CS-4"])
    first, *others = poses_about(balanced)
    response = grids.respond(ANGLES, first)
    kept = [array.copy() for array in arrays_of(response)]
    pressures = [array.copy() for array in arrays_of(grids.pressures(response))]
    assert len(kept) > 25
    start = Start.after(response)
    for pose in others:
        start = Start.after(grids.respond(ANGLES, pose, start))
    for array, before in zip(arrays_of(response), kept, strict=True):
        np.testing.assert_array_equal(array, before)
    for array, before in zip(arrays_of(grids.pressures(response)), pressures, strict=True):
        np.testing.assert_array_equal(array, before)
    (disc,) = grids.discs
    solved = [piece for kept in disc._kept for pieces in kept._pieces.values() for piece in pieces]
    assert len(solved) > 10
    assert not any(array.flags.writeable for array in arrays_of(tuple(solved)))


@pytest.mark.slow
def test_equilibrium_does_not_depend_on_its_start(paper_cases, balanced):
    """From first contact as from the tables: the same pose to the tolerance of the balance."""
    drive = paper_cases["CS-4"]
    warm = solve_equilibrium(on_grids(drive), ANGLES, drive.wheel_moment(), balanced)
    cold = solve_equilibrium(on_grids(drive), ANGLES, drive.wheel_moment())
    # residuals of 1e-9 of the load on stiffnesses of some load by 10 µm: 1e-11 mm, and the lever arms
    np.testing.assert_allclose(cold.pose, warm.pose, rtol=0.0, atol=1e-11)
    np.testing.assert_allclose(cold.response.pin_load, warm.response.pin_load, rtol=0.0, atol=1e-5)
    assert warm.iterations.max() < cold.iterations.min()


@pytest.mark.slow
def test_contacts_that_tilt_balance_as_on_tables(paper_cases):
    """Two codes of one drive: slices with their coupling, grids of the whole surfaces with the exact flank."""
    drive = paper_cases["CS-1"].with_fields({"contact.slices": 9, "pin_wheel.inclination.x": 2e-4})
    found = {
        name: HalfSpace(method=name).prepare(drive).balance(ANGLES, drive.load.torque) for name in ("tables", "direct")
    }
    tables, direct = found["tables"].response, found["direct"].response
    for name in ("pin_load", "hole_load"):
        before, after = getattr(tables, name), getattr(direct, name)
        # Bound: 1 %; measured 1e-4 of the largest load.
        np.testing.assert_allclose(after, before, atol=1e-3 * before.max())
    assert (
        abs(found["direct"].pose[0, -1] - found["tables"].pose[0, -1]) < 0.2 * np.pi / 180.0 / 3600.0
    )  # measured 0.02″
    by_slices, by_grid = (each.parts[0].leaning_pins.contact for each in (tables, direct))
    carrying = by_slices.load > 0.05 * by_slices.load.max()
    arm = by_slices.load * drive.disc.thickness / 6.0
    assert np.max(np.abs(by_grid.moment - by_slices.moment)[carrying] / arm[carrying]) < 0.02
    # Pressures of direct are those of its grids, ends included; by line loads they are estimates, 1 to 3 % lower there.
    models = [HalfSpace(method=name).prepare(drive).model.discs[0] for name in ("tables", "direct")]
    estimate, off_grids = (
        model.pressures(each.parts[0]).pins for model, each in zip(models, (tables, direct), strict=True)
    )
    np.testing.assert_allclose(estimate.largest[carrying], off_grids.largest[carrying], rtol=0.04)
    # Line loads are means over slices: those at their middles lacked 3 to 4 % of the load, the bulge at the ends.
    total = off_grids.along.line_load.mean(axis=-1) * drive.disc.thickness
    np.testing.assert_allclose(total[carrying], direct.parts[0].pin_load[carrying], rtol=1e-9)
    np.testing.assert_allclose(estimate.mid[carrying], off_grids.mid[carrying], rtol=0.01)


@pytest.fixture
def solved(monkeypatch):
    """Sizes of the contact problems that grids solve, as they are solved."""
    sizes, solve = [], pressed_grid.solve_unilateral_contact

    def counted(influence, penetration, **options):
        sizes.append(penetration.size)
        return solve(influence, penetration, **options)

    monkeypatch.setattr(pressed_grid, "solve_unilateral_contact", counted)
    return sizes


def test_rollers_of_one_radius_were_solved_one_by_one(paper_cases, solved):
    """Twelve contacts with the same separation and approach are one problem, or two where grids are blended."""
    laws = GridCompliance.of_drive(paper_cases["CS-4"]).contact_laws
    approach = np.full((2, 6), 4e-3)
    load, _ = laws.laws[3].load_and_stiffness(approach, laws.inner_radius[0])
    assert 1 <= len(solved) <= 2
    assert load.min() == load.max() > 0.0


def test_pins_are_placed_where_they_touch_the_flank(paper_cases, balanced):
    """A law knew approach and radius alone; the separation of a flank depends on where the pin touches as well."""
    drive = paper_cases["CS-4"]
    grids = GridCompliance.of_drive(drive)
    flank = Reducer(discs=(grids,)).respond(ANGLES, balanced).flank
    pin = int(np.argmax(flank.approach[0]))
    (pins, *_) = grids.contact_laws.placed(flank)
    closed = flank.approach > 0.0
    loads, _ = pins.take(closed.shape, closed).load_and_stiffness(
        flank.approach[closed], flank.effective_radius[closed]
    )
    # The same contact alone, with the separation at its exact place: stations are 1e-4 of a lobe apart.
    theta, radius = flank.parameter[0, pin], drive.pin_wheel.pin_radius
    alone = solve_fitted(
        grids.kinds.pins,
        float(flank.approach[0, pin]),
        float(flank.effective_radius[0, pin]),
        lambda x: flank_departure(grids.geometry.profile, theta, x) + circle_departure(x, radius),
    )
    assert loads.max() == pytest.approx(alone.load, rel=2e-4)  # of another grid: cells differ (1e-4 of the load)


def test_what_grids_keep_grew_with_every_place():
    """A run in time passes a new station of the flank every few steps."""
    kept, most = KeptPieces(), 10
    size = KEPT_CELLS // most
    for place in range(2 * most):
        kept.keep((5.0, float(place)), (SimpleNamespace(active=np.ones(size)),))
        kept.keep((5.0, 0.0), ())  # used all the time
    assert len(kept) == most
    assert [len(kept.start((5.0, float(place)))) for place in (0, 1, most, 2 * most - 1)] == [1, 0, 0, 1]
    (latest,) = kept.start((5.0, 2.0 * most - 1.0))
    kept.keep((5.0, 2.0 * most - 1.0), (latest,))
    assert kept.start((5.0, 2.0 * most - 1.0)) == (latest,)
    # Rollers alike have one separation only: they begin anew.
    for _ in range(most + 1):
        kept.keep((5.0, 0.0), (SimpleNamespace(active=np.ones(size)),))
    assert kept._cells <= KEPT_CELLS
    kept.clear()
    assert (len(kept), kept._cells) == (0, 0)


def test_rollers_of_a_turn_were_solved_again_and_again(paper_cases, solved):
    """The last 32 solutions of a separation were kept, fewer than rollers need in turn: 4,346 problems of rollers for 247."""
    laws = GridCompliance.of_drive(paper_cases["CS-4"]).contact_laws
    approach, radius = np.linspace(1e-3, 5e-3, 60), laws.inner_radius[0]
    first, _ = laws.laws[3].load_and_stiffness(approach, radius)
    count = len(solved)
    again, _ = laws.laws[3].load_and_stiffness(approach, radius)
    assert count > 40
    assert len(solved) == count
    np.testing.assert_array_equal(again, first)
