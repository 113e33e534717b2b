"""Memory and disc that an analysis of many positions will need, estimated before it starts."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from ltca.drive.parts import Drive
from ltca.output.resources import require_room

# The paper's drive, CS-1, half-space: 24 kB at the most and 2 kB in results.nc for each position of its 39 pairs
# (3,600 to 14,400 positions); hybrid and fe take 34 kB. Analyses of all cases are held together, their working memory once.
MEMORY_PER_PAIR = 900.0
DISC_PER_PAIR = 60.0


MEMORY_PER_PART = 2e8
"""Memory for one part of an analysis that is solved part by part, bytes: all turns of the paper's drive are one part."""


KEPT_PER_POSITION = 1e3
"""Memory for the kept results of one position, bytes: 0.9 kB measured for a drive of 100 pins."""


def positions_together(drive: Drive) -> int:
    """Return how many positions of a drive are solved at once where an analysis is solved part by part."""
    return max(1, int(MEMORY_PER_PART / (MEMORY_PER_PAIR * pairs_of(drive))))


def pairs_of(drive: Drive) -> int:
    """Pairs of contacts of all discs."""
    return drive.disc.number_of_discs * (
        drive.pin_wheel.number_of_pins
        + drive.crank.number * drive.crank_bearing.number_of_rollers
        + drive.number_of_holes
    )


def require_room_for_parts(drive: Drive, positions: int, folder: Path, option: str) -> None:
    """Refuse an analysis part by part whose parts or kept results would not fit.

    Parameters
    ----------
    drive : Drive
        Solved now.
    positions : int
        Crank angles of all parts.
    folder : Path
        Where results go.
    option : str
        What the number of positions was given by, with its value.

    Raises
    ------
    PlaceError
        With the numbers.
    """
    require_room_for([drive], min(positions, positions_together(drive)), folder, option)
    require_room(0.0, memory=KEPT_PER_POSITION * positions, folder=folder, option=option)


def require_room_for(drives: Iterable[Drive], positions: int, folder: Path, option: str) -> None:
    """Refuse an analysis that would not fit into memory or on the disc.

    Parameters
    ----------
    drives : iterable of Drive
        All cases.
    positions : int
        Crank angles of each.
    folder : Path
        Where results go.
    option : str
        What the number of positions was given by, with its value.

    Raises
    ------
    PlaceError
        With the numbers.
    """
    pairs = sum(map(pairs_of, drives))
    require_room(
        DISC_PER_PAIR * pairs * positions, memory=MEMORY_PER_PAIR * pairs * positions, folder=folder, option=option
    )
