"""Throughput of a tolerance study: the paper's CS-6, all deviations random, 28 positions over one turn.

    python benchmarks/tolerance.py [--samples 10000] [--scheduler tcp://host:port]

Prints positions per second with one and two workers (including the start of processes, and the steady rate after the first
batch of every worker), processor time per position, failures, and whether the output files are byte-identical. On a machine with
other load the wall times are affected by it: compare the processor time and the printed load.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import argparse
import math
import resource
import tempfile
import time
from pathlib import Path

from ltca.reading.drive_file import load_drive
from ltca.studies.execution.storage import StudyFolder
from ltca.studies.execution.workers import Workers, solve_batches
from ltca.studies.run_study import run_study
from ltca.studies.study import Study
from ltca.studies.study_results import read_failures
from ltca.studies.tolerance_study import tolerance_study


def cpu_seconds() -> float:
    """Return the processor time, s, of this process and its terminated children."""
    return sum(
        usage.ru_utime + usage.ru_stime
        for usage in (resource.getrusage(resource.RUSAGE_SELF), resource.getrusage(resource.RUSAGE_CHILDREN))
    )


def measure(study: Study, where: Workers, folder: StudyFolder) -> tuple[float, float]:
    """Run the study and return positions per second, whole and steady (NaN if every worker had a single batch)."""
    workers = max(where.processes, 1)
    began, load = time.perf_counter(), os.getloadavg()[0]
    cpu = cpu_seconds()
    left, first, steady, solved = folder.prepare(study, resume=False), 0.0, 0, 0
    for number, result in enumerate(solve_batches(study, left, where)):
        folder.store(study, result)
        solved += len(result.messages)
        if number == workers - 1:
            first = time.perf_counter()
        elif number >= workers:
            steady += len(result.messages)
    ended = time.perf_counter()
    positions = study.positions
    whole, rate = solved * positions / (ended - began), steady * positions / (ended - first) if steady else math.nan
    used = 1e6 * (cpu_seconds() - cpu) / (solved * positions)
    name = where.scheduler or f"{where.processes} worker{'s' if where.processes > 1 else ''}"
    print(f"  {name:<24}{whole:>10.0f}{rate:>10.0f}{used:>12.0f}{load:>10.1f} → {os.getloadavg()[0]:.1f}")
    run_study(study, folder, where, resume=True)
    return whole, rate


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--samples", type=int, default=10_000)
    parser.add_argument("--positions", type=int, default=28)
    parser.add_argument("--scheduler", default="")
    arguments = parser.parse_args()
    study = tolerance_study(
        load_drive("paper"), case="CS-6", samples=arguments.samples, positions=arguments.positions, seed=1
    )
    print(f"{study.name}: {arguments.samples} samples × {arguments.positions} positions, {os.cpu_count()} cores")
    print(f"  {'':<24}{'whole':>10}{'steady':>10}{'CPU µs':>13}{'machine load':>16}")
    print(f"  {'':<24}{'pos./s':>10}{'pos./s':>10}{'per position':>13}")
    places = [Workers(), Workers(processes=2)]
    if arguments.scheduler:
        places.append(Workers(scheduler=arguments.scheduler))
    with tempfile.TemporaryDirectory() as folder:
        folders = [StudyFolder(path=Path(folder) / str(number)) for number in range(len(places))]
        rates = [measure(study, where, part) for where, part in zip(places, folders, strict=True)]
        print(f"  two workers by one: {rates[1][0] / rates[0][0]:.2f} whole, {rates[1][1] / rates[0][1]:.2f} steady")
        failed = read_failures(folders[0].results)
        print(f"  failed samples: {len(failed)}")
        first = folders[0].results.read_bytes()
        print(f"  identical files: {all(folder.results.read_bytes() == first for folder in folders[1:])}")


if __name__ == "__main__":
    main()
