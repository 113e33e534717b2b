"""Files of influence coefficients: the user's, or derived once for each distinct shape and kept.

`ltca` reads files only: `fem` registers a function in the entry-point group ``cyclo.derivations``, of a drive, ``bodies``,
``store`` and ``processes``, that hands the dataset of docs/theory/coefficients.md to ``store``.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import as_completed
from importlib.metadata import entry_points
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ltca.compliance.coefficients import InfluenceCoefficients, load_coefficients
from ltca.drive.engine_support import require
from ltca.drive.parts import Bodies, Drive
from ltca.drive.single_discs import single_discs
from ltca.errors import CycloError, DamagedFileError
from ltca.output.derived_files import cache_folder, kept_file, read_kept, require_cache
from ltca.output.process_pools import process_pool
from ltca.output.processes import interrupts_held
from ltca.output.progress import progress
from ltca.output.resources import MUCH, derivation_memory
from ltca.output.threads import on_one_thread
from ltca.reading.coefficient_file import require_laws, write_coefficients

if TYPE_CHECKING:
    from ltca.output.labelled import Labelled

GROUP = "cyclo.derivations"
DERIVATION = "finite-elements"
SHIPPED = Path(__file__).parents[1] / "drives" / "coefficients"
"""Files of shipped drives (``python benchmarks/shipped_coefficients.py``)."""
MAX_DERIVATIONS = 2
"""Most derivations at the same time: one takes 0.4 GB for a disc like the paper's, 1.1 GB with 198 teeth."""
SECONDS, SECONDS_PER_TOOTH, SECONDS_PER_HOLE, SECONDS_PER_BORE = 3.0, 0.08, 0.05, 0.1
"""Time of a derivation on one core, s: mostly fixed, then by the number of loads."""


def cached_file(drive: Drive, bodies: Bodies = "plane") -> Path:
    """Return where the coefficients of a shape are kept, by version and hash of the code; temporary where that cannot be."""
    return kept_file(file_name(drive, bodies))


def file_name(drive: Drive, bodies: Bodies = "plane") -> str:
    """Return the name of a file of coefficients by the shape that they belong to."""
    return f"coefficients-{drive.shape_fingerprint(bodies)}-{'solid' if bodies == 'solid' else 'strain'}.nc"


def shipped_file(drive: Drive, bodies: Bodies = "plane") -> Path | None:
    """Return the coefficients of a drive of one disc that come with the package: those of the shipped drives' shapes."""
    path = SHIPPED / file_name(drive, bodies)
    return path if path.exists() else None


def has_coefficients(drive: Drive, bodies: Bodies = "plane") -> bool:
    """Tell whether coefficients of a drive of one disc are there without being derived."""
    return shipped_file(drive, bodies) is not None or cached_file(drive, bodies).exists()


def find_coefficients(
    drive: Drive, files: Sequence[Path] | None = None, *, engine: str = "hybrid", bodies: Bodies = "plane"
) -> InfluenceCoefficients:
    """Return the coefficients of a drive of one disc from files of ``cyclo derive``, or without files kept or newly derived."""
    require(drive, engine)
    if files is not None:
        return _load_first_that_fits(files, drive, bodies)[1]
    return _kept_or_derived({drive.name: drive}, bodies)[drive.name]


def find_case_coefficients(
    cases: Mapping[str, Drive], files: Sequence[Path] = (), *, engine: str = "hybrid", bodies: Bodies = "plane"
) -> dict[str, InfluenceCoefficients]:
    """Return the coefficients by case, of several discs by case and disc; every file serves a case and every case has one."""
    for drive in cases.values():
        require(drive, engine)
    cases = {label: single for name, drive in cases.items() for label, single in _discs(name, drive)}
    if files:
        return _load_each(cases, files, bodies)
    return _kept_or_derived(cases, bodies)


def _kept_or_derived(cases: Mapping[str, Drive], bodies: Bodies) -> dict[str, InfluenceCoefficients]:
    """Coefficients of drives of one disc by name; those that are not kept are derived, of each shape once."""
    kept = {name: _kept(drive, bodies) for name, drive in cases.items()}
    _derive_missing({name: drive for name, drive in cases.items() if kept[name] is None}, bodies)
    return {
        name: own or load_coefficients(cached_file(cases[name], bodies), cases[name], lawful="quick")
        for name, own in kept.items()
    }


def coefficient_warnings(found: Iterable[InfluenceCoefficients | None]) -> list[str]:
    """Return what to tell of coefficients less accurate than asked for, each file once; None stands for half-spaces."""
    return [*dict.fromkeys(own.warning for own in found if own is not None and own.warning)]


def _discs(name: str, drive: Drive) -> list[tuple[str, Drive]]:
    """The drives of each disc with labels of their own."""
    singles = single_discs(drive)
    return [(name if len(singles) == 1 else f"{name}, disc {number}", single) for number, single in enumerate(singles)]


def _load_each(cases: Mapping[str, Drive], files: Sequence[Path], bodies: Bodies) -> dict[str, InfluenceCoefficients]:
    """Give each case the file that belongs to it; leave no case and no file over, and say where clearances are left out."""
    found, used = {}, set()
    for name, drive in cases.items():
        try:
            path, found[name] = _load_first_that_fits(files, drive, bodies)
        except CycloError as error:
            raise CycloError(f"case {name}: {error}") from error
        used.add(path)
        if found[name].shared:
            print(f"{path}: leaves the clearances of {name} out, on purpose", file=sys.stderr)
    idle = [str(path) for path in files if path not in used]
    if idle:
        raise CycloError(f"--coefficients {', '.join(idle)}: serves no case of this run; leave it out")
    return found


def _load_first_that_fits(files: Sequence[Path], drive: Drive, bodies: Bodies) -> tuple[Path, InfluenceCoefficients]:
    refusals = []
    for path in files:
        try:
            return path, load_coefficients(path, drive, bodies=bodies)
        except DamagedFileError:
            raise
        except CycloError as error:
            refusals.append(str(error))
    raise CycloError("; ".join(refusals) or "no file of influence coefficients is given")


def _kept(drive: Drive, bodies: Bodies) -> InfluenceCoefficients | None:
    """Return the coefficients that are shipped or in the cache, None where there are none; only quick laws are checked again."""
    if (path := shipped_file(drive, bodies)) is not None:
        return load_coefficients(path, drive, lawful="quick")
    return read_kept(file_name(drive, bodies), lambda path: load_coefficients(path, drive, lawful="quick"))


def expected_seconds(drives: Iterable[Drive]) -> list[float]:
    """Return about how long plane bodies of each drive of one disc take on one core, s (docs/theory/coefficients.md)."""
    return [
        SECONDS
        + SECONDS_PER_TOOTH * drive.disc.number_of_teeth
        + SECONDS_PER_HOLE * drive.number_of_holes
        + SECONDS_PER_BORE * drive.crank.number
        for drive in drives
    ]


def told_seconds(seconds: float) -> str:
    """Return a time that is known to a factor of two, for a message.

    >>> told_seconds(4.6), told_seconds(21.7), told_seconds(98.0), told_seconds(290.0)
    ('some 5 s', 'some 20 s', 'some 100 s', 'some 5 min')
    """
    step = 5 if seconds < 15.0 else 10
    return f"some {step * max(round(seconds / step), 1)} s" if seconds < 180.0 else f"some {round(seconds / 60.0)} min"


def derivation_words(drives: Iterable[Drive], bodies: Bodies, at_once: int = 1) -> str:
    """Return about how long drives of one disc take, some at once, for a message; solid bodies depend on their mesh."""
    if bodies == "solid":
        return "minutes, told before each"
    each = expected_seconds(drives)
    return told_seconds(max(sum(each) / at_once, *each))


def _derive_missing(cases: Mapping[str, Drive], bodies: Bodies) -> None:
    """Derive the coefficients of cases into the cache, those of one shape once, and say so."""
    shapes: dict[str, str] = {}
    for name, drive in cases.items():
        shapes.setdefault(file_name(drive, bodies), name)
    if not shapes:
        return
    derivation()
    require_cache()
    missing = {cache_folder() / file: name for file, name in shapes.items()}
    whole = derivation_words((cases[name] for name in missing.values()), bodies, _processes(len(missing), bodies))
    most = max(derivation_memory(cases[name].disc.number_of_teeth) for name in missing.values())
    # What solid bodies need is told by what derives them.
    needed = f", {most / 1e9:.0f} GB of memory for each" if most > MUCH and bodies == "plane" else ""
    of = ", solid bodies," if bodies == "solid" else ","
    print(
        f"deriving influence coefficients of {', '.join(missing.values())}{of} once for each shape ({whole}"
        f"{needed}; kept in {next(iter(missing)).parent})",
        file=sys.stderr,
    )
    with progress("coefficients", len(missing)) as advance:
        for path in _derive({path: cases[name] for path, name in missing.items()}, bodies):
            advance(missing[path])


def _derive(drives: Mapping[Path, Drive], bodies: Bodies) -> Iterator[Path]:
    """Derive coefficients into their files, two at once, and yield each file that is there."""
    processes = _processes(len(drives), bodies)
    alone = dict(drives)
    if processes > 1:
        with process_pool(processes) as pool:
            with interrupts_held():
                flying = {
                    pool.submit(_derive_file, drive, path, processes, bodies): path for path, drive in drives.items()
                }
            for future in as_completed(flying):
                # What fails for want of memory (or of a process that was killed for it) may still fit alone.
                if future.exception() is None:
                    del alone[flying[future]]
                    yield flying[future]
    for path, drive in alone.items():
        _derive_file(drive, path, 1, bodies)
        yield path


def _processes(derivations: int, bodies: Bodies) -> int:
    """How many are derived at once: solid bodies take the memory of many plane ones."""
    return 1 if bodies == "solid" else min(MAX_DERIVATIONS, derivations, os.cpu_count() or 1)


@on_one_thread
def _derive_file(drive: Drive, path: Path, processes: int, bodies: Bodies) -> None:
    """Derive the coefficients of one drive into a file, one of some processes that share the memory."""

    def store(dataset: Labelled) -> None:
        require_laws(dataset, str(path))
        write_coefficients(dataset, path)

    # Hours of work on solid bodies are kept until its file stands.
    derivation()(drive, bodies=bodies, processes=processes, store=store)


def derivation(name: str = DERIVATION) -> Callable[..., Any]:
    """Return the function that derives influence coefficients, or the part of an entry point; CycloError where there is none."""
    found = [entry for entry in entry_points(group=GROUP) if entry.name == name]
    if not found:
        if name != DERIVATION:
            raise CycloError(
                f'ring.model = "fe": nothing is installed that derives a {name} by finite elements: use "beam"'
            )
        raise CycloError("no coefficients: give a file of 'cyclo derive' with --coefficients")
    derive: Callable[..., Any] = found[0].load()
    return derive
