"""The quantities of many drives at once; a sample that cannot be solved says why and stops nobody else."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ltca.analysis.half_width_guard import check_half_widths
from ltca.compliance.half_space import HalfSpaceCompliance, batch_signature
from ltca.compliance.response import ComplianceModel
from ltca.drive.parts import Drive
from ltca.equilibrium.balance import solve_equilibrium
from ltca.errors import CycloError
from ltca.geometry.first_contact import backlash
from ltca.geometry.pairs import WHEEL_ANGLE
from ltca.studies.quantities import QUANTITIES, SampleBatch

FloatArray = NDArray[np.float64]
ModelBuilder = Callable[[Sequence[Drive], int], ComplianceModel]


@dataclass(frozen=True, slots=True, kw_only=True)
class Nominal:
    """Solution of the drive the samples scatter about: where they start from.

    Attributes
    ----------
    full, light : array, shape (positions, 4)
        Poses at its torque and its light torque.
    """

    full: FloatArray
    light: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class BatchSettings:
    """How samples are analysed.

    Attributes
    ----------
    crank_angle : array, shape (positions,)
        φ_C of every sample, rad.
    quantities : tuple of str
        Names of `ltca.studies.quantities`.
    build : callable
        Compliance model of several drives at a number of positions each.
    nominal : Nominal or None
        Starting poses; by default every sample starts from first contact.
    together : bool
        Whether the model takes different drives in one batch; otherwise it is built for one drive at a time.
    """

    crank_angle: FloatArray
    quantities: tuple[str, ...]
    build: ModelBuilder = HalfSpaceCompliance.of_drives
    nominal: Nominal | None = None
    together: bool = True


@dataclass(frozen=True, slots=True, kw_only=True)
class SampleResults:
    """Quantities of samples.

    Attributes
    ----------
    values : array, shape (samples, quantities)
        Units of `ltca.studies.quantities`; not a number where the sample failed.
    messages : tuple of str
        Why each sample failed, empty where it did not.
    """

    values: FloatArray
    messages: tuple[str, ...]


def solve_nominal(drive: Drive, settings: BatchSettings) -> Nominal:
    """Return the solution of one drive at the angles of the settings.

    Raises
    ------
    ConvergenceError
        When it does not balance.
    """
    angle = settings.crank_angle
    model = settings.build([drive], angle.size)
    full = solve_equilibrium(model, angle, drive.wheel_moment()).pose
    light = full
    if any(QUANTITIES[name].stage == "light" for name in settings.quantities):
        light = solve_equilibrium(model, angle, drive.wheel_moment(drive.load.light_torque), full).pose
    return Nominal(full=full, light=light)


def analyse_samples(drives: Sequence[Drive], settings: BatchSettings) -> SampleResults:
    """Return the quantities of every drive.

    Drives that agree in their `ltca.compliance.half_space.batch_signature` are solved together. What fails is halved until
    the sample is found, which is tried once more from first contact before it counts as failed.

    Parameters
    ----------
    drives : sequence of Drive
        One for each sample.
    settings : BatchSettings
        Angles, quantities, model.
    """
    values = np.full((len(drives), len(settings.quantities)), np.nan)
    messages = [""] * len(drives)
    groups: dict[tuple[object, ...], list[int]] = {}
    for number, drive in enumerate(drives):
        key = batch_signature(drive) if settings.together else (number,)
        groups.setdefault(key, []).append(number)
    for members in groups.values():
        _solve_group(drives, members, settings, values, messages)
    return SampleResults(values=values, messages=tuple(messages))


def _solve_group(
    drives: Sequence[Drive], members: list[int], settings: BatchSettings, values: FloatArray, messages: list[str]
) -> None:
    try:
        values[members] = _quantities([drives[number] for number in members], settings, settings.nominal)
    except CycloError as error:
        if len(members) > 1:
            half = len(members) // 2
            _solve_group(drives, members[:half], settings, values, messages)
            _solve_group(drives, members[half:], settings, values, messages)
            return
        if settings.nominal is not None:
            try:
                values[members] = _quantities([drives[members[0]]], settings, None)
            except CycloError as second:
                messages[members[0]] = str(second)
        else:
            messages[members[0]] = str(error)


def _quantities(drives: list[Drive], settings: BatchSettings, nominal: Nominal | None) -> FloatArray:
    batch = solve_batch(drives, settings, nominal)
    return np.stack([QUANTITIES[name].evaluate(batch) for name in settings.quantities], axis=1)


def solve_batch(drives: Sequence[Drive], settings: BatchSettings, nominal: Nominal | None = None) -> SampleBatch:
    """Solve several drives at all angles as one batch.

    Parameters
    ----------
    drives : sequence of Drive
        Drives of one `ltca.compliance.half_space.batch_signature`.
    settings : BatchSettings
        Angles, quantities, model.
    nominal : Nominal, optional
        Starting poses.

    Raises
    ------
    ConvergenceError
        When a position of any of them does not balance.
    DriveError
        When a torque cannot be carried (`ltca.analysis.half_width_guard`).
    """
    samples, positions = len(drives), settings.crank_angle.size
    stages = {QUANTITIES[name].stage for name in settings.quantities}
    model = settings.build(drives, positions)
    angle = np.tile(settings.crank_angle, samples)

    def moments(torques: list[float]) -> FloatArray:
        return np.repeat(torques, positions)

    start = None if nominal is None else np.tile(nominal.full, (samples, 1))
    full = solve_equilibrium(model, angle, moments([drive.wheel_moment() for drive in drives]), start)
    pressures = model.pressures(full.response)
    check_half_widths(drives[0], full.response, pressures)
    light, play = None, None
    if "light" in stages:
        moment = moments([drive.wheel_moment(drive.load.light_torque) for drive in drives])
        start = full.pose if nominal is None else np.tile(nominal.light, (samples, 1))
        light = solve_equilibrium(model, angle, moment, start)
    if "backlash" in stages:
        play = backlash(model.geometry, angle, WHEEL_ANGLE)
    return SampleBatch(samples=samples, full=full, pressures=pressures, light=light, backlash=play)
