"""A drive of several discs as drives of one disc each.

Disc k stands at the phase ζ_k of the crank. Its flank is turned by −Δz ζ_k/z_C against holes and bore, so that it meshes
with the wheel as the others do. Turned by a number of hole pitches, such a disc may be the same part as another.
"""

from __future__ import annotations

from dataclasses import replace

from ltca.drive.deviations import OneDisc, OneEccentric
from ltca.drive.parts import (
    SAME_PART,
    Clearance,
    Crank,
    Disc,
    Drive,
    PlacementErrors,
    ProfileErrors,
    RollerErrors,
    Runout,
)


def single_discs(drive: Drive) -> tuple[Drive, ...]:
    """Return one drive per disc, each with wheel, cranks and pin shaft; values per disc replace those of the drive.

    Torques are divided by the number of discs, the share of each where all are alike. A drive that is single already
    (`is_single`) is returned itself.

    Examples
    --------
    >>> from dataclasses import replace
    >>> from ltca.reading.drive_file import load_drive
    >>> drive = load_drive("paper").cases["CS-1"]
    >>> twice = replace(drive, disc=replace(drive.disc, number_of_discs=2))
    >>> [single.disc.phases for single in single_discs(twice)]
    [(0.0,), (3.141592653589793,)]
    """
    if is_single(drive):
        return (drive,)
    return tuple(_single(drive, number) for number in range(drive.disc.number_of_discs))


def is_single(drive: Drive) -> bool:
    """Tell whether a drive has one disc without values of its own, except those of eccentrics and bores of several cranks."""
    alone = drive.disc.number_of_discs == 1 and all(entry.of_bores_alone for entry in drive.disc.of)
    return alone and (drive.crank.number > 1 or all(entry.eccentricity_error is None for entry in drive.crank.of))


def without_own(drive: Drive) -> Drive:
    """Return the drive without values per disc."""
    if not drive.disc.of and not drive.crank.of:
        return drive
    return replace(drive, disc=replace(drive.disc, of=()), crank=replace(drive.crank, of=()))


def _single(drive: Drive, number: int) -> Drive:
    disc, crank, load, discs = drive.disc, drive.crank, drive.load, drive.disc.number_of_discs
    own = disc.of[number] if disc.of else OneDisc()
    common = drive.clearance
    clearance = common
    if own.clearance is not None:
        bearing, hole = own.clearance.bearing, own.clearance.pin_hole
        clearance = Clearance(
            bearing=common.bearing if bearing is None else bearing, pin_hole=common.pin_hole if hole is None else hole
        )
    rollers = drive.crank_bearing
    return replace(
        _with_spans(drive),
        crank=_eccentrics_alone(crank, number),
        disc=_alone(disc, own, number),
        crank_bearing=rollers if own.roller_errors is None else replace(rollers, roller_errors=own.roller_errors),
        clearance=clearance,
        load=replace(load, torque=load.torque / discs, light_torque=load.light_torque / discs),
    )


def _with_spans(drive: Drive) -> Drive:
    """The drive with the spans of its pins and posts that follow from all discs, of which a single one knows nothing."""
    wheel, shaft, carrier = drive.pin_wheel, drive.pin_shaft, drive.carrier
    if wheel.beam is not None:
        wheel = replace(wheel, beam=replace(wheel.beam, span=drive.wheel_pin_span))
    if shaft is not None and shaft.beam is not None:
        shaft = replace(shaft, beam=replace(shaft.beam, span=drive.shaft_pin_span))
    if carrier is not None and carrier.posts is not None:
        carrier = replace(carrier, posts=replace(carrier.posts, length=drive.post_length))
    return replace(drive, pin_wheel=wheel, pin_shaft=shaft, carrier=carrier)


def _eccentrics_alone(crank: Crank, disc: int) -> Crank:
    """The crank with the eccentrics of one disc."""
    if crank.number > 1:
        entries = [(number, entry) for (place, number), entry in sorted(crank.entries.items()) if place == disc]
        return replace(crank, of=tuple(replace(entry, disc=0, crank=number) for number, entry in entries))
    entry = crank.eccentric(disc)
    error = crank.eccentricity_error if entry.eccentricity_error is None else entry.eccentricity_error
    phase_error = (OneEccentric(phase_error=entry.phase_error),) if entry.phase_error else ()
    return replace(crank, eccentricity_error=error, of=phase_error)


def _alone(disc: Disc, own: OneDisc, number: int) -> Disc:
    return replace(
        disc,
        number_of_discs=1,
        phases=(disc.disc_phases[number],),
        planes=(disc.disc_planes[number],),
        gap=0.0,
        of=() if own.bore_errors is None else (OneDisc(bore_errors=own.bore_errors),),
        runout=disc.runout if own.runout is None else own.runout,
        profile_errors=disc.profile_errors if own.profile_errors is None else own.profile_errors,
        hole_errors=disc.hole_errors if own.hole_errors is None else own.hole_errors,
        lead_crown_drop=disc.lead_crown_drop if own.lead_crown_drop is None else own.lead_crown_drop,
        lead_relief_length=disc.lead_relief_length if own.lead_relief_length is None else own.lead_relief_length,
        lead_relief_depth=disc.lead_relief_depth if own.lead_relief_depth is None else own.lead_relief_depth,
        lead_slope=disc.lead_slope if own.lead_slope is None else own.lead_slope,
    )


def equal_parts(drive: Drive) -> bool:
    """Tell whether all discs of a drive can be cut alike, turned against each other by hole pitches."""
    turns = [single.part_turn[0] for single in single_discs(drive)]
    return max(turns) - min(turns) < SAME_PART


def nominal_shape(drive: Drive, *, keep_clearance: bool = True) -> Drive:
    """Return the shape of a drive of one disc that influence coefficients belong to.

    Errors of single parts are left out, and clearances unless `keep_clearance`; the disc is in the orientation of the part
    (`Drive.part_turn`), not as it stands in the drive.
    """
    phase = -drive.part_turn[0] * drive.disc.number_of_teeth / drive.tooth_number_difference
    return replace(
        drive,
        crank=replace(drive.crank, of=()),
        clearance=drive.clearance if keep_clearance else Clearance(),
        pin_wheel=replace(drive.pin_wheel, pin_errors=PlacementErrors()),
        disc=replace(
            drive.disc,
            phases=(phase,) if phase else (),
            hole_errors=PlacementErrors(),
            profile_errors=ProfileErrors(),
            runout=Runout(),
            of=(),
        ),
        pin_shaft=None if drive.pin_shaft is None else replace(drive.pin_shaft, pin_errors=PlacementErrors()),
        crank_bearing=replace(drive.crank_bearing, roller_errors=RollerErrors()),
    )
