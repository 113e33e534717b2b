"""Page of ``cyclo optimise``: starting drive and optimum."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ltca.page.study_page import Curves, Section, StudyPage
from ltca.page.tables import Cell, Table, number, word
from ltca.quantities import SCALARS, unit_sign
from ltca.studies.optimiser import Optimum, front_span
from ltca.studies.study_results import field_column

OPENED = "Each is a drive file beside this page, for every command; values are those of the search, {}."


def optimum_page(
    name: str, told: str, optimum: Optimum, outcome: Mapping[str, Any], front: Mapping[str, int], text: str
) -> StudyPage:
    """Return the page of a search, `told` being what was asked, `outcome` what ``optimum.json`` holds, `text` the drive found.

    `front` has candidates of a Pareto front by the drive files that were written of them.
    """
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
    search = f"{outcome['candidates_compliance']}, {coarse} positions"
    finely = f"{outcome['compliance']}, {fine} positions"
    heads = ["", f"as it is, {finely}", f"found, {finely}", f"as it is, {search}", f"found, {search}"]
    varied = ["field", "unit", "from", "to", "as it is", "found"]
    tables = [
        Table(name="variables", caption="What was varied", columns=varied, rows=variables, words=1),
        Table(name="quantities", caption="What it reaches", columns=heads, rows=quantities),
    ]
    curves: list[Curves] = []
    notes: list[str] = []
    designs: list[Section] = []
    if len(optimum.problem.aims) == 2:
        curves, notes = _front(optimum)
        designs = [
            Section(heading="Designs of the front", notes=[OPENED.format(search)], tables=[_designs(optimum, front)])
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
    within = f"{outcome['candidates']} candidates on {search} each, {int(optimum.feasible.sum())} within the limits."
    looked = Section(heading="The search", curves=curves, notes=[within, *notes])
    return StudyPage(
        name=name, told=told, sentence=sentence, state=state, sections=[section, *designs, looked], made=made, text=text
    )


def _designs(optimum: Optimum, front: Mapping[str, int]) -> Table:
    problem = optimum.problem
    rows = []
    for file, candidate in front.items():
        sizes = [number(float(value)) for value in optimum.variables[candidate]]
        reached = [number(float(value)) for value in optimum.values[candidate]]
        best = word("compromise, optimum.toml" if candidate == optimum.best else "")
        rows.append([word(file.removesuffix(".toml")), Cell(text=file, value=file, link=file), *sizes, *reached, best])
    units = [field_column(variable.path)["units"] for variable in problem.variables]
    varied = [
        variable.path + (f" [{unit_sign(unit)}]" if unit != "1" else "")
        for variable, unit in zip(problem.variables, units, strict=True)
    ]
    columns = ["design", "drive file", *varied, *(SCALARS[name].heading for name in problem.quantities), ""]
    return Table(name="front", caption="", columns=columns, rows=rows, words=1, last_words=1)


def _front(optimum: Optimum) -> tuple[list[Curves], list[str]]:
    """The front among the candidates on axes that show it and the drive as it is, and how many lie beyond these."""
    (x, y), aims = optimum.values[:, :2].T, optimum.problem.aims
    left, right, low, high = span = front_span(optimum)
    good = optimum.feasible & np.isfinite(x) & np.isfinite(y)
    seen = good & (x >= left) & (x <= right) & (y >= low) & (y <= high)
    front = np.zeros(x.size, dtype=bool)
    front[optimum.front] = True
    best = np.arange(x.size) == optimum.best
    along, up = np.append(x[seen], optimum.start[0]), np.append(y[seen], optimum.start[1])
    near = left <= optimum.start[0] <= right and low <= optimum.start[1] <= high
    named = "the drive as it is" + ("" if near else ", beyond the axes")
    kinds = {
        "candidates within the limits": np.append(~front[seen], False),
        "Pareto front": np.append((front & ~best)[seen], False),
        "compromise": np.append(best[seen], False),
        named: np.append(np.zeros(int(seen.sum()), dtype=bool), True),
    }
    titles = [SCALARS[aim].heading for aim in aims]
    lines = {name: np.where(of, up, np.nan) for name, of in kinds.items()}
    large = ("Pareto front", "compromise", named)
    plot = Curves(
        title=f"{titles[1]} over {titles[0]}",
        unit="",
        axis=titles[0],
        x=along,
        lines=lines,
        kind="points",
        span=span,
        large=large,
    )
    beyond = int(good.sum() - seen.sum())
    told = f"{beyond} candidates within the limits lie beyond the axes, which show the front."
    return [plot], [told] if beyond else []
