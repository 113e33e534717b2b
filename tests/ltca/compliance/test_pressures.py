"""Pressures of all models: shaft pins in holes against Hertz, ends by one rule, none in plane strain."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ltca.analysis.engines import HalfSpace, Hybrid, PlaneStrain
from ltca.analysis.loaded_analysis import analyse
from ltca.arrays import stack_drives
from ltca.compliance.coupled import CoupledCompliance
from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.compliance.pressures import along_width
from ltca.contact.contact_kind import ContactKind
from ltca.equilibrium.balance import solve_equilibrium
from ltca.equilibrium.reducer import Reducer
from ltca.laws.width_pressure import WidthPressures
from ltca.reading.changes import with_fields
from ltca.testing.closed_form_bodies import without_coupling

ANGLES = np.array([0.5, 2.0])
STEEL, ALUMINIUM = (206_000.0, 0.3), (70_000.0, 0.33)
SOFT_PINS = {"materials.shaft_pin.youngs_modulus": ALUMINIUM[0], "materials.shaft_pin.poisson_ratio": ALUMINIUM[1]}


def compliance(material):
    return (1.0 - material[1] ** 2) / material[0]


def hertz(drive, load, total_compliance):
    """Peak pressure and half-width of Hertz's line contact (Johnson 4.43, 4.45), 20 in 28 mm for the paper's drive."""
    line = load / drive.disc.thickness
    gap = drive.hole_radius - drive.pin_shaft.pin_radius
    radius = drive.hole_radius * drive.pin_shaft.pin_radius / gap
    return np.sqrt(line / (np.pi * radius * total_compliance)), np.sqrt(4.0 * line * radius * total_compliance / np.pi)


@pytest.fixture(scope="module")
def drive(paper_cases):
    return paper_cases["CS-6"]


@pytest.mark.parametrize("pins", ["steel", "aluminium"])
def test_holes_of_half_spaces_press_elastic_pins(pins, drive):
    """The spring carries the load; the pressure is that of the materials, lower by what goes to the ends."""
    soft = pins == "aluminium"
    own = with_fields(drive, SOFT_PINS) if soft else drive
    pressures = (result := analyse(own, ANGLES)).pressures
    load = result.full.response.hole_load
    peak, width = hertz(drive, load, compliance(STEEL) + compliance(ALUMINIUM if soft else STEEL))
    loaded = load > 0.05 * load.max()
    assert not pressures.rigid_shaft_pins
    # The ends of a straight contact take load off its middle, here 7 to 14 % of it (the law of the fading is below);
    # pressure and half-width go like its root.
    for found, expected in ((pressures.holes.mid, peak), (pressures.holes.half_width, width)):
        ratio = found[loaded] / expected[loaded]
        assert np.all((ratio > 0.92) & (ratio < 0.96))
    assert np.all(pressures.holes.mid[load == 0.0] == 0.0)
    assert np.all(pressures.holes.largest[loaded] > 1.5 * pressures.holes.mid[loaded])
    assert pressures.holes.end_cell == 0.01 * drive.disc.thickness
    np.testing.assert_array_equal(load, analyse(drive, ANGLES).full.response.hole_load)


def test_wide_holes_press_like_hertz(drive):
    """What the ends take off the middle fades, slowly, like one over the logarithm of length by width.

    On a slender straight contact the middle carries (1 − ln 2)/ln less than the mean, like the charge on a needle; pressure
    and half-width go like the root of that: 0.15/ln in the limit.
    """
    faded = []
    for width in (1e2, 1e4):
        wide = replace(
            drive,
            disc=replace(drive.disc, thickness=width * drive.disc.thickness),
            crank_bearing=replace(drive.crank_bearing, roller_length=width * drive.disc.thickness),
            pin_shaft=replace(drive.pin_shaft, stiffness=width * drive.pin_shaft.stiffness),
            load=replace(drive.load, torque=width * drive.load.torque),
        )
        result = analyse(wide, ANGLES)
        load = result.full.response.hole_load
        peak, half_width = hertz(wide, load, 2.0 * compliance(STEEL))
        loaded = load > 0.05 * load.max()
        logarithm = np.log(4.0 * wide.disc.thickness / half_width[loaded])
        for found, expected in ((result.pressures.holes.mid, peak), (result.pressures.holes.half_width, half_width)):
            faded.append((1.0 - found[loaded] / expected[loaded]) * logarithm)
    # 0.21 to 0.22, then 0.19; a wrong radius, modulus or length would make it grow with the logarithm
    assert np.all((np.array(faded) > 0.15) & (np.array(faded) < 0.25))
    assert np.max(faded[2:]) < np.min(faded[:2])


@pytest.mark.slow
def test_holes_of_plane_strain_press_rigid_pins(drive, closed_form):
    """Hertz to the last digit, with the modulus of the disc alone; the spring's pin is elastic again without that wall."""
    coefficients = closed_form(drive)
    rigid = analyse(drive, ANGLES, engine=PlaneStrain(coefficients=coefficients))
    load = rigid.full.response.hole_load
    peak, width = hertz(drive, load, compliance(STEEL))
    assert rigid.pressures.rigid_shaft_pins
    np.testing.assert_allclose(rigid.pressures.holes.mid, peak, rtol=1e-8)
    np.testing.assert_allclose(rigid.pressures.holes.half_width, width, rtol=1e-8)
    elastic = analyse(drive, ANGLES, engine=PlaneStrain(coefficients=coefficients, hole_near_field=False))
    assert not elastic.pressures.rigid_shaft_pins
    peak, _ = hertz(drive, elastic.full.response.hole_load, 2.0 * compliance(STEEL))
    np.testing.assert_allclose(elastic.pressures.holes.mid, peak, rtol=1e-8)


ELASTIC = {"pin_shaft.elastic_contact": True}


@pytest.mark.parametrize("pins", [pytest.param(STEEL, marks=pytest.mark.slow), ALUMINIUM])
def test_elastic_shaft_pins_press_their_holes_like_hertz(pins, drive, closed_form):
    """Both moduli in plane strain, to the last digit; the pins give way, so the wheel turns further than on rigid ones."""
    made_of = {"materials.shaft_pin.youngs_modulus": pins[0], "materials.shaft_pin.poisson_ratio": pins[1]}
    coefficients, own = closed_form(drive), with_fields(drive, ELASTIC | made_of)
    found = analyse(own, ANGLES, engine=PlaneStrain(coefficients=coefficients))
    peak, width = hertz(own, found.full.response.hole_load, compliance(STEEL) + compliance(pins))
    assert not found.pressures.rigid_shaft_pins
    np.testing.assert_allclose(found.pressures.holes.mid, peak, rtol=1e-8)
    np.testing.assert_allclose(found.pressures.holes.half_width, width, rtol=1e-8)
    rigid = analyse(drive, ANGLES, engine=PlaneStrain(coefficients=coefficients))
    assert np.all(np.abs(found.transmission_error) > np.abs(rigid.transmission_error))


@pytest.mark.slow
@pytest.mark.parametrize("engine", [PlaneStrain, Hybrid])
def test_shaft_pins_that_do_not_yield_are_rigid(engine, drive, closed_form):
    """A million times the modulus of steel: poses, loads and pressures of rigid pins."""
    stiff, coefficients = (
        with_fields(drive, ELASTIC | {"materials.shaft_pin.youngs_modulus": 2e11}, check=False),
        closed_form(drive),
    )
    found, rigid = (analyse(own, ANGLES, engine=engine(coefficients=coefficients)) for own in (stiff, drive))
    # What is left of the pins' own part is a millionth of it.
    np.testing.assert_allclose(found.full.pose, rigid.full.pose, rtol=1e-5, atol=1e-10)
    np.testing.assert_allclose(found.full.response.hole_load, rigid.full.response.hole_load, atol=0.1)
    np.testing.assert_allclose(found.pressures.holes.mid, rigid.pressures.holes.mid, atol=0.01)


def test_a_shaft_pin_yields_as_one_approach_at_one_load(drive, closed_form):
    """At the loads found, an elastic pin's approach is more than a rigid one's by the closed form of the whole contact."""
    coefficients, own = closed_form(drive), with_fields(drive, ELASTIC)
    rigid, soft = (CoupledCompliance.of_drive(one, coefficients, "plane-strain") for one in (drive, own))
    load, radius = np.array([[2000.0]]), float(soft.geometry.placement.hole_effective_radii[0])
    nu, modulus = STEEL[1], STEEL[0]
    share = 2.0 * (1.0 - nu**2) / (np.pi * modulus * drive.disc.thickness)
    yielding = [
        float(model.contacts.hole_law.approach_at_load(load, radius)[0][0, 0]) + model.bodies[0].alone[2] * 2000.0
        for model in (rigid, soft)
    ]
    line, gap = 2000.0 / drive.disc.thickness, compliance(STEEL)
    both, alone = (np.sqrt(4.0 * line * radius * total / np.pi) for total in (2.0 * gap, gap))
    # Wall: its logarithm under the wider contact, separation b²/8ρ = a quarter of the bracket; pin: the closed form.
    kolosov = 3.0 - 4.0 * nu
    pin = np.log(2.0 * drive.pin_shaft.pin_radius / both) + 0.25 - 0.5 * (kolosov + 2.0) / (kolosov + 1.0)
    wall = np.log(alone / both)
    assert yielding[1] - yielding[0] == pytest.approx(share * 2000.0 * (pin + 0.25 + wall), rel=1e-9)


def test_half_spaces_know_no_contact_at_the_holes(drive):
    """Springs stand for all that yields: the field changes no digit, and its false is said beside the pressures."""
    soft, rigid = (analyse(own, ANGLES) for own in (with_fields(drive, ELASTIC), drive))
    np.testing.assert_array_equal(soft.full.pose, rigid.full.pose)
    np.testing.assert_array_equal(soft.pressures.holes.mid, rigid.pressures.holes.mid)
    assert soft.hole_words == ""
    assert "pin_shaft.elastic_contact = false: without effect" in rigid.hole_words


def test_beams_in_slices_touch_their_holes(drive):
    """Rigid shaft pins were said to be without effect, and their pressures were those of elastic ones."""
    bent = {
        "pin_shaft.stiffness": None,
        "pin_shaft.beam.tip": "free",
        "pin_shaft.beam.span": 20.0,
        "contact.slices": 3,
    }
    soft, rigid = (analyse(with_fields(drive, bent | more), ANGLES[:1]) for more in (ELASTIC, {}))
    assert soft.hole_words == ""
    assert "rigid at their holes" in rigid.hole_words
    # p² = E* q/(π ρ) in the middle, E* that of the disc alone where pins are rigid.
    disc, line = rigid.drive.materials.disc, rigid.pressures.holes.along.line_load[0, :, 1]
    radius = rigid.model.discs[0].geometry.placement.hole_effective_radii
    expected = np.sqrt(line / (np.pi * radius * disc.plane_strain_compliance))
    np.testing.assert_allclose(rigid.pressures.holes.mid[0], expected, rtol=1e-9)


@pytest.mark.slow
def test_plane_strain_has_no_ends(drive, closed_form):
    """Pressures at mid-width were given as those anywhere, of an end cell of no length."""
    pressures = analyse(drive, ANGLES, engine=PlaneStrain(coefficients=closed_form(drive))).pressures
    for kind in (pressures.pins, pressures.outer, pressures.inner, pressures.holes):
        assert np.all(np.isnan(kind.largest))
        assert np.isnan(kind.end_cell)
        assert np.all(np.isfinite(kind.mid))


@pytest.mark.slow
def test_hybrid_has_the_ends_of_half_spaces(drive, closed_form):
    """The same rule as on tables: without a body part the same pressures everywhere, with one about the same ratio."""
    plain = analyse(drive, ANGLES).pressures
    bare = Hybrid(coefficients=without_coupling(drive), hole_near_field=False)
    same = analyse(drive, ANGLES, engine=bare).pressures
    real = analyse(drive, ANGLES, engine=Hybrid(coefficients=closed_form(drive))).pressures
    for kind in ("pins", "outer", "inner", "holes"):
        one, other, third = (getattr(pressures, kind) for pressures in (plain, same, real))
        for field in ("mid", "largest", "half_width"):
            # a balance to 1e-9 of the load, and pressures that start like the root of the approach
            atol = 1e-5 * np.max(getattr(one, field))
            np.testing.assert_allclose(getattr(other, field), getattr(one, field), atol=atol, err_msg=kind)
        assert other.end_cell == one.end_cell == third.end_cell > 0.0
        loaded = third.mid > 0.3 * third.mid.max()
        assert np.all(third.largest[loaded] > 1.5 * third.mid[loaded])
    assert same.rigid_shaft_pins == plain.rigid_shaft_pins is False
    assert real.rigid_shaft_pins


@pytest.mark.slow
def test_grids_press_holes_like_tables(drive):
    tables, grids = (analyse(drive, ANGLES[:1], engine=HalfSpace(method=method)) for method in ("tables", "direct"))
    # tables and grids share the load by 0.1 % and better, of which pressures have the root
    np.testing.assert_allclose(grids.pressures.holes.mid, tables.pressures.holes.mid, rtol=2e-3)
    assert grids.pressures.holes.end_cell == tables.pressures.holes.end_cell


def test_holes_in_batches(drive):
    """Row by row what each drive has alone, radii of its own included."""
    drives = [drive, with_fields(drive, {"pin_shaft.pin_radius": 9.9, "clearance.pin_hole": 0.0})]
    batch = stack_drives([HalfSpaceCompliance.of_drive(each, in_batch=True) for each in drives], ANGLES.size)
    moments = np.repeat([own.wheel_moment() for own in drives], ANGLES.size)
    found = batch.pressures(
        solve_equilibrium(Reducer(discs=(batch,)), np.tile(ANGLES, 2), moments).response.parts[0]
    ).holes
    alone = [analyse(own, ANGLES).pressures.holes for own in drives]
    for field in ("mid", "largest", "half_width"):
        expected = np.concatenate([getattr(holes, field) for holes in alone])
        np.testing.assert_allclose(getattr(found, field), expected, atol=1e-5 * expected.max())


def test_half_widths_along_the_width_are_those_of_hertz():
    """b = √(4 q ρ/(π E*)) of each slice with its own line load q, and p = 2 q/(π b)."""
    modulus, radius, line_load = 1.1e5, np.array([3.0, 8.0]), np.array([[40.0, 90.0, 250.0], [10.0, 60.0, 20.0]])
    half_width = np.sqrt(4.0 * line_load * radius[:, None] / (np.pi * modulus))
    pressure = 2.0 * line_load / (np.pi * half_width)
    along = WidthPressures(
        height=np.array([-3.0, 0.0, 3.0]),
        line_load=line_load,
        even_line_load=line_load,
        pressure=pressure,
        largest=pressure.max(axis=1),
        place=np.zeros(2),
        end_load=np.zeros((2, 2)),
    )
    found = along_width(ContactKind(length=9.0, contact_modulus=modulus), along, radius)
    assert found.along.half_width == pytest.approx(half_width, rel=1e-12)
    assert found.half_width == pytest.approx(half_width[:, 1], rel=1e-12)
    assert found.mid == pytest.approx(pressure[:, 1], rel=1e-12)
