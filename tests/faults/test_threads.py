"""The same bytes on any number of threads of linear algebra, from the command and from Python."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import pytest
import scipy.linalg  # noqa: F401  # loaded, so that it is limited
from threadpoolctl import threadpool_info, threadpool_limits

from ltca.output import threads

MOTION = ["dynamics", "robot-joint", "--positions", "8", "--compliance", "half-space", "--speed", "1500", "--no-page"]
IN_PYTHON = """
import json, sys, ltca
drive = next(iter(ltca.load_drive("robot-joint").cases.values()))
json.dump(ltca.vibration(drive, positions=8, speed=1500.0, compliance="half-space").content, sys.stdout, default=str)
"""


def blas_threads():
    return {pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"}


limitable = pytest.mark.skipif(
    not blas_threads(), reason="the linear algebra has no threads that threadpoolctl limits (Accelerate of macOS)"
)


@limitable
def test_a_function_has_one_thread_and_gives_the_others_back():
    @threads.on_one_thread
    def counted(number, *, other=1):
        """A docstring."""
        return blas_threads(), number + other

    with threadpool_limits(2, user_api="blas"):
        # A library that was loaded after a command had asked for one thread stays at one.
        given = blas_threads()
        assert 2 in given
        assert counted(1, other=2) == ({1}, 3)
        assert blas_threads() == given
    assert counted.__doc__ == "A docstring."


@limitable
def test_the_program_has_one_thread_whatever_the_environment_says(monkeypatch):
    for variable in threads.VARIABLES:
        monkeypatch.setenv(variable, "2")
    with threadpool_limits(2, user_api="blas"):
        threads.use_one_thread()
        assert blas_threads() == {1}
    assert {os.environ[variable] for variable in threads.VARIABLES} == {"1"}


def on_threads(words, number):
    environment = {**os.environ, **dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), str(number))}
    done = subprocess.run([sys.executable, *words], capture_output=True, env=environment, check=False)
    assert done.returncode == 0, done.stderr.decode()
    return done.stdout


@pytest.mark.slow
def test_last_digits_of_vibrations_are_the_same_on_two_threads(tmp_path):
    """dynamics.json differed in last digits."""
    for number in (1, 2):
        program = "import sys; from ltca.commands.program import main; sys.exit(main(sys.argv[1:]))"
        on_threads(["-c", program, *MOTION, "--out", str(tmp_path / str(number))], number)
    for name in ("dynamics.json", "dynamics.nc"):
        assert (tmp_path / "1" / name).read_bytes() == (tmp_path / "2" / name).read_bytes()


@pytest.mark.slow
def test_last_digits_in_python_are_the_same_on_two_threads():
    one, two = (on_threads(["-c", IN_PYTHON], number) for number in (1, 2))
    assert json.loads(one)
    assert one == two
