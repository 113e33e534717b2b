"""Contacts in slices on solid bodies: tilts by moments beside approaches by loads, against closed forms and own iterations."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad

from ltca.compliance.coefficients import _coefficients_of_dataset
from ltca.compliance.coupled import CoupledCompliance
from ltca.compliance.near_field import projected_on_half_space
from ltca.compliance.response import Start
from ltca.contact.free_end import FreeEnds, guilbault_factor
from ltca.drive.members.temperatures import warm_drive
from ltca.drive.single_discs import single_discs
from ltca.equilibrium.output_torque import solve_at_output
from ltca.equilibrium.reducer import Reducer
from ltca.geometry.pair_motion import dot
from ltca.mechanics.contacts import ContactSystem
from ltca.mechanics.energy import stored_by_disc
from ltca.reading.drive_file import load_drive
from ltca.testing.closed_form_bodies import CROSS_SHARE, closed_form_coefficients
from ltca.testing.slice_law import _kernel
from ltca.testing.width_check import Taken, WidthCheck

SLICES, ANGLES = 3, np.array([0.5])
DEPTH, TILT_DEPTH, HALF_WIDTH = 300.0, 260.0, 0.05
TILTED = {
    "contact.slices": SLICES, "disc.lead_slope": 1e-4, "disc.lead_crown_drop": 0.002,
    "pin_wheel.inclination": {"x": 3e-4, "y": 2e-4}, "crank_bearing.roller_length": 10.0,
}  # fmt: skip
NEAR_FIELDS = [pytest.param("plane-strain", marks=pytest.mark.slow), "half-space"]


def paper(**fields):
    """The paper's drive with everything tilted."""
    return load_drive("paper").cases["CS-3"].with_fields(TILTED | fields)


def solid(drive, tilt_depth=TILT_DEPTH):
    """Coefficients of solid bodies in closed form."""
    data = closed_form_coefficients(drive, half_width=HALF_WIDTH, depth=DEPTH, tilt_depth=tilt_depth)
    return _coefficients_of_dataset(data, drive, shared=False)


def plane(drive):
    """Those of plane ones."""
    data = closed_form_coefficients(drive, half_width=HALF_WIDTH, depth=DEPTH)
    return _coefficients_of_dataset(data, drive, shared=False)


def tilting_scaled(model, scale):
    """A model of one disc with all its tilts by moments changed."""
    even, tilting = model.bodies
    body = tilting.coefficients
    every = {name: scale * getattr(body, name) for name in ("disc", "pin", "roller", "race")}
    every |= {f"{name}_logarithm": scale * getattr(body, f"{name}_logarithm") for name in every}
    own = {name: scale * getattr(tilting, name) for name in ("alone", "race")}
    return replace(model, bodies=(even, replace(tilting, coefficients=replace(body, **every), **own)))


def balanced(drive, disc, angles=ANGLES):
    """Reducer of one disc and its equilibrium."""
    model = Reducer.of_drive(drive, [disc])
    return model, solve_at_output(model, [drive], angles, drive.load.torque)


def drive_for(kind):
    """The tilted drive that a near field takes."""
    return paper() if kind == "half-space" else paper(**{"crank_bearing.roller_length": 11.8})


@pytest.mark.family(quick=1)
@pytest.mark.parametrize("ratio", [0.004, 0.05, 0.3])
def test_what_a_half_space_yields_under_even_and_linear_loads(ratio):
    """Closed forms against the double integral of Boussinesq's kernel over width and patch, 1e-7 (adaptive quadrature)."""
    t, b = 12.0, 12.0 * ratio
    nodes, weights = np.polynomial.legendre.leggauss(60)

    def over_width(apart, shape):
        """∫ shape(s)/√(s² + ξ²) ds with s = ξ sinh u, which takes the peak of the kernel out."""
        top = np.arcsinh(t / apart)
        return 0.5 * top * float(shape(apart * np.sinh(0.5 * top * (1.0 + nodes))) @ weights)

    def over_patch(shape):
        angle = np.pi * np.arange(1, 41) / 41
        total = 0.0
        for x, weight in zip(b * np.cos(angle), 2.0 / 41 * np.sin(angle) ** 2, strict=True):
            # x′ = x ± v² b takes the logarithm at x′ = x out.
            for side in (1.0, -1.0):
                reach = np.sqrt(1.0 - side * x / b)

                def of_place(v, x=x, side=side):
                    share = np.sqrt(max(1.0 - (x / b + side * v**2) ** 2, 0.0)) * 2.0 / np.pi
                    return share * over_width(b * v**2, shape) * 2.0 * v

                total += weight * quad(of_place, 0.0, reach, epsabs=0.0, epsrel=1e-9)[0]
        return total

    even = 2.0 / t**2 * over_patch(lambda s: t - s)
    linear = 2.0 * (12.0 / t**3) ** 2 * over_patch(lambda s: (t - s) ** 3 / 12.0 - s**2 * (t - s) / 4.0)
    np.testing.assert_allclose(projected_on_half_space(t, b), np.array([even, linear]) / np.pi, rtol=1e-7)


def test_slices_of_the_law_hold_what_is_taken_off():
    """Plane strain and Love's strips of 33 slices without softer ends, projected on even and linear loads.

    Means over strips are exact of an even load; a linear one is stairs, off by some 1/n² = 1e-3. The strips are 0.873 b wide and
    not semi-elliptic, by which distances across differ by a hundredth: 0.006 b/t.
    """
    t, b, n = 12.0, 0.06, 33
    size = t / n
    kernel = _kernel(n)(np.log(b / size))
    lag = np.abs(np.arange(n)[:, None] - np.arange(n))
    z = (np.arange(n) - n // 2) * size
    even, linear = np.full(n, 1.0 / n), z / (z**2).sum()
    # V = ½ Fᵀ a F/(π E* l): displacement by load is a/(π E* l), E* that of one body here.
    found = np.array([load @ kernel[lag] @ load for load in (even, linear)]) / (np.pi * size)
    expected = np.array(projected_on_half_space(t, b))
    np.testing.assert_allclose(found[0], expected[0], rtol=1e-4)
    np.testing.assert_allclose(found[1], expected[1], rtol=2e-3)


@pytest.mark.parametrize("kind", NEAR_FIELDS)
def test_no_tilt_by_moments_is_the_plane(kind):
    """Solid coefficients whose C' is zero give what bodies without any give: round-off of larger matrices, 1e-12."""
    drive = drive_for(kind)
    disc = tilting_scaled(CoupledCompliance.of_drive(drive, solid(drive), kind), 0.0)
    alone = replace(disc, bodies=disc.bodies[:1])
    _, found = balanced(drive, disc)
    _, expected = balanced(drive, alone)
    np.testing.assert_allclose(found.pose, expected.pose, rtol=0.0, atol=1e-12)
    for name in ("pin_load", "hole_load"):
        one, other = getattr(found.response, name), getattr(expected.response, name)
        np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-9 * other.max())


def test_even_parts_of_plane_bodies_give_plane_answers():
    """Plane strain takes the same off plane and solid bodies: with C' = 0 and rollers as long as the disc both are one."""
    drive = drive_for("plane-strain")
    disc = tilting_scaled(CoupledCompliance.of_drive(drive, solid(drive), "plane-strain"), 0.0)
    _, found = balanced(drive, disc)
    _, expected = balanced(drive, CoupledCompliance.of_drive(drive, plane(drive), "plane-strain"))
    np.testing.assert_allclose(found.pose, expected.pose, rtol=0.0, atol=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("kind", NEAR_FIELDS)
def test_the_plane_model_takes_the_even_part_alone(kind):
    """One slice: loads with solid coefficients are the same whatever C' is."""
    drive = load_drive("paper").cases["CS-3"]
    _, found = balanced(drive, CoupledCompliance.of_drive(drive, solid(drive), kind))
    _, other = balanced(drive, CoupledCompliance.of_drive(drive, solid(drive, 150.0), kind))
    np.testing.assert_array_equal(found.pose, other.pose)
    if kind == "plane-strain" and drive.roller_length == drive.disc.thickness:
        _, flat = balanced(drive, CoupledCompliance.of_drive(drive, plane(drive), kind))
        np.testing.assert_allclose(found.pose, flat.pose, rtol=0.0, atol=1e-13)


@pytest.mark.parametrize("kind", NEAR_FIELDS)
def test_the_tangent_is_that_of_the_force(kind, hold_coefficients):
    """Differences of the force against the tangent, as for plane bodies: 2e-4 of its largest entry, symmetric to round-off."""
    drive = drive_for(kind)
    model, found = balanced(drive, CoupledCompliance.of_drive(drive, solid(drive), kind))
    pose, start = found.pose, Start.after(found.response)
    hold_coefficients()
    tangent = model.respond(ANGLES, pose, start).tangent[0]
    disc = drive.disc.thickness
    lever = np.array([1.0, 1.0, drive.pin_shaft.pin_circle_radius, disc, disc, drive.pin_wheel.pin_circle_radius])
    numeric = np.empty_like(tangent)
    for column, arm in enumerate(lever):
        ends = []
        for side in (1.0, -1.0):
            moved = pose.copy()
            moved[0, column] += side * 1e-6 / arm
            ends.append(model.respond(ANGLES, moved, start).force[0])
        numeric[:, column] = (ends[0] - ends[1]) / (2e-6 / arm)
    scale = np.outer(lever, lever)
    largest = np.max(np.abs(tangent / scale))
    np.testing.assert_allclose(numeric / scale, tangent / scale, atol=2e-4 * largest)
    np.testing.assert_allclose(tangent / scale, (tangent / scale).T, atol=1e-12 * largest)


def displaced(model, pin, approach, tilt):
    """The same drive with one wheel pin pressed further into the flank, mm, and leaning further along its normal, rad."""
    (disc,) = model.discs
    place = disc.geometry.placement
    centres, leans = place.wheel_pin_centres.copy(), place.wheel_pin_leans.copy()
    centres[pin] += approach
    leans[pin] += tilt
    moved = replace(place, wheel_pin_centres=centres, wheel_pin_leans=leans)
    contacts = replace(disc.contacts, geometry=replace(disc.geometry, placement=moved))
    return replace(model, discs=(replace(disc, contacts=contacts),))


def test_loads_and_moments_are_slopes_of_one_energy(hold_coefficients):
    """∂E/∂δ = F and ∂E/∂θ = M to 1e-8, so that M follows δ as F follows θ (Maxwell), at a held pose.

    E is that of contacts and bodies, Σ E(contact) + (F·C F + M·C′ M)/2. A pin moves along its normal, or leans along it.
    Differences of fourth order with steps of 1e-3 of the approach leave 1e-10 by curvature and 1e-9 by what is not settled, 1e-13
    mm; second ones leave 1e-7 of the largest. Deformations follow the pose as their contacts say to 2e-4 of the largest, as
    forces do, coefficients held.
    """
    drive = drive_for("half-space")
    model, found = balanced(drive, CoupledCompliance.of_drive(drive, solid(drive), "half-space"))
    (part,) = found.response.parts
    contact, half = part.leaning_pins.contact, 0.5 * drive.disc.thickness
    loaded, count = np.argsort(contact.load[0])[-3:], contact.load.shape[1]
    # Normals into the pins, in the turning wheel: a disc that moves along them presses further.
    turned = np.exp(-1j * (model.discs[0].geometry.placement.wheel_rotation(ANGLES) + found.pose[:, -1]))
    normal = (part.flank.gradient[0, :, 0] + 1j * part.flank.gradient[0, :, 1]) * turned

    def at(pin, approach, tilt):
        """Energy, loads and moments with one pin pressed and tilted by so much more."""
        here = displaced(model, pin, -approach * normal[pin], -tilt * normal[pin])
        state = ContactSystem(here).respond(ANGLES, found.pose, None, roughly=False)
        (stored,) = stored_by_disc(state)
        load, moment = state.corrected_load[0, :, :count]
        return np.concatenate((stored.energy, load, moment * half))

    def slope(pin, approach, tilt):
        ends = [at(pin, side * approach, side * tilt) for side in (1.0, -1.0, 2.0, -2.0)]
        return (8.0 * (ends[0] - ends[1]) - (ends[2] - ends[3])) / (12.0 * max(approach, tilt))

    by_shift, by_tilt = [slope(pin, 4e-6, 0.0) for pin in loaded], [slope(pin, 0.0, 8e-7) for pin in loaded]
    for pin, one, other in zip(loaded, by_shift, by_tilt, strict=True):
        assert one[0] == pytest.approx(contact.load[0, pin], rel=1e-8)
        assert other[0] == pytest.approx(contact.moment[0, pin], rel=1e-7)
    loads, moments = (
        np.array([one[1 + loaded] for one in by_tilt]),
        np.array([one[1 + count + loaded] for one in by_shift]),
    )
    assert np.max(np.abs(loads[~np.eye(3, dtype=bool)])) > 1e-2 * np.max(np.abs(loads))
    np.testing.assert_allclose(moments, loads.T, atol=1e-7 * np.max(np.abs(loads)))
    hold_coefficients()
    system, pose = ContactSystem(model), found.pose
    follow = system.respond(ANGLES, pose, None, roughly=False).inner.approach_by_pose[0]
    carries = system.respond(ANGLES, pose, None, roughly=False).corrected_load[0, 0] > 0.0
    for coordinate, step in enumerate((1e-6, 1e-6, 2e-8, 1e-7, 1e-7, 2e-8)):
        ends = []
        for side in (step, -step):
            there = pose.copy()
            there[0, coordinate] += side
            ends.append(system.respond(ANGLES, there, None, roughly=False).after[0])
        numeric = (ends[0] - ends[1])[:, carries] / (2.0 * step)
        told = follow[:, carries, coordinate]
        np.testing.assert_allclose(numeric, told, atol=2e-4 * np.max(np.abs(told)))


@pytest.mark.slow
def test_twice_the_tilts_by_an_iteration_of_its_own():
    """With C' doubled, loads and moments at a pose are those of a damped fixed point outside: no tangent, no Newton over all.

    It asks the laws alone, and moves every roller by its own stiffness against its place and lean. 1e-6 of the largest:
    coefficients of the bore are taken where rollers at rest touch it, here where they do, 1e-6 of a coefficient.
    """
    drive = drive_for("half-space")
    disc = tilting_scaled(CoupledCompliance.of_drive(drive, solid(drive), "half-space"), 2.0)
    _, found = balanced(drive, disc)
    response, pose = found.response.parts[0], found.pose
    geometry, laws = disc.geometry, disc.contacts
    flank, holes = geometry.flank(ANGLES, pose), geometry.holes(ANGLES, pose)
    tilts = geometry.flank_tilt(ANGLES, pose, flank).tilt, geometry.hole_tilt(pose, holes).tilt
    bores, rays = geometry.bores(ANGLES, pose), geometry.rollers(ANGLES)
    count = rays.direction.shape[1]
    displacement = bores.each(bores.displacement, count)
    at_race, at_bore = (
        dot(rays.direction, leans) for leans in (bores.each(geometry.journal_leans(pose), count), geometry.lean(pose))
    )
    inward = 0.5 * (rays.outermost - rays.touching(rays.direction.conjugate() * displacement))
    lean = 0.5 * (at_race + at_bore)
    taken = taken_of(drive, scale=2.0)
    y = t = tuple(np.zeros(one.shape) for one in split_loads(response)[0])

    def carried(law, approach, tilt, radius):
        return law.respond(approach, tilt, np.broadcast_to(radius, approach.shape))

    for _ in range(400):
        arm = (rays.outermost - inward) * rays.direction - displacement
        cosine = dot(arm, rays.direction) / np.abs(arm)
        pins = carried(laws.pin_law, flank.approach - y[0], tilts[0] - t[0], flank.effective_radius)
        outer = carried(
            laws.outer_law,
            np.abs(arm) - rays.bore_play - y[1],
            lean - at_bore - t[1],
            disc.geometry.placement.outer_effective_radii,
        )
        on_holes = carried(
            disc.hole_law, holes.approach - y[2], tilts[1] - t[2], disc.geometry.placement.hole_effective_radii
        )
        inner = carried(
            laws.inner_law, inward - y[3], at_race - lean - t[3], disc.geometry.placement.inner_effective_radii
        )
        contacts = pins, outer, on_holes, inner
        loads, moments = (tuple(getattr(one, name) for one in contacts) for name in ("load", "moment"))
        # What turns and moves a roller inward, and how that grows as it does.
        short = np.stack((cosine * outer.load - inner.load, inner.moment - outer.moment), axis=-1)
        mixed = -inner.by_tilt - cosine * outer.by_tilt
        held = np.stack((inner.by_approach + cosine**2 * outer.by_approach, mixed, mixed,
                         inner.moment_by_tilt + outer.moment_by_tilt), axis=-1).reshape(*mixed.shape, 2, 2)  # fmt: skip
        free = held[..., 0, 0] == 0.0
        held[free] = np.eye(2)
        moved = np.linalg.solve(held, short[..., None])[..., 0]
        inward, lean = inward + 0.3 * moved[..., 0], lean + 0.3 * moved[..., 1]
        found_y, found_t = taken(disc, pose[0], response, loads, moments)
        change = max(np.max(np.abs(a - b)) for a, b in zip((*y, *t), (*found_y, *found_t), strict=True))
        y, t = (
            tuple(old + 0.3 * (new - old) for old, new in zip(before, now, strict=True))
            for before, now in ((y, found_y), (t, found_t))
        )
        if max(change, np.max(np.abs(moved))) < 1e-14:
            break
    expected, turning = split_loads(response)
    for one, other in zip((*loads, *moments), (*expected, *turning), strict=True):
        np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-6 * np.max(np.abs(other)))


def split_loads(response):
    """Loads and moments of wheel pins, bores, shaft pins and races, shape (positions, parts)."""
    rollers, pins, holes = response.rollers, response.leaning_pins.contact, response.leaning_holes.contact
    return (
        (pins.load, rollers.outer_load, holes.load, rollers.inner_load),
        (pins.moment, rollers.leaning.outer.moment, holes.moment, rollers.leaning.inner.moment),
    )


def taken_of(drive, scale=1.0):
    """What closed-form bodies take, by Johnson's half-plane and cylinder written down again and own integrals on the diagonal."""
    wide, long, parts = drive.disc.thickness, drive.roller_length, drive.materials
    steel = parts.disc
    nu = steel.poisson_ratio
    unit = 2.0 * (1.0 - nu**2) / (np.pi * steel.youngs_modulus)
    load = 0.5 * drive.load.torque / (drive.crank.eccentricity * drive.reduction_ratio)
    modulus = steel.youngs_modulus / (2.0 * (1.0 - nu**2))
    bearing, shaft = drive.crank_bearing, drive.pin_shaft

    def left(length, radius, tilts, modulus=modulus):
        """ln D of what is taken off a half-plane's unit: Love's strips."""
        b = np.sqrt(4.0 * load / length * radius / (np.pi * modulus))
        images = (FreeEnds(reach=1.0, weight=guilbault_factor(nu)),)
        held = projected_on_half_space(length, b, images)[1 if tilts else 0] * (np.pi * length / 2.0)
        return held * (length**2 / 12.0 if tilts else 1.0) + np.log(0.5 * b) - 0.25

    def matrices(disc, pose, answer, tilts):
        depth, arm = (TILT_DEPTH, lambda length: 12.0 / length**2 * scale) if tilts else (DEPTH, lambda _: 1.0)
        part = np.log(depth) - nu / (2.0 * (1.0 - nu)) - 0.5
        kappa, of_roller = unit / wide * arm(wide), unit / long * arm(long)
        places = disc.geometry.profile.flank(answer.flank.parameter)[0]
        at_bore = np.angle(answer.rollers.outer_direction[0]) - pose[2]
        on_bore = drive.bore_radius * np.exp(1j * at_bore)
        on_race = bearing.inner_race_radius * np.exp(1j * disc.geometry.placement.roller_cage_angles)
        curved = float(disc.geometry.profile.effective_radius(
            np.array([0.5 * np.pi / drive.reduction_ratio]), drive.pin_wheel.pin_radius)[0])  # fmt: skip
        bore = 1.0 / (1.0 / bearing.roller_radius - 1.0 / drive.bore_radius)
        race = 1.0 / (1.0 / bearing.roller_radius + 1.0 / bearing.inner_race_radius)
        hole = 1.0 / (1.0 / shaft.pin_radius - 1.0 / drive.hole_radius)

        def half_plane(points, radius):
            apart = np.abs(points[:, None] - points)
            np.fill_diagonal(apart, 1.0)
            found = kappa * (part - np.log(apart))
            return found - kappa * left(wide, radius, tilts) * np.eye(points.size)

        pins, bores = half_plane(places, curved), half_plane(on_bore, bore)
        races = half_plane(on_race, race)
        pins += kappa * (part - left(wide, curved, tilts)) * np.eye(places.size)
        squeezed = np.log(2.0 * bearing.roller_radius) - 1.0 - CROSS_SHARE
        bores += of_roller * (squeezed - left(long, bore, tilts)) * np.eye(on_bore.size)
        races += of_roller * (squeezed - left(long, race, tilts)) * np.eye(on_bore.size)
        # Shaft pins are rigid: the wall has all of the near field, and half the modulus.
        holes = kappa * (part - left(wide, hole, tilts, 2.0 * modulus)) * np.eye(drive.number_of_holes)
        if not tilts:
            holes += np.eye(drive.number_of_holes) / shaft.stiffness
        return pins, bores, holes, races, of_roller * CROSS_SHARE

    def both(disc, pose, answer, loads, moments):
        found = []
        for tilts, carried in ((False, loads), (True, moments)):
            pins, bores, holes, races, across = matrices(disc, pose, answer, tilts)
            of_pins, of_bores, of_holes, of_races = (one[0] for one in carried)
            found.append((
                (pins @ of_pins)[None], (bores @ of_bores + across * of_races)[None], (holes @ of_holes)[None],
                (races @ of_races + across * of_bores)[None],
            ))  # fmt: skip
        return found

    return both


def test_gaps_and_balance_in_six_directions_with_bodies_that_tilt():
    """Lines in space, laws by own quadratures and closed-form bodies: `ltca.testing.width_check` knows what bodies take.

    Without it gaps are off.
    """
    drive = drive_for("half-space")
    disc = CoupledCompliance.of_drive(drive, solid(drive), "half-space")
    model, found = balanced(drive, disc)
    own = taken_of(drive)

    def taken(one):
        approach, tilt = own(disc, found.pose[0], one.answer, *split_loads(one.answer))
        return Taken(tuple(each[0] for each in approach), tuple(each[0] for each in tilt))

    assert WidthCheck(drive, model, found, 0, taken).problems(drive.load.torque) == []
    assert any("gap" in told for told in WidthCheck(drive, model, found, 0).problems(drive.load.torque))
    _, tilts = own(disc, found.pose[0], found.response.parts[0], *split_loads(found.response.parts[0]))
    assert max(np.max(np.abs(one)) for one in tilts) > 1e-6


@pytest.mark.parametrize("kind", NEAR_FIELDS)
def test_the_mirror_image_along_z_turns_moments(kind):
    """Leads and inclinations the other way: the same loads, moments of the other sign, to round-off."""
    drive = drive_for(kind)
    other = drive.with_fields({"disc.lead_slope": -1e-4, "pin_wheel.inclination": {"x": -3e-4, "y": -2e-4}})
    (_, found), (_, mirrored) = (
        balanced(one, CoupledCompliance.of_drive(one, solid(one), kind)) for one in (drive, other)
    )
    (loads, moments), (same, turned) = (split_loads(one.response.parts[0]) for one in (found, mirrored))
    for one, two in zip(loads, same, strict=True):
        np.testing.assert_allclose(one, two, rtol=0.0, atol=1e-8 * one.max())
    for one, two in zip(moments, turned, strict=True):
        np.testing.assert_allclose(one, -two, rtol=0.0, atol=1e-8 * np.max(np.abs(one)))


def two_discs(**fields):
    """The paper's drive with two discs, its wheel held."""
    return paper(**{"disc.number_of_discs": 2, "installation.held": "pin-wheel", "disc.gap": 1.0, **fields})


DRIVES = {
    "robot-joint": lambda kinds: kinds["robot-joint"].with_fields({"contact.slices": SLICES, "disc.lead_slope": 1e-4}),
    "rv": lambda kinds: kinds["rv"].with_fields(
        {"contact.slices": SLICES, "disc.lead_slope": 1e-4, "pin_wheel.inclination": {"x": 1e-4, "y": 0.0}}
    ),
    "plastic": lambda kinds: kinds["plastic"].with_fields(
        {"contact.slices": SLICES, "disc.lead_crown_drop": 0.01, "pin_wheel.inclination": {"x": 3e-4, "y": 2e-4}}
    ),
    "two discs, wheel held": lambda kinds: two_discs(),
}


@pytest.mark.family(quick=1)
@pytest.mark.parametrize(
    "kind", [pytest.param(name, marks=() if name == "plastic" else pytest.mark.slow) for name in DRIVES]
)
def test_other_drives_balance_on_solid_bodies(kind, kinds_of_drives, monkeypatch):
    """Forces and couples in six directions; gaps, which the lines do not know of coupled bodies here, are not asked.

    Doubling C' moves moments: it is there.
    """
    drive = warm_drive(DRIVES[kind](kinds_of_drives))
    singles = single_discs(drive)
    discs = [CoupledCompliance.of_drive(one, solid(one), "half-space") for one in singles]
    model = Reducer.of_drive(drive, discs)
    found = solve_at_output(model, [drive], ANGLES, drive.load.torque)
    monkeypatch.setattr(WidthCheck, "_laws", lambda *_: None)
    assert WidthCheck(drive, model, found, 0).problems(drive.load.torque) == []
    other = Reducer.of_drive(drive, [tilting_scaled(disc, 2.0) for disc in discs])
    again = solve_at_output(other, [drive], ANGLES, drive.load.torque)
    moments, turned = (
        np.concatenate([part.leaning_pins.contact.moment[0] for part in one.response.parts]) for one in (found, again)
    )
    assert np.max(np.abs(moments - turned)) > 1e-3 * np.max(np.abs(moments))


def test_what_solid_bodies_store_at_one_slice_asked_for_tilts(paper_cases):
    """In the plane solid bodies know no tilts: forces are the slopes of what is stored, 1e-4 as radii follow the pose."""
    drive = paper_cases["CS-3"]
    model, found = balanced(drive, CoupledCompliance.of_drive(drive, solid(drive), "half-space"))
    ends = []
    for side in (1.0, -1.0):
        pose = found.pose + side * 1e-6 * np.eye(4)[0]
        ends.append(stored_by_disc(ContactSystem(model).respond(ANGLES, pose, None, roughly=False))[0].energy[0])
    tangent = found.response.tangent[0, 0, 0]
    # In balance the slope is nothing of what 1 µm more presses.
    assert abs(ends[0] - ends[1]) / 2e-6 < 1e-2 * tangent * 1e-3
