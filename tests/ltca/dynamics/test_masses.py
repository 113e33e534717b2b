"""Masses, unbalance and inertias against closed forms and sums by hand."""

from __future__ import annotations

import json
from math import pi

import numpy as np
import pytest
from refusals import refused_field
from scipy.integrate import quad

from ltca.analysis.mass_values import mass_rows, mass_values
from ltca.commands.program import main
from ltca.drive.members.named_materials import named_material
from ltca.drive.units.quantities import parse_quantity
from ltca.dynamics.kinetics import reflected_inertia
from ltca.dynamics.masses import (
    CRANKS,
    DISCS,
    INERTIA,
    ROLLERS,
    WHEEL_PINS,
    circle_section,
    drive_masses,
    flank_section,
    moved_section,
    section_within,
)
from ltca.geometry.flank import FlankProfile
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive

PAPER = load_drive("paper").cases["CS-1"]
JOINT = load_drive("robot-joint").cases["nominal"]
STEEL = named_material("100Cr6").density
ROUND_OFF = 1e-12


def test_a_section_inside_a_circle_off_centre():
    """Moments of a disc by the parallel-axis theorem."""
    radius, centre = 3.0, 2.0 - 5.0j
    angle = 2.0 * pi * np.arange(64) / 64
    points = centre + radius * np.exp(1j * angle)
    found = section_within(points, 1j * radius * np.exp(1j * angle) * 2.0 * pi / 64)
    area = pi * radius**2
    moments = area * np.array([1.0, centre, abs(centre) ** 2 + radius**2 / 2.0, centre**2])
    np.testing.assert_allclose(found, moments, rtol=ROUND_OFF)
    np.testing.assert_allclose(moved_section(circle_section(radius), centre), moments, rtol=ROUND_OFF)


@pytest.mark.parametrize("name", ["paper", "robot-joint"])
def test_the_area_of_a_flank_is_that_of_the_parallel_of_its_trochoid(name):
    """A − d L + π d² inside a trochoid of area π (R² − u e²)… of c = R e^{iθ} − e e^{iuθ}: ½∮Im(c̄ dc) = π (R² + u e²)."""
    drive = next(iter(load_drive(name).cases.values()))
    profile = FlankProfile.of_drive(
        drive if drive.disc.number_of_discs == 1 else with_fields(drive, {"disc.number_of_discs": 1})
    )
    radius, e, u, offset = profile.generating_radius, profile.eccentricity, profile.reduction_ratio, profile.offset
    pitch = 2.0 * pi / (u - 1.0)
    length = (u - 1.0) * quad(
        lambda t: abs(1j * radius * np.exp(1j * t) - 1j * u * e * np.exp(1j * u * t)), 0.0, pitch, epsrel=1e-12
    )[0]
    area = pi * (radius**2 + u * e**2) - offset * length + pi * offset**2
    assert flank_section(profile)[0].real == pytest.approx(area, rel=1e-11)  # quad's own error


def test_a_lead_is_integrated_along_the_width():
    """A parabolic crown c takes c/3 of the area of the flank by its length: ∫(2z/b)² dz = b/3; to first order of c/r."""
    crown = 1e-3
    crowned = with_fields(JOINT, {"contact.slices": 3, "disc.lead_crown_drop": crown})
    lost = drive_masses(JOINT).of(DISCS)[0].volume - drive_masses(crowned).of(DISCS)[0].volume
    profile = FlankProfile.of_drive(with_fields(JOINT, {"disc.number_of_discs": 1}))
    theta = np.linspace(0.0, 2.0 * pi, 20_000, endpoint=False)
    length = float(np.mean(np.abs(profile.flank_tangent(theta))) * 2.0 * pi)
    assert lost == pytest.approx(length * crown / 3.0 * JOINT.disc.thickness, rel=1e-3)  # c by the radius of a root


def test_round_parts_are_cylinders():
    pins, rollers = drive_masses(PAPER).of(WHEEL_PINS), drive_masses(PAPER).of(ROLLERS)
    volume = pi * 6.5**2 * 11.8
    assert len(pins) == 14
    assert pins[3].mass == pytest.approx(STEEL * 1e-12 * volume, rel=ROUND_OFF)
    assert pins[3].about_own_axis == pytest.approx(
        0.5 * pins[3].mass * 6.5**2, rel=1e-10
    )  # differences of squares of places
    across = pins[3].mass * (3.0 * 6.5**2 + 11.8**2) / 12.0
    assert pins[3].inertia[0, 0] == pytest.approx(across, rel=1e-10)
    assert abs(pins[3].inertia[0, 1]) < 1e-10 * across
    assert sum(roller.volume for roller in rollers) == pytest.approx(11 * pi * 5.0**2 * 11.8, rel=ROUND_OFF)


def test_warmth_changes_no_mass():
    warm = with_fields(PAPER, {"temperature.disc": 90.0, "temperature.shaft": 60.0, "temperature.housing": 40.0})
    assert drive_masses(warm).total == drive_masses(PAPER).total


def test_two_discs_half_a_turn_apart_leave_a_couple():
    found, one = drive_masses(JOINT).unbalance, drive_masses(with_fields(JOINT, {"disc.number_of_discs": 1})).unbalance
    assert abs(found.static) < 1e-12 * abs(one.static)
    # 5.5 mm on either side of the middle.
    assert found.couple == pytest.approx(-11.0 * one.static, rel=1e-10)
    masses = drive_masses(JOINT)
    each = [masses.mass_of(group) / 2.0 for group in (DISCS, ROLLERS, CRANKS)]
    assert abs(one.static) == pytest.approx(sum(each) * JOINT.crank.eccentricity, rel=1e-10)


def test_inertia_at_input_and_output_by_hand():
    """The paper's drive, pin shaft held: the crank with its eccentric, the disc on its circle, rollers that orbit and roll, and
    the pins of the wheel at 1/14 of the speed.
    """
    masses = drive_masses(PAPER)
    disc, rollers, e = masses.mass_of(DISCS), masses.mass_of(ROLLERS), 4.0
    cage = 19.5 / (19.5 + 29.5)
    # Rollers on their circle of 24.5 mm at the speed of the cage, rolling: 3/2 of its energy.
    turning = rollers * 1.5 * (cage * 24.5) ** 2
    crank = 0.5 * masses.mass_of(CRANKS) * 19.5**2 + masses.mass_of(CRANKS) * e**2
    wheel = sum(pin.about_own_axis + pin.mass * 88.0**2 for pin in masses.of(WHEEL_PINS))
    by_hand = crank + (disc + rollers) * e**2 + turning + wheel / 14.0**2
    found = reflected_inertia(PAPER)
    assert found.at_input == pytest.approx(by_hand, rel=1e-9)
    assert found.at_output == pytest.approx(14.0**2 * by_hand, rel=1e-9)
    given = reflected_inertia(with_fields(PAPER, {"inertia.crank": "1 kg cm²", "inertia.output": 0.5}))
    assert given.at_input == pytest.approx(by_hand - crank + 1e-4 * INERTIA, rel=1e-9)
    assert given.given_output == 0.5 * INERTIA


def test_with_the_wheel_held_the_carrier_turns():
    """Relative to the wheel the same parts move: the crank turns by 13/14 of its speed in the frame of the shaft, discs and
    cranks go round with the shaft at 1/14 backward.
    """
    held = with_fields(PAPER, {"installation.held": "pin-wheel"})
    masses, e, u = drive_masses(held), 4.0, 14.0
    disc, rollers = masses.mass_of(DISCS), masses.mass_of(ROLLERS)
    cage = 19.5 / 49.0
    own = 0.5 * masses.mass_of(CRANKS) * 19.5**2 + masses.of(CRANKS)[0].mass * e**2
    shaft = sum(pin.about_own_axis + pin.mass * 56.0**2 for pin in masses.of("shaft pins"))
    centre = (disc + rollers) * e**2 * (1.0 - 1.0 / u) ** 2
    orbit, spin = rollers * 24.5**2 * (cage - 1.0 / u) ** 2, 0.5 * rollers * 25.0 * (cage * 24.5 / 5.0 + 1.0 / u) ** 2
    turning = masses.of(DISCS)[0].about_own_axis / u**2
    by_hand = own * (1.0 - 1.0 / u) ** 2 + centre + orbit + spin + turning + shaft / u**2
    found = reflected_inertia(held)
    assert found.at_input * (1.0 - 1.0 / u) ** 2 == pytest.approx(by_hand, rel=1e-9)
    assert found.at_output == pytest.approx(13.0**2 * found.at_input, rel=1e-12)


def test_what_is_not_given_is_told_and_nothing_is_made_up():
    bare = with_fields(PAPER, {"materials.roller.density": None})
    values = mass_values(bare)
    assert values["disc_mass"] == mass_values(PAPER)["disc_mass"]
    assert all(np.isnan(values[name]) for name in ("mass", "static_unbalance", "reflected_inertia_input"))
    assert dict(mass_rows(bare))["masses left out, densities not given"] == "materials.roller.density"


def test_a_given_crank_needs_no_density():
    bare = {"materials.inner_race.density": None}
    assert reflected_inertia(with_fields(PAPER, bare)) is None
    given = with_fields(PAPER, {**bare, "inertia.crank": 1e-4, "inertia.crank_mass": "0.4 kg"})
    assert reflected_inertia(given) is not None
    assert drive_masses(given).mass_of(CRANKS) == pytest.approx(4e-4)


def test_eccentrics_have_the_density_of_the_crankshaft():
    light = with_fields(PAPER, {"materials.crankshaft.density": "2.8 g/cm³"})
    assert drive_masses(light).mass_of(CRANKS) == pytest.approx(2800e-12 * pi * 19.5**2 * 11.8, rel=ROUND_OFF)
    with refused_field("materials.crankshaft", "", "must be left out without crank.support", "density"):
        with_fields(PAPER, {"materials.crankshaft.youngs_modulus": 2e5})


def test_units():
    assert parse_quantity("1 kg·cm²", "kg·m²", "x") == 1e-4
    assert parse_quantity("5 g cm2", "kg·m²", "x") == 5e-7
    assert parse_quantity("250 g", "kg", "x") == 0.25


@pytest.mark.slow
def test_masses_are_shown_and_in_the_summary(tmp_path, capsys):
    assert main(["show", "robot-joint", "--out", str(tmp_path / "show")]) == 0
    shown = capsys.readouterr().out
    assert "mass of discs" in shown
    one = drive_masses(with_fields(JOINT, {"disc.number_of_discs": 1})).unbalance
    assert f"0 g·mm; couple {11.0 * 1e6 * abs(one.static):.5g} g·mm² at 180°" in shown
    run = ["run", "robot-joint", "--quick", "--positions", "4", "--out", str(tmp_path / "run"), "--no-figures"]
    assert main(run) in (0, 1)
    summary = json.loads((tmp_path / "run" / "summary.json").read_text(encoding="utf-8"))
    values = mass_values(JOINT)
    (case,) = summary["cases"].values()
    assert case["reflected_inertia_input_kg_m2"] == values["reflected_inertia_input"]
    assert "inertia of the drive referred to the output" in (tmp_path / "run" / "report.html").read_text(
        encoding="utf-8"
    )
