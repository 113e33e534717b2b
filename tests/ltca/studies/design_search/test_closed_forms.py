"""Closed forms against laws, printed cases, and the loaded drive."""

import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.summary import summarise
from ltca.analysis.verdict.geometry import pin_hollow_margin, roller_gap, undercut_margin, walls
from ltca.analysis.verdict.values import find_values
from ltca.geometry.placement import position_angles
from ltca.studies.design_search.closed_forms import (
    Setting,
    closed_forms,
    disc_shares,
    flank_values,
    inner_values,
    lives_by_loads,
    shape_values,
    wheel_torque,
)
from ltca.studies.design_search.demands import find_demands, written_limits
from ltca.studies.design_search.enumeration import _different, enumerate_candidates, teeth
from ltca.studies.design_search.refinement import CONTINUOUS, _between, most_rollers
from ltca.studies.design_search.requirement_file import parse_requirements
from ltca.studies.design_search.search import rounded_safely
from ltca.studies.design_search.sizes import Sizes, drive_of, stack_length

STEEL = "\n[materials]\n" + "\n".join(
    f'{part} = "100Cr6"' for part in ("disc", "wheel_pin", "roller", "inner_race", "shaft_pin")
)
PAPER = """
discs = 1
held = "pin-shaft"
ratio = 14
torque = "377.3 N m"
speed = 107.14
outer_diameter = 190.0
length = 12.0
[shop]
equidistant_offset = 0.15
shifting_offset = 0.09
bearing_clearance = 0.0
pin_hole_clearance = 0.0
shaft_pin_stiffness = 1.0e6
"""
ROW = {
    "discs": 1.0, "pins": 14.0, "stage": 1.0, "sun": 0.0, "planet": 0.0, "eccentricity": 4.0, "pin_circle": 88.0,
    "pin_radius": 6.5, "thickness": 11.8, "bore": 29.5, "roller_radius": 5.0, "roller_length": 11.8, "rollers": 11.0,
    "holes": 8.0, "hole_circle": 56.0, "hole_pin": 10.075, "torque": 377_300.0, "equidistant_offset": 0.15,
    "shifting_offset": 0.09, "bearing_clearance": 0.0, "pin_hole_clearance": 0.0, "lead_crown_drop": 0.0,
}  # fmt: skip
WITHOUT_OFFSETS = {"equidistant_offset": 0.0, "shifting_offset": 0.0}


def forms(text=PAPER + STEEL, **changed):
    requirements = parse_requirements(text)
    return {
        name: float(value[0])
        for name, value in closed_forms(Sizes.of_rows([ROW | changed]), Setting.of(requirements)).items()
    }


@pytest.mark.parametrize(("changed"), [{}, {"eccentricity": 5.0}, {"pin_radius": 9.0, "bore": 25.0}])
def test_shapes_are_those_of_the_verdict(changed):
    """The verdict takes curvatures of the flank itself from 2001 places, closed forms from 33: a thousandth apart."""
    drive = drive_of(ROW | changed, parse_requirements(PAPER + STEEL))
    told = forms(**changed)
    assert told["undercut_margin"] == pytest.approx(undercut_margin(drive), rel=5e-3)
    assert told["pin_hollow_margin"] == pytest.approx(pin_hollow_margin(drive), rel=2e-2)
    assert told["roller_gap"] == pytest.approx(roller_gap(drive), rel=1e-12)
    named = dict(walls(drive))
    assert told["pin_gap"] == pytest.approx(named.pop("between neighbouring wheel pins"), rel=1e-12)
    # The paper's rollers leave nothing of the bore's own wall to judge here.
    assert told["wall"] == pytest.approx(min(wall for name, wall in named.items() if "hole" in name), rel=1e-9)


@pytest.mark.parametrize("gap", [0.0, 0.2, 1.0])
def test_the_cage_has_room_for_so_many_rollers_and_no_more(gap):
    """Chords between neighbours are a diameter and the gap, which is a part of it."""
    requirements = parse_requirements(PAPER + f"cage_gap = {gap}\n" + STEEL)
    most = most_rollers(ROW, SimpleNamespace(requirements=requirements))
    chord = [2.0 * (29.5 - 5.0) * np.sin(np.pi / count) for count in (most, most + 1)]
    assert chord[1] < 10.0 * (1.0 + gap) <= chord[0]


@pytest.mark.parametrize("discs", [2, 3])
def test_discs_of_a_design_stand_side_by_side(discs):
    """As many as are asked, the gap of the shop between neighbours, the stack in the middle of the pins."""
    text = PAPER.replace("discs = 1", f"discs = {discs}").replace("length = 12.0", "length = 60.0")
    requirements = parse_requirements(text + "disc_gap = 0.7\n" + STEEL)
    row = ROW | {"discs": float(discs)}
    disc = drive_of(row, requirements).disc
    planes = np.array(disc.disc_planes)
    assert disc.number_of_discs == planes.size == discs
    # 11.8 mm thick each
    np.testing.assert_allclose(np.diff(planes), 11.8 + 0.7, rtol=1e-12)
    np.testing.assert_allclose(planes, -planes[::-1], atol=1e-12)
    stack = stack_length(Sizes.of_rows([row]), requirements.asked.shop.disc_gap)
    assert np.ptp(planes) + 11.8 == pytest.approx(float(stack[0]), rel=1e-12)


@pytest.mark.parametrize(
    ("e", "pin", "R", "force"),
    [(2.8, 3.5, 64.00, 138.4), (2.9, 3.4, 66.29, 133.6), (3.0, 3.3, 68.57, 129.2)],
)
def test_loads_without_clearance_are_those_of_krol(e, pin, R, force):
    """Król et al., MMS 73 (2019), variants 1, 3, 4: F = 4 M/(z_C z_P e) of a disc moment of 23 250 N·mm, re-run from their code.

    Linear contacts give the same in the mean over the pitch, as Σ sin²φ/d² = z_P/(4 R²) says for many pins; of the four
    places in a pitch none need be the largest lever, which takes off less than 2 %.
    """
    text = PAPER.replace("ratio = 14", "ratio = 16")
    own = {"eccentricity": e, "pin_circle": R, "pin_radius": pin, "pins": 16.0, "torque": 23_250.0 * 16.0 / 15.0}
    told = forms(text + STEEL, **own, **WITHOUT_OFFSETS)
    assert told["pin_load"] == pytest.approx(force, rel=0.02)


def test_closed_forms_are_near_the_loaded_paper_drive():
    """What enumeration allows for (`OTHER_SLACK`, 0.4) has to be more than closed forms are wrong by."""
    drive = drive_of(ROW, parse_requirements(PAPER + STEEL))
    analysis = analyse(drive, position_angles(24) + 1e-3)
    loaded = {one.quantity: one.value for one in find_values(analysis, summarise(analysis), lives=False)}
    told = forms()
    for name in (
        "pin_pressure_mid",
        "pin_load",
        "pin_shaft_pressure_mid",
        "roller_pressure_mid_inner",
        "backlash_output",
    ):
        assert abs(np.log(told[name] / loaded[name])) < 0.25, name


@pytest.mark.parametrize("pin", [4.0, 6.5])
def test_pins_without_clearance_rub_off_what_the_pitch_point_says(pin):
    """4 μ M (R − r)/(π e z_P²) a radian of the crank: the disc turns at 1/z_P about the pitch point, d − r from the contact.

    F = 4 M l/(z_P (e z_P)²) with the lever l = e z_P R sin φ/d (Σ sin²φ/d² = z_P/(4 R²)), d² = R² + (e z_P)² − 2 R e z_P cos φ:
    ∫ l (d − r) dφ over half a turn is 2 e z_P (R − r); there are z_P/(2 π) pins to a radian.
    """
    text = PAPER + "[friction]\npin = 0.05\n" + STEEL
    setting = Setting.of(parse_requirements(text))
    told = float(flank_values(Sizes.of_rows([ROW | WITHOUT_OFFSETS | {"pin_radius": pin}]), setting)["flank_loss"][0])
    # sums over 56 places: the kinks of sin at both ends leave (2π/56)²/12, 0.1 %
    assert told == pytest.approx(4.0 * 0.05 * 377_300.0 * (88.0 - pin) / (np.pi * 4.0 * 14.0**2), rel=2e-3)


def test_what_bearings_and_seals_take_by_hand():
    """1/η − 1 is what is lost by a radian of the crank, by T/z_P: f F (r_i + r_BR), f r T/(e z_P), and i T₀/z_P."""
    whole = 377_300.0 / 14.0

    def lost(lines):
        told = forms(PAPER + f"[friction]\n{lines}\n" + STEEL)
        return 1.0 / told["mean_efficiency"] - 1.0, told["bearing_load"]

    part, force = lost("roller = 0.002")
    assert part == pytest.approx(0.002 * force * (29.5 - 10.0 + 5.0) / whole, rel=1e-9)
    part, _ = lost("support_bearing = 0.003\nsupport_bearing_radius = 12.0")
    assert part == pytest.approx(0.003 * 12.0 * whole / 4.0 / whole, rel=1e-9)
    part, _ = lost("no_load_torque = 60.0")
    assert part == pytest.approx(60.0 / whole, rel=1e-9)


def test_spare_lengths_are_counted_by_a_fiftieth_of_the_drive():
    for diameter in (190.0, 95.0):
        demands = find_demands(parse_requirements(PAPER.replace("190.0", f"{diameter}") + STEEL))
        assert {one.scale for one in demands} == {diameter / 50.0}
    (wall,) = [one for one in demands if one.name == "wall"]
    assert wall.margin(wall.value + 1.9) == pytest.approx(1.0, rel=1e-12)


def test_bearings_of_several_cranks_carry_most_where_both_forces_point_alike():
    """One goes round with the crank, the other stands: over a turn the largest is their sum, sampled every 30°."""
    text = PAPER.replace("discs = 1", 'kind = "rv"\ncranks = 3').replace("shaft_pin_stiffness = 1.0e6", "")
    text = text.replace("pin_hole_clearance = 0.0\n", "").replace('held = "pin-shaft"\n', "")
    row = ROW | {"stage": 1.0, "holes": 3.0, "discs": 2.0}
    without_shaft_pins = STEEL.replace('shaft_pin = "100Cr6"', "")
    sizes, setting = Sizes.of_rows([row]), Setting.of(parse_requirements(text + without_shaft_pins))
    radial = float(flank_values(sizes, setting)["radial"][0])
    told = inner_values(sizes, setting, flank_values(sizes, setting))
    torque = float(wheel_torque(sizes, setting)[0]) / 2.0
    standing = abs(complex(-radial, torque / (4.0 * 14.0))) / 3.0
    around = torque * 13.0 / 14.0 / (3.0 * 56.0)
    assert (standing + around) * np.cos(np.pi / 12.0) <= told["bearing_load"][0] <= standing + around
    # What rolls takes goes with the mean force by the power 10/3 over the whole turn.
    text += "[friction]\nroller = 0.002\n"
    sizes, setting = Sizes.of_rows([row]), Setting.of(parse_requirements(text + without_shaft_pins))
    lost = 1.0 / float(inner_values(sizes, setting, flank_values(sizes, setting))["mean_efficiency"][0]) - 1.0
    turn = np.exp(2j * np.pi * np.arange(720) / 720.0)
    force = np.abs(complex(-radial, torque / (4.0 * 14.0)) / 3.0 + around * turn)
    mean = np.mean(force ** (10.0 / 3.0)) ** 0.3
    assert lost * torque / 14.0 == pytest.approx(0.002 * 3.0 * mean * (29.5 - 10.0 + 5.0), rel=1e-3)


@pytest.mark.parametrize("discs", [2, 3])
def test_shares_of_discs_on_pins_tied_by_a_ring_that_turns_on(discs):
    """Pins clamped in the flange and guided at their tips, by virtual work: M(s) = (x − s)₊ − x²/2L of a unit force at x."""
    row = ROW | {"discs": float(discs), "thickness": 8.0}
    setting = Setting.of(parse_requirements(PAPER.replace("shaft_pin_stiffness = 1.0e6", "disc_gap = 1.0") + STEEL))
    sizes, alone, turned = Sizes.of_rows([row]), np.array([2e-10]), np.array([4e-4])
    span = float(stack_length(sizes, 1.0)[0]) + 2.0
    places = 0.5 * span + 9.0 * (np.arange(discs) - 0.5 * (discs - 1))
    s = span * (np.arange(20_000) + 0.5) / 20_000
    moments = np.array([np.maximum(x - s, 0.0) - x**2 / (2.0 * span) for x in places])
    rigidity = setting.pin_modulus * np.pi * (2.0 * 10.075) ** 4 / 64.0
    bent = moments @ moments.T * (span / 20_000) / rigidity
    torque = np.linalg.solve(bent * turned[0] + alone[0] * np.eye(discs), np.ones(discs))
    expected = discs * torque.min() / torque.sum()
    assert 0.05 < expected < 0.99
    assert disc_shares(sizes, setting, alone, turned)[0] == pytest.approx(expected, rel=1e-6)


def test_sizes_between_two_have_one_ratio_to_both():
    first, second = dict(ROW), ROW | {"pin_circle": 66.0, "thickness": 20.0, "bore": 29.5, "holes": 6.0}
    middle = _between(first, second)
    assert middle.keys() == ROW.keys()
    for name, value in middle.items():
        if name in CONTINUOUS:
            assert value / first[name] == pytest.approx(second[name] / value, rel=1e-12), name
        else:
            assert value == first[name], name
    assert {"pin_circle", "thickness", "bore"} <= set(CONTINUOUS)


@pytest.mark.parametrize("spring", [True, False])
def test_everything_twice_as_stiff_yields_half(spring):
    """All of it is elastic: with each modulus, the spring of the shaft pins where one is given, and the torque, which closes the
    same gaps then, it doubles."""
    found = []
    for factor in (1.0, 2.0):
        material = f"{{ youngs_modulus = {factor * 206e3}, poisson_ratio = 0.3 }}"
        parts = ("disc", "wheel_pin", "roller", "inner_race", "shaft_pin")
        text = PAPER.replace("1.0e6", f"{factor}e6") if spring else PAPER.replace("shaft_pin_stiffness = 1.0e6", "")
        text += "\n[materials]\n" + "\n".join(f"{part} = {material}" for part in parts)
        found.append(forms(text, torque=factor * 377_300.0)["stiffness"])
    assert found[1] == pytest.approx(2.0 * found[0], rel=1e-12)


def test_ratings_are_those_of_the_life_of_one_drive():
    from ltca.analysis.life.ratings import EDGE_ALLOWANCE, RollerBearing

    requirements = parse_requirements(PAPER + STEEL)
    bearing = RollerBearing.of_drive(drive_of(ROW, requirements))
    load = np.array([8000.0])
    told = lives_by_loads(Sizes.of_rows([ROW]), Setting.of(requirements), load, load)
    capacity = bearing.dynamic_load_rating / EDGE_ALLOWANCE
    assert told["bearing_life_million_turns"][0] == pytest.approx((capacity / 8000.0) ** (10.0 / 3.0), rel=1e-12)
    assert told["static_safety_S0"][0] == pytest.approx(bearing.static_load_rating / 8000.0, rel=1e-12)


@pytest.mark.slow
def test_what_is_kept_keeps_its_walls_and_comes_from_stock():
    requirements = parse_requirements(PAPER + STEEL)
    found = enumerate_candidates(requirements, find_demands(requirements))
    shape = shape_values(found.sizes, Setting.of(requirements))
    assert shape["wall"].min() >= 2.0 - 1e-9
    assert shape["outer_diameter"].max() <= 190.0 + 1e-9
    stock = {tuple(one) for one in requirements.stock.rollers}
    assert {
        (2.0 * r, long) for r, long in zip(found.sizes.roller_radius, found.sizes.roller_length, strict=True)
    } <= stock


def test_backlash_that_is_asked_is_judged_in_minutes_of_arc():
    requirements = parse_requirements(PAPER.replace("[shop]", 'backlash = "0.05 deg"\n[shop]') + STEEL)
    (demand,) = (one for one in find_demands(requirements) if one.quantity == "backlash_output")
    (limit,) = (one for one in written_limits(requirements).values() if one.quantity == "backlash_output")
    assert (demand.value, limit.value) == pytest.approx((3.0, 3.0), rel=1e-12)


@pytest.mark.parametrize("judged", [True, False])
def test_of_flanks_in_one_room_the_least_pressed_is_kept(judged):
    """Pins of different sizes that end at the same radius, for two eccentricities: whether a limit is set on pressure or none."""
    requirements = parse_requirements(PAPER + STEEL)
    demands = [one for one in find_demands(requirements) if judged or one.quantity != "pin_pressure_mid"]
    assert judged == any(one.quantity == "pin_pressure_mid" for one in demands)
    radii, eccentricities = [5.0, 6.5, 8.0, 5.0, 6.5, 8.0], [3.5] * 3 + [4.0] * 3
    sizes = Sizes.of_rows(
        [
            ROW | {"pin_radius": radius, "pin_circle": 94.5 - radius, "eccentricity": e}
            for radius, e in zip(radii, eccentricities, strict=True)
        ]
    )
    pressure = np.array([900.0, 700.0, 800.0, 650.0, 950.0, 1000.0])
    assert set(_different(sizes, {"pin_pressure_mid": pressure}, demands, ()).tolist()) == {1, 3}


def test_teeth_of_an_rv_reducer_give_its_ratio():
    asked = 'kind = "rv"\ndiscs = 2\nratio = 81\ntorque = 4e5\nspeed = 15.0\nouter_diameter = 160.0\nlength = 40.0\n'
    found = teeth(parse_requirements(asked))
    assert found
    assert all(1.0 + planet / sun * pins == pytest.approx(81.0, rel=1e-12) for pins, _, sun, planet in found)


def test_values_that_would_do_are_rounded_to_the_side_that_does():
    assert rounded_safely(71.35001, "max") == 71.36
    assert rounded_safely(71.3599, "min") == 71.35
    assert rounded_safely(71.35, "max") == 71.35


def test_a_wider_part_is_no_smaller_load():
    """Loads follow from levers alone: wheel pins of twice the size carry the same, and are pressed less."""
    small, large = forms(), forms(pin_radius=8.0)
    assert large["pin_load"] == pytest.approx(small["pin_load"], rel=1e-3)
    assert large["pin_pressure_mid"] < small["pin_pressure_mid"]


@pytest.mark.slow
def test_a_life_that_gives_way_is_known_all_the_same(monkeypatch):
    """A design was told to fit whose life nobody had asked: what is not known has given everything, never nothing."""
    from ltca.studies.design_search import refinement
    from ltca.studies.design_search.refinement import Task, finish

    monkeypatch.setattr(refinement, "MAX_FINE_SOLUTIONS", {"half-space": 1})
    requirements = parse_requirements(PAPER.replace("[shop]", "life = 1.0e9\n[shop]") + STEEL)
    demands = find_demands(requirements)
    found = finish(Task(requirements=requirements, demands=demands, row=ROW | {"pin_circle": 88.4}, relaxed=("life",)))
    assert found.solution.values["bearing_life_hours"] > 0.0
    assert found.given == pytest.approx(np.log(1e9 / found.solution.values["bearing_life_hours"]), rel=1e-9)


def test_a_soft_bore_is_demanded_by_its_own_limit():
    """The 4000 MPa of a limit on all races stood in the search before the 73 MPa of a plastic bore, which `check` judges by."""
    plastic = STEEL.replace('disc = "100Cr6"', 'disc = "printed PETG"')
    limits = "\n[limits]\nmax_roller_pressure_mid = 4000.0\nmax_pin_pressure_mid = 100.0\n"
    demands = {one.quantity: one.value for one in find_demands(parse_requirements(PAPER + plastic + limits))}
    assert demands["roller_pressure_mid_outer"] == 73.0
    assert demands["roller_pressure_mid_inner"] == 4000.0
    assert demands["pin_pressure_mid"] == pytest.approx(1.67 * 44.0)  # first yield, which no limit of a file replaces
    assert not {"disc_shear", "contact_strain"} & set(demands)


def test_rules_of_what_can_be_made_are_attributed_to_no_standard():
    """Bounds from memory were told as those of ISO 281, ISO 8734 and DIN 5402-3, which nobody had looked up."""
    root = Path(__file__).parents[4]
    rules = (root / "docs" / "how-to" / "design.md").read_text(encoding="utf-8").split("**What can be made.**")[1]
    stock = (root / "ltca" / "studies" / "design_search" / "stock_sizes.toml").read_text(encoding="utf-8")
    for text in (rules.split("**The best few differ.**")[0], stock):
        assert "typical" in text.lower()
        assert not re.search(r"\b(ISO|DIN)\b", text)


@pytest.mark.slow
def test_what_is_enumerated_can_be_made():
    """Cage, rollers by the pitch circle, pins by their circle and length, walls: of every candidate."""
    requirements = parse_requirements(PAPER.replace("discs = 1", "discs = [1, 2]").replace("12.0", "24.0") + STEEL)
    found = enumerate_candidates(requirements, find_demands(requirements), most=20).sizes
    pitch = 2.0 * (found.bore - found.roller_radius)
    assert (2.0 * found.roller_radius / pitch).max() <= 0.3 + 1e-9
    bars = pitch * np.sin(np.pi / found.rollers) - 2.0 * found.roller_radius
    assert bars.min() >= 0.4 - 1e-9  # mm, `least_cage_bar`
    spacing = found.pin_circle * np.sin(np.pi / found.pins) / found.pin_radius
    assert 1.0 < spacing.min() <= spacing.max() <= 4.5 + 1e-9
    assert (stack_length(found, 1.0) / (2.0 * found.pin_radius)).max() <= 10.0 + 1e-9


def test_a_clearance_with_a_range_is_made_as_loose_as_costs_nothing():
    """Nothing asks for less play in holes and bearing: on closed forms they come to their most, the flank where loads want it."""
    from ltca.studies.design_search.refinement import Task, _actual, _improve
    from ltca.studies.design_search.solution import Solution

    text = PAPER.replace("bearing_clearance = 0.0", "bearing_clearance = [0.002, 0.005]")
    requirements = parse_requirements(
        text.replace("pin_hole_clearance = 0.0", "pin_hole_clearance = [0.01, 0.02]") + STEEL
    )
    row = ROW | {"bearing_clearance": 0.002, "pin_hole_clearance": 0.01}
    task = Task(requirements=requirements, demands=find_demands(requirements), row=row)
    values = closed_forms(Sizes.of_rows([row]), Setting.of(requirements))
    moved = row
    for _ in range(2):  # a step is half of the most
        solution = Solution(values={name: float(value[0]) for name, value in values.items()})
        moved = _improve(moved, _actual(solution, task), task)
        values = closed_forms(Sizes.of_rows([moved]), Setting.of(requirements))
    assert (moved["bearing_clearance"], moved["pin_hole_clearance"]) == pytest.approx((0.005, 0.02), rel=1e-3)
    assert moved["equidistant_offset"] == 0.15  # held
