"""What the page of a run tells beside its positions: wind-up of each case, life of its crank bearings.

Both are what ``cyclo curves`` has, in short, and of the answers that are there already: wind-up between the two torques of the
run, and lives from its turn, which leave some thousandths to lives over many turns.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ltca.analysis.life.bearing_lives import BearingLives, bearing_lives
from ltca.analysis.life.equivalent_load import covers_whole_turns
from ltca.analysis.loaded_analysis import LoadedAnalysis
from ltca.arrays import FloatArray
from ltca.drive.units.quantities import ARCMIN
from ltca.errors import CycloError
from ltca.page.study_page import Section
from ltca.page.tables import Cell, Table, minus, number, word


def wind_up(analyses: Mapping[str, LoadedAnalysis], summaries: Mapping[str, Mapping[str, float | None]]) -> Section:
    """Return what the two torques of a run tell of the torque curve of every case.

    Parameters
    ----------
    analyses : mapping of str to LoadedAnalysis
        By case.
    summaries : mapping of str to mapping
        Their scalars.
    """
    rows, equal = list[list[Cell]](), list[str]()
    for name, analysis in analyses.items():
        wound = np.abs(analysis.transmission_error - analysis.transmission_error_light)
        wound = wound[analysis.balanced & analysis.balanced_light]
        light = analysis.drive.load.light_torque
        if not (wound.size and np.all(wound > 0.0)):
            equal.append(name)
            continue
        play = summaries[name]["backlash_output_arcmin"]
        stiffness = abs(analysis.torque - light) / wound
        torques = word(minus(f"{light / 1e3:.4g} … {analysis.torque / 1e3:.4g}"))
        rows.append([word(name), number(play), torques, _range(wound * ARCMIN), _range(stiffness / ARCMIN / 1e3)])
    notes = [
        "Least … largest over the positions, between the answers at the light torque and at the torque. The whole curve, both "
        "ways, with lost motion and loops of friction: cyclo curves."
    ]
    if equal:
        notes.append(
            f"{', '.join(equal)}: the light torque winds up no less than the torque, so nothing stands between them."
        )
    stiffness_title = "stiffness of the cycloid stage there, N·m/′"
    columns = ["case", "backlash at the output, ′", "torques, N·m", "wind-up between them, ′", stiffness_title]
    table = Table(name="wind_up", caption="", columns=columns, rows=rows)
    return Section(heading="Wind-up", notes=notes, tables=[table] if rows else [])


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
