"""Pictures of a full solution: von Mises over the drive, the most loaded contact of each kind, the deformed shape."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fem.contact.pressure_measures import vertex_means
from fem.drive.contact_kinds import CONTACT_KINDS
from fem.drive.fields import BodyField
from fem.drive.full_solution import FullSolution
from fem.pictures.offscreen import rendering_problem
from fem.pictures.page_picture import SIDE, SIDE_OF_SEVERAL, panel_svg
from fem.pictures.scene import Lines, Panel, Triangles, paint_panels, write_panels
from ltca.arrays import ComplexArray, FloatArray
from ltca.page.study_page import Picture

# Colours over the whole drive run over ratios, from where this share of its area is below up to the largest stress: on an
# even scale the spots under the contacts would leave the rest of the drive in one colour.
COLOUR_AREA = 0.10
MAX_COLOUR_RATIO = 500.0
# The largest elastic displacement is drawn as this part of the drive's radius.
DEFORMED_SHARE = 0.04
ZOOM_HALF_WIDTHS = 3.5
# The peak pressure is drawn as long as this many half-widths.
PRESSURE_HALF_WIDTHS = 1.5


TITLES = {
    "von_mises": "von Mises stress at the loaded pose",
    "deformed": "Elastic displacement, magnified",
    "contacts": "The most loaded contact of each kind: mesh, stress, pressure",
}
ZOOM_SIDE = 1100


class Drawn(NamedTuple):
    """Pictures of a solution.

    Attributes
    ----------
    problem : str
        Why matplotlib drew them; empty when pyvista did.
    pictures : tuple of Picture
        For a page, without the headline.
    """

    problem: str
    pictures: tuple[Picture, ...]


def draw_solution(
    solution: FullSolution,
    fields: Sequence[BodyField],
    headline: str,
    folder: Path,
    *,
    side: int = 1600,
    prefix: str = "",
) -> Drawn:
    """Draw ``von_mises.png``, ``contacts.png`` and ``deformed.png``, and return them as pictures of a page.

    The pictures of the whole drive have `side` pixels; text keeps its size. `prefix` is put before the names of the files.
    """
    everything = np.concatenate([field.places for field in fields])
    reach = 1.03 * float(np.max(np.abs(everything)))
    highest = max(float(np.max(field.stress.von_mises)) for field in fields)
    lowest = _round_down(max(_stress_below(fields, COLOUR_AREA), highest / MAX_COLOUR_RATIO))
    shaft = _shaft_pins(solution)
    whole = Panel(
        title=f"{headline}\nvon Mises stress, largest {highest:.3g} MPa (logarithmic scale)",
        centre=0j,
        half_side=reach,
        triangles=tuple(_triangles(field, field.places, field.stress.von_mises) for field in fields),
        lines=(*(_outline(field, field.places) for field in fields), shaft),
        label="von Mises stress [MPa]",
        limits=(lowest, highest),
        logarithmic=True,
    )
    largest = max(float(np.max(np.abs(field.elastic))) for field in fields)
    scale = _round_down(DEFORMED_SHARE * reach / largest)
    deformed = Panel(
        title=f"{headline}\nelastic displacement × {scale:g} at the loaded pose (grey: undeformed)",
        centre=0j,
        half_side=reach,
        triangles=tuple(
            _triangles(field, field.places + scale * field.elastic, 1e3 * np.abs(field.elastic)) for field in fields
        ),
        lines=(
            *(_outline(field, field.places, "#999999") for field in fields),
            *(_outline(field, field.places + scale * field.elastic) for field in fields),
            shaft,
        ),
        label="elastic displacement [µm]",
        limits=(0.0, 1e3 * largest),
    )
    zooms = _zooms(solution, fields)
    pictures = []
    for name, panels, pixels in (
        ("von_mises", [whole], side),
        ("deformed", [deformed], side),
        ("contacts", zooms, ZOOM_SIDE),
    ):
        images = paint_panels(panels, pixels)
        write_panels(folder / f"{prefix}{name}.png", panels, images, pixels)
        drawn = [
            (
                panel.title.removeprefix(f"{headline}\n"),
                panel_svg(panel, image, SIDE if len(panels) == 1 else SIDE_OF_SEVERAL),
            )
            for panel, image in zip(panels, images, strict=True)
        ]
        pictures.append(Picture(name=name, title=TITLES[name], panels=tuple(drawn)))
    return Drawn(problem=rendering_problem(), pictures=tuple(pictures))


def _stress_below(fields: Sequence[BodyField], share: float) -> float:
    """Return the von Mises stress that a share of the area stays below, MPa."""
    areas, stresses = [], []
    for field in fields:
        triangles = field.body.mesh.t
        a, b, c = (field.places[triangles[k]] for k in range(3))
        areas.append(0.5 * np.abs(((b - a).conjugate() * (c - a)).imag))
        stresses.append(field.stress.von_mises[triangles].mean(axis=0))
    area, stress = np.concatenate(areas), np.concatenate(stresses)
    order = np.argsort(stress)
    below = np.cumsum(area[order]) / area.sum()
    return float(stress[order][np.searchsorted(below, share)])


def _round_down(value: float) -> float:
    power = 10.0 ** np.floor(np.log10(value))
    return float(max(step for step in (1.0, 2.0, 5.0) if step * power <= value) * power)


def _triangles(field: BodyField, places: ComplexArray, values: FloatArray) -> Triangles:
    return Triangles(points=places, faces=field.placed.faces(), values=values)


def _outline(field: BodyField, places: ComplexArray, colour: str = "#202020") -> Lines:
    mesh = field.body.mesh
    facets = mesh.boundary_facets()
    ends = mesh.facets[:, facets]
    points = np.column_stack([places[ends[0]], places[mesh.nvertices + facets], places[ends[1]]])
    return Lines(points=points, colour=colour, width=1.5)


def _shaft_pins(solution: FullSolution) -> Lines:
    place, pose = solution.model.placement, solution.pose
    circle = np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 361))
    centres = place.shaft_pin_centres + pose.shaft_pin_displacements
    return Lines(points=centres[:, None] + place.shaft_pin_radii[:, None] * circle, colour="#777777", width=1.5)


def _chosen(kinds: Sequence[str], loads: Sequence[float]) -> list[int]:
    """Return the most loaded contact of the flank, of the holes and of the rollers, whose two carry the same load."""
    chosen = []
    for group in (("pin",), ("hole",), ("roller_outer", "roller_inner")):
        numbers = [number for number, kind in enumerate(kinds) if kind in group and loads[number] > 0.0]
        if numbers:
            chosen.append(max(numbers, key=lambda number: loads[number]))
    return chosen


def _zooms(solution: FullSolution, fields: Sequence[BodyField]) -> list[Panel]:
    """Return windows on the most loaded contact of each kind: mesh, stress and pressure diagram."""
    model, details = solution.model, solution.contacts.details
    chosen = _chosen([pair.kind for pair in model.pairs], [detail.load for detail in details])
    panels = []
    for number in chosen:
        pair, detail = model.pairs[number], details[number]
        pose = model.carrier_pose(pair, solution.pose)
        arc = pair.zone.arc
        vertices = np.append(pair.zone.places[:, 0], pair.zone.places[-1, 2])
        pressure = vertex_means(arc, pair.zone.at_vertices(solution.state.contact.pressure[pair.unknowns]))
        exact, normal = pair.zone.exact(vertices)
        places, into = pose.place(exact), -pose.turn(normal)
        middle = complex(np.interp(detail.middle, arc, places.real), np.interp(detail.middle, arc, places.imag))
        height = PRESSURE_HALF_WIDTHS * detail.half_width / detail.peak_pressure
        on = np.flatnonzero(pressure > 0.0)
        diagram = places + height * pressure * into
        teeth = np.column_stack([places[on], diagram[on]])
        outline = diagram[None, max(on[0] - 1, 0) : on[-1] + 2]
        half_side = ZOOM_HALF_WIDTHS * detail.half_width
        near = [field for field in fields if float(np.min(np.abs(field.places - middle))) < half_side]
        limit = max(
            float(np.max(field.stress.von_mises, where=np.abs(field.places - middle) < 1.4 * half_side, initial=0.0))
            for field in near
        )
        panels.append(
            Panel(
                title=(
                    f"{CONTACT_KINDS[pair.kind].title_of(pair.index, solution.model.placement)}: {detail.load:.0f} N\n"
                    f"white: pressure, peak {detail.peak_pressure:.0f} MPa, half-width {1e3 * detail.half_width:.1f} µm"
                ),
                centre=middle,
                half_side=half_side,
                triangles=tuple(
                    _triangles(field, field.places + field.elastic, field.stress.von_mises) for field in near
                ),
                lines=(
                    *(Lines(points=_edges(field), colour="#404040", width=0.8) for field in near),
                    _shaft_pins(solution),
                    # Dark beside white: both are seen on every colour of the scale.
                    Lines(points=teeth, colour="#202020", width=3.5),
                    Lines(points=outline, colour="#202020", width=6.0),
                    Lines(points=teeth, colour="#ffffff", width=1.5),
                    Lines(points=outline, colour="#ffffff", width=3.0),
                ),
                label="von Mises stress [MPa]",
                limits=(0.0, limit),
            )
        )
    return panels


def _edges(field: BodyField) -> ComplexArray:
    mesh, nodes = field.body.mesh, field.places + field.elastic
    return np.column_stack([nodes[mesh.facets[0]], nodes[mesh.nvertices :], nodes[mesh.facets[1]]])
