"""Children and temporary files end with the process that started them, however it ends."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import pytest

from ltca.commands.program import main
from ltca.output import processes
from ltca.output.processes import Terminated, ended_by_signals

pytestmark = pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="reads /proc")

# A program under supervision that itself has a child: both sleep, both write who they are.
SUPERVISED = """
import sys, tempfile
from pathlib import Path
from ltca.output.processes import ended_by_signals, supervised
words = ["sh", "-c", "sleep 61 & echo $! >> pids; echo $$ >> pids; echo ready; wait"]
with ended_by_signals(), tempfile.TemporaryDirectory(prefix="cyclo-test-", ignore_cleanup_errors=True) as folder:
    print(folder, flush=True)
    with supervised(words, Path(folder), cwd=folder) as program:
        program.wait()
"""
POOL = """
import os, sys, time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from ltca.output.process_pools import become_worker
def who(_):
    time.sleep(0.3)
    return os.getpid()
if __name__ == "__main__":
    pool = ProcessPoolExecutor(2, mp_context=get_context(sys.argv[1]), initializer=become_worker)
    print(*set(pool.map(who, range(4))), flush=True)
    time.sleep(60)
"""


def alive(pid):
    """Whether a process runs; one that nobody has waited for does not."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def gone(pids, folder=None, seconds=120.0):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if not any(map(alive, pids)) and (folder is None or not folder.exists()):
            return True
        time.sleep(0.05)
    return False


@pytest.fixture(autouse=True)
def heard():
    """What a shell starts in the background ignores Ctrl-C, and so does all that it starts itself."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
def test_a_supervised_program_ends_with_its_parent(number):
    """SIGKILL of the parent left ccx running and its folder in /tmp."""
    with subprocess.Popen(
        [sys.executable, "-c", SUPERVISED], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    ) as parent:
        folder = Path(parent.stdout.readline().strip())
        assert parent.stdout.readline() == "ready\n"
        pids = [int(line) for line in (folder / "pids").read_text().split()]
        assert len(pids) == 2
        assert all(map(alive, pids))
        parent.send_signal(number)
        assert gone(pids, folder)


@pytest.mark.parametrize(("number", "kind"), [(signal.SIGTERM, Terminated), (signal.SIGINT, KeyboardInterrupt)])
def test_a_signal_while_an_object_is_removed_is_heard(number, kind):
    """One of the kills of `benchmarks/faults.py` came inside a weak reference's callback, and nothing ended."""

    class Dying:
        def __del__(self):
            os.kill(os.getpid(), number)
            time.sleep(0.001)

    went_on = []

    def work():
        with ended_by_signals():
            Dying()
            time.sleep(5.0)  # what is heard ends it at once
            went_on.append(True)

    with pytest.raises(kind):
        work()
    assert not went_on


@pytest.mark.parametrize(("number", "kind"), [(signal.SIGTERM, Terminated), (signal.SIGINT, KeyboardInterrupt)])
def test_a_signal_that_a_library_made_its_own_error_while_it_was_loaded(number, kind):
    """`cyclo` ended with "unforeseen SchemaError": a compiled library had turned the exception of SIGTERM into that."""

    def load():
        try:
            os.kill(os.getpid(), number)
            time.sleep(5.0)
        except (Terminated, KeyboardInterrupt):
            raise ValueError("the schema is wrong")  # noqa: B904

    with pytest.raises(kind) as ended, ended_by_signals():
        load()
    assert isinstance(ended.value.__cause__, ValueError)
    with pytest.raises(ValueError, match="of no signal"), ended_by_signals():
        raise ValueError("of no signal")


@pytest.mark.parametrize(("number", "status"), [(signal.SIGTERM, 143), (signal.SIGINT, 130)])
def test_a_signal_while_a_command_was_loaded_was_an_unforeseen_error(number, status, monkeypatch, capsys):
    def load(entry):
        try:
            os.kill(os.getpid(), number)
            time.sleep(5.0)
        except (Terminated, KeyboardInterrupt):
            raise ValueError("the schema is wrong")  # noqa: B904

    monkeypatch.setattr("importlib.metadata.EntryPoint.load", load)
    assert main(["show", "paper"]) == status
    assert "unforeseen" not in capsys.readouterr().err


@pytest.mark.parametrize(("number", "kind"), [(signal.SIGTERM, Terminated), (signal.SIGINT, KeyboardInterrupt)])
def test_a_signal_is_sent_again_on_windows(number, kind, monkeypatch):
    """`os.kill` ends a process of Windows at once, whatever the signal, this one too."""

    def kill(*words):
        raise AssertionError("the process would have ended")

    monkeypatch.setattr(processes, "os", SimpleNamespace(name="nt", getpid=os.getpid, kill=kill))
    with pytest.raises(kind), ended_by_signals():
        processes._send(number)


@pytest.mark.slow
@pytest.mark.parametrize("method", ["spawn", "forkserver"])
def test_workers_end_with_their_parent(method, tmp_path):
    script = tmp_path / "pool.py"
    script.write_text(POOL)
    with subprocess.Popen([sys.executable, str(script), method], stdout=subprocess.PIPE, text=True) as parent:
        pids = [int(word) for word in parent.stdout.readline().split()]
        assert pids
        assert all(map(alive, pids))
        parent.kill()
        assert gone(pids)


def start(*words):
    return subprocess.Popen(
        [sys.executable, "-m", "ltca.commands.program", *words],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def wait_for(folder, pattern, process, seconds=300.0):
    end = time.monotonic() + seconds
    while time.monotonic() < end and process.poll() is None and not list(folder.glob(pattern)):
        time.sleep(0.02)
    assert process.poll() is None
    assert list(folder.glob(pattern))


@pytest.mark.nightly
@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "status", "word"), [(signal.SIGINT, 130, "interrupted"), (signal.SIGTERM, 143, "terminated")]
)
def test_an_interrupted_study_names_resume_and_prints_no_traceback(number, status, word, tmp_path):
    """Ctrl-C reaches the whole group: with two workers it printed a traceback of multiprocessing."""
    out = tmp_path / "out"
    with start(
        "tolerance", "paper", "--samples", "100000", "--workers", "2", "--positions", "8", "--out", str(out)
    ) as run:
        wait_for(out, "batches/[0-9]*.npz", run)
        group = [int(path.name) for path in Path("/proc").glob("[0-9]*") if group_of(path) == run.pid]
        os.killpg(run.pid, number)
        said = run.stderr.read()
        assert run.wait(300) == status
    assert len(group) >= 4  # with fork server and resource tracker
    assert gone(group)
    assert "continue with --resume" in said
    assert said.endswith(f"cyclo: {word}\n")
    assert "Traceback" not in said
    assert not list(out.glob("**/.*"))  # neither lock nor part


def group_of(path):
    try:
        return int((path / "stat").read_text().rpartition(")")[2].split()[2])
    except (OSError, ValueError):
        return 0
