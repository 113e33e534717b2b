"""Extruded bodies pressed together: a flat patch, point contact of Hertz, mirror images, energies, floating bodies."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
from refusals import error_says

from fem.contact.coupling import Pose, integrate_pair
from fem.contact.unilateral import ContactProblem, solve_floating_contact
from fem.errors import MeshError
from fem.shapes import CircleCurve
from fem.solid.layers import Layers, graded_layers
from fem.solid_contact.block import circle_height, graded_columns, graded_rows, make_block
from fem.solid_contact.bodies import Face, condense_solid
from fem.solid_contact.pressing import opening_of_motion, press_faces, weighted_gap
from fem.solid_contact.widths import WidthGrid
from ltca.drive.parts import Material, contact_modulus

STEEL = Material(youngs_modulus=210e3, poisson_ratio=0.3)
RADIUS, CROWN = 10.0, 10.0


class Blocks:
    """Two blocks: a flat below, a crowned cylinder above; half of both by symmetry along x."""

    def __init__(self, edge, zone, extent, *, even, radius=RADIUS, flat=1e7):
        columns, count = graded_columns(edge, zone, extent)
        rows = graded_rows(edge, 0.5 * zone, extent)
        self.lower = make_block(
            "lower", circle_height(-1.0 / flat, 3 * zone), columns, count, rows, above=False, symmetric=True
        )
        self.upper = make_block(
            "upper", circle_height(1.0 / radius, 3 * zone), columns, count, rows, above=True, symmetric=True
        )
        heights = columns[: count + 1]
        self.width = WidthGrid(heights=heights if even else np.concatenate([-heights[:0:-1], heights]), even=even)
        parities = ("symmetric",) if even else ("symmetric", "antisymmetric")
        self.layers = [Layers(vertices=columns, parity=parity) for parity in parities]
        zone_below = self.lower.pressure_zone(CircleCurve(name="flat", radius=flat, centre=-1j * flat))
        zone_above = self.upper.opposite_zone(1j * radius)
        self.integrals = integrate_pair(zone_below, Pose(), Pose(centre=1j * radius), radius, zone_above)
        faces = (
            Face(plane=zone_below.load_shapes(2 * self.lower.section.node_count), width=self.width),
            Face(plane=self.upper.plane_loads(zone_above, self.integrals.opposite_loads), width=self.width),
        )
        self.bodies = tuple(
            condense_solid(block.section, self.layers, STEEL, [face], block.held)
            for block, face in zip((self.lower, self.upper), faces, strict=True)
        )

    def press(self, **options):
        def crown(z):
            return z**2 / (2.0 * CROWN)

        return press_faces(self.bodies, self.integrals, self.width, direction=1j, relief=crown, **options)


@pytest.fixture(scope="module")
def blocks():
    # Hertz contact of radius 0.1866 under 100 N: four elements for it.
    return Blocks(0.1866 / 4, 1.25 * 0.1866, 8 * 0.1866, even=False)


@pytest.mark.slow
def test_point_contact_is_that_of_hertz(blocks):
    # Half the load acts on the half that is meshed. Johnson (1985), Eqs. 4.22 to 4.24.
    load = 100.0
    modulus = contact_modulus(STEEL, STEEL)
    radius = (3.0 * load * RADIUS / (4.0 * modulus)) ** (1.0 / 3.0)
    peak = 3.0 * load / (2.0 * np.pi * radius**2)
    found = blocks.press(load=0.5 * load)
    assert found.load == pytest.approx(0.5 * load, rel=1e-12)
    # Both blocks end 8 radii away. A half-space yields there by F/(π E* 8a), 5.3 % of the approach; held at the bottom and
    # at two sides a block loses that and up to as much again.
    assert 0.89 < found.approach / (radius**2 / RADIUS) < 0.96
    # Linear hats on a quarter of the radius miss the top of the ellipsoid by h²|p″|/24 of a mean to h²|p″|/12 of a projection
    # in each direction, 0.5 %; the square-root rim costs as much again.
    assert found.pressure.max() == pytest.approx(peak, rel=0.02)
    # ⟨z²⟩ of an ellipsoid is a²/5; no more than a cell of h = a/4 is in doubt at the rim.
    weights = blocks.integrals.measure[:, None] * found.pressure
    second = np.array([blocks.width.moments(np.ones_like), blocks.width.moments(np.square)]) @ weights.sum(axis=0)
    assert second[1] / second[0] == pytest.approx(radius**2 / 5.0, rel=0.02)


@pytest.mark.slow
def test_tilting_a_crown_moves_the_contact(blocks):
    # A crown of radius R that tilts by θ rolls: the same contact, R θ further up, deeper by R θ²/2.
    straight, tilted = blocks.press(approach=3.0e-3), blocks.press(approach=3.0e-3, tilt=2e-3)
    moved = blocks.press(approach=3.0e-3 + 0.5 * CROWN * 2e-3**2, tilt=0.0)
    # Shifts of a tenth of a radius: what blocks are held by is not shifted, 2 % of the approach by a tenth of it.
    assert tilted.load == pytest.approx(moved.load, rel=5e-3)
    assert tilted.moment / tilted.load == pytest.approx(CROWN * 2e-3, rel=0.02)
    # Up is where z is positive: the centre of the pressures themselves.
    weights = blocks.integrals.measure @ tilted.pressure
    centre = weights @ blocks.width.moments(lambda z: z) / (weights @ blocks.width.moments(np.ones_like))
    assert centre == pytest.approx(tilted.moment / tilted.load, rel=1e-3)
    assert abs(straight.moment) <= 1e-12 * straight.load


@pytest.mark.slow
def test_a_mirrored_tilt_has_the_mirrored_pressure(blocks):
    up, down = blocks.press(load=40.0, tilt=3e-3), blocks.press(load=40.0, tilt=-3e-3)
    # Round-off of the condensation by the condition of the compliance, some 1e4.
    np.testing.assert_allclose(up.pressure, down.pressure[:, ::-1], atol=1e-9 * up.pressure.max())
    assert up.approach == pytest.approx(down.approach, rel=1e-10)
    assert up.moment == pytest.approx(-down.moment, rel=1e-10)
    # A moment given finds the tilt that it came from.
    again = blocks.press(load=40.0, moment=up.moment)
    assert again.tilt == pytest.approx(3e-3, rel=1e-8)


@pytest.mark.slow
def test_even_pressures_of_half_a_body_are_those_of_both_halves(blocks):
    half = Blocks(0.1866 / 4, 1.25 * 0.1866, 8 * 0.1866, even=True)
    one, both = half.press(approach=3e-3), blocks.press(approach=3e-3)
    np.testing.assert_allclose(one.pressure, both.pressure[:, both.pressure.shape[1] // 2 :], rtol=1e-8, atol=1e-6)
    assert one.load == pytest.approx(both.load, rel=1e-10)


@pytest.mark.slow
def test_energies_agree_and_their_slopes_are_the_loads(blocks):
    found = blocks.press(approach=3e-3, tilt=2e-3)
    # Where pressures act gaps are closed: an identity. The strain energy of the displacements is another way to the same.
    assert found.work == pytest.approx(found.energy, rel=1e-10)
    strain = sum(body.energy(found.solution.pressure) for body in blocks.bodies)
    assert strain == pytest.approx(found.energy, rel=1e-9)
    # Central differences of a smooth energy: (Δδ/δ)² = 1e-6, and cells that come and go.
    step, turn = 3e-6, 2e-6
    rise = blocks.press(approach=3e-3 + step, tilt=2e-3).energy - blocks.press(approach=3e-3 - step, tilt=2e-3).energy
    assert rise / (2.0 * step) == pytest.approx(found.load, rel=1e-4)
    rise = blocks.press(approach=3e-3, tilt=2e-3 + turn).energy - blocks.press(approach=3e-3, tilt=2e-3 - turn).energy
    assert rise / (2.0 * turn) == pytest.approx(found.moment, rel=1e-3)


@pytest.mark.slow
def test_surfaces_apart_press_nothing(blocks):
    found = blocks.press(approach=-1e-3)
    assert found.load == found.energy == 0.0
    assert not found.pressure.any()


def slab(parity, *, height=2.0, half=1.0, thickness=3.0, name="slab"):
    """A slab under a flat: its surface at y = 0, the body below."""
    columns = np.linspace(0.0, half, 4)
    block = make_block(name, lambda x: 0.0 * x, columns, 3, np.linspace(0.0, height, 4), above=False, symmetric=False)
    return block, graded_layers(thickness, 2, parity)


def test_a_flat_patch_is_pressed_evenly():
    # A slab between a rigid flat and its held bottom, free to slide there: σ = E ε exactly, whatever the mesh.
    height, half, thickness, approach = 2.0, 1.0, 3.0, 1e-3
    block, layers = slab("symmetric")
    width = WidthGrid(heights=layers.vertices, even=True)
    radius = np.inf
    zone = block.pressure_zone(CircleCurve(name="flat", radius=1e9, centre=-1e9j))
    integrals = integrate_pair(zone, Pose(), Pose(rotation=np.pi), radius, None)

    def held(body):
        # The bottom slides but for its middle; both ends of the axis are free.
        still = np.zeros(body.unknowns, dtype=bool)
        bottom = block.row_nodes(2 * block.rows)
        still[body.unknowns_of(bottom, 1).ravel()] = True
        still[body.unknowns_of(bottom[[bottom.size // 2]], 0).ravel()[0]] = True
        return still

    body = condense_solid(
        block.section, [layers], STEEL, [Face(plane=zone.load_shapes(2 * block.section.node_count), width=width)], held
    )
    found = press_faces((body,), integrals, width, direction=1j, approach=approach)
    expected = STEEL.youngs_modulus * approach / height
    # The radius of 1e9 mm is a flat to 1e-9; the rest is round-off.
    np.testing.assert_allclose(found.pressure, expected, rtol=1e-6)
    assert found.load == pytest.approx(expected * 2.0 * half * thickness, rel=1e-6)


@pytest.mark.family(quick=1)
@pytest.mark.parametrize("parities", [("symmetric", "antisymmetric"), ("whole",)])
def test_a_floating_slab_between_two_flats_is_pressed_evenly(parities):
    # Two faces on one body that nothing holds, pressed by the upper flat against the lower one: the same state twice.
    height, half, thickness, load = 2.0, 1.0, 3.0, 600.0
    columns = np.linspace(0.0, half, 4)
    block = make_block("slab", lambda x: 0.0 * x, columns, 3, np.linspace(0.0, height, 4), above=False, symmetric=False)
    layers = [graded_layers(thickness, 2, parity) for parity in parities]
    ends = layers[0].vertices
    heights = ends if "whole" in parities else np.concatenate([-ends[:0:-1], ends])
    width = WidthGrid(heights=heights, even=False)
    top = block.pressure_zone(CircleCurve(name="flat", radius=1e9, centre=-1e9j))
    plane = top.load_shapes(2 * block.section.node_count)
    # The same loads at the bottom, the other way.
    node = np.arange(block.section.node_count).reshape(2 * block.rows + 1, -1)[::-1].ravel()
    turned = sp.coo_matrix(plane)
    bottom = sp.csc_matrix((-turned.data, (2 * node[turned.row // 2] + turned.row % 2, turned.col)), shape=plane.shape)
    faces = [Face(plane=plane, width=width), Face(plane=bottom, width=width)]
    body = condense_solid(block.section, layers, STEEL, faces, None)
    integrals = integrate_pair(top, Pose(), Pose(rotation=np.pi), np.inf, None)
    push = opening_of_motion(integrals, width, 1j)
    nothing = np.zeros(push.size)
    # Motions: the upper flat down, and the six of the slab.
    motions = np.column_stack([np.concatenate([push, nothing]), body.motions])
    assert body.motions.shape == (2 * push.size, 6)
    problem = ContactProblem(
        compliance=body.compliance,
        gap=np.concatenate([weighted_gap(integrals, width)] * 2),
        motions=motions,
        external=np.concatenate([[load], np.zeros(6)]),
    )
    found = solve_floating_contact(problem, np.ones(problem.gap.size, dtype=bool))
    expected = load / (2.0 * half * thickness)
    np.testing.assert_allclose(found.pressure, expected, rtol=1e-6)
    # The slab yields by σ h/E between the flats.
    assert -found.motion[0] == pytest.approx(expected * height / STEEL.youngs_modulus, rel=1e-6)


def test_moments_of_hats_are_those_by_hand():
    width = WidthGrid(heights=np.array([-1.0, 0.0, 2.0]), even=False)
    # Triangles of height 1 over 1, 3 and 2 mm.
    np.testing.assert_allclose(width.moments(np.ones_like), [0.5, 1.5, 1.0], rtol=1e-14)
    # ∫χ z dz by centroids: −1/2·2/3, −1/2·1/3 + 1·2/3, 1·4/3.
    np.testing.assert_allclose(width.moments(lambda z: z), [-1.0 / 3.0, 0.5, 4.0 / 3.0], rtol=1e-14)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: WidthGrid(heights=np.array([0.0, 0.0]), even=False), "ascending"),
        (lambda: WidthGrid(heights=np.array([1.0, 2.0]), even=True), "must be 0"),
        (lambda: WidthGrid(heights=np.array([-1.0, 0.0, 2.0]), even=False).classes(), "meshed whole"),
        (lambda: WidthGrid(heights=np.array([-1.0, 1.0]), even=False).classes(), "vertex at 0"),
        (lambda: graded_columns(2.0, 1.0, 3.0), "ascending"),
    ],
)
def test_what_cannot_be_is_refused(make, words):
    with error_says(MeshError, words):
        make()


def test_pressures_that_tilt_need_the_antisymmetric_class():
    block, layers = slab("symmetric")
    ends = layers.vertices
    width = WidthGrid(heights=np.concatenate([-ends[:0:-1], ends]), even=False)
    zone = block.pressure_zone(CircleCurve(name="flat", radius=1e9, centre=-1e9j))
    face = Face(plane=zone.load_shapes(2 * block.section.node_count), width=width)
    with pytest.raises(MeshError, match="'antisymmetric'"):
        condense_solid(block.section, [layers], STEEL, [face], block.held)
