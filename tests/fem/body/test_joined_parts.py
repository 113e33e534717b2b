"""Copies of parts joined to a core against the same mesh in one piece."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
from skfem import MeshTri

from fem.body.elasticity import assemble_stiffness, first_order_space, rigid_modes
from fem.body.influence import influence_of_loads
from fem.body.joined_parts import Part, join_parts, motions_of_copy, of_first_order
from fem.mesh.body_mesh import BodyMesh, triangle_mesh
from ltca.drive.parts import Material

STEEL = Material(youngs_modulus=206_000.0, poisson_ratio=0.3)
SECTORS = 5
# Direct solutions of matrices whose condition number is about 1e5.
ROUND_OFF = 1e-10


def sector(inner: float, outer: float, around: int, across: int, angle: float) -> BodyMesh:
    """A sector of a ring from the polar angle 0, or all of the ring, of straight quadratic triangles."""
    flat = MeshTri.init_tensor(np.linspace(0.0, 1.0, across + 1), np.linspace(0.0, 1.0, around + 1))
    places = (inner + (outer - inner) * flat.p[0]) * np.exp(1j * angle * flat.p[1])
    keep, numbers = np.unique(np.round(places, 9), return_index=True)[1], np.arange(len(places))
    if angle == 2.0 * np.pi:
        _, keep, numbers = np.unique(np.round(places, 9), return_index=True, return_inverse=True)
    else:
        keep = numbers
    kept = places[keep]
    mesh = triangle_mesh(np.vstack([kept.real, kept.imag]), numbers[flat.t].astype(np.int64), {}, order=2)
    return BodyMesh(name="sector", mesh=mesh)


def forces(body: BodyMesh, places: np.ndarray, directions: np.ndarray) -> sp.csc_matrix:
    """Single forces at the nodes at some places."""
    nodes = np.argmin(np.abs(body.places[:, None] - places), axis=0)
    assert np.max(np.abs(body.places[nodes] - places)) < 1e-9
    columns = np.tile(np.arange(len(places)), 2)
    rows = np.concatenate([2 * nodes, 2 * nodes + 1])
    return sp.csc_matrix(
        (np.concatenate([directions.real, directions.imag]), (rows, columns)), shape=(body.unknowns, len(places))
    )


@pytest.fixture(scope="module")
def both():
    """A ring whose outer half is of five sectors alike, with three loads on each, in pieces and as one."""
    pitch = 2.0 * np.pi / SECTORS
    turns = np.exp(1j * pitch * np.arange(SECTORS))
    cell, core = sector(2.0, 3.0, 4, 3, pitch), sector(1.0, 2.0, 4 * SECTORS, 3, 2.0 * np.pi)
    whole = sector(1.0, 3.0, 4 * SECTORS, 6, 2.0 * np.pi)
    at = 3.0 * np.exp(1j * pitch * np.array([0.25, 0.5, 0.75]))
    along = np.array([1.0, 1j, 0.6 - 0.8j])
    inside = np.exp(1j * pitch * np.array([0.5, 2.25]))
    count = 3 * SECTORS + 5
    shared = np.abs(np.abs(cell.places) - 2.0) < 0.06
    for angle in (0.0, pitch):
        shared |= np.abs((cell.places * np.exp(-1j * angle)).imag) < 1e-9
    stiffness = {
        name: assemble_stiffness(body, STEEL, thickness=11.8)
        for name, body in (("cell", cell), ("core", core), ("whole", whole))
    }
    part = Part(
        stiffness=stiffness["cell"],
        places=cell.places,
        loads=forces(cell, at, along),
        shared=np.flatnonzero(shared),
        turns=turns,
        shifts=np.zeros(SECTORS, dtype=complex),
        numbers=np.arange(3 * SECTORS).reshape(SECTORS, 3),
    )
    datum = sp.csc_matrix(rigid_modes(core)[:, :3] * (np.abs(np.repeat(core.places, 2)) < 1.2)[:, None])
    middle = Part(
        stiffness=stiffness["core"],
        places=core.places,
        loads=sp.hstack([forces(core, inside, along[:2]), datum], format="csc"),
        shared=np.arange(core.node_count),
        turns=np.ones(1, dtype=complex),
        shifts=np.zeros(1, dtype=complex),
        numbers=np.arange(3 * SECTORS, count)[None],
    )
    every = (turns[:, None] * at).ravel(), (turns[:, None] * along).ravel()
    by_ring = sp.csc_matrix(rigid_modes(whole) * (np.abs(np.repeat(whole.places, 2)) < 1.2)[:, None])
    loads = sp.hstack([forces(whole, *every), forces(whole, inside, along[:2]), by_ring], format="csc")
    return (middle, core), (part, cell), (whole, stiffness["whole"], loads)


def influence(places, stiffness, loads, beyond=None):
    amounts = sp.eye_array(loads.shape[1], format="csc")[:, -3:]
    return influence_of_loads(places, stiffness, loads, [amounts], np.array([0, 7, 16]), beyond=beyond)


def test_joined_copies_are_the_whole(both):
    (middle, _), (part, _), (whole, stiffness, loads) = both
    joined = join_parts(middle, [part], 1e-7)
    assert joined.unknowns == whole.unknowns
    assert len(joined.places) < whole.node_count
    found = influence(joined.places, joined.stiffness, joined.loads, joined.held)
    expected = influence(whole.places, stiffness, loads)
    every = slice(0, 3 * SECTORS + 2)
    one, other = found.block(every, every), expected.block(every, every)
    np.testing.assert_allclose(one, other, atol=ROUND_OFF * np.abs(other).max())
    np.testing.assert_array_equal(one, one.T)
    np.testing.assert_allclose(found.own(every), np.diag(other), atol=ROUND_OFF * np.abs(other).max())
    np.testing.assert_allclose(found.sampled[every], expected.sampled[every], atol=ROUND_OFF * np.abs(other).max())
    np.testing.assert_allclose(found.sampled[every], one[:, [0, 7, 16]], atol=ROUND_OFF * np.abs(other).max())
    np.testing.assert_allclose(found.resultants, expected.resultants, atol=1e-9)


def test_loads_that_a_copy_is_without_are_left_out(both):
    (middle, _), (part, _), _ = both
    numbers = part.numbers.copy()
    numbers[2, 1] = -1
    fewer = Part(**{name: getattr(part, name) for name in Part.__slots__} | {"numbers": numbers})
    joined, whole = (join_parts(middle, [each], 1e-7) for each in (fewer, part))
    assert joined.loads[:, part.numbers[2, 1]].nnz == 0
    rest = np.delete(np.arange(joined.loads.shape[1]), part.numbers[2, 1])
    assert abs(joined.loads[:, rest] - whole.loads[:, rest]).max() == 0.0


def test_linear_elements_are_the_softer_trial_space(both):
    """Loads do less work on a part of the displacements, alone or joined; the joined ones are linear on the whole mesh."""
    (middle, core), (part, cell), (whole, stiffness, loads) = both
    joined = join_parts(of_first_order(middle, core), [of_first_order(part, cell)], 1e-7)
    space = first_order_space(whole)
    vertices = whole.mesh.nvertices
    linear = influence(whole.places[:vertices], space.T @ stiffness @ space, space.T @ loads)
    found = influence(joined.places, joined.stiffness, joined.loads, joined.held)
    every = slice(0, 3 * SECTORS + 2)
    quadratic = influence(whole.places, stiffness, loads).own(every)
    np.testing.assert_allclose(found.own(every), linear.own(every), rtol=1e-9)
    assert np.all(found.own(every) < quadratic)
    assert np.all(found.own(every) > 0.3 * quadratic)


@pytest.mark.parametrize(
    ("turn", "shift"), [(1.0, 0.0), (np.exp(0.7j), 0.0), (1.0, 3.0 - 2.0j), (np.exp(-2.1j), 1.0 + 4.0j)]
)
def test_motions_of_a_copy(turn, shift):
    """Motions of the first copy, turned with it and taken in these amounts, are those of the whole at the places of the copy."""
    places = np.array([1.0 + 2.0j, -0.5j, 3.0])
    fields = np.stack([np.ones(3), 1j * np.ones(3), 1j * places])
    of_whole = np.stack([np.ones(3), 1j * np.ones(3), 1j * (turn * places + shift)])
    np.testing.assert_allclose(turn * (motions_of_copy(turn, shift).T @ fields), of_whole, atol=1e-14)
