"""Drives as people draw them: round numbers, zeros and equalities, steel, aluminium or plastic.

While `random_drives` covers the space of valid drives, plain choices are frequent here: no offsets or equal ones, no
clearance, equal radii, full torque or a hundredth of it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.random import Generator

from ltca.analysis.engines import HalfSpace
from ltca.arrays import FloatArray
from ltca.compliance.response import split_shifts
from ltca.drive.deviations import OneDisc, OneEccentric, Runout
from ltca.drive.materials import Material
from ltca.drive.members.temperatures import warm_drive
from ltca.drive.parts import Clearance, Drive, Installation, Ring, RingBolts
from ltca.drive.units.quantities import ARCMIN
from ltca.equilibrium.balance import Equilibrium
from ltca.equilibrium.output_angle import play_before_cranks, wheel_angle_of_input
from ltca.equilibrium.output_torque import solve_at_output
from ltca.equilibrium.reducer import Reducer
from ltca.errors import ConvergenceError, DriveError
from ltca.geometry.coordinates import WHEEL_ANGLE, Coordinates
from ltca.geometry.flank import FlankProfile
from ltca.geometry.pairs import ContactGeometry
from ltca.geometry.play import CLOSED, free_play, loose_poses
from ltca.reading.drive_file import build_drive
from ltca.reading.physical_checks import is_sound
from ltca.testing.ring_statics import ring_by_statics

MATERIALS = {
    "steel": (206e3, 0.3, 1200.0),
    "aluminium": (70e3, 0.33, 350.0),
    "plastic": (2.6e3, 0.38, 50.0),
}
"""Young's modulus, MPa, Poisson's ratio and flank pressure at the rated torque, MPa, of the disc; its pins are steel."""
PIN_NUMBERS = (
    6, 8, 10, 11, 12, 14, 16, 18, 20, 24, 25, 26, 30, 32, 36, 40, 41, 44, 48, 50, 52, 60, 64, 76, 80, 90, 100, 120,
)  # fmt: skip
RINGS: tuple[tuple[Material, float], ...] = (
    (Material(), 1.0), (Material(), 1.0), (Material(youngs_modulus=70e3, poisson_ratio=0.33), 1.0),
    (Material(youngs_modulus=2.6e3, poisson_ratio=0.38), 2.0),
)  # fmt: skip
"""Materials of elastic rings: steel, aluminium, or plastic at twice the height."""
SOFTEST_RING = 0.2
"""Largest displacement of a seat when a quarter of the pins carry the torque, in eccentricities: beyond that teeth slip."""
CIRCLES = (20.0, 25.0, 30.0, 32.0, 40.0, 50.0, 55.0, 60.0, 72.0, 80.0, 88.0, 100.0, 120.0, 150.0, 180.0)


def practical_drive(seed: int) -> tuple[Drive, float]:
    """Return a drive as people draw them, and a crank angle in rad (one in four is zero), by a seed (not negative).

    It has its rated torque or a hundredth of it, one to three discs, either member held, and half of all an elastic ring.
    """
    random = np.random.default_rng(seed)
    while True:
        drawn = _draw(random)
        if drawn is not None:
            break
    drive, angle = _built_in(random, drawn), float(random.choice([0.0, *random.uniform(0.0, 2.0 * np.pi, 3)]))
    return with_ring(seed, drive), angle


def with_ring(seed: int, drive: Drive) -> Drive:
    """Return a drive with an elastic ring around its wheel pins, or with a rigid one, by a seed (not negative).

    Rings are free, bolted or built in, half of all drives have none. Pins stand half in the ring (its inner radius is that of
    their circle), deeper or less deep, or touch it just so. A ring so soft that teeth would slip is left out.
    """
    random = np.random.default_rng((seed, 5))
    drive = replace(drive, ring=None)
    if random.uniform() < 0.5:
        return drive
    wheel = drive.pin_wheel
    circle, seat = wheel.pin_circle_radius, wheel.pin_radius
    if wheel.seat.kind != "fixed":
        seat = (wheel.seat.radius if wheel.seat.kind == "slot" else wheel.seat.pin_radius) or seat
    material, higher = RINGS[int(random.integers(len(RINGS)))]
    inner = circle + float(random.choice([0.0, 0.0, 0.5, -0.3, 1.0])) * seat
    height = higher * float(random.choice([0.1, 0.2, 0.3, 0.5])) * circle
    stack = 2.0 * max(abs(plane) for plane in drive.disc.disc_planes) + drive.disc.thickness
    outer = _round(circle + seat + height, _step(height))
    kind = str(random.choice(["free", "free", "bolted", "built-in"]))
    bolts = None
    if kind == "bolted":
        bolts = RingBolts(
            number=int(random.choice([3, 4, 6, 8, 12, wheel.number_of_pins])),
            circle_radius=float(random.choice([0.5 * (circle + outer), outer, 1.1 * outer])),
            stiffness=float(random.choice([1e5, 5e5, 1e6])),
        )
    ring = Ring(
        inner_radius=inner,
        outer_radius=outer,
        width=stack * float(random.choice([1.0, 1.0, 1.5])),
        material=material,
        flange="built-in" if kind == "built-in" else "free",
        bolts=bolts,
    )
    ringed = replace(drive, ring=ring)
    soft = largest_ring_displacement(ringed) > SOFTEST_RING * drive.crank.eccentricity
    return drive if soft or not is_sound(ringed) else ringed


def largest_ring_displacement(drive: Drive) -> float:
    """Return the largest displacement of a seat, mm, when a quarter of the pins, side by side, carry the torque at 45°."""
    flexibility, pins = ring_by_statics(drive), drive.pin_wheel.number_of_pins
    if flexibility is None:
        return 0.0
    angles = 2.0 * np.pi * np.arange(pins) / pins
    each = abs(drive.wheel_moment()) / (drive.crank.eccentricity * pins) / np.ceil(0.25 * pins)
    force = np.where(angles < 0.5 * np.pi, each * np.sqrt(2.0) * np.exp(1j * (angles + 0.25 * np.pi)), 0.0)
    moved = np.einsum("iajb,jb->ia", flexibility, np.stack((force.real, force.imag), axis=1))
    return float(np.max(np.hypot(moved[:, 0], moved[:, 1])))


def _built_in(random: Generator, drive: Drive) -> Drive:
    """The drive with one to three discs under as many times the torque, small errors of one of them, and either member
    held.
    """
    discs = int(random.choice([1, 1, 2, 2, 3]))
    load = replace(drive.load, torque=discs * drive.load.torque, light_torque=discs * drive.load.light_torque)
    disc, crank = replace(drive.disc, number_of_discs=discs), drive.crank
    if discs > 1 and random.uniform() < 0.5:
        size = float(random.choice([0.002, 0.005, 0.01])) * min(1.0, drive.crank.eccentricity)
        own = [OneDisc(runout=Runout(amount=size, angle=float(random.choice([0.0, 1.0]))))]
        disc = replace(disc, of=(*own, *[OneDisc()] * (discs - 1)))
        if random.uniform() < 0.5:
            crank = replace(crank, of=(*[OneEccentric()] * (discs - 1), OneEccentric(eccentricity_error=size)))
    held: Any = str(random.choice(["pin-shaft", "pin-wheel"]))
    return replace(drive, disc=disc, crank=crank, load=load, installation=Installation(held=held))


def preloaded_drive(seed: int) -> tuple[Drive, float]:
    """Return a `practical_drive` whose parts overlap as drawn, and a crank angle in rad, by a seed (not negative).

    Pins and flank, rollers and races, shaft pins and holes overlap, or some of them: by micrometres to a fortieth of the
    smallest pin or roller radius.
    """
    random = np.random.default_rng((seed, 1))
    while True:
        drive, angle = practical_drive(int(random.integers(2**32)))
        wheel, disc, bearing, shaft = drive.pin_wheel, drive.disc, drive.crank_bearing, drive.pin_shaft
        assert shaft is not None  # as all of these drives have one
        largest = min(
            0.025 * min(wheel.pin_radius, bearing.roller_radius, shaft.pin_radius), 0.5 * drive.crank.eccentricity
        )
        size = min(float(random.choice([0.001, 0.005, 0.01, 0.02, 0.05])), largest)
        which = int(random.integers(1, 8))
        if which & 1:
            shift = float(random.choice([0.0, 0.5 * size, -0.5 * size]))
            disc = replace(disc, equidistant_offset=-size, shifting_offset=shift)
        if which & 2:
            bearing = replace(bearing, roller_radius=bearing.roller_radius + 0.5 * size)
        if which & 4:
            shaft = replace(shaft, hole_radius=shaft.hole_radius - size)
        drive = replace(drive, disc=disc, crank_bearing=bearing, pin_shaft=shaft, clearance=Clearance())
        if is_sound(drive):
            return drive, angle


def _draw(random: Generator) -> Drive | None:
    table = _teeth(random)
    if table is None or not _inside(random, table):
        return None
    _load(random, table)
    try:
        return build_drive(table)
    except DriveError:
        return None


def _round(value: float, step: float) -> float:
    """Round to a step."""
    return float(round(round(value / step) * step, 6))


def _step(value: float) -> float:
    """Rounding step of a length: 0.05 mm above 1 mm, 0.01 mm below."""
    return 0.05 if value > 1.0 else 0.01


def _teeth(random: Generator) -> dict[str, Any] | None:
    pins, circle = int(random.choice(PIN_NUMBERS)), float(random.choice(CIRCLES))
    wanted = random.uniform(0.4, 0.8) * circle / pins
    eccentricity = _round(wanted, _step(wanted))
    if eccentricity <= 0.0 or eccentricity * pins > 0.9 * circle:
        return None
    path = (
        FlankProfile(generating_radius=circle, eccentricity=eccentricity, reduction_ratio=float(pins), offset=1.0)
        .locus(np.linspace(0.0, 2.0 * np.pi / pins, 721))
        .curvature
    )
    room = min(circle * float(np.sin(np.pi / pins)), 1.0 / float(np.max(path)))
    wanted = room * random.uniform(0.4, 0.75)
    pin_radius = _round(wanted, 0.25 if wanted > 1.0 else 0.05)
    size = float(random.choice([0.01, 0.02, 0.05, 0.1]))
    equidistant, shifting = [
        (0.0, 0.0), (size, size), (-size, -size), (2.0 * size, size), (size, 0.0), (1.5 * size, 0.9 * size), (0.0, -size)
    ][random.integers(7)]  # fmt: skip
    if pin_radius <= 0.0 or equidistant > 0.05 * pin_radius or pin_radius > 0.9 * room:
        return None
    return {
        "crank": {"eccentricity": eccentricity},
        "pin_wheel": {"number_of_pins": pins, "pin_circle_radius": circle, "pin_radius": pin_radius},
        "disc": {
            "number_of_teeth": pins - 1,
            "thickness": _round(circle * random.uniform(0.1, 0.25), 0.5),
            "equidistant_offset": equidistant,
            "shifting_offset": shifting,
        },
    }


def _inside(random: Generator, table: dict[str, Any]) -> bool:
    """Add bearing and holes inside of the teeth; False where nothing fits."""
    wheel, disc, eccentricity = table["pin_wheel"], table["disc"], table["crank"]["eccentricity"]
    root = wheel["pin_circle_radius"] - eccentricity - wheel["pin_radius"]
    bore = _round(root * random.uniform(0.3, 0.5), 0.5)
    roller = _round(bore * random.uniform(0.1, 0.2), 0.25)
    race = bore - 2.0 * roller
    if roller <= 0.0 or race <= roller:
        return False
    fitting = int(np.pi / np.arcsin(1.05 * roller / (race + roller)))
    length = disc["thickness"] * float(random.choice([1.0, 1.0, 0.8]))
    holes = int(random.choice([4, 6, 8, 10, 12]))
    circle = _round(0.5 * (bore + root), 0.5)
    room = 0.9 * min(circle - bore, root - circle, circle * float(np.sin(np.pi / holes)))
    pin = _round((room - eccentricity) * random.uniform(0.6, 1.0), 0.25)
    if pin <= 0.0:
        return False
    table["crank_bearing"] = {
        "inner_race_radius": race,
        "outer_race_radius": bore,
        "number_of_rollers": max(6, fitting - int(random.integers(0, 4))),
        "roller_radius": roller,
        "roller_length": length,
    }
    table["pin_shaft"] = {
        "number_of_pins": holes,
        "pin_circle_radius": circle,
        "pin_radius": pin,
        "hole_radius": pin + eccentricity,
        "stiffness": float(random.choice([1e5, 3e5, 1e6])),
    }
    table["clearance"] = {
        "bearing": float(random.choice([0.0, 0.0, 0.01, 0.03])),
        "pin_hole": float(random.choice([0.0, 0.0, 0.01, 0.03])),
    }
    return True


def _load(random: Generator, table: dict[str, Any]) -> None:
    modulus, ratio, pressure = MATERIALS[str(random.choice(["steel", "steel", "aluminium", "plastic"]))]
    wheel, disc = table["pin_wheel"], table["disc"]
    # A quarter of the pins share the load of the one that carries most, Hertz pressure on its own radius.
    contact_modulus = 1.0 / ((1.0 - ratio**2) / modulus + (1.0 - 0.3**2) / 206e3)
    line_load = np.pi * pressure**2 * wheel["pin_radius"] / contact_modulus
    lever = table["crank"]["eccentricity"] * wheel["number_of_pins"]
    rated = float(f"{0.25 * wheel['number_of_pins'] * line_load * disc['thickness'] * lever:.2g}")
    torque = rated * float(random.choice([1.0, 0.01]))
    table["load"] = {"torque": torque, "light_torque": 0.03 * torque, "direction": str(random.choice(["ccw", "cw"]))}
    steel = {"youngs_modulus": 206e3, "poisson_ratio": 0.3}
    table["materials"] = {"disc": {"youngs_modulus": modulus, "poisson_ratio": ratio}} | dict.fromkeys(
        ("wheel_pin", "roller", "inner_race", "shaft_pin"), steel
    )


PARTS = (1e-6, 1e-5, 1e-4)
"""Fractions of the torque; the next one is tried where no equilibrium is found."""
NANOMETRE = 1e-6
"""mm. Unit of the gaps in `light_limit`: HiGHS leaves reduced costs of 1e-7 of a cost, and in mm a pin with next to no lever
(force 1e4 times that of the wheel) may hide a bound that is 3 % less behind that."""
TOUCHING = 1e-6
"""Gap that is round-off, nm."""
BESIDE = 1.1
"""Difference of the second crank angle to that of the drive, rad."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """Free play and what the loaded model turns at one crank angle.

    Attributes
    ----------
    outcome : {"alike", "settling", "preloaded", "not balanced", "wrong"}
        Settling: the load turns it beyond 1 % and 0.005′ of the free play, by no more than the overlaps under that load allow,
        and the limit of ever lighter loads is within them.
        That limit is a bound, so those alike do not need it.
    free, loaded, yielding : float
        Of the output, arcmin: free, between the torques, and free with those overlaps.
    limit : float
        Between torques of either sense that vanish, by `light_limit`, arcmin.
    part : float
        Of the torque.
    """

    outcome: str
    free: float
    limit: float = np.nan
    loaded: float = np.nan
    yielding: float = np.nan
    part: float = np.nan

    @property
    def difference(self) -> float:
        """Difference of loaded and free play, arcmin."""
        return abs(self.loaded - self.free)


def light_limit(geometry: ContactGeometry, crank_angle: FloatArray, sense: int) -> tuple[FloatArray, FloatArray]:
    """Return the largest wheel angle under a vanishing load with one disc, and the wheel angle without load, rad, ccw
    positive.

    Contact forces in proportion to a vanishing torque still balance it: λ ≥ 0 with Σ λ_i ∇δ_i = e of the wheel's torque.
    Their work on the remaining gaps, Σ λ_i g_i, is how much further the wheel may turn before they are closed, and the
    least of it over all balances is the bound: zero if the pairs in contact balance the torque by themselves. No contact
    law enters, so it holds for every one. Gaps are linear about the pose. Where an arc of a race or a hole lies across the
    rotation, an error of 1e-7 mm in the pose becomes its square root along the arc, and the linear gap is larger than that
    of the arc.

    Crank angles φ_C (rad) and both results have shape (positions,); `sense` is +1 or −1, of the wheel.
    """
    from scipy.optimize import linprog

    pose = rigid_poses(geometry, crank_angle, sense)
    approach, gradient = pair_approaches(geometry, crank_angle, pose)
    reach = float(geometry.placement.eccentricity.max()) * geometry.placement.reduction_ratio
    # All of one size: rotations by the lever of the wheel.
    scaled = gradient / np.array([1.0, 1.0, reach, reach])
    torque = np.array([0.0, 0.0, 0.0, float(sense)])
    further = []
    for gap, slope in zip(approach, scaled, strict=True):
        cost = np.maximum(-gap, 0.0) / NANOMETRE
        cost[cost < TOUCHING] = 0.0  # programmes with costs of round-off alone are "unbounded" to HiGHS
        # Of some programmes older versions of HiGHS say "unknown" by one method and solve them by the other.
        for method in ("highs", "highs-ds", "highs-ipm"):
            found = linprog(cost, A_eq=slope.T, b_eq=torque, method=method)
            if found.success:
                break
        further.append(found.fun * NANOMETRE)
    free = pose[:, WHEEL_ANGLE]
    return free + sense * np.array(further, dtype=float) / reach, free


def rigid_poses(geometry: ContactGeometry, crank_angle: FloatArray, sense: int) -> FloatArray:
    """Return the poses of one disc in which the wheel is turned as far as rigid bodies allow, shape (positions, 4).

    Crank angles φ_C are held, rad, shape (positions,); `sense` is +1 or −1, counter-clockwise or clockwise: the load of a crank
    driving counter-clockwise turns the wheel clockwise. ConvergenceError when parts interfere in every pose (a drive that cannot
    be put together without force), or nothing stops the wheel within half a pin pitch.
    """
    upright, angle = replace(geometry, coordinates=Coordinates()), np.atleast_1d(np.asarray(crank_angle, dtype=float))
    pose = loose_poses([upright], angle, np.full(angle.size, float(sense)))
    left = np.maximum(pair_approaches(upright, angle, pose)[0].max(axis=1), 0.0)
    worst = int(np.argmax(left))
    if left[worst] > CLOSED:
        raise ConvergenceError(
            f"parts interfere in every rigid pose at crank angle {angle[worst]:.6g} rad, by {left[worst]:.3g} mm where they "
            "do so least; interference by positions in mm",
            left.tolist(),
        )
    return pose


def pair_approaches(
    geometry: ContactGeometry, crank_angle: FloatArray, pose: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the approaches of pins, holes and outermost rollers of one disc, mm, and their gradients by the pose.

    Crank angles φ_C (rad) have shape (positions,), poses q (`ltca.geometry.pairs`) (positions, 4), approaches (positions,
    pairs) and gradients (positions, pairs, 4).
    """
    flank, holes, rays = (
        geometry.flank(crank_angle, pose),
        geometry.holes(crank_angle, pose),
        geometry.rollers(crank_angle),
    )
    bores, count = geometry.bores(crank_angle, pose), rays.direction.shape[1]
    arm = rays.outermost * rays.direction - bores.each(bores.displacement, count)
    outward = -(arm / np.abs(arm)).conjugate()[..., None]
    return (
        np.concatenate([flank.approach, holes.approach, np.abs(arm) - rays.bore_play], axis=1),
        np.concatenate([flank.gradient, holes.gradient, (outward * bores.each(bores.gradient, count)).real], axis=1),
    )


def _limit(discs: Sequence[ContactGeometry], angle: FloatArray) -> float:
    """Difference of the limits of vanishing torques of either sense, of all discs together, rad."""
    ends = []
    for sense in (1, -1):
        limits = [light_limit(disc, angle, sense)[0] for disc in discs]
        ends.append(sense * min(sense * float(limit[0]) for limit in limits))
    return ends[0] - ends[1]


def _pressed(model: Reducer, loaded: Equilibrium) -> float:
    """Largest approach of any contact at either end as rigid members that stand there have it, mm.

    That is the approach of the contact with what its pin gives way in beam, ring or carrier, and the largest displacement of any
    bearing beyond its clearance.
    """
    contacts, held = loaded.response, 0.0
    carried = model.carried_beside_discs(loaded.crank_angle, loaded.pose, contacts.parts)
    bearings, cranks = ((), 0) if model.supports is None else (model.supports.bearings, model.supports.cranks)
    for number, support in enumerate(bearings):
        of_teeth = None if carried is None or number >= cranks else carried[:, number]
        yields = np.linalg.inv(support.stiffness).diagonal(axis1=-2, axis2=-1).max()
        held = max(held, float(np.abs(support.reactions(loaded.pose, of_teeth)).max() * yields))
    approaches = []
    for disc, own in zip(model.geometries, contacts.parts, strict=True):
        rollers, pins, holes = own.rollers, own.leaning_pins, own.leaning_holes
        found = [own.flank.approach, own.holes.approach, rollers.inner_approach + rollers.outer_approach]
        if own.shifts is not None:
            for kind, moved in enumerate(split_shifts(own.shifts, disc)):
                found[kind] = found[kind] + (0.0 if moved is None else np.abs(moved))
        if pins is not None and holes is not None and (leaning := rollers.leaning) is not None:
            leant = pins.tilt.tilt, holes.tilt.tilt, leaning.inner_tilt + leaning.outer_tilt
            arms = disc.half_width, disc.half_width, disc.roller_half_length
            found = [each + np.abs(tilt) * arm for each, tilt, arm in zip(found, leant, arms, strict=True)]
        approaches += found
    return held + max(float(np.max(each, initial=0.0)) for each in approaches)


def compare_with_load(seed: int, draw: Callable[[int], tuple[Drive, float]] = practical_drive) -> list[Comparison]:
    """Return the comparisons of the practical drive of a seed, or of one drawn otherwise, at two crank angles."""
    drive, angle = draw(seed)
    return compare(drive, np.array([angle, angle + BESIDE]))


def compare(drive: Drive, crank_angle: FloatArray) -> list[Comparison]:
    """Return the comparisons of a drive, as written, at crank angles φ_C, rad."""
    drive = warm_drive(drive)
    drive = replace(drive, load=replace(drive.load, external=()))  # an arm takes the play on its side (`torque_curve`)
    model = replace(HalfSpace().prepare(drive).model, friction=None)
    discs, scale = model.geometries, abs(drive.output_per_wheel_angle) * ARCMIN
    found, before = free_play(discs, crank_angle), (scale * play_before_cranks(model, crank_angle)).tolist()
    answers, own, loose = [], model.coordinates.own, any(disc.has_loose_supports for disc in discs)
    known = not loose and not any(disc.stands_askew for disc in discs)
    for row, angle in enumerate(crank_angle):
        free = float(found.play[row]) * scale + before[row]
        if found.preloaded[row]:
            answers.append(Comparison(outcome="preloaded", free=free))
            continue
        # The bound knows rigid members in the plane alone.
        limit = _limit(discs, np.array([angle])) * scale + before[row] if known else free
        for part in (*PARTS, 1e-3) if loose else PARTS:  # what floats in clearances is balanced under more alone
            torque = part * drive.load.torque * np.array([1.0, -1.0])
            try:
                loaded = solve_at_output(model, [drive], np.full(2, angle), torque)
            except ConvergenceError:
                continue
            turned = abs(float(np.diff(wheel_angle_of_input(model, loaded))[0])) * scale
            overlap = (
                _pressed(model, loaded)
                if not known
                else np.max(
                    [
                        pair_approaches(
                            disc, np.full(2, angle), loaded.pose[:, np.append(np.arange(3) + own * number, -1)]
                        )[0]
                        for number, disc in enumerate(discs)
                    ]
                )
            )
            yielding = float(free_play(discs, np.array([angle]), overlap=float(overlap)).play[0]) * scale + before[row]
            outcome = "wrong"
            if abs(turned - free) <= max(0.005, 0.01 * turned):
                outcome = "alike"
            elif free - 1e-3 <= turned <= yielding + 1e-3 and abs(limit - free) <= max(0.005, 0.01 * free):
                outcome = "settling"
            answers.append(
                Comparison(outcome=outcome, free=free, limit=limit, loaded=turned, yielding=yielding, part=part)
            )
            break
        else:
            answers.append(Comparison(outcome="not balanced", free=free, limit=limit))
    return answers
