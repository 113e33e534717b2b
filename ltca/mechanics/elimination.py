"""Elimination of deformations, displacements of pins and places of rollers from the equations of all contacts."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import FloatArray
from ltca.mechanics.displaced_pins import PinMembers, solved
from ltca.mechanics.places import by_rows
from ltca.mechanics.pressing import Pressing, assembled, bends, bores_moved, gradient_with_crank, turn_with_cages

ROUGHLY_SETTLED = 0.02
"""Largest correction of a deformation, by the largest approach, at which a step of the pose is judged."""
LEAST_ROOM = 1e-7
"""Correction of a roller that is always allowed, mm: one that is hardly pressed would go on by less for ever."""
LEAST_TURNING = 1e-9
"""Least stiffness of a roller against leaning by that of its place and the square of half the width."""


class Eliminated(NamedTuple):
    """Force and tangent of the pose with everything else eliminated."""

    force: FloatArray
    tangent: FloatArray
    dx: FloatArray  # corrections of places and leans of rollers, mm
    dx_by_pose: FloatArray
    de: FloatArray  # corrections of deformations, mm
    de_by_pose: FloatArray
    aside: FloatArray | None  # pressed across the normals of displaced pins, by the pose and, last, at it


def eliminate_rollers(at: Any) -> None:
    """Condense each roller by itself where nothing deforms but the contacts, in the plane (Eq. 66, 70–72).

    With the stiffnesses k of its two contacts, the cosine c between ray and normal n in the bore, and the load F there, which
    turns by its place as s (n across the ray), a roller yields along its ray with k_i + c² k_o + F s²/l. The rollers of a crank
    are one spring then between bore and race, Σ a n nᵀ + b t tᵀ + m (n tᵀ + t nᵀ).
    """
    system, (rows, size) = at.system, (at.pose.shape[0], at.size)
    load, stiffness = at.load[:, 0], at.stiffness[0]
    at.force, at.tangent = np.zeros((rows, size)), np.zeros((rows, size, size))
    at.dx, at.by_own = np.zeros((rows, system.discs * system.rollers, 1)), []
    for disc, (places, own) in enumerate(zip(at.discs, at.columns, strict=True)):
        pins, bores, holes, races = system.of_kind[disc]
        n, carried, k_bore, k_race = places.outward, load[:, bores], stiffness[:, bores], stiffness[:, races]
        held = k_bore * places.cosine
        by_place, unbalanced = k_race + held * places.cosine, load[:, races] - places.cosine * carried
        if not at.by_crank:
            bend = carried / places.length
            slanted = bend * places.slant
            by_place = by_place + slanted * places.slant
        by_place = np.where(by_place != 0.0, by_place, np.inf)
        share, step = held / by_place, unbalanced / by_place
        cranks = places.bores.arm.shape[1]
        shape = rows, cranks, -1, 1
        normal = n.view(float).reshape(rows, cranks, -1, 2)
        basis, pressed = normal, (k_bore - held * share).reshape(shape) * normal
        loads, follow = (carried + held * step).reshape(shape), share.reshape(shape) * normal
        if not at.by_crank:
            across, aside = (1j * n).view(float).reshape(normal.shape), slanted / by_place
            mixed, turning = (held * aside).reshape(shape), (bend - slanted * aside).reshape(shape)
            basis = np.concatenate((normal, across), axis=2)
            pressed = np.concatenate((pressed - mixed * across, turning * across - mixed * normal), axis=2)
            loads = np.concatenate((loads, (slanted * step).reshape(shape)), axis=2)
            follow = follow + aside.reshape(shape) * across
        moved = bores_moved(at, places)
        springs, pushes = (np.matmul(basis.swapaxes(2, 3), each) for each in (pressed, loads))
        gradient = gradient_with_crank(
            at, places, np.concatenate((places.flank.gradient, places.holes.gradient), axis=1)
        )
        of_bores = moved.reshape(rows, 2 * cranks, -1)
        back = np.concatenate((gradient, of_bores), axis=1).swapaxes(1, 2)
        stiff = np.concatenate((stiffness[:, pins], stiffness[:, holes]), axis=1)[..., None]
        pressed = np.concatenate((stiff * gradient, np.matmul(springs, moved).reshape(of_bores.shape)), axis=1)
        if at.by_slope is not None:
            pressed[:, : system.pins] += at.by_slope.load[:, 0, pins][..., own]
        pushes = -pushes.reshape(rows, -1)
        force = np.matmul(back, np.concatenate((load[:, pins], load[:, holes], pushes), axis=1)[..., None])[..., 0]
        tangent = np.matmul(back, pressed)
        if not at.by_crank:
            tangent += bends(at, disc)
        else:
            turned = system.cage_speed * (pushes.view(complex) * -1j).view(float)
            turn_with_cages(tangent, turned, of_bores)
        of_rollers = slice(disc * system.rollers, (disc + 1) * system.rollers)
        followed = np.matmul(-follow.view(float).reshape(rows, cranks, -1, 2), moved).reshape(rows, system.rollers, -1)
        if system.discs > 1:
            at.force[:, own] += force
            at.tangent[:, own[:, None], own] += tangent
        else:
            at.force, at.tangent = force, tangent
        at.by_own.append(followed[:, :, None])
        at.dx[:, of_rollers, 0] = -step
    at.moved = np.abs(at.dx[..., 0]).max(axis=1, initial=0.0)


def eliminate_by_disc(at: Any) -> None:
    """Condense rollers disc by disc where nothing deforms but the contacts; displaced pins count as if at rest."""
    system, (rows, size) = at.system, (at.pose.shape[0], at.size)
    at.force, at.tangent = np.zeros((rows, size)), np.zeros((rows, size, size))
    dx, at.by_own = [], []
    for disc, (part, own) in enumerate(zip(at.pressing, at.columns, strict=True)):
        _, bores, _, races = at.local[disc]
        outward, inward = part.presses
        rollers, components, count = part.placed.shape[1:]
        pressed = loads_of(part.stiffness, part.g)
        if at.by_slope is not None:
            pressed += at.by_slope.load[:, :, at.at[disc][0].start : at.at[disc][3].stop][..., own]
        mine = [part.force_map, pressed]
        if at.shifts is not None:
            mine = [np.concatenate((each[:, :, bores], each[:, :, races]), axis=2) for each in mine]
        flat, along = (each.reshape(rows, -1, count) for each in mine)
        held_by = part.tangent + np.matmul(flat.swapaxes(1, 2), along)
        pushed = outward[..., None] * pressed[:, :, bores] + inward[..., None] * pressed[:, :, races]
        right = np.empty((rows, rollers, components, count + 1))
        np.add(part.placed, pushed.swapaxes(1, 2), out=right[..., :-1])
        right[..., -1] = part.unbalanced
        held = _own_stiffness(part.stiffness[..., bores], outward)
        held += _own_stiffness(part.stiffness[..., races], inward)
        held[:, :, 0, 0] += part.own_bend
        _hold_turning(held)
        placing = _solved_blocks(held, right)
        back = right[..., :-1].reshape(rows, rollers * components, count).swapaxes(1, 2)
        taken = np.matmul(back, placing.reshape(rows, rollers * components, count + 1))
        held_by -= taken[..., :-1]
        if system.discs == 1:
            at.force, at.tangent = part.force - taken[..., -1], held_by
        else:
            at.force[:, own] += part.force - taken[..., -1]
            at.tangent[:, own[:, None], own] += held_by
        dx.append(-placing[..., -1])
        at.by_own.append(-placing[..., :-1])
    at.dx = _bounded(at, np.concatenate(dx, axis=1) if len(dx) > 1 else dx[0])
    at.de = np.zeros((rows, system.components, at.count))
    for disc, part in enumerate(at.pressing):
        _, bores, _, races = at.at[disc]
        outward, inward = part.presses
        moved = at.dx[:, at.of_rollers[disc]].swapaxes(1, 2)
        at.de[:, :, bores], at.de[:, :, races] = outward * moved, inward * moved


def _moved_aside(at: Any, aside: FloatArray) -> FloatArray:
    """Deformations of the chosen contacts as displaced pins yield to forces aside of the normals."""
    force = at.members.forces(np.zeros(at.load.shape), aside[..., -1], changes=True)
    moved: FloatArray = at.of_chosen(at.members.approaches(at.system.model.pins.under(force)))
    return moved


def eliminate_coupled(at: Any) -> None:
    """Eliminate where bodies deform under the loads of all contacts, or beams and a ring displace pins."""
    _find_bodies(at)
    every = assembled(at)
    if at.shifts is not None:
        at.members = PinMembers(at)
    part = every if at.system.coupled else _on_pins(at, every)
    whole, left = _flexibility(at, part)
    moves = at.shifts is not None and not at.held
    found = _eliminate(at, part, whole, left[:, :, part.which], turning=moves)
    if moves and not (close := _is_near(at, found.de, part.stiffness)).all():
        # Far off loads may turn with soft pins more than these hold against.
        still = _eliminate(at, part, whole, left[:, :, part.which], turning=False)
        found = Eliminated(*(by_rows(close, *each) for each in zip(found, still, strict=True)))
    if found.aside is not None:
        left = left + _moved_aside(at, found.aside)
    at.aside = found.aside
    if at.system.coupled:
        at.force, at.tangent, at.dx, at.dx_by_pose, at.de, at.de_by_pose, _ = found
    else:
        eliminate_by_disc(at)
        _beside_rollers(at, found)
    _find_off(at, every, left)


def _on_pins(at: Any, part: Pressing) -> Pressing:
    """The part of contacts on pins."""
    some, chosen = at.members.place, {}
    for name in ("g", "force_map", "load"):
        chosen[name] = getattr(part, name)[:, :, some]
    for name in ("unbalanced", "placed", "own_bend"):
        chosen[name] = getattr(part, name)[:, :0]
    return part._replace(
        **chosen,
        stiffness=part.stiffness[:, :, some],
        presses=(part.presses[0][:, :, :0], part.presses[1][:, :, :0]),
        rolls=(some[:0], some[:0]),
        force=np.zeros(part.force.shape),
        tangent=np.zeros(part.tangent.shape),
        which=some,
    )


def _beside_rollers(at: Any, found: Eliminated) -> None:
    """Add forces and deformations of contacts on displaced pins to those of rollers."""
    some = at.members.place
    at.force, at.tangent = at.force + found.force, at.tangent + found.tangent
    at.de[:, :, some] = found.de
    at.de_by_pose = np.zeros((*at.de.shape, at.size))
    at.de_by_pose[:, :, some] = found.de_by_pose
    for disc, part in enumerate(at.pressing):
        for kind, press in zip((1, 3), part.presses, strict=True):
            mine, local = at.at[disc][kind], at.local[disc][kind]
            by_place = press[..., None] * at.by_own[disc].swapaxes(1, 2)
            at.de_by_pose[:, :, mine, at.columns[disc]] = part.g[:, :, local] + by_place
    if not at.sticking and at.system.model.friction is None and at.by_slope is None:
        at.tangent = 0.5 * (at.tangent + at.tangent.swapaxes(1, 2))


def _find_off(at: Any, every: Pressing, left: FloatArray) -> None:
    """Find the residual of the deformations where it matters, mm."""
    stiffness, (bores, races) = every.stiffness, every.rolls
    wanted = np.abs(left).sum(axis=1)
    expected = at.of_chosen(at.deformation)[:, 0] - left[:, 0]
    stiff = stiffness[0][:, bores] + stiffness[0][:, races]
    # An open roller stands in the middle of its play.
    free, middle = stiff <= 0.0, 0.5 * (expected[:, bores] + expected[:, races])
    both = 0.5 * np.abs(left[:, 0, bores] + left[:, 0, races])
    for places in (bores, races):
        expected[:, places] = np.where(free, middle, expected[:, places])
        wanted[:, places] = np.where(free, both, wanted[:, places])
    matters = (stiffness[0] > 0.0) | (expected > 0.0)
    at.off = np.max(wanted * matters, axis=1, initial=0.0)
    apart = np.abs(every.unbalanced).sum(axis=-1) / np.where(stiff > 0.0, stiff, np.inf)
    at.off = np.maximum(at.off, np.max(apart, axis=1, initial=0.0))


def _eliminate(at: Any, part: Pressing, whole: FloatArray, left: FloatArray, *, turning: bool) -> Eliminated:
    """Force and tangent of the pose; unless `turning`, loads that turn with displaced pins count only where they hold these."""
    system, g, force_map, stiffness = at.system, part.g, part.force_map, part.stiffness
    presses, unbalanced, placed, own_bend = part.presses, part.unbalanced, part.placed, part.own_bend
    force, tangent = part.force, part.tangent
    rows, components, count, size = g.shape
    rollers = unbalanced.shape[1]
    if at.shifts is not None:
        # Loads turn with displaced pins: as if contacts lay along their tangents, without loads. What they turn with the pose
        # is in the tangent already.
        bent, along, turn = at.members.turned_loads(size)
        if not turning:
            bent[0] = np.maximum(bent[0], 0.0)
            bent[1:], turn = 0.0, turn * 0.0
        held = loads_of(bent, along)
        shape = rows, components * along.shape[2], size
        tangent = tangent - np.matmul(along.reshape(shape).swapaxes(1, 2), held.reshape(shape))
        g, force_map = np.concatenate((g, along), axis=2), np.concatenate((force_map, along), axis=2)
        left = np.concatenate((left, at.members.slips()), axis=2)
        turn = np.concatenate((np.zeros(part.g.shape), turn), axis=2).reshape(rows, -1, size)
        stiffness = np.concatenate((_filled(stiffness, bent.shape[0]), bent), axis=2)
    mine, count = count, g.shape[2]
    each = components * count
    t = np.zeros((rows, components, count, rollers, components))
    own = np.arange(rollers)
    for press, places in zip(presses, part.rolls, strict=True):
        for component in range(components):
            t[:, component, places, own, component] = press[:, component]
    flat = t.reshape(rows, components * count, rollers * components)
    moved_by, by_slope = g.reshape(rows, each, size), None
    if at.by_slope is not None:
        by_slope = np.zeros(g.shape)
        by_slope[:, :, :mine] = at.by_slope.load[:, :, part.which]
        moved_by = moved_by - np.matmul(whole.reshape(rows, each, each), by_slope.reshape(rows, each, size))
        moved_by.reshape(g.shape)[:, :, :mine] -= at.by_slope.taken[:, :, part.which]
    if at.shifts is not None:
        moved_by = moved_by - np.matmul(whole.reshape(rows, each, each), turn)
    right = np.concatenate((moved_by, flat, left.reshape(rows, each, 1)), axis=-1)
    system_matrix = loads_of(
        stiffness, whole.reshape(rows, components * count, components, count).transpose(0, 2, 3, 1)
    )
    system_matrix = system_matrix.transpose(0, 3, 1, 2).reshape(rows, components * count, components * count)
    system_matrix[:, np.arange(each), np.arange(each)] += 1.0
    found = solved(system_matrix, right)
    x = found.reshape(rows, components, count, right.shape[-1])
    kx = loads_of(stiffness, x).reshape(rows, components * count, right.shape[-1])
    if by_slope is not None:
        kx[..., :size] += by_slope.reshape(rows, each, size)
    back = np.concatenate((force_map.reshape(rows, each, size), flat), axis=-1)
    products = np.matmul(back.swapaxes(1, 2), kx)
    if at.shifts is not None:
        # What turns with the pose: what is taken of it by pins and by the places of rollers.
        slipped = found.copy()
        slipped[..., :size] -= g.reshape(rows, each, size)
        products[:, :size] += np.matmul(turn.swapaxes(1, 2), slipped)
    tangent = tangent + products[:, :size, :size]
    force = force - products[:, :size, -1]
    block = products[:, size:, size:-1].copy()
    first = np.arange(rollers) * components
    block[:, first, first] += own_bend
    flat_placed = placed.reshape(rows, rollers * components, size)
    down, across = products[:, size:, :size] + flat_placed, products[:, :size, size:-1] + flat_placed.swapaxes(1, 2)
    diagonal = np.einsum("bii->bi", block)
    for component in range(1, components):
        diagonal[:, component::components] += LEAST_TURNING * np.abs(diagonal[:, ::components])
    diagonal += diagonal == 0.0
    short = unbalanced.reshape(rows, rollers * components) - products[:, size:, -1]
    placing = solved(block, np.concatenate((down, short[..., None]), axis=-1))
    tangent = tangent - np.matmul(across, placing[..., :-1])
    force = force - np.matmul(across, placing[..., -1:])[..., 0]
    of_rollers = x[..., size:-1].reshape(rows, components * count, rollers * components)
    placing = placing.reshape(rows, rollers, components, size + 1)
    dx, dx_by_pose = _bounded(at, -placing[..., -1]), -placing[..., :-1]
    placed_by = np.concatenate((dx_by_pose, dx[..., None]), axis=-1)
    moved = np.matmul(of_rollers, placed_by.reshape(rows, rollers * components, size + 1))
    moved = moved.reshape(rows, components, count, size + 1)
    moved[..., :-1] += x[..., :size]
    moved[..., -1] -= x[..., -1]
    aside = None
    if at.shifts is not None:
        pressed = loads_of(stiffness[:, :, mine:], moved[:, :, mine:])
        pressed[..., :-1] += turn.reshape(rows, components, count, size)[:, :, mine:]
        aside = at.members.of_all(pressed)
    if not at.sticking and system.model.friction is None and at.by_slope is None:
        tangent = 0.5 * (tangent + tangent.swapaxes(1, 2))
    return Eliminated(
        force=force,
        tangent=tangent,
        dx=dx,
        dx_by_pose=dx_by_pose,
        de=moved[:, :, :mine, -1],
        de_by_pose=moved[:, :, :mine, :-1],
        aside=aside,
    )


def _is_near(at: Any, de: FloatArray, stiffness: FloatArray) -> NDArray[np.bool_]:
    """Positions where corrections of deformations are so small that loads follow them linearly."""
    moved = np.max(np.where(stiffness[0] > 0.0, np.abs(de).sum(axis=1), 0.0), axis=1, initial=0.0)
    near: NDArray[np.bool_] = at.are_small(moved, ROUGHLY_SETTLED)
    return near


def _bounded(at: Any, dx: FloatArray) -> FloatArray:
    """Corrections of places and leans, at most half of what is pressed together: beyond, other slices meet."""
    if dx.shape[-1] == 1 or not dx.size:
        return dx
    each = [0.5 * (places.room + np.abs(places.at_race - places.at_bore).sum(axis=1)) for places in at.discs]
    room = np.concatenate([at.picked(one, own[1]) for one, own in zip(each, at.chosen, strict=True)], axis=1)
    room = np.maximum(room, LEAST_ROOM)
    long = np.abs(dx).max(axis=-1)
    return np.asarray(dx * np.divide(room, long, out=np.ones(long.shape), where=long > room)[..., None])


def _flexibility(at: Any, part: Pressing) -> tuple[FloatArray, FloatArray]:
    """W of contacts and slips on displaced pins, shape (positions, components, entries, components, entries), and r, mm."""
    system = at.system
    rows, components, count = part.load.shape
    members = None if at.shifts is None else at.members
    entries = count + (0 if members is None else members.count)
    whole = np.zeros((rows, components, entries, components, entries))
    for disc, bodies in enumerate(at.bodies):
        pins, bores, holes, races = at.at[disc]
        among = np.r_[pins, bores, holes]
        first, second = np.arange(bores.start, bores.stop), np.arange(races.start, races.stop)
        for component, body in enumerate(bodies):
            mine = whole[:, component, :, component]
            mine[:, among[:, None], among] = body.among
            mine[:, races, races] = body.on_race
            mine[:, first, second] = mine[:, second, first] = body.across_roller
    left = at.of_chosen(at.deformation - at.overlap)
    if system.coupled:
        left += np.einsum("bcicj,bcj->bci", whole[:, :, :count, :, :count], part.load)
    if members is not None:
        left += at.of_chosen(members.approaches(members.unsettled(at.shifts)))
        members.add_flexibility(whole)
    return whole, left


def _find_bodies(at: Any) -> None:
    """Find the flexibility of bodies between the chosen contacts, unless places and choice are those of before."""
    before = at.before
    if before is not None and all(
        first is second or np.array_equal(first, second)
        for mine, theirs in zip(at.chosen, before.chosen, strict=True)
        for first, second in zip(mine, theirs, strict=True)
    ):
        at.bodies = before.bodies
        return
    at.bodies = at.bodies_between()


def loads_of(stiffness: FloatArray, moved: FloatArray) -> FloatArray:
    """K of columns of deformations, shape (positions, components, contacts, columns)."""
    if stiffness.shape[0] == 1:
        return np.asarray(stiffness[0][:, None, :, None] * moved)
    k, mixed, turning = (each[..., None] for each in stiffness)
    first, second = moved[:, 0], moved[:, 1]
    return np.stack((k * first + mixed * second, mixed * first + turning * second), axis=1)


def _filled(stiffness: FloatArray, count: int) -> FloatArray:
    """Stiffnesses filled up with zeros."""
    if stiffness.shape[0] == count:
        return stiffness
    return np.concatenate((stiffness, np.zeros((count - stiffness.shape[0], *stiffness.shape[1:]))))


def _own_stiffness(stiffness: FloatArray, press: FloatArray) -> FloatArray:
    """Stiffness of contacts against the place and lean of their rollers, shape (positions, rollers, components, components)."""
    if stiffness.shape[0] == 1:
        return np.asarray((stiffness[0] * press[:, 0] ** 2)[..., None, None])
    k, mixed, turning = stiffness
    first, second = press[:, 0], press[:, 1]
    cross = first * mixed * second
    return np.stack((np.stack((k * first**2, cross), -1), np.stack((cross, turning * second**2), -1)), -2)


def _hold_turning(blocks: FloatArray) -> None:
    """Hold rollers that touch at one end alone a little against turning about it, in place."""
    for component in range(1, blocks.shape[-1]):
        blocks[..., component, component] += LEAST_TURNING * blocks[..., 0, 0]


def _solved_blocks(blocks: FloatArray, right: FloatArray) -> FloatArray:
    """Solve roller by roller; parts that nothing holds stay where they are."""
    if blocks.shape[-1] == 1:
        held = blocks[..., 0, 0]
        return right / np.where(held != 0.0, held, np.inf)[..., None, None]
    determinant = blocks[..., 0, 0] * blocks[..., 1, 1] - blocks[..., 0, 1] ** 2
    inverse = 1.0 / np.where(determinant > 0.0, determinant, np.inf)
    first, second = right[..., 0, :], right[..., 1, :]
    a, b, c = (blocks[..., i, j][..., None] for i, j in ((0, 0), (0, 1), (1, 1)))
    return np.stack((c * first - b * second, a * second - b * first), axis=-2) * inverse[..., None, None]
