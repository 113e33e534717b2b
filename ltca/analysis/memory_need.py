"""Memory and disc that an analysis of many positions will need, estimated before it starts."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from ltca.drive.parts import Drive
from ltca.output.resources import require_room

MEMORY_PER_PAIR, SEVERAL_DISCS, DISPLACED_PINS = 2000.0, 1.4, 3.2
"""Memory for one pair of contacts at one position of a drive of one disc, bytes, and its factors with several discs and where
pins are displaced, whose forces and slopes are solved together. At the most: by position and pair 1.9 kB at 12 positions of the
paper's drive on half-spaces and 4.1 kB on a ring, 1.1 kB for the joint and 8.8 kB for it on a ring. Analyses of all cases are
held together, their working memory once."""
IN_SLICES, PER_SLICE = 2000.0, 1000.0
"""Memory for a pair in slices at one position beside that, and for each of its slices, bytes: 6.7, 12 and 22 kB by pair with 3, 9
and 21 slices at 12 positions of the paper's drive."""
DISC_PER_PAIR, DISC_PER_SLICE = 60.0, 32.0
"""Of results.nc, 2 kB for each position of the paper's drive; for each slice of a pair line loads and pressures, 27 measured."""


MEMORY_PER_PART, PART_PER_PAIR = 2e8, 900.0
"""Memory for one part of an analysis that is solved part by part, and for a pair of it, bytes: all turns of the paper's drive
are one part."""


KEPT_PER_POSITION = 1e3
"""Memory for the kept results of one position, bytes: 0.9 kB measured for a drive of 100 pins."""


def positions_together(drive: Drive) -> int:
    """Return how many positions of a drive are solved at once where an analysis is solved part by part."""
    each = (PART_PER_PAIR + _of_slices(drive)) * (DISPLACED_PINS if _displaces_pins(drive) else 1.0)
    return max(1, int(MEMORY_PER_PART / (each * pairs_of(drive))))


def memory_per_position(drive: Drive) -> float:
    """Return the memory for one position of an analysis at the most, bytes."""
    several = SEVERAL_DISCS if drive.disc.number_of_discs > 1 else 1.0
    each = (MEMORY_PER_PAIR + _of_slices(drive)) * (DISPLACED_PINS if _displaces_pins(drive) else 1.0)
    return each * pairs_of(drive) * several


def _of_slices(drive: Drive) -> float:
    """Memory for the slices of a pair at one position, bytes: none in the plane."""
    return IN_SLICES + PER_SLICE * drive.contact.slices if drive.contact.slices > 1 else 0.0


def _displaces_pins(drive: Drive) -> bool:
    """Whether something displaces pins under the forces of others: a ring, or beams between discs."""
    beams = [part.beam for part in (drive.pin_wheel, drive.pin_shaft) if part is not None]
    return drive.ring is not None or (drive.disc.number_of_discs > 1 and any(beam is not None for beam in beams))


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
    # Rollers that tilt are kept with the loads of their slices on both races.
    rollers = drive.disc.number_of_discs * drive.crank.number * drive.crank_bearing.number_of_rollers
    kept = KEPT_PER_POSITION + (16.0 * rollers * drive.contact.slices if drive.contact.slices > 1 else 0.0)
    require_room(0.0, memory=kept * positions, folder=folder, option=option)


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
    cases = list(drives)
    each = [
        DISC_PER_PAIR + (DISC_PER_SLICE * case.contact.slices if case.contact.slices > 1 else 0.0) for case in cases
    ]
    kept = sum(size * pairs_of(case) for size, case in zip(each, cases, strict=True)) * positions
    require_room(kept, memory=sum(map(memory_per_position, cases)) * positions, folder=folder, option=option)
