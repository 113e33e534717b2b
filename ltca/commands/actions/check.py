"""Verdicts of ``cyclo check``: judge every case and tell what drives and would mend what fails."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from math import log
from pathlib import Path
from typing import Any

from ltca.analysis.engines import Engine, describe_engine
from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.summary import summarise
from ltca.analysis.verdict.advice import MAX_INPUTS, Driver, advise
from ltca.analysis.verdict.assembly import play_at_temperature
from ltca.analysis.verdict.values import judge_analysis, notes as notes_of
from ltca.drive.members.judgement import WHOLE, Check, Value, judge
from ltca.drive.members.limits import Limits
from ltca.drive.members.temperatures import warm_drive
from ltca.drive.members.verdict_words import check_content, is_of_sampling, urgency, verdict_table
from ltca.drive.parts import Drive
from ltca.errors import DriveError
from ltca.geometry.placement import position_angles
from ltca.output.files import write_json
from ltca.output.progress import progress
from ltca.page.studies.check import check_page
from ltca.page.study_page import write_study_page
from ltca.reading.drive_file import DriveFile

ADVICE_POSITIONS = 60
"""Positions at which changed drives are compared."""
OFFSET = 1e-3
LEAST_PART = 1e-3
"""Part of the torque below which it is not tried whether the drive carries it."""


def judge_and_write(
    file: DriveFile, cases: dict[str, Drive], engine: Engine, arguments: argparse.Namespace, out: Path
) -> int:
    """Judge every case, print and write the checks and the page; return how many checks fail."""
    contents, failed = {}, 0
    notes: dict[str, list[str]] = {}
    judged: dict[str, list[Check]] = {}
    driving: dict[str, dict[str, list[Driver]]] = {}
    with progress("cases", len(cases)) as advance:
        for name, drive in cases.items():
            checks, drivers, told = _judge(drive, file.limits[name], engine, arguments)
            contents[name] = [
                check_content(check, name) | {"drivers": _drivers(drivers.get(check.value.quantity, ()))}
                for check in checks
            ]
            failed += sum(check.fails for check in checks)
            print(f"{file.name} {name}, {drive.load_words(arguments.torque)}")
            print(verdict_table(checks))
            print("".join(f"  note: {note}\n" for note in told), end="")
            notes[name], judged[name], driving[name] = told, checks, drivers
            print(_advice(checks, drivers), end="")
            advance(name)
    verdict = "fail" if failed else "pass"
    write_json(out / "check.json", {"drive": file.name, "verdict": verdict, "cases": contents, "notes": notes})
    if not arguments.no_page:
        loads = dict.fromkeys(drive.load_words(arguments.torque) for drive in cases.values())
        words = (
            f"verdict at {', '.join(loads)}, {describe_engine(engine)}, {arguments.positions} positions of the crank"
        )
        made = {**engine.options, "positions": str(arguments.positions)}
        write_study_page(check_page(file.name, file.text, words, judged, driving, notes, made), out)
    return failed


def _judge(
    drive: Drive, limits: Limits, engine: Engine, arguments: argparse.Namespace
) -> tuple[list[Check], dict[str, list[Driver]], list[str]]:
    used, whole = engine.with_coefficients(drive), drive.load.torque if arguments.torque is None else arguments.torque
    part, refusal = 1.0, ""
    while True:
        try:
            analysis = analyse(drive, position_angles(arguments.positions), part * whole, used)
            break
        except DriveError as error:
            # Contacts wider than the bodies are curved: less of the torque tells how far it is from being carried.
            if "cannot be carried" not in str(error):
                raise
            if part < LEAST_PART and drive.temperature is not None:
                return _seized(drive, limits, error)
            if part < LEAST_PART:
                raise
            part, refusal = 0.5 * part, refusal or error.problems[0]
    checks = judge_analysis(analysis, summarise(analysis), limits)
    told = notes_of(analysis)
    if refusal:
        checks.insert(0, Check(value=Value(quantity="carried_torque", value=part), limit=WHOLE))
        told.insert(
            0,
            f"{refusal}; the checks are those at {part:g} of the torque. All sizes × {part ** (-1.0 / 3.0):.3g} would about "
            "carry the whole: at equal stress torques grow with the cube of the size",
        )
    if arguments.no_advice:
        return checks, {}, told
    if engine.compliance != "half-space" and any(check.fails for check in checks):
        told.append("what drives each value is found on half-spaces, whatever judges it")
    # Between those of a turn, so that nothing is refined.
    angles = position_angles(min(arguments.positions, ADVICE_POSITIONS)) + OFFSET
    return checks, advise(drive, checks, angles, whole, part), told


def _seized(drive: Drive, limits: Limits, error: DriveError) -> tuple[list[Check], dict[str, list[Driver]], list[str]]:
    """Checks of a drive whose parts thermal growth presses together beyond what they carry: those known without a solution."""
    carried = Check(value=Value(quantity="carried_torque", value=0.0), limit=WHOLE)
    return [carried, *judge(drive, list(play_at_temperature(drive, warm_drive(drive))), limits)], {}, [*error.problems]


def _advice(checks: Sequence[Check], drivers: Mapping[str, Sequence[Driver]]) -> str:
    """Text on failed checks: the inputs that drive them, and changes that would mend them."""
    lines = []
    for check in sorted((check for check in checks if check.fails), key=urgency):
        limit = check.limit
        source = "" if limit is None else f" (limit: {limit.source})"
        told = "fails" if check.verdict == "fail" else f"cannot be judged: {check.value.reason}"
        lines.append(f"  {check.title} {told}{source}")
        if is_of_sampling(check):
            lines.append("    this is a matter of --positions, not of the drive")
        each = drivers.get(check.value.quantity, ())
        helping = [driver for driver in each if driver.change]
        lines += [
            f"    {driver.input}: {driver.change} would about do (d ln value/d ln input = {driver.elasticity:+.2f})"
            for driver in helping[: 2 * MAX_INPUTS]
        ]
        if each and not helping:
            named = ", ".join(f"{driver.input} ({driver.elasticity:+.2f})" for driver in each[:MAX_INPUTS])
            lines.append(f"    driven by {named}; no single change by a factor of three mends it and keeps the others")
        lines += [
            f"    not {driver.input}: what mends this fails {', '.join(driver.breaks)}"
            for driver in [driver for driver in each if driver.breaks][:MAX_INPUTS]
        ]
    return "".join(f"{line}\n" for line in [*lines, *_at_once(checks, drivers)])


def _at_once(checks: Sequence[Check], drivers: Mapping[str, Sequence[Driver]]) -> list[str]:
    """Changes of one input that mend all failed checks together: of each input that mends every one, the largest change."""
    failed = [drivers.get(check.value.quantity, ()) for check in checks if check.fails and not is_of_sampling(check)]
    if len(failed) < 2:
        return []
    each = [{driver.input: driver for driver in one if driver.factor is not None} for one in failed]
    common = [name for name in each[0] if all(name in one for one in each)]
    farthest = [max((one[name] for one in each), key=lambda driver: abs(log(driver.factor or 1.0))) for name in common]
    told = "; ".join(f"{driver.input}: {driver.change}" for driver in farthest)
    return [f"  all of them at once: {told}"] if told else []


def _drivers(drivers: Sequence[Driver]) -> list[dict[str, Any]]:
    return [
        {
            "input": driver.input,
            "elasticity": driver.elasticity,
            "change": driver.change,
            "factor": driver.factor,
            "breaks": [*driver.breaks],
        }
        for driver in drivers
    ]
