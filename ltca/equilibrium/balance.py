"""Equilibrium of the floating discs at held crank angles (Eq. 43–44, 70–72, 85–89; ``docs/theory/balance.md``)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import FloatArray, take_positions, take_rows
from ltca.compliance.response import Response, Start
from ltca.drive.least_torque import ROUND_OFF_BOUND
from ltca.equilibrium.neighbours import (
    MOST,
    between,
    have_neighbours,
    leading_positions,
    pose_between,
    start_between,
    turned,
)
from ltca.equilibrium.newton import Holding, Search
from ltca.equilibrium.reducer import Reducer
from ltca.errors import ConvergenceError
from ltca.geometry.coordinates import DISC_ROTATION, WHEEL_ANGLE
from ltca.geometry.first_contact import turn_to_contact
from ltca.geometry.pairs import ContactGeometry
from ltca.geometry.play import loose_poses

MAX_ITERATIONS = 100
"""Newton iterations after which a start is given up; ten are usual, and fifty where contacts alternate."""
LOOSE_ITERATIONS = 40
"""The same where wheel and cranks float in their bearings: from their stops a few are enough."""
TORQUE_RATIO = 8.0
"""Ratio of successive torques of the continuation; reduced where a step fails, down to `LEAST_TORQUE_RATIO`."""
MAX_TORQUE_STEPS = 7
"""Most increases of the torque by `TORQUE_RATIO` in search of a start that balances."""
LEAST_TORQUE_RATIO = 1.05
COARSER = 4
"""Leading positions for one that leads these, where evaluations take long."""
LEAST_LED = 360
"""Positions from which some lead the others even where evaluations take little."""
FEW_ITERATIONS = 3
"""Iterations that a nearby start takes at most."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Equilibrium:
    """Balanced positions."""

    crank_angle: FloatArray  # φ_C, rad, shape (positions,)
    wheel_moment: FloatArray  # external, N·mm, shape (positions,)
    pose: FloatArray  # q of `ltca.geometry.coordinates`, shape (positions, coordinates)
    response: Response
    residual: FloatArray  # largest unbalanced force, N, moments divided by `lever_arms`, shape (positions,)
    iterations: NDArray[np.intp]  # Newton's, shape (positions,)


def equilibrium_of_disc(model: Reducer, found: Equilibrium, disc: int) -> Equilibrium:
    """Return the pose, the contacts and the moment of one of several discs."""
    part = found.response.parts[disc]
    return replace(
        found,
        wheel_moment=part.force[:, WHEEL_ANGLE],
        pose=found.pose[:, model.coordinates.columns(disc)],
        response=Response(force=part.force, parts=(part,)),
    )


def lever_arms(model: Reducer) -> FloatArray:
    """Lever arms of the residual, mm: e z_C of discs, e z_P of the wheel, e of twists, half widths of leans, 1 of places."""
    coordinates, geometries = model.coordinates, model.geometries
    eccentricities = [geometry.placement.mean_eccentricity[..., 0] for geometry in geometries]
    ring = np.ones(())
    if coordinates.ring:
        place = geometries[0].placement
        held = place.shaft_pin_centres if place.shaft_pin_centres.size else place.crank_axes
        ring = np.abs(held).mean(axis=-1)
    halves = [np.squeeze(geometry.half_width) for geometry in geometries]
    reaches = [np.squeeze(geometry.half_width + np.abs(geometry.plane)) for geometry in geometries]
    rows = np.broadcast_shapes(ring.shape, *(arm.shape for arm in (*eccentricities, *halves, *reaches)))
    arms = np.ones((*rows, coordinates.size))
    for number, (place, geometry, e) in enumerate(zip(coordinates.rotations, geometries, eccentricities, strict=False)):
        wheel = e * geometry.placement.reduction_ratio
        arms[..., place], arms[..., WHEEL_ANGLE] = wheel - e, wheel
        for twist in coordinates.twist_places:
            arms[..., place - DISC_ROTATION + twist] = e
        for lean in range(coordinates.own - 2 * (1 + coordinates.cranks) * coordinates.leans, coordinates.own):
            arms[..., place - DISC_ROTATION + lean] = halves[number]
        arms[..., coordinates.wheel_lean_place] = reaches[number][..., None]
    if coordinates.ring:
        arms[..., coordinates.ring_place.stop - 1] = ring
    return arms


def solve_equilibrium(
    model: Reducer,
    crank_angle: FloatArray,
    wheel_moment: FloatArray | float,
    start: FloatArray | None = None,
    inner: Start | None = None,
    series: int = 1,
    reference: FloatArray | float = 0.0,
    holding: Holding | None = None,
) -> Equilibrium:
    """Find the pose in which every position of a batch balances; ConvergenceError where one does not.

    `start` has poses to start from, by default first contact, and `inner` the inner unknowns near them. Positions are those of
    `series` drives or torques, equally many of each. Residuals are measured by the moment on the wheel or, where that is
    smaller, `reference`, N·mm; `holding` adjusts the moments to the contacts.
    """
    angle = np.atleast_1d(np.asarray(crank_angle, dtype=float))
    moment = np.broadcast_to(np.asarray(wheel_moment, dtype=float), angle.shape)
    search = _search(model, angle, moment, np.zeros((angle.size, model.coordinates.size)), reference)
    if holding is not None:
        search.moment, search.holding = moment.copy(), holding
    left = np.zeros(0, dtype=np.intp)
    for rows, begin in _stages(search, start, inner, series):
        left = np.append(left, search.iterate(_most(search), rows, begin))
    return _completed(search, np.sort(left))


def follow_equilibrium(
    model: Reducer, found: Equilibrium, wheel_moment: FloatArray, reference: FloatArray | float = 0.0
) -> Equilibrium:
    """Balance positions under other moments, N·mm, from known contacts; `reference` as for `solve_equilibrium`."""
    search = _search(model, found.crank_angle, wheel_moment, found.pose.copy(), reference)
    return _completed(search, search.iterate(_most(search), response=found.response))


def _search(
    model: Reducer, angle: FloatArray, moment: FloatArray, pose: FloatArray, reference: FloatArray | float
) -> Search:
    lever = lever_arms(model)
    load = np.maximum(np.abs(moment), reference) / lever[..., WHEEL_ANGLE]
    return Search(model, angle, moment, lever, load, pose)


def _completed(search: Search, left: NDArray[np.intp]) -> Equilibrium:
    """Balance by other means what Newton's method did not, and return all positions."""
    model, angle = search.model, search.angle
    creeping = search.follow_valley if search.symmetric else search.reduce_residual
    if left.size and _is_loose(model):
        left = _from_stops(search, left)
    left = np.array([row for row in left if not creeping(int(row))], dtype=np.intp)
    if left.size and not _is_loose(model):
        left = _from_stops(search, left)
    if left.size and not np.all(_below_round_off(search, left)):
        left = _follow_down(search, left)
    if left.size:
        raise _failure(search, left)
    return Equilibrium(
        crank_angle=angle,
        wheel_moment=np.array(search.moment),
        pose=search.pose,
        response=search.contacts()[1],
        residual=search.residual,
        iterations=search.iterations,
    )


def _stages(
    search: Search, start: FloatArray | None, inner: Start | None, series: int
) -> Iterator[tuple[NDArray[np.intp], Start | None]]:
    """Yield positions to balance together, with inner unknowns to begin from: leading ones, then the others from these."""
    model, angle, moment, pose = search.model, search.angle, search.moment, search.pose
    everything, count = np.arange(angle.size), angle.size // series
    # Interpolation between more leading positions saves steps that are cheap; a start that is given is one already.
    most = MOST if start is not None or _is_costly(model) else MOST // 2
    leading = leading_positions(model.discs[0].geometry, angle[:count], moment[:count], most)
    alike = all(have_neighbours(each) for each in moment.reshape(series, count))
    if start is not None:
        pose[:] = start
        leader = leading[0] + count * np.arange(series)
        rest = everything
        if alike:
            yield leader, take_positions(inner, leader)
            rest = np.setdiff1d(everything, leader, assume_unique=True)
            known = np.isin(leader, search.contacts()[0]) if search.balanced else np.zeros(series, dtype=bool)
            moved = turned(pose[leader] - start[leader], -angle[leader], model.coordinates) * known[:, None]
            pose[rest] += turned(moved[rest // count], angle[rest], model.coordinates)
        first = np.intersect1d(rest, leading) if series == 1 else rest
        yield first, take_positions(inner, first)
        rest = np.setdiff1d(rest, first, assume_unique=True)
        # A start that leads somewhere in a few steps is as good as what lies between neighbours.
        near = not search.balanced or (not _is_costly(model) and np.median(search.iterations[first]) <= FEW_ITERATIONS)
        if rest.size:
            yield rest, take_positions(inner, rest) if near else _place(search, rest)
        return
    # One position of each series leads: seen from the crank, disc and wheel do the same in all others.
    leaders = leading[0] + count * np.arange(series) if alike else everything
    pose[leaders] = _at_first_contact(model.take(leaders), angle[leaders], moment[leaders])
    yield leaders, None
    rest = np.setdiff1d(everything, leaders, assume_unique=True)
    led = np.zeros(series, dtype=bool)
    if search.balanced:
        led[search.contacts()[0] // count] = True
    beside, alone = rest[led[rest // count]], rest[~led[rest // count]]
    # Where evaluations take long, or several cranks make positions differ: few beside the leader, then those between them.
    levels = [beside]
    if series == 1 and leading.size < count and (count >= LEAST_LED or _is_costly(model)):
        some = np.isin(beside, leading)
        few = np.isin(beside, leading[::COARSER])
        levels = [beside[few], beside[some & ~few], beside[~some]]
    for number, level in enumerate(levels):
        if level.size:
            yield level, _place(search, level, (np.cumsum(led) - 1)[level // count] if number == 0 else None)
    if alone.size:
        pose[alone] = _at_first_contact(model.take(alone), angle[alone], moment[alone])
        yield alone, None


def _place(search: Search, rows: NDArray[np.intp], leaders: NDArray[np.intp] | None = None) -> Start:
    """Place positions between balanced ones, or as their leaders stand, numbered among these; return inner unknowns."""
    model, wanted = search.model, search.angle[rows]
    known, contacts = search.contacts()
    angle = search.angle[known]
    way = between(angle, wanted) if leaders is None else (leaders[:, None], np.ones((rows.size, 1)))
    if search.holding is not None:
        search.moment[rows] = (way[1] * search.moment[known][way[0]]).sum(axis=1)
    search.pose[rows] = pose_between(angle, search.pose[known], wanted, model.coordinates, way)
    ratio = model.discs[0].geometry.placement.reduction_ratio
    return start_between(angle, Start.after(contacts), wanted, ratio, way)


def _at_first_contact(model: Reducer, angle: FloatArray, moment: FloatArray) -> FloatArray:
    """Poses with the discs on the inner-race centres and the wheel turned until the first pin touches one of them."""
    pose = np.zeros((angle.size, model.coordinates.size))
    sense = np.where(moment < 0.0, -1, 1)
    for value in (-1, 1):
        rows = sense == value
        if not rows.any():
            continue
        turned = [_take_up(take_rows(geometry, rows), angle[rows], value) for geometry in model.geometries]
        pose[rows, WHEEL_ANGLE] = value * np.min(value * np.stack(turned), axis=0)
    return pose


def _part(search: Search, rows: NDArray[np.intp], factor: FloatArray, pose: FloatArray) -> Search:
    """The search for some positions under other torques."""
    model = search.model.take(rows)
    moment, load = factor * search.moment[rows], factor * search.load[rows]
    return Search(model, search.angle[rows], moment, search.levers(rows), load, pose.copy())


def _is_costly(model: Reducer) -> bool:
    """Whether evaluations of a few positions take longer than neighbours save of many."""
    several = len(model.discs) * model.discs[0].geometry.placement.cranks > 1
    coupled = any(disc.coefficients is not None for disc in model.discs)
    return several or coupled or model.pins is not None or bool(model.coordinates.leans) or not model.symmetric


def _is_loose(model: Reducer) -> bool:
    """Whether wheel or cranks of any drive are free in their bearings."""
    return any(geometry.has_loose_supports for geometry in model.geometries)


def _most(search: Search) -> int:
    """Iterations after which a start is given up."""
    return LOOSE_ITERATIONS if _is_loose(search.model) else MAX_ITERATIONS


def poses_at_stops(model: Reducer, angle: FloatArray, moment: FloatArray) -> FloatArray | None:
    """Return the poses where the wheel stops without load; None where nothing stops it."""
    try:
        return loose_poses(model.geometries, angle, np.where(moment < 0.0, -1.0, 1.0))
    except ConvergenceError:
        return None


def _from_stops(search: Search, rows: NDArray[np.intp]) -> NDArray[np.intp]:
    """Solve positions from where the wheel stops without load, with all that floats in its bearings; return the others."""
    pose = poses_at_stops(search.model.take(rows), search.angle[rows], search.moment[rows])
    if pose is None:
        return rows
    part = _part(search, rows, np.ones(rows.size), pose)
    try:
        lost = part.iterate(MAX_ITERATIONS)
    except ConvergenceError:  # contacts may be lost on the way
        return rows
    search.iterations[rows] += part.iterations
    if lost.size < rows.size:
        _take_over(search, rows, part, np.ones(rows.size, dtype=bool))
    return rows[lost]


def _take_over(search: Search, rows: NDArray[np.intp], part: Search, wanted: NDArray[np.bool_]) -> None:
    """Take over the wanted positions that the search for some of them has balanced."""
    kept, contacts = part.contacts()
    own = wanted[kept]
    there = rows[kept[own]]
    search.pose[there], search.residual[there] = part.pose[kept[own]], part.residual[kept[own]]
    search.slipped[there] = False
    search.keep(rows[kept], contacts, own)


def _follow_down(search: Search, rows: NDArray[np.intp]) -> NDArray[np.intp]:
    """Solve positions from heavier torques, which leave no play, down to their own; return those that have no balance there."""
    pose = _at_first_contact(search.model.take(rows), search.angle[rows], search.moment[rows])
    level = np.full(rows.size, np.nan)
    for power in range(1, MAX_TORQUE_STEPS + 1):
        new = np.nonzero(np.isnan(level))[0]
        if new.size == 0:
            break
        part = _part(search, rows[new], np.full(new.size, TORQUE_RATIO**power), pose[new])
        found = np.setdiff1d(np.arange(new.size), part.iterate(MAX_ITERATIONS))
        search.iterations[rows[new]] += part.iterations
        pose[new[found]], level[new[found]] = part.pose[found], TORQUE_RATIO**power
    ratio = np.full(rows.size, TORQUE_RATIO)
    going = np.nonzero(~np.isnan(level))[0]
    while going.size:
        target = np.maximum(level[going] / ratio[going], 1.0)
        part = _part(search, rows[going], target, pose[going])
        lost = part.iterate(MAX_ITERATIONS)
        search.iterations[rows[going]] += part.iterations
        found = np.setdiff1d(np.arange(going.size), lost)
        pose[going[found]], level[going[found]] = part.pose[found], target[found]
        ratio[going[found]] = np.minimum(ratio[going[found]] ** 2, TORQUE_RATIO)
        ratio[going[lost]] = np.sqrt(ratio[going[lost]])
        if np.any(target[found] == 1.0):
            _take_over(search, rows[going], part, target == 1.0)
        going = going[(level[going] > 1.0) & (ratio[going] > LEAST_TORQUE_RATIO)]
    return np.asarray(rows[level != 1.0])


def _below_round_off(search: Search, rows: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Whether loads are so small that round-off of the approaches, times their stiffness, is no small part of them."""
    response = search.evaluate(rows, search.pose[rows], None)
    return np.asarray(search.round_off(rows, response) > ROUND_OFF_BOUND * search.load[rows])


def _failure(search: Search, rows: NDArray[np.intp]) -> ConvergenceError:
    """The error that names the worst of the positions that do not balance."""
    residual, count = search.history[-1], search.angle.size
    slipped = rows[search.slipped[rows]]
    worst = int(slipped[0] if slipped.size else rows[np.argmax((residual / search.load)[rows])])
    place = f"no equilibrium at crank angle {search.angle[worst]:.6g} rad (position {worst} of {count}"
    # Infinite before it was its turn.
    history = [float(values[worst]) for values in search.history if not np.isinf(values[worst])]
    if slipped.size:
        return ConvergenceError(
            f"{place}): the teeth slip, wheel or disc turns by more than half a pin pitch ({search.half_pitch:.4g} rad) "
            f"under {abs(search.moment[worst]):.4g} N·mm; residual in N",
            history,
        )
    if np.all(_below_round_off(search, rows[rows == worst])):
        return ConvergenceError(
            f"{place}, {rows.size} unbalanced): {abs(search.moment[worst]):.4g} N·mm on the wheel are a load of "
            f"{search.load[worst]:.3g} N, too small to be balanced: approaches are known to round-off of the pin circle "
            "alone, and their stiffness makes more of it; residual in N",
            history,
        )
    return ConvergenceError(
        f"{place}, {rows.size} unbalanced) after {search.iterations[worst]} iterations, under heavier torques, too; "
        f"residual in N against a load of {search.load[worst]:.4g} N",
        history,
    )


def _take_up(geometry: ContactGeometry, angle: FloatArray, sense: int) -> FloatArray:
    """Wheel angles at first contact; zero where pins interfere so that turning the wheel alone cannot find it."""
    try:
        turned = turn_to_contact(geometry, angle, WHEEL_ANGLE, sense)[0]
        return np.where(np.abs(turned) < np.pi / geometry.placement.reduction_ratio, turned, 0.0)
    except ConvergenceError:
        if angle.size == 1:
            return np.zeros(1)
        halves = np.array_split(np.arange(angle.size), 2)
        return np.concatenate([_take_up(take_rows(geometry, half), angle[half], sense) for half in halves])
