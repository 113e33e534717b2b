r"""Equivalent roller load of a race: which loads pass at each of its places, and what they amount to.

A place of a race is stressed by every roller that passes it. Over the time at one place damage adds up with Q⁴; over the
places of a race, of which each may fail, with the Weibull slope 9/8 of line contact:

.. math:: Q = \Bigl[\mathrm{mean\ over\ places}\,\bigl(\mathrm{mean\ over\ time\ of}\ Q^4\bigr)^{9/8}\Bigr]^{1/4.5}

A place that stands still to the load always sees the same one: the mean is that with 4.5 over the places. Where the load
goes round, all places see the same: the mean is that with 4. Everything between is in it, and places along the length, the
slices of a roller, are places like others (which is the sum over laminae of ISO 16281:2025).

**Who turns to what.** Angles are those of the analysis, in the frame of the pin shaft (or carrier). The disc does not turn
there, so a place of the bore is the angle at which a roller presses on it, seen from the bore's centre; the inner race
turns with its crank, so a place on it is the roller's angle less the crank angle. The force on a central crank turns with
the crank: the inner race stands still to it. Of a crank in a carrier one part turns with the crank (the push of the wheel
pins) and one stands in the carrier (the torque's), so that neither race stands.

**Time.** Cage and crank turn by no common measure, so in time a roller comes to each place at every crank angle. Loads are
therefore summed as Fourier series around the race: a series about the place takes the mean over all crank angles by itself,
where a count of the rollers that come by in a few turns would scatter. Several turns leave 1e-4 of an equivalent load; one
turn of 11 rollers leaves up to 0.7 %, harmonics of their number that have not gone round.
"""

from __future__ import annotations

import numpy as np

from ltca.analysis.life.laminae import LAMINAE, Laminae, uneven_shares
from ltca.arrays import FloatArray

HARMONICS = 24
"""Highest harmonic around a race: zones of load are wider than the distance of two rollers."""
_PLACES = 4 * HARMONICS
DAMAGE_EXPONENT = 4.0
"""Exponent of the load over the time at one place."""
LOADS_PER_CHUNK = 50_000
"""Number of loads summed at once: each takes a kilobyte."""
WEIBULL_SLOPE = 9.0 / 8.0
"""Slope of line contact: exponent of the damage over the places."""


def race_load(load: FloatArray, place: FloatArray, laminae: Laminae, slices: FloatArray | None = None) -> float:
    """Return the equivalent roller load of a race, N.

    Parameters
    ----------
    load : array, shape (positions, rollers)
        Of one bearing's rollers, at positions evenly spread over whole turns, N.
    place : array, shape (positions, rollers)
        Where on the race each one presses, in its own frame, rad.
    laminae : Laminae
        How the load of an aligned roller spreads along it; of a straight one where slices are given.
    slices : array, shape (positions, rollers, slices), optional
        Loads of the slices of rollers that tilt, N.
    """
    pressed = load > 0.0
    if not np.any(pressed):
        return 0.0
    size, at = load[pressed], place[pressed]
    along = None if slices is None else slices[pressed]
    weights = laminae.weights if along is None else np.full(LAMINAE, 1.0 / LAMINAE)
    largest = float(np.max(size))
    order = np.arange(HARMONICS + 1)
    series = np.zeros((order.size, weights.size), dtype=complex)
    for first in range(0, size.size, LOADS_PER_CHUNK):
        few = slice(first, first + LOADS_PER_CHUNK)
        shares = laminae.shares(np.append(size[few], largest))[:-1]  # solved around the largest of all
        if along is not None:
            shares = uneven_shares(along[few], shares, laminae.slice_shares(size[few], along.shape[1]))
        damage = ((size[few] / largest)[:, None] * shares) ** DAMAGE_EXPONENT
        series += np.exp(-1j * np.outer(order, at[few])) @ damage / load.size
    series[1:] *= 2.0
    around = np.exp(2j * np.pi * np.outer(np.arange(_PLACES), order) / _PLACES)
    over_time = np.maximum((around @ series).real, 0.0)  # a cut series may dip below zero where nothing presses
    over_places = float((over_time**WEIBULL_SLOPE).mean(axis=0) @ weights)
    return float(largest * over_places ** (1.0 / (DAMAGE_EXPONENT * WEIBULL_SLOPE)))


def covers_whole_turns(crank_angle: FloatArray) -> bool:
    """Tell whether positions are evenly spread over whole turns of the crank, which means over the time need."""
    if crank_angle.size < 2:
        return False
    step = float(crank_angle[1] - crank_angle[0])
    turns = crank_angle.size * step / (2.0 * np.pi)
    even = np.allclose(np.diff(crank_angle), step, rtol=1e-9, atol=1e-9)
    return bool(even and step != 0.0 and abs(turns - round(turns)) < 1e-6)
