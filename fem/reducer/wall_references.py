"""Stress along walls on nested meshes against closed forms: the elements and the recovery of stress, apart from any contact.

Holes against Kirsch, bores against Lamé, and bending, as that of the metal between roots and holes, against a thin ring pulled
apart by two pins. Dimensions and element edges are those of the disc of a drive, load and recovery the same as in its solution.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fem.body.elasticity import PlaneState, traction_load
from fem.body.plane_references import (
    THIN_RING_ERROR,
    kirsch_hoop_stress,
    kirsch_traction,
    lame_hoop_stress,
    pulled_ring_stress,
    solve_free_body,
)
from fem.body.wall_stress import WallStress, stress_along_wall
from fem.discretisation_error import ErrorEstimate, estimate_error
from fem.drive.meshes import coarse_edge
from fem.mesh.body_mesh import BodyMesh
from fem.mesh.triangulation import default_coarse_size, mesh_ring
from fem.mesh.uniform_refinement import refine_uniformly
from fem.shapes import DiscShape, RingShape
from ltca.arrays import FloatArray
from ltca.drive.parts import Material

STRESS_ORDER = 2.0
"""Order of nodal stress at a boundary, where averaging is one-sided."""
PRESSURE, TENSION, LINE_LOAD = 100.0, 100.0, 100.0
"""Loads of the problems, MPa, MPa and N/mm; stresses are proportional to them."""
PLATE_RADII = 5.0
"""Radius of the plate about a hole by that of the hole; the exact tractions act there."""
THIN_RING = 20.0
"""Mean radius of the ring by its wall."""


@dataclass(frozen=True, slots=True, kw_only=True)
class WallReference:
    """Stress at one place of a wall on nested meshes, and what a closed form says.

    Attributes
    ----------
    name : str
        The problem.
    source : str
        Whose closed form.
    estimate : ErrorEstimate
        Stress along the wall, MPa.
    exact : float
        Closed form, MPa.
    uncertainty : float
        Of the closed form, MPa; 0 where it is exact.
    """

    name: str
    source: str
    estimate: ErrorEstimate
    exact: float
    uncertainty: float

    @property
    def error(self) -> float:
        """Finest value less the closed form, MPa."""
        return self.estimate.value - self.exact

    @property
    def held(self) -> bool:
        """Whether the closed form lies within the error bar, widened by its own uncertainty."""
        return abs(self.error) <= self.estimate.bar + self.uncertainty


def wall_references(
    shape: DiscShape, material: Material, state: PlaneState, *, size: float, meshes: int
) -> list[WallReference]:
    """Solve the problems on nested meshes whose coarsest is as coarse as walls of a disc at an element `size`."""
    edge = coarse_edge(shape, size)
    bore = shape.bores[0].radius
    hole = shape.holes[0].radius if shape.holes else bore
    kirsch = RingShape(inner_radius=hole, outer_radius=PLATE_RADII * hole, name="plate")
    lame = RingShape(inner_radius=bore, outer_radius=shape.flank.profile.root_radius, name="ring")
    thin = RingShape(inner_radius=bore, outer_radius=bore * (THIN_RING + 0.5) / (THIN_RING - 0.5), name="thin ring")

    def values(
        ring: RingShape, coarse: float, load: Callable[[BodyMesh], FloatArray], angle: float
    ) -> tuple[float, ...]:
        """Return the stress along the inner wall on every mesh, at the node of the coarsest nearest to a polar angle."""
        body, found, place = mesh_ring(ring, coarse_size=coarse), [], None
        for halving in range(meshes):
            body = refine_uniformly(body, ring.curves) if halving else body
            wall = stress_along_wall(body, solve_free_body(body, material, load(body), state=state), ring.curves[1])
            place = _nearest(wall, angle) if place is None else place
            found.append(float(wall.at(np.array([place]))[0]))
        places.append(float(place or 0.0))
        return tuple(found)

    places: list[float] = []
    plate = values(
        kirsch,
        edge,
        lambda body: traction_load(body, "outer", lambda x, n: kirsch_traction(TENSION, hole, x), thickness=1.0),
        0.5 * np.pi,
    )
    pressed = values(
        lame,
        edge,
        lambda body: traction_load(body, "inner", lambda x, n: (-PRESSURE * n[0], -PRESSURE * n[1]), thickness=1.0),
        0.0,
    )
    pulled = values(thin, default_coarse_size(thin, size), lambda body: _two_forces(body, bore), 0.5 * np.pi)
    bent = pulled_ring_stress(LINE_LOAD, bore, thin.outer_radius, bore, places[2] - 0.5 * np.pi)
    found = (
        (
            "hole in a plate under tension",
            "Kirsch",
            plate,
            float(kirsch_hoop_stress(TENSION, np.array(places[0]))),
            0.0,
        ),
        (
            "bore under pressure",
            "Lamé",
            pressed,
            float(lame_hoop_stress(PRESSURE, bore, lame.outer_radius, np.array(bore))),
            0.0,
        ),
        ("thin ring pulled by two pins", "Timoshenko", pulled, bent, THIN_RING_ERROR / THIN_RING**2 * abs(bent)),
    )
    return [
        WallReference(
            name=name,
            source=source,
            estimate=estimate_error(own, STRESS_ORDER),
            exact=exact,
            uncertainty=uncertainty,
        )
        for name, source, own, exact, uncertainty in found
    ]


def _nearest(wall: WallStress, angle: float) -> float:
    """Return the parameter of the node nearest to a parameter."""
    return float(wall.parameter[np.argmin(np.abs(np.angle(np.exp(1j * (wall.parameter - angle)))))])


def _two_forces(body: BodyMesh, radius: float) -> FloatArray:
    """Return nodal forces of two opposite forces outwards on the inner wall, along x."""
    load = np.zeros(body.unknowns)
    for side in (1.0, -1.0):
        load[2 * int(np.argmin(np.abs(body.places - side * radius)))] += side * LINE_LOAD
    return load
