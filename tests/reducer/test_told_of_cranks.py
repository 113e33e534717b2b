"""What summary, table and figures of a run tell of each of several cranks."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from ltca.analysis.drive_curves import speed_words
from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.results import build_dataset
from ltca.analysis.summary import summarise
from ltca.analysis.transmission_error_orders import Order, Spectrum
from ltca.commands.program import main
from ltca.commands.show import _loads
from ltca.drive.units.quantities import ARCSEC
from ltca.figures import curve_figures
from ltca.figures.drive_picture import drive_figure
from ltca.figures.house_style import OTHERS
from ltca.figures.run_figures import draw_figure, figure_names
from ltca.reading.drive_file import load_drive, parse_drive, shipped_drive

pytestmark = pytest.mark.slow

ANGLES = np.array([0.31, 1.7, 3.1, 4.4])


@pytest.fixture(scope="module")
def rv():
    return parse_drive(shipped_drive("rv"), "rv").cases["nominal"]


@pytest.fixture(scope="module")
def solved(rv):
    found = analyse(rv, ANGLES)
    return found, build_dataset("rv", {"nominal": found})


def test_summary_tells_largest_load_and_deflection_of_each_crank(solved):
    """Loads were means alone, and how far cranks go was in results.nc only."""
    found, data = solved[0], solved[1].isel(case=0)
    summary = summarise(found)
    load = np.hypot(data["bearing_radial"], data["bearing_tangential"])
    moved = np.hypot(data["crank_deflection_radial"], data["crank_deflection_tangential"])
    round_off = 1e-12
    assert summary["max_bearing_load_N"] == pytest.approx(float(load.max()), rel=round_off)
    for crank in range(3):
        told = summary[f"max_bearing_load_crank_{crank}_N"], summary[f"max_crank_deflection_crank_{crank}_mm"]
        assert told[0] == pytest.approx(float(load.isel(crank=crank).max()), rel=round_off)
        assert told[1] == pytest.approx(float(moved.isel(crank=crank).max()), rel=round_off)
    assert "max_bearing_load_crank_3_N" not in summary


def test_rigid_and_central_cranks_have_no_keys_of_their_own(rv):
    rigid = summarise(analyse(replace(rv, crank=replace(rv.crank, support=None)), ANGLES[:1]))
    assert "max_bearing_load_crank_2_N" in rigid
    assert not any("deflection" in key for key in rigid)
    central = summarise(analyse(load_drive("paper").cases["CS-1"], ANGLES[:1]))
    assert central["max_bearing_load_N"] == central["mean_bearing_load_N"]
    assert not any("deflection" in key or "load_crank" in key for key in central)


@pytest.mark.slow
def test_run_prints_what_each_crank_bears(tmp_path, capsys):
    """The table had the torque of each crank alone, and a residual of 0.15 N stood beside nothing."""
    path, out = tmp_path / "rv.toml", tmp_path / "out"
    path.write_text(shipped_drive("rv"), encoding="utf-8")
    assert main(["run", str(path), "--angles", "0.31", "1.7", "--no-figures", "--out", str(out)]) == 0
    told = capsys.readouterr().out
    printed = {line[:26].strip(): line[26:].split() for line in told.splitlines()}
    summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))["cases"]["nominal"]
    assert printed["crank bearing"] == [f"{summary['max_bearing_load_N']:.1f}"]
    assert printed["crank bearing, crank 2"] == [f"{summary['max_bearing_load_crank_2_N']:.1f}"]
    assert printed["crank 2"] == [f"{summary['max_crank_deflection_crank_2_mm']:.4f}"]
    part = summary["max_equilibrium_residual_N"] / summary["max_bearing_load_N"]
    assert f"forces balance within {part:.1e} of the largest bearing load" in told


def own(axes):
    """Curves of a panel, without those of the others behind."""
    return [line.get_ydata() for line in axes.lines if line.get_color() != OTHERS]


def test_the_figure_of_cranks_has_torque_and_deflection_of_each(solved):
    """No figure had either."""
    data = solved[1]
    axes = np.reshape(draw_figure("cranks", data).axes, (3, 2))
    moved = np.hypot(data["crank_deflection_radial"], data["crank_deflection_tangential"]).isel(case=0)
    for crank, (torque, deflection) in enumerate(axes):
        np.testing.assert_allclose(own(torque), data["crank_torque"].values[:1, crank] / 1e3, rtol=1e-15)
        discs = moved.isel(crank=crank).transpose("disc", "position").values
        np.testing.assert_allclose(own(deflection), 1e3 * discs, rtol=1e-15)
        assert torque.get_title(loc="left") == f"crank {crank}"
    assert set(figure_names(2, 8, 3)) - set(figure_names(2, 8)) == {"cranks"}


def test_cases_that_have_no_room_in_the_figure_of_cranks_are_counted(solved):
    data = build_dataset("rv", {f"case {number}": solved[0] for number in range(4)})
    figure = draw_figure("cranks", data)
    assert [text.get_text() for text in figure.texts if "cases" in text.get_text()] == ["2 of 4 cases"]
    assert [len(own(axes)) for axes in figure.axes] == [1, 2] * 6


def test_rollers_of_several_cranks_are_three_curves_in_their_ranges(solved):
    """Six hairy curves in three colours hid each other."""
    data = solved[1]
    panels = draw_figure("fig34_roller_load", data).axes
    assert [axes.get_title(loc="left") for axes in panels] == ["crank 0", "crank 1", "crank 2"]
    for crank, axes in enumerate(panels):
        ((mean,), (band,)) = own(axes), axes.collections
        assert np.max(band.get_paths()[0].vertices[:, 1]) == np.max(data["roller_load"].isel(crank=crank).values)
        assert 0.0 < np.max(mean) < np.max(data["roller_load"].isel(crank=crank).values)
        assert axes.get_xlim() == (-180.0, 180.0)


@pytest.mark.parametrize(
    ("installation", "elsewhere"),
    [
        # Sun and carrier at n and n/81 (1 + i₁ z_P), wheel and crank z₂/z₁ = 2: (n − n/81)/2 = 1000.
        ({}, "1000 turns a minute of the cranks against the carrier, 2025 of the input before the first stage"),
        ({"held": "pin-shaft"}, "1000 turns a minute of the cranks against the carrier, 2000 of the input"),
        # The carrier turns backward once for 40 turns of the cranks in it.
        ({"first_stage_ratio": None}, "1000 turns a minute of the cranks against the carrier, 975 against the housing"),
    ],
)
def test_the_speed_of_a_life_says_whose_it_is(rv, installation, elsewhere):
    """`--speed` was a crank speed, against the input, the housing or the carrier."""
    drive = replace(rv, installation=replace(rv.installation, **installation))
    assert speed_words(drive, 1000.0).startswith(elsewhere)


def test_the_speed_of_a_central_crank_is_against_the_held_member():
    assert speed_words(load_drive("paper").cases["CS-1"], 1500.0).endswith("of the crank against the held pin shaft")


def test_a_crank_that_carries_nothing_is_said_to_carry_none(rv):
    """`rollers, on the bore, crank 2` was followed by nothing, and its force was -0.0 N."""
    wide = replace(rv, clearance=replace(rv.clearance, bearing=0.1))
    rows = dict(_loads(analyse(wide, np.array([0.7]))))
    assert rows["disc 0: rollers, on the bore, crank 2"] == "none"
    assert rows["disc 0: bearing load on it, crank 2, radial, tangential"] == "0.0, 0.0 N"
    assert "N" in rows["disc 0: rollers, on the bore, crank 0"]


@pytest.mark.slow
def test_cranks_are_numbered_in_the_picture(rv):
    """Which crank is 2 had to be guessed from the angles."""
    figure = drive_figure(rv, analyse(rv, np.array([0.7])), 0)
    for axes in figure.axes:
        places = {text.get_text(): complex(*text.get_position()) for text in axes.texts}
        assert sum(name.startswith("crank") for name in places) == 3
        for crank, axis in enumerate(rv.crank.places):
            # inside the inner race of its own crank
            assert abs(places[f"crank {crank}"] - axis) < rv.crank_bearing.inner_race_radius


def test_numbers_of_orders_do_not_cover_each_other(tmp_path, monkeypatch):
    """Orders 1.95 and 2 of an RV reducer, and some ten more below 8, beside an axis up to 280."""
    values = np.array([0.975, 1.0, 1.742, 1.95, 2.0, 2.925, 4.0, 4.065, 6.0, 39.0, 78.0, 273.0])
    amplitude = np.array([0.041, 0.048, 0.018, 0.103, 0.124, 0.017, 0.053, 0.044, 0.28, 0.064, 0.011, 1e-5]) / ARCSEC
    orders = tuple(Order(value=float(value), name=f"order {value:g}") for value in values)
    drawn = []
    monkeypatch.setattr(curve_figures, "_save", lambda figure, stem: drawn.append(figure) or stem)
    curve_figures.draw_spectrum(
        Spectrum(orders=orders, amplitude=amplitude, phase=0.0 * values, mean=0.0, residual=0.0),
        "rv",
        tmp_path / "orders",
    )
    (axes,) = drawn[0].axes
    drawn[0].canvas.draw()
    numbers = [text for text in axes.texts if "″" not in text.get_text()]
    assert {text.get_text() for text in numbers} >= {"6", "2", "39"}
    boxes = [text.get_window_extent() for text in numbers]
    assert not any(one.overlaps(other) for place, one in enumerate(boxes) for other in boxes[:place])
    assert 78.0 < axes.get_xlim()[1] <= 100.0  # the next tick behind the last order that is seen
