"""Extremes of an analysis between its positions: peak-to-peak values and largest loads that do not hang on sampling.

Positions 2πk/N see N/gcd(N, z_C) phases of the mesh only: 13 or 26 positions of a disc of 13 teeth find one or two
points of every flank's passage. And where contacts open, the wheel angle has kinks: its extremes are sharp, and even
hundreds of positions miss them by per cents. So the turn is filled up until every passage of a tooth, a hole or a
roller is resolved, and then searched about its highest samples.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, gcd

import numpy as np

from ltca.analysis.contact_arrays import array_of, contact_arrays
from ltca.analysis.loaded_analysis import LoadedAnalysis, analyse
from ltca.analysis.memory_need import positions_together
from ltca.arrays import FloatArray, stack_drives, take_positions
from ltca.compliance.response import ContactPressures
from ltca.drive.parts import Drive
from ltca.drive.single_discs import single_discs
from ltca.drive.units.quantities import ARCSEC
from ltca.equilibrium.balance import Equilibrium
from ltca.equilibrium.neighbours import pose_between
from ltca.equilibrium.output_angle import wheel_angle_of_input
from ltca.equilibrium.output_torque import solve_at_output
from ltca.equilibrium.reducer import Reducer, bearing_forces
from ltca.geometry.coordinates import Coordinates
from ltca.geometry.placement import Placement, position_angles
from ltca.quantities import REFINED

TURN = 2.0 * np.pi
RESOLVED = 8
"""Positions per passage of a tooth, hole or roller that resolve its peaks; fewer phases of the mesh give a warning."""
SCAN_POSITIONS_PER_PASSAGE = 24
"""Positions per passage at which the search starts, as far as `SCAN_POSITIONS` in total allow."""
SCAN_POSITIONS = 720
"""Most positions of a turn at which the search starts; never fewer than `RESOLVED` per passage."""
RELATIVE_REFINEMENT_TOLERANCE = 1e-3
"""Gain below which an extreme is not refined further, relative to the range of a signed quantity or to the largest load or
pressure."""
MAX_REFINEMENTS = 6
MAX_TRIALS_PER_SIDE = 4
"""Trial positions for each extreme on either side of its highest samples, per refinement."""
LEAST_SPACING = 1e-3
"""Least distance of a trial position from a sample, relative to a passage."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Extremes:
    """Extremes over one turn of the crank, both ends included; never less than those of the given positions.

    Attributes
    ----------
    values : dict of str to float
        Scalars of `ltca.quantities.REFINED` by name, in their units; not a number where the engine cannot say it.
    added_positions, added_light_positions : int
        Positions solved beyond the given ones, at either torque.
    """

    values: dict[str, float]
    added_positions: int
    added_light_positions: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Sampling:
    """How crank angles sample the mesh.

    Attributes
    ----------
    positions : int
        How many there are.
    positions_per_mesh_period : float
        Positions by passages of a tooth, 360°/z_C, in a whole turn, or between the outermost angles of part of one.
    distinct_mesh_phases : int
        Different places in that passage among them.
    """

    positions: int
    positions_per_mesh_period: float
    distinct_mesh_phases: int


def is_full_turn(crank_angle: FloatArray) -> bool:
    """Tell whether crank angles are 2πk/N, k = 0 … N−1, with more than one position."""
    count = crank_angle.size
    return count > 1 and np.allclose(crank_angle, position_angles(count), rtol=0.0, atol=1e-9)


def sampling(drive: Drive, crank_angle: FloatArray) -> Sampling:
    """Return how crank angles, rad, sample the mesh of a drive.

    Examples
    --------
    >>> from ltca.reading.drive_file import load_drive
    >>> sampling(load_drive("paper").cases["CS-1"], position_angles(26)).distinct_mesh_phases
    2
    """
    teeth, count = drive.disc.number_of_teeth, crank_angle.size
    whole = is_full_turn(crank_angle)
    passages = float(teeth) if whole else max(float(np.ptp(crank_angle)) * teeth / TURN, 1.0)
    return Sampling(
        positions=count,
        positions_per_mesh_period=count / passages,
        distinct_mesh_phases=_distinct_phases(crank_angle, teeth),
    )


def sampling_warning(
    drive: Drive, crank_angle: FloatArray, *, refined: bool = True, typed: str = "--positions {}"
) -> str | None:
    """Return what to say of crank angles that see too few phases of the mesh; None where they see enough.

    Parameters
    ----------
    drive : Drive
        For its teeth and holes.
    crank_angle : array, shape (positions,)
        φ_C, rad; nothing is said of a single one, which has neither mean nor range.
    refined : bool
        Whether extremes are refined between them. Where they are not, the angles have to see twice as many phases, of
        the holes, too.
    typed : str
        How the user gives a number of positions over the turn; empty where the user cannot.
    """
    found = sampling(drive, crank_angle)
    teeth, holes = drive.disc.number_of_teeth, drive.number_of_holes or 1
    needed = RESOLVED if refined else 2 * RESOLVED
    seen, what = found.distinct_mesh_phases, f"mesh of {teeth} teeth"
    if not refined and seen >= needed:
        seen, what = _distinct_phases(crank_angle, holes), f"{holes} holes"
    if found.positions == 1 or seen >= needed:
        return None
    enough = next(
        count for count in range(2 * RESOLVED, 2 * RESOLVED + 2 * teeth * holes) if gcd(count, teeth * holes) == 1
    )
    return (
        f"{found.positions} positions see {seen} phase{'s' if seen > 1 else ''} of the {what}: values over them alone say "
        "little of the turn" + (f"; take {typed.format(enough)}" if typed else "")
    )


def _distinct_phases(crank_angle: FloatArray, periods: int) -> int:
    """How many different places in a period of which there are some in a turn."""
    if is_full_turn(crank_angle):
        return crank_angle.size // gcd(crank_angle.size, periods)
    # A phase is a place on a circle; 1e-9 rad of crank angle are the round-off of many turns.
    phases = np.sort(np.mod(crank_angle * periods / TURN, 1.0))
    apart = np.diff(phases, append=phases[0] + 1.0) > 1e-9 * periods
    return max(1, int(np.count_nonzero(apart)))


def refine_extremes(analysis: LoadedAnalysis) -> Extremes:
    """Return the extremes of an analysis over the whole turn that its positions sample.

    Parameters
    ----------
    analysis : LoadedAnalysis
        At crank angles 2πk/N (`is_full_turn`). Positions in between are balanced on its compliance by Newton's method,
        started from their neighbours' poses.

    Raises
    ------
    ValueError
        When the positions are no full turn.
    ConvergenceError
        When a position in between does not balance.

    Notes
    -----
    Rollers come back to their places after many turns only, so a turn ends elsewhere than it began: both ends belong
    to it. On grids, a hundred times as dear, the places of the extremes are those found on tables, and only they are
    solved.
    """
    (found,) = refine_together([analysis])
    return found


def refine_together(analyses: Sequence[LoadedAnalysis]) -> list[Extremes]:
    """Return the same of several analyses; where there are more than one, of engines that take batches (`stack_drives`).

    Raises what `refine_extremes` does where it is due for any of them.
    """
    if not all(is_full_turn(analysis.full.crank_angle) for analysis in analyses):
        raise ValueError("extremes are refined over full turns, 2πk/N with more than one position")
    if analyses[0].engine.options["contacts"] == "grids":
        return [_extremes(analysis, *_on_grids(analysis)) for analysis in analyses]
    searched = zip(analyses, _searched(analyses), strict=True)
    return [_extremes(analysis, full, light) for analysis, (full, light) in searched]


def _on_grids(analysis: LoadedAnalysis) -> tuple[_Stage, _Stage]:
    """The stages of an analysis on grids, with the extremes of tables solved on them."""
    ((near, near_light),) = _searched([analyse(analysis.drive, analysis.full.crank_angle, analysis.torque)])
    stages = _stages(analysis)
    places = near.search.places(), near_light.search.places()
    start = np.concatenate([near.start(places[0]), near_light.start(places[1])])
    _solve([analysis], [stages], [places], start)
    return stages


def _extremes(analysis: LoadedAnalysis, full: _Stage, light: _Stage) -> Extremes:
    given = analysis.full.crank_angle
    found, found_light = full.search.largest(), light.search.largest()
    values = dict.fromkeys(REFINED, np.nan) | {name: value for name, value in found.items() if name in REFINED}
    for name, torque in (("ptp_transmission_error", found), ("ptp_transmission_error_light", found_light)):
        values[name] = ARCSEC * (torque["wheel_angle"] + torque["wheel_angle_negative"])
    values["ptp_tangential_bearing_load"] = max(
        found[f"tangential_{bearing}"] + found[f"tangential_negative_{bearing}"]
        for bearing in range(analysis.bearing_tangential[0].size)
    )
    return Extremes(
        values=values,
        added_positions=full.search.angle.size - given.size,
        added_light_positions=light.search.angle.size - given.size,
    )


def _stages(analysis: LoadedAnalysis) -> tuple[_Stage, _Stage]:
    passages = passages_per_turn(analysis.drive)
    model, full = analysis.model, _full_signals(analysis, analysis.full, analysis.pressures)
    light = _wheel_signals(analysis, analysis.light)
    return (
        _Stage.of(model, analysis.full, analysis.torque, full, passages),
        _Stage.of(model, analysis.light, analysis.drive.load.light_torque, light, passages),
    )


def _searched(analyses: Sequence[LoadedAnalysis]) -> list[tuple[_Stage, _Stage]]:
    """Fill the turn of each analysis up and search it, both torques and all analyses together."""
    stages = [_stages(analysis) for analysis in analyses]
    scans = [scan_angles(each.full.crank_angle.size, passages_per_turn(each.drive)) for each in analyses]
    going, places = list(range(len(analyses))), [(scan, scan) for scan in scans]
    for _ in range(MAX_REFINEMENTS + 1):
        asked = [(stages[number], places[number]) for number in going]
        start = np.concatenate(
            [stage.start(at) for pair, angles in asked for stage, at in zip(pair, angles, strict=True)]
        )
        _solve(
            [analyses[number] for number in going],
            [stages[number] for number in going],
            [places[number] for number in going],
            start,
        )
        for number in going:
            full, light = stages[number]
            places[number] = full.search.promising(), light.search.promising()
        going = [number for number in going if places[number][0].size + places[number][1].size]
        if not going:
            break
    return stages


def passages_per_turn(drive: Drive) -> int:
    """Return how many teeth, holes or rollers, whichever are most, pass the load in a turn of the crank."""
    rollers = drive.crank_bearing.number_of_rollers * (
        1.0 - float(Placement.of_drive(single_discs(drive)[0]).cage_speed)
    )
    return max(drive.disc.number_of_teeth, drive.number_of_holes, ceil(rollers))


def scan_angles(positions: int, passages: int) -> FloatArray:
    """Return what resolves every passage when added to positions 2πk/N, and the end of the turn, rad.

    Examples
    --------
    >>> scan_angles(13, 13).size, scan_angles(360, 13).size
    (300, 1)
    """
    parts = ceil(max(RESOLVED * passages, min(SCAN_POSITIONS_PER_PASSAGE * passages, SCAN_POSITIONS)) / positions)
    places = np.arange(positions * parts + 1)
    return np.asarray(TURN * places[(places % parts > 0) | (places == places[-1])] / (positions * parts))


@dataclass(slots=True, kw_only=True)
class PeakSearch:
    """Search for the largest values of sampled curves: tells where they may be larger than any sample.

    Between a highest sample and the next one a curve that bends down stays below the lines that its sides, prolonged,
    make there: their crossing bounds it, and where contacts open or close and both sides are all but straight, it is
    the peak itself.

    Attributes
    ----------
    angle : array, shape (samples,)
        Ascending, rad.
    values : array, shape (samples, columns)
        The curves.
    groups : dict of str to (slice, bool)
        Columns whose largest value is one extreme, and whether that is one end of a range.
    nearest : float
        Places nearer to a sample are not asked for, rad.
    """

    angle: FloatArray
    values: FloatArray
    groups: dict[str, tuple[slice, bool]]
    nearest: float

    def add(self, angle: FloatArray, values: FloatArray) -> None:
        """Take new samples."""
        order = np.argsort(np.concatenate([self.angle, angle]), kind="stable")
        self.angle = np.concatenate([self.angle, angle])[order]
        self.values = np.concatenate([self.values, values])[order]

    def largest(self) -> dict[str, float]:
        """Return the largest value of every group."""
        return {name: float(np.max(self.values[:, columns])) for name, (columns, _) in self.groups.items()}

    def places(self) -> FloatArray:
        """Return where the largest values of the groups are, ascending, rad."""
        rows = [np.argmax(np.max(self.values[:, columns], axis=1)) for columns, _ in self.groups.values()]
        return np.asarray(self.angle[np.unique(rows)])

    def promising(self) -> FloatArray:
        """Return the places where an extreme may exceed every sample by more than the tolerance, ascending, rad."""
        found = [np.zeros(0)]
        for columns, is_end in self.groups.values():
            values = self.values[:, columns]
            least = np.max(values) + RELATIVE_REFINEMENT_TOLERANCE * (np.ptp(values) if is_end else np.max(values))
            for places, heights in _kinks_on_both_sides(self.angle, values):
                height = heights.ravel()
                first = np.argsort(-height, kind="stable")[:MAX_TRIALS_PER_SIDE]
                found.append(places.ravel()[first[height[first] > least]])
        kept: list[float] = []
        for place in np.sort(np.concatenate(found)):
            apart = place - kept[-1] if kept else np.inf
            if min(apart, np.min(np.abs(self.angle - place))) > self.nearest:
                kept.append(float(place))
        return np.array(kept)


def _kinks_on_both_sides(x: FloatArray, values: FloatArray) -> list[tuple[FloatArray, FloatArray]]:
    """Crossings of lines in the intervals behind and before each highest sample."""
    places, heights = _kinks_behind(-x[::-1], values[::-1])
    return [_kinks_behind(x, values), (-places[::-1], heights[::-1])]


def _kinks_behind(x: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Crossings of the line that ends in each highest sample with the one that begins in the next sample."""
    x = x[:, None]
    slope = np.diff(values, axis=0) / np.diff(x, axis=0)
    rise, fall, width = slope[:-2], slope[2:], x[2:-1] - x[1:-2]
    peak = (rise > 0.0) & (slope[1:-1] <= 0.0) & (fall < rise)
    along = (values[2:-1] - values[1:-2] - fall * width) / np.where(peak, rise - fall, 1.0)
    along = np.clip(along, 0.0, width)
    return x[1:-2] + along, np.where(peak, values[1:-2] + rise * along, -np.inf)


@dataclass(slots=True, kw_only=True)
class _Stage:
    """The positions at one torque: their search, and their poses."""

    search: PeakSearch
    angle: FloatArray
    pose: FloatArray
    torque: float
    coordinates: Coordinates

    @classmethod
    def of(
        cls, model: Reducer, found: Equilibrium, torque: float, signals: dict[str, FloatArray], passages: int
    ) -> _Stage:
        groups, column = {}, 0
        for name, values in signals.items():
            if not values.shape[1]:
                continue  # holes without a pin shaft
            groups[name] = (slice(column, column + values.shape[1]), name.startswith(("wheel", "tangential")))
            column += values.shape[1]
        search = PeakSearch(
            angle=found.crank_angle,
            values=np.hstack(list(signals.values())),
            groups=groups,
            nearest=LEAST_SPACING * TURN / passages,
        )
        return cls(
            search=search, angle=found.crank_angle, pose=found.pose, torque=torque, coordinates=model.coordinates
        )

    def start(self, angle: FloatArray) -> FloatArray:
        """Poses between those known."""
        return pose_between(self.angle, self.pose, angle, self.coordinates)

    def add(self, angle: FloatArray, pose: FloatArray, signals: dict[str, FloatArray]) -> None:
        self.search.add(angle, np.hstack(list(signals.values())))
        joined = np.concatenate([self.angle, angle])
        order = np.argsort(joined, kind="stable")
        self.angle, self.pose = joined[order], np.concatenate([self.pose, pose])[order]


def _solve(
    analyses: Sequence[LoadedAnalysis],
    stages: Sequence[tuple[_Stage, _Stage]],
    places: Sequence[tuple[FloatArray, FloatArray]],
    start: FloatArray,
) -> None:
    """Balance new positions of both torques of each analysis and give them to their stages, in batches that memory holds."""
    most = min(positions_together(analysis.drive) for analysis in analyses)
    angle = np.concatenate([at for pair in places for at in pair])
    ends = np.cumsum([at.size for pair in places for at in pair])[:-1]
    for first in range(0, angle.size, most):
        batch = slice(first, first + most)
        parts = np.split(angle[batch], np.clip(ends - first, 0, most))
        pairs = list(zip(parts[::2], parts[1::2], strict=True))
        rows = [row for row, (full, light) in enumerate(pairs) if full.size + light.size]
        _solve_batch(
            [analyses[row] for row in rows], [stages[row] for row in rows], [pairs[row] for row in rows], start[batch]
        )


def _solve_batch(
    analyses: Sequence[LoadedAnalysis],
    stages: Sequence[tuple[_Stage, _Stage]],
    places: Sequence[tuple[FloatArray, FloatArray]],
    start: FloatArray,
) -> None:
    """Balance positions of analyses, each of which has some, and give them to their stages."""
    angle = np.concatenate([at for pair in places for at in pair])
    counts = [at.size for pair in places for at in pair]
    torque = np.repeat([stage.torque for pair in stages for stage in pair], counts)
    if len(analyses) == 1:
        model, drives = analyses[0].model, [analyses[0].drive]
    else:
        rows = np.repeat(np.arange(len(analyses)), [full.size + light.size for full, light in places])
        model = stack_drives([analysis.model for analysis in analyses], 1).take(rows)
        drives = [analyses[row].drive for row in rows.tolist()]
    found, first = solve_at_output(model, drives, angle, torque, start), 0
    for analysis, pair, angles in zip(analyses, stages, places, strict=True):
        for stage, at in zip(pair, angles, strict=True):
            if not at.size:
                continue
            part = take_positions(found, np.arange(first, first + at.size))
            first += at.size
            if stage is pair[0]:
                signals = _full_signals(analysis, part, analysis.model.pressures(part.response))
            else:
                signals = _wheel_signals(analysis, part)
            stage.add(at, part.pose, signals)


def _wheel_signals(analysis: LoadedAnalysis, found: Equilibrium) -> dict[str, FloatArray]:
    output = analysis.drive.output_per_wheel_angle * wheel_angle_of_input(analysis.model, found)[:, None]
    return {"wheel_angle": output, "wheel_angle_negative": -output}


def _full_signals(analysis: LoadedAnalysis, found: Equilibrium, pressures: ContactPressures) -> dict[str, FloatArray]:
    arrays = contact_arrays(found.response, pressures)
    push = bearing_forces(analysis.model, found.crank_angle, found.response).reshape(found.crank_angle.size, -1)
    tangential = push.imag
    return {
        **_wheel_signals(analysis, found),
        **{f"tangential_{bearing}": column[:, None] for bearing, column in enumerate(tangential.T)},
        **{f"tangential_negative_{bearing}": -column[:, None] for bearing, column in enumerate(tangential.T)},
        "max_bearing_load": np.abs(push),
        **{name: values for name, scalar in REFINED.items() if (values := array_of(arrays, scalar.of)) is not None},
    }
