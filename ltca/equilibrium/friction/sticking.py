"""Friction of contacts that stick or slip while the input is locked (``docs/theory/friction.md``)."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import FloatArray, by_drive
from ltca.equilibrium.balance import Equilibrium
from ltca.equilibrium.friction.slip import Slip
from ltca.equilibrium.friction.turning import TurningFriction
from ltca.equilibrium.reducer import Reducer
from ltca.mechanics.places import DiscPlaces


def stick_or_slip(
    before: FloatArray, stiffness: FloatArray, moved: FloatArray, bound: FloatArray
) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Return the force of sliders behind springs, clip(T₀ + k_t Δs, ±μF), N, and which of them stick; `bound` is μF.

    >>> stick_or_slip(np.array([0.0, 0.0]), np.array(100.0), np.array([0.01, -0.1]), np.array(5.0))
    (array([ 1., -5.]), array([ True, False]))
    """
    elastic = before + stiffness * moved
    return np.clip(elastic, -bound, bound), np.abs(elastic) < bound


@dataclass(frozen=True, slots=True, kw_only=True)
class StickingFriction(TurningFriction):
    """Friction of pins since a balanced state, of a drive whose input is locked; bearings resist elastically."""

    pose: FloatArray = by_drive(2)  # of the balanced state, shape (positions, discs, coordinates of one)
    tangential: FloatArray = by_drive(2)  # friction there, N, shape (positions, discs, pairs)
    closed: NDArray[np.bool_] = by_drive(2)  # contacts that carried there

    @classmethod
    def at_rest(cls, friction: TurningFriction, model: Reducer, found: Equilibrium) -> StickingFriction:
        """Return the friction since a balance without friction, with the coefficients of the drive that turns."""
        kept = {item.name: getattr(friction, item.name) for item in fields(TurningFriction)}
        none, nothing = {"rolling": 0.0, "support": 0.0, "motion": 0}, np.zeros(0)
        return cls(**kept | none, pose=nothing, tangential=nothing, closed=nothing > 0.0).after(model, found)

    def after(self, model: Reducer, found: Equilibrium) -> StickingFriction:
        """Return the friction since a state that was found with this one, or without friction."""
        parts = found.response.parts
        load = np.stack([np.concatenate((part.pin_load, part.hole_load), axis=1) for part in parts], axis=1)
        held = [part.friction for part in parts if part.friction is not None]
        return replace(
            self,
            pose=np.stack([found.pose[:, model.coordinates.columns(disc)] for disc in range(len(parts))], axis=1),
            tangential=np.stack(held, axis=1) if held else np.zeros(load.shape),
            closed=load > 0.0,
        )

    def along(
        self, places: DiscPlaces, load: FloatArray, stiffness: FloatArray, disc: int
    ) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray | None]:
        """Return friction as `TurningFriction.along` does."""
        slip = Slip.of_disc(places.geometry, places.angle, places.pose, places)
        pins = places.geometry.placement.wheel_pin_radii.shape[-1]
        coefficient = np.repeat((self.pin, self.hole), (pins, load.shape[1] - pins))
        stiffness = np.where(self.closed[:, disc], stiffness, 0.0)
        moved = np.einsum("bpj,bj->bp", slip.by_pose, places.pose - self.pose[:, disc])
        tangential, sticks = stick_or_slip(self.tangential[:, disc], stiffness, moved, coefficient * load)
        return (
            slip.by_pose,
            np.where(sticks, 0.0, np.sign(tangential) * coefficient),
            np.where(sticks, tangential, 0.0),
            np.where(sticks, stiffness, 0.0),
        )
