"""Quantities of many drives in one batch; a sample that fails is reported and leaves the others unaffected."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from ltca.analysis.engines import Engine, HalfSpace, PreparedEngine
from ltca.analysis.half_width_guard import check_half_widths
from ltca.analysis.loaded_analysis import require_preload
from ltca.arrays import BoolArray, FloatArray, batch_layout, stack_drives, take_positions
from ltca.compliance.response import Start
from ltca.drive.members.temperatures import warm_drive
from ltca.drive.parts import Drive
from ltca.drive.single_discs import single_discs
from ltca.drive.unit_mistakes import explain_failure, impossible_torque
from ltca.equilibrium.balance import Equilibrium
from ltca.equilibrium.output_angle import play_before_cranks
from ltca.equilibrium.output_torque import solve_at_output
from ltca.equilibrium.reducer import Reducer
from ltca.errors import CycloError, DriveError
from ltca.geometry.coordinates import WHEEL_ANGLE
from ltca.geometry.first_contact import backlash
from ltca.geometry.pairs import ContactGeometry
from ltca.geometry.play import free_play
from ltca.studies.bound_samples import samples_that_bind
from ltca.studies.quantities import STAGES, SampleBatch, evaluate, require_quantities
from ltca.studies.shapes import with_kept_coefficients


@dataclass(frozen=True, slots=True, kw_only=True)
class Nominal:
    """Solution of the drive without deviations: starting estimate of samples that scatter about it.

    Attributes
    ----------
    full, light : Equilibrium
        At its torque and at its light torque.
    model : Reducer
        What answered.
    """

    full: Equilibrium
    light: Equilibrium
    model: Reducer

    def suits(self, model: Reducer) -> bool:
        """Tell whether a model has the same coordinates and as many parts: otherwise its samples start from first contact."""
        return _shape(self.model) == _shape(model)


def _shape(model: Reducer) -> Hashable:
    """What poses and inner unknowns of a model are of."""
    places = [geometry.placement for geometry in model.geometries]
    counts = [
        (each.wheel_pin_radii.shape[-1], each.hole_radii.shape[-1], each.roller_radii.shape[-1]) for each in places
    ]
    return model.coordinates, tuple(counts)


@dataclass(frozen=True, slots=True, kw_only=True)
class BatchSettings:
    """How samples are analysed.

    Attributes
    ----------
    crank_angle : array, shape (positions,)
        φ_C of every sample, rad.
    quantities : tuple of str
        Names of `ltca.studies.quantities`.
    engine : Engine
        How bodies yield; one that takes no batches is asked for one drive at a time.
    nominal : Nominal or None
        Starting poses of the samples that it suits; by default every sample starts from first contact.
    counts_binding : bool
        Whether it is told which samples bind.

    Raises
    ------
    DriveError
        When the engine does not run on tables.
    """

    crank_angle: FloatArray
    quantities: tuple[str, ...]
    engine: Engine = field(default_factory=HalfSpace)
    nominal: Nominal | None = None
    counts_binding: bool = False

    def __post_init__(self) -> None:
        """Refuse methods other than tables."""
        method = self.engine.options["method"]
        if method != "tables":
            raise DriveError(
                [f"method = {method}: studies balance samples on tables only; 'cyclo run' takes one drive"]
            )


@dataclass(frozen=True, slots=True, kw_only=True)
class SampleResults:
    """Quantities of samples.

    Attributes
    ----------
    values : array, shape (samples, quantities)
        Units of `ltca.studies.quantities`; not a number where the sample failed.
    messages : tuple of str
        Why each sample failed, empty where it did not.
    binds : array of bool, shape (samples,)
        Which bind (`ltca.studies.bound_samples`); none where it was not asked for, or the sample failed.
    """

    values: FloatArray
    messages: tuple[str, ...]
    binds: BoolArray


def solve_nominal(drive: Drive, settings: BatchSettings) -> Nominal:
    """Return the solution of one drive at the angles of the settings; `ConvergenceError` where it does not balance."""
    solved = _Batch([drive], settings)
    full = solved.balance([drive.load.torque], None)
    light = full
    if any(STAGES[name] == "light" for name in settings.quantities):
        light = solved.balance([drive.load.light_torque], full)
    return Nominal(full=full, light=light, model=solved.model)


class _Batch:
    """Several drives at all angles on one engine, drive by drive; `models` are theirs where they are known."""

    def __init__(
        self, drives: Sequence[Drive], settings: BatchSettings, models: Sequence[Reducer] | None = None
    ) -> None:
        self.drives, self.positions = [warm_drive(drive) for drive in drives], settings.crank_angle.size
        self.angle = np.tile(settings.crank_angle, len(drives))
        self.prepared: PreparedEngine | None = None
        if settings.engine.batches:
            each = models or [settings.engine.model(drive, in_batch=True) for drive in self.drives]
            self.model = stack_drives(each, self.positions)
        else:
            (drive,) = drives
            self.prepared = with_kept_coefficients(settings.engine, drive).prepare(drive)
            self.model = self.prepared.model

    def balance(self, torques: list[float], near: Equilibrium | None) -> Equilibrium:
        """Balance the drives at their torques, starting from the solution `near`, if given, of the same rows or of one drive."""
        if self.prepared is not None:
            return self.prepared.balance(self.angle, torques[0], None if near is None else near.pose)
        loads = np.repeat(torques, self.positions)
        if near is None:
            return solve_at_output(self.model, self.drives, self.angle, loads)
        rows = np.arange(self.angle.size) % near.crank_angle.size
        inner = take_positions(Start.onward(near.response), rows)
        return solve_at_output(self.model, self.drives, self.angle, loads, near.pose[rows], inner)


def analyse_samples(drives: Sequence[Drive], settings: BatchSettings) -> SampleResults:
    """Return the quantities of every drive.

    Drives whose models agree in their `ltca.arrays.batch_layout` are solved together. What fails is halved until the sample
    is found, which is tried once more from first contact before it counts as failed.

    Parameters
    ----------
    drives : sequence of Drive
        One for each sample.
    settings : BatchSettings
        Angles, quantities, engine.
    """
    kept = len(settings.quantities)
    values = np.full((len(drives), kept + 1), np.nan)  # the last column: 1 where the sample binds
    messages = [""] * len(drives)
    groups: dict[Hashable, list[int]] = {}
    drives = [warm_drive(drive) for drive in drives]
    models: dict[int, Reducer] = {}
    layouts: dict[int, Hashable] = {}
    for number, drive in enumerate(drives):
        if refused := impossible_torque(drive):
            messages[number] = refused
            continue
        try:
            require_quantities(drive, settings.quantities)
            if settings.engine.batches:
                models[number] = settings.engine.model(drive, in_batch=True)
        except CycloError as error:
            messages[number] = str(explain_failure(error, drive))
            continue
        key = batch_layout(models[number], layouts) if settings.engine.batches else number
        groups.setdefault(key, []).append(number)
    for members in groups.values():
        _solve_group(drives, models, members, settings, values, messages)
    return SampleResults(values=values[:, :kept], messages=tuple(messages), binds=values[:, kept] > 0.0)


def _solve_group(
    drives: Sequence[Drive],
    models: Mapping[int, Reducer],
    members: list[int],
    settings: BatchSettings,
    values: FloatArray,
    messages: list[str],
) -> None:
    own = [models[number] for number in members] if models else None
    try:
        values[members] = _quantities([drives[number] for number in members], settings, settings.nominal, own)
    except CycloError as error:
        if len(members) > 1:
            half = len(members) // 2
            _solve_group(drives, models, members[:half], settings, values, messages)
            _solve_group(drives, models, members[half:], settings, values, messages)
            return
        if settings.nominal is not None:
            try:
                values[members] = _quantities([drives[members[0]]], settings, None, own)
            except CycloError as second:
                messages[members[0]] = str(explain_failure(second, drives[members[0]]))
        else:
            messages[members[0]] = str(explain_failure(error, drives[members[0]]))


def _quantities(
    drives: list[Drive], settings: BatchSettings, nominal: Nominal | None, models: Sequence[Reducer] | None
) -> FloatArray:
    batch = solve_batch(drives, settings, nominal, models)
    bound = np.zeros(batch.samples)
    if settings.counts_binding:
        bound = samples_that_bind(batch.model, batch.drives, batch.full.crank_angle).astype(float)
    return np.stack([*(evaluate(name, batch) for name in settings.quantities), bound], axis=1)


def solve_batch(
    drives: Sequence[Drive],
    settings: BatchSettings,
    nominal: Nominal | None = None,
    models: Sequence[Reducer] | None = None,
) -> SampleBatch:
    """Solve drives whose models have one `ltca.arrays.batch_layout` at all angles as one batch; `models` are theirs if known.

    Raises `ConvergenceError` when a position of any of them does not balance, and `DriveError` when a torque cannot be carried
    (`ltca.analysis.half_width_guard`).
    """
    drives = [warm_drive(drive) for drive in drives]
    for drive in drives:
        if drive.load.torque == 0.0:
            discs = [ContactGeometry.of_drive(single) for single in single_discs(drive)]
            require_preload(discs, drive, settings.crank_angle)
    stages = {STAGES[name] for name in settings.quantities}
    solved = _Batch(drives, settings, models)
    if nominal is not None and not nominal.suits(solved.model):
        nominal = None
    full = solved.balance([drive.load.torque for drive in drives], None if nominal is None else nominal.full)
    pressures = solved.model.pressures(full.response)
    check_half_widths(drives, full.response, pressures)
    light, play = None, None
    if "light" in stages:
        near = full if nominal is None else nominal.light
        light = solved.balance([drive.load.light_torque for drive in drives], near)
    if "backlash" in stages:
        play = backlash(solved.model.geometries, solved.angle, WHEEL_ANGLE)
    free = None
    if "play" in stages:
        before = play_before_cranks(solved.model, solved.angle)
        free = free_play(solved.model.geometries, solved.angle).play + before
    return SampleBatch(
        drives=tuple(drives),
        model=solved.model,
        full=full,
        pressures=pressures,
        light=light,
        backlash=play,
        play=free,
    )
