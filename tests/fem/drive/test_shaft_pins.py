"""Meshes of elastic shaft pins: graded where the hole presses, by the half-width, coarse elsewhere."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from fem.drive.meshes import ELEMENTS_PER_HALF_WIDTH
from fem.drive.shaft_pins import mesh_shaft_pins
from fem.shapes import CircleShape

RADIUS, WIDTH, DIRECTION = 7.0, 0.2, 2.1


def rim(body):
    """Angles of the middles of the edges on the surface, and their lengths."""
    nodes = body.mesh.doflocs[0] + 1j * body.mesh.doflocs[1]
    chain = body.boundary_nodes("surface")
    return np.angle(nodes[chain[:, 1]]), np.abs(nodes[chain[:, 2]] - nodes[chain[:, 0]])


@pytest.mark.parametrize("scale", [1.0, 2.0])
def test_loaded_pins_are_graded_toward_their_holes(scale):
    shapes = SimpleNamespace(shaft_pins=[CircleShape(name=f"shaft_pin_{k}", radius=RADIUS) for k in range(2)])
    holes = SimpleNamespace(half_width=np.array([WIDTH, 0.0]), direction=np.array([DIRECTION, 0.3]))
    meshes = mesh_shaft_pins(shapes, SimpleNamespace(holes=holes), scale)
    loaded, idle = (mesh.placed(f"shaft_pin_{k}") for k, mesh in enumerate(meshes))
    angle, length = rim(loaded)
    away = np.abs(np.angle(np.exp(1j * (angle - DIRECTION))))
    wanted = scale * WIDTH / ELEMENTS_PER_HALF_WIDTH
    under = length[away * RADIUS < WIDTH]
    # whole numbers of edges: never longer than asked for, a tenth shorter at most
    assert np.all(under < 1.02 * wanted)
    assert under.mean() > 0.85 * wanted
    assert length[away > 1.0].min() > 5.0 * wanted
    assert rim(idle)[1].min() > 5.0 * wanted
