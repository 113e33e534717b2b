"""Every crank bearing over the duty: whose it is, whose load stands to it, Miner, speeds, lubricant, static safety."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from refusals import error_says

import ltca.analysis.life.bearing_lives as module
import ltca.analysis.life.passages as passages
from ltca.analysis.engines import Hybrid, PlaneStrain
from ltca.analysis.life.bearing_lives import (
    EntryLoads,
    bearing_lives,
    entry_loads,
    lives_of_entries,
    lives_over,
    passages_of_duty,
)
from ltca.analysis.life.laminae import EvenLaminae, SolvedLaminae
from ltca.analysis.life.life_text import life_content, life_lines, life_summary
from ltca.analysis.life.modification import reference_viscosity
from ltca.analysis.life.passages import laminae_of, roller_passages
from ltca.analysis.loaded_analysis import analyse
from ltca.drive.parts import contact_modulus
from ltca.errors import ConvergenceError, DriveError
from ltca.geometry.coordinates import DISC_ROTATION
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import parse_drive, shipped_drive

TURN = 2.0 * np.pi * np.arange(60) / 60


@pytest.fixture(scope="module")
def papers(paper_cases):
    return analyse(paper_cases["CS-3"], TURN)


@pytest.fixture(scope="module")
def rv():
    return parse_drive(shipped_drive("rv"), "rv").cases["nominal"]


@pytest.fixture(scope="module")
def rvs(rv):
    return analyse(rv, TURN)


def power_mean(load, power):
    return float(np.mean(load**power)) ** (1.0 / power)


@pytest.fixture
def even(monkeypatch):
    """Even loads over the length without edges: what is left is who turns to what."""
    plain = EvenLaminae(edges=False)
    monkeypatch.setattr(passages, "laminae_of", lambda analysis: (plain, plain))


@pytest.mark.usefixtures("even")
def test_a_central_crank_stands_to_its_load_and_the_bore_goes_round(paper_cases):
    """The means change places against a usual bearing: 4.5 on the inner race, 4 in the bore."""
    analysis = analyse(paper_cases["CS-3"], 2.0 * np.pi * np.arange(36 * 5) / 36)
    rollers, found = analysis.full.response.rollers, bearing_lives(analysis).shortest
    # the load nods by a few degrees about the crank
    assert found.inner_load == pytest.approx(power_mean(rollers.inner_load, 4.5), rel=1e-3)
    assert found.outer_load == pytest.approx(power_mean(rollers.outer_load, 4.0), rel=1e-3)
    # the other reading is 4.6 % away
    assert power_mean(rollers.inner_load, 4.5) > 1.04 * power_mean(rollers.inner_load, 4.0)


@pytest.mark.slow
@pytest.mark.usefixtures("even")
def test_one_turn_is_nearly_enough(paper_cases, papers):
    """What `cyclo run` has; of 11 rollers one turn leaves 0.7 % of the load in the bore, where it does most."""
    many = bearing_lives(analyse(paper_cases["CS-3"], 2.0 * np.pi * np.arange(36 * 5) / 36)).shortest
    assert bearing_lives(papers).shortest.life == pytest.approx(many.life, rel=0.01)


def test_what_turns_to_what_in_the_analysis(papers):
    """At a place of the inner race the push stays, at one of the bore it comes and goes."""
    rollers = papers.full.response.rollers
    push = (rollers.outer_load * rollers.outer_direction).sum(axis=1)
    in_crank = np.angle(push * np.exp(-1j * TURN))
    in_disc = np.unwrap(np.angle(push * np.exp(-1j * papers.full.pose[:, DISC_ROTATION])))
    assert np.ptp(in_crank) < np.radians(10.0)  # turns with the crank
    assert in_disc[-1] - in_disc[0] > np.radians(340.0)  # goes round in the disc


@pytest.mark.slow
@pytest.mark.usefixtures("even")
def test_on_a_carrier_neither_race_stands(rvs):
    """Between the means with 4 and 4.5 of all loads, clear of both, on either race of all six bearings."""
    for disc, single in enumerate(rvs.discs):
        rollers = single.full.response.rollers
        for crank in range(3):
            found = bearing_lives(rvs).bearings[3 * disc + crank]
            assert (found.disc, found.crank) == (disc, crank)
            for load, all_loads in ((found.inner_load, rollers.inner_load), (found.outer_load, rollers.outer_load)):
                own = np.split(all_loads, 3, axis=1)[crank]
                low, high = power_mean(own, 4.0), power_mean(own, 4.5)
                assert low + 0.03 * (high - low) < load < high - 0.03 * (high - low)


@pytest.mark.slow
@pytest.mark.usefixtures("even")
def test_every_bearing_is_rated_and_the_shortest_named(rv, rvs):
    found = bearing_lives(rvs)
    assert [(bearing.disc, bearing.crank) for bearing in found.bearings] == [(d, c) for d in (0, 1) for c in (0, 1, 2)]
    assert found.shortest.life == min(bearing.life for bearing in found.bearings)
    force = np.hypot(rvs.bearing_radial, rvs.bearing_tangential).max(axis=0)
    assert [bearing.static_load for bearing in found.bearings] == pytest.approx(force.ravel().tolist(), rel=1e-12)
    assert found.static_safety == pytest.approx(found.static_load_rating / force.max(), rel=1e-12)
    # one with a wider bore carries later and less, and is the one that is not named
    loose = analyse(with_fields(rv, {"disc.of.1.bore_errors.radial": (0.02, 0.0, 0.0)}), TURN)
    uneven = bearing_lives(loose)
    own = [single.full.response.rollers.inner_load for single in loose.discs]
    rows = [part for own_rows in own for part in np.split(own_rows, 3, axis=1)]
    for bearing, rollers in zip(uneven.bearings, rows, strict=True):
        # one turn leaves some thousandths
        assert 0.998 * power_mean(rollers, 4.0) < bearing.inner_load < 1.002 * power_mean(rollers, 4.5)
    lives = [bearing.life for bearing in uneven.bearings]
    assert np.argmin(lives) == np.argmax([rollers.max() for rollers in rows])
    assert max(lives) > 1.2 * min(lives)


@pytest.mark.slow
@pytest.mark.usefixtures("even")
def test_a_bearing_of_several_cranks_against_a_count_of_what_passes(rv):
    """The rollers that pass at 45 places of either race over 20 turns, one by one; then the standard's own sum.

    Places of 8° and some three hundred rollers each leave 3e-3 of a load, which is 1.2 % of a life.
    """
    turns = 2.0 * np.pi * np.arange(20 * 48) / 48.0
    analysis = analyse(rv, turns)
    found = bearing_lives(analysis)
    disc, crank, single = 1, 2, analysis.discs[1]
    rollers, count = single.full.response.rollers, rv.crank_bearing.number_of_rollers
    own = slice(crank * count, (crank + 1) * count)
    angle = np.angle(rollers.outer_direction[:, own])
    equivalent = []
    for load, place in (
        (rollers.inner_load[:, own], angle - turns[:, None]),  # the crank turns, the disc only shifts on its carrier
        (rollers.outer_load[:, own], angle),
    ):
        bins = (np.mod(place, 2.0 * np.pi) / (2.0 * np.pi) * 45).astype(int) % 45
        passed, damage = (np.bincount(bins.ravel(), weights=w.ravel()) for w in (np.ones(load.shape), load**4))
        equivalent.append(np.mean((damage / passed) ** 1.125) ** (1.0 / 4.5))
    spent = sum(
        (load / rated) ** 4.5
        for load, rated in zip(equivalent, (found.ratings.inner, found.ratings.outer), strict=True)
    )
    (bearing,) = [one for one in found.bearings if (one.disc, one.crank) == (disc, crank)]
    assert bearing.inner_load == pytest.approx(equivalent[0], rel=3e-3)
    assert bearing.outer_load == pytest.approx(equivalent[1], rel=3e-3)
    assert bearing.life == pytest.approx(spent ** (-8.0 / 9.0), rel=0.012)


def loads(drive, torque, speed, share, inner=1000.0, outer=900.0, force=8000.0):
    shape = (drive.disc.number_of_discs, drive.crank.number)
    return EntryLoads(
        torque=torque,
        speed=speed,
        share=share,
        inner=np.full(shape, inner),
        outer=np.full(shape, outer),
        largest_force=np.full(shape, force),
    )


def test_miner_by_hand(paper_cases):
    """A fifth of the time at twice the load and half the speed: 1/9 of the turns, each sixteen times as dear."""
    drive = paper_cases["CS-1"]
    light = lives_of_entries(drive, [loads(drive, 1e5, 1000.0, 1.0)]).shortest
    both = lives_of_entries(
        drive,
        [loads(drive, 1e5, 1000.0, 0.8), loads(drive, 2e5, 500.0, 0.2, inner=2000.0, outer=1800.0, force=16_000.0)],
    ).shortest
    assert [entry.turns for entry in both.entries] == pytest.approx([8.0 / 9.0, 1.0 / 9.0], rel=1e-12)
    assert both.life == pytest.approx(light.life / (8.0 / 9.0 + 16.0 / 9.0), rel=1e-12)
    # 900 turns a minute on average
    assert both.hours == pytest.approx(both.life * 1e6 / (60.0 * 900.0), rel=1e-12)
    assert both.equivalent_load == pytest.approx(light.equivalent_load * (24.0 / 9.0) ** 0.3, rel=1e-12)
    # each race by the fourth powers; the static safety is that of the worst entry
    assert both.inner_load == pytest.approx(1000.0 * (24.0 / 9.0) ** 0.25, rel=1e-12)
    assert (both.static_load, light.static_load) == (16_000.0, 8000.0)
    assert light.static_safety == pytest.approx(2.0 * both.static_safety, rel=1e-12)


DUTY = {"torque": 377_300.0, "speed": 1500.0, "share": 1.0}


def with_duty(drive, *entries):
    return with_fields(drive, {f"duty.{n}.{name}": v for n, entry in enumerate(entries) for name, v in entry.items()})


@pytest.mark.slow
@pytest.mark.usefixtures("even")
def test_a_duty_of_the_load_itself_is_the_load(paper_cases, papers):
    plain = bearing_lives(papers, speed=1500.0).shortest
    drive = with_duty(paper_cases["CS-3"], DUTY)
    whole = bearing_lives(analyse(drive, TURN)).shortest
    parted = with_duty(paper_cases["CS-3"], DUTY | {"share": 0.3}, DUTY | {"share": 0.7})
    for found in (whole, bearing_lives(analyse(parted, TURN)).shortest):
        assert (found.life, found.hours) == pytest.approx((plain.life, plain.hours), rel=1e-12)
        assert found.static_safety == pytest.approx(plain.static_safety, rel=1e-12)


@pytest.mark.slow
@pytest.mark.usefixtures("even")
def test_every_entry_is_solved_at_its_torque(paper_cases):
    """Against analyses of their own; what the drive's load is has no say."""
    first, second = DUTY | {"torque": 1.5e5, "share": 0.75}, DUTY | {"torque": 3e5, "speed": 500.0, "share": 0.25}
    drive = with_duty(paper_cases["CS-3"], first, second)
    found = bearing_lives(analyse(drive, TURN)).shortest
    alone = [bearing_lives(analyse(paper_cases["CS-3"], TURN, entry["torque"])).shortest for entry in (first, second)]
    assert [entry.life for entry in found.entries] == pytest.approx([own.life for own in alone], rel=1e-9)
    assert found.life == pytest.approx(1.0 / (0.9 / alone[0].life + 0.1 / alone[1].life), rel=1e-9)
    assert alone[0].life > 10.0 * alone[1].life
    heavier = with_fields(drive, {"load.torque": 5e5})
    assert bearing_lives(analyse(heavier, TURN)).shortest.life == pytest.approx(found.life, rel=1e-6)


@pytest.mark.usefixtures("even")
def test_hours_are_at_the_speed_of_the_crank_against_the_disc(paper_cases, rv):
    """Held shaft: the input's. Held housing: by (z_C + 1)/z_C more. Behind a stage of an RV: n_in z_P/(1 + i z_P)."""
    fast = {"load.speed": 1500.0}
    for drive, speed in (
        (with_fields(paper_cases["CS-1"], fast), 1500.0),
        (with_fields(paper_cases["CS-1"], fast | {"installation.held": "pin-wheel"}), 1500.0 * 14.0 / 13.0),
        (with_fields(rv, fast), 1500.0 * 40.0 / 81.0),
    ):
        found = bearing_lives(analyse(drive, TURN[::5])).shortest
        assert found.entries[0].speed == pytest.approx(speed, rel=1e-12)
        assert found.hours == pytest.approx(found.life * 1e6 / 60.0 / speed, rel=1e-12)
    assert bearing_lives(analyse(paper_cases["CS-1"], TURN[::5])).shortest.hours is None


def test_lubricant(paper_cases):
    """κ and a_ISO of each entry at its own speed and load, and one modified life."""
    oil = {"lubricant.viscosity": 20.0, "lubricant.contamination": 0.5}
    drive = with_fields(with_duty(paper_cases["CS-1"], DUTY), oil)
    entries = [loads(drive, 1e5, 1500.0, 0.5), loads(drive, 2e5, 3000.0, 0.5, inner=1500.0, outer=1400.0)]
    found = lives_of_entries(drive, entries).shortest
    assert found.entries[0].viscosity_ratio == pytest.approx(20.0 / reference_viscosity(1500.0, 49.0), rel=1e-12)
    first, second = found.entries
    assert second.modification < first.modification  # thicker film, but nearer to the limit of endurance
    assert second.viscosity_ratio > first.viscosity_ratio
    spent = sum(entry.turns / (entry.modification * entry.life) for entry in found.entries)
    assert found.modified_life == pytest.approx(1.0 / spent, rel=1e-12)
    # a film that ISO 281 tells nothing of: the life itself stays
    thin = lives_of_entries(with_fields(drive, {"lubricant.viscosity": 0.5}), entries).shortest
    assert (thin.modified_life, thin.life) == (None, found.life)
    assert thin.entries[0].modification is None


def test_what_is_told(paper_cases):
    drive = with_fields(
        with_duty(paper_cases["CS-1"], DUTY), {"lubricant.viscosity": 20.0, "lubricant.contamination": 0.5}
    )
    found = lives_of_entries(drive, [loads(drive, 1e5, 1500.0, 1.0)])
    told = "\n".join(life_lines(found, drive, None))
    content, summary = life_content(found, drive), life_summary(found)
    assert content["million_turns"] == summary["bearing_life_million_turns"] == found.shortest.life
    assert content["hours"] == summary["bearing_life_hours"] == found.shortest.hours
    assert content["static_safety_S0"] == summary["static_safety_S0"] == found.static_safety
    assert content["bearings"][0]["modified_hours"] == found.shortest.modified_hours
    assert f"L10r {found.shortest.life:.1f} million turns" in told
    assert f"S0 {found.static_safety:.2f}" in told
    assert f"{found.shortest.modified_life:.1f} million turns" in told
    # not a number is no JSON: without load there is no end of life
    idle = lives_of_entries(drive, [loads(drive, 1e5, 1500.0, 1.0, inner=0.0, outer=0.0, force=0.0)])
    assert life_summary(idle) == dict.fromkeys(summary)


def test_nothing_is_told_of_what_is_not_rated(paper_cases):
    """A plastic disc has loads and no rating; a maker's rating is his."""
    drive = with_fields(paper_cases["CS-1"], {"materials.disc.youngs_modulus": 2000.0})
    found = lives_of_entries(drive, [loads(drive, 1e5, 1500.0, 1.0)])
    assert set(life_summary(found).values()) == {None}
    content, told = life_content(found, drive), "\n".join(life_lines(found, drive, None))
    assert (content["million_turns"], content["bearings"][0]["static_safety_S0"]) == (None, None)
    assert content["not_rated"] == [*found.not_rated]
    assert "materials.disc.youngs_modulus = 2000 MPa: no bearing steel" in told
    assert "million" not in told
    rated = lives_of_entries(drive, [loads(drive, 1e5, 1500.0, 1.0)], 50_000.0)
    assert life_summary(rated)["bearing_life_million_turns"] == rated.shortest.life


def test_which_laminae_are_used_when(paper_cases, papers):
    """Solved along the length wherever the contact is; even slices with edge factors in plane strain alone."""
    inner, outer = laminae_of(papers)
    drive = papers.drive
    assert isinstance(inner, SolvedLaminae)
    assert inner.profile is None
    assert inner.effective_radius == pytest.approx(1.0 / (1.0 / 5.0 + 1.0 / 19.5))
    assert outer.effective_radius == pytest.approx(1.0 / (1.0 / 5.0 - 1.0 / 29.515))
    assert inner.contact_modulus == contact_modulus(drive.materials.inner_race, drive.materials.roller)
    plane, hybrid = replace(papers, engine=PlaneStrain()), replace(papers, engine=Hybrid())
    assert laminae_of(plane) == (EvenLaminae(edges=True), EvenLaminae(edges=True))
    assert laminae_of(hybrid) == (inner, outer)


@pytest.mark.slow
def test_a_crown_of_a_nanometre_does_not_change_the_life(paper_cases, papers):
    """It raised it by 19 %. Load laws of straight and of profiled rollers are two tables: they differ by 1e-4."""
    crowned = analyse(with_fields(paper_cases["CS-3"], {"crank_bearing.roller_profile.crown_drop": 1e-9}), TURN)
    assert bearing_lives(crowned).shortest.life == pytest.approx(bearing_lives(papers).shortest.life, rel=1e-3)


@pytest.mark.usefixtures("even")
def test_a_makers_rating_scales_the_life(papers):
    own, makers = bearing_lives(papers), bearing_lives(papers, dynamic_load_rating=60_000.0)
    ratio = 60_000.0 / own.dynamic_load_rating
    assert makers.shortest.life == pytest.approx(own.shortest.life * ratio**4, rel=1e-12)
    # P with (C/P)^(10/3)
    assert makers.shortest.life == pytest.approx(
        (60_000.0 / makers.shortest.equivalent_load) ** (10.0 / 3.0), rel=1e-12
    )


@pytest.mark.usefixtures("even")
def test_the_ratings_of_a_drive_are_used(papers):
    """L10r goes with C⁴, S0 with C0, as above; C_u is C0/8.2 below 100 mm. Round-off of products."""
    own = bearing_lives(papers)
    ratings = {"crank_bearing.dynamic_load_rating": 60_000.0, "crank_bearing.static_load_rating": "70 kN"}
    makers = bearing_lives(replace(papers, drive=with_fields(papers.drive, ratings)))
    ratio = 60_000.0 / own.dynamic_load_rating
    assert makers.shortest.life == pytest.approx(own.shortest.life * ratio**4, rel=1e-12)
    assert makers.static_safety == pytest.approx(own.static_safety * 70_000.0 / own.static_load_rating, rel=1e-12)
    assert makers.fatigue_load_limit == pytest.approx(70_000.0 / 8.2, rel=1e-12)
    assert (own.of_maker, makers.of_maker) == ((), ("C", "C0"))
    assert "C 60000 N (of the maker)" in "\n".join(life_lines(makers, papers.drive, None))
    # The option of a command goes before the field.
    assert (
        bearing_lives(replace(papers, drive=makers_drive(papers)), dynamic_load_rating=50_000.0).dynamic_load_rating
        == 5e4
    )


def makers_drive(analysis):
    return with_fields(analysis.drive, {"crank_bearing.dynamic_load_rating": 60_000.0})


@pytest.mark.usefixtures("even")
def test_a_catalogue_rates_no_bore_of_plastic(papers):
    """Its C is that of hardened rings; the bore of the disc is the outer one."""
    soft = with_fields(makers_drive(papers), {"materials.disc.youngs_modulus": 3000.0})
    assert bearing_lives(replace(papers, drive=soft)).not_rated


@pytest.mark.slow
@pytest.mark.parametrize("parts", [2, 7])
def test_lives_of_positions_solved_part_by_part(paper_cases, parts):
    """Turns of many pins do not fit into memory at once. Round-off of the sums, and of the search that begins elsewhere."""
    drive = with_duty(paper_cases["CS-3"], DUTY)
    whole = bearing_lives(analyse(drive, TURN)).shortest
    pieces = [passages_of_duty(analyse(drive, rows)) for rows in np.array_split(TURN, parts)]
    found = lives_over(pieces).shortest
    assert (found.life, found.static_load) == pytest.approx((whole.life, whole.static_load), rel=1e-7)


def test_what_tells_no_life_is_refused(paper_cases, monkeypatch):
    half = analyse(paper_cases["CS-1"], TURN[:30:3])
    with pytest.raises(ValueError, match="whole turns"):
        entry_loads([roller_passages(half)], None, 1.0)
    lost = replace(half, balanced=np.zeros_like(half.balanced), full=replace(half.full, crank_angle=TURN[::6]))
    with pytest.raises(ValueError, match="an answer at every position"):
        roller_passages(lost)
    # an entry that cannot be carried is named
    solved = analyse(with_duty(paper_cases["CS-1"], DUTY | {"torque": 1e6}), TURN[::6])
    for error in (DriveError(["torque = 1e+06 N·mm: too much"]), ConvergenceError("no equilibrium", [1.0])):

        def refuse(*words, error=error):
            raise error

        monkeypatch.setattr(module, "analyse", refuse)
        with error_says(type(error), starts=f"duty.0.torque = 1e+06 N·mm: {str(error)[:7]}"):
            bearing_lives(solved)
