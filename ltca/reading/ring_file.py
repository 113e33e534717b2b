"""Files of the flexibility of a ring of the pin wheel: schema, and laws that need no second computation.

A file holds the displacement (x, y) of the seats of the pins and of the bolts by unit forces there, times E b of the ring
(docs/theory/ring_elements.md); of a free ring beyond the rigid motion that fits all of them best.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ltca.arrays import ComplexArray, FloatArray
from ltca.drive.parts import Drive
from ltca.drive.ring_shape import ring_shape
from ltca.errors import CycloError, DamagedFileError
from ltca.output.files import whole_file
from ltca.output.netcdf import read_netcdf, write_netcdf
from ltca.reading.coefficient_file import CHECKSUM, checksum_of
from ltca.reading.coefficient_laws import Check
from ltca.reading.coefficient_schema import shape_differences, shape_of

if TYPE_CHECKING:
    import xarray as xr

    from ltca.output.labelled import Labelled, LabelledDataset

DIMENSIONS = ("place", "component", "place_loaded", "component_loaded")
SHAPE = (
    "pin_wheel.number_of_pins",
    "pin_wheel.pin_circle_radius",
    "seat_radius",
    "ring.inner_radius",
    "ring.outer_radius",
    "ring.material.poisson_ratio",
    "built_in",
)
"""Numbers that the shape of every ring has."""
# Set after the figures of eleven rings were known: equal seats differ by 3e-6 to 6e-5 on the default mesh, and from a mesh of
# twice the size single entries change by 1e-4 to 6e-4.
MESH_LIMIT = 1e-3
CONVERGENCE_LIMIT = 1e-2


def write_ring(dataset: xr.Dataset, path: Path) -> Path:
    """Write the flexibility of a ring with a checksum, and return the path; the folder is made."""
    with whole_file(path) as part:
        write_netcdf(dataset.assign_attrs({CHECKSUM: checksum_of(dataset)}), part)
    return path


def is_ring(dataset: Labelled) -> bool:
    """Tell whether a file says that it holds the flexibility of a ring."""
    return str(dataset.attrs.get("part", "")) == "ring"


def read_ring(path: Path, *, lawful: bool = True) -> LabelledDataset:
    """Read the flexibility of a ring into memory.

    DamagedFileError when there is no such file, it holds something else, its checksum differs, or, with `lawful`, when a law is
    broken.
    """
    dataset = read_netcdf(path, "a file of a ring's flexibility")
    if problems := [*_malformed(dataset)]:
        raise DamagedFileError(
            f"{path}: is no file of a ring's flexibility (docs/theory/ring_elements.md): {'; '.join(problems)}"
        )
    stated = dataset.attrs.get(CHECKSUM)
    if stated is not None and str(stated) != checksum_of(dataset):
        raise DamagedFileError(
            f"{path}: is damaged: its content does not have the checksum it states (who changed it on purpose removes the "
            f"attribute {CHECKSUM})"
        )
    broken = [check for check in check_ring(dataset) if not check.passed] if lawful else []
    if broken:
        said = "; ".join(f"{check.name} is {check.value:.4g}: must be {check.bounds}" for check in broken)
        raise DamagedFileError(f"{path}: breaks laws of a ring's flexibility (cyclo derive --check): {said}")
    return dataset


def require_same_ring(dataset: Labelled, drive: Drive, source: str) -> None:
    """Refuse a file of another ring than that of a drive: CycloError with the numbers that differ."""
    theirs, own = shape_of(dataset), ring_shape(drive)
    if drive.ring is None:
        raise CycloError(f"{source}: belongs to a ring, and {drive.name} has none ([ring] is left out)")
    if theirs != own:
        different = ", ".join(
            f"{name} {there} (here {here})" for name, (there, here) in shape_differences(theirs, own).items()
        )
        raise CycloError(
            f"{source}: belongs to another ring; it differs from that of {drive.name} in {different}: derive its own "
            "(cyclo derive --part ring)"
        )


def _malformed(dataset: Labelled) -> Iterator[str]:
    if not is_ring(dataset):
        yield 'its attribute part is not "ring"'
        return
    shape = shape_of(dataset)
    if lacking := [name for name in SHAPE if name not in shape]:
        yield f"its shape lacks {', '.join(lacking)}"
        return
    if "flexibility" not in dataset.variables:
        yield "it lacks flexibility"
        return
    variable, places = dataset["flexibility"], _places(shape).size
    if variable.dims != DIMENSIONS:
        yield f"flexibility has the dimensions ({', '.join(map(str, variable.dims))}): must be ({', '.join(DIMENSIONS)})"
    elif variable.values.shape != (places, 2, places, 2):
        yield f"flexibility has the shape {variable.values.shape}: must be {(places, 2, places, 2)}, of seats and bolts"
    elif variable.values.dtype.kind != "f" or not np.all(np.isfinite(variable.values)):
        yield "flexibility holds values that are no finite numbers"


def _places(shape: dict[str, float]) -> ComplexArray:
    """Places of seats, then bolts, mm."""

    def around(count: float, radius: float) -> ComplexArray:
        return np.asarray(radius * np.exp(2j * np.pi * np.arange(int(count)) / max(int(count), 1)))

    seats = around(shape["pin_wheel.number_of_pins"], shape["pin_wheel.pin_circle_radius"])
    bolts = around(shape.get("ring.bolts.number", 0.0), shape.get("ring.bolts.circle_radius", 0.0))
    return np.concatenate([seats, bolts])


def check_ring(dataset: Labelled) -> tuple[Check, ...]:
    """Check the flexibility of a ring: symmetry, rigid motions, positive work, equal seats, convergence."""
    return tuple(_checks(dataset))


def _checks(dataset: Labelled) -> Iterator[Check]:
    shape = shape_of(dataset)
    places = _places(shape)
    matrix = dataset["flexibility"].values.reshape(2 * places.size, -1)
    largest = float(np.max(np.abs(matrix)))
    symmetry = float(np.max(np.abs(matrix - matrix.T))) / largest
    yield Check(
        name="symmetry", value=symmetry, lowest=0.0, highest=1e-10, reason="Maxwell–Betti; means of both halves"
    )
    values = np.linalg.eigvalsh(0.5 * (matrix + matrix.T)) / largest
    reason = "forces do positive work"
    if shape["built_in"]:
        yield Check(name="smallest eigenvalue", value=float(values[0]), lowest=1e-9, highest=np.inf, reason=reason)
    else:
        modes, _ = np.linalg.qr(rigid_motions(places))
        left = float(np.max(np.abs(matrix @ modes))) / largest
        yield Check(name="rigid motions", value=left, lowest=0.0, highest=1e-9, reason="taken off: round-off")
        # Forces without the part dual to rigid motions.
        lifted = matrix / largest + modes @ modes.T
        smallest = float(np.linalg.eigvalsh(0.5 * (lifted + lifted.T))[0])
        yield Check(name="smallest eigenvalue", value=smallest, lowest=1e-9, highest=np.inf, reason=reason)
    for name, attribute, most, why in (
        ("equal seats under the ring's rotations", "turned", MESH_LIMIT, "an error of the mesh, averaged out"),
        ("the same in its mirror image", "mirror", MESH_LIMIT, "an error of the mesh, averaged out"),
        (
            "convergence: change from a mesh of twice the size",
            "convergence_estimate",
            CONVERGENCE_LIMIT,
            "of the largest",
        ),
    ):
        if attribute in dataset.attrs:
            yield Check(name=name, value=float(dataset.attrs[attribute]), lowest=0.0, highest=most, reason=why)


def rigid_motions(places: ComplexArray) -> FloatArray:
    """Return the displacements of places by unit x, y and rotation about the origin, shape (2 places, 3), x and y by place."""
    motions = np.zeros((places.size, 2, 3))
    motions[:, 0, 0] = motions[:, 1, 1] = 1.0
    motions[:, 0, 2], motions[:, 1, 2] = -places.imag, places.real
    return motions.reshape(-1, 3)
