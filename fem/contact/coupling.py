r"""Integrals over one contact pair: exact gaps, resultants and loads on the side opposite.

Each point x of the pressure zone looks along its exact outward normal n; the first point y on that ray of the
circle (or flat) opposite is its partner. Pressure acts as the pair of forces −p n at x and +p n at y on one line
of action, so forces and moments balance pair by pair. The weighted gap of pressure unknown i is

.. math:: g_i = t \int \varphi_i\, n \cdot (y - x)\, ds, \qquad
          \delta g_i = t \int \varphi_i\, n \cdot (u_y - u_x)\, ds,

with the same weights on both sides. The integration runs over segments between the vertices of *both*
surfaces (mortar segments), so that no shape function has a kink inside one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem.body.surface import GAUSS_POINTS, GAUSS_WEIGHTS, OppositeZone, PressureZone
from ltca.arrays import ComplexArray, FloatArray

# Gap of a ray that misses the circle, mm: far beyond any approach.
NO_PARTNER = 1.0e3


@dataclass(frozen=True, slots=True, kw_only=True)
class Pose:
    """Place of a body frame in the fixed frame.

    Attributes
    ----------
    centre : complex
        mm.
    rotation : float
        rad.
    """

    centre: complex = 0j
    rotation: float = 0.0

    def place(self, points: ComplexArray) -> ComplexArray:
        """Return points of the body in the fixed frame, mm."""
        return self.centre + self.turn(points)

    def turn(self, directions: ComplexArray) -> ComplexArray:
        """Return directions of the body in the fixed frame."""
        return np.asarray(directions * np.exp(1j * self.rotation))


@dataclass(frozen=True, slots=True, kw_only=True)
class PairIntegrals:
    """Integrals of one pair at one pose, for each of its m pressure unknowns.

    Attributes
    ----------
    gap : array, shape (m,)
        Weighted gap, mm for a unit force resultant times MPa: mm·mm².
    measure : array, shape (m,)
        Weighted area t ∫ φ ds, mm².
    force : array, shape (3, m)
        Force in x, y (N/MPa) and moment about the fixed origin (N·mm/MPa) on the side opposite; the pressure
        side takes the opposite.
    opposite_loads : array, shape (2 k, m)
        Nodal forces on the k nodes of the zone opposite in its body frame, node by node (empty for a rigid side).
    """

    gap: FloatArray
    measure: FloatArray
    force: FloatArray
    opposite_loads: FloatArray


def gap_to_opposite(points: ComplexArray, normals: ComplexArray, pose: Pose, radius: float) -> FloatArray:
    """Return the distance along unit normals to the body opposite, mm; negative inside it. Points are in the fixed frame.

    `pose` is that of the body opposite: the centre of its circle of `radius` (mm), or for an infinite radius a point of its flat,
    whose outward normal is the y axis of the body.
    """
    if np.isinf(radius):
        outward = 1j * np.exp(1j * pose.rotation)
        return np.asarray(((pose.centre - points) * np.conj(outward)).real / (normals * np.conj(outward)).real)
    away = (pose.centre - points) * normals.conjugate()
    reach = radius**2 - away.imag**2
    return np.where(reach > 0.0, away.real - np.sqrt(np.maximum(reach, 0.0)), NO_PARTNER)


def integrate_pair(
    zone: PressureZone,
    pose: Pose,
    opposite_pose: Pose,
    radius: float,
    opposite: OppositeZone | None,
) -> PairIntegrals:
    """Integrate gaps and loads of a pair over mortar segments.

    `zone` carries the pressure on a body at `pose`; the body opposite has the exact radius `radius` (mm, infinite for a flat) at
    `opposite_pose` (see `gap_to_opposite`), and the meshed zone `opposite`, None for a rigid one.
    """
    breaks = np.arange(zone.edge_count + 1, dtype=float)
    if opposite is not None:
        breaks = _segment_ends(zone, pose, opposite_pose, radius, opposite)
    length = np.diff(breaks)
    place = (breaks[:-1, None] + length[:, None] * GAUSS_POINTS).ravel()
    weight = (length[:, None] * GAUSS_WEIGHTS).ravel()
    edge = np.minimum(np.floor(0.5 * (breaks[1:] + breaks[:-1])).astype(np.int64), zone.edge_count - 1)
    edge = np.repeat(edge, len(GAUSS_POINTS))
    xi = place - edge
    meshed, speed = zone.points(edge, xi)
    exact, normal = zone.exact(meshed)
    points, normals = pose.place(exact), pose.turn(normal)
    gap = gap_to_opposite(points, normals, opposite_pose, radius)
    area = zone.thickness * weight * speed
    partner = points + np.where(gap < NO_PARTNER, gap, 0.0) * normals
    moment = (partner.conjugate() * normals).imag
    count = zone.unknown_count
    sums = [np.zeros(count) for _ in range(5)]
    nodes = 0 if opposite is None else len(opposite.nodes)
    opposite_loads = np.zeros((2 * nodes, count))
    if opposite is not None:
        local = np.exp(-1j * opposite_pose.rotation)
        edge_opposite, shapes = opposite.shapes_at(_coordinates(partner, opposite_pose, radius, opposite))
        push = normals * local
    for vertex, hat in ((edge, 1.0 - xi), (edge + 1, xi)):
        inner, column = zone.unknowns_at(vertex)
        share = (area * hat)[inner]
        for total, value in zip(sums, (gap, np.ones_like(gap), normals.real, normals.imag, moment), strict=True):
            total += np.bincount(column, weights=share * value[inner], minlength=count)
        if opposite is not None:
            for corner in range(3):
                row = 2 * (2 * edge_opposite[inner] + corner)
                amount = share * shapes[corner, inner] * push[inner]
                np.add.at(opposite_loads, (row, column), amount.real)
                np.add.at(opposite_loads, (row + 1, column), amount.imag)
    return PairIntegrals(gap=sums[0], measure=sums[1], force=np.array(sums[2:]), opposite_loads=opposite_loads)


def _coordinates(partner: ComplexArray, pose: Pose, radius: float, opposite: OppositeZone) -> FloatArray:
    """Return coordinates of partners along the zone opposite; angles unwrapped about its middle."""
    local = (partner - pose.centre) * np.exp(-1j * pose.rotation)
    if np.isinf(radius):
        return np.asarray(local.real)
    middle = 0.5 * (opposite.coordinates[0] + opposite.coordinates[-1])
    return np.asarray(middle + np.angle(local * np.exp(-1j * middle)))


def _segment_ends(
    zone: PressureZone, pose: Pose, opposite_pose: Pose, radius: float, opposite: OppositeZone
) -> FloatArray:
    """Return vertices of both surfaces as places along the pressure zone, increasing, without repetition."""
    # Where the rays of vertices and middles meet the circle is a smooth function of the place; a vertex of the
    # circle found by its inverse is off by far less than an edge, and the integrand has only a kink there.
    ends: FloatArray = 0.5 * np.arange(2 * zone.edge_count + 1, dtype=float)
    edge = np.minimum(ends.astype(np.int64), zone.edge_count - 1)
    meshed, _ = zone.points(edge, ends - edge)
    exact, normal = zone.exact(meshed)
    points, normals = pose.place(exact), pose.turn(normal)
    gap = gap_to_opposite(points, normals, opposite_pose, radius)
    hit = gap < NO_PARTNER
    coordinates = _coordinates(points[hit] + gap[hit] * normals[hit], opposite_pose, radius, opposite)
    places = ends[hit]
    if len(places) < 2:
        return np.arange(zone.edge_count + 1, dtype=float)
    if coordinates[-1] < coordinates[0]:
        coordinates, places = coordinates[::-1], places[::-1]
    vertices = opposite.vertices
    inside = vertices[(vertices > coordinates[0]) & (vertices < coordinates[-1])]
    found = np.interp(inside, coordinates, places)
    ends = np.unique(np.concatenate([np.arange(zone.edge_count + 1, dtype=float), found]))
    return np.asarray(ends[np.concatenate([[True], np.diff(ends) > 1e-9])])
