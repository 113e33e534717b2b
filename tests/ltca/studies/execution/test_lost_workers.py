"""Studies whose workers, cluster or main process are killed end in the same files byte for byte."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest

from ltca.errors import CycloError
from ltca.reading.drive_file import load_drive
from ltca.studies.execution import workers as workers_module
from ltca.studies.execution.storage import StudyFolder
from ltca.studies.execution.workers import Workers, solve_batches
from ltca.studies.run_study import run_study
from ltca.studies.tolerance_study import tolerance_study


@pytest.fixture(scope="module")
def study():
    """A study of many batches: 200 samples of 16 positions, four samples in a batch."""
    quantities = ("ptp_transmission_error", "max_pin_load")
    found = tolerance_study(load_drive("paper"), case="CS-6", samples=200, positions=16, seed=4, quantities=quantities)
    return replace(found, batch_positions=64)


@pytest.fixture(scope="module")
def straight(study, tmp_path_factory):
    """Its files, solved in this process without a disturbance."""
    folder = StudyFolder(path=tmp_path_factory.mktemp("straight"))
    run_study(study, folder, Workers())
    return folder


def same_files(one, other):
    for name in ("results.nc", "results.parquet", "summary.json"):
        assert (one.path / name).read_bytes() == (other.path / name).read_bytes(), name


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="reads /proc")
def test_local_pool_survives_a_killed_worker(study, straight, tmp_path):
    """SIGKILL for a worker after the first of many batches: the pool is built anew, the results are the same."""
    folder = StudyFolder(path=tmp_path / "disturbed")
    before = children()
    killed = False
    for result in solve_batches(study, folder.prepare(study, resume=False), Workers(processes=2)):
        folder.store(study, result)
        if not killed:
            victims = [pid for pid in children() if pid not in before and "multiprocessing" in command(pid)]
            os.kill(victims[-1], signal.SIGKILL)
            killed = True
    assert killed
    run_study(study, folder, Workers(), resume=True)
    same_files(folder, straight)


HALF = """
import os, sys, time
from ltca.output import process_pools
from ltca.studies.execution.workers import Workers

half, process_pools.NOTICING = sys.argv[1], 1.0
try:
    with Workers(processes=2).executor() as (pool, _):
        pool.submit(os.getpid).result()
        manager = pool._executor_manager_thread
        if half == "result":
            descriptor = os.dup(pool._result_queue._writer.fileno())
            os.write(descriptor, (3_000_000).to_bytes(4, "big") + b"half")  # 3 MB announced, 4 bytes sent
            os.close(descriptor)
        for _ in range(3):
            pool.submit(time.sleep, 60.0)
        if half == "batch":
            for _ in range(4):
                pool.submit(len, bytes(3_000_000))  # more than a pipe holds
        time.sleep(0.2)  # the threads are in the middle of it
        raise KeyboardInterrupt
except KeyboardInterrupt:
    print("left" if not manager.is_alive() else "still there")
"""


@pytest.mark.slow
@pytest.mark.family(full=1)
@pytest.mark.parametrize("half", ["nothing", "batch", "result"])
def test_a_pool_is_left_with_half_of_something_in_its_pipes(half):
    """It waited for ever for the other half; closing the pipes beforehand was a race for who closes them."""
    done = subprocess.run([sys.executable, "-c", HALF, half], capture_output=True, text=True, timeout=300, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "left\n", "")


def command(pid):
    try:
        return Path(f"/proc/{pid}/cmdline").read_text().replace("\0", " ")
    except OSError:
        return ""


def children():
    """All descendants of this process."""
    found, front = [], [os.getpid()]
    while front:
        parent = front.pop()
        for task in Path(f"/proc/{parent}/task").glob("*"):
            try:
                below = [int(pid) for pid in (task / "children").read_text().split()]
            except OSError:
                continue
            found += below
            front += below
    return found


KILLED_AT_THE_THIRD = """
import os, signal
from ltca.studies.execution.storage import StudyFolder
store, stored = StudyFolder.store, []
def store_and_die(folder, *words):
    store(folder, *words)
    stored.append(1)
    if len(stored) == 3:
        os.kill(os.getpid(), signal.SIGKILL)
StudyFolder.store = store_and_die
"""


@pytest.mark.nightly
@pytest.mark.slow
def test_killed_study_resumes_to_the_same_dataset(tmp_path):
    """kill −9 for the main process of the command in the middle, then --resume: byte for byte the undisturbed files."""
    arguments = ["paper", "--case", "CS-6", "--samples", "28", "--positions", "512", "--seed", "4", "--no-figures"]
    arguments += ["--quantities", "ptp_transmission_error", "max_pin_load"]
    program = "import sys; from ltca.commands.program import _Parser; from ltca.commands import tolerance as t; p = _Parser();"
    program += "t.configure(p); sys.exit(t.execute(p.parse_args(sys.argv[1:])))"
    one, other = tmp_path / "disturbed", tmp_path / "straight"

    def start(out, *more, before=""):
        return subprocess.Popen(
            [sys.executable, "-c", before + program, *arguments, "--out", str(out), *more],
            stdout=subprocess.PIPE, text=True,
        )  # fmt: skip

    process = start(one, before=KILLED_AT_THE_THIRD)
    process.communicate()
    assert process.returncode == -signal.SIGKILL
    assert len(list(one.glob("batches/[0-9]*.npz"))) == 3
    resumed = start(one, "--resume", "--workers", "2")
    text, _ = resumed.communicate()
    assert resumed.returncode == 0
    assert "28 samples × 512 positions" in text
    straight = start(other)
    straight.communicate()
    assert straight.returncode == 0
    same_files(StudyFolder(path=one), StudyFolder(path=other))


@pytest.mark.nightly
@pytest.mark.slow
@pytest.mark.needs("cluster")
def test_dask_cluster_of_processes_survives_a_killed_worker(study, straight, tmp_path):
    """A scheduler and two workers as separate processes; one of them is killed in the middle."""
    quiet = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    address_file = tmp_path / "scheduler.json"
    base = [sys.executable, "-m"]
    processes = [
        subprocess.Popen(
            [
                *base,
                "distributed.cli.dask_scheduler",
                "--port",
                "0",
                "--no-dashboard",
                "--scheduler-file",
                str(address_file),
            ],
            stderr=subprocess.DEVNULL,
            env=quiet,
        )
    ]
    try:
        deadline = time.monotonic() + 300.0
        while not address_file.exists() and time.monotonic() < deadline:
            time.sleep(0.1)
        worker = [*base, "distributed.cli.dask_worker", "--scheduler-file", str(address_file), "--nthreads", "1"]
        worker += ["--no-nanny", "--no-dashboard", "--local-directory", str(tmp_path)]
        workers = [subprocess.Popen(worker, stderr=subprocess.DEVNULL, env=quiet, cwd=os.getcwd()) for _ in range(2)]
        processes += workers
        address = json.loads(address_file.read_text())["address"]
        from distributed import Client

        with Client(address, set_as_default=False) as client:
            client.wait_for_workers(2, timeout=300)
        folder = StudyFolder(path=tmp_path / "cluster")
        done = []

        def advance(samples, rate):
            done.append(samples)
            if len(done) == 3:  # the first call tells what a resumed study had
                workers[0].kill()

        found = run_study(study, folder, Workers(scheduler=address), advance=advance)
        assert workers[0].wait(timeout=120) == -signal.SIGKILL
        assert sum(done) == 200
        assert not found.failures
    finally:
        # Workers first: one whose scheduler is gone waits for it to come back.
        for process in reversed(processes):
            process.kill()
            process.wait(timeout=120)
    same_files(folder, straight)


@pytest.mark.slow
@pytest.mark.needs("cluster")
def test_scheduler_that_does_not_answer_is_told(study, tmp_path, monkeypatch):
    monkeypatch.setattr(workers_module, "SCHEDULER_TIMEOUT", 1.0)
    with pytest.raises(CycloError, match="no scheduler answers there"):
        run_study(study, StudyFolder(path=tmp_path), Workers(scheduler="tcp://127.0.0.1:9"))
