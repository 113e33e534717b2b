"""Files and words of a solved pair: ``pair.nc``, ``summary.json`` and the table that is printed."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from fem.solid_contact.solved_pair import SolvedPair
from ltca.output.files import whole_file, write_json
from ltca.output.labelled import LabelledArray, LabelledDataset
from ltca.output.netcdf import write_netcdf
from ltca.output.provenance import code_hash, code_version

FILES = ("pair.nc", "summary.json")
ROWS = 9
"""Heights in the printed table."""


def held_words(solved: SolvedPair) -> str:
    """Return what is cut off and how it is held."""
    meshes, pair = solved.meshes, solved.pair
    half = ", half by symmetry along the profile" if pair.symmetric else ""
    rigid = f"; the {pair.opposite} is rigid" if pair.opposite_material is None else ""
    return (
        f"blocks {2.0 * meshes.block:g} mm wide and {meshes.block:g} mm deep, held in all directions at sides and "
        f"bottom, free at the ends of the axis{half}{rigid}; surfaces have their shape up to {pair.shape_reach:.3g} mm "
        "from the contact"
    )


def summarise_pair(solved: SolvedPair) -> dict[str, Any]:
    """Return the content of ``summary.json``."""
    pair, meshes = solved.pair, solved.meshes
    return {
        "pair": pair.name,
        "length_mm": pair.length,
        "effective_radius_mm": pair.effective_radius,
        "contact_modulus_MPa": pair.contact_modulus,
        "load_N": solved.load,
        "approach_mm": solved.approach,
        "tilt_rad": solved.tilt,
        "moment_Nmm": solved.moment,
        "largest_pressure_MPa": solved.largest_pressure,
        "largest_pressure_height_mm": solved.largest_height,
        "load_factor": solved.load_factor,
        "largest_half_width_mm": float(solved.half_width.max()),
        "strain_energy_Nmm": solved.energy,
        "energy_error": solved.energy_error,
        "gap_left_rms": solved.gap_left[0],
        "gap_left_largest": solved.gap_left[1],
        "size": meshes.size,
        "block_mm": meshes.block,
        "held": held_words(solved),
        "dof": solved.unknowns,
        "meshes": solved.rounds,
        "seconds": solved.seconds,
    }


def label_pair(solved: SolvedPair) -> LabelledDataset:
    """Return pressures over arc and width, and what follows along the width, with units."""

    def variable(dims: tuple[str, ...], values: Any, unit: str, text: str) -> LabelledArray:
        return LabelledArray(dims, np.asarray(values), {"units": unit, "long_name": text})

    variables = {
        "x": variable(("x",), solved.x, "mm", "place along the tangent of the contact"),
        "height": variable(("height",), solved.height, "mm", "height above the middle of the width"),
        "pressure": variable(("x", "height"), solved.pressure, "MPa", "pressure at the vertices, an L2 projection"),
        "line_load": variable(("height",), solved.line_load, "N/mm", "load by length"),
        "peak_pressure": variable(("height",), solved.peak, "MPa", "largest pressure over the profile"),
        "half_width": variable(("height",), solved.half_width, "mm", "half-width, twice the root of the second moment"),
    }
    attributes = {name: value for name, value in summarise_pair(solved).items() if isinstance(value, str | float | int)}
    attributes |= {"code_version": code_version(), "code_hash": code_hash()}
    return LabelledDataset(variables, ("x", "height"), attributes)


def write_pair(solved: SolvedPair, out: Path, more: dict[str, Any] | None = None) -> None:
    """Write the files of a pair into a folder; `more` is added to the summary."""
    write_json(out / "summary.json", summarise_pair(solved) | (more or {}))
    with whole_file(out / "pair.nc") as part:
        write_netcdf(label_pair(solved), part)


def tabulate_pair(solved: SolvedPair) -> Sequence[str]:
    """Return the table that is printed, line by line."""
    half = 0.5 * solved.pair.length
    lines = [
        held_words(solved),
        f"load {solved.load:.6g} N, approach {1e3 * solved.approach:.6g} µm, tilt {solved.tilt:.6g} rad, "
        f"moment {solved.moment:.6g} N·mm",
        f"largest pressure {solved.largest_pressure:.5g} MPa at {solved.largest_height:+.4g} mm of ±{half:.4g} mm; "
        f"K_Hβ {solved.load_factor:.4g}",
        f"{'height, mm':>12}{'line load, N/mm':>18}{'peak, MPa':>12}{'half-width, µm':>16}",
    ]
    heights = np.linspace(-half, half, ROWS)
    columns = (solved.line_load, solved.peak, 1e3 * solved.half_width)
    for z, line, peak, width in zip(
        heights, *(np.interp(heights, solved.height, each) for each in columns), strict=True
    ):
        lines.append(f"{z:>12.3f}{line:>18.2f}{peak:>12.1f}{width:>16.1f}")
    root, most = (100.0 * value for value in solved.gap_left)
    lines += [
        f"gaps left where the pressure is above a tenth of the largest: {root:.2g} % of the approach in the "
        f"root mean square, {most:.2g} % at most",
        f"energy of the displacements and work of the pressures differ by {solved.energy_error:.1e}; "
        f"{solved.unknowns:,} unknowns, {solved.rounds} meshes, {solved.seconds:.1f} s",
    ]
    return lines
