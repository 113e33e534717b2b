"""gmsh, loaded when needed, with one clear message where its system libraries are missing."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType

from fem.errors import MeshError

DEBIAN_PACKAGES = "libglu1-mesa libgl1 libxft2 libxcursor1 libxinerama1 libgomp1 libegl1"

# gmsh has one global state for the process.
_lock = threading.Lock()


def load_gmsh() -> ModuleType:
    """Import gmsh; MeshError when it or one of its system libraries is missing."""
    try:
        import gmsh
    except OSError as error:
        raise MeshError(
            f"gmsh cannot be loaded, a system library is missing ({error}): on Debian install "
            f"{DEBIAN_PACKAGES} with apt-get, or run .ci/system-libraries, which does so"
        ) from error
    except ImportError as error:
        raise MeshError(f"gmsh is not installed ({error}): install the Python package gmsh") from error
    module: ModuleType = gmsh
    return module


def _hear_signals() -> None:
    """Restore the signal handlers that gmsh replaces when it starts: SIGTERM would end the process without clean-up."""
    if threading.current_thread() is threading.main_thread():
        for number in (signal.SIGTERM, signal.SIGINT):
            handler = signal.getsignal(number)
            if handler is not None:
                signal.signal(number, handler)


@contextmanager
def gmsh_model(name: str) -> Iterator[ModuleType]:
    """Open a silent, single-threaded gmsh with an empty model of a given name."""
    gmsh = load_gmsh()
    with _lock:
        # readConfigFiles=False: options in the user's ~/.gmsh-options would change the mesh.
        gmsh.initialize(["gmsh"], readConfigFiles=False, run=False, interruptible=False)
        _hear_signals()
        try:
            gmsh.option.setNumber("General.Terminal", 0)
            # One thread and a fixed seed: the same input gives the same mesh, bit by bit.
            gmsh.option.setNumber("General.NumThreads", 1)
            gmsh.option.setNumber("Mesh.RandomSeed", 1.0)
            gmsh.model.add(name)
            yield gmsh
        finally:
            gmsh.finalize()
