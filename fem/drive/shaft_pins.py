"""Elastic shaft pins, an option: full circles whose mean displacement stands on the isotropic spring.

The default is a rigid circle on that spring. An elastic pin yields locally as well; its mean rotation is held, as that
of a roller.
"""

from __future__ import annotations

import numpy as np

from fem.drive.expected_contacts import ExpectedContacts
from fem.drive.meshes import ELEMENTS_PER_HALF_WIDTH, ZONE_HALF_WIDTHS
from fem.mesh.body_mesh import BodyMesh
from fem.mesh.element_size import Refinement
from fem.mesh.triangulation import default_coarse_size, mesh_circle
from fem.shapes import DriveShapes


def mesh_shaft_pins(shapes: DriveShapes, contacts: ExpectedContacts, scale: float) -> tuple[BodyMesh, ...]:
    """Return a mesh of every shaft pin, graded toward its hole.

    Parameters
    ----------
    shapes : DriveShapes
        Shapes of the bodies.
    contacts : ExpectedContacts
        Expected contacts.
    scale : float
        Element edge as a multiple of an eighth of each half-width.

    Returns
    -------
    tuple of BodyMesh
        About the origin, axes parallel to the fixed ones.
    """
    meshes = []
    for shape, width, direction in zip(
        shapes.shaft_pins, contacts.holes.half_width.tolist(), contacts.holes.direction.tolist(), strict=True
    ):
        spots = []
        if width > 0.0:
            size = scale * width / ELEMENTS_PER_HALF_WIDTH
            spots.append(Refinement.polar(shape.radius, direction, size=size, radius=ZONE_HALF_WIDTHS * width))
        coarse = default_coarse_size(shape, min(1.0, float(np.sqrt(scale))) if scale < 1.0 else scale)
        meshes.append(mesh_circle(shape, spots, coarse_size=coarse))
    return tuple(meshes)
