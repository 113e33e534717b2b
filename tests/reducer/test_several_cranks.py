"""Several cranks on the carrier, crankshafts and a wheel that yield: closed forms, work, invariances."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from refusals import error_says, refused_field

from ltca.analysis.engines import HalfSpace
from ltca.analysis.loaded_analysis import analyse
from ltca.drive.parts import CrankSupport
from ltca.drive.single_discs import equal_parts
from ltca.equilibrium.output_torque import solve_at_output
from ltca.equilibrium.reducer import bearing_forces
from ltca.errors import DriveError
from ltca.geometry.coordinates import DISC_ROTATION, WHEEL_ANGLE, X, Y
from ltca.laws.member_bearings import crank_stiffness
from ltca.laws.spring import SpringLaw
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import parse_drive, shipped_drive
from ltca.testing.balance_check import find_imbalance

ANGLES = np.array([0.31, 1.7, 4.4])
SUPPORT = CrankSupport(diameter=20.0, positions=(-22.0, 22.0), stiffness=(3e5, 4e5))
LOAD = 1e-4
"""Loads of equal drives solved from different sides, N: the balance closes to 1e-9 of 16 kN, and stiffness adds a digit."""


@pytest.fixture(scope="module")
def rv():
    return parse_drive(shipped_drive("rv"), "rv").cases["nominal"]


def kind(rv, name):
    """The made-up RV reducer with what yields, or with holes, in different makes."""
    rigid = replace(rv, crank=replace(rv.crank, support=None))
    if name == "rigid":
        return rigid
    if name == "cranks":
        return replace(rv, crank=replace(rv.crank, support=SUPPORT))
    if name == "wheel":
        return replace(rigid, pin_wheel=replace(rv.pin_wheel, support_stiffness=5e5))
    if name == "carrier":  # cranks turned in the carrier
        return replace(rv, installation=replace(rv.installation, first_stage_ratio=None))
    if name == "shaft held":
        return replace(rv, installation=replace(rv.installation, held="pin-shaft"))
    joint = parse_drive(shipped_drive("robot-joint"), "robot-joint").cases["nominal"]
    if name == "central crank yields":
        return replace(
            joint,
            crank=replace(joint.crank, support=SUPPORT),
            pin_wheel=replace(joint.pin_wheel, support_stiffness=5e5),
        )
    assert name == "holes"
    shaft = replace(joint.pin_shaft, number_of_pins=3, pin_circle_radius=45.0, pin_radius=8.0, hole_radius=9.26)
    return replace(rv, crank=replace(rv.crank, angle=np.pi / 3.0), pin_shaft=shaft, clearance=joint.clearance)


SLOWLY = [
    pytest.param(name, marks=pytest.mark.slow)
    for name in ("rigid", "central crank yields", "wheel", "carrier", "shaft held")
]
KINDS = ["cranks", "holes", *SLOWLY]


@pytest.mark.slow
@pytest.mark.parametrize("name", KINDS)
def test_every_kind_is_balanced_by_energies_alone(rv, name):
    drive = kind(rv, name)
    model = HalfSpace().prepare(drive).model
    found = solve_at_output(model, [drive], ANGLES, drive.load.torque)
    for position in range(ANGLES.size):
        assert find_imbalance(drive, model, found, position, torque=drive.load.torque) == []


PRELOAD, CIRCLE, ROLLERS = 0.05, 1e4, 14
"""Interference of the rollers in each bearing and radius of their circle, mm: about a circle so wide their rays do not turn, and
what preload does beside is 0.05 mm by 10 m of the stiffness."""


def with_linear_bearings(model, stiffness):
    """The model with isotropic bearings without play: preloaded rollers between linear laws, none of which ever opens."""
    law = SpringLaw(stiffness=2.0 * stiffness / (0.5 * ROLLERS))
    discs = []
    for disc in model.discs:
        place = disc.geometry.placement
        radii = {"inner_race_radius": CIRCLE, "bore_radius": CIRCLE + 2.0 * float(place.roller_radii[0]) - PRELOAD}
        geometry = replace(disc.geometry, placement=replace(place, **radii))
        discs.append(replace(disc, geometry=geometry, inner_law=law, outer_law=law))
    return replace(model, discs=tuple(discs))


@pytest.mark.parametrize("cranks", [2, 3, 4])
def test_linear_bearings_share_resultant_and_moment(rv, cranks):
    """Resultant/n on each crank and moment/(n r) at a right angle to its turned arm; radially K r (1 − cos of the rotation)."""
    stiffness = 4e5
    drive = kind(rv, "shaft held")
    drive = replace(drive, crank=replace(drive.crank, support=None, number=cranks))
    model = with_linear_bearings(HalfSpace().prepare(drive).model, stiffness)
    assert model.discs[0].geometry.placement.roller_radii.size == cranks * ROLLERS
    found = solve_at_output(model, [drive], ANGLES, drive.load.torque)
    assert all(np.min(part.rollers.outer_load) > 0.0 for part in found.response.parts)
    for number, part in enumerate(found.response.parts):
        on_disc = -np.einsum("bi,bij->bj", part.pin_load, part.flank.gradient)
        resultant, moment = on_disc[:, X] + 1j * on_disc[:, Y], on_disc[:, DISC_ROTATION]
        place = model.discs[number].geometry.placement
        rotation = found.pose[:, model.coordinates.columns(number)[DISC_ROTATION]]
        arm = np.array(drive.crank.places) * np.exp(1j * rotation)[:, None]
        radius = drive.crank.circle_radius
        force = bearing_forces(model, ANGLES, found.response)[:, number] * place.eccentric_directions(ANGLES)
        left = (force + resultant[:, None] / cranks) / (arm / radius)
        size = np.abs(resultant).max()
        np.testing.assert_allclose(
            left.imag, (-moment / (cranks * radius))[:, None] * np.ones(cranks), atol=1e-5 * size
        )
        expected = -stiffness * radius * (1.0 - np.cos(rotation))[:, None] * np.ones(cranks)
        np.testing.assert_allclose(left.real, expected, atol=1e-5 * size)
        assert np.min(np.abs(moment)) > 1e3 * radius  # there is something to share


@pytest.mark.family(quick=1, full=3)
@pytest.mark.parametrize("name", KINDS)
def test_virtual_work_at_every_position(rv, name, unbalanced_work):
    np.testing.assert_allclose(unbalanced_work(kind(rv, name), ANGLES + 0.05), 0.0, atol=1e-7)


@pytest.mark.family(quick=1, full=3)
@pytest.mark.parametrize("name", KINDS)
def test_tangent_is_the_slope_of_the_force(rv, name, tangent_and_slope):
    scaled, slope = tangent_and_slope(kind(rv, name), ANGLES[:1])
    # differences of second order over 1e-7 mm: round-off of loads of 1e4 N by the step, and contacts that just open
    np.testing.assert_allclose(slope, scaled, rtol=0.0, atol=2e-6 * np.abs(scaled).max())


@pytest.mark.slow
@pytest.mark.parametrize("name", ["cranks", "holes"])
def test_numbering_of_the_cranks_is_a_matter_of_names(rv, name):
    """The first crank a pitch further on: the same drive with other numbers, rollers with theirs."""
    drive = with_fields(kind(rv, name), {"crank.of.1.eccentricity_error": 0.004, "crank.of.5.phase_error": 2e-3})
    pitch = 2.0 * np.pi / 3.0
    turned = with_fields(drive, {"crank.angle": drive.crank.angle + pitch})
    of = tuple(replace(entry, crank=(entry.crank - 1) % 3) for entry in drive.crank.of)
    turned = replace(turned, crank=replace(turned.crank, of=of))
    first, second = analyse(drive, ANGLES), analyse(turned, ANGLES)
    np.testing.assert_allclose(first.full.response.pin_load, second.full.response.pin_load, rtol=0.0, atol=LOAD)
    np.testing.assert_allclose(
        np.roll(first.bearing_tangential, -1, axis=2), second.bearing_tangential, rtol=0.0, atol=LOAD
    )
    assert np.ptp(first.bearing_tangential, axis=2).min() > 1e3 * LOAD


@pytest.mark.slow
def test_reverse_is_the_mirror_image(rv):
    drive = with_fields(kind(rv, "cranks"), {"crank.of.1.phase_error": 1e-3, "crank.of.2.phase_error": 2e-3})
    mirrored = {"load.direction": "cw", "crank.of.1.phase_error": -2e-3, "crank.of.2.phase_error": -1e-3}
    forward, reverse = analyse(drive, -ANGLES), analyse(with_fields(drive, mirrored), ANGLES)
    swapped = [0, 2, 1]  # cranks above and below the axis of the first
    np.testing.assert_allclose(
        forward.bearing_tangential, -reverse.bearing_tangential[..., swapped], rtol=0.0, atol=LOAD
    )
    np.testing.assert_allclose(forward.bearing_radial, reverse.bearing_radial[..., swapped], rtol=0.0, atol=LOAD)
    np.testing.assert_allclose(forward.transmission_error, -reverse.transmission_error, rtol=0.0, atol=1e-11)


@pytest.mark.slow
def test_stiff_supports_tend_to_rigid_ones(rv):
    """What supports add to the wheel's angle falls with their flexibility, in first order."""
    rigid = analyse(kind(rv, "rigid"), ANGLES).full.pose[:, WHEEL_ANGLE]

    def added(factor):
        modulus = {"materials.crankshaft.youngs_modulus": 206e3 * factor}
        support = replace(SUPPORT, stiffness=tuple(factor * k for k in SUPPORT.stiffness))
        drive = with_fields(kind(rv, "cranks"), modulus)
        drive = replace(drive, crank=replace(drive.crank, support=support))
        wheel = replace(drive.pin_wheel, support_stiffness=5e5 * factor)
        return analyse(replace(drive, pin_wheel=wheel), ANGLES).full.pose[:, WHEEL_ANGLE] - rigid

    # 1 % and 0.5 % of the flexibility: what is of second order is of that size
    np.testing.assert_allclose(added(100.0) / added(200.0), 2.0, rtol=0.02)
    assert np.all(np.abs(added(1.0)) > 1e-5)


@pytest.mark.slow
def test_crank_stiffness_belongs_to_the_planes_of_the_discs(rv):
    """Planes count where shafts bend: the farther apart, the farther an end moves when the shaft tilts on its bearings."""
    drive = kind(rv, "cranks")
    wide = with_fields(drive, {"disc.planes": (-15.0, 15.0)})
    assert np.linalg.norm(crank_stiffness(wide)) < np.linalg.norm(crank_stiffness(drive))
    moved = analyse(wide, ANGLES).transmission_error - analyse(drive, ANGLES).transmission_error
    assert np.all(np.abs(moved) > 1e-6)


def test_bore_errors_are_forced_on_the_cranks(rv):
    """A bore outward by d: its crank and the others carry it against each other, in first order in d."""
    drive = with_fields(kind(rv, "rigid"), {"clearance.bearing": 0.0})
    plain = analyse(drive, ANGLES).bearing_radial

    def change(size):
        errors = {
            "disc.of.0.bore_errors.radial": (size, 0.0, 0.0),
            "disc.of.0.bore_errors.tangential": (0.0, size, 0.0),
        }
        return analyse(with_fields(drive, errors), ANGLES).bearing_radial - plain

    small, double = change(1e-5), change(2e-5)
    # 10 and 20 nm beside approaches of some µm: what is of second order is a hundredth
    np.testing.assert_allclose(double, 2.0 * small, rtol=0.0, atol=0.02 * np.abs(double).max())
    assert np.abs(small[:, 0]).max() > np.abs(small[:, 1]).max()  # disc 1 feels it through the wheel alone


@pytest.mark.parametrize(
    ("cranks", "teeth", "alike"), [(2, 39, True), (3, 39, False), (4, 39, True), (2, 40, False), (3, 40, False)]
)
def test_equal_parts_by_counting(rv, cranks, teeth, alike):
    """Half a turn of phase is 1/2 + j z_C/s turns of the flank's pitch: whole for an even number of cranks and odd teeth."""
    drive = replace(
        rv,
        crank=replace(rv.crank, number=cranks),
        disc=replace(rv.disc, number_of_teeth=teeth),
        pin_wheel=replace(rv.pin_wheel, number_of_pins=teeth + 1),
    )
    counted = any(abs((0.5 + j * teeth / cranks) % 1.0) < 1e-9 for j in range(cranks))
    assert equal_parts(drive) == counted == alike


@pytest.mark.parametrize("hole", [0, 1, 2])
def test_bores_stand_clear_of_every_hole(rv, hole):
    """Three bores on 42 mm, holes every 120° on 45 mm: d² = 42² + 45² − 2·42·45 cos of the angle between them."""
    drive, reach = kind(rv, "holes"), 9.26 + 0.005 + 18.0 + 0.0025  # radii and half of the clearances
    touch = np.degrees(np.arccos((42.0**2 + 45.0**2 - reach**2) / (2.0 * 42.0 * 45.0)))  # 36.3°
    for side in (touch, -touch):
        beyond, within = 120.0 * hole + side * 1.001, 120.0 * hole + side * 0.999
        with_fields(drive, {"crank.angle": float(np.radians(beyond))})
        with error_says(DriveError, "a bore and a hole ", " cut into each other"):
            with_fields(drive, {"crank.angle": float(np.radians(within))})
    distance = np.sqrt(42.0**2 + 45.0**2 - 2.0 * 42.0 * 45.0 * np.cos(np.radians(25.0)))
    with pytest.raises(DriveError) as caught:
        with_fields(drive, {"crank.angle": float(np.radians(120.0 * hole + 25.0))})
    assert f"cut into each other by {reach - distance:.6g} mm" in str(caught.value)


@pytest.mark.family(quick=1)
@pytest.mark.parametrize("name", ["cranks", "wheel", "central crank yields"])
def test_shares_of_the_compliance(rv, name):
    """∂c/∂ ln k of a support is −share · c: the compliance of the wheel's angle from the tangent, its supports stiffened."""
    drive = kind(rv, name)
    found = analyse(drive, ANGLES)
    shares, step = found.compliance_shares, 1e-4
    np.testing.assert_allclose(sum(shares.values()), 1.0, rtol=1e-12)
    tangent, whole = found.full.response.tangent, found.model.supports.matrix
    columns = np.zeros(tangent.shape[1], dtype=bool)
    columns[found.model.coordinates.wheel_place] = True

    def compliance(part, factor):
        of = np.outer(columns, columns) if part == "wheel_bearing" else ~np.outer(columns, columns)
        return np.linalg.inv(tangent + (factor - 1.0) * whole * of)[:, WHEEL_ANGLE, WHEEL_ANGLE]

    for part in ("cranks", "wheel_bearing"):
        slope = (compliance(part, 1.0 + step) - compliance(part, 1.0 - step)) / (2.0 * step)
        # differences of second order over 1e-4: 1e-8, and loads that follow 1e-4 of the torque not quite in line
        np.testing.assert_allclose(shares[part], -slope / compliance(part, 1.0), atol=1e-6)
    # two discs half a turn apart hardly push the wheel aside; ten times the tolerance
    assert max(shares["cranks"].max(), shares["wheel_bearing"].max()) > 1e-5
    assert abs(shares["geometry"]).max() < 0.01


@pytest.mark.parametrize(
    ("old", "new", "path", "value", "said"),
    [
        (
            "inner_race_radius = 13.0",
            "inner_race_radius = 14.0",
            "crank_bearing.roller_radius",
            "= 2.5 mm",
            "must be at most 2 mm",  # (18 − 14) / 2
        ),
        pytest.param(
            "\npin_radius = 3.0",
            "\npin_radius = 9.0",
            "pin_wheel.pin_radius",
            "= 9 mm",
            "must be less than 6.27673 mm",
            marks=pytest.mark.slow,
        ),
        pytest.param(
            "circle_radius = 42.0 ",
            "circle_radius = 62.0 ",
            "crank.circle_radius",
            "= 62 mm",
            "bores cut through the root",
            marks=pytest.mark.slow,
        ),
    ],
)
def test_causes_are_looked_for_without_a_pin_shaft(old, new, path, value, said):
    """Fields of a part that the drive has not were read ("unforeseen AttributeError")."""
    text = shipped_drive("rv")
    assert old in text
    with refused_field(path, value, said):
        parse_drive(text.replace(old, new), "rv")
