"""What the studio answers of the text of a drive file: the page of a run in parts, or how results follow a field."""

from __future__ import annotations

import re
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import gcd
from typing import Any

from ltca.analysis.derivatives import LostMotion, derivatives
from ltca.analysis.engines import (
    CoupledEngine,
    Engine,
    HalfSpace,
    describe_engine,
    engine_of,
    lending_between,
    ring_lender,
)
from ltca.analysis.extremes import RESOLVED, sampling_warning
from ltca.analysis.life.bearing_lives import BearingLives, bearing_lives
from ltca.analysis.light_torque import at_light_torque, light_torque_lines
from ltca.analysis.loaded_analysis import LoadedAnalysis, analyse_cases
from ltca.analysis.reactions import relieved_rows_warning
from ltca.analysis.results import case_arrays, labelled_results
from ltca.analysis.summary import FREE_PLAY, OF_FLANK, refined_value, scalars_of_positions, summarise_cases
from ltca.analysis.summary_rows import rows_of, with_residual_part
from ltca.analysis.torque_curve import LOST_MOTION, curve_angles
from ltca.analysis.verdict.proportions import odd_proportions
from ltca.analysis.verdict.values import judge_analysis
from ltca.arrays import FloatArray
from ltca.compliance.coefficient_files import has_coefficients
from ltca.compliance.ring import has_ring
from ltca.drive.engine_support import require
from ltca.drive.fields import field_kind
from ltca.drive.members.temperatures import warm_drive
from ltca.drive.members.verdict_words import CLOSE
from ltca.drive.parts import Drive
from ltca.drive.ring_shape import has_ring_of_elements
from ltca.drive.single_discs import single_discs
from ltca.drive.units.quantities import ARCMIN
from ltca.errors import ConvergenceError, CycloError, DriveError
from ltca.geometry.placement import position_angles
from ltca.page.run_page import Run, answer_context
from ltca.page.run_tables import derived_tables
from ltca.page.tables import minus
from ltca.page.writing import fragment
from ltca.quantities import SCALARS, printed, unit_sign
from ltca.reading.arguments import refuse_impossible_torques
from ltca.reading.drive_file import DriveFile, parse_drive

COARSE, FINE, DERIVATIVE = "coarse", "fine", "derivative"
CACHED = "cached"
"""Compliance of a fine answer: what the drive file says where its coefficients are there, half-spaces elsewhere."""
ENGINES = {"half-space": "half-spaces", "hybrid": "hybrid", "fe": "plane strain"}
"""Names of engines in a caution."""
COARSE_POSITIONS, FEWER_POSITIONS, MANY_CONTACTS = 36, 16, 60
"""Positions of a coarse answer, and those of a drive of more contacts than this."""
FINE_POSITIONS = 360
"""As ``cyclo run`` has them."""
OFFSET = 1e-3
"""Of the coarse crank angles, rad: not those of a turn, whose extremes would be refined."""
WITH_THE_FINE = {*OF_FLANK, *FREE_PLAY, "preload"}
"""Quantities that take longer than a coarse answer may."""
OF_DERIVATIVES = (
    "max_pin_load", "max_pin_pressure_mid", "max_roller_load", "mean_bearing_load", "ptp_transmission_error",
)  # fmt: skip
"""Scalars whose derivatives are told, beside that of the lost motion."""
FRICTION = "friction"
SMALL = 1e-3
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
NOTHING = 1e-9
"""Change relative to the value up to which it is told as none: what is left of sums."""
STEPS = {"mm": (1e-3, "1 µm"), "rad": (1.0 / ARCMIN, "1′"), "N*mm": (1e3, "1 N·m"), "degC": (1.0, "1 °C")}
"""Change of a field that a derivative is told for, by its unit: the number and the words; 1 % of others."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Question:
    """What a page asks.

    Attributes
    ----------
    text : str
        Of the drive file.
    source : str
        Where it is from: measured files are looked for beside it, and the drive is named after it.
    case : str
        One of its cases; the first for a name that it is without.
    quality : str
        `COARSE`, `FINE` or `DERIVATIVE`.
    compliance : str
        How bodies yield in a fine answer: ``half-space``, ``hybrid``, ``fe``, ``file`` for what the drive file says, or
        `CACHED`.
    field : str
        Of a derivative.
    """

    text: str
    source: str
    case: str
    quality: str
    compliance: str = "half-space"
    field: str = ""


class Memory:
    """What a worker keeps from one question to the next."""

    def __init__(self) -> None:
        self.near: LoadedAnalysis | None = None
        self.key: tuple[str, str] = ("", "")
        self.lost: LostMotion | str | None = None
        self.lost_key: tuple[str, str] = ("", "")


def answer(question: Question, memory: Memory) -> dict[str, Any]:
    """Return the answer as plain data: parts of a page, or mistakes by field, or why there is no answer."""
    began = time.process_time()
    try:
        file = parse_drive(question.text, question.source)
        name = question.case if question.case in file.cases else next(iter(file.cases))
        refuse_impossible_torques([file.cases[name]])
        found = (_derivative if question.quality == DERIVATIVE else _run)(question, memory, file, name)
    except DriveError as error:
        found = {"problems": [problem_of(one) for one in error.problems]}
    except CycloError as error:
        found = {"failure": str(error)}
    return {**found, "seconds": time.process_time() - began}


def _run(question: Question, memory: Memory, file: DriveFile, name: str) -> dict[str, Any]:
    """The page of a run of one case in parts."""
    drive, fine = file.cases[name], question.quality == FINE
    failure = ""
    decides = lending_between(file.cases.values(), engine_of([drive]))
    engine: Engine
    if fine:
        engine = decides
        if question.compliance == CACHED and not _is_cached(decides, drive):
            engine = HalfSpace()
        elif question.compliance not in (CACHED, "file"):
            engine = lending_between(file.cases.values(), engine_of([drive], question.compliance))
        ((_, found),) = analyse_cases({name: drive}, position_angles(FINE_POSITIONS), None, engine)
    else:
        engine, found = HalfSpace(), _coarse(drive, memory)
        memory.key = (question.text, name)
    if isinstance(found, ConvergenceError):
        failure = str(found)
        if found.partial is None:
            raise found
        found = found.partial
    analysis: LoadedAnalysis = found
    summary = summarise_cases({name: analysis}, without_load=fine, masses=fine)[name]
    checks = {}
    if analysis.is_complete:
        checks[name] = judge_analysis(analysis, summary, file.limits[name], lives=False)
        if not fine:
            checks[name] = [one for one in checks[name] if one.value.quantity not in WITH_THE_FINE]
    told = [*analysis.warnings, relieved_rows_warning(analysis), *odd_proportions(analysis.as_written)]
    angles = analysis.full.crank_angle
    if fine:
        told.append(sampling_warning(analysis.drive, angles, typed=""))
    told += light_torque_lines({name: analysis.drive})
    if failure:
        told.insert(0, f"partial, some positions have no answer: {failure}")
    run = Run(
        dataset=labelled_results(file.name, {name: analysis}, question.text),
        drives={name: analysis.as_written},
        engine=engine,
        summaries={name: summary},
        checks=checks,
        lives={name: _lives(analysis)} if fine else {},
        sampling=[f"warning: {one}" for one in told if one is not None],
        light=labelled_results(file.name, {name: at_light_torque(analysis)}, question.text),
    )
    context = answer_context(run, {name: analysis.drive}) | {"fine": fine}
    if fine:
        context["derived"] = derived_tables(run.drives, {name: analysis.drive})
    return {
        "drive": file.name,
        "case": name,
        "positions": int(angles.size),
        "model": describe_engine(engine),
        "load": ", ".join(context["loads"]),
        "sentence": context["sentence"],
        "state": context["state"],
        "caution": _caution(engine, decides) or context["caution"],
        "warnings": [minus(one) for one in context["warnings"]],
        "html": {"verdict": _part("verdict.html", context), "results": _part("answer.html", context)},
        "data": context["data"],
        "numbers": context["numbers"],
        "summary": _summary(summary),
    }


def _is_cached(engine: Engine, drive: Drive) -> bool:
    """Whether an engine takes a drive, and all its coefficients are there."""
    if not isinstance(engine, CoupledEngine):
        return True
    warm = warm_drive(drive)
    try:
        require(warm, engine.compliance)
    except DriveError:
        return False
    bodies = engine.bodies_of(single_discs(warm))
    rings = not has_ring_of_elements(warm) or has_ring(ring_lender(warm, engine.rings) or warm)
    return rings and all(has_coefficients(body, engine.bodies) for body in bodies)


def _caution(engine: Engine, decides: Engine) -> str:
    """Which engine an answer is of, where ``cyclo check`` decides on another one; empty otherwise."""
    engine_name, other = (ENGINES[one.compliance] for one in (engine, decides))
    if engine_name != other:
        return f"{engine_name}: cyclo check decides on {other}"
    return ""


def _coarse(drive: Drive, memory: Memory) -> LoadedAnalysis | ConvergenceError:
    """The analysis of few positions on half-spaces, from poses near by where there are some."""
    angles = coarse_angles(drive)
    near = memory.near
    if near is not None and near.full.crank_angle.size != angles.size:
        near = None
    found: LoadedAnalysis | ConvergenceError | None = None
    if near is not None:
        ((_, found),) = analyse_cases({"": drive}, angles, None, HalfSpace(), near)
    if not isinstance(found, LoadedAnalysis):
        ((_, found),) = analyse_cases({"": drive}, angles, None, HalfSpace())
    memory.near = found if isinstance(found, LoadedAnalysis) else None
    return found


def coarse_angles(drive: Drive) -> FloatArray:
    """Return the crank angles of a coarse answer: few, and of enough phases of the mesh."""
    contacts = drive.disc.number_of_discs * (
        drive.pin_wheel.number_of_pins
        + drive.crank.number * drive.crank_bearing.number_of_rollers
        + drive.number_of_holes
    )
    count = COARSE_POSITIONS if contacts <= MANY_CONTACTS else FEWER_POSITIONS
    while count // gcd(count, drive.disc.number_of_teeth) < RESOLVED:
        count += 1
    return position_angles(count) + OFFSET


def _lives(analysis: LoadedAnalysis) -> BearingLives | str:
    """Lives of the crank bearings, or why there are none."""
    if not analysis.is_complete:
        return "some positions have no answer."
    try:
        return bearing_lives(analysis)
    except CycloError as error:
        return str(error)


def _part(template: str, context: Mapping[str, Any]) -> str:
    return fragment(template, context, "ltca.studio")


def _summary(summary: Mapping[str, float | None]) -> list[dict[str, Any]]:
    """Scalars as rows of name, number and text, for two variants beside each other."""
    rows = []
    for row in rows_of({"": with_residual_part(summary)}, yields=False):
        value = refined_value(summary, row.key)
        if value is not None:
            text = _with_unit(printed(value, f"{{:{row.digits}}}", row.unit), row.unit)
            rows.append({"key": row.key, "title": row.title, "value": value, "text": text})
    return rows


def _with_unit(text: str, unit: str) -> str:
    """A printed number with its unit; signs of angles close to it."""
    sign = unit_sign(unit)
    return minus(text) + (sign if sign in CLOSE else f" {sign}" if sign else "")


def _derivative(question: Question, memory: Memory, file: DriveFile, name: str) -> dict[str, Any]:
    """How results follow one field, told for a small change of it."""
    drive = file.cases[name]
    if memory.key != (question.text, name) or memory.near is None:
        found = _coarse(drive, memory)
        memory.key = (question.text, name)
        if isinstance(found, ConvergenceError):
            raise found
    assert memory.near is not None
    slopes = derivatives(memory.near, [question.field])
    kind, value = field_kind(question.field), _number(memory.near.as_written, question.field)
    unit = "" if kind is None else kind.unit
    step, words = STEPS.get(unit, (0.01 * abs(value) or 0.01, "1 %" if value else "0.01"))
    cells, lost = [], _lost_motion(question, memory, drive, name)
    if isinstance(lost, LostMotion) and not question.field.startswith(f"{FRICTION}."):
        change, now = float(lost.slope(question.field).mean()) * step * ARCMIN, float(lost.value.mean()) * ARCMIN
        cells.append({"title": "lost motion", "value": change, "text": f"{_signed(change, now)}′"})
    values = scalars_of_positions(memory.near, case_arrays(memory.near))
    for scalar in (SCALARS[one] for one in OF_DERIVATIVES):
        if scalar.key not in slopes:
            continue
        change, now = float(slopes[scalar.key].values[0]) * step, float(values[scalar.name])
        cells.append({"title": scalar.title, "value": change, "text": _with_unit(_signed(change, now), scalar.unit)})
    return {"field": question.field, "step": words, "cells": cells, "note": _note(lost, drive)}


def _signed(change: float, value: float) -> str:
    """A change of a value with its sign and three digits, small ones by a power of ten."""
    if abs(change) <= NOTHING * abs(value):
        return "0"
    if abs(change) >= SMALL:
        return minus(f"{float(f'{change:.3g}'):+.10g}")
    figures, _, power = f"{change:+.2e}".partition("e")
    return f"{minus(figures)}·10{str(int(power)).translate(RAISED)}"


def _lost_motion(question: Question, memory: Memory, drive: Drive, name: str) -> LostMotion | str:
    """What is balanced for lost motion, once for all fields, or why there is none."""
    if memory.lost is None or memory.lost_key != (question.text, name):
        try:
            memory.lost = LostMotion(drive, curve_angles(drive))
        except CycloError as error:
            memory.lost = str(error)
        memory.lost_key = (question.text, name)
    return memory.lost


def _note(lost: LostMotion | str, drive: Drive) -> str:
    """What lost motion the derivatives are of."""
    if isinstance(lost, str):
        return f"No lost motion: {lost}"
    where = f"at ±{100.0 * LOST_MOTION:g} % of the torque, mean of {lost.value.size} crank angles over one mesh"
    without = ", without friction" if drive.friction is not None else ""
    return f"Lost motion {where}{without}: {lost.value.mean() * ARCMIN:.3f}′."


def _number(drive: Drive, path: str) -> float:
    from ltca.drive.fields import read_field

    return float(read_field(drive, path))


_HEAD = re.compile(r"^cases? ([^:]*): ")
_PATH = re.compile(r"[a-z_]+(?:\.[A-Za-z0-9_]+)+|^[a-z_]+(?= = |: )")


def problem_of(sentence: str) -> dict[str, Any]:
    """Return a mistake as plain data: its text, the fields that it names, and the cases, of none for the common part."""
    head, body = _HEAD.match(sentence), _HEAD.sub("", sentence)
    return {
        "text": minus(sentence),
        "fields": _fields_named(body),
        "cases": [] if head is None else head[1].split(", "),
    }


def _fields_named(sentence: str) -> Sequence[str]:
    """Fields that a sentence names; a field that is missing or unknown by its path all the same."""
    found = [one.rstrip(".") for one in _PATH.findall(sentence)]
    return list(dict.fromkeys(one for one in found if field_kind(one) is not None or sentence.startswith(one)))
