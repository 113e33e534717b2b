"""Stress in the disc in two answers: what is compared, relative to what, and what the rows make of it."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from validation.compare.comparison import contact_name
from validation.compare.disc_stresses import DiscStressAnswer, compare_stresses
from validation.levels.disc_stresses import SHEAR_LIMIT, WALL_LIMIT, disc_stress_rows
from validation.rows import failed_rows

PLACES = 2.0 * np.pi * np.arange(8) / 8
NODES = 2.0 * np.pi * (np.arange(64) + 0.5) / 64


def wave(wall, parameter):
    return 100.0 * np.cos(parameter - wall) / (1.0 + wall)


def answer(places, *, factor=1.0, shear=(300.0, 0.0)):
    return DiscStressAnswer(
        parameter=(places,) * 4,
        stress=tuple(factor * wave(wall, places) for wall in range(4)),
        clear=(np.ones(places.size, dtype=bool),) * 4,
        largest={
            "flank": factor * np.array([90.0, 80.0]),
            "bore": factor * np.array([50.0]),
            "holes": factor * np.array([33.0, np.nan]),
        },
        shear={"pin": factor * np.array(shear), "roller_outer": np.zeros(3), "hole": factor * np.array([0.0, 200.0])},
    )


REFERENCE = answer(NODES)


def test_the_same_stress_differs_by_what_lies_between_nodes():
    difference = compare_stresses(answer(PLACES), REFERENCE)
    # Chords of 64 nodes: (π/64)²/2 of the wave.
    assert all(abs(found.difference) < 1.3e-3 for found in difference.stations.values())
    assert all(found.difference == 0.0 for found in difference.largest.values())
    assert set(difference.shear["pin"]) == {0}
    assert difference.shear["roller_outer"] == {}
    assert set(difference.shear["hole"]) == {1}


def test_differences_are_relative_to_the_largest_stress_of_all_walls():
    difference = compare_stresses(answer(PLACES, factor=1.01), REFERENCE)
    largest = 100.0  # at the first place of the flank
    flank, bore = difference.stations["flank"], difference.stations["bore"]
    assert flank.place == "flank at 0.0°"
    assert flank.difference == pytest.approx(1e-2, rel=0.15)
    # The bore's own largest stress is half as large; there 1 % of it counts half.
    assert bore.difference == pytest.approx(0.5e-2, rel=0.3)
    assert bore.value - bore.reference == pytest.approx(bore.difference * largest, rel=2e-3)
    assert difference.largest["holes"].place == "hole 0"
    assert difference.largest["holes"].difference == pytest.approx(0.33e-2, rel=2e-3)
    assert difference.shear["pin"][0].difference == pytest.approx(1e-2)


def test_places_beside_contacts_do_not_count():
    model = answer(PLACES)
    spoiled = tuple(np.where(np.arange(8) == 2, 1e3, stress) for stress in model.stress)
    clear = tuple(np.arange(8) != 2 for _ in range(4))
    worst = compare_stresses(replace(model, stress=spoiled, clear=clear), REFERENCE).stations
    assert all(abs(found.difference) < 1.3e-3 for found in worst.values())
    assert abs(compare_stresses(replace(model, stress=spoiled), REFERENCE).stations["flank"].difference) > 1.0
    # A wall without any clear place is left out, and no failure.
    hidden = (np.zeros(8, dtype=bool), *clear[1:])
    assert set(compare_stresses(replace(model, stress=spoiled, clear=hidden), REFERENCE).stations) == {"bore", "holes"}


def test_another_disc_is_refused():
    model = answer(PLACES)
    with pytest.raises(ValueError, match="not the same disc"):
        compare_stresses(replace(model, stress=model.stress[:3]), REFERENCE)
    with pytest.raises(ValueError, match="not the same disc"):
        compare_stresses(replace(model, largest=model.largest | {"flank": np.ones(3)}), REFERENCE)


def rows_of(model, other):
    names = SimpleNamespace(contact_name=contact_name)
    compared = SimpleNamespace(
        full=SimpleNamespace(case="CS-1", crank_angle=0.5, answer=names),
        stress={model: compare_stresses(other, REFERENCE)},
    )
    return disc_stress_rows(compared)


def test_rows_hold_the_limits_of_plane_strain_alone():
    sound = rows_of("fe", answer(PLACES))
    assert len(sound) == 3 + 3 + 2
    assert not failed_rows(sound)
    assert {row.limit for row in sound} == {WALL_LIMIT, SHEAR_LIMIT} == {0.02, 0.03}
    assert {row.contact for row in sound} >= {"root 0", "bore", "hole 0", "pin 0"}
    wrong = failed_rows(rows_of("fe", answer(PLACES, factor=1.04)))
    assert {row.quantity for row in wrong} >= {
        "stress along the flank, worst station",
        "largest tensile stress, lobe roots, worst",
        "largest shear stress in the disc below a contact",
    }
    informing = rows_of("hybrid", answer(PLACES, factor=1.04))
    assert len(informing) == len(sound)
    assert not failed_rows(informing)
