"""A dask cluster whose worker or scheduler is killed: identical output, or a one-line message and a successful resume."""

from __future__ import annotations

import argparse
import importlib.util
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from fault_kinds.programs import Counts, content, is_one_line, start

STUDY = "tolerance paper --samples 3000 --positions 8 --no-figures --out {out}"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the kind."""
    parser.add_argument(
        "--kills", type=int, default=3, help="kills of a worker, and as many of the scheduler; default 3"
    )


def execute(arguments: argparse.Namespace) -> int:
    """Kill workers and schedulers under a study."""
    if importlib.util.find_spec("distributed") is None:
        print("skipped: dask.distributed (extra 'cluster') is not installed")
        return 0
    counts = Counts()
    with tempfile.TemporaryDirectory(prefix="faults-") as name:
        folder = Path(name)
        with start(STUDY, folder / "alone", folder / "scratch") as process:
            process.communicate()
        wanted = content(folder / "alone")
        for kind in ("worker", "scheduler"):
            for trial in range(arguments.kills):
                counts.add(f"dask {kind} killed", _tried(kind, folder / f"{kind}-{trial}", folder, wanted))
    return counts.close()


def _tried(kind: str, out: Path, folder: Path, wanted: dict[str, bytes]) -> str:
    python = [sys.executable, "-m"]
    quiet: Any = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    place = folder / f"{out.name}.json"
    scheduler = subprocess.Popen(
        [
            *python,
            "distributed.cli.dask_scheduler",
            "--port",
            "0",
            "--dashboard-address",
            ":0",
            "--scheduler-file",
            str(place),
        ],
        **quiet,
    )
    workers = []
    try:
        while not place.exists():
            time.sleep(0.1)
        words = [
            *python,
            "distributed.cli.dask_worker",
            "--scheduler-file",
            str(place),
            "--nthreads",
            "1",
            "--no-dashboard",
        ]
        workers = [subprocess.Popen(words, cwd=folder, **quiet) for _ in range(2)]
        address = json.loads(place.read_text())["address"]
        with start(f"{STUDY} --scheduler {address}", out, folder / "scratch") as process:
            end = time.monotonic() + 60.0
            while time.monotonic() < end and process.poll() is None and not any(out.glob("batches/*.npz")):
                time.sleep(0.02)
            (workers[0] if kind == "worker" else scheduler).kill()
            try:
                said = process.communicate(timeout=120.0)[1]
            except subprocess.TimeoutExpired:
                process.kill()
                return "does not end within 120 s"
        if kind == "scheduler" and process.returncode != 0:
            if process.returncode != 1 or not is_one_line(said):
                return f"exit status {process.returncode}: {said[-600:]}"
            with start(STUDY, out, folder / "scratch") as process:
                said = process.communicate()[1]
        if process.returncode != 0:
            return f"exit status {process.returncode}: {said[-600:]}"
        return "" if content(out) == wanted else "other bytes"
    finally:
        for one in (*workers, scheduler):
            one.kill()
            one.wait()
