"""Forces of contacts and supports of a drive at one instant, over the coordinates of its motion (``docs/theory/motion.md``)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ltca.arrays import ComplexArray, FloatArray
from ltca.compliance.coupled import CoupledCompliance
from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.compliance.response import Start
from ltca.dynamics.kinetics import Motion
from ltca.dynamics.teeth import Teeth, TeethForces
from ltca.equilibrium.friction.slip import Slip
from ltca.equilibrium.friction.turning import TurningFriction
from ltca.equilibrium.reducer import Reducer
from ltca.geometry.coordinates import DISC_PLACE, X, Y
from ltca.mechanics.contacts import ContactSystem, Linearised
from ltca.mechanics.energy import StoredEnergy, stored_by_disc, stored_by_pins

FADING = 1e-2
"""Slip by the speed of the eccentric at which friction has 0.7 of its size."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Instant:
    """Forces at one instant over all coordinates, N and N·mm."""

    force: FloatArray  # ∂U/∂x of contacts and supports
    friction: FloatArray  # to be overcome
    outside: FloatArray  # on the output
    stiffness: FloatArray  # Σ k g gᵀ of contacts and springs, symmetric
    contacts: Linearised
    teeth: TeethForces | None

    @property
    def loads(self) -> dict[str, list[FloatArray]]:
        """Loads of wheel pins, rollers in bores, shaft pins and crank bearings of each disc, N, by their names in results."""
        load, system = self.contacts.corrected_load[0, 0], self.contacts.system
        found = {
            name: [load[kinds[kind]] for kinds in system.of_kind]
            for kind, name in enumerate(("pin_load", "roller_load", "hole_load"))
        }
        return found | {"bearing_load": [np.abs(self.contacts.pushes(disc)[0]) for disc in range(system.discs)]}


class ContactForces:
    """Forces of contacts and supports of a drive, followed in time from `start`; friction fades by `crank_speed`, rad/s."""

    def __init__(self, model: Reducer, motion: Motion, crank_speed: float) -> None:
        friction = model.friction
        self._friction = replace(friction, motion=1) if isinstance(friction, TurningFriction) else None
        self._model = replace(model, supports=None, stage=None, friction=None, external=None)
        self._supports, self._external = model.supports, model.external
        self._teeth = None if model.stage is None else Teeth(model, motion)
        self._motion, self._speed = motion, abs(crank_speed)
        rubs = motion.drive.friction
        self._drag = 0.0 if rubs is None else rubs.no_load_torque
        self._springs = motion.springs
        self._system = ContactSystem(self._model)
        self.start: Start | None = None

    @property
    def rubs(self) -> bool:
        """Whether there is friction."""
        return self._friction is not None

    @property
    def has_energy(self) -> bool:
        """Whether the stored energy is known: of all but contact grids."""
        return all(isinstance(disc, HalfSpaceCompliance | CoupledCompliance) for disc in self._model.discs)

    def forget_grids(self) -> None:
        """Let contact grids begin anew: they have as many cells as they need, which no checkpoint keeps."""
        if not self.has_energy:
            self.start = None
            discs: tuple[Any, ...] = self._model.discs
            for disc in discs:
                disc.forget()

    def at(self, x: FloatArray, rate: FloatArray) -> Instant:
        """Return the forces at coordinates and their rates, each of shape (n,)."""
        motion, friction = self._motion, self._friction
        pose, angle = x[: motion.pose.size], x[motion.crank : motion.crank + 1]
        contacts = self._system.respond(angle, pose[None], self.start, roughly=False, by_crank=True)
        self.start = contacts.onward
        pushes = [contacts.pushes(disc) for disc in range(len(contacts.discs))]
        # Sense in which the cranks roll, fading where they stand.
        rolls = float(rate[motion.crank] / np.hypot(rate[motion.crank], FADING * self._speed))
        stiffness, force = self._springs.copy(), self._springs @ x
        # The crank angle stands behind the pose.
        force[: contacts.size] += contacts.force[0]
        stiffness[: contacts.size, : contacts.size] += contacts.tangent[0]
        teeth, carried = None, None
        if self._teeth is not None:
            rubbing = 0.0 if friction is None else rolls * friction.of_cranks(pushes)[0]
            teeth = self._teeth.at(x, _crank_moments(contacts, pushes) + rubbing)
            force += teeth.force
            stiffness += teeth.stiffness
            carried = teeth.carried
        if self._supports is not None:
            held, stiff = self._supports.respond(pose[None], carried)
            force[: pose.size] += held[0]
            stiffness[: pose.size, : pose.size] += stiff.reshape(pose.size, pose.size)
        outside, on_wheel = self._outside(angle, pose)
        rubbed = self._rubbed(contacts, pushes, rate, rolls, on_wheel)
        return Instant(
            force=force, friction=rubbed, outside=outside, stiffness=stiffness, contacts=contacts, teeth=teeth
        )

    def stored(self, x: FloatArray, now: Instant) -> tuple[float, tuple[StoredEnergy, ...]]:
        """Return the energy stored at coordinates where forces are known, N·mm, and that of each disc's contacts."""
        contacts, teeth = now.contacts, now.teeth
        if contacts.shifts is not None:
            # Loads are right to second order in what pins have still to move, what beams and ring store is not.
            contacts = contacts.corrected(np.ones(1))
        discs = stored_by_disc(contacts)
        total = 0.5 * float(x @ self._springs @ x) + float(stored_by_pins(contacts)[0])
        if teeth is not None:
            total += teeth.energy
        if self._supports is not None:
            pose = x[None, : self._motion.pose.size]
            total += float(self._supports.energy(pose, None if teeth is None else teeth.carried)[0])
        return total + sum(float(disc.energy[0]) for disc in discs), discs

    def _outside(self, angle: FloatArray, pose: FloatArray) -> tuple[FloatArray, complex]:
        """Force from outside on the output over the coordinates, and on the wheel relative to the shaft, N."""
        found, motion = np.zeros(self._motion.size), self._motion
        if self._external is None:
            return found, 0j
        force, tilting = map(complex, self._external.on_wheel(angle)[0])
        for place, pressed in ((motion.pose.wheel_place, force), (motion.pose.wheel_lean_place, tilting)):
            if place.stop > place.start:
                x, y = pose[place]
                found[place] += pressed.real, pressed.imag
                found += (x * pressed.imag - y * pressed.real) * motion.frame_turns
        return found, force

    def _rubbed(
        self, contacts: Linearised, pushes: Sequence[ComplexArray], rate: FloatArray, rolls: float, on_wheel: complex
    ) -> FloatArray:
        """Force that has to overcome friction, shape (n,); `on_wheel` is that from outside, N."""
        motion, place, pins = self._motion, self._model.discs[0].geometry.placement, contacts.system.pins
        friction, total, turning = self._friction, np.zeros(motion.size), float(rate[motion.crank])
        if friction is None:
            return total
        slow = FADING * float(place.mean_eccentricity.ravel()[0]) * self._speed
        rubs = np.repeat((friction.pin, friction.hole), (pins, contacts.system.holes))
        for number, (columns, push) in enumerate(zip(contacts.system.columns, pushes, strict=True)):
            disc = contacts.discs[number]
            nominal = disc.nominal[0, :, 0]
            slip, load = _slip(contacts, number), contacts.pin_loads(number)[0, 0]
            speed = slip @ (rate[columns] + nominal * turning)
            rubbed = rubs * load * speed / np.hypot(speed, slow)
            force = rubbed @ slip
            on_wheel += _on_wheel(contacts, number, rubbed[:pins])
            total[motion.crank] += force @ nominal
            total[columns] += force + rolls * friction.of_bearings(disc.geometry, disc.pose, np.abs(push))[0]
        total[motion.crank] += rolls * float(friction.of_cranks(pushes).sum())
        ratio = float(place.reduction_ratio)
        held = max(abs(on_wheel), friction.wheel_preload) * friction.support * rolls * np.sign(ratio)
        total[motion.wheel_angle] += held
        total[motion.crank] += held / ratio
        if self._drag:
            turns, slow = motion.input_turns, FADING * self._speed / abs(motion.drive.crank_turns_per_input)
            total += self._drag * (turns @ rate) / np.hypot(turns @ rate, slow) * turns
        return total


def _crank_moments(contacts: Linearised, pushes: Sequence[ComplexArray]) -> FloatArray:
    """Moment that holds each crank against all discs, its cages' part included, N·mm, shape (cranks,)."""
    total = np.zeros(pushes[0].shape[1])
    for number, (disc, push) in enumerate(zip(contacts.discs, pushes, strict=True)):
        bores, cage = disc.bores, disc.geometry.placement.cage_speed
        total += ((bores.lever + cage * bores.displacement)[0].conjugate() * push[0]).imag
        askew = (disc.geometry.lean(disc.pose) - disc.geometry.journal_leans(disc.pose))[0]
        total += cage * (askew.conjugate() * contacts.bearing_moments(number)[0]).imag
    return total


def _on_wheel(contacts: Linearised, disc: int, rubbed: FloatArray) -> complex:
    """Force of a disc on the wheel, with the friction of its pins, N; in slices normals turn along the width."""
    each, pins = contacts.discs[disc], slice(0, contacts.system.pins)
    load = contacts.pin_loads(disc)[0][:, pins]
    force = sum(one @ on_pins[0][:, DISC_PLACE] for one, (on_pins, _) in zip(load, each.gradients, strict=True))
    gradient = each.flank.gradient[0]
    along = gradient[:, Y] - 1j * gradient[:, X]
    return complex(force[0], force[1]) + complex(rubbed @ along)


def _slip(contacts: Linearised, disc: int) -> FloatArray:
    """Slip of wheel pins, then shaft pins, by the pose where each is loaded, off the middle in slices, shape (pairs, k)."""
    each, pins = contacts.discs[disc], contacts.system.pins
    slip = Slip.of_disc(each.geometry, contacts.angle, each.pose, each).by_pose[0]
    coordinates, (load, *moments) = each.geometry.coordinates_of(each.pose), contacts.pin_loads(disc)[0]
    for moment in moments:
        height = np.divide(moment * contacts.half, load, out=np.zeros_like(load), where=load > 0.0)
        along = height[:, None] * np.concatenate((each.flank.along[0], each.holes.along[0]))[:, DISC_PLACE]
        slip[:, coordinates.lean_place] += along
        if coordinates.wheel_leans:
            slip[:pins, coordinates.wheel_lean_place] -= along[:pins]
    return np.asarray(slip)
