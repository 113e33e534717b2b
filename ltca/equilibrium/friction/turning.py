"""Coulomb friction and rolling resistance of a drive that turns (``docs/theory/friction.md``); axial forces are left out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ltca.arrays import ComplexArray, FloatArray
from ltca.beam import support_parts
from ltca.compliance.response import DiscResponse
from ltca.drive.parts import Drive, PinShaft, PinWheel
from ltca.equilibrium.friction.slip import Slip
from ltca.geometry.coordinates import DISC_ROTATION
from ltca.geometry.pairs import ContactGeometry
from ltca.laws.bearing_pair import SideLaw
from ltca.laws.member_bearings import crank_laws, wheel_law
from ltca.mechanics.places import DiscPlaces

FADING_SLIP = 1e-4
"""Slip per crank angle, by the eccentricity, below which friction fades: its sense reverses at the pitch point."""


def rubbing(contact: float, seat: float, part: PinWheel | PinShaft) -> float:
    """Return the coefficient with which pins rub: μ at flank or hole, or in slot or sleeve where free ones slip more easily."""
    return contact if part.seat.kind == "fixed" else min(contact, seat * seat_travel(part))


def seat_travel(part: PinWheel | PinShaft) -> float:
    """Return the slip of a pin in its seat by that of its loose surface: r_i/R of a sleeve, 1 in a slot."""
    if part.seat.kind != "sleeve":
        return 1.0
    return (part.seat.bore_radius or 0.0) / part.pin_radius


@dataclass(frozen=True, slots=True, kw_only=True)
class TurningFriction:
    """Friction of a drive that turns."""

    pin: float  # coefficient of wheel pins, `hole` that of shaft pins (`rubbing`)
    hole: float
    rolling: float  # f·(r_i + r_BR) of the crank bearings, mm
    support: float  # f times the radius of the bearings of cranks and wheel, mm
    crank_bearings: FloatArray  # part of the force of each disc on each bearing of a crank, shape (bearings, discs)
    wheel_preload: float  # sum over the elements, N
    crank_preload: FloatArray  # the same of each bearing of a crank
    motion: int  # +1 of a crank that turns counter-clockwise, −1 clockwise, 0 of a locked input
    strength: float = 1.0  # of all coefficients, for continuation

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
        """Return slips of pins by the pose, friction by load, other friction, N, and its growth with slip, N/mm or None."""
        slip = Slip.of_disc(places.geometry, places.angle, places.pose, places)
        place = places.geometry.placement
        pins, soft = place.wheel_pin_radii.shape[-1], FADING_SLIP * place.mean_eccentricity
        sense = (self.motion * self.strength) * np.clip(slip.by_crank / soft, -1.0, 1.0)
        sense[:, :pins] *= self.pin
        sense[:, pins:] *= self.hole
        return slip.by_pose, sense, np.zeros(load.shape), None

    def of_bearings(self, geometry: ContactGeometry, pose: FloatArray, push: FloatArray) -> FloatArray:
        """Return the resistance of the crank bearings of a disc by the sizes of their forces, N, shape (positions, cranks)."""
        force = np.zeros(pose.shape)
        rolled = self.motion * self.strength * self.rolling
        force[:, DISC_ROTATION] -= rolled * push.sum(axis=1)
        if twists := geometry.coordinates_of(pose).twist_places:
            force[:, twists] += rolled * push
        return force

    def of_wheel(
        self, parts: Sequence[DiscResponse], reduction_ratio: float, external: ComplexArray | float = 0.0
    ) -> FloatArray:
        """Return the moment by which the wheel's bearing rubs, to be overcome, ccw positive, N·mm, shape (positions,)."""
        pins = parts[0].pin_load.shape[1]
        load = np.abs(sum(part.pin_forces[:, :pins].sum(axis=1) for part in parts) + external)
        load = np.maximum(load, self.wheel_preload)
        return np.asarray(self.motion * self.strength * self.support * np.sign(reduction_ratio) * load)

    def of_cranks(self, pushes: Sequence[ComplexArray], on_bearings: ComplexArray | None = None) -> FloatArray:
        """Return the moment that rubbing takes at every crank, ccw positive, N·mm, shape (positions, cranks).

        `pushes` are its forces on every disc, N, `on_bearings` further ones on bearings, shape (positions, cranks, bearings).
        """
        forces = np.stack(pushes, axis=-1)
        carried = np.matmul(forces, self.crank_bearings.T.astype(complex))
        if on_bearings is not None:
            more = np.zeros((*carried.shape[:-1], on_bearings.shape[-1] - carried.shape[-1]))
            carried = on_bearings - np.concatenate((carried, more), axis=-1)
        reactions = np.maximum(np.abs(carried), self.crank_preload).sum(axis=-1)
        rolled = np.abs(forces).sum(axis=-1)
        return np.asarray(self.motion * self.strength * (self.rolling * rolled + self.support * reactions))
