"""Common parts of off-screen pictures of plane bodies: surfaces and lines of pyvista, a camera that looks down."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import ComplexArray, FloatArray, IntArray

if TYPE_CHECKING:
    import pyvista


def open_plotter(**options: Any) -> Any:
    """Return an off-screen plotter with options of `pyvista.Plotter`."""
    import pyvista
    from vtkmodules.vtkCommonCore import vtkLogger

    # VTK warns about a missing X server before it takes EGL.
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_ERROR)
    return pyvista.Plotter(off_screen=True, **options)


def flat_surface(points: ComplexArray, faces: IntArray) -> pyvista.PolyData:
    """Return a surface of polygons at height 0: points, mm, and rows of their numbers, shape (polygons, corners)."""
    import pyvista

    count, corners = faces.shape
    return pyvista.PolyData(_at_height(points, 0.0), np.column_stack([np.full(count, corners), faces]).ravel())


def flat_lines(points: ComplexArray, height: float) -> pyvista.PolyData:
    """Return polylines of equal length, shape (lines, points), at a height toward the camera, mm."""
    import pyvista

    count, length = points.shape
    index = np.arange(points.size).reshape(count, length)
    return pyvista.PolyData(_at_height(points, height), lines=np.column_stack([np.full(count, length), index]).ravel())


def _at_height(points: ComplexArray, height: float) -> FloatArray:
    ravelled = points.ravel()
    return np.column_stack([ravelled.real, ravelled.imag, np.full(ravelled.size, height)])


def snapshot(
    layers: Sequence[tuple[Any, dict[str, Any]]], centre: complex, half_side: float, side: int
) -> NDArray[np.uint8]:
    """Return a square window of `side` pixels as an image without annotations and with a clear ground, shape (side, side, 4).

    `layers` are pairs of a mesh and options of `pyvista.Plotter.add_mesh`, from below; centre and half side are in mm.
    """
    plotter = open_plotter(window_size=[side, side])
    plotter.set_background("white")
    for mesh, options in layers:
        # Without light: colours are those of the scale.
        plotter.add_mesh(mesh, lighting=False, **options)
    look_down(plotter, centre, half_side, 10.0 * half_side)
    image = np.asarray(plotter.screenshot(None, return_img=True, transparent_background=True))
    plotter.close()
    return image


def look_down(plotter: Any, centre: complex, half_side: float, distance: float) -> None:
    """Show a square window of the plane, mm, in the active panel, from a camera at a distance.

    What is shown lies between half the distance and twice the distance away.
    """
    plotter.enable_parallel_projection()
    plotter.camera.focal_point = (centre.real, centre.imag, 0.0)
    plotter.camera.position = (centre.real, centre.imag, distance)
    plotter.camera.up = (0.0, 1.0, 0.0)
    plotter.camera.parallel_scale = half_side
    plotter.camera.clipping_range = (0.5 * distance, 2.0 * distance)


def may_show(points: ComplexArray, centre: complex, half_side: float) -> NDArray[np.bool_]:
    """Return which rows of points, shape (rows, points), may be visible in a square window, mm."""
    away = points - centre
    return np.asarray(
        (away.real.min(axis=1) < half_side)
        & (away.real.max(axis=1) > -half_side)
        & (away.imag.min(axis=1) < half_side)
        & (away.imag.max(axis=1) > -half_side)
    )


def coordinate_pairs(points: ComplexArray) -> Any:  # matplotlib asks for a sequence and takes an array
    """Return x and y on a last axis."""
    return np.stack([points.real, points.imag], axis=-1)
