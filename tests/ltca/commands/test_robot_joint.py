"""The page that walks a robot joint from its drive file to a moving arm, with its commands and its tables as they are printed."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread

from ltca.commands.program import main

ROOT = Path(__file__).parents[3]
PAGE = ROOT / "docs" / "how-to" / "robot_joint.md"


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", PAGE.read_text(encoding="utf-8"), flags=re.DOTALL)


@pytest.mark.slow
@pytest.mark.nightly
@pytest.mark.needs("robotics")
def test_the_page_runs_as_it_is_printed(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (added,), (first, rest, _) = blocks("toml"), blocks("sh")
    assert main(shlex.split(first)[1:]) == 0
    with Path("joint.toml").open("a", encoding="utf-8") as file:
        file.write(f"\n{added}")
    export, script = rest.strip().splitlines()
    assert main(shlex.split(export)[1:]) == 0
    told = capsys.readouterr().out
    assert "driven back from" in told
    _, path, *words = shlex.split(script)
    environment = os.environ | {"MPLBACKEND": "Agg"}
    environment.setdefault("MUJOCO_GL", "egl")
    done = subprocess.run(
        [sys.executable, str(ROOT / path), *words],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=900,
    )
    assert done.returncode == 0, done.stderr
    now, stored = tmp_path / "out" / "joint" / "moving_arm.png", ROOT / "docs" / "pictures" / "moving_arm.png"
    version = re.compile(rb"Matplotlib v(?:ersion)?[0-9.]+")
    if (
        "rendered offscreen" in done.stdout
        and version.search(now.read_bytes())[0] == version.search(stored.read_bytes())[0]
    ):
        new, old = (imread(path)[300:] for path in (now, stored))  # the curves; above them is what OpenGL rendered
        # The picture of an older law of the joint differed in 2.8 % of the pixels.
        assert np.mean(np.abs(new - old).max(axis=2) > 0.1) < 5e-3
    # Up to the weight of arm and load and what swings them: m g l and m l² φ'' of the page's arm, 54 and 122 N·m, and no more.
    low, high = map(float, re.search(r"torque (-?\d+) … (\d+) N·m", done.stdout).groups())
    assert -190.0 < low < -100.0
    assert 130.0 < high < 190.0
