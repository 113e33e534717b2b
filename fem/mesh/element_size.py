"""Size field of a body: balls of small elements that grow into a coarse interior.

The wanted edge at distance d from the centre of a ball is

.. math:: h(d) = \\min(h_{coarse}, h_0 + g \\max(0, d - r_0)),

the smallest value over all balls counts. gmsh knows the same law as its field "Ball", so that boundary and
interior follow one rule.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from fem.errors import MeshError
from ltca.arrays import ComplexArray, FloatArray

DEFAULT_GROWTH = 0.3
# Mean area of the triangles that gmsh makes for a wanted edge of 1, measured with the edges of the boundary
# included and rounded down, so that the estimate leans to too many (an equilateral triangle has 0.433).
TRIANGLE_AREA = 0.36
# Among so many balls alike the nearest is looked up in a tree.
MANY_BALLS = 32
# Of so many the exact distances are compared: the tree rounds otherwise than a complex modulus.
NEAREST = 3


@dataclass(frozen=True, slots=True)
class Refinement:
    """Small elements about one point of a body.

    Attributes
    ----------
    x, y : float
        The point in the frame of the body, mm.
    size : float
        Element edge inside the radius, mm.
    radius : float
        mm.
    """

    x: float
    y: float
    size: float
    radius: float

    def __post_init__(self) -> None:
        if not (self.size > 0.0 and self.radius >= 0.0 and np.isfinite([self.x, self.y, self.size]).all()):
            raise MeshError(
                f"refinement at ({self.x:g}, {self.y:g}) mm with size {self.size:g} mm and radius "
                f"{self.radius:g} mm: the size must be greater than 0 and the radius at least 0"
            )

    @classmethod
    def polar(cls, distance: float, angle: float, *, size: float, radius: float) -> Refinement:
        """Return the refinement at a polar angle (rad) and distance (mm) about the origin of the body."""
        return cls(float(distance * np.cos(angle)), float(distance * np.sin(angle)), float(size), float(radius))

    @property
    def point(self) -> complex:
        """The point as a complex number, mm."""
        return complex(self.x, self.y)


@dataclass(frozen=True, slots=True, kw_only=True)
class SizeField:
    """Wanted element edge everywhere in a body.

    Attributes
    ----------
    balls : tuple of Refinement
        Places of small elements.
    coarse_size : float
        Largest edge, mm.
    growth : float
        Growth g of the edge by distance.
    """

    balls: tuple[Refinement, ...]
    coarse_size: float
    growth: float = DEFAULT_GROWTH

    def __post_init__(self) -> None:
        if not (self.coarse_size > 0.0 and np.isfinite(self.coarse_size)):
            raise MeshError(f"coarse element size {self.coarse_size:g} mm: must be greater than 0 mm")
        if not 0.0 < self.growth <= 1.0:
            raise MeshError(f"growth {self.growth:g} of the element size: must be greater than 0 and at most 1")

    def at(self, points: ComplexArray) -> FloatArray:
        """Return the wanted edge at points, mm."""
        size = np.full(np.shape(points), self.coarse_size)
        for ball, centres in self.balls_alike():
            away = np.maximum(nearest_distance(points, centres) - ball.radius, 0.0)
            np.minimum(size, ball.size + self.growth * away, out=size)
        return size

    def balls_alike(self) -> Iterator[tuple[Refinement, ComplexArray]]:
        """Yield the first of the balls of each size and radius, and the centres of all of those."""
        alike: dict[tuple[float, float], list[Refinement]] = {}
        for ball in self.balls:
            alike.setdefault((ball.size, ball.radius), []).append(ball)
        for balls in alike.values():
            yield balls[0], np.array([ball.point for ball in balls])

    @property
    def smallest(self) -> float:
        """Smallest wanted edge, mm."""
        return min((ball.size for ball in self.balls), default=self.coarse_size)

    def estimate_triangles(self, area: float) -> int:
        r"""Return the number of triangles to expect in a body of given area (mm²), from above.

        Each ball is taken as a half disc, as on a straight boundary, and overlapping balls count twice:
        :math:`N = \frac{1}{a}\left(\frac{A}{h_c^2} + \sum \pi \int_0^{r_1} (h^{-2} - h_c^{-2})\, r\, dr\right)`,
        integrated in closed form, a = area of a triangle of edge 1.
        """
        coarse, growth = self.coarse_size, self.growth
        total = area / coarse**2
        for ball in self.balls:
            if ball.size >= coarse:
                continue
            outer = ball.radius + (coarse - ball.size) / growth
            ring = (
                (ball.radius - ball.size / growth) * (1.0 / ball.size - 1.0 / coarse)
                + np.log(coarse / ball.size) / growth
            ) / growth
            inside = 0.5 * ball.radius**2 / ball.size**2
            total += np.pi * max(inside + ring - 0.5 * outer**2 / coarse**2, 0.0)
        return int(np.ceil(min(total / TRIANGLE_AREA, 1e15)))


def nearest_distance(points: ComplexArray, centres: ComplexArray) -> FloatArray:
    """Return the distance of each point to the nearest of some centres, mm, shape as points."""
    if len(centres) < MANY_BALLS:
        found = np.full(np.shape(points), np.inf)
        for centre in centres.tolist():
            np.minimum(found, np.abs(points - centre), out=found)
        return found
    tree = cKDTree(np.column_stack([centres.real, centres.imag]))
    _, near = tree.query(np.stack([points.real, points.imag], axis=-1), k=NEAREST)
    return np.asarray(np.min(np.abs(points[..., None] - centres[near]), axis=-1))


def cover_small_edges(
    points: ComplexArray, edges: FloatArray, field: SizeField, *, slack: float = 1.15
) -> Sequence[Refinement]:
    """Return balls that carry small boundary edges into the interior.

    Without them the interior next to a tightly curved boundary would be meshed as coarsely as the middle. `edges` are the wanted
    edges at points of the boundary, mm. The smallest come first; where the field so far asks for no more than `slack` times the
    wanted edge no ball is added.
    """
    served = field.at(points)
    balls: list[Refinement] = []
    while True:
        # Rounding makes ties of equal curvature independent of the last bit, hence of the machine.
        wanting = served > slack * edges
        if not np.any(wanting):
            return balls
        candidates = np.flatnonzero(wanting)
        index = int(candidates[np.argmin(np.round(edges[candidates], 9))])
        ball = Refinement(
            float(points[index].real), float(points[index].imag), float(edges[index]), float(2.0 * edges[index])
        )
        balls.append(ball)
        away = np.maximum(np.abs(points - ball.point) - ball.radius, 0.0)
        np.minimum(served, ball.size + field.growth * away, out=served)
