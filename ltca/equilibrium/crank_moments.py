"""Moments that hold cranks and their roller cages, from the forces of the contacts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ltca.arrays import FloatArray
from ltca.compliance.response import DiscResponse, Response, bearing_pushes

if TYPE_CHECKING:
    from ltca.equilibrium.reducer import Reducer


def crank_moments(model: Reducer, crank_angle: FloatArray, pose: FloatArray, response: Response) -> FloatArray:
    """Return the external moment that holds each crank by virtual work, ccw positive, N·mm, shape (positions, cranks).

    It is ∂U/∂φ_C of the contacts: the moment of every bearing's force about the crank axis, which is that of the forces on the
    crank alone, and that of its cages (`cage_moments`) times `cage_speed`, the part of the crank's angle by which they turn.
    Friction at the crank adds its own.
    """
    return moments_of_parts(model, crank_angle, pose, response.parts)


def moments_of_parts(
    model: Reducer, crank_angle: FloatArray, pose: FloatArray, parts: Sequence[DiscResponse]
) -> FloatArray:
    """Return the same from the contacts of every disc."""
    cranks, friction = model.discs[0].geometry.placement.cranks, model.friction
    pushes = [bearing_pushes(part.rollers, cranks) for part in parts]
    total = model.discs[0].geometry.placement.cage_speed * cage_moments(model, crank_angle, pose, parts)
    for number, (disc, push) in enumerate(zip(model.discs, pushes, strict=True)):
        bores = disc.geometry.bores(crank_angle, pose[:, model.coordinates.columns(number)])
        total = total + (bores.lever.conjugate() * push).imag
    if friction is None:
        return total
    on_bearings = None if model.stage is None else model.stage.on_bearings(total)
    return total + friction.of_cranks(pushes, on_bearings)


def cage_moments(
    model: Reducer, crank_angle: FloatArray, pose: FloatArray, parts: Sequence[DiscResponse]
) -> FloatArray:
    """Return the external moment that holds the cages of each crank at their angle, ccw positive, N·mm, (positions, cranks).

    Cage and inner race are concentric and the race pushes its rollers along its radii, the bore along its own: what holds the
    cage is the moment of the bearing's force at the displaced centre of the bore, the sum over all discs.
    """
    cranks = model.discs[0].geometry.placement.cranks
    total = np.zeros((crank_angle.size, cranks))
    for number, (disc, part) in enumerate(zip(model.discs, parts, strict=True)):
        bores = disc.geometry.bores(crank_angle, pose[:, model.coordinates.columns(number)])
        total += (bores.displacement.conjugate() * bearing_pushes(part.rollers, cranks)).imag
    return total
