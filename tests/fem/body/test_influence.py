"""Blocks of influence against the dense condensation of all loads, plain products and plain solves."""

import numpy as np
import pytest
import scipy.sparse as sp
import scipy.sparse.linalg as spla

from fem.body.condensation import condense_body, order_nodes
from fem.body.elasticity import area_loads, assemble_stiffness, rigid_modes
from fem.body.free_body import boundary_motion_loads
from fem.body.influence import PANEL, influence_of_loads, sum_products
from fem.mesh.element_size import Refinement
from fem.mesh.triangulation import mesh_ring
from fem.shapes import RingShape
from ltca.drive.parts import Material

STEEL = Material(youngs_modulus=206_000.0, poisson_ratio=0.3)
SAMPLED = np.array([0, 7, 40])
AREA, BORE = 0, 1


@pytest.fixture(scope="module")
def ring():
    """A ring with single forces on its outside and pairs that balance each other."""
    shape = RingShape(inner_radius=10.0, outer_radius=20.0, name="ring")
    body = mesh_ring(shape, [Refinement(20.0, 0.0, 0.3, 0.5)], coarse_size=4.0)
    stiffness = assemble_stiffness(body, STEEL, thickness=11.8)
    nodes = body.boundary_nodes("outer")[:, 0]
    loaded = np.concatenate([2 * nodes, 2 * nodes + 1])
    each = sp.csc_matrix((np.ones(len(loaded)), (loaded, np.arange(len(loaded)))), shape=(body.unknowns, len(loaded)))
    single, pairs = each[:, :-11], each[:, -11:-1] - each[:, -10:]
    return body, stiffness, sp.hstack([single, 1e6 * pairs], format="csc")


@pytest.fixture(scope="module")
def influence(ring):
    body, stiffness, loads = ring
    shapes = [sp.csc_matrix(area_loads(body)), boundary_motion_loads(body, "inner")]
    count = loads.shape[1]
    every = sp.hstack([loads, *shapes], format="csc")
    amounts = sp.eye_array(count + 6, format="csc")
    datums = [amounts[:, count : count + 3], amounts[:, count + 3 :]]
    return influence_of_loads(body.places, stiffness, every, datums, SAMPLED, order=order_nodes(body))


@pytest.fixture(scope="module")
def condensed(ring):
    """The former way: all loads and the motions of the bore condensed together, then referred to the bore."""
    body, stiffness, loads = ring
    motions = boundary_motion_loads(body, "inner")
    found = condense_body(body, stiffness, sp.hstack([loads, motions], format="csc"))
    count = loads.shape[1]
    gram = rigid_modes(body).T @ motions
    transform = np.vstack([np.eye(count), -np.linalg.solve(gram, found.resultants[:, :count])])
    return found.compliance[:count, :count], transform.T @ found.compliance @ transform


# Both are direct solutions of one matrix, whose condition number is about 1e5.
ROUND_OFF = 1e-10


def test_blocks_are_those_of_the_dense_condensation(ring, influence, condensed):
    count = ring[2].shape[1]
    single, pairs = slice(0, count - 10), slice(count - 10, count)
    for datum, whole in zip((AREA, BORE), condensed, strict=True):
        for rows, columns in ((single, single), (pairs, single), (single, pairs), (pairs, pairs)):
            block = influence.block(rows, columns, datum)
            np.testing.assert_allclose(block, whole[rows, columns], atol=ROUND_OFF * np.abs(whole[rows, columns]).max())
        np.testing.assert_allclose(influence.own(single, datum), np.diag(whole)[single], rtol=ROUND_OFF)


def test_datums_share_their_products(influence):
    some = slice(3, 30)
    for datum, block in enumerate(influence.in_every_datum(some)):
        np.testing.assert_array_equal(block, influence.block(some, some, datum))
        np.testing.assert_array_equal(block, block.T)


def test_sampled_displacements_are_solved_for(ring, influence):
    """Not read from the products that they are compared with: K u is the load, and the mean motion is taken off."""
    body, stiffness, loads = ring
    modes, area = rigid_modes(body), area_loads(body)
    force = loads[:, SAMPLED].toarray()
    force -= area @ np.linalg.solve(modes.T @ area, modes.T @ force)
    held = np.array([0, 1, 2 * int(np.argmax(np.abs(body.mesh.doflocs[0] - body.mesh.doflocs[0, 0]))) + 1])
    free = np.setdiff1d(np.arange(body.unknowns), held)
    u = np.zeros(force.shape)
    u[free] = spla.spsolve(stiffness[free][:, free], force[free])
    u -= modes @ np.linalg.solve(modes.T @ area, area.T @ u)
    expected = loads.T @ u
    np.testing.assert_allclose(influence.sampled[: loads.shape[1]], expected, atol=ROUND_OFF * np.abs(expected).max())


def test_resultants_are_those_of_the_loads(ring, influence):
    body, _, loads = ring
    found = influence.resultants[:, : loads.shape[1]]
    np.testing.assert_allclose(found, rigid_modes(body).T @ loads, atol=1e-12)


@pytest.mark.parametrize("density", [0.02, 0.3, 1.0])
def test_products_by_panels(density):
    """More columns than a panel has and no multiple of them, empty ones between them, rows without an entry."""
    random = np.random.default_rng(3)
    first, second = (
        sp.random_array((rows, 3 * PANEL + 17), density=density, rng=random, format="csc") for rows in (40, 25)
    )
    for empty in (first, second):
        empty.data[empty.indptr[200] : empty.indptr[220]] = 0.0
        empty.eliminate_zeros()
    first, second = sp.csc_matrix(first), sp.csc_matrix(second)
    # Sums of some hundred products of numbers below one.
    np.testing.assert_allclose(sum_products(first, second), (first @ second.T).toarray(), atol=1e-12)
    np.testing.assert_allclose(sum_products(first, first), (first @ first.T).toarray(), atol=1e-12)


def test_product_without_common_columns_is_zero():
    left, right = sp.csc_matrix(np.eye(4)[:, :3]), sp.csc_matrix((2, 3))
    assert not np.any(sum_products(left, right))
