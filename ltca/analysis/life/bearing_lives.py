"""Life and static safety of every crank bearing: each disc on each crank, over every entry of the duty."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ltca.analysis.life.equivalent_load import covers_whole_turns, race_load
from ltca.analysis.life.modification import life_modification_factor, reference_viscosity
from ltca.analysis.life.passages import RollerPassages, roller_passages
from ltca.analysis.life.ratings import RaceRatings, RollerBearing, not_rated
from ltca.analysis.loaded_analysis import LoadedAnalysis, analyse
from ltca.arrays import FloatArray
from ltca.drive.parts import Drive
from ltca.errors import ConvergenceError, DriveError


@dataclass(frozen=True, slots=True, kw_only=True)
class EntryLife:
    """What one bearing would live under one entry of the duty alone.

    Attributes
    ----------
    torque : float
        At the output, N·mm.
    speed : float or None
        Of the crank against the disc, turns a minute.
    turns : float
        Part of all turns that the entry takes.
    inner_load, outer_load : float
        Equivalent roller loads of the races, N.
    life : float
        L_10r, millions of turns; infinite where nothing is loaded.
    equivalent_load : float
        P, the radial load whose simple life (C/P)^(10/3) is the same, N.
    static_load : float
        P_0, the largest radial force over the positions, N (ISO 76).
    viscosity_ratio : float or None
        κ; None without lubricant.
    modification : float or None
        a_ISO; None without lubricant, and where κ is below what ISO 281 covers.
    """

    torque: float
    speed: float | None
    turns: float
    inner_load: float
    outer_load: float
    life: float
    equivalent_load: float
    static_load: float
    viscosity_ratio: float | None = None
    modification: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class BearingLife:
    """Life of one crank bearing.

    Attributes
    ----------
    disc, crank : int
        Whose it is.
    life : float
        L_10r over the duty, millions of turns of the crank against the disc.
    hours : float or None
        The same in hours; None without a speed.
    inner_load, outer_load : float
        Roller loads under which the races would live as long, N.
    equivalent_load : float
        P with (C/P)^(10/3) = life, N.
    static_load, static_safety : float
        P_0, the largest over the duty, N, and S_0 = C_0/P_0.
    modified_life, modified_hours : float or None
        With a_ISO; None where an entry has none.
    entries : tuple of EntryLife
        Of each entry of the duty.
    """

    disc: int
    crank: int
    life: float
    hours: float | None
    inner_load: float
    outer_load: float
    equivalent_load: float
    static_load: float
    static_safety: float
    modified_life: float | None
    modified_hours: float | None
    entries: tuple[EntryLife, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class BearingLives:
    """Lives of all crank bearings of a drive, which are alike in size.

    Attributes
    ----------
    bearings : tuple of BearingLife
        Disc after disc, crank after crank.
    dynamic_load_rating, static_load_rating, fatigue_load_limit : float
        C_r, C_0r and C_u, N.
    ratings : RaceRatings
        Q_ci and Q_ce.
    not_rated : tuple of str
        Why the ratings are not those of its parts: lives and safeties are numbers, and mean nothing. Empty where they
        are, or where a rating of the maker was passed for them.
    of_maker : tuple of str
        Which of C and C0 are those of the maker; the others are by ISO 281 and ISO 76.
    """

    bearings: tuple[BearingLife, ...]
    dynamic_load_rating: float
    static_load_rating: float
    fatigue_load_limit: float
    ratings: RaceRatings
    not_rated: tuple[str, ...] = ()
    of_maker: tuple[str, ...] = ()

    @property
    def shortest(self) -> BearingLife:
        """The bearing that lives shortest."""
        return min(self.bearings, key=lambda bearing: bearing.life)

    @property
    def static_safety(self) -> float:
        """Least S_0 of all bearings."""
        return min(bearing.static_safety for bearing in self.bearings)


def bearing_lives(
    analysis: LoadedAnalysis, *, dynamic_load_rating: float | None = None, speed: float | None = None
) -> BearingLives:
    """Return the lives of all crank bearings from an analysis over whole turns.

    Of a drive with ``[[duty]]`` every entry is solved at its torque at the same positions; what the analysis itself was
    solved at counts if it is the torque of an entry. Without duty that torque alone counts.

    Parameters
    ----------
    analysis : LoadedAnalysis
        At positions evenly spread over whole turns of the crank, all balanced.
    dynamic_load_rating : float, optional
        C_r of the maker, N; ``crank_bearing.dynamic_load_rating`` by default, by ISO 281 without it.
    speed : float, optional
        Of the cranks against the discs, turns a minute; that of ``load.speed`` by default. Duty has its own.

    Returns
    -------
    BearingLives

    Raises
    ------
    ValueError
        When positions do not cover whole turns evenly, or one has no answer.

    Examples
    --------
    >>> import numpy as np
    >>> from ltca.reading.drive_file import load_drive
    >>> angles = 2.0 * np.pi * np.arange(72) / 36.0
    >>> found = bearing_lives(analyse(load_drive("paper").cases["CS-1"], angles))
    >>> found.shortest.disc, found.shortest.crank
    (0, 0)
    """
    return lives_over([passages_of_duty(analysis)], dynamic_load_rating=dynamic_load_rating, speed=speed)


def lives_over(
    parts: Sequence[Sequence[RollerPassages]], *, dynamic_load_rating: float | None = None, speed: float | None = None
) -> BearingLives:
    """Return the lives of all crank bearings from positions that were solved part by part.

    Parameters
    ----------
    parts : sequence of sequence of RollerPassages
        Of each part of the positions, in their order, `passages_of_duty`.
    dynamic_load_rating, speed : float, optional
        As for `bearing_lives`.
    """
    drive, ratio = parts[0][0].drive, abs(parts[0][0].drive.crank_turns_per_input)
    turning: list[tuple[float | None, float]]
    if drive.duty:
        turning = [(ratio * entry.speed, entry.share) for entry in drive.duty]
    else:
        own = None if drive.load.speed is None else ratio * drive.load.speed
        turning = [(own if speed is None else speed, 1.0)]
    entries = [entry_loads(each, *turns) for each, turns in zip(zip(*parts, strict=True), turning, strict=True)]
    return lives_of_entries(drive, entries, dynamic_load_rating)


def at_entry(analysis: LoadedAnalysis, number: int) -> LoadedAnalysis:
    """Return the same positions at torque and speed of an entry of the duty.

    Parameters
    ----------
    analysis : LoadedAnalysis
        Of a drive with duty.
    number : int
        Of the entry.

    Raises
    ------
    DriveError, ConvergenceError
        Where the entry has no answer; it is named.
    """
    drive, torque = analysis.drive, analysis.drive.duty[number].torque
    # Where no light torque was solved apart, none is here.
    light = torque if drive.load.light_torque == analysis.torque else drive.load.light_torque
    load = replace(drive.load, torque=torque, speed=drive.duty[number].speed, light_torque=light)
    try:
        return analyse(replace(drive, load=load), analysis.full.crank_angle, torque, analysis.engine)
    except DriveError as error:
        raise type(error)(
            [f"duty.{number}.torque = {torque:g} N·mm: {problem}" for problem in error.problems]
        ) from error
    except ConvergenceError as error:
        error.add(f"duty.{number}.torque = {torque:g} N·mm")
        raise


@dataclass(frozen=True, slots=True, kw_only=True)
class EntryLoads:
    """What all crank bearings carry in one entry of the duty.

    Attributes
    ----------
    torque : float
        At the output, N·mm.
    speed : float or None
        Of the cranks against the discs, turns a minute.
    share : float
        Part of the time.
    inner, outer : array, shape (discs, cranks)
        Equivalent roller loads of the races, N.
    largest_force : array, shape (discs, cranks)
        Largest radial force over the positions, N.
    """

    torque: float
    speed: float | None
    share: float
    inner: FloatArray
    outer: FloatArray
    largest_force: FloatArray


def passages_of_duty(analysis: LoadedAnalysis) -> list[RollerPassages]:
    """Return the passages of each entry of the duty at the positions of an analysis; its own without duty.

    Parameters
    ----------
    analysis : LoadedAnalysis
        All its positions balanced.

    Raises
    ------
    ValueError
        When one has no answer.
    """
    duty = analysis.drive.duty
    return [
        roller_passages(analysis if entry.torque == analysis.torque else at_entry(analysis, number))
        for number, entry in enumerate(duty)
    ] or [roller_passages(analysis)]


def entry_loads(parts: Sequence[RollerPassages], speed: float | None, share: float) -> EntryLoads:
    """Return what all crank bearings carry in one entry of the duty.

    Parameters
    ----------
    parts : sequence of RollerPassages
        At its torque; together their positions are evenly spread over whole turns of the crank.
    speed : float or None
        Of the cranks against the discs, turns a minute.
    share : float
        Part of the time.

    Raises
    ------
    ValueError
        When they do not cover whole turns evenly.
    """
    drive, (on_race, on_bore) = parts[0].drive, parts[0].laminae
    if not covers_whole_turns(np.concatenate([part.crank_angle for part in parts])):
        raise ValueError("life needs positions evenly spread over whole turns of the crank")
    cranks = drive.crank.number
    inner, outer = np.zeros((2, drive.disc.number_of_discs, cranks))
    rollers = np.split(np.arange(parts[0].on_inner.shape[2]), cranks)
    for disc, crank in np.ndindex(*inner.shape):
        own = np.s_[:, disc, rollers[crank]]
        load, place, slices = _of_bearing(parts, ("inner_load", "on_inner", "inner_slices"), own)
        inner[disc, crank] = race_load(load, place, on_race, slices)
        load, place, slices = _of_bearing(parts, ("outer_load", "in_bore", "outer_slices"), own)
        outer[disc, crank] = race_load(load, place, on_bore, slices)
    force = np.max([part.largest_force for part in parts], axis=0)
    return EntryLoads(torque=parts[0].torque, speed=speed, share=share, inner=inner, outer=outer, largest_force=force)


def _of_bearing(parts: Sequence[RollerPassages], names: Sequence[str], own: Any) -> list[Any]:
    """Loads, places and loads of slices of one bearing at all positions; None for what is not there."""
    found = []
    for name in names:
        each = [getattr(part, name) for part in parts]
        found.append(None if each[0] is None else np.concatenate([values[own] for values in each]))
    return found


def lives_of_entries(
    drive: Drive, entries: Sequence[EntryLoads], dynamic_load_rating: float | None = None
) -> BearingLives:
    """Return the lives of all crank bearings over a duty (Palmgren and Miner).

    Parameters
    ----------
    drive : Drive
        Whose they are.
    entries : sequence of EntryLoads
        All with a speed, or a single one without.
    dynamic_load_rating : float, optional
        C_r of the maker, N; ``crank_bearing.dynamic_load_rating`` by default, by ISO 281 without it.
    """
    bearing, part = RollerBearing.of_drive(drive), drive.crank_bearing
    capacity = dynamic_load_rating or part.dynamic_load_rating or bearing.dynamic_load_rating
    static = part.static_load_rating or bearing.static_load_rating
    limit = bearing.fatigue_load_limit * static / bearing.static_load_rating
    ratings = bearing.race_ratings(capacity)
    turned = [entry.share * (1.0 if entry.speed is None else entry.speed) for entry in entries]
    per_minute = None if entries[0].speed is None else sum(turned)
    lives = []
    for disc, crank in np.ndindex(*entries[0].inner.shape):
        own = []
        for entry, turns in zip(entries, turned, strict=True):
            inner, outer = float(entry.inner[disc, crank]), float(entry.outer[disc, crank])
            life = ratings.life(inner, outer)
            found = EntryLife(
                torque=entry.torque,
                speed=entry.speed,
                turns=turns / sum(turned),
                inner_load=inner,
                outer_load=outer,
                life=life,
                equivalent_load=float(capacity * life**-0.3),
                static_load=float(entry.largest_force[disc, crank]),
            )
            own.append(_modified(found, drive, bearing.pitch_diameter, limit))
        lives.append(_joined(disc, crank, own, per_minute, capacity, static))
    return BearingLives(
        bearings=tuple(lives),
        dynamic_load_rating=capacity,
        static_load_rating=static,
        fatigue_load_limit=limit,
        ratings=ratings,
        # Catalogues rate their rollers on hardened steel, also where the disc is something else.
        not_rated=not_rated(drive) if dynamic_load_rating is None else (),
        of_maker=tuple(
            name
            for name, rating in (
                ("C", dynamic_load_rating or part.dynamic_load_rating),
                ("C0", part.static_load_rating),
            )
            if rating is not None
        ),
    )


def _joined(
    disc: int, crank: int, entries: Sequence[EntryLife], per_minute: float | None, capacity: float, static: float
) -> BearingLife:
    """One life of all entries: what each takes of it adds up to one."""
    life = _miner([(entry.turns, entry.life) for entry in entries])
    modified = None
    if all(entry.modification is not None for entry in entries):
        modified = _miner([(entry.turns, (entry.modification or 0.0) * entry.life) for entry in entries])
    hours = None if per_minute is None else 1e6 / (60.0 * per_minute)
    largest = max(entry.static_load for entry in entries)
    return BearingLife(
        disc=disc,
        crank=crank,
        life=life,
        hours=None if hours is None else life * hours,
        # A race alone lives by the fourth power of its load.
        inner_load=float(sum(entry.turns * entry.inner_load**4 for entry in entries) ** 0.25),
        outer_load=float(sum(entry.turns * entry.outer_load**4 for entry in entries) ** 0.25),
        equivalent_load=float(capacity * life**-0.3),
        static_load=largest,
        static_safety=static / largest if largest > 0.0 else float("inf"),
        modified_life=modified,
        modified_hours=None if hours is None or modified is None else modified * hours,
        entries=tuple(entries),
    )


def _miner(parts: Sequence[tuple[float, float]]) -> float:
    """Life of which every part of the turns takes its part, 1/Σ(turns/life)."""
    spent = sum(turns / life for turns, life in parts)
    return 1.0 / spent if spent > 0.0 else float("inf")


def _modified(entry: EntryLife, drive: Drive, pitch_diameter: float, fatigue_load_limit: float) -> EntryLife:
    """The entry with what the lubricant makes of it."""
    lubricant = drive.lubricant
    if lubricant is None or entry.speed is None:
        return entry
    ratio = lubricant.viscosity / reference_viscosity(entry.speed, pitch_diameter)
    limit = fatigue_load_limit / entry.equivalent_load if entry.equivalent_load > 0.0 else float("inf")
    factor = life_modification_factor(ratio, lubricant.contamination, limit)
    return replace(entry, viscosity_ratio=ratio, modification=factor)
