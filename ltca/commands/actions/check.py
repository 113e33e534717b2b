"""Verdicts of ``cyclo check``: judge every case and tell what drives and would mend what fails."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ltca.analysis.engines import Engine, describe_engine
from ltca.analysis.verdict.advice import Driver
from ltca.analysis.verdict.drive_check import check_drive
from ltca.drive.members.judgement import Check
from ltca.drive.members.verdict_words import check_content, verdict_table
from ltca.drive.parts import Drive
from ltca.output.files import write_json
from ltca.output.progress import progress
from ltca.page.studies.check import check_page
from ltca.page.study_page import write_study_page
from ltca.reading.drive_file import DriveFile


def judge_and_write(
    file: DriveFile, cases: dict[str, Drive], engine: Engine, arguments: argparse.Namespace, out: Path
) -> int:
    """Judge every case, print and write the checks and the page; return how many checks fail."""
    contents, failed = {}, 0
    notes: dict[str, list[str]] = {}
    judged: dict[str, list[Check]] = {}
    driving: dict[str, Mapping[str, Sequence[Driver]]] = {}
    with progress("cases", len(cases)) as advance:
        for name, drive in cases.items():
            found = check_drive(
                drive,
                file.limits[name],
                engine,
                positions=arguments.positions,
                torque=arguments.torque,
                advice=not arguments.no_advice,
            )
            contents[name] = [
                check_content(check, name) | {"drivers": _drivers(found.drivers.get(check.value.quantity, ()))}
                for check in found.checks
            ]
            failed += len(found.failed)
            print(found.heading)
            print(verdict_table(found.checks))
            print("".join(f"  note: {note}\n" for note in found.notes), end="")
            notes[name], judged[name], driving[name] = [*found.notes], [*found.checks], found.drivers
            print(found.advice, end="")
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
