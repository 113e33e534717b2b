"""Pictures of the documents are what the commands beside them draw.

``python -m tests.test_pictures`` draws them anew: all, or those that it names (``studio.png`` with chromium and the extras
``studio`` and ``browser``, ``moving_arm.png`` in a minute with the extra ``robotics``).
"""

from __future__ import annotations

import argparse
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib
import numpy as np
import pytest

ROOT = Path(__file__).parents[1]
PICTURES = ROOT / "docs" / "pictures"
CAPTION = re.compile(r'src="docs/pictures/([\w.]+)".*?>\n\n\*[^`\n]*`([^`]+)`\.\*')
BY_HAND = {"several_cranks.svg"}
"""Diagrams that no command draws."""
NOT_COMPARED = {
    "moving_arm.png": "takes the commands of its page; tests/ltca/commands/test_robot_joint.py runs them and compares the curves",
    "studio.png": "a page in a browser, whose fonts and widgets are those of the system",
}


def require_same_matplotlib(picture):
    """Skip where another version of matplotlib drew a picture: it places letters, and so axes, otherwise."""
    stated = re.search(rb"Matplotlib v(?:ersion)?([0-9.]+)", picture.read_bytes())[1].decode()
    if stated != matplotlib.__version__:
        pytest.skip(f"{picture.name} was drawn by matplotlib {stated}, here is {matplotlib.__version__}")


def captioned():
    """Pictures of the README by the command that their caption names."""
    return dict(CAPTION.findall((ROOT / "README.md").read_text(encoding="utf-8")))


def drawn(command, folder):
    """Draw the picture of a command of ours in a folder, and return it."""
    from ltca.commands.program import main

    name, *words = shlex.split(command)
    assert (name, main([*words, "--out", str(folder)])) == ("cyclo", 0)
    (picture,) = folder.glob("*.png")
    return picture


def drawn_by_module(folder):
    """Draw the picture of ``python -m validation.seats``, without the tables that it prints."""
    from validation.seats import draw

    draw(folder / "seats.svg")
    return folder / "seats.svg"


def test_every_picture_has_its_command():
    assert set(captioned()) == {"loaded_drive.png"}
    page = (ROOT / "docs" / "theory" / "seats.md").read_text(encoding="utf-8")
    assert re.search(r"`python -m validation\.seats`[^\n]*draws the picture", page)
    names = {path.name for path in PICTURES.iterdir()}
    assert names == {*captioned(), "seats.svg", *BY_HAND, *NOT_COMPARED}


def test_the_picture_of_the_readme_was_not_what_its_command_draws(tmp_path):
    from matplotlib.image import imread

    ((name, command),) = captioned().items()
    require_same_matplotlib(PICTURES / name)
    now, stored = imread(drawn(command, tmp_path)), imread(PICTURES / name)
    assert now.shape == stored.shape
    # Another crank angle or load moves every tenth pixel.
    assert np.mean(np.abs(now - stored).max(axis=2) > 0.1) < 5e-3


@pytest.mark.slow
def test_the_picture_of_the_seats_is_what_its_command_draws(tmp_path):
    """The same paths, to the digits that an SVG has; names of clips and markers change."""
    require_same_matplotlib(PICTURES / "seats.svg")
    paths = [
        re.findall(r' d="([^"]*)"', path.read_text(encoding="utf-8"))
        for path in (drawn_by_module(tmp_path), PICTURES / "seats.svg")
    ]
    curves = [[one for one in each if one.count("L") > 20] for each in paths]
    assert len(curves[0]) == len(curves[1]) > 8
    for now, stored in zip(*curves, strict=True):
        numbers = [np.array(re.findall(r"-?\d+\.?\d*", one), dtype=float) for one in (now, stored)]
        np.testing.assert_allclose(*numbers, atol=0.02)


@pytest.mark.parametrize(("page", "name"), [("robot_joint", "moving_arm.png"), ("studio", "studio.png")])
def test_a_picture_that_no_caption_drew_was_older_than_its_program(page, name):
    """The page names the command that draws it, and the command knows the picture."""
    text = (ROOT / "docs" / "how-to" / f"{page}.md").read_text(encoding="utf-8")
    assert f"`python -m tests.test_pictures {name}`" in text
    assert name in DRAWN


def draw_captioned(name):
    """Draw a picture of the README."""
    with tempfile.TemporaryDirectory() as new:
        shutil.copy(drawn(captioned()[name], Path(new)), PICTURES / name)


def draw_studio(name):
    """Draw the first screen of the studio of `robot-joint` once its fine answer is there."""
    from playwright.sync_api import sync_playwright

    from tests.ltca.studio.conftest import studio
    from tests.plugins.needs import program

    with tempfile.TemporaryDirectory() as folder, studio("robot-joint", folder) as found, sync_playwright() as driver:
        page = driver.chromium.launch(executable_path=program("chromium"), args=["--no-sandbox"]).new_page(
            viewport={"width": 1400, "height": 900}
        )
        page.goto(found.address)
        page.wait_for_function("() => document.body.dataset.answer === 'fine'", timeout=300_000)
        page.screenshot(path=PICTURES / name)


def draw_arm(name):
    """Run the commands of the page of a moving arm."""
    page = (ROOT / "docs" / "how-to" / "robot_joint.md").read_text(encoding="utf-8")
    (added,) = re.findall(r"```toml\n(.*?)```", page, re.DOTALL)
    first, rest, *_ = re.findall(r"```sh\n(.*?)```", page, re.DOTALL)
    environment = {"MUJOCO_GL": "egl"} | os.environ
    with tempfile.TemporaryDirectory() as folder:
        for command in (first, *rest.strip().splitlines()):
            name_of, *words = shlex.split(command)
            words[0] = str(ROOT / words[0]) if name_of == "python" else words[0]
            program = [sys.executable] if name_of == "python" else [sys.executable, "-m", "ltca.commands.program"]
            subprocess.run([*program, *words], cwd=folder, env=environment, check=True)
            if command == first:
                with (Path(folder) / "joint.toml").open("a", encoding="utf-8") as file:
                    file.write(f"\n{added}")
        shutil.copy(Path(folder) / "out" / "joint" / name, PICTURES / name)


DRAWN = {
    "loaded_drive.png": draw_captioned,
    "seats.svg": lambda _: drawn_by_module(PICTURES),
    "studio.png": draw_studio,
    "moving_arm.png": draw_arm,
}
"""What draws each picture anew."""


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Draw pictures of the documents anew.")
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(DRAWN)}; default all")
    for name in parser.parse_args().names or DRAWN:
        DRAWN[name](name)
    sys.exit(0)
