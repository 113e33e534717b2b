"""Spectra of single forces at rest: one part of each kind followed over the walked turns, by the orders of its own passage.

A part meets its load again and again: a wheel pin with the order z_C/z_P by turn of the crank against the pin shaft, a roller
with that of the crank against its cage, 1 − c, shaft pins and bearings of cranks and wheel once a turn. Multiples of that
order are fitted together; what they leave (other parts that pass, errors) is told as the rest.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ltca.analysis.transmission_error_orders import LEAST_SINGULAR_RATIO, OrderFit
from ltca.arrays import FloatArray
from ltca.drive.parts import Drive
from ltca.drive.single_discs import single_discs
from ltca.equilibrium.balance import Equilibrium
from ltca.equilibrium.reducer import Reducer, bearing_forces
from ltca.geometry.placement import Placement

MULTIPLES = 16
"""Multiples of the passage order that are told; fewer where the positions or turns do not tell them apart."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceOrders:
    """Spectrum of one force at the load.

    Attributes
    ----------
    name : str
        Whose force it is.
    passage : float
        Order of its passage by turn of the crank against the pin shaft.
    mean : float
        N.
    amplitude : array, shape (multiples,)
        Of the multiples 1, 2, … of the passage, N.
    rest : float
        Root mean square of what they leave, N.
    """

    name: str
    passage: float
    mean: float
    amplitude: FloatArray
    rest: float


def single_forces(model: Reducer, found: Equilibrium) -> dict[str, FloatArray]:
    """Return a force of each kind that the drive has at balanced positions, by name, N, each of shape (positions,).

    Parameters
    ----------
    model : Reducer
        The drive.
    found : Equilibrium
        Its balanced positions, of one drive.
    """
    response, angle = found.response, found.crank_angle
    forces = {"wheel pin 0 on disc 0": response.pin_load[:, 0]}
    rollers, holes = response.rollers.outer_load, response.hole_load
    if rollers.size:
        forces["roller 0 of crank 0 in disc 0"] = rollers[:, 0]
    if holes.size:
        forces["shaft pin 0 in disc 0"] = holes[:, 0]
    bearing = bearing_forces(model, angle, response)[:, 0, 0]
    forces["crank bearing 0 on disc 0, radial"] = bearing.real
    forces["crank bearing 0 on disc 0, tangential"] = bearing.imag
    if model.supports is not None and model.coordinates.wheel:
        held = model.supports.respond(found.pose)[0][:, model.coordinates.wheel_place]
        forces["main bearing, x"], forces["main bearing, y"] = held.T
    return {name: np.asarray(values, dtype=float) for name, values in forces.items()}


def force_orders(drive: Drive, crank_angle: FloatArray, forces: dict[str, FloatArray]) -> tuple[ForceOrders, ...]:
    """Return the spectra of forces over turns of the crank.

    Parameters
    ----------
    drive : Drive
        Whose forces they are.
    crank_angle : array, shape (positions,)
        φ_C over the turns, evenly spaced, rad.
    forces : dict of str to array, shape (positions,)
        As `single_forces` names them, N.
    """
    pin = drive.disc.number_of_teeth / drive.pin_wheel.number_of_pins
    cage = 1.0 - float(Placement.of_drive(single_discs(drive)[0]).cage_speed)
    passages = {"wheel pin": pin, "roller": cage}
    resolved = np.pi / float(crank_angle[1] - crank_angle[0])
    found = []
    for name, values in forces.items():
        passage = next((order for kind, order in passages.items() if name.startswith(kind)), 1.0)
        for count in range(min(MULTIPLES, int(0.9 * resolved / passage)), 0, -1):
            fit = OrderFit(passage * np.arange(1, count + 1))
            fit.add(crank_angle, values)
            if fit.singular_ratio >= LEAST_SINGULAR_RATIO:
                mean, amplitude, rest = fit.solve()
                found.append(
                    ForceOrders(
                        name=name, passage=passage, mean=float(mean), amplitude=np.abs(amplitude), rest=float(rest)
                    )
                )
                break
    return tuple(found)


def force_content(found: tuple[ForceOrders, ...]) -> list[dict[str, Any]]:
    """Return spectra of forces as files hold them.

    Parameters
    ----------
    found : tuple of ForceOrders
        The spectra.
    """
    return [
        {
            "force": one.name,
            "mean_N": one.mean,
            "orders": [one.passage * multiple for multiple in range(1, one.amplitude.size + 1)],
            "amplitude_N": one.amplitude.tolist(),
            "rest_rms_N": one.rest,
        }
        for one in found
    ]
