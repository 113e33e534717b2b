"""Page of ``cyclo optimise``: starting drive and optimum."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ltca.page.study_page import Curves, Section, StudyPage
from ltca.page.tables import Table, number, word
from ltca.quantities import SCALARS
from ltca.studies.optimiser import Optimum


def optimum_page(name: str, told: str, optimum: Optimum, outcome: Mapping[str, Any], text: str) -> StudyPage:
    """Return the page of a search, `told` being what was asked, `outcome` what ``optimum.json`` holds, `text` the drive found."""
    variables = [
        [word(path), word(each["units"]), *(number(each[key]) for key in ("low", "high", "as_it_is", "found"))]
        for path, each in outcome["variables"].items()
    ]
    seen = ("as_it_is", "found", "as_it_is_in_search", "found_in_search")
    quantities = [
        [word(SCALARS[key].heading), *(number(each[column]) for column in seen)]
        for key, each in outcome["quantities"].items()
    ]
    fine, coarse = outcome["positions"], outcome["positions_of_candidates"]
    heads = ["", f"as it is, {fine} positions", f"found, {fine} positions", f"as it is, {coarse}", f"found, {coarse}"]
    varied = ["field", "unit", "from", "to", "as it is", "found"]
    tables = [
        Table(name="variables", caption="What was varied", columns=varied, rows=variables, words=1),
        Table(name="quantities", caption="What it reaches", columns=heads, rows=quantities),
    ]
    curves, aims = [], optimum.problem.aims
    if len(aims) == 2:
        columns = [optimum.problem.quantities.index(aim) for aim in aims]
        x, y = (optimum.values[:, column] for column in columns)
        good, front = optimum.feasible & np.isfinite(x) & np.isfinite(y), np.zeros(len(x), dtype=bool)
        front[optimum.front] = True
        lines = {
            "candidates within the limits": np.where(front, np.nan, y)[good],
            "Pareto front": np.where(front, y, np.nan)[good],
        }
        titles = [SCALARS[aim].heading for aim in aims]
        curves = [
            Curves(
                title=f"{titles[1]} over {titles[0]}", unit="", axis=titles[0], x=x[good], lines=lines, kind="points"
            )
        ]
    broken = outcome["broken_limits"]
    sentence = (
        f"Beyond {', '.join(broken)} when solved finely." if broken else "All limits are kept when solved finely."
    )
    if not outcome["limits"]:
        sentence = "Nothing was limited."
    state = "fail" if broken else "pass" if outcome["limits"] else ""
    made = {key: str(outcome[key]) for key in ("compliance", "method", "contacts", "candidates") if key in outcome}
    section = Section(heading="As it is and as found", tables=tables)
    within = f"{outcome['candidates']} candidates at {coarse} positions each, {int(optimum.feasible.sum())} within the limits."
    search = Section(heading="The search", curves=curves, notes=[within])
    return StudyPage(
        name=name, told=told, sentence=sentence, state=state, sections=[section, search], made=made, text=text
    )
