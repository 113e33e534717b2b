r"""Slip, friction force and power of every joint of a drive that turns; efficiency; whether it moves back.

The power that a joint takes is its friction force times the slip of the turning drive (`ltca.equilibrium.friction.slip`). Over
a radian of the crank it is a moment, which needs no speed. The efficiency is 1 − loss/input at every position, and
1 − mean loss/mean input for the turn; what bodies store and give back within it stands in the input of single positions.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import BoolArray, FloatArray
from ltca.compliance.response import bearing_pushes
from ltca.drive.parts import Drive, PinShaft, PinWheel
from ltca.equilibrium.balance import Equilibrium
from ltca.equilibrium.friction.slip import Slip
from ltca.equilibrium.friction.turning import rubbing, seat_travel
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
    rolls : array of bool, shape (positions,)
        Whether pins slip in their seats rather than on the disc.
    """

    force: FloatArray
    slip: FloatArray
    seat_slip: FloatArray
    energy: FloatArray
    rolls: BoolArray


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
    driven_by_input : array of bool, shape (positions,)
        Which of them drives.
    input_turns : array, shape (positions,)
        Turns of the input by those of the cranks.
    crank_speed : array, shape (positions,)
        Of the cranks against the pin shaft, rad/s; not a number without `ltca.drive.parts.Load.speed`.
    """

    pins: JointSlip
    holes: JointSlip
    by_kind: dict[str, FloatArray]
    input_torque: FloatArray
    at_input: FloatArray
    at_output: FloatArray
    driven_by_input: BoolArray
    input_turns: FloatArray
    crank_speed: FloatArray

    @property
    def total(self) -> FloatArray:
        """Energy lost by radian of the crank, N·mm, shape (positions,)."""
        return np.asarray(sum(self.by_kind.values()))

    @property
    def driving(self) -> FloatArray:
        """Energy put in by the side that drives, by radian of the crank, N·mm, shape (positions,)."""
        return np.where(self.driven_by_input, self.at_input, self.at_output)

    @property
    def efficiency(self) -> FloatArray:
        """1 − loss/input at every position; not positive where a drive that is driven at its output locks itself.

        Not a number where nothing goes through: without a torque at the output all that is put in is lost.
        """
        through = np.where(self.at_output == 0.0, np.nan, self.driving)
        return np.asarray(1.0 - self.total / through)

    @property
    def mean_efficiency(self) -> float:
        """1 − mean loss/mean input; not a number where nothing goes through."""
        through = np.nan if not np.any(self.at_output) else np.mean(self.driving)
        return float(1.0 - np.mean(self.total) / through)

    @property
    def drag_torque(self) -> float:
        """Mean torque that friction takes at the input of a drive without a torque at the output, N·mm; else not a number."""
        if np.any(self.at_output):
            return float("nan")
        return float(np.mean(self.total / np.abs(self.input_turns)))

    def per_second(self, per_radian: FloatArray) -> FloatArray:
        """Return what happens in a second from what happens in a radian of the crank; not a number without speed.

        Positions are the only axis, or the second of three.
        """
        return np.asarray(per_radian * (self.crank_speed if per_radian.ndim == 1 else self.crank_speed[:, None]))

    def watts(self, per_radian: FloatArray) -> FloatArray:
        """Return power, W, from energy by radian of the crank, N·mm; not a number without speed."""
        return np.asarray(self.per_second(per_radian) * 1e-3)


def losses(model: Reducer, drives: Sequence[Drive], found: Equilibrium, torque: float | FloatArray) -> Losses:
    """Return what friction costs.

    Parameters
    ----------
    model : Reducer
        What balanced, with the friction of a drive that turns.
    drives : sequence of Drive
        The drives of the batch, often one; all have the same number of positions, drive by drive.
    found : Equilibrium
        Balanced positions.
    torque : float or array, shape (positions,)
        Output torque they balance, N·mm.

    Raises
    ------
    ValueError
        When nothing rubs in the model.
    """
    friction, coefficients = model.friction, [drive.friction for drive in drives if drive.friction is not None]
    if friction is None or not friction.turns or len(coefficients) < len(drives):
        raise ValueError("losses are those of a drive with friction that turns")
    angle, parts = found.crank_angle, found.response.parts
    each = angle.size // len(drives)

    def by_position(values: Sequence[Any]) -> NDArray[Any]:
        return np.repeat(values, each)

    force = np.abs(np.stack([part.friction for part in parts if part.friction is not None]))
    slips = [
        Slip.of_disc(disc.geometry, angle, found.pose[:, model.coordinates.columns(number)], part).by_crank
        for number, (disc, part) in enumerate(zip(model.discs, parts, strict=True))
    ]
    slip, pins = np.abs(np.stack(slips)), parts[0].pin_load.shape[1]
    pairs = list(zip(drives, coefficients, strict=True))
    on_wheel = [_seat(drive.pin_wheel, rubs.pin, rubs.seat) for drive, rubs in pairs]
    on_shaft = [_seat(drive.pin_shaft, rubs.hole, rubs.seat) for drive, rubs in pairs]
    wheel = _joint(force[..., :pins], slip[..., :pins], *map(by_position, zip(*on_wheel, strict=True)))
    shaft = _joint(force[..., pins:], slip[..., pins:], *map(by_position, zip(*on_shaft, strict=True)))
    pushes = [bearing_pushes(part.rollers, model.discs[0].geometry.placement.cranks) for part in parts]
    rolled = friction.rolling * np.abs(np.stack(pushes)).sum(axis=(0, 2))
    on_bearings = None
    if model.stage is not None:
        smooth = replace(model, friction=None).crank_moments(angle, found.pose, found.response.parts)
        on_bearings = model.stage.on_bearings(smooth)
    at_cranks = np.abs(friction.of_cranks(pushes, on_bearings)).sum(axis=1) - rolled
    ratio = drives[0].reduction_ratio  # that of all: their parts are as many
    beside = model.beside_pins(angle, found.pose, parts)[:, 0]
    at_wheel = np.abs(friction.of_wheel(parts, ratio, beside) / ratio)
    input_turns = by_position([1.0 / drive.crank_turns_per_input for drive in drives])
    no_load = by_position([rubs.no_load_torque for rubs in coefficients])
    lost: dict[str, FloatArray] = dict.fromkeys(KINDS, np.zeros(angle.shape))
    for joint, name in ((wheel, "pin"), (shaft, "hole")):
        energy = joint.energy.sum(axis=(0, 2))
        lost[name] = np.where(joint.rolls, 0.0, energy)
        lost["seat"] = lost["seat"] + np.where(joint.rolls, energy, 0.0)
    lost["roller"], lost["support_bearing"] = rolled, at_wheel + at_cranks
    lost["no_load"] = no_load * np.abs(input_turns)
    # Cranks that are turned in the carrier are the input, seen from there.
    part = by_position([drive.input_per_crank_moment or 1.0 for drive in drives])
    moments = part * model.crank_moments(angle, found.pose, found.response.parts).sum(axis=1)
    moments += friction.motion * np.sign(input_turns) * no_load
    at_output = np.broadcast_to(torque / np.abs(ratio), angle.shape)
    driven_by_input = by_position([friction.motion == drive.driving_sign for drive in drives])
    return Losses(
        pins=wheel,
        holes=shaft,
        by_kind=lost,
        input_torque=moments,
        at_input=friction.motion * input_turns * moments,
        at_output=np.where(driven_by_input, -at_output, at_output),
        driven_by_input=driven_by_input,
        input_turns=input_turns,
        crank_speed=by_position([np.nan if (speed := drive.crank_speed) is None else speed for drive in drives]),
    )


def _seat(part: PinWheel | PinShaft | None, contact: float, seat: float) -> tuple[bool, float]:
    """Tell whether pins slip in their seats rather than on the disc, and how far (`seat_travel`)."""
    if part is None or part.seat.kind == "fixed":
        return False, 0.0
    return rubbing(contact, seat, part) < contact, seat_travel(part)


def _joint(force: FloatArray, slip: FloatArray, rolls: BoolArray, travel: FloatArray) -> JointSlip:
    rolling = rolls[:, None]
    return JointSlip(
        force=force,
        slip=np.where(rolling, 0.0, slip),
        seat_slip=np.where(rolling, travel[:, None] * slip, 0.0),
        energy=force * slip,
        rolls=rolls,
    )
