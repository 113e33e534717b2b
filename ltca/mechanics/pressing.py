"""Generalised forces of contacts on the coordinates of discs, rollers where they stand."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ltca.arrays import FloatArray
from ltca.geometry.coordinates import DISC_PLACE, DISC_ROTATION
from ltca.geometry.pair_motion import dot
from ltca.mechanics.displaced_pins import solved
from ltca.mechanics.places import DiscPlaces, Indices


class Pressing(NamedTuple):
    """Generalised forces of chosen contacts, rollers where they stand."""

    g: FloatArray  # ∂d/∂q, shape (positions, components, chosen, coordinates)
    force_map: FloatArray  # the same with friction along the tangents
    load: FloatArray  # f, shape (positions, components, chosen)
    stiffness: FloatArray  # K, shape (1 or 3, positions, chosen)
    presses: tuple[
        FloatArray, FloatArray
    ]  # ∂d/∂x of rollers in bores and on races, shape (positions, components, rollers)
    unbalanced: FloatArray  # forces on the rollers' places, shape (positions, rollers, components)
    placed: FloatArray  # ∂(unbalanced)/∂q, loads held, (positions, rollers, components, coordinates)
    own_bend: FloatArray  # and by the places, shape (positions, rollers)
    force: FloatArray
    tangent: FloatArray  # derivative of the force, loads held
    rolls: tuple[Indices, Indices]  # numbers of the rollers' contacts in bores and on races
    which: Indices | slice = slice(None)  # numbers of the contacts among the chosen ones


class BySlope(NamedTuple):
    """Derivatives by the pose, deformations held, shape (positions, components, chosen, coordinates)."""

    load: FloatArray  # of the loads of the chosen contacts
    taken: FloatArray  # of deformations of bodies, loads held


def pressing_of(at: Any, disc: int) -> Pressing:
    """Generalised forces of the chosen contacts of a disc, rollers where they stand (Eq. 66, 70–72)."""
    places, some, (_, bores, _, races) = at.discs[disc], at.chosen[disc], at.local[disc]
    own = slice(at.at[disc][0].start, at.at[disc][3].stop)
    g, across = _gradients(at, disc)
    load, stiffness = at.chosen_load[:, :, own], at.chosen_stiffness[:, :, own]
    slant = at.picked(places.slant, some[1])
    bend = load[:, 0, bores] / at.picked(places.length, some[1])
    if at.by_crank:
        bend = np.zeros(bend.shape)
    rows, components, _, size = g.shape
    # Directions in which a roller's own place and lean press its two contacts.
    outward, inward = np.ones((2, rows, components, slant.shape[1]))
    np.negative(at.picked(places.cosine, some[1]), out=outward[:, 0])
    inward[:, 1:] = -1.0
    placed = np.zeros((rows, slant.shape[1], components, size))
    np.multiply((bend * slant)[..., None], across, out=placed[:, :, 0])
    if at.by_crank:
        tangent = np.zeros((rows, size, size))
        turn_with_cages(tangent, load[:, 0, bores] * at.system.cage_speed, across)
    else:
        tangent = bends(at, disc) + np.matmul(across.swapaxes(1, 2), bend[..., None] * across)
    force_map = _rub(at, disc, g)
    force = np.matmul(force_map.reshape(rows, -1, size).swapaxes(1, 2), load.reshape(rows, -1, 1))[..., 0]
    if at.sticking:
        by_slip, slip, held = at.sticking[disc]
        force += np.einsum("bpj,bp->bj", slip, held)
        tangent += np.matmul(slip.swapaxes(1, 2), by_slip[..., None] * slip)
    return Pressing(
        g=g,
        force_map=force_map,
        load=load,
        stiffness=stiffness,
        presses=(outward, inward),
        unbalanced=(outward * load[:, :, bores] + inward * load[:, :, races]).swapaxes(1, 2),
        placed=placed,
        own_bend=bend * slant**2,
        force=force,
        tangent=tangent,
        rolls=(np.arange(bores.start, bores.stop), np.arange(races.start, races.stop)),
    )


def _gradients(at: Any, disc: int) -> tuple[FloatArray, FloatArray]:
    """∂d/∂q of the chosen contacts of a disc, and how the tangents of its rollers turn with the pose, Im(n̄ ∂)."""
    system, places, some, row = at.system, at.discs[disc], at.chosen[disc], at.row
    pins, bores, holes, races = at.local[disc]
    size = at.columns[disc].size
    g = np.zeros((at.angle.size, system.components, races.stop, size))
    components = g.swapaxes(0, 1)
    for component, (on_pins, in_holes) in zip(components, places.gradients, strict=True):
        component[:, pins] = gradient_with_crank(at, places, at.picked(on_pins, some[0]))
        component[:, holes] = gradient_with_crank(at, places, at.picked(in_holes, some[2]))
    moved = places.bores.gradient
    if at.by_crank:
        both = bores_moved(at, places)
        moved = both[:, :, 0] + 1j * both[:, :, 1]
    if moved.shape[1] > 1:
        moved = moved[row, some[1] // (system.rollers // moved.shape[1])]
    turned = at.picked(places.outward, some[1]).conjugate()[..., None] * moved
    np.negative(turned.real, out=components[0][:, bores])
    for by_tilt in components[1:]:
        ray = at.picked(places.rays.direction, some[1])
        both = at.half[..., None] * np.stack((ray.real, ray.imag), axis=-1)
        by_tilt[:, bores, system.one.lean_place] = -both
        crank_of = some[1] // (system.rollers // places.bores.arm.shape[1])
        for crank in range(system.one.cranks):
            first = system.one.crank_lean(crank)
            by_tilt[:, races, first : first + 2] = both * (crank_of == crank)[..., None]
        if at.by_crank:  # rays turn with the cages
            with_cage = 1j * places.geometry.placement.cage_speed * ray
            journals = places.bores.each(places.geometry.journal_leans(places.pose), system.rollers)
            journal = at.picked(np.broadcast_to(journals, places.total.shape), some[1])
            by_tilt[:, bores, -1] = -at.half * dot(with_cage, places.geometry.lean(places.pose))
            by_tilt[:, races, -1] = at.half * dot(with_cage, journal)
    return g, turned.imag


def gradient_with_crank(at: Any, places: DiscPlaces, gradient: FloatArray) -> FloatArray:
    """Derivatives of pins by the pose of a disc, and by the crank angle where that is a coordinate."""
    return np.concatenate((gradient, np.matmul(gradient, places.nominal)), axis=-1) if at.by_crank else gradient


def bores_moved(at: Any, places: DiscPlaces) -> FloatArray:
    """Derivatives of displacements of the bores by pose and, if it is one, crank angle, (positions, cranks, 2, coordinates)."""
    by_pose = places.bores.gradient
    found = np.empty((*by_pose.shape[:2], 2, by_pose.shape[2] + at.by_crank))
    found[:, :, 0, : by_pose.shape[2]], found[:, :, 1, : by_pose.shape[2]] = by_pose.real, by_pose.imag
    if at.by_crank:
        found[..., -1] = places.seen_from_cages
    return found


def _rub(at: Any, disc: int, g: FloatArray) -> FloatArray:
    """Generalised directions of loads on a disc: G and friction along the tangents of pins and holes."""
    friction = at.system.model.friction
    if friction is None:
        return g
    system, found, row, places = at.system, g.copy(), at.row, at.discs[disc]
    kinds = system.of_kind[disc][0], system.of_kind[disc][2]
    load = np.concatenate([at.load[:, 0, kind] for kind in kinds], axis=1)
    stiffness = np.concatenate([at.stiffness[0][:, kind] for kind in kinds], axis=1)
    if system.coupled and not friction.turns:
        stiffness = _through_bodies(at, disc, stiffness)
    slip, by_load, held, by_slip = friction.along(places, load, stiffness, disc)
    at.rubs.append(by_load)
    # Moments on leans rub as loads do, those of contacts that stick by what these hold.
    by_moment = by_load + np.divide(held, load, out=np.zeros(load.shape), where=load > 0.0)
    at.rubs_leaning.append(by_moment)
    pins, _, holes, _ = at.local[disc]
    some = at.chosen[disc]
    for where, which in ((pins, some[0]), (holes, system.pins + some[2])):
        by = by_load[row, which][..., None]
        found[:, 0, where] += by * slip[row, which]
        for by_tilt in found.swapaxes(0, 1)[1:]:
            motion, own = (places.flank, which) if where is pins else (places.holes, some[2])
            along = at.half[..., None] * by_moment[row, which][..., None] * motion.along[row, own][..., DISC_PLACE]
            by_tilt[:, where, system.one.lean_place] += along
            if where is pins and system.one.wheel_leans:
                by_tilt[:, where, system.one.wheel_lean_place] -= along
    if by_slip is not None:
        at.sticking.append((by_slip, slip, held))
    return found


def _through_bodies(at: Any, disc: int, stiffness: FloatArray) -> FloatArray:
    """Stiffnesses of wheel pins and shaft pins with the bodies there, diagonal of K (1 + C K)⁻¹, shape (positions, pairs)."""
    pins, _, holes, _ = at.local[disc]
    first = at.at[disc][0].start
    own = at.chosen_stiffness[0][:, first : first + holes.stop]
    matrix = at.bodies[disc][0].among * own[:, None]
    place = np.arange(own.shape[1])
    matrix[:, place, place] += 1.0
    through = own * np.diagonal(solved(matrix, np.broadcast_to(np.eye(own.shape[1]), matrix.shape)), axis1=1, axis2=2)
    found, some = stiffness.copy(), at.chosen[disc]
    found[at.row, some[0]] = through[:, pins]
    found[at.row, at.system.pins + some[2]] = through[:, holes]
    return found


def bends(at: Any, disc: int) -> FloatArray:
    """Σ F ∂²d/∂q² of the contacts of a disc, without the turning of the rollers' places."""
    system, places = at.system, at.discs[disc]
    pins, bores, holes, _ = system.of_kind[disc]
    found = places.flank.bend(at.load[:, 0, pins]) + places.holes.bend(at.load[:, 0, holes])
    for moment, (on_pins, in_holes) in zip(at.load.swapaxes(0, 1)[1:], places.turns, strict=True):
        found += places.flank.bend_leans(moment[:, pins] * at.half, on_pins, system.one)
        found += places.holes.bend_leans(moment[:, holes] * at.half, in_holes, system.one)
    cranks = places.bores.arm.shape[1]
    push = (at.load[:, 0, bores] * places.outward).reshape(found.shape[0], cranks, -1).sum(axis=2).conjugate()
    found[:, DISC_ROTATION, DISC_ROTATION] += (push * places.bores.arm).real.sum(axis=1)
    if places.bores.twists:
        found[:, places.bores.twists, places.bores.twists] -= (push * places.bores.lever).real
    return np.asarray(found)


def assembled(at: Any) -> Pressing:
    """Generalised forces of contacts of all discs on all coordinates."""
    system, (rows, size) = at.system, (at.pose.shape[0], at.size)
    if system.discs == 1:
        alone: Pressing = at.pressing[0]
        return alone
    components, rollers = system.components, at.of_rollers[-1].stop
    g, force_map = np.zeros((2, rows, components, at.count, size))
    placed, force = np.zeros((rows, rollers, components, size)), np.zeros((rows, size))
    tangent = np.zeros((rows, size, size))
    for disc, (part, own) in enumerate(zip(at.pressing, at.columns, strict=True)):
        mine = slice(at.at[disc][0].start, at.at[disc][3].stop)
        g[:, :, mine, own], force_map[:, :, mine, own] = part.g, part.force_map
        placed[:, at.of_rollers[disc], :, own] = part.placed
        force[:, own] += part.force
        tangent[:, own[:, None], own] += part.tangent
    outward, inward = (np.concatenate([part.presses[way] for part in at.pressing], axis=2) for way in (0, 1))
    bores, races = (np.concatenate([np.arange(own[kind].start, own[kind].stop) for own in at.at]) for kind in (1, 3))
    return Pressing(
        g=g,
        force_map=force_map,
        load=at.chosen_load,
        stiffness=at.chosen_stiffness,
        presses=(outward, inward),
        unbalanced=np.concatenate([part.unbalanced for part in at.pressing], axis=1),
        placed=placed,
        own_bend=np.concatenate([part.own_bend for part in at.pressing], axis=1),
        force=force,
        tangent=tangent,
        rolls=(bores, races),
    )


def turn_with_cages(tangent: FloatArray, forces: FloatArray, moved: FloatArray) -> None:
    """Subtract the forces of bearings that turn with the cages, in place: the stiffness of rollers counts them."""
    turned = np.matmul(forces[:, None], moved[..., :-1])[:, 0]
    tangent[:, :-1, -1] -= turned
    tangent[:, -1, :-1] -= turned
