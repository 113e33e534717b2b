"""Influence coefficients of the shapes that a study has: found before its samples are solved, kept while they are.

Coefficients belong to a shape (`ltca.drive.parts.Drive.shape_fingerprint`): samples that differ in errors of single
parts, load or direction share them, samples that differ in a dimension or a material have their own.
"""

from __future__ import annotations

import hashlib
from collections import OrderedDict
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, nullcontext, suppress
from dataclasses import fields, replace
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

import numpy as np

from ltca.analysis.engines import CoupledEngine, Engine, ring_lender
from ltca.compliance.coefficient_files import (
    GROUP,
    coefficient_warnings,
    derivation_words,
    find_case_coefficients,
    has_coefficients,
    told_seconds,
)
from ltca.compliance.coefficients import InfluenceCoefficients
from ltca.compliance.ring import expected_ring_seconds, has_ring, known_ring
from ltca.drive.members.temperatures import warm_drive
from ltca.drive.parts import Bodies, Drive
from ltca.drive.ring_shape import has_ring_of_elements, ring_fingerprint
from ltca.drive.single_discs import single_discs
from ltca.errors import CycloError
from ltca.output.derived_files import cache_folder, require_cache
from ltca.output.locks import held
from ltca.output.provenance import code_hash
from ltca.output.regular_files import regular_file

MAX_KEPT_SHAPES = 8
"""Shapes whose coefficients a process keeps in memory, some 10 MB for each."""

_ENGINES: OrderedDict[tuple[str, ...], CoupledEngine] = OrderedDict()


def with_kept_coefficients(engine: Engine, drive: Drive) -> Engine:
    """Return the engine with the coefficients of a drive in it, those of the last shapes from memory.

    Raises `CycloError` when there are none and none can be derived.
    """
    given = _given(engine)
    if not isinstance(engine, CoupledEngine) or _are_coefficients(given):
        return engine
    singles = single_discs(warm_drive(drive))
    bodies = engine.bodies_of(singles)
    shapes = [body.shape_fingerprint(engine.bodies) for body in bodies]
    key = (*engine.options.values(), repr(given), *shapes)
    if key not in _ENGINES:
        there = given is not None or all(has_coefficients(body, engine.bodies) for body in bodies)
        with nullcontext() if there else _one_process(shapes[0]):
            _ENGINES[key] = engine.with_coefficients_of(bodies)
        if len(_ENGINES) > MAX_KEPT_SHAPES:
            _ENGINES.popitem(last=False)
    _ENGINES.move_to_end(key)
    return replace(_ENGINES[key].lent_to(singles), rings=engine.rings)


def _given(engine: Engine) -> Any:
    """What the engine was given: coefficients, files, or nothing."""
    return getattr(engine, "coefficients", None)


def _are_coefficients(given: Any) -> bool:
    """Whether that is the coefficients themselves, of all discs alike or of each."""
    each = given if isinstance(given, tuple) and given else (given,)
    return all(isinstance(own, InfluenceCoefficients) for own in each)


@contextmanager
def _one_process(shape: str) -> Iterator[None]:
    """Let one process of a machine at a time look for a shape: the others find what it has derived."""
    # In the cache, which is the user's own: a name in a shared folder others could foresee.
    require_cache()
    with held(cache_folder() / f".{shape}.lock", "the cache", "derive", wait=True):
        yield


def shapes_of(drives: Iterable[Drive], engine: Engine | None = None) -> dict[str, Drive]:
    """Return the first drive of one disc of every distinct shape, by fingerprint; on an engine that lends coefficients, of
    every shape that it needs.
    """
    found: dict[str, Drive] = {}
    kind: Bodies = "plane" if engine is None else engine.bodies
    for drive in drives:
        singles = single_discs(warm_drive(drive))
        for body in engine.bodies_of(singles) if isinstance(engine, CoupledEngine) else singles:
            found.setdefault(body.shape_fingerprint(kind), body)
    return found


def rings_of(drives: Iterable[Drive], engine: Engine) -> dict[str, Drive]:
    """Return the first drive of every distinct ring of finite elements that an engine needs, by fingerprint of the ring."""
    found: dict[str, Drive] = {}
    for drive in drives:
        if has_ring_of_elements(drive):
            own = warm_drive(drive)
            ring = ring_lender(own, engine.rings) or own
            found.setdefault(ring_fingerprint(ring), ring)
    return found


def find_rings_beforehand(rings: Mapping[str, Drive], told: Callable[[str], None]) -> None:
    """Derive the rings that a study will need in this process, so that its workers find them, and say so.

    Raises `CycloError` when none can be derived; one that alone cannot is left to its samples, which say why.
    """
    missing = [drive for drive in rings.values() if not has_ring(drive)]
    if not missing:
        return
    seconds = sum(map(expected_ring_seconds, missing))
    told(
        f"{len(missing)} shape{'s' * (len(missing) > 1)} of the ring by finite elements: derived first, "
        f"{told_seconds(seconds)} in all, and kept"
    )
    failures = []
    for drive in missing:
        try:
            known_ring(drive)
        except CycloError as error:
            failures.append(error)
    if len(failures) == len(rings):
        raise failures[0]


def find_beforehand(engine: Engine, shapes: Mapping[str, Drive], told: Callable[[str], None]) -> None:
    """Derive the coefficients that a study will need in this process, so that its workers find them; nothing for half-spaces.

    Raises `CycloError` when a given file does not serve a shape, or no shape at all has coefficients. A shape that alone cannot
    be derived is left to its samples, which say why.
    """
    given = _given(engine)
    if engine.batches or _are_coefficients(given) or not shapes:
        return
    wanted = list(shapes.values())
    if given is None:
        missing = [drive for drive in wanted if not has_coefficients(drive, engine.bodies)]
        if missing:
            few = "1 shape has" if len(missing) == 1 else f"{len(missing)} shapes have"
            words = derivation_words(missing, engine.bodies, len(missing))
            if engine.bodies == "plane":
                words += " each" + (f", {derivation_words(missing, 'plane')} in all" if len(missing) > 1 else "")
            told(f"{few} no influence coefficients yet: derived first, {words}")
        for first in range(0, len(missing), MAX_KEPT_SHAPES) if len(missing) > 1 else ():
            group = {
                f"shape {first + number}": drive
                for number, drive in enumerate(missing[first : first + MAX_KEPT_SHAPES], 1)
            }
            # Several at once; what fails is tried again alone below.
            with suppress(CycloError):
                find_case_coefficients(group, engine=engine.compliance, bodies=engine.bodies)
        wanted = missing or wanted[:1]
    failures, found = [], list[InfluenceCoefficients]()
    for drive in wanted:
        try:
            given_now = _given(with_kept_coefficients(engine, drive))
            found += given_now if isinstance(given_now, tuple) else [given_now]
        except CycloError as error:
            if given is not None:
                raise
            failures.append(error)
    if len(failures) == len(wanted) == len(shapes):
        raise failures[0]
    for text in coefficient_warnings(found):
        told(f"warning: {text}")


def coefficients_identity(engine: Engine) -> str:
    """Return what tells the coefficients of an engine from others: hash of what was given or of what derives them."""
    ring = "".join(f" ring {ring_fingerprint(drive)}" for drive in engine.rings)
    ring += f" derived {code_hash('fem')}" if ring else ""
    return _coefficients_identity(engine) + ring


def _coefficients_identity(engine: Engine) -> str:
    given = _given(engine)
    if engine.batches:
        return "none"
    if _are_coefficients(given):
        digest = hashlib.sha256()
        for own in given if isinstance(given, tuple) else (given,):
            # What is said of a file names its place.
            for value in (getattr(own, item.name) for item in fields(own) if item.name != "warning"):
                digest.update(value.tobytes() if isinstance(value, np.ndarray) else repr(value).encode())
        return f"given {digest.hexdigest()[:16]}"
    if given is not None:
        files = [given] if isinstance(given, Path) else list(given)
        return "files " + " ".join(_checksum(path)[:16] for path in files)
    lent = "".join(f" lent by {body.shape_fingerprint(engine.bodies)}" for body in getattr(engine, "lenders", ()))
    packages = sorted({entry.module.partition(".")[0] for entry in entry_points(group=GROUP)})
    return f"derived {code_hash(*packages)}{lent}"


def _checksum(path: Path) -> str:
    try:
        with regular_file(path) as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest()
    except OSError as error:
        raise CycloError(f"{path}: cannot be read as a coefficient file: {error}") from error
