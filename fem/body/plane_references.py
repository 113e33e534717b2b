r"""Closed forms of plane elasticity that stresses along walls are held against, and a free ring under loads.

- Lamé's ring under inner pressure p (Timoshenko & Goodier, *Theory of Elasticity*, 28):
  :math:`\sigma_\theta = \frac{p\,a^2}{b^2 - a^2}\left(1 + \frac{b^2}{r^2}\right)`. Exact.
- Kirsch's hole of radius a in a plate under tension S along x (the same, 35): along its wall
  :math:`\sigma_\theta = S (1 - 2 \cos 2\theta)`. Exact; tractions of the infinite plate act on the circle where the mesh
  ends.
- A thin ring pulled apart by two opposite forces P (Timoshenko, *Strength of Materials* II, 80; Winkler's curved bar): at the
  angle φ from the middle between the forces, with the wall t = b − a, the mean radius R, the neutral radius
  :math:`r_n = t/\ln(b/a)` and :math:`e = R - r_n`,

  .. math:: N = \tfrac{P}{2} \cos\varphi, \quad
            M = \tfrac{PR}{2}\left(\cos\varphi - \tfrac{2}{\pi} + \tfrac{2 e}{\pi R}\right), \quad
            \sigma(r) = \frac{N}{t} + \frac{M (r_n - r)}{t\,e\,r}.

  Sections stay plane: an error of the order (t/R)². Finite elements on meshes refined three times differ from it by 0.45 %,
  0.11 % and 0.026 % at R/t = 5, 10 and 20, midway between the forces (`THIN_RING_ERROR`); not valid near the forces.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from fem.body.condensation import condense_body
from fem.body.elasticity import PlaneState, assemble_stiffness
from fem.body.stress import Stress, recover_stress
from fem.mesh.body_mesh import BodyMesh
from ltca.arrays import FloatArray
from ltca.drive.parts import Material

THIN_RING_ERROR = 0.12
"""Relative error of the thin ring's stress midway between the forces by (t/R)², rounded up."""


def solve_free_body(
    body: BodyMesh, material: Material, load: FloatArray, *, thickness: float = 1.0, state: PlaneState = "strain"
) -> Stress:
    """Return the nodal stress of a free body, MPa, under nodal forces in balance of shape (unknowns,), N."""
    stiffness = assemble_stiffness(body, material, thickness=thickness, state=state)
    displacement = condense_body(body, stiffness, sp.csc_matrix(load[:, None])).displacement(np.array([1.0]))
    return recover_stress(body, displacement, material, state=state)


def lame_hoop_stress(pressure: float, inner: float, outer: float, radius: FloatArray) -> FloatArray:
    """Return the hoop stress of a ring under inner pressure, MPa, at radii in mm."""
    return np.asarray(pressure * inner**2 / (outer**2 - inner**2) * (1.0 + outer**2 / np.asarray(radius) ** 2))


def kirsch_hoop_stress(tension: float, angle: FloatArray) -> FloatArray:
    """Return the stress along the wall of a hole in a plate under tension along x, MPa, at polar angles in rad."""
    return np.asarray(tension * (1.0 - 2.0 * np.cos(2.0 * np.asarray(angle))))


def kirsch_traction(tension: float, radius: float, places: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the traction x, y, MPa, on circles about a hole of a radius, mm, at places of shape (2, …), mm."""
    q, theta = radius**2 / (places[0] ** 2 + places[1] ** 2), np.arctan2(places[1], places[0])
    rr = 0.5 * tension * ((1.0 - q) + (1.0 - 4.0 * q + 3.0 * q**2) * np.cos(2.0 * theta))
    rt = -0.5 * tension * (1.0 + 2.0 * q - 3.0 * q**2) * np.sin(2.0 * theta)
    return rr * np.cos(theta) - rt * np.sin(theta), rr * np.sin(theta) + rt * np.cos(theta)


def pulled_ring_stress(line_load: float, inner: float, outer: float, radius: float, angle: float) -> float:
    """Return the hoop stress of a ring pulled apart by two opposite forces, MPa.

    `line_load` is the force by thickness, N/mm, `angle` is measured from the middle between the forces, rad; radii in mm.
    """
    wall, middle = outer - inner, 0.5 * (inner + outer)
    neutral = wall / np.log(outer / inner)
    offset = middle - neutral
    tension = 0.5 * line_load * np.cos(angle)
    moment = 0.5 * line_load * (middle * (np.cos(angle) - 2.0 / np.pi) + 2.0 * offset / np.pi)
    return float(tension / wall + moment * (neutral - radius) / (wall * offset * radius))
