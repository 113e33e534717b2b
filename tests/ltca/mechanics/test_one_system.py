"""One system of all contacts against its own equations, one contact at a time: drives of every kind.

At an answer each law is asked for the load at the approach that geometry has at the pose, with pins and rollers where they stand,
less what the bodies take under all loads. Rollers balance between their contacts, pins stand where beams and ring put them under
these loads, and forces are by virtual work. No tangent, no elimination: nothing of `ltca.mechanics.contacts`.
"""

from pathlib import Path

import numpy as np
import pytest

from ltca.analysis.engines import HalfSpace
from ltca.compliance.coefficients import BodyPlaces, load_coefficients
from ltca.compliance.coupled import CoupledCompliance
from ltca.drive.members.temperatures import warm_drive
from ltca.drive.single_discs import single_discs
from ltca.equilibrium import newton
from ltca.equilibrium.output_torque import solve_at_output
from ltca.equilibrium.reducer import Reducer
from ltca.geometry.coordinates import DISC_ROTATION, WHEEL_ANGLE, X, Y
from ltca.geometry.pair_motion import dot
from ltca.reading.drive_file import load_drive
from ltca.testing.closed_form_bodies import closed_form_coefficients
from ltca.testing.crank_drives import crank_drive
from ltca.testing.pin_drives import friction_drive, pin_drive
from ltca.testing.practical_drives import practical_drive, preloaded_drive
from ltca.testing.random_drives import random_reducer

GENERATORS = (random_reducer, crank_drive, pin_drive, friction_drive, preloaded_drive, practical_drive)
LOAD_BOUND = 1e-9
"""Largest difference of loads by the largest, beyond what round-off of places makes of them, and ten times what an answer says to
leave over of forces: of pins on soft beams more than is asked for, 1e-5 N of 1e4 N."""
ROUND_OFF = 2e-15
"""Of places by the pin circle, ten terms of 2e-16."""
STEP, FORCE_BOUND = 1e-6, 1e-8
"""Step of differences of places of fourth order by the pin circle, and largest difference of forces on coordinates by the largest
load: round-off of places is 1e-15 of the circle."""


@pytest.fixture
def closely(monkeypatch):
    """Search to a residual a thousand times smaller: contacts of a search are as rough as it accepts."""
    monkeypatch.setattr(newton, "TOLERANCE", 1e-12)


class DiscByItself:
    """Contacts of one disc at an answer: wheel pins, bores, holes and races."""

    def __init__(self, model, found, number):
        self.disc, self.part = model.discs[number], found.response.parts[number]
        self.geometry, self.angle = self.disc.geometry, found.crank_angle
        self.pose = found.pose[:, model.coordinates.columns(number)]
        self.leans = self.geometry.coordinates_of(self.pose).leans
        self.half = np.asarray(self.geometry.half_width, dtype=float)
        follow, rollers = found.response.inner, self.part.rollers.outer_load.shape[1]
        np.testing.assert_allclose(follow.pose, found.pose, rtol=0.0, atol=1e-15)
        own = slice(number * rollers, (number + 1) * rollers)
        self.circle = np.abs(self.geometry.placement.wheel_pin_centres).max()
        self.inward, self.lean = follow.place[:, own], follow.lean.sum(axis=1)[:, own] / self.half

    def placed(self, pose):
        """Approaches and tilts of all kinds, mm and rad, with pins and rollers as they are, and pairs of pins and holes."""
        geometry, angle, part = self.geometry, self.angle, self.part
        pins = part.pin_load.shape[1]
        shifts, leans = (
            (None, None) if each is None else (each[:, :pins], each[:, pins:]) for each in (part.shifts, part.leans)
        )
        flank = geometry.flank(angle, pose, None, shifts[0])
        holes = geometry.holes(angle, pose, shifts[1])
        bores, rays = geometry.bores(angle, pose), geometry.rollers(angle)
        arm = (rays.outermost - self.inward) * rays.direction - bores.each(bores.displacement, self.inward.shape[1])
        self.cosine = dot(arm, rays.direction) / np.abs(arm)
        self.in_bore, self.in_hole = arm, holes.gradient[..., X] + 1j * holes.gradient[..., Y]
        approach = flank.approach, np.abs(arm) - rays.bore_play, holes.approach, self.inward
        if not self.leans:
            return flank, approach, None
        journals = bores.each(geometry.journal_leans(pose), self.inward.shape[1])
        at_race, at_bore = (dot(rays.direction, lean) for lean in (journals, geometry.lean(pose)))
        tilt = (
            flank.leaning(*geometry.flank_lean(angle, pose, leans[0]), geometry.coordinates_of(pose)).tilt,
            self.lean - at_bore,
            holes.leaning(*geometry.hole_lean(pose, leans[1]), geometry.coordinates_of(pose)).tilt,
            at_race - self.lean,
        )
        return flank, approach, tilt

    def carried(self):
        """Loads and, in slices, moments of all kinds by the answer."""
        part, rollers = self.part, self.part.rollers
        loads = part.pin_load, rollers.outer_load, part.hole_load, rollers.inner_load
        if not self.leans:
            return loads, None
        pins, holes = part.leaning_pins.contact, part.leaning_holes.contact
        return loads, (pins.moment, rollers.leaning.outer.moment, holes.moment, rollers.leaning.inner.moment)

    def taken(self, flank, carried):
        """What bodies take of the approaches, and of the tilts by half the thickness."""
        if self.disc.coefficients is None:
            return None
        rays, bores = self.geometry.rollers(self.angle), self.geometry.bores(self.angle, self.pose)
        resting = rays.outermost * rays.direction - bores.each(bores.displacement, self.inward.shape[1])
        turn = self.pose[:, DISC_ROTATION, None]
        place, in_bore, in_hole = self.geometry.placement, np.angle(resting) - turn, np.angle(-self.in_hole) - turn
        on_flank, radius = self.geometry.profile.flank(flank.parameter), float(place.bore_radius)
        places = BodyPlaces.on_walls(flank.parameter, on_flank, in_bore, radius, in_hole, place.cranks)
        rows, counts = self.angle.size, [each.shape[1] for each in (flank.parameter, in_bore, in_hole)]
        ends, found = np.cumsum(counts)[:2], []
        every = [np.tile(np.arange(count), (rows, 1)) for count in counts]
        for body, load in zip(self.disc.body_flexibility(places, every), carried, strict=False):
            on_walls = np.einsum("bij,bj->bi", body.among, np.concatenate(load[:3], axis=1))
            pins, in_bores, holes = np.split(on_walls, ends, axis=1)
            on_races = np.einsum("bij,bj->bi", body.on_race, load[3]) + body.across_roller * load[1]
            found.append((pins, in_bores + body.across_roller * load[3], holes, on_races))
        return found

    def left_over(self):
        """Loads and moments by half the thickness that laws and rollers leave over, N."""
        flank, approach, tilt = self.placed(self.pose)
        loads, moments = self.carried()
        turning = None if moments is None else tuple(moment / self.half for moment in moments)
        taken = self.taken(flank, (loads, turning))
        if taken is not None:
            approach = tuple(mine - less for mine, less in zip(approach, taken[0], strict=True))
        if taken is not None and tilt is not None and len(taken) > 1:
            tilt = tuple(mine - less / self.half for mine, less in zip(tilt, taken[1], strict=True))
        laws = self.disc.contact_laws
        radii = flank.effective_radius, laws.outer_radius, laws.hole_radius, laws.inner_radius
        found, held = [], []
        for number, (law, radius) in enumerate(zip(laws.laws, radii, strict=True)):
            pressed = np.broadcast_to(radius, approach[number].shape)
            if tilt is None or turning is None:
                load, stiffness = law.load_and_stiffness(approach[number], pressed)
                found.append((load - loads[number], stiffness))
            else:
                contact = law.respond(approach[number], tilt[number], pressed)
                stiffness = contact.by_approach
                found.append((contact.load - loads[number], stiffness))
                found.append((contact.moment / self.half - turning[number], stiffness))
            held.append(stiffness)
        found.append((loads[3] - self.cosine * loads[1], held[1] + held[3]))
        if turning is not None:
            found.append((turning[3] - turning[1], held[1] + held[3]))
        place = ROUND_OFF * self.circle
        return max((np.abs(each) - place * stiffness).max(initial=0.0) for each, stiffness in found)

    def work(self):
        """Forces on the coordinates by virtual work of the loads, and levers of the coordinates, mm."""
        loads, moments = self.carried()
        circle = self.circle
        found, lever = np.zeros(self.pose.shape), np.ones(self.pose.shape[1])
        lever[self.geometry.coordinates_of(self.pose).rotations] = circle
        pressed = loads if moments is None else loads + moments
        for column, arm in enumerate(lever):
            for side, weight in ((1.0, 8.0), (-1.0, -8.0), (2.0, -1.0), (-2.0, 1.0)):
                moved = self.pose.copy()
                moved[:, column] += side * STEP * circle / arm
                _, approach, tilt = self.placed(moved)
                for load, there in zip(pressed, approach if tilt is None else approach + tilt, strict=True):
                    found[:, column] += weight * (load * there).sum(axis=1) * arm / (12.0 * STEP * circle)
        return found, lever


def left_over(model, drive, angle, torque):
    """Differences of loads and of forces on coordinates by the largest load, of displaced pins by the farthest displaced one."""
    found = solve_at_output(model, [drive], angle, torque)
    discs = [DiscByItself(model, found, number) for number in range(len(model.discs))]
    response, parts = found.response, found.response.parts
    largest = max(load.max(initial=0.0) for disc in discs for load in disc.carried()[0])
    loads = (max(disc.left_over() for disc in discs) - 10.0 * found.residual.max()) / largest
    forces = pins = 0.0
    if model.friction is None:
        for disc in discs:
            work, lever = disc.work()
            forces = max(forces, np.abs((work - disc.part.force) / lever).max() / largest)
    if model.pins is not None:
        place = model.discs[0].geometry.placement
        turned = np.exp(-1j * (place.wheel_rotation(angle) + found.pose[:, WHEEL_ANGLE]))[:, None]
        frame = np.where(np.arange(parts[0].shifts.shape[1]) < parts[0].pin_load.shape[1], turned, 1.0)
        pressed, stand = [part.pin_forces * frame for part in parts], [part.shifts for part in parts]
        if model.pins.leans:
            pressed += [part.pin_moments * frame / disc.half for part, disc in zip(parts, discs, strict=True)]
            stand += [part.leans * disc.half for part, disc in zip(parts, discs, strict=True)]
        stand = np.stack(stand, axis=1)
        pins = np.abs(model.pins.under(np.stack(pressed, axis=1)) - stand).max() / np.abs(stand).max(initial=1e-300)
        np.testing.assert_array_equal(response.shifts, stand[:, : len(parts)])
    return loads, forces, pins


def on_bodies(drive, folder: Path, field):
    """The drive on closed-form bodies that couple its contacts."""
    drive, discs = warm_drive(drive), []
    for number, single in enumerate(single_discs(drive)):
        path = folder / f"{number}.nc"
        closed_form_coefficients(single, half_width=0.02, depth=300.0).to_netcdf(path, engine="h5netcdf")
        discs.append(CoupledCompliance.of_drive(single, load_coefficients(path, single), field))
    return Reducer.of_drive(drive, discs), drive


def drawn(generator, seed):
    """A drive and two crank angles."""
    found = generator(seed)
    if found is None:
        pytest.skip("the generator draws no drive from this seed")
    drive, angle = found if isinstance(found, tuple) else (found, 0.3)
    return warm_drive(drive), np.array([angle, angle + 0.7])


def check_drawn(generator, seed):
    """Check at the torque of the drive and at a tenth of it."""
    drive, angle = drawn(generator, seed)
    model = HalfSpace().prepare(drive).model
    for part in (1.0, 0.1):
        loads, forces, pins = left_over(model, drive, angle, part * drive.load.torque)
        assert loads <= LOAD_BOUND, (generator.__name__, seed, part, loads)
        assert forces <= FORCE_BOUND, (generator.__name__, seed, part, forces)
        assert pins <= LOAD_BOUND, (generator.__name__, seed, part, pins)


@pytest.mark.parametrize("generator", GENERATORS, ids=lambda one: one.__name__)
def test_contacts_of_random_drives_carry_what_their_laws_say(generator, closely):
    check_drawn(generator, 1)


@pytest.mark.slow
@pytest.mark.nightly
@pytest.mark.parametrize("seed", range(2, 12))
@pytest.mark.parametrize("generator", GENERATORS, ids=lambda one: one.__name__)
def test_contacts_of_more_random_drives_carry_what_their_laws_say(generator, seed, closely):
    check_drawn(generator, seed)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["paper", "rv", "sleeved", "robot-joint"])
@pytest.mark.parametrize("fields", [{}, {"contact.slices": 9}], ids=["plane", "9 slices"])
def test_contacts_of_shipped_drives_carry_what_their_laws_say(name, fields, closely):
    case = next(iter(load_drive(name).cases.values()))
    drive = warm_drive(case.with_fields(fields) if fields else case)
    angle = 0.05 + 2.0 * np.pi * np.arange(3) / 3.0
    loads, forces, pins = left_over(HalfSpace().prepare(drive).model, drive, angle, drive.load.torque)
    assert loads <= LOAD_BOUND
    assert forces <= FORCE_BOUND
    assert pins <= LOAD_BOUND


@pytest.mark.slow
@pytest.mark.parametrize("field", ["plane-strain", "half-space"])
@pytest.mark.parametrize("name", ["paper", "rv", "sleeved", "robot-joint"])
def test_contacts_on_coupled_bodies_carry_what_their_laws_say(name, field, closely, tmp_path):
    model, drive = on_bodies(next(iter(load_drive(name).cases.values())), tmp_path, field)
    loads, forces, pins = left_over(model, drive, np.array([0.1, 2.6]), drive.load.torque)
    assert loads <= LOAD_BOUND
    assert forces <= FORCE_BOUND
    assert pins <= LOAD_BOUND
