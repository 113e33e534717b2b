"""Methods of other packages: contact grids and the paper's iteration."""

from __future__ import annotations

from importlib.metadata import entry_points
from typing import Any

from ltca.errors import DriveError

METHODS = "cyclo.methods"
"""Group of entry points.

``grids``: a callable that returns the contacts of a drive of one disc on half-space grids, a
`ltca.compliance.response.DiscModel`. ``paper``: a callable that prepares the paper's iteration for a drive, its tables and the
model to balance.
"""


def load_method(name: str, option: str) -> Any:
    """Load an entry point of `METHODS`.

    Parameters
    ----------
    name : {"grids", "paper"}
        Of the entry point.
    option : str
        That asks for it, for the message.

    Raises
    ------
    DriveError
        When no installed package has it.
    """
    found = [entry for entry in entry_points(group=METHODS) if entry.name == name]
    if not found:
        raise DriveError([f"{option}: comes with the package validation, which is not installed"])
    return found[0].load()
