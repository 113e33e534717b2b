r"""Coulomb friction and rolling resistance of a drive that turns.

Slip of the turning drive follows from kinematics (`ltca.equilibrium.friction.slip`), so every contact rubs with μF against
it: the generalised force :math:`Q = \sum \mu F \sigma s_q` with the sense σ of its slip. A pin that is free to turn slips
where that takes less: loose in a slot with the smaller of both coefficients, under a sleeve of bore r_i and outside R with
:math:`\min(\mu, \mu_{seat} r_i/R)`, to first order in μ (the total forces on a free pin pass through both its contacts).
Crank bearings roll with the moment :math:`f |F_b| (r_i + r_{BR})` between crank and disc; the bearings of cranks and wheel rub
with f times their load at a radius of their own: the radial force, and where that is less the loads of all elements by the
preload (`SideLaw.preload_load`). Axial forces and tilting moments are left out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ltca.arrays import ComplexArray, FloatArray
from ltca.beam import support_parts
from ltca.compliance.response import DiscResponse
from ltca.drive.parts import Drive, PinShaft, PinWheel
from ltca.equilibrium.friction.slip import Slip
from ltca.equilibrium.supports import crank_laws, wheel_law
from ltca.geometry.coordinates import DISC_ROTATION
from ltca.geometry.pairs import ContactGeometry
from ltca.laws.bearing_pair import SideLaw
from ltca.mechanics.places import DiscPlaces

FADING_SLIP = 1e-4
"""Slip per crank angle, relative to the eccentricity, below which friction is reduced linearly to zero: at the pitch point the
sense of the slip reverses."""


def rubbing(contact: float, seat: float, part: PinWheel | PinShaft) -> float:
    """Return the coefficient with which pins rub: μ at flank or hole, or in slot or sleeve where free ones slip more easily."""
    return contact if part.seat.kind == "fixed" else min(contact, seat * seat_travel(part))


def seat_travel(part: PinWheel | PinShaft) -> float:
    """Return how far a pin slips in its seat while the surface of what is loose moves by one: r_i/R of a sleeve, 1 in a slot."""
    if part.seat.kind != "sleeve":
        return 1.0
    return (part.seat.bore_radius or 0.0) / part.pin_radius


@dataclass(frozen=True, slots=True, kw_only=True)
class TurningFriction:
    """Friction of a drive that turns: `motion` is +1 where its crank turns counter-clockwise, −1 clockwise, 0 of a locked input.

    `pin` and `hole` are coefficients (`rubbing`), `rolling` is f·(r_i + r_BR) of the crank bearings and `support` f times the
    radius of the bearings of cranks and wheel, mm. `crank_bearings` is the load of each bearing of a crank by the forces of the
    discs on it, shape (bearings, discs); preloads are sums over the elements of a bearing, N, those of a crank of shape
    (bearings,). `strength` is the part of all coefficients that counts, for continuation.
    """

    pin: float
    hole: float
    rolling: float
    support: float
    crank_bearings: FloatArray
    wheel_preload: float
    crank_preload: FloatArray
    motion: int
    strength: float = 1.0

    @classmethod
    def of_drive(cls, drive: Drive) -> TurningFriction | None:
        """Return the friction of a drive; None where it has none."""
        found, shaft, bearing, wheel = drive.friction, drive.pin_shaft, drive.crank_bearing, wheel_law(drive)
        if found is None:
            return None
        # Two supports of a crank in balance, or a bearing beside each disc.
        planes, supports = drive.disc.disc_planes, drive.crank_supports
        return cls(
            pin=rubbing(found.pin, found.seat, drive.pin_wheel),
            hole=0.0 if shaft is None else rubbing(found.hole, found.seat, shaft),
            rolling=found.roller * (bearing.inner_race_radius + bearing.roller_radius),
            support=found.support_bearing * found.support_bearing_radius,
            crank_bearings=np.eye(len(planes)) if supports is None else support_parts(planes, supports),
            wheel_preload=wheel.preload_load if isinstance(wheel, SideLaw) else 0.0,
            crank_preload=np.array([law.preload_load for law in crank_laws(drive) or ()] or [0.0]),
            motion=drive.motion_sign,
        )

    @property
    def turns(self) -> bool:
        """Whether the drive turns: its friction goes with the loads alone and may be followed from none."""
        return self.motion != 0

    def scaled(self, strength: float) -> TurningFriction:
        """Return a part of this friction."""
        return replace(self, strength=strength)

    def reversed(self) -> TurningFriction:
        """Return the friction of the same drive as it turns the other way."""
        return replace(self, motion=-self.motion)

    def along(
        self, places: DiscPlaces, load: FloatArray, stiffness: FloatArray, disc: int
    ) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray | None]:
        """Return slip by the pose, the friction of wheel pins and shaft pins of a disc by their loads, what it has beside, N, and
        what it grows with slip by, N/mm or None; each of shape (positions, pairs), the first with the coordinates behind.
        """
        slip = Slip.of_disc(places.geometry, places.angle, places.pose, places)
        place = places.geometry.placement
        pins, soft = place.wheel_pin_radii.shape[-1], FADING_SLIP * place.mean_eccentricity
        sense = (self.motion * self.strength) * np.clip(slip.by_crank / soft, -1.0, 1.0)
        sense[:, :pins] *= self.pin
        sense[:, pins:] *= self.hole
        return slip.by_pose, sense, np.zeros(load.shape), None

    def of_bearings(self, geometry: ContactGeometry, pose: FloatArray, push: FloatArray) -> FloatArray:
        """Return what the crank bearings of a disc resist with by the sizes of their forces, N, shape (positions, cranks)."""
        force = np.zeros(pose.shape)
        rolled = self.motion * self.strength * self.rolling
        force[:, DISC_ROTATION] -= rolled * push.sum(axis=1)
        if twists := geometry.coordinates_of(pose).twist_places:
            force[:, twists] += rolled * push
        return force

    def of_wheel(
        self, parts: Sequence[DiscResponse], reduction_ratio: float, external: ComplexArray | float = 0.0
    ) -> FloatArray:
        """Return the moment by which the wheel's bearing rubs, to be overcome, ccw positive, N·mm, shape (positions,).

        The contacts of each disc come with their friction; `external` is the force from outside on the wheel, N.
        """
        pins = parts[0].pin_load.shape[1]
        load = np.abs(sum(part.pin_forces[:, :pins].sum(axis=1) for part in parts) + external)
        load = np.maximum(load, self.wheel_preload)
        return np.asarray(self.motion * self.strength * self.support * np.sign(reduction_ratio) * load)

    def of_cranks(self, pushes: Sequence[ComplexArray], on_bearings: ComplexArray | None = None) -> FloatArray:
        """Return the moment that rubbing takes at every crank, ccw positive, N·mm, shape (positions, cranks).

        `pushes` are the forces of each crank on every disc, N, complex, shape (positions, cranks), and `on_bearings` what its
        bearings carry besides, shape (positions, cranks, bearings), further bearings behind those of the discs.
        """
        forces = np.stack(pushes, axis=-1)
        carried = np.matmul(forces, self.crank_bearings.T.astype(complex))
        if on_bearings is not None:
            more = np.zeros((*carried.shape[:-1], on_bearings.shape[-1] - carried.shape[-1]))
            carried = on_bearings - np.concatenate((carried, more), axis=-1)
        reactions = np.maximum(np.abs(carried), self.crank_preload).sum(axis=-1)
        rolled = np.abs(forces).sum(axis=-1)
        return np.asarray(self.motion * self.strength * (self.rolling * rolled + self.support * reactions))
