"""Closed-form values of all candidates at once: rigid bodies on linear contacts, Hertz, ISO 281.

The crank is held, disc and wheel touch where their common normals pass through the pitch point (distance e z_P from the axis
of the wheel). A pin at φ has the lever l = e z_P R_C sin φ/d about that axis, d its distance from the pitch point, and the
gap Δr_P − ΔR_C (R_C − e z_P cos φ)/d of the offset flank; every contact yields in proportion to its load. Curvatures are
those of the trochoid, 1/ρ = (1 + z_P K1² − K1 (1 + z_P) cos φ)/(R_C S³) with S² = 1 + K1² − 2 K1 cos φ (convex positive).
What this leaves out is taken in by what `ltca.studies.design_search.solution` says of the loaded drive.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ltca.analysis.life.ratings import BEARING_STEEL, STATIC_RATING_FACTOR
from ltca.analysis.torque_curve import LOST_MOTION
from ltca.arrays import FloatArray
from ltca.drive.members.judgement import ANYWHERE
from ltca.drive.parts import contact_modulus
from ltca.drive.units.quantities import ARCMIN
from ltca.geometry.flank import trochoid_curvature
from ltca.studies.design_search.requirements import CLEARANCES, Requirements
from ltca.studies.design_search.sizes import Sizes, stack_length
from ltca.studies.design_search.surroundings import seat_depth

PIN_PHASES = 4
"""Phases of the pins within a pitch at which loads are evaluated."""
CURVATURE_POINTS = 33
"""Points on half a lobe at which its curvature is evaluated."""
LINE_CONTACT_FACTOR = 10.0
"""π E* L/F times the approach of a line contact: Palmgren's 3.84e-5 F^0.9/L^0.8 gives 8 to 12 for steel."""
MAX_NEWTON_STEPS = 8
"""Of the wind-up: its equation is convex and piecewise linear, so from the far side Newton's steps converge monotonically."""
TURN_POSITIONS = 12
"""Positions of a turn over which the loads of several cranks are averaged."""
ROLLER_BY_PITCH = 0.3
"""Largest diameter of a roller by the pitch circle of its bearing: as far as ratings are compared with tabulated factors."""
PIN_SPACING = 4.5
"""Largest distance of neighbouring wheel pins by their diameter: published drives have 1 to 4.05."""
PIN_ASPECT = 10.0
"""Largest length of a wheel pin by its diameter, typical of dowel pins."""
LEAST_TOLD_SHARE = 0.02
"""Share of a disc below which closed forms tell none apart."""
TINY = 1e-9
"""Keeps denominators and roots from zero."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Setting:
    """Values that all candidates share.

    Attributes
    ----------
    flank, outer, inner, hole : float
        Contact moduli of flank, bore, inner race and holes, MPa.
    pin_modulus : float
        E of shaft pins, MPa.
    softer : float
        The lesser E of disc and wheel pins, MPa.
    requirements : Requirements
        What is asked.
    """

    flank: float
    outer: float
    inner: float
    hole: float
    pin_modulus: float
    softer: float
    requirements: Requirements

    @classmethod
    def of(cls, requirements: Requirements) -> Setting:
        """Return that of requirements."""
        parts = requirements.materials
        return cls(
            flank=contact_modulus(parts.disc, parts.wheel_pin),
            outer=contact_modulus(parts.disc, parts.roller),
            inner=contact_modulus(parts.inner_race, parts.roller),
            hole=contact_modulus(parts.disc, parts.shaft_pin),
            pin_modulus=parts.shaft_pin.youngs_modulus,
            softer=min(parts.disc.youngs_modulus, parts.wheel_pin.youngs_modulus),
            requirements=requirements,
        )


def shape_values(sizes: Sizes, setting: Setting) -> dict[str, FloatArray]:
    """Return room and margins of the shape by name, mm: exact but for the places at which curvatures are evaluated."""
    asked, shop = setting.requirements.asked, setting.requirements.asked.shop
    found = flank_shape(sizes, setting)
    inner = sizes.bore - 2.0 * sizes.roller_radius
    bore = sizes.bore + 0.5 * sizes.bearing_clearance
    root = sizes.pin_circle + sizes.shifting_offset - sizes.eccentricity - sizes.pin_radius - sizes.equidistant_offset
    speed_up = asked.ratio / (sizes.stage * asked.number_of_cranks if asked.kind == "rv" else 1.0)
    shaft = 0.5 * (16.0 * sizes.torque / speed_up / (np.pi * shop.crankshaft_shear)) ** (1.0 / 3.0)
    pitch = inner + sizes.roller_radius
    chord = pitch * np.sin(np.pi / sizes.rollers) - sizes.roller_radius
    found |= {
        "torque": sizes.torque,
        "roller_gap": 2.0 * chord,
        "cage_room": 2.0 * chord - shop.roller_gap(2.0 * sizes.roller_radius),
        "race": inner - sizes.eccentricity - shaft,
        "roller_room": sizes.thickness - sizes.roller_length,
        "bearing_proportion": pitch - sizes.roller_radius / ROLLER_BY_PITCH,
    }
    found |= {name: getattr(sizes, name) for name in CLEARANCES}
    found["ring_seat"] = seat_depth(sizes.pin_circle, sizes.pin_radius, sizes.eccentricity)
    if asked.kind == "rv":
        circle = sizes.hole_circle
        between = 2.0 * (circle * np.sin(np.pi / asked.number_of_cranks) - bore)
        found["wall"] = np.minimum(np.minimum(root - circle - bore, between), circle - bore)
        return found
    hole = sizes.hole_pin + sizes.eccentricity + sizes.pin_hole_clearance
    walls = (
        root - sizes.hole_circle - hole,
        sizes.hole_circle - hole - bore,
        2.0 * (sizes.hole_circle * np.sin(np.pi / sizes.holes) - hole),
    )
    return found | {"wall": np.minimum.reduce(walls)}


def flank_shape(sizes: Sizes, setting: Setting) -> dict[str, FloatArray]:
    """Return those of `shape_values` that depend on the flank and its pins alone."""
    shop = setting.requirements.asked.shop
    generating = sizes.pin_radius + sizes.equidistant_offset
    K1 = sizes.eccentricity * sizes.pins / sizes.pin_circle
    # Of the offset flank the gap is Δr_P − ΔR_C cos of an angle whose cosine goes from √(1 − K1²) to 1.
    taken = sizes.shifting_offset * np.where(sizes.shifting_offset > 0.0, 1.0, np.sqrt(np.maximum(1.0 - K1**2, 0.0)))
    spacing = sizes.pin_circle * np.sin(np.pi / sizes.pins)
    stack = stack_length(sizes, shop.disc_gap)
    convex, hollow = _locus(sizes, np.cos(np.linspace(0.0, np.pi, CURVATURE_POINTS)))
    return {
        "outer_diameter": 2.0 * (sizes.pin_circle + sizes.pin_radius + shop.housing_wall),
        "length": stack + shop.flanges,
        "undercut_margin": 1.0 / np.maximum(convex, TINY) - generating,
        # A hollow of the path of the centres is rounder by the pin on the flank, so the pin always fits by the offset.
        "pin_hollow_margin": 1.0 / np.maximum(-hollow, TINY) + sizes.equidistant_offset,
        "pin_gap": 2.0 * (spacing - sizes.pin_radius),
        "pin_size": sizes.pin_radius - spacing / PIN_SPACING,
        "pin_slenderness": 2.0 * PIN_ASPECT * sizes.pin_radius - stack,
        "flank_clearance": sizes.equidistant_offset - taken,
    }


def _locus(sizes: Sizes, cosine: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Largest and least curvature of the path of the pins' centres over the disc, 1/mm."""
    each = _locus_curvature(sizes, cosine)
    return each.max(axis=1), each.min(axis=1)


def _locus_curvature(sizes: Sizes, cosine: FloatArray) -> FloatArray:
    return trochoid_curvature(sizes.pin_circle[:, None], sizes.eccentricity[:, None], sizes.pins[:, None], cosine)


def flank_values(sizes: Sizes, setting: Setting) -> dict[str, FloatArray]:
    """Return values of the flank for one number of pins: pressure, load, forces on the disc, stiffness, play, losses."""
    asked = setting.requirements.asked
    pins = int(sizes.pins[0])
    angle = 2.0 * np.pi * (np.arange(pins)[:, None] + np.arange(PIN_PHASES) / PIN_PHASES) / pins
    sine, cosine = np.sin(angle).ravel(), np.cos(angle).ravel()
    upper = sine > TINY
    sine, cosine, phase = sine[upper], cosine[upper], np.tile(np.arange(PIN_PHASES), pins)[upper]
    R, reach = sizes.pin_circle[:, None], (sizes.eccentricity * sizes.pins)[:, None]
    distance = np.sqrt(np.maximum(R**2 + reach**2 - 2.0 * R * reach * cosine, TINY))
    lever = reach * R * sine / distance
    gap = sizes.equidistant_offset[:, None] - sizes.shifting_offset[:, None] * (R - reach * cosine) / distance
    stiffness = (np.pi * setting.flank * sizes.thickness / LINE_CONTACT_FACTOR)[:, None]
    torque = wheel_torque(sizes, setting) / sizes.discs
    generating = (sizes.pin_radius + sizes.equidistant_offset)[:, None]
    locus = _locus_curvature(sizes, cosine)
    curvature = locus / np.where(np.abs(1.0 - locus * generating) < TINY, TINY, 1.0 - locus * generating)
    relative = np.maximum(1.0 / sizes.pin_radius[:, None] + curvature, TINY)
    pressure, largest = np.zeros((2, sizes.count))
    radial, slope, rubbed, loaded = np.zeros((4, sizes.count))
    for place in range(PIN_PHASES):
        here = phase == place
        load, stiff = _shared(lever[:, here], gap[:, here], stiffness, torque)
        pressure = np.maximum(
            pressure, np.sqrt(load * setting.flank * relative[:, here] / (np.pi * sizes.thickness[:, None])).max(axis=1)
        )
        largest = np.maximum(largest, load.max(axis=1))
        radial += (load * (reach - R * cosine[here]) / distance[:, here]).sum(axis=1) / PIN_PHASES
        slope += stiff / PIN_PHASES
        rubbed += (load * np.abs(distance[:, here] - sizes.pin_radius[:, None])).sum(axis=1) / PIN_PHASES
        loaded += (load > 0.0).sum(axis=1) / PIN_PHASES
    clearance = np.maximum((gap / lever).min(axis=1), 0.0)
    rubbing = 0.0 if asked.friction is None else asked.friction.pin
    return {
        "pin_pressure_mid": pressure,
        "pin_load": largest,
        "mean_loaded_pins": loaded,
        "radial": radial,
        "wheel_stiffness": slope,
        "play": 2.0 * clearance,
        "flank_loss": rubbing * rubbed / sizes.pins,
    }


def _shared(
    lever: FloatArray, gap: FloatArray, stiffness: FloatArray, torque: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Loads of the pins, and the stiffness of all of them in rotation."""
    closed = np.ones(lever.shape, dtype=bool)
    for _ in range(MAX_NEWTON_STEPS):
        square = (stiffness * closed * lever**2).sum(axis=1)
        wind_up = (torque + (stiffness * closed * lever * gap).sum(axis=1)) / np.maximum(square, TINY)
        closed = wind_up[:, None] * lever > gap
        closed[~closed.any(axis=1)] = True
    load = stiffness * np.maximum(wind_up[:, None] * lever - gap, 0.0)
    return load, (stiffness * closed * lever**2).sum(axis=1)


def wheel_torque(sizes: Sizes, setting: Setting) -> FloatArray:
    """Return the moment on the wheel, all discs together, N·mm."""
    asked = setting.requirements.asked
    if asked.held == "pin-shaft":
        return sizes.torque
    if asked.kind == "rv":
        return np.asarray(sizes.torque * sizes.stage * sizes.pins / (1.0 + sizes.stage * sizes.pins))
    return np.asarray(sizes.torque * sizes.pins / (sizes.pins - 1.0))


def inner_values(sizes: Sizes, setting: Setting, flank: dict[str, FloatArray]) -> dict[str, FloatArray]:
    """Return values of crank bearings, holes and the whole drive, from those of the flank (`flank_values`)."""
    asked, shop = setting.requirements.asked, setting.requirements.asked.shop
    several, friction = asked.kind == "rv", asked.friction
    torque = wheel_torque(sizes, setting) / sizes.discs
    reach = sizes.eccentricity * sizes.pins
    across, on_disc = torque / reach, torque * (sizes.pins - 1.0) / sizes.pins
    found: dict[str, FloatArray] = {}
    holes = np.zeros(sizes.count)
    if several:
        radial, count = flank["radial"], asked.number_of_cranks
        turning = np.exp(2j * np.pi * np.arange(TURN_POSITIONS) / TURN_POSITIONS)
        push = (across * 1j - radial)[:, None] / count + (on_disc / (count * sizes.hole_circle))[:, None] * turning
        force = np.abs(push)
        most, mean = force.max(axis=1), (force ** (10.0 / 3.0)).mean(axis=1) ** 0.3
        whirl = (np.pi * setting.outer * sizes.roller_length / LINE_CONTACT_FACTOR) * sizes.rollers / 8.0
        turning_compliance = (1.0 - 1.0 / sizes.pins) ** 2 / (whirl * count * sizes.hole_circle**2)
        bearings = float(count)
    else:
        bearings = 1.0
        holes = 4.0 * on_disc / (np.pi * sizes.hole_circle)
        most = mean = np.hypot(across, holes - flank["radial"])
        load = 4.0 * on_disc / (sizes.holes * sizes.hole_circle)
        closer = 1.0 / sizes.hole_pin - 1.0 / (sizes.hole_pin + sizes.eccentricity)
        found["pin_shaft_load"] = load
        found["pin_shaft_pressure_mid"] = np.sqrt(load * setting.hole * closer / (np.pi * sizes.thickness))
        spring = np.pi * setting.hole * sizes.thickness / LINE_CONTACT_FACTOR
        if shop.shaft_pin_stiffness is None:
            span = stack_length(sizes, shop.disc_gap) + 2.0 * shop.disc_gap
            diameter = 2.0 * sizes.hole_pin
            found["shaft_pin_bending_stress"] = 4.0 * load * sizes.discs * span / (np.pi * diameter**3)
            # Pulsating: the equivalent amplitude of Smith, Watson and Topper (`ltca.analysis.verdict.pin_stress`).
            found["shaft_pin_bending_amplitude"] = found["shaft_pin_bending_stress"] / np.sqrt(2.0)
            found["shaft_pin_shear_stress"] = 8.0 * load * sizes.discs / (3.0 * np.pi * diameter**2)
            beam = 192.0 * setting.pin_modulus * np.pi * diameter**4 / 64.0 / span**3
            spring = 1.0 / (1.0 / spring + sizes.discs / beam)
        else:
            spring = np.full(sizes.count, shop.shaft_pin_stiffness)
        turning_compliance = (1.0 - 1.0 / sizes.pins) ** 2 / (0.25 * sizes.holes * spring * sizes.hole_circle**2)
    found["disc_share"] = np.ones(sizes.count)
    roller = 4.0 * most / sizes.rollers
    inner = sizes.bore - 2.0 * sizes.roller_radius
    bore = sizes.bore + 0.5 * sizes.bearing_clearance
    line = roller / (np.pi * sizes.roller_length)
    found["bearing_load"], found["roller_load"] = most, roller
    found["roller_pressure_mid_outer"] = np.sqrt(line * setting.outer * (1.0 / sizes.roller_radius - 1.0 / bore))
    found["roller_pressure_mid_inner"] = np.sqrt(line * setting.inner * (1.0 / sizes.roller_radius + 1.0 / inner))
    found |= lives_by_loads(sizes, setting, most, mean)
    seat = bearings * np.pi * setting.outer * sizes.roller_length / LINE_CONTACT_FACTOR * sizes.rollers / 8.0
    alone = 1.0 / flank["wheel_stiffness"] + 1.0 / (seat * reach**2)
    compliance = alone + turning_compliance
    if not several and shop.shaft_pin_stiffness is None:
        turned = (1.0 - 1.0 / sizes.pins) ** 2 / (0.25 * sizes.holes * sizes.hole_circle**2)
        contact = np.pi * setting.hole * sizes.thickness / LINE_CONTACT_FACTOR
        found["disc_share"] = disc_shares(sizes, setting, alone + turned / contact, turned)
    leverage = wheel_torque(sizes, setting) / sizes.torque
    found["stiffness"] = sizes.discs / (compliance * leverage**2)
    found["backlash_output"] = (flank["play"] + clearance_play(sizes, setting)) * leverage * ARCMIN
    elastic = 2.0 * LOST_MOTION * sizes.torque / found["stiffness"]
    found["lost_motion"] = found["backlash_output"] + elastic * ARCMIN
    if friction is not None:
        rolling = friction.roller * bearings * mean * (inner + sizes.roller_radius)
        lost = flank["flank_loss"] + friction.hole * sizes.eccentricity * holes + rolling
        lost = lost + friction.support_bearing * friction.support_bearing_radius * across
        lost = lost + friction.no_load_torque / sizes.discs * asked.ratio / sizes.pins
        found["mean_efficiency"] = 1.0 - lost / (torque / sizes.pins + lost)
    worst = np.maximum(flank["pin_pressure_mid"], found["roller_pressure_mid_outer"])
    worst = np.maximum(worst, found.get("pin_shaft_pressure_mid", worst))
    found["disc_shear"], found["contact_strain"] = 0.3 * worst, flank["pin_pressure_mid"] / setting.softer
    # b = 2 p ρ/E* with ρ below the pin's radius: what half-spaces allow is a part of that radius.
    found["half_width_ratio"] = 2.0 * flank["pin_pressure_mid"] / setting.flank
    if not several:  # 1/ρ = 1/r − 1/(r + e) of a pin in its hole
        in_holes = 2.0 * found["pin_shaft_pressure_mid"] / setting.hole * (sizes.hole_pin / sizes.eccentricity + 1.0)
        found["half_width_ratio"] = np.maximum(found["half_width_ratio"], in_holes)
    return found


def disc_shares(sizes: Sizes, setting: Setting, alone: FloatArray, turned: FloatArray) -> FloatArray:
    """Return the torque of the least loaded disc by an even share, of discs on shaft pins whose tips a free ring ties.

    `alone` is the compliance of one disc by itself in rotation of the wheel, rad/(N·mm), `turned` that of pins by the
    displacement of one under a unit force. The ring turns on, so a pin is clamped in the flange and guided at its tip: discs near
    the ring yield more.
    """
    shop = setting.requirements.asked.shop
    share = np.ones(sizes.count)
    for several in np.unique(sizes.discs[sizes.discs > 1.0]):
        rows, count = np.flatnonzero(sizes.discs == several), int(several)
        pitch = sizes.thickness[rows] + shop.disc_gap
        span = stack_length(sizes, shop.disc_gap)[rows] + 2.0 * shop.disc_gap
        place = 0.5 * span[:, None] + pitch[:, None] * (np.arange(count) - 0.5 * (count - 1))
        first, second = place[:, :, None], place[:, None, :]
        near, far = np.minimum(first, second), np.maximum(first, second)
        bent = near**2 * (3.0 * far - near) / 6.0 - first**2 * second**2 / (4.0 * span[:, None, None])
        rigidity = setting.pin_modulus * np.pi * (2.0 * sizes.hole_pin[rows]) ** 4 / 64.0
        matrix = bent * (turned[rows] / rigidity)[:, None, None] + alone[rows][:, None, None] * np.eye(count)
        torque = np.linalg.solve(matrix, np.ones((rows.size, count, 1)))[:, :, 0]
        # One that the others leave nothing comes out below zero.
        share[rows] = np.maximum(count * torque.min(axis=1) / torque.sum(axis=1), LEAST_TOLD_SHARE)
    return share


def clearance_play(sizes: Sizes, setting: Setting) -> FloatArray:
    """Return what clearances of crank bearings and holes add to the play of the flank at the wheel, rad.

    A disc that moves by the radial clearance turns the wheel by the lever e z_P; one that turns in its holes turns the wheel with
    it. Bores of several cranks bound both ways of moving together, so the shorter lever counts.
    """
    reach = sizes.eccentricity * sizes.pins
    if setting.requirements.asked.kind == "rv":
        return np.asarray(sizes.bearing_clearance / np.minimum(reach, sizes.hole_circle))
    turning = 2.0 * sizes.pin_hole_clearance * (1.0 - 1.0 / sizes.pins) / sizes.hole_circle
    return np.asarray(sizes.bearing_clearance / reach + turning)


def lives_by_loads(sizes: Sizes, setting: Setting, most: FloatArray, mean: FloatArray) -> dict[str, FloatArray]:
    """Return life by ISO 281 and static safety by ISO 76 (`ltca.analysis.life.ratings` for one drive), shape (candidates,).

    By the largest force of a crank bearing and the mean one by the power 10/3, N.
    """
    asked = setting.requirements.asked
    diameter, pitch = 2.0 * sizes.roller_radius, 2.0 * (sizes.bore - sizes.roller_radius)
    g = diameter / pitch
    races = 1.04 * ((1.0 - g) / (1.0 + g)) ** (143.0 / 108.0)
    shape = g ** (2.0 / 9.0) * (1.0 - g) ** (29.0 / 27.0) / (1.0 + g) ** 0.25
    # As lives are told by ISO 16281:2025: what allows for edges is taken out, where edges are reckoned.
    factor = 207.9 * shape * (1.0 + races**4.5) ** (-2.0 / 9.0)
    rating = (
        BEARING_STEEL * factor * sizes.roller_length ** (7.0 / 9.0) * sizes.rollers**0.75 * diameter ** (29.0 / 27.0)
    )
    life = (rating / mean) ** (10.0 / 3.0)
    turns = asked.speed * sizes.pins
    return {
        "bearing_life_million_turns": life,
        "bearing_life_hours": life * 1e6 / (60.0 * turns),
        "static_safety_S0": STATIC_RATING_FACTOR * (1.0 - g) * sizes.rollers * sizes.roller_length * diameter / most,
    }


def closed_forms(sizes: Sizes, setting: Setting) -> dict[str, FloatArray]:
    """Return the closed-form values of candidates of one number of pins.

    Names are those of `ltca.quantities.LIMITED` where there is one. Units are mm, N, MPa, h, arcmin and N·mm/rad. Pressures
    anywhere along the width are those of an even line: what ends and tilts add is left to the solution.
    """
    flank = flank_values(sizes, setting)
    found = shape_values(sizes, setting) | flank | inner_values(sizes, setting, flank)
    return found | {name: found[middle] for name, middle in ANYWHERE.items() if middle in found}
