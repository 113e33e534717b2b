"""Files of influence coefficients: written whole with a checksum, read only when schema, laws and checksum hold.

Files may come from anybody: links to other files are not followed, data that a file only declares is refused before memory
is allocated, and nothing is executed.
"""

from __future__ import annotations

import hashlib
from dataclasses import replace
from functools import lru_cache
from numbers import Integral, Real
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from ltca.drive.parts import Bodies, Clearance, Drive
from ltca.errors import CycloError, DamagedFileError, PlaceError
from ltca.geometry.flank import FlankProfile
from ltca.geometry.placement import Placement
from ltca.output.files import whole_file
from ltca.output.labelled import LabelledDataset
from ltca.output.netcdf import DAMAGE, opened_hdf5, read_netcdf, write_netcdf
from ltca.reading.coefficient_laws import (
    INTERPOLATION,
    TILT_CONVERGENCE,
    TILT_INTERPOLATION,
    Check,
    check_laws,
    check_quick_laws,
    check_stated_quality,
)
from ltca.reading.coefficient_schema import (
    NEEDED,
    is_solid,
    require_same_supports,
    require_schema,
    shape_differences,
    shape_of,
)

if TYPE_CHECKING:
    from ltca.output.labelled import Labelled

CHECKSUM = "checksum"
PACKED = ("disc_approach", "disc_stress")
"""Matrices that make up a file: stored to `KEPT_BITS`, in single precision, packed."""
KEPT_BITS = 18
"""Bits to which `PACKED` matrices are kept below their largest entry: 4e-6 of it, where the mesh leaves some 4e-3."""

_LAWFUL: set[tuple[str, bool]] = set()
"""Checksums of contents that this process has checked already, by all laws or by the quick ones: a run reads its file more than
once.
"""


PLACE_TOLERANCE = 1e-3
"""Largest misplacement of a station relative to a half-width: coefficients change by that part of the near field's unit."""


def write_coefficients(dataset: Labelled, path: Path) -> Path:
    """Write coefficients (``docs/theory/coefficients.md``) with a checksum, and return the path; the folder is made.

    FaultError when the file cannot be written.
    """
    kept = dataset if isinstance(dataset, LabelledDataset) else LabelledDataset.of(dataset)
    packed = [name for name in PACKED if name in kept]
    fewer = {name: replace(kept[name], values=_kept_bits(kept[name].values)) for name in packed}
    kept = replace(kept, variables=kept.variables | fewer)
    with whole_file(path) as part:
        write_netcdf(replace(kept, attrs=kept.attrs | {CHECKSUM: checksum_of(kept)}), part, packed)
    return path


def _kept_bits(values: NDArray[np.floating]) -> NDArray[np.float32]:
    """Return values as multiples of the power of two that leaves `KEPT_BITS` to the largest: exact in single precision."""
    _, exponent = np.frexp(np.max(np.abs(values), initial=0.0))
    unit = np.ldexp(1.0, int(exponent) - KEPT_BITS)
    return np.asarray(np.rint(values / unit) * unit, dtype=np.float32)


def read_coefficients(path: Path, *, lawful: bool | Literal["quick"] = True) -> LabelledDataset:
    """Read coefficients of the right schema into memory.

    DamagedFileError when there is no such file, it holds something else, its checksum differs, or, with `lawful`, when a
    law is broken, one of those that take milliseconds with "quick" (``cyclo derive --check`` prints which).
    """
    dataset, checksum = _read(path, _stamp(path))
    quick = lawful == "quick"
    if lawful and not {(checksum, quick), (checksum, False)} & _LAWFUL:
        require_laws(dataset, str(path), quick=quick)
        _LAWFUL.add((checksum, quick))
    return dataset


def _stamp(path: Path) -> tuple[int, ...]:
    """What changes with a file's content; nothing where there is no file, which reading tells."""
    try:
        found = path.stat()
    except OSError:
        return ()
    return found.st_dev, found.st_ino, found.st_size, found.st_mtime_ns, found.st_ctime_ns


@lru_cache(maxsize=2)
def _read(path: Path, stamp: tuple[int, ...]) -> tuple[LabelledDataset, str]:
    """Content of a file and its checksum, read once for all discs and cases that share it."""
    dataset = read_netcdf(path, "a coefficient file")
    require_schema(dataset, str(path))
    wide = {
        name: replace(dataset[name], values=dataset[name].values.astype(float)) for name in PACKED if name in dataset
    }
    dataset = replace(dataset, variables=dataset.variables | wide)
    stated, checksum = dataset.attrs.get(CHECKSUM), checksum_of(dataset)
    if stated is not None and str(stated) != checksum:
        raise DamagedFileError(
            f"{path}: is damaged: its content does not have the checksum it states (who changed it on purpose removes the "
            f"attribute {CHECKSUM})"
        )
    return dataset, checksum


def require_laws(dataset: Labelled, source: str, *, quick: bool = False) -> None:
    """Refuse coefficients of the right schema that break a law, all that are broken named: DamagedFileError."""
    if broken := _failed(check_quick_laws(dataset) if quick else check_laws(dataset)):
        said = _words(broken)
        raise DamagedFileError(f"{source}: breaks laws of influence coefficients (cyclo derive --check): {said}")


def _failed(checks: tuple[Check, ...]) -> list[Check]:
    return [check for check in checks if not check.passed]


def _words(failed: list[Check]) -> str:
    return "; ".join(f"{check.name} is {check.value:.4g}: must be {check.bounds}" for check in failed)


def quality_warning(dataset: Labelled, source: str) -> str:
    """Return what to tell of coefficients less accurate than asked for, by what they state, with what derives finer ones.

    "" where the figures that they state are within their bounds.
    """
    if not (failed := _failed(check_stated_quality(dataset))):
        return ""
    between, names = {INTERPOLATION, TILT_INTERPOLATION}, {check.name for check in failed}
    words = ["cyclo derive DRIVE"]
    if is_solid(dataset):
        words.append("--bodies solid")
    elif str(dataset.attrs["plane"]) == "stress":
        words.append("--plane stress")
    size, told, _ = str(dataset.attrs.get("mesh_size", "")).partition(":")
    if names - between and told:
        words.append(f"--size {0.5 * float(size):g}")
    if TILT_CONVERGENCE in names and "layer_height" in dataset:
        # Heights are those of both ends of the layers.
        words.append(f"--layers {dataset['layer_height'].values.size}")
    if names & between:
        words.append("--stations 2")
    return f"{source}: {_words(failed)}; derive anew ({' '.join(words)}) and give the file with --coefficients"


def require_replaceable(path: Path) -> None:
    """Refuse to derive into the place of a file (``--out``) that `write_coefficients` did not write: PlaceError."""
    if path.is_symlink() or (path.exists() and not _is_written_by_us(path)):
        raise PlaceError(
            f"--out {path}: is there and is no coefficient file that cyclo derive wrote: move it, or choose another place"
        )


def _is_written_by_us(path: Path) -> bool:
    """Check the names of variables and attributes, no numbers."""
    try:
        with opened_hdf5(path) as file:
            return CHECKSUM in file.attrs and all(name in file for name in NEEDED)
    except DAMAGE:
        return False


def checksum_of(dataset: Labelled) -> str:
    """Return a hash (hex) of variables and attributes, independent of their storage; units and descriptions of variables
    are left out.
    """
    digest = hashlib.sha256()
    for name in sorted(map(str, dataset.variables)):
        variable = dataset.variables[name]
        if variable.values.dtype.kind not in "iubf":  # labels, and whatever else somebody has put in
            digest.update(f"{name} {variable.dims} {variable.values.tolist()}".encode("utf-8", "backslashreplace"))
            continue
        kind = "<f8" if variable.values.dtype.kind == "f" else "<i8"
        digest.update(f"{name} {variable.dims} {variable.values.shape} {kind}".encode())
        digest.update(np.ascontiguousarray(variable.values, dtype=kind).tobytes())
    for name in sorted(map(str, dataset.attrs)):
        if name != CHECKSUM:
            digest.update(f"{name} {_canonical(dataset.attrs[name])}".encode())
    return digest.hexdigest()


def _canonical(value: Any) -> str:
    if isinstance(value, Integral):
        return str(int(value))
    if isinstance(value, Real):
        return float(value).hex()
    return str(value)


def require_same_bodies(path: Path, data: Labelled, drive: Drive) -> bool:
    """Return whether the file serves the drive although it leaves the clearances out, which it must say itself."""
    bodies: Bodies = "solid" if is_solid(data) else "plane"
    own, theirs, attributes = drive.body_shape(bodies), shape_of(data), data.attrs
    nominal = replace(drive, clearance=Clearance()).body_shape(bodies)
    if theirs == own or (theirs == nominal and bool(attributes["clearances_left_out"])):
        require_same_supports(str(path), data, drive)
        return theirs != own
    different = shape_differences(theirs, own)
    if set(different) <= {"bore_radius", "hole_radius"}:
        bearing, hole = (f"{float(attributes[name]):g} mm" for name in ("bearing_clearance", "pin_hole_clearance"))
        raise CycloError(
            f"{path}: belongs to the clearances bearing {bearing} and pin hole {hole}, not to clearance.bearing = "
            f"{drive.clearance.bearing:g} mm and clearance.pin_hole = {drive.clearance.pin_hole:g} mm of this case: derive "
            "its own (cyclo derive --case), or a file that leaves them out on purpose (cyclo derive --without-clearance)"
        )
    differences = ", ".join(f"{name} {there} (here {here})" for name, (there, here) in different.items())
    raise CycloError(
        f"{path}: belongs to another drive ({attributes.get('drive', '?')}); it differs from {drive.name} in "
        f"{differences}: derive its own (cyclo derive)"
    )


def require_places(path: Path, data: Labelled, drive: Drive) -> None:
    """Refuse stations that do not lie on the walls of the disc: coefficients between them are of their places."""
    flank = FlankProfile.of_drive(drive)
    holes = Placement.of_drive(drive)
    centres = [*holes.bore_centres.tolist(), *holes.hole_centres.tolist()]
    radii = [float(holes.bore_radius)] * holes.cranks + holes.hole_radii.tolist()
    boundary, parameter = data["station_boundary"].values, data["station_parameter"].values
    place = data["station_x"].values + 1j * data["station_y"].values
    for number in range(1 + len(centres)):
        own = boundary == number
        circle = centres[number - 1] + radii[number - 1] * np.exp(1j * parameter[own]) if number else None
        expected = flank.flank(parameter[own]) if circle is None else circle
        away = np.max(np.abs(place[own] - expected) / data["station_half_width"].values[own])
        if not away <= PLACE_TOLERANCE:
            raise DamagedFileError(
                f"{path}: a station of boundary {number} stands {away:.3g} half-widths of its patch from the wall of "
                f"{drive.name}: must be within {PLACE_TOLERANCE:g}"
            )
