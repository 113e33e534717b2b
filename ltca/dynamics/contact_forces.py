r"""Forces of all contacts and supports of a drive at one instant, over the coordinates of its motion.

Coordinates are those of `ltca.dynamics.kinetics.Motion`, the crank angle among them: with it go the cages, whose work is part of
the force on it. The contacts are those of equilibria (`ltca.mechanics.contacts`), asked for one position with the crank angle
behind its pose. Each call starts from where the last one says that places of rollers, deformations and displaced pins have come
to, and settles them; answers do not depend on the start beyond their tolerances.

Friction works against the slip that a contact has in motion, :math:`v = s_q \dot q + s_\varphi \dot\varphi`, by
:math:`\mu F v/\sqrt{v^2 + v_0^2}`; rolling resistance likewise with the speed of the crank, and the drag of seals and oil
with that of the input. The slip :math:`v_0` is `FADING` of the speed of the eccentric.

Forces from outside act at the axis of the output, of wheel or pin shaft: with the displacement w of the wheel against the shaft
and a force G on the wheel (`ltca.equilibrium.external_force`) their work is :math:`G \cdot (\dot w + i \omega w)` in a frame that
turns by ω.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ltca.arrays import FloatArray
from ltca.compliance.coupled import CoupledCompliance
from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.compliance.response import Start
from ltca.compliance.stored_energy import StoredEnergy
from ltca.dynamics.kinetics import Motion
from ltca.dynamics.teeth import Teeth, TeethForces
from ltca.equilibrium.friction.slip import Slip
from ltca.equilibrium.friction.turning import TurningFriction
from ltca.equilibrium.reducer import Reducer
from ltca.geometry.coordinates import DISC_PLACE, DISC_ROTATION, X, Y
from ltca.mechanics.contacts import ContactSystem, Linearised
from ltca.mechanics.energy import stored_by_disc, stored_by_pins

FADING = 1e-2
"""Slip by the speed of the eccentric at which friction has 0.7 of its size."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Instant:
    """Forces at one instant; n coordinates.

    Attributes
    ----------
    force : array, shape (n,)
        ∂U/∂x of contacts and supports, N and N·mm.
    friction : array, shape (n,)
        Force that has to overcome friction.
    outside : array, shape (n,)
        Force from outside on the output.
    stiffness : array, shape (n, n)
        Σ k g gᵀ of contacts and springs: symmetric, without what forces add as they turn.
    contacts : Linearised
        Contacts of all discs, one position.
    teeth : TeethForces or None
        Of a first stage.
    """

    force: FloatArray
    friction: FloatArray
    outside: FloatArray
    stiffness: FloatArray
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
    """Forces of the contacts and supports of a drive, followed in time.

    Parameters
    ----------
    model : Reducer
        Of the drive.
    motion : Motion
        Coordinates.
    crank_speed : float
        Speed by which friction fades, rad/s.

    Attributes
    ----------
    start : ContactStart or None
        Inner unknowns from which the next call starts; those of contact grids are not of use elsewhere, see `forget_grids`.
    """

    def __init__(self, model: Reducer, motion: Motion, crank_speed: float) -> None:
        friction = model.friction
        self._friction = replace(friction, motion=1) if isinstance(friction, TurningFriction) else None
        self._model = replace(model, supports=None, stage=None, friction=None, external=None)
        self._supports = model.supports
        self._external = model.external
        self._teeth = None if model.stage is None else Teeth(model, motion)
        self._teeth_now: TeethForces | None = None
        self._motion, self._speed = motion, abs(crank_speed)
        rubs = motion.drive.friction
        self._drag = 0.0 if rubs is None else rubs.no_load_torque
        self._springs = motion.springs
        self._system = ContactSystem(self._model)
        self.start: Start | None = None
        self._latest: Linearised | None = None

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
        motion = self._motion
        pose, angle = x[: motion.pose.size], x[motion.crank : motion.crank + 1]
        contacts = self._system.respond(angle, pose[None], self.start, roughly=False, by_crank=True)
        self.start, self._latest = contacts.onward, contacts
        stiffness, force = self._springs.copy(), self._springs @ x
        # The crank angle stands behind the pose.
        force[: contacts.size] += contacts.force[0]
        stiffness[: contacts.size, : contacts.size] += contacts.tangent[0]
        teeth = self._pressed(x, rate, contacts, force, stiffness)
        if self._supports is not None:
            carried = None if teeth is None or teeth.carried is None else teeth.carried[None]
            held, stiff = self._supports.respond(pose[None], carried)
            force[: pose.size] += held[0]
            stiffness[: pose.size, : pose.size] += stiff.reshape(pose.size, pose.size)
        outside, on_wheel = self._outside(angle, pose)
        friction = (
            np.zeros(x.size) if self._friction is None else self._rubbed(self._friction, contacts, rate, on_wheel)
        )
        return Instant(
            force=force, friction=friction, outside=outside, stiffness=stiffness, contacts=contacts, teeth=teeth
        )

    def _pressed(
        self, x: FloatArray, rate: FloatArray, contacts: Linearised, force: FloatArray, stiffness: FloatArray
    ) -> TeethForces | None:
        """Teeth of a first stage; adds their force and stiffness in place."""
        if self._teeth is None:
            return None
        moments = _crank_moments(contacts)
        if self._friction is not None:
            pushes = [contacts.pushes(disc) for disc in range(len(contacts.discs))]
            moments = moments + self._rolls(rate) * self._friction.of_cranks(pushes)[0]
        teeth = self._teeth_now = self._teeth.at(x, moments)
        force += teeth.force
        stiffness += teeth.stiffness
        return teeth

    def _rolls(self, rate: FloatArray) -> float:
        """Sense in which the crank rolls, fading where it stands."""
        turning = float(rate[self._motion.crank])
        return float(turning / np.hypot(turning, FADING * self._speed))

    def stored(self, x: FloatArray) -> tuple[float, tuple[StoredEnergy, ...]]:
        """Return the energy stored at the last instant, whose coordinates these are, N·mm, and that of each disc's contacts."""
        pose = x[: self._motion.pose.size]
        total, teeth, carried = 0.5 * float(x @ self._springs @ x), self._teeth_now, None
        if teeth is not None:
            total, carried = total + teeth.energy, None if teeth.carried is None else teeth.carried[None]
        contacts = self._latest
        assert contacts is not None
        if contacts.shifts is not None:
            # Loads are right to second order in what pins have still to move, what beams and ring store is not.
            contacts = contacts.corrected(np.ones(1))
        discs = stored_by_disc(contacts)
        total += float(stored_by_pins(contacts)[0])
        if self._supports is not None:
            total += float(self._supports.energy(pose[None], carried)[0])
        return total + sum(float(disc.energy[0]) for disc in discs), discs

    def _outside(self, angle: FloatArray, pose: FloatArray) -> tuple[FloatArray, complex]:
        """Force from outside on the output over the coordinates, and on the wheel relative to the shaft, N."""
        found, motion = np.zeros(self._motion.size), self._motion
        if self._external is None:
            return found, 0j
        force, tilting = map(complex, self._external.on_wheel(angle)[0])
        if motion.pose.wheel:
            x, y = pose[motion.pose.wheel_place]
            found[motion.pose.wheel_place] = force.real, force.imag
            found += (x * force.imag - y * force.real) * motion.frame_turns
        if motion.pose.wheel_leans:
            x, y = pose[motion.pose.wheel_lean_place]
            found[motion.pose.wheel_lean_place] += tilting.real, tilting.imag
            found += (x * tilting.imag - y * tilting.real) * motion.frame_turns
        return found, force

    def _rubbed(
        self, friction: TurningFriction, contacts: Linearised, rate: FloatArray, on_wheel: complex
    ) -> FloatArray:
        """Force that has to overcome friction, shape (n,); `on_wheel` is that from outside, N."""
        motion, place, pins = self._motion, self._model.discs[0].geometry.placement, contacts.system.pins
        total, turning = np.zeros(motion.size), float(rate[motion.crank])
        slow = FADING * float(place.mean_eccentricity.ravel()[0]) * self._speed
        rolls = self._rolls(rate)
        rubs = np.repeat((friction.pin, friction.hole), (pins, contacts.system.holes))
        pushes = [contacts.pushes(disc) for disc in range(len(contacts.discs))]
        for disc, (columns, push) in enumerate(zip(contacts.system.columns, pushes, strict=True)):
            nominal = contacts.discs[disc].nominal[0, :, 0]
            slip, load = _slip(contacts, disc), contacts.pin_loads(disc)[0, 0]
            speed = slip @ (rate[columns] + nominal * turning)
            rubbed = rubs * load * speed / np.hypot(speed, slow)
            force = rubbed @ slip
            on_wheel += _on_wheel(contacts, disc, rubbed[:pins])
            total[motion.crank] += force @ nominal
            pushed = friction.rolling * rolls * np.abs(push[0])
            force[DISC_ROTATION] -= pushed.sum()
            if twists := motion.pose.twist_places:
                force[list(twists)] += pushed
            total[columns] += force
        total[motion.crank] += rolls * float(friction.of_cranks(pushes).sum())
        ratio = float(place.reduction_ratio)
        held = max(abs(on_wheel), friction.wheel_preload) * friction.support * rolls * np.sign(ratio)
        total[motion.wheel_angle] += held
        total[motion.crank] += held / ratio
        if self._drag:
            turns = motion.input_turns
            at_input = float(turns @ rate)
            slow = FADING * self._speed / abs(motion.drive.crank_turns_per_input)
            total += self._drag * at_input / np.hypot(at_input, slow) * turns
        return total


def _crank_moments(contacts: Linearised) -> FloatArray:
    """Moment that holds each crank against all discs, its cages' part included, N·mm, shape (cranks,)."""
    total = np.zeros(contacts.discs[0].bores.arm.shape[1])
    for number, disc in enumerate(contacts.discs):
        push, bores, cage = contacts.pushes(number)[0], disc.bores, disc.geometry.placement.cage_speed
        total += ((bores.lever + cage * bores.displacement)[0].conjugate() * push).imag
        if disc.tilts is not None:
            askew = (disc.geometry.lean(disc.pose) - disc.geometry.journal_leans(disc.pose))[0]
            total += cage * (askew.conjugate() * contacts.bearing_moments(number)[0]).imag
    return total


def _on_wheel(contacts: Linearised, disc: int, rubbed: FloatArray) -> complex:
    """Force of a disc on the wheel, with the friction of its pins, N; in slices normals turn along the width."""
    each, pins = contacts.discs[disc], slice(0, contacts.system.pins)
    load, *moment = contacts.pin_loads(disc)[0][:, pins]
    gradient = each.flank.gradient[0]
    force = load @ gradient[:, DISC_PLACE]
    if each.tilts is not None:
        force = force + (moment[0] * contacts.half) @ each.tilts[0].gradient[0][:, DISC_PLACE]
    along = gradient[:, Y] - 1j * gradient[:, X]
    return complex(force[0], force[1]) + complex(rubbed @ along)


def _slip(contacts: Linearised, disc: int) -> FloatArray:
    """Slip of wheel pins, then shaft pins, by the pose where each is loaded, shape (pairs, k): in slices leans move it as well,
    by as far as its load is off the middle.
    """
    each, pins = contacts.discs[disc], contacts.system.pins
    slip = Slip.of_disc(each.geometry, contacts.angle, each.pose, each).by_pose[0]
    if each.tilts is None:
        return np.asarray(slip)
    coordinates = each.geometry.coordinates_of(each.pose)
    load, moment = contacts.pin_loads(disc)[0]
    height = np.divide(moment * contacts.half, load, out=np.zeros_like(load), where=load > 0.0)
    along = height[:, None] * np.concatenate((each.flank.along[0], each.holes.along[0]))[:, DISC_PLACE]
    slip[:, coordinates.lean_place] += along
    if coordinates.wheel_leans:
        slip[:pins, coordinates.wheel_lean_place] -= along[:pins]
    return np.asarray(slip)
