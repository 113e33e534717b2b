"""Gaps between displaced surfaces: closed forms of bodies that move without strain."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from fem.solid.extruded import ExtrudedBody
from fem.solid.layers import Layers
from fem.solid_contact.block import circle_height, graded_columns, graded_rows, make_block
from fem.solid_contact.displaced import surface_gaps, weighted_correction
from fem.solid_contact.pair_shapes import SolidPair
from fem.solid_contact.widths import WidthGrid
from ltca.drive.parts import Material

RADIUS, CURVATURE, APPROACH, SHIFT = 1.0, 0.4, 0.01, 0.004
HEIGHTS = np.array([0.0, 0.3, 0.5])


class Moved:
    """A body that moves along x and y as a whole, in the place of one that is condensed."""

    def __init__(self, block, across, down):
        body = ExtrudedBody(section=block.section, layers=Layers(vertices=HEIGHTS, parity="symmetric"))
        everywhere = np.arange(block.section.node_count)
        moved = np.zeros(body.unknowns)
        moved[body.unknowns_of(everywhere, 0)] = across
        moved[body.unknowns_of(everywhere, 1)] = down
        self.classes = (SimpleNamespace(body=body, displacement=lambda _: moved),)


@pytest.fixture(scope="module")
def blocks():
    columns, zone = graded_columns(0.025, 0.2, 1.0)
    rows = graded_rows(0.025, 0.1, 1.0)
    shapes = [circle_height(CURVATURE, 0.5), circle_height(1.0 / RADIUS, 0.5)]
    return tuple(
        make_block("block", shape, columns, zone, rows, above=above, symmetric=False)
        for shape, above in zip(shapes, (False, True), strict=True)
    )


def gaps_of(blocks, own, opposite):
    steel = Material(youngs_modulus=210e3, poisson_ratio=0.3)
    pair = SolidPair.round_bodies(RADIUS, CURVATURE, steel, 1.0)
    pressed = SimpleNamespace(approach=APPROACH, tilt=0.0, solution=SimpleNamespace(pressure=np.zeros(1)))
    width = WidthGrid(heights=HEIGHTS, even=True)
    bodies = (Moved(blocks[0], *own), Moved(blocks[1], *opposite))
    found = surface_gaps(pair, blocks, width, bodies, pressed)
    nodes = np.unique(blocks[0].surface_edges)
    x = blocks[0].section.places[0, nodes]
    return x, found, weighted_correction(blocks[0].pressure_zone(pair.curve), width, found)


def circle(radius, x):
    return radius - np.sqrt(radius**2 - x**2)


def test_a_sideways_shift_of_the_body_opposite(blocks):
    """The gap is that of two circles of which one stands aside: known to round-off but for the interpolation of shapes."""
    x, found, _ = gaps_of(blocks, (0.0, 0.0), (SHIFT, 0.0))
    exact = circle(RADIUS, x - SHIFT) - APPROACH - circle(1.0 / CURVATURE, x)
    onto_normal = np.sqrt(1.0 - (CURVATURE * x) ** 2)
    for column in found.displaced.T:
        assert column == pytest.approx(exact * onto_normal, abs=1e-12)
    # The linear gap knows of the shift along the normals alone, and partners that do not turn: it misses x s / r.
    missed = (circle(RADIUS, x - SHIFT) - circle(RADIUS, x)) + CURVATURE * x * SHIFT
    partners = (1.0 / RADIUS - CURVATURE) * x * CURVATURE * x * APPROACH
    assert found.correction[:, 0] == pytest.approx(missed + partners, abs=0.12 * np.abs(missed).max())


def test_both_bodies_moved_alike_keep_the_displaced_gap(blocks):
    _, still, _ = gaps_of(blocks, (0.0, 0.0), (0.0, 0.0))
    _, moved, _ = gaps_of(blocks, (SHIFT, -0.02), (SHIFT, -0.02))
    assert moved.displaced == pytest.approx(still.displaced, abs=1e-12)


def test_the_weighted_correction_is_its_integral(blocks):
    """Hats add up to one: all of them together are the integral over the face, here by Simpson's rule."""
    x, found, weighted = gaps_of(blocks, (0.0, 0.0), (SHIFT, 0.0))
    speed = 1.0 / np.sqrt(1.0 - (CURVATURE * x) ** 2)
    values = found.correction[:, 0] * speed
    step = 0.5 * np.diff(x)[::2].mean() * 2.0
    integral = step / 3.0 * np.sum(values[:-2:2] + 4.0 * values[1:-1:2] + values[2::2])
    # Both halves of the width, 0.5 mm each.
    assert weighted.sum() == pytest.approx(integral, rel=1e-6)
