"""Output of a search: drive files of the designs, and a table that compares them."""

from __future__ import annotations

import csv
import io
from dataclasses import replace
from typing import Any

from ltca.analysis.engines import describe_engine, engine_named
from ltca.drive.members.judgement import ANYWHERE
from ltca.drive.members.limits import Limits
from ltca.drive.parts import Analysis, Drive
from ltca.reading.writing import drive_text
from ltca.studies.design_search.demands import LEAST_DISC_SHARE, Demand, shown, written_limits
from ltca.studies.design_search.refinement import Refined, Task, relaxed_limits
from ltca.studies.design_search.requirement_words import assumed_words
from ltca.studies.design_search.requirements import Requirements
from ltca.studies.design_search.search import Found, Relaxation, factor_words
from ltca.studies.design_search.sizes import LEAST_DISTANCE, distance, drive_of
from ltca.studies.design_search.solution import CHECK_POSITIONS

SIZES = {
    "discs": "number of discs",
    "pins": "wheel pins",
    "sun": "teeth of the sun",
    "planet": "teeth of the planets",
    "eccentricity": "eccentricity, mm",
    "pin_circle": "pin circle radius, mm",
    "pin_radius": "wheel-pin radius, mm",
    "thickness": "thickness of a disc, mm",
    "bore": "bore radius, mm",
    "rollers": "rollers of a crank bearing",
    "roller_radius": "roller radius, mm",
    "roller_length": "roller length, mm",
    "holes": "shaft pins",
    "hole_circle": "circle of shaft pins or cranks, mm",
    "hole_pin": "shaft-pin radius, mm",
    "equidistant_offset": "equidistant offset, mm",
    "shifting_offset": "shifting offset, mm",
    "bearing_clearance": "clearance of the crank bearing, mm",
    "pin_hole_clearance": "clearance of the holes, mm",
    "lead_crown_drop": "lead crown drop of the flank, mm",
}
"""Sizes as they are told."""
REACHED = (
    "outer_diameter", "length", "torque", "bearing_life_hours", "bearing_life_million_turns", "static_safety_S0", "stiffness",
    "disc_share", "backlash_output", "lost_motion", "mean_efficiency", "pin_pressure_mid", "pin_shaft_pressure_mid",
    "roller_pressure_mid_outer", "roller_pressure_mid_inner", *ANYWHERE, "disc_tilt", "ptp_transmission_error",
)  # fmt: skip
"""What is told of each design, where it is known; pressures anywhere along the width with slices or where they are asked for."""


def named_design(refined: Refined, requirements: Requirements, name: str) -> Drive:
    """Return the drive of a design, which is analysed as it was solved."""
    drive = drive_of(refined.row, requirements, name)
    return replace(drive, analysis=Analysis(compliance=refined.solution.compliance))


def design_text(refined: Refined, found: Found, name: str) -> str:
    """Return a design as the text of a drive file with its limits; `cyclo check` passes it, but for a candidate as told in it."""
    values, positions = refined.solution.values, refined.solution.positions
    at = "" if positions == CHECK_POSITIONS else f" --positions {positions}"
    engine = describe_engine(engine_named(refined.solution.compliance))
    passes = f"`cyclo check{at}` passes it. Reached, by a fine solution"
    if not refined.solution.checks:
        passes = f"a candidate that no `cyclo check` has judged yet. Reached at {positions} positions"
    lines = [f"# Written by cyclo design; {passes}, {engine}:"]
    for demand in found.demands:
        if demand.kind in ("requirement", "limit") and demand.quantity in values:
            given = ", which gives way" if demand.name in refined.relaxed else ""
            told = demand.words(values[demand.quantity])
            lines.append(f"#   {demand.title}: {told} (asked: {demand.words()}{given})")
    if refined.row["sun"]:
        lines.append(f"#   first stage: {refined.row['sun']:.0f} teeth on {refined.row['planet']:.0f}")
    requirements = found.requirements
    if assumed := assumed_words(requirements):
        lines.append(f"# {assumed[0].upper()}{assumed[1:]}")
    task = Task(requirements=requirements, demands=found.demands, row=refined.row, relaxed=refined.relaxed)
    limits = relaxed_limits(written_limits(requirements), task)
    return "\n".join(lines) + "\n\n" + drive_text(named_design(refined, requirements, name)) + limits_text(limits)


def solved_on(refined: Refined) -> str:
    """Return the engine and the positions behind the values of a design."""
    return f"{refined.solution.compliance}, {refined.solution.positions} positions"


def refused_words(found: Found) -> str:
    """Return how many candidates were refused since one of their discs carries little; empty where there are none."""
    refused = [one for one in found.tried if "disc_share" in one.broken]
    if not refused:
        return ""
    least = min(one.solution.values["disc_share"] for one in refused)
    return (
        f"{len(refused)} of {len(found.tried) + len(found.designs)} candidates refused: a disc carries {least:.2g} of an even "
        f"share of the torque, less than {LEAST_DISC_SHARE:g}"
    )


def limits_text(limits: Limits) -> str:
    """Return limits as the table of a drive file."""
    lines = ["", "[limits]"]
    for key, limit in limits.items():
        source = limit.source.replace("\\", "\\\\").replace('"', '\\"')
        lines.append(f'{key} = {{ value = {limit.value!r}, source = "{source}" }}')
    return "\n".join(lines) + "\n" if limits else ""


def design_content(refined: Refined, found: Found, file: str) -> dict[str, Any]:
    """Return the entry of a design in ``design.json``; `file` is the drive file that was written for it."""
    return {
        "file": file,
        "sizes": {name: refined.row[name] for name in SIZES if refined.row[name]},
        "values": {name: refined.solution.values[name] for name in REACHED if name in refined.solution.values},
        "margins": {
            one.name: float(one.margin(refined.solution.values[one.quantity]))
            for one in found.demands
            if one.kind != "shape" and one.quantity in refined.solution.values
        },
        "positions": refined.solution.positions,
        "compliance": refined.solution.compliance,
    }


def relaxation_content(relaxation: Relaxation, file: str | None) -> dict[str, Any]:
    """Return the entry of a relaxation in ``design.json``; `file` is that of the drive that then fits, if one was found."""
    return {
        "requirements": [
            {
                "name": one.name,
                "quantity": one.quantity,
                "asked": one.value,
                "would_do": relaxation.would_do(one),
                "unit": one.unit,
            }
            for one in relaxation.demands
        ],
        "change": None if relaxation.refined is None else relaxation.change,
        "words": relaxation.words,
        "factor": factor_words(relaxation),
        "file": file,
        "broken_by_closed_forms": relaxation.broken,
    }


def comparison(found: Found, designs: list[tuple[str, Refined]]) -> list[list[str]]:
    """Return the table that compares designs: heading, asked, then a column each."""
    asked: dict[str, Demand] = {one.quantity: one for one in found.demands if one.kind != "shape"}
    rows = [["", "asked", *(name for name, _ in designs)]]
    if designs:
        rows.append(["solved on", "", *(solved_on(one) for _, one in designs)])
    for quantity in REACHED:
        values = [one.solution.values.get(quantity) for _, one in designs]
        alone = quantity == "disc_share" and all(one.row["discs"] == 1.0 for _, one in designs)
        if alone or all(value is None for value in values):
            continue
        demand = asked.get(quantity) or Demand(
            name=quantity, quantity=quantity, sense="max", value=0.0, kind="limit", source=""
        )
        cells = ["–" if value is None else shown(value, demand.unit) for value in values]
        rows.append([demand.title, demand.words() if quantity in asked else "–", *cells])
    for name, title in SIZES.items():
        if any(one.row[name] for _, one in designs):
            rows.append([title, "", *(f"{one.row[name]:.6g}" for _, one in designs)])
    if len(designs) > 1:
        others = [[other.row for _, other in designs if other is not one] for _, one in designs]
        nearest = [min(distance(one.row, row) for row in rest) for (_, one), rest in zip(designs, others, strict=True)]
        asked_distance = f"≥ {LEAST_DISTANCE:g}" if found.designs else "–"
        rows.append(["distance to the nearest other design", asked_distance, *(f"{each:.2f}" for each in nearest)])
    return rows


def csv_text(rows: list[list[str]]) -> str:
    """Return a table as CSV."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue()
