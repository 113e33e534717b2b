"""Errors of the finite-element part; the command line turns them into one message and exit status 2."""

from __future__ import annotations

from ltca.errors import CycloError


class MeshError(CycloError):
    """A mesh cannot be made, read or used; the message is one complete sentence."""


class MemoryLimitError(MeshError):
    """A mesh or solution would need more memory than the machine has.

    Parameters
    ----------
    unknowns : int
        Estimated number of unknowns.
    needed, available : float
        Bytes.
    what : str
        What would need it.
    """

    def __init__(self, unknowns: int, needed: float, available: float, what: str) -> None:
        self.unknowns = unknowns
        self.needed = needed
        self.available = available
        rounded = int(float(f"{unknowns:.3g}"))
        super().__init__(
            f"{what} would have about {rounded:,} unknowns and need about {needed / 1e9:.3g} GB of memory, "
            f"but {available / 1e9:.3g} GB are available: use larger elements"
        )
