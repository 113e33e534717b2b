"""A series of positions: condensed pins and rollers are handed from each position to the next.

They depend on shape, grading and material alone, never on the crank angle, so every solution is equal to the last bit
to the one found alone, in whatever order the positions come and wherever a series was broken off.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from fem.drive.model import RoundGroup
from fem.options import DEFAULT_OPTIONS, SolutionOptions
from fem.reducer.solution import ReducerSolution, solve_reducer
from ltca.drive.parts import Drive


def solve_positions(
    drive: Drive,
    crank_angles: Iterable[float],
    options: SolutionOptions = DEFAULT_OPTIONS,
    *,
    torque: float | None = None,
    progress: Callable[[str], None] | None = None,
) -> Iterator[ReducerSolution]:
    """Solve a drive at one crank angle after the other; a solution is computed when it is asked for and not kept.

    Parameters
    ----------
    drive : Drive
        The drive in one case, of any number of discs, either member held.
    crank_angles : iterable of float
        φ_C, rad.
    options, torque, progress
        As for `fem.reducer.solution.solve_reducer`.

    Yields
    ------
    ReducerSolution
        In the order of the crank angles.

    Raises
    ------
    CycloError
        As `solve_reducer` does.
    """
    rounds: tuple[RoundGroup, ...] = ()
    for crank_angle in crank_angles:
        solution = solve_reducer(drive, crank_angle, options, torque=torque, rounds=rounds, progress=progress)
        rounds = solution.rounds
        yield solution
