"""Memory and disc a run will need, against what the machine has, before it starts."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

from ltca.errors import PlaceError

MUCH = 2e9
"""Memory from which on it is told before the work, bytes."""

DERIVATION, OF_MESH, PER_TOOTH = 0.2e9, 0.2e9, 3.8e6
"""Memory to derive influence coefficients of plane bodies, bytes: of any, of a mesh of size 1, and for each tooth, whose loads
need it on any mesh. Measured 0.39 GB for 13 teeth, 0.64 for 99, 1.10 for 198; for 13 teeth 0.38 GB at size 2, 1.09 at 0.5."""


def available_memory() -> float:
    """Return the bytes the process may still take: free memory of the machine, or less under a cgroup limit."""
    import psutil  # here, because most commands do not ask

    limits = [float(psutil.virtual_memory().available)]
    for limit, used in (
        ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory.current"),
        ("/sys/fs/cgroup/memory/memory.limit_in_bytes", "/sys/fs/cgroup/memory/memory.usage_in_bytes"),
    ):
        if Path(limit).exists() and Path(used).exists():
            text = Path(limit).read_text(encoding="ascii").strip()
            if text.isdigit():
                limits.append(float(text) - float(Path(used).read_text(encoding="ascii")))
    return max(min(limits), 0.0)


def derivation_memory(teeth: int, size: float = 1.0) -> float:
    """Estimate the memory for the derivation of plane bodies of a disc with so many teeth, bytes.

    `size` is the edge of elements by the default one; the memory for a mesh goes with its inverse square.
    """
    return DERIVATION + OF_MESH / size**2 + PER_TOOTH * teeth


def tell_memory(memory: float, what: str) -> None:
    """Print, before work that needs more than `MUCH` bytes of memory, how many."""
    if memory > MUCH:
        print(f"{what}: needs about {_size(memory)} of memory", file=sys.stderr)


def require_room(needed: float, *, memory: float, folder: Path, option: str) -> None:
    """Refuse work whose results need more bytes on disc or in memory than there are; tell of more than `MUCH` memory.

    `option`, what makes it so large with its value, is named in the `PlaceError`.
    """
    free = available_memory()
    if memory > free:
        raise PlaceError(f"{option}: needs about {_size(memory)} of memory, {_size(free)} are available: take fewer")
    tell_memory(memory, option)
    place = folder.absolute()
    while not place.exists():
        place = place.parent
    room = shutil.disk_usage(place).free
    if needed > room:
        raise PlaceError(
            f"{option}: results take about {_size(needed)}, {_size(room)} are free in --out {folder}: take fewer, or "
            "another folder"
        )


def _size(count: float) -> str:
    """Return a number of bytes as it is read."""
    for factor, unit in ((1e9, "GB"), (1e6, "MB")):
        if count >= factor:
            return f"{count / factor:.3g} {unit}"
    return f"{count / 1e3:.3g} kB"
