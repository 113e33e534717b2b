"""Physical checks of deviations: their numbers and sizes, and the resulting flank, which neither folds nor traps its pins."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache
from itertools import pairwise
from math import pi

import numpy as np

from ltca.arrays import ComplexArray, FloatArray
from ltca.drive.deviations import BoreErrors
from ltca.drive.fields import ANY, OWN
from ltca.drive.mistakes import entry_words
from ltca.drive.parts import Drive, PlacementErrors, RollerErrors
from ltca.geometry.flank import CurveFrame, FlankProfile
from ltca.geometry.rotation import unit

POINTS_PER_WAVE = 24
"""Points at which the flank is checked, per wave of the highest order."""


def deviation_bound(drive: Drive) -> float:
    """Return the largest deviation accepted, mm: beyond a tenth of the smallest radius it is a different design."""
    radii = [drive.pin_wheel.pin_radius, drive.crank_bearing.roller_radius]
    return 0.1 * min(radii if drive.pin_shaft is None else [*radii, drive.pin_shaft.pin_radius])


def find_disc_problems(drive: Drive) -> Iterator[str]:
    """Yield the problems of values per disc, which need an entry for every disc or none at all, one sentence each."""
    discs = drive.disc.number_of_discs
    for path, entries in (
        ("disc.phases", drive.disc.phases),
        ("disc.planes", drive.disc.planes),
        ("disc.of", drive.disc.of),
        ("crank.of", drive.crank.of if all(entry.disc is None for entry in drive.crank.of) else ()),
    ):
        if entries and len(entries) != discs:
            yield f"{path} has {len(entries)} entries: must have {discs}, one for each disc (disc.number_of_discs)"
    planes, thickness = sorted(drive.disc.planes), drive.disc.thickness
    for before, after in pairwise(planes):
        if after - before < thickness * (1.0 - 1e-9):
            yield (
                f"disc.planes holds {before:g} and {after:g} mm: must be at least {thickness:g} mm apart, the thickness of "
                "a disc"
            )
    # One disc may be one of several checked alone; where shafts or pins bend, the axis has its zero at supports and beams.
    shaft = drive.pin_shaft
    placed = (drive.crank.support, drive.pin_wheel.beam, None if shaft is None else shaft.beam)
    if discs > 1 and not any(placed) and abs(sum(planes)) > 1e-6 * len(planes) * thickness:
        mean = sum(planes) / len(planes)
        yield f"disc.planes has the mean {mean:g} mm: must be 0 mm, planes are centred on 0 where nothing bends"
    yield from _eccentric_problems(drive)
    bound = min(deviation_bound(drive), 0.5 * drive.crank.eccentricity) / drive.crank.eccentricity
    for number, entry in enumerate(drive.crank.of):
        if abs(entry.phase_error) > bound:
            yield (
                f"{_entry(drive, number)}: phase_error = {entry.phase_error:g} rad: must be at most {bound:.4g} rad in size: the "
                "eccentric's centre moves by a tenth of the smallest pin or roller radius, or by half the eccentricity"
            )


def _eccentric_problems(drive: Drive) -> Iterator[str]:
    """Problems of the index keys of ``crank.of``, and of the errors of bores."""
    discs, cranks, entries = drive.disc.number_of_discs, drive.crank.number, drive.crank.of
    told = [entry.disc is not None for entry in entries]
    if entries and not all(told) and (any(told) or cranks > 1):
        number = told.index(False)
        yield (
            f"{entry_words(number)}: disc is left out: every entry must give its disc"
            + (f" and its crank (crank.number = {cranks})" if cranks > 1 else ", or none")
        )
        return
    seen = set()
    for number, entry in enumerate(entries):
        if entry.disc is not None and entry.disc >= discs:
            yield (
                f"{entry_words(number)}: disc = {entry.disc}: must be less than {discs}, the number of discs, which count "
                "from 0"
            )
        if entry.crank is not None and entry.crank >= cranks:
            yield (
                f"{entry_words(number)}: crank = {entry.crank}: must be less than {cranks}, crank.number; cranks count from 0"
            )
        if entry.crank is None and cranks > 1:
            yield (
                f"{entry_words(number)}: crank is left out: every entry must give its disc and its crank (crank.number = "
                f"{cranks})"
            )
        if entry.disc is not None and (place := (entry.disc, entry.crank or 0)) in seen:
            yield f"{entry_words(number)}: disc {place[0]} on crank {place[1]} has an entry already"
        seen.add((number if entry.disc is None else entry.disc, entry.crank or 0))
    bound = deviation_bound(drive)
    for number, own in enumerate(drive.disc.of):
        if own.bore_errors is None:
            continue
        if cranks == 1:
            for name in ("radial", "tangential"):
                yield (
                    f"disc.of.{number}.bore_errors.{name}: must be left out with one crank, whose bore is the centre of the "
                    "disc (give disc.runout)"
                )
            continue
        yield from _part_errors(f"disc.of.{number}.bore_errors", own.bore_errors, cranks, "bores", bound)
    size = min(bound, 0.5 * drive.crank.eccentricity)
    for number, entry in enumerate(entries):
        if cranks > 1 and abs(entry.eccentricity_error or 0.0) > size:
            yield (
                f"{_entry(drive, number)}: eccentricity_error = {entry.eccentricity_error:g} mm: must be at most {size:g} mm in "
                "size, a tenth of the smallest pin or roller radius and half the eccentricity"
            )


def _entry(drive: Drive, number: int) -> str:
    """An entry of ``crank.of`` with disc and crank, where it gives them."""
    entry = drive.crank.of[number]
    told = [f"{name} {value}" for name, value in (("disc", entry.disc), ("crank", entry.crank)) if value is not None]
    return entry_words(number) + (f" ({', '.join(told)})" if told else "")


def named_in_disc(drive: Drive, problem: str, disc: int) -> str:
    """Return a problem of a drive of one disc as one of the whole drive, with the paths of the values per disc."""
    for common, own in OWN.items():
        table, _, name = own.replace(ANY, "").replace("..", ".").partition(".of.")
        if table == "crank" and drive.crank.number > 1:
            continue  # several cranks are checked with the whole drive
        entry = (drive.disc.of[disc] if drive.disc.of else None) if table == "disc" else drive.crank.eccentric(disc)
        if entry is not None and getattr(entry, name) is not None:
            problem = re.sub(rf"\b{re.escape(common)}\b", own.replace(ANY, str(disc)), problem)
    return problem


def find_deviation_problems(drive: Drive) -> Iterator[str]:
    """Yield the problems of numbers and sizes of the deviations, one sentence each."""
    pins, holes = drive.pin_wheel.number_of_pins, drive.number_of_holes
    rollers = drive.crank_bearing.number_of_rollers
    parts: list[tuple[str, PlacementErrors | RollerErrors, int, str]] = [
        ("pin_wheel.pin_errors", drive.pin_wheel.pin_errors, pins, "pins"),
        ("disc.hole_errors", drive.disc.hole_errors, holes, "holes"),
        ("crank_bearing.roller_errors", drive.crank_bearing.roller_errors, rollers, "rollers"),
    ]
    if drive.pin_shaft is not None:
        parts.append(("pin_shaft.pin_errors", drive.pin_shaft.pin_errors, holes, "pins"))
    bound = deviation_bound(drive)
    for path, errors, count, things in parts:
        yield from _part_errors(path, errors, count, things, bound)
    lengths = {
        "crank.eccentricity_error": drive.crank.eccentricity_error,
        "crank.axis_offset.x": drive.crank.axis_offset.x,
        "crank.axis_offset.y": drive.crank.axis_offset.y,
        "pin_wheel.axis_offset.x": drive.pin_wheel.axis_offset.x,
        "pin_wheel.axis_offset.y": drive.pin_wheel.axis_offset.y,
        "disc.runout.amount": drive.disc.runout.amount,
    }
    limit = min(bound, 0.5 * drive.crank.eccentricity)
    for path, value in lengths.items():
        if abs(value) > limit:
            yield (
                f"{path} = {value:g} mm: must be at most {limit:g} mm in size, a tenth of the smallest pin or "
                "roller radius and half the eccentricity"
            )
    yield from _profile_errors(drive, bound)


def _part_errors(
    path: str, errors: PlacementErrors | RollerErrors | BoreErrors, count: int, things: str, bound: float
) -> Iterator[str]:
    """Problems of numbers and sizes of the errors of single pins, holes, rollers or bores."""
    for name in ("radial", "tangential", "diameter"):
        values = getattr(errors, name, ())
        if values and len(values) != count:
            yield f"{path}.{name} has {len(values)} values: must have {count}, one for each of the {things}"
        worst = max(values, key=abs, default=0.0)
        if abs(worst) > bound:
            yield (
                f"{path}.{name} holds {worst:g} mm: must be at most {bound:g} mm in size, "
                "a tenth of the smallest pin or roller radius"
            )


def _profile_errors(drive: Drive, bound: float) -> Iterator[str]:
    errors = drive.disc.profile_errors
    path = "disc.profile_errors"
    if len(set(errors.orders)) != len(errors.orders):
        yield f"{path}.orders: must name each order once"
    for name in ("cosine", "sine"):
        values = getattr(errors, name)
        if values and len(values) != len(errors.orders):
            yield f"{path}.{name} has {len(values)} values: must have {len(errors.orders)}, one for each of the orders"
    if len(errors.deviation) != len(errors.parameter):
        yield (
            f"{path}.deviation has {len(errors.deviation)} values: must have {len(errors.parameter)}, "
            "one for each measured parameter"
        )
    if errors.parameter:
        at = np.array(errors.parameter)
        if at.size < 3 or at[0] < 0.0 or at[-1] >= 2.0 * pi or not np.all(np.diff(at) > 0.0):
            yield f"{path}.parameter: must be at least 3 angles ascending from 0 rad or more to less than 2π rad"
    size = sum(abs(value) for value in (*errors.cosine, *errors.sine)) + max(map(abs, errors.deviation), default=0.0)
    if size > bound:
        yield (
            f"{path} reaches {size:g} mm: must be at most {bound:g} mm, a tenth of the smallest pin or roller radius"
        )


def find_flank_problems(drive: Drive) -> Iterator[str]:
    """Yield the problem of a flank, designed or deviated, that folds or is more hollow than its pins are round."""
    profile = FlankProfile.of_drive(drive)
    # As designed the flank is hollowest in its roots: the curvature of the trochoid falls toward them as long as it
    # is hollow at all.
    designed = _hollow_radius(float(profile.locus_curvature(np.zeros(1))[0]), float(profile.offset))
    theta, actual = 0.0, designed
    if profile.deviation is not None:
        waves = max(
            (drive.pin_wheel.number_of_pins, *profile.deviation.orders, len(drive.disc.profile_errors.parameter))
        )
        places, direction, frame = _looked_at(
            float(profile.generating_radius), float(profile.eccentricity), profile.reduction_ratio, waves
        )
        # Without rotation and runout, which do not change its shape.
        flank = replace(profile, turn=1.0, centre=0.0).deviated(frame, direction)
        forward = (flank.tangent * frame.tangent.conjugate()).real
        if np.min(forward) <= 0.0:
            worst = float(places[np.argmin(forward)])
            yield f"disc.profile_errors: the flank folds back on itself at θ = {worst:.4g} rad; reduce amplitude or order"
            return
        hollowest = np.argmin(curvature := flank.curvature)
        theta, actual = (
            float(places[hollowest]),
            _hollow_radius(float(curvature[hollowest]), float(profile.contact_offset)),
        )
    yield from _hollow(drive, designed, actual, theta)


def _hollow(drive: Drive, designed: float, actual: float, theta: float) -> Iterator[str]:
    """A pin rounder than a hollow of the flank touches it at two points."""
    nominal = drive.pin_wheel.pin_radius
    growth = max(drive.pin_wheel.pin_errors.diameter, default=0.0)
    largest = nominal + 0.5 * max(growth, 0.0)
    if actual > largest:
        return
    if designed <= nominal:
        field = f"disc.equidistant_offset = {drive.disc.equidistant_offset:g} mm"
    elif actual <= nominal:
        field = "disc.profile_errors"
    else:
        field = f"pin_wheel.pin_errors.diameter holds {growth:g} mm"
    yield (
        f"{field}: the flank has a hollow of radius {actual:.6g} mm at θ = {theta:.4g} rad, must be greater than "
        f"{largest:g} mm, the radius of the largest pin, or pins touch it at two points at once"
    )


def _hollow_radius(curvature: float, offset: float) -> float:
    """Radius of curvature where a flank is hollow, infinite elsewhere, mm; `curvature` is that of its parallel at an
    offset.
    """
    return 1.0 / max(-curvature / (1.0 - offset * curvature), 1e-300)


@lru_cache(maxsize=8)
def _looked_at(
    radius: float, eccentricity: float, ratio: float, waves: int
) -> tuple[FloatArray, ComplexArray, CurveFrame]:
    """Parameters θ at which a deviated flank is checked, e^{iθ} and the designed frame there.

    They resolve every wave, and the roots however sharp. They are cached, since studies check one design thousands of
    times.
    """
    even = np.linspace(0.0, 2.0 * pi, POINTS_PER_WAVE * waves, endpoint=False)
    # |c′|² = (R − e u)² + 2 R e u (1 − cos (u − 1)θ): what is special in a root is so within this of it.
    pitch_radius, teeth = eccentricity * ratio, round(ratio) - 1
    sharp = (radius - pitch_radius) / (np.sqrt(radius * pitch_radius) * (ratio - 1.0))
    about = sharp * np.linspace(-3.0, 3.0, POINTS_PER_WAVE + 1)
    roots = 2.0 * pi * np.arange(teeth)[:, None] / teeth + about
    places = np.mod(np.concatenate([even, roots.ravel()]), 2.0 * pi)
    direction = unit(places)
    design = FlankProfile(generating_radius=radius, eccentricity=eccentricity, reduction_ratio=ratio, offset=0.0)
    frame = design.frame(direction)
    for kept in (places, direction, *frame):
        kept.setflags(write=False)
    return places, direction, frame
