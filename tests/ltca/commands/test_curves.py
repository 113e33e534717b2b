"""``cyclo curves``: what is printed, kept and drawn is one thing, and it is what the analysis says."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest

import ltca.analysis.drive_curves as curves
import ltca.figures.curve_figures as curve_figures
from ltca.analysis import engines, loaded_analysis, torque_curve, transmission_error_orders as orders
from ltca.analysis.life.bearing_lives import bearing_lives
from ltca.analysis.loaded_analysis import analyse
from ltca.commands.program import main
from ltca.compliance import coefficient_files
from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.equilibrium.balance import solve_equilibrium
from ltca.equilibrium.reducer import Reducer
from ltca.reading.drive_file import shipped_drive
from ltca.testing.closed_form_bodies import without_coupling

CASE, TURNS, SPEED = "CS-6", 14, 1500.0
PER_TURN = 88  # orders of 2 z_C + 2 z_PS = 42 a turn are told apart
ARCMIN, ARCSEC = 10_800.0 / np.pi, 648_000.0 / np.pi


@pytest.fixture(scope="module")
def told(tmp_path_factory):
    """One run with coarse turns: what it printed, what it kept, its figures unsaved, and the analysis behind them."""
    figures, printed, analyses = {}, [], []

    def keep(figure, path):
        figures[path.stem] = figure
        return path

    def follow(*words, **options):
        analyses.append(analyse(*words, **options))
        return analyses[-1]

    out = tmp_path_factory.mktemp("curves")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(curves, "POSITIONS_PER_TURN", PER_TURN)
        patch.setattr(curves, "HARMONICS", 1)
        patch.setattr(curve_figures, "_save", keep)
        patch.setattr(loaded_analysis, "analyse", follow)
        patch.setattr("builtins.print", lambda *words, **options: printed.append(" ".join(map(str, words))))
        words = ["curves", "paper", "--case", CASE, "--turns", str(TURNS), "--speed", str(SPEED), "--out", str(out)]
        status = main([*words, "--pressure-limit", "1.2 GPa", "--figures"])
    assert status == 0
    content = json.loads((out / "curves.json").read_text(encoding="utf-8"))
    (analysis,) = analyses
    return "\n".join(printed), content, figures, analysis


def printed_range(text, name):
    low, high = re.search(rf"{name}\D*?([\d.]+) … ([\d.]+)", text).groups()
    return float(low), float(high)


@pytest.mark.slow
def test_torque_curve_is_printed_as_it_is_kept(told):
    text, content, *_ = told
    kept = content["torque_curve"]
    for name, values in (
        ("backlash at the wheel, all clearances", np.array(kept["backlash_over_a_turn_rad"]) * ARCMIN),
        (r"lost motion at ±3 % of the rated torque", np.array(kept["lost_motion_rad"]) * ARCMIN),
        # N·mm/rad to N·m for each arc minute
        (r"stiffness of the cycloid stage, 50…100 %", np.array(kept["stiffness_N_mm_per_rad"]) / ARCMIN / 1000.0),
    ):
        # printed with four digits
        assert printed_range(text, name) == pytest.approx((values.min(), values.max()), rel=1e-3), name


@pytest.mark.slow
def test_torque_curve_is_that_of_the_drive(told, paper_cases):
    """At the last angle against two balances; the angles divide one tooth of the flank."""
    kept = told[1]["torque_curve"]
    angles = np.array(kept["crank_angle_rad"])
    np.testing.assert_allclose(angles, 2.0 * np.pi / 13.0 * np.arange(angles.size) / angles.size, rtol=1e-12)
    model, at = Reducer(discs=(HalfSpaceCompliance.of_drive(paper_cases[CASE]),)), np.repeat(angles[-1:], 4)
    half, full, low, high = solve_equilibrium(model, at, 377_300.0 * np.array([0.5, 1.0, -0.03, 0.03])).pose[:, 3]
    assert kept["stiffness_N_mm_per_rad"][-1][1] == pytest.approx(0.5 * 377_300.0 / (full - half), rel=1e-7)
    assert kept["lost_motion_rad"][-1] == pytest.approx(high - low, rel=1e-7)


@pytest.mark.slow
def test_torque_curve_is_drawn_as_it_is_kept(told):
    kept, (whole, close) = told[1]["torque_curve"], told[2]["torque_curve"].axes
    wound, torque = np.array(kept["wheel_angle_rad"]) * ARCMIN, np.array(kept["torque_N_mm"]) / 1000.0
    for axis in (whole, close):
        # The mean in the range of all crank angles: four equal curves hid each other.
        np.testing.assert_allclose(axis.get_lines()[0].get_ydata(), wound.mean(axis=0), rtol=1e-12)
        np.testing.assert_allclose(axis.get_lines()[0].get_xdata(), torque, rtol=1e-12)
        ends = axis.collections[0].get_paths()[0].vertices[:, 1]
        assert (ends.min(), ends.max()) == pytest.approx((wound.min(), wound.max()))
    (label,) = [text.get_text() for text in whole.get_legend().get_texts()]
    assert all(f"{np.degrees(angle):.3g}°" in label for angle in kept["crank_angle_rad"])
    # the chord whose slope is the stiffness, with its value
    stiff = np.array(kept["stiffness_N_mm_per_rad"]) / ARCMIN / 1e3
    (told,) = [text.get_text() for text in whole.texts if "cycloid stage" in text.get_text()]
    assert f"{stiff.min():.4g} … {stiff.max():.4g} N·m/′" in told
    (chord,) = [line for line in whole.get_lines() if line.get_linewidth() == 4.0]
    slope = np.ptp(chord.get_xdata()) / np.ptp(chord.get_ydata())
    assert stiff[:, 1].min() < slope < stiff[:, 1].max()
    # ±3 % of the rated torque, dashed
    dashed = sorted(float(line.get_xdata()[0]) for line in close.get_lines()[-2:])
    assert dashed == pytest.approx([-0.03 * 377.3, 0.03 * 377.3])


@pytest.mark.slow
def test_orders_rebuild_the_transmission_error(told):
    """Σ a cos(o φ − p) and a mean leave the residual that is printed, and what it leaves is orthogonal to every order."""
    text, content, _, analysis = told
    angle = 2.0 * np.pi * np.arange(TURNS * PER_TURN) / PER_TURN
    np.testing.assert_allclose(analysis.full.crank_angle, angle, rtol=1e-14)
    kept = content["transmission_error_orders"]
    error = analysis.full.pose[:, 3]
    left = error - error.mean()
    for entry in kept["orders"]:
        left = left - entry["amplitude_rad"] * np.cos(entry["order"] * angle - entry["phase_rad"])
    left -= left.mean()
    rms = float(np.sqrt(np.mean(left**2)))
    assert kept["residual_rms_rad"] == pytest.approx(rms, rel=1e-6)
    assert rms < 0.5 * np.std(error)
    for entry in kept["orders"]:
        assert abs(np.mean(left * np.cos(entry["order"] * angle))) < 1e-9 * np.std(error)
    assert float(re.search(r"unexplained, rms\s+([\d.]+)″", text).group(1)) == pytest.approx(rms * ARCSEC, abs=6e-5)
    assert kept["turns"] == TURNS


@pytest.mark.slow
def test_orders_are_printed_and_drawn_as_they_are_kept(told):
    text, content, figures, _ = told
    largest = sorted(content["transmission_error_orders"]["orders"], key=lambda entry: -entry["amplitude_rad"])
    printed = re.findall(r"^ +([\d.]+)  (\S.*?) +([\d.]+)″$", text, flags=re.M)
    printed = [row for row in printed if row[1] in {entry["name"] for entry in largest}]
    (axes,) = figures["transmission_error_orders"].axes
    listed = [item.get_text() for item in axes.texts if "″" in item.get_text()]
    assert len(printed) == 8
    for entry, (order, name, amplitude) in zip(largest, printed, strict=False):
        seconds = entry["amplitude_rad"] * ARCSEC
        assert (float(order), name) == (pytest.approx(entry["order"], abs=6e-5), entry["name"])
        assert float(amplitude) == pytest.approx(seconds, abs=6e-5)
        assert any(line.split()[:2] == [f"{entry['order']:.4f}", f"{seconds:.3f}″"] for line in listed)
    assert f"{content['transmission_error_orders']['residual_rms_rad'] * ARCSEC:.2g}″ rms" in axes.get_title()


@pytest.mark.slow
def test_pressure_is_one_number(told):
    """Printed, kept and drawn from the same positions: all turns, not the first alone."""
    text, content, figures, analysis = told
    kept = content["pressure_safety"]
    pressure = analysis.pressures.pins.mid
    assert kept["largest_MPa"] == pytest.approx(pressure.max(), rel=1e-12)
    assert kept["pin"] == int(np.argmax(pressure.max(axis=0)))
    assert kept["limit_MPa"] == pytest.approx(1200.0)
    assert kept["safety"] == pytest.approx(1200.0 / pressure.max(), rel=1e-12)
    assert kept["load_factor"] == pytest.approx(kept["safety"] ** 2, rel=1e-12)
    largest, safety = re.search(r"flank pressure ([\d.]+) MPa, safety ([\d.]+) against 1200 MPa", text).groups()
    assert (largest, safety) == (f"{kept['largest_MPa']:.1f}", f"{kept['safety']:.3f}")
    (axes,) = figures["flank_pressure"].axes
    assert f"safety {safety} against 1200 MPa (pin {kept['pin']})" in axes.get_title()
    *_, mark = axes.get_lines()
    assert mark.get_ydata()[0] == pytest.approx(kept["largest_MPa"])
    curve = axes.get_lines()[-3]  # the largest of all pins
    assert np.max(curve.get_ydata()) == pytest.approx(kept["largest_MPa"])
    at = int(np.argmax(curve.get_ydata()))
    assert mark.get_xdata()[0] == pytest.approx(curve.get_xdata()[at])


@pytest.mark.slow
def test_life_is_printed_as_it_is_kept(told):
    text, content, *_ = told
    kept = content["bearing_life"]
    rating, load, life = re.search(r"C (\d+) N, P (\d+) N, L10r ([\d.]+) million turns", text).groups()
    assert (rating, load) == (f"{kept['dynamic_load_rating_N']:.0f}", f"{kept['equivalent_load_N']:.0f}")
    assert life == f"{kept['million_turns']:.1f}"
    # (C/P)^(10/3), and a million turns at 1500 a minute
    ratio = kept["dynamic_load_rating_N"] / kept["equivalent_load_N"]
    assert kept["million_turns"] == pytest.approx(ratio ** (10.0 / 3.0), rel=1e-9)
    assert kept["hours"] == pytest.approx(kept["million_turns"] * 1e6 / 1500.0 / 60.0, rel=1e-12)
    assert f"{kept['hours']:.0f} h at 1500 turns a minute" in text
    static = re.search(r"C0 (\d+) N, largest force (\d+) N, S0 ([\d.]+)", text).groups()
    assert static == tuple(
        f"{kept[name]:{form}}"
        for name, form in (("static_load_rating_N", ".0f"), ("static_load_N", ".0f"), ("static_safety_S0", ".2f"))
    )
    (only,) = kept["bearings"]
    assert only == {name: kept[name] for name in only}
    assert kept["duty"] is None


@pytest.mark.slow
def test_life_is_that_of_the_analysis(told):
    """All its turns, at the speed asked for."""
    *_, analysis = told
    kept, found = told[1]["bearing_life"], bearing_lives(analysis, speed=SPEED).shortest
    assert (kept["million_turns"], kept["hours"]) == pytest.approx((found.life, found.hours), rel=1e-12)


DUTY = """
[[duty]]
torque = "377.3 N m"
speed = 1500.0
share = 0.25
[[duty]]
torque = "200 N m"
speed = 3000.0
share = 0.75
"""


def test_duty_of_a_file_is_told(monkeypatch, tmp_path, capsys):
    """Every entry, one life of all, and no speed beside it."""
    make_coarse(monkeypatch)
    source = tmp_path / "mine.toml"
    source.write_text(shipped_drive().partition("\n[tolerances]")[0] + DUTY, encoding="utf-8")
    words = ["curves", str(source), "--turns", "1", "--no-figures", "--out", str(tmp_path / "out")]
    assert main(words) == 0
    kept = json.loads((tmp_path / "out" / "curves.json").read_text(encoding="utf-8"))["bearing_life"]
    first, second = kept["duty"]
    assert (first["torque_N_mm"], second["torque_N_mm"]) == (377_300.0, 200_000.0)
    # a quarter of the time at half the speed is a seventh of the turns
    assert kept["million_turns"] == pytest.approx(
        7.0 / (1.0 / first["million_turns"] + 6.0 / second["million_turns"]), rel=1e-9
    )
    assert kept["hours"] == pytest.approx(kept["million_turns"] * 1e6 / (60.0 * 2625.0), rel=1e-9)
    text = capsys.readouterr().out
    assert "over 2 entries of the duty" in text
    assert "200 N·m: 85.7 % of the turns" in text
    assert main([*words, "--speed", "100"]) == 2
    assert "--speed: has no effect with [[duty]]" in capsys.readouterr().err


def make_coarse(monkeypatch):
    """One angle, 44 positions and the first orders only."""
    monkeypatch.setattr(torque_curve, "CURVE_ANGLES", 1)
    monkeypatch.setattr(curves, "POSITIONS_PER_TURN", 44)
    monkeypatch.setattr(
        curves, "fitted_orders", lambda drive, harmonics: (orders.Order(8.0, "a"), orders.Order(13.0, "b"))
    )


def coarse_curves(monkeypatch, out, *words):
    """A coarse run without figures; return curves.json."""
    make_coarse(monkeypatch)
    assert main(["curves", "paper", "--turns", "1", "--no-figures", "--out", str(out), *words]) == 0
    return json.loads((out / "curves.json").read_text(encoding="utf-8"))


@pytest.mark.slow
def test_all_cases_are_there(monkeypatch, tmp_path, capsys, paper_cases):
    """All but the last case given were dropped."""
    kept = coarse_curves(monkeypatch, tmp_path / "all")
    assert list(kept["cases"]) == list(paper_cases)
    printed = capsys.readouterr().out
    safeties = re.findall(r"safety ([\d.]+) against", printed)
    for (name, case), safety in zip(kept["cases"].items(), safeties, strict=True):
        assert f"paper {name}, 377.3 N·m ccw, half-space (tables): torque curve" in printed
        assert case["drive"] == f"paper {name}"
        analysis = analyse(paper_cases[name], 2.0 * np.pi * np.arange(44) / 44)
        assert case["pressure_safety"]["largest_MPa"] == pytest.approx(analysis.pressures.pins.mid.max(), rel=1e-9)
        assert safety == f"{case['pressure_safety']['safety']:.3f}"
    # one alone stands as it did, and says the same
    alone = coarse_curves(monkeypatch, tmp_path / "one", "--case", "CS-4")
    assert alone == kept["cases"]["CS-4"]
    two = coarse_curves(monkeypatch, tmp_path / "two", "--case", "CS-4", "--case", "CS-2")
    assert two["cases"] == {name: kept["cases"][name] for name in ("CS-4", "CS-2")}


@pytest.mark.slow
def test_parts_are_printed_kept_and_shown(monkeypatch, tmp_path, capsys):
    """Of a case whose carrier twists and of one that leaves it out; asked for, and not."""
    source = tmp_path / "mine.toml"
    cases = '\n[[case]]\nname = "twists"\ncarrier.stiffness_torsion = "400 N·m/arcmin"\n[[case]]\nname = "stiff"\n'
    source.write_text(shipped_drive("rv").partition("\n[tolerances]")[0] + cases, encoding="utf-8")
    make_coarse(monkeypatch)
    words = ["curves", str(source), "--turns", "1", "--compliance", "half-space", "--out", str(tmp_path / "out")]
    assert main([*words, "--parts"]) == 0
    kept = json.loads((tmp_path / "out" / "curves.json").read_text(encoding="utf-8"))["cases"]
    text, page = capsys.readouterr().out, (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    twists, stiff = (kept[name]["stiffness_by_part"] for name in ("twists", "stiff"))
    assert [*stiff["without"]] == ["crankshafts and their bearings"]
    assert [*twists["without"]] == [*stiff["without"], "torsion of the carrier"]
    # without its twist the first case is the second
    assert twists["without"]["torsion of the carrier"] == stiff["whole"]
    assert twists["contacts_alone"] == stiff["without"]["crankshafts and their bearings"]
    for name, found in (
        ("everything that is described", twists["whole"]),
        ("contacts alone", twists["contacts_alone"]),
    ):
        printed = [float(word) for word in re.search(rf"^  {name} +(.*)$", text, flags=re.M).group(1).split()]
        angles = [found[f"{angle}_rad"] * ARCMIN for angle in ("wind_up", "lost_motion", "backlash")]
        # four digits, and a thousandth of an arc minute
        assert printed[0] == pytest.approx(found["stiffness_N_mm_per_rad"] / ARCMIN / 1e3, rel=6e-4)
        assert printed[1:] == pytest.approx(angles, abs=6e-4)
    assert "Stiffness by part" in page
    assert main(words) == 0
    assert "Stiffness by part" not in (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    kept = json.loads((tmp_path / "out" / "curves.json").read_text(encoding="utf-8"))["cases"]
    assert all(case["stiffness_by_part"] is None for case in kept.values())


def test_speed_of_a_drive_whose_housing_is_held(monkeypatch, tmp_path):
    """--speed is that of the crank against what is held; against the disc, which turns back, it is z_P/z_C as much."""
    make_coarse(monkeypatch)
    source = tmp_path / "held.toml"
    text = shipped_drive().partition("\n[tolerances]")[0].replace('held = "pin-shaft"', 'held = "pin-wheel"')
    source.write_text(text, encoding="utf-8")
    out = tmp_path / "out"
    assert main(["curves", str(source), "--turns", "1", "--no-figures", "--out", str(out), "--speed", "1300"]) == 0
    kept = json.loads((out / "curves.json").read_text(encoding="utf-8"))["bearing_life"]
    assert kept["hours"] == pytest.approx(kept["million_turns"] * 1e6 / (60.0 * 1400.0), rel=1e-12)


@pytest.mark.slow
def test_figures_of_several_cases_have_their_names(monkeypatch, tmp_path):
    stems = []
    monkeypatch.setattr(curve_figures, "_save", lambda figure, path: stems.append(path.name) or path)
    make_coarse(monkeypatch)
    words = ["curves", "paper", "--turns", "1", "--out", str(tmp_path), "--case", "CS-1"]
    assert main([*words, "--case", "CS-2", "--figures", "pdf"]) == 0
    assert stems == [
        f"{name}_{case}.pdf"
        for case in ("CS-1", "CS-2")
        for name in ("torque_curve", "transmission_error_orders", "flank_pressure")
    ]


@pytest.mark.slow
def test_compliance_is_passed_on(monkeypatch, tmp_path):
    """It was half-space without a word. Without coupling and hole walls `hybrid` is the half-space, in everything."""
    plain = coarse_curves(monkeypatch, tmp_path / "plain", "--case", CASE)
    asked = []

    def nothing(drive, *given, **options):
        asked.append(drive)
        return without_coupling(drive)

    monkeypatch.setattr(engines, "find_coefficients", nothing)
    monkeypatch.setattr(coefficient_files, "find_case_coefficients", lambda cases, files, engine, bodies: {})
    words = ["--case", CASE, "--compliance", "hybrid"]
    hybrid = coarse_curves(monkeypatch, tmp_path / "hybrid", *words, "--no-hole-near-field")
    assert len(asked) == 1
    assert (hybrid["compliance"], hybrid["hole_near_field"], plain["compliance"]) == ("hybrid", "no", "half-space")
    wheels = (np.array(kept["torque_curve"]["wheel_angle_rad"]) for kept in (hybrid, plain))
    np.testing.assert_allclose(*wheels, rtol=0.0, atol=1e-11)  # 1e-9 of the load over the stiffness
    # powers of 4.5 of loads that agree to 1e-7
    assert hybrid["bearing_life"]["million_turns"] == pytest.approx(plain["bearing_life"]["million_turns"], rel=1e-5)
    assert hybrid["pressure_safety"]["largest_MPa"] == pytest.approx(plain["pressure_safety"]["largest_MPa"], rel=1e-6)
    soft = coarse_curves(monkeypatch, tmp_path / "soft", *words)
    stiffness = (np.min(kept["torque_curve"]["stiffness_N_mm_per_rad"]) for kept in (soft, plain))
    assert next(stiffness) < 0.999 * next(stiffness)
    # walls that yield move the disc as the load goes from hole to hole: not the torque curve alone is the engine's
    holes = (kept["transmission_error_orders"]["orders"][0]["amplitude_rad"] for kept in (soft, plain))
    assert abs(next(holes) / next(holes) - 1.0) > 0.01


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--coefficients", "c.nc"], "coefficients: has no effect with compliance half-space"),
        (["--no-hole-near-field"], "hole_near_field: has no effect with compliance half-space"),
        (["--compliance", "fe", "--coefficients", "missing.nc"], "missing.nc: no such file"),
        (["--case", "CS-1", "--case", "CS-9"], "case 'CS-9' is not defined"),
    ],
)
def test_what_has_no_effect_is_refused(words, message, tmp_path, capsys):
    assert main(["curves", "paper", *words, "--out", str(tmp_path)]) == 2
    assert message in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
