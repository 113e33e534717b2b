"""What all off-screen pictures of flat things share: surfaces and lines of pyvista, a camera that looks down."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import ComplexArray, FloatArray, IntArray

if TYPE_CHECKING:
    import pyvista


def open_plotter(**options: Any) -> Any:
    """Return an off-screen plotter.

    Parameters
    ----------
    **options : Any
        Of `pyvista.Plotter`.
    """
    import pyvista
    from vtkmodules.vtkCommonCore import vtkLogger

    # VTK warns about a missing X server before it takes EGL.
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_ERROR)
    return pyvista.Plotter(off_screen=True, **options)


def flat_surface(points: ComplexArray, faces: IntArray) -> pyvista.PolyData:
    """Return a surface of polygons at height 0.

    Parameters
    ----------
    points : array of complex, shape (n,)
        mm.
    faces : array of int, shape (polygons, corners)
        Rows of points.
    """
    import pyvista

    count, corners = faces.shape
    return pyvista.PolyData(_at_height(points, 0.0), np.column_stack([np.full(count, corners), faces]).ravel())


def flat_lines(points: ComplexArray, height: float) -> pyvista.PolyData:
    """Return polylines of equal length above the surfaces.

    Parameters
    ----------
    points : array of complex, shape (lines, points)
        mm.
    height : float
        Toward the camera, mm.
    """
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
    """Return a square window on flat things as pixels, nothing written on them.

    Parameters
    ----------
    layers : sequence of (mesh, options)
        From below, options of `pyvista.Plotter.add_mesh`.
    centre : complex
        Of the window, mm.
    half_side : float
        Of the window, mm.
    side : int
        Pixels.

    Returns
    -------
    array, shape (side, side, 3)
    """
    plotter = open_plotter(window_size=[side, side])
    plotter.set_background("white")
    for mesh, options in layers:
        # Without light: colours are those of the scale.
        plotter.add_mesh(mesh, lighting=False, **options)
    look_down(plotter, centre, half_side, 10.0 * half_side)
    image = np.asarray(plotter.screenshot(None, return_img=True))
    plotter.close()
    return image


def look_down(plotter: Any, centre: complex, half_side: float, distance: float) -> None:
    """Show a square window of the plane in the active panel.

    Parameters
    ----------
    plotter : pyvista.Plotter
        From `open_plotter`.
    centre : complex
        Of the window, mm.
    half_side : float
        Of the window, mm.
    distance : float
        Of the camera, mm; what is shown lies between half of it and twice of it away.
    """
    plotter.enable_parallel_projection()
    plotter.camera.focal_point = (centre.real, centre.imag, 0.0)
    plotter.camera.position = (centre.real, centre.imag, distance)
    plotter.camera.up = (0.0, 1.0, 0.0)
    plotter.camera.parallel_scale = half_side
    plotter.camera.clipping_range = (0.5 * distance, 2.0 * distance)


def may_show(points: ComplexArray, centre: complex, half_side: float) -> NDArray[np.bool_]:
    """Return which rows of points may show in a square window.

    Parameters
    ----------
    points : array of complex, shape (rows, points)
        mm.
    centre : complex
        Of the window, mm.
    half_side : float
        Of the window, mm.
    """
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
