r"""The ring of the pin wheel as a plane body: loads of pins on its seats, of bolts on patches, flexibility between them.

A force F of a pin on its seat acts as normal pressure on the wall of the seat's outer half,

.. math:: p = n \cdot M F, \qquad M^{-1} = \int n\, n^T ds,

n being the direction from the seat's centre: :math:`p = \frac{2F}{\pi r b} \cos\theta` for a force outwards, as in a conforming
seat without play. The seat's displacement is the mean with the same weights, the motion of a rigid pin that fits the normal
displacement of that wall best; so load and measure are dual and the flexibility is symmetric. It holds for both senses of
the force: pins are taken as seated without play. Bolts hold the mean displacement of a small round patch.

Plane stress; everything is for E b = 1 N/mm, and scales with 1/(E b).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import gcd

import numpy as np
import scipy.sparse as sp

from fem.body.condensation import condense_body
from fem.body.elasticity import assemble_stiffness, loads_by_nodes, unknowns_of_boundary
from fem.body.sparse_factor import factor_sparse
from fem.body.surface import GAUSS_POINTS, GAUSS_WEIGHTS, quadratic_shapes, quadratic_slopes
from fem.mesh.body_mesh import BodyMesh
from fem.mesh.element_size import Refinement
from fem.mesh.memory_need import require_memory, solution_memory
from fem.mesh.triangulation import default_coarse_size, estimate_unknowns, mesh_pin_ring
from fem.mesh.uniform_refinement import CHILDREN, refine_uniformly
from fem.shapes import PinRingShape, SlottedCircle
from ltca.arrays import ComplexArray, FloatArray
from ltca.drive.materials import Material
from ltca.drive.parts import Drive
from ltca.drive.ring_shape import bolt_patch_radius, ring_mesh_problems, seat_radius
from ltca.errors import DriveError
from ltca.reading.ring_file import rigid_motions

SEAT_EDGE = 0.1
"""Element edge at the wall of a seat by the radius of the seat, on a mesh of size 1."""
PATCH_EDGE = 0.4
"""Element edge at a bolt by the radius of its patch."""
GROWTH = 0.4


@dataclass(frozen=True, slots=True, kw_only=True)
class DerivedRing:
    """Flexibility of a ring of E b = 1 N/mm.

    Attributes
    ----------
    flexibility : array, shape (places, 2, places, 2)
        Displacement (x, y) of seats, then bolts, by unit forces there; of a free ring beyond the rigid motion that fits all
        places best, and for forces without their part dual to it.
    turned, mirror : float
        Largest difference of entries that the rotations of the ring, and its mirror image, make equal, before their mean is
        taken; of the largest entry: errors of the mesh.
    unknowns : int
        Of the mesh.
    """

    flexibility: FloatArray
    turned: float
    mirror: float
    unknowns: int


def ring_of_drive(drive: Drive) -> PinRingShape:
    """Return the shape of the ring of a drive with the seats of its pins, all of nominal radius and place.

    DriveError for a drive without ring, and for a ring that cannot be meshed.
    """
    ring, wheel = drive.ring, drive.pin_wheel
    if ring is None:
        raise DriveError(["ring: is left out in this drive; there is no ring to derive"])
    if problems := [*ring_mesh_problems(drive)]:
        raise DriveError(problems)
    inner = SlottedCircle(
        radius=ring.inner_radius,
        seats=wheel.number_of_pins,
        seat_circle_radius=wheel.pin_circle_radius,
        seat_radius=seat_radius(wheel),
    )
    return PinRingShape(inner=inner, outer_radius=ring.outer_radius)


def bolts_of_drive(drive: Drive) -> ComplexArray:
    """Return the places of the bolts of the ring, mm; none where it has none."""
    bolts = None if drive.ring is None else drive.ring.bolts
    if bolts is None:
        return np.zeros(0, dtype=complex)
    return np.asarray(bolts.circle_radius * np.exp(2j * np.pi * np.arange(bolts.number) / bolts.number))


def flexibility_of(
    shape: PinRingShape,
    bolts: ComplexArray,
    patch: float,
    poisson_ratio: float,
    *,
    held: bool = False,
    size: float = 1.0,
) -> DerivedRing:
    """Return the flexibility of a plane ring at its seats and at bolts (places in mm, patches of radius `patch`).

    With `held` the outer face is fixed. All seats are loaded on one factorised mesh; what the symmetry of the ring makes equal is
    averaged.
    """
    body, stiffness, loads = _meshed(shape, bolts, patch, poisson_ratio, size)
    fixed = unknowns_of_boundary(body, "outer") if held else None
    inner = shape.inner
    found = condense_body(body, stiffness, loads, fixed=fixed).compliance
    places = np.concatenate([inner.seat_centres, bolts])
    if not held:
        found = without_rigid_motions(found, places)
    found = found.reshape(len(places), 2, len(places), 2)
    even, turned, mirror = _symmetrised(found, inner.seats, len(bolts))
    return DerivedRing(flexibility=even, turned=turned, mirror=mirror, unknowns=body.unknowns)


def seat_flexibility(drive: Drive, size: float = 1.0, *, halvings: int = 0) -> FloatArray:
    """Return the displacement (x, y) of the seats of the ring of a drive by unit forces at them, bolts included, mm/N.

    Shape (2 seats, 2 seats), by seat and component in the wheel; of a ring that floats beyond the rigid motion that fits the
    seats best. Bolts are springs in the stiffness of the mesh itself. The mesh of a size is refined uniformly `halvings` times.
    DriveError for a drive without ring.
    """
    shape, bolts, ring = ring_of_drive(drive), bolts_of_drive(drive), drive.ring
    assert ring is not None
    unit = ring.material.youngs_modulus * ring.width
    patch = bolt_patch_radius(drive)
    body, stiffness, loads = _meshed(shape, bolts, patch, ring.material.poisson_ratio, size, halvings)
    seats = loads[:, : 2 * shape.inner.seats]
    if ring.bolts is None:
        fixed = unknowns_of_boundary(body, "outer") if ring.flange == "built-in" else None
        found = condense_body(body, stiffness, seats, fixed=fixed).compliance
        return (found if fixed is not None else without_rigid_motions(found, shape.inner.seat_centres)) / unit
    springs = loads[:, 2 * shape.inner.seats :]
    held = (stiffness + ring.bolts.stiffness / unit * (springs @ springs.T)).tocsc()
    found = seats.T @ factor_sparse(held).solve(seats.toarray())
    return np.asarray(0.5 * (found + found.T) / unit)


def _meshed(
    shape: PinRingShape, bolts: ComplexArray, patch: float, poisson_ratio: float, size: float, halvings: int = 0
) -> tuple[BodyMesh, sp.csc_matrix, sp.csc_matrix]:
    """The mesh of a ring, its stiffness for E b = 1 N/mm, and unit forces on seats, then on bolts."""
    body, inner = mesh_ring_for_seats(shape, bolts, patch, size), shape.inner
    for _ in range(halvings):
        unknowns = CHILDREN * body.unknowns
        require_memory(unknowns, solution_memory(unknowns), "the refined ring for its flexibility")
        body = refine_uniformly(body, shape.curves)
    steel = Material(youngs_modulus=1.0, poisson_ratio=poisson_ratio)
    loads = sp.hstack([seat_loads(body, inner), *(_patch_load(body, bolt, patch) for bolt in bolts)], format="csc")
    return body, assemble_stiffness(body, steel, thickness=1.0, state="stress"), loads


def mesh_ring_for_seats(
    shape: PinRingShape, bolts: ComplexArray, patch: float, size: float = 1.0, *, order: int = 2
) -> BodyMesh:
    """Mesh a ring, fine at its seats and at the patches of its bolts; `size` is a multiple of all element edges."""
    inner = shape.inner
    balls = [
        _ball(centre, SEAT_EDGE * size * inner.seat_radius, 1.1 * inner.seat_radius) for centre in inner.seat_centres
    ]
    balls += [_ball(bolt, PATCH_EDGE * size * patch, patch) for bolt in bolts]
    coarse = default_coarse_size(shape, size)
    unknowns = estimate_unknowns(shape, balls, coarse_size=coarse, growth=GROWTH)
    require_memory(unknowns, solution_memory(unknowns), "the ring for its flexibility")
    return mesh_pin_ring(shape, balls, coarse_size=coarse, growth=GROWTH, order=order)


def without_rigid_motions(flexibility: FloatArray, places: ComplexArray) -> FloatArray:
    """Return a flexibility of places (x, y by place) beyond the rigid motion that fits them best, shape as given."""
    base, _ = np.linalg.qr(rigid_motions(places))
    once = flexibility - base @ (base.T @ flexibility)
    found = once - (once @ base) @ base.T
    return np.asarray(0.5 * (found + found.T))


def _ball(centre: complex, edge: float, radius: float) -> Refinement:
    return Refinement(float(centre.real), float(centre.imag), float(edge), float(radius))


def seat_loads(body: BodyMesh, inner: SlottedCircle) -> sp.csc_matrix:
    """Return nodal forces of unit forces in x and y on every seat, shape (unknowns, 2 seats), by seat and component."""
    nodes = body.boundary_nodes(inner.name)
    corner = body.places[nodes]
    number = np.round(np.angle(corner[:, 1]) / inner.pitch).astype(int) % inner.seats
    centre = inner.seat_centres[number]
    arm = (corner - centre[:, None]) * np.exp(-1j * inner.pitch * number)[:, None]
    own = np.abs(np.abs(arm[:, 1]) - inner.seat_radius) < 1e-6 * inner.seat_radius
    # From where to where, by its coordinate ξ, an edge lies on the loaded half; angles are even along an edge.
    middle = np.angle(arm[:, 1])
    first, last = (middle + np.angle(arm[:, end] / arm[:, 1]) for end in (0, 2))
    limits = np.stack([-inner.loaded_half_arc - first, inner.loaded_half_arc - first]) / (last - first)
    start, end = np.clip(np.sort(limits, axis=0), 0.0, 1.0)
    own &= end > start
    nodes, corner, number, centre = nodes[own], corner[own], number[own], centre[own]
    start, end = start[own, None], end[own, None]
    at = start + (end - start) * GAUSS_POINTS
    shapes, slopes = quadratic_shapes(at), quadratic_slopes(at)  # (3, edges, points)
    points = np.einsum("ek,keq->eq", corner, shapes)
    length = np.abs(np.einsum("ek,keq->eq", corner, slopes)) * (end - start) * GAUSS_WEIGHTS
    normal = (points - centre[:, None]) / np.abs(points - centre[:, None])
    pair = np.stack([normal.real, normal.imag])  # (2, edges, points)
    # ∫ n nᵀ ds of every seat.
    share = np.einsum("aeq,beq,eq->eab", pair, pair, length)
    whole = np.zeros((inner.seats, 2, 2))
    np.add.at(whole, number, share)
    by_force = np.linalg.inv(whole)[number]
    # Nodal forces ∫ N n (n · M F) ds, by edge, node, component, component of F.
    forces = np.einsum("keq,aeq,beq,eq,ebc->ekac", shapes, pair, pair, length, by_force)
    edges = len(nodes)
    rows = 2 * nodes[:, :, None, None] + np.arange(2)[:, None]
    columns = 2 * number[:, None, None, None] + np.arange(2)
    size = (edges, 3, 2, 2)
    placed = (np.broadcast_to(rows, size).ravel(), np.broadcast_to(columns, size).ravel())
    return sp.csc_matrix((forces.ravel(), placed), shape=(body.unknowns, 2 * inner.seats))


def _patch_load(body: BodyMesh, centre: complex, radius: float) -> sp.csc_matrix:
    """Nodal forces of unit forces in x and y over a round patch, shape (unknowns, 2); densest in its middle, 1 − (d/r)²."""
    nodes = body.element_nodes.T
    near = np.flatnonzero(np.min(np.abs(body.places[nodes] - centre), axis=0) < radius)

    def dense(x: FloatArray, y: FloatArray) -> FloatArray:
        return np.maximum(1.0 - ((x - centre.real) ** 2 + (y - centre.imag) ** 2) / radius**2, 0.0)

    amounts = loads_by_nodes(body, dense, near)
    amounts = amounts / amounts.sum()
    load = np.zeros((body.unknowns, 2))
    load[0::2, 0] = load[1::2, 1] = amounts
    return sp.csc_matrix(load)


def _symmetrised(found: FloatArray, seats: int, bolts: int) -> tuple[FloatArray, float, float]:
    """The mean over the rotations and the mirror image of the ring, and the largest differences from them."""
    largest, turns = float(np.max(np.abs(found))), gcd(seats, bolts)

    def moved(matrix: FloatArray, steps: int) -> FloatArray:
        """The matrix of the ring turned by `steps` of its rotations."""
        angle = 2.0 * np.pi * steps / turns
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        order = np.concatenate(
            [
                (np.arange(count) - steps * count // turns) % max(count, 1) + first
                for count, first in ((seats, 0), (bolts, seats))
            ]
        ).astype(int)
        rolled = matrix[order][:, :, order]
        return np.asarray(np.einsum("ac,icjd,bd->iajb", turn, rolled, turn))

    even = np.mean([moved(found, steps) for steps in range(turns)], axis=0)
    turned = float(np.max(np.abs(found - even))) / largest
    flip = np.concatenate([-np.arange(seats) % seats, seats + -np.arange(bolts) % max(bolts, 1)]).astype(int)
    sign = np.array([1.0, -1.0])
    image = even[flip][:, :, flip] * sign[:, None, None] * sign
    mirror = float(np.max(np.abs(even - image))) / largest
    return 0.5 * (even + image), turned, mirror
