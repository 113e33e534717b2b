"""What must not change an answer in slices: sense of the axis, of the crank, numbers of parts, units, and whose slope it is."""

from dataclasses import replace

import numpy as np
import pytest

from ltca.analysis.engines import HalfSpace
from ltca.drive.parts import Inclination, PlacementErrors
from ltca.equilibrium.output_torque import solve_at_output
from ltca.mechanics.contacts import ContactSystem
from ltca.reading.drive_file import build_drive, load_drive

ANGLES = np.array([0.4, 2.9])
SAME = 1e-9
"""Of the largest load or lean: what a balance leaves over, 1e-9 of the load."""
WIDTH = {
    "contact.slices": 5,
    "disc.lead_crown_drop": 0.002,
    "disc.lead_slope": 2e-4,
    "crank.inclination": {"x": 2e-4, "y": -1e-4},
    "pin_wheel.inclination": {"x": -3e-4, "y": 1e-4},
    "pin_shaft.inclination": {"x": 1e-4, "y": 4e-4},
}


def tilted(**fields):
    return load_drive("paper").cases["CS-6"].with_fields(WIDTH | fields)


def balance(drive, angles=ANGLES):
    model = HalfSpace().prepare(drive).model
    found = solve_at_output(model, [drive], angles, drive.load.torque)
    return found, found.pose[:, model.coordinates.lean_place]


def kinds(found):
    part = found.response.parts[0]
    pins, holes, rollers = part.leaning_pins.contact, part.leaning_holes.contact, part.rollers.leaning
    return {
        "pins": pins.slice_load, "holes": holes.slice_load, "outer": rollers.outer.slice_load,
        "inner": rollers.inner.slice_load,
    }  # fmt: skip


def check_same(first, second, turned=lambda name, load: load):
    for name, load in kinds(first).items():
        other = turned(name, kinds(second)[name])
        np.testing.assert_allclose(other, load, atol=SAME * np.max(load), err_msg=name)


def opposite(given, x=-1.0, y=-1.0):
    return {"x": x * given["x"], "y": y * given["y"]}


def test_mirrored_along_the_axis():
    """Slopes and leans change sign, loads of slices change places."""
    turned = {name: opposite(WIDTH[name]) for name in WIDTH if name.endswith("inclination")}
    (first, lean), (second, other) = balance(tilted()), balance(tilted(**turned, **{"disc.lead_slope": -2e-4}))
    check_same(first, second, lambda name, load: load[..., ::-1])
    np.testing.assert_allclose(other, -lean, atol=SAME * np.max(np.abs(lean)))
    assert np.max(np.abs(lean)) > 1e-5


@pytest.mark.slow
def test_reversed_and_mirrored_in_the_plane():
    """The mirror at the x axis turns the crank the other way; y of leans changes sign, and x of rotations."""
    turned = {name: opposite(WIDTH[name], y=1.0) for name in WIDTH if name.endswith("inclination")}
    (first, lean) = balance(tilted(), -ANGLES)
    (second, other) = balance(tilted(**turned, **{"load.direction": "cw"}))
    check_same(first, second, lambda name, load: load[:, -np.arange(load.shape[1]) % load.shape[1]])
    np.testing.assert_allclose(other, lean * [1.0, -1.0], atol=SAME * np.max(np.abs(lean)))


@pytest.mark.slow
def test_turned_by_a_hole_pitch(paper_table):
    """With 12 teeth, 6 holes and 10 rollers on a cage of speed 0.4 a turn by 60° moves the numbers of pins by 2, of holes and of
    rollers by 1; inclined axes turn with it.
    """
    drive = build_drive(
        paper_table(
            pin_wheel={"number_of_pins": 13},
            disc={"number_of_teeth": 12},
            pin_shaft={"number_of_pins": 6},
            crank_bearing={"inner_race_radius": 20.0, "outer_race_radius": 30.0, "number_of_rollers": 10},
            clearance={"bearing": 0.02, "pin_hole": 0.02},
        )
    ).with_fields(WIDTH)
    turn = np.exp(2j * np.pi / 6.0)

    def moved(part):
        lean = part.inclination.lean * turn
        return replace(part, inclination=Inclination(x=-lean.imag, y=lean.real))

    other = replace(drive, crank=moved(drive.crank), pin_wheel=moved(drive.pin_wheel), pin_shaft=moved(drive.pin_shaft))
    (first, lean), (second, leaned) = balance(drive), balance(other, ANGLES + 2.0 * np.pi / 6.0)
    by = {"pins": 2, "holes": 1, "outer": 1, "inner": 1}
    check_same(first, second, lambda name, load: np.roll(load, -by[name], axis=1))
    first_lean, second_lean = (each[:, 0] + 1j * each[:, 1] for each in (lean, leaned))
    np.testing.assert_allclose(second_lean, first_lean * turn, atol=SAME * np.max(np.abs(lean)))


@pytest.mark.slow
def test_units_of_length_and_stress():
    """The same drive in a unit of 25 mm, and of 1/70 MPa: loads in their unit, leans as they are."""
    length, stress, plain = 0.04, 70.0, tilted()

    def scaled(part, **fields):
        return replace(part, **{name: getattr(part, name) * factor for name, factor in fields.items()})

    mm = length
    other = replace(
        plain,
        crank=scaled(plain.crank, eccentricity=mm),
        pin_wheel=scaled(plain.pin_wheel, pin_circle_radius=mm, pin_radius=mm),
        disc=scaled(plain.disc, thickness=mm, equidistant_offset=mm, shifting_offset=mm, lead_crown_drop=mm),
        crank_bearing=scaled(plain.crank_bearing, inner_race_radius=mm, outer_race_radius=mm, roller_radius=mm),
        pin_shaft=scaled(plain.pin_shaft, pin_circle_radius=mm, pin_radius=mm, hole_radius=mm, stiffness=stress * mm),
        clearance=scaled(plain.clearance, bearing=mm, pin_hole=mm),
        load=scaled(plain.load, torque=stress * mm**3, light_torque=stress * mm**3),
        materials=replace(
            plain.materials,
            **{
                name: scaled(getattr(plain.materials, name), youngs_modulus=stress)
                for name in ("disc", "wheel_pin", "roller", "inner_race", "shaft_pin")
            },
        ),
    )
    if plain.crank_bearing.roller_length is not None:
        longer = plain.crank_bearing.roller_length * mm
        other = replace(other, crank_bearing=replace(other.crank_bearing, roller_length=longer))
    (first, lean), (second, leaned) = balance(plain), balance(other)
    check_same(first, second, lambda name, load: load / (stress * mm**2))
    np.testing.assert_allclose(leaned, lean, atol=SAME * np.max(np.abs(lean)))


def test_a_slope_of_the_flank_is_one_of_every_pin_along_its_normal():
    """At one position: whether the disc has the slope, or every pin leans along the normal of its own contact."""
    angle = ANGLES[:1]
    sloped = tilted(**{"disc.lead_slope": 3e-4})
    first, lean = balance(sloped, angle)
    part, wheel = first.response.parts[0], sloped.pin_wheel
    normal = part.flank.gradient[0, :, 0] + 1j * part.flank.gradient[0, :, 1]
    turned = np.exp(1j * (angle[0] / wheel.number_of_pins + first.pose[0, -1]))
    own = -3e-4 * normal * np.conj(turned)
    errors = PlacementErrors(inclination_x=tuple((-own.imag).tolist()), inclination_y=tuple(own.real.tolist()))
    other = replace(sloped, pin_wheel=replace(wheel, pin_errors=errors), disc=replace(sloped.disc, lead_slope=0.0))
    second, leaned = balance(other, angle)
    check_same(first, second)
    np.testing.assert_allclose(leaned, lean, atol=SAME * np.max(np.abs(lean)))
    straight, _ = balance(replace(sloped, disc=replace(sloped.disc, lead_slope=0.0)), angle)
    assert np.max(np.abs(kinds(straight)["pins"] - kinds(first)["pins"])) > 1e-2 * np.max(kinds(first)["pins"])


@pytest.mark.family(quick=1)
@pytest.mark.parametrize("held", ["pin-shaft", "pin-wheel"])
def test_work_of_a_small_turn_of_the_wheel_is_that_of_its_moment(held):
    """Energies of all contacts at neighbouring wheel angles, all else held: their slope is the moment, as they are in balance.

    2e-4: contacts on a flank change radius as they slip, which is no force (1e-4, as in the plane), and differences.
    """
    drive = tilted(**{"installation.held": held})
    model = HalfSpace().prepare(drive).model
    found = solve_at_output(model, [drive], ANGLES[:1], drive.load.torque)

    def energy(pose):
        at, disc = ContactSystem(model).respond(ANGLES[:1], pose, None, roughly=False), model.discs[0]
        pins, _, holes, _ = at.slices_after(0)
        on_pins = disc.pin_law.energy(pins, at.discs[0].flank.effective_radius)
        return float(on_pins.sum() + disc.hole_law.energy(holes, 0.0).sum())

    ends = []
    for side in (1.0, -1.0):
        pose = found.pose.copy()
        pose[0, -1] += side * 1e-7
        ends.append(energy(pose))
    # Rollers do not see the wheel.
    slope = (ends[0] - ends[1]) / 2e-7
    assert slope == pytest.approx(float(found.wheel_moment[0]), rel=2e-4)
