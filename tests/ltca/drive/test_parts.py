"""The drive's own quantities and its identity."""

from __future__ import annotations

from dataclasses import FrozenInstanceError

import pytest

from ltca.drive.materials import MAY_BE_UNKNOWN, PARTS
from ltca.drive.members.temperatures import warm_drive
from ltca.drive.parts import LengthProfile, Material, contact_modulus
from ltca.drive.single_discs import single_discs
from ltca.reading.changes import with_fields
from ltca.testing.field_changes import change_of, leaf_fields, sensible_change


def test_paper_drive(paper_cases):
    drive = paper_cases["CS-1"]
    assert drive.reduction_ratio == 14.0
    assert drive.tooth_number_difference == 1
    assert drive.wheel_moment() == -377_300.0
    assert drive.wheel_moment(10.0) == -10.0
    clearances = [(d.clearance.bearing, d.clearance.pin_hole) for d in paper_cases.values()]
    # Table 2 of the paper
    assert clearances == [(0.0, 0.0), (0.01, 0.0), (0.03, 0.0), (0.03, 0.01), (0.03, 0.02), (0.03, 0.03)]


def test_load_opposes_the_crank(vary):
    assert vary(load={"direction": "cw"}).wheel_moment() == 377_300.0
    held = vary(installation={"held": "pin-wheel"})
    # the housing carries what output and crank put on it, T_out (1 + 1/13)
    assert held.wheel_moment(1300.0) == pytest.approx(-1400.0, rel=1e-15)
    assert (vary().transmission_ratio, held.transmission_ratio) == (14.0, -13.0)


def test_contact_modulus_of_steel_on_steel():
    steel = Material(youngs_modulus=206_000.0, poisson_ratio=0.3)
    # Johnson (4.18): 206000/(2·0.91)
    assert contact_modulus(steel, steel) == pytest.approx(113_186.813, rel=1e-8)
    rigid = Material(youngs_modulus=1e15, poisson_ratio=0.0)
    assert contact_modulus(steel, rigid) == pytest.approx(206_000.0 / 0.91, rel=1e-8)


def test_frozen_and_fingerprinted(vary):
    drive = vary()
    with pytest.raises(FrozenInstanceError):
        drive.crank.eccentricity = 3.0
    assert drive.fingerprint() == vary().fingerprint()
    assert drive.fingerprint() != vary(clearance={"bearing": 1e-6}).fingerprint()
    assert drive.fingerprint() != vary(materials={"roller": {"youngs_modulus": 205_999.0}}).fingerprint()


def test_length_profile_of_a_cylinder():
    assert LengthProfile().is_cylinder
    assert LengthProfile(end_relief_length=1.0).is_cylinder  # without depth it relieves nothing
    for profile in (
        LengthProfile(crown_drop=1e-3),
        LengthProfile(logarithmic_factor=1.0),
        LengthProfile(end_relief_length=1.0, end_relief_depth=1e-3),
    ):
        assert not profile.is_cylinder


RATINGS = ("crank_bearing.dynamic_load_rating", "crank_bearing.static_load_rating")
LEFT_OUT = (
    "pin_wheel.support_stiffness",
    "pin_wheel.core_radius",
    "crank_bearing.race_bore_radius",
    "installation.first_stage_ratio",
    "crank.circle_radius",
    "load.speed",
    "disc.axial_play",
    *RATINGS,
)
OF_PARTS = (
    "ring",
    "carrier",
    "first_stage",
    "load.external",
    "crank.support",
    "main_bearing",
    "materials.crankshaft",
    "materials.carrier",
    "materials.sleeve",
    "materials.wheel_seat",
    "duty",
    "lubricant",
    "inertia",
    "damping",
)
OF_PINS = ("pin_wheel.seat", "pin_wheel.beam", "pin_shaft.seat", "pin_shaft.beam")
# What plane finite-element bodies are made of: flank, bore, holes and thickness of the disc; pins, rollers, race; materials.
OF_THE_BODIES = [
    "crank.eccentricity",
    "crank.number",
    "pin_wheel.number_of_pins",
    "pin_wheel.pin_circle_radius",
    "pin_wheel.pin_radius",
    "pin_wheel.core_radius",
    "crank_bearing.race_bore_radius",
    "disc.number_of_teeth",
    "disc.thickness",
    "disc.phases",
    "disc.of.0.clearance.bearing",
    "disc.of.0.clearance.pin_hole",
    "disc.equidistant_offset",
    "disc.shifting_offset",
    "crank_bearing.inner_race_radius",
    "crank_bearing.outer_race_radius",
    "crank_bearing.roller_radius",
    "pin_shaft.number_of_pins",
    "pin_shaft.pin_circle_radius",
    "pin_shaft.hole_radius",
    "clearance.bearing",
    "clearance.pin_hole",
    "materials.disc.youngs_modulus",
    "materials.disc.poisson_ratio",
    "materials.wheel_pin.youngs_modulus",
    "materials.wheel_pin.poisson_ratio",
    "materials.roller.youngs_modulus",
    "materials.roller.poisson_ratio",
    "materials.inner_race.youngs_modulus",
    "materials.inner_race.poisson_ratio",
    # of sleeves on the wheel's pins, which the flank touches
    "materials.sleeve.youngs_modulus",
    "materials.sleeve.poisson_ratio",
    # of warm parts: shaft pins and wheel are none of the bodies, and the eccentricity of the flank is that of the disc
    "temperature.housing",
    "temperature.disc",
    "temperature.shaft",
    "materials.disc.thermal_expansion",
    "materials.wheel_pin.thermal_expansion",
    "materials.roller.thermal_expansion",
    "materials.inner_race.thermal_expansion",
    "materials.sleeve.thermal_expansion",
]
OF_MATERIALS = tuple(f"materials.{part}.{name}" for part in PARTS for name in MAY_BE_UNKNOWN)


def test_shape_fingerprint_is_that_of_the_bodies(paper_cases):
    """Every field that makes the bodies, materials and clearances too, and no other: a needless derivation takes 20 s."""
    plain, faults = paper_cases["CS-6"], []
    measured = with_fields(
        plain,
        {"disc.profile_errors.parameter": (0.0, 2.0), "disc.profile_errors.deviation": (0.0, 0.0)},
        check=False,
    )
    for path in leaf_fields():
        if path == "disc.number_of_discs":
            continue  # a shape is that of one disc
        beside = path.startswith((*OF_PARTS, *OF_PINS, "ring.", "temperature.")) or path in (*LEFT_OUT, *OF_MATERIALS)
        drive, change = change_of(plain, path) if beside else (measured, {path: sensible_change(measured, path)})
        other = single_discs(warm_drive(with_fields(drive, change, check=False)))[0]
        drive = warm_drive(drive)
        if (other.shape_fingerprint() != drive.shape_fingerprint()) != (path in OF_THE_BODIES):
            faults.append(f"{path}: shape")
        if (other.fingerprint() != drive.fingerprint()) != (not path.startswith("analysis.")):
            faults.append(f"{path}: drive")
    assert faults == []


def test_shape_fingerprint_of_one_bore_made_in_two_ways(vary):
    """Race and half the clearance: the bodies know the bore alone, and not the rounding of its sum."""
    wide = vary(crank_bearing={"outer_race_radius": 29.515})
    clear = vary(clearance={"bearing": 0.03})
    assert wide.bore_radius == pytest.approx(clear.bore_radius, abs=1e-12)
    assert wide.shape_fingerprint() == clear.shape_fingerprint()
    assert clear.shape_fingerprint() != vary().shape_fingerprint()
