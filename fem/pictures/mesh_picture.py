"""Picture of the mesh of a whole drive with zooms at its contacts: pyvista off-screen, or matplotlib."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, Any

import numpy as np

from fem.drive.contact_kinds import CONTACT_KINDS, PairKind
from fem.drive.expected_contacts import ContactGroup, ExpectedContacts
from fem.drive.meshes import DriveMeshes
from fem.drive.rigid_bodies import bore_displacements
from fem.mesh.placed_body import PlacedBody
from fem.pictures.flat_view import (
    coordinate_pairs,
    flat_lines,
    flat_surface,
    may_show,
    snapshot,
)
from fem.pictures.offscreen import rendering_problem
from ltca.arrays import ComplexArray
from ltca.figures.house_style import STYLE
from ltca.geometry.placement import Placement
from ltca.output.files import whole_file

if TYPE_CHECKING:
    from matplotlib.figure import Figure


# Fill and line colour of each kind of body.
COLOURS = {
    "disc": ("#c9d8e8", "#28527a"),
    "pin": ("#f2d9b8", "#8a5a17"),
    "roller": ("#cfe6cf", "#2f6b2f"),
    "inner_race": ("#e3d3ea", "#5f3a78"),
    "shaft_pin": ("#dddddd", "#666666"),
}
ZOOM_HALF_WIDTHS = 4.0
SIDE_INCHES = 7.6
"""Of the whole drive; its windows are half as large."""
PIXELS_PER_INCH = 160.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Zoom:
    """A square window on a contact.

    Attributes
    ----------
    title : str
        What it shows.
    centre : complex
        Fixed frame, mm.
    half_side : float
        mm.
    """

    title: str
    centre: complex
    half_side: float


def place_bodies(meshes: DriveMeshes, placement: Placement, contacts: ExpectedContacts) -> list[PlacedBody]:
    """Return all bodies in the fixed frame at the pose of the guess."""
    angle = contacts.crank_angle
    race_centre = complex(placement.races(np.asarray(angle)).middle)
    disc_centre = race_centre + complex(contacts.disc_x, contacts.disc_y)
    wheel_turn = angle / placement.reduction_ratio + contacts.wheel_angle
    pin_places = placement.wheel_axis + placement.wheel_pin_centres * np.exp(1j * wheel_turn)
    rays = np.exp(1j * placement.roller_angles(np.asarray(angle)))
    races, own = placement.races(np.asarray(angle)).centre, placement.roller_cranks
    shift = complex(contacts.disc_x, contacts.disc_y)
    bores = bore_displacements(placement, angle, shift, contacts.disc_rotation)
    # Rollers are drawn in the middle between the races.
    outer = np.abs(placement.bore_radius * rays + bores[own])
    roller_places = races[own] + rays * 0.5 * (placement.inner_race_radius + outer)
    placed = [PlacedBody(body=meshes.disc, centre=disc_centre, rotation=contacts.disc_rotation, kind="disc")]
    placed += [
        PlacedBody(body=body, centre=complex(place), rotation=0.0, kind="pin")
        for body, place in zip(meshes.wheel_pins, pin_places, strict=True)
    ]
    placed += [
        PlacedBody(body=body, centre=complex(place), rotation=0.0, kind="roller")
        for body, place in zip(meshes.rollers, roller_places, strict=True)
    ]
    placed += [
        PlacedBody(body=body, centre=complex(place), rotation=0.0, kind="shaft_pin")
        for body, place in zip(meshes.shaft_pins, placement.shaft_pin_centres, strict=False)
    ]
    placed += [
        PlacedBody(body=meshes.inner_race, centre=race, rotation=0.0, kind="inner_race") for race in races.tolist()
    ]
    return placed


def choose_zooms(contacts: ExpectedContacts, placement: Placement) -> list[Zoom]:
    """Return a window on the most loaded contact of each kind."""
    angle = np.asarray(contacts.crank_angle)
    disc_centre = complex(placement.races(angle).middle) + complex(contacts.disc_x, contacts.disc_y)
    races, turn = placement.races(angle).centre[placement.roller_cranks], np.exp(1j * contacts.disc_rotation)
    kinds: dict[PairKind, tuple[ContactGroup, ComplexArray]] = {
        "pin": (contacts.pins, disc_centre + contacts.flank_points * turn),
        "roller_outer": (contacts.rollers_outer, disc_centre + contacts.bore_points * turn),
        "roller_inner": (contacts.rollers_inner, races + contacts.race_points),
        "hole": (contacts.holes, disc_centre + contacts.hole_points * turn),
    }
    zooms = []
    for kind, (group, points) in kinds.items():
        if not len(points):
            continue
        index = int(np.argmax(group.load))
        width = float(group.half_width[index])
        reach = ZOOM_HALF_WIDTHS * width
        if width > 0.0:
            zooms.append(
                Zoom(
                    title=f"{CONTACT_KINDS[kind].title_of(index, placement)}\n"
                    f"expected half-width {1000.0 * width:.3g} µm, window {2.0 * reach:.3g} mm",
                    centre=complex(points[index]),
                    half_side=reach,
                )
            )
    return zooms


def draw_drive_mesh(
    path: str | Path,
    placed: Sequence[PlacedBody],
    zooms: Sequence[Zoom],
    shaft_pins: Sequence[tuple[complex, float]],
    title: str,
) -> str:
    """Draw the mesh of a drive as PNG, with up to four zooms on the right; return why matplotlib drew it, "" when pyvista did.

    `shaft_pins` are centres (fixed frame) and radii of rigid shaft pins, mm, drawn as outlines.
    """
    import matplotlib as mpl

    problem = rendering_problem()
    circles = [centre + radius * np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 721)) for centre, radius in shaft_pins]
    with mpl.rc_context({**STYLE, "axes.grid": False}), whole_file(Path(path)) as part:
        paint = _painter_with_matplotlib if problem else _painter_with_pyvista
        figure = _compose(placed, zooms[:4], title, paint(placed, circles))
        figure.savefig(part, dpi=PIXELS_PER_INCH)
    return problem


def _compose(
    placed: Sequence[PlacedBody], zooms: Sequence[Zoom], title: str, paint: Callable[[Any, Zoom, int], None]
) -> Figure:
    """The whole drive on the left, windows on its contacts on the right."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.ticker import MaxNLocator

    figure = Figure(figsize=(SIDE_INCHES * (1.0 + 0.5 * (2 if len(zooms) > 2 else len(zooms) > 0)), SIDE_INCHES))
    figure.set_layout_engine("constrained")
    FigureCanvasAgg(figure)
    across = min(2, len(zooms))
    grid = figure.add_gridspec(2, 2 + across)
    everything = np.concatenate([item.nodes for item in placed])
    low, high = (complex(pick(everything.real), pick(everything.imag)) for pick in (np.min, np.max))
    reach = 0.52 * max((high - low).real, (high - low).imag)
    windows: list[tuple[Any, Zoom]] = [(grid[:, :2], Zoom(title=title, centre=0.5 * (low + high), half_side=reach))]
    windows += [(grid[k // 2, 2 + k % 2], zoom) for k, zoom in enumerate(zooms)]
    for number, (cell, window) in enumerate(windows):
        axes = figure.add_subplot(cell)
        paint(axes, window, int(PIXELS_PER_INCH * SIDE_INCHES * (0.92 if number == 0 else 0.42)))
        letters = 100 if number == 0 else 46
        axes.set_title(
            "\n".join(fill(line, letters) for line in window.title.split("\n")), parse_math=False, fontsize=9.0
        )
        axes.set_aspect("equal")
        axes.set_xlim(window.centre.real - window.half_side, window.centre.real + window.half_side)
        axes.set_ylim(window.centre.imag - window.half_side, window.centre.imag + window.half_side)
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_locator(MaxNLocator(4 if number else 7))
        axes.ticklabel_format(useOffset=False)
        axes.set_xlabel("x [mm]")
        axes.set_ylabel("y [mm]")
    return figure


def _painter_with_pyvista(
    placed: Sequence[PlacedBody], circles: Sequence[ComplexArray]
) -> Callable[[Any, Zoom, int], None]:
    layers: list[tuple[Any, dict[str, Any]]] = []
    for item in placed:
        fill_colour, line = COLOURS[item.kind]
        layers.append((flat_surface(item.nodes, item.faces()), {"color": fill_colour}))
        layers.append((flat_lines(item.edge_lines(), 0.01), {"color": line, "line_width": 1}))
    for circle in circles:
        corners = circle[:-1]  # without the repeated end
        layers.append((flat_surface(corners, np.arange(corners.size)[None, :]), {"color": COLOURS["shaft_pin"][0]}))
        layers.append((flat_lines(circle[None, :], 0.02), {"color": COLOURS["shaft_pin"][1], "line_width": 1}))

    def paint(axes: Any, window: Zoom, side: int) -> None:
        reach, middle = window.half_side, window.centre
        extent = (middle.real - reach, middle.real + reach, middle.imag - reach, middle.imag + reach)
        # The camera stands at ten half-sides or more: lines lie above the surfaces in every window.
        axes.imshow(snapshot(layers, middle, reach, side), extent=extent, interpolation="antialiased")

    return paint


def _painter_with_matplotlib(
    placed: Sequence[PlacedBody], circles: Sequence[ComplexArray]
) -> Callable[[Any, Zoom, int], None]:
    from matplotlib.collections import LineCollection, PolyCollection

    def paint(axes: Any, window: Zoom, side: int) -> None:
        for item in placed:
            fill_colour, line = COLOURS[item.kind]
            nodes = item.nodes
            polygons, edges = nodes[item.faces()], item.edge_lines()
            polygons, edges = (rows[may_show(rows, window.centre, window.half_side)] for rows in (polygons, edges))
            axes.add_collection(
                PolyCollection(
                    coordinate_pairs(polygons), facecolors=fill_colour, edgecolors=fill_colour, linewidths=0.2
                )
            )
            axes.add_collection(LineCollection(coordinate_pairs(edges), colors=line, linewidths=0.3))
        for circle in circles:
            fill_colour, line = COLOURS["shaft_pin"]
            axes.fill(circle.real, circle.imag, facecolor=fill_colour, edgecolor=line, linewidth=0.6)

    return paint
