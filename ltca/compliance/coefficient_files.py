"""Where influence coefficients come from: a file of the user's, or derived once for a shape and kept.

`ltca` reads files only. What derives them registers in the entry-point group ``cyclo.derivations`` (the package
`fem` does), so that `ltca` imports nothing to its right.
"""

from __future__ import annotations

import os
import sys
from importlib.metadata import entry_points, version
from pathlib import Path

from ltca.compliance.coefficients import InfluenceCoefficients, load_coefficients
from ltca.drive.parts import Drive
from ltca.errors import CycloError
from ltca.output.files import whole_file

GROUP = "cyclo.derivations"
DERIVATION = "finite-elements"


def cached_file(drive: Drive, plane: str = "strain") -> Path:
    """Return where the coefficients of a drive's shape are kept: under ``$XDG_CACHE_HOME`` or ``~/.cache``."""
    base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return base / "cyclo" / version("cyclo-ltca") / f"coefficients-{drive.shape_fingerprint()}-{plane}.nc"


def find_coefficients(drive: Drive, file: Path | None = None, plane: str = "strain") -> InfluenceCoefficients:
    """Return the coefficients of a drive: from a file, from the cache, or newly derived and kept there.

    Parameters
    ----------
    drive : Drive
        The drive; its clearances, load and single-part errors do not matter.
    file : Path, optional
        File of ``cyclo derive``.
    plane : {"strain", "stress"}
        State of the body part when it has to be derived.

    Returns
    -------
    InfluenceCoefficients
        For `ltca.compliance.coupled`.

    Raises
    ------
    CycloError
        When the file does not fit the drive or nothing is installed that derives.
    """
    if file is not None:
        return load_coefficients(file, drive)
    path = cached_file(drive, plane)
    if not path.exists():
        found = [entry for entry in entry_points(group=GROUP) if entry.name == DERIVATION]
        if not found:
            raise CycloError("no coefficients: give a file of 'cyclo derive' with --coefficients")
        print(f"deriving influence coefficients once (kept as {path})", file=sys.stderr)
        dataset = found[0].load()(drive, state=plane)
        with whole_file(path) as part:
            dataset.to_netcdf(part, engine="h5netcdf")
    return load_coefficients(path, drive)
