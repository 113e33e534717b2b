r"""Forces of all contacts and supports of a drive at one instant, over the coordinates of its motion.

Coordinates are those of `ltca.dynamics.kinetics.Motion`, the crank angle among them: with it go the cages, whose work is part of
the force on it (`ltca.dynamics.stiffness.crank_force`). Contacts that do not feel each other are followed without a batch axis
(`ltca.dynamics.disc_forces`); all others are asked as equilibria ask them.

Friction works against the slip that a contact has in motion, :math:`v = s_q \dot q + s_\varphi \dot\varphi`, by
:math:`\mu F v/\sqrt{v^2 + v_0^2}`; rolling resistance likewise with the speed of the crank, and the drag of seals and oil
with that of the input. The slip :math:`v_0` is `FADING` of the speed of the eccentric.

Forces from outside act at the axis of the output, of wheel or pin shaft: with the displacement w of the wheel against the shaft
and a force G on the wheel (`ltca.equilibrium.external_force`) their work is :math:`G \cdot (\dot w + i \omega w)` in a frame that
turns by ω.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ltca.arrays import FloatArray
from ltca.compliance.coupled import CoupledCompliance
from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.compliance.response import DiscResponse, Response, Start, bearing_pushes
from ltca.compliance.stored_energy import StoredEnergy
from ltca.dynamics.disc_forces import DiscContacts, DiscForces
from ltca.dynamics.kinetics import Motion
from ltca.dynamics.stiffness import crank_force
from ltca.dynamics.teeth import Teeth, TeethForces
from ltca.equilibrium.friction.slip import Slip
from ltca.equilibrium.friction.turning import TurningFriction
from ltca.equilibrium.reducer import Reducer
from ltca.geometry.coordinates import DISC_PLACE, DISC_ROTATION, WHEEL_ANGLE, X, Y
from ltca.geometry.pairs import ContactGeometry
from ltca.geometry.rotation import unit

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
    discs : tuple of DiscForces
        Contacts of each disc.
    teeth : TeethForces or None
        Of a first stage.
    """

    force: FloatArray
    friction: FloatArray
    outside: FloatArray
    stiffness: FloatArray
    discs: tuple[DiscForces, ...]
    teeth: TeethForces | None


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
        self._springs = _springs(motion)
        coordinates = self._model.coordinates
        self._columns = [coordinates.columns(disc) for disc in range(len(model.discs))]
        self._places = [np.append(own, motion.crank) for own in self._columns]
        self._start: Start | None = None
        self._latest: tuple[FloatArray, FloatArray, Response] | None = None
        discs = [disc for disc in model.discs if isinstance(disc, HalfSpaceCompliance)]
        plain = model.pins is None and len(discs) == len(model.discs) and not model.coordinates.leans
        self._telling = [disc for disc in model.discs if isinstance(disc, HalfSpaceCompliance | CoupledCompliance)]
        self._each = [DiscContacts(disc) for disc in discs] if plain else []

    @property
    def rubs(self) -> bool:
        """Whether there is friction."""
        return self._friction is not None

    @property
    def has_energy(self) -> bool:
        """Whether the stored energy is known: of all but contact grids."""
        return len(self._telling) == len(self._model.discs)

    @property
    def warm_start(self) -> tuple[Any, ...]:
        """Inner unknowns from which the next call starts, as nested tuples; None for contact grids, see `forget_grids`."""
        return tuple(each.warm_start for each in self._each), self._start if self.has_energy else None

    @warm_start.setter
    def warm_start(self, kept: tuple[Any, ...]) -> None:
        """Start the next call from these."""
        for contacts, start in zip(self._each, kept[0], strict=True):
            contacts.warm_start = start
        self._start = kept[1]

    def forget_grids(self) -> None:
        """Let contact grids begin anew: they have as many cells as they need, which no checkpoint keeps."""
        if not self.has_energy:
            self._start = None
            grids: tuple[Any, ...] = self._model.discs
            for disc in grids:
                disc.forget()

    def at(self, x: FloatArray, rate: FloatArray) -> Instant:
        """Return the forces at coordinates and their rates, each of shape (n,)."""
        motion, size = self._motion, self._motion.size
        pose, angle = x[: motion.pose.size], float(x[motion.crank])
        stiffness = self._springs.copy()
        force = stiffness @ x
        if self._each:
            discs = tuple(each.at(angle, pose[own]) for each, own in zip(self._each, self._columns, strict=True))
            for places, disc in zip(self._places, discs, strict=True):
                force[places[:-1]] += disc.force
                force[motion.crank] += disc.by_crank
                stiffness[np.ix_(places, places)] += disc.stiffness
        else:
            discs = self._asked(angle, pose, force, stiffness)
        teeth = self._pressed(x, rate, discs, force, stiffness)
        if self._supports is not None:
            carried = None if teeth is None or teeth.carried is None else teeth.carried[None]
            held, stiff = self._supports.respond(pose[None], carried)
            force[: pose.size] += held[0]
            stiffness[: pose.size, : pose.size] += stiff.reshape(pose.size, pose.size)
        outside, on_wheel = self._outside(angle, pose)
        friction = np.zeros(size) if self._friction is None else self._rubbed(self._friction, discs, rate, on_wheel)
        return Instant(force=force, friction=friction, outside=outside, stiffness=stiffness, discs=discs, teeth=teeth)

    def _pressed(
        self, x: FloatArray, rate: FloatArray, discs: Sequence[DiscForces], force: FloatArray, stiffness: FloatArray
    ) -> TeethForces | None:
        """Teeth of a first stage; adds their force and stiffness in place."""
        if self._teeth is None:
            return None
        moments = np.sum([disc.crank_moment for disc in discs], axis=0)
        if self._friction is not None:
            moments = moments + self._rolls(rate) * self._friction.of_cranks([disc.push[None] for disc in discs])[0]
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
        if self._latest is None:
            discs = [each.stored() for each in self._each]
        else:
            angle, row, response = self._latest
            discs = [
                disc.stored(angle, row[:, own], part)
                for disc, own, part in zip(self._telling, self._columns, response.parts, strict=True)
            ]
            total += self._bent(angle, row, response)
        if self._supports is not None:
            total += float(self._supports.energy(pose[None], carried)[0])
        return total + sum(float(disc.energy[0]) for disc in discs), tuple(discs)

    def _bent(self, angle: FloatArray, pose: FloatArray, response: Response) -> float:
        """Energy of what holds pins together, ½ Σ f·u with their displacements u, in slices ½ Σ m·l of their leans as well: wheel
        pins have both in the turning wheel.
        """
        if response.shifts is None:
            return 0.0
        wheel = unit(self._model.discs[0].geometry.placement.wheel_rotation(angle) + pose[:, WHEEL_ANGLE])
        total = 0.0
        for number, part in enumerate(response.parts):
            work = [(part.pin_forces.copy(), response.shifts[:, number])]
            if part.leans is not None:
                work.append((part.pin_moments.copy(), part.leans))
            for force, moved in work:
                force[:, : part.pin_load.shape[1]] *= wheel.conjugate()[:, None]
                total += 0.5 * float((force.conjugate() * moved).real.sum())
        return total

    def _outside(self, angle: float, pose: FloatArray) -> tuple[FloatArray, complex]:
        """Force from outside on the output over the coordinates, and on the wheel relative to the shaft, N."""
        found, motion = np.zeros(self._motion.size), self._motion
        if self._external is None:
            return found, 0j
        force = complex(self._external.on_wheel(np.array([angle]))[0])
        if motion.pose.wheel:
            x, y = pose[motion.pose.wheel_place]
            found[motion.pose.wheel_place] = force.real, force.imag
            found += (x * force.imag - y * force.real) * motion.frame_turns
        if motion.pose.wheel_leans:
            tilting = complex(self._external.tilting(np.array([angle]))[0])
            x, y = pose[motion.pose.wheel_lean_place]
            found[motion.pose.wheel_lean_place] += tilting.real, tilting.imag
            found += (x * tilting.imag - y * tilting.real) * motion.frame_turns
        return found, force

    def _asked(
        self, angle: float, pose: FloatArray, force: FloatArray, stiffness: FloatArray
    ) -> tuple[DiscForces, ...]:
        """Contacts as equilibria ask them; adds their force and stiffness in place."""
        model, size, crank = self._model, pose.size, self._motion.crank
        at, row = np.array([angle]), pose[None]
        response = model.respond(at, row, self._start)
        self._start, self._latest = Start.after(response), (at, row, response)
        force[:size] += response.force[0]
        force[crank] += float(crank_force(model, at, row, response)[0])
        own = 0.5 * (response.tangent[0] + response.tangent[0].T)
        nominal, bearings, discs = np.zeros(size), np.zeros((size, size)), []
        for columns, disc, part in zip(self._columns, model.discs, response.parts, strict=True):
            geometry, place = disc.geometry, disc.geometry.placement
            velocity = complex(place.race_velocity(at)[0])
            along = np.zeros(columns.size)
            along[X], along[Y], along[WHEEL_ANGLE] = velocity.real, velocity.imag, 1.0 / place.reduction_ratio
            nominal[columns] = along
            moved = geometry.bores(at, row[:, columns]).gradient[0]
            rollers = part.rollers.tangent[0]
            each = rollers.reshape(place.cranks, -1, *rollers.shape[1:]).sum(axis=1)[:, :2, :2]
            for stiff, gradient in zip(each, moved, strict=True):
                both = np.stack((gradient.real, gradient.imag))
                bearings[np.ix_(columns, columns)] += both.T @ stiff @ both
            slip, pins = _slip(geometry, at, row[:, columns], part), part.pin_load.shape[1]
            normal = part.flank.gradient[0, :, X] + 1j * part.flank.gradient[0, :, Y]
            discs.append(
                DiscForces(
                    force=part.force[0],
                    by_crank=0.0,  # of all discs together
                    nominal=along,
                    pin_load=part.pin_load[0],
                    hole_load=part.hole_load[0],
                    pin_gradient=part.flank.gradient[0],
                    hole_gradient=part.holes.gradient[0],
                    pin_slip=slip[:pins],
                    hole_slip=slip[pins:],
                    stiffness=part.tangent[0],
                    crank_moment=Reducer(discs=(disc,)).crank_moments(at, row[:, columns], (part,))[0],
                    push=bearing_pushes(part.rollers, place.cranks)[0],
                    inner_load=part.rollers.inner_load[0],
                    outer_load=part.rollers.outer_load[0],
                    wheel_force=complex(part.pin_forces[0, :pins].sum()),
                    wheel_along=-1j * normal,
                )
            )
        column = (own - bearings) @ nominal
        stiffness[:size, :size] += own
        stiffness[:size, crank] += column
        stiffness[crank, :size] += column
        stiffness[crank, crank] += nominal @ column
        return tuple(discs)

    def _rubbed(
        self, friction: TurningFriction, discs: Sequence[DiscForces], rate: FloatArray, on_wheel: complex
    ) -> FloatArray:
        """Force that has to overcome friction, shape (n,); `on_wheel` is that from outside, N."""
        motion, place = self._motion, self._model.discs[0].geometry.placement
        total, turning = np.zeros(motion.size), float(rate[motion.crank])
        slow = FADING * float(place.mean_eccentricity.ravel()[0]) * self._speed
        rolls = self._rolls(rate)
        for columns, disc in zip(self._columns, discs, strict=True):
            going = rate[columns] + disc.nominal * turning
            force = np.zeros(columns.size)
            for coefficient, load, slip, on_pins in (
                (friction.pin, disc.pin_load, disc.pin_slip, True),
                (friction.hole, disc.hole_load, disc.hole_slip, False),
            ):
                speed = slip @ going
                rubbed = coefficient * load * speed / np.hypot(speed, slow)
                force += rubbed @ slip
                if on_pins:
                    on_wheel += disc.wheel_force + complex(rubbed @ disc.wheel_along)
            total[motion.crank] += force @ disc.nominal
            pushed = friction.rolling * rolls * np.abs(disc.push)
            force[DISC_ROTATION] -= pushed.sum()
            if twists := motion.pose.twist_places:
                force[list(twists)] += pushed
            total[columns] += force
        total[motion.crank] += rolls * float(friction.of_cranks([disc.push[None] for disc in discs]).sum())
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


def _slip(geometry: ContactGeometry, crank_angle: FloatArray, pose: FloatArray, part: DiscResponse) -> FloatArray:
    """Slip of wheel pins, then shaft pins, by the pose where each is loaded, shape (pairs, k): in slices leans move it as well,
    by as far as its load is off the middle.
    """
    slip = Slip.of_disc(geometry, crank_angle, pose, part).by_pose[0]
    if part.leaning_pins is None or part.leaning_holes is None:
        return np.asarray(slip)
    coordinates, pins = geometry.coordinates_of(pose), part.pin_load.shape[1]
    load = np.concatenate((part.pin_load[0], part.hole_load[0]))
    moment = np.concatenate((part.leaning_pins.contact.moment[0], part.leaning_holes.contact.moment[0]))
    height = np.divide(moment, load, out=np.zeros_like(load), where=load > 0.0)
    along = height[:, None] * np.concatenate((part.flank.along[0], part.holes.along[0]))[:, DISC_PLACE]
    slip[:, coordinates.lean_place] += along
    if coordinates.wheel_leans:
        slip[:pins, coordinates.wheel_lean_place] -= along[:pins]
    return np.asarray(slip)


def _springs(motion: Motion) -> FloatArray:
    """Stiffness of the carrier's twist, shape (n, n)."""
    found, carrier = np.zeros((motion.size, motion.size)), motion.drive.carrier
    if motion.twist is not None and carrier is not None:
        found[motion.twist, motion.twist] += carrier.stiffness_torsion or 0.0
    return found
