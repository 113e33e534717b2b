"""Reducers of all kinds: one or several cranks, with and without pin shaft, first stage and supports, either member held.

They are built on `practical_drives`, and plain choices are frequent as there: no errors, equal supports, rigid supports.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.random import Generator

from ltca.drive.deviations import BoreErrors, OneDisc, OneEccentric
from ltca.drive.members.first_stage import FirstStage
from ltca.drive.members.operation import ExternalLoad, OuterForce, OuterPlace
from ltca.drive.parts import (
    BearingRow,
    Carrier,
    CarrierPosts,
    Clearance,
    CrankSupport,
    Drive,
    Installation,
    MainBearing,
    Preload,
)
from ltca.geometry.flank import FlankProfile
from ltca.reading.physical_checks import is_sound
from ltca.testing.practical_drives import practical_drive, with_ring


def crank_drive(seed: int) -> tuple[Drive, float]:
    """Return a reducer of any kind, two thirds with two to five cranks on the carrier, and a crank angle in rad, by a seed
    (not negative).
    """
    random, beside, of_carrier = (np.random.default_rng((seed, which)) for which in (2, 3, 5))
    while True:
        number = int(random.integers(2**32))
        drive, angle = practical_drive(number)
        drive = replace(drive, ring=None)  # drawn again for what the drive has become
        if random.uniform() < 0.67:
            drive = _on_the_carrier(random, drive)
        drive = with_carrier(of_carrier, _pushed(beside, _geared(beside, _supported(random, drive))))
        if is_sound(drive):
            return with_ring(number, drive), angle


def _on_the_carrier(random: Generator, drive: Drive) -> Drive:
    """The drive with several cranks with small bearings on a circle, with or without first stage and shaft pins between
    them.
    """
    root, cranks = (
        FlankProfile.of_drive(replace(drive, disc=_plain(drive))).root_radius,
        int(random.choice([2, 2, 3, 3, 4, 5])),
    )
    bearing = drive.crank_bearing
    circle = round(2.0 * root * random.uniform(0.5, 0.65)) / 2.0
    room = 0.85 * min(circle * float(np.sin(np.pi / cranks)), root - circle)
    size = room / bearing.outer_race_radius
    radius = max(round(40.0 * size * bearing.roller_radius) / 40.0, 0.025)
    outer = round(4.0 * size * bearing.outer_race_radius) / 4.0
    bearing = replace(
        bearing, outer_race_radius=outer, inner_race_radius=outer - 2.0 * radius, roller_radius=radius,
        number_of_rollers=max(5, int(bearing.number_of_rollers * random.uniform(0.5, 1.0))),
    )  # fmt: skip
    discs = drive.disc.number_of_discs
    shaft, clearance, angle = None, Clearance(bearing=drive.clearance.bearing), float(random.choice([0.0, 0.0, 0.3]))
    if drive.pin_shaft is not None and random.uniform() < 0.4:
        pin = round(8.0 * (0.4 * room - drive.crank.eccentricity)) / 8.0
        if pin > 0.0:
            angle = np.pi / cranks
            shaft = replace(
                drive.pin_shaft, number_of_pins=max(cranks, 3), pin_circle_radius=circle, pin_radius=pin,
                hole_radius=pin + drive.crank.eccentricity,
            )  # fmt: skip
            clearance = drive.clearance
    entries: tuple[OneEccentric, ...] = ()
    own = drive.disc.of
    error = float(random.choice([0.001, 0.003])) * min(1.0, drive.crank.eccentricity)
    if random.uniform() < 0.3:
        entries = (OneEccentric(disc=discs - 1, crank=cranks - 1, eccentricity_error=error, phase_error=0.0),)
    if random.uniform() < 0.3:
        bores = BoreErrors(radial=(error, *[0.0] * (cranks - 1)))
        own = (
            (replace(own[0], bore_errors=bores), *own[1:])
            if own
            else (OneDisc(bore_errors=bores), *[OneDisc()] * (discs - 1))
        )
    stage = float(random.choice([0.0, 1.0, 2.0, 2.5])) or None
    return replace(
        drive,
        crank=replace(drive.crank, number=cranks, circle_radius=circle, angle=angle, of=entries),
        crank_bearing=bearing,
        disc=replace(drive.disc, of=own),
        pin_shaft=shaft,
        clearance=clearance,
        installation=Installation(held=drive.installation.held, first_stage_ratio=stage),
    )  # fmt: skip


def _geared(random: Generator, drive: Drive) -> Drive:
    """The drive with teeth in half of its first stages: often straight ones without backlash that do not yield.

    Planets stand beside the discs, on cranks that twist at their splines.
    """
    ratio, distance, support = drive.installation.first_stage_ratio, drive.crank.circle_radius, drive.crank.support
    floats = support is not None and (support.clearance or 0.0) > 0.0
    if ratio is None or distance is None or random.uniform() < 0.5 or floats:
        return drive
    sun = 2 * int(random.integers(7, 20))
    helix = float(random.choice([0.0, 0.0, 0.2, -0.3]))
    reference = 2.0 * distance * float(np.cos(helix)) / (sun + ratio * sun)
    teeth = FirstStage(
        sun_teeth=sun,
        planet_teeth=round(ratio * sun),
        module=None if random.uniform() < 0.5 else reference * float(random.choice([1.0, 0.98, 1.02])),
        helix_angle=helix,
        backlash=float(random.choice([0.0, 0.01, 0.05])) * reference,
        mesh_stiffness=float(random.choice([0.0, 1e5, 1e6])) or None,
        plane=float(random.choice([-1.0, 1.5])) * drive.disc.stack_length,
    )
    if support is not None and support.torsion:
        teeth = replace(teeth, plane=support.spline_plane)
    kept = None if random.uniform() < 0.5 else ratio
    return replace(drive, first_stage=teeth, installation=replace(drive.installation, first_stage_ratio=kept))


def _pushed(random: Generator, drive: Drive) -> Drive:
    """The drive with an arm on the output, of a third of the forces of its torque, in a third of all."""
    if random.uniform() < 0.67:
        return drive
    size = 0.3 * drive.load.torque / drive.pin_wheel.pin_circle_radius
    force = OuterForce(x=size * float(random.choice([0.0, 1.0])), y=size * float(random.choice([0.0, -0.5])), z=size)
    frame: Any = str(random.choice(["housing", "output"]))
    own = ExternalLoad(force=force, at=OuterPlace(z=float(random.choice([0.0, 50.0]))), frame=frame)
    return replace(drive, load=replace(drive.load, external=(own, ExternalLoad())[: int(random.integers(1, 3))]))


def _plain(drive: Drive) -> Any:
    return replace(drive.disc, number_of_discs=1, phases=(), planes=(), of=())


def _supported(random: Generator, drive: Drive) -> Drive:
    """The drive with elastic supports of the crankshafts, of the wheel, of both or of none."""
    crank, wheel = drive.crank, drive.pin_wheel
    stiffness = float(random.choice([1e5, 3e5, 1e6]))
    if random.uniform() < 0.6:
        ends = max(abs(plane) for plane in drive.disc.disc_planes) + drive.disc.thickness
        second = float(random.choice([1.0, 1.0, 0.5])) * stiffness
        shaft = CrankSupport(
            diameter=1.6 * drive.crank_bearing.inner_race_radius,
            positions=(-ends, float(random.choice([1.0, 1.5])) * ends),
            stiffness=(stiffness, second),
        )
        crank = replace(crank, support=shaft)
    if random.uniform() < 0.3:
        wheel = replace(wheel, support_stiffness=float(random.choice([3e5, 1e6])))
    drive = replace(drive, crank=crank, pin_wheel=wheel)
    return _on_bearings(np.random.default_rng(random.integers(2**32)), drive)


def _on_bearings(random: Generator, drive: Drive) -> Drive:
    """The drive whose supports have clearance or preload, are rows of rolling elements or twist, some of them."""
    support, wheel = drive.crank.support, drive.pin_wheel
    loose = float(random.choice([0.0, 0.004, 0.01, 0.03, -0.003, -0.01])) * min(1.0, drive.crank.eccentricity)
    preload = random.choice([Preload(force=20.0), Preload(force=2e3), Preload(displacement=0.001)])  # type: ignore[arg-type]
    if support is not None and random.uniform() < 0.5:
        kind = random.choice(["loose", "loose", "preloaded", "tapered"])
        if kind == "loose":
            support = replace(support, clearance=loose)
        elif kind == "preloaded":
            support = replace(support, preload=preload)
        else:
            support = replace(support, stiffness=(), contact_angle=0.25, load_constant=2e5, preload=preload)
    bearing = None
    if wheel.support_stiffness is not None and random.uniform() < 0.7:
        kind = random.choice(["loose", "loose", "preloaded", "rows", "alias"])
        stiffness = wheel.support_stiffness
        if kind == "loose":
            bearing = MainBearing(radial_stiffness=stiffness, clearance=loose)
        elif kind == "preloaded":
            bearing = MainBearing(radial_stiffness=stiffness, preload=preload)
        elif kind == "alias":
            bearing = MainBearing(clearance=loose)
        else:
            rows = (
                BearingRow(
                    plane=side * drive.disc.stack_length,
                    kind="angular-contact ball",
                    contact_angle=0.6,
                    pitch_radius=wheel.pin_circle_radius,
                    load_constant=2e6,
                )
                for side in (-1.0, 1.0)
            )
            bearing = MainBearing(bearings=tuple(rows), preload=preload, arrangement=str(random.choice(["O", "X"])))  # type: ignore[arg-type]
        if kind != "alias":
            wheel = replace(wheel, support_stiffness=None)
    if support is not None and random.uniform() < 0.3:  # splined beyond the discs, or between them
        spline = float(random.choice([-1.0, 0.013, 1.0, 1.0])) * drive.disc.stack_length
        support = replace(support, torsion=True, spline_plane=spline)
    return replace(drive, crank=replace(drive.crank, support=support), pin_wheel=wheel, main_bearing=bearing)


def with_carrier(random: Generator, drive: Drive) -> Drive:
    """Return the drive with a carrier that twists, with a far flange on posts, with both or, half of all, with none.

    Posts need the tips of the shaft pins tied, or cranks alone; they stand on the circle of pins or cranks as often as not.
    """
    shaft = drive.pin_shaft
    twists, stands = random.uniform() < 0.25, random.uniform() < 0.4
    tied = shaft is None or (shaft.beam is not None and shaft.beam.tip != "free")
    circle = (drive.crank.circle_radius or 0.0) if shaft is None else shaft.pin_circle_radius
    number, part = int(random.choice([2, 3, 3, 4, 6])), float(random.choice([1.0, 1.0, 0.8, 1.1]))
    thickness, longer = float(random.choice([0.5, 1.0])), float(random.choice([1.0, 1.3]))
    own, length = random.uniform() < 0.5, random.uniform() < 0.5
    posts = None
    if stands and tied:
        size = float(random.choice([0.25, 0.4])) * 2.0 * part * circle * float(np.sin(np.pi / number))
        reach = 2.0 * max(abs(plane) for plane in drive.disc.disc_planes) + drive.disc.thickness
        posts = CarrierPosts(number=number, radius=part * circle, size=size, length=longer * reach if length else None)
    if posts is None and not twists:
        return drive
    # A minute or so at the rated torque, or ten times stiffer.
    stiffness = float(random.choice([1.0, 10.0])) * drive.load.torque / 3e-4 if twists else None
    flange = (thickness * posts.size, posts.size) if posts is not None and own else None
    return replace(drive, carrier=Carrier(stiffness_torsion=stiffness, flange=flange, posts=posts))
