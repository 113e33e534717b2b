"""Friction of a turning drive as a torque at its input, by the torque on the output and the sense of motion.

Friction is Coulomb's and rolling resistance, whose coefficients do not go with speed (``[friction]``): neither does the table.
What a turn of the drive loses (`ltca.analysis.friction.losses`), by the angle of the input, is the friction torque there. A load
on the output moves the input without help where its torque, by the ratio, is more than that; the least such load is the torque
that drives back. Where a drive that is driven at its output has no equilibrium, it locks itself: the friction is then told as
what the load asks.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ltca.analysis.engines import Engine
from ltca.analysis.friction.losses import losses
from ltca.arrays import BoolArray, FloatArray
from ltca.drive.parts import Drive
from ltca.equilibrium.output_torque import solve_at_output
from ltca.errors import ConvergenceError
from ltca.geometry.placement import position_angles

TORQUE_PARTS = (0.01, 0.05, 0.15, 0.35, 0.65, 1.0)
"""Torques of the table by the largest one, either way; at none it is extrapolated."""
POSITIONS = 24
"""Crank angles of a turn, whose mean the table holds."""


@dataclass(frozen=True, slots=True, kw_only=True)
class InputFriction:
    """Friction torque at the input.

    Attributes
    ----------
    torque : array, shape (nodes,)
        On the output, as it turns it ccw positive, ascending, N·mm.
    ccw, cw : array, shape (nodes,)
        Friction at the input that turns so, not negative, mean over a turn, N·mm.
    locked : array of bool, shape (nodes,)
        Where the drive that is driven by this load has no equilibrium.
    ratio : float
        Turns of the input by those of the output.
    """

    torque: FloatArray
    ccw: FloatArray
    cw: FloatArray
    locked: BoolArray
    ratio: float

    @property
    def driven_back(self) -> FloatArray:
        """Friction at the input while the load drives, N·mm, shape (nodes,)."""
        return np.where(self.torque * self.ratio > 0.0, self.ccw, self.cw)

    @property
    def driving(self) -> FloatArray:
        """Friction at the input while it drives against the load, N·mm, shape (nodes,)."""
        return np.where(self.torque * self.ratio > 0.0, self.cw, self.ccw)

    @property
    def efficiency(self) -> FloatArray:
        """Of the input that drives, mean over a turn; 0 without a load, shape (nodes,)."""
        useful = np.abs(self.torque / self.ratio)
        through = np.where(useful + self.driving > 0.0, useful + self.driving, 1.0)
        return np.asarray(useful / through)

    @property
    def efficiency_driven_back(self) -> FloatArray:
        """Of the load that drives; 0 where it does not move the input, shape (nodes,)."""
        given = np.abs(self.torque / self.ratio)
        left = given - self.driven_back
        return np.asarray(np.where((left > 0.0) & ~self.locked, left / np.where(given > 0.0, given, 1.0), 0.0))

    def driving_back_torque(self, way: float) -> float | None:
        """Return the least torque on the output that moves the input without help, its size, N·mm; None where none does.

        Parameters
        ----------
        way : float
            Sense in which it turns the output, ccw positive.
        """
        on_way = self.torque * way >= 0.0
        size, held = np.abs(self.torque[on_way]), self.driven_back[on_way]
        at_none = self.driven_back[self.torque == 0.0]
        if np.all(at_none == 0.0) and np.all(held == 0.0):
            return 0.0
        along = np.argsort(size)
        size, left = size[along], (size / abs(self.ratio) - held)[along]
        for place in range(1, size.size):
            if left[place] > 0.0:
                low, high = left[place - 1], left[place]
                return float(size[place] - (size[place] - size[place - 1]) * high / (high - min(low, 0.0)))
        return None


def input_friction(
    drive: Drive, engine: Engine, largest: float, advance: Callable[[int], None] = lambda _: None
) -> InputFriction:
    """Return the friction at the input up to a torque either way.

    Parameters
    ----------
    drive : Drive
        At its temperatures.
    engine : Engine
        How bodies yield.
    largest : float
        Largest torque, N·mm.
    advance : callable
        Told of solved positions.
    """
    size = largest * np.array(TORQUE_PARTS)
    nodes, ratio = np.concatenate([-size[::-1], [0.0], size]), drive.transmission_ratio
    values = {sense: np.zeros(nodes.size) for sense in (1, -1)}
    locked = np.zeros(nodes.size, dtype=bool)
    if drive.friction is not None:
        for direction in ("ccw", "cw"):
            one = replace(drive, load=replace(drive.load, direction=direction, driven_by="input"))
            way = one.load_sign
            here = np.flatnonzero(nodes * way > 0.0)
            here = here[np.argsort(np.abs(nodes[here]))]
            forward = _lost(one, engine, size, False, advance)
            back = _lost(one, engine, size, True, advance)
            asked = size / abs(ratio)
            holds = np.isnan(back)
            locked[here] = holds
            driving = int(np.sign(one.driving_sign * drive.crank_turns_per_input))
            values[driving][here] = forward
            values[-driving][here] = np.where(holds, asked, back)
        middle = nodes.size // 2
        for table in values.values():
            slope = TORQUE_PARTS[0] / (TORQUE_PARTS[1] - TORQUE_PARTS[0])
            ends = [table[middle + way] - slope * (table[middle + 2 * way] - table[middle + way]) for way in (1, -1)]
            table[middle] = max(drive.friction.no_load_torque, 0.5 * sum(ends))
    return InputFriction(torque=nodes, ccw=values[1], cw=values[-1], locked=locked, ratio=ratio)


def _lost(drive: Drive, engine: Engine, size: FloatArray, back: bool, advance: Callable[[int], None]) -> FloatArray:
    """Mean loss over a turn by radian of the input at torques on the output, N·mm; not a number where nothing balances."""
    model, angle = engine.prepare(drive).model, position_angles(POSITIONS)
    friction = model.friction
    if back and friction is not None:
        model = replace(model, friction=friction.reversed())
    found = np.full(size.shape, np.nan)
    for place, torque in enumerate(size.tolist()):
        try:
            balanced = solve_at_output(model, [drive], angle, torque)
        except ConvergenceError:
            if not back:
                raise
        else:
            cost = losses(model, [drive], balanced, torque)
            found[place] = np.mean(cost.total / np.abs(cost.input_turns))
        advance(angle.size)
    return found
