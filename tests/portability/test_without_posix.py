"""Commands run with what Windows has, and write the same bytes: `sitecustomize` takes the rest away from our modules."""

from __future__ import annotations

import http.client
import json
import os
import shutil
import subprocess
import sys
import time
from contextlib import closing, suppress
from pathlib import Path
from urllib.parse import urlsplit

import psutil
import pytest

from ltca.commands.program import main
from ltca.reading.drive_file import shipped_drive

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
WITHOUT = {**os.environ, "PYTHONPATH": os.pathsep.join([str(HERE), str(ROOT)] if os.name != "nt" else [str(ROOT)])}
"""On Windows itself nothing is taken away."""
CYCLO = [sys.executable, "-m", "ltca.commands.program"]
SWEEP = """
drive = "paper"
positions = 17
[design]
kind = "grid"
[factors]
"clearance.bearing" = [0.0, 0.01]
"""


def cyclo(*words, cwd):
    return subprocess.run([*CYCLO, *words], cwd=cwd, env=WITHOUT, capture_output=True, text=True, check=False)


def python(text, cwd, **options):
    """Start a script whose functions count as ours, for it stands in a module of that name."""
    (cwd / "program.py").write_text(
        f"if __name__ == '__main__':\n    __file__ = {str(ROOT / 'ltca' / 'x.py')!r}\n{text}"
    )
    words = [sys.executable, "program.py"]
    return subprocess.Popen(words, cwd=cwd, env=WITHOUT, stdout=subprocess.PIPE, text=True, **options)


LONGEST = 300.0
"""Time, s, that a busy machine may take for what is waited for."""


def gone(pid):
    end = time.monotonic() + LONGEST
    while time.monotonic() < end:
        with suppress(psutil.Error):
            if psutil.Process(pid).status() != psutil.STATUS_ZOMBIE:
                time.sleep(0.05)
                continue
        return True
    return False


@pytest.mark.skipif(os.name == "nt", reason="nothing is to be taken away")
def test_our_modules_have_what_windows_has_and_others_all(tmp_path):
    text = """
    import os, signal
    print(os.name, hasattr(os, "killpg"), hasattr(signal, "SIGKILL"))
    for name in ("fcntl", "termios"):
        try:
            __import__(name, globals())
        except ImportError:
            print("no", name)
    import subprocess  # of the standard library: it would start nothing as on Windows
    print(subprocess.run(["true"]).returncode)
"""
    out, _ = python(text, tmp_path).communicate()
    assert out.split("\n") == ["nt False False", "no fcntl", "no termios", "0", ""]


def test_a_run_without_posix_writes_the_same_bytes(tmp_path):
    words = ["run", "paper", "--case", "CS-1", "--positions", "2", "--no-page", "--out"]
    done = cyclo(*words, str(tmp_path / "without"), cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert main([*words, str(tmp_path / "with")]) == 0
    names = sorted(path.name for path in (tmp_path / "with").iterdir())
    assert sorted(path.name for path in (tmp_path / "without").iterdir()) == names == [
        "cyclo-manifest.json", "results.nc", "summary.json",
    ]  # fmt: skip
    for name in names:
        assert (tmp_path / "without" / name).read_bytes() == (tmp_path / "with" / name).read_bytes(), name


HOLD = """
    import os, sys
    from pathlib import Path
    from ltca.errors import PlaceError
    from ltca.output.locks import held
    try:
        with held(Path("out/.lock"), "--out out", "run", wait=False):
            print("held", os.getpid(), flush=True)
            sys.stdin.read()
    except PlaceError as error:
        print(error, flush=True)
"""


def test_a_folder_is_one_process_s_by_locks_of_windows(tmp_path):
    """The name of the holder can be read beside the locked byte, and a lock ends with its process, killed as it may be."""
    with python(HOLD, tmp_path, stdin=subprocess.PIPE) as first:
        told, pid = first.stdout.readline().split()
        assert told == "held"
        with python(HOLD, tmp_path, stdin=subprocess.DEVNULL) as second:
            told = second.stdout.read()
        assert f"cyclo run (process {pid}) is writing there" in told
        first.kill()
    with python(HOLD, tmp_path, stdin=subprocess.PIPE) as third:
        assert third.stdout.readline().startswith("held ")
        with python(HOLD.replace("wait=False", "wait=True"), tmp_path, stdin=subprocess.DEVNULL) as fourth:
            third.stdin.close()
            assert fourth.stdout.read().startswith("held ")
    assert not (tmp_path / "out" / ".lock").exists()


SUPERVISED = """
    import sys
    from pathlib import Path
    from ltca.output.processes import supervised
    sleep = "import time; time.sleep(61)"
    child = f"import subprocess, sys; one = subprocess.Popen([sys.executable, '-c', {sleep!r}]); "
    child += "print(one.pid, flush=True); one.wait()"
    with supervised([sys.executable, "-c", child], Path("t")) as run:
        run.wait()
"""


def test_a_supervised_program_ends_with_its_parent_without_groups_of_processes(tmp_path):
    """Windows has neither groups nor SIGKILL: what a program has started is found by its parents."""
    (tmp_path / "t").mkdir()
    with python(SUPERVISED, tmp_path) as parent:
        pid = int(parent.stdout.readline())
        parent.kill()
        assert gone(pid)
        end = time.monotonic() + LONGEST
        while (tmp_path / "t").exists() and time.monotonic() < end:
            time.sleep(0.05)
        assert not (tmp_path / "t").exists()


@pytest.mark.slow
@pytest.mark.parametrize(
    "words",
    [
        "fields disc", "quantities", "init my.toml --like rv", "show paper", "check paper --case CS-1",
        "tolerance paper --case CS-1 --samples 8 --positions 17 --workers 2 --force --no-figures",
        "export paper --format step --part disc",
        *(pytest.param(words, marks=pytest.mark.nightly) for words in (
            "run paper --positions 4 --figures", "curves paper --case CS-1 --turns 4 --figures",
            "sweep sweep.toml --workers 2 --no-figures",
            "optimise paper --case CS-1 --vary eccentricity=3.9:4.1 --minimise max_pin_load --generations 1 --positions 4",
            "dynamics paper --case CS-1 --positions 4 --figures",
            "dynamics paper --case CS-1 --time 0.001 --speed 100 --figures",
            "derive paper --case CS-1 --stations 0.25 --size 2", "export paper --format dxf --part disc",
            "export paper --case CS-1 --for json", "fem paper --case CS-1 --size 3",
        )),
    ],
    ids=lambda words: " ".join(words.split()[:3]),
)  # fmt: skip
def test_commands_run_without_posix(words, tmp_path):
    (tmp_path / "sweep.toml").write_text(SWEEP, encoding="utf-8")
    done = cyclo(*words.split(), cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "unforeseen" not in done.stderr
    assert not list(tmp_path.rglob(".cyclo.lock"))
    assert not list(tmp_path.rglob(".*.part*"))


@pytest.mark.nightly
def test_a_design_is_found_without_posix(tmp_path):
    shutil.copy(ROOT / "examples" / "requirements" / "possible-paper.toml", tmp_path / "asked.toml")
    done = cyclo("design", "asked.toml", "--quick", "--best", "1", cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.slow
@pytest.mark.needs("studio")
def test_a_studio_answers_and_runs_jobs_without_posix(tmp_path):
    text = shipped_drive("paper")
    words = [*CYCLO, "studio", "paper", "--no-browser"]
    with subprocess.Popen(words, cwd=tmp_path, env=WITHOUT, stdout=subprocess.PIPE, text=True) as process:
        address = urlsplit(process.stdout.readline().split(": ", 1)[1].strip())

        def ask(path, content=None):
            with closing(http.client.HTTPConnection(address.hostname, address.port, timeout=LONGEST)) as connection:
                body = None if content is None else json.dumps(content)
                kind = "GET" if body is None else "POST"
                connection.request(kind, address.path + path, body, {"Content-Type": "application/json"})
                return json.loads(connection.getresponse().read())

        found = ask("answer", {"text": text, "tab": "one", "case": "CS-1", "quality": "coarse"})
        assert "failure" not in found
        assert "problems" not in found
        number = ask(
            "jobs", {"text": text, "case": "CS-1", "job": {"kind": "export", "format": "dxf", "part": "disc"}}
        )["number"]
        end = time.monotonic() + LONGEST
        while (job := ask("jobs")["jobs"][0])["state"] == "running" and time.monotonic() < end:
            time.sleep(0.2)
        assert (job["number"], job["state"]) == (number, "done")
        process.terminate()
