"""Equivalent loads of races that stand, turn, or do part of both to their load, in closed form and counted out."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

from ltca.analysis.life.equivalent_load import covers_whole_turns, race_load
from ltca.analysis.life.laminae import EvenLaminae, edge_factors

EVEN = EvenLaminae(edges=False)
ROLLERS, CAGE, PER_TURN = 13, 0.414, 60


def rollers(turns):
    """Crank angles and the angles of the rollers in the frame of the bore, rad."""
    crank = 2.0 * np.pi * np.arange(PER_TURN * turns) / PER_TURN
    return crank, CAGE * crank[:, None] + 2.0 * np.pi * np.arange(ROLLERS) / ROLLERS


def zone(angle):
    """1000 N cos^1.1 over half the circle, as rigid races without clearance have it."""
    return 1000.0 * np.maximum(np.cos(angle), 0.0) ** 1.1


def mean(power):
    """Mean of that load to a power over the circle."""
    return 1000.0**power * quad(lambda psi: np.cos(psi) ** (1.1 * power), -np.pi / 2, np.pi / 2)[0] / (2.0 * np.pi)


# Ten turns: harmonics of 13 rollers that one turn leaves have gone; of the rest the series' end is 2e-4.
@pytest.mark.parametrize(("turns", "error"), [(10, 3e-4), (1, 4e-3)])
def test_standing_and_going_round(turns, error):
    """A place that stands to the load takes the mean with 4.5 over the places, one that it goes round that with 4."""
    crank, angle = rollers(turns)
    standing = race_load(zone(angle), angle, EVEN)
    assert standing == pytest.approx(mean(4.5) ** (1.0 / 4.5), rel=error)
    # the same loads at the places of a race that turns with the crank
    assert race_load(zone(angle), angle - crank[:, None], EVEN) == pytest.approx(mean(4.0) ** 0.25, rel=error)
    # a load that turns with the crank: races change places
    turning = zone(angle - crank[:, None])
    assert race_load(turning, angle - crank[:, None], EVEN) == pytest.approx(mean(4.5) ** (1.0 / 4.5), rel=error)
    assert race_load(turning, angle, EVEN) == pytest.approx(mean(4.0) ** 0.25, rel=error)
    # the two differ by 4 %, ten times what is allowed
    assert mean(4.5) ** (1.0 / 4.5) > 1.035 * mean(4.0) ** 0.25


def test_part_of_both_in_closed_form():
    """Q⁴ = s (1 + cos α) + r (1 + cos(α − φ)): over the time a place keeps the first and sees the mean of the second."""
    crank, angle = rollers(10)
    standing, turning = 3e11, 1e11
    load = (standing * (1.0 + np.cos(angle)) + turning * (1.0 + np.cos(angle - crank[:, None]))) ** 0.25

    def damage(own, other):
        return quad(lambda place: (own * (1.0 + np.cos(place)) + other) ** 1.125, 0.0, 2.0 * np.pi)[0] / (2.0 * np.pi)

    assert race_load(load, angle, EVEN) == pytest.approx(damage(standing, turning) ** (1.0 / 4.5), rel=1e-4)
    on_crank = race_load(load, angle - crank[:, None], EVEN)
    assert on_crank == pytest.approx(damage(turning, standing) ** (1.0 / 4.5), rel=1e-4)
    # neither limit: bounded by the means of all loads with 4 and with 4.5
    low, high = (float(np.mean(load**power)) ** (1.0 / power) for power in (4.0, 4.5))
    assert low * 1.0001 < on_crank < race_load(load, angle, EVEN) < high * 0.9999


def test_against_a_count_of_what_passes():
    """The rollers that pass at sixty places of the bore over four thousand turns, one by one."""
    crank, angle = rollers(4000)
    load = np.maximum(np.cos(angle) + 0.8 * np.cos(angle - crank[:, None]) + 0.1, 0.0)
    place = (angle / (2.0 * np.pi) * 60).astype(int) % 60
    count, damage = np.bincount(place.ravel()), np.bincount(place.ravel(), weights=(load**4).ravel())
    counted = np.mean((damage / count) ** 1.125) ** (1.0 / 4.5)
    # places of 6° blur the zone by 1e-3 of a load to the fourth power; a few turns find it as well
    few_crank, few_angle = rollers(5)
    few = np.maximum(np.cos(few_angle) + 0.8 * np.cos(few_angle - few_crank[:, None]) + 0.1, 0.0)
    assert race_load(few, few_angle, EVEN) == pytest.approx(counted, rel=1e-3)


def test_places_along_the_length_are_places_like_others():
    """Shares that all loads have are a factor: their mean with 4.5, as ISO 16281:2025 sums laminae."""
    crank, angle = rollers(3)
    factor = np.mean(edge_factors() ** 4.5) ** (1.0 / 4.5)
    for place in (angle, angle - crank[:, None]):
        edged = race_load(zone(angle), place, EvenLaminae())
        assert edged == pytest.approx(factor * race_load(zone(angle), place, EVEN), rel=1e-12)
    assert factor == pytest.approx(1.0445, abs=1e-3)  # 19 % of life


def test_no_load_is_none():
    _, angle = rollers(1)
    assert race_load(np.zeros_like(angle), angle, EVEN) == 0.0


def test_whole_turns():
    """The mean over the time needs them: others are told apart."""
    turn = 2.0 * np.pi * np.arange(72) / 72
    assert covers_whole_turns(turn)
    assert covers_whole_turns(0.3 - np.concatenate([turn, turn + 2.0 * np.pi]))
    assert not covers_whole_turns(turn[:-1])
    assert not covers_whole_turns(0.5 * turn)
    assert not covers_whole_turns(turn[[0, 2, 1, *range(3, 72)]])
    assert not covers_whole_turns(np.array([0.5]))
