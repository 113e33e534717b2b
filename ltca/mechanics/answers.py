"""Contacts of a disc at poses as results have them, from the one system of all of them."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ltca.arrays import FloatArray
from ltca.compliance.response import DiscResponse, LeaningPairs, LeaningRollers, RollerState

if TYPE_CHECKING:
    from ltca.mechanics.contacts import Linearised


def disc_response(at: Linearised, disc: int) -> DiscResponse:
    """Return the contacts of one disc."""
    system, each, kinds = at.system, at.discs[disc], at.system.of_kind[disc]
    load = at.corrected_load
    pins, bores, holes, races = (load[:, 0, kind] for kind in kinds)
    flank, in_holes = each.flank, each.holes
    rollers = _rollers(at, disc)
    if at.shifts is not None:  # pins where the loads of the answer press them, not where these were found
        moved = at.moved_by_pins[:, 0]
        flank = replace(flank, approach=flank.approach + moved[:, kinds[0]])
        in_holes = replace(in_holes, approach=in_holes.approach + moved[:, kinds[2]])
    if system.coupled and system.components == 1:
        body = system.model.discs[disc].bodies[0]
        approach = _approaches(at, disc)
        flank = replace(flank, approach=approach[:, : system.pins])
        in_holes = replace(in_holes, approach=approach[:, system.pins + system.rollers :])
        at_bore = approach[:, system.pins : system.pins + system.rollers]
        rays, free = each.rays, bores <= 0.0
        resting = np.abs(rays.outermost * rays.direction - each.displacement) - rays.bore_play
        # A free roller rests on the race where the others have pressed it in.
        pressed_in = races @ body.race + float(body.coefficients.roller[0, 1]) * bores
        there = np.abs((rays.outermost - pressed_in) * rays.direction - each.displacement) - rays.bore_play
        in_bore = at.yielding[disc][0][:, system.pins : system.pins + system.rollers]
        at_bore = np.where(free, there - in_bore, at_bore)
        inner = at.after[:, 0, kinds[3]] + np.diag(body.race) * races
        rollers = replace(
            rollers,
            inner_approach=np.where(free, 0.0, inner),
            outer_approach=np.where(free, np.minimum(resting, at_bore), at_bore),
        )
    part = at.pressing[disc]
    loaded = at.of_chosen(load)[:, :, at.at[disc][0].start : at.at[disc][3].stop]
    force = np.einsum("bcij,bci->bj", part.force_map, loaded)
    friction = None
    if at.rubs:
        friction = at.rubs[disc] * np.concatenate((pins, holes), axis=1)
        if at.sticking:
            _, slip, held = at.sticking[disc]
            friction = friction + held
            force += np.einsum("bpj,bp->bj", slip, held)
    shifts = leans = None
    if at.shifts_after is not None:
        shifts, *leaning_by = at.shifts_after[:, disc :: system.discs].swapaxes(0, 1)
        leans = next((each / at.half for each in leaning_by), None)
    leaning: list[Any] = [None, None]
    for pairs in each.tilts:
        found = at.slices_after(disc)
        leaning = [
            LeaningPairs(tilt=tilt, contact=contact.kept)
            for tilt, contact in zip(pairs, (found[0], found[2]), strict=True)
        ]
    return DiscResponse(
        force=force,
        flank=flank,
        holes=in_holes,
        rollers=rollers,
        pin_load=pins,
        hole_load=holes,
        shifts=shifts,
        leans=leans,
        friction=friction,
        leaning_pins=leaning[0],
        leaning_holes=leaning[1],
        deformation=at.after[:, :, kinds[0].start : kinds[3].stop] if system.coupled else None,
    )


def _approaches(at: Linearised, disc: int) -> FloatArray:
    """Approaches of pairs of coupled bodies, on pins, bores and holes: the overlap less deformations by other contacts' loads."""
    system, some = at.system, at.chosen[disc]
    kinds = system.of_kind[disc]
    overlap = np.concatenate([at.overlap[:, 0, kinds[kind]] for kind in range(3)], axis=1)
    found = overlap - at.yielding[disc][0]
    walls = np.concatenate((some[0], system.pins + some[1], system.pins + system.rollers + some[2]), axis=1)
    own = np.arange(walls.shape[1])
    diagonal = at.bodies[disc][0].among[:, own, own]
    near = np.concatenate([at.after[:, 0, kinds[kind]][at.row, some[kind]] for kind in range(3)], axis=1)
    load = np.concatenate([at.corrected_load[:, 0, kinds[kind]][at.row, some[kind]] for kind in range(3)], axis=1)
    found[at.row, walls] = near + diagonal * load
    return np.asarray(found)


def _rollers(at: Linearised, disc: int) -> RollerState:
    """Rollers of one disc: those that carry nothing rest on the race."""
    system, each, (_, bores, _, races) = at.system, at.discs[disc], at.system.of_kind[disc]
    load, own = at.corrected_load, slice(disc * system.rollers, (disc + 1) * system.rollers)
    rays = each.rays
    place = at.place_after[:, own]
    carries = (load[:, 0, bores] > 0.0) | (load[:, 0, races] > 0.0)
    arm = rays.outermost * rays.direction - each.displacement
    rest = np.abs(arm)
    outer = each.outer - each.cosine * (place - each.inward)
    share = np.divide(place, each.total, out=np.full(place.shape, 0.5), where=carries & (each.total != 0.0))
    state = RollerState(
        share=share,
        inner_approach=np.where(carries, place, 0.0),
        outer_approach=np.where(carries, outer, rest - rays.bore_play),
        inner_load=load[:, 0, races],
        outer_load=load[:, 0, bores],
        outer_direction=np.where(carries, each.outward, arm / rest),
    )
    for lean, after in zip(at.lean_after.swapaxes(0, 1), at.after.swapaxes(0, 1)[1:], strict=True):
        contacts = at.slices_after(disc)
        leaning = LeaningRollers(
            lean=np.where(carries, lean[:, own] / at.half, 0.0),
            inner_tilt=np.where(carries, after[:, races] / at.half, 0.0),
            outer_tilt=np.where(carries, after[:, bores] / at.half, 0.0),
            inner=contacts[3].kept,
            outer=contacts[1].kept,
        )
        state = replace(state, leaning=leaning)
    return state
