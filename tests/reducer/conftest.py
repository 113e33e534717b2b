"""What the tests of reducers share."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from ltca.analysis.engines import HalfSpace
from ltca.equilibrium.balance import lever_arms
from ltca.equilibrium.output_torque import solve_at_output
from ltca.equilibrium.reducer import Reducer
from ltca.geometry.coordinates import WHEEL_ANGLE
from ltca.testing.bearing_alone import roller_laws


@pytest.fixture
def stored():
    """The function that tells the energy stored in a reducer."""
    return stored_energy


def stored_energy(model, response, pose, angle=0.0):
    """ΣU of contacts and supports, N·mm, and ∂U/∂ρ of every wheel pin, N, by differences of the law alone."""
    total, slopes = np.zeros(pose.shape[0]), []
    for disc, part in zip(model.discs, response.parts, strict=True):
        laws, flank = roller_laws(disc), part.flank
        total = total + disc.pin_law.energy(flank.approach, flank.effective_radius).sum(axis=1)
        total = total + disc.hole_law.energy(part.holes.approach, disc.geometry.placement.hole_effective_radii).sum(
            axis=1
        )
        total = total + laws.inner.energy(part.rollers.inner_approach, laws.inner_radius).sum(axis=1)
        total = total + laws.outer.energy(part.rollers.outer_approach, laws.outer_radius).sum(axis=1)
        step = 1e-4 * flank.effective_radius
        ends = [disc.pin_law.energy(flank.approach, flank.effective_radius + side * step) for side in (1.0, -1.0)]
        slopes.append((ends[0] - ends[1]) / (2.0 * step))
    if isinstance(model, Reducer) and model.supports is not None:
        total = total + model.supports.energy(pose)
    if isinstance(model, Reducer) and model.pins is not None:
        ratio = model.discs[0].geometry.placement.reduction_ratio
        turned = np.exp(1j * (angle / ratio + pose[:, WHEEL_ANGLE]))
        for number, part in enumerate(response.parts):
            force = part.pin_forces.copy()
            force[:, : part.pin_load.shape[1]] *= turned.conjugate()[:, None]
            total = total + 0.5 * (force.conjugate() * response.shifts[:, number]).real.sum(axis=1)
    return total, np.concatenate(slopes, axis=1)


@pytest.fixture
def unbalanced_work():
    """The function that tells by how much virtual work does not close."""
    return work_left_over


def work_left_over(drive, angle):
    """Power of input, output and forces from outside in the frame of the housing, less U′ − Σ ∂U/∂ρ ρ′, by the torque.

    T_C is that of all cranks with their cages, U has the supports' energy. With the shaft held the housing is the frame of the
    pose: T_C + T_W θ′ + G·w′, θ′ = 1/u + w′. With the wheel held the shaft turns by −θ in it, and its axis, on which the opposite
    of G acts, stands at s = −w exp(−iθ).
    """
    model = HalfSpace().prepare(drive).model
    centre = solve_at_output(model, [drive], angle, drive.load.torque)
    crank = model.crank_moments(angle, centre.pose, centre.response.parts).sum(axis=1)
    slope = stored_energy(model, centre.response, centre.pose, angle)[1]
    beside = model.beside_pins(angle, centre.pose, centre.response.parts)[:, 0]

    def places(angle, found):
        turned = angle / drive.reduction_ratio + found.pose[:, WHEEL_ANGLE]
        w = 0j
        if model.coordinates.wheel:
            w = found.pose[:, model.coordinates.wheel_place] @ np.array([1.0, 1j])
        return turned, w, -w * np.exp(-1j * turned)

    turned, _, _ = places(angle, centre)
    in_housing = -beside * np.exp(-1j * turned)

    def left(step):
        ends = []
        for side in (1.0, -1.0):
            found = solve_at_output(model, [drive], angle + side * step, drive.load.torque, centre.pose)
            energy = stored_energy(model, found.response, found.pose, angle + side * step)[0]
            ends.append((energy, found.response.flank.effective_radius, *places(angle + side * step, found)))
        energy, radius, turn, w, s = ((up - down) / (2.0 * step) for up, down in zip(*ends, strict=True))
        work = energy - (slope * radius).sum(axis=1)
        if not drive.wheel_is_held:
            return crank + centre.wheel_moment * turn + (beside.conjugate() * w).real - work
        output = drive.driving_sign * drive.load.torque
        by_input = crank * (1.0 - drive.input_per_crank_moment * turn)
        return by_input - output * turn + (in_housing.conjugate() * s).real - work

    # differences of second order, taken to fourth by two of them (Richardson)
    return (4.0 * left(1e-4) - left(2e-4)) / 3.0 / drive.load.torque


@dataclass(frozen=True)
class HeldRadius:
    """The law at held ρ: its dependence on the place is no force."""

    law: object
    radius: np.ndarray

    def take(self, shape, where):
        return HeldRadius(self.law.take(shape, where), np.broadcast_to(self.radius, shape)[where])

    def load_and_stiffness(self, approach, effective_radius):
        return self.law.load_and_stiffness(approach, self.radius)


@pytest.fixture
def tangent_and_slope():
    """The function that tells the tangent and the slope of the force by differences."""
    return scaled_tangent_and_slope


def scaled_tangent_and_slope(drive, angle, step=1e-7):
    """Tangent at one balanced position and the differences of the force over ±step mm, both by the lever arms."""
    model = HalfSpace().prepare(drive).model
    balanced = solve_at_output(model, [drive], angle, drive.load.torque)
    parts = zip(model.discs, balanced.response.parts, strict=True)
    held = tuple(replace(m, pin_law=HeldRadius(m.pin_law, part.flank.effective_radius)) for m, part in parts)
    fixed = replace(model, discs=held) if isinstance(model, Reducer) else Reducer(discs=held)
    lever = lever_arms(model)
    scaled = balanced.response.tangent[0] / np.outer(lever, lever)
    slope = np.empty_like(scaled)
    for column in range(lever.size):
        moved = [balanced.pose + side * step * (np.arange(lever.size) == column) / lever[column] for side in (1, -1)]
        up, down = (fixed.respond(angle, each).force[0] / lever for each in moved)
        slope[:, column] = (up - down) / (2.0 * step)
    return scaled, slope
