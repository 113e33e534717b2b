"""What the page of a run tells beside its positions: torque curve of each case, life of its crank bearings.

Both are what ``cyclo curves`` has, in short: a torque curve at a few crank angles over one mesh, and lives from the turn of the
run, which leave some thousandths to lives over many turns.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ltca.analysis.life.bearing_lives import BearingLives, bearing_lives
from ltca.analysis.life.equivalent_load import covers_whole_turns
from ltca.analysis.loaded_analysis import LoadedAnalysis
from ltca.analysis.torque_curve import TorqueCurve, torque_curve
from ltca.drive.units.quantities import ARCMIN
from ltca.errors import CycloError
from ltca.page.studies.curves import torque_section
from ltca.page.study_page import Section
from ltca.page.tables import Cell, Table, minus, number, word

FloatArray = NDArray[np.float64]

ANGLES = 4
"""Crank angles of a torque curve, over one mesh."""


def torque_curves(analyses: Mapping[str, LoadedAnalysis]) -> Section:
    """Return the torque curve of every case and what is read from them.

    Parameters
    ----------
    analyses : mapping of str to LoadedAnalysis
        By case.
    """
    curves, rows, notes = [], list[list[Cell]](), list[str]()
    for name, analysis in analyses.items():
        try:
            curve = _torque_curve(analysis)
        except CycloError as error:
            notes.append(f"{name}: no torque curve, {error}")
            continue
        (plot,) = torque_section(curve, "").curves
        curves.append(replace(plot, title=f"{name}: wind-up of the output" if len(analyses) > 1 else plot.title))
        values = (curve.backlash * ARCMIN, curve.lost_motion * ARCMIN, curve.stiffness / ARCMIN / 1e3)
        rows.append([word(name), *(_range(each) for each in values)])
        part = f"lost motion at ±{100.0 * curve.lost_motion_part:g} %, ′"
    if not rows:
        return Section(heading="Torque curve", notes=notes)
    columns = [
        "case",
        "backlash, all clearances, ′",
        part,
        "stiffness of the cycloid stage, 50 … 100 % of the torque, N·m/′",
    ]
    notes.append(
        f"Least … largest at {ANGLES} crank angles over one mesh; more of it, and loops of friction: cyclo curves."
    )
    table = Table(name="torque_curve", caption="", columns=columns, rows=rows)
    return Section(heading="Torque curve", notes=notes, curves=curves, tables=[table])


def _torque_curve(analysis: LoadedAnalysis) -> TorqueCurve:
    drive = analysis.drive
    loaded = replace(drive, load=replace(drive.load, torque=analysis.torque))
    mesh = 2.0 * np.pi / drive.disc.number_of_teeth
    return torque_curve(loaded, mesh * np.arange(ANGLES) / ANGLES, engine=analysis.engine)


def lives_of_cases(analyses: Mapping[str, LoadedAnalysis]) -> Section:
    """Return the lives of the crank bearings of every case, the shortest of each.

    Parameters
    ----------
    analyses : mapping of str to LoadedAnalysis
        By case.
    """
    rows, notes = list[list[Cell]](), list[str]()
    for name, analysis in analyses.items():
        if not (analysis.is_complete and covers_whole_turns(analysis.full.crank_angle)):
            notes.append(f"{name}: no life, positions cover no whole turn or have no answer.")
            continue
        try:
            lives = bearing_lives(analysis)
        except CycloError as error:
            notes.append(f"{name}: no life, {error}")
            continue
        if lives.not_rated:
            notes.append(f"{name}: ISO 281 rates no such crank bearing, {'; '.join(lives.not_rated)}")
            continue
        rows.append(_life_row(name, lives))
    columns = ["case", "shortest of", "C, N", "P, N", "L10r, million turns", "L10r, h", "S0"]
    table = Table(name="life", caption="", columns=columns, rows=rows, words=1)
    notes.append(
        "Lives by ISO 16281:2025 from the loads of this turn; hours at load.speed or those of the duty. With a maker's rating, "
        "a_ISO and more turns: cyclo curves."
    )
    return Section(heading="Life of the crank bearings", notes=notes, tables=[table] if rows else [])


def _life_row(name: str, lives: BearingLives) -> list[Cell]:
    found = lives.shortest
    which = (
        f"{len(lives.bearings)} bearings: disc {found.disc}, crank {found.crank}"
        if len(lives.bearings) > 1
        else "1 bearing"
    )
    return [
        word(name),
        word(which),
        number(lives.dynamic_load_rating, "{:.0f}"),
        number(found.equivalent_load, "{:.0f}"),
        number(found.life, "{:.1f}"),
        number(found.hours, "{:.0f}"),
        number(lives.static_safety, "{:.2f}"),
    ]


def _range(values: FloatArray) -> Cell:
    return word(minus(f"{values.min():.4g} … {values.max():.4g}"))
