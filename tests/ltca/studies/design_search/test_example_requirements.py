"""The requirement files that ship: each is answered as its name says, and what is written passes `cyclo check`."""

from __future__ import annotations

from pathlib import Path

import pytest

from ltca.commands.program import main

EXAMPLES = sorted((Path(__file__).parents[4] / "examples" / "requirements").glob("*.toml"))
QUICK = ("possible-paper", "impossible-backlash")


def solve(path, out):
    """Search, and check every design that was written."""
    possible = path.stem.startswith("possible-")
    assert possible or path.stem.startswith("impossible-")
    assert main(["design", str(path), "--out", str(out)]) == (0 if possible else 1)
    designs = sorted(out.glob("design-*.toml"))
    assert bool(designs) == possible
    for design in designs:
        assert main(["check", str(design), "--no-advice", "--out", str(out.parent / f"check-{design.stem}")]) == 0


@pytest.mark.slow
@pytest.mark.parametrize("name", QUICK)
def test_quick_ones_are_answered_as_their_names_say(name, tmp_path):
    (path,) = (path for path in EXAMPLES if path.stem == name)
    solve(path, tmp_path / "out")


@pytest.mark.slow
@pytest.mark.nightly
@pytest.mark.parametrize("path", [path for path in EXAMPLES if path.stem not in QUICK], ids=lambda path: path.stem)
def test_each_is_answered_as_its_name_says(path, tmp_path):
    solve(path, tmp_path / "out")
