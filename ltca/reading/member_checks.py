"""Checks of the members of a drive together: cranks, values per disc, supports, seats and beams of pins, duty."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from itertools import pairwise
from math import cos, degrees, fsum, pi, sin

from ltca.drive.fields import ANY, OWN
from ltca.drive.least_torque import torque_problem
from ltca.drive.members.first_stage import FirstStage
from ltca.drive.members.main_bearing import axial_preload
from ltca.drive.members.pins import PinShaft, PinWheel, ShaftPinBeam, WheelPinBeam
from ltca.drive.mistakes import entry_words
from ltca.drive.parts import BearingRow, CrankSupport, Drive, MainBearing, Material, Preload
from ltca.drive.ring_shape import ring_mesh_problems, seat_radius
from ltca.drive.units.table import range_of
from ltca.errors import Problem, counted
from ltca.reading.disc_checks import deviation_bound, part_errors
from ltca.reading.width_checks import find_width_problems

SHARE_ROUNDING = 1e-9
"""Round-off accepted in the sum of the shares of a duty."""
ROUNDING = 1e-9
"""Difference up to which lengths are equal, mm: round-off of a sum, and less than any real play."""
MOST_OF_BODY = 0.95
"""Largest rigid core of a pin, or fixed bore of a race, by its radius: thinner walls the default meshes do not resolve."""
MOST_WORKING_ANGLE = pi / 4.0
"""Largest working pressure angle: teeth cut at 20° and shifted as far as they go have some 30°."""
UNBALANCED = 0.01
"""Largest difference of the axial preloads of two rows, by the larger: displacements are written to two or three figures."""
BELONGS = {"radius": "slot", "pin_radius": "sleeve", "bore_radius": "sleeve"}
"""Fields of a seat, and the kind of seat they belong to."""
LARGEST_BOLT_CIRCLE = 1.5
"""Bolt circle by the outer radius of the ring, with room for lugs."""


def find_member_problems(drive: Drive) -> Iterator[Problem]:
    """Yield the problems of cranks, supports, pins, duty and values per disc, one sentence each."""
    yield from find_width_problems(drive)
    yield from _installation(drive)
    yield from _per_disc(drive)


def _installation(drive: Drive) -> Iterator[Problem]:
    """Problems of fields that belong to one crank or to several, and of supports, pins and duty."""
    crank, stage = drive.crank, drive.installation.first_stage_ratio
    if crank.number == 1:
        if drive.pin_shaft is None:
            yield Problem.of(
                "pin_shaft",
                "",
                "must be given with one crank (crank.number = 1), which alone cannot hold the disc against turning",
            )
        if crank.circle_radius is not None:
            yield Problem.of(
                "crank.circle_radius",
                f"= {crank.circle_radius:g} mm",
                "must be left out with one crank (crank.number = 1), which stands in the centre",
            )
        if crank.angle:
            yield Problem.of(
                "crank.angle",
                f"= {crank.angle:g} rad",
                "must be left out with one crank (crank.number = 1), which stands in the centre",
            )
        if stage is not None:
            yield Problem.of(
                "installation.first_stage_ratio",
                f"= {stage:g}",
                "must be left out with one crank (crank.number = 1), which is the input itself",
            )
    elif crank.circle_radius is None:
        yield Problem.of(
            "crank.circle_radius", "", f"must be given with several cranks (crank.number = {crank.number})"
        )
    if drive.pin_shaft is None:
        if drive.clearance.pin_hole:
            yield Problem.of(
                "clearance.pin_hole", f"= {drive.clearance.pin_hole:g} mm", "must be left out without a pin shaft"
            )
        for number, own in enumerate(drive.disc.of):
            if own.clearance is not None and own.clearance.pin_hole:
                yield Problem.of(
                    f"disc.of.{number}.clearance.pin_hole",
                    f"= {own.clearance.pin_hole:g} mm",
                    "must be left out without a pin shaft",
                )
        if drive.materials.shaft_pin != Material():
            yield Problem.of("materials.shaft_pin", "", "must be left out without a pin shaft")
    parts = (
        *_first_stage(drive),
        *_crank_support(drive),
        *_main_bearing(drive),
        *_race_bore(drive),
        *_ring(drive),
        *_carrier(drive),
    )
    yield from (*parts, *find_pin_problems(drive), *_torques(drive), *_duty(drive), *_vibrations(drive))


def _torques(drive: Drive) -> Iterator[Problem]:
    """Torques too small to be balanced."""
    if drive.tooth_number_difference == 0:
        return  # no ratio: a problem of its own
    problems = [*torque_problem(drive, "load.torque", drive.load.torque, zero=True)]
    yield from problems
    # One left out follows from the torque, which is to blame for both.
    if not (problems and drive.load.leaves_out_light_torque):
        name = drive.load.light_torque_name
        yield from torque_problem(drive, "load.light_torque", drive.load.light_torque, zero=False, shown=name)
    for number, entry in enumerate(drive.duty):
        yield from torque_problem(drive, f"duty.{number}.torque", entry.torque, zero=False)


def _ring(drive: Drive) -> Iterator[Problem]:
    """Problems of the ring that holds the wheel pins."""
    ring, wheel = drive.ring, drive.pin_wheel
    if ring is None:
        return
    inner, outer, circle = ring.inner_radius, ring.outer_radius, wheel.pin_circle_radius
    seat = seat_radius(wheel)
    if outer <= inner:
        yield Problem.of(
            "ring.outer_radius",
            f"= {outer:g} mm",
            f"must be greater than ring.inner_radius = {inner:g} mm",
            bound=("greater than", inner),
        )
        return
    if inner <= circle - seat:
        yield Problem.of(
            "ring.inner_radius",
            f"= {inner:g} mm",
            f"must be greater than {circle - seat:g} mm, where the wheel pins begin "
            "(pin_wheel.pin_circle_radius less the radius of the seat): they would not stand out of the ring",
            bound=("greater than", circle - seat),
        )
    if inner > circle + seat:
        yield Problem.of(
            "ring.inner_radius",
            f"= {inner:g} mm",
            f"must be at most {circle + seat:g} mm, where the wheel pins end (pin_wheel.pin_circle_radius "
            "plus the radius of the seat): they would not touch the ring",
            bound=("at most", circle + seat),
        )
    if outer <= circle + seat:
        yield Problem.of(
            "ring.outer_radius",
            f"= {outer:g} mm",
            f"must be greater than {circle + seat:g} mm, where the seats of the pins end "
            "(pin_wheel.pin_circle_radius plus the radius of the seat)",
            bound=("greater than", circle + seat),
        )
    if ring.flange == "one-side":
        yield Problem.of(
            "ring.flange",
            '= "one-side"',
            'must be "free" or "built-in": a flange on one side warps the ring, which no plane model has',
        )
    own, slots = ring.material.thermal_expansion, drive.materials.wheel_seat.thermal_expansion
    if own is not None and slots is not None and own != slots:
        yield Problem.of(
            "ring.material.thermal_expansion",
            f"= {own:g} 1/K",
            f"must equal materials.wheel_seat.thermal_expansion = {slots:g} 1/K, or leave one of them out: "
            "pin circle, slots and ring grow together",
            bound=("equal to", slots),
        )
    if ring.model == "fe" and circle - seat < inner <= circle + seat and outer > circle + seat:
        yield from ring_mesh_problems(drive)
    bolts = ring.bolts
    if bolts is None:
        return
    if ring.flange == "built-in":
        yield Problem.of(
            "ring.bolts",
            f"(number = {bolts.number})",
            'must be left out with ring.flange = "built-in", where the housing holds the outer face all around',
        )
    if not inner <= bolts.circle_radius:
        yield Problem.of(
            "ring.bolts.circle_radius",
            f"= {bolts.circle_radius:g} mm",
            f"must be at least ring.inner_radius = {inner:g} mm",
            bound=("at least", inner),
        )
    if bolts.circle_radius > LARGEST_BOLT_CIRCLE * outer:
        yield Problem.of(
            "ring.bolts.circle_radius",
            f"= {bolts.circle_radius:g} mm",
            f"must be at most {LARGEST_BOLT_CIRCLE * outer:g} mm, {LARGEST_BOLT_CIRCLE:g} times "
            "ring.outer_radius: bolts stand in the ring",
            otherwise="in lugs on it",
            bound=("at most", LARGEST_BOLT_CIRCLE * outer),
        )


def _first_stage(drive: Drive) -> Iterator[Problem]:
    """Problems of the teeth of the first stage, alone and beside cranks and the ratio that is given."""
    stage, crank, given = drive.first_stage, drive.crank, drive.installation.first_stage_ratio
    if stage is None:
        return
    teeth = "first_stage.planet_teeth", f"= {stage.planet_teeth} by first_stage.sun_teeth = {stage.sun_teeth}"
    if crank.number == 1:
        yield Problem.of(
            "first_stage", "", "must be left out with one crank (crank.number = 1), which is the input itself"
        )
        return
    if given is not None and abs(given - stage.ratio) > ROUNDING * stage.ratio:
        yield Problem.of(
            "installation.first_stage_ratio",
            f"= {given:g}",
            f"must be {stage.ratio:.12g}, {' '.join(teeth)}, or be left out",
        )
    yield from _planets_plane(drive, stage)
    if crank.support is not None and (crank.support.clearance or 0.0) > 0.0:
        yield Problem.of(
            "crank.support.clearance",
            f"= {crank.support.clearance:g} mm",
            "must be at most 0 beside first_stage: cranks that float in their bearings leave the planets no "
            "place in the mesh; give crank.support.preload or a clearance of 0 or less, or "
            "installation.first_stage_ratio in place of the teeth",
            bound=("at most", 0.0),
        )
    if crank.circle_radius is None:
        return
    distance, reference = crank.circle_radius, stage.reference_distance()
    cause = teeth if stage.module is None else ("first_stage.module", f"= {stage.module:g} mm")
    try:
        mesh = stage.mesh(distance)
    except ValueError:
        least = (reference or 0.0) * cos(stage.transverse_pressure_angle)
        yield Problem.of(
            *cause,
            f"teeth do not reach each other, crank.circle_radius = {distance:g} mm must be at least "
            f"{least:.6g} mm, the radii of the base circles of sun and planet together",
        )
        return
    if mesh.working_angle > MOST_WORKING_ANGLE:
        yield Problem.of(
            *cause,
            f"the working pressure angle at crank.circle_radius = {distance:g} mm is "
            f"{degrees(mesh.working_angle):.4g}°: must be at most {degrees(MOST_WORKING_ANGLE):g}°; the "
            f"reference circles touch at {reference or distance:.6g} mm",
        )
    apart = 2.0 * distance * sin(pi / crank.number)
    if 2.0 * mesh.pitch_radius >= apart:
        yield Problem.of(
            *teeth,
            f"planets of {2.0 * mesh.pitch_radius:.6g} mm cut into each other, neighbouring cranks stand "
            f"{apart:.6g} mm apart (crank.circle_radius, crank.number)",
        )
    if mesh.backlash_angle(stage.backlash) >= 0.5 * pi / stage.planet_teeth:
        most = 0.5 * pi / stage.planet_teeth * mesh.pitch_radius
        yield Problem.of(
            "first_stage.backlash",
            f"= {stage.backlash:g} mm",
            f"must be less than {most:.4g} mm, a quarter of the pitch of the teeth",
            bound=("less than", most),
        )
    yield from _runout_of_teeth(stage, crank.number, distance)


def _runout_of_teeth(stage: FirstStage, cranks: int, distance: float) -> Iterator[Problem]:
    """Problems of the eccentricities of sun and planets, which must not jam the mesh."""
    runout, path = stage.planet_runout, "first_stage.planet_runout"
    for name, values in (("amount", runout.amount), ("angle", runout.angle)):
        if values and len(values) != cranks:
            yield Problem.of(
                f"{path}.{name}",
                f"has {counted(len(values), 'values')}",
                f"must have {cranks}, one for each of the planets",
            )
    closed = stage.closed_by_runout(distance)
    if closed > stage.backlash:
        given = {"first_stage.sun_runout.amount": stage.sun_runout.amount}
        given[f"{path}.amount"] = max(runout.amount, key=abs, default=0.0)
        named = ", ".join(f"{name} = {value:g} mm" for name, value in given.items() if value)
        yield Problem.of(
            "first_stage.backlash",
            f"= {stage.backlash:g} mm",
            f"must be at least {closed:.4g} mm beside {named}: teeth that stand off their axes close the "
            "backlash by 2 tan α_wt of both eccentricities",
            otherwise="they jam",
            bound=("at least", closed),
        )


def _planets_plane(drive: Drive, stage: FirstStage) -> Iterator[Problem]:
    """Problems of the place of the planets along the axis, that where twisting cranks are held."""
    path, support = "first_stage.plane", drive.crank.support
    beside = "crank.support" if support is not None else "carrier.posts" if drive.crank_supports is not None else None
    if beside is None and drive.wheel_is_held and (drive.wheel_yields or drive.load.external):
        own = "main_bearing" if drive.main_bearing is not None else "pin_wheel.support_stiffness"
        beside = own if drive.wheel_yields else "load.external"
    if stage.plane is None:
        if beside is not None:
            yield Problem.of(
                path,
                "",
                f"must be given with {beside}, mm on the axis of disc.planes: the forces of the teeth act there",
            )
    elif support is not None and support.torsion and support.spline_plane not in (None, stage.plane):
        yield Problem.of(
            path,
            f"= {stage.plane:g} mm",
            f"must be crank.support.spline_plane = {support.spline_plane:g} mm, where the planets are fixed "
            "on the cranks",
        )


def _duty(drive: Drive) -> Iterator[Problem]:
    total = fsum(entry.share for entry in drive.duty)
    if drive.duty and abs(total - 1.0) > SHARE_ROUNDING:
        named = ", ".join(f"duty.{number}.share = {entry.share:g}" for number, entry in enumerate(drive.duty))
        yield Problem.of("duty", "", f"must add up to 1, they add up to {total:.10g}", shown=named)
    if drive.lubricant is not None and not drive.duty and drive.load.speed is None:
        yield Problem.of(
            "lubricant.viscosity",
            f"= {drive.lubricant.viscosity:g} mm²/s",
            "needs a speed, load.speed or those of [[duty]]; without one no film can be computed",
        )


def _vibrations(drive: Drive) -> Iterator[Problem]:
    """Problems of inertias and damping, which concern vibrations alone."""
    damping, given = drive.damping, drive.inertia
    if damping is not None and (damping.ratio is None) == (damping.loss_factor is None):
        told = "both are" if damping.ratio is not None else "neither is"
        both = "damping.ratio, damping.loss_factor"
        yield Problem.of("damping", "", f"one of the two must be given, {told}", shown=both)
    if given is not None and given.output_mass is not None and not drive.wheel_yields:
        yield Problem.of(
            "inertia.output_mass",
            f"= {given.output_mass:g} kg",
            "must be left out without main_bearing (or pin_wheel.support_stiffness), where the output turns "
            "about a fixed axis",
        )


def _crank_support(drive: Drive) -> Iterator[Problem]:
    support = drive.crank.support
    if support is None:
        own = drive.materials.crankshaft
        bare = replace(own, density=None)
        expands = drive.temperature is not None and own.thermal_expansion is not None
        if bare != Material() and not expands:
            yield Problem.of(
                "materials.crankshaft",
                "",
                "must be left out without crank.support, where cranks are rigid, but for its density and for its "
                "thermal_expansion beside [temperature]",
            )
        return
    yield from _crank_bearings(support, drive.crank.eccentricity)
    yield from _spline(support, drive.disc.disc_planes)
    start, end = support.positions
    if end <= start:
        yield Problem.of("crank.support.positions", f"holds {start:g} and {end:g} mm", "must ascend")
        return
    bore = 2.0 * drive.crank_bearing.inner_race_radius
    if support.diameter > bore:
        yield Problem.of(
            "crank.support.diameter",
            f"= {support.diameter:g} mm",
            f"must be at most {bore:g} mm, the diameter of the inner race on it",
            bound=("at most", bore),
        )
    planes = drive.disc.disc_planes
    reach = end - start
    for plane in (min(planes), max(planes)):
        if not start - reach <= plane <= end + reach:
            yield Problem.of(
                "crank.support.positions",
                f"holds {start:g} and {end:g} mm",
                f"a disc at {plane:g} mm (disc.planes) hangs over by more than their distance {reach:g} mm",
            )
            return


def _carrier(drive: Drive) -> Iterator[Problem]:
    """Problems of the flanges of the carrier, of its posts and of their material."""
    carrier, shaft = drive.carrier, drive.pin_shaft
    posts = None if carrier is None else carrier.posts
    if posts is None and drive.materials.carrier != Material() and not _expands(drive, "carrier"):
        yield Problem.of(
            "materials.carrier",
            "",
            "must be left out without carrier.posts, where the flanges do not yield, but for its "
            "thermal_expansion beside [temperature]",
        )
    if carrier is None:
        return
    if posts is None:
        if carrier.flange is not None:
            near, far = carrier.flange
            yield Problem.of(
                "carrier.flange",
                f"= [{near:g}, {far:g}] mm",
                "must be left out without carrier.posts, which tie the flanges and bend them",
            )
        elif carrier.stiffness_torsion is None:
            yield Problem.of(
                "carrier", "", "is empty; give carrier.stiffness_torsion, carrier.posts or both, or leave the table out"
            )
        return
    room = posts.radius * sin(pi / posts.number)
    if posts.size >= 2.0 * room:
        yield Problem.of(
            "carrier.posts.size",
            f"= {posts.size:g} mm",
            f"must be less than {2.0 * room:.6g} mm, the distance of {posts.number} posts on a circle of "
            f"radius {posts.radius:g} mm (carrier.posts.number, carrier.posts.radius)",
            bound=("less than", 2.0 * room),
        )
    reach = 2.0 * max(abs(plane) for plane in drive.disc.disc_planes) + drive.disc.thickness
    if posts.length is not None and posts.length < reach - ROUNDING * max(reach, 1.0):
        yield Problem.of(
            "carrier.posts.length",
            f"= {posts.length:g} mm",
            f"must be at least {reach:.6g} mm",
            otherwise="the discs are not between the flanges (disc.planes, disc.thickness)",
            bound=("at least", reach),
        )
    if shaft is None:
        return
    if shaft.beam is None:
        beams = 'pins between two flanges are beams (pin_shaft.beam with tip = "tied-clamped" or "tied-pinned")'
        if shaft.stiffness is None:
            yield Problem.of("pin_shaft.beam", "", f"must be given beside carrier.posts; {beams}")
        else:
            value = f"= {shaft.stiffness:g} N/mm"
            yield Problem.of("pin_shaft.stiffness", value, f"must be left out beside carrier.posts; {beams}")
    elif shaft.beam.tip == "free":
        yield Problem.of(
            "pin_shaft.beam.tip",
            '= "free"',
            'must be "tied-clamped" or "tied-pinned" beside carrier.posts, whose far flange holds the tips '
            "of the shaft pins",
        )


def _crank_bearings(support: CrankSupport, eccentricity: float) -> Iterator[Problem]:
    """Problems of the two bearings of a crank: how their stiffness, clearance and preload are given."""
    path = "crank.support"
    tapered = {"contact_angle": support.contact_angle, "load_constant": support.load_constant}
    if not any(value is not None for value in tapered.values()):
        if len(support.stiffness) != 2:
            yield Problem.of(
                f"{path}.stiffness",
                f"has {counted(len(support.stiffness), 'values')}",
                "must have 2, one for each bearing",
            )
    else:
        if support.stiffness:
            yield Problem.of(
                f"{path}.stiffness",
                "",
                f"must be left out beside {path}.contact_angle and {path}.load_constant, from which the stiffness "
                "of tapered rollers follows",
            )
        for name, value in tapered.items():
            if value is None:
                yield Problem.of(
                    f"{path}.{name}",
                    "",
                    f"must be given with tapered rollers, beside {path}.contact_angle and {path}.load_constant",
                )
        if support.preload is None:
            yield Problem.of(
                f"{path}.preload", "", f"must be given with {path}.load_constant, whose stiffness is that at a preload"
            )
        if support.contact_angle is not None:
            yield from _contact_angle(f"{path}.contact_angle", support.contact_angle)
    yield from _loose_or_tight(path, support.clearance, support.preload, eccentricity)


def _spline(support: CrankSupport, planes: tuple[float, ...]) -> Iterator[Problem]:
    """Problems of the place where a twisting crank is held."""
    path, place = "crank.support.spline_plane", support.spline_plane
    if not support.torsion:
        if place is not None:
            yield Problem.of(path, f"= {place:g} mm", "must be left out without crank.support.torsion = true")
    elif place is None:
        yield Problem.of(path, "", "must be given with crank.support.torsion = true: the shaft twists from there")
    elif place in planes:
        yield Problem.of(
            path,
            f"= {place:g} mm",
            "must be another place than that of a disc (disc.planes), whose eccentric is no spline",
        )


def _contact_angle(path: str, angle: float) -> Iterator[Problem]:
    if not 0.0 < angle < 0.5 * pi:
        yield Problem.of(path, f"= {angle:g} rad", f"must be greater than 0 and less than {0.5 * pi:.6g} rad")


def _loose_or_tight(
    path: str, clearance: float | None, preload: Preload | None, eccentricity: float
) -> Iterator[Problem]:
    """Problems of clearance and preload of one bearing."""
    most = 0.5 * eccentricity
    for name, value in (
        ("clearance", clearance),
        ("preload.displacement", None if preload is None else preload.displacement),
    ):
        if value is not None and abs(value) > most:
            yield Problem.of(
                f"{path}.{name}",
                f"= {value:g} mm",
                f"must be at most {most:g} mm in size, half the eccentricity",
                bound=("at most in size", most),
            )
    if preload is None:
        return
    if clearance is not None:
        yield Problem.of(
            f"{path}.clearance",
            f"= {clearance:g} mm",
            f"must be left out beside {path}.preload: a bearing is loose or tight",
        )
    yield from _one_preload(f"{path}.preload", preload)


def _one_preload(path: str, preload: Preload) -> Iterator[Problem]:
    if (preload.force is None) == (preload.displacement is None):
        yield Problem.of(path, "", "must be either a force (N) or a displacement (mm)")


def _main_bearing(drive: Drive) -> Iterator[Problem]:
    bearing, alias = drive.main_bearing, drive.pin_wheel.support_stiffness
    if bearing is None:
        return
    path, radial = "main_bearing", bearing.radial_stiffness
    if alias is not None and radial is not None:
        yield Problem.of(
            f"{path}.radial_stiffness",
            f"= {radial:g} N/mm and pin_wheel.support_stiffness = {alias:g} N/mm",
            "are two names of one stiffness; give one of them",
        )
    if bearing.tilt_stiffness is not None and bearing.bearings:
        yield Problem.of(
            f"{path}.tilt_stiffness",
            f"= {bearing.tilt_stiffness:g} N·mm/rad",
            f"must be left out beside {path}.bearings, whose pressure centres bring it",
        )
    yield from _loose_or_tight(path, bearing.clearance, bearing.preload, drive.crank.eccentricity)
    if not bearing.bearings:
        if radial is None and alias is None:
            yield Problem.of(
                f"{path}.radial_stiffness",
                "",
                f"must be given, or {path}.bearings; left out with the whole table it is rigid",
            )
        if bearing.arrangement != "O":
            yield Problem.of(
                f"{path}.arrangement", f'= "{bearing.arrangement}"', f"must be left out without {path}.bearings"
            )
        return
    for name, value in (
        ("main_bearing.radial_stiffness", radial),
        ("pin_wheel.support_stiffness", alias),
        ("main_bearing.axial_stiffness", bearing.axial_stiffness),
    ):
        if value is not None:
            yield Problem.of(
                name, f"= {value:g} N/mm", f"must be left out beside {path}.bearings, from which it follows"
            )
    used, wrong = False, list[Problem]()
    for number, row in enumerate(bearing.bearings):
        wrong += _bearing_row(f"{path}.bearings.{number}", row, bearing)
        used = used or (bool(row.contact_angle) and row.preload is None)
    yield from wrong or _row_preloads(bearing)
    if bearing.preload is not None and not used:
        yield Problem.of(
            f"{path}.preload",
            "",
            f"must be left out where no row of {path}.bearings takes it (contact_angle, no preload of its own)",
        )
    placed = [row for row in bearing.bearings if row.contact_angle]
    if len(placed) > 2:
        yield Problem.of(
            f"{path}.bearings",
            f"has {len(placed)} rows with contact angles",
            f"must have at most 2, which face each other by {path}.arrangement; rows that face alike are one "
            "row of their load constants together",
        )
    elif len(placed) > 1 and len({row.plane for row in placed}) == 1:
        yield Problem.of(
            f"{path}.bearings",
            "",
            f"plane = {placed[0].plane:g} mm of all rows: rows with contact angles must stand in different planes",
        )
    if bearing.arrangement != "O" and len(placed) < 2:
        yield Problem.of(
            f"{path}.arrangement", f'= "{bearing.arrangement}"', "must be left out without two rows with contact angles"
        )


def _row_preloads(bearing: MainBearing) -> Iterator[Problem]:
    """Problems of axial preloads that are in no balance, of rows that are sound each by itself."""
    rows, forces = [], []
    for number, row in enumerate(bearing.bearings):
        if row.contact_angle:
            preload = row.preload or bearing.preload
            rows.append((f"main_bearing.bearings.{number}", row.preload))
            if preload is None:
                forces.append(0.0)
                continue
            force, _ = axial_preload(
                row.power,
                row.axial_stiffness,
                row.load_constant,
                force=preload.force,
                displacement=preload.displacement,
            )
            forces.append(force)
    if len(rows) == 1 and forces[0]:
        ((path, own),) = rows
        given = "main_bearing.preload" if own is None else f"{path}.preload"
        yield Problem.of(
            given,
            "",
            f"must be left out with one row with a contact angle ({path}), which has none to press against; "
            "give axial_stiffness in place of load_constant",
        )
    if len(rows) != 2:
        return
    ((first, _), (second, _)), (one, other) = rows, forces
    if not all(forces) and any(forces):
        given, left_out = (first, second) if one else (second, first)
        yield Problem.of(
            f"{left_out}.preload",
            "",
            f"must be given beside {given}.preload: rows that face each other press with one force",
        )
    elif abs(one - other) > UNBALANCED * max(one, other):
        yield Problem.of(
            first,
            f"and {second}",
            f"axial preloads of {one:.4g} and {other:.4g} N must be equal to {100.0 * UNBALANCED:g} %: rows that face each "
            "other press with one force; main_bearing.preload is that of both",
        )


def _bearing_row(path: str, row: BearingRow, bearing: MainBearing) -> Iterator[Problem]:
    """Problems of one row of the main bearing."""
    preload = row.preload or bearing.preload
    if row.preload is not None:
        yield from _one_preload(f"{path}.preload", row.preload)
        if bearing.clearance is not None:
            yield Problem.of(
                f"{path}.preload", "", "must be left out beside main_bearing.clearance: a bearing is loose or tight"
            )
    if row.contact_angle == 0.0:
        if row.kind in ("angular-contact ball", "tapered roller"):
            yield Problem.of(f"{path}.contact_angle", "", f'must be given with kind = "{row.kind}"')
            return
        if row.radial_stiffness is None:
            yield Problem.of(f"{path}.radial_stiffness", "", "must be given without a contact angle")
        for name in ("axial_stiffness", "load_constant", "pitch_radius"):
            value = getattr(row, name)
            if value is not None:
                yield Problem.of(f"{path}.{name}", f"= {value:g}", "must be left out without a contact angle")
        if row.preload is not None:
            yield Problem.of(
                f"{path}.preload",
                "",
                "must be left out without a contact angle; give main_bearing.clearance, negative where tight",
            )
        return
    if row.kind == "cylindrical":
        yield Problem.of(
            f"{path}.contact_angle", f"= {row.contact_angle:g} rad", 'must be left out with kind = "cylindrical"'
        )
        return
    yield from _contact_angle(f"{path}.contact_angle", row.contact_angle)
    if row.radial_stiffness is not None:
        yield Problem.of(
            f"{path}.radial_stiffness",
            f"= {row.radial_stiffness:g} N/mm",
            "must be left out with a contact angle, from which it follows",
        )
    if (row.axial_stiffness is None) == (row.load_constant is None):
        yield Problem.of(path, "", "must have either axial_stiffness or load_constant")
    if row.load_constant is not None and preload is None:
        yield Problem.of(
            f"{path}.load_constant",
            f"= {row.load_constant:g} N/mmⁿ",
            f"needs a preload, {path}.preload or main_bearing.preload",
        )


def _per_disc(drive: Drive) -> Iterator[Problem]:
    """Yield the problems of values per disc, which need an entry for every disc or none at all, one sentence each."""
    discs = drive.disc.number_of_discs
    for path, entries in (
        ("disc.phases", drive.disc.phases),
        ("disc.planes", drive.disc.planes),
        ("disc.of", drive.disc.of),
        ("crank.of", drive.crank.of if all(entry.disc is None for entry in drive.crank.of) else ()),
    ):
        if entries and len(entries) != discs:
            yield Problem.of(
                path,
                f"has {counted(len(entries), 'entries')}",
                f"must have {discs}, one for each disc (disc.number_of_discs)",
            )
    planes, thickness = sorted(drive.disc.planes), drive.disc.thickness
    if planes and drive.disc.gap:
        yield Problem.of(
            "disc.gap",
            f"= {drive.disc.gap:g} mm",
            "must be left out beside disc.planes, which say where the discs stand",
        )
    for before, after in pairwise(planes):
        if after - before < thickness * (1.0 - 1e-9):
            yield Problem.of(
                "disc.planes",
                f"holds {before:g} and {after:g} mm",
                f"must be at least {thickness:g} mm apart, the thickness of a disc",
                bound=("at least", thickness),
            )
    # One disc may be one of several checked alone; where shafts or pins bend, the axis has its zero at supports and beams.
    shaft = drive.pin_shaft
    posts = None if drive.carrier is None else drive.carrier.posts
    placed = (drive.crank.support, drive.pin_wheel.beam, None if shaft is None else shaft.beam, posts)
    if discs > 1 and not any(placed) and abs(sum(planes)) > 1e-6 * len(planes) * thickness:
        mean = sum(planes) / len(planes)
        yield Problem.of(
            "disc.planes",
            f"has the mean {mean:g} mm",
            "must be 0 mm, planes are centred on 0 where nothing bends",
            bound=("equal to", 0.0),
        )
    yield from _eccentric_problems(drive)
    bound = min(deviation_bound(drive), 0.5 * drive.crank.eccentricity) / drive.crank.eccentricity
    for number, entry in enumerate(drive.crank.of):
        if abs(entry.phase_error) > bound:
            yield Problem.of(
                f"crank.of.{number}.phase_error",
                f"= {entry.phase_error:g} rad",
                f"must be at most {bound:.4g} rad in size: the eccentric's centre moves by a tenth of the smallest pin or roller "
                "radius, or by half the eccentricity",
                shown=f"{_entry(drive, number)}: phase_error",
                bound=("at most in size", bound),
            )


def _eccentric_problems(drive: Drive) -> Iterator[Problem]:
    """Problems of the index keys of ``crank.of``, and of the errors of bores."""
    discs, cranks, entries = drive.disc.number_of_discs, drive.crank.number, drive.crank.of
    told = [entry.disc is not None for entry in entries]
    if entries and not all(told) and (any(told) or cranks > 1):
        number = told.index(False)
        further = f" and its crank (crank.number = {cranks})" if cranks > 1 else ", or none"
        yield Problem.of(
            f"crank.of.{number}.disc",
            "is left out",
            f"every entry must give its disc{further}",
            shown=f"{entry_words(number)}: disc",
        )
        return
    seen = set()
    for number, entry in enumerate(entries):
        if entry.disc is not None and entry.disc >= discs:
            yield Problem.of(
                f"crank.of.{number}.disc",
                f"= {entry.disc}",
                f"must be less than {discs}, the number of discs, which count from 0",
                shown=f"{entry_words(number)}: disc",
                bound=("less than", discs),
            )
        if entry.crank is not None and entry.crank >= cranks:
            yield Problem.of(
                f"crank.of.{number}.crank",
                f"= {entry.crank}",
                f"must be less than {cranks}, crank.number; cranks count from 0",
                shown=f"{entry_words(number)}: crank",
                bound=("less than", cranks),
            )
        if entry.crank is None and cranks > 1:
            yield Problem.of(
                f"crank.of.{number}.crank",
                "is left out",
                f"every entry must give its disc and its crank (crank.number = {cranks})",
                shown=f"{entry_words(number)}: crank",
            )
        if entry.disc is not None and (place := (entry.disc, entry.crank or 0)) in seen:
            said = f"disc {place[0]} on crank {place[1]} has an entry already"
            yield Problem.of(f"crank.of.{number}", "", said, shown=entry_words(number))
        seen.add((number if entry.disc is None else entry.disc, entry.crank or 0))
    bound = deviation_bound(drive)
    for number, own in enumerate(drive.disc.of):
        if own.bore_errors is None:
            continue
        if cranks == 1:
            for name in ("radial", "tangential"):
                yield Problem.of(
                    f"disc.of.{number}.bore_errors.{name}",
                    "",
                    "must be left out with one crank, whose bore is the centre of the disc (give disc.runout)",
                )
            continue
        yield from part_errors(f"disc.of.{number}.bore_errors", own.bore_errors, cranks, "bores", bound)
    size = min(bound, 0.5 * drive.crank.eccentricity)
    for number, entry in enumerate(entries):
        if cranks > 1 and abs(entry.eccentricity_error or 0.0) > size:
            yield Problem.of(
                f"crank.of.{number}.eccentricity_error",
                f"= {entry.eccentricity_error:g} mm",
                f"must be at most {size:g} mm in size, a tenth of the smallest pin or roller radius and half the eccentricity",
                shown=f"{_entry(drive, number)}: eccentricity_error",
                bound=("at most in size", size),
            )


def _entry(drive: Drive, number: int) -> str:
    """An entry of ``crank.of`` with disc and crank, where it gives them."""
    entry = drive.crank.of[number]
    told = [f"{name} {value}" for name, value in (("disc", entry.disc), ("crank", entry.crank)) if value is not None]
    return entry_words(number) + (f" ({', '.join(told)})" if told else "")


def named_in_disc(drive: Drive, problem: Problem, disc: int) -> Problem:
    """Return a problem of a drive of one disc as one of the whole drive, with the paths of the values per disc."""
    return problem.reworded(partial(_with_paths_of_disc, drive, disc))


def _with_paths_of_disc(drive: Drive, disc: int, problem: str) -> str:
    for common, own in OWN.items():
        table, _, name = own.replace(ANY, "").replace("..", ".").partition(".of.")
        if table == "crank" and drive.crank.number > 1:
            continue  # several cranks are checked with the whole drive
        entry = (drive.disc.of[disc] if drive.disc.of else None) if table == "disc" else drive.crank.eccentric(disc)
        if entry is not None and getattr(entry, name) is not None:
            # A table named by one word is a word of sentences as well: only what has a field behind it is a path.
            field = "" if "." in common else r"(?=\.)"
            problem = re.sub(rf"\b{re.escape(common)}\b{field}", own.replace(ANY, str(disc)), problem)
    return problem


def find_pin_problems(drive: Drive) -> Iterator[Problem]:
    """Yield the problems of seats and beams of pins and of their materials, one sentence each; single numbers are valid
    already.
    """
    wheel, shaft = drive.pin_wheel, drive.pin_shaft
    yield from _seat(wheel, "pin_wheel", 1.0, drive.crank.eccentricity)
    yield from _slots(wheel)
    yield from _core(wheel)
    if wheel.beam is not None:
        yield from _beam(drive, wheel, wheel.beam, "pin_wheel")
    if shaft is not None:
        yield from _seat(shaft, "pin_shaft", 0.5, drive.crank.eccentricity)
        if shaft.beam is not None:
            yield from _beam(drive, shaft, shaft.beam, "pin_shaft")
        yield from _one_compliance(shaft)
        if not shaft.elastic_contact and shaft.seat.kind == "sleeve":
            yield Problem.of(
                "pin_shaft.elastic_contact",
                "= false",
                'must be true with sleeves (pin_shaft.seat.kind = "sleeve"), which yield',
            )
    kinds = {wheel.seat.kind} | (set() if shaft is None else {shaft.seat.kind})
    if "slot" not in kinds and drive.materials.wheel_seat != Material() and not _expands(drive, "wheel_seat"):
        yield Problem.of(
            "materials.wheel_seat",
            "",
            'must be left out without slots (pin_wheel.seat.kind = "slot"), but for its thermal_expansion '
            "beside [temperature]",
        )
    if "sleeve" not in kinds and drive.materials.sleeve != Material():
        yield Problem.of(
            "materials.sleeve", "", 'must be left out without sleeves (pin_wheel.seat, pin_shaft.seat: kind = "sleeve")'
        )


def _expands(drive: Drive, part: str) -> bool:
    """Whether a material is used for its thermal expansion, whatever else it is given for."""
    return drive.temperature is not None and getattr(drive.materials, part).thermal_expansion is not None


def _one_compliance(shaft: PinShaft) -> Iterator[Problem]:
    if shaft.beam is None and shaft.stiffness is None:
        yield Problem.of(
            "pin_shaft.stiffness", "", "is missing; pins of the shaft need it, or pin_shaft.beam in its place"
        )
    elif shaft.beam is not None and shaft.stiffness is not None:
        yield Problem.of(
            "pin_shaft.stiffness",
            f"= {shaft.stiffness:g} N/mm",
            "must be left out beside pin_shaft.beam, which determines how the pins bend",
        )


def _seat(part: PinWheel | PinShaft, path: str, most: float, eccentricity: float) -> Iterator[Problem]:
    """Problems of the fields and radii of a seat; the play is at most the fraction `most` of the eccentricity."""
    kind = part.seat.kind
    given = {name: getattr(part.seat, name, None) for name in BELONGS}
    said = f'{path}.seat.kind = "{kind}"' + (" (the default)" if kind == "fixed" else "")
    sound = True
    for name, value in given.items():
        if value is not None and BELONGS[name] != kind:
            sound = False
            yield Problem.of(
                f"{path}.seat.{name}",
                f"= {value:g} mm",
                f'must be left out with {said}; it belongs to "{BELONGS[name]}"',
            )
        elif value is None and BELONGS[name] == kind:
            sound = False
            yield Problem.of(f"{path}.seat.{name}", "", f"must be given with {said}")
    if kind == "fixed" or not sound:
        return
    errors = part.pin_errors.diameter
    growth, shrinkage = max((*errors, 0.0)), -min((*errors, 0.0))
    play, largest, outer = part.seat_play, most * eccentricity, part.pin_radius
    inner, pin, bore, hole = (
        (outer, f"{path}.pin_radius", given["radius"] or 0.0, "radius")
        if kind == "slot"
        else (given["pin_radius"] or 0.0, f"{path}.seat.pin_radius", given["bore_radius"] or 0.0, "bore_radius")
    )
    what = "slot" if kind == "slot" else "sleeve"
    named, value = f"{path}.seat.{hole}", f"= {bore:g} mm"
    if play <= ROUNDING:
        yield Problem.of(
            named,
            value,
            f"must be greater than {inner:g} mm ({pin})",
            otherwise=f"the pin has no play in its {what}",
            bound=("greater than", inner),
        )
    elif kind == "slot" and bore >= 2.0 * outer - ROUNDING:
        yield Problem.of(
            named,
            value,
            f"must be less than {2.0 * outer:g} mm, twice {pin}",
            otherwise=f"the pin is no guide any more (its effective radius {2.0 * outer - bore:g} mm is none)",
            bound=("less than", 2.0 * outer),
        )
    elif kind == "sleeve" and bore >= outer - ROUNDING:
        yield Problem.of(
            named,
            value,
            f"must be less than {outer:g} mm ({path}.pin_radius)",
            otherwise="the sleeve has no wall",
            bound=("less than", outer),
        )
    elif play > largest + ROUNDING:
        part_of = "the eccentricity" if most == 1.0 else "half the eccentricity"
        yield Problem.of(
            named,
            value,
            f"must be at most {inner + largest:g} mm, {pin} and {part_of}",
            otherwise=f"the pins cannot lead the disc (play {play:g} mm)",
            bound=("at most", inner + largest),
        )
    elif kind == "slot" and 0.5 * growth >= play - ROUNDING:
        yield Problem.of(
            f"{path}.pin_errors.diameter",
            f"holds {growth:g} mm",
            f"must be less than {2.0 * play:.6g} mm, twice the play of {path}.seat.radius",
            otherwise="the pin does not fit its slot",
            bound=("less than", 2.0 * play),
        )
    elif kind == "slot" and bore >= 2.0 * outer - shrinkage - ROUNDING:
        yield Problem.of(
            f"{path}.pin_errors.diameter",
            f"holds {-shrinkage:g} mm",
            f"must be greater than {bore - 2.0 * outer:.6g} mm",
            otherwise=f"the slot ({path}.seat.radius) is twice as wide as the pin",
            bound=("greater than", bore - 2.0 * outer),
        )
    elif kind == "sleeve" and outer - 0.5 * shrinkage <= bore + ROUNDING:
        yield Problem.of(
            f"{path}.pin_errors.diameter",
            f"holds {-shrinkage:g} mm",
            f"must be greater than {2.0 * (bore - outer):.6g} mm",
            otherwise=f"the sleeve ({path}.seat.bore_radius) has no wall",
            bound=("greater than", 2.0 * (bore - outer)),
        )


def _slots(wheel: PinWheel) -> Iterator[Problem]:
    room, radius = wheel.pin_circle_radius * sin(pi / wheel.number_of_pins), wheel.seat.radius or 0.0
    # Pins that overlap, or have no hold in their slots, are reported elsewhere.
    if wheel.seat.kind == "slot" and radius >= room > wheel.pin_radius > 0.5 * radius:
        yield Problem.of(
            "pin_wheel.seat.radius",
            f"= {radius:g} mm",
            f"must be less than {room:.6g} mm",
            otherwise="neighbouring slots cut into each other",
            bound=("less than", room),
        )


def _core(wheel: PinWheel) -> Iterator[Problem]:
    core, errors = wheel.core_radius, wheel.pin_errors.diameter
    if core is None:
        return
    smallest = wheel.pin_radius + 0.5 * min((*errors, 0.0))
    if wheel.seat.kind == "sleeve":
        yield Problem.of(
            "pin_wheel.core_radius",
            f"= {core:g} mm",
            'must be left out with sleeves (pin_wheel.seat.kind = "sleeve"), which lie loose on their pins '
            "and have no core",
        )
    elif core > MOST_OF_BODY * smallest:
        yield Problem.of(
            "pin_wheel.core_radius",
            f"= {core:g} mm",
            f"must be at most {MOST_OF_BODY * smallest:g} mm, {MOST_OF_BODY:g} of the radius of the smallest "
            "pin (pin_wheel.pin_radius, pin_wheel.pin_errors.diameter)",
            otherwise="too little of it deforms",
            bound=("at most", MOST_OF_BODY * smallest),
        )


def _race_bore(drive: Drive) -> Iterator[Problem]:
    bore, most = drive.crank_bearing.race_bore_radius, MOST_OF_BODY * drive.crank_bearing.inner_race_radius
    if bore is not None and bore > most:
        yield Problem.of(
            "crank_bearing.race_bore_radius",
            f"= {bore:g} mm",
            f"must be at most {most:g} mm, {MOST_OF_BODY:g} of crank_bearing.inner_race_radius",
            otherwise="too little of the race deforms",
            bound=("at most", most),
        )


def _beam(drive: Drive, part: PinWheel | PinShaft, beam: WheelPinBeam | ShaftPinBeam, path: str) -> Iterator[Problem]:
    span = drive.wheel_pin_span if isinstance(beam, WheelPinBeam) else drive.shaft_pin_span
    half, thickness, planes = 0.5 * span, drive.disc.thickness, drive.disc.disc_planes
    if span > (most := range_of("mm")[1]):  # left out it follows from the discs
        yield Problem.of(
            f"{path}.beam.span",
            f"= {span:g} mm, from the first disc to the last",
            f"must be at most {most:g} mm",
            bound=("at most", most),
        )
        return
    disc = max(range(len(planes)), key=lambda number: abs(planes[number]))
    reach = abs(planes[disc]) + 0.5 * thickness
    if half < reach - ROUNDING * max(reach, 1.0):
        which = "the disc" if len(planes) == 1 else f"disc {disc}"
        low, high = planes[disc] - 0.5 * thickness, planes[disc] + 0.5 * thickness
        held = "walls" if isinstance(beam, WheelPinBeam) else "flange and tip"
        yield Problem.of(
            f"{path}.beam.span",
            f"= {span:g} mm",
            f"must be at least {2.0 * reach:.6g} mm",
            otherwise=f"{which} from {low:.6g} to {high:.6g} mm (disc.planes, disc.thickness) is not between the {held} "
            f"at ±{half:g} mm; left out, it is as long as the discs with their gaps",
            bound=("at least", 2.0 * reach),
        )
    sleeved = part.seat.kind == "sleeve" and part.seat.bore_radius is not None
    widest = 2.0 * ((part.seat.bore_radius or 0.0) if sleeved else part.pin_radius)
    of = f"the bore of its sleeve ({path}.seat.bore_radius)" if sleeved else f"that of the pin ({path}.pin_radius)"
    if beam.diameter is not None and beam.diameter > widest + ROUNDING:
        yield Problem.of(
            f"{path}.beam.diameter",
            f"= {beam.diameter:g} mm",
            f"must be at most {widest:g} mm, {of}",
            bound=("at most", widest),
        )
