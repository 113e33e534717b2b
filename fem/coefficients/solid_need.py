"""Memory and time that the coefficients of a solid disc will need, estimated before it is meshed.

The factor of a section of n nodes, p unknowns at each (6 for each layer over half of the thickness, and 2), has some
:math:`n p^2 \\log_2 n` values by nested dissection; making it takes :math:`n^{1.5} p^3`, each load as much as there are values.
"""

from __future__ import annotations

from dataclasses import dataclass

from fem.mesh.boundary_division import MAX_TURN
from fem.mesh.memory_need import solid_memory, solid_values
from fem.mesh.triangulation import default_coarse_size, estimate_unknowns
from fem.shapes import DiscShape
from fem.solid.layers import graded_layers

# Measured with SuperLU on the paper's disc, 5,200 to 11,700 nodes with 8 and 14 unknowns at each: 44 to 61 bytes and 1.50 to
# 1.76 ns by value, 1.7 to 2.6 ns of the factor, by minimum degree as by METIS; CHOLMOD (the extra "fast") takes 42 to 69 bytes
# and 3.5 to 4.1 ns by value. The rest is what a process and the matrices of the file take.
BYTES = 3.0e8
SECONDS_PER_VALUE, SECONDS_OF_FACTOR = 1.7e-9, 2.2e-9
# Plane bodies by the unknowns of the disc, 4.6 s on that of the paper (measured).
SECONDS_OF_PLANE = 13.0e-6
# Matrices over stations that are held at the same time, of eight bytes.
MATRICES = 12
# Classes of displacements, one after the other; the coarser mesh for the estimate takes a fifth of both.
CLASSES, COARSER = 2, 1.2


@dataclass(frozen=True, slots=True, kw_only=True)
class SolidNeed:
    """What a derivation needs.

    Attributes
    ----------
    unknowns : int
        Of the disc in each class of displacements.
    loads : int
        Right-hand sides in each class.
    memory : float
        Bytes.
    seconds : float
        On one core that is free, plane bodies included, s.
    """

    unknowns: int
    loads: int
    memory: float
    seconds: float

    @property
    def words(self) -> str:
        """Told beforehand."""
        minutes = self.seconds / 60.0
        took = f"{minutes:.1f} min" if minutes >= 1.0 else f"{self.seconds:.0f} s"
        return (
            f"solid disc: some {float(f'{self.unknowns:.2g}'):,.0f} unknowns, {self.loads:,} loads even along the width and as "
            f'many linear: about {took} of one core and {self.memory / 1e9:.2g} GB, with and without the extra "fast"'
        )


def solid_need(
    shape: DiscShape, loads: int, *, size: float, growth: float, layers: int, plane_unknowns: int
) -> SolidNeed:
    """Return what the solid disc needs for its loads, on a section mesh of a size, after plane bodies of some unknowns."""
    nodes = 0.5 * estimate_unknowns(
        shape, (), coarse_size=default_coarse_size(shape, size), growth=growth, turn=MAX_TURN
    )
    per_node = graded_layers(1.0, layers, "symmetric").unknowns_per_node
    values = solid_values(nodes, per_node)
    factor = SECONDS_OF_FACTOR * nodes**1.5 * per_node**3
    return SolidNeed(
        unknowns=round(nodes * per_node),
        loads=loads,
        memory=BYTES + solid_memory(nodes, per_node) + 8.0 * MATRICES * float(loads) ** 2,
        seconds=SECONDS_OF_PLANE * plane_unknowns + COARSER * CLASSES * (factor + loads * SECONDS_PER_VALUE * values),
    )
