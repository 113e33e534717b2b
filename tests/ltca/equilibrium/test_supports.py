"""Springs on coordinates: energy, force and tangent, clearance and preload against one-sided springs found by minimising."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from refusals import reads_as

from ltca.analysis.engines import HalfSpace
from ltca.arrays import stack_drives
from ltca.drive.parts import Preload
from ltca.drive.single_discs import single_discs
from ltca.equilibrium.output_torque import solve_at_output
from ltca.equilibrium.supports import Supports
from ltca.errors import DriveError
from ltca.geometry.coordinates import Coordinates
from ltca.geometry.pairs import ContactGeometry
from ltca.laws.bearing_pair import SideLaw, bearing_matrix
from ltca.laws.member_bearings import crank_laws, wheel_law, wheel_rows
from ltca.page.derived import derived_rows
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import build_drive, load_drive, parse_drive, parse_toml, shipped_drive
from ltca.reading.writing import drive_text
from ltca.testing.bearing_springs import (
    SidedSpring,
    crank_springs,
    shaft_energy,
    wheel_rows as element_rows,
    wheel_spring,
)
from ltca.testing.yielding_pins import crankshaft_bending

ROWS = {
    f"main_bearing.bearings.{number}.{name}": value
    for number, plane in enumerate((-25.0, 35.0))
    for name, value in {
        "plane": plane, "kind": "tapered roller", "contact_angle": 0.35, "pitch_radius": 60.0, "load_constant": 8e5,
    }.items()
}  # fmt: skip
KINDS = {
    "linear": {"pin_wheel.support_stiffness": 1e6},
    "loose": {"crank.support.clearance": 0.01, "main_bearing.radial_stiffness": 1e6, "main_bearing.clearance": 0.02},
    "no clearance": {"crank.support.clearance": 0.0, "main_bearing.radial_stiffness": 1e6, "main_bearing.clearance": 0.0},
    "tight": {"crank.support.clearance": -0.004, "main_bearing.radial_stiffness": 1e6, "main_bearing.clearance": -0.01},
    "preloaded": {
        "crank.support.preload": "300 N", "main_bearing.radial_stiffness": 1e6, "main_bearing.preload": "2 µm",
    },
    "rows": {
        "crank.support.contact_angle": 0.25, "crank.support.load_constant": 2e5, "crank.support.stiffness": (),
        "crank.support.preload": 400.0, "main_bearing.preload": "1 kN", **ROWS,
    },
    "rows not alike": {
        "main_bearing.preload": "1 kN", **ROWS, "main_bearing.bearings.1.contact_angle": 0.6,
        "main_bearing.bearings.1.load_constant": 3e6, "main_bearing.bearings.2.plane": 0.0,
        "main_bearing.bearings.2.kind": "cylindrical", "main_bearing.bearings.2.radial_stiffness": 5e5,
    },
}  # fmt: skip


@pytest.fixture(scope="module")
def rv():
    return parse_drive(shipped_drive("rv"), "rv").cases["nominal"]


@pytest.fixture(scope="module")
def drives(rv):
    """The made-up RV reducer on bearings of every kind."""
    return {name: with_fields(rv, words) for name, words in KINDS.items()}


def supports_of(drive):
    return Supports.of_drive(drive, ContactGeometry.of_drive(single_discs(drive)[0]))


def poses(drive, size=0.01, seed=0, count=12):
    """Displacements of some µm up to a hundredth of a millimetre, many a support within its clearance among them."""
    random = np.random.default_rng(seed)
    shape = (count, Coordinates.of_drive(drive).size)
    return random.normal(size=shape) * size * 10.0 ** random.uniform(-2.0, 0.3, (count, 1))


@pytest.mark.family(quick=1)
@pytest.mark.parametrize(
    "name", [name if name in ("linear", "loose") else pytest.param(name, marks=pytest.mark.slow) for name in KINDS]
)
def test_force_is_the_slope_of_the_energy_and_tangent_that_of_the_force(drives, name):
    held, at = supports_of(drives[name]), poses(drives[name])
    force, tangent = held.respond(at)
    tangent, step = np.broadcast_to(tangent, (*at.shape, at.shape[1])), 1e-7
    np.testing.assert_array_equal(tangent, tangent.swapaxes(1, 2))
    assert np.linalg.eigvalsh(tangent).min() > -1e-9 * np.abs(tangent).max()  # the energy is convex
    for column in range(at.shape[1]):
        ends = [at + side * step * (np.arange(at.shape[1]) == column) for side in (1.0, -1.0)]
        slope = (held.energy(ends[0]) - held.energy(ends[1])) / (2.0 * step)
        # energies of some N·mm over 0.2 nm: 1e-15 · 1e2 / 1e-7, and what a kink within the step leaves out, k · step
        np.testing.assert_allclose(slope, force[:, column], rtol=1e-6, atol=0.2)
        bent = (held.respond(ends[0])[0] - held.respond(ends[1])[0]) / (2.0 * step)
        off = np.abs(bent - tangent[:, :, column]).max(axis=1) > 1e-4 * np.abs(tangent).max()
        assert off.sum() <= 1, name  # a pose whose support lifts off within the step


@pytest.mark.parametrize("name", KINDS)
def test_energy_is_the_least_of_one_sided_springs(drives, name):
    """Displacements at the bearings found by minimising the energies of the sides, rows summed over their elements."""
    drive = drives[name]
    held, at, coordinates = supports_of(drive), poses(drive), Coordinates.of_drive(drive)
    (start, end), planes = drive.crank.support.positions, np.array(drive.disc.disc_planes)
    second = (planes - start) / (end - start)
    wheel = at[:, coordinates.wheel_place]
    expected = wheel_spring(drive).energy(np.hypot(wheel[:, 0], wheel[:, 1]))
    for crank in range(3):
        x = coordinates.crank(crank) + coordinates.own * np.arange(2)
        moved = at[:, x] + 1j * at[:, x + 1]
        shares = np.stack([1.0 - second, second])
        expected = expected + shaft_energy(crankshaft_bending(drive), shares, crank_springs(drive), moved)
    # the minimum closes to 1e-16 of it; the check adds 1e-9 of the springs' flexibility to the shaft's
    np.testing.assert_allclose(held.energy(at), expected, rtol=1e-8, atol=1e-12)


def test_nothing_resists_within_the_clearance(drives):
    """All of a crank moved by less than 5 µm, the wheel by less than 10 µm: no force, no stiffness; a micron beyond 1e6 N/mm."""
    drive = drives["loose"]
    held, coordinates = supports_of(drive), Coordinates.of_drive(drive)
    at = np.zeros((1, coordinates.size))
    for crank in range(3):
        at[:, coordinates.crank(crank) + coordinates.own * np.arange(2)] = 0.0049
    at[:, coordinates.wheel_place] = 0.0099 * np.array([0.6, -0.8])
    force, tangent = held.respond(at)
    # round-off of 1e6 N/mm times 1e-2 mm
    np.testing.assert_allclose(force, 0.0, atol=1e-9)
    np.testing.assert_allclose(tangent, 0.0, atol=1e-5)
    at[:, coordinates.wheel_place] = 0.011 * np.array([0.6, -0.8])
    np.testing.assert_allclose(held.respond(at)[0][0, coordinates.wheel_place], [600.0, -800.0], rtol=1e-9)


def test_no_clearance_is_a_spring(drives, rv):
    plain = with_fields(rv, {"main_bearing.radial_stiffness": 1e6})
    at = poses(plain)
    (force, tangent), (bare, matrix) = supports_of(drives["no clearance"]).respond(at), supports_of(plain).respond(at)
    np.testing.assert_allclose(force, bare, rtol=0.0, atol=1e-12 * np.abs(bare).max())
    np.testing.assert_allclose(tangent, np.broadcast_to(matrix, tangent.shape), rtol=0.0, atol=1e-12 * matrix.max())


def test_the_alias_is_the_same_stiffness(rv):
    one, other = (
        with_fields(rv, {path: 1e6}) for path in ("main_bearing.radial_stiffness", "pin_wheel.support_stiffness")
    )
    np.testing.assert_array_equal(supports_of(one).matrix, supports_of(other).matrix)
    assert not supports_of(one).bearings
    both = with_fields(rv, {"pin_wheel.support_stiffness": 1e6, "main_bearing.clearance": 0.01})
    assert wheel_law(both) == SideLaw.of_clearance(1e6, 0.01)


def test_from_loose_to_tight_without_a_jump(rv):
    """Forces at a pose over the clearance: no two neighbours differ by more than the stiffness of both sides times the step."""
    at, found = poses(rv, count=6), []
    clearances = np.linspace(0.02, -0.02, 41)
    for clearance in clearances:
        fields = {"crank.support.clearance": float(clearance), "main_bearing.radial_stiffness": 1e6}
        drive = with_fields(rv, fields | {"main_bearing.clearance": float(clearance)})
        wide = np.pad(at, ((0, 0), (0, Coordinates.of_drive(drive).size - at.shape[1])), constant_values=0.003)
        found.append(supports_of(drive).respond(wide)[0])
    step = np.abs(np.diff(found, axis=0)).max()
    # radial step 0.5 µm, sides of 4e5 N/mm of a crank whose planes see one bearing with up to 1.1; the wheel of 1e6 N/mm
    assert step < 1.2 * 1e6 * 0.5 * abs(clearances[1] - clearances[0])


def test_supports_of_different_drives_are_one_batch(drives):
    loose = drives["loose"]
    wide = with_fields(loose, {"crank.support.clearance": 0.02, "main_bearing.clearance": 0.0})
    at = poses(loose, count=8)
    together = stack_drives([supports_of(loose), supports_of(wide)], 4)
    alone = [supports_of(loose).respond(at[:4]), supports_of(wide).respond(at[4:])]
    for whole, parts in zip(together.respond(at), zip(*alone, strict=True), strict=True):
        np.testing.assert_allclose(whole, np.concatenate(parts), rtol=1e-12, atol=1e-9)


def main_bearing(rv, rows, preload=None):
    """The law of a main bearing of rows, and its preloaded rows as sums over elements, facing each other."""
    changes = {
        f"main_bearing.bearings.{number}.{name}": value
        for number, row in enumerate(rows)
        for name, value in row.items()
    }
    drive = with_fields(rv, changes | ({} if preload is None else {"main_bearing.preload": preload}))
    elements, beside = element_rows(drive)
    return wheel_law(drive), [replace(row, facing=1 - 2 * number) for number, row in enumerate(elements)], beside


def row_of(angle, plane, **fields):
    ball = {"kind": "angular-contact ball", "pitch_radius": 60.0, "contact_angle": np.radians(angle)}
    return ball | {"plane": plane} | fields


def force_of(law, displacement):
    """Radial force of a law by its displacement."""
    ends = displacement - law.lift_off / law.stiffness
    return law.stiffness * displacement if ends <= 0.0 else law.lift_off + ends / (1.0 / law.stiffness + law.beyond)


CYLINDER = {"kind": "cylindrical", "plane": 0.0, "radial_stiffness": 4e5}
ALIKE = [row_of(25.0, plane, load_constant=2e6) for plane in (-30.0, 30.0)]
UNLIKE = [row_of(25.0, -30.0, load_constant=2e6), row_of(35.0, 30.0, load_constant=4e6)]


@pytest.mark.parametrize(
    ("rows", "law_beyond", "elements_beyond"),
    [
        # elements lift off one after the other: at most 4 % of balls, 2 % of rollers softer up to the lift-off of the law;
        # beyond it balls stiffen (√δ), which one side alone leaves out: up to 18 % at twice the displacement and 60 %
        # at five times, rollers 8 and 14 %
        (ALIKE, 0.04, (0.18, 0.60)),
        (UNLIKE, 0.04, (0.18, 0.60)),
        ([*UNLIKE, CYLINDER], 0.04, (0.18, 0.60)),
        ([row | {"kind": "tapered roller"} for row in ALIKE], 0.02, (0.08, 0.14)),
        ([*(row | {"kind": "tapered roller"} for row in ALIKE), CYLINDER], 0.02, (0.08, 0.14)),
    ],
    ids=["balls alike", "balls not alike", "balls beside rollers", "tapered", "tapered beside rollers"],
)
def test_law_of_rows_is_the_sum_over_elements(rv, rows, law_beyond, elements_beyond):
    law, elements, beside = main_bearing(rv, rows, preload=2e3)

    def summed(radial):
        return sum(row.forces(radial)[0] for row in elements) + beside * radial

    reach, step = law.lift_off / law.stiffness, 1e-4 * law.lift_off / law.stiffness
    # at rest: central differences of second order, 1e-8 of it; loads to round-off, and no axial force is left
    assert (summed(step) - summed(-step)) / (2.0 * step) == pytest.approx(law.stiffness, rel=1e-7)
    assert sum(row.forces()[1] for row in elements) == pytest.approx(0.0, abs=1e-8)
    assert law.preload_load == pytest.approx(sum(row.loads()[0].sum() for row in elements), rel=1e-12)
    for part in (0.25, 0.5, 0.75, 1.0):
        assert summed(part * reach) == pytest.approx(force_of(law, part * reach), rel=law_beyond)
    for part, most in zip((2.0, 5.0), elements_beyond, strict=True):
        assert 0.0 < summed(part * reach) / force_of(law, part * reach) - 1.0 < most


def test_half_of_linear_elements_carry_beyond_lift_off(rv):
    """The factor ½: of elements without stiffening half press under a large displacement, and rows beside them as before."""
    law, elements, beside = main_bearing(rv, [*UNLIKE, CYLINDER], preload=2e3)
    linear = [
        replace(row, power=1.0, load_constant=row.power * row.load_constant * row.pressed ** (row.power - 1.0))
        for row in elements
    ]
    far, step = 1e4 * law.lift_off / law.stiffness, 1.0 * law.lift_off / law.stiffness
    slope = sum(row.forces(far + step)[0] - row.forces(far)[0] for row in linear) / step + beside
    # as far as that just the elements on one side press, whose cos² sum up to a quarter of all; differences to round-off
    assert 1.0 / (1.0 / law.stiffness + law.beyond) == pytest.approx(slope, rel=1e-8)


def test_a_row_beside_a_preloaded_pair_keeps_its_stiffness(rv):
    """45°, 1e5 N/mm axially are 5e4 radially: 1e5 of a pair, 5e4 beyond lift-off at δ = 1.5·500/1e5 = 7.5 µm; 3e4 of cylindrical
    rollers beside it on both sides of it.
    """
    pair = [row_of(45.0, plane, axial_stiffness=1e5) for plane in (-30.0, 30.0)]
    law = main_bearing(rv, [*pair, CYLINDER | {"radial_stiffness": 3e4}], preload=500.0)[0]
    assert law.stiffness == pytest.approx(1.3e5, rel=1e-12)
    assert law.lift_off == pytest.approx(1.3e5 * 0.0075, rel=1e-12)
    assert 1.0 / (1.0 / law.stiffness + law.beyond) == pytest.approx(0.8e5, rel=1e-12)


def test_rows_that_are_not_alike_lift_off_on_the_average(rv):
    """45°, 1e5 and 2e5 N/mm axially under 500 N: 5e4 and 1e5 radially, free from 7.5 and 3.75 µm. One after the other at 20 µm:
    1.5e5·0.02 − 2.5e4·(0.02 − 0.0075) − 5e4·(0.02 − 0.00375) = 1875 N.
    """
    rows = [row_of(45.0, plane, axial_stiffness=stiff) for plane, stiff in ((-30.0, 1e5), (30.0, 2e5))]
    law = main_bearing(rv, rows, preload=500.0)[0]
    assert law.lift_off == pytest.approx(1.5e5 * 0.005, rel=1e-12)
    assert force_of(law, 0.020) == pytest.approx(1875.0, rel=1e-12)
    assert force_of(law, 0.00375) == pytest.approx(1.5e5 * 0.00375, rel=1e-12)


@pytest.mark.parametrize(("arrangement", "centres"), [("O", (-30.0, 60.0)), ("X", (30.0, 0.0))])
def test_a_row_without_contact_angle_does_not_turn_the_others(rv, arrangement, centres):
    """45° on a radius of 30 mm at 0 and 30 mm: pressure centres 30 mm outside or inside, whatever stands at −60 mm."""
    rows = {
        f"main_bearing.bearings.{number}.{name}": value
        for number, plane in enumerate((0.0, 30.0))
        for name, value in row_of(45.0, plane, pitch_radius=30.0, axial_stiffness=1e5).items()
    } | {"main_bearing.arrangement": arrangement}
    beside = {f"main_bearing.bearings.2.{name}": value for name, value in CYLINDER.items()} | {
        "main_bearing.bearings.2.plane": -60.0
    }
    for changes in (rows, rows | beside):
        found = wheel_rows(with_fields(rv, changes))
        assert [row.pressure_centre for row in found[:2]] == pytest.approx(centres, abs=1e-12)


def test_rows_by_hand(drives):
    """1 kN on 8e5 δ^(10/9): δ = 2.43 µm, k = (10/9) F/δ; radial cot²α/2 of both rows, the rows lift off at δ tan α."""
    pressed = (1000.0 / 8e5) ** 0.9
    axial = 10.0 / 9.0 * 1000.0 / pressed
    law = wheel_law(drives["rows"])
    assert law.stiffness == pytest.approx(axial / np.tan(0.35) ** 2, rel=1e-12)
    assert law.lift_off == pytest.approx(law.stiffness * pressed * np.tan(0.35), rel=1e-12)
    assert [row.pressure_centre for row in wheel_rows(drives["rows"])] == pytest.approx(
        [-25.0 - 60.0 * np.tan(0.35), 35.0 + 60.0 * np.tan(0.35)], rel=1e-12
    )
    assert bearing_matrix(wheel_rows(drives["rows"]))[2, 2] == pytest.approx(2.0 * axial, rel=1e-12)
    of_crank = (400.0 / 2e5) ** 0.9
    assert crank_laws(drives["rows"])[0].stiffness == pytest.approx(
        10.0 / 9.0 * 400.0 / of_crank / (2.0 * np.tan(0.25) ** 2), rel=1e-12
    )


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            {"main_bearing.radial_stiffness": 1e6, "pin_wheel.support_stiffness": 2e6},
            "main_bearing.radial_stiffness = 1e+06 N/mm and pin_wheel.support_stiffness = 2e+06 N/mm: are two names…",
        ),
        (
            {"main_bearing.radial_stiffness": 1e6, "main_bearing.tilt_stiffness": 1e9},
            "contact.slices = 1: must be odd, 3 to 65, with main_bearing.tilt_stiffness = 1e+09 N·mm/rad: …",
        ),
        (
            ROWS | {"main_bearing.preload": 1e3, "main_bearing.axial_stiffness": 1e6},
            "…main_bearing.axial_stiffness = 1e+06 N/mm: must be left out beside main_bearing.bearings, from which…",
        ),
        ({"main_bearing.clearance": 0.01}, "…main_bearing.radial_stiffness: must be given…"),
        (
            {"main_bearing.radial_stiffness": 1e6, "main_bearing.clearance": 0.01, "main_bearing.preload": 100.0},
            "…main_bearing.clearance = 0.01 mm: must be left out beside main_bearing.preload…",
        ),
        (
            {"main_bearing.radial_stiffness": 1e6, "main_bearing.preload": {"force": 1.0, "displacement": 0.001}},
            "…main_bearing.preload: must be either a force…",
        ),
        ({"main_bearing.radial_stiffness": 1e6, "main_bearing.preload": "5 MPa"}, "…main_bearing.preload.force … unit N…"),
        ({"main_bearing.radial_stiffness": 1e6, **ROWS}, "…main_bearing.radial_stiffness = 1e+06 N/mm: must be left out…"),
        (ROWS, "…main_bearing.bearings.0.load_constant = 800000 N/mmⁿ: needs a preload…"),
        (ROWS | {"main_bearing.bearings.1.kind": "cylindrical"}, "…main_bearing.bearings.1.contact_angle = 0.35 rad…"),
        (ROWS | {"main_bearing.bearings.1.plane": -25.0}, "…must stand in different planes…"),
        (
            ROWS | {"main_bearing.preload": 1e3, **{
                path.replace(".1.", ".2."): 50.0 if path.endswith("plane") else value
                for path, value in ROWS.items() if ".1." in path
            }},
            "…main_bearing.bearings has 3 rows with contact angles: must have at most 2…",
        ),
        (
            ROWS | {"main_bearing.bearings.0.preload": 1e3, "main_bearing.bearings.1.preload": 5e3},
            "…main_bearing.bearings.0 and main_bearing.bearings.1: axial preloads of 1000 and 5000 N must be equal to 1 %…",
        ),
        (
            ROWS | {"main_bearing.preload": "5 µm", "main_bearing.bearings.1.load_constant": 9e5},
            "…axial preloads of 2220 and 2498 N must be equal…",
        ),
        (
            {path: value for path, value in ROWS.items() if ".1." not in path} | {"main_bearing.preload": 1e3},
            "…main_bearing.preload: must be left out with one row with a contact angle (main_bearing.bearings.0)…",
        ),
        (
            {path: value for path, value in ROWS.items() if ".1." not in path} | {"main_bearing.bearings.0.preload": 1e3},
            "…main_bearing.bearings.0.preload: must be left out with one row…",
        ),
        (
            ROWS | {"main_bearing.bearings.0.preload": 1e3, "main_bearing.bearings.1.load_constant": None,
                    "main_bearing.bearings.1.axial_stiffness": 5e5},
            "…main_bearing.bearings.1.preload: must be given beside main_bearing.bearings.0.preload…",
        ),
        (ROWS | {"main_bearing.bearings.3.plane": 0.0}, "…main_bearing.bearings.3: there is no entry 3…"),
        ({"crank.support.stiffness": ()}, "…crank.support.stiffness has 0 values: must have 2…"),
        (
            {"crank.support.contact_angle": 0.2},
            "…crank.support.stiffness: must be left out beside crank.support.contact_angle…",
        ),
        (
            {"crank.support.contact_angle": 0.2, "crank.support.load_constant": 1e5, "crank.support.stiffness": ()},
            "…crank.support.preload: must be given with…",
        ),
    ],
)  # fmt: skip
def test_bad_input_is_one_clear_line(rv, words, message):
    with pytest.raises(DriveError) as caught:
        with_fields(rv, words)
    problems = caught.value.problems
    assert not any("\n" in problem for problem in problems)
    assert any(reads_as(message, problem) for problem in problems), problems


def test_a_preload_reads_as_written():
    """A number is a force; a text says by its unit which of both it is; what is written reads back."""
    text = shipped_drive("rv") + '\n[main_bearing]\nradial_stiffness = "1 N/µm"\npreload = "5 µm"\n'
    drive = build_drive(parse_toml(text, "rv") | {"name": "rv"})
    assert drive.main_bearing.preload == Preload(displacement=0.005)
    assert parse_drive(drive_text(drive)).cases["nominal"] == drive
    assert with_fields(
        drive, {"main_bearing": {"preload": {"displacement": None, "force": "2 kN"}}}
    ).main_bearing.preload == Preload(force=2000.0)


def test_limits_of_stiff_bearings(rv):
    """Ten times as stiff, a tenth of the displacement beyond the clearance under the same force."""
    for factor in (1.0, 10.0):
        drive = with_fields(rv, {"main_bearing.radial_stiffness": factor * 1e6, "main_bearing.clearance": 0.02})
        at = np.zeros((1, Coordinates.of_drive(drive).size))
        at[0, Coordinates.of_drive(drive).wheel_place.start] = 0.01 + 1e-3 / factor
        assert supports_of(drive).respond(at)[0].max() == pytest.approx(1000.0, rel=1e-9)


def test_the_paper_drive_has_no_supports():
    drive = load_drive("paper").cases["CS-1"]
    assert supports_of(drive) is None
    assert supports_of(replace(drive, pin_wheel=replace(drive.pin_wheel, support_stiffness=1e6))) is not None


@pytest.mark.parametrize("distance", [0.001, np.float64(0.001)])
def test_both_sides_of_the_checks_spring_carry_until_one_lifts_off(distance):
    """Numpy's truths add up to one: the slope was that of one side, and the least energy of a shaft was missed by 0.15 %."""
    spring = SidedSpring(side=5e5, pressed=0.004)
    assert spring.slopes(distance) == (pytest.approx(1e3), 1e6)
    assert spring.slopes(6.0 * distance)[1] == 5e5


def test_stiff_supports_end_at_rigid_ones():
    """Their stiffness counted as round-off of approaches: from 1e11 N/mm on loads stayed 1e-5 away. Now k tells alone."""
    drive = load_drive("rv").cases["nominal"]
    angle = np.array([0.0, 1.2])
    rigid = with_fields(drive, {"pin_wheel.support_stiffness": None})
    expected = solve_at_output(HalfSpace().prepare(rigid).model, [rigid], angle, drive.load.torque).response.pin_load
    apart = []
    for stiffness in (1e10, 1e12, 1e15):
        stiff = with_fields(drive, {"pin_wheel.support_stiffness": stiffness})
        found = solve_at_output(HalfSpace().prepare(stiff).model, [stiff], angle, drive.load.torque).response.pin_load
        apart.append(np.max(np.abs(found - expected)) / expected.max())
    assert apart[1] < 0.02 * apart[0]  # as 1/k
    assert apart[2] < 1e-8  # the balance ends at 1e-9 of the load


def test_the_pair_of_lines_in_the_docs(rv):
    """docs/how-to/supports.md: a preload of 2 kN and a negative clearance of 8 µm are one bearing."""
    preloaded = with_fields(rv, {"main_bearing.radial_stiffness": 1e6, "main_bearing.preload": "2 kN"})
    tight = with_fields(rv, {"main_bearing.radial_stiffness": 5e5, "main_bearing.clearance": "-8 µm"})
    assert wheel_law(preloaded) == wheel_law(tight)
    assert wheel_law(tight).lift_off == pytest.approx(4000.0, rel=1e-12)


def test_rows_without_pitch_radius_tell_no_tilt(rv):
    rows = ROWS | {"main_bearing.preload": 1e3}
    drives = [with_fields(rv, rows | {"main_bearing.bearings.1.pitch_radius": radius}) for radius in (None, 60.0)]
    without, whole = (dict(derived_rows(drive, drive, plays=False))["rows of the main bearing"] for drive in drives)
    assert re.fullmatch(r"axial [0-9.e+]+ N/mm", without)
    assert "pressure centres at -46.9, 56.9 mm" in whole  # -25 - 60 tan 0.35, 35 + 60 tan 0.35
    assert wheel_law(drives[0]) == wheel_law(drives[1])
