r"""Forces of single parts in motion, over all walked turns: spectra at some speeds, largest loads at all of them.

The force of a part is the one at rest plus its slope over the coordinates, times what the drive departs by from its quasi-static
motion there,

.. math:: F(\varphi) = F_s(\varphi) + \frac{\partial F}{\partial q}(\varphi)\, T(\varphi)\, Y(\varphi) ,

with the departure Y seen from the crank (`ltca.analysis.forced_vibration`) and its frame T (`Motion.turned`). The product is
taken at every walked position and its orders are fitted as those at rest are (`ltca.analysis.force_orders`), which convolves
both in orders, whole or not. Slopes are those of the contacts that carry at rest: an open contact has none, and one that the
motion would pull is followed into the negative, up to the speed from which contacts part.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from ltca.analysis.force_orders import (
    BEARING_RADIAL,
    BEARING_TANGENTIAL,
    ROLLER,
    SHAFT_PIN,
    WHEEL_PIN,
    ForceFit,
    ForceSpectrum,
    single_forces,
)
from ltca.analysis.vibration import Vibration
from ltca.arrays import ComplexArray, FloatArray, IntArray
from ltca.compliance.response import Start
from ltca.dynamics.stiffness import levers
from ltca.equilibrium.reducer import Reducer
from ltca.geometry.coordinates import WHEEL_ANGLE

STEP = 1e-6
"""Displacement by which forces are differenced, mm: approaches are micrometres."""
TOGETHER = 64
"""Positions at a time: of a large drive forces at all speeds are some tens of megabytes then."""
KINDS = {"wheel pins": WHEEL_PIN, "rollers": ROLLER, "shaft pins": SHAFT_PIN, "crank bearings": BEARING_RADIAL}
"""Contacts that dynamic factors are told of, and the forces behind them; of bearings both components."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ForcesInMotion:
    """What a response does to single parts.

    Attributes
    ----------
    torque_ratio : array, shape (speeds,)
        Largest departure of the moment between wheel and discs by its mean.
    factors : dict of str to array, shape (speeds,)
        Largest load in motion by the largest at rest, by `KINDS`.
    spectra : tuple of ForceSpectrum
        Of every kind, at rest and at the told speeds, the first axis of its parts.
    """

    torque_ratio: FloatArray
    factors: dict[str, FloatArray]
    spectra: tuple[ForceSpectrum, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceSlopes:
    """Forces at some walked positions, and their slopes.

    Attributes
    ----------
    places : array, shape (positions,)
        Which of the walked positions.
    at_rest : dict of str to array, shape (positions, parts)
        By kind, with the axes of `ForceSpectrum`, N.
    slopes : dict of str to array, shape (positions, parts, coordinates)
        N/mm and N.
    wheel : array, shape (positions, coordinates)
        Slope of the moment between wheel and discs, N and N·mm.
    moment : array, shape (positions,)
        That moment, N·mm.
    """

    places: IntArray
    at_rest: dict[str, FloatArray]
    slopes: dict[str, FloatArray]
    wheel: FloatArray
    moment: FloatArray


def force_slopes(found: Vibration, model: Reducer) -> Iterator[ForceSlopes]:
    """Return the forces of all parts over the walked turns with their slopes, some positions at a time.

    Parameters
    ----------
    found : Vibration
        Vibrations of the drive.
    model : Reducer
        That balanced its positions, without friction.
    """
    motion = found.motion
    contacts = replace(model, stage=None, friction=None, external=None)
    steps = STEP / levers(model, motion)
    every = np.arange(found.walked_angle.size)
    for places in np.array_split(every, -(-every.size // TOGETHER)):
        angle, pose = found.walked_angle[places], found.walked_pose[places]
        still = contacts.respond(angle, pose)
        start = Start.after(still)
        at_rest = single_forces(contacts, angle, pose, still)
        slopes = {kind: np.zeros((*values.shape, motion.size)) for kind, values in at_rest.items()}
        wheel = np.zeros((places.size, motion.size))
        # Sun and twist of the carrier move no contact.
        for place in range(motion.crank + 1):
            for sense in (-1.0, 1.0):
                moved, turned, step = pose.copy(), angle, 2.0 * sense * steps[place]
                if place == motion.crank:
                    turned = angle + sense * steps[place]
                else:
                    moved[:, place] += sense * steps[place]
                response = contacts.respond(turned, moved, start)
                wheel[:, place] += response.force[:, WHEEL_ANGLE] / step
                for kind, values in single_forces(contacts, turned, moved, response).items():
                    slopes[kind][..., place] += values / step
        yield ForceSlopes(
            places=places, at_rest=at_rest, slopes=slopes, wheel=wheel, moment=still.force[:, WHEEL_ANGLE]
        )


def departures(found: Vibration, orders: FloatArray, answers: ComplexArray) -> Departures:
    """Return what a drive departs by from its quasi-static motion, as a function of walked positions.

    Parameters
    ----------
    found : Vibration
        Vibrations of the drive.
    orders : array, shape (orders,)
        Whole ones that a turn resolves, then the others.
    answers : array of complex, shape (speeds, 1 + orders, coordinates)
        Mean and amplitudes, seen from the crank.
    """
    each, whole = len(found.stiffness.over_turn), found.stiffness.orders
    waves = np.zeros((len(answers), each // 2 + 1, found.motion.size), dtype=complex)
    waves[:, 0] = answers[:, 0].real
    waves[:, 1 : whole + 1] = 0.5 * answers[:, 1 : whole + 1]
    over_turn = np.fft.irfft(waves, each, axis=1, norm="forward")
    return Departures(found=found, over_turn=over_turn, between=orders[whole:], beside=answers[:, whole + 1 :])


@dataclass(frozen=True, slots=True, kw_only=True)
class Departures:
    """Whole orders over a turn, shape (speeds, positions, coordinates), and those between."""

    found: Vibration
    over_turn: FloatArray
    between: FloatArray
    beside: ComplexArray

    def at(self, places: IntArray) -> FloatArray:
        """Displacements at walked positions at rest, shape (positions, coordinates, speeds)."""
        angle = self.found.walked_angle[places]
        seen = self.over_turn[:, places % self.over_turn.shape[1]].transpose(1, 2, 0)
        waves = np.exp(1j * np.multiply.outer(angle, self.between))
        seen = seen + np.tensordot(waves, self.beside, axes=(1, 1)).real.transpose(0, 2, 1)
        return np.asarray(np.matmul(self.found.motion.turned(angle), seen))


def forces_in_motion(
    found: Vibration, model: Reducer, orders: FloatArray, answers: ComplexArray, told: IntArray
) -> ForcesInMotion:
    """Return what a response does to single parts.

    Parameters
    ----------
    found : Vibration
        Vibrations of the drive.
    model : Reducer
        That balanced its positions, without friction.
    orders : array, shape (orders,)
        Of the response, whole ones that a turn resolves, then the others.
    answers : array of complex, shape (speeds, 1 + orders, coordinates)
        Mean and amplitudes of what the drive departs by, seen from the crank.
    told : array of int, shape (told,)
        Places of the speeds whose spectra are told.
    """
    moved_by, fit = departures(found, orders, answers), ForceFit(found.drive, found.walked_angle)
    largest = {kind: np.zeros(len(answers)) for kind in KINDS}
    still, change, moments = dict.fromkeys(KINDS, 0.0), np.zeros(len(answers)), 0.0
    for here in force_slopes(found, model):
        moved = moved_by.at(here.places)
        change = np.maximum(change, np.abs(np.einsum("pn,pns->ps", here.wheel, moved)).max(axis=0))
        moments += float(np.sum(here.moment))
        at_told = np.concatenate((np.zeros((*moved.shape[:2], 1)), moved[:, :, told]), axis=2)
        fit.add(found.walked_angle[here.places], {kind: _in_motion(here, kind, at_told) for kind in here.at_rest})
        for kind, force in KINDS.items():
            if force not in here.at_rest:
                continue
            # A contact that is open has no slope; one that the linear motion would pull has no load.
            resting, sizes = here.at_rest[force], np.maximum(_in_motion(here, force, moved), 0.0)
            if force == BEARING_RADIAL:
                resting = np.hypot(resting, here.at_rest[BEARING_TANGENTIAL])
                sizes = np.hypot(_in_motion(here, force, moved), _in_motion(here, BEARING_TANGENTIAL, moved))
            still[kind] = max(still[kind], float(resting.max()))
            largest[kind] = np.maximum(largest[kind], np.moveaxis(sizes, 1, 0).reshape(len(answers), -1).max(axis=1))
    mean = moments / found.walked_angle.size
    return ForcesInMotion(
        torque_ratio=np.asarray(change / abs(mean)),
        factors={kind: largest[kind] / size for kind, size in still.items() if size},
        spectra=fit.solve(),
    )


def _in_motion(here: ForceSlopes, kind: str, moved: FloatArray) -> FloatArray:
    """Forces of all parts of a kind, shape (positions, speeds, parts)."""
    at_rest, slope = here.at_rest[kind], here.slopes[kind]
    count, speeds = len(at_rest), moved.shape[2]
    whole = np.matmul(moved.swapaxes(1, 2), slope.reshape(count, -1, slope.shape[-1]).swapaxes(1, 2))
    return np.asarray(at_rest[:, None] + whole.reshape(count, speeds, *at_rest.shape[1:]))
