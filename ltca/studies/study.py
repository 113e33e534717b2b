"""A study: drive, design, positions and quantities, everything a worker needs to solve any batch of it."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from ltca.analysis.engines import Engine, HalfSpace
from ltca.arrays import BoolArray, FloatArray
from ltca.drive.engine_support import shown, unit_of
from ltca.drive.fields import whose, with_whose
from ltca.drive.members.limits import Limits
from ltca.drive.parts import Drive
from ltca.errors import CycloError
from ltca.geometry.placement import position_angles
from ltca.output.provenance import code_hash
from ltca.output.threads import on_one_thread
from ltca.reading.changes import with_fields
from ltca.studies.batch_analysis import BatchSettings, Nominal, analyse_samples, solve_nominal
from ltca.studies.designs import Design, SweepDesign, ToleranceDesign
from ltca.studies.shapes import coefficients_identity, rings_of, shapes_of
from ltca.studies.yields import Judged

BATCH_POSITIONS = 2048
"""Positions solved together: arrays of a batch stay in the cache, and a fifth of a second of work hides what a task
costs anywhere (1.5 ms on dask.distributed)."""
SINGLE_POSITIONS = 256
"""Positions of a batch whose drives are solved one by one, some ten times as dear each."""


@dataclass(frozen=True, kw_only=True)
class Study:
    """A study, the same whoever computes it.

    Attributes
    ----------
    name : str
        Name of the drive and its case.
    cases : tuple of (str, Drive)
        The drive, one entry unless the case is a factor.
    design : Design
        The samples.
    positions : int
        Crank angles 2πk/N of every sample.
    quantities : tuple of str
        What is kept.
    near_nominal : bool
        Whether samples scatter closely about the drive, so that its solution is the place to start from.
    engine : Engine
        How bodies yield.
    definition : str
        What was asked for, as text: the study file or the options of the command.
    drive_file : str
        Text of the drive file; empty for the first case written as one.
    judged : tuple of Judged
        Limits that samples are judged by; no part of the fingerprint, as they change no result.
    not_judged : dict of str to str
        Other limits of the drive file, with the reason.
    limits : dict of str to Limit
        All of the drive file, which are pointed out where they look like numbers in another unit.
    batch_positions : int
        Positions solved together; 0 for what suits the engine.
    counts_binding : bool
        Whether it is kept which samples bind, by the geometry alone.
    """

    name: str
    cases: tuple[tuple[str, Drive], ...]
    design: Design
    positions: int
    quantities: tuple[str, ...]
    near_nominal: bool
    engine: Engine = field(default_factory=HalfSpace)
    definition: str = ""
    drive_file: str = ""
    judged: tuple[Judged, ...] = ()
    not_judged: dict[str, str] = field(default_factory=dict)
    limits: Limits = field(default_factory=dict)
    batch_positions: int = 0
    counts_binding: bool = False

    def __post_init__(self) -> None:
        """Let the coefficients of the cases serve samples of nearly their bodies."""
        drives = [drive for _, drive in self.cases]
        object.__setattr__(self, "engine", self.engine.lending(drives).lending_rings(drives))

    @property
    def settings(self) -> BatchSettings:
        """How its samples are analysed, each from first contact."""
        return BatchSettings(
            crank_angle=position_angles(self.positions),
            quantities=self.quantities,
            engine=self.engine,
            counts_binding=self.counts_binding,
        )

    @property
    def batch_samples(self) -> int:
        """Samples of a batch; batches are cut the same way whoever solves them."""
        suited = BATCH_POSITIONS if self.engine.batches else SINGLE_POSITIONS
        return max(1, (self.batch_positions or suited) // self.positions)

    @property
    def batches(self) -> int:
        """Number of batches."""
        return -(-self.design.samples // self.batch_samples)

    @property
    def sampled_words(self) -> str:
        """How its values are found, beside those of a run."""
        if self.positions == 1:
            return "values at one position"
        return f"values over {self.positions} sampled positions of a turn, not refined between them as those of cyclo run are"

    def load_words(self) -> str:
        """Return torque and direction of its drives for the heading of a table."""
        varied = [path for path in self.design.names if path in ("load.torque", "load.direction")]
        if varied:
            return f"{' and '.join(varied)} varied"
        loads = dict.fromkeys(drive.load_words() for _, drive in self.cases)
        return ", ".join(loads) if len(loads) < 4 else f"{len(loads)} torques, by case"

    def whose(self, path: str) -> str:
        """Return whose a field is where its number does not say so (`ltca.drive.fields.whose`); empty elsewhere."""
        cranks = {drive.crank.number for _, drive in self.cases}
        return "" if len(cranks) > 1 or "crank.number" in self.design.names else whose(self.cases[0][1], path)

    def eccentrics(self) -> dict[str, str]:
        """Return whose the fields of single eccentrics of several cranks are, by path; empty without any."""
        return {path: owner for path in self.design.names if (owner := self.whose(path))}

    def field_words(self, path: str) -> str:
        """Return a field as people read it: with whose it is where its number does not say so."""
        return with_whose(path, self.whose(path))

    @cached_property
    def fingerprint(self) -> str:
        """Hash of everything the results depend on, the code and files of coefficients included (hex, 16 digits)."""
        parts = (
            self.cases,
            self.design,
            self.positions,
            self.quantities,
            self.near_nominal,
            sorted(self.engine.options.items()),
            coefficients_identity(self.engine),
            code_hash("ltca"),
            self.batch_samples,
            *(["binding"] if self.counts_binding else []),
        )
        return hashlib.sha256(repr(parts).encode()).hexdigest()[:16]

    def drive_of(self, fields: dict[str, Any], *, check: bool = True) -> Drive:
        """Return the drive of one sample, with what it replaces by dotted path; `check` for physical contradictions.

        Raises `DriveError` when it is no sound drive.
        """
        fields = dict(fields)
        base = dict(self.cases)[fields.pop("case", self.cases[0][0])]
        return with_fields(base, fields, check=check)

    def shapes(self, numbers: Sequence[int]) -> dict[str, Drive]:
        """Return a drive of every distinct shape in batches of these numbers, by fingerprint; unsound samples have none."""
        return self._distinct(numbers, shapes_of)

    def rings(self, numbers: Sequence[int]) -> dict[str, Drive]:
        """Return a drive of every distinct ring of finite elements in batches of these numbers, by fingerprint."""
        return self._distinct(numbers, rings_of) if self.engine.rings or "ring.model" in self.design.names else {}

    def _distinct(
        self, numbers: Sequence[int], shapes_of: Callable[[Iterable[Drive], Engine], dict[str, Drive]]
    ) -> dict[str, Drive]:
        """What a function finds in all samples of batches of these numbers."""
        if not numbers:
            return {}
        if isinstance(self.design, ToleranceDesign):
            # Every scattering field differs between two samples: where they share a shape, all do.
            with suppress(CycloError):
                drawn = [self.drive_of(self.design.fields(row), check=False) for row in self.design.rows(0, 2)]
                if len(shapes_of([self.cases[0][1], *drawn], self.engine)) == 1:
                    return shapes_of([self.cases[0][1]], self.engine)
        found: dict[str, Drive] = {}
        for number in numbers:
            for row in self.design.rows(*self.samples_of(number)):
                with suppress(CycloError):
                    found |= shapes_of([self.drive_of(self.design.fields(row))], self.engine)
        return found

    def samples_of(self, number: int) -> tuple[int, int]:
        """Return the first sample of a batch and the first behind it."""
        first = number * self.batch_samples
        return first, min(first + self.batch_samples, self.design.samples)

    def sample_drive(self, sample: int) -> Drive:
        """Return the drive of a sample by its number; `DriveError` when it is no sound drive."""
        return self.drive_of(self.design.fields(self.design.rows(sample, sample + 1)[0]))


@dataclass(frozen=True, slots=True, kw_only=True)
class BatchResult:
    """One solved batch.

    Attributes
    ----------
    number : int
        Which.
    factors : array, shape (samples, columns)
        Numbers of the design.
    values : array, shape (samples, quantities)
        Not a number where the sample failed.
    messages : tuple of str
        Why each sample failed, empty where it did not.
    binds : array of bool, shape (samples,), or None
        Which bind; None where the study does not keep it.
    """

    number: int
    factors: FloatArray
    values: FloatArray
    messages: tuple[str, ...]
    binds: BoolArray | None = None


_NOMINAL: dict[str, Nominal | None] = {}


def _settings(study: Study) -> BatchSettings:
    """Settings with the nominal solution, which every process finds once for itself."""
    settings = study.settings
    key = study.fingerprint
    if key not in _NOMINAL:
        _NOMINAL.clear()
        _NOMINAL[key] = None
        if study.near_nominal:
            # Without it samples start from first contact, and say themselves what is wrong.
            with suppress(CycloError):
                _NOMINAL[key] = solve_nominal(study.cases[0][1], settings)
    return replace(settings, nominal=_NOMINAL[key])


@on_one_thread
def run_batch(study: Study, number: int) -> BatchResult:
    """Solve one batch of a study, by its number: the task every worker runs."""
    factors = study.design.rows(*study.samples_of(number))
    values = np.full((len(factors), len(study.quantities)), np.nan)
    messages = [""] * len(factors)
    drives, sound = [], []
    for place, row in enumerate(factors):
        try:
            drives.append(study.drive_of(study.design.fields(row)))
            sound.append(place)
        except CycloError as error:
            messages[place] = str(error)
    solved = analyse_samples(drives, _settings(study))
    values[sound] = solved.values
    binds = np.zeros(len(factors), dtype=bool)
    binds[sound] = solved.binds
    for place, message in zip(sound, solved.messages, strict=True):
        messages[place] = message
    told = tuple(_about_the_factor(study.design, row, message) for row, message in zip(factors, messages, strict=True))
    return BatchResult(
        number=number,
        factors=factors,
        values=values,
        messages=told,
        binds=binds if study.counts_binding else None,
    )


def _about_the_factor(design: Design, row: FloatArray, message: str) -> str:
    """The message of a failed sample, behind the only field that a sweep varies, cases aside, where it names others alone."""
    if not message or not isinstance(design, SweepDesign):
        return message
    varied = {path: value for path, value in design.fields(row).items() if path != "case"}
    if len(varied) != 1:
        return message
    ((path, value),) = varied.items()
    return message if path in message else f"{path} = {shown(value)}{unit_of(path)}: {message}"
