"""Values derived from the inputs of a drive: geometry, installation, walls, as names and texts."""

from __future__ import annotations

from math import degrees, isnan, pi, sin

import numpy as np

from ltca.analysis.mass_values import mass_rows
from ltca.analysis.verdict.geometry import roller_gap, walls
from ltca.drive.members.bearings import designation_of
from ltca.drive.members.named_materials import named_parts
from ltca.drive.members.temperatures import temperature_words
from ltca.drive.parts import Drive, FirstStage, PinShaft, PinWheel
from ltca.drive.pin_beams import shaft_pin_spring, two_digits
from ltca.drive.single_discs import equal_parts, single_discs
from ltca.drive.units.quantities import ARCMIN
from ltca.equilibrium.first_stage import StageMesh
from ltca.geometry.coordinates import DISC_ROTATION, WHEEL_ANGLE
from ltca.geometry.first_contact import backlash, interference
from ltca.geometry.interference import overlap_at_rest
from ltca.geometry.pairs import ContactGeometry
from ltca.geometry.placement import position_angles
from ltca.geometry.play import play_over_a_turn, preload_words
from ltca.laws.bearing_pair import SideLaw, bearing_matrix
from ltca.laws.carrier import far_flange_stiffness
from ltca.laws.member_bearings import crank_bearing_stiffness, crank_laws, wheel_law, wheel_rows
from ltca.quantities import SCALARS

Rows = list[tuple[str, str]]


def derived_rows(written: Drive, drive: Drive, *, plays: bool = True) -> Rows:
    """Return values derived from the inputs of a drive, as it was given and at its temperatures: names and texts.

    `plays` are gaps and backlash over a turn, which take most of the time.
    """
    return [*_warmth(written), *_materials(written), *_properties(drive, plays), *mass_rows(written)]


def _properties(drive: Drive, plays: bool) -> Rows:
    singles = single_discs(drive)
    geometries = [ContactGeometry.of_drive(single) for single in singles]
    first, single = geometries[0], singles[0]
    profile, place = first.profile, first.placement
    parameter = np.linspace(0.0, 2.0 * np.pi / drive.reduction_ratio, 2001)
    curvature = profile.curvature(parameter)
    locus = profile.locus(parameter).curvature
    e = float(place.mean_eccentricity[0])
    bearing = drive.crank_bearing
    roller_play = single.bore_radius - bearing.inner_race_radius - 2.0 * bearing.roller_radius
    tangential = abs(drive.wheel_moment()) / (len(singles) * drive.reduction_ratio * e)
    of = "" if len(singles) == 1 else " of disc 0"
    return [
        *_installation(drive),
        ("e z_P/R_C", f"{e * drive.reduction_ratio / drive.pin_wheel.pin_circle_radius:.4f} (must be below 1)"),
        ("disc radius at root, tip", f"{profile.root_radius:.4f}, {profile.tip_radius:.4f} mm"),
        ("smallest flank radius, convex", f"{1.0 / curvature.max():.4f} mm"),
        ("smallest flank radius, concave", f"{-1.0 / curvature.min():.4f} mm"),
        ("pin radius at which the flank is undercut", f"{1.0 / locus.max() - drive.disc.equidistant_offset:z.4f} mm"),
        *(_plays(drive, geometries, abs(drive.output_per_wheel_angle) * ARCMIN) if plays else []),
        (f"bore radius{of} with clearance", f"{single.bore_radius:.4f} mm"),
        (f"play of a roller{of} between the races", f"{roller_play:z.4f} mm"),
        ("gap between neighbouring rollers", f"{roller_gap(drive):z.4f} mm"),
        *_bought(drive),
        *_walls(single, of),
        ("mean tangential bearing load of a disc", f"{tangential:.1f} N"),
    ]  # fmt: skip


def _plays(drive: Drive, geometries: list[ContactGeometry], leverage: float) -> Rows:
    gap = np.stack([-each.flank(position_angles(90), np.zeros((90, 4))).approach for each in geometries])
    stage = StageMesh.of_drive(drive)
    turn = play_over_a_turn(geometries, None if stage is None else stage.play)
    disc = backlash(geometries[0], position_angles(360), DISC_ROTATION) * ARCMIN
    wheel = backlash(geometries, position_angles(360), WHEEL_ANGLE) * ARCMIN
    overlap, parts = overlap_at_rest(
        drive, max(float(interference(one, position_angles(90)).max()) for one in geometries)
    )
    at, held = ("the disc", "disc") if len(geometries) == 1 else ("disc 0", "discs")
    return [
        ("gap between pins and flank, nominal position", f"{gap.min():z.4f} … {gap.max():z.4f} mm"),
        *([(SCALARS["interference"].verdict_title, f"{overlap:z.4f} mm, {parts}")] if parts else []),
        (
            SCALARS["backlash_output"].verdict_title,
            ", ".join(
                filter(
                    None,
                    (
                        f"{leverage * turn.least:z.2f}′ … {leverage * turn.largest:z.2f}′ at sampled positions",
                        preload_words(turn.preloaded),
                    ),
                )
            ),
        ),
        (
            f"flank: backlash at {at}, wheel held",
            f"{disc.mean():z.2f}′ ({disc.min():z.2f}′ … {disc.max():z.2f}′)",
        ),
        (
            f"flank: backlash at the wheel, {held} held",
            f"{wheel.mean():z.2f}′ ({wheel.min():z.2f}′ … {wheel.max():z.2f}′)",
        ),
    ]


def _bought(drive: Drive) -> Rows:
    """Name of the crank bearing where it is one of the shipped ones, and ratings of its maker."""
    part, name = drive.crank_bearing, designation_of(drive.crank_bearing)
    ratings = (("C", part.dynamic_load_rating), ("C0", part.static_load_rating))
    told = ", ".join(f"{rating} {value:.0f} N" for rating, value in ratings if value is not None)
    rows = [] if name is None else [("crank bearing", name)]
    return rows + ([("ratings of the maker", told)] if told else [])


def _warmth(drive: Drive) -> Rows:
    """Temperatures of the parts, which all lengths are at."""
    held = drive.temperature
    return [] if held is None else [("temperatures, of which all lengths are", temperature_words(held))]


def _materials(drive: Drive) -> Rows:
    """Materials that have a name, part by part."""
    parts: dict[str, list[str]] = {}
    for part, name in named_parts(drive.materials).items():
        parts.setdefault(name, []).append(part)
    return [(f"material {name}", ", ".join(those)) for name, those in parts.items()]


def _walls(single: Drive, of: str) -> Rows:
    """Walls between holes, bores and roots of a disc."""
    rows, found = [], dict(walls(single))

    def both(first: str, second: str) -> str:
        return f"{found[first]:z.4f}, {found[second]:z.4f} mm"

    if single.pin_shaft is not None:
        rows += [
            (f"hole radius{of} with clearance", f"{single.hole_radius:.4f} mm"),
            ("wall between hole and root circle, bore", both("between hole and root circle", "between hole and bore")),
        ]
    if single.crank.number > 1:
        between = both("between bore and root circle", "between neighbouring bores")
        rows.append(("wall between bore and root circle, next bore", between))
    return rows


def _installation(drive: Drive) -> Rows:
    """Which member is held and which is driven, and the arrangement of the discs."""
    held = (
        "pin wheel held, pin shaft is the output" if drive.wheel_is_held else "pin shaft held, pin wheel is the output"
    )
    stage, crank = drive.first_stage_ratio, drive.crank
    turned = "crank" if stage is None else "input"
    rows = [
        ("installation", held),
        (f"reduction ratio ({turned} turns by output turns)", f"{drive.transmission_ratio:g}"),
    ]
    if crank.number > 1:
        driven = "turned in the carrier" if stage is None else f"driven by a first stage, z₂/z₁ = {stage:g}"
        rows.append(("cranks", f"{crank.number} on a circle of {crank.circle_radius:g} mm, {driven}"))
    if drive.load.leaves_out_light_torque:
        rows.append(("light torque", drive.load.light_torque_words))
    rows += _teeth(drive) + _supports(drive) + _outside(drive) + _pins(drive)
    discs = drive.disc.number_of_discs
    if discs == 1:
        return rows
    pattern = "hole pitches" if crank.number == 1 else f"{360.0 / drive.pattern:g}°"
    alike = f"can be equal parts, turned against each other by {pattern}"
    if not equal_parts(drive):
        turns = ", ".join(f"{degrees(single.part_turn[0]):z.4f}°" for single in single_discs(drive))
        against = "holes" if crank.number == 1 else "bores"
        alike = f"cannot be equal parts: flanks are cut at {turns} against their {against}"
    return [
        *rows,
        ("discs, phases of their eccentrics", ", ".join(f"{degrees(phase):.6g}°" for phase in drive.disc.disc_phases)),
        ("axial places of the discs", ", ".join(f"{plane:.6g}" for plane in drive.disc.disc_planes) + " mm"),
        ("the discs", alike),
    ]


def _teeth(drive: Drive) -> Rows:
    """Teeth of the first stage, and the forces of a planet by its tangential one."""
    stage, distance = drive.first_stage, drive.crank.circle_radius
    if stage is None or distance is None:
        return []
    mesh, give = stage.mesh(distance), stage.mesh_stiffness
    planets = "" if stage.plane is None else f", planets at {stage.plane:g} mm"
    yields = "rigid" if give is None else f"{give:g} N/mm along the line of action"
    return [
        (
            "first stage",
            f"{stage.sun_teeth} and {stage.planet_teeth} teeth, helix angle {degrees(stage.helix_angle):g}°, pitch circles ⌀ "
            f"{2.0 * (distance - mesh.pitch_radius):.6g} and {2.0 * mesh.pitch_radius:.6g} mm{planets}",
        ),
        (
            "forces of a planet",
            f"working pressure angle {degrees(mesh.working_angle):.4g}°; radial {mesh.separating:z.4f}, axial "
            f"{abs(mesh.axial):.4f} of the tangential force",
        ),
        ("backlash and stiffness of the first stage", f"{stage.backlash:g} mm at the pitch circle, {yields}"),
        *_runout_of_teeth(stage, distance),
    ]


def _runout_of_teeth(stage: FirstStage, distance: float) -> Rows:
    """Eccentricities of sun and planets, where there are any."""
    if not stage.runs_out:
        return []
    planets = ", ".join(f"{amount:g}" for amount in stage.planet_runout.amount) or "0"
    closed = stage.closed_by_runout(distance)
    return [
        (
            "eccentricity of sun; planets",
            f"{stage.sun_runout.amount:g} mm; {planets} mm, which take up to {closed:.3g} mm of the backlash",
        )
    ]


def _outside(drive: Drive) -> Rows:
    """Forces from outside on the output, one row for each entry."""
    return [
        (
            f"force from outside {number}, frame of the {entry.frame}",
            f"({entry.force.x:g}, {entry.force.y:g}, {entry.force.z:g}) N at z = {entry.at.z:g} mm, "
            f"moment ({entry.moment.x:g}, {entry.moment.y:g}) N·mm",
        )
        for number, entry in enumerate(drive.load.external)
    ]


def _supports(drive: Drive) -> Rows:
    """Elastic supports, and what they leave out."""
    rows, support, wheel = [], drive.crank.support, wheel_law(drive)
    if support is not None:
        twist = f"held at {support.spline_plane:g} mm, they twist; tilt" if support.torsion else "torsion and tilt"
        first, second = (
            f"{value:g} N/mm at {at:g} mm"
            for value, at in zip(crank_bearing_stiffness(drive), support.positions, strict=True)
        )
        rows.append(("crankshafts, as beams", f"⌀ {support.diameter:g} mm on {first}, {second}; {twist} left out"))
        rows += [
            (f"bearing of a crank at {at:g} mm", told)
            for at, law in zip(support.positions, crank_laws(drive) or (), strict=False)
            if (told := _side_words(law))
        ]
    if wheel is not None:
        stiffness = wheel.stiffness if isinstance(wheel, SideLaw) else wheel
        told = _side_words(wheel) if isinstance(wheel, SideLaw) else ""
        held = f"{stiffness:.6g} N/mm, radial{f', {told}' if told else ''}"
        left_out = "tilt and the ring's own bending" if drive.ring is None else "tilt"
        rows.append(("main bearing of the wheel", f"{held}; {left_out} left out"))
    if found := wheel_rows(drive):
        matrix = bearing_matrix(found)
        tilt = (
            f", tilt {matrix[3, 3]:.4g} N·mm/rad about the zero of disc.planes, pressure "
            f"centres at {', '.join(f'{row.pressure_centre:.4g}' for row in found)} mm"
        )
        told = "" if isnan(matrix[3, 3]) else tilt
        rows.append(("rows of the main bearing", f"axial {matrix[2, 2]:.4g} N/mm{told}"))
    return [*rows, *_carrier(drive)]


def _carrier(drive: Drive) -> Rows:
    """Stiffness of the carrier: between its flanges, and between the near one and what it is fixed to."""
    rows, carrier, held = [], drive.carrier, far_flange_stiffness(drive)
    if carrier is not None and carrier.posts is not None and held is not None:
        posts, flanges = carrier.posts, "rigid flanges"
        if carrier.flange is not None:
            flanges = f"flanges of {carrier.flange[0]:g} and {carrier.flange[1]:g} mm"
        told = f"{posts.number} posts ⌀ {posts.size:g} mm on a circle of {posts.radius:g} mm"
        told = f"{told}, {drive.post_length:g} mm long, {flanges}"
        stiff = f"{held[0, 0]:.4g} N/mm across, {held[2, 2] / ARCMIN / 1e3:.4g} N·m/′ in rotation; tilt left out"
        rows = [("carrier", told), ("far flange against the near one", stiff)]
    if carrier is not None and carrier.stiffness_torsion is not None:
        what = "output" if drive.wheel_is_held else "housing"
        rows.append((f"near flange against the {what}", f"{carrier.stiffness_torsion / ARCMIN / 1e3:.4g} N·m/′"))
    return rows


def _side_words(law: SideLaw) -> str:
    """What clearance or preload does, in words; empty for a spring alone."""
    if law.gap:
        return f"free within {law.gap:.4g} mm"
    beyond = 1.0 / (1.0 / law.stiffness + law.beyond)
    return f"both sides carry up to {law.lift_off:.4g} N, {beyond:.4g} N/mm beyond" if law.lift_off else ""


THIN_WALL = 0.1
"""Wall between slots, or of a sleeve, by the radius of its bore: what is thinner yields more than the contacts in it say."""


def _pins(drive: Drive) -> Rows:
    """Seats and beams of pins that are not fixed and rigid."""
    wheel, shaft = drive.pin_wheel, drive.pin_shaft
    rows = _seat(wheel, "wheel pins", "the flank")
    if wheel.seat.kind == "slot":
        radius = wheel.seat.radius or 0.0
        wall = 2.0 * (wheel.pin_circle_radius * sin(pi / wheel.number_of_pins) - radius)
        rows.append(("wall between neighbouring slots", _wall(wall, radius)))
    if wheel.beam is not None:
        walls = f"{drive.wheel_pin_span:g} mm between the walls, ends {wheel.beam.ends}"
        rows.append(("wheel pins, as beams", f"⌀ {wheel.beam_diameter:g} mm, {walls}"))
    if shaft is None:
        return rows
    rows += _seat(shaft, "shaft pins", "the holes")
    if shaft.beam is not None:
        ring = "a ring" if drive.posts is None else "the far flange"
        tips = {"free": "free", "tied-clamped": f"clamped in {ring}", "tied-pinned": f"pinned in {ring}"}[
            shaft.beam.tip
        ]
        reach = f"{drive.shaft_pin_span:g} mm from the flange at {-0.5 * drive.shaft_pin_span:g} mm, tips {tips}"
        rows.append(("shaft pins, as beams", f"⌀ {shaft.beam_diameter:g} mm, {reach}"))
        if (spring := shaft_pin_spring(drive)) is not None:
            between = [two_digits(one) for one in (spring.loaded_alike, spring.turned_alike)]
            ranges = (
                "" if drive.disc.number_of_discs == 1 else "; {:g} where discs carry alike, {:g} where they turn alike"
            )
            near = f", {spring.accuracy}" if spring.accuracy else ""
            words = f"pin_shaft.stiffness = {spring.stiffness:g} N/mm{near}{ranges.format(*between)}"
            rows.append(("shaft pins, springs that turn as far", words))
    return rows


def _seat(part: PinWheel | PinShaft, pins: str, seen_from: str) -> Rows:
    seat = part.seat
    if seat.kind == "fixed":
        return []
    rows = [(f"{pins}, seen from {seen_from}", f"as fixed ones of radius {part.pin_radius - part.seat_play:.4f} mm")]
    if seat.kind == "sleeve":
        bore = seat.bore_radius or 0.0
        told = f"radius {seat.pin_radius:.4f} mm, under sleeves of bore radius {bore:.4f} mm, play {part.seat_play:z.4f} mm"
        return [(pins, told), (f"wall of the sleeves on {pins}", _wall(part.pin_radius - bore, bore)), *rows]
    radius = part.pin_radius + part.seat_play
    return [(pins, f"loose in slots of radius {radius:.4f} mm, play {part.seat_play:z.4f} mm"), *rows]


def _wall(wall: float, bore: float) -> str:
    return f"{wall:z.4f} mm" + (", thin: it yields more than its contacts alone say" if wall < THIN_WALL * bore else "")
