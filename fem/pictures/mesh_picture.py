"""Picture of the mesh of a whole drive with zooms at its contacts: pyvista off-screen, or matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fem.drive.expected_contacts import ContactGroup, ExpectedContacts
from fem.drive.meshes import DriveMeshes
from fem.mesh.mesh_file import written_whole
from fem.mesh.placed_body import PlacedBody
from fem.pictures.offscreen import rendering_problem
from fem.shapes import CircleShape
from ltca.geometry.placement import Placement

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

# Fill and line colour of each kind of body.
COLOURS = {
    "disc": ("#c9d8e8", "#28527a"),
    "pin": ("#f2d9b8", "#8a5a17"),
    "roller": ("#cfe6cf", "#2f6b2f"),
    "inner_race": ("#e3d3ea", "#5f3a78"),
    "shaft_pin": ("#dddddd", "#666666"),
}
ZOOM_HALF_WIDTHS = 4.0


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
    race_centre = complex(placement.race_centre(np.asarray(angle)))
    disc_centre = race_centre + complex(contacts.disc_x, contacts.disc_y)
    wheel_turn = angle / placement.reduction_ratio + contacts.wheel_angle
    pin_places = placement.wheel_pin_centres * np.exp(1j * wheel_turn)
    rays = np.exp(1j * placement.roller_angles(np.asarray(angle)))
    # Rollers are drawn in the middle between the races.
    bore = np.abs(placement.bore_radius * rays + complex(contacts.disc_x, contacts.disc_y))
    roller_places = race_centre + rays * 0.5 * (placement.inner_race_radius + bore)
    placed = [PlacedBody(body=meshes.disc, centre=disc_centre, rotation=contacts.disc_rotation, kind="disc")]
    placed += [
        PlacedBody(body=body, centre=complex(place), rotation=0.0, kind="pin")
        for body, place in zip(meshes.wheel_pins, pin_places, strict=True)
    ]
    placed += [
        PlacedBody(body=body, centre=complex(place), rotation=0.0, kind="roller")
        for body, place in zip(meshes.rollers, roller_places, strict=True)
    ]
    placed.append(PlacedBody(body=meshes.inner_race, centre=race_centre, rotation=0.0, kind="inner_race"))
    return placed


def choose_zooms(contacts: ExpectedContacts, placement: Placement) -> list[Zoom]:
    """Return a window on the most loaded contact of each kind."""
    race_centre = complex(placement.race_centre(np.asarray(contacts.crank_angle)))
    disc_centre = race_centre + complex(contacts.disc_x, contacts.disc_y)
    turn = np.exp(1j * contacts.disc_rotation)
    kinds: Sequence[tuple[str, ContactGroup, ComplexArray]] = (
        ("pin {} on the flank", contacts.pins, disc_centre + contacts.flank_points * turn),
        ("roller {} on the bore", contacts.rollers_outer, disc_centre + contacts.bore_points * turn),
        ("roller {} on the race", contacts.rollers_inner, race_centre + contacts.race_points),
        ("rigid shaft pin {} in its hole", contacts.holes, disc_centre + contacts.hole_points * turn),
    )
    zooms = []
    for title, group, points in kinds:
        index = int(np.argmax(group.load))
        width = float(group.half_width[index])
        reach = ZOOM_HALF_WIDTHS * width
        if width > 0.0:
            zooms.append(
                Zoom(
                    title=f"{title.format(index)}\n"
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
    shaft_pins: Sequence[tuple[complex, CircleShape]],
    title: str,
) -> str:
    """Draw the mesh of a drive, zooms on the right.

    Parameters
    ----------
    path : str or Path
        PNG file.
    placed : sequence of PlacedBody
        Bodies in the fixed frame.
    zooms : sequence of Zoom
        Up to four windows.
    shaft_pins : sequence of (complex, CircleShape)
        Centres (fixed frame, mm) and shapes of the rigid shaft pins, drawn as outlines.
    title : str
        Headline.

    Returns
    -------
    str
        "" when pyvista drew it, else why matplotlib did.

    Raises
    ------
    MeshError
        When the file cannot be written.
    """
    problem = rendering_problem()
    circles = [centre + shape.radius * np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 721)) for centre, shape in shaft_pins]
    with written_whole(Path(path)) as temporary:
        draw = _draw_with_matplotlib if problem else _draw_with_pyvista
        draw(temporary, placed, zooms, circles, title)
    return problem


def _draw_with_pyvista(
    path: Path, placed: Sequence[PlacedBody], zooms: Sequence[Zoom], circles: Sequence[ComplexArray], title: str
) -> None:
    import pyvista
    from vtkmodules.vtkCommonCore import vtkLogger

    def flat(points: ComplexArray, height: float) -> FloatArray:
        ravelled = points.ravel()
        return np.column_stack([ravelled.real, ravelled.imag, np.full(ravelled.size, height)])

    def lines(points: ComplexArray, height: float) -> pyvista.PolyData:
        count, length = points.shape
        index = np.arange(points.size).reshape(count, length)
        return pyvista.PolyData(flat(points, height), lines=np.column_stack([np.full(count, length), index]).ravel())

    layers = []
    for item in placed:
        fill, line = COLOURS[item.kind]
        faces = item.faces()
        padded = np.column_stack([np.full(len(faces), 3), faces]).ravel()
        layers.append((pyvista.PolyData(flat(item.nodes, 0.0), padded), fill))
        layers.append((lines(item.edge_lines(), 0.01), line))
    for circle in circles:
        polygon = np.concatenate([[circle.size - 1], np.arange(circle.size - 1)])  # without the repeated end
        layers.append((pyvista.PolyData(flat(circle[:-1], 0.0), polygon), COLOURS["shaft_pin"][0]))
        layers.append((lines(circle[None, :], 0.02), COLOURS["shaft_pin"][1]))

    # VTK warns about a missing X server before it takes EGL.
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_ERROR)
    groups: Any = [(slice(0, 2), slice(0, 2))]
    plotter: Any = pyvista.Plotter(off_screen=True, shape=(2, 4), groups=groups, window_size=[2400, 1200])
    everything = np.concatenate([item.nodes for item in placed])
    reach = 1.04 * max(float(np.ptp(everything.real)), float(np.ptp(everything.imag))) / 2.0
    middle = complex(
        0.5 * (everything.real.max() + everything.real.min()), 0.5 * (everything.imag.max() + everything.imag.min())
    )
    windows = [((0, 0), Zoom(title=title, centre=middle, half_side=reach))]
    windows += [((k // 2, 2 + k % 2), zoom) for k, zoom in enumerate(zooms[:4])]
    for (row, column), zoom in windows:
        plotter.subplot(row, column)
        plotter.set_background("white")
        for mesh, colour in layers:
            plotter.add_mesh(mesh, color=colour, lighting=False, line_width=1)
        plotter.add_text(zoom.title, font_size=10, color="black", position="upper_edge")
        plotter.enable_parallel_projection()
        plotter.camera.focal_point = (zoom.centre.real, zoom.centre.imag, 0.0)
        plotter.camera.position = (zoom.centre.real, zoom.centre.imag, 10.0)
        plotter.camera.up = (0.0, 1.0, 0.0)
        plotter.camera.parallel_scale = zoom.half_side
        plotter.camera.clipping_range = (1.0, 20.0)
    plotter.screenshot(str(path))
    plotter.close()


def _draw_with_matplotlib(
    path: Path, placed: Sequence[PlacedBody], zooms: Sequence[Zoom], circles: Sequence[ComplexArray], title: str
) -> None:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.collections import LineCollection, PolyCollection
    from matplotlib.figure import Figure

    figure = Figure(figsize=(24.0, 12.0), layout="constrained")
    FigureCanvasAgg(figure)
    grid = figure.add_gridspec(2, 4)
    windows: list[tuple[Any, Zoom | None]] = [(grid[:, :2], None)]
    windows += [(grid[k // 2, 2 + k % 2], zoom) for k, zoom in enumerate(zooms[:4])]
    for cell, window in windows:
        axes = figure.add_subplot(cell)
        for item in placed:
            fill, line = COLOURS[item.kind]
            nodes = item.nodes
            polygons, edges = nodes[item.faces()], item.edge_lines()
            if window is not None:
                polygons, edges = (_inside(array, window) for array in (polygons, edges))
            axes.add_collection(PolyCollection(_pairs(polygons), facecolors=fill, edgecolors=fill, linewidths=0.2))
            axes.add_collection(LineCollection(_pairs(edges), colors=line, linewidths=0.25 if window is None else 0.7))
        for circle in circles:
            fill, line = COLOURS["shaft_pin"]
            axes.fill(circle.real, circle.imag, facecolor=fill, edgecolor=line, linewidth=1.0)
        axes.set_aspect("equal")
        axes.set_title(title if window is None else window.title)
        if window is None:
            axes.autoscale_view()
        else:
            axes.set_xlim(window.centre.real - window.half_side, window.centre.real + window.half_side)
            axes.set_ylim(window.centre.imag - window.half_side, window.centre.imag + window.half_side)
        axes.set_xlabel("x, mm")
        axes.set_ylabel("y, mm")
    figure.savefig(path, dpi=100.0)


def _pairs(points: ComplexArray) -> Any:  # matplotlib asks for a sequence and takes an array
    return np.stack([points.real, points.imag], axis=-1)


def _inside(points: ComplexArray, window: Zoom) -> ComplexArray:
    """Return the rows that may show in a window."""
    away = points - window.centre
    reach = window.half_side
    hidden = (
        (away.real.min(axis=1) > reach)
        | (away.real.max(axis=1) < -reach)
        | (away.imag.min(axis=1) > reach)
        | (away.imag.max(axis=1) < -reach)
    )
    return np.asarray(points[~hidden])
