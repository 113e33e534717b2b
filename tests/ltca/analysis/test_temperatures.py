"""Drives at their temperatures: similar drives carry alike, places are those of warm parts, plays that are lost are told."""

from __future__ import annotations

import argparse
from dataclasses import replace

import numpy as np
import pytest
from refusals import refused_field

import ltca
import ltca.compliance.coefficient_files
from ltca.analysis.engines import PlaneStrain
from ltca.analysis.loaded_analysis import analyse
from ltca.commands.compliance_arguments import find_coefficients_of
from ltca.drive.materials import elastic_alone
from ltca.drive.members.temperatures import growth_of, warm_drive
from ltca.drive.parts import Material, Temperature
from ltca.drive.single_discs import single_discs
from ltca.errors import DriveError
from ltca.geometry.coordinates import WHEEL_ANGLE
from ltca.geometry.first_contact import backlash
from ltca.geometry.flank import FlankProfile
from ltca.geometry.pairs import ContactGeometry
from ltca.geometry.placement import Placement
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive, parse_drive, shipped_drive
from ltca.reading.writing import drive_text
from ltca.studies.batch_analysis import BatchSettings, analyse_samples

PARTS = ("disc", "wheel_pin", "roller", "inner_race", "shaft_pin")
STEEL = 1.15e-5
EXPANSION = {f"materials.{part}.thermal_expansion": STEEL for part in PARTS}
PAPER = load_drive("paper").cases["CS-3"]
ANGLE = np.array([0.5, 3.1])
DEVIATIONS = {
    "pin_wheel.pin_errors.radial.2": 0.004,
    "pin_wheel.pin_errors.diameter.5": 0.002,
    "pin_shaft.pin_errors.tangential.1": 0.003,
    "disc.hole_errors.radial.0": -0.005,
    "disc.runout.amount": 0.004,
    "disc.profile_errors.cosine": (0.001, 0.0, 0.0005, 0.0),
    "crank_bearing.roller_errors.diameter.3": -0.001,
    "crank.eccentricity_error": 0.003,
    "crank.axis_offset.x": 0.002,
    "pin_wheel.axis_offset.y": -0.003,
}


def warmth(housing, disc, shaft):
    return {"temperature.housing": housing, "temperature.disc": disc, "temperature.shaft": shaft}


def geared(backlash, shaft):
    """Aluminium carrier on steel cranks, 42 mm apart; no expansion of discs or bearings counts at 20 °C."""
    given = {"first_stage.sun_teeth": 20, "first_stage.planet_teeth": 40, "first_stage.plane": 40.0}
    given |= {f"materials.{part}.thermal_expansion": STEEL for part in ("disc", "wheel_pin", "roller", "inner_race")}
    given |= {"materials.crankshaft.thermal_expansion": STEEL, "materials.carrier.thermal_expansion": 2.36e-5}
    return with_fields(shipped("rv"), given | {"first_stage.backlash": backlash} | warmth(20.0, 20.0, shaft))


@pytest.mark.parametrize("shaft", [70.0, -10.0])
def test_backlash_of_the_first_stage_follows_the_distance_of_its_axes(shaft):
    """Involutes: at the distance a + Δa the arc of the pitch circle between flanks is p − s₁ − s₂, by the involute function.

    It stayed that of 20 °C: an aluminium carrier takes two thirds of 0.03 mm between 20 and −30 °C.
    """
    warm = warm_drive(geared(0.03, shaft)).first_stage
    teeth = 1.0 + STEEL * (shaft - 20.0)
    distance = 42.0 * (1.0 + 2.36e-5 * (shaft - 20.0))
    base = 42.0 * teeth * np.cos(np.pi / 9.0)
    working = np.arccos(base / distance)
    involute = [np.tan(angle) - angle for angle in (working, np.pi / 9.0)]
    by_hand = distance / (42.0 * teeth) * 0.03 * teeth + 2.0 * distance * (involute[0] - involute[1])
    # of second order: the working angle changes by Δa/(a tan α) = 1.7e-3, and its slope by that over tan α
    assert warm.backlash == pytest.approx(by_hand, rel=0.0, abs=5e-3 * abs(by_hand - 0.03))


def test_teeth_that_jam_in_the_cold_are_refused_by_name():
    """They need 2 tan 20° · 42 mm · 1.21e-5/K · 60 K = 22 µm."""
    with refused_field(
        "first_stage.backlash", "= 0.02 mm", "by which teeth close", bound=("at least", pytest.approx(0.0222, rel=2e-3))
    ):
        warm_drive(geared(0.02, -40.0))


def shipped(name):
    return parse_drive(shipped_drive(name), name).cases["nominal"]


def expansion_of(drive):
    """The expansion of steel for every part of a drive."""
    parts = [part for part in PARTS if part != "shaft_pin" or drive.pin_shaft is not None]
    parts += ["wheel_seat"] * (drive.pin_wheel.seat.kind == "slot")
    parts += ["sleeve"] * (drive.pin_shaft is not None and drive.pin_shaft.seat.kind == "sleeve")
    parts += ["crankshaft"] * (drive.crank.support is not None)
    return {f"materials.{part}.thermal_expansion": STEEL for part in parts}


def stiffer(drive, factor):
    """Stiffnesses that are given as numbers, as those of a drive that is larger by a factor."""
    found = {}
    if drive.pin_shaft is not None and drive.pin_shaft.stiffness is not None:
        found["pin_shaft.stiffness"] = drive.pin_shaft.stiffness * factor
    if drive.crank.support is not None:
        found["crank.support.stiffness"] = tuple(value * factor for value in drive.crank.support.stiffness)
    return found


@pytest.mark.slow
@pytest.mark.parametrize(
    "drive", [with_fields(PAPER, DEVIATIONS), shipped("rv"), shipped("sleeved")], ids=["paper", "rv", "sleeved"]
)
def test_a_drive_of_one_material_at_one_temperature_is_a_similar_drive(drive):
    """Linear elasticity knows no size: with k³ of the torque and k of the given stiffnesses, loads are k² and pressures the same.

    Tolerance: balance ends at 1e-9 of the loads; a factor k forgotten on any length of a micrometre shows as 1e-3.
    """
    growth = 1.0 + STEEL * 180.0
    hot = with_fields(
        drive,
        expansion_of(drive)
        | warmth(200.0, 200.0, 200.0)
        | stiffer(drive, growth)
        | {"load.torque": drive.load.torque * growth**3, "load.light_torque": drive.load.light_torque * growth**3},
    )
    cold, warm = analyse(drive, ANGLE), analyse(hot, ANGLE)
    for of_cold, of_warm in (
        (cold.full.response.pin_load, warm.full.response.pin_load),
        (cold.full.response.hole_load, warm.full.response.hole_load),
        (cold.full.response.rollers.outer_load, warm.full.response.rollers.outer_load),
    ):
        np.testing.assert_allclose(
            of_warm / growth**2, of_cold, rtol=0.0, atol=1e-6 * cold.full.response.pin_load.max()
        )
    np.testing.assert_allclose(warm.pressures.pins.mid, cold.pressures.pins.mid, rtol=1e-6, atol=1e-3)
    # Angles have no size.
    np.testing.assert_allclose(
        warm.full.pose[:, WHEEL_ANGLE],
        cold.full.pose[:, WHEEL_ANGLE],
        atol=1e-7 * abs(cold.full.pose[:, WHEEL_ANGLE]).max(),
    )


def test_the_flank_of_a_warm_disc_is_that_of_the_cold_one_larger():
    """Exact: the parts of Eq. 1 grow by one factor; what is left is the rounding of sums of a hundred millimetres."""
    hot = with_fields(PAPER, EXPANSION | warmth(35.0, 95.0, 60.0) | {"disc.profile_errors.cosine": (0.01, 0, 0, 0)})
    theta = np.linspace(0.0, 2.0 * np.pi, 1001)
    cold = FlankProfile.of_drive(replace(hot, temperature=None)).flank(theta)
    warm = FlankProfile.of_drive(warm_drive(hot)).flank(theta)
    np.testing.assert_allclose(warm, (1.0 + STEEL * 75.0) * cold, rtol=0.0, atol=1e-12)


def test_places_are_those_of_the_warm_parts():
    """Pins on the circle of the housing, holes on that of the disc, shaft pins on that of the shaft, the crank by its own."""
    expansion = {f"materials.{part}.thermal_expansion": (n + 1) * 1e-5 for n, part in enumerate(PARTS)}
    hot = with_fields(
        PAPER, expansion | warmth(40.0, 80.0, 60.0) | {"materials.wheel_seat.thermal_expansion": 2.4e-5} | DEVIATIONS
    )
    cold, warm = Placement.of_drive(replace(hot, temperature=None)), Placement.of_drive(warm_drive(hot))
    housing, disc, shaft = 1.0 + 2.4e-5 * 20.0, 1.0 + 1e-5 * 60.0, 1.0 + 5e-5 * 40.0
    eccentric, roller = 1.0 + 4e-5 * 40.0, 1.0 + 3e-5 * 50.0
    close = {"rtol": 0.0, "atol": 1e-12}
    np.testing.assert_allclose(warm.wheel_pin_centres, cold.wheel_pin_centres * housing, **close)
    np.testing.assert_allclose(warm.wheel_pin_radii, cold.wheel_pin_radii * (1.0 + 2e-5 * 20.0), **close)
    np.testing.assert_allclose(warm.hole_centres, cold.hole_centres * disc, **close)
    np.testing.assert_allclose(warm.hole_radii, cold.hole_radii * disc, **close)
    np.testing.assert_allclose(warm.shaft_pin_centres, cold.shaft_pin_centres * shaft, **close)
    np.testing.assert_allclose(warm.shaft_pin_radii, cold.shaft_pin_radii * shaft, **close)
    np.testing.assert_allclose(warm.mean_eccentricity, cold.mean_eccentricity * eccentric, **close)
    np.testing.assert_allclose(warm.roller_radii, cold.roller_radii * roller, **close)
    bearing = warm_drive(hot).crank_bearing
    assert bearing.inner_race_radius == pytest.approx(19.5 * eccentric, abs=1e-12)
    assert warm_drive(hot).bore_radius == pytest.approx(hot.bore_radius * disc, abs=1e-12)


def test_bores_and_cranks_stand_on_circles_of_their_own():
    drive = shipped("rv")
    hot = with_fields(drive, expansion_of(drive) | warmth(20.0, 90.0, 50.0) | {"disc.of.1.bore_errors.radial.0": 0.004})
    for number, single in enumerate(single_discs(warm_drive(hot))):
        place, crank = Placement.of_drive(single), single.crank
        bores = np.full(3, 42.0)
        bores[0] += 0.004 * number
        np.testing.assert_allclose(np.abs(place.bore_centres), bores * (1.0 + STEEL * 70.0), rtol=0.0, atol=1e-12)
        np.testing.assert_allclose(np.abs(crank.places), 42.0 * (1.0 + STEEL * 30.0), rtol=0.0, atol=1e-12)


def test_backlash_changes_by_the_gaps_of_the_warm_parts():
    """With disc and crank alike, gap i is Δr′ − ΔR′ cos ψ and its lever R sin ψ; the pin of the least ratio on each side ends it.

    Δr′, ΔR′ are those of the warm radii. To first order in the gaps: these are up to 0.04 mm beside radii of curvature of some
    6 mm and more, so that half a per cent is left out.
    """
    thin = {"disc.equidistant_offset": 0.03, "disc.shifting_offset": 0.02}
    hot = with_fields(PAPER, EXPANSION | warmth(40.0, 30.0, 30.0) | thin)
    angle = np.array([0.3, 1.1, 2.0])

    def expected(disc, housing):
        offset = (6.5 + 0.03) * disc - 6.5 * housing
        shift = (88.0 + 0.02) * disc - 88.0 * housing
        pitch = 4.0 * disc * 14
        found = []
        for crank in angle:
            pin = 2.0 * np.pi * np.arange(14) / 14 + crank / 14 - crank  # of the turning wheel, from the eccentric
            centre = 88.0 * housing * np.exp(1j * pin)
            normal = pitch - centre  # through the pitch point, where the eccentric points
            lever = (np.conj(centre) * normal).imag / np.abs(normal)
            gap = offset - shift * np.sqrt(1.0 - (lever / (88.0 * housing)) ** 2)
            found.append(min(gap[lever > 1.0] / lever[lever > 1.0]) + min(gap[lever < -1.0] / -lever[lever < -1.0]))
        return np.array(found)

    def of(drive):
        return backlash([ContactGeometry.of_drive(drive)], angle, WHEEL_ANGLE)

    # Without the bearing's clearance, which the formula does not know.
    hot = replace(hot, clearance=replace(hot.clearance, bearing=0.0))
    cold_found, warm_found = of(replace(hot, temperature=None)), of(warm_drive(hot))
    cold, warm = expected(1.0, 1.0), expected(1.0 + STEEL * 10.0, 1.0 + STEEL * 20.0)
    np.testing.assert_allclose(cold_found, cold, rtol=0.005)
    np.testing.assert_allclose(warm_found, warm, rtol=0.005)
    assert np.all(np.abs(warm / cold - 1.0) > 0.1)  # the change is twenty times what the formula leaves out


def test_temperatures_of_20_degrees_change_no_bit():
    plain, held = PAPER, with_fields(PAPER, warmth(20.0, 20.0, 20.0))
    assert warm_drive(plain) is plain
    assert warm_drive(held) == plain
    cold, warm = analyse(plain, ANGLE), analyse(held, ANGLE)
    assert np.array_equal(cold.full.pose, warm.full.pose)
    assert np.array_equal(cold.full.response.pin_load, warm.full.response.pin_load)
    assert plain.fingerprint() == warm_drive(held).fingerprint()


def test_what_is_needed_and_missing_is_named():
    plain = replace(PAPER, materials=elastic_alone(PAPER.materials))
    with pytest.raises(DriveError) as error:
        with_fields(plain, {"temperature.disc": 50.0})
    told = str(error.value)
    assert "materials.disc.thermal_expansion: is missing; temperature.disc = 50 °C" in told
    assert "materials.roller.thermal_expansion" in told
    assert "wheel_pin" not in told  # whose part is at 20 °C
    with refused_field("materials.wheel_pin.thermal_expansion", "", "is missing; temperature.housing"):
        with_fields(plain, {"temperature.housing": 50.0})


def test_the_housing_expands_as_its_own_material_where_that_is_said():
    """Fixed pins of steel in a housing of aluminium: the circle by the one, the pins by the other."""
    given = EXPANSION | warmth(60.0, 20.0, 20.0)
    aluminium = with_fields(PAPER, given | {"materials.wheel_seat": "aluminium 7075"})
    found = growth_of(aluminium)
    assert found.wheel == pytest.approx(1.0 + 23.6e-6 * 40.0, abs=1e-15)
    assert found.wheel_pin == pytest.approx(1.0 + STEEL * 40.0, abs=1e-15)
    assert warm_drive(aluminium).materials.wheel_seat == Material()
    with refused_field("materials.wheel_seat", "", "must be left out without slots"):
        with_fields(PAPER, {"materials.wheel_seat": "aluminium 7075"})


def test_a_hot_plastic_disc_seizes_in_a_housing_of_steel():
    """88.09 mm · 1.1e-4/K · 80 K = 0.78 mm of growth in a clearance of 0.06 mm."""
    plastic = EXPANSION | {"materials.disc.thermal_expansion": 1.1e-4, "materials.disc.youngs_modulus": 1600.0}
    with pytest.raises(DriveError) as error:
        with_fields(PAPER, plastic | warmth(20.0, 100.0, 20.0))
    told = str(error.value)
    assert "temperature: housing 20 °C, disc 100 °C, shaft 20 °C: the drive seizes" in told
    assert "the play of wheel pins and flank (0.06 mm at 20 °C) is gone" in told
    # the tip of the lobe opposite the eccentric, whose own e does not grow with the disc
    overlap = 88.09 * 1.0088 - 88.0 - (6.65 * 1.0088 - 6.5) + 4.0 * 0.0088
    assert f"they overlap by {overlap:.4g} mm" in told
    with_fields(PAPER, plastic | warmth(20.0, 25.0, 20.0))  # warm is no more than warm


def test_play_that_is_gone_is_warned_of():
    """Holes that fit without play jam as soon as their circle leaves that of the pins, and the parts yield."""
    hot = with_fields(PAPER, EXPANSION | warmth(20.0, 60.0, 70.0))
    (told,) = [warning for warning in analyse(hot, ANGLE).warnings if "is gone" in warning]
    assert told.startswith("at housing 20 °C, disc 60 °C, shaft 70 °C the play of shaft pins and holes (0 mm at 20 °C)")
    even = with_fields(PAPER, EXPANSION | warmth(60.0, 60.0, 60.0))
    assert not [warning for warning in analyse(even, ANGLE).warnings if "is gone" in warning]


def test_no_geometry_is_made_of_lengths_that_are_not_warm_yet():
    hot = with_fields(PAPER, EXPANSION | warmth(20.0, 60.0, 60.0))
    for made in (FlankProfile.of_drive, Placement.of_drive, ContactGeometry.of_drive, type(hot).shape_fingerprint):
        with pytest.raises(DriveError, match="warm the drive first"):
            made(hot)


@pytest.mark.slow
def test_studies_vary_what_is_written_and_solve_what_is_warm():
    """A sample is the drive as written with a field replaced, as warm as it is: the same as that drive analysed by itself."""
    hot = with_fields(PAPER, EXPANSION | warmth(20.0, 45.0, 60.0))
    samples = [with_fields(hot, {"disc.equidistant_offset": 0.16}), with_fields(hot, {"temperature.disc": 55.0})]
    settings = BatchSettings(crank_angle=ANGLE, quantities=("max_pin_load",))
    found = analyse_samples(samples, settings)
    assert found.messages == ("", "")
    for sample, (load,) in zip(samples, found.values, strict=True):
        alone = analyse(sample, ANGLE)
        assert load == pytest.approx(alone.full.response.pin_load.max(), rel=1e-7)
    cold = analyse(PAPER, ANGLE).full.response.pin_load.max()
    assert np.all(np.abs(found.values / cold - 1.0) > 1e-3)


def test_what_is_written_stays_with_the_results():
    hot = with_fields(PAPER, EXPANSION | warmth(20.0, 45.0, 60.0))
    assert parse_drive(drive_text(hot)).cases["nominal"] == hot
    result = ltca.analyse(hot, crank_angle=[0.5])
    assert parse_drive(result.dataset.attrs["drive_file"]).cases["nominal"] == hot
    assert result.loaded.drive == warm_drive(hot)


@pytest.mark.parametrize(("value", "celsius"), [("333.15 K", 60.0), ("60 °C", 60.0), (60, 60.0)])
def test_units_of_temperature(value, celsius):
    assert with_fields(PAPER, EXPANSION | {"temperature.shaft": value}).temperature == Temperature(shaft=celsius)


def test_coefficients_of_a_warm_drive_are_asked_for_its_warm_bodies(monkeypatch):
    """`cyclo run --compliance fe` of a drive with temperatures ended in "lengths are at 20 °C still"."""
    asked = {}
    monkeypatch.setattr(
        ltca.compliance.coefficient_files, "find_case_coefficients", lambda cases, *_, **__: asked.update(cases) or {}
    )
    drive = with_fields(PAPER, EXPANSION | warmth(30.0, 50.0, 40.0))
    find_coefficients_of({"warm": drive}, PlaneStrain(), argparse.Namespace(compliance="fe", coefficients=None))
    assert asked["warm"] == warm_drive(drive)
    assert asked["warm"].shape_fingerprint() != PAPER.shape_fingerprint()
