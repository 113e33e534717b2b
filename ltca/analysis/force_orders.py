"""Spectra of single forces: every part of each kind followed over the walked turns, by the orders of its own passage.

A part meets its load again and again: a wheel pin with the order p = z_C/z_P by turn of the crank against the pin shaft, a
roller with that of the crank against its cage, 1 − c, shaft pins and bearings of cranks and wheel once a turn. What passes
elsewhere with an order b (lobes, holes, rollers, the crank itself), at rest or by a vibration, is seen through that passage, as
b ± m p. The multiples of p and these sums are fitted together, as far as the positions resolve them and the turns tell them
apart (one divided by the number of turns is the least distance); what they leave is told as the rest.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ltca.analysis.transmission_error_orders import LEAST_SINGULAR_RATIO, OrderFit
from ltca.arrays import ComplexArray, FloatArray, place_of_largest
from ltca.compliance.response import Response
from ltca.drive.parts import Drive
from ltca.drive.single_discs import single_discs
from ltca.equilibrium.reducer import Reducer, bearing_forces
from ltca.geometry.placement import Placement

WHEEL_PIN, ROLLER, SHAFT_PIN = "wheel pin", "roller", "shaft pin"
BEARING_RADIAL, BEARING_TANGENTIAL = "crank bearing, radial", "crank bearing, tangential"
MAIN_BEARING_X, MAIN_BEARING_Y = "main bearing, x", "main bearing, y"
PARTS = {
    WHEEL_PIN: "wheel pin {1} on disc {0}",
    ROLLER: "roller {2} of crank {1} in disc {0}",
    SHAFT_PIN: "shaft pin {1} in disc {0}",
    BEARING_RADIAL: "bearing of crank {1} on disc {0}, radial",
    BEARING_TANGENTIAL: "bearing of crank {1} on disc {0}, tangential",
    MAIN_BEARING_X: MAIN_BEARING_X,
    MAIN_BEARING_Y: MAIN_BEARING_Y,
}
"""How a part of each kind is named, by its numbers."""
RESOLVED = 0.9
"""Highest order that is fitted, by half the positions of a turn."""
SIDES = 16
"""Multiples of the passage about the order of what passes elsewhere."""
SAME_DISTANCE = 1e-9
"""By which orders may be nearer than the turns tell apart, for round-off."""
TOLD = 16
"""Orders of a part, the largest, that dynamics.json has; the dataset has all."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceSpectrum:
    """Spectra of the forces of all parts of one kind.

    Attributes
    ----------
    kind : str
        A key of `PARTS`.
    passage : float
        Order of its passage by turn of the crank against the pin shaft.
    mean : array, shape (…, parts)
        N; parts are numbered by disc, by crank, by pin, hole or roller, each with an axis of its own, and several speeds have
        one in front.
    orders : array, shape (orders,)
        Ascending, by turn of the crank against the pin shaft.
    amplitude : array of complex, shape (orders, …, parts)
        a of Re a·exp(i·order·φ_C), N.
    rest : array, shape (…, parts)
        Root mean square of what they leave, N.
    """

    kind: str
    passage: float
    mean: FloatArray
    orders: FloatArray
    amplitude: ComplexArray
    rest: FloatArray

    def name(self, numbers: tuple[int, ...]) -> str:
        """Return the name of a part."""
        return PARTS[self.kind].format(*numbers)

    def at(self, speed: int) -> ForceSpectrum:
        """Return the spectra at one of several speeds."""
        return ForceSpectrum(
            kind=self.kind,
            passage=self.passage,
            orders=self.orders,
            mean=np.asarray(self.mean[speed]),
            amplitude=self.amplitude[:, speed],
            rest=np.asarray(self.rest[speed]),
        )

    def largest(self) -> tuple[FloatArray, tuple[tuple[int, ...], ...]]:
        """Return the largest amplitude of each order among all parts, N, shape (orders,), and the numbers of the parts."""
        sizes = np.abs(self.amplitude)
        return sizes.reshape(len(sizes), -1).max(axis=1), tuple(map(place_of_largest, sizes))

    @property
    def strongest(self) -> tuple[int, ...]:
        """Numbers of the part whose orders together are the largest, by root mean square."""
        return place_of_largest(np.sum(np.abs(self.amplitude) ** 2, axis=0))


def single_forces(
    model: Reducer, crank_angle: FloatArray, pose: FloatArray, response: Response
) -> dict[str, FloatArray]:
    """Return the forces of all parts that the drive has, by kind, N, each of shape (positions, parts) with the axes of
    `ForceSpectrum`.

    Parameters
    ----------
    model : Reducer
        The drive.
    crank_angle : array, shape (positions,)
        φ_C, rad.
    pose : array, shape (positions, coordinates)
        Where it stands.
    response : Response
        What its contacts answer there.
    """
    discs, count = len(model.discs), crank_angle.size
    bearing = bearing_forces(model, crank_angle, response)
    forces = {
        WHEEL_PIN: response.pin_load.reshape(count, discs, -1),
        ROLLER: response.rollers.outer_load.reshape(count, discs, bearing.shape[2], -1),
        SHAFT_PIN: response.hole_load.reshape(count, discs, -1),
        BEARING_RADIAL: bearing.real,
        BEARING_TANGENTIAL: bearing.imag,
    }
    if model.supports is not None and model.coordinates.wheel:
        held = model.supports.respond(pose)[0][:, model.coordinates.wheel_place]
        forces[MAIN_BEARING_X], forces[MAIN_BEARING_Y] = held.T
    return {kind: np.asarray(values, dtype=float) for kind, values in forces.items() if values.size}


class ForceFit:
    """Spectra of forces that come a part of the positions at a time.

    Parameters
    ----------
    drive : Drive
        Whose forces they are.
    crank_angle : array, shape (positions,)
        φ_C of all turns, evenly spaced, rad.
    """

    def __init__(self, drive: Drive, crank_angle: FloatArray) -> None:
        self._angle = crank_angle
        cage = 1.0 - float(Placement.of_drive(single_discs(drive)[0]).cage_speed)
        lobes, holes = drive.disc.number_of_teeth, drive.number_of_holes
        rollers = cage * drive.crank_bearing.number_of_rollers
        self._passages = {WHEEL_PIN: lobes / drive.pin_wheel.number_of_pins, ROLLER: cage}
        self._elsewhere = (float(holes), rollers, float(lobes), 1.0, 2.0 * holes, 2.0 * rollers)
        self._fits: dict[str, OrderFit] = {}

    def add(self, crank_angle: FloatArray, forces: dict[str, FloatArray]) -> None:
        """Add forces by kind at some of the crank angles, shape (positions, …)."""
        for kind, values in forces.items():
            if kind not in self._fits:
                self._fits[kind] = OrderFit(self._told_apart(self._passage(kind)))
            self._fits[kind].add(crank_angle, values)

    def solve(self) -> tuple[ForceSpectrum, ...]:
        """Return the spectra of all kinds."""
        found = []
        for kind, fit in self._fits.items():
            mean, amplitude, rest = fit.solve()
            found.append(
                ForceSpectrum(
                    kind=kind,
                    passage=self._passage(kind),
                    orders=fit.orders,
                    mean=np.asarray(mean),
                    amplitude=amplitude,
                    rest=np.asarray(rest),
                )
            )
        return tuple(found)

    def _passage(self, kind: str) -> float:
        return self._passages.get(kind, 1.0)

    def _told_apart(self, passage: float) -> FloatArray:
        """Orders of a part with a passage that the positions resolve and tell apart, ascending."""
        step = float(self._angle[1] - self._angle[0])
        highest, apart = RESOLVED * np.pi / step, 2.0 * np.pi / (step * self._angle.size)
        own = passage * np.arange(1.0, max(int(highest / passage), 1) + 1.0)
        found = own
        for base in self._elsewhere:
            sides = np.abs(base + passage * np.arange(-SIDES, SIDES + 1.0))
            for order in sides[(sides >= apart) & (sides <= highest)]:
                if np.min(np.abs(found - order)) >= apart * (1.0 - SAME_DISTANCE):
                    found = np.append(found, order)
        orders, count = np.asarray(found), found.size
        while count > 1:
            fit = OrderFit(orders[:count])
            fit.add(self._angle, np.zeros(self._angle.size))
            if fit.singular_ratio >= LEAST_SINGULAR_RATIO:
                break
            count = min(own.size, count - 1) if count > own.size else count // 2
        return np.sort(orders[:count])


def force_content(found: tuple[ForceSpectrum, ...]) -> list[dict[str, Any]]:
    """Return spectra of forces at one speed, or at rest, as files hold them: of each kind the part whose orders together are the
    largest, and the largest amplitude of each order among all parts.

    Parameters
    ----------
    found : tuple of ForceSpectrum
        The spectra.
    """
    content = []
    for one in found:
        part, (sizes, parts) = one.strongest, one.largest()
        told = np.sort(np.argsort(-sizes, kind="stable")[:TOLD])
        content.append(
            {
                "kind": one.kind,
                "force": one.name(part),
                "mean_N": float(one.mean[part]),
                "order_of_passage": one.passage,
                "orders": one.orders[told].tolist(),
                "amplitude_N": np.abs(one.amplitude[(told, *part)]).tolist(),
                "rest_rms_N": float(one.rest[part]),
                "largest_amplitude_N": sizes[told].tolist(),
                "largest_of": [one.name(parts[place]) for place in told],
            }
        )
    return content
