"""A command that is killed anywhere and started again ends with the same bytes; `benchmarks/faults.py` kills more."""

from __future__ import annotations

import random
import subprocess
import sys
import time

import pytest

from ltca.commands.program import main

COMMANDS = {
    "run": ["run", "paper", "--case", "CS-1", "--positions", "28", "--no-figures"],
    "tolerance": ["tolerance", "paper", "--samples", "300", "--positions", "4", "--no-figures"],
}


def content(folder):
    return {path.relative_to(folder): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


@pytest.mark.slow
@pytest.mark.nightly
@pytest.mark.parametrize("command", COMMANDS)
def test_killed_and_started_again(command, tmp_path, capsys):
    whole, out = tmp_path / "whole", tmp_path / "out"
    began = time.monotonic()
    assert main([*COMMANDS[command], "--out", str(whole)]) == 0
    took = time.monotonic() - began
    rng = random.Random(command)
    for _ in range(2):
        words = [sys.executable, "-m", "ltca.commands.program", *COMMANDS[command], "--out", str(out)]
        resume = ["--resume"] if (out / "study.json").exists() else []
        with subprocess.Popen([*words, *resume], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
            time.sleep(0.7 + rng.random() * took)  # some 0.7 s pass before anything is imported
            process.kill()
    resume = ["--resume"] if (out / "study.json").exists() else []
    assert main([*COMMANDS[command], "--out", str(out), *resume]) == 0
    assert content(out) == content(whole)
