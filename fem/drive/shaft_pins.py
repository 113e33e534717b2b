"""Elastic shaft pins, an option: full circles whose mean displacement stands on the isotropic spring.

The default is a rigid circle on that spring. An elastic pin yields locally as well; its mean rotation is held, as that
of a roller.
"""

from __future__ import annotations

from fem.drive.expected_contacts import ExpectedContacts
from fem.drive.meshes import ELEMENTS_PER_HALF_WIDTH, RoundEnd, RoundGrading, RoundMesh, coarse_edge
from fem.shapes import DriveShapes


def mesh_shaft_pins(shapes: DriveShapes, contacts: ExpectedContacts, scale: float) -> tuple[RoundMesh, ...]:
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
    tuple of RoundMesh
        About the origin.
    """
    meshes = []
    for shape, width, direction in zip(
        shapes.shaft_pins, contacts.holes.half_width.tolist(), contacts.holes.direction.tolist(), strict=True
    ):
        end = RoundEnd(edge=scale * width / ELEMENTS_PER_HALF_WIDTH, half_width=width)
        grading = RoundGrading(
            radius=shape.radius,
            core_radius=shape.core_radius,
            ends=(end,),
            coarse_size=coarse_edge(shape, scale),
        )
        meshes.append(RoundMesh(grading=grading, body=grading.mesh(shape.name), turn=direction))
    return tuple(meshes)
