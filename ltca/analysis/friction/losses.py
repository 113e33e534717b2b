r"""Slip, friction force and power of every joint of a drive that turns; efficiency; whether it moves back.

The power that a joint takes is its friction force times the slip of the turning drive (`ltca.equilibrium.friction.slip`). Over
a radian of the crank it is a moment, which needs no speed. The efficiency is 1 − loss/input at every position, and
1 − mean loss/mean input for the turn; what bodies store and give back within it stands in the input of single positions.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ltca.arrays import FloatArray
from ltca.compliance.response import bearing_pushes
from ltca.drive.parts import Drive, PinShaft, PinWheel
from ltca.equilibrium.balance import Equilibrium
from ltca.equilibrium.friction.slip import Slip
from ltca.equilibrium.friction.turning import rubbing, seat_travel
from ltca.equilibrium.output_torque import crank_moments
from ltca.equilibrium.reducer import Reducer

KINDS = ("pin", "seat", "hole", "roller", "support_bearing", "no_load")
"""Where power goes, named like the fields of ``[friction]``."""


@dataclass(frozen=True, slots=True, kw_only=True)
class JointSlip:
    """Friction of wheel pins or of shaft pins.

    Attributes
    ----------
    force : array, shape (discs, positions, pairs)
        Friction force between disc and pin, its size, N.
    slip : array, shape (discs, positions, pairs)
        Of flank or hole on what it touches, by the crank angle, mm/rad; zero where a free pin rolls there.
    seat_slip : array, shape (discs, positions, pairs)
        Of the free pin or sleeve in its seat, mm/rad; zero where it does not turn, or is fixed.
    energy : array, shape (discs, positions, pairs)
        Lost by radian of the crank, N·mm.
    rolls : bool
        Whether pins slip in their seats rather than on the disc.
    """

    force: FloatArray
    slip: FloatArray
    seat_slip: FloatArray
    energy: FloatArray
    rolls: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class Losses:
    """What friction costs at every position.

    Attributes
    ----------
    pins, holes : JointSlip
        Wheel pins, and shaft pins.
    by_kind : dict of str to array, shape (positions,)
        Energy lost by radian of the crank, by `KINDS`, N·mm.
    input_torque : array, shape (positions,)
        External moment of the input, what seals and oil take included, ccw positive, N·mm; of several cranks that are turned
        in the carrier the sum of theirs.
    at_input, at_output : array, shape (positions,)
        Energy put in at input and output by radian of the crank, N·mm; what comes out there is negative.
    driven_by_input : bool
        Which of them drives.
    crank_speed : float
        Of the cranks against the pin shaft, rad/s; not a number without `ltca.drive.parts.Load.speed`.
    """

    pins: JointSlip
    holes: JointSlip
    by_kind: dict[str, FloatArray]
    input_torque: FloatArray
    at_input: FloatArray
    at_output: FloatArray
    driven_by_input: bool
    crank_speed: float

    @property
    def total(self) -> FloatArray:
        """Energy lost by radian of the crank, N·mm, shape (positions,)."""
        return np.asarray(sum(self.by_kind.values()))

    @property
    def driving(self) -> FloatArray:
        """Energy put in by the side that drives, by radian of the crank, N·mm, shape (positions,)."""
        return self.at_input if self.driven_by_input else self.at_output

    @property
    def efficiency(self) -> FloatArray:
        """1 − loss/input at every position; not positive where a drive that is driven at its output locks itself."""
        return np.asarray(1.0 - self.total / self.driving)

    @property
    def mean_efficiency(self) -> float:
        """1 − mean loss/mean input."""
        return float(1.0 - np.mean(self.total) / np.mean(self.driving))

    def watts(self, per_radian: FloatArray) -> FloatArray:
        """Return power, W, from energy by radian of the crank, N·mm; not a number without speed."""
        return np.asarray(per_radian * self.crank_speed * 1e-3)


def losses(model: Reducer, drive: Drive, found: Equilibrium, torque: float | FloatArray) -> Losses:
    """Return what friction costs.

    Parameters
    ----------
    model : Reducer
        What balanced, with the friction of a drive that turns.
    drive : Drive
        The drive, or one of a batch of drives that agree in what friction and installation are.
    found : Equilibrium
        Balanced positions.
    torque : float or array, shape (positions,)
        Output torque they balance, N·mm.

    Raises
    ------
    ValueError
        When nothing rubs in the model.
    """
    friction, coefficients = model.friction, drive.friction
    if friction is None or not friction.turns or coefficients is None:
        raise ValueError("losses are those of a drive with friction that turns")
    angle, parts = found.crank_angle, found.response.parts
    force = np.abs(np.stack([part.friction for part in parts if part.friction is not None]))
    slips = [
        Slip.of_disc(disc.geometry, angle, found.pose[:, model.coordinates.columns(number)], part).by_crank
        for number, (disc, part) in enumerate(zip(model.discs, parts, strict=True))
    ]
    slip, pins = np.abs(np.stack(slips)), parts[0].pin_load.shape[1]
    wheel = _joint(force[..., :pins], slip[..., :pins], drive.pin_wheel, coefficients.pin, coefficients.seat)
    shaft = _joint(force[..., pins:], slip[..., pins:], drive.pin_shaft, coefficients.hole, coefficients.seat)
    pushes = [bearing_pushes(part.rollers, drive.crank.number) for part in parts]
    rolled = friction.rolling * np.abs(np.stack(pushes)).sum(axis=(0, 2))
    at_cranks = np.abs(friction.of_cranks(pushes)).sum(axis=1) - rolled
    at_wheel = np.abs(friction.of_wheel(parts, drive.reduction_ratio) / drive.reduction_ratio)
    input_turns = 1.0 / drive.crank_turns_per_input
    lost: dict[str, FloatArray] = dict.fromkeys(KINDS, np.zeros(angle.shape))
    for joint, name in ((wheel, "pin"), (shaft, "hole")):
        where = "seat" if joint.rolls else name
        lost[where] = lost[where] + joint.energy.sum(axis=(0, 2))
    lost["roller"], lost["support_bearing"] = rolled, at_wheel + at_cranks
    lost["no_load"] = np.full(angle.shape, coefficients.no_load_torque * abs(input_turns))
    # Cranks that are turned in the carrier are the input, seen from there.
    part = drive.input_per_crank_moment or 1.0
    moments = part * crank_moments(model, angle, found.pose, found.response).sum(axis=1)
    moments += friction.motion * np.sign(input_turns) * coefficients.no_load_torque
    at_output = np.broadcast_to(torque / np.abs(drive.reduction_ratio), angle.shape)
    driven_by_input = friction.motion == drive.driving_sign
    speed = drive.crank_speed
    return Losses(
        pins=wheel,
        holes=shaft,
        by_kind=lost,
        input_torque=moments,
        at_input=friction.motion * input_turns * moments,
        at_output=-at_output if driven_by_input else at_output,
        driven_by_input=driven_by_input,
        crank_speed=np.nan if speed is None else speed,
    )


def _joint(
    force: FloatArray, slip: FloatArray, part: PinWheel | PinShaft | None, contact: float, seat: float
) -> JointSlip:
    rolls = part is not None and part.seat.kind != "fixed" and rubbing(contact, seat, part) < contact
    nowhere = np.zeros_like(slip)
    return JointSlip(
        force=force,
        slip=nowhere if rolls else slip,
        seat_slip=seat_travel(part) * slip if part is not None and rolls else nowhere,
        energy=force * slip,
        rolls=rolls,
    )
