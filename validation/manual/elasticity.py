"""Plane elasticity without contact: a ring under pressure, a hole in a plate under tension."""

from __future__ import annotations

from validation.levels.closed_forms import hole_rows, ring_rows
from validation.manual.case import Case, Reference
from validation.manual.error_bars import figures_by_size

CASES = (
    Case(
        name="lame_ring",
        title="Lamé's ring under inner pressure",
        problem="A steel ring, radii 10 and 20 mm, under an inner pressure of 100 MPa: hoop stress at all nodes. The "
        "row is the worst "
        "node; its difference is relative to the largest stress.",
        references=(
            Reference(
                source="Lamé (1852); Timoshenko and Goodier, *Theory of Elasticity*, section 28",
                uncertainty="None beyond round-off: a closed form.",
            ),
        ),
        model="Plane strain, quadratic triangles, free body; stresses averaged at the nodes (`fem.body.stress`).",
        run=lambda: figures_by_size(ring_rows, (1.4, 0.7, 0.35), "elements of 1.4, 0.7, 0.35 mm"),
    ),
    Case(
        name="kirsch_hole",
        title="Kirsch's hole in a plate under tension",
        problem="A hole of radius 3 mm in a plate under 80 MPa: largest stress at its wall, three times as large at "
        "the side and "
        "σ (1 − 2 cos 2θ) at the node nearest to it.",
        references=(
            Reference(
                source="Kirsch (1898); Timoshenko and Goodier, *Theory of Elasticity*, section 35",
                uncertainty="None beyond round-off: a closed form.",
            ),
        ),
        model="A ring of radii 3 and 15 mm whose outside carries the exact tractions of the infinite plate; quadratic "
        "triangles, "
        "stresses averaged at the nodes.",
        run=lambda: figures_by_size(hole_rows, (0.72, 0.36, 0.18), "elements of 0.72, 0.36, 0.18 mm"),
        long=True,
    ),
)
