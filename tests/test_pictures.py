"""Pictures of the documents are what the commands beside them draw.

``python -m tests.test_pictures`` draws them anew.
"""

from __future__ import annotations

import re
import shlex
import shutil
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
    "moving_arm.png": "rendered by MuJoCo with OpenGL; tests/ltca/commands/test_robot_joint.py runs the commands of the page",
    "studio.png": "a page in a browser, with the texts of its day",
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


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as new:
        for name, command in captioned().items():
            folder = Path(new) / name
            shutil.copy(drawn(command, folder), PICTURES / name)
        drawn_by_module(PICTURES)
    sys.exit(0)
