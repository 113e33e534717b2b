"""Torque of a cycloidal drive by the angles of its input and output: wind-up with play, transmission error, hysteresis, friction.

This file needs numpy alone and is written beside the tables of an exported drive (``cyclo export DRIVE --for json``):

>>> drive = ReducedDrive.load("robot-joint_nominal.json")        # doctest: +SKIP
>>> on_input, on_output = drive.step(input_angle, output_angle)  # doctest: +SKIP

Angles are rad, torques N·m, ccw positive, those of input and output against the held member. The law, with the ratio i of the
turns of the input by those of the output:

- wind-up x = output angle − input angle/i; at the nodes T_j of the table x_j(φ) = mean + Σ cos·cos(order φ) + sin·sin(order φ)
  with the crank angle φ; the elastic torque f is linear between the nodes, and beyond them;
- Maxwell-slip elements, each on one flank s = ±1 with the load q = max(s·f, 0): z moves by g·w·stiffness·Δq and stays within
  ± g·w·strength·T_r·(q/T_r)^exponent with the rated torque T_r, the factor g of the crank angle, 1 + Σ cos·cos(order φ) +
  sin·sin(order φ), one for either flank, and the weight w of each element, 1 + amplitude·cos(order φ − phase);
- the drive holds the output with T = f + Σs·z and turns the input with T/i;
- friction at the input is a bristle: it moves by Δ(input angle) and stays within the friction of the table at f and the sense.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class ReducedDrive:
    """A reduced drive with its state: the elements of the hysteresis and the bristle of the friction.

    Parameters
    ----------
    tables : dict
        Content of the exported JSON file.
    """

    def __init__(self, tables: dict[str, Any]) -> None:
        def column(table: str, key: str) -> Array:
            return np.asarray(tables[table][key], dtype=np.float64)

        wind_up = tables["wind_up"]
        self.ratio = float(tables["transmission_ratio"])
        self.cranks = float(tables["crank_turns_per_input_turn"])
        self.rated_torque = float(tables["limits"]["rated_torque_N_m"])
        self.torque = column("wind_up", "torque_N_m")
        self.mean = column("wind_up", "mean_rad")
        self.order = np.array([entry["order"] for entry in wind_up["orders"]], dtype=np.float64)
        shape = (self.order.size, self.torque.size)
        self.cosine = np.array([entry["cos_rad"] for entry in wind_up["orders"]], dtype=np.float64).reshape(shape)
        self.sine = np.array([entry["sin_rad"] for entry in wind_up["orders"]], dtype=np.float64).reshape(shape)
        self.flank = column("hysteresis", "flank")
        self.exponent = column("hysteresis", "exponent")
        self.strength = column("hysteresis", "strength")
        self.stiffness = column("hysteresis", "stiffness")
        self.weight_order = column("hysteresis", "weight_order")
        self.weight_amplitude = column("hysteresis", "weight_amplitude")
        self.weight_phase = column("hysteresis", "weight_phase_rad")
        around = tables["hysteresis"]["factor_orders"]
        self.factor_order = np.array([entry["order"] for entry in around], dtype=np.float64)
        self.factor = np.array([[[one[f"cos_{way}"], one[f"sin_{way}"]] for one in around] for way in ("ccw", "cw")])
        self.factor = self.factor.reshape(2, -1, 2)
        self.friction_torque = column("friction", "torque_N_m")
        self.friction = {
            1: column("friction", "at_input_turning_ccw_N_m"),
            -1: column("friction", "at_input_turning_cw_N_m"),
        }
        self.bristle_angle = float(tables["friction"]["bristle_angle_rad"])
        self.reset()

    @classmethod
    def load(cls, path: str | Path) -> ReducedDrive:
        """Read the exported JSON file.

        Parameters
        ----------
        path : str or Path
            Of the file.
        """
        return cls(json.loads(Path(path).read_text(encoding="utf-8")))

    @property
    def held(self) -> float:
        """Torque with which the output is held in the state, N·m."""
        return self.elastic + float(self.flank @ self.elements)

    def reset(self) -> None:
        """Forget the past: no element carries anything."""
        self.elastic = 0.0
        self.elements = np.zeros(self.strength.size)
        self.bristle = 0.0
        self.input_angle: float | None = None

    def wind_up_nodes(self, input_angle: float) -> Array:
        """Return the wind-up at the torques of the table, rad, ascending.

        Parameters
        ----------
        input_angle : float
            rad.
        """
        phase = self.order * (self.cranks * input_angle)
        nodes = self.mean + np.cos(phase) @ self.cosine + np.sin(phase) @ self.sine
        return np.asarray(np.maximum.accumulate(nodes))

    def elastic_torque(self, input_angle: float, output_angle: float) -> float:
        """Return the torque without hysteresis, N·m, positive where the output is turned ccw against the input.

        Parameters
        ----------
        input_angle, output_angle : float
            rad.
        """
        nodes, torque = self.wind_up_nodes(input_angle), self.torque
        wound = output_angle - input_angle / self.ratio
        first = int(np.clip(np.searchsorted(nodes, wound) - 1, 0, nodes.size - 2))
        width = nodes[first + 1] - nodes[first]
        if width <= 0.0:
            return float(torque[first])
        part = (wound - nodes[first]) / width
        return float(torque[first] + part * (torque[first + 1] - torque[first]))

    def strength_factors(self, input_angle: float) -> tuple[float, float]:
        """Return the factor of strengths on the flanks of positive and negative torque, 1 in the mean, not negative.

        Parameters
        ----------
        input_angle : float
            rad.
        """
        phase = self.factor_order * (self.cranks * input_angle)
        ccw, cw = (self.factor[:, :, 0] @ np.cos(phase) + self.factor[:, :, 1] @ np.sin(phase)).tolist()
        return max(0.0, 1.0 + ccw), max(0.0, 1.0 + cw)

    def slipped(self, input_angle: float, elastic: float) -> Array:
        """Return the elements after the elastic torque has come to a value, N·m; the state stays.

        Parameters
        ----------
        input_angle : float
            rad.
        elastic : float
            N·m.
        """
        rated, phase = self.rated_torque, self.weight_order * (self.cranks * input_angle) - self.weight_phase
        ccw, cw = self.strength_factors(input_angle)
        factor = np.where(self.flank > 0.0, ccw, cw) * (1.0 + self.weight_amplitude * np.cos(phase))
        load, before = (np.maximum(self.flank * torque, 0.0) for torque in (elastic, self.elastic))
        most = factor * self.strength * rated * (load / rated) ** self.exponent
        return np.asarray(np.clip(self.elements + factor * self.stiffness * (load - before), -most, most))

    def torque_of(self, input_angle: float, output_angle: float) -> float:
        """Return the torque with which the output is held, N·m; the state stays.

        Parameters
        ----------
        input_angle, output_angle : float
            rad.
        """
        elastic = self.elastic_torque(input_angle, output_angle)
        return elastic + float(self.flank @ self.slipped(input_angle, elastic))

    def friction_at(self, elastic: float, sense: float) -> float:
        """Return the friction at the input, N·m, not negative.

        Parameters
        ----------
        elastic : float
            Torque on the output, N·m.
        sense : float
            Of the turning input, ccw positive.
        """
        table = self.friction[1 if sense > 0.0 else -1]
        return float(np.interp(elastic, self.friction_torque, table))

    def move(self, input_angle: float, output_angle: float) -> float:
        """Take angles that follow those before, without the friction of the input; return the torque on the output, N·m.

        Parameters
        ----------
        input_angle, output_angle : float
            rad.
        """
        elastic = self.elastic_torque(input_angle, output_angle)
        self.elements, self.elastic = self.slipped(input_angle, elastic), elastic
        return self.held

    def step(self, input_angle: float, output_angle: float) -> tuple[float, float]:
        """Take angles that follow those before; return the torques of the drive on input and output, N·m.

        Parameters
        ----------
        input_angle, output_angle : float
            rad.
        """
        torque = self.move(input_angle, output_angle)
        turned = 0.0 if self.input_angle is None else input_angle - self.input_angle
        self.input_angle = input_angle
        backward, forward = self.friction_at(self.elastic, -1.0), self.friction_at(self.elastic, 1.0)
        stretched = self.bristle + max(backward, forward) * turned / self.bristle_angle
        self.bristle = min(max(stretched, -backward), forward)
        return torque / self.ratio - self.bristle, -torque
