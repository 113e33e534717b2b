"""Arguments that the study commands share."""

from __future__ import annotations

import argparse
import re

from ltca.commands.compliance_arguments import add_compliance_arguments
from ltca.errors import DriveError, shortened
from ltca.reading.arguments import (
    add_figures_argument,
    add_out_argument,
    add_page_argument,
    count_argument,
)

DEFAULT_POSITIONS = 28
SCHEDULER = re.compile(r"inproc://\S+|((tcp|tls|ws|wss|ucx)://)?(\[[0-9a-fA-F:.%]+\]|[\w.-]+):(?P<port>[0-9]{1,5})")
"""Addresses of a dask scheduler; at anything else dask itself looks for 20 s and ends in tracebacks."""


def add_positions_argument(parser: argparse.ArgumentParser, what: str) -> None:
    """Add the positions of every sample or candidate."""
    parser.add_argument(
        "--positions",
        metavar="N",
        type=count_argument("--positions", 1, 100_000),
        default=DEFAULT_POSITIONS,
        help=f"crank angles 2πk/N of every {what}; default {DEFAULT_POSITIONS}",
    )


def add_seed_argument(parser: argparse.ArgumentParser) -> None:
    """Add the seed of random numbers."""
    parser.add_argument(
        "--seed",
        metavar="S",
        type=count_argument("--seed", 0, 2**63 - 1),
        default=0,
        help="of the random numbers; default 0",
    )


def add_worker_arguments(parser: argparse.ArgumentParser) -> None:
    """Add who solves: local processes or a cluster."""
    parser.add_argument(
        "--workers",
        metavar="W",
        type=count_argument("--workers", 1, 1024),
        default=1,
        help="local processes; default 1",
    )
    parser.add_argument("--scheduler", metavar="URL", default="", help="dask.distributed scheduler, tcp://host:port")


def add_study_arguments(parser: argparse.ArgumentParser, command: str) -> None:
    """Add what every study has: compliance, who solves it, folder, resuming, figures."""
    add_compliance_arguments(parser)
    add_worker_arguments(parser)
    add_out_argument(parser, command)
    parser.add_argument("--resume", action="store_true", help="continue an interrupted study in --out")
    parser.add_argument("--force", action="store_true", help="replace another study in --out")
    add_figures_argument(parser)
    add_page_argument(parser)
    parser.add_argument(
        "--sample",
        metavar="I",
        type=count_argument("--sample", 0, 100_000_000),
        help="write the drive of sample I as a drive file and solve nothing",
    )


def check_worker_arguments(arguments: argparse.Namespace) -> None:
    """Refuse local processes beside a cluster, and addresses at which dask would look for no scheduler."""
    if arguments.scheduler:
        found = SCHEDULER.fullmatch(arguments.scheduler)
        if found is None or not 0 < int(found["port"] or 1) < 65536:
            told = "must be the address of a dask scheduler, host and port, as tcp://127.0.0.1:8786"
            raise DriveError([f"--scheduler = {shortened(arguments.scheduler)}: {told}"])

    if arguments.scheduler and arguments.workers > 1:
        raise DriveError(["--workers and --scheduler: give one of them; a cluster has its own workers"])


def check_study_arguments(arguments: argparse.Namespace) -> None:
    """Refuse options that contradict each other, before anything is imported."""
    check_worker_arguments(arguments)
    if arguments.resume and arguments.force:
        raise DriveError(
            ["--resume and --force: give one of them; one goes on with the study in --out, one replaces it"]
        )
