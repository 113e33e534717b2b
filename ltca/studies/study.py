"""A study: drive, design, positions and quantities, everything a worker needs to solve any batch of it."""

from __future__ import annotations

import hashlib
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.drive.parts import Drive
from ltca.errors import CycloError
from ltca.geometry.placement import position_angles
from ltca.reading.changes import with_fields
from ltca.studies.batch_analysis import BatchSettings, ModelBuilder, Nominal, analyse_samples, solve_nominal
from ltca.studies.designs import Design

FloatArray = NDArray[np.float64]

BATCH_POSITIONS = 2048
"""Positions solved together: arrays of a batch stay in the cache, and a fifth of a second of work hides what a task
costs on any engine (1.5 ms on dask.distributed)."""


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
    build : callable
        Compliance model of several drives.
    """

    name: str
    cases: tuple[tuple[str, Drive], ...]
    design: Design
    positions: int
    quantities: tuple[str, ...]
    near_nominal: bool
    build: ModelBuilder = field(default=HalfSpaceCompliance.of_drives)

    @property
    def batch_samples(self) -> int:
        """Samples of a batch; batches are cut the same way for every engine."""
        return max(1, BATCH_POSITIONS // self.positions)

    @property
    def batches(self) -> int:
        """Number of batches."""
        return -(-self.design.samples // self.batch_samples)

    def fingerprint(self) -> str:
        """Return a hash of everything the results depend on (hex, 16 digits)."""
        model = getattr(self.build, "__qualname__", None) or repr(self.build)
        parts = (self.cases, self.design, self.positions, self.quantities, self.near_nominal, model, BATCH_POSITIONS)
        return hashlib.sha256(repr(parts).encode()).hexdigest()[:16]

    def drive_of(self, fields: dict[str, Any]) -> Drive:
        """Return the drive of one sample.

        Raises
        ------
        DriveError
            When the sample is no sound drive.
        """
        fields = dict(fields)
        base = dict(self.cases)[fields.pop("case", self.cases[0][0])]
        return with_fields(base, fields)

    def sample_drive(self, sample: int) -> Drive:
        """Return the drive of a sample by its number.

        Raises
        ------
        DriveError
            When there is no such sample or it is no sound drive.
        """
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
    """

    number: int
    factors: FloatArray
    values: FloatArray
    messages: tuple[str, ...]


_NOMINAL: dict[str, Nominal | None] = {}


def _settings(study: Study) -> BatchSettings:
    """Settings with the nominal solution, which every process finds once for itself."""
    settings = BatchSettings(
        crank_angle=position_angles(study.positions), quantities=study.quantities, build=study.build
    )
    key = study.fingerprint()
    if key not in _NOMINAL:
        _NOMINAL.clear()
        _NOMINAL[key] = None
        if study.near_nominal:
            # Without it samples start from first contact, and say themselves what is wrong.
            with suppress(CycloError):
                _NOMINAL[key] = solve_nominal(study.cases[0][1], settings)
    return BatchSettings(
        crank_angle=settings.crank_angle,
        quantities=settings.quantities,
        build=settings.build,
        nominal=_NOMINAL[key],
    )


def run_batch(study: Study, number: int) -> BatchResult:
    """Solve one batch: the task every engine runs.

    Parameters
    ----------
    study : Study
        The study.
    number : int
        Batch 0 … ``study.batches`` − 1.
    """
    first = number * study.batch_samples
    last = min(first + study.batch_samples, study.design.samples)
    factors = study.design.rows(first, last)
    values = np.full((last - first, len(study.quantities)), np.nan)
    messages = [""] * (last - first)
    drives, sound = [], []
    for place, row in enumerate(factors):
        try:
            drives.append(study.drive_of(study.design.fields(row)))
            sound.append(place)
        except CycloError as error:
            messages[place] = str(error)
    solved = analyse_samples(drives, _settings(study))
    values[sound] = solved.values
    for place, message in zip(sound, solved.messages, strict=True):
        messages[place] = message
    return BatchResult(number=number, factors=factors, values=values, messages=tuple(messages))
