"""``cyclo sweep``: any fields of a drive varied over a grid, a list, a Latin hypercube or a Sobol sequence."""

from __future__ import annotations

import argparse
from pathlib import Path

from ltca.commands.compliance_arguments import check_compliance, compliance_of
from ltca.commands.study_arguments import add_study_arguments, check_study_arguments
from ltca.reading.arguments import default_folder

MISSING = "no such file; docs/how-to/studies.md says what a study file holds"
SUMMARY = "vary any fields of a drive: grid, list, Latin hypercube, Sobol"
EXAMPLES = (
    ("cyclo sweep study.toml", "solve what a study file describes"),
    ("cyclo sweep study.toml --scheduler tcp://host:8786", "by the workers of a cluster"),
)


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("study", metavar="STUDY", type=Path, help="study file (TOML): drive, factors, design")
    add_study_arguments(parser, "sweep")


def execute(arguments: argparse.Namespace) -> int:
    """Solve the samples, write and print the results."""
    from ltca.output.run_folder import require_folder
    from ltca.reading.toml_text import read_text

    check_study_arguments(arguments)
    check_compliance(arguments)
    read_text(arguments.study, MISSING)
    out = arguments.out or default_folder(arguments.study.stem, "sweep")
    require_folder(out)
    from ltca.commands.actions.study import execute_study
    from ltca.studies.execution.storage import StudyFolder
    from ltca.studies.sweep_file import load_sweep

    study = load_sweep(arguments.study, compliance_of(arguments))
    return execute_study(study, StudyFolder(path=out), arguments)
