"""The answer of an analysis at its light torque, as an analysis at that torque."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ltca.analysis.loaded_analysis import LoadedAnalysis
from ltca.compliance.response import ContactPressures, KindPressures
from ltca.drive.parts import Drive
from ltca.equilibrium.reducer import bearing_forces
from ltca.output.case_texts import with_case_names


def at_light_torque(analysis: LoadedAnalysis) -> LoadedAnalysis:
    """Return an analysis with its light torque as the torque of the run, without friction and stresses of walls.

    Pressures and half-widths are not a number where a position has no answer, or where contact grids would have to be solved
    again, which takes minutes.
    """
    light, model = analysis.light, analysis.model
    known = np.all(analysis.balanced_light) and analysis.engine.options.get("contacts") != "grids"
    push = bearing_forces(model, light.crank_angle, light.response)
    return replace(
        analysis,
        torque=analysis.drive.load.light_torque,
        full=light,
        pressures=model.pressures(light.response) if known else _unknown(analysis.pressures),
        bearing_radial=push.real,
        bearing_tangential=push.imag,
        wall_stresses=(),
        balanced=analysis.balanced_light,
        back=None,
    )


def light_torque_lines(cases: Mapping[str, Drive], torque: float | None = None) -> list[str]:
    """Return lines on the light torques that the file leaves out, for every screen with results at the light torque.

    `torque` is the output torque in N·mm, that of each drive by default.
    """
    loads = {
        name: drive.load if torque is None else replace(drive.load, torque=torque) for name, drive in cases.items()
    }
    words = {name: load.light_torque_words for name, load in loads.items()}
    return with_case_names({name: [f"light torque {text}"] if text else [] for name, text in words.items()})


def _unknown(pressures: ContactPressures) -> ContactPressures:
    """Pressures of the same contacts, all of them not a number."""

    def of_kind(kind: KindPressures) -> KindPressures:
        nothing = np.full_like(kind.mid, np.nan)
        return replace(kind, mid=nothing, largest=nothing, half_width=nothing)

    kinds = (pressures.pins, pressures.outer, pressures.inner, pressures.holes)
    pins, outer, inner, holes = map(of_kind, kinds)
    return replace(pressures, pins=pins, outer=outer, inner=inner, holes=holes)
