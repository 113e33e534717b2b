"""``report.html`` of a run: verdict first, the drive as it turns, its curves and tables, and what it was computed from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import degrees
from typing import TYPE_CHECKING, Any

import numpy as np

from ltca.analysis.engines import Engine, describe_engine
from ltca.analysis.friction.losses import KINDS
from ltca.analysis.half_space_errors import at_torque, half_space_cautions
from ltca.analysis.life.bearing_lives import BearingLives
from ltca.analysis.summary import refined_value
from ltca.analysis.summary_rows import rows_of, with_residual_part
from ltca.arrays import FloatArray
from ltca.drive.members.judgement import Check
from ltca.drive.members.temperatures import warm_drive
from ltca.drive.parts import Drive
from ltca.drive.single_discs import single_discs
from ltca.figures.shared_axes import contact_values, deviation, run_axes, run_values
from ltca.page.compared import Compared, matched
from ltca.page.packing import pack
from ltca.page.run_arrays import has_friction, run_arrays, shown_positions
from ltca.page.run_sections import lives_of_cases, wind_up
from ltca.page.run_tables import derived_tables, input_tables, orders_table, summary_tables, turn_orders
from ltca.page.scene import moving_scene
from ltca.page.tables import Table, number, texts, word
from ltca.page.verdict_tables import verdict_of, verdict_tables
from ltca.page.writing import page_text, script_data
from ltca.quantities import SCALARS

if TYPE_CHECKING:
    from ltca.output.labelled import Labelled

PAGE = "report.html"
STAGE = ("drawing", "plots", "motion", "stage", "width", "run")
"""Scripts of the moving drive."""
LOSSES = {kind: SCALARS[f"power_loss_{kind}"].title.removeprefix("power lost: ") for kind in KINDS}


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    """What a page of a run shows.

    Attributes
    ----------
    dataset : LabelledDataset or xarray.Dataset
        Results of the run (`ltca.analysis.results.labelled_results`, or ``results.nc`` read back).
    drives : mapping of str to Drive
        As they were given, by case.
    engine : Engine
        What the run was solved on.
    summaries : mapping of str to mapping
        Scalars by case (`ltca.analysis.summary.summarise`).
    checks : mapping of str to sequence of Check
        Verdict by case; none of cases without an answer somewhere.
    lives : mapping of str to BearingLives or str
        Of the crank bearings by case, or why there are none.
    sampling : sequence of str
        Warnings, behind "warning: ", and further lines on the positions.
    method : sequence of (str, str)
        What the values stand for: names and texts of rows.
    light : LabelledDataset, xarray.Dataset or None
        The same results at the light torque (`ltca.analysis.light_torque`); without them the drive moves at its torque alone.
    compared : Compared or None
        What stands beside it.
    """

    dataset: Labelled
    drives: Mapping[str, Drive]
    engine: Engine
    summaries: Mapping[str, Mapping[str, float | None]]
    checks: Mapping[str, Sequence[Check]]
    lives: Mapping[str, BearingLives | str]
    sampling: Sequence[str]
    light: Labelled | None = None
    compared: Compared | None = None
    method: Sequence[tuple[str, str]] = ()


def run_page(run: Run) -> str:
    """Return the page of a run; the same run gives the same page."""
    return page_text("run.html", run_context(run), scripts=(*STAGE, "opened"))


def run_context(run: Run) -> dict[str, Any]:
    """Return what the templates of the page of a run are filled with."""
    drives = {case: warm_drive(drive) for case, drive in run.drives.items()}
    return answer_context(run, drives) | {
        "inputs": input_tables(run.drives),
        "derived": derived_tables(run.drives, drives),
        "made": _made(run, drives),
        "text": run.dataset.attrs["drive_file"],
    }


def answer_context(run: Run, drives: Mapping[str, Drive]) -> dict[str, Any]:
    """Return what the templates are filled with of the answer alone; `drives` are warm."""
    dataset, cases = run.dataset, list(run.drives)
    name, positions = str(dataset.attrs["drive"]), dataset.sizes["position"]
    loads = [drive.load_words(_torque(dataset, place)) for place, drive in enumerate(drives.values())]
    loaded = {name: at_torque(drive, _torque(dataset, place)) for place, (name, drive) in enumerate(run.drives.items())}
    shown = shown_positions(dataset)
    sentence, state = verdict_of(run.checks)
    unjudged = [case for case in cases if case not in run.checks]
    if unjudged and run.checks:
        sentence, state = f"No answer at some positions, not judged: {', '.join(unjudged)}. {sentence}", "fail"
    sections = [wind_up(dataset, run.summaries, run.drives), lives_of_cases(run.lives)]
    content, numbers = script_numbers(run, drives)
    return {
        "title": f"{name}: loaded tooth contact analysis",
        "drive": name,
        "cases": cases,
        "model": describe_engine(run.engine),
        "loads": list(dict.fromkeys(loads)),
        "positions": positions,
        "thinned": 0 if shown.size == positions else int(shown[1]),
        "version": dataset.attrs["version"],
        "sentence": sentence,
        "state": state,
        "caution": "; ".join(half_space_cautions(run.engine, loaded)),
        "verdicts": verdict_tables(run.checks),
        "summary": summary_tables(drives, run.summaries),
        "orders": orders_table(dataset, drives),
        "sections": list(zip(("wind_up", "life"), sections, strict=True)),
        "friction": has_friction(dataset.isel(case=0)),
        "several": len(cases) > 1,
        "sliced": "slice" in dataset.sizes,
        "comparison": _comparison(run),
        "compared": run.compared,
        "warnings": [line.removeprefix("warning: ") for line in run.sampling if line.startswith("warning: ")],
        "data": script_data(content),
        "numbers": numbers,
    }


def script_numbers(run: Run, drives: Mapping[str, Drive]) -> tuple[dict[str, Any], str]:
    """Return what the scripts of the moving drive read, and its arrays as text (`ltca.page.packing`); `drives` are warm."""
    dataset = run.dataset
    places, numbers = pack(_arrays(run, drives))
    content = {
        "cases": [_case(dataset, place, drive) for place, drive in enumerate(drives.values())],
        "names": list(run.drives),
        "places": places,
        "cranks": dataset.sizes["crank"],
        "discs": dataset.sizes["disc"],
        "losses": LOSSES,
        "axes": _axes(run),
        "compared": _compared(run),
    }
    return content, numbers


def _torque(dataset: Labelled, place: int) -> float:
    """Output torque of a case, N·mm."""
    return float(dataset["torque"].values[place])


def _arrays(run: Run, drives: Mapping[str, Drive]) -> dict[str, FloatArray]:
    arrays = run_arrays(run.dataset, run.light, shown_positions(run.dataset))
    for place, drive in enumerate(drives.values()):
        lines = turn_orders(run.dataset.isel(case=place))
        if lines is not None:
            most = max(5 * drive.disc.number_of_teeth, 2 * drive.number_of_holes, 40)
            arrays[f"{place}/orders"] = lines[:most]
    beside = {} if run.compared is None else run.compared.arrays
    return arrays | {f"b/{name}": values for name, values in beside.items()}


def _axes(run: Run) -> dict[str, list[float]]:
    """Ends and steps of the axes of curves, as the figures of the run have them; wider where a second run asks for it."""
    values = run_values(run.dataset) | ({} if run.light is None else contact_values(run.light, "light"))
    for name, each in ({} if run.compared is None else run.compared.arrays).items():
        key = name.partition("/")[2]  # behind the number of the case
        of = ("full/te", "light/te") if name == "measured/te" else (key,) if key in values else ()
        for axis in of:
            added = deviation(each) if axis.endswith("te") else each
            values[axis] = np.concatenate([values[axis].ravel(), added.ravel()])
    return {name: list(axis) for name, axis in run_axes(values, run.dataset.sizes["disc"]).items()}


def _case(dataset: Labelled, place: int, drive: Drive) -> dict[str, Any]:
    return {
        "scenes": [moving_scene(single) for single in single_discs(drive)],
        "torque": _torque(dataset, place) / 1000.0,
        "light": drive.load.light_torque / 1000.0,
        "widths": {
            "pin": drive.disc.thickness,
            "outer": drive.roller_length,
            "hole": drive.disc.thickness,
            "play": drive.disc.axial_play,
        },
        "direction": drive.load.direction,
        "sign": int(drive.driving_sign),
    }


def _compared(run: Run) -> dict[str, Any] | None:
    beside = run.compared
    if beside is None:
        return None
    own = run.engine.options["compliance"]
    name = beside.name if beside.name != own else "second run"
    match = matched(run.drives, beside) if beside.cases else []
    return {"name": name, "cases": list(beside.cases), "match": match}


def _comparison(run: Run) -> list[Table]:
    """Scalars of both runs side by side, a table for each case."""
    beside, tables = run.compared, list[Table]()
    for case, place in zip(run.drives, matched(run.drives, beside) if beside and beside.cases else (), strict=False):
        assert beside is not None
        other = beside.summaries.get(beside.cases[place])
        if other is None:
            continue
        both = {"first": with_residual_part(run.summaries[case])}
        rows = []
        for row in rows_of(both, yields=False):
            mine, theirs = refined_value(both["first"], row.key), refined_value(other, row.key)
            change = 100.0 * (theirs / mine - 1.0) if mine and theirs is not None else None
            values = [number(value, f"{{:{row.digits}}}", row.unit) for value in (mine, theirs)]
            rows.append([word(row.title), *values, number(change, "{:+.2f}", "%")])
        heads = ["", f"this run, {case}", f"second run, {beside.cases[place]}", "change"]
        tables.append(Table(name=f"compared_{len(tables)}", caption=case, columns=heads, rows=rows))
    return tables


def _made(run: Run, drives: Mapping[str, Drive]) -> Table:
    """What the numbers were computed by."""
    angles, attributes = run.dataset["crank_angle"].values, run.dataset.attrs
    where = f"{angles.size}, {degrees(angles.min()):.6g}° … {degrees(angles.max()):.6g}°"
    options = [(name.replace("_", " "), str(value)) for name, value in run.engine.options.items()]
    rows = [
        ("version of cyclo", attributes["version"]),
        ("hash of its code", attributes["code_hash"]),
        *options,
        ("positions of the crank", where),
        *(("sampling", line) for line in run.sampling if not line.startswith("warning: ")),
        *run.method,
        *(
            (f"fingerprint of {name}" if len(drives) > 1 else "fingerprint of the drive", drive.fingerprint())
            for name, drive in drives.items()
        ),
    ]
    return Table(name="computed_by", caption="", columns=["", "value"], rows=texts(rows), words=1)
