"""Error bars of a case from nested meshes: which mesh, of what they are parts, files, too little memory."""

from types import SimpleNamespace

import numpy as np
import pytest

from fem.discretisation_error import estimate_error
from fem.errors import MemoryLimitError
from fem.options import SolutionOptions
from fem.reducer.nested_meshes import NestedFigure
from ltca.drive.units.quantities import ARCSEC
from validation.compare import error_bars
from validation.compare.error_bars import ErrorBars, bars_words, error_bars_of


def figure(quantity, values, order=2.0):
    return NestedFigure(
        quantity=quantity, place="", disc=0, part=0, formal_order=order, estimate=estimate_error(values, order)
    )


@pytest.fixture
def nested():
    """All figures halve their error by four: the finest has 1.25 · 1/3 of the last change, the middle that and the change."""
    changes = np.array([5.0, 1.0, 0.0])
    figures = [figure(name, 1e-4 * changes + 1e-3) for name in ("disc_x", "disc_y", "disc_rotation", "wheel_angle")]
    for name in ("pin_load", "roller_load", "roller_load_inner", "pin_shaft_load"):
        figures += [figure(name, 1000.0 + changes), figure(name, 500.0 + 3.0 * changes)]
    figures += [figure(name, 200.0 + changes) for name in ("pin_pressure_mid", "pin_half_width", "pin_shear_max")]
    figures += [figure("bearing_radial", 30.0 + changes), figure("bearing_tangential", 40.0 - 2.0 * changes)]
    figures += [figure("root_stress", 50.0 + changes), figure("bore_stress", 80.0 + 2.0 * changes)]
    level = SimpleNamespace(bearing=np.array([[[30.0, 40.0]]]))
    return SimpleNamespace(figures=tuple(figures), levels=(level,), solution=SimpleNamespace(crank_angle=0.5))


FINEST = 1.25 / 3.0
MIDDLE = FINEST + 1.0


def test_bars_are_those_of_the_compared_mesh(nested):
    bars = ErrorBars.of_nested(nested)
    pins = bars.kinds["pin"]
    # Order log2(4/1) = 2, so 1/(2² − 1) of the last change; loads relative to the largest of the kind, the rest to itself.
    assert pins.load == pytest.approx(3.0 * MIDDLE / 1000.0)
    assert pins.pressure == pins.half_width == pins.shear == pytest.approx(MIDDLE / 200.0)
    assert bars.kinds["hole"].pressure is None
    assert bars.wheel_angle == bars.disc_rotation == pytest.approx(1e-4 * MIDDLE * ARCSEC)
    assert bars.disc_displacement == pytest.approx(np.sqrt(2.0) * 1e-4 * MIDDLE)
    assert bars.bearing_force == pytest.approx(2.0 * MIDDLE / 50.0)
    # Walls are as fine as compared ones on the finest mesh; parts of the largest stress along any wall.
    assert bars.walls == pytest.approx({"flank": FINEST / 80.0, "bore": 2.0 * FINEST / 80.0})
    assert bars.largest_load == pins.load


def test_a_compared_solution_farther_off_widens_the_bars(nested):
    """Its distance from the finest counts where it is larger than that of the middle mesh."""
    contacts = SimpleNamespace(load=np.array([1004.0]), pressure=np.array([200.1]), half_width=np.array([200.0]))
    answer = SimpleNamespace(
        wheel_angle=1e-3 + 3e-4,
        disc_rotation=1e-3,
        bearing_radial=np.array([30.0]),
        bearing_tangential=np.array([40.0]),
        kinds=dict.fromkeys(error_bars.CONTACT_KINDS, contacts),
    )
    position = SimpleNamespace(
        answer=answer, stress=SimpleNamespace(shear={kind: [202.0] for kind in error_bars.SHEARS})
    )
    plain, bars = ErrorBars.of_nested(nested), ErrorBars.of_nested(nested, [position])
    assert bars.wheel_angle == pytest.approx(ARCSEC * (3e-4 + 1e-4 * FINEST))
    assert bars.kinds["pin"].shear == pytest.approx((2.0 + FINEST) / 200.0)
    assert bars.kinds["pin"].pressure == plain.kinds["pin"].pressure
    assert bars.disc_rotation == plain.disc_rotation


def test_bars_are_found_once(nested, paper_cases, tmp_path, monkeypatch):
    """A kept file gives the same bars; another element size is another problem."""
    solved = []
    monkeypatch.setattr(error_bars, "solve_nested", lambda *_, **__: solved.append(1) or nested)
    ask = (paper_cases["CS-1"], "CS-1", 0.5, tmp_path)
    first = error_bars_of(*ask, SolutionOptions())
    assert first == error_bars_of(*ask, SolutionOptions())
    assert first == ErrorBars.of_nested(nested)
    assert len(solved) == 1
    error_bars_of(*ask, SolutionOptions(size=2.0))
    assert len(solved) == 2


def test_too_little_memory_is_told(paper_cases, tmp_path, monkeypatch):
    def refuse(*_, **__):
        raise MemoryLimitError(10**6, 3e9, 1e9, "the finest of the nested meshes")

    monkeypatch.setattr(error_bars, "solve_nested", refuse)
    said = []
    ask = (paper_cases["CS-1"], "CS-1", 0.5, tmp_path, SolutionOptions())
    assert error_bars_of(*ask, progress=said.append) is None
    assert "no error bars: the finest of the nested meshes" in said[0]
    assert "None for CS-1: the memory is too small" in bars_words({"CS-1": None})
    assert bars_words({}) == ""
