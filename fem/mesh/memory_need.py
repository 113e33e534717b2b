"""Memory a mesh or a solution will need, estimated before any work, against what the machine has."""

from __future__ import annotations

import numpy as np

from fem.errors import MemoryLimitError
from ltca.output.resources import available_memory

# SuperLU in symmetric mode held 787 MB for 400,000 plane quadratic unknowns (measured); nested dissection grows
# like n log n.
REFERENCE_UNKNOWNS = 4.0e5
REFERENCE_BYTES = 787.0e6
# The factor of an extruded body has some n p² log₂ n values by nested dissection, with p unknowns at each of the n nodes of its
# section: 42 to 69 bytes for each with SuperLU and CHOLMOD (measured, docs/theory/solid_bodies.md).
SOLID_BYTES_PER_VALUE = 60.0
# Mesh generation, coordinates and tables on the way, per unknown: 245 to 405 measured from 47,000 to 840,000.
MESH_BYTES_PER_UNKNOWN = 500.0
# Quadratic triangles: two nodes for each triangle, two unknowns for each node.
UNKNOWNS_PER_TRIANGLE = {1: 1.0, 2: 4.0}


def mesh_memory(unknowns: int) -> float:
    """Return the bytes that making a mesh needs."""
    return MESH_BYTES_PER_UNKNOWN * unknowns


def solution_memory(unknowns: int) -> float:
    """Return the bytes that mesh and factorised stiffness need."""
    size = max(float(unknowns), 10.0)
    factor = REFERENCE_BYTES * (size / REFERENCE_UNKNOWNS) * np.log(size) / np.log(REFERENCE_UNKNOWNS)
    return float(factor + mesh_memory(unknowns))


def solid_values(nodes: float, per_node: int) -> float:
    """Return about how many values the factor of an extruded body has, of a section of so many nodes with unknowns at each."""
    size = max(float(nodes), 2.0)
    return float(size * per_node**2 * np.log2(size))


def solid_memory(nodes: float, per_node: int) -> float:
    """Return the bytes that one class of an extruded body needs, of a section of so many nodes with unknowns at each."""
    return SOLID_BYTES_PER_VALUE * solid_values(nodes, per_node)


def require_memory(unknowns: int, needed: float, what: str, *, available: float | None = None) -> None:
    """Raise MemoryLimitError when `needed` bytes are not available; `what` is the subject of the message."""
    limit = available_memory() if available is None else available
    if needed > limit:
        raise MemoryLimitError(unknowns, needed, limit, what)
