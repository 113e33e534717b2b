"""The requirement files that ship: each is answered as its name says, and what is written passes `cyclo check`.

Of every run are two of them, with fewer candidates (`tests/ltca/commands/test_design.py`), and the search of a backlash
that nothing has (`test_search.test_a_pair_that_would_do_does`).
"""

from __future__ import annotations

from pathlib import Path

import pytest

from ltca.commands.program import main

EXAMPLES = sorted((Path(__file__).parents[4] / "examples" / "requirements").glob("*.toml"))


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
@pytest.mark.nightly
@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_each_is_answered_as_its_name_says(path, tmp_path):
    solve(path, tmp_path / "out")
