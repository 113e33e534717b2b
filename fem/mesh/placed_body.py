"""The mesh of a body at its place in the drive."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem.mesh.body_mesh import BodyMesh
from ltca.arrays import ComplexArray, IntArray

POINTS_PER_EDGE = 5
"""Points drawn along a curved edge."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PlacedBody:
    """A body at its place in the fixed frame.

    Attributes
    ----------
    body : BodyMesh
        Its mesh.
    centre : complex
        Place of the origin of its frame, mm.
    rotation : float
        Turn of its frame, rad.
    kind : str
        "disc", "pin", "roller", "shaft_pin" or "inner_race".
    """

    body: BodyMesh
    centre: complex
    rotation: float
    kind: str

    @property
    def nodes(self) -> ComplexArray:
        """Nodes in the fixed frame, mm."""
        return np.asarray(self.centre + self.body.places * np.exp(1j * self.rotation))

    def edge_lines(self) -> ComplexArray:
        """Return points along every (curved) edge, shape (facets, 2 or 5)."""
        mesh, nodes = self.body.mesh, self.nodes
        first, last = nodes[mesh.facets[0]], nodes[mesh.facets[1]]
        if self.body.order == 1:
            return np.column_stack([first, last])
        s = np.linspace(0.0, 1.0, POINTS_PER_EDGE)
        shapes = np.array([(1.0 - s) * (1.0 - 2.0 * s), 4.0 * s * (1.0 - s), s * (2.0 * s - 1.0)])
        return np.asarray(np.stack([first, nodes[mesh.nvertices :], last], axis=1) @ shapes)

    def faces(self) -> IntArray:
        """Return straight triangles that fill the body: each quadratic element as four."""
        elements = self.body.element_nodes
        if self.body.order == 1:
            return elements
        return np.vstack([elements[:, part] for part in ([0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5])])
