"""Pins in slices: beams that slope under the discs, inclined pins, loose pins and sleeves."""

from dataclasses import replace

import numpy as np
import pytest

from ltca.analysis.engines import HalfSpace
from ltca.compliance.response import Start, bearing_pushes
from ltca.drive.parts import PlacementErrors, ShaftPinBeam, WheelPinBeam
from ltca.equilibrium.balance import lever_arms
from ltca.equilibrium.output_torque import solve_at_output
from ltca.laws.separate_slices import SeparateSlices
from ltca.laws.spring import SpringLaw
from ltca.reading.drive_file import load_drive

SLICES = 9
ANGLES = np.array([0.3, 2.0])


def in_slices(*, discs=1, shaft=None, wheel=None, **fields):
    """The paper's drive with its contacts in slices and some pins as beams."""
    drive = load_drive("paper").cases["CS-1"]
    if shaft is not None:
        beam = ShaftPinBeam(span=30.0, **shaft)
        drive = replace(drive, pin_shaft=replace(drive.pin_shaft, stiffness=None, beam=beam))
    if wheel is not None:
        drive = replace(drive, pin_wheel=replace(drive.pin_wheel, beam=WheelPinBeam(span=30.0, **wheel)))
    drive = replace(drive, disc=replace(drive.disc, number_of_discs=discs, gap=2.0))
    return drive.with_fields({"contact.slices": SLICES} | fields)


def balance(drive, angles=ANGLES):
    model = HalfSpace().prepare(drive).model
    return model, solve_at_output(model, [drive], angles, drive.load.torque)


def cantilever(length, width, diameter, modulus, ratio):
    """Flexibility of a cantilever, clamped at zero, under an even load on the width about `length` and a moment there, by the
    theorem of unit loads.
    """
    rigidity = modulus * np.pi * diameter**4 / 64.0
    factor = 6.0 * (1.0 + ratio) / (7.0 + 6.0 * ratio)
    shear = factor * modulus / (2.0 * (1.0 + ratio)) * np.pi * diameter**2 / 4.0
    nodes, weights = np.polynomial.legendre.leggauss(8)
    edges = np.array([0.0, length - 0.5 * width, length + 0.5 * width])
    halves = 0.5 * np.diff(edges)[:, None]
    z, weights = (edges[:-1, None] + halves + halves * nodes).ravel(), (halves * weights).ravel()
    low, high = np.clip(z - length, -0.5 * width, None), 0.5 * width
    force = np.stack([(high - low) / width, 6.0 * (high**2 - low**2) / width**3])
    moment = np.stack([(high**2 - low**2) / (2.0 * width), 4.0 * (high**3 - low**3) / width**3]) + (length - z) * force
    return (moment * weights) @ moment.T / rigidity + (force * weights) @ force.T / shear


def test_cantilever_pins_slope_by_hand():
    """Springs even along the width on cantilever pins, all else as it stands: F = k (δ − u), M = −k w²/12 s, (u, s) of the beam.

    Nothing but round-off apart, 1e-9 of the largest: all springs are pressed along the whole width.
    """
    drive = in_slices(shaft={"tip": "free"})
    shaft, width = drive.pin_shaft, drive.disc.thickness
    model = HalfSpace().prepare(drive).model
    spring, stiffness = 1.0e6, np.diag([1.0e6, 1.0e6 * width**2 / 12.0])
    relief = np.zeros((SLICES, 4))
    law = SeparateSlices(law=SpringLaw(stiffness=spring), length=width, slices=SLICES, relief=relief)
    model = replace(model, discs=tuple(replace(disc, hole_law=law) for disc in model.discs))
    pose = np.zeros((1, model.coordinates.size))
    pose[:, 2] = 2e-4
    found = model.respond(ANGLES[:1], pose)
    # What the pins were pressed in by if they stood still.
    pressed = model.geometries[0].holes(ANGLES[:1], pose).approach[0]
    closed = found.hole_load[0] > 0.0
    assert closed.sum() >= 3
    contact = found.parts[0].leaning_holes.contact
    material = drive.materials.shaft_pin
    beam = cantilever(15.0, width, 2.0 * shaft.pin_radius, material.youngs_modulus, material.poisson_ratio)
    given = np.stack((spring * pressed[closed], np.zeros(closed.sum())))
    by_hand = np.linalg.solve(np.eye(2) + stiffness @ beam, given)
    assert np.all(np.abs(by_hand[1]) < width * by_hand[0] / 6.0), "a spring pulls at an end"
    np.testing.assert_allclose(contact.load[0, closed], by_hand[0], rtol=1e-9)
    np.testing.assert_allclose(contact.moment[0, closed], by_hand[1], rtol=1e-9)
    # Towards the clamped end, where the pin yields least.
    assert np.all(by_hand[1] < 0.0)


def test_a_disc_in_the_middle_of_symmetric_pins_does_not_tilt():
    """Wheel pins between two walls, one disc in the middle: no lean and no moment but round-off."""
    drive = in_slices(wheel={"ends": "supported"})
    model, found = balance(drive)
    lean = found.pose[:, model.coordinates.lean_place]
    pins = found.response.parts[0].leaning_pins.contact
    assert np.max(np.abs(lean)) < 1e-13
    assert np.max(np.abs(pins.moment)) < 1e-9 * np.max(pins.load)
    assert np.max(np.abs(found.response.parts[0].leans)) < 1e-13


@pytest.mark.slow
def test_half_a_turn_with_the_mirror_takes_one_disc_to_the_other():
    """Two equal discs, even numbers of pins and rollers, wheel pins between two walls: what one disc has at z the other has half
    a turn further at −z; tilts are equal in the fixed frame. 1e-9 of the largest load: what the balance leaves over.
    """
    drive = in_slices(discs=2, wheel={"ends": "supported"}, **{"crank_bearing.number_of_rollers": 12})
    model, found = balance(drive)
    first, second = found.response.parts
    for name in ("leaning_pins", "leaning_holes"):
        one, other = (getattr(part, name).contact for part in (first, second))
        pairs = one.load.shape[1]
        largest = np.max(one.slice_load)
        there = np.roll(other.slice_load, pairs // 2, axis=1)[..., ::-1]
        np.testing.assert_allclose(one.slice_load, there, atol=1e-9 * largest)
        assert np.max(np.abs(one.slice_load - one.slice_load[..., ::-1])) > (
            1e-3 * largest if name == "leaning_pins" else 0.0
        )
    # Rollers are counted from the eccentric of their disc.
    one, other = (part.rollers.leaning.outer.slice_load for part in (first, second))
    np.testing.assert_allclose(one, other[..., ::-1], atol=1e-9 * np.max(one))
    places = [model.coordinates.columns(number)[model.coordinates.lean_place] for number in (0, 1)]
    leans = [found.pose[:, place] for place in places]
    assert np.max(np.abs(leans[0])) > 1e-6
    np.testing.assert_allclose(leans[0], leans[1], atol=1e-9 * np.max(np.abs(leans[0])))


@pytest.mark.family(quick=1)
@pytest.mark.parametrize(
    ("discs", "shaft", "wheel"),
    [(1, {"tip": "free"}, None), (1, {"tip": "tied-clamped"}, None), (2, {"tip": "free"}, {"ends": "supported"})],
)
def test_the_tangent_is_that_of_the_force_with_sloping_pins(discs, shaft, wheel):
    """Differences of the force against the tangent, by the roots of its diagonal: 3e-4, the effective radius that follows the
    pose (1e-4, as in the plane) and differences.
    """
    model, found = balance(in_slices(discs=discs, shaft=shaft, wheel=wheel), ANGLES[:1])
    start, tangent = Start.after(found.response), None
    tangent = model.respond(ANGLES[:1], found.pose, start).tangent[0]
    scale, steps = np.sqrt(np.diag(tangent)), np.full(tangent.shape[0], 1e-8)
    for coordinate, step in enumerate(steps):
        sides = []
        for side in (1.0, -1.0):
            pose = found.pose.copy()
            pose[:, coordinate] += side * step
            sides.append(model.respond(ANGLES[:1], pose, start).force[0])
        slope = (sides[0] - sides[1]) / (2.0 * step)
        off = (slope - tangent[:, coordinate]) / (scale * scale[coordinate])
        assert np.max(np.abs(off)) < 3e-4, coordinate


def test_inclined_parts_tilt_pairs_as_their_places_do():
    """Every kind of inclination at once on the second of two discs: the gap at ±z with pin and disc moved there as rigid bodies.

    Wheel pins stand inclined in the wheel and turn with it, holes in the disc, shaft pins and the axes in the fixed frame. Gaps
    bend along the width by z² alone, so that half the difference of two sides is θ z to 1e-6 of it.
    """
    rng = np.random.default_rng(8)

    def errors(count):
        return PlacementErrors(
            inclination_x=tuple(rng.normal(size=count) * 1e-3), inclination_y=tuple(rng.normal(size=count) * 1e-3)
        )

    drive = in_slices(
        discs=2,
        **{
            "pin_wheel.inclination": {"x": 3e-4, "y": -2e-4},
            "pin_shaft.inclination": {"x": -1e-4, "y": 5e-4},
        },
    )
    drive = replace(
        drive,
        pin_wheel=replace(drive.pin_wheel, pin_errors=errors(14)),
        pin_shaft=replace(drive.pin_shaft, pin_errors=errors(8)),
        disc=replace(drive.disc, hole_errors=errors(8)),
    )
    geometry = HalfSpace().prepare(drive).model.geometries[1]
    plane, angle = drive.disc.disc_planes[1], np.array([1.1])
    pose = np.zeros((1, geometry.coordinates.size))
    pose[0, :3], pose[0, -1] = [2e-3, -1e-3, 1e-3], -3e-3
    lean = 4e-4 - 7e-4j
    pose[0, geometry.coordinates.lean_place] = lean.real, lean.imag
    flank, holes = geometry.flank(angle, pose), geometry.holes(angle, pose)
    tilts = geometry.flank_tilt(angle, pose, flank).tilt[0], geometry.hole_tilt(pose, holes).tilt[0]

    def own(given):
        return np.array(given.inclination_y) - 1j * np.array(given.inclination_x)

    def axis(z, given):
        return z * (given.y - 1j * given.x)

    wheel, shaft = drive.pin_wheel, drive.pin_shaft
    turned = np.exp(1j * (angle[0] / 14.0 + pose[0, -1]))
    rays = {count: np.exp(2j * np.pi * np.arange(count) / count) for count in (8, 14)}
    centre = 4.0 * np.exp(1j * (angle[0] + np.pi)) + pose[0, 0] + 1j * pose[0, 1]
    place = np.linspace(0.0, 2.0 * np.pi, 400_001)
    outline = geometry.profile.flank(place[None])[0]

    def gaps(z):
        """Approaches at the height z above the middle of the disc."""
        disc, height = centre + lean * z, plane + z
        pin = axis(height, wheel.inclination) + turned * (88.0 * rays[14] + own(wheel.pin_errors) * height)
        seen = (pin - disc) * np.exp(-1j * pose[0, 2])
        nearest = []
        for point in seen:
            away = np.abs(outline - point)
            least = int(np.argmin(away))
            left, middle, right = away[least - 1], away[least], away[(least + 1) % place.size]
            nearest.append(middle - (left - right) ** 2 / (8.0 * (left + right - 2.0 * middle)))
        stands = 56.0 * rays[8] + (own(shaft.pin_errors) * height) + axis(height, shaft.inclination)
        hole = disc + np.exp(1j * pose[0, 2]) * (56.0 * rays[8] + own(drive.disc.hole_errors) * z)
        return 6.5 - np.array(nearest), np.abs(stands - hole)

    above, below = gaps(0.5), gaps(-0.5)
    for tilt, high, low in zip(tilts, above, below, strict=True):
        assert np.max(np.abs(tilt)) > 3e-4
        np.testing.assert_allclose(high - low, tilt, atol=2e-9)
    # The same gaps in the middle: inclined parts stand where they stand at the height of the disc.
    at, hole = gaps(0.0)
    np.testing.assert_allclose(at, flank.approach[0], atol=1e-9)
    np.testing.assert_allclose(hole - (14.075 - 10.075), holes.approach[0], atol=1e-12)


def test_forces_on_pins_and_rollers_balance_a_disc_that_tilts():
    """Forces of a leaning disc on its pins, told apart from its generalised forces, less those of its bearing: nothing but what
    the balance leaves over, 1e-5 N. Without the force across of moments on turning normals a hundredth of a newton is left.
    """
    inclination = {"pin_wheel.inclination": {"x": 3e-4, "y": -2e-4}}
    _, found = balance(in_slices(discs=2, shaft={"tip": "free"}, wheel={"ends": "supported"}, **inclination))
    for part in found.response.parts:
        left = part.pin_forces.sum(axis=1) - bearing_pushes(part.rollers, 1).sum(axis=1)
        assert np.max(np.abs(left)) < 1e-5
        assert np.max(np.abs(part.leaning_pins.tilt.tilt)) > 1e-5


def test_pins_that_slope_on_a_ring_follow_the_pose():
    """The force along two directions by differences of fourth order, with seats in the ring, beams and leans."""
    ring = {"ring.inner_radius": 88.0, "ring.outer_radius": 120.0, "ring.width": 30.0}
    drive = in_slices(shaft={"tip": "tied-pinned"}, wheel={"ends": "supported"}, **ring)
    model, found = balance(drive, ANGLES[:1])
    start, lever = Start.after(found.response), np.broadcast_to(lever_arms(model), found.pose.shape)
    tangent = model.whole_tangent(ANGLES[:1], found.pose, start, lever)[0] / lever / lever.T
    for direction in np.random.default_rng(2).normal(size=(2, lever.shape[1])):
        step = 5e-7 * direction / lever
        by_steps = [
            weight * model.respond(ANGLES[:1], found.pose + steps * step, start).force[0] / lever[0]
            for weight, steps in ((1.0, -2.0), (-8.0, -1.0), (8.0, 1.0), (-1.0, 2.0))
        ]
        expected = sum(by_steps) / 12.0 / 5e-7
        np.testing.assert_allclose(tangent @ direction, expected, atol=1e-7 * np.max(np.abs(expected)))


def test_without_tilt_slices_on_a_ring_are_the_plane():
    """The ring alone tilts nothing: the wheel turns as in the plane, to 0.2″, loads to 0.5 % (the bounds of a straight line)."""
    ring = {"ring.inner_radius": 88.0, "ring.outer_radius": 120.0, "ring.width": 30.0}
    found = [balance(in_slices(**ring, **{"contact.slices": slices}))[1] for slices in (1, SLICES)]
    assert np.max(np.abs(found[0].pose[:, -1] - found[1].pose[:, -1])) < np.deg2rad(0.2 / 3600.0)
    loads = [each.response.pin_load for each in found]
    np.testing.assert_allclose(loads[0], loads[1], atol=5e-3 * np.max(loads[0]))
