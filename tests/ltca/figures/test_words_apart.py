"""No two words of a figure overlap and none leaves its canvas: six kinds of drive, and figures of made-up results.

Words are those that are drawn, tick labels too, with the boxes they have when they are: a pixel of air is not asked for.
"""

from __future__ import annotations

import tomllib
from unittest.mock import patch

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text

from fem.pictures.scene import Panel, compose
from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.pressure_fields import build_pressure_dataset
from ltca.analysis.pressure_safety import pressure_safety
from ltca.analysis.results import build_dataset
from ltca.analysis.torque_curve import TorqueCurve
from ltca.analysis.transmission_error_orders import Order, Spectrum
from ltca.drive.units.quantities import ARCSEC
from ltca.drive.yielding_parts import yielding_parts
from ltca.figures import curve_figures
from ltca.figures.drive_picture import drive_figure
from ltca.figures.house_style import STYLE
from ltca.figures.optimum_figures import _front, _search, _title
from ltca.figures.pressure_figures import draw_contact_zone, draw_roller_pressure, draw_sections
from ltca.figures.run_figures import draw_figure, figure_names
from ltca.figures.study_figures import study_figures
from ltca.geometry.placement import position_angles
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive, parse_drive, shipped_drive
from ltca.studies.optimiser import Optimum, Problem, Variable, parse_bound
from ltca.studies.sensitivity import chance_of
from ltca.studies.sweep_file import parse_sweep
from ltca.studies.tolerance_study import tolerance_study

AIR = 0.5
"""Pixels that boxes may run into each other on every side: rounding of their ends."""
LONG = "a-long-name-of-a-drive-with-everything-in-it-and-more-than-fits-a-title"


def words(figure):
    """Every text that is drawn and its box, pixels."""
    drawn, draw = [], Text.draw

    def record(text, renderer):
        if text.get_visible() and text.get_text().strip():
            drawn.append((text.get_text(), text.get_window_extent(renderer).extents))
        draw(text, renderer)

    with mpl.rc_context(STYLE), patch.object(Text, "draw", record):
        # Laid out and gone through as for a file, with no pixel painted.
        figure.draw_without_rendering()
    return drawn


def assert_words_stand_apart(figure):
    found = words(figure)
    assert found
    boxes = np.array([box for _, box in found]) + AIR * np.array([1.0, 1.0, -1.0, -1.0])
    width, height = figure.bbox.size
    beyond = (boxes[:, :2] < -2.0 * AIR).any(axis=1) | (boxes[:, 2] > width + AIR) | (boxes[:, 3] > height + AIR)
    assert not [found[number] for number in np.flatnonzero(beyond)], "beyond the canvas"
    over = np.all((boxes[:, None, :2] < boxes[None, :, 2:]) & (boxes[None, :, :2] < boxes[:, None, 2:]), axis=2)
    pairs = np.argwhere(np.triu(over, 1))
    assert not [(found[one], found[other]) for one, other in pairs.tolist()], "on each other"


def shipped(name, **changes):
    drive = next(iter(parse_drive(shipped_drive(name), name).cases.values()))
    return with_fields(drive, {key.replace("__", "."): value for key, value in changes.items()}) if changes else drive


def sixty():
    """A robot joint's drive with sixty pins and one disc, in two cases."""
    one = {"disc.number_of_discs": 1, "disc.phases": (), "disc.planes": ()}
    pins = {"pin_wheel.number_of_pins": 60, "disc.number_of_teeth": 59, "pin_wheel.pin_circle_radius": 90.0}
    drive = with_fields(shipped("robot-joint"), one | pins)
    return {"tight": drive, "loose": with_fields(drive, {"clearance.bearing": 0.02})}


def plastic():
    table = tomllib.loads(shipped_drive("paper"))
    table["materials"]["disc"] = "PA12"
    table["load"] |= {"torque": 8000.0, "light_torque": 800.0}
    from ltca.reading.drive_file import build_drive

    del table["case"], table["tolerances"]
    return {"nominal": build_drive(table)}


KINDS = {
    "paper": lambda: dict(load_drive("paper").cases),
    "sixty pins": sixty,
    "robot-joint": lambda: {"nominal": shipped("robot-joint")},
    "rv": lambda: {"nominal": shipped("rv")},
    "sleeved": lambda: {"nominal": shipped("sleeved")},
    "plastic": plastic,
}


def solved(kind, positions):
    analyses = {name: analyse(drive, position_angles(positions)) for name, drive in KINDS[kind]().items()}
    text = shipped_drive() if kind == "paper" else ""
    return analyses, build_dataset(kind, analyses, text)


@pytest.fixture(scope="module")
def two():
    """Two of the paper's cases, at few positions."""
    return {name: analyse(load_drive("paper").cases[name], position_angles(6)) for name in ("CS-1", "CS-6")}


def test_words_of_a_figure_stand_apart(two):
    """Names fanned out from the ends of curves, on each other's leaders."""
    assert_words_stand_apart(draw_figure("fig24_pin_load", build_dataset("paper", two, shipped_drive())))


def test_only_figures_of_the_papers_drive_have_its_numbers(two):
    """Every drive had "(Fig. 24)"."""
    told = [
        draw_figure("fig29_tangential_bearing_load", build_dataset("paper", two, text)).get_suptitle()
        for text in (shipped_drive(), shipped_drive("rv"), "")
    ]
    assert told == ["Tangential bearing load (Fig. 29)", "Tangential bearing load", "Tangential bearing load"]


@pytest.mark.slow
def test_words_of_the_picture_of_the_drive_stand_apart(two):
    """Loads stood on each other, and on pins; no pin had its number."""
    figure = drive_figure(two["CS-6"].drive, two["CS-6"], 5, "CS-6")
    assert_words_stand_apart(figure)
    numbers = [text.get_text() for text in figure.axes[0].texts if text.get_text().isdigit()]
    assert sorted(map(int, numbers)) == sorted([*range(14), *range(11), *range(8)])


@pytest.mark.slow
def test_words_of_a_hundred_pins_stand_apart():
    """Forces stood on pins and on each other: of pins this close every second has its number and its force."""
    pins = {
        "pin_wheel.number_of_pins": 100, "disc.number_of_teeth": 99, "pin_wheel.pin_circle_radius": 110.0,
        "pin_wheel.pin_radius": 2.0, "crank.eccentricity": 0.75,
    }  # fmt: skip
    drive = with_fields(shipped("robot-joint"), pins)
    figure = drive_figure(drive, analyse(drive, np.array([0.5])), 0)
    assert_words_stand_apart(figure)
    axes = figure.axes[0]
    told = [text.get_text() for text in axes.texts]
    assert {str(number) for number in range(20, 100, 2)} <= set(told)  # of pins alone: rollers are fourteen
    assert not {str(number) for number in range(21, 100, 2)} & set(told)
    forces = np.array([box for told, box in words(figure) if told.endswith(" N")])
    assert len(forces) > 30
    for axes in figure.axes:
        pins = next(one for one in axes.collections if len(one.get_paths()) == 100)
        middles = axes.transData.transform([path.get_extents().get_points().mean(axis=0) for path in pins.get_paths()])
        inside = np.all((forces[:, None, :2] < middles) & (middles < forces[:, None, 2:]), axis=2)
        assert not inside.any()


@pytest.mark.slow
@pytest.mark.parametrize(
    "kind", [kind if kind == "paper" else pytest.param(kind, marks=pytest.mark.nightly) for kind in KINDS]
)
def test_words_of_every_figure_of_a_run_stand_apart(kind):
    analyses, dataset = solved(kind, 25)
    # The others are drawn as these are, or in the quick set.
    told = {
        "fig23_transmission_error",
        "fig24_pin_load",
        "fig25_loaded_pins",
        "fig34_roller_load",
        "torque_share",
        "cranks",
    }
    names = set(figure_names(dataset.sizes["disc"], dataset.sizes["hole"], dataset.sizes["crank"])) & told
    for name in sorted(names):
        assert_words_stand_apart(draw_figure(name, dataset))
    if kind != "paper":
        one = next(iter(analyses.values()))
        assert_words_stand_apart(drive_figure(one.drive, one, 3, next(iter(analyses))))


@pytest.mark.nightly
@pytest.mark.slow
def test_words_of_pressures_stand_apart():
    kind = "sixty pins"
    cases = KINDS[kind]()
    shown = {name: analyse(drive, np.array([0.0])) for name, drive in list(cases.items())[:2]}
    fields = build_pressure_dataset(kind, shown)
    with mpl.rc_context(STYLE):
        zone = Figure(figsize=(10.4, 4.6))
        draw_contact_zone(zone, build_dataset(kind, shown), next(iter(cases.values())))
        sections = [draw_sections(fields, major=major) for major in (True, False)]
        for figure in (zone, *sections, draw_roller_pressure(fields, next(iter(shown)))):
            assert_words_stand_apart(figure)


@pytest.mark.slow
def test_words_of_curves_stand_apart(tmp_path):
    angle = np.radians([0.0, 7.0, 14.0, 21.0])
    torque = np.linspace(-4e5, 4e5, 41)
    wound = np.sign(torque) * 1.8e-3 + torque * 1.6e-9 + 1e-6 * np.arange(4)[:, None]
    curve = TorqueCurve(
        crank_angle=angle, torque=torque, wheel_angle=wound, output_angle=wound, backlash=np.full(4, 3.6e-3),
        lost_motion=np.full(4, 3.7e-3), stiffness=np.full((4, 2), 6e8),
            reducer_stiffness=np.full((4, 2), 4e8), yielding=yielding_parts(next(iter(load_drive("paper").cases.values()))),
    )  # fmt: skip
    values = np.array([0.975, 1.0, 1.742, 1.95, 2.0, 2.925, 4.0, 4.065, 6.0, 39.0, 78.0, 273.0])
    orders = tuple(Order(value=float(value), name="flank and holes, |7 z_C − 7 z_PS|") for value in values)
    spectrum = Spectrum(orders=orders, amplitude=values[::-1] / ARCSEC, phase=0.0 * values, mean=0.0, residual=0.0)
    pressure = 1500.0 * np.abs(np.sin(np.linspace(0.0, 9.0, 90)))[:, None] * np.linspace(0.5, 1.0, 14)
    drawn = []
    with patch.object(curve_figures, "_save", lambda figure, stem: drawn.append(figure) or stem):
        curve_figures.draw_torque_curve(curve, LONG, tmp_path / "a")
        curve_figures.draw_spectrum(spectrum, LONG, tmp_path / "b")
        turn = np.radians(360.0 + 4.0 * np.arange(90))
        curve_figures.draw_pressure(turn, pressure, pressure_safety(pressure, 1200.0), LONG, tmp_path / "c")
    for figure in drawn:
        assert_words_stand_apart(figure)


def ranking(study, method):
    random = np.random.default_rng(0)
    paths = study.design.names if hasattr(study.design, "factors") else [name for name, _ in study.design.groups]
    shares = {path: float(share) for path, share in zip(paths, random.uniform(0.0, 0.4, len(paths)), strict=True)}
    table = {"explained": 0.31, "shares": dict(sorted(shares.items(), key=lambda item: -item[1]))}
    return {"method": method, "quantities": dict.fromkeys(study.quantities, table)}


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["tolerance", pytest.param("sweep", marks=pytest.mark.nightly)])
def test_words_of_studies_stand_apart(kind):
    """Titles of rankings were cut, responses stood 3835 pixels tall."""
    if kind == "tolerance":
        kept = ("ptp_transmission_error", "max_pin_load", "max_pin_shaft_pressure_mid")
        study = tolerance_study(load_drive("paper"), samples=400, positions=28, quantities=kept)
    else:
        factors = {"clearance.bearing": {"low": 0.0, "high": 0.03, "levels": 3}, "load.direction": ["ccw", "cw"]}
        table = {"case": "CS-3", "design": {"kind": "grid"}, "factors": factors}
        study = parse_sweep(table, "paper")
    random = np.random.default_rng(1)
    values = {name: 1000.0 + random.normal(size=study.design.samples) for name in study.quantities}
    found = ranking(study, "standardised regression, SRC² added up over the elements of a field")
    for name, figure in study_figures(study, values, found, dict.fromkeys(study.quantities, 1000.0)):
        assert_words_stand_apart(figure)
        assert figure.get_figheight() * 130.0 < 2200.0, name


@pytest.mark.parametrize(
    "aims",
    [
        pytest.param(("ptp_transmission_error",), marks=pytest.mark.slow),
        ("ptp_transmission_error", "max_pin_pressure_mid"),
    ],
)
def test_words_of_optima_stand_apart(aims):
    """Limits made the title leave the canvas; angles were told in rad, lengths without a unit."""
    paths = ("disc.equidistant_offset", "disc.runout.angle", "crank.eccentricity_error")
    variables = tuple(Variable(path=path, low=0.01, high=0.02) for path in paths)
    limits = (parse_bound("max_pin_pressure_mid <= 1500 MPa"), parse_bound("min_backlash_wheel >= 8 arcmin"))
    problem = Problem(drive=load_drive("paper").cases["CS-1"], variables=variables, aims=aims, limits=limits)
    points = np.random.default_rng(1).uniform(0.01, 0.02, (40, 3))
    optimum = Optimum(
        problem=problem, variables=points, values=points, feasible=points[:, 0] > 0.012, best=0,
        front=np.arange(2), start=np.array([0.015, 0.015, 0.015]), generations=1,
    )  # fmt: skip
    with mpl.rc_context(STYLE):
        title = _title(optimum, 28)
        figure = _front(optimum, title) if len(aims) > 1 else _search(optimum, title)
    assert_words_stand_apart(figure)
    if len(aims) == 1:
        assert [axes.get_xlabel() for axes in figure.axes][:3] == [
            "disc.equidistant_offset [mm]",
            "disc.runout.angle [′]",
            "crank.eccentricity_error [mm]",
        ]


@pytest.mark.slow
@pytest.mark.parametrize("side", [300, 1100])
def test_words_of_finite_element_pictures_stand_apart(side):
    """Titles overlapped, and the scale of the colours stood on the field."""
    title = f"{LONG}, CS-1, 0.5 rad, disc 1\nvon Mises stress, largest 1234 MPa (logarithmic scale)"
    panels = [
        Panel(title=title, centre=12.3 + 80.2j, half_side=0.45, triangles=(), lines=(), label="von Mises stress [MPa]",
              limits=(2.0, 1234.0), logarithmic=logarithmic)
        for logarithmic in (True, False, True)
    ]  # fmt: skip
    with mpl.rc_context(STYLE):
        figure = compose(panels, side, lambda *given: None)
    assert_words_stand_apart(figure)


def test_the_window_on_a_mesh_leaves_out_what_is_empty():
    """Three quarters of the axis were empty, and the mesh of pin 0 was cut by the end of the turn."""
    from ltca.figures.mesh_range import elements_shown, loaded_window

    angle = np.arange(0.0, 360.0, 5.0)
    place = angle[:, None] - np.array([350.0, 120.0, 200.0])
    load = np.where(np.abs(place) < 40.0, 100.0, 0.0)[None]
    shown = elements_shown(angle, load, np.zeros(1, int))
    assert shown.tolist() == [1]
    low, high = loaded_window(angle, load[:, :, 1])
    assert 60.0 <= low <= 80.0
    assert 160.0 <= high <= 180.0


def test_ranks_of_chance_are_those_of_fields_without_influence():
    """Ranks of noise stood beside those that say something: of 20 studies without any influence, 19 have no rank beyond chance.

    One field of 20 exceeded its chance, so that nearly every study had one.
    """
    study = tolerance_study(load_drive("paper"), samples=1001, positions=28, quantities=("max_pin_load",))
    sizes = {name: columns.stop - columns.start for name, columns in study.design.groups}
    chance, random = chance_of(study, 0.0, 1001, np.ones(sum(sizes.values()))), np.random.default_rng(2)
    assert set(sizes.values()) >= {1, 8, 14}
    trials = 20_000
    some = np.zeros(trials, dtype=bool)
    for name, limit in chance.items():
        # The squares of k coefficients without influence, of variance 1/1000 each, which is taken off.
        some |= random.chisquare(sizes[name], trials) / 1000.0 - sizes[name] / 1000.0 > limit
    # 20000 trials know 5 % to 0.15 %; the variance is that of 1000 less some 150 elements, known to 2 %.
    assert 0.03 < some.mean() < 0.052
