"""Largest shear stress below a contact, from recovered nodal stresses."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import LinearNDInterpolator

from fem.body.stress import Stress
from fem.errors import MeshError
from fem.mesh.body_mesh import BodyMesh

# Depths looked at, in half-widths: a Hertz contact has its largest shear at 0.786.
MIN_DEPTH, MAX_DEPTH, DEPTH_COUNT = 0.3, 2.0, 171
# Nodes this near take part, in half-widths: enough to hold the line of depths.
NEIGHBOURHOOD_RADIUS = 2.5


def largest_shear_below(
    body: BodyMesh, stress: Stress, place: complex, inward: complex, half_width: float
) -> tuple[float, float]:
    r"""Return the largest shear stress in the plane on the normal below a contact, MPa, and its depth, mm.

    The shear is :math:`\tfrac12 (\sigma_1 - \sigma_2)`; `place` is the centre of the pressure and `inward` the unit normal
    into the body. On a mesh with 8 elements for the half-width nodes lie b/16 apart, and linear interpolation between them is
    within 0.1 %. MeshError when the contact does not lie on the body.
    """
    nodes = body.mesh.doflocs
    near = np.flatnonzero(np.hypot(nodes[0] - place.real, nodes[1] - place.imag) < NEIGHBOURHOOD_RADIUS * half_width)
    if len(near) < 4:
        raise MeshError(
            f"{body.name}: has {len(near)} nodes within {NEIGHBOURHOOD_RADIUS * half_width:.3g} mm of a contact, needs 4 or more"
        )
    components = np.column_stack([stress.xx[near], stress.yy[near], stress.xy[near]])
    depth = half_width * np.linspace(MIN_DEPTH, MAX_DEPTH, DEPTH_COUNT)
    line = place + depth * inward
    xx, yy, xy = LinearNDInterpolator(nodes[:, near].T, components)(np.column_stack([line.real, line.imag])).T
    shear = np.hypot(0.5 * (xx - yy), xy)
    deepest = int(np.nanargmax(shear))
    return float(shear[deepest]), float(depth[deepest])
