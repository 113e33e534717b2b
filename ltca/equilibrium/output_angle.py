"""The angle of the wheel with the input held, and its free play: what stands before the cranks added to the cycloid stage.

The cranks are where the analysis holds them. Between them and the input lies the first stage; by what its teeth yield and are
free to turn, the cranks turn while the input is held, and the wheel by 1/u of it. Whatever else lies between input and output
and yields or has play joins here, and every transmission error, wind-up, lost motion and backlash has it.
"""

from __future__ import annotations

import numpy as np

from ltca.arrays import FloatArray
from ltca.equilibrium.balance import Equilibrium
from ltca.equilibrium.reducer import Reducer
from ltca.geometry.coordinates import WHEEL_ANGLE


def crank_lag(model: Reducer, found: Equilibrium) -> FloatArray:
    """Return the angle of the cranks less the one that the held input gives them, rad, shape (positions,)."""
    if model.stage is None:
        return np.zeros(found.crank_angle.shape)
    moments = model.crank_moments(found.crank_angle, found.pose, found.response.parts)
    displaced = None
    if model.stage.yields:
        carried, given = model.stage.beside_discs(model.stage.on_planets(moments)[0]), None
        if model.supports is not None:
            given = model.supports.given(found.pose, carried)
        displaced = model.stage.displaced(moments, found.pose, given)
    return model.stage.crank_lag(moments, displaced)


def wheel_angle_of_input(model: Reducer, found: Equilibrium) -> FloatArray:
    """Return the deviation of the wheel from its ideal angle by the held input, ccw positive, rad, shape (positions,)."""
    wheel = found.pose[:, WHEEL_ANGLE]
    return wheel if model.stage is None else wheel + crank_lag(model, found) / model.stage.reduction_ratio


def play_of_input(model: Reducer, play: FloatArray) -> FloatArray:
    """Return the free play of the wheel with the input held from that with the cranks held, rad, any shape for one drive.

    Of a batch of drives the positions are the first axis.
    """
    return play if model.stage is None else play + np.squeeze(model.stage.play)
