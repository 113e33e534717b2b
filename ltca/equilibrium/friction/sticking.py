r"""Friction of contacts that stick or slip while the input is locked.

Nothing turns, so slip is the contacts' own: what bodies yield under the torque moves them along their tangents by
:math:`s_q \cdot \Delta q`. Every contact is a spring behind a slider (Jenkins): from one balanced state to the next its
friction force grows with the tangential stiffness of the contact and slips at μF,

.. math:: T = \mathrm{clip}(T_0 + k_t\, s_q \cdot (q - q_0),\ \pm\mu F).

Bodies in line contact yield along the tangent as they do along the normal (a half-plane's displacements under either load
differ by what is far away alone), so :math:`k_t = \partial F/\partial\delta` of the pair. Contacts that were open begin
without force. Crank bearings and those of cranks and wheel roll by a µm there, less than a contact is wide: they resist
elastically, and nothing is counted for them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import ComplexArray, FloatArray, by_drive
from ltca.compliance.response import DiscResponse
from ltca.equilibrium.balance import Equilibrium
from ltca.equilibrium.friction.slip import Pairs, Slip
from ltca.equilibrium.reducer import JointFriction, Reducer
from ltca.geometry.pairs import ContactGeometry


def stick_or_slip(
    before: FloatArray, stiffness: FloatArray, moved: FloatArray, bound: FloatArray
) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Return the force of sliders behind springs, and which of them stick.

    Parameters
    ----------
    before : array
        Force in the state before, N.
    stiffness : array
        Of the spring, N/mm.
    moved : array
        Displacement since, mm.
    bound : array
        μF, N.

    Examples
    --------
    >>> stick_or_slip(np.array([0.0, 0.0]), np.array(100.0), np.array([0.01, -0.1]), np.array(5.0))
    (array([ 1., -5.]), array([ True, False]))
    """
    elastic = before + stiffness * moved
    return np.clip(elastic, -bound, bound), np.abs(elastic) < bound


@dataclass(frozen=True, slots=True, kw_only=True)
class StickingFriction:
    """Friction of a drive whose input is locked, since a balanced state.

    Attributes
    ----------
    pin, hole : float
        Coefficients with which wheel pins and shaft pins rub.
    pose : array, shape (positions, discs, coordinates of one)
        q of each disc in that state.
    tangential : array, shape (positions, discs, pairs)
        Friction forces there, N.
    closed : array of bool, shape (positions, discs, pairs)
        Contacts that carried there.
    """

    pin: float
    hole: float
    pose: FloatArray = by_drive(2)
    tangential: FloatArray = by_drive(2)
    closed: NDArray[np.bool_] = by_drive(2)

    @property
    def turns(self) -> bool:
        """Whether the drive turns: its input is locked."""
        return False

    @property
    def motion(self) -> int:
        """Sense of the crank: it is locked."""
        return 0

    @property
    def rolling(self) -> float:
        """Moment of the crank bearings by their load: none, they resist elastically."""
        return 0.0

    def scaled(self, strength: float) -> StickingFriction:
        """Return the friction with both coefficients times a factor."""
        return replace(self, pin=strength * self.pin, hole=strength * self.hole)

    def reversed(self) -> StickingFriction:
        """Return the friction itself: contacts stick alike in both senses."""
        return self

    @classmethod
    def at_rest(cls, friction: JointFriction, model: Reducer, found: Equilibrium) -> StickingFriction:
        """Return the friction since a balance without friction, with the coefficients of the drive that turns."""
        return cls(pin=friction.pin, hole=friction.hole, **_state(model, found, rubbed=False))

    def after(self, model: Reducer, found: Equilibrium) -> StickingFriction:
        """Return the friction since a state that was found with this one."""
        return StickingFriction(pin=self.pin, hole=self.hole, **_state(model, found, rubbed=True))

    def along(
        self,
        geometry: ContactGeometry,
        crank_angle: FloatArray,
        pose: FloatArray,
        pairs: Pairs,
        load: FloatArray,
        stiffness: FloatArray,
        disc: int,
    ) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray | None]:
        """Return friction; see `ltca.equilibrium.friction.turning.TurningFriction`."""
        slip = Slip.of_disc(geometry, crank_angle, pose, pairs)
        pins = geometry.placement.wheel_pin_radii.shape[-1]
        coefficient = np.r_[np.full(pins, self.pin), np.full(load.shape[1] - pins, self.hole)]
        stiffness = np.where(self.closed[:, disc], stiffness, 0.0)
        moved = np.einsum("bpj,bj->bp", slip.by_pose, pose - self.pose[:, disc])
        tangential, sticks = stick_or_slip(self.tangential[:, disc], stiffness, moved, coefficient * load)
        return (
            slip.by_pose,
            np.where(sticks, 0.0, np.sign(tangential) * coefficient),
            np.where(sticks, tangential, 0.0),
            np.where(sticks, stiffness, 0.0),
        )

    def of_bearings(self, geometry: ContactGeometry, pose: FloatArray, push: FloatArray) -> FloatArray:
        """Return what the crank bearings of a disc resist with: nothing."""
        return np.zeros(pose.shape)

    def of_wheel(
        self, parts: Sequence[DiscResponse], reduction_ratio: float, external: ComplexArray | float = 0.0
    ) -> FloatArray:
        """Return the moment by which the wheel's bearing rubs: none."""
        return np.zeros(parts[0].pin_load.shape[0])

    def of_cranks(self, pushes: Sequence[ComplexArray], on_bearings: ComplexArray | None = None) -> FloatArray:
        """Return the moment that rubbing takes at every crank: none."""
        return np.zeros(pushes[0].shape)


def _state(model: Reducer, found: Equilibrium, *, rubbed: bool) -> dict[str, Any]:
    parts = found.response.parts
    load = np.stack([np.concatenate((part.pin_load, part.hole_load), axis=1) for part in parts], axis=1)
    held = [part.friction for part in parts if part.friction is not None]
    return {
        "pose": np.stack([found.pose[:, model.coordinates.columns(disc)] for disc in range(len(parts))], axis=1),
        "tangential": np.stack(held, axis=1) if rubbed else np.zeros(load.shape),
        "closed": load > 0.0,
    }
