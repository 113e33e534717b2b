"""The figures of docs/theory/seats.md: what its command prints and draws."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ltca.laws.seats.arc import solve_arc
from validation.seats import draw, hertz_rows, persson_load, persson_pressure

DOCS = Path(__file__).parents[2] / "docs"


def test_where_hertz_ends_is_told():
    """The issue's slot under 1150 N; the page says what the command prints."""
    rows = [row for row in hertz_rows() if " 1150 N" in row]
    assert len(rows) == 1
    page = (DOCS / "theory" / "seats.md").read_text(encoding="utf-8")
    told = next(line for line in page.splitlines() if line.startswith("| 1150 N | 0.212"))
    for printed, figure in (("(+6.9%)", "+6.9 %"), ("(-9.3%)", "−9.3 %"), ("(-5.0%)", "−5.0 %")):
        assert printed in rows[0]
        assert figure in told


@pytest.mark.parametrize("b", [0.05, 0.5, 0.9])
def test_persson(b):
    arc = solve_arc(b, 0.0, 1.0)
    assert float(persson_load(b)) == pytest.approx(1.0 / arc.play, rel=1e-9)
    angle = np.linspace(0.0, 1.9 * np.arctan(b), 9)
    np.testing.assert_allclose(persson_pressure(angle, b), arc.pressure(angle), rtol=1e-9)


@pytest.mark.slow
def test_the_picture(tmp_path):
    """It is drawn, and the one in the repository has the same curves and labels (builds of fonts move other things)."""
    draw(tmp_path / "seats.svg")
    drawn, kept = ((folder / "seats.svg").read_text(encoding="utf-8") for folder in (tmp_path, DOCS / "pictures"))
    for label in ("Persson", "Hertz", "half the arc α, degrees", "α = 84°"):
        assert label in drawn
        assert label in kept


def test_hertz_is_the_limit_of_small_loads_in_the_picture(tmp_path, monkeypatch):
    from matplotlib.figure import Figure

    figures = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, *_, **__: figures.append(figure))
    draw(tmp_path / "seats.svg")
    for axes in figures[0].axes[:2]:
        drawn = {line.get_label(): line.get_ydata() for line in axes.get_lines()}
        assert drawn["Hertz"][0] == pytest.approx(drawn["law"][0], rel=0.01)
        assert drawn["Hertz"][-1] > 1.5 * drawn["law"][-1] or drawn["Hertz"][-1] < 0.7 * drawn["law"][-1]
