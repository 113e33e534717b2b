"""Sections of the page of a run beside its positions: wind-up and life of the crank bearings.

Both are what ``cyclo curves`` has, in short, and of the answers that are there already: wind-up between the two torques of the
run, and lives from its turn, which leave some thousandths to lives over many turns.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from ltca.analysis.life.bearing_lives import BearingLives
from ltca.arrays import FloatArray
from ltca.drive.parts import Drive
from ltca.drive.units.quantities import ARCMIN
from ltca.drive.yielding_parts import stiffness_notes, yielding_parts
from ltca.page.study_page import Section
from ltca.page.tables import Cell, Table, minus, number, word
from ltca.quantities import SCALARS

if TYPE_CHECKING:
    from ltca.output.labelled import Labelled

PLAY = SCALARS["backlash_output"]


def wind_up(
    dataset: Labelled, summaries: Mapping[str, Mapping[str, float | None]], drives: Mapping[str, Drive]
) -> Section:
    """Return the wind-up of every case between the two torques of the run."""
    rows, equal = list[list[Cell]](), list[str]()
    for place, name in enumerate(summaries):
        case = dataset.isel(case=place)
        known = (case["status"].values == 0) & (case["status_light"].values == 0)
        wound = np.abs(case["transmission_error"].values - case["transmission_error_light"].values)[known]
        torque, light = float(case["torque"].values), float(case["light_torque"].values)
        turned = (case["wheel_angle"].values - case["wheel_angle_light"].values)[known]
        of_stage = np.abs(drives[name].output_deviation(turned, torque - light))
        if not (wound.size and np.all(wound > 0.0) and np.all(of_stage > 0.0)):
            equal.append(name)
            continue
        stiffness = [_range(abs(torque - light) / each / ARCMIN / 1e3) for each in (of_stage, wound)]
        torques = word(minus(f"{light / 1e3:.4g} … {torque / 1e3:.4g}"))
        play = number(summaries[name][PLAY.key])
        rows.append([word(name), play, torques, _range(wound * ARCMIN), *stiffness])
    notes = [
        "Least … largest over the positions, between the answers at the light torque and at the torque. The whole curve, both "
        "ways, with lost motion and loops of friction: cyclo curves."
    ]
    if equal:
        notes.append(
            f"{', '.join(equal)}: the light torque winds up no less than the torque, so nothing stands between them."
        )
    notes += stiffness_notes({name: yielding_parts(drive) for name, drive in drives.items()})
    titles = ["stiffness of the cycloid stage there, N·m/′", "of the reducer with what the file describes, N·m/′"]
    columns = ["case", "backlash at the output, largest sampled, ′", "torques, N·m", "wind-up between them, ′", *titles]
    table = Table(name="wind_up", caption="", columns=columns, rows=rows)
    return Section(heading="Wind-up", notes=notes, tables=[table] if rows else [])


def lives_of_cases(lives: Mapping[str, BearingLives | str]) -> Section:
    """Return the shortest life of the crank bearings of every case, or why a case has none."""
    rows, notes = list[list[Cell]](), list[str]()
    for name, found in lives.items():
        if isinstance(found, str):
            notes.append(f"{name}: no life, {found}")
        elif found.not_rated:
            notes.append(f"{name}: ISO 281 rates no such crank bearing, {'; '.join(found.not_rated)}")
        else:
            rows.append(_life_row(name, found))
    makers = [name for name, found in lives.items() if not isinstance(found, str) and found.of_maker]
    if makers:
        notes.append(f"Of {', '.join(makers)} C and C0 are those of the maker where the drive gives them.")
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
