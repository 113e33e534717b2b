"""``cyclo check``: a verdict on a design, with what drives each value and what would mend it."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from ltca.commands.compliance_arguments import add_compliance_arguments
from ltca.reading.arguments import (
    add_case_argument,
    add_drive_argument,
    add_out_argument,
    add_page_argument,
    count_argument,
    default_folder,
    tell_unit_mistakes,
    torque_argument,
)

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from ltca.analysis.verdict.advice import Driver
    from ltca.drive.members.judgement import Check
    from ltca.drive.members.limits import Limits
    from ltca.drive.parts import Drive
    from ltca.errors import DriveError

SUMMARY = "judge a design: value, limit and safety of every check, what drives it and what would mend it"
EXAMPLES = (
    ("cyclo check my.toml", "every check of every case; exit status 1 where one fails"),
    ("cyclo check paper --case CS-3 --no-advice", "verdicts alone"),
)
DEFAULT_POSITIONS = 360
ADVICE_POSITIONS = 60
"""Positions at which changed drives are compared."""
BESIDE = 1e-3
LEAST_PART = 1e-3
"""Part of the torque below which it is not tried whether the drive carries it."""
FAILED = 1


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_drive_argument(parser)
    add_case_argument(parser, "case, repeatable; default all")
    parser.add_argument(
        "--positions",
        metavar="N",
        type=count_argument("--positions", 2, 100_000),
        default=DEFAULT_POSITIONS,
        help=f"crank positions of a turn; default {DEFAULT_POSITIONS}",
    )
    parser.add_argument(
        "--torque", metavar="T", type=torque_argument, help="output torque in N mm (or a text such as '377.3 N m')"
    )
    parser.add_argument("--no-advice", action="store_true", help="verdicts alone, without what drives each value")
    add_compliance_arguments(parser)
    add_out_argument(parser, "check")
    add_page_argument(parser)


def execute(arguments: argparse.Namespace) -> int:
    """Judge every case, print and write the checks; exit status 1 when one fails."""
    from ltca.commands.compliance_arguments import check_compliance, compliance_of, find_coefficients_of
    from ltca.drive.members.verdict_words import check_content, verdict_table
    from ltca.output.files import write_json
    from ltca.output.progress import progress
    from ltca.output.run_folder import claimed_folder, require_folder
    from ltca.reading.drive_file import load_drive

    check_compliance(arguments)
    file = load_drive(arguments.drive)
    cases = file.select(arguments.case)
    tell_unit_mistakes(cases.values())
    out = arguments.out or default_folder(file.name, "check")
    require_folder(out)
    from ltca.analysis.memory_need import require_room_for

    require_room_for(cases.values(), arguments.positions, out, f"--positions {arguments.positions}")
    engine, contents, failed = compliance_of(arguments), {}, 0
    notes: dict[str, list[str]] = {}
    judged: dict[str, list[Check]] = {}
    driving: dict[str, dict[str, list[Driver]]] = {}
    writes = ["check.json", *([] if arguments.no_page else ["report.html"])]
    with claimed_folder(out, "check", writes=writes):
        find_coefficients_of(cases, arguments)
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
            from ltca.analysis.engines import describe_engine
            from ltca.page.studies.check import check_page
            from ltca.page.study_page import write_study_page

            loads = dict.fromkeys(drive.load_words(arguments.torque) for drive in cases.values())
            words = f"verdict at {', '.join(loads)}, {describe_engine(engine)}, {arguments.positions} positions of the crank"
            made = {**engine.options, "positions": str(arguments.positions)}
            write_study_page(check_page(file.name, file.text, words, judged, driving, notes, made), out)
    print("results: " + ", ".join(str(out / name) for name in writes))
    return FAILED if failed else 0


def _judge(
    drive: Drive, limits: Limits, engine: Any, arguments: argparse.Namespace
) -> tuple[list[Check], dict[str, list[Driver]], list[str]]:
    from ltca.analysis.loaded_analysis import analyse
    from ltca.analysis.summary import summarise
    from ltca.analysis.verdict.advice import advise
    from ltca.analysis.verdict.values import judge_analysis, notes
    from ltca.drive.members.judgement import WHOLE, Check, Value
    from ltca.errors import DriveError
    from ltca.geometry.placement import position_angles

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
    told = notes(analysis)
    if refusal:
        checks.insert(0, Check(value=Value(quantity="carried_torque", value=part), limit=WHOLE))
        told.insert(
            0,
            f"{refusal}; the checks are those at {part:g} of the torque. All sizes × {part ** (-1.0 / 3.0):.3g} would about "
            "carry the whole: at equal stress torques grow with the cube of the size",
        )
    if arguments.no_advice:
        return checks, {}, told
    if arguments.compliance != "half-space" and any(check.fails for check in checks):
        told.append("what drives each value is found on half-spaces, whatever judges it")
    # Between those of a turn, so that nothing is refined.
    angles = position_angles(min(arguments.positions, ADVICE_POSITIONS)) + BESIDE
    return checks, advise(drive, checks, angles, whole, part), told


def _seized(drive: Drive, limits: Limits, error: DriveError) -> tuple[list[Check], dict[str, list[Driver]], list[str]]:
    """A drive that its warmth presses together more than its bodies carry: what is known without an answer."""
    from ltca.analysis.verdict.assembly import play_at_temperature
    from ltca.drive.members.judgement import WHOLE, Check, Value, judge
    from ltca.drive.members.temperatures import warm_drive

    carried = Check(value=Value(quantity="carried_torque", value=0.0), limit=WHOLE)
    return [carried, *judge(drive, list(play_at_temperature(drive, warm_drive(drive))), limits)], {}, [*error.problems]


def _advice(checks: Sequence[Check], drivers: Mapping[str, Sequence[Driver]]) -> str:
    """What drives what fails, and what would mend it."""
    from ltca.analysis.verdict.advice import MAX_INPUTS

    lines = []
    for check in checks:
        if not check.fails:
            continue
        limit = check.limit
        source = "" if limit is None else f" (limit: {limit.source})"
        told = "fails" if check.verdict == "fail" else f"cannot be judged: {check.value.reason}"
        lines.append(f"  {check.title} {told}{source}")
        each = drivers.get(check.value.quantity, ())
        helping = [driver for driver in each if driver.change]
        lines += [
            f"    {driver.input}: {driver.change} would about do (d ln value/d ln input = {driver.elasticity:+.2f})"
            for driver in helping[: 2 * MAX_INPUTS]
        ]
        if each and not helping:
            named = ", ".join(f"{driver.input} ({driver.elasticity:+.2f})" for driver in each[:MAX_INPUTS])
            lines.append(f"    driven by {named}; no single change by a factor of three mends it")
    return "".join(f"{line}\n" for line in lines)


def _drivers(drivers: Sequence[Driver]) -> list[dict[str, Any]]:
    return [
        {"input": driver.input, "elasticity": driver.elasticity, "change": driver.change, "factor": driver.factor}
        for driver in drivers
    ]
