"""How parts sit in each other: plays at temperature, and what bearings and supports yield against the clearance."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ltca.analysis.loaded_analysis import LoadedAnalysis
from ltca.analysis.verdict.places import largest_value
from ltca.arrays import FloatArray
from ltca.drive.members.judgement import Value
from ltca.drive.members.operation import Temperature
from ltca.drive.members.temperatures import warm_drive
from ltca.drive.parts import Drive
from ltca.geometry.interference import drawn_plays


def assembly_values(analysis: LoadedAnalysis) -> Iterator[Value]:
    """Yield plays at temperature, and deflections of crank bearings, cranks and wheel, also by the radial clearance.

    Parameters
    ----------
    analysis : LoadedAnalysis
        The case.
    """
    yield from play_at_temperature(analysis.as_written, analysis.drive)
    rollers = analysis.full.response.rollers
    deflections: list[tuple[FloatArray, str, str, int | None]] = [
        (np.maximum(rollers.inner_approach + rollers.outer_approach, 0.0), "bearing", "roller", None)
    ]
    moved, coordinates = np.abs(analysis.crank_deflections), analysis.model.coordinates
    if moved.shape[2]:
        deflections.append((moved.reshape(moved.shape[0], -1), "crank", "crank", None))
    if coordinates.wheel:
        place = analysis.full.pose[:, coordinates.wheel_place]
        deflections.append((np.hypot(place[:, :1], place[:, 1:]), "wheel", "", 1))
    clearance = 0.5 * analysis.drive.clearance.bearing
    for values, of, name, discs in deflections:
        yield largest_value(analysis, f"{of}_deflection", values, name, discs=discs)
        ratio = f"{of}_deflection_by_clearance"
        if clearance > 0.0:
            yield largest_value(analysis, ratio, values / clearance, name, discs=discs)
        else:
            yield Value(quantity=ratio, value=None, reason="the bearing has no clearance (clearance.bearing)")


def play_at_temperature(written: Drive, warm: Drive) -> Iterator[Value]:
    """Yield the least play that warmth has left where there was one at 20 °C; nothing of drives without temperatures.

    Parameters
    ----------
    written : Drive
        As given, with its temperatures.
    warm : Drive
        The same at them (`ltca.drive.members.temperatures.warm_drive`).
    """
    if written.temperature is None:
        return
    cold, now = drawn_plays(warm_drive(replace(written, temperature=Temperature()))), drawn_plays(warm)
    fitting = {what: play for what, play in now.items() if cold[what] >= 0.0}
    if not fitting:
        yield Value(quantity="play_at_temperature", value=None, reason="no joint has play at 20 °C")
        return
    least = min(fitting, key=lambda what: fitting[what])
    yield Value(quantity="play_at_temperature", value=fitting[least], part=f"{least}, {cold[least]:.4g} mm at 20 °C")
