"""Which code made a result: version and a hash of its sources, the same on every machine that has the same code."""

from __future__ import annotations

import hashlib
from functools import cache
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

SOURCES = (".py", ".toml", ".json", ".nc")


def code_version() -> str:
    """Return the version of the installed distribution."""
    return version("cyclo-ltca")


@cache
def code_hash(*packages: str) -> str:
    """Return a hash of the sources of some packages (hex, 16 digits).

    Parameters
    ----------
    *packages : str
        Names of importable packages, ``"ltca"`` for instance; nothing is imported.

    Returns
    -------
    str
        Of relative paths and contents of all source and data files, independent of where they lie; a package that is
        not installed counts by its absence.
    """
    digest = hashlib.sha256()
    for package in packages:
        spec = find_spec(package)
        if spec is None or not spec.submodule_search_locations:
            digest.update(f"{package} is not installed".encode())
            continue
        root = Path(next(iter(spec.submodule_search_locations)))
        for path in sorted(root.rglob("*"), key=lambda path: path.relative_to(root).as_posix()):
            if path.suffix in SOURCES and path.is_file():
                digest.update(f"{package}/{path.relative_to(root).as_posix()}\0".encode())
                digest.update(path.read_bytes())
    return digest.hexdigest()[:16]
