r"""Flexibility of the ring of the pin wheel at the seats of its pins and at its bolts, by plane finite elements.

Loads and measures are those of `fem.body.pin_ring`.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fem.body.pin_ring import DerivedRing, bolts_of_drive, flexibility_of, ring_of_drive
from fem.coefficients.bodies import require_element_size
from fem.mesh.gmsh_session import load_gmsh
from ltca.drive.parts import Drive
from ltca.drive.ring_shape import bolt_patch_radius, ring_fingerprint, ring_shape
from ltca.errors import DamagedFileError, PlaceError
from ltca.output.provenance import code_hash, code_version
from ltca.reading.ring_file import read_ring

if TYPE_CHECKING:
    import xarray as xr

MAX_SIZE = 4.0
"""Largest multiple of the default element edges: beyond it a seat has some six edges."""
COARSE_RATIO = 2.0
"""Multiple of the element edges of the second mesh, from which the convergence is estimated."""


def derive_ring(
    drive: Drive, *, case: str = "", size: float = 1.0, progress: Callable[[str], None] | None = None
) -> xr.Dataset:
    """Derive the flexibility of the ring of a drive at its seats and bolts.

    Parameters
    ----------
    drive : Drive
        With a ring; at its temperatures.
    case : str
        Name of its case, for the record.
    size : float
        Multiple of the default element edges; the convergence estimate takes a mesh of twice that.
    progress : callable, optional
        Called with the name of each step before it starts.

    Returns
    -------
    Dataset
        As ``docs/theory/ring_elements.md`` describes it.

    Raises
    ------
    DriveError
        Without a ring.
    MeshError
        When a parameter is out of bounds or meshing fails.
    MemoryLimitError
        When mesh and solution would not fit into memory.
    """
    import xarray as xr

    require_element_size(size, MAX_SIZE / COARSE_RATIO)
    shape, bolts, tell = ring_of_drive(drive), bolts_of_drive(drive), progress or (lambda step: None)
    ring = drive.ring
    assert ring is not None  # or there were no shape

    def derived(scale: float) -> DerivedRing:
        patch, held = bolt_patch_radius(drive), ring.flange == "built-in"
        return flexibility_of(shape, bolts, patch, ring.material.poisson_ratio, held=held, size=scale)

    tell("ring, twice the size")
    coarse = derived(COARSE_RATIO * size)
    tell("ring")
    fine = derived(size)
    components = ["x", "y"]
    dimensions = ("place", "component", "place_loaded", "component_loaded")
    change = np.max(np.abs(fine.flexibility - coarse.flexibility)) / np.max(np.abs(fine.flexibility))
    return xr.Dataset(
        {
            "flexibility": (
                dimensions,
                fine.flexibility,
                {"units": "1", "long_name": "displacement by a unit force, times E b"},
            )
        },
        coords={"component": components, "component_loaded": components},
        attrs={
            "part": "ring",
            "drive": drive.name,
            "case": case,
            "shape": json.dumps(ring_shape(drive)),
            "fingerprint": ring_fingerprint(drive),
            "plane": "stress",
            "bolts": len(bolts),
            "unknowns": fine.unknowns,
            "size": size,
            "turned": fine.turned,
            "mirror": fine.mirror,
            "convergence_estimate": float(change),
            "version": code_version(),
            "code_hash": code_hash("ltca", "fem"),
            "gmsh": str(load_gmsh().__version__),
        },
    )


def require_replaceable_ring(path: Path) -> None:
    """Refuse to derive into the place of a file (``--out``) that is no file of a ring's flexibility: PlaceError."""
    if path.is_symlink() or (path.exists() and not _is_ring_file(path)):
        raise PlaceError(
            f"--out {path}: is there and is no file of a ring that cyclo derive wrote: move it, or choose another place"
        )


def _is_ring_file(path: Path) -> bool:
    try:
        read_ring(path, lawful=False)
    except DamagedFileError:
        return False
    return True
